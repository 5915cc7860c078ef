"""Checks of arguments of the public Python interface: whole numbers within limits."""

import operator
from typing import Any

__all__ = ["check_limits", "whole_number"]


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


def check_limits(max_attempts: int | None, time_limit: float | None, lanes: int | None) -> None:
    """Raise ``ValueError`` for limits of sampling that are not positive."""
    for name, value in (("max_attempts", max_attempts), ("lanes", lanes)):
        if value is not None:
            whole_number(value, name, 1)
    if time_limit is not None and not time_limit > 0:
        raise ValueError(f"`time_limit` must be a positive number of seconds, not {time_limit!r}")
