"""The server behind a port: the same conversation, for clients that are let in, and it runs nothing for them."""

import json
import os
import re
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from tests.lsp.client import PATIENCE, ROOT

Send = Callable[[dict[str, Any]], None]
Receive = Callable[[], dict[str, Any]]


@contextmanager
def listening(*options: str) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """A server, and the port that it has chosen."""
    command = [sys.executable, "-m", "scenic.cli.main", "lsp", *options]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment) as server:
        assert server.stderr is not None
        found = re.search(r":(\d+)$", server.stderr.readline().strip())
        assert found is not None
        try:
            yield server, int(found[1])
        finally:
            server.kill()


def converse(send: Send, receive: Receive) -> None:
    def ask(number: int, method: str, params: object = None) -> dict[str, Any]:
        send({"jsonrpc": "2.0", "id": number, "method": method, "params": params})
        while (message := receive()).get("id") != number:
            pass
        return message

    options = {"trusted": True}
    assert "result" in ask(1, "initialize", {"capabilities": {}, "initializationOptions": options})
    document = {"uri": "untitled:a", "languageId": "scenic", "version": 1, "text": "x = (\n"}
    send({"jsonrpc": "2.0", "method": "textDocument/didOpen", "params": {"textDocument": document}})
    assert receive()["params"]["diagnostics"][0]["code"] == "SC103"
    refused = ask(2, "workspace/executeCommand", {"command": "scenic.sample", "arguments": ["untitled:a"]})
    assert "standard input" in refused["error"]["message"]
    assert ask(3, "shutdown")["result"] is None
    send({"jsonrpc": "2.0", "method": "exit"})


def test_a_port() -> None:
    with listening("--tcp", "0") as (server, port), socket.create_connection(("127.0.0.1", port)) as client:
        stream = client.makefile("rwb")

        def send(message: dict[str, Any]) -> None:
            body = json.dumps(message).encode()
            stream.write(b"content-length: %d\r\n\r\n" % len(body) + body)
            stream.flush()

        def receive() -> dict[str, Any]:
            length = int(stream.readline().partition(b":")[2])
            stream.readline()
            found: dict[str, Any] = json.loads(stream.read(length))
            return found

        converse(send, receive)
        assert server.wait(PATIENCE) == 0


def test_a_web_socket_lets_in_only_pages_of_known_origins() -> None:
    with listening("--ws", "127.0.0.1:0", "--origin", "http://known") as (server, port):
        address = f"ws://127.0.0.1:{port}"
        with pytest.raises(InvalidStatus):
            connect(address, origin="http://other")  # type: ignore[arg-type]
        with connect(address, origin="http://known") as client:  # type: ignore[arg-type]
            converse(lambda message: client.send(json.dumps(message)), lambda: json.loads(client.recv()))
            assert server.wait(PATIENCE) == 0
