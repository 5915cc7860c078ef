"""A source text with its lines, and the places of syntax nodes in it."""

import ast
import os
from dataclasses import field
from pathlib import Path
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.errors import MissingFileError, ScenicError
from scenic.language.spans import Span
from scenic.language.spelling import nearest

__all__ = ["Source", "read_source"]

_MOST_FOLDERS: Final = 200
"""Number of folders in which a file that is missing is looked for."""
_BYTE_ORDER_MARK: Final = "\ufeff"


@dataclass(frozen=True, slots=True)
class Source:
    r"""A source text and where it comes from.

    ``text`` has no byte order mark and ``\n`` at each line end, as Python reads it. ``lines`` are its lines
    without their ends; after a line end at the end of the text there is one more, empty line.
    """

    text: str
    filename: str
    lines: tuple[str, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        text = self.text.lstrip(_BYTE_ORDER_MARK)
        if "\r" in text:
            text = text.replace("\r\n", "\n").replace("\r", "\n")
        object.__setattr__(self, "text", text)
        object.__setattr__(self, "lines", tuple(text.split("\n")))

    @staticmethod
    def decode(data: bytes, filename: str) -> str:
        """Return the text of a source file; encodings other than UTF-8 are not supported.

        Raises `ScenicError` with code SC107 and the place of the first bad byte.
        """
        try:
            return data.decode("utf-8").lstrip(_BYTE_ORDER_MARK)
        except UnicodeDecodeError as error:
            raise _not_utf8(data, error.start, filename) from None

    def line(self, number: int) -> str:
        """The text of a line, from 1, without its end; empty if there is no such line."""
        return self.lines[number - 1] if 1 <= number <= len(self.lines) else ""

    def character(self, line: int, byte: int) -> int:
        """Return the column in characters of a column in UTF-8 bytes; past the end of the line, its length.

        Inside a character, the column of that character.
        """
        content = self.line(line)
        if content.isascii():
            return min(byte, len(content))
        return len(content.encode("utf-8", "surrogatepass")[:byte].decode("utf-8", "ignore"))

    def byte(self, line: int, character: int) -> int:
        """Return the column in UTF-8 bytes of a column in characters; past the end of the line, its length."""
        return len(self.line(line)[:character].encode("utf-8", "surrogatepass"))

    def span(self, node: ast.AST) -> Span:
        """The place of a node; if it has none, that of its parts, and of the beginning if they have none.

        Nodes that come from elsewhere never make it fail: places outside the text are moved to its end.
        """
        start: tuple[int, int] | None = _start(node)
        end: tuple[int, int] | None = _end(node)
        if start is None or end is None:
            parts = list(ast.walk(node))
            start = min(filter(None, map(_start, parts)), default=(1, 0))
            end = max(filter(None, map(_end, parts)), default=start)
        line, column = self._place(*start)
        end_line, end_column = self._place(*end)
        if (end_line, end_column) < (line, column):
            end_line, end_column = line, column
        return Span(line, column, end_line, end_column)

    def _place(self, line: int, byte: int) -> tuple[int, int]:
        if line > len(self.lines):
            return len(self.lines), len(self.lines[-1])
        return max(line, 1), self.character(line, max(byte, 0))


def read_source(path: str | os.PathLike[str]) -> Source:
    """Read a source file; the filename of the result is ``path`` as given.

    Raises `ScenicError`: with code SC600 if the file cannot be read, with code SC107 if it is not UTF-8.
    """
    filename = os.fspath(path)
    try:
        data = Path(filename).read_bytes()
    except FileNotFoundError:
        raise MissingFileError(
            "there is no such file", code="SC600", filename=filename, help=_whereabouts(Path(filename))
        ) from None
    except IsADirectoryError:
        raise _unreadable(filename, "this is a directory, not a file", "name the files in it") from None
    except PermissionError:
        raise _unreadable(filename, "no permission to read the file", "change its permissions") from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise _unreadable(filename, f"the file cannot be read: {reason}", "check the path") from None
    return Source(Source.decode(data, filename), filename)


def _whereabouts(path: Path) -> str:
    """Return advice about a file that does not exist: a similar name, or the part of the path that exists."""
    there = path.parent
    while not there.is_dir() and there != there.parent:
        there = there.parent
    missing = path.relative_to(there).parts[0] if path.is_relative_to(there) else path.name
    # A search from an absolute path may take long: these come from editors more than from hands.
    if there == path.parent and not path.is_absolute() and (inside := _in_folders(there, path.name)):
        return f"did you mean `{inside}`?"
    try:
        near = nearest(missing, (item.name for item in there.iterdir()))
    except OSError:
        near = None
    if near is not None:
        return f"did you mean `{there / near}`?"
    if there == path.parent:
        return "check the path"
    where = "the working directory" if there == Path() else f"`{there}`"
    return f"check the path: {where} has no `{missing}`"


def _in_folders(folder: Path, name: str) -> Path | None:
    """The file of a name that lies nearest below a folder, among the first folders that are looked into."""
    waiting = [folder]
    for _ in range(_MOST_FOLDERS):
        if not waiting:
            return None
        current = waiting.pop(0)
        try:
            entries = sorted(item for item in current.iterdir() if not item.name.startswith("."))
            folders = [item for item in entries if item.is_dir() and not item.is_symlink()]
        except OSError:  # without permission to look
            continue
        here = current / name
        if here in entries and here not in folders:
            return here
        waiting += folders
    return None


def _unreadable(filename: str, message: str, advice: str) -> ScenicError:
    return ScenicError(message, code="SC600", filename=filename, help=advice)


def _not_utf8(data: bytes, bad: int, filename: str) -> ScenicError:
    before = data[:bad].decode("utf-8").lstrip(_BYTE_ORDER_MARK)
    lines = before.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    line, column = len(lines), len(lines[-1])
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        advice = "it looks like UTF-16: save it as UTF-8"
    elif b"\0" in data[:1024]:
        advice = "it does not look like a text file"
    else:
        advice = "save the file in the encoding UTF-8"
    return ScenicError(
        f"byte 0x{data[bad]:02x} is not UTF-8 text",
        code="SC107",
        span=Span(line, column, line, column),
        filename=filename,
        help=advice,
    )


def _start(node: ast.AST) -> tuple[int, int] | None:
    line = getattr(node, "lineno", None)
    column = getattr(node, "col_offset", None)
    return None if line is None or column is None else (line, column)


def _end(node: ast.AST) -> tuple[int, int] | None:
    line = getattr(node, "end_lineno", None)
    column = getattr(node, "end_col_offset", None)
    return _start(node) if line is None or column is None else (line, column)
