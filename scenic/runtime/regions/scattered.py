"""Finite sets of points, and grids (section 9.2 of the specification)."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.graph.kinds import Column
from scenic.language.errors import ScenicTypeError, ScenicValueError
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.ground.context import here
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.values.values import Vector, is_random, to_vector


class PointSetRegion(Region):
    """A finite set of points, each equally likely.

    Args:
        name: for messages.
        points: the points.
        kdTree: accepted for compatibility; an index is made when it is needed.
        orientation: a vector field, or ``None``.
        tolerance: metres within which a point counts as one of the set.

    """

    dimension: float = 0
    draws = 1

    def __init__(
        self,
        name: str | None,
        points: Sequence[object],
        kdTree: object = None,
        orientation: object = None,
        tolerance: float = 1e-6,
    ) -> None:
        super().__init__(name=name)
        rows = points.tolist() if isinstance(points, np.ndarray) else list(points)
        if is_random(rows):
            raise ScenicTypeError(f"`{type(self).__name__}` needs fixed points", span=here())
        if not rows:
            raise ScenicValueError(f"`{type(self).__name__}` needs at least one point", span=here())
        self.points = np.array([tuple(to_vector(point, f"`{type(self).__name__}`")) for point in rows])
        self.orientation = orientation
        self.has_orientation = orientation is not None
        self.tolerance = tolerance

    @cached_property
    def kdTree(self) -> Any:
        """The index of the points, SciPy's."""
        from scipy.spatial import KDTree

        return KDTree(self.points)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        count = len(self.points)
        return self.points[np.minimum((uniforms[0] * count).astype(np.intp), count - 1)], None

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return np.asarray(self.distances(points) <= self.tolerance)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.zeros(lanes, dtype=np.bool_)

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return np.asarray(self.kdTree.query(points)[0], dtype=np.float64)

    def closestPointTo(self, point: object) -> Vector:
        place = tuple(to_vector(point, "`closestPointTo`"))
        return Vector.of(self.points[self.kdTree.query(place)[1]].tolist())

    def box(self, *columns: Column) -> tuple[Points, Points]:
        return self.points.min(axis=0)[np.newaxis], self.points.max(axis=0)[np.newaxis]

    def sizes(self, *columns: Column) -> NDArray[np.float64]:
        return np.full(1, float(len(self.points)))


class GridRegion(PointSetRegion):
    """The points of the free cells of a grid in the plane.

    Args:
        name: for messages.
        grid: a matrix ``(rows, columns)``; 0 is free, everything else an obstacle.
        Ax, Ay: metres between columns and rows.
        Bx, By: where the cell of row 0, column 0 is.
        orientation: a vector field, or ``None``.

    """

    def __init__(
        self,
        name: str | None,
        grid: object,
        Ax: float,
        Ay: float,
        Bx: float,
        By: float,
        orientation: object = None,
    ) -> None:
        self.grid = np.array(grid)
        if self.grid.ndim != 2:
            raise ScenicValueError("`GridRegion` needs a matrix of cells", span=here())
        self.Ax, self.Ay, self.Bx, self.By = float(Ax), float(Ay), float(Bx), float(By)
        self.sizeY, self.sizeX = self.grid.shape
        rows, columns = np.nonzero(self.grid == 0)
        points = [self.gridToPoint(cell) for cell in zip(columns.tolist(), rows.tolist(), strict=True)]
        super().__init__(name, points, orientation=orientation)

    def gridToPoint(self, cell: Any) -> tuple[float, float]:
        """The point of a cell given by column and row."""
        column, row = cell
        return (self.Ax * column + self.Bx, self.Ay * row + self.By)

    def pointToGrid(self, point: object) -> tuple[int, int] | None:
        """Column and row of the cell nearest to a point; ``None`` beside the grid."""
        x, y, _ = to_vector(point)
        column, row = round((x - self.Bx) / self.Ax), round((y - self.By) / self.Ay)
        inside = 0 <= column < self.sizeX and 0 <= row < self.sizeY
        return (column, row) if inside else None

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        column = np.rint((points[:, 0] - self.Bx) / self.Ax)
        row = np.rint((points[:, 1] - self.By) / self.Ay)
        inside = (column >= 0) & (column < self.sizeX) & (row >= 0) & (row < self.sizeY)
        free = (
            self.grid[np.where(inside, row, 0).astype(np.intp), np.where(inside, column, 0).astype(np.intp)]
            == 0
        )
        return np.asarray(inside & free)

    def container_box(self, *columns: Column) -> tuple[Points, Points]:
        """Return the box of the whole cells, at every height: the cell in which a point lies contains it."""
        lower, upper = self.box(*columns)
        half = np.array([abs(self.Ax) / 2, abs(self.Ay) / 2, np.inf])
        return lower - half, upper + half

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Return a mask of the lanes in which the corners of the body's bounding box lie in free cells and no
        obstacle lies below it.
        """
        import shapely

        rows, cells = np.nonzero(self.grid != 0)
        obstacles = (
            shapely.multipoints(np.column_stack([self.Ax * cells + self.Bx, self.Ay * rows + self.By]))
            if len(rows)
            else None
        )
        result = np.zeros(lanes, dtype=np.bool_)
        corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
        for lane in range(lanes):
            pose_number = np.array([lane if len(body) > 1 else 0])
            world = body.poses.take(pose_number).to_world(corners[np.newaxis])[0]
            if self.contains_points(world).all():
                outline = shapely.MultiPoint(world[:, :2]).convex_hull
                result[lane] = obstacles is None or not outline.intersects(obstacles)
        return result


__all__ = ["GridRegion", "PointSetRegion"]
