"""Places of the names of definitions: the tree records the places of whole statements only."""

import ast
from typing import Any

from scenic.compiler.semantics.symbols import DEFINITIONS
from scenic.ide.snapshot import Snapshot
from scenic.language.spans import Span

__all__ = ["name_span", "span_of"]


def span_of(snapshot: Snapshot, node: ast.AST) -> Span:
    """The place of a node."""
    return snapshot.source.span(node)


def name_span(snapshot: Snapshot, node: Any, name: str | None = None) -> Span:
    """The place of the name that a node binds or mentions; of the whole node if the name cannot be found in it.

    ``name`` is the wanted one where the node has several.
    """
    whole = span_of(snapshot, node)
    if isinstance(node, ast.Name):
        return whole
    if isinstance(node, ast.Attribute):
        # The attribute is the last word of the node.
        return _word(snapshot, node, node.attr, last=True) or whole
    if isinstance(node, ast.alias):
        name_wanted: str | None = node.asname or name or node.name.partition(".")[0]
        return _word(snapshot, node, str(name_wanted), last=node.asname is not None) or whole
    name_wanted = (
        name or getattr(node, "name", None) or getattr(node, "arg", None) or getattr(node, "rest", None)
    )
    if not isinstance(name_wanted, str):
        return whole
    # A decorator may hold the same word: the line of the definition begins after it.
    return _word(snapshot, node, name_wanted, last=False, skip=isinstance(node, DEFINITIONS)) or whole


def _word(snapshot: Snapshot, node: Any, word: str, *, last: bool, skip: bool = False) -> Span | None:
    """The first or last place of a word within a node; ``skip``: but not as the very first word."""
    tokens = snapshot.tokens
    begin = (node.lineno, node.col_offset)
    end = (node.end_lineno, node.end_col_offset)
    token = None
    first = True
    start = snapshot.tokens_of_line(node.lineno).start
    for index in range(start, len(tokens.kinds)):
        place = (tokens.lines[index], tokens.columns[index])
        if place < begin:
            continue
        if place >= end:
            break
        if tokens.texts[index] == word and snapshot.is_word(index) and not (skip and first):
            token = index
            if not last:
                break
        first = False
    return None if token is None else snapshot.span_of_token(token)
