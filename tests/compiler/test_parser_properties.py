"""Parsing never raises, and takes linear time, whatever the text."""

import ast
import gc
import sys
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenic.compiler.generated import WORDS
from scenic.compiler.parser import ParseResult, parse
from tests.compiler.golden_cases import SCENIC_FILES, read_cases

PROGRAMS = [
    "".join(f"{case.source}\n" for case in read_cases(path)[1] if not case.source.startswith((" ", "\t")))
    for path in SCENIC_FILES
]
PIECES = [
    *WORDS,
    "x",
    "C",
    "3",
    "'s'",
    "f'{",
    "}'",
    "\n",
    "\n  ",
    "\n    ",
    " ",
    "\\\n",
    "\x00",
    "\ud800",
    "é",
    "\t",
    "#",
]


def check(text: str) -> ParseResult:
    result = parse(text)
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    for found in result.diagnostics:
        assert found.span is not None
        assert found.span.end_line <= len(lines) + 1
    broken = any(type(node).__name__ == "ErrorStatement" for node in ast.walk(result.tree))
    assert result.diagnostics or not broken
    return result


@given(st.text())
def test_any_text(text: str) -> None:
    check(text)


@given(st.lists(st.sampled_from(PIECES), max_size=60))
def test_words_in_any_order(pieces: list[str]) -> None:
    check(" ".join(pieces))
    check("".join(pieces))


@settings(max_examples=200)
@given(st.sampled_from(PROGRAMS), st.integers(0, 10_000), st.integers(0, 10), st.sampled_from(PIECES))
def test_programs_with_a_change(program: str, place: int, length: int, piece: str) -> None:
    place %= len(program)
    check(program[:place] + piece + program[place + length :])


@given(st.sampled_from(PROGRAMS), st.integers(0, 10_000))
def test_programs_cut_short(program: str, place: int) -> None:
    check(program[: place % len(program)])


def repeated(start: str, middle: str, end: str = "", *, prefix: str = "x = ") -> Callable[[int], str]:
    return lambda count: prefix + start * count + middle + end * count


def nested_blocks(header: str, inner: str) -> Callable[[int], str]:
    def text(count: int) -> str:
        steps = header.count("\n") + 1
        lines = [
            " " * (depth * steps + step) + line
            for depth in range(count)
            for step, line in enumerate(header.split("\n"))
        ]
        return "\n".join([*lines, " " * (count * steps) + inner])

    return text


NESTED = {
    "parentheses": repeated("(", "1", ")"),
    "parentheses with a mistake": repeated("(", "1 1", ")"),
    "parentheses never closed": repeated("(", ""),
    "tuples": repeated("(", "1,", "),"),
    "lists": repeated("[", "1", "]"),
    "lists with a mistake": repeated("[", "1 1", "]"),
    "starred lists": repeated("[*", "a", "]"),
    "sets": repeated("{", "1", "}"),
    "sets with a mistake": repeated("{", "1 1", "}"),
    "dictionaries": repeated("{1:", "1", "}"),
    "dictionaries with a mistake": repeated("{1:", "1 1", "}"),
    "calls": repeated("f(", "1", ")"),
    "calls with a mistake": repeated("f(", "1 1", ")"),
    "keyword arguments": repeated("f(a=", "1", ")"),
    "generators in calls": repeated("f(", "1", " for x in y)"),
    "subscripts": repeated("a[", "1", "]"),
    "starred subscripts": repeated("a[*", "b", "]"),
    "slices": repeated("a[1:", "1", "]"),
    "subscripts with a mistake": repeated("a[", "1 1", "]"),
    "comprehensions": repeated("[a for b in ", "c", "]"),
    "comprehensions with a mistake": repeated("[a for b in ", "c c", "]"),
    "targets": repeated("(", "x", ")", prefix=""),
    "targets of loops": lambda count: "for " + "(" * count + "x" + ")" * count + " in y: pass",
    "context managers": lambda count: "with " + "(" * count + "x" + ")" * count + " as y: pass",
    "lambdas": repeated("lambda: ", "1"),
    "defaults of lambdas": repeated("lambda a=", "1", ": 1"),
    "conditionals": repeated("a if b else ", "c"),
    "conditionals in parentheses": repeated("(a if ", "1", " else b)"),
    "not": repeated("not ", "a"),
    "minus": repeated("-", "a"),
    "sums": repeated("a + ", "a"),
    "comparisons": repeated("a < ", "a"),
    "powers": repeated("a ** ", "a"),
    "relative to": repeated("a relative to ", "a"),
    "offset along": repeated("a offset along ", "b", " by c"),
    "offset along unfinished": repeated("a offset along ", "b"),
    "distance from": repeated("distance from ", "a"),
    "distance from to": repeated("distance from ", "a", " to b"),
    "distances in a row": repeated("distance from a | ", "a"),
    "distance from parentheses": repeated("distance from (", "a", ")"),
    "distance from calls": repeated("distance from f(", "a", ")"),
    "distance with a mistake": repeated("distance from (", "a a", ")"),
    "visible": repeated("visible ", "a"),
    "not visible": repeated("not visible ", "a"),
    "follow": repeated("follow ", "a", " from b for c"),
    "new": repeated("new C with x ", "a"),
    "new in parentheses": repeated("new C at (", "a", ")"),
    "new with a mistake": repeated("new C with x ", "a a"),
    "beyond": repeated("new C beyond ", "a", " by 3"),
    "conditions": repeated("(", "a", ")", prefix="require "),
    "conditions and more": repeated("(", "a", ") and b", prefix="require "),
    "conditions that are none": repeated("(", "a", ") + 1", prefix="require "),
    "temporal conditions": repeated("(always ", "a", ")", prefix="require "),
    "temporal conditions that are none": repeated("always (", "a", ") + 1", prefix="require "),
    "prefixes": repeated("always ", "a", prefix="require "),
    "conditions with a mistake": repeated("(", "a a", ")", prefix="require "),
    "soft keyword": repeated("(", "a", ")", prefix="take "),
    "do until": lambda count: "do " + "f(" * count + "a" + ")" * count + " until x",
    "patterns": lambda count: "match x:\n case " + "[" * count + "a" + "]" * count + ": pass",
    "class patterns": lambda count: "match x:\n case " + "C(" * count + "a" + ")" * count + ": pass",
    "keyword patterns": lambda count: "match x:\n case " + "C(a=" * count + "a" + ")" * count + ": pass",
    "patterns with a mistake": lambda count: (
        "match x:\n case " + "C(" * count + "a a" + ")" * count + ": pass"
    ),
    "f-strings": repeated('f"{', "a", '}"'),
    "f-strings with a mistake": repeated('f"{', "a a", '}"'),
    "mistakes": lambda count: "x x\n" * count,
    "elif": lambda count: "if a: pass\n" + "elif b: pass\n" * count,
    "if": nested_blocks("if a:", "pass"),
    "if with a mistake": nested_blocks("if a:", "x x"),
    "try with a mistake": nested_blocks("try:", "x x"),
    "with with a mistake": nested_blocks("with (a):", "x x"),
    "classes with a mistake": nested_blocks("class C:", "x x"),
    "async with a mistake": nested_blocks("async def f():", "x x"),
    "behaviors with a mistake": nested_blocks("behavior B():", "x x"),
    "scenarios with a mistake": nested_blocks("scenario S():", "x x"),
    "match with a mistake": nested_blocks("match a:\ncase b:", "x x"),
}


def calls_while_parsing(text: str) -> int:
    """How many Python functions are called."""
    count = 0

    def profile(frame: object, event: str, argument: object) -> None:
        nonlocal count
        count += event == "call"

    sys.setprofile(profile)
    try:
        parse(text)
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.parametrize("name", NESTED)
def test_nesting_takes_linear_time(name: str) -> None:
    text = NESTED[name]
    # Below this depth a block with a mistake may be parsed once more for every block around it.
    small, large = (calls_while_parsing(text(count)) for count in (40, 80))
    assert large < 2.6 * small + 500


@pytest.mark.parametrize(
    "text",
    [
        "x = " + "(" * 50_000 + "1" + ")" * 50_000,
        "x = " + "[" * 50_000 + "]" * 50_000,
        "x = " + "(" * 20_000,
        "x = " + "not " * 50_000 + "a",
        "x = " + "-" * 50_000 + "a",
        "x = " + "f(" * 20_000 + ")" * 20_000,
        "\n".join(" " * depth + "if x:" for depth in range(500)) + "\n" + " " * 500 + "pass",
    ],
    ids=lambda text: f"{text[4:8]}",
)
def test_deep_nesting_gives_a_tree_or_a_message(text: str) -> None:
    result = parse(text)
    assert result.tree.body
    del result
    gc.collect()


def test_too_deep_nesting_is_refused() -> None:
    result = parse("x = " + "-" * 1_100_000 + "a\ny = 2\n")
    assert [each.code for each in result.diagnostics] == ["SC112"]
    assert isinstance(result.tree.body[1], ast.Assign)


def test_the_recursion_limit_and_the_collector_are_left_alone() -> None:
    before = sys.getrecursionlimit(), gc.isenabled()
    parse("x = " + "(" * 5000 + ")" * 5000)
    parse("x x")
    assert (sys.getrecursionlimit(), gc.isenabled()) == before
