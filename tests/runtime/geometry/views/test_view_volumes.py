"""The places in view: exact test, draws and mesh say the same."""

import math

import numpy as np
import pytest

from scenic.runtime.geometry.meshes.inside import contains_points
from scenic.runtime.geometry.views.observers import Views, extents
from scenic.runtime.geometry.views.view_volumes import (
    draw_near,
    draw_places,
    near_volume,
    view_mesh,
    view_volume,
)

ANGLES = [
    (2 * math.pi, math.pi),
    (1.0, math.pi),
    (5.5, math.pi),
    (2 * math.pi, 1.2),
    (1.0, 0.7),
    (4.5, 2.5),
    (0.001, 0.001),
]


@pytest.mark.parametrize(("horizontal", "vertical"), ANGLES)
def test_the_mesh_is_a_solid_with_the_volume_of_the_region(horizontal: float, vertical: float) -> None:
    mesh = view_mesh(horizontal, vertical)
    h, v = max(horizontal, 0.017), max(vertical, 0.017)
    assert mesh.is_volume
    assert mesh.volume == pytest.approx(h * 2 * math.sin(v / 2) / 3, rel=3e-3)
    view = Views.fixed((1, 2, 3), angles=(horizontal, vertical), distance=2)
    assert view_volume(view) == pytest.approx(8 * mesh.volume, rel=3e-3)


@pytest.mark.parametrize(("horizontal", "vertical"), ANGLES[:-1])
def test_the_mesh_holds_what_the_exact_test_holds(horizontal: float, vertical: float) -> None:
    rng = np.random.default_rng(3)
    points = rng.uniform(-1.05, 1.05, (4000, 3))
    view = Views.fixed((0, 0, 0), angles=(horizontal, vertical), distance=1)
    exact, meshed = view.contain(points), contains_points(view_mesh(horizontal, vertical), points)
    inner = Views.fixed((0, 0, 0), angles=(horizontal - 0.01, vertical - 0.01), distance=0.997)
    outer = Views.fixed((0, 0, 0), angles=(horizontal + 0.01, vertical + 0.01), distance=1.003)
    assert not (inner.contain(points) & ~meshed & exact & (horizontal < 6)).any()
    assert not (meshed & ~outer.contain(points)).any()
    assert (exact != meshed).mean() < 0.01


@pytest.mark.parametrize(("horizontal", "vertical"), ANGLES[:-1])
def test_draws_are_uniform_over_the_region(horizontal: float, vertical: float) -> None:
    rng = np.random.default_rng(4)
    turn = np.array([0.1, -0.5, 0.3, 0.8])
    turn /= np.linalg.norm(turn)
    view = Views.fixed((3, -2, 1), turn, angles=(horizontal, vertical), distance=4)
    drawn = draw_places(view, rng.random((20000, 3)))
    assert view.contain(drawn).all()
    # As many draws as there is volume in a smaller region within it.
    part = Views.fixed((3, -2, 1), turn, angles=(0.6 * horizontal, 0.5 * vertical), distance=3)
    share = 0.6 * math.sin(0.25 * vertical) / math.sin(0.5 * vertical) * (3 / 4) ** 3
    assert part.contain(drawn).mean() == pytest.approx(share, abs=4.5 * math.sqrt(share / 20000))


def test_the_directions_of_boxes_are_those_of_their_points() -> None:
    rng = np.random.default_rng(5)
    axes = np.linalg.qr(rng.normal(size=(300, 3, 3)))[0] * rng.uniform(0.1, 2, (300, 3, 1))
    middle = rng.normal(size=(300, 3)) * rng.choice([0.5, 3.0], (300, 1))
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    corners = middle[:, None] + signs @ axes
    found = extents(corners)
    places = rng.uniform(-1, 1, (300, 4000, 3))
    largest = np.argmax(np.abs(places), axis=-1)
    np.put_along_axis(
        places, largest[..., None], np.sign(np.take_along_axis(places, largest[..., None], -1)), -1
    )
    x, y, z = np.moveaxis(middle[:, None] + places @ axes, -1, 0)
    altitude = np.arctan2(z, np.hypot(x, y))
    assert (altitude >= found.altitude[:, :1]).all()
    assert (altitude <= found.altitude[:, 1:]).all()
    # And tight, up to how finely the surface is sampled.
    assert np.median(altitude.min(axis=1) - found.altitude[:, 0]) < 0.02
    assert np.median(found.altitude[:, 1] - altitude.max(axis=1)) < 0.02
    azimuth = np.arctan2(-x, y)
    inside = np.zeros(azimuth.shape, bool)
    for turn in (-2 * np.pi, 0, 2 * np.pi):
        inside |= (azimuth + turn >= found.azimuth[:, :1]) & (azimuth + turn <= found.azimuth[:, 1:])
    assert (inside | found.around[:, None]).all()
    assert 20 < found.around.sum() < 280


@pytest.mark.parametrize(("horizontal", "vertical"), ANGLES[:-1])
@pytest.mark.parametrize("radius", [0.0, 0.05, 0.4, 3.0])
def test_balls_that_meet_the_view_have_their_middles_among_what_is_drawn(
    horizontal: float, vertical: float, radius: float
) -> None:
    rng = np.random.default_rng(8)
    count = 20000
    view = Views.fixed((1, 2, 3), angles=(horizontal, vertical), distance=2).spread(count)
    radii = np.full(count, radius)
    drawn = draw_near(view, radii, rng.random((count, 4)))
    # Middles of balls that touch the view: places in view, moved by up to the radius.
    step = rng.normal(size=(count, 3))
    step *= radius * rng.random((count, 1)) / np.linalg.norm(step, axis=1, keepdims=True)
    middles = draw_places(view, rng.random((count, 3))) + step
    # As many draws per volume in small boxes about such middles as in all of the set.
    chosen = middles[:40]
    side = 0.35
    inside = (np.abs(drawn[:, None] - chosen[None]) <= side / 2).all(axis=2).sum(axis=0)
    expected = count * side**3 / near_volume(view.take(np.arange(1)), radii[:1])[0]
    assert inside.max() <= expected + 6 * math.sqrt(expected) + 6
    assert inside.mean() > 0.2 * expected
    assert (inside > 0).all() or expected < 8


@pytest.mark.parametrize(("horizontal", "vertical"), [(1.0, 0.7), (1.0, 2.5), (5.5, 1.2)])
def test_middles_near_a_view_are_drawn_as_densely_close_by_as_far_off(
    horizontal: float, vertical: float
) -> None:
    """Close to the camera all directions count, farther off those of a wider view: one density, no gap, no overlap."""
    count, radius, reach = 200_000, 0.05, 2.0
    view = Views.fixed((0, 0, 0), angles=(horizontal, vertical), distance=reach).spread(count)
    drawn = draw_near(view, np.full(count, radius), np.random.default_rng(6).random((count, 4)))
    x, y, z = drawn.T
    distance = np.sqrt(x * x + y * y + z * z)
    azimuth, altitude = np.arctan2(-x, y), np.arctan2(z, np.hypot(x, y))
    core = 8 * radius
    assert distance.max() <= reach + radius
    # Shares of the core and of two shells in the middle of the view, by their volumes.
    volume = near_volume(view.take(np.arange(1)), np.full(1, radius))[0]
    middle = (np.abs(azimuth) < horizontal / 2) & (np.abs(altitude) < vertical / 2)
    part = horizontal * 2 * math.sin(vertical / 2) / 3
    for inside, expected in (
        (distance < core, 4 / 3 * math.pi * core**3),
        (distance < core / 2, 4 / 3 * math.pi * (core / 2) ** 3),
        (middle & (distance > core) & (distance < 1), part * (1 - core**3)),
        (middle & (distance > 1) & (distance < reach), part * (reach**3 - 1)),
    ):
        share = expected / volume
        assert inside.mean() == pytest.approx(share, abs=5 * math.sqrt(share * (1 - share) / count))
    # Where the view ends above, a ball beside it may touch it from farther round than in the middle.
    far = distance > core
    wider = math.asin(min(1.0, radius / core / math.cos(vertical / 2)))
    assert np.abs(azimuth[far]).max() == pytest.approx(min(math.pi, horizontal / 2 + wider), abs=1e-3)
    higher = math.asin(radius / core)
    assert np.abs(altitude[far]).max() == pytest.approx(min(math.pi / 2, vertical / 2 + higher), abs=2e-2)


@pytest.mark.parametrize("vertical", [math.pi, 3.0, 2.9])
@pytest.mark.parametrize("horizontal", [0.5, 2.0])
def test_middles_beyond_the_pole_are_drawn_all_around(horizontal: float, vertical: float) -> None:
    """A ball that lies on the other side of the vertical reaches across it into a high view."""
    count, radius = 60_000, 0.1
    view = Views.fixed((0, 0, 0), angles=(horizontal, vertical), distance=1.2).spread(count)
    drawn = draw_near(view, np.full(count, radius), np.random.default_rng(7).random((count, 4)))
    x, y, z = drawn.T
    beside = np.hypot(x, y)
    # Behind the camera, so near the vertical that it touches the part of the view there.
    touching = (beside < radius) & (np.abs(z) > 8.2 * radius) & (np.abs(z) < 1.2)
    around = np.histogram(np.arctan2(-x, y)[touching], 8, (-np.pi, np.pi))[0]
    assert around.min() > 0.4 * around.mean() > 3
