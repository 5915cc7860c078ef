"""Samplers that do not learn: independent points, Halton's and Sobol's sequences, a grid."""

import itertools
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.falsification.samplers.search_sampler import NoMorePointsError, SamplerError, options
from scenic.falsification.space import Floats, Space

__all__ = ["Grid", "Halton", "RandomSampler", "SobolSampler"]


class RandomSampler:
    """Independent uniform points."""

    batch = None

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        options(given, {}, "random")
        self._dimension = len(space)
        self._generator = np.random.default_rng(seed)

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        return self._generator.random((count, self._dimension))

    def tell(self, points: Floats, values: Floats) -> None:
        """Nothing to learn."""


class Halton:
    """Halton's sequence for continuous coordinates; discrete ones, and those with the buckets of a prior, are independent."""

    batch = None

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        chosen = options(given, {"sample_index": 0, "bases_skipped": 0}, "halton")
        self._continuous = [place for place, item in enumerate(space.coordinates) if item.is_continuous]
        self._dimension = len(space)
        skipped = int(chosen["bases_skipped"])
        self._generator = np.random.default_rng(seed)
        self._bases = _primes(skipped + len(self._continuous))[skipped:]
        self._next = int(chosen["sample_index"]) + 1

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        points = self._generator.random((count, self._dimension))
        numbers = np.arange(self._next, self._next + count)
        self._next += count
        for place, base in zip(self._continuous, self._bases, strict=True):
            points[:, place] = _reflected(numbers, base)
        return points

    def tell(self, points: Floats, values: Floats) -> None:
        """Nothing to learn."""


def _primes(count: int) -> list[int]:
    """Return the first primes."""
    found: list[int] = []
    candidates = itertools.count(2)
    while len(found) < count:
        number = next(candidates)
        if all(number % prime for prime in found):
            found.append(number)
    return found


def _reflected(numbers: NDArray[np.int64], base: int) -> Floats:
    """The numbers ``(n,)`` with their digits reflected at the point (van der Corput, 1935)."""
    result = np.zeros(len(numbers))
    place = 1.0
    while numbers.any():
        numbers, digits = np.divmod(numbers, base)
        place /= base
        result += digits * place
    return result


class SobolSampler:
    """Sobol's sequence, scrambled."""

    batch = None

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        from scipy.stats import qmc

        options(given, {}, "sobol")
        self._dimension = len(space)
        self._sequence: Any = qmc.Sobol(
            max(len(space), 1), scramble=True, bits=52, rng=np.random.default_rng(seed)
        )

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        import warnings

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of numbers of points that are no power of two
            points: Floats = self._sequence.random(count)[:, : self._dimension]
        return points

    def tell(self, points: Floats, values: Floats) -> None:
        """Nothing to learn."""


_POINTS: Final = 21


class Grid:
    """All points of a grid, the first coordinate changing fastest; its ends are included. Of a prior's buckets it takes the middles."""

    batch = None

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        settings = options(given, {"N": _POINTS, "repeat": False}, "grid")
        continuous = [item for item in space.coordinates if item.is_continuous]
        point_count = settings["N"]
        counts = list(point_count) if isinstance(point_count, Sequence) else [point_count] * len(continuous)
        if len(counts) != len(continuous) or any(int(count) < 1 for count in counts):
            raise SamplerError(
                f"the option `N` of the sampler 'grid' is {point_count!r}",
                help=f"give one number from 1 on, or {len(continuous)} of them, one for each continuous parameter",
            )
        sizes = iter(counts)
        self._axes = [
            np.linspace(0, 1, int(next(sizes)))
            if item.is_continuous
            else _middles(item.count or len(item.shares or (1.0,)))
            for item in space.coordinates
        ]
        self._repeat = bool(settings["repeat"])
        self._points = self._all()

    def _all(self) -> Any:
        while True:
            for reverse in itertools.product(*reversed(self._axes)):
                yield reverse[::-1]
            if not self._repeat:
                return

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        rows = list(itertools.islice(self._points, count))
        if not rows:
            raise NoMorePointsError(
                "the sampler 'grid' has given all of its points",
                help="set its option `repeat`, or a larger `N`",
            )
        return np.array(rows, dtype=np.float64).reshape(len(rows), len(self._axes))

    def tell(self, points: Floats, values: Floats) -> None:
        """Nothing to learn."""


def _middles(count: int) -> Floats:
    return (np.arange(count) + 0.5) / count
