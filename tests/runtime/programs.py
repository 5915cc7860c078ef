"""Helpers to run small programs and to look at what comes out."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import scenic
from scenic import pipeline
from scenic.failures import diagnose
from scenic.runtime.instances.objects import Point
from scenic.runtime.regions.base import Region
from scenic.runtime.shapes.shapes import Shape
from scenic.runtime.values.values import Orientation, Vector

FALSE_ALARM = 1e-6
"""A goodness-of-fit test fails by bad luck with this probability; seeds are fixed, so that it cannot come and go."""


def scenario(text: str, **options: Any) -> scenic.Scenario:
    return scenic.scenarioFromString(text, **options)


def unpruned(text: str) -> scenic.Scenario:
    """A program whose draws are not narrowed, and for which nobody tries to."""
    return pipeline._scenario(text, "<string>", pipeline._Options(prune=False))


def scene(text: str, *, seed: int = 0, **options: Any) -> scenic.Scene:
    (only,) = scenario(text, **options).sample(1, seed=seed)
    return only


def thing(text: str, **options: Any) -> Any:
    """The last object of a program's first scene."""
    return scene(text, **options).objects[-1]


def params(text: str, **options: Any) -> dict[str, Any]:
    return scene(text, **options).params


def draws(text: str, name: str = "x", *, n: int = 4000, seed: int = 1, **options: Any) -> list[Any]:
    """The values of a parameter in many scenes."""
    return [item.params[name] for item in scenario(text, **options).sample(n, seed=seed)]


def failure(text: str, *, n: int = 1, seed: int = 0, **options: Any) -> BaseException:
    """The exception of compiling or sampling a program."""
    try:
        scenario(text, **options).sample(n, seed=seed)
    except Exception as error:  # noqa: BLE001 - whatever it is, it is looked at
        return error
    raise AssertionError("the program has no error")


def place(error: BaseException) -> tuple[str, str, str | None]:
    """Code of an error, its place as ``line:column-line:column`` (columns from 1), and its help."""
    found = diagnose(error)
    assert found is not None, f"no diagnostic for {type(error).__name__}: {error}"
    span = found.span
    if span is None:
        return found.code, "", found.help
    where = f"{span.line}:{span.column + 1}-{span.end_line}:{span.end_column + 1}"
    return found.code, where, found.help


def marked(text: str) -> tuple[str, tuple[int, int, int]]:
    """A text without its marks, and line, first and last column (from 0) of what they mark."""
    before, _, rest = text.partition("«")
    inside, _, after = rest.partition("»")
    line = before.count("\n") + 1
    column = len(before) - (before.rfind("\n") + 1)
    return before + inside + after, (line, column, column + len(inside))


def plain(value: Any) -> Any:
    """A sampled value as nested tuples of Python's own types, for bitwise comparison."""
    if isinstance(value, Vector):
        return ("vector", *value)
    if isinstance(value, Orientation):
        return ("orientation", value.x, value.y, value.z, value.w)
    if isinstance(value, Point):
        properties = value.properties
        return (type(value).__name__, *((name, plain(properties[name])) for name in sorted(properties)))
    if isinstance(value, Region | Shape):
        return repr(value)
    if isinstance(value, Mapping):
        return tuple((key, plain(item)) for key, item in value.items())
    if isinstance(value, tuple | list):
        return (type(value).__name__, *(plain(item) for item in value))
    return (type(value).__name__, value)


def fingerprint(item: scenic.Scene) -> Any:
    """Everything that a scene says."""
    return (item.k, item.attempts, plain(item.params), tuple(plain(thing) for thing in item.objects))


# Independent formulas (SciPy's rotations, NumPy's vectors)


def euler(yaw: float, pitch: float = 0, roll: float = 0) -> Rotation:
    """Intrinsic rotations about Z, the new X and the new Y."""
    return Rotation.from_euler("ZXY", [yaw, pitch, roll])


def rotation(value: Any) -> Rotation:
    """An orientation of ours as SciPy's."""
    return Rotation.from_quat([value.x, value.y, value.z, value.w])


def azimuth(line: Any) -> float:
    """Heading of a direction: 0 is North, anticlockwise, within [-pi, pi]."""
    return float(np.angle(np.exp(1j * (np.arctan2(line[1], line[0]) - np.pi / 2))))


def altitude(line: Any) -> float:
    return float(np.arctan2(line[2], np.hypot(line[0], line[1])))


def assert_angles_equal(found: float, expected: float) -> None:
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * expected), atol=1e-9)


def assert_same_rotation(found: Any, expected: Rotation) -> None:
    np.testing.assert_allclose(rotation(found).as_matrix(), expected.as_matrix(), atol=1e-9)
