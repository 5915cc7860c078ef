"""Pieces of paths in the store on disk: the curves of a map are smoothed once, and not again in each process."""

import hashlib
import json
import sys
from collections.abc import Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np

from scenic.domains.driving.path_pieces import PathPiece
from scenic.runtime.geometry.store import find, keep
from scenic.runtime.ground.library_versions import library_version

__all__ = ["PieceKey", "keep_pieces", "kept_pieces"]

PieceKey = tuple[str | bool, ...]
"""Name of a piece: how it begins and ends, and the ``uid`` of its lanes."""

_KIND: Final = "pieces of paths"
_MOST: Final = 1_500_000
"""Points of all pieces that are kept at most: 48 MB."""
_MODULES: Final = ("narrow_lanes", "path_pieces", "path_smoothing", "paths", "tight_bends")
"""Modules that decide the pieces of a network."""


@cache
def _makers() -> bytes:
    """The digest of the code and the versions that decide pieces."""
    versions = f"{sys.version} {sys.platform} {np.__version__} {library_version('scipy')}"
    digest = hashlib.sha256(versions.encode())
    for module in _MODULES:
        digest.update(Path(__file__).with_name(f"{module}.py").read_bytes())
    return digest.digest()


def kept_pieces(content: bytes, lanes: Mapping[str, Any]) -> dict[PieceKey, PathPiece]:
    """Return the pieces that an earlier run has left.

    Args:
        content: the digest of the network and of all else that pieces follow from, besides the code.
        lanes: the lanes of the network by ``uid``.

    """
    arrays = find(_KIND, content + _makers())
    if arrays is None:
        return {}
    pieces: dict[PieceKey, PathPiece] = {}
    try:
        rows, entries = arrays["rows"], json.loads(arrays["entries"].tobytes())
        begins = np.cumsum([0, *(count for _, count, _ in entries)]).tolist()
        if begins[-1] != len(rows):
            return {}
        for (key, _, marks), (begin, end) in zip(entries, pairwise(begins), strict=True):
            points, headings, curvatures = rows[begin:end, :2], rows[begin:end, 2], rows[begin:end, 3]
            marks_by_lane = tuple((index, lanes[uid]) for index, uid in marks)
            pieces[tuple(key)] = PathPiece(points, headings, curvatures, marks_by_lane)
    except (LookupError, TypeError, ValueError):
        return {}  # the file is whole, but not one that this version wrote
    return pieces


def keep_pieces(content: bytes, pieces: Mapping[PieceKey, PathPiece]) -> None:
    """Leave pieces for later runs; see `kept_pieces`."""
    if sum(len(piece.points) for piece in pieces.values()) > _MOST:
        return
    rows = [np.column_stack([piece.points, piece.headings, piece.curvatures]) for piece in pieces.values()]
    entries = [
        (key, len(piece.points), [(index, lane.uid) for index, lane in piece.lanes])
        for key, piece in pieces.items()
    ]
    text = np.frombuffer(json.dumps(entries).encode(), dtype=np.uint8)
    keep(_KIND, content + _makers(), {"rows": np.concatenate(rows), "entries": text})
