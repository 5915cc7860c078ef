"""``scenic simulate``: simulations of a program, their trajectories, and what became of its requirements."""

import faulthandler
import sys
from typing import Any, Final

import click

from scenic.cli.batch_parts import SinkPart, check_parts
from scenic.cli.simulate_options import FOLDER, SimulateRequest, simulate_options
from scenic.language.garbage import import_lasting

__all__ = ["simulate"]

_SCREEN: Final = SinkPart("standard output")


@click.command()
@simulate_options
def simulate(**options: Any) -> int:
    """Simulate scenes of a program.

    Simulation K of a seed is always the same, whatever the number of processes. Files are complete or absent, so that
    an interrupted run continues with --resume.

    Exit codes: 0 success, 1 the program has errors, 2 wrong usage, 3 some simulations were rejected (the others were
    made), 130 interrupted.
    """
    request = SimulateRequest(**options)
    check_parts([_SCREEN, *([FOLDER] if request.output is not None else [])], [_SCREEN, FOLDER])
    # These bring in NumPy and the geometry libraries.
    import_lasting("scenic.pipeline")
    from scenic.cli.simulating import simulate_into_sinks

    # What a library of a simulator does may end the process without a word.
    if not faulthandler.is_enabled() and sys.stderr is sys.__stderr__:
        faulthandler.enable()
    return simulate_into_sinks(request)
