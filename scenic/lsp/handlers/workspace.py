"""The workspace: its folders, its settings, and files that change on the disk."""

from typing import Any, Final

from scenic.lsp import reading
from scenic.lsp.convert import Json
from scenic.lsp.session import Session
from scenic.lsp.uris import to_path

__all__ = ["NOTIFICATIONS", "read_settings", "take_settings"]

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


NOTIFICATIONS: Final = {
    "workspace/didChangeConfiguration": _configuration,
    "workspace/didChangeWorkspaceFolders": _folders,
    "workspace/didChangeWatchedFiles": _files,
}
