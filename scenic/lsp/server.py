"""The language server: takes messages in their order, keeps to the protocol's life cycle, and answers every request.

What an answer says is worked out by the handlers (`scenic.lsp.handlers`). It runs none of the code of the programs that
it is shown, unless the user asks for that.
"""

import gc
import os
import sys
import threading
import traceback
from contextlib import redirect_stdout
from enum import Enum, auto
from typing import Any, BinaryIO, Final

from scenic.ide.snapshot import Cancelled
from scenic.lsp import parent, reading
from scenic.lsp.checks import Checks
from scenic.lsp.errors import ErrorCode, ProtocolError
from scenic.lsp.handlers import notification_handler, request_handler
from scenic.lsp.handlers.lifecycle import initialize
from scenic.lsp.loop import Job, Loop, Worker
from scenic.lsp.session import Deferred, Session
from scenic.lsp.wire import Message, Reader, Writer

__all__ = ["Server", "serve"]

_CANCEL: Final = "$/cancelRequest"
_CANCEL_PROGRESS: Final = "window/workDoneProgress/cancel"


class _Stage(Enum):
    """How far the conversation is."""

    NEW = auto()
    RUNNING = auto()
    SHUT_DOWN = auto()


class Server:
    """One conversation with one client."""

    def __init__(self, incoming: BinaryIO, outgoing: BinaryIO) -> None:
        self._reader = Reader(incoming)
        self._writer = Writer(outgoing)
        self._loop = Loop(self._fault)
        self._session = Session(self._loop, self._writer)
        self._session.checks = Checks(self._session)
        self._worker = Worker("requests")
        self._stage = _Stage.NEW
        self._code = 0
        self._cancelled: set[Any] = set()
        """Requests that the client has taken back before their turn came; written by the reading thread."""
        self._working: dict[Any, tuple[Job, str | None]] = {}
        """Requests that are being answered beside the loop, each with the document that it depends on."""
        self._tokens: dict[int | str, Any] = {}
        """By the token of its progress: the request."""

    def run(self) -> int:
        """Serve until the client says to exit, or goes away; returns the exit code."""
        threading.Thread(target=self._read, name="reader", daemon=True).start()
        self._loop.run()
        return self._code

    # The reading thread

    def _read(self) -> None:
        while True:
            try:
                message = self._reader.read()
            except ProtocolError as error:
                self._loop.put(lambda error=error: self._refuse(None, error))  # type: ignore[misc]
                continue
            except (OSError, ValueError):
                message = None
            if message is None:
                self._loop.put(self._gone)
                return
            if isinstance(message, dict) and message.get("method") == _CANCEL:
                name = reading.lookup(message, "params", "id")
                if isinstance(name, int | str):
                    self._cancelled.add(name)
            self._loop.put(lambda message=message: self._receive(message))  # type: ignore[misc]

    # The loop's thread

    def _gone(self) -> None:
        """The client has closed the stream."""
        self._loop.stop()

    def _receive(self, message: Message | list[Any]) -> None:
        self._session.garbage.touched()
        if isinstance(message, list):
            wrong = ProtocolError(
                ErrorCode.INVALID_REQUEST, "batches of messages are not part of the protocol"
            )
            self._refuse(None, wrong)
            return
        method, name = message.get("method"), message.get("id")
        if method is not None:
            self._session.trace.received(method, name, message.get("params"))
        is_named = isinstance(name, int | str) and not isinstance(name, bool)
        if message.get("jsonrpc") != "2.0" or ("method" in message and not isinstance(method, str)):
            wrong = ProtocolError(ErrorCode.INVALID_REQUEST, "this is no message of JSON-RPC 2.0")
            self._refuse(name if is_named else None, wrong)
        elif isinstance(method, str) and "id" in message:
            if is_named:
                self._request(name, method, message.get("params"))
            else:
                wrong = ProtocolError(
                    ErrorCode.INVALID_REQUEST, "the id of a request is an integer or a string"
                )
                self._refuse(None, wrong)
        elif isinstance(method, str):
            self._notification(method, message.get("params"))
        elif "result" in message or "error" in message:
            self._session.answered(name, message.get("result"))
        else:
            wrong = ProtocolError(ErrorCode.INVALID_REQUEST, "a message has a method, a result or an error")
            self._refuse(name if is_named else None, wrong)

    def _request(self, name: Any, method: str, params: Any) -> None:
        try:
            if name in self._cancelled:
                raise ProtocolError(ErrorCode.REQUEST_CANCELLED, "the request was cancelled")
            result = self._result(method, params)
        except ProtocolError as error:
            self._refuse(name, error)
        except Exception as error:  # noqa: BLE001 - a request is answered whatever happens
            self._refuse(name, self._internal(method, error))
        else:
            if isinstance(result, Deferred):
                self._begin(name, method, reading.lookup(params, "workDoneToken"), result)
            else:
                self._answer(name, result)
        self._cancelled.discard(name)

    def _result(self, method: str, params: Any) -> Any:
        """What a request is answered with, by the rules of the life cycle."""
        if self._stage is _Stage.NEW:
            if method != "initialize":
                raise ProtocolError(
                    ErrorCode.SERVER_NOT_INITIALIZED, "the first request must be `initialize`"
                )
            result = initialize(self._session, params)
            self._stage = _Stage.RUNNING
            self._watch_parent(params)
            return result
        if self._stage is _Stage.SHUT_DOWN:
            raise ProtocolError(ErrorCode.INVALID_REQUEST, "the server has been shut down")
        if method == "initialize":
            raise ProtocolError(ErrorCode.INVALID_REQUEST, "the server is already initialized")
        if method == "shutdown":
            self._stage = _Stage.SHUT_DOWN
            for each in list(self._working):
                self._cancel(each)
            return None
        handler = request_handler(method)
        if handler is None:
            raise ProtocolError(ErrorCode.METHOD_NOT_FOUND, f"there is no method {method}")
        if not isinstance(params, dict):
            raise ProtocolError(ErrorCode.INVALID_PARAMS, "the parameters must be an object")
        return handler(self._session, params)

    def _notification(self, method: str, params: Any) -> None:
        if method == "exit":
            self._code = 0 if self._stage is _Stage.SHUT_DOWN else 1
            self._loop.stop()
            return
        if method == _CANCEL:
            self._cancel(reading.lookup(params, "id"))
            return
        if method == _CANCEL_PROGRESS:
            self._cancel(self._tokens.pop(reading.lookup(params, "token"), None))
            return
        if self._stage is not _Stage.RUNNING:
            return
        handler = notification_handler(method)
        if handler is None:
            return
        try:
            handler(self._session, params)
            if method == "textDocument/didChange":
                self._outdate(reading.uri_of(params))
        except ProtocolError as error:
            # A notification has no answer; the log is the only place to say it.
            self._session.log(f"{method}: {error.message}", error=True)
        except Exception as error:  # noqa: BLE001 - the server goes on
            self._session.log(f"{method}: {self._internal(method, error).message}", error=True)

    # Requests that take longer

    def _begin(self, name: Any, method: str, token: Any, deferred: Deferred) -> None:
        def work(job: Job) -> None:
            try:
                result = deferred.work(job.go_on)
            except Cancelled:
                return
            except ProtocolError as error:
                self._loop.put(lambda error=error: self._finish(name, job, error))  # type: ignore[misc]
            except Exception as error:  # noqa: BLE001 - a request is answered whatever happens
                wrong = self._internal(method, error)
                self._loop.put(lambda: self._finish(name, job, wrong))
            else:
                self._loop.put(lambda: self._finish(name, job, result))

        job = Job(work, self._loop)
        self._working[name] = (job, deferred.document)
        if isinstance(token, int | str):
            self._tokens[token] = name
        if deferred.own_thread:
            threading.Thread(target=job.run, name=method, daemon=True).start()
        else:
            self._worker.put(job)

    def _finish(self, name: Any, job: Job, result: Any) -> None:
        found = self._working.get(name)
        if found is None or found[0] is not job:
            return  # It has been answered already: it was cancelled.
        del self._working[name]
        if isinstance(result, ProtocolError):
            self._refuse(name, result)
        else:
            self._answer(name, result)

    def _cancel(self, name: Any) -> None:
        self._cancelled.discard(name)
        found = self._working.pop(name, None)
        if found is not None:
            found[0].cancel()
            self._refuse(name, ProtocolError(ErrorCode.REQUEST_CANCELLED, "the request was cancelled"))

    def _outdate(self, uri: str) -> None:
        """Give up what is being worked out for a version of a document that is no longer there."""
        for name, (job, document) in list(self._working.items()):
            if document == uri:
                del self._working[name]
                job.cancel()
                again = ProtocolError(
                    ErrorCode.SERVER_CANCELLED, "the document has changed", {"retriggerRequest": True}
                )
                self._refuse(name, again)

    # Answers

    def _answer(self, name: Any, result: Any) -> None:
        try:
            self._writer.write({"jsonrpc": "2.0", "id": name, "result": result})
        except (RecursionError, ValueError) as error:
            self._refuse(name, self._internal("an answer", error))
        else:
            self._session.trace.answered(name, result)

    def _refuse(self, name: Any, error: ProtocolError) -> None:
        self._writer.write({"jsonrpc": "2.0", "id": name, "error": error.as_json()})
        self._session.trace.answered(name, error.as_json())

    def _internal(self, method: str, error: Exception) -> ProtocolError:
        sys.stderr.write("".join(traceback.format_exception(error)[-12:]))
        return ProtocolError(
            ErrorCode.INTERNAL_ERROR,
            f"internal error in {method}: {type(error).__name__}: {error}; "
            "this is a fault of scenic, please report it",
        )

    def _fault(self, error: Exception) -> None:
        """Log a fault that no request is answered with."""
        self._session.log(self._internal("the server", error).message, error=True)

    def _watch_parent(self, params: Any) -> None:
        process = reading.lookup(params, "processId")
        if isinstance(process, int) and not isinstance(process, bool):
            parent.watch(process, lambda: self._loop.put(self._abandoned))

    def _abandoned(self) -> None:
        """The process that started us has gone without a word."""
        self._code = 0 if self._stage is _Stage.SHUT_DOWN else 1
        self._loop.stop()


def serve() -> int:
    """Serve one client over standard input and output until it says to exit, or goes away; returns the exit code."""
    # A request does not wait long for a check that runs beside it.
    sys.setswitchinterval(0.001)
    # What is kept of documents is large, lives long and has few cycles: see `Garbage`.
    gc.freeze()
    gc.disable()
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as output, redirect_stdout(sys.stderr):
        # Whatever else is printed must not get between the messages.
        code = Server(sys.stdin.buffer, output).run()
        output.flush()
        sys.stderr.flush()
        # The thread that reads may still wait for the client, and the interpreter would wait for it.
        os._exit(code)
