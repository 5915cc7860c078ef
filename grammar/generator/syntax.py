"""Emits the grammar itself as data: what editors, highlighters, diagrams and messages derive from it.

Lookaheads and cuts are left out, and groups stand where they are used. Of each action only the class of the node that it
makes is kept, with its fields if they are plain values of items and constants. `scenic.compiler.syntax` says what the rows mean.
"""

import ast
from collections.abc import Iterator
from typing import TypeAlias

from grammar.generator.actions import node_classes
from grammar.generator.analysis import Analysis
from grammar.generator.model import (
    Alternative,
    Gather,
    Grammar,
    Item,
    Optional,
    Reference,
    Repeat,
    Rule,
    Token,
    TokenChoice,
)

__all__ = ["Row", "emit_syntax", "nodes_made", "rows_of"]

Row: TypeAlias = tuple[object, ...]


def emit_syntax(analysis: Analysis, header: str) -> str:
    """Write the text of the module ``syntax``."""
    grammar = analysis.grammar
    lines = [
        header.rstrip(),
        "",
        "from types import MappingProxyType",
        "",
        "RULES = MappingProxyType(",
        "    {",
    ]
    for rule in grammar.rules.values():
        if not rule.lifted:
            alternatives = tuple(
                (tuple(_row(grammar, each)), _node(each), _fields(grammar, each))
                for each in rule.alternatives
                if each.items
            )
            lines.append(f"        {rule.name!r}: ({rule.label!r}, {alternatives!r}),")
    lines += [
        "    }",
        ")",
        '"""The label of each rule and its alternatives, with the nodes that they make."""',
        "",
    ]
    lines += [f"START = {grammar.start!r}", ""]
    return "\n".join(lines)


def rows_of(grammar: Grammar, rule: Rule) -> Iterator[tuple[Row, ...]]:
    """Yield the alternatives of a rule as rows of items."""
    return (tuple(_row(grammar, each)) for each in rule.alternatives if each.items)


def nodes_made(alternative: Alternative) -> Iterator[str]:
    """Yield the classes of nodes that the action of an alternative names, the outermost first."""
    if alternative.action is not None:
        known = node_classes()
        for node in ast.walk(ast.parse(alternative.action.strip(), mode="eval")):
            if isinstance(node, ast.Name) and node.id in known:
                yield node.id


def _node(alternative: Alternative) -> str | None:
    return next(nodes_made(alternative), None)


def _fields(grammar: Grammar, alternative: Alternative) -> tuple[tuple[str, str, object], ...] | None:
    """The fields of the node, each from an item of the row (by its index) or a constant; ``None`` if an action computes more."""
    if alternative.action is None:
        return None
    call = ast.parse(alternative.action.strip(), mode="eval").body
    if isinstance(call, ast.BoolOp) and isinstance(call.op, ast.And):
        # Before the node stand conditions, which refuse texts.
        call = call.values[-1]
    if not (
        isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in node_classes()
    ):
        return None
    places, index = {}, 0
    for entry in alternative.items:
        count = len(tuple(_item(grammar, entry.item)))
        if entry.name is not None and count == 1:
            places[entry.name] = index
        index += count
    fields: list[tuple[str, str, object]] = []
    for keyword in call.keywords:
        match keyword:
            case ast.keyword(arg=str(field), value=ast.Name(id=name)) if name in places:
                fields.append((field, "item", places[name]))
            case ast.keyword(arg=str(field), value=ast.Constant(value=value)):
                fields.append((field, "constant", value))
            case ast.keyword(arg=str(field), value=ast.List(elts=[])):
                fields.append((field, "constant", ()))
            case _:
                return None
    return tuple(fields)


def _row(grammar: Grammar, alternative: Alternative) -> Iterator[Row]:
    for named in alternative.items:
        yield from _item(grammar, named.item)


def _item(grammar: Grammar, item: Item) -> Iterator[Row]:
    match item:
        case Token():
            yield ("word", item.text) if item.literal else ("kind", item.text)
        case TokenChoice():
            yield ("choice", tuple(tuple(_item(grammar, token)) for token in item.tokens))
        case Reference():
            rule = grammar.rules[item.rule]
            if not rule.lifted:
                yield ("rule", item.rule)
            elif len(rule.alternatives) == 1:
                yield from _row(grammar, rule.alternatives[0])
            else:
                yield ("choice", tuple(tuple(_row(grammar, each)) for each in rule.alternatives))
        case Optional():
            yield ("optional", tuple(_item(grammar, item.item)))
        case Repeat():
            row = tuple(_item(grammar, item.item))
            yield ("many", row) if item.at_least_one else ("optional", (("many", row),))
        case Gather():
            yield ("list", tuple(_item(grammar, item.item)), tuple(_item(grammar, item.separator)))
        case _:
            pass
