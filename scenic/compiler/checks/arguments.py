"""Arguments of calls whose callee is certain: too many, too few, unknown."""

import ast
from collections.abc import Iterator
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import Context, NodeRule
from scenic.compiler.checks.places import word_span
from scenic.compiler.scopes import Scope, ScopeKind
from scenic.language.diagnostics import Diagnostic, Label
from scenic.language.spelling import nearest

__all__ = ["RULES", "kind_of", "required_parameters"]


_KINDS: Final[dict[type[ast.AST], str]] = {
    ast.FunctionDef: "function",
    ast.AsyncFunctionDef: "function",
    ast.ClassDef: "class",
    scenic.BehaviorDef: "behavior",
    scenic.MonitorDef: "monitor",
    scenic.ScenarioDef: "scenario",
}


def kind_of(definition: ast.AST) -> str:
    """What a definition defines, in a word."""
    return _KINDS[type(definition)]


def _parameters(definition: Any) -> ast.arguments | None:
    """The parameters of what can be called like a function; ``None`` for classes."""
    if isinstance(definition, ast.ClassDef):
        return None
    empty = ast.arguments(posonlyargs=[], args=[], kwonlyargs=[], kw_defaults=[], defaults=[])
    return empty if definition.args is None else definition.args


def required_parameters(definition: Any) -> list[str]:
    """The parameters that every call must give, in order."""
    args = _parameters(definition)
    if args is None:
        return []
    positional = [*args.posonlyargs, *args.args]
    required = [arg.arg for arg in positional[: len(positional) - len(args.defaults)]]
    named = zip(args.kwonlyargs, args.kw_defaults, strict=False)
    return required + [arg.arg for arg, default in named if default is None]


def _call(node: ast.Call, _scope: Scope, context: Context) -> Iterator[Diagnostic]:
    definition: Any = context.definition(node.func)
    skip = 0
    if definition is None:
        definition = _own_method(node.func, context)
        skip = 1
    if definition is None:
        return
    args = _parameters(definition)
    if args is not None:
        yield from _arguments(node, definition, args, skip, context)


def _arguments(
    node: ast.Call, definition: Any, args: ast.arguments, skip: int, context: Context
) -> Iterator[Diagnostic]:
    name = definition.name
    title = f"the {'method' if skip else kind_of(definition)} `{name}`"
    labels = (Label(word_span(context.source, definition, name), "defined here"),)
    positional = [*args.posonlyargs, *args.args][skip:]
    by_name = {arg.arg for arg in (*args.args[max(0, skip - len(args.posonlyargs)) :], *args.kwonlyargs)}
    spread = any(isinstance(argument, ast.Starred) for argument in node.args)
    spread_names = any(keyword.arg is None for keyword in node.keywords)
    if not spread and args.vararg is None and len(node.args) > len(positional):
        count = len(positional)
        given = len(node.args)
        yield context.error(
            "SC211",
            f"{title} takes {_count(count)}, and {given} {'is' if given == 1 else 'are'} given",
            node.args[count],
            "leave out the rest, or give it by name" if args.kwonlyargs else "leave out the rest",
            labels=labels,
        )
        return
    filled = {arg.arg for arg in positional[: 0 if spread else len(node.args)]}
    wrong = False
    for keyword in node.keywords:
        if keyword.arg is None:
            continue
        place = word_span(context.source, keyword, keyword.arg)
        if keyword.arg in filled and keyword.arg in by_name:
            wrong = True
            yield context.error(
                "SC211",
                f"{title} is given `{keyword.arg}` twice, by position and by name",
                place,
                "keep one of them",
                labels=labels,
            )
        elif keyword.arg not in by_name and args.kwarg is None:
            wrong = True
            suggestion = nearest(keyword.arg, by_name - filled - {other.arg for other in node.keywords})
            yield context.error(
                "SC211",
                f"{title} has no parameter `{keyword.arg}`",
                place,
                f"did you mean `{suggestion}`?" if suggestion else f"it takes {_listed(sorted(by_name))}",
                labels=labels,
                fix=context.replacement(f"Write `{suggestion}`", place, suggestion) if suggestion else None,
            )
    if wrong or spread or spread_names:
        return
    given_names = filled | {keyword.arg for keyword in node.keywords if keyword.arg in by_name}
    missing = [name for name in required_parameters(definition)[skip:] if name not in given_names]
    if missing:
        yield context.error(
            "SC211",
            f"{title} needs {_listed(missing)}",
            node,
            f"give {'it' if len(missing) == 1 else 'them'}: {_signature(definition, skip)}",
            labels=labels,
        )


def _own_method(function: ast.expr, context: Context) -> Any:
    """The method that ``self.name`` can only mean, in a method of a class without bases that the text does not show."""
    if not (isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name)):
        return None
    binding = context.resolution.binding(function.value)
    if binding is None or binding.scope.parent is None or binding.scope.parent.kind is not ScopeKind.CLASS:
        return None
    method = binding.scope.node
    if not (
        isinstance(method, ast.FunctionDef)
        and not method.decorator_list
        and len(binding.sites) == 1
        and method.args.args
        and method.args.args[0] is binding.sites[0]
        and not method.args.posonlyargs
    ):
        return None
    name = function.attr
    # Other classes of the program may replace the method.
    owners = context.owners.get(name, [])
    if owners != [binding.scope.parent] or name in context.stored_attributes:
        return None
    sites = owners[0].bindings[name].sites
    if len(sites) != 1 or not isinstance(sites[0], ast.FunctionDef) or sites[0].decorator_list:
        return None
    found = sites[0]
    # A method that does nothing but raise an error is there to be replaced.
    abstract = isinstance(found.body[-1], ast.Raise | ast.Pass)
    return found if found.args.args and not found.args.posonlyargs and not abstract else None


def _specifier(node: scenic.Specifier, _scope: Scope, context: Context) -> Iterator[Diagnostic]:
    """``with behavior B``: the behavior is then made without arguments."""
    if node.property == "behavior" and node.operands:
        yield from _uncalled(node.operands[0], context)


def _do(node: Any, _scope: Scope, context: Context) -> Iterator[Diagnostic]:
    """``do f``, ``do f()``: only behaviors, monitors and scenarios can be run."""
    for target in node.targets:
        called = isinstance(target, ast.Call)
        definition: Any = context.definition(target.func if isinstance(target, ast.Call) else target)
        if isinstance(definition, ast.FunctionDef) and (not called or not _returns(definition, context)):
            name = definition.name
            yield context.error(
                "SC211",
                f"`do` runs behaviors and scenarios, and `{name}` is a plain function"
                + (" that returns nothing" if called else ""),
                target,
                f"call it without `do`, or define it with `behavior {name}(...):`",
                labels=(Label(word_span(context.source, definition, name), "defined here"),),
            )
        elif not called:
            yield from _uncalled(target, context)


def _uncalled(value: ast.expr | None, context: Context) -> Iterator[Diagnostic]:
    definition: Any = context.definition(value)
    if value is None or not isinstance(definition, scenic.BehaviorDef | scenic.ScenarioDef):
        return
    missing = required_parameters(definition)
    if missing:
        name = definition.name
        yield context.error(
            "SC211",
            f"the {kind_of(definition)} `{name}` needs {_listed(missing)}",
            value,
            f"call it: {_signature(definition, 0)}",
            labels=(Label(word_span(context.source, definition, name), "defined here"),),
        )


def _returns(function: ast.FunctionDef, context: Context) -> bool:
    """Whether calls of a function may give anything else than ``None``."""
    return context.resolution.scopes.get(function) in context.returning


def _count(count: int) -> str:
    return {0: "no arguments", 1: "1 argument"}.get(count, f"{count} arguments")


def _listed(names: list[str]) -> str:
    quoted = [f"`{name}`" for name in names]
    if not quoted:
        return "none by name"
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"


def _signature(definition: Any, skip: int) -> str:
    return f"`{definition.name}({', '.join(required_parameters(definition)[skip:])})`"


RULES: Final[dict[type[ast.AST], NodeRule]] = {
    ast.Call: _call,
    scenic.Do: _do,
    scenic.Specifier: _specifier,
}
