"""Convex parts that are searched for before a program is simulated."""

from pathlib import Path

import pytest
import trimesh

import scenic
from scenic.batch.part_search import meshes_without_parts, search_parts
from scenic.runtime.geometry.meshes.convex_parts import convex_parts

pytest.importorskip("coacd")


def test_parts_of_round_hollows_are_searched_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCENIC_CACHE", "on")
    monkeypatch.setenv("SCENIC_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(
        "scenic.runtime.geometry.meshes.convex_parts._SEARCH",
        {"mcts_iterations": 10, "resolution": 200, "seed": 0},
    )
    box = trimesh.creation.box((1, 1, 0.9))
    hollow = trimesh.creation.icosphere(2, 0.42).apply_translation((0, 0, 0.45))
    trimesh.boolean.difference([box, hollow]).export(tmp_path / "bowl.obj")
    shelf = Path(__file__).parents[2] / "examples" / "meshes" / "shelf.obj"
    text = f"""
shape = MeshShape.fromFile({str(tmp_path / "bowl.obj")!r})
ego = new Object with shape Uniform(shape, BoxShape())
new Object at (5, 0), with shape shape
new Object at (9, 0), with shape MeshShape.fromFile({str(shelf)!r})
"""
    scenario = scenic.scenarioFromString(text)
    (mesh,) = meshes_without_parts(scenario)  # the shelf has exact parts
    calls = []
    search_parts([mesh], lambda *numbers: calls.append(numbers))
    assert calls == [(1, 0)]
    assert meshes_without_parts(scenario) == []
    assert len(convex_parts(mesh)) > 1
