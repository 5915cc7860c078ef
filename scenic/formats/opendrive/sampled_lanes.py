"""Roads as arrays: the boundaries of their lanes, sampled so that chords keep to a stated error (sections 3.3 and 3.4)."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.formats.opendrive.curves import Curve, cubic_bend, cubic_values
from scenic.formats.opendrive.records import Cubic, Lane, LaneSection, MapProblem, Road

__all__ = ["MAX_ERROR", "RoadShape", "SectionShape", "road_shape"]

Floats = NDArray[np.float64]

MAX_ERROR: Final = 0.01
"""Metres by which chords may deviate from curves, by default."""

_NEGATIVE: Final = -1e-3
"""Metres; wider negative widths are reported."""

_TORN: Final = 0.1
"""Metres between the pieces of a reference line that are reported, once for a road."""

_SAME: Final = 1e-9

_JUMP: Final = 1e-4
"""Metres of road within which widths change that the file changes at once."""

_MOST: Final = 50_000
"""Samples of a section beyond which a number in the file must be wrong; hours would pass otherwise."""


@dataclass(frozen=True, slots=True, eq=False)
class SectionShape:
    """A lane section of ``m`` lanes, sampled at ``n`` places along the road.

    Attributes:
        record: the section in the file.
        s: distances along the reference line, ``(n,)``.
        reference: points of the reference line, ``(n, 2)``.
        headings: directions of the reference line, anticlockwise from east, ``(n,)``.
        offsets: where the boundaries of lanes are, in metres to the left of the reference line, ``(m + 1, n)``; lane ``i`` of
            ``record.lanes`` lies between boundaries ``i`` and ``i + 1``.
        boundaries: the points of these boundaries, ``(m + 1, n, 2)``.

    """

    record: LaneSection
    s: Floats
    reference: Floats
    headings: Floats
    offsets: Floats
    boundaries: Floats


@dataclass(frozen=True, slots=True, eq=False)
class RoadShape:
    """A road as its sampled sections."""

    record: Road
    sections: tuple[SectionShape, ...]

    @property
    def reference(self) -> Floats:
        """The reference line ``(n, 2)``, without repeated points."""
        return joined([section.reference for section in self.sections])

    @property
    def samples(self) -> Floats:
        """Distance along the reference line, x, y and heading (from east) where it is sampled, ``(n, 4)``; distances ascend."""
        rows = np.concatenate(
            [np.column_stack([section.s, section.reference, section.headings]) for section in self.sections]
        )
        kept: Floats = rows[np.concatenate([[True], np.diff(rows[:, 0]) > 1e-6])]
        return kept


def road_shape(
    road: Road,
    tell: Callable[[MapProblem], None],
    *,
    max_error: float = MAX_ERROR,
    min_points: int = 2,
) -> RoadShape:
    """Sample a road.

    Args:
        road: its record.
        tell: called with what is wrong with its lanes.
        max_error: metres by which chords of the boundaries may deviate from them.
        min_points: samples of each piece of the reference line, at least.

    """
    curve = Curve(road.geometry)
    tears = curve.tears()
    gaps = [index for index in np.flatnonzero(tears > _TORN).tolist() if not road.geometry[index].corrected]
    if gaps:
        message = f"a piece of road {road.id} begins {tears[gaps[0]]:.2f} m from where the one before it ends"
        tell(MapProblem("SC621", message, road.geometry[gaps[0] + 1].line, "torn"))
    ends = [*(section.s for section in road.sections[1:]), road.length]
    shapes = []
    for section, end in zip(road.sections, ends, strict=True):
        s = _samples(road, curve, section, section.s, end, max_error, min_points)
        reference, headings = curve.at(s)
        offsets = _offsets(road, section, s, tell)
        normals = np.stack([-np.sin(headings), np.cos(headings)], axis=-1)
        boundaries = reference + offsets[:, :, None] * normals
        shapes.append(SectionShape(section, s, reference, headings, offsets, boundaries))
    return RoadShape(road, tuple(shapes))


def _samples(
    road: Road,
    curve: Curve,
    section: LaneSection,
    start: float,
    end: float,
    max_error: float,
    min_points: int,
) -> Floats:
    """Places along the road that all lanes of a section share: every break, and enough between them."""
    length = end - start
    breaks = [start, end, *curve.breaks, *(cubic.start for cubic in road.lane_offset)]
    breaks += _jumps(road.lane_offset, max_error)
    for lane in section.lanes:
        breaks += [start + cubic.start for cubic in (*lane.widths, *lane.borders)]
        breaks += [start + place for place in _jumps(lane.widths or lane.borders, max_error)]
    knots = np.unique([place for place in breaks if start <= place <= end])
    keep = np.concatenate([[True], np.diff(knots) > 1e-7])
    knots = knots[keep]
    knots[-1] = end
    reach = sum(max((abs(cubic.a) for cubic in lane.widths), default=0.0) for lane in section.lanes)
    bend = cubic_bend(road.lane_offset, road.length) + sum(
        cubic_bend(lane.widths or lane.borders, length) for lane in section.lanes
    )
    counts = []
    bends = curve.bends()
    pieces = np.array([piece[0] for piece in bends])
    for left, right in pairwise(knots):
        index = max(0, int(np.searchsorted(pieces, left, side="right")) - 1)
        begin, finish, curvature = bends[index]
        total = curvature * (1 + curvature * reach) + bend
        step = np.sqrt(8 * max_error / total) if total > 0 else np.inf
        share = (right - left) / max(finish - begin, _SAME)
        least = np.ceil((min_points - 1) * share) if min_points > 2 else 1
        counts.append(max(1, least, np.ceil((right - left) / step)))
    if not sum(counts) <= _MOST:
        raise ValueError(f"it would take {sum(counts):.3g} points: a length, width or curvature is wrong")
    parts = [
        left + (right - left) * np.arange(int(count)) / int(count)
        for left, right, count in zip(knots[:-1], knots[1:], counts, strict=True)
    ]
    return np.append(np.concatenate(parts), knots[-1]) if parts else knots


def _jumps(cubics: Sequence[Cubic], least: float) -> list[float]:
    """The places just before those at which values change at once, by more than ``least`` metres."""
    if len(cubics) < 2:
        return []
    starts = np.array([cubic.start for cubic in cubics[1:]])
    before = np.array(
        [cubic_values((cubic,), np.array([place]))[0] for cubic, place in zip(cubics, starts, strict=False)]
    )
    after = np.array([cubic.a for cubic in cubics[1:]])
    places: list[float] = (starts[np.abs(after - before) > least] - _JUMP).tolist()
    return places


def _offsets(road: Road, section: LaneSection, s: Floats, tell: Callable[[MapProblem], None]) -> Floats:
    """Return the offsets of all boundaries from the reference line, ``(m + 1, n)``, from left to right."""
    middle = cubic_values(road.lane_offset, s)
    ds = s - section.s
    left = [lane for lane in section.lanes if lane.id > 0]
    right = [lane for lane in section.lanes if lane.id < 0]
    outer, rows = middle, [middle]
    for lane in left[::-1]:
        outer = _outer(road, lane, outer, middle, ds, 1, tell)
        rows.insert(0, outer)
    outer = middle
    for lane in right:
        outer = _outer(road, lane, outer, middle, ds, -1, tell)
        rows.append(outer)
    return np.stack(rows)


def _outer(
    road: Road,
    lane: Lane,
    inner: Floats,
    middle: Floats,
    ds: Floats,
    side: int,
    tell: Callable[[MapProblem], None],
) -> Floats:
    """Return the outer boundary of a lane whose inner one is known."""
    if lane.widths:
        width = cubic_values(lane.widths, ds)
    else:
        width = side * (middle + cubic_values(lane.borders, ds) - inner)
    if float(width.min()) < _NEGATIVE:
        message = f"lane {lane.id} of road {road.id} is {width.min():.3f} m wide: 0 counts"
        tell(MapProblem("SC622", message, lane.line, "negative"))
    return np.asarray(inner + side * np.maximum(width, 0))


def joined(lines: Sequence[Floats]) -> Floats:
    """Lines ``(n, 2)`` end to end, without repeated points."""
    points = np.concatenate(lines)
    if len(points) < 2:
        return points
    keep = np.concatenate([[True], np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-6])
    kept: Floats = points[keep]
    if len(kept) > 1:
        kept[-1] = points[-1]
    return kept
