r"""The places in which operands are written: the table of precedence, prepared for quick look-up.

A place is described by four values, which the writers of expressions hand on from node to node:

- ``level``: an operand of a looser level needs parentheses;
- ``after``: the token that follows the operand, as far as it matters: a word or an operator, ``"\n"`` at the end of a
  statement, ``")"`` where nothing can be taken in, and after a comma the node that comes next;
- ``closer``: the next closing word (`from`, `to`, `of`, `by`, `for`) that follows outside of brackets, or nothing: an
  operator that could use the word must not be open to it;
- ``lead``: the flags below, which say how the parser reads the first words of the operand.
"""

import ast
from collections.abc import Mapping
from itertools import chain
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from scenic.compiler.generated import SOFT_KEYWORDS
from scenic.compiler.precedence import FORMS, LADDERS, SPECIFIERS, Form, Ladder, Slot, Word, forms_of
from scenic.compiler.syntax import STATEMENT_FORMS, ListOf, Optional, Reference, first_words
from scenic.dataclass import dataclass

After: TypeAlias = str | ast.AST

PREFIX: Final = 1
"""The prefix operators are tried here; set for every place of their level or a looser one."""
NEGATED: Final = 2
"""The word before is `not`."""
IDENTITY: Final = 512
"""The word before is `is`."""
CONDITION: Final = 4
"""The prefix operators of the temporal ladder are tried here."""
TEMPORAL: Final = 8
"""The operand belongs to the temporal ladder."""
ALSO: Final = 16
"""A prefix operator of the temporal ladder can stand here whatever its level."""
STATEMENT: Final = 32
"""The operand begins a statement that is an expression."""
REQUIRE: Final = 64
RECORD: Final = 128
DO: Final = 256
"""The word before is the statement's."""

FIRST: Final = ~(TEMPORAL | ALSO)
"""Mask of the flags that the first operand of an ordinary operator takes from the operator's own place."""
FIRST_OF_CONDITION: Final = ~ALSO
"""Mask of the flags that the first operand of an operator of the temporal ladder takes from its place."""

_ORDINARY: Final = LADDERS[Ladder.ORDINARY]
YIELD: Final = _ORDINARY["named_expression"] - 1
"""The level of `yield`, which can stand alone in a statement and nowhere else without parentheses."""
NAMED: Final = _ORDINARY["named_expression"]
EXPRESSION: Final = _ORDINARY["expression"]
DISJUNCTION: Final = _ORDINARY["disjunction"]
CONJUNCTION: Final = _ORDINARY["conjunction"]
INVERSION: Final = _ORDINARY["inversion"]
COMPARISON: Final = _ORDINARY["comparison"]
BITOR: Final = _ORDINARY["bitor"]
SUM: Final = _ORDINARY["sum"]
FACTOR: Final = _ORDINARY["factor"]
NEW: Final = _ORDINARY["new_expression"]
PRIMARY: Final = _ORDINARY["primary"]
LOOSEST_CONDITION: Final = LADDERS[Ladder.TEMPORAL]["temporal_expression"]


def level_of(rule: str) -> int | None:
    """The level of a rule of the grammar, if that is a step of the ladder of ordinary expressions."""
    return _ORDINARY.get(rule)


@dataclass(frozen=True, slots=True)
class Operand:
    """The place of one operand of a form; ``None`` stands for what the place of the whole has.

    ``index`` is that in the node's ``operands``; ``text`` is what is written after the operand.
    """

    index: int
    level: int
    after: str | None
    closer: str | None
    lead: int | None
    text: str


@dataclass(frozen=True, slots=True)
class Plan:
    """A plan by which to write a form: ``head``, then each operand and its text.

    ``absorbs`` are the words that would be taken for a part of the form if they followed it. ``is_open`` says whether
    it ends with an operand. ``clashes`` are the flags of places where the word before would take its first word for a
    part of itself, or become a part of it.
    """

    level: int
    is_temporal: bool
    head: str
    operands: tuple[Operand, ...]
    absorbs: frozenset[str]
    is_open: bool
    clashes: int


def lead_of(slot: Slot) -> int:
    """The flags of an operand that is not the first part of its form."""
    lead = PREFIX if slot.level <= _ORDINARY["prefix"] else 0
    if slot.ladder is Ladder.TEMPORAL:
        lead |= CONDITION | TEMPORAL | (ALSO if slot.also else 0)
    return lead


def _first_words(form: Form, start: int) -> str:
    """The words from part ``start`` on by which a form is known: `not visible` is not `not in`."""
    words = [part.text for part in form.parts[start : start + 2] if isinstance(part, Word)]
    return " ".join(words[:2]) if words[0] == "not" else words[0]


def _begins_like(longer: Form, form: Form) -> bool:
    return len(longer.parts) > len(form.parts) and all(
        ours == theirs if isinstance(ours, Word) else type(ours) is type(theirs)
        for ours, theirs in zip(form.parts, longer.parts, strict=False)
    )


def _absorbed(form: Form) -> frozenset[str]:
    """The words that would follow the form in a longer one, and the operators that its last operand would take in."""
    words = set()
    for longer in chain(FORMS, SPECIFIERS):
        if longer.ladder is form.ladder and _begins_like(longer, form):
            part = longer.parts[len(form.parts)]
            if isinstance(part, Word):
                words.add(part.text)
    last = form.parts[-1]
    if form.ladder is Ladder.TEMPORAL and isinstance(last, Slot):
        words.update(
            _first_words(other, 1)
            for other in FORMS
            if other.ladder is form.ladder and isinstance(other.parts[0], Slot) and other.level >= last.level
        )
    return frozenset(words)


def _plan(form: Form) -> Plan:
    parts = form.parts
    head = ""
    operands: list[Operand] = []
    for place, part in enumerate(parts):
        if isinstance(part, Slot):
            following = parts[place + 1] if place + 1 < len(parts) else None
            after = closer = None
            if isinstance(following, Word):
                after = _first_words(form, place + 1)
                closer = None if place == 0 else after
            index = part.target.index if part.target else None
            lead = lead_of(part) if place else None
            operands.append(Operand(index or 0, part.level, after, closer, lead, ""))
        elif not operands:
            head += f"{part.text} " if isinstance(part, Word) else "%s "
        else:
            last = operands[-1]
            text = f"{last.text} {part.text if isinstance(part, Word) else '%s'}"
            operands[-1] = Operand(last.index, last.level, last.after, last.closer, last.lead, text)
    operands = [
        Operand(each.index, each.level, each.after, each.closer, each.lead, f"{each.text} ")
        if each.text and each is not operands[-1]
        else each
        for each in operands
    ]
    first = parts[0]
    return Plan(
        form.level,
        form.ladder is Ladder.TEMPORAL,
        head if operands else head.rstrip(),
        tuple(operands),
        _absorbed(form),
        isinstance(parts[-1], Slot),
        _clashes(first.text) if isinstance(first, Word) else 0,
    )


_NEGATABLE: Final = frozenset(form.yields_to[1] for form in FORMS if len(form.yields_to) == 2)


def _clashes(first: str) -> int:
    """See `Plan.clashes`; ``first`` is the first word."""
    if first in _NEGATABLE:
        return NEGATED
    return IDENTITY if first == "not" else 0


def _plans(node: str, forms: tuple[Form, ...]) -> Mapping[tuple[str, tuple[int, ...]], Plan]:
    found: dict[tuple[str, tuple[int, ...]], Plan] = {}
    for form in forms:
        if form.node == node and form.operator is not None:
            found.setdefault((form.operator, form.absent), _plan(form))
    return MappingProxyType(found)


OPERATIONS: Final = _plans("Operation", FORMS)
"""Plans by which to write Scenic's operators, by name and operands left out."""
CONDITIONS: Final = _plans("Temporal", FORMS)
SPECIFIER_PLANS: Final = _plans("SpecifierPhrase", SPECIFIERS)


@dataclass(frozen=True, slots=True)
class Binary:
    """A plan by which to write an operator of Python's with two operands."""

    level: int
    left: int
    right: int
    lead: int
    symbol: str
    text: str


def _binary(operator: str) -> Binary | None:
    forms = forms_of("BinOp", operator)
    if not forms:
        return None
    left, right = forms[0].slots
    symbol = forms[0].words[0]
    return Binary(forms[0].level, left.level, right.level, lead_of(right), symbol, f" {symbol} ")


def _classes(base: type[ast.AST]) -> list[type[ast.AST]]:
    return [each for each in vars(ast).values() if isinstance(each, type) and each.__base__ is base]


BINARY: Final[Mapping[type[ast.AST], Binary]] = MappingProxyType(
    {each: plan for each in _classes(ast.operator) if (plan := _binary(each.__name__)) is not None}
)
UNARY: Final[Mapping[type[ast.AST], str]] = MappingProxyType(
    {each: forms_of("UnaryOp", each.__name__)[0].words[0] for each in _classes(ast.unaryop)}
)
COMPARED: Final[Mapping[type[ast.AST], tuple[str, str]]] = MappingProxyType(
    {
        each: (_first_words(form, 1), " ".join(form.words))
        for each in _classes(ast.cmpop)
        for form in forms_of("Compare", each.__name__)
    }
)
"""The operators of comparisons: as what they follow an operand, and whole."""

INFIX: Final = frozenset(
    _first_words(form, 1)
    for form in FORMS
    if form.ladder is Ladder.ORDINARY and isinstance(form.parts[0], Slot)
)
"""Words that can continue an open operand of the loosest level."""

SPECIFIER_STARTS: Final = frozenset(_first_words(form, 0) for form in SPECIFIERS)

OPERAND_STARTS: Final = frozenset(
    {"(", "[", "{", "-", "+", "not visible", "seconds", "steps", "every", "after"}
) | {
    word
    for word in chain(INFIX, *(form.words for form in FORMS if form.ladder is Ladder.TEMPORAL))
    if word in SOFT_KEYWORDS
}
"""Words that can follow an operand and can also begin one: soft keywords are names there."""


def _second_words() -> Mapping[str, frozenset[str]]:
    found: dict[str, frozenset[str]] = {}
    for form in FORMS:
        first = form.parts[0]
        if form.ladder is Ladder.ORDINARY and isinstance(first, Word) and first.text in SOFT_KEYWORDS:
            second = form.parts[1]
            words = {second.text} if isinstance(second, Word) else set()
            if not isinstance(second, Word) and len(form.slots) == 1:
                words |= OPERAND_STARTS
            found[first.text] = found.get(first.text, frozenset()) | words
    return MappingProxyType(found)


_SECOND_WORDS: Final = _second_words()
"""Words that must not follow a name that is the first word of a prefix operator, by that first word."""

_LATE_WORDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        form.words[0]: form.words[1]
        for form in FORMS
        if form.ladder is Ladder.ORDINARY
        and form.words[0] in SOFT_KEYWORDS
        and isinstance(form.parts[0], Word)
        and isinstance(form.parts[1], Slot)
        and len(form.slots) > 1
    }
)
"""`follow`, and the word that closes its first operand."""
_WITH_LATE_WORDS: Final = frozenset(
    _first_words(form, 1)
    for form in FORMS
    if isinstance(form.parts[0], Slot) and not frozenset(_LATE_WORDS.values()).isdisjoint(form.words)
)
"""The operators that have such a word themselves: in `follow visible from x` the name `visible` would be the operand."""

_TEMPORAL_WORDS: Final = frozenset(
    form.words[0]
    for form in FORMS
    if form.ladder is Ladder.TEMPORAL and isinstance(form.parts[0], Word) and form.node == "Temporal"
)
_SOFT_FORMS: Final = [form for form in STATEMENT_FORMS if form.is_soft and not form.has_block]
_WHOLE_STATEMENTS: Final = frozenset(
    form.start for form in _SOFT_FORMS if all(isinstance(item, Optional) for item in form.row[1:])
)


def _second_of(start: str) -> frozenset[str]:
    """The soft keywords that may follow the word ``start`` of statements, before an operand."""
    return frozenset(
        word
        for form in STATEMENT_FORMS
        if form.start == start and len(form.row) > 2
        for word in first_words(form.row[1:2]) & SOFT_KEYWORDS.keys()
        if not isinstance(form.row[1], Reference | ListOf)
    )


_BEFORE_OPERANDS: Final[Mapping[int, frozenset[str]]] = MappingProxyType(
    {
        STATEMENT: frozenset(
            form.start for form in _SOFT_FORMS if form.row[1:] and isinstance(form.row[1], Reference | ListOf)
        )
        - {"param"},
        REQUIRE: _second_of("require"),
        RECORD: _second_of("record"),
        DO: _second_of("do"),
        CONDITION: _TEMPORAL_WORDS,
    }
)
"""Words that are not names if an operand follows, by place."""

WATCHED: Final = frozenset(chain(_SECOND_WORDS, _WHOLE_STATEMENTS, *_BEFORE_OPERANDS.values()))
"""The names that are not names everywhere."""


def is_keyword(name: str, after: After, closer: str, lead: int) -> bool:
    """Return whether the parser would take a name for something else in this place."""
    if after in ("left", "right") and name in ("front", "back", "top", "bottom"):
        return True
    if lead & PREFIX:
        if after in _SECOND_WORDS.get(name, ()):
            return True
        late = _LATE_WORDS.get(name)
        if late is not None and after in OPERAND_STARTS and (closer == late or after in _WITH_LATE_WORDS):
            return True
    if lead & STATEMENT and after == "\n" and name in _WHOLE_STATEMENTS:
        return True
    return after in OPERAND_STARTS and any(
        lead & place and name in words for place, words in _BEFORE_OPERANDS.items()
    )


def first_word(node: Any) -> str:
    """The word that the text of a list's element begins with; of `not visible` both."""
    while True:
        kind = type(node)
        if kind is ast.Name:
            return str(node.id)
        if kind is ast.UnaryOp and type(node.op) is ast.Not:
            return f"not {first_word(node.operand)}"
        field = _FIRST_FIELDS.get(kind)
        if field is not None:
            node = getattr(node, field)
        elif hasattr(node, "operands"):
            absent = tuple(index for index, each in enumerate(node.operands) if each is None)
            plan = OPERATIONS.get((getattr(node, "operator", ""), absent))
            if plan is None:
                return ""
            if plan.head:
                words = plan.head.split()
                return " ".join(words[:2]) if words[0] == "not" else words[0]
            node = node.operands[0]
        elif kind is ast.BoolOp:
            node = node.values[0]
        else:
            return str(getattr(node, "arg", None) or getattr(node, "name", None) or "")


_FIRST_FIELDS: Final[Mapping[type[ast.AST], str]] = MappingProxyType(
    {
        ast.Attribute: "value",
        ast.BinOp: "left",
        ast.Call: "func",
        ast.Compare: "left",
        ast.IfExp: "body",
        ast.NamedExpr: "target",
        ast.Slice: "lower",
        ast.Subscript: "value",
        ast.withitem: "context_expr",
    }
)


def absorbs_comma(after: After) -> bool:
    """Return whether a list of specifiers would continue after a comma with the node that follows it."""
    if not isinstance(after, ast.AST):
        return False
    return hasattr(after, "specifier") or first_word(after) in SPECIFIER_STARTS
