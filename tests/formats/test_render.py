import io
import itertools
import sys

import numpy as np
import PIL.Image
import pytest

import scenic
from scenic.formats.buffers import Lens, seen
from scenic.formats.camera import STANDARD, corners, framed, framing, ground_height
from scenic.formats.imaging import MissingLibraryError
from scenic.formats.mesh_instances import picture
from scenic.formats.png import png
from scenic.formats.render import paint, render
from scenic.formats.stage import Stage
from tests.formats.stand_ins import BALL, Object, Scene, Turn

SMALL = (96, 72)
RED, GREEN = (0.9, 0.1, 0.1), (0.1, 0.8, 0.1)


def pixels(*objects: Object) -> np.ndarray:
    return render(picture([Scene(list(objects))]), 0, SMALL).astype(int)


def share(image: np.ndarray, channel: int) -> float:
    """The part of the pixels in which one colour dominates."""
    others = [other for other in range(3) if other != channel]
    return float(np.mean(image[..., channel] > 1.5 * image[..., others].max(axis=-1)))


def test_objects_are_seen_in_their_colours() -> None:
    image = pixels(Object(color=RED), Object(position=(2, 0, 0), color=GREEN, shape=BALL))
    assert image.shape == (72, 96, 3)
    assert share(image, 0) > 0.03
    assert share(image, 1) > 0.03
    assert share(image, 2) == 0


def test_east_is_to_the_right_and_up_is_up() -> None:
    def middle(image: np.ndarray, channel: int) -> np.ndarray:
        others = [other for other in range(3) if other != channel]
        return np.argwhere(image[..., channel] > 1.5 * image[..., others].max(axis=-1)).mean(axis=0)

    image = pixels(Object(color=RED), Object(position=(3, 0, 0), color=GREEN))
    assert middle(image, 1)[1] > middle(image, 0)[1] + 10
    image = pixels(Object(color=RED), Object(position=(0, 0, 3), color=GREEN))
    assert middle(image, 1)[0] < middle(image, 0)[0] - 10


def test_a_shadow_falls_on_the_ground_to_the_north_east() -> None:
    lone = pixels(Object(color=GREEN, position=(0, 0, 0.5)))
    ground = lone[..., 2] > lone[..., 1] * 0.8
    brightness = lone.sum(axis=-1)
    assert brightness[ground].min() < 0.75 * brightness[ground].max()


def test_what_is_transparent_is_seen_through() -> None:
    behind = Object(position=(-0.57 * 2, 0.82 * 2, -1.3), color=RED, width=1.5, length=1.5, height=1.5)
    opaque = pixels(Object(width=3, height=3, color=(0.1, 0.1, 0.9), length=0.1), behind)
    glass = pixels(Object(width=3, height=3, color=(0.1, 0.1, 0.9, 0.2), length=0.1), behind)
    assert glass[..., 0].sum() > opaque[..., 0].sum()


def from_one_place(*scenes: list[Object]) -> list[np.ndarray]:
    """Images of scenes through the camera that is best for the first one."""
    drawn = picture([Scene(objects) for objects in scenes])
    camera = framing(corners(drawn.scenes[0]), 4 / 3)
    return [render(drawn, number, SMALL, camera=camera).astype(int) for number in range(len(scenes))]


def test_the_ground_behind_glass_is_that_beside_it() -> None:
    post = Object(position=(0, 9, 0.5), width=20, color=GREEN)
    panes = [Object(position=(0, 0, 3), width=12, height=6, length=0.01, color=(*RED, a)) for a in (1, 0.001)]
    opaque, glass, bare = from_one_place(*([post, pane] for pane in panes), [post])
    behind = opaque[..., 0] > 1.5 * opaque[..., 1]
    same = np.abs(glass - bare).max(axis=-1) <= 6
    assert behind.mean() > 0.1
    # The pane casts a shadow all the same.
    assert same[behind].mean() > 0.5


def test_pixels_without_rays_of_their_own_show_what_those_would() -> None:
    """The same image with what every pixel sees given beforehand."""
    rng = np.random.default_rng(4)
    things = [
        Object(
            position=tuple(rng.uniform(-4, 4, 3)),
            orientation=Turn.by(*rng.uniform(-1, 1, 3)),
            color=tuple(rng.uniform(0, 1, 3)),
            **({"shape": BALL} if number % 2 else {}),
        )
        for number in range(12)
    ]
    drawn = picture([Scene(things)])
    for size in ((96, 72), (97, 73), (2, 3), (1, 1)):
        camera = framing(corners(drawn.scenes[0]), size[0] / size[1])
        stage = Stage(drawn.surfaces, drawn.scenes[0])
        lens = Lens(camera, stage.center, size)
        rays, given = paint(stage, lens).astype(int), paint(stage, lens, seen(lens, stage.rays)).astype(int)
        assert rays.shape == (size[1], size[0], 3)
        away = np.abs(rays - given).max(axis=-1)
        assert (away > 8).mean() <= 0.01


def test_a_post_thinner_than_two_pixels_has_no_gaps_where_all_pixels_are_known() -> None:
    post, wide = Object(height=8, width=0.05, length=0.05, color=RED), Object(width=12)
    drawn = picture([Scene([post, wide])])
    stage = Stage(drawn.surfaces, drawn.scenes[0])
    lens = Lens(framing(corners(drawn.scenes[0]), 4 / 3), stage.center, (320, 240))
    known = seen(lens, stage.rays)
    shown = stage.owner[known.triangle] == 0
    image = paint(stage, lens, known).astype(int)
    red = image[..., 0] > image[..., 2] + 12
    assert (shown & (known.triangle >= 0)).sum() > 40
    assert red[shown & (known.triangle >= 0)].mean() > 0.95


def test_images_are_deterministic() -> None:
    scene = Scene([Object(shape=BALL), Object(position=(1, 1, 0))])
    assert png(scene, SMALL) == png(scene, SMALL)


def test_png_is_an_image_of_the_size_asked_for() -> None:
    image = PIL.Image.open(io.BytesIO(png(Scene([Object()]), SMALL)))
    assert (image.format, image.size, image.mode) == ("PNG", SMALL, "RGB")


def test_a_scene_without_objects_is_a_picture_of_the_ground() -> None:
    assert pixels().shape == (72, 96, 3)


def test_the_camera_sees_every_corner_and_is_no_farther_than_needed() -> None:
    things = [Object(position=(5, -3, 1), width=4), Object(position=(-9, 8, 20)), Object(height=12.0)]
    instances = picture([Scene(things)]).scenes[0]
    camera = framing(corners(instances), 4 / 3)
    relative = corners(instances) - camera.eye
    depth = relative @ camera.ahead
    assert depth.min() > 0
    x = relative @ camera.right / depth / camera.tangents[0]
    y = relative @ camera.up / depth / camera.tangents[1]
    assert max(np.abs(x).max(), np.abs(y).max()) == pytest.approx(1 / 1.06, abs=1e-6)


def test_ground_height() -> None:
    def height(*objects: Object) -> float:
        return ground_height(corners(picture([Scene(list(objects))]).scenes[0]))

    assert height(Object(position=(0, 0, 0.5))) == 0
    assert height(Object()) == -0.5
    assert height(Object(position=(0, 0, 3))) == 0
    assert height(Object(position=(0, 0, 1000.5))) == 1000


def test_without_pillow_the_way_to_get_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "PIL", None)
    monkeypatch.setitem(sys.modules, "PIL.Image", None)
    with pytest.raises(MissingLibraryError) as caught:
        png(Scene([Object()]), SMALL)
    diagnostic = caught.value.diagnostic()
    assert diagnostic.code == "SC604"
    assert "pip install 'scenic-lang[view]'" in (diagnostic.help or "")


def test_a_picture_of_the_workspace_shows_what_stands_in_it_whole() -> None:
    """Above its height and below it, too; its sides are those of the workspace alone."""
    program = "workspace = Workspace(RectangularRegion((1, 2), 0, 8, 6))\nego = new Object at (1, 2, {z}), with height 4\n"
    for z in (5, -3, 0):
        (scene,) = scenic.scenarioFromString(program.format(z=z)).sample(1, seed=0)
        points = framed(scene, picture([scene]).scenes[0], STANDARD)
        low, high = points.min(axis=0), points.max(axis=0)
        assert low.tolist() == [-3, -1, min(0, z - 2)]
        assert high.tolist() == [5, 5, max(0, z + 2)]
        # At all four corners of the workspace, so that nothing hides at a rim.
        for corner in itertools.product((-3, 5), (-1, 5), (low[2], high[2])):
            assert (np.abs(points - corner).max(axis=1) < 1e-9).any()


def test_a_picture_of_a_workspace_with_a_height_shows_all_of_it() -> None:
    program = "workspace = Workspace(BoxRegion(dimensions=(8, 6, 4), position=(1, 2, 3)))\nego = new Object at (1, 2, {z})\n"
    for z in (3, 1.5, 4.5):
        (scene,) = scenic.scenarioFromString(program.format(z=z)).sample(1, seed=0)
        points = framed(scene, picture([scene]).scenes[0], STANDARD)
        assert (points.min(axis=0).tolist(), points.max(axis=0).tolist()) == ([-3, -1, 1], [5, 5, 5])
