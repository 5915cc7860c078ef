"""Lines: in the plane, and in space (section 9.2 of the specification)."""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import ScenicTypeError, ScenicValueError
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.geometry.flat.segments import Lines, Segments
from scenic.runtime.ground.context import here, warn
from scenic.runtime.regions import generic
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.fields import VectorField
from scenic.runtime.regions.nearness import SLACK
from scenic.runtime.regions.region_field import RegionField
from scenic.runtime.values.instance_base import Instance
from scenic.runtime.values.lane_methods import over_lanes
from scenic.runtime.values.values import Orientation, Vector, apply, is_random, to_scalar, to_vector

TOUCH: Final = 1e-6
"""Metres within which a point counts as lying on a line of the plane."""


def _point_given(point: Any, *rest: Any) -> tuple[tuple[Any], None] | None:
    """The point of a call; `None` for an instance, which is read on samples."""
    return (
        None if rest or isinstance(point, Instance) else ((to_vector(point, "a point beside a line"),), None)
    )


def _way_given(distance: Any, normalized: Any = False) -> tuple[tuple[Any], bool] | None:
    return (
        None
        if is_random(normalized)
        else ((to_scalar(distance, "a distance along a line"),), bool(normalized))
    )


def drawn_of_lines(lines: Lines, line: NDArray[np.intp], shares: Bounds) -> Bounds:
    """Return bounds ``(m, 3)`` of what numbers ``(m | 1,)`` of the unit interval draw from lines ``(m,)``."""
    length = lines.lengths[line]
    first, last = (
        np.clip(shares.lower * length - SLACK, 0.0, length),
        np.clip(shares.upper * length + SLACK, 0.0, length),
    )
    return Bounds(*lines.boxes_between(line, first, last))


class LineRegion(Region):
    """Fixed line segments, drawn from by length."""

    dimension: float = 1
    draws = 1

    def __init__(self, segments: Segments, tolerance: float, orientation: Any, name: str | None) -> None:
        super().__init__(name=name)
        self.tolerance = tolerance
        self.pieces = segments
        if orientation is True:
            self.orientation: VectorField | None = RegionField(self)
        else:
            self.orientation = orientation
        self.has_orientation = self.orientation is not None

    @property
    def _follows_segments(self) -> bool:
        """Return whether the orientations are the directions of its own segments, not those of a field or of another region."""
        return isinstance(self.orientation, RegionField) and self.orientation.region is self

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        return self.pieces.at(uniforms[0] * self.pieces.length), None

    def draw_points_in(
        self, lower: Points, upper: Points, uniforms: Column, keys: Column, *columns: Column
    ) -> tuple[Points, Mask | None]:
        return self.pieces.at_in(uniforms[0], lower, upper)

    @cached_property
    def _line(self) -> Lines:
        return Lines((self.pieces,))

    def drawn_extent(self, numbers: Sequence[Bounds], *parameters: Bounds | None) -> Bounds | None:
        return drawn_of_lines(self._line, np.zeros(len(numbers[0].lower), dtype=np.intp), numbers[0])

    def orientation_drawn(self, point: Any, numbers: Sequence[object]) -> Any:
        if self._follows_segments:
            return apply(_ALONG, *numbers, payload=self.pieces)
        return super().orientation_drawn(point, numbers)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return np.asarray(self.distances(points) <= self.tolerance)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.zeros(lanes, dtype=np.bool_)

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return self.pieces.nearest(points)[0]

    def closest_points(self, points: Points) -> Points:
        """The points of the line ``(n, 3)`` nearest to points ``(n, 3)``."""
        return self.pieces.nearest(points)[2]

    @over_lanes(Kind.VECTOR, _point_given, lambda _lanes, line, _setting, points: line.closest_points(points))
    def closestPointTo(self, point: Any) -> Vector:
        return Vector.of(
            self.closest_points(np.array([tuple(to_vector(point, "`closestPointTo`"))]))[0].tolist()
        )

    def orientations(self, points: Points, *columns: Column) -> Column:
        return self.pieces.frames[self.pieces.nearest(points)[1]]

    def box(self, *columns: Column) -> tuple[Points, Points]:
        return self.pieces.lower[np.newaxis], self.pieces.upper[np.newaxis]

    def sizes(self, *columns: Column) -> NDArray[np.float64]:
        return np.full(1, self.pieces.length)

    def nearestSegmentTo(self, point: Any) -> tuple[Vector, Vector]:
        """The ends of the segment nearest to a point."""
        index = int(self.pieces.nearest(np.array([tuple(to_vector(point))]))[1][0])
        return Vector.of(self.pieces.starts[index].tolist()), Vector.of(self.pieces.ends[index].tolist())

    @property
    def length(self) -> float:
        """Metres."""
        return self.pieces.length

    @property
    def cumulativeLengths(self) -> list[float]:
        """The lengths up to the end of each segment, in metres."""
        return list(
            itertools.accumulate(
                math.dist(start, end) for start, end in zip(self.pieces.starts, self.pieces.ends, strict=True)
            )
        )


def _along(call: Call, uniforms: Column) -> Column:
    pieces: Segments = call.payload
    return pieces.frames[pieces.number_at(uniforms * pieces.length)]


_ALONG = Operation(
    "direction of a line",
    always(Kind.ORIENTATION),
    _along,
    "The direction of the segment on which a uniform number draws a point; payload the segments.",
)


def _fixed_points(points: Iterable[object], what: str) -> list[tuple[float, float, float]]:
    listed = list(points)
    if is_random(listed):
        raise ScenicTypeError(f"{what} needs fixed points", span=here())
    return [tuple(to_vector(point, what)) for point in listed]


class PathRegion(LineRegion):
    """Line segments in space.

    Args:
        points: the vertices of one chain; or
        polylines: the vertices of several.
        tolerance: metres within which a point counts as lying on the path.
        orientation: a vector field; ``True`` is the direction of the segments (yaw and pitch), ``None`` no orientation.

    """

    def __init__(
        self,
        points: Sequence[Any] | None = None,
        polylines: Sequence[Sequence[Any]] | None = None,
        tolerance: float = 1e-8,
        orientation: Any = True,
        name: str | None = None,
    ) -> None:
        if (points is None) == (polylines is None):
            raise ScenicValueError("`PathRegion` takes either points or polylines", span=here())
        chains = [points] if points is not None else list(polylines or ())
        vertices = [_fixed_points(chain, "`PathRegion`") for chain in chains]
        self.chains = tuple(tuple(chain) for chain in vertices)
        try:
            segments = Segments.of_chains(vertices)
        except ValueError as error:
            raise ScenicValueError(f"`PathRegion`: {error}", span=here()) from error
        super().__init__(segments, tolerance, orientation, name)

    def defaultOrientation(self, point: Any) -> Orientation:
        """The direction of the segment nearest to a point."""
        place = np.array([tuple(to_vector(point))])
        return Orientation.of(self.pieces.frames[self.pieces.nearest(place)[1][0]].tolist())


class PolylineRegion(LineRegion):
    """A chain of line segments in the plane, or several.

    Args:
        points: the vertices of one chain; or
        polyline: a shapely line string, or several.
        orientation: a vector field; ``True`` is the direction of the segments, ``None`` no orientation.

    """

    def __init__(
        self,
        points: Sequence[Any] | None = None,
        polyline: Any = None,
        orientation: Any = True,
        name: str | None = None,
    ) -> None:
        import shapely

        if (points is None) == (polyline is None):
            raise ScenicValueError("`PolylineRegion` takes either points or a polyline", span=here())
        if points is not None:
            vertices = _fixed_points(points, "`PolylineRegion`")
            if any(z != 0 for _, _, z in vertices):
                warn("`PolylineRegion` lies in the plane: the z of its points is dropped")
            if len(vertices) < 2:
                raise ScenicValueError("`PolylineRegion` needs at least two points", span=here())
            chains = [[(x, y, 0.0) for x, y, _ in vertices]]
            self.lineString: Any = shapely.LineString([(x, y) for x, y, _ in vertices])
        else:
            parts = [part for part in getattr(polyline, "geoms", [polyline]) if not part.is_empty]
            if not parts or any(part.geom_type not in ("LineString", "LinearRing") for part in parts):
                raise ScenicValueError("`PolylineRegion` needs a line string that is not empty", span=here())
            chains = [[(x, y, 0.0) for x, y, *_ in part.coords] for part in parts]
            self.lineString = polyline
        self.chains = tuple(tuple(chain) for chain in chains)
        try:
            pieces = Segments.of_chains(chains)
        except ValueError as error:
            raise ScenicValueError(f"`PolylineRegion`: {error}", span=here()) from error
        super().__init__(pieces, TOUCH, orientation, name)

    @property
    def points(self) -> tuple[tuple[float, float, float], ...]:
        """The vertices."""
        return tuple(point for chain in self.chains for point in chain)

    @property
    def segments(self) -> list[tuple[Vector, Vector]]:
        """The ends of each segment."""
        ends = zip(self.pieces.starts.tolist(), self.pieces.ends.tolist(), strict=True)
        return [(Vector.of(start), Vector.of(end)) for start, end in ends]

    def _end(self, point: Any, segment: int) -> Any:
        place = Vector.of(point)
        return generic.oriented_point(place, self._direction(place, segment), by_angles=True)

    def _direction(self, place: Vector, segment: int) -> Orientation:
        """The orientation at a place of a segment."""
        if self._follows_segments:  # where a ring closes, two segments are as near
            return Orientation.of(self.pieces.frames[segment].tolist())
        found: Orientation = Orientation() if self.orientation is None else self.orientation_at(place)
        return found

    @property
    def start(self) -> Any:
        """The first point, with the orientation there; that of the world where the line has none."""
        return self._end(self.pieces.starts[0].tolist(), 0)

    @property
    def end(self) -> Any:
        """The last point, with the orientation there; that of the world where the line has none."""
        return self._end(self.pieces.ends[-1].tolist(), len(self.pieces.starts) - 1)

    def signed_distances(self, points: Points) -> NDArray[np.float64]:
        """Distances ``(n,)`` of points ``(n, 3)`` from the line in metres, negative on the right of it."""
        distance, index, _ = self.pieces.nearest(points)
        start = self.pieces.starts[index]
        along, across = self.pieces.ends[index] - start, points - start
        side = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
        return np.where(side >= 0, distance, -distance)

    @over_lanes(
        Kind.SCALAR, _point_given, lambda _lanes, line, _setting, points: line.signed_distances(points)
    )
    def signedDistanceTo(self, point: Any) -> float:
        """Distance from a point to the line, negative on the right of it (metres); z counts, as in every distance."""
        return float(self.signed_distances(np.array([tuple(to_vector(point))]))[0])

    def points_along(self, ways: NDArray[np.float64], *, normalized: bool = False) -> Points:
        """The points ``(n, 3)`` at distances ``(n,)`` along the line, see `pointAlongBy`."""
        metres = ways * self.length if normalized else ways
        return self.pieces.at(np.where(metres < 0, self.length + metres, metres))

    @over_lanes(
        Kind.VECTOR,
        _way_given,
        lambda _lanes, line, normalized, ways: line.points_along(ways, normalized=normalized),
    )
    def pointAlongBy(self, distance: float, normalized: bool = False) -> Vector:
        """The point at a distance along the line (a share of its length if ``normalized``); from its end if negative."""
        way = np.array([to_scalar(distance, "a distance along a line")])
        return Vector.of(self.points_along(way, normalized=normalized)[0].tolist())

    def projections(self, points: Points) -> Points:
        """The points of the line ``(n, 3)`` nearest to points ``(n, 3)``, as seen from above."""
        flat = np.array(points)
        flat[:, 2] = 0
        return self.pieces.nearest(flat)[2]

    @over_lanes(Kind.VECTOR, _point_given, lambda _lanes, line, _setting, points: line.projections(points))
    def project(self, point: Any, *direction: Any) -> Any:
        """The point of the line nearest to ``point``."""
        if direction:
            return super().project(point, *direction)
        return Vector.of(self.projections(np.array([tuple(to_vector(point))]))[0].tolist())

    @property
    def midpoint(self) -> Vector:
        """The point halfway along the line."""
        return self.pointAlongBy(0.5, normalized=True)

    def reverse(self) -> "PolylineRegion":
        """The same line from its end to its start."""
        import shapely

        parts = [shapely.reverse(part) for part in getattr(self.lineString, "geoms", [self.lineString])]
        return self._made_of(shapely.MultiLineString(parts[::-1]) if len(parts) > 1 else parts[0])

    def substring(self, start: float, end: float, normalized: bool = False) -> "PolylineRegion":
        """The part between two distances along the line (shares of its length if ``normalized``), from their end if negative.

        Raises:
            ScenicValueError: if nothing lies between them, or the line has several parts.

        """
        from shapely.ops import substring

        if len(self.chains) > 1:
            raise ScenicValueError("a line of several parts has no part between two distances", span=here())
        return self._made_of(substring(self.lineString, start, end, normalized=normalized))

    def _made_of(self, line: Any) -> "PolylineRegion":
        """Return a line with the orientation of this one: along its own segments, or that of the field."""
        if line.geom_type == "Point":
            raise ScenicValueError("no part of the line lies between these two distances", span=here())
        return PolylineRegion(polyline=line, orientation=True if self._follows_segments else self.orientation)

    def equallySpacedPoints(self, num: int) -> list[Vector]:
        """So many points from start to end, equally far apart along the line."""
        return [self.pointAlongBy(part, normalized=True) for part in np.linspace(0, 1, num).tolist()]

    def pointsSeparatedBy(self, distance: float) -> list[Vector]:
        """Points from the start on, spaced along the line by a distance in metres."""
        return [self.pointAlongBy(way) for way in np.arange(0, self.length, distance).tolist()]

    def defaultOrientation(self, point: Any) -> float:
        """The heading of the segment nearest to a point."""
        start, end = self.nearestSegmentTo(point)
        heading: float = start.azimuthTo(end)
        return heading

    @staticmethod
    def unionAll(regions: Iterable["PolylineRegion"]) -> "PolylineRegion":
        """Return the union of lines."""
        import shapely

        merged = shapely.union_all([region.lineString for region in regions])
        return PolylineRegion(polyline=merged)

    def __add__(self, other: Any) -> "PolylineRegion":
        if not isinstance(other, PolylineRegion):
            return NotImplemented
        import shapely

        parts = [
            part
            for region in (self, other)
            for part in getattr(region.lineString, "geoms", [region.lineString])
        ]
        return PolylineRegion(polyline=shapely.MultiLineString(parts))

    def __getitem__(self, index: int) -> Vector:
        return Vector.of(self.points[index])

    def __len__(self) -> int:
        return len(self.points)

    def __iter__(self) -> Iterator[Vector]:
        return map(Vector.of, self.points)


__all__ = ["LineRegion", "PathRegion", "PolylineRegion"]
