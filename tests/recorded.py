"""Recorded answers: what many small programs give, in text files beside the tests.

A file holds cases as in `tests.compiler.golden_cases`: a title after ``==``, a source, and below ``--`` what it gave when it
was recorded and read through. Numbers may differ by rounding. ``--update-golden`` writes what is found.

These tests say that nothing changed, not that it is right: laws and oracles are tested elsewhere. They notice slips in the
many corners that no law reaches.
"""

import math
import re
import warnings
from collections.abc import Callable, Mapping
from difflib import unified_diff
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.failures import diagnose
from scenic.runtime.instances.objects import Point
from scenic.runtime.regions.base import Region
from scenic.runtime.values.values import Orientation, Vector
from tests.compiler.golden_cases import Case, cases_text, read_cases

FOLDER = Path(__file__).parent / "data" / "recorded"

_LATER = (("float modulo by zero", "float modulo"),)
"""What later versions of Python say otherwise."""

_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


def hold(
    path: Path, answer: Callable[[str], str], request: pytest.FixtureRequest, *, rounding: float = 1e-6
) -> None:
    """Asserts that each source of a file gives what stands below it, its numbers but for relative differences."""
    introduction, cases = read_cases(path)
    titles = [case.title for case in cases]
    assert len(set(titles)) == len(titles), "two cases have the same title"
    found = tuple(Case(case.file, case.title, case.source, f"{answer(case.source)}\n") for case in cases)
    if request.config.getoption("--update-golden"):
        path.write_text(cases_text(introduction, found).rstrip("\n") + "\n", encoding="utf-8")
        return
    assert cases, "the file holds no case"
    differing = [
        "\n".join(unified_diff(before.splitlines(), now.splitlines(), case.title, "now", n=0, lineterm=""))
        for case, before, now in (
            (case, case.tree or "", now.tree or "") for case, now in zip(cases, found, strict=True)
        )
        if not alike(before, now, rounding)
    ]
    assert not differing, "\n\n".join([path.name, *differing])


def alike(first: str, second: str, rounding: float) -> bool:
    """Whether two texts are equal but for the rounding of their numbers."""
    if first.strip("\n") == second.strip("\n"):
        return True
    if _NUMBER.split(first.strip("\n")) != _NUMBER.split(second.strip("\n")):
        return False
    pairs = zip(_NUMBER.findall(first), _NUMBER.findall(second), strict=True)
    return all(one == other or _is_near(one, other, rounding) for one, other in pairs)


def _is_near(one: str, other: str, rounding: float) -> bool:
    """Whether two numbers differ by rounding; whole ones count, or are too large for floats to tell them apart."""
    if one.isdigit() and other.isdigit():
        return False
    return math.isclose(float(one), float(other), rel_tol=rounding, abs_tol=rounding / 100)


def scenes(source: str, *, wanted: int = 3, **options: Any) -> str:
    """What a program's first scenes hold: each object's properties and each parameter; or what is said of its error."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            scenario = scenic.scenarioFromString(source, **options)
            found = scenario.sample(wanted, seed=7, max_attempts=500)
            answer = "\n".join(_scene(number, scene) for number, scene in enumerate(found))
        except Exception as error:  # noqa: BLE001 - what is said of it is the answer
            answer = said(error)
    return "\n".join([*(f"warning: {warning.message}" for warning in warned), answer])


def columns(source: str, *, wanted: int = 16, **options: Any) -> str:
    """Each parameter of a program, and where its objects are, over many scenes that are looked for together, a line each."""
    try:
        scenario = scenic.scenarioFromString(source, **options)
        found = scenario.sample(wanted, seed=7, max_attempts=500)
        rows = {name: [scene.params[name] for scene in found] for name in found[0].params}
        for index in range(len(found[0].objects)):
            rows[f"#{index}"] = [scene.objects[index].position for scene in found]
            rows[f"#{index} faces"] = [scene.objects[index].orientation for scene in found]
        return "\n".join(f"{name}: {_column(list(map(shown, values)))}" for name, values in rows.items())
    except Exception as error:  # noqa: BLE001 - what is said of it is the answer
        return said(error)


def _column(values: list[str]) -> str:
    """The values, or the one that all are."""
    return f"always {values[0]}" if len(set(values)) == 1 else " ".join(values)


def expressions(source: str) -> str:
    """What each expression below a line of ``?`` gives in two scenes of the program above it, or what is said of its error.

    Each is a program of its own, so that those after a mistake are heard too.
    """
    program, _, asked = source.partition("\n?\n")
    lines = []
    for expression in asked.strip("\n").split("\n"):
        try:
            found = scenic.scenarioFromString(f"{program}\nparam answer = ({expression})\n")
            values = [shown(scene.params["answer"]) for scene in found.sample(2, seed=7, max_attempts=500)]
            answer = values[0] if len(set(values)) == 1 else " | ".join(values)
        except Exception as error:  # noqa: BLE001 - what is said of it is the answer
            answer = said(error)
        lines.append(f"{expression} -> {answer}")
    return "\n".join(lines)


def said(error: BaseException) -> str:
    """Code, place, words, second places and help of an error; its type too."""
    found = diagnose(error)
    if found is None:
        return f"{type(error).__name__}: {error}"

    def where(span: Any) -> str:
        return "" if span is None else f"{span.line}:{span.column}-{span.end_line}:{span.end_column} "

    message = found.message
    for later, before in _LATER:
        message = message.replace(later, before)
    lines = [f"{type(error).__name__} {where(found.span)}{found.code} {message}"]
    lines += [f"  {where(label.span)}{label.text}" for label in found.labels]
    lines += [f"  help: {found.help}"] if found.help else []
    return "\n".join(lines)


def _scene(number: int, scene: "scenic.Scene") -> str:
    lines = [f"scene {number}"]
    names = {id(item): f"#{index}" for index, item in enumerate(scene.objects)}
    for index, item in enumerate(scene.objects):
        ego = ", ego" if item is scene.egoObject else ""
        lines.append(f"  #{index} {type(item).__name__}{ego}")
        lines += [f"    {name}: {text}" for name, text in unusual(item, names).items()]
    lines += [f"  param {name}: {shown(value, names)}" for name, value in scene.params.items()]
    return "\n".join(lines)


def unusual(item: Point, names: Mapping[int, str] | None = None) -> dict[str, str]:
    """The properties of an instance that differ from those of a plain object, as texts."""
    properties = item.properties
    texts = {name: shown(properties[name], names) for name in sorted(properties) if name not in _FOLLOWING}
    return {name: text for name, text in texts.items() if text != _usual().get(name)}


_FOLLOWING = frozenset({"heading", "yaw", "pitch", "roll"})
"""Properties that follow from the orientation."""


@cache
def _usual() -> Mapping[str, str]:
    """The properties of an object of which nothing is said."""
    (plain,) = scenic.scenarioFromString("ego = new Object").sample(1, seed=0)[0].objects
    return {name: shown(value) for name, value in plain.properties.items() if name != "position"}


def shown(value: Any, names: Mapping[int, str] | None = None) -> str:
    """A value as text, with nine digits of its numbers."""
    names = names or {}
    if id(value) in names:
        return names[id(value)]
    if isinstance(value, bool | str) or value is None:
        return repr(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return "0" if abs(value) <= 1e-12 else f"{value + 0.0:.9g}"
    if isinstance(value, np.generic | np.ndarray):
        return f"{type(value).__name__} {shown(value.tolist())}"
    if isinstance(value, Vector):
        return f"({', '.join(shown(float(part)) for part in value)})"
    if isinstance(value, Orientation):
        parts = [value.w, value.x, value.y, value.z]
        leading = next((part for part in parts if abs(part) > 1e-9), 1.0)
        return f"turn ({', '.join(shown(float(part) * (1 if leading > 0 else -1)) for part in parts)})"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{shown(key, names)}: {shown(part, names)}' for key, part in value.items())}}}"
    if isinstance(value, set | frozenset):
        return f"{{{', '.join(sorted(shown(part, names) for part in value))}}}"
    if isinstance(value, list | tuple):
        return f"{type(value).__name__}({', '.join(shown(part, names) for part in value)})"
    if isinstance(value, Point):
        return f"{type(value).__name__} at {shown(value.position)}"
    if isinstance(value, Region):
        try:
            lower, upper = value.AABB
        except TypeError:
            return f"{type(value).__name__} without a box"
        return f"{type(value).__name__} in {shown(tuple(lower))} to {shown(tuple(upper))}"
    if isinstance(value, type):
        return value.__name__
    return f"{type(value).__name__} {re.sub(r' at 0x[0-9a-f]+', '', str(value))}"
