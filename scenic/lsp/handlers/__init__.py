"""What the server does for each method of the protocol: one module for each theme.

A handler converts what the client sent, calls one function of `scenic.ide`, and converts what that returns.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from scenic.lsp.convert import Json
from scenic.lsp.handlers import (
    diagnostics,
    editing,
    hints,
    information,
    lifecycle,
    navigation,
    running,
    structure,
    synchronization,
    workspace,
)
from scenic.lsp.session import Deferred, Session

__all__ = ["NOTIFICATIONS", "REQUESTS", "Notified", "Requested"]

Requested: TypeAlias = Callable[[Session, Any], Json | Deferred]
Notified: TypeAlias = Callable[[Session, Any], None]

REQUESTS: Final[Mapping[str, Requested]] = MappingProxyType(
    {
        **diagnostics.REQUESTS,
        **editing.REQUESTS,
        **hints.REQUESTS,
        **information.REQUESTS,
        **navigation.REQUESTS,
        **running.REQUESTS,
        **structure.REQUESTS,
    }
)
"""By method: what answers a request."""

NOTIFICATIONS: Final[Mapping[str, Notified]] = MappingProxyType(
    {
        **lifecycle.NOTIFICATIONS,
        **synchronization.NOTIFICATIONS,
        **workspace.NOTIFICATIONS,
    }
)
"""By method: what takes note of a notification."""
