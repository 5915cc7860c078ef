"""Regions that are another one in each lane: what they hold is asked of that one, in the lanes that have it."""

from abc import abstractmethod
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from scenic.graph.kinds import Column
from scenic.runtime.geometry.collision import Body
from scenic.runtime.regions.base import Mask, Points, Region


class VaryingRegion(Region):
    """A region that is one of several, by lane."""

    @abstractmethod
    def drawn(
        self, lanes: int, columns: Sequence[Column]
    ) -> Iterator[tuple[Region, NDArray[np.intp], Sequence[Column]]]:
        """Each of the regions with the lanes that draw it and the columns of its parameters there."""

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        lanes = _lanes(points, *columns)
        points = np.broadcast_to(points, (lanes, 3))
        result = np.zeros(lanes, dtype=np.bool_)
        for option, chosen, mine in self.drawn(lanes, columns):
            result[chosen] = option.contains_points(points[chosen], *mine)
        return result

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        result = np.zeros(lanes, dtype=np.bool_)
        for option, chosen, mine in self.drawn(lanes, columns):
            part = body if len(body) == 1 else body.take(chosen)
            result[chosen] = option.contains_bodies(part, len(chosen), *mine)
        return result

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        result = np.zeros(lanes, dtype=np.bool_)
        for option, chosen, mine in self.drawn(lanes, columns):
            part = body if len(body) == 1 else body.take(chosen)
            result[chosen] = option.meets_bodies(part, len(chosen), *mine)
        return result

    def gaps(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        lanes = _lanes(points, *columns)
        points = np.broadcast_to(points, (lanes, 3))
        result = np.zeros(lanes)
        for option, chosen, mine in self.drawn(lanes, columns):
            result[chosen] = option.gaps(points[chosen], *mine)
        return result

    def sizes(self, *columns: Column) -> NDArray[np.float64]:
        lanes = _lanes(*columns)
        result = np.zeros(lanes)
        for option, chosen, mine in self.drawn(lanes, columns):
            result[chosen] = option.sizes(*mine)
        return result

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        lanes = _lanes(points, *columns)
        points = np.broadcast_to(points, (lanes, 3))
        result = np.zeros(lanes)
        for option, chosen, mine in self.drawn(lanes, columns):
            result[chosen] = option.distances(points[chosen], *mine)
        return result

    def orientations(self, points: Points, *columns: Column) -> Column:
        lanes = _lanes(points, *columns)
        points = np.broadcast_to(points, (lanes, 3))
        result = np.zeros((lanes, 4))
        for option, chosen, mine in self.drawn(lanes, columns):
            result[chosen] = option.orientations(points[chosen], *mine)
        return result


def _lanes(*columns: Column) -> int:
    return max(len(column) for column in columns)
