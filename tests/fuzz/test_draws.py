"""Sources of decisions: the same numbers, wherever they come from."""

from hypothesis import HealthCheck, find, settings
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from fuzz.draws import HypothesisDraws, RandomDraws


def test_numbers_lie_below_the_bound_and_are_noted():
    draws = RandomDraws(1)
    numbers = [draws.number(below) for below in (1, 2, 3, 100)]
    assert all(0 <= number < below for number, below in zip(numbers, (1, 2, 3, 100), strict=True))
    # Where there is no choice, none is noted.
    assert draws.choices == numbers[1:]
    draws.pick(5)
    assert draws.choices == numbers[1:]
    draws.extend([7])
    assert draws.choices[-1] == 7


def test_the_same_seed_gives_the_same_numbers():
    assert [RandomDraws(3).number(1000) for _ in range(2)] == [RandomDraws(3).number(1000)] * 2
    assert RandomDraws(3).number(10**6) != RandomDraws(4).number(10**6)


def test_hypothesis_shrinks_numbers_and_parts():
    @st.composite
    def pair(draw: DrawFn) -> tuple[int, str]:
        draws = HypothesisDraws(draw)
        return draws.number(1000), draws.part(lambda rule: f"{rule}{draws.number(1)}{draws.number(50)}", "r")

    found = find(
        pair(),
        lambda drawn: drawn[0] > 17 and drawn[1] != "r00",
        settings=settings(database=None, derandomize=True, suppress_health_check=list(HealthCheck)),
    )
    assert found == (18, "r01")
