"""Every kind of region: membership, draws, distances, bounds, and the algebra of regions.

The oracles are independent: dense points of a box around the region, and SciPy's and shapely's own answers.
"""

import math

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

import scenic
from scenic.language.errors import InvalidScenarioError, ScenicTypeError, ScenicValueError
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.values.values import Orientation
from tests.runtime.programs import (
    FALSE_ALARM,
    assert_same_rotation,
    draws,
    euler,
    failure,
    params,
    scenario,
    thing,
)

SETTING = """
import trimesh
import numpy
R = {
    'circle': CircularRegion((1, 2, 1), 3),
    'rectangle': RectangularRegion((1, 2, 1), 0.3, 2, 4),
    'polygon': PolygonalRegion([(0, 0), (4, 0), (4, 3), (2, 1), (0, 5)], z=1),
    'sector': SectorRegion((1, 1, 1), 3, 0.4, 1.2),
    'wide sector': SectorRegion((1, 1, 1), 3, 0.4, 4.5),
    'line': PolylineRegion([(0, 0), (1, 0), (1, 2), (4, 6)]),
    'path': PathRegion([(0, 0, 0), (1, 1, 1), (3, 1, 2)]),
    'points': PointSetRegion('p', [(1, 2, 3), (4, 5, 6), (0, 0, 0)]),
    'grid': GridRegion('g', numpy.array([[0, 0, 1], [0, 1, 0]]), 2, 3, 10, 20),
    'box': BoxRegion(dimensions=(2, 3, 4), position=(1, 2, 0.5), rotation=(0.3, 0.1, 0.2)),
    'spheroid': SpheroidRegion(dimensions=(2, 3, 4), position=(1, 0, 0)),
    'mesh': MeshVolumeRegion(trimesh.creation.icosahedron(), (2, 3, 4), (1, 2, 3), (0.1, 0.2, 0.3)),
    'voxels': BoxRegion(dimensions=(2, 3, 4), position=(1, 2, 0.5)).voxelized(0.7),
    'surface': MeshSurfaceRegion(trimesh.creation.box((1, 1, 1)), (2, 3, 4), (1, 2, 3)),
}
R['intersection'] = R['circle'].intersect(R['polygon'])
R['general intersection'] = CircularRegion((0, 0, 1), Range(1.9, 2)).intersect(R['polygon'])
R['difference'] = R['box'].difference(R['spheroid'])
R['general difference'] = R['circle'].difference(R['box'])
R['union'] = R['box'].union(R['spheroid'])
R['general union'] = R['circle'].union(R['sector'].union(PolygonalRegion([(5, 0), (6, 0), (6, 2)], z=3)))
ego = new Object at (100, 100)
"""
NAMES = [
    "circle", "rectangle", "polygon", "sector", "wide sector", "line", "path", "points", "grid", "box", "spheroid", "mesh",
    "voxels", "surface", "intersection", "general intersection", "difference", "general difference", "union", "general union",
]  # fmt: skip


@pytest.fixture(scope="module")
def drawn() -> dict[str, list[tuple[float, float, float]]]:
    """Points drawn from every region, and whether the region says that it holds them."""
    text = SETTING + "".join(
        f"p{number} = new Point in R[{name!r}]\nrequire R[{name!r}].distanceTo(p{number}) < 1e-6\n"
        if name not in ("general intersection", "difference", "general difference")
        else f"p{number} = new Point in R[{name!r}]\nrequire R[{name!r}].containsPoint(p{number})\n"
        for number, name in enumerate(NAMES)
    )
    text += "param x = (" + ", ".join(f"p{number}.position" for number in range(len(NAMES))) + ",)\n"
    loaded = scenario(text)
    scenes = loaded.sample(400, seed=2)
    assert all(scene.attempts == 1 for scene in scenes), "every draw lies in its region"
    return {name: [tuple(scene.params["x"][number]) for scene in scenes] for number, name in enumerate(NAMES)}


@pytest.mark.parametrize("name", NAMES)
def test_draws_lie_in_the_bounding_box_and_fill_it(
    name: str, drawn: dict[str, list[tuple[float, float, float]]]
) -> None:
    points = np.array(drawn[name])
    if name != "general intersection":
        found = params(SETTING + f"param x = R[{name!r}].AABB")["x"]
        assert (points >= np.array(found[0]) - 1e-6).all()
        assert (points <= np.array(found[1]) + 1e-6).all()
    assert (np.ptp(points, axis=0) > 0).any()


def test_draws_are_uniform(drawn: dict[str, list[tuple[float, float, float]]]) -> None:
    circle = np.array(drawn["circle"]) - (1, 2, 1)
    assert stats.kstest((circle[:, :2] ** 2).sum(axis=1) / 9, "uniform").pvalue > FALSE_ALARM
    sector = np.array(drawn["wide sector"]) - (1, 1, 1)
    turned = np.remainder(np.arctan2(-sector[:, 0], sector[:, 1]) - 0.4 + np.pi, 2 * np.pi) - np.pi
    assert stats.kstest(turned / 4.5 + 0.5, "uniform").pvalue > FALSE_ALARM
    line = np.array(drawn["line"])
    along = np.where(
        line[:, 1] == 0, line[:, 0], np.where(line[:, 0] == 1, 1 + line[:, 1], 3 + (line[:, 0] - 1) / 3 * 5)
    )
    assert stats.kstest(along / 8, "uniform").pvalue > FALSE_ALARM
    counts = np.unique(np.array(drawn["points"]), axis=0, return_counts=True)[1]
    assert stats.chisquare(counts).pvalue > FALSE_ALARM
    counts = np.unique(np.array(drawn["grid"]), axis=0, return_counts=True)[1]
    assert len(counts) == 4
    assert stats.chisquare(counts).pvalue > FALSE_ALARM
    surface = np.array(drawn["surface"]) - (1, 2, 3)
    on = [np.isclose(np.abs(surface[:, axis]), half).sum() for axis, half in enumerate((1, 1.5, 2))]
    assert stats.chisquare(on, 400 * np.array([12, 8, 6]) / 26).pvalue > FALSE_ALARM


def test_composites_are_drawn_uniformly() -> None:
    text = "a = CircularRegion((0, 0), Range(1.999, 2))\nb = CircularRegion((2, 0), 2)\n"
    points = np.array(
        [tuple(p) for p in draws(text + "q = new Point in a.union(b)\nparam x = q.position", n=2000)]
    )
    both = ((points[:, :2] ** 2).sum(axis=1) <= 4) & (((points[:, :2] - (2, 0)) ** 2).sum(axis=1) <= 4)
    lens = 2 * 4 * np.arccos(0.5) - 2 * np.sin(2 * np.arccos(0.5)) * 2
    share = lens / (8 * np.pi - lens)
    assert stats.binomtest(int(both.sum()), 2000, share).pvalue > FALSE_ALARM
    points = np.array(
        [tuple(p) for p in draws(text + "q = new Point in a.difference(b)\nparam x = q.position", n=500)]
    )
    assert (((points[:, :2] - (2, 0)) ** 2).sum(axis=1) > 4).all()


CLOUD = [(x / 2, y / 2, z / 2) for x in range(-2, 11, 2) for y in range(-2, 11, 2) for z in (0, 1, 2, 5)]


def test_set_identities_hold_at_points() -> None:
    members = ["circle", "polygon", "sector", "box", "spheroid", "mesh", "voxels"]
    text = SETTING + f"cloud = {CLOUD}\n"
    text += "def held(r): return [r.containsPoint(p) for p in cloud]\n"
    pairs = [(a, b) for a in members for b in members]
    text += f"param one = {{n: held(R[n]) for n in {members!r}}}\n"
    text += f"param both = [(a, b, held(R[a].difference(R[b])), R[a].intersects(R[b]), R[b].intersects(R[a])) for a, b in {pairs!r}]\n"
    found = params(text)
    for a, b, rest, one_way, other_way in found["both"]:
        assert one_way == other_way
        one, two = np.array(found["one"][a]), np.array(found["one"][b])
        if {a, b} <= {"box", "mesh"}:  # exact solids; the mesh of a spheroid is an approximation
            assert (np.array(rest) == (one & ~two)).all() or a == b


def test_solids_are_combined_exactly() -> None:
    text = SETTING + (
        "a, b = BoxRegion((2, 2, 2)), BoxRegion((2, 2, 2), position=(1, 0, 0))\nfloor = CircularRegion((0, 0, 0.5), 9)\n"
        "param x = (a.intersect(b).size, a.union(b).size, a.difference(b).size, a.intersect(floor).area,"
        " a.intersect(RectangularRegion((0, 0), 0, 1, 1).footprint).size, a.difference(RectangularRegion((0, 0), 0, 1, 1).footprint).size)\n"
        "param y = (a.containsRegion(BoxRegion()), a.containsRegion(b), a.intersects(floor), a.intersects(BoxRegion(position=(9, 9, 9))))\n"
        "param z = (a.intersect(everywhere) is a, a.intersect(nowhere) is nowhere, a.difference(everywhere) is nowhere, a.union(nowhere) is a)\n"
    )
    found = params(text)
    assert found["x"] == pytest.approx((4, 12, 4, 4, 2, 6), abs=1e-6)
    assert found["y"] == (True, False, True, False)
    assert found["z"] == (True,) * 4


def test_regions_of_the_plane_keep_their_height() -> None:
    text = SETTING + (
        "a, b = CircularRegion((0, 0, 2), 2), CircularRegion((1, 0, 2), 2)\nc = CircularRegion((0, 0, 3), 2)\n"
        "param x = (a.intersect(b).z, a.union(b).z, a.difference(b).z, a.intersect(c) is nowhere, a.difference(c) is a)\n"
        "param y = (a.intersects(c), a.intersects(b), a.intersects(c.footprint), a.intersect(c.footprint).z)\n"
    )
    found = params(text)
    assert found["x"] == (2, 2, 2, True, True)
    assert found["y"] == (False, True, True, 2)


def test_polylines() -> None:
    text = SETTING + (
        "l = R['line']\n"
        "param x = (l.length, l.start.heading, l.end.heading, l.signedDistanceTo((0.5, 1)), l.signedDistanceTo((0.5, -1)))\n"
        "param y = (l.pointAlongBy(1.5), l.pointAlongBy(0.5, normalized=True), l.project((3, 1)), l[1], l.start.position)\n"
        "param z = (len(l), l.equallySpacedPoints(3), l.pointsSeparatedBy(3), l.nearestSegmentTo((2, 1)), (l + l).length)\n"
        "param w = (l.orientation[(1, 1)], R['path'].orientation[(2, 1, 1.5)])\n"
    )
    found = params(text)
    assert found["x"] == pytest.approx((8, -np.pi / 2, np.arctan2(-3, 4), 0.5, -1))
    for point, expected in zip(found["y"], [(1, 0.5), (1.6, 2.8), (1, 1), (1, 0), (0, 0)], strict=True):
        assert tuple(point)[:2] == pytest.approx(expected)
    assert found["z"][0] == 4
    assert [tuple(p)[:2] for p in found["z"][1]] == [pytest.approx(p) for p in [(0, 0), (1.6, 2.8), (4, 6)]]
    assert found["z"][4] == 16
    assert_same_rotation(found["w"][0], euler(0))
    assert_same_rotation(found["w"][1], euler(-np.pi / 2, np.arctan2(1, 2)))


def test_objects_align_with_regions_that_have_a_direction() -> None:
    item = thing("ego = new Object on PolylineRegion([(0, 0), (-5, 0)])\n")
    assert_same_rotation(item.orientation, euler(np.pi / 2))
    field = "PolygonalRegion([(0, 0), (4, 0), (4, 3)], z=2, orientation=VectorField('f', lambda p: p.x))"
    for how in (f"in {field}", f"on {field}", f"at (Range(1, 2), 0.2, 9), on {field}"):
        item = thing(f"ego = new Object {how}\n")
        assert_same_rotation(item.orientation, euler(item.position.x))
    item = thing("ego = new Object at (0.2, 0.3, 9), on BoxRegion((3, 3, 1))\n")
    assert tuple(item.position) == pytest.approx((0.2, 0.3, 1.00005))


def test_grids() -> None:
    found = params(
        SETTING
        + "g = R['grid']\nparam x = (g.gridToPoint((1, 2)), g.pointToGrid((12.2, 23.1)), g.containsPoint((14, 20)), g.containsPoint((10.4, 20)))"
    )
    assert found["x"] == ((12, 26), (1, 1), False, True)


def test_distances_bound_one_another() -> None:
    """A point as far away as the region says has no point of the region nearer; one of its own points is that far."""
    text = (
        SETTING
        + "names = ['circle', 'polygon', 'sector', 'line', 'path', 'points', 'box', 'spheroid', 'mesh', 'surface']\n"
    )
    text += "param x = {n: [R[n].distanceTo(p) for p in [(9, 2, 0), (1, -12, 3), (0, 0, -9), (1, 2, 3)]] for n in names}\n"
    text += "".join(f"q{n} = [new Point in R[n] for n in names]\n" for n in range(1))
    text += "param y = [q.position for q in q0]\n"
    loaded = scenario(text)
    scenes = loaded.sample(300, seed=1)
    for place, name in enumerate(scenes[0].params["x"]):
        points = np.array([tuple(item.params["y"][place]) for item in scenes])
        for target, distance in zip(
            [(9, 2, 0), (1, -12, 3), (0, 0, -9), (1, 2, 3)], scenes[0].params["x"][name], strict=True
        ):
            nearest = np.linalg.norm(points - target, axis=1).min()
            assert nearest >= distance - 1e-9, name
            assert nearest <= distance + 1.5, name


def test_mistakes_with_regions() -> None:
    for text, error in (
        ("PolylineRegion([(0, 0)])", ScenicValueError),
        ("PathRegion([(0, 0), (0, 0)])", ScenicValueError),
        ("PointSetRegion('a', [])", ScenicValueError),
        ("PolylineRegion([(0, Range(0, 1)), (1, 1)])", ScenicTypeError),
        ("CircularRegion((0, 0), 1).intersect(3)", ScenicTypeError),
        ("everywhere.AABB", ScenicTypeError),
        ("MeshVolumeRegion(3)", ScenicTypeError),
    ):
        assert isinstance(failure(f"x = {text}"), error), text
    assert isinstance(failure("new Object in CircularRegion((0, 0), 1).footprint"), InvalidScenarioError)
    assert isinstance(failure("new Object at (1, 1), on PolylineRegion([(0, 0), (1, 0)])"), ScenicTypeError)


def test_members_of_objects() -> None:
    text = (
        "ego = new Object at (1, 2, 3), facing 0.5, with width 2, with length 4, with height 6\n"
        "param x = (ego.inradius, ego.planarInradius, ego.distanceTo((1, 2, 3)), ego.distanceTo((1, 2, 9)))\n"
        "param y = ego.boundingBox.AABB, z = ego.occupiedSpace.size\n"
        "c = new Object at (30, 2, 3), with shape ConeShape(), with width Range(2, 2)\nparam w = c.inradius\n"
    )
    found = params(text)
    assert found["x"] == pytest.approx((1, 1, 0, 3))
    reach = np.array([np.cos(0.5) + 2 * np.sin(0.5), np.sin(0.5) + 2 * np.cos(0.5), 3])
    np.testing.assert_allclose(
        found["y"], [np.array([1, 2, 3]) - reach, np.array([1, 2, 3]) + reach], atol=1e-9
    )
    assert found["z"] == pytest.approx(48)
    assert 0.2 < found["w"] < 0.5


def test_points_drawn_now_follow_pythons_generator() -> None:
    import random

    from scenic.core.regions import CircularRegion
    from scenic.core.vectors import Vector

    disc = CircularRegion(Vector(1, 2), 3)
    random.seed(3)
    first = disc.uniformPointInner()
    random.seed(3)
    assert disc.uniformPointInner() == first
    assert disc.containsPoint(first)
    assert isinstance(scenic.scenarioFromString("ego = new Object").egoObject.position, Vector)


MOVED, ROLLED = "(Range(1, 2), Range(2, 3), Range(4, 5))", "(Range(0, 6), Range(0, 1), Range(0, 6))"
FRAME = f"{MOVED}, {ROLLED}"
RANDOM = {
    "disc": "CircularRegion((Range(1, 2), 3, Range(4, 5)), Range(0.5, 3))",
    "rectangle": "RectangularRegion((Range(1, 2), 3, Range(4, 5)), Range(0, 6), Range(3, 5), Range(0.2, 0.4))",
    "sector": "SectorRegion((1, Range(2, 3), 4), Range(1, 3), Range(0, 6), Range(0.2, 1))",
    "box": f"BoxRegion((Range(3, 5), Range(0.2, 0.4), Range(1, 2)), {FRAME})",
    "ball": f"SpheroidRegion((Range(3, 5), Range(0.2, 0.4), Range(1, 2)), {FRAME})",
    "cone": f"MeshVolumeRegion(trimesh.creation.cone(1, 2, 12), (Range(3, 5), Range(0.2, 0.4), 1), {FRAME})",
    "shell": f"MeshSurfaceRegion(trimesh.creation.box(), (Range(3, 5), Range(0.2, 0.4), 1), {FRAME})",
    "view": "ViewRegion(Range(2, 4), (Range(0.5, 1), Range(0.2, 0.4)), None, (Range(1, 2), 2, 3), (Range(0, 6), 0.4, 0.3))",
    "space": f"(new Object at {MOVED}, facing {ROLLED}, with width Range(1, 2)).occupiedSpace",
    "side": f"(new Object at {MOVED}, facing (Range(0, 6), 0.2, 0), with width Range(1, 2)).topSurface",
}


@pytest.mark.parametrize("kind", RANDOM)
def test_points_of_regions_that_are_drawn_lie_all_over_those_of_their_scenes(kind: str) -> None:
    """By the side of the middle of all points, in the frame of the region, on which they lie."""
    text = (
        "import trimesh\nfrom scenic.core.regions import ViewRegion\n"
        f"r = {RANDOM[kind]}\np = (new Point in r).position\nparam r = r, p = p\n"
    )
    places = []
    for scene in scenario(text).sample(64, seed=3):
        region, point = scene.params["r"], scene.params["p"]
        assert region.distanceTo(point) < 1e-6
        frame = getattr(region, "rotation", None) or Orientation.fromEuler(
            getattr(region, "heading", 0), 0, 0
        )
        middle = getattr(region, "position", None) or region.center
        places.append(Rotation.from_quat(frame.q).inv().apply(np.array(point) - np.array(middle)))
    found = np.array(places)
    for axis in range(3):
        part = found[:, axis]
        if np.ptp(part) > 1e-6 and not (kind == "side" and axis == 2):
            share = np.mean(part > (part.max() + part.min()) / 2)
            assert 0.1 < share < 0.9
            assert len(np.unique(part)) > 30
    size = np.ptp(found, axis=0)
    flat = {"disc": 1, "rectangle": 1, "sector": 1, "side": 1}
    assert sum(size > 1e-6) >= 3 - flat.get(kind, 0)
    if kind in ("rectangle", "box", "ball", "cone", "shell"):
        assert 2.5 < size[0] <= 5
        assert 0.1 < size[1] <= 0.4


SHEET = (
    "import trimesh\n"
    "def sheet(*corners):\n"
    "    return MeshSurfaceRegion(trimesh.Trimesh(corners, [(0, 1, 2), (0, 2, 3)]), centerMesh=False)\n"
    "floor = sheet((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0))\n"
    "wall = sheet((0, -9, 0), (0, 9, 0), (0, 9, 5), (0, -9, 5))\n"
)


def test_things_land_on_flat_meshes() -> None:
    text = (
        f"{SHEET}a = new Object at (3, 4, 7), on floor\nb = new Object at (4, 2, 3), on wall, with onDirection (1, 0, 0)\n"
        "c = new Object in floor.intersect(BoxRegion(dimensions=(4, 4, 4))), with allowCollisions True\n"
        "param held = [(1, 2, 0) in floor, (1, 2, 1) in floor, (0, 2, 3) in wall, (1, 2, 3) in wall]\n"
        "param away = [distance from (1, 2, 3) to floor, distance from (-2, 0, 3) to wall]\n"
        "param dimensions = list(floor.dimensions)\n"
    )
    for scene in scenario(text).sample(3, seed=1):
        a, b, c = (tuple(item.position) for item in scene.objects)
        assert a == pytest.approx((3, 4, 0.50005))
        assert b == pytest.approx((0.50005, 2, 3))
        assert max(map(abs, c[:2])) <= 2
        assert c[2] == 0
        assert scene.params["held"] == [True, False, True, False]
        assert scene.params["away"] == pytest.approx([3, 2])
        assert scene.params["dimensions"] == [18, 18, 0]


def test_what_is_visible_in_2d_mode_lies_in_the_sector() -> None:
    text = (
        "workspace = Workspace(RectangularRegion((0, 0), 0, 40, 40))\n"
        "ego = new Object with viewAngle 90 deg, with visibleDistance 15, facing 0.5\n"
        "new Object visible, with requireVisible False\nnew Object not visible, with requireVisible False\n"
    )
    for scene in scenario(text, mode2D=True).sample(200, seed=2):
        for item, seen in zip(scene.objects[1:], (True, False), strict=True):
            x, y, _ = item.position
            turn = abs((math.atan2(-x, y) - 0.5 + math.pi) % (2 * math.pi) - math.pi)
            assert (math.hypot(x, y) <= 15 + 1e-9 and turn <= math.pi / 4 + 1e-9) == seen


@pytest.mark.parametrize("place", ["with regionContainedIn nowhere", "with regionContainedIn apart"])
def test_containers_that_are_certainly_empty_are_named(place: str) -> None:
    text = f"apart = CircularRegion((0, 0), 1).intersect(CircularRegion((9, 0), 1))\nego = new Object at (Range(0, 1), 0), {place}\n"
    with pytest.raises(InvalidScenarioError, match="inside its container, which is empty"):
        scenario(text).sample(1, seed=1)


def test_nothing_is_left_of_what_is_empty() -> None:
    text = (
        "p = PolygonalRegion([(0, 0), (1, 0), (1, 1)])\n"
        "param area = PolygonalRegion.unionAll((p, nowhere)).area\n"
        "param none = PolygonalRegion.unionAll([nowhere])\n"
        "param left = BoxRegion(dimensions=(2, 2, 2)).voxelized(1).dilation(-5)\nego = new Object\n"
    )
    params = scenario(text).sample(1, seed=1)[0].params
    assert params["area"] == 0.5
    assert str(params["none"]) == str(params["left"]) == "nowhere"


def test_surfaces_have_no_orientation_beside_them() -> None:
    made = "r = BoxRegion(dimensions=(2, 2, 2)).getSurfaceRegion()\nego = new Object at (9, 9, 9)\n"
    with pytest.raises(InvalidScenarioError, match="no orientation away from a surface"):
        scenario(f"{made}param o = r.orientation[(5, 5, 5)]\n")
    text = f"{made}z = Uniform(1, 1.5)\nparam o = r.orientation[(0.2, 0.1, z)]\nparam z = z\n"
    assert {scene.params["z"] for scene in scenario(text).sample(20, seed=1)} == {1}


@pytest.mark.parametrize(
    "region",
    [
        "CircularRegion((0, 0), 3)",
        "RectangularRegion((0, 0), 0, 3, 3)",
        "SectorRegion((0, 0), 3, 0, 1)",
        "BoxRegion(dimensions=(3, 3, 3))",
        "CircularRegion((0, 0), 3).difference(CircularRegion((Range(0, 1), 0), 1))",
        "BoxRegion(dimensions=(3, 3, 3)).getSurfaceRegion()",
    ],
)
def test_fields_that_are_given_to_regions_hold(region: str) -> None:
    text = (
        f"r = {region}\nr.orientation = VectorField('f', lambda p: 1.5)\nego = new Object in r\n"
        "param h = (ego.heading, r.orientation[(0, 0, 0)].yaw)\n"
    )
    for scene in scenario(text).sample(3, seed=1):
        assert scene.params["h"] == pytest.approx((1.5, 1.5))


def test_the_box_of_a_disc_holds_all_its_points() -> None:
    disc = CircularRegion((0.1, 0.2), 0.3)
    low, high = disc.AABB
    angles = np.linspace(0, 2 * math.pi, 4000)
    x, y = 0.1 + 0.3 * np.cos(angles), 0.2 + 0.3 * np.sin(angles)
    held = disc.contains_points(np.column_stack([x, y, 0 * x]), *disc.fixed_columns("the test"))
    for part, axis in ((x, 0), (y, 1)):
        assert low[axis] <= part[held].min()
        assert part[held].max() <= high[axis]
    assert (low[0], high[1]) == pytest.approx((-0.2, 0.5))
