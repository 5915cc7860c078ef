"""Regions of the plane: what all of them share, polygons, and the columns above and below them.

Containment ignores z; points are drawn at the region's height (section 9.2 of the specification).
"""

from abc import abstractmethod
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import ScenicTypeError, ScenicValueError, UndefinedSamplingException
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.flat.outlines import Geometries
from scenic.runtime.geometry.flat.polygons import Polygons
from scenic.runtime.geometry.flat.rectangles import Rectangles
from scenic.runtime.ground.context import here
from scenic.runtime.regions import generic
from scenic.runtime.regions.base import Mask, Points, Region, unsupported
from scenic.runtime.regions.flat import Flat, meets_flat, some_inside
from scenic.runtime.regions.scalar_regions import Polygon, Single
from scenic.runtime.regions.spaces import Nowhere
from scenic.runtime.values.values import (
    Vector,
    apply,
    is_number,
    is_random,
    to_scalar,
    to_vector,
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
        """Return the polygon of the region with fixed parameters, shapely's."""
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
        return generic.boundary(self)

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
        """Return the union of regions, without those that are empty; gaps that are narrower than twice ``buf`` metres are closed.

        What the regions prefer as orientations it prefers, too, the first that holds a point before the others.
        """
        operands = list(regions)
        members = [region for region in operands if isinstance(region, PlanarRegion)]
        empty = [region for region in operands if isinstance(region, Nowhere)]
        if len(members) + len(empty) < max(len(operands), 1):
            raise ScenicTypeError("`unionAll` takes at least one polygonal region", span=here())
        if not members:
            return empty[0]
        outline = Polygons.union([Polygons(member.polygons) for member in members], buf)
        field = generic.joint_field(members[0], members)
        return PolygonalRegion(polygon=outline.polygon, z=float(members[0].height), orientation=field)

    @abstractmethod
    def beside(self, points: Points, *columns: Column) -> Column:
        """Distances of points ``(n, 3)`` from the region seen from above, ``(n,)``; z is ignored."""

    @abstractmethod
    def geometries(self, *columns: Column) -> Geometries:
        """Return the region as shapely polygons, ``(n | 1,)``."""

    @abstractmethod
    def nearest(self, points: Points, *columns: Column) -> Points:
        """The points ``(n, 3)`` of the region nearest to points ``(n, 3)`` of its plane; the z of the points stays."""

    def heights(self, *columns: Column) -> Column:
        """Return the z of the plane, ``(n | 1,)``."""
        return np.zeros(1)

    def heights_at(self, points: Points, *columns: Column) -> Column:
        """The z of the region above or below points ``(n, 3)``, ``(n | 1,)``: that of its plane."""
        return self.heights(*columns)

    def from_above(self, *columns: Column) -> Flat:
        return Flat(self.geometries(*columns), self.heights(*columns))

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return meets_flat(self, body, lanes, columns, self.heights(*columns))

    def meets_rectangles(self, rectangles: Rectangles, *columns: Column) -> tuple[Mask, Mask]:
        """Return the masks of rectangles ``(n,)`` that meet the region, and of the others for which this is left open: here all."""
        return np.zeros(1, dtype=np.bool_), np.ones(1, dtype=np.bool_)

    def meets_outlines(self, outlines: Geometries, *columns: Column) -> Mask:
        """Return the mask of shapely geometries ``(n,)`` that meet the region."""
        import shapely

        return np.asarray(shapely.intersects(self.geometries(*columns), outlines))

    def meets_places(self, points: Points, *columns: Column) -> Mask:
        """Return a mask of the rows of points ``(n, m, 2)`` of which some lie in the region, seen from above."""
        return some_inside(self.geometries(*columns), points)

    def gaps(self, points: Points, *columns: Column) -> Column:
        return self.beside(points, *columns)

    def distances(self, points: Points, *columns: Column) -> Column:
        return np.hypot(self.beside(points, *columns), points[:, 2] - self.heights(*columns))

    def closestPointTo(self, point: Any) -> Vector:
        place = super().closestPointTo(point)
        return Vector.of((place.x, place.y, float(self.heights(*self.fixed_columns("the nearest point"))[0])))

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        """Project a point vertically onto the plane; a point beside the region lands nowhere."""
        target = to_vector(point)
        landed = vector(target.x, target.y, self.height)
        place = apply(_LAND, landed, *self.parameters, payload=self)
        return place, self.orientation_at(place)


def rounded_outward(lower: Points, upper: Points) -> tuple[Points, Points]:
    """Return corners ``(n, 3)`` of level boxes, so much larger that points of what they are about are not beside them by rounding."""
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
        points: Sequence[object] = (),
        polygon: Any = None,
        z: float = 0,
        orientation: Any = None,
        *,
        name: str | None = None,
        additionalDeps: Sequence[object] = (),
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

    def lie_farther(self, points: Points, limits: Column, *columns: Column) -> Mask:
        return self.outline.lie_farther(points[:, 0], points[:, 1], limits)

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

    def draw_points_in(
        self, lower: Points, upper: Points, uniforms: Column, keys: Column, *columns: Column
    ) -> tuple[Points, Mask | None]:
        points = np.empty((uniforms.shape[1], 3))
        choice, first, second = uniforms
        points[:, :2], there = self.outline.sample_in(choice, first, second, lower, upper)
        points[:, 2] = self.z
        return points, there

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

    def lie_farther(self, points: Points, limits: Column, *columns: Column) -> Mask:
        return self.region.lie_farther(points, limits, *columns)

    def depths(self, points: Points, *columns: Column) -> Column:
        return self.region.depths(points, *columns)

    def box(self, *columns: Column) -> tuple[Points, Points]:
        return self.region.container_box(*columns)

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return self.region.container_extent(*parameters)

    def sizes(self, *columns: Column) -> Column:
        return np.full(1, np.inf)

    def uniform_placement(self) -> tuple[Any, Any]:
        raise UndefinedSamplingException(
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
        """Return whether the region seen from above is convex."""
        return bool(self.polygons.convex_hull.area <= self.polygons.area * (1 + 1e-9))

    def boundFootprint(self, centerZ: float, height: float) -> Region:
        """Return the part of the footprint that is so high, about a middle height (metres)."""
        part: Region = generic.part_between(self, centerZ - height / 2, centerZ + height / 2)
        return part

    def approxBoundFootprint(self, centerZ: float, height: float) -> Region:
        """Return a part of the footprint that holds the one of `boundFootprint`."""
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
