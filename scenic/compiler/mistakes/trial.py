"""Trying a repair: does the line parse when its tokens are changed?

A suggestion that was tried is never nonsense: the parser itself has read the text as it would be afterwards.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from scenic.compiler.actions import Actions
from scenic.compiler.generated import HARD_KEYWORDS, OPERATORS, SOFT_KEYWORDS, build_recording_parser
from scenic.compiler.tokens import DEDENT, ENDMARKER, ERROR, INDENT, NAME, NEWLINE, NUMBER, STRING, Tokens
from scenic.dataclass import dataclass

__all__ = ["LONGEST", "Change", "TrialOutcome", "Trials"]

LONGEST: Final = 300
"""Repairs of longer lines are not tried."""

_MOST: Final = 1500
"""So many trials are made in one text; after that, mistakes are explained without."""


@dataclass(frozen=True, slots=True)
class Change:
    """Tokens from ``first`` up to (not including) ``end`` are replaced by ``words``."""

    first: int
    end: int
    words: tuple[str, ...]
    tight: bool = False
    """True if the blanks before the tokens go, too."""


@dataclass(frozen=True, slots=True)
class TrialOutcome:
    """The outcome of a trial.

    ``complete``: the whole line is right. ``reached``: the token, by its number in the original text, that cannot
    stand where it stands now.
    """

    complete: bool
    reached: int


_FAILED: Final = TrialOutcome(False, -1)

_Piece: TypeAlias = str | int
"""A word, or the kind of a token without text."""

_IF: Final[tuple[_Piece, ...]] = ("if", "1", ":", NEWLINE, INDENT, "pass", NEWLINE, DEDENT)
_TRY: Final[tuple[_Piece, ...]] = ("try", ":", NEWLINE, INDENT, "pass", NEWLINE, DEDENT)
_SCENARIO: Final[tuple[_Piece, ...]] = ("scenario", "S", ":", NEWLINE, INDENT)
_BEFORE: Final[Mapping[str, tuple[_Piece, ...]]] = MappingProxyType(
    {
        "elif": _IF,
        "else": _IF,
        "except": _TRY,
        "finally": _TRY,
        "interrupt": _TRY,
        "case": ("match", "1", ":", NEWLINE, INDENT),
        "setup": _SCENARIO,
        "compose": _SCENARIO,
    }
)
"""Tokens that must precede a line that starts with one of these words."""
_INSTANCE: Final[tuple[_Piece, ...]] = ("new", "Object", ",", NEWLINE, INDENT)


class Trials:
    """Tries changes of the lines of one text."""

    def __init__(self, tokens: Tokens) -> None:
        self._tokens = tokens
        self._left = _MOST
        self._known: dict[Any, TrialOutcome] = {}

    def line(self, token: int) -> tuple[int, int]:
        """The first token of the line of ``token``, and the token at its end."""
        kinds = self._tokens.kinds
        start = token
        while start > 0 and kinds[start - 1] not in (NEWLINE, INDENT, DEDENT):
            start -= 1
        end = token
        while end < len(kinds) - 1 and kinds[end] not in (NEWLINE, ENDMARKER):
            end += 1
        return start, end

    def run(self, token: int, changes: Sequence[Change], *, context: str = "") -> TrialOutcome:
        """Parse the line of ``token`` with ``changes``, which are in order and do not overlap.

        ``context`` says how the line is read: as a statement (``""``), as an item of a class (``"class"``), as a line of
        specifiers (``"specifiers"``), or ``"block"`` as a statement followed by a block even if none follows.
        """
        start, end = self.line(token)
        if end - start > LONGEST or self._left <= 0 or ERROR in self._tokens.kinds[start:end]:
            return _FAILED
        key = (start, context, tuple(changes))
        outcome = self._known.get(key)
        if outcome is None:
            self._left -= 1
            outcome = self._known[key] = self._run(start, end, changes, context)
        return outcome

    def _run(self, start: int, end: int, changes: Sequence[Change], context: str) -> TrialOutcome:
        line = _Line(self._tokens)
        position = start
        for change in changes:
            line.copy(position, change.first)
            line.write(change.words, min(change.first, end))
            position = change.end
        line.copy(position, end)
        first = line.texts[0] if line.texts else ""
        rule = "class_item" if context == "class" else "statement"
        result = _Line(self._tokens)
        result.pieces(_INSTANCE if context == "specifiers" else _BEFORE.get(first, ()), start)
        inside = result.kinds.count(INDENT) - result.kinds.count(DEDENT)
        offset = len(result.kinds)
        result.extend(line)
        result.pieces((NEWLINE,), end)
        kinds = self._tokens.kinds
        block = end + 1 < len(kinds) and kinds[end + 1] == INDENT and line.texts[-1:] != [","]
        if context == "block" or block:
            result.pieces((INDENT,), end)
            if first == "match":
                result.pieces(("case", "_", ":"), end)
            result.pieces(("pass", NEWLINE, DEDENT), end)
        if first == "try":
            result.pieces(("finally", ":", "pass", NEWLINE), end)
        result.pieces((DEDENT,) * inside, end)
        size = len(result.kinds)
        result.pieces((ENDMARKER,) * 4, end)
        tokens = result.tokens
        blocks = _Blocks()
        try:
            blocks.run = build_recording_parser(*tokens.lists(), Actions(tokens), blocks)
            node, stop, farthest, _ = blocks.run(rule, 0)
        except RecursionError:
            return _FAILED
        if node is not None and stop >= size:
            return TrialOutcome(True, end)
        farthest = max(farthest, stop, blocks.reached)
        return TrialOutcome(False, start if farthest <= offset else result.origins[farthest])


class _Blocks:
    """Stands for recovery, which a trial does not do: the blocks inside are parsed as they are."""

    def __init__(self) -> None:
        self.run: Any = None
        self.reached = -1

    def __call__(self, rule: str, position: int) -> tuple[list[Any], int]:
        body: list[Any] = []
        while True:
            node, end, farthest, _ = self.run(rule, position)
            self.reached = max(self.reached, farthest)
            if node is None:
                return body, position
            body.append(node)
            position = end


class _Line:
    """Tokens being put together, each with the number of the original one that it stands for."""

    def __init__(self, source: Tokens) -> None:
        self._source = source
        self.tokens = Tokens(source.text)
        self.origins: list[int] = []

    @property
    def kinds(self) -> list[int]:
        return self.tokens.kinds

    @property
    def texts(self) -> list[str]:
        return self.tokens.texts

    def _add(self, kind: int, text: str, origin: int) -> None:
        source, tokens = self._source, self.tokens
        tokens.kinds.append(kind)
        tokens.texts.append(text)
        tokens.lines.append(source.lines[origin])
        tokens.columns.append(source.columns[origin])
        tokens.end_lines.append(source.end_lines[origin])
        tokens.end_columns.append(source.end_columns[origin])
        self.origins.append(origin)

    def copy(self, first: int, end: int) -> None:
        for index in range(first, end):
            self._add(self._source.kinds[index], self._source.texts[index], index)

    def write(self, words: Sequence[str], origin: int) -> None:
        self.pieces(words, origin)

    def pieces(self, pieces: Sequence[_Piece], origin: int) -> None:
        """Add tokens that are not in the text, at the place of ``origin``."""
        for piece in pieces:
            kind, text = (piece, "") if isinstance(piece, int) else (_kind(piece), piece)
            self._add(kind, text, origin)

    def extend(self, other: "_Line") -> None:
        for kind, text, origin in zip(other.kinds, other.texts, other.origins, strict=True):
            self._add(kind, text, origin)


def _kind(word: str) -> int:
    for table in (HARD_KEYWORDS, OPERATORS, SOFT_KEYWORDS):
        if word in table:
            return table[word]
    if word[:1].isdigit():
        return NUMBER
    return STRING if word[:1] in "\"'" else NAME
