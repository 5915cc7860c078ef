"""Regions as lines to be drawn, and the box around them."""

from collections.abc import Callable, Sequence
from itertools import pairwise, product
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.formats.mesh_instances import Array
from scenic.formats.poses import rotation_matrix
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.body_regions import OccupiedSpace, SideSurface
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.combinations import DifferenceRegion, IntersectionRegion, UnionRegion
from scenic.runtime.regions.composite import Composite, exactly_contains
from scenic.runtime.regions.lines import LineRegion
from scenic.runtime.regions.meshes import solid_in_world
from scenic.runtime.regions.planar import Footprint, PlanarRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.scattered import PointSetRegion
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.regions.view_regions import ViewRegion
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from scenic.runtime.regions.voxels import VoxelRegion

Keep = Callable[[Array], npt.NDArray[np.bool_]]

_CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
_EDGES = [(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit]
_AXES: Final = ([2, 0, 1], [0, 2, 1], [0, 1, 2])
"""Positions of the coordinates along x, y and z after an axis has been moved to the end."""
_SIDES = 72
_CREASE: Final = np.cos(np.radians(25))
"""Edges at which the faces of a mesh turn by more are drawn."""
_SLACK: Final = 1e-9
"""By how much a normal may miss what it has to reach, for rounding."""
_ROUND: Final = 0.5
"""Sections show a mesh of whose edges so large a part lies in curved faces."""
_MOST_EDGES: Final = 3000
_MOST_POINTS: Final = 1000
_CLOUD: Final = 300
"""So many points stand for a region of which nothing but its points is known."""
_STEPS: Final = 400
"""Number of tested places along the diagonal of a cut area."""
_HATCHES: Final = 24


def outlines(region: object) -> list[Array]:
    """Return lines ``(k, 3)`` that show where a fixed region is; none for a value that is not a region, or a region without bounds.

    Regions made of others are drawn as those parts of the others' lines that bound them; in the plane they are hatched, since
    a volume cuts them along lines that no member has. Of kinds that are not known here, some points are shown.
    """
    while isinstance(region, Workspace):
        region = region.region
    if not isinstance(region, Region) or region.is_random:
        return []
    columns = region.fixed_columns("the outline")
    match region:
        case CircularRegion():
            return [columns[0] + columns[1][:, np.newaxis] * _ring()]
        case RectangularRegion():
            return [_rectangle(region)]
        case PlanarRegion():
            return _rings(region.polygons, _height(region))
        case Footprint():
            return _rings(region.polygons, 0.0)
        case LineRegion():
            return _chained(np.stack([region.pieces.starts, region.pieces.ends], axis=1))
        case PointSetRegion():
            return _crosses(region.points)
        case BoxRegion() | SpheroidRegion():
            return _ellipsoid_or_box(columns, is_box=isinstance(region, BoxRegion))
        case VoxelRegion():
            return _longest([region.corner + line * region.pitch for line in _cell_edges(region.filled)])
        case SideSurface():
            return _mesh_lines(solid_in_world(columns), region.facing.side, region.facing.threshold)
        case OccupiedSpace():
            return _mesh_lines(solid_in_world(columns), None, 0.0)
        case ViewRegion():
            camera, orientation, horizontal, vertical, distance = columns
            frame = rotation_matrix(tuple(orientation[0].tolist()))
            angles = min(float(horizontal[0]), 2 * np.pi), min(float(vertical[0]), np.pi)
            return [camera + line @ frame.T for line in view_outline(*angles, float(distance[0]))]
        case UnionRegion():
            return [line for member in region.members for line in outlines(member)]
        case IntersectionRegion() | DifferenceRegion():
            return _composed(region)
        case _:
            return _cloud(region, columns)


def _rectangle(region: RectangularRegion) -> Array:
    offset = np.zeros((5, 3))
    offset[:, :2] = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) / 2
    offset *= [region.width, region.length, 0]
    half = region.heading / 2
    turn = rotation_matrix((0.0, 0.0, np.sin(half), np.cos(half)))
    return np.array(list(region.position), dtype=float) + offset @ turn.T


def _ellipsoid_or_box(columns: Sequence[Any], *, is_box: bool) -> list[Array]:
    size, middle, turn = columns
    frame = rotation_matrix(tuple(turn[0].tolist())) * size[0]
    ring = _ring() / 2
    rings = [ring, ring[:, [0, 2, 1]], ring[:, [2, 0, 1]]]
    lines = [_CORNERS[list(edge)] for edge in _EDGES] if is_box else rings
    return [middle + line @ frame.T for line in lines]


def _composed(region: Composite) -> list[Array]:
    """Return the parts of the members' lines that bound an intersection or a difference, or hatches if it lies in a plane."""
    members = [(member, member.fixed_columns("the outline")) for member in region.members]

    def within(number: int, points: Array) -> npt.NDArray[np.bool_]:
        return np.asarray(exactly_contains(members[number][0], points, members[number][1]))

    lines = []
    for number, member in enumerate(region.members):
        others = [other for other in range(len(members)) if other != number]
        # The border of what is taken away bounds the rest where it is in the first member.
        inside = isinstance(region, IntersectionRegion) or number > 0
        lines += _cut(
            outlines(member),
            lambda points, others=others, inside=inside: np.logical_and.reduce(  # type: ignore[misc] # of the loop
                [within(other, points) == inside for other in others]
            ),
        )
    flat = next((member for member in region.members if isinstance(member, PlanarRegion)), None)
    box = bounds(flat)
    if flat is None or box is None or region.dimension != 2:
        return lines
    columns = region.fixed_columns("the outline")
    (lower, upper), height = box, _height(flat)
    hatches = [
        np.array([[lower[0], y, height], [upper[0], y, height]])
        for y in np.linspace(lower[1], upper[1], _HATCHES + 2)[1:-1]
    ]
    return lines + _cut(hatches, lambda points: np.asarray(exactly_contains(region, points, columns)))


def _cut(lines: Sequence[Array], keep: Keep) -> list[Array]:
    """The parts of lines to keep, decided at short steps along the lines."""
    if not lines:
        return []
    points = np.concatenate(lines)
    step = max(float(np.linalg.norm(np.ptp(points, axis=0))) / _STEPS, 1e-9)
    result = []
    for line in lines:
        length = np.linalg.norm(np.diff(line, axis=0), axis=1)
        counts = np.maximum(np.ceil(length / step).astype(int), 1)
        parts = [
            np.linspace(a, b, n, endpoint=False) for (a, b), n in zip(pairwise(line), counts, strict=True)
        ]
        fine = np.concatenate([*parts, line[-1:]])
        is_inside = keep((fine[:-1] + fine[1:]) / 2)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], is_inside, [False]]).astype(int)))
        result += [fine[start : end + 1] for start, end in edges.reshape(-1, 2).tolist()]
    return result


def _height(region: PlanarRegion) -> float:
    return float(np.asarray(region.heights(*region.fixed_columns("the height"))).reshape(-1)[0])


def _rings(polygons: Any, z: float) -> list[Array]:
    """Return the borders of shapely polygons at a height."""
    rings = [ring for part in polygons.geoms for ring in (part.exterior, *part.interiors)]
    return [_at_height(np.array(ring.coords)[:, :2], z) for ring in rings]


def _chained(segments: Array) -> list[Array]:
    """Join segments ``(n, 2, 3)`` to lines where one begins at the end of the one before."""
    breaks = np.flatnonzero((segments[1:, 0] != segments[:-1, 1]).any(axis=1)) + 1
    return [np.concatenate([part[:, 0], part[-1:, 1]]) for part in np.split(segments, breaks) if len(part)]


def _crosses(points: Array) -> list[Array]:
    """Three short lines through each of the points, or through some of very many."""
    points = points[:: -(-len(points) // _MOST_POINTS)]
    spread = float(np.linalg.norm(np.ptp(points, axis=0)))
    half = max(spread / max(len(points), 9) ** 0.5 * 0.08, spread * 0.003) or 0.1
    return [point + half * np.outer([-1, 1], axis) for point in points for axis in np.eye(3)]


def _cloud(region: Region, columns: Sequence[Array]) -> list[Array]:
    """Some points of a region; none of one without bounds, or without points."""
    lower, upper = region.box(*columns)
    if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        return []
    rng = np.random.default_rng(0)
    numbers = rng.uniform(size=(region.draws, _CLOUD))
    points, found = region.draw_points(numbers, rng.integers(1 << 63, size=_CLOUD, dtype=np.uint64), *columns)
    points = np.broadcast_to(points, (_CLOUD, 3))
    return _crosses(points if found is None else points[found]) if found is None or found.any() else []


def _mesh_lines(mesh: Mesh, side: tuple[int, int] | None, threshold: float) -> list[Array]:
    """Return the edges of a mesh, or of its faces that look to a side, and sections of round parts."""
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    if side is not None:
        faces_the_side = normal[:, side[0]] * side[1] >= threshold - _SLACK
        faces, normal = faces[faces_the_side], normal[faces_the_side]
    if not len(faces):
        return []
    pairs = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, number, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    total = np.zeros((len(edges), 3))
    np.add.at(total, number, np.repeat(normal, 3, axis=0))
    # Two unit normals that enclose an angle a add up to a vector of length 2 cos(a / 2).
    squared_length = (total**2).sum(axis=1)
    sharp = (count != 2) | (squared_length < 2 + 2 * _CREASE)
    is_curved = ~sharp & (squared_length < 4 - 1e-6)
    lines = _longest(list(vertices[edges[sharp]]))
    if is_curved.mean() > _ROUND:
        for axis in range(3):
            lines += _section(vertices[faces], axis)
    return lines


def _longest(lines: list[Array]) -> list[Array]:
    """Return as many of the lines ``(2, 3)`` as a page takes, the longest ones, in their order."""
    if len(lines) <= _MOST_EDGES:
        return lines
    length = np.array([np.linalg.norm(line[1] - line[0]) for line in lines])
    return [lines[index] for index in np.sort(np.argsort(-length, kind="stable")[:_MOST_EDGES]).tolist()]


def _cell_edges(filled: npt.NDArray[np.bool_]) -> list[Array]:
    """Return the edges ``(2, 3)`` of filled cells of side 1, along each axis joined to lines; none within flat faces."""
    lines = []
    for axis in range(3):
        cells = np.pad(np.moveaxis(filled, axis, 2), 1)
        a, b, c, d = cells[:-1, :-1], cells[1:, :-1], cells[:-1, 1:], cells[1:, 1:]
        count = a.astype(np.int8) + b + c + d
        # Of four cells around an edge two side by side are flat, two across from each other are not.
        edge = (count == 1) | (count == 3) | ((count == 2) & (a == d))
        steps = np.diff(edge.astype(np.int8), axis=2)
        starts, ends = np.argwhere(steps == 1), np.argwhere(steps == -1)
        # Both are in the order of the lines; padding moves all cells up by one.
        segments = np.stack([starts, ends], axis=1).astype(float)
        lines += list(segments[..., _AXES[axis]])
    return lines


def _section(corners: Array, axis: int) -> list[Array]:
    """Return the segments in which triangles ``(n, 3, 3)`` cross the plane through the middle of their box, across an axis."""
    values = corners[..., axis]
    # A little off the middle, where no vertices of symmetric meshes lie.
    height = values - (values.min() + (values.max() - values.min()) * 0.5000012345)
    ends = []
    crossing = (height.min(axis=1) < 0) & (height.max(axis=1) > 0)
    corners, height = corners[crossing], height[crossing]
    for a, b in ((0, 1), (1, 2), (2, 0)):
        part = height[:, a] / np.where(height[:, a] == height[:, b], 1, height[:, a] - height[:, b])
        place = corners[:, a] + part[:, np.newaxis] * (corners[:, b] - corners[:, a])
        place[(height[:, a] > 0) == (height[:, b] > 0)] = np.nan
        ends.append(place)
    places = np.stack(ends, axis=1)
    crosses = ~np.isnan(places[..., 0])
    return list(places[crosses].reshape(-1, 2, 3)) if len(places) else []


def view_outline(horizontal: float, vertical: float, distance: float) -> list[Array]:
    """Return lines ``(k, 3)`` that show a view from the origin, ahead to +Y: arcs of its outer border, and its edges.

    Args:
        horizontal: view angle, radians, up to 2π.
        vertical: view angle, radians, up to π.
        distance: how far it reaches, metres.

    """

    def place(azimuth: Array, altitude: Array) -> Array:
        level = np.cos(altitude)
        directions = [-np.sin(azimuth) * level, np.cos(azimuth) * level, np.sin(altitude)]
        return distance * np.stack(np.broadcast_arrays(*directions), axis=-1)

    across = np.linspace(-horizontal / 2, horizontal / 2, _SIDES // 2 + 1)
    upward = np.linspace(-vertical / 2, vertical / 2, _SIDES // 4 + 1)
    around, upright = horizontal > 2 * np.pi - 0.02, vertical > np.pi - 0.02
    lines = [place(across, np.array(0.0))]
    if not upright:
        lines += [place(across, np.array(side * vertical / 2)) for side in (-1, 1)]
    if around:
        lines += [place(np.array(turn * np.pi / 2), upward) for turn in range(4)]
    else:
        lines += [place(np.array(side * horizontal / 2), upward) for side in (-1, 1)]
    if not around:
        tops = (0.0,) if upright else (-0.5, 0.5)
        corners = [(side * horizontal / 2, top * vertical) for side in (-1, 1) for top in tops]
        lines += [np.stack([np.zeros(3), place(np.array(a), np.array(b))]) for a, b in corners]
    return lines


def bounds(region: object) -> tuple[Array, Array] | None:
    """The lower and upper corner ``(3,)`` of the box around a fixed region; ``None`` where it has none or is not known."""
    if not isinstance(region, Region) or region.is_random:
        return None
    lower, upper = (corner.reshape(-1, 3)[0] for corner in region.box(*region.fixed_columns("the box")))
    return (lower.copy(), upper.copy()) if np.isfinite([lower, upper]).all() else None


def _ring() -> Array:
    angle = np.linspace(0, 2 * np.pi, _SIDES + 1)
    return np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)


def _at_height(points: Array, z: float) -> Array:
    return np.column_stack([points, np.full(len(points), z)])
