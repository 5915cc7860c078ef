"""All properties accept what is right; those of parsing and acceptance notice what they are there for."""

import ast
from collections.abc import Callable
from typing import Any

import pytest

from fuzz import properties
from fuzz.properties import Case, Property, Violation, acceptance, parsing
from scenic.compiler import tree as scenic
from scenic.compiler.parser import ParseResult, parse
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Label
from scenic.language.spans import Span
from tests.each import each


def case(text: str, *diagnostics: Diagnostic, node: ast.AST | None = None) -> Case:
    """A text of which the parser is said to have made something wrong."""
    result = parse(text)
    if node is not None:
        result.tree.body.append(node)
    made = Case(text)
    made.__dict__["result"] = ParseResult(result.tree, diagnostics or result.diagnostics)
    return made


RIGHT = [
    "",
    "x\n",
    "x",
    "é = '😀'",
    "new Object at x,\n    facing y\n",
    "@a\n@b.c\ndef f(a, /, b=1, *, c=2, **d): return (yield a)\n",
    "f(*a, b=1, *c, **d)[1:2, *e]\nclass C(D, *b, k=1): pass\n",
    "x = f'a{b!r:{c}}{d=}' f'e'\n",
    "behavior B():\n    'doc'\n    precondition: x\n    invariant: y\n    do B() for 3 seconds\n",
    "scenario S():\n    setup:\n        ego = new Object\n    compose:\n        do S()\n",
    "class C:\n    width: self.length\n    height[additive]: 3\n    def f(self): return 1\n",
    "match x:\n    case {'a': b, **c} | C(d, e=f) if g: pass\n    case [*_]: pass\n",
    "require[0.5] (always x) implies next y as z\nrecord a every 3 seconds after 2 steps as b\n",
    "x = a offset along b by c if not visible d else {**e, 1: 2}\n",
]


@each(properties.OF_PROGRAMS, RIGHT)
def test_what_is_right_is_accepted(law: Property, text: str):
    law.holds(Case(text, thorough=True))


@each(
    properties.OF_TEXTS,
    [
        "\0",
        "\ud800 = (",
        "if x:\n\ty\n  z",
        "f'{",
        "\r\n  x\r",
        "\ufeffx (",
        "x = '''a\n\n",
        "new Object with wdth 3",
        "match:\n  case\n  case 1:\n    x",
        "class C:\n  x[:\n  y: 3",
        "def f(: pass\n\n\nreturn",
        "\f\\",
    ],
)
def test_what_is_wrong_is_explained(law: Property, text: str):
    law.holds(Case(text, thorough=True))


# Of properties.


def never(case: Case) -> None:
    raise Violation("never")


def test_dear_properties_are_tried_on_a_sample():
    each = Property.of(never, one_in=10)
    tried = []
    for number in range(500):
        try:
            each.holds(Case(f"x{number}"))
        except Violation:
            tried.append(number)
    assert 25 <= len(tried) <= 80
    # The same texts each time, and every text where that matters.
    with pytest.raises(Violation):
        each.holds(Case(f"x{tried[0]}"))
    with pytest.raises(Violation):
        each.holds(Case(f"x{(tried[0] + 1)}", thorough=True))


def test_the_names_of_properties_are_their_own():
    names = [each.name for each in properties.OF_PROGRAMS]
    assert len(set(names)) == len(names)
    assert set(properties.PARSING) < set(properties.OF_TEXTS) < set(properties.OF_PROGRAMS)


# Of parsing.


def test_a_gap_without_an_error_is_noticed():
    with pytest.raises(Violation, match="no error"):
        parsing.parsing_gives_a_tree(case("x\n", node=scenic.ErrorStatement(body=[])))


@pytest.mark.parametrize("span", [Span(1, 0, 3, 0), Span(1, 0, 1, 9), Span(1, 3, 1, 3), None])
def test_places_outside_the_text_are_noticed(span: Any):
    inside = Span(1, 0, 1, 1)
    for diagnostic in (
        Diagnostic("SC110", "wrong", span),
        Diagnostic("SC110", "wrong", inside, labels=(Label(span, "here"),)),
        Diagnostic("SC110", "wrong", inside, fix=Fix("t", (Edit(inside, "y"), Edit(span, "z")))),
    ):
        with pytest.raises(Violation, match=r"(outside the text|without a place).*SC110 'wrong'"):
            parsing.diagnostics_lie_in_the_text(case("x\n", diagnostic))


def test_changes_that_overlap_are_noticed():
    fix = Fix("t", (Edit(Span(1, 0, 1, 2), "y"), Edit(Span(1, 1, 1, 3), "z")))
    with pytest.raises(Violation, match="edits overlap"):
        parsing.diagnostics_lie_in_the_text(
            case("xxx\n", Diagnostic("SC110", "wrong", Span(1, 0, 1, 1), fix=fix))
        )


def test_an_error_that_the_check_loses_is_noticed(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(properties.case, "check_text", lambda text, *, filename: ())
    with pytest.raises(Violation, match="the check does not say: SC110"):
        parsing.diagnostics_lie_in_the_text(Case("x y\n"))


def test_an_exception_of_the_check_gets_through(monkeypatch: pytest.MonkeyPatch):
    def broken(text: str, *, filename: str) -> tuple[Diagnostic, ...]:
        raise IndexError(text + filename)

    monkeypatch.setattr(properties.case, "check_text", broken)
    with pytest.raises(IndexError):
        parsing.diagnostics_lie_in_the_text(Case("x\n"))


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("1", "2"),
        lambda text: text + "x x\n",
        lambda text: text.replace("\r\n", "\n\n"),
        lambda text: text.replace("\r", "\\\n") if "\r\n" not in text else text,
        lambda text: text.replace("\ufeff", " "),
    ],
)
def test_a_parser_that_depends_on_more_than_the_text_is_noticed(
    change: Callable[[str], str], monkeypatch: pytest.MonkeyPatch
):
    text = "x = 1\ny = 2\n"
    right = Case(text, thorough=True)
    parsing.parsing_is_deterministic(right)
    monkeypatch.setattr(parsing, "parse", lambda text: parse(change(text)))
    with pytest.raises(Violation, match=r"another tree|other diagnostics"):
        parsing.parsing_is_deterministic(right)


def test_other_diagnostics_are_noticed():
    made = case("x x\n", Diagnostic("SC110", "something else", Span(1, 0, 1, 1)))
    with pytest.raises(Violation, match="other diagnostics"):
        parsing.parsing_is_deterministic(made)


@pytest.mark.parametrize("name", ["parse", "check_text"])
def test_quadratic_work_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch):
    right = getattr(parsing, name)

    def quadratic(text: str, **options: Any) -> Any:
        lines = text.split("\n")
        for _ in lines:
            for line in lines:
                str_of(line)
        return right(text, **options)

    text = "x = 1\n" * 20
    parsing.work_is_linear(Case(text))
    monkeypatch.setattr(parsing, name, quadratic)
    with pytest.raises(Violation, match="is not linear"):
        parsing.work_is_linear(Case(text))


def str_of(line: str) -> str:
    return line


# Of acceptance.


def test_a_refused_program_is_noticed():
    with pytest.raises(Violation, match="refused: SC110"):
        acceptance.programs_are_accepted(Case("x y\n"))
    with pytest.raises(Violation, match="refused: SC120"):
        acceptance.programs_are_accepted(case("x\n", Diagnostic("SC120", "something else", Span(1, 0, 1, 1))))


def test_what_depends_on_the_running_python_is_no_refusal():
    acceptance.programs_are_accepted(Case("type X = int\ndef f[T](): pass\n"))
