"""Colours of pixels against the formula of the light, where it can be done by hand: stretched, thin and backward surfaces."""

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from scenic.formats.backdrop import _lines, sky_color
from scenic.formats.buffers import Lens, look
from scenic.formats.camera import Camera
from scenic.formats.colors import decoded, encoded, linear
from scenic.formats.lighting import _averaged, own_light
from scenic.formats.mesh_instances import picture
from scenic.formats.render import paint
from scenic.formats.stage import SKY, Stage
from tests.formats.stand_ins import BALL, Mesh, Object, Scene, Shape, Source, Turn, unit

SUN = np.array([-0.55, -0.33, 0.77]) / np.linalg.norm([-0.55, -0.33, 0.77])
SUN_COLOR = np.array([1.0, 0.96, 0.9]) * 0.95
SKY_COLOR = np.array([0.86, 0.93, 1.0]) * 0.62
BOUNCE_COLOR = np.array([1.0, 0.95, 0.88]) * 0.34
GREY = (0.6, 0.5, 0.4)
COARSE = Shape(unit(trimesh.creation.icosphere(1)), Source({"kind": "mesh"}))
"""Eighty triangles: within each, the normals of its corners decide."""
HIGH = 1000.0
"""So far above everything else nothing shades an object."""


def towards(place: np.ndarray, offset: np.ndarray, width: float) -> Camera:
    """A camera at an offset from a place, which it looks at; ``width`` is the tangent of half its angle."""
    ahead = -offset / np.linalg.norm(offset)
    right = np.cross(ahead, [0, 0, 1])
    right /= np.linalg.norm(right)
    return Camera(place + offset, right, np.cross(right, ahead), ahead, (width, width))


def shaded(normals: np.ndarray) -> np.ndarray:
    """Linear colours of places with these normals in full sun, under the open sky."""
    facing = np.maximum(normals @ SUN, 0)[:, None]
    upward = (normals[:, 2:] + 1) / 2
    light = SUN_COLOR * facing + BOUNCE_COLOR + upward * (SKY_COLOR - BOUNCE_COLOR)
    return np.asarray(linear(GREY)) * light


@pytest.mark.parametrize(
    ("shape", "size", "turn", "most"),
    [
        (BALL, (4.0, 1.5, 3.0), Turn.by(0.7, 0.3, 0.4), 0.018),
        (BALL, (2.0, 2.0, 2.0), Turn(), 0.018),
        (COARSE, (3.0, 3.0, 3.0), Turn.by(0.2), 0.045),
    ],
)
def test_round_things_are_lit_by_their_true_normals(
    shape: Shape, size: tuple[float, float, float], turn: Turn, most: float
) -> None:
    from scipy.spatial.transform import Rotation

    place = np.array([0.0, 0.0, HIGH])
    width, length, height = size
    ball = Object(tuple(place), turn, width, length, height, shape, GREY)
    drawn = picture([Scene([ball, Object()])])
    stage = Stage(drawn.surfaces, drawn.scenes[0])
    camera = towards(place, 12 * (SUN + np.array([0.5, -0.6, 0.0])), 0.15)
    lens = Lens(camera, stage.center, (48, 48))
    image = decoded(paint(stage, lens)).reshape(-1, 3)
    seen = look(stage, lens.eye, lens.through_all(1).reshape(-1, 3))
    rotation = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w])
    hits = camera.eye + seen.directions / np.maximum(seen.nearness, 1e-9)[:, None] - place
    normals = rotation.apply(rotation.inv().apply(hits) / np.square(size))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    # Not at its outline, and not where it begins to shade itself.
    inner = (seen.triangle >= 0) & (normals @ SUN > 0.35) & (normals @ -camera.ahead > 0.4)
    assert inner.sum() > 150
    away = np.abs(image[inner] - shaded(normals[inner])).max(axis=1)
    assert np.quantile(away, 0.95) < most
    assert away.mean() < 0.4 * most


SHEET = Shape(
    Mesh(
        np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]]),
        np.array([[0, 1, 2], [0, 2, 3]]),
    ),
    Source({"kind": "mesh"}),
)


@pytest.mark.parametrize("above", [True, False])
def test_only_the_side_that_the_sun_reaches_is_bright(above: bool) -> None:
    """A sheet has one normal and two sides."""
    place = np.array([0.0, 0.0, HIGH])
    sheet = Object(tuple(place), width=9, length=9, shape=SHEET, color=GREY)
    drawn = picture([Scene([sheet, Object()])])
    stage = Stage(drawn.surfaces, drawn.scenes[0])
    lens = Lens(towards(place, np.array([1.0, -3.0, 9.0 if above else -9.0]), 0.05), stage.center, (12, 12))
    image = decoded(paint(stage, lens)).reshape(-1, 3).mean(axis=0)
    up = np.array([[0.0, 0.0, 1.0]])
    sunny = shaded(up)[0] - np.asarray(linear(GREY)) * SKY_COLOR
    assert image == pytest.approx(shaded(up)[0] - (0 if above else 1) * sunny, abs=0.02)


def test_what_is_thinner_than_two_pixels_is_lit_as_well() -> None:
    place = np.array([0.0, 0.0, HIGH])
    wire = Object(tuple(place), width=0.02, length=0.02, height=9, color=GREY)
    drawn = picture([Scene([wire, Object()])])
    stage = Stage(drawn.surfaces, drawn.scenes[0])
    lens = Lens(towards(place, np.array([0.0, -10.0, 0.0]), 0.3), stage.center, (301, 8))
    seen = look(stage, lens.eye, lens.through_all(1).reshape(-1, 3))
    shown = np.flatnonzero(seen.triangle >= 0)
    assert len(shown) == 8
    light = own_light(stage, lens.eye, seen.take(shown), np.arange(len(shown)))
    assert light.sun == pytest.approx(1)
    image = decoded(paint(stage, lens)).reshape(-1, 3)[shown]
    # Half of a pixel at an edge is its own colour, the rest that of what is around its corners.
    south = shaded(np.array([[0.0, -1.0, 0.0]]))[0]
    beside = decoded(paint(stage, lens)).reshape(8, 301, 3)[:, 100]
    least, most = np.minimum(south, beside) - 0.03, np.maximum(south, beside) + 0.03
    assert ((image >= least) & (image <= most)).all()


def test_below_the_ground_nothing_falls_on_it() -> None:
    drawn = picture([Scene([Object((0, 0, 0.5))])])
    stage = Stage(drawn.surfaces, drawn.scenes[0])
    directions = np.array([[0.1, 0.0, -1.0], [5.0, 5.0, -1.0]], np.float32)
    below, above = (
        np.array([5.0, 5.0, z], np.float32) - stage.center.astype(np.float32) for z in (-1.0, 1.0)
    )
    assert look(stage, below, directions).group.tolist() == [SKY, SKY]
    assert SKY not in look(stage, above, directions).group.tolist()


def test_the_sky_is_palest_at_the_horizon_whatever_the_length_of_directions() -> None:
    rise = np.radians([-40, 0, 10, 20, 30, 60, 90])
    directions = np.stack([np.cos(rise) * 0.6, np.cos(rise) * 0.8, np.sin(rise)], axis=1)
    low, high = np.asarray(linear((0.90, 0.92, 0.95))), np.asarray(linear((0.74, 0.82, 0.91)))
    part = np.clip(2 * np.sin(rise), 0, 1)
    for length in (0.1, 1, 7):
        found = sky_color((length * directions).astype(np.float32))
        np.testing.assert_allclose(found.T, low + part[:, None] * (high - low), atol=1e-5)


def test_lines_of_the_ground_are_a_pixel_wide_and_fade() -> None:
    """A metre apart, every fifth one stronger; about the middle of the scene, which is not that of the grid."""
    stage = SimpleNamespace(reach=12.0, center=np.array([0.25, -0.5, 0.0]))
    for distance, wide, strength, step in (
        (0.0, 0.01, 0.7, 5), (0.005, 0.01, 0.7, 5), (0.02, 0.05, 0.7, 5), (0.1, 0.2, 0.7, 5), (0.3, 0.2, 0.0, 5)
    ):  # fmt: skip
        for sign in (-1, 1):
            place = np.array([5 - 0.25 + sign * distance], np.float32)
            other = np.array([2.5 + 0.5], np.float32)
            found = [
                _lines(stage, *at, np.array([wide], np.float32))
                for at in ((place, other), (other - 0.75, place + 0.75))
            ]
            line = min(1.2 - distance / wide, 1)
            fine = line * 0.35 * np.clip(1.5 - 6 * wide, 0, 1)
            coarse = line * strength * np.clip(1.5 - 6 * wide / step, 0, 1)
            expected = max(1 - (1 - fine) * (1 - coarse), 0) if distance < 1.2 * wide else 0
            np.testing.assert_allclose(np.concatenate(found), expected, atol=1e-4)


def test_means_are_over_the_same_surface() -> None:
    group = np.ones((9, 12), np.int32)
    group[:, 6:] = 2
    means, count = _averaged(np.where(group == 1, np.float32(3), np.float32(5)), group)
    np.testing.assert_allclose(means, np.where(group == 1, 3, 5), rtol=1e-6)
    # Five nodes of which the outer two count half, in both directions.
    np.testing.assert_allclose(count[4], 4 * np.array([2.5, 3.5, 4, 4, 3.5, 2.5] * 2))
    slope = np.tile(np.arange(12, dtype=np.float32), (9, 1))
    means, _ = _averaged(slope, np.ones_like(group))
    np.testing.assert_allclose(means[:, 2:-2], slope[:, 2:-2], rtol=1e-6)


@pytest.mark.parametrize("height", [0.2, 1.0, 5.0])
def test_shadows_begin_at_the_foot_of_what_throws_them(height: float) -> None:
    """However low it is: behind it as seen from the sun, and nowhere else."""
    thing = Object((0, 0, height / 2), width=2, length=2, height=height)
    drawn = picture([Scene([thing])])
    stage = Stage(drawn.surfaces, drawn.scenes[0])
    reach = height * np.hypot(SUN[0], SUN[1]) / SUN[2]
    away = -SUN[:2] / np.hypot(SUN[0], SUN[1])
    # From the corner that is turned away from the sun along its shadow, and beyond it; then towards the sun.
    corner = np.array([1.0, 1.0])
    places = [corner + away * reach * part for part in (0.1, 0.5, 0.85, 1.3, 2.0)]
    places += [-corner - away * reach * part for part in (0.1, 0.5, 1.5)]
    ground = np.array([[*place, 0.0] for place in places]) - stage.center
    sun = stage.sunlit(
        ground.astype(np.float32),
        np.tile(np.float32([0, 0, 1]), (len(places), 1)),
        np.zeros(len(places), np.int64),
        16,
    )
    np.testing.assert_allclose(sun, [0, 0, 0, 1, 1, 1, 1, 1], atol=0.1)


def test_tones_come_back_from_light() -> None:
    """And light between two tones becomes the nearer one, by the standard's formula."""
    tones = np.arange(256, dtype=np.uint8)
    np.testing.assert_array_equal(encoded(decoded(tones)), tones)
    light = np.linspace(0, 1, 5001, dtype=np.float32)
    exact = 255 * np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    assert np.abs(encoded(light) - exact).max() < 0.65
    assert abs(float(np.mean(encoded(light) - exact))) < 0.02
    assert encoded(np.array([-1.0, 2.0])).tolist() == [0, 255]
