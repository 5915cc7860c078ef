"""Problems that the client asks for: of one document, and of all files of the workspace."""

from collections.abc import Callable, Iterator
from hashlib import sha256
from json import dumps
from typing import Any, Final

from scenic.configuration.project import Configurations
from scenic.lsp import reading
from scenic.lsp.checks import finder, found_in_document
from scenic.lsp.convert import Json
from scenic.lsp.progress import Partial, Progress
from scenic.lsp.session import SUFFIXES, Deferred, Session
from scenic.lsp.uris import to_uri
from scenic.project.index import Project

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
    project, stamp = session.project_beside(None), session.generation
    progress = Progress(session, reading.lookup(params, "workDoneToken"), "Checking the workspace")
    partial = Partial(session, reading.lookup(params, "partialResultToken"))

    def work(go_on: Callable[[], None]) -> Json:
        with progress:
            named = {to_uri(path): path for path in _programs(project)}
            for done, uri in enumerate(sorted(named.keys() | documents.keys())):
                go_on()
                document = documents.get(uri) or session.file(uri)
                if document is None:
                    continue
                found, _ = found_in_document(session, document, project, stamp, go_on)
                report = {"uri": uri, "version": document.version, **_report(found, previous.get(uri))}
                partial.add([report], lambda items: {"items": items})
                progress.report(done + 1, len(named))
        return {"items": partial.rest}

    return Deferred(work)


def _programs(project: Project) -> Iterator[str]:
    """The programs of the workspace, but for those that its settings leave out."""
    configurations = Configurations()
    for path in project.files():
        if path.endswith(SUFFIXES) and not configurations.of_file(path).excludes(path):
            yield path


def _report(found: list[Json], previous: Json) -> Json:
    """All that was found, or only that it is what the client knows already."""
    name = sha256(dumps(found, sort_keys=True).encode()).hexdigest()[:16]
    if name == previous:
        return {"kind": "unchanged", "resultId": name}
    return {"kind": "full", "resultId": name, "items": found}


REQUESTS: Final = {"textDocument/diagnostic": _document, "workspace/diagnostic": _workspace}
