"""``scenic sample``: scenes from a program, as text, 3D files, a page or images."""

import json
import math
import re
import secrets
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import FrameType, MappingProxyType
from typing import Any, Final

import click

from scenic.cli import sinks
from scenic.cli.output import CLEAN, has_colours

__all__ = ["NOT_ALL", "parameter_value", "sample"]

NOT_ALL: Final = 3
"""Exit code: some scenes were not found within the limits."""

_INTEGER: Final = re.compile(r"[+-]?\d+")
_REAL: Final = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_MOST_PIXELS: Final = 16384
_WORDS: Final = MappingProxyType({"true": True, "True": True, "false": False, "False": False})


def parameter_value(text: str) -> int | float | bool | str:
    """A parameter's value as it is meant: an integer, a real number, true or false, or else text.

    Text that would be read as one of these can be quoted as in JSON: ``"5"``.
    """
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text) and len(text) < 1000:
        return int(text)
    if _REAL.fullmatch(text):
        return float(text)
    if len(text) >= 2 and text[0] == text[-1] == '"':
        try:
            value = json.loads(text)
        except ValueError:
            return text
        if isinstance(value, str):
            return value
    return text


def _parameters(_context: click.Context, _option: click.Parameter, given: tuple[str, ...]) -> dict[str, Any]:
    parameters = {}
    for item in given:
        name, equals, value = item.partition("=")
        if not equals or not name:
            raise click.BadParameter(f"{item!r} is not of the form NAME=VALUE")
        parameters[name] = parameter_value(value)
    return parameters


def _seconds(_context: click.Context, _option: click.Parameter, given: float | None) -> float | None:
    if given is not None and not (math.isfinite(given) and given > 0):
        raise click.BadParameter("the time must be a positive number of seconds")
    return given


def _image_size(
    _context: click.Context, _option: click.Parameter, given: str | None
) -> tuple[int, int] | None:
    if given is None:
        return None
    match = re.fullmatch(r"(\d{1,5})[xX](\d{1,5})", given)
    if match is None or not all(1 <= int(part) <= _MOST_PIXELS for part in match.groups()):
        raise click.BadParameter(
            f"{given!r} is not of the form WIDTHxHEIGHT, in pixels up to {_MOST_PIXELS}: 640x480"
        )
    return int(match[1]), int(match[2])


def _outlook(_context: click.Context, _option: click.Parameter, given: str | None) -> Mapping[str, float]:
    if given is None:
        return {}
    if given == "above":
        return {"azimuth": 0.0, "elevation": 90.0}
    try:
        azimuth, elevation = (float(part) for part in given.split(","))
    except ValueError:
        azimuth = elevation = math.nan
    if not (math.isfinite(azimuth) and -89.9 <= elevation <= 90):
        raise click.BadParameter(
            f"{given!r} is neither 'above' nor AZIMUTH,ELEVATION in degrees, such as -35,33"
        )
    return {"azimuth": azimuth, "elevation": elevation}


@click.command()
@click.argument("file", metavar="FILE")
@click.option(
    "-n", "count", metavar="N", type=click.IntRange(min=1), default=1, help="How many scenes.  [default: 1]"
)
@click.option(
    "--seed",
    metavar="S",
    type=int,
    help="Scenes of one seed are always the same. Without it, one is drawn and shown.",
)
@click.option(
    "-p",
    "--param",
    "parameters",
    metavar="NAME=VALUE",
    multiple=True,
    callback=_parameters,
    help="A value for a global parameter: a number, true, false, or text. Repeatable.",
)
@click.option("--scenario", metavar="NAME", help="Which scenario of the file, where it defines several.")
@click.option("--model", metavar="MODULE", help="A world model to use in place of the program's.")
@click.option("--2d", "mode_2d", is_flag=True, help="Use the 2D compatibility mode.")
@click.option(
    "--no-prune", is_flag=True, help="Do not narrow the distributions first. The same scenes are as likely."
)
@click.option(
    "--max-attempts",
    metavar="M",
    type=click.IntRange(min=1),
    help="Give a scene up after so many candidates.",
)
@click.option("--time-limit", metavar="T", type=float, callback=_seconds, help="Stop after so many seconds.")
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help="JSON Lines to this file, or a 3D file for each scene if OUT ends in .glb; - is standard output, which is "
    "the default without --view and --png.",
)
@click.option(
    "--view", metavar="PAGE.html", help="Make a page in which the scenes can be turned and stepped through."
)
@click.option(
    "--png", metavar="PATH", help="Make an image of each scene: in this folder, or at this name with .png."
)
@click.option(
    "--camera",
    metavar="NAME",
    help="Make labelled images in the folder OUT: what the sensor of this name sees, or the object of a variable.",
)
@click.option(
    "--image-size",
    metavar="WxH",
    callback=_image_size,
    help="Columns and rows of the images.  [default: 960x720; a sensor's own]",
)
@click.option(
    "--look-from",
    "outlook",
    metavar="AZ,EL",
    callback=_outlook,
    help="Where --png looks from: degrees east of south and above the horizon, or 'above'.  [default: -35,33]",
)
@click.option(
    "--frame",
    type=click.Choice(["workspace", "objects"]),
    default="workspace",
    help="What --png shows whole: the workspace, so that all scenes are seen alike, or the objects.",
    show_default=True,
)
def sample(
    file: str,
    count: int,
    seed: int | None,
    parameters: Mapping[str, Any],
    scenario: str | None,
    model: str | None,
    mode_2d: bool,
    no_prune: bool,
    max_attempts: int | None,
    time_limit: float | None,
    output: str | None,
    view: str | None,
    png: str | None,
    camera: str | None,
    image_size: tuple[int, int] | None,
    outlook: Mapping[str, float],
    frame: str,
) -> int:
    """Sample scenes from a program.

    Files for several scenes are numbered: room-000.glb, room-001.glb, ... Files are complete or absent.

    Exit codes: 0 success, 1 the program has errors, 2 wrong usage (also a file that cannot be read or written, and an
    unknown parameter), 3 some scenes were not found within the limits (the others are written), 130 interrupted.
    """
    path = Path(file)
    chosen: list[sinks.Sink] = []
    # All of them are checked before anything is sampled.
    if camera is not None:
        if output is None:
            raise click.UsageError("--camera needs a folder for its images: -o FOLDER")
        chosen.append(sinks.labelled(Path(output), camera, image_size))
    elif output is not None or (view is None and png is None):
        chosen.append(sinks.scene_file(Path(output or "-"), count))
    if view is not None:
        chosen.append(sinks.page(Path(view), path.name))
    if png is not None:
        chosen.append(
            sinks.images(
                Path(png), path.stem, count, image_size, {**outlook, "workspace": frame == "workspace"}
            )
        )

    # These bring in NumPy and the geometry libraries.
    from scenic.pipeline import load
    from scenic.runtime.sampling.report import Exhausted

    loaded = load(path, params=parameters, model=model, scenario=scenario, mode2D=mode_2d, prune=not no_prune)
    if seed is None:
        seed = secrets.randbits(32)
        sys.stderr.write(f"seed {seed} (the same scenes again: --seed {seed})\n")
    results = loaded.stream(count, seed=seed, max_attempts=max_attempts, time_limit=time_limit)
    missing = []
    to_terminal = output in (None, "-") and view is None and png is None and sys.stdout.isatty()
    with _ended_by_signals(), ExitStack() as stack:
        takers = [stack.enter_context(sink) for sink in chosen]
        advance = stack.enter_context(_progress(count, shown=not to_terminal))
        for result in results:
            if isinstance(result, Exhausted):
                missing.append(result)
            else:
                for take in takers:
                    take(result)
            advance()
    if missing:
        from rich.console import Console

        from scenic.cli.render.rejections import render_missing

        render_missing(
            missing, Console(file=sys.stderr, no_color=not has_colours(sys.stderr), highlight=False)
        )
        return NOT_ALL
    return CLEAN


@contextmanager
def _progress(count: int, *, shown: bool) -> Iterator[Callable[[], None]]:
    """A progress bar on the error stream if that is a terminal."""
    if not (shown and sys.stderr.isatty()):
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("sampling"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    console = Console(file=sys.stderr, no_color=not has_colours(sys.stderr))
    with Progress(*columns, console=console, transient=True, redirect_stdout=False) as progress:
        task = progress.add_task("sampling", total=count)
        yield lambda: progress.advance(task)


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Makes a polite request to end (SIGTERM) leave no half-written file behind, as Ctrl-C does not."""

    def end(number: int, _frame: FrameType | None) -> None:
        raise SystemExit(128 + number)

    try:
        before = signal.signal(signal.SIGTERM, end)
    except ValueError:  # not in the main thread, where nobody can be interrupted
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
