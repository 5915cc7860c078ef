"""Checks of data sets: every part against its digest, and a share of the scenes against the program."""

import math
import os
import random
import secrets
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from itertools import pairwise
from pathlib import Path
from typing import Final

from scenic.batch.folders.file_digests import file_digests
from scenic.batch.folders.folder import WrittenFolder, check_files
from scenic.batch.folders.ranges import gaps
from scenic.batch.image_parts import copy_images, join_indices
from scenic.batch.manifest import DATASET, DatasetError, Manifest, Part
from scenic.batch.part_contents import Damage, damages_of, encoded_rows, part_rows, strangers
from scenic.batch.scene_bytes import Encoder
from scenic.batch.scene_file_parts import FORMS, copy_scene_files
from scenic.batch.scenes import Job, method_of, results_of
from scenic.formats.files import OutputError, make_folder, write
from scenic.formats.mesh_files import digest_of
from scenic.runtime.ground.context import warn
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["Damage", "merge", "part_rows", "verify"]


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
    if scenario is not None and scenario.digest != manifest.digest:
        raise DatasetError(
            f"the data set in '{folder}' is of another program, or of the same with other options",
            help="give the program as it was when the data set was made",
        )
    if scenario is not None:
        check_files(folder, DatasetError, manifest.files, file_digests(scenario), accepted=False)
    for part in manifest.parts:
        damages = list(damages_of(folder, part, manifest))
        yield from damages
        if not damages and scenario is not None and share > 0:
            yield from _compared(scenario, manifest, part, folder / part.file, share, advance)
    for path in strangers(folder, manifest):
        yield Damage(path.relative_to(folder).as_posix(), "the file does not belong to the data set")


def _compared(
    scenario: Scenario,
    manifest: Manifest,
    part: Part,
    path: Path,
    share: float,
    advance: Callable[[int], None],
) -> Iterator[Damage]:
    sample_numbers = random.Random(part.sha256).sample(
        range(part.first, part.last), min(part.last - part.first, math.ceil(share * (part.last - part.first)))
    )
    kept_rows = {row["k"]: row for row in part_rows(path, manifest.form)}
    encoder = Encoder.of(manifest)
    method = method_of(manifest.points)
    for k in sorted(sample_numbers):
        job = Job(manifest.seed, k, k + 1, manifest.max_attempts, None, **method)
        (result,) = results_of(scenario, job)
        advance(1)
        if isinstance(result, Exhausted):
            if k in kept_rows:
                yield Damage(part.file, f"scene {k} is there, and the program does not find it")
            continue
        again = next(iter(encoded_rows(encoder.rows(scenario, [result]), manifest.form)), None)
        # Scenes in which no camera takes part have no row.
        if (again is None) != (k not in kept_rows):
            yield Damage(
                part.file, f"scene {k} is {'there, without a camera' if again is None else 'missing'}"
            )
        elif again is not None and not is_same(kept_rows[k], again):
            yield Damage(part.file, f"scene {k} differs from that of the program")


def is_same(one: object, other: object) -> bool:
    """Return whether two rows are equal; NaN equals NaN."""
    if isinstance(one, float) and isinstance(other, float) and math.isnan(one):
        return math.isnan(other)
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(is_same(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return len(one) == len(other) and all(map(is_same, one, other))
    return bool(one == other)


def merge(folders: Sequence[Path], target: Path) -> Manifest:
    """Join data sets of one program and seed whose scenes have different numbers; the parts are copied.

    The joined data set appears whole, in a folder that is new or empty, or not at all. Scenes between those of the data sets may be
    missing: then a warning says so, and ``--resume`` makes them.

    Raises:
        DatasetError: if they do not fit together, a part is damaged, or the target holds something.
        OutputError: if files cannot be written.

    """
    pieces, manifest = _joined(folders)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise DatasetError(
            f"'{target}' is there already: data sets are joined in a new folder",
            help="name another folder; nothing has been changed",
        )
    home = target.absolute().parent
    make_folder(home)
    temporary = home / f".{target.absolute().name[:100]}.{secrets.token_hex(6)}.part"
    try:
        with WrittenFolder(temporary, DATASET) as place:
            for path, part in pieces:
                _copy_part(path, part, manifest, temporary / part.file)
            manifest = manifest.beside(target, str((folders[0] / manifest.source).resolve()))
            place.save(asdict(manifest))
            if manifest.form == "images":
                join_indices(temporary, manifest)
        try:
            os.replace(temporary, target)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise OutputError(f"cannot make the folder '{target}': {reason}") from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
    missing_ranges = gaps(manifest.numbers, [part.numbers for part in manifest.parts])
    if missing_ranges:
        ranges = ", ".join(f"{first} to {last - 1}" for first, last in missing_ranges[:_SHOWN])
        more = f", and {len(missing_ranges) - _SHOWN} more ranges" if len(missing_ranges) > _SHOWN else ""
        warn(
            f"'{target}' lacks the scenes {ranges}{more}",
            code="SC612",
            help=f"make them: scenic sample {manifest.program} -n {manifest.count}"
            + (f" --first {manifest.first}" if manifest.first else "")
            + f" -o {target} --resume",
        )
    return manifest


_SHOWN: Final = 3
"""Gaps that a warning names, at most."""


def _joined(folders: Sequence[Path]) -> tuple[list[tuple[Path, Part]], Manifest]:
    """The files of all parts of data sets with the parts that they become, and the manifest of all; raises `DatasetError`."""
    manifests = [(folder, Manifest.load(folder)) for folder in folders]
    _, head = manifests[0]
    pieces: list[tuple[Path, Part]] = []
    for folder, manifest in manifests:
        check_files(folder, DatasetError, head.files, manifest.files, accepted=False)
        differs = replace(manifest, first=head.first, part_size=head.part_size).difference(head)
        if differs is not None:
            raise DatasetError(f"'{folder}' and '{folders[0]}' were made otherwise: {differs}")
        pieces += [(folder / part.file, part) for part in manifest.parts]
    pieces.sort(key=lambda piece: piece[1].first)
    for (_, before), (path, after) in pairwise(pieces):
        if after.first < before.last:
            raise DatasetError(f"'{path}' holds scenes that another part holds, too: {after.first} and more")
    first = min(manifest.first for _, manifest in manifests)
    last = max(manifest.numbers[1] for _, manifest in manifests)
    parts = tuple(replace(part, file=head.file_of(part.numbers)) for _, part in pieces)
    changes = tuple(change for _, manifest in manifests for change in manifest.accepted)
    seconds = sum(manifest.seconds for _, manifest in manifests)
    joint_manifest = replace(
        head, first=first, count=last - first, parts=parts, seconds=seconds, accepted=changes
    )
    return [(path, part) for (path, _), part in zip(pieces, parts, strict=True)], joint_manifest


def _copy_part(path: Path, part: Part, manifest: Manifest, target: Path) -> None:
    """Copy a part with the files that belong to it; raises `DatasetError` where one is damaged."""
    if not path.is_file():
        raise DatasetError(f"'{path}' is missing", help=_MEND)
    if digest_of(path) != part.sha256:
        raise DatasetError(f"'{path}' has changed since it was written", help=_MEND)
    write(target, path.read_bytes())
    source = replace(part, file=path.name)
    if manifest.images is not None:
        copy_images(path.parent, source, manifest.form, target)
    elif manifest.form in FORMS:
        copy_scene_files(path.parent, source, target)


_MEND: Final = "make this part again: scenic sample ... -o FOLDER --resume --verify"
