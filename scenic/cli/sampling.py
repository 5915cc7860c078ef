"""The run of ``scenic sample``: scenes of a source, made by an engine, into sinks."""

import secrets
import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from scenic.batch.engines import BatchEngine
from scenic.batch.folders.file_digests import digest_of_files, file_digests
from scenic.batch.folders.lock import locked
from scenic.batch.scenes import Job, in_processes, method_of, results_of
from scenic.cli import sinks
from scenic.cli.batch_runs import announce_seed, batch_run
from scenic.cli.output import has_colours
from scenic.cli.sample_options import SampleRequest
from scenic.cli.sample_parts import SINKS, sink_parts
from scenic.dataclass import dataclass
from scenic.formats.files import OutputError
from scenic.formats.growing import GrowingFile
from scenic.formats.json_lines import SceneLines
from scenic.formats.resuming import check_remade, continued
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

    from scenic.batch.manifest import Manifest
    from scenic.runtime.scenes.scene import Scene

__all__ = ["sample_into_sinks"]


_HINT: Final = (
    "still looking for the first scene: few candidates meet all requirements. `--approximate` moves single objects instead, which "
    "finds scenes of crowds in far less time; `scenic analyze` says which requirement costs most"
)
"""The words that are printed where scenes take long."""


@dataclass(slots=True)
class _Batch:
    """The scenes of a request: a source and an engine.

    Attributes:
        scenario: the program.
        request: the options.
        seed: the seed of the scenes.
        deadline: a time of `time.monotonic`.
        engine: where scenes are made; this process if ``None``.
        advance: called with how many more scenes are done, and their candidates.
        missing: scenes that were not found so far.
        lost: number of scenes that the run which goes on did not find.

    """

    scenario: Scenario
    request: SampleRequest
    seed: int
    deadline: float | None
    engine: BatchEngine | None = None
    advance: Callable[[int, int], None] = lambda _scenes, _attempts: None
    missing: list[Exhausted] = field(default_factory=list)
    lost: int = 0

    def job(self, done: int = 0) -> Job:
        """Return the job of the scenes after the first ``done``."""
        request = self.request
        first, last = request.first + done, request.first + request.count
        method = method_of(request.points)
        return Job(self.seed, first, last, request.max_attempts, self.deadline, **method)

    def scenes(self, done: int = 0) -> "Iterator[Scene]":
        """Yield the scenes after the first ``done``, made in this process; others are recorded as missing."""
        request = self.request
        if request.sampler is None:
            results = results_of(self.scenario, self.job(done))
        else:
            from scenic.falsification.objectives import Objective
            from scenic.falsification.sampling import sampled_by

            objective = None if request.minimized is None else Objective(expression=request.minimized)
            results = sampled_by(
                self.scenario, request.sampler, request.count, seed=self.seed, objective=objective
            )
        for result in results:
            if isinstance(result, Exhausted):
                self.missing.append(result)
            else:
                yield result
            self.advance(1, result.attempts)

    def line(self, k: int, lines: SceneLines) -> bytes | None:
        """Return the line of one scene; ``None`` if it is not found."""
        job = replace(self.job(), first=k, last=k + 1)
        (result,) = results_of(self.scenario, job)
        return None if isinstance(result, Exhausted) else lines.encoded(result)

    def manifest(self, form: str, part_size: int) -> "Manifest":
        """The manifest of a data set of these scenes."""
        from scenic.batch.manifest import Manifest

        request = self.request
        images = {
            "cameras": list(dict.fromkeys(request.cameras)),
            "size": request.image_size and list(request.image_size),
            "overlay": request.overlay,
        }
        return Manifest.of(
            self.scenario,
            seed=self.seed,
            first=request.first,
            count=request.count,
            form=form,
            part_size=part_size,
            points=request.points,
            max_attempts=request.max_attempts,
            properties=request.properties,
            images=images if request.cameras else None,
            command=shlex.join(["scenic", *sys.argv[1:]]),
        )


def sample_into_sinks(
    scenario: Scenario, request: SampleRequest, chosen: "list[sinks.Sink]", deadline: float | None
) -> tuple[list[Exhausted], int]:
    """Make the scenes of a request and write them; returns those that were not found, and how many an earlier run did not find.

    Args:
        scenario: the program.
        request: the options, which fit together.
        chosen: sinks that take scenes one by one.
        deadline: a time of `time.monotonic` after which scenes are not looked for.

    """
    names = sink_parts(request)
    place = Path(request.output or "-")
    target = place if "lines" in names else None
    folder = place if names.keys() & {"dataset", "worlds", "labels"} else None
    growing_file = None if target is None else GrowingFile(target, resume=request.resume)
    to_terminal = "output" in names and sys.stdout.isatty()
    with ExitStack() as stack:
        _lock_files(stack, request, place if names.keys() & {"lines", "files"} else None)
        seed, form, part_size = _as_before(request, folder)
        files, done_count = digest_of_files(file_digests(scenario)), 0
        if growing_file is not None and request.resume:
            files_to_compare = None if request.accept_changes else files
            first, count, points = request.first, request.count, request.points
            seed, done_count = continued(
                growing_file, scenario.digest, seed, first, count, points=points, files=files_to_compare
            )
        chosen_seed = secrets.randbits(32) if seed is None else seed
        if seed is None:
            announce_seed(chosen_seed, "scenes")
        batch = _Batch(scenario, request, chosen_seed, deadline)
        lines = SceneLines(
            (request.path.name, scenario.digest),
            changed=request.properties == "changed",
            points=request.points,
            folder=Path.cwd() if target is None else target.parent,
            files=files,
        )
        if growing_file is not None and done_count:
            batch.lost = done_count - len(growing_file.kept())
            if not request.accept_changes:
                check_remade(growing_file, files, lambda k: batch.line(k, lines))
        stack.enter_context(_kept_is_reported(growing_file, folder, request.count))
        takers = [stack.enter_context(sink) for sink in chosen]
        put = _to_output if growing_file is None else stack.enter_context(growing_file).write
        batch.advance, batch.engine = stack.enter_context(
            batch_run(
                request.count,
                "sampling",
                jobs=request.jobs,
                dask=request.dask,
                shown=not to_terminal,
                hint=None if request.approximate else _HINT,
            )
        )
        batch.advance(done_count, 0)
        if folder is not None:
            _write_folder(batch, folder, form, part_size)
        elif "table" in names:
            _write_table(batch, place)
        elif not names.keys() & {"output", "lines"}:
            _give(batch, done_count, takers)
        elif to_terminal:
            _show_tables(batch, takers)
        else:
            _write_lines(batch, done_count, lines, put, takers)
    return batch.missing, batch.lost


def _write_table(batch: _Batch, target: Path) -> None:
    from scenic.batch.datasets import DatasetRun, write_table

    run = DatasetRun(batch.engine, batch.deadline, batch.advance)
    batch.missing.extend(write_table(batch.scenario, target, batch.manifest("parquet", 65536), run).missing)


def _lock_files(stack: ExitStack, request: SampleRequest, output: Path | None) -> None:
    """Keep other commands from the files of a request, of which ``output`` is the one that ``-o`` names."""
    for place in (output, request.view):
        if place is not None:
            stack.enter_context(locked(Path(place)))
    if request.png is not None:
        image = Path(request.png)
        stack.enter_context(locked(image, is_folder=image.suffix.lower() != ".png"))


def _as_before(request: SampleRequest, folder: Path | None) -> tuple[int | None, str, int]:
    """Seed, form and size of the parts of a data set, by default those of the data set that is resumed."""
    from scenic.batch.folders.folder import NAME

    seed, form, part_size = request.seed, request.form, request.part_size
    if folder is not None and request.resume and (folder / NAME).exists():
        from scenic.batch.manifest import Manifest

        earlier = Manifest.load(folder)
        seed = earlier.seed if seed is None else seed
        if form is None and bool(request.cameras) == (earlier.images is not None):
            form = earlier.form
        part_size = earlier.part_size if part_size is None else part_size
    default = SINKS["labels" if request.cameras else "dataset"].forms[0]
    return seed, form or default, part_size or (512 if request.cameras else 65536)


def _write_folder(batch: _Batch, folder: Path, form: str, part_size: int) -> None:
    from scenic.batch.datasets import DatasetRun, Resuming, make_dataset

    request = batch.request
    run = DatasetRun(batch.engine, batch.deadline, batch.advance)
    resume = Resuming(request.verified, request.accept_changes) if request.resume else False
    outcome = make_dataset(batch.scenario, folder, batch.manifest(form, part_size), run, resume=resume)
    batch.missing.extend(outcome.missing)
    lost_numbers = {k for part in outcome.manifest.parts for k in part.missing}
    batch.lost = len(lost_numbers.difference(item.k for item in outcome.missing))
    if skip_count := sum(part.skipped for part in outcome.manifest.parts):
        sys.stderr.write(
            f"{skip_count:,} images are not there: their camera's object does not take part in the scene\n"
        )


def _write_lines(
    batch: _Batch,
    done: int,
    lines: SceneLines,
    put: "Callable[[ReadableBuffer], object]",
    takers: "list[sinks.Take]",
) -> None:
    """Write the lines of the scenes after the first ``done``; other processes make them where there are any."""
    if batch.engine is None or batch.request.count - done < 2:
        is_output = put is _to_output
        _give(batch, done, [*takers, lambda scene: put(lines.encoded(scene))], is_output=is_output)
        return
    for block in in_processes(batch.scenario, lines.block, batch.job(done), batch.engine):
        put(block.encoded)
        batch.missing.extend(block.missing)
        batch.advance(block.job.last - block.job.first, block.attempts)


def _give(batch: _Batch, done: int, takers: "list[sinks.Take]", *, is_output: bool = False) -> None:
    """Give the scenes after the first ``done`` to sinks; parameters go beside standard output if this has the scenes."""
    for scene in batch.scenes(done):
        if batch.request.show_params:
            stream = sys.stderr if is_output else sys.stdout
            stream.write(f"scene {scene.k}:\n")
            stream.writelines(f"  {name} = {value}\n" for name, value in scene.params.items())
        for take in takers:
            take(scene)


def _show_tables(batch: _Batch, takers: "list[sinks.Take]") -> None:
    """Print scenes as tables, and the ways to save them."""
    from rich.console import Console

    from scenic.cli.render.scene_listing import render_scene

    console = Console(no_color=not has_colours(sys.stdout), highlight=False)
    for scene in batch.scenes():
        for take in takers:
            take(scene)
        render_scene(scene, console)
    console.print("save scenes with -o scenes.jsonl, look at them with --view page.html", style="dim")


@contextmanager
def _kept_is_reported(grown: GrowingFile | None, folder: Path | None, count: int) -> Iterator[None]:
    """Print, when a run is interrupted, the number of kept scenes and the way to continue."""
    try:
        yield
    except KeyboardInterrupt:
        from scenic.batch.datasets import scenes_kept

        place = folder if grown is None else grown.part
        scene_count = (
            len(grown.lines_kept()) if grown is not None else 0 if folder is None else scenes_kept(folder)
        )
        if scene_count:
            sys.stderr.write(f"{scene_count:,} of {count:,} kept in '{place}'; continue with --resume\n")
        raise


def _to_output(lines: "ReadableBuffer") -> None:
    try:
        sys.stdout.write(str(lines, "ascii"))
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(f"cannot write to the standard output: {reason}") from error
