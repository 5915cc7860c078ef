"""What is written as JSON Lines is read back."""

import json
import math
from pathlib import Path

import pytest

import scenic
from scenic.formats.json_lines import SceneLines, scene_line
from scenic.formats.revival import Revival
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


@pytest.mark.parametrize("scale", ["1", "0.5", "0", "Uniform(0, 1)"])
def test_scenes_are_written_as_they_were_mutated(tmp_path: Path, scale: str) -> None:
    text = (
        "import random\nclass M(Mutator):\n    def appliedTo(self, thing):\n"
        "        thing.count += random.random()\n        thing.word = thing.word + str(random.random())\n        return thing, True\n"
        "class A:\n    count: 3\n    word: 'a'\n    mutator[additive]: M()\n"
        f"ego = new Object\nother = new A at (9, 9), with mutationScale {scale}\n"
    )
    scenes = scenic.scenarioFromString(text).sample(6, seed=2)
    file = tmp_path / "scenes.jsonl"
    lines = SceneLines(("a.scenic", "0123"))
    file.write_text("".join(lines.line(scene) + "\n" for scene in scenes))
    for scene, read in zip(scenes, scenic.read_scenes(file), strict=True):
        thing, item = scene.objects[1], read.objects[1]
        assert item.position == tuple(thing.position)
        for name in ("count", "word", "yaw", "mutationScale"):
            assert item.properties[name] == getattr(thing, name)
        assert (thing.count > 3) is (thing.word != "a") is (thing.mutationScale != 0)


@pytest.mark.parametrize(
    "text", ["{", "[]", "{}", '{"format":"scenic-scene","version":99,"objects":[],"ego":null}', "\n"]
)
def test_other_files_are_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "scenes.jsonl"
    file.write_text(text)
    with pytest.raises(Located, match=r"line 1 .* holds no scene"):
        list(scenic.read_scenes(file))
    with pytest.raises(Located, match=r"cannot read .*: no such file"):
        list(scenic.read_scenes(tmp_path / "none.jsonl"))


def test_no_number_is_a_negative_zero() -> None:
    text = "ego = new Object at (-0.0, 0, 0), facing -0.0, with tag -0.0, with tags (-0.0, 1), with drawn Range(-2, -1) * 0.0\nparam p = -0.0, q = Range(-1, 1) * 0\n"
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=2)
    assert "-0.0" not in scene_line(scene)


def test_the_program_is_told_apart_from_its_digest(tmp_path: Path) -> None:
    (scene,) = scenic.scenarioFromString("ego = new Object\n").sample(1, seed=2)
    file = tmp_path / "scenes.jsonl"
    file.write_text(SceneLines(("a.scenic", "0123")).line(scene) + "\n" + scene_line(scene) + "\n")
    told = [(read.program, read.digest) for read in scenic.read_scenes(file)]
    assert told == [("a.scenic", "0123"), (None, None)]


def test_the_line_that_is_no_text_is_told(tmp_path: Path) -> None:
    (scene,) = scenic.scenarioFromString("ego = new Object\n").sample(1, seed=2)
    line = scene_line(scene).encode()
    file = tmp_path / "scenes.jsonl"
    file.write_bytes(line + b"\r\n" + line + b"\n\xff\n")
    read = scenic.read_scenes(file)
    assert next(read).k == next(read).k == 0
    with pytest.raises(Located, match=r"line 3 .* holds no scene"):
        next(read)


def test_revived_scenes_are_as_they_were(tmp_path: Path) -> None:
    """Shapes with their parameters, turned parts, and the ego even where another object is its equal."""
    text = (
        "ego = new Object at (1, 2, 3), facing (0.5, 0.4, 0.3), with color (0.1, 0.2, 0.3), with allowCollisions True\n"
        "new Object at (9, 9, 9), with shape CylinderShape(sections=5, initial_rotation=(0.1, 0.2, 0.3))\n"
        "new Object at (-9, 9, 9), with shape CylinderShape(sections=7), with width 2\n"
    )
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=2)
    data = json.loads(scene_line(scene))
    data["objects"].insert(0, data["objects"][0])
    data["ego"] = 1
    file = tmp_path / "scenes.jsonl"
    file.write_text(json.dumps(data) + "\n")
    (read,) = scenic.read_scenes(file)
    assert read.ego is read.objects[1]
    revived = Revival().revive(read)
    assert revived.egoObject is revived.objects[1]
    for before, after in zip(scene.objects, revived.objects[1:], strict=True):
        assert tuple(after.position) == pytest.approx(tuple(before.position))
        assert after.orientation.approxEq(before.orientation)
        assert (after.yaw, after.pitch, after.roll) == pytest.approx((before.yaw, before.pitch, before.roll))
        assert (after.width, after.length, after.height) == (before.width, before.length, before.height)
        assert after.shape.mesh.vertices == pytest.approx(before.shape.mesh.vertices)
    assert [thing.color for thing in revived.objects[1:]] == [(0.1, 0.2, 0.3), None, None]


def test_what_one_scene_has_is_not_told_of_another(tmp_path: Path) -> None:
    """What is the same in all scenes is put into words once; these properties are not."""
    text = (
        "ego = new Object with tag Range(0, 1), with kind Uniform('a', 'b', 'c'), with fixed 3\n"
        "new Object at (9, 9), with shape Uniform(BoxShape(), ConeShape(), CylinderShape(sections=5))\n"
        "new Object at (-9, 9), with shape CylinderShape(), with width Range(1, 2)\n"
    )
    scenes = scenic.scenarioFromString(text).sample(8, seed=2)
    for changed in (False, True):
        lines = SceneLines(changed=changed)
        for scene in scenes:
            first, second, third = json.loads(lines.line(scene))["objects"]
            thing = scene.objects[0]
            told = first["properties"]
            assert (told["tag"], told["kind"], told["fixed"]) == (thing.tag, thing.kind, 3)
            assert second["shape"] == scene.objects[1].shape.source.as_dict()
            assert third["size"][0] == scene.objects[2].width
    assert len({scene.objects[0].tag for scene in scenes}) == 8
