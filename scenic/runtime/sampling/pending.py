"""Scenes that are being looked for, as columns: one by one they would cost more than their candidates."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenic.graph.draws import Counter, Words, address, scene_keys, seed_words


class SceneTask(NamedTuple):
    """The task to find a scene: scene ``k`` of a seed."""

    seed: int
    k: int


def soft_address(place: int) -> int:
    """The address of the draw that decides whether a soft requirement has to hold, the number ``place`` among them."""
    return address("soft requirement", place)


class Pending:
    """Scenes under way, in order.

    Args:
        chances: the probabilities with which soft requirements have to hold, ``(s,)``.
        places: their numbers among all soft requirements of the program, ``(s,)``.
        tried: candidates of each scene that have been tried already.

    Attributes:
        number: which of all scenes that are looked for each one is, ``(n,)``.
        given: the seeds, any integers, ``(n,)``.
        seed: words that the seeds stand for, ``(n,)``.
        k: their numbers in the runs of those seeds, ``(n,)``.
        key: words that their draws follow from, ``(n,)``.
        attempts: how many candidates have been tried, ``(n,)``.
        inactive: which soft requirements need not hold, ``(n, s)``.

    """

    def __init__(self, chances: NDArray[np.float64], places: Sequence[int], tried: int = 0) -> None:
        self._chances: Final = chances
        self._addresses: Final = np.array([soft_address(place) for place in places], dtype=np.uint64)
        self._tried: Final = tried
        self._next = 0
        self.number = np.empty(0, dtype=np.int64)
        self.given = np.empty(0, dtype=np.object_)
        self.seed: Words = np.empty(0, dtype=np.uint64)
        self.k = np.empty(0, dtype=np.int64)
        self.key: Words = np.empty(0, dtype=np.uint64)
        self.attempts = np.empty(0, dtype=np.int64)
        self.inactive = np.empty((0, len(chances)), dtype=np.bool_)

    def __len__(self) -> int:
        return len(self.number)

    def task(self, row: int) -> SceneTask:
        """The scene's seed and number."""
        return SceneTask(self.given[row], int(self.k[row]))

    def add(self, tasks: Sequence[tuple[int, int]]) -> None:
        """Look for more scenes, of seeds and numbers in their runs."""
        if not tasks:
            return
        numbers = range(self._next, self._next + len(tasks))
        self._next = numbers.stop
        seeds, ks = zip(*tasks, strict=True)
        seed = np.broadcast_to(seed_words(seeds[:1] if len(set(seeds)) == 1 else seeds), len(seeds))
        k = np.array(ks, dtype=np.int64)
        key = scene_keys(seed, k)
        inactive = Counter(key).uniforms(self._addresses) >= self._chances[:, np.newaxis]
        self.number = np.concatenate([self.number, np.arange(numbers.start, numbers.stop)])
        self.given = np.concatenate([self.given, np.array(seeds, dtype=np.object_)])
        self.seed = np.concatenate([self.seed, seed])
        self.k = np.concatenate([self.k, k])
        self.key = np.concatenate([self.key, key])
        self.attempts = np.concatenate([self.attempts, np.full(len(tasks), self._tried, dtype=np.int64)])
        self.inactive = np.concatenate([self.inactive, inactive.T])

    def leave(self, finished: NDArray[np.bool_]) -> None:
        """Remove the scenes ``(n,)`` that are finished: found, or given up."""
        if not finished.any():
            return
        left = np.flatnonzero(~finished)
        for name in ("number", "given", "seed", "k", "key", "attempts", "inactive"):
            setattr(self, name, getattr(self, name)[left])


__all__ = ["Pending", "SceneTask", "soft_address"]
