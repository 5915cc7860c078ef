"""Conversions and functions of numbers: with all their arguments, and of numbers only."""

import pytest

from tests.runtime.programs import draws, failure, params, place, scenario

CONVERSIONS = [
    ("int(Uniform('10', '10'), 16)", 16),
    ("int('12', DiscreteRange(8, 8))", 10),
    ("float(Uniform('1.5', '1.5'))", 1.5),
    ("int(Range(2.5, 2.6))", 2),
    ("str(Uniform(Vector(1, 2, 3), Vector(1, 2, 3)))", "Vector(1, 2, 3)"),
    ("str((DiscreteRange(4, 4), 2))", "(4, 2)"),
    ("str(b'ab', 'ascii')", "ab"),
]


@pytest.mark.parametrize(("expression", "expected"), CONVERSIONS)
def test_a_conversion_takes_all_that_it_is_given(expression: str, expected: object) -> None:
    assert params(f"param x = {expression}")["x"] == expected


VECTORS = ["Vector(1, 2, 3)", "Uniform(Vector(1, 2, 3), Vector(2, 3, 4))", "Vector(Range(0, 1), 2, 3)"]
TURNS = ["Orientation.fromEuler(1, 2, 3)", "Orientation.fromEuler(Range(0, 1), 2, 3)"]


@pytest.mark.parametrize("value", VECTORS + TURNS)
@pytest.mark.parametrize("function", ["sin", "cos", "tan", "hypot", "float", "int"])
def test_vectors_are_no_numbers(function: str, value: str) -> None:
    error = failure(f"y = {value}\nparam x = {function}(y)")
    assert isinstance(error, TypeError)
    assert place(error)[1].startswith("2:")


def test_what_waits_for_an_object_is_a_number_or_not_when_it_is_there() -> None:
    program = "flow = VectorField('flow', lambda p: p.x)\nnew Object at (0.25, 2), with x {}(flow relative to 0.5){}"
    assert place(failure(program.format("hypot(", ", 3)")))[0] == "SC404"


def test_floats_become_the_integers_that_they_are() -> None:
    """Also those above 2**53, to which no fraction is left, up to where integers of 64 bits end."""
    text = "x = Range(2.0**52, 2.0**61)\ny = -x\nparam p = (x, int(x), round(x), int(y), round(y), x // 1, int(x / 2**40))\n"
    for x, *found in draws(text.replace("p =", "x ="), n=20):
        assert found == [int(x), round(x), -int(x), -round(x), x // 1, int(x / 2**40)]


def test_integers_beyond_all_of_the_machine_stay_what_they_are() -> None:
    """On either side, definite and drawn."""
    for number in (10**30, -(10**30), 2**63, -(2**63), 2**63 - 1, -(2**63) - 1):
        text = f"a = Uniform({number}, {number})\nparam x = (a, a + 1, -a, Uniform({number}, 1), {number})\n"
        for found, more, less, either, own in draws(text, n=3):
            assert (found, more, less, own) == (number, number + 1, -number, number)
            assert either in (number, 1)


NUMPY_NUMBERS = [
    *((name, 2.5) for name in ("float16", "float32", "float64")),
    *((name, 3) for name in ("int8", "uint8", "int32", "uint64")),
    ("bool_", True),
]


@pytest.mark.parametrize(("name", "value"), NUMPY_NUMBERS)
def test_numbers_of_numpy_are_the_numbers_of_python_to_what_is_drawn(name: str, value: float) -> None:
    """By type, too: a small float widens to Python's, an integer stays one and does not wrap around."""
    program = (
        "import numpy\nn = {}\ns, i = Uniform(3.0, 3.0), Uniform(300, 300)\n"
        "x = Range(0, n)\nchosen = Uniform(n, n)\nv = Vector(s, n, 0)\n"
        "param x = [x, x + n, DiscreteRange(0, n), s + n, n - s, i * n, i / n, i // n, i % n, 2 ** chosen, -chosen, abs(chosen),\n"
        "    v.y, v * n, n * v, v / n, max(s, n), Uniform('a', 'a') * int(n), Uniform(n), Uniform((s, n), (n, n))[1] + 0,\n"
        "    Orientation.fromEuler(s, n, n).pitch, (n @ s).x]\n"
    )
    found = params(program.format(f"numpy.{name}({value})"))["x"]
    expected = params(program.format(value))["x"]
    assert found == expected
    assert [type(part) for part in found] == [type(part) for part in expected]


def test_numbers_of_numpy_are_known_before_anything_is_drawn() -> None:
    for number in ("numpy.float32(0.5)", "numpy.int16(1)", "numpy.bool_(True)"):
        text = f"import numpy\nx = Range(0, {number})\nrequire x > 2\n"
        assert "the requirements cannot hold together" in str(failure(text))


@pytest.mark.parametrize("kind", ["float16", "float32", "float64", "int8", "int64", "uint16"])
def test_numbers_of_numpy_of_every_width_are_numbers(kind: str) -> None:
    """As sizes, coordinates, headings and in arithmetic, whether something random stands beside them or not."""
    text = (
        f"import numpy as np\nn = np.array([2], dtype=np.{kind})[0]\nx = Range(1, 1)\n"
        "ego = new Object at (n, n * x), facing n, with width n, with length n * x\nparam x = (n @ n, n + x, max(n, x), round(n))"
    )
    (only,) = scenario(text).sample(1, seed=0)
    ego = only.egoObject
    assert (ego.x, ego.y, ego.width, ego.length) == (2, 2, 2, 2)
    assert ego.heading == pytest.approx(2)
    assert only.params["x"] == ((2, 2, 0), 3, 2, 2)
