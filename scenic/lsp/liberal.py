"""Fields that clients leave out of messages although the protocol requires them, and the values that are taken instead."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

from lsprotocol import types

__all__ = ["completed"]

_FORMATTING: Final = {"options": {"tabSize": 4, "insertSpaces": True}}
_REQUIRED: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        types.INITIALIZE: {"capabilities": {}, "processId": None, "rootUri": None},
        types.TEXT_DOCUMENT_CODE_ACTION: {"context": {"diagnostics": []}},
        types.TEXT_DOCUMENT_DID_OPEN: {"textDocument": {"languageId": "scenic", "version": 0}},
        types.TEXT_DOCUMENT_FORMATTING: _FORMATTING,
        types.TEXT_DOCUMENT_RANGE_FORMATTING: _FORMATTING,
        types.TEXT_DOCUMENT_ON_TYPE_FORMATTING: _FORMATTING,
        types.TEXT_DOCUMENT_REFERENCES: {"context": {"includeDeclaration": True}},
    }
)
"""By method, the fields that are added where they are missing."""
_REQUIRED_INSIDE: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        types.TEXT_DOCUMENT_COMPLETION: {"context": {"triggerKind": 1}},
        types.TEXT_DOCUMENT_SIGNATURE_HELP: {"context": {"triggerKind": 1, "isRetrigger": False}},
    }
)
"""The same for objects that may be missing as a whole."""


def completed(method: str, params: object) -> Any:
    """Return the parameters of a message, with the fields that some clients leave out."""
    if not isinstance(params, dict):
        return params
    defaults = _REQUIRED.get(method, {})
    inside = {
        name: fields
        for name, fields in _REQUIRED_INSIDE.get(method, {}).items()
        if isinstance(params.get(name), dict)
    }
    return _with_defaults(params, {**defaults, **inside}) if defaults or inside else params


def _with_defaults(given: Mapping[str, object], defaults: Mapping[str, object]) -> dict[str, Any]:
    result = dict(given)
    for name, default in defaults.items():
        value = result.get(name)
        if value is None:
            result[name] = default
        elif isinstance(value, dict) and isinstance(default, Mapping):
            result[name] = _with_defaults(value, default)
    return result
