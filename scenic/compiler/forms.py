"""The declared forms of specifiers and operators, each with the grammar's facts about its words.

A declaration writes operands by their names (``facing toward target``); which of the words are operands, only the grammar
knows.
"""

from collections.abc import Iterator, Sequence

from scenic.compiler.precedence import FORMS, SPECIFIERS, Form, Word
from scenic.dataclass import dataclass
from scenic.language import operators, specifiers
from scenic.language.keywords import TEMPORAL_OPERATORS

__all__ = ["DeclaredForm", "declared_forms"]


@dataclass(frozen=True, slots=True)
class DeclaredForm:
    """A form of a declaration, which ``node`` and ``name`` identify.

    ``words`` are all of its words, and ``is_word`` tells of each whether it is written as it stands, and names no operand.
    """

    node: str
    name: str
    text: str
    words: tuple[str, ...]
    is_word: tuple[bool, ...]
    form: Form


def declared_forms() -> Iterator[DeclaredForm]:
    """Return all forms in the order of the declarations: specifiers, operators, temporal operators."""
    for node, forms in (
        ("SpecifierPhrase", {name: each.forms for name, each in specifiers.SPECIFIERS.items()}),
        ("Operation", {name: each.forms for name, each in operators.OPERATORS.items()}),
        ("Temporal", {name: each.forms for name, each in TEMPORAL_OPERATORS.items()}),
    ):
        for name, texts in forms.items():
            declaration = [
                each for each in (*SPECIFIERS, *FORMS) if (each.node, each.operator) == (node, name)
            ]
            for text in texts:
                words = tuple(text.split())
                form = next(each for each in declaration if _agrees(words, each))
                is_word = tuple(isinstance(part, Word) for part in form.parts)
                yield DeclaredForm(node, name, text, words, is_word, form)


def _agrees(words: Sequence[str], form: Form) -> bool:
    return len(words) == len(form.parts) and all(
        not isinstance(part, Word) or part.text == word for word, part in zip(words, form.parts, strict=True)
    )
