"""Programs in Markdown files: the blocks that begin with three backticks and ``scenic``."""

import re
from collections.abc import Iterator
from typing import Final, NamedTuple

__all__ = ["SUFFIXES", "Block", "program_blocks"]

SUFFIXES: Final = (".md", ".markdown")
_FENCE: Final = re.compile(r"^(?P<indent> {0,3})(?P<fence>`{3,}|~{3,})(?P<info>[^`]*)$")


class Block(NamedTuple):
    """A program, and the number of lines of the file before it."""

    lines_before: int
    text: str

    @property
    def in_place(self) -> str:
        """The program after as many empty lines as precede it in the file, so that places are those of the file."""
        return "\n" * self.lines_before + self.text


def program_blocks(text: str) -> Iterator[Block]:
    """The blocks of a Markdown text that contain programs, in order."""
    fence, first, is_program = "", 0, False
    lines = text.split("\n")
    for number, line in enumerate(lines):
        found = _FENCE.match(line.rstrip())
        if not fence and found is not None:
            language = found["info"].split()
            fence, first = found["fence"], number + 1
            is_program = language[:1] == ["scenic"] and not found["indent"]
        elif fence and found is not None and not found["info"].strip() and found["fence"].startswith(fence):
            if is_program and number > first:
                yield Block(first, "\n".join(lines[first:number]) + "\n")
            fence = ""
