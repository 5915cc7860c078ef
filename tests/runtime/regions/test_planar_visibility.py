"""What an object sees in 2D mode, against planar geometry by shapely."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import scenic
from scenic.runtime.regions.planar_visibility import _sees, _sees_at_once
from tests.runtime.programs import thing


def sector(x: float, y: float, heading: float, angle: float, distance: float) -> shapely.Geometry:
    """A finely cut circular sector, a little smaller than the true one."""
    if angle >= 2 * math.pi - 0.017:
        return shapely.Point(x, y).buffer(distance, quad_segs=256)
    steps = np.linspace(heading - angle / 2, heading + angle / 2, 721)
    rim = [(x - distance * math.sin(a), y + distance * math.cos(a)) for a in steps]
    return shapely.Polygon([(x, y), *rim])


def rectangle(x: float, y: float, heading: float, width: float, length: float) -> shapely.Geometry:
    box = shapely.box(-width / 2, -length / 2, width / 2, length / 2)
    turned = shapely.affinity.rotate(box, heading, origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(turned, x, y)


angles = st.floats(-math.pi, math.pi)


@given(
    heading=angles,
    angle=st.floats(0.1, 2 * math.pi),
    distance=st.floats(1, 10),
    place=st.tuples(st.floats(-10, 10), st.floats(-10, 10)),
    turn=angles,
    size=st.tuples(st.floats(0.2, 8), st.floats(0.2, 8)),
)
def test_a_sector_meets_a_rectangle_as_in_planar_geometry(
    heading: float,
    angle: float,
    distance: float,
    place: tuple[float, float],
    turn: float,
    size: tuple[float, float],
) -> None:
    quaternion = [0, 0, math.sin(turn / 2), math.cos(turn / 2)]
    seen = _sees(
        None,  # type: ignore[arg-type] # elementwise: nothing of the call is used
        np.zeros((1, 3)),
        np.array([heading]),
        np.array([angle]),
        np.array([distance]),
        np.array([[*place, 0.0]]),
        np.array([quaternion]),
        np.array([[*size, 1.0]]),
    )[0]
    at_once = _sees_at_once(
        None, (0.0, 0.0, 0.0), heading, angle, distance, (*place, 0.0), (*quaternion,), (*size, 1.0)
    )
    assert at_once == seen
    view, target = sector(0, 0, heading, angle, distance), rectangle(*place, turn, *size)
    if view.buffer(-1e-3).intersects(target):
        assert seen
    elif not view.buffer(1e-3).intersects(target):
        assert not seen


PROGRAM = """
ego = new Object with viewAngle 90 deg, with visibleDistance 10
other = new Object at (Range(-12, 12), Range(-12, 12)), with allowCollisions True
"""


def test_objects_of_2d_scenes_are_in_view_of_the_ego() -> None:
    scenario = scenic.scenarioFromString(PROGRAM, mode2D=True)
    view = sector(0, 0, 0, math.pi / 2, 10).buffer(1e-3)
    scenes = scenario.sample(200, seed=1)
    for scene in scenes:
        x, y, _ = scene.objects[1].position
        assert view.intersects(rectangle(x, y, 0, 1, 1))
    assert sum(scene.attempts for scene in scenes) > 400


def test_an_object_out_of_view_is_an_error_at_once() -> None:
    with pytest.raises(scenic.InvalidScenarioError, match="cannot be seen") as caught:
        scenic.scenarioFromString("ego = new Object\nnew Object at 100 @ 0", mode2D=True)
    assert caught.value.line == 2
    assert "requireVisible False" in (caught.value.help or "")


def test_whether_an_object_must_be_seen_may_be_random() -> None:
    text = (
        "ego = new Object with viewAngle 90 deg, with visibleDistance 10\n"
        "other = new Object at (0, Range(5, 50)), with requireVisible Uniform(True, False)\n"
    )
    scenes = scenic.scenarioFromString(text, mode2D=True).sample(300, seed=4)
    kept = {True: [], False: []}
    for scene in scenes:
        other = scene.objects[1]
        kept[other.requireVisible].append(other.position.y)
    assert max(kept[True]) <= 10.5 < max(kept[False])


PLANE = """
workspace = Workspace(RectangularRegion((0, 0), 0, 30, 30))
ego = new Object at (2, 1), facing 30 deg, with viewAngle 80 deg, with visibleDistance 9
spot = new OrientedPoint in workspace, facing 200 deg, with viewAngle 60 deg, with visibleDistance 12
near = new Object visible, with requireVisible False
far = new Object not visible, with requireVisible False
other = new Object visible from spot, with requireVisible False, with allowCollisions True
require ego can see (1, 5)
require not (ego can see spot)
param spot = spot.position
"""


def test_visibility_in_2d_mode_is_planar() -> None:
    view = sector(2, 1, math.radians(30), math.radians(80), 9)
    for scene in scenic.scenarioFromString(PLANE, mode2D=True).sample(60, seed=2):
        _, near, far, other = scene.objects
        x, y, _ = scene.params["spot"]
        assert view.buffer(1e-3).intersects(rectangle(near.position.x, near.position.y, 0, 1, 1))
        assert not view.buffer(-1e-3).intersects(rectangle(far.position.x, far.position.y, 0, 1, 1))
        assert not view.buffer(-1e-3).contains(shapely.Point(x, y))
        from_spot = sector(x, y, math.radians(200), math.radians(60), 12).buffer(1e-3)
        assert from_spot.intersects(rectangle(other.position.x, other.position.y, 0, 1, 1))


def test_what_occludes_in_2d_mode_hides() -> None:
    text = (
        "ego = new Object with requireVisible False\n"
        "wall = new Object at (0, 4), with width 8, with length 0.5, with height 8, with occluding {}, with requireVisible False\n"
        "box = new Object at (0, Range(8, 9)), with requireVisible False\n"
        "require ego can see box\n"
    )
    scenic.scenarioFromString(text.format(False), mode2D=True).sample(3, seed=1)
    with pytest.raises(scenic.RejectionException):
        scenic.scenarioFromString(text.format(True), mode2D=True).generate(maxIterations=50)


def test_what_may_occlude_in_2d_mode_hides_where_it_does() -> None:
    text = (
        "ego = new Object with requireVisible False\n"
        "wall = new Object at (0, 4), with width 8, with length 0.5, with occluding Uniform(True, False), with requireVisible False\n"
        "box = new Object at (0, Range(8, 9)), with requireVisible False\n"
        "require ego can see box\nrequire not (ego can see (0, 8)) or wall.occluding is False\n"
    )
    scenes = scenic.scenarioFromString(text, mode2D=True).sample(10, seed=1)
    assert {scene.objects[1].occluding for scene in scenes} == {False}
    hidden = scenic.scenarioFromString(text.replace("require ego", "require not ego", 1), mode2D=True)
    assert {scene.objects[1].occluding for scene in hidden.sample(10, seed=1)} == {True}


def answers(text: str) -> dict[str, object]:
    return dict(scenic.scenarioFromString(text, mode2D=True).sample(1, seed=1)[0].params)


def test_borders_of_views_in_the_plane_belong_to_them() -> None:
    text = (
        "ego = new Object facing 90 deg, with viewAngle 60 deg, with visibleDistance 10\n"
        "round = new OrientedPoint at (0, 0), with viewAngle (359.5 deg), with visibleDistance 10\n"
        "param end = ego.canSee((-10, 0)), beyond = ego.canSee((-10.001, 0)), here = ego.canSee((0, 0)), "
        "behind = round.canSee((0, -5)), beside = ego.canSee((-5, 5 * 0.58)), within = ego.canSee((-5, 5 * 0.57))\n"
    )
    assert answers(text) == {
        "end": True,
        "beyond": False,
        "here": True,
        "behind": True,
        "beside": False,
        "within": True,
    }


def test_each_sample_sees_the_place_of_its_own_camera_in_the_plane() -> None:
    text = "ego = new Object with viewAngle 10 deg\ny = Uniform(0, -2, 2)\nparam y = y, seen = ego.canSee((0, y))\n"
    found = [dict(item.params) for item in scenic.scenarioFromString(text, mode2D=True).sample(30, seed=1)]
    assert {(each["y"], each["seen"]) for each in found} == {(0, True), (-2, False), (2, True)}


def test_directions_on_the_border_of_a_view_in_the_plane_are_in_it() -> None:
    points = {"left": (-5, 5), "right": (5, 5), "off": (5, 4.999), "end": (6, 8), "behind": (0, -0.1)}
    seen = ", ".join(f"{name} = ego.canSee({point})" for name, point in points.items())
    found = answers(f"ego = new Object with viewAngle 90 deg, with visibleDistance 10\nparam {seen}\n")
    assert found == {"left": True, "right": True, "off": False, "end": True, "behind": False}


def test_neither_an_observer_nor_what_it_looks_at_makes_the_plane_a_space() -> None:
    """Only others that may hide something call for rays: between these few the corner in view is not met."""
    text = (
        "ego = new Object with viewAngle 60 deg, with visibleDistance 10, with viewRayDensity 0.02, with occluding True\n"
        "box = new Object at (4.2, 6), with occluding True, with requireVisible False\n"
        "other = new Object at (-8, 1), with occluding True, with requireVisible False\n"
        "param own = ego.canSee(box, [box, ego]), other = ego.canSee(box, [box, ego, other])\n"
    )
    assert answers(text) == {"own": True, "other": False}


def test_a_camera_within_an_outline_sees_it() -> None:
    text = (
        "ego = new Object with viewAngle 10 deg, with visibleDistance 1, with width 0.1, with length 0.1, with allowCollisions True\n"
        "big = new Object at (0.5, 0.5), with width 30, with length 20, facing 20 deg, with allowCollisions True, with requireVisible False\n"
        "param seen = ego.canSee(big)\n"
    )
    assert answers(text) == {"seen": True}


def test_what_does_not_occlude_leaves_the_answer_to_the_plane() -> None:
    """Of an object only a corner is in view, between any rays; something that hides nothing stands elsewhere."""
    text = (
        "ego = new Object with viewAngle 60 deg, with visibleDistance 10, with viewRayDensity 0.02\n"
        "box = new Object at (4.2, 6), with requireVisible True\n"
        "other = new Object at (-2, 5)\n"
        "out = new Object at (4.8, 7.2), with length 0.2, with requireVisible False\n"
        "param seen = ego.canSee(box), beside = ego.canSee(box, [other]), out = ego.canSee(out)\n"
        "param random = ego.canSee(Uniform(box, box))\n"
    )
    (scene,) = scenic.scenarioFromString(text, mode2D=True).sample(1, seed=1)
    assert scene.params == {"seen": True, "beside": True, "out": False, "random": True}
    ego, box, _, out = scene.objects
    assert (ego.canSee(box), ego.canSee(out)) == (True, False)


def test_defaults_in_the_plane() -> None:
    text = (
        "ego = new Object with width 2, with length 5\n"
        "param height = ego.height, base = ego.baseOffset, gap = ego.contactTolerance, hides = ego.occluding, asked = ego.requireVisible\n"
    )
    assert answers(text) == {"height": 5, "base": (0, 0, 0), "gap": 0, "hides": False, "asked": True}


def test_large_things_are_placed_visibly_with_their_middle_in_view() -> None:
    text = "ego = new Object with viewAngle 90 deg, with visibleDistance 5\nnew Object visible, with width 6, with length 8\n"
    scenes = scenic.scenarioFromString(text, mode2D=True).sample(200, seed=1)
    assert 4.5 < max(math.hypot(*tuple(scene.objects[1].position)[:2]) for scene in scenes) <= 5


@pytest.mark.parametrize("angle", [0.2, 1.5, math.pi - 0.1, math.pi + 0.3, 4.5, 6.2, 2 * math.pi])
def test_large_and_near_outlines_in_views_of_every_width(angle: float) -> None:
    """Many reach into the view with the middle of an edge alone, or beside the camera."""
    count, rng = 160, np.random.default_rng(int(10 * angle))
    heading, turn = rng.uniform(-math.pi, math.pi, (2, count))
    distance, size = (
        rng.uniform(1, 4, count),
        rng.uniform(0.1, 9, (count, 2)) * rng.choice([0.1, 1], (count, 2)),
    )
    camera = rng.uniform(-3, 3, (count, 3))
    # Beyond the rim by about half the width of the outline, or anywhere near.
    way, off = (
        rng.uniform(-math.pi, math.pi, count),
        distance + size.max(axis=1) / 2 * rng.uniform(0.3, 1.2, count),
    )
    off = np.where(rng.random(count) < 0.3, rng.uniform(0, 5, count), off)
    turn = np.where(rng.random(count) < 0.5, way + rng.normal(0, 0.1, count), turn)
    place = camera + np.stack([-off * np.sin(way), off * np.cos(way), rng.normal(size=count)], axis=-1)
    zeros = np.zeros(count)
    seen = _sees(
        None,  # type: ignore[arg-type] # elementwise: nothing of the call is used
        camera,
        heading,
        np.full(count, angle),
        distance,
        place,
        np.stack([zeros, zeros, np.sin(turn / 2), np.cos(turn / 2)], axis=-1),
        np.column_stack([size, np.ones(count)]),
    )
    decided = 0
    for lane in range(count):
        view = sector(*camera[lane, :2], heading[lane], angle, distance[lane])
        target = rectangle(*place[lane, :2], turn[lane], *size[lane])
        if view.intersects(target) and view.intersection(target).area > 1e-5:
            assert seen[lane]
        elif not view.buffer(1e-3).intersects(target):
            assert not seen[lane]
        else:
            continue
        decided += 1
    assert decided > 0.95 * count
    assert 0.1 < seen.mean() < 0.97


@pytest.mark.parametrize("place", [(0.0, 0.5), (0.3, 0.5), (-0.5, 0.2), (0.5, 0.5), (0.5, -0.5), (0.0, 0.0)])
def test_a_camera_on_an_outline_sees_it_whichever_way_it_looks(place: tuple[float, float]) -> None:
    for heading in (0.1, 1.7, 3.0, -1.4):
        seen = _sees(
            None,  # type: ignore[arg-type] # elementwise: nothing of the call is used
            np.array([[*place, 0.0]]),
            np.array([heading]),
            np.array([0.2]),
            np.array([5.0]),
            np.zeros((1, 3)),
            np.array([[0.0, 0, 0, 1]]),
            np.ones((1, 3)),
        )
        assert seen.tolist() == [True]


@pytest.mark.parametrize("mode_2d", [False, True])
def test_nobody_asks_whether_the_ego_sees_itself(mode_2d: bool) -> None:
    """It need not: its camera may stand before it and look ahead."""
    looks_ahead = "with cameraOffset (0, 5), with viewAngle 20 deg, with requireVisible True"
    (found,) = scenic.scenarioFromString(f"ego = new Object {looks_ahead}\n", mode2D=mode_2d).sample(
        1, seed=0
    )
    assert not found.egoObject.canSee(found.egoObject)


@pytest.mark.parametrize(
    "condition",
    [
        "(ego can see {place})",
        "all([ego can see {place} for _ in range(1)])",
        "((new Point at (0, 2)) can see {place})",
        "ego.canSee({place})",
    ],
)
def test_the_height_of_what_is_looked_at_counts_only_in_space(condition: str) -> None:
    """Whether the condition is a formula or code: in 2D mode a place 45 metres away stays in view however high it is."""
    text = "ego = new Object\nrequire {}" + condition + "\n"
    assert thing(text.format("", place="(0, 45, 0)")) is not None
    assert thing(text.format("not ", place="(0, 45, 45)")) is not None
    assert thing(text.format("", place="(0, 45, 45)"), mode2D=True) is not None


@pytest.mark.parametrize("roll", [0, 180])
@pytest.mark.parametrize("turn", [0, 20])
def test_outlines_of_what_lies_on_its_back_are_outlines(roll: int, turn: int) -> None:
    """From within, from beside, and out of view."""
    text = (
        "ego = new Object with viewAngle 10 deg, with visibleDistance 1, with width 0.1, with length 0.1, with allowCollisions True\n"
        f"big = new Object at (0.5, 0.5), with width 30, with length 20, facing ({turn} deg, 0, {roll} deg), with allowCollisions True, with requireVisible False\n"
        "near = new OrientedPoint at (0, -20), with viewAngle 5 deg, with visibleDistance 15\n"
        "away = new OrientedPoint at (0, -20), facing 180 deg, with viewAngle 5 deg, with visibleDistance 15\n"
        "param seen = [looker.canSee(big) for looker in (ego, near, away)]\n"
    )
    assert answers(text) == {"seen": [True, True, False]}


def test_what_may_hide_others_in_the_plane_may_come_one_by_one() -> None:
    text = (
        "ego = new Object with requireVisible False\nbox = new Object at (0, 8), with requireVisible False\n"
        "wall = new Object at (0, 4), with width 8, with length 0.5, with height 8, with requireVisible False, with occluding True\n"
        "one, looker = Uniform(box, box), Uniform(ego, ego)\n"
        "param seen = [who.canSee(what, iter([wall])) for who in (ego, looker) for what in (box, one, (0, 8))]\n"
    )
    assert answers(text) == {"seen": [False] * 6}


def test_parameters_know_what_hides_by_chance_in_the_plane() -> None:
    text = (
        "ego = new Object with requireVisible False\nbox = new Object at (0, 8), with requireVisible False\n"
        "wall = new Object at (0, 4), with width 8, with length 0.5, with height 8, with requireVisible False, with occluding Uniform(True, False)\n"
        "param hides = wall.occluding, seen = ego.canSee(box, [wall]), drawn = ego.canSee(Uniform(box, box), [wall]), place = ego.canSee((0, 8), [wall])\n"
    )
    scenes = scenic.scenarioFromString(text, mode2D=True).sample(12, seed=1)
    assert {scene.params["hides"] for scene in scenes} == {True, False}
    for scene in scenes:
        seen = not scene.params["hides"]
        assert [scene.params[name] for name in ("seen", "drawn", "place")] == [seen] * 3
