"""Samplers over buckets: cross-entropy, epsilon-greedy, and a bandit for each coordinate."""

import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.falsification.samplers.search_sampler import SamplerError, options
from scenic.falsification.space import Floats, Space, shares_of

__all__ = ["Bandit", "CrossEntropy", "EpsilonGreedy"]

_BUCKETS: Final = 5
_DEFAULTS: Final[Mapping[str, Any]] = {"alpha": 0.9, "thres": 0.0, "cont": {}, "disc": {}}


def _attribute(given: object, name: str, default: object) -> Any:
    found = given.get(name) if isinstance(given, Mapping) else getattr(given, name, None)
    return default if found is None else found


class _Buckets:
    """Coordinates cut into buckets of equal width, with one distribution for each coordinate."""

    batch: int | None = None
    name = "ce"

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        settings = options(given, _DEFAULTS, self.name)
        self.alpha = float(settings["alpha"])
        self.threshold = float(settings["thres"])
        if not 0 <= self.alpha <= 1:
            raise SamplerError(f"`alpha` lies between 0 and 1, not at {self.alpha}")
        buckets = _attribute(settings["cont"], "buckets", _BUCKETS)
        counts = np.ravel(buckets).astype(int)
        self.distributions = [np.array(item, dtype=np.float64) for item in shares_of(space, int(counts[0]))]
        for kind in ("cont", "disc"):
            places = [
                place
                for place, item in enumerate(space.coordinates)
                if item.is_continuous == (kind == "cont")
            ]
            if kind == "cont" and len(counts) > 1:
                _checked(len(counts), len(places), "cont.buckets")
                for place, count in zip(places, counts.tolist(), strict=True):
                    if space.coordinates[place].shares is None:
                        self.distributions[place] = np.full(count, 1 / count)
            given_shares = _attribute(settings[kind], "dist", None)
            if given_shares is not None:
                _checked(len(given_shares), len(places), f"{kind}.dist")
                for place, shares in zip(places, given_shares, strict=True):
                    weights = np.array(shares, dtype=np.float64)
                    self.distributions[place] = weights / weights.sum()
        self.generator = np.random.default_rng(seed)

    def drawn(self) -> list[int]:
        """Return the next buckets, one for each coordinate."""
        return [int(self.generator.choice(len(item), p=item)) for item in self.distributions]

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        rows = np.zeros((count, len(self.distributions)))
        for row in rows:
            row[:] = [
                (bucket + self.generator.random()) / len(shares)
                for bucket, shares in zip(self.drawn(), self.distributions, strict=True)
            ]
        return rows

    def buckets_of(self, point: Floats) -> list[int]:
        """Return the buckets that a point lies in."""
        return [
            min(int(place * len(shares)), len(shares) - 1)
            for place, shares in zip(point.tolist(), self.distributions, strict=True)
        ]


def _checked(count: int, wanted: int, name: str) -> None:
    if count != wanted:
        raise SamplerError(f"the option `{name}` has {count} entries for {wanted} parameters")


class CrossEntropy(_Buckets):
    """Distributions over buckets that come nearer to the buckets of what was worth finding.

    After a value below the threshold every distribution ``p`` becomes ``alpha p + (1 - alpha) e``, ``e`` the bucket drawn
    (Rubinstein, "The cross-entropy method for combinatorial and continuous optimization", 1999, with one elite).
    """

    def tell(self, points: Floats, values: Floats) -> None:
        """See `Sampler.tell`."""
        for point, value in zip(points, values.tolist(), strict=True):
            if value < self.threshold:
                for bucket, shares in zip(self.buckets_of(point), self.distributions, strict=True):
                    shares *= self.alpha
                    shares[bucket] += 1 - self.alpha


_HALVED: Final = 100


class EpsilonGreedy(CrossEntropy):
    """Cross-entropy that draws from all buckets alike with a chance that is halved every 100 updates."""

    name = "eg"

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        super().__init__(space, seed, given)
        self._updates = 0

    @property
    def epsilon(self) -> float:
        """The chance of a draw from all buckets alike."""
        return 0.5 * 0.5 ** (self._updates // _HALVED)

    def drawn(self) -> list[int]:
        """Return the next buckets, one for each coordinate."""
        if self.generator.random() < self.epsilon:
            return [int(self.generator.integers(len(item))) for item in self.distributions]
        return super().drawn()

    def tell(self, points: Floats, values: Floats) -> None:
        """See `Sampler.tell`."""
        super().tell(points, values)
        self._updates += len(points)


class Bandit(_Buckets):
    """A bandit for each coordinate: the bucket of the highest upper confidence bound (Auer et al., 2002), ties at random.

    Each bucket begins as if it had been drawn once.
    """

    name = "mab"

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        super().__init__(space, seed, given)
        self.counts = [np.ones(len(item)) for item in self.distributions]
        self.errors = [np.zeros(len(item)) for item in self.distributions]
        self.time = 1
        self._waiting: list[NDArray[np.float64]] = [np.zeros(len(item)) for item in self.distributions]

    def drawn(self) -> list[int]:
        """Return the next buckets, one for each coordinate.

        Points that were asked for and not told yet count as drawn, so that those of a batch differ.
        """
        chosen = [int(self.generator.choice(np.flatnonzero(bound == bound.max()))) for bound in self.bounds()]
        for bucket, waiting in zip(chosen, self._waiting, strict=True):
            waiting[bucket] += 1
        return chosen

    def bounds(self) -> list[Floats]:
        """Return the upper confidence bounds of the buckets of each coordinate."""
        found = []
        for counts, errors, waiting in zip(self.counts, self.errors, self._waiting, strict=True):
            tried = counts + waiting
            found.append(errors / tried + np.sqrt(2 * math.log(self.time) / tried))
        return found

    def tell(self, points: Floats, values: Floats) -> None:
        """See `Sampler.tell`."""
        for point, value in zip(points, values.tolist(), strict=True):
            self.time += 1
            for place, bucket in enumerate(self.buckets_of(point)):
                self._waiting[place][bucket] = max(0.0, self._waiting[place][bucket] - 1)
                self.counts[place][bucket] += 1
                if value < self.threshold:
                    self.errors[place][bucket] += 1
