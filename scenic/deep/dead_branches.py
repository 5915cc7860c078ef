"""Branches that no scene reaches in code that runs during simulations: of `if`, `while`, interrupts, conditional expressions.

A condition over drawn values alone, which no step of a simulation changes, is built again as a node of the value graph; then
analysis decides whether the requirements leave scenes in which it holds, and scenes in which it does not.
"""

import ast
from collections.abc import Container, Iterator, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from types import CodeType
from typing import Any, Final, get_args

from scenic.analysis.contraction import contract
from scenic.analysis.facts import Fact
from scenic.compiler import tree as scenic
from scenic.compiler.compile import compile_text
from scenic.compiler.parser import parse
from scenic.compiler.traversal import parts, position, walk
from scenic.dataclass import dataclass
from scenic.deep.constant_names import PARAMETERS, Code, Settled
from scenic.graph.node import Graph, Node
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.runtime.description.outcome import Program
from scenic.runtime.ground.context import current
from scenic.runtime.program.prelude import Loader

__all__ = ["prove_branches"]

_PREFIX: Final = "_branch_"
_FILENAME: Final = "<branch>"

_INNER: Final = (*get_args(Code), ast.AsyncFunctionDef, ast.ClassDef)
"""Definitions, which are looked at by themselves."""


class _Way(StrEnum):
    """Ways on from a condition, each with what is said where it is never taken."""

    BRANCH = "the branch of this condition is never taken: it holds in no scene that reaches it"
    ELSE = "the `else` of this condition is never reached: the condition holds in every scene that reaches it"
    LOOP = "the loop of this condition is never entered: it holds in no scene that reaches it"
    INTERRUPT = "this interrupt never happens: its condition holds in no scene that reaches it"
    VALUE = "the value before this condition is never used: it holds in no scene that reaches it"
    OTHER_VALUE = "the value after the `else` of this condition is never used: the condition holds in every scene that reaches it"


_Path = tuple[tuple[ast.expr, bool], ...]


@dataclass(frozen=True, slots=True)
class _Branch:
    """One way on: the conditions that lead to it, the last of which is the one that is blamed."""

    path: _Path
    way: _Way

    @property
    def test(self) -> ast.expr:
        return self.path[-1][0]


def prove_branches(
    text: str, filename: str, program: Program, roots: Sequence[Node], facts: Sequence[Fact]
) -> tuple[Diagnostic, ...]:
    """Report the branches that no scene reaches (SC703), in program order, without sampling.

    Args:
        text: the program's text.
        filename: its file.
        program: what running it gave.
        roots: the nodes that its scenes are made of.
        facts: its requirements, which some scene meets as far as is known.

    """
    source = Source(text, filename)
    tree = parse(source.text, filename=filename).tree
    constant_values = Settled(tree, program)
    dead_branches: list[_Branch] = []
    dead: set[_Path] = set()
    for code, body in constant_values.code():
        for branch in _branches(body):
            values_of_tests = [constant_values.readings(test, code) for test, _ in branch.path]
            if not values_of_tests[-1] or any(
                branch.path[:end] in dead for end in range(len(values_of_tests))
            ):
                continue
            uses = max(map(len, values_of_tests))
            if all(
                _is_dead(branch, values_of_tests, use, program, source, roots, facts) for use in range(uses)
            ):
                dead_branches.append(branch)
                dead.add(branch.path)
    dead_branches.sort(key=lambda branch: (branch.test.lineno, branch.test.col_offset))
    return tuple(_diagnostic(branch, filename) for branch in dead_branches)


def _branches(body: Sequence[ast.stmt]) -> Iterator[_Branch]:
    """Yield all branches in the statements of a body, outer ones first."""
    stack: list[tuple[ast.AST, _Path]] = [(item, ()) for item in reversed(body)]
    while stack:
        part, path = stack.pop()
        if isinstance(part, _INNER):
            continue
        if isinstance(part, ast.If | ast.While | ast.IfExp):
            path_if_true, path_if_false = (*path, (part.test, True)), (*path, (part.test, False))
            inside, otherwise = (
                ([part.body], [part.orelse]) if isinstance(part, ast.IfExp) else (part.body, part.orelse)
            )
            if isinstance(part, ast.If):
                yield _Branch(path_if_true, _Way.BRANCH)
                is_elif = len(otherwise) == 1 and isinstance(otherwise[0], ast.If)
                if otherwise and not is_elif:
                    yield _Branch(path_if_false, _Way.ELSE)
            elif isinstance(part, ast.While):
                yield _Branch(path_if_true, _Way.LOOP)
            else:
                yield _Branch(path_if_true, _Way.VALUE)
                yield _Branch(path_if_false, _Way.OTHER_VALUE)
            stack += [(item, path_if_false) for item in reversed(otherwise)]
            stack += [(item, path_if_true) for item in reversed(inside)]
            stack.append((part.test, path))
        elif isinstance(part, scenic.Interrupt):
            path_if_true = (*path, (part.condition, True))
            yield _Branch(path_if_true, _Way.INTERRUPT)
            stack += [(item, path_if_true) for item in reversed(part.body)]
            stack.append((part.condition, path))
        else:
            stack += [(item, path) for item in reversed(parts(part))]


def _is_dead(
    branch: _Branch,
    told: Sequence[Sequence[Mapping[str, Any]]],
    use: int,
    program: Program,
    source: Source,
    roots: Sequence[Node],
    facts: Sequence[Fact],
) -> bool:
    """Return whether no scene meets the requirements and all conditions that lead to a branch."""
    parts = []
    for (test, holds), readings in zip(branch.path, told, strict=True):
        if readings:  # conditions that may change say nothing
            values = readings[use if len(readings) > 1 else 0]
            parts.append(Fact(_condition(test, holds, values, program, source), "branch", None, False, None))
    graph = Graph([*roots, *(part.node for part in parts)])
    return bool(contract(graph, [*facts, *parts]).impossible)


def _condition(
    test: ast.expr, holds: bool, values: Mapping[str, object], program: Program, source: Source
) -> Node:
    """Return the node of a condition over values of a program, or of its negation."""
    text = f"({_over_parameters(test, values, source)})"
    compilation = compile_text(f"require {text if holds else f'not {text}'}\n", filename=_FILENAME)
    assert compilation.code is not None
    parameters = {_PREFIX + name: value for name, value in values.items()}
    beside = Program(context=program.context, parameters={**program.parameters, **parameters})
    token = current.set(program.context)
    try:
        Loader(_NoModules(), program.context, beside).run(compilation.code, _FILENAME)
    finally:
        current.reset(token)
    return beside.requirements[0].condition


def _over_parameters(test: ast.expr, names: Container[str], source: Source) -> str:
    """The text of a condition with global parameters in the place of names: a program of one requirement has no others."""
    whole = source.span(test)
    lines = list(source.lines[whole.line - 1 : whole.end_line])
    lines[-1] = lines[-1][: whole.end_column]
    inner = [node for node in walk(test) if isinstance(node, ast.Name) and node.id in names]
    for node in sorted(inner, key=position, reverse=True):
        span = source.span(node)
        line = lines[span.line - whole.line]
        parameter = f"{PARAMETERS}.{_PREFIX}{node.id}"
        lines[span.line - whole.line] = line[: span.column] + parameter + line[span.end_column :]
    lines[0] = lines[0][whole.column :]
    return "\n".join(lines)


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
    return Diagnostic(
        "SC703",
        branch.way.value,
        span,
        Severity.WARNING,
        filename,
        help="the values that it compares are drawn with the scene, and the requirements decide it; remove the branch, or correct the condition",
    )
