"""Simulations as Parquet files (extra ``parquet``): one row for each object at each step; what is said of the whole in the metadata.

The column ``actions`` is the JSON of what the object then did, as in JSON Lines, or null.
"""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final

from scenic.formats.json_lines import number
from scenic.language.errors import UnsupportedError

__all__ = ["KEY", "parquet_about", "parquet_bytes", "parquet_steps", "parquet_support"]

KEY: Final = b"scenic-simulation"
"""Of the metadata: a JSON object with the fields of the first line of JSON Lines."""

_PLACES: Final = ("x", "y", "z")
_TURNS: Final = ("qx", "qy", "qz", "qw")


def parquet_support() -> tuple[Any, Any]:
    """The modules ``pyarrow`` and ``pyarrow.parquet``; raises `UnsupportedError` without them. They have no types, hence `Any`."""
    try:
        import pyarrow
        import pyarrow.parquet  # optional, and slow to import
    except ImportError as error:
        raise UnsupportedError(
            "Parquet files need the package pyarrow",
            help="install scenic-lang[parquet], or write JSON Lines",
        ) from error
    return pyarrow, pyarrow.parquet


def parquet_bytes(about: Mapping[str, Any], steps: Iterable[Mapping[str, Any]]) -> bytes:
    """The file of a simulation: of `course_document` and `step_documents`; equal simulations give equal bytes."""
    pyarrow, parquet = parquet_support()
    columns: dict[str, list[Any]] = {
        name: [] for name in ("step", "time", "object", *_PLACES, *_TURNS, "actions")
    }
    for row in steps:
        poses = zip(row["positions"], row["orientations"], strict=True)
        for index, (position, turn) in enumerate(poses):
            done = row["actions"].get(str(index))
            values = (
                row["step"],
                row["time"],
                index,
                *position,
                *turn,
                None if done is None else _text(done),
            )
            for column, value in zip(columns.values(), values, strict=True):
                column.append(_number(value))
    whole, real = pyarrow.int32(), pyarrow.float64()
    kinds = {"step": whole, "object": whole, "actions": pyarrow.string()}
    schema = pyarrow.schema(
        [(name, kinds.get(name, real)) for name in columns], metadata={KEY: _text(about).encode()}
    )
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.table(columns, schema=schema), sink, compression="zstd")
    data: bytes = sink.getvalue().to_pybytes()
    return data


def parquet_about(path: Path) -> dict[str, Any]:
    """What is said of the whole simulation; raises ``ValueError`` for a file that is none of ours."""
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
    """The states, as `step_documents` gives them."""
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
        done = table["actions"][index]
        if done is not None:
            row["actions"][str(table["object"][index])] = json.loads(done)
    return rows


def _text(value: Any) -> str:
    return json.dumps(value, allow_nan=False, separators=(",", ":"))


def _number(value: Any) -> Any:
    """A number that JSON cannot hold, as it is."""
    return float(value["$float"]) if isinstance(value, dict) else value
