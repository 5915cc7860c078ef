"""Operands of operators and specifiers, from what a program gives to what an implementation takes.

A declaration (`scenic.language.operators`) says which types an operand may have, and what stands in where the text leaves it
out. One layer here decides, for all operators alike and in one order:

1. what the text leaves out is the ego;
2. where an operand is lazy, so is the result;
3. a value that is definite, or random and of a known type, is converted to the first of the types that it has;
4. a choice has the first type that all of its options have;
5. where only the draw shows what an operand is, the operator waits for it;
6. anything else is an error that names the operator, the operand and the types.

So an implementation is a function of typed values, which are definite or random.
"""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, NamedTuple

from scenic.graph.kinds import Kind
from scenic.language.errors import InvalidScenarioError
from scenic.language.operators import Operator
from scenic.language.types import (
    DIRECTION,
    FIELD,
    HEADING,
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
)
from scenic.runtime.instances.objects import Object, OrientedPoint, Point
from scenic.runtime.python.opaque import call_later
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import as_region
from scenic.runtime.regions.drawn import DrawnRegion
from scenic.runtime.regions.fields import VectorField, field_of
from scenic.runtime.values.coercions import when_drawn
from scenic.runtime.values.lazy import defer, is_lazy
from scenic.runtime.values.values import (
    Random,
    Vector,
    is_number,
    is_open,
    is_orientation,
    is_vector,
    options_of,
    to_heading,
    to_orientation,
    to_scalar,
    to_vector,
    wrong_type,
)

Ego = Callable[[], Any]
Read = Callable[[Any], Any]
"""An operand as its type; `UNDECIDED` where it is lazy, or where only the draw shows its type."""
Bound = Callable[..., Any]
"""An operator as a function ``(ego, *operands)``; an operand that the text leaves out is ``None``."""


class _Undecided:
    """The type of `UNDECIDED`."""

    def __repr__(self) -> str:
        return "UNDECIDED"


UNDECIDED: Final = _Undecided()
"""In the place of an operand or a result: it has to wait for the object being specified, or for the draw."""


class _Reading(NamedTuple):
    """The test and the conversion for values of one type.

    ``fits`` tells whether a value that is no choice is of the type. ``convert`` gives the typed value; its second argument names
    the operand in an error. ``by_some`` is set where a choice is of the type as soon as one of its options is.
    """

    fits: Callable[[Any], bool]
    convert: Callable[[Any, str], Any]
    by_some: bool = False


def _number(value: object) -> bool:
    return value.node.kind.is_number if isinstance(value, Random) else is_number(value)


def _place(value: object) -> bool:
    return is_vector(value) or (not isinstance(value, Random | type) and hasattr(value, "toVector"))


def _is_measure(value: object) -> bool:
    """Return whether a value is a number or a vector itself, not what stands for one."""
    return _number(value) or (is_vector(value) and isinstance(value, Random | Vector))


def _instance(cls: type[Point]) -> _Reading:
    return _Reading(lambda value: isinstance(value, cls), lambda value, _: value)


_READINGS: Final[Mapping[Type, _Reading]] = MappingProxyType(
    {
        SCALAR: _Reading(_number, to_scalar),
        VECTOR: _Reading(_place, to_vector),
        ORIENTATION: _Reading(is_orientation, to_orientation),
        FIELD: _Reading(lambda value: isinstance(value, VectorField), field_of, by_some=True),
        REGION: _Reading(lambda value: as_region(value) is not None, lambda value, _: as_region(value)),
        POINT: _instance(Point),
        ORIENTED_POINT: _instance(OrientedPoint),
        OBJECT: _instance(Object),
        SCALAR_OR_VECTOR: _Reading(_is_measure, lambda value, _: value),
    }
)


def _is(type_: Type, value: object) -> bool:
    reading = _READINGS[type_]
    options = options_of(value)
    if options:
        return (any if reading.by_some else all)(_is(type_, option) for option in options)
    return reading.fits(value)


def type_of(value: object, types: Sequence[Type], label: str) -> Type | None:
    """Return the first of the types that a value has, all of its options where it is a choice; ``None`` where only the draw shows it.

    Raises:
        ScenicTypeError: if it has none of them; ``label`` names the operand.

    """
    if not isinstance(value, Random):
        for each in types:
            if _READINGS[each].fits(value):
                return each
        raise wrong_type(types, value, label)
    for each in types:
        if _is(each, value):
            return each
    options = options_of(value)
    if is_open(value) or any(_is(each, option) for option in options for each in types):
        return None
    while options:  # Of a choice without a right option, the message names the first one.
        value, options = options[0], options_of(options[0])
    raise wrong_type(types, value, label)


def is_kind(value: object, cls: type[Point]) -> bool:
    """Return whether a value is certainly an instance of a class: for a choice, every option."""
    options = options_of(value)
    return all(is_kind(option, cls) for option in options) if options else isinstance(value, cls)


def is_unknown(value: object, cls: type[Point] = Object) -> bool:
    """Return whether only the draw shows if a random value is an instance of a class (section 4.3)."""
    return is_open(value) or len({is_kind(option, cls) for option in options_of(value)}) > 1


def _to_yaw(value: object, label: str) -> Any:
    """Return a heading; here three numbers are Euler angles, as wherever an orientation is wanted."""
    if not isinstance(value, Point) and is_vector(value):
        value = to_orientation(value, label)
    return to_heading(value, label)


def _to_measure(value: Any, label: str) -> Any:
    """A number or a vector, as it is; checked when it is drawn where its type is not known before."""
    if type_of(value, (SCALAR_OR_VECTOR,), label) is None:
        return when_drawn(value, Kind.OTHER, lambda drawn: _to_measure(drawn, label))
    return value


_COERCED: Final[Mapping[Type, tuple[frozenset[type], Callable[[Any, str], Any]]]] = MappingProxyType(
    {
        SCALAR: (frozenset({float}), to_scalar),
        SCALAR_OR_VECTOR: (frozenset({float, int, Vector}), _to_measure),
        HEADING_OR_ANGLES: (frozenset({float}), _to_yaw),
        DIRECTION: (frozenset({float}), lambda value, _: value),
    }
)
"""Types to which random values are converted whatever they are, each with the classes whose values are left as they are."""


def reader(types: Sequence[Type], label: str) -> Read:
    """Return the function that reads an operand of these types; see the module's text.

    Raises:
        ScenicTypeError: when it is called with a value of a wrong type.

    """
    if types[0] is VECTOR:
        return _reading_places(types, label)
    if len(types) == 1 and types[0] in _COERCED:
        exact, convert = _COERCED[types[0]]

        def read(value: object) -> Any:
            if type(value) in exact:
                return value
            return UNDECIDED if is_lazy(value) else convert(value, label)

        return read

    def decide(value: object) -> Any:
        if is_lazy(value):
            return UNDECIDED
        found = type_of(value, types, label)
        return UNDECIDED if found is None else _READINGS[found].convert(value, label)

    return decide


def _reading_places(types: Sequence[Type], label: str) -> Read:
    """Return a `reader` for vectors, or for vectors and regions, which reads points first, since they are the most frequent."""
    takes_regions = REGION in types

    def read(value: object) -> Any:
        if type(value) is Vector:
            return value
        if isinstance(value, Point):
            return value.position
        if takes_regions and isinstance(value, Region):
            return value
        if is_lazy(value):
            return UNDECIDED
        if not takes_regions:
            return to_vector(value, label)
        kind = type_of(value, types, label)
        return UNDECIDED if kind is None else _READINGS[kind].convert(value, label)

    return read


def region_of(value: Any, label: str) -> Region:
    """Return a region; raises `ScenicTypeError` for anything else."""
    region = as_region(value)
    if region is not None:
        return region
    if is_open(value):
        return DrawnRegion.of(value, label)
    raise wrong_type(REGION, value, label)


def _observer(value: object, label: str) -> Any:
    if not is_kind(value, Point):
        raise wrong_type(POINT, value, label)
    return value


_CONVERTED: Final[Mapping[Type, Callable[[Any, str], Any]]] = MappingProxyType(
    {
        SCALAR: to_scalar,
        VECTOR: to_vector,
        HEADING: to_heading,
        FIELD: field_of,
        REGION: region_of,
        POINT: _observer,
    }
)


def converter(types: Sequence[Type], label: str) -> Read | None:
    """Return the function that converts an operand of a specifier: a lazy value gives a lazy one, as it is read with the instance.

    ``None`` for operands of several types, and for those of a type that depends on where the instance is: they stay as they are.

    Raises:
        ScenicTypeError: when it is called with a value of a wrong type.

    """
    convert = _CONVERTED.get(types[0]) if len(types) == 1 else None
    return None if convert is None else lambda value: convert(value, label)


def bound(declared: Operator, function: Callable[..., Any], drawn: Callable[..., Any]) -> Bound:
    """Return an operator as programs use it, from its implementation: a function of the typed operands.

    ``drawn`` gives its result in a sample, from its name and the drawn operands; it is not part of the result, so that
    what a sample reads stays small.

    Raises:
        ScenicTypeError: when it is called with an operand of a wrong type.
        InvalidScenarioError: when an operand is left out and there is no ego.

    """
    name, application = declared.name, DrawnRegion.made if declared.result == REGION.name else call_later
    reads = [reader(operand.types, declared.label(operand)) for operand in declared.operands]
    egos = [operand.may_be_ego for operand in declared.operands]

    def undecided(call: Bound, ego: Ego, given: tuple[Any, ...], operands: tuple[Any, ...]) -> Any:
        return defer(call, ego, *given) if is_lazy(given) else application(drawn, name, *operands)

    if len(reads) == 1:
        return _unary(reads[0], function, undecided)
    if len(reads) == 2:
        are_places = all(operand.types[0] is VECTOR for operand in declared.operands)
        return _binary((reads[0], reads[1]), (egos[0], egos[1]), are_places, function, undecided)
    return _ternary((reads[0], reads[1], reads[2]), function, undecided)


# One function for each number of operands: a simulation calls them all the time.


def _unary(read: Read, function: Callable[..., Any], undecided: Callable[..., Any]) -> Bound:
    def call(ego: Ego, given: object) -> Any:
        operand = read(given)
        return undecided(call, ego, (given,), (given,)) if operand is UNDECIDED else function(operand)

    return call


def _binary(
    reads: tuple[Read, Read],
    egos: tuple[bool, bool],
    are_places: bool,
    function: Callable[..., Any],
    undecided: Callable[..., Any],
) -> Bound:
    (read_first, read_second), (first_is_ego, second_is_ego) = reads, egos

    def call(ego: Ego, first: object, second: object) -> Any:
        if type(first) is Vector and type(second) is Vector and are_places:
            return function(first, second)
        operands = first, second
        try:
            if first is None and first_is_ego:
                first = ego()
            if second is None and second_is_ego:
                second = ego()
        except InvalidScenarioError:  # A wrong operand is told before a missing ego.
            for read, value in zip(reads, operands, strict=True):
                if value is not None:
                    read(value)
            raise
        one, other = read_first(first), read_second(second)
        if one is UNDECIDED or other is UNDECIDED:
            return undecided(call, ego, operands, (first, second))
        return function(one, other)

    return call


def _ternary(
    reads: tuple[Read, Read, Read], function: Callable[..., Any], undecided: Callable[..., Any]
) -> Bound:
    read_first, read_second, read_third = reads

    def call(ego: Ego, first: object, second: object, third: object) -> Any:
        one, two, three = read_first(first), read_second(second), read_third(third)
        if one is UNDECIDED or two is UNDECIDED or three is UNDECIDED:
            return undecided(call, ego, (first, second, third), (first, second, third))
        return function(one, two, three)

    return call
