"""Results in words: each case that could mislead has its sentence, and no probability comes without its interval."""

import re
from typing import Any

import numpy as np
import pytest
from scenic.core.vectors import Vector

import scenic
from scenic.estimation.estimate import Asked, Estimate, Tally, requirement_tallies
from scenic.estimation.estimate_page import estimate_page
from scenic.estimation.sentences import comparison_words, headline, notes
from scenic.simulators.kinematic import KinematicSimulation, KinematicSimulator
from tests.estimation.test_estimating import BRAKE, braking


def rows_with(*verdicts: str | None) -> list[dict[str, Any]]:
    return [
        {
            "run": run,
            "status": "counterexample" if verdict in ("FALSE", "PRESUMABLY_FALSE") else "held",
            "values": [1.0],
            "requirements": {} if verdict is None else {"safe": {"verdict": verdict, "robustness": 1.0}},
        }
        for run, verdict in enumerate(verdicts)
    ]


def made(rows: list[dict[str, Any]], **options: Any) -> Estimate:
    total = Tally()
    for row in rows:
        total.add(row)
    asked = options.pop("asked", Asked(runs=len(rows)))
    return Estimate(asked, rows, 1, total, requirement_tallies(rows, ["safe"]), **options)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (
            rows_with(*["TRUE"] * 5, *["FALSE"] * 3),
            "8 runs are too few to say much: the probability may be anything from",
        ),
        (rows_with(*["TRUE"] * 100), "fewer than one run in 33 is one"),
        (rows_with(*["FALSE"] * 100), "more than 97% of all runs"),
        (rows_with(*[None] * 40), "`safe` was never evaluated"),
        (
            rows_with(*[None] * 10, *["TRUE"] * 30),
            "not evaluated in 10 of 40 runs; these count as runs in which it held",
        ),
        (rows_with(*["PRESUMABLY_TRUE"] * 40), "never decided for good"),
        (rows_with(*["PRESUMABLY_TRUE"] * 40, "FALSE"), "In 40 runs `safe` held until the simulation ended"),
        (
            rows_with(*["PRESUMABLY_FALSE"] * 2, *["TRUE"] * 40),
            "In 2 runs `safe` was not met when the simulation ended",
        ),
        ([{"run": 0, "status": "rejected", "values": None}] * 3, "nothing is known of the probability"),
        ([{"run": 0, "status": "failed", "values": None}] * 3, "nothing is known of the probability"),
        (
            [*rows_with(*["TRUE"] * 40), {"status": "failed", "values": None}],
            "1 run failed and has no outcome",
        ),
        ([*rows_with(*["TRUE"] * 40), {"status": "rejected", "values": None}], "1 of 41 numbers gave no run"),
    ],
)
def test_what_is_said(rows: list[dict[str, Any]], words: str) -> None:
    result = made(rows)
    assert any(words in note for note in notes(result)), notes(result)
    assert re.search(r"\(95% interval [\d.e-]+ to [\d.e-]+\)", headline(result)[1])
    assert "probability" in estimate_page({"": result}, "p")


def test_an_early_end_is_told() -> None:
    rows = rows_with(*["TRUE"] * 40)
    early = made(
        rows,
        is_finished=False,
        at_any_time=True,
        asked=Asked(runs=100),
        stop_reason="the time limit was reached",
    )
    assert notes(early)[0].startswith("Only 40 of 100 runs are made: the time limit was reached.")
    coarse = made(rows, is_finished=False, at_any_time=True, asked=Asked("precision", 0.95, 40, 0.001))
    assert "The precision of 0.001 is not reached" in notes(coarse)[0]
    assert "plus or minus 0.0" in notes(coarse)[0]


class NoisySimulation(KinematicSimulation):
    """A simulation that is noisy."""

    def createObjectInSimulator(self, obj: Any) -> None:
        """Shift the object by a random number of no seed."""
        obj.position = obj.position + Vector(0, np.random.default_rng().uniform(0, 1), 0)
        super().createObjectInSimulator(obj)


class Noisy(KinematicSimulator):
    """A simulator with random numbers of its own."""

    def createSimulation(self, scene: Any, **options: Any) -> Any:
        """A simulation that has run."""
        return NoisySimulation(scene, **options)


def test_random_numbers_of_a_controller_are_told() -> None:
    result = scenic.estimate(
        scenic.scenarioFromString(BRAKE), Noisy(), n=3, seed=1, timestep=0.1, max_steps=5
    )
    assert result.is_repeatable is False
    assert any("draws random numbers of its own" in note for note in notes(result))
    assert braking(n=3).is_repeatable is True


def test_two_programs_are_compared_by_equal_runs() -> None:
    worse = scenic.scenarioFromString(BRAKE.replace("< 12", "< 10"))
    result = braking(n=60, against=worse, requirement="keeps_distance")
    pairs = result.comparison
    assert pairs is not None
    assert result.other is not None
    assert pairs.pairs == 60
    assert result.violations - result.other.violations == pairs.first_only - pairs.second_only < 0
    assert pairs.first_only == 0  # equal runs: whoever brakes earlier hits in fewer of the same
    (words,) = comparison_words(result)
    assert "interval" in words
    assert "McNemar" in words
    assert ("by chance" in words) == (pairs.p_value < 0.05)


def test_settings_are_drawn_side_by_side() -> None:
    results = {name: made(rows_with(*["FALSE"] * 4, *["TRUE"] * 30)) for name in ("n=1", "n=2")}
    page = estimate_page(results, "p")
    assert page.count("with its interval of 95%") == 1
    assert page.count("<td>n=1</td>") == 1
    assert "<code>safe</code>" in estimate_page({"": made(rows_with(*[None] * 40))}, "p")
