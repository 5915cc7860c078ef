"""What analysis knows of regions, bodies and views from bounds: never less than is possible, however tight the bounds are.

A reading is sound if the operation's own answer lies in the bounds of every box that holds its operands, and if the
operands lie in the inverse of every result that they give. Boxes here touch the operands, or are just them.
"""

import itertools
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy import stats
from scipy.spatial.transform import Rotation

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Kind
from scenic.graph.operation import Call, Operation
from scenic.language.errors import UnsupportedError
from scenic.runtime.regions import base
from scenic.runtime.regions import body_regions as bodies
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import RegionChoice
from scenic.runtime.regions.circular import DISC_POINT, CircularRegion
from scenic.runtime.regions.combinations import DifferenceRegion, IntersectionRegion, UnionRegion
from scenic.runtime.regions.fixed_sides import _POINT as POINT
from scenic.runtime.regions.fixed_sides import FixedSide
from scenic.runtime.regions.knowledge import fixed
from scenic.runtime.regions.lines import PathRegion
from scenic.runtime.regions.meshes import MeshSurfaceRegion, MeshVolumeRegion
from scenic.runtime.regions.nearness import SLACK, body_reach, grown, separation
from scenic.runtime.regions.planar_visibility import _SEES as SEES_IN_PLANE
from scenic.runtime.regions.planar_visibility import _SEES_POINT as SEES_POINT_IN_PLANE
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.scattered import PointSetRegion
from scenic.runtime.regions.sectors import SectorRegion
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.regions.visibility_nodes import SEES
from scenic.runtime.regions.volumes import BALL_POINT, BoxRegion, SpheroidRegion
from scenic.runtime.values.values import Orientation, Random, Vector
from tests.amounts import amount
from tests.runtime.geometry.samples import SHAPES
from tests.runtime.programs import scenario, unpruned
from tests.runtime.regions.test_region_readings import REGIONS, UNBOUNDED, around, columns_of

CONTAINS, DISTANCE, DRAW = base.CONTAINS_POINT, base._DISTANCE, base._DRAW
Row = np.ndarray
ROOT = Vector(0, 0, 0)


def boxes(rows: Sequence[Row | None], random: np.random.Generator) -> Iterator[list[Bounds | None]]:
    """Bounds that hold operands ``(n | 1, ...)``: just them, with them in a corner, and around them; nothing of ``None``.

    Once the first operand alone is not known exactly, then all are not.
    """
    yield exact(rows)
    for spread in (1, len(rows)):
        for sides in ((0, 1), (1, 0), (1, 1)):
            for scale in (1e-6, 0.3, 5.0):
                room = [
                    np.zeros((2, *np.shape(row)))
                    if place >= spread
                    else scale * np.abs(random.normal(size=(2, *np.shape(row))))
                    for place, row in enumerate(rows)
                ]
                yield [
                    None if row is None else Bounds(row - sides[0] * less, row + sides[1] * more)
                    for row, (less, more) in zip(rows, room, strict=True)
                ]


def within(rows: Row, bounds: Bounds | None) -> bool:
    return bounds is None or bool(((bounds.lower <= rows) & (rows <= bounds.upper)).all())


def is_sound(
    operation: Operation,
    payload: Any,
    results: Any,
    rows: Sequence[Row | None],
    random: np.random.Generator,
) -> None:
    """The readings of an operation agree with the results ``(n,)`` that it gives for some operands."""
    assert operation.bounds is not None
    assert operation.inverse is not None
    results = np.asarray(results, dtype=float)
    outcomes = [Bounds(results, results)]
    if np.isin(results, (0, 1)).all():
        outcomes.append(Bounds(np.zeros_like(results), np.ones_like(results)))
    else:
        outcomes.append(Bounds(results - 3, results + 5))
    for given in boxes(rows, random):
        assert within(results, operation.bounds(payload, *given))
        for outcome in outcomes:
            for row, part in zip(rows, operation.inverse(payload, outcome, *given), strict=True):
                assert row is None or within(row, part)


def exact(rows: Sequence[Row | None]) -> list[Bounds | None]:
    return [None if row is None else Bounds(row, row) for row in rows]


@pytest.mark.parametrize("name", REGIONS)
def test_points_and_distances(name: str) -> None:
    region, random = REGIONS[name], np.random.default_rng(3)
    columns = columns_of(region)
    rows = [None if column.dtype == object else column.astype(float) for column in columns]
    points = around(region, 60)[::2]
    lower, upper = (np.clip(corner, -30, 30) for corner in region.box(*columns))
    beside = upper + np.array([region.tolerance, 0, 0])
    points = np.concatenate([points, lower, upper, (lower + upper) / 2, beside])
    is_sound(
        CONTAINS,
        region,
        np.broadcast_to(region.contains_points(points, *columns), len(points)),
        [points, *rows],
        random,
    )
    try:
        distances = np.broadcast_to(region.distances(points, *columns), len(points))
    except UnsupportedError:
        distances = np.full(len(points), np.inf)
    else:
        is_sound(DISTANCE, region, distances, [points, *rows], random)
    if np.isfinite(distances).all() and all(
        row is not None for row in rows
    ):  # of meshes of objects no bounds are known
        assert DISTANCE.bounds is not None
        found = DISTANCE.bounds(region, *exact([points, *rows]))
        assert (found.upper - found.lower).max() < 1e-4
    if name not in UNBOUNDED | {"everywhere", "nowhere"}:
        far = np.array([[400.0, -300, 200]])
        assert CONTAINS.bounds is not None
        assert CONTAINS.bounds(region, *exact([far, *rows])).upper[0] == 0


def test_a_tolerance_counts() -> None:
    """Points that count as in a region though they lie beside it, in whatever the region is part of."""
    dots = PointSetRegion("dots", [(0, 0, 0), (1, 0, 0)], tolerance=0.5)
    other = BoxRegion((1, 1, 1), Vector(9, 9, 9))
    for region in (
        *(dots, UnionRegion(dots, other), UnionRegion(other, dots), UnionRegion(other, dots, other)),
        *(
            DifferenceRegion(dots, other),
            IntersectionRegion(BoxRegion((9, 9, 9)), dots),
            Workspace(dots),
        ),
    ):
        columns = columns_of(region)
        point = np.array([[1.4999, 0, 0]])
        assert region.contains_points(point, *columns).all()
        is_sound(CONTAINS, region, [1.0], [point, *columns], np.random.default_rng(2))
    index = Random(scenario("param i = DiscreteRange(0, 1)").params["i"].node)
    chosen = RegionChoice(index, [other, dots])
    assert chosen.tolerance == 0.5


@pytest.mark.parametrize("turn", [Orientation(), Orientation.fromEuler(0.7, 0.4, -0.3)])
def test_a_tolerance_counts_on_every_side(turn: Orientation) -> None:
    """Of meshes, which know how far a point is from them, as of lines."""
    cube = trimesh.creation.box((2, 2, 2))
    assert CONTAINS.bounds is not None
    assert CONTAINS.inverse is not None
    for local in (*np.eye(3), *-np.eye(3)):
        way = np.array(Vector(*local).rotatedBy(turn))
        for region in (
            MeshVolumeRegion(cube, rotation=turn, tolerance=0.25),
            MeshSurfaceRegion(cube, rotation=turn, tolerance=0.25),
            PathRegion([tuple(-way), tuple(way)], tolerance=0.25),
        ):
            columns = columns_of(region)
            given = [None if column.dtype == object else column for column in columns]
            for off, held in ((0.2, True), (0.3, False)):
                point = ((1 + off) * way)[np.newaxis]
                assert np.broadcast_to(region.contains_points(point, *columns), 1).tolist() == [held]
                if held:
                    known = exact([point, *given])
                    assert CONTAINS.bounds(region, *known).upper[0] == 1
                    yes = Bounds(np.ones(1), np.ones(1))
                    assert within(point, CONTAINS.inverse(region, yes, *known)[0])


def test_a_body_whose_turn_is_not_known_reaches_as_far_as_its_corners() -> None:
    """In whichever way it is turned, and however long it is along one axis."""
    for size in ((2, 2, 2), (6, 1, 1), (1, 6, 1), (1, 1, 6)):
        given = np.array([size], dtype=float)
        reach = body_reach(None, Bounds(given / 2, given))
        assert reach is not None
        far = float(np.linalg.norm(size)) / 2
        assert reach.upper[0] == pytest.approx([far] * 3)
        assert reach.lower[0] == pytest.approx([-far] * 3)
        assert (reach.upper >= far).all()
        assert (reach.lower <= -far).all()
        half = np.array([size], dtype=float) / 2
        known = body_reach(
            Bounds(np.array([[0.0, 0, 0, 1]]), np.array([[0.0, 0, 0, 1]])), Bounds(given / 2, given)
        )
        assert known is not None
        np.testing.assert_allclose((known.lower, known.upper), (-half, half), rtol=1e-7)


def test_what_grows_and_what_lies_apart() -> None:
    """By just so much, and what rounding may change; nothing shrinks."""
    box = Bounds(np.array([[1.0, 2, 3]]), np.array([[2.0, 4, 6]]))
    for distance, room in ((0.0, 0.0), (2.5, 2.5), (-3.0, 0.0)):
        found = grown(box, np.array([distance]))
        np.testing.assert_allclose(found.lower, box.lower - room - SLACK, rtol=1e-12)
        np.testing.assert_allclose(found.upper, box.upper + room + SLACK, rtol=1e-12)
    for move, apart in (((0, 0, 0), 0), ((0.5, 0, 0), 0), ((4, 0, 0), 3), ((0, -5, 0), 3), ((0, 5, -7), 5)):
        other = Bounds(box.lower + move, box.upper + move)
        for one, two in ((box, other), (other, box)):
            found = separation(one, two)
            assert found[0] <= apart
            assert max(found[0], 0) == pytest.approx(apart, abs=2 * SLACK)
    several = Bounds(np.array([[0.0, 0, 0], [9, 0, 0]]), np.array([[1.0, 1, 1], [10, 1, 1]]))
    assert separation(box, several) == pytest.approx([np.hypot(1, 2), np.hypot(7, np.hypot(1, 2))], abs=1e-5)


def test_parameters_are_fixed_where_each_part_has_one_value_in_all_boxes() -> None:
    place, number = np.array([[1.0, 2, 3]]), np.array([4.0])
    alike = Bounds(np.repeat(place, 3, axis=0), np.repeat(place, 3, axis=0))
    found = fixed([Bounds(place, place), Bounds(number, number), alike])
    assert found is not None
    for column, expected in zip(found, (place, number, place), strict=True):
        np.testing.assert_array_equal(column, expected)
    assert fixed([]) == []
    for axis in range(3):
        wider, moved = Bounds(place, place + np.eye(3)[axis]), place + np.eye(3)[[axis]]
        rows = np.concatenate([place, moved])
        for loose in (wider, Bounds(rows, rows), None):
            assert fixed([loose]) is None
            assert fixed([Bounds(number, number), loose]) is None
            assert fixed([loose, Bounds(number, number)]) is None


VARYING: dict[str, Region] = {
    "disc": CircularRegion(ROOT, 1),
    "rectangle": RectangularRegion(ROOT, 0, 1, 1),
    "sector": SectorRegion(ROOT, 1, 0, 1),
    "box": BoxRegion((1, 1, 1)),
    "ellipsoid": SpheroidRegion((1, 1, 1)),
}


def varied(region: Region, random: np.random.Generator) -> list[Row]:
    """Columns of parameters that a region of this kind may have."""
    rows = []
    for value, column in zip(region.parameters, columns_of(region), strict=True):
        if column.shape[1:] == (4,):
            rows.append(Rotation.random(random_state=int(random.integers(1000))).as_quat()[None])
        elif isinstance(value, Vector):
            rows.append(random.uniform(0.2, 4, (1, 3)))
        else:
            rows.append(random.uniform(0.2, 4, 1))
    return rows


@pytest.mark.parametrize("name", VARYING)
def test_regions_with_random_parameters(name: str) -> None:
    region, random = VARYING[name], np.random.default_rng(4)
    other = BoxRegion((2, 2, 2), Vector(3, 0, 0))
    others = [column.astype(float) for column in columns_of(other)]
    both = (region, other)
    index = Random(scenario("param i = DiscreteRange(0, 1)").params["i"].node)
    for _ in range(amount(3, 6)):
        rows = varied(region, random)
        uniforms, keys = random.random((3, 6)), np.arange(6, dtype=np.uint64)
        points, _ = region.draw_points(uniforms[: region.draws], keys, *rows)
        points = np.concatenate([points, points + random.normal(size=points.shape)])
        for whole, mine in (
            (region, rows),
            (region.footprint, rows),
            (UnionRegion(*both), [*rows, *others]),
            (IntersectionRegion(*both), [*rows, *others]),
            (DifferenceRegion(*both), [*rows, *others]),
            (RegionChoice(index, both), [np.zeros(1), *rows, *others]),
        ):
            held = np.broadcast_to(whole.contains_points(points, *mine), len(points))
            is_sound(CONTAINS, whole, held, [points, *mine], random)
        is_sound(DISTANCE, region, region.distances(points, *rows), [points, *rows], random)
        for given in boxes(rows, random):
            assert DRAW.bounds is not None
            known = [*[None] * (region.draws + 1), *given]
            assert within(points[:6], DRAW.bounds(region, *known))
        far = exact([np.array([[50.0, 50, 0]])])
        for given in boxes(rows, random):
            assert CONTAINS.bounds is not None
            near = all(bound is not None and (bound.upper < 15).all() for bound in given)
            found = CONTAINS.bounds(region, *far, *given)
            assert not near or found.upper[0] == 0


def pose(random: np.random.Generator, place: Any = None) -> list[Row]:
    """Position, orientation and size."""
    turn = Rotation.random(random_state=int(random.integers(1000))).as_quat()
    where = random.normal(size=(1, 3)) if place is None else np.asarray(place, dtype=float)[None]
    return [where, turn[None], random.uniform(0.2, 2, (1, 3))]


def test_two_bodies() -> None:
    random = np.random.default_rng(7)
    for name in ("box", "cone"):
        mesh = shape_column(name)
        first, second = (
            [np.concatenate(part) for part in zip(*(pose(random) for _ in range(24)), strict=True)]
            for _ in range(2)
        )
        second[0] = second[0] * np.repeat([[0.2], [1], [2], [4]], 6, axis=0)
        columns, rows = [*first, mesh, *second, mesh], [*first, None, *second, None]
        gaps = bodies._GAP.batch(Call((24,), None, [None] * 8), *columns)
        assert gaps.min() == 0
        assert gaps.max() > 1
        is_sound(bodies._GAP, None, gaps, rows, random)
        meets = bodies._INTERSECT.batch(Call((24,), None, [None] * 8), *columns)
        assert (meets == (gaps == 0)).all()
        is_sound(bodies._INTERSECT, None, meets, rows, random)
    far = exact([*pose(random, (0, 0, 0)), None, *pose(random, (30, 40, 0)), None])
    assert bodies._INTERSECT.bounds is not None
    assert bodies._GAP.bounds is not None
    assert bodies._INTERSECT.bounds(None, *far).upper[0] == 0
    assert 50 - 2 * np.sqrt(12) < bodies._GAP.bounds(None, *far).lower[0] < 50


def shape_column(name: str) -> Row:
    """A column of one shape with the unit mesh of a sample."""

    class Shape:
        mesh = SHAPES[name]()

    column = np.empty(1, dtype=object)
    column[0] = Shape()
    return column


ANGLES = [(2 * np.pi, np.pi), (1.0, np.pi), (3.1, 2.9), (2 * np.pi, 0.4), (0.5, 0.3), (4.0, 1.0)]


def observer(random: np.random.Generator, angles: tuple[float, float], reach: float) -> list[Row]:
    turn = Rotation.random(random_state=int(random.integers(1000))).as_quat()
    numbers = [*angles, reach, 5.0, 0.0, 0.0]
    return [random.normal(size=(1, 3)), turn[None], *(np.array([number]) for number in numbers), np.zeros(1)]


@pytest.mark.parametrize("angles", ANGLES)
def test_what_is_seen(angles: tuple[float, float]) -> None:
    """Targets lie just within, and just out of, the range and the borders of the view."""
    random = np.random.default_rng(11)
    shape = shape_column("box")
    seen = unseen = 0
    for number in range(amount(8, 14)):
        views = observer(random, angles, 4.0)
        frame = Rotation.from_quat(views[1][0])
        half = np.array(angles) / 2 * (1 + random.choice([-1e-6, 1e-6, -0.2, 0.2], 2))
        azimuth, altitude = half * (random.uniform(-1, 1, 2) if number % 2 else random.choice([-1, 1], 2))
        length = 4.0 * (1 + random.choice([-1e-6, 1e-6, -0.5]))
        way = [-np.sin(azimuth) * np.cos(altitude), np.cos(azimuth) * np.cos(altitude), np.sin(altitude)]
        place = views[0] + frame.apply(way)[None] * length
        call = Call((1,), (False, False), [None] * 10, kinds=(Kind.SCALAR,) * 10)
        point = float(SEES.batch(call, *views, place)[0])
        is_sound(SEES, (False, False), [point], [*views, place], random)
        body = pose(random, place[0])
        body[2] = body[2] * (0.05 if number % 2 else 1)
        call = Call((1,), (True, False), [None] * 13)
        thing = float(SEES.batch(call, *views, *body, shape)[0])
        is_sound(SEES, (True, False), [thing], [*views, *body, None], random)
        seen, unseen = seen + int(point), unseen + int(not point)
        away = views[0] + frame.apply(way)[None] * 9
        assert SEES.bounds is not None
        assert SEES.bounds((False, False), *exact([*views, away])).upper[0] == 0
        behind = views[0] - frame.apply([0, 2, 0])[None]
        above = views[0] + frame.apply([0, 0.01, 2])[None]
        for where, limit in ((behind, angles[0]), (above, angles[1])):
            if limit < 3:
                assert SEES.bounds((False, False), *exact([*views, where])).upper[0] == 0
    assert seen
    assert unseen


def test_what_is_seen_in_the_plane() -> None:
    random = np.random.default_rng(12)
    seen = 0
    for _ in range(40):
        camera, heading = random.normal(size=(1, 3)), random.uniform(-4, 4, 1)
        angle, reach = random.uniform(0.3, 6.3, 1), np.array([3.0])
        way = heading[0] + angle[0] / 2 * random.uniform(-1.1, 1.1)
        length = 3 * (1 + random.choice([-1e-6, 1e-6, -0.4]))
        place = camera + length * np.array([[-np.sin(way), np.cos(way), random.normal()]])
        rows = [camera, heading, angle, reach, place]
        point = float(SEES_POINT_IN_PLANE.batch(Call((1,), None, [None] * 5), *rows)[0])
        is_sound(SEES_POINT_IN_PLANE, None, [point], rows, random)
        body = pose(random, place[0] + (0.3, 0.2, 5))
        yaw = random.uniform(-4, 4)
        body[1] = np.array([[0, 0, np.sin(yaw / 2), np.cos(yaw / 2)]])
        rows = [camera, heading, angle, reach, *body]
        thing = float(SEES_IN_PLANE.batch(Call((1,), None, [None] * 7), *rows)[0])
        is_sound(SEES_IN_PLANE, None, [thing], rows, random)
        seen += int(point)
        rows[4] = camera + 20 * np.array([[-np.sin(way), np.cos(way), 0]])
        for operation, known in ((SEES_POINT_IN_PLANE, rows[:5]), (SEES_IN_PLANE, rows)):
            assert operation.bounds is not None
            assert operation.bounds(None, *exact(known)).upper[0] == 0
    assert 5 < seen < 40


PROGRAMS = {
    "distance to a region": (
        "region = CircularRegion((10, 0), 5)\n"
        "ego = new Object at (Range(-100, 100), Range(-100, 100), 0)\n"
        "require (distance from ego to region) < 3"
    ),
    "a random region": (
        "region = CircularRegion((Range(5, 10), 0), Range(4, 6))\n"
        "ego = new Object at (Range(-100, 100), Range(-100, 100), 0)\n"
        "require ego in region"
    ),
    "a place": (
        "region = RectangularRegion((0, 30), 0.4, 30, 10)\n"
        "ego = new Object at (Range(-100, 100), Range(-100, 100), 0)\n"
        "require ego.position in region"
    ),
    "in view": (
        "ego = new Object facing 30 deg, with visibleDistance 20, with viewAngle 60 deg\n"
        "other = new Object at (Range(-100, 100), Range(-100, 100), 0), with requireVisible True"
    ),
}
MOST_TRIED = {"distance to a region": 3, "a random region": 5, "a place": 2, "in view": 5}
"""Candidates for a scene with pruning; without, some hundreds."""


@pytest.mark.parametrize("name", PROGRAMS)
def test_pruning_changes_no_law(name: str) -> None:
    places, tried, count = [], [], amount(100, 150)
    for prune in (True, False):
        program = (scenario if prune else unpruned)(PROGRAMS[name])
        scenes = program.sample(count, seed=5)
        places.append(np.array([tuple(scene.objects[-1].position)[:2] for scene in scenes]))
        tried.append(sum(scene.attempts for scene in scenes) / count)
    for axis in range(2):
        assert stats.ks_2samp(places[0][:, axis], places[1][:, axis]).pvalue > 1e-3
    assert tried[0] < MOST_TRIED[name] < tried[1] / 20


def known_place(
    operation: Operation, payload: Any, result: float, rows: Sequence[Row | None], number: int
) -> Bounds:
    """Where an operand can be that is not known at all, once the others and the result are known."""
    given = exact(rows)
    shape = np.shape(rows[number])
    given[number] = Bounds(np.full(shape, -np.inf), np.full(shape, np.inf))
    assert operation.inverse is not None
    found = operation.inverse(payload, Bounds(np.array([result]), np.array([result])), *given)
    place = found[number]
    assert place is not None
    return place


def is_box(found: Bounds, lower: Any, upper: Any) -> None:
    """Bounds hold a box and are larger by some thousandths of a millimetre at most."""
    for outer, inner in ((-found.lower, -np.asarray(lower)), (found.upper, np.asarray(upper))):
        assert np.all(outer >= inner)
        assert np.all((outer <= inner + 1e-5) | np.isinf(inner))


@pytest.mark.parametrize("name", ["box", "ball", "disc"])
def test_what_a_region_holds_is_known_to_be_in_its_box(name: str) -> None:
    region, radius = {
        "box": (BoxRegion((2, 4, 6), Vector(1, 2, 3)), [1, 2, 3]),
        "ball": (SpheroidRegion((2, 4, 6), Vector(1, 2, 3)), [1, 2, 3]),
        "disc": (CircularRegion(Vector(1, 2, 3), 5), [5, 5, 0]),
    }[name]
    columns = [column.astype(float) for column in columns_of(region)]
    middle, half = np.array([[1.0, 2, 3]]), np.array([radius], dtype=float)
    # What is flat holds what is above and below it.
    held = half + (np.array([[0, 0, np.inf]]) if name == "disc" else 0.0)
    is_box(known_place(CONTAINS, region, 1, [middle, *columns], 0), middle - held, middle + held)
    for distance in (0.0, 3.0):
        room = half + distance
        is_box(known_place(DISTANCE, region, distance, [middle, *columns], 0), middle - room, middle + room)
    # Nothing follows from what is not so.
    given = exact([middle, *columns])
    assert CONTAINS.inverse is not None
    (place, *_) = CONTAINS.inverse(region, Bounds(np.zeros(1), np.ones(1)), *given)
    assert place is None or (np.isinf(place.lower).all() and np.isinf(place.upper).all())


def test_a_point_in_the_corner_of_a_box_is_known_to_be_beside_a_ball() -> None:
    """Not by the box around the ball, but by the distance from it; also of some points among others."""
    ball = SpheroidRegion((2, 2, 2))
    columns = [column.astype(float) for column in columns_of(ball)]
    points = np.array([[0.9, 0.9, 0.9], [0.5, 0.5, 0.5], [-0.9, 0.9, 0], [0, 0, 0.99]])
    assert CONTAINS.bounds is not None
    assert CONTAINS.bounds(ball, *exact([points, *columns])).upper.tolist() == [0, 1, 0, 1]


def test_where_what_is_seen_and_who_sees_it_can_be() -> None:
    camera, place = np.array([[1.0, 2, 3]]), np.array([[4.0, 6, 3]])
    still = np.array([[0.0, 0, 0, 1]])
    numbers = [np.array([number]) for number in (1.0, 1.0, 7.0, 5.0, 0.0, 0.0)]
    views = [camera, still, *numbers, np.zeros(1)]
    size = np.array([[2.0, 4, 4]])
    radius = 3.0  # of the ball around a body of this size
    for payload, target, reach in (
        ((False, False), [place], 7.0),
        ((True, False), [place, still, size, None], 7 + radius),
    ):
        is_box(known_place(SEES, payload, 1, [*views, *target], 0), place - reach, place + reach)
        is_box(known_place(SEES, payload, 1, [*views, *target], 9), camera - reach, camera + reach)
    endless = np.array([[0, 0, np.inf]])
    flat = [camera, np.zeros(1), np.ones(1), np.array([7.0]), place]
    for operation, rows, reach in (
        (SEES_POINT_IN_PLANE, flat, 7.0),
        (SEES_IN_PLANE, [*flat, still, size], 7 + radius),
    ):
        room = reach + endless
        is_box(known_place(operation, None, 1, rows, 0), place - room, place + room)
        is_box(known_place(operation, None, 1, rows, 4), camera - room, camera + room)


def test_where_bodies_near_each_other_can_be() -> None:
    """As far apart as half their sizes together and the gap on each axis."""
    still = np.array([[0.0, 0, 0, 1]])
    first = [np.array([[1.0, 2, 3]]), still, np.array([[2.0, 4, 6]]), None]
    second = [np.array([[5.0, 5, 5]]), still, np.array([[1.0, 1, 3]]), None]
    rows, half = [*first, *second], np.array([[1.5, 2.5, 4.5]])
    for operation, result, gap in ((bodies._INTERSECT, 1.0, 0.0), (bodies._GAP, 2.0, 2.0)):
        for mine, other in ((0, first), (4, second)):
            other = second if mine == 0 else first
            assert other[0] is not None
            room = half + gap
            is_box(known_place(operation, None, result, rows, mine), other[0] - room, other[0] + room)


def test_a_narrow_view_hides_what_is_beside_above_and_behind_it() -> None:
    """A ball just within each border of a turned view may be seen for all that is known, and just beyond it not."""
    turn = Rotation.from_euler("ZXY", [0.7, 0.3, -0.4])
    still = np.array([[0.0, 0, 0, 1]])
    width, height = 0.6, 0.4
    numbers = [np.array([number]) for number in (width, height, 50.0, 5.0, 0.0, 0.0)]
    views = [np.array([[1.0, 2, 3]]), turn.as_quat()[None], *numbers, np.zeros(1)]
    assert SEES.bounds is not None
    for side in (-1, 1):
        for off, seen in ((-1e-4, 1), (1e-4, 0)):
            across, upward = np.tan(width / 2 + off), np.tan(height / 2 + off)
            for way in ([side * across, 1, 0], [0, 1, side * upward]):
                place = views[0] + 20 * turn.apply(way)[None]
                assert SEES.bounds((False, False), *exact([*views, place])).upper[0] == seen
                size = np.full((1, 3), 1e-9)
                body = [place, still, size, None]
                assert SEES.bounds((True, False), *exact([*views, *body])).upper[0] == seen
    # Nothing is known of the heights that a view shows that is as wide as can be, or nearly.
    for gap in (0.0, 0.0169):
        wide = [views[0], views[1], np.array([2 * np.pi - gap]), np.array([np.pi - gap]), *views[4:]]
        for way in ([0, -1, 0], [0, 0, 1], [0, 0, -1], [1, 0, 0]):
            place = views[0] + 20 * turn.apply(way)[None]
            assert SEES.bounds((False, False), *exact([*wide, place])).upper[0] == 1


def test_of_random_view_angles_the_widest_counts() -> None:
    """What the widest view shows may be seen, however narrow the view can be; what it does not show is not."""
    turn = Rotation.from_euler("ZXY", [0.7, 0.3, -0.4])
    still, size = np.array([[0.0, 0, 0, 1]]), np.full((1, 3), 1e-9)
    numbers = [np.array([number]) for number in (0.0, 0.0, 50.0, 5.0, 0.0, 0.0)]
    views = [np.array([[1.0, 2, 3]]), turn.as_quat()[None], *numbers, np.zeros(1)]

    def most(way: Sequence[float], width: tuple[float, float], height: tuple[float, float]) -> set[float]:
        place = views[0] + 20 * turn.apply(way)[None]
        found = set()
        for payload, target in (((False, False), [place]), ((True, False), [place, still, size, None])):
            given = exact([*views, *target])
            given[2:4] = [Bounds(np.array([low]), np.array([high])) for low, high in (width, height)]
            assert SEES.bounds is not None
            found.add(float(SEES.bounds(payload, *given).upper[0]))
        return found

    for side in (-1, 1):
        for off, seen in ((-1e-4, 1), (1e-4, 0)):
            across, upward = np.tan(0.3 + off), np.tan(0.2 + off)
            assert most([side * across, 1, 0], (0.1, 0.6), (0.1, 0.4)) == {seen}
            assert most([0, 1, side * upward], (0.1, 0.6), (0.1, 0.4)) == {seen}
        # Views that may be as wide as can be show all, those that are narrow for certain nothing behind.
        assert most([side, -1, 0], (0.1, 2 * np.pi), (0.1, 0.4)) == {1}
        assert most([side, -1, 0], (0.1, 0.6), (0.1, np.pi)) == {0}
        assert most([0, 0, side], (0.1, 2 * np.pi), (0.1, np.pi)) == {1}
        assert most([0, 0, side], (0.1, 2 * np.pi), (0.1, 0.4)) == {0}


ENDS = np.array([5e-324, 2.0**-64, 0.25, 0.5, 1 - 2.0**-53])


@pytest.mark.parametrize(
    "name", [name for name in REGIONS if name not in UNBOUNDED | {"everywhere", "nowhere"}]
)
def test_draws_from_the_ends_of_the_unit_interval_are_within_the_bounds(name: str) -> None:
    region, random = REGIONS[name], np.random.default_rng(2)
    columns = columns_of(region)
    uniforms = random.choice(ENDS, (region.draws, 40))
    points, found = region.draw_points(uniforms, np.arange(40, dtype=np.uint64), *columns)
    points = points if found is None else points[found]
    assert DRAW.bounds is not None
    known = [*[None] * (region.draws + 1), *exact([None if c.dtype == object else c for c in columns])]
    assert within(points, DRAW.bounds(region, *known))


@pytest.mark.parametrize("operation", [DISC_POINT, BALL_POINT])
def test_points_of_the_unit_disc_and_ball(operation: Operation) -> None:
    """Bounds that hold the numbers hold the points, and are no wider than the farthest of these is off."""
    random = np.random.default_rng(3)
    count = 2 if operation is DISC_POINT else 3
    for _ in range(40):
        ends = np.sort(random.choice([*ENDS, *random.random(4)], (2, count)), axis=0)
        numbers = ends[0] + np.linspace(0, 1, 30)[:, None] * (ends[1] - ends[0])
        numbers = np.concatenate([ends, numbers, random.permuted(numbers, axis=0)]).clip(*ends)
        points = operation.batch(Call((len(numbers),), None, [None] * count), *numbers.T)
        assert operation.bounds is not None
        found = operation.bounds(None, *(Bounds(low[None], high[None]) for low, high in ends.T))
        assert within(points, found)
        reach = ends[1, 0] ** (1 / count)
        # Those of the disc follow the angle, too.
        assert (
            found.upper <= np.array([reach, reach, 0 if count == 2 else reach]) * (1 + 1e-12) + 1e-13
        ).all()


def test_points_on_a_side_that_is_far_off_and_tilted() -> None:
    """Weights that sum to 1 but for rounding leave a face by no more than the bounds do."""
    random = np.random.default_rng(4)
    turns = (Orientation(), Orientation.fromEuler(0.7, 0.4, -0.3))
    for turn, place in itertools.product(turns, ((1e3, -2e4, 3e2), (0.1, 0.2, 0.3))):
        side = FixedSide.of(SHAPES["box"](), (Vector(*place), turn, Vector(3, 2, 1)), (2, 1), 0.5)
        assert side is not None
        payload = side._triangles
        face = random.integers(0, len(side.areas), 300)
        numbers = random.choice([*ENDS, *random.random(9)], (2, 300))
        points = POINT.batch(Call((300,), payload, [None] * 3), face, *numbers)
        assert POINT.bounds is not None
        unit = Bounds(np.zeros(1), np.ones(1))
        found = POINT.bounds(payload, unit, unit, unit)
        assert within(points, found)
        corners = side.corners.reshape(-1, 3)
        np.testing.assert_allclose(found.lower[0], corners.min(axis=0), atol=1e-9)
        np.testing.assert_allclose(found.upper[0], corners.max(axis=0), atol=1e-9)
