"""The language's operators: on fixed operands, on random ones of the same values, on choices; and their mistakes."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenic.language.errors import InvalidScenarioError, RandomControlFlowError, ScenicTypeError
from scenic.runtime.values.values import Orientation, Vector
from tests.each import each
from tests.runtime.programs import (
    altitude,
    assert_angles_equal,
    assert_same_rotation,
    azimuth,
    euler,
    failure,
    params,
    place,
    scenario,
)

A, B = np.array([1.0, -2, 3]), np.array([4.0, 5, -6])
EGO_AT, EGO_TURNED = np.array([7.0, 8, 9]), euler(0.4, 0.3, -0.2)
P_AT, P_TURNED = np.array([-3.0, 2, 1]), euler(2.5, -0.3, 0.2)
YAW_P, YAW_EGO = 2.5, 0.4

FIXED = {
    "a": "(1, -2, 3)",
    "b": "Vector(4, 5, -6)",
    "s": "0.75",
    "h": "1.5",
    "o": "Orientation.fromEuler(0.3, 0.2, 0.1)",
    "eyaw": "0.4",
    "pyaw": "2.5",
}
RANDOM = {
    "a": "(Range(1, 1), -2, Range(3, 3))",
    "b": "Vector(4, Range(5, 5), -6)",
    "s": "Range(0.75, 0.75)",
    "h": "Uniform(1.5, 1.5)",
    "o": "Orientation.fromEuler(Range(0.3, 0.3), 0.2, 0.1)",
    "eyaw": "Range(0.4, 0.4)",
    "pyaw": "Range(2.5, 2.5)",
}
NUMPY = FIXED | {
    "a": "numpy.array([1, -2, 3])",
    "s": "numpy.float64(0.75)",
    "h": "numpy.float32(1.5)",
    "eyaw": "numpy.float64(0.4)",
    "pyaw": "numpy.float32(2.5)",
}
MIXED = FIXED | {
    "a": "Uniform((1, -2, 3), Vector(1, -2, 3), [1, -2, 3], new Point at (1, -2, 3))",
    "b": "Uniform(Vector(4, 5, -6), new Object at (4, 5, -6), with allowCollisions True)",
    "s": "Uniform(0.75, Range(0.75, 0.75))",
}
TURN = euler(0.3, 0.2, 0.1)


def setting(operands: dict[str, str]) -> str:
    return (
        "import numpy\n"
        f"ego = new Object at (7, 8, 9), facing ({operands['eyaw']}, 0.3, -0.2), with allowCollisions True,\n"
        "    with width 2, with length 4, with height 6\n"
        f"p = new OrientedPoint at (-3, 2, 1), facing ({operands['pyaw']}, -0.3, 0.2)\n"
        + "".join(f"{name} = {operands[name]}\n" for name in "absho")
    )


def wrap(angle: float) -> float:
    return float(np.angle(np.exp(1j * angle)))


CASES: dict[str, Any] = {
    "s deg": 0.75 * math.pi / 180,
    "b deg": B * math.pi / 180,
    "s @ h": np.array([0.75, 1.5, 0]),
    "a relative to b": A + B,
    "a offset by b": A + B,
    "b relative to b": B + B,
    "b offset by a": A + B,
    "s relative to h": euler(2.25),
    "o relative to s": euler(0.75) * TURN,
    "s relative to o": TURN * euler(0.75),
    "s relative to p": YAW_P + 0.75,
    "p relative to s": YAW_P + 0.75,
    "o relative to p": P_TURNED * TURN,
    "p relative to o": TURN * P_TURNED,
    "(b relative to p).position": P_AT + P_TURNED.apply(B),
    "(p offset by b).orientation": P_TURNED,
    "a offset along s by b": A + euler(0.75).apply(B),
    "a offset along o by b": A + TURN.apply(B),
    "a offset along p by b": A + P_TURNED.apply(B),
    "relative position of a": A - EGO_AT,
    "relative position of a from b": A - B,
    "relative heading of s": wrap(0.75 - YAW_EGO),
    "relative heading of p from h": wrap(YAW_P - 1.5),
    "relative heading of o from p": wrap(TURN.as_euler("ZXY")[0] - YAW_P),
    "apparent heading of p": wrap(YAW_P - azimuth(P_AT - EGO_AT)),
    "apparent heading of p from b": wrap(YAW_P - azimuth(P_AT - B)),
    "apparent heading to b": wrap(azimuth(B - EGO_AT) - YAW_EGO),
    "apparent heading to b from p": wrap(azimuth(B - P_AT) - YAW_P),
    "distance to b": np.linalg.norm(B - EGO_AT),
    "distance from b": np.linalg.norm(B - EGO_AT),
    "distance from a to b": np.linalg.norm(B - A),
    "distance from ego to p": np.linalg.norm(P_AT - EGO_AT),
    "distance past b": euler(-YAW_EGO).apply(EGO_AT - B)[1],
    "distance past b of p": euler(-YAW_P).apply(P_AT - B)[1],
    "angle to b": azimuth(B - EGO_AT),
    "angle from b": azimuth(EGO_AT - B),
    "angle from a to b": azimuth(B - A),
    "altitude to b": altitude(B - EGO_AT),
    "altitude from b": altitude(EGO_AT - B),
    "altitude from a to b": altitude(B - A),
    "(front of ego).position": EGO_AT + EGO_TURNED.apply([0, 2, 0]),
    "(left of ego).position": EGO_AT + EGO_TURNED.apply([-1, 0, 0]),
    "(back right of ego).position": EGO_AT + EGO_TURNED.apply([1, -2, 0]),
    "(bottom of ego).position": EGO_AT + EGO_TURNED.apply([0, 0, -3]),
    "(top front left of ego).position": EGO_AT + EGO_TURNED.apply([-1, 2, 3]),
    "(bottom back right of ego).orientation": EGO_TURNED,
    "b.norm()": np.linalg.norm(B),
    "b.dot(a)": A @ B,
    "b.cross(a)": np.cross(B, A),
    "b.normalized()": B / np.linalg.norm(B),
    "b.rotatedBy(s)": euler(0.75).apply(B),
    "b.rotatedBy(o)": TURN.apply(B),
    "b.distanceTo(a)": np.linalg.norm(B - A),
    "b.angleTo(a)": azimuth(A - B),
    "b.altitudeTo(a)": altitude(A - B),
    "b.angleWith(a)": wrap(azimuth(A) - azimuth(B)),
    "b.offsetRotated(s, a)": B + euler(0.75).apply(A),
    "b.offsetLocally(o, a)": B + TURN.apply(A),
    "b.offsetRadially(s, h)": B + euler(1.5).apply([0, 0.75, 0]),
    "b.sphericalCoordinates()[0]": np.linalg.norm(B),
    "b + a": A + B,
    "a + b": A + B,
    "b - a": B - A,
    "a - b": A - B,
    "s * b": 0.75 * B,
    "b * s": 0.75 * B,
    "b / s": B / 0.75,
    "-b": -B,
    "b[1]": 5.0,
    "b.y + b.z": -1.0,
    "o.yaw": 0.3,
    "o.roll": 0.1,
    "o.inverse": TURN.inv(),
    "o * o": TURN * TURN,
    "o + s": TURN * euler(0.75),
    "s + o": euler(0.75) * TURN,
    "o * b": TURN.apply(B),
    "o.localAnglesFor(s)[0]": (TURN.inv() * euler(0.75)).as_euler("ZXY")[0],
    "sin(s) + cos(s) + hypot(s, h)": math.sin(0.75) + math.cos(0.75) + math.hypot(0.75, 1.5),
    "max(s, h, 0.2) + min(s, h, 0.9)": 2.25,
    "round(s) + abs(-s) + int(h) + float(s)": 1 + 0.75 + 1 + 0.75,
    "divmod(h, s)[0] + h // s + h % s + h ** 2": 2 + 2 + 0 + 2.25,
}  # fmt: skip


def assert_is(found: Any, expected: Any, case: str) -> None:
    if isinstance(found, Vector):
        np.testing.assert_allclose(tuple(found), expected, atol=1e-9, err_msg=case)
    elif isinstance(found, Orientation):
        assert_same_rotation(found, expected)
    elif hasattr(expected, "as_matrix"):
        assert_same_rotation(Orientation.fromEuler(found, 0, 0), expected)
    elif "heading" in case or "angle" in case.lower():
        assert_angles_equal(found, expected)
    else:
        assert found == pytest.approx(expected, abs=1e-9), case


@pytest.mark.parametrize("operands", [FIXED, RANDOM, NUMPY], ids=["fixed", "random", "numpy"])
def test_operators(operands: dict[str, str]) -> None:
    listed = "".join(f"param c{index} = {case}\n" for index, case in enumerate(CASES))
    listed = listed.replace("b.", "Vector(*b)." if operands is MIXED else "b.")
    found = params(setting(operands) + listed)
    for index, (case, expected) in enumerate(CASES.items()):
        assert_is(found[f"c{index}"], expected, case)


PLACES = [case for case in CASES if "b." not in case and " + " not in case and "*" not in case and "b[" not in case
          and case not in ("b deg", "-b", "a - b", "b - a", "b / s", "a relative to b", "a offset by b")
          and "b relative to" not in case and "offset by b" not in case]  # fmt: skip


def test_operators_on_choices_of_different_types() -> None:
    listed = "".join(f"param c{index} = {case}\n" for index, case in enumerate(PLACES))
    for seed in range(8):
        found = params(setting(MIXED) + listed, seed=seed)
        for index, case in enumerate(PLACES):
            assert_is(found[f"c{index}"], CASES[case], case)


LANGUAGE = list(CASES)[: list(CASES).index("b.norm()")]


@pytest.mark.parametrize("way", ["told({0}, Range(0, 1))", "Uniform(told({0}, Range(0, 1)), {0})"])
@pytest.mark.parametrize("hidden", ["absho", "p", "e", "abshope"])
def test_what_operators_mean_is_decided_when_their_operands_are_drawn(hidden: str, way: str) -> None:
    """Of a value that a function of the program gives nothing is known before; nor of a choice that may be such a value."""
    cases = [case for case in LANGUAGE if "deg" not in case]
    text = "e = ego\ntold = distributionFunction(lambda value, _: value)\n"
    text += "".join(f"{name} = {way.format(name)}\n" for name in hidden)
    text += "".join(f"param c{index} = {case.replace(' ego', ' e')}\n" for index, case in enumerate(cases))
    found = params(setting(FIXED) + text)
    for index, case in enumerate(cases):
        assert_is(found[f"c{index}"], CASES[case], case)


def test_operators_say_what_is_wrong_with_an_operand_that_is_drawn() -> None:
    text = "told = distributionFunction(lambda value: value)\nx = told(Range(1, 1))\nego = new Object\nparam p = "
    cases = {
        "front of x": "an object",
        "apparent heading of x": "an oriented point",
        "apparent heading to (1, 2) from x": "an oriented point",
        "ego left of x": "an oriented point",
        "x intersects ego": "an object or a region",
        "minimum distance from ego to x": "an object",
        "distance past (0, 0) of x": "an oriented point",
        "x at (1, 2)": "a vector field",
        "follow x from (1, 2) for 3": "a vector field",
        "distance from x to ego": "a vector or a region",
        "minimum distance from x": "an object",
        "top front left of x": "an object",
        "ego intersects x": "an object or a region",
    }
    for case, expected in cases.items():
        error = failure(text + case + "\n")
        assert isinstance(error, ScenicTypeError), case
        assert f"expected {expected}, not 1" in str(error), case
        assert place(error)[1].startswith("4:11-"), case


def test_fields_and_regions_that_are_drawn_are_asked_then() -> None:
    text = (
        "told = distributionFunction(lambda value, _: value)\nego = new Object at (3, 0, 0.5)\n"
        "F = told(VectorField('F', lambda place: 0.5), Range(0, 1))\nD = told(CircularRegion((0, 0), 2), Range(0, 1))\n"
        "param f = F at (1, 2), g = (follow F from (1, 2) for 3).position, far = distance from D to (5, 0)\n"
        "param near = distance from (1, 0) to D, met = D intersects ego, same = ego intersects D\n"
    )
    found = params(text)
    assert_same_rotation(found["f"], euler(0.5))
    assert tuple(found["g"]) == pytest.approx((1 - 3 * math.sin(0.5), 2 + 3 * math.cos(0.5), 0))
    assert (found["far"], found["near"]) == (3, 0)
    assert found["met"] is found["same"] is False


def test_options_of_different_types_are_relative_each_in_its_way() -> None:
    text = (
        "p = new OrientedPoint at (1, 2), facing 0.5\nn = DiscreteRange(0, 3)\n"
        "x = Uniform([0.25, Orientation.fromEuler(0.25, 0, 0), (0, 2), 'no'], [0.25] * 4)[n]\n"
        "y = Uniform(0.25, Orientation.fromEuler(0.25, 0, 0))\n"
        "param n = n, x = x relative to p, y = y relative to 0.5, z = 0.5 relative to y\nrequire n < 3\n"
    )
    seen = set()
    for scene in scenario(text).sample(40, seed=1):
        found, n = scene.params["x"], scene.params["n"]
        seen.add((n, type(found).__name__))
        if isinstance(found, float):
            assert found == pytest.approx(0.75)
        elif isinstance(found, Orientation):
            assert_same_rotation(found, euler(0.75))
        else:
            assert tuple(found.position) == pytest.approx((1 - 2 * math.sin(0.5), 2 + 2 * math.cos(0.5), 0))
            assert found.heading == pytest.approx(0.5)
        for name in "yz":
            assert_same_rotation(scene.params[name], euler(0.75))
    assert seen == {(0, "float"), (1, "float"), (2, "float"), (1, "Orientation"), (2, "OrientedPoint")}
    field = "F = VectorField('F', lambda place: 0.5)\nf = distributionFunction(lambda _: F)\n"
    error = failure(f"{field}param x = f(Range(0, 1)) relative to 0.5\n")
    assert isinstance(error, InvalidScenarioError)
    assert place(error)[1].startswith("3:")


def test_operators_need_an_ego_only_where_they_mean_it() -> None:
    for case in ("distance to (1, 2)", "angle from (1, 2)", "altitude to (1, 2)", "relative heading of 1",
                 "relative position of (1, 2)", "distance past (1, 2)"):  # fmt: skip
        found = failure(f"x = {case}")
        assert type(found) is InvalidScenarioError, case
        assert found.span is not None
    assert params("param x = distance from (0, 3) to (4, 0)")["x"] == 5


@pytest.mark.parametrize(
    "expression",
    [
        "(1, 2) deg",
        "'a' deg",
        "(1, 2) @ 3",
        "'a' @ 3",
        "p relative to p",
        "p relative to 'a'",
        "'a' relative to 'b'",
        "(1, 2) relative to 3",
        "relative heading of (1, 2) from 3",
        "relative position of 3 from (1, 2)",
        "apparent heading of (1, 2) from (3, 4)",
        "apparent heading to (1, 2) from (3, 4)",
        "(1, 2) behind 3",
        "distance from 1 to (1, 2)",
        "distance from (1,) to (1, 2)",
        "angle from (1, 2) to ()",
        "relative heading of () from 1",
        "distance past (1, 2) of (3, 4)",
        "angle from 'here' to (1, 2)",
        "altitude from (1, 2) to 4",
        "front of p",
        "top front left of (1, 2)",
        "(1, 2) offset along 'north' by (3, 4)",
        "p intersects p",
        "3 intersects everywhere",
        "everywhere intersects 3",
        "everywhere intersects p",
    ],
)
def test_wrong_operands_are_type_errors_with_a_place(expression: str) -> None:
    text = f"p = new OrientedPoint\nx = {expression}\n"
    found = failure(text)
    assert isinstance(found, ScenicTypeError), found
    assert found.span is not None
    line = text.splitlines()[found.span.line - 1]
    assert line[found.span.column : found.span.end_column] == expression


def test_wrong_operands_that_are_drawn_fail_when_they_are_drawn() -> None:
    for seed in range(8):
        found = failure("x = Uniform('near', 'far')\nparam d = distance from x to (1, 2)", seed=seed)
        assert isinstance(found, ScenicTypeError)
        assert found.span is not None
        assert found.span.line == 2


COORDINATE = st.floats(-100, 100).map(lambda number: round(number, 3))
POINT = st.tuples(COORDINATE, COORDINATE, COORDINATE)
ANGLE = st.floats(-3, 3).map(lambda number: round(number, 3))


@settings(max_examples=25, deadline=None)
@given(POINT, POINT, st.tuples(ANGLE, ANGLE, ANGLE))
def test_frames_and_places(a: Any, b: Any, angles: Any) -> None:
    found = params(
        f"p = new OrientedPoint at {a}, facing {angles}\n"
        f"param there = ({b} relative to p).position, back = p.relativePosition({b})\n"
        f"param distance = distance from p to {b}, apparent = apparent heading of p from {b}"
    )
    turned = euler(*angles)
    np.testing.assert_allclose(tuple(found["there"]), np.array(a) + turned.apply(b), atol=1e-6)
    np.testing.assert_allclose(tuple(found["back"]), tuple(found["there"]), atol=1e-6)
    assert found["distance"] == pytest.approx(float(np.linalg.norm(np.subtract(a, b))))


def test_containment_and_intersection() -> None:
    text = (
        "big = new Object with width 4, with length 4, with height 4, with allowCollisions True\n"
        "small = new Object at (0.5, 0, 0), with allowCollisions True\n"
        "far = new Object at (9, 0, 0)\n"
        "disc = CircularRegion((0, 0), 3)\n"
        "param both = big intersects small, none = big intersects far, corner = (2.9, 0, 5) in disc\n"
        "param outside = (3.1, 0) in disc, whole = small in disc, part = far in disc, not_in = (9, 9) not in disc\n"
    )
    assert params(text) == {
        "both": True, "none": False, "corner": True, "outside": False, "whole": True, "part": False, "not_in": True
    }  # fmt: skip


def test_degrees_scale_everything_to_their_left() -> None:
    found = params("param a = 2 * 90 deg, b = (1 @ 2) deg, c = 90 deg + 1, d = -90 deg")
    assert found["a"] == pytest.approx(math.pi)
    assert tuple(found["b"]) == pytest.approx((math.radians(1), math.radians(2), 0))
    assert found["c"] == pytest.approx(math.pi / 2 + 1)
    assert found["d"] == pytest.approx(-math.pi / 2)


def test_vectors_compare_with_tuples() -> None:
    assert params(
        "v = Vector(1, 2, 0)\nparam a = v == (1, 2), b = v == [1, 2, 0], c = v != (1, 3), d = v == 'x', e = len(v)\n"
        "param f = list(v), g = v[0:2], h = v[-1], i = hash(v) == hash(Vector(1, 2))"
    ) == {"a": True, "b": True, "c": True, "d": False, "e": 3, "f": [1, 2, 0], "g": (1, 2), "h": 0, "i": True}


@pytest.mark.parametrize(
    "value", ["Range(0.1, 0.9)", "DiscreteRange(1, 2)", "1", "True", "numpy.float64(0.5)"]
)
@pytest.mark.parametrize("index", range(3))
def test_orientations_from_angles_of_all_kinds(index: int, value: str) -> None:
    """Whichever of the angles is random, an integer, a truth value or a number of NumPy's."""
    angles = ["0.4", "-0.3", "0.2"]
    angles[index] = "a"
    found = params(
        f"import numpy\na = {value}\nparam a = a, o = Orientation.fromEuler({', '.join(angles)})\n"
    )
    numbers = [float(found["a"]) if angle == "a" else float(angle) for angle in angles]
    assert_same_rotation(found["o"], euler(*numbers))


TURN = "Orientation.fromEuler(0.3, 0, 0)"


@pytest.mark.parametrize("operator", "*/")
@pytest.mark.parametrize(
    "other",
    [
        "{v}",
        "{o}",
        "Uniform({v}, (0, 0, 1))",
        "Uniform({o}, {o})",
        "Orientation.fromEuler(Range(0, 1), 0, 0)",
    ],
)
@pytest.mark.parametrize(
    "vector", ["Vector(1, 2, 3)", "Vector(Range(0, 1), 2, 3)", "Uniform(Vector(1, 0, 0), Vector(2, 0, 0))"]
)
def test_vectors_are_multiplied_and_divided_by_numbers_alone(vector: str, operator: str, other: str) -> None:
    """Whether they are random or not; what else it is, is told."""
    other = other.format(v="Vector(4, 5, 6)", o=TURN)
    error = failure(f"param x = {vector} {operator} {other}\n")
    assert isinstance(error, TypeError)
    assert place(error)[1].startswith("1:")
    for number in ("2", "Range(2, 2)", "Uniform(2, 2.0)"):
        found = tuple(params(f"v = {vector}\nparam v = v, x = v {operator} {number}\n").items())
        (_, before), (_, after) = found
        expected = np.array(before) * 2 if operator == "*" else np.array(before) / 2
        np.testing.assert_allclose(after, expected)


@pytest.mark.parametrize("number", ["Uniform([2, 4], [2, 5])[0]", "Uniform({'k': 2}, {'k': 2})['k']"])
def test_vectors_are_multiplied_by_what_is_a_number_when_it_is_drawn(number: str) -> None:
    text = f"n = {number}\nparam product = Vector(1, 2, 3) * n, quotient = Vector(2, 4, 6) / n\n"
    found = params(text)
    assert (tuple(found["product"]), tuple(found["quotient"])) == ((2, 4, 6), (1, 2, 3))


@pytest.mark.parametrize("condition", ["{v} < 3", "3 < {v}", "{v} >= {v}", "{v} > {o}", "1.5 <= {o}"])
@pytest.mark.parametrize("later", [False, True])
def test_vectors_and_orientations_have_no_order(condition: str, later: bool) -> None:
    """Neither among themselves nor beside numbers; the error is that of the requirement."""
    number = "Range(0, 1)" if later else "0.5"
    shown = condition.format(v="ego.position", o="ego.orientation")
    error = failure(f"ego = new Object at ({number}, 0), facing {number}\nrequire {shown}\n")
    assert isinstance(error, TypeError)
    assert place(error)[1].startswith("2:")


@pytest.mark.parametrize("part", ["n", "1", "True", "Uniform(True, False)", "Uniform(1, 2)"])
@pytest.mark.parametrize(
    "place_of", ["v.x", "v[0]", "v[-3]", "v.coordinates[0]", "(v + (0, 0, 0)).x", "(1 * v).x"]
)
def test_components_are_floats_whatever_they_were_made_of(part: str, place_of: str) -> None:
    text = f"n = DiscreteRange(1, 3)\nv = Vector({part}, n, 2)\nparam x = {place_of}, y = v.y\n"
    for found in scenario(text).sample(3, seed=1):
        assert type(found.params["x"]) is type(found.params["y"]) is float


@pytest.mark.parametrize(
    "later", ["Range({0}, {0})", "DiscreteRange({0}, {0})", "(({0} relative to north).yaw)", "{0}"]
)
@pytest.mark.parametrize("places", [(0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)])
def test_angles_of_orientations_are_known_sooner_or_later(places: tuple[int, ...], later: str) -> None:
    angles = [
        later.format(angle) if place in places else f"{angle}.0" for place, angle in enumerate((1, -1, 2))
    ]
    text = "north = VectorField('north', lambda point: 0)\n"
    text += f"ego = new Object facing 0.3, with turned Orientation.fromEuler({', '.join(angles)})\nparam x = ego.turned"
    assert_same_rotation(params(text)["x"], euler(1, -1, 2))


@pytest.mark.parametrize("facing", ["170 deg", "Range(170, 170) deg", "Uniform(170 deg, 170 deg)"])
@pytest.mark.parametrize(
    ("expression", "degrees"),
    [
        ("apparent heading of p", -20),
        ("apparent heading of q", 20),
        ("relative heading of p from q", -20),
        ("relative heading of q from p", 20),
        ("relative heading of q", 160),
        ("angle to p", -170),
        ("angle to q", 170),
        ("angle from q", -10),
        ("q.position.angleWith(p.position)", 20),
        ("p.position.angleWith(q.position)", -20),
    ],
)
def test_angles_between_directions_are_within_half_a_turn(
    expression: str, degrees: float, facing: str
) -> None:
    """Of `p`, South of the ego and a little to the East, and `q`, a little to the West, which face South or nearly so."""
    text = (
        "ego = new Object facing 30 deg, with allowCollisions True\n"
        f"p = new OrientedPoint at Vector(0, 5, 0).rotatedBy(-170 deg), facing {facing}\n"
        f"q = new OrientedPoint at Vector(0, 5, 0).rotatedBy(170 deg), facing -({facing})\n"
    )
    assert params(f"{text}param x = {expression}")["x"] == pytest.approx(math.radians(degrees))


@pytest.mark.parametrize("bad", ["0", "float('inf')", "-float('inf')", "float('nan')"])
@pytest.mark.parametrize("index", range(4))
def test_what_is_no_rotation_is_refused(bad: str, index: int) -> None:
    parts = ["0"] * 4 if bad == "0" else ["0.5"] * 4
    parts[index] = bad
    error = failure(f"param x = Orientation.fromQuaternion(({', '.join(parts)}))\n")
    assert "not a rotation" in str(error)


def test_rotations_are_those_of_scipy() -> None:
    """Of any length of their quaternion; as one of theirs and back."""
    turn = euler(2.5, -0.3, 0.2)
    quaternion = turn.as_quat()
    for found in (
        Orientation.fromQuaternion(quaternion),
        Orientation.fromQuaternion(quaternion * 3),
        Orientation.fromQuaternion(quaternion * -1e-3),
        Orientation(turn),
        Orientation.fromEuler(2.5, -0.3, 0.2),
    ):
        for same in (found, Orientation(found.r), Orientation(found.getRotation())):
            assert_same_rotation(same, turn)
            assert np.linalg.norm(same.q) == pytest.approx(1)
            assert same.q == (same.x, same.y, same.z, same.w)
            assert same.eulerAngles == (same.yaw, same.pitch, same.roll) == pytest.approx((2.5, -0.3, 0.2))
    drawn = params(
        "o = Orientation.fromEuler(Range(2.5, 2.5), -0.3, 0.2)\nparam o = o, q = o.q, e = o.eulerAngles"
    )
    assert drawn["q"] == pytest.approx(drawn["o"].q)
    assert drawn["e"] == pytest.approx((2.5, -0.3, 0.2))
    assert Orientation() == Orientation(None) == Orientation.fromEuler(0, 0, 0)
    for other in (0, "", (), quaternion):
        with pytest.raises(ScenicTypeError, match="rotation of SciPy"):
            Orientation(other)


@pytest.mark.parametrize("digits", ["", ", 0", ", 1", ", -1", ", None"])
def test_numbers_are_rounded_as_by_python(digits: str) -> None:
    """To an integer without a number of digits alone."""
    found = params(
        f"x = Range(10, 99)\nparam x = x, n = round(x{digits}), m = x.__round__({digits[2:]}), d = round(37.25{digits})\n"
    )
    for value, rounded in (("x", "n"), ("x", "m"), (37.25, "d")):
        expected = eval(f"round(x{digits})", {"x": found.get(value, value)})
        assert (found[rounded], type(found[rounded])) == (expected, type(expected))


@pytest.mark.parametrize("index", ["0", "2", "-1", "-3", "3", "-4", ":2", "1:", "::-1", "-1:", "True"])
@pytest.mark.parametrize("row", ["(1.0, 2.0, 3.0)", "(Range(1, 1), 2.0, 3.0)"])
def test_vectors_have_the_parts_of_triples(index: str, row: str) -> None:
    text = f"v = Vector(*{row})\nparam x = v[{index}]\n"
    if index in ("3", "-4"):
        assert isinstance(failure(text), IndexError)
    else:
        assert params(text)["x"] == eval(f"(1.0, 2.0, 3.0)[{index}]")


@pytest.mark.parametrize("value", ["'3'", "ego", "None", "[3]", "True and 'north'"])
def test_only_numbers_are_degrees(value: str) -> None:
    error = failure(f"ego = new Object\nparam x = ({value}) deg\n")
    assert isinstance(error, ScenicTypeError)
    assert "`deg`: expected a number or a vector, not" in str(error)
    assert place(error)[1].startswith("2:11-")


def test_what_is_left_out_is_the_ego_also_of_operands_that_are_drawn() -> None:
    """The ego as it is where the operator stands, not where its operand is drawn."""
    text = (
        "told = distributionFunction(lambda value, _: value)\nhidden = Range(0, 1)\n"
        "ego = new Object at (1, 2, 3), facing (0.4, 0.3, -0.2)\n"
        "box = new Object at (7, 2, 3), facing 0.5, with length 2\n"
        "b, D = told(box, hidden), told(CircularRegion((9, 2, 3), 2), hidden)\n"
        "drawn = [(apparent heading of b), (minimum distance to b), (distance to D), (distance past b),\n"
        "    (relative heading of b), (angle to b), (altitude to b), (relative position of b)]\n"
        "known = [(apparent heading of box), (minimum distance to box),\n"
        "    (distance to CircularRegion((9, 2, 3), 2)), (distance past box), (relative heading of box), (angle to box),\n"
        "    (altitude to box), (relative position of box)]\n"
        "ego = new Object at (-40, 30, 20), facing 2\n"
        "param drawn = drawn, known = known\n"
    )
    found = params(text)
    for drawn, known in zip(found["drawn"], found["known"], strict=True):
        assert drawn == known or drawn == pytest.approx(known)
    assert found["known"][2] == 6
    assert_angles_equal(found["known"][0], 0.5 + math.pi / 2)


VECTOR, NUMBER, HEADING = "a vector", "a number", "a heading"
ORIENTATION = "an orientation (a heading, Euler angles or an oriented point)"
WRONG_FORMS = {
    "known": "'a'",
    "chosen": "Uniform('a', 'a')",
    "drawn": "told('a', Range(0, 1))",
    "late": "DelayedArgument({'zeta'}, lambda thing: 'a')",
    "class": "OrientedPoint",
}
WANTED = {
    "new Object at «, with zeta 3": ("`at`", VECTOR),
    "new Object left of ego by «, with zeta 3": ("`left of ... by`", VECTOR),
    "new Object facing «, with zeta 3": ("`facing`", ORIENTATION),
    "new Object facing toward «, with zeta 3": ("`facing toward`", VECTOR),
    "new Object beyond ego by «, with zeta 3": ("`beyond ... by`", VECTOR),
    "new Object beyond ego by 3 from «, with zeta 3": ("`beyond ... from`", VECTOR),
    "new Object following F for «, with zeta 3": ("`following ... for`", NUMBER),
    "new Object following F from « for 3, with zeta 3": ("`following ... from`", VECTOR),
    "new Object offset by «, with zeta 3": ("`offset by`", VECTOR),
    "new Object offset along « by (1, 2), with zeta 3": ("`offset along`", ORIENTATION),
    "new Object offset along 3 by «, with zeta 3": ("`offset along ... by`", VECTOR),
    "new Object apparently facing «, with zeta 3": ("`apparently facing`", HEADING),
    "new Object with width «, with zeta 3": ("property 'width'", NUMBER),
    "new Object with position «, with zeta 3": ("property 'position'", VECTOR),
    "new Object with parentOrientation «, with zeta 3": ("property 'parentOrientation'", ORIENTATION),
    "« @ 3": ("`@`", NUMBER),
    "3 @ «": ("`@`", NUMBER),
    "angle to «": ("`angle to`", VECTOR),
    "angle from «": ("`angle from`", VECTOR),
    "altitude from ego to «": ("`altitude to`", VECTOR),
    "distance from « to ego": ("`distance from`", "a vector or a region"),
    "relative position of «": ("`relative position of`", VECTOR),
    "relative heading of «": ("`relative heading of`", HEADING),
    "relative heading of 3 from «": ("`relative heading of ... from`", HEADING),
    "apparent heading of ego from «": ("`apparent heading of ... from`", VECTOR),
    "apparent heading to «": ("`apparent heading to`", VECTOR),
    "distance past «": ("`distance past`", VECTOR),
    "F at «": ("`at`", VECTOR),
    "F[«]": ("field 'F'", VECTOR),
    "(follow F from « for 3)": ("`follow ... from`", VECTOR),
    "(follow F from ego for «)": ("`follow ... for`", NUMBER),
    "F.followFrom(«, 3)": ("`follow ... from`", VECTOR),
    "F.followFrom((1, 2), «)": ("`follow ... for`", NUMBER),
    "(1, 2) offset along « by (3, 4)": ("`offset along`", ORIENTATION),
    "(1, 2) offset along 3 by «": ("`offset along ... by`", VECTOR),
    "Vector(1, 2).dot(«)": ("", VECTOR),
    "Vector(1, 2).rotatedBy(«)": ("", ORIENTATION),
}


@each(WANTED, WRONG_FORMS)
def test_what_wants_an_operand_says_what_for(use: str, form: str) -> None:
    """Whether it is wrong at once or shows to be so only later; and a class is no instance of it."""
    what, wanted = WANTED[use]
    program = use.replace("«", WRONG_FORMS[form])
    if not use.startswith("new"):
        program = f"new Object with zeta 3, with tag ({program})"
    text = (
        "from scenic.core.lazy_eval import DelayedArgument\ntold = distributionFunction(lambda value, _: value)\n"
        f"F = VectorField('F', lambda p: p.x)\nego = new Object at (1, 2)\n{program}\n"
    )
    error = failure(text)
    shown = "the class OrientedPoint" if form == "class" else "'a' (str)"
    assert isinstance(error, ScenicTypeError)
    assert f"{what + ': ' if what else ''}expected {wanted}, not {shown}" in str(error)
    assert place(error)[1].startswith("5:")


@pytest.mark.parametrize("nested", [False, True])
def test_choices_within_choices_are_relative_each_in_its_way(nested: bool) -> None:
    inner = "Uniform(0.5, (0, 2))" if nested else "0.5, (0, 2)"
    text = f"p = new OrientedPoint at (1, 2), facing 0.5\nparam x = Uniform(0.25, {inner}) relative to p, y = p relative to Uniform(0.25, {inner})\n"
    for name in "xy":
        found = {
            value if isinstance(value, float) else tuple(round(part, 9) for part in value.position)
            for value in (item.params[name] for item in scenario(text).sample(30, seed=1))
        }
        ahead = (1 - 2 * math.sin(0.5), 2 + 2 * math.cos(0.5), 0)
        assert found == {0.75, 1.0, tuple(round(part, 9) for part in ahead)}


@pytest.mark.parametrize("number", ["37.256", "Range(37.256, 37.256)", "Uniform(37.256, 37.256)"])
@pytest.mark.parametrize("digits", ["2", "DiscreteRange(2, 2)", "Uniform(2, 2)", "-1", "Uniform(None, None)"])
def test_numbers_are_rounded_to_digits_that_are_drawn(number: str, digits: str) -> None:
    found = params(f"param x = round({number}, {digits})\n")["x"]
    expected = 40.0 if digits == "-1" else 37 if "None" in digits else 37.26
    assert (found, type(found)) == (expected, type(expected))


@pytest.mark.parametrize("row", ["(1, n)", "[1, n, 0]", "(1.0, n, 0)", "Vector(1, n)"])
@pytest.mark.parametrize("vector", ["Vector(1, 2)", "Vector(n - n + 1, 2)"])
@pytest.mark.parametrize("shown", ["{v} == {r}", "{r} == {v}", "not {v} != {r}", "not {r} != {v}"])
def test_vectors_are_compared_with_what_is_drawn_by_requirements_alone(
    vector: str, row: str, shown: str
) -> None:
    condition = shown.format(v=vector, r="r")
    text = f"n = DiscreteRange(1, 3)\nr = {row}\nparam n = n\n"
    assert isinstance(failure(f"{text}x = ({condition})\n"), RandomControlFlowError)
    assert {item.params["n"] for item in scenario(f"{text}require {condition}\n").sample(3)} == {2}


def test_vectors_are_arrays_of_the_type_that_is_asked_for() -> None:
    vector = Vector(1, 2, 3)
    for kind in (np.float64, np.float32, np.int64, np.complex128):
        for made in (np.array(vector, dtype=kind), np.asarray(vector, dtype=kind)):
            assert made.dtype == kind
            assert made.tolist() == [1, 2, 3]
    assert np.asarray(vector).dtype == np.float64
    copied = np.array(vector)
    copied[0] = 5
    assert vector == (1, 2, 3)


@pytest.mark.parametrize(
    "turn", [(0, 0, 0), (math.pi, 0, 0), (0, math.pi, 0), (0, 0, math.pi), (3, 1, -2), (1e-5, 0, 0)]
)
def test_an_orientation_and_its_opposite_quaternion_are_one(turn: tuple[float, float, float]) -> None:
    quaternion = euler(*turn).as_quat()
    one, same = Orientation.fromQuaternion(quaternion), Orientation.fromQuaternion(-quaternion)
    assert one == same
    assert hash(one) == hash(same)
    assert len({one, same}) == 1
    assert one.approxEq(same)
    assert same.approxEq(one)
    other = one * Orientation.fromEuler(0.001, 0, 0)
    assert other != one
    assert not one.approxEq(other)
    assert one.approxEq(other, tol=1e-3)
    assert not one.approxEq(same * Orientation.fromEuler(math.pi, 0, 0), tol=0.9)


@pytest.mark.parametrize("pair", ["(1, 2)", "(1.5, -2.5)", "(1, 2, 3)", "(1.5, -2.5, 3.5)"])
def test_arrays_of_two_or_three_numbers_are_vectors_as_tuples_are(pair: str) -> None:
    """Beside vectors that are drawn or definite, on either side, and as places."""
    text = (
        "import numpy\nego = new Object at (50, 50)\nx = Uniform(1.0, 1.0)\np = {}\nplaces = []\n"
        "for v in (Vector(x, 5, 0), Vector(1, 5, 0)):\n"
        "    places += [p relative to v, v relative to p, p offset by v, v offset by p, v + p, v - p, Vector(*p) + v,\n"
        "        p offset along 0.5 by v, v offset along 0.5 by p, relative position of p from v,\n"
        "        relative position of v from p, CircularRegion(p, 3).center, Uniform(CircularRegion(p, x)).center]\n"
        "near = new Object at p, facing toward p offset by v\n"
        "far = new Object at v offset by p, facing away from p, with allowCollisions True\n"
        "beyond = new Object beyond p by 7 from v, with allowCollisions True\n"
        "param numbers = [distance from p to v, distance from v to p, angle from p to v, angle from v to p,\n"
        "    altitude from v to p, p in CircularRegion((0, 0), 9), near.heading, far.heading, beyond.heading]\n"
        "param places = places + [near.position, far.position, beyond.position]\n"
    )
    found, expected = params(text.format(f"numpy.array({pair})")), params(text.format(pair))
    assert found["places"] == expected["places"]
    assert found["numbers"] == expected["numbers"]


@pytest.mark.parametrize(
    "array", ["numpy.zeros(4)", "numpy.zeros((3, 1))", "numpy.zeros((1, 3))", "numpy.zeros(1)"]
)
def test_other_arrays_are_no_vectors(array: str) -> None:
    for expression in (f"v relative to {array}", f"distance from v to {array}", f"new Object at {array}"):
        text = f"import numpy\nv = Vector(Range(0, 1), 5, 0)\nparam x = {expression}\n"
        assert isinstance(failure(text), ScenicTypeError)


def test_directions() -> None:
    turned, size = math.radians(30), 0.02
    directions = ("ahead of", "behind", "left of", "right of")
    degrees = [0, 0.005, 1, 89.98, 90, 90.02, 179, -0.005, -1, -89.98, -90, -90.02, -179]
    expected = [
        (abs(angle) < 89.99, abs(angle) > 90.01, 0.01 < angle < 180, -180 < angle < -0.01)
        for angle in degrees
    ]
    places = [
        (7 - size * math.sin(turned + math.radians(angle)), 8 + size * math.cos(turned + math.radians(angle)))
        for angle in degrees
    ]
    for spread in ("", " + (Range(0, 0), 0)"):
        found = params(
            "ego = new Object at (7, 8), facing 30 deg\nparam found = ["
            + ", ".join(
                f"[{', '.join(f'(Vector({x!r}, {y!r}, 3){spread} {words} ego)' for words in directions)}]"
                for x, y in places
            )
            + "]\n"
        )["found"]
        assert [tuple(map(bool, row)) for row in found] == expected


def test_straight_behind_is_neither_left_nor_right() -> None:
    text = "ego = new Object\nparam p = [(0, -2) left of ego, (0, -2) right of ego, (0, -2) behind ego]"
    assert params(f"{text}, q = apparent heading to (0, -2)") == {"p": [False, False, True], "q": math.pi}


def test_requirements_narrow_by_direction() -> None:
    text = "ego = new Object\na = new Object at (Range(-5, 5), Range(-5, 5))\n"
    scenes = scenario(text + "require a left of ego\nrequire a ahead of ego").sample(50, seed=1)
    assert all(scene.objects[1].x < 0 < scene.objects[1].y for scene in scenes)
