"""The elements at many places at a time, and the direction of traffic there."""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import LinearElement, NetworkElement
from scenic.domains.driving.levels import Levels
from scenic.domains.driving.line_directions import Segments
from scenic.domains.driving.surfaces import frames_of
from scenic.graph import quaternions
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, always, stacking
from scenic.runtime.geometry.flat.cell_index import CellIndex
from scenic.runtime.geometry.ragged import expand
from scenic.runtime.regions.fields import TabulatedField
from scenic.runtime.values.values import Orientation, Random, Vector, apply, is_number, to_vector

__all__ = ["Finder", "RoadDirection"]

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

_RUN = 16
"""Segments of a guide that a circle is drawn around."""
_KEPT: Final = 512
"""Places of which a finder keeps the answers."""


class Finder:
    """Finds elements by place.

    Args:
        elements: the elements, in order of precedence.
        tolerance: metres within which an element counts as being at a place that none holds.
        levels: what lies above each other; ``None`` in the plane, where heights do not count.

    """

    def __init__(
        self, elements: Sequence[NetworkElement], tolerance: float, levels: Levels | None = None
    ) -> None:
        self.elements = tuple(elements)
        self._tolerance = tolerance
        self._levels = levels
        self._known: dict[tuple[float, float, float], NetworkElement | None] = {}

    @cached_property
    def _cells(self) -> CellIndex:
        return CellIndex([element.polygon for element in self.elements])

    @cached_property
    def _tree(self) -> Any:
        import shapely

        return shapely.STRtree([element.polygon for element in self.elements])

    def holding(self, places: Floats) -> Indices:
        """Index of the first element that holds each place ``(n, 2)``; their number where none does."""
        if not self.elements:
            return np.zeros(len(places), dtype=np.intp)
        return self._cells.first_at(places[:, 0], places[:, 1])

    def near(self, places: Floats) -> Indices:
        """As `holding`; where none holds a place, the first one within the tolerance.

        Where roads pass above each other, the heights of places ``(n, 3)`` choose between them.
        """
        import shapely

        indices = self.holding(places)
        if self._levels is not None and places.shape[1] > 2:
            some = np.flatnonzero(self._levels.stacked(places[:, :2]))
            if len(some):
                indices[some] = self._at_level(places[some])
        outside = np.flatnonzero(indices == len(self.elements))
        if len(outside) and self.elements and self._tolerance > 0:
            points = shapely.points(places[outside])
            pairs = self._tree.query(points, predicate="dwithin", distance=self._tolerance)
            np.minimum.at(indices, outside[pairs[0]], pairs[1])
        return indices

    def _at_level(self, points: Floats) -> Indices:
        """Return the index of the first element that contains each point ``(n, 3)`` and is at its level; else of the first that contains it."""
        import shapely

        first_holders = self.holding(points)
        best = np.full(len(points), len(self.elements), dtype=np.intp)
        owner, number = self._tree.query(shapely.points(points[:, :2]), predicate="intersects")
        for element in np.unique(number).tolist():
            mine = owner[number == element]
            ground = self.elements[element].ground
            fits = np.ones(len(mine), dtype=np.bool_) if ground is None else ground.fits(points[mine])
            np.minimum.at(best, mine[fits], element)
        return np.where(best < len(self.elements), best, first_holders)

    def nearest(self, places: Floats) -> Indices:
        """Index of the first element that holds each place, else of the nearest one."""
        import shapely

        found = self.holding(places)
        lost = np.flatnonzero(found == len(self.elements))
        if len(lost):
            pairs = self._tree.query_nearest(shapely.points(places[lost]), all_matches=False)
            found[lost[pairs[0]]] = pairs[1]
        return found

    def at(self, x: float, y: float, z: float = 0.0) -> NetworkElement | None:
        """The element at one place: the first that holds it, else the first within the tolerance."""
        # Programs ask for one place again and again within a step of a simulation, and for things that stand.
        place = x, y, z
        if place not in self._known:
            index = len(self.elements)
            if self._levels is None and self.elements:
                index = self._cells.first_of(x, y)
            if index == len(self.elements):
                (index,) = self.near(np.array([[x, y, z]]))
            if len(self._known) >= _KEPT:
                self._known.clear()
            self._known[place] = self.elements[index] if index < len(self.elements) else None
        return self._known[place]


class RoadDirection(TabulatedField):
    """The direction of traffic: that of the first element that holds a point, and 0 (north) elsewhere.

    Args:
        name: for messages.
        elements: the elements, in order of precedence.
        tolerance: see `Finder`.
        levels: those of a network in space, where directions follow the slope of the roads; ``None`` in the plane.

    """

    divides_backward = True

    def __init__(
        self,
        name: str,
        elements: Sequence[NetworkElement],
        tolerance: float,
        levels: Levels | None = None,
    ) -> None:
        self._finder = Finder(elements, tolerance, levels)
        self._levels = levels
        super().__init__(name, self._value)

    @cached_property
    def _guides(self) -> tuple[tuple[LinearElement, ...], Indices, Indices]:
        """All guides of the elements, and where those of each element begin and how many there are."""
        groups = [tuple(element._guides()) for element in self._finder.elements]
        counts = np.array([len(group) for group in groups], dtype=np.intp)
        starts = np.cumsum(counts) - counts
        return tuple(guide for group in groups for guide in group), starts, counts

    @cached_property
    def _segments(self) -> tuple[Floats, Floats, Floats, Floats, Indices, Indices]:
        """Starts and steps ``(2, k)``, squared lengths and headings of the segments of all guides, and which are those of each."""
        parts = [Segments(guide.line) for guide in self._guides[0]]
        counts = np.array([len(part.starts) for part in parts], dtype=np.intp)
        return (
            np.ascontiguousarray(np.concatenate([part.starts for part in parts]).T),
            np.ascontiguousarray(np.concatenate([part.delta for part in parts]).T),
            np.concatenate([part.square for part in parts]),
            np.concatenate([part.heading for part in parts]),
            np.cumsum(counts) - counts,
            counts,
        )

    def headings(self, points: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Headings at points ``(n, 3)``; every point has one."""
        headings, _, _ = self._found(np.asarray(points))
        return headings, np.ones(len(points), dtype=np.bool_)

    def _found(self, points: Floats) -> tuple[Floats, Indices, Indices]:
        """Headings at points ``(n, 3)``, and which of them lie in some element, and in which of the guides."""
        places = points[:, :2]
        headings = np.zeros(len(places))
        element_numbers = self._finder.near(points if self._levels is not None else places)
        there = np.flatnonzero(element_numbers < len(self._finder.elements))
        guide = there
        if len(there):
            guide = self._guide_at(places[there], element_numbers[there])
            headings[there] = self._along(places[there], guide)
        return headings, there, guide

    def roads_at(self, points: Floats) -> Indices:
        """The number of the road whose direction holds at points ``(n, 3)``; off the roads, that of the nearest element."""
        places = points[:, :2]
        found = self._finder.near(points)
        lost = found == len(self._finder.elements)
        if lost.any():
            found[lost] = self._finder.nearest(places[lost])
        return self._numbers[self._guide_at(places, found)]

    @cached_property
    def _numbers(self) -> Indices:
        """The numbers of the roads of all guides."""
        guides = self._guides[0]
        return np.array([guide.network.road_number(guide._road_uid) for guide in guides], dtype=np.intp)

    def frames(self, points: Floats) -> Floats:
        """Orientations ``(n, 4)`` at points ``(n, 3)``: on a road, pitched and rolled with it."""
        headings, there, guide = self._found(points)
        frames = frames_of(headings)
        if self._levels is not None and len(there):
            frames[there] = self._levels.elevation.frames(
                self._numbers[guide], points[there, :2], headings[there]
            )
        return frames

    def stepped(self, points: Floats, strides: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """As of any field; in space, points keep their height above the road."""
        if self._levels is None:
            return super().stepped(points, strides)
        ahead = np.zeros((len(points), 3))
        ahead[:, 1] = strides
        ends = points + quaternions.rotate(self.frames(points), ahead)
        on_road = self._levels.heights(points)
        above = points[:, 2] - on_road
        lands = self._levels.heights(np.column_stack([ends[:, :2], on_road + (ends - points)[:, 2]]))
        has_height = np.isfinite(above) & np.isfinite(lands)
        ends[has_height, 2] = (lands + above)[has_height]
        return ends, np.ones(len(points), dtype=np.bool_)

    def __getitem__(self, position: Any) -> Any:
        place = to_vector(position, f"field {self.name!r}")
        if self._levels is not None and isinstance(place, Random):
            return apply(_FRAME, place, payload=self)
        return super().__getitem__(place)

    def _guide_at(self, places: Floats, element: Indices) -> Indices:
        """Return the guide that holds each place, the first of its element; else the nearest one."""
        import shapely

        guides, starts, counts = self._guides
        polygons = self._polygons
        result = starts[element].copy()
        several = np.flatnonzero(counts[element] > 1)
        if not len(several):
            return result
        owner, place = expand(counts[element[several]])
        candidate = starts[element[several]][owner] + place
        x, y = places[several][owner].T
        is_inside = shapely.intersects_xy(polygons[candidate], x, y)
        none = len(guides)
        first = np.full(len(several), none, dtype=np.intp)
        np.minimum.at(first, owner[is_inside], candidate[is_inside])
        is_outside = first == none
        if is_outside.any():
            mine = is_outside[owner]
            away = shapely.distance(polygons[candidate[mine]], shapely.points(x[mine], y[mine]))
            order = np.lexsort((candidate[mine], away, owner[mine]))
            owners = owner[mine][order]
            begins = np.flatnonzero(np.concatenate([[True], owners[1:] != owners[:-1]]))
            first[owners[begins]] = candidate[mine][order][begins]
        result[several] = first
        return result

    @cached_property
    def _polygons(self) -> NDArray[np.object_]:
        import shapely

        polygons = np.array([guide.polygon for guide in self._guides[0]], dtype=object)
        shapely.prepare(polygons)
        return polygons

    def _along(self, places: Floats, guide: Indices) -> Floats:
        """Return the headings of the segments of guides that are nearest to places."""
        starts, delta, square, heading, _, _ = self._segments
        result = np.empty(len(places))
        block = 65536
        for begin in range(0, len(places), block):
            mine = guide[begin : begin + block]
            some = places[begin : begin + block]
            owner, segment = self._near_segments(some, mine)
            # Coordinate by coordinate: sums over an axis of two are slow.
            x = some[:, 0].copy()[owner] - starts[0][segment]
            y = some[:, 1].copy()[owner] - starts[1][segment]
            along, up = delta[0][segment], delta[1][segment]
            share = np.clip((x * along + y * up) / square[segment], 0, 1)
            away = (x - share * along) ** 2 + (y - share * up) ** 2
            changes = np.flatnonzero(owner[1:] != owner[:-1]) + 1
            least = np.minimum.reduceat(away, np.concatenate([[0], changes]))
            best = np.flatnonzero(away == least[owner])
            first = np.concatenate([[True], owner[best[1:]] != owner[best[:-1]]])
            result[begin : begin + block] = heading[segment[best[first]]]
        return result

    @cached_property
    def _runs(self) -> tuple[Floats, Floats, Indices, Indices, Indices, Indices]:
        """Runs of up to `_RUN` segments of a guide: centre and radius of a circle around each, where its segments begin and how
        many they are; then where the runs of each guide begin, and how many they are.
        """
        starts, delta, _, _, first, counts = self._segments
        starts, delta = starts.T, delta.T
        runs = -(-counts // _RUN)
        guide, place = expand(runs)
        begin = first[guide] + place * _RUN
        size = np.minimum(counts[guide] - place * _RUN, _RUN)
        owner, step = expand(size)
        segment = begin[owner] + step
        bounds = np.cumsum(size) - size
        ends = starts + delta
        lower = np.minimum.reduceat(np.minimum(starts, ends)[segment], bounds)
        upper = np.maximum.reduceat(np.maximum(starts, ends)[segment], bounds)
        radius = np.hypot(*(upper - lower).T) / 2 + 1e-6  # more than rounding takes away
        return (lower + upper) / 2, radius, begin, size, np.cumsum(runs) - runs, runs

    def _near_segments(self, places: Floats, guide: Indices) -> tuple[Indices, Indices]:
        """Pairs of places and segments of their guides, in order, among them the nearest segments of each place."""
        centre, radius, begin, size, first, runs = self._runs
        owner, place = expand(runs[guide])
        run = first[guide][owner] + place
        away = np.hypot(*(places[owner] - centre[run]).T)
        most = np.minimum.reduceat(away + radius[run], np.cumsum(runs[guide]) - runs[guide])
        near = away - radius[run] <= most[owner]
        owner, run = owner[near], run[near]
        pair, step = expand(size[run])
        return owner[pair], begin[run][pair] + step

    def _value(self, point: Any) -> Any:
        place = np.array([[point.x, point.y, point.z]])
        if self._levels is not None:
            return Orientation.of(self.frames(place)[0].tolist())
        headings, _ = self.headings(place)
        return float(headings[0])

    def followFrom(
        self, position: Any, distance: Any, steps: int | None = None, stepSize: float | None = None
    ) -> Any:
        if steps is None and is_number(distance):
            size = self.defaultStepSize if stepSize is None else stepSize
            steps = max(self.minSteps, math.ceil(abs(distance) / size))
        start = to_vector(position, "`follow ... from`")
        if self._levels is not None and steps is not None and type(start) is Vector and is_number(distance):
            place = np.array([tuple(start)])
            for _ in range(steps):
                place, _ = self.stepped(place, np.full(1, distance / steps))
            return Vector.of(place[0].tolist())
        return super().followFrom(start, distance, steps, stepSize)

    def random_parts(self) -> list[Any]:
        return []

    def sampled(self, sample: Any) -> "RoadDirection":
        return self


def _frames(call: Call, points: Column) -> Column:
    field: RoadDirection = call.payload
    return field.frames(points.reshape(-1, 3)).reshape(*points.shape[:-1], 4)


_FRAME = stacking(
    "direction of roads in space",
    always(Kind.ORIENTATION),
    _frames,
    "The direction of traffic at a point, pitched and rolled with the road; payload the field.",
)
