"""What the server knows while it talks to one client: what the client can do, the open documents, what is asked of it."""

import os
import sys
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from scenic.configuration.project import Configurations
from scenic.ide.snapshot import PythonSnapshot, Snapshot
from scenic.language.errors import ScenicError
from scenic.language.selection import Rules
from scenic.language.source import Source, read_source
from scenic.language.spans import Span
from scenic.lsp import reading
from scenic.lsp.convert import Encoding, Json, Lines
from scenic.lsp.documents import Document, snapshot_of
from scenic.lsp.errors import ErrorCode, ProtocolError
from scenic.lsp.garbage import Garbage
from scenic.lsp.loop import Loop, Worker
from scenic.lsp.trace import Trace
from scenic.lsp.uris import to_path, to_uri
from scenic.lsp.wire import Writer
from scenic.project.index import Project
from scenic.project.modules import Module

if TYPE_CHECKING:
    from scenic.lsp.checks import Checks

__all__ = ["Client", "Deferred", "Session"]

SUFFIXES: Final = (".scenic", ".sc")
"""The endings of the files that are programs."""

Answer = Callable[[Json], None]
"""What is done with the client's answer to a request; it is given ``None`` if the client refused."""


class Client:
    """What the client can do, as it says at the beginning."""

    def __init__(self, capabilities: Any = None) -> None:
        self._capabilities = capabilities

    def can(self, *path: str) -> bool:
        """Whether there is ``true`` at a path of its capabilities."""
        return reading.flag(self._capabilities, *path)

    def has(self, *path: str) -> bool:
        """Whether there is anything at a path of its capabilities."""
        return reading.lookup(self._capabilities, *path) is not None

    def lists(self, *path: str) -> frozenset[str]:
        """The texts listed at a path of its capabilities."""
        return frozenset(reading.texts(self._capabilities, *path))

    def limit(self, *path: str) -> int | None:
        """The number at a path of its capabilities."""
        value = reading.lookup(self._capabilities, *path)
        return value if isinstance(value, int) and not isinstance(value, bool) else None

    @property
    def encoding(self) -> Encoding:
        """The first encoding of columns that it offers and we know; without an offer, that of the protocol."""
        for each in reading.texts(self._capabilities, "general", "positionEncodings"):
            if each in tuple(Encoding):
                return Encoding(each)
        return Encoding.UTF16


class Deferred:
    """The answer to a request that takes long: worked out beside the loop.

    ``work`` calls the function that it is given now and then, which raises if the answer is no longer wanted.
    ``document`` is the one whose change makes the answer worthless, if there is one. Work that mostly waits has a
    thread of its own.
    """

    def __init__(
        self,
        work: Callable[[Callable[[], None]], Json],
        *,
        document: str | None = None,
        own_thread: bool = False,
    ) -> None:
        self.work = work
        self.document = document
        self.own_thread = own_thread


class Results:
    """The last result of each document for which a client may ask what has changed since."""

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
    """The state that all handlers share; used in the loop's thread only."""

    def __init__(self, loop: Loop, writer: Writer) -> None:
        self.loop = loop
        self.writer = writer
        self.client = Client()
        self.encoding = Encoding.UTF16
        self.documents: dict[str, Document] = {}
        self.folders: dict[str, str] = {}
        """The folders of the workspace: names of folders by their addresses."""
        self.trusted: bool | None = None
        """Whether programs may be run; ``None`` if the client did not say."""
        self.settings: Mapping[str, Any] = {}
        self.garbage = Garbage(loop)
        self.trace = Trace(writer)
        self.checker = Worker("checks")
        self.checks: Checks
        self.tokens = Results()
        self.generation = 0
        """Grows whenever what one document says of others may have changed."""
        self.project = Project()
        self._in_project: dict[str, Document] = {}
        """By file name: the version of each open document that the project knows."""
        self._snapshots: dict[str, tuple[Module, Snapshot]] = {}
        self._asked: dict[str, Answer] = {}
        self._count = 0

    # Documents

    def document(self, uri: str) -> Document:
        """An open document, or else the file of that name as it is on the disk.

        Raises `ProtocolError` if there is neither.
        """
        found = self.documents.get(uri)
        if found is None:
            found = self.file(uri)
        if found is None:
            raise ProtocolError(
                ErrorCode.INVALID_PARAMS, f"the document {uri} is not open, and no file can be read"
            )
        return found

    def file(self, uri: str) -> Document | None:
        """A file that is not open, if it can be read."""
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
        before = self.documents.get(uri)
        snapshot = snapshot_of(text, uri, None if before is None else before.snapshot)
        document = Document(uri, language, version, text, self.encoding, snapshot)
        self.documents[uri] = document
        return document

    def close(self, uri: str) -> bool:
        """Give a document up; tells whether it was open."""
        document = self.documents.pop(uri, None)
        if document is None:
            return False
        self.generation += 1
        self.tokens.forget(uri)
        filename = document.snapshot.filename
        if self._in_project.pop(filename, None) is not None:
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
        self.have_asked_again("diagnostics", "semanticTokens", "inlayHint", "codeLens")

    def have_asked_again(self, *features: str) -> None:
        """Tell the client, if it can be told, that answers about some features may be others now."""
        for what in features:
            if self.client.can("workspace", what, "refreshSupport"):
                method = "diagnostic" if what == "diagnostics" else what
                self.ask(f"workspace/{method}/refresh", None, lambda _result: None)

    def project_with(self, document: Document) -> Project:
        """The project, with the present texts of the open documents."""
        return self.project_beside(None if document.uri in self.documents else document)

    def project_beside(self, document: Document | None) -> Project:
        """The project, with the present texts of the open documents other than this one."""
        for each in self.documents.values():
            if each is document:
                continue
            filename = each.snapshot.filename
            if each.version is not None and self._in_project.get(filename) is not each:
                snapshot = each.snapshot
                known = snapshot.resolution if each.is_program else None
                tree = snapshot.tree if each.is_program else None
                self.project.open(filename, snapshot.text, tree=tree, resolution=known)
                self._in_project[filename] = each
        return self.project

    def workspace_snapshots(self) -> list[tuple[str, Callable[[], Snapshot]]]:
        """The files of the workspace, each with what gives its snapshot: made when it is first asked for."""
        opened = {
            each.snapshot.filename: each.snapshot for each in self.documents.values() if each.is_program
        }
        names = dict.fromkeys([*opened, *self.project.files()])
        return [(name, self._snapshot_of(name, opened.get(name))) for name in names]

    def _snapshot_of(self, filename: str, opened: Snapshot | None) -> Callable[[], Snapshot]:
        project, known = self.project, self._snapshots

        def make() -> Snapshot:
            if opened is not None:
                return opened
            module = project.module(filename)
            if module is None:
                return Snapshot("", filename)
            kept = known.get(filename)
            if kept is None or kept[0] is not module:
                own = (
                    Snapshot(module.source.text, filename)
                    if module.is_scenic
                    else PythonSnapshot(module.source, module.tree)
                )
                kept = known[filename] = (module, own)
            return kept[1]

        return make

    # From here on: also called by work beside the loop.

    def uri_of(self, filename: str) -> str:
        """The address of a file, as the client has it if it is open."""
        opened = self._opened_as(filename)
        return to_uri(filename) if opened is None else opened.uri

    def lines_of(self, filename: str) -> Lines:
        """The lines of a file, as the project knows it."""
        opened = self._opened_as(filename)
        if opened is not None:
            return opened.lines
        module = self.project.module(filename)
        return Lines(Source("", filename) if module is None else module.source, self.encoding)

    def location(self, filename: str, span: Span) -> Json:
        """A place in any file."""
        return {"uri": self.uri_of(filename), "range": self.lines_of(filename).to_range(span)}

    def lines_of_source(self, filename: str, source: Source) -> Lines:
        """The lines of a file of which the source is at hand."""
        opened = self._opened_as(filename)
        return Lines(source, self.encoding) if opened is None else opened.lines

    def _opened_as(self, filename: str) -> Document | None:
        # The list is made at once, whatever the loop does to the documents meanwhile.
        return next(
            (each for each in list(self.documents.values()) if each.snapshot.filename == filename), None
        )

    def workspace_edit(self, changes: Mapping[str, list[Json]]) -> Json:
        """Changes of documents, with their versions if the client knows of such."""
        if not self.client.can("workspace", "workspaceEdit", "documentChanges"):
            return {"changes": dict(changes)}
        documents = []
        for uri, edits in changes.items():
            opened = self.documents.get(uri)
            version = None if opened is None else opened.version
            documents.append({"textDocument": {"uri": uri, "version": version}, "edits": edits})
        return {"documentChanges": documents}

    def rules(self, filename: str) -> tuple[Configurations, Rules]:
        """The settings of the project that a document belongs to. Read each time: they may have changed, and are small."""
        configurations = Configurations()
        if not os.path.isabs(filename):
            return configurations, Rules()
        return configurations, configurations.of_file(filename).rules_for(filename)

    # Messages to the client

    def notify(self, method: str, params: Json) -> None:
        """Tell the client something; from any thread."""
        self.writer.write({"jsonrpc": "2.0", "method": method, "params": params})

    def ask(self, method: str, params: Json, answer: Answer) -> None:
        """Ask the client something; ``answer`` is given what it says."""
        self._count += 1
        name = f"scenic-{self._count}"
        self._asked[name] = answer
        self.writer.write({"jsonrpc": "2.0", "id": name, "method": method, "params": params})

    def answered(self, name: object, result: Json) -> None:
        """The client has answered one of our requests."""
        answer = self._asked.pop(name, None) if isinstance(name, str) else None
        if answer is not None:
            answer(result)

    def log(self, message: str, *, error: bool = False) -> None:
        """Write to the client's log, and to our error stream; from any thread."""
        sys.stderr.write(f"{message}\n")
        self.notify("window/logMessage", {"type": _ERROR if error else _LOG, "message": message})


_ERROR: Final = 1
_LOG: Final = 4
