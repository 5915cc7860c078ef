"""The built-in classes `Point`, `OrientedPoint` and `Object`, from which all classes of programs derive.

An instance made by the program holds values, definite or random, of its properties in its ``__dict__``. A sampled instance
(in a scene, or inside a requirement's condition) is a second object of the same class, which takes each value from the
sample when it is first read: most values of most scenes are never looked at.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from copy import deepcopy
from types import MappingProxyType
from typing import Any, ClassVar, Self

from scenic.graph.kinds import Kind
from scenic.language.errors import InvalidScenarioError
from scenic.language.properties import CLASSES, BuiltinProperty, ConstantDefault
from scenic.language.types import VECTOR
from scenic.runtime.geometry.contact.scalar_bodies import meet
from scenic.runtime.ground.context import here
from scenic.runtime.instances.mutators import OrientationMutator, PositionMutator
from scenic.runtime.instances.properties import ATTRIBUTES, Property, PropertyDefinition, combine, update
from scenic.runtime.regions import generic
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.body_regions import (
    OccupiedSpace,
    SideSurface,
    bounding_corners,
    inradius,
    planar_inradius,
)
from scenic.runtime.regions.planar_visibility import sees_in_plane
from scenic.runtime.regions.stacked import placed_of
from scenic.runtime.regions.view_regions import ViewRegion
from scenic.runtime.regions.visibility_nodes import occluders_of, sees
from scenic.runtime.regions.volumes import BoxRegion
from scenic.runtime.shapes.shapes import BoxShape
from scenic.runtime.values.class_members import bind
from scenic.runtime.values.generic import sample_of
from scenic.runtime.values.instance_base import PLACEMENT, Instance, put
from scenic.runtime.values.values import (
    Orientation,
    operate,
    per_option,
    to_orientation,
    to_scalar,
    to_vector,
    vector,
)


def _definitions(name: str, computed: Mapping[str, Callable[[Any], Any]]) -> dict[str, PropertyDefinition]:
    """Return the properties of a built-in class as declared in `scenic.language.properties`; ``computed`` are the defaults that vary."""
    return {
        each.name: PropertyDefinition(
            each.name,
            frozenset(word for word in ATTRIBUTES if getattr(each, word)),
            _constant(each) if isinstance(each.given, ConstantDefault) else computed[each.name],
            each.needs,
            is_builtin=True,
        )
        for each in CLASSES[name].properties
    }


def _constant(declared: BuiltinProperty) -> Callable[[Any], Any]:
    """Return the function of a constant default: a new object for each instance where it can be changed."""
    assert isinstance(declared.given, ConstantDefault)
    value = declared.given.value
    if declared.types == (VECTOR,):
        return lambda _: vector(*value)
    return (lambda _: dict(value)) if isinstance(value, dict) else lambda _: value


def _combine_properties(cls: type["Point"]) -> None:
    chain = [base.__dict__["_definitions"] for base in cls.__mro__ if "_definitions" in base.__dict__]
    cls.scenic_properties = MappingProxyType(combine(chain))
    cls._resolutions = {}
    # Instances without dictionaries take half the time and memory. They share the names that the first of them has, which
    # has to come before any with a dictionary: CPython (3.11 on) gives up names that nobody has used by then.
    first: Any = object.__new__(cls)
    first._source = first._sample = None
    with suppress(AttributeError):  # of a class that hides a property, which is refused when it is used
        put(first, (None,) * len(PLACEMENT))


class Point(Instance):
    """A position in space."""

    scenic_kind: ClassVar[Kind] = Kind.OBJECT
    scenic_properties: ClassVar[Mapping[str, Property]]
    """All properties of the class, with what their definitions combine to."""
    _resolutions: ClassVar[dict[Any, Any]]
    """Cached resolutions of combinations of specifiers; see `scenic.runtime.elements.resolution`."""
    _definitions: ClassVar[Mapping[str, PropertyDefinition]] = _definitions(
        "Point",
        {
            "mutator": lambda self: PositionMutator(self.positionStdDev),
        },
    )

    def __new__(cls, *_args: Any, **_kwargs: Any) -> Self:
        raise InvalidScenarioError(
            f"{cls.__name__} is a Scenic class and cannot be called",
            code="SC111",
            span=here(),
            help=f"create an instance with `new {cls.__name__}`",
        )

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if cls.__module__ != Point.__module__:
            bind(cls, Point)
        definitions: tuple[PropertyDefinition, ...] = cls.__dict__.get("__scenic_properties__", ())
        if definitions or "_definitions" not in cls.__dict__:
            cls._definitions = {definition.name: definition for definition in definitions}
            if len(cls._definitions) < len(definitions):
                # Only in 2D mode: the compiler refuses a property that is written twice.
                raise InvalidScenarioError(
                    "`heading` and `parentOrientation` mean the same in 2D mode",
                    span=definitions[-1].span,
                    help="define one of the two",
                )
        _combine_properties(cls)

    @classmethod
    def _make(cls, values: Mapping[str, object]) -> Self:
        """Return an instance with these property values; for the runtime, not for programs."""
        instance = object.__new__(cls)
        instance.__dict__ = dict(
            values
        )  # not updated, which would add to the names that scenes' objects share
        return instance

    def _copyWith(self, **properties: Any) -> Self:
        """A copy with other values of some properties: an established way for mutators to give their result."""
        other = self._make(self.__dict__)
        update(other, properties)
        return other

    @property
    def properties(self) -> Mapping[str, Any]:
        """All properties and their values."""
        return MappingProxyType({name: getattr(self, name) for name in self._property_names()})

    def _property_names(self) -> Iterable[str]:
        names: Iterable[str] = self.__dict__.get("_source", self).__dict__.get(
            "_names", self.scenic_properties
        )
        return names

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._property_names()})

    def __getattr__(self, name: str) -> Any:
        # Reached only for what is not stored yet: a property of a sampled instance, or a vector's attribute.
        attributes = self.__dict__
        if name == "observations" and "_observed" in attributes:
            sensors = self.sensors
            value = attributes[name] = {
                key: item.getObservation() if item is sensors.get(key) else item
                for key, item in attributes["_observed"].items()
            }
            return value
        source = attributes.get("_source")
        if source is not None:
            values = source.__dict__
            if name in values:
                value = attributes[name] = attributes["_sample"].value(values[name])
                return value
        whole = attributes if source is None else source.__dict__
        if "_implied" in whole and name not in whole and name in type(self).scenic_properties:
            _fill(self if source is None else source, name)
            if source is None:
                return attributes[name]
        if source is not None and name in source.__dict__:  # a property that was implied
            value = attributes[name] = attributes["_sample"].value(source.__dict__[name])
            return value
        if (
            not name.startswith("_")
            and (source is not None or "position" in attributes)
            and name != "position"
        ):
            position = self.position
            if hasattr(type(position), name):
                return getattr(position, name)
        raise AttributeError(
            f"{type(self).__name__} has no property or attribute {name!r}", name=name, obj=self
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """A sampled instance is pickled as its values; its class by the first base that others can import."""
        cls = type(self)
        known = next(base for base in cls.__mro__ if base in (Object, OrientedPoint, Point))
        values = {name: value for name, value in self._copied().items() if name not in _NOT_KEPT}
        return _restored, (known, cls.__name__), values  # apart, since objects may know each other

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        made = memo[id(self)] = self._alike({})
        made.__dict__.update({name: deepcopy(value, memo) for name, value in self._copied().items()})
        return made

    def __copy__(self) -> Any:
        return self._alike(self._copied())

    def _alike(self, values: Mapping[str, object]) -> Self:
        """Return an instance with these values whose methods see the same sample."""
        made = self._make(values)
        if "_sample" in self.__dict__:
            made.__dict__["_sample"] = self.__dict__["_sample"]
        return made

    def _copied(self) -> dict[str, Any]:
        """Return the content of a copy: the properties, and the attributes named in ``_KNOWN``."""
        return {**self.properties, **{name: self._all()[name] for name in _KNOWN if name in self._all()}}

    def toVector(self) -> Any:
        """Return the position."""
        return self.position

    def sample(self, subsamples: object = None) -> Any:
        """Return the instance with its random properties drawn now, independent of all scenes."""
        return sample_of(self)

    def canSee(self, other: object, occludingObjects: object = (), *, certain: bool = False) -> Any:
        """Return whether it sees a vector, a point or an object past some objects.

        Rays may miss what shows between them. With ``certain`` they are not used: an object counts as seen if that is
        proved, however little of it shows.
        """
        attributes: Mapping[str, Any] = self.__dict__.get("_source", self).__dict__
        occluders = occluders_of(occludingObjects)
        if "_planar" in attributes and not certain:
            return sees_in_plane(self, other, occluders)
        return sees(self, other, occluders, certain=certain)

    @property
    def corners(self) -> tuple[Any, ...]:
        """The position, which is all that it fills."""
        return (self.position,)

    @property
    def visibleRegion(self) -> Any:
        """The places in its view, as far as nothing hides them."""
        return ViewRegion.of(self)

    def __str__(self) -> str:
        name = (
            getattr(self, "name", None) if "name" in self.scenic_properties or "name" in self._all() else None
        )
        return name if isinstance(name, str) else f"unnamed {type(self).__name__}"

    def __repr__(self) -> str:
        return f"<{self}>"

    def _all(self) -> Mapping[str, Any]:
        """The attributes stored in the instance, or, for a sample, in the instance that it is a sample of."""
        stored: Mapping[str, Any] = self.__dict__.get("_source", self).__dict__
        return stored


class OrientedPoint(Point):
    """A position with an orientation."""

    _definitions = _definitions(
        "OrientedPoint",
        {
            "parentOrientation": lambda _: Orientation(),
            "orientation": lambda self: operate(
                "compose",
                self.parentOrientation,
                Orientation.fromEuler(self.yaw, self.pitch, self.roll),
            ),
            "heading": lambda self: self.orientation.yaw,
            "viewAngles": lambda self: (self.viewAngle, math.pi),
            "orientationStdDev": lambda self: vector(self.headingStdDev, 0, 0),
            "mutator": lambda self: OrientationMutator(self.orientationStdDev),
        },
    )

    def toHeading(self) -> Any:
        """Return the global yaw, in radians."""
        return self.heading

    def toOrientation(self) -> Any:
        """Return the global orientation."""
        return self.orientation

    def relativePosition(self, offset: object) -> Any:
        """Return the global position of ``offset``, a vector given in this frame."""
        return operate("add", self.position, operate("rotate", self.orientation, to_vector(offset)))

    def relativize(self, offset: object) -> "OrientedPoint":
        """The oriented point at ``offset``, a vector given in this frame, turned as this one is."""
        return oriented_point(self.relativePosition(offset), self.orientation)

    def distancePast(self, point: object) -> Any:
        """The distance of this point past ``point``, measured along its heading (metres)."""
        back = operate("from euler", operate("negative", self.heading), 0, 0)
        return operate("rotate", back, operate("subtract", self.position, to_vector(point))).y

    def _placed(self, x: float, y: float, z: float) -> "OrientedPoint":
        """The oriented point at these multiples of the half extents, in this frame."""
        return oriented_point(self._place(x, y, z), self.orientation)

    def _place(self, x: float, y: float, z: float) -> Any:
        """The global point at these multiples of the half extents, in this frame."""
        offset = vector(
            operate("multiply", x / 2, to_scalar(self.width)),
            operate("multiply", y / 2, to_scalar(self.length)),
            operate("multiply", z / 2, to_scalar(self.height)),
        )
        return self.relativePosition(offset)


class Yielding:
    """An attribute that is computed by a method, unless a class defines a property of its name: then that is meant."""

    def __init__(self, compute: Callable[[Any], Any]) -> None:
        self._compute = compute
        self.__doc__ = compute.__doc__

    def __get__(self, instance: Any, owner: type | None = None) -> Any:
        return self if instance is None else self._compute(instance)


class Object(OrientedPoint):
    """A physical object: a shape with a size, in a place, that collides with others."""

    _definitions = _definitions(
        "Object",
        {
            "shape": lambda _: BoxShape(),
            "width": lambda self: self.shape.width,
            "length": lambda self: self.shape.length,
            "height": lambda self: self.shape.height,
            "baseOffset": lambda self: vector(0, 0, operate("divide", operate("negative", self.height), 2)),
            "visionSensorOffset": lambda self: vector(0, operate("divide", self.length, 2), 0),
            "velocity": lambda self: operate("rotate", self.orientation, vector(0, self.speed, 0)),
        },
    )

    @Yielding
    def hw(self) -> Any:
        """Return half the width, in metres."""
        return operate("divide", self.width, 2)

    @Yielding
    def hl(self) -> Any:
        """Return half the length, in metres."""
        return operate("divide", self.length, 2)

    @Yielding
    def hh(self) -> Any:
        """Return half the height, in metres."""
        return operate("divide", self.height, 2)

    @Yielding
    def radius(self) -> Any:
        """Return half the diagonal of the bounding box, in metres."""
        return operate("divide", operate("norm", vector(self.width, self.length, self.height)), 2)

    @property
    def corners(self) -> tuple[Any, ...]:
        """The eight corners of the bounding box in this object's frame, as global points."""
        return tuple(self._place(x, y, z) for z in (1, -1) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1)))

    @property
    def boundingBox(self) -> BoxRegion:
        """The box along the global axes around the space that it fills."""
        lower, upper = bounding_corners(self)
        middle = operate("divide", operate("add", lower, upper), 2)
        return BoxRegion(dimensions=operate("subtract", upper, lower), position=middle)

    @property
    def inradius(self) -> Any:
        """The radius of a ball about the position within which everything is inside, in metres."""
        return inradius(self)

    @property
    def planarInradius(self) -> Any:
        """The radius of a disc about the position within which everything is inside seen from above, in metres."""
        if isinstance(self.shape, BoxShape):
            return operate("divide", operate("minimum", self.width, self.length), 2)
        return planar_inradius(self)

    def distanceTo(self, point: object) -> Any:
        """Return the distance from the space that the object fills to a point; 0 inside."""
        return self.occupiedSpace.distanceTo(point)

    def containsPoint(self, point: object) -> Any:
        """Return whether the shape holds a point."""
        return self.occupiedSpace.containsPoint(point)

    def intersects(self, other: object) -> Any:
        """Return whether the shape shares a point with another object or region."""
        body = placed_of(self)
        if body is not None:
            overlap = None
            if isinstance(other, Object):
                other_body = placed_of(other)
                overlap = None if other_body is None else meet(body, other_body)
            elif isinstance(other, Region) and other.at_once is not None:
                overlap = other.at_once.meets_body(body)
            if overlap is not None:
                return overlap
        return self.occupiedSpace.intersects(other)

    @property
    def occupiedSpace(self) -> Any:
        """The region that the object fills."""
        return OccupiedSpace(self)

    @property
    def surface(self) -> Any:
        """The whole boundary, as a region."""
        return self._side("surface")

    @property
    def onSurface(self) -> Any:
        """The surface for things placed `on` this object: its top surface, unless a class overrides it."""
        return self.topSurface

    def startDynamicSimulation(self) -> None:
        """Do nothing; a class may override this method, which is called when the object is created in a simulation."""

    def _side(self, name: str) -> Any:
        return per_option(
            self.sideComponentThresholds, lambda thresholds: SideSurface(self, name, thresholds)
        )


_KNOWN = ("_names", "_given", "_planar")
"""Attributes of an instance beside its properties: their names, the names given by the program, and whether
it belongs to 2D mode."""

_NOT_KEPT = frozenset({"behavior", "mutator", "sensors", "observations", "lastActions"})
"""Properties that belong to the program rather than to a pickled object."""


def _restored(base: type[Point], name: str) -> Any:
    """An instance still to be given its pickled values, of a class of its own if the program's cannot be imported."""
    cls: type[Any] = base if base.__name__ == name else type(name, (base,), {})
    return cls._make(dict.fromkeys(_NOT_KEPT & cls.scenic_properties.keys()))


def _corner(x: float, y: float, z: float) -> property:
    return property(lambda self: self._placed(x, y, z))


def _surface(side: str) -> property:
    return property(lambda self: self._side(side))


SIDES: Mapping[str, tuple[int, int, int]] = MappingProxyType(
    {
        "left": (-1, 0, 0),
        "right": (1, 0, 0),
        "front": (0, 1, 0),
        "back": (0, -1, 0),
        "top": (0, 0, 1),
        "bottom": (0, 0, -1),
        "frontLeft": (-1, 1, 0),
        "frontRight": (1, 1, 0),
        "backLeft": (-1, -1, 0),
        "backRight": (1, -1, 0),
        "topFrontLeft": (-1, 1, 1),
        "topFrontRight": (1, 1, 1),
        "topBackLeft": (-1, -1, 1),
        "topBackRight": (1, -1, 1),
        "bottomFrontLeft": (-1, 1, -1),
        "bottomFrontRight": (1, 1, -1),
        "bottomBackLeft": (-1, -1, -1),
        "bottomBackRight": (1, -1, -1),
    }
)
"""Derived oriented points on the bounding box, in half extents along the object's axes."""


_combine_properties(Point)
for _name, _place in SIDES.items():
    setattr(Object, _name, _corner(*_place))
for _name in ("top", "bottom", "left", "right", "front", "back"):
    setattr(Object, f"{_name}Surface", _surface(_name))


def oriented_point(position: object, orientation: object, *, by_angles: bool = False) -> OrientedPoint:
    """An oriented point that the program did not create with ``new``.

    Its orientation is that of its parent; or, ``by_angles``, its own yaw, pitch and roll in the global frame. All its other
    properties are at their defaults, which are computed when they are asked for.
    """
    whole = to_orientation(orientation)
    angles = whole.eulerAngles if by_angles else (0.0, 0.0, 0.0)
    instance = OrientedPoint._make(
        {"position": position, "parentOrientation": Orientation() if by_angles else whole}
    )
    instance.__dict__.update(zip(("yaw", "pitch", "roll"), angles, strict=True))
    instance.__dict__["orientation"] = whole
    instance.__dict__["_implied"] = True
    return instance


generic.oriented_point.register(object, oriented_point)


def _fill(instance: Any, name: str) -> None:
    """Give a property its default, after those that the default reads."""
    if name not in instance.__dict__:
        entry = type(instance).scenic_properties[name]
        for needed in entry.dependencies:
            _fill(instance, needed)
        instance.__dict__[name] = entry.default(instance)


TWO_D_DEFAULTS: Mapping[str, PropertyDefinition] = MappingProxyType(
    {
        name: PropertyDefinition(name, frozenset(), value, tuple(needs), is_builtin=True)
        for name, value, *needs in (
            ("baseOffset", lambda _: vector(0, 0, 0)),
            ("contactTolerance", lambda _: 0),
            ("requireVisible", lambda _: True),
            ("occluding", lambda _: False),
            ("height", lambda self: operate("maximum", self.width, self.length), "width", "length"),
        )
    }
)
"""Built-in defaults of objects that differ in 2D mode (section 5.5)."""
