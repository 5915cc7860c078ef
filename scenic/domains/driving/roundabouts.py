"""Roundabouts of a road network: lanes of one way that close to a ring round its middle."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.domains.driving.elements import Lane
from scenic.domains.driving.enumerations import turned
from scenic.domains.driving.network import RoadNetwork

__all__ = ["Roundabout", "roundabouts"]

_LONGEST: Final = 400.0
"""Metres round the largest ring."""
_ROUND: Final = 0.82
"""Area of a ring, in parts of that of a circle of its length, from which on it is round; that of a square is 0.785."""
_BACK: Final = 0.4
"""Radians by which a part of a ring may turn outward, as where it meets a ramp."""
_ONE: Final = 0.3
"""Rings whose middles are nearer to each other than so many parts of their radius are lanes of one roundabout."""


@dataclass(frozen=True, slots=True)
class Roundabout:
    """A roundabout.

    Attributes:
        center: its middle, metres.
        radius: of the ring's innermost lane, metres.
        lanes: those of the ring that was found first, in the direction of traffic.
        arms: roads that lead into it or out of it.

    """

    center: tuple[float, float]
    radius: float
    lanes: tuple[Lane, ...]
    arms: int


def roundabouts(network: RoadNetwork) -> tuple[Roundabout, ...]:
    """The roundabouts of a network: rings of one-way lanes round a middle, at most 400 m long, in the direction of circular traffic."""
    way = -1.0 if network.driveOnLeft else 1.0
    after = _continuations(network)
    rings: list[Roundabout] = []
    for lane in network.lanes:
        if lane.is_connecting or not lane.road.is1Way or any(lane in item.lanes for item in rings):
            continue
        ring = next(_rings(lane, after, way), None)
        if ring is None:
            continue
        center, radius = _circle(ring)
        near = [item for item in rings if math.dist(item.center, center) < _ONE * radius]
        if not near:
            rings.append(Roundabout(center, radius, ring, _arms(network, ring)))
    return tuple(rings)


def _continuations(network: RoadNetwork) -> dict[int, list[Lane]]:
    """Return the lanes that go on from each lane, by its identity."""
    after: dict[int, list[Lane]] = {}
    for maneuver in network.maneuvers:
        parts = [maneuver.startLane, maneuver.connectingLane, maneuver.endLane]
        lanes = [lane for lane in parts if lane is not None]
        for lane, follower in pairwise(lanes):
            followers = after.setdefault(id(lane), [])
            if not any(follower is other for other in followers):
                followers.append(follower)
    for lane in network.lanes:
        follower = lane._successor
        if isinstance(follower, Lane):
            after.setdefault(id(lane), [follower])
    return after


def _rings(start: Lane, after: dict[int, list[Lane]], way: float) -> Iterator[tuple[Lane, ...]]:
    """Yield ways from a lane back to itself that turn once round, only in the direction of circular traffic."""
    waiting: list[tuple[tuple[Lane, ...], float, float]] = [
        ((start,), _length(start), way * turned(start.line))
    ]
    while waiting:
        path, length, turn = waiting.pop()
        for lane in after.get(id(path[-1]), ()):
            if lane is start:
                if abs(turn - 2 * math.pi) < 0.6 and _roundness(path) > _ROUND:
                    yield path
                continue
            further, bend = length + _length(lane), way * turned(lane.line)
            is_ring = lane.is_connecting or lane.road.is1Way
            if not is_ring or further > _LONGEST or bend < -_BACK or turn + bend > 2 * math.pi + 0.6:
                continue
            if not any(lane is other for other in path):
                waiting.append(((*path, lane), further, turn + bend))


def _length(lane: Lane) -> float:
    return float(np.hypot(*np.diff(lane.line, axis=0).T).sum())


def _points(ring: tuple[Lane, ...]) -> NDArray[np.float64]:
    return np.concatenate([lane.line for lane in ring])


def _roundness(ring: tuple[Lane, ...]) -> float:
    """Return the area that lanes enclose, in parts of that of a circle of the same length."""
    points = _points(ring)
    x, y = (points - points.mean(axis=0)).T
    area = 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))
    length = float(np.hypot(*(np.roll(points, -1, axis=0) - points).T).sum())
    return 4 * math.pi * area / max(length * length, 1e-9)


def _circle(ring: tuple[Lane, ...]) -> tuple[tuple[float, float], float]:
    """Return the middle and radius of the circle that fits lanes best: least squares on ``x^2 + y^2 = 2 a x + 2 b y + c`` (Kåsa, 1976)."""
    points = _points(ring)
    columns = np.column_stack([2 * points, np.ones(len(points))])
    (a, b, c), *_ = np.linalg.lstsq(columns, (points * points).sum(axis=1))
    return (float(a), float(b)), math.sqrt(max(float(c + a * a + b * b), 0.0))


def _arms(network: RoadNetwork, ring: tuple[Lane, ...]) -> int:
    """The number of roads beside the ring that lead into it or out of it."""
    ring_roads = {lane.road.uid for lane in ring}
    parts = {id(lane) for lane in ring}
    places = {
        id(maneuver.intersection) for maneuver in network.maneuvers if id(maneuver.connectingLane) in parts
    }
    roads = {
        lane.road.uid
        for maneuver in network.maneuvers
        if id(maneuver.intersection) in places
        for lane in (maneuver.startLane, maneuver.endLane)
    }
    return len(roads - ring_roads)
