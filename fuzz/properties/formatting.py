"""The formatter changes nothing that is said, and formats its own result to itself."""

from typing import Final

from fuzz.properties.case import Case, Property, Violation, describe
from fuzz.properties.differences import difference
from scenic.compiler.parser import parse
from scenic.compiler.tokens import DEDENT, ENDMARKER, INDENT, NEWLINE
from scenic.ide.formatting import format_text
from scenic.ide.snapshot import Snapshot
from scenic.ide.spacing import text_of

__all__ = ["OF_TEXTS", "on_lines"]


def formatted_texts_read_the_same(case: Case) -> None:
    """A text without errors is formatted to a text with the same tree, which is formatted to itself."""
    if case.has_error:
        return
    new_text = format_text(case.text)
    if new_text is None:
        raise Violation("it is not formatted")
    again = parse(new_text)
    if again.diagnostics:
        raise Violation(f"what was written is refused: {describe(again.diagnostics[0])}\n{new_text}")
    where = difference(case.result.tree, again.tree)
    if where is not None:
        raise Violation(f"another tree: {where}\n{new_text}")
    if case.number % 4 == 0 or case.thorough:
        twice = format_text(new_text)
        if twice != new_text:
            raise Violation(f"formatted differently the second time:\n{new_text}{twice}")


def on_lines(text: str) -> str:
    """Write a program without mistakes with each logical line on one line, as far as strings allow."""
    snapshot = Snapshot(text, "<text>")
    lines: list[str] = []
    depth = 0
    begin: int | None = None
    for index, kind in enumerate(snapshot.tokens.kinds):
        if kind in (NEWLINE, ENDMARKER):
            if begin is not None:
                lines.append("    " * depth + text_of(snapshot, begin, index) + "\n")
            begin = None
        elif kind in (INDENT, DEDENT):
            depth += 1 if kind == INDENT else -1
        elif begin is None:
            begin = index
    return "".join(lines)


OF_TEXTS: Final = (Property.of(formatted_texts_read_the_same),)
