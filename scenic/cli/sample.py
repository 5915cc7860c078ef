"""``scenic sample``: scenes from a program, as text, 3D files, a page or images."""

import secrets
import shlex
import signal
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, Final

import click

from scenic.cli import sinks
from scenic.cli.options import (
    OneOf,
    count_option,
    dask_option,
    extra_params_option,
    first_option,
    image_size_option,
    jobs_option,
    look_from_option,
    program_argument,
    program_options,
    seconds,
    seed_option,
    sobol_option,
)
from scenic.cli.output import CLEAN, has_colours
from scenic.cli.running import NOT_ALL, ended_by_signals, engine_of, progress_bar
from scenic.formats.files import OutputError
from scenic.formats.growing import GrowingFile
from scenic.language.errors import Located
from scenic.language.garbage import import_lasting

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

    from scenic.runtime.scenes.scenario import Scenario
    from scenic.runtime.scenes.scene import Scene


__all__ = ["sample"]


@click.command()
@program_argument
@count_option("How many scenes.")
@first_option("Number of the first scene; -n scenes from there on.")
@jobs_option("Make JSON Lines in so many processes. The scenes and their order are the same.")
@click.option(
    "--resume",
    is_flag=True,
    help="Continue the JSON Lines of an interrupted run: OUT.part, or OUT with fewer scenes.",
)
@click.option(
    "--properties",
    type=OneOf(["all", "changed"]),
    default="all",
    show_default=True,
    help="Properties of objects to write in JSON Lines: all, or only properties that the program gives.",
)
@seed_option("Scenes")
@sobol_option
@click.option(
    "--approximate",
    metavar="N",
    type=click.IntRange(min=2),
    help="For requirements that are hardly ever met: make N scenes together. The larger N, the closer their "
    "distribution is to the program's.",
)
@program_options
@extra_params_option
@click.option(
    "--settle",
    metavar="T",
    type=float,
    callback=seconds,
    help="Reject scenes in which an object moves within this number of seconds of physics (MuJoCo).",
)
@click.option(
    "--settle-tolerance",
    metavar="M",
    type=click.FloatRange(min=0, min_open=True),
    default=0.01,
    show_default=True,
    help="With --settle: the distance in metres that is not yet moving; turning by 5 degrees is.",
)
@click.option(
    "--no-prune",
    is_flag=True,
    help="Do not narrow the distributions first. The distribution of the scenes is the same.",
)
@click.option(
    "--max-attempts",
    metavar="M",
    type=click.IntRange(min=1),
    help="Give up a scene after this number of candidates.",
)
@click.option(
    "--time-limit", metavar="T", type=float, callback=seconds, help="Stop after this number of seconds."
)
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help="JSON Lines to this file, columns if OUT ends in .parquet, a file for each scene if it ends in .glb, .obj, .wbt, .usda, .usdc, .usdz, .xml (MJCF) or .sdf, a data "
    "set of many files if it ends in / or is a folder; - is standard output, which is the default without --view and --png.",
)
@click.option(
    "--format",
    "form",
    type=OneOf(["parquet", "jsonl", "images", "tar", "usd", "mjcf", "sdf"]),
    help="Format of the files of a data set: parquet or jsonl; usd, mjcf or sdf for a file of each scene with shared meshes; with --camera images, or tar for shards.  [default: the first]",
)
@click.option(
    "--part-size",
    metavar="N",
    type=click.IntRange(min=1),
    help="Scenes in each part of a data set.  [default: 65536, with --camera 512]",
)
@dask_option("Sample")
@click.option(
    "--sampler",
    metavar="NAME",
    help="Let a sampler of `scenic falsify` (halton, grid, cma, ...) choose the external parameters, else all draws.",
)
@click.option(
    "--minimize",
    "minimized",
    metavar="EXPR",
    help="With --sampler: an expression over parameters, `ego` and `objects` that learning samplers minimise.",
)
@click.option(
    "--view", metavar="PAGE.html", help="Make a page in which the scenes can be turned and stepped through."
)
@click.option(
    "--png", metavar="PATH", help="Make an image of each scene: in this folder, or at this name with .png."
)
@click.option(
    "--camera",
    "cameras",
    metavar="NAME",
    multiple=True,
    help="Make a data set of labelled images, as the sensor of this name sees them, or the object of a variable; "
    "several cameras share one data set.",
)
@click.option(
    "--overlay", is_flag=True, help="With --camera: make images with the labels drawn into them, too."
)
@click.option(
    "--image-size",
    metavar="WxH",
    callback=image_size_option,
    help="Columns and rows of the images.  [default: 960x720; a sensor's own]",
)
@look_from_option("--png")
@click.option(
    "--frame",
    type=OneOf(["workspace", "objects"]),
    default="workspace",
    help="The contents that --png fits into the image: the workspace, so that all scenes are seen alike, or the "
    "objects.",
    show_default=True,
)
@click.option(
    "--show-params",
    is_flag=True,
    help="Print the parameters of each scene, on the error stream if the scenes go to standard output.",
)
@click.option(
    "--profile",
    is_flag=True,
    help="Show the time of sampling by operation, line and requirement, instead of the scenes.",
)
def sample(
    file: str,
    count: int,
    first: int,
    jobs: int,
    resume: bool,
    properties: str,
    seed: int | None,
    sobol: bool,
    approximate: int | None,
    parameters: Mapping[str, Any],
    scenario: str | None,
    model: str | None,
    mode_2d: bool,
    extra_params: bool,
    settle: float | None,
    settle_tolerance: float,
    no_prune: bool,
    max_attempts: int | None,
    time_limit: float | None,
    output: str | None,
    form: str | None,
    part_size: int | None,
    dask: str | None,
    sampler: str | None,
    minimized: str | None,
    view: str | None,
    png: str | None,
    cameras: tuple[str, ...],
    overlay: bool,
    image_size: tuple[int, int] | None,
    outlook: Mapping[str, float],
    frame: str,
    show_params: bool,
    profile: bool,
) -> int:
    """Sample scenes from a program.

    On a terminal scenes are shown as tables, elsewhere as JSON Lines. Files for several scenes are numbered: room-000.glb,
    room-001.glb, ... Files are complete or absent; an interrupted run keeps its scenes in OUT.part.

    Exit codes: 0 success, 1 the program has errors, 2 wrong usage (also a file that cannot be read or written, and an
    unknown parameter), 3 some scenes were not found within the limits (the others are written), 130 interrupted.
    """
    path = Path(file)
    if profile and (
        resume or jobs > 1 or any(item is not None for item in (output, view, png, dask)) or cameras
    ):
        raise click.UsageError(
            "--profile makes no files: it goes without -o, -j, --dask, --resume and images"
        )
    if approximate is not None and (
        resume or jobs > 1 or dask is not None or sobol or profile or time_limit is not None
    ):
        raise click.UsageError(
            "--approximate goes without -j, --dask, --resume, --sobol, --profile and --time-limit"
        )
    chosen: list[sinks.Sink] = []
    target: Path | None = None
    dataset: Path | None = None
    table: Path | None = None
    # All of them are checked before anything is sampled.
    if cameras:
        if output is None:
            raise click.UsageError("--camera needs a folder for its images: -o FOLDER")
        dataset = Path(output)
        sinks.check_labelled(dataset)
    elif output is not None or (view is None and png is None):
        named = Path(output or "-")
        if sinks.is_dataset(output):
            dataset = named
        elif sinks.is_table(named):
            table = named
        elif sinks.is_lines(named):
            sinks.check_lines(named)
            target = named
        else:
            chosen.append(sinks.scene_file(named, count, first))
    if view is not None:
        chosen.append(sinks.page(Path(view), path.name))
    if png is not None:
        chosen.append(
            sinks.images(
                Path(png),
                path.stem,
                count,
                image_size,
                {**outlook, "workspace": frame == "workspace"},
                first,
            )
        )
    if chosen and (jobs > 1 or resume or dask is not None or dataset is not None or table is not None):
        raise click.UsageError(
            "-j, --dask, --resume, --camera, data sets and Parquet go without --view, --png and 3D files"
        )
    if resume and (target == sinks.STANDARD_OUTPUT or (target is None and dataset is None)):
        raise click.UsageError("--resume needs a file or a data set to go on with: -o OUT.jsonl, -o FOLDER/")
    if show_params and (jobs > 1 or dask is not None or dataset is not None or table is not None or profile):
        raise click.UsageError("--show-params goes without -j, --dask, --profile, data sets and Parquet")
    if form is not None and dataset is None:
        raise click.UsageError("--format is for data sets: -o FOLDER/")
    if form is not None and (not cameras) != (form not in ("images", "tar")):
        raise click.UsageError("--format images and tar go with --camera, the others without it")
    if form is not None and dataset is not None and not cameras:
        sinks.check_files(form)
    if overlay and not cameras:
        raise click.UsageError("--overlay draws into the images of a camera: --camera NAME")
    if form is None:
        form = "images" if cameras else "parquet"
    if part_size is None:
        part_size = 512 if cameras else 65536
    if minimized is not None and sampler is None:
        raise click.UsageError("--minimize needs a sampler that learns: --sampler cma")
    if sampler is not None and (
        jobs > 1 or resume or sobol or first or profile or dask or dataset is not None or table is not None
    ):
        raise click.UsageError(
            "--sampler goes without -j, --dask, --resume, --first, --sobol, --profile, data sets and Parquet"
        )
    grown = None if target in (None, sinks.STANDARD_OUTPUT) else GrowingFile(target, resume=resume)
    deadline = None if time_limit is None else time.monotonic() + time_limit

    # These bring in NumPy and the geometry libraries.
    import_lasting("scenic.pipeline")
    from scenic.batch import scenes as batches
    from scenic.formats.json_lines import SceneLines
    from scenic.formats.resuming import continued
    from scenic.pipeline import load
    from scenic.runtime.sampling.report import Exhausted

    with _limited(
        time_limit,
        f"'{path}' was still being run when the time limit of {time_limit or 0:g} s was over",
        "give it more time, or look for a loop without end at the top of the program",
    ):
        loaded = load(
            path,
            params=parameters,
            model=model,
            scenario=scenario,
            mode2D=mode_2d,
            prune=not no_prune,
            extra_params=extra_params,
            settle=settle,
            settle_tolerance=settle_tolerance,
        )
    if any("texture" in thing.__dict__ for thing in loaded.objects):
        from scenic.batch.source_files import check_textures, warn_of_textures

        (
            check_textures
            if cameras or png is not None or form in ("usd", "mjcf", "sdf")
            else warn_of_textures
        )(loaded)
    if profile:
        return _profiled(loaded, first, count, seed or 0, sobol, max_attempts, deadline)
    done = 0
    points = "sobol" if sobol else None if approximate is None else f"approximate {approximate}"
    if dataset is not None and resume:
        from scenic.batch.manifest import Manifest

        seed = Manifest.load(dataset).seed if seed is None else seed
    if grown is not None and resume:
        seed, done = continued(grown, loaded.digest, seed, first, count, points=points)
    if seed is None:
        seed = secrets.randbits(32)
        sys.stderr.write(f"seed {seed} (the same scenes again: --seed {seed})\n")
    place = Path.cwd() if target in (None, sinks.STANDARD_OUTPUT) else target.parent
    lines = SceneLines(
        (path.name, loaded.digest), changed=properties == "changed", points=points, folder=place
    )
    job = batches.Job(seed, first + done, first + count, max_attempts, deadline, **batches.method_of(points))
    if sampler is None:
        results = batches.results_of(loaded, job)
    else:
        from scenic.falsification.objectives import Objective
        from scenic.falsification.sampling import sampled_by

        objective = None if minimized is None else Objective(expression=minimized)
        results = sampled_by(loaded, sampler, count, seed=seed, objective=objective)
    missing: list[Exhausted] = []
    to_terminal = target == sinks.STANDARD_OUTPUT and sys.stdout.isatty()
    shown = _Shown() if to_terminal else None
    left = None if deadline is None else max(0.0, deadline - time.monotonic()) + PATIENCE
    endless = _limited(
        left,
        f"a candidate was still being evaluated {PATIENCE:g} s after the time limit of {time_limit or 0:g} s",
        "look for a loop without end in what is called on samples",
    )
    with _told_what_is_kept(grown, dataset, count), ended_by_signals(), endless, ExitStack() as stack:
        takers = [stack.enter_context(sink) for sink in chosen]
        put = _to_output if grown is None else stack.enter_context(grown).write
        engine = stack.enter_context(engine_of(jobs, dask))
        advance = stack.enter_context(progress_bar(count, "sampling", shown=not to_terminal))
        advance(done, 0)
        if dataset is not None or table is not None:
            from scenic.batch.datasets import Run, make_dataset, write_table
            from scenic.batch.manifest import Manifest

            run = Run(engine, deadline, advance)
            manifest = Manifest.of(
                loaded,
                seed=seed,
                first=first,
                count=count,
                form=form,
                part_size=part_size,
                points=points,
                max_attempts=max_attempts,
                properties=properties,
                images={
                    "cameras": list(dict.fromkeys(cameras)),
                    "size": image_size and list(image_size),
                    "overlay": overlay,
                }
                if cameras
                else None,
                command=shlex.join(["scenic", *sys.argv[1:]]),
            )
            if dataset is not None:
                finished = make_dataset(loaded, dataset, manifest, run, resume=resume)
            else:
                assert table is not None
                finished = write_table(loaded, table, manifest, run)
            missing.extend(finished.missing)
        elif engine is not None and count - done > 1 and shown is None:
            for made in batches.in_processes(loaded, lines.block, job, engine):
                put(made.encoded)
                missing.extend(made.missing)
                advance(made.job.last - made.job.first, made.attempts)
        else:
            for result in results:
                if isinstance(result, Exhausted):
                    missing.append(result)
                else:
                    for take in takers:
                        take(result)
                    if show_params and shown is None:
                        told = sys.stderr if target == sinks.STANDARD_OUTPUT else sys.stdout
                        told.write(f"scene {result.k}:\n")
                        told.writelines(f"  {name} = {value}\n" for name, value in result.params.items())
                    if shown is not None:
                        shown.show(result)
                    elif target is not None:
                        put(lines.encoded(result))
                advance(1, result.attempts)
    if shown is not None:
        shown.finish()
    if settle is not None and loaded.program.settling.tally.scenes:
        sys.stderr.write(f"settling: {loaded.program.settling.tally}\n")
    if loaded.approximation is not None:
        sys.stderr.write(f"{loaded.approximation}\n")
    if missing:
        from rich.console import Console

        from scenic.cli.render.rejections import render_missing

        render_missing(
            missing, Console(file=sys.stderr, no_color=not has_colours(sys.stderr), highlight=False)
        )
        return NOT_ALL
    return CLEAN


def _profiled(
    loaded: "Scenario",
    first: int,
    count: int,
    seed: int,
    sobol: bool,
    max_attempts: int | None,
    deadline: float | None,
) -> int:
    """Show where the time of sampling goes."""
    from rich.console import Console

    from scenic.cli.render.profiles import render_profile
    from scenic.graph.points import Sobol

    found = loaded.profile(
        count,
        seed=seed,
        first=first,
        max_attempts=max_attempts,
        time_limit=None if deadline is None else max(0.0, deadline - time.monotonic()),
        source=Sobol() if sobol else None,
    )
    render_profile(found, Console(no_color=not has_colours(sys.stdout), highlight=False))
    return CLEAN if found.scenes == count else NOT_ALL


@contextmanager
def _told_what_is_kept(grown: GrowingFile | None, dataset: Path | None, count: int) -> Iterator[None]:
    """Print, when a run is interrupted, the number of kept scenes and the way to continue."""
    try:
        yield
    except KeyboardInterrupt:
        kept = 0 if grown is None else len(grown.lines_kept())
        if grown is not None and kept:
            sys.stderr.write(f"{kept:,} of {count:,} kept in '{grown.part}'; continue with --resume\n")
        if dataset is not None:
            from scenic.batch.datasets import scenes_kept

            if kept := scenes_kept(dataset):
                sys.stderr.write(f"{kept:,} of {count:,} kept in '{dataset}'; continue with --resume\n")
        raise


class _Shown:
    """Scenes as tables on a terminal."""

    def __init__(self) -> None:
        from rich.console import Console

        self._console = Console(no_color=not has_colours(sys.stdout), highlight=False)

    def show(self, scene: "Scene") -> None:
        """Print the parameters and objects of a scene."""
        from scenic.cli.render.scenes import render_scene

        render_scene(scene, self._console)

    def finish(self) -> None:
        """Say how to save scenes."""
        self._console.print(
            "save scenes with -o scenes.jsonl, look at them with --view page.html", style="dim"
        )


PATIENCE: Final = 10.0
"""Seconds after the time limit until candidates under way are given up; the engine itself looks at the time between rounds."""


def _to_output(lines: "ReadableBuffer") -> None:
    try:
        sys.stdout.write(str(lines, "ascii"))
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(f"cannot write to the standard output: {reason}") from error


@contextmanager
def _limited(seconds: float | None, what: str, help: str) -> Iterator[None]:
    """Ends Python code of a program that runs longer than a number of seconds, if the system supports it.

    Raises `TimeLimitError` with the place that was reached; ``what`` says what was done for too long.
    """
    if seconds is None or not hasattr(signal, "setitimer"):
        yield
        return

    def end(_number: int, frame: FrameType | None) -> None:
        from scenic.compiler.tracebacks import locate

        raise _TimeIsOver(None if frame is None else locate(frame))

    try:
        before = signal.signal(signal.SIGALRM, end)
    except ValueError:  # not in the main thread
        yield
        return
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    except _TimeIsOver as over:
        (place,) = over.args
        raise TimeLimitError(
            what,
            span=None if place is None else place.span,
            filename=None if place is None else place.filename,
            help=help,
        ) from None
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


class _TimeIsOver(BaseException):
    """Raised wherever the program is; no exception that it catches."""


class TimeLimitError(Located):
    """A program that runs longer than the time limit."""

    code = "SC608"
