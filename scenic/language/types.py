"""The types of operands and parameters, as data: names, nouns for messages, and what a program writes to have one."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

__all__ = [
    "ANYTHING",
    "DIRECTION",
    "FIELD",
    "HEADING",
    "HEADING_OR_ANGLES",
    "OBJECT",
    "ORIENTATION",
    "ORIENTED_POINT",
    "POINT",
    "REGION",
    "SCALAR",
    "SCALAR_OR_VECTOR",
    "SHAPE",
    "VECTOR",
    "VIEW_ANGLES",
    "Type",
    "listed",
    "wanted",
]


@dataclass(frozen=True, slots=True, eq=False)
class Type:
    """One type that the language wants of a value.

    ``name`` is the type in documentation, ``noun`` the same in a message: "expected a number". ``advice`` says how a
    program gets such a value.
    """

    name: str
    noun: str
    advice: str = ""


ANYTHING: Final = Type("anything", "anything")
SCALAR: Final = Type(
    "scalar",
    "a number",
    "numbers are written plainly, drawn as by `Range(1, 2)`, or measured as by `distance to x`",
)
VECTOR: Final = Type("vector", "a vector", "write `(x, y, z)` or `x @ y`, or name a point or an object")
SCALAR_OR_VECTOR: Final = Type(
    "scalar or vector", "a number or a vector", "write a number, or a vector as `Vector(x, y, z)`"
)
"""Either, not converted: a tuple is no vector here."""
HEADING: Final = Type(
    "heading", "a heading", "write an angle, as `30 deg`, or name an oriented point or an object"
)
HEADING_OR_ANGLES: Final = Type(
    "heading or Euler angles",
    "a heading",
    "write an angle, as `30 deg`, or name an oriented point or an object",
)
"""A heading; of three numbers, the first of the Euler angles that they are."""
ORIENTATION: Final = Type(
    "orientation",
    "an orientation (a heading, Euler angles or an oriented point)",
    "write three Euler angles `(yaw, pitch, roll)`, or name an oriented point or an object",
)
DIRECTION: Final = Type("heading, orientation or field", ORIENTATION.noun, ORIENTATION.advice)
"""An orientation, or a field that has one at the place where it is wanted."""
FIELD: Final = Type(
    "vector field", "a vector field", "make one, as `VectorField('name', lambda position: 30 deg)`"
)
REGION: Final = Type(
    "region",
    "a region",
    "make one, as `CircularRegion((0, 0), 5)`, or take one of an object, as `x.topSurface`",
)
SHAPE: Final = Type("shape", "a shape", "make one, as `BoxShape()` or `MeshShape.fromFile(path)`")
POINT: Final = Type("point", "a point or an object", "make one with `new Point` or `new Object`")
ORIENTED_POINT: Final = Type(
    "oriented point", "an oriented point", "make one with `new OrientedPoint`, or give an object"
)
OBJECT: Final = Type("object", "an object", "make one with `new Object`")
VIEW_ANGLES: Final = Type("pair of angles", "a pair of angles", "write two angles, as `(90 deg, 45 deg)`")


def listed(types: Sequence[Type]) -> str:
    """Types in the words of the documentation: ``vector or region``."""
    return _alternatives([each.name for each in types])


def wanted(types: Sequence[Type]) -> tuple[str, str | None]:
    """The noun of several types, any of which will do, and the advice of all of them."""
    noun = _alternatives([each.noun for each in types])
    if len(types) == 1:
        return noun, types[0].advice or None
    return noun, "; ".join(f"{each.noun}: {each.advice}" for each in types)


def _alternatives(words: Sequence[str]) -> str:
    return " or ".join(filter(None, (", ".join(words[:-1]), words[-1])))
