"""Operations on regions: intersection, union, difference, and whether they meet (section 9.4 of the specification).

Fixed regions are combined in closed form where there is one: polygons and lines of the plane by shapely, solids by
manifold3d. Everything else, and everything random, becomes a composite region.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Final

import numpy as np

from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Operation, always
from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.runtime.geometry.meshes import booleans
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.prisms import prism, shadow, slice_at
from scenic.runtime.ground.context import here
from scenic.runtime.python.opaque import evaluated, later
from scenic.runtime.regions import generic
from scenic.runtime.regions.base import MEETS_BODY, Mask, Region
from scenic.runtime.regions.body_regions import OccupiedSpace, SideSurface
from scenic.runtime.regions.choice import RegionChoice, as_region
from scenic.runtime.regions.combinations import DifferenceRegion, IntersectionRegion, UnionRegion
from scenic.runtime.regions.composite import Composite
from scenic.runtime.regions.fields import PiecewiseVectorField, field_of_union
from scenic.runtime.regions.fixed_intersections import MEETING, cells_near
from scenic.runtime.regions.lines import LineRegion, PathRegion, PolylineRegion
from scenic.runtime.regions.meshes import (
    MeshSurfaceRegion,
    MeshVolumeRegion,
    surface_in_world,
)
from scenic.runtime.regions.one_lane import in_lane
from scenic.runtime.regions.pairs import Cell, PairTable
from scenic.runtime.regions.planar import Footprint, PlanarRegion, PolygonalFootprintRegion, PolygonalRegion
from scenic.runtime.regions.region_containment import HOLDS
from scenic.runtime.regions.region_field import RegionField
from scenic.runtime.regions.scattered import PointSetRegion
from scenic.runtime.regions.spaces import Everywhere, Nowhere, Workspace, nowhere
from scenic.runtime.regions.stacked import is_body
from scenic.runtime.regions.terms import flat_of, holds, pieces_inside, prism_about, solid_of
from scenic.runtime.regions.view_regions import ViewRegion
from scenic.runtime.regions.volumes import PlacedVolume
from scenic.runtime.regions.voxels import VoxelRegion
from scenic.runtime.regions.voxels import voxelized as cells_of
from scenic.runtime.shapes.shapes import Shape, ShapeSource
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.values import (
    Orientation,
    Vector,
    apply,
    as_value,
    describe,
    is_open,
    is_random,
    options_of,
    per_option,
)


def _operand(value: object, what: str) -> Region:
    """Return a region to combine: an object means the space that it fills."""
    region = as_region(value)
    if region is None:
        region = as_region(getattr(value, "occupiedSpace", None))
    if region is None:
        raise ScenicTypeError(f"{what}: expected a region, not {describe(value)}", span=here())
    return _unwrapped(region)


def _unwrapped(region: Region) -> Region:
    """Return a region itself, where it is a workspace what that is made of."""
    while isinstance(region, Workspace):
        region = region.region
    return region


# Fixed regions in terms of other libraries


def region_of(geometry: object, height: float | None, orientation: object) -> Region:
    """Return the region of a shapely geometry: of its parts of the highest dimension."""
    import shapely

    leaves: list[Any] = []
    for part in getattr(geometry, "geoms", [geometry]):
        leaves += [leaf for leaf in getattr(part, "geoms", [part]) if not leaf.is_empty]
    areas = [part for part in leaves if part.geom_type == "Polygon" and part.area > 0]
    if areas:
        polygon = shapely.MultiPolygon(areas) if len(areas) > 1 else areas[0]
        if height is None:
            return PolygonalFootprintRegion(polygon)
        return PolygonalRegion(polygon=polygon, z=height, orientation=orientation)
    lines = [part for part in leaves if part.geom_type in ("LineString", "LinearRing") and part.length > 0]
    if lines and height is not None:
        line = shapely.MultiLineString(lines) if len(lines) > 1 else lines[0]
        if height == 0:
            return PolylineRegion(polyline=line, orientation=_of_pieces(orientation))
        chains = [[(x, y, height) for x, y, *_ in part.coords] for part in lines]
        return PathRegion(polylines=chains, orientation=_of_pieces(orientation))
    points = [(part.x, part.y, height) for part in leaves if part.geom_type == "Point"]
    if points and height is not None:
        return PointSetRegion("points", points, orientation=orientation)
    return nowhere


def _field(*regions: Region) -> Any:
    """Return the preferred orientation of what is left of regions: that of the first one with any."""
    return next((region.orientation for region in regions if region.orientation is not None), None)


def _field_of_drawn(members: Sequence[tuple[Any, float | None, Any]]) -> PiecewiseVectorField | None:
    """Return the same for the geometries, heights and fields of regions whose fields are drawn."""
    return field_of_union([region_of(*member) for member in members])


def _volume(mesh: Mesh | None, orientation: object = None) -> Region:
    if mesh is None or not mesh.volume > 0:
        return nowhere
    return MeshVolumeRegion(mesh, centerMesh=False, orientation=orientation)


def _by_option(operation: Callable[[Any, Any], Region], a: Region, b: Region) -> Region | None:
    """The choice among the results for each option, if there is one among regions whose dimensions differ, or ``None``.

    Of which dimension the result is, and so which of the two points are drawn from, follows from the option.
    """
    if isinstance(a, RegionChoice) and not a.is_alike:
        return RegionChoice(a.parameters[0], [operation(option, b) for option in a.options])
    if isinstance(b, RegionChoice) and not b.is_alike:
        return RegionChoice(b.parameters[0], [operation(a, option) for option in b.options])
    return None


# The operations


@generic.intersection.register(Region)
def intersection(first: object, second: object) -> Region:
    """The points that lie in both regions."""
    a, b = _operand(first, "`intersect`"), _operand(second, "`intersect`")
    if isinstance(a, Everywhere) or isinstance(b, Nowhere):
        return b
    if isinstance(b, Everywhere) or isinstance(a, Nowhere):
        return a
    if not (a.has_closed_form and b.has_closed_form):
        # What is not level meets a region of the plane as a container.
        return IntersectionRegion(*(_as_container(one, two) for one, two in ((a, b), (b, a))))
    if not (a.is_random or b.is_random):
        for one, two in ((a, b), (b, a)):
            if isinstance(one, PointSetRegion):
                points = [point for point in one.points if holds(two, point)]
                return PointSetRegion(one.name, points, orientation=_field(a, b)) if points else nowhere
        exact = _exact_intersection(a, b)
        if exact is not None:
            return exact
    return _by_option(intersection, a, b) or IntersectionRegion(a, b)


def _as_container(region: Region, other: Region) -> Region:
    """Return a region of the plane as what is above and below it, if another region is not level."""
    return region.footprint if region.has_closed_form and not other.has_closed_form else region


def _exact_intersection(a: Region, b: Region) -> Region | None:
    flat_a, flat_b = flat_of(a), flat_of(b)
    if flat_a is not None and flat_b is not None:
        (one, height_a), (two, height_b) = flat_a, flat_b
        if height_a is not None and height_b is not None and height_a != height_b:
            return nowhere
        height = height_b if height_a is None else height_a
        return region_of(one.intersection(two), height, _field(a, b))
    solid_a, solid_b = solid_of(a), solid_of(b)
    if solid_a is not None and solid_b is not None:
        return _volume(booleans.intersection([solid_a, solid_b]), _field(a, b))
    for solid, flat, line in ((solid_a, flat_b, b), (solid_b, flat_a, a)):
        if solid is None:
            continue
        if flat is not None and not isinstance(line, LineRegion):
            polygon, height = flat
            if height is None:
                column = prism_about(solid, polygon)
                return (
                    nowhere
                    if column is None
                    else _volume(booleans.intersection([solid, column]), _field(a, b))
                )
            return region_of(slice_at(solid, height).intersection(polygon), height, _field(a, b))
        if isinstance(line, LineRegion):
            return _line_inside(line, solid, _field(a, b))
    for path, above in ((a, b), (b, a)):
        if isinstance(path, PathRegion) and isinstance(above, Footprint):
            heights = [point[2] for chain in path.chains for point in chain]
            column = prism(above.polygons, min(heights) - 1, max(heights) + 1)
            return nowhere if column is None else _line_inside(path, column, _field(a, b))
    return None


def _line_inside(line: LineRegion, solid: Mesh, orientation: object) -> Region:
    """Return the pieces of a line inside a solid, with an orientation field."""
    pieces = pieces_inside(line, solid)
    if not pieces:
        return nowhere
    if isinstance(line, PolylineRegion):
        import shapely

        return PolylineRegion(
            polyline=shapely.MultiLineString([[point[:2] for point in piece] for piece in pieces]),
            orientation=_of_pieces(orientation),
        )
    return PathRegion(polylines=pieces, orientation=_of_pieces(orientation))


def _of_pieces(orientation: object) -> Any:
    """Return the field of what is left of a line: where it was that of the line's own directions, those of the pieces (``True``)."""
    return True if orientation is None or isinstance(orientation, RegionField) else orientation


@generic.union.register(Region)
def union(first: object, second: object) -> Region:
    """The points that lie in either region."""
    a, b = _operand(first, "`union`"), _operand(second, "`union`")
    if isinstance(a, Everywhere) or isinstance(b, Nowhere):
        return a
    if isinstance(b, Everywhere) or isinstance(a, Nowhere):
        return b
    if not (a.is_random or b.is_random) and a.has_closed_form and b.has_closed_form:
        flat_a, flat_b = flat_of(a), flat_of(b)
        areal = not (isinstance(a, LineRegion) or isinstance(b, LineRegion))
        if areal and flat_a is not None and flat_b is not None and flat_a[1] == flat_b[1]:
            if is_random((a.orientation, b.orientation)):
                field = call_later(_field_of_drawn, [(*flat_a, a.orientation), (*flat_b, b.orientation)])
            else:
                field = field_of_union([a, b])
            return region_of(flat_a[0].union(flat_b[0]), flat_a[1], field)
        solid_a, solid_b = solid_of(a), solid_of(b)
        if solid_a is not None and solid_b is not None:
            return _volume(booleans.union([solid_a, solid_b]))
    choice = _by_option(union, a, b)
    if choice is not None:
        return choice
    members = [
        member
        for region in (a, b)
        for member in (region.members if isinstance(region, UnionRegion) else [region])
    ]
    return UnionRegion(*members)


@generic.difference.register(Region)
def difference(first: object, second: object) -> Region:
    """The points of the first region that do not lie in the second."""
    a, b = _operand(first, "`difference`"), _operand(second, "`difference`")
    if isinstance(b, Everywhere) or isinstance(a, Nowhere):
        return nowhere
    if isinstance(b, Nowhere):
        return a
    if not a.has_closed_form:
        return DifferenceRegion(a, _as_container(b, a))
    if not (a.is_random or b.is_random):
        if isinstance(a, PointSetRegion):
            points = [point for point in a.points if not holds(b, point)]
            return PointSetRegion(a.name, points, orientation=a.orientation) if points else nowhere
        flat_a, flat_b = flat_of(a), flat_of(b)
        if flat_a is not None and flat_b is not None:
            if flat_a[1] is not None and flat_b[1] is not None and flat_a[1] != flat_b[1]:
                return a
            if flat_a[1] is not None or flat_b[1] is None:
                return region_of(flat_a[0].difference(flat_b[0]), flat_a[1], _field(a))
        solid_a, solid_b = solid_of(a), solid_of(b)
        if solid_a is not None and solid_b is None and flat_b is not None and flat_b[1] is None:
            solid_b = prism_about(solid_a, flat_b[0])
        if solid_a is not None and solid_b is not None:
            return _volume(booleans.difference(solid_a, [solid_b]), _field(a))
    return _by_option(difference, a, b) or DifferenceRegion(a, b)


@generic.intersects.register(Region)
def intersects(first: object, second: object) -> Any:
    """Return whether two regions or objects share a point; random where one of them is."""
    if is_open(second):
        return call_later(intersects, first, second)
    if options_of(second) and as_region(second) is None and not is_body(second):
        return per_option(second, partial(intersects, first))
    a, b = _operand(first, "`intersects`"), _operand(second, "`intersects`")
    if isinstance(a, Nowhere) or isinstance(b, Nowhere):
        return False
    if isinstance(a, Everywhere) or isinstance(b, Everywhere):
        return True
    for region, space in ((a, b), (b, a)):
        is_view = isinstance(region, ViewRegion)
        if isinstance(space, OccupiedSpace) and (is_view or region.is_random or space.is_random):
            return apply(MEETS_BODY, *space.parameters, *region.parameters, payload=region)
    if a.is_random or b.is_random:
        return as_value(later(_MEET, _meet, (a, b)))
    return _meet(a, b)


def _meet(a: Region, b: Region) -> bool:
    """Return whether two fixed regions share a point; raises `UnknownPairError` where that is not known."""
    return bool(_MEETS.ask(_unwrapped(a), _unwrapped(b)))


def _composite_meets(one: IntersectionRegion | DifferenceRegion, other: Region) -> bool | None:
    shared = _shared(one, other)
    return None if shared is None else not isinstance(shared, Nowhere)


_MEETS: Final = PairTable(
    "whether {} and {} intersect",
    (
        Cell(Nowhere, Region, lambda _nowhere, _other: False),
        Cell(Everywhere, Region, lambda _everywhere, _other: True),
        Cell(PointSetRegion, Region, lambda one, two: any(holds(two, point) for point in one.points)),
        Cell(UnionRegion, Region, lambda one, two: any(_meet(member, two) for member in one.members)),
        Cell(IntersectionRegion, Region, _composite_meets),
        Cell(DifferenceRegion, Region, _composite_meets),
        Cell(VoxelRegion, Region, lambda one, two: any(_meet(cell, two) for cell in cells_near(one, two))),
        *MEETING,
    ),
    symmetric=True,
)
"""Rules that decide whether regions of two kinds intersect; a rule that returns ``None`` passes the pair on
to the rules after it."""


def _shared(one: IntersectionRegion | DifferenceRegion, other: Region) -> Region | None:
    """Return the closed form of the intersection of a composite region with another, or ``None``.

    Views count as their meshes.
    """
    first, *rest = (generic.meshed(each) if isinstance(each, ViewRegion) else each for each in one.members)
    common = intersection(first, generic.meshed(other) if isinstance(other, ViewRegion) else other)
    for member in rest:
        if isinstance(one, IntersectionRegion):
            common = intersection(common, member)
        elif isinstance(common, PlanarRegion) and (solid := solid_of(member)) is not None:
            cut = slice_at(solid, float(common.height))
            common = region_of(common.polygons.difference(cut), float(common.height), None)
        else:
            common = difference(common, member)
    return None if isinstance(common, Composite) else common


@generic.meets_bodies.register(Region)
def meets_bodies(region: Region, body: Body, lanes: int, columns: Sequence[Column]) -> Mask:
    """Return a mask of the lanes in which a region shares a point with a body."""
    result = np.zeros(lanes, dtype=np.bool_)
    numbers = np.zeros(lanes, dtype=np.intp) if body.choice is None else np.broadcast_to(body.choice, lanes)
    poses = body.poses
    for lane in range(lanes):
        row = body.poses.take(np.array([lane])) if len(poses) > 1 else poses
        mesh = body.meshes[int(numbers[lane])]
        space = object.__new__(OccupiedSpace)
        shape = Shape(mesh, (1.0, 1.0, 1.0), ShapeSource("mesh"))
        pose = (Vector.of(row.position[0]), Orientation.of(row.orientation[0]), Vector.of(row.size[0]))
        Region.__init__(space, *pose, shape)
        result[lane] = _meet(in_lane(region, lane, columns), space)
    return result


_MEET = Operation(
    "regions meet",
    always(Kind.BOOLEAN),
    lambda call, *columns: np.array([bool(item) for item in evaluated(call, columns)]),
    "Whether two regions, some with random parameters, share a point.",
    pure=False,
    calls_code=True,
    faults=True,
    rejects=True,
)


@generic.contains_region.register(Region)
def contains_region(first: object, second: object, tolerance: float = 0) -> bool:
    """Return whether a fixed region holds another; raises `UnknownPairError` where that is not known."""
    a, b = _operand(first, "`containsRegion`"), _operand(second, "`containsRegion`")
    if isinstance(a, Everywhere) or isinstance(b, Nowhere):
        return True
    if isinstance(b, Everywhere) or isinstance(a, Nowhere):
        return False
    for region in (a, b):
        if isinstance(region, RegionChoice):
            region.fixed_columns("what it holds")  # which says that it is random
    return bool(HOLDS.ask(a, b, tolerance))


@generic.boundary.register(PlanarRegion)
def boundary(region: PlanarRegion) -> PolylineRegion:
    """Return the outline of a region of the plane."""
    return PolylineRegion(polyline=region.polygons.boundary)


@generic.meshed.register(PlacedVolume)
def _volume_as_mesh(region: PlacedVolume) -> MeshVolumeRegion:
    return MeshVolumeRegion(
        region.unit_mesh(),
        region.dimensions,
        region.position,
        region.rotation,
        orientation=region.orientation,
        onDirection=region.onDirection,
    )


@generic.meshed.register(ViewRegion)
def _view_as_mesh(region: ViewRegion) -> MeshVolumeRegion:
    return MeshVolumeRegion(region.solid(), centerMesh=False)


@generic.joint_field.register(Region)
def _joint_field(_first: Region, members: Sequence[Region]) -> PiecewiseVectorField | None:
    return field_of_union(members)


@generic.own_field.register(Region)
def _own_field(region: Region) -> RegionField:
    return RegionField(region)


@generic.outline_from_above.register(Region)
def outline_from_above(region: Region) -> PolygonalRegion:
    """Return a volume or surface seen from above, at height 0."""
    solid = surface_in_world(region) if isinstance(region, SideSurface) else solid_of(region)
    outline = None if solid is None else shadow(solid)
    if outline is None or outline.is_empty:
        raise InvalidScenarioError(f"{region!r} has no outline from above", span=here())
    return PolygonalRegion(polygon=outline)


@generic.part_between.register(Footprint)
def part_between(region: Footprint, low: float, high: float) -> Region:
    """Return the part of a footprint between two heights, in metres."""
    return _volume(prism(region.polygons, low, high))


@generic.surface_of.register(OccupiedSpace)
def surface_of(region: OccupiedSpace) -> MeshSurfaceRegion:
    """Return the surface of a solid, with the same parameters."""
    return MeshSurfaceRegion.of_operands(region.parameters)


@generic.voxelized.register(Region)
def voxelized(region: Region, pitch: float) -> VoxelRegion:
    """Return the cells of a grid that a volume touches."""
    solid = solid_of(region)
    if solid is None:
        raise InvalidScenarioError(f"{region!r} has no cells", span=here())
    return cells_of(region, solid, pitch)


__all__ = ["difference", "intersection", "intersects", "meets_bodies", "region_of", "union"]
