"""Estimates of rare failures: runs that a splitting asks for, made by moves, or read from a folder."""

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any, Final

import numpy as np

from scenic.batch.engines import BatchEngine
from scenic.dataclass import dataclass
from scenic.falsification.evaluating import Evaluation, evaluated
from scenic.falsification.lineages import Ancestry, Lineage, LineageStep
from scenic.statistics.confidence_intervals import Interval
from scenic.statistics.splitting import (
    Move,
    Repetition,
    Splitting,
    SplittingRun,
    repeated_interval,
    repeated_probability,
)

__all__ = ["Branching", "Rare", "is_of_law", "rare_of", "split"]

_LEAST_REPETITIONS: Final = 2
"""Finished repetitions below which there is no interval."""

_Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Rare:
    """The outcome of a splitting.

    Attributes:
        pilot: its first, small repetition, which only tells how large the others may be.
        repetitions: the others, those that did not come to their end included.
        is_out_of_budget: whether the budget ended before all repetitions were finished.

    """

    pilot: Repetition
    repetitions: Sequence[Repetition]
    is_out_of_budget: bool

    @classmethod
    def of(cls, splitting: Splitting[Lineage]) -> "Rare":
        """Return what a splitting has come to."""
        return cls(splitting.pilot, splitting.repetitions, splitting.is_out_of_budget)

    @property
    def _finished(self) -> list[Repetition]:
        return [item for item in self.repetitions if item.log_probability is not None]

    @property
    def logarithms(self) -> list[float]:
        """The logarithms of the probability of all repetitions that are finished."""
        return [item.log_probability for item in self.repetitions if item.log_probability is not None]

    @property
    def is_flat(self) -> bool:
        """True if values do not say how near a failure is, so that there are no levels."""
        return self.pilot.is_flat or any(item.is_flat for item in self.repetitions)

    @property
    def is_known(self) -> bool:
        """True if there are enough repetitions for an interval."""
        return len(self.logarithms) >= _LEAST_REPETITIONS and not self.is_flat

    @property
    def mixes_badly(self) -> bool:
        """True if one of the repetitions mixes badly; see `Repetition.mixes_badly`."""
        return any(item.mixes_badly for item in self.repetitions)

    @property
    def probability(self) -> float:
        """The probability, where it is known."""
        return repeated_probability(self._finished)

    def interval(self, confidence: float) -> Interval:
        """Return the interval of the probability, where it is known."""
        return repeated_interval(self._finished, confidence)


def is_of_law(row: Mapping[str, Any]) -> bool:
    """Return whether a run is one of the program's law, and not one that a move has made."""
    return row.get("move") is None


def split(
    splitting: Splitting[Lineage],
    make: Callable[[int, Sequence[Move[Lineage]]], Iterator[_Row]],
    threshold: float,
) -> Generator[_Row]:
    """The rows of a splitting, in order.

    Args:
        splitting: decides about the moves.
        make: makes the rows of moves, given the number of the first; the splitting ends where it gives fewer.
        threshold: largest value of a counterexample.

    """
    making = splitting.runs()
    number = 0
    moves = next(making, None)
    while moves is not None:
        outcomes = []
        for row, move in zip(make(number, moves), moves, strict=False):
            value = None if row["values"] is None else _distance(row, threshold)
            step = LineageStep(row["run"], move.step, move.share)
            point = Lineage(row["run"]) if move.parent is None else move.parent.child(step)
            outcomes.append(SplittingRun(point, value))
            yield row
        if len(outcomes) < len(moves):
            return
        number += len(moves)
        try:
            moves = making.send(outcomes)
        except StopIteration:
            return


def _distance(row: _Row, threshold: float) -> float:
    """Return by how much a run misses a failure."""
    if "distances" in row:
        return min(map(float, row["distances"]))
    return min(map(float, row["values"])) - threshold


def rare_of(rows: Sequence[_Row], seed: int, budget: int, threshold: float) -> Rare:
    """Return the outcome of a splitting whose rows are known."""
    splitting: Splitting[Lineage] = Splitting(seed, budget)
    for _ in split(splitting, lambda first, moves: islice(rows, first, first + len(moves)), threshold):
        pass
    return Rare.of(splitting)


class Branching:
    """Makes the runs that a splitting asks for.

    Args:
        evaluation: of runs.
        ancestry: of their scenes.
        engine: where simulations are made.

    """

    def __init__(self, evaluation: Evaluation, ancestry: Ancestry, engine: BatchEngine | None) -> None:
        self._evaluation = evaluation
        self._ancestry = ancestry
        self._engine = engine

    def rows(self, first: int, moves: Sequence[Move[Lineage]]) -> Iterator[_Row]:
        """The rows of moves, in order; the first is run ``first``."""
        lineages = [
            Lineage(run)
            if move.parent is None
            else move.parent.child(LineageStep(run, move.step, move.share))
            for run, move in enumerate(moves, first)
        ]
        for row, move in zip(self._made(first, lineages), moves, strict=True):
            if move.parent is not None:
                row["move"] = [move.parent.run, move.step, move.share]
            row["level"] = [move.repetition, move.level]
            yield row

    def _made(self, first: int, lineages: Sequence[Lineage]) -> Iterator[_Row]:
        if self._evaluation.simulations is not None:
            return evaluated(self._evaluation, map(self._ancestry.task, lineages), self._engine)
        if not lineages[0].steps:
            return self._evaluation.together(first, np.zeros((len(lineages), 0)))
        numbers, words = self._ancestry.numbers(self._ancestry.all_draws(lineages))
        return self._evaluation.given(first, numbers, words, len(lineages))
