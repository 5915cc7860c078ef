"""What observers have in view as regions: distances, boxes, bodies within and across the border, places nearby."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import scenic
from scenic.runtime.geometry.containment import body_points
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions import view_regions as views
from scenic.runtime.regions.spaces import everywhere
from scenic.runtime.regions.view_regions import NearView, ViewRegion
from scenic.runtime.regions.volumes import BoxRegion
from tests.runtime.programs import params, scenario, thing
from tests.runtime.regions.test_visibility_nodes import answers, view

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


@pytest.mark.parametrize("asked", ["view.intersects({})", "{}.intersects(view)", "({} intersects view)"])
def test_things_at_the_edge_of_sight_meet_a_view_whoever_is_asked(asked: str) -> None:
    """Also between the corners of its mesh, which is smaller than the view is."""
    text = TURNED + "view = ego.visibleRegion\nfound = []\n"
    for reach, away in itertools.product((4.999, 5.001), (1.5, 4.5, 7.5)):
        text += (
            f"a, r = {away} deg, {reach}\n"
            "box = new Object at (1 - r * cos(a) * cos(a), 2 - r * sin(a) * cos(a), 3 + r * sin(a)), "
            "with width 1e-4, with length 1e-4, with height 1e-4, with allowCollisions True\n"
            f"found.append({asked.format('box.occupiedSpace')})\n"
        )
    assert answers(text + "param found = found\n")["found"] == [True] * 3 + [False] * 3


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


def test_each_observer_is_asked_of_the_shape_of_its_lane() -> None:
    """Views of all around or of one half hold a cone at a fixed place, and not the box about it."""
    view = ViewRegion(2, (2 * math.pi, math.pi))
    camera, turn, _, vertical, _ = view.fixed_columns("a test")
    angles, shape = np.array([1, 1, 2, 2, 1, 2, 1]) * np.pi, np.array([0, 1, 0, 1, 1, 1, 0])
    body = Body((primitives.box(), primitives.cone()), shape, Poses.fixed((0, 1, 0), size=(1, 1, 2)))
    held = view.contains_bodies(body, 7, camera, turn, angles, vertical, np.full(1, 1.83))
    np.testing.assert_array_equal(held, shape == 1)


def test_a_wire_too_thin_to_be_found_reaches_into_a_view() -> None:
    """Where the search ends undecided, a body may be there; beside the view, where it ends sooner, it is not."""
    view, turn = ViewRegion(5, (1.0, 0.7)), Rotation.from_euler("ZYX", [0.1, 0.2, 0.3]).as_quat()
    columns = view.fixed_columns("a test")
    for x, meets in ((1.9, True), (5.5, False)):
        wire = Body((primitives.box(),), None, Poses.fixed((x, 3, 0.1), turn, (4, 1e-9, 1e-9)))
        assert view.meets_bodies(wire, 1, *columns).tolist() == [meets]


@pytest.mark.parametrize("angles", [(1e-3, 1e-3), (1e-3, 1), (2, 1e-4), (2 * math.pi - 1e-3, math.pi - 1e-3)])
def test_points_of_very_narrow_and_very_wide_views_are_in_them(angles: tuple[float, float]) -> None:
    region = ViewRegion(4, angles, position=(1, 2, 3))
    columns = region.fixed_columns("a test")
    random = np.random.default_rng(6)
    keys = random.integers(0, 1 << 63, 500, dtype=np.uint64)
    points, _ = region.draw_points(random.random((region.draws, 500)), keys, *columns)
    assert region.contains_points(points, *columns).all()


def test_tall_things_may_be_farther_off_than_sight_reaches() -> None:
    text = (
        "ego = new Object with visibleDistance 10, with viewAngles (90 deg, 90 deg)\n"
        "new Object visible, with height 8, with width 0.5, with length 0.5\n"
    )
    scenes = scenic.scenarioFromString(text).sample(200, seed=1)
    distances = [np.linalg.norm(list(scene.objects[1].position)) for scene in scenes]
    assert 11 < max(distances) < 10 + math.sqrt(16 + 0.125)


def test_in_space_things_are_visible_above_and_below_a_flat_workspace() -> None:
    text = (
        "workspace = Workspace(RectangularRegion((0, 0), 0, 16, 12))\n"
        "ego = new Object with visibleDistance 5\nnew Object visible, with width 0.5, with requireVisible False\n"
    )
    places = np.array(
        [list(scene.objects[1].position) for scene in scenic.scenarioFromString(text).sample(80, seed=1)]
    )
    assert (np.abs(places[:, :2]) <= (7.75, 5.5)).all()
    assert places[:, 2].min() < -3
    assert places[:, 2].max() > 3


def test_places_near_a_view_reach_as_far_as_the_thing_does() -> None:
    text = (
        "ego = new Object with visibleDistance 10, with viewAngles (90 deg, 90 deg)\n"
        "new Object at (0, 20, 0), with width 4, with length 4, with height 2\n"
    )
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=1)
    near = NearView(everywhere, *scene.objects)
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


def _observer_and_seen() -> tuple[Any, Any]:
    return (
        thing("ego = new Object at (4, -3, 2), with visibleDistance 5, with viewAngles (1, 1)"),
        thing("ego = new Object with width 2, with length 4, with height 4"),
    )


def test_places_near_a_view_are_in_the_container_and_within_reach() -> None:
    observer, seen = _observer_and_seen()
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


def test_places_near_a_view_are_drawn_from_the_container_of_their_lane(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A small cone whose box has to be drawn from again in most lanes, in each about another place."""
    monkeypatch.setattr(body_points, "TRIES", 1)
    cone = thing("ego = new Object with shape ConeShape()").occupiedSpace
    near = NearView(cone, *_observer_and_seen())
    position, *rest = near.fixed_columns("a test")
    random, lanes = np.random.default_rng(5), 40
    places = position + 3.0 * np.arange(lanes)[:, np.newaxis] * (0, 0, 1)
    keys = random.integers(0, 1 << 63, lanes, dtype=np.uint64)
    points, found = near.draw_points(random.random((near.draws, lanes)), keys, places, *rest)
    assert found is not None
    assert found.all()
    assert (np.abs(points - places) <= 0.5).all()
    assert cone.contains_points(points - places + position, position, *rest[:3]).all()


def test_places_near_a_view_are_drawn_in_each_lane_as_if_it_were_alone() -> None:
    """Of boxes that are smaller than the view, or hold most of it; observers, ranges, angles and sizes differ."""
    near = NearView(BoxRegion((1, 1, 1)), *_observer_and_seen())
    random, lanes = np.random.default_rng(9), 40
    small = np.arange(lanes) % 3 == 0
    side = np.where(small[:, np.newaxis], 2.0, random.uniform(20, 60, (lanes, 3)))
    middle = random.uniform(-3, 3, (lanes, 3))
    turn = random.normal(size=(lanes, 4))
    columns = [np.repeat(column, lanes, axis=0) for column in near.fixed_columns("a test")]
    columns[:2] = side, middle
    columns[-6:] = (
        middle + random.uniform(-0.5, 0.5, (lanes, 3)) * side,
        turn / np.linalg.norm(turn, axis=1, keepdims=True),
        random.uniform(0.3, 6, lanes),
        random.uniform(0.3, 3, lanes),
        random.uniform(4, 9, lanes),
        random.uniform(0.1, 4, lanes),
    )
    keys = random.integers(0, 1 << 63, lanes, dtype=np.uint64)
    uniforms = random.random((near.draws, lanes))
    points, found = near.draw_points(uniforms, keys, *columns)
    assert found is not None
    assert found.all()
    assert (np.abs(points - middle) <= side / 2).all()
    assert near.contains_points(points, *columns)[~small].all()
    for lane in range(lanes):
        one = slice(lane, lane + 1)
        alone, _ = near.draw_points(uniforms[:, one], keys[one], *(column[one] for column in columns))
        np.testing.assert_array_equal(alone[0], points[lane])


def test_views_of_several_shapes_answer_in_each_lane_as_if_it_were_alone() -> None:
    view, random, lanes = ViewRegion(2, (1, 1)), np.random.default_rng(10), 15
    turn, spin = random.normal(size=(2, lanes, 4))
    columns = [
        random.normal(size=(lanes, 3)),
        turn / np.linalg.norm(turn, axis=1, keepdims=True),
        np.array([1.0, 2 * math.pi])[np.arange(lanes) % 2],
        np.array([math.pi, 1.2])[np.arange(lanes) % 2],
        random.uniform(2, 4, lanes),
    ]
    ahead = columns[0] + random.normal(size=(lanes, 3))
    poses = Poses(
        ahead, spin / np.linalg.norm(spin, axis=1, keepdims=True), random.uniform(0.1, 0.6, (lanes, 3))
    )
    body = Body((primitives.box(), primitives.cone()), np.arange(lanes) // 3 % 2, poses)
    uniforms, keys = random.random((view.draws, lanes)), np.zeros(lanes, dtype=np.uint64)

    def answers(rows: np.ndarray[Any, Any]) -> list[Any]:
        own, part = [column[rows] for column in columns], body.take(rows)
        return [
            view.distances(3 * ahead[rows], *own),
            view.contains_points(ahead[rows], *own),
            view.contains_bodies(part, len(rows), *own),
            view.meets_bodies(part, len(rows), *own),
            view.draw_points(uniforms[:, rows], keys[rows], *own)[0],
            view.sizes(*own),
            *view.box(*own),
        ]

    together = answers(np.arange(lanes))
    for lane in (1, 6, 13):
        for all_of_them, alone in zip(together, answers(np.array([lane])), strict=True):
            assert all_of_them[lane].tolist() == pytest.approx(alone[0].tolist(), abs=1e-12)
    for each in together[1:4]:
        assert 0 < each.sum() < lanes


def test_what_of_all_space_is_not_in_view() -> None:
    text = (
        "ego = new Object with visibleDistance 10, with viewAngle 90 deg\nworkspace = Workspace()\n"
        "param p = [everywhere_seen.containsPoint(x) for x in PLACES], q = [unseen.containsPoint(x) for x in PLACES]\n"
    )
    places = "[(0, 5), (0, 11), (0, -5), (4, 5), (6, 5)]"
    for region in ("everywhere", "workspace"):
        names = f"everywhere_seen = visible {region}\nunseen = not visible {region}\n"
        head, tail = text.split("param")
        found = params(f"{head}{names}param{tail}".replace("PLACES", places))
        assert found["p"] == [True, False, False, True, False]
        assert found["q"] == [False, True, True, False, True]


@pytest.mark.parametrize("rows", [1, 7])
def test_places_in_view_are_those_of_one_attempt_after_the_other(
    rows: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a disc that is a small part of what the first observer has in view, and most of it of the others."""
    text = (
        "workspace = Workspace(CircularRegion((5, 0), 2))\n"
        "ego = new Object at (5, 0), with visibleDistance Uniform(2, 9, 40)\nparam place = (new Point visible).position\n"
    )

    def places() -> list[tuple[float, ...]]:
        return [tuple(scene.params["place"]) for scene in scenario(text).sample(12, seed=2)]

    expected = places()
    assert len(set(expected)) == 12
    monkeypatch.setattr(views, "_ROWS", rows)
    assert places() == expected
