"""Scenes of seeds that a script will probably draw next.

`Scenario.generate` takes its seed from Python's ``random``. A script that calls it in a loop, and draws nothing itself in
between, gets the seeds that a copy of the generator gives now. Sampling those scenes together with the first one makes
the loop as cheap as a batch. Nothing of it can be seen: a scene is a function of its seed.
"""

import random
from collections.abc import Sequence
from typing import Final

from scenic.runtime.sampling.report import Exhausted
from scenic.runtime.scene import Scene

SEED_BITS: Final = 63

_MOST: Final = 128
"""Scenes foreseen at a time, at most."""

_SECONDS: Final = 0.05
"""Processor time that a refill may take before fewer scenes are foreseen."""


class Foreseen:
    """Scenes sampled ahead, and how many to sample next time."""

    def __init__(self) -> None:
        self._scenes: dict[int, Scene | Exhausted] = {}
        self._limit = 0
        self._count = 0
        """How many seeds to foresee: twice as many after a success, none after a miss."""
        self._used = False
        self._foreseen = 0
        self._seconds: float = 0.0

    def take(self, seed: int, limit: int) -> Scene | Exhausted | None:
        """The scene of a seed, if it has been foreseen under the same limit of candidates."""
        if limit != self._limit:
            self._scenes.clear()
        found = self._scenes.pop(seed, None)
        self._used = self._used or found is not None
        return found

    def seeds(self) -> list[int]:
        """The seeds that ``random`` will give next, as many as past success suggests."""
        if self._used or not self._foreseen:
            # The cost of a round is mostly the same whatever its size, so that only a long refill ends the growth.
            self._count = min(_MOST, 2 * self._count + 1) if self._seconds < _SECONDS else self._count // 2
        else:
            self._count = 0
        self._foreseen = self._count
        if not self._count:
            return []
        copy = random.Random()
        copy.setstate(random.getstate())
        return [copy.getrandbits(SEED_BITS) for _ in range(self._count)]

    def keep(self, scenes: Sequence[Scene | Exhausted], limit: int, seconds: float) -> None:
        """Keep the scenes of the seeds foreseen last; ``seconds`` is the processor time that they took, with the first one."""
        self._seconds = seconds
        self._scenes = {scene.seed: scene for scene in scenes}
        self._limit = limit
        self._used = False
