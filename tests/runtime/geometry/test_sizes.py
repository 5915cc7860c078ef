"""Small and large bodies: with all lengths a trillion times as small or large the answers are the same."""

from collections.abc import Callable

import numpy as np
import pytest
import shapely

from scenic.runtime.geometry.contact.narrowphase import Solids
from scenic.runtime.geometry.contact.triangles import separated_by_edges
from scenic.runtime.geometry.containment import distance
from scenic.runtime.geometry.flat.polygons import Polygons
from scenic.runtime.geometry.flat.segments import Segments
from scenic.runtime.geometry.meshes import primitives, projection, surface
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.inside import contains_lattice, contains_points
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.nearest import nearest_on_triangles
from scenic.runtime.geometry.meshes.solids import proper_volume
from scenic.runtime.geometry.meshes.surface import Side
from scenic.runtime.geometry.poses import Poses

from .samples import bumpy, hollow, random_poses, table

SIZES = (2.0**-40, 2.0**40)
LANES = 20
MESHES = (primitives.box(), primitives.cone(), table(), hollow(), bumpy(2))
SIDES: tuple[tuple[Side, float], ...] = ((None, 0.0), ((2, 1), 0.5), ((0, -1), 0.2))


def poses(size: float, seed: int, spread: float = 0.6) -> Poses:
    some = random_poses(LANES, seed, spread=spread)
    return Poses(some.position * size, some.orientation, some.size * size)


def body(size: float, seed: int, spread: float = 0.6) -> Body:
    return Body(MESHES, np.arange(LANES) % len(MESHES), poses(size, seed, spread))


def places(seed: int, count: int = LANES, spread: float = 1.0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-spread, spread, (count, 3))


def triangles(size: float) -> list[np.ndarray]:
    """Also segments, points, and pairs in one plane."""
    corners = places(1, 6 * 60).reshape(60, 2, 3, 3) * size
    corners[::5, :, 2] = corners[::5, :, 1]
    corners[::15, :, 1:] = corners[::15, :, :1]
    corners[1::5, ..., 2] = 0.0
    first, second = (np.ascontiguousarray(part.transpose(1, 2, 0)) for part in corners.swapaxes(0, 1))
    nearest = nearest_on_triangles(places(2, 60) * size, *corners[:, 0].swapaxes(0, 1))
    return [nearest / size, separated_by_edges(first, second)]


def meshes(size: float) -> list[np.ndarray]:
    found = []
    for mesh in MESHES:
        some = Mesh((mesh.vertices + 0.25) * size, mesh.faces)
        unit, centre, extents = some.normalized()
        found += [
            some.normals,
            some.areas / size**2,
            np.array([some.volume, some.hull.volume]) / size**3,
            np.array([some.is_volume, some.is_convex, some.is_box]),
            some.outermost / size,
            unit.vertices,
            centre / size,
            extents / size,
            contains_points(some, (places(3, 200, 0.6) + 0.25) * size),
            contains_lattice(some, *(np.linspace(-0.3, 0.8, 12) * size for _ in range(3))),
            proper_volume(Mesh(some.triangles.reshape(-1, 3), np.arange(3 * len(some.faces)).reshape(-1, 3))).vertices / size,
        ]  # fmt: skip
    return found


def sides(size: float) -> list[np.ndarray]:
    some, uniforms = body(size, 4), np.random.default_rng(5).random((3, LANES))
    found = []
    for side, threshold in SIDES:
        faces = surface.draw_faces(some, side, threshold, uniforms[0], LANES)
        found += [
            faces,
            surface.side_contains(
                bumpy(2), some.poses, side, threshold, np.arange(LANES), np.arange(LANES) * 7
            ),
            surface.mean_normals(some, side, threshold, LANES) / (1 if side is None else size**2),
            surface.face_normals(some, faces),
            surface.face_orientations(some, faces),
            surface.face_points(some, faces, *uniforms[1:]) / size,
        ]
    return found


def landings(size: float) -> list[np.ndarray]:
    """Along directions of any length; nothing is so small that all of it is within the tolerance."""
    size = max(size, 2.0**-8)
    some, found = body(size, 6), []
    start = some.poses.position + size * places(7, spread=0.5)
    for side, threshold in SIDES:
        for length in (size, 1.0, 2.0**-70):
            faces, landed = projection.project(some, side, threshold, start, places(8) * length, LANES)
            assert 0.1 < (faces >= 0).mean() < 0.9
            found += [faces, landed / size]
    return found


def gaps(size: float) -> list[np.ndarray]:
    one, convex = body(size, 9), [Body(MESHES[:1], None, poses(size, seed, 1.5)) for seed in (10, 11)]
    found = distance.to_surface(one, 2 * size * places(11), LANES)
    within = distance.to_surface(one, 2 * size * places(11), LANES, within=0.5 * size)
    return [
        found.distance / size,
        found.point / size,
        within.distance / size,
        distance.signed(one, size * places(12), LANES) / size,
        distance.between(*convex, LANES) / size,
    ]


def meetings(size: float) -> list[np.ndarray]:
    first, second = np.random.default_rng(13).integers(0, len(MESHES), (2, LANES))
    solids = [Solids(MESHES, patience=patience) for patience in (0, np.inf)]
    return [some.intersect(first, poses(size, 14), second, poses(size, 15)) for some in solids]


def lines(size: float) -> list[np.ndarray]:
    chain = np.cumsum(places(16, 130), axis=0) * size
    found = []
    for count in (9, 130):
        line = Segments.of_chains([chain[:count].tolist()])
        ways = np.linspace(0, line.length, 20)
        where, number, place = line.nearest(4 * size * places(17))
        found += [line.frames, line.number_at(ways), line.at(ways) / size, where / size, number, place / size]
    return found


def polygons(size: float) -> list[np.ndarray]:
    outline = np.array([(0, 0), (4, 0), (4, 3), (2, 1.5), (0, 3)]) * size
    some = Polygons(shapely.Polygon(outline))
    return [some.sample(*np.random.default_rng(18).random((3, 50))) / size, np.array([some.area / size**2])]


@pytest.mark.parametrize("ask", [triangles, meshes, sides, landings, gaps, meetings, lines, polygons])
def test_answers_do_not_depend_on_the_unit_of_length(ask: Callable[[float], list[np.ndarray]]) -> None:
    expected = ask(1.0)
    for size in SIZES:
        for number, (found, usual) in enumerate(zip(ask(size), expected, strict=True)):
            np.testing.assert_allclose(found, usual, 1e-12, 1e-12, err_msg=f"answer {number} for {size}")
