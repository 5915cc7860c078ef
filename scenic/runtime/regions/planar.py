"""Regions of the plane: discs, rectangles, polygons, and the columns above and below them.

Containment ignores z; points are drawn at the region's height (section 9.2 of the specification).
"""

import math
from abc import abstractmethod
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounds import Bounds, outward
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.graph.operations.functions import cos_bounds, length_bounds, sin_bounds
from scenic.language.errors import InvalidScenarioError, ScenicTypeError, ScenicValueError
from scenic.runtime.geometry import containment
from scenic.runtime.geometry.collision import Body
from scenic.runtime.geometry.outlines import Geometries
from scenic.runtime.geometry.polygons import Polygons
from scenic.runtime.geometry.rectangles import Rectangles
from scenic.runtime.program.context import here
from scenic.runtime.regions.base import Mask, Points, Region, unsupported
from scenic.runtime.regions.flat import Flat, meets_flat, rows_of, some_inside
from scenic.runtime.regions.scalar_regions import Disc, Polygon, Rectangle, Single
from scenic.runtime.regions.spaces import Nowhere
from scenic.runtime.values.values import (
    Vector,
    apply,
    is_number,
    is_random,
    operate,
    to_heading,
    to_scalar,
    to_vector,
    uniform,
    vector,
)


class PlanarRegion(Region):
    """A region of the plane at some height."""

    dimension: float = 2

    @property
    def height(self) -> Any:
        """The z of the plane, in metres."""
        return 0.0

    @property
    def z(self) -> Any:
        """The same as `height`."""
        return self.height

    @property
    def footprint(self) -> Region:
        return Footprint(self)

    def polygons_now(self) -> Any:
        """The polygon of the region with fixed parameters, shapely's."""
        raise unsupported(f"the polygon of a region of the kind {type(self).__name__}")

    @property
    def polygons(self) -> Any:
        """The region as a shapely ``MultiPolygon``; raises ``TypeError`` where its parameters are random."""
        import shapely

        self.fixed_columns("the polygon")
        found = self.polygons_now()
        return found if found.geom_type == "MultiPolygon" else shapely.MultiPolygon([found])

    @property
    def area(self) -> float:
        """Square metres."""
        return float(self.sizes(*self.fixed_columns("the area"))[0])

    @property
    def circumcircle(self) -> tuple[Any, float]:
        """Centre and radius of the smallest circle around the region."""
        import shapely

        circle = shapely.minimum_bounding_circle(self.polygons)
        middle = circle.centroid
        return vector(middle.x, middle.y, self.height), float(shapely.minimum_bounding_radius(self.polygons))

    @property
    def inradius(self) -> Any:
        """The radius of the largest circle about the middle of its bounding box that it holds, in metres."""
        import shapely

        left, bottom, right, top = self.polygons.bounds
        middle = shapely.Point((left + right) / 2, (bottom + top) / 2)
        return float(self.polygons.boundary.distance(middle)) if self.polygons.covers(middle) else 0.0

    @property
    def boundary(self) -> Any:
        """The outline, as a line."""
        return self.algebra.boundary(self)

    @property
    def points(self) -> tuple[tuple[float, float, float], ...]:
        """The vertices of the outlines, those of holes last."""
        parts = getattr(self.polygons, "geoms", [self.polygons])
        rings = [part.exterior for part in parts] + [ring for part in parts for ring in part.interiors]
        return tuple((x, y, float(self.height)) for ring in rings for x, y, *_ in ring.coords)

    def buffer(self, distance: float) -> "PolygonalRegion":
        """The region of all points within ``distance`` metres (shrunk where negative)."""
        return PolygonalRegion(polygon=self.polygons.buffer(distance), z=float(self.height))

    @staticmethod
    def unionAll(regions: Iterable[Region], buf: float = 0) -> Region:
        """The union of regions, without those that are empty; gaps that are narrower than twice ``buf`` metres are closed.

        What the regions prefer as orientations it prefers, too, the first that holds a point before the others.
        """
        given = list(regions)
        members = [region for region in given if isinstance(region, PlanarRegion)]
        empty = [region for region in given if isinstance(region, Nowhere)]
        if len(members) + len(empty) < max(len(given), 1):
            raise ScenicTypeError("`unionAll` takes at least one polygonal region", span=here())
        if not members:
            return empty[0]
        merged = Polygons.union([Polygons(member.polygons) for member in members], buf)
        field = PlanarRegion.algebra.field_of_union(members)
        return PolygonalRegion(polygon=merged.polygon, z=float(members[0].height), orientation=field)

    @abstractmethod
    def beside(self, points: Points, *columns: Column) -> Column:
        """Distances of points ``(n, 3)`` from the region seen from above, ``(n,)``; z is ignored."""

    @abstractmethod
    def geometries(self, *columns: Column) -> Geometries:
        """The region as shapely polygons, ``(n | 1,)``."""

    @abstractmethod
    def nearest(self, points: Points, *columns: Column) -> Points:
        """The points ``(n, 3)`` of the region nearest to points ``(n, 3)`` of its plane; the z of the points stays."""

    def heights(self, *columns: Column) -> Column:
        """The z of the plane, ``(n | 1,)``."""
        return np.zeros(1)

    def from_above(self, *columns: Column) -> Flat:
        return Flat(self.geometries(*columns), self.heights(*columns))

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return meets_flat(self, body, lanes, columns, self.heights(*columns))

    def meets_rectangles(self, rectangles: Rectangles, *columns: Column) -> tuple[Mask, Mask]:
        """Which rectangles ``(n,)`` meet the region, and for which of the others this is left open: here all."""
        return np.zeros(1, dtype=np.bool_), np.ones(1, dtype=np.bool_)

    def meets_outlines(self, outlines: Geometries, *columns: Column) -> Mask:
        """Which shapely geometries ``(n,)`` meet the region."""
        import shapely

        return np.asarray(shapely.intersects(self.geometries(*columns), outlines))

    def meets_places(self, points: Points, *columns: Column) -> Mask:
        """Of which rows of points ``(n, m, 2)`` some lie in the region, seen from above."""
        return some_inside(self.geometries(*columns), points)

    def gaps(self, points: Points, *columns: Column) -> Column:
        return self.beside(points, *columns)

    def distances(self, points: Points, *columns: Column) -> Column:
        return np.hypot(self.beside(points, *columns), points[:, 2] - self.heights(*columns))

    def closestPointTo(self, point: Any) -> Vector:
        place = super().closestPointTo(point)
        return Vector.of((place.x, place.y, float(self.heights(*self.fixed_columns("the nearest point"))[0])))

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        """Vertically onto the plane; a point beside the region lands nowhere."""
        target = to_vector(point)
        landed = vector(target.x, target.y, self.height)
        place = apply(_LAND, landed, *self.parameters, payload=self)
        return place, self.orientation_at(place)


def rounded_outward(lower: Points, upper: Points) -> tuple[Points, Points]:
    """Corners ``(n, 3)`` of level boxes, so much larger that points of what they are about are not beside them by rounding."""
    slack = 8 * np.spacing(np.maximum(np.abs(lower), np.abs(upper))) * np.array([1.0, 1.0, 0.0])
    return lower - slack, upper + slack


def nearest_by_geometry(geometries: Geometries, points: Points) -> Points:
    """The points ``(n, 3)`` of shapely geometries ``(n | 1,)`` nearest to points ``(n, 3)``, whose z stays."""
    import shapely

    places = shapely.points(points[:, :2])
    ways = shapely.shortest_line(geometries, places)
    found = np.array(points)
    found[:, :2] = shapely.get_coordinates(shapely.get_point(ways, 0))
    return found


def _land(call: Call, points: Points, *columns: Column) -> Column:
    inside = call.payload.contains_points(points, *columns)
    call.reject(~inside)
    return points


_LAND = Operation(
    "plane projection",
    always(Kind.VECTOR),
    _land,
    "A point of a plane; the candidate is rejected where it lies beside the region.",
    rejects=True,
    missing="place to land on",
)


def positive(value: Any, what: str) -> Any:
    size = to_scalar(value, what)
    if is_number(size) and not size >= 0:
        raise ScenicValueError(
            f"{what} cannot be negative: {size:g}", span=here(), help="sizes are in metres"
        )
    return size


def disc_points(first: Column, second: Column) -> Points:
    """Uniform points ``(n, 3)`` of the unit disc from two uniform numbers ``(n,)``."""
    # The radius of a uniform point of the unit disc is distributed as the square root of a uniform number.
    radius, angle = np.sqrt(first), 2 * math.pi * second
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros_like(radius)], axis=-1)


def _disc_point(_call: Call, first: Column, second: Column) -> Column:
    return disc_points(first, second)


def disc_extent(center: Bounds | None, radius: Bounds | None) -> Bounds | None:
    """The box of a level disc, from bounds of its centre and radius."""
    if center is None or radius is None:
        return None
    reach = np.maximum(radius.upper, 0.0)[:, np.newaxis] * np.array([1.0, 1.0, 0.0])
    return intervals.add(center, Bounds(-reach, reach))


def _disc_bounds(_payload: Any, first: Bounds, second: Bounds) -> Bounds:
    radius = outward(np.sqrt(first.lower), np.sqrt(first.upper), ulps=4)
    radius = Bounds(np.maximum(radius.lower, 0.0), radius.upper)
    angle = Bounds(math.tau * second.lower, math.tau * second.upper)
    x, y = (intervals.multiply(radius, wave(None, angle)) for wave in (cos_bounds, sin_bounds))
    return intervals.widened(intervals.stacked([x, y, Bounds.exactly(0.0)]), 1e-14)


def _disc_inverse(_payload: Any, result: Bounds, _first: Bounds, _second: Bounds) -> list[Bounds | None]:
    """The squares of the distances that points in these bounds have from the middle."""
    squares = [intervals.square(part) for part in intervals.components(result)[:2]]
    return [intervals.widened(intervals.total(squares), 1e-13), None]


DISC_POINT = Operation(
    "disc point",
    always(Kind.VECTOR),
    _disc_point,
    "A uniform point of the unit disc, from two axes.",
    bounds=_disc_bounds,
    inverse=_disc_inverse,
)


class CircularRegion(PlanarRegion):
    """A disc.

    Args:
        center: its centre; points are drawn at its z.
        radius: metres.
        resolution: vertices per quadrant of the polygon that must hold the outline of an object.

    """

    parameter_names = ("center", "radius")
    draws = 2

    def __init__(self, center: Any, radius: Any, resolution: int = 32, *, name: str | None = None) -> None:
        self.center = to_vector(center, "`CircularRegion` center")
        self.radius = positive(radius, "`CircularRegion` radius")
        self.resolution = resolution
        super().__init__(self.center, self.radius, name=name)

    @property
    def height(self) -> Any:
        return self.center.z

    @property
    def circumcircle(self) -> tuple[Any, Any]:
        return self.center, self.radius

    @property
    def inradius(self) -> Any:
        """The radius of the largest disc about the middle that it holds, in metres."""
        return self.radius

    def uniform_placement(self) -> tuple[Any, Any]:
        offset = apply(DISC_POINT, uniform(), uniform())
        point = operate("add", self.center, operate("multiply", offset, self.radius))
        return point, self.orientation_at(point)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        center, radius = columns
        return center + disc_points(uniforms[0], uniforms[1]) * radius[:, np.newaxis], None

    def heights(self, *columns: Column) -> Column:
        return columns[0][:, 2]

    def polygons_now(self) -> Any:
        import shapely

        disc = shapely.Point(self.center.x, self.center.y)
        return disc.buffer(self.radius, quad_segs=self.resolution)

    def box(self, *columns: Column) -> tuple[Points, Points]:
        center, radius = columns
        reach = radius[:, np.newaxis] * np.array([1.0, 1.0, 0.0])
        return rounded_outward(center - reach, center + reach)

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return super().extent(*parameters) or disc_extent(*parameters)

    def sizes(self, *columns: Column) -> Column:
        return np.asarray(math.pi * columns[1] ** 2)

    def single(self) -> Single | None:
        return Disc(self.center.row, self.radius, 4 * self.resolution)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        center, radius = columns
        dx, dy = points[:, 0] - center[:, 0], points[:, 1] - center[:, 1]
        inside: Mask = dx * dx + dy * dy <= radius * radius
        return inside

    def beside(self, points: Points, *columns: Column) -> Column:
        center, radius = columns
        dx, dy = points[:, 0] - center[:, 0], points[:, 1] - center[:, 1]
        return np.asarray(np.maximum(np.hypot(dx, dy) - radius, 0))

    def depths(self, points: Points, *columns: Column) -> Column:
        center, radius = columns
        dx, dy = points[:, 0] - center[:, 0], points[:, 1] - center[:, 1]
        return np.asarray(np.maximum(radius - np.hypot(dx, dy), 0))

    def nearest(self, points: Points, *columns: Column) -> Points:
        center, radius = columns
        offset = points[:, :2] - center[:, :2]
        away = np.hypot(offset[:, 0], offset[:, 1])
        share = np.minimum(1.0, radius / np.where(away > 0, away, 1.0))
        found = np.array(points)
        found[:, :2] = center[:, :2] + share[:, np.newaxis] * offset
        return found

    def meets_rectangles(self, rectangles: Rectangles, *columns: Column) -> tuple[Mask, Mask]:
        met: Mask = rectangles.distances(columns[0][:, :2]) <= columns[1]
        return met, np.zeros(1, dtype=np.bool_)

    def meets_outlines(self, outlines: Geometries, *columns: Column) -> Mask:
        import shapely

        center, radius = columns
        return np.asarray(shapely.distance(outlines, shapely.points(center[:, :2])) <= radius)

    def meets_places(self, points: Points, *columns: Column) -> Mask:
        center, radius = columns
        away = np.hypot(points[..., 0] - center[:, [0]], points[..., 1] - center[:, [1]])
        return np.asarray(np.logical_or.reduce(away <= radius[:, np.newaxis], axis=1))

    def geometries(self, *columns: Column) -> Geometries:
        import shapely

        return np.asarray(shapely.polygons(self._corners(*columns)), dtype=np.object_)

    def _corners(self, center: Column, radius: Column) -> Column:
        """The vertices ``(n | 1, k, 2)`` of the polygon that stands for the disc, anticlockwise."""
        angles = np.arange(4 * self.resolution) * (math.pi / (2 * self.resolution))
        circle = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        corners: Column = center[:, np.newaxis, :2] + radius[:, np.newaxis, np.newaxis] * circle
        return corners

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        center, radius = columns
        inside, is_open = containment.surely_in_disc(body, center, radius, 4 * self.resolution, lanes)
        left = np.flatnonzero(is_open)
        if len(left):
            corners = self._corners(*rows_of(columns, left))
            inside[left] = containment.in_convex_polygon(body.take(left), corners, len(left))
        return inside


class RectangularRegion(PlanarRegion):
    """A rectangle turned by a heading.

    Args:
        position: its centre.
        heading: radians, anticlockwise.
        width: extent across the heading, metres.
        length: extent along the heading, metres.

    """

    parameter_names = ("position", "heading", "width", "length")
    draws = 2

    def __init__(
        self, position: Any, heading: Any, width: Any, length: Any, *, name: str | None = None
    ) -> None:
        self.position = to_vector(position, "`RectangularRegion` position")
        self.heading = to_heading(heading, "`RectangularRegion` heading")
        self.width = positive(width, "`RectangularRegion` width")
        self.length = positive(length, "`RectangularRegion` length")
        super().__init__(self.position, self.heading, self.width, self.length, name=name)

    @property
    def height(self) -> Any:
        return self.position.z

    @property
    def hw(self) -> Any:
        """Half the width, in metres."""
        return operate("divide", self.width, 2)

    @property
    def hl(self) -> Any:
        """Half the length, in metres."""
        return operate("divide", self.length, 2)

    @property
    def radius(self) -> Any:
        """Half the diagonal, in metres."""
        return operate("norm", vector(self.hw, self.hl, 0))

    @property
    def circumcircle(self) -> tuple[Any, Any]:
        return self.position, self.radius

    @property
    def inradius(self) -> Any:
        """The radius of the largest disc about the middle that it holds, in metres."""
        return operate("minimum", self.hw, self.hl)

    def uniform_placement(self) -> tuple[Any, Any]:
        x = operate("multiply", operate("subtract", uniform(), 0.5), self.width)
        y = operate("multiply", operate("subtract", uniform(), 0.5), self.length)
        frame = operate("from euler", self.heading, 0.0, 0.0)
        offset = vector(x, y, 0)
        if not is_number(self.heading) or self.heading != 0:
            offset = operate("rotate", frame, offset)
        point = operate("add", self.position, offset)
        return point, self.orientation_at(point)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        position, heading, width, length = columns
        across, along = (uniforms[0] - 0.5) * width, (uniforms[1] - 0.5) * length
        cos, sin = np.cos(heading), np.sin(heading)
        offsets = [across * cos - along * sin, across * sin + along * cos, np.zeros_like(across)]
        return position + np.stack(offsets, axis=-1), None

    def heights(self, *columns: Column) -> Column:
        return columns[0][:, 2]

    @property
    def corners(self) -> tuple[Any, ...]:
        """The corners, anticlockwise from that ahead on the right."""
        turn = operate("from euler", self.heading, 0.0, 0.0)
        return tuple(
            operate(
                "add",
                self.position,
                operate(
                    "rotate",
                    turn,
                    vector(operate("multiply", x, self.width), operate("multiply", y, self.length), 0),
                ),
            )
            for x, y in ((0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5))
        )

    def polygons_now(self) -> Any:
        import shapely

        x, y = self.width / 2, self.length / 2
        box = shapely.Polygon(
            [(x, y), (-x, y), (-x, -y), (x, -y)]
        )  # from the corner with which `corners` begin
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return shapely.affinity.affine_transform(box, [cos, -sin, sin, cos, self.position.x, self.position.y])

    def box(self, *columns: Column) -> tuple[Points, Points]:
        position, heading, width, length = columns
        cos, sin = np.abs(np.cos(heading)), np.abs(np.sin(heading))
        x, y = (width * cos + length * sin) / 2, (width * sin + length * cos) / 2
        reach = np.stack([x, y, np.zeros_like(x)], axis=-1)
        return position - reach, position + reach

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        position, _, width, length = parameters
        found = super().extent(*parameters)
        if found is not None or width is None or length is None:
            return found
        diagonal = length_bounds([width, length])
        return disc_extent(position, Bounds(diagonal.lower / 2, diagonal.upper / 2))

    def sizes(self, *columns: Column) -> Column:
        return np.asarray(columns[2] * columns[3])

    def single(self) -> Single | None:
        cos, sin = float(np.cos(self.heading)), float(np.sin(self.heading))
        return Rectangle(self.position.row, cos, sin, self.width, self.length)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        across, along = self._local(points, *columns)
        inside: Mask = (np.abs(across) <= columns[2] / 2) & (np.abs(along) <= columns[3] / 2)
        return inside

    def beside(self, points: Points, *columns: Column) -> Column:
        across, along = self._local(points, *columns)
        return np.hypot(
            np.maximum(np.abs(across) - columns[2] / 2, 0), np.maximum(np.abs(along) - columns[3] / 2, 0)
        )

    def depths(self, points: Points, *columns: Column) -> Column:
        across, along = self._local(points, *columns)
        inside = np.minimum(columns[2] / 2 - np.abs(across), columns[3] / 2 - np.abs(along))
        return np.asarray(np.maximum(inside, 0))

    def _local(
        self, points: Points, position: Column, heading: Column, *_size: Column
    ) -> tuple[Column, Column]:
        """Coordinates of points across and along the heading, from the centre."""
        dx, dy = points[:, 0] - position[:, 0], points[:, 1] - position[:, 1]
        cos, sin = np.cos(heading), np.sin(heading)
        return dx * cos + dy * sin, dy * cos - dx * sin

    def nearest(self, points: Points, *columns: Column) -> Points:
        across, along = self._local(points, *columns)
        position, heading, width, length = columns
        x, y = np.clip(across, -width / 2, width / 2), np.clip(along, -length / 2, length / 2)
        cos, sin = np.cos(heading), np.sin(heading)
        found = np.array(points)
        inside = (x == across) & (y == along)
        found[:, 0] = np.where(inside, points[:, 0], position[:, 0] + (x * cos - y * sin))
        found[:, 1] = np.where(inside, points[:, 1], position[:, 1] + (x * sin + y * cos))
        return found

    def meets_rectangles(self, rectangles: Rectangles, *columns: Column) -> tuple[Mask, Mask]:
        position, heading, width, length = columns
        axis = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        half = np.stack(np.broadcast_arrays(width, length), axis=-1) / 2
        return Rectangles(position[:, :2], axis, half).meet(rectangles), np.zeros(1, dtype=np.bool_)

    def geometries(self, *columns: Column) -> Geometries:
        import shapely

        return np.asarray(shapely.polygons(self._corners(*columns)), dtype=np.object_)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return containment.in_convex_polygon(body, self._corners(*columns), lanes)

    @staticmethod
    def _corners(*columns: Column) -> Column:
        """The corners ``(n | 1, 4, 2)``, anticlockwise."""
        position, heading, width, length = columns
        cos, sin = np.cos(heading), np.sin(heading)
        corners = np.empty((max(map(len, columns)), 4, 2))
        for corner, (x, y) in enumerate(((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))):
            corners[:, corner, 0] = position[:, 0] + (x * width * cos - y * length * sin)
            corners[:, corner, 1] = position[:, 1] + (x * width * sin + y * length * cos)
        return corners


class PolygonalRegion(PlanarRegion):
    """A polygon, or several, with holes.

    Args:
        points: vertices of one polygon, in order; or
        polygon: a shapely polygon or multipolygon.
        z: height at which points are drawn, metres.

    Raises:
        ValueError: if the polygon is empty or crosses itself.

    """

    kindred = ("CircularRegion", "RectangularRegion", "SectorRegion")

    def __init__(
        self,
        points: Sequence[Any] = (),
        polygon: Any = None,
        z: float = 0,
        orientation: Any = None,
        *,
        name: str | None = None,
        additionalDeps: Sequence[Any] = (),
    ) -> None:
        if is_random(points) or is_random(z):
            raise ScenicTypeError("`PolygonalRegion` needs fixed points", span=here())
        self.orientation = orientation
        self.has_orientation = orientation is not None
        try:
            if polygon is None:
                self.outline = Polygons.of_points([tuple(to_vector(point))[:2] for point in points])
            else:
                self.outline = Polygons(polygon)
        except ValueError as error:
            raise ScenicValueError(f"`PolygonalRegion`: {error}", span=here()) from error
        self._z = float(z)
        super().__init__(name=name)

    @property
    def height(self) -> Any:
        return self._z

    def polygons_now(self) -> Any:
        return self.outline.polygon

    def single(self) -> Single | None:
        return Polygon(self.outline, self._z)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return self.outline.contains(points[:, 0], points[:, 1])

    def beside(self, points: Points, *columns: Column) -> Column:
        return self.outline.distances(points[:, 0], points[:, 1])

    def depths(self, points: Points, *columns: Column) -> Column:
        return self.outline.depths(points[:, 0], points[:, 1])

    def drawn_extent(self, numbers: Sequence[Bounds], *parameters: Bounds | None) -> Bounds | None:
        lower, upper = self.outline.drawn_bounds(*((part.lower, part.upper) for part in numbers))
        height = np.full(len(lower), self.z)
        return Bounds(np.column_stack([lower, height]), np.column_stack([upper, height]))

    def draw_cuts(self) -> Column:
        return self.outline.choice_cuts

    def heights(self, *columns: Column) -> Column:
        return np.full(1, self.z)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        points = np.empty((uniforms.shape[1], 3))
        points[:, :2] = self.outline.sample(*uniforms)
        points[:, 2] = self.z
        return points, None

    def box(self, *columns: Column) -> tuple[Points, Points]:
        x, y, last_x, last_y = self.outline.polygon.bounds
        return np.array([[x, y, self.z]]), np.array([[last_x, last_y, self.z]])

    def sizes(self, *columns: Column) -> Column:
        return np.full(1, self.outline.area)

    def nearest(self, points: Points, *columns: Column) -> Points:
        return nearest_by_geometry(self.geometries(*columns), points)

    def geometries(self, *columns: Column) -> Geometries:
        return self.outline.as_row

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return containment.in_polygons(body, self.outline, lanes)


class Footprint(Region):
    """All points above and below a region of the plane."""

    dimension: float = 3

    def __init__(self, region: PlanarRegion, *, name: str | None = None) -> None:
        super().__init__(*region.parameters, name=name)
        self.region = region

    def sampled(self, sample: Any) -> Region:
        """The footprint of one sample."""
        region = self.region.sampled(sample)
        return self if region is self.region else Footprint(region, name=self.name)  # type: ignore[arg-type]

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return self.region.contains_points(points, *columns)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return self.region.contains_bodies(body, lanes, *columns)

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return meets_flat(self.region, body, lanes, columns, None)

    def from_above(self, *columns: Column) -> Flat:
        return Flat(self.region.geometries(*columns), None)

    def nearest(self, points: Points, *columns: Column) -> Points:
        return self.region.nearest(points, *columns)

    def distances(self, points: Points, *columns: Column) -> Column:
        return self.region.beside(points, *columns)

    def gaps(self, points: Points, *columns: Column) -> Column:
        return self.region.gaps(points, *columns)

    def depths(self, points: Points, *columns: Column) -> Column:
        return self.region.depths(points, *columns)

    def box(self, *columns: Column) -> tuple[Points, Points]:
        return self.region.container_box(*columns)

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return self.region.container_extent(*parameters)

    def sizes(self, *columns: Column) -> Column:
        return np.full(1, np.inf)

    def uniform_placement(self) -> tuple[Any, Any]:
        raise InvalidScenarioError(
            "no point can be drawn from a footprint, which is not bounded",
            span=here(),
            help="draw from the region itself, or intersect the footprint with a bounded region",
        )

    @property
    def polygons(self) -> Any:
        """The region seen from above, as a shapely ``MultiPolygon``."""
        return self.region.polygons

    @property
    def isConvex(self) -> bool:
        """Whether the region seen from above is convex."""
        return bool(self.polygons.convex_hull.area <= self.polygons.area * (1 + 1e-9))

    def boundFootprint(self, centerZ: float, height: float) -> Region:
        """The part of the footprint that is so high, about a middle height (metres)."""
        part: Region = self.algebra.part_between(self, centerZ - height / 2, centerZ + height / 2)
        return part

    def approxBoundFootprint(self, centerZ: float, height: float) -> Region:
        """A part of the footprint that holds the one of `boundFootprint`."""
        return self.boundFootprint(centerZ, height)

    def buffer(self, distance: float) -> "Footprint":
        """The footprint of all points within ``distance`` metres."""
        return Footprint(self.region.buffer(distance))

    def __repr__(self) -> str:
        return self.name or f"the footprint of {self.region!r}"


class PolygonalFootprintRegion(Footprint):
    """All points above and below a polygon.

    Args:
        polygon: a shapely polygon or multipolygon, or a polygonal region.

    """

    kindred = ("Footprint",)

    def __init__(self, polygon: Any, name: str | None = None) -> None:
        region = polygon if isinstance(polygon, PlanarRegion) else PolygonalRegion(polygon=polygon)
        super().__init__(region, name=name)
