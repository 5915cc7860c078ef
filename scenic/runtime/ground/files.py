"""Files that are complete or absent; what goes wrong keeps Python's own exception, with the name of the file.

A file is written under a temporary name in its own folder, flushed to the disk and only then given its name. On any error, Ctrl-C
included, the temporary file is removed, and what had the name before is untouched.
"""

import os
import re
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final

__all__ = ["discard_unfinished", "is_special", "named", "naming", "unnamed", "whole"]

_UNFINISHED: Final = re.compile(r"\..+\.[0-9a-f]{12}(\.[^.]*)?\.part")
"""Temporary names of `whole`."""


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Name for files without a name in errors."""
    try:
        yield
    except OSError as error:
        if error.filename is None:
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


def is_special(path: Path) -> bool:
    """Return whether the path names a device or a pipe, which cannot be renamed."""
    try:
        mode = path.stat().st_mode
    except OSError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def unnamed(path: Path) -> BinaryIO:
    """Return a file in the folder of another one."""
    import tempfile  # slow to import

    with naming(path):
        return tempfile.TemporaryFile(dir=path.resolve().parent)


def named(path: Path, suffix: str) -> Path:
    """An empty file beside another one, under a name of its own."""
    temporary = path.with_name(f".{path.name[:100]}.{secrets.token_hex(6)}{suffix}")
    # The kernel applies the user's umask to these permissions.
    os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    return temporary


@contextmanager
def whole(path: Path) -> Iterator[BinaryIO]:
    """Open a binary file that gets the name ``path`` when the block ends well and vanishes when it does not.

    Links are followed, so a link keeps pointing where it did. Devices and pipes are written to directly. The permissions are those of
    the file replaced, else the usual ones of a new file.
    """
    if is_special(path) or path.is_dir():
        with naming(path), path.open("wb") as stream:
            yield stream
        return
    target = path.resolve()
    temporary = named(target, f"{target.suffix[:20]}.part")
    try:
        with naming(path):
            with temporary.open("w+b") as stream:
                yield stream
                stream.flush()
                with suppress(FileNotFoundError):
                    os.chmod(temporary, stat.S_IMODE(target.stat().st_mode))
                os.fsync(stream.fileno())
            temporary.replace(target)
    except BaseException:
        with suppress(OSError):
            temporary.unlink()
        raise
    _flush_folder(target.parent)


def discard_unfinished(folder: Path) -> None:
    """Remove the files that `whole` leaves in a folder if its process is killed; no other process may write there."""
    for path in folder.glob(".*.part"):
        if _UNFINISHED.fullmatch(path.name):
            path.unlink(missing_ok=True)


def _flush_folder(folder: Path) -> None:
    """Make the new name itself last, on systems that can."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
