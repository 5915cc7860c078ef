"""An estimate: the runs so far, what is asked of them, and the probability that follows, with its interval."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import Any, Final, Literal

from scenic.dataclass import dataclass
from scenic.estimation.branching import Rare
from scenic.estimation.importance_sampling import Weighted
from scenic.formats.json_lines import real
from scenic.statistics.comparisons import PairedComparison
from scenic.statistics.confidence_intervals import Interval, exact_interval
from scenic.statistics.confidence_sequences import sequence_interval
from scenic.statistics.sequential_test import BoundTest

__all__ = ["Asked", "Estimate", "Method", "Tally", "requirement_tallies"]

Method = Literal["fixed number", "precision", "bound", "splitting", "importance sampling"]

VIOLATED: Final = "counterexample"
"""Status of a run in which the requirement was violated."""


@dataclass(frozen=True, slots=True)
class Asked:
    """A question that runs are to answer; their rows do not depend on it.

    Attributes:
        method: how the probability is estimated.
        confidence: chance of an interval to contain its probability, between 0 and 1.
        runs: number of runs: all of them where it is fixed, else at most; ``None`` for no limit.
        precision: half the width of the interval at which there are enough runs.
        test: of a bound.

    """

    method: Method = "fixed number"
    confidence: float = 0.95
    runs: int | None = 1000
    precision: float | None = None
    test: BoundTest | None = None

    def to_data(self) -> dict[str, Any]:
        """Return the same as plain data."""
        test = self.test
        bound = None if test is None else [test.bound, test.good, test.confidence, test.power]
        return {
            "method": self.method,
            "confidence": self.confidence,
            "runs": self.runs,
            "precision": self.precision,
            "bound": bound,
        }

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> "Asked":
        """Read the data of `to_data`."""
        bound = data["bound"]
        test = None if bound is None else BoundTest(*bound)
        return cls(data["method"], data["confidence"], data["runs"], data["precision"], test)


@dataclass(slots=True)
class Tally:
    """Counts of runs for one requirement, or for all that are asked about.

    Attributes:
        label: of the requirement; empty for all.
        line: of the requirement, where it is known.
        runs: runs of the program's law, those without an outcome included.
        violations: runs in which it was violated.
        unknown: runs without an outcome, for they failed.
        rejected: numbers without a run: no scene was found, or the simulation was rejected.
        unmet: violations that are only presumable: it was not met when the simulation ended.
        presumable: runs in which it held as far as the simulation went.
        unseen: runs that never evaluated it.
        flat: runs with an infinite robustness.

    """

    label: str = ""
    runs: int = 0
    violations: int = 0
    unknown: int = 0
    rejected: int = 0
    unmet: int = 0
    presumable: int = 0
    unseen: int = 0
    flat: int = 0

    @property
    def share(self) -> float:
        """Violations among the runs with an outcome; NaN without any."""
        known = self.runs - self.unknown
        return self.violations / known if known else math.nan

    def add(self, row: Mapping[str, Any]) -> None:
        """Count a run for all requirements that are asked about."""
        status = row["status"]
        if status == "rejected":
            self.rejected += 1
            return
        self.runs += 1
        if status == "failed":
            self.unknown += 1
            return
        self.violations += status == VIOLATED
        self.flat += math.isinf(min(map(float, row["values"])))

    def add_outcome(self, row: Mapping[str, Any]) -> None:
        """Count a run for this requirement alone."""
        status = row["status"]
        if status in ("rejected", "failed"):
            self.add(row)
            return
        self.runs += 1
        outcome = row.get("requirements", {}).get(self.label)
        if outcome is None or outcome["verdict"] is None:
            self.unseen += 1
            return
        verdict = outcome["verdict"]
        self.violations += verdict in ("FALSE", "PRESUMABLY_FALSE")
        self.unmet += verdict == "PRESUMABLY_FALSE"
        self.presumable += verdict == "PRESUMABLY_TRUE"
        self.flat += outcome["robustness"] is not None and math.isinf(real(outcome["robustness"]))

    def interval(self, confidence: float, *, at_any_time: bool) -> Interval:
        """Return the interval of the probability; ``at_any_time`` where the number of runs was not fixed in advance."""
        if self.runs == 0:
            return Interval(0.0, 1.0)
        method = sequence_interval if at_any_time else exact_interval
        return method(self.violations, self.runs, confidence, unknown=self.unknown)


def requirement_tallies(rows: Sequence[Mapping[str, Any]], labels: Sequence[str]) -> list[Tally]:
    """Counts for each requirement; of all that occur where ``labels`` names none."""
    names = list(labels)
    if not names:
        names = list(dict.fromkeys(name for row in rows for name in row.get("requirements", ())))
    tallies = [Tally(name) for name in names]
    for tally in tallies:
        for row in rows:
            tally.add_outcome(row)
    return tallies


@dataclass(slots=True)
class Estimate:
    """The probability that a run violates what is required, so far as the runs tell.

    Attributes:
        asked: what is asked of the runs.
        rows: one mapping for each run, as `FalsificationResult.rows`; without ``point`` and ``numbers``.
        seed: of the runs.
        total: their counts.
        requirements: counts for each requirement.
        at_any_time: whether the interval is one of a sequence that holds at all times, rather than one for a fixed number of runs.
        is_finished: whether what is asked is answered.
        folder: where the runs are kept.
        is_static: whether runs are scenes alone.
        is_repeatable: whether a run that was made again was the same; ``None`` if none was.
        rare: the outcome of a splitting; without enough repetitions its first runs are used as plain ones.
        weighted: the outcome of importance sampling.
        answer: of a bound: whether the probability is at most that; ``None`` while it is not known.
        stop_reason: why there are no more runs, in words.
        other: the estimate of another program with the same runs.

    """

    asked: Asked
    rows: list[dict[str, Any]]
    seed: int
    total: Tally
    requirements: list[Tally] = field(default_factory=list)
    at_any_time: bool = False
    is_finished: bool = True
    folder: Path | None = None
    is_static: bool = False
    is_repeatable: bool | None = None
    rare: Rare | None = None
    weighted: Weighted | None = None
    answer: bool | None = None
    stop_reason: str = ""
    other: "Estimate | None" = None

    @property
    def runs(self) -> int:
        """Number of runs; of a splitting also those that moves have made."""
        return self.total.runs if self.rare is None else len(self.rows)

    @property
    def violations(self) -> int:
        """Number of counterexamples among them."""
        return sum(row["status"] == VIOLATED for row in self.rows)

    @property
    def probability(self) -> float:
        """The estimate; NaN where nothing is known."""
        if self.rare is not None and self.rare.is_known:
            return self.rare.probability
        return self.total.share if self.weighted is None else self.weighted.probability

    @property
    def confidence(self) -> float:
        """Chance of the interval to contain the probability."""
        return self.asked.confidence

    @property
    def interval(self) -> Interval:
        """The interval of the probability."""
        if self.rare is not None and self.rare.is_known:
            return self.rare.interval(self.confidence)
        if self.weighted is not None:
            return self.weighted.interval(self.confidence)
        return self.total.interval(self.confidence, at_any_time=self.at_any_time)

    @property
    def comparison(self) -> PairedComparison | None:
        """The comparison with the other program: of all runs that have an outcome in both."""
        if self.other is None:
            return None
        theirs = {
            row["run"]: row["status"] == VIOLATED for row in self.other.rows if row["values"] is not None
        }
        pairs = [
            (row["status"] == VIOLATED, theirs[row["run"]])
            for row in self.rows
            if row["values"] is not None and row["run"] in theirs
        ]
        return PairedComparison(len(pairs), pairs.count((True, False)), pairs.count((False, True)))

    @property
    def method(self) -> Method:
        """The way in which the probability is estimated."""
        return self.asked.method
