"""The surfaces of roads in space: the profile of the reference line, tilted by superelevation and crossfall, and shaped across (section 3.6).

All roads of a map are tables, so that many points on different roads are computed at once.
"""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.formats.opendrive.records import Cubic, LateralShape
from scenic.graph import quaternions

__all__ = ["Elevation", "RoadHeight"]

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

_APART: Final = 1e7
"""Metres by which the tables place one road behind another: more than any road is long."""
_ROUNDS: Final = 4
"""Steps of Newton's method, from a guess that is off by centimetres."""
_CURLED: Final = 0.05
"""The least factor by which lengths shrink on the inner side of a curve; beyond it, roads fold over themselves."""


@dataclass(frozen=True, slots=True, eq=False)
class RoadHeight:
    """The height of one road.

    Attributes:
        uid: the road's.
        samples: places of its reference line, ``(n, 4)``: distance along it, x, y, and heading anticlockwise from east.
        profile: height of the reference line.
        tilt: superelevation in radians, positive where the right side is lower.
        falls: crossfall of the left and of the right side in radians, positive where a side falls outwards.
        shapes: what is added to that across the road, in order of their places along it.

    """

    uid: str
    samples: Floats
    profile: tuple[Cubic, ...]
    tilt: tuple[Cubic, ...]
    falls: tuple[tuple[Cubic, ...], tuple[Cubic, ...]] = ((), ())
    shapes: tuple[LateralShape, ...] = ()


class Elevation:
    """The surfaces of all roads of a map; roads are numbered in the order given.

    Args:
        roads: the roads.

    """

    def __init__(self, roads: Sequence[RoadHeight]) -> None:
        self.roads = tuple(roads)

    @cached_property
    def numbers(self) -> dict[str, int]:
        """The number of each road, by its ``uid``."""
        return {road.uid: number for number, road in enumerate(self.roads)}

    @cached_property
    def is_level(self) -> bool:
        """Return whether all roads are level, at height 0."""
        cubics = [
            cubic
            for road in self.roads
            for cubics in (road.profile, road.tilt, *road.falls, *(shape.heights for shape in road.shapes))
            for cubic in cubics
        ]
        return not any(cubic.a or cubic.b or cubic.c or cubic.d for cubic in cubics)

    @cached_property
    def _profile(self) -> "_Cubics":
        return _Cubics([road.profile for road in self.roads])

    @cached_property
    def _tilts(self) -> "tuple[_Cubics, _Cubics, _Cubics]":
        """Superelevation, and crossfall on the left and on the right."""
        return (
            _Cubics([road.tilt for road in self.roads]),
            _Cubics([road.falls[0] for road in self.roads]),
            _Cubics([road.falls[1] for road in self.roads]),
        )

    @cached_property
    def _shapes(self) -> "_Shapes":
        return _Shapes([road.shapes for road in self.roads])

    @cached_property
    def _lines(self) -> "_Lines":
        return _Lines([road.samples for road in self.roads])

    def heights(self, roads: Indices, places: Floats) -> Floats:
        """Heights ``(n,)`` in metres of the surfaces of roads ``(n,)`` at places ``(n, 2)``, on the road or beside it."""
        s, t, _, _ = self._lines.project(roads, places)
        return self._heights(roads, s, t)

    def _heights(self, roads: Indices, s: Floats, t: Floats) -> Floats:
        return (
            self._profile.values(roads, s)
            + t * self._lean(roads, s, t)[0]
            + self._shapes.heights(roads, s, t)[0]
        )

    def gradients(self, roads: Indices, places: Floats) -> Floats:
        """By how much surfaces rise towards east and north, ``(n, 2)``; see `heights`."""
        return self._gradients(roads, *self._lines.project(roads, places))

    def heights_and_gradients(self, roads: Indices, places: Floats) -> tuple[Floats, Floats]:
        """`heights` and `gradients` at once."""
        heights = self._level_heights[roads]
        gradients = np.zeros((len(roads), 2))
        # Most roads are level, and it takes long to find out where on a road a place is.
        some = np.flatnonzero(np.isnan(heights))
        if len(some):
            projected = self._lines.project(roads[some], places[some])
            heights[some] = self._heights(roads[some], *projected[:2])
            gradients[some] = self._gradients(roads[some], *projected)
        return heights, gradients

    @cached_property
    def _level_heights(self) -> Floats:
        """The heights of roads that are level, NaN of others."""
        return np.array([_level_height(road) for road in self.roads])

    def _gradients(self, roads: Indices, s: Floats, t: Floats, heading: Floats, bend: Floats) -> Floats:
        lean, change = self._lean(roads, s, t)
        _, along, across = self._shapes.heights(roads, s, t)
        lean = lean + across
        rise = self._profile.slopes(roads, s) + t * change + along
        rise = rise / np.maximum(1 - bend * t, _CURLED)
        cos, sin = np.cos(heading), np.sin(heading)
        return np.stack([rise * cos - lean * sin, rise * sin + lean * cos], axis=-1)

    def frames(self, roads: Indices, places: Floats, headings: Floats) -> Floats:
        """Orientations ``(n, 4)`` of things that stand on surfaces and face headings ``(n,)``, anticlockwise from north."""
        return frames_on(self.gradients(roads, places), headings)

    def _lean(self, roads: Indices, s: Floats, t: Floats) -> tuple[Floats, Floats]:
        """Return the slope across the road on the side where a point is, towards the left, and how it changes along the road."""
        tilt, *falls = self._tilts
        lean, change = np.zeros(len(s)), np.zeros(len(s))
        for table, sign in (
            (tilt, 1.0),
            (falls[0], np.where(t > 0, -1.0, 0.0)),
            (falls[1], np.where(t < 0, 1.0, 0.0)),
        ):
            if table.is_zero:
                continue
            slope = np.tan(table.values(roads, s))
            lean += sign * slope
            change += sign * (1 + slope * slope) * table.slopes(roads, s)
        return lean, change

    def bounds(self, road: int, reach: float) -> tuple[float, float]:
        """Return the least and the greatest height of a road within ``reach`` metres of its reference line."""
        end = float(self.roads[road].samples[-1, 0])
        low, high = self._profile.bounds(road, end)
        lean = sum(
            np.tan(min(max(map(abs, table.bounds(road, end))), 1.5))
            for table in self._tilts
            if not table.is_zero
        )
        least, most = self._shapes.bounds(road, reach)
        return low - reach * float(lean) + least, high + reach * float(lean) + most

    def reach(self, road: int, places: Floats) -> float:
        """Upper bounds of the distances of places ``(n, 2)`` from the reference line of a road, in metres."""
        if self._shapes.is_zero and all(table.is_zero for table in self._tilts):
            return 0.0
        return float(np.abs(self._lines.project(np.full(len(places), road), places)[1]).max(initial=0.0))


def _level_height(road: RoadHeight) -> float:
    """Return the height of a road that is level and even, NaN of another one."""
    slopes = [(cubic.b, cubic.c, cubic.d) for cubic in road.profile]
    leans = [(cubic.a, cubic.b, cubic.c, cubic.d) for cubic in (*road.tilt, *road.falls[0], *road.falls[1])]
    heights = {cubic.a for cubic in road.profile} or {0.0}
    is_level = (
        len(heights) == 1 and not any(map(any, slopes)) and not any(map(any, leans)) and not road.shapes
    )
    return heights.pop() if is_level else math.nan


class _Cubics:
    """Piecewise cubics of all roads; constant before the first piece, and 0 on roads without any."""

    def __init__(self, by_road: Sequence[Sequence[Cubic]]) -> None:
        rows, starts = [], []
        for number, cubics in enumerate(by_road):
            for cubic in cubics or (Cubic(0.0, 0.0, 0.0, 0.0, 0.0),):
                rows.append((cubic.start, cubic.a, cubic.b, cubic.c, cubic.d))
                starts.append(number)
        self._table = np.array(rows).reshape(-1, 5)
        self._road = np.array(starts, dtype=np.intp)
        self._first = np.searchsorted(self._road, np.arange(len(by_road)))
        self._keys = self._road * _APART + self._table[:, 0]
        self.is_zero = not self._table[:, 1:].any()

    def _at(self, roads: Indices, s: Floats) -> tuple[Floats, Floats]:
        found = np.searchsorted(self._keys, roads * _APART + s, side="right") - 1
        index = np.maximum(found, self._first[roads])
        rows = self._table[index]
        ds = s - rows[:, 0]
        rows[ds < 0, 2:] = 0.0
        return rows[:, 1:].T, np.maximum(ds, 0.0)

    def values(self, roads: Indices, s: Floats) -> Floats:
        """Return the values ``(n,)`` on roads ``(n,)`` at distances ``(n,)`` along them."""
        (a, b, c, d), ds = self._at(roads, s)
        return np.asarray(a + ds * (b + ds * (c + ds * d)))

    def slopes(self, roads: Indices, s: Floats) -> Floats:
        """Return the derivatives ``(n,)`` of `values`."""
        (_, b, c, d), ds = self._at(roads, s)
        return np.asarray(b + ds * (2 * c + 3 * ds * d))

    def bounds(self, road: int, end: float) -> tuple[float, float]:
        """Return the least and the greatest value on a road that is ``end`` metres long."""
        mine = self._table[self._road == road]
        lows, highs = [], []
        for (start, a, b, c, d), stop in zip(mine, [*mine[1:, 0], end], strict=True):
            width = max(stop - start, 0.0)
            turns = np.roots([3 * d, 2 * c, b])
            inner = [float(turn.real) for turn in turns if abs(turn.imag) < 1e-9 and 0 < turn.real < width]
            values = [a + x * (b + x * (c + x * d)) for x in (0.0, width, *inner)]
            lows.append(min(values))
            highs.append(max(values))
        return float(min(lows)), float(max(highs))


class _Shapes:
    """The shapes of all roads across; between the places where they are given, heights go over evenly, along equal distances aside."""

    def __init__(self, by_road: Sequence[Sequence[LateralShape]]) -> None:
        shapes = [each or (LateralShape(0.0, ()),) for each in by_road]
        counts = np.array([len(each) for each in shapes], dtype=np.intp)
        self._places = np.array([shape.s for each in shapes for shape in each])
        self._keys = self._places + np.repeat(np.arange(len(shapes)), counts) * _APART
        self._first = np.cumsum(counts) - counts
        self._last = self._first + counts - 1
        self._cubics = _Cubics([shape.heights for each in shapes for shape in each])
        self.is_zero = self._cubics.is_zero

    def heights(self, roads: Indices, s: Floats, t: Floats) -> tuple[Floats, Floats, Floats]:
        """Return heights ``(n,)`` on roads ``(n,)`` at distances along and to the left of them, and how they change with each."""
        if self.is_zero:
            nothing = np.zeros(len(s))
            return nothing, nothing, nothing
        places = np.searchsorted(self._keys, roads * _APART + s, side="right") - 1
        before = np.clip(places, self._first[roads], self._last[roads])
        after = np.minimum(before + 1, self._last[roads])
        length = self._places[after] - self._places[before]
        share = np.clip((s - self._places[before]) / np.where(length > 0, length, 1.0), 0.0, 1.0)
        one, two = self._cubics.values(before, t), self._cubics.values(after, t)
        inside = (length > 0) & (s >= self._places[before])
        along = np.where(inside, (two - one) / np.where(length > 0, length, 1.0), 0.0)
        across = (1 - share) * self._cubics.slopes(before, t) + share * self._cubics.slopes(after, t)
        return one + share * (two - one), along, across

    def bounds(self, road: int, reach: float) -> tuple[float, float]:
        """Return the least and the greatest height within ``reach`` metres of the reference line of a road."""
        if self.is_zero:
            return 0.0, 0.0
        ends = [self._cubics.bounds(shape, reach) for shape in range(self._first[road], self._last[road] + 1)]
        return min(low for low, _ in ends), max(high for _, high in ends)


class _Lines:
    """The reference lines of all roads; between their samples, cubics with the headings of the samples."""

    def __init__(self, samples: Sequence[Floats]) -> None:
        import shapely

        counts = np.array([len(rows) for rows in samples], dtype=np.intp)
        self._s, x, y, headings = np.concatenate(samples).T
        self._points = np.array([x, y])
        self._directions = np.array([np.cos(headings), np.sin(headings)])
        self._first = np.cumsum(counts) - counts
        self._last = self._first + counts - 2  # the last segment of each road
        self._lines = np.array([shapely.LineString(rows[:, 1:3]) for rows in samples], dtype=object)
        steps = np.hypot(np.diff(x, append=0.0), np.diff(y, append=0.0))
        chords = [
            np.concatenate([[0.0], np.cumsum(steps[first : first + count - 1])])
            for first, count in zip(self._first, counts, strict=True)
        ]
        self._chord = np.concatenate(chords)
        self._keys = self._chord + np.repeat(np.arange(len(samples)), counts) * _APART

    def project(self, roads: Indices, places: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """The coordinates of places ``(n, 2)`` on roads ``(n,)``.

        Gives the distance along the reference line, the distance to its left, and heading (from east) and curvature of the line
        there, ``(n,)`` each.
        """
        import shapely

        along = shapely.line_locate_point(self._lines[roads], shapely.points(places))
        first, last = self._first[roads], self._last[roads]
        index = np.searchsorted(self._keys, roads * _APART + along, side="right") - 1
        index = np.minimum(np.maximum(index, first), last)
        chords, length = self._chord[index], self._s[index + 1] - self._s[index]
        share = (along - chords) / np.maximum(self._chord[index + 1] - chords, 1e-12)
        # A place beside a bend may belong to the neighbour of the nearest segment: its cubic goes on a little.
        least = np.where(index == first, 0.0, -0.5)
        most = np.where(index == last, 1.0, 1.5)
        curve = _Hermite(
            self._points[:, index],
            self._points[:, index + 1],
            length * self._directions[:, index],
            length * self._directions[:, index + 1],
        )
        goals = places.T
        for _ in range(_ROUNDS):
            derivatives, seconds = curve.derivatives(share)
            off = curve.points(share) - goals
            square = _dot(derivatives, derivatives)
            across = off * seconds
            slope = square + across[0] + across[1]
            share = share - _dot(off, derivatives) / np.maximum(slope, _CURLED * square)
            share = np.minimum(np.maximum(share, least), most)
        (px, py), ((dx, dy), (ddx, ddy)) = curve.points(share), curve.derivatives(share)
        speed = np.hypot(dx, dy)
        left = (dx * (goals[1] - py) - dy * (goals[0] - px)) / speed
        bend = (dx * ddy - dy * ddx) / speed**3
        return self._s[index] + share * length, left, np.arctan2(dy, dx), bend


def _dot(one: Floats, other: Floats) -> Floats:
    """Return the dot products ``(n,)`` of columns of two arrays ``(2, n)``."""
    products = one * other
    result: Floats = products[0] + products[1]
    return result


class _Hermite:
    """Cubic curves from points ``(2, n)`` to others, with derivatives ``(2, n)`` at their ends."""

    __slots__ = ("_cubic", "_first", "_point", "_square", "_twice")

    def __init__(self, begin: Floats, end: Floats, first: Floats, last: Floats) -> None:
        self._point, self._first = begin, first
        self._square = 3 * (end - begin) - 2 * first - last
        self._twice = 2 * self._square
        self._cubic = 2 * (begin - end) + first + last

    def points(self, share: Floats) -> Floats:
        """Return the points ``(2, n)`` at shares ``(n,)`` of the curves."""
        result: Floats = self._point + share * (self._first + share * (self._square + share * self._cubic))
        return result

    def derivatives(self, share: Floats) -> tuple[Floats, Floats]:
        """Return first and second derivatives ``(2, n)``; see `points`."""
        first: Floats = self._first + share * (self._twice + 3 * share * self._cubic)
        return first, self._twice + 6 * share * self._cubic


def frames_on(gradients: Floats, headings: Floats) -> Floats:
    """Orientations ``(n, 4)`` of things on slopes ``(n, 2)`` towards east and north that face headings ``(n,)``."""
    cos, sin = np.cos(headings), np.sin(headings)
    pitch = np.arctan(gradients[:, 1] * cos - gradients[:, 0] * sin)
    roll = -np.arctan((gradients[:, 0] * cos + gradients[:, 1] * sin) * np.cos(pitch))
    return quaternions.from_euler(headings, pitch, roll)
