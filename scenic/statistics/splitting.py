"""Adaptive multilevel splitting: the probability of a rare failure as a product of probabilities that are not rare.

A population of runs from the program's law is narrowed, level by level, to the runs whose value is among the smallest tenth; the
others are replaced by runs that descend from these, by moves which leave the law of all runs below the level as it is (Au and Beck,
"Estimation of small failure probabilities in high dimensions by subset simulation", 2001; Cérou and Guyader, "Adaptive multilevel
splitting for rare event analysis", 2007). A move is a step of preconditioned Crank and Nicolson after a map of the unit cube to normals, of
all coordinates or of a random block of them; its length follows the share of moves that are accepted (Papaioannou et al., "MCMC algorithms
for subset simulation", 2015). The whole is repeated; the interval comes from the spread of the repetitions.
"""

import math
from collections.abc import Generator, Hashable, Sequence
from dataclasses import field
from typing import Final, Generic, TypeVar

import numpy as np

from scenic.dataclass import dataclass
from scenic.statistics.intervals import Interval

__all__ = ["Move", "Outcome", "Repetition", "Splitting", "repeated_interval", "repeated_probability"]

REPETITIONS: Final = 5
"""Number of independent repetitions, from whose spread the interval is made."""

_KEPT: Final = 0.1
"""Share of the population that goes on to the next level."""

_PILOT: Final = 100
"""Runs in each level of the first repetition, which only shows how many levels there are."""

_LEAST: Final = 50
"""Runs in each level, at least."""

_FLAT: Final = 0.9
"""Share of the population on one level from which there is no progress."""

_DISTINCT: Final = 0.5
"""Share of different runs among equal values below which moves are to blame for these."""

_MORE: Final = 1.5
"""Levels there may be, for each of a pilot that was stuck."""

_ACCEPTED: Final = 0.44
"""Share of accepted moves to aim at."""

_BADLY: Final = 0.05
"""Share of accepted moves below which a level mixes badly."""

_MOST_LEVELS: Final = 60
_TRIES: Final = 1000
"""Candidates for each run of a first population."""

_Point = TypeVar("_Point", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Move(Generic[_Point]):
    """A run to be made.

    Attributes:
        parent: the point that it starts from; ``None`` for a new point of the program's law.
        step: the length of the step, from 0 (stay) to 1 (forget the parent).
        share: chance of each coordinate to move.
        repetition: number of the repetition, 0 for the pilot.
        level: number of the level, 0 for the first population.

    """

    parent: _Point | None
    step: float = 1.0
    share: float = 1.0
    repetition: int = 0
    level: int = 0


@dataclass(frozen=True, slots=True)
class Outcome(Generic[_Point]):
    """A run that was made: its point, and its value, 0 or less for a failure; ``None`` where the run is not one of the law."""

    point: _Point
    value: float | None


@dataclass(slots=True)
class Repetition:
    """One repetition of the splitting.

    Attributes:
        log_probability: the logarithm of its estimate; ``None`` if it did not come to its end.
        levels: the values of the levels.
        shares: the logarithms of the probabilities of values as small.
        accepted: the share of accepted moves at each level.
        ancestors: number of members of the first population from which the last one descends.
        runs: number of its runs.
        is_flat: whether it stopped since the values of most runs were equal.
        is_stuck: whether it stopped since moves did not leave a few runs.

    """

    log_probability: float | None = None
    levels: list[float] = field(default_factory=list)
    shares: list[float] = field(default_factory=list)
    accepted: list[float] = field(default_factory=list)
    ancestors: int = 0
    runs: int = 0
    is_flat: bool = False
    is_stuck: bool = False

    @property
    def mixes_badly(self) -> bool:
        """Return whether hardly any move was accepted at some level, or all members of the last one descend from very few."""
        return (
            self.is_stuck
            or min(self.accepted, default=1.0) < _BADLY
            or (bool(self.levels) and self.ancestors < 3)
        )


@dataclass(slots=True)
class _Member(Generic[_Point]):
    point: _Point
    value: float
    ancestor: int


_Making = Generator[list[Move[_Point]], list[Outcome[_Point]], None]


class Splitting(Generic[_Point]):
    """The splitting of a budget of runs into repetitions.

    Args:
        seed: of the order of members and the blocks; moves themselves are made by the caller.
        budget: number of runs, all repetitions together; it is not exceeded.
        repetitions: number of repetitions after the pilot.

    """

    def __init__(self, seed: int, budget: int, repetitions: int = REPETITIONS) -> None:
        self._generator = np.random.default_rng([abs(seed), 47])
        self._left = budget
        self._count = repetitions
        self.pilot = Repetition()
        self.repetitions: list[Repetition] = []
        self.first_values: list[float] = []
        """The values of all runs of the program's law, that of the pilot included."""
        self.is_out_of_budget = False
        self._kernel = _Kernel(self._generator)

    def runs(self) -> _Making[_Point]:
        """The runs to be made, some at a time; each time the outcomes of all of them are sent back, in order."""
        yield from self._repeat(self.pilot, _PILOT, 0)
        pilot = self.pilot
        if self.is_out_of_budget or pilot.is_flat or not pilot.runs:
            return
        # A pilot that was stuck has not seen all levels.
        per_member = pilot.runs / _PILOT * (_MORE if pilot.is_stuck else 1)
        for number in range(1, self._count + 1):
            repetition = Repetition()
            size = int(self._left / (self._count + 1 - number) / per_member)
            if size < _LEAST:
                self.is_out_of_budget = True
                return
            self.repetitions.append(repetition)
            yield from self._repeat(repetition, size, number)
            if self.is_out_of_budget:
                return
            per_member = max(per_member, repetition.runs / size)

    def _repeat(self, repetition: Repetition, size: int, number: int) -> _Making[_Point]:
        members: list[_Member[_Point]] = []
        yield from self._first(repetition, size, number, members)
        if len(members) < size:
            return
        logarithm, kernel = 0.0, self._kernel
        while True:
            failed = sum(member.value <= 0 for member in members)
            if failed >= _KEPT * size:
                repetition.log_probability = logarithm + math.log(failed / size)
                repetition.ancestors = len({member.ancestor for member in members if member.value <= 0})
                return
            values = sorted(member.value for member in members)
            level = values[max(1, int(_KEPT * size)) - 1]
            kept = [member for member in members if member.value <= level]
            if len(kept) > _FLAT * size or len(repetition.levels) == _MOST_LEVELS:
                # Equal values of different runs show nothing to follow, those of the same run only that moves do not leave it.
                is_stuck = len({member.point for member in kept}) < _DISTINCT * size
                repetition.is_stuck, repetition.is_flat = is_stuck, not is_stuck
                return
            logarithm += math.log(len(kept) / size)
            repetition.levels.append(level)
            repetition.shares.append(logarithm)
            order = self._generator.permutation(len(kept))
            members = [kept[place] for place in order]
            kernel.begin(len(repetition.levels))
            yield from self._descend(repetition, members, size, level, number, kernel)
            if len(members) < size:
                return
            repetition.accepted.append(kernel.accepted)

    def _first(
        self, repetition: Repetition, size: int, number: int, members: list[_Member[_Point]]
    ) -> _Making[_Point]:
        """Make the first population; there is less of it if the budget ends."""
        asked = 0
        while len(members) < size and asked < _TRIES * size:
            count = min(size - len(members), self._left)
            if count == 0:
                self.is_out_of_budget = True
                return
            outcomes = yield [Move(None, repetition=number)] * count
            asked += count
            self._spend(repetition, sum(outcome.value is not None for outcome in outcomes))
            for outcome in outcomes:
                if outcome.value is not None:
                    members.append(_Member(outcome.point, outcome.value, len(members)))
                    self.first_values.append(outcome.value)

    def _spend(self, repetition: Repetition, count: int) -> None:
        self._left -= count
        repetition.runs += count

    def _descend(
        self,
        repetition: Repetition,
        members: list[_Member[_Point]],
        size: int,
        level: float,
        number: int,
        kernel: "_Kernel",
    ) -> _Making[_Point]:
        """Fill the population up by chains that start at its members, all of them a step at a time."""
        chains = list(members)
        while len(members) < size:
            chains = chains[: size - len(members)]
            if len(chains) > self._left:
                self.is_out_of_budget = True
                return
            in_blocks = kernel.choose(len(chains))
            moves = [
                Move(member.point, *kernel.step(in_block), repetition=number, level=len(repetition.levels))
                for member, in_block in zip(chains, in_blocks, strict=True)
            ]
            outcomes = yield moves
            self._spend(repetition, len(outcomes))
            moved = [
                _Member(outcome.point, outcome.value, member.ancestor)
                if outcome.value is not None and outcome.value <= level
                else member
                for member, outcome in zip(chains, outcomes, strict=True)
            ]
            kernel.learn(in_blocks, chains, moved)
            chains = moved
            members += moved


class _Kernel:
    """The choice among moves of all coordinates and of blocks, and the lengths of both; both follow the moves so far."""

    def __init__(self, generator: np.random.Generator) -> None:
        self._generator = generator
        self._steps = [0.6, 0.9]
        self._jumps = [0.0, 0.0]
        self._tried = [0, 0]
        self._accepted = 0
        self._share = 0.5
        self._level = 0
        self._learned: dict[int, tuple[list[float], float]] = {}
        """Lengths of steps, and the share of moves of blocks, by level."""

    def begin(self, level: int) -> None:
        """A new level begins; steps are at first those at which an earlier repetition has arrived there, else at the level before."""
        self._jumps, self._tried, self._accepted = [0.0, 0.0], [0, 0], 0
        self._steps, self._share = self._learned.setdefault(level, (list(self._steps), self._share))
        self._level = level

    @property
    def accepted(self) -> float:
        """The share of accepted moves at this level."""
        return self._accepted / max(1, sum(self._tried))

    def choose(self, count: int) -> list[bool]:
        """Choose the moves that are of blocks; the kind of moves that changes values more comes more often."""
        if min(self._tried) >= _LEAST // 5:
            every, block = (jump / tried for jump, tried in zip(self._jumps, self._tried, strict=True))
            self._share = min(0.9, max(0.1, block / (every + block))) if every + block else 0.5
        return [bool(number < self._share) for number in self._generator.random(count)]

    def step(self, in_block: bool) -> tuple[float, float]:
        """The length of a step, and the chance of each coordinate to move."""
        return self._steps[in_block], float(self._generator.random()) if in_block else 1.0

    def learn(
        self, in_blocks: Sequence[bool], before: Sequence[_Member[_Point]], after: Sequence[_Member[_Point]]
    ) -> None:
        """Take note of moves that were made."""
        for kind in (False, True):
            pairs = [
                (old, new)
                for old, new, in_block in zip(before, after, in_blocks, strict=True)
                if in_block is kind
            ]
            if not pairs:
                continue
            accepted = sum(old is not new for old, new in pairs)
            self._accepted += accepted
            self._tried[kind] += len(pairs)
            jumps = (old.value - new.value for old, new in pairs if old is not new)
            self._jumps[kind] += sum(jump**2 for jump in jumps if math.isfinite(jump))
            gain = 0.5 * min(1.0, len(pairs) / 30)
            longer = math.exp(gain * (accepted / len(pairs) - _ACCEPTED))
            self._steps[kind] = min(0.999, self._steps[kind] * longer)
        self._learned[self._level] = (self._steps, self._share)


def repeated_probability(log_probabilities: Sequence[float]) -> float:
    """The mean of the probabilities that some repetitions have given."""
    return float(np.mean(np.exp(log_probabilities)))


def repeated_interval(log_probabilities: Sequence[float], confidence: float) -> Interval:
    """A t interval of the logarithm of the probability, from two repetitions or more; approximate.

    The logarithms of repetitions are taken as normal, so that the logarithm of their mean varies by their variance and by the variance
    of that (Olsson, "Confidence intervals for the mean of a log-normal distribution", 2005).
    """
    from scipy.stats import t

    count = len(log_probabilities)
    variance = float(np.var(log_probabilities, ddof=1))
    error = math.sqrt(variance / count + variance**2 / (2 * (count - 1)))
    half = float(t.isf((1 - confidence) / 2, count - 1)) * error
    center = math.log(repeated_probability(log_probabilities))
    return Interval(math.exp(center - half), min(1.0, math.exp(min(0.0, center + half))))
