"""Parsing never raises, whatever the text."""

import ast
import gc
import sys

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


@settings(max_examples=100, deadline=None)
@given(st.sampled_from(PROGRAMS), st.integers(0, 10_000), st.integers(0, 10), st.sampled_from(PIECES))
def test_programs_with_a_change(program: str, place: int, length: int, piece: str) -> None:
    place %= len(program)
    check(program[:place] + piece + program[place + length :])


@settings(deadline=None)
@given(st.sampled_from(PROGRAMS), st.integers(0, 10_000))
def test_programs_cut_short(program: str, place: int) -> None:
    check(program[: place % len(program)])


@pytest.mark.parametrize(
    "text",
    [
        "x = " + "(" * 8_000 + "1" + ")" * 8_000,
        "x = " + "[" * 8_000 + "]" * 8_000,
        "x = " + "(" * 8_000,
        "x = " + "not " * 8_000 + "a",
        "x = " + "-" * 8_000 + "a",
        "x = " + "f(" * 8_000 + ")" * 8_000,
        "\n".join(" " * depth + "if x:" for depth in range(300)) + "\n" + " " * 300 + "pass",
    ],
    ids=lambda text: f"{text[4:8]}",
)
def test_deep_nesting_gives_a_tree_or_a_message(text: str) -> None:
    result = parse(text)
    assert result.tree.body or result.diagnostics
    del result
    gc.collect()


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [
        ("y = 1\nx = " + "(" * 200 + "a" + ")" * 200 + "\n", None, None),
        ("y = 1\nx = " + "([" * 100 + "{a}" + "])" * 100 + "\n", 2, 204),
        ("".join(" " * depth + "if a:\n" for depth in range(99)) + " " * 99 + "pass\n", None, None),
        ("".join(" " * depth + "if a:\n" for depth in range(100)) + " " * 100 + "pass\n", 101, 100),
    ],
)
def test_brackets_and_blocks_nest_as_deeply_as_in_python(text: str, line: int, column: int) -> None:
    result = parse(text)
    assert [(each.code, each.span and (each.span.line, each.span.column)) for each in result.diagnostics] == (
        [] if line is None else [("SC112", (line, column))]
    )
    try:
        compile(text, "f", "exec")
    except SyntaxError as error:
        assert line is not None or "blocks" in str(error)  # noqa: PT017 - loops and the like nest less deeply
    else:
        assert line is None


def test_long_chains_give_a_tree_or_a_diagnostic() -> None:
    assert not parse("x = " + "-" * 1_000 + "a\ny = 2\n").diagnostics
    result = parse("x = " + "-" * 22_000 + "a\ny = 2\n")
    assert [each.code for each in result.diagnostics] == ["SC112"]
    assert isinstance(result.tree.body[1], ast.Assign)


def test_the_recursion_limit_and_the_collector_are_left_alone() -> None:
    before = sys.getrecursionlimit(), gc.isenabled()
    parse("x = " + "(" * 190 + ")" * 190)
    parse("x = " + "(" * 5000 + ")" * 5000)
    parse("x x")
    assert (sys.getrecursionlimit(), gc.isenabled()) == before
