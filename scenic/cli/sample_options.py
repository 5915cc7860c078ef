"""The options of ``scenic sample``, and the request that they make."""

import math
from collections.abc import Mapping
from typing import Any, Final

import click

from scenic.cli.batch_parts import forms_help, output_help
from scenic.cli.options import (
    COUNT,
    POSITIVE,
    BatchRequest,
    batch_options,
    extra_params_option,
    first_option,
    image_size_option,
    look_from_option,
    option,
    program_options,
    seconds,
    sobol_option,
    with_options,
)
from scenic.cli.sample_parts import SINKS
from scenic.dataclass import dataclass

__all__ = ["SampleRequest", "sample_options"]

_SECONDS: Final = 3.0
"""Length of the simulation of ``--settle keep``."""


def _settling(
    _context: click.Context, _option: click.Parameter, given: str | None
) -> tuple[float, bool] | None:
    """Seconds of the simulation, and whether settled poses are kept."""
    if given is None:
        return None
    way, colon, number = (
        given.rpartition(":") if given not in ("keep", "reject") else (given, ":", str(_SECONDS))
    )
    try:
        length = float(number)
    except ValueError:
        length = 0.0
    if not 0 < length < math.inf or (way, colon) not in _WAYS:
        raise click.BadParameter(
            f"{given!r} is neither a positive number of seconds nor keep:SECONDS; for example: --settle 2, --settle keep:2"
        )
    return length, way == "keep"


_WAYS: Final = (("", ""), ("keep", ":"), ("reject", ":"))
sample_options: Final = with_options(
    batch_options("scenes"),
    first_option("Number of the first scene; -n scenes from there on."),
    option(
        "--verify verified",
        "With --resume: compare the content of a data set's parts with their digests, and make changed ones again.",
    ),
    option(
        "--properties",
        "Properties of objects to write in JSON Lines: all, or only properties that the program gives.",
        ["all", "changed"],
        default="all",
    ),
    sobol_option,
    option(
        "--approximate N",
        "For requirements that are hardly ever met: make N scenes together. The larger N, the closer their "
        "distribution is to the program's.",
        click.IntRange(min=2),
    ),
    program_options,
    extra_params_option,
    option(
        "--settle T|keep:T",
        "Reject scenes in which an object moves within T seconds of physics (MuJoCo). With keep:T (keep: 3 seconds) scenes "
        "have the poses after that time instead.",
        callback=_settling,
    ),
    option(
        "--settle-tolerance M",
        "With --settle: the distance in metres that is not yet moving; turning by 5 degrees is.",
        POSITIVE,
        default=0.01,
    ),
    option(
        "--no-prune", "Do not narrow the distributions first. The distribution of the scenes is the same."
    ),
    option("--max-attempts M", "Give up a scene after this number of candidates.", COUNT),
    option("--time-limit T", "Stop after this number of seconds.", float, callback=seconds),
    option("-o --output OUT", f"Where the scenes go, by the ending: {output_help(SINKS.values())}"),
    option(
        "--format form",
        f"Format of the files of a folder: {forms_help(SINKS.values())}",
        [form for sink in SINKS.values() for form in sink.forms],
    ),
    option("--part-size N", "Scenes in each part of a data set.  [default: 65536, with --camera 512]", COUNT),
    option(
        "--sampler NAME",
        "Let a sampler of `scenic falsify` (halton, grid, cma, ...) choose the external parameters, else all draws.",
    ),
    option(
        "--minimize minimized EXPR",
        "With --sampler: an expression over parameters, `ego` and `objects` that learning samplers minimise.",
    ),
    option("--view PAGE.html", "Make a page in which the scenes can be turned and stepped through."),
    option("--png PATH", "Make an image of each scene: in this folder, or at this name with .png."),
    option(
        "--camera cameras NAME",
        "Make a data set of labelled images, as the sensor of this name sees them, or the object of a variable; "
        "several cameras share one data set.",
        multiple=True,
    ),
    option("--overlay", "With --camera: make images with the labels drawn into them, too."),
    option(
        "--image-size WxH",
        "Columns and rows of the images.  [default: 960x720; a sensor's own]",
        callback=image_size_option,
    ),
    look_from_option("--png"),
    option(
        "--frame",
        "The contents that --png fits into the image: the workspace, so that all scenes are seen alike, or the "
        "objects.",
        ["workspace", "objects"],
        default="workspace",
    ),
    option(
        "--show-params",
        "Print the parameters of each scene, on the error stream if the scenes go to standard output.",
    ),
    option(
        "--profile", "Show the time of sampling by operation, line and requirement, instead of the scenes."
    ),
)


@dataclass(frozen=True, slots=True)
class SampleRequest(BatchRequest):
    """The values of the options, as the command takes them."""

    first: int
    verified: bool
    properties: str
    sobol: bool
    approximate: int | None
    parameters: Mapping[str, Any]
    extra_params: bool
    settle: tuple[float, bool] | None
    settle_tolerance: float
    no_prune: bool
    max_attempts: int | None
    time_limit: float | None
    output: str | None
    form: str | None
    part_size: int | None
    sampler: str | None
    minimized: str | None
    view: str | None
    png: str | None
    cameras: tuple[str, ...]
    overlay: bool
    image_size: tuple[int, int] | None
    outlook: Mapping[str, float]
    frame: str
    show_params: bool
    profile: bool

    @property
    def points(self) -> str | None:
        """The way in which scenes are made, as manifests name it."""
        return (
            "sobol" if self.sobol else None if self.approximate is None else f"approximate {self.approximate}"
        )
