"""Rounds of typed programs: some outcomes, and at most one failure, shrunk."""

import traceback
from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Final

from hypothesis import HealthCheck, Phase, given, seed, settings

from fuzz.limits import SECONDS, TookTooLongError, limited
from fuzz.semantics.programs import Program, programs
from fuzz.semantics.properties import PROPERTIES, Run

__all__ = ["ROUND", "Report", "run_round"]

ROUND: Final = 100
"""Programs that one round makes."""


@dataclass
class Report:
    """The findings of a round: outcomes by stage and code, and each failure with its smallest program."""

    outcomes: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)

    def add(self, other: "Report") -> None:
        """Takes in what another round found."""
        self.outcomes += other.outcomes
        self.failures += other.failures


def run_round(seed_of_round: int, count: int = ROUND, names: Collection[str] | None = None) -> Report:
    """Runs ``count`` programs of a seed through the named properties, or all; the first failure ends the round, and is shrunk."""
    report = Report()
    failures: list[tuple[str, str, str]] = []

    @seed(seed_of_round)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=(Phase.generate, Phase.shrink),
        report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
    )
    @given(programs())
    def attempt(program: Program) -> None:
        run = Run(program)
        for name in PROPERTIES if names is None else names:
            try:
                with limited(SECONDS):
                    PROPERTIES[name](run)
            except (Exception, TookTooLongError) as error:
                failures.append((name, program.text, _reason(error)))
                raise AssertionError(name) from error
        if not failures:
            report.outcomes[f"{run.outcome.stage} {run.outcome.code}".strip()] += 1

    try:
        attempt()
    except AssertionError:
        name, text, reason = failures[-1]  # The last that was tried is the smallest.
        report.failures.append(f"FAILED {name} (seed {seed_of_round})\n{text}{reason}\n")
    return report


def _reason(error: BaseException) -> str:
    cause = error.__cause__ or error
    last = traceback.extract_tb(cause.__traceback__)[-1]
    return f"{type(error).__name__}: {error} ({last.filename.rpartition('scenic/')[2]}:{last.lineno})"
