"""Texts that are nearly programs: what becomes of a program when somebody edits it badly."""

import re
from collections.abc import Callable, Sequence
from typing import Final, TypeAlias

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

__all__ = ["MUTATIONS", "mutated"]

_TOKEN: Final = re.compile(r"\n[ \t\f]*|[ \t\f]+|\w+|[^\w\s]|\s", re.DOTALL)
"""Rough tokens: words and numbers, indentation, blanks, and every other character by itself."""

_ODD: Final = (
    "\0", "\ud800", "\udfff", "😀", "𝐱", "é", "\u00a0", "\u2028", "\ufeff", "\u200b", "\x1a", "\f", "\r", "\t", "\\",
    "`", "$", "?", "“", "−", "'", '"', '"""', "f'", "{", "}", "(", ")", "[", "]", "#", "\n", "\\\n", "٣", "0_", "1e",
)  # fmt: skip

Mutation: TypeAlias = Callable[[DrawFn, list[str], Sequence[str]], None]
"""Changes a row of rough tokens in place; the last argument holds those of another program."""


def _place(draw: DrawFn, tokens: Sequence[str], *, after_end: bool = False) -> int:
    return draw(st.integers(0, max(0, len(tokens) - (0 if after_end else 1))))


def delete(draw: DrawFn, tokens: list[str], _other: Sequence[str]) -> None:
    """Leave out a few tokens."""
    start = _place(draw, tokens)
    del tokens[start : start + draw(st.integers(1, 3))]


def swap(draw: DrawFn, tokens: list[str], _other: Sequence[str]) -> None:
    """Let two tokens change places."""
    if tokens:
        left, right = _place(draw, tokens), _place(draw, tokens)
        tokens[left], tokens[right] = tokens[right], tokens[left]


def double(draw: DrawFn, tokens: list[str], _other: Sequence[str]) -> None:
    """Repeat a few tokens."""
    start = _place(draw, tokens)
    piece = tokens[start : start + draw(st.integers(1, 3))]
    tokens[start:start] = piece * draw(st.integers(1, 3))


def splice(draw: DrawFn, tokens: list[str], other: Sequence[str]) -> None:
    """Put a part of another program in place of a part of this one."""
    start, start_of_other = _place(draw, tokens, after_end=True), _place(draw, other)
    part = other[start_of_other : start_of_other + draw(st.integers(1, 12))]
    tokens[start : start + draw(st.integers(0, 6))] = part


def truncate(draw: DrawFn, tokens: list[str], _other: Sequence[str]) -> None:
    """Stop in the middle, perhaps of a token."""
    end = _place(draw, tokens)
    last = tokens[end][: draw(st.integers(0, 2))] if tokens else ""
    tokens[end:] = [last]


def insert_odd(draw: DrawFn, tokens: list[str], _other: Sequence[str]) -> None:
    """Put a character, or a beginning of something, where nothing or something else is expected."""
    tokens.insert(_place(draw, tokens, after_end=True), draw(st.sampled_from(_ODD)))


def indent(draw: DrawFn, tokens: list[str], _other: Sequence[str]) -> None:
    """Change the indentation of a line."""
    lines = [index for index, token in enumerate(tokens) if token.startswith("\n")]
    if lines:
        white = draw(st.sampled_from(("", " ", "    ", "\t", "        ", " \t", "\f ")))
        tokens[draw(st.sampled_from(lines))] = f"\n{white}"


MUTATIONS: Final[tuple[Mutation, ...]] = (delete, swap, double, splice, truncate, insert_odd, indent)


def mutated(texts: SearchStrategy[str], *, most: int = 3) -> SearchStrategy[str]:
    """Texts with one to ``most`` mutations each; parts are taken from other texts of the same strategy."""
    mutation_strategy = st.sampled_from(MUTATIONS)
    count_strategy = st.integers(1, most)

    @st.composite
    def mutant(draw: DrawFn) -> str:
        tokens = _TOKEN.findall(draw(texts))
        other: list[str] | None = None
        for _ in range(draw(count_strategy)):
            mutation = draw(mutation_strategy)
            if mutation is splice and other is None:
                other = _TOKEN.findall(draw(texts))
            mutation(draw, tokens, other or ())
        return "".join(tokens)

    return mutant()
