"""Visibility against casting every ray at every triangle, and its independence of batches."""

import numpy as np
import pytest

from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.views.observers import Views
from scenic.runtime.geometry.views.occluders import Occluder
from scenic.runtime.geometry.views.seen_bodies import sees_bodies
from scenic.runtime.geometry.views.seen_points import sees_points
from tests.amounts import amount
from tests.runtime.geometry.views import reference

BOX, CONE, CYLINDER = primitives.box(), primitives.cone(), primitives.cylinder(6)


def frame_mesh():
    """A picture frame: not convex, and its middle is not in it."""
    outer = primitives.box().moved(np.eye(3))
    from scenic.runtime.geometry.meshes.booleans import difference
    from scenic.runtime.geometry.meshes.mesh import Mesh

    hole = Mesh(outer.vertices * [0.7, 2.0, 0.7], outer.faces)
    made = difference(outer, [hole])
    assert made is not None
    return made.normalized()[0]


FRAME = frame_mesh()


def quaternions(rng: np.random.Generator, count: int) -> np.ndarray:
    rows = rng.normal(size=(count, 4))
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def bodies(rng: np.random.Generator, count: int, reach: float, size: tuple[float, float]) -> Body:
    meshes = (BOX, CONE, CYLINDER, FRAME)
    poses = Poses(
        rng.uniform(-reach, reach, (count, 3)), quaternions(rng, count), rng.uniform(*size, (count, 3))
    )
    return Body(meshes, rng.integers(0, 4, count), poses)


def views(rng: np.random.Generator, count: int) -> Views:
    wide = rng.random(count) < 0.3
    return Views(
        rng.uniform(-1, 1, (count, 3)),
        quaternions(rng, count),
        np.stack(
            [
                np.where(wide, 2 * np.pi, rng.uniform(0.2, 6.2, count)),
                np.where(wide, np.pi, rng.uniform(0.2, 3, count)),
            ],
            axis=-1,
        ),
        rng.uniform(2, 8, count),
        rng.uniform(0.1, 0.5, count),
        np.where(rng.random((count, 1)) < 0.5, 0, rng.integers(1, 60, (count, 2))).astype(float),
        rng.random(count) < 0.2,
    )


def scenes(seed: int, count: int) -> tuple[Views, Body, list[Occluder]]:
    rng = np.random.default_rng(seed)
    observers, target = views(rng, count), bodies(rng, count, 5, (0.2, 3))
    # Many targets lie ahead of their observers, or few would be seen.
    ahead = reference.Rotation.from_quat(observers.orientation).apply([0, 1, 0])
    position = np.where(
        rng.random((count, 1)) < 0.7,
        observers.camera + ahead * rng.uniform(1, 6, (count, 1)) + rng.normal(size=(count, 3)),
        target.poses.position,
    )
    poses = Poses(position, target.poses.orientation, target.poses.size)
    target = Body(target.meshes, target.choice, poses)
    between = 0.5 * (observers.camera + position) + rng.normal(size=(count, 3)) * 0.5
    blocker = bodies(rng, count, 1, (0.3, 3))
    blocker = Body(
        blocker.meshes, blocker.choice, Poses(between, blocker.poses.orientation, blocker.poses.size)
    )
    occluders = [Occluder(blocker, rng.random(count) < 0.8), Occluder(bodies(rng, count, 5, (0.2, 3)))]
    return observers, target, occluders


def active(occluders: list[Occluder], lane: int) -> list[Body]:
    return [item.body for item in occluders if item.active[lane if len(item.active) > 1 else 0]]


@pytest.mark.parametrize("seed", range(2))
def test_bodies_are_seen_as_when_every_ray_is_cast(seed: int) -> None:
    count = amount(24, 50)
    observers, target, occluders = scenes(seed, count)
    seen = sees_bodies(observers, target, occluders, count)
    expected = [
        reference.sees_body(observers, target, active(occluders, lane), lane) for lane in range(count)
    ]
    assert seen.tolist() == expected
    assert 0.2 < seen.mean() < 0.8


def test_points_are_seen_as_by_the_letter() -> None:
    count = amount(600, 2000)
    observers, target, occluders = scenes(9, count)
    points = target.poses.position
    seen = sees_points(observers, points, occluders, count)
    expected = [
        reference.sees_point(observers, points[lane], active(occluders, lane), lane) for lane in range(count)
    ]
    assert seen.tolist() == expected
    assert 0.1 < seen.mean() < 0.9


def seen_alone(observers: Views, target: Body, occluders: list[Occluder], lanes: np.ndarray) -> list[bool]:
    """What these lanes see as the only ones."""
    others = [
        Occluder(item.body.take(lanes), item.active if len(item.active) == 1 else item.active[lanes])
        for item in occluders
    ]
    found: list[bool] = sees_bodies(observers.take(lanes), target.take(lanes), others, len(lanes)).tolist()
    return found


def test_neither_batch_nor_company_changes_a_lane() -> None:
    count = 64
    observers, target, occluders = scenes(5, count)
    together = sees_bodies(observers, target, occluders, count)
    for step in (1, 7):
        for start in range(0, count, step):
            lanes = np.arange(start, min(start + step, count))
            assert seen_alone(observers, target, occluders, lanes) == together[lanes].tolist()


def test_thousands_of_lanes_see_as_a_few_do() -> None:
    """So many that they are looked at in parts; of all but the last ones the target is out of range."""
    count, near = 1100, 80
    observers, target, occluders = scenes(6, count)
    lanes = np.arange(count - near, count)
    observers.distance[: count - near] = 1e-3
    observers.scaling[:] = np.arange(count) % 2 == 0
    together = sees_bodies(observers, target, occluders, count)[lanes]
    assert seen_alone(observers, target, occluders, lanes) == together.tolist()
    assert 15 < together.sum() < 65


def fixed(position: tuple[float, float, float], size: tuple[float, float, float] = (1, 1, 1)) -> Body:
    return Body((BOX,), None, Poses.fixed(position, size=size))


def sees(observer: Views, target: Body, *occluders: Body) -> bool:
    return bool(sees_bodies(observer, target, [Occluder(item) for item in occluders], 1)[0])


def sees_at(observer: Views, point: tuple[float, float, float], *occluders: Body) -> bool:
    return bool(
        sees_points(observer, np.array([point], dtype=float), [Occluder(item) for item in occluders], 1)[0]
    )


def test_a_wall_hides_until_a_ray_passes_beside_it() -> None:
    observer, target = Views.fixed((0, 0, 0)), fixed((0, 10, 0))
    # The target reaches from -0.5 to 0.5 at 9.5: seen past the edge at 5 of a wall that is narrower than half of that.
    assert not sees(observer, target, fixed((0, 5, 0), (0.53, 0.01, 10)))
    assert sees(observer, target, fixed((0, 5, 0), (0.5, 0.01, 10)))


def test_two_walls_hide_what_neither_hides_alone() -> None:
    observer, target = Views.fixed((0, 0, 0)), fixed((0, 10, 0), (4, 1, 1))
    left, right = fixed((-2, 5, 0), (4.2, 0.1, 4)), fixed((2, 5, 0), (4.2, 0.1, 4))
    assert sees(observer, target, left)
    assert sees(observer, target, right)
    assert not sees(observer, target, left, right)


def test_occluders_behind_or_beyond_hide_nothing() -> None:
    observer, target = Views.fixed((0, 0, 0)), fixed((0, 10, 0))
    assert sees(observer, target, fixed((0, -3, 0), (9, 1, 9)), fixed((0, 12, 0), (9, 1, 9)))


def test_the_camera_sees_what_it_is_in_and_what_surrounds_it() -> None:
    assert sees(Views.fixed((0.2, 0, 0), angles=(0.1, 0.1), distance=0.01), fixed((0, 0, 0)))
    hollow = Body((FRAME,), None, Poses.fixed((0, 0, 0), size=(4, 4, 4)))
    assert sees(Views.fixed((0, 0, 0)), hollow)
    assert not sees(Views.fixed((0, 0, 0), distance=1), hollow)


def test_from_inside_an_occluder_nothing_outside_is_seen() -> None:
    assert not sees(Views.fixed((0, 0, 0)), fixed((0, 10, 0)), fixed((0, 0, 0), (2, 2, 2)))
    assert sees(Views.fixed((0, 0, 0)), fixed((0, 0.6, 0), (0.2, 0.2, 0.2)), fixed((0, 0, 0), (2, 2, 2)))


def test_borders_belong_to_views() -> None:
    observer = Views.fixed((0, 0, 0), angles=(np.pi / 2, np.pi / 2), distance=5)
    assert sees_at(observer, (0, 5, 0))
    assert not sees_at(observer, (0, 5.001, 0))
    assert sees_at(observer, (2, 2, 0))
    assert sees_at(observer, (-2, 2, 0))
    assert not sees_at(observer, (-2.001, 2, 0))
    assert sees_at(observer, (0, 2, -2))
    assert not sees_at(observer, (0, 2, -2.001))


def test_a_point_at_the_camera_is_seen_even_with_occluders_there() -> None:
    assert sees_at(Views.fixed((1, 2, 3), angles=(0.1, 0.1)), (1, 2, 3), fixed((1, 2, 3)))


def test_a_point_on_an_occluder_is_hidden_by_it() -> None:
    wall = fixed((0, 5, 0), (2, 1, 2))
    assert not sees_at(Views.fixed((0, 0, 0)), (0, 4.5, 0), wall)
    assert sees_at(Views.fixed((0, 0, 0)), (0, 4.499, 0), wall)


def test_the_view_turns_with_its_frame() -> None:
    half = np.sqrt(0.5)
    up = Views.fixed((0, 0, 0), (half, 0, 0, half), angles=(0.2, 0.2))
    assert sees_at(up, (0, 0, 5))
    assert not sees_at(up, (0, 5, 0))


def test_few_rays_may_miss_what_more_rays_find() -> None:
    # Its middle is out of view; one corner reaches in.
    target = fixed((4, 4, 0), (1, 1, 1))
    target = Body((BOX,), None, Poses.fixed((4.2, 4, 0)))
    coarse = Views.fixed((0, 0, 0), angles=(np.pi / 2, 0.5), count=(4, 4))
    fine = Views.fixed((0, 0, 0), angles=(np.pi / 2, 0.5), count=(400, 40))
    assert not sees(coarse, target)
    assert sees(fine, target)


def test_ray_numbers_grow_with_the_distance_where_asked() -> None:
    target = Body((BOX,), None, Poses.fixed((20.5, 20, 0), size=(1, 1, 1)))
    for scaling in (False, True):
        observer = Views.fixed((0, 0, 0), angles=(np.pi / 2, 0.3), density=0.4, scaling=scaling, distance=100)
        assert sees(observer, target) == scaling
