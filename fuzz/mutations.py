"""Texts that are nearly programs: what becomes of a program when somebody edits it badly."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from fuzz.draws import Draws, HypothesisDraws

__all__ = ["MUTATIONS", "Mutant", "make_mutant", "mutated"]

_TOKEN: Final = re.compile(r"\n[ \t\f]*|[ \t\f]+|\w+|[^\w\s]|\s", re.DOTALL)
"""Rough tokens: words and numbers, indentation, blanks, and every other character by itself."""

_ODD: Final = (
    "\0", "\ud800", "\udfff", "😀", "𝐱", "é", "\u00a0", "\u2028", "\ufeff", "\u200b", "\x1a", "\f", "\r", "\t", "\\",
    "`", "$", "?", "“", "−", "'", '"', '"""', "f'", "{", "}", "(", ")", "[", "]", "#", "\n", "\\\n", "٣", "0_", "1e",
)  # fmt: skip
_LETTERS: Final = "aeiourst"
_INDENTATIONS: Final = ("", " ", "    ", "\t", "        ", " \t", "\f ")
_MOST: Final = 3
"""Largest number of mutations of a mutant; half of the mutants have one."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """A text made from the program ``original``.

    ``start`` is the offset of the first character that differs, in both texts; ``end`` that of what follows the last
    change, in ``text``. From there on the two end alike. If nothing differs, both are the length of the text.
    """

    text: str
    original: str
    start: int
    end: int


Mutation: TypeAlias = Callable[[Draws, list[str], Callable[[], Sequence[str]]], None]
"""Changes a row of rough tokens in place; the last argument gives those of another program."""


def _place(draws: Draws, tokens: Sequence[str], *, after_end: bool = False) -> int:
    return draws.number(max(1, len(tokens) + after_end))


def delete(draws: Draws, tokens: list[str], _other: Callable[[], Sequence[str]]) -> None:
    """Leave out a few tokens."""
    start = _place(draws, tokens)
    del tokens[start : start + 1 + draws.number(3)]


def swap(draws: Draws, tokens: list[str], _other: Callable[[], Sequence[str]]) -> None:
    """Let two tokens change places."""
    left, right = _place(draws, tokens), _place(draws, tokens)
    if tokens:
        tokens[left], tokens[right] = tokens[right], tokens[left]


def double(draws: Draws, tokens: list[str], _other: Callable[[], Sequence[str]]) -> None:
    """Repeat a few tokens."""
    start = _place(draws, tokens)
    piece = tokens[start : start + 1 + draws.number(3)]
    tokens[start:start] = piece * (1 + draws.number(3))


def splice(draws: Draws, tokens: list[str], other: Callable[[], Sequence[str]]) -> None:
    """Put a part of another program in place of a part of this one."""
    source = other()
    start, start_of_other = _place(draws, tokens, after_end=True), _place(draws, source)
    part = source[start_of_other : start_of_other + 1 + draws.number(12)]
    tokens[start : start + draws.number(7)] = part


def truncate(draws: Draws, tokens: list[str], _other: Callable[[], Sequence[str]]) -> None:
    """Stop in the middle, perhaps of a token."""
    end = _place(draws, tokens)
    last = tokens[end][: draws.number(3)] if tokens else ""
    tokens[end:] = [last]


def insert_odd(draws: Draws, tokens: list[str], _other: Callable[[], Sequence[str]]) -> None:
    """Put a character, or a beginning of something, where nothing or something else is expected."""
    tokens.insert(_place(draws, tokens, after_end=True), _ODD[draws.number(len(_ODD))])


def indent(draws: Draws, tokens: list[str], _other: Callable[[], Sequence[str]]) -> None:
    """Change the indentation of a line."""
    lines = [index for index, token in enumerate(tokens) if token.startswith("\n")]
    if lines:
        white = _INDENTATIONS[draws.number(len(_INDENTATIONS))]
        tokens[lines[draws.number(len(lines))]] = f"\n{white}"


def misspell(draws: Draws, tokens: list[str], _other: Callable[[], Sequence[str]]) -> None:
    """Leave out, double, exchange or replace a letter of a word, or write it with another size."""
    words = [index for index, token in enumerate(tokens) if len(token) > 2 and token.isidentifier()]
    if not words:
        return
    index = words[draws.number(len(words))]
    word, kind = tokens[index], draws.number(5)
    at = draws.number(len(word) - 1)
    before, letter, after = word[:at], word[at], word[at + 1 :]
    tokens[index] = (
        before + after,
        before + 2 * letter + after,
        before + after[:1] + letter + after[1:],
        before + _LETTERS[draws.number(len(_LETTERS))] + after,
        word.swapcase() if at else word.capitalize(),
    )[kind]


MUTATIONS: Final[tuple[Mutation, ...]] = (
    delete,
    swap,
    double,
    splice,
    truncate,
    insert_odd,
    indent,
    misspell,
)


def make_mutant(draws: Draws, original: str, other: Callable[[], str], *, most: int = _MOST) -> Mutant:
    """A program with one to ``most`` mutations, half of the time with one; ``other`` gives another program."""
    tokens = _TOKEN.findall(original)
    number = draws.number(2 * (most - 1)) if most > 1 else 0
    for _ in range(1 + max(0, number - (most - 2))):
        MUTATIONS[draws.number(len(MUTATIONS))](draws, tokens, lambda: _TOKEN.findall(other()))
    text = "".join(tokens)
    return Mutant(text, original, *_changed(original, text))


def _changed(original: str, text: str) -> tuple[int, int]:
    """Return the start of the difference between two texts, and its end in the second text."""
    shorter = min(len(original), len(text))
    start = next((index for index in range(shorter) if original[index] != text[index]), shorter)
    alike = 0
    while alike < shorter - start and original[-1 - alike] == text[-1 - alike]:
        alike += 1
    end = len(text) - alike
    return (start, end) if text != original else (len(text), len(text))


def mutated(texts: SearchStrategy[str], *, most: int = _MOST) -> SearchStrategy[Mutant]:
    """Return a strategy for texts with one to ``most`` mutations each; parts are taken from other texts of the same strategy."""

    @st.composite
    def mutant(draw: DrawFn) -> Mutant:
        return make_mutant(HypothesisDraws(draw), draw(texts), lambda: draw(texts), most=most)

    return mutant()
