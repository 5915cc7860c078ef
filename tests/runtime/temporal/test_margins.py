"""By how much requirements hold: the signed distances of comparisons, regions and objects, against values by hand."""

import math
import time
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import ConvexHull

import scenic
from scenic.runtime.dynamics.margins import margin
from scenic.runtime.geometry.contact.broadphase import boxes_overlap
from scenic.runtime.geometry.contact.depth import convex_depth, convex_gap
from scenic.runtime.geometry.contact.scalar_bodies import PlacedBody, overlap, placed
from scenic.runtime.geometry.containment.distance import between as gaps
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.visibility_margins import clearance
from scenic.runtime.values.values import Orientation, Vector
from scenic.simulators.dummy import DummySimulator

SCENE = """
zone = RectangularRegion((0, 2), 0, 10, 10)
shelf = RectangularRegion((0, 2, 0.4), 0, 10, 10)
room = BoxRegion(dimensions=(20, 20, 20), position=(0, 0, 0))
far = RectangularRegion((0, 20), 0, 10, 10)
row = PointSetRegion('row', [(0, 0, 0), (0, 1, 0), (0, 2, 0), (0, 3, 0)])
ego = new Object with name 'ego'
wall = new Object at (0, 6), with shape SpheroidShape()
block = new Object at (0.7, 0.4), with allowCollisions True
cone = new Object at (0.7, 0.4), with allowCollisions True, with shape ConeShape()
"""


def robustness(condition: str, steps: int, program: str = SCENE) -> float:
    """Of a requirement while everything moves North by a metre in each step."""
    scene = scenic.scenarioFromString(f"{program}require {condition}\n").sample(1, seed=0)[0]
    done = DummySimulator(drift=1).simulate(scene, maxSteps=steps, robustness=True)
    assert done is not None
    assert done.result is not None
    (outcome,) = done.result.requirements
    assert outcome.robustness is not None
    return outcome.robustness


@pytest.mark.parametrize(
    ("condition", "margin"),
    [
        ("always ego.position.y < 10", 7),
        ("eventually 2 < ego.position.y <= 4", 1),
        ("eventually ego.position.y == 2", math.inf),
        ("always ego.position.x != 3", 3),
        ("not always ego.position.y == 0", 3),
        ("always ego.position != (4, 0, 0)", 4),
        ("always ego.position != (4, 3, 0)", 4),
        ("always ego.position != (3, -4, 0)", 5),
        ("always ego.position in zone", 3),
        ("always ego in zone", 2.5),
        ("always ego.position in shelf", 3),
        ("always ego in shelf", 2.5),
        ("eventually wall.position not in shelf", 2),
        ("always wall.position not in zone implies ego in zone", 2.5),
        ("eventually wall.position not in zone", 2),
        ("always ego.position in room", 7),
        ("always ego in room", 6.5),
        ("always ego.position in row", math.inf),
        ("always wall in room", 0.5),
        ("eventually wall not in zone", 2.5),
        ("always ego intersects block", 0.3),
        ("always cone intersects block", 2 / 5**0.5),  # along the normal of its side
        ("always ego not in far", 12.5),  # by its corner that is farthest from there
        ("always not (ego intersects wall)", 5),
        ("always ego.name == 'ego'", math.inf),
        # A vector on either side, and places of the plane.
        ("always (4, 0, 0) != ego.position", 4),
        ("always ego.position != (0, -4)", 4),
        ("always (3, -4) != ego.position", 5),
        # What has no distance just holds, as it is or negated.
        ("always (1, 2) != (1, 3)", math.inf),
        ("always ego.name < 'f'", math.inf),
        ("always not (ego.name < 'a')", math.inf),
        ("always ego.name in ['ego']", math.inf),
        ("always ego.position not in [(4, 0, 0)]", math.inf),
        ("always ego not in [wall, block]", math.inf),
        ("always ego.name not in ('wall', 'block')", math.inf),
        ("always ego intersects zone", math.inf),
        ("always ego in everywhere", math.inf),
        ("always ego.position not in nowhere", math.inf),
        ("always ego != wall", math.inf),
        # A number beside something else.
        ("always ego.position != 4", math.inf),
        ("always 4 != ego.position", math.inf),
        ("always ego.name != 4", math.inf),
        ("always not (4 == ego.name)", math.inf),
        ("always ego.position.x != None", math.inf),
        ("always 1 > ego.position.x >= -3", 1),
        # Directions, in radians.
        ("always wall ahead of ego", math.radians(89.99)),
        ("always wall.position left of block", math.atan(0.7 / 5.6) - math.radians(0.01)),
        ("always block right of ego", math.atan2(0.7, 0.4) - math.radians(0.01)),
        ("always ego behind wall", math.pi - math.radians(90.01)),
        # A point as its place, and lines, that have no inside.
        ("always (new Point at (0, 1)) in zone", 4),
        ("always wall.position not in PolylineRegion([(-3, -9), (-3, 99)])", 3),
        ("always ego.position in PolylineRegion([(0, -9), (0, 99)])", math.inf),
    ],
)
def test_margins(condition: str, margin: float) -> None:
    assert robustness(condition, steps=3) == pytest.approx(margin, abs=1e-3)


HOLES = """
import trimesh
ring = MeshShape(trimesh.creation.annulus(2, 4, 1, sections=32), dimensions=(8, 8, 1))
zone = CircularRegion((0, 0), 9).difference(CircularRegion((0, 0), 1, resolution=64))
spot = new OrientedPoint at (0, 5)
ego = new Object with shape ring, with width 8, with length 8, with allowCollisions True
block = new Object at (3, 0), with width 0.5, with length 0.5, with height 0.5, with allowCollisions True
plate = new Object with width 4, with length 4, with allowCollisions True
"""


@pytest.mark.parametrize(
    ("condition", "margin"),
    [
        ("spot in zone", 4),
        ("not (spot in CircularRegion((0, 9), 1, resolution=256))", 3),
        ("eventually spot.position not in zone or True", math.inf),
        # Of concave shapes no depth is known, whichever of the two is one.
        ("ego intersects block", math.inf),
        ("block intersects ego", math.inf),
        # Over a hole all corners are within, and yet it is not known by how much the whole is not.
        ("plate not in zone", math.inf),
        ("ego.position not in zone", 1),
    ],
)
def test_margins_where_there_are_holes(condition: str, margin: float) -> None:
    assert robustness(condition, 0, HOLES) == pytest.approx(margin, abs=1e-2)


def test_a_condition_that_fails_to_be_computed_holds_neither_as_it_is_nor_negated() -> None:
    program = "table = {0: 1}\nego = new Object\n"
    for condition in ("table[ego.y] > 3", "not (table[ego.y] > 3)", "not (table[ego.y] > 3 and ego.y < 9)"):
        assert robustness(f"always (ego.y < 9 or {condition})", 3, program) == pytest.approx(6)


def test_what_is_round_is_as_deep_inside_as_its_hull_not_its_box() -> None:
    program = "disc = CircularRegion((0, 0), 9)\nego = new Object with shape CylinderShape(), with width 2, with length 2\n"
    assert robustness("always ego in disc", 3, program) == pytest.approx(5, abs=0.01)


def test_the_margin_of_the_first_state_decides_outside_of_temporal_operators() -> None:
    assert robustness("ego.position in zone", steps=3) == pytest.approx(3)


def test_boxes_are_as_deep_in_each_other_as_one_has_to_move() -> None:
    random = np.random.default_rng(0)
    checked = 0
    for _ in range(300):
        turns = [Orientation.fromEuler(*random.uniform(-3, 3, 3).tolist()) for _ in range(2)]
        sizes = random.uniform(0.5, 2, (2, 3))
        where = random.uniform(-0.8, 0.8, 3)
        one, other = (
            placed(tuple(place), turn.q, tuple(size), primitives.box())
            for place, turn, size in zip(([0.0] * 3, where.tolist()), turns, sizes.tolist(), strict=True)
        )
        depth = overlap(one, other)
        if depth < 0.05:
            continue
        checked += 1
        ways = random.normal(size=(400, 3))
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        for share, parts in ((0.98, False), (1.02, True)):
            moved = where + share * depth * np.vstack([ways, _normals(one, other)])
            pose = Poses(moved, np.array([turns[1].q]), sizes[1:])
            meet = boxes_overlap(Poses.fixed((0, 0, 0), turns[0].q, sizes[0]), pose)
            # By less than the depth no way leads out, by a little more one does, across a face or two edges.
            assert bool((~meet).any()) is parts
    assert checked > 100


@pytest.mark.parametrize(
    "kinds", [("cylinder", "cone"), ("spheroid", "box"), ("cylinder", "cylinder"), ("box", "box")]
)
def test_convex_solids_are_as_deep_in_each_other_as_the_hull_of_all_differences_says(
    kinds: tuple[str, str],
) -> None:
    random = np.random.default_rng(1)
    corners = [getattr(primitives, kind)().vertices for kind in kinds]
    checked = 0
    for _ in range(12):
        first, second = (
            Orientation.fromEuler(*random.uniform(-3, 3, 3).tolist()).r.apply(
                unit * random.uniform(0.3, 2, 3)
            )
            for unit in corners
        )
        second = second + random.uniform(-0.4, 0.4, 3)
        differences = (first[:, None] - second[None]).reshape(-1, 3)
        depth = -ConvexHull(differences).equations[:, 3].max()
        if depth <= 0:
            continue
        checked += 1
        assert convex_depth(first, second) == pytest.approx(depth, rel=1e-7, abs=1e-9)
    assert checked > 5


@pytest.mark.parametrize(
    "kinds", [("cylinder", "cone"), ("spheroid", "box"), ("spheroid", "spheroid"), ("box", "box")]
)
def test_convex_solids_are_as_far_apart_as_their_faces(kinds: tuple[str, str]) -> None:
    random = np.random.default_rng(2)
    meshes = [getattr(primitives, kind)() for kind in kinds]
    for far in (0.01, 0.5, 3, 1000):
        turns = [Orientation.fromEuler(*random.uniform(-3, 3, 3).tolist()).q for _ in range(2)]
        sizes = random.uniform(0.3, 2, (2, 3)).tolist()
        way = random.normal(size=3)
        where = way / np.linalg.norm(way) * (far + np.linalg.norm(sizes, axis=1).sum() / 2)
        places = [(0.0, 0.0, 0.0), tuple(where.tolist())]
        poses = [Poses.fixed(*pose) for pose in zip(places, turns, map(tuple, sizes), strict=True)]
        corners = [pose.to_world(mesh.vertices[None])[0] for pose, mesh in zip(poses, meshes, strict=True)]
        bodies = [Body((mesh,), None, pose) for mesh, pose in zip(meshes, poses, strict=True)]
        assert convex_gap(*corners) == pytest.approx(float(gaps(*bodies, 1)[0]), rel=1e-9)


def test_gaps_of_faces_edges_and_corners() -> None:
    box = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    assert convex_gap(box, box + np.array((2.5, 0.3, 0.2))) == pytest.approx(0.5, rel=1e-12)  # faces
    assert convex_gap(box, box + np.array((5, 6, 0.2))) == pytest.approx(5, rel=1e-12)  # edges
    assert convex_gap(box, box + np.array((3, 4, 4))) == pytest.approx(3, rel=1e-12)  # corners
    assert convex_gap(box, box + np.array((2, 0.3, 0.2))) == pytest.approx(0, abs=1e-9)  # touching
    assert convex_gap(box, box + np.array((2 + 1e-6, 0, 0))) == pytest.approx(1e-6, rel=1e-3)
    assert convex_gap(box[:1], box + np.array((9, 0, 0))) == pytest.approx(9, rel=1e-12)


def test_solids_that_touch_or_are_one_in_the_other() -> None:
    box = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    assert convex_depth(box, box + np.array((2, 0.3, 0.2))) == pytest.approx(0, abs=1e-12)
    assert convex_depth(box, box + np.array((0.5, 0, 0))) == pytest.approx(1.5)
    flat = box * np.array((1, 1, 0))
    assert convex_depth(flat, flat) == 0
    assert convex_depth(0.1 * box, box) == pytest.approx(1.1)
    assert convex_depth(1e-3 * box, 1e-3 * (box + np.array((1.5, 0, 0)))) == pytest.approx(5e-4)


def _normals(one: PlacedBody, other: PlacedBody) -> np.ndarray:
    faces = [*one.axes, *other.axes]
    edges = [np.cross(a, b) for a in one.axes for b in other.axes]
    ways = np.array([*faces, *edges])
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    return np.vstack([ways, -ways])


def test_margins_of_many_corners_cost_no_more_than_a_few() -> None:
    """A ball has hundreds: they are measured at once."""
    robustness("always wall in room", steps=1)
    begun = time.process_time()
    assert robustness("always wall in room", steps=3) == pytest.approx(0.5, abs=1e-3)
    assert time.process_time() - begun < 2


def test_a_chain_has_a_margin_only_if_all_of_its_parts_have_one() -> None:
    """It is the least of theirs; where the margin of one is not known, that of the whole is not."""
    assert margin(("<", "<=", ">"), (1.0, 3.0, 3.5, 2.0)) == 0.5
    assert margin(("<", ">="), (3.0, 1.0, 0.0)) == -2.0
    # A point on a border is known to be on it.
    disc = CircularRegion((0, 0), 2)
    for symbol in ("in", "not in"):
        assert margin([symbol], (Vector(0, 2, 0), disc)) == pytest.approx(0, abs=1e-12)
    assert margin(["<"], (3.0, 3.0)) == 0
    for place in range(3):
        symbols, operands = ["<"] * 3, [1.0, 2.0, 3.0, 4.0]
        symbols[place] = "is"
        assert margin(symbols, operands) is None
    for place in range(4):
        others: list[object] = [1.0, 2.0, 3.0, 4.0]
        others[place] = "text"
        assert margin(["<"] * 3, others) is None


@pytest.mark.parametrize(
    ("condition", "margin"),
    [
        ("always ego.position.y < limit", 5 - 3),
        ("always ego.position.y < low()", 5 - 3),
        ("always ego.position.y < start", 9 - 3),
        ("eventually ego.position.y > drawn", 3 - 1),
    ],
)
def test_margins_are_those_of_the_values_in_the_simulation(condition: str, margin: float) -> None:
    """Of names as they were drawn for the scene, or as a behavior has assigned them since."""
    program = """
limit = 9
start = limit
drawn = Range(1, 1)
def low(): return limit
behavior Lower():
    global limit
    while True:
        limit = limit - 2 if limit > 5 else 5
        wait
ego = new Object with behavior Lower
"""
    assert robustness(condition, 3, program) == pytest.approx(margin, abs=1e-6)


SIGHTS = """
class Eye:
    viewAngles: (60 deg, 60 deg)
    visibleDistance: 50
    cameraOffset: (0, 0, 0)
ego = new Eye at (0, 0, 0), with width 0.1, with length 0.1, with height 0.1
wall = new Object at (0, 10, 0), with width 4, with height 4, with length 0.02
"""


def test_what_is_seen_has_a_margin_of_shares_and_angles() -> None:
    """Angles and shares by hand; the grid of directions is 2 degrees wide."""
    boxes = (
        "half = new Object at (4, 20, 0), with width 2, with length 0.01, with height 2\n"
        "whole = new Object at (8, 20, 0), with width 1, with length 1, with height 1\n"
        "out = new Object at (-20, 10, 0), with width 1, with length 1, with height 1\n"
    )
    ego, wall, half, whole, out = scenic.scenarioFromString(SIGHTS + boxes).sample(1, seed=0)[0].objects

    def at(degrees: float, distance: float) -> Vector:
        angle = math.radians(degrees)
        return Vector(distance * math.sin(angle), distance * math.cos(angle), 0)

    edge = math.degrees(math.atan(2 / 10))  # of the wall
    for target, wanted, near in (
        # To the border of the view at 30 degrees.
        (at(25, 30), math.radians(5), 0.04),
        (at(50, 30), -math.radians(20), 0.04),
        # Behind the wall, and beside it.
        (at(0, 20), -math.radians(edge), 0.04),
        (at(5, 20), math.radians(5 - edge), 0.04),
        (at(15, 20), math.radians(15 - edge), 0.04),
        # Near the end of the range, and beyond it.
        (at(20, 49), 0.02, 1e-6),
        (at(20, 55), -0.1, 1e-6),
        (half, 0.5, 0.1),
        (whole, 1 - math.hypot(7.5, 19.5) / 50, 0.02),
        (out, math.radians(30) - math.atan2(19.5, 10.5), 0.06),
    ):
        seen = bool(ego.canSee(target, [wall]))
        found = clearance(ego, target, [wall], seen=seen)
        assert (found > 0) == seen, target
        assert found == pytest.approx(wanted, abs=near), target
    assert (
        robustness(
            "always ego can see (0, 50, 0)", 2, SIGHTS.replace("new Object at (0, 10", "new Object at (0, -9")
        )
        > 0
    )


def test_margins_of_what_moves_into_view_grow() -> None:
    cars = "".join(
        f"new Object at ({x}, 20, 0), with width 1, with length 1, with allowCollisions True\n"
        for x in np.linspace(8, 18, 21).tolist()
    )
    ego, wall, *cars = scenic.scenarioFromString(SIGHTS + cars).sample(1, seed=0)[0].objects
    values = [clearance(ego, car, [wall], seen=bool(ego.canSee(car, [wall]))) for car in cars]
    assert values[0] > 0 > values[-1]
    assert all(a >= b - 0.03 for a, b in pairwise(values))
