"""File names and the addresses that editors have for them."""

import os
import re
import sys
from typing import Final
from urllib.parse import quote, unquote, urlsplit

__all__ = ["to_path", "to_uri"]

_DRIVE: Final = re.compile(r"/?([A-Za-z]):(?=/|$)")
_KEPT: Final = "/:-._~"


def to_path(uri: str) -> str | None:
    """The name of the file that an address means; ``None`` if it means none (a text that was never saved)."""
    try:
        parts = urlsplit(uri)
    except ValueError:
        return None
    if parts.scheme != "file":
        return None
    path = unquote(
        uri.partition(":")[2].removeprefix("//" + parts.netloc).partition("#")[0].partition("?")[0]
    )
    if "\0" in path or not path:
        return None
    if sys.platform == "win32":
        drive = _DRIVE.match(path)
        if drive is not None:
            path = drive[1].lower() + path[drive.end() - 1 :]
        elif parts.netloc:
            path = f"//{parts.netloc}{path}"
        path = path.replace("/", os.sep)
    return os.path.abspath(path) if os.path.isabs(path) else None


def to_uri(path: str) -> str:
    """The address of a file, with its absolute name."""
    path = os.path.abspath(path).replace(os.sep, "/")
    if not path.startswith("/"):
        path = "/" + path
    return "file://" + quote(
        path.encode("utf-8", "surrogateescape"), safe=_KEPT if sys.platform == "win32" else "/-._~"
    )
