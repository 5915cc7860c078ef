"""Maps and modes that do not fit: one error, at the parameter that has to be changed."""

from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.domains.driving.setting import SettingError
from scenic.formats.opendrive.xml_tree import MapError
from tests.maps import straight

MODEL = "model scenic.domains.driving.model\nego = new Car\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "road.xodr").write_text(straight())
    (tmp_path / "other.xodr").write_text("<osm/>")
    (tmp_path / "road.osm").write_text("")
    return tmp_path


def compiled(folder: Path, text: str, *, flat: bool = True, **params: Any) -> Any:
    return scenic.scenarioFromString(text, filename=str(folder / "main.scenic"), mode2D=flat, params=params)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (MODEL, 1, "needs a map"),
        (f"\nparam map = localPath('none.xodr')\n{MODEL}", 2, "there is no map.*road.xodr"),
        (f"x = 1\nparam map = localPath('.')\n{MODEL}", 2, "is a folder"),
        (f"param map = localPath('road.osm')\n{MODEL}", 1, "OpenDRIVE"),
        (f"param map = 3\n{MODEL}", 1, "int"),
        (
            f"param map = localPath('road.xodr')\nparam map_options = {{'tolerence': 1}}\n{MODEL}",
            2,
            "'tolerance'",
        ),
        (f"param map = localPath('road.xodr')\nparam use2DMap = False\n{MODEL}", 2, "a map is flat"),
    ],
)
def test_errors_are_where_the_program_can_be_changed(folder: Path, text: str, line: int, words: str) -> None:
    with pytest.raises(SettingError, match=words) as caught:
        compiled(folder, text)
    assert isinstance(caught.value, RuntimeError)
    assert caught.value.filename == str(folder / "main.scenic")
    assert caught.value.line == line
    assert caught.value.diagnostic().code == "SC620"


def test_maps_given_from_outside_are_wrong_there(folder: Path) -> None:
    with pytest.raises(SettingError, match="no map") as caught:
        compiled(folder, f"param map = localPath('road.xodr')\n{MODEL}", map="none.xodr")
    assert caught.value.filename == "--param map"


def test_files_that_are_no_maps_are_wrong_in_the_file(folder: Path) -> None:
    with pytest.raises(MapError, match="OpenDRIVE") as caught:
        compiled(folder, f"param map = localPath('other.xodr')\n{MODEL}")
    assert caught.value.filename == str(folder / "other.xodr")


def test_three_dimensions_have_roads_with_heights_unless_the_map_is_to_be_flat(folder: Path) -> None:
    text = f"param map = localPath('road.xodr')\n{MODEL}"
    [scene] = compiled(folder, text, flat=False).sample(1, seed=0)
    assert scene.egoObject.position.z == pytest.approx(0.75, abs=1e-4)
    [scene] = compiled(folder, text, flat=False, use2DMap=True).sample(1, seed=0)
    car = scene.egoObject
    assert car.height == 1.5
    assert car.elevation == car.position.z
    assert car.position.z == 0
