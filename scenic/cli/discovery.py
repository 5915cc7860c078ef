"""The files that the arguments of a command stand for."""

import os
from collections.abc import Iterator, Sequence
from typing import Final

from scenic.configuration.project import Configurations
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic

__all__ = ["STANDARD_INPUT", "DiscoveredFiles", "discover"]

STANDARD_INPUT: Final = "-"
SUFFIXES: Final = (".scenic", ".sc")


@dataclass(frozen=True, slots=True)
class DiscoveredFiles:
    """The files, each but once, in the order of the arguments and by name within folders; and what went wrong."""

    files: tuple[str, ...]
    problems: tuple[Diagnostic, ...]


def discover(arguments: Sequence[str], configurations: Configurations) -> DiscoveredFiles:
    """List the files that the arguments name, and the Scenic files in the folders that they name.

    A file that is named is listed whatever its ending. In folders, files with the usual endings are listed, except those that the
    configuration excludes, and those in hidden folders, virtual environments or caches. Links to folders are not followed, unless
    they are named.
    """
    files: dict[str, str] = {}
    problems: list[Diagnostic] = []
    for argument in arguments or (os.curdir,):
        if argument != STANDARD_INPUT and os.path.isdir(argument):
            # Who names a folder that is excluded wants it nevertheless.
            excluding = not configurations.of_folder(argument).excludes(argument)
            for file in _in_folder(argument, configurations, problems, excluding=excluding):
                files.setdefault(os.path.abspath(file), file)
        else:
            key = argument if argument == STANDARD_INPUT else os.path.abspath(argument)
            files.setdefault(key, argument)
    return DiscoveredFiles(tuple(files.values()), tuple(problems))


def _in_folder(
    folder: str, configurations: Configurations, problems: list[Diagnostic], *, excluding: bool
) -> Iterator[str]:
    try:
        with os.scandir(folder) as scan:
            entries = sorted(scan, key=lambda entry: entry.name)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        problems.append(
            Diagnostic(
                "SC600",
                f"the folder cannot be read: {reason}",
                filename=folder,
                help="change its permissions",
            )
        )
        return
    configuration = configurations.of_folder(folder)
    for entry in entries:
        path = entry.name if folder == os.curdir else os.path.join(folder, entry.name)
        if entry.is_dir(follow_symlinks=False):
            if not _is_passed_over(entry) and not (excluding and configuration.excludes(path)):
                yield from _in_folder(path, configurations, problems, excluding=excluding)
        elif (
            entry.name.endswith(SUFFIXES)
            and not entry.is_dir()
            and not (excluding and configuration.excludes(path))
        ):
            yield path


def _is_passed_over(folder: "os.DirEntry[str]") -> bool:
    """Return whether a folder holds nothing that its user wrote."""
    name = folder.name
    return (
        name.startswith(".")
        or name == "__pycache__"
        or os.path.exists(os.path.join(folder.path, "pyvenv.cfg"))
    )
