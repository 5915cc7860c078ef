"""``scenic try``: the phase that programs reach, all their diagnostics, a scene and a simulation, as one answer each."""

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

import click

from scenic.cli.discovery import STANDARD_INPUT, discover
from scenic.cli.options import COUNT, NATURAL, POSITIVE, OneOf, option, program_options, seed_option
from scenic.cli.output import has_colours
from scenic.configuration.project import PLAIN, Configurations
from scenic.language.errors import ScenicError
from scenic.language.source import Source, read_source

__all__ = ["EXIT_CODES", "try_command"]

EXIT_CODES: Final[Mapping[str, int]] = MappingProxyType(
    {"parse": 11, "check": 12, "load": 13, "sample": 14, "simulate": 15}
)
"""Exit codes by the phase that fails; of several programs the smallest counts."""


@click.command("try")
@click.argument("paths", nargs=-1, required=True, metavar="FILE...", type=click.Path())
@click.option(
    "--json",
    "form",
    type=OneOf(["object", "lines"]),
    is_flag=False,
    flag_value="object",
    help="Print one JSON object, or with `--json lines` one object a line for each program.",
)
@option(
    "--schema",
    "Print the JSON schema of an answer, and end.",
    is_eager=True,
    expose_value=False,
    callback=lambda context, _option, wanted: _show_schema(context, wanted),
)
@seed_option("The scene and the simulation")
@program_options
@option("--simulate steps N", "Simulate N steps of the scene.", NATURAL, default=0)
@option("--png FILE.png", "Draw the scene; of several, into this folder.")
@option("-n scenes N", "Sample N scenes of each program.", COUNT, default=1)
@option("--moments FILE.png", "With --simulate and one program: draw moments of the simulation.")
@option("--candidates M", "Candidates for the scene.", COUNT, default=2000)
@option("--seconds T", "Seconds for each program.", POSITIVE, default=20.0)
@option("--memory MB", "Megabytes of address space for each program.", click.IntRange(min=256), default=4096)
@option("--stdin-filename NAME", "Name of the program of standard input.", default="program.scenic")
@option("-j --jobs N", "Try programs in N processes.", COUNT, default=1)
def try_command(
    paths: tuple[str, ...],
    form: str | None,
    seed: int | None,
    parameters: Mapping[str, object],
    model: str | None,
    scenario: str | None,
    mode_2d: bool,
    steps: int,
    png: str | None,
    scenes: int,
    moments: str | None,
    candidates: int,
    seconds: float,
    memory: int,
    stdin_filename: str,
    jobs: int,
) -> int:
    """Parse, check, load and sample programs, and report the phase that each reaches with all diagnostics.

    FILE is a program, a folder of programs, or - for standard input. Programs run in a process of their own, within the limits.

    Exit codes: 0 all phases succeed; otherwise the first phase that fails: 11 parse, 12 check, 13 load, 14 sample, 15 simulate;
    2 wrong usage.
    """
    from scenic.trying.answer import Limits, Trial
    from scenic.trying.trial_processes import tried

    files = discover(paths, Configurations(PLAIN)).files
    if form == "object" and len(files) > 1:
        raise click.UsageError("--json prints one object for one program; several need `--json lines`")
    if moments is not None and (len(files) > 1 or not steps):
        raise click.UsageError("--moments draws the simulation of one program: give --simulate N")
    limits = Limits(candidates, seconds, memory << 20)
    trials = [
        Trial(
            source.text, source.filename, dict(parameters), model, scenario, mode_2d, seed or 0, steps,
            None if png is None else _picture(png, source.filename, len(files)), scenes, moments, limits,
        )
        for source in (_read(file, stdin_filename) for file in files)
    ]  # fmt: skip
    code = 0
    for trial, report in zip(trials, tried(trials, jobs), strict=True):
        if not report["ok"]:
            failure_code = EXIT_CODES[report["phase"]]
            code = failure_code if code == 0 else min(code, failure_code)
        _write(report, Source(trial.text, trial.filename), form)
    return code


def _show_schema(context: click.Context, wanted: bool) -> None:
    if not wanted or context.resilient_parsing:
        return
    from scenic.trying.schema import SCHEMA

    click.echo(json.dumps(SCHEMA, indent=2))
    context.exit()


def _read(file: str, stdin_filename: str) -> Source:
    if file != STANDARD_INPUT:
        return read_source(file)
    data = sys.stdin.buffer.read()
    try:
        return Source(Source.decode(data, stdin_filename), stdin_filename)
    except ScenicError as error:
        error.filename = error.filename or stdin_filename
        raise


def _picture(png: str, filename: str, programs: int) -> str:
    if programs == 1:
        return png
    folder = Path(png)
    folder.mkdir(parents=True, exist_ok=True)
    return str(folder / f"{Path(filename).stem}.png")


def _write(report: Mapping[str, object], source: Source, form: str | None) -> None:
    """Write a report on standard output: as JSON of a form, or for readers."""
    if form is None:
        _show(report, source)
    else:
        print(json.dumps(report, indent=2 if form == "object" else None, ensure_ascii=False), flush=True)


def _show(found: Mapping[str, object], source: Source) -> None:
    """Print an answer for people."""
    from rich.console import Console

    from scenic.cli.render import Sources
    from scenic.cli.render.text_format import render_text
    from scenic.cli.render.trials import diagnostics_of, render_trial

    diagnostics = diagnostics_of(found)
    if diagnostics:
        sys.stdout.write(render_text(diagnostics, Sources([source]), has_colours(sys.stdout)))
    render_trial(
        found,
        os.path.relpath(source.filename),
        Console(no_color=not has_colours(sys.stdout), highlight=False),
    )
