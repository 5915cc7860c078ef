"""The table of precedence of all operators, as the generator reads it from the grammar.

There are two ladders of levels, loosest first: ``"ordinary"`` for expressions (levels 1 to 19), ``"temporal"`` for
the conditions of ``require`` (levels -1 to 5, then the ordinary ones from 6, comparisons, on; an `Slot.ladder` says
where one changes over). Numbers of both ladders can be compared as long as a slot's ladder is respected: where an
operand of the ordinary ladder is wanted, no operator of the temporal one can stand, parentheses or not.

A `Form` is one way to write one operator. Its parts are words, slots for operands, and places for contents that are
no operands (arguments, parameters, names, lists of specifiers). An operand fits into a slot without parentheses if
`Slot.accepts` its form. That alone does not make a text right: what ends in an operand looser than itself (a prefix
operator of the temporal ladder, the last specifier of ``new``) takes in what follows it.
"""

import ast
from collections.abc import Iterator, Mapping
from enum import StrEnum
from functools import cached_property
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from scenic.compiler import generated
from scenic.dataclass import dataclass

__all__ = [
    "ATOM",
    "FORMS",
    "LADDERS",
    "SPECIFIERS",
    "Associativity",
    "Content",
    "Fixity",
    "Form",
    "Ladder",
    "Part",
    "Slot",
    "Target",
    "Word",
    "form_of",
    "forms_of",
]


class Ladder(StrEnum):
    """The group of forms that a form belongs to: expressions, conditions of ``require``, specifiers of ``new``
    and ``override``.
    """

    ORDINARY = "ordinary"
    TEMPORAL = "temporal"
    SPECIFIER = "specifier"


class Fixity(StrEnum):
    """The position of the operands of a form; ``TERNARY`` has operands at both ends and one inside."""

    PREFIX = "prefix"
    POSTFIX = "postfix"
    INFIX = "infix"
    TERNARY = "ternary"
    CLOSED = "closed"


class Associativity(StrEnum):
    """The end operand that may be of the form's own level.

    ``CHAINED`` forms of one level make one node with all their operands, as in ``a < b <= c`` and ``a or b or c``.
    """

    LEFT = "left"
    RIGHT = "right"
    NONE = "none"
    CHAINED = "chained"


@dataclass(frozen=True, slots=True)
class Word:
    """A token of a form."""

    text: str


@dataclass(frozen=True, slots=True)
class Target:
    """The destination of an operand: a field of the node, and the index in it if the field is a list of fixed length."""

    field: str
    index: int | None


@dataclass(frozen=True, slots=True)
class Slot:
    """The place of an operand: one of ``level`` or a tighter one, or of one of the rules ``also``."""

    ladder: Ladder
    level: int
    also: tuple[str, ...]
    target: Target | None

    def accepts(self, form: "Form") -> bool:
        """Return whether an operand of this form fits without parentheses."""
        if form.rule in self.also:
            return True
        if form.ladder is self.ladder:
            return form.level >= self.level
        # Below its own levels the temporal ladder is the ordinary one.
        return (
            self.ladder is Ladder.TEMPORAL
            and form.ladder is Ladder.ORDINARY
            and form.level > max(LADDERS[Ladder.TEMPORAL].values())
        )


@dataclass(frozen=True, slots=True)
class Content:
    """A part that is not an operand, by the name of its rule in the grammar, or of a kind of token."""

    rule: str
    optional: bool


Part: TypeAlias = Word | Slot | Content


@dataclass(frozen=True)
class Form:
    """One way to write one operator.

    ``rule`` is the rule of the grammar that it is an alternative of. A text that starts with the words ``yields_to``
    is first tried as something tighter (``not visible x``). One of the tokens ``followed_by`` has to stand after the
    form, if there are any. ``node`` is the class of node that it makes, empty for parentheses, whose value is that of
    the operand; ``operator`` is the node's operator: a class of `ast` such as ``"Add"``, or a name declared in
    `scenic.language.operators` or `scenic.language.specifiers`. ``absent`` are the indices of operands left out.
    """

    rule: str
    ladder: Ladder
    level: int
    parts: tuple[Part, ...]
    fixity: Fixity
    associativity: Associativity
    yields_to: tuple[str, ...]
    followed_by: tuple[str, ...]
    node: str | None
    operator: str | None
    absent: tuple[int, ...]

    @cached_property
    def text(self) -> str:
        """The form with ``_`` for operands and contents: ``distance from _ to _``."""
        return " ".join(part.text if isinstance(part, Word) else "_" for part in self.parts)

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The tokens, in order."""
        return tuple(part.text for part in self.parts if isinstance(part, Word))

    @cached_property
    def slots(self) -> tuple[Slot, ...]:
        """The places of operands, in order."""
        return tuple(part for part in self.parts if isinstance(part, Slot))


def _form(row: tuple[Any, ...]) -> Form:
    (
        rule,
        ladder,
        level,
        parts,
        fixity,
        associativity,
        yields_to,
        followed_by,
        node,
        operator,
        targets,
        absent,
    ) = row
    return Form(
        rule,
        Ladder(ladder),
        level,
        tuple(_parts(parts, iter(targets))),
        Fixity(fixity),
        Associativity(associativity),
        yields_to,
        followed_by,
        node,
        operator,
        absent,
    )


def _parts(
    rows: tuple[tuple[Any, ...], ...], targets: Iterator[tuple[str, int | None] | None]
) -> Iterator[Part]:
    for kind, *values in rows:
        if kind == "word":
            yield Word(*values)
        elif kind == "content":
            yield Content(*values)
        else:
            ladder, level, also = values
            target = next(targets, None)
            yield Slot(Ladder(ladder), level, also, None if target is None else Target(*target))


LADDERS: Final[Mapping[Ladder, Mapping[str, int]]] = MappingProxyType(
    {Ladder(ladder): MappingProxyType(dict(steps)) for ladder, steps in generated.LADDERS.items()}
)
"""The rules of each ladder's own levels, loosest first, with their numbers."""

ATOM: Final = max(LADDERS[Ladder.ORDINARY].values())
"""The tightest level: names, literals, displays, everything in parentheses."""

FORMS: Final[tuple[Form, ...]] = tuple(_form(row) for row in generated.FORMS)
"""All forms of operators, ladder by ladder, loosest first, and within a level in the order in which they are tried."""

SPECIFIERS: Final[tuple[Form, ...]] = tuple(_form(row) for row in generated.SPECIFIER_FORMS)
"""All forms of specifiers; every operand is a whole expression."""


def _by_operator() -> Mapping[tuple[str, str | None], tuple[Form, ...]]:
    found: dict[tuple[str, str | None], tuple[Form, ...]] = {}
    for form in FORMS + SPECIFIERS:
        if form.node:
            key = (form.node, form.operator)
            found[key] = (*found.get(key, ()), form)
    return MappingProxyType(found)


_BY_OPERATOR: Final = _by_operator()


def forms_of(node: str, operator: str | None, ladder: Ladder = Ladder.ORDINARY) -> tuple[Form, ...]:
    """Return the forms in a ladder that make a class of nodes with an operator, in the order in which they are tried.

    In the temporal ladder these are its own forms if it has any, else the ordinary ones.
    """
    forms = _BY_OPERATOR.get((node, operator), ())
    own = tuple(form for form in forms if form.ladder is ladder)
    if not own and ladder is Ladder.TEMPORAL:
        return tuple(form for form in forms if form.ladder is Ladder.ORDINARY)
    return own


def form_of(node: ast.AST, ladder: Ladder = Ladder.ORDINARY) -> Form | None:
    """Return the form in which a node is written; ``None`` for atoms, and for nodes that ``ladder`` has no form for.

    If there are several (``distance from a to b``, ``distance to b from a``), the one that is tried first. A
    comparison is judged by its first operator, a call by whether it has arguments; of ``Slice``, ``Starred``,
    ``yield`` and displays the table knows nothing.
    """
    fields: Any = node
    operator: object = None
    for name in ("op", "operator", "specifier"):
        operator = getattr(node, name, operator)
    if isinstance(node, ast.Compare):
        operator = node.ops[0]
    if isinstance(operator, ast.AST):
        operator = type(operator).__name__
    name = type(node).__name__
    forms = forms_of(name, operator if isinstance(operator, str) else None, ladder)
    if not forms and name == "SpecifierPhrase":
        forms = forms_of(name, fields.specifier, Ladder.SPECIFIER)
    if isinstance(node, ast.Call):
        has_arguments = bool(node.args or node.keywords)
        forms = tuple(
            form for form in forms if has_arguments == any(isinstance(part, Content) for part in form.parts)
        )
    absent = tuple(index for index, each in enumerate(getattr(node, "operands", ())) if each is None)
    return next((form for form in forms if form.absent == absent), None)
