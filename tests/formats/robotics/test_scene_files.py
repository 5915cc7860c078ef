"""Files of one scene: what goes wrong leaves nothing behind."""

import sys
from pathlib import Path

import pytest

import scenic
from scenic.formats.imaging import MissingLibraryError
from scenic.formats.robotics.scene_files import write_scene
from scenic.language.errors import Located
from tests.cli.commands import run_here
from tests.formats.robotics.example import scenes

PROGRAM = "ego = new Object with shape ConeShape()\n"


def test_without_its_extra_a_format_is_refused_before_anything_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pxr", None)
    monkeypatch.setitem(sys.modules, "pxr.Usd", None)
    (scene,) = scenic.scenarioFromString(PROGRAM).sample(1, seed=1)
    with pytest.raises(MissingLibraryError, match="usd-core") as caught:
        scene.save(tmp_path / "scene.usda")
    assert "scenic-lang[usd]" in (caught.value.help or "")
    (tmp_path / "program.scenic").write_text(PROGRAM)
    done = run_here(["sample", "program.scenic", "-n", 1, "--format", "usd", "-o", "out/"], folder=tmp_path)
    assert done.returncode == 2
    assert "usd-core" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["program.scenic"]


@pytest.mark.parametrize("name", ["scene.sdf", "scene.xml", "scene.usda"])
def test_a_target_that_cannot_be_written_leaves_nothing(name: str, tmp_path: Path) -> None:
    if name.endswith(".usda"):
        pytest.importorskip("pxr")
    (tmp_path / "file").write_text("x")
    with pytest.raises((Located, OSError)):
        scenes(1)[0].save(tmp_path / "file" / name)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize("failing", [0, 1, -1])
def test_a_failure_in_the_middle_leaves_nothing(
    failing: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from scenic.formats.robotics import scene_files

    whole = tmp_path / "whole"
    whole.mkdir()
    write_scene(scenes(1)[0], whole / "scene.sdf")
    count = sum(path.is_file() for path in whole.rglob("*"))
    calls = 0

    def write(path: Path, content: bytes) -> None:
        nonlocal calls
        calls += 1
        if calls == (failing % count) + 1:
            raise OSError(28, "No space left on device")
        path.write_bytes(content)

    monkeypatch.setattr(scene_files, "write", write)
    broken = tmp_path / "broken"
    broken.mkdir()
    with pytest.raises(OSError, match="No space"):
        write_scene(scenes(1)[0], broken / "scene.sdf")
    assert not [path for path in broken.rglob("*") if path.is_file()]


def test_a_file_in_the_place_of_the_folder_of_meshes_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "assets").write_text("mine")
    with pytest.raises(Located):
        write_scene(scenes(1)[0], tmp_path / "scene.sdf")
    assert [path.name for path in tmp_path.iterdir()] == ["assets"]
    assert (tmp_path / "assets").read_text() == "mine"
