"""Problems of a map, counted where many are alike."""

from collections import Counter
from typing import Final

from scenic.formats.opendrive.records import MapProblem

__all__ = ["told"]

_ALIKE: Final = 5
"""Number of problems of one kind that are reported one by one."""


def told(problems: tuple[MapProblem, ...]) -> tuple[MapProblem, ...]:
    """The problems with at most a few of a kind, and a count of the others of that kind."""
    counts: Counter[str] = Counter()
    remaining = []
    for problem in problems:
        counts[problem.kind] += 1
        if counts[problem.kind] <= _ALIKE:
            remaining.append(problem)
    for kind, count in counts.items():
        if count > _ALIKE:
            first = next(problem for problem in problems if problem.kind == kind)
            message = f"{count - _ALIKE} more like: {first.message}"
            remaining.append(MapProblem(first.code, message, first.line, kind))
    return tuple(remaining)
