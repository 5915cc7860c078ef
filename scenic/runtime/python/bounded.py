"""Bounds of Python code, given to analysis by those who wrote it: of results of functions, of draws, and of regions."""

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from scenic.graph.bounds import Bounds, outward
from scenic.language.errors import InvalidScenarioError

__all__ = ["bounded", "bounds_of_call", "bounds_of_region", "bounds_of_support"]

_Told = TypeVar("_Told", bound=Callable[..., Any])

_MARK = "__scenic_bounds__"

_ULPS = 4
"""Units in the last place that readings may be wrong by, since they are written without outward rounding."""


def bounded(reading: Callable[..., tuple[Any, ...]]) -> Callable[[_Told], _Told]:
    """Tell analysis between which numbers the result of a function lies, or in which box a region, so that requirements can prune.

    >>> from scenic import bounded
    >>> @bounded(lambda speed, friction: (speed[0] ** 2 / (20 * friction[1]), speed[1] ** 2 / (20 * friction[0])))
    ... def stopping(speed, friction):
    ...     return speed**2 / (20 * friction)

    Args:
        reading: is called with an interval ``(low, high)`` for each positional argument of the function, and gives one that
            holds every result for arguments within those. Of what is no number, or not known, the interval is
            ``(-inf, inf)``; of a vector there are three. For a class of regions it is called with the intervals of the
            parameters, in the order in which they are given to ``Region.__init__``, and gives the three intervals of a box.

    The function has to be lifted by `distributionFunction`, and its result computed before the requirement that asks for it:
    ``d = stopping(v, f)``, then ``require d < 20`` (what a requirement calls itself is called on samples only). An interval that
    is too narrow changes the law of scenes: it must hold whatever the arguments.

    """

    def mark(told: _Told) -> _Told:
        if not callable(told):
            raise InvalidScenarioError(
                f"`bounded` marks a function or a class of regions, not {told!r}",
                help="give it the function of bounds first: `@bounded(lambda x: (x[0], x[1]))`",
            )
        setattr(told, _MARK, reading)
        return told

    return mark


def bounds_of_call(
    function: Callable[..., Any], args: Sequence[object], known: Callable[[Any], Bounds | None]
) -> Bounds | None:
    """Return bounds of the result of a function, box by box, if it is a `bounded` one.

    Args:
        function: the function.
        args: its positional arguments.
        known: bounds of an argument, ``None`` where there are none.

    """
    reading = getattr(function, _MARK, None)
    if reading is None:
        return None
    ends = np.array([_ends(interval) for interval in _readings(reading, [known(item) for item in args])])
    return outward(ends[:, 0], ends[:, 1], _ULPS)


def bounds_of_region(kind: type, parameters: Sequence[Bounds | None]) -> Bounds | None:
    """Bounds ``(m, 3)`` of the points of regions of a `bounded` class, box by box; ``None`` of others.

    Args:
        kind: the class.
        parameters: bounds of the region's parameters, ``None`` where there are none.

    """
    reading = getattr(kind, _MARK, None)
    if reading is None:
        return None
    rows = []
    for intervals in _readings(reading, parameters):
        if not isinstance(intervals, tuple | list) or len(intervals) != 3:
            raise _no_interval(intervals, "three intervals, of x, y and z")
        rows.append([_ends(interval) for interval in intervals])
    ends = np.array(rows)
    return outward(ends[..., 0], ends[..., 1], _ULPS)


def _readings(reading: Callable[..., Any], bounds: Sequence[Bounds | None]) -> list[Any]:
    """Call a bounding function once for each box of ``bounds``, with an interval for each argument; return the results."""
    boxes = max((len(item.lower) for item in bounds if item is not None), default=1)
    return [reading(*(_interval(item, box) for item in bounds)) for box in range(boxes)]


def _interval(bounds: Bounds | None, box: int) -> Any:
    if bounds is None:
        return (-math.inf, math.inf)
    row = box if len(bounds.lower) > 1 else 0
    low, high = bounds.lower[row], bounds.upper[row]
    if bounds.lower.ndim == 1:
        return (float(low), float(high))
    return tuple(zip(low.tolist(), high.tolist(), strict=True))


def _ends(found: Any) -> tuple[float, float]:
    try:
        low, high = (float(end) for end in found)
    except (TypeError, ValueError):
        low = high = math.nan
    if not low <= high:
        raise _no_interval(found, "two numbers, the smaller first; (-inf, inf) where nothing is known")
    return low, high


def _no_interval(found: object, wanted: str) -> InvalidScenarioError:
    return InvalidScenarioError(
        f"the bounds that `bounded` was given are {found!r}, which is no interval", help=f"give {wanted}"
    )


def bounds_of_support(support: Callable[[], Any]) -> Bounds | None:
    """Return bounds of a draw from a distribution of the program's own, by its `supportInterval`; ``None`` where that fails."""
    try:
        low, high = support()
        ends = (-math.inf if low is None else float(low), math.inf if high is None else float(high))
    except Exception:  # noqa: BLE001 - whatever the program's code raises: then nothing is known
        return None
    if not ends[0] <= ends[1]:
        return None
    return Bounds(np.array([ends[0]]), np.array([ends[1]]))
