"""Scenes of seeds that a script will probably draw next.

`Scenario.generate` takes its seed from Python's ``random``. A script that calls it in a loop, and draws nothing itself in
between, gets the seeds that a copy of the generator gives now. Sampling those scenes together makes the loop as cheap
as a batch. Nothing of it can be seen: a scene is a function of its seed.
"""

import random
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from typing import Final

from scenic.runtime.sampling.pending import SceneTask
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scene import Scene

SEED_BITS: Final = 63

Found = Iterator[Scene | Exhausted]


class Foreseen:
    """The scenes of seeds drawn one after the other, as long as they are those that were to come.

    Args:
        find: scenes of tasks without end, in order, each found among at most so many candidates or given up; and whether
            to expect that more than the first one will be wanted.

    """

    def __init__(self, find: Callable[[Iterable[SceneTask], int, bool], Found]) -> None:
        self._find = find
        self._lock = threading.Lock()
        self._limit = 0
        self._stream: Found | None = None
        self._given = 0
        """Scenes taken from the stream."""
        self._seeds: Iterator[int] = iter(())
        self._expected: deque[int] = deque()
        """The seeds of the scenes that come next in the stream."""
        self._peeked: deque[int] = deque()
        """Expected seeds that the stream has not read."""

    def take(self, seed: int, limit: int) -> Scene | Exhausted:
        """The scene of a seed that was drawn just now; raises what goes wrong in sampling it."""
        if not self._lock.acquire(blocking=False):
            # Another thread samples, or the program's own function has asked for a scene in the middle of another one.
            return next(self._find([SceneTask(seed, 0)], limit, False))
        try:
            if self._stream is None or limit != self._limit or self._next_seed() != seed:
                self._begin(seed, limit)
            self._expected.popleft()
            assert self._stream is not None
            self._given += 1
            return next(self._stream)
        except BaseException:
            self._stream = None  # it ends with what it raises
            raise
        finally:
            self._lock.release()

    def _begin(self, seed: int, limit: int) -> None:
        """Start another stream, whose first seed is ``seed``."""
        # Who draws numbers between one scene and the next has broken off the stream before after its first scene.
        more = self._given != 1
        self._given = 0
        self._limit = limit
        self._seeds = seeds_after(random.getstate())
        self._expected, self._peeked = deque([seed]), deque([seed])
        self._stream = self._find(self._tasks(), limit, more)

    def _next_seed(self) -> int:
        if not self._expected:
            seed = next(self._seeds)
            self._expected.append(seed)
            self._peeked.append(seed)
        return self._expected[0]

    def _tasks(self) -> Iterator[SceneTask]:
        expected, peeked, seeds = self._expected, self._peeked, self._seeds
        while True:
            if peeked:
                yield SceneTask(peeked.popleft(), 0)
            else:
                seed = next(seeds)
                expected.append(seed)
                yield SceneTask(seed, 0)


def seeds_after(state: tuple[object, ...]) -> Iterator[int]:
    """The seeds that ``random`` gives from a state on."""
    copy = random.Random()
    copy.setstate(state)
    while True:
        yield copy.getrandbits(SEED_BITS)
