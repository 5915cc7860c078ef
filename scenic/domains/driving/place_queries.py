"""Queries of behaviors about places at each step: exact answers, mostly derived from the answer of the last step.

A distance changes by no more than the point has moved. So geometry is looked at only where the answer could have changed.
"""

import math
from typing import Any

from scenic.domains.driving.elements import NetworkElement
from scenic.runtime.shapes.shapes import BoxShape

__all__ = ["InsideWatch", "Nearness"]

_FAR = 1e9
"""A distance in metres beyond all maps."""


class Nearness:
    """The nearness of a moving point to an element, or to a point.

    Args:
        target: an element of the network, a region with polygons, or a vector.

    """

    __slots__ = ("_distance", "_polygon", "_target", "_x", "_y")

    def __init__(self, target: Any) -> None:
        self._polygon = _polygon_of(target)
        self._target: tuple[float, float] | None = None
        if self._polygon is None:
            x, y, *_ = target
            self._target = (float(x), float(y))
        self._x = self._y = _FAR
        self._distance = 0.0

    def closer_than(self, limit: float, point: Any) -> bool:
        """Return whether the distance of a point from the target is less than a limit in metres."""
        x, y, *_ = point
        if self._target is not None:
            return math.hypot(x - self._target[0], y - self._target[1]) < limit
        displacement = math.hypot(x - self._x, y - self._y)
        if self._distance - displacement > limit:
            return False
        if self._distance + displacement < limit:
            return True
        import shapely

        self._x, self._y = x, y
        self._distance = float(shapely.distance(self._polygon, shapely.Point(x, y)))
        return self._distance < limit


def _polygon_of(target: object) -> Any:
    if isinstance(target, NetworkElement):
        return target.polygon
    return getattr(target, "polygons", None)


class InsideWatch:
    """Answers for one object if the whole of it is in one intersection.

    Args:
        agent: the object; its size stays as it is.

    """

    __slots__ = ("_agent", "_found", "_inner", "_network", "_outer", "_room", "_x", "_y")

    def __init__(self, agent: Any) -> None:
        self._agent = agent
        self._network = agent.roadNetwork
        self._inner = min(agent.width, agent.length) / 2
        self._outer = math.hypot(agent.width, agent.length) / 2
        self._x = self._y = _FAR
        self._room = 0.0
        self._found: Any = None

    def __call__(self) -> bool:
        """Return whether it is now."""
        x, y, *_ = self._agent.position
        displacement = math.hypot(x - self._x, y - self._y)
        if self._found is not None:
            if self._room - displacement > self._outer:
                return True
            if self._room + displacement < self._inner:
                return False
        elif displacement < self._room:
            return False
        return self._looked(x, y)

    def _looked(self, x: float, y: float) -> bool:
        """Measure the room around the object: to the border of its intersection, or to the nearest one."""
        import shapely

        self._x, self._y = x, y
        point = shapely.Point(x, y)
        intersection = self._found
        if intersection is None or not shapely.contains_xy(intersection.polygon, x, y):
            intersection = self._network.intersectionAt(self._agent.position)
        self._found = intersection
        if intersection is None:
            region = self._network.intersectionRegion
            polygons = getattr(region, "polygons", None)
            away = _FAR if polygons is None else float(shapely.distance(polygons, point))
            # Lookups find what is within the tolerance, too.
            self._room = away - self._network.tolerance
            return False
        shapely.prepare(intersection.polygon)
        self._room = float(shapely.distance(intersection.polygon.boundary, point))
        if self._room > self._outer:
            return True
        if self._room < self._inner:
            return False
        agent = self._agent
        if not isinstance(agent.shape, BoxShape):
            return bool(intersection.containsObject(agent))
        return bool(shapely.covers(intersection.polygon, shapely.Polygon(self._corners(x, y))))

    def _corners(self, x: float, y: float) -> list[tuple[float, float]]:
        """Return the corners of the object seen from above; it stands upright."""
        agent = self._agent
        sine, cosine = math.sin(agent.heading), math.cos(agent.heading)
        a, b = agent.width / 2, agent.length / 2
        return [
            (x + u * cosine - v * sine, y + u * sine + v * cosine)
            for u, v in ((-a, -b), (a, -b), (a, b), (-a, b))
        ]
