"""The protocol of pygls, held to the life cycle that the specification prescribes.

pygls reads, dispatches, cancels and writes. What it leaves open is closed here: what is no message, comes too early or too late,
or has wrong parameters is answered with the right error; work that has begun can be cancelled; what cannot be sent is an error,
too. `docs/pygls.patch` is what we propose to change in pygls itself.
"""

import asyncio
import inspect
import json
import sys
import threading
import time
import traceback
from collections.abc import Callable, Generator
from concurrent.futures import Future
from enum import Enum, auto
from typing import Any, Final

from cattrs import Converter, transform_error
from lsprotocol import types
from pygls.exceptions import (
    JsonRpcException,
    JsonRpcInternalError,
    JsonRpcInvalidParams,
    JsonRpcInvalidRequest,
    JsonRpcParseError,
    JsonRpcRequestCancelled,
    JsonRpcServerNotInitialized,
)
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol, lsp_method

from scenic.lsp.capabilities import COMMANDS
from scenic.lsp.liberal import completed

__all__ = ["Protocol", "Stage", "fault"]

_OURS: Final = (
    types.TEXT_DOCUMENT_DID_OPEN,
    types.TEXT_DOCUMENT_DID_CHANGE,
    types.TEXT_DOCUMENT_DID_CLOSE,
    types.NOTEBOOK_DOCUMENT_DID_OPEN,
    types.NOTEBOOK_DOCUMENT_DID_CHANGE,
    types.NOTEBOOK_DOCUMENT_DID_CLOSE,
    types.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS,
    types.WORKSPACE_EXECUTE_COMMAND,
)
"""Messages that this server handles instead of pygls, whose documents count lines by `str.splitlines`, which
takes form feeds for line ends."""


def _strictly(value: Any, kind: Any) -> Any:
    """Return a plain value, or a member of an enumeration of such, as a message has it."""
    if issubclass(kind, Enum):
        return kind(value)
    if kind is int and isinstance(value, float) and value.is_integer():
        return int(value)  # Some clients write whole numbers as `1.0`.
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise ValueError(f"expected a value of type {kind.__name__}, not {value!r}")
    return value


class Stage(Enum):
    """The stages of a conversation."""

    NEW = auto()
    RUNNING = auto()
    SHUT_DOWN = auto()


class Protocol(LanguageServerProtocol):
    """One conversation with one client."""

    def __init__(self, server: LanguageServer, converter: Converter) -> None:
        super().__init__(server, converter)
        for kind in (int, str, bool):
            # By itself the converter makes a text of any value, and 1 of 1.5.
            converter.register_structure_hook(kind, _strictly)
        self.stage = Stage.NEW
        self.loop: asyncio.AbstractEventLoop | None = None
        self.exited: Callable[[], None] = lambda: None
        """Called when the client sends ``exit``."""
        self.touched: Callable[[], None] = lambda: None
        """Called when a message comes."""
        self.log: Callable[[str], None] = lambda _message: None
        """Called with what goes wrong where no request is answered with it."""
        self._thread = 0
        self._cancelled: set[Any] = set()
        """Requests that the client has taken back before their turn came; written by the reading thread."""
        self._sending: set[asyncio.Future[None]] = set()
        self._asked: dict[Any, tuple[str, float]] = {}
        """By the id of a request: its method, and when it came."""

    def _register_builtin_features(self) -> None:
        super()._register_builtin_features()  # type: ignore[no-untyped-call]
        for method in _OURS:
            self.fm.builtin_features.pop(method, None)

    def foresee(self, body: bytes) -> None:
        """Look at a message before its turn comes; from any thread."""
        if b"$/cancelRequest" in body:
            try:
                message = json.loads(body)
                if message["method"] == types.CANCEL_REQUEST:
                    self._cancelled.add(message["params"]["id"])
            except (ValueError, RecursionError, LookupError, TypeError):
                return

    # Messages

    def structure_message(self, data: dict[str, Any]) -> Any:
        """Leave messages as they are: they are typed in `handle_message`, where an error can name the request."""
        return data

    def unreadable(self, error: Exception) -> None:
        """Answer a message that is not JSON."""
        wrong = JsonRpcParseError(f"the message cannot be read: {error}")
        self._send_response(None, error=wrong.to_response_error())

    def handle_message(self, message: object) -> None:
        """Answer a request, take note of a notification, hand on an answer; refuse what is none of these."""
        if self.loop is None:
            self.loop, self._thread = asyncio.get_running_loop(), threading.get_ident()
            self.loop.set_exception_handler(self._failed)
        self.touched()
        fields = message if isinstance(message, dict) else {}
        name, method = fields.get("id"), fields.get("method")
        is_named = isinstance(name, int | str) and not isinstance(name, bool)
        if fields.get("jsonrpc") != "2.0" or ("method" in fields and not isinstance(method, str)):
            self._refuse(name if is_named else None, "this is no message of JSON-RPC 2.0")
        elif method is not None and "id" in fields:
            if is_named:
                self._request(name, method, fields.get("params"))
            else:
                self._refuse(None, "the id of a request is an integer or a string")
        elif method is not None:
            self._notification(method, fields.get("params"))
        elif "result" in fields or "error" in fields:
            self._answered(name, fields)
        else:
            self._refuse(name if is_named else None, "a message has a method, a result or an error")

    def _request(self, name: Any, method: str, params: object) -> None:
        self._asked[name] = (method, time.monotonic())
        self._trace(f"received request {method} ({name})", params)
        try:
            if name in self._cancelled:
                raise JsonRpcRequestCancelled("the request was cancelled")
            self._check(method)
            message = self._typed(method, params)
        except JsonRpcException as error:
            self._send_response(name, error=error.to_response_error())
        else:
            self._handle_request(name, method, message)
        self._cancelled.discard(name)

    def _check(self, method: str) -> None:
        """Raise if it is not the time for a request."""
        if self.stage is Stage.SHUT_DOWN:
            raise JsonRpcInvalidRequest("the server has been shut down")
        if self.stage is Stage.NEW and method != types.INITIALIZE:
            raise JsonRpcServerNotInitialized("the first request must be `initialize`")
        if self.stage is Stage.RUNNING and method == types.INITIALIZE:
            raise JsonRpcInvalidRequest("the server is already initialized")
        self._get_handler(method)
        if method in types.METHOD_TO_TYPES and not _is_request(method):
            raise JsonRpcInvalidRequest(f"`{method}` is a notification, and has no answer")

    def _notification(self, method: str, params: object) -> None:
        self._trace(f"received notification {method}", params)
        if method == types.EXIT:
            self.exited()
        elif self.stage is Stage.RUNNING and _is_request(method):
            self.log(f"{method} was sent without an id, so it cannot be answered")
        elif self.stage is Stage.RUNNING:
            try:
                message = self._typed(method, params)
            except JsonRpcException as error:
                # A notification has no answer; the log is the only place to say it.
                self.log(f"{method}: {error.message}")
            else:
                if method == types.CANCEL_REQUEST:
                    self._cancelled.discard(message.id)
                self._handle_notification(method, message)

    def _answered(self, name: Any, fields: dict[str, Any]) -> None:
        self._result_types.pop(name, None)
        wrong = fields.get("error")
        if wrong is None:
            self._handle_response(name, fields.get("result"))
        else:
            self._handle_response(name, None, types.ResponseError(0, str(wrong)))

    def _typed(self, method: str, params: object) -> Any:
        """Convert parameters to the protocol's types."""
        kind: Any = types.METHOD_TO_TYPES.get(method, (None, None, None))[2]
        if kind is None:
            return params
        try:
            return self._converter.structure(completed(method, params), kind)
        except Exception as error:  # noqa: BLE001 - converters raise what they like
            reason = "; ".join(transform_error(error, path="params"))
            raise JsonRpcInvalidParams(f"wrong parameters: {reason}") from None

    # Handlers

    @lsp_method(types.INITIALIZE)
    def lsp_initialize(self, params: types.InitializeParams) -> Generator[Any, Any, types.InitializeResult]:
        """Say what the server can do for this client."""
        result = yield from super().lsp_initialize(params)
        self.trace = params.trace or types.TraceValue.Off
        self.stage = Stage.RUNNING
        result.capabilities.execute_command_provider = types.ExecuteCommandOptions(
            list(COMMANDS), work_done_progress=True
        )
        return result

    @lsp_method(types.SHUTDOWN)
    def lsp_shutdown(self, *_args: Any) -> Generator[Any, Any, None]:
        """Give up what is under way, and do nothing from now on."""
        yield from ()
        self.stage = Stage.SHUT_DOWN
        for name, future in list(self._request_futures.items()):
            if name != self.msg_id:
                future.cancel()

    def _execute_handler(
        self,
        msg_id: Any,
        handler: Callable[..., Any],
        callback: Callable[[Future[Any]], None],
        args: tuple[Any, ...] | None = None,
        kwargs: dict[str, Any] | None = None,
    ) -> None:
        """Call a handler at once; one that returns a future has its answer worked out beside the loop."""
        if inspect.isgeneratorfunction(handler):
            super()._execute_handler(msg_id, handler, callback, args, kwargs)
            return
        future: Future[Any] = Future()
        try:
            result = handler(*(args or ()), **(kwargs or {}))
        except Exception as error:  # noqa: BLE001 - a request is answered whatever happens
            future.set_exception(error)
        else:
            if isinstance(result, Future):
                future = self._request_futures[msg_id] = result
            else:
                future.set_result(result)
        future.add_done_callback(callback)

    def _send_handler_result(self, future: Future[Any], *, msg_id: Any) -> None:
        self._request_futures.pop(msg_id, None)
        error = (
            JsonRpcRequestCancelled("the request was cancelled") if future.cancelled() else future.exception()
        )
        if error is None:
            self._send_response(msg_id, future.result())
            return
        if not isinstance(error, JsonRpcException):
            error = fault(self._asked.get(msg_id, ("a request", 0.0))[0], error)
        self._send_response(msg_id, error=error.to_response_error())

    # Answers

    def _refuse(self, name: object, message: str) -> None:
        self._send_response(name, error=JsonRpcInvalidRequest(message).to_response_error())

    def _send_response(
        self, msg_id: Any, result: Any = None, error: types.ResponseError | None = None
    ) -> None:
        if msg_id is None:
            # The types of the protocol would leave the id out.
            self._send_data({"jsonrpc": "2.0", "id": None, "error": error})
            return
        super()._send_response(msg_id, result, error)
        method, start_time = self._asked.pop(msg_id, (None, 0.0))
        if method is not None:
            milliseconds = round(1000 * (time.monotonic() - start_time))
            self._trace(
                f"answered request {method} ({msg_id}) after {milliseconds} ms",
                result if error is None else error,
            )

    def _send_data(self, data: Any) -> None:
        """Send a message, from any thread. If the client is gone, nothing is raised; the reader notices it."""
        try:
            # Escapes for what is not ASCII also carry lone surrogates, which programs may hold.
            body = json.dumps(data, default=self._serialize_message, separators=(",", ":"))
        except (RecursionError, ValueError, TypeError) as error:
            wrong = fault("an answer", error)
            if hasattr(data, "method"):
                self.log(wrong.message)
            else:
                self._send_response(data.id, error=wrong.to_response_error())
            return
        if self.loop is None or threading.get_ident() == self._thread:
            self._write(body)
        else:
            self.loop.call_soon_threadsafe(self._write, body)

    def _write(self, body: str) -> None:
        header = f"Content-Length: {len(body)}\r\n\r\n" if self._include_headers else ""
        try:
            assert self.writer is not None
            writing = self.writer.write((header + body).encode("ascii"))
        except (OSError, ValueError):
            return
        if inspect.isawaitable(writing):
            sending = asyncio.ensure_future(writing)
            self._sending.add(sending)
            sending.add_done_callback(self._sending.discard)

    def _trace(self, message: str, content: object) -> None:
        """Tell a client that wants to follow the conversation."""
        if self.trace is types.TraceValue.Off:
            return
        verbose = None
        if self.trace is types.TraceValue.Verbose:
            verbose = json.dumps(content, default=self._serialize_message)
        self.notify(types.LOG_TRACE, types.LogTraceParams(message, verbose))

    def _failed(self, _loop: object, context: dict[str, Any]) -> None:
        """Log what a timer has raised."""
        error = context.get("exception")
        self.log(fault("the server", error).message if isinstance(error, Exception) else context["message"])


def _is_request(method: str) -> bool:
    return types.METHOD_TO_TYPES.get(method, (None, None))[1] is not None


def fault(what: str, error: BaseException) -> JsonRpcInternalError:
    """The answer when a handler fails; the place of the fault goes to the error stream."""
    sys.stderr.write("".join(traceback.format_exception(error)[-12:]))
    return JsonRpcInternalError(
        f"internal error in {what}: {type(error).__name__}: {error}; "
        "this is a fault of scenic, please report it"
    )
