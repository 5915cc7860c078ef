"""Ways for cars: lanes one after the other, or points with speeds."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import Lane, LinearElement, Maneuver
from scenic.domains.driving.maneuvering import intersection_ahead
from scenic.domains.driving.narrow_lanes import line_to_drive, ways_after
from scenic.domains.driving.wrong_arguments import impossible_argument, wrong_argument
from scenic.runtime.regions.lines import PolylineRegion
from scenic.runtime.values.values import Vector

__all__ = ["LaneRoute", "Route", "Trajectory"]

Floats = NDArray[np.float64]

_FAR: Final = 10.0
"""Metres from a route from which on a car does not begin it."""


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
            wanted = "lanes or lines in a list that is not empty, or a `Trajectory`"
            raise wrong_argument("trajectory", wanted, trajectory, "the trajectory")
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


class LaneRoute:
    """Lanes that a driver takes one after the other where it has a choice, and which of them come next.

    Args:
        trajectory: lanes, or maneuvers, one after the other; connecting lanes may be left out.

    Attributes:
        lanes: the lanes.

    Raises:
        ScenicTypeError: it is something else.
        InvalidScenarioError: some lane does not follow the one before it.

    """

    def __init__(self, trajectory: object) -> None:
        parts = list(trajectory) if isinstance(trajectory, list | tuple) else []
        if not parts or not all(isinstance(part, Lane | Maneuver) for part in parts):
            wanted = "lanes or maneuvers in a list that is not empty"
            raise wrong_argument("trajectory", wanted, trajectory, "the trajectory")
        lanes: list[Lane] = []
        for part in parts:
            ways = (part,) if isinstance(part, Lane) else (part.startLane, part.connectingLane, part.endLane)
            lanes += [lane for lane in ways if lane is not None and lane not in lanes[-1:]]
        for before, after in pairwise(lanes):
            if not any(after in _taken_by(way) for way in _ways_from(before)):
                ends = ", ".join(way.endLane.uid for way in _ways_from(before)) or "none"
                raise impossible_argument(
                    "trajectory",
                    f"the trajectory cannot be driven: {after.uid} does not follow {before.uid}",
                    f"lanes that follow {before.uid}: {ends}",
                )
        self.lanes: tuple[Lane, ...] = tuple(lanes)
        self._count = 0
        """The number of lanes that have been taken."""
        self._has_begun = False

    def begin(self, lane: Lane, place: tuple[float, float]) -> Lane:
        """Return the lane in which to begin, or to go on: the own one if it belongs to the route, or leads to it, else the first.

        A car that has been moved away from its route leaves it.

        Raises:
            InvalidScenarioError: the first lane is far from the place where the car begins.

        """
        is_first, self._has_begun = not self._has_begun, True
        for number in (*range(self._count, len(self.lanes)), *range(self._count)):
            if self.lanes[number] == lane:
                self._count = number + 1
                return lane
        self._count = 0
        if self.open_ways(_ways_from(lane)):
            return lane
        if not is_first:
            self._count = len(self.lanes)
            return lane
        import shapely

        away = shapely.distance(shapely.linestrings(self.lanes[0].line), shapely.Point(*place))
        if away > _FAR:
            raise impossible_argument(
                "trajectory",
                f"the car is {away:.0f} m from {self.lanes[0].uid}, in which its trajectory begins, and in none of its lanes",
                "put the car there, as by `new Car on LANE.centerline`",
            )
        self._count = 1
        return self.lanes[0]

    def open_ways(self, ways: Sequence[Maneuver]) -> tuple[Maneuver, ...]:
        """Return those of some maneuvers by which the route goes on; none after its last lane."""
        wanted = self.lanes[self._count : self._count + 1]
        return tuple(way for way in ways if any(lane in wanted for lane in _taken_by(way)))

    def take(self, way: Maneuver) -> None:
        """Go on by a maneuver."""
        for lane in _taken_by(way):
            if lane in self.lanes[self._count : self._count + 1]:
                self._count += 1


def _ways_from(lane: Lane) -> Sequence[Maneuver]:
    return lane.maneuvers or ways_after(lane)


def _taken_by(way: Maneuver) -> tuple[Lane, ...]:
    """Return the lanes of a maneuver after the one in which it begins."""
    return tuple(lane for lane in (way.connectingLane, way.endLane) if lane is not None)


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
