"""Stanford PLY, text and binary: the elements ``vertex`` and ``face``."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.reading.soup import NotCoveredError, Soup, fans
from scenic.runtime.geometry.poses import Indices

_TYPES: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(("char", "int8"), "i1"),
        **dict.fromkeys(("uchar", "uint8"), "u1"),
        **dict.fromkeys(("short", "int16"), "i2"),
        **dict.fromkeys(("ushort", "uint16"), "u2"),
        **dict.fromkeys(("int", "int32"), "i4"),
        **dict.fromkeys(("uint", "uint32"), "u4"),
        **dict.fromkeys(("float", "float32"), "f4"),
        **dict.fromkeys(("double", "float64"), "f8"),
    }
)
_ORDERS: Final[Mapping[str, str]] = MappingProxyType(
    {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
)
_CORNERS: Final = ("vertex_indices", "vertex_index")


@dataclass(frozen=True, slots=True)
class _Property:
    name: str
    kind: str
    length: str | None = None
    """The type of a list's length; ``None`` for single values."""


@dataclass(frozen=True, slots=True)
class _Element:
    name: str
    count: int
    properties: list[_Property]


def read_ply(data: bytes) -> Soup:
    """The faces, polygons cut into fans."""
    order, elements, body = _header(data)
    columns: dict[tuple[str, str], npt.NDArray[Any]] = {}
    counts: Indices | None = None
    values = np.array(data[body:].split(), dtype=np.float64) if not order else None
    place = 0 if values is not None else body
    missing = {"vertex", "face"}
    for element in elements:
        if not missing:
            break  # what comes behind them may be of any form
        missing.discard(element.name)
        lists = [item for item in element.properties if item.length is not None]
        if not lists:
            if values is not None:
                table, place = _text_rows(values, place, element)
            else:
                table, place = _binary_rows(data, place, element, order)
            columns.update({(element.name, name): column for name, column in table.items()})
        elif element.name == "face" and [item.name in _CORNERS for item in lists] == [True]:
            if values is not None:
                corners, counts, place = _text_lists(values, place, element)
            else:
                corners, counts, place = _binary_lists(data, place, element, order)
        else:
            raise NotCoveredError(f"element `{element.name}`")
    if counts is None:
        raise ValueError("no faces")
    try:
        points = np.stack([columns["vertex", axis] for axis in "xyz"], axis=1).astype(np.float64)
    except KeyError:
        raise ValueError("no vertices with `x`, `y` and `z`") from None
    if len(corners) and (corners.min() < 0 or corners.max() >= len(points)):
        raise ValueError(f"a face with a vertex outside 0 to {len(points) - 1}")
    return Soup(points, fans(corners, counts))


def _header(data: bytes) -> tuple[str, list[_Element], int]:
    """The byte order (empty for text), the elements, and where the data begin."""
    if not data.startswith(b"ply"):
        raise ValueError("it does not begin with `ply`")
    marker = data.find(b"end_header")
    end = data.find(b"\n", marker)
    if marker < 0 or end < 0:
        raise ValueError("its header has no end")
    order: str | None = None
    elements: list[_Element] = []
    for line in data[:marker].decode("latin-1").splitlines():
        match line.split():
            case ["format", kind, _] if kind in _ORDERS:
                order = _ORDERS[kind]
            case ["element", name, count] if int(count) >= 0:
                elements.append(_Element(name, int(count), []))
            case ["property", "list", length, kind, name] if elements and {length, kind} <= _TYPES.keys():
                elements[-1].properties.append(_Property(name, _TYPES[kind], _TYPES[length]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append(_Property(name, _TYPES[kind]))
            case ["ply"] | ["comment", *_] | ["obj_info", *_] | []:
                pass
            case _:
                raise ValueError(f"its header has the line `{line}`")
    if order is None:
        raise ValueError("its header names no known format")
    return order, elements, end + 1


_Table = dict[str, npt.NDArray[Any]]


def _text_rows(values: npt.NDArray[np.float64], place: int, element: _Element) -> tuple[_Table, int]:
    width = len(element.properties)
    rows = _enough(values[place : place + element.count * width], element.count * width).reshape(-1, width)
    # Numbers written out are of the declared type nevertheless.
    table = {item.name: rows[:, number].astype(item.kind) for number, item in enumerate(element.properties)}
    return table, place + rows.size


def _binary_rows(data: bytes, place: int, element: _Element, order: str) -> tuple[_Table, int]:
    record = np.dtype([(item.name, order + item.kind) for item in element.properties])
    end = place + element.count * record.itemsize
    rows = np.frombuffer(_enough(data[place:end], end - place), dtype=record)
    return {item.name: rows[item.name] for item in element.properties}, end


def _text_lists(
    values: npt.NDArray[np.float64], place: int, element: _Element
) -> tuple[Indices, Indices, int]:
    before, after = _around_list(element)
    if element.count > len(values) - place:  # each takes a value at least
        raise ValueError("it ends before its last face")
    starts = np.empty(element.count, dtype=np.intp)
    counts = np.empty(element.count, dtype=np.intp)
    for number in range(element.count):
        place += len(before)
        if place >= len(values):
            raise ValueError("it ends before its last face")
        starts[number], counts[number] = place + 1, values[place]
        place += 1 + int(counts[number]) + len(after)
    if place > len(values) or (counts < 0).any():
        raise ValueError("it ends before its last face")
    first = np.repeat(starts, counts)
    offset = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    return values[first + offset].astype(np.intp), counts, place


def _binary_lists(data: bytes, place: int, element: _Element, order: str) -> tuple[Indices, Indices, int]:
    before, after = _around_list(element)
    corners = next(item for item in element.properties if item.length is not None)
    lead = np.dtype([(f"b{i}", order + item.kind) for i, item in enumerate(before)])
    tail = np.dtype([(f"a{i}", order + item.kind) for i, item in enumerate(after)])
    length = np.dtype(order + str(corners.length))
    number = np.dtype(order + corners.kind)
    # Nearly always all faces are triangles.
    record = np.dtype([("lead", lead), ("length", length), ("corners", number, 3), ("tail", tail)])
    end = place + element.count * record.itemsize
    if end <= len(data):
        rows = np.frombuffer(data[place:end], dtype=record)
        if (rows["length"] == 3).all():
            return rows["corners"].astype(np.intp).ravel(), np.full(element.count, 3, dtype=np.intp), end
    if element.count * length.itemsize > len(data) - place:
        raise ValueError("it ends before its last face")
    parts, counts = [], np.empty(element.count, dtype=np.intp)
    for face in range(element.count):
        place += lead.itemsize
        size = int(np.frombuffer(_enough(data[place : place + length.itemsize], length.itemsize), length)[0])
        if size < 0:
            raise ValueError(f"a face of {size} vertices")
        place += length.itemsize
        width = size * number.itemsize
        parts.append(np.frombuffer(_enough(data[place : place + width], width), number))
        counts[face] = size
        place += width + tail.itemsize
    return np.concatenate([np.empty(0, dtype=np.intp), *parts]).astype(np.intp), counts, place


def _around_list(element: _Element) -> tuple[list[_Property], list[_Property]]:
    """The single values before and after the list of corners."""
    place = next(i for i, item in enumerate(element.properties) if item.length is not None)
    return element.properties[:place], element.properties[place + 1 :]


def _enough(part: Any, length: int) -> Any:  # bytes and arrays alike
    if len(part) < length:
        raise ValueError("it ends before its last element")
    return part
