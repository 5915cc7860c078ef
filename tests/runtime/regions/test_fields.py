"""Vector fields, and values that are known only while an object is built."""

import math
from functools import partial

import numpy as np
import pytest
import shapely

import scenic
from scenic.language.errors import (
    InvalidScenarioError,
    RandomControlFlowError,
    ScenicTypeError,
    ScenicValueError,
    SpecifierError,
)
from scenic.runtime.regions.fields import VectorField
from scenic.runtime.values.values import Orientation, Vector
from tests.runtime.programs import (
    assert_same_rotation,
    draws,
    euler,
    failure,
    params,
    place,
    rotation,
    scenario,
    scene,
    thing,
)

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


def heading_by_y(sign: float, _x: float, y: float) -> float:
    return sign * y / 4


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
    """Where they are followed from stays where it is."""
    text = CELLS + "s = Vector(Range(4, 16), 2)\np = follow F from s for 1.5\nparam x = (p.position, s)"
    for end, start in draws(text, n=50):
        assert start == (start.x, 2, 0)
        assert 4 < start.x < 16
        np.testing.assert_allclose(tuple(end), follow(heading_of_cells, tuple(start), 1.5), atol=1e-9)


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
    for way, end in draws(text, n=6):
        assert tuple(end) == pytest.approx((1 - way * math.sin(0.5), 2 + way * math.cos(0.5), 0))


@pytest.mark.parametrize("start", ["(1, 2)", "(1, Range(2, 2.5))", "Uniform((1, 2), (2, 2))"])
def test_a_field_that_gives_nothing_somewhere_is_an_error_there(start: str) -> None:
    """Whether the point is known or drawn, first or midway, and whatever it gives elsewhere."""
    missing = ("None", "None if p.y > 1 else 0.5", "'north'")
    for value in missing:
        program = f"F = VectorField('f', lambda p: {value})\nstart = {start}\n"
        for use in ("F at start", "follow F from start for 3"):
            error = failure(program + f"param x = {use}")
            assert isinstance(error, ScenicTypeError), (value, use)
            assert "the value of a field: expected an orientation" in str(error)
    midway = f"F = VectorField('f', lambda p: None if p.y > 4 else 0)\nstart = {start}\nparam x = (follow F from start for "
    assert isinstance(failure(midway + "4)"), ScenicTypeError)
    assert params(midway + "1.5).position.y")["x"] >= 3.5
    cells = "from scenic.core.vectors import PolyhedronVectorField\nF = PolyhedronVectorField('f', [(everywhere, None)])\n"
    assert isinstance(failure(f"{cells}param x = F at {start}"), ScenicTypeError)


def test_a_way_that_is_rejected_midway_is_rejected() -> None:
    text = (
        "def value(p):\n    if 4 < p.y < 5: raise RejectionException()\n    return 0\n"
        "F = VectorField('f', value)\ny, d = Range(0, 9), Uniform(2, 12, -2)\nparam x = (y, d, (follow F from (1, y) for d).position)\n"
    )
    values = draws(text, n=100)
    for y, way, end in values:
        assert tuple(end) == pytest.approx((1, y + way, 0))
        assert not any(4 < y + step * way / 4 < 5 for step in range(4))
    assert {way for _, way, _ in values} == {2, 12, -2}


def test_fields_called_by_python() -> None:
    field = VectorField("winding", lambda point: point.x / 2)
    assert (field.minSteps, field.defaultStepSize, field.valueType) == (4, 5, Orientation)
    assert repr(field) == "<VectorField winding>"
    assert_same_rotation(field.at((1, 2)), euler(0.5))
    assert_same_rotation(field.at([3, 2, 7]), euler(1.5))
    assert tuple(field.followFrom((0, 0, 1), 10, steps=1)) == pytest.approx((0, 10, 1))


def test_fields_read_what_is_drawn() -> None:
    """The function of a field, or that of its cells, may read drawn names; two scenes have two fields."""
    text = (
        "from shapely.geometry import box\nk = Range(0, 1)\nF = VectorField('f', lambda p: k + p.x)\n"
        "G = PolygonalVectorField('g', [(box(0, 0, 1, 1), None), (box(1, 0, 2, 1), 0.75)], headingFunction=lambda p: k / 2, defaultHeading=0.5)\n"
        "param k = k, fields = (F, G), values = [(G at (x, 0.5)).yaw for x in (0.5, 1.5, 2.5)], f = (F at (1, 0)).yaw\n"
        "param drawn = (G at (Range(0.1, 0.9), 0.5)).yaw, end = (follow G from (0.5, 0) for 0.5).position\n"
    )
    first, second = (each.params for each in scenic.scenarioFromString(text).sample(2, seed=4))
    assert first["k"] != second["k"]
    for found in (first, second):
        k, (plain, cells) = found["k"], found["fields"]
        assert found["values"] == pytest.approx([k / 2, 0.75, 0.5])
        assert [cells[x, 0.5].yaw for x in (0.5, 1.5, 2.5)] == pytest.approx([k / 2, 0.75, 0.5])
        assert (found["f"], plain[2, 0].yaw) == pytest.approx((k + 1, k + 2))
        assert found["drawn"] == pytest.approx(k / 2)
        assert tuple(found["end"]) == pytest.approx((0.5 - math.sin(k / 2) / 2, math.cos(k / 2) / 2, 0))


def test_fields_by_volumes_agree_where_points_are_drawn() -> None:
    text = (
        "from scenic.core.vectors import PolyhedronVectorField\n"
        "near, far = BoxRegion(dimensions=(2, 2, 2)), BoxRegion(dimensions=(8, 8, 8))\n"
        "F = PolyhedronVectorField('f', [(near, None), (far, (0.1, 0.2, 0.3))], headingFunction=lambda p: p.x, defaultHeading=(0.4, 0.5, 0.6))\n"
        "x = Uniform(0.5, -0.5, 1.5, 5)\nparam x = (x, F at (x, 0, 0), F at (x, 0, 4.5))\n"
    )
    inside, outside = euler(0.1, 0.2, 0.3), euler(0.4, 0.5, 0.6)
    values = draws(text, n=30)
    assert {x for x, _, _ in values} == {0.5, -0.5, 1.5, 5}
    for x, found, above in values:
        assert_same_rotation(found, euler(x) if x < 1 else inside if x < 4 else outside)
        assert_same_rotation(above, outside)


def test_choices_among_fields_are_followed_step_by_step() -> None:
    """By as many steps as asked for, and from where the object will be."""
    text = (
        "one, two = VectorField('one', lambda p: p.y / 4), VectorField('two', lambda p: -p.y / 4)\nwhich = Uniform(one, two)\n"
        "other = VectorField('other', lambda p: p.x)\nplace = ((other relative to 0).yaw, 3)\n"
        "ego = new Object at (2, 1), with read (which at place).yaw, with end (follow which from place for 0.5).position, facing (place offset along which by (0, 1)).x\n"
        "param found = [which.followFrom((0, 0), 4, **options) for options in ({}, {'steps': 2}, {'stepSize': 0.5})], sign = (which at (0, 4)).yaw\n"
    )
    signs = set()
    for found in scenic.scenarioFromString(text).sample(12, seed=2):
        sign, ego = found.params["sign"], found.egoObject
        signs.add(sign)
        for end, count in zip(found.params["found"], (4, 2, 8), strict=True):
            place = np.zeros(2)
            for _ in range(count):
                angle = sign * place[1] / 4
                place += 4 / count * np.array([-np.sin(angle), np.cos(angle)])
            assert tuple(end)[:2] == pytest.approx(tuple(place)), count
        assert ego.read == pytest.approx(sign * 0.75)
        angle = sign * 0.75
        assert tuple(ego.end) == pytest.approx(tuple(follow(partial(heading_by_y, sign), (2, 3, 0), 0.5)))
        assert ego.yaw == pytest.approx(2 - math.sin(angle))
    assert signs == {1, -1}


def test_the_directions_of_lines_are_fields() -> None:
    text = (
        "path = PolylineRegion([(0, 0), (3, 0), (3, 4)])\nF, p = path.orientation, Uniform((1, 0), (3, 2))\n"
        "ego = new Object at (3, 3), facing 0.25 relative to F\n"
        "param there = [(F at q).yaw for q in ((1, 0), (3, 2), p)], p = p, end = (follow F from p for 0.5).position, fixed = (follow F from (3, 1) for 2).position\n"
    )
    for found in scenic.scenarioFromString(text).sample(8, seed=1):
        values = found.params
        first = values["p"][0] == 1
        assert values["there"] == pytest.approx([-math.pi / 2, 0, -math.pi / 2 if first else 0])
        assert tuple(values["end"]) == pytest.approx((1.5, 0, 0) if first else (3, 2.5, 0))
        assert tuple(values["fixed"]) == pytest.approx((3, 3, 0))
        assert found.egoObject.yaw == pytest.approx(0.25)


def test_unions_of_many_regions_agree_with_those_of_few() -> None:
    """At drawn points, at their own height and above, and whatever gave the regions."""
    text = (
        "def square(x, heading):\n    return PolygonalRegion([(x, 0), (x + 2, 0), (x + 2, 2), (x, 2)], orientation=VectorField('own', lambda p: heading))\n"
        "row = [square(x, x / 100) for x in range(0, 60, 2)]\n"
        "F, G = VectorField.forUnionOf(iter(row)), VectorField.forUnionOf(row[:3])\np = Range(0, 5.9)\n"
        "param x = (p, (F at (p, 1)).yaw, (G at (p, 1)).yaw, (G at (p, 1, 7)).yaw, F[p, 0].yaw)\n"
    )
    for x, *headings in draws(text, n=10):
        assert headings == pytest.approx([2 * int(x / 2) / 100] * 4)


def test_a_class_is_no_field_and_says_how_an_instance_is_made() -> None:
    error = failure("class Kind:\n    foo: 3\nkind = [Kind][0]\nx = follow kind from (1, 2) for 3")
    assert isinstance(error, ScenicTypeError)
    assert place(error)[2] == "to create an instance write `new Kind`"


@pytest.mark.parametrize("options", [{}, {"steps": 2}, {"stepSize": 0.5}, {"steps": 3, "stepSize": 0.1}])
@pytest.mark.parametrize("start", ["(2, 3)", "((F relative to 0).yaw, 3)", "(Range(2, 2), 3)"])
def test_ways_are_divided_as_asked_wherever_they_start(start: str, options: dict[str, float]) -> None:
    """The object is where the field says 2, so that a start that waits for it is the same place."""
    given = "".join(f", {name}={value}" for name, value in options.items())
    text = f"F = VectorField('f', lambda p: p.y / 4)\nnew Object at (9, 8), with end F.followFrom({start}, 4{given})\n"
    count = int(options.get("steps", 4 / options.get("stepSize", 1)))
    place = np.array([2.0, 3.0])
    for _ in range(count):
        place += 4 / count * np.array([-np.sin(place[1] / 4), np.cos(place[1] / 4)])
    assert tuple(thing(text).end) == pytest.approx((*place, 0))


@pytest.mark.parametrize("operands", ["F relative to late", "late relative to F"])
def test_what_is_relative_to_a_field_waits_for_all_that_both_read(operands: str) -> None:
    text = (
        "from scenic.core.lazy_eval import DelayedArgument\nF = VectorField('f', lambda p: p.x)\n"
        "late = DelayedArgument({'zeta'}, lambda thing: thing.zeta)\n"
    )
    zeta = "zeta (F relative to 0).yaw / 4"
    for first, second in ((zeta, f"tag {operands}"), (f"tag {operands}", zeta)):
        item = thing(f"{text}new Object at (1, 20), with {first}, with {second}")
        assert_same_rotation(item.tag, euler(1.25))


@pytest.mark.parametrize("use", ["Uniform(F, 3) at (1, 2)", "follow Uniform(F, 3) from (1, 2) for 3"])
def test_a_choice_of_which_only_some_are_fields_is_refused_as_a_whole(use: str) -> None:
    error = failure(f"{FIELD}x = {use}")
    assert isinstance(error, ScenicTypeError)
    assert "expected a vector field, not a random value" in str(error)


@pytest.mark.parametrize(
    "call",
    [
        "join(late, 'b')",
        "join('a', b=late)",
        "join([late], b={'k': (late,)})",
        "join(join(late, b='b'), b=join('c', b=late))",
        "join(b=x, a=late)",
        "max([], default=late)",
        "max([1, 2], key=lambda n: -n, default=late)",
        "max(late, 2, key=lambda n: -n)",
        "min([late, 2])",
        "hypot(late, x)",
        "divmod(7, late)",
        "divmod(late, 2)",
        "round(late, 1)",
        "[late, {'k': late, 'l': [(late, 1)]}]",
        "(late ** 2 // 3 % 5, -late, +late, abs(-late), 2 ** late, 7 % late, 8 // late)",
        "Vector(late, 1, x)",
        "Vector(1, late)",
        "Vector(x, 1, late)",
    ],
)
@pytest.mark.parametrize("x", ["3", "Range(1, 2)"])
def test_calls_wait_for_what_they_get_by_place_or_name(call: str, x: str) -> None:
    text = (
        "from scenic.core.lazy_eval import DelayedArgument\nlate = DelayedArgument({'zeta'}, lambda thing: thing.zeta)\n"
        f"@distributionFunction\ndef join(a, b): return (a, b, str(type(a)), str(type(b)))\nx = {x}\nnew Object with tag {call}, with zeta x\n"
    )
    item = thing(text)
    names = {
        "late": item.zeta,
        "x": item.zeta,
        "join": lambda a, b: (a, b, str(type(a)), str(type(b))),
        "Vector": Vector,
        "hypot": math.hypot,
    }
    assert item.tag == eval(call, names)


@pytest.mark.parametrize(
    "call", ["Vector('a', 1)", "Vector(late, 'a')", "Vector(x, None)", "Vector([1], 2)", "Vector(1, 2, 'b')"]
)
def test_vectors_are_of_numbers_alone_sooner_or_later(call: str) -> None:
    text = (
        "from scenic.core.lazy_eval import DelayedArgument\nlate = DelayedArgument({'zeta'}, lambda thing: thing.zeta)\n"
        f"x = Range(0, 1)\nnew Object with tag {call}, with zeta 3\n"
    )
    assert isinstance(failure(text), ScenicTypeError)


def test_values_that_wait_may_give_others_that_wait() -> None:
    """Each is asked once for an object, however many there are, and whether or not it is kept."""
    text = (
        "from scenic.core.lazy_eval import DelayedArgument, valueInContext\n"
        "def number(n): return DelayedArgument({'zeta'}, lambda thing: n * thing.zeta)\n"
        "many = DelayedArgument({'zeta'}, lambda thing: [valueInContext(number(n), thing) for n in range(50)])\n"
        "nested = DelayedArgument({'zeta'}, lambda thing: [number(2), {'k': (number(3),)}])\n"
        "drawn = DelayedArgument({'zeta'}, lambda thing: Range(0, 1))\n"
        "new Object with many many, with nested nested, with pair (drawn, drawn + 0), with again drawn, with zeta 3\n"
        "new Object at (9, 9), with again drawn, with zeta 3\n"
    )
    first, second = scene(text).objects
    assert first.many == [3 * n for n in range(50)]
    assert first.nested == [6, {"k": (9,)}]
    assert first.pair == (first.again, first.again)
    assert first.again != second.again


@pytest.mark.parametrize(
    "distance", ["1e30", "math.inf", "-math.inf", "math.nan", "Range(1e29, 1e30)", "5e6 + 1"]
)
@pytest.mark.parametrize("form", ["new Point following F from (0, 0) for {}", "follow F from (0, 0) for {}"])
def test_endless_ways_are_refused(form: str, distance: str) -> None:
    text = "import math\nF = VectorField('F', lambda p: 0)\nparam x = " + form.format(distance)
    error = failure(text)
    assert isinstance(error, ScenicValueError)
    assert "a field cannot be followed for" in str(error)


def test_a_way_that_is_not_drawn_may_be_endless() -> None:
    loaded = scenario(
        "F = VectorField('F', lambda p: 0)\nparam x = follow F from (0, 0) for Uniform(3, 1e30)"
    )
    found = []
    for seed in range(12):
        try:
            (drawn,) = loaded.sample(1, seed=seed)
            found.append(tuple(drawn.params["x"].position))
        except ScenicValueError:
            found.append(())
    assert set(found) == {(0, 3, 0), ()}
