"""The options of ``scenic simulate``, and the request that they make."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import click

from scenic.cli.batch_parts import SinkPart
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
    with_options,
)
from scenic.dataclass import dataclass

if TYPE_CHECKING:
    from scenic.batch.keeping import Form

__all__ = ["FOLDER", "FORMS", "SimulateRequest", "simulate_options"]

FORMS: Final[Mapping[str, "Form"]] = MappingProxyType(
    {"jsonl": "jsonl", "parquet": "parquet", "openscenario": "xosc", "commonroad": "xml"}
)
"""The endings of trajectory files by the names of their formats."""

FOLDER: Final = SinkPart(
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


simulate_options: Final = with_options(
    batch_options("simulations"),
    first_option("Number of the first one."),
    course_options,
    click.option(
        "--tries",
        metavar="M",
        type=click.IntRange(min=1),
        default=20,
        help="Number of tries before a scene is given up as rejected.  [default: 20]",
    ),
    click.option(
        "--keep",
        type=OneOf(["all", "violations", "none"]),
        default="none",
        show_default=True,
        help="Simulations to keep although they violate a requirement: none (they are rejected and tried again), all, or "
        "violations (then the folder and the page contain only simulations with a violation).",
    ),
    click.option(
        "--table",
        metavar="FILE.csv",
        type=click.Path(path_type=Path),
        help="Write a row for each simulation: verdict, robustness, reason of its end.",
    ),
    click.option(
        "--plot",
        "picture",
        metavar="FILE.svg",
        type=click.Path(path_type=Path),
        help="Draw the robustness of all simulations, for each setting of the parameters, and its mean.",
    ),
    sobol_option,
    click.option(
        "--step-limit",
        metavar="T",
        type=float,
        callback=seconds,
        default=10.0,
        help="Seconds that the program may run within one step.  [default: 10]",
    ),
    swept_program_options,
    extra_params_option,
    click.option("--show-params", is_flag=True, help="Print the parameters of each simulation's scene."),
    click.option("--show-records", is_flag=True, help="Print the records of each simulation."),
    click.option(
        "-o",
        "--output",
        metavar="DIR",
        type=click.Path(path_type=Path),
        help="Keep the trajectories in this folder, which must be new or without simulations.",
    ),
    click.option(
        "--format",
        "form",
        type=OneOf(list(FOLDER.forms)),
        default="jsonl",
        show_default=True,
        help="Format of the trajectories: JSON Lines, columns (extra `parquet`), OpenSCENARIO XML (extra "
        "`openscenario`), or CommonRoad XML.",
    ),
    click.option(
        "--view",
        metavar="PAGE.html",
        type=click.Path(path_type=Path),
        help="Make a page that plays the simulations.",
    ),
)
