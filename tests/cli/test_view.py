"""``scenic view`` makes of saved scenes what ``scenic sample`` would have made of them at once."""

import json
from pathlib import Path
from typing import Any

import pytest
import trimesh
from click.testing import CliRunner, Result

import scenic
from scenic.cli.view import view
from scenic.formats.glb import glb
from scenic.formats.json_lines import scene_line
from scenic.formats.obj import obj
from scenic.language.errors import Located

PROGRAM = """
class Chair:
    width: 0.5
ego = new Object at (Range(0, 1), 2, 3), facing (Range(0, 1), 0.2, 0.1), with shape ConeShape()
c = new Chair at (9, 9), with color (1, 0, 0), with note "green", with shape CylinderShape(sections=7)
new Object at (5, 5), with shape MeshShape.fromFile(localPath("tetra.stl"), initial_rotation=(1, 0, 0)), with width 2
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made: Path = tmp_path_factory.mktemp("view")
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    trimesh.Trimesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).export(made / "tetra.stl")
    return made


@pytest.fixture(scope="module")
def scenes(folder: Path) -> list[Any]:
    found = list(scenic.scenarioFromString(PROGRAM, filename=str(folder / "p.scenic")).sample(3, seed=2))
    (folder / "scenes.jsonl").write_text("".join(scene_line(scene) + "\n" for scene in found))
    return found


def run(*arguments: object, input: str | None = None) -> Result:
    return CliRunner().invoke(view, [*map(str, arguments)], standalone_mode=False, input=input)


def test_3d_files_are_those_of_the_scenes(folder: Path, scenes: list[Any], tmp_path: Path) -> None:
    result = run(folder / "scenes.jsonl", "-o", tmp_path / "a.glb", "-o", tmp_path / "a.obj")
    assert (result.return_value, result.stderr, result.exception) == (0, "", None)
    for scene in scenes:
        name = f"a-00{scene.k}"
        assert (tmp_path / f"{name}.glb").read_bytes() == glb(scene)
        content, materials = obj(scene, f"{name}.mtl")
        assert (tmp_path / f"{name}.obj").read_bytes() == content
        assert (tmp_path / f"{name}.mtl").read_bytes() == materials
    assert len(list(tmp_path.iterdir())) == 9


def test_a_page_is_made_beside_the_scenes(folder: Path, scenes: list[Any]) -> None:
    assert run(folder / "scenes.jsonl").return_value == 0
    text = (folder / "scenes.html").read_text()
    assert "<title>scenes.jsonl" in text
    assert text.count('"class":"Chair"') == len(scenes)
    assert '"note":"green"' in text


def test_some_scenes_from_standard_input(folder: Path, scenes: list[Any], tmp_path: Path) -> None:
    lines = (folder / "scenes.jsonl").read_text()
    options = (
        "--first",
        1,
        "-n",
        1,
        "-o",
        tmp_path / "one.glb",
        "-o",
        tmp_path / "pictures",
        "--image-size",
        "32x24",
    )
    assert run("-", *options, input=lines).return_value == 0
    assert (tmp_path / "one.glb").read_bytes() == glb(scenes[1])
    (picture,) = (tmp_path / "pictures").iterdir()
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_boxes_stand_for_forms_that_are_gone(tmp_path: Path, scenes: list[Any]) -> None:
    document = json.loads(scene_line(scenes[0]))
    document["objects"][0]["shape"] = {"kind": "mesh"}
    document["objects"][1]["shape"] = {"kind": "mesh", "path": str(tmp_path / "gone.obj")}
    document["objects"][2]["shape"] = {"kind": "cloud", "path": 3}
    (tmp_path / "s.jsonl").write_text(json.dumps(document))
    result = run(tmp_path / "s.jsonl", "-o", tmp_path / "s.glb")
    assert result.return_value == 0
    warnings = result.stderr.splitlines()
    assert len(warnings) == 3
    assert "that the program itself made" in warnings[0]
    assert "gone.obj" in warnings[1]
    assert "cloud" in warnings[2]
    (loaded,) = {mesh.volume for mesh in trimesh.load_scene(tmp_path / "s.glb").geometry.values()}
    assert loaded == pytest.approx(1)


@pytest.mark.parametrize(
    ("change", "options", "message"),
    [
        ({}, ["--first", "7"], "no scene to show"),
        ({"seed": 9}, [], "several scenes of number 0, of seeds 9 and 2"),
        ({}, ["-o", "x.csv"], "'.csv'"),
        ({}, ["-o", "x.jsonl"], "'.jsonl'"),
        ({"format": "else"}, [], "line 1 .* holds no scene"),
    ],
)
def test_mistakes_are_named(
    tmp_path: Path, scenes: list[Any], change: dict[str, Any], options: list[str], message: str
) -> None:
    first = json.loads(scene_line(scenes[0])) | change
    (tmp_path / "s.jsonl").write_text(json.dumps(first) + "\n" + scene_line(scenes[0]) + "\n")
    result = run(tmp_path / "s.jsonl", *options)
    assert isinstance(result.exception, Located)
    with pytest.raises(Located, match=message):
        raise result.exception
    assert [item.name for item in tmp_path.iterdir()] == ["s.jsonl"]
