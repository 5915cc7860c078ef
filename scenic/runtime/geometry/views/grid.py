"""The grid of rays of a view (section 11.3), and the part of it that may meet a target.

Rays stand in rows of one altitude. Row j of V has the altitude ``-v/2 + (j + 1/2) v/V`` and ray i of the H in a row
the azimuth ``-h/2 + (i + 1/2) h/H``, so that rays are spread evenly and none is on the border of the view.
"""

from collections.abc import Iterator
from dataclasses import fields
from typing import Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import expand, pieces
from scenic.runtime.geometry.views.observers import Extents, Views

_TURNS: Final = np.array([-2 * np.pi, 0.0, 2 * np.pi])


@dataclass(frozen=True)
class RayRows:
    """Pieces of rows of rays, an entry for each.

    Attributes:
        lane: whose rays they are, ascending.
        number: which row of the lane's rows that may meet the target, from 0.
        altitude: of the row, radians.
        first: azimuth of the first ray, radians.
        step: from one ray to the next, radians.
        count: how many rays.

    """

    lane: Indices
    number: Indices
    altitude: Floats
    first: Floats
    step: Floats
    count: Indices

    def where(self, chosen: Indices) -> "RayRows":
        """The pieces of these numbers."""
        return RayRows(*(getattr(self, field.name)[chosen] for field in fields(self)))

    def totals(self, lanes: int) -> Indices:
        """Numbers of rays of the lanes, ``(lanes,)``."""
        return np.bincount(self.lane, self.count, lanes).astype(np.intp)

    def thinned(self, across: int, lanes: int) -> "RayRows":
        """About ``across`` rows of ``across`` rays of each lane, evenly spread over all of its rays."""
        most = np.zeros(lanes, dtype=np.intp)
        np.maximum.at(most, self.lane, self.number + 1)
        stride = np.maximum(most // across, 1)[self.lane]
        row_numbers = np.flatnonzero(self.number % stride == stride // 2)
        rows = self.where(row_numbers)
        stride = np.maximum(rows.count // across, 1)
        offset = stride // 2
        return RayRows(
            rows.lane,
            rows.number,
            rows.altitude,
            rows.first + offset * rows.step,
            rows.step * stride,
            (rows.count - offset + stride - 1) // stride,
        )

    def rays(self, most: int) -> Iterator[tuple[Indices, Floats]]:
        """Lanes and directions in the view's frame of all rays, about ``most`` at a time."""
        for part in pieces(self.count, most):
            owner, index = expand(self.count[part])
            azimuth = self.first[part][owner] + index * self.step[part][owner]
            level = np.cos(self.altitude[part])[owner]
            directions = np.empty((len(owner), 3))
            directions[:, 0] = -np.sin(azimuth) * level
            directions[:, 1] = np.cos(azimuth) * level
            directions[:, 2] = np.sin(self.altitude[part])[owner]
            yield self.lane[part][owner], directions


def rows_towards(views: Views, target: Extents, distance: Floats) -> RayRows:
    """The rays of each view's grid whose directions are among those of the target.

    Args:
        views: with a row for each lane.
        target: the directions of the target's box.
        distance: from the camera to the target's position, metres, ``(n,)``.

    """
    window = views.window
    explicit = views.count > 0
    scale = np.where(views.scaling, distance, 1.0)
    by_density = np.degrees(window) * (views.density * scale)[:, None]
    counts = np.maximum(np.ceil(np.where(explicit, views.count, by_density) - 1e-9), 1.0)
    tall = window[:, 1] / counts[:, 1]
    low = np.ceil((target.altitude[:, 0] + window[:, 1] / 2) / tall - 0.5)
    high = np.floor((target.altitude[:, 1] + window[:, 1] / 2) / tall - 0.5)
    low, high = np.maximum(low, 0.0), np.minimum(high, counts[:, 1] - 1)
    lane, number = expand(np.maximum(high - low + 1, 0.0).astype(np.intp))
    altitude = -window[lane, 1] / 2 + (low[lane] + number + 0.5) * tall[lane]
    across = counts[lane, 0]
    columns = np.maximum(np.round(across * np.cos(altitude)), 1.0)
    across = np.where(explicit[lane, 0], across, columns)
    step = window[lane, 0] / across
    # A target behind the observer may be met by both ends of a row: three turns of it are looked at.
    begin, end = (target.azimuth[lane, side, None] + _TURNS for side in (0, 1))
    everywhere = target.around[lane]
    begin[everywhere], end[everywhere] = [np.inf, -np.pi, np.inf], [-np.inf, np.pi, -np.inf]
    start = -window[lane, 0, None] / 2
    with np.errstate(invalid="ignore"):
        first = np.maximum(np.ceil((begin - start) / step[:, None] - 0.5), 0.0)
        last = np.minimum(np.floor((end - start) / step[:, None] - 0.5), across[:, None] - 1)
    piece, turn = np.nonzero(last >= first)
    first, last = first[piece, turn], last[piece, turn]
    return RayRows(
        lane[piece],
        number[piece],
        altitude[piece],
        start[piece, 0] + (first + 0.5) * step[piece],
        step[piece],
        (last - first + 1).astype(np.intp),
    )
