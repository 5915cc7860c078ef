"""Data sets: folders of parts that hold many scenes, made in any number of processes, and continued after any end.

A part holds the scenes of a fixed range of numbers, and is complete or absent. Its name and bytes depend on the manifest's
settings alone. Beside the part that is being made lies its *journal*, with the accepted candidate of each scene found so far:
a run that goes on evaluates these candidates and looks for the rest.
"""

import contextlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from scenic.batch.engines import Engine
from scenic.batch.image_parts import ImageRows, ImageSink, join_indices
from scenic.batch.manifest import NAME, DatasetError, Manifest, Part
from scenic.batch.scene_file_parts import FORMS, SceneFileRows, SceneFileSink
from scenic.batch.scenes import LONGEST, Job, Made, encoded_here, in_processes, method_of
from scenic.dataclass import dataclass
from scenic.formats.files import Waiting, discard_unfinished, make_folder, refusing, writing
from scenic.formats.json_lines import SceneLines
from scenic.formats.mesh_files import digest_of
from scenic.formats.trajectory_tables import parquet_support
from scenic.runtime.sampling.report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene

__all__ = ["GROUP", "Encoder", "Finished", "make_dataset", "scenes_kept", "write_table"]

GROUP: Final = 4096
"""Rows of a group of a Parquet file."""

_ENTRY: Final = 16
"""Bytes of a scene in a journal."""

_BLOCK: Final = 512
"""Scenes evaluated together from a journal."""

_IMAGES: Final = 16
"""Scenes whose images are kept in memory together, and lost together where a run ends."""


@dataclass(frozen=True, slots=True)
class Run:
    """Settings of a run that change no row.

    Attributes:
        engine: where scenes are sampled; in this process if ``None``.
        deadline: a time of `time.monotonic` after which scenes are not looked for.
        advance: called with how many more scenes are done, and the candidates that they took.

    """

    engine: Engine | None = None
    deadline: float | None = None
    advance: Callable[[int, int], None] = lambda _scenes, _attempts: None


@dataclass(frozen=True, slots=True)
class Finished:
    """The manifest that a run wrote, and the scenes that it did not find."""

    manifest: Manifest
    missing: tuple[Exhausted, ...]


class Encoder:
    """Encodes blocks of scenes for a part: numbers and attempts, then the rows.

    Args:
        form: ``parquet`` or ``jsonl``, or of `IMAGE_FORMS` or `FORMS`.
        changed: whether JSON Lines tell only the properties that the program gives.
        points: see `Manifest`.
        images: see `Manifest`.

    """

    def __init__(
        self,
        form: str,
        *,
        changed: bool = True,
        points: str | None = None,
        images: Mapping[str, Any] | None = None,
    ) -> None:
        self._form = form
        self._images = images
        self._changed = changed
        self._points = points
        self._writer: Any = None

    @classmethod
    def of(cls, manifest: Manifest) -> Self:
        """The encoder of a data set."""
        return cls(
            manifest.form,
            changed=manifest.properties == "changed",
            points=manifest.points,
            images=manifest.images,
        )

    @property
    def most(self) -> int:
        """Number of scenes that are encoded together, at most."""
        return LONGEST if self._images is None and self._form not in FORMS else _IMAGES

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_writer": None}  # belongs to one process

    def __call__(self, scenario: Scenario, scenes: Sequence[Scene]) -> bytes:
        """The block of some scenes."""
        rows = self.rows(scenario, scenes)
        head = [len(scenes), len(rows), *(scene.k for scene in scenes), *(scene.attempts for scene in scenes)]
        return np.array(head, dtype=np.int64).tobytes() + rows

    def rows(self, scenario: Scenario, scenes: Sequence[Scene]) -> bytes:
        """Their rows: text, the stream of an Arrow record batch, or those of `ImageRows`."""
        if self._images is not None:
            if self._writer is None:
                self._writer = ImageRows(scenario, self._form, self._images)
            return bytes(self._writer.rows(scenes))
        if self._form in FORMS:
            if self._writer is None:
                self._writer = SceneFileRows(scenario, self._form)
            return bytes(self._writer.rows(scenes))
        if self._form == "jsonl":
            if self._writer is None:
                program = Path(scenario.filename)
                self._writer = SceneLines(
                    (program.name, scenario.digest),
                    changed=self._changed,
                    points=self._points,
                    folder=program.parent,
                )
            return bytes(self._writer.block(scenario, scenes))
        from scenic.formats.scene_tables import SceneTable

        if self._writer is None:
            self._writer = SceneTable(scenario)
        return bytes(self._writer.encoded(scenes))


@dataclass(frozen=True, slots=True)
class Block:
    """An encoded block taken apart: scene numbers ``(n,)``, attempts ``(n,)``, and rows."""

    numbers: NDArray[np.int64]
    attempts: NDArray[np.int64]
    rows: memoryview


def blocks_of(encoded: Any) -> Iterator[Block]:
    """The blocks in the bytes of an `Encoder`."""
    view, place = memoryview(encoded).cast("B"), 0
    while place < len(view):
        count, size = (int(word) for word in np.frombuffer(view[place : place + 16], dtype=np.int64))
        heads = np.frombuffer(view[place + 16 : place + 16 + 16 * count], dtype=np.int64)
        place += 16 + 16 * count
        yield Block(heads[:count], heads[count:], view[place : place + size])
        place += size


def make_dataset(
    scenario: Scenario,
    folder: Path,
    manifest: Manifest,
    run: Run | None = None,
    *,
    resume: bool = False,
) -> Finished:
    """Make the parts of a data set that are not there.

    Args:
        scenario: the scenario.
        folder: where the data set is; made if it is not there.
        manifest: the settings of the data set.
        run: how the scenes are made.
        resume: whether to go on with the data set in the folder.

    Raises:
        DatasetError: if the folder holds another data set, or one that is not to be resumed.
        OutputError: if files cannot be written.

    """
    run = run or Run()
    make_folder(folder)
    kept = _kept(folder, manifest, resume=resume).beside(folder, scenario.filename)
    for part in kept.parts:
        run.advance(part.last - part.first, 0)
    kept.save(folder)
    missing: list[Exhausted] = []
    try:
        for further in _progress(scenario, folder, kept, run, missing):
            kept = further
            kept.save(folder)
    finally:
        if manifest.form == "images":
            join_indices(folder, kept)
    return Finished(kept, tuple(missing))


def _progress(
    scenario: Scenario, folder: Path, kept: Manifest, run: Run, missing: list[Exhausted]
) -> Iterator[Manifest]:
    """Make the parts that are not there; yields the manifest after each, and adds to ``missing`` what is not found."""
    done = {part.first for part in kept.parts}
    for first, last in kept.ranges():
        if first in done:
            continue
        begun = time.monotonic()
        with contextlib.closing(_PartInProgress(scenario, folder, kept, first)) as progress:
            for attempts in progress.recalled():
                run.advance(1, attempts)
            job = Job(
                kept.seed,
                progress.upcoming,
                last,
                kept.max_attempts,
                run.deadline,
                **method_of(kept.points),
            )
            for made in _made(scenario, progress.encoder, job, run.engine):
                progress.add(made)
                missing.extend(made.missing)
                run.advance(made.job.last - made.job.first, made.attempts)
            if any(item.reason == "time" for item in missing):
                return
            kept = kept.with_part(progress.finish(last), time.monotonic() - begun)
            if scenario.approximation is not None:
                kept = replace(kept, approximation=str(scenario.approximation))
        yield kept
        progress.forget()


def write_table(
    scenario: Scenario,
    path: Path,
    manifest: Manifest,
    run: Run | None = None,
) -> Finished:
    """Write scenes as one Parquet file, which has the manifest in its metadata; the arguments are those of `make_dataset`."""
    run = run or Run()
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
    with contextlib.closing(_Table(path, scenario, manifest)) as table:
        for made in _made(scenario, encoder, job, run.engine):
            for block in blocks_of(made.encoded):
                table.add(block.rows)
            missing.extend(made.missing)
            run.advance(made.job.last - made.job.first, made.attempts)
        table.finish()
    return Finished(manifest, tuple(missing))


def scenes_kept(folder: Path) -> int:
    """Number of scenes of a data set that a run with ``resume`` does not look for again: in parts and journals."""
    if not (folder / NAME).exists():
        return 0
    done = sum(part.last - part.first for part in Manifest.load(folder).parts)
    return done + sum(path.stat().st_size // _ENTRY for path in folder.glob("part-*.journal"))


def _made(scenario: Scenario, encoder: Encoder, job: Job, engine: Engine | None) -> Iterator[Made]:
    if engine is None or job.last - job.first < 2:
        return encoded_here(scenario, encoder, job, most=encoder.most)
    return in_processes(scenario, encoder, job, engine)


def _kept(folder: Path, manifest: Manifest, *, resume: bool) -> Manifest:
    """The manifest to continue with: the manifest of the folder, with the number of scenes wanted now."""
    if not (folder / NAME).exists():
        return manifest
    earlier = Manifest.load(folder)
    if not resume:
        if not earlier.parts and not any(path.stat().st_size for path in folder.glob("part-*.journal")):
            return manifest  # nothing has come of it
        raise DatasetError(
            f"'{folder}' holds a data set of {earlier.rows} scenes already",
            help="go on with it by --resume, or choose another folder",
        )
    differs = manifest.difference(earlier)
    if differs is not None:
        raise DatasetError(
            f"the data set in '{folder}' was made otherwise: {differs}",
            help="give the same program, options and versions as before, or choose another folder",
        )
    discard_unfinished(folder)
    wanted = replace(earlier, count=manifest.count)
    fitting = set(wanted.ranges())
    parts = tuple(
        part for part in earlier.parts if (part.first, part.last) in fitting and (folder / part.file).exists()
    )
    return replace(wanted, parts=parts)


class _PartInProgress:
    """The part that begins with scene ``first``: its rows so far, and its journal."""

    def __init__(self, scenario: Scenario, folder: Path, manifest: Manifest, first: int) -> None:
        self._scenario = scenario
        self._manifest = manifest
        self._first = first
        self.upcoming = first
        """The number of the first scene that is neither found nor given up."""
        self.encoder = Encoder.of(manifest)
        self._path = folder / manifest.file_of(first)
        self._journal_path = self._path.with_suffix(".journal")
        self._rows = 0
        self._attempts = 0
        self._missing: list[int] = []
        self._sink = _sink(self._path, scenario, manifest)
        self._journal: Any = None

    def recalled(self) -> Iterator[int]:
        """Take up the scenes of the journal; yields the attempts of each."""
        entries = self._entries()
        with refusing(self._journal_path):
            self._journal = self._journal_path.open("wb")
        most = min(_BLOCK, self.encoder.most)
        for start in range(0, len(entries), most):
            block = entries[start : start + most]
            found = block[block[:, 1] > 0]
            if len(found):
                source = method_of(self._manifest.points).get("source")
                scenes = list(
                    self._scenario.found(self._manifest.seed, found[:, 0], found[:, 1], source=source)
                )
                self._put(self.encoder(self._scenario, scenes))
            self._note(block)
            yield from np.abs(block[:, 1]).tolist()

    def _entries(self) -> NDArray[np.int64]:
        """The journal's rows ``(n, 2)``: consecutive numbers from the part's first on, and attempts, negative if not found."""
        try:
            data = self._journal_path.read_bytes()
        except OSError:
            data = b""
        entries = np.frombuffer(data[: len(data) - len(data) % _ENTRY], dtype=np.int64).reshape(-1, 2)
        wanted = self._first + np.arange(len(entries))
        good = np.cumprod(entries[:, 0] == wanted, dtype=np.int64).sum() if len(entries) else 0
        return entries[:good]

    def add(self, made: Made) -> None:
        """The next scenes."""
        numbers = np.arange(made.job.first, made.job.last, dtype=np.int64)
        attempts = np.zeros(len(numbers), dtype=np.int64)
        for item in made.missing:
            attempts[item.k - made.job.first] = -item.attempts
        for block in blocks_of(made.encoded):
            attempts[block.numbers - made.job.first] = block.attempts
        self._put(made.encoded)
        if any(item.reason == "time" for item in made.missing):
            # Scenes that ran out of time are looked for again; what comes before is certain.
            late = min(item.k for item in made.missing if item.reason == "time")
            numbers, attempts = numbers[: late - made.job.first], attempts[: late - made.job.first]
        self._note(np.stack([numbers, attempts], axis=1))

    def _put(self, encoded: object) -> None:
        for block in blocks_of(encoded):
            self._rows += len(block.numbers)
            self._sink.add(block.rows)

    def _note(self, entries: NDArray[np.int64]) -> None:
        if not len(entries):
            return
        self._attempts += int(np.abs(entries[:, 1]).sum())
        self._missing += entries[entries[:, 1] < 0, 0].tolist()
        self.upcoming = int(entries[-1, 0]) + 1
        with refusing(self._journal_path):
            self._journal.write(np.ascontiguousarray(entries).tobytes())
            self._journal.flush()

    def finish(self, last: int) -> Part:
        """Complete the file."""
        self._sink.finish()
        index = digest_of(self._path.with_suffix(".json")) if self._manifest.form == "tar" else ""
        return Part(
            self._path.name,
            self._first,
            last,
            self._rows,
            self._attempts,
            tuple(self._missing),
            digest_of(self._path),
            index,
        )

    def close(self) -> None:
        """Give up what is not finished; the journal stays."""
        self._sink.close()
        if self._journal is not None:
            self._journal.close()

    def forget(self) -> None:
        """Remove the journal of a part that is complete and in the manifest."""
        self._journal_path.unlink(missing_ok=True)


class _Sink(Protocol):
    """Takes the rows of a part; its file is complete or absent."""

    def add(self, rows: memoryview) -> None: ...

    def finish(self) -> None: ...

    def close(self) -> None: ...


def _sink(path: Path, scenario: Scenario, manifest: Manifest) -> _Sink:
    if manifest.images is not None:
        return ImageSink(path, scenario, manifest)
    if manifest.form in FORMS:
        return SceneFileSink(path, scenario, manifest)
    return _Lines(path) if manifest.form == "jsonl" else _Table(path, scenario)


class _Lines:
    """JSON Lines that get their name when they are complete."""

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


class _Table:
    """A Parquet file in groups of `GROUP` rows, which gets its name when it is complete."""

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
