"""Members of tar files, made one by one: shards of data sets are their concatenation, closed by `END`.

A member's bytes depend on its name and content alone: it has no time and no owner.
"""

import io
import json
import tarfile
from collections.abc import Iterator
from typing import Any, Final

import numpy as np

__all__ = ["END", "encoded_row", "member", "members", "rows_of"]

END: Final = bytes(2 * tarfile.BLOCKSIZE)
"""Two blocks of zeros end a tar file."""


def member(name: str, content: bytes) -> bytes:
    """Return a file as a member of a tar file: header and content, filled up to whole blocks."""
    info = tarfile.TarInfo(name)
    info.size = len(content)
    padding = -len(content) % tarfile.BLOCKSIZE
    return info.tobuf(tarfile.USTAR_FORMAT) + content + bytes(padding)


def members(content: bytes) -> Iterator[tuple[str, bytes]]:
    """Names and contents of the files in a tar file, or in members without an end."""
    with tarfile.open(fileobj=io.BytesIO(content + END)) as archive:
        for info in archive:
            stream = archive.extractfile(info)
            if stream is not None:
                yield info.name, stream.read()


def encoded_row(content: bytes, entry: object) -> bytes:
    """Return the row of a scene as processes send it: two lengths, members of a tar file, and its entry of an index as JSON."""
    record = json.dumps(entry, allow_nan=False).encode()
    return np.array([len(content), len(record)], dtype=np.int64).tobytes() + content + record


def rows_of(encoded: memoryview) -> Iterator[tuple[bytes, Any]]:
    """Yield the members and the entry of each of some encoded rows."""
    place = 0
    while place < len(encoded):
        size, length = (int(word) for word in np.frombuffer(encoded[place : place + 16], dtype=np.int64))
        middle = place + 16 + size
        yield bytes(encoded[place + 16 : middle]), json.loads(bytes(encoded[middle : middle + length]))
        place = middle + length
