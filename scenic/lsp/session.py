"""State of the server while it talks to one client: the client's capabilities, the open documents, pending requests."""

import asyncio
import os
import sys
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, Final, TypeVar

from lsprotocol import types
from pygls.capabilities import ServerCapabilitiesBuilder, get_capability
from pygls.exceptions import JsonRpcException, JsonRpcInvalidParams

from scenic.compiler.semantics.modules import Module
from scenic.configuration.project import Configurations
from scenic.ide.remarks import Remarks
from scenic.ide.snapshot import PythonSnapshot, Snapshot
from scenic.language.code_selection import Rules
from scenic.language.errors import ScenicError
from scenic.language.source import Source, read_source
from scenic.language.spans import Span
from scenic.lsp.convert import Encoding, Lines
from scenic.lsp.documents import Document, snapshot_of
from scenic.lsp.garbage import Garbage
from scenic.lsp.threads import GoOn, Workers
from scenic.lsp.uris import to_path, to_uri
from scenic.project.index import Project

if TYPE_CHECKING:
    from scenic.lsp.check_schedule import Checks
    from scenic.lsp.protocol import Protocol

__all__ = ["SUFFIXES", "Session"]

_T = TypeVar("_T")

SUFFIXES: Final = (".scenic", ".sc")
"""The endings of the files that are programs."""

_REFRESHED: Final = {
    "diagnostics": types.WORKSPACE_DIAGNOSTIC_REFRESH,
    "semantic_tokens": types.WORKSPACE_SEMANTIC_TOKENS_REFRESH,
    "inlay_hint": types.WORKSPACE_INLAY_HINT_REFRESH,
    "code_lens": types.WORKSPACE_CODE_LENS_REFRESH,
}


class Results:
    """The last result for each document, from which a client may request the changes."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[str, list[int]]] = {}
        self._count = 0

    def keep(self, uri: str, data: list[int]) -> str:
        """Keep a result; returns its name."""
        self._count += 1
        name = str(self._count)
        self._kept[uri] = (name, data)
        return name

    def known(self, uri: str, name: str) -> list[int] | None:
        """The result of this name, if it is the last one of the document."""
        kept = self._kept.get(uri)
        return kept[1] if kept is not None and kept[0] == name else None

    def forget(self, uri: str) -> None:
        """The document is closed."""
        self._kept.pop(uri, None)


class Session:
    """The state that all handlers share; used in the event loop only. ``idle`` is set while that waits for messages."""

    def __init__(self, protocol: "Protocol", idle: threading.Event, *, trusting: bool) -> None:
        self.protocol = protocol
        self.trusting = trusting
        """True if the client's statement that programs may be run can be trusted."""
        self.client = types.ClientCapabilities()
        """The capabilities that the client reports at the beginning."""
        self.encoding = Encoding.UTF16
        self.documents: dict[str, Document] = {}
        self.folders: dict[str, str] = {}
        """The folders of the workspace: names of folders by their addresses."""
        self.trusted: bool | None = None
        """True if programs may be run; ``None`` if the client did not say."""
        self.settings: Mapping[str, Any] = {}
        self.garbage = Garbage()
        self.checker = Workers("checks", idle)
        self.checks: Checks
        self.requests = Workers("requests", idle)
        self.runs = Workers("runs", idle, threads=4)
        """For work that mostly waits."""
        self.tokens = Results()
        self.remarks: dict[str, Remarks] = {}
        """By address: what the last run of a document says about its text."""
        self.shows_remarks = False
        """True once the client has asked for lenses or hints, which contain the remarks."""
        self.generation = 0
        """A number that grows whenever the facts that one document implies for others may have changed."""
        self.project = Project()
        self._in_project: dict[str, Document] = {}
        """By file name: the version of each open document that the project knows."""
        self._snapshots: dict[str, tuple[Module, Snapshot]] = {}
        self._working: dict[Future[Any], str] = {}
        """The running computations, each with the document on which it depends."""

    # What the client can do

    def set_client(self, client: types.ClientCapabilities) -> None:
        """Take note of what the client can do."""
        self.client = client
        self.encoding = Encoding(ServerCapabilitiesBuilder.choose_position_encoding(client))

    def can(self, path: str) -> bool:
        """Return whether there is ``true`` at a path of its capabilities."""
        return get_capability(self.client, path) is True

    def has(self, path: str) -> bool:
        """Return whether there is anything at a path of its capabilities."""
        return get_capability(self.client, path) is not None

    def lists(self, path: str) -> frozenset[str]:
        """Return the texts listed at a path of its capabilities."""
        return frozenset(get_capability(self.client, path) or ())

    # Documents

    def document(self, uri: str) -> Document:
        """An open document, or else the file of that name as it is on the disk.

        Raises `JsonRpcInvalidParams` if there is neither.
        """
        document_here = self.documents.get(uri)
        if document_here is None:
            document_here = self.file(uri)
        if document_here is None:
            raise JsonRpcInvalidParams(f"the document {uri} is not open, and no file can be read")
        return document_here

    def file(self, uri: str) -> Document | None:
        """Return a file that is not open, if it can be read."""
        path = to_path(uri)
        if path is None:
            return None
        try:
            source = read_source(path)
        except ScenicError:
            return None
        return Document(uri, "scenic", None, source.text, self.encoding, snapshot_of(source.text, uri))

    def open(self, uri: str, language: str, version: int, text: str) -> Document:
        """Take a document, or a new version of it, into the keeping of the server."""
        self.generation += 1
        snapshot = snapshot_of(text, uri, language)
        document = Document(uri, language, version, text, self.encoding, snapshot)
        self.garbage.outdate(self.documents.get(uri))
        self.documents[uri] = document
        return document

    def close(self, uri: str) -> bool:
        """Close a document; return whether it was open."""
        document = self.documents.pop(uri, None)
        if document is None:
            return False
        self.generation += 1
        self.tokens.forget(uri)
        self.remarks.pop(uri, None)
        whole = document.snapshot.filename
        for filename in [each for each in self._in_project if each == whole or each.startswith(f"{whole}#")]:
            del self._in_project[filename]
            self.project.close(filename)
        return True

    # The project

    def set_folders(self, folders: dict[str, str]) -> None:
        """Take other folders for the workspace."""
        self.folders = folders
        self.generation += 1
        self.project = Project(tuple(folders.values()))
        self._in_project = {}

    def files_changed(self) -> None:
        """Files on the disk have changed: look at them again, and have the client ask again for what depends on them."""
        self.generation += 1
        self.project.refresh()
        self.checks.everything()
        self.have_asked_again(*_REFRESHED)

    def have_asked_again(self, *features: str) -> None:
        """Notify the client, if it supports that, that answers for some features may have changed."""
        for what in features:
            if self.can(f"workspace.{what}.refresh_support"):
                self.ask(_REFRESHED[what], None)

    def project_with(self, document: Document) -> Project:
        """The project, with the present texts of the open documents."""
        return self.project_beside(None if document.uri in self.documents else document)

    def project_beside(self, document: Document | None) -> Project:
        """The project, with the present texts of the open documents other than this one."""
        open_documents = [one for each in self.documents.values() for one in (each.programs or (each,))]
        for each in open_documents:
            if each is document:
                continue
            filename = each.snapshot.filename
            if each.version is not None and self._in_project.get(filename) is not each:
                snapshot = each.snapshot
                resolution = snapshot.resolution if each.is_program else None
                tree = snapshot.tree if each.is_program else None
                self.project.open(filename, snapshot.text, tree=tree, resolution=resolution)
                self._in_project[filename] = each
        return self.project

    def workspace_snapshots(self) -> list[tuple[str, Callable[[], Snapshot]]]:
        """Return the files of the workspace, each with a function that returns its snapshot, made on first use."""
        opened = {
            each.snapshot.filename: each.snapshot for each in self.documents.values() if each.is_program
        }
        names = dict.fromkeys([*opened, *self.project.files()])
        return [(name, self._snapshot_of(name, opened.get(name))) for name in names]

    def _snapshot_of(self, filename: str, opened: Snapshot | None) -> Callable[[], Snapshot]:
        project, snapshots = self.project, self._snapshots

        def make() -> Snapshot:
            if opened is not None:
                return opened
            module = project.module(filename)
            if module is None:
                return Snapshot("", filename)
            entry = snapshots.get(filename)
            if entry is None or entry[0] is not module:
                snapshot = (
                    Snapshot(module.source.text, filename)
                    if module.is_scenic
                    else PythonSnapshot(module.source, module.tree)
                )
                entry = snapshots[filename] = (module, snapshot)
            return entry[1]

        return make

    # From here on: also called by work beside the loop.

    def uri_of(self, filename: str) -> str:
        """Return the address of a file, as the client has it if it is open."""
        opened = self._opened_as(filename)
        return to_uri(filename) if opened is None else opened.uri

    def lines_of(self, filename: str) -> Lines:
        """Return the lines of a file, as the project knows it."""
        opened = self._opened_as(filename)
        if opened is not None:
            return opened.lines
        module = self.project.module(filename)
        return Lines(Source("", filename) if module is None else module.source, self.encoding)

    def location(self, filename: str, span: Span) -> types.Location:
        """A place in any file."""
        return types.Location(self.uri_of(filename), self.lines_of(filename).to_range(span))

    def lines_of_source(self, filename: str, source: Source) -> Lines:
        """Return the lines of a file of which the source is at hand."""
        opened = self._opened_as(filename)
        return Lines(source, self.encoding) if opened is None else opened.lines

    def _opened_as(self, filename: str) -> Document | None:
        # The list is made at once, whatever the loop does to the documents meanwhile.
        opened = [one for each in list(self.documents.values()) for one in (each, *each.programs)]
        return next((each for each in opened if each.snapshot.filename == filename), None)

    def workspace_edit(self, changes: Mapping[str, list[types.TextEdit]]) -> types.WorkspaceEdit:
        """Changes of documents, with their versions if the client knows of such."""
        if not self.can("workspace.workspace_edit.document_changes"):
            return types.WorkspaceEdit(changes=dict(changes))
        documents = []
        for uri, edits in changes.items():
            open_document = self.documents.get(uri)
            version = None if open_document is None else open_document.version
            identifier = types.OptionalVersionedTextDocumentIdentifier(uri, version)
            documents.append(types.TextDocumentEdit(identifier, edits))
        return types.WorkspaceEdit(document_changes=documents)

    def rules(self, filename: str) -> tuple[Configurations, Rules]:
        """The settings of the project that a document belongs to. Read each time: they may have changed, and are small."""
        configurations = Configurations()
        if not os.path.isabs(filename):
            return configurations, Rules()
        return configurations, configurations.of_file(filename).rules_for(filename)

    # Work beside the event loop

    def work(
        self,
        work: Callable[[GoOn], _T],
        *,
        document: str | None = None,
        token: types.ProgressToken | None = None,
        workers: Workers | None = None,
    ) -> Future[_T]:
        """The answer to a request that takes long.

        ``document`` is the one whose change makes the answer worthless, if there is one; by ``token`` the client may call
        off the work.
        """
        future = (workers or self.requests).begin(work)
        if document is not None:
            self._working[future] = document
            future.add_done_callback(lambda done: self._working.pop(done, None))
        if token is not None:
            futures = self.protocol.progress.tokens
            futures[token] = future
            future.add_done_callback(lambda _done: futures.pop(token, None))
        return future

    def outdate(self, uri: str) -> None:
        """Cancel the computations for an outdated version of a document."""
        for future, document in list(self._working.items()):
            if document == uri and not future.done():
                code = types.LSPErrorCodes.ServerCancelled
                again = types.DiagnosticServerCancellationData(retrigger_request=True)
                future.set_exception(JsonRpcException("the document has changed", code, again))

    def later(self, delay: float, action: Callable[[], None]) -> asyncio.TimerHandle:
        """Schedule an action in the event loop after a number of seconds."""
        return asyncio.get_running_loop().call_later(delay, action)

    # Messages to the client

    def notify(self, method: str, params: object) -> None:
        """Tell the client something; from any thread."""
        self.protocol.notify(method, params)

    def ask(self, method: str, params: object) -> "Future[Any]":
        """Send the client a request; return a future of its answer, as JSON."""
        return self.protocol.send_request(method, params)

    def log(self, message: str, *, error: bool = False) -> None:
        """Write to the client's log, and to our error stream; from any thread."""
        sys.stderr.write(f"{message}\n")
        kind = types.MessageType.Error if error else types.MessageType.Log
        self.notify(types.WINDOW_LOG_MESSAGE, types.LogMessageParams(kind, message))
