"""Functions of operators and specifiers under their established names, as every program sees them."""

import math

import pytest

from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS
from tests.runtime.programs import scene, thing

PLACES = "ego = new Object facing 30 deg\nother = new Object at (3, 4), facing 90 deg\n"


@pytest.mark.parametrize(
    ("call", "value"),
    [
        ("RelativeHeading(other)", math.radians(60)),
        ("DistanceFrom(other)", 5),
        ("DistanceFrom((3, 0), (0, 4))", 5),
        ("AngleTo((1, 1))", math.radians(-45)),
        ("Front(other).y", 4),
        ("RelativePosition((4, 4), (1, 2)).x", 3),
    ],
)
def test_they_do_what_the_operators_do(call: str, value: float) -> None:
    params = scene(f"{PLACES}param value = {call}\n").params
    assert params["value"] == pytest.approx(value)


def test_they_take_random_operands() -> None:
    params = scene("ego = new Object\nx = Range(2, 3)\nparam near = DistanceFrom((x, 0)), x = x\n").params
    assert params["near"] == pytest.approx(params["x"])


def test_requirements_may_call_them() -> None:
    ego = thing("ego = new Object at (Range(-1, 1), 0)\nrequire DistanceFrom((5, 0)) < 4.5\n")
    assert ego.position.x > 0.5


def test_functions_of_the_program_may_call_them() -> None:
    text = "ego = new Object at (Range(-1, 1), 0)\ndef near(): return DistanceFrom((5, 0)) < 4.5\nrequire near()\n"
    assert thing(text).position.x > 0.5


def test_a_definition_of_the_program_wins() -> None:
    text = "ego = new Object\nbehavior Follow():\n    wait\nNext = 3\nparam value = Next, kind = Follow.__name__\n"
    params = scene(text).params
    assert (params["value"], params["kind"]) == (3, "Follow")


def test_scenarios_have_a_common_base() -> None:
    text = "scenario Main():\n    setup:\n        ego = new Object\n        param value = issubclass(Main, DynamicScenario)\n"
    assert scene(text).params["value"] is True


def test_every_declared_function_is_in_scope() -> None:
    names = [
        function.name for each in (*OPERATORS.values(), *SPECIFIERS.values()) for function in each.functions
    ] + ["With"]
    assert (
        scene(f"ego = new Object\nparam value = [f.__name__ for f in ({', '.join(names)})]\n").params["value"]
        == names
    )
