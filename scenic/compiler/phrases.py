"""The words of which operators, specifiers and statements of Scenic are made, by the part they have in them.

What messages and scans of tokens must know of single words, read from the forms that the grammar has.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.compiler.generated import SOFT_KEYWORDS
from scenic.compiler.precedence import FORMS, SPECIFIERS, Ladder, Slot
from scenic.compiler.precedence import Word as Written
from scenic.compiler.syntax import RULES, Word
from scenic.language.operators import SIDES

__all__ = [
    "BEFORE_CONNECTORS",
    "CLOSING_WORDS",
    "CONNECTORS",
    "PREFIX_STARTS",
    "SCENIC_FORMS",
    "TEMPORAL_FORMS",
    "words_before",
]

_OF_SCENIC: Final = frozenset({"Operation", "SpecifierPhrase", "Temporal"})

SCENIC_FORMS: Final = tuple(form for form in (*FORMS, *SPECIFIERS) if form.node in _OF_SCENIC)
"""The forms of the operators and specifiers that Scenic adds."""

TEMPORAL_FORMS: Final = tuple(form for form in FORMS if form.node == "Temporal")
"""The forms of the temporal operators."""

PREFIX_STARTS: Final = frozenset(
    (form.parts[0].text, form.parts[1].text)
    for form in FORMS
    if form.ladder is Ladder.ORDINARY
    and len(form.parts) > 1
    and isinstance(form.parts[0], Written)
    and isinstance(form.parts[1], Written)
    and form.parts[0].text in SOFT_KEYWORDS
)
"""The first two words of prefix operators whose first one is a name where no such operator can stand."""


_INFIX_STARTS: Final = frozenset(form.words[0] for form in SCENIC_FORMS if isinstance(form.parts[0], Slot))
_SIDES: Final = frozenset(word for side in SIDES for word in side.split())

CONNECTORS: Final = tuple(
    sorted(
        frozenset(word for form in SCENIC_FORMS for word in form.words[1:]) - _INFIX_STARTS - _SIDES,
        key=lambda word: (len(word), word),
    )
)
"""The words in the middle of operators and specifiers, of which one may be forgotten; the small ones first."""

BEFORE_CONNECTORS: Final = frozenset(
    word for form in SCENIC_FORMS for word in form.words[:-1] if word in SOFT_KEYWORDS
)
"""The words of operators and specifiers that a connector follows further on."""


def _closing_words() -> Mapping[tuple[str, str], str]:
    closers: dict[tuple[str, str], str] = {}
    for form in FORMS:
        match form.parts:
            case (*start, Slot(), Written(text=closer), Slot()) if (
                form.node == "Operation" and len(start) > 1
            ):
                words = [part.text for part in start if isinstance(part, Written)]
                if len(words) == len(start):
                    closers[words[-2], words[-1]] = closer
    return MappingProxyType(closers)


CLOSING_WORDS: Final = _closing_words()
"""By the last two words before the first operand of a prefix operator: the word that may end this operand."""


def words_before(word: str) -> frozenset[str]:
    """Return the words that stand directly before ``word`` in some form, and so make one operator or statement with it."""
    pairs = [
        (left.text, right.text)
        for form in (*FORMS, *SPECIFIERS)
        for left, right in zip(form.parts, form.parts[1:], strict=False)
        if isinstance(left, Written) and isinstance(right, Written)
    ]
    pairs += [
        (left.text, right.text)
        for rule in RULES.values()
        for alternative in rule.alternatives
        for left, right in zip(alternative.row, alternative.row[1:], strict=False)
        if isinstance(left, Word) and isinstance(right, Word)
    ]
    return frozenset(left for left, right in pairs if right == word and left.isidentifier())
