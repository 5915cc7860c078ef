"""The input of every rule: the program, what its names mean, and the making of diagnostics."""

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import Block, blocks
from scenic.compiler.places import header_span
from scenic.compiler.scopes import PROVIDED, BindingKind, Scope
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import NO_MODULES, Module
from scenic.compiler.semantics.symbols import DEFINITIONS, Symbol
from scenic.compiler.surroundings import Surroundings
from scenic.compiler.traversal import position
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Label, Severity
from scenic.language.spans import Span
from scenic.language.spelling import is_slip, nearest

__all__ = ["DEFINITIONS", "CheckContext", "NodeRule", "ProgramRule"]

HEADED: Final = (
    ast.ClassDef,
    ast.FunctionDef,
    scenic.BehaviorDef,
    scenic.Model,
    scenic.MonitorDef,
    scenic.ScenarioDef,
)
"""Statements after which an unparsed text no longer counts as the header of the following block."""


class CheckContext(Model):
    """A program under examination, with the making of diagnostics. Facts that several rules need are computed once."""

    def __init__(
        self,
        module: Module,
        surroundings: Surroundings | None = None,
        *,
        typing: bool = False,
    ) -> None:
        super().__init__(module, NO_MODULES if surroundings is None else surroundings.modules)
        self.surroundings: Final = surroundings
        self.source = module.source
        self.typing: Final = typing
        """True if somebody is writing the program, in an editor."""

    @cached_property
    def wildcard(self) -> bool:
        """Return whether names may exist that neither the text nor the modules that it imports show."""
        if any(_brings_names(self.source.line(node.lineno)) for node, _ in self.nodes(scenic.ErrorStatement)):
            return True
        if self.surroundings is None:
            return self.resolution.wildcard
        return self.resolution.rebinding or not self.complete

    # What the program is

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """Every list of statements, outer ones before those in them."""
        return tuple(blocks(self.tree, self.tree.body))

    # Facts about the whole program

    @cached_property
    def broken(self) -> bool:
        """Return whether parts could not be parsed: then nothing can be reported as missing or unused."""
        return bool(self.nodes(scenic.ErrorStatement))

    @cached_property
    def attributes(self) -> frozenset[str]:
        """The names of all attributes that the program reads or writes."""
        return frozenset(node.attr for node, _ in self.nodes(ast.Attribute))

    @cached_property
    def stored_attributes(self) -> frozenset[str]:
        """The names of all attributes that the program writes, also with ``setattr``."""
        assigned = (node.attr for node, _ in self.nodes(ast.Attribute) if not isinstance(node.ctx, ast.Load))
        return frozenset(assigned).union(each for each in self._named_in("setattr") if each is not None)

    @cached_property
    def writes_any_attribute(self) -> bool:
        """Return whether the program may give things attributes of names that its text does not show."""
        return "__dict__" in self.attributes or None in self._named_in("setattr")

    def _named_in(self, function: str) -> Iterator[str | None]:
        """The names of attributes that calls of a function of Python name; ``None`` for computed ones."""
        for node, _ in self.nodes(ast.Call) if function in self.resolution.mentions else ():
            if isinstance(node.func, ast.Name) and node.func.id == function:
                match node.args:
                    case [_, ast.Constant(value=str(attribute)), *_]:
                        yield attribute
                    case _:
                        yield None

    @cached_property
    def asked_attributes(self) -> frozenset[str]:
        """The names of all attributes that the program asks for with ``hasattr``."""
        return frozenset(each for each in self._named_in("hasattr") if each is not None)

    @cached_property
    def given(self) -> frozenset[str]:
        """The properties that the program gives with `with`."""
        return frozenset(node.property for node, _ in self.nodes(scenic.SpecifierPhrase))

    @cached_property
    def parameters(self) -> frozenset[str]:
        """The names of the global parameters that the program sets."""
        return frozenset(item.name for node, _ in self.nodes(scenic.Param) for item in node.items)

    @cached_property
    def class_names(self) -> frozenset[str]:
        """The names of the classes that are defined at the top level."""
        names = self.resolution.names
        return frozenset(name for name, binding in names.items() if BindingKind.CLASS in binding.kinds)

    @cached_property
    def unresolved(self) -> frozenset[str]:
        """The names that are read and mean nothing that is known."""
        names = self.resolution.names
        return frozenset(
            name
            for name in self.resolution.uses
            if name not in names and name not in PROVIDED and name not in self.brought
        )

    # What its names mean

    @cached_property
    def attempts(self) -> Sequence[tuple[tuple[int, int], ...]]:
        """The stretches of the text in which exceptions are caught, in order; none lies in another."""
        attempts: list[tuple[tuple[int, int], ...]] = []
        for node, _ in self.nodes(ast.Try):
            if node.handlers and not (attempts and position(node) < attempts[-1][1]):
                attempts.append((position(node), position(node.handlers[0])))
        return attempts

    def is_cut(self, node: ast.AST) -> bool:
        """Return whether a comma separates an object from the rest of its last operand, which SC311 reports."""
        return node in self._cut

    @cached_property
    def _cut(self) -> frozenset[ast.AST]:
        return frozenset(
            each.value.elts[0]
            for each, _ in self.nodes(ast.Assign)
            if isinstance(each.value, ast.Tuple) and each.value.elts
        )

    def defined(self, symbol: Symbol) -> tuple[Label, ...]:
        """The place of a definition, here or in another file."""
        if symbol.span is None:
            return ()
        if symbol.module is self.module:
            return (Label(symbol.span, "defined here"),)
        return (Label(symbol.span, "defined here", symbol.filename),)

    @cached_property
    def imports(self) -> Mapping[ast.AST, tuple[Any, bool, list[Any]]]:
        """For each imported name: its statement, whether that is an attempt that may fail, and the statements of its block."""
        return {
            alias: (statement, isinstance(block.owner, ast.Try | ast.ExceptHandler), block.statements)
            for block in self.blocks
            for statement in block.statements
            if isinstance(statement, ast.Import | ast.ImportFrom)
            for alias in statement.names
        }

    def mentions(self, name: str) -> list[tuple[int, int]]:
        """Return the places where a name is read or written, in order."""
        return sorted(position(each.node) for each in self.resolution.mentions.get(name, ()))

    # What is said about it

    def error(
        self,
        code: str,
        message: str,
        place: ast.AST | Span,
        help_: str,
        *,
        labels: tuple[Label, ...] = (),
        fix: Fix | None = None,
    ) -> Diagnostic:
        """An error at a place; of a node that spans several lines, at the first."""
        span = self.span(place)
        return Diagnostic(code, message, span, Severity.ERROR, self.source.filename, help_, labels, fix)

    def warning(
        self,
        code: str,
        message: str,
        place: ast.AST | Span,
        help_: str,
        *,
        labels: tuple[Label, ...] = (),
        fix: Fix | None = None,
    ) -> Diagnostic:
        """A warning at a place; of a node that spans several lines, at the first."""
        span = self.span(place)
        return Diagnostic(code, message, span, Severity.WARNING, self.source.filename, help_, labels, fix)

    def label(self, place: ast.AST | Span, text: str) -> Label:
        """A second place."""
        return Label(self.span(place), text)

    def span(self, place: ast.AST | Span) -> Span:
        """The place of a node on its first line."""
        return place if isinstance(place, Span) else header_span(self.source, place)

    def text(self, node: ast.AST) -> str | None:
        """Return the text of a node; ``None`` if it takes several lines."""
        span = self.source.span(node)
        return (
            self.source.line(span.line)[span.column : span.end_column] if span.end_line == span.line else None
        )

    def insertion(self, title: str, *places: tuple[ast.AST, str]) -> Fix:
        """A repair that adds a text after each of some nodes."""
        ends = ((self.source.span(node), text) for node, text in places)
        return Fix(
            title,
            tuple(
                Edit(Span(span.end_line, span.end_column, span.end_line, span.end_column), text)
                for span, text in ends
            ),
        )

    def replacement(self, title: str, place: ast.AST | Span, text: str, *, certain: bool = True) -> Fix:
        """A repair that replaces a node by a text."""
        span = place if isinstance(place, Span) else self.source.span(place)
        return Fix(title, (Edit(span, text),), certain)

    def renaming(self, place: ast.AST | Span, name: str, meant: str, *, certain: bool = True) -> Fix:
        """A repair of a misspelt name, certain at most if it can hardly be anything else."""
        return self.replacement(f"Write `{meant}`", place, meant, certain=certain and is_slip(name, meant))


def _brings_names(line: str) -> bool:
    """Return whether a line that could not be parsed may have been one that brings names that the text does not show."""
    words = line.split(maxsplit=1)
    if not words:
        return False
    return (
        words[0] == "model" or nearest(words[0], ("model",)) is not None or ("import" in line and "*" in line)
    )


NodeRule = Callable[[Any, Scope, CheckContext], Iterator[Diagnostic]]
"""A rule about one node in a scope."""

ProgramRule = Callable[[CheckContext], Iterator[Diagnostic]]
"""A rule about a program as a whole."""
