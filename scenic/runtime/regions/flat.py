"""Regions of the plane, and columns above and below them, as shapely geometries over lanes; and how bodies meet them."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.kinds import Column
from scenic.runtime.geometry.flat.outlines import Geometries, cuts, shadows, shadows_meet, upright
from scenic.runtime.geometry.flat.polygons import TOLERANCE
from scenic.runtime.geometry.flat.rectangles import Rectangles
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses

Mask = NDArray[np.bool_]
_SLACK = 1e-9
"""Metres by which boxes may lie apart and be looked at: more than rounding."""


@dataclass(frozen=True, slots=True)
class Flat:
    """The geometry in a level plane, or above and below it, in each lane.

    Attributes:
        geometries: shapely geometries, ``(n | 1,)``.
        heights: of the planes, ``(n | 1,)``; ``None`` for columns, which have every height.

    """

    geometries: Geometries
    heights: Column | None

    def intersection(self, other: "Flat") -> "Flat":
        """Return the geometry that lies in both."""
        import shapely

        shared = shapely.intersection(self.geometries, other.geometries)
        if self.heights is None or other.heights is None:
            return Flat(shared, other.heights if self.heights is None else self.heights)
        return Flat(np.where(self.heights == other.heights, shared, shapely.Polygon()), self.heights)

    def difference(self, other: "Flat") -> "Flat | None":
        """Return the geometry that lies in the first alone; ``None`` for a column without a plane."""
        import shapely

        rest = shapely.difference(self.geometries, other.geometries)
        if other.heights is None:
            return Flat(rest, self.heights)
        if self.heights is None:
            return None
        return Flat(np.where(self.heights == other.heights, rest, self.geometries), self.heights)

    def union(self, other: "Flat") -> "Flat | None":
        """Return the geometry that lies in either; ``None`` unless all heights are the same."""
        import shapely

        if self.heights is None or other.heights is None:
            same = self.heights is None and other.heights is None
        else:
            same = bool((self.heights == other.heights).all())
        return Flat(shapely.union(self.geometries, other.geometries), self.heights) if same else None

    def meets(self, body: Body, lanes: NDArray[np.intp]) -> Mask:
        """Return a mask of some lanes, whose geometries these are: those in which a body shares a point with them."""
        import shapely

        if self.heights is None:
            return shadows_meet(body, lanes, self)
        return np.asarray(shapely.intersects(self.geometries, cuts(body, lanes, self.heights)))

    def meets_geometries(self, geometries: Geometries, rows: NDArray[np.intp]) -> Mask:
        """Return whether shapely geometries ``(k,)`` meet those of the lanes with the numbers ``rows``, ``(k,)``."""
        import shapely

        return np.asarray(shapely.intersects(rows_of([self.geometries], rows)[0], geometries))

    def meets_points(self, points: NDArray[np.float64], rows: NDArray[np.intp]) -> Mask:
        """Return whether some of the points ``(k, m, 2)`` lie in the geometries of the lanes with the numbers ``rows``, ``(k,)``."""
        return some_inside(rows_of([self.geometries], rows)[0], points)

    def holds(self, body: Body, lanes: NDArray[np.intp]) -> Mask:
        """Return a mask of some lanes, whose geometries these are: those in which the column over them holds the body."""
        import shapely

        grown = shapely.buffer(self.geometries, TOLERANCE, join_style="mitre")
        return np.asarray(shapely.covers(grown, shadows(body, lanes)))

    def distances(self, points: NDArray[np.float64]) -> Column:
        """Distances ``(n,)`` of points ``(n, 3)``; 0 inside, infinite where nothing is left."""
        import shapely

        beside = shapely.distance(self.geometries, shapely.points(points[:, 0], points[:, 1]))
        beside = np.where(np.isnan(beside), np.inf, beside)
        return beside if self.heights is None else np.hypot(beside, points[:, 2] - self.heights)


def load_library() -> None:
    """Import shapely now, while a program is loaded, instead of during the first scenes."""
    import shapely  # noqa: F401 - for the functions here


def some_inside(geometries: Geometries, points: NDArray[np.float64]) -> Mask:
    """Return whether some of the points ``(k, m, 2)`` lie in shapely geometries ``(k | 1,)`` or on their edges, ``(k,)``."""
    import shapely

    held = shapely.intersects_xy(geometries[:, np.newaxis], points[..., 0], points[..., 1])
    return np.asarray(np.logical_or.reduce(held, axis=1))


class MeetingFlat(Protocol):
    """Regions of the plane that bodies can meet."""

    def box(self, *columns: Column) -> tuple[Column, Column]:
        """Lower and upper corners ``(n | 1, 3)``."""

    def meets_rectangles(self, rectangles: Rectangles, *columns: Column) -> tuple[Mask, Mask]:
        """Return the masks of rectangles ``(n,)`` that meet the region, and of those for which this is left open."""

    def meets_outlines(self, outlines: Geometries, *columns: Column) -> Mask:
        """Return the mask of geometries ``(n,)`` that meet the region."""

    def meets_places(self, points: Column, *columns: Column) -> Mask:
        """Return a mask of the rows of points ``(n, m, 2)`` of which some lie in the region."""


@dataclass(frozen=True, slots=True)
class _Placed:
    """A region of the plane in some lanes, as an area."""

    region: MeetingFlat
    columns: Sequence[Column]

    def meets_geometries(self, geometries: Geometries, rows: NDArray[np.intp]) -> Mask:
        return self.region.meets_outlines(geometries, *rows_of(self.columns, rows))

    def meets_points(self, points: NDArray[np.float64], rows: NDArray[np.intp]) -> Mask:
        return self.region.meets_places(points, *rows_of(self.columns, rows))


def rows_of(columns: Sequence[Column], lanes: NDArray[np.intp]) -> list[Column]:
    """Return the columns in some lanes; a single row stays one."""
    return [column if len(column) == 1 else column[lanes] for column in columns]


def meets_flat(
    region: MeetingFlat, body: Body, lanes: int, columns: Sequence[Column], heights: Column | None
) -> Mask:
    """Return a mask of the lanes in which a body meets a region of planes at ``heights``, or its column where they are ``None``.

    Upright boxes are compared as rectangles, in closed form; other bodies by their outlines.
    """
    result = np.zeros(lanes, dtype=np.bool_)
    lower, upper = body.poses.bounds()
    low, high = region.box(*columns)
    near = (low[:, :2] <= upper[:, :2] + _SLACK) & (high[:, :2] >= lower[:, :2] - _SLACK)
    close = near[:, 0] & near[:, 1]
    if heights is not None:
        close = close & (lower[:, 2] - _SLACK <= heights) & (heights <= upper[:, 2] + _SLACK)
    left = np.flatnonzero(np.broadcast_to(close, lanes))
    if not len(left):
        return result
    boxes, rectangles = upright_boxes(body, left, heights)
    if boxes.any():
        mine = left[boxes]
        overlaps, is_open = region.meets_rectangles(rectangles.take(boxes), *rows_of(columns, mine))
        result[mine] = overlaps
        left = np.concatenate([left[~boxes], mine[np.broadcast_to(is_open & ~overlaps, len(mine))]])
    if not len(left):
        return result
    if heights is None:
        result[left] = shadows_meet(body, left, _Placed(region, rows_of(columns, left)))
    else:
        cut = cuts(body, left, rows_of([heights], left)[0])
        result[left] = region.meets_outlines(cut, *rows_of(columns, left))
    return result


def upright_boxes(body: Body, lanes: NDArray[np.intp], heights: Column | None) -> tuple[Mask, Rectangles]:
    """Return a mask of some lanes: those in which the body is an upright box that a plane meets; and the outlines of the bodies' boxes."""
    count = len(lanes)
    poses = body.poses.take(lanes)
    full = Poses(
        np.broadcast_to(poses.position, (count, 3)),
        np.broadcast_to(poses.orientation, (count, 4)),
        np.broadcast_to(poses.size, (count, 3)),
    )
    boxes = np.array(upright(full))
    numbers = (
        np.zeros(count, dtype=np.intp)
        if body.choice is None
        else np.broadcast_to(body.choice if len(body.choice) == 1 else body.choice[lanes], count)
    )
    boxes &= np.array([mesh.is_box for mesh in body.meshes])[numbers]
    if heights is not None:
        middle, half = full.position[:, 2], full.size[:, 2] / 2
        level = heights if len(heights) == 1 else heights[lanes]
        boxes &= (middle - half <= level) & (level <= middle + half)
    return boxes, Rectangles.under(full)


def ragged_polygons(points: NDArray[np.float64], counts: NDArray[np.intp]) -> Geometries:
    """Return polygons ``(n,)`` whose outlines are the first ``counts`` ``(n,)`` of points ``(n, k, 2)``."""
    import shapely

    used = np.arange(points.shape[1]) < counts[:, np.newaxis]
    owner = np.nonzero(used)[0]
    return np.asarray(shapely.polygons(shapely.linearrings(points[used], indices=owner)), dtype=np.object_)


__all__ = [
    "Flat",
    "load_library",
    "meets_flat",
    "ragged_polygons",
    "rows_of",
    "some_inside",
    "upright_boxes",
]
