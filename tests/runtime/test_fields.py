"""Vector fields, and values that are known only while an object is built."""

import math

import numpy as np
import pytest
import shapely

import scenic
from scenic.language.errors import (
    InvalidScenarioError,
    RandomControlFlowError,
    ScenicTypeError,
    SpecifierError,
)
from tests.runtime.programs import assert_same_rotation, draws, euler, failure, params, rotation, scene, thing

FIELD = "F = VectorField('f', lambda p: p.x + 0.1 * p.y)\nego = new Object at (0.5, 2, 1), facing (0.4, 0.3, -0.2)\n"
CELLS = """
from shapely.geometry import box
cells = [(box(0, 0, 10, 10), 0.5), (box(10, 0, 20, 10), -0.25), (box(5, 0, 15, 10), 2.0)]
F = PolygonalVectorField('f', cells)
"""


def test_a_field_gives_an_orientation_at_points_and_objects() -> None:
    found = params(FIELD + "param a = F at (1, 2), b = F at ego, c = F[3 @ 4]")
    for name, heading in (("a", 1.2), ("b", 0.7), ("c", 3.4)):
        assert_same_rotation(found[name], euler(heading))


def test_a_field_may_give_euler_angles_or_orientations() -> None:
    text = (
        "A = VectorField('a', lambda p: (p.x, 0.2, 0.3))\n"
        "B = VectorField('b', lambda p: Orientation.fromEuler(p.x, 0.2, 0.3))\n"
        "q = (Range(1, 1.001), 0)\nparam a = A at q, b = B at q, x = q[0]"
    )
    found = params(text)
    for name in "ab":
        assert_same_rotation(found[name], euler(found["x"], 0.2, 0.3))


def test_fields_in_specifiers_are_read_at_the_position_of_the_new_object() -> None:
    item = thing(FIELD + "new Object at (Range(3, 4), 5), facing F, with parentOrientation (0.3, 0.2, 0.1)")
    assert_same_rotation(item.orientation, euler(item.position.x + 0.5))
    item = thing(FIELD + "new Object at (7, 5), facing F relative to (0.1 relative to 0.2)")
    assert_same_rotation(item.orientation, euler(0.3 + 7.5))
    item = thing(FIELD + "new Object at (7, 5), facing (0.1, 0.2, 0.3) relative to F")
    assert_same_rotation(item.orientation, euler(7.5) * euler(0.1, 0.2, 0.3))
    item = thing(
        FIELD + "new Object at (7, 5), facing (F relative to 0.1) + 0.2, with tag (F relative to F).yaw / 2"
    )
    assert_same_rotation(item.orientation, euler(7.5 + 0.3))
    assert np.isclose(np.exp(2j * item.tag), np.exp(15j))


def test_lazy_values_work_in_every_place_of_a_specifier() -> None:
    angle = "(F relative to 0).yaw"
    item = thing(FIELD + f"new Object at (1, 20), with width 1 + {angle}, with foo [{angle}, (3, {angle})]")
    assert np.isclose(item.width, 4.0)
    assert np.allclose([item.foo[0], item.foo[1][1]], 3.0)
    item = thing(
        FIELD + f"new Object at (1, 20), with height max(0.5, {angle}), with x_ Uniform({angle}, {angle})"
    )
    assert np.isclose(item.height, 3.0)
    assert np.isclose(item.x_, 3.0)


def test_defaults_of_properties_may_be_lazy() -> None:
    text = (
        FIELD
        + "class C:\n    parentOrientation: F relative to self.extra\n    extra: 0.25\nnew C at (1, 20)\n"
    )
    assert_same_rotation(thing(text).orientation, euler(3.25))


def test_a_lazy_value_that_needs_what_it_decides_is_an_error() -> None:
    error = failure(FIELD + "new Object at (0, (F relative to 0).yaw)")
    assert isinstance(error, SpecifierError)
    error = failure(FIELD + "class C:\n    position: (0, (F relative to 0).yaw)\nnew C\n")
    assert isinstance(error, SpecifierError)


def test_lazy_values_are_good_for_nothing_outside_of_objects() -> None:
    assert isinstance(failure(FIELD + "param x = F relative to 1"), InvalidScenarioError)
    assert isinstance(failure(FIELD + "require (F relative to 1).yaw > 0"), InvalidScenarioError)
    assert isinstance(failure(FIELD + "x = F relative to 1\nif x: pass"), RandomControlFlowError)


def follow(heading: object, start: tuple[float, float, float], distance: float) -> np.ndarray:
    """Euler's method, written out."""
    place = np.array(start, dtype=float)
    steps = max(4, int(np.ceil(distance / 5)))
    for _ in range(steps):
        angle = heading(*place[:2])  # type: ignore[operator]
        place += distance / steps * np.array([-np.sin(angle), np.cos(angle), 0])
    return place


@pytest.mark.parametrize("distance", [3.0, 25.0, 27.0])
def test_following_a_field(distance: float) -> None:
    text = (
        FIELD
        + f"o = new Object following F from (1, 2, 3) for {distance}\np = follow F from (1, 2, 3) for {distance}\n"
    )
    for end in (scene(text + "").objects[-1], params(text + "param x = p")["x"]):
        expected = follow(lambda x, y: x + 0.1 * y, (1, 2, 3), distance)
        np.testing.assert_allclose(tuple(end.position), expected, atol=1e-9)
        assert_same_rotation(end.orientation, euler(expected[0] + 0.1 * expected[1]))


def test_following_from_random_places_agrees_lane_by_lane() -> None:
    text = (
        FIELD
        + "s = (Range(0, 2), 1, 2)\nd = Uniform(Range(1, 40), 25, 30)\np = follow F from s for d\nparam x = (s[0], d, p.position)"
    )
    for x, distance, end in draws(text, n=20):
        np.testing.assert_allclose(
            tuple(end), follow(lambda x, y: x + 0.1 * y, (x, 1, 2), distance), atol=1e-9
        )


def heading_of_cells(x: float, y: float) -> float:
    cells = [((0, 0, 10, 10), 0.5), ((10, 0, 20, 10), -0.25), ((5, 0, 15, 10), 2.0)]
    return next(
        heading for box, heading in cells if shapely.intersects(shapely.box(*box), shapely.Point(x, y))
    )


def test_polygonal_fields_take_the_first_cell() -> None:
    text = CELLS + "p = (Range(0, 20), Range(0, 10))\nparam x = (p, (F at p).yaw)"
    for (x, y), yaw in draws(text, n=50):
        assert np.isclose(yaw, heading_of_cells(x, y))
    assert np.isclose(params(CELLS + "param x = (F at (10, 1)).yaw")["x"], 0.5)


def test_polygonal_fields_reject_where_they_have_no_direction() -> None:
    values = draws(CELLS + "x = Range(-20, 20)\ny = (F at (x, 1)).yaw\nparam x = (x, y)", n=200)
    assert all(x >= 0 for x, _ in values)
    for default in (1.5, 0):
        outside = CELLS.replace("cells)", f"cells, defaultHeading={default})")
        values = draws(outside + "x = Range(-20, 20)\nparam x = (x, (F at (x, 1)).yaw)", n=100)
        assert {round(yaw, 6) for x, yaw in values if x < 0} == {default}
    assert isinstance(failure(CELLS + "param x = (F at (-1, 1)).yaw"), InvalidScenarioError)


def test_polygonal_fields_are_followed_over_arrays() -> None:
    text = CELLS + "s = (Range(4, 16), 2)\np = follow F from s for 1.5\nparam x = (s[0], p.position)"
    for x, end in draws(text, n=50):
        np.testing.assert_allclose(tuple(end), follow(heading_of_cells, (x, 2, 0), 1.5), atol=1e-9)


@pytest.mark.parametrize("distance", ["8", "Range(8, 8)", "Uniform(8, 4)"])
def test_ways_that_leave_the_cells_for_a_while_are_rejected(distance: str) -> None:
    """Four steps, each of two metres or of one: that one of them begins in the gap is enough."""
    text = (
        "from shapely.geometry import box\n"
        "F = PolygonalVectorField('f', [(box(0, 0, 9, 10), 0), (box(0, 11, 9, 40), 0)])\n"
        f"y, d = Range(0, 20), {distance}\nparam x = (y, d, (follow F from (1, y) for d).position)"
    )
    values = draws(text, n=300)
    for y, length, end in values:
        assert tuple(end) == pytest.approx((1, y + length, 0))
        assert not any(10 < y + step * length / 4 < 11 for step in range(4))
    for before in range(4):
        assert any(10 < y + before * 2 + 1 < 11 for y, length, _ in values if length == 8)


def test_cells_without_heading_ask_the_function() -> None:
    text = CELLS.replace("0.5)", "None)").replace("cells)", "cells, headingFunction=lambda p: 3 * p.x)")
    for x, yaw in draws(text + "x = Range(0, 1)\nparam x = (x, (F at (x, 1)).yaw)", n=10):
        assert np.isclose(np.exp(1j * yaw), np.exp(3j * x))
    broken = CELLS.replace("0.5)", "None)")
    assert isinstance(failure(broken), ScenicTypeError)


@pytest.mark.parametrize(
    "use",
    [
        "3 at (1, 2)",
        "Uniform(F, 3) at (1, 2)",
        "follow Uniform(3, F) from (1, 2) for 4",
        "follow 3 from (1, 2) for 4",
        "new Object following 3 for 4",
    ],
)
def test_what_is_no_field_is_refused(use: str) -> None:
    assert isinstance(failure(FIELD + f"x = {use}"), ScenicTypeError)


def test_offset_along_a_field() -> None:
    found = params(FIELD + "param x = (3 @ 4) offset along F by (1, 2, 3)")
    expected = np.array([3, 4, 0]) + euler(3.4).apply([1, 2, 3])
    np.testing.assert_allclose(tuple(found["x"]), expected, atol=1e-9)
    item = thing(FIELD + "new Object offset along F by (1, 2, 3)")
    np.testing.assert_allclose(
        tuple(item.position), np.array([0.5, 2, 1]) + euler(0.7).apply([1, 2, 3]), atol=1e-9
    )
    assert rotation(item.orientation).approx_equal(euler(0.4, 0.3, -0.2), 1e-9)


def test_a_choice_among_fields_is_a_field() -> None:
    text = (
        "one, two = VectorField('one', lambda p: p.x / 10), VectorField('two', lambda p: 2 + p.y / 10)\n"
        "which = Uniform(one, two, Uniform(one, two))\n"
        "ego = new Object at (Range(3, 4), 5), facing which\n"
        "other = new Object at (10, 7), facing 0.1 relative to which\n"
        "third = new Object following which from (0, 50) for 2\n"
        "mixed = new Object at (60, 0), facing Uniform(one, 0.5)\n"
        "param there = (which at ego).yaw, follow = (follow which from (0, 50) for 2).position\n"
        "param along = (1, 2) offset along which by (0, 1)\n"
    )
    kinds = set()
    for found in scenic.scenarioFromString(text).sample(40, seed=1):
        ego, other, third, mixed = found.objects
        second = other.yaw - 0.1 > 2
        kinds.add((second, mixed.yaw == 0.5))
        x, y = ego.x, ego.y
        assert ego.yaw == pytest.approx(2 + y / 10 if second else x / 10)
        assert found.params["there"] == pytest.approx(ego.yaw)
        assert other.yaw - 0.1 == pytest.approx(2.7 if second else 1.0)
        assert third.position == found.params["follow"]
        assert mixed.yaw in (0.5, pytest.approx(6 - 2 * math.pi))
        heading = 2.2 if second else 0.1
        assert found.params["along"] == pytest.approx((1 - math.sin(heading), 2 + math.cos(heading), 0))
    assert len(kinds) == 4


def test_attributes_are_no_names_of_the_program() -> None:
    # The field reads `p.x`, which has nothing to do with the program's `x`; that one depends on the field.
    text = "field = VectorField('f', lambda p: p.x / 10)\nx = field at Uniform((1, 2), (3, 4))\nparam x = x\n"
    found = {
        round(sampled.params["x"].yaw, 9) for sampled in scenic.scenarioFromString(text).sample(20, seed=1)
    }
    assert found == {0.1, 0.3}


def test_unions_of_many_regions_take_the_first_that_holds_the_point() -> None:
    """A row of squares that overlap by half, each with a field of its own; also above them, and beside."""
    text = (
        "def square(x):\n    return PolygonalRegion([(x, 0), (x + 2, 0), (x + 2, 2), (x, 2)], "
        "orientation=VectorField('own', lambda p: x / 100))\n"
        "plain = PolygonalRegion([(-1, 0), (40, 0), (40, 2), (-1, 2)])\n"
        "row = PolygonalRegion.unionAll([plain, *[square(x) for x in range(30)]])\n"
        "def heading(x, z=0): return row.orientation[(x, 1, z)].yaw\n"
        "param found = [heading(x + 0.5) for x in (0, 1, 7, 28, 29)], border = heading(4), last = heading(31)\n"
        "new Object in row, with width 0.1, with length 0.1\n"
    )
    (found,) = scenic.scenarioFromString(text).sample(1, seed=1)
    assert found.params["found"] == pytest.approx([0, 0, 0.06, 0.27, 0.28])
    assert (found.params["border"], found.params["last"]) == pytest.approx((0.02, 0.29))
    (item,) = found.objects
    assert item.heading == pytest.approx(max(0, math.ceil(item.x) - 2) / 100)


def test_unions_of_many_regions_may_have_volumes_among_them() -> None:
    """These hold points at their own heights, and the first that does gives the direction, as among few."""
    text = (
        "def square(x):\n    return PolygonalRegion([(x, 0), (x + 2, 0), (x + 2, 2), (x, 2)], "
        "orientation=VectorField('own', lambda p: x / 100))\n"
        "box = BoxRegion((3, 3, 3), position=(5, 1, 9), orientation=VectorField('own', lambda p: 1.5))\n"
        "some = [square(x) for x in range(30)]\nfields = [VectorField.forUnionOf(each) for each in ([box, *some], [*some, box])]\n"
        "param found = [field[p].yaw for field in fields for p in ((4.5, 1, 0), (4.5, 1, 9), (10.5, 1, 9))]\n"
    )
    (found,) = scenic.scenarioFromString(text).sample(1, seed=1)
    assert found.params["found"] == pytest.approx([0.03, 1.5, 0.09, 0.03, 0.03, 0.09])


def test_the_field_of_a_union_is_that_of_the_first_region_that_has_a_place() -> None:
    text = (
        "from scenic.core.regions import RectangularRegion, PolygonalRegion\nF = VectorField('F', lambda p: 0.5)\nG = VectorField('G', lambda p: p.x)\n"
        "left = PolygonalRegion([(-4, -1), (1, -1), (1, 1), (-4, 1)], orientation=F)\n"
        "right = PolygonalRegion([(0, -1), (4, -1), (4, 1), (0, 1)], orientation=G)\n"
        "bare = RectangularRegion((0, 0), 0, 1, 1)\nboth = VectorField.forUnionOf([left, right])\n"
        "param found = [(both at (x, 0)).yaw for x in (-3, 0.5, 1.5, 3)], none = VectorField.forUnionOf([bare]), other = (F at (9, 9)).yaw\n"
    )
    found = params(text)
    assert found["found"] == pytest.approx([0.5, 0.5, 1.5, 3])
    assert found["none"] is None
    assert found["other"] == pytest.approx(0.5)


@pytest.mark.parametrize(
    "start",
    [
        "Uniform((1, 2), (4, 5))",
        "new OrientedPoint at (1, 2)",
        "Vector(0, 0)",
        "[0, 0]",
        "numpy.array([1, 2])",
    ],
)
def test_following_starts_wherever_that_is(start: str) -> None:
    """At a choice, a point, the origin; and not at the ego, which is elsewhere."""
    text = f"import numpy\n{FIELD}s = {start}\nnew Object following F from s for 3\nparam start = s\n"
    found = scene(text)
    at = found.params["start"]
    place = tuple(getattr(at, "position", at))
    expected = follow(lambda x, y: x + 0.1 * y, (place[0], place[1], 0), 3)
    np.testing.assert_allclose(tuple(found.objects[-1].position), expected, atol=1e-9)


@pytest.mark.parametrize(
    "field", ["VectorField('f', lambda p: 0.5", "PolygonalVectorField('f', [(area, 0.5)]"]
)
@pytest.mark.parametrize("length", ["0", "3", "-3", "Uniform(0, 3, -3)"])
def test_a_field_that_asks_for_no_least_number_of_steps_takes_one(field: str, length: str) -> None:
    """Also for a way of no length, and backwards."""
    text = (
        f"from shapely.geometry import box\narea = box(-9, -9, 9, 9)\nF = {field}, minSteps=0)\nlength = {length}\n"
        "place = follow F from (1, 2) for length\nparam x = (length, place.position)\n"
    )
    for way, place in draws(text, n=6):
        assert tuple(place) == pytest.approx((1 - way * math.sin(0.5), 2 + way * math.cos(0.5), 0))
