"""The question that the runs of an estimate are to answer, from single options."""

from typing import Final

from scenic.estimation.estimate import Asked
from scenic.estimation.goals import EstimateError
from scenic.runtime.ground.arguments import whole_number
from scenic.statistics.sequential_test import BoundTest

__all__ = ["asked_of"]

_RUNS: Final = 1000
_BUDGET: Final = 10_000


def asked_of(
    *,
    runs: int | None = None,
    budget: int | None = None,
    confidence: float = 0.95,
    precision: float | None = None,
    at_most: float | None = None,
    good: float | None = None,
    power: float = 0.9,
    rare: bool = False,
    follows: bool = False,
    together: int = 1,
) -> Asked:
    """Make a question of single options; raises `EstimateError` for values that are not allowed or contradict each other.

    The intervals and tests of so many estimates hold ``together`` with the confidence: each gets its share of the chance to miss
    (Bonferroni).
    """
    runs = None if runs is None else whole_number(runs, "n", 1)
    budget = None if budget is None else whole_number(budget, "budget", 1)
    _check_shares(confidence=confidence, precision=precision, bound=at_most, good=good, power=power)
    ways = {
        "a precision": precision is not None,
        "a bound": at_most is not None,
        "rare": rare,
        "a search to follow": follows,
    }
    method_names = [name for name, is_given in ways.items() if is_given]
    if len(method_names) > 1:
        raise EstimateError(
            f"{method_names[0]} and {method_names[1]} contradict each other: each is a way to estimate",
            help="give one of them",
        )
    has_budget = bool(method_names) and not follows
    if runs is not None and has_budget:
        raise EstimateError(
            f"a number of runs contradicts {method_names[0]}, which takes as many as it needs",
            help="limit them by a budget, or leave the number away",
        )
    if budget is not None and not has_budget:
        raise EstimateError(
            "a budget goes with a precision, a bound, or rare failures",
            help="here the number of runs is fixed: `n`, -n",
        )
    if good is not None and at_most is None:
        raise EstimateError("a good probability belongs to a bound", help="name the bound: --at-most P")
    confidence = 1 - (1 - confidence) / together
    if rare:
        return Asked("splitting", confidence, _BUDGET if budget is None else budget)
    if precision is not None:
        return Asked("precision", confidence, budget, precision)
    if at_most is not None:
        return Asked("bound", confidence, budget, test=_test(at_most, good, confidence, power))
    return Asked(
        "importance sampling" if follows else "fixed number", confidence, _RUNS if runs is None else runs
    )


def _test(bound: float, good: float | None, confidence: float, power: float) -> BoundTest:
    better = bound / 2 if good is None else good
    if better >= bound:
        raise EstimateError(
            f"the good probability {better:g} is not below the bound {bound:g}",
            help="the test tells one from the other: the closer they are, the more runs it needs",
        )
    return BoundTest(bound, better, confidence, power)


def _check_shares(**shares: float | None) -> None:
    for name, value in shares.items():
        if value is not None and not 0 < value < 1:
            words = "good probability" if name == "good" else name
            raise EstimateError(
                f"the {words} {value:g} is not between 0 and 1",
                help="write a probability, such as 0.01 or 1e-3",
            )
