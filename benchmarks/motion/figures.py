"""The figures of runs, and what holds of them by the specification of the driving domain (section 11)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from benchmarks.motion.courses import Course, Lines, sign_changes

__all__ = ["BOUNDS", "Figures", "Run", "figures_of"]

Floats = NDArray[np.float64]

TIGHT = 6.0
"""Radius (m) of a lane below which a corner may leave the drivable region."""
STRAIGHT = 400.0
"""Radius (m) from which on a lane is straight."""
NOTHING = 0.002
"""Yaw rates (radians a second) that count as none: 0.06 m/s² at 30 m/s."""

BOUNDS = {
    "centre": 0,
    "corner": 0,
    "d99": 0.25,
    "d99str": 0.05,
    "a_lat": 3.5,
    "jerk": 8.0,
    "flips": 2.0,
    "brake": 0,
    "us": 60.0,
}
"""Largest values of the columns."""


@dataclass
class Run:
    """The motion of one car, and what it was to be.

    Attributes:
        course: its motion.
        lines: the centerlines along which it was to go.
        asked: curvatures ``(n,)`` of the planned path at the states.
        braked: it braked within the intersection.
        since: the first state from which on it was to be on the centerlines.

    """

    course: Course
    lines: Lines
    asked: Floats
    braked: bool = False
    since: int = 0


@dataclass
class Figures:
    """The figures of a line of the table; shares of runs for ``centre``, ``corner`` (``tight`` where lanes bend sharply), ``brake``."""

    centre: int = 0
    corner: int = 0
    tight: int = 0
    d99: float = math.nan
    d99str: float = math.nan
    a_lat: float = 0.0
    jerk: float = 0.0
    flips: float = 0.0
    brake: int = 0
    us: float = math.nan

    def misses(self) -> list[str]:
        """The names of figures over their bounds."""
        return [name for name, bound in BOUNDS.items() if getattr(self, name) > bound]

    @staticmethod
    def head() -> str:
        """The names of the columns."""
        return "centre corner tight    d99 d99str  a_lat   jerk  flips brake    us"

    def row(self) -> str:
        """The columns."""
        return (
            f"{self.centre:6d} {self.corner:6d} {self.tight:5d} {self.d99:6.3f} {self.d99str:6.3f} {self.a_lat:6.2f} "
            f"{self.jerk:6.2f} {self.flips:6.2f} {self.brake:5d} {self.us:5.1f}"
        )


def figures_of(runs: Sequence[Run], region: Any, spent: float) -> Figures:
    """The figures of runs on a drivable region, of which a step of a car took ``spent`` seconds."""
    figures = Figures(us=spent * 1e6)
    deviations, straights = [], []
    flips = minutes = 0.0
    for run in runs:
        course, lines = run.course, run.lines
        figures.centre += bool((~shapely.contains_xy(region, *course.places.T)).any())
        outside = ~shapely.contains_xy(region, *course.corners().reshape(-1, 2).T).reshape(-1, 4).all(axis=1)
        # Who is put on the road across its edge has to come from there first.
        outside[: np.flatnonzero(~outside)[0] if not outside.all() else 0] = False
        indices = lines.indices(course.places)
        excused = lines.within(indices, 6.0, TIGHT)
        figures.corner += bool((outside & ~excused).any())
        figures.tight += bool((outside & excused).any())
        away = lines.away(course.places, indices)
        deviations.append(away[run.since :])
        straights.append(away[run.since :][~lines.within(indices[run.since :], 10.0, STRAIGHT)])
        side, _ = course.accelerations
        figures.a_lat = max(figures.a_lat, float(np.abs(side).max()))
        figures.jerk = max(figures.jerk, float(course.jerk.max()))
        own = sign_changes(course.rates, NOTHING)
        asked = sign_changes(run.asked[: len(course.speeds)] * course.speeds, NOTHING)
        flips += max(0, own - asked)
        minutes += len(course.places) * course.step / 60
        figures.brake += run.braked
    figures.flips = flips / minutes
    figures.d99 = float(np.percentile(np.concatenate(deviations), 99))
    straight = np.concatenate(straights)
    if len(straight):
        figures.d99str = float(np.percentile(straight, 99))
    return figures
