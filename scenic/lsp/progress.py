"""Telling the client how far something is that takes long."""

from collections.abc import Callable
from types import TracebackType
from typing import Any, Generic, Self, TypeVar

from lsprotocol import types

from scenic.lsp.session import Session

__all__ = ["Partial", "Progress"]

_T = TypeVar("_T")


class Partial(Generic[_T]):
    """Sends parts of an answer as soon as they are known, to a client that gave a ``token`` for that.

    What has been sent so must not be in the answer again: `rest` is what still belongs there.
    """

    def __init__(self, session: Session, token: types.ProgressToken | None) -> None:
        self._session = session
        self._token = token
        self.rest: list[_T] = []

    def add(self, items: list[_T], wrap: Callable[[list[_T]], Any] = lambda items: items) -> None:
        """Some more of the answer; ``wrap`` makes of a list what is sent."""
        if self._token is None:
            self.rest += items
        elif items:
            self._session.notify(types.PROGRESS, types.ProgressParams(self._token, wrap(items)))


class Progress:
    """Progress of one piece of work, reported to a client that gave a ``token`` for it; without one, nothing."""

    def __init__(self, session: Session, token: types.ProgressToken | None, title: str) -> None:
        self._session = session
        self._token = token
        self._title = title
        self._shown = -1

    def __enter__(self) -> Self:
        self._tell(types.WorkDoneProgressBegin(self._title, cancellable=True, percentage=0))
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        self._tell(types.WorkDoneProgressEnd())

    def report(self, done: int, count: int) -> None:
        """``done`` of ``count`` things are done."""
        percentage = 100 * done // max(count, 1)
        if percentage != self._shown:
            self._shown = percentage
            self._tell(types.WorkDoneProgressReport(message=f"{done} of {count}", percentage=percentage))

    def _tell(self, value: object) -> None:
        if self._token is not None:
            self._session.notify(types.PROGRESS, types.ProgressParams(self._token, value))
