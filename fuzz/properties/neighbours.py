"""A mistake leaves the statements around it as they are."""

import ast
import random
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, Final

from fuzz.properties.case import Case, Property, Violation, describe, is_syntax_error
from fuzz.properties.differences import difference
from fuzz.properties.formatting import on_lines
from scenic.compiler import tree as scenic
from scenic.compiler.parser import parse

__all__ = ["OF_TEXTS"]

_WRONG: Final = ("x = = 1", "x = 1 +", "x y", "new", "require", "class", "take 1,", "while", "return 1 2")
"""Lines that are wrong wherever a statement can stand, and say nothing of a block."""


def mistakes_leave_the_rest_alone(case: Case) -> None:
    """With a wrong line put between its statements, a program has one mistake, and its statements are what they were.

    The program is written with each logical line on one line for that, so that no line in brackets looks like a statement.
    """
    if case.has_error:
        return
    text = on_lines(case.source.text)
    tree = parse(text).tree
    where = difference(case.result.tree, tree)
    if where is not None:
        raise Violation(f"another tree on one line each: {where}\n{text}")
    places = list(_places(tree))
    if not places:
        return
    draw = random.Random(case.number)
    line, column = draw.choice(places)
    lines = text.split("\n")
    lines.insert(line - 1, " " * column + draw.choice(_WRONG))
    wrong_text = "\n".join(lines)
    result = parse(wrong_text)
    mistakes = [each for each in result.diagnostics if is_syntax_error(each)]
    if [each.span.line if each.span else 0 for each in mistakes] != [line]:
        descriptions = "; ".join(map(describe, mistakes)) or "nothing"
        raise Violation(f"not one error in line {line}, but {descriptions}\n{wrong_text}")
    for node in ast.walk(result.tree):
        for name, block in ast.iter_fields(node):
            if isinstance(block, list) and any(_is_gap(each, line) for each in block):
                setattr(node, name, [each for each in block if not _is_gap(each, line)])
    where = difference(tree, result.tree)
    if where is not None:
        raise Violation(f"another tree beside a wrong line {line}: {where}\n{wrong_text}")


def _places(tree: ast.Module) -> Iterator[tuple[int, int]]:
    """Line and column of each statement that begins a line, not the first of its block; guards have to stand together."""
    for node in ast.walk(tree):
        for _, block in ast.iter_fields(node):
            if isinstance(block, list):
                for before, each in pairwise(block):
                    if not isinstance(each, ast.stmt) or isinstance(each, scenic.Guard):
                        continue
                    if each.lineno > (before.end_lineno or 0):
                        decorators = getattr(each, "decorator_list", None)
                        yield decorators[0].lineno if decorators else each.lineno, each.col_offset


def _is_gap(node: Any, line: int) -> bool:
    return isinstance(node, scenic.ErrorStatement) and node.lineno == line and not node.body


OF_TEXTS: Final = (Property.of(mistakes_leave_the_rest_alone, one_in=3),)
