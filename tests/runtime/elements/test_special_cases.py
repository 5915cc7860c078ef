"""Rules of regions, specifiers and operators that show only in corners."""

import io
import math
from typing import Any

import numpy as np
import pytest
import scenic.core.regions as named
import trimesh
from scenic.core.distributions import Distribution, distributionFunction, needsSampling
from scenic.core.lazy_eval import DelayedArgument
from scenic.core.object_types import Mutator
from scenic.core.simulators import DummySimulator
from scipy import stats

from scenic.graph.bounds import Bounds
from scenic.graph.operations import TABLE
from scenic.language.errors import (
    InvalidScenarioError,
    PreconditionViolation,
    RandomControlFlowError,
    ScenicTypeError,
)
from scenic.runtime.python.purity import is_pure
from scenic.runtime.regions.choice import RegionChoice
from scenic.runtime.regions.fields import VectorField
from scenic.runtime.regions.spaces import Workspace, everywhere, nowhere
from scenic.runtime.values.coercions import to_heading
from scenic.runtime.values.values import Orientation, Vector
from tests.runtime.programs import FALSE_ALARM, draws, failure, params, place, scenario, scene, thing

TILT = Orientation.fromEuler(0.7, 0.4, -0.3)


def test_lines_in_numbers() -> None:
    line = named.PolylineRegion([(0, 0), (3, 0), (3, 4)])
    assert line.cumulativeLengths == [3, 7]
    assert [tuple(point)[:2] for point in line.pointsSeparatedBy(2)] == [(0, 0), (2, 0), (3, 1), (3, 3)]
    assert line.signedDistanceTo(Vector(1, 1, 50)) == pytest.approx(math.hypot(1, 50))
    assert line.signedDistanceTo(Vector(1, -1, 50)) == pytest.approx(-math.hypot(1, 50))
    assert tuple(line.project(Vector(1, 1, 50))) == (1, 0, 0)


def test_vectors_of_what_is_no_number() -> None:
    for text in ("param x = Vector(1, 2, 'a')", "param x = Vector(None, 2)"):
        error = failure(text)
        assert isinstance(error, ScenicTypeError)
        assert "`Vector` needs three numbers" in str(error)
        assert (error.lineno, bool(error.help)) == (1, True)


def test_cells_of_grids_and_points() -> None:
    grid = named.GridRegion("grid", np.array([[0, 1, 0], [0, 0, 1]]), 2, 5, 0.5, -1)
    for cell in ((0, 0), (1, 1), (2, 0)):
        x, y = grid.gridToPoint(cell)
        for dx, dy in ((0.9, 2.4), (-0.9, -2.4)):
            assert grid.pointToGrid(Vector(x + dx, y + dy, 0)) == cell
            assert bool(grid.containsPoint(Vector(x + dx, y + dy, 0))) is bool(
                grid.grid[cell[1], cell[0]] == 0
            )
    cells = np.array([[0, 1]])
    own = named.GridRegion("own", cells, 1, 1, 0, 0)
    cells[:] = 1 - cells
    assert [bool(own.containsPoint(Vector(x, 0, 0))) for x in (0, 1)] == [True, False]
    assert grid.pointToGrid(Vector(-0.6, 0, 0)) is None
    assert grid.pointToGrid(Vector(5.6, 0, 0)) is None


def test_volumes_of_surfaces_are_where_these_are() -> None:
    surface = named.MeshSurfaceRegion(
        trimesh.creation.box((1, 2, 3)), dimensions=(2, 1, 4), position=(1, 2, 3), rotation=TILT
    )
    volume = surface.getVolumeRegion()
    np.testing.assert_allclose(np.array(volume.AABB), np.array(surface.AABB), atol=1e-9)
    assert volume.size == pytest.approx(8)


def test_choices_of_regions_are_as_their_options() -> None:
    field = named.PolygonalRegion([(0, 0), (1, 0), (1, 1)], orientation=object())
    plain, box = named.CircularRegion((0, 0), 1), named.BoxRegion()
    assert not RegionChoice(0, [field, plain]).has_orientation
    assert RegionChoice(0, [field, field]).has_orientation
    assert RegionChoice(0, [plain, box]).dimension == 3
    error = failure("x = Uniform(CircularRegion((0, 0), 1), 3)\nego = new Object in x\n")
    assert isinstance(error, ScenicTypeError)
    assert "expected a region" in str(error)


def test_set_operations_of_workspaces_and_nothing() -> None:
    box = named.BoxRegion((2, 2, 2))
    room: Any = Workspace(Workspace(box))
    assert room.intersect(named.BoxRegion((1, 1, 9))).size == pytest.approx(2)
    assert box.intersect(room).size == pytest.approx(8)
    for region in (box, room, named.CircularRegion((0, 0), 1)):
        assert region.containsRegion(nowhere)
        assert everywhere.containsRegion(region)
        assert not region.containsRegion(everywhere)
    disc = named.CircularRegion((0, 0, 1), 3)
    assert disc.footprint.containsRegion(named.CircularRegion((0, 0, 5), 2))
    assert not disc.containsRegion(named.CircularRegion((0, 0, 5), 2))
    assert not disc.containsRegion(named.CircularRegion((0, 0, 5), 2).footprint)


def test_what_meets_only_by_its_inside_or_by_one_edge() -> None:
    box = named.BoxRegion((4, 4, 4))
    assert box.intersects(named.PathRegion([(-1, 0, 0), (1, 0, 0)]))  # within it
    assert box.intersects(named.PathRegion([(-9, 0, 0), (9, 0, 0)]))  # through it
    assert box.intersects(named.MeshSurfaceRegion(trimesh.creation.box((1, 1, 1))))
    needle = named.MeshSurfaceRegion(trimesh.creation.box((0.1, 0.1, 9)), position=(1, 0.4, 0))
    plate = named.MeshSurfaceRegion(trimesh.creation.box((5, 5, 0.1)))
    assert needle.intersects(plate)
    assert plate.intersects(needle)
    disc = named.CircularRegion((0, 0, 1), 1)
    for ends in ([(0, 0, 0), (0, 0, 2)], [(0, 0, 2), (0, 0, 0)]):
        assert disc.intersects(named.PathRegion(ends))
    assert not disc.intersects(named.PathRegion([(0, 0, 2), (0, 0, 3)]))
    flat = named.PathRegion([(-2, 0, 1), (2, 0, 1)])
    assert disc.intersects(flat)
    assert not named.CircularRegion((0, 0, 2), 1).intersects(flat)


def test_lines_keep_their_height_where_they_are_cut() -> None:
    for height in (0, 2):
        one = named.RectangularRegion(Vector(0, 0, height), 0, 2, 2)
        other = named.RectangularRegion(Vector(2, 0, height), 0, 2, 2)
        common: Any = one.intersect(other)  # an edge
        assert common.length == pytest.approx(2)
        low, high = common.AABB
        assert (low[2], high[2]) == (height, height)


def test_pieces_of_a_path_in_a_solid() -> None:
    """It ends in one of them, and the other way round the same pieces are left."""
    rooms = named.BoxRegion((2, 2, 2)).union(named.BoxRegion((2, 2, 2), (6, 0, 0)))
    places = [(-3, 0, 0.1), (6, 0, 0.1)]
    for ends in (places, places[::-1]):
        inside: Any = rooms.intersect(named.PathRegion(ends))
        assert inside.length == pytest.approx(2 + 1)
        assert inside.distanceTo(Vector(3, 0, 0.1)) == pytest.approx(2)
        assert inside.AABB[1][0] == pytest.approx(6)
    assert not rooms.intersects(named.PathRegion([(1.5, 0, 0), (4.5, 0, 0)]))


def test_heights_of_what_is_left_of_regions_of_the_plane() -> None:
    high = named.RectangularRegion(Vector(0, 0, 3), 0, 4, 4)
    low = named.RectangularRegion(Vector(1, 0, 0), 0, 4, 4)
    for common in (low.footprint.intersect(high), high.intersect(low.footprint)):
        assert (common.z, common.area) == (3, pytest.approx(12))
    rest: Any = high.difference(low.footprint)
    assert (rest.z, rest.area) == (3, pytest.approx(4))
    either = high.union(low)
    assert either.AABB == ((-2, -2, 0), (3, 2, 3))
    assert either.distanceTo(Vector(0, 0, 2)) == pytest.approx(1)
    assert either.distanceTo(Vector(0, 0, 1)) == pytest.approx(1)


# Purity


def _assigns_globally(x: float) -> float:
    global _seen
    _seen = x
    return x


def _assigns_slices(x: list[float]) -> list[float]:
    x[0:1] = [0.0]
    return x


def _imports(x: float) -> float:
    import math as other

    return other.sin(x)


def _defaults(x: float, *, box: list[float] = []) -> float:  # noqa: B006 - it is what is tested
    return x + len(box)


def _harmless(x: float, *, y: float = 2.0) -> float:
    return math.sin(x) + y


_seen = 0.0


def test_what_functions_may_not_do_to_be_pure() -> None:
    for function in (_assigns_globally, _assigns_slices, _imports, _defaults):
        assert not is_pure(function)
    assert is_pure(_harmless)


# Specifiers and operators

FIELD = "turned = PolygonalRegion([(-9, -9), (9, -9), (9, 9), (-9, 9)], orientation=VectorField('f', lambda p: 1.2))\n"


def test_upright_orientations_of_random_yaw() -> None:
    """They are one angle each, which is turned back, and left alone by what turns nothing."""
    text = (
        "y = Range(0.5, 1)\no = Orientation.fromEuler(y, 0, 0)\nn = Orientation.fromEuler(0, 0, 0)\n"
        "param x = (y, o.inverse.yaw, (o * n).yaw, (n * o).yaw, (o * o.inverse).yaw, (o * o).yaw)\n"
    )
    yaw, *found = params(text)["x"]
    assert found == pytest.approx([-yaw, yaw, yaw, 0, 2 * yaw])


@pytest.mark.parametrize("ends", [(5.0, 0.0), (0.0, 5.0)])
def test_bounds_of_ranges_whose_ends_are_in_either_order(ends: tuple[float, float]) -> None:
    reading = TABLE["range"].bounds
    assert reading is not None
    found = reading(None, Bounds(np.array([0.1]), np.array([0.9])), *map(Bounds.exactly, ends))
    assert found is not None
    assert found.lower[0] == pytest.approx(0.5)
    assert found.upper[0] == pytest.approx(4.5)


def test_distances_to_regions_from_both_sides() -> None:
    text = (
        "ego = new Object at (5, 0, 1)\nr = CircularRegion((0, 0, 1), 2)\n"
        "param x = (distance from r to (5, 0, 1), distance from (5, 0, 1) to r, distance to r)\n"
    )
    assert params(text)["x"] == pytest.approx((3, 3, 3))


def test_requirements_see_what_hides() -> None:
    wall = "wall = new Object at (0, 5), with width 9, with height 9\nfar = new Object at (0, 9)\nego = new Object\n"
    assert thing(f"{wall}require not (ego can see far)\n") is not None
    assert scenario(f"{wall}require ego can see wall\n").sample(1, seed=0)


def test_the_gap_is_that_of_the_new_object() -> None:
    text = (
        "a = new Object with contactTolerance 0.5\n"
        "b = new Object right of a, with contactTolerance 0.1\nparam x = b.position.x\n"
    )
    assert params(text)["x"] == pytest.approx(1 + 0.05)


def test_objects_to_be_seen_stay_in_their_own_container() -> None:
    text = (
        "workspace = Workspace(RectangularRegion((0, 0), 0, 40, 40))\nego = new Object with visibleDistance 30\n"
        "room = RectangularRegion((10, 0), 0, 4, 4)\n"
        "x = new Object visible, with regionContainedIn room, with width 0.1, with length 0.1\nparam p = (x.position.x, x.position.y)\n"
    )
    made = scenario(text)
    scenes = made.sample(20, seed=1)
    assert all(8 <= item.params["p"][0] <= 12 for item in scenes)
    # They are looked for there only.
    assert sum(item.attempts for item in scenes) < 200


def test_specifiers_of_one_name_may_offer_different_things() -> None:
    """A class remembers how specifiers fit together: by what they offer, not by their names."""
    for first, second in (("plain", "turned"), ("turned", "plain")):
        text = (
            f"{FIELD}plain = PolygonalRegion([(-9, -9), (9, -9), (9, 9), (-9, 9)])\n"
            f"ego = new Object in {first}\nother = new Object in {second}\n"
            "param x = (ego.yaw, ego.heading, other.heading)\n"
        )
        _, *headings = params(text.replace("new Object in", "new Object with allowCollisions True, in"))["x"]
        assert headings == pytest.approx([1.2 if name == "turned" else 0 for name in (first, second)])


def test_images_of_many_columns_have_them_across() -> None:
    from scenic.cli.options import image_size_option

    assert image_size_option(None, None, "640x480") == (640, 480)  # type: ignore[arg-type]


def test_grids_hold_boxes_by_all_corners_and_face_their_field() -> None:
    grid = named.GridRegion("grid", np.zeros((3, 3)), 1, 1, 0, 0, orientation=named_field(0.4))
    assert grid.has_orientation
    setting = (
        "grid = GridRegion('grid', [[0, 0, 0]] * 3, 1, 1, 0, 0)\n"
        "param x = tuple(grid.containsObject(new Object at (x, y, 50), facing ({turn}), with regionContainedIn everywhere, with allowCollisions True)"
        " for x, y in {places})\n"
    )
    upright = [(1, 1), (-0.1, 1), (2.1, 1), (1, -0.1), (1, 2.1)]
    found = params(setting.format(turn="0, 0, 0", places=upright))["x"]
    assert found == (True, False, False, False, False)
    # Leaning by 45 degrees about an axis of the plane, a cube reaches 0.71 to both sides of it.
    for turn, places in (
        ("0, 45 deg, 0", [(1, 0.3), (1, 1.7), (1, 0.1), (1, 1.9)]),
        ("0, 0, 45 deg", [(0.3, 1), (1.7, 1), (0.1, 1), (1.9, 1)]),
    ):
        assert params(setting.format(turn=turn, places=places))["x"] == (True, True, False, False)


def named_field(heading: float) -> Any:
    return VectorField("field", lambda _place: heading)


def test_sectors_hold_their_arc_and_their_corner() -> None:
    sector = named.SectorRegion((1, 2, 3), 5, 0, 1)
    for point, held in (((1, 7), True), ((1, 7.001), False), ((1, 2), True), ((1, 1.999), False)):
        assert bool(sector.containsPoint(Vector(*point, 3))) is held
    assert sector.distanceTo(Vector(1, 7, 3)) == 0


def test_discs_have_as_many_corners_as_asked_for() -> None:
    for resolution in (1, 4, 32):
        (part,) = named.CircularRegion((0, 0), 1, resolution=resolution).polygons.geoms
        assert len(part.exterior.coords) == 4 * resolution + 1


def test_volumes_of_any_size_hold_others_by_their_own_measure() -> None:
    for size in (1e-4, 1.0, 1e4):
        whole, moved = (named.BoxRegion((size,) * 3, position=(x * size, 0, 0)) for x in (0, 0.01))
        assert whole.containsRegion(whole)
        assert not whole.containsRegion(moved)
        assert whole.containsRegion(named.BoxRegion((0.9 * size,) * 3, position=(0.04 * size, 0, 0)))


def test_a_solid_taken_away_is_that_of_each_lane() -> None:
    """A cube that a random hole in its container reaches in some lanes only."""
    text = (
        "import trimesh\nway = Uniform(1, 3)\n"
        "hole = MeshVolumeRegion(trimesh.creation.box((1, 1, 1)), position=(way, 0, 0))\n"
        "room = BoxRegion((9, 9, 9)).difference(hole)\n"
        "cube = new Object with width 2, with regionContainedIn everywhere\n"
        "param x = (room.containsObject(cube), way)\n"
    )
    assert set(draws(text, n=24)) == {(False, 1), (True, 3)}


def test_functions_of_numbers_read_own_properties() -> None:
    text = (
        "class Kite:\n    width: 3\n    span: hypot(self.width, 4)\n    tilt: sin(self.width) + cos(self.width)\n"
        "    most: max(self.width, 2) + min(self.width, 2)\nego = new Kite\n"
    )
    kite = thing(text)
    assert (kite.span, kite.most) == (5, 5)
    assert kite.tilt == pytest.approx(math.sin(3) + math.cos(3))


def test_functions_of_numbers_wait_for_what_depends_on_the_place() -> None:
    text = "east = VectorField('east', lambda place: place.x)\nego = new Object at (3, 0), with k {}((0 relative to east).yaw{})\n"
    for function, rest, expected in (("hypot", ", 4", 5), ("sin", "", math.sin(3)), ("max", ", 2", 3)):
        assert thing(text.format(function, rest)).k == pytest.approx(expected)


def test_lists_that_are_drawn_and_unpacked() -> None:
    """Each element of what the lists come to is as likely."""
    for options, expected in (
        ("*Uniform([1, 2], [3]), *Uniform([4], [5, 6, 7])", {3: 3 / 16, 4: 5 / 24, 5: 11 / 96, 1: 13 / 96}),
        ("*listed(Range(0, 1))", {1: 1 / 3, 3: 1 / 3}),
        ("*listed(Range(0, 1)), 9", {1: 1 / 4, 9: 1 / 4}),
    ):
        text = f"def listed(_): return [1, 2, 3]\nx = Uniform({options})\nparam x = x\n"
        found = draws(text)
        for value, share in expected.items():
            assert stats.binomtest(found.count(value), len(found), share).pvalue > FALSE_ALARM


def test_options_that_are_no_numbers_are_named_when_they_are_drawn() -> None:
    error = failure("ego = new Object with width Uniform(1, 2.5, 'a')\n", n=30)
    assert isinstance(error, ScenicTypeError)
    assert "expected a number, not 'a'" in str(error)
    assert set(draws("ego = new Object with width Uniform(1, 2.5)\nparam x = ego.width\n", n=30)) == {1, 2.5}


@pytest.mark.parametrize(
    "region",
    [
        "PolygonalRegion([(0, 0), (x, 0), (1, 1)])",
        "PolygonalRegion([(0, 0), (1, 0), (1, 1)], z=x)",
        "PolylineRegion([(0, 0), (x, 0)])",
        "PathRegion([(0, 0, 0), (x, 0, 1)])",
        "PointSetRegion('points', [(0, 0), (x, 0)])",
    ],
)
def test_regions_of_points_need_fixed_ones(region: str) -> None:
    error = failure(f"x = Range(1, 2)\nego = new Object in {region}\n")
    assert isinstance(error, ScenicTypeError)
    assert "needs fixed points" in str(error)


def test_points_and_grids_have_the_orientation_that_they_are_given() -> None:
    for region in (
        named.PointSetRegion("points", [(0, 0), (3, 0)], orientation=named_field(0.4)),
        named.GridRegion("grid", np.zeros((1, 2)), 3, 1, 0, 0, orientation=named_field(0.4)),
    ):
        assert region.has_orientation
        assert region.orientation_at(Vector(3, 0, 0)).yaw == pytest.approx(0.4)
    assert not named.PointSetRegion("points", [(0, 0)]).has_orientation


LATER = {
    "truth": bool,
    "elements": list,
    "length": len,
    "membership": lambda value: 3 in value,
    "order": lambda value: value < 3,
}


@pytest.mark.parametrize("what", list(LATER))
def test_what_depends_on_the_object_is_not_looked_into(what: str) -> None:
    value = DelayedArgument({"x"}, lambda item: item.x)
    with pytest.raises(RandomControlFlowError, match="depends on the object being specified") as caught:
        LATER[what](value)
    assert caught.value.help is not None
    assert caught.value.help.startswith("it is known only while")


def test_parts_that_programs_have_to_provide() -> None:
    value = Distribution(1)
    with pytest.raises(NotImplementedError, match="buckets"):
        value.bucket()
    with pytest.raises(NotImplementedError, match="sampleGiven"):
        value.sampleGiven({})
    with pytest.raises(NotImplementedError, match="appliedTo"):
        Mutator().appliedTo(None)
    assert value.supportInterval() == (None, None)


def test_values_without_an_end_on_one_side_say_where_the_other_is() -> None:
    found = params(
        "from scenic.core.distributions import supportInterval\ny = 1 / Range(0, 1)\n"
        "param low = supportInterval(max(0.5, y)), high = supportInterval(min(-0.5, -y)), both = supportInterval(y)\n"
    )
    assert found == {"low": (0.5, None), "high": (None, -0.5), "both": (None, None)}


def test_an_object_needs_sampling_if_anything_of_it_does() -> None:
    loaded = scenario(
        "ego = new Object with width Range(1, 2)\nother = new Object at (5, 5)\n"
        "param r = Range(0, 1), s = 3, disc = CircularRegion((0, 0), Range(1, 2)), fixed = CircularRegion((0, 0), 1)\n"
    )
    ego, other = loaded.objects
    found = [needsSampling(item) for item in (ego, other, *loaded.params.values())]
    assert found == [True, False, True, False, True, False]


def test_lifted_functions_keep_their_name_and_words() -> None:
    def gain(value: float) -> float:
        """By how much."""
        return 2 * value

    lifted = distributionFunction(gain)
    assert (lifted.__name__, lifted.__doc__, lifted(3)) == ("gain", "By how much.", 6)


def test_headings_of_random_values_that_have_none() -> None:
    values = scenario(
        "param v = Vector(Range(0, 1), 2, 3), h = Range(0, 1), b = Uniform(True, False)\n"
    ).params
    with pytest.raises(ScenicTypeError, match="a heading"):
        to_heading(values["v"])
    assert to_heading(values["h"]) is values["h"]


@pytest.mark.parametrize(
    "condition",
    [
        "not (x > 0.5 and y < 1)", "x > 0.5 if b else y > 0.2", "0 < x < y", "min(x, y) > 0.1", "abs(x) < 1", "ego in zone",
        "(distance from ego to p) < 5", "ego can see p", "x > 0.5 or (y < 1 and b)", "always x > 0.5", "x > 0.5 implies y > 0.1",
        "(x, y)[0] > 0.5", "(relative heading of ego) < 1", "hypot(x, y) < 1", "x % 1 < 0.5", "round(x) == 1", "sin(x) > 0", "b",
        "ego intersects p", "max([x, y]) > 0", "len([x, y]) == 2", "ego.position.x > 0", "(x > 0.5 or y < 1) == b",
        "(x > 0.5 and b) == (y < 1)", "(not b) == (x > 0.5)", "(1 if x > 0.5 else 2) > y", "max(x if b else y, 0.2) < 1",
    ],
)  # fmt: skip
def test_analysis_looks_into_conditions_of_the_language(condition: str) -> None:
    """Called on samples they would hold as well; but nothing would be known of them."""
    text = (
        "x, y, b = Range(0, 1), Range(0, 2), Uniform(True, False)\nzone = CircularRegion((0, 0), 9)\n"
        f"ego = new Object at (x, 0)\np = new Object at (5, y)\nrequire {condition}\n"
    )
    names = {node.operation.name for node in scenario(text).outline.graph.nodes}
    assert "opaque condition" not in names


def test_of_options_that_do_not_fit_only_those_that_are_drawn_are_errors() -> None:
    program = scenario("ego = new Object with width Uniform(1, 'a', 2.5)\n")
    outcomes = set()
    for seed in range(30):
        try:
            outcomes.add(program.sample(1, seed=seed)[0].objects[0].width)
        except ScenicTypeError as error:
            outcomes.add(str(error).partition("expected ")[2])
    assert outcomes == {1.0, 2.5, "a number, not 'a' (str)"}


def test_clones_are_independent_draws_of_the_same_law() -> None:
    text = "x = Range(0, 1)\ny = x.clone()\nz = resample(x)\nparam x = (x, y, z)\n"
    values = np.array(draws(text, n=300))
    for column in values.T:
        assert stats.kstest(column, "uniform").pvalue > FALSE_ALARM
    assert abs(np.corrcoef(values.T) - np.eye(3)).max() < 0.25


@pytest.mark.parametrize("sign", ["<", "<=", ">", ">=", "==", "!="])
def test_what_depends_on_the_object_is_not_compared(sign: str) -> None:
    """On either side: an answer would be one for all objects."""
    for use in (f"lazy {sign} 1", f"1 {sign} lazy", f"lazy {sign} lazy", f"(lazy, 1)[0] {sign} 'a'"):
        error = failure(
            f"flow = VectorField('flow', lambda p: p.x)\nlazy = (flow relative to 0).yaw\nx = {use}"
        )
        assert isinstance(error, RandomControlFlowError), use
        assert "comparing a value that depends on the object" in str(error)
        assert place(error)[1].startswith("3:")


def test_what_depends_on_the_object_is_drawn_once_for_each() -> None:
    text = (
        "flow = VectorField('flow', lambda p: p.x)\ndrawn = Range((flow relative to 0).yaw, (flow relative to 1).yaw)\n"
        "class Kind:\n    foo: 0\n    bar: 0\n    baz: 0\n"
        "for x in (0.25, 0.5): new Kind at (x, 9 * x), with allowCollisions True, with foo drawn, with bar [drawn, {'a': drawn}], with baz drawn * 2\n"
        "ego = new Kind at (2, 40), with foo Uniform(drawn, 7), with bar (drawn, drawn), with baz 1\n"
    )
    found = scene(text, seed=3).objects
    kinds = sorted((item for item in found if item.baz != 1), key=lambda item: item.x)
    for item in kinds:
        assert item.x <= item.foo <= item.x + 1
        assert item.bar == [item.foo, {"a": item.foo}]
        assert item.baz == 2 * item.foo
    assert kinds[0].foo - kinds[0].x != pytest.approx(kinds[1].foo - kinds[1].x)
    (ego,) = (item for item in found if item.baz == 1)
    assert ego.bar[0] == ego.bar[1]
    assert ego.foo in (7, ego.bar[0])


def test_functions_that_depend_on_the_object_are_called_when_it_is_there() -> None:
    text = (
        "flow = VectorField('flow', lambda p: p.x)\nturn = flow relative to 0\n"
        "new Object at (0.5, 2), with a turn.localAnglesFor(0.75)[0], with b turn.eulerAngles[0] * 2, with c [turn.inverse.yaw, {'d': turn.toHeading()}]\n"
    )
    item = thing(text)
    assert (item.a, item.b) == pytest.approx((0.25, 1))
    assert [item.c[0], item.c[1]["d"]] == pytest.approx([-0.5, 0.5])


def test_bounds_of_slices_may_depend_on_the_object() -> None:
    text = """
field = VectorField("f", lambda place: 1)
numbers = Uniform([1, 2, 3], [4, 5, 6])
ego = new Object with tail numbers[int((0 relative to field).yaw):],
    with kept filter(lambda x: x > 0, [-1, (0 relative to field).yaw, 3])
"""
    found = scenario(text).sample(1, seed=0)[0].egoObject
    assert found.tail in ([2, 3], [5, 6])
    assert found.kept == [1, 3]


def test_slices_of_fixed_sequences_between_random_and_lazy_bounds() -> None:
    found = scene(
        """
n = DiscreteRange(0, 2)
class Case:
    k: DiscreteRange(1, 2)
    some: [1, 2, 3][self.k:]
    head: "abc"[:self.k]
ego = new Case
field = VectorField("f", lambda place: 1)
other = new Object at (5, 5), with rest [1, 2, 3][int((1 relative to field).yaw):]
param n = n, tail = [1, 2, 3][n:], step = (1, 2, 3)[::n - 3], things = [ego, other][n:], named = [n, 4, 5][:n]
require len([1, 2, 3][n:]) == 2
"""
    )
    params = found.params
    assert params["n"] == 1
    assert (params["tail"], params["step"], params["named"]) == ([2, 3], (3, 1), [1])
    assert params["things"] == [found.objects[1]]
    assert found.objects[1].rest == [3]
    k = found.egoObject.k
    assert (found.egoObject.some, found.egoObject.head) == ([1, 2, 3][k:], "abc"[:k])


def test_slices_in_behaviors_stay_pythons() -> None:
    program = """
behavior Cut(n):
    items = [1, 2, 3]
    items[:n] = [7, 7]
    del items[n:]
    take tuple(items[n - 1:n + 1])
ego = new Object with behavior Cut(2)
"""
    simulation = DummySimulator().simulate(scene(program), maxSteps=1)
    assert list(simulation.result.actions[0].values()) == [(7,)]


def test_a_place_off_a_surface_rejects_what_is_being_sampled() -> None:
    program = """
skin = BoxRegion().getSurfaceRegion()
behavior Look():
    precondition: skin.orientation[(0, 0, 0)].yaw > -100
    take 1
ego = new Object with behavior Look
"""
    simulated = scene(program)
    assert DummySimulator().simulate(simulated, maxSteps=1) is None
    with pytest.raises(PreconditionViolation):
        DummySimulator().simulate(simulated, maxSteps=1, raiseGuardViolations=True)
    with pytest.raises(InvalidScenarioError):
        scenario("skin = BoxRegion().getSurfaceRegion()\nparam x = skin.orientation[(0, 0, 0)].yaw")


def test_vectors_are_dumped_as_vectors() -> None:
    stream = io.StringIO()
    scene("ego = new Object with foo Vector(1, 2, 3), with bar [Vector(1, 1, 1)]").dumpAsScenicCode(stream)
    assert "with foo Vector(1.0, 2.0, 3.0)" in stream.getvalue()
    read = thing(stream.getvalue())
    assert type(read.foo) is Vector
    assert read.bar == [Vector(1, 1, 1)]
