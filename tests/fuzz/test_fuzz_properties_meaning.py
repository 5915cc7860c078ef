"""The properties that compare with something else notice what they are there for.

Those are the text for tokens, Python for what is Python, the table of precedence for operators, the tree for its code.
"""

import ast
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from fuzz.properties import (
    Case,
    Violation,
    columns,
    content,
    forms,
    neighbours,
    parsers,
    python,
    tokens,
)
from scenic.compiler import tree as scenic
from scenic.compiler.parser import ParseResult, parse
from scenic.compiler.scopes import Scope, ScopeKind
from scenic.language.spans import Span
from tests.each import each

TEXTS = [
    "",
    "x = f(a, *b, c=1)[1:2]  # é\n",
    "é = '😀' ; x = f'{é!r:>{x}}{{}}'\n",
    "def f(a, b=[y for y in x], *, c: int=1): return lambda d: (a, d, f)\n",
    "class C:\n    x = 1\n    def f(self): return x\n    y = [x for x in x]\n",
    "require (a implies b) and not (always c) until d or e\n",
    "x = (a + b) * c - (d - e) ** f if not visible g else a < b is not c\n",
    "x = distance to a from b + c relative to d offset along e by f\n",
    "ego = new C at 1 @ 2, with width 3, beyond a by b from c, facing d\n",
    "@d\ndef f(a=1): global g; g = {**a, 'b': c}\nf(*a, k=b)\n",
    "with \\\n  a as b, \\\n  c: pass\n",
]

RIGHT = tuple(
    each
    for module in (tokens, columns, python, forms, content, neighbours, parsers)
    for each in module.OF_TEXTS
)


@each(RIGHT, TEXTS)
def test_right_texts_have_them(law: Any, text: str):
    law.holds(Case(text, thorough=True))
    law.holds(Case(text + "x = = 1\n", thorough=True))


# Tokens.


@pytest.mark.parametrize(
    ("field", "index", "value", "message"),
    [
        ("columns", 1, 3, "stands where"),
        ("end_columns", 0, 2, "stands where"),
        ("texts", 0, "y", "stands where"),
        ("lines", 1, 2, "stands where"),
    ],
)
def test_tokens_elsewhere_are_noticed(field: str, index: int, value: object, message: str):
    case = Case("x = 1\ny = 2\n")
    getattr(case.tokens, field)[index] = value
    with pytest.raises(Violation, match=message):
        tokens.tokens_are_where_they_are_written(case)


def test_lost_tokens_are_noticed():
    case = Case("x = 1\n")
    for field in ("kinds", "texts", "lines", "columns", "end_lines", "end_columns"):
        del getattr(case.tokens, field)[1]
    with pytest.raises(Violation, match="no token for b' = '"):
        tokens.tokens_are_where_they_are_written(case)


def test_columns_in_bytes_are_noticed(monkeypatch: pytest.MonkeyPatch):
    case = Case("x = 'ab'; y = = 1\n")
    columns.columns_count_characters(case)

    def in_bytes(text: str) -> ParseResult:
        # As many more as the two letters have bytes more.
        result = parse(text)
        moved = [replace(each, span=Span(1, 18, 1, 19)) for each in result.diagnostics]
        return ParseResult(result.tree, tuple(moved))

    monkeypatch.setattr(columns, "parse", in_bytes)
    with pytest.raises(Violation, match="other places"):
        columns.columns_count_characters(case)


# Python.


def changed(text: str, cls: type[ast.AST], change: Callable[[Any], object]) -> Case:
    """A text in whose tree the first node of a class has been changed."""
    made = Case(text, thorough=True)
    change(next(node for node in ast.walk(made.result.tree) if isinstance(node, cls)))
    return made


@pytest.mark.parametrize(
    ("text", "cls", "field", "value"),
    [
        ("x = a - b\n", ast.BinOp, "op", ast.Add()),
        ("x = a\n", ast.Name, "col_offset", 1),
        ("while a: pass\nelse: b\n", ast.While, "orelse", []),
        ("def f(*, a=1): pass\n", ast.arguments, "kw_defaults", [None]),
    ],
)
def test_other_trees_than_pythons_are_noticed(text: str, cls: type[ast.AST], field: str, value: object):
    case = changed(text, cls, lambda node: setattr(node, field, value))
    with pytest.raises(Violation, match="not as in Python"):
        python.python_reads_the_same(case)


def test_statements_that_python_has_not_are_noticed():
    case = changed("x\ny\n", ast.Expr, lambda node: setattr(node, "end_col_offset", 2))
    with pytest.raises(Violation, match="no statement"):
        python.python_reads_the_same(case)


def with_names_exchanged(text: str) -> None:
    """Tries a text often: each time other names are exchanged, if any."""
    for number in range(30):
        python.names_mean_what_python_says(Case(f"{text}# {number}\n", thorough=True))


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("x = [y for y in x]\n", ScopeKind.COMPREHENSION),
        ("x = lambda y: y\n", ScopeKind.LAMBDA),
        ("def f(y): return y\n", ScopeKind.FUNCTION),
        ("def f():\n    y = 1\n    return lambda: y\n", ScopeKind.FUNCTION),
    ],
)
def test_missed_scopes_are_noticed(text: str, kind: ScopeKind, monkeypatch: pytest.MonkeyPatch):
    with_names_exchanged(text)
    lookup = Scope.lookup

    def one_too_far_out(self: Scope, name: str) -> Any:
        found = lookup(self, name)
        return None if found is not None and found.scope.kind is kind else found

    monkeypatch.setattr(Scope, "lookup", one_too_far_out)
    with pytest.raises(Violation, match=r"`\w+` at .* is nothing, but local"):
        with_names_exchanged(text)


def test_names_of_classes_are_out_of_reach(monkeypatch: pytest.MonkeyPatch):
    text = "class C:\n    x = 1\n    def f(self): return x\n"

    def anywhere(self: Scope, name: str) -> Any:
        return next((each.bindings[name] for each in self.ancestors() if name in each.bindings), None)

    monkeypatch.setattr(Scope, "lookup", anywhere)
    with pytest.raises(Violation, match=r"`\w+` at .* is a name of the class \w+, but global"):
        with_names_exchanged(text)


def test_names_in_what_is_scenics_count():
    text = "def f(a):\n    new C at [b for b in a], with c (lambda d: d)\n    require always a\n    take a\n"
    with_names_exchanged(text)


# Operators.


def read_as(text: str, other: str) -> Case:
    """A text of which the parser is said to have made the tree of another one, of the same length."""
    case = Case(text, thorough=True)
    case.__dict__["result"] = ParseResult(parse(other).tree, ())
    return case


def swap(node: Any) -> None:
    node.operands.reverse()


@pytest.mark.parametrize(
    ("case", "message"),
    [
        (changed("x = distance to a from b\n", scenic.Operation, swap), "no form"),
        (changed("x = new C beyond a by b from c\n", scenic.SpecifierPhrase, swap), "no form"),
        (changed("x = a - b\n", ast.BinOp, lambda node: setattr(node, "op", ast.Add())), "no form"),
        (read_as("x =  a + b * c\n", "x = (a + b)* c\n"), "needs parentheses"),
        (read_as("x = a -  b - c\n", "x = a - (b - c)\n"), "needs parentheses"),
        (read_as("require a until  b until c\n", "require a until (b until c)\n"), "needs parentheses"),
        (read_as("require a and  b or c\n", "require a and (b or c)\n"), "needs parentheses"),
        (read_as("x = not  visible a\n", "x = not (visible a)\n"), "no form"),
    ],
)
def test_operators_that_are_read_otherwise_are_noticed(case: Case, message: str):
    with pytest.raises(Violation, match=message):
        forms.operators_follow_the_table(case)


def test_what_needs_no_parentheses_should_be_able_to_have_none(monkeypatch: pytest.MonkeyPatch):
    text = "require a until (b until c)\n"
    forms.operators_follow_the_table(Case(text, thorough=True))
    # As if `until` could be repeated.
    monkeypatch.setattr(forms, "parse", lambda _: parse(text))
    with pytest.raises(Violation, match="no operand without parentheses"):
        forms.operators_follow_the_table(Case(text, thorough=True))


# Neighbours of mistakes, and the two parsers.

TWO_STATEMENTS = "if a:\n    x\n    y\nz\n"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda result: ParseResult(result.tree, ()), "not one error in line . but nothing"),
        (lambda result: ParseResult(result.tree, result.diagnostics * 2), "not one error"),
        (
            lambda result: ParseResult(ast.Module(result.tree.body[:-1], []), result.diagnostics),
            "another tree",
        ),
    ],
)
def test_mistakes_that_spoil_others_are_noticed(
    change: Callable[[ParseResult], ParseResult], message: str, monkeypatch: pytest.MonkeyPatch
):
    case = Case(TWO_STATEMENTS, thorough=True)
    assert not case.has_error
    right = parse(TWO_STATEMENTS)

    def spoilt(text: str) -> ParseResult:
        result = parse(text)
        return result if text == TWO_STATEMENTS else change(result)

    monkeypatch.setattr(neighbours, "parse", spoilt)
    assert right.tree.body
    with pytest.raises(Violation, match=message.replace(" . ", r" \d, ")):
        neighbours.mistakes_leave_the_rest_alone(case)


def test_a_parser_that_refuses_or_differs_is_noticed(monkeypatch: pytest.MonkeyPatch):
    case = Case("x = a\n", thorough=True)
    build = parsers.build_parser
    monkeypatch.setattr(parsers, "build_parser", lambda *_: lambda *_: (None, 0))
    with pytest.raises(Violation, match="the fast parser refuses"):
        parsers.both_parsers_agree(case)
    monkeypatch.setattr(parsers, "build_parser", build)
    monkeypatch.setattr(parsers, "build_recording_parser", lambda *_: lambda *_: (None, 1, 0, set()))
    with pytest.raises(Violation, match="the recording parser refuses"):
        parsers.both_parsers_agree(case)
    monkeypatch.setattr(parsers, "build_recording_parser", lambda *_: lambda *_: (ast.Pass(), 4, 0, set()))
    with pytest.raises(Violation, match="another tree than that of the recording parser"):
        parsers.both_parsers_agree(case)


# What is lost.


@pytest.mark.parametrize(
    ("text", "cls", "field", "value", "message"),
    [
        ("while a: pass\nelse: b\n", ast.While, "orelse", [], "not in the tree: b"),
        ("def f(*, a=1): pass\n", ast.arguments, "kw_defaults", [None], "1 numbers"),
        ("require monitor a as b\n", scenic.RequireMonitor, "name", None, "not in the tree: b"),
        ("require a as 1\n", scenic.Require, "name", None, "1 numbers"),
    ],
)
def test_what_parsing_loses_is_noticed(
    text: str, cls: type[ast.AST], field: str, value: object, message: str
):
    content.parsing_loses_nothing(Case(text))
    case = changed(text, cls, lambda node: setattr(node, field, value))
    with pytest.raises(Violation, match=message):
        content.parsing_loses_nothing(case)


def lose(text: str, cls: type[ast.AST], field: str, value: object, monkeypatch: pytest.MonkeyPatch) -> Case:
    """A text of whose lowered tree the first node of a class is changed."""
    lowered = content.lowered

    def less(case: Case) -> Any:
        found = lowered(case)
        assert found is not None
        node: Any = next(node for node in ast.walk(found.module) if isinstance(node, cls))
        setattr(node, field, value)
        return found._replace(tree=parse(case.text).tree)

    monkeypatch.setattr(content, "lowered", less)
    return Case(text, thorough=True)


@pytest.mark.parametrize(
    ("text", "cls", "field", "value", "message"),
    [
        ("@d\ndef f(): pass\n", ast.FunctionDef, "decorator_list", [], "nothing stands at the place of Name"),
        ("def f(a=1): pass\n", ast.arguments, "defaults", [], "nothing stands at the place of Constant"),
        ("f(k=a)\n", ast.keyword, "arg", None, "lost: k"),
        ("a.b\n", ast.Attribute, "attr", "c", "lost: b"),
        ("import a\n", ast.alias, "name", "c", "lost: a"),
        ("new Object at 1 @ 2\n", ast.Call, "col_offset", 1, "nothing stands at the place of New"),
    ],
)
def test_what_lowering_loses_is_noticed(
    text: str, cls: type[ast.AST], field: str, value: object, message: str, monkeypatch: pytest.MonkeyPatch
):
    with pytest.raises(Violation, match=message):
        content.lowering_loses_nothing(lose(text, cls, field, value, monkeypatch))
