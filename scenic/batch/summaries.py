"""What came of many simulations, in a few lines and as a table."""

import csv
import io
from collections import Counter
from collections.abc import Sequence

from scenic.batch.simulations import SimulationRow, is_violated

__all__ = ["csv_of", "summary", "verdict_of"]


def verdict_of(row: SimulationRow) -> str:
    """``held``, ``violated``, ``rejected`` or ``failed``."""
    if row.error is not None:
        return "failed"
    if row.about is None:
        return "rejected"
    return "violated" if is_violated(row.about) else "held"


def robustness_of(row: SimulationRow) -> float | None:
    """The least robustness of all requirements; ``None`` where none is known."""
    if row.about is None:
        return None
    known = [
        item["robustness"] for item in row.about["requirements"] if isinstance(item["robustness"], float)
    ]
    return min(known, default=None)


def summary(rows: Sequence[SimulationRow]) -> str:
    """The counts of verdicts, and the mean and least robustness."""
    counts = Counter(map(verdict_of, rows))
    words = ", ".join(
        f"{counts[name]} {name}" for name in ("held", "violated", "rejected", "failed") if counts[name]
    )
    values = [value for row in rows if (value := robustness_of(row)) is not None]
    by = (
        f"; robustness {sum(values) / len(values):.4g} on average, {min(values):.4g} at least"
        if values
        else ""
    )
    return f"{len(rows)} simulations: {words}{by}"


def csv_of(rows: Sequence[SimulationRow]) -> str:
    """A table with a row for each simulation: number, verdict, least robustness, steps, why it ended."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["k", "verdict", "robustness", "steps", "reason"])
    for row in rows:
        value = robustness_of(row)
        about = row.about or {}
        reason = row.missing or about.get("reason") or ("" if row.error is None else row.error.message)
        table.writerow(
            [row.k, verdict_of(row), "" if value is None else repr(value), about.get("steps", ""), reason]
        )
    return text.getvalue()
