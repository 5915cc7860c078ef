"""Distances that drivers keep: the intelligent driver model, and who is ahead on a path."""

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.domains.driving.paths import Path

__all__ = ["Course", "Gap", "Leader", "Traffic", "following_acceleration", "leader_on"]

_HORIZON: Final = 120.0
"""Metres ahead in which others count."""
_BESIDE: Final = 0.3
"""Metres between the sides of two cars below which one is in the other's way."""
_STRIDE: Final = 4
"""Points of a path from one that is looked at to the next one."""
_REACH: Final = 12.0
"""Metres from such a point within which the middle of a long vehicle that reaches the path lies."""


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
        """Its speed in the direction of a heading (radians), m/s; at least 0."""
        vx, vy, *_ = self.item.velocity
        return max(0.0, float(vy * math.cos(heading) - vx * math.sin(heading)))


class Traffic:
    """The places of all objects of a simulation at one step, as columns that all drivers read.

    Attributes:
        items: the objects.
        places: their middles as complex numbers ``(n,)``.

    """

    __slots__ = ("items", "places")

    def __init__(self, items: Sequence[Any]) -> None:
        self.items = items
        self.places = np.array([complex(x, y) for x, y, *_ in (item.position for item in items)], complex)


class Course:
    """Points of a path from an index on, every few of them, by which drivers find who is near to it."""

    __slots__ = ("_begin", "_path", "_points")

    def __init__(self, path: Path, begin: int) -> None:
        self._path, self._begin = path, begin
        x, y = path.stretch(begin, len(path.along))[::_STRIDE].T
        self._points = x + 1j * y

    def ahead(self, along: float, index: int) -> tuple[NDArray[np.complex128], int, int]:
        """The points from an index to metres along the path.

        Returns:
            The points as complex numbers, and the indices of the first and the last one in the path.

        """
        path, first = self._path, max(index - self._begin, 0) // _STRIDE
        last = path.index_at(along, index)
        points = self._points[first : (last - self._begin) // _STRIDE + 2]
        return points, self._begin + first * _STRIDE, last


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
    x, y, *_ = agent.position
    near = np.flatnonzero(np.abs(traffic.places - complex(x, y)) < _HORIZON)
    if not len(near):
        return None
    along = path.along
    points, begin, end = course.ahead(along[index] + _HORIZON, index)
    if not len(points):
        return None
    away = np.abs(points - traffic.places[near][:, None])
    nearest = away.argmin(axis=1)
    beside = away[np.arange(len(near)), nearest] < _REACH
    best: Leader | None = None
    for number, point in zip(near[beside].tolist(), nearest[beside].tolist(), strict=True):
        other = traffic.items[number]
        if other is agent:
            continue
        a, b, *_ = other.position
        point, share, side = path.locate(a, b, min(begin + _STRIDE * point, end))
        place = along[point] + share * (along[point + 1] - along[point])
        if place <= along[index] or (best is not None and place >= best.along):
            continue
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
