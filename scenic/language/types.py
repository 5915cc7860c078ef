"""The types of operands and parameters, as data: names, nouns for messages, and what a program writes to have one."""

from collections.abc import Sequence
from typing import Final

from scenic.dataclass import dataclass

__all__ = [
    "ANYTHING",
    "BEHAVIOR",
    "BOOLEAN",
    "CALLABLE",
    "COLOR",
    "DIMENSIONS",
    "DIRECTION",
    "FIELD",
    "FIXED_NUMBER",
    "HEADING",
    "HEADING_OR_ANGLES",
    "INSTANCES",
    "MESH",
    "NONE",
    "OBJECT",
    "ORIENTATION",
    "ORIENTED_POINT",
    "PATTERN",
    "POINT",
    "POINTS",
    "POLYGON",
    "POLYLINE",
    "REGION",
    "REGIONS",
    "SCALAR",
    "SCALAR_OR_VECTOR",
    "SHAPE",
    "TEXT",
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
    program gets such a value. ``kinds`` are the kinds of values (`scenic.compiler.semantics.kinds`) that can be given for it, ``None``
    if the text of a program does not show that; ``lengths`` are those of tuples and lists of numbers that can. ``items`` is the
    type of the elements of a tuple or list of any length that can.
    """

    name: str
    noun: str
    advice: str = ""
    kinds: frozenset[str] | None = None
    lengths: frozenset[int] = frozenset()
    items: "Type | None" = None


INSTANCES: Final = frozenset({"object", "oriented point", "point"})
"""The kinds of values that `new` makes."""
_ORIENTED: Final = INSTANCES | {"number", "boolean", "orientation", "vector", "region"}
"""A region may have a preferred orientation."""
_FIELDS: Final = frozenset({"vector field", "region"})


ANYTHING: Final = Type("anything", "anything")
SCALAR: Final = Type(
    "scalar",
    "a number",
    "numbers are written plainly, drawn as by `Range(1, 2)`, or measured as by `distance to x`",
    kinds=frozenset({"number", "boolean"}),
)
VECTOR: Final = Type(
    "vector",
    "a vector",
    "write `(x, y, z)` or `x @ y`, or name a point or an object",
    kinds=INSTANCES | {"vector"},
    lengths=frozenset({2, 3}),
)
SCALAR_OR_VECTOR: Final = Type(
    "scalar or vector",
    "a number or a vector",
    "write a number, or a vector as `Vector(x, y, z)`",
    kinds=INSTANCES | {"vector", "number", "boolean"},
)
"""Either, not converted: a tuple is not a vector here."""
HEADING: Final = Type(
    "heading",
    "a heading",
    "write an angle, as `30 deg`, or name an oriented point or an object",
    kinds=_ORIENTED,
    lengths=frozenset({3}),
)
HEADING_OR_ANGLES: Final = Type(
    "heading or Euler angles",
    "a heading",
    "write an angle, as `30 deg`, or name an oriented point or an object",
    kinds=_ORIENTED,
    lengths=frozenset({3}),
)
"""A heading; of three numbers, the first of the Euler angles that they are."""
ORIENTATION: Final = Type(
    "orientation",
    "an orientation (a heading, Euler angles or an oriented point)",
    "write three Euler angles `(yaw, pitch, roll)`, or name an oriented point or an object",
    kinds=_ORIENTED,
    lengths=frozenset({3}),
)
DIRECTION: Final = Type(
    "heading, orientation or field",
    ORIENTATION.noun,
    ORIENTATION.advice,
    kinds=_ORIENTED | _FIELDS,
    lengths=frozenset({3}),
)
"""An orientation, or a field that has one at the place where it is wanted."""
FIELD: Final = Type(
    "vector field",
    "a vector field",
    "make one, as `VectorField('name', lambda position: 30 deg)`",
    kinds=_FIELDS,
)
REGION: Final = Type(
    "region",
    "a region",
    "make one, as `CircularRegion((0, 0), 5)`, or take one of an object, as `x.topSurface`",
    kinds=frozenset({"region", "workspace"}),
)
SHAPE: Final = Type(
    "shape", "a shape", "make one, as `BoxShape()` or `MeshShape.fromFile(path)`", kinds=frozenset({"shape"})
)
POINT: Final = Type(
    "point", "a point or an object", "make one with `new Point` or `new Object`", kinds=INSTANCES
)
ORIENTED_POINT: Final = Type(
    "oriented point",
    "an oriented point",
    "make one with `new OrientedPoint`, or give an object",
    kinds=frozenset({"object", "oriented point"}),
)
OBJECT: Final = Type("object", "an object", "make one with `new Object`", kinds=frozenset({"object"}))
NONE: Final = Type("None", "`None`", "write `None`", kinds=frozenset({"nothing"}))
BOOLEAN: Final = Type("boolean", "a truth value", "write `True` or `False`")
COLOR: Final = Type(
    "3 or 4 numbers in [0, 1]",
    "a colour (3 or 4 numbers from 0 to 1)",
    "write red, green, blue and maybe opacity as numbers from 0 to 1, in parentheses",
    kinds=frozenset({"vector"}),
    lengths=frozenset({3, 4}),
)
BEHAVIOR: Final = Type(
    "behavior",
    "a behavior",
    "define one with `behavior Name():`, and name it or call it",
    kinds=frozenset({"behavior", "monitor", "scenario"}),
)
TEXT: Final = Type("text", "text", "write it in quotes", kinds=frozenset({"text"}))
CALLABLE: Final = Type(
    "function", "a function", "define one, or write `lambda x: ...`", kinds=frozenset({"function", "class"})
)
FIXED_NUMBER: Final = Type(
    "fixed number",
    "a fixed number",
    "write it plainly; it cannot be random",
    kinds=frozenset({"number", "boolean"}),
)
PATTERN: Final = Type(
    "pattern or recorder",
    "a pattern of file names or a recorder",
    'write for example `to "positions.npz"`',
    kinds=frozenset({"text"}),
)
DIMENSIONS: Final = Type(
    "three numbers",
    "three numbers",
    "write width, length and height, as `(1, 2, 3)`",
    kinds=frozenset({"vector"}),
    lengths=frozenset({3}),
)
POINTS: Final = Type(
    "list of points", "a list of points", "write `[(0, 0), (1, 0), (1, 1)]`", kinds=frozenset(), items=VECTOR
)
REGIONS: Final = Type(
    "list of regions", "a list of regions", "write `[first, second]`", kinds=frozenset(), items=REGION
)
MESH: Final = Type(
    "mesh", "a mesh", "load one from a file by `fromFile(path)`, or make it with trimesh", kinds=frozenset()
)
POLYGON: Final = Type(
    "polygon", "a polygon of shapely", "or give the points as one list", kinds=frozenset({"region"})
)
POLYLINE: Final = Type(
    "line string", "a line string of shapely", "or give the points as one list", kinds=frozenset()
)
VIEW_ANGLES: Final = Type("pair of angles", "a pair of angles", "write two angles, as `(90 deg, 45 deg)`")


def listed(types: Sequence[Type]) -> str:
    """Write types in the words of the documentation: ``vector or region``."""
    return _alternatives([each.name for each in types])


def wanted(types: Sequence[Type]) -> tuple[str, str | None]:
    """Return the noun of several types, any of which will do, and the advice of all of them."""
    noun = _alternatives([each.noun for each in types])
    if len(types) == 1:
        return noun, types[0].advice or None
    return noun, "; ".join(f"{each.noun}: {each.advice}" for each in types)


def _alternatives(words: Sequence[str]) -> str:
    return " or ".join(filter(None, (", ".join(words[:-1]), words[-1])))
