"""Messages read ahead from a stream, for the loop of pygls.

That loop asks for lines, each by a thread, and knows headers of one spelling. Here one thread reads whole messages: header
fields as HTTP has them, whatever the case of their names, in any order, unknown ones too. The loop gets them as it likes them.
"""

import asyncio
import threading
from collections.abc import Callable
from typing import BinaryIO, Final

__all__ = ["MessageReader"]

_LONGEST_HEADER: Final = 65_536
_LARGEST: Final = 1 << 30
_ENCODINGS: Final = frozenset({"", "utf-8", "utf8"})
_NO_JSON: Final = b" "
"""Handed on instead of a message that cannot be read: the loop refuses it as it refuses all that is not JSON."""


class MessageReader:
    """Reads messages; ``notice`` is called in the reading thread with each, before its turn comes.

    ``idle`` is set while the event loop waits for messages. To be made in the event loop.
    """

    def __init__(self, stream: BinaryIO, notice: Callable[[bytes], None], idle: threading.Event) -> None:
        self._stream = stream
        self._notice = notice
        self._idle = idle
        self._loop = asyncio.get_running_loop()
        self._messages: asyncio.Queue[bytes | None] = asyncio.Queue()
        self._body: bytes | None = None
        threading.Thread(target=self._read, name="reader", daemon=True).start()

    # What the loop of pygls asks for

    async def readline(self) -> bytes:
        """Return a line of the next header; empty at the end of the stream."""
        if self._body is not None:
            return b"\r\n"
        if self._messages.empty():
            self._idle.set()
        self._body = await self._messages.get()
        self._idle.clear()
        return b"" if self._body is None else b"Content-Length: %d\r\n" % len(self._body)

    async def readexactly(self, _count: int) -> bytes:
        """Return the message after the header."""
        body, self._body = self._body, None
        return body or _NO_JSON

    # The reading thread

    def _read(self) -> None:
        body: bytes | None = b""
        while body is not None:
            try:
                body = _message(self._stream)
            except (OSError, ValueError):
                body = None
            if body is not None:
                self._notice(body)
            self._idle.clear()
            try:
                self._loop.call_soon_threadsafe(self._messages.put_nowait, body)
            except RuntimeError:
                return  # The conversation has ended.


def _message(stream: BinaryIO) -> bytes | None:
    """Return the next message; ``None`` at the end of the stream."""
    fields: dict[str, str] = {}
    while True:
        line = stream.readline(_LONGEST_HEADER)
        if not line:
            return None
        if line.strip():
            name, colon, value = line.decode("latin-1").partition(":")
            if colon:
                fields[name.strip().lower()] = value.strip()
        elif fields:  # Otherwise it is an empty line too much between messages.
            break
    length = fields.get("content-length", "")
    if not (length.isascii() and length.isdigit()) or int(length) > _LARGEST:
        return _NO_JSON
    body = _exactly(stream, int(length))
    charset = fields.get("content-type", "").lower().partition("charset=")[2].split(";")[0].strip(' "')
    return body if body is None or charset in _ENCODINGS else _NO_JSON


def _exactly(stream: BinaryIO, length: int) -> bytes | None:
    parts = []
    while length:
        part = stream.read(length)
        if not part:
            return None
        parts.append(part)
        length -= len(part)
    return b"".join(parts) or _NO_JSON
