"""Output of the commands: colours only on a terminal, and exit codes that mean the same everywhere."""

import os
import sys
import warnings
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from typing import Final, TextIO

from scenic.cli.render import Sources, render_text
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.errors import ScenicWarning

__all__ = [
    "CLEAN",
    "FINDINGS",
    "INTERNAL",
    "INTERRUPTED",
    "USAGE",
    "exit_code",
    "has_colours",
    "show_diagnostics",
    "shown_warnings",
    "summary",
]

CLEAN: Final = 0
FINDINGS: Final = 1
"""The program has errors; of ``scenic check``: or warnings."""
USAGE: Final = 2
"""The command was called wrongly: an unknown option, a file that cannot be read or written."""
INTERNAL: Final = 70
"""A fault of this program (``EX_SOFTWARE`` of sysexits.h)."""
INTERRUPTED: Final = 130
"""Ended with Ctrl-C (128 + SIGINT, as shells have it)."""

_OF_USAGE: Final = frozenset({"SC600", "SC601", "SC603", "SC604", "SC605", "SC606", "SC607"})


def exit_code(diagnostics: Iterable[Diagnostic], *, failing: Collection[Severity] = (Severity.ERROR,)) -> int:
    """Return the exit code for diagnostics: the worst of them decides; ``failing`` are the severities that count."""
    codes = {item.code for item in diagnostics if item.severity in failing}
    if not codes:
        return CLEAN
    if "SC999" in codes:
        return INTERNAL
    return USAGE if codes & _OF_USAGE else FINDINGS


def has_colours(stream: TextIO) -> bool:
    """Return whether to use colours: on a terminal that has them, unless ``NO_COLOR`` is set (no-color.org)."""
    if os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb":
        return False
    return stream.isatty()


def show_diagnostics(diagnostics: Iterable[Diagnostic], sources: Sources | None = None) -> None:
    """Show diagnostics for people on the error stream, as commands do whose output is something else."""
    found = list(diagnostics)
    sys.stderr.write(render_text(found, sources or Sources(), has_colours(sys.stderr)))


@contextmanager
def shown_warnings() -> Iterator[None]:
    """Show warnings of a running program in this context as all findings are shown, each once."""
    earlier_findings: set[Diagnostic] = set()
    with warnings.catch_warnings():
        as_python = warnings.showwarning

        def show(
            message: Warning | str,
            category: type[Warning],
            filename: str,
            lineno: int,
            file: TextIO | None = None,
            line: str | None = None,
        ) -> None:
            if not isinstance(message, ScenicWarning):
                as_python(message, category, filename, lineno, file, line)
            elif (finding := message.diagnostic()) not in earlier_findings:
                earlier_findings.add(finding)
                show_diagnostics([finding])

        warnings.showwarning = show
        yield


def summary(diagnostics: Iterable[Diagnostic]) -> str:
    """Numbers of diagnostics of each severity, in words."""
    severities = [item.severity for item in diagnostics]
    counts = [(severity.value, severities.count(severity)) for severity in Severity]
    parts = [
        f"{count} {name}{'s' if count > 1 and name != 'information' else ''}"
        for name, count in counts
        if count
    ]
    return ", ".join(parts) or "no problems"
