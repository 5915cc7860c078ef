"""What a word of a program means: keywords, operators, specifiers, properties and the names in scope."""

import ast
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse
from scenic.compiler.tokens import NAME, Tokens
from scenic.ide import documentation
from scenic.language.operators import OPERATORS
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

__all__ = ["Hover", "hover"]

_PLACES_OF_SOFT_KEYWORDS: Final = (
    scenic.ScenicStatement,
    scenic.Duration,
    scenic.Interrupt,
    ast.Match,
)
"""Nodes whose words, where they have no node of their own, are keywords and not names."""


@dataclass(frozen=True, slots=True)
class Hover:
    """An explanation in Markdown, and the word that it is about."""

    markdown: str
    span: Span


def hover(text: str, line: int, column: int) -> Hover | None:
    """Explain the word at a place: ``line`` from 1, ``column`` in characters from 0.

    ``None`` where there is nothing to explain: in strings and comments, on names that the program defines.
    """
    source = Source(text, "")
    tokens = lex(text, WORDS)
    index = _token_at(tokens, source, line, column)
    if index is None:
        return None
    node = _innermost(parse(text, filename="").tree, line, tokens.columns[index])
    markdown = _explain(tokens.texts[index], tokens.kinds[index], node)
    if markdown is None:
        return None
    start, end = tokens.columns[index], tokens.end_columns[index]
    return Hover(markdown, Span(line, source.character(line, start), line, source.character(line, end)))


def _token_at(tokens: Tokens, source: Source, line: int, column: int) -> int | None:
    """The word or operator at a place; between two of them the one on the right."""
    if not 1 <= line <= len(source.lines) or column > len(source.line(line)):
        return None
    place = (line, source.byte(line, column))
    starts = list(zip(tokens.lines, tokens.columns, strict=True))
    index = bisect_right(starts, place) - 1
    while index >= 0 and not tokens.texts[index]:
        index -= 1
    for candidate in (index, index - 1):
        if candidate >= 0 and tokens.lines[candidate] == line == tokens.end_lines[candidate]:
            touches = tokens.columns[candidate] <= place[1] <= tokens.end_columns[candidate]
            if touches and tokens.texts[candidate] in WORDS:
                return candidate
            if touches and tokens.kinds[candidate] >= NAME:
                return candidate
    return None


def _innermost(tree: ast.AST, line: int, column: int) -> ast.AST:
    """The smallest node around a place; found without recursion, since trees may be deep."""
    node = tree
    while True:
        inner = next((child for child in _placed_children(node) if _holds(child, line, column)), None)
        if inner is None:
            return node
        node = inner


def _placed_children(node: ast.AST) -> Iterator[ast.AST]:
    """The children of a node that have places; for those that have none, their children."""
    stack = list(ast.iter_child_nodes(node))
    while stack:
        child = stack.pop()
        if getattr(child, "end_lineno", None) is None:
            stack.extend(ast.iter_child_nodes(child))
        else:
            yield child


def _holds(node: ast.AST, line: int, column: int) -> bool:
    start = (getattr(node, "lineno", 0), getattr(node, "col_offset", 0))
    end = (getattr(node, "end_lineno", 0), getattr(node, "end_col_offset", 0))
    # A word is explained from its first character up to the one after it.
    return start <= (line, column) < end


def _explain(word: str, kind: int, node: ast.AST) -> str | None:
    """What ``word`` means in ``node``, which is the smallest node around it."""
    if isinstance(node, ast.Name):
        return documentation.of_name(word)
    if isinstance(node, ast.Attribute):
        return documentation.of_property(word)
    if isinstance(node, scenic.Specifier):
        if word == node.property:
            return documentation.of_property(word)
        declared = SPECIFIERS.get(node.specifier)
        return None if declared is None else documentation.of_specifier(declared)
    if isinstance(node, scenic.Operation):
        operator = OPERATORS.get(node.operator)
        return None if operator is None else documentation.of_operator(operator)
    if isinstance(node, scenic.Temporal):
        return documentation.of_temporal(node.operator) or documentation.of_keyword(word)
    if isinstance(node, scenic.PropertyDef) and word == node.name:
        return documentation.of_property(word)
    statement = STATEMENTS.get(type(node).__name__)
    if kind == NAME:
        # A name that is no word of the language, in a place that has no node: a parameter, a definition.
        return documentation.of_name(word) if isinstance(node, scenic.ErrorStatement) else None
    if statement is not None and word in " ".join(statement.forms).replace(":", " ").split():
        return documentation.of_statement(statement)
    if kind < NAME or isinstance(node, _PLACES_OF_SOFT_KEYWORDS):
        return documentation.of_keyword(word)
    return None
