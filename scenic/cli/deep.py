"""Calls of library functions that recurse into trees, which may be nested more deeply than Python allows for."""

from collections.abc import Callable

from scenic.compiler.parser import recursion_limit
from scenic.language.errors import ScenicError

__all__ = ["call_deep"]


def call_deep(function: Callable[[], str], filename: str, *, frames: int) -> str:
    """The result of ``function``, which may recurse by a number of frames.

    Raises `ScenicError` with code SC112 if that is not enough.
    """
    try:
        with recursion_limit(frames):
            return function()
    except RecursionError:
        raise ScenicError(
            "the program is nested too deeply to be shown",
            code="SC112",
            filename=filename,
            help="split the longest expressions and the deepest blocks",
        ) from None
