"""Inputs at which small faults show: sides of turned things, ends of ranges, zeros that are known beforehand."""

from typing import Any

import numpy as np
import pytest
import shapely
import trimesh

from scenic.graph.draws import Counter, LaneOwners, open_unit
from scenic.runtime.geometry.containment import body_points
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from tests.runtime.boundaries import Thing, unit_mesh
from tests.runtime.geometry.samples import SHAPES
from tests.runtime.programs import euler, params, scenario

SIDES = {"top": (2, 1), "bottom": (2, -1), "left": (0, -1), "right": (0, 1), "front": (1, 1), "back": (1, -1)}
THINGS = [
    Thing("box", (1, 2, 3), (1, 2, 3), (0.3, 0.2, 0.4)),
    Thing("cylinder", (2, 1, 3), (0, 0, 1), (0.5, -0.6, 0)),
    Thing("cone", (3, 2, 1), (-1, 0, 0), (0, 0.3, 0.4)),
]
OWN = {"box": "BoxShape()", "cylinder": "CylinderShape()", "cone": "ConeShape()"}


def faces_of(thing: Thing, side: str) -> trimesh.Trimesh:
    """The faces whose normals in the world reach the threshold of one half, as a mesh."""
    axis, sign = SIDES[side]
    mesh = trimesh.Trimesh(thing.vertices(), unit_mesh(thing.shape)[1], process=False)
    mine = mesh.face_normals[:, axis] * sign >= 0.5
    return mesh.submesh([np.flatnonzero(mine)], append=True) if mine.any() else None


PRESENT = [(thing, side) for thing in THINGS for side in SIDES if faces_of(thing, side) is not None]


def test_there_are_enough_sides() -> None:
    assert len(PRESENT) >= 15


@pytest.mark.parametrize(("thing", "side"), PRESENT, ids=lambda part: getattr(part, "shape", part))
def test_distances_to_sides(thing: Thing, side: str) -> None:
    faces = faces_of(thing, side)
    text = (
        f"x = new Object at {thing.position}, facing {thing.angles}, with shape {OWN[thing.shape]},"
        f" with width {thing.size[0]}, with length {thing.size[1]}, with height {thing.size[2]}\n"
        f"p = new Point at (Range(-4, 4), Range(-4, 4), Range(-4, 4))\ns = x.{side}Surface\n"
        "param p = p.position, d = distance from p to s, near = (new Point in s).position\n"
    )
    scenes = scenario(text).sample(12, seed=2)
    points = np.array([tuple(scene.params["p"]) for scene in scenes])
    _, expected, _ = trimesh.proximity.closest_point_naive(faces, points)
    np.testing.assert_allclose([scene.params["d"] for scene in scenes], expected, atol=1e-9)
    drawn = np.array([tuple(scene.params["near"]) for scene in scenes])
    assert trimesh.proximity.closest_point_naive(faces, drawn)[1].max() < 1e-9


@pytest.mark.parametrize("name", ["box", "cylinder", "cone"])
def test_distances_from_boxes_are_never_more(name: str) -> None:
    """Sizes that differ in each direction, turned; of a box itself they are the distances."""
    rng = np.random.default_rng(3)
    size = rng.uniform(0.3, 3, (40, 3))
    turns = [euler(*angles) for angles in rng.uniform(-3, 3, (40, 3))]
    position = rng.uniform(-1, 1, (40, 3))
    points = position + rng.normal(0, 3, (40, 3))
    from scenic.runtime.geometry.meshes.mesh import Mesh

    sample = SHAPES[name]()
    mesh = Mesh(np.asarray(sample.vertices), np.asarray(sample.faces))
    poses = Poses(position, np.array([turn.as_quat() for turn in turns]), size)
    found = body_points.distances_from_box(Body((mesh,), None, poses), points)
    local = np.array([turn.inv().apply(point) for turn, point in zip(turns, points - position, strict=True)])
    beside = np.maximum(np.abs(local) - size / 2, 0)
    np.testing.assert_allclose(found, np.sqrt((beside**2).sum(axis=1)), atol=1e-12)
    exact = body_points.distances_to_surface(Body((mesh,), None, poses), points, None, 0.0)
    outside = (beside > 0).any(axis=1)
    assert (found[outside] <= exact[outside] + 1e-12).all()


def test_inradii_of_unequal_boxes() -> None:
    for size in ((1, 2, 3), (3, 1, 2), (2, 3, 1)):
        text = f"x = new Object with width {size[0]}, with length {size[1]}, with height {size[2]}\n"
        found = params(text + "param r = x.inradius, q = x.planarInradius\n")
        assert found == {"r": 0.5, "q": min(size[:2]) / 2}


# Ends of ranges


@pytest.mark.parametrize(("low", "high"), [(-1.7e308, 1.7e308), (1.7e308, -1.7e308), (-1.6e308, 0.4e308)])
def test_ranges_whose_width_overflows(low: float, high: float) -> None:
    text = f"u = Uniform(1, 1)\nparam x = Range({low!r}, {high!r}), y = Range({low!r} * u, {high!r} * u)\n"
    scenes = scenario(text).sample(400, seed=1)
    for name in "xy":
        share = np.array([scene.params[name] / 2 - low / 2 for scene in scenes]) / (high / 2 - low / 2)
        assert ((share >= 0) & (share <= 1)).all()
        counts, _ = np.histogram(share, 4, (0, 1))
        assert (np.abs(counts - 100) < 45).all()


@pytest.mark.parametrize("number", [2**53 + 1, 2**60 + 3, -(2**58) - 1])
def test_large_whole_numbers_stay_themselves(number: int) -> None:
    text = f"n = DiscreteRange({number}, {number} + 2)\nparam n = n, same = [int(n), round(n), +n, abs(n), -(-n), n // 1, max(n, 0), min(n, 0)]\n"
    for scene in scenario(text).sample(6, seed=1):
        n = scene.params["n"]
        assert n - number in (0, 1, 2)
        assert scene.params["same"] == [n, n, n, abs(n), n, n, max(n, 0), min(n, 0)]
        assert {type(item) for item in scene.params["same"]} == {int}


def test_whole_parts_of_negative_numbers() -> None:
    text = "x = Range(-3, 3)\nparam x = x, parts = [int(x), round(x), x // 1, x % 1, divmod(x, 2)[0], round(x, 1)]\n"
    for scene in scenario(text).sample(30, seed=1):
        x = scene.params["x"]
        assert scene.params["parts"] == [int(x), round(x), x // 1, x % 1, divmod(x, 2)[0], round(x, 1)]


def test_rounding_gives_the_type_that_python_gives() -> None:
    """A whole number only where no digits are asked for; those may be negative."""
    text = "x = Range(-300, 300)\nn = DiscreteRange(-300, 300)\nparam x = x, n = n\n"
    asked = [f"round({name}{digits})" for name in "xn" for digits in ("", ", None", ", 0", ", 2", ", -2")]
    asked += [f"{name}.__round__({digits})" for name in "xn" for digits in ("", "0", "2", "-2")]
    for scene in scenario(text + f"param parts = [{', '.join(asked)}]\n").sample(20, seed=1):
        expected = [eval(part, {"x": scene.params["x"], "n": scene.params["n"]}) for part in asked]
        found = scene.params["parts"]
        assert found == expected
        assert list(map(type, found)) == list(map(type, expected))


# Draws


def test_draws_lie_in_the_open_interval_and_are_centred() -> None:
    """Each word stands for the middle of its part of the interval: never an end, and none nearer to one end."""
    words = np.array([0, 1 << 12, (1 << 64) - 1, (1 << 64) - 1 - (1 << 12), 1 << 63], dtype=np.uint64)
    found = open_unit(words)
    assert found.tolist() == [2.0**-53, 3 * 2.0**-53, 1 - 2.0**-53, 1 - 3 * 2.0**-53, 0.5 + 2.0**-53]


def test_keys_differ_in_seed_scene_attempt_and_address() -> None:
    base = (7, 3, 2, 5)
    variants = [
        base,
        (8, 3, 2, 5),
        (-7, 3, 2, 5),
        (7 + 2**64, 3, 2, 5),
        (7, 4, 2, 5),
        (7, 3, 3, 5),
        (7, 2, 3, 5),
        (7, 3, 2, 6),
    ]
    found = set()
    for seed, scene, attempt, place in variants:
        (row,) = Counter(LaneOwners.of(seed, scene, attempt).keys).uniforms(
            np.array([place], dtype=np.uint64)
        )
        found.add(float(row[0]))
    assert len(found) == len(variants)


# What is known of an orientation about the vertical axis


def test_angles_of_upright_things() -> None:
    text = (
        "yaw = Range(-9, 9)\nx = new Object facing yaw\no = x.orientation\nparam yaw = yaw, angles = o.eulerAngles,"
        " own = (x.yaw, x.pitch, x.roll), back = o.inverse.eulerAngles, up = o * (0, 0, 1), ahead = o * (0, 1, 0)\n"
    )
    for scene in scenario(text).sample(6, seed=1):
        found = scene.params
        turned = (found["yaw"] + np.pi) % (2 * np.pi) - np.pi
        assert found["angles"][0] == pytest.approx(turned)
        assert found["own"][0] == pytest.approx(turned)
        assert found["back"][0] == pytest.approx(-turned)
        for name in ("angles", "own", "back"):
            assert tuple(found[name][1:]) == (0, 0)
        assert tuple(found["up"]) == pytest.approx((0, 0, 1))
        assert tuple(found["ahead"]) == pytest.approx((-np.sin(turned), np.cos(turned), 0))


# Slices of volumes


@pytest.mark.parametrize("scale", [1e-3, 1, 1e3])
def test_volumes_cut_at_their_own_ends(scale: float) -> None:
    """The polygon of a face in the plane, whatever the size."""
    text = (
        f"b = BoxRegion(({2 * scale}, {3 * scale}, {scale}), position=(0, 0, {scale / 2}))\n"
        f"def cut(z): return b.intersect(RectangularRegion((0, 0, z), 0, {9 * scale}, {9 * scale})).area\n"
        f"param areas = [cut(0), cut({scale / 3}), cut({scale})]\n"
    )
    np.testing.assert_allclose(params(text)["areas"], [6 * scale**2] * 3, rtol=1e-5)


def test_shapely_agrees_about_discs() -> None:
    """The polygon that has to hold the outline of an object is inscribed: an object in the gap is outside."""
    disc = shapely.Point(0, 0).buffer(5, quad_segs=32)
    middle = np.pi / 128  # half way between two corners
    edge = 5 * np.cos(middle)
    for radius, inside in ((edge - 2e-4, True), (5 - 1e-4, False)):
        place = (float(radius * np.cos(middle)), float(radius * np.sin(middle)), 0)
        assert disc.contains(shapely.Point(*place[:2])) is inside
        text = (
            "workspace = Workspace(CircularRegion((0, 0), 5))\n"
            f"x = new Object at {place}, facing {middle}, with width 1e-5, with length 1e-5, with height 1\n"
        )
        outcome: Any = None
        try:
            scenario(text)
        except Exception as error:  # noqa: BLE001 - whether there is one is asked
            outcome = error
        assert (outcome is None) is inside


def test_primitive_solids() -> None:
    """Closed, wound outwards, of unit extents, and of the volumes of their prisms and pyramids."""
    for sections in (4, 8, 24):
        expected = sections / 2 * np.sin(2 * np.pi / sections) / 4
        solid = trimesh.Trimesh(
            primitives.cylinder(sections).vertices, primitives.cylinder(sections).faces, process=False
        )
        assert solid.is_volume
        assert solid.volume == pytest.approx(expected)
    for mesh, low, high in (
        (primitives.box(), 1, 1),
        (primitives.cone(), 0.95 * np.pi / 12, np.pi / 12),
        (primitives.spheroid(), 0.95 * np.pi / 6, np.pi / 6),
    ):
        solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        assert solid.is_volume
        assert low - 1e-12 <= solid.volume <= high + 1e-12
        np.testing.assert_allclose(solid.bounds, [[-0.5] * 3, [0.5] * 3], atol=1e-12)


def test_planar_inradii_are_those_seen_from_above() -> None:
    text = (
        "import trimesh\nego = new Object with shape ConeShape(), with width 2, with length 4, with height 6\n"
        "ring = new Object at (30, 0), with shape MeshShape(trimesh.creation.annulus(1, 2, 1))\n"
        "param r = ego.inradius, q = ego.planarInradius, hollow = ring.planarInradius\n"
    )
    assert params(text) == pytest.approx({"r": 0.492616, "q": 0.99879, "hollow": 0}, abs=1e-5)


def test_boxes_of_sides_hold_their_faces_alone() -> None:
    found = params(
        "ego = new Object with width 2\nparam x = ego.bottomSurface.AABB, y = ego.leftSurface.AABB"
    )
    np.testing.assert_allclose(found["x"], [(-1, -0.5, -0.5), (1, 0.5, -0.5)])
    np.testing.assert_allclose(found["y"], [(-1, -0.5, -0.5), (-1, 0.5, 0.5)])
