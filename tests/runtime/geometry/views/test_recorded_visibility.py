"""What is seen, and how it is found out, is as recorded: where things come into view and go behind others."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from scenic.runtime.geometry.contact import scalar_bodies as one_body
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.views import grid, hits
from scenic.runtime.geometry.views import observers as views
from scenic.runtime.geometry.views import occlusion_proofs as proofs
from scenic.runtime.geometry.views import scalar_views as single
from scenic.runtime.geometry.views import seen_bodies as bodies
from scenic.runtime.geometry.views import subdivision as proving
from scenic.runtime.geometry.views import view_volumes as regions
from scenic.runtime.geometry.views.observers import Views
from scenic.runtime.geometry.views.occluders import Obstacles, Occluder
from scenic.runtime.geometry.views.seen_points import hidden_points, sees_points
from tests.recorded import FOLDER, hold
from tests.runtime.geometry.samples import random_poses
from tests.runtime.geometry.test_recorded_geometry import meshes, points
from tests.runtime.matrices import flips, numbers, summary, turns

Lines = Iterator[str]
QUESTIONS: dict[str, Callable[[], Lines]] = {}
LANES = 8
ANGLES = [
    (2 * np.pi, np.pi),
    (1.3, 0.8),
    (4.2, 0.5),
    (2 * np.pi, 0.7),
    (0.9, np.pi),
    (2 * np.pi - 0.01, np.pi - 0.01),
]


def question(ask: Callable[[], Lines]) -> Callable[[], Lines]:
    QUESTIONS[ask.__name__] = ask
    return ask


def test_visibility(request: pytest.FixtureRequest) -> None:
    hold(FOLDER / "visibility.txt", lambda source: "\n".join(QUESTIONS[source.strip()]()), request)


def test_every_question_is_asked() -> None:
    text = (FOLDER / "visibility.txt").read_text(encoding="utf-8")
    assert all(f"== {name}\n" in text for name in QUESTIONS)


def observers(seed: int, angles: Any = None, lanes: int = LANES, **options: Any) -> Views:
    rng = np.random.default_rng(seed)
    if angles is None:
        angles = np.array([ANGLES[lane % len(ANGLES)] for lane in range(lanes)])
    return Views(
        rng.normal(0, 0.3, (lanes, 3)),
        turns(rng, lanes),
        np.broadcast_to(np.asarray(angles, dtype=float), (lanes, 2)),
        rng.uniform(4, 9, lanes),
        options.get("density", rng.uniform(0.6, 2, lanes)),
        np.asarray(options.get("count", np.zeros((1, 2))), dtype=float),
        np.asarray(options.get("scaling", [False])),
    )


def ahead(some: Views, lane: int, azimuth: float, altitude: float, reach: float) -> Any:
    level = np.cos(altitude)
    way = np.array([-np.sin(azimuth) * level, np.cos(azimuth) * level, np.sin(altitude)])
    matrix = some.matrix[lane if len(some.matrix) > 1 else 0]
    return some.camera[lane if len(some.camera) > 1 else 0] + matrix @ (reach * way)


def swept(some: Views, kind: str, lanes: int = LANES) -> Callable[[Any], Any]:
    """Places that go from the middle of the view over a border: to the side, up, both ways or farther away."""
    sides = {
        "left": (3.1, 0),
        "right": (-3.1, 0.02),
        "up": (0.05, 1.6),
        "down": (0, -1.5),
        "across": (-2.5, 1.1),
        "far": (0.1, 0.05),
    }
    azimuth, altitude = sides[kind]

    def place(t: Any) -> Any:
        return np.array(
            [
                ahead(
                    some,
                    lane,
                    t[lane] * azimuth,
                    t[lane] * altitude,
                    3.0 + (8 * t[lane] if kind == "far" else 0.2 * lane),
                )
                for lane in range(lanes)
            ]
        )

    return place


KINDS = ("left", "right", "up", "down", "across", "far")


@question
def frames() -> Lines:
    some = observers(1)
    for of in (
        some,
        Views.fixed((1, 2, 3)),
        Views.fixed((1, -1, 0), (0.1, 0.2, 0.3, np.sqrt(0.86)), angles=(1, 0.5), distance=7),
    ):
        lanes = len(of.camera)
        yield f"window {numbers(of.window)} views {numbers(of.to_view(points(lanes, 2, 3)))}"
        yield f"several {numbers(of.to_view(points(6, 3, 3).reshape(1, 6, 3)))}"
        yield f"spread {numbers(of.spread(lanes).take(np.arange(lanes)[::-1]).distance)} contains {numbers(of.contain(points(40, 4, 6)) if lanes == 1 else of.contain(points(lanes, 4, 6)))}"
    for kind in KINDS:
        for name, of in (("turned", some), ("level", level())):
            place = swept(of, kind)
            yield f"{kind}, {name} {flips(lambda t, p=place, v=of: v.contain(p(t)), LANES)}"
    yield f"itself {numbers(some.contain(some.camera))}"
    for seed in range(4):
        poses = random_poses(LANES, seed, spread=3, sizes=(0.3, 2.5))
        found = views.extents(views.box_corners(some, poses))
        yield f"extents {numbers(found.azimuth)} {numbers(found.around)} {numbers(found.altitude)}"
        yield f"meet {numbers(found.meet(some.window))}"
    over = Poses(
        np.array([(0.1, 0.2, 2), (0.1, -0.1, -2), (0.05, 1.2, 0), (0, -2, 0.1)]),
        np.array([[0, 0, 0, 1.0]]),
        np.array([[1, 2, 0.5]]),
    )
    found = views.extents(views.box_corners(Views.fixed((0, 0, 0)).spread(4), over))
    yield f"over and under {numbers(found.azimuth)} {numbers(found.around)} {numbers(found.altitude)}"


def level() -> Views:
    return Views(
        points(LANES, 5),
        np.array([[0, 0, 0, 1.0]]),
        np.array([ANGLES[lane % 6] for lane in range(LANES)]),
        np.full(1, 6.0),
        np.ones(1),
        np.zeros((1, 2)),
        np.array([False]),
    )


@question
def grids_of_rays() -> Lines:
    poses = random_poses(LANES, 1, spread=3, sizes=(0.3, 2.5))
    for options in (
        {},
        {"count": [[30, 20]]},
        {"scaling": [True]},
        {"count": [[0, 9]]},
        {"count": [[8, 0]], "scaling": [True]},
        {"density": np.full(LANES, 0.01)},
    ):
        some = observers(2, **options)
        directions = views.extents(views.box_corners(some, poses))
        rows = grid.rows_towards(some.spread(LANES), directions, np.linspace(1, 5, LANES))
        yield f"{sorted(options)} {len(rows.lane)} {rows.totals(LANES).tolist()} {numbers(rows.altitude)} {numbers(rows.first)} {numbers(rows.step)}"
        yield f"numbers {numbers(rows.number.astype(float))} counts {numbers(rows.count.astype(float))}"
        for across in (3, 8):
            thin = rows.thinned(across, LANES)
            yield f"thinned {across} {len(thin.lane)} {thin.totals(LANES).tolist()} {numbers(thin.first)} {numbers(thin.step)} {numbers(thin.altitude)}"
        for most in (1 << 20, 50):
            cast = list(rows.rays(most))
            yield f"rays {most} {len(cast)} {numbers(np.concatenate([part[0] for part in cast]).astype(float))} {numbers(np.concatenate([part[1] for part in cast]))}"


@question
def first_hits() -> Lines:
    some = observers(3)
    rng = np.random.default_rng(4)
    for names in (("box", "cone", "bumpy"), ("table",), ("hollow", "ball")):
        known = tuple(meshes()[name] for name in names)
        poses = random_poses(LANES, 5, spread=2, sizes=(0.8, 2.5))
        body = Body(known, np.arange(LANES) % len(names), poses)
        placed = hits.place(body, some, np.arange(LANES))
        lane = np.repeat(np.arange(LANES), 12)
        towards = some.to_view(poses.to_world(rng.uniform(-0.7, 0.7, (LANES, 12, 3)))).reshape(-1, 3)
        for exact in (False, True):
            yield f"{names} {exact} {numbers(placed.first(lane, towards, exact=exact))}"
        yield f"{names} away {numbers(placed.first(lane, -towards))} inside {numbers(bodies.inside_body(placed))}"
        yield f"{names} apart {numbers(bodies.box_distance(placed.origin, poses.size))}"
        within = Views(
            poses.position,
            some.orientation,
            some.angles,
            some.distance,
            some.density,
            some.count,
            some.scaling,
        )
        inner = hits.place(body, within, np.arange(LANES))
        yield f"{names} from within {numbers(inner.first(lane, towards))} {numbers(bodies.inside_body(inner))}"
    start, way = points(60, 6, 1.5), points(60, 7)
    way[::6] = np.eye(3)[np.arange(10) % 3]
    near, far = hits.box_span(start, way)
    yield f"span {numbers(near.clip(-9, 9))} {numbers(far.clip(-9, 9))}"
    for name in ("cone", "bumpy", "ball"):
        near, _ = hits.box_span(start, points(60, 8, 0.3) - start)
        yield f"{name} exactly {numbers(hits.exact_first(meshes()[name], start, points(60, 8, 0.3) - start, near))}"
        crosses, where = hits.face_crossings(meshes()[name], start, way, np.arange(60))
        yield f"{name} crossings {numbers(crosses)} {numbers(np.where(crosses, where, 0))}"


def hiding(seed: int, names: tuple[str, ...], some: Views, t: Any = None, way: Any = None) -> list[Occluder]:
    """Occluders between the observers and what is before them."""
    result = []
    for number, name in enumerate(names):
        poses = random_poses(LANES, seed + number, spread=0.3, sizes=(0.8, 2.2))
        middle = np.array(
            [ahead(some, lane, 0.1 * number, -0.05 * number, 1.7 + 0.3 * number) for lane in range(LANES)]
        )
        position = poses.position + middle
        if t is not None and number == 0:
            position = position + t[:, None] * way
        active = np.ones(1, bool) if number == 0 else np.arange(LANES) % 3 != number
        result.append(
            Occluder(Body((meshes()[name],), None, Poses(position, poses.orientation, poses.size)), active)
        )
    return result


@question
def points_in_view() -> Lines:
    for seed, names in (
        (1, ()),
        (2, ("box",)),
        (3, ("cone", "box", "table")),
        (4, ("bumpy", "hollow")),
        (5, ("ball", "cone")),
    ):
        some = observers(seed)
        for kind in KINDS:
            place = swept(some, kind)
            around = hiding(seed, names, some)
            yield f"{names} {kind} {flips(lambda t, p=place, o=around, v=some: sees_points(v, p(t), o, LANES), LANES)}"
        target = swept(some, "left")(np.zeros(LANES))
        way = turns(np.random.default_rng(seed), LANES)[:, :3] * 6
        if names:
            yield f"{names} passing {flips(lambda t, w=way, v=some, n=names, s=seed, p=target: sees_points(v, p, hiding(s, n, v, t, w), LANES), LANES)}"
            yield f"{names} one {numbers(sees_points(some, target[:1], hiding(seed, names, some), LANES))}"
            lanes = np.array([1, 4, 6])
            yield f"{names} hidden {numbers(hidden_points(some.spread(LANES).take(lanes), target[lanes], hiding(seed, names, some), lanes))}"
            yield f"{names} at the camera {numbers(sees_points(some, some.camera, hiding(seed, names, some), LANES))}"


@question
def bodies_in_view() -> Lines:
    for seed, target, names in (
        (1, "box", ()),
        (2, "cone", ("box",)),
        (3, "table", ("cone", "box")),
        (4, "bumpy", ("hollow", "table")),
        (5, "ball", ("bumpy",)),
        (6, "hollow", ("box", "box")),
    ):
        some = observers(seed)
        poses = random_poses(LANES, seed + 7, spread=0.1, sizes=(0.3, 0.9))
        mesh = meshes()[target]
        hidden = hiding(seed, names, some)
        for kind in KINDS:
            place = swept(some, kind)

            def moved(t: Any, place: Any = place, poses: Poses = poses, mesh: Mesh = mesh) -> Body:
                return Body((mesh,), None, Poses(place(t), poses.orientation, poses.size))

            yield f"{target} {names} {kind} {flips(lambda t, b=moved, o=hidden, v=some: bodies.sees_bodies(v, b(t), o, LANES), LANES, 7)}"
            if kind in ("up", "across"):
                yield f"{target} {names} {kind} proved {flips(lambda t, b=moved, o=hidden, v=some: proving.prove(v, b(t), o, LANES, most_cells=64) == 1, LANES, 4)}"
            yield f"{target} {names} {kind} hidden {numbers(proving.prove(some, moved(np.full(LANES, 0.15)), hidden, LANES).astype(float))}"
        wide = Body(
            (mesh,), None, Poses(swept(some, "left")(np.zeros(LANES)), poses.orientation, poses.size * 2)
        )
        way = turns(np.random.default_rng(seed), LANES)[:, :3] * 6
        if names:
            yield f"{target} {names} passing {flips(lambda t, w=way, v=some, n=names, s=seed, b=wide: bodies.sees_bodies(v, b, hiding(s, n, v, t, w), LANES), LANES, 10)}"
        few = observers(seed, count=[[3, 2]])
        yield f"{target} few rays {numbers(bodies.sees_bodies(few, wide, hidden, LANES))} {numbers(bodies.sees_bodies(observers(seed, density=np.full(LANES, 9.0)), wide, hidden, LANES))}"
        scaled = observers(seed, density=np.full(LANES, 0.02), scaling=[True])
        yield f"{target} scaled {numbers(bodies.sees_bodies(scaled, wide, hidden, LANES))}"
    many = Views.fixed((0, 0, 0), angles=(2, 1.2), distance=9)
    crowd = random_poses(1500, 9, spread=4)
    wall = Occluder(Body((meshes()["box"],), None, Poses.fixed((0.3, 1.4, 0), size=(2, 0.1, 1.3))))
    yield f"many {numbers(bodies.sees_bodies(many, Body((meshes()['box'],), None, crowd), [wall], 1500))}"
    yield f"many points {numbers(sees_points(many, crowd.position, [wall], 1500))}"
    yield f"many proved {numbers(proving.prove(many, Body((meshes()['cone'],), None, crowd.take(np.arange(150))), [wall], 150).astype(float))}"


@question
def what_hides() -> Lines:
    some = observers(4)
    for names in (("box", "cone"), ("table", "hollow", "bumpy")):
        target = random_poses(LANES, 9, spread=0.1, sizes=(0.2, 0.5))
        place = swept(some, "left")(np.zeros(LANES))
        poses = Poses(place, target.orientation, target.size)
        obstacles = Obstacles(
            hiding(4, names, some), some.spread(LANES), np.arange(LANES), place, np.linspace(0, 0.9, LANES)
        )
        yield f"{names} near {len(obstacles.near)} {[numbers(lanes) for lanes in obstacles.lanes]}"
        corners = views.box_corners(some, poses)
        yield f"{names} boxes {numbers(proofs.boxes_hidden(corners, obstacles))}"
        lane = np.repeat(np.arange(LANES), 8)
        for limit in (0.2, 0.6, 1.0):
            yield f"{names} blocked {limit} {numbers(obstacles.block(lane, corners.reshape(-1, 3), np.full(len(lane), limit)))}"
        limits = np.linspace(0.3, 1, LANES * 8).reshape(LANES, 8)
        for number in range(len(obstacles.near)):
            yield f"{names} shadow {number} {numbers(proofs.shadowed(obstacles.placed(number), np.arange(LANES), corners, limits))}"
    for name in ("table", "hollow", "bumpy"):
        boxes = meshes()[name].derived(proofs.inner_boxes)
        yield f"{name} inner boxes {len(boxes)} {numbers(boxes)}"


@question
def places_in_view() -> Lines:
    some = observers(5)
    rng = np.random.default_rng(6)
    yield f"drawn {numbers(regions.draw_places(some.spread(LANES), rng.random((LANES, 3))))}"
    yield f"near {numbers(regions.draw_near(some.spread(LANES), np.linspace(0.1, 2, LANES), rng.random((LANES, 4))))}"
    yield f"volumes {numbers(regions.view_volume(some))} {numbers(regions.near_volume(some, np.linspace(0.1, 2, LANES)))}"
    yield f"angles {numbers(regions.region_angles(np.array(ANGLES)))}"
    for angles in ANGLES:
        mesh = regions.view_mesh(*angles)
        yield f"{angles[0]:.3f} {angles[1]:.3f} {summary(mesh)} {mesh.is_volume} {mesh.is_convex}"


@question
def one_at_a_time() -> Lines:
    known = meshes()
    for angles in ANGLES:
        matrix = one_body.axes_of((0.1, 0.2, 0.3, 0.86**0.5))
        view = single.View((0.2, -0.1, 0.3), matrix, angles, 6.0)
        told: list[list[Any]] = [[], [], [], []]
        rng = np.random.default_rng(7)
        for _ in range(40):
            place = tuple(rng.uniform(-5, 5, 3).tolist())
            turn = rng.normal(size=4)
            turn = tuple((turn / np.linalg.norm(turn)).tolist())
            size = tuple(rng.uniform(0.3, 1.5, 3).tolist())
            half = tuple((0.5 * np.array(place) + rng.normal(0, 0.2, 3)).tolist())
            for mesh in (known["box"], known["cone"]):
                target, wall = (
                    one_body.placed(place, turn, size, known["table"]),
                    one_body.placed(half, turn, tuple(2 * part for part in size), mesh),
                )
                told[0].append(view.contains(place))
                told[1].append(view.meets_ball(place, size[0]))
                told[2].append(single.sees_point(view, place, [wall]))
                told[3].append(
                    single.sees_body(view, one_body.placed(place, turn, size, mesh), [wall, target])
                )
        yield "\n".join(
            f"{angles[0]:.3f} {what} {''.join({True: 'X', False: 'o', None: '?'}[answer] for answer in answers)}"
            for what, answers in zip(("contains", "ball", "point", "body"), told, strict=True)
        )
