"""Lines of regions of all kinds lie on them, and the page tells them apart."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
import trimesh

import scenic
from scenic.formats.html import page
from scenic.formats.regions import _cell_edges, _longest, _mesh_lines, bounds, outlines
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.combinations import IntersectionRegion
from scenic.runtime.regions.lines import PathRegion
from scenic.runtime.regions.spaces import everywhere, nowhere
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from tests.formats.test_html import data_of
from tests.runtime.geometry.samples import SHAPES

PROGRAM = """
import trimesh
workspace = Workspace(RectangularRegion((0, 0, 0), 0, 60, 40))
disc = CircularRegion((-20, 10, 0), 5)
sector = SectorRegion((-8, 8, 1), 6, 30 deg, 70 deg)
rectangle = RectangularRegion((5, 10, 2), 20 deg, 6, 8)
polygon = PolygonalRegion([(12, 6), (20, 6), (20, 14), (16, 10), (12, 14)])
line = PolylineRegion([(-25, -5), (-20, 0), (-15, -5), (-10, 0)])
path = PathRegion([(-5, -5, 0), (0, 0, 3), (5, -5, 0)])
dots = PointSetRegion("dots", [(8 + i, -4 + j, 0) for i in range(5) for j in range(4)])
grid = GridRegion("grid", [[0, 1, 0], [0, 0, 1]], 2, 2, 16, -5)
box = BoxRegion(dimensions=(4, 5, 6), position=(-24, -14, 3), rotation=Orientation.fromEuler(0.4, 0.1, 0))
ball = SpheroidRegion(dimensions=(6, 6, 4), position=(-14, -14, 2))
ring = MeshVolumeRegion(trimesh.creation.annulus(2, 3, 2), position=(-5, -14, 1))
shell = MeshSurfaceRegion(trimesh.creation.icosphere(radius=3), position=(4, -14, 3))
voxels = ball.voxelized(1)
both = rectangle.union(disc)
cut = ball.difference(BoxRegion(dimensions=(4, 4, 9), position=(-12, -14, 2)))
common = box.intersect(SpheroidRegion(dimensions=(5, 5, 5), position=(-24, -14, 5)))
ego = new Object at (22, -14, 0.5), facing 40 deg, with viewAngles (60 deg, 30 deg), with visibleDistance 9
other = new Object at (Range(10, 14), -14, 1), with width 2, with length 3, with height 2
top = other.topSurface
space = other.occupiedSpace
sight = ego.visibleRegion
seen = visible RectangularRegion((20, -8, 0.5), 0, 12, 12)
unseen = not visible RectangularRegion((20, -8, 0.5), 0, 12, 12)
chosen = Uniform(disc, sector)
footprint = polygon.footprint
unused = CircularRegion((Range(-5, 5), 16, 0), 2)
nothing = nowhere
_private = disc
"""
OTHERS = {"workspace", "ego", "other", "unused", "nothing", "_private", "chosen"}
SHOWN = sorted({line.split(" = ")[0] for line in PROGRAM.splitlines() if " = " in line} - OTHERS)


@pytest.fixture(scope="module")
def scenes():
    return scenic.scenarioFromString(PROGRAM).sample(2, seed=3)


def dense(lines):
    """Points along lines."""
    parts = [np.linspace(a, b, 9) for line in lines for a, b in pairwise(np.asarray(line))]
    return np.concatenate(parts)


@pytest.mark.parametrize("name", SHOWN)
def test_lines_lie_on_their_region(scenes, name):
    region = scenes[0].regions[name]
    points = dense(outlines(region))
    columns = region.fixed_columns("the test")
    assert len(points) > 4
    box = bounds(region)
    size = 1.0 if box is None else float(np.linalg.norm(box[1] - box[0]))
    if name in ("dots", "grid"):
        points = points[4::9]  # the middles of the crosses
    if box is not None:
        assert (points >= box[0] - 0.02 * size).all()
        assert (points <= box[1] + 0.02 * size).all()
        span = np.ptp(points, axis=0)
        assert (span >= 0.8 * (box[1] - box[0]) - 1e-9).all() or name in (
            "sight",
            "seen",
            "unseen",
            "common",
            "top",
        )
    if name in (
        "disc",
        "sector",
        "rectangle",
        "polygon",
        "line",
        "path",
        "box",
        "ball",
        "ring",
        "top",
        "space",
        "footprint",
    ):
        assert region.distances(points, *columns).max() < 0.01


def test_edges_of_cells_are_joined():
    filled = np.zeros((3, 2, 2), dtype=bool)
    filled[:2, 0, 0] = filled[0, 1, 0] = True
    lines = {tuple(map(tuple, line.astype(int).tolist())) for line in _cell_edges(filled)}
    assert ((0, 0, 0), (2, 0, 0)) in lines
    assert ((1, 1, 0), (1, 1, 1)) in lines
    assert ((0, 2, 1), (1, 2, 1)) in lines
    # An L of three cells has the eighteen edges of a prism over a hexagon.
    assert len(lines) == 18
    assert len(_cell_edges(np.ones((4, 5, 6), dtype=bool))) == 12


def test_the_page_holds_each_region_once_with_its_name(scenes):
    data = data_of(page(scenes, "regions"))
    first, second = data["scenes"]
    assert set(first["regions"]) == set(SHOWN) == set(second["regions"])
    assert first["regions"]["disc"] == second["regions"]["disc"]
    assert first["regions"]["top"] != second["regions"]["top"]
    assert first["workspace"] == second["workspace"]
    # `top` and `space` move with their object; a footprint has the lines of its polygon.
    assert len(data["outlines"]) == len(SHOWN) + 1 + 2 - 1


def test_a_region_that_nothing_needs_has_no_place(scenes):
    assert "unused" not in scenes[0].regions
    used = PROGRAM + "\nnew Object in unused, with allowCollisions True"
    (scene,) = scenic.scenarioFromString(used).sample(1, seed=3)
    center = scene.regions["unused"].center
    assert np.hypot(*(np.array(list(scene.objects[-1].position)) - list(center))[:2]) <= 2


def test_chains_stay_apart_and_whole() -> None:
    chains = [
        [(0, 0, 0), (1, 0, 0), (1, 1, 0)],
        [(5, 0, 0), (6, 0, 0), (6, 1, 0), (7, 1, 2)],
        [(9, 9, 9), (8, 9, 9)],
    ]
    lines = outlines(PathRegion(polylines=chains))
    assert [[tuple(point) for point in line] for line in lines] == chains


def test_nothing_is_drawn_of_what_has_no_bounds() -> None:
    assert outlines(everywhere) == outlines(nowhere) == []


def test_what_is_left_of_a_plane_is_hatched() -> None:
    """Lines across the rest of a disc, and none across a volume's rest."""
    disc, ball = CircularRegion((0, 0, 1), 4), SpheroidRegion((6, 6, 6), (0, 0, 1))
    for members, expected in (((disc, ball), True), ((ball, disc), True)):
        lines = outlines(IntersectionRegion(*members))
        inner = [line for line in lines if (np.hypot(line[:, 0], line[:, 1]) < 2.9).any()]
        assert bool(inner) is expected
        assert all((line[:, 2] == 1).all() for line in inner)
        assert all((np.hypot(line[:, 0], line[:, 1]) < 3.1).all() for line in inner)
    box = BoxRegion((2, 2, 2), (1, 0, 1))
    for line in outlines(IntersectionRegion(ball, box)):
        assert all(
            (np.abs(np.abs(line - box.position.row) - 1) < 1e-9).any(axis=1)
            | (np.abs(np.linalg.norm(line - [0, 0, 1], axis=1) - 3) < 1e-9)
        )


def test_of_too_many_lines_the_longest_are_drawn_in_their_order() -> None:
    lengths = np.random.default_rng(2).permutation(4000) + 1.0
    lines = [np.array([[number, 0, 0], [number, length, 0]]) for number, length in enumerate(lengths)]
    kept = _longest(lines)
    expected = np.flatnonzero(lengths > 1000)
    assert [int(line[0, 0]) for line in kept] == expected.tolist()
    assert _longest(lines[:3000]) == lines[:3000]


@pytest.mark.parametrize("size", [(1, 1, 1), (1, 3, 0.2)])
@pytest.mark.parametrize("name", ["box", "table", "hollow", "cone", "cylinder", "prism"])
def test_edges_of_meshes_are_those_at_which_faces_meet_at_an_angle(
    name: str, size: tuple[float, ...]
) -> None:
    """None within a flat side, however it is divided, and all others, whatever the order of the faces is."""
    if name == "prism":
        polygon = shapely.Polygon(
            [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)], [[(0.5, 0.3), (1, 0.3), (0.5, 0.6)]]
        )
        whole = trimesh.creation.extrude_polygon(polygon, 1)
    else:
        whole = trimesh.Trimesh(np.array(SHAPES[name]().vertices), SHAPES[name]().faces, process=False)
    whole.vertices *= size
    whole = whole.subdivide().subdivide() if name in ("box", "prism") else whole
    whole.faces = np.random.default_rng(3).permutation(whole.faces)
    sharp = whole.face_adjacency_edges[whole.face_adjacency_angles > np.radians(25)]
    expected = {frozenset(map(tuple, np.round(whole.vertices[pair], 9).tolist())) for pair in sharp}
    lines = _mesh_lines(Mesh(whole.vertices, whole.faces), None, 0.0)
    found = {frozenset(map(tuple, np.round(line, 9).tolist())) for line in lines if len(line) == 2}
    assert expected <= found
    assert name in ("cone", "cylinder") or found == expected  # which have sections besides
