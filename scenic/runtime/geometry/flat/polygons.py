"""The facade over shapely: fixed polygons in the plane, with holes, perhaps several."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.runtime.geometry.flat.near_boxes import near_boxes, tree_of_boxes
from scenic.runtime.geometry.poses import Booleans, Floats
from scenic.runtime.geometry.ragged import choose

_ROUNDING: Final = 4e-16
"""Relative error of a number times an area."""

Ends = tuple[Floats, Floats]
"""Lower and upper ends of numbers, ``(m | 1,)`` each."""

_LARGE: Final = 200
"""Corners of polygons from which on it is asked first whether a single point lies inside."""
TOLERANCE: Final = 1e-9
"""Metres by which something may stick out of a container, for rounding."""


class Polygons:
    """A polygon or several disjoint ones.

    Args:
        polygon: a shapely ``Polygon`` or ``MultiPolygon``; height is dropped.

    Raises:
        ValueError: it is empty, crosses itself, or is another kind of geometry.

    """

    def __init__(self, polygon: object) -> None:  # shapely has no types
        import shapely

        kind = getattr(polygon, "geom_type", type(polygon).__name__)
        if kind not in {"Polygon", "MultiPolygon"}:
            raise ValueError(f"a polygon or multipolygon is needed, not a value of type `{kind}`")
        flat = shapely.force_2d(polygon)
        if not flat.is_valid:
            raise ValueError(f"the polygon is not valid: {shapely.is_valid_reason(flat)}")
        if flat.is_empty or not flat.area > 0:
            raise ValueError("the polygon is empty")
        self.polygon: Final[Any] = shapely.orient_polygons(flat)

    @classmethod
    def of_points(cls, points: Sequence[Sequence[float]]) -> "Polygons":
        """The polygon with these vertices ``(x, y)`` in order."""
        import shapely

        if len(points) < 3:
            raise ValueError(f"a polygon needs at least three points, not {len(points)}")
        return cls(shapely.Polygon([(float(x), float(y)) for x, y in points]))

    @staticmethod
    def union(members: Sequence["Polygons"], buffer: float = 0.0) -> "Polygons":
        """Return the union of polygons; gaps between and in them that are narrower than twice ``buffer`` metres are closed."""
        import shapely

        if not buffer:
            return Polygons(shapely.union_all([member.polygon for member in members]))
        grown = shapely.union_all([member.polygon.buffer(buffer) for member in members])
        return Polygons(grown.buffer(-buffer))

    def __repr__(self) -> str:
        return f"<Polygons of {self.area:g} square metres>"

    @property
    def area(self) -> float:
        """Square metres."""
        return float(self.polygon.area)

    @cached_property
    def as_row(self) -> npt.NDArray[np.object_]:
        """The polygon, prepared for questions, as an array ``(1,)`` of shapely geometries."""
        import shapely

        shapely.prepare(self.polygon)
        row = np.empty(1, dtype=np.object_)
        row[0] = self.polygon
        return row

    @cached_property
    def convex_corners(self) -> Floats | None:
        """The vertices ``(k, 2)``, anticlockwise, of a single convex polygon; ``None`` for others."""
        if self.polygon.geom_type != "Polygon" or self.polygon.interiors:
            return None
        corners = np.asarray(self.polygon.exterior.coords, dtype=np.float64)[:-1]
        after, before = np.roll(corners, -1, axis=0), np.roll(corners, 1, axis=0)
        ahead, behind = after - corners, corners - before
        turns = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0]
        return corners if (turns >= 0).all() else None

    @cached_property
    def _triangles(self) -> tuple[Floats, Floats]:
        """A triangulation ``(t, 3, 2)`` and its cumulative areas ``(t,)``."""
        import shapely

        parts = shapely.get_parts(shapely.constrained_delaunay_triangles(self.polygon))
        corners = shapely.get_coordinates(parts).reshape(-1, 4, 2)[:, :3]
        ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        return corners, np.cumsum(0.5 * np.abs(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]))

    @property
    def choice_cuts(self) -> Floats:
        """The numbers at which `sample` goes from one triangle to the next, ascending."""
        areas = self._triangles[1]
        return np.asarray(areas[:-1] / areas[-1])

    @cached_property
    def _ranges(self) -> list[tuple[Floats, Floats]]:
        """The boxes of 1, 2, 4, ... triangles from each one on: corners ``(t, 2)`` each."""
        corners, _ = self._triangles
        levels = [(corners.min(axis=1), corners.max(axis=1))]
        while 2 ** len(levels) <= len(corners):
            step = 2 ** (len(levels) - 1)
            low, high = levels[-1]
            levels.append((np.minimum(low[:-step], low[step:]), np.maximum(high[:-step], high[step:])))
        return levels

    def drawn_bounds(self, choice: Ends, first: Ends, second: Ends) -> tuple[Floats, Floats]:
        """Boxes, corners ``(m, 2)`` each, of the points that `sample` makes of numbers between ends ``(m | 1,)``."""
        corners, areas = self._triangles
        last = len(areas) - 1
        choice_low, choice_high, *others = np.broadcast_arrays(*choice, *first, *second)
        # Boxes that end at a break between triangles hold one of them: at the break, up to rounding, both are as good, since
        # no number is drawn there but with a probability of some 1e-16.
        begin = np.minimum(
            np.searchsorted(areas, choice_low * areas[-1] * (1 + _ROUNDING), side="right"), last
        )
        end = np.minimum(np.searchsorted(areas, choice_high * areas[-1] * (1 - _ROUNDING), side="left"), last)
        end = np.maximum(end, begin)
        level = np.frexp(end - begin + 1.0)[1] - 1
        lower, upper = np.empty((len(begin), 2)), np.empty((len(begin), 2))
        for number, (low, high) in enumerate(self._ranges):
            mine = np.flatnonzero(level == number)
            one, two = begin[mine], end[mine] + 1 - 2**number
            lower[mine] = np.minimum(low[one], low[two])
            upper[mine] = np.maximum(high[one], high[two])
        single = np.flatnonzero(begin == end)
        if len(single):
            a, b, c = np.moveaxis(corners[begin[single]], 1, 0)
            first_low, first_high, second_low, second_high = (part[single, None] for part in others)
            # For either number alone a point moves along a line: the extremes are at the ends.
            points = [
                a + root * ((b - a) + along * (c - b))
                for root in (np.sqrt(first_low), np.sqrt(first_high))
                for along in (second_low, second_high)
            ]
            lower[single] = np.minimum.reduce(points)
            upper[single] = np.maximum.reduce(points)
        slack = 1e-12 * np.maximum(np.abs(lower), np.abs(upper)) + 1e-12
        return lower - slack, upper + slack

    def sample(self, choice: Floats, first: Floats, second: Floats) -> Floats:
        """Points ``(n, 2)``, uniform by area, from three columns ``(n,)`` of uniform numbers in (0, 1)."""
        corners, areas = self._triangles
        triangle = np.searchsorted(areas, choice * areas[-1], side="right")
        return _in_triangles(corners[np.minimum(triangle, len(areas) - 1)], first, second)

    def sample_in(
        self, choice: Floats, first: Floats, second: Floats, lower: Floats, upper: Floats
    ) -> tuple[Floats, Booleans]:
        """Points ``(n, 2)`` of the triangles that meet boxes ``(n, 2 or more)``, as `sample` draws them, and which boxes meet any."""
        corners, _ = self._triangles
        owner, number = near_boxes(self._tree, lower, upper)
        ab, ac = (corners[:, side] - corners[:, 0] for side in (1, 2))
        areas = np.abs(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])
        member, _, there = choose(owner, areas[number], len(choice), choice)
        if not len(owner):
            return np.zeros((len(choice), 2)), there
        return _in_triangles(corners[number[member]], first, second), there

    @cached_property
    def _tree(self) -> Any:
        corners, _ = self._triangles
        return tree_of_boxes(corners.min(axis=1), corners.max(axis=1))

    def contains(self, x: Floats, y: Floats) -> Booleans:
        """The mask of points that lie inside or on the edge, ``(n,)``."""
        import shapely

        shapely.prepare(self.polygon)
        return np.asarray(shapely.intersects_xy(self.polygon, x, y), dtype=np.bool_)

    def holds_point(self, x: float, y: float) -> bool:
        """As `contains`, of one point."""
        import shapely

        if not shapely.is_prepared(self.polygon):
            shapely.prepare(self.polygon)
        return bool(shapely.intersects_xy(self.polygon, x, y))

    def holds_disc(self, x: float, y: float, radius: float) -> bool:
        """Return whether the polygons contain one disc; `holds_discs` answers for many."""
        import shapely

        return self.holds_point(x, y) and not bool(
            shapely.dwithin(self._boundary, shapely.Point(x, y), radius)
        )

    @cached_property
    def _boundary(self) -> Any:
        import shapely

        boundary = self.polygon.boundary
        shapely.prepare(boundary)
        return boundary

    def distances(self, x: Floats, y: Floats) -> Floats:
        """Distances of points of the plane from the polygons, ``(n,)``; 0 inside."""
        import shapely

        # Whether a point lies inside is read off an index, while a distance visits every edge.
        outside = np.flatnonzero(~self.contains(x, y))
        distances = np.zeros(len(x))
        distances[outside] = shapely.distance(self.polygon, shapely.points(x[outside], y[outside]))
        return distances

    def distance(self, x: float, y: float) -> float:
        """As `distances`, of one point."""
        import shapely

        if self._is_large and self.holds_point(x, y):
            return 0.0
        return float(shapely.distance(self.polygon, shapely.points(np.array((x, y)))))

    @cached_property
    def _is_large(self) -> bool:
        """Return whether visiting every edge takes longer than asking first whether the point lies inside."""
        import shapely

        return bool(shapely.get_num_coordinates(self.polygon) > _LARGE)

    def lie_farther(self, x: Floats, y: Floats, limits: Floats) -> Booleans:
        """Return a mask ``(n,)`` of points whose distance from the polygons exceeds ``limits`` ``(n,)``; sooner than by `distances`."""
        import shapely

        shapely.prepare(self.polygon)
        return np.asarray(~shapely.dwithin(self.polygon, shapely.points(x, y), limits), dtype=np.bool_)

    def depths(self, x: Floats, y: Floats) -> Floats:
        """Distances of points of the plane from what lies outside, ``(n,)``; 0 outside."""
        import shapely

        depths = shapely.distance(self._boundary, shapely.points(x, y))
        return np.where(self.contains(x, y), depths, 0.0)

    def nearly_contains(self, x: Floats, y: Floats) -> Booleans:
        """The mask of points that lie inside up to the tolerance, ``(n,)``."""
        import shapely

        return np.asarray(shapely.intersects_xy(self._grown, x, y), dtype=np.bool_)

    @cached_property
    def _grown(self) -> Any:
        import shapely

        grown = self.polygon.buffer(TOLERANCE, join_style="mitre")
        shapely.prepare(grown)
        return grown

    def holds_discs(self, x: Floats, y: Floats, radius: Floats) -> Booleans:
        """Return the mask of discs that are quickly seen to lie inside, ``(n,)``; not all that do."""
        import shapely

        near = shapely.dwithin(self._boundary, shapely.points(x, y), radius)
        return np.asarray(self.contains(x, y) & ~near, dtype=np.bool_)

    def covers_hulls(self, points: Floats) -> Booleans:
        """The mask of convex hulls of points ``(n, k, 2)`` that lie inside, up to the tolerance."""
        import shapely

        count, size = points.shape[:2]
        owner = np.repeat(np.arange(count), size)
        hulls = shapely.convex_hull(shapely.multipoints(points.reshape(-1, 2), indices=owner))
        return np.asarray(shapely.covers(self._grown, hulls), dtype=np.bool_)

    def covers_triangles(self, corners: Floats) -> bool:
        """Return whether all triangles ``(t, 3, 2)`` lie inside, up to the tolerance."""
        import shapely

        return bool(shapely.covers(self._grown, shapely.polygons(corners)).all())


def _in_triangles(corners: Floats, first: Floats, second: Floats) -> Floats:
    """Uniform points ``(n, 2)`` of triangles ``(n, 3, 2)``."""
    a, b, c = np.moveaxis(corners, 1, 0)
    # The square root makes a strip parallel to bc as likely as it is long.
    root = np.sqrt(first)[:, None]
    along = second[:, None]
    result: Floats = (1 - root) * a + root * (1 - along) * b + root * along * c
    return result
