"""The report of an estimate as a page: the interval over the runs, and each requirement."""

import html
import math
import re
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from scenic.estimation.branching import Rare
from scenic.estimation.estimate import Estimate, Tally
from scenic.estimation.sentences import comparison_words, described, headline, method_words, notes, percent
from scenic.falsification.search_page import page_of, table

__all__ = ["estimate_page", "interval_plot"]

_WIDTH: Final = 860
_HEIGHT: Final = 300
_ROW: Final = 26
"""Height of a line in the plot of settings."""

_WIDE_LEFT: Final = 180
"""Room for the names of settings."""

_LEFT, _RIGHT, _TOP, _BOTTOM = 70, 24, 16, 44
_POINTS: Final = 160
"""Numbers of runs at which the interval is drawn."""


def estimate_page(results: Mapping[str, Estimate], title: str) -> str:
    """The text of a page about an estimate, or about those of the settings of a sweep.

    Args:
        results: the estimates, by setting.
        title: the name of the program.

    """
    parts = [f"<h1>Estimate for {html.escape(title)}</h1>"]
    if len(results) > 1:
        head = ("setting", "runs", "counterexamples", "probability")
        rows = [
            (
                label,
                f"{item.runs:,}",
                f"{item.violations:,}",
                described(item.probability, item.interval, item.confidence),
            )
            for label, item in results.items()
        ]
        parts += [table(head, rows), settings_plot(results)]
    parts += [f"<p>{html.escape(line)}</p>" for item in results.values() for line in comparison_words(item)]
    for label, result in results.items():
        if label:
            parts.append(f"<h1>{html.escape(label)}</h1>")
        parts += _section(result)
    return page_of(title, parts)


def _row(label: str, result: Estimate, tally: Tally) -> tuple[str, ...]:
    interval = tally.interval(result.confidence, at_any_time=result.at_any_time)
    return (
        label,
        f"{tally.runs:,}",
        f"{tally.violations:,}",
        described(tally.share, interval, result.confidence),
    )


def _marked(line: str) -> str:
    """Return a sentence as HTML."""
    return re.sub("`([^`]*)`", r"<code>\1</code>", html.escape(line[:1].upper() + line[1:]))


def _section(result: Estimate) -> list[str]:
    """The parts of the page about one estimate."""
    parts = [f"<p>{_marked(line)}.</p>" for line in headline(result)]
    parts.append(f"<p>The interval is one {html.escape(method_words(result))}. Seed {result.seed}.</p>")
    remarks = "".join(f"<li>{_marked(line)}</li>" for line in notes(result))
    if remarks:
        parts.append(f"<ul>{remarks}</ul>")
    if result.rare is not None and result.rare.is_known:
        parts += ["<h2>Levels</h2>", levels_plot(result.rare)]
    elif result.total.runs and result.weighted is None:
        parts += ["<h2>Interval over runs</h2>", interval_plot(result)]
    if result.requirements:
        head = ("requirement", "runs", "violated", "probability", "presumably true", "not evaluated")
        rows = [
            (*_row(item.label, result, item), f"{item.presumable:,}", f"{item.unseen:,}")
            for item in result.requirements
        ]
        parts += ["<h2>Requirements</h2>", table(head, rows)]
        if len(rows) > 1:
            parts.append("<p>Each interval is right with its own confidence, not all of them together.</p>")
    return parts


def settings_plot(results: Mapping[str, Estimate]) -> str:
    """Return the probability and its interval for each setting, as SVG."""
    estimates = {label: item for label, item in results.items() if not math.isnan(item.probability)}
    if not estimates:
        return ""
    top = min(1.0, 1.1 * max(item.interval.high for item in estimates.values()))
    height = _TOP + _ROW * len(estimates) + _BOTTOM

    def x(share: float) -> float:
        return _WIDE_LEFT + share / top * (_WIDTH - _WIDE_LEFT - _RIGHT)

    parts = [
        f"<line x1='{x(value):.1f}' x2='{x(value):.1f}' y1='{_TOP}' y2='{height - _BOTTOM}' stroke='#ddd'/>"
        f"<text x='{x(value):.1f}' y='{height - _BOTTOM + 18}' text-anchor='middle'>{value:.3g}</text>"
        for value in _ticks(top)
    ]
    for place, (label, item) in enumerate(estimates.items()):
        y = _TOP + _ROW * (place + 0.5)
        low, high = item.interval
        parts.append(
            f"<text x='{_WIDE_LEFT - 10}' y='{y + 4:.1f}' text-anchor='end'>{html.escape(label)}</text>"
            f"<line x1='{x(low):.1f}' x2='{x(high):.1f}' y1='{y:.1f}' y2='{y:.1f}' stroke='#2e86c1' stroke-width='3'/>"
            f"<circle cx='{x(item.probability):.1f}' cy='{y:.1f}' r='4' fill='#1b4f72'/>"
        )
    confidence = percent(next(iter(estimates.values())).confidence)
    words = (
        f"<text x='{_WIDTH / 2:.0f}' y='{height - 8}' text-anchor='middle'>probability of a counterexample, with its interval of"
        f" {confidence}</text>"
    )
    return f"<svg viewBox='0 0 {_WIDTH} {height}' width='100%'>{''.join(parts)}{words}</svg>"


def interval_plot(result: Estimate) -> str:
    """The share of counterexamples and the interval that holds at all times, over the number of runs, as SVG."""
    total = Tally()
    every = max(1, len(result.rows) // _POINTS)
    points: list[tuple[int, float, float, float]] = []
    for place, row in enumerate(result.rows, 1):
        total.add(row)
        if total.runs > total.unknown and (place % every == 0 or place == len(result.rows) or place < 10):
            points.append((total.runs, total.share, *total.interval(result.confidence, at_any_time=True)))
    if not points:
        return ""
    # The first intervals say next to nothing; the axis ends where the later ones lie.
    late = points[len(points) // 8 :] if len(points) > 16 else points
    top = min(1.0, 1.1 * max(point[3] for point in late))
    bound = result.asked.test.bound if result.asked.test is not None else None
    if bound is not None:
        top = min(1.0, max(top, 1.3 * bound))
    runs = points[-1][0]

    def x(number: float) -> float:
        return _LEFT + number / runs * (_WIDTH - _LEFT - _RIGHT)

    def y(share: float) -> float:
        return _HEIGHT - _BOTTOM - min(share, top) / top * (_HEIGHT - _TOP - _BOTTOM)

    upper = [f"{x(point[0]):.1f},{y(point[3]):.1f}" for point in points]
    lower = [f"{x(point[0]):.1f},{y(point[2]):.1f}" for point in reversed(points)]
    share = [f"{x(point[0]):.1f},{y(point[1]):.1f}" for point in points]
    parts = [
        f"<polygon points='{' '.join(upper + lower)}' fill='#2e86c1' fill-opacity='.18' stroke='none'/>",
        f"<polyline points='{' '.join(share)}' fill='none' stroke='#1b4f72' stroke-width='1.5'/>",
    ]
    if bound is not None:
        parts.append(
            f"<line x1='{_LEFT}' x2='{_WIDTH - _RIGHT}' y1='{y(bound):.1f}' y2='{y(bound):.1f}' stroke='#c0392b' stroke-dasharray='6 4'/>"
            f"<text x='{_WIDTH - _RIGHT}' y='{y(bound) - 5:.1f}' text-anchor='end'>at most {bound:g}</text>"
        )
    low, high = result.interval
    end = x(runs)
    parts.append(
        f"<line x1='{end:.1f}' x2='{end:.1f}' y1='{y(low):.1f}' y2='{y(high):.1f}' stroke='#c0392b' stroke-width='3'/>"
        f"<circle cx='{end:.1f}' cy='{y(points[-1][1]):.1f}' r='3.5' fill='#c0392b'/>"
    )
    ticks = "".join(
        f"<line x1='{_LEFT - 4}' x2='{_WIDTH - _RIGHT}' y1='{y(value):.1f}' y2='{y(value):.1f}' stroke='#ddd'/>"
        f"<text x='{_LEFT - 8}' y='{y(value) + 4:.1f}' text-anchor='end'>{value:.3g}</text>"
        for value in _ticks(top)
    )
    ticks += "".join(
        f"<text x='{x(value):.1f}' y='{_HEIGHT - _BOTTOM + 18}' text-anchor='middle'>{value:,.0f}</text>"
        for value in _ticks(runs)
    )
    words = (
        f"<text x='{_WIDTH / 2:.0f}' y='{_HEIGHT - 8}' text-anchor='middle'>runs; band: interval of {percent(result.confidence)} that"
        " holds at all times, red: the interval that is reported</text>"
    )
    return f"<svg viewBox='0 0 {_WIDTH} {_HEIGHT}' width='100%'>{ticks}{''.join(parts)}{words}</svg>"


def levels_plot(rare: Rare) -> str:
    """Return the probability of each level, on a logarithmic axis, by the value of the level, for each repetition, as SVG."""
    courses = []
    for item in rare.repetitions:
        if item.log_probability is None:
            continue
        shares = [0.0, *item.shares, item.log_probability]
        values = [*item.levels, 0.0]
        courses.append(list(zip(values, shares[1:], strict=True)))
    values = [value for course in courses for value, _ in course if math.isfinite(value)]
    depth = min(share for course in courses for _, share in course) / math.log(10) * 1.05
    left, right = max(values, default=0.0), min([*values, 0.0])
    width = (left - right) or 1.0

    def x(value: float) -> float:
        return _LEFT + (left - value) / width * (_WIDTH - _LEFT - _RIGHT)

    def y(logarithm: float) -> float:
        return _TOP + logarithm / math.log(10) / depth * (_HEIGHT - _TOP - _BOTTOM)

    ticks = "".join(
        f"<line x1='{_LEFT - 4}' x2='{_WIDTH - _RIGHT}' y1='{y(-power * math.log(10)):.1f}' y2='{y(-power * math.log(10)):.1f}'"
        f" stroke='#ddd'/><text x='{_LEFT - 8}' y='{y(-power * math.log(10)) + 4:.1f}' text-anchor='end'>1e-{power}</text>"
        for power in range(int(-depth) + 1)
    )
    ticks += "".join(
        f"<text x='{x(value):.1f}' y='{_HEIGHT - _BOTTOM + 18}' text-anchor='middle'>{value:.3g}</text>"
        for value in np.linspace(left, right, 6).tolist()
    )
    lines = "".join(
        f"<polyline points='{' '.join(f'{x(value):.1f},{y(share):.1f}' for value, share in course)}' fill='none'"
        " stroke='#2e86c1' stroke-opacity='.6'/>"
        + "".join(
            f"<circle cx='{x(value):.1f}' cy='{y(share):.1f}' r='2.5' fill='#1b4f72'/>"
            for value, share in course
        )
        for course in courses
    )
    words = (
        f"<text x='{_WIDTH / 2:.0f}' y='{_HEIGHT - 8}' text-anchor='middle'>distance to a failure; probability of a"
        " distance as small, one line for each repetition</text>"
    )
    return f"<svg viewBox='0 0 {_WIDTH} {_HEIGHT}' width='100%'>{ticks}{lines}{words}</svg>"


def _ticks(top: float) -> Sequence[float]:
    """Four to eight round numbers from 0 to ``top``."""
    raw = top / 5
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= raw * 0.99)
    return [step * k for k in range(int(top / step + 1e-9) + 1)]
