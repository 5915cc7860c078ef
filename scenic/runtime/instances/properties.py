"""Properties of classes: their defaults, how definitions combine along the inheritance chain, how values are stored.

Section 5.2 of the specification.
"""

import math
from array import array
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from graphlib import TopologicalSorter
from itertools import chain
from types import MappingProxyType
from typing import Any

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph.kinds import Kind
from scenic.language.errors import InvalidScenarioError, ScenicValueError
from scenic.language.properties import CLASSES
from scenic.language.spans import Span
from scenic.language.types import BOOLEAN, REGION, SCALAR, SHAPE, VECTOR, VIEW_ANGLES, Type
from scenic.runtime.ground.context import current, here, warn
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.drawn import DrawnRegion
from scenic.runtime.shapes.shapes import Shape
from scenic.runtime.values.choices import per_option
from scenic.runtime.values.coercions import when_drawn
from scenic.runtime.values.lazy import MEMO, resolve
from scenic.runtime.values.values import (
    Random,
    Vector,
    is_number,
    is_open,
    operate,
    options_of,
    to_orientation,
    to_scalar,
    to_vector,
    wrong_type,
)

ATTRIBUTES = frozenset({"additive", "dynamic", "final"})


@dataclass(frozen=True, slots=True)
class PropertyDefinition:
    """One definition in one class.

    ``value`` computes the default from the partially built instance, of which it reads ``dependencies``.
    """

    name: str
    attributes: frozenset[str]
    value: Callable[[Any], Any]
    dependencies: tuple[str, ...]
    span: Span | None = None
    is_builtin: bool = False

    def compute(self, instance: object) -> Any:
        """The value for one instance, by the program's names as they are in what is running."""
        context = None if self.is_builtin else current.get()
        return (self.value if context is None else context.settled(self.value))(instance)


@dataclass(frozen=True, slots=True)
class Property:
    """A property as instances of one class have it."""

    name: str
    definitions: tuple[PropertyDefinition, ...]
    additive: bool
    dynamic: bool
    final: bool
    dependencies: frozenset[str] = field(init=False)
    """Properties that the default reads."""

    def __post_init__(self) -> None:
        names = (name for definition in self.definitions for name in definition.dependencies)
        object.__setattr__(self, "dependencies", frozenset(names))

    def default(self, instance: object) -> Any:
        """Return the default for one instance; additive properties give all definitions, most derived first."""
        if self.additive:
            return tuple(definition.compute(instance) for definition in self.definitions)
        return self.definitions[0].compute(instance)


@dataclass(frozen=True, slots=True)
class Finals:
    """The properties of a class that follow from others while a simulation runs, each after those that it reads.

    Attributes:
        builtin: those of the language itself.
        inputs: all that these read.
        own: those of the program, whose defaults may depend on anything.

    """

    builtin: tuple[Property, ...]
    inputs: tuple[str, ...]
    own: tuple[Property, ...]

    @classmethod
    def of(cls, properties: Mapping[str, Property]) -> "Finals":
        """Return the final dynamic properties among the properties of a class."""
        found = {name: entry for name, entry in properties.items() if entry.dynamic and entry.final}
        reads = {name: entry.dependencies & found.keys() for name, entry in found.items()}
        ordered = [found[name] for name in TopologicalSorter(reads).static_order()]
        builtin = tuple(entry for entry in ordered if entry.definitions[0].is_builtin)
        inputs = {name for entry in builtin for name in entry.dependencies} - found.keys()
        return cls(builtin, tuple(sorted(inputs)), tuple(entry for entry in ordered if entry not in builtin))

    def renew_own(self, instance: object) -> None:
        """Compute the values of the program's own final properties of an instance again."""
        stored = instance.__dict__
        for entry in self.own:
            stored[entry.name] = normalised(entry.name, resolve(entry.default(instance), instance))
        stored.pop(MEMO, None)


def combine(chain: Sequence[Mapping[str, PropertyDefinition]]) -> dict[str, Property]:
    """The properties of a class from the definitions of each class of its method-resolution order.

    Raises `InvalidScenarioError` where a final property is defined again, or one definition is both additive and dynamic.
    """
    names = dict.fromkeys(name for definitions in reversed(chain) for name in definitions)
    return {
        name: _combine(name, [definitions[name] for definitions in chain if name in definitions])
        for name in names
    }


def _combine(name: str, definitions: Sequence[PropertyDefinition]) -> Property:
    primary = definitions[0]
    for overridden in definitions[1:]:
        if "final" in overridden.attributes:
            raise InvalidScenarioError(
                f"property {name!r} is final and cannot be defined again",
                span=primary.span,
                help="choose another name, or leave `final` out where it is defined first",
            )
    if {"additive", "dynamic"} <= primary.attributes:
        raise InvalidScenarioError(
            f"property {name!r} cannot be both additive and dynamic",
            span=primary.span,
            help="leave one of the two out",
        )
    additive = "additive" in primary.attributes
    return Property(
        name,
        tuple(definitions) if additive else (primary,),
        additive,
        any("dynamic" in definition.attributes for definition in definitions),
        "final" in primary.attributes,
    )


# Values as they are stored


def normalised(name: str, value: object) -> Any:
    """Return a property's value as instances store it: vectors, scalars and angles in (-pi, pi] by name."""
    normalise = NORMAL.get(name)
    return value if normalise is None else normalise(name, value)


def _vector(name: str, value: object) -> Any:
    return value if type(value) is Vector else to_vector(value, f"property {name!r}")


def _position(name: str, value: object) -> Any:
    position = _vector(name, value)
    if type(position) is Vector and not all(map(math.isfinite, position)):
        raise ScenicValueError(
            f"property {name!r} must be finite, not {position!r}",
            span=here(),
            help="look for what is infinite or undefined in the numbers that it is made of",
        )
    return position


def _scalar(name: str, value: object) -> Any:
    return value if type(value) is float else to_scalar(value, f"property {name!r}")


def _distance(name: str, value: object) -> Any:
    distance = _scalar(name, value)
    if is_number(distance) and not distance >= 0:
        raise ScenicValueError(
            f"property {name!r} must not be negative, but is {distance:g}",
            span=here(),
            help="distances are in metres",
        )
    return distance


def _angle(name: str, value: object) -> Any:
    angle = _scalar(name, value)
    if type(angle) is float and abs(angle) <= math.pi:
        return angle
    if is_number(angle) and not math.isfinite(angle):
        raise ScenicValueError(
            f"property {name!r} must be finite, not {angle:g}", span=here(), help="angles are in radians"
        )
    return operate("normalize angle", angle)


def _orientation(name: str, value: object) -> Any:
    return to_orientation(value, f"property {name!r}")


def _shape(name: str, value: object) -> Any:
    if not isinstance(value, Shape):
        raise wrong_type(SHAPE, value, f"property {name!r}")
    return value


def _truth(name: str, value: object) -> Any:
    """Python's own rule holds; of what is random, numbers have a truth of their own."""
    if not isinstance(value, Random):
        return bool(value)
    if value.node.kind is Kind.BOOLEAN:
        return value
    if not value.node.kind.is_number:
        raise wrong_type("a truth value", value, f"property {name!r}")
    return operate("truth", value)


def _per_drawn(
    normalise: Callable[[str, Any], Any],
    kind: Kind = Kind.OTHER,
    together: Callable[[list[Any]], list[Any] | None] | None = None,
) -> Callable[[str, Any], Any]:
    """Return a function that normalises each option of a random choice, and values whose kind shows only when they are drawn.

    ``together`` normalises a list of drawn values, or gives ``None`` where they have to be looked at one by one.
    """

    def applied(name: str, value: object) -> Any:
        if not (isinstance(value, Random) and value.node.kind.is_boxed):
            return normalise(name, value)
        if options_of(value):
            return per_option(value, lambda option: applied(name, option))
        return when_drawn(value, kind, lambda drawn: normalise(name, drawn), together)

    return applied


def _density(name: str, value: object) -> Any:
    """A number, left as it is written."""
    _scalar(name, value)
    return value


def _ray_count(name: str, value: object) -> Any:
    """Check the numbers of rays across and upward; ``None`` stands for the default."""
    if value is None:
        return value
    if not (isinstance(value, tuple | list) and len(value) == 2):
        raise wrong_type("a pair of numbers", value, f"property {name!r}")
    for count in value:
        if is_number(_scalar(name, count)) and not count >= 1:
            raise ScenicValueError(
                f"property {name!r} must be at least 1, not {count:g}",
                span=here(),
                help="these are the numbers of rays across and upward, for example `(300, 200)`",
            )
    return tuple(value)


def _container(name: str, value: object) -> Any:
    if not isinstance(value, Region | Random | None):
        raise wrong_type(REGION, value, f"property {name!r}")
    if isinstance(value, Random) and is_open(value):
        return DrawnRegion.of(value, f"property {name!r}")
    return value


def _view_angles(_name: str, value: object) -> Any:
    """A pair of angles, at most all around."""
    if not (isinstance(value, tuple | list | Vector) and len(value) in (2, 3)):
        raise wrong_type(VIEW_ANGLES, value, "property 'viewAngles'")
    angles = []
    for angle, limit in zip(list(value)[:2], (2 * math.pi, math.pi), strict=True):
        size = to_scalar(angle, "property 'viewAngles'")
        if is_number(size):
            if not size > 0:
                raise ScenicValueError(
                    f"view angles are greater than 0, not {size:g}",
                    span=here(),
                    help="give them in radians, or with `deg`",
                )
            if size > limit:
                warn(
                    f"view angle {size:g} is truncated to {limit:g}",
                    help="the angles are at most 360 and 180 degrees",
                )
                size = limit
        else:
            size = operate("minimum", size, limit)
        angles.append(size)
    return tuple(angles)


def _colour(_name: str, value: object) -> Any:
    if value is None:
        return value
    parts = tuple(value) if isinstance(value, tuple | list) else ()
    fine = len(parts) in (3, 4) and all(
        isinstance(part, Random) or (is_number(part) and 0 <= part <= 1) for part in parts
    )
    if not fine:
        raise ScenicValueError(
            f"a colour is 3 or 4 numbers from 0 to 1, not {value!r}",
            span=here(),
            help="write red, green, blue and maybe opacity as numbers from 0 to 1; divide parts that go up to 255 by 255",
        )
    return value if isinstance(value, tuple) else parts  # a `Color` stays one


def _colours(values: list[Any]) -> list[Any] | None:
    """Return colours as `_colour` does, where all of them are tuples of three or four numbers; ``None`` otherwise."""
    if not all(issubclass(cls, tuple) for cls in set(map(type, values))):
        return None
    sizes = set(map(len, values))
    try:
        parts = np.frombuffer(array("d", chain.from_iterable(values)))
    except (TypeError, OverflowError):  # not numbers, or none of these
        return None
    fine = len(sizes) == 1 and sizes <= {3, 4} and ((parts >= 0) & (parts <= 1)).all()
    return values if fine else None


def update(instance: Any, changes: Mapping[str, object]) -> None:
    """Give properties new values, and those that always follow from others the values that follow now."""
    values = instance.__dict__
    for name, value in changes.items():
        values[name] = normalised(name, value)
    dependents = {
        name: entry for name, entry in instance.scenic_properties.items() if entry.dynamic and entry.final
    }
    names_done: set[str] = set()

    def settle(name: str) -> None:
        if name not in names_done:
            names_done.add(name)
            for needed in dependents[name].dependencies & dependents.keys():
                settle(needed)
            values[name] = normalised(name, dependents[name].default(instance))

    for name in dependents.keys() - changes.keys():
        settle(name)


_BY_TYPE: Mapping[tuple[Type, ...], Callable[[str, Any], Any]] = MappingProxyType(
    {
        (VECTOR,): _vector,
        (SCALAR,): _scalar,
        (BOOLEAN,): _per_drawn(_truth, Kind.BOOLEAN),
    }
)
"""Conversions of the values of properties by their declared types, where the type decides."""

NORMAL: Mapping[str, Callable[[str, Any], Any]] = MappingProxyType(
    {
        **{
            each.name: _BY_TYPE[each.types]
            for cls in CLASSES.values()
            for each in cls.properties
            if each.types in _BY_TYPE and not each.final
        },
        "position": _position,
        **dict.fromkeys(("yaw", "pitch", "roll"), _angle),
        "visibleDistance": _distance,
        "parentOrientation": _orientation,
        "viewAngles": _per_drawn(_view_angles),
        "viewRayDensity": _density,
        "viewRayCount": _per_drawn(_ray_count),
        "color": _per_drawn(_colour, together=_colours),
        "shape": _per_drawn(_shape),
        "regionContainedIn": _container,
    }
)
"""Functions that check and convert the values that properties of the language are given, by name."""
