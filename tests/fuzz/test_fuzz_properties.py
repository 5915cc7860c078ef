"""The properties notice what they are there for."""

import ast
from typing import Any

import pytest

from fuzz import properties
from fuzz.properties import Case, Violation
from scenic.compiler import tree as scenic
from scenic.compiler.parser import ParseResult, parse
from scenic.language.diagnostics import Diagnostic, Label
from scenic.language.spans import Span


def case(text: str, *diagnostics: Diagnostic, node: ast.AST | None = None, **places: Any) -> Case:
    """A text of which the parser is said to have made something wrong."""
    result = parse(text)
    for each in ast.walk(result.tree):
        if isinstance(each, ast.Name):
            vars(each).update(places)
    if node is not None:
        result.tree.body.append(node)
    made = Case(text)
    made.__dict__["result"] = ParseResult(result.tree, diagnostics or result.diagnostics)
    return made


@pytest.mark.parametrize("name", [each.name for each in properties.OF_PROGRAMS])
@pytest.mark.parametrize("text", ["", "x\n", "x", "é = '😀'", "new Object at x,\n    facing y\n"])
def test_what_is_right_is_accepted(name: str, text: str):
    next(each for each in properties.OF_PROGRAMS if each.name == name).holds(Case(text))


@pytest.mark.parametrize("text", ["", "\0", "\ud800 = (", "if x:\n\ty\n  z", "f'{", "\r\n  x\r", "\ufeffx ("])
def test_what_is_wrong_is_explained(text: str):
    for each in properties.OF_TEXTS:
        each.holds(Case(text))


@pytest.mark.parametrize(
    "places",
    [
        {"lineno": 0},
        {"lineno": 3, "end_lineno": 3},
        {"end_lineno": 9},
        {"end_col_offset": 99},
        {"col_offset": -1},
        {"col_offset": 1, "end_col_offset": 0},
    ],
)
def test_places_outside_the_text_are_noticed(places: dict[str, int]):
    with pytest.raises(Violation, match="Name"):
        properties.nodes_lie_in_the_text(case("x\n", **places))


def test_a_node_without_a_place_is_noticed():
    with pytest.raises(Violation, match="Pass has no place"):
        properties.nodes_lie_in_the_text(case("x\n", node=ast.Pass()))


@pytest.mark.parametrize("span", [Span(1, 0, 3, 0), Span(1, 0, 1, 9), Span(1, 3, 1, 3)])
def test_spans_outside_the_text_are_noticed(span: Span):
    inside = Span(1, 0, 1, 1)
    for diagnostic in (
        Diagnostic("SC110", "wrong", span),
        Diagnostic("SC110", "wrong", inside, labels=(Label(span, "here"),)),
    ):
        with pytest.raises(Violation, match="SC110 'wrong'"):
            properties.diagnostics_lie_in_the_text(case("x\n", diagnostic))


def test_a_gap_without_an_error_is_noticed():
    gap = scenic.ErrorStatement(body=[])
    with pytest.raises(Violation, match="no error"):
        properties.parsing_gives_a_tree(case("x\n", node=gap))


def test_a_refused_program_is_noticed():
    with pytest.raises(Violation, match="refused: SC110"):
        properties.programs_are_accepted(Case("x y\n"))
    with pytest.raises(Violation, match="refused: SC120"):
        properties.programs_are_accepted(case("x\n", Diagnostic("SC120", "something else", Span(1, 0, 1, 1))))


def test_what_depends_on_the_running_python_is_no_refusal():
    properties.programs_are_accepted(Case("type X = int\ndef f[T](): pass\n"))


def test_an_exception_of_the_check_gets_through(monkeypatch: pytest.MonkeyPatch):
    def broken(text: str, *, filename: str) -> tuple[Diagnostic, ...]:
        raise IndexError(text + filename)

    monkeypatch.setattr(properties, "check_text", broken)
    with pytest.raises(IndexError):
        properties.checking_never_raises(Case("x\n"))
