"""The options of ``scenic simulate``, and the request that they make."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from scenic.cli.batch_parts import SinkPart
from scenic.cli.options import (
    COUNT,
    PATH,
    BatchRequest,
    batch_options,
    course_options,
    extra_params_option,
    first_option,
    option,
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
    option("--tries M", "Number of tries before a scene is given up as rejected.", COUNT, default=20),
    option(
        "--keep",
        "Simulations to keep although they violate a requirement: none (they are rejected and tried again), all, or "
        "violations (then the folder and the page contain only simulations with a violation).",
        ["all", "violations", "none"],
        default="none",
    ),
    option(
        "--table FILE.csv", "Write a row for each simulation: verdict, robustness, reason of its end.", PATH
    ),
    option(
        "--plot picture FILE.svg",
        "Draw the robustness of all simulations, for each setting of the parameters, and its mean.",
        PATH,
    ),
    sobol_option,
    option(
        "--step-limit T",
        "Seconds that the program may run within one step.  [default: 10]",
        float,
        callback=seconds,
        default=10.0,
    ),
    swept_program_options,
    extra_params_option,
    option("--show-params", "Print the parameters of each simulation's scene."),
    option("--show-records", "Print the records of each simulation."),
    option(
        "-o --output DIR",
        "Keep the trajectories in this folder, which must be new or without simulations.",
        PATH,
    ),
    option(
        "--format form",
        "Format of the trajectories: JSON Lines, columns (extra `parquet`), OpenSCENARIO XML (extra "
        "`openscenario`), or CommonRoad XML.",
        list(FOLDER.forms),
        default="jsonl",
    ),
    option("--view PAGE.html", "Make a page that plays the simulations.", PATH),
)
