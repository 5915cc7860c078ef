"""What is written as JSON Lines is read back."""

import math
from pathlib import Path

import pytest

import scenic
from scenic.formats.json_lines import scene_line
from scenic.language.errors import Located

PROGRAM = (
    "ego = new Object at (Range(0, 1), 2, 3), facing Range(0, 1), with far 1e400, with friend None\n"
    "other = new Object at (9, 9), with friend ego\nparam x = Range(0, 1)\n"
)


def test_scenes_come_back(tmp_path: Path) -> None:
    scenes = scenic.scenarioFromString(PROGRAM).sample(3, seed=2)
    file = tmp_path / "scenes.jsonl"
    file.write_text("".join(scene_line(scene) + "\n" for scene in scenes))
    for scene, read in zip(scenes, scenic.read_scenes(file), strict=True):
        assert (read.seed, read.k, read.attempts) == (scene.seed, scene.k, scene.attempts)
        assert read.params == scene.params
        assert read.ego is read.objects[0]
        for thing, item in zip(scene.objects, read.objects, strict=True):
            assert item.position == tuple(thing.position)
            assert item.size == (thing.width, thing.length, thing.height)
            assert item.euler[0] == pytest.approx(thing.yaw)
        assert read.objects[0].properties["far"] == math.inf
        assert read.objects[1].properties["friend"] == {"$object": 0}
        assert read.objects[1].name == "other"


@pytest.mark.parametrize(
    "text", ["{", "[]", "{}", '{"format":"scenic-scene","version":99,"objects":[],"ego":null}', "\n"]
)
def test_other_files_are_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "scenes.jsonl"
    file.write_text(text)
    with pytest.raises(Located, match=r"line 1 .* holds no scene"):
        list(scenic.read_scenes(file))
    with pytest.raises(Located, match="cannot read"):
        list(scenic.read_scenes(tmp_path / "none.jsonl"))
