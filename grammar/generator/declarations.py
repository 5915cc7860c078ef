"""Holds the grammar against what `scenic.language` declares: nothing can be written that nobody has explained.

An operator or specifier needs an entry with as many operands as the grammar gives it, a statement one under the class
of its node. Without them it would parse, and every tool after the parser would fail on it.
"""

import ast
from collections.abc import Iterator, Mapping, Sized
from pathlib import Path
from typing import Final

from grammar.generator.actions import SOURCES
from grammar.generator.analysis import Analysis
from grammar.generator.model import Grammar, GrammarError
from grammar.generator.precedence import Precedence
from grammar.generator.syntax import nodes_made
from scenic.language.keywords import TEMPORAL_OPERATORS
from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

__all__ = ["check_declarations"]

_TABLES: Final[Mapping[str, tuple[str, str, Mapping[str, Sized]]]] = {
    "Operation": ("operator", "operators", {name: each.operands for name, each in OPERATORS.items()}),
    "SpecifierPhrase": (
        "specifier",
        "specifiers",
        {name: each.operands for name, each in SPECIFIERS.items()},
    ),
    "Temporal": (
        "temporal operator",
        "keywords",
        {name: each.operands for name, each in TEMPORAL_OPERATORS.items()},
    ),
}
"""By class of node: what it is, the module that declares it, the declared operands by name."""

_BASE = "ScenicStatement"
_NOT_WRITTEN = frozenset({"ErrorStatement"})


def check_declarations(analysis: Analysis) -> None:
    """Raise `GrammarError` if the grammar has an operator, specifier or statement that is not declared."""
    precedence = Precedence(analysis)
    for form in (*precedence.forms, *precedence.specifiers):
        if form.node is not None and form.node in _TABLES and form.operator is not None:
            what, module, declarations = _TABLES[form.node]
            text = " ".join(form.words)
            if form.operator not in declarations:
                raise GrammarError(
                    f"rule {form.rule!r}: the {what} {form.operator!r} (`{text} ...`) is not declared: "
                    f"add it to scenic/language/{module}.py"
                )
            _check_count(what, form.operator, declarations[form.operator], len(form.slots) + len(form.absent))
    for rule, node in _statements(analysis.grammar):
        if node not in STATEMENTS:
            raise GrammarError(
                f"rule {rule!r}: the statement {node} is not declared: add it to scenic/language/statements.py"
            )


def _check_count(what: str, name: str, declared: Sized, count: int) -> None:
    if len(declared) != count:
        raise GrammarError(f"the {what} {name!r} has {count} operands, but is declared with {len(declared)}")


def _statements(grammar: Grammar) -> Iterator[tuple[str, str]]:
    """The statements of Scenic that the grammar makes, each with its rule."""
    tree = ast.parse(Path(SOURCES / "tree.py").read_text(encoding="utf-8"))
    classes = {
        each.name
        for each in tree.body
        if isinstance(each, ast.ClassDef)
        and any(isinstance(base, ast.Name) and base.id == _BASE for base in each.bases)
    } - _NOT_WRITTEN
    for rule in grammar.rules.values():
        for alternative in rule.alternatives:
            for node in nodes_made(alternative):
                if node in classes:
                    yield rule.name, node
