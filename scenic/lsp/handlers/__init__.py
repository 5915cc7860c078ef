"""What the server does for each method of the protocol: one module for each theme.

A handler converts what the client sent, calls one function of `scenic.ide`, and converts what that returns. The modules
are imported when the first request of their theme arrives: the server starts without them.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from scenic.lsp.convert import Json
from scenic.lsp.session import Deferred, Session

__all__ = ["THEMES", "Notified", "Requested", "notification_handler", "request_handler"]

Requested: TypeAlias = Callable[[Session, Any], Json | Deferred]
Notified: TypeAlias = Callable[[Session, Any], None]

_METHODS: Final = {
    "diagnostics": ("textDocument/diagnostic", "workspace/diagnostic"),
    "editing": (
        "textDocument/codeAction",
        "codeAction/resolve",
        "textDocument/formatting",
        "textDocument/rangeFormatting",
        "textDocument/rangesFormatting",
        "textDocument/onTypeFormatting",
        "textDocument/prepareRename",
        "textDocument/rename",
        "textDocument/linkedEditingRange",
    ),
    "hints": (
        "textDocument/inlayHint",
        "inlayHint/resolve",
        "textDocument/codeLens",
        "codeLens/resolve",
        "textDocument/documentLink",
        "documentLink/resolve",
        "textDocument/documentColor",
        "textDocument/colorPresentation",
    ),
    "information": (
        "textDocument/hover",
        "textDocument/completion",
        "completionItem/resolve",
        "textDocument/signatureHelp",
    ),
    "lifecycle": ("initialized", "$/setTrace"),
    "navigation": (
        "textDocument/declaration",
        "textDocument/definition",
        "textDocument/typeDefinition",
        "textDocument/implementation",
        "textDocument/references",
        "textDocument/documentHighlight",
        "textDocument/prepareCallHierarchy",
        "callHierarchy/incomingCalls",
        "callHierarchy/outgoingCalls",
        "textDocument/prepareTypeHierarchy",
        "typeHierarchy/supertypes",
        "typeHierarchy/subtypes",
        "textDocument/moniker",
        "workspace/symbol",
        "workspaceSymbol/resolve",
    ),
    "running": ("workspace/executeCommand",),
    "structure": (
        "textDocument/documentSymbol",
        "textDocument/foldingRange",
        "textDocument/selectionRange",
        "textDocument/semanticTokens/full",
        "textDocument/semanticTokens/full/delta",
        "textDocument/semanticTokens/range",
    ),
    "synchronization": (
        "textDocument/didOpen",
        "textDocument/didChange",
        "textDocument/didSave",
        "textDocument/didClose",
    ),
    "workspace": (
        "workspace/didChangeConfiguration",
        "workspace/didChangeWorkspaceFolders",
        "workspace/didChangeWatchedFiles",
        "workspace/willRenameFiles",
        "workspace/didRenameFiles",
        "workspace/didCreateFiles",
        "workspace/didDeleteFiles",
    ),
}

THEMES: Final[Mapping[str, str]] = MappingProxyType(
    {method: theme for theme, methods in _METHODS.items() for method in methods}
)
"""By method: the module that knows what to do."""


def request_handler(method: str) -> Requested | None:
    """What answers a request; ``None`` if nothing does."""
    handler: Requested | None = _table(method, "REQUESTS").get(method)
    return handler


def notification_handler(method: str) -> Notified | None:
    """What takes note of a notification; ``None`` if nothing does."""
    handler: Notified | None = _table(method, "NOTIFICATIONS").get(method)
    return handler


def _table(method: str, name: str) -> Mapping[str, Any]:
    theme = THEMES.get(method)
    module = None if theme is None else import_module(f"{__name__}.{theme}")
    table: Mapping[str, Any] = getattr(module, name, {})
    return table
