"""The language's own operators on values (section 7 of the specification).

Each is a composition of operations of the table, so that sampling, intervals and the solver read it alike. The names are
those of `scenic.language.operators`.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.runtime.elements.specifiers import Ego, is_kind, is_unknown, region_of
from scenic.runtime.instances.objects import SIDES, Object, OrientedPoint, Point, oriented_point
from scenic.runtime.program.context import current, here
from scenic.runtime.python.opaque import call_later
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.body_regions import gap_between
from scenic.runtime.regions.choice import as_region
from scenic.runtime.regions.drawn import DrawnRegion
from scenic.runtime.regions.fields import field_of, frame_at, is_field, relative_to
from scenic.runtime.regions.views import part_of
from scenic.runtime.values.lazy import defer, definite, is_lazy
from scenic.runtime.values.values import (
    Random,
    Vector,
    binary,
    describe,
    is_number,
    is_open,
    is_orientation,
    is_vector,
    operate,
    options_of,
    to_heading,
    to_orientation,
    to_scalar,
    to_vector,
    unary,
    vector,
    wrong_type,
)
from scenic.runtime.visibility.flat import sees_in_mode
from scenic.runtime.visibility.seeing import sees

_add, _rotate, _compose, _distance_between = map(binary, ("add", "rotate", "compose", "distance"))
_minus, _azimuth, _slope, _normal = (
    binary("subtract"),
    *map(unary, ("azimuth", "altitude", "normalize angle")),
)
_PLACES = (Vector, Point)
"""What has a place and is no region."""


def _place(value: Any, what: str) -> Any:
    """As `to_vector`, sooner for points."""
    if type(value) is Vector:
        return value
    return value.position if isinstance(value, Point) else to_vector(value, what)


def _degrees(_ego: Ego, value: Any) -> Any:
    if not (is_number(value) or isinstance(value, Random | Vector)):
        raise wrong_type("a number", value, "`deg`")
    return operate("multiply", value, 0.017453292519943295)


def _vector(_ego: Ego, x: Any, y: Any) -> Any:
    return vector(to_scalar(x, "`@`"), to_scalar(y, "`@`"))


def _is_frame(value: Any) -> bool:
    """A number or an orientation."""
    return _is_scalar(value) or is_orientation(value)


def _is_scalar(value: Any) -> bool:
    """A number, or a random choice among numbers."""
    if isinstance(value, Random) and not value.node.kind.is_number:
        options = options_of(value)
        return bool(options) and all(map(_is_scalar, options))
    return is_number(value) or isinstance(value, Random)


def _relative_to(value: Any, frame: Any) -> Any:
    """Section 7.1: the first row of the table that fits."""
    if type(value) is Vector and type(frame) is Vector:
        return value + frame
    if is_field(value) or is_field(frame):
        return relative_to(value, frame)
    if _is_undecided(value) or _is_undecided(frame):
        return call_later(_relative_when_drawn, value, frame)
    oriented = [is_kind(operand, OrientedPoint) for operand in (value, frame)]
    if all(oriented):
        raise ScenicTypeError(
            "`relative to` between two oriented points is ambiguous",
            span=here(),
            help="write `.position` or `.heading` behind the one that you mean",
        )
    if any(oriented):
        point, other = (value, frame) if oriented[0] else (frame, value)
        if _is_scalar(other):
            return _add(point.heading, to_scalar(other))
        if is_orientation(other):
            return _compose(to_orientation(frame), to_orientation(value))
        return point.relativize(to_vector(other, "`relative to`"))
    if _is_frame(value) and _is_frame(frame):
        return _compose(to_orientation(frame), to_orientation(value))
    if _is_place(value) and _is_place(frame):
        return _add(to_vector(value), to_vector(frame))
    raise ScenicTypeError(
        f"`relative to` cannot combine {describe(value)} with {describe(frame)}",
        span=here(),
        help="it takes two vectors, two orientations or headings, or an oriented point and one of these",
    )


def _is_undecided(value: Any) -> bool:
    """Whether it shows only when a random value is drawn what it is for `relative to`."""
    if not isinstance(value, Random) or not value.node.kind.is_boxed:
        return False
    options = options_of(value)
    return is_open(value) or not (all(map(_is_scalar, options)) or all(map(_is_place, options)))


def _relative_when_drawn(value: Any, frame: Any) -> Any:
    return definite(_relative_to(value, frame), "`relative to` a field")


def _when_drawn(operator: Callable[..., Any], *operands: Any) -> Any:
    """What an operator gives once it shows what its operands, none of which is left out, are (section 4.3)."""
    return call_later(operator, None, *operands)


def _is_place(value: Any) -> bool:
    return is_vector(value) or (hasattr(value, "toVector") and not isinstance(value, type))


def _offset_along(_ego: Ego, base: Any, direction: Any, offset: Any) -> Any:
    start = _place(base, "`offset along`")
    frame = frame_at(direction, start, "`offset along`")
    return _add(start, _rotate(frame, to_vector(offset, "`offset along`")))


def _field_at(_ego: Ego, field: Any, position: Any) -> Any:
    if is_open(field):
        return _when_drawn(_field_at, field, position)
    place = to_vector(position, "`at`")
    return field_of(field, "`at`")[place]


def _follow(ego: Ego, field: Any, origin: Any, distance: Any) -> Any:
    start = to_vector(ego() if origin is None else origin, "`follow ... from`")
    if is_open(field):
        return _when_drawn(_follow, field, start, distance)
    way = field_of(field, "`follow`")
    end = way.followFrom(start, to_scalar(distance, "`follow ... for`"))
    return oriented_point(end, way[end])


def _relative_position(ego: Ego, target: Any, origin: Any) -> Any:
    return _direction(ego, origin, target, "`relative position`")


def _relative_heading(ego: Ego, target: Any, origin: Any) -> Any:
    start = _global_yaw(ego() if origin is None else origin)
    return _normal(_minus(_global_yaw(target), start))


def _global_yaw(value: Any) -> Any:
    """A heading; here three numbers are Euler angles, as wherever an orientation is wanted."""
    if is_vector(value) and not is_kind(value, Point):
        value = to_orientation(value, "`relative heading`")
    return to_heading(value, "`relative heading`")


def _apparent_heading(ego: Ego, target: Any, origin: Any) -> Any:
    waits = is_unknown(target, OrientedPoint)
    if not (waits or is_kind(target, OrientedPoint)):
        raise wrong_type("an oriented point", target, "`apparent heading of`")
    start = _place(ego() if origin is None else origin, "`apparent heading`")
    if waits:
        return _when_drawn(_apparent_heading, target, start)
    line = _azimuth(_minus(target.position, start))
    return _normal(_minus(target.heading, line))


def _distance(ego: Ego, origin: Any, target: Any) -> Any:
    start = ego() if origin is None else origin
    end = ego() if target is None else target
    if isinstance(start, _PLACES) and isinstance(end, _PLACES):
        return _distance_between(_place(start, "`distance`"), _place(end, "`distance`"))
    if is_open(start) or is_open(end):
        return _when_drawn(_distance, start, end)
    for near, far in ((start, end), (end, start)):
        region = as_region(near)
        if region is not None:
            return region.distance_from(to_vector(far, "`distance`"))
    return _distance_between(to_vector(start, "`distance`"), to_vector(end, "`distance`"))


def _minimum_distance(ego: Ego, origin: Any, target: Any) -> Any:
    first, second = (ego() if operand is None else operand for operand in (origin, target))
    if is_unknown(first) or is_unknown(second):
        return _when_drawn(_minimum_distance, first, second)
    for operand in (first, second):
        if not is_kind(operand, Object):
            raise wrong_type("an object", operand, "`minimum distance`")
    return gap_between(first, second)


def _distance_past(ego: Ego, target: Any, reference: Any) -> Any:
    point = ego() if reference is None else reference
    if is_unknown(point, OrientedPoint):
        return _when_drawn(_distance_past, target, point)
    if not is_kind(point, OrientedPoint):
        raise wrong_type("an oriented point", point, "`distance past ... of`")
    return point.distancePast(to_vector(target, "`distance past`"))


def _direction(ego: Ego, origin: Any, target: Any, what: str) -> Any:
    start = _place(ego() if origin is None else origin, what)
    return _minus(_place(ego() if target is None else target, what), start)


def _angle(ego: Ego, origin: Any, target: Any) -> Any:
    return _azimuth(_direction(ego, origin, target, "`angle`"))


def _altitude(ego: Ego, origin: Any, target: Any) -> Any:
    return _slope(_direction(ego, origin, target, "`altitude`"))


def _intersects(_ego: Ego, left: Any, right: Any) -> Any:
    one, other = (as_region(operand) or operand for operand in (left, right))
    if is_unknown(one) or is_unknown(other):
        return _when_drawn(_intersects, left, right)
    for operand in (one, other):
        if not isinstance(operand, Region) and not is_kind(operand, Object):
            raise wrong_type("an object or a region", operand, "`intersects`")
    return one.intersects(other)


def _can_see(_ego: Ego, viewer: Any, target: Any) -> Any:
    context = current.get()
    if context is None:
        return sees(viewer, target, ())
    if context.judging:
        context.looks = True
    elif context.is_symbolic and context.sample is None:
        raise InvalidScenarioError(
            "`can see` cannot be used while the program runs: the scene is not there yet",
            span=here(),
            help="use it in a requirement: `require ego can see x`",
        )
    return sees_in_mode(viewer, target, context.present, mode_2d=context.mode_2d)


def _part_in_view(ego: Ego, region: Any, viewer: Any, *, seen: bool) -> Region:
    observer = ego() if viewer is None else viewer
    if is_open(region) or is_open(observer):
        return DrawnRegion.made(_part_of, region, observer, seen=seen)
    return _part_of(region, observer, seen=seen)


def _part_of(region: Any, observer: Any, *, seen: bool) -> Region:
    return part_of(region_of(region, "`visible`" if seen else "`not visible`"), observer, seen=seen)


def _side(name: str, attribute: str) -> Callable[..., Any]:
    def build(_ego: Ego | None, target: Any) -> Any:
        if is_unknown(target):
            return _when_drawn(build, target)
        if not is_kind(target, Object):
            raise wrong_type("an object", target, f"`{name}`")
        return getattr(target, attribute)

    return build


def _sides() -> dict[str, Callable[..., Any]]:
    names = {}
    for attribute in SIDES:
        words = "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in attribute)
        names[f"{words} of"] = _side(f"{words} of", attribute)
    return names


OPERATORS: Mapping[str, Callable[..., Any]] = MappingProxyType(
    {
        "deg": _degrees,
        "at": _field_at,
        "follow": _follow,
        "@": _vector,
        "relative to": lambda _ego, value, frame: _relative_to(value, frame),
        "offset by": lambda _ego, base, offset: _relative_to(base, offset),
        "offset along": _offset_along,
        "relative position": _relative_position,
        "relative heading": _relative_heading,
        "apparent heading": _apparent_heading,
        "distance": _distance,
        "minimum distance": _minimum_distance,
        "distance past": _distance_past,
        "angle": _angle,
        "altitude": _altitude,
        "intersects": _intersects,
        "can see": _can_see,
        "visible": lambda ego, region, viewer: _part_in_view(ego, region, viewer, seen=True),
        "not visible": lambda ego, region, viewer: _part_in_view(ego, region, viewer, seen=False),
        **_sides(),
    }
)
"""Each operator as a function ``(ego, *operands)``; an operand that the text leaves out is ``None``."""


_NEVER_LAZY = (float, Vector, Point, type(None))
"""Types that most operands have; looked at first."""


def operation(name: str, ego: Ego, *operands: Any) -> Any:
    """The result of an operator; a lazy value where an operand is one."""
    function = OPERATORS[name]
    for operand in operands:
        if not isinstance(operand, _NEVER_LAZY) and is_lazy(operand):
            return defer(function, ego, *operands)
    return function(ego, *operands)
