"""glTF 2.0, as JSON with its buffers beside it and as one binary file: the triangles of the default scene."""

import base64
import json
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final
from urllib.parse import unquote

import numpy as np
import numpy.typing as npt

from scenic.graph import quaternions
from scenic.runtime.geometry.meshes.reading.soup import NotCoveredError, Soup, joined
from scenic.runtime.geometry.poses import Floats

_TRIANGLES: Final = 4
_TRIANGLE_STRIP: Final = 5
_KINDS: Final[Mapping[int, str]] = MappingProxyType(
    {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
)
_WIDTHS: Final[Mapping[str, int]] = MappingProxyType({"SCALAR": 1, "VEC3": 3})
_JSON: Final = b"JSON"
_BINARY: Final = b"BIN\0"
_DEEPEST: Final = 256

Neighbour = Callable[[str], bytes]
"""Reads a file by its name, relative to the one that names it."""


def read_glb(data: bytes, neighbour: Neighbour) -> Soup:
    """The one-file form: a chunk of JSON, then perhaps one with the first buffer."""
    if data[:4] != b"glTF" or len(data) < 20:
        raise ValueError("it does not begin with `glTF`")
    if int.from_bytes(data[4:8], "little") != 2:
        raise NotCoveredError("a version other than 2")
    chunks: dict[bytes, bytes] = {}
    place = 12
    while place + 8 <= len(data):
        length = int.from_bytes(data[place : place + 4], "little")
        chunks.setdefault(data[place + 4 : place + 8], data[place + 8 : place + 8 + length])
        place += 8 + length
    if _JSON not in chunks:
        raise ValueError("it has no description")
    return _Document(json.loads(chunks[_JSON]), chunks.get(_BINARY), neighbour).soup()


def read_gltf(data: bytes, neighbour: Neighbour) -> Soup:
    """The form with JSON alone."""
    return _Document(json.loads(data), None, neighbour).soup()


class _Document:
    def __init__(self, tree: Any, binary: bytes | None, neighbour: Neighbour) -> None:
        asset = tree.get("asset") if isinstance(tree, dict) else None
        if not isinstance(asset, dict) or not str(asset.get("version", "")).startswith("2"):
            raise NotCoveredError("a version other than 2")
        self._tree = tree
        self._binary = binary
        self._neighbour = neighbour
        self._buffers: dict[int, bytes] = {}

    def soup(self) -> Soup:
        try:
            return joined(self._placed())
        except (KeyError, IndexError, TypeError, AttributeError) as error:
            raise ValueError(f"its description is broken ({type(error).__name__}: {error})") from None

    def _placed(self) -> Iterator[Soup]:
        for mesh, matrix in self._instances():
            # A mirrored body is turned inside out unless its triangles are wound the other way round.
            mirrored = np.linalg.det(matrix[:3, :3]) < 0
            for primitive in mesh["primitives"]:
                part = self._primitive(primitive)
                if part is not None:
                    x, y, z = part.vertices.T
                    image = np.stack(
                        [row[0] * x + row[1] * y + row[2] * z + row[3] for row in matrix[:3]], axis=1
                    )
                    yield Soup(image, part.faces[:, ::-1] if mirrored else part.faces)

    def _instances(self) -> Iterator[tuple[Any, Floats]]:
        """The meshes of the default scene, with the matrices ``(4, 4)`` that place them."""
        nodes = self._tree.get("nodes", [])
        scenes = self._tree.get("scenes")
        if scenes:
            roots = scenes[self._tree.get("scene", 0)].get("nodes", [])
        else:
            below = {child for node in nodes for child in node.get("children", ())}
            roots = [number for number in range(len(nodes)) if number not in below]
        stack = [(root, np.eye(4), 0) for root in roots[::-1]]
        while stack:
            number, outer, depth = stack.pop()
            if depth > _DEEPEST:
                raise ValueError("its nodes go round in a circle")
            node = nodes[number]
            matrix = outer @ _placement(node)
            if "mesh" in node:
                yield self._tree["meshes"][node["mesh"]], matrix
            stack.extend((child, matrix, depth + 1) for child in node.get("children", ())[::-1])

    def _primitive(self, primitive: Any) -> Soup | None:
        """The triangles; ``None`` for points and lines."""
        mode = primitive.get("mode", _TRIANGLES)
        if mode < _TRIANGLES:
            return None
        if mode > _TRIANGLE_STRIP or primitive.get("extensions") or "targets" in primitive:
            raise NotCoveredError("a primitive with extensions or targets")
        vertices = self._accessor(primitive["attributes"]["POSITION"]).astype(np.float64)
        if "indices" in primitive:
            corners = self._accessor(primitive["indices"]).astype(np.intp).ravel()
        else:
            corners = np.arange(len(vertices), dtype=np.intp)
        if len(corners) and (corners.min() < 0 or corners.max() >= len(vertices)):
            raise ValueError(f"a triangle with a vertex outside 0 to {len(vertices) - 1}")
        if mode == _TRIANGLES:
            return Soup(vertices, corners[: len(corners) // 3 * 3].reshape(-1, 3))
        strip = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
        strip[1::2] = strip[1::2, ::-1]
        return Soup(vertices, strip)

    def _accessor(self, number: int) -> npt.NDArray[Any]:
        accessor = self._tree["accessors"][number]
        if "sparse" in accessor or "bufferView" not in accessor:
            raise NotCoveredError("a sparse accessor")
        kind, width = np.dtype(_KINDS[accessor["componentType"]]), _WIDTHS[accessor["type"]]
        if accessor.get("normalized"):
            raise NotCoveredError("normalised integers")
        view = self._tree["bufferViews"][accessor["bufferView"]]
        if view.get("extensions"):
            raise NotCoveredError("a compressed buffer")
        count, item = accessor["count"], kind.itemsize * width
        stride = view.get("byteStride", item)
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        if not count:
            return np.empty((0, width), dtype=kind)
        data = self._buffer(view["buffer"])[start : start + (count - 1) * stride + item]
        if len(data) < (count - 1) * stride + item:
            raise ValueError("a buffer ends before its last element")
        return np.ndarray((count, width), dtype=kind, buffer=data, strides=(stride, kind.itemsize))

    def _buffer(self, number: int) -> bytes:
        if number not in self._buffers:
            buffer = self._tree["buffers"][number]
            uri = buffer.get("uri")
            if uri is None:
                if self._binary is None:
                    raise ValueError("a buffer without data")
                self._buffers[number] = self._binary
            elif uri.startswith("data:"):
                self._buffers[number] = base64.b64decode(uri.partition(",")[2])
            else:
                self._buffers[number] = self._neighbour(unquote(uri))
        return self._buffers[number]


def _placement(node: Any) -> Floats:
    """The matrix ``(4, 4)`` of a node within the one above it."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    result = np.eye(4)
    turn = quaternions.to_matrix(np.array(node.get("rotation", (0, 0, 0, 1)), dtype=np.float64))
    result[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
    result[:3, 3] = node.get("translation", (0, 0, 0))
    return result
