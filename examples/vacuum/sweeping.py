"""The floor that a round robot has passed over."""

from collections.abc import Sequence

from shapely import LineString

__all__ = ["Sweep"]

_EXACT = 1e-3
"""Deviation (metres) up to which a path is simplified before it is buffered."""


class Sweep:
    """The path of a robot's middle, and the area that its disc has swept.

    Args:
        radius: radius of the robot, metres.

    """

    def __init__(self, radius: float) -> None:
        self.radius = radius
        self.path: list[tuple[float, float]] = []

    def pass_over(self, place: Sequence[float]) -> None:
        """Add the present place of the robot's middle, metres."""
        self.path.append((float(place[0]), float(place[1])))

    def area(self) -> float:
        """The swept area, square metres."""
        if len(self.path) < 2:
            return 0.0
        return float(LineString(self.path).simplify(_EXACT).buffer(self.radius).area)
