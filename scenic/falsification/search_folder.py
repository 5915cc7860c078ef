"""The folder of a search: a manifest, and one line for each finished run."""

import json
import math
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Final, Self

from scenic.batch.folders.folder import NAME, FolderKind, WrittenFolder, check_files
from scenic.batch.folders.lock import LOCK
from scenic.formats.files import refusing, write
from scenic.language.errors import Located

__all__ = [
    "ESTIMATE",
    "EstimateFolderError",
    "RunsFolder",
    "SearchFolder",
    "SearchFolderError",
    "folders_of",
    "kind_of",
    "manifest_of",
    "number",
    "read_rows",
]

_DESCRIBING: Final = ("units", "origin")
"""Settings that decide nothing: they may be others when a search goes on."""


class SearchFolderError(Located):
    """A folder that is not that of this search."""

    code = "SC609"


class NoSearchError(SearchFolderError):
    """The error for a folder without a search."""


SEARCH: Final = FolderKind(
    "scenic-falsification", 1, "search", "`scenic falsify -o FOLDER`", SearchFolderError, NoSearchError
)
"""Folders of searches."""


class EstimateFolderError(Located):
    """A folder that is not that of this estimate."""

    code = "SC609"


class NoEstimateError(EstimateFolderError):
    """The error for a folder without an estimate."""


ESTIMATE: Final = FolderKind(
    "scenic-estimate",
    1,
    "probability estimate",
    "`scenic estimate -o FOLDER`",
    EstimateFolderError,
    NoEstimateError,
)
"""Folders of estimates."""


class RunsFolder(WrittenFolder):
    """Keeps rows of runs, each on the disk before the next ones begin.

    Args:
        path: the folder, made if it is not there.
        kind: its kind.
        settings: everything that decides what comes out, and what describes it.
        resume: whether to go on with what is there.
        accept_changes: whether to go on although files that decide the scenes have changed.
        first: number of the first run.

    Raises:
        SearchFolderError: the folder holds other runs, or some that are not to be gone on with.

    """

    def __init__(
        self,
        path: Path,
        kind: FolderKind,
        settings: Mapping[str, object],
        *,
        resume: bool,
        accept_changes: bool = False,
        first: int = 0,
    ) -> None:
        super().__init__(path, kind)
        self._first = first
        self._settings: dict[str, Any] = json.loads(json.dumps(settings))
        self._resume = resume
        self._accept_changes = accept_changes
        self.rows: list[dict[str, Any]] = []
        """The runs that are finished."""

    def __enter__(self) -> Self:
        super().__enter__()
        try:
            self._begin()
        except BaseException as error:
            self.__exit__(type(error))
            raise
        return self

    def _begin(self) -> None:
        """Compare the search with that of the folder, and take up its runs."""
        settings = self._settings
        if self.has_manifest and self._resume:
            earlier = self.document()
            different = [
                name for name in settings if name not in _DESCRIBING and earlier.get(name) != settings[name]
            ]
            if different:
                raise self.kind.error(
                    f"'{self.path}' holds another {self.kind.noun}: its {different[0]} differs",
                    help="give the same program and options, or name another folder",
                )
            before, now = (item.get("origin", {}).get("files", {}) for item in (earlier, settings))
            changes = check_files(self.path, self.kind.error, before, now, accepted=self._accept_changes)
            combined_settings = self._gone_on(earlier)
            if changes:
                change = {"run": self._first + len(self._read()), "changes": changes}
                combined_settings["accepted"] = [*earlier.get("accepted", []), change]
            if combined_settings != earlier:
                self.save(combined_settings)
        elif self.has_manifest and self._read():
            self.document()  # raises for that of something else
            raise self.kind.error(
                f"'{self.path}' holds a {self.kind.noun} already",
                help="go on with it by --resume, or name another folder",
            )
        elif self._resume and any(item.name != LOCK for item in self.path.iterdir()):
            raise self.kind.error(
                f"'{self.path}' holds no {self.kind.noun}", help="name the folder of one, or an empty one"
            )
        else:
            if self.has_manifest:
                self.document()  # raises for that of something else
            self.save(settings)
        self.rows = self._read()
        self._keep()

    def _gone_on(self, earlier: Mapping[str, Any]) -> dict[str, Any]:
        """The manifest of runs that go on, from the one before."""
        return {**earlier, **self._settings}

    def _read(self) -> list[dict[str, Any]]:
        return read_rows(self.path, self._first)

    def _keep(self) -> None:
        """Leave no unfinished line."""
        lines = "".join(_line(row) for row in self.rows).encode()
        file = self.path / "runs.jsonl"
        if not file.exists() or file.read_bytes() != lines:
            write(file, lines)

    def add(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Append finished runs; raises ``OutputError``."""
        file = self.path / "runs.jsonl"
        with refusing(file), file.open("ab") as stream:
            stream.write("".join(map(_line, rows)).encode())
            stream.flush()
            os.fsync(stream.fileno())


def kind_of(folder: Path) -> FolderKind | None:
    """The kind of a folder of runs; ``None`` of any other."""
    for kind in (SEARCH, ESTIMATE):
        with suppress(Located):
            kind.document(folder)
            return kind
    return None


class SearchFolder(RunsFolder):
    """The folder of a search; see `RunsFolder`."""

    def __init__(
        self, path: Path, settings: Mapping[str, object], *, resume: bool, accept_changes: bool = False
    ) -> None:
        super().__init__(path, SEARCH, settings, resume=resume, accept_changes=accept_changes)


def manifest_of(folder: Path) -> dict[str, Any]:
    """The manifest of a search; raises `SearchFolderError` if there is none."""
    if not (folder / NAME).exists():
        raise SearchFolderError(
            f"'{folder}' holds no search", help="name the folder that `scenic falsify -o` has written"
        )
    return SEARCH.document(folder)


def folders_of(folder: Path, kind: FolderKind = SEARCH) -> list[Path]:
    """Return a folder of runs of a kind itself, or those of the settings of a sweep that it holds."""
    if kind_of(folder) is kind:
        return [folder]
    inner = [manifest.parent for manifest in folder.glob(f"*/{NAME}") if kind_of(manifest.parent) is kind]
    # So that n=9 comes before n=16.
    return sorted(inner, key=lambda item: (len(item.name), item.name))


def read_rows(folder: Path, first: int = 0) -> list[dict[str, Any]]:
    """The finished runs in a folder, from number ``first`` on; what a run that was killed has left half written is not one."""
    rows: list[dict[str, Any]] = []
    try:
        lines = (folder / "runs.jsonl").read_bytes().split(b"\n")
    except FileNotFoundError:
        return rows
    for line in lines:
        try:
            row = json.loads(line)
        except ValueError:
            break
        if not isinstance(row, dict) or row.get("run") != first + len(rows):
            break
        rows.append(row)
    return rows


def number(value: float) -> Any:
    """A number as JSON knows it: infinities and NaN as text."""
    return value if math.isfinite(value) else str(value)


def _line(row: Mapping[str, object]) -> str:
    return json.dumps(row, allow_nan=False, separators=(",", ":")) + "\n"
