"""The rewrites that a text needs to be read as Scenic 3 at all: words and names, found by tokens."""

from collections.abc import Iterator, Sequence

from scenic.compiler.tokens import NAME
from scenic.migration.class_names import ModuleNames
from scenic.migration.migration_rules import Note, decision
from scenic.migration.missing_new import Dialect, makers, unknown_classes
from scenic.migration.reserved import renamings
from scenic.migration.texts import TextEdit, Token

__all__ = ["rewritten_words"]


def rewritten_words(
    tokens: Sequence[Token], names: ModuleNames, dialect: Dialect
) -> tuple[list[TextEdit], list[Note], frozenset[int]]:
    """The edits and notes of a text, and the lines of the monitors that get parentheses."""
    edits: list[TextEdit] = []
    notes: list[Note] = []
    monitors: set[int] = set()
    for index, token in enumerate(tokens):
        if not (index == 0 or tokens[index - 1].is_layout) or token.kind < NAME:
            continue
        name = tokens[index + 1]
        if name.kind < NAME:
            continue
        if token.text == "constructor" and tokens[index + 2].text in ("(", ":"):
            edits.append(TextEdit(token.start, token.end, "class"))
            notes.append(Note(token.line, "constructor"))
        elif token.text == "monitor" and tokens[index + 2].text == ":":
            edits.append(TextEdit(name.end, name.end, "()"))
            notes.append(Note(token.line, "monitor"))
            monitors.add(token.line)
    for index in makers(tokens, names, certain=not dialect.is_old):
        token = tokens[index]
        edits.append(TextEdit(token.start, token.start, "new "))
        notes.append(Note(token.line, "new"))
    if not dialect.is_new:
        for line, edit in renamings(tokens):
            edits.append(edit)
            notes.append(Note(line, "reserved"))
    if dialect.is_old:
        notes += _decisions(tokens, names)
    return edits, notes, frozenset(monitors)


def _decisions(tokens: Sequence[Token], names: ModuleNames) -> Iterator[Note]:
    reported_words: set[str] = set()
    class_names = unknown_classes(tokens, names)
    for index, token in enumerate(tokens):
        if token.kind < NAME or (index and tokens[index - 1].text in ("class", "constructor", ".", "def")):
            continue
        if token.text in class_names and token.text not in reported_words:
            reported_words.add(token.text)
            yield decision("unknown-class", token.line, token.text, token.text)
        is_called = tokens[index + 1].text == "(" and token.text in names.classes
        if is_called and token.text not in reported_words:
            reported_words.add(token.text)
            yield decision("call-of-class", token.line, token.text, token.text)
