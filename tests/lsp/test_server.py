"""The server as an editor meets it: a process that speaks JSON-RPC over its standard input and output."""

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import pytest

from scenic.compiler.check import check_text

ROOT = Path(__file__).parents[2]
PATIENCE = 30.0
"""Seconds to wait for an answer before the test fails."""


class Client:
    """The least of an editor; waits for no message longer than `PATIENCE`."""

    def __init__(self) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "scenic.cli.main", "lsp"],
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        self._messages: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self._kept: list[dict[str, Any]] = []
        self._count = 0
        assert self.process.stdout is not None
        self._reader = threading.Thread(target=self._read, args=(self.process.stdout,), daemon=True)
        self._reader.start()

    def _read(self, stream: BinaryIO) -> None:
        while header := stream.readline():
            length = 0
            while header.strip():
                name, _, value = header.partition(b":")
                length = int(value) if name.lower() == b"content-length" else length
                header = stream.readline()
            self._messages.put(json.loads(stream.read(length)))
        self._messages.put(None)

    def send(self, method: str, params: object, **others: object) -> None:
        body = json.dumps({"jsonrpc": "2.0", "method": method, "params": params, **others}).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self.process.stdin.flush()

    def request(self, method: str, params: object = None) -> Any:
        self._count += 1
        self.send(method, params, id=self._count)
        answer = self.wait(lambda message: message.get("id") == self._count and "method" not in message)
        assert "error" not in answer, answer
        return answer["result"]

    def published(self, uri: str) -> dict[str, Any]:
        message = self.wait(
            lambda each: (
                each.get("method") == "textDocument/publishDiagnostics" and each["params"]["uri"] == uri
            )
        )
        params: dict[str, Any] = message["params"]
        return params

    def wait(self, wanted: Any) -> dict[str, Any]:
        for index, message in enumerate(self._kept):
            if wanted(message):
                return self._kept.pop(index)
        while True:
            received = self._messages.get(timeout=PATIENCE)
            assert received is not None, "the server has gone"
            if wanted(received):
                return received
            self._kept.append(received)

    def start(self, *encodings: str) -> dict[str, Any]:
        capabilities = {"general": {"positionEncodings": list(encodings)}} if encodings else {}
        result = self.request(
            "initialize", {"processId": None, "rootUri": None, "capabilities": capabilities}
        )
        self.send("initialized", {})
        found: dict[str, Any] = result["capabilities"]
        return found

    def open(self, uri: str, text: str) -> None:
        document = {"uri": uri, "languageId": "scenic", "version": 1, "text": text}
        self.send("textDocument/didOpen", {"textDocument": document})

    def change(self, uri: str, text: str, version: int) -> None:
        document = {"uri": uri, "version": version}
        self.send("textDocument/didChange", {"textDocument": document, "contentChanges": [{"text": text}]})

    def end(self) -> None:
        self.process.kill()
        self.process.wait(PATIENCE)
        self._reader.join(PATIENCE)
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            assert stream is not None
            stream.close()


@pytest.fixture
def client() -> Iterator[Client]:
    client = Client()
    try:
        yield client
    finally:
        client.end()


def in_units(line: str, units: int, codec: str, size: int) -> int:
    return len(line.encode(codec)[: units * size].decode(codec))


@pytest.mark.parametrize(
    ("encoding", "codec", "size"), [("utf-8", "utf-8", 1), ("", "utf-16-le", 2), ("utf-32", "utf-32-le", 4)]
)
def test_a_session(client: Client, tmp_path: Path, encoding: str, codec: str, size: int) -> None:
    file = tmp_path / "room.scenic"
    uri = file.as_uri()
    broken = "ego = new Object at (0, 0)\nname = '😀é'; require (1 > $\nx = undefined_name\n"

    capabilities = client.start(*([encoding] if encoding else []))
    assert capabilities["positionEncoding"] == (encoding or "utf-16")
    assert capabilities["hoverProvider"]

    client.open(uri, broken)
    published = client.published(uri)
    lines = broken.split("\n")
    expected = check_text(broken, filename=str(file))
    assert len(expected) > 1
    assert published["version"] == 1
    assert [
        (
            item["code"],
            item["message"],
            item["range"]["start"]["line"] + 1,
            in_units(lines[item["range"]["start"]["line"]], item["range"]["start"]["character"], codec, size),
        )
        for item in published["diagnostics"]
    ] == [
        (
            item.code,
            item.message + (f"\nhelp: {item.help}" if item.help else ""),
            item.span.line if item.span else 1,
            item.span.column if item.span else 0,
        )
        for item in expected
    ]

    fixed = "ego = new Object at (0, 0)\nname = '😀é'; require 1 > 0.5 deg\n"
    client.change(uri, broken + "#", 2)
    client.change(uri, fixed, 3)
    published = client.published(uri)
    # The first change was followed by another one at once: only the second is checked.
    assert (published["version"], published["diagnostics"]) == (3, [])

    position = {
        "line": 1,
        "character": len(fixed.split("\n")[1].partition("require")[0].encode(codec)) // size + 2,
    }
    hover = client.request("textDocument/hover", {"textDocument": {"uri": uri}, "position": position})
    assert "require" in hover["contents"]["value"]
    assert hover["range"]["start"] == {"line": 1, "character": position["character"] - 2}
    nothing = {"line": 1, "character": 5}
    assert client.request("textDocument/hover", {"textDocument": {"uri": uri}, "position": nothing}) is None

    client.open(tmp_path.joinpath("other.scenic").as_uri(), "x = (")
    assert client.published(tmp_path.joinpath("other.scenic").as_uri())["diagnostics"]
    client.change(uri, broken, 4)
    client.send("textDocument/didClose", {"textDocument": {"uri": uri}})
    assert client.published(uri)["diagnostics"] == []

    client.request("shutdown")
    client.send("exit", None)
    assert client.process.wait(PATIENCE) == 0
    # Nothing but the two answers: the check of the closed document was given up.
    assert not [each for each in client._kept if each.get("method") == "textDocument/publishDiagnostics"]


def test_exit_without_shutdown(client: Client) -> None:
    client.start()
    client.send("exit", None)
    assert client.process.wait(PATIENCE) == 1


def test_the_editor_goes_away(client: Client) -> None:
    client.start()
    assert client.process.stdin is not None
    client.process.stdin.close()
    assert client.process.wait(PATIENCE) == 0


def test_settings_and_ignore_comments_hold_in_the_editor(client: Client, tmp_path: Path) -> None:
    settings = tmp_path / "pyproject.toml"
    settings.write_text('[tool.scenic]\nignore = ["SC390"]\nseverity = { SC300 = "error" }\nselct = []\n')
    uri = (tmp_path / "room.scenic").as_uri()
    client.start()
    client.open(uri, "ego = new Object with wdth 3\nx = 1  # scenic: ignore\n")
    (found,) = client.published(uri)["diagnostics"]
    assert (found["code"], found["severity"]) == ("SC300", 1)
    (problem,) = client.published(settings.as_uri())["diagnostics"]
    assert (problem["code"], problem["range"]["start"]) == ("SC606", {"line": 3, "character": 0})

    settings.write_text("[tool.scenic]\n")
    client.change(uri, "ego = new Object with wdth 3  # scenic: ignore[SC300]\n", 2)
    assert client.published(uri)["diagnostics"] == []
    assert client.published(settings.as_uri())["diagnostics"] == []


def applied(text: str, edits: list[dict[str, Any]]) -> str:
    """A text after changes by the protocol, with columns in code units of UTF-16."""
    lines = text.split("\n")

    def offset(position: dict[str, int]) -> int:
        before = lines[position["line"]].encode("utf-16-le")[: 2 * position["character"]]
        return len("\n".join([*lines[: position["line"]], before.decode("utf-16-le")]))

    for edit in sorted(edits, key=lambda each: offset(each["range"]["start"]), reverse=True):
        start, end = (offset(edit["range"][which]) for which in ("start", "end"))
        text = text[:start] + edit["newText"] + text[end:]
    return text


def test_repairs_are_offered(client: Client, tmp_path: Path) -> None:
    uri = (tmp_path / "room.scenic").as_uri()
    text = "import os\r\nego = new Object with name '😀', with wdth 3\r\nif True\r\n    pass\r\n"
    provider = client.start()["codeActionProvider"]
    assert provider["codeActionKinds"] == ["quickfix", "source.fixAll.scenic"]
    client.open(uri, text)
    client.published(uri)

    def actions(line: int, character: int, **context: object) -> list[dict[str, Any]]:
        place = {"line": line, "character": character}
        params = {
            "textDocument": {"uri": uri},
            "range": {"start": place, "end": place},
            "context": {"diagnostics": [], **context},
        }
        found: list[dict[str, Any]] = client.request("textDocument/codeAction", params) or []
        return found

    # Columns count two units for the smiling face.
    column = text.split("\n")[1].index("wdth") + 1
    action, silence = actions(1, column, triggerKind=2)
    assert applied(text, silence["edit"]["changes"][uri]) == text.replace(
        "wdth 3", "wdth 3  # scenic: ignore[SC300]"
    )
    assert (action["title"], action["kind"], action["isPreferred"]) == ("Write `width`", "quickfix", True)
    assert action["diagnostics"][0]["code"] == "SC300"
    assert applied(text, action["edit"]["changes"][uri]) == text.replace("wdth", "width")
    (whole,) = actions(1, column, only=["source"])
    assert whole["kind"] == "source.fixAll.scenic"
    repaired = applied(text, whole["edit"]["changes"][uri])
    assert repaired == text.replace("import os\r\n", "").replace("wdth", "width").replace("True", "True:")
    assert [each["kind"] for each in actions(1, column)] == ["quickfix", "quickfix", "source.fixAll.scenic"]
    assert actions(1, column, only=["refactor", "quick"]) == []
    assert actions(1, 0, only=["quickfix"]) == []
    client.change(uri, "x = 1\n", 2)
    assert actions(0, 0) == []
