"""Regions made of equal cubes: those of a grid that are filled (the voxel region of section 9.2 of the specification)."""

import itertools
import math
from collections.abc import Iterator
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from scenic.graph.kinds import Column
from scenic.language.errors import ScenicTypeError, ScenicValueError
from scenic.runtime.geometry.containment.body_points import bounds
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.ground.context import here
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.meshes import MeshVolumeRegion
from scenic.runtime.regions.spaces import nowhere
from scenic.runtime.regions.volumes import BoxRegion

_INNER = 1 - 1e-9
"""Part of the edge of an empty cell that nothing inside the others may meet: a face belongs to both cells at it."""

_MOST_CELLS = 1 << 27
"""Cells of a grid up to which it is made."""


class VoxelRegion(Region):
    """The filled cells of a grid.

    Args:
        voxelGrid: a `trimesh.voxel.VoxelGrid`, of cubes along the global axes.
        orientation: a vector field, or ``None``.
        name: for messages.

    """

    dimension: float = 3
    draws = 4

    def __init__(
        self, voxelGrid: Any, orientation: object = None, name: str | None = None, **_established: Any
    ) -> None:
        try:
            cells = np.asarray(voxelGrid.matrix, dtype=np.bool_)
            matrix = np.asarray(voxelGrid.transform, dtype=np.float64)
        except AttributeError:
            raise ScenicTypeError(
                f"`VoxelRegion` needs a voxel grid of trimesh, not {voxelGrid!r}",
                span=here(),
                help="use `region.voxelized(pitch)`, or `trimesh.voxel.VoxelGrid`",
            ) from None
        pitch = np.diag(matrix)[:3]
        if not np.array_equal(matrix[:3, :3], np.diag(pitch)) or not (pitch > 0).all():
            raise ScenicValueError("`VoxelRegion` needs a grid along the global axes", span=here())
        self._fill(cells, matrix[:3, 3] - pitch / 2, pitch, orientation, name)

    @classmethod
    def of_cells(
        cls, filled: NDArray[np.bool_], corner: Points, pitch: float, orientation: object = None
    ) -> Self:
        """The region of cells of one edge length from the lower corner ``(3,)`` of the grid on."""
        self = object.__new__(cls)
        self._fill(filled, np.asarray(corner, dtype=np.float64), np.full(3, float(pitch)), orientation, None)
        return self

    def _fill(
        self, filled: NDArray[np.bool_], corner: Points, pitch: Points, orientation: object, name: str | None
    ) -> None:
        if not filled.any():
            raise ScenicValueError("`VoxelRegion` needs at least one filled cell", span=here())
        super().__init__(name=name)
        self.filled, self.corner, self.pitch = filled, corner, pitch
        self.orientation = orientation
        self.has_orientation = orientation is not None
        self._cells = np.argwhere(filled)

    @property
    def scale(self) -> Points:
        """The edges of a cell, ``(3,)`` in metres."""
        return self.pitch

    @property
    def voxel_points(self) -> Points:
        """The middles of the filled cells, ``(n, 3)``."""
        return self.corner + (self._cells + 0.5) * self.pitch

    @property
    def kdTree(self) -> Any:
        """SciPy's search tree over the middles of the filled cells."""
        from scipy.spatial import KDTree

        return KDTree(self.voxel_points)

    @property
    def voxelGrid(self) -> Any:
        """The grid, trimesh's."""
        from trimesh.voxel import VoxelGrid

        matrix = np.diag([*self.pitch, 1.0])
        matrix[:3, 3] = self.corner + self.pitch / 2
        return VoxelGrid(  # type: ignore[no-untyped-call] # trimesh has no types
            self.filled, transform=matrix
        )

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        count = len(self._cells)
        chosen = self._cells[np.minimum((uniforms[0] * count).astype(np.intp), count - 1)]
        return self.corner + (chosen + uniforms[1:].T) * self.pitch, None

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        place = (points - self.corner) / self.pitch
        cell = np.floor(place).astype(np.int64)
        inside = self._are_filled(cell)
        # A point on a face belongs to both cells at it, one at an edge or a corner to all that meet there.
        at_border = place == cell
        left = np.flatnonzero(at_border.any(axis=1) & ~inside)
        for step in itertools.product((0, 1), repeat=3):
            inside[left] |= self._are_filled(cell[left] - at_border[left] * step)
        return inside

    def _are_filled(self, cell: NDArray[np.int64]) -> Mask:
        shape = np.array(self.filled.shape)
        known = ((cell >= 0) & (cell < shape)).all(axis=1)
        x, y, z = np.clip(cell, 0, shape - 1).T
        return np.asarray(known & self.filled[x, y, z])

    def cells_within(self, lower: Points, upper: Points) -> Iterator[Region]:
        """Yield the filled cells, as boxes, that reach into a box of these corners ``(1, 3)``."""
        middles = self.corner + (self._cells + 0.5) * self.pitch
        near = ((middles + self.pitch / 2 >= lower) & (middles - self.pitch / 2 <= upper)).all(axis=1)
        for middle in middles[near].tolist():
            yield BoxRegion(dimensions=self.pitch.tolist(), position=middle)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Return a mask of the lanes in which the body meets no empty cell and nothing outside the grid."""
        lower, upper = bounds(body)
        first = np.floor((lower - self.corner) / self.pitch).astype(np.int64)
        last = np.ceil((upper - self.corner) / self.pitch).astype(np.int64)
        shape = np.array(self.filled.shape)
        inside: Mask = np.asarray((first >= 0).all(axis=1) & (last <= shape).all(axis=1))
        first, last = np.clip(first, 0, shape), np.clip(last, 0, shape)
        # Only lanes whose box reaches an empty cell need the body itself.
        doubtful = np.flatnonzero(inside & (self._filled_cells(first, last) < (last - first).prod(axis=1)))
        if len(doubtful):
            inside[doubtful] = self._free_of_empty(
                body if len(body) == 1 else body.take(doubtful), first[doubtful], last[doubtful]
            )
        return np.asarray(np.broadcast_to(inside, lanes))

    def _filled_cells(self, first: NDArray[np.int64], last: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the numbers of filled cells from ``first`` (included) to ``last`` (excluded), ``(n, 3)`` each."""
        sums = np.zeros(np.array(self.filled.shape) + 1, dtype=np.int64)
        sums[1:, 1:, 1:] = self.filled.cumsum(0).cumsum(1).cumsum(2)
        (a, b, c), (d, e, f) = first.T, last.T
        return np.asarray(
            sums[d, e, f] - sums[a, e, f] - sums[d, b, f] - sums[d, e, c]
            + sums[a, b, f] + sums[a, e, c] + sums[d, b, c] - sums[a, b, c]
        )  # fmt: skip

    def _free_of_empty(self, body: Body, first: NDArray[np.int64], last: NDArray[np.int64]) -> Mask:
        """Return a mask ``(n,)`` of the lanes in which the body avoids the inside of every empty cell that its box reaches."""
        free = np.ones(len(first), dtype=np.bool_)
        empty = np.argwhere(~self.filled)
        nearby = ((first.min(axis=0) <= empty) & (empty < last.max(axis=0))).all(axis=1)
        for cell in empty[nearby]:
            lanes = np.flatnonzero(free & (first <= cell).all(axis=1) & (cell < last).all(axis=1))
            if not len(lanes):
                continue
            middle = self.corner + (cell + 0.5) * self.pitch
            part = body if len(body) == 1 else body.take(lanes)
            inner = BoxRegion(dimensions=(self.pitch * _INNER).tolist(), position=middle.tolist())
            columns = inner.fixed_columns("a cell")
            free[lanes] = ~np.broadcast_to(inner.meets_bodies(part, len(lanes), *columns), len(lanes))
        return free

    @property
    def mesh(self) -> MeshVolumeRegion:
        """The cells as a volume bounded by a mesh: the faces between filled cells and empty ones."""
        solid_cells = np.pad(self.filled, 1)
        corners: list[NDArray[np.int64]] = []
        for axis in range(3):
            across, along = (axis + 1) % 3, (axis + 2) % 3
            for side in (0, 1):
                beyond = np.roll(solid_cells, 1 - 2 * side, axis=axis)
                cells = np.argwhere(solid_cells & ~beyond) - 1
                steps = [(0, 0), (1, 0), (1, 1), (0, 1)][:: 1 if side else -1]
                quads = np.repeat(cells[:, np.newaxis], 4, axis=1)
                quads[:, :, axis] += side
                for place, (one, two) in enumerate(steps):
                    quads[:, place, across] += one
                    quads[:, place, along] += two
                corners.append(quads)
        quads = np.concatenate(corners).reshape(-1, 3)
        vertices, numbers = np.unique(quads, axis=0, return_inverse=True)
        numbers = numbers.reshape(-1, 4)
        faces = np.concatenate([numbers[:, [0, 1, 2]], numbers[:, [0, 2, 3]]])
        surface = Mesh(self.corner + vertices * self.pitch, faces)
        return MeshVolumeRegion(surface, centerMesh=False, orientation=self.orientation, name=self.name)

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        """Return the distances to the nearest filled cell: its centre is within a cell's diagonal of being the nearest."""
        from scipy.spatial import KDTree

        centres = self.corner + (self._cells + 0.5) * self.pitch
        index = KDTree(centres)
        near = index.query(points)[0]
        half = self.pitch / 2
        result = np.empty(len(points))
        reach = near + float(np.linalg.norm(half))
        for lane, candidates in enumerate(index.query_ball_point(points, reach)):
            beside = np.maximum(np.abs(points[lane] - centres[candidates]) - half, 0)
            result[lane] = np.sqrt((beside**2).sum(axis=1).min())
        return result

    def gaps(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        lower, upper = self.box()
        beside = np.maximum(np.maximum(lower - points, points - upper), 0)
        return np.asarray(np.sqrt((beside**2).sum(axis=1)))

    def box(self, *columns: Column) -> tuple[Points, Points]:
        low, high = self._cells.min(axis=0), self._cells.max(axis=0) + 1
        return (self.corner + low * self.pitch)[np.newaxis], (self.corner + high * self.pitch)[np.newaxis]

    def sizes(self, *columns: Column) -> NDArray[np.float64]:
        return np.array([len(self._cells) * float(self.pitch.prod())])

    def dilation(self, iterations: int, structure: Any = None) -> Region:
        """Return the region with the cells added that touch a filled one, repeatedly, or removed if ``iterations`` is negative; `nowhere` if nothing is left.

        Args:
            iterations: how often.
            structure: which neighbours touch, an array of truth values as SciPy takes it; those that share a face by default.

        """
        from scipy import ndimage

        if iterations == 0:
            return self
        margin_cells = np.pad(self.filled, max(iterations, 0))
        change = ndimage.binary_dilation if iterations > 0 else ndimage.binary_erosion
        solid_cells = change(margin_cells, structure=structure, iterations=abs(iterations))
        if not solid_cells.any():
            return nowhere
        corner = self.corner - max(iterations, 0) * self.pitch
        region = object.__new__(VoxelRegion)
        region._fill(np.asarray(solid_cells), corner, self.pitch, self.orientation, None)
        return region


def voxelized(region: Region, solid: Mesh, pitch: float) -> VoxelRegion:
    """Return the cells of a grid about the origin that a solid touches.

    Args:
        region: the region, asked for the middles of cells that its surface does not meet.
        solid: its surface in the world, a `Mesh`.
        pitch: edge of a cell, metres.

    """
    if not pitch > 0:
        raise ScenicValueError(f"`voxelized` needs a positive edge, not {pitch!r}", span=here())
    low, high = (np.asarray(corner) for corner in solid.bounds)
    first, last = (np.floor(corner / pitch + 0.5) for corner in (low, high))
    numbers = last - first + 1
    if math.prod(numbers.tolist()) > _MOST_CELLS:  # of floats: integers might overflow
        count = ", ".join(f"{number:.16g}" for number in numbers)
        raise ScenicValueError(
            f"cells of {pitch:g} m would be [{count}] in number", span=here(), help="use larger cells"
        )
    shape = numbers.astype(np.int64)
    corner = (first - 0.5) * pitch
    cells = np.zeros(shape, dtype=np.bool_)
    middles = corner + (np.argwhere(~cells) + 0.5) * pitch
    inside = region.contains_points(middles, *region.fixed_columns("the cells")).reshape(shape)
    # A cell that the surface meets but whose middle is outside: found by points of the surface, closer than any cell.
    import trimesh

    surface = trimesh.Trimesh(np.array(solid.vertices), np.array(solid.faces), process=False)
    vertices, _ = trimesh.remesh.subdivide_to_size(  # type: ignore[no-untyped-call] # trimesh has no types
        surface.vertices, surface.faces, pitch / 2, max_iter=20
    )
    cells_of_vertices = np.clip(np.floor((vertices - corner) / pitch).astype(np.int64), 0, shape - 1)
    inside[tuple(cells_of_vertices.T)] = True
    return VoxelRegion.of_cells(inside, np.asarray(corner, dtype=np.float64), pitch, region.orientation)


__all__ = ["VoxelRegion", "voxelized"]
