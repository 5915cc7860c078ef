"""Files that programs name by old paths: where a file of that name is now."""

import os
from collections.abc import Sequence
from typing import Final

__all__ = ["MapFiles"]

SUFFIXES: Final = (".xodr", ".net.xml", ".snet", ".wbt")
"""Endings of the files that are searched for."""

_MOST_ENTRIES: Final = 50_000
"""Entries of folders after which the search ends."""


class MapFiles:
    """The maps in some folders, found once, when the first is asked for."""

    def __init__(self, roots: Sequence[str] = ()) -> None:
        self._roots = tuple(dict.fromkeys(map(os.path.abspath, roots)))
        self._places: dict[str, dict[str, list[str]]] = {}

    def nearest(self, path: str, program: str) -> str | None:
        """The path, relative to the folder of a program, of the nearest file with the name of ``path``; ``None`` if no
        folder has one.
        """
        folder = os.path.dirname(os.path.abspath(program))
        candidates: list[str] = []
        for root in dict.fromkeys((folder, *self._roots)):
            places = self._places.get(root)
            if places is None:
                places = self._places[root] = _maps_in(root)
            candidates += places.get(os.path.basename(path), ())
        if not candidates:
            return None
        relative = {os.path.relpath(each, folder).replace(os.sep, "/") for each in candidates}
        return min(relative, key=lambda each: (each.count("/"), each))


def _maps_in(root: str) -> dict[str, list[str]]:
    places: dict[str, list[str]] = {}
    entries = 0
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(each for each in folders if not each.startswith(".") and each != "node_modules")
        entries += len(names) + len(folders)
        for name in names:
            if name.endswith(SUFFIXES):
                places.setdefault(name, []).append(os.path.join(folder, name))
        if entries > _MOST_ENTRIES:
            break
    return places
