"""The run of ``scenic simulate``: simulations of a seed for each setting of the parameters, made by an engine, into sinks."""

import json
import secrets
import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, closing
from typing import Any, Final

from scenic.batch.engines import BatchEngine
from scenic.batch.simulation_folders import seed_of_simulations
from scenic.batch.simulations import SimulationRow, Simulations, SimulationSettings, nothing_happens
from scenic.batch.summaries import SettingRuns, csv_of, plot, summary
from scenic.cli.batch_parts import FileSink, places_of, write_files
from scenic.cli.batch_runs import NOT_ALL, Advance, announce_seed, batch_run, find_convex_parts
from scenic.cli.options import settings_of
from scenic.cli.output import CLEAN, FINDINGS, show_diagnostics
from scenic.cli.simulate_options import FORMS, SimulateRequest
from scenic.cli.sinks import check_page
from scenic.formats.course_page import course_page
from scenic.formats.files import safe_name

__all__ = ["simulate_into_sinks"]


def _page(request: SimulateRequest, settings: Sequence[SettingRuns]) -> bytes | None:
    """Return the page that plays all simulations, if there are any."""
    pages = [row.page for setting in settings for row in setting.simulations if row.page is not None]
    return course_page(request.path.name, pages).encode() if pages else None


_FILES: Final = (
    FileSink("table", lambda _, settings: csv_of(settings).encode()),
    FileSink("picture", lambda _, settings: plot(settings).encode()),
    FileSink("view", _page, check_page),
)


def simulate_into_sinks(request: SimulateRequest) -> int:
    """Make the simulations of a request and write them; returns the exit code of the command."""
    places = places_of(request, _FILES)
    _require_libraries(request.form)
    seed = request.seed
    if request.resume and seed is None and request.output is not None:
        seed = seed_of_simulations(request.output)
    chosen_seed = secrets.randbits(32) if seed is None else seed
    batches = _batches(request, chosen_seed)
    settings = [setting for setting, _ in batches]
    numbers = range(request.first, request.first + request.count)
    code = CLEAN
    with ExitStack() as stack:
        for setting, batch in batches:
            stack.enter_context(batch.opened(resume=request.resume, accept_changes=request.accept_changes))
            setting.rows.update({k: row for k in numbers if (row := batch.known(k)) is not None})
        if seed is None:
            announce_seed(chosen_seed, "simulations")
        missing = len(batches) * request.count - sum(len(setting.rows) for setting in settings)
        shows_progress = not sys.stdout.isatty()
        run = batch_run(
            missing, "simulating", jobs=request.jobs, dask=request.dask, shown=shows_progress, places=places
        )
        advance, engine = stack.enter_context(run)
        for setting, batch in batches:
            code = max(code, _simulate(request, setting, batch, engine, advance))
        _show_summaries(request, settings)
        write_files(request, _FILES, request, settings)
    has_failures = any(row.error is not None for setting in settings for row in setting.rows.values())
    return FINDINGS if has_failures else code


def _require_libraries(form: str) -> None:
    """Raise ``MissingLibraryError`` if a format needs a library that is not installed."""
    if form == "parquet":
        from scenic.formats.trajectory_tables import parquet_support

        parquet_support()
    if form == "openscenario":
        from scenic.formats.openscenario import openscenario_support

        openscenario_support()


def _batches(request: SimulateRequest, seed: int) -> list[tuple[SettingRuns, Simulations]]:
    """Return for each setting of the parameters the source of its simulations."""
    running = SimulationSettings(
        seed, request.max_steps, request.timestep, request.tries, request.step_limit,
        sobol=request.sobol, keep_violations=request.keep != "none",
    )  # fmt: skip
    batches = []
    for parameters, different in settings_of(request.swept):
        setting = SettingRuns({}, different)
        scenario = request.load(parameters, request.simulator, extra_params=request.extra_params)
        place = request.output
        if place is not None and different:
            place /= safe_name(setting.label)
        batch = Simulations(
            scenario, request.simulator, running, folder=place, form=FORMS[request.form],
            shown=request.view is not None, only_violations=request.keep == "violations",
        )  # fmt: skip
        batches.append((setting, batch))
        if getattr(batch.simulator, "touches_with_parts", False):
            find_convex_parts(scenario)
        idle = nothing_happens(scenario, batch.simulator) if len(batches) == 1 else None
        show_diagnostics([] if idle is None else [idle])
    return batches


def _simulate(
    request: SimulateRequest,
    setting: SettingRuns,
    batch: Simulations,
    engine: BatchEngine | None,
    advance: Advance,
) -> int:
    """Make the missing simulations of a setting, and print all in order, each as soon as those before it are there."""
    numbers = iter(range(request.first, request.first + request.count))
    missing = [k for k in range(request.first, request.first + request.count) if k not in setting.rows]
    if setting.parameters:
        print(f"{setting.label}:")
    code, due, is_explained = CLEAN, next(numbers, None), False
    with closing(batch.rows(missing, engine)) as rows:
        while due is not None:
            if due not in setting.rows:
                row = next(rows)
                setting.rows[row.k] = row
                advance(1, 1)
                continue
            row = setting.rows[due]
            code = max(code, _show(row))
            if row.exhausted is not None and not is_explained:
                # The other scenes are missing for the same reasons.
                print(row.exhausted.message())
                is_explained = True
            if request.show_params:
                _show_params(setting.rows[due])
            if request.show_records:
                _show_records(setting.rows[due])
            sys.stdout.flush()
            due = next(numbers, None)
    return code


def _show_summaries(request: SimulateRequest, settings: Sequence[SettingRuns]) -> None:
    """Print the outcomes of all simulations together, where there are several."""
    if len(settings) * request.count < 2:
        return
    print(_total([row for setting in settings for row in setting.rows.values()], request.max_steps))
    if request.keep != "none" or request.table is not None or len(settings) > 1:
        for setting in settings:
            print(summary(setting))


def _total(rows: "Sequence[SimulationRow]", max_steps: int) -> str:
    """Return a line that sums up the outcomes of all simulations."""
    documents = [row.about for row in rows if row.about is not None]
    late = sum(map(_is_late, documents))
    parts = [f"{len(documents):,} of {len(rows):,} simulations"]
    if late:
        parts.append(f"{late:,} reached the time limit (--time {max_steps})")
    if rejection_count := sum(row.missing is not None for row in rows):
        parts.append(f"{rejection_count:,} rejected")
    if failure_count := sum(row.error is not None for row in rows):
        parts.append(f"{failure_count:,} failed")
    return ", ".join(parts)


def _is_late(about: Mapping[str, object]) -> bool:
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
    _show_notes(row.about)
    return CLEAN


_NOTES: Final = 5
"""Notes of a simulation that are printed; its file contains all."""


def _show_notes(about: Mapping[str, Any]) -> None:
    """Print what was noted of objects, such as why a car stands."""
    notes = about.get("notes", ())
    for note in notes[:_NOTES]:
        thing = about["objects"][note["object"]]
        name = thing["name"] or f"{thing['class']} {note['object']}"
        print(f"  {name} at {note['step'] * about['timestep']:.1f} s: {note['text']}")
    if len(notes) > _NOTES:
        print(f"  and {len(notes) - _NOTES} more notes, which files of --format json contain")


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
