"""Explanations of the words of a program: keywords, operators, specifiers, properties, names of the language and of the program."""

import ast
from collections.abc import Callable
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import Module
from scenic.compiler.tokens import NAME
from scenic.dataclass import dataclass
from scenic.ide import descriptions, documentation
from scenic.ide.parameters import parameter_at, settings
from scenic.ide.snapshot import Snapshot
from scenic.language.names import TRACKED
from scenic.language.operators import OPERATORS
from scenic.language.spans import Span
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS
from scenic.project.index import Project
from scenic.project.queries import occurrence_at, occurrences, symbol_of

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


def hover(
    snapshot: Snapshot, line: int, column: int, project_of: Callable[[], Project] | None = None
) -> Hover | None:
    """Explain the word at a place: ``line`` from 1, ``column`` in characters from 0.

    ``None`` where there is nothing to explain: in strings and comments. Names that the program defines are explained by
    the project, which must know the document; it is only asked for where there is such a name.
    """
    tokens = snapshot.tokens
    index = snapshot.token_at(line, column)
    if index is None or not (snapshot.is_word(index) or tokens.texts[index] == "@"):
        return None
    span = snapshot.span_of_token(index)
    parameter = parameter_at(snapshot, line, column)
    if parameter is not None and project_of is not None:
        return _of_parameter(project_of(), snapshot, *parameter)
    node = snapshot.path_to(line, span.column)[-1]
    markdown = _explain(tokens.texts[index], tokens.kinds[index], node)
    is_name = isinstance(node, ast.Name | ast.Attribute)
    if project_of is not None and (is_name or (markdown is None and tokens.kinds[index] >= NAME)):
        markdown = _defined(project_of(), snapshot, span) or markdown
    if markdown is None and isinstance(node, ast.Name):
        markdown = descriptions.of_python(node.id)
    return None if markdown is None else Hover(markdown, span)


def _of_parameter(project: Project, snapshot: Snapshot, name: str, span: Span) -> Hover | None:
    """Return a global parameter with the values that it is given."""
    module = project.module(snapshot.filename)
    found = [] if module is None else [each for each in settings(project, module) if each.name == name]
    if not found:
        return None
    lines = "\n".join(f"param {name} = {each.value}" for each in found)
    return Hover(f"```scenic\n{lines}\n```\nA global parameter.", span)


def _defined(project: Project, snapshot: Snapshot, span: Span) -> str | None:
    """Return the project's description of the name at a span, or ``None``."""
    module = project.module(snapshot.filename)
    found = None if module is None else occurrence_at(module, span.line, span.column)
    if module is None or found is None or found.span.line != span.line or found.span.column != span.column:
        return None
    if found.name in TRACKED and isinstance(found.node, ast.Name):
        return _tracked(module, found.name)
    symbol = symbol_of(Model(module, project), found)
    return None if symbol is None else descriptions.describe(project, symbol)


def _tracked(module: Module, name: str) -> str | None:
    """Return the description of the ego or the workspace, if the module sets it."""
    setting = next((each for each in occurrences(module) if each.name == name and each.defines), None)
    if setting is None:
        return None
    line = module.source.line(setting.span.line).strip().removesuffix(",")
    return f"```scenic\n{line}\n```\n\n{documentation.of_name(name) or ''}".rstrip()


def _explain(word: str, kind: int, node: ast.AST) -> str | None:
    """Return the language's explanation of ``word`` in ``node``, the smallest node around it, or ``None``."""
    if isinstance(node, ast.Name):
        return documentation.of_name(word)
    if isinstance(node, ast.Attribute):
        return documentation.of_property(word)
    if isinstance(node, scenic.SpecifierPhrase):
        if word == node.property:
            return documentation.of_property(word)
        declaration = SPECIFIERS.get(node.specifier)
        return None if declaration is None else documentation.of_specifier(declaration)
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
