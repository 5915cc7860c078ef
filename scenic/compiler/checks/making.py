"""Expressions that look like the making or running of something and are neither: calls of classes, tuples, behaviors without `do`."""

import ast
from collections.abc import Iterator
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import DYNAMIC, where_of
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.scopes import Scope
from scenic.compiler.traversal import position
from scenic.language.diagnostics import Diagnostic, Edit, Fix
from scenic.language.spans import Span
from scenic.language.statements import Place

__all__ = ["RULES"]

_RUN: Final = {
    scenic.BehaviorDef: "behavior",
    scenic.MonitorDef: "monitor",
    scenic.ScenarioDef: "scenario",
}


def _call(node: ast.Call, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC135 for ``ego = Object(width=3)``."""
    if not isinstance(node.func, ast.Name):
        return
    if context.provided(node.func) == "workspace":
        yield context.error(
            "SC404",
            "`workspace` is the region of the scene, and the class is called `Workspace`",
            node.func,
            "write `workspace = Workspace(region)`",
            fix=context.renaming(node.func, "workspace", "Workspace"),
        )
    if context.properties(node.func) is None:
        return
    name = node.func.id
    example = f"new {name}"
    keywords = [keyword for keyword in node.keywords if keyword.arg is not None]
    if keywords:
        value = context.text(keywords[0].value) or "value"
        example += f" with {keywords[0].arg} {value if len(value) < 40 else 'value'}"
    yield context.error(
        "SC135",
        f"`{name}` is a class of objects, which are made with `new` and specifiers, not by a call",
        node,
        f"write `{example}{', ...' if len(keywords) > 1 else ''}`",
    )


def _assign(node: ast.Assign, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC311 for ``ego = new Object at 1, 2``."""
    value = node.value
    yield from _bound_simulator(node, context)
    if not (isinstance(value, ast.Tuple) and value.elts and isinstance(value.elts[0], scenic.New)):
        return
    first, rest = value.elts[0], value.elts[1:]
    if not rest or position(value) != position(first) or len(node.targets) != 1:
        return  # A comma at the end is an error of its own, and parentheses say that a tuple is meant.
    target = node.targets[0]
    if isinstance(target, ast.Tuple | ast.List) or any(isinstance(each, scenic.New) for each in rest):
        return
    ego = isinstance(target, ast.Name) and target.id == "ego"
    say = context.error if ego else context.warning
    operand = _last_operand(first)
    coordinates = None
    if operand is not None and not isinstance(operand, ast.Tuple):
        texts = [context.text(each) for each in (operand, *rest)]
        coordinates = ", ".join(text for text in texts if text) if all(texts) else None
    yield say(
        "SC311",
        "this comma makes a tuple of the object and what follows",
        Span(context.span(rest[0]).line, context.span(rest[0]).column, *_end(context, rest[0])),
        f"put the coordinates in parentheses: `({coordinates})`"
        if coordinates
        else "put parentheses around what belongs together, or write a specifier after the comma",
    )


def _bound_simulator(node: ast.Assign, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC307 for ``simulator = NewtonianSimulator()``."""
    match node:
        case ast.Assign(
            targets=[ast.Name(id="simulator") as name], value=ast.Call(func=ast.Name(id=simulator_name))
        ) if simulator_name.endswith("Simulator") and len(context.mentions("simulator")) == 1:
            text = context.text(node.value) or f"{simulator_name}(...)"
            yield context.warning(
                "SC307",
                "this binds a name, and chooses no simulator",
                name,
                f"write `simulator {text}`, a statement",
                fix=context.replacement("Write a statement", node, f"simulator {text}")
                if context.text(node.value)
                else None,
            )


def _end(context: CheckContext, node: ast.AST) -> tuple[int, int]:
    span = context.span(node)
    return span.end_line, span.end_column


def _last_operand(node: scenic.New) -> ast.expr | None:
    operands = node.specifiers[-1].operands if node.specifiers else []
    return operands[-1] if operands else None


def _statement(node: ast.Expr, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC312 for a behavior, monitor or scenario that is called without `do` or `require monitor`."""
    value = node.value
    callee = value.func if isinstance(value, ast.Call) else value
    if not isinstance(callee, ast.Name | ast.Attribute):
        return
    symbol = context.definition(callee)
    definition: Any = None if symbol is None else symbol.node
    kind = _RUN.get(type(definition))
    if kind is None:
        return
    name = definition.name
    where = where_of(node, scope)
    if kind == "monitor":
        advice = f"start it with `require monitor {name}(...)`"
    elif (
        where.place in DYNAMIC
        and where.function is None
        and (kind == "scenario") == (where.place is Place.COMPOSE)
    ):
        advice = f"run it with `do {name}(...)`"
    elif kind == "scenario":
        advice = f"run it with `do {name}(...)` in the compose block of a scenario"
    else:
        advice = f"give it to an object `with behavior {name}(...)`, or run it with `do` in another behavior"
    does = "makes" if isinstance(value, ast.Call) else "names"
    yield context.warning("SC312", f"this {does} the {kind} `{name}`, and nothing runs it", node, advice)


def check_monitors(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC114 for ``require M()`` where ``M`` is a monitor."""
    for node, _ in context.nodes(scenic.Require):
        yield from _required(node, context)


def _required(node: scenic.Require, context: CheckContext) -> Iterator[Diagnostic]:
    condition = node.condition
    if not isinstance(condition, ast.Call):
        return
    symbol = context.definition(condition.func)
    definition: Any = None if symbol is None else symbol.node
    if not isinstance(definition, scenic.MonitorDef) or node.probability is not None:
        return
    start = context.source.span(condition)
    place = Span(start.line, start.column, start.line, start.column)
    yield context.error(
        "SC114",
        f"`monitor` is missing: `{definition.name}` is a monitor, not a condition",
        condition,
        f"write `require monitor {definition.name}(...)`",
        fix=Fix("Insert `monitor`", (Edit(place, "monitor "),)),
    )


def _do(
    node: scenic.Do | scenic.DoChoose | scenic.DoShuffle, scope: Scope, context: CheckContext
) -> Iterator[Diagnostic]:
    """Report SC314 for ``do`` with what cannot be done there."""
    match where_of(node, scope).place:
        case Place.COMPOSE:
            kinds: tuple[str, ...] = ("scenario",)
        case Place.BEHAVIOR:
            kinds = ("behavior",)
        case Place.MONITOR:
            kinds = ("behavior", "monitor")
        case _:
            return
    for target in node.targets:
        for value in target.keys if isinstance(target, ast.Dict) else [target]:
            if value is not None:
                yield from _wrong(value, kinds, "do", context)


def _require_monitor(
    node: scenic.RequireMonitor, _scope: Scope, context: CheckContext
) -> Iterator[Diagnostic]:
    """Report SC314 for ``require monitor`` with something else than a monitor."""
    yield from _wrong(node.monitor, ("monitor",), "require monitor", context)


def _specifier(node: scenic.SpecifierPhrase, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC314 for ``with behavior`` with something else than a behavior."""
    if node.property == "monitor":
        text = context.text(node.operands[0]) if node.operands and node.operands[0] is not None else None
        yield context.warning(
            "SC314",
            "an object has no monitor: monitors run beside the whole simulation",
            node,
            f"write `require monitor {text or 'M()'}`, a statement",
        )
    if node.specifier == "with" and node.property == "behavior":
        for value in filter(None, node.operands[:1]):
            yield from _wrong(value, ("behavior",), "with behavior", context, classes=True)


def _wrong(
    value: ast.expr, kinds: tuple[str, ...], words: str, context: CheckContext, *, classes: bool = False
) -> Iterator[Diagnostic]:
    """Yield the errors about a value that is run as one of ``kinds``; ``classes`` if the definition itself is allowed."""
    is_call = isinstance(value, ast.Call)
    name = value.func if isinstance(value, ast.Call) else value
    symbol = context.definition(name) if isinstance(name, ast.Name | ast.Attribute) else None
    definition: Any = None if symbol is None else symbol.node
    kind = _RUN.get(type(definition))
    if kind is None:
        value_kind = None if classes else context.kind_of(value)
        if value_kind is not None and value_kind.name not in _MAY_RUN:
            yield context.error(
                "SC314",
                f"`{words}` takes a {kinds[0]}, not {value_kind.phrase}",
                value,
                f"define one: `{kinds[0]} Name():`",
            )
        return
    if kind not in kinds:
        yield context.error(
            "SC314",
            f"`{words}` takes a {kinds[0]} here, and `{definition.name}` is a {kind}",
            value,
            _PLACES_OF[kind].format(definition.name),
        )
    elif not is_call and not classes:
        yield context.error(
            "SC314",
            f"this names the {kind} `{definition.name}`, and makes none",
            value,
            f"write `{words} {definition.name}(...)`",
        )


def _new(node: scenic.New, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC401 for an object that is made while a simulation runs."""
    where = where_of(node, scope)
    if where.place in DYNAMIC and where.function is None and context.built_in(node.cls) == "Object":
        yield context.error(
            "SC401",
            f"no object can be created {where.place}",
            node,
            "create it at the top level or in the setup of a scenario; points can be created here",
        )


def _take(node: scenic.Take, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC314 for ``take SetBrakeAction``."""
    for action in node.actions:
        callee = action.func if isinstance(action, ast.Call) else action
        symbol = context.definition(callee)
        if symbol is not None and isinstance(symbol.node, scenic.BehaviorDef):
            text = context.text(callee) or "Name"
            run = text if isinstance(action, ast.Call) else f"{text}()"
            yield context.warning(
                "SC314",
                f"`take` takes actions, and does not run the behavior `{text}`",
                action,
                f"run it: `do {run}`",
                fix=_do_instead(node, context) if len(node.actions) == 1 else None,
            )
            continue
        cls = None if isinstance(action, ast.Call) else context.class_of_symbol(symbol)
        if cls is not None and cls.complete and not cls.is_scenic:
            name = cls.symbol.name
            yield context.warning(
                "SC314",
                f"this names the class `{name}`, and makes no action",
                action,
                f"write `take {context.text(action) or name}(...)`",
            )


def _do_instead(node: scenic.Take, context: CheckContext) -> Fix:
    span = context.source.span(node)
    return Fix(
        "Write `do`", (Edit(Span(span.line, span.column, span.line, span.column + len("take")), "do"),)
    )


_MAY_RUN: Final = frozenset({*_RUN.values(), "function", "class", "list", "tuple", "dictionary"})
"""Kinds of values that can be run, hold what can be run, or are reported elsewhere."""

_PLACES_OF: Final = {
    "behavior": "give it to an object `with behavior {}(...)`, or run it with `do` in another behavior",
    "monitor": "start it with `require monitor {}(...)`",
    "scenario": "run it with `do {}(...)` in the compose block of a scenario",
}


RULES: Final[dict[type[ast.AST], NodeRule]] = {
    ast.Assign: _assign,
    ast.Call: _call,
    ast.Expr: _statement,
    scenic.Do: _do,
    scenic.DoChoose: _do,
    scenic.DoShuffle: _do,
    scenic.New: _new,
    scenic.Take: _take,
    scenic.RequireMonitor: _require_monitor,
    scenic.SpecifierPhrase: _specifier,
}
