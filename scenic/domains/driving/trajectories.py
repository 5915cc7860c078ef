"""Ways for cars: lanes one after the other, or points with speeds."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import Lane, LinearElement
from scenic.domains.driving.maneuvering import intersection_ahead
from scenic.domains.driving.narrow_lanes import line_to_drive
from scenic.runtime.regions.lines import PolylineRegion
from scenic.runtime.values.describing import wrong_type
from scenic.runtime.values.values import Vector

__all__ = ["Route", "Trajectory"]

Floats = NDArray[np.float64]


class Trajectory:
    """A way through points, with a speed at each of them if wanted.

    Args:
        points: places in metres, at least two.
        speeds: m/s at each place, linear in between; none for the speed of the behavior.

    Raises:
        ValueError: there are too few points, or not as many speeds.

    """

    def __init__(self, points: Sequence[Any], speeds: Sequence[float] | None = None) -> None:
        self.points = tuple(
            (float(x), float(y), 0.0) for x, y, *_ in (getattr(p, "position", p) for p in points)
        )
        self.speeds = None if speeds is None else tuple(map(float, speeds))
        if len(self.points) < 2:
            raise ValueError("a trajectory needs at least two points")
        if self.speeds is not None and len(self.speeds) != len(self.points):
            raise ValueError(
                f"a trajectory of {len(self.points)} points needs as many speeds, not {len(self.speeds)}"
            )

    @classmethod
    def through(cls, parts: Sequence[Any], speed: float | None = None) -> "Trajectory":
        """Return the way along the middle of lanes, or along polylines, one after the other, at one speed in m/s if given."""
        points = [point for part in parts for point in getattr(part, "centerline", part).points]
        kept = [point for index, point in enumerate(points) if index == 0 or point != points[index - 1]]
        return cls(kept, None if speed is None else [speed] * len(kept))

    @property
    def centerline(self) -> PolylineRegion:
        """The way as a region."""
        return PolylineRegion(self.points)


class Route:
    """A trajectory that is followed: its line, where it ends, and the speeds on it.

    Args:
        trajectory: lanes, or polylines, one after the other; or a `Trajectory`.

    Attributes:
        parts: lanes, polylines, or a trajectory, one after the other.
        lines: what to follow, ``(n, 2)`` of each part.
        end: the intersection after the last lane, else the last point.

    Raises:
        ScenicTypeError: it is neither.

    """

    def __init__(self, trajectory: object) -> None:
        self._speeds: tuple[float, ...] | None = None
        if isinstance(trajectory, Trajectory):
            parts: Sequence[Any] = (trajectory,)
            self._speeds = trajectory.speeds
        elif isinstance(trajectory, list | tuple) and trajectory and all(map(_is_way, trajectory)):
            parts = trajectory
        else:
            raise wrong_type(
                "lanes or lines in a list that is not empty, or a `Trajectory`", trajectory, "the trajectory"
            )
        self.parts = tuple(parts)
        self.lines = [_vertices(part) for part in parts]
        last = parts[-1]
        self.end: Any = intersection_ahead(last) if isinstance(last, Lane) else Vector(*_end_of(last))

    @property
    def speeds(self) -> tuple[float, ...] | None:
        """The speeds (m/s) at the points of a trajectory that has some."""
        return self._speeds

    def speeds_at(self, points: Floats) -> Floats:
        """The speeds ``(n,)`` in m/s at places ``(n, 2)`` along the trajectory, linear between its points."""
        import shapely

        line = shapely.LineString(np.concatenate(self.lines))
        vertices = np.concatenate(self.lines)
        lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(vertices, axis=0).T))])
        speeds: Floats = np.interp(
            shapely.line_locate_point(line, shapely.points(points)), lengths, self._speeds or ()
        )
        return speeds


def _vertices(part: Any) -> Floats:
    if isinstance(part, Lane):
        return line_to_drive(part)
    if isinstance(part, LinearElement):
        return part.line
    return np.array([point[:2] for point in part.points])


def _is_way(part: object) -> bool:
    return isinstance(part, LinearElement | PolylineRegion | Trajectory)


def _end_of(part: Any) -> tuple[float, ...]:
    point: tuple[float, ...] = tuple(getattr(part, "centerline", part).points[-1])
    return point
