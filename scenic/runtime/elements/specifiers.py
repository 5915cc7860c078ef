"""What each specifier specifies (section 6.2 to 6.4 of the specification).

A specifier is turned into a `Specifier`: the properties it offers with their priorities, the properties it reads, and
a function from the partially built instance to values. Which of the offered values are taken is decided in
`scenic.runtime.instances.resolution`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Any

from scenic.graph.operations import TABLE
from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.language.spans import Span
from scenic.runtime.instances.objects import Object, OrientedPoint, Point
from scenic.runtime.program.context import current, here
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import as_region
from scenic.runtime.regions.drawn import DrawnRegion
from scenic.runtime.regions.fields import field_of, frame_at, is_field
from scenic.runtime.regions.scattered import PointSetRegion
from scenic.runtime.regions.spaces import Everywhere, Workspace
from scenic.runtime.regions.views import place_in_plane, place_near
from scenic.runtime.values.lazy import Lazy, defer, reads_of, resolve
from scenic.runtime.values.values import (
    Orientation,
    Random,
    as_value,
    describe,
    is_number,
    is_open,
    is_orientation,
    is_vector,
    operate,
    options_of,
    per_option,
    to_heading,
    to_orientation,
    to_scalar,
    to_vector,
    vector,
    wrong_type,
)
from scenic.runtime.visibility.seeing import Sighting

Evaluate = Callable[[Any], Mapping[str, Any]]
Ego = Callable[[], Any]


@dataclass(
    slots=True, eq=False
)  # Not frozen: that would double the cost of making one, of which there are many.
class Specifier:
    """One specifier of an instance.

    ``priorities`` maps each property offered to the strength of the offer (1 is strongest). ``modify`` is the function
    used when the specifier modifies a property that another one specifies; ``modifiable`` names those properties.
    ``is_default`` marks the default of a property, which the program did not write here. ``sighting`` is a demand on
    who sees the instance.
    """

    name: str
    priorities: Mapping[str, int]
    dependencies: frozenset[str]
    evaluate: Evaluate
    modifiable: frozenset[str] = frozenset()
    modify: Evaluate | None = None
    span: Span | None = None
    is_default: bool = False
    sighting: Sighting | None = None

    def __str__(self) -> str:
        return f"`{self.name}`"


def _specifier(
    name: str, priorities: Mapping[str, int], evaluate: Evaluate, *dependencies: str, **options: Any
) -> Specifier:
    return Specifier(name, priorities, frozenset(dependencies), evaluate, span=here(), **options)


# What operands are, where formulas differ by it


def is_kind(value: Any, cls: type[Point]) -> bool:
    """Whether a value is certainly an instance of a class: for a choice, every option."""
    if isinstance(value, Random):
        if value.node.operation is not TABLE["select"]:
            return False
        return all(is_kind(as_value(option), cls) for option in value.node.operands[1:])
    return isinstance(value, cls)


def is_unknown(value: Any, cls: type[Point] = Object) -> bool:
    """Whether only the draw shows if a random value is an instance of a class (section 4.3)."""
    return is_open(value) or len({is_kind(option, cls) for option in options_of(value)}) > 1


def region_of(value: Any, what: str) -> Region:
    """A region; raises `ScenicTypeError` for anything else."""
    region = as_region(value)
    if region is None and is_open(value):
        return DrawnRegion.of(value, what)
    if region is None:
        raise wrong_type("a region", value, what)
    return region


# The specifiers


def with_(_ego: Ego, property: str, value: Any) -> Specifier:
    return _specifier(f"with {property}", {property: 1}, lambda _: {property: value})


def at(_ego: Ego, position: Any) -> Specifier:
    place = to_vector(position, "`at`")
    return _specifier("at", {"position": 1}, lambda _: {"position": place})


def in_(_ego: Ego, region: Any, *, name: str = "in", contained: bool = False) -> Specifier:
    target = region_of(region, f"`{name}`")
    priorities = {"position": 1}
    if target.has_orientation:
        priorities["parentOrientation"] = 3
    if contained:
        priorities["regionContainedIn"] = 1

    def evaluate(_: Any) -> Mapping[str, Any]:
        position, orientation = target.uniform_placement()
        return {"position": position, "parentOrientation": orientation, "regionContainedIn": target}

    return _specifier(name, priorities, evaluate)


def contained_in(ego: Ego, region: Any) -> Specifier:
    return in_(ego, region, name="contained in", contained=True)


def on(_ego: Ego, target: Any) -> Specifier:
    """Section 6.3: the base point touches the target, with a gap of half the contact tolerance."""
    surface = target.onSurface if is_kind(target, Object) else target
    reads = ("baseOffset", "contactTolerance", "onDirection")
    priorities = {"position": 1}
    region = as_region(surface)
    if region is None and (is_open(surface) or _may_be_surface(surface)):
        region = DrawnRegion.made(_surface, surface)
    if region is not None:
        if region.has_orientation:
            priorities["parentOrientation"] = 2
    elif is_vector(surface) or isinstance(surface, Random) or hasattr(surface, "toVector"):
        place = to_vector(surface, "`on`")
    else:
        raise wrong_type("a region, an object or a vector", surface, "`on`")

    def rest(instance: Any, anchor: Any, orientation: Any) -> Mapping[str, Any]:
        gap = vector(0, 0, operate("divide", instance.contactTolerance, 2))
        offset = operate("subtract", gap, to_vector(instance.baseOffset))
        if orientation is not None:
            offset = operate("rotate", orientation, offset)
        return {"position": operate("add", anchor, offset), "parentOrientation": orientation}

    def evaluate(instance: Any) -> Mapping[str, Any]:
        if region is None:
            return rest(instance, place, None)
        return rest(instance, *region.uniform_placement())

    def modify(instance: Any) -> Mapping[str, Any]:
        if region is None:
            raise ScenicTypeError(
                "`on` a vector cannot be combined with a specifier that sets the position",
                span=here(),
                help="use `at`, or `on` a region or object",
            )
        return rest(instance, *region.project(instance.position, instance.onDirection))

    return _specifier("on", priorities, evaluate, *reads, modifiable=frozenset({"position"}), modify=modify)


def _may_be_surface(value: Any) -> bool:
    """Whether some option of a choice is a region or an object."""
    return any(isinstance(option, Region | Object) or _may_be_surface(option) for option in options_of(value))


def _surface(target: Any) -> Region:
    """What a drawn value is for `on`."""
    surface = target.onSurface if isinstance(target, Object) else target
    if isinstance(surface, Region):
        return surface
    if is_vector(surface) or hasattr(surface, "toVector"):
        return PointSetRegion("place", [to_vector(surface, "`on`")])
    raise wrong_type("a region, an object or a vector", surface, "`on`")


def offset_by(ego: Ego, offset: Any) -> Specifier:
    step, origin = to_vector(offset, "`offset by`"), ego()

    def evaluate(_: Any) -> Mapping[str, Any]:
        return {"position": origin.relativePosition(step), "parentOrientation": origin.orientation}

    return _specifier("offset by", {"position": 1, "parentOrientation": 3}, evaluate)


def offset_along(ego: Ego, direction: Any, offset: Any) -> Specifier:
    step, origin = to_vector(offset, "`offset along`"), ego()
    frame = frame_at(direction, origin.position, "`offset along`")

    def evaluate(_: Any) -> Mapping[str, Any]:
        position = operate("add", origin.position, operate("rotate", frame, step))
        return {"position": position, "parentOrientation": origin.orientation}

    return _specifier("offset along", {"position": 1, "parentOrientation": 3}, evaluate)


def beyond(ego: Ego, target: Any, offset: Any, origin: Any) -> Specifier:
    place = to_vector(target, "`beyond`")
    step = scalar_or_vector(offset, "`beyond`", axis=1)
    observer = ego() if origin is None else origin
    line = operate("subtract", place, to_vector(observer, "`beyond ... from`"))
    frame = operate("from euler", operate("azimuth", line), operate("altitude", line), 0)
    orientation = observer.orientation if is_kind(observer, OrientedPoint) else Orientation()

    def evaluate(_: Any) -> Mapping[str, Any]:
        position = operate("add", place, operate("rotate", frame, step))
        return {"position": position, "parentOrientation": orientation}

    return _specifier("beyond", {"position": 1, "parentOrientation": 3}, evaluate)


def scalar_or_vector(value: Any, what: str, *, axis: int) -> Any:
    """A displacement: a vector, or a number along one axis."""
    if isinstance(value, Lazy):
        return defer(scalar_or_vector, value, what, axis=axis)
    if is_number(value) or (isinstance(value, Random) and value.node.kind.is_number):
        parts: list[Any] = [0, 0, 0]
        parts[axis] = value
        return vector(*parts)
    if options_of(value) and value.node.kind.is_boxed:
        return to_vector(per_option(value, partial(scalar_or_vector, what=what, axis=axis)), what)
    if is_open(value):
        return to_vector(Random.later(scalar_or_vector, value, what, axis=axis), what)
    return to_vector(value, what)


def _directional(name: str, axis: int, sign: int, extent: str) -> Callable[..., Specifier]:
    """Section 6.4: next to something, along one axis of its frame."""

    def build(_ego: Ego, target: Any, distance: Any) -> Specifier:
        is_object, is_oriented = is_kind(target, Object), is_kind(target, OrientedPoint)
        centre = target.position if is_oriented else to_vector(target, f"`{name}`")
        reference = to_scalar(getattr(target, extent)) if is_object else 0.0
        step = None if distance is None else scalar_or_vector(distance, f"`{name} ... by`", axis=axis)

        def offset(instance: Any) -> Any:
            # u (s/2 + t/2 + d + g): the two half extents, the displacement, or else the contact gap.
            along = operate("divide", operate("add", to_scalar(getattr(instance, extent)), reference), 2)
            parts: list[Any] = [0.0, 0.0, 0.0] if step is None else list(resolve(step, instance))
            if step is not None:
                along = operate("add", along, parts[axis])
            elif is_object:
                along = operate("add", along, operate("divide", instance.contactTolerance, 2))
            parts[axis] = operate("multiply", sign, along)
            return vector(*parts)

        def evaluate(instance: Any) -> Mapping[str, Any]:
            frame = target.orientation if is_oriented else instance.orientation
            position = operate("add", centre, operate("rotate", frame, offset(instance)))
            return {"position": position, "parentOrientation": target.orientation if is_oriented else None}

        priorities = {"position": 1, "parentOrientation": 3} if is_oriented else {"position": 1}
        reads = [extent]
        if is_object:
            reads.append("contactTolerance")
        if not is_oriented:
            reads.append("orientation")
        return _specifier(name, priorities, evaluate, *reads)

    return build


def following(ego: Ego, field: Any, origin: Any, distance: Any) -> Specifier:
    start = to_vector(ego() if origin is None else origin, "`following ... from`")
    way = field_of(field, "`following`")
    end = way.followFrom(start, to_scalar(distance, "`following ... for`"))
    orientation = way[end]

    def evaluate(_: Any) -> Mapping[str, Any]:
        return {"position": end, "parentOrientation": orientation}

    return _specifier("following", {"position": 1, "parentOrientation": 3}, evaluate)


def facing(_ego: Ego, orientation: Any) -> Specifier:
    reads = ["parentOrientation"]
    target = orientation
    if is_field(orientation):
        reads.append("position")
    elif is_number(orientation) or is_orientation(orientation) or is_kind(orientation, OrientedPoint):
        target = to_orientation(orientation, "`facing`")
    elif isinstance(orientation, tuple | list) and len(orientation) == 2:
        raise ScenicTypeError(
            f"`facing` takes a heading, an orientation or three Euler angles, not {describe(orientation)}",
            span=here(),
            help="to face a position write `facing toward`",
        )
    else:
        target = to_orientation(orientation, "`facing`")

    def evaluate(instance: Any) -> Mapping[str, Any]:
        wanted = frame_at(target, instance.position, "`facing`") if is_field(target) else target
        local = operate("compose", operate("inverse", instance.parentOrientation), wanted)
        if isinstance(local, Lazy):
            return {"yaw": local.yaw, "pitch": local.pitch, "roll": local.roll}
        yaw, pitch, roll = local.eulerAngles
        return {"yaw": yaw, "pitch": pitch, "roll": roll}

    return _specifier("facing", {"yaw": 1, "pitch": 1, "roll": 1}, evaluate, *reads)


def _facing_point(name: str, *, away: bool, directly: bool) -> Callable[..., Specifier]:
    def build(_ego: Ego, target: Any) -> Specifier:
        place = to_vector(target, f"`{name}`")

        def evaluate(instance: Any) -> Mapping[str, Any]:
            ends = (place, instance.position) if away else (instance.position, place)
            line = operate("subtract", ends[1], ends[0])
            local = operate("rotate", operate("inverse", instance.parentOrientation), line)
            angles = {"yaw": operate("azimuth", local)}
            return {**angles, "pitch": operate("altitude", local)} if directly else angles

        priorities = {"yaw": 1, "pitch": 1} if directly else {"yaw": 1}
        return _specifier(name, priorities, evaluate, "position", "parentOrientation")

    return build


def apparently_facing(ego: Ego, heading: Any, origin: Any) -> Specifier:
    angle = to_heading(heading, "`apparently facing`")
    observer = to_vector(ego() if origin is None else origin, "`apparently facing ... from`")

    def evaluate(instance: Any) -> Mapping[str, Any]:
        line = operate("subtract", instance.position, observer)
        return {"yaw": operate("add", operate("azimuth", line), angle)}

    return _specifier("apparently facing", {"yaw": 1}, evaluate, "position", "parentOrientation")


def visible(ego: Ego, viewer: Any, workspace: Region, *, wanted: bool = True) -> Specifier:
    """Section 11.4: who must see the object, or must not; and, if nothing else says so, any position in its container."""
    name = "visible" if wanted else "not visible"
    observer = ego() if viewer is None else viewer
    if not is_kind(observer, Point):
        raise wrong_type("a point or an object", observer, f"`{name} from`")
    context = current.get()
    mode_2d = context is not None and context.mode_2d

    def evaluate(instance: Any) -> Mapping[str, Any]:
        container = instance.regionContainedIn
        region = workspace if container is None else region_of(container, f"`{name}`")
        while isinstance(region, Workspace):
            region = region.region
        if wanted:
            place = (
                place_in_plane(observer, region, seen=True)
                if mode_2d
                else place_near(observer, region, instance)
            )
            return {"position": place}
        if isinstance(region, Everywhere):
            raise InvalidScenarioError(
                "`not visible` needs to know where the object may be",
                span=here(),
                help="set `workspace = Workspace(region)`, or say where: `not visible, in region`",
            )
        if mode_2d:
            return {"position": place_in_plane(observer, region, seen=False)}
        return {"position": region.uniform_placement()[0]}

    reads = ("regionContainedIn", "width", "length", "height") if wanted else ("regionContainedIn",)
    return _specifier(name, {"position": 3}, evaluate, *reads, sighting=Sighting(observer, wanted))


BUILDERS: Mapping[str, Callable[..., Specifier]] = MappingProxyType(
    {
        "with": with_,
        "at": at,
        "in": in_,
        "contained in": contained_in,
        "on": on,
        "offset by": offset_by,
        "offset along": offset_along,
        "beyond": beyond,
        "left of": _directional("left of", 0, -1, "width"),
        "right of": _directional("right of", 0, 1, "width"),
        "ahead of": _directional("ahead of", 1, 1, "length"),
        "behind": _directional("behind", 1, -1, "length"),
        "above": _directional("above", 2, 1, "height"),
        "below": _directional("below", 2, -1, "height"),
        "following": following,
        "facing": facing,
        "facing toward": _facing_point("facing toward", away=False, directly=False),
        "facing away from": _facing_point("facing away from", away=True, directly=False),
        "facing directly toward": _facing_point("facing directly toward", away=False, directly=True),
        "facing directly away from": _facing_point("facing directly away from", away=True, directly=True),
        "apparently facing": apparently_facing,
        "visible": visible,
        "not visible": partial(visible, wanted=False),
    }
)
"""How each specifier of `scenic.language.specifiers` is built: ``(ego, *operands)``; ``with`` gets its property
first. ``ego`` is a function, so that a scenario without ego fails only where one is needed."""


class UserSpecifier:
    """A specifier that a program defines, used as ``with name (argument, ...)``; made by `specifier`."""

    def __init__(
        self,
        function: Callable[..., Mapping[str, Any]],
        priorities: Mapping[str, int],
        reads: Sequence[str],
        modifies: Sequence[str],
    ) -> None:
        self.function = function
        self.priorities = priorities
        self.reads = tuple(reads)
        self.modifies = tuple(modifies)
        self.__doc__ = function.__doc__
        self.__name__ = function.__name__

    def __call__(self, *arguments: Any) -> Specifier:
        """The specifier with these arguments."""

        def evaluate(instance: Any) -> Mapping[str, Any]:
            offered = self.function(instance, *(resolve(argument, instance) for argument in arguments))
            missing = sorted(self.priorities.keys() - offered.keys())
            if missing:
                raise ScenicTypeError(
                    f"specifier {self.__name__!r} gives no value for {', '.join(map(repr, missing))}",
                    span=here(),
                    help="its function returns a dictionary with a value for each property that it declares",
                )
            return offered

        reads = {*self.reads, *reads_of(arguments)}
        return _specifier(
            self.__name__, self.priorities, evaluate, *reads, modifiable=frozenset(self.modifies)
        )


def specifier(
    *, reads: Sequence[str] = (), modifies: Sequence[str] = (), **priorities: int
) -> Callable[[Callable[..., Mapping[str, Any]]], UserSpecifier]:
    """Define a specifier by a function.

    The function gets the object being built, and the arguments of the specifier; it returns the values of the properties.
    It is used like a property that has a value: ``new Object with beside (tree, 3)``; a tuple holds several arguments.

    Args:
        reads: the properties of the new object that the function needs.
        modifies: those of its properties whose value, given by another specifier, it may replace after having read it.
        priorities: the properties that it specifies, each with its strength (1 is the strongest).

    >>> @specifier(position=1, parentOrientation=3, reads=("width",))
    ... def beside(self, other, gap=0):
    ...     offset = (other.width / 2 + gap + self.width / 2, 0)
    ...     return {"position": other.relativePosition(offset), "parentOrientation": other.orientation}

    """
    if not priorities:
        raise ScenicTypeError(
            "a specifier specifies at least one property", help="for example `specifier(position=1)`"
        )
    return lambda function: UserSpecifier(function, priorities, reads, modifies)


def specify(name: str, ego: Ego, *operands: Any) -> Specifier:
    """One specifier; what lazy operands read, it depends on."""
    found = BUILDERS[name](ego, *operands)
    reads = reads_of(operands)
    return replace(found, dependencies=found.dependencies | reads) if reads else found


__all__ = [
    "BUILDERS",
    "Specifier",
    "UserSpecifier",
    "is_kind",
    "region_of",
    "scalar_or_vector",
    "specifier",
    "specify",
]
