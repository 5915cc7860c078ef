"""Ignore comments, on the warning SC300 (a misspelt property) and errors of several kinds."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.compiler.check import check_text
from scenic.compiler.fixes import apply_fixes
from scenic.compiler.suppression_comments import apply_ignores
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.spans import Span

WARNED = "ego = new Object with wdth 3"


def codes(text: str) -> list[str]:
    return [f"{item.span.line if item.span else 0}:{item.code}" for item in check_text(text, filename="f")]


@pytest.mark.parametrize(
    "comment",
    [
        "# scenic: ignore",
        "#scenic:ignore",
        "# scenic: ignore[SC300]",
        "# scenic: ignore[SC3]",
        "# scenic: ignore[SC]",
        "# scenic:  ignore [ SC300 ] the width is meant so",
        "# see below # scenic: ignore[SC300]  # more",
        "# scenic: ignore since it is meant so",
    ],
)
def test_a_warning_is_silenced(comment: str) -> None:
    assert codes(f"{WARNED}\n") == ["1:SC300"]
    assert codes(f"{WARNED} {comment}\n") == []
    assert codes(f"{WARNED} {comment}") == []
    assert codes(f"{WARNED} {comment}\r\nx = 1\r\n") == []


def test_other_comments_silence_nothing() -> None:
    for comment in ("# scenic: a language", "# scenic", "# ignore[SC300]", "# noqa", "# escenic: ignore"):
        assert codes(f"{WARNED} {comment}\n") == ["1:SC300"]


def test_strings_are_no_comments() -> None:
    assert codes("ego = new Object with wdth '# scenic: ignore[SC300]'\n") == ["1:SC300"]
    assert codes("x = '''\n# scenic: ignore-file[SC300]\n'''\n" + WARNED) == ["4:SC300"]
    assert codes("x = f'{1}# scenic: ignore'\n") == []


def test_a_tuple_that_ends_with_a_comma_does_not_go_on() -> None:
    assert codes(f"x = 1,\n{WARNED}\ny = 1,  # scenic: ignore[SC300]\n") == ["2:SC300", "3:SC390"]
    text = "ego = new Object with height 1,\n    with wdth 3,\n    with width 3\nx = 1,  # scenic: ignore[SC300]\n"
    assert codes(text) == ["2:SC300", "4:SC390"]


@pytest.mark.parametrize("brackets", [False, True])
@pytest.mark.parametrize(("line", "silenced"), [(1, True), (2, False), (3, True), (4, True)])
def test_statements_over_several_lines(line: int, silenced: bool, brackets: bool) -> None:
    lines = ["ego = new Object with width 1,", "    with height 2,", "    with wdth 3,", "    with length 4"]
    if brackets:
        lines = ["ego = (new Object with width 1,", *lines[1:3], "    with length 4)"]
    lines[line - 1] += "  # scenic: ignore[SC300]"
    found = codes("\n".join(lines) + "\n")
    assert found == ([] if silenced else ["2:SC390", "3:SC300"])


def test_the_header_of_a_block_is_not_its_body() -> None:
    assert codes("for x in ():  # scenic: ignore[SC300]\n    ego = new Object with wdth 3\n") == [
        "1:SC390",
        "2:SC300",
    ]
    assert codes("x = '''\n'''; ego = new Object with wdth 3  # scenic: ignore[SC300]\n") == []


def test_whole_files() -> None:
    text = f"{WARNED}\nfor i in ():\n    x = new Object with heigt 2\n"
    assert codes(text) == ["1:SC300", "3:SC300"]
    assert codes(f"# About this file.\n# scenic: ignore-file[SC300]\n{text}") == []
    assert codes(f"# scenic: ignore-file\n{text}") == []
    assert codes(f"x = 1\n# scenic: ignore-file[SC300]\n{text}") == ["2:SC391", "3:SC300", "5:SC300"]
    assert codes("# scenic: ignore-file[SC300]\nx = 1\n") == ["1:SC390"]
    assert codes("# scenic: ignore-file[SC300]\n") == ["1:SC390"]


def test_errors_need_their_code_and_those_of_syntax_last() -> None:
    assert codes("x = undefined_name  # scenic: ignore\n") == ["1:SC202"]
    assert codes("x = undefined_name  # scenic: ignore[SC202]\n") == []
    assert codes("x = (  # scenic: ignore[SC103]\n") == ["1:SC103"]
    assert codes("# scenic: ignore-file[SC1]\nx = 1 +\n") == ["2:SC110"]


def test_unused_comments_and_codes() -> None:
    assert codes("x = 1  # scenic: ignore\n") == ["1:SC390"]
    assert codes("x = 1  # scenic: ignore[SC300, SC202]\n") == ["1:SC390"]
    assert codes(f"{WARNED}  # scenic: ignore[SC300, SC202]\n") == ["1:SC390"]
    assert codes(f"{WARNED}  # scenic: ignore[SC300, SC300]\n") == ["1:SC390"]
    # What only a run could find is not called unused.
    assert codes("x = 1  # scenic: ignore[SC701]\n") == []
    # With errors, not everything has been looked for.
    assert codes("x = 1  # scenic: ignore[SC300]\ny = undefined_name\n") == ["2:SC202"]


def test_a_comment_can_be_meant_to_stay_unused() -> None:
    assert codes("x = 1  # scenic: ignore[SC300, SC390]\n") == []
    assert codes("# scenic: ignore-file[SC390]\nx = 1  # scenic: ignore[SC300]\n") == []
    assert codes("x = 1  # scenic: ignore[SC390]\n") == ["1:SC390"]
    assert codes("x = 1  # scenic: ignore[SC8O0, SC391]\n") == []


@pytest.mark.parametrize(
    ("comment", "column", "message", "repaired"),
    [
        ("# scenic: ignore[sc300]", 17, "there is no code `sc300`", "# scenic: ignore[SC300]"),
        ("# scenic: ignore[300]", 17, "there is no code `300`", "# scenic: ignore[SC300]"),
        ("# scenic: ignore[SC30O]", 17, "there is no code `SC30O`", None),
        ("# scenic: ignore[banana]", 17, "there is no code `banana`", None),
        ("# scenic: ignore SC300", 16, "the codes of an ignore comment", "# scenic: ignore[SC300]"),
        ("# scenic: ignore: sc300,SC7 x", 16, "the codes of an ignore", "# scenic: ignore[SC300, SC7] x"),
        ("# scenic: ignor[SC300]", 10, "`ignor` silences nothing", "# scenic: ignore[SC300]"),
        ("# scenic: Ignore", 10, "`Ignore` silences nothing", "# scenic: ignore"),
        ("# scenic: ignore_file[SC3]", 10, "`ignore_file` silences", "# scenic: ignore-file[SC3]"),
        ("# scenic: ignore[]", 0, "this ignore comment names no codes", None),
        ("# scenic: ignore[SC300", 0, "the bracket of this ignore comment", None),
    ],
)
def test_comments_that_cannot_be_understood(
    comment: str, column: int, message: str, repaired: str | None
) -> None:
    text = f"{WARNED} {comment}\n"
    first, second = check_text(text, filename="f")
    assert (first.code, second.code, second.severity) == ("SC300", "SC391", Severity.WARNING)
    assert second.message.startswith(message)
    assert second.help
    assert second.span is not None
    assert second.span.column == len(WARNED) + 1 + column
    if repaired is None:
        assert second.fix is None
    else:
        assert second.fix is not None
        assert apply_fixes(text, [second.fix]) == (f"{WARNED} {repaired}\n", 1)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("x = 1  # scenic: ignore[SC300] why\ny = 2\n", "x = 1\ny = 2\n"),
        ("x = 1  # scenic: ignore\r\ny = 2\r\n", "x = 1\r\ny = 2\r\n"),
        ("x = 1  # scenic: ignore", "x = 1"),
        ("x = 1\n  # scenic: ignore\ny = 2\n", "x = 1\ny = 2\n"),
        ("# scenic: ignore", ""),
        ("x = 1  # scenic: ignore  # other\n", "x = 1  # other\n"),
        ("x = 1  # other # scenic: ignore\n", "x = 1  # other\n"),
        (
            f"{WARNED} # scenic: ignore[SC202, SC300 ,SC7,SC210] why\n",
            f"{WARNED} # scenic: ignore[SC300, SC7] why\n",
        ),
    ],
)
def test_repairs_of_unused_comments(before: str, after: str) -> None:
    fixes = [item.fix for item in check_text(before, filename="f") if item.code == "SC390" and item.fix]
    assert apply_fixes(before, fixes) == (after, 1)
    assert codes(after) == []


def test_diagnostics_of_other_origin() -> None:
    text = "# scenic: ignore-file[SC500]\nx = 1  # scenic: ignore[SC701, SC300]\n"
    proved = Diagnostic("SC701", "m", Span(2, 0, 2, 1), Severity.WARNING)
    unplaced = Diagnostic("SC500", "m")
    other = Diagnostic("SC700", "m", Span(2, 0, 2, 1))
    assert apply_ignores(text, [proved, unplaced, other], filename="f", complain=False) == (other,)


@given(st.text(st.sampled_from("#scenic: ignore-file[SC300],\n\"'( x"), max_size=60), st.booleans())
def test_any_comment_is_answered(text: str, placed: bool) -> None:
    text = f"{WARNED} # scenic: {text}" if placed else text
    for item in check_text(text, filename="f"):
        assert item.span is None or item.span.line <= text.count("\n") + 2
        if item.fix is not None and item.code in ("SC390", "SC391"):
            repaired, made = apply_fixes(text, [item.fix])
            assert (made, repaired != text) == (1, True)
