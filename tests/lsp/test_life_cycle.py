"""The conversation from beginning to end: every request is answered, and by the protocol's rules."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.lsp.client import FULL, PATIENCE, PROGRAM, Client

PARSE_ERROR, INVALID_REQUEST, NO_METHOD, INVALID_PARAMS = -32700, -32600, -32601, -32602
NOT_INITIALIZED, CANCELLED = -32002, -32800
URI = "file:///nowhere/room.scenic"


def place(line: int = 0, character: int = 0, uri: str = URI) -> dict[str, object]:
    return {"textDocument": {"uri": uri}, "position": {"line": line, "character": character}}


def frame(body: bytes, header: bytes = b"Content-Length: %d\r\n\r\n") -> bytes:
    return header % len(body) + body


def test_from_before_the_beginning_to_after_the_end(client: Client) -> None:
    assert client.refused("textDocument/hover", place()) == NOT_INITIALIZED
    assert client.refused("shutdown") == NOT_INITIALIZED
    client.send("textDocument/didOpen", {"textDocument": {"uri": URI, "version": 1, "text": "x = ("}})
    assert client.refused("initialize", []) == INVALID_PARAMS
    client.start()
    assert client.refused("initialize", {"capabilities": {}}) == INVALID_REQUEST
    assert client.refused("textDocument/unheardOf", {}) == NO_METHOD
    assert client.refused("$/unheardOf", {}) == NO_METHOD
    client.send("$/unheardOf", {})
    client.send("unheardOf", {})
    client.send("$/setTrace", {"value": "verbose"})
    client.send("$/cancelRequest", {"id": 99})
    # What was opened before the beginning does not exist.
    assert client.refused("textDocument/hover", place()) == INVALID_PARAMS
    assert client.request("shutdown") is None
    assert client.refused("shutdown") == INVALID_REQUEST
    assert client.refused("textDocument/hover", place()) == INVALID_REQUEST
    assert client.refused("initialize", {"capabilities": {}}) == INVALID_REQUEST
    client.send("textDocument/didOpen", {"textDocument": {"uri": URI, "version": 1, "text": "x = ("}})
    client.send("exit")
    assert client.process.wait(PATIENCE) == 0
    assert not [each for each in client.kept if each.get("method") == "textDocument/publishDiagnostics"]


@pytest.mark.parametrize("begun", [False, True])
def test_exit_without_shutdown(client: Client, begun: bool) -> None:
    if begun:
        client.start()
    client.send("exit")
    assert client.process.wait(PATIENCE) == 1


def test_the_editor_goes_away(client: Client) -> None:
    client.start()
    assert client.process.stdin is not None
    client.process.stdin.close()
    assert client.process.wait(PATIENCE) == 0


@pytest.mark.skipif(sys.platform == "win32", reason="ends a process by a signal")
def test_the_editor_dies(client: Client) -> None:
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as parent:
        client.start(None, processId=parent.pid)
        time.sleep(1.5)
        assert client.process.poll() is None
        parent.send_signal(signal.SIGKILL)
        # It is a zombie until it is waited for.
        assert client.process.wait(PATIENCE) == 1


def test_what_is_no_message_is_refused_and_what_follows_is_answered(client: Client) -> None:
    def error() -> int:
        message = client.wait(lambda each: each.get("id", "") is None)
        code: int = message["error"]["code"]
        return code

    client.start()
    client.raw(frame(b'{"jsonrpc": "2.0", "method"'))
    assert error() == PARSE_ERROR
    client.raw(frame(b"\xff\xfe"))
    assert error() == PARSE_ERROR
    client.raw(frame(b"[" * 100_000))
    assert error() == PARSE_ERROR
    client.raw(frame(b"{}", b"Content-Length: minus %d\r\n\r\n")[:-2])
    assert error() == PARSE_ERROR
    for body in (
        b"3",
        b"[]",
        b"{}",
        b'{"jsonrpc": "1.0", "method": "x"}',
        b'{"jsonrpc": "2.0", "method": 3}',
    ):
        client.raw(frame(body))
        assert error() == INVALID_REQUEST
    client.raw(frame(json.dumps({"jsonrpc": "2.0", "id": None, "method": "shutdown"}).encode()))
    assert error() == INVALID_REQUEST
    client.raw(frame(b'{"jsonrpc": "2.0", "id": 7}'))
    assert client.wait(lambda each: each.get("id") == 7)["error"]["code"] == INVALID_REQUEST
    # Responses to what nobody asked.
    client.raw(frame(b'{"jsonrpc": "2.0", "id": "none", "result": 3}'))
    # Names of header fields in lower case, in another order, and unknown ones.
    body = b'{"jsonrpc": "2.0", "id": "text", "method": "textDocument/hover", "params": {}}'
    client.raw(
        b"x-unknown: 1\r\ncontent-type: application/vscode-jsonrpc; charset=utf8\r\ncontent-length: %d\r\n\r\n"
        % len(body)
        + body
    )
    assert client.wait(lambda each: each.get("id") == "text")["error"]["code"] == INVALID_PARAMS
    assert client.leave() == 0


@pytest.mark.parametrize(
    ("method", "params"),
    [
        ("textDocument/hover", None),
        ("textDocument/hover", []),
        ("textDocument/hover", {}),
        ("textDocument/hover", {"textDocument": {"uri": 3}, "position": {"line": 0, "character": 0}}),
        ("textDocument/hover", place(-1)),
        ("textDocument/hover", {**place(uri="untitled:1"), "position": {"line": 0.5, "character": 0}}),
        ("textDocument/hover", {**place(uri="untitled:1"), "position": {"line": True, "character": 0}}),
        ("textDocument/hover", {"textDocument": {"uri": None}, "position": {"line": 0, "character": 0}}),
        ("textDocument/references", {**place(uri="untitled:1"), "context": {"includeDeclaration": "no"}}),
        ("textDocument/hover", {"textDocument": {"uri": "untitled:1"}, "position": {"line": "0"}}),
        ("textDocument/completion", place(uri="file:///nowhere")),
        ("textDocument/codeAction", {"textDocument": {"uri": "untitled:1"}}),
        ("textDocument/rename", place(uri="untitled:1")),
        ("workspace/executeCommand", {"command": "rm"}),
        ("workspace/symbol", {}),
        ("textDocument/selectionRange", {"textDocument": {"uri": "untitled:1"}, "positions": 3}),
    ],
)
def test_bad_parameters(running: Client, method: str, params: object) -> None:
    assert running.refused(method, params) == INVALID_PARAMS


@pytest.fixture(scope="module")
def running():  # type: ignore[no-untyped-def]
    client = Client()
    client.start()
    client.open("untitled:1", "ego = new Object\n")
    yield client
    client.end()


def test_notifications_that_make_no_sense_change_nothing(running: Client) -> None:
    for params in (None, {}, {"textDocument": {"uri": "untitled:2", "version": 2}, "contentChanges": []}):
        running.send("textDocument/didChange", params)
        running.send("textDocument/didOpen", params)
        running.send("textDocument/didClose", params)
    running.send("workspace/didChangeWatchedFiles", {"changes": [{}]})
    # A request without an id, and a notification with one.
    running.send("shutdown")
    document = {"uri": "untitled:1", "languageId": "scenic", "version": 9, "text": ""}
    assert running.refused("textDocument/didOpen", {"textDocument": document}) == INVALID_REQUEST
    assert running.request("textDocument/hover", place(uri="untitled:1", character=7))


def test_requests_can_be_taken_back(tmp_path: Path, client: Client) -> None:
    client.start(FULL)
    uri = (tmp_path / "a.scenic").as_uri()
    client.open(uri, "x = 1\n" * 4000)
    client.published(uri)
    numbers = []
    for version in range(2, 8):
        client.change(uri, f"y = {version}\n" + "x = 1\n" * 4000)
        numbers.append(client.ask("textDocument/diagnostic", {"textDocument": {"uri": uri}}))
        client.send("$/cancelRequest", {"id": numbers[-1]})
    answers = [client.wait(lambda each, number=number: each.get("id") == number) for number in numbers]
    codes = {each["error"]["code"] for each in answers if "error" in each}
    assert CANCELLED in codes
    assert codes <= {CANCELLED, -32802}
    assert client.leave() == 0


def test_a_newer_version_ends_what_is_found_out_about_the_old_one(tmp_path: Path, client: Client) -> None:
    client.start(FULL)
    uri = (tmp_path / "a.scenic").as_uri()
    client.open(uri, "x = 1\n" * 8000)
    number = client.ask("textDocument/diagnostic", {"textDocument": {"uri": uri}})
    client.change(uri, "y = 1\n" * 8000)
    answer = client.wait(lambda each: each.get("id") == number)
    if "error" in answer:  # unless it was faster
        assert answer["error"]["code"] == -32802
        assert answer["error"]["data"] == {"retriggerRequest": True}
    assert client.request("textDocument/diagnostic", {"textDocument": {"uri": uri}})["kind"] == "full"


@pytest.mark.parametrize("start", ["script", "module"])
def test_a_hostile_folder_runs_nothing(tmp_path: Path, start: str) -> None:
    """Whatever a folder holds, opening it and all that is in it runs none of it."""
    trap = f"open({str(tmp_path / 'ran')!r}, 'w').close()\n"
    names = (
        "click",
        "json",
        "logging",
        "numpy",
        "pygls",
        "lsprotocol",
        "sitecustomize",
        "conftest",
        "helper",
        "ast",
    )
    for name in (*names, "setup", "queue", "heapq", "tomllib", "rich", "pygments"):
        (tmp_path / f"{name}.py").write_text(trap)
    for name in ("email", "asyncio"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(trap)
    (tmp_path / "pyproject.toml").write_text("[tool.scenic]\nignore = []\n")
    (tmp_path / "model.scenic").write_text(trap)
    text = (
        "import helper, click\nfrom numpy import *\nmodel model\nx = helper.\nego = new Object with behavior B\n"
        + trap
    )
    file = tmp_path / "main.scenic"
    file.write_text(text)
    program = PROGRAM if start == "module" else ("-P", *PROGRAM)
    client = Client(cwd=tmp_path, program=program)
    try:
        client.start(FULL, tmp_path)
        client.open(file.as_uri(), text)
        client.published(file.as_uri())
        uri = {"textDocument": {"uri": file.as_uri()}}
        for line, character in ((3, 11), (0, 9), (1, 7), (2, 8)):
            position = {"position": {"line": line, "character": character}}
            for method in ("hover", "completion", "definition", "documentHighlight", "signatureHelp"):
                client.request(f"textDocument/{method}", {**uri, **position})
        for method in (
            "documentSymbol",
            "semanticTokens/full",
            "codeLens",
            "documentLink",
            "formatting",
            "diagnostic",
        ):
            client.request(f"textDocument/{method}", {**uri, "options": {"tabSize": 4, "insertSpaces": True}})
        client.request("workspace/diagnostic", {"previousResultIds": []})
        client.request("workspace/symbol", {"query": ""})
        assert client.refused(
            "workspace/executeCommand", {"command": "scenic.sample", "arguments": [file.as_uri()]}
        )
        assert client.leave() == 0
    finally:
        client.end()
    assert not (tmp_path / "ran").exists()
    assert os.listdir(tmp_path)


def test_a_client_can_follow_the_conversation(client: Client) -> None:
    client.start()
    client.open("untitled:1", "x = 1\n")

    def traced() -> list[dict[str, str]]:
        client.request("textDocument/documentSymbol", {"textDocument": {"uri": "untitled:1"}})
        client.refused("no/method")  # What was told of the request before has arrived by now.
        found = [each["params"] for each in client.kept if each.get("method") == "$/logTrace"]
        client.kept.clear()
        return [each for each in found if "documentSymbol" in each["message"]]

    assert traced() == []
    client.send("$/setTrace", {"value": "messages"})
    received, answered = traced()
    assert received.keys() == answered.keys() == {"message"}
    client.send("$/setTrace", {"value": "verbose"})
    received, answered = traced()
    assert ("untitled:1" in received["verbose"], '"x"' in answered["verbose"]) == (True, True)
    client.send("$/setTrace", {"value": "off"})
    assert traced() == []
