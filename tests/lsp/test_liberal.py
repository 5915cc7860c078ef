"""Requests of clients that leave fields out, and answers without `null` where clients read it as a value."""

from typing import Any

import pytest
from lsprotocol import converters, types

from scenic.lsp.liberal import completed

PLACE = {"textDocument": {"uri": "file:///a.scenic"}, "position": {"line": 0, "character": 1}}
RANGE = {
    "textDocument": {"uri": "file:///a.scenic"},
    "range": {"start": PLACE["position"], "end": PLACE["position"]},
}


@pytest.mark.parametrize(
    ("method", "params"),
    [
        (types.TEXT_DOCUMENT_SIGNATURE_HELP, {**PLACE, "context": {"triggerKind": 1}}),
        (types.TEXT_DOCUMENT_SIGNATURE_HELP, {**PLACE, "context": {}}),
        (types.TEXT_DOCUMENT_SIGNATURE_HELP, PLACE),
        (types.TEXT_DOCUMENT_COMPLETION, {**PLACE, "context": {}}),
        (types.TEXT_DOCUMENT_REFERENCES, PLACE),
        (types.TEXT_DOCUMENT_CODE_ACTION, RANGE),
        (types.TEXT_DOCUMENT_CODE_ACTION, {**RANGE, "context": {"only": ["quickfix"]}}),
        (types.TEXT_DOCUMENT_FORMATTING, {"textDocument": PLACE["textDocument"]}),
        (types.TEXT_DOCUMENT_FORMATTING, {"textDocument": PLACE["textDocument"], "options": {"tabSize": 2}}),
        (types.TEXT_DOCUMENT_DID_OPEN, {"textDocument": {"uri": "file:///a.scenic", "text": "x = 1"}}),
        (types.INITIALIZE, {}),
    ],
)
def test_missing_fields_are_no_error(method: str, params: dict[str, Any]) -> None:
    kind: Any = types.METHOD_TO_TYPES[method][2]
    converters.get_converter().structure(completed(method, params), kind)


def test_given_fields_stay() -> None:
    params = {**RANGE, "context": {"only": ["quickfix"], "diagnostics": []}}
    assert completed(types.TEXT_DOCUMENT_CODE_ACTION, params) == params
    assert completed(types.TEXT_DOCUMENT_HOVER, [1]) == [1]
