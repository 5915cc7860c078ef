"""Candidates whose external parameters a sampler chooses, evaluated many together.

The candidates of a loop of `Scenario.generate` are one stream: candidate ``k`` has the next point of the sampler, and draws all else as scene
``k`` of the stream's seed, which is the seed of its first scene. So each is evaluated once, in whatever batch, and accepted ones
that nobody has wanted yet wait. The stream goes on as long as the seeds are those that Python's ``random`` was to give.
"""

import random
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from scenic.runtime.sampling.engine import Accepted, CandidateError
from scenic.runtime.scenes.prefetching import seeds_after

__all__ = ["ExternalCandidates", "ExternalPoints"]

_MOST_SCENES: Final = 64
"""Scenes looked for together, at most: nobody knows how many are wanted."""

Columns = Mapping[int, NDArray[np.float64]]
Result = Accepted | CandidateError


class ExternalPoints(Protocol):
    """The points of a sampler of external parameters, in order."""

    @property
    def sampler(self) -> Any:
        """The sampler, as the program names it."""

    @property
    def answerless(self) -> bool:
        """True if no point depends on what has become of those before it."""

    def ahead(self, feedback: object, count: int) -> Columns:
        """The numbers ``(n,)`` of the next points, by address, at least one and at most ``count``.

        They are those that come one after the other if all but the last are rejected; ``feedback`` is about the one before them.
        """

    def use(self, count: int) -> None:
        """Go on behind so many of the points that `ahead` has given; the others come next, or are chosen anew."""


class ExternalCandidates:
    """The stream of candidates of a scenario.

    Args:
        points: the points of the external parameters.
        evaluate: the candidates that nothing rejects, with their places: of columns, a count, a seed and the number of the first.
        lanes_for: number of candidates that are best evaluated together where a number of scenes are wanted.

    """

    def __init__(
        self,
        points: ExternalPoints,
        evaluate: Callable[[Columns, int, int, int], list[tuple[int, Result]]],
        lanes_for: Callable[[int], int],
    ) -> None:
        self.points = points
        self._evaluate = evaluate
        self._lanes_for = lanes_for
        self._seeds: Iterator[int] = iter(())
        """The seeds that are expected next."""
        self._given = 0
        """Scenes taken from the stream."""
        self._seed = 0
        self._next = self._end = 0
        """The candidate that comes next, and the first one that is not evaluated."""
        self._waiting: deque[tuple[int, Result]] = deque()
        """Candidates that are evaluated and not rejected, with their numbers."""

    def take(self, seed: int, most: int, feedback: object) -> tuple[Result | None, int]:
        """Return the next candidate that nothing rejects, if it is one of ``most``; and the number of those tried.

        Args:
            seed: the seed that was drawn just now.
            most: candidates to try.
            feedback: what the sampler is told about the scene before.

        """
        if next(self._seeds, None) != seed:
            self.forget()
            self._seed, self._seeds = seed, seeds_after(random.getstate())
        attempts = 0
        while attempts < most:
            if self._next == self._end:
                self._fill(feedback, most - attempts)
            reach = self._waiting[0][0] + 1 if self._waiting else self._end
            steps = min(most - attempts, reach - self._next)
            self._next += steps
            attempts += steps
            self.points.use(steps)
            if self._waiting and self._next == reach:
                _, result = self._waiting.popleft()
                self._given += 1
                if not self.points.answerless:
                    self._waiting.clear()
                    self._end = self._next
                return result, attempts
            feedback = self.points.sampler.rejectionFeedback
        return None, attempts

    def forget(self) -> None:
        """Begin another stream with the next scene; points that were not used come first."""
        self._seeds = iter(())
        self._waiting.clear()
        self._given = self._next = self._end = 0

    def _fill(self, feedback: object, most: int) -> None:
        """Evaluate the next candidates."""
        if self.points.answerless:
            count = self._lanes_for(min(max(1, 2 * self._given), _MOST_SCENES))
        else:
            count = min(most, self._lanes_for(1))
        columns = self.points.ahead(feedback, count)
        count = len(next(iter(columns.values())))
        try:
            results = self._evaluate(columns, count, self._seed, self._end)
        except BaseException:
            self.points.use(0)
            self.forget()
            raise
        self._waiting.extend((self._end + place, result) for place, result in results)
        self._end += count
