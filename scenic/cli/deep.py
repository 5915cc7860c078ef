"""Calls of library functions that recurse into trees, which may be nested more deeply than Python allows for."""

from collections.abc import Callable

from scenic.language.errors import ScenicError

__all__ = ["call_deep"]


def call_deep(function: Callable[[], str], filename: str) -> str:
    """The result of ``function``; raises `ScenicError` with code SC112 if it recurses too deeply."""
    try:
        return function()
    except RecursionError:
        raise ScenicError(
            "the program is nested too deeply to be shown",
            code="SC112",
            filename=filename,
            help="split the longest expressions and the deepest blocks",
        ) from None
