"""Values of specifiers (section 6.2 to 6.4 of the specification).

A specifier is turned into a `Specifier`: the properties it offers with their priorities, the properties it reads, and
a function from the partially built instance to values. Priorities, needs and the defaults of operands come from
`scenic.language.specifiers`; the functions here compute the values alone. `scenic.runtime.elements.resolution` decides
which of the offered values are taken.
"""

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from types import MappingProxyType
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.language.spans import Span
from scenic.language.specifiers import SPECIFIERS, SpecifierDeclaration
from scenic.language.types import OBJECT, REGION, VECTOR
from scenic.runtime.elements.operands import Ego, Read, converter, is_kind, region_of
from scenic.runtime.ground.context import Site, current, here
from scenic.runtime.instances.objects import Object, OrientedPoint
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import as_region
from scenic.runtime.regions.drawn import DrawnRegion
from scenic.runtime.regions.fields import VectorField, frame_at, is_field
from scenic.runtime.regions.scattered import PointSetRegion
from scenic.runtime.regions.spaces import Everywhere, Workspace
from scenic.runtime.regions.view_regions import place_in_plane, place_near
from scenic.runtime.regions.visibility_nodes import Sighting
from scenic.runtime.shapes.resting import middle_of_mass, resting_pose
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.lazy import Lazy, defer, reads_of, resolve
from scenic.runtime.values.values import (
    Orientation,
    Random,
    describe,
    is_number,
    is_open,
    is_vector,
    operate,
    options_of,
    per_option,
    to_orientation,
    to_scalar,
    to_vector,
    uniform,
    vector,
    wrong_type,
)

Evaluate = Callable[[Any], Mapping[str, Any]]
Space = Callable[[], Region]
"""The program's workspace, or everywhere."""


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
    site: Span | Site | None = None
    is_default: bool = False
    sighting: Sighting | None = None
    kind: Hashable = None
    """The key by which a class keeps how it is resolved; ``None`` if it has to be made."""

    @property
    def span(self) -> Span | None:
        """The place in the program."""
        if isinstance(self.site, Site):
            context = current.get()
            self.site = None if context is None else context.place_at(self.site)
        return self.site

    def __str__(self) -> str:
        return f"`{self.name}`"


def kind_of_specifier(
    name: str, priorities: Mapping[str, int], dependencies: frozenset[str], modifiable: frozenset[str]
) -> Hashable:
    """Return the key by which a class keeps how a specifier is resolved (`Specifier.kind`)."""
    return name, tuple(priorities.items()), dependencies, modifiable


@dataclass(frozen=True, slots=True)
class _Declared:
    """A specifier's declaration, in the form in which instances are resolved."""

    always: Mapping[str, int]
    under_condition: Mapping[str, int]
    """Priorities if the declared conditions hold."""
    needs: frozenset[str]
    modifies: frozenset[str]
    conversions: tuple[tuple[int, Read], ...]
    """Operands that are converted, and how."""
    egos: Mapping[int, Read]
    """Operands for which the ego stands in, and how it is converted."""
    reads_ego: bool
    reads_workspace: bool
    only: Read | None
    """The conversion of the operand where there is one only, which is never left out."""
    is_plain: bool
    """True if the specifier is built from its operands alone, without conversion."""
    kinds: tuple[Hashable, Hashable]
    """The kinds of specifiers (`Specifier.kind`) that need no more than declared: without what has a condition, and with it."""

    @classmethod
    def of(cls, declared: SpecifierDeclaration) -> "_Declared":
        reads = [converter(each.types, declared.label(each)) for each in declared.operands]
        reads_more = declared.may_read_ego or declared.reads_workspace
        always = {item.property: item.priority for item in declared.specifies if not item.when}
        under_condition = {item.property: item.priority for item in declared.specifies}
        needs, modifies = frozenset(declared.needs), frozenset(declared.modifies)
        return cls(
            MappingProxyType(always),
            MappingProxyType(under_condition),
            needs,
            modifies,
            tuple((i, read) for i, read in enumerate(reads) if read is not None),
            MappingProxyType(
                {i: reads[i] or _same for i, each in enumerate(declared.operands) if each.may_be_ego}
            ),
            declared.reads_ego,
            declared.reads_workspace,
            reads[0] if len(reads) == 1 and declared.operands[0].default is None and not reads_more else None,
            not (any(reads) or reads_more),
            (
                kind_of_specifier(declared.name, always, needs, modifies),
                kind_of_specifier(declared.name, under_condition, needs, modifies),
            ),
        )


def _same(value: object) -> Any:
    return value


_DECLARED = MappingProxyType({name: _Declared.of(declared) for name, declared in SPECIFIERS.items()})


def _specifier(
    name: str, evaluate: Evaluate, *reads: str, conditional: bool = True, **options: Any
) -> Specifier:
    """Return a specifier as declared.

    ``reads`` are the properties that it needs beside the declared ones; ``conditional`` tells whether it gives what is
    declared under a condition.
    """
    declaration = _DECLARED[name]
    return Specifier(
        name,
        declaration.under_condition if conditional else declaration.always,
        declaration.needs.union(reads) if reads else declaration.needs,
        evaluate,
        declaration.modifies,
        kind=None if reads else declaration.kinds[conditional],
        **options,
    )


# The specifiers


def with_(property: str, value: object) -> Specifier:
    """Return the one specifier that declares no priority: giving a property by name is the strongest way."""
    name, priorities, kind = _giving(property)
    return Specifier(name, priorities, _NOTHING, lambda _: {property: value}, kind=kind)


@lru_cache(maxsize=1024)
def _giving(property: str) -> tuple[str, Mapping[str, int], Hashable]:
    name, priorities = f"with {property}", MappingProxyType({property: 1})
    return name, priorities, kind_of_specifier(name, priorities, _NOTHING, _NOTHING)


_NOTHING: Final[frozenset[str]] = frozenset()


def at(position: object) -> Specifier:
    return _specifier("at", lambda _: {"position": position})


def in_(region: Region, *, name: str = "in") -> Specifier:
    def evaluate(_: Any) -> Mapping[str, Any]:
        position, orientation = region.uniform_placement()
        return {"position": position, "parentOrientation": orientation, "regionContainedIn": region}

    return _specifier(name, evaluate, conditional=region.has_orientation)


def on(target: object) -> Specifier:
    """Place the base point of an object on the target (section 6.3), with a gap of half the contact tolerance."""

    def base(instance: Any, _: bool) -> tuple[Any, Mapping[str, Any]]:
        gap = vector(0, 0, operate("divide", instance.contactTolerance, 2))
        return operate("subtract", gap, to_vector(instance.baseOffset)), {}

    return _standing("on", target, base)


def resting_on(target: object) -> Specifier:
    """A stable pose of the shape touches the target, with a gap of half the contact tolerance.

    What is drawn is the place below the centre of mass: an object whose mass hangs over the rim of a table falls.
    """

    def base(instance: Any, is_drawn: bool) -> tuple[Any, Mapping[str, Any]]:
        solid = instance.shape, instance.width, instance.length, instance.height
        pose = resting_pose(*solid)
        angles = {"yaw": operate("multiply", uniform(), 2 * math.pi), "pitch": pose.x, "roll": pose.y}
        height = operate("add", operate("divide", instance.contactTolerance, 2), pose.z)
        if not is_drawn:
            return vector(0, 0, height), angles
        mass = operate("rotate", operate("from euler", *angles.values()), middle_of_mass(*solid))
        return vector(operate("negative", mass.x), operate("negative", mass.y), height), angles

    return _standing("resting on", target, base)


def _standing(
    name: str, target: Any, base: Callable[[Any, bool], tuple[Any, Mapping[str, Any]]]
) -> Specifier:
    """Return a specifier that puts an object on a surface.

    ``base`` gives the place of the object's middle from the point of the surface, in the frame of its parent, and further
    properties; it is told whether that point is drawn, or is below a given place of the middle.
    """
    surface = target.onSurface if is_kind(target, Object) else target
    region = as_region(surface)
    if region is None and (is_open(surface) or _may_be_surface(surface)):
        region = DrawnRegion.made(_surface, surface)
    if region is None:
        if not (is_vector(surface) or isinstance(surface, Random) or hasattr(surface, "toVector")):
            raise wrong_type((REGION, OBJECT, VECTOR), surface, f"`{name}`")
        place = to_vector(surface, f"`{name}`")

    def rest(
        instance: object, anchor: object, orientation: object, is_drawn: bool = True
    ) -> Mapping[str, Any]:
        offset, properties = base(instance, is_drawn)
        if orientation is not None:
            offset = operate("rotate", orientation, offset)
        return {"position": operate("add", anchor, offset), "parentOrientation": orientation, **properties}

    def evaluate(instance: Any) -> Mapping[str, Any]:
        if region is None:
            return rest(instance, place, None, is_drawn=False)
        return rest(instance, *region.uniform_placement())

    def modify(instance: Any) -> Mapping[str, Any]:
        if region is None:
            raise ScenicTypeError(
                f"`{name}` a vector cannot be combined with a specifier that sets the position",
                span=here(),
                help=f"use `at`, or `{name}` a region or object",
            )
        return rest(instance, *region.project(instance.position, instance.onDirection), is_drawn=False)

    is_oriented = region is not None and region.has_orientation
    return _specifier(name, evaluate, modify=modify, conditional=is_oriented)


def _may_be_surface(value: object) -> bool:
    """Return whether some option of a choice is a region or an object."""
    return any(isinstance(option, Region | Object) or _may_be_surface(option) for option in options_of(value))


def _surface(target: object) -> Region:
    """Return the surface that the drawn operand of `on` denotes: of an object its ``onSurface``, of a point
    the region of that point.
    """
    surface = target.onSurface if isinstance(target, Object) else target
    if isinstance(surface, Region):
        return surface
    if is_vector(surface) or hasattr(surface, "toVector"):
        return PointSetRegion("place", [to_vector(surface, "`on`")])
    raise wrong_type((REGION, OBJECT, VECTOR), surface, "`on`")


def offset_by(ego: Any, offset: object) -> Specifier:
    def evaluate(_: Any) -> Mapping[str, Any]:
        return {"position": ego.relativePosition(offset), "parentOrientation": ego.orientation}

    return _specifier("offset by", evaluate)


def offset_along(ego: Any, direction: object, offset: object) -> Specifier:
    frame = frame_at(direction, ego.position, "`offset along`")

    def evaluate(_: Any) -> Mapping[str, Any]:
        position = operate("add", ego.position, operate("rotate", frame, offset))
        return {"position": position, "parentOrientation": ego.orientation}

    return _specifier("offset along", evaluate)


def beyond(place: object, offset: object, observer: Any) -> Specifier:
    step = scalar_or_vector(offset, "`beyond ... by`", axis=1)
    line = operate("subtract", place, to_vector(observer, "`beyond ... from`"))
    frame = operate("from euler", operate("azimuth", line), operate("altitude", line), 0)
    orientation = observer.orientation if is_kind(observer, OrientedPoint) else Orientation()

    def evaluate(_: Any) -> Mapping[str, Any]:
        position = operate("add", place, operate("rotate", frame, step))
        return {"position": position, "parentOrientation": orientation}

    return _specifier("beyond", evaluate)


def scalar_or_vector(value: Any, what: str, *, axis: int) -> Any:
    """Return a displacement: a vector, or a number along one axis."""
    if isinstance(value, Lazy):
        return defer(scalar_or_vector, value, what, axis=axis)
    if is_number(value) or (isinstance(value, Random) and value.node.kind.is_number):
        parts: list[Any] = [0, 0, 0]
        parts[axis] = value
        return vector(*parts)
    if options_of(value) and value.node.kind.is_boxed:
        return to_vector(per_option(value, partial(scalar_or_vector, what=what, axis=axis)), what)
    if is_open(value):
        return to_vector(call_later(scalar_or_vector, value, what, axis=axis), what)
    return to_vector(value, what)


def _directional(name: str, sign: int) -> Callable[..., Specifier]:
    """Return a specifier that places an object next to something (section 6.4), along the axis of its frame whose extent is declared."""
    (extent,) = SPECIFIERS[name].needs
    axis = ("width", "length", "height").index(extent)
    beside_vector = SPECIFIERS[name].needs_beside_vector

    def build(target: Any, distance: object) -> Specifier:
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

        gap = ("contactTolerance",) if is_object else ()
        reads = () if is_oriented else beside_vector
        return _specifier(name, evaluate, *gap, *reads, conditional=is_oriented)

    return build


def following(field: VectorField, start: object, distance: object) -> Specifier:
    end = field.followFrom(start, distance)
    orientation = field[end]

    def evaluate(_: Any) -> Mapping[str, Any]:
        return {"position": end, "parentOrientation": orientation}

    return _specifier("following", evaluate)


def facing(orientation: object) -> Specifier:
    if isinstance(orientation, tuple | list) and len(orientation) == 2:
        raise ScenicTypeError(
            f"`facing` takes a heading, an orientation or three Euler angles, not {describe(orientation)}",
            span=here(),
            help="to face a position write `facing toward`",
        )
    varies = is_field(orientation)
    target = orientation if varies else to_orientation(orientation, "`facing`")

    def evaluate(instance: Any) -> Mapping[str, Any]:
        wanted = frame_at(target, instance.position, "`facing`") if varies else target
        local = operate("compose", operate("inverse", instance.parentOrientation), wanted)
        if isinstance(local, Lazy):
            return {"yaw": local.yaw, "pitch": local.pitch, "roll": local.roll}
        yaw, pitch, roll = local.eulerAngles
        return {"yaw": yaw, "pitch": pitch, "roll": roll}

    return _specifier("facing", evaluate, *(("position",) if varies else ()))


def _facing_point(name: str, *, away: bool = False) -> Callable[..., Specifier]:
    directly = "pitch" in _DECLARED[name].always

    def build(place: object) -> Specifier:
        def evaluate(instance: Any) -> Mapping[str, Any]:
            ends = (place, instance.position) if away else (instance.position, place)
            line = operate("subtract", ends[1], ends[0])
            local = operate("rotate", operate("inverse", instance.parentOrientation), line)
            angles = {"yaw": operate("azimuth", local)}
            return {**angles, "pitch": operate("altitude", local)} if directly else angles

        return _specifier(name, evaluate)

    return build


def apparently_facing(angle: object, observer: object) -> Specifier:
    def evaluate(instance: Any) -> Mapping[str, Any]:
        line = operate("subtract", instance.position, observer)
        return {"yaw": operate("add", operate("azimuth", line), angle)}

    return _specifier("apparently facing", evaluate)


def visible(workspace: Region, observer: object, *, wanted: bool = True) -> Specifier:
    """Require that the observer sees the object, or does not (section 11.4); without another position, it may be anywhere in its container."""
    name = "visible" if wanted else "not visible"
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

    extents = ("width", "length", "height") if wanted else ()
    return _specifier(name, evaluate, *extents, sighting=Sighting(observer, wanted))


BUILDERS: Mapping[str, Callable[..., Specifier]] = MappingProxyType(
    {
        "with": with_,
        "at": at,
        "in": in_,
        "contained in": partial(in_, name="contained in"),
        "on": on,
        "resting on": resting_on,
        "offset by": offset_by,
        "offset along": offset_along,
        "beyond": beyond,
        "left of": _directional("left of", -1),
        "right of": _directional("right of", 1),
        "ahead of": _directional("ahead of", 1),
        "behind": _directional("behind", -1),
        "above": _directional("above", 1),
        "below": _directional("below", -1),
        "following": following,
        "facing": facing,
        "facing toward": _facing_point("facing toward"),
        "facing away from": _facing_point("facing away from", away=True),
        "facing directly toward": _facing_point("facing directly toward"),
        "facing directly away from": _facing_point("facing directly away from", away=True),
        "apparently facing": apparently_facing,
        "visible": visible,
        "not visible": partial(visible, wanted=False),
    }
)
"""Builders of the specifiers of `scenic.language.specifiers`, from their converted operands; ``with`` gets its property first, and
a specifier that reads the ego or the workspace gets that first."""


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
        """Return the specifier with these arguments."""

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

        reads = frozenset(self.reads) | reads_of(arguments)
        modifiable = frozenset(self.modifies)
        return Specifier(self.__name__, self.priorities, reads, evaluate, modifiable, site=here())


def specifier(
    *, reads: Sequence[str] = (), modifies: Sequence[str] = (), **priorities: int
) -> Callable[[Callable[..., Mapping[str, Any]]], UserSpecifier]:
    """Define a specifier by a function.

    The function gets the object being built, and the arguments of the specifier; it returns the values of the properties.
    It is used like a property that has a value: ``new Object with beside (tree, 3)``; a tuple passes several arguments.

    Args:
        reads: the properties of the new object that the function needs.
        modifies: properties whose value, given by another specifier, it may read and replace.
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


def _converted(declared: _Declared, ego: Ego, workspace: Space, operands: Sequence[object]) -> Sequence[Any]:
    """Return the arguments that a specifier is built from: the ego or the workspace where it reads them, then
    its converted operands.
    """
    arguments = [*operands]
    for index, read in declared.conversions:
        if arguments[index] is not None or index not in declared.egos:
            arguments[index] = read(arguments[index])
    for index, read in declared.egos.items():
        if arguments[index] is None:
            arguments[index] = read(ego())
    if declared.reads_ego:
        arguments.insert(0, ego())
    if declared.reads_workspace:
        arguments.insert(0, workspace())
    return arguments


def specify(name: str, ego: Ego, workspace: Space, *operands: Any, site: Site | None = None) -> Specifier:
    """Return one specifier; what lazy operands read, it depends on.

    ``ego`` and ``workspace`` are functions: a program without an ego fails only where one is needed. They stand in for
    the operands that the text leaves out (``None``), as declared. A wrong operand is told before a missing ego. ``site`` is the call
    in generated code, if that is known.
    """
    declaration = _DECLARED[name]
    if declaration.only is not None:
        arguments: Sequence[Any] = (declaration.only(operands[0]),)
    elif declaration.is_plain:
        arguments = operands
    else:
        arguments = _converted(declaration, ego, workspace, operands)
    specifier = BUILDERS[name](*arguments)
    specifier.site = here() if site is None else site
    reads = reads_of(operands)
    return replace(specifier, dependencies=specifier.dependencies | reads, kind=None) if reads else specifier


__all__ = [
    "BUILDERS",
    "Specifier",
    "UserSpecifier",
    "scalar_or_vector",
    "specifier",
    "specify",
]
