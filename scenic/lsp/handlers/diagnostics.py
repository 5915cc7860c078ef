"""Problems that the client asks for: of one document, and of all files of the workspace."""

from collections.abc import Callable
from hashlib import sha256
from json import dumps
from typing import Any, Final

from scenic.lsp import reading
from scenic.lsp.checks import finder
from scenic.lsp.convert import Json
from scenic.lsp.progress import Progress
from scenic.lsp.session import SUFFIXES, Deferred, Session
from scenic.lsp.uris import to_uri

__all__ = ["REQUESTS"]


def _document(session: Session, params: Any) -> Deferred:
    uri = reading.uri_of(params)
    document = session.document(uri)
    if uri in session.documents:
        session.checks.pulled(uri)
    previous = reading.lookup(params, "previousResultId")

    find = finder(session, document)

    def work(go_on: Callable[[], None]) -> Json:
        found, _ = find(go_on)
        return _report(found, previous)

    return Deferred(work, document=uri)


def _workspace(session: Session, params: Any) -> Deferred:
    previous = {
        reading.lookup(each, "uri"): reading.lookup(each, "value")
        for each in reading.lookup(params, "previousResultIds") or []
    }
    documents = dict(session.documents)
    progress = Progress(session, reading.lookup(params, "workDoneToken"), "Checking the workspace")

    def work(go_on: Callable[[], None]) -> Json:
        items = []
        with progress:
            named = {to_uri(path): path for path in session.project.files() if path.endswith(SUFFIXES)}
            for done, uri in enumerate(sorted(named.keys() | documents.keys())):
                go_on()
                document = documents.get(uri) or session.file(uri)
                if document is None:
                    continue
                found, _ = finder(session, document)(go_on)
                items.append({"uri": uri, "version": document.version, **_report(found, previous.get(uri))})
                progress.report(done + 1, len(named))
        return {"items": items}

    return Deferred(work)


def _report(found: list[Json], previous: Json) -> Json:
    """All that was found, or only that it is what the client knows already."""
    name = sha256(dumps(found, sort_keys=True).encode()).hexdigest()[:16]
    if name == previous:
        return {"kind": "unchanged", "resultId": name}
    return {"kind": "full", "resultId": name, "items": found}


REQUESTS: Final = {"textDocument/diagnostic": _document, "workspace/diagnostic": _workspace}
