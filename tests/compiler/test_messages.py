"""What is said about wrong programs, mistake by mistake.

Each file in ``tests/data/messages`` holds a family of mistakes. A line of ``==`` begins a case, a line of ``--`` ends its
text; below it stand its diagnostics: place, code, message, help, second places, and the text as the fix leaves it.
``--update-golden`` writes what is found.
"""

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenic.compiler.fixes import apply_fixes
from scenic.compiler.generated import WORDS
from scenic.compiler.parser import parse
from scenic.language.diagnostics import Diagnostic
from scenic.language.spans import Span

FOLDER = Path(__file__).parent.parent / "data" / "messages"
FILES = sorted(FOLDER.glob("*.txt"))


def read_cases(path: Path) -> list[tuple[str, str]]:
    """Texts and what stands below them."""
    cases = []
    for part in ("\n" + path.read_text(encoding="utf-8")).split("\n==\n")[1:]:
        text, _, report = part.partition("\n--\n")
        cases.append((text, report.strip("\n")))
    return cases


def written(cases: list[tuple[str, str]]) -> str:
    return "".join(f"==\n{text}\n--\n{report}\n" for text, report in cases)


def place(span: Span | None) -> str:
    assert span is not None
    return f"{span.line}:{span.column}-{span.end_line}:{span.end_column}"


def report(text: str) -> str:
    lines = []
    for found in parse(text + "\n").diagnostics:
        lines.append(f"{place(found.span)} {found.code} {found.message}")
        if found.help:
            lines.append(f"  help: {found.help}")
        lines += [f"  {place(label.span)}: {label.text}" for label in found.labels]
        if found.fix is not None:
            lines.append(f"  fix: {found.fix.title}")
            lines += [f"    {line}".rstrip() for line in apply_fixes(text, [found.fix])[0].split("\n")]
    return "\n".join(lines)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_what_is_said(path: Path, request: pytest.FixtureRequest) -> None:
    cases = read_cases(path)
    found = [(text, report(text)) for text, _ in cases]
    if request.config.getoption("--update-golden"):
        path.write_text(written(found), encoding="utf-8")
        cases = found
    assert found == cases


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_fix_leaves_nothing_of_the_mistake(path: Path) -> None:
    for text, _ in read_cases(path):
        for found in parse(text + "\n").diagnostics:
            if found.fix is not None:
                assert not similar(found, apply_fixes(text, [found.fix])[0]), text


def similar(before: Diagnostic, text: str) -> list[Diagnostic]:
    """The diagnostics of ``text`` that say the same of the same line as one did."""

    def said(each: Diagnostic) -> tuple[str, str, int]:
        assert each.span is not None
        return each.code, each.message, each.span.line

    return [each for each in parse(text + "\n").diagnostics if said(each) == said(before)]


TEXTS = [text for path in FILES for text, _ in read_cases(path)]
PIECES = [*WORDS, "x", "Chair", "3", "'s'", "\n", "\n    ", "f'{", "}"]


@settings(max_examples=150, deadline=None)
@given(st.sampled_from(TEXTS), st.data())
def test_whatever_the_mistake_is_something_is_said(text: str, data: st.DataObject) -> None:
    """No rule fails on any text, points outside it, or suggests what is not there to be changed."""
    tokens = re.findall(r"\s+|\w+|[^\w\s]", text)
    for _ in range(data.draw(st.integers(1, 3))):
        index = data.draw(st.integers(0, len(tokens)))
        tokens[index : index + data.draw(st.integers(0, 1))] = [f" {data.draw(st.sampled_from(PIECES))} "]
    broken = "".join(tokens) + "\n"
    lines = broken.split("\n")
    for found in parse(broken).diagnostics:
        assert found.span is not None
        assert found.message
        assert "``" not in found.message.replace("```", "")
        spans = [found.span, *(label.span for label in found.labels)]
        spans += [edit.span for edit in found.fix.edits] if found.fix else []
        for span in spans:
            assert span.column <= len(lines[span.line - 1])
            assert span.end_column <= len(lines[span.end_line - 1])
        if found.fix is not None:
            assert apply_fixes(broken, [found.fix]) != (broken, 0)


@pytest.mark.parametrize(
    "text", ["alpha beta", "total = count items", "new Chair at point north", "x = fan[1 lamp]"]
)
def test_plain_names_are_not_taken_for_misspelt_keywords(text: str) -> None:
    assert "SC118" not in {found.code for found in parse(text).diagnostics}


@pytest.mark.parametrize(
    "text", ["behavoir = 3", "x = moniter + 3", "f(requier)", "wiht(x)", "require alway(x)", "pram: 3"]
)
def test_what_can_be_read_is_never_corrected(text: str) -> None:
    assert parse(text).diagnostics == ()


def test_long_lines_are_explained_without_trials() -> None:
    (found,) = parse(f"x = [{' '.join(f'a{index}' for index in range(1000))}]").diagnostics
    assert (found.code, found.fix) == ("SC113", None)


def test_there_are_many() -> None:
    assert sum(len(read_cases(path)) for path in FILES) >= 300
