"""Containment of whole bodies, lane by lane.

A body lies in a convex container if the corners of its convex hull do. Two quick tests spare most lanes the
hull: the corners of the oriented bounding box inside mean yes, a few extreme corners of the hull outside mean
no. Containers are closed, up to `TOLERANCE`.
"""

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from scenic.runtime.geometry.affine import AffineMaps, Columns, relative_map
from scenic.runtime.geometry.contact.narrowphase import Solids
from scenic.runtime.geometry.flat.polygons import TOLERANCE, Polygons
from scenic.runtime.geometry.meshes import inside
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import distinct, rows

_CHUNK: Final = 1 << 19
"""Combinations of entry, corner and edge looked at together."""

_MOST_PLANES: Final = 128
"""Planes up to which a convex mesh is tested by them."""

_Test = Callable[[Indices, Floats], Booleans]
"""Says of lanes ``(m,)`` and points ``(k, 3)`` of the unit frame: which lanes have all points inside."""


def contains_points(body: Body, points: Floats) -> Booleans:
    """Return whether the solid of a body holds a point ``(n | 1, 3)``, lane by lane."""
    lanes = max(len(body), len(points))
    result = np.zeros(lanes, dtype=np.bool_)
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        local = body.poses.take(lanes_of_mesh).to_unit(points if len(points) == 1 else points[lanes_of_mesh])
        if mesh.is_box:
            close = np.abs(local) <= 0.5
            result[lanes_of_mesh] = close[:, 0] & close[:, 1] & close[:, 2]
        else:
            result[lanes_of_mesh] = inside.contains_points(mesh, local)
    return result


def in_convex_polygon(body: Body, corners: Floats, lanes: int) -> Booleans:
    """Return whether the column above and below a convex polygon holds the body, ``(lanes,)``.

    Args:
        body: the body.
        corners: the polygon's vertices, anticlockwise, ``(lanes | 1, k, 2)``.
        lanes: the number of lanes.

    """
    edges = np.roll(corners, -1, axis=1) - corners
    lengths = np.hypot(edges[..., 0], edges[..., 1])
    # Twice the polygon's area, as a fan: a polygon without area holds nothing.
    spokes = corners - corners[:, :1]
    after = np.roll(spokes, -1, axis=1)
    double_area = spokes[..., 0] * after[..., 1] - spokes[..., 1] * after[..., 0]
    has_area: Booleans = np.logical_or.reduce(double_area > 0, axis=1)

    def beside(images: Columns, chosen: Indices, numbers: Indices | int) -> Booleans:
        """Return whether all points are on the inner side of an edge, the same for all lanes or one for each."""
        edge, corner, length = (
            part[0 if len(part) == 1 else chosen, numbers] for part in (edges, corners, lengths)
        )
        side = edge[..., 0] * (images[1] - corner[..., 1]) - edge[..., 1] * (images[0] - corner[..., 0])
        inner: Booleans = np.logical_and.reduce(side >= -TOLERANCE * length, axis=0)
        return inner

    def test(chosen: Indices, points: Floats) -> Booleans:
        images = _world(body.poses, chosen, points)
        result = np.ones(len(chosen), dtype=np.bool_)
        for number in range(corners.shape[1]):
            result &= beside(images, chosen, number)
        return result

    result: Booleans = np.zeros(lanes, dtype=np.bool_)
    margins = _box_margins(body.poses, corners, edges)
    worst = np.broadcast_to(np.argmin(margins, axis=1), (lanes,))
    box_inside = np.broadcast_to(np.min(margins, axis=1) >= 0, (lanes,))
    for mesh, chosen in body.by_mesh(lanes):
        result[chosen] = box_inside[chosen]
        left = chosen[~box_inside[chosen]]
        # The edge that the world box oversteps most is the one that the body is likely to overstep, with its extremes.
        for points in (extreme_corners(mesh), mesh.hull.vertices):
            for part in rows(len(left), len(points), _CHUNK):
                some = left[part]
                result[some] = beside(_world(body.poses, some, points), some, worst[some])
            left = left[result[left]]
        result[left] = _chunked(test, left, mesh.hull.vertices)
    result &= has_area
    return result


def surely_in_disc(
    body: Body, centre: Floats, radius: Floats, sides: int, lanes: int
) -> tuple[Booleans, Booleans]:
    """Return the masks of the lanes in which a polygon certainly contains the body, and of those in which that is open; the polygon stands for a disc.

    The polygon lies between two circles: a body is in it if it is in the inner one, and not if a corner is outside the outer one.
    Both are moved by more than the tolerance and rounding.

    Args:
        body: the body.
        centre: of the disc, ``(lanes | 1, 3)``.
        radius: of the disc, ``(lanes | 1,)``.
        sides: of the regular polygon, whose corners lie on the circle.
        lanes: the number of lanes.

    """
    inside, is_open = np.zeros(lanes, dtype=np.bool_), np.zeros(lanes, dtype=np.bool_)
    inner = np.broadcast_to(radius * math.cos(math.pi / sides) - TOLERANCE, (lanes,))
    outer = np.broadcast_to(radius + 2 * TOLERANCE, (lanes,))
    middle = np.broadcast_to(centre, (lanes, 3))
    for mesh, every in body.by_mesh(lanes):
        points = mesh.hull.vertices
        for part in rows(len(every), len(points), _CHUNK):
            lanes_here = every[part]
            x, y, _ = _world(body.poses, lanes_here, points)
            dx, dy = x - middle[lanes_here, 0], y - middle[lanes_here, 1]
            farthest = np.sqrt(np.max(dx * dx + dy * dy, axis=0))
            inside[lanes_here] = farthest < inner[lanes_here]
            is_open[lanes_here] = ~inside[lanes_here] & (farthest < outer[lanes_here])
    return inside, is_open


def _box_margins(poses: Poses, corners: Floats, edges: Floats) -> Floats:
    """Return the distance, times the length of the edge, by which world boxes lie inside each edge: ``(n | 1, k)``."""
    lower, upper = poses.bounds()
    x, y = ((lower[:, axis, None] + upper[:, axis, None]) / 2 for axis in (0, 1))
    reach_x, reach_y = ((upper[:, axis, None] - lower[:, axis, None]) / 2 for axis in (0, 1))
    ex, ey = edges[..., 0], edges[..., 1]
    side = ex * (y - corners[..., 1]) - ey * (x - corners[..., 0])
    margins: Floats = side - (np.abs(ex) * reach_y + np.abs(ey) * reach_x)
    return margins


def in_polygons(body: Body, polygons: Polygons, lanes: int) -> Booleans:
    """Return whether the columns above and below fixed polygons hold the body, ``(lanes,)``."""
    convex = polygons.convex_corners
    if convex is not None:
        return in_convex_polygon(body, convex[None], lanes)

    def covered(chosen: Indices, points: Floats) -> Booleans:
        x, y = _world(body.poses, chosen, points)[:2]
        return polygons.covers_hulls(np.stack([x.T, y.T], axis=-1))

    def vertices_inside(chosen: Indices, points: Floats) -> Booleans:
        x, y = _world(body.poses, chosen, points)[:2]
        near = polygons.nearly_contains(x.ravel(), y.ravel()).reshape(x.shape)
        held: Booleans = np.logical_and.reduce(near, axis=0)
        return held

    result = np.zeros(lanes, dtype=np.bool_)
    lower, upper = body.poses.bounds()
    centre, reach = (lower + upper) / 2, (upper - lower) / 2
    radius = np.sqrt(reach[:, 0] * reach[:, 0] + reach[:, 1] * reach[:, 1])
    result[:] = polygons.holds_discs(centre[:, 0], centre[:, 1], radius)
    for mesh, every in body.by_mesh(lanes):
        left = every[~result[every]]
        left = left[_chunked(vertices_inside, left, extreme_corners(mesh))]
        for points in (_BOX_CORNERS, mesh.hull.vertices):
            for part in rows(len(left), len(points), _CHUNK):
                result[left[part]] = covered(left[part], points)
            left = left[~result[left]]
        for lane in left:
            # The outline of a concave body may go around a hole or a notch of the polygon.
            pose = body.poses.take(np.array([lane]))
            outline = pose.to_world(mesh.triangles.reshape(1, -1, 3)).reshape(-1, 3, 3)
            result[lane] = not mesh.is_box and polygons.covers_triangles(outline[..., :2])
    return result


def in_box(body: Body, dimensions: Floats, position: Floats, rotation: Floats, lanes: int) -> Booleans:
    """Return whether a solid box holds the body, ``(lanes,)``.

    Args:
        body: the body.
        dimensions: width, length and height, ``(lanes | 1, 3)``.
        position: its centre, ``(lanes | 1, 3)``.
        rotation: quaternions, ``(lanes | 1, 4)``.
        lanes: the number of lanes.

    """
    container, proper = _container(dimensions, position, rotation)

    def test(chosen: Indices, points: Floats) -> Booleans:
        images, scale = _local(body.poses, container, chosen, points)
        result = np.ones(len(chosen), dtype=np.bool_)
        for axis in range(3):
            result &= np.logical_and.reduce(np.abs(images[axis]) <= 0.5 + TOLERANCE / scale[axis], axis=0)
        return result

    return _all_inside(body, lanes, test) & proper


def in_ellipsoid(body: Body, dimensions: Floats, position: Floats, rotation: Floats, lanes: int) -> Booleans:
    """Return whether a solid ellipsoid with these diameters holds the body; arguments as for `in_box`."""
    container, proper = _container(dimensions, position, rotation)

    def test(chosen: Indices, points: Floats) -> Booleans:
        (x, y, z), scale = _local(body.poses, container, chosen, points)
        radius = np.sqrt(x * x + y * y + z * z)
        # What is a length of 1 across the surface in the unit frame, in the world is one over this.
        across = np.sqrt((x / scale[0]) ** 2 + (y / scale[1]) ** 2 + (z / scale[2]) ** 2)
        result: Booleans = np.logical_and.reduce((radius - 0.5) * radius <= TOLERANCE * across, axis=0)
        return result

    return _all_inside(body, lanes, test) & proper


def in_body(body: Body, container: Body, lanes: int) -> Booleans:
    """Return whether the solid of another body holds the body, ``(lanes,)``."""
    result = np.zeros(lanes, dtype=np.bool_)
    for outer, outer_lanes in container.by_mesh(lanes):
        for inner, inner_lanes in body.by_mesh(lanes):
            lanes_of_pair = np.intersect1d(outer_lanes, inner_lanes, assume_unique=True)
            if len(lanes_of_pair):
                poses = body.poses.take(lanes_of_pair), container.poses.take(lanes_of_pair)
                is_inside = mesh_in_mesh(inner, poses[0], outer, poses[1])
                result[lanes_of_pair] = is_inside
    return result


def mesh_in_mesh(inner: Mesh, inner_poses: Poses, outer: Mesh, outer_poses: Poses) -> Booleans:
    """Return whether the solid of one mesh lies in that of another, entry by entry, ``(n,)``."""
    count = max(len(inner_poses), len(outer_poses))
    every = np.arange(count)

    def test(chosen: Indices, points: Floats) -> Booleans:
        (x, y, z), scale = _local(inner_poses, outer_poses, chosen, points)
        result = np.ones(len(chosen), dtype=np.bool_)
        width, length, height = (1 / part for part in scale)
        for a, b, c, d in outer.hull.planes:
            # What is a length of 1 beside the plane in the unit frame, in the world is one over this.
            across = np.sqrt((a * width) ** 2 + (b * length) ** 2 + (c * height) ** 2)
            result &= np.logical_and.reduce(a * x + b * y + c * z + d <= TOLERANCE * across, axis=0)
        return result

    if outer.is_convex and len(outer.hull.planes) <= _MOST_PLANES:
        return _chunked(test, every, inner.hull.vertices)
    # A body that touches the container from inside is held; so a body smaller by the tolerance is tested.
    smaller = Poses(inner_poses.position, inner_poses.orientation, inner_poses.size - 2 * TOLERANCE)

    def vertices_inside(chosen: Indices, points: Floats) -> Booleans:
        images, _ = _local(smaller, outer_poses, chosen, points)
        held = inside.contains_points(outer, np.stack([part.ravel() for part in images], axis=1))
        result: Booleans = np.logical_and.reduce(held.reshape(images[0].shape), axis=0)
        return result

    result = _chunked(vertices_inside, every, extreme_corners(inner))
    left = np.flatnonzero(result)
    result[left] = _chunked(vertices_inside, left, inner.component_vertices)
    left = np.flatnonzero(result)
    if len(left):
        a, b = smaller.take(left), outer_poses.take(left)
        body, holder = np.zeros(len(left), dtype=np.intp), np.ones(len(left), dtype=np.intp)
        solids = Solids([inner, outer])
        # Surfaces apart and the body's surface inside: only a cavity of the container could still be in it.
        result[left] = ~solids.surfaces_touch(body, a, holder, b) & ~solids.some_part_inside(
            holder, b, body, a
        )
    return result


def _container(dimensions: Floats, position: Floats, rotation: Floats) -> tuple[Poses, Booleans]:
    """Return the poses of a container, and where it has a volume."""
    proper: Booleans = np.logical_and.reduce(dimensions > 0, axis=1)
    return Poses(position, rotation, np.where(dimensions > 0, dimensions, 1.0)), proper


def _all_inside(body: Body, lanes: int, test: _Test) -> Booleans:
    """Apply ``test`` to the hull, for convex containers."""
    result = np.zeros(lanes, dtype=np.bool_)
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        whole = _chunked(test, lanes_of_mesh, _BOX_CORNERS)
        result[lanes_of_mesh[whole]] = True
        lanes_of_mesh = lanes_of_mesh[~whole]
        if mesh.is_box:
            continue
        lanes_of_mesh = lanes_of_mesh[_chunked(test, lanes_of_mesh, extreme_corners(mesh))]
        result[lanes_of_mesh] = _chunked(test, lanes_of_mesh, mesh.hull.vertices)
    return result


_BOX_CORNERS: Final = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def extreme_corners(mesh: Mesh) -> Floats:
    """Return the hull's corners farthest along the axes and the diagonals, ``(k, 3)`` with k up to 26."""
    return mesh.derived(_find_extreme_corners)


def _find_extreme_corners(mesh: Mesh) -> Floats:
    """Return the hull's corners farthest along the axes and the diagonals, ``(k, 3)`` with k up to 26."""
    steps = (-1, 0, 1)
    directions = np.array([(x, y, z) for x in steps for y in steps for z in steps if (x, y, z) != (0, 0, 0)])
    highest = [int(np.argmax((mesh.vertices * direction).sum(axis=1))) for direction in directions]
    corners: Floats = mesh.vertices[distinct(np.array(highest))]
    return corners


def _chunked(test: _Test, chosen: Indices, points: Floats) -> Booleans:
    """Apply ``test`` with bounded memory; a lane continues only while all points so far are inside."""
    result = np.ones(len(chosen), dtype=np.bool_)
    for some in rows(len(points), 1, 4096):
        left = np.flatnonzero(result)
        for part in rows(len(left), len(points[some]), _CHUNK):
            result[left[part]] = test(chosen[left[part]], points[some])
    return result


def _world(poses: Poses, chosen: Indices, points: Floats) -> Columns:
    """The world coordinates, each ``(k, m)``, of points ``(k, 3)`` in the chosen lanes."""
    taken = poses.take(chosen)
    still = Poses.fixed((0, 0, 0))
    return _spread(relative_map(taken, still), points, len(chosen))


def _local(poses: Poses, container: Poses, chosen: Indices, points: Floats) -> tuple[Columns, Columns]:
    """Return the coordinates in the container's unit frame, and the container's sizes, each ``(m | 1,)``."""
    outer = container.take(chosen)
    images = _spread(relative_map(poses.take(chosen), outer), points, len(chosen))
    return images, (outer.size[:, 0], outer.size[:, 1], outer.size[:, 2])


def _spread(maps: AffineMaps, points: Floats, count: int) -> Columns:
    x, y, z = maps.columns((points[:, 0, None], points[:, 1, None], points[:, 2, None]))
    shape = (len(points), count)
    return np.broadcast_to(x, shape), np.broadcast_to(y, shape), np.broadcast_to(z, shape)
