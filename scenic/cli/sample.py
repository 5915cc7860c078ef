"""``scenic sample``: scenes from a program, as text, 3D files, a page or images."""

import sys
import time
from typing import TYPE_CHECKING, Any

import click

from scenic.cli import sinks
from scenic.cli.batch_runs import NOT_ALL
from scenic.cli.output import CLEAN, has_colours
from scenic.cli.sample_options import SampleRequest, sample_options
from scenic.cli.sample_parts import check_sample, sink_parts
from scenic.cli.time_limit import PATIENCE, limited
from scenic.language.garbage import import_lasting

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["sample"]


@click.command()
@sample_options
def sample(**options: Any) -> int:
    """Sample scenes from a program.

    On a terminal scenes are shown as tables, elsewhere as JSON Lines. Files for several scenes are numbered: room-000.glb,
    room-001.glb, ... Files are complete or absent; an interrupted run keeps its scenes in OUT.part.

    Exit codes: 0 success, 1 the program has errors, 2 wrong usage (also a file that cannot be read or written, and an
    unknown parameter), 3 some scenes were not found within the limits (the others are written), 130 interrupted.
    """
    request = SampleRequest(**options)
    check_sample(request)
    takers = _takers(request)
    limit = request.time_limit
    deadline = None if limit is None else time.monotonic() + limit
    # These bring in NumPy and the geometry libraries.
    import_lasting("scenic.pipeline")

    with limited(
        limit,
        f"'{request.path}' was still being run when the time limit of {limit or 0:g} s was over",
        "give it more time, or look for a loop without end at the top of the program",
    ):
        scenario = _loaded(request)
    if request.profile:
        return _profiled(scenario, request, deadline)
    if request.settle is not None or request.form in ("mjcf", "sdf"):
        from scenic.cli.batch_runs import find_convex_parts

        find_convex_parts(scenario)
    from scenic.cli.sampling import sample_into_sinks

    endless = limited(
        None if deadline is None else max(0.0, deadline - time.monotonic()) + PATIENCE,
        f"a candidate was still being evaluated {PATIENCE:g} s after the time limit of {limit or 0:g} s",
        "look for a loop without end in what is called on samples",
    )
    with endless:
        missing, lost_count = sample_into_sinks(scenario, request, takers, deadline)
    if request.settle is not None and scenario.program.settling.tally.scenes:
        sys.stderr.write(f"settling: {scenario.program.settling.tally}\n")
    if scenario.approximation is not None:
        sys.stderr.write(f"{scenario.approximation}\n")
    if lost_count:
        sys.stderr.write(
            f"scenes that the earlier run did not find, and that are not looked for again: {lost_count:,}\n"
        )
    if not missing:
        return NOT_ALL if lost_count else CLEAN
    from rich.console import Console

    from scenic.cli.render.rejections import render_missing

    render_missing(missing, Console(file=sys.stderr, no_color=not has_colours(sys.stderr), highlight=False))
    return NOT_ALL


def _takers(request: SampleRequest) -> "list[sinks.Sink]":
    """Return the sinks that take scenes one by one; all outputs are checked before anything is sampled."""
    parts = sink_parts(request).values()
    for part in parts:
        part.check(request)
    return [part.taker(request) for part in parts if part.taker is not None]


def _loaded(request: SampleRequest) -> "Scenario":
    """Load the program, and read its textures if there will be pictures."""
    scenario = request.load(
        request.parameters,
        prune=not request.no_prune,
        extra_params=request.extra_params,
        settle=None if request.settle is None else request.settle[0],
        settle_tolerance=request.settle_tolerance,
        settle_keep=request.settle is not None and request.settle[1],
    )
    if any("texture" in thing.__dict__ for thing in scenario.objects):
        from scenic.batch.source_files import check_textures, warn_of_textures

        is_seen = bool(sink_parts(request).keys() & {"labels", "images", "worlds"})
        (check_textures if is_seen else warn_of_textures)(scenario)
    return scenario


def _profiled(scenario: "Scenario", request: SampleRequest, deadline: float | None) -> int:
    """Show where the time of sampling goes."""
    from rich.console import Console

    from scenic.cli.render.profiles import render_profile
    from scenic.graph.points import Sobol

    profile = scenario.profile(
        request.count,
        seed=request.seed or 0,
        first=request.first,
        max_attempts=request.max_attempts,
        time_limit=None if deadline is None else max(1e-3, deadline - time.monotonic()),
        source=Sobol() if request.sobol else None,
    )
    render_profile(profile, Console(no_color=not has_colours(sys.stdout), highlight=False))
    return CLEAN if profile.scenes == request.count else NOT_ALL
