"""Films of recorded images."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.language.errors import UnsupportedError
from scenic.runtime.dynamics.series import Film, _even
from scenic.simulators.dummy import DummySimulator


def record(folder: Path, expression: str, *, more: str = "", steps: int = 9, timestep: float = 0.1) -> None:
    text = f"""
import numpy as np
param recordFolder = {str(folder)!r}
def image(y, *shape):
    picture = np.zeros(shape, dtype=np.uint8)
    picture[:, : 8 * (1 + round(y))] = 255
    return picture
ego = new Object
record {expression} {more} to 'film.mp4'
"""
    scene = scenic.scenarioFromString(text).sample(1, seed=0)[0]
    assert DummySimulator(drift=1).simulate(scene, maxSteps=steps, timestep=timestep) is not None


def frames(path: Path) -> tuple[tuple[int, int], float, list[Any]]:
    """Size, images a second, and the images ``(height, width, 3)``, as ffmpeg tells them."""
    import imageio_ffmpeg

    words = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    done = subprocess.run(words, capture_output=True, check=True)
    about = next(
        line
        for line in done.stderr.decode().splitlines()
        if "Stream #0:0" in line and ": Video: h264" in line
    )
    size = re.search(r", (\d+)x(\d+)", about)
    pace = re.search(r", ([\d.]+) fps", about)
    assert size is not None
    assert pace is not None
    width, height = int(size[1]), int(size[2])
    images = np.frombuffer(done.stdout, dtype=np.uint8).reshape(-1, height, width, 3)
    return (width, height), float(pace[1]), list(images)


def white(frame: Any) -> int:
    return round(float((frame[frame.shape[0] // 2, :, 0] > 128).sum()))


@pytest.mark.skipif(importlib.util.find_spec("imageio_ffmpeg") is None, reason="needs the extra [video]")
@pytest.mark.parametrize("shape", ["64, 96, 3", "64, 96", "63, 97, 3"])
def test_films_show_every_image(tmp_path: Path, shape: str) -> None:
    record(tmp_path, f"image(ego.y, {shape})")
    size, pace, shown = frames(tmp_path / "film.mp4")
    assert [path.name for path in tmp_path.iterdir()] == ["film.mp4"]
    assert size == (96 if "96" in shape else 98, 64)
    assert pace == 10
    np.testing.assert_allclose([white(frame) for frame in shown], 8 * np.arange(1, 11), atol=3)


@pytest.mark.parametrize("size", [(3, 4), (4, 3), (3, 5), (2, 2), (1, 1)])
def test_images_of_odd_sizes_grow_below_and_to_the_right(size: tuple[int, int]) -> None:
    """By what is at the border: nothing else of them moves."""
    rng = np.random.default_rng(1)
    for shape in (size, (*size, 3), (*size, 4)):
        image = rng.integers(0, 256, shape).astype(np.uint8)
        colours = np.stack([image] * 3, axis=-1) if image.ndim == 2 else image[:, :, :3]
        grown = _even(image)
        height, width = size
        assert grown.shape == (height + height % 2, width + width % 2, 3)
        np.testing.assert_array_equal(grown[:height, :width], colours)
        np.testing.assert_array_equal(grown[height:, :width], colours[-1:][: grown.shape[0] - height])
        np.testing.assert_array_equal(grown[:height, width:], colours[:, -1:][:, : grown.shape[1] - width])


@pytest.mark.skipif(importlib.util.find_spec("imageio_ffmpeg") is None, reason="needs the extra [video]")
def test_films_keep_the_pace_of_the_simulation(tmp_path: Path) -> None:
    record(tmp_path, "image(ego.y, 64, 96)", more="every 2 steps", timestep=0.05)
    _, pace, shown = frames(tmp_path / "film.mp4")
    assert pace == 10
    assert len(shown) == 5


@pytest.mark.skipif(importlib.util.find_spec("imageio_ffmpeg") is None, reason="needs the extra [video]")
def test_films_may_have_a_pace_of_their_own(tmp_path: Path) -> None:
    film = Film(tmp_path / "film.mp4", 0.1, fps=25)
    for step in range(3):
        film.add(step, np.zeros((64, 96), dtype=np.uint8))
    film.save()
    _, pace, shown = frames(tmp_path / "film.mp4")
    assert (pace, len(shown)) == (25, 3)


def test_without_the_library_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(UnsupportedError, match="without the package imageio-ffmpeg") as caught:
        record(tmp_path, "image(ego.y, 64, 96)")
    assert "scenic-lang[video]" in str(caught.value.help)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(importlib.util.find_spec("imageio_ffmpeg") is None, reason="needs the extra [video]")
def test_of_a_dropped_film_nothing_remains_and_of_a_saved_one_everything(tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    picture = np.zeros((64, 96), dtype=np.uint8)

    def film(images: int) -> Film:
        made = Film(path, 0.1)
        for step in range(images):
            made.add(step, picture)
        return made

    for images in range(4):
        film(images).drop()
        assert list(tmp_path.rglob("*.mp4")) == []
    saved = film(2)
    assert list(tmp_path.rglob("film.mp4")) == []
    saved.save()
    saved.drop()
    assert [each.name for each in path.parent.iterdir()] == ["film.mp4"]
    assert len(frames(path)[2]) == 2
    refused = film(2)
    with pytest.raises(ValueError, match=r"not one of \(32, 96\) after \(64, 96\)"):
        refused.add(2, picture[:32])
    refused.drop()
    assert [each.name for each in path.parent.iterdir()] == ["film.mp4"]
    assert len(frames(path)[2]) == 2


@pytest.mark.skipif(importlib.util.find_spec("imageio_ffmpeg") is None, reason="needs the extra [video]")
def test_a_film_of_one_image_is_seen_for_a_step(tmp_path: Path) -> None:
    film = Film(tmp_path / "film.mp4", 0.25)
    film.add(3, np.zeros((64, 96), dtype=np.uint8))
    film.save()
    _, pace, shown = frames(tmp_path / "film.mp4")
    assert (pace, len(shown)) == (4, 1)


@pytest.mark.skipif(importlib.util.find_spec("imageio_ffmpeg") is None, reason="needs the extra [video]")
def test_a_film_that_begins_late_plays_as_fast_as_others(tmp_path: Path) -> None:
    """How long an image is seen is the time between images, not the time of the first or the second."""
    film = Film(tmp_path / "film.mp4", 0.05)
    for step in (7, 9, 11):
        film.add(step, np.zeros((64, 96), dtype=np.uint8))
    film.save()
    _, pace, shown = frames(tmp_path / "film.mp4")
    assert (pace, len(shown)) == (10, 3)
