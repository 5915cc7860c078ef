"""Proofs of visibility against the rays, which are a sample of what is proved."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.booleans import difference
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.views.observers import Views
from scenic.runtime.geometry.views.occluders import Occluder
from scenic.runtime.geometry.views.occlusion_proofs import inner_boxes
from scenic.runtime.geometry.views.seen_bodies import sees_bodies
from scenic.runtime.geometry.views.subdivision import Proof, _Cells, prove
from tests.runtime.geometry.views.reference import winding
from tests.runtime.geometry.views.test_seen_bodies import BOX, FRAME, fixed, quaternions, scenes


def _window() -> Mesh:
    """A unit wall with a small hole in its middle."""
    made = difference(BOX, [Mesh(BOX.vertices * [0.05, 2, 0.05], BOX.faces)])
    assert made is not None
    return made.normalized()[0]


WINDOW = _window()


def test_rays_see_nothing_that_is_proved_hidden_and_miss_little() -> None:
    count = 500
    observers, target, occluders = scenes(21, count)
    # The default density; proofs do not depend on it.
    observers = dataclasses.replace(
        observers, density=np.full(count, 5.0), count=np.zeros((count, 2)), scaling=np.zeros(count, bool)
    )
    seen = sees_bodies(observers, target, occluders, count)
    proved = prove(observers, target, occluders, count, most_cells=1024)
    wrong = int((seen & (proved == Proof.HIDDEN)).sum())
    missed = int((~seen & (proved == Proof.SEEN)).sum())
    visible = int((proved == Proof.SEEN).sum())
    print(f"{visible} seen, {missed} of them missed by rays; {(proved == Proof.OPEN).sum()} open")
    assert wrong == 0
    assert missed <= 0.01 * visible
    assert visible > 100
    assert (proved == Proof.HIDDEN).sum() > 100
    assert (proved == Proof.OPEN).sum() < 0.05 * count


def proof(observer: Views, target: Body, *occluders: Body) -> int:
    return int(prove(observer, target, [Occluder(item) for item in occluders], 1)[0])


def test_two_overlapping_walls_are_proved_to_hide() -> None:
    observer, target = Views.fixed((0, 0, 0)), fixed((0, 10, 0), (4, 1, 1))
    left, right = fixed((-2, 5, 0), (4.2, 0.1, 4)), fixed((2, 5.3, 0), (4.2, 0.1, 4))
    assert proof(observer, target, left, right) == Proof.HIDDEN
    assert proof(observer, target, left) == Proof.SEEN


def test_a_slit_narrower_than_the_rays_is_found() -> None:
    observer = Views.fixed((0, 0, 0), count=(1800, 900))
    left, right = fixed((-2.0007, 5, 0), (4, 0.1, 4)), fixed((2.0007, 5, 0), (4, 0.1, 4))
    target = fixed((0.8, 10, 0), (2, 1, 1))
    assert not sees_bodies(observer, target, [Occluder(left), Occluder(right)], 1)[0]
    assert proof(observer, target, left, right) == Proof.SEEN


def test_walls_that_only_touch_leave_the_question_open() -> None:
    observer, target = Views.fixed((0, 0, 0)), fixed((0, 10, 0), (4, 1, 1))
    left, right = fixed((-2, 5, 0), (4, 0.1, 4)), fixed((2, 5, 0), (4, 0.1, 4))
    assert proof(observer, target, left, right) == Proof.OPEN


def test_a_solid_that_is_not_convex_hides_by_boxes_inside_it() -> None:
    boxes = FRAME.derived(inner_boxes)
    assert len(boxes) >= 4
    corners = np.array(
        [[box[i, 0], box[j, 1], box[k, 2]] for box in boxes for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    )
    middle = np.repeat(boxes.mean(axis=1), 8, axis=0)
    assert (winding(corners + 1e-6 * (middle - corners), FRAME.triangles) > 0.5).all()
    frame = Body((FRAME,), None, Poses.fixed((0, 5, 0), size=(8, 1, 8)))
    beside = Views.fixed((3.4, 0, 0))
    assert proof(beside, fixed((3.4, 10, 0), (0.3, 0.3, 0.3)), frame) == Proof.HIDDEN
    assert proof(Views.fixed((0, 0, 0)), fixed((0, 10, 0)), frame) == Proof.SEEN


def test_what_surrounds_the_observer_is_divided_all_around() -> None:
    ring = Body((FRAME,), None, Poses.fixed((0, 0, 0), (np.sqrt(0.5), 0, 0, np.sqrt(0.5)), size=(9, 1, 9)))
    assert proof(Views.fixed((0, 0, 0)), ring) == Proof.SEEN
    assert proof(Views.fixed((0, 0, 0), distance=2), ring) == Proof.HIDDEN


def test_what_stands_behind_or_in_a_body_hides_nothing_of_it() -> None:
    """Also of one whose middle is not part of it, however near behind its nearest part that is."""
    observer = Views.fixed((0, 0, 0))
    frame = Body((FRAME,), None, Poses.fixed((0, 10, 0), size=(4, 1, 4)))
    for behind in (10.6, 12, 15, 25):
        assert proof(observer, frame, fixed((0, behind, 0), (40, 0.1, 40))) == Proof.SEEN
    assert proof(observer, frame, fixed((0, 9.4, 0), (40, 0.1, 40))) == Proof.HIDDEN
    # A wall in the middle of it hides the half that is behind.
    assert proof(observer, frame, fixed((0, 10, 0), (40, 0.1, 40))) == Proof.SEEN


def test_the_corners_of_a_cell_have_all_of_it_between_them() -> None:
    """Every direction of a cell is a sum of its corners with no negative part, and the cell is hardly smaller."""
    rng = np.random.default_rng(2)
    count = 500
    azimuth = rng.uniform(-np.pi, np.pi, (count, 1)) + np.array([[0, 1]]) * rng.uniform(
        0.01, 0.35, (count, 1)
    )
    low = rng.uniform(-1.5, 1.4, (count, 1))
    altitude = np.concatenate([low, np.minimum(low + rng.uniform(0.01, 0.35, (count, 1)), 1.55)], axis=1)
    cells = _Cells(np.arange(count), azimuth, altitude)
    corners = cells.corners()
    # On the inner side of the planes through neighbouring corners, which run anticlockwise as seen from the camera.
    normals = np.cross(corners, np.roll(corners, -1, axis=1))
    middle = cells.middles()
    inner = np.sign((normals * middle[:, np.newaxis]).sum(axis=2))
    assert (inner == inner[:, :1]).all()
    for u in np.linspace(0, 1, 9):
        for v in np.linspace(0, 1, 9):
            a, b = (1 - u) * azimuth[:, 0] + u * azimuth[:, 1], (1 - v) * altitude[:, 0] + v * altitude[:, 1]
            way = np.stack([-np.sin(a) * np.cos(b), np.cos(a) * np.cos(b), np.sin(b)], axis=1)
            assert ((normals * way[:, np.newaxis]).sum(axis=2) * inner >= -1e-12).all()
    quarters = cells.quartered()
    assert len(quarters.lane) == 4 * count
    area = np.diff(np.sin(altitude), axis=1)[:, 0] * np.diff(azimuth, axis=1)[:, 0]
    parts = np.diff(np.sin(quarters.altitude), axis=1)[:, 0] * np.diff(quarters.azimuth, axis=1)[:, 0]
    np.testing.assert_allclose(np.bincount(quarters.lane, parts), area)


def test_what_shows_through_a_frame_is_seen_though_the_corners_of_its_box_are_hidden() -> None:
    """A frame hides by one of its bars what that hides, not by all of them together what is in its hole."""
    observer = Views.fixed((0, 0, 0))
    before = Body((FRAME,), None, Poses.fixed((0, 5, 0), size=(4, 0.2, 4)))
    behind = Body((FRAME,), None, Poses.fixed((0, 10, 0), size=(6.8, 1, 6.8)))
    assert proof(observer, behind, before) == Proof.SEEN
    assert sees_bodies(observer, behind, [Occluder(before)], 1)[0]
    full = fixed((0, 5, 0), (4, 0.2, 4))
    assert proof(observer, behind, full) == Proof.HIDDEN


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("axis", [0, 2])
def test_what_shows_only_beside_a_narrow_view_is_hidden(axis: int, side: int) -> None:
    """A screen covers the view, or leaves a thousandth of it open on the side to which the body reaches out of it."""
    observer = Views.fixed((0, 0, 0), angles=(0.5, 0.5))
    place, size = np.array([0.0, 10, 0]), np.array([2.0, 0.2, 2.0])
    place[axis], size[axis] = side * 5.0, 9.0
    size[2 - axis] = 1e-3  # only about the middle of a view its upper and lower borders are level
    target = fixed(tuple(place), tuple(size))
    edge = 4.95 * np.tan(0.25)  # of the view, at the front of the screen
    for off, expected in ((1e-6, Proof.HIDDEN), (-1e-3, Proof.SEEN)):
        middle, extent = np.array([0.0, 5, 0]), np.array([6.0, 0.1, 6.0])
        middle[axis], extent[axis] = side * ((edge + off) - 2.0), 4.0
        assert proof(observer, target, fixed(tuple(middle), tuple(extent))) == expected
    beside = np.array([0.0, 10, 0])
    for off, expected in ((1e-6, Proof.HIDDEN), (-1e-3, Proof.SEEN)):
        beside[axis] = side * (10.5 * np.tan(0.25) + off + 0.5)
        assert proof(observer, fixed(tuple(beside), (size[0] if axis else 1, 1, 1))) == expected


@pytest.mark.parametrize("gap", [1e-6, 1e-3, 0.2])
def test_only_what_begins_before_a_body_hides_it(gap: float) -> None:
    for reach, seen in ((50.0, Proof.SEEN), (9.5 + gap / 2, Proof.SEEN), (9.5 - gap / 2, Proof.HIDDEN)):
        observer = Views.fixed((0, 0, 0), angles=(1.0, 1.0), distance=reach)
        target = fixed((0, 10, 0), (1, 1, 1))
        assert proof(observer, target) == seen
        for off, expected in ((gap, seen), (-gap, Proof.HIDDEN)):
            assert proof(observer, target, fixed((0, 9.5 + off + 0.2, 0), (30, 0.4, 30))) == expected


def test_lanes_are_proved_alone_as_together() -> None:
    """Lanes that differ in the mesh, the size, the angle or the place of what hides, each for itself and all at once.

    These are more than are looked at together.
    """
    count = 80
    rng = np.random.default_rng(8)
    position = np.tile([0.0, 10, 0], (count, 1)) + rng.normal(size=(count, 3)) * 2
    size = rng.uniform(0.5, 3, (count, 3))
    poses = Poses(position, quaternions(rng, count), size)
    target = Body((FRAME, BOX), np.arange(count) % 2, poses)
    walls = Poses(0.5 * position + rng.normal(size=(count, 3)) * 0.3, quaternions(rng, count), 0.7 * size)
    wall = Body((BOX, FRAME), np.arange(count) // 2 % 2, walls)
    observers = Views.fixed((0, 0, 0), angles=(0.4, 0.3)).spread(count)
    together = prove(observers, target, [Occluder(wall)], count, most_cells=256)
    assert {Proof.HIDDEN, Proof.SEEN} <= set(together.tolist())
    for lane in [*range(0, 64, 8), *range(64, count)]:
        one = np.array([lane])
        alone = [
            Body((body.meshes[body.choice[lane]],), None, body.poses.take(one)) for body in (target, wall)
        ]
        found = prove(observers.take(one), alone[0], [Occluder(alone[1])], 1, most_cells=256)
        assert found[0] == together[lane]


@pytest.mark.parametrize("turn", [0.0, 2.0])
def test_what_shows_only_beyond_the_range_is_not_seen(turn: float) -> None:
    """A long wall goes out of range; a screen hides what of it is within, or a little less."""
    frame = Rotation.from_euler("z", turn)

    def turned(place: tuple[float, ...], size: tuple[float, ...]) -> Body:
        return Body((BOX,), None, Poses.fixed(frame.apply(place), frame.as_quat(), size))

    observer = Views.fixed((0, 0, 0), distance=10.0)
    wall = turned((-3, 17, 0), (0.2, 30, 1))
    # The end of the range, along the side of the wall that faces the observer.
    end = np.sqrt(100 - 2.9**2)
    for off, expected in ((0.05, False), (-1.5, True)):
        edge = 1.0 * 2.9 / (end + off)  # at a metre ahead, the screen reaches from the left to there
        screen = turned((-edge - 5, 1.005, 0), (10, 0.01, 20))
        assert (proof(observer, wall, screen) == Proof.SEEN) is expected
    assert proof(Views.fixed((0, 0, 0), distance=40.0), wall, screen) == Proof.SEEN


def test_each_lane_is_covered_by_the_boxes_of_its_own_mesh() -> None:
    """Through a small window only the middle of the target shows, which a frame does not have."""
    window = Body((WINDOW,), None, Poses.fixed((0, 5, 0), size=(8, 0.1, 8)))
    poses = Poses(
        np.tile([0.0, 10, 0], (6, 1)), np.tile([0.0, 0, 0, 1], (6, 1)), np.tile([4.0, 1, 4], (6, 1))
    )
    choice = np.array([0, 1, 1, 0, 0, 1])
    for meshes, seen in (((BOX, FRAME), 0), ((FRAME, BOX), 1)):
        found = prove(Views.fixed((0, 0, 0)), Body(meshes, choice, poses), [Occluder(window)], 6)
        assert found.tolist() == [Proof.SEEN if number == seen else Proof.HIDDEN for number in choice]


@pytest.mark.parametrize("axis", [0, 2])
@pytest.mark.parametrize("side", [-1, 1])
def test_what_is_behind_the_observer_hides_nothing(axis: int, side: int) -> None:
    """Within a frame, the backward ways to a body meet the bar behind, and the forward ones pass the bar ahead."""
    way = np.zeros(3)
    way[1], way[axis] = 10, side * 3
    turn = Rotation.from_euler("x" if axis else "z", 90, degrees=True)
    around = Body((FRAME,), None, Poses.fixed((0, 1.5, 0), turn.as_quat(), (7, 1, 7)))
    target, dot = fixed(tuple(way), (0.5, 0.5, 0.5)), fixed(tuple(0.9 * way), (0.2, 0.2, 0.2))
    observer = Views.fixed((0, 0, 0))
    for occluders in ((around,), (around, dot)):  # which hides the middle of the target
        assert proof(observer, target, *occluders) == Proof.SEEN
        assert sees_bodies(observer, target, [Occluder(item) for item in occluders], 1)[0]
