"""Parses thousands of one-line programs at once, and shows trees in a form that knows no class of nodes."""

import ast
import gc
from collections.abc import Callable, Iterable, Sequence

from scenic.compiler.actions import Actions
from scenic.compiler.generated import WORDS, build_parser
from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse
from scenic.compiler.shared_words import closed_operands
from scenic.compiler.tokens import NEWLINE


def parse_lines(lines: Sequence[str], *, shared_words: bool = True) -> list[ast.stmt | None]:
    """The statements that are the lines; ``None`` for lines that are wrong. Positions are those in the whole.

    Without ``shared_words`` no operator leaves a closing word to another one (`scenic.compiler.shared_words`).
    """
    gc.disable()
    try:
        return _parse_lines(lines, shared_words)
    finally:
        gc.enable()


def _parse_lines(lines: Sequence[str], shared_words: bool) -> list[ast.stmt | None]:
    tokens = lex("\n".join(lines) + "\n", WORDS)
    assert not tokens.diagnostics
    actions = Actions(tokens)
    run: Callable[[str, int], tuple[ast.stmt | None, int]] = build_parser(*tokens.lists(), actions)
    found: list[ast.stmt | None] = []
    start = 0
    for line in lines:
        end = tokens.kinds.index(NEWLINE, start) + 1
        node, reached = run("statement", start)
        if node is None or reached != end:
            node = _alone(line, len(found)) if shared_words else None
        found.append(node)
        start = end
    for problem in actions.problems.values():
        found[problem.place[0] - 1] = None
    return found


def _alone(line: str, index: int) -> ast.stmt | None:
    """The statement of a line that the fast parser alone does not understand."""
    if not closed_operands(lex(line, WORDS)):
        return None
    result = parse(line)
    if result.diagnostics:
        return None
    return ast.increment_lineno(result.tree.body[0], index)


def same(left: object, right: object) -> bool:
    """Whether two trees are equal apart from places."""
    if isinstance(left, ast.AST):
        return type(left) is type(right) and all(
            same(getattr(left, name, None), getattr(right, name, None)) for name in left._fields
        )
    if isinstance(left, list):
        return (
            isinstance(right, list)
            and len(left) == len(right)
            and all(same(one, other) for one, other in zip(left, right, strict=True))
        )
    return type(left) is type(right) and left == right


def bracketed(line: str, nodes: Iterable[tuple[int, int]]) -> str:
    """A line, words apart by blanks, with parentheses around the texts from ``start`` to ``end``."""
    opening = [0] * (len(line) + 1)
    closing = [0] * (len(line) + 1)
    for start, end in nodes:
        opening[start] += 1
        closing[end] += 1
    text = "".join(
        ")" * closing[index] + "(" * opening[index] + line[index : index + 1]
        for index in range(len(line) + 1)
    )
    return " ".join(text.replace("(", " ( ").replace(")", " ) ").split())


def reading_of(line: str, node: ast.expr) -> str:
    """An expression that stands alone in its line after some words, with parentheses around every operation."""
    first = node.col_offset
    places = [
        (each.col_offset - first, (each.end_col_offset or 0) - first)
        for each in ast.walk(node)
        if isinstance(each, ast.expr) and not isinstance(each, ast.Name | ast.Constant)
    ]
    return bracketed(line[first : node.end_col_offset], places)
