"""Documents that are opened, changed and closed."""

from typing import Any, Final

from scenic.lsp import reading
from scenic.lsp.documents import changed
from scenic.lsp.errors import ErrorCode, ProtocolError
from scenic.lsp.session import Session

__all__ = ["NOTIFICATIONS"]


def _opened(session: Session, params: Any) -> None:
    uri = reading.uri_of(params)
    language = reading.lookup(params, "textDocument", "languageId")
    session.open(
        uri,
        language if isinstance(language, str) else "scenic",
        reading.integer(params, "textDocument", "version"),
        reading.text(params, "textDocument", "text"),
    )
    if session.project.finder.is_stale(session.documents[uri].snapshot.filename):
        # A file was made beside it of which nobody told us, perhaps this one.
        session.files_changed()
    session.checks.opened(uri)


def _changed(session: Session, params: Any) -> None:
    uri = reading.uri_of(params)
    document = session.documents.get(uri)
    if document is None:
        raise ProtocolError(ErrorCode.INVALID_PARAMS, f"the document {uri} is not open")
    text = changed(document.text, reading.items(params, "contentChanges"), session.encoding)
    session.open(uri, document.language, reading.integer(params, "textDocument", "version"), text)
    session.checks.changed(uri)


def _saved(session: Session, params: Any) -> None:
    uri = reading.uri_of(params)
    if not session.client.can("workspace", "didChangeWatchedFiles", "dynamicRegistration"):
        # Nobody else will tell us that a file may be new.
        session.files_changed()
    elif uri in session.documents:
        session.checks.changed(uri)


def _closed(session: Session, params: Any) -> None:
    uri = reading.uri_of(params)
    if session.close(uri):
        session.checks.closed(uri)


NOTIFICATIONS: Final = {
    "textDocument/didOpen": _opened,
    "textDocument/didChange": _changed,
    "textDocument/didSave": _saved,
    "textDocument/didClose": _closed,
}
