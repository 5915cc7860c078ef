"""Operands in other places than those they were written in: the writer of trees must put parentheses where they are needed."""

import ast
import copy
import random
from collections.abc import Iterator, Sequence
from typing import Any, Final, TypeAlias

from fuzz.properties.case import Case, Property, Violation, describe
from fuzz.properties.differences import difference
from fuzz.properties.forms import operators_follow_the_table
from scenic.compiler import tree as scenic
from scenic.compiler.parser import parse
from scenic.compiler.unparser import unparse
from scenic.language.diagnostics import Severity

__all__ = ["OF_FORMULAS", "OF_TEXTS"]

_OPERATORS: Final = (
    ast.BinOp,
    ast.UnaryOp,
    ast.BoolOp,
    ast.Compare,
    ast.IfExp,
    ast.Await,
    scenic.Operation,
    scenic.Temporal,
)
_MOST: Final = 3
_ATTEMPTS: Final = 4

_Place: TypeAlias = tuple[Any, str, int | None]


def operands_can_be_exchanged(case: Case) -> None:
    """Operators can have any operands: such a tree is written so that it is read as it was, with no more parentheses than needed."""
    if case.has_error:
        return
    tree = case.fresh_tree()
    _exchange(tree, (_places(tree), _places_in_conditions(tree)), random.Random(case.number))


def conditions_can_be_exchanged(case: Case) -> None:
    """The same of the conditions of `require` alone, with more exchanges."""
    if case.has_error:
        return
    draw = random.Random(case.number)
    for _ in range(_ATTEMPTS):
        tree = case.fresh_tree()
        _exchange(tree, (_places_in_conditions(tree),), draw)


def _exchange(tree: ast.Module, kinds: Sequence[Sequence[_Place]], draw: random.Random) -> None:
    """Put operands in the places of others of their kind, and see whether the tree is still written as it should be."""
    kinds = [places for places in kinds if len(places) > 1]
    if not kinds:
        return
    for places in kinds:
        for _ in range(draw.randint(1, _MOST)):
            node, name, index = draw.choice(places)
            donors = [place for place in places if isinstance(_get(*place), _OPERATORS)]
            given = copy.deepcopy(_get(*draw.choice(donors if donors and draw.random() < 0.7 else places)))
            if index is None:
                setattr(node, name, given)
            else:
                getattr(node, name)[index] = given
    written = unparse(tree)
    again = parse(written)
    for diagnostic in again.diagnostics:
        if diagnostic.severity is Severity.ERROR:
            raise Violation(f"what was written is refused: {describe(diagnostic)}\n{written}")
    where = difference(tree, again.tree)
    if where is not None:
        raise Violation(f"another tree: {where}\n{written}")
    operators_follow_the_table(Case(written))


def _places(tree: ast.AST) -> list[_Place]:
    """The operands of a tree, outside of conditions and patterns, where not every operator can stand."""
    found: list[_Place] = []
    stack: list[ast.AST] = [tree]
    while stack:
        node = stack.pop()
        if isinstance(node, scenic.Require | ast.pattern):
            continue
        stack.extend(ast.iter_child_nodes(node))
        if not isinstance(node, _OPERATORS):
            continue
        found.extend(_operands(node))
    return found


def _operands(node: ast.AST) -> Iterator[_Place]:
    for name in node._fields:
        value = getattr(node, name)
        if isinstance(value, ast.expr):
            yield node, name, None
        elif isinstance(value, list):
            yield from ((node, name, index) for index, each in enumerate(value) if isinstance(each, ast.expr))


def _places_in_conditions(tree: ast.AST) -> list[_Place]:
    """Conditions, and the operands of their operators, all of which may be conditions."""
    requirements = [node for node in ast.walk(tree) if isinstance(node, scenic.Require)]
    found: list[_Place] = [(node, "condition", None) for node in requirements]
    stack = [node.condition for node in requirements]
    while stack:
        node = stack.pop()
        if isinstance(node, scenic.Temporal | ast.BoolOp) or (
            isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
        ):
            found.extend(_operands(node))
            stack.extend(_get(*operand) for operand in _operands(node))
    return found


def _get(node: Any, name: str, index: int | None) -> Any:
    value = getattr(node, name)
    return value if index is None else value[index]


OF_TEXTS: Final = (Property.of(operands_can_be_exchanged, one_in=3),)
OF_FORMULAS: Final = (Property.of(conditions_can_be_exchanged),)
