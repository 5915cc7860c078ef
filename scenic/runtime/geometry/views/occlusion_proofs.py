"""Proofs that a target is hidden, or seen, without casting all rays.

What hides is convex: a whole occluder, or a box inside it. Seen from the camera, the points behind a convex body K
(those p for which the way to p meets K) are a convex set: if p' = s p + (1 - s) q, the way to p' meets a convex
combination of the points of K on the ways to p and q. So a box is hidden when its corners are, all by the same K.
"""

from typing import Final

import numpy as np

from scenic.runtime.geometry.meshes.inside import contains_points
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.voxels import RESOLUTION, voxels
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.views.hits import SeenBodies
from scenic.runtime.geometry.views.occluders import Obstacles

_MARGIN: Final = 1e-9
"""Share of the distance by which an occluder must be nearer than the target, so that rounding cannot fake a proof."""

_MOST_BOXES: Final = 12
"""Boxes put into a solid that is not convex."""

_LEAST_CELLS: Final = 64
"""Cells that a box in a solid needs to be worth its tests."""


def boxes_hidden(corners: Floats, obstacles: Obstacles) -> Booleans:
    """Return whether one occluder is proved to hide boxes with corners ``(n, 8, 3)`` in the views' frames, ``(n,)``."""
    hidden = np.zeros(len(corners), dtype=np.bool_)
    limits = np.ones((len(corners), 8))
    for number, near in enumerate(obstacles.lanes):
        chosen = np.flatnonzero(near & ~hidden)
        if len(chosen):
            hidden[chosen] = shadowed(obstacles.placed(number), chosen, corners[chosen], limits[chosen])
    return hidden


def shadowed(placed: SeenBodies, lanes: Indices, directions: Floats, limits: Floats) -> Booleans:
    """Return whether one convex part of a body is met by all rays of each lane before their limits, ``(m,)``.

    Args:
        placed: the body.
        lanes: the lanes, ``(m,)``.
        directions: of the rays from each lane's camera, ``(m, k, 3)``, in the frame of the view.
        limits: in lengths of the directions, ``(m, k)``.

    """
    count, rays = limits.shape
    owner = np.repeat(lanes, rays)
    flat, most = directions.reshape(-1, 3), limits.ravel() * (1 - _MARGIN)
    result = np.zeros(count, dtype=np.bool_)
    mesh = placed.mesh[lanes]
    for number, form in enumerate(placed.meshes):
        lanes_of_mesh = np.flatnonzero(mesh == number)
        if not len(lanes_of_mesh):
            continue
        outside = ~_inside(form, placed.origin[lanes[lanes_of_mesh]])
        lanes_of_mesh = lanes_of_mesh[outside]
        pick = (lanes_of_mesh[:, None] * rays + np.arange(rays)).ravel()
        if form.is_convex:
            blocks = placed.first(owner[pick], flat[pick], exact=True) <= most[pick]
            result[lanes_of_mesh] = blocks.reshape(-1, rays).all(axis=1)
            continue
        origins, local_directions = placed.rays(owner[pick], flat[pick])
        for low, high in form.derived(inner_boxes):
            blocks = _meets_box(origins, local_directions, low, high, most[pick])
            result[lanes_of_mesh] |= blocks.reshape(-1, rays).all(axis=1)
    return result


def _inside(mesh: Mesh, origins: Floats) -> Booleans:
    """Return whether points in the unit frame are in the solid, ``(n,)``; its rays need not meet the surface then."""
    result = np.asarray((np.abs(origins) <= 0.5 + _MARGIN).all(axis=1))
    if not mesh.is_box:
        near = np.flatnonzero(result)
        result[near] = contains_points(mesh, origins[near])
    return result


def _meets_box(origins: Floats, directions: Floats, low: Floats, high: Floats, limits: Floats) -> Booleans:
    """Return whether rays enter a box of the unit frame ahead of their origins and before their limits, ``(r,)``."""
    near, far = np.full(len(origins), -np.inf), np.full(len(origins), np.inf)
    with np.errstate(over="ignore"):
        for axis in range(3):
            way = directions[:, axis]
            inverse = 1 / np.where(np.abs(way) < 1e-300, 1e-300, way)
            first, last = (low[axis] - origins[:, axis]) * inverse, (high[axis] - origins[:, axis]) * inverse
            np.maximum(near, np.minimum(first, last), out=near)
            np.minimum(far, np.maximum(first, last), out=far)
    result: Booleans = (near > 0) & (near < far) & (near <= limits)
    return result


def inner_boxes(mesh: Mesh) -> Floats:
    """Return boxes inside a closed unit mesh, ``(k, 2, 3)``, large ones first; callers get them as ``mesh.derived(inner_boxes)``.

    Each box grows from the deepest cell outside the earlier boxes, a layer at a time, while it stays in solid cells.
    """
    from scipy.ndimage import distance_transform_cdt

    solid = voxels(mesh).solid
    depth = distance_transform_cdt(np.pad(solid, 1), metric="chessboard")[1:-1, 1:-1, 1:-1]
    open_cells = np.array(depth)
    sums = np.zeros((RESOLUTION + 1,) * 3, dtype=np.int64)
    sums[1:, 1:, 1:] = solid.cumsum(axis=0).cumsum(axis=1).cumsum(axis=2)
    boxes: list[tuple[Indices, Indices]] = []
    while len(boxes) < _MOST_BOXES and open_cells.max() > 0:
        seed = np.array(np.unravel_index(int(np.argmax(open_cells)), solid.shape))
        low, high = seed - (depth[tuple(seed)] - 1), seed + depth[tuple(seed)]
        low, high = _grown(sums, low, high)
        open_cells[low[0] : high[0], low[1] : high[1], low[2] : high[2]] = 0
        if np.prod(high - low) >= _LEAST_CELLS:
            boxes.append((low, high))
    boxes.sort(key=lambda box: -int(np.prod(box[1] - box[0])))
    return np.array(boxes, dtype=np.float64).reshape(-1, 2, 3) / RESOLUTION - 0.5


def _grown(sums: Indices, low: Indices, high: Indices) -> tuple[Indices, Indices]:
    """A box of cells made larger in turn on each of its sides while all its cells are solid."""
    grows = True
    while grows:
        grows = False
        for axis in range(3):
            for side, step in ((low, -1), (high, 1)):
                side[axis] += step
                if 0 <= side[axis] <= RESOLUTION and _filled(sums, low, high):
                    grows = True
                else:
                    side[axis] -= step
    return low, high


def _filled(sums: Indices, low: Indices, high: Indices) -> bool:
    (a, b, c), (x, y, z) = low, high
    total = (
        sums[x, y, z] - sums[a, y, z] - sums[x, b, z] - sums[x, y, c]
        + sums[a, b, z] + sums[a, y, c] + sums[x, b, c] - sums[a, b, c]
    )  # fmt: skip
    return bool(total == (x - a) * (y - b) * (z - c))
