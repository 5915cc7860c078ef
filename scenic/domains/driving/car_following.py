"""Distances that drivers keep: the intelligent driver model, and who is ahead on a path."""

import math
from collections.abc import Iterable
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.domains.driving.paths import Path

__all__ = ["Gap", "Leader", "following_acceleration", "leader_on"]

_HORIZON: Final = 120.0
"""Metres ahead in which others count."""
_BESIDE: Final = 0.3
"""Metres between the sides of two cars below which one is in the other's way."""


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


def following_acceleration(
    speed: float, distance: float, ahead: float, gap: Gap, acceleration: float, deceleration: float
) -> float:
    """The acceleration (m/s^2) by which a driver keeps the gap to a car ahead.

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
    wanted = gap.standing + max(0.0, speed * gap.headway + approach)
    return acceleration * (1 - (wanted / max(distance, 0.1)) ** 2)


def leader_on(path: Path, index: int, agent: Any, others: Iterable[Any]) -> Leader | None:
    """The first of some objects that is on a path ahead of a car.

    Args:
        path: of the car.
        index: of the point of the path at which the car is.
        agent: the car.
        others: the objects.

    """
    x, y, *_ = agent.position
    near = []
    for other in others:
        if other is agent:
            continue
        a, b, *_ = other.position
        if abs(a - x) < _HORIZON and abs(b - y) < _HORIZON:
            near.append((a, b, other))
    if not near:
        return None
    along = path.along
    last = path.index_at(along[index] + _HORIZON, index) + 1
    points = path.stretch(index, last + 1)
    places = np.array([item[:2] for item in near])
    away = np.abs(points[None] - places[:, None]).max(axis=2)
    nearest = away.argmin(axis=1)
    best: Leader | None = None
    for number, (a, b, other) in enumerate(near):
        point = index + int(nearest[number])
        if away[number, nearest[number]] > 6.0:
            continue
        point, share, side = path.locate(a, b, point)
        place = along[point] + share * (along[point + 1] - along[point])
        ahead = place - along[index]
        if ahead <= 0 or (best is not None and place >= best.along):
            continue
        turned = other.heading - path.headings[point]
        sine, cosine = abs(math.sin(turned)), abs(math.cos(turned))
        half = (other.length * sine + other.width * cosine) / 2
        if abs(side) < half + agent.width / 2 + _BESIDE:
            best = Leader(other, place, (other.length * cosine + other.width * sine) / 2)
    return best
