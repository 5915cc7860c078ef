"""Messages about a token that cannot stand where it stands."""

from collections.abc import Iterable
from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.generated import HARD_KEYWORDS, INFIX_KINDS, OPERATORS, SOFT_KEYWORDS
from scenic.compiler.mistakes import (
    Situation,
    Trials,
    explain,
    header_without_colon,
    instead_of_failure,
    unfinished_header,
)
from scenic.compiler.phrases import TEMPORAL_FORMS
from scenic.compiler.precedence import Fixity
from scenic.compiler.tokens import (
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

_CONNECTORS: Final = frozenset(OPERATORS[mark] for mark in (",", ";", ":", "="))
_POSTFIX: Final = frozenset(OPERATORS[mark] for mark in ("(", "[", "."))
_SEPARATORS: Final = frozenset({"`)`", "`]`", "`}`", "`,`", "`:`", "`;`", "`=`"})
"""Tokens before which something may be missing."""

_AFTER: Final = {
    "new": "the name of a class",
    "with": "the name of a property",
    "def": "the name of the function",
    "class": "the name of the class",
    "behavior": "the name of the behavior",
    "monitor": "the name of the monitor",
    "scenario": "the name of the scenario",
    "global": "the name of a variable",
    "nonlocal": "the name of a variable",
    ".": "the name of an attribute",
    "!": "`s`, `r` or `a`",
}
"""Descriptions of the name that has to follow a word."""

_SHOWN: Final = {"a target": "a variable"}
"""Labels of rules that are too learned for messages."""

_DOTS: Final = frozenset({OPERATORS["."], OPERATORS["..."]})

_TEMPORAL_STARTS: Final = frozenset(
    SOFT_KEYWORDS[form.words[0]] for form in TEMPORAL_FORMS if form.fixity is Fixity.PREFIX
)

_MANY: Final = 5
"""So many possibilities are named."""


class Expectations:
    """Explains mistakes in the tokens of one text."""

    def __init__(self, tokens: Tokens) -> None:
        self._tokens = tokens
        self._kinds = [*tokens.kinds, 0, 0]
        self._trials = Trials(tokens)

    def problem(self, start: int, token: int, expected: Iterable[int | str]) -> SyntaxProblem:
        """Return the mistake of a statement from ``start`` on that is right up to ``token``.

        ``expected`` holds the kinds of tokens, and the labels of rules, that could have stood there.
        """
        at = Situation(self._tokens, self._trials, start, token, frozenset(expected))
        explanation = explain(at)
        if explanation is not None:
            return explanation
        actual = self.found(token)
        alternatives = _AFTER.get(at.before, "") if at.expected <= {NAME, "a name"} else ""
        if at.before == "." and at.word(at.first) in ("model", "import", "from"):
            alternatives = "the name of a module"
        if not alternatives:
            alternatives = self.wanted(
                at.expected, after_word=self._kinds[token - 1] > NAME if token else False
            )
        if not alternatives:
            return SyntaxProblem("SC110", at.here(), f"{actual} cannot stand here")
        # After the end of a line it is not plain where the expected would have stood.
        # Where something is missing, it is what is before it that misses it.
        missing = (
            at.before
            and (at.at_end() or actual in _SEPARATORS)
            and not alternatives.startswith("an operator")
        )
        where = f" after `{at.before}`" if missing else ""
        return SyntaxProblem("SC110", at.here(), f"expected {alternatives}{where}, but found {actual}")

    def failed(self, start: int, failure: SyntaxProblem) -> SyntaxProblem:
        """Return the mistake of a statement from ``start`` on whose parts are right, but for ``failure``."""
        if failure.code != "SC123":
            return failure
        first, end = self._trials.line(start)
        texts = self._tokens.texts
        signs = [index for index in range(first + 1, end) if texts[index] == "="]
        for sign in signs:
            explanation = instead_of_failure(Situation(self._tokens, self._trials, start, sign, frozenset()))
            if explanation is not None:
                return explanation
        return failure

    def unfinished_header(self, first: int) -> SyntaxProblem | None:
        """Return the mistake of a line before an indented one, if it is the beginning of a header."""
        start, end = self._trials.line(max(first - 3, 0))
        return unfinished_header(Situation(self._tokens, self._trials, start, end, frozenset()))

    def unfinished_clause(self, first: int) -> SyntaxProblem:
        """Return the mistake of a line that is the beginning of a clause."""
        start, end = self._trials.line(first)
        at = Situation(self._tokens, self._trials, start, end, frozenset())
        return SyntaxProblem(
            "SC110",
            at.place(first),
            f"`{at.word(first)}` is no complete clause",
            "write the whole clause, with a colon at its end",
        )

    def unexpected_block(self, first: int) -> SyntaxProblem:
        """Return the mistake of a line, with its first token, that is indented more than the one before."""
        # Before it stand the end of the line before, and the indentation.
        start, end = self._trials.line(max(first - 3, 0))
        before = Situation(self._tokens, self._trials, start, end, frozenset())
        return header_without_colon(before) or SyntaxProblem(
            "SC102",
            before.place(first),
            "this line is indented more than the one before, which begins no block",
            "align it with the line before",
        )

    def found(self, token: int) -> str:
        """Return the text at a token, in words."""
        kind = self._kinds[token]
        text = self._tokens.texts[token]
        if kind in (NUMBER, STRING) or kind >= 16:
            return (
                f"`{text}`" if len(text) <= 30 and "\n" not in text else f"`{text[:20].splitlines()[0]}...`"
            )
        return _KINDS.get(kind, "this")

    def wanted(self, expected: Iterable[int | str], *, after_word: bool = False) -> str:
        """The possible texts at a place, in words; ``after_word``: directly after a soft keyword."""
        kinds = {each for each in expected if isinstance(each, int)}
        words = {each for each in expected if isinstance(each, str)}
        if kinds >= _TEMPORAL_STARTS:
            # The words that start a condition say less than that one is missing.
            kinds -= _TEMPORAL_STARTS | {HARD_KEYWORDS["not"]}
            words = (words - {"an expression"}) | {"a condition"}
        likely = kinds - INFIX_KINDS - _CONNECTORS - {NEWLINE}
        if after_word and len(kinds & INFIX_KINDS) > 5 and (likely or words - {"an assignment operator"}):
            # The word may be a name, after which nearly everything can go on; but it was hardly meant as one.
            kinds = likely
            words.discard("an assignment operator")
        if len(words) > 1:
            words.discard("a statement")
        if (kinds | words) - _POSTFIX:
            kinds -= _POSTFIX
        if len(kinds | words) > 2:
            kinds.discard(OPERATORS[":="])
        if HARD_KEYWORDS["for"] in kinds:
            kinds.discard(HARD_KEYWORDS["async"])
        if len(kinds & INFIX_KINDS) > 5:
            kinds -= INFIX_KINDS
            words.add("an operator")
            if NEWLINE in kinds:
                # After a complete statement nearly everything can go on; what is said is what is likely.
                kinds -= _CONNECTORS
                words.discard("an assignment operator")
        if "the name of a module" in words:
            kinds -= _DOTS
        words = {_SHOWN.get(word, word) for word in words}
        names = {_KINDS[kind] if kind in _KINDS else f"`{_WORDS[kind]}`" for kind in kinds}
        alternatives = sorted(words | names, key=lambda name: (name.startswith("`"), name))
        if len(alternatives) > _MANY:
            alternatives = [*alternatives[: _MANY - 1], "something else"]
        if len(alternatives) > 1:
            return ", ".join(alternatives[:-1]) + " or " + alternatives[-1]
        return "".join(alternatives)


__all__ = ["Expectations"]
