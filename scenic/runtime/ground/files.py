"""Files that are there when they are whole; what goes wrong keeps Python's own exception, with the name of the file."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

__all__ = ["named", "naming", "unnamed", "whole"]


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Name for files without a name in errors."""
    try:
        yield
    except OSError as error:
        if error.filename is None:
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


def unnamed(path: Path) -> BinaryIO:
    """A file in the folder of another one."""
    import tempfile  # slow to import

    with naming(path):
        return tempfile.TemporaryFile(dir=path.parent)


def named(path: Path) -> Path:
    """An empty file beside another one, under a name of its own."""
    temporary = path.with_name(f".{path.name[:100]}.{secrets.token_hex(6)}{path.suffix}")
    # The kernel applies the user's umask to these permissions.
    os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    return temporary


@contextmanager
def whole(path: Path) -> Iterator[BinaryIO]:
    """A file that is there when it is whole; a device or a pipe keeps its name, and is written to."""
    if path.exists() and not path.is_file():
        with naming(path), path.open("wb") as stream:
            yield stream
        return
    temporary = named(path)
    try:
        with naming(path), temporary.open("w+b") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
