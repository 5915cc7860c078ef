"""Pieces of paths that are kept on disk: those read are those made, and bad files cost only time."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenic.domains.driving import paths, piece_store
from scenic.domains.driving.roads import Network
from tests.maps import cross


@pytest.fixture
def road_map(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SCENIC_CACHE", "on")
    monkeypatch.setenv("SCENIC_CACHE_DIR", str(tmp_path / "store"))
    monkeypatch.setattr(paths, "_WORTH", 0.0)
    monkeypatch.setattr(paths, "_SHARE", 0.0)
    file = tmp_path / "cross.xodr"
    file.write_text(cross())
    return file


def pieces_of(road_map: Path, **options: Any) -> list[Any]:
    """All pieces through the intersection of a map, as a process has them that finds the store as it is now."""
    network = Network.fromFile(road_map)
    pieces = paths.PathPieces(origin=network.origin, lanes=network.elements, **options)
    ways = [(way.startLane, way.connectingLane, way.endLane) for way in network.maneuvers]
    assert ways
    return [pieces.between(way, opens=True, closes=True) for way in ways]


def equal(one: Any, other: Any) -> bool:
    lanes = [[(index, lane.uid) for index, lane in piece.lanes] for piece in (one, other)]
    names = ("points", "headings", "curvatures")
    return lanes[0] == lanes[1] and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in names
    )


def no_smoothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(paths, "smoothed", lambda *given, **named: pytest.fail("smoothed again"))


def test_pieces_are_those_of_another_run(road_map: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = pieces_of(road_map)
    with monkeypatch.context() as patch:
        no_smoothing(patch)
        second = pieces_of(road_map)
        # Other pieces are other files.
        with pytest.raises(pytest.fail.Exception):
            pieces_of(road_map, tightest=0.1)
    assert all(map(equal, first, second))
    monkeypatch.setenv("SCENIC_CACHE", "off")
    assert all(map(equal, first, pieces_of(road_map)))


@pytest.mark.parametrize("part", ["entries", "rows"])
def test_bad_files_cost_only_time(road_map: Path, monkeypatch: pytest.MonkeyPatch, part: str) -> None:
    first = pieces_of(road_map)
    find = piece_store.find

    def damaged(kind: str, content: bytes) -> Any:
        arrays = find(kind, content)
        return arrays and {name: array[:-40] if name == part else array for name, array in arrays.items()}

    monkeypatch.setattr(piece_store, "find", damaged)
    with monkeypatch.context() as patch:
        no_smoothing(patch)
        with pytest.raises(pytest.fail.Exception):
            pieces_of(road_map)
    assert all(map(equal, first, pieces_of(road_map)))
    monkeypatch.setattr(piece_store, "_MOST", 0)
    piece_store.keep_pieces(b"too many", {("start", "lane"): first[0]})
    assert find("pieces of paths", b"too many" + piece_store._makers()) is None
