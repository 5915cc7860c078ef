"""Messages on a stream: a header that gives the length of what follows, and JSON.

Header fields are read as HTTP's are: whatever the case of their names, in any order, unknown ones too.
"""

import json
import threading
from typing import Any, BinaryIO, Final, TypeAlias

from scenic.lsp.errors import ErrorCode, ProtocolError

__all__ = ["Message", "Reader", "Writer"]

Message: TypeAlias = dict[str, Any]

_LONGEST_HEADER: Final = 65_536
_LARGEST: Final = 1 << 30
_ENCODINGS: Final = frozenset({"utf-8", "utf8"})


class Reader:
    """Reads messages, one after the other."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream

    def read(self) -> Message | list[Any] | None:
        """The next message, or ``None`` at the end of the stream.

        Raises `ProtocolError` for what is no message; the stream then stands after it.
        """
        fields = self._header()
        if fields is None:
            return None
        length = fields.get("content-length", "")
        if not (length.isascii() and length.isdigit()) or int(length) > _LARGEST:
            raise ProtocolError(ErrorCode.PARSE_ERROR, "the header has no valid Content-Length")
        body = self._exactly(int(length))
        if body is None:
            return None
        charset = fields.get("content-type", "").lower().partition("charset=")[2].split(";")[0].strip(' "')
        if charset and charset not in _ENCODINGS:
            raise ProtocolError(ErrorCode.PARSE_ERROR, f"the charset {charset!r} is not supported: use utf-8")
        try:
            message = json.loads(body)
        except (ValueError, RecursionError) as error:
            raise ProtocolError(ErrorCode.PARSE_ERROR, f"the message is not JSON: {error}") from None
        if not isinstance(message, dict | list):
            raise ProtocolError(ErrorCode.INVALID_REQUEST, "a message must be an object")
        return message

    def _header(self) -> dict[str, str] | None:
        fields: dict[str, str] = {}
        while True:
            line = self._stream.readline(_LONGEST_HEADER)
            if not line:
                return None
            if not line.strip():
                if fields:
                    return fields
                continue  # an empty line too much between messages
            name, colon, value = line.decode("latin-1").partition(":")
            if colon:
                fields[name.strip().lower()] = value.strip()

    def _exactly(self, length: int) -> bytes | None:
        parts = []
        while length:
            part = self._stream.read(length)
            if not part:
                return None
            parts.append(part)
            length -= len(part)
        return b"".join(parts)


class Writer:
    """Writes messages whole, from any thread."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._lock = threading.Lock()

    def write(self, message: Message) -> None:
        """Send a message; one that nobody reads any more is dropped."""
        # Escapes for what is not ASCII also carry lone surrogates, which programs may hold.
        body = json.dumps(message, separators=(",", ":")).encode("ascii")
        with self._lock:
            try:
                self._stream.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
                self._stream.flush()
            except (OSError, ValueError):
                return  # The client has gone; the reader notices.
