"""Closing words that the innermost operator must leave to one around it.

The parser reads from left to right and gives `from`, `to` and `of` to the innermost operator that can use them. In
``follow distance to x from b for c`` that leaves none for `follow`, which cannot do without; likewise, in
``require new C at x and always y`` the specifier takes all that it can. Trying every sharing of the words would take
exponential time, so that for a text which the parser refused the words are counted instead: an operator that can do
without a word gets one only if enough are left for those that cannot. Where it gets none, the operand around it is
put into parentheses that are not in the text; nodes do not show parentheses, so the tree is that of the text.

All takes one pass over the tokens.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field, replace
from typing import Final, Literal, NamedTuple, TypeAlias

from scenic.compiler.generated import HARD_KEYWORDS, OPERATORS, SOFT_KEYWORDS, WORDS
from scenic.compiler.phrases import CLOSING_WORDS, TEMPORAL_FORMS, words_before
from scenic.compiler.precedence import Fixity
from scenic.compiler.tokens import FSTRING_START, NAME, NEWLINE, NUMBER, STRING, Tokens
from scenic.dataclass import dataclass

__all__ = ["OperandSpan", "closed_operands", "in_parentheses"]

_FROM: Final = HARD_KEYWORDS["from"]
_FOR: Final = HARD_KEYWORDS["for"]
_NOT: Final = HARD_KEYWORDS["not"]
_IF: Final = HARD_KEYWORDS["if"]
_ELSE: Final = HARD_KEYWORDS["else"]
_LAMBDA: Final = HARD_KEYWORDS["lambda"]
_NEW: Final = HARD_KEYWORDS["new"]
_REQUIRE: Final = HARD_KEYWORDS["require"]
_VISIBLE: Final = SOFT_KEYWORDS["visible"]
_FOLLOW: Final = SOFT_KEYWORDS["follow"]

_OPENING: Final = {
    (WORDS[first], WORDS[second]): WORDS[closer] for (first, second), closer in CLOSING_WORDS.items()
}
"""By the last two words before an operand of a prefix operator: the word that may end the operand."""

_NOT_CLOSING: Final = {
    kind: frozenset(WORDS[before] for before in words_before(word))
    for word, kind in WORDS.items()
    if word in {"from", *CLOSING_WORDS.values()}
}
"""By closing word, the words that make one operator with it."""

_OPENERS: Final = frozenset(OPERATORS[text] for text in "([{")
_CLOSERS: Final = frozenset(OPERATORS[text] for text in ")]}")
_COMMA: Final = OPERATORS[","]
_COLON: Final = OPERATORS[":"]
_SEMICOLON: Final = OPERATORS[";"]

_SUSPECT: Final = (_FOLLOW, _NOT, _LAMBDA, _REQUIRE)
_STATEMENT_ENDS: Final = frozenset({NEWLINE, _SEMICOLON})
_ENDS: Final = frozenset({OPERATORS["="], OPERATORS[":="]})

_CONNECTIVES: Final = frozenset({HARD_KEYWORDS["and"], HARD_KEYWORDS["or"]})
_LADDER_ENDS: Final = frozenset(
    WORDS[form.words[0]] for form in TEMPORAL_FORMS if form.fixity is Fixity.INFIX
)
_TEMPORAL: Final = frozenset(WORDS[form.words[0]] for form in TEMPORAL_FORMS if form.fixity is Fixity.PREFIX)
_LADDER: Final = (
    _CONNECTIVES | _LADDER_ENDS | _TEMPORAL | {_REQUIRE, _NOT, _IF, _ELSE, OPERATORS["("], OPERATORS["]"]}
)
"""After these, a parenthesis in a condition may hold a condition."""

_MOST_SEARCHED: Final = 100
"""So many operators around a closing word are considered; keeps the time linear."""

_OPERAND_STARTS: Final = frozenset(
    {NUMBER, STRING, FSTRING_START, _NOT, _NEW, _LAMBDA, *_OPENERS}
    | {HARD_KEYWORDS[word] for word in ("None", "True", "False", "await")}
    | {OPERATORS["..."], OPERATORS["~"]}
)


class OperandSpan(NamedTuple):
    """The tokens from ``first`` up to ``end`` (exclusive) are one operand.

    ``start`` and ``stop`` are the places (line and column in bytes) of the first token of its simple statement or header
    and of the token after that.
    """

    first: int
    end: int
    start: tuple[int, int]
    stop: tuple[int, int]


class _Open(NamedTuple):
    """Begin an operator whose operand at ``first`` may extend to the closing word ``wants``, which may be required."""

    wants: int
    must: bool
    first: int


class _Close(NamedTuple):
    """A closing word."""

    kind: int
    token: int


_Event: TypeAlias = _Open | _Close | Literal["if", "else"]


@dataclass(slots=True)
class _Frame:
    """The state of the text between two brackets, or between two commas in them.

    ``regions`` are the events of the expression, and of the first two operands of each `follow` that is not closed. The
    default of a parameter of a lambda has a frame of its own, which ``is_default``.
    """

    condition: bool = False
    is_default: bool = False
    lambdas: int = 0
    new: int | None = None
    regions: list[list[_Event]] = field(default_factory=lambda: [[]])


def closed_operands(tokens: Tokens) -> list[OperandSpan]:
    """Return the operands in ``tokens`` that have to end before a closing word, although one within them could use it."""
    kinds, lines, columns = tokens.kinds, tokens.lines, tokens.columns
    scan = _Scan(kinds)
    operands: list[OperandSpan] = []
    start = 0
    statement_end = -1
    # What can be wrong here takes an operator that must have its words, or a condition with an instance.
    for index in sorted(place for kind in _SUSPECT for place in _places(kinds, kind)):
        if index < statement_end:
            continue
        start = index
        while start > 0 and kinds[start - 1] not in _STATEMENT_ENDS:
            start -= 1
        statement_end = index
        while statement_end < len(kinds) and kinds[statement_end] not in _STATEMENT_ENDS:
            statement_end += 1
        if statement_end < len(kinds):
            places = (lines[start], columns[start]), (lines[statement_end], columns[statement_end])
            operands += (OperandSpan(*each, *places) for each in scan.statement(start, statement_end))
    return operands


def _places(kinds: list[int], kind: int) -> Iterator[int]:
    """Yield the indices at which ``kind`` occurs in ``kinds``."""
    place = -1
    for _ in range(kinds.count(kind)):
        place = kinds.index(kind, place + 1)
        yield place


def in_parentheses(tokens: Tokens, operands: Iterable[OperandSpan]) -> Tokens:
    """Return ``tokens`` with parentheses of no width around ``operands``."""
    openings: dict[int, int] = {}
    closings: dict[int, int] = {}
    for operand in operands:
        openings[operand.first] = openings.get(operand.first, 0) + 1
        closings[operand.end] = closings.get(operand.end, 0) + 1
    result = replace(tokens, kinds=[], texts=[], lines=[], columns=[], end_lines=[], end_columns=[])
    lists = (result.lines, result.columns, result.end_lines, result.end_columns)
    before = 0
    for index in sorted(openings.keys() | closings.keys()):
        _extend(result, tokens, before, index)
        before = index
        count = closings.get(index, 0)
        result.kinds += [OPERATORS[")"]] * count
        result.texts += [")"] * count
        end = tokens.end_lines[index - 1], tokens.end_columns[index - 1]
        for each, value in zip(lists, end * 2, strict=True):
            each += [value] * count
        count = openings.get(index, 0)
        result.kinds += [OPERATORS["("]] * count
        result.texts += ["("] * count
        start = tokens.lines[index], tokens.columns[index]
        for each, value in zip(lists, start * 2, strict=True):
            each += [value] * count
    _extend(result, tokens, before, len(tokens.kinds))
    return result


def _extend(result: Tokens, tokens: Tokens, start: int, end: int) -> None:
    result.kinds += tokens.kinds[start:end]
    result.texts += tokens.texts[start:end]
    result.lines += tokens.lines[start:end]
    result.columns += tokens.columns[start:end]
    result.end_lines += tokens.end_lines[start:end]
    result.end_columns += tokens.end_columns[start:end]


class _Scan:
    """Reads the tokens of statements."""

    def __init__(self, kinds: Sequence[int]) -> None:
        self._kinds = kinds
        self._found: list[tuple[int, int]] = []

    def statement(self, start: int, end: int) -> list[tuple[int, int]]:
        """Return the operands in the tokens of one simple statement or header: their first tokens and those after them."""
        self._found = []
        self._read(start, end)
        return self._found

    def _read(self, start: int, end: int) -> None:
        kinds = self._kinds
        frames = [_Frame()]
        index = start
        while index < end:
            kind = kinds[index]
            frame = frames[-1]
            if frame.is_default and (kind in _CLOSERS or (kind in (_COMMA, _COLON) and not frame.lambdas)):
                self._end(frame)
                frames.pop()
                frame = frames[-1]
            if kind in _OPENERS:
                group = frame.condition and (kinds[index - 1] in _LADDER or index == start)
                frames.append(_Frame(condition=group and kind == OPERATORS["("]))
            elif kind in _CLOSERS:
                self._end(frame)
                if len(frames) > 1:
                    frames.pop()
            elif kind == _REQUIRE:
                frame.condition = True
            elif kind == _LAMBDA:
                frame.lambdas += 1
            elif kind == _COLON and frame.lambdas:
                frame.lambdas -= 1
            elif kind in _ENDS and frame.lambdas:
                frames.append(_Frame(is_default=True))
            elif kind in _ENDS or kind == _COLON or (kind == _COMMA and not frame.lambdas):
                self._end(frame)
            else:
                index = self._word(frame, index)
            index += 1
        for frame in frames:
            self._end(frame)

    def _word(self, frame: _Frame, index: int) -> int:
        """Note what the word at ``index`` begins or closes; the index of the last token that belongs to it."""
        kinds = self._kinds
        kind, after = kinds[index], kinds[index + 1]
        events = frame.regions[-1]
        closer = _OPENING.get((kind, after))
        if closer is not None:
            events.append(self._open(closer, index + 2))
            return index + 1
        if kind == _FOLLOW and (after >= NAME or after in _OPERAND_STARTS or after == OPERATORS["-"]):
            frame.regions.append([_Open(_FROM, True, index + 1)])
        elif kind in _NOT_CLOSING and kinds[index - 1] not in _NOT_CLOSING[kind]:
            events.append(_Close(kind, index))
        elif kind == _FOR:
            if len(frame.regions) > 1:
                self._share(frame.regions.pop())
            else:
                self._end(frame)
        elif kind == _IF:
            events.append("if")
        elif kind == _ELSE:
            events.append("else")
        elif kind == _NEW and frame.new is None:
            frame.new = index
        elif kind in _LADDER_ENDS:
            frame.new = None
        elif kind in _TEMPORAL and frame.condition and frame.new is not None:
            self._temporal(frame, index)
        return index

    def _temporal(self, frame: _Frame, index: int) -> None:
        """End an instance before the connective whose right operand is the temporal operator at ``index``."""
        kinds = self._kinds
        if kinds[index + 1] < NAME and kinds[index + 1] not in _OPERAND_STARTS:
            return
        before = index - 1
        while kinds[before] == _NOT:
            before -= 1
        if kinds[before] in _CONNECTIVES and frame.new is not None:
            self._found.append((frame.new, before))
            frame.new = None

    def _open(self, wants: int, first: int) -> _Open:
        """Return an operator with the operand at ``first``; if its short form cannot have this operand, the closing word is required."""
        kind = self._kinds[first]
        must = kind == _LAMBDA or (kind == _NOT and self._kinds[first + 1] != _VISIBLE)
        return _Open(wants, must, first)

    def _end(self, frame: _Frame) -> None:
        """An expression ends; a `follow` without its `for` is beyond help."""
        self._share(frame.regions[0])
        frame.regions = [[]]
        frame.lambdas = 0

    def _share(self, events: Sequence[_Event]) -> None:
        """Share out the closing words among operators, each word to the innermost one that may have it."""
        words = dict.fromkeys(_NOT_CLOSING, 0)
        """For each closing word, the number left, less the number that later operators need."""
        needs = dict.fromkeys(_NOT_CLOSING, 0)
        """For each closing word, the number that the open operators need."""
        for event in events:
            if isinstance(event, _Close):
                words[event.kind] += 1
            elif isinstance(event, _Open):
                words[event.wants] -= event.must
        stack: list[_Open | None] = []
        for event in events:
            if isinstance(event, _Open):
                stack.append(event)
                needs[event.wants] += event.must
                words[event.wants] += event.must
            elif event == "if":
                stack.append(None)
            elif event == "else":
                while stack:
                    operator = stack.pop()
                    if operator is None:
                        break
                    needs[operator.wants] -= operator.must
            else:
                assert isinstance(event, _Close)
                words[event.kind] -= 1
                self._close(event, stack, needs, enough=words[event.kind] >= needs[event.kind])

    def _close(
        self, word: _Close, stack: list[_Open | None], needed: dict[int, int], *, enough: bool
    ) -> None:
        passed_over = False
        place = len(stack) - 1
        lowest = max(0, len(stack) - _MOST_SEARCHED)
        while place >= lowest:
            entry = stack[place]
            if entry is None:
                # Within the test of a conditional expression nothing outside can be closed.
                return
            if entry.wants == word.kind:
                if entry.must or enough:
                    break
                passed_over = True
            elif entry.must:
                return
            place -= 1
        if place < lowest:
            return
        taker = stack[place]
        assert taker is not None
        needed[taker.wants] -= taker.must
        del stack[place:]
        if passed_over:
            self._found.append((taker.first, word.token))
