"""Names, and the ego, that are used at the top level before they exist."""

import ast
import sys
from bisect import bisect_right
from collections.abc import Iterator
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import in_compose
from scenic.compiler.checks.context import CheckContext
from scenic.compiler.checks.unfinished import begun_names
from scenic.compiler.places import word_span
from scenic.compiler.scopes import PROVIDED, Scope, ScopeKind
from scenic.compiler.traversal import position
from scenic.language.diagnostics import Diagnostic, Label
from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

__all__ = ["check_order"]

_DEFERRED: Final[tuple[type[ast.AST], ...]] = (
    *(getattr(scenic, name) for name, each in STATEMENTS.items() if each.later),
    *(getattr(ast, name) for name in ("TypeAlias",) if hasattr(ast, name)),
)
"""Statements whose expressions are evaluated later."""

_CONDITIONAL: Final = (*_DEFERRED, scenic.Require)
"""Statements that may read names which the module defines after them."""


_OPERATORS: Final = frozenset(name for name, each in OPERATORS.items() if each.may_read_ego)
_SPECIFIERS: Final = frozenset(name for name, each in SPECIFIERS.items() if each.may_read_ego)
"""Specifiers that may refer to the ego without naming it."""


def check_order(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC204 and SC209 for names and for ``ego`` that are read before they have a value."""
    if context.broken:
        return
    starts = [position(statement) for statement in context.tree.body]
    yield from _names(context, starts)
    yield from _ego(context, starts)


def _statement(starts: list[tuple[int, int]], node: ast.AST) -> int:
    """Return the index of the statement of the module that contains a node."""
    return bisect_right(starts, position(node)) - 1


def _names(context: CheckContext, starts: list[tuple[int, int]]) -> Iterator[Diagnostic]:
    resolution = context.resolution
    if context.wildcard or resolution.reflective or _postpones_annotations(context):
        return
    body = context.tree.body
    first: dict[str, int] = {}
    early: list[ast.Name] = []
    for name, references in resolution.uses.items():
        if name not in resolution.names or name in PROVIDED or name in context.brought:
            continue
        reads = [each.node for each in references if each.scope is resolution.module]
        first[name] = _statement(starts, resolution.names[name].first_site)
        last_line = getattr(body[first[name]], "end_lineno", None) or 0
        early += [node for node in reads if isinstance(node.ctx, ast.Load) and node.lineno <= last_line]
    reported_names: set[str] = set()
    half_typed = min(map(position, begun_names(context)), default=None)
    for node in sorted(early, key=position):
        name = node.id
        if name in reported_names or node in resolution.tolerated:
            continue
        if half_typed is not None and half_typed < position(node):
            # Names that stand alone are about to be targets, and this may be one that comes after them.
            break
        here = _statement(starts, node)
        if here < 0 or here > first[name] or isinstance(body[here], _CONDITIONAL):
            continue
        binding = resolution.names[name]
        if here == first[name]:
            # `x = x + 1`: the value is computed first.
            statement = body[here]
            if not isinstance(statement, ast.Assign) or any(
                context.assigned.get(site) is not statement.value
                for site in binding.sites
                if _statement(starts, site) == here
            ):
                continue
        if context.binding(node) is not binding:
            continue
        reported_names.add(name)
        site = binding.first_site
        yield context.error(
            "SC204",
            f"`{name}` is used before it is defined",
            node,
            "move the definition before this line",
            labels=(Label(word_span(context.source, site, name), "defined here"),),
        )


def _ego(context: CheckContext, starts: list[tuple[int, int]]) -> Iterator[Diagnostic]:
    """Report SC209 for an explicit or implicit use of the ego before the first assignment to it."""
    if context.resolution.reflective or any("ego".startswith(name.id) for name in begun_names(context)):
        return  # It may be set in ways that the text does not show, or be about to be.
    brings = (lambda _: True) if context.surroundings is None else context.surroundings.sets_ego
    if any(brings(node) for node, _ in context.nodes(scenic.Model)):
        return
    module = context.resolution.module
    assignments = [
        (reference.node, reference.scope)
        for reference in context.resolution.uses.get("ego", ())
        if not isinstance(reference.node.ctx, ast.Load)
    ]
    end = len(context.tree.body)
    for statement, _ in (*context.nodes(ast.Import), *context.nodes(ast.ImportFrom)):
        if not _is_python(statement) and brings(statement):
            # A Scenic module brings its ego along.
            end = min(end, _statement(starts, statement) - 1)
    assignments_outside = [item for item in assignments if not _in_scenario(item[1])]
    uses = list(_uses(context))
    yield from _ego_of(context, module, context.tree.body, assignments_outside, uses, end)
    scenarios = context.nodes(scenic.ScenarioDef)
    if assignments_outside or end < len(context.tree.body):
        return
    for scenario, outer in scenarios:
        # A scenario that another one runs has the ego of that one from the beginning.
        if outer is module and (len(scenarios) == 1 or scenario.name == "Main"):
            scope = context.resolution.scopes[scenario]
            setting = [item for item in assignments if scope in item[1].ancestors()]
            within = [(node, where) for node, where in uses if not in_compose(node, scenario)]
            setup = scenario.setup or []
            if setting:
                yield from _ego_of(context, scope, setup, setting, within, len(setup))


def _ego_of(
    context: CheckContext,
    scope: Scope,
    body: list[ast.stmt],
    assignments: list[tuple[ast.Name, Scope]],
    uses: list[tuple[ast.AST, Scope]],
    end: int,
) -> Iterator[Diagnostic]:
    """Report SC209 in the statements of one body up to the index ``end``, both with the scopes in which they stand."""
    if not body or any(where is not scope for _, where in assignments):
        return  # A function that sets it may be called at any time.
    starts = [position(statement) for statement in body]
    setting = min((node for node, _ in assignments), key=position, default=None)
    first = len(body) if setting is None else _statement(starts, setting)
    early = []
    for node, where in uses:
        index = _statement(starts, node)
        if where is not scope or not 0 <= index <= min(first, end) or isinstance(body[index], _DEFERRED):
            continue
        if setting is None or index < first or _in_value(body[index], node):
            early.append(node)
    if not early:
        return
    yield _too_early(context, scope, min(early, key=position), setting)


def _too_early(context: CheckContext, scope: Scope, place: ast.AST, setting: ast.Name | None) -> Diagnostic:
    other = next((name for name in scope.bindings if name != "ego" and name.lower() == "ego"), None)
    if setting is None and other is not None:
        site = scope.bindings[other].first_site
        return context.error(
            "SC209",
            f"the ego is used, and never set: `{other}` is a name like any other",
            site,
            "write `ego`",
            fix=context.renaming(site, other, "ego", certain=False) if isinstance(site, ast.Name) else None,
        )
    missing = "not set yet" if setting is not None else "never set"
    if isinstance(place, ast.Name):
        message = (
            "the ego is used before it is set" if setting is not None else "the ego is used, and never set"
        )
    else:
        message = f"`{_title(place)}` refers to the ego, which is {missing}"
    # The ego of a scenario may also come from the one that runs it.
    say = context.error if scope is context.resolution.module else context.warning
    return say(
        "SC209",
        message,
        place,
        "move `ego = ...` before this line"
        if setting is not None
        else "set it before with `ego = new Object ...`",
        labels=() if setting is None else (context.label(setting, "set here"),),
    )


def _in_scenario(scope: Scope) -> bool:
    """Return whether code in a scope sets the ego of a scenario of its own, not that of the module."""
    own = (ScopeKind.SCENARIO, ScopeKind.BEHAVIOR, ScopeKind.MONITOR)
    return any(outer.kind in own for outer in scope.ancestors())


def _uses(context: CheckContext) -> Iterator[tuple[ast.AST, Scope]]:
    """Yield every node that reads the ego, and the scope in which it stands."""
    for reference in context.resolution.uses.get("ego", ()):
        if isinstance(reference.node.ctx, ast.Load) and reference.node not in context.resolution.tolerated:
            yield reference.node, reference.scope
    for node, scope in context.nodes(scenic.Operation):
        if node.operator in _OPERATORS and _implied(node, OPERATORS[node.operator].operands):
            yield node, scope
    for node, scope in context.nodes(scenic.SpecifierPhrase):
        if node.specifier in _SPECIFIERS:
            declaration = SPECIFIERS[node.specifier]
            if declaration.reads_ego or _implied(node, declaration.operands):
                yield node, scope


def _implied(node: Any, declared: Any) -> bool:
    return any(
        value is None and operand.may_be_ego for value, operand in zip(node.operands, declared, strict=False)
    )


def _title(node: Any) -> str:
    name: str = node.operator if isinstance(node, scenic.Operation) else node.specifier
    return name


def _in_value(statement: ast.stmt, node: ast.AST) -> bool:
    """Return whether a node stands in the value of an assignment, which is computed before the ego is set."""
    return isinstance(statement, ast.Assign) and position(node) >= position(statement.value)


def _postpones_annotations(context: CheckContext) -> bool:
    return any(node.module == "__future__" for node, _ in context.nodes(ast.ImportFrom))


def _is_python(node: Any) -> bool:
    modules = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""]
    level = getattr(node, "level", 0)
    return not level and all(module.partition(".")[0] in sys.stdlib_module_names for module in modules)
