"""Files for robot simulators as parts of data sets: a file of each scene, with meshes and images that all of them share.

A part is an index ``part-N.json`` that names the files of its scenes, with digests. Shared files are named after their content,
so that scenes may be made in any order and by any process.
"""

import hashlib
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from scenic.batch.manifest import DatasetError, Manifest, Part
from scenic.formats.files import make_folder, write
from scenic.formats.robotics.scene_files import FORMS, scene_files
from scenic.formats.shards import encoded_row, member, members, rows_of
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene

__all__ = [
    "FORMS",
    "SceneFileRows",
    "SceneFileSink",
    "copy_scene_files",
    "damaged_scene_files",
    "scene_file_names",
    "scene_file_rows",
]


class SceneFileRows:
    """Turns scenes into rows: for each scene two lengths, the members of a tar file, and its entry of the index as JSON.

    A process sends each shared file once.

    Args:
        scenario: the program, whose name begins the names of files.
        form: of `FORMS`.

    """

    def __init__(self, scenario: Scenario, form: str) -> None:
        self._stem = Path(scenario.filename).stem
        self._form = form
        self._sent: set[str] = set()

    def rows(self, scenes: Sequence[Scene]) -> bytes:
        """Return the rows of some scenes."""
        return b"".join(self._row(scene) for scene in scenes)

    def _row(self, scene: Scene) -> bytes:
        files = scene_files(scene, self._form, f"{self._stem}-{scene.k:06d}")
        own_files = {name: content for name, content in files.items() if "/" not in name}
        content = b"".join(member(name, data) for name, data in files.items() if name not in self._sent)
        self._sent |= files.keys() - own_files.keys()
        entry = {
            "seed": scene.seed,
            "k": scene.k,
            "files": {name: _digest(data) for name, data in own_files.items()},
            "shared": {name: _digest(data) for name, data in files.items() if name not in own_files},
        }
        return encoded_row(content, entry)


class SceneFileSink:
    """The part that is being made: files are written at once, the index when it is complete."""

    skipped = 0

    def __init__(self, path: Path, _scenario: Scenario, _manifest: Manifest) -> None:
        self._path = path
        self._entries: list[dict[str, Any]] = []

    def add(self, rows: memoryview) -> None:
        """Write the next rows."""
        for content, entry in rows_of(rows):
            for name, data in members(content):
                target = self._path.parent / name
                make_folder(target.parent)
                write(target, data)
            self._entries.append(entry)

    def finish(self) -> None:
        """Write the index."""
        write(self._path, (json.dumps({"scenes": self._entries}, indent=1) + "\n").encode())

    def close(self) -> None:
        """Leave the files that are written: they are complete."""


def scene_file_rows(source: Path | bytes) -> Iterator[dict[str, Any]]:
    """Yield the entries of a part's index, or of encoded rows."""
    if isinstance(source, bytes):
        yield from (entry for _, entry in rows_of(memoryview(source)))
        return
    try:
        yield from json.loads(source.read_bytes())["scenes"]
    except (OSError, ValueError, KeyError) as error:
        raise DatasetError(f"'{source}' cannot be read: {error}") from error


def scene_file_names(index: Path) -> list[str]:
    """The names of the files that an index names."""
    names = dict.fromkeys(
        name for entry in scene_file_rows(index) for name in (*entry["files"], *entry["shared"])
    )
    return list(names)


def damaged_scene_files(folder: Path, part: Part) -> Iterator[tuple[str, str]]:
    """Yield files of a part that are missing or changed, and what is wrong with them."""
    names: set[str] = set()
    for entry in scene_file_rows(folder / part.file):
        for name, digest in {**entry["files"], **entry["shared"]}.items():
            if name in names:
                continue
            names.add(name)
            path = folder / name
            if not path.is_file():
                yield name, "the file is missing"
            elif _digest(path.read_bytes()) != digest:
                yield name, "the content has changed since it was written"


def copy_scene_files(source: Path, part: Part, target: Path) -> None:
    """Copy the files that a part names to the folder of ``target``.

    Raises:
        DatasetError: a file is damaged.

    """
    for name, what in damaged_scene_files(source, part):
        raise DatasetError(f"'{source / name}': {what}", help="make this part again")
    for entry in scene_file_rows(source / part.file):
        for name in [*entry["files"], *entry["shared"]]:
            path = target.parent / name
            if not path.is_file():
                make_folder(path.parent)
                write(path, (source / name).read_bytes())


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
