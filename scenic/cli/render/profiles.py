"""Profiles of sampling as tables for people."""

from typing import Final

from rich.console import Console
from rich.table import Table
from rich.text import Text

from scenic.runtime.sampling.profiling import Profile

__all__ = ["render_profile"]

_ROWS: Final = 20
"""Operations that are shown by themselves."""


def render_profile(profile: Profile, console: Console) -> None:
    """Show what operations and requirements cost, and which of them call Python code for each candidate."""
    console.print(
        Text(
            f"{profile.scenes} scenes from {profile.candidates} candidates ({profile.acceptance:.1%} accepted) "
            f"in {profile.rounds} rounds: {profile.seconds * 1e3:.1f} ms",
            style="bold",
        ),
        soft_wrap=True,
    )
    operations = Table(title="Operations", title_justify="left")
    operations.add_column("operation", overflow="fold")
    for heading in ("line", "values", "ms", "share"):
        operations.add_column(heading, justify="right")
    whole = max(profile.seconds, 1e-9)
    for row in profile.operations[:_ROWS]:
        operations.add_row(
            _named(row.operation, row.in_python),
            "" if row.line is None else str(row.line),
            str(row.values),
            f"{row.seconds * 1e3:.2f}",
            f"{row.seconds / whole:.1%}",
        )
    others = profile.operations[_ROWS:]
    if others:
        rest = sum(row.seconds for row in others)
        operations.add_row(
            f"{len(others)} others", "", "", f"{rest * 1e3:.2f}", f"{rest / whole:.1%}", style="dim"
        )
    console.print(operations)
    checks = Table(title="Requirements", title_justify="left")
    checks.add_column("requirement", overflow="fold")
    for heading in ("line", "candidates", "pass", "ms"):
        checks.add_column(heading, justify="right")
    for check in profile.checks:
        checks.add_row(
            _named(check.label, check.in_python),
            "" if check.span is None else str(check.span.line),
            str(check.candidates),
            f"{check.passed / check.candidates:.1%}" if check.candidates else "",
            f"{check.seconds * 1e3:.2f}",
        )
    console.print(checks)
    for check in profile.in_python:
        console.print(Text(f"{check.label} calls Python code for each candidate"), soft_wrap=True)


def _named(name: str, in_python: bool) -> Text:
    return Text(f"{name} (in Python)" if in_python else name, style="yellow" if in_python else "")
