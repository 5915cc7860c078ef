"""The commands that run a program. Only the user can give them, and only where the user trusts the programs."""

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Final

from lsprotocol import types
from pygls.exceptions import JsonRpcException, JsonRpcInvalidParams

from scenic.ide.remarks import Remarks
from scenic.ide.running import RunError, run_remarks, sample_page, simulation_page
from scenic.lsp.capabilities import COMMANDS, SAMPLE, SIMULATE
from scenic.lsp.documents import Document
from scenic.lsp.progress import Progress
from scenic.lsp.session import Session
from scenic.lsp.threads import GoOn

__all__ = ["HANDLERS"]

_RUN: Final = "Run it"
_REMARKED: Final = ("code_lens", "inlay_hint")
"""Features that show what a run says."""
_SAMPLED: Final = 9
"""Scenes of a page that shows several."""
_INTERVAL: Final = 0.1
_REFUSED: Final = (
    "programs are not run in a workspace that is not trusted: start the server with the initialization option "
    "`trusted: true` if you trust what is in it"
)
_NOT_HERE: Final = "programs are run only for a client that has started the server itself, on standard input"


def _execute(session: Session, params: types.ExecuteCommandParams) -> Future[str]:
    if params.command not in COMMANDS:
        raise JsonRpcInvalidParams(f"there is no command {params.command}")
    first, second = (*(params.arguments or ()), None, None)[:2]
    uri = first.get("uri") if isinstance(first, dict) else first
    if not isinstance(uri, str):
        raise JsonRpcInvalidParams("the first argument is the address of a document")
    options: dict[str, Any] = second if isinstance(second, dict) else {}
    document = session.document(uri)
    simulates = params.command == SIMULATE
    if simulates and not document.is_saved():
        raise _failed("save the program first: its file is what is simulated")
    title = "Simulating" if simulates else "Sampling"
    progress = Progress(session, params.work_done_token, title)
    await_permission = _permission(session, document)
    loop = asyncio.get_running_loop()
    name, seed = options.get("scenario"), options.get("seed")
    scenario = name if isinstance(name, str) else None
    seed = seed if isinstance(seed, int) else 0
    snapshot = document.snapshot
    count = _SAMPLED if params.command == SAMPLE else 1

    def work(go_on: GoOn) -> str:
        await_permission(go_on)
        try:
            with progress:
                if simulates:
                    page = simulation_page(snapshot.filename, scenario=scenario, seed=seed, go_on=go_on)
                else:
                    page = sample_page(
                        snapshot.text,
                        snapshot.filename,
                        scenario=scenario,
                        seed=seed,
                        count=count,
                        go_on=go_on,
                    )
        except RunError as error:
            if error.is_rejected:
                loop.call_soon_threadsafe(_remark, session, document, scenario)
            raise _failed(str(error)) from None
        loop.call_soon_threadsafe(_remark, session, document, scenario)
        return page

    return session.work(work, token=params.work_done_token, workers=session.runs)


def _remark(session: Session, document: Document, scenario: str | None) -> None:
    """Find out, beside the loop, what a program that has just run says about its lines; then have the client ask for it."""
    if not session.shows_remarks:
        return
    loop, snapshot = asyncio.get_running_loop(), document.snapshot

    def keep(done: Future[Remarks]) -> None:
        if document.uri in session.documents and not done.cancelled() and done.exception() is None:
            session.remarks[document.uri] = done.result()
            session.have_asked_again(*_REMARKED)

    work = session.work(
        lambda go_on: run_remarks(snapshot.text, snapshot.filename, scenario=scenario, go_on=go_on),
        document=document.uri,
        workers=session.runs,
    )
    work.add_done_callback(lambda done: loop.call_soon_threadsafe(keep, done))


def _permission(session: Session, document: Document) -> Callable[[GoOn], None]:
    """Return a function that returns when the program may be run, and raises if it may not."""
    if not session.trusting:
        raise _failed(_NOT_HERE)
    if session.trusted is None and session.has("window.show_message"):
        # The client does not know of trust, but the user can be asked.
        answer_event = threading.Event()
        name = document.snapshot.filename.rpartition("/")[2]
        question = types.ShowMessageRequestParams(
            types.MessageType.Warning,
            f"{name} and the modules that it imports may do anything that you can do. Run it?",
            [types.MessageActionItem(_RUN), types.MessageActionItem("Cancel")],
        )
        answer = session.ask(types.WINDOW_SHOW_MESSAGE_REQUEST, question)
        answer.add_done_callback(lambda _answer: answer_event.set())

        def wait(go_on: GoOn) -> None:
            while not answer_event.wait(_INTERVAL):
                go_on()
            refused = answer.cancelled() or answer.exception() is not None
            chosen = None if refused else answer.result()
            if not isinstance(chosen, dict) or chosen.get("title") != _RUN:
                raise _failed(_REFUSED)

        return wait
    if not session.trusted:
        raise _failed(_REFUSED)
    return lambda _go_on: None


def _failed(reason: str) -> JsonRpcException:
    return JsonRpcException(reason, types.LSPErrorCodes.RequestFailed)


HANDLERS: Final = {types.WORKSPACE_EXECUTE_COMMAND: _execute}
