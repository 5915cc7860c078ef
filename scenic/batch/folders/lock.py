"""Locks of folders and files that are being written: one writer at a time, and none left by a process that was killed.

A lock is a lock of the operating system on a small file, which says who holds it. The system gives it up when its process ends,
however that ends; network file systems pass such locks on to other machines (NFS, Lustre, CephFS). Where a file system has no
locks, the file alone says that somebody is writing: a holder on another machine counts as alive until the file is removed.
"""

import errno
import json
import os
import platform
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Final, Self

from scenic.dataclass import dataclass
from scenic.formats.files import OutputError, make_folder
from scenic.language.errors import Located
from scenic.runtime.ground.context import warn
from scenic.runtime.ground.files import is_special

__all__ = ["LOCK", "BusyError", "Lock", "lock_beside", "locked"]

LOCK: Final = ".lock"
"""Name of the lock of a folder."""

_WITHOUT_LOCKS: Final = frozenset(
    number
    for name in ("ENOLCK", "ENOSYS", "EOPNOTSUPP", "ENOTSUP")
    if (number := getattr(errno, name, None)) is not None
)
_TRIES: Final = 5
_PAUSE: Final = 0.02
"""Seconds between readings of a lock whose holder has not yet written its name."""


class BusyError(Located):
    """A folder or file that another process is writing."""

    code = "SC615"


def lock_beside(path: Path) -> "Lock":
    """The lock of a single file."""
    whole = path.resolve()
    return Lock(whole.with_name(f".{whole.name[:100]}.lock"), path)


@contextmanager
def locked(path: Path, *, is_folder: bool = False) -> Iterator[None]:
    """Hold the lock of a place, which is made if it is a folder, within a ``with`` block; a device or a pipe has none."""
    if is_special(path):
        yield
        return
    if is_folder:
        make_folder(path)
    try:
        with Lock(path / LOCK, path) if is_folder else lock_beside(path):
            yield
    finally:
        if is_folder:
            with suppress(OSError):  # it has content
                path.rmdir()


class Lock:
    """The right to write something, held within a ``with`` block.

    Args:
        path: the file that is locked; made if it is not there, and removed at the end.
        target: the folder or file that it protects, for messages.

    Raises:
        BusyError: if another process, or another part of this one, holds it.
        OutputError: if the file cannot be made.

    """

    def __init__(self, path: Path, target: Path) -> None:
        self._path = path
        self._target = target
        self._descriptor: int | None = None

    def __enter__(self) -> Self:
        while True:
            try:
                descriptor = os.open(self._path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
            except OSError as error:
                reason = (error.strerror or str(error)).lower()
                raise OutputError(f"cannot write '{self._target}': {reason}") from error
            try:
                self._take(descriptor)
            except BaseException:
                os.close(descriptor)
                raise
            if self._is_current(descriptor):
                break
            os.close(descriptor)  # its last holder has removed it meanwhile
        self._descriptor = descriptor
        if hasattr(os, "register_at_fork"):
            # A process that is forked must not hold the lock when this one has been killed.
            os.register_at_fork(after_in_child=_Forgetting(self))
        start_time = datetime.now().astimezone().isoformat(timespec="seconds")
        holder = _Holder(platform.node(), os.getpid(), start_time)
        os.ftruncate(descriptor, 0)
        os.write(descriptor, json.dumps(asdict(holder)).encode())
        return self

    def _take(self, descriptor: int) -> None:
        try:
            _lock(descriptor)
        except (BlockingIOError, PermissionError):
            raise self._busy() from None
        except OSError as error:
            if error.errno not in _WITHOUT_LOCKS:
                reason = (error.strerror or str(error)).lower()
                raise OutputError(f"cannot lock '{self._target}': {reason}") from error
            if self._may_be_alive():
                raise self._busy(
                    f"wait until it has ended, or name another place; if it has ended already, remove '{self._path}'"
                ) from None
            warn(
                f"the file system of '{self._target}' has no locks: a second command that writes there is not noticed",
                help="write to one place by one command at a time",
            )

    def _is_current(self, descriptor: int) -> bool:
        try:
            there = self._path.stat()
        except FileNotFoundError:
            return False
        here = os.fstat(descriptor)
        return (here.st_dev, here.st_ino) == (there.st_dev, there.st_ino)

    def _busy(
        self, help: str = "wait until it has ended, then go on by --resume; or name another place"
    ) -> BusyError:
        words = ""
        for _ in range(_TRIES):
            if (holder := self._holder()) is not None:
                words = f": process {holder.process} on {holder.host}, since {holder.started}"
                break
            time.sleep(_PAUSE)
        return BusyError(f"another command is writing '{self._target}'{words}", help=help)

    def _holder(self) -> "_Holder | None":
        """Return the process that the file names, if it names one."""
        with suppress(OSError, ValueError, TypeError):
            return _Holder(**json.loads(self._path.read_bytes()))
        return None

    def _may_be_alive(self) -> bool:
        """Return whether the process that the file names may still be writing; what other machines run cannot be seen."""
        holder = self._holder()
        if holder is None or holder.process == os.getpid():
            return holder is not None
        if holder.host != platform.node():
            return True
        try:
            os.kill(holder.process, 0)
        except ProcessLookupError:
            return False
        except (OSError, OverflowError, TypeError):
            return True
        return True

    def __exit__(self, *_: object) -> None:
        if self._descriptor is not None:
            with suppress(OSError):  # Windows removes no open file: the next holder does
                self._path.unlink()
            self.forget()

    def forget(self) -> None:
        """Close the file, which in the last process that has it open gives up the lock."""
        descriptor, self._descriptor = self._descriptor, None
        if descriptor is not None:
            with suppress(OSError):
                os.close(descriptor)


@dataclass(frozen=True, slots=True)
class _Holder:
    """The content of the file: who holds the lock, and since when."""

    host: str
    process: int
    started: str


class _Forgetting:
    """Closes a lock in processes that are forked, as long as it exists."""

    def __init__(self, lock: Lock) -> None:
        self._lock = weakref.ref(lock)

    def __call__(self) -> None:
        lock = self._lock()
        if lock is not None:
            lock.forget()


if os.name == "nt":
    import msvcrt

    _FAR: Final = 1 << 30
    """The byte that is locked, beyond the name of the holder, which others may read."""

    def _lock(descriptor: int) -> None:
        os.lseek(descriptor, _FAR, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        os.lseek(descriptor, 0, os.SEEK_SET)

else:
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
