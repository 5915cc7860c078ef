"""Problems that the client requests: of one document, and of all files of the workspace."""

from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from hashlib import sha256
from typing import Final

from lsprotocol import types

from scenic.configuration.project import Configurations
from scenic.lsp.check_schedule import finder, found_in_document
from scenic.lsp.progress import Partial, Progress
from scenic.lsp.session import SUFFIXES, Session
from scenic.lsp.threads import GoOn
from scenic.lsp.uris import to_uri
from scenic.project.index import Project

__all__ = ["HANDLERS"]


def _document(
    session: Session, params: types.DocumentDiagnosticParams
) -> Future[types.DocumentDiagnosticReport]:
    uri = params.text_document.uri
    document = session.document(uri)
    if uri in session.documents:
        session.checks.pulled(uri)
    find = finder(session, document)

    def work(go_on: GoOn) -> types.DocumentDiagnosticReport:
        found, _ = find(go_on)
        name = _name(found)
        if name == params.previous_result_id:
            return types.RelatedUnchangedDocumentDiagnosticReport(name)
        return types.RelatedFullDocumentDiagnosticReport(found, result_id=name)

    return session.work(work, document=uri, token=params.work_done_token)


def _workspace(
    session: Session, params: types.WorkspaceDiagnosticParams
) -> Future[types.WorkspaceDiagnosticReport]:
    previous = {each.uri: each.value for each in params.previous_result_ids}
    documents = dict(session.documents)
    project, stamp = session.project_beside(None), session.generation
    progress = Progress(session, params.work_done_token, "Checking the workspace")
    partial: Partial[types.WorkspaceDocumentDiagnosticReport] = Partial(session, params.partial_result_token)

    def work(go_on: GoOn) -> types.WorkspaceDiagnosticReport:
        with progress:
            paths = {to_uri(path): path for path in _programs(project)}
            for number, uri in enumerate(sorted(paths.keys() | documents.keys())):
                go_on()
                document = documents.get(uri) or session.file(uri)
                if document is None:
                    continue
                diagnostics, _ = found_in_document(session, document, project, stamp, go_on)
                report = _report(uri, document.version, diagnostics, previous.get(uri))
                partial.add([report], types.WorkspaceDiagnosticReport)
                progress.report(number + 1, len(paths))
        return types.WorkspaceDiagnosticReport(partial.rest)

    return session.work(work, token=params.work_done_token)


def _programs(project: Project) -> Iterator[str]:
    """Yield the programs of the workspace, but for those that its settings leave out."""
    configurations = Configurations()
    for path in project.files():
        if path.endswith(SUFFIXES) and not configurations.of_file(path).excludes(path):
            yield path


def _report(
    uri: str, version: int | None, found: Sequence[types.Diagnostic], previous: str | None
) -> types.WorkspaceDocumentDiagnosticReport:
    """Report all diagnostics, or only that they are those that the client has already."""
    name = _name(found)
    if name == previous:
        return types.WorkspaceUnchangedDocumentDiagnosticReport(uri, name, version)
    return types.WorkspaceFullDocumentDiagnosticReport(uri, found, version, result_id=name)


def _name(found: Sequence[types.Diagnostic]) -> str:
    """The name of a result: equal results have equal names."""
    return sha256(repr(found).encode("utf-8", "surrogatepass")).hexdigest()[:16]


HANDLERS: Final = {types.TEXT_DOCUMENT_DIAGNOSTIC: _document, types.WORKSPACE_DIAGNOSTIC: _workspace}
