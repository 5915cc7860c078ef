"""Branches of `if` in behaviors that no scene reaches.

A condition over drawn values alone, which no step of a simulation changes, is built again as a node of the value graph; then
analysis decides whether the requirements leave scenes in which it holds, and scenes in which it does not.
"""

import ast
from collections.abc import Container, Iterator, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from types import CodeType
from typing import Any, Final

from scenic.analysis.contraction import contract
from scenic.analysis.facts import Fact
from scenic.compiler import tree as scenic
from scenic.compiler.compile import compile_text
from scenic.compiler.parser import parse
from scenic.compiler.traversal import walk
from scenic.compiler.unparser import unparse
from scenic.dataclass import dataclass
from scenic.graph.node import Graph, Node
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.names import LIFTED_FUNCTIONS
from scenic.language.spans import Span
from scenic.runtime.dynamics.definitions import Behavior
from scenic.runtime.program.context import current
from scenic.runtime.program.outcome import Program
from scenic.runtime.program.prelude import Loader
from scenic.runtime.values.values import is_random

__all__ = ["prove_branches"]

_PARAMETERS: Final = "globalParameters"
_PREFIX: Final = "_branch_"
_FILENAME: Final = "<branch>"

_READABLE: Final = (
    ast.Name,
    ast.Constant,
    ast.Compare,
    ast.BoolOp,
    ast.UnaryOp,
    ast.BinOp,
    ast.IfExp,
    ast.Call,
    ast.Attribute,
    scenic.Operation,
    ast.operator,
    ast.cmpop,
    ast.boolop,
    ast.unaryop,
    ast.expr_context,
)
"""Nodes that a condition may consist of."""

_INNER: Final = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)


@dataclass(frozen=True, slots=True)
class _Branch:
    """One way through an `if`: the conditions that lead to it, the last of which is the one that is blamed."""

    path: tuple[tuple[ast.expr, bool], ...]
    is_else: bool

    @property
    def test(self) -> ast.expr:
        return self.path[-1][0]


def prove_branches(
    text: str, filename: str, program: Program, roots: Sequence[Node], facts: Sequence[Fact]
) -> tuple[Diagnostic, ...]:
    """Branches that no scene reaches (SC703), in program order. Never samples.

    Args:
        text: the program's text.
        filename: its file.
        program: what running it gave.
        roots: the nodes that its scenes are made of.
        facts: its requirements, which some scene meets as far as is known.

    """
    tree = parse(text, filename=filename).tree
    definitions = [item for item in tree.body if isinstance(item, scenic.BehaviorDef)]
    found: list[Diagnostic] = []
    for definition in definitions:
        values = _Values(definition, tree, program)
        for branch in _branches(definition.body):
            told = [values.readings(test) for test, _ in branch.path]
            if not told[-1]:
                continue
            uses = max(map(len, told))
            if all(_is_dead(branch, told, use, program, roots, facts) for use in range(uses)):
                found.append(_diagnostic(branch, filename))
    return tuple(found)


def _branches(body: Sequence[ast.stmt]) -> Iterator[_Branch]:
    """All branches of the `if` statements of a body, outer ones first."""
    stack: list[tuple[ast.stmt, tuple[tuple[ast.expr, bool], ...]]] = [(item, ()) for item in reversed(body)]
    while stack:
        statement, path = stack.pop()
        if isinstance(statement, _INNER):
            continue
        if isinstance(statement, ast.If):
            taken, passed = (*path, (statement.test, True)), (*path, (statement.test, False))
            yield _Branch(taken, is_else=False)
            is_elif = len(statement.orelse) == 1 and isinstance(statement.orelse[0], ast.If)
            if statement.orelse and not is_elif:
                yield _Branch(passed, is_else=True)
            stack += [(item, passed) for item in reversed(statement.orelse)]
            stack += [(item, taken) for item in reversed(statement.body)]
            continue
        inner = [part for part in ast.iter_child_nodes(statement) if not isinstance(part, ast.expr)]
        for part in reversed(inner):
            if isinstance(part, ast.stmt):
                stack.append((part, path))
            else:  # handlers, interrupts, cases
                stack += [
                    (item, path)
                    for item in reversed(list(ast.iter_child_nodes(part)))
                    if isinstance(item, ast.stmt)
                ]


class _Values:
    """The values that names in a behavior have throughout every simulation of a scene."""

    def __init__(self, definition: scenic.BehaviorDef, tree: ast.Module, program: Program) -> None:
        self._program = program
        self._uses: list[Mapping[str, Any]] | None = None
        self._names: dict[str, Any] = {}
        self._assigned = {
            part.id
            for item in definition.body
            for part in walk(item)
            if isinstance(part, ast.Name) and not isinstance(part.ctx, ast.Load)
        }
        changed = {name for part in walk(tree) if isinstance(part, ast.Global) for name in part.names}
        arguments = definition.args
        self._parameters = {
            item.arg
            for item in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs, arguments.vararg, arguments.kwarg)
            if item is not None
        }  # fmt: skip
        kind = next((item for item in program.invocables if item._definition.name == definition.name), None)
        if kind is None or kind._definition.body is None:
            return
        scope = kind._definition.body.__globals__
        self._names = {
            name: value for name, value in scope.items() if name not in changed and _is_settled(value)
        }
        if not _is_used_inside(definition.name, tree):
            own = [item.behavior for item in program.objects if item.behavior is not None]
            if all(isinstance(item, Behavior) for item in own):
                self._uses = [item._arguments.arguments for item in own if isinstance(item, kind)]

    def readings(self, test: ast.expr) -> list[dict[str, Any]]:
        """The values of the names in a condition, for each use of the behavior; none where some may change, or are not known."""
        own: dict[str, Any] = {}
        parameters: set[str] = set()
        for part in walk(test):
            if not isinstance(part, _READABLE) or (
                isinstance(part, scenic.Operation) and None in part.operands
            ):
                return []
            if isinstance(part, ast.Attribute) and not self._is_parameter(part):
                return []
            if isinstance(part, ast.Call) and not (
                isinstance(part.func, ast.Name) and part.func.id in LIFTED_FUNCTIONS
            ):
                return []
            if not isinstance(part, ast.Name) or part.id == _PARAMETERS:
                continue
            if part.id in self._assigned:
                return []
            if part.id in self._parameters:
                parameters.add(part.id)
            elif part.id in self._names:
                own[part.id] = self._names[part.id]
            elif part.id not in LIFTED_FUNCTIONS:
                return []
        if not parameters:
            return [own]
        uses = self._uses or []
        if not all(name in use and _is_settled(use[name]) for use in uses for name in parameters):
            return []
        return [{**own, **{name: use[name] for name in parameters}} for use in uses]

    def _is_parameter(self, part: ast.Attribute) -> bool:
        return (
            isinstance(part.value, ast.Name)
            and part.value.id == _PARAMETERS
            and _is_settled(self._program.parameters.get(part.attr))
        )


def _is_settled(value: Any) -> bool:
    """Tell whether a value is drawn with the scene, or a constant."""
    return isinstance(value, bool | int | float | str) or is_random(value)


def _is_used_inside(name: str, tree: ast.Module) -> bool:
    """Tell whether code that runs in simulations may start the behavior of a name."""
    later = (scenic.BehaviorDef, scenic.MonitorDef, scenic.ScenarioDef, *_INNER)
    return any(
        isinstance(part, ast.Name) and part.id == name
        for item in tree.body
        if isinstance(item, later)
        for part in walk(item)
    )


def _is_dead(
    branch: _Branch,
    told: Sequence[Sequence[Mapping[str, Any]]],
    use: int,
    program: Program,
    roots: Sequence[Node],
    facts: Sequence[Fact],
) -> bool:
    """Tell whether no scene meets the requirements and all conditions that lead to a branch."""
    parts = []
    for (test, holds), readings in zip(branch.path, told, strict=True):
        if readings:  # conditions that may change say nothing
            values = readings[use if len(readings) > 1 else 0]
            parts.append(Fact(_condition(test, holds, values, program), "branch", None, False, None))
    graph = Graph([*roots, *(part.node for part in parts)])
    return bool(contract(graph, [*facts, *parts]).impossible)


def _condition(test: ast.expr, holds: bool, values: Mapping[str, Any], program: Program) -> Node:
    """The node of a condition over values of a program, or of its negation."""
    written = f"({unparse(_Named(values).visit(deepcopy(test)))})"
    compiled = compile_text(f"require {written if holds else f'not {written}'}\n", filename=_FILENAME)
    assert compiled.code is not None
    given = {_PREFIX + name: value for name, value in values.items()}
    beside = Program(context=program.context, parameters={**program.parameters, **given})
    token = current.set(program.context)
    try:
        Loader(_NoModules(), program.context, beside).run(compiled.code, _FILENAME)
    finally:
        current.reset(token)
    return beside.requirements[0].condition


class _Named(ast.NodeTransformer):
    """Puts global parameters in the place of names: a program of one requirement has no others."""

    def __init__(self, names: Container[str]) -> None:
        self._names = names

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id not in self._names:
            return node
        return ast.Attribute(ast.Name(_PARAMETERS, ast.Load()), _PREFIX + node.id, ast.Load())


class _NoModules:
    """Finds no modules: a condition imports none."""

    def find(self, _name: str) -> Path | None:
        return None

    def code(self, path: Path) -> CodeType:
        raise FileNotFoundError(path)


def _diagnostic(branch: _Branch, filename: str) -> Diagnostic:
    test = branch.test
    assert test.end_lineno is not None
    assert test.end_col_offset is not None
    span = Span(test.lineno, test.col_offset, test.end_lineno, test.end_col_offset)
    if branch.is_else:
        message = "the `else` of this condition is never reached: the condition holds in every scene that reaches it"
    else:
        message = "the branch of this condition is never taken: it holds in no scene that reaches it"
    return Diagnostic(
        "SC703",
        message,
        span,
        Severity.WARNING,
        filename,
        help="the values that it compares are drawn with the scene, and the requirements decide it; remove the branch, or correct the condition",
    )
