"""The folder of a search: a manifest, and one line for each finished run."""

import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from scenic.formats.files import make_folder, refusing, write
from scenic.language.errors import Located

__all__ = ["SearchFolder", "SearchFolderError", "folders_of", "manifest_of", "number", "read_rows"]

_FORMAT: Final = "scenic-falsification"
_VERSION: Final = 1
_DESCRIBING: Final = ("units", "origin")
"""Settings that decide nothing: they may be others when a search goes on."""


class SearchFolderError(Located):
    """A folder that is not that of this search."""

    code = "SC609"


class SearchFolder:
    """Keeps the runs of a search. Each generation is on the disk before the next one begins.

    Args:
        path: the folder, made if it is not there.
        settings: everything that decides what comes out.
        resume: whether to go on with what is there.

    Raises:
        SearchFolderError: the folder holds another search, or one that is not to be gone on with.

    """

    def __init__(self, path: Path, settings: Mapping[str, Any], *, resume: bool) -> None:
        make_folder(path)
        self.path = path
        manifest = path / "manifest.json"
        wanted = {"format": _FORMAT, "version": _VERSION, **json.loads(json.dumps(settings))}
        found = _manifest(manifest) if manifest.exists() else None
        if found is not None and not resume and read_rows(path):
            raise SearchFolderError(
                f"'{path}' holds a search already",
                help="go on with it by --resume, or name another folder",
            )
        if found is not None and resume:
            different = [
                name for name in wanted if name not in _DESCRIBING and found.get(name) != wanted[name]
            ]
            if different:
                raise SearchFolderError(
                    f"'{path}' holds another search: its {different[0]} differs",
                    help="give the same program and options, or name another folder",
                )
        elif resume and any(path.iterdir()):
            raise SearchFolderError(
                f"'{path}' holds no search", help="name the folder of one, or an empty one"
            )
        else:
            write(manifest, json.dumps(wanted, indent=1).encode())
        self.rows: list[dict[str, Any]] = read_rows(path)
        """The runs that are finished."""
        self._keep()

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


def _manifest(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_bytes())
    except (OSError, ValueError):
        found = None
    if not isinstance(found, dict) or found.get("format") != _FORMAT:
        raise SearchFolderError(f"'{path}' is no manifest of a search", help="name the folder of a search")
    return found


def manifest_of(folder: Path) -> dict[str, Any]:
    """The manifest of a search; raises `SearchFolderError` if there is none."""
    if not (folder / "manifest.json").exists():
        raise SearchFolderError(
            f"'{folder}' holds no search", help="name the folder that `scenic falsify -o` has written"
        )
    return _manifest(folder / "manifest.json")


def folders_of(folder: Path) -> list[Path]:
    """The folder of a search itself, or those of the searches of a sweep that it holds."""
    if (folder / "manifest.json").exists():
        return [folder]
    found = [manifest.parent for manifest in folder.glob("*/manifest.json")]
    # So that n=9 comes before n=16.
    return sorted(found, key=lambda item: (len(item.name), item.name))


def read_rows(folder: Path) -> list[dict[str, Any]]:
    """The finished runs in a folder; what a run that was killed has left half written is not one."""
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
        if not isinstance(row, dict) or row.get("run") != len(rows):
            break
        rows.append(row)
    return rows


def number(value: float) -> Any:
    """A number as JSON knows it: infinities and NaN as text."""
    return value if math.isfinite(value) else str(value)


def _line(row: Mapping[str, Any]) -> str:
    return json.dumps(row, allow_nan=False, separators=(",", ":")) + "\n"
