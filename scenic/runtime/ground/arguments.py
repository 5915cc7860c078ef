"""Checks of arguments of the public Python interface: whole numbers within limits, seconds."""

import operator
from numbers import Real
from typing import Any

__all__ = ["check_limits", "check_seconds", "whole_number"]


def whole_number(value: Any, name: str, least: int | None = None) -> int:
    """Return the integer that an argument is, also one of NumPy.

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
    check_seconds(time_limit, "time_limit")


def check_seconds(value: object, name: str) -> None:
    """Raise ``ValueError`` for an argument that is neither a positive number of seconds nor ``None``."""
    if value is not None and not (isinstance(value, Real) and float(value) > 0):
        raise ValueError(f"`{name}` must be a positive number of seconds, not {value!r}")
