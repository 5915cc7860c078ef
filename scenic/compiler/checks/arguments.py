"""Arguments of calls whose callee is certain: too many, too few, unknown."""

import ast
from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.checks.provided import PROVIDED_PARAMETERS
from scenic.compiler.places import word_span
from scenic.compiler.scopes import Scope, ScopeKind
from scenic.compiler.semantics.symbols import Symbol, symbol_of_binding
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Label
from scenic.language.libraries import ROAD_RULES
from scenic.language.names import NAMES
from scenic.language.spans import Span
from scenic.language.spelling import nearest, related

__all__ = ["RULES", "kind_of", "required_parameters"]


_KINDS: Final[dict[type[ast.AST], str]] = {
    ast.FunctionDef: "function",
    ast.AsyncFunctionDef: "function",
    ast.ClassDef: "class",
    scenic.BehaviorDef: "behavior",
    scenic.MonitorDef: "monitor",
    scenic.ScenarioDef: "scenario",
}


_CHOICES: Final = frozenset({"Uniform"})
"""Distributions that choose from their arguments, of which there may be any number but none."""


def kind_of(definition: ast.AST) -> str:
    """Return the kind of a definition, in a word."""
    return _KINDS[type(definition)]


def _parameters(definition: Any) -> ast.arguments | None:
    """Return the parameters of what can be called like a function; ``None`` for classes."""
    if isinstance(definition, ast.ClassDef):
        return None
    empty = ast.arguments(posonlyargs=[], args=[], kwonlyargs=[], kw_defaults=[], defaults=[])
    return empty if definition.args is None else definition.args


def required_parameters(definition: object) -> list[str]:
    """Return the parameters that every call must give, in order."""
    args = _parameters(definition)
    return [] if args is None else _required(args)


def _required(args: ast.arguments) -> list[str]:
    positional = [*args.posonlyargs, *args.args]
    required = [arg.arg for arg in positional[: len(positional) - len(args.defaults)]]
    named = zip(args.kwonlyargs, args.kw_defaults, strict=False)
    return required + [arg.arg for arg, default in named if default is None]


def _call(node: ast.Call, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    callee = _known(node, context)
    if context.provided(node.func) in _CHOICES and not node.args:
        yield context.error(
            "SC211",
            f"the distribution `{context.text(node.func)}` needs something to choose from",
            node,
            "give it the options: `Uniform(1, 2)`",
        )
    elif callee is not None:
        yield from _arguments(node, callee, context)
        if callee.name == "DriveByRulesBehavior" and not callee.is_here(context):
            yield from _ignored_rules(node, context)


def _ignored_rules(node: ast.Call, context: CheckContext) -> Iterator[Diagnostic]:
    """SC401: ``DriveByRulesBehavior(ignore={'signal'})``, where there is no such rule."""
    for keyword in node.keywords:
        if keyword.arg != "ignore":
            continue
        value = keyword.value
        for item in value.elts if isinstance(value, ast.Set | ast.List | ast.Tuple) else [value]:
            if (
                isinstance(item, ast.Constant)
                and isinstance(item.value, str)
                and item.value not in ROAD_RULES
            ):
                near = nearest(item.value, list(ROAD_RULES))
                hint = f"did you mean {near!r}?" if near else f"the rules are {', '.join(ROAD_RULES)}"
                yield context.error("SC401", f"there is no rule {item.value!r} to ignore", item, hint)


class _Callee(NamedTuple):
    """The function or class that a call calls; the call itself gives ``skip`` of its parameters."""

    name: str
    kind: str
    args: ast.arguments
    symbol: Symbol | None = None
    skip: int = 0

    @property
    def title(self) -> str:
        return f"the {self.kind} `{self.name}`"

    @property
    def definition(self) -> ast.AST | None:
        return None if self.symbol is None else self.symbol.node

    def is_here(self, context: CheckContext) -> bool:
        """Return whether the program itself defines it, or the language does."""
        return self.symbol is None or self.symbol.module is context.module

    @property
    def required(self) -> list[str]:
        return _required(self.args)[self.skip :]

    @property
    def signature(self) -> str:
        return f"`{self.name}({', '.join(self.required)})`"

    def labels(self, context: CheckContext) -> tuple[Label, ...]:
        """Return labels at the definition of the callee; none if the language defines it."""
        return () if self.symbol is None else context.defined(self.symbol)


def _known(node: ast.Call, context: CheckContext) -> _Callee | None:
    """Return the callee of a call, if it is certain and defined by the program or by the language."""
    builtin_name = context.provided(node.func)
    if builtin_name is not None:
        args = PROVIDED_PARAMETERS.get(builtin_name)
        if args is None:
            return None
        return _Callee(builtin_name, NAMES[builtin_name].kind, args)
    symbol = context.definition(node.func)
    skip = 0
    if symbol is None:
        symbol = _own_method(node.func, context)
        skip = 1
    if symbol is None or symbol.node is None:
        return None
    cls = context.class_of_symbol(symbol)
    args = _parameters(symbol.node) if cls is None else cls.parameters
    if args is None:
        return None
    return _Callee(symbol.name, "method" if skip else kind_of(symbol.node), args, symbol, skip)


def _too_many(
    node: ast.Call, positional: Sequence[ast.arg], callee: _Callee, context: CheckContext
) -> Diagnostic:
    """Return the diagnostic of more positional arguments than there are parameters."""
    count, given_count = len(positional), len(node.args)
    if count == 1 and positional[0].arg in _VECTORS and given_count in (2, 3) and not node.keywords:
        return _one_vector(node, callee.title, positional[0].arg, callee, context)
    return context.error(
        "SC211",
        f"{callee.title} takes {_count(count)}, and {given_count} {'is' if given_count == 1 else 'are'} given",
        node.args[count],
        "leave out the rest, or give it by name" if callee.args.kwonlyargs else "leave out the rest",
        labels=callee.labels(context),
    )


def _keywords(
    node: ast.Call, by_name: set[str], filled: set[str], callee: _Callee, context: CheckContext
) -> Iterator[Diagnostic]:
    """Arguments by name that are given twice, or that no parameter has the name of."""
    for keyword in node.keywords:
        if keyword.arg is None:
            continue
        if keyword.arg in filled and keyword.arg in by_name:
            yield context.error(
                "SC211",
                f"{callee.title} is given `{keyword.arg}` twice, by position and by name",
                word_span(context.source, keyword, keyword.arg),
                "keep one of them",
                labels=callee.labels(context),
            )
        elif keyword.arg not in by_name and callee.args.kwarg is None:
            place = word_span(context.source, keyword, keyword.arg)
            free = by_name - filled - {other.arg for other in node.keywords if other.arg is not None}
            suggestion = nearest(keyword.arg, free) or related(keyword.arg, free)
            yield context.error(
                "SC211",
                f"{callee.title} has no parameter `{keyword.arg}`",
                place,
                f"did you mean `{suggestion}`?" if suggestion else f"it takes {_listed(sorted(by_name))}",
                labels=callee.labels(context),
                fix=context.renaming(place, keyword.arg, suggestion) if suggestion else None,
            )


def _arguments(node: ast.Call, callee: _Callee, context: CheckContext) -> Iterator[Diagnostic]:
    args, skip = callee.args, callee.skip
    positional = [*args.posonlyargs, *args.args][skip:]
    if isinstance(callee.definition, scenic.BehaviorDef) and [arg.arg for arg in positional[:1]] == ["self"]:
        return  # The definition is wrong, not the call.
    by_name = {arg.arg for arg in (*args.args[max(0, skip - len(args.posonlyargs)) :], *args.kwonlyargs)}
    spread = any(isinstance(argument, ast.Starred) for argument in node.args)
    spread_names = any(keyword.arg is None for keyword in node.keywords)
    if not spread and args.vararg is None and len(node.args) > len(positional):
        yield _too_many(node, positional, callee, context)
        return
    filled_names = {arg.arg for arg in positional[: 0 if spread else len(node.args)]}
    problems = list(_keywords(node, by_name, filled_names, callee, context))
    yield from problems
    if isinstance(callee.definition, scenic.BehaviorDef) and not spread:
        yield from _apart(node, positional, callee, context)
    if not spread:
        yield from _no_numbers(node, callee, context)
    if problems or spread or spread_names:
        return
    given_names = filled_names | {keyword.arg for keyword in node.keywords if keyword.arg in by_name}
    missing = [name for name in callee.required if name not in given_names]
    if missing:
        yield context.error(
            "SC211",
            f"{callee.title} needs {_listed(missing)}",
            node,
            f"give {'it' if len(missing) == 1 else 'them'}: {callee.signature}",
            labels=callee.labels(context),
        )


_VECTORS: Final = frozenset(
    {"direction", "location", "offset", "place", "point", "pos", "position", "target", "vector", "velocity"}
)
"""Names of parameters that take a vector."""
_PLACES: Final = frozenset({"location", "place", "point", "pos", "position"})
"""Names of parameters that always mean a place."""


def _one_vector(
    node: ast.Call, title: str, parameter: str, callee: _Callee, context: CheckContext
) -> Diagnostic:
    """Return SC211 for ``SetPositionAction(1, 2)``."""
    first, last = context.source.span(node.args[0]), context.source.span(node.args[-1])
    texts = [context.text(each) for each in node.args]
    vector = f"({', '.join(text for text in texts if text)})"
    fix = None
    if all(texts) and first.line == last.end_line:
        place = Span(first.line, first.column, last.end_line, last.end_column)
        fix = Fix("Make a vector", (Edit(place, vector),))
    return context.error(
        "SC211",
        f"{title} takes one vector as `{parameter}`, and {len(node.args)} arguments are given",
        node.args[1],
        f"put the coordinates in parentheses: `{callee.name}({vector})`",
        labels=callee.labels(context),
        fix=fix,
    )


def _apart(
    node: ast.Call, positional: list[ast.arg], callee: _Callee, context: CheckContext
) -> Iterator[Diagnostic]:
    """Report SC211 for ``WalkTo(3, 4)``, whose first parameter is a place."""
    if len(node.args) not in (2, 3) or not positional or positional[0].arg not in _PLACES:
        return
    kinds = [context.kind_of(each) for each in node.args]
    if all(kind is not None and kind.name == "number" for kind in kinds):
        yield _one_vector(node, callee.title, positional[0].arg, callee, context)


_NOT_NUMBERS: Final = frozenset(
    {"dictionary", "list", "nothing", "region", "set", "text", "tuple", "workspace"}
)


def _no_numbers(node: ast.Call, callee: _Callee, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC404 for ``FollowLaneBehavior(target_speed="fast")``: text for a parameter whose default or annotation is a number."""
    args = callee.args
    every = [*args.posonlyargs, *args.args]
    positional = every[callee.skip :]
    numeric_names = {
        each.arg
        for each in positional
        if isinstance(each.annotation, ast.Name) and each.annotation.id in ("float", "int")
    }
    if not (numeric_names or (args.defaults and isinstance(callee.definition, scenic.BehaviorDef))):
        return
    defaults = dict(
        zip(
            [each.arg for each in every[len(every) - len(args.defaults) :]],
            args.defaults,
            strict=True,
        )
    )
    arguments = dict(zip([each.arg for each in positional], node.args, strict=False))
    arguments.update((each.arg, each.value) for each in node.keywords if each.arg is not None)
    for name, value in arguments.items():
        default = defaults.get(name)
        number = default.value if isinstance(default, ast.Constant) else None
        is_default = isinstance(number, int | float) and not isinstance(number, bool)
        is_default = is_default and isinstance(callee.definition, scenic.BehaviorDef)
        is_optional = isinstance(default, ast.Constant) and number is None
        if not is_default and ((default is not None and not is_optional) or name not in numeric_names):
            continue
        kind = context.kind_of(value)
        if (
            kind is None
            or kind.name not in _NOT_NUMBERS
            or (kind.name == "nothing" and (is_optional or callee.is_here(context)))
        ):
            continue
        text = context.text(value) or ""
        plain = text.strip("\"'")
        is_number = kind.name == "text" and plain.replace(".", "", 1).isdigit()
        say = context.warning if callee.is_here(context) else context.error
        yield say(
            "SC404",
            f"{callee.title} needs a number as `{name}`, not {kind.phrase}",
            value,
            f"write `{plain}` without quotes"
            if is_number
            else "give a number" + (f"; the default is {number!r}" if is_default else ""),
            fix=context.replacement("Remove the quotes", value, plain) if is_number else None,
        )


def _own_method(function: ast.expr, context: CheckContext) -> Symbol | None:
    """Return the method that ``self.name`` can only mean, in a method of a class without bases that the text does not show."""
    if not (isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name)):
        return None
    binding = context.binding(function.value)
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
    method_binding = None if binding.scope.parent is None else binding.scope.parent.bindings.get(name)
    if method_binding is None or context.owners.get(name) != 1 or name in context.stored_attributes:
        return None
    sites = method_binding.sites
    if len(sites) != 1 or not isinstance(sites[0], ast.FunctionDef) or sites[0].decorator_list:
        return None
    definition = sites[0]
    # A method that does nothing but raise an error is there to be replaced.
    abstract = isinstance(definition.body[-1], ast.Raise | ast.Pass)
    plain = definition.args.args and not definition.args.posonlyargs and not abstract
    return symbol_of_binding(context.module, method_binding) if plain else None


def _specifier(node: scenic.SpecifierPhrase, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``with behavior B``: the behavior is then made without arguments."""
    if node.property == "behavior" and node.operands:
        yield from _uncalled(node.operands[0], context)


def _property(node: scenic.PropertyDef, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``behavior: B`` in a class."""
    if node.name == "behavior":
        yield from _uncalled(node.value, context)


def _do(node: Any, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``do f``, ``do f()``: only behaviors, monitors and scenarios can be run."""
    for target in node.targets:
        is_call = isinstance(target, ast.Call)
        function = target.func if isinstance(target, ast.Call) else target
        symbol = context.definition(function)
        definition = None if symbol is None else symbol.node
        plain = isinstance(definition, ast.FunctionDef) and not (
            is_call and (definition not in context.resolution.scopes or _returns(definition, context))
        )
        if symbol is not None and plain:
            name = symbol.name
            yield context.error(
                "SC211",
                f"`do` runs behaviors and scenarios, and `{name}` is a plain function"
                + (" that returns nothing" if is_call else ""),
                target,
                f"call it without `do`, or define it with `behavior {name}(...):`",
                labels=context.defined(symbol),
            )
        elif not is_call:
            yield from _uncalled(target, context)


def _uncalled(value: ast.expr | None, context: CheckContext) -> Iterator[Diagnostic]:
    symbol = context.definition(value)
    definition = None if symbol is None else symbol.node
    if value is None or symbol is None or not isinstance(definition, scenic.BehaviorDef | scenic.ScenarioDef):
        return
    missing = required_parameters(definition)
    if missing and missing[0] != "self":
        name = symbol.name
        yield context.error(
            "SC211",
            f"the {kind_of(definition)} `{name}` needs {_listed(missing)}",
            value,
            f"call it: `{name}({', '.join(missing)})`",
            labels=context.defined(symbol),
        )


def _returns(function: ast.FunctionDef, context: CheckContext) -> bool:
    """Return whether calls of a function may give anything else than ``None``."""
    scope = context.resolution.scopes.get(function)
    return scope is not None and any(
        cls is not ast.Return or node.value is not None
        for cls in (ast.Return, ast.Yield, ast.YieldFrom)
        for node in context.resolution.nodes_in(scope, cls)
    )


def _count(count: int) -> str:
    return {0: "no arguments", 1: "1 argument"}.get(count, f"{count} arguments")


def _listed(names: list[str]) -> str:
    quoted = [f"`{name}`" for name in names]
    if not quoted:
        return "none by name"
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"


RULES: Final[dict[type[ast.AST], NodeRule]] = {
    ast.Call: _call,
    scenic.Do: _do,
    scenic.PropertyDef: _property,
    scenic.SpecifierPhrase: _specifier,
}
