"""Handlers of the methods of the protocol: one module for each theme.

A handler is given what the client sent as the protocol's types have it, calls one function of `scenic.ide`, and converts what
that returns. The modules are imported when the first request of their theme arrives: the server starts without them.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any, Final

from lsprotocol import types

from scenic.lsp.session import Session

__all__ = ["METHODS", "handler"]

_THEMES: Final[Mapping[str, tuple[str, ...]]] = {
    "diagnostics": (types.TEXT_DOCUMENT_DIAGNOSTIC, types.WORKSPACE_DIAGNOSTIC),
    "editing": (
        types.TEXT_DOCUMENT_CODE_ACTION,
        types.CODE_ACTION_RESOLVE,
        types.TEXT_DOCUMENT_FORMATTING,
        types.TEXT_DOCUMENT_RANGE_FORMATTING,
        types.TEXT_DOCUMENT_RANGES_FORMATTING,
        types.TEXT_DOCUMENT_ON_TYPE_FORMATTING,
        types.TEXT_DOCUMENT_PREPARE_RENAME,
        types.TEXT_DOCUMENT_RENAME,
        types.TEXT_DOCUMENT_LINKED_EDITING_RANGE,
    ),
    "hints": (
        types.TEXT_DOCUMENT_INLAY_HINT,
        types.INLAY_HINT_RESOLVE,
        types.TEXT_DOCUMENT_INLINE_VALUE,
        types.TEXT_DOCUMENT_CODE_LENS,
        types.CODE_LENS_RESOLVE,
        types.TEXT_DOCUMENT_DOCUMENT_LINK,
        types.DOCUMENT_LINK_RESOLVE,
        types.TEXT_DOCUMENT_DOCUMENT_COLOR,
        types.TEXT_DOCUMENT_COLOR_PRESENTATION,
    ),
    "information": (
        types.TEXT_DOCUMENT_HOVER,
        types.TEXT_DOCUMENT_COMPLETION,
        types.COMPLETION_ITEM_RESOLVE,
        types.TEXT_DOCUMENT_SIGNATURE_HELP,
    ),
    "lifecycle": (types.INITIALIZED,),
    "navigation": (
        types.TEXT_DOCUMENT_DECLARATION,
        types.TEXT_DOCUMENT_DEFINITION,
        types.TEXT_DOCUMENT_TYPE_DEFINITION,
        types.TEXT_DOCUMENT_IMPLEMENTATION,
        types.TEXT_DOCUMENT_REFERENCES,
        types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT,
        types.TEXT_DOCUMENT_PREPARE_CALL_HIERARCHY,
        types.CALL_HIERARCHY_INCOMING_CALLS,
        types.CALL_HIERARCHY_OUTGOING_CALLS,
        types.TEXT_DOCUMENT_PREPARE_TYPE_HIERARCHY,
        types.TYPE_HIERARCHY_SUPERTYPES,
        types.TYPE_HIERARCHY_SUBTYPES,
        types.TEXT_DOCUMENT_MONIKER,
        types.WORKSPACE_SYMBOL,
        types.WORKSPACE_SYMBOL_RESOLVE,
    ),
    "running": (types.WORKSPACE_EXECUTE_COMMAND,),
    "structure": (
        types.TEXT_DOCUMENT_DOCUMENT_SYMBOL,
        types.TEXT_DOCUMENT_FOLDING_RANGE,
        types.TEXT_DOCUMENT_SELECTION_RANGE,
        types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL,
        types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL_DELTA,
        types.TEXT_DOCUMENT_SEMANTIC_TOKENS_RANGE,
    ),
    "synchronization": (
        types.TEXT_DOCUMENT_DID_OPEN,
        types.TEXT_DOCUMENT_DID_CHANGE,
        types.TEXT_DOCUMENT_DID_SAVE,
        types.TEXT_DOCUMENT_DID_CLOSE,
    ),
    "workspace": (
        types.WORKSPACE_DID_CHANGE_CONFIGURATION,
        types.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS,
        types.WORKSPACE_DID_CHANGE_WATCHED_FILES,
        types.WORKSPACE_WILL_RENAME_FILES,
        types.WORKSPACE_DID_RENAME_FILES,
        types.WORKSPACE_DID_CREATE_FILES,
        types.WORKSPACE_DID_DELETE_FILES,
    ),
}
_THEME_OF: Final = {method: theme for theme, methods in _THEMES.items() for method in methods}

METHODS: Final = tuple(_THEME_OF)
"""The methods that are registered once the client is known."""


def handler(method: str) -> Callable[[Session, Any], Any]:
    """Return the handler of a method, or of ``initialize``."""
    module = import_module(f"{__name__}.{_THEME_OF.get(method, 'lifecycle')}")
    found: Callable[[Session, Any], Any] = module.HANDLERS[method]
    return found
