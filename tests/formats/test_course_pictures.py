"""Pictures of simulations: where things are in them, and when."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.formats.camera import Outlook
from scenic.formats.course_page import PoseTape
from scenic.formats.course_pictures import StatePictures, evenly, film_of, sheet
from scenic.formats.png import png
from tests.formats.test_course_page import simulated
from tests.maps import cross

PIL = pytest.importorskip("PIL.Image")

ABOVE = Outlook(azimuth=0.0, elevation=90.0)
SIZE = (120, 90)


@pytest.fixture(scope="module")
def simulation() -> Any:
    return simulated()


@pytest.fixture(scope="module")
def pictures(simulation: Any) -> StatePictures:
    tape = PoseTape()
    for state in simulation.poses:
        tape.add(state)
    return StatePictures.of_course(simulation, tape)


def of_colour(image: np.ndarray, channel: int) -> np.ndarray:
    """The columns of pixels in which a channel is the only bright one."""
    others = np.delete(image.astype(int), channel, axis=2).max(axis=2)
    return np.nonzero(image[:, :, channel] > others + 60)[1]


def test_things_are_where_they_are_at_each_state(simulation: Any, pictures: StatePictures) -> None:
    states = [0, 20, 40, 80]
    images = list(pictures.images(states, SIZE, ABOVE))
    assert len(pictures) == 81
    assert all(image.shape == (90, 120, 3) for image in images)
    columns = [float(of_colour(image, 0).mean()) for image in images]
    places = [float(simulation.poses[state][0][0].x) for state in states]
    # From straight above, columns are a linear function of x.
    slope, start = np.polyfit(places, columns, 1)
    assert slope > 1
    np.testing.assert_allclose(columns, slope * np.array(places) + start, atol=0.7)
    # The blue object comes after three seconds.
    assert [len(of_colour(image, 2)) > 0 for image in images] == [False, False, True, True]


def test_a_scene_is_its_only_state() -> None:
    (scene,) = scenic.scenarioFromString("ego = new Object at (0, 0, 0.5), with color (1, 0, 0)").sample(
        1, seed=1
    )
    pictures = StatePictures(scene)
    content = png(scene, SIZE)
    (image,) = pictures.images([0], SIZE)
    assert (image == np.asarray(PIL.open(io.BytesIO(content)))).all()
    assert sheet(pictures, evenly(len(pictures), 9), SIZE) == content


def test_a_still_camera_on_a_map_shows_the_ego_and_what_is_near_it(tmp_path: Path) -> None:
    (tmp_path / "cross.xodr").write_text(cross(arm=100))
    areas = []
    for other in ("", "new Car at (-95, -1.75), facing -90 deg, with color (0, 0, 1)\n"):
        text = (
            "param map = localPath('cross.xodr')\nmodel scenic.domains.driving.model\n"
            "ego = new Car at (90, 1.75), facing 90 deg, with color (1, 0, 0)\n"
            f"new Car at (70, 1.75), facing 90 deg, with color (0, 1, 0)\n{other}"
        )
        scenario = scenic.scenarioFromString(text, filename=str(tmp_path / "main.scenic"), mode2D=True)
        (scene,) = scenario.sample(1, seed=1)
        (image,) = StatePictures(scene).images([0], SIZE, ABOVE)
        areas.append([len(of_colour(image, channel)) for channel in range(3)])
    (red, green, _), (red_again, green_again, blue) = areas
    assert min(red, green) > 20
    assert (red_again, green_again, blue) == (red, green, 0)


@pytest.mark.parametrize(("count", "most"), [(1, 9), (9, 9), (10, 9), (100, 9), (5, 1)])
def test_numbers_are_spread_evenly(count: int, most: int) -> None:
    found = evenly(count, most)
    assert len(found) == len(set(found)) == min(count, most)
    assert found[0] == 0
    assert most == 1 or found[-1] == count - 1
    assert np.ptp(np.diff(found)) <= 1 if len(found) > 1 else True


def test_a_sheet_has_all_states_with_their_times(pictures: StatePictures) -> None:
    image = PIL.open(io.BytesIO(sheet(pictures, [0, 30, 60, 80], (240, 180), ABOVE)))
    assert image.size == (240, 180)  # two rows of three
    cells = np.asarray(image)
    reds = [float(of_colour(cells[:90, 80 * k : 80 * k + 80], 0).mean()) for k in range(3)]
    assert reds == sorted(reds)
    assert (cells[90:, 80:] == 255).all()


def test_films_last_as_long_as_the_simulation(pictures: StatePictures, tmp_path: Path) -> None:
    states = [0, 20, 40, 60, 80]
    film_of(pictures, states, tmp_path / "run.gif", SIZE, ABOVE)
    with PIL.open(tmp_path / "run.gif") as film:
        assert film.n_frames == 5
        lengths = []
        for frame in range(5):
            film.seek(frame)
            lengths.append(film.info["duration"])
    assert lengths == [2000] * 5
    film_of(pictures, states[:1], tmp_path / "one.gif", SIZE, ABOVE)
    sizes = [(tmp_path / name).stat().st_size for name in ("run.gif", "one.gif")]
    assert sizes[0] < 3 * sizes[1], "what stands still costs nothing"
    (tmp_path / "one.gif").unlink()
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    film_of(pictures, states, tmp_path / "run.mp4", SIZE, ABOVE)
    frames, seconds = ffmpeg.count_frames_and_secs(tmp_path / "run.mp4")
    assert (frames, seconds) == (5, pytest.approx(10.0))
    assert sorted(item.name for item in tmp_path.iterdir()) == ["run.gif", "run.mp4"]
