"""Python's complaints become diagnostics; hostile programs never raise."""

import ast

import pytest

from scenic.compiler.compile import compile_text, lower_text
from scenic.language.diagnostics import Severity


@pytest.mark.parametrize(
    ("text", "code", "line", "columns"),
    [
        ("y = 1\nnonlocal x", "SC201", 2, (0, 10)),
        ("def f():\n    x = 1\n    global x\n", "SC110", 3, (4, 12)),
        ("def f(a, a): pass", "SC210", 1, (9, 10)),
        ("'é'; def_ = lambda é, é: 1", "SC210", 1, (22, 23)),
        ("*a, *b = c = [1]", "SC110", 1, (0, 6)),
        ("x = 1\nfrom __future__ import annotations", "SC110", 2, None),
        ("async def f(): pass\ndef g(): return [i async for i in f()]", "SC201", 2, None),
        ("match 1:\n    case x: pass\n    case y: pass", "SC110", 2, None),
        ("def f():\n    nonlocal missing\n", "SC110", 2, None),
    ],
)
def test_errors_of_python(text: str, code: str, line: int, columns: tuple[int, int] | None) -> None:
    result = compile_text(text, filename="program.scenic")
    assert result.code is None
    [finding] = [item for item in result.diagnostics if item.severity is Severity.ERROR]
    assert (finding.code, finding.filename) == (code, "program.scenic")
    assert finding.span is not None
    assert finding.span.line == line
    if columns is not None:
        assert (finding.span.column, finding.span.end_column) == columns


def test_warnings_of_python_come_once() -> None:
    result = compile_text("x = 3\nrequire x.real[0] == 1 or 'a'[0.5] == x", filename="f")
    assert result.code is not None
    [finding] = result.diagnostics
    assert finding.severity is Severity.WARNING
    assert finding.span is not None
    assert finding.span.line == 2


def test_findings_of_all_steps_are_reported() -> None:
    result = lower_text("x = = 3\ny = Rnage(1)\n", filename="f")
    assert result.module is None
    assert len({item.code for item in result.diagnostics}) == 2


def test_warnings_do_not_stop_compilation() -> None:
    result = compile_text("new Object with widht 3", filename="f")
    assert result.code is not None
    assert [item.code for item in result.diagnostics] == ["SC300"]


@pytest.mark.parametrize(
    "text",
    [
        "x = " + "(" * 2000 + ")" * 2000,
        "x = " + "+".join(["1"] * 20_000),
        "x = " + "-" * 20_000 + "1",
        "require " + " and ".join(["x > 1"] * 3000) + "\nx = 1",
        "require " + "not " * 5000 + "True",
        "x = " + "(1 if 2 else " * 2000 + "3" + ")" * 2000,
        "require 1 < " + "(2 < " * 500 + "3" + " < 4)" * 500,
        "if 1:\n" + "".join("    " * depth + "if 1:\n" for depth in range(1, 90)) + "    " * 90 + "pass\n",
        "x = " + "new Object at " * 1000 + "1",
        "x = [" + "lambda: " * 1000 + "1]",
    ],
)
def test_depth_gives_code_or_a_diagnostic(text: str) -> None:
    result = compile_text(text, filename="f")
    if result.code is None:
        assert result.diagnostics
        assert {item.code for item in result.diagnostics} <= {"SC112", "SC102", "SC103", "SC110"}


def test_middles_of_chains_are_not_copied() -> None:
    """The size of the result grows linearly with nested chains."""

    def size(depth: int) -> int:
        text = "x = 1\nrequire 1 < " + "(2 < " * depth + "x.real" + " < 4)" * depth + " < 3"
        module = lower_text(text, filename="f").module
        assert module is not None
        return sum(1 for _ in ast.walk(module))

    assert size(40) < 2.5 * size(20)
