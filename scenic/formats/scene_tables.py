"""Scenes as Parquet (extra ``parquet``): a row a scene, written in columns; ``docs/howto/datasets.md`` describes the schema.

Columns of the graph become Arrow columns without a Python object for each value. Only values that are Python objects in the
graph, too, are read scene by scene.
"""

import json
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from scenic.formats.json_lines import plain
from scenic.formats.mesh_files import MeshPaths
from scenic.formats.trajectory_tables import parquet_support
from scenic.graph.kinds import Kind
from scenic.runtime.instances.objects import Object
from scenic.runtime.scenes.columns import ObjectColumns, SceneColumns, ValueColumn
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.definite import Orientation, Vector

__all__ = ["FORMAT", "VERSION", "SceneTable"]

FORMAT: Final = "scenic-scenes"
VERSION: Final = 1
"""Of the schema; a later version may add columns, and changes none."""

_TEXT = "text"
_JSON = "json"

_KINDS: Final[Mapping[Kind, str]] = {
    Kind.SCALAR: "real",
    Kind.INTEGER: "integer",
    Kind.BOOLEAN: "boolean",
    Kind.VECTOR: "vector",
    Kind.ORIENTATION: "quaternion",
}


class SceneTable:
    """The table of a scenario's scenes.

    Raises `UnsupportedError` where pyarrow is missing.
    """

    def __init__(self, scenario: Scenario) -> None:
        arrow, self._parquet = parquet_support()
        self._arrow = arrow
        self._meshes = MeshPaths(Path(scenario.filename).parent)
        columns = SceneColumns(scenario)
        self._params = {name: _Field(arrow, [column]) for name, column in columns.params.items()}
        self._objects = columns.objects
        property_names = dict.fromkeys(key for thing in columns.objects for key in thing.given)
        self._properties = {
            key: _Field(arrow, [thing.properties[key] for thing in columns.objects if key in thing.given])
            for key in sorted(property_names)
        }
        self._object_type = arrow.struct(
            [
                ("class", arrow.string()),
                ("name", arrow.string()),
                ("position", arrow.list_(arrow.float64(), 3)),
                ("quaternion", arrow.list_(arrow.float64(), 4)),
                ("size", arrow.list_(arrow.float64(), 3)),
                ("shape", arrow.string()),
                # Parquet has no structs without fields.
                *_struct_fields(arrow, "properties", self._properties),
            ]
        )
        self.schema: Any = arrow.schema(
            [
                ("k", arrow.int64()),
                ("attempts", arrow.int64()),
                *_struct_fields(arrow, "params", self._params),
                ("objects", arrow.list_(self._object_type)),
            ]
        )
        """The Arrow schema; equal programs have equal ones."""

    def batch(self, scenes: Sequence[Scene]) -> Any:
        """Return the rows of some scenes, as a ``pyarrow.RecordBatch``."""
        arrow = self._arrow
        params = [field.array(scenes, [True]) for field in self._params.values()]
        columns = [
            arrow.array([scene.k for scene in scenes], arrow.int64()),
            arrow.array([scene.attempts for scene in scenes], arrow.int64()),
            *([_struct(arrow, self.schema.field("params").type, params)] if params else []),
            self._all_objects(scenes),
        ]
        return arrow.RecordBatch.from_arrays(columns, schema=self.schema)

    def encoded(self, scenes: Sequence[Scene]) -> bytes:
        """Return the rows of some scenes, as the bytes of an Arrow stream."""
        sink = self._arrow.BufferOutputStream()
        with self._arrow.ipc.new_stream(sink, self.schema) as stream:
            stream.write_batch(self.batch(scenes))
        return bytes(sink.getvalue())

    def writer(self, stream: BinaryIO, manifest: Mapping[str, Any] | None = None) -> Any:
        """Return a ``pyarrow.parquet.ParquetWriter`` of such rows; equal rows and manifests give equal files."""
        metadata = {FORMAT: str(VERSION)}
        if manifest is not None:
            metadata["manifest"] = _json(manifest)
        writer = self._parquet.ParquetWriter(stream, self.schema, compression="zstd", store_schema=False)
        writer.add_key_value_metadata(metadata)
        return writer

    def _all_objects(self, scenes: Sequence[Scene]) -> Any:
        arrow, things, count = self._arrow, self._objects, len(scenes)
        kind = self._object_type
        properties = [
            field.array(scenes, [key in thing.given for thing in things])
            for key, field in self._properties.items()
        ]
        parts = [
            self._repeated([thing.cls for thing in things], count),
            self._repeated([thing.name for thing in things], count),
            self._rows(scenes, kind.field("position").type, 3, _positions),
            self._rows(scenes, kind.field("quaternion").type, 4, _quaternions),
            self._rows(scenes, kind.field("size").type, 3, _sizes),
            self._shapes(scenes),
            *([_struct(arrow, kind.field("properties").type, properties)] if properties else []),
        ]
        rows = _struct(arrow, kind, parts)
        there = np.ones((count, len(things)), dtype=np.bool_)
        for place, thing in enumerate(things):
            there[:, place] = _numbers(thing.present, scenes)
        if not there.all():
            rows = rows.filter(arrow.array(there.ravel()))
        offsets = np.concatenate([[0], np.cumsum(there.sum(axis=1))]).astype(np.int32)
        return arrow.ListArray.from_arrays(arrow.array(offsets), rows, type=arrow.list_(kind))

    def _repeated(self, words: Sequence[str | None], count: int) -> Any:
        codes = np.tile(np.arange(len(words), dtype=np.int32), count)
        return self._arrow.array(words, self._arrow.string()).take(self._arrow.array(codes))

    def _rows(
        self,
        scenes: Sequence[Scene],
        kind: object,
        width: int,
        read: Callable[[ObjectColumns, Sequence[Scene]], NDArray[np.float64]],
    ) -> Any:
        """Rows of numbers of each object in each scene, ``(n * m, width)``."""
        rows = np.empty((len(scenes), len(self._objects), width))
        for place, thing in enumerate(self._objects):
            rows[:, place] = read(thing, scenes)
        rows += 0.0  # no negative zeros
        return self._arrow.FixedSizeListArray.from_arrays(self._arrow.array(rows.ravel()), type=kind)

    def _shapes(self, scenes: Sequence[Scene]) -> Any:
        arrow = self._arrow
        columns = [thing.properties["shape"] for thing in self._objects]
        if all(column.is_fixed for column in columns):
            return self._repeated(
                [_json(self._meshes.told(column.value.source)) for column in columns], len(scenes)
            )
        rows = [
            [_json(self._meshes.told(shape.source)) for shape in column.values(scenes)] for column in columns
        ]
        return arrow.array([text for row in zip(*rows, strict=True) for text in row], arrow.string())


class _Field:
    """A property of the objects that have it (or a parameter, of the scene alone) as one Arrow column.

    Its type follows from the program: numbers, vectors, quaternions and text have types of their own where all objects
    agree, anything else is text that holds JSON.
    """

    def __init__(self, arrow: Any, columns: Sequence[ValueColumn]) -> None:
        self._arrow = arrow
        self._columns = tuple(columns)
        words = {_word(column) for column in columns} - {"nothing"}
        self._word = _common(words) if words else "boolean"
        self.type = _type(arrow, self._word)

    def array(self, scenes: Sequence[Scene], has: Sequence[bool]) -> Any:
        """Return the values, scene by scene; null where an object lacks the property.

        Args:
            scenes: the scenes.
            has: which objects have it, ``(m,)``.

        """
        width = {"vector": 3, "quaternion": 4}.get(self._word, 0)
        if self._word in (_JSON, _TEXT):
            return self._texts(scenes, has)
        dtype = {"integer": np.int64, "boolean": np.bool_}.get(self._word, np.float64)
        rows: NDArray[Any] = np.zeros(
            (len(scenes), len(has), width) if width else (len(scenes), len(has)), dtype=dtype
        )
        missing = np.ones((len(scenes), len(has)), dtype=np.bool_)
        columns = iter(self._columns)
        for place, there in enumerate(has):
            if not there:
                continue
            column = next(columns)
            if _word(column) == "nothing":
                continue
            missing[:, place] = False
            rows[:, place] = _numbers(column, scenes)
        if not width:
            return self._arrow.array(rows.ravel(), self.type, mask=missing.ravel())
        flat = self._arrow.array(rows.reshape(-1) + 0.0)  # no negative zeros
        return self._arrow.FixedSizeListArray.from_arrays(
            flat, type=self.type, mask=self._arrow.array(missing.ravel())
        )

    def _texts(self, scenes: Sequence[Scene], has: Sequence[bool]) -> Any:
        columns = iter(self._columns)
        count = len(scenes)
        rows: list[list[str | None]] = []
        numbers: list[dict[int, int]] | None = None
        for there in has:
            if not there:
                rows.append([None] * count)
                continue
            column = next(columns)
            if self._word == _TEXT:
                rows.append(
                    [None if text is None else _LONE.sub("\ufffd", text) for text in column.values(scenes)]
                )
            elif column.is_fixed and not _names_objects(column.value):
                rows.append([_json(plain(column.value, {}))] * count)
            else:
                if numbers is None:
                    numbers = [
                        {id(thing): index for index, thing in enumerate(scene.objects)} for scene in scenes
                    ]
                values = [column.read(scene) for scene in scenes]
                rows.append([_json(plain(*pair)) for pair in zip(values, numbers, strict=True)])
        return self._arrow.array([text for row in zip(*rows, strict=True) for text in row], self.type)


_LONE: Final = re.compile("[\ud800-\udfff]")
"""Lone halves of characters, which UTF-8 cannot hold."""


def _names_objects(value: object) -> bool:
    """Return whether a fixed value has objects in it, whose numbers are those of a scene."""
    if isinstance(value, Mapping):
        value = (*value, *value.values())
    if isinstance(value, (list, tuple, set, frozenset)):
        return any(map(_names_objects, value))
    return isinstance(value, Object)


def _word(column: ValueColumn) -> str:
    """Return the type of a column's values, in a word."""
    if column.kind is not None:
        return _KINDS[column.kind]
    values = (column.value,) if column.is_fixed else column.options
    return _common({_word_of(value) for value in values})


def _common(words: set[str]) -> str:
    """Return the type that holds values of all of these types."""
    if words == {"integer", "real"}:
        return "real"
    return next(iter(words)) if len(words) == 1 else _JSON


def _word_of(value: object) -> str:
    match value:
        case None:
            return "nothing"
        case bool() | np.bool_():
            return "boolean"
        case int() | np.integer():
            return "integer" if abs(int(value)) < 1 << 62 else _JSON
        case float() | np.floating():
            return "real"
        case str():
            return _TEXT
        case Vector():
            return "vector"
        case Orientation():
            return "quaternion"
    return _JSON


def _type(arrow: Any, word: str) -> Any:
    return {
        "boolean": arrow.bool_(),
        "integer": arrow.int64(),
        "real": arrow.float64(),
        "vector": arrow.list_(arrow.float64(), 3),
        "quaternion": arrow.list_(arrow.float64(), 4),
        _TEXT: arrow.string(),
        _JSON: arrow.string(),
    }[word]


def _numbers(column: ValueColumn, scenes: Sequence[Scene]) -> Any:
    if column.kind is not None:
        return column.array(scenes)
    if column.is_fixed:
        return _row(column.value)
    return [_row(value) for value in column.values(scenes)]


def _row(value: object) -> Any:
    """A number, or the numbers of a vector or an orientation."""
    if isinstance(value, Orientation):
        return (value.x, value.y, value.z, value.w)
    return tuple(value) if isinstance(value, Vector) else value


def _positions(thing: ObjectColumns, scenes: Sequence[Scene]) -> NDArray[np.float64]:
    return np.asarray(_numbers(thing.properties["position"], scenes), dtype=np.float64)


def _quaternions(thing: ObjectColumns, scenes: Sequence[Scene]) -> NDArray[np.float64]:
    rows = np.atleast_2d(np.asarray(_numbers(thing.properties["orientation"], scenes), dtype=np.float64))
    return np.where(rows[:, 3:] < 0, -rows, rows)


def _sizes(thing: ObjectColumns, scenes: Sequence[Scene]) -> NDArray[np.float64]:
    parts = [_numbers(thing.properties[name], scenes) for name in ("width", "length", "height")]
    return np.stack(np.broadcast_arrays(*(np.asarray(part, dtype=np.float64) for part in parts)), axis=-1)


def _struct_fields(arrow: Any, name: str, fields: Mapping[str, _Field]) -> list[tuple[str, Any]]:
    return [(name, arrow.struct([(key, field.type) for key, field in fields.items()]))] if fields else []


def _struct(arrow: Any, kind: Any, parts: Sequence[object]) -> Any:
    return arrow.StructArray.from_arrays(parts, fields=list(kind))


def _json(value: object) -> str:
    return json.dumps(value, allow_nan=False, separators=(",", ":"))
