"""The server of the playground: the page's files, a language server for each page, and scenes of its program.

It listens on this machine alone, and answers only who knows the token that the page's address holds: other users of the
machine do not, nor do other pages in the same browser, whose origin is refused besides. A program is run only when the
page asks for scenes, in a process with limits; what it says is shown in a frame that may load nothing.
"""

import asyncio
import http
import json
import logging
import secrets
import tempfile
from collections import OrderedDict
from collections.abc import Mapping
from contextlib import suppress
from importlib import resources
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final
from urllib.parse import parse_qs, urlsplit

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from scenic.dataclass import dataclass
from scenic.ide.running import RunError, sample_page
from scenic.playground.bridge import connect_language_server
from scenic.playground.language import language

__all__ = ["Playground", "is_built"]

_KEPT: Final = 20
"""So many pages with scenes are kept."""
_MOST_SCENES: Final = 50
_LARGEST: Final = 4 << 20
"""Bytes of a message."""

_POLICY: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; font-src 'self'; img-src 'self' data:; "
    "connect-src 'self' ws:; worker-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_POLICY_OF_SCENES: Final = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; "
    "frame-ancestors 'self'"
)
_FILES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "page.js": "text/javascript",
        "worker.js": "text/javascript",
        "page.css": "text/css",
        "codicon.ttf": "font/ttf",
    }
)

EXAMPLE: Final = """\
# A chair and a box that faces it. Press "Sample", or Ctrl+Enter.
chair = new Object at (0, 0, 0.5),
    with color (0.8, 0.3, 0.2)
ego = new Object ahead of chair by Range(1, 3),
    facing toward chair,
    with width Range(0.5, 2)
require ego.width > 1
"""


@dataclass(frozen=True, slots=True)
class _Order:
    """A request of a page: the text of a program, the number of scenes, and the seed."""

    text: str
    count: int
    seed: int

    @staticmethod
    def read(message: str | bytes) -> "_Order":
        """Raises `ValueError` if the message is none."""
        found = json.loads(message)
        text, count, seed = found["text"], found.get("count", 1), found.get("seed")
        if not isinstance(text, str) or not isinstance(count, int) or not isinstance(seed, int | None):
            raise ValueError("text, count or seed has the wrong type")
        return _Order(
            text, max(1, min(count, _MOST_SCENES)), secrets.randbits(31) if seed is None else abs(seed)
        )


class Playground:
    """One playground; `start` it within a running event loop.

    ``file`` is the program to begin with; its modules and meshes are found beside it. Without one the page begins with an
    example, and the program has a folder of its own.
    """

    def __init__(self, file: Path | None = None) -> None:
        self._token = secrets.token_urlsafe(24)
        self._pages: OrderedDict[str, str] = OrderedDict()
        self._folder = None if file else tempfile.TemporaryDirectory(prefix="scenic-playground-")
        self._file = file.resolve() if file else Path(self._folder.name, "program.scenic")  # type: ignore[union-attr]
        self._text = file.read_text(encoding="utf-8") if file else EXAMPLE
        if not file:
            self._file.write_text(EXAMPLE, encoding="utf-8")
        self._server: Server | None = None
        self._hosts: frozenset[str] = frozenset()

    async def start(self, port: int = 0) -> str:
        """Listen on a port of this machine, 0 for any that is free, and return the address of the page; raises `OSError`."""
        logger = logging.getLogger("websockets.server")
        logger.addHandler(logging.NullHandler())
        logger.propagate = False
        self._server = await serve(
            self._serve,
            "127.0.0.1",
            port,
            process_request=self._answer,
            max_size=_LARGEST,
            server_header=None,
            logger=logger,
        )
        port = next(iter(self._server.sockets)).getsockname()[1]
        self._hosts = frozenset({f"127.0.0.1:{port}", f"localhost:{port}"})
        return f"http://127.0.0.1:{port}/?token={self._token}"

    async def wait(self) -> None:
        """Serve until this is cancelled, or `stop` is called."""
        assert self._server is not None
        await self._server.wait_closed()

    async def stop(self) -> None:
        """Close all connections; programs that run are ended."""
        if self._server is not None:
            self._server.close()
            await self._server.wait_closed()
        if self._folder is not None:
            self._folder.cleanup()

    # HTTP.

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """The answer to a request; ``None`` for WebSockets that may be opened."""
        parts = urlsplit(request.path)
        # A name that leads here from outside, and a page from elsewhere, know no token; but neither gets to try one.
        if request.headers.get("Host") not in self._hosts:
            return _plain(http.HTTPStatus.FORBIDDEN, "this is not the address of the playground")
        origin = request.headers.get("Origin")
        is_socket = request.headers.get("Upgrade", "").lower() == "websocket"
        if (origin is not None or is_socket) and origin not in {f"http://{host}" for host in self._hosts}:
            return _plain(http.HTTPStatus.FORBIDDEN, "pages from elsewhere are not answered")
        path = parts.path.lstrip("/")
        if path in _FILES and not is_socket:
            return _response((_static() / path).read_bytes(), _FILES[path], _POLICY)
        # The name of a scene is a secret of its own: its frame, which shows what a program made, never learns the token.
        kind, _, name = path.partition("/")
        if kind == "scene" and name in self._pages and not is_socket:
            return _response(self._pages[name].encode(), "text/html", _POLICY_OF_SCENES)
        token = parse_qs(parts.query).get("token", [""])[0]
        if not secrets.compare_digest(token.encode(), self._token.encode()):
            return _plain(
                http.HTTPStatus.FORBIDDEN, "the token is missing: use the address that the command shows"
            )
        if is_socket:
            return (
                None
                if path in ("lsp", "sample")
                else _plain(http.HTTPStatus.NOT_FOUND, "there is nothing here")
            )
        if path == "":
            return _response(self._page().encode(), "text/html", _POLICY)
        return _plain(http.HTTPStatus.NOT_FOUND, "there is nothing here")

    def _page(self) -> str:
        config = {
            "token": self._token,
            "uri": self._file.as_uri(),
            "text": self._text,
            "language": language(),
        }
        text = json.dumps(config).replace("<", "\\u003c")
        page: str = (_static() / "page.html").read_text(encoding="utf-8")
        return page.replace("{{config}}", text)

    # WebSockets.

    async def _serve(self, connection: ServerConnection) -> None:
        assert connection.request is not None
        path = urlsplit(connection.request.path).path
        with suppress(ConnectionClosed):
            if path == "/lsp":
                await connect_language_server(connection, folder=self._file.parent)
            else:
                await self._sample(connection)

    async def _sample(self, connection: ServerConnection) -> None:
        """Answer one order; when the page closes the connection, the program is ended."""
        try:
            order = _Order.read(await connection.recv())
        except (ValueError, KeyError, TypeError) as error:
            await connection.close(1003, f"not an order: {error}"[:100])
            return
        work = asyncio.create_task(self._made(order, lambda: _is_open(connection)))
        await connection.send(json.dumps(await work))

    async def _made(self, order: _Order, is_wanted: Any) -> Mapping[str, Any]:
        def go_on() -> None:
            if not is_wanted():
                raise RunError("stopped")

        try:
            page = await asyncio.to_thread(
                sample_page, order.text, str(self._file), seed=order.seed, count=order.count, go_on=go_on
            )
        except RunError as error:
            return {"trouble": str(error), "seed": order.seed}
        name = secrets.token_urlsafe(12)
        self._pages[name] = page
        while len(self._pages) > _KEPT:
            self._pages.popitem(last=False)
        return {"scene": name, "seed": order.seed}


def is_built() -> bool:
    """Return whether the page's files are there; a checkout has them once ``make playground`` has made them."""
    return all((_static() / name).is_file() for name in (*_FILES, "page.html"))


def _static() -> Any:
    return resources.files("scenic.playground") / "static"


def _is_open(connection: ServerConnection) -> bool:
    return connection.close_code is None and connection.state == 1


def _plain(status: http.HTTPStatus, text: str) -> Response:
    return _response((text + "\n").encode(), "text/plain", "default-src 'none'", status)


def _response(body: bytes, kind: str, policy: str, status: http.HTTPStatus = http.HTTPStatus.OK) -> Response:
    headers = Headers(
        {
            "Content-Type": f"{kind}; charset=utf-8" if kind.startswith("text/") else kind,
            "Content-Length": str(len(body)),
            "Content-Security-Policy": policy,
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Cache-Control": "no-store",
            "Connection": "close",
        }
    )
    return Response(status.value, status.phrase, headers, body)
