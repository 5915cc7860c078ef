"""The questions of rules about a mistake: the tokens around it, what was expected, whether a repair would do."""

from collections.abc import Sequence
from dataclasses import field
from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.actions.common import Place
from scenic.compiler.generated import WORDS
from scenic.compiler.mistakes.trial import LONGEST, Change, TrialOutcome, Trials
from scenic.compiler.tokens import DEDENT, ENDMARKER, INDENT, NAME, NEWLINE, NUMBER, STRING, Tokens
from scenic.dataclass import dataclass

__all__ = ["Situation", "insertion"]

_OPENERS: Final = {"(": ")", "[": "]", "{": "}"}
_CLOSERS: Final = frozenset(_OPENERS.values())
_LAYOUT: Final = frozenset({NEWLINE, ENDMARKER, DEDENT, INDENT})
_TIGHT: Final = frozenset({",", ":", ")", "()", "(", ";"})
"""Tokens that are written without a blank before them."""


def insertion(before: int, *words: str) -> Change:
    """The change that writes ``words`` before a token."""
    return Change(before, before, words)


@dataclass(slots=True)
class Situation:
    """A statement that is right from ``start`` up to ``token``, which cannot stand where it stands.

    ``expected`` holds the kinds of the tokens, and the labels of the rules, that could have stood there. ``first`` and
    ``end`` are the tokens between which the line of ``token`` lies.
    """

    tokens: Tokens
    trials: Trials
    start: int
    token: int
    expected: frozenset[int | str]
    first: int = field(init=False)
    end: int = field(init=False)
    _context: str | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        self.first, self.end = self.trials.line(self.token)
        if self.first < self.start < self.end:
            self.first = self.start

    # Words.

    def word(self, index: int) -> str:
        """Return the text of a token of the line, an empty text outside it."""
        return self.tokens.texts[index] if self.first <= index < self.end else ""

    @property
    def found(self) -> str:
        """The text of the token that cannot stand there."""
        return self.word(self.token)

    @property
    def before(self) -> str:
        """The text of the token before that one."""
        return self.word(self.token - 1)

    def words(self, first: int, end: int) -> str:
        """Return several tokens as they would be written."""
        text = ""
        for index in range(first, end):
            word = self.word(index)
            tight = not text or word in _TIGHT or word in (".", "[", "]") or text[-1] in "([.{"
            text += word if tight else f" {word}"
        return text

    def is_name(self, index: int) -> bool:
        """Return whether a token is a name, which soft keywords are too."""
        return self.first <= index < self.end and self.tokens.kinds[index] >= NAME

    def is_plain_name(self, index: int) -> bool:
        """Return whether a token is a name and no keyword of any kind."""
        return self.first <= index < self.end and self.tokens.kinds[index] == NAME

    def is_class_name(self, index: int) -> bool:
        """Return whether a token is a name that looks like that of a class."""
        return self.is_plain_name(index) and self.word(index)[:1].isupper()

    def starts_operand(self, index: int) -> bool:
        """Return whether an expression can start with a token."""
        if not self.first <= index < self.end:
            return False
        kind = self.tokens.kinds[index]
        return kind >= NAME or kind in (NUMBER, STRING) or self.word(index) in _OPERAND_WORDS or kind == 6

    def is_long(self) -> bool:
        """Return whether the line is so long that no repair can be tried."""
        return self.end - self.first > LONGEST

    def at_end(self) -> bool:
        """Return whether the line ends where it should continue."""
        return self.token >= self.end

    def expects(self, *wanted: str) -> bool:
        """Return whether one of these words, or rules by their labels, could have stood there."""
        return any(word in self.expected or WORDS.get(word) in self.expected for word in wanted)

    def opener(self, index: int) -> int | None:
        """Return the bracket of the line that is open at a token."""
        depth = 0
        for position in range(min(index, self.end) - 1, self.first - 1, -1):
            word = self.word(position)
            if word in _CLOSERS:
                depth += 1
            elif word in _OPENERS:
                if depth == 0:
                    return position
                depth -= 1
        return None

    def adjacent(self, index: int) -> bool:
        """Return whether nothing stands between a token and the next."""
        tokens = self.tokens
        return (
            index + 1 < self.end
            and tokens.end_lines[index] == tokens.lines[index + 1]
            and tokens.end_columns[index] == tokens.columns[index + 1]
        )

    def _block_start(self) -> int | None:
        """Return the token that begins the block around this line, ``None`` at the top level or if it is very far."""
        kinds = self.tokens.kinds
        depth, index = 0, self.first - 1
        farthest = max(0, index - _FARTHEST)
        while index > farthest and not (kinds[index] == INDENT and depth == 0):
            depth += (kinds[index] == DEDENT) - (kinds[index] == INDENT)
            index -= 1
        return index if index > max(farthest, 1) else None

    def header(self) -> "Situation | None":
        """Return the line that the block around this line belongs to, as if its second token were wrong."""
        index = self._block_start()
        if index is None:
            return None
        first, _ = self.trials.line(index - 2)
        return self.elsewhere(first, first + 1)

    def context(self) -> str:
        """Return how the line is read: as an item of a class, a line of specifiers, or a statement (see `Trials.run`)."""
        if self._context is None:
            self._context = ""
            index = self._block_start()
            if index is not None:
                if self.tokens.texts[index - 2] == ",":
                    self._context = "specifiers"
                elif self.tokens.texts[self.trials.line(index - 2)[0]] == "class":
                    self._context = "class"
        return self._context

    def lines_of_block(self) -> list[int]:
        """Return the first tokens of the lines of the block that this line is in, without those of blocks inside it."""
        kinds = self.tokens.kinds
        index, depth = self.first, 0
        while index > 0 and not (kinds[index - 1] == INDENT and depth == 0):
            index -= 1
            depth += (kinds[index] == DEDENT) - (kinds[index] == INDENT)
        lines = []
        fresh = True
        while index < len(kinds) and kinds[index] != ENDMARKER:
            kind = kinds[index]
            if kind == INDENT:
                depth += 1
            elif kind == DEDENT:
                if depth == 0:
                    break
                depth -= 1
            elif fresh and depth == 0:
                lines.append(index)
            fresh = kind in (NEWLINE, DEDENT, INDENT)
            index += 1
        return lines

    def elsewhere(self, start: int, token: int, expected: frozenset[int | str] = frozenset()) -> "Situation":
        """Return the situation of another mistake in the same text."""
        return Situation(self.tokens, self.trials, start, token, expected)

    # Places.

    def place(self, first: int, end: int | None = None) -> Place:
        """From the beginning of a token to the end of the one before ``end``; without, to its own end."""
        tokens = self.tokens
        last = first if end is None else end - 1
        return (tokens.lines[first], tokens.columns[first], tokens.end_lines[last], tokens.end_columns[last])

    def here(self) -> Place:
        """The place to mark: the token, or the end of the text before it if the token ends something."""
        return self.pointer(self.token)

    def pointer(self, token: int) -> Place:
        """Return the place to mark for a token: the token, or the end of the text before it if the token ends something."""
        kinds = self.tokens.kinds
        if token < len(kinds) and kinds[token] not in _LAYOUT - {INDENT}:
            return self.place(token)
        token = min(token, len(kinds) - 1)
        while token > 0 and kinds[token] in _LAYOUT:
            token -= 1
        return self._after(token)

    def _after(self, token: int) -> Place:
        tokens = self.tokens
        line, column = tokens.end_lines[token], tokens.end_columns[token]
        return (line, column, line, column)

    def gap(self, token: int) -> Place:
        """The empty place between the token before and this one, at the former."""
        return self._after(token - 1) if token > 0 else self.place(token)[:2] * 2

    # Repairs.

    def reads(self, changes: Sequence[Change], *, context: str | None = None) -> TrialOutcome:
        """Read the line with ``changes``."""
        if context is None:
            context = self.context()
        return self.trials.run(self.token, changes, context=context)

    def repairs(self, *changes: Change, context: str | None = None) -> bool:
        """Return whether the line is right with ``changes``."""
        return self.reads(changes, context=context).complete

    def helps(self, *changes: Change, context: str | None = None) -> bool:
        """Return whether the line with ``changes`` is right, or right up to a later token."""
        outcome = self.reads(changes, context=context)
        return outcome.complete or outcome.reached > max(self.token, changes[-1].end)

    def problem(
        self,
        code: str,
        place: Place,
        message: str,
        help: str | None = None,
        *,
        fix: tuple[str, Sequence[Change]] | None = None,
        labels: tuple[tuple[Place, str], ...] = (),
    ) -> SyntaxProblem:
        """A problem, with the repair only if the line is right afterwards."""
        repair = None
        if fix is not None and self.repairs(*fix[1]):
            repair = (fix[0][:1].upper() + fix[0][1:], tuple(self._edit(change) for change in fix[1]))
        return SyntaxProblem(code, place, message, help, labels, repair)

    def _edit(self, change: Change) -> tuple[Place, str]:
        text = " ".join(change.words).replace("( )", "()")
        first, end = change.first, change.end
        if change.tight:
            return (*self.gap(first)[:2], *self.place(first)[:2]), text
        if first < end and not text:
            # One of the blanks around what goes has to go with it.
            if first == self.first:
                return (*self.place(first)[:2], *self.place(end)[:2]), text
            return (*self.gap(first)[:2], *self.place(first, end)[2:]), text
        if first < end:
            if self.adjacent(first - 1) and (text.isalnum() or text == "=") and first > self.first:
                text = f" {text}"
            if self.adjacent(end - 1) and text[-1].isalnum() and self.word(end)[:1].isalnum():
                text += " "
            return self.place(first, end), text
        if text in _TIGHT and text != "(":
            return self.gap(change.first), text
        if change.first >= self.end:
            return self.gap(change.first), f" {text}"
        return self.place(change.first)[:2] * 2, text if text == "(" else f"{text} "


_FARTHEST: Final = 5000
"""So many tokens before a line the beginning of its block is looked for."""

_OPERAND_WORDS: Final = frozenset(
    {"(", "[", "{", "...", "None", "True", "False", "new", "lambda", "not", "await", "-", "+", "~"}
)
