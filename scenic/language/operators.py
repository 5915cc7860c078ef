"""The operators that Scenic adds to Python's, as data.

The names are those of ``Operation.operator`` in the tree and of the first argument of the prelude's ``operation``;
the operands stand in the order declared here. An operand with a default may be left out of the text and is then
``None`` in the tree.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.types import (
    DIRECTION,
    FIELD,
    HEADING_OR_ANGLES,
    OBJECT,
    ORIENTATION,
    ORIENTED_POINT,
    POINT,
    REGION,
    SCALAR,
    SCALAR_OR_VECTOR,
    VECTOR,
    Type,
    listed,
)

__all__ = ["EGO", "FRAMES", "OPERATORS", "SIDES", "Function", "Operand", "Operator", "label"]


@dataclass(frozen=True, slots=True)
class Operand:
    """One operand of an operator or specifier.

    ``types`` are the types that it may have; the first that fits is taken. ``default`` says in words what is meant when
    the text leaves the operand out; ``None`` when it may not. ``angle`` tells whether a plain number, and each in a
    tuple, is read as an angle in radians.
    """

    name: str
    types: tuple[Type, ...]
    default: str | None = None
    angle: bool = False

    @property
    def type(self) -> str:
        """The types in words, for documentation."""
        return listed(self.types)

    @property
    def may_be_ego(self) -> bool:
        """Return whether the ego is meant where the operand is left out."""
        return self.default == EGO


@dataclass(frozen=True, slots=True)
class Function:
    """A function of the established Python API that does what an operator or specifier does.

    ``operands`` are the parameters that stand for the operands, in order, ``-`` where none does; by default those of the
    signature. Operands for which no parameter stands are left out.
    """

    signature: str
    operands: str | None = None

    @property
    def name(self) -> str:
        """The name of the function."""
        return self.signature.partition("(")[0]

    @property
    def parameters(self) -> Mapping[str, bool]:
        """The parameters in order; true for those that may be left out."""
        inside = self.signature.partition("(")[2].removesuffix(")")
        return {part.partition("=")[0]: "=" in part for part in inside.split(", ") if part}


@dataclass(frozen=True, slots=True)
class Operator:
    """One operator: its name in the tree, its operands in order, and what a reader should know.

    ``forms`` are all ways to write it, operands by their names. ``available`` tells whether this version builds it;
    a program that uses an operator that is not available is refused where it stands. ``angle`` tells whether the result
    is an angle in radians. ``reads_scene`` tells whether the result depends on more than the operands: on the other objects,
    or on the simulation that runs. ``functions`` are those of the established Python API.
    """

    name: str
    operands: tuple[Operand, ...]
    result: str
    forms: tuple[str, ...]
    documentation: str
    available: bool = True
    angle: bool = False
    reads_scene: bool = False
    functions: tuple[Function, ...] = ()

    @property
    def may_read_ego(self) -> bool:
        """Return whether some operand may be left out and then is the ego."""
        return any(operand.may_be_ego for operand in self.operands)

    def label(self, operand: Operand) -> str:
        """Return the operator as messages about an operand name it; see `label`."""
        return label(self.forms, self.operands, operand)


def label(forms: Sequence[str], operands: Sequence[Operand], operand: Operand) -> str:
    """Return an operator or specifier as messages about an operand name it: its first words, and those before the operand.

    The words that follow an operand name it where the text begins with it.
    """
    names = {each.name for each in operands}
    words = next(form.split() for form in forms if operand.name in form.split())
    # A keyword of the same name stands before its operand: `offset by offset`.
    places = {number for number, word in enumerate(words) if word in names - set(words[number + 1 :])}
    end = max(number for number in places if words[number] == operand.name)
    if end == 0:
        end = min(places - {0}, default=len(words))
    runs: list[list[str]] = [[]]
    for number in range(1 if 0 in places else 0, end):
        if number in places:
            runs.append([])
        else:
            runs[-1].append(words[number])
    return f"`{' ... '.join(' '.join(run) for run in (runs if len(runs) < 3 else [runs[0], runs[-1]]))}`"


EGO: Final = "the ego"
"""The default of most operands that may be left out."""

SIDES: Final = (
    "front",
    "back",
    "left",
    "right",
    "top",
    "bottom",
    "front left",
    "front right",
    "back left",
    "back right",
    "top front left",
    "top front right",
    "top back left",
    "top back right",
    "bottom front left",
    "bottom front right",
    "bottom back left",
    "bottom back right",
)
"""The sides of an object's bounding box that have an operator ``<side> of``."""


FRAMES: Final = (FIELD, ORIENTED_POINT, SCALAR, ORIENTATION, VECTOR)
"""Types of the operands of `relative to` and `offset by`."""


def _side(side: str) -> Operator:
    part = {1: "middle of the face", 2: "middle of the edge", 3: "corner"}[len(side.split())]
    return Operator(
        f"{side} of",
        (Operand("object", (OBJECT,)),),
        "oriented point",
        (f"{side} of object",),
        f"The {part} at the {side} of the object's bounding box, with the orientation of the object.",
        functions=(Function(f"{side.title().replace(' ', '')}(X)"),),
    )


def _direction(words: str, condition: str) -> Operator:
    return Operator(
        f"is {words}",
        (Operand("target", (VECTOR,)), Operand("base", (ORIENTED_POINT,))),
        "boolean",
        (f"target {words} base",),
        f"True if the apparent heading to the target from the base is {condition}. On a border, within a "
        "hundredth of a degree, neither this operator nor the opposite one is true.",
    )


_ALL = (
    Operator(
        "deg",
        (Operand("angle", (SCALAR_OR_VECTOR,)),),
        "as the operand",
        ("angle deg",),
        "An angle given in degrees, or a vector of such angles, converted to radians. It applies to everything "
        "multiplied on its left: `2 * x deg` is `(2 * x) deg`.",
    ),
    Operator(
        "@",
        (Operand("x", (SCALAR,)), Operand("y", (SCALAR,))),
        "vector",
        ("x @ y",),
        "The vector with these two coordinates and `z = 0`.",
    ),
    Operator(
        "at",
        (Operand("field", (FIELD,)), Operand("position", (VECTOR,))),
        "orientation",
        ("field at position",),
        "The orientation that a vector field has at a position.",
        functions=(Function("FieldAt(X, Y)"),),
    ),
    Operator(
        "relative to",
        (
            Operand("value", FRAMES),
            Operand("base", FRAMES),
        ),
        "the type of the operands",
        ("value relative to base",),
        "The first operand read in the frame of the second: headings and orientations are composed, vectors are "
        "added, and a vector relative to an oriented point is an oriented point at that offset.",
        functions=(Function("RelativeTo(X, Y)"),),
    ),
    Operator(
        "offset by",
        (Operand("base", FRAMES), Operand("offset", FRAMES)),
        "the type of the operands",
        ("base offset by offset",),
        "The same as `relative to`, but more natural to read for vectors.",
    ),
    Operator(
        "offset along",
        (
            Operand("position", (VECTOR,)),
            Operand("direction", (DIRECTION,), angle=True),
            Operand("offset", (VECTOR,)),
        ),
        "vector",
        ("position offset along direction by offset",),
        "A position moved by an offset that is given in the frame of the direction.",
        functions=(Function("OffsetAlong(X, H, Y)"),),
    ),
    Operator(
        "relative position",
        (Operand("target", (VECTOR,)), Operand("base", (VECTOR,), EGO)),
        "vector",
        ("relative position of target", "relative position of target from base"),
        "The vector from the base to the target, in global coordinates.",
        functions=(Function("RelativePosition(X, Y=None)"),),
    ),
    Operator(
        "relative heading",
        (
            Operand("heading", (HEADING_OR_ANGLES,), angle=True),
            Operand("base", (HEADING_OR_ANGLES,), EGO, angle=True),
        ),
        "scalar",
        ("relative heading of heading", "relative heading of heading from base"),
        "The difference of two global headings, between -pi and pi.",
        angle=True,
        functions=(Function("RelativeHeading(X, Y=None)"),),
    ),
    Operator(
        "apparent heading",
        (Operand("target", (ORIENTED_POINT,)), Operand("viewpoint", (VECTOR,), EGO)),
        "scalar",
        ("apparent heading of target", "apparent heading of target from viewpoint"),
        "The heading of the target relative to the line of sight from the viewpoint.",
        angle=True,
        functions=(Function("ApparentHeading(X, Y=None)"),),
    ),
    Operator(
        "apparent heading to",
        (Operand("target", (VECTOR,)), Operand("viewer", (ORIENTED_POINT,), EGO)),
        "scalar",
        ("apparent heading to target", "apparent heading to target from viewer"),
        "The heading of the line from the viewer to the target, relative to the heading of the viewer: 0 is straight "
        "ahead, and it grows anticlockwise up to pi.",
        angle=True,
    ),
    Operator(
        "distance",
        (Operand("start", (VECTOR, REGION), EGO), Operand("end", (VECTOR, REGION), EGO)),
        "scalar",
        (
            "distance to end",
            "distance from start",
            "distance from start to end",
            "distance to end from start",
        ),
        "The straight distance between two points, or between a point and a region. An object counts as its "
        "position; see `minimum distance` for its extent.",
        functions=(Function("DistanceFrom(X, Y=None)"),),
    ),
    Operator(
        "minimum distance",
        (Operand("start", (OBJECT,), EGO), Operand("end", (OBJECT,), EGO)),
        "scalar",
        (
            "minimum distance to end",
            "minimum distance from start",
            "minimum distance from start to end",
            "minimum distance to end from start",
        ),
        "The smallest distance between the spaces that two objects occupy; 0 if they touch.",
    ),
    Operator(
        "distance past",
        (Operand("target", (VECTOR,)), Operand("base", (ORIENTED_POINT,), EGO)),
        "scalar",
        ("distance past target", "distance past target of base"),
        "The distance by which the base is ahead of the target, measured along the heading of the base.",
        functions=(Function("DistancePast(X, Y=None)"),),
    ),
    Operator(
        "angle",
        (Operand("start", (VECTOR,), EGO), Operand("end", (VECTOR,), EGO)),
        "scalar",
        ("angle to end", "angle from start", "angle from start to end", "angle to end from start"),
        "The heading of the line from one position to another: 0 is North (+Y), and it grows anticlockwise.",
        angle=True,
        functions=(
            Function("AngleFrom(X=None, Y=None)"),
            Function("AngleTo(X)", "- X"),
        ),
    ),
    Operator(
        "altitude",
        (Operand("start", (VECTOR,), EGO), Operand("end", (VECTOR,), EGO)),
        "scalar",
        (
            "altitude to end",
            "altitude from start",
            "altitude from start to end",
            "altitude to end from start",
        ),
        "The angle of the line from one position to another above the horizontal plane.",
        angle=True,
        functions=(
            Function("AltitudeFrom(X=None, Y=None)"),
            Function("AltitudeTo(X)", "- X"),
        ),
    ),
    Operator(
        "follow",
        (Operand("field", (FIELD,)), Operand("start", (VECTOR,)), Operand("distance", (SCALAR,))),
        "oriented point",
        ("follow field from start for distance",),
        "The point reached by following a vector field for a distance, with the orientation of the field there.",
        functions=(Function("Follow(F, X, D)"),),
    ),
    Operator(
        "visible",
        (Operand("region", (REGION,)), Operand("viewer", (POINT,), EGO)),
        "region",
        ("visible region", "region visible from viewer"),
        "The part of a region that the viewer's view volume covers; occlusion is ignored.",
        functions=(
            Function("Visible(region)"),
            Function("VisibleFromOp(region, base)"),
        ),
    ),
    Operator(
        "not visible",
        (Operand("region", (REGION,)), Operand("viewer", (POINT,), EGO)),
        "region",
        ("not visible region", "region not visible from viewer"),
        "The part of a region that the viewer's view volume does not cover; occlusion is ignored.",
        functions=(
            Function("NotVisible(region)"),
            Function("NotVisibleFromOp(region, base)"),
        ),
    ),
    Operator(
        "can see",
        (Operand("viewer", (POINT,)), Operand("target", (VECTOR, POINT))),
        "boolean",
        ("viewer can see target",),
        "True if the viewer sees the target past the other objects. For requirements and dynamic code only.",
        reads_scene=True,
        functions=(Function("CanSee(X, Y)"),),
    ),
    Operator(
        "intersects",
        (Operand("first", (OBJECT, REGION)), Operand("second", (OBJECT, REGION))),
        "boolean",
        ("first intersects second",),
        "True if two objects or regions share a point.",
        functions=(Function("Intersects(X, Y)"),),
    ),
    *(
        _direction(words, condition)
        for words, condition in (
            ("ahead of", "less than 90 degrees to either side"),
            ("behind", "more than 90 degrees to either side"),
            ("left of", "on the left"),
            ("right of", "on the right"),
        )
    ),
    Operator(
        "initial scenario",
        (),
        "boolean",
        ("initial scenario",),
        "True while the top-level scenario is set up, false in scenarios that start later.",
        reads_scene=True,
    ),
    *(_side(side) for side in SIDES),
)

OPERATORS: Final[Mapping[str, Operator]] = MappingProxyType({operator.name: operator for operator in _ALL})
"""Every operator by its name in the tree."""
