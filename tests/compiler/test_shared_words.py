"""Closing words go to the innermost operator that can use them, as far as all operators get those they need."""

import ast

import pytest

from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse
from scenic.compiler.shared_words import closed_operands, in_parentheses
from tests.work import calls_while

READINGS = [
    # What the parser reads without help.
    ("distance from distance from a to b to c", "distance from (distance from a to b) to c"),
    ("distance from distance to a to b", "distance from (distance to a) to b"),
    ("distance to distance from a from b", "distance to (distance from a) from b"),
    ("distance from distance from a to b", "distance from (distance from a to b)"),
    # An operator that cannot do without a word.
    ("follow distance to x from b for c", "follow (distance to x) from b for c"),
    ("follow relative heading of x from b for c", "follow (relative heading of x) from b for c"),
    ("follow apparent heading of x from b for c", "follow (apparent heading of x) from b for c"),
    ("follow distance to x from a from b for c", "follow (distance to x from a) from b for c"),
    (
        "follow distance to x from altitude to y from z for c",
        "follow (distance to x from (altitude to y)) from z for c",
    ),
    (
        "follow follow distance to a from b for c from d for e",
        "follow (follow (distance to a) from b for c) from d for e",
    ),
    (
        "distance to distance to follow distance to x from b for c from a",
        "distance to (distance to (follow (distance to x) from b for c) from a)",
    ),
    ("angle to not distance to x from x", "angle to (not distance to x) from x"),
    (
        "angle to not angle to not angle to x from a from b",
        "angle to (not angle to (not angle to x) from a) from b",
    ),
    ("angle to lambda a, b: distance to x from y", "angle to (lambda a, b: distance to x) from y"),
    ("angle to lambda a, b=1: distance to x from y", "angle to (lambda a, b=1: distance to x) from y"),
    (
        "angle to lambda a=distance to c: distance to x from y",
        "angle to (lambda a=distance to c: distance to x) from y",
    ),
    (
        "f(a=angle to lambda b=(c, d), e=f: distance to x from y, g=h)",
        "f(a=angle to (lambda b=(c, d), e=f: distance to x) from y, g=h)",
    ),
    ("distance past not distance past x of y", "distance past (not distance past x) of y"),
    ("angle to not a if distance to b else c from d", "angle to (not a if distance to b else c) from d"),
    ("[follow angle to x from b for c for d in e]", "[(follow (angle to x) from b for c) for d in e]"),
    ("f(follow distance to x from b for c, d)", "f((follow (distance to x) from b for c), d)"),
    ("{follow distance to x from b for c: d}", "{(follow (distance to x) from b for c): d}"),
    ("a[follow distance to x from b for c:d]", "a[(follow (distance to x) from b for c):d]"),
    (
        "new C following distance to x from b for c",
        "new C following (distance to x from b) for c",
    ),
    (
        "new C at follow distance to x from b for c, with d e",
        "new C at (follow (distance to x) from b for c), with d e",
    ),
]

CONDITIONS = [
    ("new C at x and always y", "(new C at x) and always y"),
    ("a or new C at x and always y", "a or (new C at x) and always y"),
    ("new C at x, facing y and not always z", "(new C at x, facing y) and not always z"),
    ("new C with foo new D at x or eventually y", "(new C with foo (new D at x)) or eventually y"),
    ("(new C at x and always y) implies z", "((new C at x) and always y) implies z"),
    ("a in new C at x and next -y", None),
    ("a in new C at x and next f(y)", "a in (new C at x) and next f(y)"),
    ("new C at x until y", "(new C at x) until y"),
    ("new C at x and y", "new C at (x and y)"),
]


def tree_of(text: str) -> ast.Module:
    result = parse(text)
    assert result.diagnostics == ()
    return result.tree


@pytest.mark.parametrize(("text", "reading"), READINGS)
def test_expressions(text: str, reading: str) -> None:
    assert ast.dump(tree_of(f"x = {text}")) == ast.dump(tree_of(f"x = {reading}"))


@pytest.mark.parametrize(("text", "reading"), CONDITIONS)
def test_conditions(text: str, reading: str | None) -> None:
    if reading is None:
        # Here `next` can be a name, and the difference is a right reading.
        assert "Temporal" not in ast.dump(tree_of(f"require {text}"))
    else:
        assert ast.dump(tree_of(f"require {text}")) == ast.dump(tree_of(f"require {reading}"))


def test_places_are_those_of_the_text() -> None:
    text = "é = follow distance to x from b for c"
    (statement,) = tree_of(text).body
    assert isinstance(statement, ast.Assign)
    segments = [
        ast.get_source_segment(text, each) for each in ast.walk(statement.value) if hasattr(each, "lineno")
    ]
    assert segments == ["follow distance to x from b for c", "distance to x", "b", "c", "x"]


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [
        ("x = follow distance to x for c\n", 1, 25),
        ("x = distance to not distance from x to y\n", 1, 40),
        ("x = follow distance to x from b for c; y = follow a for b\n", 1, 52),
    ],
)
def test_what_is_wrong_is_told_as_the_text_stands(text: str, line: int, column: int) -> None:
    (found,) = parse(text).diagnostics
    assert found.span is not None
    assert (found.span.line, found.span.column) == (line, column)


def test_a_mistake_elsewhere_does_not_change_the_reading() -> None:
    good = "if a:\n  x = follow distance to x from b for c\n"
    result = parse(good + "y y\n")
    assert [each.span.line for each in result.diagnostics if each.span] == [3]
    assert ast.dump(result.tree.body[0]) == ast.dump(tree_of(good).body[0])


def test_a_mistake_on_the_line_leaves_other_lines_alone() -> None:
    text = "x = follow distance to x from b for c for\ny = follow distance to x from b for c\n"
    result = parse(text)
    assert {each.span.line for each in result.diagnostics if each.span} == {1}
    assert isinstance(result.tree.body[1], ast.Assign)


def test_lists_of_tokens_stay_parallel() -> None:
    tokens = lex("x = follow angle to not distance to x from b from c for d\n", WORDS)
    operands = closed_operands(tokens)
    again = in_parentheses(tokens, operands)
    lengths = {
        len(each)
        for each in (again.kinds, again.texts, again.lines, again.columns, again.end_lines, again.end_columns)
    }
    assert lengths == {len(tokens.kinds) + 2 * len(operands)}
    assert [text for text in again.texts if text not in "()"] == [text for text in tokens.texts if text]


CHAINS = {
    "one closing word": lambda count: "x = " + "distance from " * count + "a to b",
    "a closing word for each": lambda count: "x = " + "distance from " * count + "a" + " to b" * count,
    "mixed, one closing word": lambda count: "x = " + "distance to altitude from " * count + "a from b",
    "none": lambda count: "x = " + "distance from " * count + "a",
    "one word too few": lambda count: "x = " + "angle to not " * count + "a" + " from b" * (count - 1),
    "not, with words": lambda count: "x = " + "angle to not " * count + "angle to a" + " from b" * count,
    "follow": lambda count: "x = " + "follow distance to " * count + "a" + " from b for c" * count,
    "follow without": lambda count: "x = " + "follow distance to " * count + "a for b",
    "instances": lambda count: "require " + "new C at x and " * count + "always y",
    "words that nobody wants": lambda count: "x = " + "angle from " * count + "follow a" + " from b" * count,
}


@pytest.mark.parametrize("name", CHAINS)
def test_chains_take_linear_time(name: str) -> None:
    text = CHAINS[name]
    small, large = (calls_while(parse, text(count)) for count in (500, 1000))
    assert large < 2.3 * small


@pytest.mark.parametrize("name", CHAINS)
def test_two_hundred_operators(name: str) -> None:
    result = parse(CHAINS[name](200))
    assert bool(result.diagnostics) == (
        name in ("one word too few", "follow without", "words that nobody wants")
    )
    assert "SC112" not in {each.code for each in result.diagnostics}


@pytest.mark.parametrize("name", CHAINS)
def test_two_thousand_operators(name: str) -> None:
    result = parse(CHAINS[name](2000) + "\ny = 1\n")
    codes = {each.code for each in result.diagnostics}
    assert ("SC112" in codes) == (name != "none")
    assert isinstance(result.tree.body[-1], ast.Assign)
