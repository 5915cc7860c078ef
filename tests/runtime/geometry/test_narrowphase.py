import itertools

import numpy as np
import pytest

from scenic.graph import quaternions
from scenic.runtime.geometry import narrowphase, primitives
from scenic.runtime.geometry.affine import relative_map
from scenic.runtime.geometry.fcl import SizedSurfaces, Surface
from scenic.runtime.geometry.narrowphase import meshes_intersect
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.proofs import ProofTable

from .samples import (
    FILES,
    SHAPES,
    bumpy,
    common_volume,
    gap,
    hollow,
    in_batches,
    random_poses,
    real_meshes,
    table,
    unit_mesh,
    yawed,
)

PAIRS = list(itertools.combinations_with_replacement(SHAPES, 2))


def check(mesh_a, poses_a, mesh_b, poses_b, count):
    """Collisions against exact Booleans; touching within rounding may go either way."""
    found = meshes_intersect(mesh_a, poses_a, mesh_b, poses_b)
    for entry in range(count):
        volume = common_volume(mesh_a, poses_a, mesh_b, poses_b, entry)
        if volume > 1e-9:
            assert found[entry], entry
        elif volume == 0 and found[entry]:
            assert gap(mesh_a, poses_a, mesh_b, poses_b, entry) < 1e-6, entry
    return found


@pytest.mark.parametrize("constant_size", [False, True])
@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_against_booleans(first, second, constant_size):
    seed = PAIRS.index((first, second))
    a = random_poses(24, seed, spread=0.6, constant_size=constant_size)
    b = random_poses(24, seed + 100, spread=0.6, constant_size=constant_size)
    check(SHAPES[first](), a, SHAPES[second](), b, 24)


@real_meshes
@pytest.mark.parametrize("constant_size", [False, True])
def test_real_meshes_against_booleans(constant_size):
    seen = []
    for number, (first, second) in enumerate(list(itertools.combinations(FILES, 2))[::4]):
        a = random_poses(4, number, spread=0.5, constant_size=constant_size)
        b = random_poses(4, number + 100, spread=0.5, constant_size=constant_size)
        seen.extend(check(unit_mesh(first), a, unit_mesh(second), b, 4))
    assert 0.1 < np.mean(seen) < 0.9


@pytest.mark.slow
@pytest.mark.parametrize("constant_size", [False, True])
def test_large_meshes_are_indexed_in_part(constant_size):
    large = bumpy(6)
    assert len(large.faces) > narrowphase._MANY_FACES
    a = random_poses(30, 15, spread=0.5, sizes=(0.8, 1.5), constant_size=constant_size)
    b = random_poses(30, 16, spread=0.5, sizes=(0.1, 0.6), constant_size=constant_size)
    check(large, a, table(), b, 30)
    found = narrowphase.surfaces_touch(large, a, table(), b)
    whole = SizedSurfaces(large).at(np.ones(3))
    maps = relative_map(b, a)
    for entry in range(30):
        other = Surface(maps.of_entry(entry, table().vertices), table().faces)
        assert found[entry] == whole.touches(other)
    assert 0 < found.mean() < 1


def test_a_stool_under_a_table():
    """Boxes overlap, meshes do not: between the legs, and no longer when it touches one."""
    at = yawed((0, 0, 0.5), size=(1, 1, 1))
    stool = primitives.cylinder()
    for x, expected in ((0.0, False), (0.17, False), (0.2, True), (0.75, False), (0.6, True)):
        seat = yawed((x, 0.2, 0.3), size=(0.35, 0.35, 0.6))
        # Legs stand at 0.35 to 0.45 on both sides; a seat at 0.2 reaches 0.375 between y 0.025 and 0.375.
        touching = meshes_intersect(table(), at, stool, seat)[0]
        volume = common_volume(table(), at, stool, seat, 0)
        assert touching == (volume > 0)
        if x in (0.0, 0.75):
            assert touching == expected


def test_nested_bodies_collide_but_not_in_a_cavity():
    outer, inner = yawed((1, 2, 3), 0.4, (2, 2, 2)), yawed((1, 2, 3), 1.0, (0.2, 0.2, 0.2))
    spheroid = primitives.spheroid()
    for constant in (True, False):
        a, b = (Poses(pose.position, pose.orientation, pose.size, constant) for pose in (outer, inner))
        for solid in (primitives.box(), primitives.cylinder(), spheroid):
            assert meshes_intersect(solid, a, spheroid, b)[0]
            assert meshes_intersect(spheroid, b, solid, a)[0]
        assert not meshes_intersect(hollow(), a, spheroid, b)[0]
        assert not meshes_intersect(spheroid, b, hollow(), a)[0]


def test_a_body_around_one_part_of_another():
    """Only the inner wall of the hollow box is surrounded, so a vertex of each surface has to be tried."""
    a = yawed((0, 0, 0), size=(1, 1, 1))
    for size in (0.6, 0.9):
        filler = yawed((0, 0, 0), size=(size, size, size))
        assert narrowphase.solids_touch(hollow(), a, primitives.cylinder(), filler)[0]
        assert narrowphase.solids_touch(primitives.cylinder(), filler, hollow(), a)[0]


def test_steps_agree_with_the_exact_test():
    """What the quick tests prove is what FCL and parity say."""
    proved = 0
    for first, second in PAIRS:
        a, b = random_poses(60, 7, spread=0.8), random_poses(60, 8, spread=0.8)
        meshes = [SHAPES[first](), SHAPES[second]()]
        zeros = np.zeros(60, dtype=np.intp)
        together, left = narrowphase.quick_tests(ProofTable(meshes), zeros, a, zeros + 1, b)
        exact = narrowphase.solids_touch(meshes[0], a, meshes[1], b)
        np.testing.assert_array_equal(together[~left], exact[~left])
        proved += int((~left).sum())
    assert proved > 0.6 * 60 * len(PAIRS)


@pytest.mark.parametrize("constant_size", [False, True])
@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_do_not_matter(batch, constant_size):
    count = 520
    a = random_poses(count, 9, spread=0.6, constant_size=constant_size)
    b = random_poses(count, 10, spread=0.6, constant_size=constant_size)
    mesh_a, mesh_b = table(), primitives.cone()
    whole = meshes_intersect(mesh_a, a, mesh_b, b)
    parts = in_batches(lambda i: meshes_intersect(mesh_a, a.take(i), mesh_b, b.take(i)), count, batch)
    np.testing.assert_array_equal(parts, whole)


def test_relative_maps():
    a, b = random_poses(30, 11), random_poses(30, 12)
    points = np.random.default_rng(13).normal(size=(5, 3))
    x, y, z = relative_map(a, b).columns(tuple(points[:, i, None] for i in range(3)))
    world = a.to_world(np.broadcast_to(points, (30, 5, 3)))
    np.testing.assert_allclose(np.stack([x.T, y.T, z.T], axis=-1), b.to_unit(world), atol=1e-12)


def test_resting_gap():
    """An object placed on another rests 5e-5 above it, which must not be a collision."""
    rng = np.random.default_rng(14)
    yaw = rng.uniform(-3, 3, 64)
    size = rng.uniform(0.1, 2, (64, 3))
    plate = Poses.fixed((0, 0, 1.0), size=(4, 4, 2))
    for mesh in (primitives.cylinder(), table(), primitives.spheroid()):
        for shift, expected in ((5e-5, False), (-5e-5, True)):
            position = np.c_[rng.uniform(-1, 1, (64, 2)), 2 + size[:, 2] / 2 + shift]
            poses = Poses(position, quaternions.from_euler(yaw, 0, 0), size)
            assert (meshes_intersect(table(), plate, mesh, poses) == expected).all()
