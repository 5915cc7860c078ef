"""Proofs of visibility against the rays, which are a sample of what is proved."""

import dataclasses

import numpy as np

from scenic.runtime.geometry.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.visibility.bodies import sees_bodies
from scenic.runtime.geometry.visibility.obstacles import Occluder
from scenic.runtime.geometry.visibility.proofs import inner_boxes
from scenic.runtime.geometry.visibility.proving import Proof, _Cells, prove
from scenic.runtime.geometry.visibility.views import Views
from tests.runtime.geometry.visibility.reference import winding
from tests.runtime.geometry.visibility.test_bodies import FRAME, fixed, scenes


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
