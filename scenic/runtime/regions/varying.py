"""Regions that differ between lanes: each primitive calls the region of a lane, for all lanes that have it."""

from abc import abstractmethod
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from scenic.graph.kinds import Column
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.regions.base import Mask, Points, Region


class VaryingRegion(Region):
    """A region that is one of several, by lane."""

    @abstractmethod
    def drawn(
        self, lanes: int, columns: Sequence[Column]
    ) -> Iterator[tuple[Region, NDArray[np.intp], Sequence[Column]]]:
        """Yield each of the regions with the lanes that draw it and the columns of its parameters there."""

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return self._of_points("contains_points", points, columns, dtype=np.bool_)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return self._of_bodies("contains_bodies", body, lanes, columns)

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return self._of_bodies("meets_bodies", body, lanes, columns)

    def gaps(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return self._of_points("gaps", points, columns)

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return self._of_points("distances", points, columns)

    def orientations(self, points: Points, *columns: Column) -> Column:
        return self._of_points("orientations", points, columns, width=(4,))

    def sizes(self, *columns: Column) -> NDArray[np.float64]:
        lanes = _lanes(*columns)
        result = np.zeros(lanes)
        for option, chosen, mine in self.drawn(lanes, columns):
            result[chosen] = option.sizes(*mine)
        return result

    def _of_points(
        self,
        primitive: str,
        points: Points,
        columns: Sequence[Column],
        *,
        width: tuple[int, ...] = (),
        dtype: type = np.float64,
    ) -> Column:
        """Evaluate a method of the drawn options on points; return an array of the given width by lane."""
        lanes = _lanes(points, *columns)
        points = np.broadcast_to(points, (lanes, 3))
        result: Column = np.zeros((lanes, *width), dtype=dtype)
        for option, lanes_of_option, mine in self.drawn(lanes, columns):
            result[lanes_of_option] = getattr(option, primitive)(points[lanes_of_option], *mine)
        return result

    def _of_bodies(self, primitive: str, body: Body, lanes: int, columns: Sequence[Column]) -> Mask:
        result = np.zeros(lanes, dtype=np.bool_)
        for option, chosen, mine in self.drawn(lanes, columns):
            part = body if len(body) == 1 else body.take(chosen)
            result[chosen] = getattr(option, primitive)(part, len(chosen), *mine)
        return result


def _lanes(*columns: Column) -> int:
    return max(len(column) for column in columns)
