"""Checks of arguments of the public Python interface: whole numbers within limits."""

import operator
from typing import Any

__all__ = ["whole_number"]


def whole_number(value: Any, name: str, least: int | None = None) -> int:
    """The integer that an argument is, also one of NumPy.

    Raises:
        ValueError: if it is not an integer, or less than ``least``; the message names the argument and says what is allowed.

    """
    try:
        number = operator.index(value)
    except TypeError:
        raise ValueError(f"`{name}` must be {_words(least)}, not {value!r}") from None
    if isinstance(value, bool) or (least is not None and number < least):
        raise ValueError(f"`{name}` must be {_words(least)}, not {value!r}")
    return number


def _words(least: int | None) -> str:
    return "an integer" if least is None else f"an integer of at least {least}"
