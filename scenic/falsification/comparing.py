"""The differences between a run that was kept and the same run made again, in words."""

import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any, Final

from scenic.batch.keeping import Form, about_file

__all__ = ["differences", "file_departures", "row_departures"]

_COMPARED: Final = ("status", "values", "requirements", "steps")
_LEFT_OUT: Final = ("settings", "origin", "objects", "records")


def row_departures(
    kept: Mapping[str, object], made: Mapping[str, object], *, without: Sequence[str] = ()
) -> list[str]:
    """Return where two rows of a search differ; what is in ``without`` is not compared."""
    return list(differences(kept, made, [name for name in _COMPARED if name not in without]))


def file_departures(kept: Path, made: Path, form: Form, *, without: Sequence[str] = ()) -> list[str]:
    """Return where two files of simulations differ: in the document about the whole, and the first state that does.

    Args:
        kept: the file that was kept.
        made: the file that was made again.
        form: the format of both.
        without: fields of the document that are not compared.

    """
    about, again = about_file(kept, form), about_file(made, form)
    departures = list(
        differences(about, again, [name for name in about if name not in (*_LEFT_OUT, *without)])
    )
    if form == "xosc":
        departure = _route_departure(_routes(kept), _routes(made))
    elif form == "xml":
        departure = _route_departure(_road_states(kept), _road_states(made))
    else:
        things = [item["name"] or f"{item['class']} {k}" for k, item in enumerate(about["objects"])]
        departure = _state_departure(_states(kept, form), _states(made, form), things)
    if departure is not None:
        return [*departures, departure]
    return departures or list(differences(about, again, ("records",)))


def differences(
    before: Mapping[str, object], after: Mapping[str, object], names: Sequence[str]
) -> Iterator[str]:
    """Return the fields of these names in which two documents differ, with both values."""
    for name in names:
        if name == "requirements" and before.get(name) and after.get(name):
            old, new = _by_label(before[name]), _by_label(after[name])
            yield from differences(old, new, list(dict.fromkeys([*old, *new])))
        elif before.get(name) != after.get(name):
            yield f"{name}: was {_short(before.get(name))}, now {_short(after.get(name))}"


def _states(path: Path, form: Form) -> Iterator[Mapping[str, Any]]:
    if form == "parquet":
        from scenic.formats.trajectory_tables import parquet_steps

        yield from parquet_steps(path)
        return
    with path.open(encoding="utf-8") as stream:
        stream.readline()
        yield from map(json.loads, stream)


def _state_departure(
    kept: Iterator[Mapping[str, Any]], made: Iterator[Mapping[str, Any]], things: Sequence[str]
) -> str | None:
    for before, after in zip_longest(kept, made):
        if before is None or after is None:
            return "the simulations end at different steps"
        if before != after:
            return _departure(before, after, things)
    return None


def _departure(before: Mapping[str, Any], after: Mapping[str, Any], things: Sequence[str]) -> str:
    where = f"from step {before['step']} (time {before['time']:g} s) on"
    for key, words in (("positions", "position"), ("orientations", "orientation")):
        for number, (old, new) in enumerate(zip(before[key], after[key], strict=False)):
            if old != new:
                return f"{where} it departs: the {words} of {_name(things, number)} was {old}, now {new}"
    acting = [
        _name(things, int(number))
        for number in sorted({*before["actions"], *after["actions"]}, key=int)
        if before["actions"].get(number) != after["actions"].get(number)
    ]
    return f"{where} it departs: " + (
        f"the actions of {', '.join(acting)} are others" if acting else "there are other objects"
    )


def _name(things: Sequence[str], number: int) -> str:
    return things[number] if number < len(things) else f"object {number}"


_Routes = Mapping[str, list[tuple[str, dict[str, str]]]]
"""Times and states of entities, by their names."""


def _route_departure(old: _Routes, new: _Routes) -> str | None:
    """Return the first place at which the trajectories of two files differ."""
    times_and_words = [
        (float(time), f"{name}'s {', '.join(differences(before, after, [*before]))}")
        for name, places in old.items()
        for (time, before), (_, after) in zip(places, new.get(name, []), strict=False)
        if before != after
    ]
    if times_and_words:
        time, words = min(times_and_words)
        return f"from time {time:g} s on it departs: {words}"
    if {name: len(places) for name, places in old.items()} != {
        name: len(places) for name, places in new.items()
    }:
        return "the simulations end at different steps"
    return None


def _road_states(path: Path) -> _Routes:
    """Return the states of each obstacle of a CommonRoad file."""
    from xml.etree import ElementTree

    return {
        f"obstacle {obstacle.get('id')}": [
            (
                state.findtext("time/exact", ""),
                {item.tag: " ".join(text.strip() for text in item.itertext()).strip() for item in state},
            )
            for state in obstacle.iter("state")
        ]
        for obstacle in ElementTree.parse(path).iter("dynamicObstacle")
    }


def _routes(path: Path) -> _Routes:
    """Return the vertices of each entity's trajectory: time, and attributes of the position."""
    from xml.etree import ElementTree

    return {
        str(trajectory.get("name")).removesuffix(" trajectory"): [
            (str(vertex.get("time")), dict(place.attrib))
            for vertex in trajectory.iter("Vertex")
            for place in vertex.iter("WorldPosition")
        ]
        for trajectory in ElementTree.parse(path).iter("Trajectory")
    }


def _by_label(requirements: Any) -> dict[str, Any]:
    """Return verdict and robustness by the label of the requirement, however they were kept."""
    items = (
        requirements.items()
        if isinstance(requirements, dict)
        else ((item["label"], item) for item in requirements)
    )
    return {label: [item["verdict"], item["robustness"]] for label, item in items}


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
