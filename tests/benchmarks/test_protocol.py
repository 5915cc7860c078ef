"""The outside client's model of a document, which was written from the specification, and what the server makes of the same edits."""

import random

import pytest
from lsprotocol import types

from benchmarks.protocol.documents import LINE_ENDS, Model, random_change, width
from scenic.lsp.convert import Encoding, units
from scenic.lsp.documents import changed


@pytest.mark.parametrize("encoding", list(Encoding))
@pytest.mark.parametrize("line_end", list(LINE_ENDS.values()), ids=list(LINE_ENDS))
def test_edits_give_the_text_of_the_model(encoding: Encoding, line_end: str) -> None:
    generator = random.Random(f"{encoding} {line_end!r}")
    text = line_end.join(("x = 'é𝄞\u2028'", "\fy = 3", "", "ego = new Object"))
    model = Model(text, encoding.value)
    for _ in range(150):
        change = random_change(model, generator)
        first, last = (types.Position(**change["range"][end]) for end in ("start", "end"))
        text = changed(
            text, [types.TextDocumentContentChangePartial(types.Range(first, last), change["text"])], encoding
        )
        assert text == model.text


@pytest.mark.parametrize("encoding", list(Encoding))
def test_widths_agree(encoding: Encoding) -> None:
    for text in ("abc", "é", "𝄞", "\u2028\f", "e\u0301", "\ufeff"):
        assert width(text, encoding.value) == units(text, encoding)
