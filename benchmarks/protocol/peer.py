"""The other side of a language server: frames and reads messages by the base protocol, and knows nothing of the server's libraries."""

import contextlib
import json
import os
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

__all__ = ["ENCODINGS", "Failure", "Peer", "started"]

ROOT: Final = Path(__file__).parents[2]
PATIENCE: Final = 60.0
"""Seconds to wait for a message."""
ENCODINGS: Final = ("utf-8", "utf-16", "utf-32")

_CAPABILITIES: Final[Mapping[str, Any]] = {
    "textDocument": {
        "codeAction": {
            "codeActionLiteralSupport": {"codeActionKind": {"valueSet": ["quickfix", "refactor", "source"]}}
        },
        "documentSymbol": {"hierarchicalDocumentSymbolSupport": True},
        "hover": {"contentFormat": ["markdown", "plaintext"]},
        "publishDiagnostics": {"versionSupport": True, "relatedInformation": True},
        "rename": {"prepareSupport": True},
        "rangeFormatting": {"rangesSupport": True},
    },
    "workspace": {"workspaceEdit": {"documentChanges": True}, "workspaceFolders": True},
    "window": {"workDoneProgress": False},
}


class Failure(Exception):
    """A promise of the protocol that was not kept."""


class Peer:
    """A server process and the conversation with it."""

    def __init__(self, folder: Path = ROOT) -> None:
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-m", "scenic.cli.main", "lsp"],
            cwd=folder,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        self.kept: list[Any] = []
        self.capabilities: dict[str, Any] = {}
        self._received: queue.Queue[Any] = queue.Queue()
        self._count = 0
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        stream = self.process.stdout
        assert stream is not None
        while True:
            length = None
            while line := stream.readline():
                if line == b"\r\n":
                    break
                name, _, value = line.partition(b":")
                if name.lower() == b"content-length":
                    length = int(value)
            if length is None:
                self._received.put(None)
                return
            self._received.put(json.loads(stream.read(length)))

    # Sending

    def raw(self, data: bytes) -> None:
        """Send bytes as they are."""
        assert self.process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.write(data)
            self.process.stdin.flush()

    def message(self, content: Any, *, header: str = "Content-Length") -> None:
        """Send a message in a frame."""
        body = json.dumps(content, ensure_ascii=False).encode("utf-8", "surrogatepass")
        self.raw(f"{header}: {len(body)}\r\n\r\n".encode() + body)

    def notify(self, method: str, params: Any = None) -> None:
        """Send a notification."""
        self.message({"jsonrpc": "2.0", "method": method, "params": params})

    def ask(self, method: str, params: Any = None, *, name: Any = None) -> Any:
        """Send a request; returns its id."""
        self._count += 1
        used = self._count if name is None else name
        self.message({"jsonrpc": "2.0", "id": used, "method": method, "params": params})
        return used

    # Receiving

    def wait(self, wanted: Callable[[Any], bool], seconds: float = PATIENCE) -> Any:
        """Return the next message that is wanted; raises `Failure` if none comes."""
        for index, each in enumerate(self.kept):
            if wanted(each):
                return self.kept.pop(index)
        end = time.monotonic() + seconds
        while True:
            try:
                received = self._received.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                raise Failure(f"no answer within {seconds:g} s") from None
            if received is None:
                raise Failure("the server has ended")
            if "method" in received and "id" in received:
                self.message({"jsonrpc": "2.0", "id": received["id"], "result": None})
            elif wanted(received):
                return received
            else:
                self.kept.append(received)

    def response(self, name: Any) -> Any:
        """The whole response to a request."""
        return self.wait(
            lambda each: "method" not in each and each.get("id") == name and type(each["id"]) is type(name)
        )

    def request(self, method: str, params: Any = None) -> Any:
        """The result of a request; raises `Failure` if it is refused."""
        found = self.response(self.ask(method, params))
        if "error" in found:
            raise Failure(f"{method}: {found['error']['code']} {found['error']['message'][:80]}")
        return found["result"]

    def code(self, method: str, params: Any = None) -> int | None:
        """The code of the error with which a request is refused; ``None`` if it is not."""
        found = self.response(self.ask(method, params))
        return found["error"]["code"] if "error" in found else None

    def silent(self, seconds: float = 0.3) -> bool:
        """Return whether nothing is received for a while; what is received is kept."""
        before = len(self.kept)
        with contextlib.suppress(Failure):
            self.wait(lambda _: False, seconds)
        return len(self.kept) == before

    # A conversation

    def start(
        self,
        *,
        encoding: str = "utf-16",
        process: int | None = None,
        capabilities: Mapping[str, Any] | None = None,
        trusted: bool | None = None,
    ) -> None:
        """Initialize the server; ``trusted`` says whether programs may be run."""
        offered = {**(_CAPABILITIES if capabilities is None else capabilities)}
        if capabilities is None:
            offered["general"] = {"positionEncodings": [encoding]}
        params = {"processId": process, "rootUri": None, "capabilities": offered, "workspaceFolders": None}
        if trusted is not None:
            params["initializationOptions"] = {"trusted": trusted}
        self.capabilities = self.request("initialize", params)["capabilities"]
        self.notify("initialized", {})

    def open(self, uri: str, text: str, version: int = 1) -> None:
        """Open a document."""
        item = {"uri": uri, "languageId": "scenic", "version": version, "text": text}
        self.notify("textDocument/didOpen", {"textDocument": item})

    def change(self, uri: str, version: int, *changes: Mapping[str, Any]) -> None:
        """Change a document."""
        self.notify(
            "textDocument/didChange",
            {"textDocument": {"uri": uri, "version": version}, "contentChanges": list(changes)},
        )

    def published(self, uri: str, version: int | None = None) -> list[Any]:
        """The diagnostics of a version of a document."""

        def wanted(each: Any) -> bool:
            params = each.get("params")
            return (
                each.get("method") == "textDocument/publishDiagnostics"
                and params["uri"] == uri
                and (version is None or params.get("version") == version)
            )

        found: list[Any] = self.wait(wanted)["params"]["diagnostics"]
        return found

    def processor(self) -> float:
        """Seconds of processor time that the server has used."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def ended(self, seconds: float = 15.0) -> int | None:
        """The exit code of the server; ``None`` if it goes on."""
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return None

    def end(self) -> None:
        """End the server, whatever its state is."""
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()


@contextlib.contextmanager
def started(**others: Any) -> Iterator[Peer]:
    """A server that is initialized, and is ended afterwards."""
    peer = Peer()
    try:
        peer.start(**others)
        yield peer
    finally:
        peer.end()
