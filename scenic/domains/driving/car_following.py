"""Distances that drivers keep: the intelligent driver model, and who is ahead on a path."""

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.domains.driving.paths import Path
from scenic.domains.driving.wrong_arguments import impossible_argument

__all__ = ["Course", "Gap", "Leader", "Traffic", "following_acceleration", "leader_on"]

_HORIZON: Final = 120.0
"""Metres ahead in which others count."""
_BESIDE: Final = 0.3
"""Metres between the sides of two cars below which one is in the other's way."""
_STRIDE: Final = 4
"""Points of a path from one that is looked at to the next one."""
_REACH: Final = 12.0
"""Metres from such a point within which the middle of a long vehicle that reaches the path lies."""
_AWAY: Final = 1.1
"""Metres from a place on the path to the nearest such point at most."""


@dataclass(frozen=True, slots=True)
class Gap:
    """The distance that a driver keeps.

    Attributes:
        headway: seconds between the front of the car and the rear of the one ahead.
        standing: metres between them at rest.
        is_of_centres: ``standing`` counts between the centres of the cars.

    """

    headway: float = 1.5
    standing: float = 2.0
    is_of_centres: bool = False

    def __post_init__(self) -> None:
        if not self.headway >= 0:
            raise impossible_argument(
                "follow_gap",
                f"no car keeps {self.headway} s behind others",
                "give a number of seconds, at least 0",
            )


@dataclass(frozen=True, slots=True)
class Leader:
    """Somebody ahead.

    Attributes:
        item: the object.
        along: metres along the path to its middle.
        reach: half of its extent along the path, in metres.

    """

    item: Any
    along: float
    reach: float

    def speed_along(self, heading: float) -> float:
        """Return the leader's speed in the direction of a heading (radians), m/s; at least 0."""
        vx, vy, *_ = self.item.velocity
        return max(0.0, float(vy * math.cos(heading) - vx * math.sin(heading)))


class Traffic:
    """The places of all objects of a simulation at one step, as columns that all drivers read.

    Attributes:
        items: the objects.
        places: their middles.
        halves: half of the diagonal of each, seen from above, in metres.
        columns: of the middles: x, y, their squared distance from the origin, and 1, ``(n, 4)``.

    """

    __slots__ = ("columns", "halves", "items", "places")

    def __init__(self, items: Sequence[Any]) -> None:
        self.items = items
        self.places = [(x, y) for x, y, *_ in (item.position for item in items)]
        self.halves = [math.hypot(item.length, item.width) / 2 for item in items]
        self.columns = np.array([(x, y, x * x + y * y, 1.0) for x, y in self.places]).reshape(-1, 4)


class Course:
    """Points of a path from an index on, every few of them, by which drivers find who is near to it."""

    __slots__ = ("_begin", "_path", "_rows")

    def __init__(self, path: Path, begin: int) -> None:
        self._path, self._begin = path, begin
        x, y = path.stretch(begin, len(path.along))[::_STRIDE].T
        self._rows = np.stack([-2 * x, -2 * y, np.ones(len(x)), x * x + y * y])

    def near(self, traffic: Traffic, index: int, end: int, margin: float) -> list[tuple[int, int]]:
        """Return who may reach within metres of the path from one index to another one.

        Returns:
            Numbers of objects of the traffic, each with the index of a point of the path near to it.

        """
        first = max(index - self._begin, 0) // _STRIDE
        rows = self._rows[:, first : (end - self._begin) // _STRIDE + 2]
        count = rows.shape[1]
        if not count:
            return []
        # |p - q|^2 = |p|^2 - 2 p q + |q|^2, of all pairs at once.
        squares = traffic.columns @ rows
        least = squares.min(axis=1)
        near = (least < _REACH * _REACH).nonzero()[0]
        begin, halves = self._begin + first * _STRIDE, traffic.halves
        margin += _AWAY
        found = []
        for number, square in zip(near.tolist(), least[near].tolist(), strict=True):
            point = int(squares[number].argmin())
            # Beyond the ends, the path goes on straight.
            if square < (halves[number] + margin) ** 2 or point == 0 or point == count - 1:
                found.append((number, min(begin + _STRIDE * point, end)))
        return found


def following_acceleration(
    speed: float, distance: float, ahead: float, gap: Gap, acceleration: float, deceleration: float
) -> float:
    """Return the acceleration (m/s^2) by which a driver keeps the gap to a car ahead.

    The interaction of the intelligent driver model (M. Treiber, A. Hennecke, D. Helbing, Congested traffic states in empirical
    observations and microscopic simulations, Physical Review E 62, 2000): a [1 - (s* / s)^2] with
    s* = s0 + v T + v (v - v_ahead) / (2 sqrt(a b)).

    Args:
        speed: of the driver's car, m/s.
        distance: between the cars, m.
        ahead: speed of the car ahead, m/s.
        gap: what the driver keeps.
        acceleration: a, m/s^2.
        deceleration: b, m/s^2.

    """
    approach = speed * (speed - ahead) / (2 * math.sqrt(acceleration * deceleration))
    target_gap = gap.standing + max(0.0, speed * gap.headway + approach)
    return acceleration * (1 - (target_gap / max(distance, 0.1)) ** 2)


def leader_on(path: Path, index: int, agent: Any, traffic: Traffic, course: Course) -> Leader | None:
    """Return the first object that is on a path ahead of a car, at the height of the path.

    Args:
        path: of the car.
        index: of the point of the path at which the car is.
        agent: the car.
        traffic: where everybody is.
        course: of the path.

    """
    along = path.along
    own = along[index]
    end = path.index_at(own + _HORIZON, index)
    x, y, *_ = agent.position
    margin = agent.width / 2 + _BESIDE
    best: Leader | None = None
    for number, start in course.near(traffic, index, end, margin):
        other = traffic.items[number]
        a, b = traffic.places[number]
        if other is agent or math.hypot(a - x, b - y) >= _HORIZON:
            continue
        point, share, side = path.locate(a, b, start)
        place = along[point] + share * (along[point + 1] - along[point])
        if place <= own or (best is not None and place >= best.along):
            continue
        if abs(side) > traffic.halves[number] + margin:
            continue  # however it is turned
        heading_difference = other.heading - path.headings[point]
        sine, cosine = abs(math.sin(heading_difference)), abs(math.cos(heading_difference))
        half = (other.length * sine + other.width * cosine) / 2
        if abs(side) < half + agent.width / 2 + _BESIDE and _is_level(path, point, other):
            best = Leader(other, place, (other.length * cosine + other.width * sine) / 2)
    return best


def _is_level(path: Path, point: int, other: Any) -> bool:
    """Return whether an object is at the height of a path, and not on a bridge above it or on a road below it."""
    lane = path.lane_at(point)
    return lane is None or bool(lane.network.is_level(lane, other.position))
