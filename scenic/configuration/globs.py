"""Patterns of file names, as in ``exclude`` and ``per-file-ignores``."""

import re
from collections.abc import Sequence
from functools import cache
from typing import Final

__all__ = ["matches"]

_PIECE: Final = r"(?:^|(?<=/))\*\*/|\*\*|\*|\?|\[!?+\]?+[^\]/]*\]|."
_BECOMES: Final = {"**/": "(?:.*/)?", "**": ".*", "*": "[^/]*", "?": "[^/]"}


def matches(parts: Sequence[str], pattern: str) -> bool:
    """Return whether a pattern stands for a path, given by its parts, or for a folder above it.

    A pattern without a slash may stand for any part, another one begins with the first. ``*`` and ``?`` stop at
    slashes, ``**`` does not, and ``[...]`` is one of several characters.
    """
    expression = _expression(pattern.strip("/"))
    if "/" not in pattern.rstrip("/"):
        return any(expression.fullmatch(part) for part in parts)
    return any(expression.fullmatch("/".join(parts[:count])) for count in range(1, len(parts) + 1))


@cache
def _expression(pattern: str) -> re.Pattern[str]:
    try:
        return re.compile(
            "".join(_BECOMES.get(each) or _piece(each) for each in re.findall(_PIECE, pattern, re.DOTALL)),
            re.DOTALL,
        )
    except re.error:  # a set that is none, such as [z-a]
        return re.compile(re.escape(pattern))


def _piece(piece: str) -> str:
    if len(piece) < 3 or piece[0] != "[":
        return re.escape(piece)
    negated = piece[1] == "!"
    # Characters that mean something in a set of a regular expression, but not in ours; a range stays one.
    members = re.sub(r"(.)-(.)|(.)", _members, piece[1 + negated : -1], flags=re.DOTALL)
    return f"[{'^/' if negated else ''}{members}]"


def _members(found: re.Match[str]) -> str:
    return "-".join(re.escape(each) for each in found.groups() if each is not None)
