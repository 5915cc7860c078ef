"""The playground's server: who may ask, what runs and when, and what comes back."""

import http.client
import json
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

EGO = "ego = new Object at (Range(1, 2), 0)\n"


@pytest.fixture(scope="module")
def address(playground: Callable[..., Any]) -> Iterator[str]:
    with playground() as found:
        yield found


def place(address: str) -> tuple[str, str]:
    parts = urlsplit(address)
    return parts.netloc, parse_qs(parts.query)["token"][0]


def fetch(address: str, path: str, **headers: str) -> tuple[int, str, http.client.HTTPMessage]:
    connection = http.client.HTTPConnection(place(address)[0], timeout=20)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    return answer.status, answer.read().decode(), answer.headers


def opened(
    address: str, path: str, *, token: str | None = None, origin: str | None = None
) -> ClientConnection:
    host, known = place(address)
    uri = f"ws://{host}/{path}?token={known if token is None else token}"
    return connect(uri, origin=f"http://{host}" if origin is None else origin, max_size=None)  # type: ignore[arg-type]


def sample(address: str, text: str, **more: object) -> dict[str, Any]:
    with opened(address, "sample") as connection:
        connection.send(json.dumps({"text": text, **more}))
        found: dict[str, Any] = json.loads(connection.recv(60))
        return found


def test_the_page_needs_the_token(address: str) -> None:
    status, text, headers = fetch(address, "/?token=" + place(address)[1])
    assert status == 200
    assert "Sample" in text
    assert "script-src 'self'" in headers["Content-Security-Policy"]
    for path in ("/", "/?token=wrong", "/?token=", "/scene/x?token=wrong"):
        assert fetch(address, path)[0] == 403


def test_other_names_and_origins_are_refused(address: str) -> None:
    path = "/?token=" + place(address)[1]
    assert fetch(address, path, Host="evil.example")[0] == 403
    assert fetch(address, path, Origin="http://evil.example")[0] == 403
    assert fetch(address, path, Origin="null")[0] == 403
    for arguments in ({"origin": "http://evil.example"}, {"token": "wrong"}, {"origin": "null"}):
        for name in ("lsp", "sample"):
            with pytest.raises(InvalidStatus) as caught:
                opened(address, name, **arguments)
            assert caught.value.response.status_code == 403


def test_nothing_else_is_served(address: str) -> None:
    token = place(address)[1]
    for path in ("/../server.py", "/static/page.html", "/page.html", "/%2e%2e/server.py", "/scene/unknown"):
        assert fetch(address, f"{path}?token={token}")[0] == 404
    assert fetch(address, "/page.js")[0] == 200


def test_scenes(address: str) -> None:
    found = sample(address, EGO, seed=7, count=2)
    assert found["seed"] == 7
    status, page, headers = fetch(address, f"/scene/{found['scene']}")
    assert status == 200
    assert '"seed":"7"' in page
    assert headers["Content-Security-Policy"].startswith("sandbox allow-scripts; default-src 'none'")


def test_what_is_wrong_is_said(address: str) -> None:
    assert "SC110" in sample(address, "ego = new Object at\n")["trouble"]
    assert "ZeroDivisionError" in sample(address, "x = 1 / 0\n")["trouble"]


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such limits on Windows")
def test_memory_is_limited(address: str) -> None:
    assert "MemoryError" in sample(address, "x = bytearray(1 << 36)\n")["trouble"]


@pytest.mark.parametrize("message", ["", "[]", "{}", '{"text": 3}', '{"text": "", "count": "x"}', "\ud7ff"])
def test_what_is_no_order_is_refused(address: str, message: str) -> None:
    with opened(address, "sample") as connection:
        connection.send(message)
        with pytest.raises(Exception, match="1003"):
            connection.recv(20)


@pytest.mark.slow
def test_leaving_ends_the_program(address: str, tmp_path: Path) -> None:
    sign = tmp_path / "sign"
    text = f"import time\nwhile True:\n    open({str(sign)!r}, 'a').write('.')\n    time.sleep(0.05)\n"
    with opened(address, "sample") as connection:
        connection.send(json.dumps({"text": text}))
        wait_for(sign.exists)
    last = -1
    end = time.monotonic() + 20
    while last != (last := sign.stat().st_size):
        assert time.monotonic() < end
        time.sleep(1)


def wait_for(holds: Callable[[], bool]) -> None:
    end = time.monotonic() + 30
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.05)


def request(connection: ClientConnection, method: str, params: object, number: int | None = None) -> None:
    message = {"jsonrpc": "2.0", "method": method, "params": params}
    connection.send(json.dumps(message if number is None else {**message, "id": number}))


def test_the_language_server_answers(address: str) -> None:
    uri = "file:///nowhere/program.scenic"
    with opened(address, "lsp") as connection:
        request(connection, "initialize", {"processId": None, "rootUri": None, "capabilities": {}}, 1)
        while json.loads(connection.recv(30)).get("id") != 1:
            pass
        request(connection, "initialized", {})
        document = {"uri": uri, "languageId": "scenic", "version": 1, "text": "x = new Object lef of é😀\n"}
        request(connection, "textDocument/didOpen", {"textDocument": document})
        while True:
            message = json.loads(connection.recv(30))
            if (
                message.get("method") == "textDocument/publishDiagnostics"
                and message["params"]["diagnostics"]
            ):
                break
        assert message["params"]["uri"] == uri


def test_a_file_is_shown_and_never_run_or_changed(playground: Callable[..., Any], tmp_path: Path) -> None:
    sign = tmp_path / "sign"
    file = tmp_path / "program.scenic"
    (tmp_path / "beside.scenic").write_text("x = 3\n")
    text = f"from beside import x\nopen({str(sign)!r}, 'w').close()\n{EGO}"
    file.write_text(text)
    with playground(file) as address:
        page = fetch(address, "/?token=" + place(address)[1])[1]
        assert "from beside import x" in page
        with opened(address, "lsp") as connection:
            request(connection, "initialize", {"processId": None, "rootUri": None, "capabilities": {}}, 1)
            connection.recv(30)
            document = {"uri": file.as_uri(), "languageId": "scenic", "version": 1, "text": text}
            request(connection, "textDocument/didOpen", {"textDocument": document})
            time.sleep(1)
        assert not sign.exists()
        assert "scene" in sample(address, text)
        assert sign.exists()
    assert file.read_text() == text
