"""Expressions that read as a tuple or an operator, and can only be meant as a specifier of a new object."""

import ast
from collections.abc import Iterator, Sequence
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext
from scenic.compiler.checks.misplaced_specifiers import continuation_after
from scenic.compiler.traversal import position
from scenic.language.diagnostics import Diagnostic, Edit, Fix
from scenic.language.spans import Span

__all__ = ["check_meant_specifiers"]


_PLACES: Final = frozenset({"at", "in", "on"})
_DIRECTIONS: Final = frozenset({"is ahead of", "is behind", "is left of", "is right of"})


def check_meant_specifiers(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC111, SC113 and SC311 for a specifier without `new`, without a comma before it, or missing after one."""
    for cls in (ast.Assign, ast.Expr):
        for node, _ in context.nodes(cls):
            if isinstance(node.value, ast.Tuple):
                targets = node.targets if cls is ast.Assign else ()
                yield from _dangling_comma(node.value, targets, context)
    for node, _ in context.nodes(scenic.Operation):
        yield from _missing_new(node, context)
    for node, _ in context.nodes(scenic.SpecifierPhrase):
        yield from _missing_comma(node, context)


def _dangling_comma(
    value: ast.Tuple, targets: Sequence[ast.expr], context: CheckContext
) -> Iterator[Diagnostic]:
    """Report mistakes such as ``ego = new Object with width 3,``."""
    if not (len(value.elts) == 1 and isinstance(value.elts[0], scenic.New)):
        return
    (first,) = value.elts
    if position(value) != position(first):
        return  # in parentheses
    end = context.source.span(first)
    comma = context.source.line(end.end_line).find(",", end.end_column)
    if comma < 0:
        return
    place = Span(end.end_line, comma, end.end_line, comma + 1)
    line = continuation_after(context.source, end.end_line)
    # `with (x): ...` is a statement of its own.
    if line is not None and not any(node.lineno == line for node, _ in context.nodes(ast.With)):
        if not any(node.lineno == line for node, _ in context.nodes(scenic.ErrorStatement)):
            yield _not_indented(line, context)
        return
    # Nobody wants such a tuple, but the ego alone must not be one.
    say = context.error if any(context.provided(each) == "ego" for each in targets) else context.warning
    yield say(
        "SC311",
        "no specifier follows this comma, which makes a tuple of the object",
        place,
        "remove the comma, or write more specifiers after it",
        fix=Fix("Remove the comma", (Edit(place, ""),)),
    )


def _not_indented(line: int, context: CheckContext) -> Diagnostic:
    """Return SC102 for ``facing (3, 4)`` on a line of its own, which reads as a statement."""
    text = context.source.line(line)
    column = len(text) - len(text.lstrip())
    return context.error(
        "SC102",
        "this line goes on with specifiers of the line before, and is not indented",
        Span(line, column, line, len(text.rstrip())),
        "indent it by four spaces",
        fix=Fix("Indent the line", (Edit(Span(line, column, line, column), "    "),)),
    )


def _missing_new(node: scenic.Operation, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``Chair left of table``."""
    if node.operator not in _DIRECTIONS:
        return
    left = node.operands[0]
    if not isinstance(left, ast.Name) or context.properties(left) is None:
        return
    words = node.operator.removeprefix("is ")
    start = context.source.span(left)
    place = Span(start.line, start.column, start.line, start.column)
    yield context.error(
        "SC111",
        f"`{left.id}` is followed by a specifier, but `new` is missing",
        left,
        f"write `new {left.id} {words} ...`",
        fix=Fix("Insert `new`", (Edit(place, "new "),)),
    )


def _missing_comma(node: scenic.SpecifierPhrase, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``new Chair at x left of table``: no specifier takes the answer of such a question but ``with``."""
    operand = node.operands[-1] if node.operands else None
    if node.specifier in _PLACES and operand is not None:
        yield from _second_place(node, operand, context)
    if not isinstance(operand, scenic.Operation) or operand.operator not in _DIRECTIONS:
        return
    left = operand.operands[0]
    if left is None or (node.specifier == "with" and not isinstance(left, ast.Constant)):
        return
    start, end = context.source.span(operand), context.source.span(left)
    if context.source.line(start.line)[: start.column].rstrip().endswith("("):
        return  # in parentheses: a wrong operand, but no missing comma
    words = operand.operator.removeprefix("is ")
    word = words.split()[0]
    column = context.source.line(end.end_line).find(word, end.end_column)
    if column < 0:
        return
    gap = Span(end.end_line, end.end_column, end.end_line, end.end_column)
    yield context.error(
        "SC113",
        f"a comma is missing before the specifier `{words}`",
        Span(end.end_line, column, end.end_line, column + len(word)),
        f"write `{context.text(left) or '...'}, {words} ...`",
        fix=Fix("Insert a comma", (Edit(gap, ","),)),
    )


def _second_place(
    node: scenic.SpecifierPhrase, operand: ast.expr, context: CheckContext
) -> Iterator[Diagnostic]:
    """Report SC301 for ``new Object at (0, 0) at (1, 1)``, ``new Object at x in y``, which read as operators."""
    match operand:
        case scenic.Operation(operator="at", operands=[ast.expr() as left, _]):
            word = "at"
        case ast.Compare(left=left, ops=[ast.In()]):
            word = "in"
        case _:
            return
    start, end = context.source.span(operand), context.source.span(left)
    kind = context.kind_of(left)
    if kind is None or kind.name in ("vector field", "function"):
        return
    if context.source.line(start.line)[: start.column].rstrip().endswith("("):
        return
    column = context.source.line(end.end_line).find(word, end.end_column)
    if column < 0:
        return
    yield context.error(
        "SC301",
        f"`{node.specifier}` and `{word}` both give the position of this object, and no comma stands between them",
        Span(end.end_line, column, end.end_line, column + len(word)),
        "keep one of both",
    )
