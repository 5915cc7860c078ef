"""Collision and containment of random pairs of meshes against the volumes that exact Booleans leave.

The meshes are those of the examples, primitives, solids with cavities and legs, and the files that ``SCENIC_TEST_MESHES``
names. Pairs lie apart, near contact, through and in each other. Tests compare some; ``python -m
tests.runtime.geometry.test_against_booleans`` compares hundreds.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from scenic.runtime.geometry.contact.narrowphase import Solids
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses
from tests.amounts import amount

from .samples import FILES, SHAPES, placed, random_poses, solid, unit_mesh

EXAMPLES = Path(__file__).parents[3] / "examples" / "meshes"
CONTACT = 1e-6
"""Metres within which surfaces may count as touching or not."""
SURE = 1e-9
"""Cubic metres above which a common volume is more than contact."""
ROUNDING = 1e-12
"""Part of a volume that rounding may leave of nothing."""


@cache
def meshes() -> tuple[Mesh, ...]:
    files = [*sorted(EXAMPLES.glob("*.obj")), *FILES]
    return (*(make() for make in SHAPES.values()), *map(unit_mesh, files))


def pairs(count: int, seed: int) -> tuple[np.ndarray, Poses, np.ndarray, Poses]:
    """Pairs of meshes by number; a third each of like size, small in large, and moved along a line until they nearly touch."""
    rng = np.random.default_rng(seed)
    first, second = rng.integers(0, len(meshes()), (2, count))
    a = random_poses(count, seed + 1, spread=0.4, sizes=(0.5, 1.5))
    b = random_poses(count, seed + 2, spread=0.4, sizes=(0.5, 1.5))
    small = np.arange(count) % 3 == 1
    size, position = b.size.copy(), b.position.copy()
    size[small] *= rng.uniform(0.05, 0.3, (int(small.sum()), 1))
    position[small] = a.position[small] + rng.normal(scale=0.12, size=(int(small.sum()), 3))
    b = Poses(position, b.orientation, size)
    for entry in np.flatnonzero(np.arange(count) % 3 == 2):
        position[entry] = contact(first[entry], a, second[entry], b, int(entry), rng)
    return first, a, second, Poses(position, b.orientation, size)


def contact(first: int, a: Poses, second: int, b: Poses, entry: int, rng: np.random.Generator) -> np.ndarray:
    """A place for the second body a little before or behind its first contact on the way to the first one."""
    still, moving = solid(meshes()[first], a, entry), solid(meshes()[second], b, entry)
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    start = a.position[entry] - b.position[entry]
    near, far = 0.0, 4.0
    for _ in range(18):
        middle = (near + far) / 2
        apart = still.min_gap(moving.translate(start + middle * way), 0.01) > 0
        near, far = (near, middle) if apart else (middle, far)
    return b.position[entry] + start + (far + rng.choice([-1, 1]) * 10 ** rng.uniform(-5, -2)) * way


def compare(count: int, seed: int) -> dict[str, int]:
    """Compare all pairs; returns how many of each kind there were."""
    first, a, second, b = pairs(count, seed)
    met = Solids(meshes(), patience=0).intersect(first, a, second, b)
    held = containment.in_body(Body(meshes(), second, b), Body(meshes(), first, a), count)
    seen = {"meet": 0, "apart": 0, "held": 0, "not held": 0, "contact": 0}
    for entry in range(count):
        one, two = solid(meshes()[first[entry]], a, entry), solid(meshes()[second[entry]], b, entry)
        common = (one ^ two).volume()
        if met[entry] != (common > 0):
            seen["contact"] += 1
            assert common <= SURE, f"pair {entry}: {common} m3 in common"
            assert one.min_gap(two, 0.1) < CONTACT, f"pair {entry}: apart"
        outside = (two - one).volume()
        if held[entry] != (outside <= ROUNDING * two.volume()):
            seen["contact"] += 1
            assert outside <= SURE, f"pair {entry}: {outside} m3 outside"
            # The rest of space within reach: what is wholly inside keeps a distance from it.
            assert (around(one) - one).min_gap(two, 0.1) < CONTACT, f"pair {entry}: inside"
        seen["meet" if met[entry] else "apart"] += 1
        seen["held" if held[entry] else "not held"] += 1
    return seen


def around(body):
    """A box some way around a solid."""
    low_x, low_y, low_z, high_x, high_y, high_z = body.bounding_box()
    low, high = np.array([low_x, low_y, low_z]) - 1, np.array([high_x, high_y, high_z]) + 1
    box = placed(SHAPES["box"](), (low + high) / 2, high - low)
    return solid(box, Poses.fixed((0, 0, 0)), 0)


@pytest.mark.slow
def test_pairs_of_all_kinds() -> None:
    seen = compare(amount(60, 120), 1)
    assert min(seen["meet"], seen["apart"], seen["held"], seen["not held"]) >= amount(3, 5)


if __name__ == "__main__":
    total = [compare(100, seed) for seed in range(10, 60, 10)]
    print({name: sum(seen[name] for seen in total) for name in total[0]})
