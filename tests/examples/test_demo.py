import os
from pathlib import Path

import pytest
import trimesh

from examples import demo


def test_the_demo_leaves_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # As `make demo` runs it, but for the numbers and sizes of what it makes.
    monkeypatch.setattr(demo, "ROOMS", 2)
    monkeypatch.setattr(demo, "PICTURES_OF_ROOMS", 1)
    monkeypatch.setattr(demo, "PICTURE", (96, 72))
    folder = tmp_path / "out"
    demo.main([str(folder)])
    shown = capsys.readouterr().out
    found = set(os.listdir(folder))
    assert {"scenes.jsonl", "rooms.html", "room.glb", "room-0.png", "tilted_cube.png"} <= found
    assert all(str(folder / name) in shown for name in found)
    assert len(trimesh.load_scene(folder / "room.glb").graph.nodes_geometry) == 20
    assert (folder / "room-0.png").read_bytes()[:4] == b"\x89PNG"


def test_a_folder_that_cannot_be_used_is_said_so(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(SystemExit, match="cannot be used"):
        demo.main([str(tmp_path / "file")])
