"""The built-in classes, their properties and their derived attributes, as data (section 5.1 of the specification).

Defaults are given as text for readers; the runtime computes them.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.language.types import (
    BEHAVIOR,
    BOOLEAN,
    COLOR,
    NONE,
    ORIENTATION,
    REGION,
    SCALAR,
    SHAPE,
    VECTOR,
    Type,
    listed,
)

__all__ = [
    "CLASSES",
    "PROPERTY_ATTRIBUTES",
    "Attribute",
    "BuiltinClass",
    "BuiltinProperty",
    "ConstantDefault",
    "attributes_of",
    "properties_of",
]


@dataclass(frozen=True, slots=True)
class ConstantDefault:
    """A default that is the same for every instance; ``text`` is how a program writes it, where that is not ``repr``."""

    value: Any
    text: str = ""


@dataclass(frozen=True, slots=True)
class BuiltinProperty:
    """One property as one built-in class defines it.

    Its value has any of ``types``. ``given`` is the default: a constant, or the words of the manual for one that the runtime
    computes. ``needs`` are the properties that the default reads. ``unit`` is that of the numbers in the value, where they have one.
    ``positive`` tells whether the number must be greater than 0.
    """

    name: str
    types: tuple[Type, ...]
    given: ConstantDefault | str
    documentation: str
    needs: tuple[str, ...] = ()
    dynamic: bool = False
    final: bool = False
    additive: bool = False
    unit: str = ""
    positive: bool = False

    @property
    def angle(self) -> bool:
        """Return whether numbers in the value are angles, in radians."""
        return self.unit == "rad"

    @property
    def type(self) -> str:
        """The types in words, for documentation."""
        return listed(self.types)

    @property
    def default(self) -> str:
        """The default in the words of the manual."""
        if isinstance(self.given, str):
            return self.given
        return self.given.text or repr(self.given.value)


@dataclass(frozen=True, slots=True)
class Attribute:
    """An attribute or method that instances have without its being a property: it cannot be specified.

    ``yields``: unless a class defines a property of the same name, which is then meant.
    """

    name: str
    type: str
    documentation: str
    is_method: bool = False
    yields: bool = False


@dataclass(frozen=True, slots=True)
class BuiltinClass:
    """A built-in class: what it defines itself, in order; what it inherits comes from ``base``."""

    name: str
    base: str | None
    documentation: str
    properties: tuple[BuiltinProperty, ...]
    attributes: tuple[Attribute, ...]


PROPERTY_ATTRIBUTES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "additive": "The value collects the definitions of all classes along the inheritance chain in a tuple, "
        "the most derived first.",
        "dynamic": "During a simulation the value is read from the simulator at every step.",
        "final": "The value always follows from its definition: it can be neither specified nor defined again.",
    }
)
"""Words for the brackets of a property definition."""


def _P(
    name: str,
    types: Type | tuple[Type, ...],
    default: object,
    documentation: str,
    needs: tuple[str, ...] = (),
    *,
    shown: str = "",
    **rest: Any,
) -> BuiltinProperty:
    """Return a property; a default that is not words is a constant, which the manual shows as ``shown``."""
    default_value = default if isinstance(default, str) else ConstantDefault(default, shown)
    types = types if isinstance(types, tuple) else (types,)
    return BuiltinProperty(name, types, default_value, documentation, needs, **rest)


def _method(name: str, result: str, documentation: str) -> Attribute:
    return Attribute(name, result, documentation, is_method=True)


def _words(name: str) -> Type:
    """Return a type whose values the text of a program does not show."""
    return Type(name, name)


_POINT = BuiltinClass(
    "Point",
    None,
    "A position in space.",
    (
        _P("position", VECTOR, (0, 0, 0), "Global position, in metres.", dynamic=True, unit="m"),
        _P("width", SCALAR, 0, "Extent along the local X axis; points have none.", unit="m"),
        _P("length", SCALAR, 0, "Extent along the local Y axis; points have none.", unit="m"),
        _P("height", SCALAR, 0, "Extent along the local Z axis; points have none.", unit="m"),
        _P(
            "baseOffset",
            VECTOR,
            (0, 0, 0),
            "The base point, relative to the position, that `on` puts on a surface.",
            unit="m",
        ),
        _P(
            "contactTolerance",
            SCALAR,
            0,
            "The small gap that `on` and the directional specifiers leave, in metres.",
            unit="m",
        ),
        _P(
            "onDirection",
            (VECTOR, NONE),
            None,
            "The direction in which `on` projects a position onto a surface.",
        ),
        _P(
            "viewAngles",
            _words("pair of scalars"),
            (2 * math.pi, math.pi),
            "Horizontal and vertical angle of view.",
            shown="(360 deg, 180 deg)",
            unit="rad",
        ),
        _P("visibleDistance", SCALAR, 50, "Range of the view, in metres.", unit="m"),
        _P(
            "viewRayDensity",
            SCALAR,
            5,
            "Rays per degree, in each dimension, with which visibility is tested.",
        ),
        _P(
            "viewRayCount", (_words("pair of integers"), NONE), None, "Numbers of rays, instead of a density."
        ),
        _P(
            "viewRayDistanceScaling",
            BOOLEAN,
            False,
            "True if more rays are cast towards more distant things.",
        ),
        _P(
            "regionContainedIn",
            (REGION, NONE),
            None,
            "The region that must contain it; `None` means the workspace.",
        ),
        _P("mutationScale", SCALAR, 0, "Factor of the noise that mutation adds; 0 means none."),
        _P(
            "positionStdDev",
            VECTOR,
            (1, 1, 0),
            "Standard deviation of the noise on the position, per axis.",
            unit="m",
        ),
        _P(
            "mutator",
            _words("tuple of mutators"),
            "a position mutator",
            "What adds the noise.",
            ("positionStdDev",),
            additive=True,
        ),
    ),
    (_method("toVector", "vector", "The position."),),
)

_ORIENTED_POINT = BuiltinClass(
    "OrientedPoint",
    "Point",
    "A position in space with an orientation.",
    (
        _P(
            "yaw",
            SCALAR,
            0,
            "Rotation about the Z axis of the parent orientation, in radians.",
            dynamic=True,
            unit="rad",
        ),
        _P(
            "pitch",
            SCALAR,
            0,
            "Rotation about the X axis after the yaw, in radians.",
            dynamic=True,
            unit="rad",
        ),
        _P(
            "roll",
            SCALAR,
            0,
            "Rotation about the Y axis after yaw and pitch, in radians.",
            dynamic=True,
            unit="rad",
        ),
        _P(
            "parentOrientation",
            ORIENTATION,
            "no rotation",
            "The frame in which yaw, pitch and roll are read.",
        ),
        _P(
            "orientation",
            ORIENTATION,
            "parentOrientation turned by yaw, pitch, roll",
            "Global orientation.",
            ("yaw", "pitch", "roll", "parentOrientation"),
            dynamic=True,
            final=True,
        ),
        _P(
            "heading",
            SCALAR,
            "orientation.yaw",
            "Global yaw, in radians: 0 is North (+Y), growing anticlockwise.",
            ("orientation",),
            dynamic=True,
            final=True,
            unit="rad",
        ),
        _P(
            "viewAngle",
            SCALAR,
            2 * math.pi,
            "Horizontal angle of view; the older form of `viewAngles`.",
            shown="360 deg",
            unit="rad",
        ),
        _P(
            "viewAngles",
            _words("pair of scalars"),
            "(viewAngle, 180 deg)",
            "Horizontal and vertical angle of view.",
            ("viewAngle",),
            unit="rad",
        ),
        _P(
            "headingStdDev",
            SCALAR,
            math.radians(5),
            "Standard deviation of the noise on the yaw.",
            shown="5 deg",
            unit="rad",
        ),
        _P(
            "orientationStdDev",
            VECTOR,
            "(headingStdDev, 0, 0)",
            "Standard deviations of the noise on yaw, pitch and roll.",
            ("headingStdDev",),
            unit="rad",
        ),
        _P(
            "mutator",
            _words("tuple of mutators"),
            "an orientation mutator, then the point's",
            "What adds the noise.",
            ("orientationStdDev",),
            additive=True,
        ),
    ),
    (
        _method("toHeading", "scalar", "The global yaw."),
        _method("toOrientation", "orientation", "The global orientation."),
        _method("relativize", "oriented point", "The oriented point at an offset given in this frame."),
        _method("relativePosition", "vector", "The global position of an offset given in this frame."),
        _method(
            "distancePast", "scalar", "The distance by which this is ahead of a point, along its heading."
        ),
    ),
)

_SIDES: Final = (
    ("left", "right", "front", "back", "top", "bottom"),
    ("frontLeft", "frontRight", "backLeft", "backRight"),
    tuple(
        f"{end}{face}{side}"
        for end in ("top", "bottom")
        for face in ("Front", "Back")
        for side in ("Left", "Right")
    ),
)
_PLACES: Final = ("The middle of this face", "The middle of this edge", "This corner")

_OBJECT = BuiltinClass(
    "Object",
    "OrientedPoint",
    "A physical object: a shape with a size, in a place, that collides with others. The base of classes without bases.",
    (
        _P("shape", SHAPE, "BoxShape()", "The form, apart from its size and place."),
        _P(
            "width",
            SCALAR,
            "shape.width",
            "Extent of the bounding box along the local X axis.",
            ("shape",),
            positive=True,
        ),
        _P(
            "length",
            SCALAR,
            "shape.length",
            "Extent of the bounding box along the local Y axis.",
            ("shape",),
            positive=True,
        ),
        _P(
            "height",
            SCALAR,
            "shape.height",
            "Extent of the bounding box along the local Z axis.",
            ("shape",),
            positive=True,
        ),
        _P(
            "present",
            BOOLEAN,
            True,
            "True if the object is in the scene; random for a random number of objects.",
        ),
        _P("allowCollisions", BOOLEAN, False, "True if it may overlap other objects."),
        _P(
            "regionContainedIn",
            (REGION, NONE),
            None,
            "The region that must contain it; `None` means the workspace.",
        ),
        _P(
            "baseOffset",
            VECTOR,
            "(0, 0, -height / 2)",
            "The base point that `on` puts on a surface.",
            ("height",),
        ),
        _P(
            "contactTolerance",
            SCALAR,
            1e-4,
            "The small gap that `on` and the directional specifiers leave.",
            shown="1e-4",
        ),
        _P(
            "sideComponentThresholds",
            _words("three pairs of scalars"),
            ((-0.5, 0.5),) * 3,
            "Limits of the components of a normal, per axis, beyond which a face belongs to the surface of a side.",
            shown="((-0.5, 0.5),) * 3",
        ),
        _P("cameraOffset", VECTOR, (0, 0, 0), "The position of its eye, in its own frame."),
        _P(
            "visionSensorOffset",
            VECTOR,
            "(0, length / 2, 0)",
            "The default position of its vision sensors, in its own frame.",
            ("length",),
        ),
        _P("requireVisible", BOOLEAN, False, "True if the ego must see it."),
        _P("occluding", BOOLEAN, True, "True if it hides things behind it."),
        _P("showVisibleRegion", BOOLEAN, False, "True if pictures show its view volume."),
        _P("color", (COLOR, NONE), None, "Colour in pictures: red, green, blue, opacity."),
        _P("render", BOOLEAN, True, "Whether pictures show it."),
        _P(
            "velocity",
            VECTOR,
            "(0, speed, 0) turned by orientation",
            "Velocity at the start of a simulation.",
            ("speed", "orientation"),
            dynamic=True,
            unit="m/s",
        ),
        _P("speed", SCALAR, 0, "Speed at the start of a simulation.", dynamic=True, unit="m/s"),
        _P(
            "angularVelocity",
            VECTOR,
            (0, 0, 0),
            "Angular velocity at the start of a simulation.",
            dynamic=True,
            unit="rad/s",
        ),
        _P(
            "angularSpeed",
            SCALAR,
            0,
            "Angular speed at the start of a simulation.",
            dynamic=True,
            unit="rad/s",
        ),
        _P("behavior", (BEHAVIOR, NONE), None, "Its behavior in simulations."),
        _P(
            "lastActions",
            _words("tuple of actions"),
            (),
            "The actions that it took last; empty while it decides.",
        ),
        _P("sensors", _words("dictionary of sensors"), {}, "Its sensors by name."),
        _P("observations", _words("dictionary"), {}, "The latest observation of each sensor.", final=True),
    ),
    (
        *(
            Attribute(name, "oriented point", f"{place} of the bounding box, oriented like the object.")
            for names, place in zip(_SIDES, _PLACES, strict=True)
            for name in names
        ),
        Attribute("corners", "tuple of vectors", "The eight corners of the bounding box."),
        Attribute("hw", "scalar", "Half the width.", yields=True),
        Attribute("hl", "scalar", "Half the length.", yields=True),
        Attribute("hh", "scalar", "Half the height.", yields=True),
        Attribute("radius", "scalar", "Half the diagonal of the bounding box.", yields=True),
        Attribute(
            "inradius", "scalar", "A distance from the position within which everything is inside the object."
        ),
        Attribute("planarInradius", "scalar", "The same within the footprint."),
        Attribute("visibleRegion", "region", "The volume that it sees if nothing occludes it."),
        Attribute("occupiedSpace", "region", "The volume that it fills."),
        Attribute("boundingBox", "region", "The box along the global axes around the volume that it fills."),
        Attribute("surface", "region", "The whole surface."),
        Attribute(
            "onSurface",
            "region",
            "The surface for things placed `on` this object; the top surface unless a class overrides it.",
        ),
        *(
            Attribute(f"{side}Surface", "region", f"The part of the surface on the {side}.")
            for side in _SIDES[0]
        ),
        _method("intersects", "boolean", "True if it shares a point with an object or region."),
        _method("containsPoint", "boolean", "True if a point is inside."),
        _method("distanceTo", "scalar", "Distance from the position to a point."),
        _method("canSee", "boolean", "True if it sees a point or an object."),
        _method("startDynamicSimulation", "None", "Called when the object is created in a simulation."),
    ),
)

CLASSES: Final[Mapping[str, BuiltinClass]] = MappingProxyType(
    {cls.name: cls for cls in (_POINT, _ORIENTED_POINT, _OBJECT)}
)
"""The built-in classes, bases first."""


def properties_of(cls: str) -> Mapping[str, BuiltinProperty]:
    """All properties of a built-in class by name, its own definitions before those it inherits."""
    declared = CLASSES[cls]
    found = {} if declared.base is None else dict(properties_of(declared.base))
    found.update((entry.name, entry) for entry in declared.properties)
    return MappingProxyType(found)


def attributes_of(cls: str) -> Mapping[str, Attribute]:
    """All derived attributes and methods of a built-in class by name."""
    declared = CLASSES[cls]
    found = {} if declared.base is None else dict(attributes_of(declared.base))
    found.update((entry.name, entry) for entry in declared.attributes)
    return MappingProxyType(found)
