"""Code that takes time: behaviors, monitors, compose blocks, and the statements in them.

A behavior, a monitor or a compose block becomes a generator function whose first parameter is the running instance; local
names are attributes of it, so that the blocks of a ``try-interrupt`` statement, which are generator functions of their
own, share them. What a statement yields is for the simulation to act upon:

* ``take a, b`` and ``wait`` yield what the prelude makes of them;
* ``do``, ``wait for`` and ``wait until`` delegate to a generator of the prelude;
* ``try-interrupt`` delegates to the prelude with its blocks and conditions. A block returns how it ended: by ``abort``,
  ``break``, ``continue`` or ``return``, which then happens where the statement stands.
"""

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType
from typing import Any, Final, Protocol

from scenic.compiler import tree as scenic
from scenic.compiler.lowering.build import (
    at,
    constant,
    lambda_,
    name,
    parameters,
    prelude,
    prelude_call,
    rebuilt,
    start_of,
    statement,
    tuple_,
)
from scenic.compiler.lowering.conditions import Conditions
from scenic.language.statements import STATEMENTS, Effect

__all__ = ["RULES", "Blocks", "Lowerer", "definition", "plain"]


class Lowerer(Protocol):
    """The part of the lowering of a program that the rules here need."""

    blocks: "Blocks"

    def expression(self, node: ast.expr) -> ast.expr:
        """Return a lowered expression."""

    def block(self, statements: Sequence[ast.stmt]) -> list[ast.stmt]:
        """Return a lowered suite."""

    def copy(self, node: ast.AST, **changes: Any) -> Any:
        """Return a node with its fields lowered."""

    def handlers(self, nodes: Sequence[ast.ExceptHandler]) -> list[ast.ExceptHandler]:
        """Lower ``except`` clauses."""

    def specifier(self, node: scenic.SpecifierPhrase) -> ast.expr:
        """Return a lowered specifier."""

    def label(self, name: str | ast.expr | None) -> str | ast.expr | None:
        """The name of a statement, lowered if it is an expression."""

    def conditions(self) -> Conditions:
        """Return the lowering of conditions that are kept."""


class Blocks:
    """The position of the lowering in dynamic code: the running instance, and the blocks that ``break`` and
    ``return`` would leave.

    ``frames`` are of three kinds: a block of ``try-interrupt`` (the set of the ways out of it that occur), a loop
    (``None``) and a function (``False``).
    """

    def __init__(self) -> None:
        self.instances: list[str] = []
        self.frames: list[set[str] | bool | None] = []
        self._count = 0

    @property
    def instance(self) -> str:
        """The parameter that holds the running instance."""
        return self.instances[-1]

    def fresh(self, what: str) -> str:
        """A name that nothing else has."""
        self._count += 1
        return f"__{what}_{self._count}__"

    @contextmanager
    def inside(self, frame: "set[str] | bool | None") -> Iterator[None]:
        """Enter a frame for the time of the context."""
        self.frames.append(frame)
        try:
            yield
        finally:
            self.frames.pop()

    @contextmanager
    def running(self, instance: str) -> Iterator[None]:
        """Enter a definition for the time of the context."""
        self.instances.append(instance)
        try:
            with self.inside(False):
                yield
        finally:
            self.instances.pop()

    def leaves(self, *, loops: bool) -> "set[str] | None":
        """Return the block that a ``return`` (with ``loops``: ``break`` or ``continue``) here would leave, if it would."""
        for frame in reversed(self.frames):
            if isinstance(frame, set):
                return frame
            if frame is False or loops:
                return None
        return None


def definition(
    node: Any,
    *,
    decorator: str,
    parts: Sequence[ast.expr],
    arguments: ast.arguments,
    body: Sequence[ast.stmt],
) -> ast.FunctionDef:
    """Return ``@__scenic__.decorator(*parts)`` on a function."""
    mark = prelude_call(decorator, parts, node)
    start_of(mark, node)
    return _function(node.name, arguments, body, node, [mark])


def _function(
    identifier: str,
    arguments: ast.arguments,
    body: Sequence[ast.stmt],
    origin: ast.AST,
    decorators: Sequence[ast.expr] = (),
) -> ast.FunctionDef:
    fields: dict[str, Any] = {
        "name": identifier,
        "args": arguments,
        "body": list(body) or [start_of(ast.Pass(), origin)],
        "decorator_list": list(decorators),
        "returns": None,
        "type_comment": None,
    }
    if "type_params" in ast.FunctionDef._fields:  # Python 3.12
        fields["type_params"] = []
    return at(ast.FunctionDef(**fields), origin)


def guards(lowerer: Lowerer, node: Any, extra: Sequence[str]) -> list[ast.expr]:
    """Return the preconditions and invariants of a definition, two tuples of functions of the instance (and the agent)."""
    names = [(identifier, node) for identifier in (lowerer.blocks.instance, *extra)]
    kinds: dict[str, list[ast.expr]] = {"precondition": [], "invariant": []}
    for guard in node.guards:
        function = lambda_(names, lowerer.expression(guard.condition), guard.condition)
        for argument in function.args.args:
            start_of(argument, guard)
        kinds[guard.kind].append(function)
    return [tuple_(kinds[kind], node) for kind in ("precondition", "invariant")]


def compose(lowerer: Lowerer, node: scenic.ScenarioDef) -> tuple[list[ast.stmt], ast.expr]:
    """Return the function of a compose block, and an expression for it (``None`` if there is no such block)."""
    if node.compose is None:
        return [], start_of(ast.Constant(None), node)
    identifier = lowerer.blocks.fresh("compose")
    instance = start_of(ast.arg(lowerer.blocks.instance, None), node)
    function = _function(identifier, parameters([instance]), lowerer.block(node.compose), node)
    return [function], start_of(ast.Name(identifier, ast.Load()), node)


# Statements


def _instance(lowerer: Lowerer, node: ast.AST) -> ast.expr:
    return start_of(ast.Name(lowerer.blocks.instance, ast.Load()), node)


def plain(lowerer: Lowerer, node: scenic.ScenicStatement) -> ast.stmt:
    """A statement without a rule of its own: the call of a method, as `scenic.language.statements` declares it."""
    declaration = STATEMENTS[type(node).__name__]
    args = [_instance(lowerer, node)] if declaration.suspends else []
    options: dict[str, object] = {}
    for field in node._fields:
        value = getattr(node, field)
        match value:
            case scenic.Duration():
                args += _limit(lowerer, value, None)
            case ast.expr() if field == "name":
                options[field] = lowerer.label(value)
            case ast.expr():
                expression = lowerer.expression(value)
                args.append(lambda_([], expression, value) if field in declaration.later else expression)
            case list():
                args += [
                    lowerer.specifier(item)
                    if isinstance(item, scenic.SpecifierPhrase)
                    else lowerer.expression(item)
                    for item in value
                ]
            case _:
                options[field] = value
    call: ast.expr = prelude_call(declaration.function, args, node, options=options)
    if declaration.effect is not Effect.CALL:
        call = at((ast.Yield if declaration.effect is Effect.YIELD else ast.YieldFrom)(call), node)
    return statement(call, node)


def _delegate(function: str, args: Sequence[ast.expr], lowerer: Lowerer, node: ast.AST) -> ast.stmt:
    call = prelude_call(function, [_instance(lowerer, node), *args], node)
    return statement(at(ast.YieldFrom(call), node), node)


def _limit(lowerer: Lowerer, duration: scenic.Duration | None, until: ast.expr | None) -> list[ast.expr]:
    """Return the arguments that say when to stop."""
    if duration is not None:
        return [lowerer.expression(duration.value), constant(duration.unit, duration)]
    if until is not None:
        return [lambda_([], lowerer.expression(until), until), constant("until", until)]
    return []


def _do(lowerer: Lowerer, node: scenic.Do) -> ast.stmt:
    targets = tuple_([lowerer.expression(target) for target in node.targets], node)
    return _delegate("do", [targets, *_limit(lowerer, node.duration, node.until)], lowerer, node)


def _wait_until(lowerer: Lowerer, node: scenic.WaitUntil) -> ast.stmt:
    return _delegate("wait", _limit(lowerer, None, node.condition), lowerer, node)


def _terminate_when(lowerer: Lowerer, node: scenic.TerminateWhen) -> ast.stmt:
    kept = lowerer.conditions().kept(node.condition)
    options = {"simulation": node.simulation, "name": lowerer.label(node.name)}
    return statement(prelude_call("terminate_when", kept, node, options=options), node)


def _record(lowerer: Lowerer, node: scenic.Record) -> ast.stmt:
    closures = lowerer.conditions().kept(node.value)
    call = prelude_call(
        "record", closures, node, options={"moment": node.moment, "name": lowerer.label(node.name)}
    )
    for option, duration in (("every", node.every), ("after", node.after)):
        if duration is not None:
            value = tuple_(_limit(lowerer, duration, None), duration)
            call.keywords.append(at(ast.keyword(option, value), duration))
    if node.to is not None:
        call.keywords.append(at(ast.keyword("to", lowerer.expression(node.to)), node.to))
    return statement(call, node)


# Interrupts


def _try_interrupt(lowerer: Lowerer, node: scenic.TryInterrupt) -> list[ast.stmt]:
    blocks = lowerer.blocks
    exits: set[str] = set()
    functions: list[ast.stmt] = []

    def block(what: str, statements: Sequence[ast.stmt], origin: ast.AST) -> ast.expr:
        identifier = blocks.fresh(what)
        with blocks.inside(exits):
            body = lowerer.block(statements)
        functions.append(_function(identifier, parameters([]), body, origin))
        return start_of(ast.Name(identifier, ast.Load()), origin)

    main = block("body", node.body, node)
    clauses: list[ast.expr] = []
    for clause in node.interrupts:
        condition = lambda_([], lowerer.expression(clause.condition), clause.condition)
        clauses.append(tuple_([condition, block("handler", clause.body, clause)], clause))
    outcome = blocks.fresh("outcome")
    call = prelude_call("interruptible", [_instance(lowerer, node), main, tuple_(clauses, node)], node)
    delegation = at(ast.YieldFrom(call), node)
    target = start_of(ast.Name(outcome, ast.Store()), node)
    run: list[ast.stmt] = [at(ast.Assign([target], delegation), node)]
    for way in sorted(exits):
        test: ast.expr
        if way == "return":
            # What the block returned comes with the outcome.
            test = prelude_call("returned", [name(outcome, node)], node)
        else:
            way_name = start_of(prelude(way.upper(), node), node)
            test = at(ast.Compare(name(outcome, node), [ast.Is()], [way_name]), node)
        run.append(at(ast.If(test, [_go(way, outcome, lowerer, node)], []), node))
    if not node.handlers:
        # Python has no `else` without `except`.
        run += lowerer.block(node.orelse)
    if node.handlers or node.finalbody:
        run = [
            at(
                ast.Try(
                    body=run,
                    handlers=lowerer.handlers(node.handlers),
                    orelse=lowerer.block(node.orelse) if node.handlers else [],
                    finalbody=lowerer.block(node.finalbody),
                ),
                node,
            )
        ]
    return [*functions, *run]


def _go(way: str, outcome: str, lowerer: Lowerer, origin: ast.AST) -> ast.stmt:
    """Leave the statement in one of the ways in which its blocks end."""
    around = lowerer.blocks.leaves(loops=way != "return")
    if around is not None:
        around.add(way)
        return at(ast.Return(name(outcome, origin)), origin)
    if way == "return":
        return at(ast.Return(at(ast.Attribute(name(outcome, origin), "value", ast.Load()), origin)), origin)
    return at(ast.Break() if way == "break" else ast.Continue(), origin)


def _exit(lowerer: Lowerer, node: ast.Break | ast.Continue) -> ast.stmt:
    block = lowerer.blocks.leaves(loops=True)
    if block is None:
        return node
    way = "break" if isinstance(node, ast.Break) else "continue"
    block.add(way)
    return at(ast.Return(prelude(way.upper(), node)), node)


def _return(lowerer: Lowerer, node: ast.Return) -> ast.stmt:
    block = lowerer.blocks.leaves(loops=False)
    if block is None:
        lowered: ast.stmt = lowerer.copy(node)
        return lowered
    block.add("return")
    value = start_of(ast.Constant(None), node) if node.value is None else lowerer.expression(node.value)
    return at(ast.Return(prelude_call("leave", [value], node)), node)


def _abort(_lowerer: Lowerer, node: scenic.Abort) -> ast.stmt:
    return at(ast.Return(prelude("ABORT", node)), node)


def _loop(lowerer: Lowerer, node: Any) -> ast.stmt:
    if not lowerer.blocks.frames:
        lowered: ast.stmt = lowerer.copy(node)
        return lowered
    with lowerer.blocks.inside(None):
        body = lowerer.block(node.body)
    lowered = lowerer.copy(rebuilt(node, body=[]))
    return rebuilt(lowered, body=body)


RULES: Final[Mapping[type[ast.AST], Callable[[Any, Any], Any]]] = MappingProxyType(
    {
        scenic.WaitUntil: _wait_until,
        scenic.Do: _do,
        scenic.TerminateWhen: _terminate_when,
        scenic.Record: _record,
        scenic.TryInterrupt: _try_interrupt,
        scenic.Abort: _abort,
        ast.Break: _exit,
        ast.Continue: _exit,
        ast.Return: _return,
        ast.For: _loop,
        ast.While: _loop,
    }
)
"""Functions that lower statements, by the classes of their nodes, where `plain` does not do."""
