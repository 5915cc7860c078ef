"""A file of lines that grows, and can be taken up again after whatever ended its run.

While it grows it has the name of the file with ``.part`` after it, and holds whole lines but for, at most, the last one of
a run that was killed. It gets its own name when it is complete: a run that is
ended, by Ctrl-C or an error, leaves the lines that there are in the ``.part``. A device or a pipe is written to as it is.
"""

import contextlib
import os
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, BinaryIO, Self

from scenic.formats.files import OutputError, check_writable
from scenic.runtime.ground.files import is_special

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class GrowingFile:
    """The file at ``path``, open for more lines.

    Args:
        path: the file.
        resume: whether to go on after the lines of an earlier run.

    Raises ``OutputError`` if it cannot be made or written.

    """

    def __init__(self, path: Path, *, resume: bool = False) -> None:
        check_writable(path)
        self._is_special = is_special(path)
        self.path = path if self._is_special else path.resolve()
        self.part = self.path.with_name(f"{self.path.name}.part")
        self._stream: BinaryIO | None = None
        self._resume = resume
        self._is_empty = True

    def kept(self) -> list[bytes]:
        """The whole lines of the earlier run that is resumed; a torn last line is left out."""
        if not self._resume or self._is_special:
            return []
        return max(self._lines(self.part), self._lines(self.path), key=len)

    def _lines(self, path: Path) -> list[bytes]:
        """Return the whole lines of a file; none if it is not there."""
        try:
            data = path.read_bytes()
        except FileNotFoundError:
            return []
        except OSError as error:
            raise _refusal(self.path, error) from error
        return data[: data.rfind(b"\n") + 1].splitlines(keepends=True)

    def lines_kept(self) -> list[bytes]:
        """Return the whole lines that a run which was ended has left."""
        return [] if self._is_special else self._lines(self.part)

    def __enter__(self) -> Self:
        lines = self.kept()
        try:
            if self._is_special:
                # A device or a pipe keeps its name, and has no content to go on with.
                self._stream = self.path.open("wb")
                return self
            if (
                self._resume
                and self.path.exists()
                and not (self.part.exists() and len(self._lines(self.part)) >= len(lines))
            ):
                os.replace(self.path, self.part)
            self._stream = self.part.open("r+b" if self._resume and self.part.exists() else "wb")
            self._stream.truncate(sum(map(len, lines)))
            self._stream.seek(0, os.SEEK_END)
        except OSError as error:
            raise _refusal(self.path, error) from error
        self._is_empty = not lines
        return self

    def write(self, lines: "ReadableBuffer") -> None:
        """Add whole lines; they are in the file when this returns, whatever happens to the process."""
        assert self._stream is not None
        try:
            self._stream.write(lines)
            self._stream.flush()
        except BrokenPipeError:
            raise
        except OSError as error:
            raise _refusal(self.path, error) from error
        self._is_empty = self._is_empty and not memoryview(lines).nbytes

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, place: TracebackType | None
    ) -> None:
        assert self._stream is not None
        with contextlib.suppress(OSError):
            os.fsync(self._stream.fileno())
        with contextlib.suppress(OSError):
            self._stream.close()
        if self._is_special:
            return
        if self._is_empty and kind is not None:
            self.part.unlink(missing_ok=True)
        elif kind is None:
            os.replace(self.part, self.path)


def _refusal(path: Path, error: OSError) -> OutputError:
    return OutputError(f"cannot write '{path}': {(error.strerror or str(error)).lower()}")
