"""The code of programs without errors: its existence, and its places in the source."""

import ast
import re
import warnings
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from types import CodeType
from typing import Any, Final, NamedTuple

from fuzz.properties.case import FILENAME, Case, Property, Violation
from scenic.compiler import tree as scenic
from scenic.compiler.lowering import lower
from scenic.compiler.resolver import resolve
from scenic.compiler.scopes import Resolution
from scenic.compiler.tokens import DEDENT, ENDMARKER, INDENT, NEWLINE
from scenic.language.diagnostics import Severity
from scenic.language.spans import Span

__all__ = ["OF_TEXTS", "Lowering", "check_code", "check_places", "lowered"]

_HARMLESS: Final = frozenset({"SC202", "SC203", "SC204", "SC214", "SC404"})
"""Errors that make no difference to lowering: names that are not defined, or not yet, and values of the wrong kind."""

_COMPLAINTS: Final = (
    r"duplicate argument '.*' in function definition",
    r"keyword argument repeated: .*",
    r"name '.*' is (assigned to|used|annotated|parameter|nonlocal|local).*",
    r"annotated name '.*' can't be (global|nonlocal)",
    r"no binding for nonlocal '.*' found",
    r"nonlocal declaration not allowed at module level",
    r"import \* only allowed at module level",
    r"'(return|yield)' with value in async generator",
    r"asynchronous comprehension outside of an asynchronous function",
    r"'yield' inside .*",
    r"'yield from' inside async function",
    r"(multiple|two) starred expressions in assignment",
    r"multiple starred (expressions|names) in sequence pattern",
    r"starred assignment target must be in a list or tuple",
    r"can't use starred expression here",
    r"too many expressions in star-unpacking assignment",
    r"too many sub-patterns in sequence pattern",
    r"default 'except:' must be last",
    r"(name capture '.*'|wildcard) makes remaining patterns unreachable",
    r"alternative patterns bind different names",
    r"multiple assignments to name '.*' in pattern",
    r"attribute name repeated in class pattern: .*",
    r"mapping pattern checks duplicate key .*",
    r"assignment expression (cannot|within) .*",
    r"assignment expression cannot rebind comprehension iteration variable '.*'",
    r"comprehension inner loop cannot rebind assignment expression target '.*'",
    r"cannot (assign to|delete) .*",
    r"from __future__ imports must occur at the beginning of the file",
    r"future feature .* is not defined",
    r"not a chance",
    r"too many statically nested blocks",
    r"too many nested .*",
)
_COMPLAINT: Final = re.compile("|".join(_COMPLAINTS))
"""Complaints of Python's compiler, other than its parser, that are the fault of the program.

What stands outside of a function, or of a loop, is not among it: our own checks find that.
"""


class Lowering(NamedTuple):
    """A tree with the tree that it is lowered to."""

    tree: ast.Module
    module: ast.Module


def lowered(case: Case) -> Lowering | None:
    """Lower the program of a case without the statements of the module that have errors; ``None`` if that does not help."""
    if case.has_error:
        return None
    tree = case.result.tree
    for _ in range(3):
        resolution = resolve(tree, case.source)
        errors = _errors(resolution)
        if not errors:
            return Lowering(tree, lower(tree, resolution))
        tree = _without(tree, errors)
    return None


def _errors(resolution: Resolution) -> list[Span | None]:
    return [
        each.span
        for each in resolution.diagnostics
        if each.severity is Severity.ERROR and each.code not in _HARMLESS
    ]


def _without(tree: ast.Module, spans: Sequence[Span | None]) -> ast.Module:
    """A module without the statements on whose lines these spans begin."""
    lines = {span.line for span in spans if span is not None}
    body = [
        node
        for node in tree.body
        if lines.isdisjoint(range(_start(node)[0], (node.end_lineno or node.lineno) + 1))
    ]
    return ast.Module(body=body, type_ignores=[])


def programs_can_be_compiled(case: Case) -> None:
    """Every tree without errors lowers to code that Python compiles, and places of nodes and code are those of the program."""
    lowering = lowered(case)
    if lowering is None:
        return
    check_places(lowering)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            code = compile(lowering.module, FILENAME, "exec", dont_inherit=True)
        except SyntaxError as error:
            if not _COMPLAINT.fullmatch(error.msg):
                raise Violation(f"Python refuses it: {error.msg}, line {error.lineno}") from error
            return
    check_code(case, lowering, code)


# Places of nodes.


def check_places(found: Lowering) -> None:
    """Every node of the lowered tree lies inside the statement that it came from."""
    statements = sorted(
        ((_start(node), _end(node)) for node in ast.walk(found.tree) if isinstance(node, ast.stmt)),
        key=lambda each: (each[0], tuple(-value for value in each[1])),
    )
    stack: list[tuple[ast.AST, tuple[Any, Any] | None]] = [(found.module, None)]
    while stack:
        node, home = stack.pop()
        if "lineno" in node._attributes:
            for name in ("lineno", "col_offset", "end_lineno", "end_col_offset"):
                if not isinstance(getattr(node, name, None), int):
                    raise Violation(f"lowered {type(node).__name__} has no {name}")
            if isinstance(node, ast.stmt) and not _gathers(node):
                home = _innermost(statements, node)
            start, end = _start(node), _end(node)
            if end < start:
                raise Violation(f"lowered {_where(node)} ends before it starts")
            if home is not None and not (home[0] <= start and end <= home[1]):
                raise Violation(
                    f"lowered {_where(node)} to {end} lies outside its statement, {home[0]} to {home[1]}"
                )
        stack.extend((part, home) for part in ast.iter_child_nodes(node))


def _gathers(node: ast.stmt) -> bool:
    """Return whether a lowered statement gathers several statements of a class: its properties."""
    match node:
        case ast.Assign(targets=[ast.Name(id="__scenic_properties__")]):
            return True
    return False


def _innermost(statements: Sequence[tuple[Any, Any]], node: ast.stmt) -> tuple[Any, Any]:
    """The smallest statement around a lowered one."""
    start, end = _start(node), _end(node)
    for index in range(bisect_right(statements, start, key=lambda each: each[0]) - 1, -1, -1):
        if statements[index][1] >= end:
            return statements[index]
    raise Violation(f"lowered {_where(node)} to {end} lies in no statement")


# Places of instructions.


def check_code(case: Case, found: Lowering, code: CodeType) -> None:
    """Instructions are on lines that hold tokens, and every statement that makes code has some on its lines."""
    lines = _token_lines(case)
    lines_of_code: set[int] = set()
    for each in _codes(code):
        for line, end_line, column, end_column in each.co_positions():
            if line is None or line == 0 or (each is code and not found.module.body):
                continue
            if each is code and line == 1 and (column, end_column) in ((0, 0), (None, None)):
                # The start of the module, which is no place of the program.
                continue
            end = line if end_line is None else end_line
            lines_of_code.update(range(line, end + 1) if end - line < 1000 else (line, end))
            for one, offset in ((line, column), (end, end_column)):
                if one not in lines:
                    raise Violation(
                        f"an instruction of {each.co_name} is on line {one}, where nothing stands"
                    )
                if offset is not None and offset > case.widths[one - 1]:
                    raise Violation(
                        f"an instruction of {each.co_name} is past the end of line {one}: {offset}"
                    )
    for node in _making_code(found.tree.body):
        first, last = _start(node)[0], _end(node)[0]
        if lines_of_code.isdisjoint(range(first, last + 1)):
            raise Violation(f"no instruction is on the lines of the {_where(node)}")


def _token_lines(case: Case) -> set[int]:
    tokens = case.tokens
    found: set[int] = set()
    for kind, line, end_line in zip(tokens.kinds, tokens.lines, tokens.end_lines, strict=True):
        if kind not in (NEWLINE, INDENT, DEDENT, ENDMARKER):
            found.update(range(line, end_line + 1))
    return found


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


_ALWAYS: Final = (
    ast.Assign,
    ast.AugAssign,
    ast.Import,
    ast.ImportFrom,
    ast.FunctionDef,
    ast.AsyncFunctionDef,
    ast.ClassDef,
    ast.Delete,
    ast.Raise,
    ast.Return,
    ast.With,
    ast.For,
    scenic.Param,
    scenic.Require,
    scenic.Model,
    scenic.Simulator,
    scenic.BehaviorDef,
    scenic.ScenarioDef,
)
_ENDS: Final = (ast.Raise, ast.Return, ast.Break, ast.Continue, ast.While, ast.Match, ast.Assert)


def _making_code(block: Sequence[ast.stmt]) -> Iterator[ast.stmt]:
    """The statements of a block, and of those in it, of which it is certain that they make code."""
    for node in block:
        value = node.value if isinstance(node, ast.Expr) else None
        if isinstance(node, _ALWAYS) or isinstance(value, ast.Name | ast.Call | ast.Attribute | scenic.New):
            yield node
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef() | ast.With() | ast.For():
                yield from _making_code(node.body)
            case ast.If(test=ast.Name() | ast.Call()):
                yield from _making_code(node.body)
                yield from _making_code(node.orelse)
            case scenic.ScenarioDef(setup=list(setup)):
                yield from _making_code(setup)
        if any(isinstance(part, _ENDS) for part in _within(node)):
            # What comes after may never be reached, and is left out.
            return


def _within(node: ast.stmt) -> Iterator[ast.AST]:
    """A statement and what is in it, without what is only defined there."""
    stack: list[ast.AST] = [node]
    while stack:
        part = stack.pop()
        yield part
        if not isinstance(
            part, ast.FunctionDef | ast.AsyncFunctionDef | scenic.BehaviorDef | scenic.ScenarioDef
        ):
            stack.extend(ast.iter_child_nodes(part))


def _start(node: Any) -> tuple[int, int]:
    decorators = getattr(node, "decorator_list", None)
    start = (node.lineno, node.col_offset)
    if decorators and (decorators[0].lineno, decorators[0].col_offset) < start:
        # The `@` stands before the decorator, on its line. (Those that lowering adds stand where the definition does.)
        return (decorators[0].lineno, 0)
    return start


def _end(node: Any) -> tuple[int, int]:
    return (node.end_lineno, node.end_col_offset)


def _where(node: Any) -> str:
    return f"{type(node).__name__} at {node.lineno}:{node.col_offset}"


OF_TEXTS: Final = (Property.of(programs_can_be_compiled, one_in=2),)
