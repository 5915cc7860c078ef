"""``scenic view``: a page, 3D files or images of scenes that `scenic sample` has written as JSON Lines."""

import sys
import threading
import webbrowser
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from itertools import chain, islice
from pathlib import Path
from typing import Final

import click

from scenic.cli import sinks
from scenic.cli.options import COUNT, NATURAL, image_size_option, look_from_option, option, program_argument
from scenic.cli.output import CLEAN
from scenic.formats.reading import ReadScene, SceneFileError, read_scenes, scenes_of

__all__ = ["view"]

_STANDARD_INPUT: Final = "-"
_SHOWN: Final = 4
"""Scenes on the page of a program that is watched."""
_PAGES: Final = frozenset({".html", ".htm"})


@click.command()
@program_argument
@option(
    "-o --output outputs OUT",
    "The output, by its ending: one page of all scenes (.html), or a file for each scene: .glb, .obj or "
    ".png; any other name is a folder for images. Repeatable.  [default: a page beside SCENES.jsonl]",
    multiple=True,
)
@option("--first K", "Omit scenes with k less than this.", NATURAL, default=0)
@option("-n count N", "The largest number of scenes.  [default: all]", COUNT)
@option("--image-size WxH", "Columns and rows of the images.  [default: 960x720]", callback=image_size_option)
@look_from_option()
@option(
    "--watch",
    "FILE is a program: show new scenes in the browser whenever it is saved. Runs the program each time.",
)
@option("--seed S", "Seed of the scenes of --watch.", int, default=0)
@option("--no-browser", "With --watch: only show the address, open no browser.")
def view(
    file: str,
    outputs: tuple[str, ...],
    first: int,
    count: int | None,
    image_size: tuple[int, int] | None,
    outlook: Mapping[str, float],
    watch: bool,
    seed: int,
    no_browser: bool,
) -> int:
    """Show scenes that `scenic sample -o SCENES.jsonl` has saved; - reads them from standard input.

    The program is not run, unless --watch is given. Mesh files are read again; a shape whose mesh is missing is shown as its box.

    Exit codes: 0 success, 2 a file cannot be read or written or contains no scenes.
    """
    source = Path(file)
    if watch:
        return _watch(source, count or _SHOWN, seed, no_browser)
    if not outputs:
        if file == _STANDARD_INPUT:
            raise click.UsageError("scenes from standard input need a name for what is made: -o scenes.html")
        outputs = (str(source.with_suffix(".html")),)
    scenes = _chosen(file, first, count)
    head = list(islice(scenes, 2))
    if not head:
        raise SceneFileError(
            f"no scene to show in '{file}'"
            + (f" from k = {first} on" if first else "; it holds none" if count is None else ""),
            help="make some: scenic sample PROGRAM.scenic -n 10 -o scenes.jsonl",
        )
    title = "scenes" if file == _STANDARD_INPUT else source.name
    # One scene has the very name, of several each has its number.
    sinks = [_sink(Path(name), title, len(head), image_size, outlook) for name in outputs]
    _deliver(file, chain(head, scenes), sinks)
    return CLEAN


def _deliver(file: str, scenes: Iterable[ReadScene], chosen: Sequence[sinks.Sink]) -> None:
    """Hand scenes of a file to sinks; boxes stand for forms that are missing."""
    # These bring in NumPy and the geometry libraries.
    from scenic.formats.revival import Revival

    revival = Revival()
    numbers: dict[int, int] = {}
    with ExitStack() as stack:
        takers = [stack.enter_context(sink) for sink in chosen]
        for read in scenes:
            if numbers.setdefault(read.k, read.seed) != read.seed:
                raise SceneFileError(
                    f"'{file}' holds several scenes of number {read.k}, of seeds {numbers[read.k]} and {read.seed}",
                    help="show the scenes of one seed at a time",
                )
            scene = revival.revive(read)
            for take in takers:
                take(scene)
    for reason in dict.fromkeys(revival.substituted.values()):
        sys.stderr.write(f"warning: {reason}: boxes stand for what has this form\n")


def _watch(program: Path, count: int, seed: int, no_browser: bool) -> int:
    """Serve the page that follows a program, until the user ends it."""
    from scenic.playground.live_page import WatchedProgram, served

    if not program.is_file():
        raise click.UsageError(f"there is no program '{program}' to watch")
    with served(WatchedProgram(program.absolute(), count=count, seed=seed)) as address:
        click.echo(f"{address}\nsave {program.name} to see new scenes; Ctrl+C ends this")
        if not no_browser:
            webbrowser.open(address)
        with suppress(KeyboardInterrupt):
            threading.Event().wait()
    return CLEAN


def _chosen(file: str, first: int, count: int | None) -> Iterator[ReadScene]:
    read = scenes_of(sys.stdin, "standard input") if file == _STANDARD_INPUT else read_scenes(file)
    return islice((scene for scene in read if scene.k >= first), count)


def _sink(
    path: Path, title: str, count: int, image_size: tuple[int, int] | None, outlook: Mapping[str, float]
) -> sinks.Sink:
    suffix = path.suffix.lower()
    if suffix in _PAGES:
        return sinks.page(path, title)
    if suffix in {".png", ""}:
        return sinks.images(path, Path(title).stem, count, image_size, outlook)
    if sinks.is_lines(path):
        raise sinks.OutputChoiceError(
            f"saved scenes are not shown as '{suffix}' files",
            help="give a name that ends in .html, .glb, .obj or .png",
        )
    return sinks.scene_file(path, count)
