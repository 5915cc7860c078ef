"""The possible continuations at a place of a text: the parser runs up to the place and records the tokens that it expects there.

The text after the place does not count. Of the text before it, only the statement around the place has to be right;
where this has a mistake, the line alone.
"""

from collections.abc import Iterable
from functools import cache
from typing import Any, Final

from scenic.compiler.actions import Actions
from scenic.compiler.generated import KIND_NAMES, WORDS, build_recording_parser
from scenic.compiler.lexer import lex
from scenic.compiler.parser import deep_recursion
from scenic.compiler.syntax import BLOCK_STARTERS, RULES, RuleReference, first_words
from scenic.compiler.tokens import DEDENT, ERROR, INDENT, NEWLINE, Tokens
from scenic.dataclass import dataclass

__all__ = ["CLAUSES", "Wanted", "wanted_at"]

_MARK: Final = "$"
"""Read as a token that fits nowhere: what the parser wants instead of it is what may stand there."""
_MOST_LINES: Final = 400
"""So many lines before a place are looked at."""
CLAUSES: Final = frozenset(BLOCK_STARTERS - first_words((RuleReference("statement"),)))
"""The first words of lines that continue the statement before them."""
_GOING_ON: Final = (*sorted(CLAUSES), ")", "]", "}")
"""Beginnings of lines that continue the statement before them."""
_ALONE: Final = ("statement", "class_item", "specifier_line")
"""Grammar rules for a line that is read without the lines around it."""

_NAMES: Final = {kind: word for word, kind in WORDS.items()}

_LABELLED: Final = {
    label: tuple(RuleReference(rule.name) for rule in RULES.values() if rule.label == label)
    for label in {rule.label for rule in RULES.values() if rule.label is not None}
}


@dataclass(frozen=True, slots=True)
class Wanted:
    """The possible continuations at a place.

    ``words`` are keywords and operators; ``labels`` what messages call other things, such as ``"an expression"``;
    ``kinds`` are those of tokens of varying text, such as ``"NAME"``. ``before`` are the tokens of the logical line
    before the place.
    """

    words: frozenset[str]
    labels: frozenset[str]
    kinds: frozenset[str]
    before: tuple[str, ...]

    def begins(self, label: str) -> frozenset[str]:
        """Return the words with which what a label stands for may begin, none if it cannot stand here."""
        if label not in self.labels:
            return frozenset()
        return _beginnings(label)


@cache
def _beginnings(label: str) -> frozenset[str]:
    return frozenset().union(*(first_words((rule,)) for rule in _LABELLED.get(label, ())))


def wanted_at(text: str, line: int, column: int) -> Wanted | None:
    """Return the possible continuations at ``line`` (from 1) and ``column`` (in characters from 0), where a new token begins.

    ``None`` in strings and comments, and where what stands before on the line cannot be right.
    """
    lines = text.split("\n")
    here = lines[line - 1][:column]
    around = _around(lines[max(0, line - 1 - _MOST_LINES) : line - 1], here)
    for before, rules in (("\n".join(around), ("statement",)), (here.lstrip(), _ALONE)):
        tokens = lex(before + _MARK, WORDS)
        mark = next((index for index, kind in enumerate(tokens.kinds) if kind == ERROR), -1)
        if mark < 0 or tokens.texts[mark] != _MARK:
            return None
        continuations = {each for rule in rules for each in _expected(tokens, mark, rule)}
        if continuations:
            return _wanted(tokens, mark, continuations)
    return None


def _around(lines: list[str], here: str) -> list[str]:
    """The relevant lines before a place: headers of the blocks around it, and statements that they may continue."""
    level = _indentation(here)
    relevant = [here]
    is_whole = not _goes_on(here)
    is_near = True
    for text in reversed(lines):
        content = text.lstrip()
        if not content or content[0] == "#":
            continue
        column = _indentation(text)
        if column > level:
            if is_near:
                relevant.append(text)
        elif column < level or is_near:
            relevant.append(text)
            is_whole = not _goes_on(text)
            # The statement before the line itself is kept, and further out only what a clause belongs to.
            is_near = not is_whole
            level = column
            if not level and is_whole:
                break
    return relevant[::-1]


def _indentation(text: str) -> int:
    return len(text) - len(text.lstrip())


def _goes_on(text: str) -> bool:
    """Return whether a line continues the statement before it."""
    return text.lstrip().startswith(_GOING_ON)


def _wanted(tokens: Tokens, mark: int, expected: Iterable[int | str]) -> Wanted:
    start = mark
    while start > 0 and tokens.kinds[start - 1] not in (NEWLINE, INDENT, DEDENT):
        start -= 1
    kinds = [each for each in expected if isinstance(each, int)]
    return Wanted(
        frozenset(_NAMES[kind] for kind in kinds if kind in _NAMES),
        frozenset(each for each in expected if isinstance(each, str)),
        frozenset(KIND_NAMES[kind] for kind in kinds if kind in KIND_NAMES),
        tuple(tokens.texts[start:mark]),
    )


def _expected(tokens: Tokens, mark: int, rule: str) -> set[int | str]:
    """Return the tokens that the parser expects at the token ``mark``, reading by ``rule`` from the first token
    on; empty if it fails before.
    """
    probe = _Probe()
    probe.run = build_recording_parser(*tokens.lists(), Actions(tokens), probe)
    try:
        with deep_recursion():
            probe(rule, 0)
    except RecursionError:
        return set()
    return probe.expected if probe.farthest == mark else set()


class _Probe:
    """Reads block after block, and keeps what was wanted at the farthest token."""

    def __init__(self) -> None:
        self.run: Any = None
        self.farthest = -1
        self.expected: set[int | str] = set()

    def __call__(self, rule: str, position: int) -> tuple[list[Any], int]:
        body: list[Any] = []
        while True:
            node, end, farthest, alternatives = self.run(rule, position)
            if farthest > self.farthest:
                self.farthest, self.expected = farthest, set()
            if farthest == self.farthest:
                self.expected |= alternatives
            if node is None:
                return body, position
            body.append(node)
            position = end
