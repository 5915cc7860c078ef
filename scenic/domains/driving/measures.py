"""Measures of how critical traffic is: times, gaps and decelerations between vehicles, lane borders, and red lights.

All of them take objects of a running simulation, or of a scene, so that they can stand in `record`, `require always` and as
objectives of falsification. Distances are in metres, times in seconds, decelerations in m/s^2; what does not occur is infinite.
"""

import math
from typing import Any

import numpy as np

from scenic.runtime.program.builtins import is_simulating, running_simulation

__all__ = [
    "PostEncroachment",
    "bumper_gap",
    "distance_to_lane_border",
    "is_running_red",
    "post_encroachment_time",
    "required_deceleration",
    "time_headway",
    "time_to_collision",
]


def _extent(thing: Any, dx: float, dy: float) -> float:
    """Return half of the extent of an object's outline along a direction."""
    ahead = abs(-math.sin(thing.heading) * dx + math.cos(thing.heading) * dy)
    aside = abs(math.cos(thing.heading) * dx + math.sin(thing.heading) * dy)
    return float(thing.length * ahead + thing.width * aside) / 2


def _corners(thing: Any) -> list[tuple[float, float]]:
    """Return the corners of an object's outline."""
    sine, cosine = math.sin(thing.heading), math.cos(thing.heading)
    x, y, *_ = thing.position
    a, b = thing.width / 2, thing.length / 2
    return [
        (x + u * cosine - v * sine, y + u * sine + v * cosine)
        for u, v in ((-a, -b), (a, -b), (a, b), (-a, b))
    ]


def _distance(one: Any, other: Any) -> float:
    """Return the distance of two outlines, 0 where they touch; infinite if one object is above the other."""
    import shapely

    (x, y, z), (u, v, w) = one.position, other.position
    reach = math.hypot(one.width, one.length) / 2 + math.hypot(other.width, other.length) / 2
    if math.hypot(x - u, y - v) > reach or abs(z - w) > (one.height + other.height) / 2:
        return math.inf
    return float(shapely.Polygon(_corners(one)).distance(shapely.Polygon(_corners(other))))


def bumper_gap(car: object, other: object) -> float:
    """Return the distance from the front of a car to the rear of another object in its way, along its lane; infinite if it is not ahead.

    It is 0 while they touch. Where the outlines overlap along the lane, but do not touch, it is their distance. The way is the lane of the car and the lanes straight after it; beside the way, by more than half of both widths, nobody is ahead.
    """
    found = _along_lane(car, other)
    return math.inf if found is None else found[0]


def _along_lane(car: Any, other: Any) -> tuple[float, float, float] | None:
    """Return the gap to an object ahead or in contact, and the speeds of both along the lane; ``None`` if it is not ahead in the way."""
    import shapely

    lane = car._lane
    if lane is None:
        return None
    lanes = [lane]
    for _ in range(6):
        maneuvers = [item for item in lanes[-1].maneuvers if item.type.name == "STRAIGHT"]
        if not maneuvers:
            break
        if maneuvers[0].connectingLane is not None:
            lanes.append(maneuvers[0].connectingLane)
        lanes.append(maneuvers[0].endLane)
    line = shapely.LineString(np.concatenate([item.line for item in lanes]))
    spots = [shapely.Point(item.position[0], item.position[1]) for item in (car, other)]
    own_place, place = (float(line.project(spot)) for spot in spots)
    headings = []
    for along in (own_place, place):
        x0, y0 = line.interpolate(max(along - 0.05, 0.0)).coords[0]
        x1, y1 = line.interpolate(along + 0.05).coords[0]
        length = max(math.hypot(x1 - x0, y1 - y0), 1e-9)
        headings.append(((x1 - x0) / length, (y1 - y0) / length))
    (dx, dy), (ex, ey) = headings
    aside = abs(spots[1].distance(line))
    gap = place - own_place - _extent(car, dx, dy) - _extent(other, ex, ey)
    distance = _distance(car, other) if gap <= 0 else gap
    if distance:
        if place <= own_place or aside > (_extent(other, -ey, ex) + _extent(car, -dy, dx)):
            return None
        if not all(lane.network.is_level(item, other.position) for item in lanes):
            return None  # on a bridge, or below one
    speeds = (
        car.velocity[0] * dx + car.velocity[1] * dy,
        other.velocity[0] * ex + other.velocity[1] * ey,
    )
    return distance, float(speeds[0]), float(speeds[1])


def time_to_collision(car: object, other: object) -> float:
    """The time until a car runs into an object ahead if both keep their speeds: gap / (v - v_other); 0 while they touch.

    J. C. Hayward, Near-miss determination through use of a scale of danger, Highway Research Record 384, 1972.
    """
    found = _along_lane(car, other)
    if found is None:
        return math.inf
    gap, own, ahead = found
    return gap / (own - ahead) if own - ahead > 1e-9 else math.inf if gap else 0.0


def time_headway(car: object, other: object) -> float:
    """The time until the front of a car is where the rear of an object ahead is now: gap / v."""
    found = _along_lane(car, other)
    if found is None:
        return math.inf
    gap, own, _ = found
    return gap / own if own > 1e-9 else math.inf


def required_deceleration(car: object, other: object) -> float:
    """The constant deceleration by which a car just does not run into an object ahead that keeps its speed: (v - v_other)^2 / (2 gap).

    It is 0 where none is required, and infinite at contact.
    """
    gap_and_speeds = _along_lane(car, other)
    if gap_and_speeds is None:
        return 0.0
    gap, own_speed, ahead = gap_and_speeds
    if own_speed <= ahead:
        return 0.0
    return math.inf if gap == 0 else (own_speed - ahead) ** 2 / (2 * gap)


def distance_to_lane_border(car: Any) -> float:
    """Return the distance from the outline of a car to the nearest side of its lane; negative as far as the car is across it."""
    import shapely

    lane = car._lane
    if lane is None:
        return -math.inf
    sides = [shapely.LineString(side) for side in (lane.left, lane.right)]
    corners = _corners(car)
    outline = shapely.Polygon(corners)
    if all(not outline.intersects(side) for side in sides):
        return float(min(outline.distance(side) for side in sides))
    middle = shapely.LineString(lane.line)
    return -max(
        float(side.distance(shapely.Point(corner)))
        for side in sides
        for corner in corners
        if shapely.LineString(
            [corner, middle.interpolate(middle.project(shapely.Point(corner))).coords[0]]
        ).intersects(side)
    )


def is_running_red(car: Any) -> bool:
    """Return whether a car enters an intersection now while the light of its approach is red: its front is in, its rear is not.

    `record` this measure in each step; the number of true values times the step is the time in red.
    """
    if not is_simulating():
        return False  # nothing drives in a scene
    simulation = running_simulation()
    network = car.roadNetwork
    ahead, back = ((side * car.length / 2) for side in (1, -1))
    sine, cosine = math.sin(car.heading), math.cos(car.heading)
    x, y, z = car.position
    front, rear = ((x - part * sine, y + part * cosine, z) for part in (ahead, back))
    intersection = network.intersectionAt(front)
    if intersection is None or network.intersectionAt(rear) is not None:
        return False
    lane = network.laneAt(rear)
    if lane is None or car.speed < 0.05:
        return False
    ways = [item for item in intersection.maneuvers if item.startLane is lane]
    lights = {item.uid: item for way in ways for item in way.signals if item.isTrafficLight}
    # Of an approach with several lights, some may be for other ways.
    return bool(lights) and all(simulation.signalState(item) == "red" for item in lights.values())


class PostEncroachment:
    """Post-encroachment time of two objects: from one leaving the place that both pass until the other one arrives.

    B. L. Allen, B. T. Shin, P. J. Cooper, Analysis of Traffic Conflicts and Collisions, Transportation Research Record 667, 1978.

    Args:
        one: outlines of an object over time, shapely polygons.
        other: those of the other one at the same times.
        timestep: seconds between outlines.

    """

    def __init__(self, one: list[Any], other: list[Any], timestep: float) -> None:
        import shapely

        self._area = shapely.intersection(shapely.union_all(one), shapely.union_all(other))
        self._spans = [self._inside(course) for course in (one, other)]
        self._timestep = timestep

    def _inside(self, course: list[Any]) -> tuple[int, int] | None:
        import shapely

        if self._area.is_empty:
            return None
        steps = np.flatnonzero(shapely.intersects(np.array(course, dtype=object), self._area))
        return (int(steps[0]), int(steps[-1])) if len(steps) else None

    @property
    def time(self) -> float:
        """Seconds; 0 if both are there at once, infinite if no place is passed by both."""
        first, second = self._spans
        if first is None or second is None:
            return math.inf
        steps = max(second[0] - first[1], first[0] - second[1])
        return max(0.0, steps * self._timestep)


def post_encroachment_time(simulation: Any, one: Any, other: Any) -> float:
    """The post-encroachment time of two objects of a finished simulation, in seconds; see `PostEncroachment`."""
    import shapely

    things = list(simulation.scene.objects)
    courses = []
    for thing in (one, other):
        number = next(index for index, item in enumerate(things) if item is thing)
        outlines = []
        for state in simulation.trajectory:
            x, y, *_ = state.positions[number]
            yaw = state.orientations[number].yaw
            sine, cosine = math.sin(yaw), math.cos(yaw)
            a, b = thing.width / 2, thing.length / 2
            outlines.append(
                shapely.Polygon(
                    [
                        (x + u * cosine - v * sine, y + u * sine + v * cosine)
                        for u, v in ((-a, -b), (a, -b), (a, b), (-a, b))
                    ]
                )
            )
        courses.append(outlines)
    return PostEncroachment(courses[0], courses[1], float(simulation.timestep)).time
