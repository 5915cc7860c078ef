"""Files of parts: rows become a file of Parquet or JSON Lines, images, shards or files of scenes, complete or absent."""

import contextlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, Protocol

from scenic.batch.image_parts import ImageSink
from scenic.batch.manifest import DatasetError, Manifest
from scenic.batch.scene_file_parts import FORMS, SceneFileSink
from scenic.formats.files import Waiting, refusing, writing
from scenic.formats.trajectory_tables import parquet_support
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["GROUP", "PartFile", "TableFile", "manifest_of_table", "part_file"]

GROUP: Final = 4096
"""Rows of a group of a Parquet file."""


class PartFile(Protocol):
    """Takes the rows of a part; its file is complete or absent. ``skipped`` counts images that scenes do not have."""

    skipped: int

    def add(self, rows: memoryview) -> None: ...

    def finish(self) -> None: ...

    def close(self) -> None: ...


def part_file(path: Path, scenario: Scenario, manifest: Manifest) -> PartFile:
    if manifest.images is not None:
        return ImageSink(path, scenario, manifest)
    if manifest.form in FORMS:
        return SceneFileSink(path, scenario, manifest)
    return _Lines(path) if manifest.form == "jsonl" else TableFile(path, scenario)


class _Lines:
    """JSON Lines that get their name when they are complete."""

    skipped = 0

    def __init__(self, path: Path) -> None:
        self._path = path
        self._waiting = Waiting(path)

    def add(self, rows: memoryview) -> None:
        self._waiting.write(bytes(rows))

    def finish(self) -> None:
        with writing(self._path) as stream:
            self._waiting.copy(stream)

    def close(self) -> None:
        self._waiting.close()


def manifest_of_table(path: Path) -> Manifest:
    """Return the manifest in a Parquet file of scenes, with the rows that the file has; raises `DatasetError` if it has none."""
    _, parquet = parquet_support()
    try:
        file = parquet.ParquetFile(path)
        document = json.loads((file.metadata.metadata or {})[b"manifest"])
    except (OSError, ValueError, KeyError) as error:  # errors of Arrow are of these types
        raise DatasetError(
            f"'{path}' cannot be read as a Parquet file of scenes",
            help="name a file that `scenic sample -o FILE.parquet` has written, or the folder of a data set",
        ) from error
    with file:
        manifest = Manifest.from_document(document, path)
        rows = file.metadata.num_rows
    return manifest if manifest.parts else replace(manifest, parts=(manifest.table_part(path.name, rows),))


class TableFile:
    """A Parquet file in groups of `GROUP` rows, which gets its name when it is complete."""

    skipped = 0

    def __init__(self, path: Path, scenario: Scenario, manifest: Manifest | None = None) -> None:
        from scenic.formats.scene_tables import SceneTable

        self._arrow, self._parquet = parquet_support()
        self._path = path
        self._waiting = Waiting(path)
        self._batches: list[Any] = []
        self._count = 0
        with refusing(path):
            self._writer = SceneTable(scenario).writer(
                self._waiting.stream, None if manifest is None else manifest.document()
            )

    def add(self, rows: memoryview) -> None:
        with self._arrow.ipc.open_stream(self._arrow.py_buffer(bytes(rows))) as stream:
            for batch in stream:
                self._batches.append(batch)
                self._count += batch.num_rows
        while self._count >= GROUP:
            self._flush(GROUP)

    def _flush(self, count: int) -> None:
        table = self._arrow.Table.from_batches(self._batches)
        with refusing(self._path):
            self._writer.write_table(table.slice(0, count).combine_chunks(), row_group_size=GROUP)
        self._batches = table.slice(count).to_batches()
        self._count -= count

    def finish(self) -> None:
        if self._count:
            self._flush(self._count)
        with refusing(self._path):
            self._writer.close()
        with writing(self._path) as stream:
            self._waiting.copy(stream)

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self._writer.close()
        self._waiting.close()
