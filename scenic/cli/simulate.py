"""``scenic simulate``: simulations of a program, their trajectories, and what became of its requirements."""

import faulthandler
import json
import secrets
import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, closing
from itertools import chain
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import click

from scenic.cli.options import (
    OneOf,
    accept_changes_option,
    count_option,
    dask_option,
    extra_params_option,
    first_option,
    jobs_option,
    program_argument,
    resume_option,
    seconds,
    seed_option,
    settings_of,
    simulator_option,
    sobol_option,
    steps_option,
    swept_program_options,
    timestep_option,
)
from scenic.cli.output import CLEAN, FINDINGS, show_diagnostics
from scenic.cli.running import NOT_ALL, ended_by_signals, engine_of, progress_bar
from scenic.cli.sinks import check_page
from scenic.language.garbage import import_lasting

if TYPE_CHECKING:
    from scenic.batch.keeping import Form
    from scenic.batch.simulations import SimulationRow

__all__ = ["simulate"]


@click.command()
@program_argument
@count_option("How many simulations.")
@first_option("Number of the first one.")
@seed_option("Simulations")
@simulator_option
@steps_option
@timestep_option
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
@jobs_option("Processes.")
@dask_option("Simulate")
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Keep the trajectories in this folder, which must be new or without simulations.",
)
@resume_option
@accept_changes_option
@click.option(
    "--format",
    "form",
    type=OneOf(["jsonl", "parquet", "openscenario", "commonroad"]),
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
def simulate(
    file: str,
    count: int,
    first: int,
    seed: int | None,
    simulator: str | None,
    max_steps: int,
    timestep: float | None,
    tries: int,
    keep: str,
    table: Path | None,
    picture: Path | None,
    sobol: bool,
    step_limit: float,
    swept: Mapping[str, tuple[Any, ...]],
    scenario: str | None,
    model: str | None,
    mode_2d: bool,
    extra_params: bool,
    show_params: bool,
    show_records: bool,
    jobs: int,
    dask: str | None,
    output: Path | None,
    resume: bool,
    accept_changes: bool,
    form: str,
    view: Path | None,
) -> int:
    """Simulate scenes of a program.

    Simulation K of a seed is always the same, whatever the number of processes. Files are complete or absent, so that
    an interrupted run continues with --resume.

    Exit codes: 0 success, 1 the program has errors, 2 wrong usage, 3 some simulations were rejected (the others were
    made), 130 interrupted.
    """
    # These bring in NumPy and the geometry libraries.
    import_lasting("scenic.pipeline")
    from scenic.batch.simulation_folders import seed_of_simulations
    from scenic.batch.simulations import Running, Simulations
    from scenic.batch.summaries import Setting, csv_of, plot, summary
    from scenic.formats.files import safe_name, write
    from scenic.pipeline import load

    # What a library of a simulator does may end the process without a word.
    if not faulthandler.is_enabled() and sys.stderr is sys.__stderr__:
        faulthandler.enable()
    if view is not None:
        check_page(view)
    if form == "parquet":
        from scenic.formats.trajectory_tables import parquet_support

        parquet_support()
    if form == "openscenario":
        from scenic.formats.openscenario import openscenario_support

        openscenario_support()
    if (resume or accept_changes) and output is None:
        raise click.UsageError("--resume needs the folder of the simulations: -o DIR")
    if resume and seed is None and output is not None:
        seed = seed_of_simulations(output)
    is_drawn = seed is None
    seed = secrets.randbits(32) if seed is None else seed
    running = Running(
        seed, max_steps, timestep, tries, step_limit, sobol=sobol, keep_violations=keep != "none"
    )
    numbers = range(first, first + count)
    batches: list[tuple[Setting, Simulations]] = []
    for parameters, different in settings_of(swept):
        setting = Setting({}, different)
        loaded = load(
            Path(file),
            params=parameters,
            model=model,
            scenario=scenario,
            mode2D=mode_2d,
            extra_params=extra_params,
        )
        place = output if output is None or not different else output / safe_name(setting.label)
        batch = Simulations(
            loaded,
            simulator,
            running,
            folder=place,
            form=_FORMS[form],
            shown=view is not None,
            only_violations=keep == "violations",
        )
        batches.append((setting, batch))
    code = CLEAN
    with ExitStack() as folders:
        for setting, batch in batches:
            folders.enter_context(batch.opened(resume=resume, accept_changes=accept_changes))
            setting.rows.update({k: row for k in numbers if (row := batch.known(k)) is not None})
        opened = folders.pop_all()
    if is_drawn:
        sys.stderr.write(f"seed {seed} (the same simulations again: --seed {seed})\n")
    missing = len(batches) * count - sum(len(setting.rows) for setting, _ in batches)
    with (
        opened,
        ended_by_signals(),
        progress_bar(missing, "simulating", shown=not sys.stdout.isatty()) as advance,
        engine_of(jobs, dask) as engine,
    ):
        for setting, batch in batches:
            with closing(batch.rows([k for k in numbers if k not in setting.rows], engine)) as rows:
                if setting.parameters:
                    print(f"{setting.label}:")
                waiting = iter(numbers)
                due = next(waiting, None)
                for row in chain([None], rows):
                    if row is not None:
                        setting.rows[row.k] = row
                        advance(1, 1)
                    # Simulations are told in order, each as soon as those before it are.
                    while due is not None and due in setting.rows:
                        code = max(code, _show(setting.rows[due]))
                        if show_params:
                            _show_params(setting.rows[due])
                        if show_records:
                            _show_records(setting.rows[due])
                        due = next(waiting, None)
                    sys.stdout.flush()
    settings = [setting for setting, _ in batches]
    if len(settings) * count > 1:
        print(_total([row for setting in settings for row in setting.rows.values()], max_steps))
    if keep != "none" or table is not None or len(settings) > 1:
        for setting in settings:
            if len(settings) * count > 1:
                print(summary(setting))
    if table is not None:
        write(table, csv_of(settings).encode())
    if picture is not None:
        write(picture, plot(settings).encode())
    if view is not None:
        from scenic.formats.course_page import course_page

        pages = [setting.rows[k].page for setting in settings for k in numbers]
        made = [page for page in pages if page is not None]
        if made:
            write(view, course_page(Path(file).name, made).encode())
    failed = any(row.error is not None for setting in settings for row in setting.rows.values())
    return FINDINGS if failed else code


_FORMS: Final[Mapping[str, "Form"]] = MappingProxyType(
    {"jsonl": "jsonl", "parquet": "parquet", "openscenario": "xosc", "commonroad": "xml"}
)


def _total(rows: "Sequence[SimulationRow]", max_steps: int) -> str:
    """Return a line that sums up the outcomes of all simulations."""
    made = [row.about for row in rows if row.about is not None]
    late = sum(map(_is_late, made))
    parts = [f"{len(made):,} of {len(rows):,} simulations"]
    if late:
        parts.append(f"{late:,} reached the time limit (--time {max_steps})")
    if rejected := sum(row.missing is not None for row in rows):
        parts.append(f"{rejected:,} rejected")
    if failed := sum(row.error is not None for row in rows):
        parts.append(f"{failed:,} failed")
    return ", ".join(parts)


def _is_late(about: Mapping[str, Any]) -> bool:
    """Return whether the limit of the command ended a simulation, rather than one of the program."""
    return bool(about["reason"] == f"reached time limit ({about['steps']} steps)")


def _show(row: "SimulationRow") -> int:
    """Print the outcome of a simulation; return its exit code."""
    if row.error is not None:
        sys.stderr.write(f"simulation {row.k} failed:\n")
        show_diagnostics([row.error])
        return FINDINGS
    if row.about is None:
        print(f"simulation {row.k}: {row.missing}")
        for reason, times in row.rejections:
            more = "; --time gives more" if "; reached time limit (" in reason else ""
            print(f"  {reason}: {times} {'try' if times == 1 else 'tries'}{more}")
        return NOT_ALL
    more = "; --time gives more" if _is_late(row.about) else ""
    print(f"simulation {row.k}: {row.about['steps']} steps, {row.about['reason']}{more}")
    for item in row.about["requirements"]:
        verdict = "not evaluated" if item["verdict"] is None else item["verdict"].lower().replace("_", " ")
        margin = item["robustness"]
        by = f", robustness {margin:.4g}" if isinstance(margin, float) else ""
        print(f"  {item['label']}: {verdict}{by}")
    return CLEAN


def _show_params(row: "SimulationRow") -> None:
    """Print the parameters of a simulation's scene."""
    for name, value in ({} if row.about is None else row.about.get("params", {})).items():
        print(f"  parameter {name} = {json.dumps(value)}")


def _show_records(row: "SimulationRow") -> None:
    """Print what a simulation has recorded, series step by step."""
    for name, value in ({} if row.about is None else row.about["records"]).items():
        if not _is_series(value):
            print(f"  record {name} = {json.dumps(value)}")
            continue
        print(f"  record {name}:")
        for step, item in value:
            print(f"    {step}: {json.dumps(item)}")


def _is_series(value: Any) -> bool:
    """Return whether a recorded value is a list of steps with what was recorded then."""
    pairs = isinstance(value, list) and all(isinstance(item, list) and len(item) == 2 for item in value)
    return pairs and all(isinstance(step, int) for step, _ in value)
