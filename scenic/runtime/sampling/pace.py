"""How many candidates to try at a time: measured, and without influence on what comes out."""

from dataclasses import dataclass
from typing import Final

_FADING: Final = 0.8
"""Old measurements count less, since costs change with what is sampled."""

_LIKELY_FIXED: Final = 1e-3
_LIKELY_LANE: Final = 5e-6
"""Seconds a round and a lane before anything is measured."""

_ROUND_SECONDS: Final = 2.0
"""Rounds are cut to about this time, so that limits and interrupts are noticed soon."""


@dataclass(frozen=True, slots=True)
class Round:
    """A round: so many scenes, each with so many attempts ahead."""

    scenes: int
    ahead: int


@dataclass(slots=True)
class Pace:
    """Chooses rounds by a fitted cost ``fixed + lane x lanes`` of a round and by the measured acceptance.

    Args:
        most: lanes of a round, at most.

    """

    most: int
    lanes: float = 0.0
    passed: float = 0.0
    _rounds: int = 0
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
            return _LIKELY_FIXED, _LIKELY_LANE
        mean_x, mean_y = self._x / self._weight, self._y / self._weight
        variance = self._xx / self._weight - mean_x * mean_x
        if variance > 1e-2 * mean_x * mean_x:
            slope = (self._xy / self._weight - mean_x * mean_y) / variance
        else:
            slope = 0.5 * mean_y / mean_x  # rounds of one size tell nothing of the two parts
        slope = min(max(slope, 1e-9), mean_y / mean_x)
        return max(mean_y - slope * mean_x, 1e-6), slope

    def scenes_within(self, seconds: float) -> int:
        """How many scenes are found in about that time together; at least one."""
        fixed, lane = self.cost()
        return max(1, int((seconds - fixed) * self.acceptance / lane))

    def choose(self, waiting: int, most: int) -> Round:
        """The round of at most ``most`` lanes that finds scenes at the least expected time each.

        ``waiting`` scenes are being looked for.
        """
        fixed, lane = self.cost()
        most = max(1, min(self.most, most, int((_ROUND_SECONDS - fixed) / lane)))
        rejected = 1 - self.acceptance
        best, price = Round(1, 1), float("inf")
        ahead = 1
        while ahead <= most:
            scenes = min(waiting, most // ahead)
            found = scenes * (1 - rejected**ahead)
            this = (fixed + lane * scenes * ahead) / found if found > 0 else float("inf")
            if this < price or (found <= 0 and price == float("inf")):
                best, price = Round(scenes, ahead), this
            ahead *= 2
        return best
