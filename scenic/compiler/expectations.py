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

_CONNECTORS: Final = frozenset(OPERATORS[mark] for mark in (",", ";", ":", "="))
_POSTFIX: Final = frozenset(OPERATORS[mark] for mark in ("(", "[", "."))
_KEYWORD_KINDS: Final = frozenset(HARD_KEYWORDS.values())
_NAME_LABELS: Final = frozenset({"a name", "a parameter", "a parameter's name", "the name of a module"})

_PREFIX_OPERATORS: Final = frozenset(
    [(word, mark) for word in ("distance", "angle", "altitude") for mark in ("to", "from")]
    + [("distance", "past"), ("relative", "heading"), ("relative", "position"), ("apparent", "heading")]
    + [(word, "of") for word in ("front", "back", "left", "right", "top", "bottom")]
)
"""The first words of prefix operators, of which the first is a name where no such operator can stand."""

_MANY: Final = 5
"""So many possibilities are named."""


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
        if self._kinds[token] in (NEWLINE, ENDMARKER, DEDENT):
            while token > 0 and self._kinds[token] in (NEWLINE, ENDMARKER, DEDENT, INDENT):
                token -= 1
            line, column = tokens.end_lines[token], tokens.end_columns[token]
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
        if len(words) > 1:
            words.discard("a statement")
        if (kinds | words) - _POSTFIX:
            kinds -= _POSTFIX
        if len(kinds & INFIX_KINDS) > 5:
            kinds -= INFIX_KINDS
            words.add("an operator")
            if NEWLINE in kinds:
                # After a complete statement nearly everything can go on; what is said is what is likely.
                kinds -= _CONNECTORS
                words.discard("an assignment operator")
        names = {_KINDS[kind] if kind in _KINDS else f"`{_WORDS[kind]}`" for kind in kinds}
        ordered = sorted(words | names, key=lambda name: (name.startswith("`"), name))
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
        """A mistake that has its own message."""
        kind = self._kinds[token]
        text = self._tokens.texts[token]
        place = self.place(token)
        if kind == NEWLINE and OPERATORS[":"] in expected:
            return Problem("SC110", place, "expected `:`, but found the end of the line", "add `:`")
        if INDENT in expected or expected == {"an indented block"}:
            return Problem(
                "SC110",
                place,
                f"expected an indented block, but found {self.found(token)}",
                "indent the lines of the block",
            )
        if kind == INDENT:
            return Problem("SC102", place, "this line is indented more than it can be", "indent it less")
        if kind in _KEYWORD_KINDS and (
            expected & _NAME_LABELS
            or ("an argument" in expected and self._kinds[token + 1] == OPERATORS["="])
            or expected == {NAME}
        ):
            return Problem(
                "SC110", place, f"`{text}` is a keyword and cannot be a name", "choose another name"
            )
        return self._special_word(start, token, expected)

    def _special_word(self, start: int, token: int, expected: set[int | str]) -> Problem | None:
        """A mistake that is known by the words around it."""
        texts = self._tokens.texts
        text, before, first = texts[token], texts[token - 1] if token > start else "", texts[start]
        place = self.place(token)
        if text == "=" and expected & INFIX_KINDS and OPERATORS["="] not in expected:
            if token > start + 1 and texts[start + 1] == ":" and self._kinds[start] >= NAME:
                return Problem(
                    "SC110",
                    place,
                    "annotated assignments are not allowed in a class: `name: value` defines a property",
                    f"write `{first}: value`, or `{first} = value` for an ordinary attribute",
                )
            return Problem(
                "SC110", place, "`=` assigns a value and cannot stand here", "use `==` to compare two values"
            )
        if (before, text) in _PREFIX_OPERATORS:
            return Problem(
                "SC110",
                place,
                f"`{before} {text}` is looser than the operator before it",
                f"put parentheses around `{before} {text} ...`",
            )
        if first == "require" and text in ("until", "implies"):
            return Problem(
                "SC110", place, f"`{text}` takes exactly two operands", "put parentheses around two of them"
            )
        if first == "require" and before == "]" and texts[start + 1] == "[":
            return Problem(
                "SC220",
                self.place(start + 2),
                "the probability of a requirement has to be a number between 0 and 1",
                "write it out, as in `require[0.5] ...`",
            )
        if first == "do" and text == "until":
            return Problem(
                "SC110",
                place,
                "a conditional expression before `until` has to stand in parentheses",
                "put parentheses around what stands between `do` and `until`",
            )
        if first == "monitor" and text == ":" and token == start + 2:
            return Problem(
                "SC110",
                place,
                "the definition of a monitor needs parentheses",
                f"write `monitor {before}():`",
            )
        return None


__all__ = ["Expectations"]
