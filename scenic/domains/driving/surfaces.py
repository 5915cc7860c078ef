"""Regions of a road network that may be surfaces in space: areas and lines with the height of the roads (section 3.6).

In the plane, where they have no ground, they are the ordinary regions.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.levels import Ground
from scenic.graph import quaternions
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.regions.base import Mask, Points
from scenic.runtime.regions.flat import Flat, meets_flat
from scenic.runtime.regions.lines import PolylineRegion
from scenic.runtime.regions.planar import PolygonalRegion
from scenic.runtime.regions.scalar_regions import Single
from scenic.runtime.values.frozen import Frozen
from scenic.runtime.values.values import Orientation, Vector, apply, to_vector

__all__ = ["GroundedLine", "Surface", "frames_of"]

Floats = NDArray[np.float64]


def frames_of(headings: Floats) -> Floats:
    """Return orientations ``(n, 4)`` that face headings ``(n,)``, anticlockwise from north, on level ground."""
    frames = np.zeros((len(headings), 4))
    frames[:, 2], frames[:, 3] = np.sin(headings / 2), np.cos(headings / 2)
    return frames


class Surface(PolygonalRegion):
    """An area of a road network: of the plane, or a surface where it has ``ground``.

    As a container a surface holds what is above and below it, as a region of the plane does; but where another road passes
    there, each thing belongs to the nearer one.
    """

    ground: Ground | None = None
    """The surface; ``None`` in the plane."""

    @property
    def has_closed_form(self) -> bool:  # type: ignore[override] # only in the plane
        """Return whether it lies in the plane."""
        return self.ground is None

    def single(self) -> Single | None:
        return super().single() if self.ground is None else None

    def heights_at(self, points: Points, *columns: Column) -> Column:
        return super().heights_at(points, *columns) if self.ground is None else self.ground.heights(points)

    def _raised(self, points: Points) -> Points:
        """Points moved onto the surface."""
        if self.ground is not None:
            points = np.array(points)
            points[:, 2] = self.ground.heights(points)
        return points

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        points, known = super().draw_points(uniforms, keys, *columns)
        return self._raised(points), known

    def drawn_extent(self, numbers: Sequence[Bounds], *parameters: Bounds | None) -> Bounds | None:
        found = super().drawn_extent(numbers, *parameters)
        if self.ground is not None and found is not None:
            found.lower[:, 2], found.upper[:, 2] = self.ground.bounds
        return found

    def box(self, *columns: Column) -> tuple[Points, Points]:
        lower, upper = super().box(*columns)
        if self.ground is not None:
            lower[:, 2], upper[:, 2] = self.ground.bounds
        return lower, upper

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        inside = super().contains_points(points, *columns)
        if self.ground is not None:
            some = np.flatnonzero(inside)
            inside[some] = self.ground.fits(points[some])
        return inside

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        inside = super().contains_bodies(body, lanes, *columns)
        if self.ground is not None:
            inside = inside & self.ground.fits(np.broadcast_to(body.poses.position, (lanes, 3)))
        return inside

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        if self.ground is None:
            return super().meets_bodies(body, lanes, *columns)
        met = meets_flat(self, body, lanes, columns, None)
        return met & self.ground.fits(np.broadcast_to(body.poses.position, (lanes, 3)))

    def from_above(self, *columns: Column) -> Flat:
        flat = super().from_above(*columns)
        return flat if self.ground is None else Flat(flat.geometries, None)

    def distances(self, points: Points, *columns: Column) -> Column:
        """Return the distances as seen from above; for a point on another level, the height between counts, too."""
        if self.ground is None:
            return super().distances(points, *columns)
        away = self.beside(points, *columns)
        some = np.flatnonzero(self.ground.may_miss(points))
        if len(some):
            points = points[some]
            away[some] = np.hypot(away[some], self.ground.clearances(points, self.nearest(points, *columns)))
        return away

    def closestPointTo(self, point: Any) -> Vector:
        place = super().closestPointTo(point)
        return Vector.of(self._raised(np.array([tuple(place)]))[0].tolist())

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        """Project a point vertically onto the surface; a point beside it lands nowhere."""
        if self.ground is None:
            return super().project(point, direction)
        place = apply(_LAND, to_vector(point), payload=self)
        return place, self.orientation_at(place)


def _land(call: Call, points: Points) -> Column:
    surface: Surface = call.payload
    call.reject(~surface.outline.contains(points[:, 0], points[:, 1]))
    return surface._raised(points)


_LAND = Operation(
    "surface projection",
    always(Kind.VECTOR),
    _land,
    "A point of a surface; the candidate is rejected where it lies beside it. Payload the surface.",
    rejects=True,
    missing="place to land on",
)


class GroundedLine(Frozen, PolylineRegion):
    """A line on the surface of roads; lengths and directions are those seen from above.

    Args:
        line: the line in the plane: its vertices, or shapely's.
        ground: the surface on which it lies.

    """

    has_closed_form = False

    def __init__(
        self, line: Any, ground: Ground, *, orientation: Any = True, name: str | None = None
    ) -> None:
        self.ground = ground
        super().__init__(polyline=line, orientation=orientation, name=name)

    def _raised(self, points: Points) -> Points:
        points = np.array(points)
        points[:, 2] = self.ground.heights(points)
        return points

    @cached_property
    def _heights(self) -> list[float]:
        """The heights of the vertices."""
        vertices = np.array([point for chain in self.chains for point in chain])
        heights: list[float] = self.ground.heights(vertices).tolist()
        return heights

    @property
    def points(self) -> tuple[tuple[float, float, float], ...]:
        """The vertices."""
        flat = (point for chain in self.chains for point in chain)
        return tuple((x, y, z) for (x, y, _), z in zip(flat, self._heights, strict=True))

    @property
    def segments(self) -> list[tuple[Vector, Vector]]:
        """The ends of each segment."""
        ends = (self._raised(self.pieces.starts).tolist(), self._raised(self.pieces.ends).tolist())
        return [(Vector.of(start), Vector.of(end)) for start, end in zip(*ends, strict=True)]

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        points, known = super().draw_points(uniforms, keys, *columns)
        return self._raised(points), known

    def orientation_drawn(self, point: Any, numbers: Sequence[object]) -> Any:
        return self.orientation_at(point)

    def orientations(self, points: Points, *columns: Column) -> Column:
        flat = np.array(points)
        flat[:, 2] = 0
        yaw, _, _ = quaternions.to_euler(super().orientations(flat))
        return self.ground.frames(points, yaw)

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        flat = np.array(points)
        flat[:, 2] = 0
        away, _, places = self.pieces.nearest(flat)
        return np.hypot(away, points[:, 2] - self.ground.heights(places))

    def box(self, *columns: Column) -> tuple[Points, Points]:
        lower, upper = (np.array(corner) for corner in super().box(*columns))
        lower[:, 2], upper[:, 2] = self.ground.bounds
        return lower, upper

    def closest_points(self, points: Points) -> Points:
        return self.projections(points)

    def nearestSegmentTo(self, point: Any) -> tuple[Vector, Vector]:
        """The ends of the segment nearest to a point, as seen from above."""
        start, end = super().nearestSegmentTo(_flat(point))
        return self._on_ground(start), self._on_ground(end)

    def signed_distances(self, points: Points) -> NDArray[np.float64]:
        """Return distances as seen from above, see `PolylineRegion.signed_distances`."""
        flat = np.array(points)
        flat[:, 2] = 0
        return super().signed_distances(flat)

    def points_along(self, ways: NDArray[np.float64], *, normalized: bool = False) -> Points:
        return self._raised(super().points_along(ways, normalized=normalized))

    def projections(self, points: Points) -> Points:
        return self._raised(super().projections(points))

    def defaultOrientation(self, point: Any) -> Any:
        """The direction of the line on its ground, at its point nearest to a point."""
        return Orientation.of(self.orientations(np.array([tuple(_flat(point))]))[0].tolist())

    def _end(self, point: Any, segment: int) -> Any:
        return super()._end(tuple(self._on_ground(Vector.of(point))), segment)

    def _direction(self, place: Vector, segment: int) -> Orientation:
        flat = super()._direction(place, segment)
        frame = self.ground.frames(np.array([tuple(place)]), np.array([flat.yaw]))
        return Orientation.of(frame[0].tolist())

    def _on_ground(self, point: Vector) -> Vector:
        return Vector.of(self._raised(np.array([tuple(point)]))[0].tolist())

    def _made_of(self, line: Any) -> PolylineRegion:
        made = super()._made_of(line)
        return GroundedLine(
            made.lineString, self.ground, orientation=True if self._follows_segments else self.orientation
        )


def _flat(point: Any) -> Vector:
    x, y, *_ = point.position if hasattr(point, "position") else point
    return Vector.of((float(x), float(y), 0.0))
