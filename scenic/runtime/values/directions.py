"""The four directions of an oriented point, by the bearing of a place: the heading of the line to it, relative to its own."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass

__all__ = ["DIRECTIONS", "Direction"]

_BORDER: Final = math.radians(0.01)
"""A place within this angle of the border between two directions lies in neither, in radians."""


@dataclass(frozen=True, slots=True)
class Direction:
    """The bearings of a direction, in radians: those greater than ``least`` and less than ``most``.

    ``either_side`` says that it is the size of a bearing that is compared.
    """

    least: float
    most: float
    either_side: bool = False

    def margin(self, bearing: float) -> float:
        """Return how far inside the direction a bearing lies, both in radians; negative outside."""
        size = abs(bearing) if self.either_side else bearing
        return min(size - self.least, self.most - size)


DIRECTIONS: Final[Mapping[str, Direction]] = MappingProxyType(
    {
        "ahead of": Direction(-math.inf, math.pi / 2 - _BORDER, either_side=True),
        "behind": Direction(math.pi / 2 + _BORDER, math.inf, either_side=True),
        "left of": Direction(_BORDER, math.pi),
        "right of": Direction(-math.pi, -_BORDER),
    }
)
"""Each direction by the words of its operator."""
