"""Name resolution: the scope that each name of a program belongs to.

`resolve` also runs the static checks, so its result holds everything that can be said about names and places without
running the program. It uses an explicit stack, so that no depth of nesting is too much for it.
"""

import ast
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks import CheckContext, check
from scenic.compiler.scopes import (
    Binding,
    BindingKind,
    Reference,
    Resolution,
    Scope,
    ScopeKind,
)
from scenic.compiler.semantics.modules import Module
from scenic.compiler.surroundings import SurroundingsOf
from scenic.compiler.traversal import FIELDS, parts, walk
from scenic.language.garbage import no_garbage_collection
from scenic.language.names import RESERVED, TRACKED
from scenic.language.source import Source

__all__ = ["bind", "resolve", "resolve_within"]


def resolve(tree: ast.Module, source: Source) -> Resolution:
    """Bind every name of a module and check names, placement and declarations.

    Never raises on any tree that the parser makes; what is wrong is in ``diagnostics``, ordered by place.
    """
    return resolve_within(tree, source, None)[0]


def resolve_within(
    tree: ast.Module,
    source: Source,
    surroundings_of: SurroundingsOf | None,
    resolution: Resolution | None = None,
    go_on: Callable[[], None] = lambda: None,
    typing: bool = False,
) -> tuple[Resolution, CheckContext]:
    """Bind and check the names of a module, with what ``surroundings_of`` finds out about its imports.

    Also returns what further checks need. ``resolution`` are the names of the tree, if they are bound already. ``go_on``
    is called now and then, and may raise to stop. ``typing`` says that somebody is writing the program, so that what a half-typed line may still bind is not missed.
    """
    with no_garbage_collection():
        bound = bind(tree) if resolution is None else resolution
        module = Module(source, tree, bound, is_scenic=True, broken=bool(bound.nodes(scenic.ErrorStatement)))
        surroundings = None if surroundings_of is None else surroundings_of(module)
        context = CheckContext(module, surroundings, typing=typing)
        diagnostics = check(context, go_on)
    return bound.with_findings(diagnostics, wildcard=context.wildcard), context


def bind(tree: ast.Module) -> Resolution:
    """Bind every name of a module, of Scenic or of Python, without any check: ``diagnostics`` stays empty."""
    with no_garbage_collection():
        return _Collector(tree).resolution()


_Event = tuple[Scope, str, BindingKind, ast.AST]
"""A name that is bound in a scope, in what way, and by which node."""
_Task = tuple[ast.AST, Scope]


class _Collector:
    """Walks a module once and notes scopes, bindings and uses of names."""

    def __init__(self, tree: ast.Module) -> None:
        self._module = Scope(ScopeKind.MODULE, "<module>", tree, None)
        self._scopes: dict[ast.AST, Scope] = {tree: self._module}
        self._events: list[_Event] = []
        self._uses: list[tuple[ast.Name, Scope]] = []
        self._nonlocals: dict[ast.AST, Scope] = {}
        self._plain_targets: set[ast.AST] = set()
        self._nodes: dict[type[ast.AST], list[tuple[Any, Scope]]] = defaultdict(list)
        self._pending: list[tuple[Scope, list[Any]]] = [(self._module, list(tree.body))]
        self._wildcard = False
        self._tolerated: set[ast.AST] = set()
        """Names read where a ``NameError`` is caught."""

    def _walk(self) -> None:
        """Visit every node once, scope by scope. Most nodes belong to the scope of what they are part of."""
        pending = self._pending
        handlers, fields, nodes, uses = _HANDLERS, FIELDS, self._nodes, self._uses
        while pending:
            scope, stack = pending.pop()
            while stack:
                node = stack.pop()
                cls = node.__class__
                if cls is ast.Name:
                    uses.append((node, scope))
                    if node.ctx.__class__ is not ast.Load and node not in self._plain_targets:
                        self._events.append((scope, node.id, BindingKind.VARIABLE, node))
                    continue
                if cls is ast.Constant:
                    continue
                nodes[cls].append((node, scope))
                handler = handlers.get(cls)
                if handler is not None:
                    for part, owner in handler(self, node, scope):
                        if owner is scope:
                            stack.append(part)
                        else:
                            pending.append((owner, [part]))
                    continue
                # What is no node (an absent part, a name) has no fields.
                names = fields.get(cls)
                if not names:
                    continue
                values = node.__dict__
                for field in names:
                    part = values.get(field)
                    if part.__class__ is list:
                        stack.extend(part)
                    elif part is not None:
                        stack.append(part)

    def resolution(self) -> Resolution:
        """Visit all nodes, and return what has been collected."""
        self._walk()
        bound = {event[:2] for event in self._events}
        reserved_names: list[tuple[str, ast.AST]] = []
        for event in self._events:
            _, name, _, site = event
            if name in RESERVED:
                reserved_names.append((name, site))
            else:
                self._bind(event, bound)
        references: dict[ast.AST, Reference] = {}
        mentions: defaultdict[str, list[Reference]] = defaultdict(list)
        read: set[Binding] = set()
        meanings: dict[tuple[Scope, str], Binding | None] = {}
        for node, scope in self._uses:
            name = node.id
            key = (scope, name)
            if key not in meanings:
                meanings[key] = scope.lookup(name)
            binding = meanings[key]
            # Without a call in Python, of which there would be one for each name.
            reference = tuple.__new__(Reference, (node, scope, binding))
            references[node] = reference
            mentions[name].append(reference)
            if binding is not None and node.ctx.__class__ is ast.Load:
                read.add(binding)
        resolution = Resolution(
            self._module,
            references,
            mentions,
            read,
            self._scopes,
            self._nonlocals,
            self._nodes,
            self._tolerated,
            reserved_names,
            self._wildcard,
        )
        resolution.wildcard = self._wildcard or resolution.rebinding
        return resolution

    def _bind(self, event: _Event, bound: set[tuple[Scope, str]]) -> None:
        """Bind a name in the scope that its declarations name."""
        scope, name, kind, site = event
        if name in scope.global_names:
            scope = self._module
        elif name in scope.nonlocal_names:
            scope = next(
                (
                    outer
                    for outer in scope.ancestors()
                    if name not in outer.nonlocal_names
                    and outer.kind not in (ScopeKind.CLASS, ScopeKind.MODULE)
                    and (outer, name) in bound
                ),
                scope,
            )
        binding = scope.bindings.get(name)
        if binding is None:
            binding = scope.bindings[name] = Binding(name, scope)
        binding.sites.append(site)
        binding.kinds.add(kind)

    # Pieces

    def _open(self, kind: ScopeKind, name: str, node: ast.AST, parent: Scope) -> Scope:
        scope = Scope(kind, name, node, parent)
        self._scopes[node] = scope
        return scope

    def _note(self, scope: Scope, name: str | None, kind: BindingKind, site: ast.AST) -> None:
        if name:
            self._events.append((scope, name, kind, site))

    def _parameters(self, args: ast.arguments, outer: Scope, inner: Scope) -> Iterator[_Task]:
        """Binds parameters in ``inner``; defaults and annotations belong to ``outer``."""
        every = [*args.posonlyargs, *args.args, args.vararg, *args.kwonlyargs, args.kwarg]
        for arg in every:
            if arg is not None:
                self._note(inner, arg.arg, BindingKind.PARAMETER, arg)
                if arg.annotation is not None:
                    yield arg.annotation, outer
        for default in (*args.defaults, *args.kw_defaults):
            if default is not None:
                yield default, outer

    def _type_parameters(self, node: Any, scope: Scope) -> tuple[Scope, list[_Task]]:
        """Return the scope for what follows a definition's name, and the work that its type parameters make."""
        parameters: list[Any] = getattr(node, "type_params", None) or []
        if not parameters:
            return scope, []
        inner = Scope(ScopeKind.TYPE_PARAMETERS, getattr(node.name, "id", node.name), node, scope)
        tasks: list[_Task] = []
        for parameter in parameters:
            self._note(inner, parameter.name, BindingKind.TYPE_PARAMETER, parameter)
            tasks.extend((child, inner) for child in parts(parameter))
        return inner, tasks

    # Definitions

    def function(self, node: Any, scope: Scope) -> Iterable[_Task]:
        self._note(scope, node.name, BindingKind.FUNCTION, node)
        outer, tasks = self._type_parameters(node, scope)
        inner = self._open(ScopeKind.FUNCTION, node.name, node, outer)
        yield from ((decorator, scope) for decorator in node.decorator_list)
        yield from tasks
        yield from self._parameters(node.args, outer, inner)
        if node.returns is not None:
            yield node.returns, outer
        yield from ((statement, inner) for statement in node.body)

    def anonymous_function(self, node: ast.Lambda, scope: Scope) -> Iterable[_Task]:
        inner = self._open(ScopeKind.LAMBDA, "<lambda>", node, scope)
        yield from self._parameters(node.args, scope, inner)
        yield node.body, inner

    def class_definition(self, node: Any, scope: Scope) -> Iterable[_Task]:
        self._note(scope, node.name, BindingKind.CLASS, node)
        outer, tasks = self._type_parameters(node, scope)
        inner = self._open(ScopeKind.CLASS, node.name, node, outer)
        yield from ((decorator, scope) for decorator in node.decorator_list)
        yield from tasks
        yield from ((base, outer) for base in node.bases)
        yield from ((keyword.value, outer) for keyword in node.keywords)
        yield from ((statement, inner) for statement in node.body)

    def property_definition(self, node: scenic.PropertyDef, scope: Scope) -> Iterable[_Task]:
        inner = self._open(ScopeKind.PROPERTY, node.name, node, scope)
        self._note(inner, "self", BindingKind.SELF, node)
        yield node.value, inner

    def behavior(self, node: scenic.BehaviorDef, scope: Scope) -> Iterable[_Task]:
        self._note(scope, node.name, BindingKind.BEHAVIOR, node)
        inner = self._open(ScopeKind.BEHAVIOR, node.name, node, scope)
        self._note(inner, "self", BindingKind.SELF, node)
        yield from self._parameters(node.args, scope, inner)
        yield from ((guard, inner) for guard in node.guards)
        yield from ((statement, inner) for statement in node.body)

    def monitor(self, node: scenic.MonitorDef, scope: Scope) -> Iterable[_Task]:
        self._note(scope, node.name, BindingKind.MONITOR, node)
        inner = self._open(ScopeKind.MONITOR, node.name, node, scope)
        yield from self._parameters(node.args, scope, inner)
        yield from ((statement, inner) for statement in node.body)

    def scenario(self, node: scenic.ScenarioDef, scope: Scope) -> Iterable[_Task]:
        self._note(scope, node.name, BindingKind.SCENARIO, node)
        inner = self._open(ScopeKind.SCENARIO, node.name, node, scope)
        if node.args is not None:
            yield from self._parameters(node.args, scope, inner)
        yield from ((guard, inner) for guard in node.guards)
        yield from ((statement, inner) for statement in (*(node.setup or ()), *(node.compose or ())))

    def type_alias(self, node: Any, scope: Scope) -> Iterable[_Task]:
        outer, tasks = self._type_parameters(node, scope)
        yield node.name, scope
        yield from tasks
        yield node.value, outer

    # Expressions

    def comprehension(self, node: Any, scope: Scope) -> Iterable[_Task]:
        inner = self._open(ScopeKind.COMPREHENSION, "<comprehension>", node, scope)
        for index, generator in enumerate(node.generators):
            # The first iterable is evaluated where the comprehension stands.
            yield generator.iter, inner if index else scope
            yield generator.target, inner
            yield from ((test, inner) for test in generator.ifs)
        if isinstance(node, ast.DictComp):
            yield node.key, inner
            yield node.value, inner
        else:
            yield node.elt, inner

    def walrus(self, node: ast.NamedExpr, scope: Scope) -> Iterable[_Task]:
        owner = next(outer for outer in scope.ancestors() if outer.kind is not ScopeKind.COMPREHENSION)
        self._note(owner, node.target.id, BindingKind.VARIABLE, node.target)
        self._uses.append((node.target, scope))
        yield node.value, scope

    # Statements

    def assignment(self, node: ast.Assign, scope: Scope) -> Iterable[_Task]:
        if len(node.targets) == 1 and isinstance(node.targets[0], ast.Name) and node.targets[0].id in TRACKED:
            self._plain_targets.add(node.targets[0])
        yield node.value, scope
        yield from ((target, scope) for target in node.targets)

    def annotation(self, node: ast.AnnAssign, scope: Scope) -> Iterable[_Task]:
        if isinstance(node.target, ast.Name) and not node.simple and node.value is None:
            # As in Python, `(x): int` binds nothing.
            self._plain_targets.add(node.target)
        return [(child, scope) for child in parts(node)]

    def importation(self, node: ast.Import, scope: Scope) -> Iterable[_Task]:
        for alias in node.names:
            name = alias.asname or alias.name.partition(".")[0]
            self._note(scope, name, BindingKind.MODULE, alias)
        return ()

    def import_from(self, node: ast.ImportFrom, scope: Scope) -> Iterable[_Task]:
        for alias in node.names:
            if alias.name == "*":
                self._wildcard = True
            else:
                self._note(scope, alias.asname or alias.name, BindingKind.IMPORTED, alias)
        return ()

    def model(self, _node: scenic.Model, _scope: Scope) -> Iterable[_Task]:
        self._wildcard = True
        return ()

    def global_declaration(self, node: ast.Global, scope: Scope) -> Iterable[_Task]:
        if scope is not self._module:
            scope.global_names.update(node.names)
        return ()

    def nonlocal_declaration(self, node: ast.Nonlocal, scope: Scope) -> Iterable[_Task]:
        if scope is not self._module:
            scope.nonlocal_names.update(node.names)
        self._nonlocals[node] = scope
        return ()

    def handler(self, node: ast.ExceptHandler, scope: Scope) -> Iterable[_Task]:
        self._note(scope, node.name, BindingKind.EXCEPTION, node)
        return [(child, scope) for child in parts(node)]

    def capture(self, node: Any, scope: Scope) -> Iterable[_Task]:
        self._note(
            scope, getattr(node, "rest", None) or getattr(node, "name", None), BindingKind.CAPTURE, node
        )
        return [(child, scope) for child in parts(node)]

    def attempt(self, node: Any, scope: Scope) -> Iterable[_Task]:
        if any(_catches_name_errors(handler) for handler in node.handlers):
            for statement in node.body:
                self._tolerated.update(part for part in walk(statement) if isinstance(part, ast.Name))
        return [(child, scope) for child in parts(node)]


def _catches_name_errors(handler: ast.ExceptHandler) -> bool:
    if handler.type is None:
        return True
    types = handler.type.elts if isinstance(handler.type, ast.Tuple) else [handler.type]
    return any(
        isinstance(type_, ast.Name) and type_.id in ("NameError", "Exception", "BaseException")
        for type_ in types
    )


def _handlers() -> Mapping[type[ast.AST], Callable[[_Collector, Any, Scope], Iterable[_Task]]]:
    table: dict[type[ast.AST], Callable[[_Collector, Any, Scope], Iterable[_Task]]] = {
        ast.FunctionDef: _Collector.function,
        ast.AsyncFunctionDef: _Collector.function,
        ast.Lambda: _Collector.anonymous_function,
        ast.ClassDef: _Collector.class_definition,
        scenic.PropertyDef: _Collector.property_definition,
        scenic.BehaviorDef: _Collector.behavior,
        scenic.MonitorDef: _Collector.monitor,
        scenic.ScenarioDef: _Collector.scenario,
        scenic.Model: _Collector.model,
        ast.ListComp: _Collector.comprehension,
        ast.SetComp: _Collector.comprehension,
        ast.DictComp: _Collector.comprehension,
        ast.GeneratorExp: _Collector.comprehension,
        ast.NamedExpr: _Collector.walrus,
        ast.AnnAssign: _Collector.annotation,
        ast.Assign: _Collector.assignment,
        ast.Import: _Collector.importation,
        ast.ImportFrom: _Collector.import_from,
        ast.Global: _Collector.global_declaration,
        ast.Nonlocal: _Collector.nonlocal_declaration,
        ast.ExceptHandler: _Collector.handler,
        ast.MatchAs: _Collector.capture,
        ast.MatchStar: _Collector.capture,
        ast.MatchMapping: _Collector.capture,
        ast.Try: _Collector.attempt,
        ast.TryStar: _Collector.attempt,
        scenic.TryInterrupt: _Collector.attempt,
    }
    if hasattr(ast, "TypeAlias"):  # Python 3.12
        table[ast.TypeAlias] = _Collector.type_alias
    return MappingProxyType(table)


_HANDLERS: Final = _handlers()
