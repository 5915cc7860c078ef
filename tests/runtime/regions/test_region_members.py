"""Members that every kind of region has, and what is refused: names, measures, directions, fields of unions, operators."""

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenic.core.regions as named
import shapely
import trimesh
from scenic.core.distributions import Range
from scipy.spatial.transform import Rotation

import scenic
from scenic.language.errors import InvalidScenarioError, ScenicTypeError, ScenicValueError, UnsupportedError
from scenic.runtime.geometry.contact.scalar_bodies import placed
from scenic.runtime.geometry.flat.segments import Segments
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.combinations import IntersectionRegion, UnionRegion
from scenic.runtime.regions.fields import VectorField
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.shapes.shapes import BoxShape, ConeShape, CylinderShape, MeshShape, SpheroidShape
from scenic.runtime.values.values import Orientation, Vector
from tests.runtime.geometry.samples import SHAPES
from tests.runtime.programs import assert_same_rotation, draws, euler, failure, params, scenario, thing

TILT = Orientation.fromEuler(0.7, 0.4, -0.3)
PLACE = Vector(1, 2, 3)
CUBE = trimesh.creation.box()
MAKERS: dict[str, Any] = {
    "disc": lambda **more: named.CircularRegion(PLACE, 2, **more),
    "sector": lambda **more: named.SectorRegion(PLACE, 2, 0.3, 1, **more),
    "rectangle": lambda **more: named.RectangularRegion(PLACE, 0.3, 2, 4, **more),
    "polygon": lambda **more: named.PolygonalRegion([(0, 0), (4, 0), (0, 3)], **more),
    "footprint": lambda **more: named.PolygonalFootprintRegion(shapely.box(0, 0, 1, 2), **more),
    "polyline": lambda **more: named.PolylineRegion([(0, 0), (4, 0), (4, 3)], **more),
    "path": lambda **more: named.PathRegion([(0, 0, 0), (4, 0, 1)], **more),
    "box": lambda **more: named.BoxRegion((1, 2, 3), PLACE, TILT, **more),
    "ball": lambda **more: named.SpheroidRegion((1, 2, 3), PLACE, TILT, **more),
    "volume": lambda **more: named.MeshVolumeRegion(CUBE, **more),
    "surface": lambda **more: named.MeshSurfaceRegion(CUBE, **more),
    "cells": lambda **more: named.VoxelRegion(trimesh.voxel.VoxelGrid(np.ones((1, 2, 3), bool)), **more),
    "view": lambda **more: named.ViewRegion(4, (1, 1), **more),
    "cut": lambda **more: IntersectionRegion(named.BoxRegion(), named.SpheroidRegion(), **more),
}


@pytest.mark.parametrize("kind", MAKERS)
def test_regions_keep_their_names(kind: str) -> None:
    region = MAKERS[kind](name="plaza")
    assert region.name == "plaza"
    assert "plaza" in str(region)
    assert MAKERS[kind]().name is None
    assert type(region).__name__ in str(region)


@pytest.mark.parametrize(
    ("region", "center", "radius"),
    [
        (MAKERS["disc"](), PLACE, 2),
        (MAKERS["rectangle"](), PLACE, math.sqrt(5)),
        (MAKERS["box"](), PLACE, math.sqrt(14) / 2),
        (MAKERS["ball"](), PLACE, math.sqrt(14) / 2),
        (named.MeshVolumeRegion(CUBE, (1, 2, 3), PLACE, TILT), PLACE, math.sqrt(14) / 2),
        (named.MeshSurfaceRegion(CUBE, (1, 2, 3), PLACE, TILT), PLACE, math.sqrt(14) / 2),
        (named.PolygonalRegion([(0, 0), (4, 0), (4, 3)], z=2), Vector(2, 1.5, 2), 2.5),
    ],
)
def test_circles_and_balls_around_regions(region: Any, center: Vector, radius: float) -> None:
    middle, found = region.circumcircle
    assert tuple(middle) == pytest.approx(tuple(center))
    assert found == pytest.approx(radius)


def test_measures_of_volumes_of_meshes() -> None:
    for shape, inradius in (("box", 0.5), ("hollow", 0.0), ("cylinder", 0.5)):
        mesh = SHAPES[shape]()
        volume = named.MeshVolumeRegion(mesh, (1, 2, 3), PLACE, TILT)
        assert volume.inradius == pytest.approx(inradius, rel=0.02)
        assert volume.size == pytest.approx(6 * mesh.volume)
        assert volume.isConvex is (shape != "hollow")
        assert volume.getVolumeRegion() is volume
        surface = volume.getSurfaceRegion()
        assert surface.getSurfaceRegion() is surface
        assert surface.getVolumeRegion().size == pytest.approx(6 * mesh.volume)
        turned = trimesh.Trimesh(np.array(mesh.vertices) * (1, 2, 3), mesh.faces, process=False)
        assert surface.size == pytest.approx(turned.area)
        for region in (volume, surface):
            outline = region.boundingPolygon
            hull = shapely.MultiPoint(np.array(region.mesh.vertices)[:, :2]).convex_hull
            assert outline.polygons.convex_hull.symmetric_difference(hull).area < 1e-9
        assert volume.voxelized(0.5).size >= volume.size * 0.9


@pytest.mark.parametrize("kind", ["box", "ball", "volume", "surface"])
def test_surfaces_are_placed_as_their_volumes(kind: str) -> None:
    maker = {
        "box": named.BoxRegion,
        "ball": named.SpheroidRegion,
        "volume": lambda *placing: named.MeshVolumeRegion(CUBE, *placing),
        "surface": lambda *placing: named.MeshSurfaceRegion(CUBE, *placing),
    }[kind]
    region = maker((4, 5, 6), PLACE, TILT)
    for part in (region, region.getSurfaceRegion(), region.getVolumeRegion()):
        assert tuple(part.dimensions) == (4, 5, 6)
        assert tuple(part.position) == tuple(PLACE)
        assert_same_rotation(part.rotation, euler(0.7, 0.4, -0.3))


def test_polylines_are_made_of_what_shapely_calls_lines() -> None:
    outline = shapely.Polygon([(0, 0), (4, 0), (4, 3)])
    ring = named.PolylineRegion(polyline=outline.exterior)
    both = named.PolylineRegion(polyline=shapely.MultiLineString([[(0, 0), (4, 0)], [(4, 0), (4, 3)]]))
    assert ring.length == pytest.approx(12)
    assert both.length == pytest.approx(7)
    for region, through in ((ring, True), (both, False)):
        assert region.containsPoint((2, 0))
        assert region.containsPoint((4, 1.5))
        assert region.containsPoint((2, 1.5)) is through


@pytest.mark.parametrize("way", ["from the left", "from the right", "of shapely", "in a program"])
def test_sums_of_lines_hold_all_parts_in_their_order(way: str) -> None:
    """Whichever of the two has several parts."""
    corners = [[(0, 0), (1, 0)], [(3, 0), (5, 0), (5, 2)], [(7, 0), (8, 0)], [(9, 1), (9, 2)]]
    first, second, third, fourth = map(named.PolylineRegion, corners)
    if way == "from the left":
        total = first + second + third + fourth
    elif way == "from the right":
        total = first + (second + (third + fourth))
    elif way == "of shapely":
        pairs = [shapely.MultiLineString([shapely.LineString(c) for c in corners[i : i + 2]]) for i in (0, 2)]
        total = named.PolylineRegion(polyline=pairs[0]) + named.PolylineRegion(polyline=pairs[1])
    else:
        made = " + ".join(f"PolylineRegion({one})" for one in corners)
        total = params(f"param r = {made}\nego = new Object on {made}\n")["r"]
    assert isinstance(total, named.PolylineRegion)
    assert total.length == pytest.approx(1 + 4 + 1 + 1)
    assert total.lineString.geom_type == "MultiLineString"
    assert [len(part.coords) for part in total.lineString.geoms] == [2, 3, 2, 2]
    assert [tuple(point)[:2] for point in total.points] == [point for line in corners for point in line]
    assert all(total.containsPoint(point) for point in ((0.5, 0), (5, 1), (9, 1.5)))
    assert not any(total.containsPoint(point) for point in ((2, 0), (6, 1), (8.5, 0.5)))
    with pytest.raises(TypeError):
        total + 3


def test_meshes_that_are_inside_out_are_turned() -> None:
    inward = trimesh.creation.box((2, 2, 2))
    inward.invert()
    volume = named.MeshVolumeRegion(inward, position=(5, 5, 5))
    assert volume.size == pytest.approx(8)
    assert volume.mesh.volume == pytest.approx(8)
    corner = volume.intersect(named.BoxRegion(position=(6, 6, 6), dimensions=(2, 2, 2)))
    assert corner.size == pytest.approx(1)
    assert volume.difference(named.BoxRegion(position=(6, 6, 6), dimensions=(2, 2, 2))).size == pytest.approx(
        7
    )


@pytest.mark.parametrize("kind", ["volume", "surface"])
def test_vertices_that_no_face_uses_are_none_of_a_region_of_a_mesh(kind: str) -> None:
    """They neither move it nor count for its extents, wherever they stand among the others."""
    made = {"volume": named.MeshVolumeRegion, "surface": named.MeshSurfaceRegion}[kind]
    own = np.array(CUBE.vertices) * (1, 2, 3)
    for before, after in (([(50, 0, 0)], [(0, 70, 0)]), ([], [(0, 0, -9)]), ([(0, 0, 9)], [])):
        vertices = np.vstack([np.reshape(before, (-1, 3)), own, np.reshape(after, (-1, 3))])
        region = made(trimesh.Trimesh(vertices, CUBE.faces + len(before), process=False), position=PLACE)
        assert tuple(region.dimensions) == (1, 2, 3)
        np.testing.assert_allclose(region.AABB, [(0.5, 1, 1.5), (1.5, 3, 4.5)])
        np.testing.assert_allclose(region.mesh.triangles, own[CUBE.faces] + tuple(PLACE))


@pytest.mark.parametrize("angle", [2 * math.pi, 7.0])
def test_a_sector_of_the_full_turn_is_a_disc(angle: float) -> None:
    sector, disc = named.SectorRegion((1, 2), 3, 0.4, angle), named.CircularRegion((1, 2), 3)
    assert sector.polygons.is_valid
    assert sector.polygons.symmetric_difference(disc.polygons).area < 1e-9
    text = (
        f"r = SectorRegion((1, 2), 3, 0.4, {angle})\nways = [i * 45 deg for i in range(9)]\n"
        "ego = new Object at (90, 90)\n"
        "param held = [r.containsObject(new Object at (1 + sin(w), 2 + cos(w)), with allowCollisions True, with width x) for w in ways for x in (0.5, Range(0.5, 0.6))]\n"
        "param out = r.containsObject(new Object at (1 + 2.6, 2), with allowCollisions True)\n"
    )
    found = scenario(text).sample(1, seed=1)[0].params
    assert found["held"] == [True] * 18
    assert found["out"] is False


def test_measures_of_views() -> None:
    view = named.ViewRegion(3, (2 * math.pi, math.pi), position=PLACE, rotation=TILT)
    assert tuple(view.position) == tuple(PLACE)
    assert view.rotation == TILT
    assert view.inradius == pytest.approx(3, rel=0.01)
    middle, radius = view.circumcircle
    assert tuple(middle) == pytest.approx(tuple(PLACE), abs=1e-6)
    assert radius == pytest.approx(3 * math.sqrt(3), rel=0.01)
    assert view.getVolumeRegion().size == pytest.approx(4 / 3 * math.pi * 27, rel=0.01)
    assert view.getSurfaceRegion().size == pytest.approx(4 * math.pi * 9, rel=0.01)
    assert view.isConvex is True
    assert view.voxelized(0.5).size == pytest.approx(4 / 3 * math.pi * 27, rel=0.4)


@pytest.mark.parametrize("shape", ["box", "table", "hollow", "cone", "bumpy"])
def test_discs_that_bodies_hold_seen_from_above_themselves(shape: str) -> None:
    """By the distance of the position from the outline of the stretched body."""
    mesh = SHAPES[shape]()
    triangles = shapely.polygons(mesh.triangles[mesh.area_vectors[:, 2] != 0][:, :, :2])
    outline = shapely.union_all(triangles)
    for width, length in ((1, 1), (4, 1), (0.5, 3)):
        stretched = shapely.affinity.scale(outline, width, length, origin=(0, 0))
        item = thing(
            "from tests.runtime.geometry.samples import SHAPES\n"
            f"ego = new Object at (1, 2, 3), facing (0.7, 0.4, -0.3), with shape MeshShape(SHAPES['{shape}']()), "
            f"with width {width}, with length {length}, with height 2\n"
        )
        expected = (
            stretched.boundary.distance(shapely.Point(0, 0)) if stretched.covers(shapely.Point(0, 0)) else 0
        )
        assert item.planarInradius == pytest.approx(expected, abs=1e-9)


def test_shapes_know_their_middles() -> None:
    for shape in (BoxShape(), ConeShape(), CylinderShape(), SpheroidShape()):
        assert shape.isConvex is True
        assert shape.containsCenter is True
    for name, convex, centre in (("hollow", False, False), ("table", False, False), ("bumpy", False, True)):
        shape = MeshShape(SHAPES[name]())
        assert (shape.isConvex, shape.containsCenter) == (convex, centre)
    sizes = BoxShape(dimensions=(1, 2, 3), scale=2)
    assert (sizes.width, sizes.length, sizes.height) == (2, 4, 6)


def test_the_orientation_of_an_intersection_is_that_of_the_first_member_with_one() -> None:
    field = VectorField("f", lambda point: point.x)
    plain, oriented = (
        named.CircularRegion(PLACE, 5),
        named.PolygonalRegion([(-9, -9), (9, -9), (0, 9)], orientation=field),
    )
    other = named.PolygonalRegion([(-9, -9), (9, -9), (0, 9)], orientation=VectorField("g", lambda _point: 3))
    for members, heading in (
        ((plain, oriented), 0.5),
        ((oriented, plain), 0.5),
        ((plain, oriented, other), 0.5),
        ((plain, other, oriented), 3),
    ):
        region = IntersectionRegion(*members)
        assert region.has_orientation is True
        assert region.orientation_at(Vector(0.5, 0, 0)).yaw == pytest.approx(heading)
    assert IntersectionRegion(plain, plain).has_orientation is False
    text = (
        "field = VectorField('f', lambda p: 0.1 * p.x)\n"
        "plain = CircularRegion((0, 0), Range(3, 4))\n"
        "streets = PolygonalRegion([(-9, -9), (9, -9), (0, 9)], orientation=field)\n"
        "ego = new Object in plain.intersect(streets)\nparam x = (ego.x, ego.heading)\n"
    )
    for x, heading in draws(text, n=9):
        assert heading == pytest.approx(0.1 * x)


def test_what_is_drawn_from_combinations_has_the_orientation_of_a_member() -> None:
    """Of an intersection the first one's with any, of a difference the first one's, of a union none."""
    text = (
        "import numpy\nf = VectorField('f', lambda p: 0.1 * p.x)\n"
        "disc, wide = CircularRegion((4, 0), Range(2, 3)), CircularRegion((4, 0), Range(20, 30))\n"
        "street = PolygonalRegion([(0, -4), (9, -4), (9, 4), (0, 4)], orientation=f)\n"
        "grid = GridRegion('grid', numpy.zeros((2, 3)), 2, 1, 3, 0, orientation=f)\n"
        "table = new Object at (4, 0, 2), facing (0, 0.3, 0), with width 9, with length 9\n"
        "top, column = table.topSurface, disc.footprint\n"
        "of_field = [street.intersect(disc), disc.intersect(street), street.difference(disc), grid.intersect(column)]\n"
        "of_table = [top.intersect(column), column.intersect(top), top.difference(column)]\n"
        "of_none = [wide.difference(street), disc.union(street), street.union(disc)]\n"
        "param x = [(p.x, p.orientation) for p in [new OrientedPoint in r for r in of_field + of_table + of_none]]\n"
    )
    for found in draws(text, n=4):
        turns = [euler(0.1 * x) for x, _ in found[:4]] + [euler(0, 0.3)] * 3 + [euler(0)] * 3
        for (_, orientation), expected in zip(found, turns, strict=True):
            assert_same_rotation(orientation, expected)


def test_unions_of_fields_take_the_first_region_with_one() -> None:
    left = named.PolygonalRegion(
        [(0, 0), (2, 0), (2, 2), (0, 2)], orientation=VectorField("l", lambda _point: 1)
    )
    right = named.PolygonalRegion(
        [(1, 0), (3, 0), (3, 2), (1, 2)], orientation=VectorField("r", lambda _point: 2)
    )
    plain = named.PolygonalRegion([(0, 0), (9, 0), (9, 2), (0, 2)])
    field = VectorField.forUnionOf([plain, left, right])
    assert field is not None
    assert [field.at(Vector(x, 1, 0)).yaw for x in (0.5, 1.5, 2.5)] == pytest.approx([1, 1, 2])
    field = VectorField.forUnionOf([right, left])
    assert field is not None
    assert [field.at(Vector(x, 1, 0)).yaw for x in (0.5, 1.5, 2.5)] == pytest.approx([1, 2, 2])
    assert VectorField.forUnionOf([plain]) is None


def test_fields_that_fail_in_some_lanes_fail_there() -> None:
    for text in (
        "f = VectorField('f', lambda p: 0.1 if p.x < 0.5 else 'north')\nparam x = f at (Range(0, 1), 0)\n",
        "f = VectorField('f', lambda p: 0.1 if p.x < 0.5 else 'north')\nparam x = f.followFrom((Range(0, 1), 0), 3)\n",
    ):
        error = failure(text, n=12)
        assert isinstance(error, ScenicTypeError)
        assert "field" in str(error)
        kept = text.replace("Range(0, 1)", "x").replace("f = ", "x = Range(0, 1)\nrequire x < 0.4\nf = ", 1)
        assert len(scenic.scenarioFromString(kept).sample(12, seed=1)) == 12


def test_fields_wait_for_the_object_in_specifiers() -> None:
    text = (
        "f = VectorField('f', lambda p: 0.1 * p.x)\n"
        "class Car:\n    way: f.followFrom(self.position, self.width)\n    turn: f[self.position]\n    width: 4\n"
        "ego = new Car at (2, 3)\n"
    )
    item = thing(text)
    assert_same_rotation(item.turn, euler(0.2))
    assert math.dist(tuple(item.way), (2, 3, 0)) == pytest.approx(4, rel=0.02)


def test_ends_and_directions_of_lines() -> None:
    line = named.PolylineRegion([(0, 0), (4, 0), (4, 3)])
    assert [(tuple(a), tuple(b)) for a, b in line.segments] == [
        ((0, 0, 0), (4, 0, 0)),
        ((4, 0, 0), (4, 3, 0)),
    ]
    assert line.defaultOrientation(Vector(1, 1, 0)) == pytest.approx(-math.pi / 2)
    assert line.defaultOrientation(Vector(5, 2, 0)) == pytest.approx(0)
    own = named.PolylineRegion([(0, 0), (4, 0)], orientation=VectorField("f", lambda point: point.x))
    assert own.end.heading == pytest.approx(4 - 2 * math.pi)
    assert own.start.heading == pytest.approx(0)
    tilted = named.PolylineRegion(
        [(0, 0), (3, 4)], orientation=VectorField("tilted", lambda _: (0.3, 0.2, 0.1))
    )
    for end in (tilted.start, tilted.end):
        assert (end.yaw, end.pitch, end.roll) == pytest.approx((0.3, 0.2, 0.1))
        assert end.parentOrientation == Orientation()
    ring = named.PolylineRegion([(0, 0), (4, 0), (4, 3), (0, 0)])
    assert tuple(ring.start.position) == tuple(ring.end.position)
    assert ring.start.heading == pytest.approx(-math.pi / 2)
    assert ring.end.heading == pytest.approx(math.atan2(4, -3))
    # A line without an orientation has that of the world, one with that of another line looks as this does beside it.
    for points, orientation, heading in (
        ([(0, 0), (4, 0)], None, 0),
        ([(5, 1), (6, 1)], line.orientation, 0),
        ([(1, -2), (1, -1)], line.orientation, -math.pi / 2),
    ):
        other = named.PolylineRegion(points, orientation=orientation)
        for end in (other.start, other.end):
            assert end.heading == pytest.approx(heading)
    assert [tuple(point) for point in line] == [(0, 0, 0), (4, 0, 0), (4, 3, 0)]
    assert tuple(line[-1]) == (4, 3, 0)
    assert line.cumulativeLengths == pytest.approx([4, 7])
    climbing = named.PathRegion(polylines=[[(0, 0, 0), (3, 0, 4), (3, 4, 7)], [(9, 9, 9), (9, 9, 8)]])
    assert climbing.cumulativeLengths == pytest.approx([5, 10, 11])
    assert climbing.length == pytest.approx(11)
    # Before its start and after its end, on the same straight line, a point is not on the right.
    for point, signed in (((-3, 0, 0), 3), ((4, 5, 0), 2), ((2, 1, 0), 1), ((2, -1, 0), -1), ((5, 2, 0), -1)):
        assert line.signedDistanceTo(Vector(*point)) == pytest.approx(signed)
    joined = line + own
    assert joined.length == pytest.approx(11)
    assert [tuple(point) for point in joined] == [tuple(point) for part in (line, own) for point in part]
    with pytest.raises(TypeError):
        line + 3
    for chains in ([[(0, 0, 0), (math.inf, 0, 0)]], [[(0, 0, 0), (0, math.nan, 0)]], [[(1, 1, 1)]], []):
        with pytest.raises(ValueError, match=r"finite|at least two"):
            Segments.of_chains(chains)


@pytest.mark.parametrize(
    ("make", "error"),
    [
        (lambda: named.PathRegion(), ScenicValueError),
        (lambda: named.PathRegion([(0, 0, 0), (1, 1, 1)], [[(0, 0, 0), (1, 1, 1)]]), ScenicValueError),
        (lambda: named.PolylineRegion(), ScenicValueError),
        (
            lambda: named.PolylineRegion([(0, 0), (1, 1)], shapely.LineString([(0, 0), (1, 1)])),
            ScenicValueError,
        ),
        (lambda: named.PolylineRegion(polyline=shapely.LineString()), ScenicValueError),
        (lambda: named.PolylineRegion(polyline=shapely.Point(0, 0)), ScenicValueError),
        (
            lambda: named.PolylineRegion(
                polyline=shapely.GeometryCollection(
                    [shapely.LineString([(0, 0), (1, 1)]), shapely.Point(0, 0)]
                )
            ),
            ScenicValueError,
        ),
        (lambda: named.PolylineRegion([(0, 0), (0, 0)]), ScenicValueError),
        (lambda: named.GridRegion("g", [0, 0], 1, 1, 0, 0), ScenicValueError),
        (lambda: named.MeshVolumeRegion(CUBE, dimensions=(1, 0, 1)), ScenicValueError),
        (lambda: named.MeshSurfaceRegion(CUBE, dimensions=(1, -1, 1)), ScenicValueError),
        (lambda: named.MeshVolumeRegion.fromFile(3), ScenicTypeError),
        (lambda: named.PolygonalRegion.unionAll([]), ScenicTypeError),
        (lambda: named.PolygonalRegion.unionAll([named.BoxRegion()]), ScenicTypeError),
        (lambda: named.BoxRegion().voxelized(0), ScenicValueError),
        (lambda: named.BoxRegion().voxelized(-1), ScenicValueError),
        (lambda: named.SpheroidRegion().voxelized(1e-5), ScenicValueError),
        (
            lambda: named.VoxelRegion(
                trimesh.voxel.VoxelGrid(np.ones((2, 2, 2), bool), transform=np.diag([1.0, -1, 1, 1]))
            ),
            ScenicValueError,
        ),
        (lambda: named.VoxelRegion(trimesh.voxel.VoxelGrid(np.zeros((2, 2, 2), bool))), ScenicValueError),
        (lambda: named.ViewRegion(4, (0, 1)), ScenicValueError),
        (lambda: named.CircularRegion(PLACE, -1), ScenicValueError),
        (lambda: named.RectangularRegion(PLACE, 0, 1, -1), ScenicValueError),
        (lambda: named.BoxRegion((1, 0, 1)), ScenicValueError),
        (lambda: named.everywhere.orientations(np.zeros((1, 3))), UnsupportedError),
        (lambda: named.PathRegion([(0, 0, 0), (1, 1, 1)]).project(PLACE, None), ScenicTypeError),
    ],
)
def test_what_is_no_region_is_refused(make: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        make()


def test_files_of_volumes_and_of_surfaces(tmp_path: Path) -> None:
    (tmp_path / "cube.obj").write_text(CUBE.export(file_type="obj"))
    volume = named.MeshVolumeRegion.fromFile(tmp_path / "cube.obj", dimensions=(1, 2, 3))
    assert volume.size == pytest.approx(6)
    surface = named.MeshSurfaceRegion.fromFile(tmp_path / "cube.obj", position=PLACE)
    assert surface.size == pytest.approx(6)
    assert tuple(surface.AABB[0]) == pytest.approx((0.5, 1.5, 2.5))
    (tmp_path / "plate.obj").write_text("v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n")
    assert named.MeshSurfaceRegion.fromFile(tmp_path / "plate.obj").size == pytest.approx(2)
    plain = named.MeshSurfaceRegion.fromFile(tmp_path / "plate.obj", orientation=None)
    assert plain.has_orientation is False
    assert plain.uniform_placement()[1] is None


def test_bodies_over_regions_without_an_extent_are_beside_them() -> None:
    """One extent, or both, of a rectangle are 0; at once as over lanes."""
    body = placed((0, 0, 0), (0, 0, 0, 1), (1, 1, 1), primitives.box())
    for width, length in ((0, 4), (4, 0), (0, 0)):
        region = named.RectangularRegion(Vector(0, 0, 0), 0.3, width, length)
        single = region.at_once
        assert single is not None
        assert not single.holds_body(body)
        assert region.containsPoint(Vector(0, 0, 9)) is True
        assert region.containsPoint(Vector(0.1, 0.1, 0)) is False
        assert region.containsObject(thing("ego = new Object")) is False
        assert region.distanceTo(Vector(0, 0, 2)) == pytest.approx(2)
    assert named.CircularRegion(Vector(0, 0, 0), 0).containsObject(thing("ego = new Object")) is False


def test_operators_between_objects_and_regions() -> None:
    text = (
        "ego = new Object at (0, 0, 0)\nother = new Object at (5, 0, 0), with width Range(2, 2.5)\n"
        "param w = other.width, a = minimum distance from other, b = minimum distance to other, "
        "c = minimum distance from other to ego\n"
        "param d = (1, 2, 3) relative to (4, 5, 6), e = (1, 2) offset by (3, 4)\n"
    )
    for item in scenario(text).sample(4, seed=1):
        found = item.params
        for name in "abc":
            assert found[name] == pytest.approx(4.5 - found["w"] / 2)
        assert tuple(found["d"]) == (5, 7, 9)
        assert tuple(found["e"]) == (4, 6, 0)
    for wrong in ("minimum distance from (0, 0)", "minimum distance from ego to 3"):
        assert isinstance(failure(f"ego = new Object\nparam x = {wrong}"), ScenicTypeError)


def test_sides_of_objects_by_name() -> None:
    words = {
        "left of": (-1, 0, 0), "right of": (1, 0, 0), "front of": (0, 2, 0), "back of": (0, -2, 0),
        "top of": (0, 0, 3), "bottom of": (0, 0, -3), "front left of": (-1, 2, 0), "back right of": (1, -2, 0),
        "top front left of": (-1, 2, 3), "bottom back right of": (1, -2, -3),
    }  # fmt: skip
    text = (
        "ego = new Object at (1, 2, 3), facing (0.7, 0.4, -0.3), with width 2, with length 4, with height 6\n"
    )
    text += "param x = [" + ", ".join(f"({name} ego).position" for name in words) + "]\n"
    turn = euler(0.7, 0.4, -0.3)
    for place, offset in zip(params(text)["x"], words.values(), strict=True):
        np.testing.assert_allclose(tuple(place), turn.apply(offset) + np.array([1, 2, 3]), atol=1e-9)


def test_shared_points_of_regions_without_bounds() -> None:
    box, points = named.BoxRegion(), named.PointSetRegion("p", [(0, 0, 0), (3, 0, 0)])
    assert named.everywhere.union(box) is named.everywhere
    assert box.union(named.everywhere) is named.everywhere
    assert named.nowhere.union(box) is box
    assert box.difference(named.nowhere) is box
    assert isinstance(box.difference(named.everywhere), named.EmptyRegion)
    assert box.intersect(named.everywhere) is box
    assert isinstance(box.intersect(named.nowhere), named.EmptyRegion)
    assert named.everywhere.intersects(box) is True
    assert box.intersects(named.nowhere) is False
    assert len(points.intersect(box).points) == 1
    assert len(box.intersect(points).points) == 1
    assert points.difference(box).points.tolist() == [[3, 0, 0]]
    for one, other in ((named.PolylineRegion([(-2, 0), (2, 0)]), named.PolylineRegion([(0, -2), (0, 2)])),):
        crossing = one.intersect(other)
        assert isinstance(crossing, named.PointSetRegion)
        assert crossing.points.tolist() == [[0, 0, 0]]
    with pytest.raises((InvalidScenarioError, AttributeError)):
        _ = MAKERS["cut"]().boundingPolygon


@pytest.mark.parametrize(
    "made",
    [
        "disc.footprint.intersect(plate.footprint)",
        "disc.footprint.difference(plate.footprint)",
        "disc.footprint.union(plate.footprint)",
        "everywhere",
        "disc.footprint",
    ],
)
def test_no_point_is_drawn_from_what_has_no_bounds(made: str) -> None:
    text = (
        "disc, plate = CircularRegion((0, 0), Range(1, 2)), RectangularRegion((0, 0), 0, Range(1, 2), 4)\n"
        f"new Point in {made}\n"
    )
    assert isinstance(failure(text), InvalidScenarioError | ScenicTypeError)


def test_boxes_of_sides_of_several_bodies_hold_them() -> None:
    """Of one body the box of the side is told, of several those of the bodies."""
    item = thing("ego = new Object at (1, 2, 3), with width 2, with length 4, with height 6")
    for side, bottom in ((item.topSurface, 6), (item.surface, 0)):
        position, *others = side.fixed_columns("a test")
        lower, upper = side.box(position, *others)
        assert lower[0].tolist() == pytest.approx([0, 0, bottom])
        assert upper[0].tolist() == pytest.approx([2, 4, 6])
        moved = position + np.arange(3)[:, np.newaxis]
        lower, upper = side.box(moved, *others)
        np.testing.assert_allclose(lower, np.array([[0, 0, 0]]) + np.arange(3)[:, np.newaxis])
        np.testing.assert_allclose(upper, np.array([[2, 4, 6]]) + np.arange(3)[:, np.newaxis])


@pytest.mark.parametrize(
    "made",
    ["line.intersect(square)", "square.intersect(line)", "line.difference(square)", "beside.intersect(upon)"],
)
def test_parts_of_lines_look_along_their_pieces(made: str) -> None:
    text = (
        "line = PolylineRegion([(0, 0), (4, 0), (4, 3)])\nother = PolylineRegion([(9, 9), (9, 8)])\n"
        "square = PolygonalRegion([(1, -1), (9, -1), (9, 1), (1, 1)])\n"
        "beside = PolygonalRegion([(0, 0), (4, 0), (4, -1), (0, -1)])\nupon = PolygonalRegion([(0, 0), (4, 0), (4, 1), (0, 1)])\n"
        f"r = {made}\np = new OrientedPoint in r\nparam x = (p.position, p.heading), o = r.orientation is None\n"
    )
    found = draws(text, n=30)
    assert params(text)["o"] is False
    for (x, y, _), heading in found:
        way = math.pi / 2 if y == 0 else 0
        turns = 1 if made.startswith("beside") else 2  # whose edge may be followed either way
        assert math.remainder(heading + way, turns * math.pi) == pytest.approx(0, abs=1e-6)
        assert y == 0 or x == 4


@pytest.mark.parametrize("heading", [0.1 * number for number in range(0, 63, 7)])
def test_regions_hold_what_is_the_same_up_to_rounding(heading: float) -> None:
    """And nothing that sticks out by more, unless a tolerance allows it."""
    turned = named.RectangularRegion((1e3, -2e3, 0), heading, 7, 4)
    cos, sin = math.cos(heading), math.sin(heading)

    def corners(grown: float) -> list[tuple[float, float]]:
        parts = [(x * (3.5 + grown), y * (2 + grown)) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        return [(1e3 + cos * x - sin * y, -2e3 + sin * x + cos * y) for x, y in parts]

    same, larger = named.PolygonalRegion(corners(0)), named.PolygonalRegion(corners(1e-6))
    assert turned.containsRegion(same)
    assert same.containsRegion(turned)
    assert larger.containsRegion(turned)
    assert not turned.containsRegion(larger)
    assert turned.containsRegion(larger, tolerance=2e-6)


def test_members_of_combinations_by_name() -> None:
    first, second = MAKERS["box"](), MAKERS["ball"]()
    cut = named.DifferenceRegion(first, second)
    assert cut.regionA is first
    assert cut.regionB is second


@pytest.mark.parametrize(
    "region",
    [
        "BoxRegion((2, 2, 2))",
        "SpheroidRegion((2, 2, 2))",
        "MeshVolumeRegion(trimesh.creation.box(), dimensions=(2, 2, 2))",
        "MeshSurfaceRegion(trimesh.creation.box(), dimensions=(2, 2, 2))",
        "(new Object at (0, 0, 0), with width 2, with length 2, with height 2).occupiedSpace",
        "(new Object at (0, 0, 0), with width Range(2, 2.5), with length 2, with height 2).occupiedSpace",
        "(new Object at (0, 0, 0), with width 2, with length 2, with height 2).topSurface",
        "(new Object at (0, 0, 0), with width Range(2, 2.5), with length 2, with height 2).topSurface",
        "RectangularRegion((0, 0, 1), 0.0, 2, 2)",
        "CircularRegion((0, 0, 1), 1)",
        "SectorRegion((0, 0, 1), 1, 0, 3)",
        "PolygonalRegion([(-1, -1), (1, -1), (1, 1), (-1, 1)], z=1)",
        "Uniform(BoxRegion((2, 2, 2)), CircularRegion((0, 0, 1), 1))",
        "BoxRegion((2, 2, 2)).intersect(BoxRegion((3, 3, 3)))",
    ],
)
def test_what_does_not_land_is_drawn_again(region: str) -> None:
    """Of points to the right and left of a region about the origin, those that miss it come into no scene."""
    text = f"import trimesh\nr = {region}\np = new OrientedPoint at (Range(-9, 9), 0.1, 5), on r\nparam x = p.position\n"
    found = draws(text, n=30)
    assert all(abs(place.x) <= 1.26 for place in found)
    assert len({round(place.x, 9) for place in found}) == 30


def test_all_and_nothing_in_every_relation() -> None:
    """Nothing meets nothing, not even all of space, and lies in everything."""
    everything, none, box = named.everywhere, named.nowhere, MAKERS["box"]()
    meets = [
        (everything, none, False),
        (none, none, False),
        (everything, everything, True),
        (everything, box, True),
        (none, box, False),
    ]
    for one, other, expected in meets:
        assert one.intersects(other) is expected
        assert other.intersects(one) is expected
    holds = [(everything, none), (none, none), (box, none), (everything, everything), (everything, box)]
    for one, other in itertools.product((everything, none, box), repeat=2):
        if one is not box or other is not box:
            assert one.containsRegion(other) is ((one, other) in holds)


@pytest.mark.parametrize(
    "made", ["disc.footprint", "r", "r.union(other)", "other.intersect(r)", "other.difference(r)"]
)
def test_samples_of_regions_keep_names(made: str) -> None:
    text = (
        "disc = CircularRegion((0, 0), Range(1, 2), name='plaza')\nother = BoxRegion((2, 2, Range(2, 3)), name='hall')\n"
        f"r = SpheroidRegion((3, 3, Range(1, 2)), name='dome')\nmade = {made}\nparam x = made, name = made.name\n"
    )
    for scene in scenario(text).sample(3, seed=1):
        region = scene.params["x"]
        assert region.name == scene.params["name"]
        names = {"disc.footprint": None, "r": "dome"}
        assert made not in names or names[made] is None or region.name == names[made]
        assert {part.name for part in getattr(region, "members", ())} <= {"plaza", "hall", "dome"}
    footprint = PLAZA_FOOTPRINT
    assert [item.params["x"].name for item in scenario(footprint).sample(2, seed=1)] == ["below", "below"]


@pytest.mark.parametrize("centered", [True, False])
@pytest.mark.parametrize("kind", ["MeshVolumeRegion", "MeshSurfaceRegion"])
def test_samples_of_regions_of_meshes_are_where_they_are_drawn(kind: str, centered: bool) -> None:
    """Their attributes are the values of the scene, and so are circle and normals."""
    text = (
        "import trimesh\ncube = trimesh.creation.box((1, 2, 4))\ncube.apply_translation((5, 0, 0))\n"
        "width, x, pitch = Range(2, 3), Range(1, 2), Range(0.1, 0.3)\n"
        f"mesh = {kind}(cube, dimensions=(width, 1, 1), position=(x, 2, 3), rotation=(0, pitch, 0), centerMesh={centered})\n"
        "ego = new Object at (x, 2, 30), with width width, with length 1, with height 1, facing (0, pitch, 0)\n"
        "top = ego.topSurface\nfield = top.orientation\n"
        "param regions = (mesh, ego.occupiedSpace, top), numbers = (width, x, pitch)\n"
    )
    for scene in scenario(text).sample(3, seed=1):
        width, x, pitch = scene.params["numbers"]
        for region, z in zip(scene.params["regions"], (3, 30, 30), strict=True):
            assert tuple(region.position) == (x, 2, z)
            assert tuple(region.dimensions) == (width, 1, 1)
            assert_same_rotation(region.rotation, euler(0, pitch))
            middle, radius = region.circumcircle
            away = 0 if z == 30 or centered else 5 * width
            assert tuple(middle) == pytest.approx((x + away, 2, z))
            assert radius == pytest.approx(math.sqrt(width**2 + 2) / 2)
            assert region.containsPoint(middle) is (region.dimension == 3)
            if region.dimension == 2:
                upper = middle + Vector(0, 0, 0.5 / math.cos(pitch))
                for found in (region.orientation[upper], region.orientation_at(upper)):
                    assert_same_rotation(found, euler(0, pitch))


PLAZA_FOOTPRINT = (
    "from scenic.runtime.regions.planar import Footprint\n"
    "param x = Footprint(CircularRegion((0, 0), Range(1, 2)), name='below')\n"
)


LAZY_CALLS = [
    "f.followFrom({p}, 3)",
    "f.followFrom((1, 2), {w})",
    "f.followFrom({p}, {w})",
    "f[{p}]",
    "disc.containsPoint({p})",
    "disc.distanceTo({p})",
    "CircularRegion({p}, 2).center",
    "CircularRegion((0, 0), {w}).radius",
    "BoxRegion((2, 2, 2), {p}).position",
    "Vector(1, 2).distanceTo({p})",
    "{p}.distanceTo((1, 2))",
    "{p}.offsetRotated({w}, (1, 2))",
    "{p}.angleTo((1, 2))",
    "(follow f from {p} for 2).position",
    "(follow f from (1, 2) for {w}).heading",
    "({p} offset along {w} by (1, 2))",
    "(distance from {p} to (1, 2))",
    "(distance to {p})",
    "(angle from (1, 2) to {p})",
    "(relative heading of {w} from 0.5)",
    "({w} relative to 0.5)",
    "({p} relative to (1, 2))",
    "max({w}, 1)",
]


@pytest.mark.parametrize("call", LAZY_CALLS)
def test_calls_wait_for_each_argument_that_is_not_known_yet(call: str) -> None:
    nothing = "(f relative to 0).yaw * 0"  # which is known once the object has a place
    lazy = call.format(p=f"(Vector(2, 3) * ({nothing} + 1))", w=f"({nothing} + 1.5)")
    default = call.format(p="self.position", w="self.width")
    text = (
        "f = VectorField('f', lambda p: 0.1 * p.x)\ndisc = CircularRegion((0, 0), 2.5)\n"
        f"class Car:\n    late: {default}\n    width: 1.5\n"
        f"ego = new Object at (9, 9, -9)\ncar = new Car at (2, 3)\nother = new Object at (5, 5), with late {lazy}\n"
        f"param x = {call.format(p='Vector(2, 3)', w='1.5')}\n"
    )
    found = scenario(text).sample(1, seed=1)[0]
    known = found.params["x"]
    for late in (found.objects[1].late, found.objects[2].late):
        assert late == known or late == pytest.approx(known)


def test_names_of_objects_that_are_drawn() -> None:
    """Whether a class or a specifier gives the property, a choice or nobody."""
    text = (
        "class Named:\n    name: 'class'\nego = new Object at (Range(0, 1), 0), with name 'given'\n"
        "new Named at (3, Range(0, 1))\nnew Object at (6, 0), with name Uniform('one', 'other')\n"
        "new Object at (Range(9, 10), 0)\nnew Object at (12, 0), with name 'fixed'\n"
    )
    seen = set()
    for scene in scenario(text).sample(12, seed=1):
        names = [str(item) for item in scene.objects]
        assert [repr(item) for item in scene.objects] == [f"<{name}>" for name in names]
        assert names[0:2] + names[3:] == ["given", "class", "unnamed Object", "fixed"]
        seen.add(names[2])
    assert seen == {"one", "other"}


DIMENSIONS = {
    "disc": 2, "sector": 2, "rectangle": 2, "polygon": 2, "footprint": 3, "polyline": 1, "path": 1, "box": 3, "ball": 3,
    "volume": 3, "surface": 2, "cells": 3, "view": 3, "cut": 3,
}  # fmt: skip


def test_dimensions_are_those_of_the_specification() -> None:
    for kind, dimension in DIMENSIONS.items():
        assert MAKERS[kind]().dimension == dimension, kind
    assert DIMENSIONS.keys() == MAKERS.keys()
    item = thing("ego = new Object")
    assert item.occupiedSpace.dimension == 3
    assert item.visibleRegion.dimension == 3
    assert item.topSurface.dimension == item.surface.dimension == 2
    assert (named.everywhere.dimension, named.nowhere.dimension) == (math.inf, 0)
    # So of a solid and a plate most of the draws, or all, are in the solid.
    found = draws(
        "ego = new Object\nr = ego.occupiedSpace.union(CircularRegion((9, 0), 3))\nparam x = (new Point in r).position\n",
        n=20,
    )
    assert all(abs(place.x) <= 0.5 for place in found)


def test_distances_of_random_combinations_from_random_points() -> None:
    text = (
        "x, size = Range(5, 9), Range(1, 3)\nroom = BoxRegion((size, 2, 2)).intersect(BoxRegion((8, 1, 1)))\n"
        "param x = (x, size, room.distanceTo((x, 0, 0)))\n"
    )
    for place, size, distance in draws(text, n=25):
        assert distance == pytest.approx(place - size / 2)


@pytest.mark.parametrize("centered", [True, False])
@pytest.mark.parametrize("kind", ["MeshVolumeRegion", "MeshSurfaceRegion"])
def test_meshes_are_stretched_turned_and_moved_in_this_order(kind: str, centered: bool) -> None:
    """About the middle of their box, or about the origin that their vertices have."""
    mesh = trimesh.creation.box((1, 2, 4))
    mesh.apply_translation((3, -1, 2))
    size = np.array([2.0, 3.0, 5.0])
    region = getattr(named, kind)(mesh, tuple(size), PLACE, TILT, centerMesh=centered)
    corners = mesh.vertices - ((3, -1, 2) if centered else (0, 0, 0))
    expected = Rotation.from_quat(TILT.q).apply(corners * (size / (1, 2, 4))) + np.array(PLACE)
    np.testing.assert_allclose(region.AABB, (expected.min(axis=0), expected.max(axis=0)))
    assert region.containsPoint(Vector(*expected[0])) is True


@pytest.mark.parametrize("tolerance", [1e-6, 0.25])
@pytest.mark.parametrize("kind", ["MeshVolumeRegion", "MeshSurfaceRegion"])
def test_what_is_within_the_tolerance_of_a_mesh_counts_as_in_it(kind: str, tolerance: float) -> None:
    """Beside a face as beside a corner, on every side; of several points asked at once and of one alone."""
    region = getattr(named, kind)(CUBE, (1, 2, 4), PLACE, TILT, tolerance=tolerance)
    ways = np.array([way for way in itertools.product((-1, 0, 1), repeat=3) if any(way)], dtype=float)
    unit = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    local = [ways * (0.5, 1, 2) + off * tolerance * unit for off in (1.001, 0.999)]
    # First some that are far off, or in the very middle.
    local = [ways * 9, ways * 0, *local]
    points = Rotation.from_quat(TILT.q).apply(np.concatenate(local)) + np.array(PLACE)
    expected = np.repeat([False, region.dimension == 3, False, True], len(ways))
    columns = region.fixed_columns("a test")
    np.testing.assert_array_equal(region.contains_points(points, *columns), expected)
    each = [np.repeat(column, len(points), axis=0) for column in columns]
    np.testing.assert_array_equal(region.contains_points(points, *each), expected)
    for point, inside in list(zip(points, expected.tolist(), strict=True))[::5]:
        assert region.containsPoint(Vector(*point)) is inside


def test_lines_and_points_of_several_members_count_alike() -> None:
    parts = [named.PolylineRegion([(number, 0), (number, number + 1)]) for number in range(4)]
    assert named.PolylineRegion.unionAll(parts).length == pytest.approx(10)
    points = named.PointSetRegion("points", [(number, 0, 0) for number in range(4)])
    numbers = (np.arange(400) + 0.5) / 400
    drawn, _ = points.draw_points(numbers[np.newaxis], np.zeros(400, dtype=np.uint64))
    assert np.bincount(drawn[:, 0].astype(int)).tolist() == [100] * 4


def test_the_direction_of_a_path_is_that_of_its_nearest_piece_in_space() -> None:
    path = named.PathRegion(polylines=[[(0, 0, 0), (4, 0, 0)], [(0, 1, 5), (0, 5, 9)]])
    assert_same_rotation(path.defaultOrientation(Vector(0, 2, 6)), euler(0, math.pi / 4))
    assert_same_rotation(path.defaultOrientation((0, 2, 0)), euler(-math.pi / 2))


def test_vertices_of_polygons_come_by_part_and_those_of_holes_last() -> None:
    ring = shapely.Polygon([(0, 0), (9, 0), (0, 9)], [[(1, 1), (2, 1), (1, 2)]])
    other = shapely.Polygon([(20, 0), (21, 0), (20, 1)])
    region = named.PolygonalRegion(polygon=shapely.MultiPolygon([ring, other]), z=2.5)
    parts = region.polygons.geoms
    rings = [*(part.exterior for part in parts), *(hole for part in parts for hole in part.interiors)]
    assert len(rings) == 3
    assert region.points == tuple((x, y, 2.5) for ring in rings for x, y in ring.coords)
    assert len(region.points) == 12
    assert sorted(set(region.points[-4:])) == [(1, 1, 2.5), (1, 2, 2.5), (2, 1, 2.5)]


def test_measures_of_discs_of_random_radius_are_random() -> None:
    text = "r = CircularRegion((1, 2), Range(1, 3))\nparam x = (r.radius, r.inradius, r.circumcircle, r.center, r)\n"
    for radius, inradius, (middle, around), center, region in draws(text, n=3):
        assert radius == inradius == around == region.inradius
        assert tuple(middle) == tuple(center) == (1, 2, 0)


def test_members_of_combinations_are_told_in_their_order() -> None:
    parts = (MAKERS["box"](), MAKERS["ball"](), MAKERS["cells"]())
    assert named.IntersectionRegion(*parts).regions == named.UnionRegion(*parts).regions == parts
    assert named.DifferenceRegion(*parts[:2]).regions == parts[:2]


def test_what_combinations_are_given_is_also_that_of_their_samples() -> None:
    """The field, which goes before those of members, and the name."""
    text = (
        "from scenic.core.regions import DifferenceRegion, IntersectionRegion, UnionRegion\n"
        "f, g = VectorField('f', lambda p: 0.1 * p.x), VectorField('g', lambda p: 3)\n"
        "street = PolygonalRegion([(0, 0), (4, 0), (4, 3)], orientation=g)\ndisc = CircularRegion((2, 1), Range(2, 3))\n"
        "rs = [{}(street, disc, orientation=f, name='mine')]\n"
        "rs += [{}(disc, street, orientation=f, name='mine')]\n"
        "param x = [(r, (new OrientedPoint in r)) for r in rs]\n"
    )
    for kind in ("IntersectionRegion", "UnionRegion", "DifferenceRegion"):
        for found in draws(text.format(kind, kind), n=2):
            for region, point in found:
                assert region.name == "mine"
                assert type(region).__name__ == kind
                assert_same_rotation(point.orientation, euler(0.1 * point.x))
                assert region.orientation[Vector(5, 0, 0)].yaw == pytest.approx(0.5)


def test_distances_of_combinations_are_told_of_many_points_of_one_and_of_one_of_many() -> None:
    """In whichever of points, parameters and both the lanes differ."""

    def room(width: Any) -> IntersectionRegion:
        return IntersectionRegion(named.BoxRegion((width, 2, 2)), named.BoxRegion((8, 1, 1)))

    region = room(Range(1, 9))
    alike = [room(width).fixed_columns("a test") for width in (2, 4, 6)]
    each = [np.concatenate(columns) for columns in zip(*alike, strict=True)]
    points = np.array([(5.0, 0, 0), (7, 0, 0), (0, 0, 2.5)])
    for found, expected in (
        (region.distances(points, *alike[0]), [4, 6, 2]),
        (region.distances(points[:1], *each), [4, 3, 2]),
        (region.distances(points, *each), [4, 5, 2]),
    ):
        np.testing.assert_allclose(found, expected)


def test_parts_of_columns_and_columns_around_them() -> None:
    column = named.CircularRegion((1, 2, 9), 3).footprint
    for bounded in (column.boundFootprint(5, 4), column.approxBoundFootprint(5, 4)):
        np.testing.assert_allclose(bounded.AABB, ((-2, -1, 3), (4, 5, 7)), atol=0.05)
    for distance, held in ((1, True), (-1, False)):
        grown = column.buffer(distance)
        assert grown.containsPoint(Vector(1 + 2.5, 2, -40)) is held
        assert grown.containsPoint(Vector(1 + 3.5, 2, -40)) is held
        assert grown.containsPoint(Vector(1 + 1.5, 2, 40)) is True


def test_things_land_on_views_along_directions() -> None:
    """On a ball of radius 3, seen all around, as on any solid: from outside, and not from inside."""
    view = named.ViewRegion(3, (2 * math.pi, math.pi), position=PLACE)
    for point, direction, place in (
        ((1, 2, 13), None, (1, 2, 6)),
        ((1, 2, -9), (0, 0, 1), (1, 2, 0)),
        ((9, 2, 3), (1, 0, 0), (4, 2, 3)),
        ((1, -9, 3), (0, 1, 0), (1, -1, 3)),
        ((1.5, 2, 3), None, (1.5, 2, 3)),
    ):
        landed, _ = view.project(Vector(*point), direction and Vector(*direction))
        np.testing.assert_allclose(tuple(landed), place, atol=0.01)
        assert tuple(view.projectVector(Vector(*point), direction)) == tuple(landed)
    assert view.projectVector(Vector(9, 2, 3), (0, 0, 1)) is None


def test_views_wider_than_a_half_turn_are_not_convex() -> None:
    for angle, convex in ((1.0, True), (3.0, True), (4.7, False)):
        view = named.ViewRegion(3, (angle, 3.1415927), position=PLACE)
        assert view.isConvex is convex
        hull = view.mesh.convex_hull.volume
        assert bool(view.mesh.volume > 0.99 * hull) is convex
        assert view.mesh.volume == pytest.approx(18 * angle, rel=0.02)
        # A sector is seen from above.
        assert view.boundingPolygon.area == pytest.approx(4.5 * angle, rel=0.02)
        assert view.boundingPolygon.polygons.contains(shapely.Point(1, 3))
        if convex:  # the middle of its box is half its reach ahead
            assert view.inradius == pytest.approx(1.5 * math.sin(angle / 2), rel=0.01)
        cells = view.voxelized(0.5)
        assert cells.dimension == view.getVolumeRegion().dimension == 3
        assert cells.scale.tolist() == [0.5] * 3
        assert view.getSurfaceRegion().dimension == 2


def test_workspaces_answer_as_the_region_that_they_are_made_of() -> None:
    """Also where they are drawn from, landed on and looked along, in each scene its way."""
    line = named.PathRegion(polylines=[[(0, 0, 0), (3, 0, 3)], [(9, 0, 0), (9, 5, 0)]])
    space = Workspace(Workspace(line))
    points = np.array([(1.0, 0, 1), (9, 2, 0), (2, 0, 2)])
    turns = [euler(-math.pi / 2, math.pi / 4), euler(0), euler(-math.pi / 2, math.pi / 4)]
    for found, turn in zip(space.orientations(points), turns, strict=True):
        assert_same_rotation(Orientation.of(found.tolist()), turn)
    assert (space.dimension, space.dimensionality, space.size) == (1, 1, pytest.approx(5 + 3 * math.sqrt(2)))
    disc = named.CircularRegion(PLACE, 2)
    ground = Workspace(disc)
    assert ground.footprint.containsPoint(Vector(1, 3, 70)) is True
    assert ground.dimensionality == 2
    assert isinstance(ground.footprint, type(disc.footprint))
    box = thing(
        "ego = new Object at (1, 2, 3), facing (0, 0.3, 0), with width 4, with length 4, with height 2"
    )
    for direction in (None, (0, 0, 1), (0, 1, 0), (0.1, 0.2, 1)):
        for point in (Vector(1, 2, 9), Vector(1.5, 2.5, 3.2), Vector(1, 9, 3)):
            for region in (box.occupiedSpace, box.topSurface, disc):
                found, known = (each.projectVector(point, direction) for each in (Workspace(region), region))
                assert found == known
    text = (
        "from scenic.core.regions import PathRegion\n"
        "workspace = Workspace(PathRegion(polylines=[[(0, 0, 0), (3, 0, 3)], [(9, 0, 0), (9, 5, 0)]]))\n"
        "place = new OrientedPoint in workspace\nparam x = (place.x, place.orientation)\n"
    )
    found = draws(text, n=12)
    for x, orientation in found:
        assert_same_rotation(orientation, euler(0) if x == 9 else euler(-math.pi / 2, math.pi / 4))
    assert len({x == 9 for x, _ in found}) == 2


def test_points_drawn_now_have_the_heading_of_their_region_there() -> None:
    field = VectorField("f", lambda place: (place.x / 9, 0.4, 0.2))
    region = named.PolygonalRegion([(0, 0), (4, 0), (4, 3)], orientation=field)
    for point in (region.uniformPointInner(), region.orient(Vector(3, 1, 0)), region.orient((2.5, 1, 0))):
        assert point.heading == pytest.approx(point.x / 9)
    assert type(MAKERS["disc"]().uniformPointInner()) is Vector
    # Where a region is random, or the point, no heading is known yet.
    drawn = named.SpheroidRegion((4, 4, Range(3, 4)), orientation=field)
    assert type(drawn.orient(Vector(1, 0, 0))) is Vector
    text = "from scenic.core.regions import Region\nr = CircularRegion((20, 0, 1), 2)\np = Region.uniformPointIn(r)\nparam x = p\n"
    found = draws(text, n=5)
    assert len(set(found)) == 5
    assert all(named.CircularRegion((20, 0, 1), 2).containsPoint(point) and point.z == 1 for point in found)


def test_nothing_is_in_or_on_or_of_the_empty_region() -> None:
    nothing, item = named.nowhere, thing("ego = new Object")
    assert (nothing.size, nothing.dimensionality, repr(nothing)) == (0, 0, "nowhere")
    for region in (named.EmptyRegion("void"), named.AllRegion("void"), named.EmptyRegion(name="void")):
        assert (region.name, repr(region), region.parameters) == ("void", "void", ())
    assert nothing.containsObject(item) is nothing.containsPoint(item.position) is False
    assert nothing.distanceTo(item.position) == math.inf
    for call in ("new Object on nowhere", "new Object in nowhere", "new Object at (0, 0, 0), on nowhere"):
        error = failure(f"ego = new Object at (9, 9, 9)\n{call}\n")
        assert isinstance(error, InvalidScenarioError)
        assert "empty region" in str(error)
    assert nothing.projectVector(item.position, None) is None
    # All of space is where one is already.
    assert tuple(named.everywhere.projectVector(Vector(1, 2, 3), (1, 0, 0))) == (1, 2, 3)
    assert tuple(thing("ego = new Object at (1, 2, 3), on everywhere").position) == pytest.approx(
        (1, 2, 3.5), abs=0.6
    )


def test_sides_alone_bound_no_volume() -> None:
    item = thing(
        "ego = new Object at (1, 2, 3), facing (0.7, 0.4, -0.3), with width 2, with length 4, with height 6"
    )
    for side in ("top", "bottom", "left", "right", "front", "back"):
        region = getattr(item, f"{side}Surface")
        assert region.isConvex is False
        assert region.getSurfaceRegion() is region
        middle, radius = region.circumcircle
        assert tuple(middle) == (1, 2, 3)
        assert radius == pytest.approx(math.sqrt(4 + 16 + 36) / 2)
    assert item.surface.isConvex is True
    for region in (item.surface, item.occupiedSpace):
        assert tuple(region.dimensions) == (2, 4, 6)
        assert tuple(region.position) == (1, 2, 3)
        assert region.rotation.eulerAngles == pytest.approx((0.7, 0.4, -0.3))
    hollow = thing(
        "from tests.runtime.geometry.samples import SHAPES\nego = new Object with shape MeshShape(SHAPES['hollow']())"
    )
    assert hollow.surface.isConvex is hollow.occupiedSpace.isConvex is False


@pytest.mark.parametrize(
    "thresholds",
    [
        "3",
        "((0, 1), (0, 1))",
        "((0, 1), (0, 1), (0, 'a'))",
        "(0, 1, 2)",
        "None",
        "((0, 1, 2), (0, 1), (0, 1))",
        "((0, 1), (0, 1), (0,))",
        "('ab', 'ab', 'ab')",
        "((0, 1), (0, 1), (0, 1), (0, 1))",
    ],
)
def test_thresholds_of_sides_are_three_pairs(thresholds: str) -> None:
    error = failure(
        f"ego = new Object with sideComponentThresholds {thresholds}\nnew Object on ego.topSurface\n"
    )
    assert isinstance(error, ScenicTypeError)
    assert "expected three pairs of numbers" in str(error)


def test_thresholds_of_sides_are_no_formulas() -> None:
    text = "x = Range(0, 1)\nego = new Object with sideComponentThresholds ((-x, x), (-x, x), (-x, x))\nnew Object on ego.topSurface\n"
    assert isinstance(failure(text), UnsupportedError)


def test_distances_between_things_are_known_to_be_at_least_those_of_their_boxes() -> None:
    text = (
        "ego = new Object at (0, 0, 0)\nother = new Object at (Range(5, 9e5), Range(-1, 1), 0), with width Range(1, 2)\n"
        "near, close = minimum distance from other, ego.distanceTo(other.position)\n"
        "param x = near, low = near.supportInterval()[0], high = near.supportInterval()[1]\n"
    )
    for item in scenario(text).sample(5, seed=1):
        low, high = item.params["low"], item.params["high"]
        assert low == pytest.approx(5 - 1 - 0.5, abs=1e-5)
        assert high is None or high >= 9e5 - 1
        assert item.params["x"] >= low


def test_unions_hold_and_meet_in_each_lane_the_body_of_that_lane() -> None:
    """Two blocks beside each other hold a body across their seam where they touch, each alone what is in it."""

    def blocks(x: Any) -> Any:
        return named.UnionRegion(
            named.BoxRegion((2, 2, 2), (-1, 0, 0)), named.BoxRegion((2, 2, 2), (x, 0, 0))
        )

    seconds = np.array([1.0, 1.5, 0.75, 1.0, 1.0, 1.5])
    places = np.array([0.0, 0.0, 0.1, 1.2, 2.7, 1.5])
    held = [True, False, True, True, False, True]
    met = [True, True, True, True, False, True]
    each = [
        np.concatenate(columns)
        for columns in zip(*(blocks(x).fixed_columns("a test") for x in seconds), strict=True)
    ]
    poses = Poses(
        np.stack([places, 0 * places, 0 * places], axis=1), np.array([[0.0, 0, 0, 1]]), np.full((1, 3), 0.8)
    )
    body = Body((primitives.box(),), None, poses)
    for order in (np.arange(6), np.arange(6)[::-1], np.array([3, 0, 4, 1, 5, 2])):
        mine, part = [column[order] for column in each], body.take(order)
        region = blocks(Range(0, 2))
        assert region.contains_bodies(part, 6, *mine).tolist() == [held[lane] for lane in order]
        assert region.meets_bodies(part, 6, *mine).tolist() == [met[lane] for lane in order]
    fixed = UnionRegion(named.BoxRegion((2, 2, 2), (-1, 0, 0)), named.CircularRegion((9, 0), 2))
    columns = fixed.fixed_columns("a test")
    assert fixed.contains_bodies(body, 6, *columns).tolist() == [False] * 6
    assert fixed.meets_bodies(body, 6, *columns).tolist() == [True, True, True, False, False, False]
    inside = Body((primitives.box(),), None, Poses.fixed((9, 0, 4)))
    assert fixed.contains_bodies(inside, 1, *columns).tolist() == [True]


@pytest.mark.parametrize(
    "made",
    [
        "PolygonalRegion([(0, 0), (4, 0), (4, 3)], orientation=F)",
        "BoxRegion((2, 2, 2), (3, 0, 0), orientation=F)",
        "CircularRegion((3, 0), 1).intersect(PolygonalRegion([(-9, -9), (9, -9), (9, 9), (-9, 9)], orientation=F))",
        "CircularRegion((3, 0), Range(1, 2)).intersect(PolygonalRegion([(-9, -9), (9, -9), (9, 9), (-9, 9)], orientation=F))",
        "PathRegion([(0, 0, 0), (3, 0, 4)], orientation=F)",
        "PolygonalRegion([(0, 0), (4, 0), (4, 3)], orientation=F).difference(BoxRegion((2, 2, 2)))",
        "PolygonalRegion([(0, 0), (4, 0), (4, 3)], orientation=F).difference(CircularRegion((0, 0), Range(1, 2)))",
        "IntersectionRegion(BoxRegion((4, 4, 4)), SpheroidRegion((5, 5, 5)), orientation=F)",
        "IntersectionRegion(BoxRegion((4, 4, 4)), SpheroidRegion((5, 5, Range(4, 5))), orientation=F)",
        "UnionRegion(BoxRegion((2, 2, 2)), SpheroidRegion((2, 2, 2), (3, 0, 0)), orientation=F)",
        "DifferenceRegion(BoxRegion((2, 2, 2)), SpheroidRegion((2, 2, 2), (1, 0, 0)), orientation=F)",
        "Workspace(PolygonalRegion([(0, 0), (4, 0), (4, 3)], orientation=F))",
        "MeshSurfaceRegion(trimesh.creation.box((4, 2, 2)), orientation=F)",
        "Uniform(BoxRegion((2, 2, 2), orientation=F), PathRegion([(0, 0, 0), (3, 0, 4)], orientation=F))",
    ],
)
def test_fields_of_regions_may_be_drawn(made: str) -> None:
    text = (
        "import trimesh\nfrom scenic.core.regions import DifferenceRegion, IntersectionRegion, PathRegion, UnionRegion\n"
        "f, g = VectorField('f', lambda p: 0.1 * p.x), VectorField('g', lambda p: 0.7)\nF = Uniform(f, g)\n"
        f"r = {made}\np = new OrientedPoint in r\nparam x = (p, r, F, r.orientation)\n"
    )
    drawn = draws(text, n=16)
    assert {field.name for _, _, field, _ in drawn} == {"f", "g"}
    for point, region, field, orientation in drawn:
        expected = 0.7 if field.name == "g" else 0.1 * point.x
        assert point.heading == pytest.approx(expected)
        assert region.orientation is orientation is field
        assert region.orientation_at(point.position).yaw == pytest.approx(expected)


@pytest.mark.parametrize("field", ["Uniform(f, g)", "chosen(f, Uniform(1, 2))"])
def test_unions_in_the_plane_take_the_field_that_is_drawn_of_the_first_that_holds_the_point(
    field: str,
) -> None:
    text = f"""
from scenic.core.distributions import distributionFunction
f, g, h = (VectorField(str(turn), lambda p, turn=turn: turn) for turn in (0.5, 1.5, 2.5))
@distributionFunction
def chosen(field, number):
    return f if number == 1 else g
F = {field}
a = PolygonalRegion([(0, 0), (4, 0), (4, 4), (0, 4)], orientation=F)
b = PolygonalRegion([(2, 2), (9, 2), (9, 9), (2, 9)], orientation=h)
param x = (F, new OrientedPoint in a.union(b), new OrientedPoint in b.union(a))
"""
    found = draws(text, n=60)
    assert {drawn.name for drawn, _, _ in found} == {"0.5", "1.5"}
    for drawn, first, second in found:
        in_a = [max(point.x, point.y) <= 4 for point in (first, second)]
        in_b = [min(point.x, point.y) >= 2 for point in (first, second)]
        own = float(drawn.name)
        assert first.heading == pytest.approx(own if in_a[0] else 2.5)
        assert second.heading == pytest.approx(2.5 if in_b[1] else own)


def test_paths_hold_what_is_within_their_tolerance_and_lines_what_is_on_them() -> None:
    points = [(0, 0, 0), (4, 0, 0)]
    for region, tolerance in (
        (named.PathRegion(points), 1e-8),
        (named.PathRegion(points, tolerance=0.1), 0.1),
        (named.PathRegion(polylines=[points], tolerance=1e-4), 1e-4),
        (named.PolylineRegion(points), 1e-6),
    ):
        for share, held in ((0.9, True), (1.1, False)):
            for away in (Vector(1, share * tolerance, 0), Vector(4 + share * tolerance, 0, 0)):
                assert region.containsPoint(away) is held


@pytest.mark.parametrize(
    "region",
    [
        "PolygonalRegion([(0, 0), (10, 0), (10, 10), (0, 10)], orientation=f)",
        "BoxRegion(dimensions=(20, 20, 20), orientation=f)",
    ],
)
def test_a_workspace_has_the_field_of_its_region(region: str) -> None:
    """However deep it is nested; one of a region without a field has none."""
    text = f"f = VectorField('f', lambda place: 0.5)\nr = {region}\nworkspace = Workspace(Workspace(r))\n"
    facing = "ego = new Object at (3, 3, 0), facing workspace.orientation\n"
    found = params(
        text
        + facing
        + "p = new OrientedPoint in workspace\nparam x = (ego.heading, p.heading, workspace.orientation is f)"
    )["x"]
    assert found == pytest.approx((0.5, 0.5, True))
    assert params(text.replace(", orientation=f", "") + "param x = workspace.orientation")["x"] is None


@pytest.mark.parametrize(
    "name",
    [name for name in named.__all__ if isinstance(getattr(named, name), type) and name.endswith("Region")],
)
def test_instances_of_regions_are_none_of_the_classes_that_a_program_derives(name: str) -> None:
    """Though some count as of a class that they do not derive from, such as a disc as a polygon."""
    cls = getattr(named, name)
    mine = type("Mine", (cls,), {})
    made = [
        named.CircularRegion((0, 0), 1), named.RectangularRegion((0, 0), 0, 1, 2), named.SectorRegion((0, 0), 1, 0, 1), named.everywhere,
        named.PolygonalRegion([(0, 0), (1, 0), (0, 1)]), named.BoxRegion(), named.SpheroidRegion(), named.PolylineRegion([(0, 0), (1, 1)]),
        thing("ego = new Object").occupiedSpace, named.nowhere,
    ]  # fmt: skip
    assert not any(isinstance(region, mine) for region in made)
    assert any(isinstance(region, named.Region) for region in made)


@pytest.mark.parametrize(
    "heading", ["0.5", "Orientation.fromEuler(0.5, 0.3, 0)", "ego", "Uniform(ego, 0.5)", "turn"]
)
def test_regions_are_turned_by_whatever_has_a_heading(heading: str) -> None:
    text = (
        "ego = new Object facing 0.5\nturn = Uniform(Orientation.fromEuler(0.5, 0.1, 0.2), ego)\n"
        f"sector, oblong = SectorRegion((0, 0), 5, {heading}, 0.1), RectangularRegion((0, 0), {heading}, 0.1, 9)\n"
        "param x = [(new Point in sector).position, (new Point in oblong).position, sector.heading, oblong.heading]\n"
    )
    for beam, point, first, second in draws(text, n=5):
        assert math.atan2(-beam.x, beam.y) == pytest.approx(0.5, abs=0.051)
        along = point.x * -math.sin(0.5) + point.y * math.cos(0.5)
        assert math.dist((point.x, point.y), (-along * math.sin(0.5), along * math.cos(0.5))) < 0.051
        assert (first, second) == pytest.approx((0.5, 0.5))


def test_regions_of_what_depends_on_the_object_are_made_for_it() -> None:
    """Alone, in containers and as operands; of each object for itself, and of each sample."""
    text = (
        "flow = VectorField('flow', lambda place: 0.1 * place.x)\nturn = (0.25 relative to flow).yaw\n"
        "for x in [1, Range(2, 3)]:\n    new Object at (x, 5), with zone CircularRegion((turn, 0), 3 + turn),"
        " with pair [BoxRegion(position=(0, turn, 0)), RectangularRegion((9, 9), turn, 1, 1)],"
        " with hit CircularRegion((0, 0), 1) intersects CircularRegion((1.25 + turn, 0), 0.5)\n"
    )
    for scene in scenario(text).sample(4, seed=1):
        for walker in scene.objects:
            turn = 0.25 + 0.1 * walker.x
            np.testing.assert_allclose(
                walker.zone.AABB, [[-3, -3 - turn, 0], [3 + 2 * turn, 3 + turn, 0]], atol=1e-9
            )
            box, plate = walker.pair
            assert (box.position.y, plate.heading) == pytest.approx((turn, turn))
            assert walker.hit is (1.25 + turn <= 1.5)
