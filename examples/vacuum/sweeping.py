"""The floor that a round robot has passed over."""

from collections.abc import Sequence

import shapely

__all__ = ["Sweep"]


class Sweep:
    """The area that the disc of a robot has swept, along the way of its middle.

    Args:
        radius: radius of the robot, metres.

    """

    def __init__(self, radius: float) -> None:
        self.radius = radius
        self.path: list[tuple[float, float]] = []
        self._swept: shapely.Geometry = shapely.Polygon()
        self._counted = 0

    def pass_over(self, place: Sequence[float]) -> None:
        """Add the present place of the robot's middle, metres."""
        self.path.append((float(place[0]), float(place[1])))

    def area(self) -> float:
        """The swept area, square metres."""
        # The rest of the path begins where the counted part ends.
        rest = self.path[max(0, self._counted - 1) :]
        line = shapely.LineString(rest) if len(rest) > 1 else shapely.MultiPoint(rest)
        self._swept = self._swept.union(line.buffer(self.radius))
        self._counted = len(self.path)
        return float(self._swept.area)
