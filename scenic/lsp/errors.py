"""The protocol's errors, each with the code that clients know it by."""

from enum import IntEnum
from typing import Any

__all__ = ["ErrorCode", "ProtocolError"]


class ErrorCode(IntEnum):
    """The codes of JSON-RPC and of the language server protocol."""

    PARSE_ERROR = -32700
    INVALID_REQUEST = -32600
    METHOD_NOT_FOUND = -32601
    INVALID_PARAMS = -32602
    INTERNAL_ERROR = -32603
    SERVER_NOT_INITIALIZED = -32002
    REQUEST_FAILED = -32803
    SERVER_CANCELLED = -32802
    CONTENT_MODIFIED = -32801
    REQUEST_CANCELLED = -32800


class ProtocolError(Exception):
    """An answer that says why there is no other; ``data`` is what the protocol adds for some codes."""

    def __init__(self, code: ErrorCode, message: str, data: Any = None) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.data = data

    def as_json(self) -> dict[str, Any]:
        """The ``error`` of a response."""
        found: dict[str, Any] = {"code": int(self.code), "message": self.message}
        if self.data is not None:
            found["data"] = self.data
        return found
