"""Number of candidates to try at a time: measured, and without influence on the results."""

import math
from typing import Final

from scenic.dataclass import dataclass

_FADING: Final = 0.8
"""Old measurements count less, since costs change with what is sampled."""

_LIKELY_FIXED: Final = 1e-3
_LIKELY_LANE: Final = 5e-6
"""Seconds a round and a lane before anything is measured."""

_LIKELY_PYTHON: Final = 1e-4
"""The same where code of the program is called in each lane."""

_FIXED_LANES: Final = 200
"""Assumed fixed cost of a round, in lanes, before rounds of several sizes have been measured."""

_LEAST_SHARE: Final = 0.25
"""Lower bound of the fitted cost of a lane, as a share of the cost under the assumed fixed cost of a round."""

_ROUND_SECONDS: Final = 2.0
"""Rounds are cut to about this time, so that limits and interrupts are noticed soon."""

_TRUST: Final = 4
"""Fitted costs are used for rounds up to this factor larger than any measured round."""

_FIRST: Final = 512
"""Lanes of the first round, at most, if it has many attempts at a scene."""

_FIRST_CALLS: Final = 16
"""The same where code of the program is called in each lane: a call may take a tenth of a second."""

_AHEAD: Final = (1, 2, 3, 4, 6, 8, 12, 16)
"""Attempts ahead that are weighed where all rounds to come are looked at."""

_FEW: Final = 0.02
"""So many scenes left, in expectation, count as none."""

_MOST_LEVELS: Final = 64
"""Attempts, at most, within which all scenes but those few have to be found for that."""


@dataclass(frozen=True, slots=True)
class Round:
    """The size of a round: the number of scenes, and of attempts ahead for each."""

    scenes: int
    ahead: int


@dataclass(slots=True)
class Pace:
    """Chooses rounds by a fitted cost ``fixed + lane x lanes`` of a round and by the measured acceptance.

    Args:
        most: lanes of a round, at most.
        calls_code: whether code of the program is called in each lane.

    """

    most: int
    calls_code: bool = False
    lanes: float = 0.0
    passed: float = 0.0
    _rounds: int = 0
    _largest: int = 0
    _weight: float = 0.0
    _x: float = 0.0
    _y: float = 0.0
    _xx: float = 0.0
    _xy: float = 0.0

    def add(self, lanes: int, passed: int, seconds: float) -> None:
        """Take a finished round into account; ``passed`` lanes met every requirement."""
        self.lanes = _FADING * self.lanes + lanes
        self.passed = _FADING * self.passed + passed
        # What the first round made, later ones find.
        fading = 0.0 if self._rounds == 1 else _FADING
        self._rounds += 1
        self._largest = max(self._largest, lanes)
        for name, value in (
            ("_weight", 1.0),
            ("_x", lanes),
            ("_y", seconds),
            ("_xx", lanes * lanes),
            ("_xy", lanes * seconds),
        ):
            setattr(self, name, fading * getattr(self, name) + value)

    @property
    def acceptance(self) -> float:
        """Estimated probability that a candidate meets every requirement; falls while none does."""
        return (self.passed + 0.5) / (self.lanes + 1)

    def cost(self) -> tuple[float, float]:
        """Seconds of a round, and of each of its lanes, by weighted least squares."""
        if self._weight == 0:
            return _LIKELY_FIXED, _LIKELY_PYTHON if self.calls_code else _LIKELY_LANE
        mean_x, mean_y = self._x / self._weight, self._y / self._weight
        variance = self._xx / self._weight - mean_x * mean_x
        if variance > 1e-2 * mean_x * mean_x:
            slope = (self._xy / self._weight - mean_x * mean_y) / variance
        else:
            slope = mean_y / (mean_x + _FIXED_LANES)  # rounds of one size tell nothing of the two parts
        # What is made once is in some rounds' times, and may hide what lanes cost: they are taken to cost a little.
        slope = min(max(slope, _LEAST_SHARE * mean_y / (mean_x + _FIXED_LANES)), mean_y / mean_x)
        return max(mean_y - slope * mean_x, 1e-6), slope

    def scenes_within(self, seconds: float) -> int:
        """Number of scenes that are found in about that time together; at least one."""
        fixed, lane = self.cost()
        return max(1, int((seconds - fixed) * self.acceptance / lane))

    def choose(self, waiting: int, most: int, *, more: bool) -> Round:
        """The round of at most ``most`` lanes with which finding ``waiting`` scenes takes least time.

        ``more`` says whether others will take the places of those that are found. Then what counts is the time for each that
        is found now; otherwise the last ones of them may take as many rounds as all before, and those count, too.
        """
        fixed_cost, lane = self.cost()
        most = max(1, min(self.most, most, int((_ROUND_SECONDS - fixed_cost) / lane)))
        if self.calls_code and not self._rounds:
            most = min(most, _FIRST_CALLS)
        lane_limit = min(most, max(waiting, _FIRST, _TRUST * self._largest))
        rejection_rate = 1 - self.acceptance
        if not more:
            ahead = _until_all_are_found(waiting, lane_limit, fixed_cost, lane, rejection_rate)
            if ahead is not None:
                return Round(waiting, ahead)
        best, price = Round(1, 1), float("inf")
        ahead = 1
        while ahead <= lane_limit:
            scenes = min(waiting, lane_limit // ahead)
            expected_scenes = scenes * (1 - rejection_rate**ahead)
            this = (
                (fixed_cost + lane * scenes * ahead) / expected_scenes
                if expected_scenes > 0
                else float("inf")
            )
            if this < price or (expected_scenes <= 0 and price == float("inf")):
                best, price = Round(scenes, ahead), this
            ahead *= 2
        return best


def _until_all_are_found(waiting: int, most: int, fixed: float, lane: float, rejected: float) -> int | None:
    """The attempts ahead of the first of the rounds that find all scenes in the least expected time.

    By dynamic programming over the attempts that have been made at those which are left. ``None`` where that takes too many,
    or rounds cannot hold all scenes.
    """
    if waiting > most or waiting * rejected**_MOST_LEVELS > _FEW:
        return None
    left = [float(waiting)]
    while left[-1] > _FEW:
        left.append(left[-1] * rejected)
    times = [0.0] * len(left)
    first = 1
    for level in reversed(range(len(left) - 1)):
        scenes = left[level]
        start = fixed * (1 - (1 - scenes / waiting) ** waiting)
        times[level] = math.inf
        for ahead in _AHEAD:
            if ahead > 1 and scenes * ahead > most:
                break
            time = start + lane * scenes * ahead + times[min(level + ahead, len(left) - 1)]
            if time < times[level]:
                times[level], first = time, ahead
    return first
