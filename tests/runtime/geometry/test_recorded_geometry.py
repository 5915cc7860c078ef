"""The functions of geometry give what was recorded, for bodies that are turned, tilted and stretched, in lanes that differ."""

import itertools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
import shapely

from scenic.runtime.geometry import affine, ragged
from scenic.runtime.geometry.contact import broadphase, depth, triangles
from scenic.runtime.geometry.contact import cell_proofs as proofs
from scenic.runtime.geometry.contact import scalar_bodies as single
from scenic.runtime.geometry.contact.collision import Collider, collide
from scenic.runtime.geometry.contact.crowd import Crowd, PropertyRows
from scenic.runtime.geometry.contact.fronts import Fronts
from scenic.runtime.geometry.contact.narrowphase import Solids, meshes_intersect
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.containment import body_points, distance
from scenic.runtime.geometry.flat import segments
from scenic.runtime.geometry.flat.cell_index import CellIndex
from scenic.runtime.geometry.flat.polygons import Polygons
from scenic.runtime.geometry.meshes import (
    booleans,
    cells,
    embree,
    facegrid,
    facetree,
    inside,
    nearest,
    primitives,
    prisms,
    projection,
    solids,
    surface,
    topology,
    voxels,
)
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.surface import Side
from scenic.runtime.geometry.poses import Poses
from tests.recorded import FOLDER, hold
from tests.runtime.geometry.samples import bumpy, hollow, random_poses, table
from tests.runtime.matrices import attempt, flips, numbers, summary

Lines = Iterator[str]
QUESTIONS: dict[str, Callable[[], Lines]] = {}
SIDES: list[tuple[Side, float]] = [(None, 0.0), ((0, 1), 0.3), ((1, -1), 0.55), ((2, 1), 0.8), ((2, -1), 2.0)]


def question(ask: Callable[[], Lines]) -> Callable[[], Lines]:
    QUESTIONS[ask.__name__] = ask
    return ask


@pytest.mark.parametrize("name", ["geometry"])
def test_geometry(name: str, request: pytest.FixtureRequest) -> None:
    hold(FOLDER / f"{name}.txt", lambda source: "\n".join(QUESTIONS[source.strip()]()), request)


def test_every_question_is_asked() -> None:
    text = (FOLDER / "geometry.txt").read_text(encoding="utf-8")
    assert all(f"== {name}\n" in text for name in QUESTIONS)


def meshes() -> dict[str, Mesh]:
    return {
        "box": primitives.box(),
        "cylinder": primitives.cylinder(7),
        "cone": primitives.cone(),
        "ball": primitives.spheroid(),
        "table": table(),
        "hollow": hollow(),
        "bumpy": bumpy(3),
    }


def poses(count: int, seed: int, **options: Any) -> Poses:
    return random_poses(count, seed, **options)


def points(count: int, seed: int, spread: float = 1.0) -> Any:
    return np.random.default_rng(seed).uniform(-spread, spread, (count, 3))


def mixed(count: int, seed: int, names: tuple[str, ...] = ("box", "table", "cone"), **options: Any) -> Body:
    known = meshes()
    return Body(
        tuple(known[name] for name in names), np.arange(count) * 2 % len(names), poses(count, seed, **options)
    )


@question
def places() -> Lines:
    p = poses(5, 1)
    one = Poses.fixed((1, -2, 0.5), (0.1, 0.2, 0.3, np.sqrt(0.86)), (1, 2, 3))
    for some in (
        p,
        one,
        Poses(p.position, one.orientation, one.size),
        Poses(one.position, p.orientation, p.size),
    ):
        yield f"length {len(some)}"
        yield f"world {numbers(some.to_world(points(5, 2)))}"
        yield f"world of several {numbers(some.to_world(points(6, 3).reshape(1, 6, 3)))}"
        yield f"unit {numbers(some.to_unit(points(5, 2)))}"
        yield f"unit of several {numbers(some.to_unit(points(6, 3).reshape(1, 6, 3)))}"
        yield f"directions {numbers(some.directions_to_unit(points(5, 2)))}"
        yield f"knows {some.knows_bounds}, bounds {numbers(np.array(some.bounds()))}, knows {some.knows_bounds}"
        part = some.take(np.array([3, 1, 3]))
        yield f"taken {numbers(part.position)} | {numbers(part.matrix)} | {numbers(np.array(part.bounds()))} {len(part)}"
    yield attempt(lambda: Poses(p.position, p.orientation[:4], p.size))
    yield attempt(lambda: Poses(p.position, p.position, p.size))


@question
def maps() -> Lines:
    one, two = affine.relative_map(poses(4, 1), poses(4, 2)), affine.relative_map(poses(1, 3), poses(3, 4))
    fixed = affine.relative_map(
        Poses.fixed((1, 2, 3), size=(3, 2, 1)), Poses.fixed((0, 1, 0.5), size=(1, 2, 4))
    )
    x, y, z = points(4, 5).T
    for name, maps in (("alike", one), ("both", one.followed_by(two)), ("fixed", fixed)):
        yield f"{name} {numbers(maps.matrix)} {numbers(maps.offset)}"
        yield f"{name} taken {numbers(maps.take(np.array([0, 0])).matrix)}"
    yield f"images {numbers(one.columns((x, y, z)))} {numbers(one.columns(points(8, 7).reshape(3, 2, 4)))}"
    yield f"reaches {numbers(one.reaches((abs(x), abs(y), abs(z))))}"
    yield f"reaches {numbers(one.reaches(abs(points(8, 7)).reshape(3, 2, 4)))}"
    yield f"taken {numbers(np.array(affine.taken((x, y, z), np.array([2, 0]))))} {numbers(affine.taken(points(4, 5).T, np.array([2, 0])))}"


@question
def bodies() -> Lines:
    body = mixed(6, 1)
    allow = Body(body.meshes, None, Poses.fixed((0, 1, 2)), np.array([True, False, True]))
    for some in (body, body.take(np.array([4, 1])), allow, allow.take(np.array([2]))):
        yield f"{len(some)} {numbers(some.allow)} {None if some.choice is None else numbers(some.choice)}"
        yield f"{[(len(mesh.faces), chosen.tolist()) for mesh, chosen in some.by_mesh(6)]}"
    yield attempt(lambda: Body(body.meshes, None, body.poses, is_fixed=True))


@question
def solids_of_bodies() -> Lines:
    rng = np.random.default_rng(3)
    for names in (("box", "table", "cone"), ("hollow", "ball")):
        body = mixed(9, 4, names)
        uniforms, keys = rng.random((3, 9)), rng.integers(0, 2**63, 9).astype(np.uint64)
        drawn, found = body_points.draw_points(body, uniforms, keys)
        yield f"draws {numbers(drawn)} {numbers(found)}"
        drawn, found = body_points.draw_points(body, uniforms, keys[:1])
        yield f"draws with one key {numbers(drawn)} {numbers(found)}"
        yield f"box {numbers(body_points.distances_from_box(body, points(9, 5, 2)))}"
        yield f"bounds {numbers(np.array(body_points.bounds(body)))}"
        yield f"volumes {numbers(body_points.volumes(body))} inradii {numbers(body_points.inradii(body))}"
        yield f"planar inradii {numbers(body_points.planar_inradii(body))}"
        for side, threshold in SIDES:
            yield f"areas {side} {threshold} {numbers(body_points.areas(body, side, threshold))}"
            yield f"distances {numbers(body_points.distances_to_surface(body, points(9, 5, 2), side, threshold))}"
            yield f"from one {numbers(body_points.distances_to_surface(body, points(1, 6), side, threshold))}"
            yield f"faces {numbers(body_points.nearest_faces(body, points(9, 5, 2), side, threshold) > 5)}"
            alone = body.take(np.array([4]))
            yield f"box of side {numbers(np.array(body_points.side_bounds(alone, side, threshold)))}"
    many = Body((meshes()["ball"],), None, poses(450, 8))
    yield f"many {numbers(body_points.distances_to_surface(many, points(450, 9), (0, -1), 0.2))}"
    flat = Mesh(
        np.array([(0, 0, 0), (2, 0, 1), (0, 3, 0), (2, 3, 1)]), np.array([(0, 1, 2), (1, 3, 2)])
    ).normalized()[0]
    yield f"flat {numbers(np.array(body_points.bounds(Body((flat,), None, poses(3, 4)))))}"
    yield f"unlike {numbers(body_points.volumes(Body((table(),), None, Poses.fixed((0, 0, 0), size=(2, 3, 5)))))}"


@question
def boxes() -> Lines:
    for seed in range(4):
        a, b = poses(7, seed, sizes=(0.2, 1.9)), poses(7, seed + 10, sizes=(0.2, 1.9), spread=0.1)
        way = np.random.default_rng(seed).normal(size=(7, 3)) * 2.5
        way[::2] *= np.eye(3)[[0, 1, 2, 0]]

        def meet(t: Any, a: Poses = a, b: Poses = b, way: Any = way) -> Any:
            return broadphase.boxes_overlap(Poses(b.position + t[:, None] * way, a.orientation, a.size), b)

        yield f"apart {flips(meet, 7)}"
        yield f"one {flips(lambda t, a=a, b=b, way=way: broadphase.boxes_overlap(Poses(t[:, None] * way, a.orientation[:1], a.size[:1]), b.take(np.array([2]))), 7)}"
    many = 20_000
    yield f"many {numbers(broadphase.boxes_overlap(poses(many, 1), poses(many, 2)))}"
    yield f"not numbers {numbers(broadphase.boxes_overlap(Poses.fixed((np.nan, 0, 0)), Poses.fixed((0, 0, 0))))}"


@question
def near_pairs() -> Lines:
    rng = np.random.default_rng(1)
    for count, moving, lanes in ((9, 9, 16), (9, 4, 8), (70, 60, 40), (450, 420, 8), (450, 450, 16)):
        low = rng.uniform(-20, 20, (count, lanes, 3)) * np.array([1, 0.4, 0.1])
        high = low + rng.uniform(0.1, 4, low.shape)
        grid = broadphase.CellMap.around(low.reshape(-1, 3))
        lower, upper = np.full((3, count, lanes), 255, np.uint8), np.zeros((3, count, lanes), np.uint8)
        grid.put(low, lower)
        grid.put(high, upper)
        found = sorted(
            itertools.chain.from_iterable(
                zip(*(part.tolist() for part in group), strict=True)
                for group in broadphase.near_pairs(lower, upper, moving)
            )
        )
        yield f"{count} {moving} {lanes}: {len(found)} {len(set(found))} {numbers(np.array(found, dtype=float))}"
        yield f"cells {numbers(lower.astype(float))} {numbers(upper.astype(float))} {numbers(grid.origin)} {numbers(grid.scale)}"
    odd = broadphase.CellMap.around(
        np.array([(1, 2, 3), (np.nan, 0, 0), (1, 5, 3), (4, 2, 3), (np.inf, 1, 1)])
    )
    yield f"odd {numbers(odd.origin)} {numbers(odd.scale)}"
    none = broadphase.CellMap.around(np.full((2, 3), np.nan))
    yield f"none {numbers(none.origin)} {numbers(none.scale)}"


@question
def polygons_by_place() -> Lines:
    rng = np.random.default_rng(2)
    some = [
        shapely.Point(*rng.uniform(-5, 9, 2) * [3, 1]).buffer(rng.uniform(0.3, 2), quad_segs=2)
        for _ in range(60)
    ]
    some[7] = shapely.Polygon()
    index = CellIndex(some)
    x, y = rng.uniform(-20, 30, 900), rng.uniform(-8, 12, 900)
    x[5], y[8], x[9] = np.nan, np.inf, 1e300
    yield f"first {numbers(index.first_at(x, y))}"
    yield f"few {numbers(index.first_at(x[:9], y[:9]))}"
    yield f"none {numbers(CellIndex([]).first_at(x[:3], y[:3]))} {numbers(CellIndex([shapely.Polygon()]).first_at(x[:3], y[:3]))}"
    row = CellIndex([shapely.box(i, 0, i + 1, 0.1 + i / 9) for i in range(30)])
    yield f"row {numbers(row.first_at(np.linspace(-0.5, 31, 40), np.full(40, 0.15)))}"


@question
def touched_cells() -> Lines:
    for name in ("box", "cone", "table", "bumpy"):
        for resolution in (5, 16, 64):
            pairs = [
                np.stack(pair, axis=1) for pair in cells.touched_cells(meshes()[name].triangles, resolution)
            ]
            found = np.unique(np.concatenate(pairs), axis=0)
            yield f"{name} {resolution}: {len(found)} {numbers(found.astype(float))} {len(np.unique(found[:, 1]))}"
    yield f"cells {numbers(cells.cell_of(points(9, 1, 0.6), 7).astype(float))}"


@question
def collisions() -> Lines:
    known = meshes()
    for seed, lanes in ((1, 37), (2, 500)):
        cast = [
            Body((known["box"],), None, poses(lanes, seed, spread=2.5)),
            Body((known["table"], known["cone"]), np.arange(lanes) % 2, poses(lanes, seed + 1, spread=2.5)),
            Body(
                (known["hollow"],),
                None,
                Poses.fixed((0.4, -0.3, 0.2), (0, 0.1, 0.2, np.sqrt(0.95)), (2, 1.6, 1.2)),
                is_fixed=True,
            ),
            Body(
                (known["ball"],),
                None,
                Poses(
                    poses(lanes, seed + 2, spread=2.5).position,
                    np.array([[0, 0, 0, 1.0]]),
                    np.array([[1, 2, 0.4]]),
                ),
            ),
            Body((known["box"],), None, Poses.fixed((3, 0, 0), size=(1, 1, 0.3)), is_fixed=True),
            Body(
                (known["bumpy"],),
                None,
                poses(lanes, seed + 3, spread=2.5, sizes=(0.3, 2.8)),
                np.arange(lanes) % 5 == 0,
            ),
        ]
        everything = collide(cast, None, lanes, exhaustive=True)
        yield f"all {numbers(everything.free)} {numbers(everything.pairs)}"
        yield f"free {numbers(collide(cast, None, lanes).free)}"
        some = [[4, 0], [5, 2], [1, 3], [2, 4], [3, 2]]
        wanted = collide(cast, some, lanes, exhaustive=True)
        yield f"some {numbers(wanted.free)} {numbers(wanted.pairs)} {numbers(collide(cast, some, lanes).free)}"
        collider = Collider(cast)
        yield f"fixed {collider.fixed_collisions.tolist()} pairs {collider.pairs.tolist()}"
        part = np.arange(lanes)[::3]
        yield f"again {numbers(collider.test([body.take(part) if not body.is_fixed else body for body in cast], len(part)).free)}"
    touching = [
        Body((known["box"],), None, Poses.fixed((3.9, 0.2, 0)), is_fixed=True),
        cast[4],
        Body((known["cone"],), None, Poses.fixed((3.9, 0.2, 0.6)), is_fixed=True),
        cast[0],
    ]
    found = Collider(touching)
    yield f"fixed ones {found.fixed_collisions.tolist()} {numbers(found.test(touching, lanes, exhaustive=True).pairs)}"
    row = [Body((known["box"],), None, poses(60, 100 + k, spread=9, sizes=(0.5, 2.2))) for k in range(40)]
    crowded = collide(row, None, 60, exhaustive=True)
    yield f"row {numbers(crowded.free)} {numbers(crowded.pairs)} {numbers(collide(row, None, 60).free)}"
    one = Crowd.of([cast[0]])
    yield f"alone {numbers(Collider([cast[0]]).test(one, lanes).free)}"


@question
def crowds() -> Lines:
    known = meshes()
    cast = [
        Body((known["box"],), None, poses(8, 1, sizes=(0.2, 3))),
        Body((known["table"], known["box"]), np.arange(8) % 2, poses(8, 2)),
        Body(
            (known["cone"],),
            None,
            Poses(poses(8, 3).position, np.array([[0.5, 0.5, 0.5, 0.5]]), np.array([[1, 2, 4.0]])),
            np.array([True]),
        ),
        Body((known["cone"],), None, Poses.fixed((1, 2, 3), (0.5, -0.5, 0.5, 0.5), (4, 1, 0.5))),
        Body(
            (known["ball"],),
            None,
            Poses(poses(8, 5).position, np.array([[0.1, 0.5, 0.1, np.sqrt(0.73)]]), poses(8, 6).size),
        ),
    ]
    cast[1].poses.bounds()
    crowd = Crowd.of(cast)
    rows = np.full((5 * 8, 3), 0.5) + np.arange(40)[:, None]
    stacked = Crowd.stacked(
        5, (known["box"],), rows, poses(5, 7).orientation, rows[:1], np.zeros(1, np.intp), np.zeros(5, bool)
    )
    for some in (crowd, stacked, crowd.followed_by(stacked), stacked.followed_by(crowd)):
        yield f"{len(some)} of {len(some.meshes)}, radius {numbers(some.radius().values)}"
        body, lane = np.arange(len(some)), np.arange(len(some)) * 3 % 8
        placed = some.poses(body, lane)
        yield f"poses {numbers(placed.position)} {numbers(placed.orientation)} {numbers(placed.size)}"
        yield f"meshes {numbers(some.mesh.at(body, lane).astype(float))} allow {numbers(some.allow.at(body, lane))}"
        for lanes in (slice(0, 8), slice(3, 5)):
            yield f"boxes {numbers(np.array(some.boxes(lanes)))}"
        yield f"over {numbers(some.position.over(np.arange(len(some)), slice(2, 5)))} {numbers(some.position.over(np.array([3]), slice(2, 5)))}"
        yield f"over {numbers(some.position.over(np.array([0, 1]), slice(2, 5)))} {numbers(some.position.over(np.array([1, 0]), slice(2, 5)))}"
    yield f"rows {numbers(PropertyRows.of([points(3, 1), points(1, 2)]).followed_by(PropertyRows.of([points(2, 3)])).at(np.array([0, 1, 2]), np.array([2, 1, 1])))}"


NOTCHED = shapely.Polygon(
    [(-2, -1.5), (2, -1.5), (2, 1.5), (0.3, 1.5), (0.3, 0.4), (-0.3, 0.4), (-0.3, 1.5), (-2, 1.5)]
)
HOLED = shapely.Polygon([(-3, -2), (3, -2.5), (2.5, 2), (-2, 2.5)], [[(-0.4, -0.3), (0.5, -0.2), (0.1, 0.4)]])


@question
def containers() -> Lines:
    rng = np.random.default_rng(5)
    for name in ("box", "cone", "table", "ball"):
        start, size, turn = points(6, 1, 0.8), rng.uniform(0.3, 0.9, (6, 3)), poses(6, 2).orientation
        way = rng.normal(size=(6, 3)) * 3

        def moved(
            t: Any, name: str = name, start: Any = start, way: Any = way, turn: Any = turn, size: Any = size
        ) -> Body:
            return Body((meshes()[name],), None, Poses(start + t[:, None] * way, turn, size))

        def grown(t: Any, name: str = name, start: Any = start, turn: Any = turn, size: Any = size) -> Body:
            return Body((meshes()[name],), None, Poses(start, turn, size * (0.01 + 5 * t)[:, None]))

        corners = np.array([(-2, -1.5), (2.5, -1), (1.5, 2), (-1, 1.7)])
        each = corners + rng.normal(0, 0.1, (6, 4, 2))
        box = rng.uniform(3, 4, (6, 3)), points(6, 3, 0.2), poses(6, 4).orientation
        fixed = (
            np.array([[4, 3, 2.5]]),
            np.array([[0.1, 0.2, -0.1]]),
            np.array([[0.1, 0.2, 0.3, np.sqrt(0.86)]]),
        )
        for kind, body in (("moved", moved), ("grown", grown)):
            yield f"{name} {kind} polygon {flips(lambda t, b=body, c=corners[None]: containment.in_convex_polygon(b(t), c, 6), 6)}"
            yield f"{name} {kind} each {flips(lambda t, b=body, e=each: containment.in_convex_polygon(b(t), e, 6), 6)}"
            for what, polygon in (
                ("notch", Polygons(NOTCHED)),
                ("hole", Polygons(HOLED)),
                ("two", Polygons(shapely.MultiPolygon([HOLED, shapely.box(5, 5, 9, 6)]))),
            ):
                yield f"{name} {kind} {what} {flips(lambda t, b=body, p=polygon: containment.in_polygons(b(t), p, 6), 6)}"
            for where, of in (("each", box), ("fixed", fixed)):
                yield f"{name} {kind} box {where} {flips(lambda t, b=body, o=of: containment.in_box(b(t), *o, 6), 6)}"
                yield f"{name} {kind} ellipsoid {where} {flips(lambda t, b=body, o=of: containment.in_ellipsoid(b(t), *o, 6), 6)}"
            for outer in ("box", "cone", "hollow", "table", "ball"):
                holder = Body((meshes()[outer],), None, Poses(box[1], box[2], box[0] * 1.3))
                yield f"{name} {kind} {outer} {flips(lambda t, b=body, h=holder: containment.in_body(b(t), h, 6), 6, 10)}"
        shells = (
            ("hollow", (0.37, 0.1, 0.05)),
            ("table", (0.1, 0.2, 0.45)),
            ("table", (0.4, 0.4, -0.1)),
            ("bumpy", (0.1, 0.1, 0)),
        )
        for outer, place in shells:
            poses_ = Poses(box[1], box[2], box[0] * 1.3)
            middle = poses_.to_world(np.array([place]))

            def inner(
                t: Any, name: str = name, middle: Any = middle, turn: Any = turn, size: Any = size
            ) -> Body:
                return Body((meshes()[name],), None, Poses(middle, turn, size * (0.01 + 1.5 * t)[:, None]))

            holder = Body((meshes()[outer],), None, poses_)
            yield f"{name} within {outer} {flips(lambda t, b=inner, h=holder: containment.in_body(b(t), h, 6), 6, 12)}"
        yield f"extremes {numbers(containment.extreme_corners(meshes()[name]))}"
    none = np.zeros((1, 3)), np.zeros((1, 3)), np.array([[0, 0, 0, 1.0]])
    yield f"nothing {numbers(containment.in_box(moved(np.zeros(6)), *none, 6))} {numbers(containment.in_ellipsoid(moved(np.zeros(6)), *none, 6))}"
    yield f"line {numbers(containment.in_convex_polygon(moved(np.zeros(6)), np.array([[(0, 0), (1, 1), (2, 2.0)]]), 6))}"
    several, holders = mixed(40, 6, sizes=(0.1, 0.5)), mixed(40, 7, ("hollow", "box", "table"), sizes=(1, 3))
    yield f"bodies {numbers(containment.in_body(several, holders, 40))}"
    for name, mesh in meshes().items():
        body = Body((mesh,), None, poses(400, 8))
        yield f"points in {name} {numbers(containment.contains_points(body, points(400, 9)))} {numbers(containment.contains_points(body, points(1, 10, 0.1)))}"


@question
def depths() -> Lines:
    for seed in range(6):
        p, q = poses(2, seed, spread=0.4), poses(2, seed + 20, spread=0.4)
        a, b = (
            some.to_world(mesh.hull.vertices[None])[0]
            for some, mesh in ((p, primitives.cone()), (q, primitives.cylinder(5)))
        )
        yield f"{depth.convex_depth(a, b):.8g} {depth.convex_depth(b, a):.8g} apart {depth.convex_gap(a, b + np.array([3, 1, 0.4])):.8g} {depth.convex_gap(b + np.array([3, 1, 0.4]), a):.8g}"
    flat = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0.0)])
    yield f"flat {depth.convex_depth(flat, flat + 0.1 * flat):.8g} {depth.convex_gap(flat, flat + np.array([0.3, 0.2, 2])):.8g}"


@question
def distances() -> Lines:
    for name in ("box", "cone", "table", "hollow", "bumpy"):
        body = Body((meshes()[name],), None, poses(6, 1))
        one = Body(
            (meshes()[name],),
            None,
            Poses.fixed((0.3, 0.2, -0.1), (0.1, 0.2, 0.3, np.sqrt(0.86)), (1, 2, 0.6)),
        )
        for some in (body, one):
            found = distance.to_surface(some, points(6, 2, 1.5), 6)
            yield f"{name} {numbers(found.distance)} at {numbers(found.point)}"
            within = distance.to_surface(some, points(6, 2, 1.5), 6, within=0.4)
            yield f"{name} within {numbers(within.distance)} {numbers(within.number >= 0)}"
            yield f"{name} signed {numbers(distance.signed(some, points(6, 2, 0.7), 6))} {numbers(distance.signed(some, points(1, 3, 0.7), 6))}"
            yield f"{name} solid {numbers(distance.to_solid(some, points(6, 2, 0.7), 6))}"
        for other in ("box", "table", "ball"):
            near = Body((meshes()[other],), None, poses(6, 4, spread=2.4))
            yield f"{name} {other} {numbers(distance.between(body, near, 6))} {numbers(distance.between(one, near, 6))}"
    apart = poses(150, 11, spread=0.6, sizes=(0.5, 1.5))
    away = Poses(apart.position[::-1] + np.array([1.9, 1.2, 0.9]), apart.orientation[::-1], apart.size)
    for name, other in (("bumpy", "table"), ("cone", "bumpy")):
        crowds = (Body((meshes()[one],), None, where) for one, where in ((name, apart), (other, away)))
        yield f"many {name} {other} {numbers(distance.between(*crowds, 150))}"
    yield f"mixed {numbers(distance.between(mixed(50, 5, spread=2), mixed(50, 6, ('cone', 'box', 'hollow'), spread=2), 50))}"
    a, b = poses(12, 7), poses(12, 8)
    faces = [
        [some.to_world(points(3, 9, 0.5)[None])[:, k] + (2 if some is b else 0) for k in range(3)]
        for some in (a, b)
    ]
    yield f"triangles {numbers(distance.squared_distances(*faces))}"


@question
def rays() -> Lines:
    for name in ("box", "bumpy"):
        scene = embree.RayScene(meshes()[name].triangles)
        start = points(30, 1, 2).astype(np.float32)
        way = (points(30, 2, 0.3) - start).astype(np.float32)
        hits = scene.first_hits(start, way)
        yield f"{name} {numbers(hits.triangle >= 0)} {numbers(hits.distance.astype(float).round(4))}"
        yield f"{name} {numbers(hits.second.astype(float).round(3))} {numbers(hits.third.astype(float).round(3))}"
        yield f"{name} blocked {numbers(scene.blocked(start, way))} {numbers(scene.blocked(start, way, 0.6))}"
        yield f"{name} first {numbers(scene.first_triangles(start[0], way) >= 0)}"
    nothing = embree.RayScene(np.zeros((0, 3, 3)))
    yield f"nothing {numbers(nothing.first_hits(start, way).distance)} {numbers(nothing.blocked(start, way))} {numbers(nothing.first_triangles(start[0], way))}"
    empty = np.zeros((0, 3), np.float32)
    yield f"no rays {len(scene.first_hits(empty, empty).distance)} {len(scene.blocked(empty, empty))} {len(scene.first_triangles(start[0], empty))}"


@question
def face_grids() -> Lines:
    for name in ("cone", "bumpy"):
        grid = meshes()[name].derived(facegrid.face_grid)
        yield f"{name} {grid.resolution} {len(grid.faces)} {numbers(grid.starts.astype(float))}"
        way = points(40, 1)
        way[::5] = np.eye(3)[np.arange(8) % 3] * (-1) ** np.arange(8)[:, None]
        for start in (points(40, 2, 0.5), points(40, 3, 4), points(40, 4, 300)):
            line, face = grid.along_lines(start, way)
            yield f"{name} lines {len(line)} {numbers(np.bincount(line, minlength=40).astype(float))} {numbers(face.astype(float))}"
        point, face = grid.near_points(points(40, 5, 0.7), np.full((40, 3), 0.05) * [1, 2, 0.5])
        yield f"{name} points {len(point)} {numbers(np.bincount(point, minlength=40).astype(float))} {numbers(face.astype(float))}"


@question
def face_trees() -> Lines:
    for name in ("bumpy", "cone"):
        tree = meshes()[name].derived(facetree.face_tree)
        yield f"{name} {tree.middle.shape} {numbers(np.sort(tree.faces).astype(float))} {numbers(tree.starts.astype(float))}"
    yield f"boxes {numbers(meshes()['bumpy'].derived(facetree.face_tree).half)} {numbers(meshes()['bumpy'].derived(facetree.face_tree).middle)}"
    small = facetree.tree_of(points(15, 1).reshape(5, 3, 3))
    yield f"small {numbers(small.middle)} {numbers(small.half)} {small.starts.tolist()} {small.faces.tolist()}"
    forest = facetree.Forest([bumpy(3), primitives.cylinder(5)])
    for level in (0, 2, 40):
        first, width = forest.level(level)
        yield f"level {level} {first.tolist()} {width.tolist()}"
    entry, node = forest.parts(np.arange(4), np.array([0, 3, forest.roots[1], len(forest.child) - 1]))
    yield f"parts {entry.tolist()} {node.tolist()}"
    below = forest.below(
        np.arange(3), np.array([0, 1, len(forest.child) - 1]), np.array([forest.roots[1], 2, 5])
    )
    yield f"below {[part.tolist() for part in below]}"
    leaves = np.flatnonzero(forest.child < 0)[[0, 5, -1]]
    entry, one, two = forest.faces_of(np.arange(3), leaves, leaves[::-1])
    yield f"faces {entry.tolist()} {(one - one.min()).tolist()} {(two - two.min()).tolist()}"
    yield f"normals {numbers(forest.normals)} corners {numbers(forest.corners)}"


@question
def pairs_of_solids() -> Lines:
    names = ("box", "cone", "table", "hollow", "bumpy")
    numbered = np.repeat(np.arange(5), 30), np.tile(np.arange(5), 30)
    for patience in (0.0, np.inf):
        some = Solids([meshes()[name] for name in names], patience=patience)
        first, second = numbered
        a, b = poses(150, 1, spread=1.2), poses(150, 2, spread=1.2)
        yield f"{patience} intersect {numbers(some.intersect(first, a, second, b))}"
        yield f"{patience} surfaces {numbers(some.surfaces_touch(first, a, second, b))}"
        tiny = Poses(b.position, a.orientation, a.size * 0.1)
        yield f"{patience} inside {numbers(some.intersect(first, tiny, second, b))} {numbers(some.intersect(second, b, first, tiny))}"
        yield f"{patience} part {numbers(some.some_part_inside(first, tiny, second, b))}"
        together, left = some.prove(first, a, second, b)
        yield f"{patience} proved {numbers(together)} {numbers(left)}"
        yield f"{patience} touch {numbers(some.touch(first, a, second, b))}"
        fixed = Poses.fixed((0.1, 0.2, 0), size=(1, 2, 1))
        yield f"{patience} one {numbers(some.intersect(first, fixed, second, b))}"
    for one, other in itertools.product(("cone", "table", "hollow", "bumpy"), ("box", "table", "bumpy")):
        p, q, way = poses(5, 3, spread=0.2), poses(5, 4, spread=0.2), points(5, 5) * 4

        def meet(
            t: Any, one: str = one, other: str = other, p: Poses = p, q: Poses = q, way: Any = way
        ) -> Any:
            return meshes_intersect(
                meshes()[one], Poses(p.position + t[:, None] * way, p.orientation, p.size), meshes()[other], q
            )

        yield f"{one} {other} {flips(meet, 5, 12)}"
    table_ = proofs.ProofTable([meshes()[name] for name in names])
    forth, back = affine.relative_map(a, b), affine.relative_map(b, a)
    moving, still = np.concatenate(numbered), np.concatenate(numbered[::-1])
    # Of meshes without symmetries: equal places may be sorted in any order.
    uneven = [bumpy(3), bumpy(2)]
    first, second = np.arange(40) % 2, np.arange(40) // 2 % 2
    c, d = poses(40, 6, spread=0.9), poses(40, 7, spread=0.9)
    ways = affine.relative_map(c, d).followed_by(affine.relative_map(d, c))
    fronts = Fronts(facetree.Forest(uneven), proofs.ProofTable(uneven))
    front = fronts.find(np.concatenate([first, second]), np.concatenate([second, first]), ways)
    yield f"front {numbers(front.touching)} {len(front.entry)} {numbers(front.centre)} {numbers(front.reach)}"
    yield f"leaves {[numbers(part.counts.astype(float)) for part in front.leaves()]}"
    both = forth.followed_by(back)
    yield f"contact {numbers(table_.contact(moving, still, both, slice(3)))} {numbers(table_.contact(moving, still, both, slice(16, None)))}"
    yield f"distance {numbers(table_.distance(moving, still, both))}"


@question
def cells_of_solids() -> Lines:
    for name, mesh in meshes().items():
        found = mesh.derived(voxels.voxels)
        yield f"{name} solid {int(found.solid.sum())} filled {int(found.filled[-1, -1, -1])} {numbers(found.filled[::9, ::7, ::5].astype(float))}"
        yield f"{name} cover {numbers(found.cover)}"
        yield f"{name} probes {numbers(found.probes)}"
        axis = np.linspace(-0.49, 0.48, 9)
        yield f"{name} lattice {numbers(inside.contains_lattice(mesh, axis, axis[1:] * 0.9, axis[2:] * 0.8))}"
        yield f"{name} points {numbers(inside.contains_points(mesh, points(700, 1, 0.5)))}"
    thin = Mesh(
        np.array([(-0.5, -0.5, -0.5), (0.5, -0.5, 0.5), (-0.5, 0.5, 0.4999), (-0.5, -0.4999, 0.5)]),
        np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]),
    )
    yield f"thin {thin.volume > 0} {numbers(thin.derived(voxels.voxels).probes)}"


@question
def meshes_themselves() -> Lines:
    for name, mesh in {
        **meshes(),
        "moved": Mesh(table().vertices * [1, 2, 3] + [4, 5, 6], table().faces),
    }.items():
        yield f"{name} {summary(mesh)} box {mesh.is_box} convex {mesh.is_convex} volume {mesh.is_volume} {mesh.census}"
        yield f"{name} areas {numbers(mesh.areas)} normals {numbers(mesh.normals)} vectors {numbers(mesh.area_vectors)}"
        hull = mesh.hull
        yield f"{name} hull {numbers(np.sort(hull.vertices, axis=0))} planes {len(hull.planes)} {numbers(np.sort(hull.planes, axis=0))} {hull.volume:.8g}"
        unit, centre, extents = mesh.normalized()
        yield f"{name} unit {unit is mesh} {numbers(centre)} {numbers(extents)} {numbers(unit.bounds)} parts {numbers(mesh.component_vertices)}"
        turned = mesh.moved(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]))
        yield f"{name} turned {numbers(turned.bounds)} {numbers(turned.vertices)}"
    sheet = Mesh(np.array([(0, 0, 0), (2, 0, 0), (0, 3, 0.0)]), np.array([(0, 1, 2)]))
    unit, centre, extents = sheet.normalized()
    yield f"sheet {numbers(unit.vertices)} {numbers(centre)} {numbers(extents)} {sheet.is_volume} {sheet.is_convex} {sheet.is_box} {numbers(sheet.outermost)}"
    vertices, faces = np.eye(3), np.array([(0, 1, 2)])
    yield attempt(lambda: Mesh(vertices[:, :2], faces))
    yield attempt(lambda: Mesh(vertices, faces[:0]))
    yield attempt(lambda: Mesh(vertices, faces + 1))
    yield attempt(lambda: Mesh(vertices, faces - 1))
    yield attempt(lambda: Mesh(vertices * np.nan, faces))


@question
def nearest_points() -> Lines:
    for name in ("cone", "bumpy"):
        index = meshes()[name].derived(nearest.nearest_of)
        for scale in (None, np.array([[1, 2, 0.5]]), points(8, 1) ** 2 + 0.2):
            found = index.find(points(8, 2), scale)
            yield f"{name} {numbers(found.distance)} {numbers(found.point)}"
            within = index.find(points(8, 2), scale, within=0.3)
            yield f"{name} within {numbers(within.distance)} {numbers(within.number >= 0)}"
    a, b, c = (points(30, seed) for seed in (3, 4, 5))
    c[:3] = b[:3]
    b[1] = c[1] = a[1]
    yield f"triangles {numbers(nearest.nearest_on_triangles(points(30, 6, 1.5), a, b, c))}"


@question
def flat_polygons() -> Lines:
    for name, polygon in (
        ("notch", NOTCHED),
        ("hole", HOLED),
        ("box", shapely.box(1, 2, 4, 3)),
        ("two", shapely.MultiPolygon([NOTCHED, shapely.box(5, 5, 9, 6)])),
    ):
        some = Polygons(polygon)
        rng = np.random.default_rng(1)
        x, y = rng.uniform(-3, 5, (2, 60))
        yield f"{name} {some!r} convex {summary(some.convex_corners)} bounds {numbers(some.polygon.bounds)}"
        yield f"{name} sample {numbers(some.sample(*rng.random((3, 12))))}"
        yield f"{name} contains {numbers(some.contains(x, y))} nearly {numbers(some.nearly_contains(x, y))} {numbers(some.distances(x, y))}"
        yield f"{name} points {''.join('X' if some.holds_point(*pair) else 'o' for pair in zip(x.tolist(), y.tolist(), strict=True))}"
        discs = zip(x.tolist(), y.tolist(), rng.uniform(0, 1, 60).tolist(), strict=True)
        yield f"{name} discs {''.join('X' if some.holds_disc(*disc) else 'o' for disc in discs)}"
        yield f"{name} discs {numbers(some.holds_discs(x, y, np.linspace(0, 1, 60)))}"
        yield f"{name} hulls {numbers(some.covers_hulls(rng.uniform(-1.5, 1.5, (30, 4, 2)) * np.linspace(0.1, 1, 30)[:, None, None]))}"
        yield f"{name} triangles {some.covers_triangles(np.array([[(-1, -1), (1, -1), (0, -0.5)]]))} {some.covers_triangles(np.array([[(-1, 1), (1, -1), (1, 1.2)]]))}"
        for low, high in ((-1, 2), (0.5, 0.7)):
            yield f"{name} prism {summary(prisms.prism(polygon, low, high))}"
        for buffer in (0.0, 0.35):
            yield f"{name} union {Polygons.union([some, Polygons(shapely.box(4.5, 2, 4.9, 6))], buffer)!r}"
    for wrong in (
        shapely.Polygon(),
        shapely.Point(1, 2),
        3,
        shapely.Polygon([(0, 0), (1, 1), (1, 0), (0, 1)]),
    ):
        yield attempt(lambda w=wrong: Polygons(w))
    yield attempt(lambda: Polygons.of_points([(0, 0), (1, 1)]))
    yield attempt(lambda: Polygons.of_points([(0, 0), (1, 1), (2, 2)]))
    yield f"empty {prisms.prism(shapely.Polygon(), 0, 1)} {prisms.prism(shapely.LineString([(0, 0), (1, 1)]), 0, 1)}"
    for name in ("cone", "table", "hollow", "bumpy"):
        solid = Mesh(meshes()[name].vertices * [1, 2, 3] + [0.1, 0.2, 0.3], meshes()[name].faces)
        for height in (-1.2, -0.9, 0.3, 1.8, 1.9):
            yield f"{name} slice {height} {summary(prisms.slice_at(solid, height))}"
        yield f"{name} shadow {summary(prisms.shadow(solid))}"


@question
def landings() -> Lines:
    for names in (("box", "cone"), ("table", "bumpy"), ("hollow",)):
        body, one = (
            mixed(8, 1, names),
            Body(
                (meshes()[names[0]],),
                None,
                Poses.fixed((0.3, 0.2, 0.1), (0.1, 0.2, 0.3, np.sqrt(0.86)), (1, 2, 0.6)),
            ),
        )
        start, way = points(8, 2, 1.1), points(8, 3, 2)
        way[3] = 0
        for side, threshold in SIDES:
            for some in (body, one):
                faces, landed = projection.project(some, side, threshold, start, way, 8)
                yield f"{names} {side} {numbers(faces >= 0)} {numbers(np.where(faces[:, None] >= 0, landed, 0))}"
                yield f"{names} {side} on {numbers(projection.landing_points(some, faces, start, way))}"
                faces, landed = projection.project(
                    some, side, threshold, start[:1], np.array([[0.1, 0.2, -1]]), 8
                )
                yield f"{names} {side} from one {numbers(faces >= 0)} {numbers(np.where(faces[:, None] >= 0, landed, 0))}"
                on, _ = projection.project(some, None, 0.0, start, way, 8)
                place = projection.landing_points(some, on, start, way)
                for beside in (0.0, 9e-7, 1.1e-6):
                    shift = surface.face_normals(some, on) * beside
                    yield f"{names} {side} near {beside} {numbers(projection.near_surface(some, side, threshold, place + shift, 8) & (on >= 0))}"


@question
def faces_of_sides() -> Lines:
    for names in (("box", "cone"), ("table", "bumpy"), ("ball",)):
        for count in (7, 60):
            body = mixed(count, 1, names)
            alike = Body(
                body.meshes,
                body.choice,
                Poses(body.poses.position, body.poses.orientation[:1], body.poses.size[:1]),
            )
            uniforms = np.random.default_rng(2).random((3, count))
            for some in (body, alike):
                for side, threshold in SIDES:
                    faces = surface.draw_faces(some, side, threshold, uniforms[0], count)
                    place = surface.face_points(some, faces, uniforms[1], uniforms[2])
                    yield f"{names} {side} {numbers(faces >= 0)} {numbers(np.where(faces[:, None] >= 0, place, 0))}"
                    yield f"{names} {side} mean {numbers(surface.mean_normals(some, side, threshold, count))}"
                    yield f"{names} {side} one {numbers(surface.draw_faces(some, side, threshold, uniforms[0][:1], count) >= 0)}"
                faces = surface.draw_faces(some, None, 0.0, uniforms[0], count)
                yield f"{names} normals {numbers(surface.face_normals(some, faces))}"
                yield f"{names} orientations {numbers(surface.face_orientations(some, faces))}"
    large = Body((bumpy(5),), None, poses(30, 3, same_size=True))
    faces = surface.draw_faces(large, (2, 1), 0.1, np.linspace(0.01, 0.99, 30), 30)
    yield f"large {numbers(surface.face_points(large, faces, np.full(1, 0.3), np.full(1, 0.6)))} {numbers(surface.mean_normals(large, (2, 1), 0.1, 30))}"
    same = Body(
        (bumpy(5),), None, Poses(points(30, 4), np.array([[0, 0, 0.6, 0.8]]), np.array([[1, 2, 3.0]]))
    )
    faces = surface.draw_faces(same, (1, 1), 0.1, np.linspace(0.01, 0.99, 30), 30)
    yield f"same {numbers(surface.face_points(same, faces, np.full(1, 0.3), np.full(1, 0.6)))}"
    upright = Body((primitives.box(),), None, Poses.fixed((1, 2, 3)))
    yield f"upright {numbers(surface.face_orientations(upright, np.arange(0, 12, 2)))}"


@question
def loops() -> Lines:
    counts = np.array([2, 0, 3, 1, 0])
    yield f"expand {[part.tolist() for part in ragged.expand(counts)]} none {[part.tolist() for part in ragged.expand(np.zeros(0, int))]}"
    keys = np.array([4, 1, 4, 0, 1, 7])
    yield f"first {ragged.first_of_each(keys).tolist()} distinct {ragged.distinct(keys.reshape(2, 3)).tolist()}"
    yield f"starts {ragged.group_starts(np.sort(keys), 9).tolist()}"
    yield f"pieces {list(ragged.pieces(np.array([3, 3, 9, 1, 1, 0, 5]), 6))} rows {list(ragged.rows(10, 3, 10))} {list(ragged.rows(3, 0, 2))}"
    groups = ragged.Groups(np.array([0, 2, 5]), counts[:3]).take(np.array([2, 0]))
    yield f"groups {groups.starts.tolist()} {groups.counts.tolist()}"


@question
def lines() -> Lines:
    chains = [[(0, 0, 0), (1, 2, 0.5), (1, 2, 0.5), (3, 1, 2)], [(5, 5, 5), (4, 7, 5)]]
    few = segments.Segments.of_chains(chains)
    many = segments.Segments.of_chains(
        [[(np.cos(k / 9) * k / 20, np.sin(k / 7), k / 40) for k in range(140)]]
    )
    for some in (few, many):
        yield f"{len(some.starts)} {some.length:.9g} {numbers(some.lower)} {numbers(some.upper)} frames {numbers(some.frames)}"
        ways = np.linspace(-0.5, some.length + 0.5, 12)
        yield f"at {numbers(some.number_at(ways).astype(float))} {numbers(some.at(ways))}"
        found, number, place = some.nearest(points(30, 1, 3) + 1)
        yield f"nearest {numbers(found)} {numbers(number.astype(float))} {numbers(place)}"
        ends = some.starts[[0, 1, 2]] * 1.0
        yield f"ends {numbers(some.nearest(ends + np.array([0, 0, 0.3]))[1].astype(float))} {numbers(some.nearest(some.ends[-2:] + np.array([0, 0, -0.2]))[1].astype(float))}"
    yield attempt(lambda: segments.Segments.of_chains([[(0, 0, 0)]]))
    yield attempt(lambda: segments.Segments.of_chains([[(0, 0, 0), (1, np.inf, 0)]]))


@question
def one_at_a_time() -> Lines:
    p, q = poses(30, 1, spread=1.3, sizes=(0.4, 2)), poses(30, 2, spread=1.3, sizes=(0.4, 2))
    for first, second in (("box", "box"), ("box", "cone"), ("cone", "ball"), ("table", "box")):
        found: dict[str, list[Any]] = {"meet": [], "gap": [], "overlap": []}
        for lane in range(30):
            a, b = (
                single.placed(
                    tuple(some.position[lane].tolist()),
                    tuple(some.orientation[lane].tolist()),
                    tuple(some.size[lane].tolist()),
                    meshes()[name],
                )
                for some, name in ((p, first), (q, second))
            )
            found["meet"].append(single.meet(a, b))
            found["gap"].append(single.gap(a, b))
            found["overlap"].append(single.overlap(a, b))
        yield f"{first} {second} meet {''.join({True: 'X', False: 'o', None: '?'}[one] for one in found['meet'])}"
        yield f"{first} {second} gap {numbers([-1 if one is None else one for one in found['gap']])}"
        yield f"{first} {second} overlap {numbers(found['overlap'])}"
    yield f"radius {a.radius:.8g} reach {a.reach(0.6, 0, 0.8):.8g} extents {numbers(a.extents())} corners {numbers(a.corners())}"
    yield f"hull {numbers(b.hull())} slack {a.slack:.8g} {b.slack:.8g} far {single.placed((900, -5, 2), (0, 0, 0, 1), (1, 2, 3), primitives.box()).slack:.8g}"
    starts, ends, middles = (points(40, seed, 2).tolist() for seed in (3, 4, 5))
    near = [
        single.is_near_way(tuple(s), tuple(e), tuple(m), 0.9)
        for s, e, m in zip(starts, ends, middles, strict=True)
    ]
    yield f"way {''.join('X' if one else 'o' for one in near)} {single.is_near_way((0, 0, 0), (0, 0, 0), (0.5, 0, 0), 0.4)} {single.is_near_way((0, 0, 0), (0, 0, 0), (0.5, 0, 0), 0.6)}"
    one, other = ((0.0, 0.0, 0.0), (0.0, 0.0, 2.0))

    def apart(t: Any) -> Any:
        moved = [
            single.placed((0.2, 0.1, z), (0.1, 0.2, 0.3, 0.86**0.5), (1, 2, 0.6), primitives.box())
            for z in (3 * t).tolist()
        ]
        still = single.placed(one, (0, 0, 0.6, 0.8), (1, 0.5, 2), primitives.box())
        return np.array([single.meet(some, still) is True for some in moved])

    yield f"flips {flips(apart, 2)} {other}"


@question
def volumes_of_soups() -> Lines:
    box, cone = primitives.box(), primitives.cone()

    def moved(mesh: Mesh, by: Any, size: float = 1.0, turn: int = 1) -> tuple[Any, Any]:
        return mesh.vertices * size + by, mesh.faces[:, ::turn]

    def soup(*parts: tuple[Any, Any]) -> Mesh:
        offsets = np.cumsum([0] + [len(part[0]) for part in parts[:-1]])
        return Mesh(
            np.concatenate([part[0] for part in parts]),
            np.concatenate([part[1] + k for part, k in zip(parts, offsets, strict=True)]),
        )

    tried = {
        "box": soup(moved(box, 0)),
        "inside out": soup(moved(box, 0, 1, -1)),
        "two apart": soup(moved(box, 0), moved(cone, (3, 0, 0))),
        "two meeting": soup(moved(box, 0), moved(cone, (0.4, 0.1, 0.2))),
        "one turned": soup(moved(box, 0), moved(cone, (3, 0, 0), 1, -1)),
        "cavity": soup(moved(box, 0), moved(cone, (0, 0.1, 0), 0.5, -1)),
        "cavity of the inner": soup(
            moved(box, 0, 4), moved(box, (0, 0, 0.2), 2, -1), moved(box, 0), moved(cone, (0, 0.1, 0), 0.5, -1)
        ),
        "apart": Mesh(box.triangles.reshape(-1, 3), np.arange(36).reshape(-1, 3)),
        "nearly": Mesh(box.triangles.reshape(-1, 3) + points(36, 1, 1e-9), np.arange(36).reshape(-1, 3)),
        "too far": Mesh(box.triangles.reshape(-1, 3) + points(36, 1, 1e-4), np.arange(36).reshape(-1, 3)),
        "hole": Mesh(box.vertices, box.faces[1:]),
        "two holes": Mesh(box.vertices, box.faces[[1, 2, 4, 5, 6, 7, 8, 9, 10, 11]]),
        "winding": Mesh(box.vertices, np.concatenate([box.faces[:1, ::-1], box.faces[1:]])),
        "flat": Mesh(box.vertices * [1, 1, 0], box.faces),
        "point": Mesh(box.vertices * 0, box.faces),
    }
    for name, mesh in tried.items():
        for unify in (True, False):
            yield f"{name} {unify} {attempt(lambda m=mesh, u=unify: solids.proper_volume(m, unify=u, name='`a.obj`'))}"
        yield f"{name} {topology.edge_census(mesh.faces)} {numbers(topology.face_components(mesh.faces, len(mesh.vertices)).astype(float))}"
    vertices, faces = topology.merge_vertices(tried["nearly"].vertices, tried["nearly"].faces, tolerance=1e-7)
    yield f"merged {len(vertices)} {len(faces)} {len(topology.merge_vertices(tried['nearly'].vertices, tried['nearly'].faces)[0])}"
    for name, solid in (
        ("union", booleans.union([box, Mesh(*moved(cone, (0.3, 0.2, 0.1)))])),
        ("both", booleans.intersection([box, Mesh(*moved(cone, (0.3, 0.2, 0.1)))])),
        ("rest", booleans.difference(box, [Mesh(*moved(cone, (0.3, 0.2, 0.1)))])),
    ):
        yield f"{name} {solid.volume:.8g} {numbers(solid.bounds)}"
    yield f"none {booleans.intersection([box, Mesh(*moved(cone, (3, 0, 0)))])} {booleans.union([box, tried['hole']])} {booleans.difference(box, [Mesh(box.vertices * 2, box.faces)])}"
    for name, mesh in (
        ("cylinder", primitives.cylinder(3)),
        ("default", primitives.cylinder()),
        ("cone", cone),
        ("ball", primitives.spheroid()),
    ):
        yield f"{name} {summary(mesh)} {numbers(mesh.vertices)} {numbers(mesh.faces.astype(float))}"


@question
def faces_that_meet() -> Lines:
    rng = np.random.default_rng(1)
    for kind in ("any", "level", "shared edge"):
        first, second, way = (
            rng.normal(size=(3, 3, 40)),
            rng.normal(size=(3, 3, 40)),
            rng.normal(size=(3, 40)) * 4,
        )
        if kind == "level":
            first[:, 2] = second[:, 2] = 0.3
            way[2] = 0
        if kind == "shared edge":
            second[0] = first[1]
        yield f"{kind} {flips(lambda t, a=first, b=second, w=way: triangles.separated_by_edges(a, b + t * w), 40, 14)}"
