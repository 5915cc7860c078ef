"""Values that a property cannot hold are refused: at once, or when they are drawn."""

import math

import pytest

from scenic.language.errors import ScenicTypeError, ScenicValueError
from tests.runtime.programs import failure, params, place, scenario, thing

WRONG = [
    # (property, a value that fits, one that does not, the code)
    ("shape", "ConeShape()", "3", "SC404"),
    ("viewAngles", "(1, 0.5)", "3", "SC404"),
    ("viewAngles", "(1, 0.5)", "(1, 0)", "SC405"),
    ("color", "(1, 0, 0.5)", "3", "SC405"),
    ("color", "None", "(1, 0, 2)", "SC405"),
]


@pytest.mark.parametrize(("name", "fits", "wrong", "code"), WRONG)
@pytest.mark.parametrize(
    "form", ["{1}", "Uniform({0}, {1})", "Uniform([{0}, {1}], [{0}, {1}])[DiscreteRange(1, 1)]"]
)
def test_a_wrong_value_is_refused(name: str, fits: str, wrong: str, code: str, form: str) -> None:
    program = "ego = new Object\nnew Object at (4, 5, 6), with {} {}"
    error = failure(program.format(name, form.format(fits, wrong)))
    assert place(error)[:1] == (code,)
    assert place(error)[1].startswith("2:")
    assert thing(program.format(name, form.format(fits, fits))) is not None


@pytest.mark.parametrize("value", ["Range(0, 1)", "(Range(0, 1), 2, 3) relative to (1, 2, 3)"])
def test_random_numbers_are_no_shapes(value: str) -> None:
    assert place(failure(f"ego = new Object with shape {value}"))[0] == "SC404"


@pytest.mark.parametrize("name", ["allowCollisions", "requireVisible", "occluding"])
def test_truth_is_that_of_python(name: str) -> None:
    """A drawn value of any type is true or false as Python says; a vector is neither."""
    assert place(failure(f"ego = new Object with {name} Vector(Range(0, 1), 2, 3)"))[0] == "SC404"
    drawn = "Uniform([(), (1, 2)], [(), (1, 2)])[DiscreteRange({0}, {0})]"
    ego = "ego = new Object\n"
    for index in (0, 1):
        item = thing(f"{ego}new Object at (0, 5), with {name} {drawn.format(index)}")
        assert getattr(item, name) is bool(index)


def test_options_of_view_angles_are_limited_too() -> None:
    with pytest.warns(UserWarning, match="truncated"):
        item = thing("ego = new Object with viewAngles Uniform((7, 1), (7, 1))")
    assert tuple(item.viewAngles) == (pytest.approx(6.283185307179586), 1)


def test_a_random_behavior() -> None:
    program = "behavior Idle():\n    wait\nego = new Object with behavior {}"
    assert type(thing(program.format("Uniform(Idle, Idle)")).behavior).__name__ == "Idle"
    assert place(failure(program.format("Uniform(1, 2)")))[0] == "SC404"
    assert place(failure(program.format("Uniform(Idle(), 2)")))[0] == "SC404"


def test_an_observer_that_is_a_random_number() -> None:
    error = failure("param x = CircularRegion((0, 0), 3) visible from Range(1, 2)")
    assert place(error)[0] == "SC404"


def test_a_colour_that_is_given_as_a_list_is_kept_as_a_tuple() -> None:
    assert thing("c = [1, 0, 0.5]\nego = new Object with color c\nc.append(3)").color == (1, 0, 0.5)


EDGES = [
    # (property, the last value that fits, one that does not)
    ("visibleDistance", "0", "-1e-300"),
    ("viewRayCount", "(1, 1)", "(1, 0.999)"),
    ("viewRayCount", "None", "(0.999, 1)"),
    ("color", "(0, 1, 0)", "(0, 1, 1.001)"),
    ("color", "(1, 0, 1, 0)", "(-0.001, 0, 1, 0)"),
    ("color", "(0, 0, 0, 1)", "(0, 0)"),
    ("viewAngles", "(2 * math.pi, math.pi)", "(0, 1)"),
    ("viewAngles", "(1e-300, 1e-300)", "(1, -1)"),
    ("width", "1e-9", "0"),
    ("length", "1e300", "math.inf"),
    ("yaw", "-math.pi", "math.inf"),
    ("position", "(1e300, 0, 0)", "(0, 0, math.nan)"),
    ("position", "(0, 1e300, 0)", "(0, -math.inf, 0)"),
    ("visibleDistance", "1e300", "math.nan"),
    ("viewRayCount", "(1, 1)", "(math.nan, 2)"),
    ("viewAngles", "(1, 1)", "(math.nan, 1)"),
    ("color", "(0.5, 1, 0)", "(0, math.nan, 1)"),
    ("yaw", "math.pi", "math.nan"),
    ("pitch", "1.5", "-math.inf"),
    ("roll", "-1.5", "math.nan"),
]


@pytest.mark.parametrize(("name", "fits", "wrong"), EDGES)
def test_the_last_value_that_fits(name: str, fits: str, wrong: str) -> None:
    """It is kept as it is, without a warning; the next one is refused."""
    text = "import math\nego = new Object with {0} {1}\nparam x = ego.{0}"
    assert params(text.format(name, fits))["x"] == eval(fits, {"math": math})
    assert isinstance(failure(text.format(name, wrong)), ScenicValueError)


@pytest.mark.parametrize("angle", [4.0, -4.0, 7.0, -7.0, 3.5, 100.0])
@pytest.mark.parametrize("name", ["yaw", "pitch", "roll"])
def test_angles_are_stored_within_half_a_turn(name: str, angle: float) -> None:
    found = params(f"p = new OrientedPoint with {name} {angle}\nparam x = p.{name}")["x"]
    assert abs(found) <= math.pi
    assert math.isclose(math.cos(found), math.cos(angle), abs_tol=1e-9)
    assert math.isclose(math.sin(found), math.sin(angle), abs_tol=1e-9)


FORMS = [
    # (property, a form of a value, what is stored)
    ("viewAngles", "[1, 0.5]", (1, 0.5)),
    ("viewAngles", "1 @ 0.5", (1, 0.5)),
    ("viewAngles", "Vector(1, 0.5, 0)", (1, 0.5)),
    ("viewAngles", "Uniform([1, 0.5], [1, 0.5])", (1, 0.5)),
    ("viewAngles", "Uniform(1 @ 0.5, Uniform([1, 0.5], (1, 0.5)))", (1, 0.5)),
    ("viewAngles", "(Range(7, 8), Range(4, 5))", (math.tau, math.pi)),
    ("viewAngles", "[Range(7, 8), 0.5]", (math.tau, 0.5)),
    ("color", "[1, 0.5, 0]", (1, 0.5, 0)),
    ("color", "(1, 0.5, 0, 0.25)", (1, 0.5, 0, 0.25)),
    ("color", "(Range(1, 1), 0.5, DiscreteRange(0, 0))", (1, 0.5, 0)),
    ("color", "Uniform([1, 0.5, 0], Uniform([1, 0.5, 0], (1, 0.5, 0)))", (1, 0.5, 0)),
    ("viewRayCount", "[3, 2]", (3, 2)),
    ("viewRayCount", "Uniform([3, 2], Uniform([3, 2], (3, 2)))", (3, 2)),
    ("viewRayCount", "(DiscreteRange(3, 3), 2)", (3, 2)),
    ("viewRayCount", "Uniform([3, 2], told([3, 2], Range(0, 1)))", (3, 2)),
    ("viewAngles", "Uniform(told([1, 0.5], Range(0, 1)), [1, 0.5])", (1, 0.5)),
    ("color", "Uniform(told([1, 0.5, 0], Range(0, 1)), [1, 0.5, 0])", (1, 0.5, 0)),
]


@pytest.mark.parametrize(("name", "form", "stored"), FORMS)
def test_pairs_and_colours_are_kept_as_tuples_whatever_they_are_given_as(
    name: str, form: str, stored: tuple[float, ...]
) -> None:
    item = thing(f"told = distributionFunction(lambda value, _: value)\nego = new Object with {name} {form}")
    found = getattr(item, name)
    assert type(found) is tuple
    assert found == pytest.approx(stored, abs=1e-12)


@pytest.mark.parametrize(
    "truth", ["DiscreteRange(0, 1)", "Uniform(0, 0.5)", "Uniform(False, True)", "max(0, Range(-1, 1))"]
)
def test_drawn_numbers_may_say_whether_something_holds(truth: str) -> None:
    """Objects that may collide by chance do so only in scenes where they may."""
    text = f"may = {truth}\nego = new Object with allowCollisions may\nx = Range(0, 2)\nother = new Object at (x, 0)\nparam may = may\n"
    met = [(bool(item.params["may"]), item.objects[1].x < 1) for item in scenario(text).sample(40, seed=1)]
    assert set(met) == {(True, True), (True, False), (False, False)}


@pytest.mark.parametrize("kind", ["monitor M():\n    wait", "scenario M():\n    setup:\n        pass"])
@pytest.mark.parametrize("value", ["M", "M()"])
def test_only_behaviors_are_behaviors(kind: str, value: str) -> None:
    """Not what else can be run, nor its class."""
    error = failure(f"{kind}\nego = new Object with behavior {value}")
    assert isinstance(error, ScenicTypeError), error
    assert "must be a behavior" in str(error)
