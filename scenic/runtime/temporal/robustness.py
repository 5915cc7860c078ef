"""Quantitative robustness: by how much a formula holds on a finished trace.

The value of an atom in a state is a number, positive where it holds (by how much a comparison holds, a signed distance, or
an infinity where there is only a truth value). Operators take minima and maxima over the trace (Fainekos and
Pappas, "Robustness of temporal logic specifications for continuous-time signals", 2009), with the finite-trace values of
section 12.6 of the specification at the end: where the robustness is positive, the verdict is true, where negative, false.
"""

import math
from collections.abc import Sequence

from scenic.runtime.temporal.formulas import Atom, Formula

__all__ = ["robustness"]


def robustness(formula: Formula, trace: Sequence[Sequence[float]]) -> float:
    """The robustness at the first state.

    Args:
        formula: the formula.
        trace: for each state the values of the atoms by their numbers; at least one state.

    """
    if not trace:
        raise ValueError("the trace is empty")
    return _signal(formula, trace)[0]


def _signal(formula: Formula, trace: Sequence[Sequence[float]]) -> list[float]:
    """The robustness at every state."""
    if isinstance(formula, Atom):
        return [state[formula.index] for state in trace]
    signals = [_signal(operand, trace) for operand in formula.operands]
    match formula.operator:
        case "not":
            return [-value for value in signals[0]]
        case "and":
            return [min(values) for values in zip(*signals, strict=True)]
        case "or":
            return [max(values) for values in zip(*signals, strict=True)]
        case "implies":
            return [max(-premise, conclusion) for premise, conclusion in zip(*signals, strict=True)]
        case "next":
            return [*signals[0][1:], -math.inf]
        case "always":
            return _backwards(signals[0], [-math.inf] * len(trace), strong=False)
        case "eventually":
            return _backwards([math.inf] * len(trace), signals[0], strong=True)
        case _:  # until
            return _backwards(signals[0], signals[1], strong=True)


def _backwards(held: Sequence[float], goal: Sequence[float], *, strong: bool) -> list[float]:
    """``goal or (held and this at the next state)`` at every state, from the last one back."""
    later = -math.inf if strong else math.inf
    values: list[float] = []
    for now, reached in zip(reversed(held), reversed(goal), strict=True):
        later = max(reached, min(now, later))
        values.append(later)
    return values[::-1]
