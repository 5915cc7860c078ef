"""Adaptive multilevel splitting: the probability of a rare failure as a product of probabilities that are not rare.

A population of runs from the program's law is narrowed, level by level, to the runs whose value is among the smallest tenth; the
others are replaced by runs that descend from these, by moves which leave the law of all runs below the level as it is (Au and Beck,
"Estimation of small failure probabilities in high dimensions by subset simulation", 2001; Cérou and Guyader, "Adaptive multilevel
splitting for rare event analysis", 2007). A move is a step of preconditioned Crank and Nicolson after a map of the unit cube to normals, of
all coordinates or of a random block of them; its length follows the share of moves that are accepted (Papaioannou et al., "MCMC algorithms
for subset simulation", 2015).

Several repetitions are narrowed side by side, and the interval comes from their spread. Each has members of its own, which meet those of no
other; the level is the same for all. With levels that are chosen beforehand the product of the shares is an unbiased estimate in each
repetition, however badly moves mix, since each kept run gets equally many descendants on average (Cérou, Del Moral, Furon and Guyader,
"Sequential Monte Carlo for rare event estimation", 2012). A level that is the quantile of a population has a bias in proportion to one over
its size: so it is the quantile of all repetitions together, and not of each one. That holds for any value that is 0 or less exactly for failures.
"""

import math
from collections.abc import Callable, Generator, Hashable, Sequence
from dataclasses import field
from typing import Final, Generic, TypeVar

import numpy as np

from scenic.dataclass import dataclass
from scenic.statistics.confidence_intervals import Interval

__all__ = ["Move", "Repetition", "Splitting", "SplittingRun", "repeated_interval", "repeated_probability"]

REPETITIONS: Final = 5
"""Number of repetitions, from whose spread the interval is made; fewer if the budget is small."""

_KEPT: Final = 0.1
"""Share of the population that goes on to the next level."""

_PILOT: Final = 100
"""Runs in each level of the first repetition, which only shows how many levels there are, at most."""

_LEAST_PILOT: Final = 40
"""Runs in each level of the first repetition, at least, where the budget is small."""

_PILOTS: Final = 20
"""Levels of the first repetition that the budget has room for."""

_LEAST: Final = 20
"""Runs in the first population of a repetition, at least."""

_FEWEST: Final = 10
"""Runs in a later level of a repetition, at least."""

_FEW: Final = 3
"""Repetitions below which their spread says too little."""

_SURVIVING: Final = 0.02
"""Share of each repetition that goes on, at least, if others are nearer to a failure."""

_RESERVE: Final = 0.25
"""Levels for which there is budget left beside those that are expected."""

_FLAT: Final = 0.9
"""Share of the population on one level from which there is no progress."""

_DISTINCT: Final = 0.5
"""Share of different runs among equal values below which moves are to blame for these."""

_MORE: Final = 1.5
"""Levels there may be, for each of a pilot that was stuck."""

_MOST_AHEAD: Final = 3.0
"""Levels that values let expect, at most, for each that the pilot lets expect."""

_ACCEPTED: Final = 0.44
"""Share of accepted moves to aim at."""

_BLOCKS: Final = 0.2
"""Share of moves of blocks."""

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
class SplittingRun(Generic[_Point]):
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
        """Return whether hardly any move was accepted at some level, or all members of the last one descend from a single one."""
        return (
            self.is_stuck
            or min(self.accepted, default=1.0) < _BADLY
            or (self.log_probability is not None and bool(self.levels) and self.ancestors < 2)
        )


@dataclass(slots=True)
class _Member(Generic[_Point]):
    point: _Point
    value: float
    ancestor: int


_Making = Generator[list[Move[_Point]], list[SplittingRun[_Point]], None]


class Splitting(Generic[_Point]):
    """The splitting of a budget of runs into repetitions.

    Args:
        seed: of the order of members and the blocks; moves themselves are made by the caller.
        budget: number of runs, all repetitions together; it is not exceeded.
        repetitions: number of repetitions after the pilot, where the budget suffices for so many.

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
        pilot_size = max(_LEAST_PILOT, min(_PILOT, self._left // _PILOTS))
        yield from self._narrow([self.pilot], 0, lambda _level: pilot_size)
        pilot = self.pilot
        if self.is_out_of_budget or pilot.is_flat or not pilot.runs:
            return
        ahead = _Ahead(pilot)
        first_cost = 1 + (1 - _KEPT) * max(0.0, ahead.levels(None) - 0.5 + _RESERVE)
        count = min(self._count, int(self._left / first_cost / _LEAST))
        if count < min(self._count, _FEW):
            self.is_out_of_budget = True
            return
        self.repetitions = [Repetition() for _ in range(count)]

        def size(level: float | None) -> int:
            cost = (
                first_cost
                if level is None
                else (1 - _KEPT) * (max(1.0, ahead.levels(level) + 0.5) + _RESERVE)
            )
            return max(int(self._left / count / cost), min(_FEWEST, self._left // count))

        yield from self._narrow(self.repetitions, 1, size)

    def _narrow(
        self, repetitions: Sequence[Repetition], number: int, sizes: Callable[[float | None], int]
    ) -> _Making[_Point]:
        """Narrow some repetitions, of which the first has a number, level by level.

        Args:
            repetitions: what becomes of them.
            number: number of the first of them.
            sizes: the size of the population of each repetition below a level, or of the first population.

        """
        size = sizes(None)
        populations: list[list[_Member[_Point]]] = [[] for _ in repetitions]
        yield from self._first(repetitions, size, number, populations)
        while all(len(members) >= size for members in populations):
            failure_counts = [sum(member.value <= 0 for member in members) for members in populations]
            if min(failure_counts) > 0 and sum(failure_counts) >= _KEPT * size * len(populations):
                if number:
                    yield from self._enlarge(repetitions, populations, size, number)
                for repetition, members in zip(repetitions, populations, strict=True):
                    failures = [member.ancestor for member in members if member.value <= 0]
                    logarithm = repetition.shares[-1] if repetition.shares else 0.0
                    repetition.log_probability = logarithm + math.log(len(failures) / len(members))
                    repetition.ancestors = len(set(failures))
                return
            level = _next_level(populations, size)
            survivors = [[member for member in members if member.value <= level] for members in populations]
            if (
                sum(map(len, survivors)) > _FLAT * size * len(survivors)
                or len(repetitions[0].levels) == _MOST_LEVELS
            ):
                # Equal values of different runs show nothing to follow, those of the same run only that moves do not leave it.
                points = {member.point for members in survivors for member in members}
                is_stuck = len(points) < _DISTINCT * size * len(survivors)
                for repetition in repetitions:
                    repetition.is_stuck, repetition.is_flat = is_stuck, not is_stuck
                return
            for repetition, members in zip(repetitions, survivors, strict=True):
                repetition.levels.append(level)
                before = repetition.shares[-1] if repetition.shares else 0.0
                repetition.shares.append(before + math.log(len(members) / size))
            size = sizes(level)
            if size < _FEWEST:
                self.is_out_of_budget = True
                return
            populations = [
                [members[place] for place in self._generator.permutation(len(members))[:size]]
                for members in survivors
            ]
            self._kernel.begin(len(repetitions[0].levels))
            yield from self._descend(repetitions, populations, populations, size, number)
            for repetition in repetitions:
                repetition.accepted.append(self._kernel.accepted)

    def _first(
        self,
        repetitions: Sequence[Repetition],
        size: int,
        number: int,
        populations: Sequence[list[_Member[_Point]]],
    ) -> _Making[_Point]:
        """Make the first populations; there is less of them if the budget ends."""
        attempts, total = 0, size * len(repetitions)
        while attempts < _TRIES * total:
            places = [place for place, members in enumerate(populations) for _ in range(size - len(members))]
            if not places:
                return
            places = places[: self._left]
            if not places:
                self.is_out_of_budget = True
                return
            outcomes = yield [Move(None, repetition=number + place) for place in places]
            attempts += len(places)
            for place, outcome in zip(places, outcomes, strict=True):
                if outcome.value is not None:
                    members = populations[place]
                    members.append(_Member(outcome.point, outcome.value, len(members)))
                    self.first_values.append(outcome.value)
                    self._spend(repetitions[place])

    def _enlarge(
        self,
        repetitions: Sequence[Repetition],
        populations: Sequence[list[_Member[_Point]]],
        size: int,
        number: int,
    ) -> _Making[_Point]:
        """Make the last populations larger by what is left of the budget."""
        extra = self._left // len(populations)
        if extra and repetitions[0].levels:
            chains = [members[-max(1, int(_KEPT * size)) :] for members in populations]
            yield from self._descend(repetitions, populations, chains, size + extra, number)

    def _spend(self, repetition: Repetition) -> None:
        self._left -= 1
        repetition.runs += 1

    def _descend(
        self,
        repetitions: Sequence[Repetition],
        populations: Sequence[list[_Member[_Point]]],
        starts: Sequence[Sequence[_Member[_Point]]],
        size: int,
        number: int,
    ) -> _Making[_Point]:
        """Fill populations up by chains that start at some members, all of them a step at a time."""
        chains = [list(members) for members in starts]
        level = repetitions[0].levels[-1]
        while any(len(members) < size for members in populations):
            for place, members in enumerate(populations):
                chains[place] = chains[place][: size - len(members)]
            places = [place for place, some in enumerate(chains) for _ in some]
            if len(places) > self._left:
                self.is_out_of_budget = True
                return
            before = [member for some in chains for member in some]
            in_blocks = self._kernel.choose(len(before))
            outcomes = yield [
                Move(
                    member.point,
                    *self._kernel.step(in_block),
                    repetition=number + place,
                    level=len(repetitions[place].levels),
                )
                for place, member, in_block in zip(places, before, in_blocks, strict=True)
            ]
            after = [
                _Member(outcome.point, outcome.value, member.ancestor)
                if outcome.value is not None and outcome.value <= level
                else member
                for member, outcome in zip(before, outcomes, strict=True)
            ]
            self._kernel.learn(in_blocks, [old is not new for old, new in zip(before, after, strict=True)])
            chains = [[] for _ in populations]
            for place, member in zip(places, after, strict=True):
                chains[place].append(member)
                populations[place].append(member)
                self._spend(repetitions[place])


def _next_level(populations: Sequence[Sequence[_Member[_Point]]], size: int) -> float:
    """Return the value of the tenth of all members, but so that none of the repetitions dies out."""
    together = sorted(member.value for members in populations for member in members)
    level = together[max(1, int(_KEPT * len(together))) - 1]
    least = max(1, int(_SURVIVING * size)) - 1
    return max(level, *(sorted(member.value for member in members)[least] for members in populations))


class _Ahead:
    """The number of levels that are still to come, by those of a pilot, and by the progress of the values."""

    def __init__(self, pilot: Repetition) -> None:
        self._levels = [*pilot.levels, 0.0]
        shares = pilot.shares or [math.log(_KEPT)]
        # A pilot that was stuck has not seen all levels.
        end = pilot.log_probability if pilot.log_probability is not None else shares[-1] * _MORE
        self._shares = [*pilot.shares, end]
        self._before = math.inf

    def levels(self, level: float | None) -> float:
        """The number of levels below a level, the next in the course of levels, or of all of them."""
        share_behind = 0.0
        if level is not None and level < self._levels[0]:
            falling = [-value for value in self._levels]
            share_behind = float(np.interp(-level, falling, self._shares))
        ahead = max(0.0, (self._shares[-1] - share_behind) / math.log(_KEPT))
        if level is not None:
            if math.isfinite(self._before) and self._before > level:
                by_values = level / (self._before - level)
                ahead = max(ahead, min(by_values, _MOST_AHEAD * max(1.0, ahead)))
            self._before = level
        return ahead


class _Kernel:
    """The choice among moves of all coordinates and of blocks, and the lengths of both, which follow the moves so far."""

    def __init__(self, generator: np.random.Generator) -> None:
        self._generator = generator
        self._steps = [0.6, 0.9]
        self._tried = 0
        self._accepted = 0
        self._learned: dict[int, list[float]] = {}
        """Lengths of steps by level."""

    def begin(self, level: int) -> None:
        """A new level begins; steps are at first those at which an earlier repetition has arrived there, else at the level before."""
        self._tried = self._accepted = 0
        self._steps = self._learned.setdefault(level, list(self._steps))

    @property
    def accepted(self) -> float:
        """The share of accepted moves at this level."""
        return self._accepted / max(1, self._tried)

    def choose(self, count: int) -> list[bool]:
        """Choose the moves that are of blocks."""
        return [bool(number < _BLOCKS) for number in self._generator.random(count)]

    def step(self, in_block: bool) -> tuple[float, float]:
        """The length of a step, and the chance of each coordinate to move."""
        return self._steps[in_block], float(self._generator.random()) if in_block else 1.0

    def learn(self, in_blocks: Sequence[bool], accepted: Sequence[bool]) -> None:
        """Take note of moves that were made, whether of blocks, and whether they were accepted."""
        self._tried += len(accepted)
        self._accepted += sum(accepted)
        for kind in (False, True):
            outcomes = [
                is_good for is_good, in_block in zip(accepted, in_blocks, strict=True) if in_block is kind
            ]
            if outcomes:
                gain = 0.5 * min(1.0, len(outcomes) / 30)
                longer = math.exp(gain * (sum(outcomes) / len(outcomes) - _ACCEPTED))
                self._steps[kind] = min(0.999, self._steps[kind] * longer)


def repeated_probability(repetitions: Sequence[Repetition]) -> float:
    """Return the probability by finished repetitions with the same levels: the product of their mean shares.

    Each share counts with the members of all repetitions, so that this varies by a third less than the mean of the repetitions' products.
    As these products, the mean shares are unbiased up to one over the size of a population.
    """
    courses = np.array([[0.0, *item.shares, item.log_probability] for item in repetitions], dtype=np.float64)
    return float(np.prod(np.exp(np.diff(courses, axis=1)).mean(axis=0)))


def repeated_interval(repetitions: Sequence[Repetition], confidence: float) -> Interval:
    """Return a t interval of the logarithm of the probability, from two finished repetitions or more; approximate.

    The logarithms of repetitions are taken as normal, and that of the probability as their mean, which it is to first order.
    """
    from scipy.stats import t

    count = len(repetitions)
    logarithms = [item.log_probability for item in repetitions if item.log_probability is not None]
    half = float(t.isf((1 - confidence) / 2, count - 1)) * math.sqrt(
        float(np.var(logarithms, ddof=1)) / count
    )
    center = math.log(repeated_probability(repetitions))
    return Interval(math.exp(center - half), min(1.0, math.exp(min(0.0, center + half))))
