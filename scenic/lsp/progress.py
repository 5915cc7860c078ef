"""Telling the client how far something is that takes long."""

from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

from scenic.lsp.session import Session

__all__ = ["Partial", "Progress"]


class Partial:
    """Sends parts of an answer as soon as they are known, to a client that gave a ``token`` for that.

    What has been sent so must not be in the answer again: `rest` is what still belongs there.
    """

    def __init__(self, session: Session, token: Any) -> None:
        self._session = session
        self._token = token if isinstance(token, int | str) and not isinstance(token, bool) else None
        self.rest: list[Any] = []

    def add(self, items: list[Any], wrap: Callable[[list[Any]], Any] = lambda items: items) -> None:
        """Some more of the answer; ``wrap`` makes of a list what is sent."""
        if self._token is None:
            self.rest += items
        elif items:
            self._session.notify("$/progress", {"token": self._token, "value": wrap(items)})


class Progress:
    """What is told of one piece of work, to a client that gave a ``token`` for that; without one, nothing."""

    def __init__(self, session: Session, token: Any, title: str) -> None:
        self._session = session
        self._token = token if isinstance(token, int | str) and not isinstance(token, bool) else None
        self._title = title
        self._shown = -1

    def __enter__(self) -> Self:
        self._tell({"kind": "begin", "title": self._title, "percentage": 0, "cancellable": True})
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        self._tell({"kind": "end"})

    def report(self, done: int, count: int) -> None:
        """``done`` of ``count`` things are done."""
        percentage = 100 * done // max(count, 1)
        if percentage != self._shown:
            self._shown = percentage
            self._tell({"kind": "report", "percentage": percentage, "message": f"{done} of {count}"})

    def _tell(self, value: Any) -> None:
        if self._token is not None:
            self._session.notify("$/progress", {"token": self._token, "value": value})
