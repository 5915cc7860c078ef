"""Proofs of visibility against the rays, which are a sample of what is proved."""

import dataclasses

import numpy as np

from scenic.runtime.geometry.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.visibility.bodies import sees_bodies
from scenic.runtime.geometry.visibility.obstacles import Occluder
from scenic.runtime.geometry.visibility.proofs import inner_boxes
from scenic.runtime.geometry.visibility.proving import Proof, prove
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
