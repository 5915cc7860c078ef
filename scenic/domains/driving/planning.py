"""Plans of drivers: a path ahead, made longer as the car goes on, and the speeds on it."""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import Lane, Maneuver
from scenic.domains.driving.narrow_lanes import ways_after
from scenic.domains.driving.path_smoothing import TIGHTEST, resampled, smoothed
from scenic.domains.driving.paths import Path, PathPieces, is_long, piece_along
from scenic.domains.driving.speed_profiles import Comfort, speeds_along, speeds_in_bends

__all__ = ["MotionPlan", "join", "path_of_lines", "speeds_of"]

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


def path_of_lines(lines: Sequence[Floats], tightest: float = TIGHTEST) -> Path:
    """The smooth path along lines ``(n, 2)``, one after the other, of a curvature (1/m) that a car drives."""
    points = smoothed(resampled(np.concatenate(lines)), tightest=tightest)
    return Path(piece_along(points))


def join(
    path: Path,
    place: Any,
    heading: float,
    speed: float,
    duration: float = 0.0,
    near: float | None = None,
    curvature: float | None = None,
    reach: Callable[[float, float], float] | None = None,
) -> float:
    """Bend a path so that it begins where a car is, in the direction of the car: a lateral offset of least jerk.

    The offset is the polynomial of fifth order that has the offset, slope and curvature of the car at its beginning, and none at
    its end (T. Flash and N. Hogan, The Coordination of Arm Movements, 1985).

    Args:
        path: the path, which changes.
        place: the position of the car.
        heading: of the car, radians.
        speed: of the car, m/s.
        duration: seconds that the car takes at least; 0 for as few as comfort allows.
        near: metres along the path about which the car is.
        curvature: of the way of the car, in 1/m, positive to the left; that of the path by default.
        reach: metres that the car goes in some seconds, and at least as many as other seconds take it at its greatest speed in
            them; at its present speed by default.

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
    least = math.sqrt(5.77 * abs(offset) / 2.0)
    time = max(time, least)
    time = max(time, min(3.0 * math.sqrt(abs(slope) * speed), 4.0))
    # Acceleration `pull` ends with a jerk of 9 pull / T at first; longer ways would lead too far from the path.
    time = max(time, min(1.3 * pull, 2.0))
    distance = max(speed * time if reach is None else reach(time, least), 4.0, 6.0 * abs(offset) ** 0.5)
    along = np.array(path.along)
    start = along[index] + share * (along[index + 1] - along[index])
    left = along[-1] - start
    curvatures = np.array(path.curvatures)
    for _ in range(8):
        count = int(np.searchsorted(along, start + min(distance, left), side="right"))
        if distance >= left or count - index < 6:
            break
        share_done = np.clip((along[index:count] - start) / distance, 0.0, 1.0)
        second = _second_derivative(share_done, offset, slope * distance, bend * distance**2) / distance**2
        if np.abs(second + curvatures[index:count]).max() <= max(
            _SHARPEST, 1.05 * np.abs(curvatures[index:count]).max(), abs(curvature or 0.0)
        ):
            break
        distance *= 1.3
    distance = min(distance, max(left, 1.0))
    count = int(np.searchsorted(along, start + distance, side="right"))
    share_done = (along[:count] - start) / distance
    # The path bends to where it was behind the car, where nobody looks at its curvature.
    begin = max(0, index - 8)
    offsets = _offset(share_done[begin:], offset, slope * distance, bend * distance**2)
    path.shifted(begin, offsets)
    return float(distance)


def _offset(share: Floats, offset: float, slope: float, bend: float) -> Floats:
    """The polynomial of fifth order from an offset and its two derivatives at 0 to nothing at 1, where it has none."""
    t = np.minimum(share, 1.0)
    rest: Floats = (
        offset * (1 - 10 * t**3 + 15 * t**4 - 6 * t**5)
        + slope * (t - 6 * t**3 + 8 * t**4 - 3 * t**5)
        + bend * (t**2 - 3 * t**3 + 3 * t**4 - t**5) / 2
    )
    return np.where(share < 0, offset + slope * share + bend * share**2 / 2, rest)


def _second_derivative(t: Floats, offset: float, slope: float, bend: float) -> Floats:
    result: Floats = (
        offset * (-60 * t + 180 * t**2 - 120 * t**3)
        + slope * (-36 * t + 96 * t**2 - 60 * t**3)
        + bend * (1 - 9 * t + 18 * t**2 - 10 * t**3)
    )
    return result


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
