"""The life cycle and the base protocol: what comes too early, too late, or is no message."""

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, Final

from benchmarks.protocol.peer import Failure, Peer, started

__all__ = ["base_protocol", "life_cycle", "parent"]

Row = tuple[str, Callable[[], Any], Any]
"""A promise, what is done, and what that must give."""

_INITIALIZE: Final = {"processId": None, "rootUri": None, "capabilities": {}}
_HOVER: Final = {"textDocument": {"uri": "untitled:none"}, "position": {"line": 0, "character": 0}}


def life_cycle() -> Iterator[Row]:
    """The rows about beginning and end."""
    peer = Peer()
    yield "a request before `initialize`: -32002", lambda: peer.code("textDocument/hover", _HOVER), -32002
    yield "`shutdown` before `initialize`: -32002", lambda: peer.code("shutdown"), -32002
    peer.notify(
        "textDocument/didOpen",
        {"textDocument": {"uri": "untitled:x", "languageId": "scenic", "version": 1, "text": "x = ("}},
    )
    yield "a notification before `initialize` is ignored", peer.silent, True
    yield "`initialize` without parameters: -32602", lambda: peer.code("initialize"), -32602
    yield (
        "`initialize` with wrong parameters: -32602",
        lambda: peer.code("initialize", {"processId": "x", "capabilities": 3}),
        -32602,
    )
    yield "`initialize` after that", lambda: peer.code("initialize", _INITIALIZE), None
    yield "`initialize` a second time: -32600", lambda: peer.code("initialize", _INITIALIZE), -32600
    peer.notify("initialized", {})
    peer.open("untitled:none", "x = 1\n")
    yield (
        "`initialized` a second time is ignored",
        lambda: (peer.notify("initialized", {}), peer.code("textDocument/hover", _HOVER))[1],
        None,
    )
    yield "an unknown method: -32601", lambda: peer.code("textDocument/unknown", {}), -32601
    yield "an unknown request that begins with `$/`: -32601", lambda: peer.code("$/unknown", {}), -32601
    yield "unknown notifications are ignored", lambda: _ignored(peer, "$/unknown", "workspace/unknown"), None
    yield "missing parameters: -32602", lambda: peer.code("textDocument/hover"), -32602
    yield (
        "parameters of a wrong type: -32602",
        lambda: peer.code("textDocument/hover", {**_HOVER, "position": "here"}),
        -32602,
    )
    yield "parameters that are a list: -32602", lambda: peer.code("textDocument/hover", [1, 2]), -32602
    yield (
        "a negative line: -32602 or an answer",
        lambda: (
            peer.code("textDocument/hover", {**_HOVER, "position": {"line": -1, "character": 0}})
            in (None, -32602)
        ),
        True,
    )
    yield (
        "a notification asked as a request: refused",
        lambda: (
            peer.code("textDocument/didClose", {"textDocument": {"uri": "untitled:x"}}) in (-32600, -32601)
        ),
        True,
    )
    yield (
        "wrong parameters of a notification change nothing",
        lambda: _ignored(peer, "textDocument/didChange", "textDocument/didOpen", "$/cancelRequest"),
        None,
    )
    yield "changing a document that is not open changes nothing", lambda: _change_unopened(peer), None
    yield (
        "the id of a request may be text",
        lambda: peer.response(peer.ask("textDocument/hover", _HOVER, name="näme"))["id"],
        "näme",
    )
    yield (
        "the id of a request may be 0",
        lambda: peer.response(peer.ask("textDocument/hover", _HOVER, name=0))["id"],
        0,
    )
    yield "the text '1' and the integer 1 are different ids", lambda: _both_ids(peer), ["1", 1001]
    yield "a request that is cancelled is answered", lambda: _cancelled(peer) in (None, -32800), True
    yield "an answer to nothing is ignored", lambda: _answered_nothing(peer), None
    yield "`shutdown` answers null", lambda: peer.request("shutdown"), None
    yield "a request after `shutdown`: -32600", lambda: peer.code("textDocument/hover", _HOVER), -32600
    yield "`shutdown` a second time: -32600", lambda: peer.code("shutdown"), -32600
    yield "`initialize` after `shutdown`: -32600", lambda: peer.code("initialize", _INITIALIZE), -32600
    yield "`exit` after `shutdown`: exit code 0", lambda: (peer.notify("exit"), peer.ended())[1], 0
    first = Peer()
    yield "`exit` before `initialize`: exit code 1", lambda: (first.notify("exit"), first.ended())[1], 1
    second = Peer()
    second.start()
    yield "`exit` without `shutdown`: exit code 1", lambda: (second.notify("exit"), second.ended())[1], 1
    third = Peer()
    third.start()
    yield "the end of the input ends the server", lambda: _closed(third), True
    for each in (peer, first, second, third):
        each.end()


def _ignored(peer: Peer, *methods: str) -> int | None:
    for method in methods:
        peer.notify(method, {"unknown": 1})
    return peer.code("textDocument/hover", _HOVER)


def _change_unopened(peer: Peer) -> int | None:
    peer.change("untitled:never", 2, {"text": "x"})
    return peer.code("textDocument/hover", _HOVER)


def _both_ids(peer: Peer) -> list[Any]:
    peer.ask("textDocument/hover", _HOVER, name="1")
    peer.ask("textDocument/hover", _HOVER, name=1001)
    return [peer.response("1")["id"], peer.response(1001)["id"]]


def _cancelled(peer: Peer) -> int | None:
    uri = "untitled:long"
    peer.open(uri, "x = 1\n" * 3000)
    name = peer.ask("textDocument/semanticTokens/full", {"textDocument": {"uri": uri}})
    peer.notify("$/cancelRequest", {"id": name})
    peer.notify("$/cancelRequest", {"id": "unknown"})
    found = peer.response(name)
    return found["error"]["code"] if "error" in found else None


def _answered_nothing(peer: Peer) -> int | None:
    peer.message({"jsonrpc": "2.0", "id": 999_999, "result": None})
    peer.message({"jsonrpc": "2.0", "id": "nobody", "error": {"code": 1, "message": "x"}})
    return peer.code("textDocument/hover", _HOVER)


def _closed(peer: Peer) -> bool:
    assert peer.process.stdin is not None
    peer.process.stdin.close()
    return peer.ended() is not None


def base_protocol() -> Iterator[Row]:
    """The rows about frames and messages."""
    with started() as peer:
        peer.open("untitled:none", "x = 1\n")
        body = json.dumps(
            {"jsonrpc": "2.0", "id": 7001, "method": "textDocument/hover", "params": _HOVER}
        ).encode()

        def framed(frame: bytes, name: Any = 7001) -> Any:
            peer.raw(frame)
            return peer.response(name)["id"]

        yield (
            "headers in lower case",
            lambda: framed(b"content-length: %d\r\n\r\n%s" % (len(body), body)),
            7001,
        )
        yield (
            "further headers, before and after",
            lambda: framed(
                b"X-Own: 1\r\nContent-Type: application/vscode-jsonrpc; charset=utf-8\r\nContent-Length: %d\r\nX-Other: a: b\r\n\r\n%s"
                % (len(body), body)
            ),
            7001,
        )
        yield (
            "no blank after the colon",
            lambda: framed(b"Content-Length:%d\r\n\r\n%s" % (len(body), body)),
            7001,
        )
        yield (
            "a message byte by byte",
            lambda: _in_bytes(peer, b"Content-Length: %d\r\n\r\n%s" % (len(body), body)),
            7001,
        )
        yield "ten messages in one write", lambda: _together(peer), list(range(8000, 8010))
        yield "text that is not JSON: -32700 with the id null", lambda: _refused(peer, b"{nonsense"), -32700
        yield (
            "bytes that are not UTF-8: -32700",
            lambda: _refused(peer, b'{"jsonrpc": "2.0", "id": 3, "method": "\xff"}'),
            -32700,
        )
        yield "an empty message: -32700", lambda: _refused(peer, b""), -32700
        yield "a number: -32600", lambda: _refused(peer, b"3"), -32600
        yield "an empty list: -32600", lambda: _refused(peer, b"[]"), -32600
        yield "an object without a method: -32600", lambda: _refused(peer, b'{"jsonrpc": "2.0"}'), -32600
        yield (
            "another version of JSON-RPC: -32600",
            lambda: _refused(peer, b'{"jsonrpc": "1.0", "method": "x"}'),
            -32600,
        )
        yield (
            "an id that is a fraction: -32600",
            lambda: _refused(peer, b'{"jsonrpc": "2.0", "id": 1.5, "method": "x"}'),
            -32600,
        )
        yield "after all of that requests are answered", lambda: peer.code("textDocument/hover", _HOVER), None
        yield "characters of several bytes are counted in bytes", lambda: _several_bytes(peer), 1


def _in_bytes(peer: Peer, frame: bytes) -> Any:
    for index in range(len(frame)):
        peer.raw(frame[index : index + 1])
    return peer.response(7001)["id"]


def _together(peer: Peer) -> list[Any]:
    frames = b""
    for name in range(8000, 8010):
        body = json.dumps(
            {"jsonrpc": "2.0", "id": name, "method": "textDocument/hover", "params": _HOVER}
        ).encode()
        frames += b"Content-Length: %d\r\n\r\n%s" % (len(body), body)
    peer.raw(frames)
    return [peer.response(name)["id"] for name in range(8000, 8010)]


def _refused(peer: Peer, body: bytes) -> int:
    peer.raw(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
    found = peer.wait(lambda each: "error" in each and each.get("id") is None)
    code: int = found["error"]["code"]
    return code


def _several_bytes(peer: Peer) -> int:
    uri = "untitled:é𝄞"
    peer.open(uri, "é = '𝄞'\nx = missing_name\n")
    return int(peer.published(uri)[0]["range"]["start"]["line"])


def parent() -> Iterator[Row]:
    """The row about the process that the client names as its own."""
    editor = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    peer = Peer()
    peer.start(process=editor.pid)

    def dies() -> bool:
        editor.kill()
        editor.wait()
        began = time.monotonic()
        if peer.ended(30.0) is None:
            raise Failure("it goes on")
        return time.monotonic() - began < 30

    yield "the server ends once the process of the client is gone", dies, True
    peer.end()
