"""Speeds along a path: as fast as bends allow, with braking that ends before them, and without jolts.

Two passes limit the squared speed by constant acceleration and deceleration (forward and backward along the path). The result is
averaged over a moving window of time, so that acceleration changes at a bounded rate.
"""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.language.errors import InvalidScenarioError
from scenic.runtime.ground.context import here

__all__ = ["Comfort", "speeds_along", "speeds_in_bends"]

Floats = NDArray[np.float64]

_EMERGENCY: Final = 6.0
"""Deceleration (m/s^2) of a car that is too fast for what lies ahead."""
_BEND: Final = 0.015
"""Curvature (1/m) from which on a path is in a bend."""
_AHEAD: Final = 18.0
"""Metres of a bend that count from its beginning on."""
_HARDER: Final = 1.25
"""Times the comfortable deceleration from which on a car brakes at once."""
_TOLERANCE: Final = 1.1
"""Times the squared speed limits up to which no car brakes at once."""
_FEW: Final = 4
"""Points of a path on which a car that is too fast brakes hard, at least."""
_SOON: Final = 0.65
"""Seconds over which acceleration changes of a car that comes to what it brakes for before it would brake without any jolt."""
_AT_ONCE: Final = 0.3
"""Seconds over which acceleration changes of a car that is too fast."""
_CLASSES: Final = (3.0, 6.0, 12.0, 24.0, 60.0)
"""Classes of speeds (m/s) by their upper bounds."""
_CREEP: Final = 0.05
"""Speed (m/s) below which a car counts as standing."""
_MORE: Final = 2
"""Moments before and after a motion that its derivatives take."""


@dataclass(frozen=True, slots=True)
class Comfort:
    """Limits that a driver keeps to.

    Attributes:
        lateral: acceleration to the side, m/s^2.
        acceleration: m/s^2.
        deceleration: m/s^2.
        jerk: change of the acceleration, m/s^3.
        lateral_jerk: change of the acceleration to the side in bends that tighten, m/s^3.

    """

    lateral: float = 3.0
    acceleration: float = 2.0
    deceleration: float = 2.5
    jerk: float = 4.0
    lateral_jerk: float = 3.5

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value = getattr(self, name)
            if isinstance(value, int | float) and not value > 0:
                raise InvalidScenarioError(
                    f"{name} of `Comfort` must be more than 0, not {value}", span=here()
                )


def speeds_in_bends(
    along: Floats, curvatures: Floats, comfort: Comfort, bends: Floats | None = None
) -> Floats:
    """The largest speeds ``(n,)`` in m/s at points along a path with curvatures ``(n,)`` in 1/m.

    Args:
        along: metres along the path ``(n,)``.
        curvatures: at the points.
        comfort: of which the lateral acceleration and jerk count.
        bends: curvatures of which the changes count; the same by default.

    """
    bent = np.sqrt(comfort.lateral / np.maximum(np.abs(curvatures), 1e-6))
    if len(along) < 3:
        return bent
    change = np.abs(np.gradient(curvatures if bends is None else bends, along))
    tightening = np.cbrt(comfort.lateral_jerk / np.maximum(change, 1e-7))
    limits = np.minimum(bent, tightening)
    # Braking ends before a bend: within it, what comes next counts already.
    size = max(3, round(_AHEAD / max((along[-1] - along[0]) / (len(along) - 1), 1e-3)))
    coming = _least_within(limits, 0, size - 1)
    return np.where(np.abs(curvatures) > _BEND, np.minimum(limits, coming), limits)


def speeds_along(
    along: Floats,
    limits: Floats,
    speed: float,
    comfort: Comfort,
    *,
    wanted: Floats | float = math.inf,
    acceleration: float = 0.0,
    stops: bool = False,
    junctions: Sequence[tuple[int, int]] = (),
) -> tuple[Floats, Floats]:
    """Speeds and accelerations ``(n,)`` at points along a path.

    Args:
        along: metres along the path ``(n,)``; the car is at the first point.
        limits: largest speeds ``(n,)``, for which a car that is too fast brakes hard.
        speed: of the car, m/s.
        comfort: limits of acceleration, deceleration and jerk.
        wanted: further largest speeds ``(n,)``, for which it brakes comfortably.
        acceleration: of the car so far, m/s^2.
        stops: the car stands at the last point.
        junctions: stretches, from and to an index, before which braking for lower limits ends, rather than in them.

    """
    wanted = np.minimum(limits, wanted)
    way = _Way(along, wanted, comfort, junctions, stops)
    begun = _braked_evenly(way, limits, speed, acceleration) or _braked_hard(way, limits, speed, acceleration)
    motion, place = begun
    if place is None:
        return motion
    after = speeds_along(
        along[place:],
        limits[place:],
        float(motion[0][place]),
        comfort,
        wanted=wanted[place:],
        acceleration=float(motion[1][place]),
        stops=stops,
        junctions=[(max(0, low - place), high - place) for low, high in junctions if high > place],
    )
    return np.concatenate([motion[0][:place], after[0]]), np.concatenate([motion[1][:place], after[1]])


@dataclass(frozen=True, slots=True)
class _Way:
    """A way as `speeds_along` is given it."""

    along: Floats
    wanted: Floats
    comfort: Comfort
    junctions: Sequence[tuple[int, int]]
    stops: bool

    def speeds(
        self, speed: float, acceleration: float, decelerations: Floats, window: float, allowed: Floats
    ) -> tuple[Floats, Floats]:
        """Return speeds and accelerations ``(n,)`` of a car that brakes by decelerations ``(n - 1,)``, which change in seconds.

        The squared speeds ``(n,)`` that the limits allow are those of `_allowed` for half of the window.
        """
        along, comfort, stops = self.along, self.comfort, self.stops
        squares = np.minimum(allowed, _eroded(along, self.wanted, window / 2) ** 2)
        last = squares[-1]
        if stops:
            # Whoever stops in a junction, at the end of the network, brakes there.
            squares[-1] = squares[-2]
        squares = _slow_before(along, squares, self.junctions, speed, window / 2, comfort.deceleration)
        squares[-1] = last
        # v(s)^2 <= v(t)^2 + 2 b (t - s) for every t ahead, and likewise for acceleration from every place behind.
        squares = _backward(squares, 2 * decelerations * np.diff(along))
        # Half a window long the car goes on as it does: so the average begins with its speed and acceleration.
        deceleration = float(decelerations[0])
        acceleration, last_speed, reach = _going_on(speed, acceleration, window / 2, deceleration, comfort)
        ahead = along - along[0]
        begun = np.maximum(speed * speed + 2 * acceleration * ahead, 0.0)
        is_begun = (ahead < reach) | (ahead == 0.0)
        squares[is_begun] = begun[is_begun]
        up = 2 * comfort.acceleration * along
        squares = np.minimum.accumulate(squares - up) + up
        hardest = np.where(is_begun, begun, last_speed**2 - 2 * deceleration * (ahead - reach))
        squares = np.maximum(squares, np.maximum(hardest, 0.0))
        return _averaged(along, np.sqrt(squares), window, acceleration, stops=stops)


def _braked_evenly(
    way: _Way, limits: Floats, speed: float, acceleration: float
) -> tuple[tuple[Floats, Floats], int | None] | None:
    """The motion of a car that brakes evenly, or about so, and the index from which on it is to be planned anew.

    ``None`` for a car that is too fast for that.
    """
    along, comfort, stops = way.along, way.comfort, way.stops
    most = _HARDER * comfort.deceleration
    for window in (_window(comfort), _SOON):
        allowed = _allowed(along, limits, window / 2, stops=stops)
        going = _going_on(speed, acceleration, window / 2, comfort.deceleration, comfort)
        if _needed(along, _TOLERANCE * allowed, *going[1:])[0] > most:
            continue
        needed, place = _needed(along, allowed, *going[1:])
        decelerations = np.full(len(along) - 1, comfort.deceleration)
        decelerations[:place] = min(max(needed, comfort.deceleration), most)
        motion = way.speeds(speed, acceleration, decelerations, window, allowed)
        is_whole = window == _window(comfort) or place >= len(along) - 2 * _FEW
        return motion, None if is_whole else place + _FEW
    return None


def _braked_hard(
    way: _Way, limits: Floats, speed: float, acceleration: float
) -> tuple[tuple[Floats, Floats], int | None]:
    """The motion of a car that brakes evenly, hard and at once, and the index from which on comfort is enough."""
    along, comfort, stops = way.along, way.comfort, way.stops
    comfortable = _TOLERANCE * _allowed(along, limits, _window(comfort) / 2, stops=stops)
    allowed = _allowed(along, limits, _AT_ONCE / 2, stops=stops)
    needed, _ = _needed(along, allowed, speed, 0.0)
    decelerations = np.full(len(along) - 1, max(comfort.deceleration, min(1.1 * needed, _EMERGENCY)))
    slowing = _Way(along, np.minimum(way.wanted, speed), comfort, way.junctions, stops)
    motion = slowing.speeds(speed, acceleration, decelerations, _AT_ONCE, allowed)
    slow = motion[0] ** 2 <= _backward(comfortable, 2 * _HARDER * comfort.deceleration * np.diff(along))
    places = np.flatnonzero(slow[_FEW:-_FEW])
    return motion, _FEW + int(places[0]) if len(places) else None


def _window(comfort: Comfort) -> float:
    """Return the seconds over which the acceleration changes from its largest value to the deceleration."""
    return (comfort.acceleration + comfort.deceleration) / comfort.jerk


def _going_on(
    speed: float, acceleration: float, time: float, deceleration: float, comfort: Comfort
) -> tuple[float, float, float]:
    """Return the acceleration of a car, within bounds, its speed after seconds of it, and the metres that it has gone by then."""
    acceleration = min(max(acceleration, -deceleration), comfort.acceleration)
    if speed + acceleration * time < 0.0:
        time = speed / -acceleration
    after = speed + acceleration * time
    return acceleration, after, (speed + after) / 2 * time


def _allowed(along: Floats, limits: Floats, time: float, *, stops: bool) -> Floats:
    """Return squared speeds that keep limits for seconds before and after each point."""
    squares: Floats = _eroded(along, limits, time) ** 2
    if stops:
        squares[-1] = 0.0
    return squares


def _slow_before(
    along: Floats,
    squares: Floats,
    junctions: Sequence[tuple[int, int]],
    speed: float,
    time: float,
    deceleration: float,
) -> Floats:
    """Squared speed limits that let a car brake for what comes after a junction before it, and seconds of time earlier.

    Junctions that are too near for that, at the speed of the car, are left out.
    """
    steps = 2 * deceleration * np.diff(along)
    # A car that is too fast for a bend ahead brakes for that anyway: later junctions count nevertheless.
    least = min(_backward(squares, steps)[0], 0.98 * speed * speed)
    for first in range(len(junctions)):
        falls = steps.copy()
        for begin, end in junctions[first:]:
            end = min(end, len(along) - 1)
            reach = math.sqrt(squares[begin : end + 1].min()) * time + deceleration * time * time / 2
            low, high = np.searchsorted(along, [along[begin] - reach, along[end] + reach])
            falls[low:high] = 0.0
        slowest = _backward(squares, falls)
        if slowest[0] >= (1 - 1e-9) * least:
            return slowest
    return squares


def _backward(squares: Floats, falls: Floats) -> Floats:
    """Return squared speeds that fall at most by given amounts ``(n - 1,)`` from each point to the next, within limits ``(n,)``."""
    down = np.concatenate([[0.0], np.cumsum(falls)])
    slowest: Floats = np.minimum.accumulate((squares + down)[::-1])[::-1] - down
    return slowest


def _needed(along: Floats, squares: Floats, speed: float, reach: float) -> tuple[float, int]:
    """Return the constant deceleration by which a car meets all squared speed limits from metres ahead of it on, m/s^2.

    And the index of the point for which it is needed.
    """
    ahead = along[1:] - along[0] - reach
    # What a car meets at once it is a little too fast for at most.
    each = (speed * speed - squares[1:]) / (2 * np.maximum(ahead, 0.5 + 0.3 * speed))
    place = int(each.argmax())
    return float(each[place]), place + 1


def _eroded(along: Floats, limits: Floats, time: float) -> Floats:
    """The least of the limits that a car meets within some time before and after each point: about, by classes of speed."""
    spacing = max((along[-1] - along[0]) / max(len(along) - 1, 1), 1e-3)
    lowest = limits.copy()
    slowest, most = float(limits.min()), float(limits.max())
    low = 0.0
    for high in _CLASSES:
        if slowest < high and most >= low:
            some = np.where((limits >= low) & (limits < high), limits, np.inf)
            count = round(min(high, most) * time / spacing)
            lowest = np.minimum(lowest, _least_within(some, count, count))
        low = high
    return lowest


def _least_within(values: Floats, before: int, after: int) -> Floats:
    """Return the least ``(n,)`` of the values from some points before each point to some points after it.

    Minima of neighbours are taken over ranges of doubled length (SciPy's filter is as exact, but takes 0.3 s to import).
    """
    size = before + after + 1
    least = np.full(len(values) + size - 1, np.inf)
    least[before : before + len(values)] = values
    span = 1
    while 2 * span <= size:
        least = np.minimum(least[:-span], least[span:])
        span *= 2
    if span < size:
        least = np.minimum(least[: span - size], least[size - span :])
    return least


def _averaged(
    along: Floats, speeds: Floats, window: float, earlier: float, *, stops: bool
) -> tuple[Floats, Floats]:
    """The motion averaged over a window of time, as speeds and accelerations at the points."""
    means = np.maximum((speeds[1:] + speeds[:-1]) / 2, _CREEP / 2)
    times = np.concatenate([[0.0], np.cumsum(np.diff(along) / means)])
    step = 0.05
    half = round(window / 2 / step)
    count = max(2, int(times[-1] / step) + 1)
    moments = np.arange(count) * step
    places = np.interp(moments, times, along)
    # Before, the car has gone at an even acceleration; after, it goes on at the last speed.
    ahead = 0.0 if stops else speeds[-1]
    past = step * np.arange(half + _MORE, 0, -1)
    before = places[0] - past * np.maximum(speeds[0] - earlier * past / 2, 0.0)
    after = places[-1] + ahead * step * np.arange(1, half + _MORE + 1)
    whole = np.concatenate([before, places, after])
    sums = np.concatenate([[0.0], np.cumsum(whole)])
    width = 2 * half + 1
    mean = (sums[width:] - sums[:-width]) / width
    # Derivatives at the ends are those between moments before and after.
    speed = np.gradient(mean, step)
    acceleration = np.gradient(speed, step)[_MORE:-_MORE]
    mean, speed = np.maximum.accumulate(mean[_MORE:-_MORE]), speed[_MORE:-_MORE]
    return np.interp(along, mean, speed), np.interp(along, mean, acceleration)
