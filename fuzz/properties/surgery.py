"""Trees that no text has: the checks and the resolution of names must stand them, too."""

import ast
import random
from typing import Any, Final

from fuzz.properties.case import FILENAME, Case, Property
from fuzz.properties.signatures import SIGNATURES
from scenic.compiler import tree as scenic
from scenic.compiler.checks import CheckContext, lint
from scenic.compiler.resolver import resolve
from scenic.compiler.semantics.modules import Module
from scenic.language.source import Source

__all__ = ["OF_TEXTS", "operate"]

_ATTEMPTS: Final = 3

_SHRINKING: Final = frozenset(
    {
        ("Call", "args"),
        ("Call", "keywords"),
        ("New", "specifiers"),
        ("Override", "specifiers"),
        ("ClassDef", "bases"),
        ("ClassDef", "keywords"),
        ("ClassDef", "decorator_list"),
        ("FunctionDef", "decorator_list"),
        ("Tuple", "elts"),
        ("List", "elts"),
        ("JoinedStr", "values"),
        ("Param", "items"),
        ("Match", "cases"),
        ("Mutate", "targets"),
        ("Do", "targets"),
        ("Take", "actions"),
        ("Import", "names"),
        ("Global", "names"),
        ("Try", "handlers"),
        ("TryInterrupt", "interrupts"),
        ("BehaviorDef", "guards"),
        ("ScenarioDef", "guards"),
        ("PropertyDef", "attributes"),
        ("arguments", "defaults"),
    }
)
"""Lists of other things than statements that may lose elements without the node becoming nonsense."""


def checks_never_raise(case: Case) -> None:
    """Neither the resolution of names nor the checks raise, on trees from which parts are missing or have been exchanged."""
    source = Source(case.text, FILENAME)
    for attempt in range(_ATTEMPTS):
        tree = case.fresh_tree()
        operate(tree, random.Random(case.number + attempt))
        lint(CheckContext(Module(source, tree, resolve(tree, source), is_scenic=True, broken=False)))


def operate(tree: ast.Module, draw: random.Random) -> None:
    """Change a tree in up to four places; every field still has a value of its declared type."""
    for _ in range(draw.randint(1, 4)):
        nodes = list(ast.walk(tree))
        operation = draw.choice(
            (_lose_statement, _empty_block, _put_gap, _lose_part, _lose_part, _exchange, _exchange)
        )
        operation(nodes, draw)


def _blocks(nodes: list[ast.AST]) -> list[list[Any]]:
    """The lists of statements."""
    return [
        value
        for node in nodes
        for field in SIGNATURES[type(node)]
        if ast.stmt in field.types and isinstance(value := getattr(node, field.name), list) and value
    ]


def _lose_statement(nodes: list[ast.AST], draw: random.Random) -> None:
    blocks = _blocks(nodes)
    if blocks:
        block = draw.choice(blocks)
        del block[draw.randrange(len(block))]


def _empty_block(nodes: list[ast.AST], draw: random.Random) -> None:
    blocks = _blocks(nodes)
    if blocks:
        draw.choice(blocks).clear()


def _put_gap(nodes: list[ast.AST], draw: random.Random) -> None:
    """An error node instead of a statement, which may still contain the statement, or its inner statements."""
    blocks = _blocks(nodes)
    if not blocks:
        return
    block = draw.choice(blocks)
    index = draw.randrange(len(block))
    node = block[index]
    body = draw.choice(([], [node], getattr(node, "body", [])))
    gap = scenic.ErrorStatement()
    gap.body = body
    block[index] = ast.copy_location(gap, node)


def _lose_part(nodes: list[ast.AST], draw: random.Random) -> None:
    """Something optional is absent, or a list is shorter."""
    places: list[tuple[Any, str, int | None]] = []
    for node in nodes:
        for field in SIGNATURES[type(node)]:
            value = getattr(node, field.name)
            if field.kind == "optional" and value is not None and not isinstance(node, ast.Constant):
                places.append((node, field.name, None))
            elif field.kind != "one" and value and (type(node).__name__, field.name) in _SHRINKING:
                places.append((node, field.name, draw.randrange(len(value))))
    if places:
        node, name, index = draw.choice(places)
        if index is None:
            setattr(node, name, None)
        else:
            del getattr(node, name)[index]


def _exchange(nodes: list[ast.AST], draw: random.Random) -> None:
    """One expression replaces another that is read, or two statements are exchanged."""
    if draw.random() < 0.3:
        blocks = _blocks(nodes)
        if len(blocks) > 1:
            left, right = draw.sample(blocks, 2)
            here, there = draw.randrange(len(left)), draw.randrange(len(right))
            if not _holds(left[here], right[there]) and not _holds(right[there], left[here]):
                left[here], right[there] = right[there], left[here]
        return
    places = [
        (node, field.name, index)
        for node in nodes
        for field in SIGNATURES[type(node)]
        if field.types == (ast.expr,)
        for index, value in _values(getattr(node, field.name))
        if value is not None
        and isinstance(getattr(value, "ctx", ast.Load()), ast.Load)
        # The literal keys and values of patterns are literals only.
        and not isinstance(
            node, ast.MatchValue | ast.MatchMapping | ast.MatchClass | ast.FormattedValue | ast.JoinedStr
        )
    ]
    if not places:
        return
    node, name, index = draw.choice(places)
    donor, donor_name, donor_index = draw.choice(places)
    value, replacement = _get(node, name, index), _get(donor, donor_name, donor_index)
    if (
        _holds(replacement, value)
        or any(part is node for part in ast.walk(replacement))
        or isinstance(replacement, ast.Starred)
    ):
        replacement = ast.copy_location(ast.Constant(value=draw.choice((None, 0, 1.5, "x", True))), value)
    _set(node, name, index, replacement)


def _values(value: Any) -> list[tuple[int | None, Any]]:
    return list(enumerate(value)) if isinstance(value, list) else [(None, value)]


def _get(node: ast.AST, name: str, index: int | None) -> Any:
    value = getattr(node, name)
    return value if index is None else value[index]


def _set(node: ast.AST, name: str, index: int | None, value: Any) -> None:
    if index is None:
        setattr(node, name, value)
    else:
        getattr(node, name)[index] = value


def _holds(node: ast.AST, part: ast.AST) -> bool:
    return any(each is part for each in ast.walk(node))


OF_TEXTS: Final = (Property.of(checks_never_raise, one_in=4),)
