"""The workspace: its folders, its settings, and files that change on the disk."""

from typing import Any, Final

from scenic.ide.moving import imports_after_moves
from scenic.lsp import reading
from scenic.lsp.convert import Json
from scenic.lsp.session import Session
from scenic.lsp.uris import to_path

__all__ = ["NOTIFICATIONS", "REQUESTS", "read_settings", "take_settings"]

_SECTION: Final = "scenic"


def take_settings(session: Session, settings: Any) -> None:
    """Take settings over, as they come with `initialize` or later; those of other sections are none of ours."""
    inner = reading.lookup(settings, _SECTION)
    settings = inner if isinstance(inner, dict) else settings
    if not isinstance(settings, dict):
        return
    session.settings = {**session.settings, **settings}
    if isinstance(settings.get("trusted"), bool):
        session.trusted = settings["trusted"]


def read_settings(session: Session) -> None:
    """Ask the client for its settings, if it can be asked."""
    if not session.client.can("workspace", "configuration"):
        return

    def answer(result: Json) -> None:
        if isinstance(result, list) and result:
            take_settings(session, result[0])

    session.ask("workspace/configuration", {"items": [{"section": _SECTION}]}, answer)


def _configuration(session: Session, params: Any) -> None:
    take_settings(session, reading.lookup(params, "settings"))
    read_settings(session)
    session.checks.everything()


def _folders(session: Session, params: Any) -> None:
    folders = dict(session.folders)
    for removed in reading.items(params, "event", "removed"):
        folders.pop(reading.text(removed, "uri"), None)
    for added in reading.items(params, "event", "added"):
        uri = reading.text(added, "uri")
        path = to_path(uri)
        if path is not None:
            folders[uri] = path
    session.set_folders(folders)
    session.files_changed()


def _files(session: Session, params: Any) -> None:
    if reading.items(params, "changes"):
        session.files_changed()


def _will_rename(session: Session, params: Any) -> Json:
    """What changes in the files that import those which get another name."""
    moves = []
    for each in reading.items(params, "files"):
        old, new = to_path(reading.text(each, "oldUri")), to_path(reading.text(each, "newUri"))
        if old is not None and new is not None:
            moves.append((old, new))
    project = session.project_beside(None)
    changes: dict[str, list[Json]] = {}
    for place, text in imports_after_moves(project, moves):
        edit = {"range": session.lines_of(place.filename).to_range(place.span), "newText": text}
        changes.setdefault(session.uri_of(place.filename), []).append(edit)
    return session.workspace_edit(changes) if changes else None


def _moved(session: Session, params: Any) -> None:
    if reading.items(params, "files"):
        session.files_changed()


REQUESTS: Final = {"workspace/willRenameFiles": _will_rename}
NOTIFICATIONS: Final = {
    "workspace/didChangeConfiguration": _configuration,
    "workspace/didChangeWorkspaceFolders": _folders,
    "workspace/didChangeWatchedFiles": _files,
    "workspace/didRenameFiles": _moved,
    "workspace/didCreateFiles": _moved,
    "workspace/didDeleteFiles": _moved,
}
