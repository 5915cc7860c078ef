"""The meaning of an expression at a place of a document, though it does not stand there as a whole yet."""

import ast
from collections.abc import Sequence
from dataclasses import replace

from scenic.compiler.parser import parse
from scenic.compiler.scopes import Reference
from scenic.compiler.semantics.model import Model
from scenic.ide.snapshot import Snapshot
from scenic.project.index import Project

__all__ = ["expression", "operand_before"]

_OPENERS = {")": "(", "]": "[", "}": "{"}


def operand_before(tokens: Sequence[str]) -> str:
    """The text of the names, attributes and calls that a sequence of tokens ends with."""
    index = len(tokens)
    while index > 0:
        token = tokens[index - 1]
        if token in _OPENERS:
            depth = 0
            while index > 0:
                index -= 1
                depth += (tokens[index] in _OPENERS) - (tokens[index] in _OPENERS.values())
                if not depth:
                    break
            if index > 0 and (tokens[index - 1].isidentifier() or tokens[index - 1] in _OPENERS):
                continue
            break
        if not token.isidentifier():
            break
        index -= 1
        if index == 0 or tokens[index - 1] != ".":
            break
        index -= 1
    return " ".join(tokens[index:])


def expression(
    project: Project, snapshot: Snapshot, text: str, line: int, column: int
) -> tuple[Model, ast.expr] | None:
    """An expression with its names bound as at a place, and a model for questions about it."""
    module = project.module(snapshot.filename)
    result = parse(text)
    if module is None or result.diagnostics or len(result.tree.body) != 1:
        return None
    statement = result.tree.body[0]
    if not isinstance(statement, ast.Expr):
        return None
    scope = snapshot.scope_at(line, column)
    references: dict[ast.AST, Reference] = {
        node: Reference(node, scope, scope.lookup(node.id))
        for node in ast.walk(statement)
        if isinstance(node, ast.Name)
    }
    resolution = module.resolution
    mentions = dict(resolution.mentions)
    for each in references.values():
        mentions[each.node.id] = [*mentions.get(each.node.id, ()), each]
    resolution = replace(resolution, references={**resolution.references, **references}, mentions=mentions)
    return Model(replace(module, resolution=resolution), project), statement.value
