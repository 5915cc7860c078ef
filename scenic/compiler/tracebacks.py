"""From Python frames and tracebacks back to places in the program.

Code generated from a program is recognised by its globals, which hold the prelude. Its positions are exact, but count
UTF-8 bytes; the text that turns them into characters comes from the module's own globals (`SOURCE_NAME`) if it was put
there, as for programs that are no files, and else from the file.
"""

import linecache
import os
import re
import sys
import sysconfig
import traceback
from collections.abc import Iterator
from functools import cache
from itertools import islice
from pathlib import Path
from types import CodeType, FrameType, TracebackType
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.generated_code import PRELUDE
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["SOURCE_NAME", "Locator", "TracedPlace", "format_traceback", "locate", "raised_at"]

SOURCE_NAME: Final = "__scenic_source__"
"""A global of generated modules that may hold their `Source`; without it the text is read from the file."""


@dataclass(frozen=True, slots=True)
class TracedPlace:
    """A place in a program."""

    filename: str
    span: Span


_Positions = tuple[int | None, int | None, int | None, int | None]


class Locator:
    """Finds places, and caches them for repeated calls."""

    def __init__(self) -> None:
        self._positions: dict[int, tuple[CodeType, list[_Positions]]] = {}
        self._places: dict[tuple[int, int], TracedPlace | None] = {}
        self._quotable: dict[int, tuple[TracedPlace, object]] = {}
        self._names: dict[tuple[int, int], tuple[str, int]] = {}

    def place(self, where: TracebackType | FrameType, instruction: int | None = None) -> TracedPlace | None:
        """Locate a frame of generated code, as `locate` does, at an earlier ``instruction``."""
        frame_place = (
            _innermost(where)
            if instruction is None or not isinstance(where, FrameType)
            else (where, instruction)
        )
        if frame_place is None:
            return None
        frame, instruction = frame_place
        key = (id(frame.f_code), instruction)
        if key not in self._places:
            place = self._places[key] = _place(frame, self._position(frame.f_code, instruction))
            if place is not None:
                self._quotable[id(place.span)] = place, frame.f_globals.get(SOURCE_NAME)
        return self._places[key]

    def quote(self, span: Span) -> tuple[str, str] | None:
        """Return the file and the text of a span that was found here, identified by its identity; ``None`` for others."""
        place, source = self._quotable.get(id(span), (None, None))
        if place is None:
            return None
        numbers = range(span.line, span.end_line + 1)
        lines = [
            source.line(number) if isinstance(source, Source) else linecache.getline(place.filename, number)
            for number in numbers
        ]
        lines[-1] = lines[-1][: span.end_column]
        return place.filename, "\n".join([lines[0][span.column :], *lines[1:]])

    def name(self, where: FrameType) -> tuple[str, int] | None:
        """A name that identifies a place, and stays the same when lines are added elsewhere.

        The text of the line without its comment, and the column in it.
        """
        frame_place = _innermost(where)
        if frame_place is None:
            return None
        frame, instruction = frame_place
        key = (id(frame.f_code), instruction)
        name = self._names.get(key)
        if name is None:
            place = self.place(frame)
            line = "" if place is None else _line(frame, place.span.line)
            column = 0 if place is None else place.span.column - (len(line) - len(line.lstrip()))
            name = self._names[key] = (_without_comment(line).strip(), column)
        return name

    def _position(self, code: CodeType, instruction: int) -> _Positions | None:
        # The code object is kept with its positions, so that its identity stays its own.
        kept = self._positions.get(id(code))
        if kept is None:
            kept = self._positions[id(code)] = (code, list(code.co_positions()))
        return kept[1][instruction // 2] if 0 <= instruction // 2 < len(kept[1]) else None


_CODE: Final = re.compile(r"""(?:[^#'"]|"(?:[^"\\]|\\.)*"?|'(?:[^'\\]|\\.)*'?)*""", re.DOTALL)
"""The text before a comment on a line: anything but a number sign, which counts only outside of strings."""


def _without_comment(line: str) -> str:
    """Return a line up to its comment. Of one that begins inside a text less may be left, by which places are told apart as well."""
    return line if "#" not in line else line[: _CODE.match(line).end()]  # type: ignore[union-attr]  # matches anything


def locate(where: TracebackType | FrameType) -> TracedPlace | None:
    """The place in the program that a frame, or the failure of a traceback, comes from.

    It is that of the innermost frame of generated code: of the callers of a frame, it itself included; of the frames
    of a traceback. ``None`` if there is no such frame, or Python was told to keep no positions.
    """
    frame_place = _innermost(where)
    if frame_place is None:
        return None
    frame, instruction = frame_place
    position = next(islice(frame.f_code.co_positions(), max(0, instruction // 2), None), None)
    return _place(frame, position)


def _innermost(where: TracebackType | FrameType) -> tuple[FrameType, int] | None:
    if isinstance(where, FrameType):
        frame: FrameType | None = where
        while frame is not None:
            if PRELUDE in frame.f_globals:
                return frame, frame.f_lasti
            frame = frame.f_back
        return None
    frame_place = None
    step: TracebackType | None = where
    while step is not None:
        if PRELUDE in step.tb_frame.f_globals:
            frame_place = step.tb_frame, step.tb_lasti
        step = step.tb_next
    return frame_place


def _place(frame: FrameType, position: _Positions | None) -> TracedPlace | None:
    filename = frame.f_code.co_filename
    if position is None:
        return None
    line, end_line, column, end_column = position
    if line is None:
        return None
    if end_line is None or column is None or end_column is None:
        return TracedPlace(filename, Span(line, 0, line, 0))
    start = _character(frame, line, column)
    end = _character(frame, end_line, end_column)
    if (end_line, end) < (line, start):
        end_line, end = line, start
    return TracedPlace(filename, Span(line, start, end_line, end))


def _character(frame: FrameType, line: int, column: int) -> int:
    """Return the column in characters of a column in UTF-8 bytes."""
    text = _line(frame, line)
    if text.isascii():
        return column
    return len(text.encode("utf-8", "surrogatepass")[:column].decode("utf-8", "ignore"))


def _line(frame: FrameType, line: int) -> str:
    source = frame.f_globals.get(SOURCE_NAME)
    if isinstance(source, Source):
        return source.line(line)
    return linecache.getline(frame.f_code.co_filename, line, frame.f_globals)


def format_traceback(error: BaseException) -> str:
    """Return a traceback as Python prints it, with the frames of the program and of its own Python modules alone.

    Frames of this package, of Python's library and of installed packages are left out.
    """
    summary = traceback.StackSummary.from_list(list(_user_frames(error.__traceback__)))
    lines = ["Traceback (most recent call last):\n", *summary.format()] if summary else []
    lines.extend(traceback.format_exception_only(error))
    return "".join(lines)


def _lines(frame: FrameType, first: int, last: int) -> str | None:
    """Return some lines as a traceback has to have them: from Python 3.13 on all, before the first. ``None`` where one is missing."""
    lines = [
        _line(frame, line) for line in range(first, (last if sys.version_info >= (3, 13) else first) + 1)
    ]
    return "\n".join(line.rstrip("\r\n") for line in lines) if all(line.strip() for line in lines) else None


def _user_frames(step: TracebackType | None) -> Iterator[traceback.FrameSummary]:
    while step is not None:
        frame = step.tb_frame
        if PRELUDE in frame.f_globals or _is_users(_file(step)):
            position = next(islice(frame.f_code.co_positions(), max(0, step.tb_lasti // 2), None), None)
            line, end_line, column, end_column = position or (step.tb_lineno, None, None, None)
            first = step.tb_lineno if line is None else line
            quotation = _lines(frame, first, first if end_line is None else end_line)
            if quotation is None:
                end_line = end_column = None
            yield traceback.FrameSummary(
                frame.f_code.co_filename,
                first,
                frame.f_code.co_name,
                lookup_line=False,
                line=_line(frame, first).rstrip() if quotation is None else quotation,
                end_lineno=end_line,
                colno=column,
                end_colno=end_column,
            )
        step = step.tb_next


def raised_at(error: BaseException) -> TracedPlace | None:
    """Return the place where an exception was raised: the innermost line of the user's code, in the program or a Python module.

    The script that called this library is not meant: its lines stand before all of the library's.
    """
    step = error.__traceback__
    while step is not None and PRELUDE not in step.tb_frame.f_globals and _is_users(_file(step)):
        step = step.tb_next
    frames = list(_user_frames(step))
    if not frames or frames[-1].lineno is None:
        return None
    frame = frames[-1]
    line, column, end_column = frames[-1].lineno, frame.colno, frame.end_colno
    if column is None or end_column is None or frame.end_lineno != line:
        return TracedPlace(frame.filename, Span(line, 0, line, 0))
    text = linecache.getline(frame.filename, line).encode("utf-8", "surrogatepass")
    first, last = (len(text[:end].decode("utf-8", "ignore")) for end in (column, end_column))
    return TracedPlace(frame.filename, Span(line, first, line, last))


def _file(step: TracebackType) -> str:
    return step.tb_frame.f_code.co_filename


def _is_users(filename: str) -> bool:
    if filename.startswith("<"):
        return False
    path = os.path.abspath(filename)
    return not any(path.startswith(folder + os.sep) for folder in _library_folders())


@cache
def _library_folders() -> tuple[str, ...]:
    """Return the folders whose Python code is not the user's."""
    paths = sysconfig.get_paths()
    names = ("stdlib", "platstdlib", "purelib", "platlib")
    package = str(Path(__file__).resolve().parent.parent)
    return tuple(
        {package, *(os.path.abspath(paths[name]) for name in names), os.path.join(sys.base_prefix, "lib")}
    )
