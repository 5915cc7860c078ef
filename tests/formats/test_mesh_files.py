"""Files of scenes name mesh files so that they are found elsewhere, and changed ones are noticed."""

import json
import shutil
from pathlib import Path

import pytest
import trimesh

import scenic
from tests.cli.commands import run_here

PROGRAM = """
class Crate:
    shape: MeshShape.fromFile(localPath('meshes/crate.obj'))
ego = new Crate at (Range(0, 1), 0)
new Object at (5, 0), with shape Uniform(BoxShape(), MeshShape.fromFile(localPath('meshes/crate.obj')))
"""


@pytest.fixture
def made(tmp_path: Path) -> Path:
    """A folder with a program, its mesh, and scenes in the folder ``out``."""
    folder = tmp_path / "one"
    (folder / "meshes").mkdir(parents=True)
    trimesh.creation.icosphere(1).export(folder / "meshes" / "crate.obj")
    (folder / "crates.scenic").write_text(PROGRAM)
    (folder / "out").mkdir()
    assert (
        run_here(
            ["sample", "crates.scenic", "-n", "3", "--seed", "1", "-o", "out/s.jsonl"], folder=folder
        ).returncode
        == 0
    )
    return folder


def shapes(file: Path) -> set[str]:
    lines = file.read_text().splitlines()
    return {thing["shape"].get("path", "") for line in lines for thing in json.loads(line)["objects"]}


def test_scenes_are_the_same_in_every_clone_and_find_their_meshes(made: Path) -> None:
    assert shapes(made / "out" / "s.jsonl") == {"", "../meshes/crate.obj"}
    other = made.parent / "two"
    shutil.copytree(made, other)
    again = run_here(
        ["sample", "crates.scenic", "-n", "3", "--seed", "1", "-o", "out/again.jsonl"], folder=other
    )
    assert again.returncode == 0
    assert (other / "out" / "again.jsonl").read_bytes() == (made / "out" / "s.jsonl").read_bytes()
    shutil.rmtree(made)
    done = run_here(["view", other / "out" / "s.jsonl", "-o", other / "x.obj"])
    assert (done.returncode, done.stderr) == (0, "")
    # On the standard output they are relative to the current folder.
    done = run_here(["sample", "../crates.scenic", "--seed", "1"], folder=other / "out")
    assert json.loads(done.stdout)["objects"][0]["shape"]["path"] == "../meshes/crate.obj"
    assert (
        run_here(["view", "-", "-o", "y.obj"], folder=other / "out", text=done.stdout.encode()).stderr == ""
    )


def test_a_changed_mesh_is_an_error_and_a_missing_one_a_box(made: Path) -> None:
    mesh = made / "meshes" / "crate.obj"
    trimesh.creation.box().export(mesh)
    done = run_here(["view", made / "out" / "s.jsonl", "-o", made / "x.obj"])
    assert done.returncode == 2
    assert f"error[SC607]: the mesh file '{mesh}' has changed since the scenes were saved" in done.stderr
    mesh.unlink()
    done = run_here(["view", made / "out" / "s.jsonl", "-o", made / "x.obj"])
    assert done.returncode == 0
    assert "boxes stand for what has this form" in done.stderr


def test_older_files_have_absolute_paths_and_no_digest(made: Path) -> None:
    mesh = made / "meshes" / "crate.obj"
    (read, *_) = scenic.read_scenes(made / "out" / "s.jsonl")
    assert read.objects[0].shape["path"] == str(mesh)
    lines = []
    for line in (made / "out" / "s.jsonl").read_text().splitlines():
        document = json.loads(line)
        for thing in document["objects"]:
            if thing["shape"].pop("sha256", None):
                thing["shape"]["path"] = str(mesh)
        lines.append(json.dumps(document))
    (made / "old.jsonl").write_text("\n".join(lines))
    done = run_here(["view", made / "old.jsonl", "-o", made / "x.obj"])
    assert (done.returncode, done.stderr) == (0, "")


def test_parts_of_data_sets_name_meshes_beside_the_program(made: Path, tmp_path: Path) -> None:
    command = [
        "sample",
        "crates.scenic",
        "--seed",
        "1",
        "-n",
        "2",
        "--format",
        "jsonl",
        "-o",
        f"{tmp_path}/set/",
    ]
    assert run_here(command, folder=made).returncode == 0
    (part,) = (tmp_path / "set").glob("*.jsonl")
    assert shapes(part) <= {"", "meshes/crate.obj"}
    assert next(scenic.read_scenes(part)).objects[0].shape["path"] == str(made / "meshes" / "crate.obj")
