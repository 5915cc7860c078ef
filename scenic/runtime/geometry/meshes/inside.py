"""Containment of points in a solid, decided exactly by parity in double precision.

A vertical line through the point is followed upwards, and its crossings with the surface are counted. What
counts as a crossing is decided per edge of the projected triangles, by the same operations on the same
numbers for all faces that share the edge, and half-open where the point is level with a vertex. So no line
slips between two faces or meets both: the surface of a closed mesh is watertight whatever the rounding, and
only points within rounding of the surface itself may go either way.
"""

from collections.abc import Iterator
from typing import Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.ragged import expand, group_starts, pieces

_CHUNK: Final = 1 << 19
"""Pairs of point and face looked at together; some twenty temporary arrays of that length are alive."""

_FEW: Final = 1 << 16
"""Pairs of point and face up to which all are looked at: a grid takes longer to make."""

_PADDING: Final = 1e-12
"""Part of the extents by which the boxes of faces are widened: more than the rounding of points on edges."""

_MOST_INCIDENCES: Final = 8
"""Cells of the grid per face above which the grid is made coarser, on average."""


@dataclass(frozen=True, slots=True)
class UprightFaces:
    """The faces of a mesh, made ready for vertical lines.

    Attributes:
        corners: ``(f, 3, 3)`` corners of each face, in ascending order of vertex index, so that both faces
            of an edge run through it in the same direction.
        boxes: ``(f, 6)``: lower and upper corner of the bounding box of each face, slightly widened.

    """

    corners: Floats
    boxes: Floats


def upright_faces(mesh: Mesh) -> UprightFaces:
    """Compute the upright faces of a mesh. Get them as ``mesh.derived(upright_faces)``, which keeps them."""
    corners = mesh.vertices[np.sort(mesh.faces, axis=1)]
    padding = _PADDING * mesh.extents
    # Written out, since reductions over short axes are slow.
    lowest = np.minimum(np.minimum(corners[:, 0], corners[:, 1]), corners[:, 2])
    highest = np.maximum(np.maximum(corners[:, 0], corners[:, 1]), corners[:, 2])
    return UprightFaces(corners, np.concatenate([lowest - padding, highest + padding], axis=1))


@dataclass(frozen=True, slots=True)
class ColumnGrid:
    """The faces of a mesh sorted into columns over a grid in the XY plane.

    Attributes:
        lower: corner of the grid, ``(2,)``.
        scale: cells per unit of length, ``(2,)``.
        cells: cells per axis.
        starts: ``(cells² + 1,)``: where the faces of each cell begin in ``faces``.
        faces: face indices, cell by cell.

    """

    lower: Floats
    scale: Floats
    cells: int
    starts: Indices
    faces: Indices


def column_grid(mesh: Mesh) -> ColumnGrid:
    """Return the grid of a mesh; takes tens of milliseconds for 100,000 faces. Get it as ``mesh.derived(column_grid)``."""
    boxes = mesh.derived(upright_faces).boxes
    low, high = boxes[:, :2], boxes[:, 3:5]
    lower, extents = mesh.bounds[0, :2], mesh.extents[:2]
    cells = int(np.clip(np.sqrt(len(mesh.faces)), 1, 1024))
    while True:
        scale = np.where(extents > 0, cells / np.where(extents > 0, extents, 1), 0)
        first = _cell(low, lower, scale, cells)
        counts = _cell(high, lower, scale, cells) - first + 1
        total = int((counts[:, 0] * counts[:, 1]).sum())
        if cells == 1 or total <= _MOST_INCIDENCES * len(boxes) + 4096:
            break
        cells = max(cells // 2, 1)
    face, offset = expand(counts[:, 0] * counts[:, 1])
    column = first[face, 0] + offset // counts[face, 1]
    row = first[face, 1] + offset % counts[face, 1]
    cell = column * cells + row
    order = np.argsort(cell, kind="stable")
    return ColumnGrid(lower, scale, cells, group_starts(cell[order], cells * cells), face[order])


def contains_points(mesh: Mesh, points: Floats) -> Booleans:
    """Return whether points ``(n, 3)``, in the frame of the mesh, lie in the solid that the closed mesh bounds."""
    result = np.zeros(len(points), dtype=np.bool_)
    near = (points >= mesh.bounds[0]) & (points <= mesh.bounds[1])
    candidates = np.flatnonzero(near[:, 0] & near[:, 1] & near[:, 2])
    if not len(candidates):
        return result
    points = points[candidates]
    for part, owner, face in _faces_over(mesh, points):
        point = points[part][owner]
        above = _heights(mesh.derived(upright_faces).corners[face], point) > point[:, 2]
        crossings = np.bincount(owner[above], minlength=part.stop - part.start)
        result[candidates[part]] = crossings % 2 == 1
    return result


def contains_lattice(mesh: Mesh, x: Floats, y: Floats, z: Floats) -> Booleans:
    """The answers of `contains_points` for all combinations of coordinates, ``(len(x), len(y), len(z))``; much faster.

    Args:
        mesh: closed.
        x: coordinates, ``(k,)``.
        y: coordinates, ``(l,)``.
        z: ascending coordinates, ``(m,)``.

    """
    lowest = np.full(len(x) * len(y), -np.inf)
    points = np.stack([np.repeat(x, len(y)), np.tile(y, len(x)), lowest], axis=1)
    levels = len(z) + 1
    crossings = np.zeros((len(points), levels), dtype=np.intp)
    for part, owner, face in _faces_over(mesh, points):
        height = _heights(mesh.derived(upright_faces).corners[face], points[part][owner])
        hit_numbers = np.flatnonzero(height > -np.inf)
        # The number of lattice points below the crossing: those see it above them.
        level = np.searchsorted(z, height[hit_numbers])
        flat = np.bincount(owner[hit_numbers] * levels + level, minlength=(part.stop - part.start) * levels)
        crossings[part] += flat.reshape(-1, levels)
    above = np.cumsum(crossings[:, :0:-1], axis=1)[:, ::-1]
    result: Booleans = (above % 2 == 1).reshape(len(x), len(y), len(z))
    return result


def _faces_over(mesh: Mesh, points: Floats) -> Iterator[tuple[slice, Indices, Indices]]:
    """Pieces of the points, with pairs (point in the piece, face) that hold all faces above each point."""
    boxes = mesh.derived(upright_faces).boxes
    if len(points) * len(boxes) <= _FEW:
        owner, face = np.nonzero(_may_cross_above(boxes, points[:, np.newaxis]))
        yield slice(0, len(points)), owner, face
        return
    grid = mesh.derived(column_grid)
    cells = _cell(points[:, :2], grid.lower, grid.scale, grid.cells)
    cell = cells[:, 0] * grid.cells + cells[:, 1]
    counts = grid.starts[cell + 1] - grid.starts[cell]
    for part in pieces(counts, _CHUNK):
        owner, offset = expand(counts[part])
        face = grid.faces[grid.starts[cell[part]][owner] + offset]
        over = _may_cross_above(boxes[face], points[part][owner])
        yield part, owner[over], face[over]


def _cell(xy: Floats, lower: Floats, scale: Floats, cells: int) -> Indices:
    """The cell of each point; monotonic in the coordinates, so a face's range covers all points over it."""
    return np.clip(((xy - lower) * scale).astype(np.intp), 0, cells - 1)


def _may_cross_above(boxes: Floats, points: Floats) -> Booleans:
    """Return whether points ``(..., 3)`` lie below or in the columns of boxes ``(..., 6)``."""
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    low_x, low_y, _, high_x, high_y, high_z = boxes.T
    result: Booleans = (low_x <= x) & (x <= high_x) & (low_y <= y) & (y <= high_y) & (z <= high_z)
    return result


def _heights(corners: Floats, points: Floats) -> Floats:
    """Return the heights ``(m,)`` at which the vertical through each point ``(m, 3)`` crosses the face with
    ``corners`` ``(m, 3, 3)``.

    Minus infinity where it does not: the horizontal line y = py meets the projected edges in none or two points;
    the vertical crosses the face if px lies between them.
    """
    px, py = points[:, 0], points[:, 1]
    x = [corners[:, i, 0] for i in range(3)]
    y = [corners[:, i, 1] for i in range(3)]
    z = [corners[:, i, 2] for i in range(3)]
    north = [y_i > py for y_i in y]
    inside = np.zeros(len(points), dtype=np.bool_)
    # Of the two meeting points, the one to the right of the point and the one that is not.
    right_x, right_z = np.zeros(len(points)), np.zeros(len(points))
    left_x, left_z = np.zeros(len(points)), np.zeros(len(points))
    with np.errstate(divide="ignore", invalid="ignore"):
        for a, b in ((0, 1), (1, 2), (0, 2)):
            meets = north[a] != north[b]
            t = (py - y[a]) / (y[b] - y[a])
            edge_x = x[a] + t * (x[b] - x[a])
            edge_z = z[a] + t * (z[b] - z[a])
            right = meets & (edge_x > px)
            left = meets & ~right
            inside ^= right
            right_x, right_z = np.where(right, edge_x, right_x), np.where(right, edge_z, right_z)
            left_x, left_z = np.where(left, edge_x, left_x), np.where(left, edge_z, left_z)
        part = (px - left_x) / (right_x - left_x)
        height = left_z + part * (right_z - left_z)
    return np.where(inside, height, -np.inf)
