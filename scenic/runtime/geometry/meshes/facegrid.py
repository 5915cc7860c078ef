"""The faces of a unit mesh sorted into the cells of a grid: which faces may a line meet, which are near a point."""

from typing import Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.cells import PADDING, cell_of, touched_cells
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import distinct, expand, group_starts, pieces

_CHUNK: Final = 1 << 19
"""Pairs of query and cell or face looked at together."""


@dataclass(frozen=True, slots=True)
class FaceGrid:
    """The faces that touch each cell of a grid over the unit cube.

    Attributes:
        resolution: cells per axis.
        starts: ``(resolution³ + 1,)``: where the faces of each cell begin in ``faces``.
        faces: face numbers, cell by cell.

    """

    resolution: int
    starts: Indices
    faces: Indices

    def along_lines(self, points: Floats, directions: Floats) -> tuple[Indices, Indices]:
        """Pairs (line, face) without duplicates that hold all the faces each line meets.

        Args:
            points: a point of each line, ``(n, 3)``, in the unit frame.
            directions: its direction, ``(n, 3)``, of any length but 0.

        """
        cells = [
            self._cells_along(points[part], directions[part], part.start) for part in self._lines(points)
        ]
        return self._faces_in(*(np.concatenate(columns) for columns in zip(*cells, strict=True)))

    def _lines(self, points: Floats) -> list[slice]:
        step = max(1, _CHUNK // (9 * self.resolution))
        return [slice(start, min(start + step, len(points))) for start in range(0, max(len(points), 1), step)]

    def _cells_along(self, points: Floats, directions: Floats, offset: int) -> tuple[Indices, Indices]:
        """Pairs (line, cell): in each layer across its main direction, a line meets at most 3 by 3 cells."""
        size = self.resolution
        main = np.argmax(np.abs(directions), axis=1)
        line = np.arange(len(points))
        slope = directions / directions[line, main][:, None]
        layers = np.arange(size)
        bottom = layers / size - 0.5 - PADDING
        top = (layers + 1) / size - 0.5 + PADDING
        low = np.empty((3, len(points), size), dtype=np.intp)
        high = np.empty((3, len(points), size), dtype=np.intp)
        for axis in range(3):
            at_bottom, at_top = (
                points[:, axis, None] + (ends - points[line, main][:, None]) * slope[:, axis, None]
                for ends in (bottom, top)
            )
            # Far outside the cube the coordinates would overflow; one cell outside says the same.
            first = np.clip(np.minimum(at_bottom, at_top) - PADDING, -1.0, 1.0)
            last = np.clip(np.maximum(at_bottom, at_top) + PADDING, -1.0, 1.0)
            low[axis] = np.maximum(np.floor((first + 0.5) * size), 0)
            high[axis] = np.minimum(np.floor((last + 0.5) * size), size - 1)
            across = main == axis
            low[axis, across] = high[axis, across] = layers
        counts = (high - low + 1).clip(0)
        total = counts[0] * counts[1] * counts[2]
        owner, index = expand(total.ravel())
        ny, nz = counts[1].ravel()[owner], counts[2].ravel()[owner]
        x = low[0].ravel()[owner] + index // (ny * nz)
        y = low[1].ravel()[owner] + index // nz % ny
        z = low[2].ravel()[owner] + index % nz
        return owner // size + offset, (x * size + y) * size + z

    def near_points(self, points: Floats, reach: Floats) -> tuple[Indices, Indices]:
        """Pairs (point, face) without duplicates that hold all faces near each point.

        Args:
            points: ``(n, 3)``, in the unit frame.
            reach: how far, on each axis, ``(n, 3)``.

        """
        close = (np.abs(points) <= 0.5 + PADDING + reach).all(axis=1)
        near = np.flatnonzero(close)
        low = cell_of(points[near] - reach[near] - PADDING, self.resolution)
        counts = cell_of(points[near] + reach[near] + PADDING, self.resolution) - low + 1
        owner, index = expand(counts[:, 0] * counts[:, 1] * counts[:, 2])
        ny, nz = counts[owner, 1], counts[owner, 2]
        cell = low[owner] + np.stack([index // (ny * nz), index // nz % ny, index % nz], axis=1)
        number = (cell[:, 0] * self.resolution + cell[:, 1]) * self.resolution + cell[:, 2]
        return self._faces_in(near[owner], number)

    def _faces_in(self, query: Indices, cell: Indices) -> tuple[Indices, Indices]:
        counts = self.starts[cell + 1] - self.starts[cell]
        full_cells = np.flatnonzero(counts)
        query, cell, counts = query[full_cells], cell[full_cells], counts[full_cells]
        keys = [np.zeros(0, dtype=np.intp)]
        count = int(self.faces.max(initial=0)) + 1
        for part in pieces(counts, _CHUNK):
            owner, index = expand(counts[part])
            faces = self.faces[self.starts[cell[part]][owner] + index]
            keys.append(distinct(query[part][owner] * count + faces))
        unique = distinct(np.concatenate(keys))
        return unique // count, unique % count


def face_grid(mesh: Mesh) -> FaceGrid:
    """Return the grid of a unit mesh. Get it as ``mesh.derived(face_grid)``."""
    resolution = int(np.clip(np.sqrt(len(mesh.faces) / 6), 4, 96))
    pairs = list(touched_cells(mesh.triangles, resolution))
    face = np.concatenate([pair[0] for pair in pairs])
    cell = np.concatenate([pair[1] for pair in pairs])
    order = np.argsort(cell, kind="stable")
    return FaceGrid(resolution, group_starts(cell[order], resolution**3), face[order])
