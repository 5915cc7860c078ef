"""Visibility of things for observers, as values: nodes of the graph over everything that decides it (section 11.3).

Observers and targets are known by what they have, so that classes of objects can offer `canSee` themselves.
"""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any, Final, Literal

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Graph, Node
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import ScenicTypeError
from scenic.language.types import OBJECT, POINT
from scenic.runtime.geometry.contact.scalar_bodies import PlacedBody, Triple, axes_of, is_near_way
from scenic.runtime.geometry.views.observers import Views
from scenic.runtime.geometry.views.occluders import Occluder
from scenic.runtime.geometry.views.scalar_views import View, sees_body, sees_point
from scenic.runtime.geometry.views.seen_bodies import sees_bodies
from scenic.runtime.geometry.views.seen_points import sees_points
from scenic.runtime.geometry.views.subdivision import Proof, prove
from scenic.runtime.ground.context import here
from scenic.runtime.regions.presence import hides, seen_if_present
from scenic.runtime.regions.stacked import body_of, body_operands, is_body, placed_of
from scenic.runtime.regions.visibility_bounds import TARGET, sees_bounds, sees_inverse, sees_looks_at
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.values import (
    Orientation,
    Random,
    Vector,
    apply,
    describe,
    is_open,
    operate,
    options_of,
    per_option,
    to_scalar,
    to_vector,
    wrong_type,
)

VIEW_OPERANDS: Final = TARGET
"""Number of values that describe an observer."""


def sees(observer: Any, target: Any, occluders: Iterable[object], *, certain: bool = False) -> Any:
    """Return whether an observer sees a vector, a point or an object past others: true or false, or a random truth value.

    The observer and the target hide nothing, even if they are among the occluders. With ``certain``, no rays are sampled:
    an object is seen if that is proved by dividing the directions in which it lies.
    """
    everything = tuple(occluders)
    return per_option(
        observer, lambda viewer: per_option(target, lambda thing: _sees(viewer, thing, everything, certain))
    )


def _sees(observer: Any, target: Any, occluders: Sequence[object], certain: bool) -> Any:
    if is_open(observer) or is_open(target):
        # Which of the objects it is, if any, only the draw shows.
        return call_later(sees, observer, target, occluders, certain=certain)
    found = None if certain else _at_once(observer, target, occluders)
    if found is None:
        found = _looked(observer, target, occluders, certain)
    return seen_if_present(target, found)


def _at_once(observer: Any, target: Any, occluders: Sequence[object]) -> bool | None:
    """Return whether it is seen, if that needs no closer look; ``None`` also where something is random."""
    camera, orientation = camera_of(observer)
    angles = observer.viewAngles if _is_turned(observer) else (2 * np.pi, np.pi)
    distance = observer.visibleDistance
    if not (type(camera) is Vector and type(orientation) is Orientation and type(distance) is float):
        return None
    if type(angles) is not tuple or not all(type(angle) is float for angle in angles):
        return None
    view = View(camera.row, axes_of(orientation.q), angles, distance)
    placed_body = placed_of(target) if is_body(target) else None
    place = target.position if is_body(target) else to_vector(target, "`can see`")
    if type(place) is not Vector or (is_body(target) and placed_body is None):
        return None
    radius = 0.0 if placed_body is None else placed_body.radius
    hiding = []
    for thing in occluders:
        if thing is observer or thing is target:
            continue
        hiding_it = hides(thing)
        if hiding_it is True:
            body = _in_the_way(thing, camera.row, place.row, radius)
            if body is None:
                return None
            if body:
                hiding.append(body)
        elif hiding_it is not False:
            return None
    return (
        sees_point(view, place.row, hiding) if placed_body is None else sees_body(view, placed_body, hiding)
    )


def _in_the_way(thing: Any, start: Triple, end: Triple, radius: float) -> PlacedBody | Literal[False] | None:
    """Return the body of an object that may be between a camera and a ball; false if it is not, ``None`` if it is random."""
    position, width, length, height = thing.position, thing.width, thing.length, thing.height
    if type(position) is not Vector or not (type(width) is type(length) is type(height) is float):
        return None
    reach = radius + 0.5 * (width + length + height)
    return placed_of(thing) if is_near_way(start, end, position.row, reach) else False


def _looked(observer: Any, target: Any, occluders: Sequence[object], certain: bool) -> Any:
    operands = list(view_operands(observer))
    is_object = is_body(target)
    operands += body_operands(target) if is_object else [to_vector(target, "`can see`")]
    for thing in occluders:
        if thing is not observer and thing is not target:
            hiding = hides(thing)
            if isinstance(hiding, Random) or hiding:
                operands += [*body_operands(thing), hiding]
    return apply(SEES, *operands, payload=(is_object, certain))


def occluders_of(values: Any) -> tuple[Any, ...]:
    """Return the objects that may hide others, as a tuple; raises `ScenicTypeError` for any other value."""
    if isinstance(values, Random) or not isinstance(values, Iterable):
        raise wrong_type("objects in a sequence", values, "what may hide others")
    things = tuple(values)
    for thing in things:
        if not (thing.node.kind.is_boxed if isinstance(thing, Random) else is_body(thing)):
            raise wrong_type(OBJECT, thing, "what may hide others")
    return things


def camera_of(observer: Any) -> tuple[Any, Any]:
    """The place that an observer looks from, and the orientation of its view (section 11.1)."""
    if not hasattr(type(observer), "canSee"):
        raise wrong_type(POINT, observer, "an observer")
    if not _is_turned(observer):
        return observer.position, Orientation()
    orientation = observer.orientation
    if not is_body(observer):
        return observer.position, orientation
    offset = to_vector(observer.cameraOffset)
    return operate("add", observer.position, operate("rotate", orientation, offset)), orientation


def _is_turned(observer: Any) -> bool:
    return hasattr(type(observer), "toOrientation")


def view_operands(observer: Any) -> tuple[Any, ...]:
    """Return the values that describe an observer's view, for `views_of`; for a random choice of observers each is a choice."""
    if options_of(observer):
        return tuple(per_option(observer, partial(_view_operand, number)) for number in range(VIEW_OPERANDS))
    camera, orientation = camera_of(observer)
    horizontal, vertical = _pair(observer.viewAngles, "viewAngles")
    if not _is_turned(observer):
        horizontal, vertical = 2 * np.pi, np.pi
    count = observer.viewRayCount
    across, upward = (0, 0) if count is None else _pair(count, "viewRayCount")
    return (
        camera,
        orientation,
        horizontal,
        vertical,
        to_scalar(observer.visibleDistance),
        to_scalar(observer.viewRayDensity),
        across,
        upward,
        observer.viewRayDistanceScaling,
    )


def _view_operand(number: int, observer: Any) -> Any:
    return view_operands(observer)[number]


def _pair(value: Any, name: str) -> tuple[Any, Any]:
    if not isinstance(value, Random):
        try:
            first, second = value
        except (TypeError, ValueError) as error:
            raise ScenicTypeError(
                f"property '{name}' must be a pair of numbers, not {describe(value)}", span=here()
            ) from error
    else:
        first, second = operate("getitem", value, 0), operate("getitem", value, 1)
    return to_scalar(first, f"'{name}'"), to_scalar(second, f"'{name}'")


def views_of(columns: Sequence[Column]) -> Views:
    """Return the views whose operands have these columns."""
    camera, orientation, horizontal, vertical, distance, density, across, upward, scaling = columns
    return Views(
        camera,
        orientation,
        _stacked(horizontal, vertical),
        distance,
        density,
        _stacked(across, upward),
        np.asarray(scaling, dtype=np.bool_),
    )


def _stacked(first: Column, second: Column) -> Column:
    first, second = np.broadcast_arrays(first, second)
    return np.stack([first, second], axis=-1).astype(np.float64)


def _seen(call: Call, *columns: Column) -> Column:
    views, rest = views_of(columns[:VIEW_OPERANDS]), columns[VIEW_OPERANDS:]
    is_object, certain = call.payload
    width = 4 if is_object else 1
    occluders = [
        Occluder(body_of(*rest[at : at + 4]), np.asarray(rest[at + 4], dtype=np.bool_))
        for at in range(width, len(rest), 5)
    ]
    lanes = max(len(column) for column in columns)
    if is_object and certain:
        return np.asarray(prove(views, body_of(*rest[:4]), occluders, lanes) == Proof.SEEN)
    if is_object:
        return sees_bodies(views, body_of(*rest[:4]), occluders, lanes)
    return sees_points(views, rest[0], occluders, lanes)


SEES = Operation(
    "sees",
    always(Kind.BOOLEAN),
    _seen,
    "Whether an observer sees a point or an object past others.",
    bounds=sees_bounds,
    inverse=sees_inverse,
    partial=True,
    looks_at=sees_looks_at,
)


def looks(root: Node) -> bool:
    """Return whether a condition depends on visibility, unless the dependence is hidden in Python code."""
    return any(node.operation is SEES for node in Graph([root]).nodes if not node.is_axis)


@dataclass(frozen=True, slots=True)
class Sighting:
    """A demand by the specifiers `visible` and `not visible`: an observer has to see an instance, or must not see it."""

    observer: Any
    wanted: bool
