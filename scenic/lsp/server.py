"""The language server: receives what the editor asks, calls one function of `scenic.ide`, sends the answer.

It runs none of the code of the programs that it is shown.
"""

import asyncio
import os
import sys
from contextlib import redirect_stdout
from importlib.metadata import PackageNotFoundError, version
from typing import Final

from lsprotocol import types
from pygls.lsp.server import LanguageServer

from scenic.ide.diagnostics import diagnostics
from scenic.ide.hover import hover
from scenic.language.source import Source
from scenic.lsp import convert

__all__ = ["ScenicServer", "create_server", "serve"]

PAUSE: Final = 0.15
"""Seconds without a change after which a document is checked again, so that typing is not disturbed."""


class ScenicServer(LanguageServer):
    """The server and the checks that it is about to make."""

    def __init__(self) -> None:
        # Whole documents with each change: the library's edits of parts count other line ends than the protocol.
        super().__init__("scenic", _version(), text_document_sync_kind=types.TextDocumentSyncKind.Full)
        self._pending: dict[str, asyncio.TimerHandle] = {}
        self.is_shut_down = False

    @property
    def encoding(self) -> convert.Encoding:
        """How columns are counted, as agreed with the client."""
        return self.workspace.position_encoding or types.PositionEncodingKind.Utf16

    def source(self, uri: str) -> Source:
        """The present text of a document."""
        document = self.workspace.get_text_document(uri)
        return Source(document.source, document.path)

    def check_soon(self, uri: str) -> None:
        """Check a document when no change has come for a while."""
        self.forget(uri)
        self._pending[uri] = asyncio.get_running_loop().call_later(PAUSE, self.check, uri)

    def check(self, uri: str) -> None:
        """Check a document and publish what is found."""
        self.forget(uri)
        source = self.source(uri)
        found = diagnostics(source.text, filename=source.filename)
        self.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(
                uri,
                [convert.to_diagnostic(item, source, uri, self.encoding) for item in found],
                self.workspace.get_text_document(uri).version,
            )
        )

    def forget(self, uri: str) -> None:
        """Give up a check that has not begun yet."""
        timer = self._pending.pop(uri, None)
        if timer is not None:
            timer.cancel()


def create_server() -> ScenicServer:
    """A server with all its features, not yet connected to a client."""
    server = ScenicServer()

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    async def did_open(params: types.DidOpenTextDocumentParams) -> None:
        server.check(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    async def did_change(params: types.DidChangeTextDocumentParams) -> None:
        server.check_soon(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    async def did_close(params: types.DidCloseTextDocumentParams) -> None:
        uri = params.text_document.uri
        server.forget(uri)
        server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, []))

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    async def show_hover(params: types.HoverParams) -> types.Hover | None:
        source = server.source(params.text_document.uri)
        line, column = convert.from_position(params.position, source, server.encoding)
        found = hover(source.text, line, column)
        return None if found is None else convert.to_hover(found, source, server.encoding)

    @server.feature(types.SHUTDOWN)
    def shut_down(_params: None) -> None:
        server.is_shut_down = True

    @server.feature(types.EXIT)
    def leave(_params: None) -> None:
        # The library would first wait for the thread that reads, and so for the client to close the pipe.
        os._exit(0 if server.is_shut_down else 1)

    return server


def serve() -> None:
    """Serve one client over standard input and output until it says to exit, or goes away."""
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as output, redirect_stdout(sys.stderr):
        # Whatever else is printed must not get between the messages.
        create_server().start_io(stdout=output)


def _version() -> str:
    try:
        return version("scenic-lang")
    except PackageNotFoundError:
        return "0"
