"""Functions and methods give the same of a definite value, of a drawn one, and of one that waits for its object."""

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest

from scenic.runtime.values.definite import Orientation, OrientedVector, Vector
from tests.runtime.programs import draws, euler, failure, params, thing

NUMBER = 1.25
FUNCTIONS = [
    "max([{}, 1])", "max({}, 1, key=lambda v: -v)", "max({}, 2, 1.5)", "min(3, {}, 2)", "min(({}, 7))", "min(1, {})", "max([], default={})",
    "round({}, 1)", "round({})", "round(-{}, 0)", "round({} * 100, -1)", "int({})", "int(-{})", "float({})", "str({})", "len([{}, 1])", "len(({},))",
    "filter(lambda v: v > 1, [{}, 0.5, 2])", "filter(None, [{}, 0])", "abs(-{})", "abs({} - 2)", "hypot({}, 3)", "hypot({})", "hypot(1, {}, 2)",
    "sin({})", "cos({})", "{} // 0.5", "-7 // {}", "{} % 0.5", "-7 % {}", "2 ** {}", "{} ** 2", "+{}", "divmod(-7, {})", "divmod({}, 0.5)",
    "numpy.float64(3) * {}", "numpy.float64(3) - {}", "{} / numpy.float64(2)", "numpy.float64(3) / {}",
]  # fmt: skip


def expected_of(expression: str) -> Any:
    names = {
        "filter": lambda function, values: list(filter(function, values)),
        **{name: getattr(math, name) for name in ("hypot", "sin", "cos", "tan")},
        "numpy": np,
    }
    return eval(expression.format(NUMBER), names)


def test_functions_of_numbers_in_every_form() -> None:
    before = "import numpy\nflow = VectorField('flow', lambda place: place.x)\nx, lazy = Range(1.25, 1.25), (flow relative to 0).yaw\n"
    lists = {name: ", ".join(item.format(name) for item in FUNCTIONS) for name in ("1.25", "x", "lazy")}
    found = params(
        f"{before}ego = new Object at (1.25, 2), with found [{lists['lazy']}]\nparam drawn = [{lists['x']}], definite = [{lists['1.25']}], waiting = ego.found\n"
    )
    for form in ("definite", "drawn", "waiting"):
        for expression, value in zip(FUNCTIONS, found[form], strict=True):
            expected = expected_of(expression)
            where = (form, expression)
            if expression.startswith("str"):
                assert value == expected, where
            else:
                assert value == pytest.approx(expected), where
            if expression.startswith(("round", "int", "len")):
                assert type(value) is type(expected), where


def test_conversions_of_nothing_are_those_of_python() -> None:
    """Also where no arguments are unpacked."""
    assert params("param x = [int(), float(), str(), int(*[]), str(*[])]")["x"] == [0, 0.0, "", 0, ""]


@pytest.mark.parametrize(
    "call", ["hypot(1, None)", "sin('a')", "cos([1])", "max()", "max(3)", "min(3)", "len(3)", "round('a')", "max(Range(0, 1))", "len(Range(0, 1))", "int(None)", "hypot(x, 'a')", "sin(Vector(x, 2))"]
)  # fmt: skip
def test_functions_refuse_what_python_refuses(call: str) -> None:
    assert isinstance(failure(f"x = Range(0, 1)\nparam x = {call}"), TypeError)


V = (0.75, -2.0, 1.5)
W = np.array([3.0, 0.5, -1.0])
VECTORS = {
    "v + (3, 0.5, -1)": V + W, "(3, 0.5, -1) + v": V + W, "[3, 0.5, -1] + v": V + W, "v + numpy.array([3, 0.5, -1])": V + W,
    "v - (3, 0.5, -1)": V - W, "(3, 0.5, -1) - v": W - V, "[3, 0.5, -1] - v": W - V, "(3, 0.5) - v": (2.25, 2.5, -1.5),
    "v * 2": 2 * np.array(V), "2 * v": 2 * np.array(V), "v * numpy.float64(2)": 2 * np.array(V), "v * True": V, "v / 2": np.array(V) / 2, "-v": -np.array(V), "+v": V,
    "v.normalized()": V / np.linalg.norm(V), "(v - v).normalized()": (0, 0, 0), "v.toVector()": V, "v.coordinates": V, "v[:2]": V[:2],
    "v.cross((3, 0.5, -1))": np.cross(V, W), "(v.dot((3, 0.5, -1)), v.norm(), len(v))": (V @ W, np.linalg.norm(V), 3),
    "v.applyRotation(0.5)": euler(0.5).apply(V), "v.rotatedBy((0.5, 0.2, 0.1))": euler(0.5, 0.2, 0.1).apply(V), "v.rotatedBy(turn)": euler(0.5, 0.2, 0.1).apply(V),
    "v.offsetLocally(turn, (3, 0.5, -1))": V + euler(0.5, 0.2, 0.1).apply(W), "v.offsetRadially(2, 0.5)": V + euler(0.5).apply([0, 2, 0]),
    "v.sphericalCoordinates()": (np.linalg.norm(V), math.atan2(-2, 0.75) - math.pi / 2, math.atan2(1.5, math.hypot(0.75, 2))),
    "(v.angleTo((0.75, 3)), v.azimuthTo((2, -2)), v.altitudeTo((0.75, -2, 9)))": (0, -math.pi / 2, math.pi / 2),
    "(v.distanceTo((0.75, -2, 4)), v.distanceTo(box), v.distanceTo(far))": (2.5, math.hypot(1, 1), 4.5), "tuple(turn * v)": euler(0.5, 0.2, 0.1).apply(V),
    "turn.globalToLocalAngles(0.5, 0.2, 0.1)": (0, 0, 0), "turn.localAnglesFor(0.5)": (euler(0.5, 0.2, 0.1).inv() * euler(0.5)).as_euler("ZXY"),
}  # fmt: skip


def test_vectors_in_both_forms() -> None:
    before = (
        "import numpy\nturn = Orientation.fromEuler(0.5, 0.2, 0.1)\nbox = BoxRegion(dimensions=(2, 2, 2), position=(0, 0, -0.5))\n"
        "far = new Object at (0.75, -7, 1.5), with width 1, with length 1, with height 9\n"
    )
    shown = ", ".join(VECTORS)
    for vector in ("Vector(0.75, -2, 1.5)", "Vector(Range(0.75, 0.75), -2, 1.5)"):
        found = params(f"{before}v = {vector}\nparam found = [{shown}]")["found"]
        for expression, value in zip(VECTORS, found, strict=True):
            np.testing.assert_allclose(
                tuple(value), VECTORS[expression], atol=1e-9, err_msg=f"{expression} of {vector}"
            )


@pytest.mark.parametrize("vector", ["Vector(1, 2, 3)", "Vector(Range(0, 1), 2, 3)"])
def test_vectors_refuse_what_is_no_operand(vector: str) -> None:
    for use in (
        "v + 'a'",
        "v - None",
        "3 + v",
        "v - 3",
        "v * 'a'",
        "v * v",
        "v / v",
        "2 / v",
        "v + (1, 2, 3, 4)",
        "v['x']",
        "v[1.5]",
    ):
        assert isinstance(failure(f"v = {vector}\nparam x = {use}"), TypeError), use


def test_distances_to_what_waits_for_the_object() -> None:
    text = "flow = VectorField('flow', lambda place: place.x)\nplace = ((flow relative to 0).yaw, 6)\nv = {}\nnew Object at (1.25, 2), with tag v.distanceTo(place offset by (2, 0, 0))\n"
    for vector in ("Vector(1.25, 2, 0)", "Vector(Range(1.25, 1.25), 2, 0)"):
        assert thing(text.format(vector)).tag == pytest.approx(math.hypot(2, 4))


def test_rows_of_vectors() -> None:
    vector = Vector(1, 2.5, 1)
    assert [vector.index(1), vector.index(2.5), vector.count(1), vector.count(7)] == [0, 1, 2, 0]
    with pytest.raises(ValueError, match="not in"):
        vector.index(7)
    whole = np.array(vector, dtype=int)
    assert whole.tolist() == [1, 2, 1]
    assert whole.dtype == int
    assert np.asarray(vector).dtype == float
    assert copy.copy(vector) is copy.deepcopy(vector) is vector
    assert hash(Vector(1, 2, 0)) == hash(Vector(1, 2))
    assert hash(Vector(0.0, 0, 0)) == hash(Vector(-0.0, 0, 0))
    assert (Vector(1, 2) == 3, Vector(1, 2) == None, Vector(1, 2) != "12") == (False, False, True)  # noqa: E711
    for wrong in ((1, "a", 2), (1, None, 2), ([1], 2, 3)):
        with pytest.raises(TypeError, match="three numbers"):
            Vector(*wrong)


def test_vectors_with_a_heading_keep_it_in_copies_alone() -> None:
    made = OrientedVector.make((1, 2, 3), 0.5)
    for same in (
        copy.copy(made),
        copy.deepcopy(made),
        pickle.loads(pickle.dumps(made)),
        OrientedVector(1, 2, 3, 0.5),
    ):
        assert type(same) is OrientedVector
        assert (same, same.toHeading(), same.heading) == ((1, 2, 3), 0.5, 0.5)
    for other in (made + made, made - (1, 0, 0), made * 2, made.rotatedBy(0.3), -made):
        assert type(other) is Vector
    assert {made, Vector(1, 2, 3)} == {made}


def test_orientations_are_equal_as_rotations_alone() -> None:
    turn = Orientation.fromEuler(0.5, 0.2, 0.1)
    for other in (0.5, (0.5, 0.2, 0.1), turn.q, None):
        assert turn != other
    for row in ((0.6, 0.0, 0.8, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 0.0), (0.5, -0.5, 0.5, -0.5)):
        one, opposite = Orientation.of(row), Orientation.of(-part for part in row)
        assert one == opposite
        assert hash(one) == hash(opposite)
        assert len({one, opposite, Orientation.fromQuaternion(row)}) == 1
        assert one.approxEq(opposite)
        assert one != turn
    assert turn.approxEq(Orientation.fromEuler(0.52, 0.2, 0.1), tol=1e-3)
    assert not turn.approxEq(Orientation.fromEuler(0.62, 0.2, 0.1), tol=1e-3)
    assert copy.deepcopy(turn) == pickle.loads(pickle.dumps(turn)) == turn


@pytest.mark.parametrize("angles", ["1, 0, True", "numpy.float64(1), numpy.int64(0), 1", "1.0, 0.0, 1.0"])
def test_euler_angles_are_numbers_of_any_type(angles: str) -> None:
    found = params(
        f"import numpy\nx = Range(1, 1)\nparam x = [Orientation.fromEuler({angles}), Orientation.fromEuler(x, 0, x)]"
    )
    for turn in found["x"]:
        np.testing.assert_allclose(turn.r.as_matrix(), euler(1, 0, 1).as_matrix(), atol=1e-12)


def test_choices_among_functions_are_called_option_by_option() -> None:
    """Python's own, the language's and the program's, with random arguments and with keywords."""
    text = (
        "import math\ndef twice(v, times=2): return v * times if v > 0.5 else 0\ndef thrice(v, times=3): return -v * times\n"
        "x, n = Range(0, 1), DiscreteRange(4, 6)\nf = Uniform(math.sin, cos, twice, abs)\ng = Uniform(max, min)\nh = Uniform(twice, thrice)\n"
        "param x = (x, f(x), g(x, 0.5), g([1, 2, 3], key=lambda v: -v), h(x, times=n), h(times=2, v=x), n)\n"
    )
    seen = set()
    for x, called, extreme, listed, scaled, doubled, n in draws(text, n=60):
        options = (math.sin(x), math.cos(x), 2 * x if x > 0.5 else 0, x)
        which = min(range(4), key=lambda number: abs(options[number] - called))
        assert called == pytest.approx(options[which])
        assert (extreme, listed) in ((max(x, 0.5), 1), (min(x, 0.5), 3))
        assert scaled == pytest.approx(-n * x if doubled < 0 else n * x if x > 0.5 else 0)
        assert abs(doubled) == pytest.approx(2 * x if x > 0.5 or doubled < 0 else 0)
        seen.add((which, listed))
    assert len(seen) == 8


@pytest.mark.parametrize("vector", ["Vector(1, 2, 3)", "Vector(Range(0, 1), 2, 3)"])
def test_other_operands_may_know_what_to_do_with_a_vector(vector: str) -> None:
    text = (
        "class Scale(object):\n    def __rmul__(self, other): return 'times'\n    def __rtruediv__(self, other): return 'over'\n"
        "    def __radd__(self, other): return 'plus'\n    def __rsub__(self, other): return 'minus'\n"
        f"v, s = {vector}, Scale()\nparam x = [v * s, v / s, v + s, v - s]"
    )
    assert params(text)["x"] == ["times", "over", "plus", "minus"]
