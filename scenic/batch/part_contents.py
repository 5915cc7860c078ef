"""Contents of complete parts: their rows, the files that belong to them, and damage."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from scenic.batch.folders.folder import NAME
from scenic.batch.folders.lock import LOCK
from scenic.batch.image_parts import IMAGE_FORMS, damaged_files, image_files, image_rows
from scenic.batch.manifest import DatasetError, Manifest, Part
from scenic.batch.parts_in_progress import journal_name
from scenic.batch.scene_file_parts import FORMS, damaged_scene_files, scene_file_names, scene_file_rows
from scenic.dataclass import dataclass
from scenic.formats.coco import INDEX
from scenic.formats.mesh_files import digest_of
from scenic.formats.trajectory_tables import parquet_support

__all__ = ["Damage", "damage_of", "damages_of", "encoded_rows", "files_of", "part_rows", "strangers"]


@dataclass(frozen=True, slots=True)
class Damage:
    """A file that is missing, changed or does not belong, or a scene that its program does not give."""

    file: str
    what: str


def damage_of(folder: Path, part: Part, manifest: Manifest, *, read: bool) -> Damage | None:
    """Return the first damage of a part: by sizes, or also by content if ``read``."""
    path = folder / part.file
    try:
        size = path.stat().st_size
    except OSError:
        return Damage(part.file, "the file is missing")
    if size != part.size:
        return Damage(part.file, f"the file has {size} bytes, not {part.size}")
    if read:
        return next(damages_of(folder, part, manifest), None)
    try:
        names = files_of(folder, part, manifest.form)
    except DatasetError as error:
        return Damage(part.file, error.message)
    for name in names:
        if not (folder / name).is_file():
            return Damage(name, "the file is missing")
    return None


def damages_of(folder: Path, part: Part, manifest: Manifest) -> Iterator[Damage]:
    """Yield all damages of a part and of the files that belong to it."""
    path = folder / part.file
    if not path.is_file():
        yield Damage(part.file, "the file is missing")
    elif digest_of(path) != part.sha256:
        yield Damage(part.file, "the content has changed since it was written")
    elif manifest.form in FORMS:
        yield from (Damage(*item) for item in damaged_scene_files(folder, part))
    elif manifest.images is not None:
        yield from (Damage(*item) for item in damaged_files(folder, part, manifest.form))


def files_of(folder: Path, part: Part, form: str) -> list[str]:
    """The names of the files that belong to a part, beside its own."""
    if form == "tar":
        return [Path(part.file).with_suffix(".json").name]
    if form in IMAGE_FORMS:
        return image_files(folder / part.file)
    return scene_file_names(folder / part.file) if form in FORMS else []


def strangers(folder: Path, manifest: Manifest) -> Iterator[Path]:
    """The files in a data set's folder that do not belong to it; while it is not complete, other files than parts are not looked at."""
    names = {NAME, LOCK, *([INDEX] if manifest.images is not None else [])}
    is_known = manifest.is_complete
    for part in manifest.parts:
        names.add(part.file)
        try:
            names.update(files_of(folder, part, manifest.form))
        except DatasetError:  # a damaged index names no files
            is_known = False
    names.update(journal_name(first) for first, _ in manifest.ranges())
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if name not in names and not path.is_dir() and (is_known or name.startswith("part-")):
            yield path


def part_rows(path: Path, form: str) -> Iterator[dict[str, Any]]:
    """Yield the rows of a part, as plain data."""
    if form in IMAGE_FORMS:
        yield from image_rows(path, form)
        return
    if form in FORMS:
        yield from scene_file_rows(path)
        return
    if form == "jsonl":
        with path.open("rb") as stream:
            for line in stream:
                yield json.loads(line)
        return
    _, parquet = parquet_support()
    with parquet.ParquetFile(path) as file:
        for batch in file.iter_batches(batch_size=1024, use_threads=False):
            yield from batch.to_pylist()


def encoded_rows(encoded: bytes, form: str) -> list[dict[str, Any]]:
    """Return the rows of an `Encoder`, as plain data."""
    if form in IMAGE_FORMS:
        return list(image_rows(encoded, form))
    if form in FORMS:
        return list(scene_file_rows(encoded))
    if form == "jsonl":
        return [json.loads(line) for line in encoded.splitlines()]
    arrow, _ = parquet_support()
    with arrow.ipc.open_stream(encoded) as stream:
        rows: list[dict[str, Any]] = stream.read_all().to_pylist()
    return rows
