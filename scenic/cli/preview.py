"""``scenic preview``: one page with scenes of a program that is read from standard input, for editors."""

import json
import os
import sys
from typing import Final

import click

from scenic.cli.options import POSITIVE, option
from scenic.cli.output import exit_code, show_diagnostics
from scenic.cli.render import Sources
from scenic.language.errors import ParseCompileError
from scenic.language.source import Source

__all__ = ["preview"]

_MEMORY: Final = 8 << 30
"""Bytes of address space that a program may take."""


@click.command(hidden=True)
@option("--filename NAME", "Name of the program; its modules are beside it.", required=True)
@option("--scenario NAME", "The scenario of the program.")
@option("--seed", "The seed of the scenes.", int, default=0)
@option("-n count", "The number of scenes.", click.IntRange(1, 100), default=1)
@option("--time-limit", "In seconds.", POSITIVE, default=20.0)
@option("--remarks wants_remarks", "Write what analysis says of the lines, as JSON.")
def preview(
    filename: str, scenario: str | None, seed: int, count: int, time_limit: float, wants_remarks: bool
) -> int:
    """Write a page with scenes of a program from standard input to standard output, within limits of time and memory."""
    _limit(time_limit)
    text = sys.stdin.buffer.read().decode()
    output = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    # What the program prints must not get into the page.
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())

    from scenic.failures import diagnose
    from scenic.formats.html import Page
    from scenic.pipeline import scenarioFromString
    from scenic.runtime.sampling.rejection_report import Exhausted

    page = Page(os.path.basename(filename))
    missing: list[Exhausted] = []
    try:
        program = scenarioFromString(text, scenario=scenario, filename=filename)
        if wants_remarks:
            from scenic.assessment.remarks import remarks

            with output:
                output.write(json.dumps(remarks(program)).encode())
            return 0
        for result in program.stream(count, seed=seed, time_limit=time_limit):
            if isinstance(result, Exhausted):
                missing.append(result)
            else:
                page.add(result)
    except Exception as error:
        diagnostic = diagnose(error)
        diagnostics = (
            error.diagnostics
            if isinstance(error, ParseCompileError)
            else []
            if diagnostic is None
            else [diagnostic]
        )
        if not diagnostics:
            raise
        # The text that is quoted is the one in the editor, whatever the file holds.
        show_diagnostics(diagnostics, Sources([Source(text, filename)]))
        return exit_code(diagnostics)
    if not len(page):
        click.echo(missing[0].message(), err=True)
        return 3
    with output:
        output.write(page.text().encode())
    return 0


def _limit(seconds: float) -> None:
    """Let the system end this process when it takes more than it should."""
    try:
        import resource
    except ImportError:  # There are no such limits on Windows.
        return
    for kind, most in ((resource.RLIMIT_CPU, int(4 * seconds) + 10), (resource.RLIMIT_AS, _MEMORY)):
        _, hard = resource.getrlimit(kind)
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(kind, (most, most))
