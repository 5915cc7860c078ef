"""The report of a search as a page: values over runs, parameters, the worst runs."""

import html
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from scenic.falsification.search import FalsificationResult
from scenic.falsification.search_folder import folders_of, manifest_of, read_rows

__all__ = ["importances", "load_result", "load_results", "page_of", "report_page", "table"]

_WIDTH: Final = 860
_HEIGHT: Final = 260
_EDGE: Final = 48
_WORST: Final = 10
_MOST_AXES: Final = 12
_MOST_LINES: Final = 500

_STYLE: Final = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:900px;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse}td,th{padding:.2em .8em;text-align:right;border-bottom:1px solid #ddd}"
    "svg{background:#fafafa;border:1px solid #ddd}text{font-size:12px;fill:#555}"
)


def load_result(folder: Path) -> FalsificationResult:
    """The result of the search that a folder keeps; raises `SearchFolderError` if there is none."""
    about = manifest_of(folder)
    return FalsificationResult(
        read_rows(folder), tuple(about.get("objectives", ())), folder, about.get("units", {})
    )


def load_results(folder: Path) -> dict[str, FalsificationResult]:
    """The results that a folder keeps, by the settings of a sweep; of a single search by the empty text.

    Raises `SearchFolderError` if there is none.
    """
    found = folders_of(folder)
    if found in ([], [folder]):
        return {"": load_result(folder)}
    return {item.name: load_result(item) for item in found}


def importances(result: FalsificationResult) -> list[tuple[str, float]]:
    """Return the strength with which each coordinate goes with the value: the size of Spearman's rank correlation, the greatest first."""
    rows = [row for row in result.rows if row["values"] is not None and math.isfinite(_value(row))]
    if len(rows) < 3:
        return []
    values = _ranks([_value(row) for row in rows])
    strengths = []
    for name in rows[0]["point"]:
        places = _ranks([row["point"][name] for row in rows])
        spread = float(np.std(places) * np.std(values))
        together = float(np.mean((places - places.mean()) * (values - values.mean())))
        strengths.append((name, abs(together) / spread if spread else 0.0))
    return sorted(strengths, key=lambda item: -item[1])


def _ranks(values: Sequence[float]) -> Any:
    from scipy.stats import rankdata

    return rankdata(values)


def _value(row: Any) -> float:
    return min(map(float, row["values"]))


def report_page(
    results: Mapping[str, FalsificationResult], title: str, *, links_from: Path | None = None
) -> str:
    """The text of a page about a search, or about those of a sweep.

    Args:
        results: the searches, by the settings of a sweep.
        title: the name of the program.
        links_from: the folder of the page, for links to the pages that play counterexamples.

    """
    parts = [f"<h1>Search of {html.escape(title)}</h1>"]
    if len(results) > 1:
        parts.append(
            table(
                ("setting", "runs", "counterexamples", "share", "95% interval", "least value"),
                [_total(label, result) for label, result in results.items()],
            )
        )
    for label, result in results.items():
        if label:
            parts.append(f"<h1>{html.escape(label)}</h1>")
        parts += _section(result, links_from)
    return page_of(title, parts)


def page_of(title: str, parts: Sequence[str]) -> str:
    """The text of a report, from the parts of its body."""
    return f"<!doctype html><html lang='en'><meta charset='utf-8'><title>{html.escape(title)}</title><style>{_STYLE}</style>{''.join(parts)}</html>"


def _total(label: str, result: FalsificationResult) -> tuple[str, ...]:
    share, low, high = result.share()
    worst = "" if result.best is None else f"{_value(result.best):.6g}"
    counts = (str(len(result.rows)), str(len(result.counterexamples)))
    return label, *counts, f"{100 * share:.3g}%", f"{100 * low:.3g}% to {100 * high:.3g}%", worst


def _section(result: FalsificationResult, links_from: Path | None) -> list[str]:
    """The parts of the page about one search."""
    share, low, high = result.share()
    failure_count = len(result.counterexamples)
    rows_with_values = [row for row in result.rows if row["values"] is not None]
    parts = [
        f"<p>Made small: {html.escape(', '.join(result.objectives))}.</p>",
        f"<p>{len(result.rows)} runs, {len(rows_with_values)} with a value, {failure_count} counterexamples",
        f": {100 * share:.3g}% (95% interval {100 * low:.3g}% to {100 * high:.3g}%, Clopper-Pearson).</p>"
        if rows_with_values
        else ".</p>",
    ]
    if result.is_blind:
        parts.append(
            "<p>All values are plus or minus infinity: of this objective only the truth is known, so nothing guides a search.</p>"
        )
    finite = [row for row in rows_with_values if math.isfinite(_value(row))]
    if finite:
        parts += ["<h2>Value over runs</h2>", _progress(finite)]
        strengths = importances(result)
        axes = [name for name, _ in strengths[:_MOST_AXES]]
        if axes:
            parts += [
                "<h2>Parameters</h2>",
                _parallel(finite, axes),
                table(
                    ("parameter", "rank correlation"),
                    [(name, f"{size:.2f}") for name, size in strengths[:_MOST_AXES]],
                ),
            ]
    worst = sorted(rows_with_values, key=_value)[:_WORST]
    parts += [
        "<h2>The worst runs</h2>",
        table(
            ("run", "value", "status", "point"),
            [_described(row, result, links_from) for row in worst],
            raw=True,
        ),
    ]
    return parts


def _described(row: Any, result: FalsificationResult, links_from: Path | None) -> tuple[str, ...]:
    run = str(row["run"])
    if result.folder is not None:
        page = result.folder / "counterexamples" / f"{row['run']:04d}" / "play.html"
        if page.exists():
            run = f"<a href='{html.escape(os.path.relpath(page, links_from or result.folder))}'>{run}</a>"
    point = html.escape(", ".join(result.point(row)[:_MOST_AXES]))
    return run, f"{_value(row):.6g}", row["status"], point


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, raw: bool = False) -> str:
    """Return a table of texts; ``raw`` says that they are HTML."""
    cells = "".join(f"<th>{item}</th>" for item in head)
    lines = ("".join(f"<td>{item if raw else html.escape(item)}</td>" for item in row) for row in rows)
    return f"<table><tr>{cells}</tr>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def _scaled(values: Any, size: float, *, up: bool = False) -> Any:
    low, high = float(np.min(values)), float(np.max(values))
    places = (
        (np.asarray(values, dtype=np.float64) - low) / (high - low)
        if high > low
        else np.full(len(values), 0.5)
    )
    return size - _EDGE - places * (size - 2 * _EDGE) if up else _EDGE + places * (size - 2 * _EDGE)


def _progress(rows: Sequence[Any]) -> str:
    values = np.array([_value(row) for row in rows])
    best = np.minimum.accumulate(values)
    across = _scaled([row["run"] for row in rows], _WIDTH)
    down = _scaled(np.concatenate([values, best]), _HEIGHT, up=True)
    dots = "".join(
        f"<circle cx='{x:.1f}' cy='{y:.1f}' r='2.5' fill='{_colour(row)}'/>"
        for x, y, row in zip(across, down, rows, strict=False)
    )
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, down[len(values) :], strict=True))
    words = f"<text x='4' y='{_EDGE}'>{values.max():.3g}</text><text x='4' y='{_HEIGHT - _EDGE}'>{values.min():.3g}</text>"
    return f"<svg viewBox='0 0 {_WIDTH} {_HEIGHT}' width='100%'>{dots}<polyline points='{line}' fill='none' stroke='#444'/>{words}</svg>"


def _colour(row: Any) -> str:
    return "#c0392b" if row["status"] == "counterexample" else "#2e86c1"


def _parallel(rows: Sequence[Any], names: Sequence[str]) -> str:
    some = sorted(rows, key=_value, reverse=True)[-_MOST_LINES:]
    columns = [_scaled([row["point"][name] for row in some], _HEIGHT, up=True) for name in names]
    across = np.linspace(_EDGE, _WIDTH - _EDGE, len(names))
    lines = "".join(
        f"<polyline points='{' '.join(f'{x:.1f},{column[k]:.1f}' for x, column in zip(across, columns, strict=True))}'"
        f" fill='none' stroke='{_colour(row)}' stroke-opacity='.35'/>"
        for k, row in enumerate(some)
    )
    words = "".join(
        f"<text x='{x:.1f}' y='{20 + 14 * (k % 2)}' text-anchor='middle'>{html.escape(name)}</text>"
        for k, (x, name) in enumerate(zip(across, names, strict=True))
    )
    return f"<svg viewBox='0 0 {_WIDTH} {_HEIGHT}' width='100%'>{lines}{words}</svg>"
