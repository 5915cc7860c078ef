"""The workspace: its folders, its settings, and files that change on the disk."""

from concurrent.futures import Future
from typing import Any, Final

from lsprotocol import types

from scenic.ide.moving import imports_after_moves
from scenic.lsp.session import Session
from scenic.lsp.uris import to_path

__all__ = ["HANDLERS", "read_settings", "take_settings"]

_SECTION: Final = "scenic"


def take_settings(session: Session, settings: object) -> None:
    """Take settings over, as they come with `initialize` or later; those of other sections are none of ours."""
    inner = settings.get(_SECTION) if isinstance(settings, dict) else None
    settings = inner if isinstance(inner, dict) else settings
    if not isinstance(settings, dict):
        return
    session.settings = {**session.settings, **settings}
    if isinstance(settings.get("trusted"), bool) and session.trusting:
        session.trusted = settings["trusted"]


def read_settings(session: Session) -> None:
    """Ask the client for its settings, if it can be asked."""
    if not session.can("workspace.configuration"):
        return
    question = types.ConfigurationParams([types.ConfigurationItem(section=_SECTION)])

    def take(answer: Future[Any]) -> None:
        refused = answer.cancelled() or answer.exception() is not None
        result = None if refused else answer.result()
        if isinstance(result, list) and result:
            take_settings(session, result[0])

    session.ask(types.WORKSPACE_CONFIGURATION, question).add_done_callback(take)


def _configuration(session: Session, params: types.DidChangeConfigurationParams) -> None:
    take_settings(session, params.settings)
    read_settings(session)
    session.checks.everything()


def _folders(session: Session, params: types.DidChangeWorkspaceFoldersParams) -> None:
    folders = dict(session.folders)
    for removed in params.event.removed:
        folders.pop(removed.uri, None)
    for added in params.event.added:
        path = to_path(added.uri)
        if path is not None:
            folders[added.uri] = path
    session.set_folders(folders)
    session.files_changed()


def _watched(session: Session, params: types.DidChangeWatchedFilesParams) -> None:
    if params.changes:
        session.files_changed()


def _will_rename(session: Session, params: types.RenameFilesParams) -> types.WorkspaceEdit | None:
    """Return the edits of the files that import the renamed files."""
    moves = []
    for each in params.files:
        old, new = to_path(each.old_uri), to_path(each.new_uri)
        if old is not None and new is not None:
            moves.append((old, new))
    changes: dict[str, list[types.TextEdit]] = {}
    for place, text in imports_after_moves(session.project_beside(None), moves):
        edit = types.TextEdit(session.lines_of(place.filename).to_range(place.span), text)
        changes.setdefault(session.uri_of(place.filename), []).append(edit)
    return session.workspace_edit(changes) if changes else None


def _moved(
    session: Session, params: types.RenameFilesParams | types.CreateFilesParams | types.DeleteFilesParams
) -> None:
    if params.files:
        session.files_changed()


HANDLERS: Final = {
    types.WORKSPACE_WILL_RENAME_FILES: _will_rename,
    types.WORKSPACE_DID_CHANGE_CONFIGURATION: _configuration,
    types.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS: _folders,
    types.WORKSPACE_DID_CHANGE_WATCHED_FILES: _watched,
    types.WORKSPACE_DID_RENAME_FILES: _moved,
    types.WORKSPACE_DID_CREATE_FILES: _moved,
    types.WORKSPACE_DID_DELETE_FILES: _moved,
}
