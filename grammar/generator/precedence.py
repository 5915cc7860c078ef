"""Reads the table of precedence of all operators from the rules of the grammar.

A *ladder* is a chain of rules, loosest first, each made of the next one and of operators over it; atoms end it. The
number of a rule in its chain is the level of its operators. What else a rule of the chain can be (its *branches*, such
as the prefix operators) has the level of that rule if it ends in an operand of that level; else it is a level of its
own, directly below. A ladder that runs into another one is numbered so that the levels they share have one number.

A *form* is one way to write one operator: its words, and between them slots for operands with the level that each
accepts. What node it makes, and which slot goes to which field, is read from the action.
"""

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, TypeAlias

from grammar.generator.actions import OPERATORS
from grammar.generator.analysis import Analysis
from grammar.generator.model import (
    Alternative,
    Item,
    Look,
    Named,
    Optional,
    Reference,
    Repeat,
    Token,
    TokenChoice,
)

ROOTS: Final = {"ordinary": "named_expression", "temporal": "temporal_expression"}
"""The loosest rule of each ladder; a later ladder may run into an earlier one."""

SPECIFIER: Final = "specifier"
"""The rule whose alternatives are the specifiers, the other place where words stand between operands."""

OPERATOR_FIELDS: Final = ("op", "ops", "operator", "specifier")
"""The fields of nodes that distinguish operators."""


@dataclass(frozen=True, slots=True)
class Level:
    """One level of a ladder."""

    ladder: str
    number: int


@dataclass(frozen=True, slots=True)
class Slot:
    """The place of an operand. ``also`` are rules of looser operators that it accepts all the same."""

    level: Level
    also: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Content:
    """The place of a part that is not an operand: parameters, arguments, a name."""

    rule: str
    optional: bool


Part: TypeAlias = str | Slot | Content
Target: TypeAlias = tuple[str, int | None]
"""A field of a node, and the index in it if it is a list with a place for each operand."""


@dataclass(frozen=True, slots=True)
class Form:
    """One way to write one operator.

    A text that starts with the words of ``yields_to`` is first tried as something tighter. One of the tokens
    ``followed_by`` has to stand after the form, if there are any. Forms with ``repeats`` go on as in ``a or b or c``.
    ``node`` is the class of node that is made, empty where the value is that of the operand; ``operator`` is what the
    node holds of it; ``targets`` are where the operands go; ``absent`` are indices of operands that are left out.
    """

    rule: str
    level: Level
    parts: tuple[Part, ...]
    repeats: bool = False
    yields_to: tuple[str, ...] = ()
    followed_by: tuple[str, ...] = ()
    node: str | None = None
    operator: str | None = None
    targets: tuple[Target | None, ...] = ()
    absent: tuple[int, ...] = ()

    @property
    def words(self) -> list[str]:
        """The tokens, in order."""
        return [part for part in self.parts if isinstance(part, str)]

    @property
    def slots(self) -> list[Slot]:
        """The places of operands, in order."""
        return [part for part in self.parts if isinstance(part, Slot)]

    @property
    def fixity(self) -> str:
        """The position of the operands: prefix, postfix, infix, ternary or closed."""
        left, right = isinstance(self.parts[0], Slot), isinstance(self.parts[-1], Slot)
        if left and right:
            return "infix" if len(self.slots) == 2 else "ternary"
        return "postfix" if left else "prefix" if right else "closed"

    @property
    def associativity(self) -> str:
        """The associativity among operators of one level: left, right, chained or none."""
        if self.repeats:
            return "chained"
        first, last = self.parts[0], self.parts[-1]
        if isinstance(first, Slot) and first.level.number <= self.level.number:
            return "left"
        if isinstance(last, Slot) and last.level.number <= self.level.number:
            return "right"
        return "none"


@dataclass(frozen=True, slots=True)
class _Operand:
    """In the value of an action: the operand of a slot."""

    slot: int


@dataclass(frozen=True, slots=True)
class _Operator:
    """In the value of an action: a node such as ``ast.Add``."""

    name: str


@dataclass(frozen=True, slots=True)
class _Many:
    """In the value of an action: any number of a value."""

    value: Any


_UNKNOWN: Final = object()
"""In the value of an action: something else."""


@dataclass(frozen=True, slots=True)
class _Expansion:
    """One way through a row of items: the parts so far, and what the variables of the action stand for."""

    parts: tuple[Part, ...]
    variables: Mapping[str, Any]
    repeats: bool = False
    followed_by: tuple[str, ...] = ()

    def add(self, part: Part, value: object, name: str | None) -> "_Expansion":
        return replace(self, parts=(*self.parts, part)).bind(name, value)

    def bind(self, name: str | None, value: object) -> "_Expansion":
        return self if name is None else replace(self, variables={**self.variables, name: value})


class Precedence:
    """The ladders of a grammar by name, their forms in the grammar's order, and the forms of specifiers.

    A ladder's steps are pairs of a rule and its level, loosest first.
    """

    def __init__(self, analysis: Analysis) -> None:
        self.rules = analysis.rules
        self.ladders: dict[str, list[tuple[str, int]]] = {}
        self._levels: dict[str, Level] = {}
        self._atoms: set[str] = set()
        levels = [
            place
            for ladder, root in ROOTS.items()
            if root in self.rules
            for place in self._number(ladder, root)
        ]
        self.forms = [form for rule, level in levels for form in self._forms(rule, level)]
        self.specifiers = list(self._forms(SPECIFIER, Level(SPECIFIER, 0))) if SPECIFIER in self.rules else []

    # Levels.

    def _units(self, rule: str) -> list[str]:
        """The rules that are, alone, an alternative of ``rule``."""
        return [
            alternative.items[0].item.rule
            for alternative in self.rules[rule].alternatives
            if len(alternative.items) == 1
            and isinstance(alternative.items[0].item, Reference)
            and (alternative.action is None or alternative.action.strip() == alternative.items[0].name)
        ]

    def _next(self, rule: str) -> str | None:
        """The next rule of a chain: the one that the rule's own operators are over, else the last one tried."""
        units = self._units(rule)
        starts = {
            alternative.items[0].item.rule
            for alternative in self.rules[rule].alternatives
            if len(alternative.items) > 1 and isinstance(alternative.items[0].item, Reference)
        }
        return next((unit for unit in units if unit in starts), units[-1] if units else None)

    def _chain(self, root: str) -> list[str]:
        """A ladder's rules, from ``root`` to the atoms, or to a rule of an earlier ladder, which is the last then."""
        chain = [root]
        tightest = 0
        while (following := self._next(chain[-1])) is not None and following not in chain:
            chain.append(following)
            if following in self._levels:
                return chain
            alternatives = self.rules[following].alternatives
            if any(each.items[0].item == Reference(following) for each in alternatives):
                tightest = len(chain) - 1
        # Atoms are what the tightest operators are over.
        return chain[: tightest + 2]

    def _number(self, ladder: str, root: str) -> list[tuple[str, Level]]:
        """Give the rules of a ladder their levels; returns the rules with operators, branches included."""
        chain = self._chain(root)
        common_level = self._levels.get(chain[-1])
        # Each rule beside its distance from the ladder's loosest level.
        places: list[tuple[str, int]] = []
        distance = -1
        for index, rule in enumerate(chain if common_level is None else chain[:-1]):
            distance += 1
            places.append((rule, distance))
            is_last = index + 1 == len(chain)
            for branch in self._units(rule):
                if is_last:
                    self._atoms.add(branch)
                elif branch == chain[index + 1]:
                    continue
                elif branch not in self._levels and not self._belongs(branch, rule):
                    distance += 1
                places.append((branch, distance))
        if common_level is None:
            self._atoms.add(chain[-1])
        loosest = 1 if common_level is None else common_level.number - distance - 1
        levels = [(rule, Level(ladder, loosest + distance)) for rule, distance in places]
        numbers: dict[int, str] = {}
        for rule, level in levels:
            self._levels.setdefault(rule, level)
            numbers.setdefault(level.number, rule)
        self.ladders[ladder] = [(rule, number) for number, rule in numbers.items()]
        return levels

    def _belongs(self, branch: str, rule: str) -> bool:
        """Return whether a branch of ``rule`` ends in an operand of ``rule``, or only puts something in brackets."""
        for alternative in self.rules[branch].alternatives:
            items = [named for named in alternative.items if not isinstance(named.item, Look)]
            if items[-1].item == Reference(rule) or alternative.action in {named.name for named in items}:
                return True
        return False

    # Forms.

    def _forms(self, rule: str, level: Level) -> Iterator[Form]:
        yields_to: tuple[str, ...] = ()
        for alternative in self.rules[rule].alternatives:
            yields_to = yields_to or self._exception(alternative)
            for expansion in self._expand_row(alternative.items, _Expansion((), {})):
                form = Form(
                    rule,
                    level,
                    expansion.parts,
                    repeats=expansion.repeats,
                    followed_by=expansion.followed_by,
                )
                if not form.words:
                    continue
                if form.words[0] == "".join(yields_to[:1]) and form.parts[0] == form.words[0]:
                    form = replace(form, yields_to=yields_to)
                form = _with_node(form, self._value(alternative, expansion))
                # Of the atoms, brackets around one operand and what the grammar makes an operator of.
                if rule not in self._atoms or form.node == "" or form.operator is not None:
                    yield form

    def _exception(self, alternative: Alternative) -> tuple[str, ...]:
        """The words of an alternative ``&('not' "visible") a=tighter``: with them, ``tighter`` is tried first."""
        items = [named.item for named in alternative.items]
        match items:
            case [Look(item=Reference() as looked, positive=True), Reference(rule=tighter)] if (
                tighter in self._levels
            ):
                (words,) = self.rules[looked.rule].alternatives
                return tuple(str(named.item.text) for named in words.items if isinstance(named.item, Token))
        return ()

    def _expand_row(self, items: tuple[Named, ...], start: _Expansion) -> list[_Expansion]:
        found = [start]
        for named in items:
            found = [after for before in found for after in self._expand(named.item, named.name, before)]
        return found

    def _expand(self, item: Item, name: str | None, before: _Expansion) -> list[_Expansion]:
        """All ways to continue with an item whose value gets the name ``name``."""
        match item:
            case Token(literal=True):
                return [before.add(item.text, _UNKNOWN, name)]
            case TokenChoice():
                return [before.add(token.text, _UNKNOWN, name) for token in item.tokens]
            case Reference() if (slot := self._slot(item.rule)) is not None:
                index = sum(isinstance(part, Slot) for part in before.parts)
                return [before.add(slot, _Operand(index), name)]
            case Reference() if self._is_clause(item):
                return self._expand_clause(item.rule, name, before)
            case Optional() if self._is_clause(item.item):
                return [*self._expand(item.item, name, before), before.bind(name, None)]
            case Repeat() if self._is_clause(item.item):
                return [
                    replace(each.bind(name, _Many(each.variables.get(name or ""))), repeats=True)
                    for each in self._expand(item.item, name, before)
                ]
            case Look():
                if item.positive and before.parts:
                    return [replace(before, followed_by=self._tokens(item.item))]
                return [before]
            case Token() | Reference() | Optional() | Repeat():
                return [before.add(_content(item), _UNKNOWN, name)]
            case _:
                return [before]

    def _expand_clause(self, rule: str, name: str | None, before: _Expansion) -> list[_Expansion]:
        """The ways through a rule that is written as a part of the rule around it."""
        return [
            replace(each, variables=before.variables).bind(name, self._value(alternative, each))
            for alternative in self.rules[rule].alternatives
            for each in self._expand_row(alternative.items, replace(before, variables={}))
        ]

    def _is_clause(self, item: Item) -> bool:
        """Return whether an item is one or more tokens, then operands: a piece of a form."""
        if isinstance(item, Token):
            return item.literal
        if not isinstance(item, Reference) or item.rule in self._levels:
            return False
        for alternative in self.rules[item.rule].alternatives:
            items = [entry.item for entry in alternative.items if not isinstance(entry.item, Look)]
            if not isinstance(items[0], Token | TokenChoice) or not any(
                isinstance(each, Reference) and self._slot(each.rule) is not None for each in items
            ):
                return False
        return True

    def _slot(self, rule: str) -> Slot | None:
        """The slot that a reference to a rule of a ladder is, or to a choice between such rules."""
        if rule in self._levels:
            return None if rule in self._atoms else Slot(self._levels[rule])
        units = self._units(rule)
        if len(units) < len(self.rules[rule].alternatives) or not all(unit in self._levels for unit in units):
            return None
        tightest = max(units, key=lambda unit: self._levels[unit].number)
        return Slot(self._levels[tightest], tuple(unit for unit in units if unit != tightest))

    def _tokens(self, item: Item) -> tuple[str, ...]:
        """The tokens that a lookahead names."""
        match item:
            case Token():
                return (item.text,)
            case TokenChoice():
                return tuple(token.text for token in item.tokens)
            case Reference():
                alternatives = self.rules[item.rule].alternatives
                return tuple(token for each in alternatives for token in self._tokens(each.items[0].item))
            case _:
                return ()

    # Values of actions.

    def _value(self, alternative: Alternative, expansion: _Expansion) -> Any:
        if alternative.action is not None:
            expression = ast.parse(alternative.action.strip(), mode="eval").body
            return _evaluate(expression, expansion.variables)
        named = [each.name for each in alternative.items if each.name is not None]
        return expansion.variables[named[0]] if len(named) == 1 else _UNKNOWN


def _content(item: Item) -> Content:
    optional = isinstance(item, Optional) or (isinstance(item, Repeat) and not item.at_least_one)
    while not isinstance(item, Token | Reference):
        item = item.item  # type: ignore[union-attr] # what has no item is a token, a reference or no content
    return Content(item.text if isinstance(item, Token) else item.rule, optional)


def _evaluate(node: ast.expr, variables: Mapping[str, Any]) -> Any:
    """Evaluate an action as far as possible: operands stay symbols, nodes become pairs of a name and fields."""
    match node:
        case ast.Name(id=name) if name in variables:
            return variables[name]
        case ast.Name(id=name) if name in OPERATORS:
            return _Operator(OPERATORS[name])
        case ast.Constant(value=value):
            return value
        case ast.Tuple(elts=elements) | ast.List(elts=elements):
            return [_evaluate(each, variables) for each in elements]
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            sides = [_evaluate(left, variables), _evaluate(right, variables)]
            return [each for side in sides for each in (side if isinstance(side, list) else [side])]
        case ast.BoolOp(op=ast.And(), values=[*_, last]):
            return _evaluate(last, variables)
        case ast.ListComp(elt=element, generators=[ast.comprehension(target=ast.Name(id=name), iter=source)]):
            values = _evaluate(source, variables)
            if isinstance(values, _Many):
                return _Many(_evaluate(element, {**variables, name: values.value}))
        case ast.Subscript(value=value, slice=ast.Constant(value=int(index))):
            values = _evaluate(value, variables)
            if isinstance(values, list):
                return values[index]
        case ast.Call(func=ast.Name(id=name), args=[]) if name[:1].isupper():
            fields = {each.arg: _evaluate(each.value, variables) for each in node.keywords}
            return (name, fields)
    return _UNKNOWN


def _with_node(form: Form, value: object) -> Form:
    """A form with its action's facts about the node that it makes."""
    if isinstance(value, _Operand):
        return replace(form, node="", targets=(None,))
    if not isinstance(value, tuple):
        return form
    name, fields = value
    operator: str | None = None
    targets: list[Target | None] = [None] * len(form.slots)
    absent: list[int] = []
    for field, content in fields.items():
        content = content.value if isinstance(content, _Many) else content
        if field in OPERATOR_FIELDS and isinstance(content, str | _Operator):
            operator = content if isinstance(content, str) else content.name
        elif isinstance(content, _Operand):
            targets[content.slot] = (field, None)
        elif isinstance(content, list):
            many = any(isinstance(each, _Many) for each in content)
            for index, each in enumerate(content):
                each = each.value if isinstance(each, _Many) else each
                if isinstance(each, _Operand):
                    targets[each.slot] = (field, None if many else index)
                elif each is None:
                    absent.append(index)
    return replace(form, node=name, operator=operator, targets=tuple(targets), absent=tuple(absent))
