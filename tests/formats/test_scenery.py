"""What makes pictures of training data varied: lights, exposure, backgrounds and textures, as scenes say them."""

import math
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.formats.mesh_instances import picture
from scenic.formats.render import render
from scenic.formats.scenery import USUAL, SceneryError, scenery_of
from scenic.formats.textures import PATTERNS, TextureError, texture_of
from scenic.runtime.scenes.scene import Scene
from tests.each import each

SIZE = (48, 36)


def scene_of(text: str, seed: int = 1) -> Scene:
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=seed)
    return scene


def drawn(params: str = "", thing: str = "") -> Any:
    text = f"{params}\nego = new Object at (0, 0, 0.5), with color (0.5, 0.5, 0.5){thing}"
    return render(picture([scene_of(text)]), 0, SIZE).astype(float)


def test_light_and_exposure_scale_what_is_seen() -> None:
    usual = drawn()
    assert (drawn("param lighting = {}") == usual).all()
    assert (drawn("param lighting = 'dusk'\nparam backdrop = 3") == usual).all()
    assert (drawn("param lighting = {'sunlight': 0, 'skylight': 0}")[18, 24] == 0).all()
    darker, brighter = drawn("param lighting = {'exposure': -1}"), drawn("param lighting = {'exposure': 1}")
    assert darker.mean() < usual.mean() < brighter.mean()
    # Half the light, in sRGB, where nothing is cut off.
    half = (usual / 255) ** 2.2 / 2
    assert np.abs((darker / 255) ** 2.2 - half).max() < 0.05
    assert drawn("param lighting = {'sunlight': 0.2}").mean() < usual.mean()


def test_the_sun_stands_where_it_is_told() -> None:
    """A wall that looks south is bright with the sun in the south, and the ground is dark on the other side."""
    south, north = (
        drawn(f"param lighting = {{'sun': ({angle} deg, 30 deg), 'skylight': 0.2}}") for angle in (180, 0)
    )
    face = (slice(16, 24), slice(18, 28))
    assert south[face].mean() > 1.5 * north[face].mean()
    up = scenery_of({"lighting": {"sun": (0.0, math.pi / 2)}})
    np.testing.assert_allclose(up.sun, (0, 0, 1), atol=1e-12)
    assert np.isfinite(drawn("param lighting = {'sun': (0, 90 deg)}")).all()
    west = scenery_of({"lighting": {"sun": (math.pi / 2, math.radians(10))}}).sun
    assert west[0] < -0.9


def test_backgrounds_have_the_colours_that_are_told() -> None:
    text = (
        "param backdrop = {'ground': (0, 0.6, 0), 'horizon': (1, 0, 0), 'zenith': (1, 0, 0), 'grid': False}"
    )
    image = drawn(text)
    top, bottom = image[0, 0], image[-3, 3]
    assert top[0] > 200
    assert top[2] < 5
    assert bottom[1] > 100
    assert bottom[1] > 2 * max(bottom[0], bottom[2])


def test_textures_mix_two_colours_in_the_objects_own_frame() -> None:
    plain = drawn()
    for pattern in PATTERNS:
        image = drawn(thing=f", with texture {{'pattern': '{pattern}', 'scale': 0.2, 'color': (1, 0, 0)}}")
        changed = np.abs(image - plain).max(axis=2) > 12
        assert 30 < changed.sum() < 900, pattern
        assert (image[changed][:, 0] >= image[changed][:, 2]).mean() > 0.9, pattern
    assert np.abs(drawn(thing=", with texture None") - plain).max() == 0
    places = np.random.default_rng(1).uniform(-5, 5, (4000, 3)).astype(np.float32)
    for name, pattern in PATTERNS.items():
        share = pattern(places)
        assert share.min() >= 0
        assert share.max() <= 1
        assert 0.4 < share.mean() < 0.6, name
    # It moves and turns with the object.
    texture = texture_of("checker", (1, 1, 1))
    assert texture is not None
    assert texture.share(np.array([[0.1, 0.1, 0.1]], np.float32)) != texture.share(
        np.array([[0.4, 0.1, 0.1]], np.float32)
    )


def test_what_is_random_differs_between_scenes() -> None:
    text = """
param lighting = {"exposure": Range(-2, 1), "sun": (Range(0, 360) deg, Range(20, 80) deg)}
param backdrop = {"ground": Uniform((1, 0, 0), (0, 0, 1))}
ego = new Object with texture Uniform("checker", {"pattern": "noise", "scale": Range(0.1, 0.2)})
"""
    scenes = scenic.scenarioFromString(text).sample(8, seed=1)
    found = [scenery_of(scene.params) for scene in scenes]
    assert len({item.exposure for item in found}) == 8
    assert len({item.ground for item in found}) == 2
    images = [render(picture([scene]), 0, SIZE) for scene in scenes]
    assert len({image.tobytes() for image in images}) == 8


WRONG = {
    "`param lighting` has no 'moon'": {"lighting": {"moon": 1}},
    "'sun' of `param lighting` must be an azimuth": {"lighting": {"sun": (0, -1)}},
    "'sunlight' of `param lighting` must be a number": {"lighting": {"sunlight": -1}},
    "'exposure' of `param lighting` must be a number of stops": {"lighting": {"exposure": "high"}},
    "'ground' of `param backdrop` must be three numbers": {"backdrop": {"ground": (2, 0, 0)}},
    "'grid' of `param backdrop` must be True or False": {"backdrop": {"grid": 1}},
}


@each(WRONG)
def test_what_has_no_meaning_is_refused(words: str) -> None:
    with pytest.raises(SceneryError, match=words.replace("(", r"\(")):
        scenery_of(WRONG[words])


@each(
    ["wood", {"pattern": "checker", "scale": 0}, {"pattern": "noise", "colour": 1}, {"color": (1, 1, 1)}, 3]
)
def test_unknown_textures_are_refused(value: Any) -> None:
    with pytest.raises(TextureError, match="is no texture"):
        texture_of(value, (1, 1, 1))


def test_the_usual_scenery_is_shared() -> None:
    assert scenery_of({"weather": "rain"}) is USUAL
