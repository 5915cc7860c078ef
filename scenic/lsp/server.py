"""The language server: receives what the editor asks, calls one function of `scenic.ide`, sends the answer.

It runs none of the code of the programs that it is shown.
"""

import asyncio
import os
import sys
from collections.abc import Iterable, Sequence
from contextlib import redirect_stdout
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Final

from lsprotocol import types
from pygls.lsp.server import LanguageServer

from scenic.configuration.project import Configurations
from scenic.ide.diagnostics import diagnostics
from scenic.ide.hover import hover
from scenic.ide.repairs import repair_all, repairs
from scenic.language.diagnostics import Diagnostic, Edit
from scenic.language.errors import ScenicError
from scenic.language.selection import Rules
from scenic.language.source import Source, read_source
from scenic.lsp import convert

__all__ = ["ScenicServer", "create_server", "serve"]

PAUSE: Final = 0.15
"""Seconds without a change after which a document is checked again, so that typing is not disturbed."""
FIX_ALL: Final = f"{types.CodeActionKind.SourceFixAll.value}.scenic"
"""The kind of the action that makes all repairs of a document, which editors can make when they save it."""


class ScenicServer(LanguageServer):
    """The server and the checks that it is about to make."""

    def __init__(self) -> None:
        # Whole documents with each change: the library's edits of parts count other line ends than the protocol.
        super().__init__("scenic", _version(), text_document_sync_kind=types.TextDocumentSyncKind.Full)
        self._pending: dict[str, asyncio.TimerHandle] = {}
        self._troubled: dict[str, set[str]] = {}
        """By document: the files of settings whose problems are shown because of it."""
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
        """Check a document and publish what is found, by the rules of the project that it belongs to."""
        self.forget(uri)
        source = self.source(uri)
        configurations, rules = _settings(source)
        found = diagnostics(source.text, filename=source.filename, rules=rules)
        self.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(
                uri,
                [convert.to_diagnostic(item, source, uri, self.encoding) for item in found],
                self.workspace.get_text_document(uri).version,
            )
        )
        self.show_problems(uri, configurations.problems)

    def show_problems(self, document: str, problems: Sequence[Diagnostic]) -> None:
        """Publish what is wrong with the settings of a document, and take back what no longer is."""
        by_file: dict[str, list[Diagnostic]] = {filename: [] for filename in self._troubled.pop(document, ())}
        for item in problems:
            if item.filename is not None:
                by_file.setdefault(os.path.abspath(item.filename), []).append(item)
        for filename, found in by_file.items():
            uri = Path(filename).as_uri()
            try:
                source = read_source(filename)
            except ScenicError:
                source = Source("", filename)
            self.text_document_publish_diagnostics(
                types.PublishDiagnosticsParams(
                    uri, [convert.to_diagnostic(item, source, uri, self.encoding) for item in found]
                )
            )
        if problems:
            self._troubled[document] = {filename for filename, found in by_file.items() if found}

    def repairs(self, params: types.CodeActionParams) -> list[types.CodeAction]:
        """What can be repaired at a place, and if that is asked for, all that can be repaired in the document."""
        uri, context = params.text_document.uri, params.context
        source = self.source(uri)
        _, rules = _settings(source)
        actions = []
        if _wanted(types.CodeActionKind.QuickFix, context):
            found = diagnostics(source.text, filename=source.filename, rules=rules)
            for item in repairs(found, convert.from_range(params.range, source, self.encoding)):
                assert item.fix is not None
                action = self._action(
                    item.fix.title, types.CodeActionKind.QuickFix, item.fix.edits, uri, source
                )
                action.diagnostics = [convert.to_diagnostic(item, source, uri, self.encoding)]
                action.is_preferred = True
                actions.append(action)
        # It is dear, and an editor asks with each move of the cursor what is offered there.
        automatic = context.trigger_kind == types.CodeActionTriggerKind.Automatic and not context.only
        if not automatic and _wanted(FIX_ALL, context):
            edit = repair_all(source.text, filename=source.filename, rules=rules)
            if edit is not None:
                actions.append(self._action("Make all repairs of scenic", FIX_ALL, [edit], uri, source))
        return actions

    def _action(
        self, title: str, kind: str, edits: Iterable[Edit], uri: str, source: Source
    ) -> types.CodeAction:
        document = self.workspace.get_text_document(uri)
        line_end = "\r\n" if "\r\n" in document.source else "\n"
        changes = convert.to_edits(edits, source, self.encoding, line_end)
        return types.CodeAction(title, kind, edit=types.WorkspaceEdit(changes={uri: changes}))

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

    @server.feature(
        types.TEXT_DOCUMENT_CODE_ACTION, types.CodeActionOptions([types.CodeActionKind.QuickFix, FIX_ALL])
    )
    async def show_repairs(params: types.CodeActionParams) -> list[types.CodeAction]:
        return server.repairs(params)

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


def _settings(source: Source) -> tuple[Configurations, Rules]:
    """The settings of the project that a document belongs to. Read each time: they may have changed, and are small."""
    configurations = Configurations()
    return configurations, configurations.of_file(source.filename).rules_for(source.filename)


def _wanted(kind: str, context: types.CodeActionContext) -> bool:
    """Whether the editor asks for actions of this kind: kinds are parts with dots between, the first ones wider."""
    return not context.only or any((kind + ".").startswith(asked + ".") for asked in context.only)


def _version() -> str:
    try:
        return version("scenic-lang")
    except PackageNotFoundError:
        return "0"
