"""The beginning of a session: the client's capabilities, and the reports that it is asked for."""

from typing import Final

from lsprotocol import types

from scenic.lsp.capabilities import registrations
from scenic.lsp.handlers.workspace import read_settings, take_settings
from scenic.lsp.session import Session
from scenic.lsp.uris import to_path, to_uri

__all__ = ["HANDLERS"]


def _initialize(session: Session, params: types.InitializeParams) -> None:
    session.set_client(params.capabilities)
    session.set_folders(_folders(params))
    take_settings(session, params.initialization_options)


def _folders(params: types.InitializeParams) -> dict[str, str]:
    """Return the folders of the workspace; older clients name only one."""
    uris = [each.uri for each in params.workspace_folders or ()]
    if not uris and params.root_uri is not None:
        uris = [params.root_uri]
    elif not uris and params.root_path:
        uris = [to_uri(params.root_path)]
    folders = {uri: to_path(uri) for uri in uris}
    return {uri: path for uri, path in folders.items() if path is not None}


def _initialized(session: Session, _params: types.InitializedParams) -> None:
    """Register for further reports, once the client is ready."""
    wanted = registrations(session.client)
    if wanted:
        session.ask(types.CLIENT_REGISTER_CAPABILITY, types.RegistrationParams(wanted))
    read_settings(session)


HANDLERS: Final = {types.INITIALIZE: _initialize, types.INITIALIZED: _initialized}
