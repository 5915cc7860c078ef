import os
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_the_demo_leaves_what_it_says(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    result = subprocess.run(
        [sys.executable, "-m", "examples.demo", str(folder)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    found = set(os.listdir(folder))
    assert {"scenes.jsonl", "rooms.html", "room.glb", "room-0.png", "tilted_cube.png"} <= found
    assert all(str(folder / name) in result.stdout for name in found)
    assert len(trimesh.load_scene(folder / "room.glb").graph.nodes_geometry) == 20
    assert (folder / "room-0.png").read_bytes()[:4] == b"\x89PNG"


def test_a_folder_that_cannot_be_used_is_said_so(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    result = subprocess.run(
        [sys.executable, "-m", "examples.demo", str(tmp_path / "file")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 1
    assert "cannot be used" in result.stderr
    assert "Traceback" not in result.stderr
