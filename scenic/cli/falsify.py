"""``scenic falsify``: search for scenes and simulations in which requirements fail."""

import secrets
import shlex
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from scenic.cli.batch_parts import FileSink, SinkPart, check_parts, places_of, write_files
from scenic.cli.batch_runs import NOT_ALL, announce_seed, batch_run
from scenic.cli.options import (
    COUNT,
    PATH,
    BatchRequest,
    batch_options,
    course_options,
    named_values,
    option,
    seconds,
    settings_of,
    swept_program_options,
)
from scenic.cli.output import CLEAN
from scenic.cli.sinks import check_page
from scenic.dataclass import dataclass
from scenic.formats.files import safe_name, write
from scenic.language.errors import ScenicWarning

if TYPE_CHECKING:
    from scenic.falsification.search import FalsificationResult, SearchPlan
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["falsify"]

_SHOWN: Final = 12
"""Values of a point that are printed, at most."""

_TIMELESS: Final = (
    "nothing in this program happens over time, so that simulations show no more than its scenes do"
)
_STATIC: Final = "search the scenes alone: --static with --objective PARAMETER or --minimize EXPRESSION"

_SCREEN: Final = SinkPart("standard output")
_FOLDER: Final = SinkPart("folders of searches (-o DIR)", frozenset({"resume", "accept_changes"}))


@dataclass(frozen=True, slots=True)
class _FalsifyRequest(BatchRequest):
    """The values of the options, as the command takes them."""

    sampler: str
    sampler_options: Mapping[str, Any]
    objectives: tuple[str, ...]
    expressions: tuple[str, ...]
    threshold: float
    stop_after: int | None
    time_limit: float | None
    space: str
    batch: int | None
    static: bool
    simulator: str | None
    max_steps: int
    timestep: float | None
    swept: Mapping[str, tuple[Any, ...]]
    output: Path | None
    report: Path | None

    def plan(self, seed: int) -> "SearchPlan":
        """The plan of the search for each setting of the parameters."""
        from scenic.falsification.objectives import Objective
        from scenic.falsification.search import SearchPlan

        objectives = [
            *(Objective(name=item) for item in self.objectives),
            *(Objective(expression=item) for item in self.expressions),
        ]
        return SearchPlan(
            seed, self.sampler, self.sampler_options, tuple(objectives) or (Objective(),), self.threshold, self.space,
            self.batch, self.simulator, self.static, self.max_steps, self.timestep,
        )  # fmt: skip


def _report(page: Path, title: str, results: "Mapping[str, FalsificationResult]") -> bytes:
    from scenic.falsification.search_page import report_page

    return report_page(results, title, links_from=page.parent).encode()


_FILES: Final = (FileSink("report", _report, lambda page: check_page(page, "--report")),)


@click.command()
@batch_options("runs", count=1000)
@option("--sampler NAME", "random, halton, sobol, grid, ce, mab, eg, sa, cma, tpe or bo.", default="cma")
@option(
    "--sampler-option sampler_options NAME=VALUE",
    "An option of the sampler. Repeatable.",
    multiple=True,
    callback=named_values,
)
@option(
    "--objective objectives NAME",
    "A requirement, a record or a parameter to minimise. Repeatable.  [default: the least robustness]",
    multiple=True,
)
@option(
    "--minimize expressions EXPR",
    "An expression over records, or over parameters, to minimise. Repeatable.",
    multiple=True,
)
@option("--threshold X", "Largest value of a counterexample.  [default: 0]", float, default=0.0)
@option("--stop-after K", "End after this number of counterexamples.", COUNT)
@option("--time-limit T", "Seconds after which no new generation of points begins.", float, callback=seconds)
@option(
    "--space",
    "The space to search: external parameters, or all draws of the scene; auto: the former if there are any, else all draws on which "
    "something depends, so not colours.",
    ["auto", "external", "scene"],
    default="auto",
)
@option("--batch B", "Points that the sampler gives at a time.  [default: the sampler's]", COUNT)
@option("--static", "Search scenes alone, without simulations.")
@course_options
@swept_program_options
@option("-o --output DIR", "Keep runs and counterexamples in this folder.", PATH)
@option("--report PAGE.html", "Make a page about the search.", PATH)
def falsify(**options: Any) -> int:
    """Search for scenes and simulations in which requirements fail.

    If FILE is the folder of a search instead of a program, the command makes the report of the search again.

    A run is a counterexample if its value is at most the threshold. The value of a requirement is its robustness.

    If a parameter has several values (-p toys=0,4,16), each value gets a search in a folder of its own.

    Exit codes: 0 counterexamples were found, 1 the program has errors, 2 wrong usage, 3 none was found, 130 interrupted.
    """
    request = _FalsifyRequest(**options)
    check_parts([_SCREEN, *([_FOLDER] if request.output is not None else [])], [_SCREEN, _FOLDER])
    places = places_of(request, _FILES)
    if request.path.is_dir():
        return _report_again(request)
    from scenic.falsification.search_folder import folders_of, manifest_of

    seed, output = request.seed, request.output
    if request.resume and seed is None and output is not None:
        seed = next((int(manifest_of(folder)["seed"]) for folder in folders_of(output)), None)
    programs = [
        (
            request.load(parameters, request.simulator),
            ", ".join(f"{name}={value}" for name, value in different.items()),
        )
        for parameters, different in settings_of(request.swept)
    ]
    if not request.static and request.simulator is None and all(item.is_timeless for item, _ in programs):
        warnings.warn(ScenicWarning(_TIMELESS, help=_STATIC), stacklevel=2)
    search_seed = secrets.randbits(32) if seed is None else seed
    if seed is None:
        announce_seed(search_seed, "search")
    results = _search(request, request.plan(search_seed), programs, places)
    return CLEAN if any(result.counterexamples for result in results.values()) else NOT_ALL


def _report_again(request: _FalsifyRequest) -> int:
    """Make the report of a search in a folder once more."""
    from scenic.falsification.search_page import load_results

    page = request.report or request.path / "report.html"
    write(page, _report(page, request.path.name, load_results(request.path)))
    print(f"wrote {page}")
    return CLEAN


def _search(
    request: _FalsifyRequest, plan: "SearchPlan", programs: "list[tuple[Scenario, str]]", places: list[Path]
) -> "dict[str, FalsificationResult]":
    """Search each program, and write what is wanted; returns the results by the labels of the programs."""
    from scenic.falsification.search import SearchLimits, search
    from scenic.falsification.search_folder import SearchFolder

    results: dict[str, FalsificationResult] = {}
    with batch_run(
        request.count * len(programs), "searching",
        jobs=request.jobs, dask=request.dask, shown=not sys.stdout.isatty(), places=places,
    ) as (advance, engine):  # fmt: skip
        limits = SearchLimits(
            request.count, request.stop_after, request.time_limit, lambda _row: advance(1, 1)
        )
        for scenario, label in programs:
            folder = None
            if request.output is not None:
                folder = SearchFolder(
                    request.output / safe_name(label) if label else request.output, plan.settings(scenario),
                    resume=request.resume, accept_changes=request.accept_changes,
                )  # fmt: skip
            results[label] = search(scenario, plan, limits, engine=engine, folder=folder)
            _show(label, results[label])
        write_files(request, _FILES, request.report, request.path.name, results)
    return results


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
