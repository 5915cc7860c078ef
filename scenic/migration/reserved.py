"""Names that Scenic 3 reserves: they get a trailing underscore."""

from collections.abc import Iterator, Sequence
from typing import Final

from scenic.compiler.tokens import FSTRING_END, NAME, NUMBER, STRING
from scenic.language.word_sets import word_set
from scenic.migration.texts import TextEdit, Token, first_of_line

__all__ = ["renamings"]

KEYWORDS: Final = frozenset(["new", "at", "by", "do", "of", "on", "to", "until", "require"])
CONVERSIONS: Final = frozenset(["int", "float", "str"])

_NO_OPERANDS: Final = KEYWORDS | word_set(
    "and or not if else elif in is for while return yield lambda assert raise del with as from "
    "import await async except finally try global nonlocal def class pass break continue"
)
"""Words that are no operands themselves."""

_CONTINUING: Final = frozenset(["and", "or", "if", "else", "in", "is", "for", "as", "async"]) | (
    KEYWORDS - {"new", "do", "require"}
)
"""Words that may follow an operand, and do not begin one."""

_STATEMENTS: Final = frozenset({"do", "require"})


def renamings(tokens: Sequence[Token]) -> Iterator[tuple[int, TextEdit]]:
    """Yield the edits that rename what a text calls by a reserved name, each with its line."""
    places: list[tuple[int, str]] = []
    bound: set[str] = set()
    for index, token in enumerate(tokens):
        if token.text in KEYWORDS and token.kind < NAME:
            if _is_name(tokens, index):
                places.append((index, token.text))
                if _binds(tokens, index):
                    bound.add(token.text)
        elif token.text in CONVERSIONS and token.kind >= NAME:
            if not (index and tokens[index - 1].text == "."):
                places.append((index, token.text))
            if _binds(tokens, index) and not _is_annotation(tokens, index):
                bound.add(token.text)
    for index, name in places:
        if name not in bound:
            continue
        token = tokens[index]
        if tokens[index + 1].text == "=" and _in_call(tokens, index) and name in CONVERSIONS:
            continue
        yield token.line, TextEdit(token.start, token.end, f"{name}_")


def _is_annotation(tokens: Sequence[Token], index: int) -> bool:
    return bool(index) and tokens[index - 1].text in (":", "->") and tokens[index + 1].text == "="


def _ends_operand(token: Token) -> bool:
    return (
        (token.kind >= NAME or token.kind in (NUMBER, STRING, FSTRING_END) or token.text in (")", "]", "}"))
        and token.text not in _NO_OPERANDS
    ) or token.text in ("True", "False", "None")


def _begins_operand(token: Token) -> bool:
    if token.is_layout or token.text in _CONTINUING:
        return False
    return (
        token.kind >= NAME
        or token.kind in (NUMBER, STRING, 6)
        or token.text
        in ("(", "[", "{", "-", "+", "~", "not", "lambda", "new", "True", "False", "None", "...")
    )


def _is_name(tokens: Sequence[Token], index: int) -> bool:
    """Return whether a keyword stands where only a name can stand."""
    token, after = tokens[index], tokens[index + 1]
    before = tokens[index - 1] if index else None
    starts = before is None or before.is_layout
    if before is not None and before.text == ".":
        return True
    if before is not None and before.text == "with" and _begins_operand(after):
        return True  # a property of that name
    if not _begins_operand(after):
        return not (after.is_layout and token.text in _STATEMENTS and starts)
    if starts or before is None or _ends_operand(before):
        return False
    if after.text in ("(", "-", "[", "+"):
        return not (before.text == "," and token.text in ("at", "on")) and before.text not in KEYWORDS
    return before.text in ("def", "for", "as", "behavior", "monitor", "scenario", "class")


def _binds(tokens: Sequence[Token], index: int) -> bool:
    """Return whether a name is bound here: assigned, a parameter, the target of a loop, a property or a definition."""
    after = tokens[index + 1].text
    before = tokens[index - 1].text if index else ""
    if before == ".":
        return False
    if after in ("=", "+=", "-=", "*=", "/=", ":="):
        return not _in_call(tokens, index)
    first = tokens[first_of_line(list(tokens), index)]
    if first.text in ("def", "behavior", "monitor", "scenario", "async", "class"):
        return before in ("(", ",", "*", "**", "def", "behavior", "class") and after in (
            ",",
            ")",
            ":",
            "=",
            "(",
        )
    if before in ("for", "as", "def"):
        return True
    if after == ":" and first.start == tokens[index].start:
        return True  # a property
    if after in (",", "in", "=") and _is_target(tokens, index):
        return True
    return before == "lambda" or (before == "," and after == "=")


def _is_target(tokens: Sequence[Token], index: int) -> bool:
    """Return whether a name is in a list of targets: of an assignment, or of a loop."""
    place = index
    while tokens[place].text not in ("=", "in") and not tokens[place].is_layout:
        if tokens[place].kind < NAME and tokens[place].text not in (",", *KEYWORDS):
            return False
        place += 1
    ending = tokens[place].text
    place = index
    while place >= 0 and not tokens[place].is_layout and tokens[place].text != "for":
        if tokens[place].kind < NAME and tokens[place].text not in (",", *KEYWORDS):
            return False
        place -= 1
    is_loop = place >= 0 and tokens[place].text == "for"
    return ending == "=" or (ending == "in" and is_loop)


def _in_call(tokens: Sequence[Token], index: int) -> bool:
    """Return whether a token is within brackets that are not those of a definition."""
    depth = 0
    place = index
    while place >= 0 and not tokens[place].is_layout:
        text = tokens[place].text
        depth += (text in (")", "]", "}")) - (text in ("(", "[", "{"))
        place -= 1
    if depth >= 0:
        return False
    return tokens[place + 1].text not in ("def", "behavior", "monitor", "scenario", "class", "async")
