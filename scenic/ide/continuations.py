"""The words that the grammar allows at a place, each with the form that it begins: what completion offers of the language.

Which words may stand at a place, the parser says (`scenic.compiler.probing`); what they mean, the declarations. So what is
added to the grammar and declared is offered without further ado.
"""

from collections.abc import Iterator, Mapping
from enum import StrEnum
from types import MappingProxyType
from typing import Final

from scenic.compiler.forms import DeclaredForm, declared_forms
from scenic.compiler.precedence import ATOM, FORMS, Ladder, Slot
from scenic.compiler.precedence import SPECIFIERS as SPECIFIER_FORMS
from scenic.compiler.probing import Wanted, wanted_at
from scenic.compiler.syntax import STATEMENT_FORMS, words_of
from scenic.dataclass import dataclass
from scenic.ide import documentation
from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

__all__ = ["Continuation", "Continuations", "PhraseKind", "continuations", "prepare"]


class PhraseKind(StrEnum):
    """The kinds of phrases that a word begins."""

    SPECIFIER = "specifier"
    OPERATOR = "operator"
    TEMPORAL = "temporal operator"
    STATEMENT = "statement"
    KEYWORD = "keyword"


@dataclass(frozen=True, slots=True)
class _Phrase:
    """A declared form: ``start`` are its first words, ``rest`` what follows them; of infix forms without the left operand."""

    kind: PhraseKind
    name: str
    start: tuple[str, ...]
    rest: str
    form: str
    operands: tuple[str, ...]
    is_infix: bool = False
    level: int = ATOM


@dataclass(frozen=True, slots=True)
class Continuation:
    """Something that may be written at a place.

    ``text`` is the rest of the form from here on, operands by their names (``"toward target"``), ``words`` is the part of
    it that is written as it stands, ``operands`` are the places to fill in. ``form`` is the whole form as it is declared.
    ``name`` is that of the declaration: of `SPECIFIERS`, `OPERATORS`, `TEMPORAL_OPERATORS` or `STATEMENTS` by ``kind``, or
    the keyword itself.
    """

    kind: PhraseKind
    name: str
    text: str
    words: str
    operands: tuple[str, ...]
    form: str

    @property
    def markdown(self) -> str | None:
        """The documentation of the phrase, in Markdown."""
        match self.kind:
            case PhraseKind.SPECIFIER:
                return documentation.of_specifier(SPECIFIERS[self.name])
            case PhraseKind.OPERATOR:
                return documentation.of_operator(OPERATORS[self.name])
            case PhraseKind.TEMPORAL:
                return documentation.of_temporal(self.name)
            case PhraseKind.STATEMENT:
                return documentation.of_statement(STATEMENTS[self.name])
            case PhraseKind.KEYWORD:
                return documentation.of_keyword(self.name)


@dataclass(frozen=True, slots=True)
class Continuations:
    """The possible continuations at a place: ``items`` of the language, and by ``labels`` and ``kinds`` other things.

    Labels are those of the grammar's rules: ``"an expression"``, ``"a condition"``, ``"an argument"``, ``"a pattern"``,
    ``"a name"`` (after ``new``, of a class), ``"the name of a module"``; kinds those of tokens: ``"NAME"`` where a new name or
    an attribute stands. ``before`` are the tokens of the line before the place.
    """

    items: tuple[Continuation, ...]
    labels: frozenset[str]
    kinds: frozenset[str]
    before: tuple[str, ...]


_OPERANDS: Final = ("an expression", "a condition", "an argument", "a subscript", "an item")
_NOWHERE: Final = Continuations((), frozenset(), frozenset(), ())


def continuations(text: str, line: int, column: int) -> Continuations:
    """Return the possible continuations at ``line`` (from 1) and ``column`` (in characters from 0); a word begun there is not looked at.

    Nothing in strings and comments, and after a mistake in the same statement. Runs nothing of the program.
    """
    here = text.split("\n")[line - 1][:column]
    while column > 0 and (here[column - 1].isalnum() or here[column - 1] == "_"):
        column -= 1
    expectation = wanted_at(text, line, column)
    if expectation is None:
        return _NOWHERE
    phrases = dict.fromkeys(_find(expectation))
    return Continuations(tuple(phrases), expectation.labels, expectation.kinds, expectation.before)


def prepare() -> None:
    """Load and make what `continuations` needs for any text."""
    continuations("x = ", 1, 4)


def _find(wanted: Wanted) -> Iterator[Continuation]:
    words_begun: set[str] = set()
    after = _LOOSEST_AFTER.get(wanted.before[-1]) if wanted.before else None
    for phrase in _PHRASES:
        if after is not None and after > phrase.level and not phrase.is_infix:
            continue
        for count, word in enumerate(phrase.start):
            if count == 0:
                fits = word in _beginning(wanted, phrase)
            else:
                fits = word in wanted.words and wanted.before[-count:] == phrase.start[:count]
            if fits:
                words_begun.add(word)
                yield _continuation(phrase, count)
    others = set(wanted.words).union(*(wanted.begins(label) for label in wanted.labels)) - words_begun
    for word in sorted(others):
        if word.isidentifier() and word != "_":
            yield Continuation(PhraseKind.KEYWORD, word, word, word, (), word)


def _beginning(wanted: Wanted, phrase: _Phrase) -> frozenset[str]:
    """Return the words with which a phrase of this kind may begin here."""
    match phrase.kind:
        case PhraseKind.SPECIFIER:
            return wanted.begins("a specifier")
        case PhraseKind.STATEMENT:
            first = wanted.words if not wanted.before or wanted.before[-1] in (":", ";") else frozenset()
            return first.union(*(wanted.begins(label) for label in wanted.labels if label not in _OPERANDS))
    if phrase.is_infix:
        return wanted.words
    return frozenset().union(*(wanted.begins(label) for label in _OPERANDS), _directly(wanted, phrase))


def _directly(wanted: Wanted, phrase: _Phrase) -> frozenset[str]:
    """Return the words that can stand alone in a condition, as those of the temporal ladder do."""
    return wanted.words if phrase.kind is PhraseKind.TEMPORAL else frozenset()


def _continuation(phrase: _Phrase, count: int) -> Continuation:
    words = " ".join(phrase.start[count:])
    text = f"{words}{'' if phrase.rest[:1] in (':', '[') else ' '}{phrase.rest}".strip()
    return Continuation(phrase.kind, phrase.name, text, words, phrase.operands, phrase.form)


_KINDS: Final = {
    "SpecifierPhrase": PhraseKind.SPECIFIER,
    "Operation": PhraseKind.OPERATOR,
    "Temporal": PhraseKind.TEMPORAL,
}


def _phrases() -> Iterator[_Phrase]:
    for declared in declared_forms():
        yield _phrase(_KINDS[declared.node], declared)
    for name, statement in STATEMENTS.items():
        for form in statement.forms:
            yield from _statement(name, form)


def _phrase(kind: PhraseKind, declared: DeclaredForm) -> _Phrase:
    words, is_word = declared.words, declared.is_word
    first = 0 if is_word[0] else 1
    count = next((index for index in range(first, len(words)) if not is_word[index]), len(words))
    return _Phrase(
        kind,
        declared.name,
        words[first:count],
        " ".join(words[count:]),
        declared.text,
        tuple(words[index] for index in range(count, len(words)) if not is_word[index]),
        is_infix=first > 0,
        level=declared.form.level if kind is PhraseKind.OPERATOR else ATOM,
    )


def _statement(name: str, text: str) -> Iterator[_Phrase]:
    words = text.replace(":", " :", 1).replace("[", " [", 1).split()
    rows = [
        form.row
        for form in STATEMENT_FORMS
        if form.node == name or (form.node is None and form.start == words[0])
    ]
    words_of_rows = frozenset(word for row in rows for word in words_of(row))
    count = next((index for index, word in enumerate(words) if word not in words_of_rows), len(words))
    if count:
        rest = text.partition(" ".join(words[:count]))[2].strip()
        yield _Phrase(PhraseKind.STATEMENT, name, tuple(words[:count]), rest, text, ())


_WRITTEN: Final = (*SPECIFIER_FORMS, *FORMS)


def _loosest_after() -> Mapping[str, int]:
    found: dict[str, int] = {}
    for form in _WRITTEN:
        last = form.parts[-1]
        if form.ladder is not Ladder.TEMPORAL and isinstance(last, Slot):
            word = form.words[-1]
            found[word] = min(found.get(word, ATOM), last.level)
    return MappingProxyType(found)


_LOOSEST_AFTER: Final = _loosest_after()
"""By the word before it, how loose an operand may be there that is an operator itself."""

_PHRASES: Final = tuple(_phrases())
"""All declared forms, in the order of the declarations."""
