"""A random choice among regions: in specifiers, containers, conditions and values."""

import math

import numpy as np
import pytest

from runtime.programs import draws, failure, scenario, thing
from scenic.graph.bounds import Bounds
from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import RegionChoice
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.combinations import DifferenceRegion, IntersectionRegion
from scenic.runtime.regions.composite import exactly_contains
from scenic.runtime.regions.knowledge import distance_bounds
from scenic.runtime.regions.lines import PathRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.regions.stacked import body_of
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from scenic.runtime.shapes.shapes import BoxShape, ConeShape, CylinderShape
from scenic.runtime.values.values import Orientation, Vector, uniform

REGIONS = (
    "disc = CircularRegion((0, 0, 1), 2)\nplate = RectangularRegion((10, 0, 3), 0.5, 2, 4)\n"
    "ball = SpheroidRegion((2, 2, 2), (0, 20, 0))\nlocal = Uniform(disc, plate, ball)\n"
)


def test_points_are_drawn_in_each_option_with_its_probability() -> None:
    text = (
        REGIONS
        + "p = new Point in local\nparam x = (p.x, p.y, p.z, disc.containsPoint(p), plate.containsPoint(p), ball.containsPoint(p))\n"
    )
    values = np.array(draws(text, n=900), dtype=float)
    counts = values[:, 3:].sum(axis=0)
    assert counts.sum() == 900
    assert (np.abs(counts - 300) < 75).all()
    assert set(np.round(values[values[:, 3] == 1, 2], 12)) == {1.0}
    assert set(np.round(values[values[:, 4] == 1, 2], 12)) == {3.0}


def test_a_container_may_be_a_choice() -> None:
    text = REGIONS + (
        "room = Uniform(disc, plate)\n"
        "o = new Object in room, with regionContainedIn room, with width 0.5, with length 0.5\n"
        "param x = (disc.containsObject(o), plate.containsObject(o))\n"
    )
    values = draws(text, n=60)
    assert all(one != other for one, other in values)
    assert {one for one, _ in values} == {True, False}


def test_conditions_ask_the_drawn_region_alone() -> None:
    text = REGIONS + "x = Range(0, 12)\nroom = Uniform(disc, plate)\nrequire (x, 0, 1) in room\nparam x = x\n"
    values = np.array(draws(text, n=100))
    assert ((values < 2) | (values > 8)).all()
    assert {bool(value < 5) for value in values} == {True, False}
    distance = REGIONS + "param x = distance from (0, 0, 1) to local\n"
    found = sorted({round(value, 9) for value in draws(distance, n=60)})
    assert found[0] == 0
    assert found[-1] == pytest.approx(np.hypot(20, 1) - 1)
    assert len(found) == 3


def test_a_region_with_random_parameters_is_sampled() -> None:
    text = "r = CircularRegion((0, 0), Range(1, 2))\nparam x = (r.radius, r)\n"
    for radius, region in draws(text, n=20):
        assert region.radius == radius
        assert region.containsPoint((radius * 0.999, 0)) is True
        assert region.containsPoint((radius * 1.001, 0)) is False


@pytest.mark.parametrize("made", ["r", "visible r"])
def test_the_region_that_is_drawn_is_sampled_itself(made: str) -> None:
    """Also as a member of another one."""
    text = (
        "ego = new Object\n"
        "r = Uniform(CircularRegion((0, 0), Range(1, 2)), RectangularRegion((Range(3, 4), 0), 0, 1, 1))\n"
    )
    parts = [getattr(region, "members", [region]) for region in draws(f"{text}param x = {made}\n", n=20)]
    found = [part for members in parts for part in members if type(part).__name__ != "ViewRegion"]
    assert len(found) == 20
    assert {type(region).__name__ for region in found} == {"CircularRegion", "RectangularRegion"}
    for region in found:
        assert not region.is_random
        if type(region).__name__ == "CircularRegion":
            assert 1 < region.radius < 2
            assert region.containsPoint((region.radius * 0.999, 0)) is True
        else:
            assert 3 < region.position.x < 4
            assert region.containsPoint(region.position) is True


def test_a_workspace_that_is_drawn_meets_what_its_region_meets() -> None:
    text = (
        "workspace = Workspace(CircularRegion((0, 0), 5))\nfar = CircularRegion((50, 0), 3)\n"
        "ego = new Object at (Range(1, 2), 0, 0)\nplace = Uniform(workspace, far)\n"
        "param x = (far.containsPoint(place.center), ego intersects place, place intersects ego)\n"
    )
    found = draws(text, n=20)
    assert set(found) == {(False, True, True), (True, False, False)}


def test_all_of_space_cannot_be_drawn_from() -> None:
    for options in ("disc, everywhere", "everywhere, disc", "ball, plate, everywhere"):
        error = failure(REGIONS + f"new Object in Uniform({options})")
        assert isinstance(error, InvalidScenarioError)
        assert "no point can be drawn uniformly from all of space" in str(error)


def roll_of_a_tilted_top() -> float:
    """The roll of the top of the object below that is rolled by 0.5."""
    tilted = thing("ego = new Object facing (0.3, 0, 0.5)")
    return float(tilted.topSurface.orientation[tilted.top.position].roll)


def test_things_land_on_the_option_that_is_drawn() -> None:
    text = (
        "low = new Object at (0, 0, 0), with allowCollisions True\n"
        "high = new Object at (0, 0, 9), with allowCollisions True\n"
        "tilted = new Object at (0, 0, 20), facing (0.3, 0, 0.5), with allowCollisions True\n"
        "aside = new Object at (40, 0, 0)\n"
        "new Object at (0, 0, 30), on {where}, with allowCollisions True, with onDirection (0, 0, 1)\n"
        "param x = (ego.z, ego.parentOrientation)\n"
    )
    level = text.replace("new Object at (0, 0, 30)", "ego = new Object at (0, 0, 30)")
    heights = [height for height, _ in draws(level.format(where="Uniform(low, high)"), n=60)]
    assert sorted({round(height, 3) for height in heights}) == [1, 10]
    assert 15 < sum(height > 5 for height in heights) < 45
    # Where the option that is drawn is missed, the candidate is rejected; one that is not drawn rejects nothing.
    missed = [height for height, _ in draws(level.format(where="Uniform(low, aside, high)"), n=60)]
    assert 15 < sum(height > 5 for height in missed) < 45
    frames = [frame for _, frame in draws(level.format(where="Uniform(tilted, high)"), n=40)]
    assert {round(frame.roll, 6) for frame in frames} == {0.0, round(roll_of_a_tilted_top(), 6)}


def test_random_vectors_are_places_to_stand_on() -> None:
    found = draws("ego = new Object on Uniform((1, 2), (3, 4, 5))\nparam x = tuple(ego.position)", n=30)
    assert {tuple(round(part, 4) for part in place) for place in found} == {(1, 2, 0.5), (3, 4, 5.5)}


TILT = Orientation.fromEuler(0.7, 0.4, -0.3)
OPTIONS: list[Region] = [
    CircularRegion(Vector(1, 2, 3), 4),
    BoxRegion(dimensions=(4, 1, 2), position=(-6, -2, 3), rotation=TILT),
    PathRegion(polylines=[[(0, 0, 0), (1, 2, 13)], [(5, -5, 5), (5, 5, 9)]]),
    SpheroidRegion(dimensions=(3, 9, 5), position=(1, 12, 3), rotation=TILT),
    RectangularRegion(Vector(-1, 2, -4), 0.6, 7, 0.5),
]


@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4), (3, 4, 1, 0, 2), (2, 1)])
def test_each_lane_is_answered_by_its_own_option(order: tuple[int, ...]) -> None:
    """Every reading over columns, with parameters that are the same in all lanes or differ from lane to lane."""
    options = [OPTIONS[number] for number in order]
    region = RegionChoice(0, options)
    rng = np.random.default_rng(2)
    lanes = 60
    index = rng.integers(0, len(options), lanes)
    shared = [option.fixed_columns("a test") for option in options]
    spread = [
        [column + 0.01 * np.arange(lanes).reshape(lanes, *(1,) * (column.ndim - 1)) for column in columns]
        if type(option) in (CircularRegion, RectangularRegion)
        else columns
        for option, columns in zip(options, shared, strict=True)
    ]
    points = rng.uniform((-8, -6, -5), (6, 16, 10), (lanes, 3))
    body = Body(
        (primitives.box(), primitives.cone()),
        rng.integers(0, 2, lanes),
        Poses(points, np.array([[0.0, 0, 0, 1]]), rng.uniform(0.05, 2, (lanes, 3))),
    )
    uniforms, keys = rng.random((region.draws, lanes)), rng.integers(0, 2**63, lanes).astype(np.uint64)
    for columns in (shared, spread):
        flat = [index, *(column for mine in columns for column in mine)]
        found = {
            "contains": region.contains_points(points, *flat),
            "holds": region.contains_bodies(body, lanes, *flat),
            "meets": region.meets_bodies(body, lanes, *flat),
            "gaps": region.gaps(points, *flat),
            "distances": region.distances(points, *flat),
            "sizes": region.sizes(*flat),
            "draws": region.draw_points(uniforms, keys, *flat)[0],
        }
        lower, upper = region.box(*flat)
        for lane in range(lanes):
            one = np.array([lane])
            option = options[index[lane]]
            mine = [column if len(column) == 1 else column[one] for column in columns[index[lane]]]
            alone = {
                "contains": option.contains_points(points[one], *mine),
                "holds": option.contains_bodies(body.take(one), 1, *mine),
                "meets": option.meets_bodies(body.take(one), 1, *mine),
                "gaps": option.gaps(points[one], *mine),
                "distances": option.distances(points[one], *mine),
                "sizes": option.sizes(*mine),
                "draws": option.draw_points(uniforms[: option.draws, one], keys[one], *mine)[0],
            }
            for name, value in alone.items():
                np.testing.assert_allclose(
                    found[name][lane], np.ravel(value) if name == "draws" else value[0]
                )
            # Wherever the option may be drawn from lies in the box.
            row = 0 if len(lower) == 1 else lane
            for other, all_columns in zip(options, columns, strict=True):
                rest = [column if len(column) == 1 else column[one] for column in all_columns]
                place = other.draw_points(uniforms[: other.draws, one], keys[one], *rest)[0]
                assert (lower[row] <= place + 1e-9).all()
                assert (place <= upper[row] + 1e-9).all()
        assert len(np.unique(found["contains"])) == 2 or order == (2, 1)
    assert region.dimension == max(option.dimension for option in options)
    assert region.has_orientation is all(option.has_orientation for option in options)


def test_each_option_is_asked_of_the_shapes_of_its_own_lanes() -> None:
    """Where the pose of the body is fixed and its shape, a unit cube or the ball in it, is not."""
    near = SpheroidRegion((1.5, 1.5, 1.5))  # which misses the corners of the cube
    around = SpheroidRegion((2, 2, 2))
    corner, middle, far = (BoxRegion((0.2, 0.2, 0.2), (x, x, x)) for x in (0.5, 0, 3))
    index, shape = np.array([1, 0, 2, 0, 1, 0, 1]), np.array([0, 1, 0, 0, 1, 1, 0])
    body = Body((primitives.box(), primitives.spheroid()), shape, Poses.fixed((0, 0, 0)))
    holders = RegionChoice(0, [near, around, far])
    columns = [column for option in holders.options for column in option.fixed_columns("a test")]
    found = holders.contains_bodies(body, 7, index, *columns)
    np.testing.assert_array_equal(found, (index == 1) | ((index == 0) & (shape == 1)))
    touched = RegionChoice(0, [corner, middle, far])
    columns = [column for option in touched.options for column in option.fixed_columns("a test")]
    found = touched.meets_bodies(body, 7, index, *columns)
    np.testing.assert_array_equal(found, (index == 1) | ((index == 0) & (shape == 0)))


def test_a_choice_among_lines_has_the_direction_of_the_one_drawn() -> None:
    lines = [PathRegion([(0, 0, 0), (4, 1, 2)]), PathRegion([(0, 0, 0), (-1, 3, 0)])]
    region = RegionChoice(0, lines)
    assert region.has_orientation
    index = np.array([1, 0, 0, 1])
    found = region.orientations(np.zeros((1, 3)), index)
    for lane, number in enumerate(index):
        np.testing.assert_array_equal(found[lane], lines[number].orientations(np.zeros((1, 3)))[0])
    # One that all lanes draw is asked of the point of each.
    bend = RegionChoice(0, [lines[0], PathRegion([(0, 0, 0), (4, 0, 0), (4, 4, 0)])])
    points = np.array([(1.0, 0, 0), (4, 3, 0), (2, 0, 0)])
    found = bend.orientations(points, np.array([1]))
    np.testing.assert_array_equal(found, bend.options[1].orientations(points))
    found = bend.orientations(points[[0, 2, 1]], np.array([1, 0, 1]))
    for lane, (option, place) in enumerate(((1, 0), (0, 2), (1, 1))):
        np.testing.assert_array_equal(found[lane], bend.options[option].orientations(points[[place]])[0])
    assert not RegionChoice(0, [lines[0], OPTIONS[0]]).has_orientation
    # Footprints of the plane, and of what is none already.
    assert RegionChoice(0, lines).footprint.options == tuple(lines)
    assert RegionChoice(0, [OPTIONS[0], OPTIONS[1]]).footprint.dimension == 3


def test_a_choice_among_regions_with_fields_asks_that_of_the_one_drawn() -> None:
    """Whatever gives the orientation: a field, the line itself, or a member; a field that fails elsewhere does no harm."""
    text = (
        "def other(p):\n    assert 4 < p.x < 5\n    return 2 * p.x\n"
        "f, g = VectorField('f', lambda p: p.x), VectorField('g', other)\n"
        "square = PolygonalRegion([(1, 0), (2, 0), (2, 1), (1, 1)], orientation=f)\n"
        "later = PolygonalRegion([(4, 0), (5, 0), (5, 1), (4, 1)], orientation=g)\n"
        "line = PolylineRegion([(7, 0), (8, 1)])\n"
        "part = BoxRegion((1, 1, Range(1, 2)), (9.5, 0, 0), orientation=f).intersect(BoxRegion((2, 2, 2), (9.5, 0, 0)))\n"
        "place = Uniform(square, Uniform(later, line), part)\n"
        "ego = new Object in place, with regionContainedIn everywhere\n"
        "there = new OrientedPoint at (Range(1.1, 4.9), 0.5, 3), on Uniform(square, later)\n"
        "param x = [(p.position.x, p.heading) for p in (ego, there)]\n"
    )
    kinds = set()
    for places in draws(text, n=40):
        for x, heading in places:
            expected = x if x < 4 or x > 9 else 2 * x if x < 6 else -math.pi / 4
            assert math.remainder(heading - expected, 2 * math.pi) == pytest.approx(0, abs=1e-9)
            kinds.add(int(x))
    assert kinds == {1, 4, 7, 9}


@pytest.mark.parametrize("operation", ["intersect", "union", "difference"])
@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize(
    "options", ["CircularRegion((0, 0, 0), 1), BoxRegion()", "disc, CircularRegion((0, 0, 3), 1)"]
)
def test_a_choice_is_an_operand_as_the_region_that_it_draws(
    operation: str, swapped: bool, options: str
) -> None:
    """Points are drawn from what that and the other one come to, whose dimension may depend on the option."""
    one, other = ("choice", "box") if swapped else ("box", "choice")
    text = (
        "disc = CircularRegion((0, 0, 0), 1)\nbox = BoxRegion((1.6, 1.6, Range(0.9, 1)))\n"
        f"choice = Uniform({options})\nmade = {one}.{operation}({other})\np = new Point in made\n"
        "param choice = choice, box = box, made = made, p = p.position, meets = box.intersects(choice)\n"
    )
    if operation == "intersect" and "3" in options:
        text += "require choice.center.z == 0\n"
    kinds = set()
    for scene in scenario(text).sample(8, seed=2):
        drawn, box, made, point = (scene.params[name] for name in ("choice", "box", "made", "p"))
        first, second = (drawn, box) if swapped else (box, drawn)
        expected = getattr(first, operation)(second)
        assert (made.dimension, type(made)) == (expected.dimension, type(expected))
        assert exactly_contains(expected, np.array([point]), expected.fixed_columns("a test"))[0]
        assert scene.params["meets"] is (not isinstance(drawn, CircularRegion) or drawn.height == 0)
        kinds.add(type(drawn))
    assert len(kinds) == (1 if "3" in options else 2)


@pytest.mark.parametrize("made", ["disc.union(choice)", "choice.union(disc)"])
def test_points_of_a_union_with_a_choice_are_drawn_from_what_is_larger_in_that_scene(made: str) -> None:
    """From the disc beside a line, and from the box beside the disc."""
    text = (
        "disc = CircularRegion((0, 0), Range(1, 2))\nchoice = Uniform(PolylineRegion([(9, 0), (9, 5)]), BoxRegion((1, 1, 1), (20, 0, 0)))\n"
        f"made = {made}\nx = (new Point in made).position\nparam x = (x.x, choice.dimension, made)\n"
    )
    found = draws(text, n=20)
    assert {dimension for _, dimension, _ in found} == {1, 3}
    for x, dimension, region in found:
        assert (abs(x) <= 2) is (dimension == 1)
        assert region.dimension == max(2, dimension)


def test_points_count_at_the_height_of_the_option_of_their_lane() -> None:
    low, high = CircularRegion(Vector(0, 0, 0), 2), CircularRegion(Vector(0, 0, 3), 1)
    region = RegionChoice(0, [low, high, BoxRegion((2, 2, 2))])
    index = np.array([1, 0, 2, 1, 0, 2, 1])
    places = [(0.5, 0, 3), (1.5, 0, 0), (0.5, 0, 0.5), (0.5, 0, 0), (0.5, 0, 3), (0, 0, 3), (1.5, 0, 3)]
    points, expected = np.array(places), np.array([True, True, True, False, False, False, False])
    columns = [column for option in region.options for column in option.fixed_columns("a test")]
    for order in (np.arange(7), np.arange(7)[::-1], np.array([3, 0, 6, 1, 4, 2, 5])):
        found = exactly_contains(region, points[order], [index[order], *columns])
        np.testing.assert_array_equal(found, expected[order])
        assert found.dtype == np.bool_
        # What is left of all that is around has the others.
        rest = DifferenceRegion(BoxRegion((9, 9, 9)), region)
        around = rest.regionA.fixed_columns("a test")
        held = exactly_contains(rest, points[order], [*around, index[order], *columns])
        np.testing.assert_array_equal(held, ~expected[order])


def test_lanes_in_which_no_point_is_found_are_told_of_every_option() -> None:
    nothing = IntersectionRegion(BoxRegion((1, 1, 1)), BoxRegion((1, 1, 1), (4, 0, 0)))
    full = BoxRegion((2, 2, 2), (9, 9, 9))
    index = np.array([0, 1, 1, 0])
    for empty in (
        nothing,
        Workspace(nothing),
        Workspace(Workspace(nothing)),
        DifferenceRegion(nothing, full),
    ):
        region = RegionChoice(0, [empty, full])
        columns = [column for option in region.options for column in option.fixed_columns("a test")]
        keys = np.arange(4, dtype=np.uint64)
        points, known = region.draw_points(np.full((region.draws, 4), 0.5), keys, index, *columns)
        assert known is not None
        assert known.tolist() == [False, True, True, False]
        np.testing.assert_allclose(points[1:3], 9)


def test_what_a_choice_holds_and_what_holds_it_is_not_known_before_it_is_drawn() -> None:
    region = RegionChoice(uniform(), OPTIONS[:2])
    for one, other in ((region, OPTIONS[1]), (OPTIONS[1], region), (region, region)):
        with pytest.raises(ScenicTypeError, match="random"):
            one.containsRegion(other)


def test_each_lane_has_the_body_of_its_shape() -> None:
    """Also where others have none, because theirs is rejected or fails."""
    text = (
        "from scenic.core.distributions import RejectionException\nn = DiscreteRange(0, 3)\n"
        "@distributionFunction\ndef shape(n):\n    if n == 0: raise RejectionException('no shape')\n"
        "    return [BoxShape(), ConeShape(), CylinderShape()][n - 1]\n"
        "ego = new Object with shape shape(n), with regionContainedIn everywhere\nspot = Vector(0.45, 0.45, 0.45)\n"
        "rim = Vector(0.3, 0.3, 0.45)\nparam x = (n, ego.containsPoint(spot), ego.containsPoint(rim))\n"
    )
    seen = set(draws(text, n=60))
    assert seen == {(1, True, True), (2, False, False), (3, False, True)}


@pytest.mark.parametrize("missing", [(0,), (1,), (0, 2), (0, 1, 2)])
def test_a_box_stands_in_for_a_shape_that_could_not_be_drawn(missing: tuple[int, ...]) -> None:
    """Its lane has a fault; those beside it have their own shapes."""
    shapes = np.array([ConeShape(), BoxShape(), CylinderShape()], dtype=object)
    expected = [shape.mesh for shape in shapes]
    for lane in missing:
        shapes[lane], expected[lane] = None, primitives.box()
    body = body_of(np.zeros((3, 3)), np.array([[0.0, 0, 0, 1]]), np.ones((1, 3)), shapes)
    choice = np.zeros(3, dtype=int) if body.choice is None else body.choice
    assert [body.meshes[number] for number in choice] == expected


def test_points_that_a_choice_of_regions_draws_are_drawn_in_each_sample() -> None:
    """In the region that is drawn; where that has none, the sample is rejected."""
    text = (
        "near, far = CircularRegion((0, 0), 1), BoxRegion((1, 2, 3), (9, 9, 9))\n"
        "r = Uniform(near, far, nowhere)\n"
        "param x = r.uniformPointInner(), r = r, y = [r.uniformPointInner(), r.uniformPointInner()]\n"
    )
    found = scenario(text)
    scenes = found.sample(60, seed=4)
    points = [scene.params["x"] for scene in scenes]
    assert len(set(map(tuple, points))) == 60
    for scene in scenes:
        region = scene.params["r"]
        assert all(region.containsPoint(point) for point in (scene.params["x"], *scene.params["y"]))
        assert len({tuple(point) for point in (scene.params["x"], *scene.params["y"])}) == 3
    assert 15 < sum(point.x < 2 for point in points) < 45
    assert 60 < sum(scene.attempts for scene in scenes) < 140
    assert [tuple(scene.params["x"]) for scene in found.sample(60, seed=4)] == list(map(tuple, points))


def test_bounds_of_a_choice_hold_what_its_boxes_draw() -> None:
    random = np.random.default_rng(5)
    lines = [PathRegion(np.cumsum(random.normal(size=(6, 3)), axis=0).tolist()) for _ in range(5)]
    choice = RegionChoice(0, lines)
    index = np.sort(random.integers(0, 5, (2, 300)), axis=0).astype(float)
    number = np.sort(random.random((2, 300)), axis=0)
    bounds = choice.drawn_extent([Bounds(*number)], Bounds(*index))
    assert bounds is not None
    for _ in range(30):
        shares = random.random((2, 300))
        drawn = np.floor(index[0] + shares[0] * (index[1] - index[0] + 1)).clip(*index).astype(int)
        ways = number[0] + shares[1] * (number[1] - number[0])
        points, _ = choice.draw_points(ways[np.newaxis], np.zeros(300, dtype=np.uint64), drawn)
        assert (bounds.lower - 1e-9 <= points).all()
        assert (points <= bounds.upper + 1e-9).all()
    # Where the index is known, the box is that of a part of its line; else that of the lines which it may draw.
    known = np.flatnonzero(index[0] == index[1])
    lower, upper = lines[int(index[0, known[0]])].box()
    assert (bounds.upper - bounds.lower)[known[0]].sum() < (upper - lower).sum()
    whole = choice.extent(Bounds(np.zeros(1), np.full(1, 4.0)))
    assert whole is not None
    assert np.allclose(whole.upper, np.max([line.box()[1] for line in lines], axis=0))


def test_distances_are_bounded_where_the_choice_is_known() -> None:
    lines = [PathRegion([(0, y, 0), (100, y, 0)]) for y in (0, 50)]
    choice = RegionChoice(0, lines)
    place = Bounds(np.array([[1.0, 9.0, 0.0]] * 3), np.array([[3.0, 11.0, 0.0]] * 3))
    found = distance_bounds(choice, place, Bounds(np.array([0.0, 1.0, 0.0]), np.array([0.0, 1.0, 1.0])))
    assert found is not None
    assert found.lower[0] > 8
    assert found.upper[0] < 12
    assert found.lower[1] > 38
    assert found.upper[1] < 42
    assert found.upper[2] == np.inf


def test_a_container_that_draws_none_is_the_workspace() -> None:
    scenes = scenario(
        "workspace = Workspace(RectangularRegion((0, 0), 0, 40, 40))\n"
        "small = RectangularRegion((0, 0), 0, 10, 10)\n"
        "ego = new Object at (Range(-30, 30), 0), with regionContainedIn Uniform(small, None)\n"
    ).sample(40, seed=1)
    reach = {
        free: max(
            abs(s.egoObject.position.x) for s in scenes if (s.egoObject.regionContainedIn is None) == free
        )
        for free in (False, True)
    }
    assert reach[False] <= 4.5 < 10 < reach[True] <= 19.5
