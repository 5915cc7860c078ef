from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types

from scenic.language.diagnostics import Diagnostic, Edit, Label, Severity
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.lsp.convert import Encoding, Lines, to_diagnostic

CODECS = {Encoding.UTF8: ("utf-8", 1), Encoding.UTF16: ("utf-16-le", 2), Encoding.UTF32: ("utf-32-le", 4)}


def lines(text: str, encoding: Encoding = Encoding.UTF16) -> Lines:
    marks = len(text) - len(text.lstrip("\ufeff"))
    return Lines(Source(text, "f"), encoding, marks)


@given(st.text("aé€😀", max_size=10), st.data(), st.sampled_from(Encoding), st.integers(0, 1))
def test_columns_count_code_units(line: str, data: st.DataObject, encoding: Encoding, marks: int) -> None:
    first = data.draw(st.booleans())
    text = "\ufeff" * marks + (f"{line}\nx" if first else f"x\n{line}\n")
    number = 1 if first else 2
    column = data.draw(st.integers(0, len(line)))
    codec, size = CODECS[encoding]
    before = ("\ufeff" * marks if first else "") + line[:column]
    position = lines(text, encoding).to_position(number, column)
    assert position == types.Position(number - 1, len(before.encode(codec)) // size)
    assert lines(text, encoding).from_position(position) == (number, column)


def test_positions_inside_characters_and_outside_lines() -> None:
    found = [lines("a😀b").from_position(types.Position(0, units))[1] for units in range(7)]
    assert found == [0, 1, 1, 2, 3, 3, 3]
    assert lines("a😀b").from_position(types.Position(7, 3)) == (1, 3)
    assert lines("ab\ncd").from_position(types.Position(1, 9)) == (2, 2)


def test_a_byte_order_mark_is_a_character_of_the_first_line() -> None:
    marked = lines("\ufeffab\ncd", Encoding.UTF8)
    assert marked.to_position(1, 1) == types.Position(0, 4)
    assert marked.to_position(2, 1) == types.Position(1, 1)
    assert [marked.from_position(types.Position(0, units))[1] for units in range(6)] == [0, 0, 0, 0, 1, 2]


def test_diagnostics() -> None:
    diagnostic = Diagnostic(
        "SC103",
        "open",
        Span(1, 4, 1, 5),
        Severity.WARNING,
        help="close",
        labels=(Label(Span(1, 0, 1, 1), "here"),),
    )
    found = to_diagnostic(diagnostic, lines("😀 = (\n"), "file:///f")
    assert found.range == types.Range(types.Position(0, 5), types.Position(0, 6))
    assert (found.code, found.source, found.severity) == ("SC103", "scenic", types.DiagnosticSeverity.Warning)
    assert found.message == "open\nhelp: close"
    (related,) = found.related_information or ()
    assert related.message == "here"
    assert related.location.range.end == types.Position(0, 2)
    nowhere = to_diagnostic(Diagnostic("SC600", "none"), lines("", Encoding.UTF8), "file:///f")
    assert nowhere.range == types.Range(types.Position(0, 0), types.Position(0, 0))
    assert nowhere.related_information is None


def test_clients_are_told_no_more_than_they_can_show() -> None:
    labelled = Diagnostic("SC206", "unused", Span(1, 0, 1, 1), labels=(Label(Span(1, 2, 1, 3), "here"),))
    found = to_diagnostic(labelled, lines("a b"), "file:///f", related=False, tags=False)
    assert found.message == "unused\nline 1: here"
    assert (found.related_information, found.tags, found.code_description) == (None, None, None)


def test_what_can_be_left_out_is_marked() -> None:
    codes = ("SC206", "SC300")
    tags = [to_diagnostic(Diagnostic(code, "m"), lines("import os\n"), "file:///f").tags for code in codes]
    assert tags == [[types.DiagnosticTag.Unnecessary], None]


def test_ranges_and_changes() -> None:
    converted = lines("😀x\ny")
    span = Span(1, 1, 2, 0)
    given_range = types.Range(types.Position(0, 2), types.Position(1, 0))
    assert converted.to_edits([Edit(span, "a\nb")], "\r\n") == [types.TextEdit(given_range, "a\r\nb")]
    assert converted.from_range(given_range) == span
    assert converted.from_range(types.Range(types.Position(1, 1), types.Position(0, 0))) == Span(2, 1, 2, 1)
