"""What to say of a token that cannot stand where it stands."""

from collections.abc import Iterable
from typing import Final

from scenic.compiler.actions import Problem
from scenic.compiler.generated import HARD_KEYWORDS, INFIX_KINDS, OPERATORS, SOFT_KEYWORDS, SPECIFIER_KINDS
from scenic.compiler.lexer import (
    DEDENT,
    ENDMARKER,
    FSTRING_END,
    FSTRING_MIDDLE,
    FSTRING_START,
    INDENT,
    NAME,
    NEWLINE,
    NUMBER,
    STRING,
    Tokens,
)

_WORDS: Final = {
    kind: word for table in (HARD_KEYWORDS, OPERATORS, SOFT_KEYWORDS) for word, kind in table.items()
}
_KINDS: Final = {
    ENDMARKER: "the end of the file",
    NEWLINE: "the end of the line",
    INDENT: "an indented block",
    DEDENT: "the end of the block",
    NUMBER: "a number",
    STRING: "a string",
    FSTRING_START: "a string",
    FSTRING_MIDDLE: "text",
    FSTRING_END: "the end of the f-string",
    NAME: "a name",
}

_UNMISTAKABLE: Final = SPECIFIER_KINDS - {HARD_KEYWORDS["at"], HARD_KEYWORDS["in"], HARD_KEYWORDS["not"]}
"""The first words of specifiers that are no operators."""

_MANY: Final = 6


class Expectations:
    """Explains mistakes in the tokens of one text."""

    def __init__(self, tokens: Tokens) -> None:
        self._tokens = tokens
        self._kinds = [*tokens.kinds, 0, 0]

    def problem(self, start: int, token: int, expected: set[int | str]) -> Problem:
        """The mistake of a statement from ``start`` on that is right up to ``token``.

        ``expected`` holds the kinds of tokens, and the labels of rules, that could have stood there.
        """
        special = self._missing_new(start, token) or self._special(start, token, expected)
        if special is not None:
            return special
        found = self.found(token)
        wanted = self.wanted(expected)
        if not wanted:
            return Problem("SC110", self.place(token), f"{found} cannot stand here")
        return Problem("SC110", self.place(token), f"expected {wanted}, but found {found}")

    def place(self, token: int) -> tuple[int, int, int, int]:
        """Where to point: at the token, or at the end of what is before it if it is the end of something."""
        tokens = self._tokens
        if self._kinds[token] in (NEWLINE, ENDMARKER, DEDENT) and token > 0:
            line, column = tokens.end_lines[token - 1], tokens.end_columns[token - 1]
            if self._kinds[token - 1] not in (NEWLINE, DEDENT, INDENT):
                return (line, column, line, column)
        return (
            tokens.lines[token],
            tokens.columns[token],
            tokens.end_lines[token],
            tokens.end_columns[token],
        )

    def found(self, token: int) -> str:
        """What stands at a token, in words."""
        kind = self._kinds[token]
        text = self._tokens.texts[token]
        if kind in (NUMBER, STRING) or kind >= 16:
            return (
                f"`{text}`" if len(text) <= 30 and "\n" not in text else f"`{text[:20].splitlines()[0]}...`"
            )
        return _KINDS.get(kind, "this")

    def wanted(self, expected: Iterable[int | str]) -> str:
        """What could have stood somewhere, in words."""
        kinds = {each for each in expected if isinstance(each, int)}
        words = {each for each in expected if isinstance(each, str)}
        words -= {"a statement"} if len(words) > 1 else set()
        if len(kinds & INFIX_KINDS) > 3:
            kinds -= INFIX_KINDS
            words.add("an operator")
        names = [_KINDS[kind] if kind in _KINDS else f"`{_WORDS[kind]}`" for kind in kinds]
        ordered = sorted(words) + sorted(set(names), key=lambda name: (name.startswith("`"), name))
        ordered = list(dict.fromkeys(ordered))
        if len(ordered) > _MANY:
            ordered = [*ordered[: _MANY - 1], "something else"]
        if len(ordered) > 1:
            return ", ".join(ordered[:-1]) + " or " + ordered[-1]
        return "".join(ordered)

    def _missing_new(self, start: int, token: int) -> Problem | None:
        """``Object facing x``: an instance without ``new``."""
        kinds, texts = self._kinds, self._tokens.texts
        if token == start or kinds[token] not in _UNMISTAKABLE or kinds[token - 1] < NAME:
            return None
        if token - 1 > start and texts[token - 2] in (".", "new"):
            return None
        name = texts[token - 1]
        if not name[:1].isupper():
            return None
        return Problem(
            "SC111",
            self.place(token - 1),
            f"`{name}` is followed by a specifier, but `new` is missing",
            f"write `new {name} {texts[token]} ...`",
        )

    def _special(self, start: int, token: int, expected: set[int | str]) -> Problem | None:
        kinds, texts = self._kinds, self._tokens.texts
        kind, text = kinds[token], texts[token] if token < len(texts) else ""
        place = self.place(token)
        if text == "=" and (expected & INFIX_KINDS) and OPERATORS["="] not in expected:
            return Problem(
                "SC110", place, "`=` assigns a value and cannot stand here", "use `==` to compare two values"
            )
        if (
            kind in HARD_KEYWORDS.values()
            and (NAME in expected or "a name" in expected)
            and len(expected) <= 3
        ):
            return Problem(
                "SC110", place, f"`{text}` is a keyword and cannot be a name", "choose another name"
            )
        if INDENT in expected or expected == {"an indented block"}:
            return Problem(
                "SC110",
                place,
                f"expected an indented block, but found {self.found(token)}",
                "indent the lines of it",
            )
        if kind == INDENT:
            return Problem("SC102", place, "this line is indented more than it can be")
        if OPERATORS[":"] in expected and kind == NEWLINE:
            return Problem("SC110", place, "expected `:`, but found the end of the line", "add `:`")
        return None


__all__ = ["Expectations"]
