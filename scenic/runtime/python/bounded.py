"""What analysis is told of Python code by those who wrote it: bounds of a function's result, and of a distribution's draws."""

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from scenic.graph.bounds import Bounds, outward
from scenic.language.errors import InvalidScenarioError

__all__ = ["bounded", "bounds_of_call", "bounds_of_support"]

_Function = TypeVar("_Function", bound=Callable[..., Any])

_MARK = "__scenic_bounds__"


def bounded(reading: Callable[..., tuple[float, float]]) -> Callable[[_Function], _Function]:
    """Tell analysis between which numbers the result of a function lies, so that requirements about it can prune.

    >>> from scenic import bounded
    >>> @bounded(lambda speed, friction: (speed[0] ** 2 / (20 * friction[1]), speed[1] ** 2 / (20 * friction[0])))
    ... def stopping(speed, friction):
    ...     return speed**2 / (20 * friction)

    Args:
        reading: is called with an interval ``(low, high)`` for each positional argument of the function, and gives one that
            holds every result for arguments within those. Of what is no number, or not known, the interval is
            ``(-inf, inf)``; of a vector there are three.

    The function has to be lifted by `distributionFunction`, and its result computed before the requirement that asks for it:
    ``d = stopping(v, f)``, then ``require d < 20`` (what a requirement calls itself is called on samples only). An interval that
    is too narrow changes the law of scenes: it must hold whatever the arguments.

    """

    def mark(function: _Function) -> _Function:
        setattr(function, _MARK, reading)
        return function

    return mark


def bounds_of_call(
    function: Callable[..., Any], args: Sequence[Any], known: Callable[[Any], Bounds | None]
) -> Bounds | None:
    """Bounds of what a function gives, box by box, if it is a `bounded` one.

    Args:
        function: the function.
        args: its positional arguments.
        known: bounds of an argument, ``None`` where there are none.

    """
    reading = getattr(function, _MARK, None)
    if reading is None:
        return None
    bounds = [known(item) for item in args]
    boxes = max((len(item.lower) for item in bounds if item is not None), default=1)
    ends = np.array([_ends(reading, [_interval(item, box) for item in bounds]) for box in range(boxes)])
    return outward(ends[:, 0], ends[:, 1], 4)


def _interval(bounds: Bounds | None, box: int) -> Any:
    if bounds is None:
        return (-math.inf, math.inf)
    row = box if len(bounds.lower) > 1 else 0
    low, high = bounds.lower[row], bounds.upper[row]
    if bounds.lower.ndim == 1:
        return (float(low), float(high))
    return tuple(zip(low.tolist(), high.tolist(), strict=True))


def _ends(reading: Callable[..., Any], intervals: Sequence[Any]) -> tuple[float, float]:
    found = reading(*intervals)
    try:
        low, high = (float(end) for end in found)
    except (TypeError, ValueError):
        low = high = math.nan
    if not low <= high:
        raise InvalidScenarioError(
            f"the bounds of a `bounded` function are {found!r}, which is no interval",
            help="give two numbers, the smaller first; (-inf, inf) where nothing is known",
        )
    return low, high


def bounds_of_support(support: Callable[[], Any]) -> Bounds | None:
    """Bounds of what a distribution of the program's own draws, by its `supportInterval`; ``None`` where that fails."""
    try:
        low, high = support()
        ends = (-math.inf if low is None else float(low), math.inf if high is None else float(high))
    except Exception:  # noqa: BLE001 - whatever the program's code raises: then nothing is known
        return None
    if not ends[0] <= ends[1]:
        return None
    return Bounds(np.array([ends[0]]), np.array([ends[1]]))
