"""Convex polytopes over lanes, as half-spaces: whether something is left of them, and how far it is.

A half-space is a row (a, b, c, d) with a unit normal; inside means ``a x + b y + c z + d <= 0``. A polytope that is bounded and
not empty has an edge, and that lies on the line of two of its planes. So what is left of the line of each pair of planes
within all others says everything: nothing is left of any where the polytope is empty, the ends of what is left are its
vertices, and the nearest point of a polytope is the foot on a plane or the nearest point of an edge.
"""

from typing import Final, NamedTuple

import numpy as np

from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Poses
from scenic.runtime.geometry.ragged import rows
from scenic.runtime.geometry.vectors import cross, dot

MOST_PLANES: Final = 32
"""Planes up to which a solid is treated as a polytope."""

_SLACK: Final = 1e-9
"""Metres by which a point may lie outside a half-space, for rounding."""

_PARALLEL: Final = 1e-12
"""Square of the sine below which two planes count as parallel."""

_CHUNK: Final = 1 << 18
"""Combinations of lane, line and plane looked at together."""


class Edges(NamedTuple):
    """The rest of the lines of pairs of planes: ends ``(n, e, 3)``, and where something is left, ``(n, e)``."""

    starts: Floats
    ends: Floats
    valid: Booleans


def half_spaces(mesh: Mesh, poses: Poses) -> Floats | None:
    """Return the half-spaces ``(n | 1, k, 4)`` of a placed convex mesh; ``None`` of one that is not convex, or has many faces."""
    if not mesh.is_convex or len(mesh.hull.planes) > MOST_PLANES:
        return None
    planes = mesh.hull.planes
    normals = planes[np.newaxis, :, :3] / poses.size[:, np.newaxis]
    length = np.sqrt(dot(normals, normals))
    normals = normals / length[..., np.newaxis]
    offset = planes[np.newaxis, :, 3] / length
    x, y, z = normals[..., 0], normals[..., 1], normals[..., 2]
    matrix = poses.matrix[:, np.newaxis]
    normal = np.stack(
        [matrix[..., i, 0] * x + matrix[..., i, 1] * y + matrix[..., i, 2] * z for i in range(3)], axis=-1
    )
    level = offset - dot(normal, poses.position[:, np.newaxis])
    normal = np.broadcast_to(normal, (*level.shape, 3))
    return np.concatenate([normal, level[..., np.newaxis]], axis=-1)


def joined(*parts: Floats) -> Floats:
    """Return the half-spaces ``(n | 1, k, 4)`` of the intersection of polytopes."""
    lanes = max(map(len, parts))
    return np.concatenate([np.broadcast_to(part, (lanes, *part.shape[1:])) for part in parts], axis=1)


def edges(planes: Floats) -> Edges:
    """The rest of the lines of all pairs of planes ``(n, k, 4)`` within all half-spaces."""
    count = planes.shape[1]
    first, second = np.triu_indices(count, 1)
    shape = (len(planes), len(first))
    starts, ends = np.zeros((*shape, 3)), np.zeros((*shape, 3))
    valid = np.zeros(shape, dtype=np.bool_)
    for some in rows(len(planes), len(first) * count, _CHUNK):
        part = planes[some]
        starts[some], ends[some], valid[some] = _clipped(part, part[:, first], part[:, second])
    return Edges(starts, ends, valid)


def _clipped(planes: Floats, one: Floats, two: Floats) -> Edges:
    n, m = one[..., :3], two[..., :3]
    along = cross(n, m)
    square = dot(along, along)
    proper = square > _PARALLEL
    safe = np.where(proper, square, 1.0)
    along = along / np.sqrt(safe)[..., np.newaxis]
    # The point of both planes that is nearest to the origin.
    turn = dot(n, m)
    a = (-one[..., 3] + two[..., 3] * turn) / safe
    b = (-two[..., 3] + one[..., 3] * turn) / safe
    base = a[..., np.newaxis] * n + b[..., np.newaxis] * m
    low, high = np.full(square.shape, -np.inf), np.full(square.shape, np.inf)
    for number in range(planes.shape[1]):
        plane = planes[:, number, np.newaxis]
        rate = dot(along, plane[..., :3])
        height = dot(base, plane[..., :3]) + plane[..., 3] - _SLACK
        moves = np.abs(rate) > _PARALLEL
        at = -height / np.where(moves, rate, 1.0)
        high = np.where(moves & (rate > 0), np.minimum(high, at), high)
        low = np.where(moves & (rate < 0), np.maximum(low, at), low)
        high = np.where(~moves & (height > 0), -np.inf, high)
    valid = proper & (low <= high) & np.isfinite(low) & np.isfinite(high)
    low, high = (np.where(valid, end, 0.0)[..., np.newaxis] for end in (low, high))
    return Edges(base + low * along, base + high * along, valid)


def hold(planes: Floats, points: Floats) -> Booleans:
    """The mask of points ``(n, m, 3)`` that lie in all half-spaces ``(n | 1, k, 4)``, up to rounding."""
    inside = np.ones(points.shape[:2], dtype=np.bool_)
    for number in range(planes.shape[1]):
        plane = planes[:, number, np.newaxis]
        inside &= dot(points, plane[..., :3]) + plane[..., 3] <= 2 * _SLACK
    return inside


def distances(planes: Floats, points: Floats) -> Floats:
    """Distances ``(n,)`` of points ``(n, 3)`` from polytopes ``(n, k, 4)``; infinite where a polytope is empty."""
    found = edges(planes)
    nearest = _on_segments(found, points)
    height = dot(points[:, np.newaxis], planes[..., :3]) + planes[..., 3]
    feet = points[:, np.newaxis] - height[..., np.newaxis] * planes[..., :3]
    away = np.where(hold(planes, feet), np.abs(height), np.inf)
    away[hold(planes, points[:, np.newaxis])[:, 0]] = 0.0
    least: Floats = np.minimum(nearest.min(axis=1), away.min(axis=1))
    return least


def distances_without_ball(planes: Floats, centre: Floats, radius: Floats, points: Floats) -> Floats:
    """Distances ``(n,)`` of points ``(n, 3)`` from polytopes without balls with these centres ``(n, 3)`` and radii ``(n,)``.

    The nearest point is the point itself, or lies on a plane, an edge, the sphere, the circle where a plane cuts it, or
    where an edge does.
    """
    reach = radius[:, np.newaxis]
    candidates = [points[:, np.newaxis]]
    height = dot(points[:, np.newaxis], planes[..., :3]) + planes[..., 3]
    candidates.append(points[:, np.newaxis] - height[..., np.newaxis] * planes[..., :3])
    candidates.append(centre[:, np.newaxis] + reach[..., np.newaxis] * _unit(points - centre)[:, np.newaxis])
    depth = dot(centre[:, np.newaxis], planes[..., :3]) + planes[..., 3]
    middle = centre[:, np.newaxis] - depth[..., np.newaxis] * planes[..., :3]
    circle = np.sqrt(np.maximum(reach**2 - depth**2, 0.0))
    candidates.append(middle + circle[..., np.newaxis] * _unit(candidates[1] - middle))
    segments = edges(planes)
    along = segments.ends - segments.starts
    square = np.maximum(dot(along, along), 1e-300)
    foot = np.clip(dot(points[:, np.newaxis] - segments.starts, along) / square, 0, 1)
    candidates.append(segments.starts + foot[..., np.newaxis] * along)
    to_centre = segments.starts - centre[:, np.newaxis]
    half, rest = dot(to_centre, along) / square, (dot(to_centre, to_centre) - reach**2) / square
    root = np.sqrt(np.maximum(half**2 - rest, 0.0))
    shares = (-half - root, -half + root, np.zeros_like(half), np.ones_like(half))
    candidates += [segments.starts + np.clip(share, 0, 1)[..., np.newaxis] * along for share in shares]
    every = np.concatenate(candidates, axis=1)
    gap = every - centre[:, np.newaxis]
    outside = np.sqrt(dot(gap, gap)) >= reach - 2 * _SLACK
    way = every - points[:, np.newaxis]
    away = np.where(outside & hold(planes, every), np.sqrt(dot(way, way)), np.inf)
    least: Floats = away.min(axis=1)
    return least


def _unit(vectors: Floats) -> Floats:
    """Return vectors of length 1; along x where there is no direction."""
    length = np.sqrt(dot(vectors, vectors))[..., np.newaxis]
    return np.where(length > 0, vectors / np.where(length > 0, length, 1.0), np.array([1.0, 0.0, 0.0]))


def _on_segments(found: Edges, points: Floats) -> Floats:
    """Distances ``(n, e)`` of points ``(n, 3)`` from the edges; infinite where nothing is left of one."""
    along = found.ends - found.starts
    offset = points[:, np.newaxis] - found.starts
    share = np.clip(dot(offset, along) / np.maximum(dot(along, along), 1e-300), 0, 1)
    gap = offset - share[..., np.newaxis] * along
    return np.where(found.valid, np.sqrt(dot(gap, gap)), np.inf)


__all__ = [
    "MOST_PLANES",
    "Edges",
    "distances",
    "distances_without_ball",
    "edges",
    "half_spaces",
    "hold",
    "joined",
]
