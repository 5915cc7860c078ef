"""Files of scenes for robot simulators, by format: for a data set with shared meshes and images, and for one scene alone."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from scenic.formats.files import make_folder, write
from scenic.formats.robotics.mjcf import mjcf
from scenic.formats.robotics.sdf import sdf
from scenic.formats.robotics.usd import require_usd, usd, usd_file
from scenic.formats.scene_protocols import Scene

__all__ = ["ENDINGS", "FORMS", "check_form", "scene_files", "write_scene"]

FORMS: Final[Mapping[str, str]] = {"usd": ".usda", "mjcf": ".xml", "sdf": ".sdf"}
"""Forms of data sets, with the endings of their scenes' files."""

ENDINGS: Final[Mapping[str, str]] = {
    ".usda": "usd",
    ".usdc": "usd",
    ".usdz": "usd",
    ".xml": "mjcf",
    ".sdf": "sdf",
}
"""Endings of files of one scene, with their forms."""


def check_form(form: str) -> None:
    """Raise ``MissingLibraryError`` if a form needs a library that is not installed."""
    if form == "usd":
        require_usd()


def scene_files(scene: Scene, form: str, stem: str) -> dict[str, bytes]:
    """The files of a scene in a data set by their paths: its own first, which begins with ``stem``, then shared ones."""
    name = stem + FORMS[form]
    match form:
        case "usd":
            return usd(scene, name)
        case "mjcf":
            return mjcf(scene, name, inline=False)
    return sdf(scene, name)


def write_scene(scene: Scene, path: Path) -> None:
    """Write one scene by the ending of the file's name; meshes are in it where the format has them, else in a folder beside it.

    The scene's own file is written last: a failure leaves none, and no other file that was not there.
    """
    makers: Mapping[str, Callable[[], dict[str, bytes]]] = {
        "usd": lambda: usd_file(scene, path.name),
        "mjcf": lambda: mjcf(scene, path.name, inline=True),
        "sdf": lambda: sdf(scene, path.name),
    }
    (name, content), *others = makers[ENDINGS[path.suffix.lower()]]().items()
    targets = [(path.parent / other, data) for other, data in others]
    for target, _ in targets:
        make_folder(target.parent)
    fresh = [target for target, _ in targets if not target.exists()]
    try:
        for target, data in targets:
            write(target, data)
        write(path.parent / name, content)
    except BaseException:
        for target in fresh:
            target.unlink(missing_ok=True)
        raise
