"""The height of roads: the profile of the reference line, tilted by the superelevation (section 3.6)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.formats.opendrive.curves import cubic_values
from scenic.formats.opendrive.records import Cubic

__all__ = ["Elevation", "RoadHeight"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class RoadHeight:
    """The height of one road.

    Attributes:
        uid: the road's.
        polygon: its area.
        line: vertices of its reference line, ``(n, 2)``.
        length: length of the exact reference line in metres, of which cubics are functions.
        profile: height of the reference line.
        tilt: superelevation in radians, positive where the right side is lower.

    """

    uid: str
    polygon: Any
    line: Floats
    length: float
    profile: tuple[Cubic, ...]
    tilt: tuple[Cubic, ...]

    def at(self, places: Floats) -> Floats:
        """Heights ``(n,)`` of the road's surface at places ``(n, 2)``."""
        import shapely

        string = shapely.linestrings(self.line)
        along = shapely.line_locate_point(string, shapely.points(places))
        s = along * (self.length / max(string.length, 1e-9))
        height = cubic_values(self.profile, s)
        if self.tilt:
            before = shapely.get_coordinates(
                shapely.line_interpolate_point(string, np.maximum(along - 0.1, 0))
            )
            after = shapely.get_coordinates(shapely.line_interpolate_point(string, along + 0.1))
            way = after - before
            way /= np.maximum(np.hypot(*way.T), 1e-12)[:, None]
            offset = places - (before + after) / 2
            left = way[:, 0] * offset[:, 1] - way[:, 1] * offset[:, 0]
            height = height + left * np.tan(cubic_values(self.tilt, s))
        return height


class Elevation:
    """The heights of all roads of a map.

    Args:
        roads: the roads; others are level, at 0.

    """

    def __init__(self, roads: Sequence[RoadHeight]) -> None:
        self.roads = tuple(roads)

    @cached_property
    def _tree(self) -> Any:
        import shapely

        return shapely.STRtree([road.polygon for road in self.roads])

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {road.uid: number for number, road in enumerate(self.roads)}

    def at(self, points: Floats, uid: str | None = None) -> Floats:
        """Heights ``(n,)`` in metres at points ``(n, 3)``, NaN off the roads.

        Args:
            points: the points; where several roads hold one, the height nearest to its z counts.
            uid: the only road to look at; all of them if not given.

        """
        import shapely

        found = np.full(len(points), np.nan)
        if not self.roads:
            return found
        places = shapely.points(points[:, :2])
        if uid is None:
            owners, numbers = self._tree.query(places, predicate="intersects")
        else:
            number = self._numbers[uid]
            owners = np.flatnonzero(shapely.intersects(self.roads[number].polygon, places))
            numbers = np.full(len(owners), number)
        for number in np.unique(numbers):
            mine = owners[numbers == number]
            height = self.roads[number].at(points[mine, :2])
            nearer = ~(np.abs(found[mine] - points[mine, 2]) <= np.abs(height - points[mine, 2]))
            found[mine[nearer]] = height[nearer]
        return found
