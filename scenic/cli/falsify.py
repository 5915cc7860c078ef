"""``scenic falsify``: search for scenes and simulations in which requirements fail."""

import secrets
import shlex
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from scenic.cli.options import (
    OneOf,
    accept_changes_option,
    count_option,
    dask_option,
    jobs_option,
    named_values,
    program_argument,
    resume_option,
    seconds,
    seed_option,
    settings_of,
    simulator_option,
    steps_option,
    swept_program_options,
    timestep_option,
)
from scenic.cli.output import CLEAN
from scenic.cli.running import NOT_ALL, ended_by_signals, engine_of, progress_bar
from scenic.cli.sinks import check_page
from scenic.language.errors import ScenicWarning

if TYPE_CHECKING:
    from scenic.falsification.search import FalsificationResult

__all__ = ["falsify"]

_SHOWN: Final = 12
"""Values of a point that are printed, at most."""

_TIMELESS: Final = (
    "nothing in this program happens over time, so that simulations show no more than its scenes do"
)
_STATIC: Final = "search the scenes alone: --static with --objective PARAMETER or --minimize EXPRESSION"


@click.command()
@program_argument
@count_option("Runs at most.", default=1000)
@click.option(
    "--sampler",
    metavar="NAME",
    default="cma",
    help="random, halton, sobol, grid, ce, mab, eg, sa, cma, tpe or bo.  [default: cma]",
)
@click.option(
    "--sampler-option",
    "sampler_options",
    metavar="NAME=VALUE",
    multiple=True,
    callback=named_values,
    help="An option of the sampler. Repeatable.",
)
@click.option(
    "--objective",
    "objectives",
    metavar="NAME",
    multiple=True,
    help="A requirement, a record or a parameter to minimise. Repeatable.  [default: the least robustness]",
)
@click.option(
    "--minimize",
    "expressions",
    metavar="EXPR",
    multiple=True,
    help="An expression over records, or over parameters, to minimise. Repeatable.",
)
@click.option(
    "--threshold",
    metavar="X",
    type=float,
    default=0.0,
    help="Largest value of a counterexample.  [default: 0]",
)
@click.option(
    "--stop-after", metavar="K", type=click.IntRange(min=1), help="End after this number of counterexamples."
)
@click.option(
    "--time-limit",
    metavar="T",
    type=float,
    callback=seconds,
    help="Seconds after which no new generation of points begins.",
)
@click.option(
    "--space",
    type=OneOf(["auto", "external", "scene"]),
    default="auto",
    show_default=True,
    help="The space to search: external parameters, or all draws of the scene.",
)
@click.option(
    "--batch",
    metavar="B",
    type=click.IntRange(min=1),
    help="Points that the sampler gives at a time.  [default: the sampler's]",
)
@seed_option("Searches")
@click.option("--static", is_flag=True, help="Search scenes alone, without simulations.")
@simulator_option
@steps_option
@timestep_option
@swept_program_options
@jobs_option("Processes.")
@dask_option("Simulate")
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Keep runs and counterexamples in this folder.",
)
@resume_option
@accept_changes_option
@click.option(
    "--report", metavar="PAGE.html", type=click.Path(path_type=Path), help="Make a page about the search."
)
def falsify(
    file: str,
    count: int,
    sampler: str,
    sampler_options: Mapping[str, Any],
    objectives: tuple[str, ...],
    expressions: tuple[str, ...],
    threshold: float,
    stop_after: int | None,
    time_limit: float | None,
    space: str,
    batch: int | None,
    seed: int | None,
    static: bool,
    simulator: str | None,
    max_steps: int,
    timestep: float | None,
    swept: Mapping[str, tuple[Any, ...]],
    scenario: str | None,
    model: str | None,
    mode_2d: bool,
    jobs: int,
    dask: str | None,
    output: Path | None,
    resume: bool,
    accept_changes: bool,
    report: Path | None,
) -> int:
    """Search for scenes and simulations in which requirements fail.

    If FILE is the folder of a search instead of a program, the command makes the report of the search again.

    A run is a counterexample if its value is at most the threshold. The value of a requirement is its robustness.

    If a parameter has several values (-p toys=0,4,16), each value gets a search in a folder of its own.

    Exit codes: 0 counterexamples were found, 1 the program has errors, 2 wrong usage, 3 none was found, 130 interrupted.
    """
    if resume and output is None:
        raise click.UsageError("--resume needs the folder of the search: -o DIR")
    if report is not None:
        check_page(report, "--report")
    if Path(file).is_dir():
        from scenic.falsification.report import load_results

        page = report or Path(file) / "report.html"
        _write_report(load_results(Path(file)), Path(file).name, page)
        print(f"wrote {page}")
        return CLEAN
    from scenic.falsification.objectives import Objective
    from scenic.falsification.search import Limits, Plan, search
    from scenic.falsification.store import SearchFolder, folders_of, manifest_of
    from scenic.formats.files import safe_name
    from scenic.pipeline import load

    if resume and seed is None and output is not None:
        seed = next((int(manifest_of(folder)["seed"]) for folder in folders_of(output)), None)
    settings = settings_of(swept)
    programs = [
        load(Path(file), params=parameters, model=model, scenario=scenario, mode2D=mode_2d)
        for parameters, _ in settings
    ]
    if not static and simulator is None and all(loaded.is_timeless for loaded in programs):
        warnings.warn(ScenicWarning(_TIMELESS, help=_STATIC), stacklevel=2)
    if seed is None:
        seed = secrets.randbits(32)
        sys.stderr.write(f"seed {seed} (the same search again: --seed {seed})\n")
    wanted = [
        *(Objective(name=item) for item in objectives),
        *(Objective(expression=item) for item in expressions),
    ]
    plan = Plan(
        seed,
        sampler,
        sampler_options,
        tuple(wanted) or (Objective(),),
        threshold,
        space,
        batch,
        simulator,
        static,
        max_steps,
        timestep,
    )
    results: dict[str, FalsificationResult] = {}
    with (
        ended_by_signals(),
        progress_bar(count * len(settings), "searching", shown=not sys.stdout.isatty()) as advance,
        engine_of(jobs, dask) as engine,
    ):
        limits = Limits(count, stop_after, time_limit, lambda _row: advance(1, 1))
        for loaded, (_, different) in zip(programs, settings, strict=True):
            label = ", ".join(f"{name}={value}" for name, value in different.items())
            place = output if output is None or not label else output / safe_name(label)
            folder = (
                None
                if place is None
                else SearchFolder(place, plan.settings(loaded), resume=resume, accept_changes=accept_changes)
            )
            results[label] = search(loaded, plan, limits, engine=engine, folder=folder)
            _show(label, results[label])
    if report is not None:
        _write_report(results, Path(file).name, report)
    return CLEAN if any(result.counterexamples for result in results.values()) else NOT_ALL


def _show(label: str, result: "FalsificationResult") -> None:
    """Print the findings of a search; ``label`` distinguishes it from other searches."""
    if label:
        print(f"{label}:")
    share, low, high = result.share()
    print(
        f"{_counted(len(result.rows), 'run')}, {result.evaluated} with a value,"
        f" {_counted(len(result.counterexamples), 'counterexample')}"
    )
    if result.evaluated:
        print(f"share of counterexamples {share:.3g} (95% interval {low:.3g} to {high:.3g})")
    worst = result.best
    if worst is not None:
        print(f"least value {min(map(float, worst['values'])):.6g} in run {worst['run']}")
        for words in result.point(worst)[:_SHOWN]:
            print(f"  {words}")
        if len(worst["point"]) > _SHOWN:
            print(f"  and {len(worst['point']) - _SHOWN} more")
        if result.folder is not None:
            print(f"again: scenic replay {shlex.join([str(result.folder), str(worst['run'])])}")
    if result.is_blind:
        print("all values are plus or minus infinity: nothing guides the search")
    sys.stdout.flush()


def _counted(count: int, thing: str) -> str:
    return f"{count} {thing}{'' if count == 1 else 's'}"


def _write_report(results: "Mapping[str, FalsificationResult]", title: str, page: Path) -> None:
    from scenic.falsification.report import report_page
    from scenic.formats.files import write

    write(page, report_page(results, title, links_from=page.parent).encode())
