"""Enumerations of the driving domain."""

import math
from enum import Enum, auto
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["ManeuverType", "VehicleType"]

_STRAIGHT: Final = math.radians(20)


class VehicleType(Enum):
    """A kind of road users."""

    CAR = auto()
    BICYCLE = auto()
    PEDESTRIAN = auto()


class ManeuverType(Enum):
    """A continuation at the end of a lane."""

    STRAIGHT = auto()
    LEFT_TURN = auto()
    RIGHT_TURN = auto()
    U_TURN = auto()

    @staticmethod
    def guessTypeFromLanes(
        start: Any, end: Any, connecting: Any, turnThreshold: float = _STRAIGHT
    ) -> "ManeuverType":
        """Return the type of the maneuver from lane ``start`` over lane ``connecting`` (perhaps ``None``) to lane ``end``.

        ``turnThreshold`` is the angle in radians from which on it counts as a turn.
        """
        if connecting is None:
            return ManeuverType.STRAIGHT
        if start.road is end.road:
            return ManeuverType.U_TURN
        turn = turned(connecting.line)
        if turn >= turnThreshold:
            return ManeuverType.LEFT_TURN
        return ManeuverType.RIGHT_TURN if turn <= -turnThreshold else ManeuverType.STRAIGHT


def turned(line: NDArray[np.float64]) -> float:
    """Return the angle by which a line ``(n, 2)`` turns from its first to its last segment, accumulated, anticlockwise."""
    steps = np.diff(line, axis=0)
    ways = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    return float(ways[-1] - ways[0])
