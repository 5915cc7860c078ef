"""Simulations as Parquet files (extra ``parquet``): one row for each object at each step; data about the whole simulation in the metadata.

The column ``actions`` is the JSON of what the object then did, as in JSON Lines, or null.
"""

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from scenic.formats.files import OutputError, Waiting, refusing, writing
from scenic.formats.json_lines import number, real
from scenic.language.extras import needing

__all__ = ["GROUP", "KEY", "ParquetFile", "parquet_about", "parquet_steps", "parquet_support"]

KEY: Final = b"scenic-simulation"
"""Of the metadata: a JSON object with the fields of the first line of JSON Lines."""

GROUP: Final = 1 << 15
"""Approximate number of rows kept in memory until they are written."""

_PLACES: Final = ("x", "y", "z")
_TURNS: Final = ("qx", "qy", "qz", "qw")


def parquet_support() -> tuple[Any, Any]:
    """Return the modules ``pyarrow`` and ``pyarrow.parquet``; raises `UnsupportedError` without them. They have no types, hence `Any`."""
    with needing("Parquet files need the package pyarrow", "parquet", instead="; or write JSON Lines"):
        import pyarrow
        import pyarrow.parquet  # optional, and slow to import
    return pyarrow, pyarrow.parquet


class ParquetFile:
    """A Parquet file at ``path``, in groups of rows; equal simulations give equal files.

    Groups wait in a file without a name until all is known. Raises ``OutputError`` where files cannot be written.
    """

    def __init__(self, path: Path) -> None:
        pyarrow, parquet = parquet_support()
        whole, real = pyarrow.int32(), pyarrow.float64()
        kinds = {"step": whole, "object": whole, "actions": pyarrow.string()}
        names = ("step", "time", "object", *_PLACES, *_TURNS, "actions")
        self._path = path
        self._arrow = pyarrow
        self._schema = pyarrow.schema([(name, kinds.get(name, real)) for name in names])
        self._columns: dict[str, list[Any]] = {name: [] for name in names}
        self._waiting = Waiting(path)
        try:
            with refusing(path):
                self._writer = parquet.ParquetWriter(
                    self._waiting.stream, self._schema, compression="zstd", store_schema=False
                )
        except OutputError:
            self._waiting.close()
            raise

    def add(self, state: Mapping[str, Any]) -> None:
        """The next state."""
        poses = zip(state["positions"], state["orientations"], strict=True)
        for index, (position, turn) in enumerate(poses):
            action = state["actions"].get(str(index))
            action_text = None if action is None else _text(action)
            values = (state["step"], state["time"], index, *position, *turn, action_text)
            for column, value in zip(self._columns.values(), values, strict=True):
                column.append(_number(value))
        if len(self._columns["step"]) >= GROUP:
            self._flush()

    def _flush(self) -> None:
        if not self._columns["step"]:
            return
        with refusing(self._path):
            self._writer.write_table(self._arrow.table(self._columns, schema=self._schema))
        for column in self._columns.values():
            column.clear()

    def finish(self, about: Mapping[str, object]) -> None:
        """Complete the file."""
        self._flush()
        with refusing(self._path):
            self._writer.add_key_value_metadata({KEY: _text(about).encode()})
            self._writer.close()
        with writing(self._path) as stream:
            self._waiting.copy(stream)

    def close(self) -> None:
        """Give up what is not finished."""
        with suppress(OSError):
            self._writer.close()
        self._waiting.close()


def parquet_about(path: Path) -> dict[str, Any]:
    """Return the facts about the whole simulation; raises ``ValueError`` for a file of another kind."""
    pyarrow, parquet = parquet_support()
    try:
        metadata = parquet.read_schema(path).metadata or {}
    except pyarrow.ArrowException as error:
        raise ValueError(str(error)) from error
    if KEY not in metadata:
        raise ValueError("there is no simulation in it")
    about: dict[str, Any] = json.loads(metadata[KEY])
    return about


def parquet_steps(path: Path) -> list[dict[str, Any]]:
    """The states, as `step_document` gives them."""
    _, parquet = parquet_support()
    about = parquet_about(path)
    rows: list[dict[str, Any]] = [
        {
            "step": step,
            "time": number(step * about["timestep"]),
            "positions": [],
            "orientations": [],
            "actions": {},
        }
        for step in range(about["steps"] + 1)
    ]
    table = parquet.read_table(path, use_threads=False).to_pydict()
    for index, step in enumerate(table["step"]):
        row = rows[step]
        row["positions"].append([number(table[name][index]) for name in _PLACES])
        row["orientations"].append([number(table[name][index]) for name in _TURNS])
        action = table["actions"][index]
        if action is not None:
            row["actions"][str(table["object"][index])] = json.loads(action)
    return rows


def _text(value: object) -> str:
    return json.dumps(value, allow_nan=False, separators=(",", ":"))


def _number(value: object) -> Any:
    """A number that JSON cannot hold, as it is."""
    return real(value) if isinstance(value, dict) else value
