"""Bounds and inverse readings, without sampling, of "a region holds a body", "holds a point", "is so far".

A body lies in a region only if each of its extreme corners does. Intervals say where a corner, or a point, can be; it is
certainly outside where that box lies beside the box in which the region lies, or farther from the region than it is large.
"""

from collections.abc import Sequence
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph import intervals
from scenic.graph.bounds import Bounds, Floats
from scenic.graph.operations.inverse_readings import truth, where
from scenic.graph.operations.orientations import matrix, turned_by
from scenic.language.errors import UnsupportedError
from scenic.runtime.geometry.containment.body_containment import extreme_corners
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.regions.nearness import SLACK, grown, near, separation

if TYPE_CHECKING:
    from scenic.runtime.regions.base import Region
Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Containment:
    """Payload of the operation: the region, and the unit mesh of the body where that is fixed."""

    region: "Region"
    mesh: Mesh | None = field(
        compare=False
    )  # follows from the operands; bodies of different meshes are alike


def containment_bounds(payload: Containment, *operands: Bounds | None) -> Bounds | None:
    """Bound the truth of containment: false where a body is certainly outside.

    The operands are position, orientation, size, (shape,) and parameters.
    """
    reach, position = _reach(payload, operands), operands[0]
    container = payload.region.container_extent(*operands[4:])
    if reach is None or position is None or container is None:
        return None
    low = position.lower[:, np.newaxis] + reach.lower
    high = position.upper[:, np.newaxis] + reach.upper
    beside = (low > container.upper[:, np.newaxis] + SLACK) | (high < container.lower[:, np.newaxis] - SLACK)
    outside = np.asarray(beside.any(axis=(1, 2)))
    columns = fixed(operands[4:])
    if columns is not None:
        corners = Bounds(low.reshape(-1, 3), high.reshape(-1, 3))
        away = _is_away(payload.region, corners, columns, SLACK)
        outside = outside | away.reshape(low.shape[:2]).any(axis=1)
        outside = outside | _is_near_the_edge(payload, container, operands, columns)
    return truth(np.zeros_like(outside), outside)


def containment_inverse(
    payload: Containment, result: Bounds, *operands: Bounds | None
) -> Sequence[Bounds | None]:
    """Bound the position of a body for which containment is true."""
    nothing: list[Bounds | None] = [None] * len(operands)
    reach, container = _reach(payload, operands), payload.region.container_extent(*operands[4:])
    if reach is None or container is None:
        return nothing
    lower, upper = container.lower - SLACK, container.upper + SLACK
    new = Bounds(lower[:, np.newaxis] - reach.upper, upper[:, np.newaxis] - reach.lower)
    inradius = _inradius(payload, operands)[:, np.newaxis]
    least = np.maximum(new.lower.max(axis=1), lower + inradius)
    most = np.minimum(new.upper.min(axis=1), upper - inradius)
    return [where(result.lower > 0, Bounds(least, most)), *nothing[1:]]


def point_bounds(region: "Region", point: Bounds | None, *parameters: Bounds | None) -> Bounds | None:
    """Bound the truth of ``point in region``: false where the point is certainly outside."""
    container = region.container_extent(*parameters)
    if point is None or container is None:
        return None
    slack = SLACK + region.tolerance
    beside = (point.lower > container.upper + slack) | (point.upper < container.lower - slack)
    outside = np.asarray(beside.any(axis=1), dtype=np.bool_)
    columns = fixed(parameters)
    if columns is not None:
        outside = outside | _is_away(region, point, columns, slack)
    return truth(np.zeros_like(outside), outside)


def point_inverse(
    region: "Region", result: Bounds, _point: Bounds | None, *parameters: Bounds | None
) -> Sequence[Bounds | None]:
    """Bound the position of a point that lies in a region."""
    container = region.container_extent(*parameters)
    return [near(result, container, np.full(1, region.tolerance)), *(None for _ in parameters)]


def distance_bounds(region: "Region", point: Bounds | None, *parameters: Bounds | None) -> Bounds | None:
    """Bounds of the distance of a point from a region: that of its box from the region's, and what a distance can change within its box."""
    extent = region.extent(*parameters)
    if point is None:
        return None
    least = np.zeros(1) if extent is None else np.maximum(separation(point, extent), 0.0)
    bounds = Bounds(least, np.full_like(least, np.inf))
    centre, radius, is_definite = _ball(point)
    rows, columns = fixed_rows(parameters, len(centre))
    if columns is None:
        return bounds
    # Asked as often as there are places or regions, and only where both are known.
    boxes = max(len(centre), len(rows))
    is_definite, rows = np.broadcast_to(is_definite, boxes), np.broadcast_to(rows, boxes)
    boxes_to_measure = np.flatnonzero(is_definite & rows)
    if not len(boxes_to_measure):
        return bounds
    distances = np.zeros(boxes)
    try:
        distances[boxes_to_measure] = region.distances(
            _some(centre, boxes_to_measure), *(_some(part, boxes_to_measure) for part in columns)
        )
    except UnsupportedError:
        return bounds
    is_definite = is_definite & rows & np.isfinite(distances)
    margin = np.where(is_definite, radius + SLACK + 1e-9 * np.abs(distances), np.inf)
    return bounds.meet(
        Bounds(np.where(is_definite, distances, 0.0) - margin, np.where(is_definite, distances, 0.0) + margin)
    )


def distance_inverse(
    region: "Region", result: Bounds, _point: Bounds | None, *parameters: Bounds | None
) -> Sequence[Bounds | None]:
    """Bound the position of a point whose distance from a region is ``result``."""
    extent = region.extent(*parameters)
    place = None if extent is None else grown(extent, result.upper * (1 + 1e-9))
    return [place, *(None for _ in parameters)]


def _is_away(region: "Region", boxes: Bounds, columns: Sequence[Floats], slack: float) -> Mask:
    """Return a mask of the boxes ``(m, 3)`` whose centre is certainly farther from a container than any of
    their points is from the centre.
    """
    centre, radius, known = _ball(boxes)
    away: Mask = known & region.lie_farther(centre, radius + slack, *columns)
    return away


def _is_near_the_edge(
    payload: Containment, container: Bounds, operands: Sequence[Bounds | None], columns: Sequence[Floats]
) -> Mask:
    """Return a mask of the bodies that certainly cross the edge of a container, as their centre is less deep
    in it than the radius of the ball or disc that they contain.
    """
    position = operands[0]
    assert position is not None
    inradius = _inradius(payload, operands)
    if _is_column(container):
        z = np.array([False, False, True])
        position = Bounds(np.where(z, 0.0, position.lower), np.where(z, 0.0, position.upper))
        inradius = np.maximum(inradius, _inradius(payload, operands, upright=True))
    centre, radius, is_definite = _ball(position)
    spare = np.where(is_definite, inradius - radius - SLACK, 0.0)
    near: Mask = spare > 0  # A depth is not negative, and in large boxes that settles the answer.
    near_bodies = np.flatnonzero(near)
    if len(near_bodies):
        centres = np.broadcast_to(centre, (len(near), 3))[near_bodies]
        near[near_bodies] = payload.region.depths(centres, *columns) < spare[near_bodies]
    return near


def _is_column(container: Bounds) -> bool:
    """Return whether a container reaches to every height."""
    return bool(np.isinf(container.lower[:, 2]).all() and np.isinf(container.upper[:, 2]).all())


def _inradius(
    payload: Containment, operands: Sequence[Bounds | None], *, upright: bool = False
) -> NDArray[np.float64]:
    """Return the radius ``(m,)`` of a ball about the position that a body holds at least; 0 where nothing is known.

    If it is asked of what stands ``upright``, that of a disc seen from above; 0 where the body may be tilted.
    """
    orientation, size = operands[1:3]
    mesh = payload.mesh
    if mesh is None or orientation is None or size is None or not mesh.is_convex:
        return np.zeros(1)
    planes = mesh.hull.planes
    inner = max(0.0, float((-planes[:, 3] / np.sqrt((planes[:, :3] ** 2).sum(axis=1))).min()))
    axes = 2 if upright else 3
    radius: NDArray[np.float64] = np.maximum(size.lower[:, :axes].min(axis=1), 0.0) * (inner * (1 - 1e-9))
    if upright:
        tilt = np.maximum(np.abs(orientation.lower), np.abs(orientation.upper))[:, :2]
        radius = np.where((tilt == 0).all(axis=1), radius, 0.0)
    return radius


def _ball(boxes: Bounds) -> tuple[Floats, Floats, Mask]:
    """Return centres ``(m, 3)`` and radii ``(m,)`` of balls around boxes, and the mask of the boxes that are bounded."""
    centre, half = (boxes.lower + boxes.upper) / 2, (boxes.upper - boxes.lower) / 2
    radius = np.sqrt((half * half).sum(axis=1))
    known = np.isfinite(centre).all(axis=1) & np.isfinite(radius)
    return np.where(known[:, np.newaxis], centre, 0.0), radius, known


def _reach(payload: Containment, operands: Sequence[Bounds | None]) -> Bounds | None:
    """Return bounds ``(m, corners, 3)`` of the body's extreme corners relative to its position.

    Of a mesh that is not fixed nothing is known but that it is not empty; its centre need not be part of it.
    """
    orientation, size = operands[1:3]
    if orientation is None or size is None or payload.mesh is None:
        return None
    corners = extreme_corners(payload.mesh)
    count, boxes = len(corners), max(len(orientation.lower), len(size.lower))
    # A turn or a size that is the same in all boxes, as of most bodies, is worked out once.
    orientation, size = _once(orientation), _once(size)
    rows = max(len(orientation.lower), len(size.lower))

    def spread(bounds: Bounds) -> Bounds:
        shape = (rows, *bounds.lower.shape[1:])
        ends = (np.broadcast_to(end, shape) for end in (bounds.lower, bounds.upper))
        return Bounds(*(np.repeat(end, count, axis=0) for end in ends))

    points = np.tile(corners, (rows, 1))
    vectors = intervals.multiply(spread(size), Bounds(points, points))
    offsets = intervals.widened(turned_by(spread(matrix(orientation)), vectors), 1e-9)
    ends = (end.reshape(rows, count, 3) for end in (offsets.lower, offsets.upper))
    return Bounds(*(np.broadcast_to(end, (boxes, count, 3)) for end in ends))


def _once(bounds: Bounds) -> Bounds:
    """Return the first row of bounds of which all rows are the same; else the bounds."""
    ends = (bounds.lower, bounds.upper)
    if len(bounds.lower) > 1 and all((end == end[:1]).all() for end in ends):
        return Bounds(bounds.lower[:1], bounds.upper[:1])
    return bounds


def fixed(parameters: Sequence[Bounds | None]) -> list[Floats] | None:
    """Return the columns of parameters that have one value each in every box; ``None`` if some have not."""
    columns = []
    for bounds in parameters:
        if bounds is None or not (bounds.lower == bounds.upper).all():
            return None
        if len(bounds.lower) > 1 and not (bounds.lower == bounds.lower[:1]).all():
            return None
        columns.append(bounds.lower[:1])
    return columns


def fixed_rows(parameters: Sequence[Bounds | None], boxes: int) -> tuple[Mask, list[Floats] | None]:
    """Return a mask of the boxes ``(m | 1,)`` in which the parameters have one value each, and their columns there; no columns if in none of them."""
    is_fixed: Mask = np.ones(1, dtype=np.bool_)
    columns = []
    for bounds in parameters:
        if bounds is None:
            return np.zeros(boxes, dtype=np.bool_), None
        one = bounds.lower == bounds.upper
        is_fixed = is_fixed & (one if one.ndim == 1 else one.all(axis=1))
        columns.append(bounds.lower)
    return is_fixed, columns if is_fixed.any() else None


def _some(column: Floats, boxes: NDArray[np.intp]) -> Floats:
    return column if len(column) == 1 else column[boxes]
