"""``scenic doctor``: whether this installation is complete, and how to complete it."""

import sys

import click

from scenic.cli.output import CLEAN, FINDINGS, has_colours

__all__ = ["doctor"]


@click.command()
def doctor() -> int:
    """List versions, extras, the state of the cache, and problems of this installation.

    Exit codes: 0 no problem, 1 there is a problem.
    """
    from rich.console import Console
    from rich.text import Text

    from scenic.installation import State, findings  # looks at many packages

    marks = {State.FINE: ("ok", "green"), State.MISSING: ("--", "yellow"), State.PROBLEM: ("!!", "bold red")}
    console = Console(file=sys.stdout, no_color=not has_colours(sys.stdout), highlight=False, soft_wrap=True)
    worst = CLEAN
    for finding in findings():
        mark, style = marks[finding.state]
        console.print(Text.assemble((f"{mark}  ", style), (f"{finding.subject:20} ", "bold"), finding.text))
        if finding.help is not None:
            console.print(Text(f"{'':25}{finding.help}"))
        if finding.state is State.PROBLEM:
            worst = FINDINGS
    return worst
