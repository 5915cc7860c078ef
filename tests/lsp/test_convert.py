from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types

from scenic.ide.hover import Hover
from scenic.language.diagnostics import Diagnostic, Edit, Label, Severity
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.lsp.convert import from_position, from_range, to_diagnostic, to_edits, to_hover, to_range

ENCODINGS = {
    types.PositionEncodingKind.Utf8: "utf-8",
    types.PositionEncodingKind.Utf16: "utf-16-le",
    types.PositionEncodingKind.Utf32: "utf-32-le",
}
UNIT = {"utf-8": 1, "utf-16-le": 2, "utf-32-le": 4}


@given(st.text("aé€😀", max_size=10), st.data(), st.sampled_from(sorted(ENCODINGS)))
def test_columns_count_code_units(
    line: str, data: st.DataObject, encoding: types.PositionEncodingKind
) -> None:
    source = Source(f"x\n{line}\n", "f")
    column = data.draw(st.integers(0, len(line)))
    position = to_range(Span(2, column, 2, column), source, encoding).start
    codec = ENCODINGS[encoding]
    assert position == types.Position(1, len(line[:column].encode(codec)) // UNIT[codec])
    assert from_position(position, source, encoding) == (2, column)


def test_positions_inside_characters_and_outside_lines() -> None:
    source = Source("a😀b", "f")
    utf16 = types.PositionEncodingKind.Utf16
    found = [from_position(types.Position(0, units), source, utf16)[1] for units in range(7)]
    assert found == [0, 1, 1, 2, 3, 3, 3]
    assert from_position(types.Position(7, 3), source, utf16) == (8, 0)


def test_diagnostics() -> None:
    source = Source("😀 = (\n", "f")
    diagnostic = Diagnostic(
        "SC103",
        "open",
        Span(1, 4, 1, 5),
        Severity.WARNING,
        help="close",
        labels=(Label(Span(1, 0, 1, 1), "here"),),
    )
    found = to_diagnostic(diagnostic, source, "file:///f", types.PositionEncodingKind.Utf16)
    assert found.range == types.Range(types.Position(0, 5), types.Position(0, 6))
    assert (found.code, found.source, found.severity) == ("SC103", "scenic", types.DiagnosticSeverity.Warning)
    assert found.message == "open\nhelp: close"
    assert found.related_information is not None
    assert found.related_information[0].location.range.end == types.Position(0, 2)
    nowhere = to_diagnostic(Diagnostic("SC600", "none"), source, "file:///f", types.PositionEncodingKind.Utf8)
    assert nowhere.range == types.Range(types.Position(0, 0), types.Position(0, 0))
    assert nowhere.related_information is None


def test_what_can_be_left_out_is_marked() -> None:
    source = Source("import os\n", "f")
    codes = ("SC206", "SC300")
    tags = [to_diagnostic(Diagnostic(code, "m"), source, "file:///f", "utf-8").tags for code in codes]
    assert tags == [[types.DiagnosticTag.Unnecessary], None]


def test_ranges_and_changes() -> None:
    source = Source("😀x\ny", "f")
    utf16 = types.PositionEncodingKind.Utf16
    span = Span(1, 1, 2, 0)
    found = to_edits([Edit(span, "a\nb")], source, utf16, "\r\n")
    given_range = types.Range(types.Position(0, 2), types.Position(1, 0))
    assert found == [types.TextEdit(given_range, "a\r\nb")]
    assert from_range(given_range, source, utf16) == span
    backwards = types.Range(types.Position(1, 1), types.Position(0, 0))
    assert from_range(backwards, source, utf16) == Span(2, 1, 2, 1)


def test_hover() -> None:
    found = to_hover(Hover("**x**", Span(1, 1, 1, 2)), Source("😀x", "f"), types.PositionEncodingKind.Utf8)
    assert found.contents == types.MarkupContent(types.MarkupKind.Markdown, "**x**")
    assert found.range == types.Range(types.Position(0, 4), types.Position(0, 5))
