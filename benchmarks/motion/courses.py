"""Courses of cars: places over time, and the lanes along which they were to lead."""

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.path_smoothing import curvatures_of, headings_of, resampled

__all__ = ["Course", "Lines", "sign_changes"]

Floats = NDArray[np.float64]

SIZE = (4.5, 2.0)
"""Length and width of a car, m."""
_SPACING = 0.25
_BACK, _ON = 20, 60
"""Points of lines that are looked at behind and ahead of a car."""


class Course:
    """The motion of one car: positions ``(n, 2)`` and headings ``(n,)``, ``step`` seconds apart."""

    def __init__(self, places: Floats, headings: Floats, step: float) -> None:
        self.places, self.headings, self.step = places, np.unwrap(headings), step

    def part(self, begin: int, end: int) -> "Course":
        """The course between two states."""
        return Course(self.places[begin:end], self.headings[begin:end], self.step)

    @cached_property
    def velocities(self) -> Floats:
        """``(n - 1, 2)``."""
        return np.diff(self.places, axis=0) / self.step

    @cached_property
    def speeds(self) -> Floats:
        """``(n - 1,)``."""
        speeds: Floats = np.hypot(*self.velocities.T)
        return speeds

    @cached_property
    def accelerations(self) -> tuple[Floats, Floats]:
        """Lateral and longitudinal."""
        change = np.diff(self.velocities, axis=0) / self.step
        heading = self.headings[1:-1]
        return (
            -(change[:, 0] * np.cos(heading) + change[:, 1] * np.sin(heading)),
            change[:, 1] * np.cos(heading) - change[:, 0] * np.sin(heading),
        )

    @cached_property
    def jerk(self) -> Floats:
        """``(n - 3,)``."""
        lateral, along = (np.diff(item) / self.step for item in self.accelerations)
        jerk: Floats = np.hypot(lateral, along)
        return jerk

    @cached_property
    def rates(self) -> Floats:
        """Yaw rates ``(n - 1,)``, radians a second."""
        rates: Floats = np.diff(self.headings) / self.step
        return rates

    def corners(self) -> Floats:
        """``(n, 4, 2)``."""
        sine, cosine = np.sin(self.headings), np.cos(self.headings)
        long, wide = SIZE[0] / 2, SIZE[1] / 2
        offsets = [(-wide, -long), (wide, -long), (wide, long), (-wide, long)]
        return np.stack(
            [
                self.places + np.column_stack([u * cosine - v * sine, u * sine + v * cosine])
                for u, v in offsets
            ],
            axis=1,
        )


def sign_changes(values: Floats, least: float) -> int:
    """Changes of sign between values beyond a threshold."""
    signs = np.sign(values[np.abs(values) > least])
    return int((np.diff(signs) != 0).sum())


class Lines:
    """The centerlines of lanes one after the other, as the map has them.

    Args:
        lines: ``(n, 2)`` each.
        begins: metres along the lines within which the car begins.

    Attributes:
        lengths: metres along the lines to each of their points.

    """

    def __init__(self, lines: Sequence[Floats], begins: float) -> None:
        self.points = resampled(np.concatenate(lines), _SPACING)
        steps = np.hypot(*np.diff(self.points, axis=0).T)
        self.lengths: Floats = np.concatenate([[0.0], np.cumsum(steps)])
        self._first = max(2, int(np.searchsorted(self.lengths, begins, side="right")))
        half = round(2.0 / _SPACING)
        padded = np.pad(headings_of(self.points), half, mode="edge")
        turned = (padded[2 * half :] - padded[: -2 * half]) / (2 * half * _SPACING)
        # Averaged over two metres on either side: maps draw bends as polygons of such steps.
        self.curvatures: Floats = np.append(turned, turned[-1:])
        self.sharpest: Floats = np.abs(curvatures_of(self.points))

    def indices(self, places: Floats) -> NDArray[np.intp]:
        """The points ``(n,)`` at which a car is that goes along the lines through places ``(n, 2)``."""
        numbers = np.empty(len(places), dtype=np.intp)
        points = self.points
        at = int(((points[: self._first] - places[0]) ** 2).sum(axis=1).argmin())
        for number, place in enumerate(places):
            low = max(0, at - _BACK)
            away = points[low : at + _ON] - place
            at = low + int((away * away).sum(axis=1).argmin())
            numbers[number] = at
        return numbers

    def away(self, places: Floats, indices: NDArray[np.intp]) -> Floats:
        """Metres ``(n,)`` from the lines to places ``(n, 2)`` near points of them."""
        best = np.full(len(places), math.inf)
        for shift in (-1, 0):
            low = np.clip(indices + shift, 0, len(self.points) - 2)
            a, b = self.points[low], self.points[low + 1]
            along = b - a
            share = ((places - a) * along).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-12)
            foot = a + np.clip(share, 0.0, 1.0)[:, None] * along
            best = np.minimum(best, np.hypot(*(places - foot).T))
        return best

    def within(self, indices: NDArray[np.intp], reach: float, radius: float) -> NDArray[np.bool_]:
        """Return which points ``(n,)`` have a bend of less than a radius within metres of the lines on either side."""
        from scipy.ndimage import maximum_filter1d

        size = 2 * round(reach / _SPACING) + 1
        most = maximum_filter1d(np.abs(self.curvatures), size, mode="nearest")
        bent: NDArray[np.bool_] = most[indices] > 1 / radius
        return bent
