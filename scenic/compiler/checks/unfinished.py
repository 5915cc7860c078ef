"""Names that are words of the language in what is not finished: ``facing toward``, ``require always``, ``do choose``."""

import ast
import re
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import pairwise
from types import MappingProxyType
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext
from scenic.compiler.forms import declared_forms
from scenic.compiler.generated import SOFT_KEYWORDS
from scenic.language.diagnostics import Diagnostic
from scenic.language.keywords import TEMPORAL_OPERATORS
from scenic.language.statements import STATEMENTS

__all__ = [
    "alone_names",
    "begun_names",
    "begun_word",
    "compared_names",
    "may_bind_more",
    "text_before",
    "unfinished",
]

_ENDS: Final = ("", ",", ")", "]", "}", ";", ":", "#")
"""Texts that may follow a missing part: the end of the line, or one of these characters."""


_HALF_BOUND: Final = re.compile(
    r"[^=]*[^=<>!]=(?:(?!=).*[=([{])?\s*$"
    r"|(?=.*[,(\[*])\s*(?:[*(\[ ]{0,9}+[^\W\d]\w*+[)\] ]{0,9}+,)*[*(\[ ]{0,9}+\w*+$"
)
"""An assignment that ends with ``=`` or an open bracket, or the beginning of its targets."""

_BINDING: Final = (
    "async",
    "behavior",
    "case",
    "class",
    "def",
    "except",
    "for",
    "from",
    "import",
    "match",
    "model",
    "monitor",
    "scenario",
    "with",
)
"""First words of statements that bind names of any kind."""


@cache
def _following() -> Mapping[tuple[str, str], str]:
    """Return the form of the language for each two words that follow each other in it."""
    forms: dict[tuple[str, str], str] = {}
    for declaration in declared_forms():
        words = zip(declaration.words, declaration.is_word, strict=True)
        for (first, is_first), (second, is_second) in pairwise(words):
            if is_first and is_second and second in SOFT_KEYWORDS:
                forms.setdefault((first, second), declaration.text)
    for form in (form for statement in STATEMENTS.values() for form in statement.forms):
        for first, second in pairwise(form.split()):
            if second in SOFT_KEYWORDS:
                forms.setdefault((first, second), form)
    for temporal in TEMPORAL_OPERATORS.values():
        for form in temporal.forms:
            if form.split()[0] in SOFT_KEYWORDS:
                forms.setdefault(("require", form.split()[0]), f"require {form}")
    return MappingProxyType(forms)


@cache
def _beginnings() -> Mapping[str, str]:
    """Return the form for each word that begins statements and may be a name."""
    found: dict[str, str] = {}
    for statement in STATEMENTS.values():
        for form in statement.forms:
            first, *rest = form.split()
            if first in SOFT_KEYWORDS and rest:
                found.setdefault(first, form)
    return MappingProxyType(found)


@cache
def _operators() -> Mapping[str, str]:
    """Return the form for each word of operators: one that begins with the word, if there is any."""
    found: dict[str, str] = {}
    operators = [each for each in declared_forms() if each.node == "Operation"]
    for begins in (True, False):
        for each in operators:
            for index, word in enumerate(each.words):
                if each.is_word[index] and word in SOFT_KEYWORDS and begins == (index == 0):
                    found.setdefault(word, each.text)
    return MappingProxyType(found)


def text_before(context: CheckContext, node: ast.Name) -> str:
    """The text before a name on its line, without blanks at the end."""
    span = context.source.span(node)
    return context.source.line(span.line)[: span.column].rstrip()


def _word_before(context: CheckContext, node: ast.Name) -> str:
    words = text_before(context, node).replace("(", " ").split()
    return words[-1] if words else ""


def unfinished(context: CheckContext, node: ast.Name) -> Diagnostic | None:
    """The missing rest after a name that is a word of the language and has nothing else in its place."""
    if node.id not in SOFT_KEYWORDS:
        return None
    span = context.source.span(node)
    rest = context.source.line(span.line)[span.end_column :].lstrip()
    if rest[:1] not in _ENDS:
        return None
    form = _following().get((_word_before(context, node), node.id))
    if form is None and not text_before(context, node) and node in alone_names(context):
        form = _beginnings().get(node.id)
    if form is not None:
        return context.error(
            "SC110", f"something is missing after `{node.id}`", node, f"the form is `{form}`"
        )
    form = _operators().get(node.id) if rest[:1] in ("", "#") else None
    if form is None:
        return None
    return context.error(
        "SC110",
        f"`{node.id}` is a word of an operator, and nothing by itself",
        node,
        f"the form is `{form}`; a variable of that name would have to be defined",
    )


def alone_names(context: CheckContext) -> set[ast.Name]:
    """The names that nothing binds and that are whole statements, alone or in a row: all have just begun to be typed."""
    return {
        name
        for node, _ in context.nodes(ast.Expr)
        for name in _names_in_row(node.value)
        if context.is_unbound(name)
    }


def begun_names(context: CheckContext) -> set[ast.Name]:
    """The names of `alone_names` while somebody is typing; none in a program that is written."""
    return alone_names(context) if context.typing else set()


def compared_names(context: CheckContext) -> set[ast.Name]:
    """The names that nothing binds on the left of ``==`` or ``<-`` in statements that only compare: they were meant to be bound."""
    names = set()
    for node, _ in context.nodes(ast.Expr):
        match node.value:
            case ast.Compare(left=ast.Name() as name, ops=[ast.Eq()]) if context.is_unbound(name):
                names.add(name)
            case ast.Compare(left=ast.Name() as name, ops=[ast.Lt()], comparators=[right]) if (
                context.is_unbound(name)
                and isinstance(right, ast.UnaryOp)
                and "<-" in (context.text(node) or "")
            ):
                names.add(name)
    return names


def _names_in_row(value: ast.expr) -> Iterator[ast.Name]:
    """The names of a value that are targets as soon as ``=`` follows; none if it could not be assigned to."""
    if isinstance(value, ast.Name):
        yield value
    elif isinstance(value, ast.Starred):
        yield from _names_in_row(value.value)
    elif isinstance(value, ast.Tuple | ast.List):
        for each in value.elts:
            yield from _names_in_row(each)


def may_bind_more(context: CheckContext) -> bool:
    """Return whether a statement is half typed, so that any name may be one that the rest of it binds.

    Such are assignments that end with ``=`` or an open bracket, beginnings of targets and, while somebody is typing, names in
    a row, and those that may become the first word of a statement that binds others.
    """
    for name in begun_names(context):
        if "," in context.source.line(name.lineno) or any(word.startswith(name.id) for word in _BINDING):
            return True
    return any(
        _HALF_BOUND.match(context.source.line(node.lineno))
        for node, _ in context.nodes(scenic.ErrorStatement)
    )


def begun_word(context: CheckContext, node: ast.Name) -> str | None:
    """Return the only word of the language that begins with the name at the end of a line; ``None`` if there are others."""
    before = _word_before(context, node)
    found = {
        second for first, second in _candidates(before) if second.startswith(node.id) and second != node.id
    }
    return found.pop() if len(found) == 1 and len(node.id) > 1 else None


def _candidates(before: str) -> Iterator[tuple[str, str]]:
    return (pair for pair in _following() if pair[0] == before)
