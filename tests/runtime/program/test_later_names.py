"""Conditions about names that the program defines after them."""

import pytest

from runtime.programs import draws, failure, scenario, scene
from scenic.language.errors import UndefinedNameError
from scenic.simulators.kinematic import KinematicSimulator


def test_a_requirement_reads_a_number_that_is_drawn_later():
    found = draws("require x > 5\nx = Range(0, 10)\nparam x = x", n=40)
    assert min(found) > 5
    assert max(found) > 8


def test_the_requirement_is_understood_by_analysis():
    """It is a condition on the draw, as one after the definition is: almost no candidate is rejected."""
    made = scenario("require x > 9.9\nx = Range(0, 10)\nparam x = x")
    assert sum(each.attempts for each in made.sample(20, seed=1)) < 40


def test_negations_functions_and_comprehensions():
    text = (
        "ego = new Object at (Range(0, 10), 0)\n"
        "require far(ego)\n"
        "require not (x > 3 or 0 in [t for t in things if t > 3])\n"
        "def far(thing):\n    return thing.position.x > limit\n"
        "things, x, limit = [Range(0, 4), 0], Range(2, 5), Range(2, 3)\n"
        "param x = (ego.position.x, x, limit)"
    )
    for place, x, limit in draws(text, n=20):
        assert place > limit
        assert x <= 3


def test_functions_may_read_names_that_are_set_later():
    text = "def f():\n    return k > 1 and g()\nrequire f()\nk = Range(0, 2)\ndef g():\n    return k < limit\nlimit = 1.5\nparam x = k"
    found = draws(text, n=20)
    assert min(found) > 1
    assert max(found) < 1.5


def test_an_object_that_is_made_later_is_seen_mutated():
    text = (
        "ego = new Object at (0, 0)\n"
        "require (distance from ego to other) > 7\n"
        "other = new Object at (6, 0)\nmutate other by 2\n"
    )
    for each in scenario(text).sample(10, seed=1):
        assert each.objects[1].position.norm() > 7


def test_names_keep_the_value_that_they_have_at_the_statement():
    found = draws("x = Range(0, 1)\nrequire x < y\ny = 0.5\nx = Range(5, 6)\nparam x = x", n=10)
    assert min(found) >= 5


def test_of_several_later_values_the_last_counts():
    assert set(draws("require y < 3\ny = 7\ny = 2\nparam x = y", n=3)) == {2}


def test_simulations_record_and_end_by_later_names():
    text = "ego = new Object at (0, 0)\nrecord x as seen\nterminate when y > 3\nx, y = 5, 4\n"
    done = KinematicSimulator().simulate(scene(text), maxSteps=5)
    assert done.result.records["seen"] == [(0, 5)]


@pytest.mark.parametrize("statement", ["require x > 3", "require not x", "record x"])
def test_a_name_that_is_never_set_is_an_error(statement):
    assert isinstance(failure(f"ego = new Object\n{statement}\n"), UndefinedNameError)
