"""Tables, for people, of why scenes were not found: the share of each requirement in the rejections."""

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from scenic.runtime.sampling.rejection_report import Exhausted

__all__ = ["render_missing"]


def render_missing(missing: Sequence[Exhausted], console: Console) -> None:
    """Say which scenes were not found, and why the first of them was not."""
    first = missing[0]
    which = _ranges([item.k for item in missing])
    head = (
        f"scene {which} was not found"
        if len(missing) == 1
        else f"{len(missing)} scenes were not found (k = {which})"
    )
    console.print(Text(f"{head}: {_why(first)}", style="bold"), soft_wrap=True)
    report = first.report
    if not report.rows or not report.candidates:
        return
    table = Table(
        title=f"What rejects, on {report.candidates} candidates of scene {first.k}", title_justify="left"
    )
    table.add_column("requirement", overflow="fold")
    table.add_column("line", justify="right")
    table.add_column("rejects", justify="right")
    table.add_column("alone rejects", justify="right")
    for row in sorted(report.rows, key=lambda row: (-row.rejected, -row.alone)):
        table.add_row(
            Text(row.label),
            "" if row.span is None else str(row.span.line),
            f"{row.rejected:.1%}",
            f"{row.alone:.1%}",
            style="bold red" if row.rejected >= 1 else None,
        )
    console.print(table)
    for row in report.rows:
        if row.rejected >= 1:
            console.print(Text(row.blame()), soft_wrap=True)


def _why(missing: Exhausted) -> str:
    match missing.reason:
        case "impossible":
            return "the requirements cannot hold together (`scenic check --deep` marks which)"
        case "time":
            return f"the time limit was reached ({missing.attempts} candidates)"
        case _:
            return f"none of {missing.attempts} candidates met every requirement"


def _ranges(numbers: Sequence[int]) -> str:
    """Ascending numbers in short: ``0, 3-5``."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][-1] + 1:
            parts[-1][1:] = [number]
        else:
            parts.append([number])
    return ", ".join("-".join(map(str, part)) for part in parts)
