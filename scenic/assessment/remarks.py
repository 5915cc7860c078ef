"""Remarks on the lines of a program that was run: shares that requirements reject, ranges that narrowing leaves."""

from typing import Any, Final

from scenic.analysis.supports import DrawnSupport, supports
from scenic.language.diagnostic_data import span_data
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["remarks"]

_CANDIDATES: Final = 2_000
"""Candidates of each component, at most: an editor shows whole percents."""


def remarks(scenario: Scenario) -> dict[str, Any]:
    """Return the remarks about a scenario's program as plain data, with places.

    ``requirements`` have the shares of candidates that they reject, and reject alone, after narrowing. ``values`` are the random
    numbers and choices of which narrowing removes a part: ``before`` and ``after`` have the least and the greatest number, or
    the options.
    """
    estimates = () if scenario.impossible else scenario.estimates(seed=0, candidates=_CANDIDATES)
    return {
        "candidates": max((part.candidates for part in estimates), default=0),
        "requirements": [
            {
                "label": row.label,
                "span": span_data(row.span),
                "rejected": row.rejected,
                "alone": row.alone,
            }
            for part in estimates
            for row in part.requirements
            if row.span is not None
        ],
        "values": [
            {"span": span_data(row.span), "before": _before(row), "after": _after(row)}
            for row in supports(scenario.outline.graph, scenario.domain)
            if row.span is not None and row.removed > 0 and (row.options or row.after is not None)
        ],
    }


def _before(row: DrawnSupport) -> list[Any]:
    return list(row.options or row.before or ())


def _after(row: DrawnSupport) -> list[Any]:
    if row.options:
        return [row.options[number] for number in row.left if number < len(row.options)]
    return list(row.after or ())
