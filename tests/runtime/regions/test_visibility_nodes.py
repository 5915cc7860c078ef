"""Visibility in the language: operators, specifiers, built-in requirements and regions, against the kernel's own answers."""

import math

import numpy as np
import pytest

import scenic
from scenic.formats.labels import body_of
from scenic.language.errors import Located, ScenicTypeError
from scenic.runtime.geometry.views.observers import Views
from scenic.runtime.geometry.views.occluders import Occluder
from scenic.runtime.geometry.views.seen_bodies import sees_bodies
from scenic.runtime.geometry.views.seen_points import sees_points
from tests.amounts import amount


def view(thing: object) -> Views:
    offset = np.array(list(getattr(thing, "cameraOffset", (0, 0, 0))))
    turn = thing.orientation
    x, y, z, w = turn.x, turn.y, turn.z, turn.w
    matrix = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return Views.fixed(
        np.array(list(thing.position)) + matrix @ offset,
        (x, y, z, w),
        angles=tuple(thing.viewAngles),
        distance=thing.visibleDistance,
    )


def sees(scene: object, observer: object, target: object) -> bool:
    occluders = [
        Occluder(body_of(thing))
        for thing in scene.objects
        if thing is not observer and thing is not target and thing.occluding
    ]
    return bool(sees_bodies(view(observer), body_of(target), occluders, 1)[0])


OBSERVER = (
    "ego = new Object with viewAngles (90 deg, 60 deg), with visibleDistance 20, facing Range(-20, 20) deg\n"
)
SCENE = (
    OBSERVER
    + "box = new Object at (Range(-10, 10), Range(4, 15), 0), facing Range(0, 360) deg\n"
    + "{condition}\n"
    # What stands in the way comes after the requirement.
    + "wall = new Object at (Range(-3, 3), 2.5, 0), with width 3, with height 3, with length 0.1, with occluding {hides}\n"
)


@pytest.mark.parametrize("hides", ["True", "Uniform(True, False)"])
@pytest.mark.parametrize(
    ("condition", "wanted"),
    [
        ("require ego can see box", True),
        ("require not (ego can see box)", False),
        ("require all([ego can see thing for thing in [box]])", True),
        ("def seen(a, b):\n    return a can see b\nrequire not seen(ego, box)", False),
    ],
)
def test_requirements_see_past_everything_in_the_scene(condition: str, wanted: bool, hides: str) -> None:
    scenario = scenic.scenarioFromString(SCENE.format(condition=condition, hides=hides))
    scenes = scenario.sample(40, seed=3)
    assert [sees(scene, *scene.objects[:2]) for scene in scenes] == [wanted] * 40
    assert sum(scene.attempts for scene in scenes) > 50


def test_node_and_python_code_choose_the_same_scenes() -> None:
    texts = ["require ego can see box", "require all([ego can see thing for thing in [box]])"]
    drawn = [
        [
            (scene.attempts, *scene.objects[1].position)
            for scene in scenic.scenarioFromString(SCENE.format(condition=text, hides="True")).sample(
                20, seed=5
            )
        ]
        for text in texts
    ]
    assert drawn[0] == drawn[1]


def test_points_are_seen_and_hidden() -> None:
    text = (
        OBSERVER
        + "wall = new Object at (0, 3, 0), with width 3, with height 3, with length 0.1\n"
        + "spot = new Point at (Range(-8, 8), Range(1, 10), 0)\n"
        + "require {}ego can see spot\nparam spot = spot.position\n"
    )
    for word in ("", "not "):
        for scene in scenic.scenarioFromString(text.format(word)).sample(30, seed=1):
            point = np.array([list(scene.params["spot"])])
            wall = Occluder(body_of(scene.objects[1]))
            assert sees_points(view(scene.egoObject), point, [wall], 1)[0] == (word == "")


def test_specifiers_ask_for_sight_and_blindness() -> None:
    text = (
        "workspace = Workspace(BoxRegion((20, 20, 4)))\n"
        "ego = new Object with viewAngles (120 deg, 80 deg), with visibleDistance 8\n"
        "wall = new Object at (0, 3, 0), with width 3, with height 3, with length 0.1\n"
        "new Object visible, with width 0.5\n"
        "new Object not visible, facing Range(0, 90) deg\n"
        "new Object at (Range(-9, 9), Range(-9, 9), 0), visible from wall\n"
    )
    for scene in scenic.scenarioFromString(text).sample(25, seed=2):
        ego, wall, seen, unseen, other = scene.objects
        assert sees(scene, ego, seen)
        assert not sees(scene, ego, unseen)
        assert sees(scene, wall, other)


def test_the_law_of_visible_objects_is_that_of_uniform_ones_that_are_seen() -> None:
    text = (
        "workspace = Workspace(BoxRegion((12, 12, 4)))\n"
        "ego = new Object with viewAngles (70 deg, 50 deg), with visibleDistance 5\n"
        "new Object at (1, 3, 0), with width 1, with height 3, with length 0.1\n"
    )
    first = scenic.scenarioFromString(text + "new Object visible").sample(600, seed=1)
    second = scenic.scenarioFromString(text + "x = new Object in workspace\nrequire ego can see x").sample(
        600, seed=2
    )
    from scipy.stats import ks_2samp

    for axis in range(3):
        one, other = (
            [list(scene.objects[2].position)[axis] for scene in scenes] for scenes in (first, second)
        )
        assert ks_2samp(one, other).pvalue > 1e-4


def test_without_a_container_objects_are_wherever_they_may_be_seen() -> None:
    text = "ego = new Object with visibleDistance 10, with viewAngles (90 deg, 90 deg)\nnew Object visible, with width 6"
    scenes = scenic.scenarioFromString(text).sample(300, seed=1)
    distances = [np.linalg.norm(list(scene.objects[1].position)) for scene in scenes]
    # The middle may be out of range, by up to half the diagonal, while a part is seen.
    assert 10 < max(distances) < 10 + math.sqrt(9 + 0.5)
    assert min(scene.objects[1].position.y for scene in scenes) < min(distances) + 2


@pytest.mark.parametrize("wanted", ["True", "Uniform(True, False)"])
def test_objects_that_must_be_visible_are(wanted: str) -> None:
    text = SCENE.format(condition="", hides="True").replace(
        "facing Range(0, 360) deg", f"with requireVisible {wanted}"
    )
    scenes = scenic.scenarioFromString(text).sample(40, seed=7)
    for scene in scenes:
        assert sees(scene, *scene.objects[:2]) or not scene.objects[1].requireVisible
    if "Uniform" in wanted:
        assert not all(sees(scene, *scene.objects[:2]) for scene in scenes)


def test_view_regions_are_regions() -> None:
    text = (
        "ego = new Object facing Range(0, 360) deg, with viewAngles (90 deg, 40 deg), with visibleDistance 6\n"
        "square = RectangularRegion((0, 0, 0), 0, 10, 10)\n"
        "a = new Point in visible square\n"
        "b = new Point in not visible square\n"
        "c = new Point in square visible from ego\n"
        "d = new Point in ego.visibleRegion\n"
        "e = new Object in ego.visibleRegion, with width 0.3, with length 0.3, with height 0.3, with allowCollisions True\n"
        "require e in ego.visibleRegion\n"
        "require (d in visible square) or True\n"
        "param points = [a.position, b.position, c.position, d.position]\n"
    )
    for scene in scenic.scenarioFromString(text).sample(40, seed=1):
        points = np.array([list(point) for point in scene.params["points"]])
        assert view(scene.egoObject).contain(points).tolist() == [True, False, True, True]
        assert np.abs(points[:3, :2]).max() <= 5


def test_objects_answer_what_they_see() -> None:
    text = (
        "ego = new Object\nwall = new Object at (0, 3, 0), with width 3, with height 3, with length 0.1\n"
        "box = new Object at (0, 6, 0)\n"
        "param alone = ego.canSee(box), hidden = ego.canSee(box, [wall]), point = ego.canSee((0, 5, 0), (wall,))\n"
    )
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=1)
    assert scene.params == {"alone": True, "hidden": False, "point": False}


def test_certain_answers_find_what_is_between_rays() -> None:
    text = (
        "ego = new Object with viewRayCount (1800, 900), with width 0.1, with length 0.1\n"
        "left = new Object at (-2.0007, 5, 0), with width 4, with length 0.1, with height 4\n"
        "right = new Object at (2.0007, 5, 0), with width 4, with length 0.1, with height 4\n"
        "box = new Object at (Range(0.79, 0.81), 10, 0), with width 2\n"
        "param rays = ego.canSee(box, [left, right]), proved = ego.canSee(box, [left, right], certain=True)\n"
        "param drawn = [ego.canSee(Uniform(box, box), [left, right], certain=sure) for sure in (False, True)]\n"
        "param eyes = [Uniform(ego, ego).canSee(box, [left, right], certain=sure) for sure in (False, True)]\n"
        "told = distributionFunction(lambda value, _: value)(box, Range(0, 1))\n"
        "param told = [ego.canSee(told, [left, right], certain=sure) for sure in (False, True)]\n"
    )
    for scene in scenic.scenarioFromString(text).sample(3, seed=1):
        both = [False, True]
        assert scene.params == {"rays": False, "proved": True, "drawn": both, "eyes": both, "told": both}


def test_certain_answers_find_what_is_between_rays_in_the_plane_too() -> None:
    text = (
        "ego = new Object with viewRayCount (1800, 900), with width 0.1, with length 0.1\n"
        "left = new Object at (-2.0007, 5), with width 4, with length 0.1, with occluding True\n"
        "right = new Object at (2.0007, 5), with width 4, with length 0.1, with occluding True\n"
        "box = new Object at (Range(0.79, 0.81), 10), with width 2, with requireVisible False\n"
        "param seen = [ego.canSee(box, [left, right], certain=sure) for sure in (False, True)]\n"
        "param free = [ego.canSee(box, certain=sure) for sure in (False, True)]\n"
    )
    for scene in scenic.scenarioFromString(text, mode2D=True).sample(3, seed=1):
        assert scene.params == {"seen": [False, True], "free": [True, True]}


def test_what_cannot_be_proved_to_be_seen_is_not_certainly_seen() -> None:
    """Two boxes that touch hide all, but no single one of them does, wherever the directions are divided."""
    text = (
        "ego = new Object with width 0.1, with length 0.1\n"
        "left = new Object at (-2, 5, 0), with width 4, with length 0.1, with height 4, with allowCollisions True\n"
        "right = new Object at (2, 5, 0), with width 4, with length 0.1, with height 4, with allowCollisions True\n"
        "box = new Object at (Range(-0.01, 0.01), 10, 0), with width 2\n"
        "param proved = ego.canSee(box, [left, right], certain=True), alone = ego.canSee(box, [left], certain=True)\n"
    )
    for scene in scenic.scenarioFromString(text).sample(amount(1, 3), seed=1):
        assert scene.params == {"proved": False, "alone": True}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("ego = new Object\nx = ego can see (1, 2)", "cannot be used while the program runs"),
        # Also behind requirements, whether what they ask for is known at once or not.
        (
            "ego = new Object\nrequire ego.x < 9\nx = ego can see (1, 2)",
            "cannot be used while the program runs",
        ),
        (
            "ego = new Object at (Range(0, 1), 0)\nrequire [ego.x, 3][0 if ego.x < 2 else 1] < 9\nx = ego can see (1, 2)",
            "cannot be used while the program runs",
        ),
        (
            "ego = new Object\nn = DiscreteRange(1, 4)\nrequire n in [1, 2]\nx = ego can see (1, 2)",
            "cannot be used while the program runs",
        ),
        ("ego = new Object\nnew Object not visible", "needs to know where"),
        ("ego = new Object\nnew Object at (0, 90, 0), visible", "cannot be seen from ego"),
        ("ego = new Object\nnew Object at (0, 9, 0), not visible", "always seen"),
        ("new Object with requireVisible True", "there is no ego"),
        ("ego = new Object with viewAngles (0, 1)\nnew Object at 5 @ 5, visible", "greater than 0"),
        ("ego = new Object\nnew Object visible from (1, 2)", "visible from"),
    ],
)
def test_what_makes_no_sense_is_refused(text: str, message: str) -> None:
    with pytest.raises(Exception, match=message) as caught:
        scenic.scenarioFromString(text)
    assert isinstance(caught.value, Located)


def test_what_is_not_visible_lies_in_its_own_container() -> None:
    text = (
        "{workspace}ego = new Object with visibleDistance 3, with viewAngles (360 deg, 180 deg)\n"
        "new Object not visible, with regionContainedIn BoxRegion(position=(0, 0, 0), dimensions=(12, 6, 4))\n"
    )
    for workspace in ("", "workspace = Workspace(BoxRegion(dimensions=(900, 900, 900)))\n"):
        for scene in scenic.scenarioFromString(text.format(workspace=workspace)).sample(
            20, seed=2, max_attempts=200
        ):
            x, y, z = scene.objects[1].position
            assert max(abs(x) - 5.5, abs(y) - 2.5, abs(z) - 1.5) <= 1e-9


def test_parts_in_view_are_intersections_and_differences() -> None:
    """What a program gets by `visible` it also gets by combining with the view itself."""
    text = """
floor = RectangularRegion((0, 0, 0), 0, 30, 30)
ego = new Object at (Range(-3, 3), 0, 0.5), facing Range(0, 360) deg, with viewAngles (90 deg, 60 deg), with visibleDistance 12
seen = visible floor
unseen = not visible floor
by_hand = floor.intersect(ego.visibleRegion)
without = floor.difference(ego.visibleRegion)
"""
    points = np.random.default_rng(3).uniform((-18, -18, 0), (18, 18, 0), (400, 3))
    for scene in scenic.scenarioFromString(text).sample(3, seed=5):
        inside = {
            name: region.contains_points(points, *region.fixed_columns("the test"))
            for name, region in scene.regions.items()
        }
        assert (inside["seen"] == inside["by_hand"]).all()
        assert (inside["unseen"] == inside["without"]).all()
        assert (inside["floor"] == (inside["seen"] | inside["unseen"])).all()
        assert not (inside["seen"] & inside["unseen"]).any()
        assert 20 < inside["seen"].sum() < inside["unseen"].sum()


def answers(text: str) -> dict[str, object]:
    """The parameters of the one scene of a program."""
    return dict(scenic.scenarioFromString(text).sample(1, seed=1)[0].params)


def test_a_camera_is_mounted_in_the_frame_of_its_object() -> None:
    """Turned to look along -X, an object looks from ahead of itself, so farther along -X."""
    text = (
        "ego = new Object facing 90 deg, with cameraOffset (0, 3, 1), with visibleDistance 5, with viewAngles (60 deg, 60 deg)\n"
        "param far = ego.canSee((-7.9, 0, 1)), beyond = ego.canSee((-8.1, 0, 1)), beside = ego.canSee((-4, 0.6, 1)), "
        "behind = ego.canSee((-2, 0, 1)), region = ego.visibleRegion.containsPoint((-7.9, 0, 1)), "
        "near = ego.visibleRegion.containsPoint((-2.9, 0, 1))\n"
    )
    assert answers(text) == {
        "far": True,
        "beyond": False,
        "beside": False,
        "behind": False,
        "region": True,
        "near": False,
    }


def test_points_look_around_whatever_their_angles() -> None:
    text = (
        "p = new Point with viewAngles (10 deg, 10 deg), with visibleDistance 5\n"
        "o = new OrientedPoint with viewAngles (10 deg, 10 deg), with visibleDistance 5\n"
        "param point = p.canSee((1, -4, 1)), oriented = o.canSee((1, -4, 1))\n"
        "param above = p.canSee((0, 0, 4)), below = p.canSee((0, 1, -4)), off = o.canSee((0, 1, 4))\n"
        "box = new Object at (0, 1, 4)\nparam thing = p.canSee(box), part = o.canSee(box)\n"
        "random = new Point at (0, 0, Range(0, 0.1)), with viewAngles (10 deg, 10 deg), with visibleDistance 5\n"
        "require random can see (0, 0, 4)\nrequire random can see (0, 1, -4)\nrequire random can see box\n"
    )
    assert answers(text) == {
        "point": True,
        "oriented": False,
        "above": True,
        "below": True,
        "off": False,
        "thing": True,
        "part": False,
    }


@pytest.mark.parametrize("pair", ["Uniform({0}, {0})", "Uniform([{0}], [{0}, 3])[0]"])
def test_random_pairs_of_view_angles_are_across_and_upward(pair: str) -> None:
    text = (
        f"ego = new Object with viewAngles {pair.format('(0.2, 2.0)')}, with viewRayCount {pair.format('(2, 9)')}\n"
        "param up = ego.canSee((0, 2, 1)), beside = ego.canSee((1, 2, 0))\n"
        "pole = new Object at (0, 10, 9.5), with width 3\nslab = new Object at (9.5, 10), with height 3\n"
        "param high = ego.canSee(pole), far = ego.canSee(slab)\n"
    )
    assert answers(text) == {"up": True, "beside": False, "high": True, "far": False}


@pytest.mark.parametrize(("aside", "seen"), [(0.7, False), (0.72, True)])
def test_the_corner_of_a_turned_box_hides_a_place(aside: float, seen: bool) -> None:
    """It reaches farther from the middle than any side does."""
    text = f"ego = new Object\nwall = new Object at ({aside}, 5), facing 45 deg\nparam seen = ego.canSee((0, 9), [wall])\n"
    assert answers(text) == {"seen": seen}


def test_whoever_looks_nearly_up_to_the_zenith_sees_what_is_there() -> None:
    """Also for the analysis, which looks for scenes where that is required."""
    text = "ego = new Object with viewAngles (360 deg, 179.5 deg)\nspot = new Point at (0, 0, Range(4, 5))\nrequire ego can see spot\n"
    assert [item.attempts for item in scenic.scenarioFromString(text).sample(3, seed=1)] == [1, 1, 1]


@pytest.mark.parametrize(("count", "seen"), [("(1, 2)", True), ("(2, 1)", False)])
def test_rays_are_counted_across_and_then_upward(count: str, seen: bool) -> None:
    """Of a pole whose middle is hidden, two rays one above the other meet what is above and below."""
    text = (
        f"ego = new Object with viewAngles (60 deg, 60 deg), with viewRayCount {count}, with width 0.1\n"
        "pole = new Object at (0, 10, 0), with height 8\n"
        "wall = new Object at (0, 5, 0), with height 2, with length 0.1, with width 1\n"
        "param seen = ego.canSee(pole, [wall])\n"
    )
    assert answers(text) == {"seen": seen}


@pytest.mark.parametrize("hides", ["True", "False"])
def test_what_only_sometimes_hides_hides_only_then(hides: str) -> None:
    text = (
        "ego = new Object\nbox = new Object at (0, 9, 0)\n"
        "wall = new Object at (0, 4, 0), with width 5, with height 5, with occluding Uniform(True, False)\n"
        f"require wall.occluding == {hides}\nrequire {'not ' * (hides == 'True')}(ego can see box)\n"
    )
    assert len(scenic.scenarioFromString(text).sample(5, seed=1)) == 5


def test_a_workspace_of_a_workspace_is_what_it_is_made_of() -> None:
    text = "workspace = Workspace(Workspace(everywhere))\nego = new Object\nnew Object not visible\n"
    with pytest.raises(scenic.InvalidScenarioError, match="needs to know where"):
        scenic.scenarioFromString(text)


def test_functions_that_look_from_places_of_their_own_see_the_objects_of_each_candidate() -> None:
    """Nothing that is random is named in them; what hides is in another place in each candidate."""
    text = (
        "wall = new Object at (Range(-2, 2), 5), with height 9\nx = Range(-2, 2)\n"
        "def clear(x):\n    here = new Point at (x, 0, 0)\n    return here can see (x, 10, 0)\n"
        "require {}clear(x)\nparam x = x, wall = wall.position.x\n"
    )
    for word, free in (("", True), ("not ", False)):
        for found in scenic.scenarioFromString(text.format(word)).sample(30, seed=1):
            assert (abs(found.params["x"] - found.params["wall"]) > 0.5) is free


LOOKERS = """
ego = new Object with visibleDistance 20, with allowCollisions True
blind = new Object at (0, -30, 0), with visibleDistance 1
wall = new Object at ({x}, 3, 0), with width 3, with height 3, with length 0.1, with occluding {hides}, with allowCollisions True
box, far, beside = new Object at (0, 6, 0), new Object at (0, 60, 0), new Object at (9, 0, 0)
"""


@pytest.mark.parametrize(
    ("x", "hides"), [("0", "True"), ("Range(-9, 9)", "True"), ("0", "Uniform(True, False)")]
)
def test_what_hides_by_chance_is_looked_at_in_each_scene(x: str, hides: str) -> None:
    """Halfway to a box of a metre, a wall of three hides all of it up to 1.22 metres aside, its middle up to 1.5."""
    text = LOOKERS.format(x=x, hides=hides) + (
        "seen = [ego.canSee(box, [wall]), ego.canSee((0, 6, 0), [wall]), ego.canSee(beside, (wall,)), ego.canSee(far, [wall])]\n"
        "certain = [ego.canSee(box, [wall], certain=True), ego.canSee(far, [wall], certain=True)]\n"
        "one, other = Uniform(box, far), Uniform(ego, blind)\n"
        "param wall = wall, seen = seen, certain = certain, one = one, drawn = ego.canSee(one, [wall])\n"
        "param other = other, through = other.canSee(box, [wall]), sure = other.canSee(one, [wall], certain=True)\n"
    )
    answers = set()
    for scene in scenic.scenarioFromString(text).sample(40, seed=3):
        found = scene.params
        off = abs(found["wall"].x) if found["wall"].occluding else 9.0
        box, place, beside, far = found["seen"]
        if abs(off - 1.22) > 0.05:
            assert box is (off > 1.22)
        if not 1.17 < off < 1.8:
            assert found["certain"][0] is box
        if abs(off - 1.5) > 0.01:
            assert place is (off > 1.5)
        assert (beside, far, found["certain"][1]) == (True, False, False)
        assert found["drawn"] is (found["one"].y < 50 and box)
        assert found["through"] is (found["other"].y == 0 and box)
        assert found["sure"] is (found["other"].y == 0 and found["one"].y < 50 and found["certain"][0])
        answers.add((box, found["drawn"], found["through"]))
    assert len(answers) >= (1 if (x, hides) == ("0", "True") else 3)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ("3", "objects in a sequence, not 3"),
        ("ego", "objects in a sequence"),
        ("Uniform(ego, box)", "objects in a sequence"),
        ("[3]", "an object, not 3"),
        ("[ego, (1, 2)]", "an object"),
        ("[Range(0, 1)]", "an object"),
    ],
)
def test_only_objects_hide_others(values: str, expected: str) -> None:
    text = f"ego = new Object\nbox = new Object at (0, 6, 0)\nparam x = ego.canSee(box, {values})\n"
    with pytest.raises(ScenicTypeError, match=f"what may hide others: expected {expected}"):
        scenic.scenarioFromString(text).sample(1, seed=0)


def test_observers_of_a_choice_look_with_eyes_of_their_own() -> None:
    """Each with its place, its turn, its angles, its distance and its rays."""
    text = (
        "ego = new Object at (0, 0, 0), facing 90 deg, with viewAngles (40 deg, 20 deg), with visibleDistance 5, with cameraOffset (0, 1, 0)\n"
        "other = new Object at (20, 0, 0), with viewAngles (80 deg, 90 deg), with visibleDistance 9\n"
        "eye = Uniform(ego, other)\n"
        "places = [(-5.9, 0, 0), (-6.1, 0, 0), (-4, 1, 0), (-4, 1.2, 0), (-4, 0, 0.5), (-4, 0, 0.6), (20, 8.9, 0), (20, 9.1, 0), (24, 5, 0), (20, 4, 3.9)]\n"
        "param x = (eye.x, [eye.canSee(p) for p in places], [eye.visibleRegion.containsPoint(p) for p in places])\n"
    )
    seen = {0: [1, 0, 1, 0, 1, 0, 0, 0, 0, 0], 20: [0, 0, 0, 0, 0, 0, 1, 0, 1, 1]}
    drawn = [scene.params["x"] for scene in scenic.scenarioFromString(text).sample(12, seed=2)]
    assert {x for x, _, _ in drawn} == {0, 20}
    for x, looked, held in drawn:
        assert looked == list(map(bool, seen[x]))
        assert held == looked


def test_angles_that_are_drawn_are_those_that_are_looked_in() -> None:
    """From one that sees a place to one that does not, across and upward."""
    text = (
        "a = Range(0.5, 0.8)\nacross = new Object at (0, 0, 0), with viewAngles (a, 1), with allowCollisions True\n"
        "upward = new Object at (0, 0, 0), with viewAngles (1, a), with allowCollisions True\n"
        "ego = new Object at (0, -9, 0)\nparam a = a, across = [across.canSee((x, 3, 0)) for x in (-1, 1)]\n"
        "param upward = [upward.canSee((0, 3, z)) for z in (-1, 1)]\n"
    )
    answers = set()
    for scene in scenic.scenarioFromString(text).sample(20, seed=1):
        seen = bool(scene.params["a"] / 2 > math.atan(1 / 3))
        assert scene.params["across"] == scene.params["upward"] == [seen, seen]
        answers.add(seen)
    assert answers == {True, False}


@pytest.mark.parametrize(
    "things", ["[wall]", "(wall,)", "{wall}", "{wall: 1}", "iter([wall])", "(each for each in [wall])"]
)
def test_what_may_hide_others_comes_in_any_kind_of_sequence(things: str) -> None:
    text = (
        "ego = new Object\nwall = new Object at (0, 3, 0), with width 3, with height 3, with length 0.1\n"
        "box = new Object at (0, Range(6, 7), 0)\none, looker = Uniform(box, box), Uniform(ego, ego)\n"
        "param seen = [who.canSee(what, {0}) for who in (ego, looker) for what in (box, one, (0, 6, 0))]\n"
        "param sure = [who.canSee(what, {0}, certain=True) for who in (ego, looker) for what in (box, one)]\n"
    )
    found = answers(text.format(things))
    assert found == {"seen": [False] * 6, "sure": [False] * 4}
