"""The language's own operators on values (section 7 of the specification).

Each is a composition of operations of the table, so that sampling, intervals and the solver read it alike. The names are
those of `scenic.language.operators`.
"""

import math
from collections.abc import Callable, Mapping
from operator import attrgetter
from types import MappingProxyType
from typing import Any, NoReturn

from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.language.operators import FRAMES, SIDES
from scenic.language.operators import OPERATORS as DECLARED
from scenic.language.types import FIELD, ORIENTED_POINT, SCALAR, VECTOR
from scenic.runtime.elements.operands import Bound, Ego, bound, type_of
from scenic.runtime.ground.context import current, here
from scenic.runtime.instances.objects import OrientedPoint, oriented_point
from scenic.runtime.python.opaque import call_later
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.body_regions import gap_between
from scenic.runtime.regions.fields import frame_at, relative_to
from scenic.runtime.regions.planar_visibility import sees_in_mode
from scenic.runtime.regions.view_regions import part_of
from scenic.runtime.regions.visibility_nodes import sees
from scenic.runtime.values.directions import DIRECTIONS, Direction
from scenic.runtime.values.lazy import defer, definite, is_lazy
from scenic.runtime.values.values import (
    Vector,
    binary,
    describe,
    operate,
    to_orientation,
    to_scalar,
    to_vector,
    unary,
    vector,
)

_add, _rotate, _compose, _distance_between = map(binary, ("add", "rotate", "compose", "distance"))
_minus, _azimuth, _slope, _normal = (
    binary("subtract"),
    *map(unary, ("azimuth", "altitude", "normalize angle")),
)


def _degrees(value: object) -> Any:
    return operate("multiply", value, 0.017453292519943295)


def _follow(field: Any, start: object, distance: object) -> Any:
    end = field.followFrom(start, distance)
    return oriented_point(end, field[end])


def _offset_along(start: object, direction: object, offset: object) -> Any:
    return _add(start, _rotate(frame_at(direction, start, "`offset along`"), offset))


def _apparent_heading(target: Any, viewpoint: object) -> Any:
    return _normal(_minus(target.heading, _azimuth(_minus(target.position, viewpoint))))


def _apparent_heading_to(target: object, viewer: Any) -> Any:
    """Return the apparent heading, from -pi (exclusive) to pi."""
    bearing = _normal(_minus(_azimuth(_minus(target, viewer.position)), viewer.heading))
    return operate("if", operate("greater", bearing, -math.pi), bearing, math.pi)


def _lies(direction: Direction) -> Callable[[Any, Any], Any]:
    """Return the operator that tests whether a place lies in a direction from an oriented point."""

    def build(target: object, base: object) -> Any:
        bearing = _apparent_heading_to(target, base)
        if direction.either_side:
            bearing = operate("absolute", bearing)
        return operate(
            "and", operate("greater", bearing, direction.least), operate("less", bearing, direction.most)
        )

    return build


def _distance(start: object, end: object) -> Any:
    if type(start) is Vector and type(end) is Vector:
        return _distance_between(start, end)
    if isinstance(start, Region):
        return start.distance_from(to_vector(end, "`distance` from a region"))
    if isinstance(end, Region):
        return end.distance_from(start)
    return _distance_between(start, end)


def _angle(start: object, end: object) -> Any:
    return _azimuth(_minus(end, start))


def _altitude(start: object, end: object) -> Any:
    return _slope(_minus(end, start))


def _no_ego() -> NoReturn:
    raise AssertionError("an operand of a drawn operator is never left out")


def _of_drawn(name: str, *operands: Any) -> Any:
    """The result of an operator in a sample."""
    return definite(OPERATORS[name](_no_ego, *operands), f"`{name}`")


def _visible(region: Any, viewer: Any) -> Region:
    return part_of(region, viewer, seen=True)


def _attribute(side: str) -> str:
    """Return the attribute of objects for a side: ``frontLeft`` for ``front left``."""
    first, *others = side.split()
    return first + "".join(map(str.capitalize, others))


IMPLEMENTATIONS: Mapping[str, Callable[..., Any]] = MappingProxyType(
    {
        "deg": _degrees,
        "@": vector,
        "at": lambda field, position: field[position],
        "follow": _follow,
        "offset along": _offset_along,
        "relative position": _minus,
        "relative heading": lambda heading, base: _normal(_minus(heading, base)),
        "apparent heading": _apparent_heading,
        "apparent heading to": _apparent_heading_to,
        **{f"is {words}": _lies(direction) for words, direction in DIRECTIONS.items()},
        "distance": _distance,
        "minimum distance": gap_between,
        "distance past": lambda target, base: base.distancePast(target),
        "angle": _angle,
        "altitude": _altitude,
        "intersects": lambda first, second: first.intersects(second),
        "visible": _visible,
        "not visible": lambda region, viewer: part_of(region, viewer, seen=False),
        **{f"{side} of": attrgetter(_attribute(side)) for side in SIDES},
    }
)
"""Each operator as a function of its operands, which have one of the declared types, and may be random."""


# Operators that look at their operands themselves


def _relative_to(ego: Ego, value: Any, frame: Any) -> Any:
    """Evaluate `relative to` by the first row of the table in section 7.1 that fits."""
    if type(value) is Vector and type(frame) is Vector:
        return value + frame
    if type(frame) is Vector and isinstance(value, OrientedPoint):
        return value.relativize(frame)
    if is_lazy(value) or is_lazy(frame):
        return defer(_relative_to, ego, value, frame)
    types = [type_of(operand, FRAMES, "`relative to`") for operand in (value, frame)]
    if FIELD in types:
        return relative_to(value, frame)
    if None in types:
        return call_later(_of_drawn, "relative to", value, frame)
    if types == [ORIENTED_POINT, ORIENTED_POINT]:
        raise ScenicTypeError(
            "`relative to` between two oriented points is ambiguous",
            span=here(),
            help="write `.position` or `.heading` behind the one that you mean",
        )
    if ORIENTED_POINT in types:
        point, other = (value, frame) if types[0] is ORIENTED_POINT else (frame, value)
        if SCALAR in types:
            return _add(point.heading, to_scalar(other))
        if VECTOR in types:
            return point.relativize(to_vector(other))
    elif types == [VECTOR, VECTOR]:
        return _add(to_vector(value), to_vector(frame))
    if VECTOR in types:
        raise ScenicTypeError(
            f"`relative to` cannot combine {describe(value)} with {describe(frame)}",
            span=here(),
            help="it takes two vectors, two orientations or headings, or an oriented point and one of these",
        )
    return _compose(to_orientation(frame), to_orientation(value))


def _can_see(ego: Ego, viewer: object, target: object) -> Any:
    if is_lazy(viewer) or is_lazy(target):
        return defer(_can_see, ego, viewer, target)
    context = current.get()
    if context is None:
        return sees(viewer, target, ())
    if context.judging:
        context.record.looks = True
    elif context.is_symbolic and context.sample is None:
        raise InvalidScenarioError(
            "`can see` cannot be used while the program runs: the scene is not there yet",
            span=here(),
            help="use it in a requirement: `require ego can see x`",
        )
    return sees_in_mode(viewer, target, context.present, mode_2d=context.mode_2d)


OPERATORS: Mapping[str, Bound] = MappingProxyType(
    {
        **{name: bound(DECLARED[name], function, _of_drawn) for name, function in IMPLEMENTATIONS.items()},
        "relative to": _relative_to,
        "offset by": _relative_to,
        "can see": _can_see,
    }
)
"""Each operator as programs use it: a function ``(ego, *operands)``; an operand that the text leaves out is ``None``."""


def operation(name: str, ego: Ego, *operands: Any) -> Any:
    """The result of an operator; a lazy value where an operand is one."""
    return OPERATORS[name](ego, *operands)
