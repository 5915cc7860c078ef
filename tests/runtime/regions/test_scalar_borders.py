"""What is said of fixed regions, contacts and views on plain floats, right beside where it changes.

Something moves along a line, and bisection with an oracle finds where the answer changes. There nothing is certain; a
hair's breadth away every answer that is given is the oracle's; and a centimetre away boxes get one.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import shapely
from scipy.spatial.transform import Rotation

from scenic.graph import quaternions
from scenic.runtime.geometry.contact.collision import collide
from scenic.runtime.geometry.contact.scalar_bodies import PlacedBody, gap, is_near_way, meet, overlap, placed
from scenic.runtime.geometry.containment.distance import between
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats, Poses
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.planar import PolygonalRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.scalar_regions import Single
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from scenic.runtime.values.values import Orientation, Vector
from tests.amounts import amount
from tests.runtime.boundaries import CENTIMETRE, compare, flip
from tests.runtime.geometry.samples import SHAPES

ANGLES = (0.4, 0.2, -0.3)
TURN = Orientation.fromEuler(*ANGLES)
SIZE = np.array([5.0, 4.0, 3.0])
CENTRE = np.array([0.5, -0.25, 1.0])
CORNERS = [(-3, -2), (3, -2), (4, 3), (-3, 3)]
NOTCHED = [(-4, -4), (4, -4), (4, 4), (0, 0.5), (-4, 4)]


@dataclass(frozen=True)
class Case:
    """A region, which points it holds, and somewhere well inside."""

    region: Region
    holds: Callable[[Floats], bool]
    middle: tuple[float, float, float]
    exact: bool = True
    """Whether boxes get an answer a centimetre from where it changes."""

    @property
    def single(self) -> Single:
        single = self.region.at_once
        assert single is not None
        return single


def rectangle(width: float, length: float, heading: float, x: float, y: float) -> Callable[[Floats], bool]:
    turn = Rotation.from_euler("z", -heading)

    def holds(points: Floats) -> bool:
        local = np.abs(turn.apply(points - [x, y, 0])[:, :2])
        return bool((local <= [width / 2, length / 2]).all())

    return holds


def polygon(corners: Any) -> Callable[[Floats], bool]:
    outline = shapely.Polygon(corners)
    shapely.prepare(outline)
    return lambda points: bool(outline.covers(shapely.MultiPoint(points[:, :2]).convex_hull))


def solid(inside: Callable[[Floats], Floats]) -> Callable[[Floats], bool]:
    inverse = Rotation.from_quat(TURN.q).inv()
    return lambda points: bool((inside(inverse.apply(points - CENTRE) / (SIZE / 2)) <= 1).all())


ROUND = [
    (3 * math.cos(part * math.pi / 64) + 1, 3 * math.sin(part * math.pi / 64) - 1) for part in range(128)
]
CASES = {
    "rectangle": Case(RectangularRegion((1, 2, 0.5), 0.3, 7, 4), rectangle(7, 4, 0.3, 1, 2), (1.2, 1.9, 0.5)),
    "upright rectangle": Case(
        RectangularRegion((0, 0, -2), 0, 4, 6), rectangle(4, 6, 0, 0, 0), (0.1, -0.3, -2)
    ),
    "disc": Case(CircularRegion((1, -1, 0.25), 3), polygon(ROUND), (1.1, -0.8, 0.25)),
    "convex polygon": Case(PolygonalRegion(CORNERS, z=1.5), polygon(CORNERS), (0.3, 0.4, 1.5)),
    "notched polygon": Case(PolygonalRegion(NOTCHED), polygon(NOTCHED), (-1, -1.5, 0), exact=False),
    "box": Case(
        BoxRegion(dimensions=tuple(SIZE), position=tuple(CENTRE), rotation=TURN),
        solid(lambda local: np.abs(local).max(axis=1)),
        (0.4, -0.2, 1.1),
    ),
    "ball": Case(
        SpheroidRegion(dimensions=tuple(SIZE), position=tuple(CENTRE), rotation=TURN),
        solid(lambda local: np.sqrt((local**2).sum(axis=1))),
        (0.4, -0.2, 1.1),
    ),
}


@dataclass(frozen=True)
class Moving:
    """A body of unequal sizes that moves along a line from somewhere."""

    shape: str
    start: Floats
    way: Floats
    turn: Floats
    size: tuple[float, float, float]

    def at(self, along: float) -> PlacedBody:
        x, y, z, w = self.turn.tolist()
        place = (self.start + along * self.way).tolist()
        return placed((place[0], place[1], place[2]), (x, y, z, w), self.size, mesh_of(self.shape))

    def vertices(self, along: float) -> Floats:
        local = mesh_of(self.shape).vertices * self.size
        corners: Floats = Rotation.from_quat(self.turn).apply(local) + self.start + along * self.way
        return corners


CORNER = Mesh(
    np.array([(-0.5, -0.5, -0.5), (0.5, -0.5, -0.5), (-0.5, 0.5, -0.5), (-0.5, -0.5, 0.5)]),
    np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]),
)
"""A corner of its box, which does not hold the middle of that."""


def mesh_of(shape: str) -> Mesh:
    return CORNER if shape == "corner" else SHAPES[shape]()


def moving(count: int, start: Any, *, seed: int, largest: float = 1.6) -> list[Moving]:
    """Bodies, every third of them upright, that move in all directions; one after the other of each shape."""
    random = np.random.default_rng(seed)
    made = []
    for number in range(count):
        way = random.normal(size=3)
        turn = Rotation.random(random_state=random.integers(1 << 30)).as_quat()
        if number % 3 == 0:
            turn, way = np.array([0.0, 0.0, 0.0, 1.0]), np.eye(3)[number // 3 % 3] * (-1) ** (number // 9)
        shape = [*SHAPES, "corner"][number // 2 % (len(SHAPES) + 1)] if number % 2 else "box"
        a, b, c = random.uniform(0.2, largest, 3).tolist()
        made.append(Moving(shape, np.asarray(start, float), way / np.linalg.norm(way), turn, (a, b, c)))
    return made


@pytest.mark.parametrize("name", CASES)
def test_bodies_that_nearly_leave(name: str) -> None:
    case = CASES[name]
    for item in moving(36, case.middle, seed=3, largest=1.2):

        def truth(along: float, item: Moving = item) -> bool:
            return case.holds(item.vertices(along))

        def answer(along: float, item: Moving = item) -> bool | None:
            return case.single.holds_body(item.at(along))

        if truth(20):
            continue  # straight up from a region of the plane
        compare(answer, truth, flip(truth, 0, 20), certain=case.exact and item.shape == "box")


@pytest.mark.parametrize("name", ["box", "ball"])
def test_points_that_nearly_leave(name: str) -> None:
    case = CASES[name]
    for item in moving(24, case.middle, seed=4):

        def truth(along: float, item: Moving = item) -> bool:
            return case.holds((item.start + along * item.way)[np.newaxis])

        def answer(along: float, item: Moving = item) -> bool | None:
            x, y, z = (item.start + along * item.way).tolist()
            return case.single.holds_point((x, y, z))

        change = flip(truth, 0, 20)
        for off in (1e-4, -1e-4):
            assert answer(change + off) is truth(change + off)
        if name == "ball":  # for boxes the comparison is the one that lanes make
            assert answer(change) is None
            # Whoever asks the region still gets an answer.
            place = Vector(*(item.start + change * item.way).tolist())
            assert case.region.containsPoint(place) in (True, False)


def meets_plane(vertices: Floats, height: float, holds: shapely.Geometry) -> bool:
    """Whether a convex body meets a region of the plane: by the polygon in which the plane cuts it."""
    rise = vertices[:, 2] - height
    above, below = vertices[rise >= 0], vertices[rise < 0]
    if not len(above) or not len(below):
        return False
    part = (height - below[:, np.newaxis, 2]) / (above[:, 2] - below[:, np.newaxis, 2])
    cut = below[:, np.newaxis] + part[..., np.newaxis] * (above - below[:, np.newaxis])
    return bool(shapely.MultiPoint(cut.reshape(-1, 3)[:, :2]).convex_hull.intersects(holds))


@pytest.mark.parametrize("name", [name for name in CASES if name not in ("box", "ball")])
def test_boxes_that_nearly_leave_a_plane(name: str) -> None:
    case = CASES[name]
    region: Any = case.region
    outline, height = region.polygons, float(region.height)
    shapely.prepare(outline)
    certain = 0
    for item in moving(54, case.middle, seed=5, largest=3):
        if item.shape != "box":
            continue

        def truth(along: float, item: Moving = item) -> bool:
            return meets_plane(item.vertices(along), height, outline)

        def answer(along: float, item: Moving = item) -> bool | None:
            return case.single.meets_body(item.at(along))

        assert answer(0) is True
        change = flip(truth, 0, 20)
        compare(answer, truth, change, certain=False)
        assert answer(change + 4) is False
        certain += answer(change + CENTIMETRE) is False
        # Over the middle of the body it certainly is met, where the body is there at that height.
        inside = flip(lambda along, item=item: answer(along) is True, 0, change)  # type: ignore[misc]
        assert truth(inside - 1e-6)
    assert certain > 7


def test_a_ring_does_not_meet_what_lies_in_its_hole() -> None:
    disc = CircularRegion((0, 0, 0), 0.1).at_once
    assert disc is not None
    frame = placed((0, 0, 0), (0, 0, 0, 1), (4, 4, 4), SHAPES["hollow"]())
    assert disc.meets_body(frame) is None


def test_a_body_within_a_region_that_its_own_middle_is_beside() -> None:
    turn = Rotation.align_vectors([[1, 0, 0]], [[1, 1, 1]])[0].as_quat().tolist()
    single = RectangularRegion((0, 0), 0, 4, 4).at_once
    assert single is not None
    for x, held in ((2.1, None), (0.5, True), (5.0, False)):
        body = placed((x, 0, 0), (turn[0], turn[1], turn[2], turn[3]), (1, 1, 1), CORNER)
        assert single.holds_body(body) is held


def test_a_box_at_the_corner_of_the_box_about_a_ball() -> None:
    """Their boxes meet; they need not."""
    single = CASES["ball"].single
    for part, met in ((0.95, None), (1.2, False)):
        x, y, z = (Rotation.from_quat(TURN.q).apply(part * SIZE / 2) + CENTRE).tolist()
        assert single.meets_body(placed((x, y, z), TURN.q, (0.1, 0.1, 0.1), primitives.box())) is met


def test_a_box_over_a_region_beside_its_middle() -> None:
    """Its middle is beside the region; it may reach over it all the same."""
    disc = CircularRegion((0, 0, 0), 1).at_once
    assert disc is not None
    for x, met in ((1.5, None), (2.5, False), (0.9, True)):
        assert disc.meets_body(placed((x, 0, 0), (0, 0, 0, 1), (2, 2, 2), primitives.box())) is met


def lanes(item: Moving, along: float) -> Body:
    place, turn = item.start + along * item.way, item.turn
    return Body((mesh_of(item.shape),), None, Poses.fixed(place.tolist(), turn.tolist(), item.size))


def test_boxes_that_nearly_touch() -> None:
    fixed, *others = moving(amount(15, 30), (0.3, 0.1, -0.2), seed=6)
    standing = Moving(
        "box", fixed.start, fixed.way, Rotation.from_euler("zxy", ANGLES).as_quat(), (1, 2, 0.5)
    )
    both = lanes(standing, 0)
    for item in others:
        if item.shape != "box":
            continue

        def truth(along: float, item: Moving = item) -> bool:
            return not collide([lanes(item, along), both], np.array([[0, 1]]), lanes=1).free[0]

        def answer(along: float, item: Moving = item) -> bool | None:
            found = meet(item.at(along), standing.at(0))
            assert meet(standing.at(0), item.at(along)) is found
            return found

        change = flip(truth, 0, 20, width=1e-9)
        compare(answer, truth, change, certain=True)
        # As deep as they are in each other, the second would have to be moved: then they touch.
        for along in (change - 0.1, change - 0.3):
            deep = overlap(item.at(along), standing.at(0))
            assert 0 < deep <= change - along + 1e-7
            assert deep == pytest.approx(depth(item, along, standing), abs=1e-9)


def test_boxes_turned_alike_meet_where_their_faces_do() -> None:
    """By a quarter turn, too: what rounding leaves of the products of parallel edges says nothing."""
    rng = np.random.default_rng(10)
    for number in range(300):
        turn = Rotation.random(random_state=number)
        size, axis = rng.uniform(0.3, 2, 3), number % 3
        quarter = turn * Rotation.from_euler("xyz"[axis], math.pi / 2)
        swapped = size.copy()
        swapped[[(axis + 1) % 3, (axis + 2) % 3]] = size[[(axis + 2) % 3, (axis + 1) % 3]]
        way = size * rng.uniform(-0.9, 0.9, 3)
        along = (number // 3) % 3
        for shift, met in ((1e-3, False), (-1e-3, True)):
            way[along] = size[along] + shift
            place = turn.apply(way)
            one = Moving("box", np.zeros(3), np.zeros(3), turn.as_quat(), tuple(size.tolist()))
            for other, sides in ((turn, size), (quarter, swapped)):
                two = Moving("box", place, np.zeros(3), other.as_quat(), tuple(sides.tolist()))
                assert meet(one.at(0), two.at(0)) is met
                assert overlap(one.at(0), two.at(0)) == pytest.approx(max(0.0, -shift), abs=1e-9)


@pytest.mark.parametrize("shape", ["box", "cone"])
def test_the_gap_between_convex_bodies(shape: str) -> None:
    turn = Rotation.from_euler("zxy", ANGLES).as_quat()
    standing = Moving(shape, np.array([0.3, 0.1, -0.2]), np.zeros(3), turn, (1, 2, 0.5))
    both = lanes(standing, 0)
    measured = set()
    for item in moving(10, (0.3, 0.1, -0.2), seed=9)[1::2]:

        def truth(along: float, item: Moving = item) -> bool:
            return not collide([lanes(item, along), both], np.array([[0, 1]]), lanes=1).free[0]

        change = flip(truth, 0, 5, width=1e-8)
        convex = mesh_of(item.shape).is_convex
        for beyond in (1e-3, 0.4, 9):
            found = gap(item.at(change + beyond), standing.at(0))
            assert (found is None) is not convex
            assert (gap(standing.at(0), item.at(change + beyond)) is None) is not convex
            if found is not None:
                measured.add(item.shape)
                assert found == pytest.approx(between(lanes(item, change + beyond), both, 1)[0], abs=1e-9)
                assert found == pytest.approx(gap(standing.at(0), item.at(change + beyond)), abs=1e-9)
        assert gap(item.at(change + 1e-7), standing.at(0)) is None
        inside = gap(item.at(change - CENTIMETRE), standing.at(0))
        assert inside == (0 if item.shape == shape == "box" else None)
    assert measured == {"box", "cylinder", "cone", "spheroid"}


def depth(one: Moving, along: float, other: Moving) -> float:
    """How far one box has to be moved to leave another one: by the facets of the sum of both."""
    from scipy.spatial import ConvexHull

    apart = one.vertices(along)[:, np.newaxis] - other.vertices(0)
    return float(-ConvexHull(apart.reshape(-1, 3)).equations[:, 3].max())


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("side", [1, -1])
def test_far_from_the_origin_less_is_certain(axis: int, side: int) -> None:
    """Where positions are kilometres upon kilometres, rounding is more than a millionth of a metre."""
    x, y, z = (np.eye(3)[axis] * side * 3e9).tolist()
    body = placed((x, y, z), (0, 0, 0, 1), (2, 2, 2), primitives.box())
    wide = RectangularRegion((x, y), 0, 2 + 1e-5, 2 + 1e-5).at_once
    assert wide is not None
    assert wide.holds_body(body) is None
    beside = placed((x + 2 + 1e-5, y, z), (0, 0, 0, 1), (2, 2, 2), primitives.box())
    assert meet(body, beside) is None


def test_what_is_near_a_way() -> None:
    random = np.random.default_rng(7)
    start, end, middle = random.uniform(-2, 2, (3, 300, 3))
    way = end - start
    part = np.clip(((middle - start) * way).sum(axis=1) / (way**2).sum(axis=1), 0, 1)
    apart = np.linalg.norm(start + part[:, np.newaxis] * way - middle, axis=1)
    for number in range(300):
        ends = [tuple(point[number].tolist()) for point in (start, end, middle)]
        assert is_near_way(ends[0], ends[1], ends[2], float(apart[number]))
        assert is_near_way(ends[1], ends[0], ends[2], float(apart[number]) + 1e-3)
        assert not is_near_way(ends[0], ends[1], ends[2], float(apart[number]) * 0.9 - 1e-4)
    assert is_near_way((1, 1, 1), (1, 1, 1), (1, 1, 2), 1)
    assert not is_near_way((1, 1, 1), (1, 1, 1), (1, 1, 2), 0.9)


def test_the_measures_of_a_body() -> None:
    for item in moving(40, (1, 2, 3), seed=8):
        body = item.at(0)
        local = (
            np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * item.size
        )
        corners = Rotation.from_quat(item.turn).apply(local) + item.start
        found = np.array(body.corners())
        assert np.allclose(np.sort(found, axis=0), np.sort(corners, axis=0))
        assert np.allclose(body.extents(), np.abs(corners - item.start).max(axis=0))
        way = item.way.tolist()
        assert body.reach(*way) == pytest.approx(((corners - item.start) @ item.way).max())
        radius = np.linalg.norm(corners - item.start, axis=1).max()
        assert radius < body.radius < radius + 1e-4
        assert np.allclose(body.axes, quaternions.to_matrix(item.turn[np.newaxis])[0].T)


@pytest.mark.parametrize("angle", [0.01, 0.06, 0.3, 1.2])
def test_planks_that_nearly_cross(angle: float) -> None:
    """Of two planks, turned in all directions by little or much."""
    sizes = (40.0, 1.0, 0.2), (40.0, 1.0, 0.2)
    turn = Rotation.from_euler("z", angle) * Rotation.from_euler("x", 0.7)
    other = Rotation.from_euler("z", -angle) * Rotation.from_euler("x", -0.4)
    for number in range(amount(3, 6)):
        way = np.random.default_rng(number).normal(size=3)
        way /= np.linalg.norm(way)
        still = Moving("box", np.zeros(3), way, turn.as_quat(), sizes[0])
        item = Moving("box", np.array([0.3 * number, 0.1, 0]), way, other.as_quat(), sizes[1])
        both = lanes(still, 0)

        def truth(along: float, item: Moving = item, both: Body = both) -> bool:
            return not collide([lanes(item, along), both], np.array([[0, 1]]), lanes=1).free[0]

        for change in (flip(truth, 0, 60, width=1e-9), flip(truth, 0, -60, width=1e-9)):
            for off in (CENTIMETRE, -CENTIMETRE, 0.1, -0.1):
                met = meet(item.at(change + off), still.at(0))
                assert met is truth(change + off)
                assert meet(still.at(0), item.at(change + off)) is met


def test_gaps_are_told_of_convex_bodies_alone() -> None:
    """Whichever of the two is not convex."""
    for shape in SHAPES:
        one = placed((0, 0, 0), TURN.q, (1, 2, 3), mesh_of(shape))
        other = placed((5, 0, 0), (0, 0, 0, 1), (1, 1, 1), primitives.cone())
        assert (gap(one, other) is None) is (not mesh_of(shape).is_convex)
        assert (gap(other, one) is None) is (not mesh_of(shape).is_convex)
        assert meet(one, placed((0.1, 0, 0), (0, 0, 0, 1), (1, 1, 1), primitives.box())) is (
            True if shape == "box" else None
        )
        assert meet(placed((0.1, 0, 0), (0, 0, 0, 1), (1, 1, 1), primitives.box()), one) is (
            True if shape == "box" else None
        )


@pytest.mark.parametrize("angle", [0.02, 0.05, 0.09, 0.4])
def test_bars_that_cross_edge_on_edge(angle: float) -> None:
    """Only the direction across both edges tells them apart, however little one is turned against the other."""
    size = (400.0, 1.0, 1.0)
    lower, upper = (
        Rotation.from_euler("z", turn) * Rotation.from_euler("x", math.pi / 4) for turn in (angle, -angle)
    )
    still = Moving("box", np.zeros(3), np.array([0.0, 0, 1]), lower.as_quat(), size)
    item = Moving("box", np.array([0.3, 0.1, 0]), np.array([0.0, 0, 1]), upper.as_quat(), size)
    change = math.sqrt(2)  # both stand on their edges
    for off in (CENTIMETRE, -CENTIMETRE, 0.1, -0.1):
        assert meet(item.at(change + off), still.at(0)) is (off < 0)
        assert meet(still.at(0), item.at(change + off)) is (off < 0)
        assert overlap(item.at(change + off), still.at(0)) == pytest.approx(max(0.0, -off), abs=1e-9)
    assert meet(item.at(change), still.at(0)) is None
