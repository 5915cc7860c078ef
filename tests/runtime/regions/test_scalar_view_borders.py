"""Views of observers on plain floats, right beside where they change: see `tests.runtime.regions.test_scalar_borders`."""

import math
from collections.abc import Callable

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.contact.scalar_bodies import PlacedBody, Triple, axes_of, placed
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats
from scenic.runtime.geometry.views.scalar_views import View, sees_body, sees_point
from tests.runtime.boundaries import CENTIMETRE, HAIR, compare, flip

TURN = Rotation.from_euler("ZXY", (0.7, 0.3, -0.2))
CAMERA = np.array([1.0, -2.0, 0.5])
REACH = 6.0
WINDOWS = [(1.5, 1.0), (0.8, math.pi), (4.0, 0.6), (2 * math.pi, 0.7), (2 * math.pi, math.pi)]


def triple(point: Floats) -> Triple:
    x, y, z = point.tolist()
    return x, y, z


def view(angles: tuple[float, float], distance: float = REACH) -> View:
    x, y, z, w = TURN.as_quat().tolist()
    return View(triple(CAMERA), axes_of((x, y, z, w)), angles, distance)


def shown(points: Floats, angles: tuple[float, float]) -> Floats:
    """Which points ``(n, 3)`` lie within range and angles."""
    x, y, z = TURN.inv().apply(points - CAMERA).T
    azimuth, altitude = np.arctan2(-x, y), np.arctan2(z, np.hypot(x, y))
    near = np.sqrt(x * x + y * y + z * z) <= REACH
    held: Floats = near & (np.abs(azimuth) <= angles[0] / 2) & (np.abs(altitude) <= angles[1] / 2)
    return held


@pytest.mark.parametrize("angles", WINDOWS)
def test_points_that_nearly_leave_a_view(angles: tuple[float, float]) -> None:
    random = np.random.default_rng(1)
    start = TURN.apply([0.1, 2.5, 0.1]) + CAMERA
    looking = view(angles)
    for way in random.normal(size=(40, 3)) / 2:

        def truth(along: float, way: Floats = way) -> bool:
            return bool(shown((start + along * way)[np.newaxis], angles)[0])

        def answer(along: float, way: Floats = way) -> bool | None:
            return looking.contains(triple(start + along * way))

        # The first change on the way: there may be several.
        places = np.linspace(0, 40, 400).tolist()
        last = next(number for number, place in enumerate(places) if not truth(place))
        change = flip(truth, places[last - 1], places[last])
        compare(answer, truth, change, certain=True)
        assert sees_point(looking, triple(start + change * way), []) is None
    assert looking.contains(triple(CAMERA)) is not True
    if angles[0] < 6 and angles[1] > 3:  # above the camera all azimuths are the same
        assert looking.contains(triple(TURN.apply([0, 0, 2]) + CAMERA)) is None


@pytest.mark.parametrize(("gap", "seen"), [(0.016, True), (0.018, False)])
def test_what_is_nearly_all_around_counts_as_that(gap: float, seen: bool) -> None:
    looking = view((2 * math.pi - gap, math.pi - gap))
    for way in ([0.001, -3, 0.1], [-0.001, -3, -0.1], [0, 0.001, 3], [0, 0.001, -3]):
        point = triple(TURN.apply(way) + CAMERA)
        assert looking.contains(point) is seen
        assert looking.meets_ball(point, 0.001) is (None if seen else False)


@pytest.mark.parametrize("angles", WINDOWS)
def test_balls_that_reach_into_a_view(angles: tuple[float, float]) -> None:
    random = np.random.default_rng(2)
    points = CAMERA + random.uniform(-REACH, REACH, (6000, 3))
    points = points[shown(points, angles)][:600]
    assert len(points) > 100
    looking, outside = view(angles), 0
    for point, way, radius in zip(
        points, random.normal(size=(len(points), 3)), random.uniform(0.01, 5, len(points)), strict=True
    ):
        # On the way out of the view, the ball still touches the point where it left.
        centre = point + (1 - 1e-9) * radius * way / np.linalg.norm(way)
        assert looking.meets_ball(triple(centre), radius) is None
        outside += not shown(centre[np.newaxis], angles)[0]
    assert outside > 40
    far = TURN.apply([0, REACH + 1.1, 0]) + CAMERA
    assert looking.meets_ball(triple(far), 1.0) is False
    assert looking.meets_ball(triple(far), 1.2) is None
    if angles[0] < 6:
        assert looking.meets_ball(triple(TURN.apply([0, -2, 0]) + CAMERA), 0.05) is False
    if angles[1] < 3:
        assert looking.meets_ball(triple(TURN.apply([0, 0.1, 2]) + CAMERA), 0.5) is False
        assert looking.meets_ball(triple(TURN.apply([0, 0.1, -2]) + CAMERA), 0.5) is False


BOX = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
SIDES = (0.5, 1.2, 0.3)
LEANING = Rotation.from_euler("ZXY", (-0.5, 0.4, 0.9))


def leaning(place: Floats, size: Triple = SIDES, mesh: Mesh | None = None) -> PlacedBody:
    x, y, z, w = LEANING.as_quat().tolist()
    return placed(triple(place), (x, y, z, w), size, primitives.box() if mesh is None else mesh)


def blocks(place: Floats, end: Floats, size: Triple = SIDES) -> bool:
    """Whether a leaning box at a place meets the segment from the camera to an end."""
    start, stop = (LEANING.inv().apply(point - place) / size for point in (CAMERA, end))
    low, high = 0.0, 1.0
    for begin, finish in zip(start.tolist(), stop.tolist(), strict=True):
        ends = sorted(((-0.5 - begin) / (finish - begin), (0.5 - begin) / (finish - begin)))
        low, high = max(low, ends[0]), min(high, ends[1])
    return low <= high


def moved(mesh: Mesh | None = None) -> list[tuple[Callable[[float], bool], Callable[[float], bool | None]]]:
    """Occluders that leave the way to a point in all directions: whether they block it, and what is said of it."""
    random = np.random.default_rng(3)
    end = TURN.apply([0.2, 4.0, 0.3]) + CAMERA
    looking, cases = view((2 * math.pi, math.pi)), []
    along = (end - CAMERA) / np.linalg.norm(end - CAMERA)
    for number, way in enumerate([along, -along, *random.normal(size=(30, 3))]):
        middle = CAMERA + (end - CAMERA) * (0.3 + 0.01 * number)

        def truth(far: float, way: Floats = way, middle: Floats = middle) -> bool:
            return blocks(middle + far * way, end)

        def answer(far: float, way: Floats = way, middle: Floats = middle) -> bool | None:
            seen = sees_point(looking, triple(end), [leaning(middle + far * way, mesh=mesh)])
            return None if seen is None else not seen

        cases.append((truth, answer))
    return cases


def test_boxes_that_nearly_hide_a_point() -> None:
    for number, (truth, answer) in enumerate(moved()):
        # The second one moves over the camera: from within a box it is not certain what is seen.
        compare(answer, truth, flip(truth, 0, 20), certain=number != 1)
        assert answer(0) is True
        assert answer(20) is False


def test_other_shapes_hide_nothing_for_certain() -> None:
    for truth, answer in moved(primitives.spheroid()):
        change = flip(truth, 0, 20)
        assert answer(0) is None
        assert answer(change + CENTIMETRE) is False


def test_two_boxes_of_which_one_is_uncertain() -> None:
    end = TURN.apply([0.2, 4.0, 0.3]) + CAMERA
    middle = (CAMERA + end) / 2
    looking = view((2 * math.pi, math.pi))
    ball, box, far = leaning(middle, mesh=primitives.spheroid()), leaning(middle), leaning(middle + 9)
    for items, seen in (([ball, far], None), ([far, ball], None), ([ball, box], False), ([far], True)):
        assert sees_point(looking, triple(end), items) is seen


def test_walls_that_nearly_hide_a_body() -> None:
    random = np.random.default_rng(4)
    target = leaning(TURN.apply([0, 5.0, 0]) + CAMERA, (0.6, 0.4, 0.8))
    corners = np.array(target.corners())
    looking = view((2 * math.pi, math.pi), 20.0)
    sides = (4.0, 4.5, 3.5)
    middle = TURN.apply([0, 3.0, 0]) + CAMERA
    for way in random.normal(size=(20, 3)):
        way[:] = TURN.apply([way[0], 0, way[2]]) / np.hypot(way[0], way[2])

        def truth(far: float, way: Floats = way) -> bool:
            return all(blocks(middle + far * way, corner, sides) for corner in corners)

        def answer(far: float, way: Floats = way) -> bool | None:
            return sees_body(looking, target, [leaning(middle + far * way, sides)])

        assert answer(0) is False
        change = flip(truth, 0, 20)
        assert answer(change - CENTIMETRE) is False
        for off in (-HAIR, 0, HAIR, CENTIMETRE):
            assert answer(change + off) is not False
        assert answer(20) is True
        solid = leaning(middle, sides, primitives.spheroid())
        assert sees_body(looking, target, [solid]) is None


def test_a_corner_that_reaches_into_the_way_hides() -> None:
    """Of a cube, whose corners are farther from its middle than any of its sides; so do they show it."""
    diagonal = Rotation.align_vectors([[0, 0, 1]], [[1, 1, 1]])[0]
    x, y, z, w = (TURN * diagonal).as_quat().tolist()
    end = TURN.apply([0, 4.0, 0]) + CAMERA
    looking = view((2 * math.pi, math.pi))
    for below, hidden in ((0.8, True), (0.9, False)):  # its upper corner is 0.866 above the middle
        place = triple(TURN.apply([0, 2.0, -below]) + CAMERA)
        cube = placed(place, (x, y, z, w), (1, 1, 1), primitives.box())
        assert sees_point(looking, triple(end), [cube]) is (not hidden)
    # The corner alone is above the lower border of the view.
    low = View(triple(CAMERA), view((1.0, 1.0)).axes, (1.0, 1.0), REACH)
    for below, open_question in ((0.8, True), (0.95, False)):
        place = triple(TURN.apply([0, 2.0, -below - 2 * math.tan(0.5)]) + CAMERA)
        cube = placed(place, (x, y, z, w), (1, 1, 1), primitives.box())
        assert low.contains(place) is False
        found = sees_body(low, cube, [])
        assert found is not True
        assert (found is None) or not open_question


@pytest.mark.parametrize("axis", [0, 2])
@pytest.mark.parametrize("side", [1, -1])
def test_ways_along_a_face_are_blocked_within_it_alone(axis: int, side: int) -> None:
    """In it, up to rounding, nothing is certain."""
    looking = View((0.0, 0.0, 0.0), axes_of((0, 0, 0, 1)), (2 * math.pi, math.pi), REACH)
    for off, seen in ((-1e-3, False), (-5e-7, None), (0.0, None), (5e-7, None), (1e-3, True)):
        place = [0.0, 2.0, 0.0]
        place[axis] = side * (0.5 + off)
        cube = placed((place[0], place[1], place[2]), (0, 0, 0, 1), (1, 1, 1), primitives.box())
        assert sees_point(looking, (0.0, 4.0, 0.0), [cube]) is seen


def test_through_a_ring_nothing_of_it_may_be_seen() -> None:
    made = trimesh.creation.annulus(r_min=0.45, r_max=0.5, height=1.0)
    ring = Mesh(np.asarray(made.vertices), np.asarray(made.faces))
    x, y, z, w = Rotation.from_euler("X", math.pi / 2).as_quat().tolist()
    place = TURN.apply([0, 4.0, 0]) + CAMERA
    turned = (TURN * Rotation.from_quat((x, y, z, w))).as_quat().tolist()
    body = placed(triple(place), (turned[0], turned[1], turned[2], turned[3]), (2, 2, 0.2), ring)
    assert sees_body(view((0.05, 0.05)), body, []) is None
    whole = leaning(place)
    assert sees_body(view((0.05, 0.05)), whole, []) is True
    assert sees_body(view((0.05, 0.05)), leaning(TURN.apply([4.0, 4.0, 0]) + CAMERA), []) is False
