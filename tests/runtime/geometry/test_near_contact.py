"""Collision and containment against exact Booleans, on pairs placed near contact.

SCENIC_TEST_PAIRS sets their number (2,000 take some five minutes).
"""

import os

import numpy as np
import pytest

from scenic.runtime.geometry.contact.narrowphase import Solids
from scenic.runtime.geometry.containment.body_containment import TOLERANCE, in_body
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.voxels import voxels
from scenic.runtime.geometry.poses import Poses
from tests.amounts import amount

from .samples import FILES, SHAPES, common_volume, random_poses, solid, unit_mesh

PAIRS = int(os.environ.get("SCENIC_TEST_PAIRS", amount(30, 60)))
CONTACT = 1e-6
"""Metres of gap within which either answer is right."""


def meshes() -> list[Mesh]:
    real = [unit_mesh(path) for path in FILES]
    return [*(SHAPES[name]() for name in SHAPES), *(mesh for mesh in real if len(mesh.faces) < 10_000)]


def shifted(poses: Poses, entry: int, offset: np.ndarray) -> Poses:
    one = poses.take(np.array([entry]))
    return Poses(one.position + offset, one.orientation, one.size)


def bisected(apart, near: float, far: float, steps: int) -> float:
    """Where ``apart`` changes from false (near) to true (far), to the given number of halvings."""
    for _ in range(steps):
        middle = (near + far) / 2
        near, far = (near, middle) if apart(middle) else (middle, far)
    return (near + far) / 2


@pytest.mark.slow
def test_collisions_near_contact():
    rng = np.random.default_rng(1)
    table = meshes()
    solids = Solids(table, patience=0)
    numbers = rng.integers(0, len(table), (2, PAIRS))
    a = random_poses(PAIRS, 2, spread=0.1, sizes=(0.3, 1.5))
    b = random_poses(PAIRS, 3, spread=0.1, sizes=(0.3, 1.5))
    directions = rng.normal(size=(PAIRS, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    offsets = np.zeros((PAIRS, 3))
    for entry in range(PAIRS):
        one, two = (table[numbers[side, entry]] for side in (0, 1))

        def apart(travel, entry=entry, one=one, two=two):
            moved = shifted(b, entry, travel * directions[entry])
            return common_volume(one, a.take(np.array([entry])), two, moved, 0) == 0

        contact = bisected(apart, 0.0, 4.0, 11)
        offsets[entry] = (contact + rng.choice([-1e-2, -1e-3, 0, 1e-3, 1e-2])) * directions[entry]
    moved = Poses(b.position + offsets, b.orientation, b.size)
    found = solids.intersect(numbers[0], a, numbers[1], moved)
    assert 0.2 < found.mean() < 0.8
    wrong = 0
    for entry in range(PAIRS):
        one, two = (table[numbers[side, entry]] for side in (0, 1))
        volume = common_volume(one, a, two, moved, entry)
        if found[entry] and volume == 0:
            wrong += solid(one, a, entry).min_gap(solid(two, moved, entry), 0.1) > CONTACT
        elif not found[entry]:
            # A sliver of volume up to the contact tolerance deep.
            wrong += volume > CONTACT
    assert wrong == 0


@pytest.mark.slow
def test_containment_near_contact():
    rng = np.random.default_rng(4)
    table = meshes()
    count = PAIRS // 2
    found, truth, margins = [], [], []
    for entry in range(count):
        outer, inner = (table[number] for number in rng.integers(0, len(table), 2))
        box = Poses.fixed(rng.normal(size=3), random_poses(1, entry).orientation[0], rng.uniform(1, 2, 3))
        # A small body near a deep point of the container, moved until it comes out.
        start = box.to_world(outer_deep(outer)[None])[0]
        turn, size = random_poses(1, 1000 + entry).orientation[0], rng.uniform(0.02, 0.1, 3)
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)

        def outside(
            travel, box=box, outer=outer, inner=inner, start=start, turn=turn, size=size, way=direction
        ):
            placed = Poses.fixed(start + travel * way, turn, size)
            rest = solid(inner, placed, 0) - solid(outer, box, 0)
            return rest.volume() > 0

        if outside(0.0):
            continue
        border = bisected(outside, 0.0, 4.0, 11)
        for shift in (-1e-2, -1e-3, 1e-3, 1e-2):
            placed = Poses.fixed(start + (border + shift) * direction, turn, size)
            bodies = Body((inner,), None, placed), Body((outer,), None, box)
            found.append(bool(in_body(*bodies, 1)[0]))
            left = (solid(inner, placed, 0) - solid(outer, box, 0)).volume()
            truth.append(left == 0)
            margins.append(left)
    found, truth, margins = (np.array(part) for part in (found, truth, margins))
    assert 0.2 < truth.mean() < 0.8
    assert found[truth].all()
    # What is taken for contained oversteps by the tolerance at most.
    assert (margins[found & ~truth] < 0.1 * TOLERANCE).all()


def outer_deep(mesh: Mesh) -> np.ndarray:
    return mesh.derived(voxels).probes[0]
