"""Single rays: which of them there are, that none is left out, and that none slips through a surface or starts on its wrong side."""

import dataclasses
import itertools
import math
from fractions import Fraction

import numpy as np
import pytest

from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.views import hits
from scenic.runtime.geometry.views.grid import rows_towards
from scenic.runtime.geometry.views.hits import exact_first, place
from scenic.runtime.geometry.views.observers import Extents, Views
from scenic.runtime.geometry.views.occluders import Obstacles, Occluder
from scenic.runtime.geometry.views.occlusion_proofs import shadowed
from scenic.runtime.geometry.views.seen_bodies import inside_body, sees_bodies
from scenic.runtime.geometry.views.seen_points import sees_points
from tests.runtime.geometry.samples import bumpy, random_poses, table
from tests.runtime.geometry.views import reference
from tests.runtime.geometry.views.reference import Rotation
from tests.runtime.geometry.views.test_seen_bodies import BOX, CONE, FRAME, fixed, scenes

EVERYWHERE = Extents(np.array([[-np.pi, np.pi]]), np.array([True]), np.array([[-np.pi / 2, np.pi / 2]]))


def sees(observer: Views, target: Body, *occluders: Body) -> bool:
    return bool(sees_bodies(observer, target, [Occluder(item) for item in occluders], 1)[0])


@pytest.mark.parametrize("tenths", [1, 3, 7, 10, 23, 50])
def test_ray_numbers_are_those_of_exact_arithmetic(tenths: int) -> None:
    """Rounding of the product of angle and density makes no ray more."""
    for degrees in range(1, 180, 2):
        angle = math.radians(degrees)
        observer = Views.fixed((0, 0, 0), angles=(angle, angle), density=tenths / 10)
        rows = rows_towards(observer, EVERYWHERE, np.ones(1))
        lines = math.ceil(Fraction(tenths, 10) * degrees)
        assert len(rows.lane) == lines
        level = np.abs(rows.altitude).argmin()
        across = lines * math.cos(rows.altitude[level])
        assert rows.count[level] == max(1, round(across))


@pytest.mark.parametrize("shape", ["wide", "high"])
def test_each_ray_of_a_fine_grid_is_cast(shape: str) -> None:
    """Through a slit as narrow as the step from ray to ray a body is seen wherever the slit is about a ray."""
    across, upward, angle = 260, 250, 0.5
    if shape == "high":
        across, upward = upward, across
    observer = Views.fixed((0, 0, 0), angles=(angle, angle), count=(across, upward))
    # Its middle is hidden by the beam that stands before it.
    target, beam = fixed((0, 10, 0), (6, 0.1, 6)), fixed((0, 4.9, 0), (0.01, 0.01, 0.01))
    half, count = 0.2 * angle / 260, 260
    for number in np.random.default_rng(3).choice(count, 14, replace=False).tolist():
        for off, seen in ((0.0, True), (0.5, False)):
            middle = -angle / 2 + (number + 0.5 + off) * angle / count
            if abs(middle) + 2 * half > angle / 2:
                continue
            low, high = 5 * math.tan(middle - half), 5 * math.tan(middle + half)
            sides = [(low - 6, low), (high, high + 6)]
            if shape == "wide":  # azimuths grow to the left
                walls = [fixed((-(a + b) / 2, 5.0005, 0), (b - a, 1e-3, 12)) for a, b in sides]
            else:
                # Seen from the camera, rows are cones: only near the middle of the view they are level.
                walls = [fixed((0, 5.0005, (a + b) / 2), (12, 1e-3, b - a)) for a, b in sides]
                walls += [fixed((s * 6.02, 4.8, 0), (12, 1e-3, 12)) for s in (-1, 1)]
            assert sees(observer, target, beam, *walls) is seen


@pytest.mark.parametrize("mesh", [primitives.cylinder(40), primitives.spheroid(), table()])
@pytest.mark.parametrize("off", [1e-3, 1e-7, 1e-9])
def test_from_just_outside_a_surface_its_body_hides_nothing_ahead(mesh: Mesh, off: float) -> None:
    """And everything from just inside, in every direction."""
    turn = Rotation.from_euler("zxy", (0.4, 0.2, -0.3))
    body = Body((mesh,), None, Poses.fixed((1, 2, 3), turn.as_quat(), (2, 3, 1.5)))
    corners = turn.apply(mesh.triangles.reshape(-1, 3) * (2, 3, 1.5)).reshape(-1, 3, 3) + np.array([1, 2, 3])
    faces = np.flatnonzero(mesh.areas > 1e-4)[:: max(1, len(mesh.faces) // 150)]
    normal = np.cross(*(corners[faces, i] - corners[faces, 0] for i in (1, 2)))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    middle = corners[faces].mean(axis=1)
    for side in (1, -1):
        observers = Views.fixed((0, 0, 0), distance=99).spread(len(faces))
        observers = Views(middle + side * off * normal, *(getattr(observers, name) for name in _REST))
        for sideways in (0.0, 0.8):
            ahead = normal + sideways * np.roll(normal, 1, axis=1) * (np.abs(normal) < 0.9)
            ahead *= np.sign((ahead * normal).sum(axis=1, keepdims=True))
            points = observers.camera + 0.1 * ahead if side > 0 else observers.camera + 9 * ahead
            if side > 0 and not mesh.is_convex:
                points = observers.camera + 0.01 * normal
            seen = sees_points(observers, points, [Occluder(body)], len(faces))
            assert (seen == (side > 0)).all()
            if side < 0:
                continue  # what single precision misses is looked at again, what it finds is not
            obstacles = Obstacles(
                [Occluder(body)], observers, np.arange(len(faces)), points, np.zeros(len(faces))
            )
            ways = observers.to_view(points)
            assert not obstacles.block(np.arange(len(faces)), ways, np.ones(len(faces)), exact=False).any()


_REST = ("orientation", "angles", "distance", "density", "count", "scaling")


@pytest.mark.parametrize("mesh", [BOX, primitives.cylinder(7), primitives.spheroid(), table(), bumpy(3)])
def test_no_ray_slips_between_two_faces(mesh: Mesh) -> None:
    """Rays towards points of edges and corners meet the surface there or before."""
    rng = np.random.default_rng(4)
    first, second = mesh.faces[:, [0, 1, 2]].ravel(), mesh.faces[:, [1, 2, 0]].ravel()
    edges = rng.integers(0, len(first), 900)
    share = np.where(rng.random((900, 1)) < 0.2, 0.0, rng.random((900, 1)))
    targets = (1 - share) * mesh.vertices[first[edges]] + share * mesh.vertices[second[edges]]
    way = rng.normal(size=(900, 3))
    origins = targets + way * rng.choice([0.3, 2.0, 40.0], (900, 1))
    directions = targets - origins
    near, _ = hits.box_span(origins, directions)
    met = exact_first(mesh, origins, directions, near)
    # One that only touches an edge from outside may pass.
    deep = _dives(mesh, first, second, edges, directions)
    assert (met[deep] <= 1 + 1e-9).all()
    assert deep.mean() > 0.3


def _dives(mesh: Mesh, first: Floats, second: Floats, edges: Floats, directions: Floats) -> Floats:
    """Whether directions go inwards on both sides of an edge."""
    sides = {(a, b): number // 3 for number, (a, b) in enumerate(zip(first, second, strict=True))}
    along = np.array(
        [
            [directions[i] @ mesh.normals[sides[pair]] for pair in ((a, b), (b, a))]
            for i, (a, b) in enumerate(zip(first[edges], second[edges], strict=True))
        ]
    )
    return (along < -0.05 * np.linalg.norm(directions, axis=1)[:, np.newaxis]).all(axis=1)


@pytest.mark.parametrize("seed", [32, 33])
def test_what_single_precision_misses_hides_all_the_same(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the index in single precision misses obstacles, faces in double precision are what counts."""
    count = 60
    observers, target, occluders = scenes(seed, count)
    target = Body((BOX,), None, target.poses)
    points = target.poses.position
    honest = (
        sees_bodies(observers, target, occluders, count),
        sees_points(observers, points, occluders, count),
    )
    rng = np.random.default_rng(5)

    def careless(mesh: Mesh, origins: Floats, directions: Floats, near: Floats) -> Floats:
        found = exact_first(mesh, origins, directions, near)
        return np.where(rng.random(len(found)) < 0.7, np.inf, found)

    monkeypatch.setattr(hits, "_quick_first", careless)
    assert sees_bodies(observers, target, occluders, count).tolist() == honest[0].tolist()
    assert sees_points(observers, points, occluders, count).tolist() == honest[1].tolist()


def test_obstacles_are_all_that_meet_the_hull_of_camera_and_target() -> None:
    """Against balls along the way; few are kept that do not meet it."""
    rng = np.random.default_rng(6)
    count = 4000
    camera, middle = rng.normal(size=(2, count, 3))
    middle = camera + (middle - camera) * rng.choice([0.3, 3.0], (count, 1))
    radius = rng.choice([0.0, 0.5, 2.0], count) * rng.random(count)
    place, size = camera + rng.normal(size=(count, 3)), rng.uniform(0.05, 1.2, (count, 3))
    body = Body((BOX,), None, Poses(place, np.array([[0.0, 0, 0, 1]]), size))
    observers = Views.fixed((0, 0, 0)).spread(count)
    observers = Views(camera, *(getattr(observers, name) for name in _REST))
    obstacles = Obstacles([Occluder(body)], observers, np.arange(count), middle, radius)
    kept = obstacles.lanes[0]
    part = np.linspace(0, 1, 801)[:, np.newaxis]
    reach = np.linalg.norm(size, axis=1) / 2
    lacks = np.array(
        [
            (
                np.linalg.norm(camera[i] + part * (middle[i] - camera[i]) - place[i], axis=1)
                - part[:, 0] * radius[i]
            ).min()
            - reach[i]
            for i in range(count)
        ]
    )
    assert kept[lacks <= 0].all()
    assert not kept[lacks > 0.01].any()
    assert 0.1 < (lacks <= 0).mean() < 0.9


def test_of_a_body_that_passes_through_the_obstacle_around_the_camera_the_part_inside_is_seen() -> None:
    """All corners of its box, and its middle, are hidden by the obstacle."""
    room, plank = fixed((0, 0, 0), (2, 2, 2)), fixed((3.75, 0.6, 0), (10.5, 0.2, 0.2))
    assert sees(Views.fixed((0, 0, 0)), plank, room)
    assert not sees(Views.fixed((0, 0, 0)), fixed((3.75, 2.6, 0), (10.5, 0.2, 0.2)), room)
    assert sees(Views.fixed((0, 0, 0)), plank, Body((primitives.cylinder(),), None, room.poses))


@pytest.mark.parametrize("mesh", [BOX, primitives.cone(), FRAME])
def test_rays_meet_turned_and_stretched_bodies_where_lines_of_the_world_do(mesh: Mesh) -> None:
    """In lengths of the directions of the view's frame, whatever the frame and the sizes are."""
    rng = np.random.default_rng(7)
    turns = Rotation.random(2, random_state=8)
    body = Body((mesh,), None, Poses.fixed((0.5, 4, -0.3), turns[0].as_quat(), (0.7, 3, 1.9)))
    observer = Views.fixed((-0.2, 0.1, 0.3), turns[1].as_quat())
    targets = mesh.triangles[rng.integers(0, len(mesh.faces), 300)]
    weights = rng.dirichlet(np.ones(3), 300)[:, :, np.newaxis]
    world = turns[0].apply((targets * weights).sum(axis=1) * (0.7, 3, 1.9)) + np.array([0.5, 4, -0.3])
    directions = turns[1].inv().apply(world - observer.camera[0])
    for exact in (False, True):
        found = place(body, observer, np.zeros(1, dtype=np.intp)).first(
            np.zeros(300, dtype=np.intp), directions, exact=exact
        )
        assert (found <= 1 + 1e-9).all()
        assert np.isclose(found, 1).mean() > 0.1
        # Half as long, they take twice as many of their lengths.
        again = place(body, observer, np.zeros(1, dtype=np.intp)).first(
            np.zeros(300, dtype=np.intp), directions / 2, exact=exact
        )
        assert again == pytest.approx(2 * found)


def test_cameras_in_bodies_of_different_shapes_are_each_in_their_own() -> None:
    """The middle of a frame is beside it, that of a box in it; whichever comes first in the table of shapes."""
    meshes = (BOX, FRAME, primitives.cone())
    count = 24
    choice = np.arange(count) % 3
    place = np.where((np.arange(count) // 3 % 2 == 0)[:, np.newaxis], [[0.0, 0, 0]], [[0.9, 0, 0.9]])
    # Straight ahead of narrow views that look away there is nothing of any of them but around the camera.
    observers = Views.fixed((0, 0, 0), angles=(0.02, 0.02), count=(1, 1), distance=0.05).spread(count)
    observers = Views(place, *(getattr(observers, name) for name in _REST))
    for order in ((0, 1, 2), (2, 0, 1), (1, 2, 0)):
        table_ = tuple(meshes[number] for number in order)
        numbers = np.array([order.index(number) for number in choice])
        body = Body(table_, numbers, Poses.fixed((0, 0, 0), size=(2, 2, 2)))
        # A box holds both places, a frame the one in its corner, a cone the middle.
        expected = (choice == 0) | ((choice == 1) == (place[:, 0] > 0))
        assert sees_bodies(observers, body, (), count).tolist() == expected.tolist()


@pytest.mark.parametrize("mesh", [primitives.cylinder(7), primitives.spheroid(), table(), bumpy(3)])
def test_rays_at_edges_are_decided_again_where_single_precision_names_the_wrong_face(mesh: Mesh) -> None:
    rng = np.random.default_rng(14)
    first, second = mesh.faces[:, [0, 1, 2]].ravel(), mesh.faces[:, [1, 2, 0]].ravel()
    edges = rng.integers(0, len(first), 600)
    share = rng.random((600, 1))
    targets = (1 - share) * mesh.vertices[first[edges]] + share * mesh.vertices[second[edges]]
    origins = targets + rng.normal(size=(600, 3)) * 2
    directions = targets - origins
    near, _ = hits.box_span(origins, directions)
    deep = _dives(mesh, first, second, edges, directions)
    quick = hits._quick_first(mesh, origins, directions, near)[deep]
    assert (quick <= 1 + 1e-9).mean() > 0.98
    np.testing.assert_allclose(quick, exact_first(mesh, origins, directions, near)[deep], atol=1e-9)


@pytest.mark.parametrize(
    "count", [(9, 9), (31, 31), (333, 77), *((across, 60) for across in range(180, 212))]
)
@pytest.mark.parametrize("side", [-1, 1])
def test_no_ray_is_cast_beyond_the_view(count: tuple[int, int], side: int) -> None:
    """All of a wide body that is in view is hidden, and what is beside the view is not seen however many rays there are."""
    observer = Views.fixed((0, 0, 0), angles=(0.5, 0.5), count=count)
    for axis in (0, 2):
        place, size = np.array([0.0, 10, 0]), np.array([2.0, 0.2, 2.0])
        place[axis], size[axis] = side * 5.0, 9.0
        target = fixed(tuple(place), tuple(size))
        screen = fixed((0, 5, 0), (2.6, 0.1, 2.6))  # the view is 5 tan 0.25 wide to each side there
        assert not sees(observer, target, screen)
        assert sees(observer, target)
        narrow = fixed((0, 5, 0), (2.4, 0.1, 2.4))
        assert sees(Views.fixed((0, 0, 0), angles=(0.5, 0.5), count=(401, 401)), target, narrow)


@pytest.mark.parametrize("explicit", [False, True])
@pytest.mark.parametrize("angles", [(2 * math.pi, math.pi), (1.0, 2.9), (5.0, 0.3), (0.02, 3.0)])
def test_the_rays_of_a_view_are_those_of_the_letter(explicit: bool, angles: tuple[float, float]) -> None:
    """Rows lose rays as they shrink towards the poles, unless their number is given."""
    for density in (0.1, 0.37, 1.0):
        for scaling in (False, True):
            count = (round(97 * density), round(61 * density)) if explicit else (0, 0)
            observer = Views.fixed((0, 0, 0), angles=angles, density=density / 3, count=count)
            observer = dataclasses.replace(observer, scaling=np.array([scaling]))
            found = [rays for _, rays in rows_towards(observer, EVERYWHERE, np.full(1, 3.0)).rays(1000)]
            expected = reference.grid(observer, 0, 3.0)
            np.testing.assert_allclose(np.concatenate(found), expected, atol=1e-12)


@pytest.mark.parametrize("across", [1, 2, 3, 7, 16, 1000])
def test_thinned_rays_are_rays_that_lie_evenly_in_their_rows(across: int) -> None:
    """None is made up, not even beyond the end of a row, and no more are left out there than between two of them."""
    lanes = 24
    observers = Views.fixed((0, 0, 0), angles=(1.9, 1.3), density=0.5).spread(lanes)
    middle = np.linspace(-0.9, 0.9, lanes)[:, np.newaxis]
    half = np.linspace(0.01, 0.8, lanes)[:, np.newaxis] * [[-1, 1]]
    target = Extents(middle + half, np.zeros(lanes, dtype=bool), 0.4 * middle + half)
    rows = rows_towards(observers, target, np.ones(lanes))
    thinned = rows.thinned(across, lanes)
    assert set(thinned.lane.tolist()) == set(rows.lane.tolist())
    assert (thinned.totals(lanes) <= rows.totals(lanes)).all()
    for lane, altitude, first, step, count in zip(
        thinned.lane, thinned.altitude, thinned.first, thinned.step, thinned.count, strict=True
    ):
        (row,) = np.flatnonzero((rows.lane == lane) & (rows.altitude == altitude))
        numbers = (first + np.arange(count) * step - rows.first[row]) / rows.step[row]
        np.testing.assert_allclose(numbers, np.round(numbers), atol=1e-6)
        stride = round(step / rows.step[row])
        assert -1e-6 < numbers[0] < stride - 0.5
        assert rows.count[row] - 0.5 - stride < numbers[-1] < rows.count[row] - 0.5
        assert min(across, rows.count[row]) <= count <= max(1, 2 * across)


@pytest.mark.parametrize("mesh", [primitives.cylinder(7), primitives.spheroid(), bumpy(3)])
@pytest.mark.parametrize("away", [1.0, 100.0])
def test_rays_past_corners_and_from_beside_faces_are_decided_as_in_double_precision(
    mesh: Mesh, away: float
) -> None:
    """A millionth of the body beneath a corner, and from as far beneath and above it, single precision cannot tell."""
    rng = np.random.default_rng(15)
    count = 150
    corners = mesh.vertices[rng.integers(0, len(mesh.vertices), count)]
    depth = rng.choice([1e-6, 1e-4], (count, 1))
    beneath, above = corners * (1 - depth), corners * (1 + depth)
    far_off = beneath + away * rng.normal(size=(count, 3))
    origins = np.concatenate([far_off, beneath, above])
    directions = np.concatenate([beneath - far_off, rng.normal(size=(2 * count, 3))])
    near, far = hits.box_span(origins, directions)
    meets = np.flatnonzero((far >= 0) & (near <= far))
    origins, directions, near = origins[meets], directions[meets], near[meets]
    quick = hits._quick_first(mesh, origins, directions, near)
    # Every face by itself.
    ray, face = (
        np.repeat(np.arange(len(origins)), len(mesh.faces)),
        np.tile(np.arange(len(mesh.faces)), len(origins)),
    )
    crosses, distance = hits.face_crossings(mesh, origins[ray], directions[ray], face)
    distance = np.where(crosses & (distance >= 0), distance, np.inf)
    expected = distance.reshape(len(origins), -1).min(axis=1)
    np.testing.assert_allclose(quick, expected, rtol=0, atol=1e-9)
    assert 0.3 < np.isfinite(expected).mean() < 1
    assert (expected < 1e-3).any()


@pytest.mark.parametrize("mesh", [primitives.cylinder(6), FRAME, table(), primitives.cone()])
@pytest.mark.parametrize("scale", [1.0, 30.0, 1e6])
def test_single_precision_finds_what_double_does(mesh: Mesh, scale: float) -> None:
    """Also on faces in the sides of the box, along the axes, and from inside; nothing farther on is taken for the first."""
    rng, count = np.random.default_rng(7), 400
    origins = rng.normal(size=(count, 3))
    origins *= scale / np.linalg.norm(origins, axis=1, keepdims=True)
    targets = rng.uniform(-0.5, 0.5, (count, 3))
    origins[::5, :2] = targets[::5, :2]
    if scale == 1:
        origins[::7] *= 0.2
    directions = targets - origins
    near, _ = hits.box_span(origins, directions)
    exact = exact_first(mesh, origins, directions, near)
    quick = hits._quick_first(mesh, origins, directions, near)
    met = np.isfinite(exact)
    np.testing.assert_array_equal(np.isfinite(quick), met)
    assert 0.2 < met.mean() < 1
    np.testing.assert_allclose(quick[met], exact[met], rtol=1e-9)


def test_lines_almost_along_the_faces_of_the_box_enter_and_leave_it_where_they_do() -> None:
    """However small a part of the direction is, its sign says which face comes first."""
    rng, count = np.random.default_rng(8), 2000
    tiny = rng.choice([1, -1], (count, 3)) * 10.0 ** rng.uniform(-12, 0, (count, 3))
    directions = np.where(rng.random((count, 3)) < 0.6, tiny, rng.normal(size=(count, 3)))
    within = rng.uniform(-0.5, 0.5, (count, 3))
    origins = within - directions * 10.0 ** rng.uniform(-1, 6, (count, 1))
    origins = np.where(np.abs(origins) > 10, 0.6 * np.sign(origins), origins)
    near, far = hits.box_span(origins, directions)
    for line in range(count):
        spans = [
            sorted((Fraction(side) - Fraction(start)) / Fraction(way) for side in (-0.5, 0.5))
            for start, way in zip(origins[line].tolist(), directions[line].tolist(), strict=True)
        ]
        assert near[line] == pytest.approx(float(max(low for low, _ in spans)), rel=1e-12, abs=1e-12)
        assert far[line] == pytest.approx(float(min(high for _, high in spans)), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("mesh", [primitives.cylinder(7), bumpy(3)])
def test_thousands_of_rays_are_each_decided_as_among_few(mesh: Mesh) -> None:
    rng, count = np.random.default_rng(9), 5000
    origins = rng.normal(size=(count, 3)) * 2
    directions = rng.uniform(-0.6, 0.6, (count, 3)) - origins
    near, _ = hits.box_span(origins, directions)
    together = exact_first(mesh, origins, directions, near)
    for some in (np.arange(200), np.arange(4000, 4200), np.arange(4600, 4800)):
        alone = exact_first(mesh, origins[some], directions[some], near[some])
        np.testing.assert_array_equal(together[some], alone)
    assert 0.2 < np.isfinite(together).mean() < 0.8


@pytest.mark.parametrize("exact", [False, True])
def test_what_rays_of_many_lanes_meet_is_what_each_meets_alone(exact: bool) -> None:
    """Of bodies of several shapes, from outside and from within; some lanes of many, in any order."""
    rng, lanes, rays = np.random.default_rng(21), 40, 20
    meshes = (BOX, CONE, FRAME, bumpy(1))

    def some(spread: float) -> Body:
        poses = random_poses(lanes, int(rng.integers(1000)), spread=spread, sizes=(0.5, 2.5))
        return Body(meshes, rng.integers(0, len(meshes), lanes), poses)

    bodies = [some(1.5) for _ in range(3)]
    turns = random_poses(lanes, 22).orientation
    camera = rng.uniform(-2, 2, (lanes, 3))
    camera[::3] = bodies[0].poses.position[::3]
    observers = dataclasses.replace(Views.fixed((0, 0, 0)).spread(lanes), camera=camera, orientation=turns)
    chosen = rng.permutation(lanes)[:14]
    looking = observers.take(chosen)
    lane = np.repeat(np.arange(len(chosen)), rays)
    directions = rng.normal(size=(len(lane), 3)) * rng.uniform(0.1, 3, (len(lane), 1))
    # Some along the sides of the first body.
    owner = chosen[lane[::4]]
    number = np.arange(len(owner))
    sides = bodies[0].poses.matrix[owner][number, :, number % 3]
    directions[::4] = Rotation.from_quat(turns[owner]).inv().apply(sides)
    world = Rotation.from_quat(turns[chosen[lane]]).apply(directions)
    met = np.array(
        [
            np.concatenate(
                [
                    reference.first_hits(camera[number], ways, reference.triangles(body, number))
                    for number, ways in zip(chosen, world.reshape(-1, rays, 3), strict=True)
                ]
            )
            for body in bodies
        ]
    )
    assert 0.1 < np.isfinite(met).mean() < 0.9
    for body, expected in zip(bodies, met, strict=True):
        found = place(body, looking, chosen).first(lane, directions, exact=exact)
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    active = [np.ones(1, dtype=bool), rng.random(lanes) < 0.5, rng.random(lanes) < 0.5]
    occluders = [Occluder(body, where) for body, where in zip(bodies, active, strict=True)]
    count = len(chosen)
    obstacles = Obstacles(occluders, looking, chosen, np.zeros((count, 3)), np.full(count, 50.0))
    limits = rng.uniform(0.05, 3, len(lane))
    hides = np.array([np.broadcast_to(where, (lanes,))[chosen[lane]] for where in active])
    expected = ((met <= limits) & hides).any(axis=0)
    np.testing.assert_array_equal(obstacles.block(lane, directions, limits, exact=exact), expected)
    # Asked in another order, and of a part of the rays.
    part = rng.permutation(len(lane))[: len(lane) // 2]
    found = obstacles.block(lane[part], directions[part], limits[part], exact=exact)
    np.testing.assert_array_equal(found, expected[part])


def test_what_hides_bundles_of_rays_is_met_by_all_of_them_from_outside() -> None:
    """By a convex body exactly then, by others then at the most; in each lane by the body of that lane."""
    rng, lanes, rays = np.random.default_rng(31), 90, 4
    meshes = (BOX, CONE, FRAME, table())
    poses = random_poses(lanes, 32, spread=1.0, sizes=(0.6, 2.5))
    body = Body(meshes, rng.integers(0, len(meshes), lanes), poses)
    camera = rng.uniform(-2.5, 2.5, (lanes, 3))
    camera[::5] = poses.position[::5] + 0.1
    turns = random_poses(lanes, 33).orientation
    observers = dataclasses.replace(Views.fixed((0, 0, 0)).spread(lanes), camera=camera, orientation=turns)
    order = rng.permutation(lanes)[:70]
    placed = place(body, observers.take(order), order)
    asked = rng.permutation(len(order))[:50]
    owner = np.repeat(order[asked], rays)
    ways = poses.position[owner] - camera[owner] + rng.normal(size=(len(owner), 3)) * 0.2
    directions = Rotation.from_quat(turns[owner]).inv().apply(ways)
    limits = rng.choice([0.5, 1.0, 2.0], (len(asked), 1)) * np.ones(rays)
    met = placed.first(np.repeat(asked, rays), directions, exact=True).reshape(-1, rays)
    outside = ~inside_body(placed)[asked]
    convex = np.array([mesh.is_convex for mesh in meshes])[body.choice[order[asked]]]
    all_met = (met <= limits).all(axis=1) & outside
    found = shadowed(placed, asked, directions.reshape(-1, rays, 3), limits)
    np.testing.assert_array_equal(found[convex], all_met[convex])
    assert not (found & ~all_met).any()
    assert found[~convex].any()
    assert 5 < (all_met & convex).sum() < convex.sum()
    assert (~outside).sum() > 3


def test_a_frame_before_all_corners_of_a_body_does_not_hide_it() -> None:
    """Nor when its middle is hidden by something little."""
    observer = Views.fixed((0, 0, 0), angles=(1.2, 1.2), count=(41, 41))
    target = fixed((0, 3.2, 0), (1.8, 0.1, 1.8))
    frame = Body((FRAME,), None, Poses.fixed((0, 3, 0), (0, 0, 0, 1), (2, 0.1, 2)))
    whole, little = fixed((0, 3, 0), (2, 0.1, 2)), fixed((0, 2, 0), (0.1, 0.1, 0.1))
    for occluders, seen in (
        ((frame,), True),
        ((frame, little), True),
        ((little, frame), True),
        ((whole,), False),
    ):
        assert sees(observer, target, *occluders) is seen


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_each_obstacle_counts_for_the_rays_of_its_lanes_whatever_others_do(order: tuple[int, ...]) -> None:
    """Those before it may hide nothing, or be near in other lanes alone."""
    rng = np.random.default_rng(6)
    # Each of three walls stands between camera and target in some of six lanes, and far off in the others.
    there = np.array([[1, 1, 0, 0, 0, 1], [0, 1, 1, 0, 0, 0], [0, 0, 1, 1, 0, 1]], dtype=bool)
    walls = []
    for number, lanes in enumerate(there):
        place = np.where(lanes[:, np.newaxis], [0.4 * number - 0.3, 10.0 + number, 0], [200.0, 10, 0])
        walls.append(
            Body((BOX,), None, Poses(place, np.array([[0.0, 0, 0, 1]]), np.array([[0.9, 0.2, 0.9]])))
        )
    observers = Views.fixed((0, 0, 0), distance=60).spread(6)
    middle, radius = np.array([[0.0, 30, 0]] * 6), np.full(6, 2.0)
    lane = rng.integers(0, 6, 400)
    ways = np.column_stack([rng.uniform(-2, 2, 400), np.full(400, 30.0), rng.uniform(-2, 2, 400)])

    def hidden(bodies: list[Body], rays: Indices) -> Booleans:
        obstacles = Obstacles([Occluder(body) for body in bodies], observers, np.arange(6), middle, radius)
        return obstacles.block(lane[rays], ways[rays], np.ones(len(rays)))

    for rays in (np.arange(400), *(np.flatnonzero(lane == one) for one in range(6))):
        each = np.array([hidden([wall], rays) for wall in walls])
        assert hidden([walls[place] for place in order], rays).tolist() == each.any(axis=0).tolist()
    assert 0.1 < hidden(walls, np.arange(400)).mean() < 0.9
