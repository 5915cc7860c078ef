"""``scenic simulate``: simulations of a program, their trajectories, and what became of its requirements."""

import faulthandler
import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import click

from scenic.cli.batch_parts import SinkPart, check_parts
from scenic.cli.options import (
    BatchRequest,
    OneOf,
    batch_options,
    course_options,
    extra_params_option,
    first_option,
    seconds,
    sobol_option,
    swept_program_options,
)
from scenic.dataclass import dataclass
from scenic.language.garbage import import_lasting

if TYPE_CHECKING:
    from scenic.batch.keeping import Form

__all__ = ["FORMS", "SimulateRequest", "simulate"]

FORMS: Final[Mapping[str, "Form"]] = MappingProxyType(
    {"jsonl": "jsonl", "parquet": "parquet", "openscenario": "xosc", "commonroad": "xml"}
)
"""The endings of trajectory files by the names of their formats."""

_SCREEN: Final = SinkPart("standard output")
_FOLDER: Final = SinkPart(
    "folders of simulations (-o DIR)",
    frozenset({"resume", "accept_changes", "form"}),
    forms=tuple(FORMS),
)


@dataclass(frozen=True, slots=True)
class SimulateRequest(BatchRequest):
    """The values of the options, as the command takes them."""

    first: int
    simulator: str | None
    max_steps: int
    timestep: float | None
    tries: int
    keep: str
    table: Path | None
    picture: Path | None
    sobol: bool
    step_limit: float
    swept: Mapping[str, tuple[Any, ...]]
    extra_params: bool
    show_params: bool
    show_records: bool
    output: Path | None
    form: str
    view: Path | None


@click.command()
@batch_options("simulations")
@first_option("Number of the first one.")
@course_options
@click.option(
    "--tries",
    metavar="M",
    type=click.IntRange(min=1),
    default=20,
    help="Number of tries before a scene is given up as rejected.  [default: 20]",
)
@click.option(
    "--keep",
    type=OneOf(["all", "violations", "none"]),
    default="none",
    show_default=True,
    help="Simulations to keep although they violate a requirement: none (they are rejected and tried again), all, or "
    "violations (then the folder and the page contain only simulations with a violation).",
)
@click.option(
    "--table",
    metavar="FILE.csv",
    type=click.Path(path_type=Path),
    help="Write a row for each simulation: verdict, robustness, reason of its end.",
)
@click.option(
    "--plot",
    "picture",
    metavar="FILE.svg",
    type=click.Path(path_type=Path),
    help="Draw the robustness of all simulations, for each setting of the parameters, and its mean.",
)
@sobol_option
@click.option(
    "--step-limit",
    metavar="T",
    type=float,
    callback=seconds,
    default=10.0,
    help="Seconds that the program may run within one step.  [default: 10]",
)
@swept_program_options
@extra_params_option
@click.option("--show-params", is_flag=True, help="Print the parameters of each simulation's scene.")
@click.option("--show-records", is_flag=True, help="Print the records of each simulation.")
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Keep the trajectories in this folder, which must be new or without simulations.",
)
@click.option(
    "--format",
    "form",
    type=OneOf(list(_FOLDER.forms)),
    default="jsonl",
    show_default=True,
    help="Format of the trajectories: JSON Lines, columns (extra `parquet`), OpenSCENARIO XML (extra "
    "`openscenario`), or CommonRoad XML.",
)
@click.option(
    "--view",
    metavar="PAGE.html",
    type=click.Path(path_type=Path),
    help="Make a page that plays the simulations.",
)
def simulate(**options: Any) -> int:
    """Simulate scenes of a program.

    Simulation K of a seed is always the same, whatever the number of processes. Files are complete or absent, so that
    an interrupted run continues with --resume.

    Exit codes: 0 success, 1 the program has errors, 2 wrong usage, 3 some simulations were rejected (the others were
    made), 130 interrupted.
    """
    request = SimulateRequest(**options)
    check_parts([_SCREEN, *([_FOLDER] if request.output is not None else [])], [_SCREEN, _FOLDER])
    # These bring in NumPy and the geometry libraries.
    import_lasting("scenic.pipeline")
    from scenic.cli.simulating import simulate_into_sinks

    # What a library of a simulator does may end the process without a word.
    if not faulthandler.is_enabled() and sys.stderr is sys.__stderr__:
        faulthandler.enable()
    return simulate_into_sinks(request)
