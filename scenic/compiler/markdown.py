"""Programs in Markdown files: the blocks that begin with three backticks and ``scenic``."""

import re
from collections.abc import Callable, Iterator, Sequence
from typing import Final, NamedTuple

from scenic.compiler.check import check_text
from scenic.compiler.fixes import Repaired, repair
from scenic.compiler.surroundings import SurroundingsOf
from scenic.language.diagnostics import Diagnostic

__all__ = ["SUFFIXES", "ProgramBlock", "check_blocks", "program_blocks", "repair_blocks", "with_blocks"]

SUFFIXES: Final = (".md", ".markdown")
_FENCE: Final = re.compile(r"^(?P<indent> {0,3})(?P<fence>`{3,}|~{3,})(?P<info>[^`]*)$")


class ProgramBlock(NamedTuple):
    """A program, and the number of lines of the file before it."""

    lines_before: int
    text: str

    @property
    def in_place(self) -> str:
        """The program after as many empty lines as precede it in the file, so that places are those of the file."""
        return "\n" * self.lines_before + self.text


def program_blocks(text: str) -> Iterator[ProgramBlock]:
    """Yield the blocks of a Markdown text that contain programs, in order."""
    fence, first, is_program = "", 0, False
    lines = text.split("\n")
    for number, line in enumerate(lines):
        fence_match = _FENCE.match(line.rstrip())
        if not fence and fence_match is not None:
            language = fence_match["info"].split()
            fence, first = fence_match["fence"], number + 1
            is_program = language[:1] == ["scenic"] and not fence_match["indent"]
        elif (
            fence
            and fence_match is not None
            and not fence_match["info"].strip()
            and fence_match["fence"].startswith(fence)
        ):
            if is_program and number > first:
                yield ProgramBlock(first, "\n".join(lines[first:number]) + "\n")
            fence = ""


def with_blocks(text: str, change: Callable[[str], str | None]) -> str:
    """Return the Markdown text with other programs in its blocks; ``change`` gives ``None`` for a program that stays."""
    lines = text.split("\n")
    for block in reversed(list(program_blocks(text))):
        changed = change(block.text)
        if changed is not None:
            last = block.lines_before + block.text.count("\n")
            lines[block.lines_before : last] = changed.removesuffix("\n").split("\n")
    return "\n".join(lines)


def check_blocks(
    text: str, *, filename: str, surroundings_of: SurroundingsOf | None = None
) -> tuple[Diagnostic, ...]:
    """Return the findings of `check_text` in the blocks of a Markdown text, each of which is a program by itself."""
    return tuple(
        item
        for block in program_blocks(text)
        for item in check_text(block.in_place, filename=filename, surroundings_of=surroundings_of)
    )


def repair_blocks(
    text: str,
    *,
    filename: str,
    shown: Callable[[Sequence[Diagnostic]], Sequence[Diagnostic]],
    surroundings_of: SurroundingsOf | None = None,
) -> Repaired:
    """Make the certain repairs in the blocks of a Markdown text, as `repair` does in a program."""
    count = 0

    def change(program: str) -> str:
        nonlocal count
        repaired = repair(program, filename=filename, shown=shown, surroundings_of=surroundings_of)
        count += repaired.count
        return repaired.text

    new_text = with_blocks(text, change)
    diagnostics = check_blocks(new_text, filename=filename, surroundings_of=surroundings_of)
    return Repaired(new_text, count, tuple(shown(diagnostics)))
