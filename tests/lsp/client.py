"""The least of an editor, for tests: starts the server, speaks JSON-RPC with it, and holds all it says against the protocol.

The types of the protocol are those of lsprotocol, which knows nothing of the server.
"""

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, BinaryIO

from lsprotocol import converters, types

from tests.lsp.forked import Forked

ROOT = Path(__file__).parents[2]
PATIENCE = 60.0
"""Seconds to wait for an answer before the test fails."""

PROGRAM = ("-m", "scenic.cli.main", "lsp")
"""The command by which Python starts a server."""

FULL: dict[str, Any] = {
    "general": {"positionEncodings": ["utf-16"]},
    "textDocument": {
        "codeAction": {"codeActionLiteralSupport": {"codeActionKind": {"valueSet": ["quickfix", "source"]}}},
        "completion": {"completionItem": {"snippetSupport": True, "documentationFormat": ["markdown"]}},
        "definition": {"linkSupport": True},
        "documentSymbol": {"hierarchicalDocumentSymbolSupport": True},
        "hover": {"contentFormat": ["markdown", "plaintext"]},
        "publishDiagnostics": {
            "relatedInformation": True,
            "versionSupport": True,
            "tagSupport": {"valueSet": [1, 2]},
        },
        "rename": {"prepareSupport": True},
        "signatureHelp": {"signatureInformation": {"parameterInformation": {"labelOffsetSupport": True}}},
    },
    "workspace": {"workspaceEdit": {"documentChanges": True}},
}
"""What an editor of today can do."""


@cache
def _converter() -> Any:
    return converters.get_converter()


class Refused(Exception):
    """The server answered with an error."""

    def __init__(self, error: dict[str, Any]) -> None:
        super().__init__(error)
        self.code: int = error["code"]
        self.message: str = error["message"]
        self.data = error.get("data")


class Client:
    """Starts a server, and waits for no message longer than `PATIENCE`.

    The server is forked from a process that has imported it, unless ``program`` says how Python starts it. Unless
    ``strict``, the client believes what it is told, as editors do: holding a long answer against the protocol takes longer
    than making it. ``environment`` is what the server finds in its environment besides.
    """

    def __init__(
        self,
        *,
        cwd: Path = ROOT,
        program: tuple[str, ...] = (),
        strict: bool = True,
        environment: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self._strict = strict
        environment = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
        self.process: Forked | subprocess.Popen[bytes]
        if program or os.name == "nt":
            self.process = subprocess.Popen(
                [sys.executable, *(program or PROGRAM)],
                cwd=cwd,
                env=environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
            )
        else:
            self.process = Forked(cwd, environment)
        self.methods: dict[int, str] = {}
        self.kept: list[dict[str, Any]] = []
        self.log: list[bytes] = []
        self.versions: dict[str, int] = {}
        self._messages: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self._count = 0
        assert self.process.stdout is not None
        assert self.process.stderr is not None
        self._threads = [
            threading.Thread(target=self._read, args=(self.process.stdout,), daemon=True),
            threading.Thread(target=self.log.extend, args=(self.process.stderr,), daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    def _read(self, stream: BinaryIO) -> None:
        while header := stream.readline():
            length = 0
            while header.strip():
                name, _, value = header.partition(b":")
                length = int(value) if name.lower() == b"content-length" else length
                header = stream.readline()
            self._messages.put(json.loads(stream.read(length)))
        self._messages.put(None)

    # Sending

    def raw(self, data: bytes) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(data)
        self.process.stdin.flush()

    def send(self, method: str, params: object = None, **others: object) -> None:
        body = json.dumps({"jsonrpc": "2.0", "method": method, "params": params, **others}).encode()
        self.raw(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))

    def ask(self, method: str, params: object = None) -> int:
        """Send a request; returns its number."""
        self._count += 1
        self.methods[self._count] = method
        self.send(method, params, id=self._count)
        return self._count

    def answer(self, number: int) -> Any:
        """What the server answers to a request, checked by the protocol's types."""
        message = self.wait(lambda each: each.get("id") == number and "method" not in each)
        if "error" in message:
            raise Refused(message["error"])
        response = types.METHOD_TO_TYPES.get(self.methods[number])
        if self._strict and response is not None and response[1] is not None:
            _converter().structure(message, response[1])
        return message["result"]

    def request(self, method: str, params: object = None) -> Any:
        return self.answer(self.ask(method, params))

    def refused(self, method: str, params: object = None) -> int:
        """The code of the error that a request is answered with."""
        try:
            self.request(method, params)
        except Refused as error:
            return error.code
        raise AssertionError(f"{method} was answered")

    # Receiving

    def wait(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        for index, message in enumerate(self.kept):
            if wanted(message):
                return self.kept.pop(index)
        while True:
            received = self._messages.get(timeout=PATIENCE)
            assert received is not None, b"".join(self.log).decode()
            if wanted(received):
                return received
            self.kept.append(received)

    def published(self, uri: str, *, version: int | None = None) -> list[dict[str, Any]]:
        """The next problems of a document, or those of a version."""
        message = self.wait(
            lambda each: (
                each.get("method") == "textDocument/publishDiagnostics"
                and each["params"]["uri"] == uri
                and (version is None or each["params"].get("version") == version)
            )
        )
        if self._strict:
            _converter().structure(message, types.PublishDiagnosticsNotification)
        found: list[dict[str, Any]] = message["params"]["diagnostics"]
        return found

    # An editor's doings

    def start(
        self, capabilities: dict[str, Any] | None = None, *folders: Path, **others: object
    ) -> dict[str, Any]:
        """Begin the conversation; returns what the server offers."""
        params = {
            "processId": None,
            "rootUri": None,
            "capabilities": FULL if capabilities is None else capabilities,
            "workspaceFolders": [{"uri": folder.as_uri(), "name": folder.name} for folder in folders] or None,
            **others,
        }
        found: dict[str, Any] = self.request("initialize", params)["capabilities"]
        self.send("initialized", {})
        return found

    def open(self, uri: str, text: str, language: str = "scenic") -> None:
        self.versions[uri] = 1
        document = {"uri": uri, "languageId": language, "version": 1, "text": text}
        self.send("textDocument/didOpen", {"textDocument": document})

    def change(self, uri: str, *changes: str | tuple[tuple[int, int], tuple[int, int], str]) -> int:
        """Give a document another text, or change ranges of it; returns the new version."""
        self.versions[uri] += 1
        content = [
            {"text": each}
            if isinstance(each, str)
            else {
                "range": {
                    "start": {"line": each[0][0], "character": each[0][1]},
                    "end": {"line": each[1][0], "character": each[1][1]},
                },
                "text": each[2],
            }
            for each in changes
        ]
        document = {"uri": uri, "version": self.versions[uri]}
        self.send("textDocument/didChange", {"textDocument": document, "contentChanges": content})
        return self.versions[uri]

    def end(self) -> None:
        self.process.kill()
        self.process.wait(PATIENCE)
        for thread in self._threads:
            thread.join(PATIENCE)
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            assert stream is not None
            stream.close()

    def leave(self) -> int:
        """Say goodbye properly; returns the exit code."""
        self.request("shutdown")
        self.send("exit")
        return self.process.wait(PATIENCE)


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


def at(text: str, marked: str) -> dict[str, int]:
    """The position of ``|`` in a piece of a text, in code units of UTF-16."""
    before, after = marked.split("|")
    assert text.count(before + after) == 1, marked
    place = text.index(before + after) + len(before)
    line = text.count("\n", 0, place)
    start = text.rfind("\n", 0, place) + 1
    return {"line": line, "character": len(text[start:place].encode("utf-16-le")) // 2}
