"""STL, binary and text: triangles one after the other, each with its own corners."""

import re
from typing import Final

import numpy as np

from scenic.runtime.geometry.meshes.reading.soup import Soup

_HEADER: Final = 84
_RECORD: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
_VERTEX: Final = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)


def read_stl(data: bytes) -> Soup:
    """The triangles of all solids. A file is binary if its length agrees with its number of triangles."""
    if len(data) >= _HEADER:
        count = int.from_bytes(data[_HEADER - 4 : _HEADER], "little")
        if len(data) == _HEADER + count * _RECORD.itemsize:
            corners = np.frombuffer(data, dtype=_RECORD, offset=_HEADER)["corners"]
            return _soup(corners.astype(np.float64).reshape(-1, 3))
    if not data.lstrip()[:5].lower() == b"solid":
        raise ValueError(
            "neither a text that begins with `solid`, nor as long as its number of triangles says"
        )
    found = _VERTEX.findall(data)
    if len(found) % 3:
        raise ValueError("a triangle without three corners")
    return _soup(np.array(found or np.empty((0, 3)), dtype=np.float64))


def _soup(corners: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Soup:
    return Soup(corners, np.arange(len(corners), dtype=np.intp).reshape(-1, 3))
