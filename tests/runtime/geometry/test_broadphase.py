import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.contact import broadphase
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.poses import Poses

from .samples import common_volume, in_batches, random_poses, world_vertices, yawed

BOX = primitives.box()


def separable(points_a, points_b) -> bool:
    """Whether a plane separates two point sets by a margin: linear programming, no axes."""
    rows = np.concatenate([np.c_[points_a, -np.ones(8)], np.c_[-points_b, np.ones(8)]])
    result = linprog(np.zeros(4), A_ub=rows, b_ub=-np.ones(16), bounds=[(None, None)] * 4)
    return result.status == 0


@settings(max_examples=150)
@given(st.integers(0, 10**6))
def test_boxes_against_separating_planes(seed):
    a, b = random_poses(1, seed, spread=0.6), random_poses(1, seed + 1, spread=0.6)
    found = broadphase.boxes_overlap(a, b)[0]
    assert found != separable(world_vertices(BOX, a, 0), world_vertices(BOX, b, 0))


def test_boxes_against_booleans():
    a, b = random_poses(400, 1), random_poses(400, 2)
    found = broadphase.boxes_overlap(a, b)
    volumes = np.array([common_volume(BOX, a, BOX, b, entry) for entry in range(400)])
    assert 0.1 < found.mean() < 0.9
    assert found[volumes > 0].all()
    assert (volumes[~found] == 0).all()


@pytest.mark.parametrize("yaw", [0.0, 0.3, np.pi / 2])
def test_touching_boxes_overlap_and_parallel_edges_do_not_separate(yaw):
    axis = np.array([-np.sin(yaw), np.cos(yaw), 0])
    still = yawed((0, 0, 0), yaw)
    for offset, expected in ((0.9999999, True), (1.0000001, False)):
        assert broadphase.boxes_overlap(still, yawed(offset * axis, yaw))[0] == expected
        assert broadphase.boxes_overlap(still, yawed((0, 0, offset), yaw + 0.7))[0] == expected
    assert broadphase.boxes_overlap(yawed((0, 0, 0)), yawed((0, 0, 1)))[0]


@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_do_not_matter(batch):
    a, b = random_poses(700, 3), random_poses(700, 4)
    whole = broadphase.boxes_overlap(a, b)
    parts = in_batches(lambda i: broadphase.boxes_overlap(a.take(i), b.take(i)), 700, batch)
    np.testing.assert_array_equal(parts, whole)
    strided = np.arange(0, 700, 3)
    np.testing.assert_array_equal(broadphase.boxes_overlap(a.take(strided), b.take(strided)), whole[::3])


def test_fixed_poses_broadcast():
    a, b = random_poses(50, 5), random_poses(1, 6, same_size=True)
    repeated = Poses(*(np.repeat(part, 50, axis=0) for part in (b.position, b.orientation, b.size)))
    np.testing.assert_array_equal(broadphase.boxes_overlap(a, b), broadphase.boxes_overlap(a, repeated))


def cells_of(lower, upper):
    """The cells of corners ``(bodies, lanes, 3)``, padded to whole words of lanes."""
    shape = (3, lower.shape[0], -(-lower.shape[1] // 8) * 8)
    low, high = np.full(shape, 255, dtype=np.uint8), np.zeros(shape, dtype=np.uint8)
    cells = broadphase.CellMap.around(lower.reshape(-1, 3))
    cells.put(lower, low[:, :, : lower.shape[1]])
    cells.put(upper, high[:, :, : lower.shape[1]])
    return low, high


@pytest.mark.parametrize("swept", [broadphase._SWEPT, 0])
@pytest.mark.parametrize(
    ("bodies", "moving", "lanes"),
    [(2, 2, 5), (2, 1, 8), (20, 20, 5), (65, 30, 3), (150, 150, 300), (420, 410, 2), (420, 5, 2)],
)
def test_near_pairs_hold_all_overlapping_boxes(bodies, moving, lanes, swept, monkeypatch):
    monkeypatch.setattr(broadphase, "_SWEPT", swept)
    rng = np.random.default_rng(bodies)
    spread = 3 * bodies ** (1 / 3)
    lower = rng.uniform(-spread, spread, (bodies, lanes, 3))
    upper = lower + rng.uniform(0, 1.5, lower.shape)
    upper[0] += 10 * spread  # one body is as large as the world
    if bodies > 2:
        lower[-2] -= 10 * spread  # and one that may be fixed begins before all others
    lower[-1, 0], upper[-1, 0] = np.inf, np.inf
    lower[-1, 1], upper[-1, 1] = np.nan, np.nan
    found = [np.stack(group, axis=1) for group in broadphase.near_pairs(*cells_of(lower, upper), moving)]
    rows = np.concatenate(found)
    assert len(np.unique(rows, axis=0)) == len(rows)
    assert (rows[:, 0] < rows[:, 1]).all()
    assert (rows[:, 0] < moving).all()
    assert (rows[:, 2] < lanes).all()
    near = np.zeros((bodies, bodies, lanes), dtype=bool)
    near[tuple(rows.T)] = True
    overlap = ((lower[:, None] <= upper[None]) & (lower[None] <= upper[:, None])).all(axis=-1)
    overlap &= np.triu(np.ones((bodies, bodies), dtype=bool), 1)[..., None]
    overlap[moving:] = False
    assert near[overlap].all()
    assert near.sum() < 4 * overlap.sum() + 50 * lanes


def test_boxes_turned_alike_are_apart_only_along_their_faces():
    """By a quarter turn, too: what rounding leaves of the cross products of parallel edges separates nothing."""
    rng, count = np.random.default_rng(5), 2000
    a = random_poses(count, 6)
    turn = Rotation.from_quat(a.orientation)
    quarter = (turn * Rotation.from_euler("z", np.pi / 2)).as_quat()
    for shift in (1e-4, -1e-4):
        # Along one of the axes, in or out by a little; along the others a part of the way.
        way = a.size * rng.uniform(-0.99, 0.99, (count, 3))
        axis = rng.integers(0, 3, count)
        way[np.arange(count), axis] = a.size[np.arange(count), axis] - shift
        place = a.position + turn.apply(way)
        for b in (Poses(place, a.orientation, a.size), Poses(place, quarter, a.size[:, [1, 0, 2]])):
            np.testing.assert_array_equal(broadphase.boxes_overlap(a, b), shift > 0)


def test_boxes_may_be_apart_along_any_pair_of_edges():
    """An edge of the one passes over an edge of the other: only the direction across both tells that they are apart."""
    rng = np.random.default_rng(7)
    for first, second in itertools.product(range(3), repeat=2):
        count = 200
        turns = [Rotation.random(count, rng) for _ in range(2)]
        sizes = rng.uniform(0.3, 2.0, (2, count, 3))
        axes = [turn.as_matrix() for turn in turns]
        across = np.cross(axes[0][:, :, first], axes[1][:, :, second])
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        # The edges nearest to the other box, and a point within each.
        ends = []
        for axis, size, number, side in zip(axes, sizes, (first, second), (1, -1), strict=True):
            corner = np.sign(side * np.einsum("nij,ni->nj", axis, across)) * size / 2
            corner[:, number] = rng.uniform(-0.45, 0.45, count) * size[:, number]
            ends.append(np.einsum("nij,nj->ni", axis, corner))
        for gap in (1e-6, -1e-6):
            a = Poses(np.zeros((1, 3)), turns[0].as_quat(), sizes[0])
            b = Poses(ends[0] - ends[1] + gap * across, turns[1].as_quat(), sizes[1])
            np.testing.assert_array_equal(broadphase.boxes_overlap(a, b), gap < 0)
            np.testing.assert_array_equal(broadphase.boxes_overlap(b, a), gap < 0)


@pytest.mark.parametrize("fixed", [None, 0, 1])
def test_how_many_boxes_are_looked_at_together_does_not_matter(fixed, monkeypatch):
    """Also where one of them is the same everywhere."""
    a, b = random_poses(700, 3), random_poses(700, 4)
    if fixed == 0:
        a = random_poses(1, 3, same_size=True)
    elif fixed == 1:
        b = random_poses(1, 4, same_size=True)
    whole = broadphase.boxes_overlap(a, b)
    assert 0 < whole.sum() < 700
    for chunk in (699, 700, 100, 33):
        monkeypatch.setattr(broadphase, "_CHUNK", chunk)
        np.testing.assert_array_equal(broadphase.boxes_overlap(a, b), whole)
