"""Certainty about visibility: the directions of the target are divided until each part of them is settled.

The rays of a view are a sample: a target may show between them. Here the window of directions in which the target
lies is cut into cells. A cell is settled when no part of the target lies in it within range, or when one convex part of one
occluder hides all of it, nearer than any part of the target there. One ray that gets through, decided in double
precision, proves that the target is seen. What is neither after so many cells stays open: a gap may close without
width, where two occluders touch.
"""

from collections.abc import Sequence
from dataclasses import fields
from enum import IntEnum
from typing import Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.voxels import voxels
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.ragged import expand
from scenic.runtime.geometry.vectors import cross, dot
from scenic.runtime.geometry.views.hits import SeenBodies
from scenic.runtime.geometry.views.observers import CORNERS, DISTANCE_SLACK, Extents, Views
from scenic.runtime.geometry.views.occluders import Occluder
from scenic.runtime.geometry.views.occlusion_proofs import boxes_hidden, shadowed
from scenic.runtime.geometry.views.seen_bodies import SightBounds, bounded

_LANES: Final = 64
"""Lanes looked at together."""

_WIDEST: Final = 0.35
"""Radians that a cell may span at first, so that its directions lie well within half a sphere."""


class Proof(IntEnum):
    """The facts that are proved of a lane."""

    HIDDEN = -1
    OPEN = 0
    SEEN = 1


@dataclass(frozen=True)
class _Cells:
    """Parts of the windows of lanes: bounds of azimuth and altitude, ``(c, 2)`` each."""

    lane: Indices
    azimuth: Floats
    altitude: Floats

    def where(self, chosen: Booleans | Indices) -> "_Cells":
        return _Cells(*(getattr(self, field.name)[chosen] for field in fields(self)))

    def quartered(self) -> "_Cells":
        sides = []
        for bounds in (self.azimuth, self.altitude):
            middle = 0.5 * (bounds[:, 0] + bounds[:, 1])
            sides.append([np.stack([bounds[:, 0], middle], -1), np.stack([middle, bounds[:, 1]], -1)])
        return _Cells(
            np.concatenate([self.lane] * 4),
            np.concatenate([sides[0][0], sides[0][1], sides[0][0], sides[0][1]]),
            np.concatenate([sides[1][0], sides[1][0], sides[1][1], sides[1][1]]),
        )

    def middles(self) -> Floats:
        """Return unit directions in the middles, ``(c, 3)``."""
        return _direction(self.azimuth.mean(axis=1), self.altitude.mean(axis=1))

    def corners(self) -> Floats:
        """Return four unit directions whose conic hull contains the cell, anticlockwise from the lower right: ``(c, 4, 3)``.

        A side of constant altitude is no great circle: the great circle between its ends lies above it where the
        altitude is positive. There, so that it touches from below, the ends' tangent shrinks by the cosine of
        half the side's azimuth; and likewise for the upper side of negative altitude.
        """
        shrink = np.cos(0.5 * (self.azimuth[:, 1] - self.azimuth[:, 0]))
        low, high = np.tan(self.altitude[:, 0]), np.tan(self.altitude[:, 1])
        low = np.arctan(np.where(low > 0, low * shrink, low))
        high = np.arctan(np.where(high < 0, high * shrink, high))
        right, left = self.azimuth[:, 0], self.azimuth[:, 1]
        return np.stack(
            [_direction(*pair) for pair in ((right, low), (right, high), (left, high), (left, low))], axis=1
        )


def prove(
    views: Views, target: Body, occluders: Sequence[Occluder], lanes: int, *, most_cells: int = 4096
) -> npt.NDArray[np.int8]:
    """Return proofs about each observer's sight of the target: a `Proof` for each lane, ``(lanes,)``.

    Unlike `sees_bodies` this does not depend on the observers' ray numbers.

    Args:
        views: the observers.
        target: what they look at.
        occluders: what may hide it; neither the observers themselves nor the target may be among them.
        lanes: the number of lanes.
        most_cells: how many cells of a lane may be open at once before it is given up.

    """
    result = np.zeros(lanes, dtype=np.int8)
    spread = views.spread(lanes)
    for start in range(0, lanes, _LANES):
        part = np.arange(start, min(start + _LANES, lanes))
        result[part] = _prove(spread.take(part), target, occluders, part, most_cells)
    return result


def _prove(
    views: Views, target: Body, occluders: Sequence[Occluder], lanes: Indices, most_cells: int
) -> npt.NDArray[np.int8]:
    bounds = bounded(views, target, occluders, lanes)
    result = np.where(bounds.seen, Proof.SEEN, Proof.HIDDEN).astype(np.int8)
    if len(bounds.left):
        result[bounds.left] = _Division(views, target, occluders, lanes, bounds).decided(most_cells)
    return result


class _Division:
    """The division of the windows of some lanes."""

    def __init__(
        self, views: Views, target: Body, occluders: Sequence[Occluder], lanes: Indices, bounds: SightBounds
    ) -> None:
        self._views = views.take(bounds.left)
        self._count = len(bounds.left)
        self._placed, self._obstacles, self._corners = bounds.surroundings(
            self._views, target, occluders, lanes
        )
        self._cells = _first_cells(self._views, bounds.directions)
        self._boxes = _cover(self._placed, target, self._views, lanes[bounds.left])

    def decided(self, most_cells: int) -> npt.NDArray[np.int8]:
        result = np.full(self._count, Proof.OPEN, dtype=np.int8)
        result[boxes_hidden(self._corners, self._obstacles)] = Proof.HIDDEN
        cells = self._cells
        given_up = np.zeros(self._count, dtype=np.bool_)
        while True:
            cells = cells.where((result[cells.lane] == Proof.OPEN) & ~given_up[cells.lane])
            nearest = self._nearest(cells)
            cells, nearest = cells.where(np.isfinite(nearest)), nearest[np.isfinite(nearest)]
            cells = cells.where(~self._hidden(cells, nearest))
            result[cells.lane[self._through(cells)]] = Proof.SEEN
            counts = np.bincount(cells.lane, minlength=self._count)
            result[(counts == 0) & (result == Proof.OPEN) & ~given_up] = Proof.HIDDEN
            given_up |= counts > most_cells / 4
            if (given_up | (result != Proof.OPEN)).all():
                return result
            cells = cells.quartered()

    def _nearest(self, cells: _Cells) -> Floats:
        """Return the least distance of parts of the target that may be in each cell; infinite where none is in range."""
        corners = cells.corners()
        middle = cells.middles()
        boxes, distance = self._boxes
        result = np.full(len(cells.lane), np.inf)
        planes = [cross(corners[:, k], corners[:, (k + 1) % 4]) for k in range(4)]
        for number in range(boxes.shape[1]):
            corner, apart = boxes[cells.lane, number], distance[cells.lane, number]
            out = (dot(corner, middle[:, None]) < 0).all(axis=1)
            for plane in planes:
                # Outside of a side by more than rounding.
                out |= (dot(corner, plane[:, None]) > 1e-12).all(axis=1)
            out |= apart > self._views.distance[cells.lane] * (1 + DISTANCE_SLACK)
            result = np.where(out, result, np.minimum(result, apart))
        return result

    def _hidden(self, cells: _Cells, nearest: Floats) -> Booleans:
        result = np.zeros(len(cells.lane), dtype=np.bool_)
        corners = cells.corners()
        limits = np.broadcast_to(nearest[:, None], (len(nearest), 4))
        for number, near in enumerate(self._obstacles.lanes):
            cell_numbers = np.flatnonzero(near[cells.lane] & ~result)
            if len(cell_numbers):
                result[cell_numbers] = shadowed(
                    self._obstacles.placed(number),
                    cells.lane[cell_numbers],
                    corners[cell_numbers],
                    limits[cell_numbers],
                )
        return result

    def _through(self, cells: _Cells) -> Indices:
        """Return the cells whose middle ray meets the target, within range, before any occluder."""
        directions = cells.middles()
        distance = self._placed.first(cells.lane, directions, exact=True)
        meets = np.flatnonzero(distance <= self._views.distance[cells.lane] * (1 + DISTANCE_SLACK))
        blocked = self._obstacles.block(cells.lane[meets], directions[meets], distance[meets], exact=True)
        return meets[~blocked]


def _first_cells(views: Views, target: Extents) -> _Cells:
    """Return the parts of the views' windows in which targets lie, in cells that are not too wide."""
    half = 0.5 * views.window
    lanes, azimuths, altitudes = [], [], []
    low = np.maximum(target.altitude[:, 0], -half[:, 1])
    high = np.minimum(target.altitude[:, 1], half[:, 1])
    for turn in (-2 * np.pi, 0.0, 2 * np.pi):
        whole = target.around if turn == 0 else np.zeros(len(low), dtype=np.bool_)
        right = np.where(whole, -half[:, 0], np.maximum(target.azimuth[:, 0] + turn, -half[:, 0]))
        left = np.where(whole, half[:, 0], np.minimum(target.azimuth[:, 1] + turn, half[:, 0]))
        lane = np.flatnonzero((right <= left) & (low <= high) & (whole | ~target.around))
        columns = np.maximum(np.ceil((left - right)[lane] / _WIDEST), 1).astype(np.intp)
        rows = np.maximum(np.ceil((high - low)[lane] / _WIDEST), 1).astype(np.intp)
        owner, index = expand(columns * rows)
        column, row = index // rows[owner], index % rows[owner]
        lane, columns, rows = lane[owner], columns[owner], rows[owner]
        wide, tall = (left - right)[lane] / columns, (high - low)[lane] / rows
        lanes.append(lane)
        azimuths.append(right[lane, None] + (column[:, None] + [0, 1]) * wide[:, None])
        altitudes.append(low[lane, None] + (row[:, None] + [0, 1]) * tall[:, None])
    return _Cells(np.concatenate(lanes), np.concatenate(azimuths), np.concatenate(altitudes))


def _cover(placed: SeenBodies, target: Body, views: Views, lanes: Indices) -> tuple[Floats, Floats]:
    """Return boxes that contain the target: corners in the view's frame ``(n, k, 8, 3)`` and distances ``(n, k)``, metres."""
    covers = [mesh.derived(voxels).cover for mesh in placed.meshes]
    width = max(len(cover) for cover in covers)
    boxes_of_meshes = np.stack([cover[np.minimum(np.arange(width), len(cover) - 1)] for cover in covers])
    boxes = boxes_of_meshes[placed.mesh]  # (n, k, 2, 3)
    low, high = boxes[:, :, 0], boxes[:, :, 1]
    poses = target.poses.take(lanes)
    local = low[:, :, None] + (CORNERS + 0.5) * (high - low)[:, :, None]
    corners = views.to_view(poses.to_world(local))
    size = poses.size[:, None]
    gap = (placed.origin[:, None] - np.clip(placed.origin[:, None], low, high)) * size
    return corners, np.sqrt(gap[..., 0] ** 2 + gap[..., 1] ** 2 + gap[..., 2] ** 2)


def _direction(azimuth: Floats, altitude: Floats) -> Floats:
    level = np.cos(altitude)
    return np.stack([-np.sin(azimuth) * level, np.cos(azimuth) * level, np.sin(altitude)], axis=-1)
