"""The beginning of a conversation: what the client can do, and what the server offers to such a client."""

import os
import sys
from typing import Any, Final

from scenic.lsp import reading
from scenic.lsp.capabilities import capabilities, registrations
from scenic.lsp.convert import Json
from scenic.lsp.errors import ErrorCode, ProtocolError
from scenic.lsp.handlers.workspace import read_settings, take_settings
from scenic.lsp.session import Client, Session
from scenic.lsp.uris import to_path, to_uri

__all__ = ["NOTIFICATIONS", "initialize"]


def initialize(session: Session, params: Any) -> Json:
    """Note what the client says of itself; returns what the server can do for it."""
    if not isinstance(params, dict) or not isinstance(params.get("capabilities", {}), dict):
        raise ProtocolError(ErrorCode.INVALID_PARAMS, "`initialize` needs an object with `capabilities`")
    client = session.client = Client(params.get("capabilities"))
    session.encoding = client.encoding
    session.set_folders(_folders(params))
    session.trace.set(params.get("trace"))
    options = params.get("initializationOptions")
    take_settings(session, options)
    return {
        "capabilities": capabilities(client),
        "serverInfo": {"name": "scenic", "version": _version()},
    }


def _folders(params: Any) -> dict[str, str]:
    """The folders of the workspace; older clients name only one."""
    found = reading.lookup(params, "workspaceFolders")
    uris = [reading.lookup(each, "uri") for each in found] if isinstance(found, list) else []
    if not uris:
        root, path = reading.lookup(params, "rootUri"), reading.lookup(params, "rootPath")
        uris = [root if root is not None else to_uri(path) if isinstance(path, str) and path else None]
    folders = {uri: to_path(uri) for uri in uris if isinstance(uri, str)}
    return {uri: path for uri, path in folders.items() if path is not None}


def _initialized(session: Session, _params: Any) -> None:
    """The client is ready: now it may be asked to report more."""
    wanted = registrations(session.client)
    if wanted:
        session.ask("client/registerCapability", {"registrations": wanted}, lambda _result: None)
    read_settings(session)


def _trace(session: Session, params: Any) -> None:
    """The client would like to hear more or less."""
    session.trace.set(reading.lookup(params, "value"))


NOTIFICATIONS: Final = {"initialized": _initialized, "$/setTrace": _trace}


def _version() -> str:
    """The version that is installed, read off the name of a folder: asking for it takes longer than to start."""
    for folder in sys.path:
        try:
            names = os.listdir(folder or os.curdir)
        except OSError:
            continue
        for name in names:
            if name.startswith("scenic_lang-") and name.endswith(".dist-info"):
                return name.removeprefix("scenic_lang-").removesuffix(".dist-info")
    return "0"
