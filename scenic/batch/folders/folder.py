"""Folders that commands write over time, and go on with: one writer, a manifest that says how the content was made, and refusals.

Data sets, simulations and searches are such folders. Their manifest holds the *settings* that decide the content, and the
digests of the *files* that decide it, too. A folder goes on only with the same settings and files; a difference is named.
"""

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final, Self

from scenic.batch.folders.lock import LOCK, Lock
from scenic.dataclass import dataclass
from scenic.formats.files import make_folder, write
from scenic.language.errors import Located
from scenic.runtime.ground.files import discard_unfinished

__all__ = ["NAME", "FolderKind", "WrittenFolder", "changes_of", "check_files"]

NAME: Final = "manifest.json"
"""Name of the manifest in its folder."""

_NAMED: Final = 3
"""Changed files that a message names, at most."""


@dataclass(frozen=True, slots=True)
class FolderKind:
    """A kind of folders.

    Attributes:
        format: its name in manifests.
        version: of manifests.
        noun: its name in messages.
        maker: the command that makes such folders.
        error: raised where a folder cannot be used.
        missing: raised where there is no manifest.

    """

    format: str
    version: int
    noun: str
    maker: str
    error: type[Located]
    missing: type[Located]

    def document(self, folder: Path) -> dict[str, Any]:
        """The manifest of a folder, without its format and version; raises ``error`` or ``missing``."""
        path = folder / NAME
        if folder.is_file():
            raise self.missing(
                f"'{folder}' is a file, not a {self.noun}", help=f"name a folder that {self.maker} has made"
            )
        try:
            content = json.loads(path.read_bytes())
        except FileNotFoundError:
            raise self.missing(
                f"there is no {self.noun} in '{folder}': it has no {NAME}",
                help=f"give the folder that {self.maker} has made",
            ) from None
        except (OSError, ValueError) as error:
            raise self.error(f"'{path}' cannot be read: {error}") from error
        if not isinstance(content, dict) or content.pop("format", None) != self.format:
            raise self.error(
                f"'{path}' cannot be read: it is not the manifest of a {self.noun}",
                help=f"give the folder that {self.maker} has made",
            )
        version = content.pop("version", None)
        if not isinstance(version, int) or isinstance(version, bool):
            raise self.error(f"the manifest '{path}' is damaged: `version` is {version!r}, not an integer")
        if version > self.version:
            raise self.error(f"'{path}' cannot be read: a later version of scenic wrote it")
        return content


class WrittenFolder:
    """A folder while a command writes it: a context that holds its lock.

    A folder that is made and remains without content vanishes at the end.

    Args:
        path: the folder.
        kind: its kind.

    Raises:
        BusyError: if another command is writing it.
        OutputError: if it cannot be made.

    """

    def __init__(self, path: Path, kind: FolderKind) -> None:
        self.path = path
        self.kind = kind
        self._lock = Lock(path / LOCK, path)
        self._is_new = False

    def __enter__(self) -> Self:
        self._is_new = not self.path.exists()
        make_folder(self.path)
        self._lock.__enter__()
        discard_unfinished(self.path)
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if not (self._is_new and kind is not None and self._is_void()):
            self._lock.__exit__()
            return
        for path in self.path.iterdir():
            if path.name != LOCK:
                path.unlink()
        self._lock.__exit__()
        with suppress(OSError):  # another command has begun there
            self.path.rmdir()

    def _is_void(self) -> bool:
        """Return whether nothing has come of the folder: it has a manifest at most, and empty files."""
        return all(
            item.name in (NAME, LOCK) or (item.is_file() and not item.stat().st_size)
            for item in self.path.iterdir()
        )

    @property
    def has_manifest(self) -> bool:
        """Return whether something has been written there before."""
        return (self.path / NAME).exists()

    def document(self) -> dict[str, Any]:
        """Return the manifest as plain data; see `FolderKind.document`."""
        return self.kind.document(self.path)

    def save(self, content: Mapping[str, object]) -> None:
        """Write the manifest; raises ``OutputError``."""
        head = {"format": self.kind.format, "version": self.kind.version}
        write(self.path / NAME, (json.dumps({**head, **content}, indent=1) + "\n").encode())

    def check_without(self, pattern: str) -> None:
        """Raise the kind's error if there are files of these names, which no manifest explains."""
        for file in self.path.glob(pattern):
            raise self.kind.error(
                f"'{self.path}' holds '{file.name}', and no manifest that says how it was made",
                help="name an empty folder, or a new one",
            )


def changes_of(before: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    """Return words for the files whose content has changed."""
    words = []
    for name in sorted({*before, *now}):
        if name not in now:
            words.append(f"'{name}' is no longer used")
        elif name not in before:
            words.append(f"'{name}' is used, too")
        elif before[name] != now[name]:
            words.append(f"'{name}' has changed" if now[name] != "missing" else f"'{name}' is missing")
    return words


def check_files(
    target: Path,
    error: type[Located],
    before: Mapping[str, str],
    now: Mapping[str, str],
    *,
    accepted: bool,
) -> list[str]:
    """Raise ``error`` if files that decide the content of ``target`` have changed, unless that is accepted; returns the changes."""
    changes = changes_of(before, now)
    if changes and not accepted:
        more = f", and {len(changes) - _NAMED} more" if len(changes) > _NAMED else ""
        raise error(
            f"files that decide the content of '{target}' have changed: {', '.join(changes[:_NAMED])}{more}",
            help="put them back, or write to another place; --accept-changes goes on, and notes the change in the manifest",
        )
    return changes
