"""Regions that code of the program gives: nothing is known of them before they are drawn."""

import math

import numpy as np
import pytest
from scipy import stats

from scenic.language.errors import InvalidScenarioError, RejectionException, ScenicTypeError
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.drawn import DrawnRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.volumes import BoxRegion
from tests.runtime.programs import (
    FALSE_ALARM,
    assert_same_rotation,
    failure,
    fingerprint,
    place,
    rotation,
    scenario,
)

SETTING = """
told = distributionFunction(lambda value, _: value)
way = VectorField("way", lambda place: 0.5 + 0.01 * place.x)
road = PolygonalRegion([(2, 2), (8, 2), (8, 8), (2, 8)], orientation=way)
disc = CircularRegion((5, 5, 1), 3)
box = BoxRegion(position=(5, 5, 5), dimensions=(4, 5, 6))
hollow = BoxRegion(dimensions=(4, 5, 6)).difference(BoxRegion(dimensions=(3, 4, 5)))
line = PolylineRegion([(0, 0), (4, 0), (4, 3)])
grown = CircularRegion((0, 0), Range(2, 3))
both = CircularRegion((0, 0), 1).union(CircularRegion((20, 20), 2))
points = PointSetRegion("points", [(1, 2, 3), (4, 5, 6)])
ego = new Object at (-50, -50)
"""


def drawn(text: str) -> str:
    return f"told({text}, Range(0, 1))"


@pytest.mark.parametrize("name", ["road", "disc", "box", "hollow", "line", "grown", "both", "points"])
def test_points_have_the_law_of_the_region(name: str) -> None:
    text = f"{SETTING}p = new OrientedPoint in {drawn(name)}\nq = new OrientedPoint in {name}\nparam p = p, q = q\n"
    found = [
        [[*item.params[key].position, item.params[key].heading] for key in "pq"]
        for item in scenario(text).sample(300, seed=1)
    ]
    one, other = np.array(found).swapaxes(0, 1)
    for first, second in zip(one.T, other.T, strict=True):
        assert stats.ks_2samp(first, second).pvalue > FALSE_ALARM
        assert (np.ptp(first) > 0) == (np.ptp(second) > 0)


def test_each_lane_has_the_region_that_it_draws() -> None:
    region = drawn("Uniform(disc, box, grown)")
    text = f"{SETTING}r = {region}\nnew Object contained in r, with width 0.1, with length 0.1, with height 0.1\nparam r = r\n"
    seen = []
    for item in scenario(text).sample(90, seed=1):
        seen.append(str(item.params["r"]))
        assert item.objects[1].regionContainedIn is item.params["r"]
        assert item.params["r"].containsObject(item.objects[1])
        assert item.params["r"].is_random is False
    assert 15 < seen.count("<BoxRegion>") < 45


@pytest.mark.parametrize("lanes", [1, 7, 64])
def test_scenes_do_not_depend_on_lanes(lanes: int) -> None:
    text = (
        f"{SETTING}r = {drawn('Uniform(road, hollow, both)')}\n"
        "new Object in r, with width 0.1, with length 0.1\nnew Object on r, with allowCollisions True\nrequire ego.x < 0\n"
    )
    scenes = scenario(text).sample(12, seed=3, lanes=lanes)
    assert [fingerprint(item) for item in scenes] == [
        fingerprint(item) for item in scenario(text).sample(12, seed=3)
    ]


@pytest.mark.parametrize("lanes", [1, 64])
@pytest.mark.parametrize(
    "empty",
    [
        "nowhere",
        "disc.difference(CircularRegion((5, 5, 1), Range(4, 5)))",
        "box.intersect(BoxRegion(position=(Range(15, 16), 5, 5), dimensions=(4, 5, 6), rotation=(0.1, 0.2, 0)))",
    ],
)
@pytest.mark.parametrize("choice", [drawn("Uniform({})"), "Uniform({})"])
def test_where_a_region_turns_out_empty_no_scene_is_made(choice: str, empty: str, lanes: int) -> None:
    text = f"{SETTING}p = new Point in {choice.format(f'disc, {empty}')}\nparam p = p\n"
    places = [item.params["p"].position for item in scenario(text).sample(6, seed=1, lanes=lanes)]
    assert all(math.dist(place, (5, 5, 1)) <= 3 for place in places)
    assert len(set(places)) == 6


def test_what_is_on_something_drawn_rests_on_it() -> None:
    text = SETTING + (
        "table = new Object at (30, 30), with width 4, with length 4, with height 2\n"
        f"a = new Object on {drawn('road')}\n"
        f"b = new Object on {drawn('table')}, with width 0.5, with length 0.5, with height 0.5\n"
        f"c = new Object on {drawn('(90, 90, 9)')}\n"
        f"d = new Object at (30 + DiscreteRange(0, 9), 31, 40), on {drawn('table')}, with allowCollisions True, with width 0.2\n"
    )
    landed = set()
    for item in scenario(text).sample(20, seed=2):
        _, _, a, b, c, d = item.objects
        assert a.z == pytest.approx(0.50005)
        assert a.heading == pytest.approx(0.5 + 0.01 * a.x)
        assert b.z == pytest.approx(1.25005)
        assert abs(b.x - 30) <= 2
        assert tuple(c.position) == pytest.approx((90, 90, 9.50005))
        assert d.z == pytest.approx(1.50005)
        landed.add(d.x)
    assert landed == {30, 31, 32}  # where there is no table the candidate is rejected


@pytest.mark.parametrize("start", [(0.9, 0.3, 0.2), (-0.9, 0.3, 0.2), (0.3, 0.9, -0.2), (0.5, 0.3, 5)])
@pytest.mark.parametrize("name", ["surface", "turned", "slope"])
def test_what_lands_on_something_drawn_is_turned_as_where_it_lands(
    name: str, start: tuple[float, float, float]
) -> None:
    """Not as what is nearest to where it comes from: that may be a wall."""
    text = SETTING + (
        "surface = BoxRegion(dimensions=(2, 2, 2)).getSurfaceRegion()\n"
        "turned = MeshSurfaceRegion(box.mesh, (2, 2, 2), rotation=(0.7, 0.4, -0.3), "
        "orientation=VectorField('up', lambda place: place.z))\n"
        "slope = MeshSurfaceRegion(box.mesh, (2, 2, 2), rotation=(0.7, 0.4, -0.3))\n"
        f"a = new OrientedPoint at {start}, on {drawn(name)}\nb = new OrientedPoint at {start}, on {name}\n"
        "param a = a, b = b\n"
    )
    found = scenario(text).sample(1, seed=1)[0].params
    assert tuple(found["a"].position) == pytest.approx(tuple(found["b"].position))
    assert_same_rotation(found["a"].orientation, rotation(found["b"].orientation))
    if name == "surface":
        height = found["a"].position.z
        assert abs(height) == pytest.approx(1)
        np.testing.assert_allclose(
            rotation(found["a"].orientation).apply([0, 0, 1]), [0, 0, height], atol=1e-9
        )


def test_a_container_holds_all_of_an_object() -> None:
    text = (
        f"{SETTING}r = {drawn('grown')}\n"
        "o = new Object at (Range(-3, 3), 0, 7), with regionContainedIn r, with height 0.1\nparam r = r\n"
    )
    reach = [
        item.params["r"].radius - math.hypot(abs(item.objects[1].x) + 0.5, 0.5)
        for item in scenario(text).sample(100, seed=1)
    ]
    assert -1e-9 <= min(reach) < 0.1
    gone = f"{SETTING}new Object at (9, 9), with regionContainedIn {drawn('grown')}\n"
    with pytest.raises(RejectionException):
        scenario(gone).sample(1, seed=1, max_attempts=50)


@pytest.mark.parametrize("hidden", ["region", "observer", "both"])
def test_what_is_in_view_is_known_when_it_is_drawn(hidden: str) -> None:
    region = "CircularRegion((6, 0), 4)"
    observer = "watch"
    text = (
        "told = distributionFunction(lambda value, _: value)\n"
        "ego = new Object at (-50, 0)\nwatch = new Object at (0, 0), facing -90 deg, with viewAngle 90 deg, with visibleDistance 6\n"
        f"region = {drawn(region) if hidden != 'observer' else region}\n"
        f"observer = {drawn(observer) if hidden != 'region' else observer}\n"
        "param seen = new Point in (region visible from observer), unseen = new Point in (region not visible from observer)\n"
    )
    for item in scenario(text).sample(20, seed=1):
        for name, wanted in (("seen", True), ("unseen", False)):
            x, y, z = item.params[name].position
            assert math.hypot(x - 6, y) <= 4 + 1e-9
            assert z == pytest.approx(0)
            assert (math.hypot(x, y) <= 6 and abs(y) <= x) is wanted


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("in X", "`in`: expected a region, not 3"),
        ("on X", "`on`: expected a region, an object or a vector, not 3"),
        ("contained in X", "`contained in`: expected a region, not 3"),
        ("with regionContainedIn X", "property 'regionContainedIn': expected a region, not 3"),
        ("in (visible X)", "`visible`: expected a region, not 3"),
        ("in (disc visible from X)", "`visible from`: expected a point or an object, not 3"),
    ],
)
def test_what_is_no_region_is_told(words: str, wanted: str) -> None:
    error = failure(f"{SETTING}new Object {words.replace('X', drawn('3'))}\n")
    assert isinstance(error, ScenicTypeError)
    assert wanted in str(error)
    assert place(error)[1].startswith("13:")


def test_primitives_are_those_of_the_region_of_each_lane() -> None:
    options = [
        CircularRegion((0, 0), 2),
        BoxRegion(dimensions=(2, 2, 2)),
        RectangularRegion((1, 1), 0.3, 4, 2),
    ]
    column = np.empty(8, dtype=object)
    column[:] = [options[number] for number in (0, 1, 2, 0, 2, 1, 1, 0)]
    column[3] = None  # what has been rejected has none
    region = object.__new__(DrawnRegion)
    random = np.random.default_rng(5)
    points = np.concatenate([random.uniform(-2, 2, (8, 2)), np.zeros((8, 1))], axis=1)
    turned = np.tile([0.0, 0.0, 0.0, 1.0], (8, 1))
    body = Body((primitives.box(),), None, Poses(points, turned, np.full((8, 3), 0.4)))
    for primitive in ("contains_points", "contains_bodies", "meets_bodies", "distances"):
        inputs = (points,) if primitive in ("contains_points", "distances") else (body, 8)
        found = getattr(region, primitive)(*inputs, column)
        assert not found[3]
        for lane, option in enumerate(column):
            if option is not None:
                alone = (points[lane : lane + 1],) if len(inputs) == 1 else (body.take(np.array([lane])), 1)
                (expected,) = getattr(option, primitive)(*alone, *option.fixed_columns("it"))
                assert found[lane] == expected
    # One region for all lanes is given once.
    for option in options:
        column = np.empty(1, dtype=object)
        column[0] = option
        fixed = option.fixed_columns("it")
        np.testing.assert_array_equal(
            region.contains_points(points, column), option.contains_points(points, *fixed)
        )
        np.testing.assert_array_equal(
            region.contains_bodies(body, 8, column), option.contains_bodies(body, 8, *fixed)
        )


PROMISED = """
from scenic.core.regions import orientedRegion, unorientedRegion
field = VectorField("f", lambda place: 1)
oriented, line = PolygonalRegion([(0, 0), (1, 0), (1, 1)], orientation=field), PolylineRegion([(0, 0), (5, 5)])
plain, box = CircularRegion((0, 0), 3), RectangularRegion((9, 0), 0, 1, 1)
@distributionFunction
def pick(x, first, second):
    return first if x < 0.5 else second
x = Range(0, 1)
class Turned:
    parentOrientation: 0.25
ego = new Turned in {}
param heading = round(ego.heading, 3)
"""


def test_programs_promise_whether_drawn_regions_give_orientations() -> None:
    def headings(region: str) -> set[float]:
        found = scenario(PROMISED.format(region)).sample(6, seed=1)
        return {item.params["heading"] for item in found}

    assert headings("orientedRegion(oriented)") == {1}
    assert headings("unorientedRegion(oriented)") == {0.25}
    assert headings("orientedRegion(Uniform(oriented, line))") == {1, -0.785}
    assert headings("unorientedRegion(Uniform(oriented, line))") == {0.25}
    assert headings("orientedRegion(pick(x, oriented, line))") == {1, -0.785}
    assert headings("unorientedRegion(pick(x, oriented, line))") == {0.25}
    for region in ("plain", "pick(x, plain, box)"):
        with pytest.raises(InvalidScenarioError, match="has no preferred orientations"):
            headings(f"orientedRegion({region})")
    for function in ("orientedRegion", "unorientedRegion"):
        with pytest.raises(ScenicTypeError, match="expected a region"):
            headings(f"{function}(3)")
