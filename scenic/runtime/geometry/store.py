"""Store on disk of arrays that are expensive to compute, by the content that they follow from.

The store only saves time: where it cannot be read or written, things are computed. Files hold arrays alone (nothing
is ever unpickled), appear whole or not at all, so that any number of processes may share a store, and the ones used
longest ago go first when it grows beyond `MOST_BYTES`.

Two environment variables govern it: ``SCENIC_CACHE=off`` turns it off; ``SCENIC_CACHE_DIR`` names its folder, by default
``scenic`` in ``XDG_CACHE_HOME`` or ``~/.cache``.
"""

import contextlib
import hashlib
import io
import json
import os
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt

Arrays: TypeAlias = Mapping[str, npt.NDArray[Any]]

MOST_BYTES: Final = 256 << 20
"""Size that the store may grow to."""

_SUFFIX: Final = ".arrays"
"""Of files: a checksum, the names as JSON, the arrays in NumPy's own format. An archive takes longer to open."""

_PROGRAMS: Final = "programs"
"""The folder in the store for compiled programs (`scenic.compiler.loader`)."""

_KEPT: Final = 0.75
"""Part of the size that is left after a clearance."""


def digest_of(*arrays: npt.NDArray[Any]) -> bytes:
    """The digest of the content of arrays, their types and shapes included."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.dtype.str}{array.shape}\0".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.digest()


def kept(
    kind: str, content: bytes, compute: Callable[[], Arrays], *, read: bool = True, write: bool = True
) -> Arrays:
    """Return ``compute()``, or the result that an earlier run stored.

    Args:
        kind: a name and a version of what is computed; a new version whenever the result changes.
        content: the digest of all that it is computed from.
        compute: returns named arrays, none of them of objects.
        read: use an earlier result if there is one.
        write: keep the result for later runs.

    """
    arrays = find(kind, content) if read else None
    if arrays is None:
        arrays = compute()
        if write:
            keep(kind, content, arrays)
    return arrays


def find(kind: str, content: bytes) -> Arrays | None:
    """Return the arrays that an earlier run stored, ``None`` where there are none; the arguments are those of `kept`."""
    path = _path(kind, content)
    return None if path is None else _read(path)


def keep(kind: str, content: bytes, arrays: Arrays) -> None:
    """Leave arrays for later runs; the arguments are those of `kept`."""
    path = _path(kind, content)
    if path is not None:
        _write(path, arrays)


def is_kept(kind: str, content: bytes) -> bool:
    """Return whether an earlier run left what `kept` would otherwise compute."""
    path = _path(kind, content)
    return path is not None and path.exists()


def store_folder() -> Path | None:
    """The folder of the store; ``None`` if it is turned off, or if there is no home folder."""
    if os.environ.get("SCENIC_CACHE", "").lower() in ("off", "0", "no", "false"):
        return None
    folder = os.environ.get("SCENIC_CACHE_DIR")
    if folder:
        return Path(folder)
    base = os.environ.get("XDG_CACHE_HOME")
    try:
        return Path(base) / "scenic" if base else Path.home() / ".cache" / "scenic"
    except RuntimeError:  # there is no home
        return None


def programs_folder() -> Path | None:
    """The folder of compiled programs in the store, if there is a store."""
    folder = store_folder()
    return None if folder is None else folder / _PROGRAMS


def _path(kind: str, content: bytes) -> Path | None:
    """Return the file for some content; ``None`` if the store is turned off."""
    folder = store_folder()
    key = hashlib.sha256(kind.encode() + b"\0" + content).hexdigest()
    return None if folder is None else folder / f"{key}{_SUFFIX}"


def _read(path: Path) -> Arrays | None:
    try:
        checksum, _, content = path.read_bytes().partition(b"\n")
        if checksum != _checksum(content):
            return None
        stream = io.BytesIO(content)
        names = json.loads(stream.readline())
        arrays = {name: np.lib.format.read_array(stream, allow_pickle=False) for name in names}
    except (OSError, ValueError, EOFError):
        # Not there, or no file of ours: what is computed takes its place.
        return None
    with contextlib.suppress(OSError):
        os.utime(path)
    return arrays


def _checksum(content: bytes) -> bytes:
    return b"%08x" % zlib.crc32(content)


def _write(path: Path, arrays: Arrays) -> None:
    import tempfile  # only where something is written, and slow to import

    stream = io.BytesIO()
    stream.write(json.dumps(list(arrays)).encode() + b"\n")
    for array in arrays.values():
        np.lib.format.write_array(stream, np.asanyarray(array), allow_pickle=False)
    content = stream.getvalue()
    with contextlib.suppress(OSError):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, prefix=".", suffix=".part", delete=False) as part:
            try:
                part.write(_checksum(content) + b"\n" + content)
                part.close()
                os.replace(part.name, path)
            except BaseException:
                os.unlink(part.name)
                raise
        _make_room(path.parent)


def kept_files(folder: Path) -> list[tuple[int, int, Path]]:
    """The files of a store: when each was last used (nanoseconds), its bytes, and its path."""
    files = []
    programs = folder / _PROGRAMS
    for path in (
        *folder.glob(f"*{_SUFFIX}"),
        *folder.glob("*.npz"),  # which earlier versions wrote
        *programs.glob("*.program"),
    ):
        with contextlib.suppress(OSError):  # another process may have removed it
            status = path.stat()
            files.append((status.st_mtime_ns, status.st_size, path))
    return files


def clear() -> int:
    """Remove everything that is kept; the number of bytes that were removed."""
    folder = store_folder()
    removed = 0
    for _, size, path in [] if folder is None else kept_files(folder):
        with contextlib.suppress(OSError):
            path.unlink()
            removed += size
    return removed


def _make_room(folder: Path) -> None:
    """Remove the files used longest ago if there are too many bytes."""
    files = kept_files(folder)
    total = sum(size for _, size, _ in files)
    if total <= MOST_BYTES:
        return
    for _, size, path in sorted(files):
        if total <= _KEPT * MOST_BYTES:
            return
        with contextlib.suppress(OSError):
            path.unlink()
        total -= size
