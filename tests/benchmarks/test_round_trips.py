"""Files for robots, read back by the libraries of their simulators."""

from pathlib import Path
from typing import Any

import pytest

import scenic
from benchmarks.drake_worlds import Worlds
from benchmarks.round_trips import TOLERANCE, Reader, first_scene, forms, write
from fuzz.semantics.programs import texts
from scenic.formats.robotics.solids import solids_of
from tests.formats.robotics.example import scenes


def random_scenes(count: int) -> list[Any]:
    """Scenes of the first random typed programs that have any."""
    drawn = (first_scene(lambda text=text: scenic.scenarioFromString(text)) for text in texts(3 * count, 1))  # type: ignore[misc]
    return [scene for scene in drawn if scene is not None][:count]


def test_poses_bounds_and_masses_come_back(tmp_path: Path) -> None:
    """OpenUSD, MuJoCo and Drake read what was written, and their validators find no fault."""
    with Worlds() as worlds:
        for number, scene in enumerate([*scenes(1), *random_scenes(4)]):
            for form in forms():
                folder = tmp_path / f"{number} {form}"
                folder.mkdir()
                read = Reader(form, write(scene, form, folder), solids_of(scene), worlds)
                assert read.faults == []
                assert max(read.worst.values()) < TOLERANCE[form], (number, form, read.worst)


@pytest.mark.parametrize("form", ["usd", "mjcf"])
def test_a_number_that_is_a_little_off_is_seen(form: str, tmp_path: Path) -> None:
    if form not in forms():
        pytest.skip("its library is not installed")
    (scene,) = scenes(1)
    path = write(scene, form, tmp_path)
    text = path.read_text()
    place = next(solid for solid in solids_of(scene) if solid.name == "ball").position
    assert repr(place[0]) in text
    path.write_text(text.replace(repr(place[0]), repr(place[0] + 1e-5)))
    with Worlds() as worlds:
        assert Reader(form, path, solids_of(scene), worlds).worst["pose"] > TOLERANCE[form]
