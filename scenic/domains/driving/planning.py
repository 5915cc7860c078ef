"""Plans of drivers: a path ahead, made longer as the car goes on, and the speeds on it."""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import Lane, Maneuver
from scenic.domains.driving.narrow_lanes import ways_after
from scenic.domains.driving.path_smoothing import TIGHTEST
from scenic.domains.driving.paths import Path, PathPieces, is_long
from scenic.domains.driving.speed_profiles import Comfort, speeds_along, speeds_in_bends

__all__ = ["MotionPlan", "Pace", "join", "speeds_of"]

Floats = NDArray[np.float64]

_MARGIN: Final = 50.0
"""Metres of path that a plan has ahead at least, beyond the way of braking."""
_OFF: Final = 0.05
"""Metres beside a path from which a car joins it along a curve of its own."""
_TURNED: Final = 0.02
"""Angle (radians) between a car and a path from which it does."""
_PULL: Final = 0.5
"""Lateral acceleration (m/s^2) by which the car would leave the path, with its steering wheel as it is, from which it does."""
_SHARPEST: Final = 0.2
"""Curvature (1/m) of curves by which a car joins a path."""
_SHORTEST: Final = 6.0
"""Metres that a car takes to join a path on which it stops sooner."""
_SLOW: Final = 2.5
"""Speed (m/s) at which times along a path are computed where a car is slower: it bends its way no more than this lets it."""


class MotionPlan:
    """The way ahead of a car: along a lane, and through the maneuvers that are chosen.

    Args:
        network: the road network.
        lane: the lane in which the plan begins.
        backward: against the direction of the lanes.
        tightest: curvature (1/m) that the path may have.

    Attributes:
        path: the path so far.
        is_complete: nothing more can be chosen: the path ends where the network does.

    """

    def __init__(
        self, network: Any, lane: Lane, *, backward: bool = False, tightest: float = TIGHTEST
    ) -> None:
        self._pieces: PathPieces = network.path_pieces(backward=backward, tightest=tightest)
        self._backward = backward
        self.path = Path()
        self.is_complete = False
        self._pending: list[Lane] = [lane]
        self._opens = is_long(lane)
        if self._opens:
            self.path.extend(self._pieces.start(lane))
        if not self.choices:
            self._close()

    def _close(self) -> None:
        """End the path with the last lane."""
        lanes = self._pending
        if self._opens and len(lanes) == 1:
            self.path.extend(self._pieces.end(lanes[0]))
        else:
            self.path.extend(self._pieces.between(lanes, opens=self._opens, closes=False))
        self.is_complete = True

    @property
    def last_lane(self) -> Lane:
        """The lane after which the plan goes on."""
        return self._pending[-1]

    @property
    def choices(self) -> tuple[Any, ...]:
        """The ways to go on after the last lane: maneuvers straight ahead if there are any, else all; backward, a lane."""
        last = self._pending[-1]
        if self._backward:
            before = last._predecessor
            return (before,) if isinstance(before, Lane) else ()
        return ways_after(last)

    def choose(self, choice: Maneuver | Lane) -> None:
        """Go on by a maneuver."""
        if isinstance(choice, Lane):
            lanes = [choice]
        else:
            lanes = [lane for lane in (choice.connectingLane, choice.endLane) if lane is not None]
        self._pending += lanes
        last = self._pending[-1]
        if is_long(last):
            self.path.extend(self._pieces.between(self._pending, opens=self._opens, closes=True))
            self._pending, self._opens = [last], True
        if not self.choices:
            self._close()

    def reserve(self, speed: float, deceleration: float) -> float:
        """Metres of path ahead from which on the next choice is due: more than the way of braking from a speed."""
        return speed * speed / (2 * deceleration) + 2 * speed + _MARGIN


class Pace:
    """The places of a car on its way over time.

    Args:
        along: metres ``(n,)`` ahead of the car; the first are 0.
        speeds: there ``(n,)``, m/s, all positive.

    Attributes:
        end: metres ahead where the car stops.

    """

    def __init__(self, along: Floats, speeds: Floats) -> None:
        self._along, self._speeds = along, speeds
        self.end = math.inf
        means = (speeds[1:] + speeds[:-1]) / 2
        self._moments = np.concatenate([[0.0], np.cumsum(np.diff(along) / means)])
        self._changes = np.gradient(speeds, along) if len(along) > 1 else np.zeros(len(along))

    @classmethod
    def planned(cls, along: Floats, speeds: Floats) -> "Pace":
        """The pace by a speed profile; of a car that is slow, what it would be a little faster."""
        pace = cls(along, (speeds**4 + _SLOW**4) ** 0.25)
        standing = np.flatnonzero(speeds[1:] <= 0.0)
        if len(standing):
            pace.end = float(along[standing[0] + 1])
        return pace

    def way(self, time: float) -> float:
        """Metres that the car goes in seconds."""
        beyond = time - self._moments[-1]
        if beyond > 0:
            return float(self._along[-1] + beyond * self._speeds[-1])
        return float(np.interp(time, self._moments, self._along))

    def at(self, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        """Seconds until the car is at places ``(k,)`` metres ahead, its speeds there, and their changes (1/s) by the metre."""
        beyond = ahead - np.clip(ahead, 0.0, self._along[-1])
        speeds = np.interp(ahead, self._along, self._speeds)
        moments = np.interp(ahead, self._along, self._moments) + beyond / speeds
        return moments, speeds, np.where(beyond == 0, np.interp(ahead, self._along, self._changes), 0.0)


def join(
    path: Path,
    place: Any,
    heading: float,
    speed: float,
    duration: float = 0.0,
    near: float | None = None,
    curvature: float | None = None,
    pace: Callable[[], Pace] | None = None,
) -> float:
    """Bend a path so that it begins where a car is, in the direction of the car: a lateral offset of least jerk.

    The offset is the polynomial of fifth order in time that has the offset, slope and curvature of the car at its beginning, and
    none at its end (T. Flash and N. Hogan, The Coordination of Arm Movements, 1985).

    Args:
        path: the path, which changes.
        place: the position of the car.
        heading: of the car, radians.
        speed: of the car, m/s.
        duration: seconds that the car takes at least; 0 for as few as comfort allows.
        near: metres along the path about which the car is.
        curvature: of the way of the car, in 1/m, positive to the left; that of the path by default.
        pace: computes that of the car on its way; its present speed by default.

    Returns:
        Metres along the path until the car is on it.

    """
    x, y, *_ = place
    index, share, offset = path.locate(x, y, path.nearest(x, y, near))
    if (share < 0 and index == 0) or (share > 1 and index == len(path.along) - 2):
        return 0.0
    direction, bend = (
        values[index] + min(max(share, 0.0), 1.0) * (values[index + 1] - values[index])
        for values in (path.headings, path.curvatures)
    )
    heading_error = (heading - direction + math.pi) % (2 * math.pi) - math.pi
    bend = 0.0 if curvature is None else curvature - bend
    pull = abs(bend) * speed * speed
    if duration == 0.0 and abs(offset) < _OFF and abs(heading_error) < _TURNED and pull < _PULL:
        return 0.0
    slope = math.tan(min(max(heading_error, -1.2), 1.2))
    # The acceleration of a curve of least jerk is 5.77 d / T^2 at most, of which 2 m/s^2 are allowed, and its jerk 60 d / T^3, of
    # which 3.4 m/s^3 are unless a time is given; the jerk of a slope m is 36 m v / T^2.
    time = duration or math.cbrt(60.0 * abs(offset) / 3.4)
    time = max(time, math.sqrt(5.77 * abs(offset) / 2.0))
    time = max(time, min(3.0 * math.sqrt(abs(slope) * speed), 4.0))
    # Acceleration `pull` ends with a jerk of 9 pull / T at first; longer ways would lead too far from the path.
    time = max(time, min(1.3 * pull, 2.0))
    if pace is None:
        even = max(speed, 4.0 / time, 6.0 * abs(offset) ** 0.5 / time)
        going = Pace(np.array([0.0]), np.array([even]))
    else:
        going = pace()
    along, curvatures = np.array(path.along), np.array(path.curvatures)
    start = along[index] + share * (along[index + 1] - along[index])
    left = min(along[-1] - start, max(going.end, _SHORTEST))
    bends, least = _Offset(going, time, offset, slope, bend), math.inf
    for attempt in range(9):
        longer = _Offset(going, 1.3**attempt * time, offset, slope, bend)
        count = int(np.searchsorted(along, start + longer.distance, side="right"))
        if longer.distance >= left or count - index < 6:
            break
        ahead = np.maximum(along[index:count] - start, 0.0)
        sharpest = float(np.abs(longer.curvatures(ahead) + curvatures[index:count]).max())
        if sharpest < least:
            bends, least = longer, sharpest
        known = max(float(np.abs(curvatures[index:count]).max()), abs(curvature or 0.0))
        if sharpest <= max(_SHARPEST, 1.05 * known):
            break
    if bends.distance > max(left, 1.0):
        bends = _Offset(going, float(going.at(np.array([max(left, 1.0)]))[0][0]), offset, slope, bend)
    count = int(np.searchsorted(along, start + bends.distance, side="right"))
    # The path bends to where it was behind the car, where nobody looks at its curvature.
    begin = max(0, index - 8)
    path.shifted(begin, bends.offsets(along[begin:count] - start))
    return bends.distance


class _Offset:
    """The polynomial of fifth order in time from an offset and its two derivatives along the way at 0 to nothing, where it has none.

    Args:
        pace: of the car.
        time: seconds that it takes.
        offset: metres to the left of the path.
        slope: radians from it, to the left.
        bend: curvature (1/m) against it.

    """

    def __init__(self, pace: Pace, time: float, offset: float, slope: float, bend: float) -> None:
        self.time, self.distance = time, pace.way(time)
        self._pace, self._first = pace, (offset, slope, bend)
        _, (speed,), (change,) = pace.at(np.zeros(1))
        rate = slope * speed * time
        bent = (bend * speed * speed + slope * speed * change) * time * time
        terms = offset * np.array([1.0, 0.0, 0.0, -10.0, 15.0, -6.0])
        terms += rate * np.array([0.0, 1.0, 0.0, -6.0, 8.0, -3.0])
        terms += bent / 2 * np.array([0.0, 0.0, 1.0, -3.0, 3.0, -1.0])
        self._curve = np.polynomial.Polynomial(terms)

    def offsets(self, ahead: Floats) -> Floats:
        """Metres ``(k,)`` to the left of the path at places ``(k,)`` metres ahead of the car, or behind it."""
        share = np.clip(self._pace.at(np.maximum(ahead, 0.0))[0] / self.time, 0.0, 1.0)
        offset, slope, bend = self._first
        return np.where(ahead < 0, offset + slope * ahead + bend * ahead**2 / 2, self._curve(share))

    def curvatures(self, ahead: Floats) -> Floats:
        """Return the curvatures ``(k,)`` that the offset adds to those of the path at places ``(k,)`` metres ahead, before the end."""
        moments, speeds, changes = self._pace.at(ahead)
        share = np.clip(moments / self.time, 0.0, 1.0)
        first, second = (self._curve.deriv(order)(share) / self.time**order for order in (1, 2))
        added: Floats = (second - first * changes) / speeds**2
        return added


def speeds_of(
    path: Path,
    begin: int,
    target: float,
    speed: float,
    comfort: Comfort,
    *,
    limits: Floats | None,
    stops: float | None,
    acceleration: float = 0.0,
    junctions: Sequence[tuple[int, int]] = (),
) -> tuple[list[float], list[float]]:
    """Speeds and accelerations at the points of a path from an index on.

    Args:
        path: the path.
        begin: index of the point at which the car is.
        target: speed to reach, m/s.
        speed: of the car, m/s.
        comfort: what limits the speed.
        limits: further largest speeds at all points of the path, m/s.
        stops: metres before the end of the path at which the car stops, if it does.
        acceleration: of the car so far, m/s^2.
        junctions: stretches of the path, from and to an index, through which the car does not brake for what comes after.

    """
    along = np.array(path.along[begin:])
    curvatures = np.array(path.curvatures[begin:])
    top = speeds_in_bends(along, curvatures, comfort, np.array(path.bends[begin:]))
    target_speeds = np.full(len(top), target)
    if limits is not None:
        target_speeds = np.minimum(target_speeds, limits[begin : begin + len(top)])
    count = len(along)
    if stops is not None:
        count = max(2, int(np.searchsorted(along, along[-1] - stops, side="right")))
    ahead = [
        (max(0, low - begin), high - begin) for low, high in junctions if high > begin and low - begin < count
    ]
    speeds, accelerations = speeds_along(
        along[:count],
        top[:count],
        speed,
        comfort,
        wanted=target_speeds[:count],
        acceleration=acceleration,
        stops=stops is not None,
        junctions=ahead,
    )
    rest = [0.0] * (len(along) - count)
    return speeds.tolist() + rest, accelerations.tolist() + rest
