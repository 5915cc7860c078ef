"""Poses in which thrown solids come to rest."""

from collections import defaultdict
from collections.abc import Iterable

import numpy as np
import pytest
import trimesh

from scenic.runtime.geometry.meshes import primitives, stable_poses
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.stable_poses import ellipsoid_footing, hull_footing, resting_poses


def by_direction(normals: Iterable[np.ndarray], shares: Iterable[float]) -> dict[tuple[float, ...], float]:
    """The probabilities of downward directions, rounded."""
    sums: dict[tuple[float, ...], float] = defaultdict(float)
    for normal, share in zip(normals, shares, strict=True):
        sums[tuple(np.round(normal, 2) + 0.0)] += share
    return sums


def distance_from_trimesh(number: int) -> float:
    """Half the sum of differences between the shares that trimesh computes and ours, for the stretched hull of random points."""
    rng = np.random.default_rng(number)
    hull = trimesh.convex.convex_hull(rng.normal(size=(rng.integers(4, 30), 3)))
    mesh, _, _ = Mesh(hull.vertices, hull.faces).normalized()
    size = np.array([1.0, *rng.uniform(0.5, 2, 2)])
    matrices, theirs = trimesh.poses.compute_stable_poses(
        trimesh.Trimesh(mesh.vertices * size, mesh.faces, process=False)
    )
    footing = mesh.derived(hull_footing)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stable_poses, "_FIRM", -np.pi)  # trimesh keeps poses that are not firm
        ours = footing.shares(size[np.newaxis])[0]
    stands = ours > 1e-9
    down = footing.normals[stands] / size
    down /= np.linalg.norm(down, axis=1, keepdims=True)
    one, other = by_direction(down, ours[stands]), by_direction(-matrices[:, 2, :3], theirs)
    return sum(abs(one[key] - other[key]) for key in {*one, *other}) / 2


def test_shares_are_those_of_the_toppling_graph() -> None:
    """A face from which a solid may roll over two edges is the only cause of differences: trimesh takes the one below its middle."""
    differences = np.array([distance_from_trimesh(number) for number in range(30)])
    assert (differences < 1e-9).mean() > 0.7
    assert differences.max() < 0.1


def test_a_fine_side_is_rested_on_as_a_coarse_one() -> None:
    """Sides of 100 faces, each of which a tilt of 2 degrees ends, lead to each other, and keep the share of the whole side."""
    size = np.array([[1.0, 1.0, 2.0]])
    shares = []
    for sections in (24, 100):
        footing = primitives.cylinder(sections).derived(hull_footing)
        shares.append(footing.shares(size)[0][np.abs(footing.normals[:, 2]) < 0.5])
    assert shares[1].sum() == pytest.approx(shares[0].sum(), rel=0.01)
    assert shares[1] == pytest.approx(shares[1].mean())


def test_a_weak_pose_counts_for_the_one_to_which_it_leads() -> None:
    """A board can stand on its rims, which lean a little, but a push lets it fall to the side to which they lean."""
    points = [
        (x * half, y * half, z) for half, z in ((1, -0.02), (0.9993, 0.02)) for x in (-1, 1) for y in (-1, 1)
    ]
    hull = trimesh.convex.convex_hull(np.array(points) * (0.5, 0.5, 1))
    mesh, _, size = Mesh(hull.vertices, hull.faces).normalized()
    footing = mesh.derived(hull_footing)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stable_poses, "_FIRM", -np.pi)
        unpushed = footing.shares(size[np.newaxis])[0]
    shares = footing.shares(size[np.newaxis])[0]
    rims = np.abs(footing.normals[:, 2]) < 0.5
    assert np.count_nonzero(unpushed[rims]) == 4
    assert np.count_nonzero(shares[~rims]) == np.count_nonzero(shares) == 2
    gained = shares[~rims] - unpushed[~rims]
    assert sorted(gained) == pytest.approx([0, unpushed[rims].sum()])


def test_sizes_together_and_alone_agree_in_every_bit() -> None:
    rng = np.random.default_rng(1)
    sizes, draws = rng.uniform(0.5, 2, (40, 3)), rng.random(40)
    footing = primitives.cylinder().derived(hull_footing)
    together = resting_poses(footing, sizes, draws)
    alone = [resting_poses(footing, sizes[i : i + 1], draws[i : i + 1]) for i in range(40)]
    assert (together == np.concatenate(alone, axis=1)).all()


@pytest.mark.parametrize(
    ("size", "count"), [((1, 1.2, 0.8), 2), ((1, 1.2, 1.2), 2), ((1, 1.2, 1), 40), ((1, 1, 1), 642)]
)
def test_an_ellipsoid_rests_on_its_shortest_axes(size: tuple[float, float, float], count: int) -> None:
    footing = primitives.spheroid().derived(ellipsoid_footing)
    shares = footing.shares(np.array([size]))[0]
    assert np.count_nonzero(shares) == pytest.approx(count, abs=0 if count in (2, 642) else 16)
    draws = np.random.default_rng(0).random(50)
    poses = resting_poses(footing, np.tile(size, (50, 1)), draws)
    assert poses[2] == pytest.approx(min(size) / 2)
