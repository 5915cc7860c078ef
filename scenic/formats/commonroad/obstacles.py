"""Objects of scenes and simulations as CommonRoad's obstacles, and the ego as a planning problem."""

import math
from collections.abc import Iterable, Sequence
from typing import Final, Protocol
from xml.etree import ElementTree

import numpy as np

from scenic.dataclass import dataclass
from scenic.formats.commonroad.elements import Numbers, add, add_exact, add_point, decimal
from scenic.formats.scene_protocols import SceneObject

__all__ = ["ObstacleCourse", "State", "add_obstacle", "add_problem", "state_of"]

Element = ElementTree.Element

_CATEGORIES: Final = (
    ("Motorcycle", "motorcycle"),
    ("Bicycle", "bicycle"),
    ("Truck", "truck"),
    ("Bus", "bus"),
    ("Vehicle", "car"),
    ("Pedestrian", "pedestrian"),
)
"""CommonRoad's types of moving obstacles by the names of classes."""

_AHEAD: Final = 100
"""Steps within which the ego of a scene alone is to reach its goal."""


@dataclass(frozen=True, slots=True)
class State:
    """Place (metres), heading (radians from east, anticlockwise) and forward speed (m/s) of an object."""

    x: float
    y: float
    heading: float
    speed: float

    def onward(self, seconds: float) -> "State":
        """The state after some time at constant speed."""
        way = self.speed * seconds
        return State(
            self.x + way * math.cos(self.heading),
            self.y + way * math.sin(self.heading),
            self.heading,
            self.speed,
        )


@dataclass(frozen=True, slots=True)
class ObstacleCourse:
    """An object and its states, one for each step."""

    thing: SceneObject
    states: tuple[State, ...]

    @property
    def is_still(self) -> bool:
        """Return whether the object never moves."""
        first = self.states[0]
        return not first.speed and all(state == first for state in self.states)


class Turned(Protocol):
    """Anything with an angle from north."""

    @property
    def yaw(self) -> float: ...


def state_of(position: Iterable[float], orientation: Turned, velocity: Iterable[float]) -> State:
    """The state of an object by its position (metres), orientation and velocity (m/s)."""
    x, y, *_ = map(float, position)
    along, across, *_ = map(float, velocity)
    heading = math.remainder(float(orientation.yaw) + math.pi / 2, 2 * math.pi)
    return State(x, y, heading, along * math.cos(heading) + across * math.sin(heading))


def add_obstacle(root: Element, course: ObstacleCourse, key: str, numbers: Numbers, timestep: float) -> None:
    """Append an obstacle: a static one if it never moves."""
    first, *later = course.states
    if course.is_still:
        element = add(root, "staticObstacle", id=numbers[key])
        is_vehicle = bool(getattr(course.thing, "isVehicle", False))
        add(element, "type", "parkedVehicle" if is_vehicle else "unknown")
    else:
        element = add(root, "dynamicObstacle", id=numbers[key])
        names = {cls.__name__ for cls in type(course.thing).__mro__}
        add(element, "type", next((word for cls, word in _CATEGORIES if cls in names), "unknown"))
    _add_shape(add(element, "shape"), course.thing)
    _add_state(add(element, "initialState"), first, 0)
    if not course.is_still:
        # The schema requires a state after the first one.
        trajectory = add(element, "trajectory")
        for time, state in enumerate(later or [first.onward(timestep)], 1):
            _add_state(add(trajectory, "state"), state, time)


def _add_shape(parent: Element, thing: SceneObject) -> None:
    """Append the outline of an object from above, about its middle, with its front to the east."""
    if thing.shape.source.as_dict()["kind"] == "box":
        rectangle = add(parent, "rectangle")
        add(rectangle, "length", decimal(thing.length))
        add(rectangle, "width", decimal(thing.width))
        return
    import shapely

    places = thing.shape.mesh.vertices[:, [1, 0]] * (thing.length, -thing.width)
    hull = shapely.MultiPoint(places).convex_hull
    polygon = add(parent, "polygon")
    for place in np.asarray(hull.exterior.coords)[:-1].tolist():
        add_point(polygon, place)


def _add_state(element: Element, state: State, time: int) -> None:
    add_point(add(element, "position"), (state.x, state.y))
    add_exact(element, "orientation", state.heading)
    add(add(element, "time"), "exact", str(time))
    add_exact(element, "velocity", state.speed)


def add_problem(
    root: Element,
    course: ObstacleCourse,
    numbers: Numbers,
    goal: Sequence[str],
    timestep: float,
) -> None:
    """Append the planning problem of the ego.

    It is to be where its course ends, within the last second; if there is no course, on one of the lanelets ``goal``, or ten
    seconds ahead.

    Args:
        root: the whole document.
        course: of the ego.
        numbers: of lanelets and other things.
        goal: keys of lanelets.
        timestep: seconds in a step.

    """
    first, last, steps = course.states[0], course.states[-1], len(course.states) - 1
    problem = add(root, "planningProblem", id=numbers["planning problem"])
    initial = add(problem, "initialState")
    add_point(add(initial, "position"), (first.x, first.y))
    for tag, value in (
        ("velocity", first.speed),
        ("orientation", first.heading),
        ("yawRate", 0.0),
        ("slipAngle", 0.0),
    ):
        add_exact(initial, tag, value)
    add(add(initial, "time"), "exact", "0")
    state = add(problem, "goalState")
    time = add(state, "time")
    begin = max(0, steps - math.ceil(1 / timestep)) if steps else 0
    add(time, "intervalStart", str(begin))
    add(time, "intervalEnd", str(steps or _AHEAD))
    position = add(state, "position")
    if not steps and goal:
        for key in goal:
            add(position, "lanelet", ref=numbers[key])
        return
    place = last if steps else first.onward(_AHEAD * timestep)
    rectangle = add(position, "rectangle")
    add(rectangle, "length", decimal(2 * course.thing.length))
    add(rectangle, "width", decimal(2 * course.thing.width))
    add(rectangle, "orientation", decimal(place.heading))
    center = add(rectangle, "center")
    add(center, "x", decimal(place.x))
    add(center, "y", decimal(place.y))
