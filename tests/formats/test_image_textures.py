"""Image files as textures: read once, projected or laid by the mesh's own coordinates, and named by their content."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.batch.manifest import Manifest
from scenic.batch.source_files import check_textures
from scenic.formats.coco import Photographer
from scenic.formats.image_textures import ImageTexture, TextureError
from scenic.formats.mesh_coordinates import coordinates_of
from scenic.formats.mesh_files import digest_of
from scenic.formats.mesh_instances import picture
from scenic.formats.render import render
from scenic.formats.textures import texture_of

PIL = pytest.importorskip("PIL.Image")

RED, GREEN, BLUE, WHITE = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255)
CUBE = """
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v -1 -1 2
v 1 -1 2
v 1 1 2
v -1 1 2
vt 0 0
vt 0.5 0
vt 0.5 0.5
vt 0 0.5
f 1/1 2/2 6/3 5/4
f 2/1 3/2 7/3 6/4
f 3/1 4/2 8/3 7/4
f 4/1 1/2 5/3 8/4
f 5/1 6/2 7/3 8/4
f 4/1 3/2 2/3 1/4
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Four quarters (red and green above, blue and white below), a grey image, and a cube whose faces show the lower left one."""
    quarters = np.array([[RED, GREEN], [BLUE, WHITE]], np.uint8).repeat(32, axis=0).repeat(32, axis=1)
    PIL.fromarray(quarters).save(tmp_path / "quarters.png")
    PIL.fromarray(np.full((8, 8, 3), 128, np.uint8)).save(tmp_path / "grey.jpg")
    (tmp_path / "cube.obj").write_text(CUBE)
    return tmp_path


def scenario_of(folder: Path, thing: str) -> scenic.Scenario:
    """Something before a camera that looks north, with the light from behind it."""
    program = folder / "program.scenic"
    program.write_text(
        'from scenic import RGBSensor\n'
        "param lighting = {'sun': (180 deg, 1 deg), 'skylight': 1}\n"
        'ego = new Object at (0, -5, 0), with sensors {"eye": RGBSensor(width=48, height=48, attributes={"fov": 40})}\n'
        f"new Object at (0, 1, 0), with width 2, with length 2, with height 2, {thing}\n"
    )  # fmt: skip
    return scenic.load(program)


def photo(folder: Path, thing: str, seed: int = 1) -> Any:
    """The image that the camera takes, and its labels."""
    (scene,) = scenario_of(folder, thing).sample(1, seed=seed)
    shot = Photographer("eye", None).shoot(scene)
    pixels = np.asarray(PIL.open(io.BytesIO(shot.files["eye-000000-rgb.png"])).convert("RGB"))
    return pixels.astype(int), json.loads(shot.files["eye-000000.json"])


def hue(pixel: Any) -> tuple[bool, ...]:
    """Return a mask of the strong channels among red, green and blue."""
    return tuple(bool(part > 0.7 * pixel.max()) for part in pixel)


def test_an_image_stands_upright_on_the_sides_of_a_box(folder: Path) -> None:
    for turn in (0, 90, 180, 270):
        image, labels = photo(folder, f'with texture "quarters.png", facing {turn} deg')
        found = [hue(image[row, column]) for row in (18, 30) for column in (18, 30)]
        assert found == [(True, False, False), (False, True, False), (False, False, True), (True, True, True)]
        digest = digest_of(folder / "quarters.png")
        assert labels["objects"][0]["texture"] == {"image": "quarters.png", "sha256": digest}


def test_scale_is_the_width_of_an_image_and_transparent_parts_show_the_object(folder: Path) -> None:
    small, _ = photo(folder, 'with texture {"image": "quarters.png", "scale": 1}')
    large, _ = photo(folder, 'with texture {"image": "quarters.png", "scale": 4}')
    # The middle of an image is in the middle of the object: of a small one, the next image begins half a metre from there.
    assert hue(small[15, 15]) == (True, True, True)
    assert hue(large[12, 12]) == (True, False, False)
    half = np.zeros((2, 2, 4), np.uint8)
    half[:, 0] = (255, 0, 0, 255)
    PIL.fromarray(half.repeat(32, axis=0).repeat(32, axis=1)).save(folder / "half.png")
    image, _ = photo(folder, 'with texture "half.png", with color (0, 0, 1)')
    assert [hue(image[24, column]) for column in (16, 32)] == [(True, False, False), (False, False, True)]
    above, _ = photo(
        folder, 'with texture {"image": "quarters.png", "projection": "planar"}, facing (0, 90 deg, 0)'
    )
    assert hue(above[18, 18]) != hue(above[30, 18])


def test_meshes_have_coordinates_of_their_own(folder: Path) -> None:
    shape = 'with shape MeshShape.fromFile(localPath("cube.obj"){})'
    for rotation in ("", ", initial_rotation=(90 deg, 0, 0)"):
        image, _ = photo(folder, f'{shape.format(rotation)}, with texture "quarters.png"')
        assert {hue(image[row, column]) for row in (16, 24, 32) for column in (16, 24, 32)} == {
            (False, False, True)
        }
    boxed, _ = photo(
        folder, f'{shape.format("")}, with texture {{"image": "quarters.png", "projection": "box"}}'
    )
    assert hue(boxed[18, 18]) == (True, False, False)


def test_triangles_are_found_among_those_of_the_file_even_in_parts(folder: Path) -> None:
    corners = np.array([[-0.5, -0.5, -0.5], [0.5, -0.5, -0.5], [0.5, -0.5, 0.5], [0, -0.5, -0.5], [0, 0, 0]])
    source = {"kind": "mesh", "path": str(folder / "cube.obj")}
    found = coordinates_of(source, corners, np.array([[0, 1, 2], [0, 3, 2], [0, 1, 4]]))
    assert found is not None
    np.testing.assert_allclose(found[0], [(0, 0), (0.5, 0), (0.5, 0.5)], atol=1e-6)
    np.testing.assert_allclose(found[1], [(0, 0), (0.25, 0), (0.5, 0.5)], atol=1e-6)
    assert np.isnan(found[2]).all()
    assert coordinates_of({"kind": "box"}, corners, np.array([[0, 1, 2]])) is None
    plain = "\n".join(line for line in CUBE.splitlines() if not line.startswith("vt"))
    (folder / "plain.obj").write_text(
        plain.replace("/1", "").replace("/2", "").replace("/3", "").replace("/4", "")
    )
    assert (
        coordinates_of({"kind": "mesh", "path": str(folder / "plain.obj")}, corners, np.array([[0, 1, 2]]))
        is None
    )


def test_from_afar_an_image_is_its_mean(folder: Path) -> None:
    texture = texture_of("quarters.png", (1, 1, 1), folder)
    assert isinstance(texture, ImageTexture)
    places = np.random.default_rng(1).random((500, 2)).astype(np.float32)
    own = np.ones(3, np.float32)
    near = texture.colors(own, places, np.full(500, 1e-4, np.float32))
    far = texture.colors(own, places, np.full(500, 2, np.float32))
    assert np.abs(near.mean(axis=1) - 0.5).max() < 0.05
    assert np.abs(far - 0.5).max() < 0.01
    np.testing.assert_allclose(
        texture.colors(own, places + 3, np.full(500, 1e-4, np.float32)), near, atol=2e-3
    )


def test_drawn_images_are_in_manifests_by_their_content(folder: Path) -> None:
    choice = '{"image": Uniform("quarters.png", "grey.jpg"), "scale": Range(1, 2)}'
    scenario = scenario_of(folder, f"with texture Uniform({choice}, 'checker')")
    wanted = {name: digest_of(folder / name) for name in ("grey.jpg", "quarters.png")}
    assert Manifest.of(scenario, seed=1, count=1).files == wanted
    named = {
        photo(folder, f"with texture {choice}", seed)[1]["objects"][0]["texture"]["image"]
        for seed in range(8)
    }
    assert named == {"quarters.png", "grey.jpg"}


@pytest.mark.parametrize(
    ("name", "reason"), [("none.png", "no such file"), ("broken.png", "cannot identify")]
)
def test_files_that_cannot_be_read_are_errors_at_their_object(folder: Path, name: str, reason: str) -> None:
    (folder / "broken.png").write_bytes(b"no image")
    scenario = scenario_of(folder, f'with texture Uniform("quarters.png", "{name}")')
    with pytest.raises(TextureError, match=f"cannot read the texture '{name}': {reason}") as caught:
        check_textures(scenario)
    assert caught.value.line == 4
    (scene,) = scenario_of(folder, f'with texture "{name}"').sample(1, seed=1)
    with pytest.raises(TextureError, match=reason) as late:
        Photographer("eye", None).shoot(scene)
    assert late.value.line == 4


@pytest.mark.parametrize(
    "value",
    [
        "wood.bmp",
        {"image": 3},
        {"image": "a.png", "scale": 0},
        {"image": "a.png", "projection": "round"},
        {"image": "a.png", "hue": 1},
    ],
)
def test_other_textures_are_refused(value: Any) -> None:
    with pytest.raises(TextureError, match="is no texture"):
        texture_of(value, (1, 1, 1), Path())


def test_scenes_without_a_program_leave_relative_images_out() -> None:
    assert texture_of("wood.png", (1, 1, 1)) is None
    absolute = texture_of(Path("/wood.png"), (1, 1, 1))
    assert isinstance(absolute, ImageTexture)
    with pytest.raises(TextureError, match="no such file"):
        absolute.digest()


def test_pictures_show_images_too(folder: Path) -> None:
    (scene,) = scenario_of(folder, 'with texture "quarters.png"').sample(1, seed=1)
    image = render(picture([scene]), 0, (96, 72)).astype(int)
    assert (image[..., 0] - image[..., 1] > 100).any()
