"""What is known of containment without sampling: the bounds and inverse readings of "a region holds a body".

A body lies in a region only if each of its extreme corners does. Intervals say where a corner can be; it is certainly
outside where that box lies beside the region's bounding box, or farther from the region than it is large.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounds import Bounds, Floats
from scenic.graph.operations.narrowing import truth, where
from scenic.graph.operations.orientations import turned
from scenic.runtime.geometry.containment import extreme_corners
from scenic.runtime.geometry.mesh import Mesh

if TYPE_CHECKING:
    from scenic.runtime.regions.base import Region

_SLACK: Final = 1e-6
"""Metres by which containment is read generously: more than its tolerance and all rounding."""


@dataclass(frozen=True, slots=True)
class Containment:
    """Payload of the operation: the region, and the unit mesh of the body where that is fixed."""

    region: "Region"
    mesh: Mesh | None = field(
        compare=False
    )  # follows from the operands; bodies of different meshes are alike


def containment_bounds(payload: Containment, *operands: Bounds | None) -> Bounds | None:
    """Where a body is certainly outside, from bounds of position, orientation, size, (shape,) and parameters."""
    reach, position = _reach(payload, operands), operands[0]
    fixed = _fixed(operands[4:])
    if reach is None or position is None or fixed is None:
        return None
    low = position.lower[:, np.newaxis] + reach.lower
    high = position.upper[:, np.newaxis] + reach.upper
    lower, upper = payload.region.container_box(*fixed)
    outside = ((low > upper + _SLACK) | (high < lower - _SLACK)).any(axis=(1, 2))
    centre, half = (low + high) / 2, (high - low) / 2
    radius = np.sqrt((half * half).sum(axis=2))
    known = np.isfinite(centre).all(axis=2) & np.isfinite(radius)
    points = np.where(known[..., np.newaxis], centre, 0.0)
    gaps = payload.region.gaps(points.reshape(-1, 3), *fixed).reshape(radius.shape)
    outside = outside | (known & (gaps > radius + _SLACK)).any(axis=1)
    return truth(np.zeros_like(outside), outside)


def containment_inverse(
    payload: Containment, result: Bounds, *operands: Bounds | None
) -> Sequence[Bounds | None]:
    """Where the centre of a body that is inside can be."""
    nothing: list[Bounds | None] = [None] * len(operands)
    reach, fixed = _reach(payload, operands), _fixed(operands[4:])
    if reach is None or fixed is None:
        return nothing
    lower, upper = payload.region.container_box(*fixed)
    new = Bounds((lower - _SLACK)[:, np.newaxis] - reach.upper, (upper + _SLACK)[:, np.newaxis] - reach.lower)
    return [where(result.lower > 0, Bounds(new.lower.max(axis=1), new.upper.min(axis=1))), *nothing[1:]]


def payload_box(region: "Region", parameters: Sequence[Bounds | None]) -> Bounds | None:
    """Bounds of a point of a region from those of its parameters; known only where these are fixed."""
    fixed = _fixed(parameters)
    if fixed is None:
        return None
    lower, upper = region.box(*fixed)
    return Bounds(lower - _SLACK, upper + _SLACK)


def _reach(payload: Containment, operands: Sequence[Bounds | None]) -> Bounds | None:
    """Where the body's extreme corners are, seen from its position: bounds ``(m, corners, 3)``.

    Of a mesh that is not fixed nothing is known but that it is not empty; its centre need not be part of it.
    """
    orientation, size = operands[1:3]
    if orientation is None or size is None or payload.mesh is None:
        return None
    corners = extreme_corners(payload.mesh)
    count, boxes = len(corners), max(len(orientation.lower), len(size.lower))

    def spread(bounds: Bounds) -> Bounds:
        shape = (boxes, *bounds.lower.shape[1:])
        ends = (np.broadcast_to(end, shape) for end in (bounds.lower, bounds.upper))
        return Bounds(*(np.repeat(end, count, axis=0) for end in ends))

    points = np.tile(corners, (boxes, 1))
    offsets = intervals.widened(
        turned(spread(orientation), intervals.multiply(spread(size), Bounds(points, points))), 1e-9
    )
    return Bounds(offsets.lower.reshape(boxes, count, 3), offsets.upper.reshape(boxes, count, 3))


def _fixed(parameters: Sequence[Bounds | None]) -> list[Floats] | None:
    """The columns of parameters that have one value each in every box; ``None`` if some have not."""
    columns = []
    for bounds in parameters:
        if bounds is None or not (bounds.lower == bounds.upper).all():
            return None
        if len(bounds.lower) > 1 and not (bounds.lower == bounds.lower[:1]).all():
            return None
        columns.append(bounds.lower[:1])
    return columns
