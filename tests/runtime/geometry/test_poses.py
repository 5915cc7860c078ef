import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.runtime.geometry.affine import relative_map
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses

from .samples import SHAPES, random_poses, table, world_vertices


@given(st.integers(0, 10**6))
def test_to_world_and_back(seed):
    poses = random_poses(5, seed)
    points = np.broadcast_to(table().vertices, (5, *table().vertices.shape))
    world = poses.to_world(points)
    for entry in range(5):
        np.testing.assert_allclose(world[entry], world_vertices(table(), poses, entry), atol=1e-12)
    np.testing.assert_allclose(poses.to_unit(world), points, atol=1e-12)


def test_bounds_hold_the_oriented_boxes_tightly():
    poses = random_poses(50, 1)
    lower, upper = poses.bounds()
    for entry in range(50):
        corners = world_vertices(SHAPES["box"](), poses, entry)
        np.testing.assert_allclose(lower[entry], corners.min(axis=0), atol=1e-12)
        np.testing.assert_allclose(upper[entry], corners.max(axis=0), atol=1e-12)


def test_take_keeps_what_is_the_same_everywhere():
    poses = random_poses(6, 2, same_size=True)
    assert poses.matrix.shape == (6, 3, 3)
    some = poses.take(np.array([4, 1]))
    assert (len(some), len(some.size)) == (2, 1)
    np.testing.assert_array_equal(some.position, poses.position[[4, 1]])
    np.testing.assert_array_equal(some.matrix, poses.matrix[[4, 1]])
    assert len(poses.take(np.zeros(0, dtype=int))) == 0


def test_shapes_are_checked():
    with pytest.raises(ValueError, match="poses of shapes"):
        Poses(np.zeros((2, 3)), np.zeros((3, 4)), np.ones((1, 3)))
    with pytest.raises(ValueError, match="poses of shapes"):
        Poses(np.zeros((2, 3)), np.zeros((2, 3)), np.ones((1, 3)))


def test_affine_maps():
    a, b = random_poses(7, 3), random_poses(7, 4)
    maps = relative_map(a, b)
    points = np.random.default_rng(5).normal(size=(4, 3))
    expected = b.to_unit(a.to_world(np.broadcast_to(points, (7, 4, 3))))
    images = maps.columns(points.T[:, :, None])
    np.testing.assert_allclose(images.transpose(2, 1, 0), expected, atol=1e-12)
    for entry in range(7):
        alone = maps.take(np.array([entry]))
        np.testing.assert_array_equal(alone.columns(points.T[:, :, None])[..., 0], images[..., entry])


PARTS = ("position", "orientation", "size")
SOME_PARTS = [names for count in range(4) for names in itertools.combinations(PARTS, count)]


def varying(names, count: int, seed: int) -> Poses:
    """Poses of which these parts alone differ from entry to entry."""
    many = random_poses(count, seed)
    return Poses(*(getattr(many, name) if name in names else getattr(many, name)[:1] for name in PARTS))


def spread(poses: Poses, count: int) -> Poses:
    return Poses(
        *(np.repeat(part, count // len(part), axis=0) for part in (getattr(poses, name) for name in PARTS))
    )


def test_affine_maps_of_poses_that_differ_in_some_parts():
    """On either side; what is the same everywhere is as if each entry had it."""
    count = 3
    for here, there in itertools.product(SOME_PARTS, repeat=2):
        a, b = varying(here, count, 3), varying(there, count, 4)
        maps = relative_map(a, b)
        entries = max(len(a), len(b))
        expected = relative_map(spread(a, entries), spread(b, entries))
        assert maps.matrix.shape == (3, 3, entries)
        assert maps.offset.shape == (3, entries)
        np.testing.assert_array_equal(maps.matrix, expected.matrix)
        np.testing.assert_array_equal(maps.offset, expected.offset)


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize("names", SOME_PARTS, ids="+".join)
@pytest.mark.parametrize("others", [(), ("choice",), ("allow",), ("choice", "allow")], ids="+".join)
def test_bodies_that_differ_in_some_parts_are_taken_lane_by_lane(names, others, known):
    """Whether or not their world boxes are known already; parts that are the same everywhere stay so."""
    meshes, choice, allow = (
        (SHAPES["box"](), table()),
        np.array([1, 0, 1, 1]),
        np.array([True, False, False, True]),
    )
    poses = varying(names, 4, 7)
    if known:
        poses.bounds()
    body = Body(
        meshes,
        choice if "choice" in others else choice[:1],
        poses,
        allow if "allow" in others else allow[:1],
    )
    assert len(body) == (4 if names or others else 1)
    lanes = np.array([3, 1])
    some = body.take(lanes)
    assert len(some) == (2 if names or others else 1)
    whole = spread(poses, 4)
    for name in PARTS:
        part = getattr(some.poses, name)
        assert len(part) == (2 if name in names else 1)
        np.testing.assert_array_equal(np.broadcast_to(part, (2, part.shape[1])), getattr(whole, name)[lanes])
    for found, expected in zip(some.poses.bounds(), whole.bounds(), strict=True):
        np.testing.assert_array_equal(np.broadcast_to(found, (2, 3)), expected[lanes])
    np.testing.assert_array_equal(np.broadcast_to(some.poses.matrix, (2, 3, 3)), whole.matrix[lanes])
    assert some.choice.tolist() == (choice[lanes] if "choice" in others else choice[:1]).tolist()
    assert some.allow.tolist() == (allow[lanes] if "allow" in others else allow[:1]).tolist()


def test_bodies_walk_over_their_meshes():
    meshes = (SHAPES["box"](), table())
    choice = np.array([1, 0, 1])
    body = Body(meshes, choice, Poses.fixed((0, 0, 0)))
    found = {mesh: lanes.tolist() for mesh, lanes in body.by_mesh(3)}
    assert found == {meshes[0]: [1], meshes[1]: [0, 2]}
    assert (len(body), body.is_fixed) == (3, False)
    single = Body(meshes, np.array([1]), Poses.fixed((0, 0, 0)))
    assert (len(single), single.is_fixed) == (1, False)
    assert [(mesh, lanes.tolist()) for mesh, lanes in single.by_mesh(2)] == [(table(), [0, 1])]


def test_taken_bodies_keep_what_was_computed_and_what_is_fixed():
    body = Body(
        (SHAPES["box"](), table()), np.array([1, 0, 1]), random_poses(3, 6), np.array([True, False, False])
    )
    lower, upper = body.poses.bounds()
    some = body.take(np.array([2, 0]))
    assert some.choice.tolist() == [1, 1]
    assert some.allow.tolist() == [False, True]
    assert some.poses.knows_bounds
    np.testing.assert_array_equal(some.poses.bounds(), (lower[[2, 0]], upper[[2, 0]]))
    np.testing.assert_array_equal(some.poses.matrix, body.poses.matrix[[2, 0]])
    alone = body.take(np.array([1]))
    assert (len(alone), alone.is_fixed) == (1, False)
    fixed = Body((table(),), None, Poses.fixed((0, 0, 0)), is_fixed=True)
    assert fixed.take(np.array([5, 7])).is_fixed
    with pytest.raises(ValueError, match="a fixed body with 3 rows"):
        Body((table(),), None, random_poses(3, 7), is_fixed=True)
