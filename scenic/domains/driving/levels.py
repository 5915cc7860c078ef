"""Roads above each other: which of them is meant at a point in space, and the surface of an element."""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elevation import Elevation, frames_on
from scenic.graph import quaternions

__all__ = ["Ground", "Levels"]

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]

_STOREY: Final = 2.5
"""Metres between two surfaces from which on one passes above the other."""
_LEVEL: Final = 1.0
"""Metres within which two surfaces are equally near to a point."""
_ROOM: Final = 4.5
"""Metres above or below a surface within which things belong to it."""
_BELOW, _ABOVE = 1.6, 2.4
"""Metres below and above a road, which others pass at `_STOREY` at least, within which the middle of a thing on it lies."""
_SHARED: Final = 0.1
"""Square metres that two areas share at least where they lie above each other."""


class Levels:
    """The areas of all roads, and where some lie above others.

    Args:
        elevation: the surfaces of the roads.
        polygons: areas, shapely's.
        roads: the number of the road of each area.
        content_digest: the digest of all that they follow from, where it is known (`scenic.analysis.identity`).

    """

    def __init__(
        self,
        elevation: Elevation,
        polygons: Sequence[object],
        roads: Sequence[int],
        content_digest: bytes | None = None,
    ) -> None:
        self.elevation = elevation
        self.content_digest = content_digest
        self._polygons = np.array(polygons, dtype=object)
        self._roads = np.array(roads, dtype=np.intp)

    @cached_property
    def _tree(self) -> Any:
        import shapely

        return shapely.STRtree(self._polygons)

    @cached_property
    def _bounds(self) -> tuple[Floats, Floats]:
        """The least and the greatest height of each road on its areas."""
        import shapely

        low, high = np.zeros(len(self.elevation.roads)), np.zeros(len(self.elevation.roads))
        for road in np.unique(self._roads).tolist():
            corners = shapely.get_coordinates(self._polygons[self._roads == road])
            low[road], high[road] = self.elevation.bounds(road, self.elevation.reach(road, corners))
        return low, high

    def bounds(self, roads: Sequence[int]) -> tuple[float, float]:
        """Return the least and the greatest height of some roads, on their areas."""
        low, high = self._bounds
        some = list(roads)
        return float(low[some].min()) - 1e-6, float(high[some].max()) + 1e-6

    @cached_property
    def _stacks(self) -> tuple[set[tuple[int, int]], Any]:
        """Pairs of roads of which one passes above the other, and the area where any does (``None`` if nowhere)."""
        import shapely

        if self.elevation.is_level:
            return set(), None
        low, high = (bound[self._roads] for bound in self._bounds)
        one, two = self._tree.query(self._polygons, predicate="intersects")
        may = (one < two) & (np.maximum(high[one] - low[two], high[two] - low[one]) > _STOREY)
        one, two = one[may], two[may]
        overlaps = shapely.intersection(self._polygons[one], self._polygons[two])
        some = shapely.area(overlaps) > _SHARED
        one, two, overlaps = one[some], two[some], overlaps[some]
        middles = shapely.get_coordinates(shapely.point_on_surface(overlaps))
        heights = [self.elevation.heights(self._roads[side], middles) for side in (one, two)]
        above = np.abs(heights[0] - heights[1]) > _STOREY
        pairs = {
            (int(a), int(b))
            for first, second in zip(self._roads[one[above]], self._roads[two[above]], strict=True)
            for a, b in ((first, second), (second, first))
        }
        if not pairs:
            return pairs, None
        area = shapely.union_all(overlaps[above]).buffer(0.5)
        shapely.prepare(area)
        return pairs, area

    @property
    def pairs(self) -> set[tuple[int, int]]:
        """Pairs of roads of which one passes above the other, each in both orders."""
        return self._stacks[0]

    @cached_property
    def has_storeys(self) -> bool:
        """Return whether some road passes above another one."""
        return self._stacks[1] is not None

    def is_on(self, element: Any, point: Any) -> bool:
        """Return whether a thing over an element belongs to it, and not to a road that passes above or below.

        Args:
            element: of the road network.
            point: the middle of the thing.

        """
        if not self.has_storeys:
            return True
        x, y, z = point
        if not self.stacked(np.array([[x, y]]))[0]:
            return True
        height = element.elevationAt(point)
        return height is None or -_BELOW < z - height < _ABOVE

    def stacked(self, places: Floats) -> Mask:
        """Return a mask of the places ``(n, 2)`` at which roads lie above each other."""
        import shapely

        area = self._stacks[1]
        if area is None:
            return np.zeros(len(places), dtype=np.bool_)
        return np.asarray(shapely.intersects_xy(area, places[:, 0], places[:, 1]), dtype=np.bool_)

    def _under(self, points: Floats) -> tuple[Indices, Indices]:
        """Pairs of points ``(n, 3)``, in their order, and roads that hold them as seen from above."""
        import shapely

        # Boxes first: prepared areas answer for all pairs at once much faster than the tree asks them one by one.
        owner, area = self._tree.query(shapely.points(points[:, :2]))
        areas, places = self._prepared[area], points[owner]
        inside = shapely.intersects_xy(areas, places[:, 0], places[:, 1])
        return owner[inside], self._roads[area[inside]]

    @cached_property
    def _prepared(self) -> Any:
        import shapely

        shapely.prepare(self._polygons)
        return self._polygons

    def _at(self, points: Floats) -> tuple[Indices, Indices, Floats]:
        """Pairs of points ``(n, 3)`` and roads that hold them as seen from above, and by how much each road misses the point."""
        owner, roads = self._under(points)
        gaps = np.abs(points[owner, 2] - self.elevation.heights(roads, points[owner, :2]))
        return owner, roads, gaps

    def heights(self, points: Floats) -> Floats:
        """Heights ``(n,)`` of the surfaces nearest to points ``(n, 3)``, NaN off the roads."""
        found = np.full(len(points), np.nan)
        there, roads = self._nearest(points)
        found[there] = self.elevation.heights(roads, points[there, :2])
        return found

    def frames(self, points: Floats, headings: Floats) -> Floats:
        """Orientations ``(n, 4)`` of things on the surfaces nearest to points ``(n, 3)`` that face headings ``(n,)``.

        Headings are anticlockwise from north; off the roads, the ground is level.
        """
        frames = quaternions.from_euler(headings, np.zeros(1), np.zeros(1))
        there, roads = self._nearest(points)
        frames[there] = self.elevation.frames(roads, points[there, :2], headings[there])
        return frames

    def settled(self, points: Floats, headings: Floats) -> tuple[Floats, Floats]:
        """Return heights ``(n,)`` and orientations ``(n, 4)``, as `heights` and `frames` do, at once."""
        owner, roads = self._under(points)
        above, gradients = self.elevation.heights_and_gradients(roads, points[owner, :2])
        if (owner[1:] == owner[:-1]).any():
            order = np.lexsort((np.abs(points[owner, 2] - above), owner))
            first = order[np.flatnonzero(np.diff(owner[order], prepend=-1))]
            owner, above, gradients = owner[first], above[first], gradients[first]
        heights = np.full(len(points), np.nan)
        heights[owner] = above
        slopes = np.zeros((len(points), 2))
        slopes[owner] = gradients
        return heights, frames_on(slopes, headings)

    def _nearest(self, points: Floats) -> tuple[Indices, Indices]:
        """Return the indices of the points ``(n, 3)`` that lie on some road, and for each the road nearest in height."""
        owner, roads, gaps = self._at(points)
        order = np.lexsort((gaps, owner))
        first = order[np.flatnonzero(np.diff(owner[order], prepend=-1))]
        return owner[first], roads[first]

    def fits(self, points: Floats, heights: Callable[[Floats], Floats]) -> Mask:
        """Return the mask of the points ``(n, 3)`` at which no other surface is nearer than the one whose heights ``(n,)`` the function returns."""
        result = np.ones(len(points), dtype=np.bool_)
        some = np.flatnonzero(self.stacked(points[:, :2]))
        if len(some):
            owner, _, gaps = self._at(points[some])
            least = np.full(len(some), np.inf)
            np.minimum.at(least, owner, gaps)
            result[some] = np.abs(points[some, 2] - heights(points[some])) <= least + _LEVEL
        return result


class Ground:
    """The surface of a part of a road network in space.

    Args:
        levels: the areas and heights of its network.
        roads_at: gives the numbers ``(n,)`` of the roads that are the surface at points ``(n, 3)``.
        roads: the numbers of all of them.

    """

    def __init__(self, levels: Levels, roads_at: Callable[[Floats], Indices], roads: Sequence[int]) -> None:
        self.levels = levels
        self.roads_at = roads_at
        self.roads = tuple(roads)

    @cached_property
    def bounds(self) -> tuple[float, float]:
        """Its least and greatest height in metres."""
        return self.levels.bounds(self.roads)

    def heights(self, points: Floats) -> Floats:
        """Its heights ``(n,)`` in metres above or below points ``(n, 3)``."""
        return self.levels.elevation.heights(self.roads_at(points), points[:, :2])

    def frames(self, points: Floats, headings: Floats) -> Floats:
        """Return orientations ``(n, 4)`` of things on the ground that face headings ``(n,)``, anticlockwise from north."""
        return self.levels.elevation.frames(self.roads_at(points), points[:, :2], headings)

    def fits(self, points: Floats) -> Mask:
        """Return the mask of the points ``(n, 3)`` on the area that belong to this ground, and not to a surface above or below."""
        return self.levels.fits(points, self.heights)

    def may_miss(self, points: Floats) -> Mask:
        """Return a mask of the points ``(n, 3)`` that are too high or too low for some place on it, so that `clearances` may not be 0."""
        least, most = self.bounds
        fits: Mask = np.maximum(points[:, 2] - least, most - points[:, 2]) < _ROOM - 1e-6
        return ~fits

    def clearances(self, points: Floats, places: Floats) -> Floats:
        """Return by how many metres points ``(n, 3)`` are too high or too low to belong to the ground, whose nearest places ``(n, 3)`` are given."""
        return np.maximum(np.abs(points[:, 2] - self.heights(places)) - _ROOM, 0.0)
