"""The language server: pygls with our protocol, handlers and transports.

It runs none of the code of the programs that it is shown, unless the user asks for that.
"""

import asyncio
import gc
import logging
import os
import socket
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from typing import Any, BinaryIO, Final, cast

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.io_ import StdoutWriter, run_async, run_websocket
from pygls.lsp.server import LanguageServer

from scenic.lsp import parent
from scenic.lsp.capabilities import options_for
from scenic.lsp.check_schedule import Checks
from scenic.lsp.handlers import METHODS, handler
from scenic.lsp.protocol import Protocol, Stage, fault
from scenic.lsp.reader import MessageReader
from scenic.lsp.session import Session

__all__ = ["Server", "serve", "serve_tcp", "serve_websocket"]

_logger: Final = logging.getLogger("pygls")


class Server(LanguageServer):
    """A server for one conversation with one client.

    ``trusting`` tells whether the client is believed when it says that programs may be run.
    """

    protocol: Protocol

    def __init__(self, *, trusting: bool = True) -> None:
        super().__init__("scenic", _version(), protocol_cls=Protocol)
        self._stopped = threading.Event()
        self._idle = threading.Event()
        self._idle.set()
        self.session = Session(self.protocol, self._idle, trusting=trusting)
        self.session.checks = Checks(self.session)
        self.protocol.exited = self._stopped.set
        self.protocol.touched = self.session.garbage.touched
        self.protocol.log = lambda message: self.session.log(message, error=True)
        self.feature(types.INITIALIZE)(lambda params: self._initialize(params))

    @property
    def code(self) -> int:
        """The exit code: 1 if the client has left without a word."""
        return int(self._stopped.is_set() and self.protocol.stage is not Stage.SHUT_DOWN)

    def _initialize(self, params: types.InitializeParams) -> None:
        """Register what is offered to a client of such capabilities."""
        options = options_for(params.capabilities)
        for method in METHODS:
            self.feature(method, options.get(method))(self._handler(method))
        handler(types.INITIALIZE)(self.session, params)
        if params.process_id is not None and self.session.trusting:
            parent.watch(params.process_id, self._abandoned)

    def _handler(self, method: str) -> Callable[[Any], Any]:
        """Return the handler of a method, whose module is imported when it is first called."""
        return lambda params: handler(method)(self.session, params)

    def _abandoned(self) -> None:
        """End this process: the process that started it has gone without a word."""
        os._exit(int(self.protocol.stage is not Stage.SHUT_DOWN))

    def report_server_error(self, error: Exception, source: Any) -> None:
        """Answer what is no JSON; log what else no request is answered with."""
        if source is JsonRpcException:
            if isinstance(error, ValueError | RecursionError):
                self.protocol.unreadable(error)
            else:
                self.session.log(fault("the server", error).message, error=True)
        elif not issubclass(source, JsonRpcException) and self.protocol.stage is Stage.RUNNING:
            self.session.log(str(error), error=True)

    # Transports

    def start_io(self, stdin: BinaryIO | None = None, stdout: BinaryIO | None = None) -> None:
        """Serve on two streams, by default standard input and output."""
        self.protocol.set_writer(StdoutWriter(stdout or sys.stdout.buffer))

        async def converse() -> None:
            reader = MessageReader(stdin or sys.stdin.buffer, self.protocol.foresee, self._idle)
            await run_async(
                self._stopped, reader, self.protocol, logger=_logger, error_handler=self.report_server_error
            )

        asyncio.run(converse())

    def start_tcp(self, host: str, port: int) -> None:
        """Serve the first client that connects."""
        with socket.create_server((host, port)) as listening:
            _listens("tcp", listening.getsockname())
            connection, _ = listening.accept()
        stream = cast(BinaryIO, connection.makefile("rwb"))
        self.start_io(stream, stream)
        # The reading thread may hold the stream, which cannot be closed then.
        connection.shutdown(socket.SHUT_RDWR)

    def start_ws(self, host: str, port: int, origins: Sequence[str] = ()) -> None:
        """Serve the first client that connects by a web socket, pages in browsers only from ``origins``."""
        from websockets.asyncio.server import ServerConnection, serve
        from websockets.typing import Origin

        async def listen() -> None:
            shutdown = asyncio.Event()

            async def converse(connection: ServerConnection) -> None:
                try:
                    await run_websocket(
                        connection, self._stopped, self.protocol, _logger, self.report_server_error
                    )
                finally:
                    shutdown.set()

            allowed_origins = [None, *map(Origin, origins)]
            async with serve(converse, host, port, origins=allowed_origins) as listening:
                _listens("ws", next(iter(listening.sockets)).getsockname())
                await shutdown.wait()

        asyncio.run(listen())


def _listens(kind: str, address: Any) -> None:
    sys.stderr.write(f"scenic: listening on {kind}://{address[0]}:{address[1]}\n")
    sys.stderr.flush()


def serve() -> int:
    """Serve one client over standard input and output until it sends ``exit`` or disconnects; return the exit code."""
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as output, redirect_stdout(sys.stderr):
        # Whatever else is printed must not get between the messages.
        return _serve(Server(), lambda server: server.start_io(None, output))


def serve_tcp(host: str, port: int) -> int:
    """Serve the first client that connects to a port; it cannot have programs run. Returns the exit code."""
    return _serve(Server(trusting=False), lambda server: server.start_tcp(host, port))


def serve_websocket(host: str, port: int, origins: Sequence[str]) -> int:
    """Serve the first client that connects by a web socket; it cannot have programs run. Returns the exit code.

    Pages in browsers are refused, but for those of ``origins``.
    """
    return _serve(Server(trusting=False), lambda server: server.start_ws(host, port, origins))


def _serve(server: Server, start: Callable[[Server], None]) -> int:
    # Our own log says what matters.
    _logger.setLevel(logging.CRITICAL)
    # A request does not wait long for a check that runs beside it.
    sys.setswitchinterval(0.001)
    # What is kept of documents is large, lives long and has few cycles: see `Garbage`.
    gc.freeze()
    gc.disable()
    start(server)
    sys.stderr.flush()
    # The thread that reads may still wait for the client, and the interpreter would wait for it.
    os._exit(server.code)


def _version() -> str:
    """Return the version that is installed, read off the name of a folder: asking for it takes longer than to start."""
    for folder in sys.path:
        try:
            names = os.listdir(folder or os.curdir)
        except OSError:
            continue
        for name in names:
            if name.startswith("scenic_lang-") and name.endswith(".dist-info"):
                return name.removeprefix("scenic_lang-").removesuffix(".dist-info")
    return "0"
