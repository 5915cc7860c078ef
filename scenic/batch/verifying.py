"""Checks of data sets: every part against its digest, and a share of the scenes against the program."""

import json
import math
import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from scenic.batch.datasets import Encoder
from scenic.batch.image_parts import IMAGE_FORMS, copy_images, damaged_files, image_rows, join_indices
from scenic.batch.manifest import DatasetError, Manifest, Part
from scenic.batch.scene_file_parts import FORMS, copy_scene_files, damaged_scene_files, scene_file_rows
from scenic.batch.scenes import Job, method_of, results_of
from scenic.batch.source_files import mesh_digests, texture_digests
from scenic.dataclass import dataclass
from scenic.formats.files import make_folder, write
from scenic.formats.mesh_files import digest_of
from scenic.formats.trajectory_tables import parquet_support
from scenic.runtime.sampling.report import Exhausted
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["Damage", "merge", "part_rows", "verify"]


@dataclass(frozen=True, slots=True)
class Damage:
    """A part that is missing or changed, or a scene that its program does not give."""

    file: str
    what: str


def verify(
    folder: Path,
    scenario: Scenario | None,
    *,
    share: float = 0.01,
    advance: Callable[[int], None] = lambda _: None,
) -> Iterator[Damage]:
    """The faults of a data set.

    Args:
        folder: the data set.
        scenario: its program, compiled with the same options; without it no scene is made again.
        share: the share of scenes of each part that are made again, 0 to 1; at least one.
        advance: told how many more scenes have been compared.

    Raises:
        DatasetError: if there is no data set, or ``scenario`` is of another program or other options.

    """
    manifest = Manifest.load(folder)
    if scenario is not None and (scenario.digest, scenario.fingerprint) != (
        manifest.digest,
        manifest.fingerprint,
    ):
        raise DatasetError(
            f"the data set in '{folder}' is of another program, or of the same with other options or meshes",
            help="give the program as it was when the data set was made",
        )
    if scenario is not None:
        found = {**mesh_digests(scenario), **texture_digests(scenario)}
        for name, digest in {**manifest.meshes, **manifest.textures}.items():
            if found.get(name) != digest:
                raise DatasetError(
                    f"the data set in '{folder}' was made with another file '{name}'",
                    help="put the file back that it was made with",
                )
    for part in manifest.parts:
        path = folder / part.file
        if not path.is_file():
            yield Damage(part.file, "the file is missing")
            continue
        if digest_of(path) != part.sha256:
            yield Damage(part.file, "the content has changed since it was written")
            continue
        if manifest.images is not None or manifest.form in FORMS:
            found_damages = (
                damaged_scene_files(folder, part)
                if manifest.form in FORMS
                else damaged_files(folder, part, manifest.form)
            )
            damages = [Damage(*item) for item in found_damages]
            yield from damages
            if damages:
                continue
        if scenario is not None and share > 0:
            yield from _compared(scenario, manifest, part, path, share, advance)


def _compared(
    scenario: Scenario,
    manifest: Manifest,
    part: Part,
    path: Path,
    share: float,
    advance: Callable[[int], None],
) -> Iterator[Damage]:
    chosen = random.Random(part.sha256).sample(
        range(part.first, part.last), min(part.last - part.first, math.ceil(share * (part.last - part.first)))
    )
    kept = {row["k"]: row for row in part_rows(path, manifest.form)}
    encoder = Encoder.of(manifest)
    method = method_of(manifest.points)
    for k in sorted(chosen):
        job = Job(manifest.seed, k, k + 1, manifest.max_attempts, None, **method)
        (result,) = results_of(scenario, job)
        advance(1)
        if isinstance(result, Exhausted):
            if k in kept:
                yield Damage(part.file, f"scene {k} is there, and the program does not find it")
            continue
        (again,) = _rows(encoder.rows(scenario, [result]), manifest.form)
        if k not in kept:
            yield Damage(part.file, f"scene {k} is missing")
        elif kept[k] != again:
            yield Damage(part.file, f"scene {k} differs from that of the program")


def part_rows(path: Path, form: str) -> Iterator[dict[str, Any]]:
    """The rows of a part, as plain data."""
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


def _rows(encoded: bytes, form: str) -> list[dict[str, Any]]:
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


def merge(folders: Sequence[Path], target: Path) -> Manifest:
    """Join data sets of one program and seed whose scenes have different numbers; the parts are copied.

    Raises:
        DatasetError: if they do not fit together, or a part is damaged.
        OutputError: if files cannot be written.

    """
    manifests = [(folder, Manifest.load(folder)) for folder in folders]
    _, head = manifests[0]
    pieces: list[tuple[Path, Part]] = []
    for folder, manifest in manifests:
        differs = replace(manifest, first=head.first, part_size=head.part_size).difference(head)
        if differs is not None:
            raise DatasetError(f"'{folder}' does not fit '{folders[0]}': it has {differs}")
        pieces += [(folder / part.file, part) for part in manifest.parts]
    pieces.sort(key=lambda piece: piece[1].first)
    for (_, before), (path, after) in pairwise(pieces):
        if after.first < before.last:
            raise DatasetError(f"'{path}' holds scenes that another part holds, too: {after.first} and more")
    make_folder(target)
    parts = []
    for index, (path, part) in enumerate(pieces):
        if not path.is_file():
            raise DatasetError(f"'{path}' is missing", help="make this part again")
        content = path.read_bytes()
        if digest_of(path) != part.sha256:
            raise DatasetError(f"'{path}' has changed since it was written", help="make this part again")
        name = head.file_name(index)
        write(target / name, content)
        if head.images is not None:
            copy_images(path.parent, part, head.form, target / name)
        elif head.form in FORMS:
            copy_scene_files(path.parent, part, target / name)
        parts.append(replace(part, file=name))
    first, last = (parts[0].first, parts[-1].last) if parts else (head.first, head.first)
    merged = replace(
        head,
        first=first,
        count=last - first,
        parts=tuple(parts),
        seconds=sum(item.seconds for _, item in manifests),
    ).beside(target, str((folders[0] / head.source).resolve()))
    merged.save(target)
    if merged.form == "images":
        join_indices(target, merged)
    return merged
