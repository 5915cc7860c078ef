"""Broken variants of road maps: ``python -m benchmarks.broken_maps town.xodr ... [--variants 300] [--seed 1] [--schema FILE.xsd ...]``.

Each variant has one thing wrong: an attribute that is missing, no number, NaN, huge or negative, an element that is missing, empty
or there twice, or a reference to what does not exist. Counted are the variants that raise anything but `MapError`, those that take
longer than ten seconds and ten times what the map itself takes, and the diagnostics of the others, apart for those that break the
standard and those that remain a valid map (one without its signals, say). A variant breaks the standard if one of the official
schemas refuses it (``--schema``, a file from ASAM's package; those that refuse the map itself are not asked), or if `faults_beside`
finds one of the faults that no schema knows: ids that are there twice, links to what is not there, lines that are torn. ``--show``
prints what was changed where a variant that breaks the standard has no diagnostic, several, or none at the line of the change.
"""

import argparse
import copy
import math
import random
import re
import time
import traceback
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from scenic.domains.driving.loading import MapOptions, network_of
from scenic.formats.opendrive.xml_tree import MapError

UNCACHED = MapOptions(useCache=False, writeCache=False)
VALUES = ("nan", "inf", "1e300", "-1", "", "west", "999999")
_MARK = "changed-here"


@dataclass(frozen=True)
class Variant:
    """A broken map.

    Attributes:
        text: the map; each element begins a line.
        done: what was changed.
        kind: the same without values, for counting.
        lines: the lines at which a diagnostic is expected: of the element that was changed, of the one that holds it, and of
            links to what is no longer there.

    """

    text: str
    done: str
    kind: str
    lines: frozenset[int]


def variants(text: str, count: int, seed: int) -> Iterator[Variant]:
    """Broken variants of the text of a map."""
    root = ElementTree.fromstring(text)
    draw = random.Random(seed)
    for _ in range(count):
        broken = copy.deepcopy(root)
        done, kind, places = _break(broken, draw)
        for place in places:
            place.set(_MARK, "1")
        ElementTree.indent(broken)
        written = ElementTree.tostring(broken, encoding="unicode")
        lines = frozenset(number for number, row in enumerate(written.splitlines(), 1) if _MARK in row)
        yield Variant(written.replace(f' {_MARK}="1"', ""), done, kind, lines)


def _links_to(root: Any, tag: str, name: str | None) -> list[Any]:
    """The elements that name a road, junction or lane."""
    words = {"road": ("elementId", "incomingRoad", "connectingRoad"), "junction": ("elementId", "junction")}
    return [item for item in root.iter() for word in words.get(tag, ()) if name and item.get(word) == name]


def _break(root: Any, draw: random.Random) -> tuple[str, str, list[Any]]:
    """Change one thing; gives what, its kind, and the elements where it can be seen."""
    parents = {child: parent for parent in root.iter() for child in parent}
    # Every kind of element is as likely, however often it is there.
    tag = draw.choice(sorted({item.tag for item in parents}))
    item = draw.choice([item for item in parents if item.tag == tag])
    way = draw.choice(("value", "value", "value", "drop attribute", "drop", "repeat", "empty"))
    parent = parents[item]
    seen = [parent, *_links_to(root, tag, item.get("id"))]
    if way in ("value", "drop attribute") and item.attrib:
        name = draw.choice(sorted(item.attrib))
        old = item.attrib.pop(name)
        if way == "drop attribute":
            return f"<{tag}> without {name}={old!r}", f"<{tag}> without {name}", [item, *seen]
        item.set(name, draw.choice(VALUES))
        return (
            f"<{tag}> {name}={item.get(name)!r} instead of {old!r}",
            f"<{tag}> {name} changed",
            [item, *seen],
        )
    if way == "repeat":
        again = copy.deepcopy(item)
        parent.insert(list(parent).index(item) + 1, again)
        return f"<{tag}> {item.attrib} twice", f"<{tag}> twice", [again]
    if way == "empty" and len(item):
        done = f"<{tag}> {item.attrib} without content"
        for child in list(item):
            item.remove(child)
        return done, f"<{tag}> without content", [item, *seen]
    parent.remove(item)
    for lane in item.iter("lane"):  # what links to the lanes of the file name
        links = (link for which in ("predecessor", "successor") for link in root.iter(which))
        seen += [parents[parents[link]] for link in links if link.get("id") == lane.get("id")]
    return (
        f"no <{tag}> {item.attrib}",
        f"no <{tag}>",
        [*seen, *(parents[item] for item in [parent] if item in parents)],
    )


def faults_beside(root: Any) -> list[str]:
    """The faults of a map that no schema knows: ids there twice, links to nothing, links that nobody returns, torn lines.

    Written from the standard, and apart from the reader that is tried.
    """
    roads = root.findall("road")
    junctions = root.findall("junction")
    names = Counter(road.get("id") for road in roads)
    identifiers = {"road": names, "junction": Counter(item.get("id") for item in junctions)}
    faults = [
        f"{kind} {name} twice"
        for kind, names in identifiers.items()
        for name, many in names.items()
        if many > 1
    ]
    by_name = {road.get("id"): road for road in roads}
    for path in ("road/signals/signal", "road/objects/object"):
        ids = Counter(item.get("id") for item in root.findall(path))
        faults += [f"{path} {name} twice" for name, many in ids.items() if many > 1]
    for junction in junctions:
        ids = Counter(item.get("id") for item in junction.findall("connection"))
        faults += [f"connection {name} twice" for name, many in ids.items() if many > 1]
        for connection in junction.findall("connection"):
            pairs = Counter((link.get("from"), link.get("to")) for link in connection.findall("laneLink"))
            faults += ["lane link twice" for many in pairs.values() if many > 1]
            faults += [
                f"connection names {connection.get(end)}"
                for end in ("incomingRoad", "connectingRoad")
                if connection.get(end) not in names
            ]
            for link in connection.findall("laneLink"):
                incoming, connecting = (
                    by_name.get(connection.get(end)) for end in ("incomingRoad", "connectingRoad")
                )
                if incoming is not None and link.get("from") not in _lanes(incoming, 0) | _lanes(
                    incoming, -1
                ):
                    faults.append("link from no lane")
                if connecting is not None and link.get("to") not in _lanes(connecting, 0) | _lanes(
                    connecting, -1
                ):
                    faults.append("link to no lane")
    for road in roads:
        if road.get("junction") not in (None, "-1") and road.get("junction") not in identifiers["junction"]:
            faults.append(f"road in no junction {road.get('junction')}")
        faults += _faults_of_road(road, by_name, identifiers)
    return faults


def _faults_of_road(road: Any, by_name: dict[Any, Any], known: dict[str, Any]) -> Iterator[str]:
    for which, place in (("predecessor", 0), ("successor", -1)):
        end = road.find(f"link/{which}")
        if end is None:
            continue
        if end.get("elementId") not in known.get(end.get("elementType"), {}):
            yield f"{which} {end.get('elementId')} is not there"
        elif end.get("elementType") == "road" and road.get("junction") == "-1":
            other = by_name[end.get("elementId")]
            back = "predecessor" if end.get("contactPoint") == "start" else "successor"
            if other.get("junction") == "-1" and other.find(f"link/{back}") is None:
                yield f"{which} does not link back"
            beyond = _lanes(other, 0 if end.get("contactPoint") == "start" else -1)
            for lane in _last(road, place).iter("lane"):
                link = lane.find(f"link/{which}")
                if link is not None and link.get("id") not in beyond:
                    yield f"lane {which} is not there"
    pieces = road.findall("planView/geometry")
    for before, after in pairwise(pieces):
        numbers = [_numbers(piece) for piece in (before, after)]
        if before.find("line") is not None and all(
            map(all, [[math.isfinite(x) for x in row] for row in numbers])
        ):
            (x, y, heading, length), (other_x, other_y, *_) = numbers
            if (
                math.hypot(x + length * math.cos(heading) - other_x, y + length * math.sin(heading) - other_y)
                > 1
            ):
                yield "torn line"
    for section in road.findall("lanes/laneSection"):
        ids = Counter(lane.get("id") for lane in section.iter("lane"))
        yield from (f"lane {name} twice" for name, many in ids.items() if many > 1)


def _numbers(piece: Any) -> list[float]:
    try:
        return [float(piece.get(name)) for name in ("x", "y", "hdg", "length")]
    except (TypeError, ValueError):
        return [math.nan]


def _last(road: Any, place: int) -> Any:
    sections = road.findall("lanes/laneSection")
    return sections[place] if sections else ElementTree.Element("laneSection")


def _lanes(road: Any, place: int) -> set[Any]:
    return {lane.get("id") for lane in _last(road, place).iter("lane")}


def judged(text: str) -> tuple[str, tuple[int, ...]]:
    """The outcome of loading a variant, ``"error"``, ``"network"`` or a traceback, and the lines of its diagnostics (0: none)."""
    try:
        network = network_of.__wrapped__(text.encode(), "broken.xodr", UNCACHED)
        _ = network.drivableRegion, network.walkableRegion, network.curbRegion, network.shoulderRegion
        for move in (move for lane in network.lanes for move in lane.maneuvers):
            _ = move.type, move.conflictingManeuvers
    except MapError as error:
        return "error", (error.span.line if error.span else 0,)
    except Exception:  # noqa: BLE001 - what is looked for
        return traceback.format_exc(limit=-4), ()
    return "network", tuple(item.span.line if item.span else 0 for item in network.problems)


class _Judge:
    """Says whether a map breaks the standard."""

    def __init__(self, schemas: Sequence[Path], text: str) -> None:
        self._schemas = []
        for path in schemas:
            from lxml import etree

            schema = etree.XMLSchema(etree.parse(path))
            if schema.validate(etree.fromstring(text.encode())):
                self._schemas.append(schema)
            else:
                print(f"  {path.name} refuses the map itself: not asked")

    def breaks(self, text: str) -> bool:
        """Return whether a map breaks the standard."""
        if self._schemas:
            from lxml import etree

            if not all(schema.validate(etree.fromstring(text.encode())) for schema in self._schemas):
                return True
        return bool(faults_beside(ElementTree.fromstring(text)))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("maps", nargs="+", type=Path)
    parser.add_argument("--variants", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--schema", type=Path, action="append", default=[])
    parser.add_argument("--show", action="store_true")
    arguments = parser.parse_args()
    for path in arguments.maps:
        text = path.read_text(encoding="utf-8")
        text = re.sub(r"^<\?xml.*?\?>", "", text).strip()
        judge = _Judge(arguments.schema, text)
        start_time = time.process_time()
        _, usual_lines = judged(text)
        usual = time.process_time() - start_time
        found: Counter[str] = Counter()
        harmless: Counter[str] = Counter()
        slowest = 0.0
        for variant in variants(text, arguments.variants, arguments.seed):
            start_time = time.process_time()
            outcome, lines = judged(variant.text)
            taken = time.process_time() - start_time
            slowest = max(slowest, taken)
            if outcome not in ("error", "network"):
                found["traceback"] += 1
                print(f"  {variant.done}\n{outcome}", flush=True)
                continue
            found["slow"] += taken > max(10.0, 10 * usual)
            more = len(lines) - len(usual_lines) if outcome == "network" else 1
            many = "none" if more < 1 else "one" if more == 1 else "more"
            if not judge.breaks(variant.text):
                found["valid"] += 1
                harmless[f"{variant.kind} ({many})"] += 1
                continue
            found[many] += 1
            there = bool(variant.lines & set(lines))
            found["elsewhere"] += more > 0 and not there
            if arguments.show and (more != 1 or not there):
                print(f"  {more} at {lines[:5]}, not {sorted(variant.lines)}: {variant.done}")
        names = ("traceback", "slow", "none", "one", "more", "elsewhere")
        counts = ", ".join(f"{name} {found[name]}" for name in names)
        broken = arguments.variants - found["valid"] - found["traceback"]
        print(
            f"{path.name}: {broken} break the standard: {counts}; slowest {slowest:.2f} s, the map {usual:.2f} s"
        )
        print(
            f"  {found['valid']} are valid maps: {', '.join(f'{n} {kind}' for kind, n in harmless.most_common())}",
            flush=True,
        )


if __name__ == "__main__":
    main()
