"""Quantitative robustness: by how much a formula holds on the states seen so far.

The value of an atom in a state is a number, positive where it holds (by how much a comparison holds, a signed distance, or
an infinity where there is only a truth value). Operators take minima and maxima over the trace (Fainekos and
Pappas, "Robustness of temporal logic specifications for continuous-time signals", 2009), with the finite-trace values of
section 12.6 of the specification at the end: where the robustness is positive, the verdict is true, where negative, false.

No states are kept: as a function of what the next state will give its obligations, the robustness is a maximum of minima of
some of them and a constant, and minima distribute over maxima. So there is one constant for each clause of obligations, and what
is kept is bounded by the formula, as in a `Monitor`, of which this is the reading by numbers.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import Final, TypeAlias

from scenic.runtime.temporal.formulas import Formula
from scenic.runtime.temporal.normal_form import Connective, Literal, Next, Normal, Obligation, Until, normal

__all__ = ["Robustness", "joint_margin"]

_Clauses: TypeAlias = Mapping[frozenset[Obligation], float]
"""A maximum over clauses, each the minimum of its number and of its obligations."""

_NOW: Final[frozenset[Obligation]] = frozenset()

_EXPONENT: Final = 2 / 3
"""Exponent of the norm of margins above 0."""

_Join: TypeAlias = Callable[[Sequence[float]], float]
"""The margin of an ``or`` by those of its parts, in one state."""


def joint_margin(parts: Sequence[float]) -> float:
    """Return by how much at least one of some parts holds, where all of them are on the way to a failure.

    The largest margin says by how much `or` holds, and the others do not matter to it. But all of them have to fall to 0 or less until
    nothing holds. So where one holds, this is a norm of the margins above 0, of an exponent between counting them (0) and adding them (1): it
    falls with any of them. It is 0 or less exactly where the largest margin is, and has the same unit.
    """
    largest = max(parts)
    if not 0 < largest < math.inf:
        return largest
    total = math.fsum(part**_EXPONENT for part in parts if part > 0)
    return max(largest, math.pow(total, 1 / _EXPONENT))


class Robustness:
    """Follows one formula along a trace.

    Args:
        formula: what is to hold from the first state on.
        is_joint: whether the parts of an `or` in one state count together (`joint_margin`), rather than the largest alone.

    """

    __slots__ = ("_join", "_left", "_start")

    def __init__(self, formula: Formula, *, is_joint: bool = False) -> None:
        self._start: Normal | None = normal(formula)
        self._left: _Clauses = {}
        self._join: _Join = joint_margin if is_joint else max

    def add(self, margin: Callable[[int], float]) -> None:
        """Go on by a state, in which ``margin`` gives by how much atoms hold, by their number.

        NaN says that an atom has no value there; neither it nor its negation holds then.
        """
        clauses_of: dict[Normal, _Clauses] = {}
        if self._start is not None:
            self._left = _progressed(self._start, margin, self._join, clauses_of)
            self._start = None
            return
        if all(not obligations for obligations in self._left):
            return  # Nothing is left to hold.
        left: _Clauses = {}
        for obligations, value in self._left.items():
            clause: _Clauses = {_NOW: value}
            for _, part in obligations:
                clause = _lower(clause, _progressed(part, margin, self._join, clauses_of))
            left = _higher(left, clause)
        self._left = left

    @property
    def value(self) -> float | None:
        """The robustness if the trace ends here; ``None`` before the first state."""
        if self._start is not None:
            return None
        ended = (value for clause, value in self._left.items() if all(weak for weak, _ in clause))
        return max(ended, default=-math.inf)


def _progressed(
    part: Normal, margin: Callable[[int], float], join: _Join, known: dict[Normal, _Clauses]
) -> _Clauses:
    """The robustness of a part at a state, in terms of what comes after it."""
    found = known.get(part)
    if found is None:
        found = known[part] = _made(part, margin, join, known)
    return found


def _made(
    part: Normal, margin: Callable[[int], float], join: _Join, known: dict[Normal, _Clauses]
) -> _Clauses:
    match part:
        case Literal(index, truth):
            value = margin(index)
            return {} if math.isnan(value) else {_NOW: value if truth else -value}
        case Connective(conjunction, parts):
            each = [_progressed(item, margin, join, known) for item in parts]
            if not conjunction and all(clauses.keys() <= {_NOW} for clauses in each):
                margins = [value for clauses in each for value in clauses.values()]
                return {_NOW: join(margins)} if margins else {}
            return reduce(_lower if conjunction else _higher, each)
        case Next(weak, later):
            return {frozenset([(weak, later)]): math.inf}
        case Until(weak, condition, goal):
            again: _Clauses = {frozenset([(weak, part)]): math.inf}
            inner, outer = (_higher, _lower) if weak else (_lower, _higher)
            if condition is not None:
                again = inner(_progressed(condition, margin, join, known), again)
            return outer(_progressed(goal, margin, join, known), again)


def _higher(left: _Clauses, right: _Clauses) -> _Clauses:
    """Return the maximum of two."""
    joined = dict(left)
    for clause, value in right.items():
        joined[clause] = max(value, joined.get(clause, -math.inf))
    return _needed(joined)


def _lower(left: _Clauses, right: _Clauses) -> _Clauses:
    """Return the minimum of two."""
    joined: dict[frozenset[Obligation], float] = {}
    for one, first in left.items():
        for other, second in right.items():
            clause = one | other
            joined[clause] = max(min(first, second), joined.get(clause, -math.inf))
    return _needed(joined)


def _needed(clauses: _Clauses) -> _Clauses:
    """Remove the clauses that are never above another one."""
    if len(clauses) < 2:
        return clauses
    kept: dict[frozenset[Obligation], float] = {}
    for clause, value in sorted(clauses.items(), key=lambda item: len(item[0])):
        if not any(other <= clause and least >= value for other, least in kept.items()):
            kept[clause] = value
    return kept
