"""Ten thousand random edits: nothing fails, and what is said in the end is what a fresh server says of the same text."""

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from scenic.language.source import Source
from tests.lsp.client import FULL, Client

ROOT = Path(__file__).parents[2]
PROGRAMS = sorted(
    [*ROOT.glob("tests/data/**/*.scenic"), *ROOT.glob("examples/**/*.scenic")],
    key=lambda file: (-min(file.stat().st_size, 4000), file.name),
)[:20]
TEXTS = [Source(file.read_text(encoding="utf-8"), "").text for file in PROGRAMS]
EDITS, EVERY = 200, 100
SNIPPETS = (
    *"()[]{}\"'#:x@\\,😀é ",
    "\n",
    "\r\n",
    '"""',
    "    ",
    "\n    ",
    "new Object at ",
    "f'{",
    "\t",
    "\ufeff",
    "\x00",
    "\ud83d\ude00",
)


@pytest.fixture(scope="module")
def servers() -> Iterator[tuple[Client, Client]]:
    pair = Client(), Client()
    for client in pair:
        client.start(FULL)
    yield pair
    for client in pair:
        assert client.leave() == 0
        log = b"".join(client.log).decode()
        assert "Error" not in log, log[-3000:]
        errors = [each for each in client.kept if each.get("method") == "window/logMessage"]
        assert not errors, errors
        client.end()


def said(client: Client, uri: str) -> list[Any]:
    """What a server says of a document."""
    document = {"textDocument": {"uri": uri}}
    return [
        client.request("textDocument/diagnostic", document)["items"],
        client.request("textDocument/semanticTokens/full", document)["data"],
        client.request("textDocument/documentSymbol", document),
        client.request("textDocument/foldingRange", document),
    ]


@pytest.mark.slow
@pytest.mark.parametrize("index", range(len(PROGRAMS)))
def test_random_edits(servers: tuple[Client, Client], index: int) -> None:
    client, fresh = servers
    chance = random.Random(index)
    uri = f"file:///nowhere/{index}.scenic"
    text = TEXTS[index]
    client.open(uri, text)
    for count in range(1, EDITS + 1):
        lines = text.split("\n")
        first = chance.randrange(len(lines))
        start = chance.randint(0, len(lines[first]))
        last = min(len(lines) - 1, first + chance.choice([0, 0, 0, 0, 1, 3]))
        end = chance.randint(start if last == first else 0, len(lines[last]))
        if chance.random() < 0.6:
            last, end = first, start
        new = chance.choice(SNIPPETS)
        if chance.random() < 0.03:
            other = chance.choice(TEXTS)
            new = other[: len(other) // 2] if chance.random() < 0.5 else other[len(other) // 2 :]
        new = new.replace("\r\n", "\n").encode("utf-16", "surrogatepass").decode("utf-16", "replace")
        if len(text) > 8000:
            text = TEXTS[index]
            client.change(uri, text)
            continue
        units = [len(lines[n][:c].encode("utf-16-le")) // 2 for n, c in ((first, start), (last, end))]
        client.change(uri, ((first, units[0]), (last, units[1]), new))
        text = "\n".join([*lines[:first], lines[first][:start] + new + lines[last][end:], *lines[last + 1 :]])
        if chance.random() < 0.1:
            place = {"textDocument": {"uri": uri}, "position": {"line": first, "character": units[0]}}
            for method in ("hover", "completion", "signatureHelp", "definition", "documentHighlight"):
                client.request(f"textDocument/{method}", place)
        if count % EVERY == 0:
            fresh.open(uri, text)
            assert said(client, uri) == said(fresh, uri)
            fresh.send("textDocument/didClose", {"textDocument": {"uri": uri}})
    client.send("textDocument/didClose", {"textDocument": {"uri": uri}})
