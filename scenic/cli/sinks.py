"""Destinations of sampled scenes: each sink is a context that gives a function to call with every scene.

A sink's files are complete when its context ends well; when it ends with an error, Ctrl-C included, those begun are absent.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

from scenic.formats.files import check_folder, check_writable, numbered, write
from scenic.formats.scene_protocols import Scene
from scenic.language.errors import Located
from scenic.runtime.ground.files import is_special

Take = Callable[[Scene], object]
Sink = AbstractContextManager[Take]

STANDARD_OUTPUT = Path("-")

_OTHER_FORMATS = {
    ".png": "images are made with --png",
    ".jpg": "images are made with --png, as PNG",
    ".html": "a page to look at the scenes is made with --view",
    ".htm": "a page to look at the scenes is made with --view",
    ".csv": "scenes are written as JSON Lines: a name that ends in .jsonl",
    ".json": "scenes are written as JSON Lines: a name that ends in .jsonl",
    ".gltf": "write the binary form of it: a name that ends in .glb",
    ".stl": "3D files are written as .glb, .obj, .usda or .wbt",
    ".ply": "3D files are written as .glb, .obj, .usda or .wbt",
    ".usd": "give the ending of text, binary or a package: .usda, .usdc or .usdz",
    ".urdf": "a world of several objects is written as .sdf, with a URDF of each object beside it",
    ".mjcf": "MJCF is written to a name that ends in .xml",
}


_PAGES = frozenset({".html", ".htm", ""})
"""Endings of pages."""


class OutputChoiceError(Located):
    """An output that scenes are not written as."""

    code = "SC604"


def is_dataset(output: str | None) -> bool:
    """Return whether scenes go to a data set: a name that ends in a slash, or a folder."""
    return output is not None and (output.endswith(("/", "\\")) or Path(output).is_dir())


def check_table(path: Path) -> None:
    """Raises ``OutputError`` or ``MissingLibraryError`` if scenes cannot be written to a Parquet file."""
    from scenic.formats.trajectory_tables import parquet_support

    parquet_support()
    check_writable(path)


def is_lines(path: Path) -> bool:
    """Return whether scenes are written to a file as JSON Lines, by its name's ending.

    Raises ``OutputChoiceError`` for endings of formats that scenes are not written as.
    """
    suffix = path.suffix.lower()
    if path != STANDARD_OUTPUT and suffix in _OTHER_FORMATS:
        raise OutputChoiceError(f"scenes are not written as '{suffix}' files", help=_OTHER_FORMATS[suffix])
    return suffix not in FILES


def check_lines(path: Path) -> None:
    """Raises ``OutputChoiceError`` for a name with the ending of another format, ``OutputError`` if it cannot be written."""
    is_lines(path)
    suffix = path.suffix.lower()
    if suffix not in {"", ".jsonl"} and not is_special(path):
        known = ", ".join(sorted({".jsonl", ".parquet", *FILES}))
        raise OutputChoiceError(
            f"'{suffix}' tells of no format that scenes are written as", help=f"known endings are {known}"
        )
    check_writable(path)


def scene_file(path: Path, count: int, first: int = 0) -> Sink:
    """A file of a 3D program or simulator for each scene, by the name's ending; raises ``OutputError`` at once if that cannot be.

    Args:
        path: the file of one scene; those of several have their numbers in their names.
        count: how many scenes.
        first: the number of the first one.

    """
    check_writable(path)
    ending = _ending(path)
    if ending in _ROBOTICS:
        from scenic.formats.robotics.scene_files import ENDINGS, check_form

        check_form(ENDINGS[ending])
    _check_numbered(path, count, first)
    return FILES[ending](path, count)


def _ending(path: Path) -> str:
    """The end of a file's name that tells the format."""
    name = path.name.lower()
    return _COMMONROAD if name.endswith(_COMMONROAD) else path.suffix.lower()


def check_files(form: str) -> None:
    """Raises ``MissingLibraryError`` if files of a form of data sets need a library that is not installed."""
    from scenic.formats.robotics.scene_files import check_form

    check_form(form)


def check_page(path: Path, option: str = "--view") -> None:
    """Raises ``OutputError`` if a page cannot be written there, ``OutputChoiceError`` if the name has the ending of another format."""
    check_writable(path)
    suffix = path.suffix.lower()
    if suffix not in _PAGES:
        raise OutputChoiceError(
            f"{option} makes a page, no '{suffix}' file",
            help="give it a name that ends in .html",
        )


def page(path: Path, title: str) -> Sink:
    """Return the sink for one HTML page that shows the scenes; raises at once what `check_page` raises."""
    check_page(path)
    return _page(path, title)


def check_labelled(folder: Path) -> None:
    """Raises ``OutputError``, ``OutputChoiceError`` or ``MissingLibraryError`` if no labelled images can be in a folder."""
    from scenic.formats.imaging import require_pillow

    require_pillow()
    if folder == STANDARD_OUTPUT or folder.suffix.lower() in {*_OTHER_FORMATS, *FILES, ".jsonl"}:
        raise OutputChoiceError(
            f"labelled images cannot be written to '{folder}'", help="give a folder: --camera front -o images"
        )
    check_folder(folder if folder.exists() else folder.resolve().parent)


def images(
    path: Path,
    stem: str,
    count: int,
    size: tuple[int, int] | None,
    outlook: Mapping[str, object],
    first: int = 0,
) -> Sink:
    """Return the sink for a PNG image of each scene: at ``path`` if that ends in ``.png``, else in the folder of that name.

    ``outlook`` contains the settings that differ from an `Outlook` made without arguments; ``first`` is the number of the first
    scene.

    Raises ``OutputError`` or ``MissingLibraryError`` at once if that cannot be.
    """
    from scenic.formats.imaging import require_pillow

    require_pillow()
    if path.suffix.lower() == ".png":
        check_writable(path)
        folder, target = None, path
    else:
        if path.suffix.lower() in {".jpg", ".jpeg", ".gif", ".bmp", ".webp", ".tif", ".tiff", ".svg"}:
            raise OutputChoiceError(
                f"--png makes no '{path.suffix}' file", help="give a name that ends in .png, or a folder"
            )
        check_folder(path if path.exists() else path.resolve().parent)
        folder, target = path, path / f"{stem}.png"
    _check_numbered(target, count, first)
    return _images(folder, target, count, size, outlook)


def _check_numbered(path: Path, count: int, first: int) -> None:
    """Look at the last file: no other name is longer."""
    if path.parent.exists():
        check_writable(numbered(path, first + count - 1, count))


@contextmanager
def _glb_files(path: Path, count: int) -> Iterator[Take]:
    from scenic.formats.glb import glb

    def take(scene: Scene) -> None:
        write(numbered(path, scene.k, count), glb(scene))

    yield take


@contextmanager
def _obj_files(path: Path, count: int) -> Iterator[Take]:
    from scenic.formats.obj import obj

    def take(scene: Scene) -> None:
        file = numbered(path, scene.k, count)
        library = file.with_suffix(".mtl")
        content, materials = obj(scene, library.name)
        write(library, materials)
        write(file, content)

    yield take


@contextmanager
def _worlds(path: Path, count: int) -> Iterator[Take]:
    from scenic.formats.webots import write_world

    def take(scene: Scene) -> None:
        write_world(scene, numbered(path, scene.k, count))

    yield take


@contextmanager
def _robot_files(path: Path, count: int) -> Iterator[Take]:
    from scenic.formats.robotics.scene_files import write_scene

    yield lambda scene: write_scene(scene, numbered(path, scene.k, count))


@contextmanager
def _road_files(path: Path, count: int) -> Iterator[Take]:
    from scenic.formats.commonroad.scenario_files import write_scene

    stem = path.name[: -len(_COMMONROAD)]

    def take(scene: Scene) -> None:
        file = numbered(path.with_name(f"{stem}.xml"), scene.k, count)
        write_scene(scene, file.with_name(file.stem + path.name[len(stem) :]))

    yield take


_COMMONROAD = ".cr.xml"
"""Ending of CommonRoad files."""

_ROBOTICS = (".usda", ".usdc", ".usdz", ".xml", ".sdf")
"""Endings of files for robot simulators."""

FILES = {
    ".glb": _glb_files,
    ".obj": _obj_files,
    ".wbt": _worlds,
    _COMMONROAD: _road_files,
    **dict.fromkeys(_ROBOTICS, _robot_files),
}
"""Sinks of 3D files by their endings."""


@contextmanager
def _page(path: Path, title: str) -> Iterator[Take]:
    from scenic.formats.html import Page

    made = Page(title)
    yield made.add
    if len(made):
        write(path, made.text().encode())


@contextmanager
def _images(
    folder: Path | None,
    target: Path,
    count: int,
    size: tuple[int, int] | None,
    outlook: Mapping[str, Any],
) -> Iterator[Take]:
    from scenic.formats.camera import Outlook
    from scenic.formats.png import png
    from scenic.formats.render import SIZE

    view = Outlook(**outlook)

    def take(scene: Scene) -> None:
        if folder is not None:
            folder.mkdir(exist_ok=True)
        write(numbered(target, scene.k, count), png(scene, size or SIZE, view))

    yield take
