import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.contact import collision, narrowphase
from scenic.runtime.geometry.contact.broadphase import boxes_overlap
from scenic.runtime.geometry.contact.collision import Collider, collide
from scenic.runtime.geometry.contact.crowd import Crowd
from scenic.runtime.geometry.contact.narrowphase import meshes_intersect
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from tests.amounts import amount

from .samples import SHAPES, hollow, random_poses, table, yawed

LANES = amount(24, 60)
MESHES = [SHAPES[name]() for name in ("box", "table", "cylinder", "spheroid", "hollow")]


@pytest.fixture(autouse=True, params=[0.0, np.inf], ids=["with proofs", "exactly"])
def patience(request, monkeypatch):
    """Cells prove what they can from the first pair on, or never: what is found is the same."""
    monkeypatch.setattr(narrowphase, "seconds_to_make", lambda mesh: request.param)


def crowd(bodies: int, seed: int, lanes: int = LANES) -> list[Body]:
    """Bodies of all sorts: fixed ones, such of constant and random size, choices of meshes."""
    rng = np.random.default_rng(seed)
    spread = 0.5 * bodies ** (1 / 3) + 0.5
    result = []
    for number in range(bodies):
        kind = number % 4
        if kind == 0:
            poses = random_poses(1, seed + number, spread=spread, sizes=(0.2, 0.8))
            poses = Poses.fixed(poses.position[0], poses.orientation[0], poses.size[0])
        else:
            poses = random_poses(lanes, seed + number, spread=spread, sizes=(0.2, 0.8), same_size=kind == 1)
        mesh = MESHES[rng.integers(len(MESHES))]
        if rng.random() < 0.3:
            poses.bounds()  # bodies whose world boxes are known are looked at by them
        if kind == 3:
            result.append(Body((mesh, table()), rng.integers(0, 2, lanes), poses, rng.random(lanes) < 0.2))
        else:
            result.append(Body((mesh,), None, poses, is_fixed=kind == 0))
    return result


def lane_poses(body: Body, lane: int) -> Poses:
    parts = (body.poses.position, body.poses.orientation, body.poses.size)
    rows = [part[lane : lane + 1] if len(part) > 1 else part for part in parts]
    return Poses(*rows)


def one_by_one(bodies, pairs, lanes):
    """Every pair of every lane for itself."""
    result = np.zeros((lanes, len(pairs)), dtype=bool)
    for lane in range(lanes):
        for number, (i, j) in enumerate(pairs):
            a, b = sorted((i, j))
            allowed = any(body.allow[lane % len(body.allow)] for body in (bodies[a], bodies[b]))
            meshes = [
                body.meshes[0 if body.choice is None else body.choice[lane]]
                for body in (bodies[a], bodies[b])
            ]
            if not allowed:
                poses = lane_poses(bodies[a], lane), lane_poses(bodies[b], lane)
                result[lane, number] = meshes_intersect(meshes[0], poses[0], meshes[1], poses[1])[0]
    return result


def check(bodies, pairs, lanes):
    expected = one_by_one(bodies, pairs, lanes)
    every = collide(bodies, pairs, lanes, exhaustive=True)
    np.testing.assert_array_equal(every.pairs, expected)
    np.testing.assert_array_equal(every.free, ~expected.any(axis=1))
    quick = collide(bodies, pairs, lanes)
    np.testing.assert_array_equal(quick.free, every.free)
    assert quick.pairs is None
    return expected


def test_all_pairs():
    bodies = crowd(9, 1)
    # The bodies that are fixed in all lanes must not collide, or all lanes are lost.
    pairs = [(i, j) for i, j in itertools.combinations(range(9), 2) if i % 4 or j % 4]
    expected = check(bodies, pairs, LANES)
    assert 0 < expected.mean() < 0.5
    assert 0 < expected.any(axis=1).mean() < 1


def test_some_pairs_in_any_order():
    check(crowd(6, 2), [(5, 1), (2, 3), (4, 2), (1, 0)], LANES)


def test_many_bodies_are_swept():
    lanes = 2
    bodies = [body for body in crowd(amount(350, 600), 3, lanes) if not body.is_fixed]
    pairs = np.array(list(itertools.combinations(range(len(bodies)), 2)))
    every = collide(bodies, None, lanes, exhaustive=True)
    spread = np.stack([np.broadcast_to(body.poses.position, (lanes, 3)) for body in bodies])
    far = np.linalg.norm(spread[pairs[:, 0]] - spread[pairs[:, 1]], axis=-1).min(axis=1) > 1.4
    assert not every.pairs[:, far].any()
    np.testing.assert_array_equal(every.pairs[:, ~far], one_by_one(bodies, pairs[~far].tolist(), lanes))
    np.testing.assert_array_equal(collide(bodies, None, lanes).free, every.free)


@pytest.mark.parametrize("is_fixed", [True, False])
def test_still_pairs_decide_all_lanes(is_fixed):
    box = primitives.box()
    bodies = [
        Body((box,), None, yawed(p), is_fixed=is_fixed) for p in ((0, 0, 0), (0.5, 0.5, 0.5), (5, 0, 0))
    ]
    assert not collide(bodies, [(0, 1), (0, 2)], 10).free.any()
    assert collide(bodies, [(0, 2), (1, 2)], 10).free.all()
    every = collide(bodies, [(0, 1), (0, 2)], 10, exhaustive=True)
    np.testing.assert_array_equal(every.pairs, [[True, False]] * 10)
    tolerant = Body((box,), None, yawed((0, 0, 0)), np.array([True]))
    assert collide([tolerant, *bodies[1:]], [(0, 1)], 10).free.all()


def test_a_cast_is_tested_batch_after_batch():
    lanes = amount(20, 40)
    bodies = crowd(9, 7, lanes)
    pairs = [(i, j) for i, j in itertools.combinations(range(9), 2) if i % 4 or j % 4]
    cast = Collider(bodies, pairs)
    for chosen in (np.arange(lanes), np.arange(0, lanes, 3), np.array([7])):
        some = [body.take(chosen) for body in bodies]
        expected = one_by_one(some, pairs, len(chosen))
        np.testing.assert_array_equal(cast.test(some, len(chosen), exhaustive=True).pairs, expected)
        np.testing.assert_array_equal(cast.test(some, len(chosen)).free, ~expected.any(axis=1))


def test_stacked_bodies_are_those_one_by_one():
    lanes, count = amount(20, 50), 6
    poses = random_poses(lanes * count, 9, spread=1.2)
    sizes = random_poses(count, 10).size
    numbers = np.arange(lanes * count) % 3
    still = Body((table(),), None, yawed((0, 0, 0)), is_fixed=True)
    alone = [
        Body(
            tuple(MESHES[:3]), numbers[part], Poses(poses.position[part], poses.orientation[part], size[None])
        )
        for part, size in zip(np.arange(lanes * count).reshape(count, lanes), sizes, strict=True)
    ]
    stack = Crowd.stacked(
        count, tuple(MESHES[:3]), poses.position, poses.orientation, sizes, numbers, np.array([False])
    )
    cast = Collider([*alone, still])
    expected = one_by_one([*alone, still], cast.pairs.tolist(), lanes)
    assert 0 < expected.mean() < 1
    np.testing.assert_array_equal(cast.test(stack, lanes, exhaustive=True).pairs, expected)
    np.testing.assert_array_equal(cast.test([*alone, still], lanes, exhaustive=True).pairs, expected)


def test_fixed_bodies_are_compared_once():
    box, places = primitives.box(), [(0, 0, 0), (0.5, 0.5, 0.5), (5, 0, 0), (5.2, 0, 0.9), (5, 5, 5)]
    bodies = [Body((box,), None, yawed(place), is_fixed=True) for place in places]
    bodies.insert(1, Body((box,), None, random_poses(30, 8, spread=3)))
    cast = Collider(bodies)
    assert sorted(cast.fixed_collisions.tolist()) == [[0, 2], [3, 4]]
    assert not cast.test(bodies, 30).free.any()
    found = cast.test(bodies, 30, exhaustive=True).pairs
    np.testing.assert_array_equal(found, one_by_one(bodies, cast.pairs.tolist(), 30))
    assert Collider(bodies, [(0, 1), (3, 0)]).fixed_collisions.tolist() == []
    assert Collider(bodies, [(2, 0), (3, 0)]).fixed_collisions.tolist() == [[0, 2]]


def test_meshes_may_differ_from_batch_to_batch():
    """As many as before: what was learnt of the others says nothing about them."""
    count = amount(25, 60)
    poses = random_poses(count, 12, spread=0.5)
    still = Body((table(),), None, yawed((0, 0, 0)))
    cast = Collider([Body((primitives.spheroid(),), None, poses), still])
    for mesh in (primitives.spheroid(), hollow(), primitives.cone(), table()):
        bodies = [Body((mesh,), None, poses), still]
        np.testing.assert_array_equal(
            cast.test(bodies, count).free, [not hit for (hit,) in one_by_one(bodies, [(0, 1)], count)]
        )


def test_either_body_of_a_pair_may_allow_collisions():
    lanes = 6
    at = yawed((0, 0, 0))
    allow = np.arange(lanes) % 2 == 0
    for one, other in ((allow, np.zeros(1, bool)), (np.zeros(1, bool), allow), (allow, ~allow)):
        bodies = [Body((primitives.box(),), None, at, allow=item) for item in (one, other)]
        np.testing.assert_array_equal(collide(bodies, None, lanes).free, np.broadcast_to(one | other, lanes))


PROPERTIES = ("position", "orientation", "size", "choice", "allow")


def differing(names: tuple[str, ...], seed: int, *, lanes: int = 12) -> Body:
    """A body of which only these properties differ from lane to lane; it is long, so that its turn matters."""
    rng = np.random.default_rng(seed)
    many = random_poses(lanes, seed, spread=1.3, sizes=(0.2, 1.2))
    parts = {
        "position": many.position,
        "orientation": many.orientation,
        "size": many.size * [1, 1, 2],
        "choice": rng.permutation(lanes) % 3,
        "allow": rng.random(lanes) < 0.2,
    }
    rows = {name: part if name in names else part[:1] for name, part in parts.items()}
    poses = Poses(rows["position"], rows["orientation"], rows["size"])
    meshes = (primitives.box(), table(), primitives.cone())
    return Body(meshes, rows["choice"], poses, rows["allow"] if "allow" in names else np.zeros(1, dtype=bool))


@pytest.mark.parametrize("known", [(), (0, 2, 4), (1, 3, 5)], ids=str)
@pytest.mark.parametrize("varied", [*((name,) for name in PROPERTIES), PROPERTIES], ids="+".join)
def test_bodies_that_differ_in_some_properties_alone(varied, known):
    """Beside such that differ in all others, and fixed ones; the world boxes of some are known beforehand."""
    others = tuple(name for name in PROPERTIES if name not in varied)
    bodies = [differing(names, seed) for seed, names in enumerate((varied, others, varied, others), 131)]
    for seed in (135, 136):
        still = differing((), seed)
        bodies.append(Body(still.meshes, still.choice, still.poses, is_fixed=True))
    for number in known:
        bodies[number].poses.bounds()
    pairs = list(itertools.combinations(range(len(bodies)), 2))
    lanes = [replace(body, choice=np.broadcast_to(body.choice, 12), is_fixed=False) for body in bodies]
    expected = one_by_one(lanes, pairs, 12)
    assert expected.any(axis=0).mean() > 0.2
    assert not expected.any(axis=1).all()
    found = collide(bodies, pairs, 12, exhaustive=True)
    np.testing.assert_array_equal(found.pairs, expected)
    np.testing.assert_array_equal(collide(bodies, pairs, 12).free, ~expected.any(axis=1))
    # Two alike, stacked, before the fixed ones.
    alike = [bodies[number] for number in (0, 2, 4, 5)]
    columns = [np.concatenate([getattr(body.poses, name) for body in alike[:2]]) for name in PROPERTIES[:3]]
    columns += [np.concatenate([getattr(body, name) for body in alike[:2]]) for name in PROPERTIES[3:]]
    cast, stack = Collider(alike), Crowd.stacked(2, alike[0].meshes, *columns)
    chosen = [pairs.index((0, 2)), pairs.index((0, 4)), pairs.index((0, 5)), pairs.index((2, 4))]
    chosen += [pairs.index((2, 5)), pairs.index((4, 5))]
    np.testing.assert_array_equal(cast.test(stack, 12, exhaustive=True).pairs, expected[:, chosen])


@pytest.mark.parametrize("varied", [("size",), ("position", "size")], ids="+".join)
def test_bodies_that_never_turn_and_are_about_as_long_as_wide(varied):
    """Of changing size: their boxes need no matrix for each lane."""
    lanes, bodies = 12, []
    for seed in range(160, 166):
        many = random_poses(lanes, seed, spread=0.7, sizes=(0.4, 0.9))
        bodies.append(
            Body(
                (table(),),
                None,
                Poses(
                    many.position if "position" in varied else many.position[:1],
                    many.orientation[:1],
                    many.size,
                ),
            )
        )
    pairs = list(itertools.combinations(range(len(bodies)), 2))
    expected = check(bodies, pairs, lanes)
    assert 0.05 < expected.mean() < 0.6


def test_unwanted_pairs_count_nowhere_among_many_lanes():
    """Pairs come in several groups there; in each of them only the wanted ones count."""
    lanes, count = 9000, 8
    box = primitives.box()
    bodies = [Body((box,), None, random_poses(lanes, 40 + number, spread=2)) for number in range(count)]
    wanted = [(0, 3), (7, 1), (2, 6), (5, 6)]
    found = collide(bodies, wanted, lanes, exhaustive=True)
    expected = np.stack([boxes_overlap(bodies[i].poses, bodies[j].poses) for i, j in wanted], axis=1)
    np.testing.assert_array_equal(found.pairs, expected)
    np.testing.assert_array_equal(collide(bodies, wanted, lanes).free, ~expected.any(axis=1))
    assert 0.1 < expected.any(axis=1).mean() < 0.9


def test_no_pairs():
    assert collide([], [], 4).free.all()
    assert collide(crowd(3, 4), np.empty((0, 2)), LANES).free.all()


@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_do_not_matter(batch):
    lanes = 540
    bodies = crowd(8, 5, lanes)
    pairs = [(i, j) for i, j in itertools.combinations(range(8), 2) if i % 4 or j % 4]
    whole = collide(bodies, pairs, lanes, exhaustive=True)
    for start in range(0, min(lanes, amount(30, 60) * batch), batch):
        part = slice(start, min(start + batch, lanes))
        some = [body.take(np.arange(part.start, part.stop)) for body in bodies]
        found = collide(some, pairs, part.stop - part.start, exhaustive=True)
        np.testing.assert_array_equal(found.pairs, whole.pairs[part])


@pytest.mark.parametrize("turned", [False, True])
def test_the_one_of_many_near_bodies_that_collides_is_found_whichever_it_is(turned):
    """In a cavity many bodies must be told apart from the walls exactly; in each lane another one is in a wall."""
    steps = np.linspace(-0.18, 0.18, 3)
    places = np.array(list(itertools.product(steps, steps, steps)))
    count = len(places)
    lanes = count + 1
    turn = Rotation.from_euler("ZXY", [0.4, 0.3, 0.9]) if turned else Rotation.identity()
    frame, size = turn.as_quat()[None], np.full((1, 3), 0.06)
    still = Poses(np.zeros((1, 3)), frame, np.ones((1, 3)))
    bodies = [Body((hollow(), primitives.box()), np.zeros(lanes, dtype=np.intp), still)]
    for number, place in enumerate(places):
        local = np.tile(place, (lanes, 1))
        local[number, 0] = 0.3
        bodies.append(Body((primitives.cylinder(),), None, Poses(turn.apply(local), frame, size)))
    expected = np.arange(lanes) == count
    np.testing.assert_array_equal(collide(bodies, None, lanes).free, expected)
    pairs = [(0, number + 1) for number in range(count)]
    every = collide(bodies, pairs, lanes, exhaustive=True)
    np.testing.assert_array_equal(every.pairs, np.eye(lanes, count, dtype=bool))
    # Lanes that differ only in the mesh: the cavity is filled in some of them.
    bodies[0] = Body(bodies[0].meshes, np.arange(lanes) % 2, bodies[0].poses)
    np.testing.assert_array_equal(collide(bodies, None, lanes).free, expected & (np.arange(lanes) % 2 == 0))


@pytest.mark.parametrize("most", [1, 7, 64])
def test_how_much_is_looked_at_together_does_not_matter(most, monkeypatch):
    bodies = crowd(9, 6)
    pairs = [(i, j) for i, j in itertools.combinations(range(9), 2) if i % 4 or j % 4]
    expected = collide(bodies, pairs, LANES, exhaustive=True).pairs
    for name in ("_CHUNK", "_BOXES", "_MOST_ENTRIES", "_STEP", "_FEW"):
        monkeypatch.setattr(collision, name, most)
    np.testing.assert_array_equal(collide(bodies, pairs, LANES, exhaustive=True).pairs, expected)
    np.testing.assert_array_equal(collide(bodies, pairs, LANES).free, ~expected.any(axis=1))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("part", ["position", "size", "orientation"])
@pytest.mark.parametrize("moving", [2, 4])
def test_lanes_without_a_place_collide_with_nothing_and_disturb_no_other(bad, part, moving):
    """What could not be computed in a lane is not a number there."""
    lanes = 16
    bodies = [differing(PROPERTIES[:3], seed, lanes=lanes) for seed in range(140, 140 + moving)]
    bodies += [Body((table(),), None, yawed((0, 0, 0)), is_fixed=True)]
    usual = collide(bodies, None, lanes, exhaustive=True).pairs
    poses = bodies[0].poses
    rows = {name: np.array(getattr(poses, name)) for name in PROPERTIES[:3]}
    broken = np.arange(lanes) % 3 == 0
    rows[part][broken, 1] = bad
    with np.errstate(all="ignore"):
        others = [replace(bodies[0], poses=Poses(**rows)), *bodies[1:]]
        found = collide(others, None, lanes, exhaustive=True)
        free = collide(others, None, lanes).free
    mine = np.array([0 in pair for pair in itertools.combinations(range(len(bodies)), 2)])
    np.testing.assert_array_equal(found.pairs[~broken], usual[~broken])
    np.testing.assert_array_equal(found.pairs[:, ~mine], usual[:, ~mine])
    if np.isnan(bad) and part == "position":
        assert not found.pairs[broken][:, mine].any()
    np.testing.assert_array_equal(free[~broken], ~usual[~broken].any(axis=1))


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("size", [(1, 1, 1), (1, 2, 3), (0.2, 0.2, 1)])
def test_corners_that_point_along_an_axis_meet_there(axis, size):
    """Bodies, long or not, of an orientation for each lane, that reach as far as half their diagonal."""
    lanes, half = 5, np.array(size) / 2
    reach = np.linalg.norm(half)
    diagonal, _ = Rotation.align_vectors([np.eye(3)[axis]], [half])
    turns = (diagonal * Rotation.from_rotvec(np.linspace(0, 2, lanes)[:, None] * half / reach)).as_quat()
    for gap in (-0.02, 0.02):
        away = (2 * reach + gap) * np.eye(3)[axis]
        cast = [
            Body((primitives.box(),), None, Poses(np.array([place]), turns, np.array([size], dtype=float)))
            for place in (np.zeros(3), away, np.full(3, 50.0))
        ]
        found = collide(cast, None, lanes, exhaustive=True).pairs
        assert found[:, 0].tolist() == [gap < 0] * lanes
        assert not found[:, 1:].any()
