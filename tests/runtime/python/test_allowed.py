"""Relations that a program declares by the combinations for which they hold."""

import pytest

from scenic import allowed, bounded
from scenic.language.errors import InvalidScenarioError
from tests.runtime.programs import scenario

PROGRAM = """
from scenic import allowed
def ask(a, b):
    raise RuntimeError("never asked")
fits = allowed(ask, [(i, (7 * i) % 40) for i in range(40)])
x, y, z = DiscreteRange(0, 39), DiscreteRange(0, 39), DiscreteRange(0, 39)
"""


def test_a_relation_holds_for_its_combinations_alone() -> None:
    def follows(ahead: str, behind: str) -> bool:
        """The first may follow the second."""
        raise AssertionError

    relation = allowed(follows, [("bus", "car"), ["car", "car"]])
    assert relation("bus", "car")
    assert relation("car", "car")
    assert not relation("car", "bus")
    assert relation.__name__ == "follows"
    assert relation.__doc__ == "The first may follow the second."


def test_requirements_that_ask_a_relation_are_decided() -> None:
    program = scenario(f"{PROGRAM}require fits(x, y)\nrequire fits(y, z)\nparam v = (x, y, z)\n")
    for scene in program.sample(20, seed=1):
        x, y, z = scene.params["v"]
        assert (y, z) == (7 * x % 40, 49 * x % 40)
        assert scene.attempts == 1


def test_a_relation_of_random_values_is_random() -> None:
    program = scenario(f"{PROGRAM}either = fits(x, y)\nparam v = (x, y, either)\n")
    rows = [scene.params["v"] for scene in program.sample(200, seed=1)]
    assert all(either == (y == 7 * x % 40) for x, y, either in rows)
    assert any(either for *_, either in rows)


@pytest.mark.parametrize("combinations", [[(1, 2), (1,)], [([1], 2)], [3], "ab", [(1, 2)], [()]])
def test_combinations_that_cannot_be_looked_up_are_refused(combinations: list[object]) -> None:
    with pytest.raises(InvalidScenarioError, match="the combinations that are allowed"):
        allowed(lambda x: x, combinations)  # type: ignore[arg-type] # that is the fault


def test_what_is_no_function_is_refused() -> None:
    with pytest.raises(InvalidScenarioError, match="declared of a function, not of 3"):
        allowed(3, [(1, 2)])  # type: ignore[arg-type]
    with pytest.raises(InvalidScenarioError, match="marks a function or a class of regions, not 3"):
        bounded(lambda x: x)(3)  # type: ignore[type-var]


def test_a_relation_asked_about_another_number_of_values_is_refused_where_it_is_asked() -> None:
    with pytest.raises(
        InvalidScenarioError, match="of ask have 2 values, but it is asked about 3 values"
    ) as caught:
        scenario(f"{PROGRAM}require fits(x, y, z)\n").sample(1, seed=1)
    assert caught.value.span is not None
    assert caught.value.span.line == 7
    assert caught.value.help is not None
    with pytest.raises(InvalidScenarioError, match="asked about 1 value"):
        scenario(f"{PROGRAM}one = fits(x)\n")
    everything_goes = allowed(max, [(1, 2)])
    assert everything_goes(1, 2)
    assert not allowed(max, [])(1)
