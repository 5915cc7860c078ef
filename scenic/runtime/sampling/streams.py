"""The random numbers of a scene: a function of seed, scene number and purpose alone.

Scene ``k`` of seed ``s`` has a stream of its own, the counter-based generator Philox (Salmon et al., SC 2011) keyed by
``(s, k)``. Its counter is split by purpose; within the purpose `ATTEMPTS`, attempt ``a`` is row ``a`` of a matrix of
uniform numbers. So no number depends on what was drawn before, in which batch, or by which worker.
"""

import hashlib
import itertools
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

SOFT: Final = 0
"""Which soft requirements hold in the scene."""
ATTEMPTS: Final = 1
"""The points of the cube that are tried in turn."""
SIMULATION: Final = 2
"""Draws during simulations of the scene."""

_WORDS = 4  # Philox gives four 64-bit words for each value of its counter.
_SMALLEST = 2.0**-54  # Stands for zero, which is not in the open interval.


class Streams:
    """Uniform numbers of all scenes of one seed.

    Args:
        seed: any integer.

    """

    def __init__(self, seed: int) -> None:
        self.seed = seed
        self._generator = np.random.Philox(key=0)
        self._state: dict[str, Any] = dict(self._generator.state)
        digest = hashlib.blake2b(str(seed).encode(), digest_size=8).digest()
        word = seed if 0 <= seed < 2**64 else int.from_bytes(digest, "little")
        self._key = np.array([word, 0], dtype=np.uint64)
        self._counter = np.zeros(_WORDS, dtype=np.uint64)

    def rows(self, scene: int, purpose: int, first: int, count: int, width: int) -> NDArray[np.float64]:
        """Rows ``first`` to ``first + count`` of a scene's matrix, shape ``(count, width)``, within (0, 1)."""
        blocks = -(-width // _WORDS)
        self._key[1] = scene
        self._counter[:] = (first * blocks, 0, 0, purpose)
        self._state["state"] = {"counter": self._counter, "key": self._key}
        self._state["buffer_pos"] = _WORDS
        self._state["has_uint32"] = 0
        self._generator.state = self._state  # type: ignore[assignment] # the stub wants its own TypedDict
        words: NDArray[np.uint64] = self._generator.random_raw(count * blocks * _WORDS)
        numbers = (words >> np.uint64(11)).astype(np.float64) * 2.0**-53
        np.maximum(numbers, _SMALLEST, out=numbers)
        return numbers.reshape(count, blocks * _WORDS)[:, :width]

    def matrix(
        self, scenes: NDArray[np.int64], attempts: NDArray[np.int64], width: int
    ) -> NDArray[np.float64]:
        """The rows of many attempts, shape ``(n, width)``; runs of consecutive attempts of a scene are drawn at once."""
        result = np.empty((len(scenes), width))
        if len(scenes) == 0 or width == 0:
            return result
        jump = (np.diff(scenes) != 0) | (np.diff(attempts) != 1)
        starts = np.concatenate([[0], np.flatnonzero(jump) + 1, [len(scenes)]]).tolist()
        for start, end in itertools.pairwise(starts):
            scene, attempt = int(scenes[start]), int(attempts[start])
            result[start:end] = self.rows(scene, ATTEMPTS, attempt, end - start, width)
        return result
