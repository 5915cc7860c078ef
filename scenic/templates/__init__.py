"""Folders to start from, which `scenic new` copies."""

from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from types import MappingProxyType
from typing import Final

__all__ = ["TEMPLATES", "copy"]

TEMPLATES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "tabletop": "things on a table, seen by a camera",
        "driving": "cars on a road map, with behaviors",
        "drone": "a drone that flies to a pad and keeps away from a mast",
    }
)
"""Descriptions of the templates, by their names, which are those of their folders."""


def copy(template: str, folder: Path) -> list[str]:
    """Copy the files of a template into a folder, which is made if it does not exist; the names of the files.

    Raises:
        FileExistsError: if the folder holds something already.
        OSError: if it cannot be written.

    """
    if folder.exists() and any(folder.iterdir()):
        raise FileExistsError(folder)
    folder.mkdir(parents=True, exist_ok=True)
    names = []
    for source in sorted(
        resources.files(__name__).joinpath(template).iterdir(), key=lambda entry: entry.name
    ):
        if source.is_file():
            (folder / source.name).write_bytes(source.read_bytes())
            names.append(source.name)
    return names
