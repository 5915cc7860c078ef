"""The specifiers of ``new`` and ``override``, as data (section 6.2 of the specification).

The names are those of ``SpecifierPhrase.specifier`` in the tree and of the first argument of the prelude's ``specifier``;
the operands stand in the order declared here. How a specifier computes its values is the runtime's business; what it
specifies, and how strongly, is declared here once for all.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.operators import EGO, Function, Operand, label
from scenic.language.types import (
    ANYTHING,
    DIRECTION,
    FIELD,
    HEADING,
    OBJECT,
    ORIENTED_POINT,
    POINT,
    REGION,
    SCALAR,
    VECTOR,
)

__all__ = ["SPECIFIERS", "Specified", "SpecifierDeclaration"]


@dataclass(frozen=True, slots=True)
class Specified:
    """One property that a specifier gives a value.

    ``priority``: 1 is the strongest. ``when`` says in words under which condition it is given at all; ``None``
    means always.
    """

    property: str
    priority: int
    when: str | None = None


@dataclass(frozen=True, slots=True)
class SpecifierDeclaration:
    """One specifier.

    ``specifies`` is empty for ``with``, which specifies the property that it names. ``modifies`` are the properties
    whose value, given by another specifier, this one may adjust. ``needs`` are the properties of the new object that
    the value always depends on; more may follow from the operands. ``group`` says which half of the object's pose it
    gives, for ordering documentation and completion: ``"position"``, ``"orientation"`` or ``"general"``.
    ``needs_beside_vector`` are the properties that the value needs if the first operand is a mere position.
    ``reads_ego`` and ``reads_workspace`` tell whether the value depends on the ego, or on the workspace, whatever the
    operands are. ``functions`` are those of the established Python API.
    """

    name: str
    operands: tuple[Operand, ...]
    specifies: tuple[Specified, ...]
    needs: tuple[str, ...]
    group: str
    forms: tuple[str, ...]
    documentation: str
    modifies: tuple[str, ...] = ()
    available: bool = True
    needs_beside_vector: tuple[str, ...] = ()
    reads_ego: bool = False
    reads_workspace: bool = False
    functions: tuple[Function, ...] = ()

    @property
    def may_read_ego(self) -> bool:
        """Return whether the value may depend on the ego, though the text does not name it."""
        return self.reads_ego or any(operand.may_be_ego for operand in self.operands)

    def label(self, operand: Operand) -> str:
        """Return the specifier as messages about an operand name it."""
        return label(self.forms, self.operands, operand)


_PREFERRED = "the region has a preferred orientation"
_ORIENTED = "the reference is an oriented point or object"


def _beside(name: str, axis: str, extent: str, function: str) -> SpecifierDeclaration:
    return SpecifierDeclaration(
        name,
        (
            Operand("reference", (ORIENTED_POINT, VECTOR)),
            Operand("distance", (SCALAR, VECTOR), "no gap"),
        ),
        (Specified("position", 1), Specified("parentOrientation", 3, _ORIENTED)),
        (extent,),
        "position",
        (f"{name} reference", f"{name} reference by distance"),
        f"Places the object on the {axis} side of the reference, in the reference's frame, so that their bounding "
        "boxes are the given distance apart. Next to an object and without a distance they nearly touch.",
        needs_beside_vector=("orientation",),
        functions=(Function(f"{function}(pos, dist=None)"),),
    )


_ALL = (
    SpecifierDeclaration(
        "with",
        (Operand("value", (ANYTHING,)),),
        (),
        (),
        "general",
        ("with property value",),
        "Gives a property a value. A property that the class does not define is created.",
    ),
    SpecifierDeclaration(
        "at",
        (Operand("position", (VECTOR,)),),
        (Specified("position", 1),),
        (),
        "position",
        ("at position",),
        "Places the object's centre at a global position.",
        functions=(Function("At(pos)"),),
    ),
    SpecifierDeclaration(
        "in",
        (Operand("region", (REGION,)),),
        (Specified("position", 1), Specified("parentOrientation", 3, _PREFERRED)),
        (),
        "position",
        ("in region",),
        "Places the object's centre uniformly at random in a region, aligned with the region's preferred "
        "orientation if it has one.",
        functions=(Function("In(region)"),),
    ),
    SpecifierDeclaration(
        "contained in",
        (Operand("region", (REGION,)),),
        (
            Specified("position", 1),
            Specified("parentOrientation", 3, _PREFERRED),
            Specified("regionContainedIn", 1),
        ),
        (),
        "position",
        ("contained in region",),
        "Like `in`, but the whole object must lie in the region.",
        functions=(Function("ContainedIn(region)"),),
    ),
    SpecifierDeclaration(
        "on",
        (Operand("target", (REGION, OBJECT, VECTOR)),),
        (Specified("position", 1), Specified("parentOrientation", 2, _PREFERRED)),
        ("baseOffset", "contactTolerance", "onDirection"),
        "position",
        ("on target",),
        "Puts the object with its base on a surface: uniformly at random, or, together with another specifier "
        "of the position, at the projection of that position onto the surface. For an object the surface is its "
        "top surface.",
        modifies=("position",),
        functions=(Function("On(thing)"),),
    ),
    SpecifierDeclaration(
        "resting on",
        (Operand("target", (REGION, OBJECT, VECTOR)),),
        (
            Specified("position", 1),
            Specified("pitch", 1),
            Specified("roll", 1),
            Specified("yaw", 3),
            Specified("parentOrientation", 2, _PREFERRED),
        ),
        ("shape", "width", "length", "height", "contactTolerance", "onDirection"),
        "position",
        ("resting on target",),
        "Lets the object lie or stand on a surface, in one of the stable poses of its shape, each as likely as a throw ends in it, "
        "and with a uniformly random yaw. A place on the surface that no other specifier gives is below its centre of mass.",
        modifies=("position",),
        functions=(Function("RestingOn(thing)"),),
    ),
    SpecifierDeclaration(
        "offset by",
        (Operand("offset", (VECTOR,)),),
        (Specified("position", 1), Specified("parentOrientation", 3)),
        (),
        "position",
        ("offset by offset",),
        "Places the object at an offset from the ego, in the ego's frame.",
        reads_ego=True,
        functions=(Function("OffsetBy(offset)"),),
    ),
    SpecifierDeclaration(
        "offset along",
        (Operand("direction", (DIRECTION,), angle=True), Operand("offset", (VECTOR,))),
        (Specified("position", 1), Specified("parentOrientation", 3)),
        (),
        "position",
        ("offset along direction by offset",),
        "Places the object at an offset from the ego, in the frame of the direction.",
        reads_ego=True,
        functions=(Function("OffsetAlongSpec(direction, offset)"),),
    ),
    SpecifierDeclaration(
        "beyond",
        (
            Operand("reference", (VECTOR,)),
            Operand("offset", (SCALAR, VECTOR)),
            Operand("viewpoint", (ORIENTED_POINT, VECTOR), EGO),
        ),
        (Specified("position", 1), Specified("parentOrientation", 3)),
        (),
        "position",
        ("beyond reference by offset", "beyond reference by offset from viewpoint"),
        "Places the object behind the reference as seen from the viewpoint, on the line of sight.",
        functions=(Function("Beyond(pos, offset, fromPt=None)"),),
    ),
    SpecifierDeclaration(
        "visible",
        (Operand("viewer", (POINT,), EGO),),
        (Specified("position", 3),),
        ("regionContainedIn",),
        "position",
        ("visible", "visible from viewer"),
        "Requires that the viewer sees the object. Without another specifier of the position, the position is "
        "uniformly random among those where the viewer sees the object.",
        reads_workspace=True,
        functions=(
            Function("VisibleFrom(base)"),
            Function("VisibleSpec()"),
        ),
    ),
    SpecifierDeclaration(
        "not visible",
        (Operand("viewer", (POINT,), EGO),),
        (Specified("position", 3),),
        ("regionContainedIn",),
        "position",
        ("not visible", "not visible from viewer"),
        "Requires that the viewer does not see the object. Without another specifier of the position, the "
        "position is uniformly random in the object's container.",
        reads_workspace=True,
        functions=(
            Function("NotVisibleFrom(base)"),
            Function("NotVisibleSpec()"),
        ),
    ),
    _beside("left of", "left (-X)", "width", "LeftSpec"),
    _beside("right of", "right (+X)", "width", "RightSpec"),
    _beside("ahead of", "front (+Y)", "length", "Ahead"),
    _beside("behind", "back (-Y)", "length", "Behind"),
    _beside("above", "upper (+Z)", "height", "Above"),
    _beside("below", "lower (-Z)", "height", "Below"),
    SpecifierDeclaration(
        "following",
        (
            Operand("field", (FIELD,)),
            Operand("start", (VECTOR,), EGO),
            Operand("distance", (SCALAR,)),
        ),
        (Specified("position", 1), Specified("parentOrientation", 3)),
        (),
        "position",
        ("following field for distance", "following field from start for distance"),
        "Places the object at the point reached by following a vector field for a distance, aligned with the "
        "field there.",
        functions=(Function("Following(field, dist, fromPt=None)", "field fromPt dist"),),
    ),
    SpecifierDeclaration(
        "facing",
        (Operand("direction", (DIRECTION,), angle=True),),
        (Specified("yaw", 1), Specified("pitch", 1), Specified("roll", 1)),
        ("parentOrientation",),
        "orientation",
        ("facing direction",),
        "Turns the object to a global orientation. A number is a heading in radians: write `90 deg` for degrees.",
        functions=(Function("Facing(heading)"),),
    ),
    SpecifierDeclaration(
        "facing toward",
        (Operand("target", (VECTOR,)),),
        (Specified("yaw", 1),),
        ("position", "parentOrientation"),
        "orientation",
        ("facing toward target",),
        "Turns the object's front toward a position, by its yaw alone: it stays upright.",
        functions=(Function("FacingToward(pos)"),),
    ),
    SpecifierDeclaration(
        "facing away from",
        (Operand("target", (VECTOR,)),),
        (Specified("yaw", 1),),
        ("position", "parentOrientation"),
        "orientation",
        ("facing away from target",),
        "Turns the object's front away from a position, by its yaw alone: it stays upright.",
        functions=(Function("FacingAwayFrom(pos)"),),
    ),
    SpecifierDeclaration(
        "facing directly toward",
        (Operand("target", (VECTOR,)),),
        (Specified("yaw", 1), Specified("pitch", 1)),
        ("position", "parentOrientation"),
        "orientation",
        ("facing directly toward target",),
        "Points the object's front exactly at a position, by yaw and pitch.",
        functions=(Function("FacingDirectlyToward(pos)"),),
    ),
    SpecifierDeclaration(
        "facing directly away from",
        (Operand("target", (VECTOR,)),),
        (Specified("yaw", 1), Specified("pitch", 1)),
        ("position", "parentOrientation"),
        "orientation",
        ("facing directly away from target",),
        "Points the object's front exactly away from a position, by yaw and pitch.",
        functions=(Function("FacingDirectlyAwayFrom(pos)"),),
    ),
    SpecifierDeclaration(
        "apparently facing",
        (Operand("heading", (HEADING,), angle=True), Operand("viewpoint", (VECTOR,), EGO)),
        (Specified("yaw", 1),),
        ("position", "parentOrientation"),
        "orientation",
        ("apparently facing heading", "apparently facing heading from viewpoint"),
        "Turns the object to a heading that is measured from the line of sight of the viewpoint.",
        functions=(Function("ApparentlyFacing(heading, fromPt=None)"),),
    ),
)

SPECIFIERS: Final[Mapping[str, SpecifierDeclaration]] = MappingProxyType(
    {specifier.name: specifier for specifier in _ALL}
)
"""Every specifier by its name in the tree."""
