"""Chains of line segments: points by length, and nearest points, over arrays."""

import itertools
from collections.abc import Sequence
from functools import cached_property
from typing import Any, Final, Self

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph import quaternions
from scenic.runtime.geometry.flat.near_boxes import near_boxes, tree_of_boxes
from scenic.runtime.geometry.meshes.nearest import Nearest
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.ragged import choose

_FEW: Final = 96
"""Segments up to which looking at all of them is faster than a tree."""

_SLACK: Final = 1e-9
"""Metres by which boxes are widened in which points are drawn: more than rounding."""

CHUNK: Final = 1 << 20
"""Pairs of points and segments looked at together."""


@dataclass(frozen=True, eq=False)
class Segments:
    """Segments from ``starts`` to ``ends``, each ``(k, 3)``; none has length 0."""

    starts: Floats
    ends: Floats

    @classmethod
    def of_chains(cls, chains: Sequence[Sequence[Sequence[float]]]) -> Self:
        """Return the segments between the vertices of chains; raises ``ValueError`` if there is none."""
        pairs = [(a, b) for chain in chains for a, b in itertools.pairwise(chain) if tuple(a) != tuple(b)]
        if not pairs:
            raise ValueError("a line needs at least two different points")
        ends = np.array(pairs, dtype=np.float64)
        if not np.isfinite(ends).all():
            raise ValueError("a coordinate is not a finite number")
        return cls(np.ascontiguousarray(ends[:, 0]), np.ascontiguousarray(ends[:, 1]))

    @cached_property
    def sums(self) -> Floats:
        """Length of the line up to the end of each segment."""
        along = self.ends - self.starts
        return np.cumsum(np.sqrt((along * along).sum(axis=1)))

    @property
    def length(self) -> float:
        """Metres."""
        return float(self.sums[-1])

    @cached_property
    def lower(self) -> Floats:
        """The lower corner ``(3,)`` of the bounding box."""
        return np.asarray(np.minimum(self.starts, self.ends).min(axis=0))

    @cached_property
    def upper(self) -> Floats:
        """The upper corner ``(3,)`` of the bounding box."""
        return np.asarray(np.maximum(self.starts, self.ends).max(axis=0))

    @cached_property
    def frames(self) -> Floats:
        """Orientations ``(k, 4)`` that look along the segments, without roll."""
        x, y, z = (self.ends - self.starts).T
        yaw, pitch = np.arctan2(-x, y), np.arctan2(z, np.hypot(x, y))
        return quaternions.from_euler(yaw, pitch, np.zeros_like(yaw))

    @cached_property
    def before(self) -> Floats:
        """Length of the line up to the start of each segment."""
        return np.concatenate([[0.0], self.sums[:-1]])

    def number_at(self, ways: Floats) -> Indices:
        """Return the segments ``(n,)`` at lengths ``(n,)`` along the line."""
        return np.minimum(np.searchsorted(self.sums, ways, side="left"), len(self.sums) - 1)

    def at(self, ways: Floats) -> Floats:
        """The points ``(n, 3)`` at lengths ``(n,)`` along the line."""
        chosen = self.number_at(ways)
        before = self.before[chosen]
        part = np.clip((ways - before) / (self.sums[chosen] - before), 0, 1)[:, np.newaxis]
        return np.asarray(self.starts[chosen] * (1 - part) + self.ends[chosen] * part)

    def at_in(self, numbers: Floats, lower: Floats, upper: Floats) -> tuple[Floats, Booleans]:
        """Points ``(n, 3)`` of the parts of the line within boxes ``(n, 3)``, uniform by length, from numbers ``(n,)`` in (0, 1).

        Also tells which boxes the line passes, ``(n,)``.
        """
        owner, number = near_boxes(self._tree, lower, upper)
        start, along = self.starts[number], self.ends[number] - self.starts[number]
        low, high = lower[owner] - _SLACK, upper[owner] + _SLACK
        moving = along != 0
        step = np.where(moving, along, 1.0)
        ends = (low - start) / step, (high - start) / step
        inside = (low <= start) & (start <= high)
        first = np.where(moving, np.minimum(*ends), np.where(inside, -np.inf, np.inf)).max(axis=1)
        last = np.where(moving, np.maximum(*ends), np.where(inside, np.inf, -np.inf)).min(axis=1)
        first, last = np.clip(first, 0.0, 1.0), np.clip(last, 0.0, 1.0)
        length = np.sqrt((along * along).sum(axis=1))
        member, share, there = choose(owner, np.maximum(last - first, 0.0) * length, len(numbers), numbers)
        if not len(owner):
            return np.zeros((len(numbers), 3)), there
        part = (first[member] + share * (last[member] - first[member]))[:, np.newaxis]
        return start[member] + part * along[member], there

    @cached_property
    def _tree(self) -> Any:
        ends = np.stack([self.starts, self.ends])
        return tree_of_boxes(ends.min(axis=0), ends.max(axis=0))

    def nearest(self, points: Floats) -> tuple[Floats, Indices, Floats]:
        """For points ``(n, 3)``: distance ``(n,)``, segment ``(n,)`` and place ``(n, 3)`` of the nearest point of the line.

        Where segments meet, the first of them counts, also where a line closes. Long lines are asked through a tree of boxes.
        """
        if len(self.starts) <= _FEW:
            distance, number, place = self._nearest_of_all(points)
        else:
            distance, place, number = self._index.find(points)
        return distance, self._first_there(points, number), place

    def _first_there(self, points: Floats, number: Indices) -> Indices:
        """Return the first segments that end where these nearest ones ``(n,)`` are nearest to points, if that is at an end.

        Others may be as near only up to rounding, and a tree finds any of them.
        """
        starts = self.starts[number]
        along, offset = self.ends[number] - starts, points - starts
        share = (offset * along).sum(axis=1) / (along * along).sum(axis=1)
        at_start, at_end = (first[number] for first in self._first_at_ends)
        result: Indices = np.where(share <= 0, at_start, np.where(share >= 1, at_end, number))
        return result

    @cached_property
    def _first_at_ends(self) -> tuple[Indices, Indices]:
        """For each segment, the first one with an end where it starts, and the first one with an end where it ends."""
        count = len(self.starts)
        _, where = np.unique(np.concatenate([self.starts, self.ends]), axis=0, return_inverse=True)
        first = np.full(2 * count, count, dtype=np.intp)
        np.minimum.at(first, where.ravel(), np.tile(np.arange(count), 2))
        return first[where.ravel()[:count]], first[where.ravel()[count:]]

    @cached_property
    def _index(self) -> Nearest:
        return Nearest(np.stack([self.starts, self.ends, self.ends], axis=1))

    def _nearest_of_all(self, points: Floats) -> tuple[Floats, Indices, Floats]:
        """Return the same by looking at all segments."""
        distance = np.empty(len(points))
        segment = np.empty(len(points), dtype=np.intp)
        place = np.empty((len(points), 3))
        along = self.ends - self.starts
        squares = (along * along).sum(axis=1)
        step = max(1, CHUNK // len(self.starts))
        for first in range(0, len(points), step):
            part = slice(first, first + step)
            offset = points[part, np.newaxis, :] - self.starts
            share = np.clip((offset * along).sum(axis=2) / squares, 0, 1)
            gap = offset - share[..., np.newaxis] * along
            distances = np.sqrt((gap * gap).sum(axis=2))
            best = distances.argmin(axis=1)
            rows = np.arange(len(best))
            distance[part], segment[part] = distances[rows, best], best
            place[part] = self.starts[best] + share[rows, best, np.newaxis] * along[best]
        return distance, segment, place


__all__ = ["Segments"]


@dataclass(frozen=True, eq=False)
class Lines:
    """Several lines, for questions about parts of many of them at once."""

    parts: tuple[Segments, ...]

    @cached_property
    def lengths(self) -> Floats:
        """Metres, ``(n,)``."""
        return np.array([part.length for part in self.parts])

    @cached_property
    def _arrays(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Of the segments of all lines: starts and ends ``(k, 3)``, lengths of their lines up to these ``(k,)``."""
        columns = zip(*((part.starts, part.ends, part.before, part.sums) for part in self.parts), strict=True)
        starts, ends, before, sums = (np.concatenate(column) for column in columns)
        return starts, ends, before, sums

    @cached_property
    def _first(self) -> Indices:
        """The number of the first segment of each line, and at last that of all segments, ``(n + 1,)``."""
        return np.cumsum([0, *(len(part.starts) for part in self.parts)])

    @cached_property
    def _keys(self) -> Floats:
        """The ends of segments as number of the line plus share of its length, which rise."""
        return np.concatenate([number + part.sums / part.length for number, part in enumerate(self.parts)])

    def _segments_at(self, line: Indices, ways: Floats) -> Indices:
        number = np.searchsorted(self._keys, line + ways / self.lengths[line], side="left")
        return np.clip(number, self._first[line], self._first[line + 1] - 1)

    def boxes_between(self, line: Indices, first: Floats, last: Floats) -> tuple[Floats, Floats]:
        """Return the corners ``(m, 3)`` of boxes around the parts of lines ``(m,)`` between lengths ``(m,)`` along them."""
        starts, ends, before, sums = self._arrays
        runs = np.stack([self._segments_at(line, first), self._segments_at(line, last)], axis=1)
        part = np.clip((np.stack([first, last], axis=1) - before[runs]) / (sums[runs] - before[runs]), 0, 1)[
            ..., np.newaxis
        ]
        points = starts[runs] * (1 - part) + ends[runs] * part
        lower, upper = points.min(axis=1), points.max(axis=1)
        several = np.flatnonzero(runs[:, 0] < runs[:, 1])
        if len(several):
            # Between a segment and the next one lie the end of the first and the start of the other.
            after = np.concatenate([starts[1:], ends[-1:]])
            places = runs[several].ravel()
            for corner, extreme in ((lower, np.minimum), (upper, np.maximum)):
                corners_between = extreme.reduceat(extreme(ends, after), places)[::2]
                corner[several] = extreme(corner[several], corners_between)
        return lower, upper
