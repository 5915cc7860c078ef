"""The commands that run a program. Only the user can give them, and only where the user trusts the programs."""

import threading
from collections.abc import Callable
from typing import Any, Final

from scenic.ide.running import RunError, sample_page, simulation_page
from scenic.lsp import reading
from scenic.lsp.capabilities import SAMPLE, SIMULATE
from scenic.lsp.convert import Json
from scenic.lsp.documents import Document
from scenic.lsp.errors import ErrorCode, ProtocolError
from scenic.lsp.progress import Progress
from scenic.lsp.session import Deferred, Session

__all__ = ["REQUESTS"]

_RUN: Final = "Run it"
_INTERVAL: Final = 0.1
_REFUSED: Final = (
    "programs are not run in a workspace that is not trusted: start the server with the initialization option "
    "`trusted: true` if you trust what is in it"
)


def _execute(session: Session, params: Any) -> Deferred:
    command = reading.text(params, "command")
    if command not in (SAMPLE, SIMULATE):
        raise ProtocolError(ErrorCode.INVALID_PARAMS, f"there is no command {command}")
    first = reading.lookup(params, "arguments", 0)
    uri = first if isinstance(first, str) else reading.text(first, "uri")
    options = reading.lookup(params, "arguments", 1)
    document = session.document(uri)
    simulates = command == SIMULATE
    if simulates and not document.is_saved():
        raise ProtocolError(ErrorCode.REQUEST_FAILED, "save the program first: its file is what is simulated")
    title = "Simulating" if simulates else "Sampling a scene"
    progress = Progress(session, reading.lookup(params, "workDoneToken"), title)
    allowed = _permission(session, document)

    def work(go_on: Callable[[], None]) -> Json:
        allowed(go_on)
        name, seed = reading.lookup(options, "scenario"), reading.lookup(options, "seed")
        scenario = name if isinstance(name, str) else None
        seed = seed if isinstance(seed, int) else 0
        snapshot = document.snapshot
        with progress:
            try:
                if simulates:
                    return simulation_page(snapshot.filename, scenario=scenario, seed=seed, go_on=go_on)
                return sample_page(
                    snapshot.text, snapshot.filename, scenario=scenario, seed=seed, go_on=go_on
                )
            except RunError as error:
                raise ProtocolError(ErrorCode.REQUEST_FAILED, str(error)) from None

    return Deferred(work, own_thread=True)


def _permission(session: Session, document: Document) -> Callable[[Callable[[], None]], None]:
    """A function that returns when the program may be run, and raises if it may not."""
    if session.trusted is None and session.client.has("window", "showMessage"):
        # The client does not know of trust, but the user can be asked.
        answered = threading.Event()
        choice: list[Json] = []

        def answer(result: Json) -> None:
            choice.append(reading.lookup(result, "title"))
            answered.set()

        name = document.snapshot.filename.rpartition("/")[2]
        question = f"{name} and the modules that it imports may do anything that you can do. Run it?"
        actions = [{"title": _RUN}, {"title": "Cancel"}]
        session.ask("window/showMessageRequest", {"type": 2, "message": question, "actions": actions}, answer)

        def wait(go_on: Callable[[], None]) -> None:
            while not answered.wait(_INTERVAL):
                go_on()
            if choice != [_RUN]:
                raise ProtocolError(ErrorCode.REQUEST_FAILED, _REFUSED)

        return wait
    if not session.trusted:
        raise ProtocolError(ErrorCode.REQUEST_FAILED, _REFUSED)
    return lambda _go_on: None


REQUESTS: Final = {"workspace/executeCommand": _execute}
