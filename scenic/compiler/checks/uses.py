"""Names that are bound in vain: never read, hidden, or bound again before they are read."""

import ast
import sys
from bisect import bisect_left
from collections.abc import Iterable, Iterator
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.arguments import kind_of
from scenic.compiler.checks.context import DEFINITIONS, CheckContext
from scenic.compiler.places import word_span
from scenic.compiler.scopes import Binding, BindingKind, Scope, ScopeKind
from scenic.compiler.traversal import position, walk
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Label
from scenic.language.names import NAMES, NameKind
from scenic.language.spans import Span
from scenic.language.spelling import is_slip

__all__ = ["check_uses"]

_PYTHON_MODULES: Final = sys.stdlib_module_names | {"numpy", "scipy", "shapely", "trimesh"}
"""Modules that are certainly no Scenic modules: importing one of those has effects, used or not."""

_HIDEABLE: Final = frozenset({NameKind.FUNCTION, NameKind.VALUE})
"""Kinds of provided names that may be hidden without a word: ordinary words are among them."""

_HIDING: Final = frozenset(
    {
        BindingKind.BEHAVIOR,
        BindingKind.CAPTURE,
        BindingKind.CLASS,
        BindingKind.EXCEPTION,
        BindingKind.FUNCTION,
        BindingKind.MONITOR,
        BindingKind.PARAMETER,
        BindingKind.SCENARIO,
        BindingKind.VARIABLE,
    }
)
"""Kinds of bindings that hide a name of the language by mistake; an import of the name is deliberate."""


def check_uses(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC205 to SC208 and SC312 for bindings that are never read, that hide others, or that are replaced."""
    resolution = context.resolution
    for scope in resolution.scopes.values():
        local = scope.kind in (ScopeKind.FUNCTION, ScopeKind.BEHAVIOR, ScopeKind.MONITOR)
        for binding in scope.bindings.values():
            if binding.name in NAMES:
                yield from _hidden(binding, context)
            if (
                local
                and binding.kinds == {BindingKind.VARIABLE}
                and binding not in resolution.read
                and not resolution.reflective
            ):
                yield from _unused(binding, scope, context)
    if resolution.reflective or context.broken:
        return
    imports = (node for cls in (ast.Import, ast.ImportFrom) for node, _ in context.nodes(cls))
    import_bindings = (resolution.sites.get(alias) for node in imports for alias in node.names)
    for binding in dict.fromkeys(each for each in import_bindings if each is not None):
        if _is_imported(binding) and binding not in resolution.read and _is_of_concern(binding, context):
            yield from _unused_import(binding, binding.scope, context)
    for block in context.blocks:
        yield from _replaced(context, block.statements)
    yield from _monitors(context)


def _monitors(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC312 for a monitor of a program, not of a library, that nothing names."""
    resolution = context.resolution
    for binding in resolution.names.values():
        if binding.kinds != {BindingKind.MONITOR} or binding in resolution.read or _is_library(context):
            continue
        if binding.name.startswith("_") or not _is_of_concern(binding, context):
            continue
        yield context.warning(
            "SC312",
            f"nothing requires the monitor `{binding.name}`, so it never runs",
            word_span(context.source, binding.first_site, binding.name),
            f"start it with `require monitor {binding.name}()`",
        )


def _hidden(binding: Binding, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC207 for a binding that hides a name of the language."""
    declaration = NAMES[binding.name]
    if declaration.kind in _HIDEABLE or not binding.kinds <= _HIDING or binding.scope.kind is ScopeKind.CLASS:
        return
    first = binding.first_site
    yield context.warning(
        "SC207",
        f"`{binding.name}` hides the {declaration.kind} of the language with that name",
        word_span(context.source, first, binding.name),
        "use another name",
    )


def _is_imported(binding: Binding) -> bool:
    return binding.kinds <= {BindingKind.MODULE, BindingKind.IMPORTED}


def _is_of_concern(binding: Binding, context: CheckContext) -> bool:
    """Return whether it would be a mistake not to read a binding."""
    # What is assigned to the word of a guard was meant to be compared, as the parser says.
    if binding.name.startswith("_") or binding.name in scenic.GUARDS:
        return False
    # It may be another name that is wrong.
    own = binding.name
    return not any(
        is_slip(name, own) or name.startswith(own) or own.startswith(name) for name in context.unresolved
    )


def _unused(binding: Binding, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC205 for a variable that is never read."""
    if (
        # The variables of behaviors and monitors can be read from outside, as attributes.
        (scope.kind is ScopeKind.FUNCTION or binding.name not in context.attributes)
        and all(_plain(context.assigned.get(site)) for site in binding.sites)
        and not context.broken
        and _is_of_concern(binding, context)
    ):
        first = binding.first_site
        yield context.warning(
            "SC205",
            f"the variable `{binding.name}` is never read",
            first,
            f"remove it, or call it `_{binding.name}` if that is meant",
        )


def _plain(value: ast.expr | None) -> bool:
    """Return whether a value is assigned to a name alone, and is none of those whose making alone has a purpose."""
    return value is not None and not isinstance(value, scenic.New)


def _unused_import(binding: Binding, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    if len(binding.sites) != 1 or scope.kind is ScopeKind.CLASS or binding.name in _exported(context):
        return
    [site] = binding.sites
    entry = context.imports.get(site)
    if not isinstance(site, ast.alias) or entry is None or site.asname == site.name:
        return
    statement, is_guarded, _ = entry
    if is_guarded or not _has_no_effects(statement, site, context):
        return
    if scope is context.resolution.module and _is_library(context):
        return  # Others may import it from here.
    span = context.source.span(site)
    yield context.warning(
        "SC206",
        f"`{binding.name}` is imported and never used",
        word_span(context.source, site, binding.name.partition(".")[0]),
        "remove the import",
        fix=Fix("Remove the import", (_removal(statement, site, span, context),)),
    )


def _is_library(context: CheckContext) -> bool:
    """Return whether a file defines things and makes no scene: then others may take from it what it imports."""
    module = context.resolution.module
    return any(isinstance(statement, DEFINITIONS) for statement in context.tree.body) and not (
        bool(context.nodes(scenic.ScenarioDef))
        or any(scope is module for _, scope in context.nodes(scenic.New))
        or any(
            not isinstance(reference.node.ctx, ast.Load)
            for reference in context.resolution.uses.get("ego", ())
        )
    )


def _has_no_effects(statement: Any, site: ast.alias, context: CheckContext) -> bool:
    """Return whether nothing is lost without this name: not even the objects that importing a Scenic module creates."""
    if isinstance(statement, ast.Import):
        return site.name.partition(".")[0] in _PYTHON_MODULES
    module = statement.module or ""
    if module == "__future__":
        return False
    if not statement.level and module.partition(".")[0] in _PYTHON_MODULES:
        return True
    # The module is imported all the same for the sake of another name.
    others = (context.resolution.sites.get(other) for other in statement.names if other is not site)
    return any(other is not None and other in context.resolution.read for other in others)


def _removal(statement: Any, site: ast.alias, span: Span, context: CheckContext) -> Edit:
    """Return the edit that removes one name of an import, or the whole statement if it has no other name."""
    names = statement.names
    if len(names) == 1:
        whole = context.source.span(statement)
        line = context.source.line(whole.end_line)
        before = context.source.line(whole.line)[: whole.column]
        alone = not (before.strip() or line[whole.end_column :].strip())
        if whole.line > 1 and context.source.line(whole.line - 1).endswith("\\"):
            # It goes on from the line before.
            alone = False
        owner = context.imports[site][2]
        if alone and len(owner) > 1 and whole.end_line < len(context.source.lines):
            return Edit(Span(whole.line, 0, whole.end_line + 1, 0), "")
        return Edit(whole, "pass")
    index = names.index(site)
    if index + 1 < len(names):
        following = context.source.span(names[index + 1])
        return Edit(Span(span.line, span.column, following.line, following.column), "")
    previous = context.source.span(names[index - 1])
    return Edit(Span(previous.end_line, previous.end_column, span.end_line, span.end_column), "")


def _exported(context: CheckContext) -> set[str]:
    """The names in ``__all__``."""
    binding = context.resolution.names.get("__all__")
    if binding is None:
        return set()
    return {
        part.value
        for site in binding.sites
        for part in ast.walk(context.assigned.get(site) or ast.Pass())
        if isinstance(part, ast.Constant) and isinstance(part.value, str)
    }


def _names_read_first(statement: object) -> frozenset[str]:
    """The names that a definition reads before it binds its own: in bases and defaults."""
    arguments = getattr(statement, "args", None)
    values = [*getattr(statement, "bases", ()), *(each.value for each in getattr(statement, "keywords", ()))]
    if arguments is not None:
        values += [each for each in (*arguments.defaults, *arguments.kw_defaults) if each is not None]
    return frozenset(part.id for value in values for part in walk(value) if isinstance(part, ast.Name))


def _replaced(context: CheckContext, statements: Iterable[ast.stmt]) -> Iterator[Diagnostic]:
    """Report SC208 for two definitions of one name in one block, without a use between them."""
    last: dict[str, Any] = {}
    for statement in statements:
        if not isinstance(statement, DEFINITIONS):
            continue
        name = statement.name
        first = last.get(name)
        last[name] = statement
        if first is None or name == "_":
            continue
        if any(getattr(node, "decorator_list", None) for node in (first, statement)):
            continue
        mentions = context.mentions(name)
        following = bisect_left(mentions, position(first))
        if following < len(mentions) and mentions[following] < position(statement):
            continue
        if name in _names_read_first(statement):
            continue
        yield context.warning(
            "SC208",
            f"this replaces the {kind_of(first)} `{name}`, which has not been used",
            word_span(context.source, statement, name),
            "remove one of the definitions, or use another name",
            labels=(Label(word_span(context.source, first, name), "first defined here"),),
        )
