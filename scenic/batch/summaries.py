"""Many simulations in a few lines, as a table, and as a plot; of one setting of the parameters or of several."""

import csv
import io
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field
from typing import Any, Final

from scenic.batch.simulations import SimulationRow, is_violated
from scenic.dataclass import dataclass

__all__ = ["SettingRuns", "csv_of", "plot", "summary", "verdict_of"]

_WIDTH: Final = 760
_HEIGHT: Final = 420
_LEFT: Final = 70
_BOTTOM: Final = 80
_TOP: Final = 20
_TICKS: Final = 6


@dataclass(frozen=True)
class SettingRuns:
    """The simulations of one setting of the parameters.

    Attributes:
        rows: the simulations, by number.
        parameters: values of the parameters that differ between settings, by name.

    """

    rows: dict[int, SimulationRow]
    parameters: Mapping[str, Any] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """The parameters in words: ``toys=4``."""
        return ", ".join(f"{name}={value}" for name, value in self.parameters.items())

    @property
    def simulations(self) -> list[SimulationRow]:
        """The simulations in order."""
        return [self.rows[k] for k in sorted(self.rows)]


def verdict_of(row: SimulationRow) -> str:
    """Return ``held``, ``violated``, ``rejected`` or ``failed``."""
    if row.error is not None:
        return "failed"
    if row.about is None:
        return "rejected"
    return "violated" if is_violated(row.about) else "held"


def robustness_of(row: SimulationRow) -> float | None:
    """Return the least robustness of all requirements; ``None`` where none is known."""
    if row.about is None:
        return None
    known = [
        item["robustness"] for item in row.about["requirements"] if isinstance(item["robustness"], float)
    ]
    return min(known, default=None)


def summary(setting: SettingRuns) -> str:
    """Return one line: the counts of verdicts, and the mean and least robustness."""
    counts = Counter(map(verdict_of, setting.simulations))
    words = ", ".join(
        f"{counts[name]} {name}" for name in ("held", "violated", "rejected", "failed") if counts[name]
    )
    values = _values(setting)
    by = (
        f"; robustness {sum(values) / len(values):.4g} on average, {min(values):.4g} at least"
        if values
        else ""
    )
    head = f"{setting.label}: " if setting.parameters else ""
    return f"{head}{len(setting.rows)} simulations: {words}{by}"


def csv_of(settings: Sequence[SettingRuns]) -> str:
    """Return a table with a row for each simulation: parameters, number, verdict, least robustness, steps, why it ended."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    names = list(settings[0].parameters) if settings else []
    table.writerow([*names, "k", "verdict", "robustness", "steps", "reason"])
    for setting in settings:
        for row in setting.simulations:
            value = robustness_of(row)
            about = row.about or {}
            reason = row.missing or about.get("reason") or ("" if row.error is None else row.error.message)
            table.writerow(
                [
                    *setting.parameters.values(),
                    row.k,
                    verdict_of(row),
                    "" if value is None else repr(value),
                    about.get("steps", ""),
                    reason,
                ]
            )
    return text.getvalue()


def plot(settings: Sequence[SettingRuns]) -> str:
    """Return an SVG image: a dot for the robustness of each simulation, a line through the means, the share violated below.

    Simulations without a finite robustness have no dot, but count in the share.
    """
    values = [_values(item) for item in settings]
    every = [value for some in values for value in some] or [0.0]
    low, high = min(*every, 0.0), max(*every, 0.0)
    margin = 0.06 * (high - low) or 1.0
    low, high = low - margin, high + margin
    column = (_WIDTH - _LEFT) / max(1, len(settings))

    def height(value: float) -> float:
        return _TOP + (_HEIGHT - _TOP - _BOTTOM) * (high - value) / (high - low)

    parts = [
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {_WIDTH} {_HEIGHT}' font-family='sans-serif' font-size='13'>",
        f"<rect width='{_WIDTH}' height='{_HEIGHT}' fill='white'/>",
        *_scale([low + (high - low) * tick / _TICKS for tick in range(_TICKS + 1)], height),
    ]
    means = []
    for number, (setting, some) in enumerate(zip(settings, values, strict=True)):
        middle = _LEFT + column * (number + 0.5)
        parts += _column(setting, some, middle, column, height)
        if some:
            means.append((middle, height(sum(some) / len(some))))
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in means)
    parts.append(f"<polyline points='{line}' fill='none' stroke='#222' stroke-width='2'/>")
    parts += [f"<rect x='{x - 4:.1f}' y='{y - 4:.1f}' width='8' height='8' fill='#222'/>" for x, y in means]
    centre = _TOP + (_HEIGHT - _TOP - _BOTTOM) / 2
    parts.append(
        f"<text transform='translate(18 {centre:.0f}) rotate(-90)' text-anchor='middle'>robustness</text></svg>"
    )
    return "".join(parts)


def _scale(ticks: Sequence[float], height: Callable[[float], float]) -> Iterator[str]:
    """The lines and numbers of the vertical axis, and the line of 0."""
    for value in ticks:
        y = height(value)
        yield f"<text x='{_LEFT - 8}' y='{y + 4:.1f}' text-anchor='end' fill='#555'>{value:.2g}</text>"
        yield f"<line x1='{_LEFT}' x2='{_WIDTH}' y1='{y:.1f}' y2='{y:.1f}' stroke='#eee'/>"
    y = height(0)
    yield f"<line x1='{_LEFT}' x2='{_WIDTH}' y1='{y:.1f}' y2='{y:.1f}' stroke='#888' stroke-dasharray='5 4'/>"


def _column(
    setting: SettingRuns,
    values: Sequence[float],
    middle: float,
    width: float,
    height: Callable[[float], float],
) -> Iterator[str]:
    """The dots of one setting, beside each other in the order of the simulations, and its words."""
    import html

    for place, value in enumerate(values):
        x = middle + 0.5 * width * ((place + 0.5) / len(values) - 0.5)
        colour = "#c0392b" if value < 0 else "#2e86c1"
        yield f"<circle cx='{x:.1f}' cy='{height(value):.1f}' r='3' fill='{colour}' fill-opacity='.55'/>"
    violation_count = sum(verdict_of(row) == "violated" for row in setting.simulations)
    for line, text in enumerate(
        (setting.label or "all", f"{violation_count} of {len(setting.rows)}", "violated")
    ):
        y = _HEIGHT - _BOTTOM + 22 + 17 * line
        yield f"<text x='{middle:.1f}' y='{y}' text-anchor='middle'>{html.escape(text)}</text>"


def _values(setting: SettingRuns) -> list[float]:
    return [value for row in setting.simulations if (value := robustness_of(row)) is not None]
