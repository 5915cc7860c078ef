"""What the server tells a client that wants to follow the conversation: `$/logTrace`."""

import time
from json import dumps
from typing import Any, Final

from scenic.lsp.wire import Writer

__all__ = ["Trace"]

_LEVELS: Final = ("off", "messages", "verbose")


class Trace:
    """Tells which messages came and what was answered when; with ``verbose`` also what was in them.

    At first it is ``off`` and tells nothing.
    """

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._level = _LEVELS[0]
        self._begun: dict[Any, tuple[str, float]] = {}

    def set(self, level: Any) -> None:
        """Take the level that the client asks for; one that the protocol does not know changes nothing."""
        if level in _LEVELS:
            self._level = level

    def received(self, method: Any, name: Any, params: Any) -> None:
        """A request (``name`` is its id) or a notification has come."""
        if self._level == _LEVELS[0]:
            return
        if name is None:
            self._tell(f"received notification {method}", params)
        else:
            self._begun[name] = (str(method), time.monotonic())
            self._tell(f"received request {method} ({name})", params)

    def answered(self, name: Any, answer: Any) -> None:
        """A request was answered."""
        method, begun = self._begun.pop(name, (None, 0.0))
        if method is not None and self._level != _LEVELS[0]:
            spent = round(1000 * (time.monotonic() - begun))
            self._tell(f"answered request {method} ({name}) after {spent} ms", answer)

    def _tell(self, message: str, content: Any) -> None:
        params = {"message": message}
        if self._level == "verbose":
            params["verbose"] = dumps(content)
        self._writer.write({"jsonrpc": "2.0", "method": "$/logTrace", "params": params})
