"""Programs that nest very deeply: every request is answered, and the server goes on."""

from typing import Any

import pytest

from tests.lsp.client import FULL, Client, Refused

INTERNAL_ERROR = -32603
URI = "file:///nowhere/deep.scenic"
PROGRAMS = {
    "operators": "x = 1" + " + 1" * 1953,
    "brackets": "x = " + "(" * 976 + "1" + ")" * 976,
    "tuples": "(" * 900 + "x," + "),".join([""] * 900) + ") = 1",
    "attributes": "x = ego" + ".position" * 1900,
    "blocks": "".join(f"{' ' * depth}if x:\n" for depth in range(1386)) + " " * 1386 + "y = 1\n",
    "branches": "if x:\n    y = 1\n" + "elif x:\n    y = 1\n" * 488,
    "functions": "".join(f"{' ' * depth}def f{depth}():\n" for depth in range(400)) + " " * 400 + "pass\n",
}
ANYWHERE = ("documentSymbol", "foldingRange", "formatting", "semanticTokens/full", "diagnostic", "codeLens")
AT_A_PLACE = (
    "hover",
    "definition",
    "completion",
    "signatureHelp",
    "documentHighlight",
    "references",
    "prepareRename",
)


@pytest.fixture(scope="module")
def client() -> Any:
    client = Client(strict=False)
    client.start(FULL)
    yield client
    assert client.leave() == 0
    client.end()


@pytest.mark.parametrize("name", PROGRAMS)
def test_deep_programs_are_answered(client: Client, name: str) -> None:
    text = PROGRAMS[name]
    client.open(URI, text)
    lines = text.split("\n")
    document = {"textDocument": {"uri": URI}}
    last = next(number for number in reversed(range(len(lines))) if lines[number])
    place = {"line": last, "character": len(lines[last]) // 2}
    whole = {"start": {"line": 0, "character": 0}, "end": {"line": last, "character": len(lines[last])}}
    requests: list[tuple[str, dict[str, Any]]] = [
        ("selectionRange", {"positions": [place]}),
        ("inlayHint", {"range": whole}),
        ("codeAction", {"range": {"start": place, "end": place}, "context": {"diagnostics": []}}),
        *((method, {}) for method in ANYWHERE),
        *((method, {"position": place, "context": {"includeDeclaration": True}}) for method in AT_A_PLACE),
    ]
    failed = []
    for method, params in requests:
        try:
            client.request(f"textDocument/{method}", {**document, **params})
        except Refused as error:
            if error.code == INTERNAL_ERROR:
                failed.append((method, error.message))
    assert not failed
    client.send("textDocument/didClose", document)


def test_selections_are_cut(client: Client) -> None:
    client.open(URI, PROGRAMS["operators"])
    place = {"line": 0, "character": 4}
    (found,) = client.request(
        "textDocument/selectionRange", {"textDocument": {"uri": URI}, "positions": [place]}
    )
    ranges = []
    while found is not None:
        ranges.append(found["range"])
        found = found.get("parent")
    assert len(ranges) == 100
    assert ranges[0]["end"] == {"line": 0, "character": 5}
    assert ranges[-1]["end"] == {"line": 0, "character": len(PROGRAMS["operators"])}
    client.send("textDocument/didClose", {"textDocument": {"uri": URI}})
