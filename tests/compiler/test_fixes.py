import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.compiler import fixes as module
from scenic.compiler.check import check_text
from scenic.compiler.fixes import apply_fixes, repair
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Severity
from scenic.language.source import Source
from scenic.language.spans import Span


def fix(*edits: tuple[int, int, int, int, str]) -> Fix:
    return Fix("t", tuple(Edit(Span(*edit[:4]), edit[4]) for edit in edits))


def test_several_edits() -> None:
    text = "abc\ndef\nghi"
    assert apply_fixes(text, [fix((1, 0, 1, 1, "XY"), (3, 3, 3, 3, "!"))]) == ("XYbc\ndef\nghi!", 1)
    assert apply_fixes(text, [fix((1, 2, 2, 1, ""))]) == ("abef\nghi", 1)
    assert apply_fixes(text, [fix((2, 0, 3, 0, ""))]) == ("abc\nghi", 1)
    assert apply_fixes(text, [fix((1, 99, 1, 99, ";"))]) == ("abc;\ndef\nghi", 1)
    assert apply_fixes(text, [fix((9, 0, 9, 0, ";"))]) == (text + ";", 1)
    assert apply_fixes(text, []) == (text, 0)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_ends_and_marks_are_kept(end: str) -> None:
    text = f"\ufeffäb{end}cd{end}"
    assert apply_fixes(text, [fix((1, 1, 1, 2, "x\ny"), (2, 0, 2, 0, "z"))]) == (
        f"\ufeffäx{end}y{end}zcd{end}",
        1,
    )


def test_of_overlapping_repairs_the_first_is_made() -> None:
    text = "abcdef"
    first, second = fix((1, 0, 1, 3, "X")), fix((1, 2, 1, 4, "Y"))
    assert apply_fixes(text, [second, first]) == ("Xdef", 1)
    assert apply_fixes(text, [fix((1, 1, 1, 1, "X")), fix((1, 1, 1, 1, "Y"))]) == ("aXbcdef", 1)
    # A repair is made as a whole or not at all.
    assert apply_fixes(text, [first, fix((1, 2, 1, 2, "Y"), (1, 5, 1, 5, "Z"))]) == ("Xdef", 1)
    assert apply_fixes(text, [first, fix((1, 3, 1, 4, "Y"))]) == ("XYef", 2)


@given(
    st.text(st.sampled_from("ab\n"), max_size=20),
    st.lists(st.tuples(st.integers(0, 20), st.integers(0, 5), st.text("XY\n", max_size=3)), max_size=6),
)
def test_against_the_plain_definition(text: str, edits: list[tuple[int, int, str]]) -> None:
    """One character after the other is copied, deleted, or has something put in front of it."""
    source = Source(text, "f")

    def place(offset: int) -> tuple[int, int]:
        before = text[:offset].split("\n")
        return len(before), len(before[-1])

    fixes, taken = [], []
    for start, length, new in edits:
        start = min(start, len(text))
        end = min(start + length, len(text))
        fixes.append(fix((*place(start), *place(end), new)))
        taken.append((start, end, new))
    expected, cursor, made = "", 0, 0
    last: tuple[int, int] | None = None
    for start, end, new in sorted(taken):
        if last is not None and (start < last[1] or start == last[0]):
            continue
        expected += text[cursor:start] + new
        cursor, last, made = end, (start, end), made + 1
    assert source.text == text
    assert apply_fixes(text, fixes) == (expected + text[cursor:], made)


def test_repairing_until_nothing_is_left() -> None:
    text = "ego = new Object with wdth 3  # scenic: ignore[300]\n"
    repaired = repair(text, filename="f", shown=lambda found: found)
    assert repaired.count >= 2
    assert repaired.diagnostics == ()
    assert check_text(repaired.text, filename="f") == ()


def test_only_what_is_shown_is_repaired() -> None:
    text = "x = 1  # scenic: ignore\n"
    assert repair(text, filename="f", shown=lambda _: ()).text == text
    assert repair(text, filename="f", shown=lambda found: found).text == "x = 1\n"


def test_a_repair_that_breaks_the_program_is_not_made(monkeypatch: pytest.MonkeyPatch) -> None:
    def checked(text: str, *, filename: str, surroundings_of: None) -> tuple[Diagnostic, ...]:
        # Every `a` asks for a bracket in front of it, and every bracket is an error; every `b` asks for a `c`.
        errors = [Diagnostic("SC103", "m") for _ in range(text.count("("))]
        return (
            *errors,
            *(
                Diagnostic(
                    "SC300",
                    letter,
                    severity=Severity.WARNING,
                    fix=fix((1, index, 1, index + 1, new)),
                )
                for index, letter in enumerate(text)
                for old, new in (("a", "(a"), ("b", "c"))
                if letter == old
            ),
        )

    monkeypatch.setattr(module, "check_text", checked)
    repaired = repair("abab", filename="f", shown=lambda found: found)
    assert (repaired.text, repaired.count) == ("acac", 2)


def test_repairs_that_undo_each_other_end(monkeypatch: pytest.MonkeyPatch) -> None:
    def checked(text: str, *, filename: str, surroundings_of: None) -> tuple[Diagnostic, ...]:
        new = "b" if text == "a" else "a"
        return (Diagnostic("SC300", "m", severity=Severity.WARNING, fix=fix((1, 0, 1, 1, new))),)

    monkeypatch.setattr(module, "check_text", checked)
    assert repair("a", filename="f", shown=lambda found: found).text == "b"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("import os\nx = 1\n", "x = 1\n"),
        # The line before goes on, and may not be the last.
        ("x = 1; \\\n    import os\n", "x = 1; \\\n    pass\n"),
        ("import os; x = 1\n", "pass; x = 1\n"),
    ],
)
def test_an_unused_import_is_removed_with_its_line_if_that_is_its_own(text: str, expected: str) -> None:
    assert repair(text, filename="f", shown=lambda found: found).text == expected


def test_a_condition_that_binds_less_is_negated_as_a_whole() -> None:
    text = "behavior B():\n    do B() while {}\n"
    for condition, negated in (("b", "b"), ("b.x > 1", "b.x > 1"), ("b and c", "(b and c)")):
        found = check_text(text.format(condition), filename="a.scenic")
        (repaired, _) = apply_fixes(
            text.format(condition), [each.fix for each in found if each.code == "SC129" and each.fix]
        )
        assert repaired == text.format(condition).replace(f"while {condition}", f"until not {negated}")
