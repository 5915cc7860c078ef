"""Files that are complete or absent (`scenic.runtime.ground.files`), with errors that name the place, the cause and the remedy."""

import contextlib
import hashlib
import os
import re
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, Final

from scenic.language.errors import Located
from scenic.runtime.ground.files import is_special, unnamed, whole


class OutputError(Located):
    """A file that cannot be written, and why."""

    code = "SC601"


def _refusal(path: Path, reason: str, help: str | None = None) -> OutputError:
    return OutputError(f"cannot write '{path}': {reason}", help=help)


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()


def check_writable(path: Path) -> None:
    """Raise ``OutputError`` now if a file could not be written at ``path`` later."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        pass
    except OSError as error:
        raise _refusal(path, _reason(error)) from error
    else:
        if stat.S_ISDIR(mode):
            raise _refusal(path, "it is a folder", "give the name of a file in it")
        if not os.access(path, os.W_OK):
            raise _refusal(path, "permission denied")
        if not stat.S_ISREG(mode):
            return
    check_folder(path.resolve().parent)


def check_folder(folder: Path) -> None:
    """Raise ``OutputError`` if no file can be made in ``folder``."""
    if not folder.exists():
        raise OutputError(f"the folder '{folder}' does not exist", help=f"make it first: mkdir -p '{folder}'")
    if not folder.is_dir():
        raise OutputError(f"'{folder}' is not a folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputError(f"no file can be made in the folder '{folder}': permission denied")


def make_folder(folder: Path) -> None:
    """Make a folder, and those that it is to be in, unless it is there; raises ``OutputError``."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise OutputError(f"'{folder}' is not a folder", help="give the name of a folder") from None
    except OSError as error:
        raise OutputError(f"cannot make the folder '{folder}': {_reason(error)}") from error
    check_folder(folder)


@contextlib.contextmanager
def writing(path: Path) -> Iterator[BinaryIO]:
    """Open the file of `whole`; raises ``OutputError`` if it cannot be made or written, at once where that can be known."""
    if not is_special(path):
        check_writable(path.resolve())
    with refusing(path), whole(path) as stream:
        yield stream


class Waiting:
    """A file without a name in the folder of ``path``, to become the file of that name; raises ``OutputError``."""

    def __init__(self, path: Path) -> None:
        self._path = path
        with refusing(path):
            self.stream = unnamed(path)

    def write(self, content: bytes) -> None:
        """Append to the file."""
        with refusing(self._path):
            self.stream.write(content)

    def copy(self, target: BinaryIO) -> None:
        """Write all of it to a file."""
        from shutil import copyfileobj  # slow to import

        with refusing(self._path):
            self.stream.seek(0)
            copyfileobj(self.stream, target)

    def close(self) -> None:
        """Forget it."""
        with contextlib.suppress(OSError):  # it may be what could not be written
            self.stream.close()


@contextlib.contextmanager
def refusing(path: Path) -> Iterator[None]:
    """Errors of the system within this become an ``OutputError`` of the file ``path``."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise _refusal(path, _reason(error)) from error


def write(path: Path, content: bytes) -> None:
    """Write a whole file, or none; raises ``OutputError``."""
    with writing(path) as stream:
        stream.write(content)


def numbered(path: Path, k: int, count: int) -> Path:
    """Return the file of scene ``k`` of ``count``: ``room.glb`` itself for one, ``room-007.glb`` for more."""
    if count == 1:
        return path
    digits = max(3, len(str(count - 1)))
    return path.with_name(f"{path.stem}-{k:0{digits}d}{path.suffix}")


def safe_name(text: str) -> str:
    """A name of a file or folder that stands for a text: the text itself where it can be, else with a digest, so that texts stay different."""
    plain = _UNSAFE.sub("_", text).strip(". ")
    if plain == text and text:
        return text
    return f"{plain[:80]}-{hashlib.sha256(text.encode('utf-8', 'surrogatepass')).hexdigest()[:8]}"


_UNSAFE: Final = re.compile(r'[\x00-\x1f\x7f<>:"/\\|?*\ud800-\udfff]')
"""Characters that names of files may not have on some system."""
