"""The tokens of a logical line, and the line that they make in the usual style."""

from collections.abc import Container, Iterator, Sequence
from typing import Final, NamedTuple

from scenic.compiler.generated import WORDS
from scenic.compiler.precedence import FORMS, Word
from scenic.compiler.tokens import (
    DEDENT,
    ENDMARKER,
    FSTRING_END,
    FSTRING_START,
    INDENT,
    NAME,
    NEWLINE,
    NUMBER,
    STRING,
)
from scenic.dataclass import dataclass
from scenic.ide.snapshot import Snapshot

__all__ = ["Lexeme", "lexemes", "needless_pairs", "spaced", "text_of"]

_LAYOUT: Final = frozenset({NEWLINE, INDENT, DEDENT, ENDMARKER})
_CLOSERS: Final = {")": "(", "]": "[", "}": "{"}
_OPENERS: Final = frozenset(_CLOSERS.values())
_DEFINING: Final = frozenset({"class", "def", "behavior", "monitor", "scenario"})
_VALUES: Final = frozenset({"None", "True", "False", "..."})
_PREFIXES: Final = frozenset({"+", "-", "~", "*", "**", "@"})
_LAST_WORDS: Final = frozenset(form.parts[-1].text for form in FORMS if isinstance(form.parts[-1], Word))
"""Words and marks that end an operation, such as the unit ``deg``."""

_OPERATORS: Final = frozenset(word for form in FORMS for word in form.words) - frozenset(
    {"(", ")", "[", "]", "{", "}", ",", ":", ".", "=", ":=", "if", "else", "lambda", "new", "yield"}
)
"""Words and marks of operators beside which, and around which, parentheses show what an operator takes."""


class Lexeme(NamedTuple):
    """A token, or a whole f-string, as ``token`` gives its place among the tokens of a text.

    ``is_name`` tells whether a word is a name here, ``is_value`` whether it is a number, a string or a constant.
    """

    token: int
    text: str
    is_name: bool = False
    is_value: bool = False

    @property
    def ends_operand(self) -> bool:
        """Return whether an operator that follows has this as the end of its first operand."""
        return self.is_name or self.is_value or self.text in _CLOSERS or self.text in _LAST_WORDS


def lexemes(snapshot: Snapshot, begin: int, end: int) -> list[Lexeme]:
    """Return the tokens from ``begin`` on and before ``end``, without layout."""
    tokens, names = snapshot.tokens, _places_of_names(snapshot)
    result: list[Lexeme] = []
    first_token = depth = 0
    for index in range(begin, end):
        kind, text = tokens.kinds[index], tokens.texts[index]
        if kind == FSTRING_START:
            first_token = first_token if depth else index
            depth += 1
        elif kind == FSTRING_END:
            depth -= 1
            if not depth:
                result.append(Lexeme(first_token, _source(snapshot, first_token, index), is_value=True))
        elif not depth and kind not in _LAYOUT:
            place = tokens.lines[index], tokens.columns[index]
            before = result[-1].text if result else ""
            is_name = text.isidentifier() and (
                kind == NAME
                or place in names
                or before in _DEFINING
                or (before == "." and result[0].text != "from")
            )
            if before == "with" and result[0].text not in ("with", "async"):
                is_name = False  # A property, whose value follows.
            is_value = kind in (NUMBER, STRING) or text in _VALUES
            if kind == NAME and text in WORDS:
                text = _source(snapshot, index, index)  # In letters that keep it from being a keyword.
            result.append(Lexeme(index, text, is_name and not is_value, is_value))
    return result


def _places_of_names(snapshot: Snapshot) -> Container[tuple[int, int]]:
    return snapshot.derived(
        "places of names",
        lambda: frozenset(
            (node.lineno, node.col_offset)  # type: ignore[attr-defined] # all of them are names
            for node in snapshot.resolution.references
        ),
    )


def _source(snapshot: Snapshot, first: int, last: int) -> str:
    """Return the text from one token to another one, as it stands."""
    start, end = snapshot.span_of_token(first), snapshot.span_of_token(last)
    lines = list(snapshot.source.lines[start.line - 1 : end.end_line])
    lines[-1] = lines[-1][: end.end_column]
    lines[0] = lines[0][start.column :]
    return "\n".join(lines)


def text_of(snapshot: Snapshot, begin: int, end: int) -> str:
    """Return the tokens from ``begin`` on and before ``end`` on one line."""
    return spaced(lexemes(snapshot, begin, end))


@dataclass(slots=True)
class _Bracket:
    """An open bracket, or the whole line: whether it takes an item, the colons that lambdas in it still want, and
    whether the present parameter in it has an annotation.
    """

    opener: str
    is_subscript: bool = False
    lambdas: int = 0
    is_annotated: bool = False

    @property
    def has_tight_equals(self) -> bool:
        """Return whether ``=`` gives an argument or the default of a parameter without annotation."""
        return (self.opener in ("(", "[") or self.lambdas > 0) and not self.is_annotated


def spaced(line: Sequence[Lexeme]) -> str:
    """Return a line with blanks as the usual style has them, and with strings in double quotes where that is as short."""
    parts: list[str] = []
    brackets = [_Bracket("")]
    before: Lexeme | None = None
    is_tight = True  # No blank follows what was written last, whatever comes.
    for place, lexeme in enumerate(line):
        text, bracket = lexeme.text, brackets[-1]
        if text in _CLOSERS and len(brackets) > 1:
            brackets.pop()
        adjoins = _adjoins(line, place)
        if before is not None and not is_tight and not adjoins and not _is_tight(before, lexeme, bracket):
            parts.append(" ")
        parts.append(_quoted(text) if lexeme.is_value else text)
        is_tight = text in _OPENERS or text == "." or (text in _PREFIXES and _is_prefix(before))
        if text in _OPENERS:
            brackets.append(_Bracket(text, text == "[" and adjoins))
        elif text == "lambda":
            bracket.lambdas += 1
        elif text == ",":
            bracket.is_annotated = False
        elif text == ":" and bracket.lambdas:
            bracket.lambdas -= 1
        elif text == ":":
            is_tight = bracket.is_subscript
            bracket.is_annotated = bracket.opener == "("
        elif text == "=":
            is_tight = bracket.has_tight_equals
        if line[0].text == "from" and text in (".", "..."):
            is_tight = place + 1 < len(line) and line[place + 1].text != "import"
        before = lexeme
    return "".join(parts)


def _is_prefix(before: Lexeme | None) -> bool:
    return before is None or not (before.ends_operand or before.text == "except")


def _adjoins(line: Sequence[Lexeme], place: int) -> bool:
    """Return whether an opening bracket belongs to what stands before it: a call, an item, parameters, a probability."""
    if not place or line[place].text not in ("(", "["):
        return False
    before = line[place - 1]
    if _is_requirement(line, place - 1):
        return line[place].text == "[" and line[place + 1].is_value and line[place + 2].text == "]"
    if before.text == "]" and _is_requirement(line, place - 4):
        return False
    return before.is_name or before.text in _CLOSERS or (before.is_value and not before.text[0].isdigit())


def _is_requirement(line: Sequence[Lexeme], place: int) -> bool:
    return place == 0 and line[0].text == "require" and not line[0].is_name


def _is_tight(before: Lexeme, after: Lexeme, bracket: _Bracket) -> bool:
    """Return whether no blank stands before ``after``."""
    text = after.text
    if text == ".":
        is_integer = before.text[0].isdigit() and "." not in before.text
        return before.text != "from" and not is_integer
    return (
        text in _CLOSERS
        or text in (",", ";")
        or (text == ":" and before.text != ",")
        or (text == "=" and bracket.has_tight_equals)
        or (text == "*" and before.text == "except")
    )


def _quoted(text: str) -> str:
    """A string in double quotes, if that needs no more backslashes."""
    start = text.find("'")
    prefix = text[:start] if start >= 0 else ""
    if start < 0 or (prefix and not prefix.isalpha()):
        return text
    quotes = 3 if text.startswith("'''", start) else 1
    body = text[start + quotes : -quotes]
    if '"' in body or (quotes == 3 and "'" in body) or ("\\'" in body and "r" in prefix.lower()):
        return text
    if "f" in prefix.lower() and "'" in body:
        return text
    body = body.replace("\\'", "'") if "\\\\" not in body else body
    return text if quotes == 1 and "\\'" in body else f"{prefix}{quotes * chr(34)}{body}{quotes * chr(34)}"


def needless_pairs(line: Sequence[Lexeme]) -> Iterator[tuple[Lexeme, Lexeme]]:
    """Yield the parentheses of a line that may be needless, outer ones first, and show nothing about operators.

    Each pair is judged as if those before it were gone. Whether the line is read as before without it is another question.
    """
    token_numbers: set[int] = set()
    for place, opening in enumerate(line):
        if opening.text != "(" or _adjoins(line, place):
            continue
        last = _closing(line, place)
        if last is None or last == place + 1:
            continue
        inner = line[place + 1 : last]
        if len(inner) > 1 and any(each.text in (".", "[", "(") for each in line[last + 1 : last + 2]):
            continue
        tops = list(_at_top(inner))
        is_import = place > 0 and line[place - 1].text == "import"
        if not is_import and any(each.text in (",", ":=", "for", "async") for each in tops):
            continue
        beside = [_kept(reversed(line[:place]), token_numbers), _kept(line[last + 1 :], token_numbers)]
        if any(map(_is_operator, tops)) and any(each is not None and _is_operator(each) for each in beside):
            continue
        token_numbers.update((opening.token, line[last].token))
        yield opening, line[last]


def _kept(line: Sequence[Lexeme] | Iterator[Lexeme], dropped: Container[int]) -> Lexeme | None:
    return next((each for each in line if each.token not in dropped), None)


def _is_operator(lexeme: Lexeme) -> bool:
    return lexeme.text in _OPERATORS and not (lexeme.is_name or lexeme.is_value)


def _closing(line: Sequence[Lexeme], place: int) -> int | None:
    """The place of the bracket that closes the one at ``place``."""
    depth = 0
    for index in range(place, len(line)):
        depth += (line[index].text in _OPENERS) - (line[index].text in _CLOSERS)
        if not depth:
            return index
    return None


def _at_top(line: Sequence[Lexeme]) -> Iterator[Lexeme]:
    """Yield the tokens that are in no further brackets."""
    depth = 0
    for lexeme in line:
        depth -= lexeme.text in _CLOSERS
        if not depth:
            yield lexeme
        depth += lexeme.text in _OPENERS
