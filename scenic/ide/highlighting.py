"""Input of a highlighter without a parser: the words of the language and the places where they are keywords.

Read from the grammar and the declarations; Pygments, TextMate grammars, Vim and the playground show the same. Soft
keywords are names in most places, so most of them count only within a phrase of several words, or before an operand.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from enum import StrEnum
from itertools import groupby
from typing import Final

from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS
from scenic.compiler.phrases import SCENIC_FORMS
from scenic.compiler.precedence import FORMS, Form, Slot, Word
from scenic.compiler.syntax import (
    RULES,
    STATEMENT_FORMS,
    ListOf,
    Optional,
    Row,
    RuleReference,
    TokenKind,
    words_of,
)
from scenic.compiler.syntax import Word as Written
from scenic.dataclass import dataclass
from scenic.language.names import NAMES, TRACKED, NameKind
from scenic.language.properties import CLASSES, properties_of

__all__ = ["PATTERNS", "VOCABULARY", "Category", "Pattern", "Vocabulary", "any_of"]


class Category(StrEnum):
    """The categories that pieces of text are shown as."""

    STATEMENT = "statement"
    DEFINITION = "definition"
    OPERATOR = "operator"
    CONSTANT = "constant"
    VARIABLE = "variable"
    CLASS = "class"
    FUNCTION = "function"
    PROPERTY = "property"
    DEFINED = "defined"


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """The words, by where they are keywords.

    ``phrases`` are rows of words that are keywords together; ``before_operands`` single words of operators and
    specifiers, keywords if an operand follows; ``after_operands`` those that end one. The words of statements count at
    the beginning of a line: ``statements`` before an operand, ``whole_statements`` alone, ``blocks`` before a colon,
    ``headers`` on a line that ends with a colon. ``definitions`` are followed by a name that they define.
    """

    statement_words: frozenset[str]
    operator_words: frozenset[str]
    constants: frozenset[str]
    variables: frozenset[str]
    definitions: frozenset[str]
    phrases: tuple[tuple[str, ...], ...]
    before_operands: frozenset[str]
    after_operands: frozenset[str]
    infix: frozenset[str]
    statement_starts: frozenset[str]
    statements: frozenset[str]
    whole_statements: frozenset[str]
    blocks: frozenset[str]
    headers: frozenset[str]
    classes: frozenset[str]
    functions: frozenset[str]
    properties: frozenset[str]


@dataclass(frozen=True, slots=True)
class _Run:
    """Words in a row in a form, and whether operands stand before and after them."""

    words: tuple[str, ...]
    before: bool
    after: bool


def _runs(form: Form) -> Iterator[_Run]:
    for is_word, group in groupby(enumerate(form.parts), lambda each: isinstance(each[1], Word)):
        if is_word:
            found = list(group)
            words = tuple(part.text for _, part in found if isinstance(part, Word))
            yield _Run(words, found[0][0] > 0, found[-1][0] + 1 < len(form.parts))


def _starts_of_statements() -> tuple[Mapping[str, set[str]], set[tuple[str, ...]]]:
    """Return the words that begin statements, by what follows them, and runs of several words."""
    starts: dict[str, set[str]] = {
        kind: set() for kind in ("statement", "whole", "block", "header", "definition")
    }
    phrases: set[tuple[str, ...]] = set()
    for form in STATEMENT_FORMS:
        words = _leading(form.row)
        if form.has_block and _begins_with_name(form.row[1:]):
            starts["definition"].add(form.start)
            continue
        match form.row[1:]:
            case _ if not form.is_soft:
                pass
            case (Written(":"), *_):
                starts["block"].add(form.start)
            case () | (Optional(),):
                starts["whole"].add(form.start)
            case _ if form.has_block and len(words) == 1:
                starts["header"].add(form.start)
            case (RuleReference() | ListOf() | TokenKind(), *_):
                starts["statement"].add(form.start)
        if len(words) > 1:
            phrases.add(words)
    return starts, phrases


def _vocabulary() -> Vocabulary:
    runs = [run for form in SCENIC_FORMS for run in _runs(form)]
    by_kind, phrases = _starts_of_statements()
    phrases |= {run.words for run in runs if len(run.words) > 1}
    infix = {
        form.parts[1].text
        for form in FORMS
        if isinstance(form.parts[0], Slot) and isinstance(form.parts[1], Word)
    }
    constants = frozenset(word for word in HARD_KEYWORDS if word[0].isupper())
    of_expressions = frozenset(
        part.text
        for form in FORMS
        for part in form.parts
        if isinstance(part, Word) and part.text in HARD_KEYWORDS
    )
    operators = of_expressions | {word for run in runs for word in run.words if word in HARD_KEYWORDS}
    starts = frozenset(form.start for form in STATEMENT_FORMS)
    return Vocabulary(
        statement_words=frozenset(HARD_KEYWORDS) - constants - (operators - starts) - by_kind["definition"],
        operator_words=operators - starts,
        constants=constants,
        variables=frozenset(TRACKED) | _named(NameKind.VALUE) | {"self"},
        definitions=frozenset(by_kind["definition"]),
        phrases=tuple(sorted(phrases, key=lambda words: (-len(words), words))),
        before_operands=_single(runs, after=True),
        after_operands=_single(runs, before=True, after=False) | _units(),
        infix=frozenset(word for word in infix if word.isidentifier()),
        statement_starts=starts,
        statements=frozenset(by_kind["statement"]),
        whole_statements=frozenset(by_kind["whole"]),
        blocks=frozenset(by_kind["block"]),
        headers=frozenset(by_kind["header"]),
        classes=_named(
            NameKind.CLASS, NameKind.SHAPE, NameKind.REGION, NameKind.DISTRIBUTION, NameKind.EXCEPTION
        ),
        functions=_named(NameKind.FUNCTION),
        properties=frozenset(name for cls in CLASSES for name in properties_of(cls)),
    )


def _begins_with_name(row: Row) -> bool:
    match row:
        case (TokenKind("NAME"), *_):
            return True
        case (RuleReference(rule), *_):
            alternatives = RULES[rule].alternatives
            return len(alternatives) == 1 and _begins_with_name(alternatives[0].row)
    return False


def _leading(row: Row) -> tuple[str, ...]:
    """Return the words that a statement begins with."""
    words: list[str] = []
    for item in row:
        if not isinstance(item, Written) or not item.text.isidentifier():
            break
        words.append(item.text)
    return tuple(words)


def _single(runs: Iterable[_Run], *, before: bool | None = None, after: bool) -> frozenset[str]:
    """Return the soft keywords that stand alone, with an operand after them or not, and before them if that matters."""
    return frozenset(
        run.words[0]
        for run in runs
        if len(run.words) == 1
        and run.words[0] in SOFT_KEYWORDS
        and run.after == after
        and (before is None or run.before == before)
    )


def _units() -> frozenset[str]:
    """Return the words that durations end with."""
    return frozenset(word for each in RULES["duration"].alternatives for word in words_of(each.row))


def _named(*kinds: NameKind) -> frozenset[str]:
    return frozenset(name.name for name in NAMES.values() if name.kind in kinds)


VOCABULARY: Final = _vocabulary()
"""The words of the language, as the grammar and the declarations have them."""


@dataclass(frozen=True, slots=True)
class Pattern:
    """Pieces of one line that stand one after the other: regular expressions, and what each is shown as, if anything.

    The expressions are the same in Python, Oniguruma and JavaScript. What stands ``before`` and ``after`` the pieces is
    only looked at; ``is_line_start`` tells that the first piece begins its line.
    """

    pieces: tuple[tuple[str, Category | None], ...]
    after: str = ""
    before: str = ""
    is_line_start: bool = False

    @property
    def regex(self) -> str:
        """The regular expression, with a group for each part that has a category."""
        pieces = "".join(f"({piece})" if category else piece for piece, category in self.pieces)
        before = f"(?<={self.before})" if self.before else ""
        return f"{'^' if self.is_line_start else ''}{before}{pieces}{self.after}"

    @property
    def categories(self) -> tuple[Category, ...]:
        """The categories of the groups."""
        return tuple(category for _, category in self.pieces if category)


def any_of(words: Collection[str]) -> str:
    """Return a regular expression for one of several words, the longer ones first."""
    return (
        "(?:" + "|".join(re.escape(word) for word in sorted(words, key=lambda word: (-len(word), word))) + ")"
    )


def _patterns() -> Iterator[Pattern]:
    vocabulary = VOCABULARY
    # A name is followed by a blank and a name only before an operator that is a word.
    operand = rf"(?=[ \t]+(?!{any_of(vocabulary.infix)}\b)[\w\"'(\[{{])"
    no_name = r"(?![ \t]*[=(.])"
    name = r"[A-Za-z_]\w*"
    blanks = r"[ \t]+"
    of_statements = [words for words in vocabulary.phrases if words[0] in vocabulary.statement_starts]
    of_operators = [words for words in vocabulary.phrases if words[0] not in vocabulary.statement_starts]
    yield Pattern(
        (
            (rf"\b{any_of(vocabulary.definitions)}", Category.DEFINITION),
            (blanks, None),
            (name, Category.DEFINED),
        )
    )
    for words, after in (
        (any_of(vocabulary.blocks), r"(?=[ \t]*:)"),
        (any_of(vocabulary.headers), r"\b(?=[ \t].*:[ \t]*(?:#.*)?$)"),
        (any_of(vocabulary.whole_statements), r"(?=[ \t]*(?:$|[#;]))"),
        (_rows(of_statements), rf"\b{no_name}"),
        (any_of(vocabulary.statements), rf"\b{operand}"),
    ):
        yield Pattern(((r"[ \t]*", None), (words, Category.STATEMENT)), after, is_line_start=True)
    yield Pattern(((rf"\b{_rows(of_operators)}", Category.OPERATOR),), r"\b")
    yield Pattern(((rf"\b{any_of(vocabulary.before_operands)}", Category.OPERATOR),), rf"\b{operand}")
    yield Pattern(
        ((any_of(vocabulary.after_operands), Category.OPERATOR),), rf"\b{no_name}", before=r"[\w)\]][ \t]"
    )
    yield Pattern(
        ((r"\bwith", Category.OPERATOR), (blanks, None), (name, Category.PROPERTY)), after=r"(?=[ \t])"
    )
    yield Pattern(
        ((blanks, None), (name, Category.PROPERTY)),
        r"(?=[ \t]*(?:\[[a-z, ]+\])?[ \t]*:[ \t]*[^\s#:=])",
        is_line_start=True,
    )
    for category, single in (
        (Category.CONSTANT, vocabulary.constants),
        (Category.OPERATOR, vocabulary.operator_words),
        (Category.STATEMENT, vocabulary.statement_words | vocabulary.definitions & HARD_KEYWORDS.keys()),
        (Category.VARIABLE, vocabulary.variables),
        (Category.CLASS, vocabulary.classes),
    ):
        yield Pattern(((rf"\b{any_of(single)}", category),), r"\b")
    yield Pattern(((rf"\b{any_of(vocabulary.functions)}", Category.FUNCTION),), r"(?=\()")


def _rows(rows: Iterable[tuple[str, ...]]) -> str:
    return "(?:" + "|".join(r"[ \t]+".join(map(re.escape, words)) for words in rows) + ")"


PATTERNS: Final = tuple(_patterns())
"""In the order in which they are tried; each category belongs to a group."""
