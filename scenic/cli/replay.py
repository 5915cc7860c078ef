"""``scenic replay``: makes a run that was kept again, tells whether it is the same, and shows it."""

import tempfile
import webbrowser
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import quote

import click

from scenic.cli.batch_runs import NOT_ALL
from scenic.cli.options import (
    COUNT,
    PATH,
    POSITIVE,
    image_size_option,
    look_from_option,
    named_values,
    option,
    simulator_option,
)
from scenic.cli.output import CLEAN
from scenic.cli.sinks import OutputChoiceError, check_page

if TYPE_CHECKING:
    from scenic.formats.camera import Outlook
    from scenic.formats.course_pictures import StatePictures

__all__ = ["replay"]

_ON_A_SHEET: Final = 9
_IMAGES: Final = 60
"""Images in a folder or in a film, at most, unless the steps between them are given."""
_FILMS: Final = (".gif", ".mp4", ".mov", ".mkv")


@click.command()
@click.argument("path", metavar="RUN", type=click.Path(path_type=Path))
@click.argument("number", metavar="[NUMBER]", type=click.IntRange(min=0), required=False)
@option(
    "--worst K",
    "The run with the Kth least value of a search: --worst 1 is the worst run, the default.",
    COUNT,
)
@option(
    "--program FILE",
    "The program, where it is no longer in its place.  [default: the one that the run names]",
    PATH,
)
@option(
    "-p --param parameters NAME=VALUE",
    "Another value for a global parameter: the run as it would have been. Repeatable.",
    multiple=True,
    callback=named_values,
)
@simulator_option
@option("--view PAGE.html", "Make a page that plays it.", PATH)
@option("--open opened", "Open the page in the browser; without --view, a temporary one.")
@option(
    "--png PATH",
    "Draw it: nine states in one image, at this name with .png, or an image for each state, in this folder.",
    PATH,
)
@option(
    "--film FILE",
    "Make a film that plays as fast as the simulation: .gif, or .mp4, .mov or .mkv (extra `video`).",
    PATH,
)
@option(
    "--every STEPS",
    "Steps between images of a folder or a film.  [default: so many that there are 60 images at most]",
    COUNT,
)
@option(
    "--image-size WxH",
    "Columns and rows of the images, of a film, or of the whole image of several states.  [default: 960x720]",
    callback=image_size_option,
)
@look_from_option()
@option(
    "--follow NAME",
    "Let the camera stay behind an object: the name of its variable, or its number. --look-from is then relative to it.  "
    "[default of --look-from: 0,22]",
)
@option(
    "--around METRES",
    "Metres around the object of --follow that images show.  [default: by its size]",
    POSITIVE,
)
@option("--show-records", "Print what the simulation records.")
@option(
    "--accept-changes",
    "Make the run although modules or files of the program have changed since; the changes are printed.",
)
def replay(
    path: Path,
    number: int | None,
    worst: int | None,
    program: Path | None,
    parameters: Mapping[str, Any],
    simulator: str | None,
    view: Path | None,
    opened: bool,
    png: Path | None,
    film: Path | None,
    every: int | None,
    image_size: tuple[int, int] | None,
    outlook: Mapping[str, Any],
    follow: str | None,
    around: float | None,
    show_records: bool,
    accept_changes: bool,
) -> int:
    """Make a run again that `falsify -o` or `simulate -o` has kept, compare it with what was kept, and show it.

    RUN is the folder of a search or of one of its counterexamples, a folder of simulations, or the file of one. NUMBER chooses
    a run of a folder: by default the worst of a search, the first of simulations.

    Exit codes: 0 the run is the same, bit by bit, 1 the program has errors, 2 wrong usage, 3 it differs.
    """
    from scenic.falsification.replaying import kept_run, program_of
    from scenic.falsification.replaying import replay as made_again
    from scenic.pipeline import load

    if number is not None and worst is not None:
        raise click.UsageError("NUMBER and --worst both choose a run: give one of them")
    _check(view, png, film)
    if around is not None and follow is None:
        raise click.UsageError("--around belongs to --follow")
    run = kept_run(path, number, worst=worst)
    if opened and view is None:
        view = Path(tempfile.mkdtemp(prefix="scenic-replay-"), f"run-{run.number:04d}.html")
    options = dict(run.origin["options"])
    if parameters:
        options["params"] = {**(options.get("params") or {}), **parameters}
    scenario = load(program or program_of(run), **options)
    repetition = made_again(
        run,
        scenario,
        simulator,
        shown=any(item is not None for item in (view, png, film)),
        accept_changes=accept_changes,
    )
    _show(run.number, repetition.about)
    if repetition.version is not None:
        print(repetition.version)
    if show_records:
        for name, value in repetition.about.get("records", {}).items():
            print(f"  record {name} = {value}")
    if repetition.page is None and (view, png, film) != (None, None, None):
        print("nothing is shown, since there is no simulation")
    if view is not None and repetition.page is not None:
        _write_page(view, repetition.page, follow, opened=opened)
    if repetition.pictures is not None and (png is not None or film is not None):
        _draw(repetition.pictures, png, film, every, image_size, _camera(outlook, follow, around))
    for words in repetition.unknown:
        print(f"not compared: {words}")
    if not repetition.departures:
        print("the same as kept, bit by bit")
        return CLEAN
    for words in repetition.departures:
        print(f"differs: {words}")
    return NOT_ALL


def _check(view: Path | None, png: Path | None, film: Path | None) -> None:
    """Raise at once, before anything is simulated, what stands in the way of files."""
    from scenic.formats.files import check_folder, check_writable
    from scenic.formats.imaging import require_pillow

    if view is not None:
        check_page(view)
    if png is not None:
        require_pillow()
        if png.suffix.lower() == ".png":
            check_writable(png)
        elif png.suffix:
            raise OutputChoiceError(
                f"--png makes no '{png.suffix}' file", help="give a name that ends in .png, or a folder"
            )
        else:
            check_folder(png if png.exists() else png.resolve().parent)
    if film is not None:
        require_pillow()
        if film.suffix.lower() not in _FILMS:
            raise OutputChoiceError(
                f"--film makes no '{film.suffix}' file", help=f"give a name that ends in {', '.join(_FILMS)}"
            )
        check_writable(film)


def _write_page(view: Path, page: str, follow: str | None, *, opened: bool) -> None:
    from scenic.formats.files import write

    write(view, page.encode())
    if opened:
        print(f"opens {view}")
        webbrowser.open(view.resolve().as_uri() + (f"#follow={quote(follow)}" if follow else ""))


def _camera(outlook: Mapping[str, Any], follow: str | None, around: float | None) -> "Outlook":
    """Return the camera of images and films, which may follow an object."""
    from scenic.formats.camera import Outlook
    from scenic.formats.chase_cameras import BEHIND

    if follow is None:
        return Outlook(**outlook)
    name = int(follow) if follow.isdecimal() else follow
    return Outlook(**{"azimuth": BEHIND[0], "elevation": BEHIND[1], **outlook}, follow=name, reach=around)


def _draw(
    pictures: "StatePictures",
    png: Path | None,
    film: Path | None,
    every: int | None,
    size: tuple[int, int] | None,
    outlook: "Outlook",
) -> None:
    """Write images and the film."""
    from scenic.formats.course_pictures import evenly, film_of, sheet
    from scenic.formats.files import make_folder, write
    from scenic.formats.png import encoded
    from scenic.formats.render import SIZE

    size = size or SIZE
    last = len(pictures) - 1
    states = evenly(len(pictures), _IMAGES) if every is None else [*range(0, last, every), last]
    if png is not None and png.suffix:
        write(png, sheet(pictures, evenly(len(pictures), _ON_A_SHEET), size, outlook))
    elif png is not None:
        make_folder(png)
        for state, image in zip(states, pictures.images(states, size, outlook), strict=True):
            write(png / f"state-{state:0{len(str(last))}d}.png", encoded(image))
    if film is not None:
        film_of(pictures, states, film, size, outlook)


def _show(number: int, about: Mapping[str, Any]) -> None:
    """Print what came of the run."""
    requirements = about.get("requirements") or {}
    if isinstance(requirements, list):
        requirements = {item["label"]: item for item in requirements}
    outcome = about.get("status") or about.get("reason") or "nothing"
    steps = f", {about['steps']} steps" if "steps" in about else ""
    print(f"run {number}: {outcome}{steps}")
    if about.get("values"):
        print(f"  value {min(map(float, about['values'])):.6g}")
    for label, item in requirements.items():
        verdict = "not evaluated" if item["verdict"] is None else item["verdict"].lower().replace("_", " ")
        by = f", robustness {item['robustness']:.4g}" if isinstance(item["robustness"], float) else ""
        print(f"  {label}: {verdict}{by}")
    if about.get("error"):
        print(f"  {about['error']}")
