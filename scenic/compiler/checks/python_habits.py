"""Python that runs and does not mean what it means in a program of Scenic: draws of other generators, sleeping, constructors."""

import ast
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import DYNAMIC, Where, where_of
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.checks.randomness import is_random
from scenic.compiler.scopes import Scope
from scenic.language.diagnostics import Diagnostic, Edit, Fix
from scenic.language.libraries import NEEDS_MAP
from scenic.language.spans import Span
from scenic.language.statements import Place
from scenic.language.word_sets import word_set

__all__ = ["RULES", "check_maps"]

_DRAWS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "random.choice": "Uniform(*{})",
        "random.gauss": "Normal({})",
        "random.normalvariate": "Normal({})",
        "random.randint": "DiscreteRange({})",
        "random.random": "Range(0, 1)",
        "random.uniform": "Range({})",
        "numpy.random.choice": "Uniform(*{})",
        "numpy.random.normal": "Normal({})",
        "numpy.random.rand": "Range(0, 1)",
        "numpy.random.random": "Range(0, 1)",
        "numpy.random.uniform": "Range({})",
    }
)
"""Draws of Python's generators, and the distributions of the language, which take the same arguments."""
_CLOCKS: Final = word_set(
    "time.time time.monotonic time.perf_counter datetime.datetime.now datetime.datetime.today "
    "datetime.date.today"
)
_PARAMETERS: Final = {"Uniform(*{})": 1, "Range(0, 1)": 0}
"""The numbers of arguments that the replacement takes, where it is not two."""


def _full_name(function: ast.expr, context: CheckContext) -> str | None:
    """The dotted name of a function of a module that is imported: ``numpy.random.uniform`` for ``np.random.uniform``."""
    parts: list[str] = []
    while isinstance(function, ast.Attribute):
        parts.insert(0, function.attr)
        function = function.value
    if not isinstance(function, ast.Name):
        return None
    binding = context.binding(function)
    if binding is None or len(binding.sites) != 1:
        return None
    [site] = binding.sites
    if not isinstance(site, ast.alias):
        return None
    statement = context.imports[site][0] if site in context.imports else None
    if isinstance(statement, ast.ImportFrom):
        return ".".join([statement.module or "", site.name, *parts])
    return ".".join([site.name if site.asname else site.name.split(".")[0], *parts])


def _call(node: ast.Call, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``random.uniform(0, 3)``, ``np.sqrt(x)`` with a random ``x``, ``time.sleep(3)``."""
    if not isinstance(node.func, ast.Attribute | ast.Name) or context.provided(node.func) is not None:
        return
    name = _full_name(node.func, context)
    if name is None:
        return
    where = where_of(node, scope)
    at_load = where.function is None and where.place not in DYNAMIC
    if name in _DRAWS and at_load:
        yield _draw(node, name, context)
    elif name in _CLOCKS and at_load and any(context.nodes_around(node, scenic.SpecifierPhrase)):
        yield context.warning(
            "SC407",
            f"`{context.text(node.func) or name}` is asked once, while the program is loaded: all scenes get the same value, and other "
            "runs another one",
            node,
            "draw a value, `Range(low, high)`, or set a parameter: `param time = 12`",
        )
    elif name == "time.sleep" and where.place in DYNAMIC and where.function is None:
        text = context.text(node.args[0]) if len(node.args) == 1 else None
        duration = f"wait for {text or 'n'} seconds"
        alone = any(each.value is node for each in context.nodes_around(node, ast.Expr))
        yield context.warning(
            "SC305",
            "`time.sleep` stops the whole program for a while, but no time passes in the simulation",
            node,
            f"write `{duration}`",
            fix=context.replacement(f"Write `{duration}`", node, duration, certain=False)
            if alone and text
            else None,
        )
    elif (
        name.startswith("numpy.")
        and not name.startswith("numpy.random.")
        and where == Where(Place.TOP)
        and any(is_random(each, context) for each in node.args)
    ):
        yield context.error(
            "SC403",
            "functions of NumPy take no random values while the scenario is being built",
            node,
            "use the functions of the language (`sin`, `cos`, `hypot`, `max`, `min`, `x ** 0.5`), or define a function of "
            "your own with `@distributionFunction`",
        )


def _draw(node: ast.Call, name: str, context: CheckContext) -> Diagnostic:
    pattern = _DRAWS[name]
    texts = [context.text(each) for each in node.args]
    fits = len(texts) == _PARAMETERS.get(pattern, 2) and not node.keywords and all(texts)
    replacement = pattern.format(", ".join(text for text in texts if text) if fits else "...")
    return context.warning(
        "SC407",
        f"`{context.text(node.func) or name}` draws once, while the program is loaded: all scenes get the same value",
        node,
        f"write `{replacement}`",
        fix=context.replacement(f"Write `{replacement}`", node, replacement, certain=False) if fits else None,
    )


def _statement(node: ast.Expr, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC312 for ``SetBrakeAction(1)`` in a behavior, without ``take``."""
    call = node.value
    if not isinstance(call, ast.Call):
        return
    symbol = context.definition(call.func)
    definition: Any = None if symbol is None else symbol.node
    if not isinstance(definition, ast.ClassDef) or not _is_action(definition):
        return
    where = where_of(node, scope)
    if where.place in DYNAMIC and where.function is None:
        text = context.text(call) or f"{definition.name}(...)"
        span = context.source.span(node)
        yield context.warning(
            "SC312",
            f"this makes the action `{definition.name}`, and nothing takes it",
            node,
            f"write `take {text}`" if len(text) < 60 else f"write `take {definition.name}(...)`",
            fix=Fix("Insert `take`", (Edit(Span(span.line, span.column, span.line, span.column), "take "),)),
        )


def _is_action(definition: ast.ClassDef) -> bool:
    """Return whether the name of a class, or of a base of it, says that it is an action."""
    names = [definition.name, *(each.id for each in definition.bases if isinstance(each, ast.Name))]
    return len(names) > 1 and any(name.endswith("Action") for name in names)


def _annotation(node: ast.AnnAssign, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC307 for ``self.height: 3`` in a method, which Python reads as an annotation."""
    match node:
        case ast.AnnAssign(
            target=ast.Attribute() as target, annotation=ast.Constant(value=int() | float()), value=None
        ):
            text = f"{context.text(target)} = {context.text(node.annotation)}"
            yield context.warning(
                "SC307",
                "this annotates an attribute with a number, and sets nothing",
                node,
                f"write `{text}`; properties with a default are declared in the class: `{target.attr}: value`",
                fix=context.replacement(f"Write `{text}`", node, text),
            )


def _class(node: ast.ClassDef, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC307 for ``def __init__`` in a class of objects."""
    if context.class_at(node) is None:
        return
    for item in node.body:
        if not isinstance(item, ast.FunctionDef) or item.name != "__init__":
            continue
        parameters = [each.arg for each in item.args.args[1:]]
        property_name = parameters[0] if parameters else "name"
        yield context.warning(
            "SC307",
            f"`new {node.name}` gives properties, and passes no arguments to `__init__`",
            item,
            f"declare properties in the class: `{property_name}: value`, which `new {node.name} with {property_name} 3` sets",
        )


def check_maps(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC620 for a world model of roads without a parameter `map` before it."""
    models = [node for node, _ in context.nodes(scenic.Model) if node.name in NEEDS_MAP]
    if not models or not context.ego_value:
        return
    node = models[0]
    settings = [
        param for param, _ in context.nodes(scenic.Param) if any(item.name == "map" for item in param.items)
    ]
    if not settings and not (context.nodes(ast.ImportFrom) or context.nodes(ast.Import)):
        yield context.warning(
            "SC620",
            f"the world model `{node.name}` needs a map, and this program names none",
            node,
            "write `param map = localPath('town.xodr')` before this line, or give `--param map FILE` in every run",
        )
    elif settings and all(param.lineno > node.lineno for param in settings):
        yield context.warning(
            "SC620",
            f"the map is read by `model` in line {node.lineno}, before this line sets it",
            settings[0],
            "move this line before the `model` statement",
            labels=(context.label(node, "the map is read here"),),
        )


RULES: Final[dict[type[ast.AST], NodeRule]] = {
    ast.AnnAssign: _annotation,
    ast.Call: _call,
    ast.ClassDef: _class,
    ast.Expr: _statement,
}
