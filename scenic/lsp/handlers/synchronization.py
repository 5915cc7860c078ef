"""Documents that are opened, changed and closed."""

from typing import Final

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from scenic.lsp.documents import changed
from scenic.lsp.session import Session

__all__ = ["HANDLERS"]


def _opened(session: Session, params: types.DidOpenTextDocumentParams) -> None:
    given = params.text_document
    document = session.open(given.uri, given.language_id, given.version, given.text)
    if session.project.finder.is_stale(document.snapshot.filename):
        # A file was made beside it of which nobody told us, perhaps this one.
        session.files_changed()
    session.checks.opened(given.uri)


def _changed(session: Session, params: types.DidChangeTextDocumentParams) -> None:
    uri = params.text_document.uri
    document = session.documents.get(uri)
    if document is None:
        raise JsonRpcInvalidParams(f"the document {uri} is not open")
    text = changed(document.text, params.content_changes, session.encoding)
    session.open(uri, document.language, params.text_document.version, text)
    session.checks.changed(uri)
    session.outdate(uri)


def _saved(session: Session, params: types.DidSaveTextDocumentParams) -> None:
    uri = params.text_document.uri
    if not session.can("workspace.did_change_watched_files.dynamic_registration"):
        # Nobody else will tell us that a file may be new.
        session.files_changed()
    elif uri in session.documents:
        session.checks.changed(uri)


def _closed(session: Session, params: types.DidCloseTextDocumentParams) -> None:
    uri = params.text_document.uri
    if session.close(uri):
        session.checks.closed(uri)


HANDLERS: Final = {
    types.TEXT_DOCUMENT_DID_OPEN: _opened,
    types.TEXT_DOCUMENT_DID_CHANGE: _changed,
    types.TEXT_DOCUMENT_DID_SAVE: _saved,
    types.TEXT_DOCUMENT_DID_CLOSE: _closed,
}
