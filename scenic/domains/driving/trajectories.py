"""Ways for cars: lanes one after the other, or points with speeds."""

from bisect import bisect_right
from collections.abc import Sequence
from typing import Any

from scenic.domains.driving.elements import Lane, LinearElement
from scenic.domains.driving.lines import FollowedLine
from scenic.domains.driving.maneuvering import intersection_ahead
from scenic.runtime.regions.lines import PolylineRegion
from scenic.runtime.values.values import Vector

__all__ = ["Route", "Trajectory"]


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
        """The way along the middle of lanes, or along polylines, one after the other, at one speed in m/s if given."""
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
        line: what to follow.
        end: the intersection after the last lane, else the last point.

    Raises:
        TypeError: it is neither.

    """

    def __init__(self, trajectory: Any) -> None:
        self._speeds: tuple[float, ...] | None = None
        if isinstance(trajectory, Trajectory):
            parts: Sequence[Any] = (trajectory,)
            self._speeds = trajectory.speeds
        elif isinstance(trajectory, list | tuple) and trajectory and all(map(_is_way, trajectory)):
            parts = trajectory
        else:
            raise TypeError(
                "FollowTrajectoryBehavior needs a trajectory: a list of lanes that is not empty, or a Trajectory"
            )
        self.line = FollowedLine(*parts)
        last = parts[-1]
        self.end: Any = intersection_ahead(last) if isinstance(last, Lane) else Vector(*_end_of(last))

    def speed(self, default: float) -> float:
        """The speed (m/s) where the line has been looked at last; ``default`` on trajectories without speeds."""
        speeds = self._speeds
        if speeds is None:
            return default
        lengths = self.line.lengths
        along = self.line.progress
        index = min(max(bisect_right(lengths, along) - 1, 0), len(lengths) - 2)
        share = (along - lengths[index]) / (lengths[index + 1] - lengths[index])
        return speeds[index] + (speeds[index + 1] - speeds[index]) * min(max(share, 0.0), 1.0)


def _is_way(part: Any) -> bool:
    return isinstance(part, LinearElement | PolylineRegion | Trajectory)


def _end_of(part: Any) -> tuple[float, ...]:
    point: tuple[float, ...] = tuple(getattr(part, "centerline", part).points[-1])
    return point
