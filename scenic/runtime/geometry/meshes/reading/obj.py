"""Wavefront OBJ: the lines ``v x y z`` and ``f a/b/c ...``; other lines do not affect the shape."""

import re
from typing import Final

import numpy as np

from scenic.runtime.geometry.meshes.reading.soup import Soup, fans
from scenic.runtime.geometry.poses import Indices

_CONTINUED: Final = re.compile(rb"\\[ \t]*\r?\n")
_COMMENT: Final = re.compile(rb"#[^\r\n]*")
_BESIDE: Final = re.compile(rb"/[^\s]*")
"""Texture and normal numbers of a corner."""


def read_obj(data: bytes) -> Soup:
    """All faces of all objects and groups; polygons are cut into fans."""
    if b"\\" in data:
        data = _CONTINUED.sub(b" ", data)
    if b"#" in data:
        data = _COMMENT.sub(b"", data)
    lines = [line.split(None, 1) for line in data.splitlines()]
    points = [line[1] for line in lines if line[:1] == [b"v"] and len(line) == 2]
    polygons = [line[1] for line in lines if line[:1] == [b"f"] and len(line) == 2]
    places = [point.split()[:3] for point in points]
    if any(len(place) < 3 for place in places):
        raise ValueError("a vertex without three coordinates")
    vertices = np.array(places or np.empty((0, 3)), dtype=np.float64)
    corners = [_BESIDE.sub(b"", polygon).split() for polygon in polygons]
    counts = np.array([len(corner) for corner in corners], dtype=np.intp)
    numbers = np.array([number for corner in corners for number in corner] or [], dtype=np.intp)
    before = np.full(len(polygons), len(vertices), dtype=np.intp)
    if (numbers < 0).any():
        before = _vertices_before(lines)
    absolute = np.where(numbers < 0, np.repeat(before, counts) + numbers, numbers - 1)
    if len(absolute) and (absolute.min() < 0 or absolute.max() >= len(vertices)):
        raise ValueError(f"a face with a vertex outside 1 to {len(vertices)}")
    return Soup(vertices, fans(absolute, counts))


def _vertices_before(lines: list[list[bytes]]) -> Indices:
    """Return the number of vertices before each face, from which negative vertex numbers count back."""
    kinds = [line[0] for line in lines if len(line) == 2]
    is_face = np.array([kind == b"f" for kind in kinds])
    count: Indices = np.cumsum([kind == b"v" for kind in kinds])[is_face]
    return count
