"""Files that are complete or absent.

A file is written under a temporary name in its own folder, flushed to the disk and only then given its name; on
any error, Ctrl-C included, the temporary file is removed and what had the name before is untouched.
"""

import contextlib
import hashlib
import os
import re
import secrets
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, Final

from scenic.language.errors import Located

_UNFINISHED: Final = re.compile(r"\..+\.[0-9a-f]{12}\.part")
"""Temporary names of `writing`."""


class OutputError(Located):
    """A file that cannot be written, and why."""

    code = "SC601"


def _refusal(path: Path, reason: str, help: str | None = None) -> OutputError:
    return OutputError(f"cannot write '{path}': {reason}", help=help)


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()


def is_special(path: Path) -> bool:
    """Return whether the path names a device or a pipe, which cannot be renamed."""
    try:
        mode = path.stat().st_mode
    except OSError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


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
    """A binary file that gets the name ``path`` when the block ends well and vanishes when it does not.

    Links are followed, so a link keeps pointing where it did. Devices and pipes are written to directly. The
    permissions are those of the file replaced, else the usual ones of a new file.

    Raises ``OutputError`` if the file cannot be made or written.
    """
    if is_special(path):
        try:
            with path.open("wb") as device:
                yield device
        except BrokenPipeError:
            raise
        except OSError as error:
            raise _refusal(path, _reason(error)) from error
        return
    target = path.resolve()
    check_writable(target)
    temporary = target.with_name(f".{target.name[:100]}.{secrets.token_hex(6)}.part")
    try:
        # The kernel applies the user's umask to these permissions.
        descriptor = os.open(
            temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666
        )
    except OSError as error:
        raise _refusal(path, _reason(error)) from error
    try:
        try:
            with os.fdopen(descriptor, "wb") as stream:
                yield stream
                stream.flush()
                with contextlib.suppress(FileNotFoundError):
                    os.chmod(temporary, stat.S_IMODE(target.stat().st_mode))
                os.fsync(stream.fileno())
            os.replace(temporary, target)
        except OSError as error:
            raise _refusal(path, _reason(error)) from error
        _flush_folder(target.parent)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise


def discard_unfinished(folder: Path) -> None:
    """Remove the files that `writing` leaves in a folder if its process is killed; no other process may write there."""
    for path in folder.glob(".*.part"):
        if _UNFINISHED.fullmatch(path.name):
            path.unlink(missing_ok=True)


class Waiting:
    """A file without a name in the folder of ``path``, to become the file of that name; raises ``OutputError``."""

    def __init__(self, path: Path) -> None:
        import tempfile  # slow to import

        self._path = path
        with refusing(path):
            self.stream: BinaryIO = tempfile.TemporaryFile(dir=path.resolve().parent)  # noqa: SIM115 - `close` does

    def write(self, content: bytes) -> None:
        """Append to it."""
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
    except OSError as error:
        raise _refusal(path, _reason(error)) from error


def write(path: Path, content: bytes) -> None:
    """Write a whole file, or none; raises ``OutputError``."""
    with writing(path) as stream:
        stream.write(content)


def _flush_folder(folder: Path) -> None:
    """Make the new name itself last, on systems that can."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def numbered(path: Path, k: int, count: int) -> Path:
    """The file of scene ``k`` of ``count``: ``room.glb`` itself for one, ``room-007.glb`` for more."""
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
