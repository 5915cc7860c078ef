"""Parts of a text that an editor can fold: blocks, brackets, long strings, runs of comments and of imports."""

from collections.abc import Iterator
from enum import StrEnum

from scenic.compiler.generated import WORDS
from scenic.compiler.tokens import (
    DEDENT,
    ENDMARKER,
    FSTRING_END,
    FSTRING_START,
    INDENT,
    NEWLINE,
    STRING,
    Tokens,
)
from scenic.dataclass import dataclass
from scenic.ide.snapshot import Snapshot

__all__ = ["Fold", "FoldKind", "folds"]

_OPENERS = frozenset({"(", "[", "{"})
_CLOSERS = frozenset({")", "]", "}"})
_IMPORTS = frozenset({"import", "from", "model"})


class FoldKind(StrEnum):
    """The kinds of folds that editors treat in a way of their own."""

    CODE = "code"
    COMMENT = "comment"
    IMPORTS = "imports"
    REGION = "region"


@dataclass(frozen=True, slots=True)
class Fold:
    """Lines that can be folded into the first of them; lines count from 1."""

    line: int
    end_line: int
    kind: FoldKind


def folds(snapshot: Snapshot) -> tuple[Fold, ...]:
    """Return all that can be folded, in order; no two begin and end on the same lines."""
    tokens = snapshot.tokens
    fold_by_lines: dict[tuple[int, int], Fold] = {}
    for fold in (
        *_comments(tokens, snapshot),
        *_regions(tokens),
        *_imports(tokens),
        *_blocks(tokens),
        *_brackets(tokens),
    ):
        end_line = min(fold.end_line, len(snapshot.source.lines))
        if end_line > fold.line:
            fold_by_lines.setdefault((fold.line, end_line), Fold(fold.line, end_line, fold.kind))
    return tuple(fold_by_lines[key] for key in sorted(fold_by_lines))


def _blocks(tokens: Tokens) -> Iterator[Fold]:
    """Yield the lines of each block with its header."""
    starts: list[int] = []
    first = True
    line = header = 1
    last = 1
    for kind, at, end in zip(tokens.kinds, tokens.lines, tokens.end_lines, strict=True):
        if kind == INDENT:
            starts.append(header)
            continue
        if kind == DEDENT:
            if starts:
                yield Fold(starts.pop(), last, FoldKind.CODE)
            continue
        if kind == ENDMARKER:
            continue
        if first:
            line = at
            first = False
        if kind == NEWLINE:
            header, first = line, True
        else:
            last = end


def _brackets(tokens: Tokens) -> Iterator[Fold]:
    opening_lines: list[int] = []
    string_lines: list[int] = []
    for index, (kind, text) in enumerate(zip(tokens.kinds, tokens.texts, strict=True)):
        if kind == STRING:
            yield Fold(tokens.lines[index], tokens.end_lines[index], FoldKind.CODE)
        elif kind == FSTRING_START:
            string_lines.append(tokens.lines[index])
        elif kind == FSTRING_END and string_lines:
            yield Fold(string_lines.pop(), tokens.end_lines[index], FoldKind.CODE)
        elif text in _OPENERS and WORDS.get(text) == kind:
            opening_lines.append(tokens.lines[index])
        elif text in _CLOSERS and WORDS.get(text) == kind and opening_lines:
            # The line of the closing bracket stays in sight.
            yield Fold(opening_lines.pop(), tokens.lines[index] - 1, FoldKind.CODE)


def _imports(tokens: Tokens) -> Iterator[Fold]:
    start = end = 0
    first = True
    for index, kind in enumerate(tokens.kinds):
        if first and kind not in (INDENT, DEDENT, NEWLINE):
            first = False
            line = tokens.lines[index]
            if tokens.texts[index] in _IMPORTS and tokens.columns[index] == 0:
                start = start or line
                end = line
            elif start:
                yield Fold(start, end, FoldKind.IMPORTS)
                start = 0
        if kind == NEWLINE:
            first = True
            if start:
                end = max(end, tokens.lines[index])


def _comments(tokens: Tokens, snapshot: Snapshot) -> Iterator[Fold]:
    """Comments on lines of their own that follow each other."""
    comment_lines = [
        line
        for line, column, text in tokens.comments
        if not snapshot.source.line(line)[:column].strip() and not _region(text)
    ]
    start = previous = 0
    for line in comment_lines:
        if line != previous + 1:
            if previous > start > 0:
                yield Fold(start, previous, FoldKind.COMMENT)
            start = line
        previous = line
    if previous > start > 0:
        yield Fold(start, previous, FoldKind.COMMENT)


def _regions(tokens: Tokens) -> Iterator[Fold]:
    """Yield the folds between the comments ``# region`` and ``# endregion``."""
    opened: list[int] = []
    for line, _, text in tokens.comments:
        word = _region(text)
        if word == "region":
            opened.append(line)
        elif word and opened:
            yield Fold(opened.pop(), line, FoldKind.REGION)


def _region(text: str) -> str:
    words = text[1:].split(maxsplit=1)
    return words[0] if words and words[0] in ("region", "endregion") else ""
