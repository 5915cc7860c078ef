"""Data sets: folders of parts that hold many scenes, made in any number of processes, and continued after any end.

A part holds the scenes of a fixed range of numbers, and is complete or absent. Its name and bytes depend on the manifest's
settings alone. Beside the part that is being made lies its *journal*, with the accepted candidate of each scene found so far:
a run that goes on evaluates these candidates and looks for the rest.
"""

import contextlib
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Final

from scenic.batch.engines import BatchEngine
from scenic.batch.folders.folder import WrittenFolder, check_files
from scenic.batch.folders.lock import lock_beside
from scenic.batch.image_parts import join_indices
from scenic.batch.manifest import DATASET, NAME, DatasetError, Manifest
from scenic.batch.part_contents import damage_of, strangers
from scenic.batch.part_files import TableFile
from scenic.batch.parts_in_progress import ENTRY, JOURNAL, PartInProgress
from scenic.batch.scene_bytes import Encoder, blocks_of
from scenic.batch.scenes import Job, Made, encoded_here, in_processes, method_of
from scenic.dataclass import dataclass
from scenic.runtime.ground.context import warn
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["DatasetRun", "Finished", "Resuming", "make_dataset", "scenes_kept", "write_table"]


@dataclass(frozen=True, slots=True)
class Resuming:
    """Permissions of a run that goes on with a data set.

    Attributes:
        verify: compare the content of complete parts with their digests, not their sizes alone.
        accept_changes: go on although files that decide the scenes have changed; the manifest notes it.

    """

    verify: bool = False
    accept_changes: bool = False


@dataclass(frozen=True, slots=True)
class DatasetRun:
    """Settings of a run that change no row.

    Attributes:
        engine: where scenes are sampled; in this process if ``None``.
        deadline: a time of `time.monotonic` after which scenes are not looked for.
        advance: called with how many more scenes are done, and the candidates that they took.

    """

    engine: BatchEngine | None = None
    deadline: float | None = None
    advance: Callable[[int, int], None] = lambda _scenes, _attempts: None


@dataclass(frozen=True, slots=True)
class Finished:
    """The manifest that a run wrote, and the scenes that it did not find."""

    manifest: Manifest
    missing: tuple[Exhausted, ...]


def make_dataset(
    scenario: Scenario,
    folder: Path,
    manifest: Manifest,
    run: DatasetRun | None = None,
    *,
    resume: bool | Resuming = False,
) -> Finished:
    """Make the parts of a data set that are not there.

    Args:
        scenario: the scenario.
        folder: where the data set is; made if it is not there.
        manifest: the settings of the data set.
        run: how the scenes are made.
        resume: whether, and how, to go on with the data set in the folder.

    Raises:
        BusyError: if another command is writing there.
        DatasetError: if the folder holds another data set, or one that is not to be resumed.
        OutputError: if files cannot be written.

    """
    run = run or DatasetRun()
    with WrittenFolder(folder, DATASET) as place:
        current = _continued(place, manifest, resume).beside(folder, scenario.filename)
        for part in current.parts:
            run.advance(part.last - part.first, 0)
        place.save(asdict(current))
        short_parts = [part for part in current.parts if current.is_cut_short(part)]
        _remove_strangers(folder, current)
        missing: list[Exhausted] = []
        try:
            for further in _progress(scenario, folder, current, run, missing):
                current = further
                place.save(asdict(current))
                for part in short_parts:
                    if part not in current.parts:
                        (folder / part.file).unlink(missing_ok=True)
        finally:
            if manifest.form == "images":
                join_indices(folder, current)
        return Finished(current, tuple(missing))


def _progress(
    scenario: Scenario, folder: Path, kept: Manifest, run: DatasetRun, missing: list[Exhausted]
) -> Iterator[Manifest]:
    """Make the parts that are not there; yields the manifest after each, and adds to ``missing`` what is not found."""
    for numbers in kept.ranges():
        start_time = time.monotonic()
        with contextlib.closing(PartInProgress(scenario, folder, kept, numbers)) as progress:
            for attempts in progress.recalled():
                run.advance(1, attempts)
            job = Job(
                kept.seed,
                progress.upcoming,
                numbers[1],
                kept.max_attempts,
                run.deadline,
                **method_of(kept.points),
            )
            for block_of_scenes in _made(scenario, progress.encoder, job, run.engine):
                progress.add(block_of_scenes)
                missing.extend(block_of_scenes.missing)
                run.advance(block_of_scenes.job.last - block_of_scenes.job.first, block_of_scenes.attempts)
            if any(item.reason == "time" for item in missing):
                return
            kept = kept.with_part(progress.finish(), time.monotonic() - start_time)
            if scenario.approximation is not None:
                kept = replace(kept, approximation=str(scenario.approximation))
        yield kept
        progress.forget()


def write_table(
    scenario: Scenario,
    path: Path,
    manifest: Manifest,
    run: DatasetRun | None = None,
) -> Finished:
    """Write scenes as one Parquet file, which has the manifest in its metadata; the arguments are those of `make_dataset`."""
    run = run or DatasetRun()
    encoder = Encoder("parquet")
    missing: list[Exhausted] = []
    job = Job(
        manifest.seed,
        manifest.first,
        manifest.first + manifest.count,
        manifest.max_attempts,
        run.deadline,
        **method_of(manifest.points),
    )
    with lock_beside(path), contextlib.closing(TableFile(path, scenario, manifest)) as table:
        for result in _made(scenario, encoder, job, run.engine):
            for block in blocks_of(result.encoded):
                table.add(block.rows)
            missing.extend(result.missing)
            run.advance(result.job.last - result.job.first, result.attempts)
        table.finish()
    return Finished(manifest, tuple(missing))


def scenes_kept(folder: Path) -> int:
    """Number of scenes of a data set that a run with ``resume`` does not look for again: in parts and journals."""
    if not (folder / NAME).exists():
        return 0
    done = sum(part.last - part.first for part in Manifest.load(folder).parts)
    return done + sum(path.stat().st_size // ENTRY for path in folder.glob(f"part-*{JOURNAL}"))


def _made(scenario: Scenario, encoder: Encoder, job: Job, engine: BatchEngine | None) -> Iterator[Made]:
    if engine is None or job.last - job.first < 2:
        return encoded_here(scenario, encoder, job, most=encoder.most)
    return in_processes(scenario, encoder, job, engine)


def _continued(place: WrittenFolder, manifest: Manifest, resume: bool | Resuming) -> Manifest:
    """The manifest to continue with: the manifest of the folder, with the number of scenes wanted now."""
    folder = place.path
    if not place.has_manifest:
        place.check_without("part-*")
        return manifest
    earlier = Manifest.load(folder)
    how = resume if isinstance(resume, Resuming) else Resuming()
    if not resume:
        if not earlier.parts and not any(path.stat().st_size for path in folder.glob(f"part-*{JOURNAL}")):
            return manifest  # nothing has come of it
        raise DatasetError(
            f"'{folder}' holds a data set of {earlier.rows} scenes already",
            help="go on with it by --resume, or choose another folder",
        )
    _check_same(folder, manifest, earlier)
    changes = check_files(folder, DatasetError, earlier.files, manifest.files, accepted=how.accept_changes)
    target = replace(earlier, count=manifest.count, files=manifest.files, fingerprint=manifest.fingerprint)
    whole = []
    for part in earlier.parts:
        damage = damage_of(folder, part, earlier, read=how.verify)
        if damage is None:
            whole.append(part)
        else:
            warn(f"'{folder / damage.file}': {damage.what}; its scenes are made again", code="SC612")
    kept = replace(target, parts=tuple(whole))
    if changes:
        # What was found by other files is looked for again.
        for path in folder.glob(f"part-*{JOURNAL}"):
            path.unlink()
        first = min((numbers[0] for numbers in kept.ranges()), default=kept.numbers[1])
        kept = replace(kept, accepted=(*earlier.accepted, {"scene": first, "changes": changes}))
    return kept


def _check_same(folder: Path, manifest: Manifest, earlier: Manifest) -> None:
    """Raise `DatasetError` if a data set cannot go on with these settings."""
    if manifest.files != earlier.files:
        # The graph follows the files, whose difference is named, or accepted.
        manifest = replace(manifest, fingerprint=earlier.fingerprint)
    differs = manifest.difference(earlier)
    if differs is not None:
        raise DatasetError(
            f"the data set in '{folder}' was made otherwise: {differs}",
            help="give the same program, options and versions as before, or choose another folder",
        )
    if manifest.count < earlier.count:
        raise DatasetError(
            f"the data set in '{folder}' is to hold {earlier.count} scenes, more than {manifest.count}",
            help=f"go on with -n {earlier.count} or more; or make the first {manifest.count} in another folder",
        )


def _remove_strangers(folder: Path, kept: Manifest) -> None:
    """Remove parts and journals of ranges that the data set does not have, so that readers of all files see each scene once."""
    for path in strangers(folder, kept):
        if _OURS.fullmatch(path.name):
            path.unlink()


_OURS: Final = re.compile(r"part-\d{8,}(-\d{8,}\.[a-z]+|\.journal)")
"""Names of parts and journals."""
