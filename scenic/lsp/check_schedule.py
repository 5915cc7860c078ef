"""The schedule of checks of documents, and the publication of their findings.

A check begins a moment after a change, beside the loop. A change that arrives while it runs makes it worthless, unless
the client has waited too long for any result.
"""

import asyncio
import os
import re
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import Final, TypeAlias

from lsprotocol import types

from scenic.ide.continuations import prepare
from scenic.ide.diagnostics import found_in
from scenic.language.diagnostics import Diagnostic
from scenic.language.errors import ScenicError
from scenic.language.source import Source, read_source
from scenic.lsp.convert import Lines, to_diagnostic
from scenic.lsp.documents import Document
from scenic.lsp.session import Session
from scenic.lsp.threads import GoOn
from scenic.lsp.uris import to_uri
from scenic.project.index import Project

__all__ = ["Checks"]

PAUSE: Final = 0.002
"""Seconds without a change after which a document is checked."""
LONG_PAUSE: Final = 0.5
"""Seconds without a change after which the documents are checked that may import the changed one."""
LONGEST_WAIT: Final = 0.3
"""Seconds after the first change that nobody has heard of, after which a check is begun, and no longer given up."""


_IMPORTS: Final = re.compile(r"^\s*(?:import|from|model)\b", re.MULTILINE)

Found: TypeAlias = tuple[list[types.Diagnostic], tuple[Diagnostic, ...]]
"""The faults of a document by the settings of its project, and those of the settings."""


class Checks:
    """The checks of the open documents, made beside the loop."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._timers: dict[str, asyncio.TimerHandle] = {}
        self._running: dict[str, Future[Found]] = {}
        self._since: dict[str, float] = {}
        """By document: when the first change came that no result has covered yet."""
        self._pulled: set[str] = set()
        """The documents whose problems the client requests itself."""
        self._told: set[str] = set()
        """The documents with published problems that have to be withdrawn later."""
        self._others: asyncio.TimerHandle | None = None
        self._troubled: dict[str, tuple[Diagnostic, ...]] = {}
        """By document: the problems of its settings that are shown."""
        self._is_prepared = False

    # What makes a check necessary

    def changed(self, uri: str) -> None:
        """A document has changed."""
        now = time.monotonic()
        late = now - self._since.setdefault(uri, now) > LONGEST_WAIT
        if uri in self._running:
            if late:
                return  # Its result is waited for; the next check begins when it is there.
            self._running.pop(uri).cancel()
        self._stop_timer(uri)
        if late:
            self._begin(uri)
        else:
            self._timers[uri] = self._session.later(PAUSE, lambda: self._begin(uri))
        self._await_others(uri)

    def opened(self, uri: str) -> None:
        """A document has been opened: it is checked at once."""
        self._since[uri] = time.monotonic()
        self._begin(uri)
        if not self._session.documents[uri].is_saved():
            self._await_others(uri)

    def closed(self, uri: str) -> None:
        """A document has been closed: nothing is shown of it any more, and its file is what others import."""
        self._stop_timer(uri)
        job = self._running.pop(uri, None)
        if job is not None:
            job.cancel()
        self._since.pop(uri, None)
        self._pulled.discard(uri)
        self._told.discard(uri)
        self._publish(uri, [], None)
        self._show_problems(uri, ())
        self._await_others(uri)

    def everything(self) -> None:
        """Settings or files on the disk have changed: every open document may have other problems now."""
        for uri in self._session.documents:
            self.changed(uri)

    def _await_others(self, changed: str) -> None:
        """Check what may import a document that has another text now, once nothing changes for a while."""
        if self._others is not None:
            self._others.cancel()
        self._others = self._session.later(LONG_PAUSE, lambda: self._check_others(changed))

    def _check_others(self, changed: str) -> None:
        """Other documents may import the one that has changed."""
        self._others = None
        importing = [
            uri
            for uri, document in self._session.documents.items()
            if uri != changed and _IMPORTS.search(document.text)
        ]
        for uri in importing:
            if uri not in self._running:
                self._since.setdefault(uri, time.monotonic())
                self._begin(uri)
        if not self._pulled.isdisjoint(importing):
            self._session.have_asked_again("diagnostics")

    def pulled(self, uri: str) -> None:
        """Stop sending the problems of a document that the client requests itself, which it would show twice.

        A client that does not say that it can ask goes by what it is sent, whatever it tries besides.
        """
        if uri not in self._pulled and self._session.has("text_document.diagnostic"):
            self._pulled.add(uri)
            if uri in self._told:
                self._told.discard(uri)
                self._publish(uri, [], None)

    # One check

    def _begin(self, uri: str) -> None:
        self._stop_timer(uri)
        document = self._session.documents.get(uri)
        if document is None:
            return
        if uri in self._pulled:
            self._since.pop(uri, None)
            return
        session = self._session
        loop = asyncio.get_running_loop()
        check = session.checker.begin(finder(session, document))
        self._running[uri] = check
        check.add_done_callback(lambda done: loop.call_soon_threadsafe(self._finish, done, document))

    def _finish(self, check: Future[Found], document: Document) -> None:
        uri = document.uri
        if self._running.get(uri) is not check:
            return
        del self._running[uri]
        self._since.pop(uri, None)
        present = self._session.documents.get(uri)
        if present is None:
            return
        diagnostics, problems = check.result()
        if uri not in self._pulled:
            self._told.add(uri)
            self._publish(uri, diagnostics, document.version)
        self._show_problems(uri, problems)
        if present is not document:
            self.changed(uri)
        self._session.garbage.checked()
        if not self._is_prepared:
            self._is_prepared = True
            self._session.later(LONG_PAUSE, self._prepare)

    def _prepare(self) -> None:
        """Make the tables that completion reads, once nobody waits for a check: the first one should not wait for them."""
        if self._timers or self._running:
            self._session.later(LONG_PAUSE, self._prepare)
        else:
            self._session.requests.begin(lambda _go_on: prepare())

    def _stop_timer(self, uri: str) -> None:
        timer = self._timers.pop(uri, None)
        if timer is not None:
            timer.cancel()

    def _publish(self, uri: str, found: list[types.Diagnostic], version: int | None) -> None:
        support = "text_document.publish_diagnostics"
        knows = self._session.can(f"{support}.version_support") or not self._session.has(support)
        self._session.notify(
            types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS,
            types.PublishDiagnosticsParams(uri, found, version=version if knows else None),
        )

    # Problems of settings

    def _show_problems(self, document: str, problems: tuple[Diagnostic, ...]) -> None:
        """Publish what is wrong with the settings of a document, and take back what no open document has any more."""
        before = self._files(self._troubled.pop(document, ()))
        if problems:
            self._troubled[document] = problems
        remaining = self._files(
            [item for problems_of_document in self._troubled.values() for item in problems_of_document]
        )
        for filename in sorted(before | self._files(problems)):
            diagnostics = [
                item
                for item in dict.fromkeys(
                    each for problems_of_document in self._troubled.values() for each in problems_of_document
                )
                if item.filename is not None and os.path.abspath(item.filename) == filename
            ]
            assert diagnostics or filename not in remaining
            try:
                source = read_source(filename)
            except ScenicError:
                source = Source("", filename)
            uri = to_uri(filename)
            self._publish(
                uri, _protocol(diagnostics, Lines(source, self._session.encoding), uri, self._session), None
            )

    @staticmethod
    def _files(problems: Sequence[Diagnostic]) -> set[str]:
        return {os.path.abspath(item.filename) for item in problems if item.filename is not None}


def finder(session: Session, document: Document) -> Callable[[GoOn], Found]:
    """Return a function that finds the problems of a document, in any thread. To be called in the loop's thread."""
    project, stamp = session.project_beside(document), session.generation

    return lambda go_on: found_in_document(session, document, project, stamp, go_on)


def found_in_document(
    session: Session, document: Document, project: Project, stamp: int, go_on: GoOn
) -> Found:
    """Return the faults of a document, and of its settings; ``stamp`` is the generation that ``project`` is of."""
    if not document.programs:
        return [], ()
    configurations, rules = session.rules(document.snapshot.filename)
    diagnostics: list[types.Diagnostic] = []
    for each in document.programs:
        faults = found_in(each.snapshot, rules, project, stamp=stamp, go_on=go_on)
        diagnostics += _protocol(faults, each.lines, document.uri, session)
    return diagnostics, configurations.problems


def _protocol(
    found: Sequence[Diagnostic], lines: Lines, uri: str, session: Session
) -> list[types.Diagnostic]:
    support = "text_document.publish_diagnostics"
    is_declared = session.has(support)
    takes_related = not is_declared or session.can(f"{support}.related_information")
    tags = not is_declared or session.has(f"{support}.tag_support")
    pages = session.can(f"{support}.code_description_support")
    return [
        to_diagnostic(
            item, lines, uri, elsewhere=session.location, related=takes_related, tags=tags, pages=pages
        )
        for item in found
    ]
