"""What observers have in view as regions: distances, boxes, bodies within and across the border, places nearby."""

import math

import numpy as np
import pytest

import scenic
from scenic.runtime.regions.base import everywhere
from scenic.runtime.regions.views import NearView
from tests.runtime.test_sight import answers, view

TURNED = (
    "ego = new Object at (1, 2, 3), facing 90 deg, with viewAngles (60 deg, 40 deg), with visibleDistance 5\n"
)
"""Looks along -X from (1, 2, 3)."""


def test_distances_are_to_the_view_and_nothing_within_it() -> None:
    text = TURNED + (
        "view = ego.visibleRegion\n"
        # Between the corners of the mesh by which distances are measured.
        "a, r = 1.5 deg, 4.999\n"
        "param edge = view.distanceTo((1 - r * cos(a) * cos(a), 2 - r * sin(a) * cos(a), 3 + r * sin(a)))\n"
        "param within = view.distanceTo((-3.999, 2, 3)), before = view.distanceTo((-7, 2, 3)), "
        "behind = view.distanceTo((9, 2, 3)), beside = view.distanceTo((1, 6, 3))\n"
    )
    found = answers(text)
    assert (found.pop("within"), found.pop("edge")) == (0, 0)
    assert found == pytest.approx(
        {"before": 3, "behind": 8, "beside": 4 * math.cos(math.radians(30))}, abs=0.02
    )


def test_a_view_has_a_box() -> None:
    (scene,) = scenic.scenarioFromString(TURNED).sample(1, seed=1)
    low, high = scene.egoObject.visibleRegion.AABB
    assert (tuple(low), tuple(high)) == ((-4, -3, -2), (6, 7, 8))


@pytest.mark.parametrize(
    ("asked", "meets"),
    [
        ("view.intersects({})", {"across": True, "out": False, "near": True}),
        ("({} intersects view)", {"across": True, "out": False, "near": True}),
        ("({}.occupiedSpace intersects view)", {"across": True, "out": False, "near": True}),
        ("BoxRegion(position={}.position).intersects(view)", {"across": True, "out": False, "near": True}),
        ("CircularRegion({}.position, 0.5).intersects(view)", {"across": True, "out": False, "near": True}),
        ("{}.visibleRegion.intersects(view)", {"across": True, "out": True, "near": True}),
    ],
)
def test_what_lies_across_the_border_meets_a_view(asked: str, meets: dict[str, bool]) -> None:
    text = TURNED + "view = ego.visibleRegion\n"
    for name, x in (("across", -4.2), ("out", -4.6), ("near", -2)):
        text += f"{name} = new Object at ({x}, 2, 3), with allowCollisions True, with visibleDistance 0.7\n"
        text += f"param {name} = {asked.format(name)}\n"
    assert answers(text) == meets


def test_whether_something_moving_meets_a_view_is_a_requirement() -> None:
    text = (
        TURNED
        + "box = new Object at (Range(-8, -3), 2, 3), with allowCollisions True\nrequire {}box intersects ego.visibleRegion\n"
    )
    for word in ("", "not "):
        places = [
            scene.objects[1].position.x
            for scene in scenic.scenarioFromString(text.format(word)).sample(40, seed=1)
        ]
        assert all((x > -4.5) is (word == "") for x in places)


def test_bodies_in_views_of_random_angles_are_within_them() -> None:
    text = (
        "ego = new Object facing Range(0, 360) deg, with viewAngles (Uniform(50, 100) deg, Uniform(40, 80) deg), "
        "with visibleDistance Range(6, 8)\n"
        "box = new Object at (Range(-6, 6), Range(-6, 6), Range(-2, 2)), facing Range(0, 360) deg, "
        "with width Range(0.5, 2), with allowCollisions True\n"
        "require box in ego.visibleRegion\n"
    )
    scenes = scenic.scenarioFromString(text).sample(40, seed=1)
    for scene in scenes:
        corners = np.array([list(corner) for corner in scene.objects[1].corners])
        assert view(scene.egoObject).contain(corners).all()
    angles = {tuple(np.round(np.degrees(scene.egoObject.viewAngles))) for scene in scenes}
    assert len(angles) > 2


def test_tall_things_may_be_farther_off_than_sight_reaches() -> None:
    text = (
        "ego = new Object with visibleDistance 10, with viewAngles (90 deg, 90 deg)\n"
        "new Object visible, with height 8, with width 0.5, with length 0.5\n"
    )
    scenes = scenic.scenarioFromString(text).sample(200, seed=1)
    distances = [np.linalg.norm(list(scene.objects[1].position)) for scene in scenes]
    assert 11 < max(distances) < 10 + math.sqrt(16 + 0.125)


def test_places_near_a_view_reach_as_far_as_the_thing_does() -> None:
    text = (
        "ego = new Object with visibleDistance 10, with viewAngles (90 deg, 90 deg)\n"
        "new Object at (0, 20, 0), with width 4, with length 4, with height 2\n"
    )
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=1)
    ego, thing = scene.objects
    near = NearView(everywhere, ego, thing)
    assert [near.containsPoint((0, y, 0)) for y in (9.9, 12.9, 13.1)] == [True, True, False]


def test_where_few_places_fit_they_are_drawn_again_and_no_scene_is_lost() -> None:
    """In the corner of a large hall an eighth of what is near is within the hall."""
    text = (
        "workspace = Workspace(BoxRegion((40, 40, 40), position=(20, 20, 20)))\n"
        "spot = new Point at (0.01, 0.01, 0.01), with visibleDistance 8\n"
        "new Object visible from spot, with width 0.1, with length 0.1, with height 0.1\n"
    )
    scenes = scenic.scenarioFromString(text).sample(60, seed=1)
    assert sum(scene.attempts for scene in scenes) < 1.6 * 60


def test_places_near_a_view_are_in_the_container_and_within_reach() -> None:
    from scenic.runtime.geometry import primitives
    from scenic.runtime.geometry.bodies import Body
    from scenic.runtime.geometry.poses import Poses
    from scenic.runtime.regions.views import NearView
    from scenic.runtime.regions.volumes import BoxRegion
    from tests.runtime.programs import thing

    observer = thing("ego = new Object at (4, -3, 2), with visibleDistance 5, with viewAngles (1, 1)")
    seen = thing("ego = new Object with width 2, with length 4, with height 4")
    container = BoxRegion((9, 9, 9), (1, 1, 1))
    near = NearView(container, observer, seen)
    columns = near.fixed_columns("a test")
    rng = np.random.default_rng(3)
    points = rng.uniform(-9, 9, (3000, 3))
    camera = np.array([4, -3, 2])  # no camera offset by default
    inside = (np.abs(points - 1) <= 4.5).all(axis=1) & (np.linalg.norm(points - camera, axis=1) <= 5 + 3)
    np.testing.assert_array_equal(near.contains_points(points, *columns), inside)
    assert 100 < inside.sum() < 1500
    body = Body(
        (primitives.box(),), None, Poses(points, np.array([[0.0, 0, 0, 1]]), np.array([[0.5, 1, 0.2]]))
    )
    corners = points[:, None] + np.array(
        [(x, y, z) for x in (-0.25, 0.25) for y in (-0.5, 0.5) for z in (-0.1, 0.1)]
    )
    held = (np.abs(corners - 1) <= 4.5).all(axis=(1, 2)) & (
        np.linalg.norm(corners - camera, axis=2) <= 8
    ).all(axis=1)
    np.testing.assert_array_equal(near.contains_bodies(body, 3000, *columns), held)
