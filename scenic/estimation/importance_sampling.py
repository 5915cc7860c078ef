"""Importance sampling: runs that are drawn from where a search has found counterexamples, with weights that make up for it.

The weighted share of counterexamples among all candidates is an estimate of the probability that a candidate is a run and a counterexample.
Where some candidates meet no requirement of the scenes, it is divided by the weighted share of those that do.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.falsification.search_folder import manifest_of, read_rows
from scenic.language.errors import Located
from scenic.statistics.confidence_intervals import Interval
from scenic.statistics.weighting import LEAST_EFFECTIVE, Proposal, effective_size, weighted_interval

__all__ = ["FollowError", "Guide", "Weighted", "guide_of", "weighted_of"]

Floats = NDArray[np.float64]

_FOLLOWED: Final = ("ce", "cma")
"""Samplers whose last points lie where counterexamples are."""

_FOLLOWED_POINTS: Final = 20
"""Counterexamples of a search that are followed: those that the program draws most easily."""

_NARROWEST: Final = 0.7
"""Least standard deviation of a number that is drawn, after a map to a standard normal: a sampler narrows its points to a line."""

_LEAST: Final = 10
"""Counterexamples that a search must have found."""


class FollowError(Located):
    """A search that cannot be followed."""

    code = "SC604"


@dataclass(frozen=True, slots=True)
class Guide:
    """The distribution to draw the numbers of some draws from.

    Attributes:
        addresses: of these draws.
        proposal: the distribution.

    """

    addresses: tuple[int, ...]
    proposal: Proposal

    def point(self, seed: int, run: int) -> Floats:
        """The numbers ``(d,)`` of a run."""
        return np.asarray(self.proposal.draw(np.random.default_rng([abs(seed), run]), 1)[0])

    def weight(self, point: Floats) -> float:
        """The weight of a run that has these numbers."""
        return float(self.proposal.weights(point[np.newaxis])[0])

    def to_data(self) -> dict[str, Any]:
        """Return the same as plain data."""
        return {
            "addresses": [f"{item:016x}" for item in self.addresses],
            "means": self.proposal.means.tolist(),
            "deviations": self.proposal.deviations.tolist(),
            "uniform share": self.proposal.uniform_share,
        }


def guide_of(folder: Path, program: str) -> Guide:
    """Return the guide that follows the search in a folder, which must be of the program with this digest; raises `FollowError`."""
    from scipy.special import ndtri

    manifest = manifest_of(folder)
    if manifest["program"] != program:
        raise FollowError(
            f"the search in '{folder}' is of another program, or of other parameters",
            help="search the same program: `scenic falsify FILE --sampler ce -o FOLDER`",
        )
    if manifest["sampler"] not in _FOLLOWED:
        raise FollowError(
            f"the search in '{folder}' has the sampler {manifest['sampler']}, whose points do not gather where counterexamples are",
            help="search by --sampler ce or --sampler cma",
        )
    rows = [row for row in read_rows(folder) if row["status"] == "counterexample"]
    if len(rows) < _LEAST:
        raise FollowError(
            f"the search in '{folder}' has {len(rows)} counterexamples, too few to follow: it takes {_LEAST}",
            help="search longer (-n), or estimate by --rare, which needs no search",
        )
    addresses = tuple(int(name, 16) for name in rows[0]["numbers"])
    points = np.array([list(row["numbers"].values()) for row in rows], dtype=np.float64)
    points = np.clip(points, 2.0**-53, 1 - 2.0**-53)
    # A sampler goes on to ever worse failures, of which nearly none is ever drawn: after a map to normals the likely ones are near 0.
    order = np.argsort(np.square(ndtri(points)).sum(axis=1), kind="stable")
    near = Proposal.around(points[order[:_FOLLOWED_POINTS]])
    return Guide(addresses, Proposal(near.means, np.maximum(near.deviations, _NARROWEST)))


@dataclass(frozen=True, slots=True)
class Weighted:
    """Weights of candidates.

    Attributes:
        failed: of the counterexamples.
        valid: of all runs.
        candidates: number of candidates, those that are no runs included.

    """

    failed: Floats
    valid: Floats
    candidates: int

    @property
    def effective(self) -> float:
        """The effective number of counterexamples."""
        return effective_size(self.failed)

    @property
    def is_known(self) -> bool:
        """True if there are enough effective counterexamples for an estimate."""
        return self.effective >= LEAST_EFFECTIVE

    @property
    def _is_conditional(self) -> bool:
        return len(self.valid) < self.candidates

    @property
    def probability(self) -> float:
        """The probability; NaN where it is not known."""
        if not self.is_known:
            return float("nan")
        whole = float(self.valid.sum()) if self._is_conditional else float(self.candidates)
        return min(1.0, float(self.failed.sum()) / whole)

    def interval(self, confidence: float) -> Interval:
        """Return the interval of the probability; of a quotient from the intervals of both its parts (Bonferroni)."""
        if not self.is_known:
            return Interval(0.0, 1.0)
        if not self._is_conditional:
            return weighted_interval(self.failed, self.candidates, confidence)
        each = 1 - (1 - confidence) / 2
        failed = weighted_interval(self.failed, self.candidates, each)
        valid = weighted_interval(self.valid, self.candidates, each)
        return Interval(failed.low / valid.high, min(1.0, failed.high / valid.low))


def weighted_of(rows: Sequence[Mapping[str, Any]]) -> Weighted:
    """Return the weights of rows of importance sampling; runs that failed count as counterexamples, so that nothing is hidden."""
    failed = [row["weight"] for row in rows if row["status"] in ("counterexample", "failed")]
    valid = [row["weight"] for row in rows if row["status"] != "rejected"]
    return Weighted(np.array(failed), np.array(valid), len(rows))
