"""The input of every rule: the program, what its names mean, and the making of diagnostics."""

import ast
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, Final
from weakref import proxy

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import Block, blocks
from scenic.compiler.checks.classes import Classes
from scenic.compiler.checks.kept import Kept, Moves, Said, changed_names
from scenic.compiler.checks.meanings import ProgramMeanings
from scenic.compiler.checks.places import header_span, word_span
from scenic.compiler.kinds import Kind, KindOf
from scenic.compiler.scopes import (
    PROVIDED,
    Binding,
    BindingKind,
    Resolution,
    Scope,
    ScopeKind,
    Stretch,
)
from scenic.compiler.surroundings import Foreign, Surroundings
from scenic.compiler.traversal import position
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
        before: Kept | None = None,
        *,
        typing: bool = False,
    ) -> None:
        self.tree = tree
        self.source = source
        self.resolution = resolution
        self.surroundings = surroundings
        self.typing: Final = typing
        """True if somebody is writing the program, in an editor."""
        if before is None:
            # All of them will be asked for: they are put together at once.
            _ = resolution.references
        self.brought: Final[Collection[str]] = () if surroundings is None else surroundings.names
        """The names that star imports and the model are known to bring."""
        self.before: Final = before
        self.said: Final[dict[tuple[str, tuple[object, ...]], Said]] = {}
        """Findings of each group of rules about each stretch."""
        self.asked: Final[set[str]] = set()
        """The facts about the whole program that rules have read."""
        self._facts: Final[dict[str, Any]] = {}
        self._foreign: Final[dict[ast.expr, Foreign | None]] = {}
        self._cut: Final[dict[Stretch, frozenset[ast.AST]]] = {}

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

    # What has changed since the version before

    @cached_property
    def kept(self) -> Kept:
        """The findings, kept for the next version."""
        return Kept(self._state, self.resolution.names, self.resolution.stretches, self.said)

    @cached_property
    def _state(self) -> tuple[object, ...]:
        """The state, beside the statements themselves, on which every rule may depend."""
        resolution, surroundings = self.resolution, self.surroundings
        imports = [key for stretch in resolution.stretches for key in stretch.importing]
        modules = None if surroundings is None else surroundings.state
        return (
            self.typing,
            self.source.filename,
            resolution.wildcard,
            resolution.reflective,
            modules,
            *imports,
        )

    @cached_property
    def _changed(self) -> frozenset[str] | None:
        """The names of the module that no longer mean the same; ``None`` if anything may have changed."""
        before = self.before
        if (
            before is None
            or len(before.state) != len(self._state)
            or not all(
                one is other or one == other for one, other in zip(before.state, self._state, strict=True)
            )
        ):
            return None
        return changed_names(before.names, self.resolution.names, self.resolution.stretches)

    def is_unchanged(self, stretch: Stretch) -> bool:
        """Return whether all that a stretch that stood in the version before may depend on is as it was, but for `fact`."""
        return self._changed is not None and self._changed.isdisjoint(stretch.used)

    @cached_property
    def moves(self) -> Moves:
        """A map from the statements of the previous version to their places in this version."""
        return Moves(() if self.before is None else self.before.stretches, self.resolution.stretches)

    def follows_error(self, stretch: Stretch) -> bool:
        """Return whether the last thing before a stretch that could be a header could not be parsed."""
        return stretch in self._after_errors

    @cached_property
    def _after_errors(self) -> frozenset[Stretch]:
        found = set()
        wrong = False
        for stretch in self.resolution.stretches if self.nodes(scenic.ErrorStatement) else ():
            if wrong:
                found.add(stretch)
            for statement in stretch.statements:
                if isinstance(statement, scenic.ErrorStatement):
                    wrong = True
                elif isinstance(statement, HEADED):
                    wrong = False
        return frozenset(found)

    # Facts about the whole program

    def fact(self, name: str) -> Any:
        """Return one of the facts below by its name, and record that it was read."""
        self.asked.add(name)
        if name not in self._facts:
            self._facts[name] = _FACTS[name](self)
        return self._facts[name]

    @property
    def broken(self) -> bool:
        """Return whether parts could not be parsed: then nothing can be reported as missing or unused."""
        found: bool = self.fact("broken")
        return found

    @property
    def attributes(self) -> frozenset[str]:
        """The names of all attributes that the program reads or writes."""
        found: frozenset[str] = self.fact("attributes")
        return found

    @property
    def stored_attributes(self) -> frozenset[str]:
        """The names of all attributes that the program writes."""
        found: frozenset[str] = self.fact("stored attributes")
        return found

    @property
    def grown(self) -> frozenset[str]:
        """The names of lists and dictionaries whose elements the program may change."""
        found: frozenset[str] = self.fact("grown")
        return found

    @property
    def given(self) -> frozenset[str]:
        """The properties that the program gives with `with`."""
        found: frozenset[str] = self.fact("given")
        return found

    @property
    def parameters(self) -> frozenset[str]:
        """The names of the global parameters that the program sets."""
        found: frozenset[str] = self.fact("parameters")
        return found

    @property
    def owners(self) -> Mapping[str, int]:
        """Numbers of classes of the program that define an attribute or method of each name."""
        found: Mapping[str, int] = self.fact("owners")
        return found

    @property
    def class_names(self) -> frozenset[str]:
        """The names of the classes that are defined at the top level."""
        found: frozenset[str] = self.fact("class names")
        return found

    # What its names mean

    def nodes(self, cls: type[ast.AST]) -> Sequence[tuple[Any, Scope]]:
        """All nodes of a class, with their scopes."""
        return self.resolution.nodes(cls)

    def nodes_around(self, node: ast.AST, cls: type[ast.AST]) -> Iterator[Any]:
        """The nodes of a class that may stand around or in a node: those near it, and maybe others."""
        return (found for stretch in self.resolution.around(node) for found, _ in stretch.nodes(cls))

    def is_cut(self, node: ast.AST) -> bool:
        """Return whether a comma separates an object from the rest of its last operand, which SC311 reports."""
        for stretch in self.resolution.around(node):
            if stretch not in self._cut:
                self._cut[stretch] = frozenset(
                    each.value.elts[0]
                    for each, _ in stretch.nodes(ast.Assign)
                    if isinstance(each.value, ast.Tuple) and each.value.elts
                )
            if node in self._cut[stretch]:
                return True
        return False

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
        reference = self.resolution.reference(name) if isinstance(name, ast.Name) else None
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
        reference = self.resolution.reference(name)
        if reference is None or reference.binding is not None or self.resolution.wildcard:
            return None
        return self.surroundings.kind_of(name.id) if name.id in self.brought else None

    def provided(self, name: ast.expr | None) -> str | None:
        """The name that an expression is, if it means what the language provides under that name."""
        if not isinstance(name, ast.Name) or self.resolution.wildcard:
            return None
        reference = self.resolution.reference(name)
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

    @property
    def unresolved(self) -> frozenset[str]:
        """The names that are read and mean nothing that is known."""
        found: frozenset[str] = self.fact("unresolved")
        return found

    def mentions(self, name: str) -> list[tuple[int, int]]:
        """Return the places where a name is read or written, in order."""
        return sorted(
            place
            for stretch in self.resolution.stretches
            if name in stretch.common("mentioned", _mentioned)
            for place in stretch.mentions[name]
        )

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


def _united(context: Context, key: str, find: Callable[[Stretch], frozenset[str]]) -> frozenset[str]:
    """Return the union of the sets found in all stretches."""
    return frozenset().union(*(each.common(key, find) for each in context.resolution.stretches))


def _attributes(context: Context) -> frozenset[str]:
    return _united(
        context, "attributes", lambda own: frozenset(node.attr for node, _ in own.nodes(ast.Attribute))
    )


def _stored_attributes(context: Context) -> frozenset[str]:
    return _united(
        context,
        "stored attributes",
        lambda own: frozenset(
            node.attr for node, _ in own.nodes(ast.Attribute) if not isinstance(node.ctx, ast.Load)
        ),
    )


_GROWING: Final = frozenset(
    {"append", "clear", "extend", "insert", "pop", "popitem", "remove", "setdefault", "update"}
)
"""Methods that change the elements of a list or dictionary."""


def _grown(context: Context) -> frozenset[str]:
    return _united(context, "grown", _grown_in)


def _grown_in(own: Stretch) -> frozenset[str]:
    called = (node.value for node, _ in own.nodes(ast.Attribute) if node.attr in _GROWING)
    stored = (node.value for node, _ in own.nodes(ast.Subscript) if not isinstance(node.ctx, ast.Load))
    return frozenset(value.id for value in (*called, *stored) if isinstance(value, ast.Name))


def _given(context: Context) -> frozenset[str]:
    return _united(
        context,
        "given",
        lambda own: frozenset(node.property for node, _ in own.nodes(scenic.SpecifierPhrase)),
    )


def _parameters(context: Context) -> frozenset[str]:
    return _united(
        context,
        "parameters",
        lambda own: frozenset(item.name for node, _ in own.nodes(scenic.Param) for item in node.items),
    )


def _ego_value(context: Context) -> ast.expr | None:
    """The value of the ego, if the program sets it just once."""
    stores = [use.node for use in context.resolution.uses("ego") if isinstance(use.node.ctx, ast.Store)]
    return context.assigned.get(stores[0]) if len(stores) == 1 else None


def _ego_members(context: Context) -> frozenset[str] | None:
    """All attributes and methods of the ego, if the program sets it just once and makes it there."""
    value = _ego_value(context)
    return context.meanings.members(value.cls) if isinstance(value, scenic.New) else None


def _owners(context: Context) -> Mapping[str, int]:
    found: Counter[str] = Counter()
    for stretch in context.resolution.stretches:
        found.update(stretch.common("owners", _owners_in))
    return found


def _owners_in(stretch: Stretch) -> Counter[str]:
    classes = (scope for scope in stretch.scopes.values() if scope.kind is ScopeKind.CLASS)
    return Counter(name for scope in classes for name in scope.bindings)


def _unresolved(context: Context) -> frozenset[str]:
    resolution = context.resolution
    return frozenset(
        name
        for name in resolution.used
        if name not in resolution.names and name not in PROVIDED and name not in context.brought
    )


class Assigned:
    """The values of names in targets of assignments, by the nodes of the names."""

    def __init__(self, resolution: Resolution) -> None:
        self._resolution = resolution
        self._known: dict[Stretch, Mapping[ast.AST, tuple[ast.expr, bool]]] = {}

    def get(self, site: ast.AST) -> ast.expr | None:
        """The value that is assigned to a name there, which is a whole target."""
        found = self._found(site)
        return found[0] if found is not None and found[1] else None

    def part(self, site: ast.AST) -> ast.expr | None:
        """The value that is assigned to a name there, also as a part of a tuple."""
        found = self._found(site)
        return None if found is None else found[0]

    def _found(self, site: ast.AST) -> tuple[ast.expr, bool] | None:
        for stretch in self._resolution.around(site):
            if stretch not in self._known:
                self._known[stretch] = _assigned_in(stretch)
            value = self._known[stretch].get(site)
            if value is not None:
                return value
        return None


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


def _assigned_in(stretch: Stretch) -> Mapping[ast.AST, tuple[ast.expr, bool]]:
    found: dict[ast.AST, tuple[ast.expr, bool]] = {}
    for node, _ in stretch.nodes(ast.Assign):
        for target in node.targets:
            found.update(_parts(target, node.value))
    for node, _ in stretch.nodes(ast.AnnAssign):
        if isinstance(node.target, ast.Name) and node.value is not None:
            found[node.target] = (node.value, True)
    return found


def _class_names(context: Context) -> frozenset[str]:
    return _united(
        context,
        "class names",
        lambda own: frozenset(name for name, kinds in own.kinds.items() if BindingKind.CLASS in kinds),
    )


_FACTS: Final[Mapping[str, Callable[[Context], Any]]] = {
    "attributes": _attributes,
    "broken": lambda context: bool(context.nodes(scenic.ErrorStatement)),
    "class names": _class_names,
    "ego members": _ego_members,
    "ego value": _ego_value,
    "given": _given,
    "grown": _grown,
    "owners": _owners,
    "parameters": _parameters,
    "stored attributes": _stored_attributes,
    "unresolved": _unresolved,
}


NodeRule = Callable[[Any, Scope, Context], Iterator[Diagnostic]]
"""A rule about one node in a scope."""

ProgramRule = Callable[[Context], Iterator[Diagnostic]]
"""A rule about a program as a whole."""


def _mentioned(stretch: Stretch) -> frozenset[str]:
    return frozenset(stretch.mentions)
