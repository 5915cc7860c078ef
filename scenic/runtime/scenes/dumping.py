"""A scene as a program: concrete objects that compile back to the same scene."""

import math
from collections.abc import Iterator, Mapping
from keyword import iskeyword
from typing import Any

import numpy as np

from scenic.language.keywords import HARD_KEYWORDS
from scenic.language.properties import CLASSES
from scenic.language.word_sets import word_set
from scenic.runtime.instances.objects import Object, OrientedPoint, Point
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.spaces import Everywhere
from scenic.runtime.shapes.shapes import PrimitiveShape, Shape
from scenic.runtime.values.values import Orientation, Vector

_LEFT_OUT = word_set(
    "allowCollisions position orientation heading mutator mutationScale observations sensors "
    "behavior lastActions present regionContainedIn requireVisible"
)
"""Properties that the placement gives, that follow from others, or that would add requirements again: the requirements of the scene were tested when it was sampled."""

_DECLARED = frozenset(item.name for cls in CLASSES.values() for item in cls.properties)
"""The properties that the language declares."""


class NoLiteralError(Exception):
    """A value that cannot be written as an expression."""


def program_of(
    objects: tuple[Any, ...], ego: object, params: Mapping[str, object], names: Mapping[Any, str]
) -> str:
    """Return the text of a program whose only scene has these objects and parameters.

    Values that have no literal (regions, meshes made in memory, instances of the program's own Python classes) are left
    out, and named in comments.
    """
    lines: list[str] = []
    for name, value in params.items():
        is_word = name.isidentifier() and not iskeyword(name) and name not in HARD_KEYWORDS
        key = name if is_word else repr(name)
        try:
            lines.append(f"param {key} = {literal(value)}")
        except NoLiteralError:
            lines.append(f"# param {key}: {_described(value)}")
    classes = {type(item).__name__: type(item) for item in objects if type(item) is not Object}
    for name in classes:
        lines += [f"class {name}:", "    pass"]
    taken_names: set[str] = set()
    for number, item in enumerate(objects):
        name = "ego" if item is ego else names.get(item, "")
        if not name.isidentifier() or name in taken_names:
            name = f"object_{number}"
        taken_names.add(name)
        lines += _instance(name, item)
    return "\n".join(lines) + "\n"


def _instance(name: str, item: Any) -> Iterator[str]:
    parts = [f"at {_triple(item.position)}"]
    comments = []
    for key, value in item.properties.items():
        if key in _LEFT_OUT:
            continue
        try:
            # Properties of the language make vectors of triples themselves.
            write = _triple if isinstance(value, Vector) and key in _DECLARED else literal
            parts.append(f"with {key} {write(value)}")
        except NoLiteralError:
            comments.append(f"    # {key}: {_described(value)}")
    parts += ["with allowCollisions True", "with regionContainedIn everywhere"]
    yield f"{name} = new {type(item).__name__} {parts[0]},"
    for part in parts[1:-1]:
        yield f"    {part},"
    yield f"    {parts[-1]}"
    yield from comments


def literal(value: object) -> str:
    """Return a value as an expression of the language; raises `NoLiteralError` where there is none."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool):
        return repr(value)
    # Classes derived of these, such as enumerations, show themselves in ways that are no expressions.
    if isinstance(value, int):
        return int.__repr__(value)
    if isinstance(value, str):
        return str.__repr__(value)
    if isinstance(value, float):
        text = float.__repr__(value)
        return text if math.isfinite(value) else f"float({text!r})"
    if isinstance(value, Vector):
        return f"Vector{_triple(value)}"
    if isinstance(value, Orientation):
        return f"Orientation.fromQuaternion(({value.x!r}, {value.y!r}, {value.z!r}, {value.w!r}))"
    if isinstance(value, tuple):
        inside = ", ".join(map(literal, value))
        return f"({inside},)" if len(value) == 1 else f"({inside})"
    if isinstance(value, list):
        return f"[{', '.join(map(literal, value))}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{literal(key)}: {literal(item)}" for key, item in value.items()) + "}"
    if isinstance(value, Shape):
        return _shape(value)
    if isinstance(value, Everywhere):
        return "everywhere"
    if isinstance(value, OrientedPoint) and not isinstance(value, Object):
        return f"(new OrientedPoint at {_triple(value.position)}, with parentOrientation {literal(value.orientation)})"
    if type(value) is Point:
        return f"(new Point at {_triple(value.position)})"
    raise NoLiteralError


def _triple(value: Vector) -> str:
    return f"({value.x!r}, {value.y!r}, {value.z!r})"


def _shape(shape: Shape) -> str:
    source = shape.source
    options = [f"dimensions={literal(tuple(float(size) for size in shape.dimensions))}"]
    options += [f"{name}={literal(value)}" for name, value in source.parameters.items()]
    if source.initial_rotation is not None:
        options.append(f"initial_rotation={literal(tuple(source.initial_rotation))}")
    if isinstance(shape, PrimitiveShape):
        return f"{type(shape).__name__}({', '.join(options)})"
    if source.path is not None:
        return f"MeshShape.fromFile({source.path!r}, {', '.join(options)})"
    raise NoLiteralError


def _described(value: object) -> str:
    text = f"a {type(value).__name__}" if isinstance(value, Region) else repr(value)
    return text.replace("\n", " ")[:80]


__all__ = ["NoLiteralError", "literal", "program_of"]
