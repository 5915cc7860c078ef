"""The input of every rule: the program, what its names mean, and the making of diagnostics."""

import ast
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, Final
from weakref import proxy

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import Block, blocks
from scenic.compiler.checks.classes import Classes
from scenic.compiler.checks.meanings import ProgramMeanings
from scenic.compiler.checks.places import header_span, word_span
from scenic.compiler.kinds import Kind, KindOf
from scenic.compiler.scopes import PROVIDED, Binding, BindingKind, Resolution, Scope, ScopeKind
from scenic.compiler.surroundings import Foreign, Surroundings
from scenic.compiler.traversal import first_position, position
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Label, Severity
from scenic.language.members import Member
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.language.spelling import is_slip

__all__ = ["DEFINITIONS", "Context", "Definition", "NodeRule", "ProgramRule"]

DEFINITIONS: Final = (
    ast.FunctionDef,
    ast.AsyncFunctionDef,
    ast.ClassDef,
    scenic.BehaviorDef,
    scenic.MonitorDef,
    scenic.ScenarioDef,
)
"""Statements that bind a name to something that can be called, instantiated or run."""

HEADED: Final = (
    ast.ClassDef,
    ast.FunctionDef,
    scenic.BehaviorDef,
    scenic.Model,
    scenic.MonitorDef,
    scenic.ScenarioDef,
)
"""Statements after which an unparsed text no longer counts as the header of the following block."""

Definition = (
    ast.FunctionDef
    | ast.AsyncFunctionDef
    | ast.ClassDef
    | scenic.BehaviorDef
    | scenic.MonitorDef
    | scenic.ScenarioDef
)


class Context:
    """A program under examination. Facts that several rules need are computed once, on first use."""

    def __init__(
        self,
        tree: ast.Module,
        source: Source,
        resolution: Resolution,
        surroundings: Surroundings | None = None,
        *,
        typing: bool = False,
    ) -> None:
        self.tree = tree
        self.source = source
        self.resolution = resolution
        self.surroundings = surroundings
        self.typing: Final = typing
        """True if somebody is writing the program, in an editor."""
        self.brought: Final[Collection[str]] = () if surroundings is None else surroundings.names
        """The names that star imports and the model are known to bring."""
        self._foreign: Final[dict[ast.expr, Foreign | None]] = {}

    # What the program is

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """Every list of statements, outer ones before those in them."""
        return tuple(blocks(self.tree, self.tree.body))

    @cached_property
    def classes(self) -> Classes:
        """The properties of the classes that the program uses."""
        # Without a reference back all of this is gone as soon as the check is done.
        return Classes(proxy(self))

    @cached_property
    def meanings(self) -> ProgramMeanings:
        """The meanings of names for the inference of kinds."""
        return ProgramMeanings(proxy(self))

    @cached_property
    def _kinds(self) -> KindOf:
        return KindOf(self.meanings)

    def kind_of(self, value: ast.expr | None) -> Kind | None:
        """The kind of what an expression gives; ``None`` if it is not certain."""
        return self._kinds(value)

    def method(self, function: ast.Attribute) -> Member | None:
        """The declared method of a value that a call of an attribute calls."""
        return self._kinds.method(function)

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
        """The names of all attributes that the program writes."""
        return frozenset(
            node.attr for node, _ in self.nodes(ast.Attribute) if not isinstance(node.ctx, ast.Load)
        )

    @cached_property
    def grown(self) -> frozenset[str]:
        """The names of lists and dictionaries whose elements the program may change."""
        called = (node.value for node, _ in self.nodes(ast.Attribute) if node.attr in _GROWING)
        stored = (node.value for node, _ in self.nodes(ast.Subscript) if not isinstance(node.ctx, ast.Load))
        return frozenset(value.id for value in (*called, *stored) if isinstance(value, ast.Name))

    @cached_property
    def given(self) -> frozenset[str]:
        """The properties that the program gives with `with`."""
        return frozenset(node.property for node, _ in self.nodes(scenic.SpecifierPhrase))

    @cached_property
    def parameters(self) -> frozenset[str]:
        """The names of the global parameters that the program sets."""
        return frozenset(item.name for node, _ in self.nodes(scenic.Param) for item in node.items)

    @cached_property
    def owners(self) -> Mapping[str, int]:
        """Numbers of classes of the program that define an attribute or method of each name."""
        classes = (scope for scope in self.resolution.scopes.values() if scope.kind is ScopeKind.CLASS)
        return Counter(name for scope in classes for name in scope.bindings)

    @cached_property
    def class_names(self) -> frozenset[str]:
        """The names of the classes that are defined at the top level."""
        names = self.resolution.names
        return frozenset(name for name, binding in names.items() if BindingKind.CLASS in binding.kinds)

    @cached_property
    def ego_value(self) -> ast.expr | None:
        """The value of the ego, if the program sets it just once."""
        uses = self.resolution.uses.get("ego", ())
        stores = [use.node for use in uses if isinstance(use.node.ctx, ast.Store)]
        return self.assigned.get(stores[0]) if len(stores) == 1 else None

    @cached_property
    def ego_members(self) -> frozenset[str] | None:
        """All attributes and methods of the ego, if the program sets it just once and makes it there."""
        value = self.ego_value
        return self.meanings.members(value.cls) if isinstance(value, scenic.New) else None

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

    def nodes(self, cls: type[ast.AST]) -> Sequence[tuple[Any, Scope]]:
        """All nodes of a class, with their scopes."""
        return self.resolution.nodes(cls)

    def nodes_around(self, node: ast.AST, cls: type[ast.AST]) -> Iterator[Any]:
        """The nodes of a class in the statement of the top level that a node stands in."""
        nodes, starts = self.nodes(cls), self._starts
        index = bisect_right(starts, position(node))
        begin = bisect_left(nodes, starts[index - 1], key=_position_of_noted) if index else 0
        for each, _ in nodes[begin:]:
            if index < len(starts) and position(each) >= starts[index]:
                return
            yield each

    @cached_property
    def _starts(self) -> list[tuple[int, int]]:
        """The places at which the statements of the top level begin."""
        return [first_position(each) for each in self.tree.body]

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

    @cached_property
    def _last_wildcard(self) -> tuple[int, int]:
        """The last place where names come in that the text does not show; they may replace those before."""
        stars = [
            node for node, _ in self.nodes(ast.ImportFrom) if any(alias.name == "*" for alias in node.names)
        ]
        models = [node for node, _ in self.nodes(scenic.Model)]
        return max(map(position, (*stars, *models)), default=(0, 0))

    def binding(self, name: ast.Name) -> Binding | None:
        """The meaning of a name of the program, as far as the text shows it."""
        return self.resolution.binding(name)

    def is_unbound(self, name: ast.Name) -> bool:
        """Return whether the text binds a name of the program nowhere in reach."""
        reference = self.resolution.references.get(name)
        return reference is not None and reference.binding is None

    def definition(self, name: ast.expr | None) -> Definition | None:
        """The one definition that an expression can only mean; ``None`` if there may be others, or decorators."""
        if not isinstance(name, ast.Name) or self.resolution.reflective:
            return None
        binding = self.binding(name)
        if binding is None or len(binding.sites) != 1:
            return None
        [site] = binding.sites
        if not isinstance(site, DEFINITIONS) or getattr(site, "decorator_list", None):
            return None
        return site if self._stands(name.id, site) else None

    def _stands(self, name: str, site: ast.AST) -> bool:
        """Return whether no names that the text does not show may replace what is bound to a name there."""
        if position(site) >= self._last_wildcard:
            return True
        return not self.resolution.wildcard and name not in self.brought

    def foreign(self, name: ast.expr | None) -> Foreign | None:
        """The meaning of an expression, if another module certainly defines it."""
        if self.surroundings is None or self.resolution.reflective or name is None:
            return None
        # Several rules ask about each name.
        if name not in self._foreign:
            self._foreign[name] = self._foreign_of(name, self.surroundings)
        return self._foreign[name]

    def _foreign_of(self, name: ast.expr, surroundings: Surroundings) -> Foreign | None:
        if isinstance(name, ast.Attribute):
            return surroundings.attribute(name)
        reference = self.resolution.references.get(name) if isinstance(name, ast.Name) else None
        if reference is None:
            return None
        binding = reference.binding
        if binding is None:
            known = reference.node.id in self.brought and not self.resolution.wildcard
            return surroundings.brought(reference.node.id) if known else None
        if len(binding.sites) != 1 or binding.kinds != {BindingKind.IMPORTED}:
            return None
        [site] = binding.sites
        if not isinstance(site, ast.alias) or not self._stands(binding.name, site):
            return None
        return surroundings.imported(site)

    def kind_of_brought(self, name: ast.expr) -> str | None:
        """The kind of the value that another module defines under a name, in the word of the declared type."""
        if self.surroundings is None or not isinstance(name, ast.Name) or self.resolution.reflective:
            return None
        reference = self.resolution.references.get(name)
        if reference is None or reference.binding is not None or self.resolution.wildcard:
            return None
        return self.surroundings.kind_of(name.id) if name.id in self.brought else None

    def provided(self, name: ast.expr | None) -> str | None:
        """The name that an expression is, if it means what the language provides under that name."""
        if not isinstance(name, ast.Name) or self.resolution.wildcard:
            return None
        reference = self.resolution.references.get(name)
        own = reference is not None and reference.binding is None and name.id not in self.brought
        return name.id if own else None

    def defined(self, name: str, definition: Definition, foreign: Foreign | None) -> tuple[Label, ...]:
        """The place of a definition, here or in another file."""
        if foreign is None:
            return (Label(word_span(self.source, definition, name), "defined here"),)
        if foreign.filename is None or foreign.span is None:
            return ()
        return (Label(foreign.span, "defined here", foreign.filename),)

    def constant(self, name: ast.Name) -> ast.expr | None:
        """The literal that is certainly the value of a name: a number, text or collection assigned just once."""
        binding = self.binding(name)
        if binding is None or len(binding.sites) != 1 or self.resolution.reflective:
            return None
        value = self.assigned.get(binding.sites[0])
        literal = isinstance(value, ast.Constant | ast.List | ast.Tuple | ast.Dict | ast.Set | ast.JoinedStr)
        return value if literal and value is not None and self._stands(name.id, value) else None

    @cached_property
    def assigned(self) -> "Assigned":
        """The value of each name that is the whole target of an assignment."""
        return Assigned(self.resolution)

    @cached_property
    def imports(self) -> Mapping[ast.AST, tuple[Any, bool, list[Any]]]:
        """Of each imported name: the statement, whether it is an attempt that may fail, and the block it stands in."""
        return {
            alias: (statement, isinstance(block.owner, ast.Try | ast.ExceptHandler), block.statements)
            for block in self.blocks
            for statement in block.statements
            if isinstance(statement, ast.Import | ast.ImportFrom)
            for alias in statement.names
        }

    @cached_property
    def _mentions(self) -> Mapping[str, list[tuple[int, int]]]:
        places: dict[str, list[tuple[int, int]]] = {}
        for node in self.resolution.references:
            assert isinstance(node, ast.Name)
            places.setdefault(node.id, []).append(position(node))
        return places

    def mentions(self, name: str) -> list[tuple[int, int]]:
        """Return the places where a name is read or written, in order."""
        return sorted(self._mentions.get(name, ()))

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
        """The text of a node; ``None`` if it takes several lines."""
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


_GROWING: Final = frozenset(
    {"append", "clear", "extend", "insert", "pop", "popitem", "remove", "setdefault", "update"}
)
"""Methods that change the elements of a list or dictionary."""


def _position_of_noted(noted: tuple[ast.AST, Scope]) -> tuple[int, int]:
    return position(noted[0])


class Assigned:
    """The values of names in targets of assignments, by the nodes of the names."""

    def __init__(self, resolution: Resolution) -> None:
        values: dict[ast.AST, tuple[ast.expr, bool]] = {}
        for node, _ in resolution.nodes(ast.Assign):
            for target in node.targets:
                values.update(_parts(target, node.value))
        for node, _ in resolution.nodes(ast.AnnAssign):
            if isinstance(node.target, ast.Name) and node.value is not None:
                values[node.target] = (node.value, True)
        self._values = values

    def get(self, site: ast.AST) -> ast.expr | None:
        """The value that is assigned to a name there, which is a whole target."""
        value, whole = self._values.get(site, (None, False))
        return value if whole else None

    def part(self, site: ast.AST) -> ast.expr | None:
        """The value that is assigned to a name there, also as a part of a tuple."""
        return self._values.get(site, (None, False))[0]


def _parts(
    target: ast.expr, value: ast.expr, *, whole: bool = True
) -> Iterator[tuple[ast.AST, tuple[ast.expr, bool]]]:
    """The names of a target, each with its value, and whether it is a whole target; tuples in the text part by part."""
    if isinstance(target, ast.Name):
        yield target, (value, whole)
    elif isinstance(target, ast.Tuple | ast.List) and isinstance(value, ast.Tuple | ast.List):
        starred = any(isinstance(each, ast.Starred) for each in (*target.elts, *value.elts))
        if not starred and len(target.elts) == len(value.elts):
            for part, of in zip(target.elts, value.elts, strict=True):
                yield from _parts(part, of, whole=False)


NodeRule = Callable[[Any, Scope, Context], Iterator[Diagnostic]]
"""A rule about one node in a scope."""

ProgramRule = Callable[[Context], Iterator[Diagnostic]]
"""A rule about a program as a whole."""
