"""By how much a condition holds: the atoms of quantitative robustness (`scenic.runtime.temporal.robustness`).

A margin is in the unit of what is compared (radians for directions), positive where the condition holds and negative where it does not. It is infinite
where there is nothing to measure: for an equality that holds, or inside something of which no depth is known. What is seen is
measured by shares and angles (`scenic.runtime.regions.visibility_margins`).
"""

import math
from collections.abc import Sequence

import numpy as np

from scenic.graph.quaternions import normal_angle
from scenic.language.errors import ScenicError
from scenic.runtime.geometry.contact.depth import convex_depth
from scenic.runtime.geometry.contact.scalar_bodies import overlap
from scenic.runtime.geometry.poses import Floats
from scenic.runtime.ground.context import current
from scenic.runtime.instances.objects import Object, OrientedPoint, Point
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.body_regions import gap_between
from scenic.runtime.regions.planar import PlanarRegion
from scenic.runtime.regions.stacked import placed_of
from scenic.runtime.regions.visibility_margins import clearance
from scenic.runtime.regions.visibility_nodes import sees
from scenic.runtime.values.directions import DIRECTIONS
from scenic.runtime.values.values import Vector, is_number, is_vector, to_vector

__all__ = ["margin"]


def margin(symbols: Sequence[str], operands: Sequence[object]) -> float | None:
    """Return the least margin of ``a SYMBOL b SYMBOL c ...``; ``None`` where one of the parts has none.

    Args:
        symbols: comparisons, ``in``, ``not in``, ``intersects``, ``can see`` or a direction such as ``is ahead of``.
        operands: one more than symbols.

    """
    least = math.inf
    for symbol, left, right in zip(symbols, operands, operands[1:], strict=False):
        part = _part(symbol, left, right)
        if part is None:
            return None
        least = min(least, part)
    return least


def _part(symbol: str, left: object, right: object) -> float | None:
    match symbol:
        case "<" | "<=" | ">" | ">=":
            if not (is_number(left) and is_number(right)):
                return None
            return float(right - left if symbol.startswith("<") else left - right)
        case "==":
            return _equality(left, right)
        case "in":
            return _membership(left, right)
        case "intersects":
            return _overlap(left, right)
        case "can see":
            return _sight(left, right)
        case "is ahead of" | "is behind" | "is left of" | "is right of":
            return _direction(symbol.removeprefix("is "), left, right)
        case _:
            opposite = _part("==" if symbol == "!=" else "in", left, right)
            return None if opposite is None else -opposite


def _equality(left: object, right: object) -> float | None:
    if is_number(left) and is_number(right):
        apart = abs(float(left - right))
    elif (isinstance(left, Vector) and is_vector(right)) or (is_vector(left) and isinstance(right, Vector)):
        apart = (to_vector(left) - to_vector(right)).norm()
    else:
        return None
    return -apart if apart else math.inf


def _direction(words: str, place: object, base: object) -> float | None:
    """Return the angle, in radians, by which the base could turn before the place leaves the direction."""
    if not isinstance(base, OrientedPoint):
        return None
    bearing = normal_angle(base.position.azimuthTo(to_vector(place)) - base.heading)
    return DIRECTIONS[words].margin(bearing)


def _membership(item: object, region: object) -> float | None:
    """The signed distance of a point, or of the corner of an object that is least inside."""
    if not isinstance(region, Region):
        return None
    try:
        if isinstance(item, Object):
            return _clearance(item, region)
        if is_vector(item) or isinstance(item, Point):
            return _signed_distance(to_vector(item), region)
    except ScenicError:  # some regions know no distances
        return None
    return None


def _clearance(item: Object, region: Region) -> float:
    corners = _corners(item)
    if region.containsObject(item):
        return max(0.0, float(_depths(corners, region).min()))
    # It may stick out between its corners, over a hole; then it is not known by how much.
    outside = float(_distances(corners, region).max())
    return -outside if outside > 0 else -math.inf


def _corners(item: Object) -> Floats:
    """Return the corners of the convex hull of an object, ``(n, 3)``."""
    body = placed_of(item)
    return np.array(item.corners) if body is None else body.hull()


def _signed_distance(point: Vector, region: Region) -> float:
    place = np.array([point.row])
    (distance,) = _depths(place, region) if region.containsPoint(point) else -_distances(place, region)
    return float(distance)


def _distances(points: Floats, region: Region) -> Floats:
    """Return the distances ``(n,)`` of points ``(n, 3)`` from the region, in metres.

    A region of the plane is seen from above, as it is for containment.
    """
    if isinstance(region, PlanarRegion):
        points = np.column_stack([points[:, :2], np.full(len(points), float(region.z))])
    return region.distances(points, *region.fixed_columns("the distance"))


def _depths(points: Floats, region: Region) -> Floats:
    """Return the distances ``(n,)`` of points ``(n, 3)`` in the region from its boundary, in metres."""
    if isinstance(region, PlanarRegion):
        # Its outline is a line of the ground, whatever the height of the region is.
        ground: Floats = region.boundary.distances(np.column_stack([points[:, :2], np.zeros(len(points))]))
        return ground
    surface = getattr(region, "getSurfaceRegion", None)
    return np.full(len(points), math.inf) if surface is None else _distances(points, surface())


def _overlap(left: object, right: object) -> float | None:
    """Return the depth, in metres, to which two objects overlap, or the gap between them as a negative
    number.

    The depth of concave shapes is unknown and counts as infinite; values other than objects give ``None``.
    """
    if not (isinstance(left, Object) and isinstance(right, Object)):
        return None
    if not left.intersects(right):
        return -float(gap_between(left, right))
    one, other = placed_of(left), placed_of(right)
    if one is None or other is None:
        return math.inf
    if one.mesh.is_box and other.mesh.is_box:
        return overlap(one, other)
    if one.mesh.is_convex and other.mesh.is_convex:
        return convex_depth(one.hull(), other.hull())
    return math.inf


def _sight(observer: object, target: object) -> float | None:
    """Return by how much an observer sees a point or an object past those of the simulation; unknown in the plane."""
    context = current.get()
    if context is None or context.mode_2d:
        return None
    occluders = context.present
    return clearance(observer, target, occluders, seen=bool(sees(observer, target, occluders)))
