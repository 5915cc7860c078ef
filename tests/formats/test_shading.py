"""Colours of pixels against the formula of the light, where it can be done by hand: stretched, thin and backward surfaces."""

import numpy as np
import pytest
import trimesh

from scenic.formats.buffers import Lens, look
from scenic.formats.camera import Camera
from scenic.formats.colors import decoded, linear
from scenic.formats.instances import picture
from scenic.formats.lighting import own_light
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
