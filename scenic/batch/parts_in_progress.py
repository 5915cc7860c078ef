"""The part of a data set that is being made: its rows so far, and its journal, by which a run that was ended goes on."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.batch.folders.ranges import Range
from scenic.batch.manifest import Manifest, Part
from scenic.batch.part_files import part_file
from scenic.batch.scene_bytes import Encoder, blocks_of
from scenic.batch.scenes import Made, method_of
from scenic.formats.files import refusing
from scenic.formats.mesh_files import digest_of
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["ENTRY", "JOURNAL", "PartInProgress", "journal_name"]

ENTRY: Final = 16
"""Bytes of a scene in a journal."""

JOURNAL: Final = ".journal"
"""Suffix of journals."""

_BLOCK: Final = 512
"""Scenes evaluated together from a journal."""


def journal_name(first: int) -> str:
    """The name of the journal of the part that begins with a scene; the part may become longer when more scenes are wanted."""
    return f"part-{first:08d}{JOURNAL}"


class PartInProgress:
    """The part of the scenes ``numbers``: its rows so far, and its journal."""

    def __init__(self, scenario: Scenario, folder: Path, manifest: Manifest, numbers: Range) -> None:
        first, self._last = numbers
        self._scenario = scenario
        self._manifest = manifest
        self._first = first
        self.upcoming = first
        """The number of the first scene that is neither found nor given up."""
        self.encoder = Encoder.of(manifest)
        self._path = folder / manifest.file_of(numbers)
        self._journal_path = folder / journal_name(first)
        self._rows = 0
        self._attempts = 0
        self._missing: list[int] = []
        self._sink = part_file(self._path, scenario, manifest)
        self._journal: Any = None

    def recalled(self) -> Iterator[int]:
        """Take up the scenes of the journal; yields the attempts of each."""
        entries = self._entries()
        with refusing(self._journal_path):
            self._journal = self._journal_path.open("wb")
        most = min(_BLOCK, self.encoder.most)
        for start in range(0, len(entries), most):
            block = entries[start : start + most]
            rows = block[block[:, 1] > 0]
            if len(rows):
                source = method_of(self._manifest.points).get("source")
                scenes = list(
                    self._scenario.found(self._manifest.seed, rows[:, 0], rows[:, 1], source=source)
                )
                self._put(self.encoder(self._scenario, scenes))
            self._note(block)
            yield from np.abs(block[:, 1]).tolist()

    def _entries(self) -> NDArray[np.int64]:
        """Return the journal's rows ``(n, 2)``: consecutive numbers from the part's first on, and attempts, negative if not found."""
        try:
            data = self._journal_path.read_bytes()
        except OSError:
            data = b""
        entries = np.frombuffer(data[: len(data) - len(data) % ENTRY], dtype=np.int64).reshape(-1, 2)
        numbers = self._first + np.arange(len(entries))
        entries = entries[: self._last - self._first]
        numbers = numbers[: len(entries)]
        good = np.cumprod(entries[:, 0] == numbers, dtype=np.int64).sum() if len(entries) else 0
        return entries[:good]

    def add(self, made: Made) -> None:
        """Add the next scenes."""
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

    def finish(self) -> Part:
        """Complete the file."""
        self._sink.finish()
        index = digest_of(self._path.with_suffix(".json")) if self._manifest.form == "tar" else ""
        return Part(
            self._path.name,
            self._first,
            self._last,
            self._rows,
            self._attempts,
            tuple(self._missing),
            digest_of(self._path),
            self._path.stat().st_size,
            index,
            self._sink.skipped,
        )

    def close(self) -> None:
        """Give up what is not finished; the journal stays."""
        self._sink.close()
        if self._journal is not None:
            self._journal.close()

    def forget(self) -> None:
        """Remove the journal of a part that is complete and in the manifest."""
        self._journal_path.unlink(missing_ok=True)
