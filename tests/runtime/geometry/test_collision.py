import itertools

import numpy as np
import pytest

from scenic.runtime.geometry import primitives
from scenic.runtime.geometry.bodies import Body
from scenic.runtime.geometry.collision import collide
from scenic.runtime.geometry.narrowphase import meshes_intersect
from scenic.runtime.geometry.poses import Poses

from .samples import SHAPES, random_poses, table, yawed

LANES = 60
MESHES = [SHAPES[name]() for name in ("box", "table", "cylinder", "spheroid", "hollow")]


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
            poses = random_poses(
                lanes, seed + number, spread=spread, sizes=(0.2, 0.8), constant_size=kind == 1
            )
        mesh = MESHES[rng.integers(len(MESHES))]
        if kind == 3:
            result.append(Body((mesh, table()), rng.integers(0, 2, lanes), poses, rng.random(lanes) < 0.2))
        else:
            result.append(Body((mesh,), None, poses))
    return result


def lane_poses(body: Body, lane: int) -> Poses:
    parts = (body.poses.position, body.poses.orientation, body.poses.size)
    rows = [part[lane : lane + 1] if len(part) > 1 else part for part in parts]
    return Poses(*rows, body.poses.constant_size)


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
    check(crowd(66, 3, lanes=2), list(itertools.combinations(range(66), 2)), 2)


def test_fixed_pairs_decide_all_lanes():
    box = primitives.box()
    bodies = [Body((box,), None, yawed(p)) for p in ((0, 0, 0), (0.5, 0.5, 0.5), (5, 0, 0))]
    assert not collide(bodies, [(0, 1), (0, 2)], 10).free.any()
    assert collide(bodies, [(0, 2), (1, 2)], 10).free.all()
    every = collide(bodies, [(0, 1), (0, 2)], 10, exhaustive=True)
    np.testing.assert_array_equal(every.pairs, [[True, False]] * 10)
    tolerant = Body((box,), None, yawed((0, 0, 0)), np.array([True]))
    assert collide([tolerant, *bodies[1:]], [(0, 1)], 10).free.all()


def test_no_pairs():
    assert collide([], [], 4).free.all()
    assert collide(crowd(3, 4), np.empty((0, 2)), LANES).free.all()


@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_do_not_matter(batch):
    lanes = 540
    bodies = crowd(8, 5, lanes)
    pairs = [(i, j) for i, j in itertools.combinations(range(8), 2) if i % 4 or j % 4]
    whole = collide(bodies, pairs, lanes, exhaustive=True)
    for start in range(0, lanes, batch):
        part = slice(start, min(start + batch, lanes))
        some = [
            Body(
                body.meshes,
                body.choice if body.choice is None else body.choice[part],
                body.poses.take(np.arange(part.start, part.stop)),
                body.allow if len(body.allow) == 1 else body.allow[part],
            )
            for body in bodies
        ]
        found = collide(some, pairs, part.stop - part.start, exhaustive=True)
        np.testing.assert_array_equal(found.pairs, whole.pairs[part])
