"""Members of tar files, made one by one: shards of data sets are their concatenation, closed by `END`.

A member's bytes depend on its name and content alone: it has no time and no owner.
"""

import io
import tarfile
from collections.abc import Iterator
from typing import Final

__all__ = ["END", "member", "members"]

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
