"""The property of lowering notices what it is there for."""

import ast
from collections.abc import Callable
from types import CodeType
from typing import Any

import pytest

from fuzz.properties import Case, Violation, lowering
from scenic.compiler.lowering import lower
from scenic.compiler.scopes import Resolution

PROGRAM = """\
x = [
    1, y]
@d
def f(a):
    return a.b


class C(D):
    width: self.length
    height[additive]: 3
ego = new C at x, facing 3 deg
require f(ego) > 3 and (distance to x) < 5
scenario S(p):
    q = p
"""


def tried(
    change: Callable[[ast.Module], object], monkeypatch: pytest.MonkeyPatch, text: str = PROGRAM
) -> None:
    """Try the property on a lowering that changes what it should give."""

    def broken(tree: ast.Module, resolution: Resolution) -> ast.Module:
        module = ast.parse("")
        module.body = [*lower(tree, resolution).body]
        change(module)
        return module

    monkeypatch.setattr(lowering, "lower", broken)
    lowering.programs_can_be_compiled(Case(text, thorough=True))


def first(cls: type[ast.AST], change: Callable[[Any], object]) -> Callable[[ast.Module], object]:
    """Change the first node of a class."""
    return lambda module: change(next(node for node in ast.walk(module) if isinstance(node, cls)))


def fields(**values: object) -> Callable[[Any], object]:
    return lambda node: vars(node).update(values)


def test_the_program_is_lowered():
    found = lowering.lowered(Case(PROGRAM))
    assert found is not None
    assert len(found.tree.body) == len(found.module.body) == 6


def test_statements_with_errors_are_left_out():
    found = lowering.lowered(Case("x = 1\nreturn y\nz = undefined\n"))
    assert found is not None
    assert [type(node) for node in found.tree.body] == [ast.Assign, ast.Assign]
    assert lowering.lowered(Case("x x\n")) is None


def test_what_is_lowered_rightly_is_accepted(monkeypatch: pytest.MonkeyPatch):
    tried(lambda module: None, monkeypatch)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda module: module.body.append(ast.Pass()), "lowered Pass has no lineno"),
        (first(ast.Constant, fields(lineno=9, end_lineno=9)), "outside its statement"),
        (first(ast.Constant, fields(end_col_offset=None)), "has no end_col_offset"),
        (first(ast.Constant, fields(col_offset=99)), "ends before it starts|outside its statement"),
        (first(ast.Call, fields(end_lineno=99)), "outside its statement"),
        (lambda module: module.body.append(pass_at(99)), "in no statement"),
        (lambda module: module.body.pop(1), "no instruction is on the lines of the FunctionDef at 4:0"),
        (lambda module: module.body[1].body.__setitem__(0, pass_at(6)), "on line 6, where nothing stands"),
        (
            lambda module: module.body.__delitem__(slice(3, 4)),
            "no instruction is on the lines of the Assign at 11:0",
        ),
    ],
)
def test_wrong_places_are_noticed(
    change: Callable[[ast.Module], object], message: str, monkeypatch: pytest.MonkeyPatch
):
    with pytest.raises(Violation, match=message):
        tried(change, monkeypatch)


def pass_at(line: int) -> ast.stmt:
    return ast.Pass(lineno=line, col_offset=0, end_lineno=line, end_col_offset=0)


@pytest.mark.parametrize(
    ("change", "error"),
    [
        (first(ast.Name, fields(ctx=ast.Del())), ValueError),
        (first(ast.FunctionDef, fields(body=[])), ValueError),
        (first(ast.Assign, fields(value=None)), ValueError),
        (first(ast.Name, fields(id=1)), TypeError),
        (lambda module: module.body.extend(module.body[1].body), Violation),
    ],
)
def test_what_python_refuses_is_noticed(
    change: Callable[[ast.Module], object], error: type[Exception], monkeypatch: pytest.MonkeyPatch
):
    with pytest.raises(error):
        tried(change, monkeypatch)


@pytest.mark.parametrize(
    "text",
    [
        "def f(a, a): pass\n",
        "nonlocal x\n",
        "x = 1\nglobal x\n",
        "f(a=1, a=2)\n",
        "match x:\n case _: 1\n case 2: 3\n",
    ],
)
def test_what_python_has_against_the_program_is_no_fault(text: str):
    lowering.programs_can_be_compiled(Case(text, thorough=True))


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ((7, 7, 0, 0), "where nothing stands"),
        ((1, 1, 0, 99), "past the end of line 1"),
        ((99, 99, 0, 1), "where nothing stands"),
    ],
)
def test_instructions_elsewhere_are_noticed(place: tuple[int, int, int, int], message: str):
    case = Case(PROGRAM)
    found = lowering.lowered(case)
    assert found is not None
    odd: Any = ast.parse("x")
    line, end_line, column, end_column = place
    for node in ast.walk(odd):
        if "lineno" in node._attributes:
            vars(node).update(lineno=line, end_lineno=end_line, col_offset=column, end_col_offset=end_column)
    code: CodeType = compile(odd, "p", "exec")
    with pytest.raises(Violation, match=message):
        lowering.check_code(case, found, code)
