"""``scenic analyze``: what a program is like to sample."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from scenic.cli.options import COUNT, option, program_argument, program_options
from scenic.cli.output import CLEAN, FINDINGS, has_colours

if TYPE_CHECKING:
    from scenic.assessment.assessment import Assessment

__all__ = ["analyze"]


@click.command("analyze")
@program_argument
@program_options
@option(
    "-n --candidates N",
    "Number of candidates of each component, at most, for estimating probabilities.",
    COUNT,
    default=20_000,
)
@option("--json as_json", "Write the findings as JSON.")
@option(
    "--png PATH",
    "Draw the possible places of each object, from above and from the side.",
    click.Path(path_type=Path, dir_okay=False),
)
def analyze(
    file: str,
    parameters: Mapping[str, object],
    scenario: str | None,
    model: str | None,
    mode_2d: bool,
    candidates: int,
    as_json: bool,
    png: Path | None,
) -> int:
    """Report the cost of sampling a program, and the possible places of its objects.

    Exit codes: 0 success, 1 the program has errors or no scene exists, 2 wrong usage.
    """
    from scenic.formats.files import check_writable
    from scenic.formats.imaging import require_pillow
    from scenic.pipeline import analyze as analysed

    if png is not None:
        require_pillow()
        check_writable(png)
    report = analysed(
        file, params=parameters, scenario=scenario, model=model, mode2D=mode_2d, candidates=candidates
    )
    if png is not None:
        report.png(png)
    if as_json:
        click.echo(report.to_json())
    else:
        _show(report)
    return FINDINGS if report.impossible else CLEAN


def _show(found: "Assessment") -> None:
    from rich.console import Console
    from rich.table import Table

    console = Console(no_color=not has_colours(sys.stdout), highlight=False)
    for line in found.summary():
        console.print(line, soft_wrap=True, markup=False)
    values = Table(title="Random values", title_justify="left")
    values.add_column("name", no_wrap=True)
    for heading in ("value", "line", "before", "after", "removed"):
        values.add_column(heading, overflow="fold")
    rows_in_use = [row for row in found.values if not row.is_idle]
    for row in rows_in_use:
        line = "" if row.line is None else str(row.line)
        values.add_row(row.name, row.text, line, row.before, row.after, f"{row.support.removed:.1%}")
    if rows_in_use:
        console.print(values)
    if found.idle is not None:
        console.print(found.idle, soft_wrap=True, markup=False)
    for number, part in enumerate(found.components, start=1):
        of_part = f" of component {number}" if len(found.components) > 1 else ""
        checks = Table(
            title=f"Requirements{of_part}: {part.accepted} of {part.candidates} candidates pass",
            title_justify="left",
        )
        checks.add_column("requirement", overflow="fold")
        for heading in ("line", "rejects", "alone", "without it"):
            checks.add_column(heading, justify="right")
        for check in part.requirements:
            checks.add_row(
                check.label,
                "" if check.span is None else str(check.span.line),
                f"{check.rejected:.1%}",
                f"{check.alone:.1%}",
                "" if check.factor is None else f"{check.factor:.3g} times fewer",
            )
        if part.requirements:
            console.print(checks)
