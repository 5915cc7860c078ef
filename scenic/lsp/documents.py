"""The documents that the client has open, version by version."""

import os
import re
from collections.abc import Sequence
from functools import cached_property
from typing import Final

from lsprotocol import types

from scenic.dataclass import dataclass
from scenic.ide.markdown import is_markdown, program_blocks
from scenic.ide.snapshot import Snapshot
from scenic.language.errors import ScenicError
from scenic.language.source import read_source
from scenic.lsp.convert import Encoding, Lines, units
from scenic.lsp.uris import to_path

__all__ = ["Document", "changed", "snapshot_of"]

_LINE_END: Final = re.compile(r"\r\n|\n|\r")
_OTHERS: Final = frozenset({"python", "toml", "markdown"})
"""Languages of documents that are no programs, or contain them."""
_MARK: Final = "\ufeff"


@dataclass(frozen=True)
class Document:
    """One version of a document: the client's text, and what we make of it.

    ``version`` is ``None`` for a file that is not open. A Markdown document has an empty snapshot, and a document of its own
    for each block of Scenic, with ``before`` lines of the whole before it.
    """

    uri: str
    language: str
    version: int | None
    text: str
    encoding: Encoding
    snapshot: Snapshot
    before: int = 0

    @cached_property
    def lines(self) -> Lines:
        """The lines of the document with their places in the protocol."""
        marks = len(self.text) - len(self.text.lstrip(_MARK))
        return Lines(self.snapshot.source, self.encoding, marks, self.before)

    @property
    def programs(self) -> tuple["Document", ...]:
        """The programs of the document: itself, or the blocks of a Markdown text."""
        if self.before or not is_markdown(self.uri, self.language):
            return (self,) if self.is_program else ()
        return self._blocks

    @cached_property
    def _blocks(self) -> tuple["Document", ...]:
        name = self.snapshot.filename
        return tuple(
            Document(
                self.uri,
                "scenic",
                self.version,
                block.text,
                self.encoding,
                Snapshot(block.text, f"{name}#{number}.scenic"),
                block.lines_before,
            )
            for number, block in enumerate(program_blocks(_LINE_END.sub("\n", self.text)), 1)
        )

    def at(self, line: int) -> "Document":
        """Return the program on a line, counted from 0 as the protocol does; else the document itself."""
        for each in self.programs:
            if each.before <= line < each.before + each.text.count("\n"):
                return each
        return self

    def has_part_of(self, place: types.Range) -> bool:
        """Return whether a range touches this document: always, but for blocks."""
        return not self.before or (
            place.end.line >= self.before and place.start.line < self.before + self.text.count("\n")
        )

    @property
    def is_program(self) -> bool:
        """Return whether it is a Scenic program: an editor may also show us the Python modules beside it."""
        name = self.snapshot.filename
        return not (self.language in _OTHERS or name.endswith((".py", ".pyi", ".toml")) or is_markdown(name))

    @property
    def line_end(self) -> str:
        """The line end of the document: its first one."""
        found = _LINE_END.search(self.text)
        return "\n" if found is None else found[0]

    def is_saved(self) -> bool:
        """Return whether its file holds its present text."""
        try:
            return read_source(self.snapshot.filename).text == self.snapshot.text
        except ScenicError:
            return False


def snapshot_of(text: str, uri: str, language: str = "scenic") -> Snapshot:
    """Return the snapshot of a text; of a Markdown text, that of an empty program."""
    if is_markdown(uri, language):
        text = ""
    # What is no file gets a name that is none either, and that no file has.
    path = to_path(uri) or os.path.abspath(os.sep + re.sub(r"[/\\]", "_", uri))
    return Snapshot(text, path)


def changed(text: str, changes: Sequence[types.TextDocumentContentChangeEvent], encoding: Encoding) -> str:
    """A text after the changes that a client reports, one after the other.

    A place past the end of a line means its end, as the protocol has it.
    """
    for change in changes:
        if isinstance(change, types.TextDocumentContentChangeWholeDocument):
            text = change.text
            continue
        first, last = (_offset(text, place, encoding) for place in (change.range.start, change.range.end))
        text = text[:first] + change.text + text[max(first, last) :]
    return text


def _line(text: str, line: int) -> tuple[int, int] | None:
    """Return the start and the end of a line, without its line end; ``None`` if there is no such line."""
    if "\r" not in text:
        parts = text.split("\n", line)
        if len(parts) <= line:
            return None
        begin = len(text) - len(parts[-1])
        end = text.find("\n", begin)
        return begin, len(text) if end < 0 else end
    ends = list(_LINE_END.finditer(text))
    if line > len(ends):
        return None
    return ends[line - 1].end() if line else 0, ends[line].start() if line < len(ends) else len(text)


def _offset(text: str, position: types.Position, encoding: Encoding) -> int:
    line_range, character = _line(text, position.line), position.character
    if line_range is None:
        return len(text)
    begin, end = line_range
    content = text[begin:end]
    if content.isascii() or encoding is Encoding.UTF32:
        return begin + min(character, len(content))
    unit_count = 0
    for column, each in enumerate(content):
        unit_count += units(each, encoding)
        if unit_count > character:
            return begin + column
    return end
