"""A coarse picture of a solid in its unit cube: cells that are solid, empty, or cut by the surface.

Solid cells prove collisions and empty ones prove that there is none, whatever the size and pose of the mesh.
Where cells are cut, nothing is proved.
"""

from typing import Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.cells import touched_cells
from scenic.runtime.geometry.meshes.inside import contains_lattice, contains_points
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats
from scenic.runtime.geometry.store import Arrays, is_kept, kept

RESOLUTION: Final = 64

COVER_BOXES: Final = 16
_COVER_RESOLUTION: Final = 32
_COVER_WASTE: Final = 0.002
"""Part of the whole that a box of the cover may hold in empty cells without being cut further."""

INTERIOR_POINTS: Final = 16
PROBES: Final = 64
"""Points of a solid that are looked for in another one: some inside, the others on its surface."""

_KIND: Final = f"voxels 2, {RESOLUTION}"
"""Names what is kept of a mesh."""

_CANDIDATES: Final = 4096
"""Cells among which interior points are chosen, at most."""


@dataclass(frozen=True, slots=True)
class Voxels:
    """Facts about the cells of a mesh.

    Attributes:
        solid: whether a cell lies wholly inside, ``(r, r, r)``.
        filled: number of non-empty cells with smaller index on every axis, ``(r + 1, r + 1, r + 1)``.
        cover: boxes that together hold the whole solid, ``(k, 2, 3)`` lower and upper corners.
        probes: points of the solid, ``(PROBES, 3)``: first up to `INTERIOR_POINTS` inside it, spread out and
            deep, then points of its surface; the first ones of these are spread over it as all are.

    """

    solid: Booleans
    filled: npt.NDArray[np.int32]
    cover: Floats
    probes: Floats


def voxels(mesh: Mesh) -> Voxels:
    """Return the cells of a closed unit mesh. Get them as ``mesh.derived(voxels)``."""
    if mesh.is_box:
        return _box_voxels(mesh)
    found = kept(_KIND, mesh.digest, lambda: _computed(mesh))
    solid, occupied = (_unpacked(found[name]) for name in ("solid", "occupied"))
    return Voxels(solid, _counts(occupied), found["cover"], found["probes"])


def _counts(occupied: Booleans) -> npt.NDArray[np.int32]:
    """Return, for each corner of the grid, the number of occupied cells with smaller index on every axis, as
    in `Voxels.filled`.
    """
    # Whole slabs are added: `cumsum` takes three times as long. A row holds few enough cells for one byte.
    rows = np.ascontiguousarray(occupied.transpose(2, 0, 1)).view(np.uint8)
    for index in range(1, RESOLUTION):
        rows[index] += rows[index - 1]
    counts = np.zeros((RESOLUTION + 1,) * 3, dtype=np.int32)
    counts[1:, 1:, 1:] = rows.transpose(1, 2, 0)
    for index in range(2, RESOLUTION + 1):
        counts[:, index] += counts[:, index - 1]
    for index in range(2, RESOLUTION + 1):
        counts[index] += counts[index - 1]
    return counts


def seconds_to_make(mesh: Mesh) -> float:
    """Estimate how many seconds `voxels` will take: next to nothing where an earlier run stored its result."""
    if mesh.is_box or is_kept(_KIND, mesh.digest):
        return 0.0
    return 0.04 + 4e-6 * len(mesh.faces)


def _unpacked(bits: npt.NDArray[np.uint8]) -> Booleans:
    return np.unpackbits(bits).view(np.bool_).reshape((RESOLUTION,) * 3)


def _computed(mesh: Mesh) -> Arrays:
    """Compute the arrays that `voxels` stores for a mesh, the cells packed as bits."""
    surface_cells = np.zeros(RESOLUTION**3, dtype=np.bool_)
    for _, cell in touched_cells(mesh.triangles, RESOLUTION):
        surface_cells[cell] = True
    cut = surface_cells.reshape(RESOLUTION, RESOLUTION, RESOLUTION)
    axis = (np.arange(RESOLUTION) + 0.5) / RESOLUTION - 0.5
    inside = contains_lattice(mesh, axis, axis, axis)
    solid = inside & ~cut
    return {
        "solid": np.packbits(solid),
        "occupied": np.packbits(solid | cut),
        "cover": _cover(solid | cut),
        "probes": _probes(mesh, _interior(mesh, inside, solid, axis)),
    }


def _box_voxels(mesh: Mesh) -> Voxels:
    """Return the voxels of a box: all cells are solid, including those at its surface."""
    solid = np.ones((RESOLUTION,) * 3, dtype=np.bool_)
    steps = np.arange(RESOLUTION + 1, dtype=np.int32)
    filled = steps[:, None, None] * steps[:, None] * steps
    near = [-0.45, 0.0, 0.45]
    points = np.array([(x, y, z) for x in near for y in near for z in near])
    corners_faces_centre = np.isin((points != 0).sum(axis=1), (0, 1, 3))
    whole = np.array([[[-0.5] * 3, [0.5] * 3]])
    return Voxels(solid, filled, whole, _probes(mesh, points[corners_faces_centre]))


def _cover(occupied: Booleans) -> Floats:
    """Return boxes around the occupied cells: the box that contains most empty cells is cut in two, repeatedly."""
    # Coarser cells do for this, and are eight times fewer.
    blocks = occupied.reshape(*(_COVER_RESOLUTION, RESOLUTION // _COVER_RESOLUTION) * 3)
    occupied = np.asarray(np.logical_or.reduce(blocks, axis=(1, 3, 5)))
    whole = _tight(occupied, (0, 0, 0))
    boxes = [whole]
    while len(boxes) < COVER_BOXES:
        waste = [int(part.size - np.count_nonzero(part)) for part, _ in boxes]
        worst = int(np.argmax(waste))
        if waste[worst] < _COVER_WASTE * whole[0].size:
            break
        part, corner = boxes.pop(worst)
        axis, at = _best_cut(part)
        below, above = np.split(part, [at], axis=axis)
        offset = [at if i == axis else 0 for i in range(3)]
        boxes.append(_tight(below, corner))
        boxes.append(_tight(above, (corner[0] + offset[0], corner[1] + offset[1], corner[2] + offset[2])))
    corners = np.array([corner for _, corner in boxes])
    sizes = np.array([part.shape for part, _ in boxes])
    return np.stack([corners, corners + sizes], axis=1) / _COVER_RESOLUTION - 0.5


def _tight(part: Booleans, corner: tuple[int, int, int]) -> tuple[Booleans, tuple[int, int, int]]:
    """Return the occupied part of a box of cells whose first cell is ``corner``, and the first cell of that."""
    spans = []
    for axis in range(3):
        used = np.flatnonzero(part.any(axis=tuple({0, 1, 2} - {axis})))
        spans.append(slice(int(used[0]), int(used[-1]) + 1))
    x, y, z = spans
    return part[x, y, z], (corner[0] + x.start, corner[1] + y.start, corner[2] + z.start)


def _best_cut(part: Booleans) -> tuple[int, int]:
    """The axis and place of the cut that leaves the least volume in the tight boxes of the two sides.

    Where no cut leaves less than the whole, as in a ring, it is the middle of the longest axis.
    """
    longest = int(np.argmax(part.shape))
    best = (part.size, longest, part.shape[longest] // 2)
    for axis in range(3):
        slices = np.moveaxis(part, axis, 0)
        before = _volumes_up_to(slices)[:-1]
        after = _volumes_up_to(slices[::-1])[::-1][1:]
        if len(before):
            at = int(np.argmin(before + after))
            if before[at] + after[at] < best[0]:
                best = (int(before[at] + after[at]), axis, at + 1)
    return best[1], best[2]


def _volumes_up_to(part: Booleans) -> npt.NDArray[np.intp]:
    """Return the volume of the tight box around the first 1, 2, ... slices."""
    slices = np.arange(1, len(part) + 1)
    volume: npt.NDArray[np.intp] = np.maximum.accumulate(np.where(part.any(axis=(1, 2)), slices, 0))
    for other in (1, 2):
        shadow = np.logical_or.reduce(part, axis=3 - other)
        width = shadow.shape[1]
        is_occupied = shadow.any(axis=1)
        low = np.minimum.accumulate(np.where(is_occupied, shadow.argmax(axis=1), width))
        high = np.maximum.accumulate(np.where(is_occupied, width - shadow[:, ::-1].argmax(axis=1), 0))
        volume = volume * np.maximum(high - low, 0)
    return volume


def _interior(mesh: Mesh, inside: Booleans, solid: Booleans, axis: Floats) -> Floats:
    """Points inside, each far from those before it and from the surface."""
    cells = np.flatnonzero(inside)
    cells = cells[:: len(cells) // _CANDIDATES + 1]
    x, y, z = np.unravel_index(cells, inside.shape)
    points, depths = np.stack([axis[x], axis[y], axis[z]], axis=1), _depths(solid)[x, y, z] + 0.25
    if not len(points):
        # All of the solid is thinner than the cells: the middles of its faces, moved inwards where that works.
        step = 1e-3 * mesh.normals
        points = mesh.triangles.mean(axis=1) - step
        points = points[contains_points(mesh, points)]
        depths = np.ones(len(points))
    point_numbers: list[int] = []
    distance = np.full(len(points), 1.0)
    while len(point_numbers) < min(INTERIOR_POINTS, len(points)):
        best = int(np.argmax(distance * np.sqrt(depths)))
        if distance[best] == 0:
            break
        point_numbers.append(best)
        offset = points - points[best]
        distance = np.minimum(distance, np.sqrt((offset * offset).sum(axis=1)))
    return np.ascontiguousarray(points[point_numbers])


def _depths(solid: Booleans) -> npt.NDArray[np.float64]:
    """Return, for each solid cell, the number of times the solid can be peeled before the cell is gone."""
    result = np.zeros(solid.shape)
    left = np.pad(solid, 1)
    while left.any():
        result += left[1:-1, 1:-1, 1:-1]
        core = left.copy()
        for axis in range(3):
            core &= np.roll(left, 1, axis) & np.roll(left, -1, axis)
        left = core
    return result


def _probes(mesh: Mesh, interior: Floats) -> Floats:
    """The interior points, then points of the surface, spread by area."""
    count = PROBES - len(interior)
    # The order of bits reversed spreads every beginning of the sequence over the whole.
    bits = PROBES.bit_length() - 1
    order = np.array([int(f"{number:0{bits}b}"[::-1], 2) for number in range(PROBES)])
    place = (order[order < count] + 0.5) / count
    areas = np.cumsum(mesh.areas)
    face = np.minimum(np.searchsorted(areas, place * areas[-1]), len(areas) - 1)
    # Steps by the two numbers of the plastic ratio fill the square evenly (Roberts, 2018).
    number = np.arange(1, count + 1)
    along, across = number * 0.7548776662466927 % 1, number * 0.5698402909980532 % 1
    root = np.sqrt(along)[:, None]
    a, b, c = (mesh.triangles[face, corner] for corner in range(3))
    surface = (1 - root) * a + root * ((1 - across)[:, None] * b + across[:, None] * c)
    return np.concatenate([interior, surface])
