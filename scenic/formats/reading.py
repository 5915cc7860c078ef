"""Scenes read back from JSON Lines (``docs/reference/scene-format.md``), as plain data with names."""

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from scenic.dataclass import dataclass
from scenic.formats.json_lines import FORMAT, VERSION
from scenic.formats.mesh_files import resolved
from scenic.language.errors import Located, MissingFileError

Triple = tuple[float, float, float]


class SceneFileError(Located):
    """A file that does not hold scenes."""

    code = "SC607"


@dataclass(frozen=True, slots=True)
class ReadObject:
    """An object of a scene that was read.

    Attributes:
        kind: the name of its class.
        name: the program's variable that holds it, or ``None``.
        position: metres.
        quaternion: x, y, z, w.
        euler: yaw, pitch, roll in radians.
        size: width, length, height in metres.
        shape: what its mesh is, as data; the ``path`` of a mesh file is absolute.
        properties: its other properties; a reference to another object is ``{"$object": number}``.

    """

    kind: str
    name: str | None
    position: Triple
    quaternion: tuple[float, float, float, float]
    euler: Triple
    size: Triple
    shape: Mapping[str, Any]
    properties: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class ReadScene:
    """A scene that was read: of which program, seed and number, with its parameters and objects (the ego first)."""

    seed: int
    k: int
    attempts: int
    params: Mapping[str, Any]
    objects: tuple[ReadObject, ...]
    ego: ReadObject | None
    program: str | None = None
    digest: str | None = None


def read_scenes(path: str | Path) -> Iterator[ReadScene]:
    """Yield the scenes of a file that ``scenic sample -o FILE.jsonl`` has written, one after the other.

    Raises:
        MissingFileError: if the file cannot be read.
        SceneFileError: if a line is not a scene.

    """
    try:
        with Path(path).open("rb") as file:
            # Line by line, so that the one that is no text is known.
            yield from scenes_of((line.decode() for line in file), str(path), _mesh_folder(Path(path).parent))
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise MissingFileError(
            f"cannot read '{path}': {reason}", code="SC600", help="check the path"
        ) from error


def _mesh_folder(folder: Path) -> Path:
    """Return the folder that paths of mesh files are relative to: that of the file, in a data set that of the program."""
    try:
        manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
        return Path(folder, manifest["source"]).parent
    except (OSError, ValueError, KeyError, TypeError):
        return folder


def scenes_of(lines: Iterable[str], name: str, folder: Path = Path()) -> Iterator[ReadScene]:
    """Yield the scenes of lines of text; ``name`` is where they come from, ``folder`` what paths of meshes are relative to.

    Raises ``SceneFileError`` at a line that holds none.
    """
    number = 0
    try:
        for number, line in enumerate(lines, start=1):
            try:
                yield _scene(json.loads(line, object_hook=_number), folder)
            except (ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError) as error:
                raise _no_scene(number, name, error) from error
    except UnicodeDecodeError as error:
        raise _no_scene(number + 1, name, error) from error


def _no_scene(number: int, name: str, error: Exception) -> SceneFileError:
    return SceneFileError(
        f"line {number} of '{name}' holds no scene ({error})",
        help="read files that `scenic sample` has written as JSON Lines",
    )


def _number(data: dict[str, Any]) -> Any:
    """Numbers that JSON has no word for."""
    return float(data["$float"]) if data.keys() == {"$float"} else data


def _scene(data: Any, folder: Path) -> ReadScene:
    if data["format"] != FORMAT or data["version"] != VERSION:
        raise ValueError(f"format {data['format']!r}, version {data['version']!r}")
    objects = tuple(
        ReadObject(
            item["class"],
            item["name"],
            _numbers(item["position"], 3),
            _numbers(item["quaternion"], 4),
            _numbers(item["euler"], 3),
            _numbers(item["size"], 3),
            resolved(item["shape"], folder),
            item["properties"],
        )
        for item in data["objects"]
    )
    return ReadScene(
        int(data["seed"]),
        int(data["k"]),
        int(data["attempts"]),
        data["params"],
        objects,
        None if data["ego"] is None else objects[data["ego"]],
        data.get("program"),
        data.get("digest"),
    )


def _numbers(values: Any, count: int) -> Any:
    if len(values) != count:
        raise ValueError(f"{count} numbers are needed, not {len(values)}")
    return tuple(float(value) for value in values)
