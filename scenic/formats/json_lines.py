"""Scenes as JSON Lines: one line of JSON for each scene (``docs/reference/scene-format.md`` describes every field)."""

import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from scenic.formats.mesh_files import MeshPaths
from scenic.formats.poses import euler_angles, quaternion_of
from scenic.formats.scene_protocols import Origin, Scene, SceneObject
from scenic.runtime.instances.objects import Object

FORMAT = "scenic-scene"
VERSION = 1

TOLD_ELSEWHERE = frozenset({"position", "orientation", "heading", "width", "length", "height", "shape"})
"""Properties that have fields of their own or follow from them."""

DEPTH = 32
"""Deeper nesting of lists and mappings is written as text."""

_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def scene_line(scene: Scene) -> str:
    """Return the scene as one line of JSON, without the line's end; equal scenes give equal text."""
    return SceneLines().line(scene)


def scene_document(scene: Scene) -> dict[str, Any]:
    """Return the scene as plain data that JSON can hold."""
    document: dict[str, Any] = json.loads(scene_line(scene))
    return document


class SceneLines:
    """Lines of the scenes of one program. What is the same in all of them is put into words once.

    Args:
        program: the name of the program's file and the digest of its text and options; told in every line.
        changed: whether to tell only properties that the program gives, not those at the defaults of the language.
        points: how the scenes are made, if not by rejection of random numbers: ``sobol``, ``approximate N``.
        folder: the folder that paths of mesh files are relative to; they are absolute if there is none.
        files: a digest of all files that decide the scenes beside the program's text, if there are any.

    """

    def __init__(
        self,
        program: tuple[str, str] | None = None,
        *,
        changed: bool = False,
        points: str | None = None,
        folder: Path | None = None,
        files: str = "",
    ) -> None:
        self._changed = changed
        self._meshes = MeshPaths(folder)
        self._head = {"format": FORMAT, "version": VERSION}
        if program is not None:
            self._head["program"], self._head["digest"] = program
        if files:
            self._head["files"] = files
        if points is not None:
            self._head["points"] = points
        self._templates: dict[int, _Template] = {}

    def line(self, scene: Scene) -> str:
        """Return the scene as one line of JSON, without the line's end."""
        things = scene.objects
        numbers = {id(thing): index for index, thing in enumerate(things)}
        names = scene.names
        head = self._head | {
            "seed": scene.seed,
            "k": scene.k,
            "attempts": scene.attempts,
            "params": {str(name): plain(value, numbers) for name, value in scene.params.items()},
            "ego": None if scene.egoObject is None else numbers[id(scene.egoObject)],
        }
        objects = ",".join([self._object(scene, thing, names.get(thing), numbers) for thing in things])
        return f'{_text_of(head)[:-1]},"objects":[{objects}]}}'

    def encoded(self, scene: Scene) -> bytes:
        """The line with its end, as files hold it."""
        return self.line(scene).encode("ascii") + b"\n"

    def block(self, _scenario: object, scenes: Iterable[Scene]) -> bytes:
        """Return the lines of some scenes, as files hold them."""
        return b"".join(map(self.encoded, scenes))

    def _object(self, scene: Scene, thing: SceneObject, name: str | None, numbers: Mapping[int, int]) -> str:
        origin = scene.origin(thing)
        template = self._templates.get(id(origin))
        if template is None:
            template = _Template(origin, thing, name, numbers, self._meshes, changed=self._changed)
            self._templates[id(origin)] = template
        quaternion = quaternion_of(thing)
        shape = template.shape or _text_of(plain(self._meshes.told(thing.shape.source), numbers))
        place = f'{template.head},"position":{_list_of(thing.position)},"quaternion":{_list_of(quaternion)}'
        size = _list_of((thing.width, thing.length, thing.height))
        turn = _list_of(euler_angles(quaternion))
        parts = [f'{place},"euler":{turn},"size":{size},"shape":{shape},"properties":{{']
        for text, key in template.pieces:
            parts.append(text)
            if key:
                value = origin.read(thing, key)
                parts.append(_real(value) if type(value) is float else _text_of(plain(value, numbers)))
        return "".join(parts)


class _Template:
    """The text of an object that is the same in all scenes.

    Attributes:
        head: the object's text up to its name.
        shape: the text of its shape; empty where it differs.
        pieces: text, and the property whose value comes next, if any.

    """

    def __init__(
        self,
        origin: Origin,
        thing: SceneObject,
        name: str | None,
        numbers: Mapping[int, int],
        meshes: MeshPaths,
        *,
        changed: bool,
    ) -> None:
        self.origin = origin  # kept, so that its identity stays its own
        self.head = _text_of({"class": type(thing).__name__, "name": name})[:-1]
        self.shape = ""
        if "shape" in origin.fixed:
            self.shape = _text_of(plain(meshes.told(thing.shape.source), numbers))
        self.pieces: list[tuple[str, str]] = []
        text, separator = "", ""
        for key in origin.given if changed else origin.names:
            if key in TOLD_ELSEWHERE:
                continue
            text += f"{separator}{_text_of(key)}:"
            separator = ","
            value = origin.read(thing, key) if key in origin.fixed else None
            # The number of another object may differ between scenes.
            if key in origin.fixed and plain(value, numbers) == plain(value, {}):
                text += _text_of(plain(value, numbers))
            else:
                self.pieces.append((text, key))
                text = ""
        self.pieces.append((text + "}}", ""))


def _list_of(values: Iterable[float]) -> str:
    # What is not finite, or a number of NumPy's, has an n in it.
    text = ",".join([repr(value + 0.0) for value in values])
    return f"[{text}]" if "n" not in text else _text_of([number(value) for value in values])


def _real(value: float) -> str:
    """A real number as JSON, as `number` and Python's own writer write it."""
    return repr(value + 0.0) if math.isfinite(value) else _text_of(number(value))


_ENCODER = json.JSONEncoder(allow_nan=False, separators=(",", ":"))


def _text_of(data: object) -> str:
    return _ENCODER.encode(data)


def number(value: float) -> float | dict[str, str]:
    """A real number; JSON has no word for those that are not finite, so they are marked."""
    value = float(value) + 0.0  # no negative zero
    if math.isfinite(value):
        return value
    return {"$float": "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"}


def real(value: Any) -> float:
    """Return the real number that `number` has written."""
    return float(value["$float"]) if isinstance(value, dict) else float(value)


def decoded(value: Any) -> Any:
    """Return a saved value with its numbers that JSON has no word for."""
    if isinstance(value, list):
        return [decoded(item) for item in value]
    if isinstance(value, dict):
        return (
            real(value) if value.keys() == {"$float"} else {key: decoded(item) for key, item in value.items()}
        )
    return value


def plain(value: object, numbers: Mapping[int, int], within: tuple[int, ...] = ()) -> Any:
    """Return a value as JSON holds it; ``numbers`` maps the ``id`` of each object of the scene to its index.

    ``within`` are the ``id``s of the lists and mappings round the value.
    """
    match value:
        case None | bool() | str():
            return value
        case int():
            return int(value)
        case float():
            return number(value)
        case np.generic() | np.ndarray():
            return plain(value.tolist(), numbers, within)
    if id(value) in numbers:
        return {"$object": numbers[id(value)]}
    if isinstance(value, Object) and not getattr(value, "present", True):
        return None  # it does not take part in this scene
    if len(within) >= DEPTH or id(value) in within:
        return _text(value)
    inner = (*within, id(value))
    if isinstance(value, Mapping):
        if all(type(key) is str and not key.startswith("$") for key in value):
            return {key: plain(item, numbers, inner) for key, item in value.items()}
        return {
            "$map": [[plain(key, numbers, inner), plain(item, numbers, inner)] for key, item in value.items()]
        }
    parts = [getattr(value, part, None) for part in "xyzw"]
    if all(isinstance(part, float) for part in parts[:3]):
        if isinstance(parts[3], float):
            return {"$quaternion": [number(part) for part in parts if isinstance(part, float)]}
        return [number(part) for part in parts if isinstance(part, float)]
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray, memoryview, range)):
        return [plain(item, numbers, inner) for item in value]
    if callable(getattr(value, "applyTo", None)):
        # An action: its numbers are what matters.
        parts_of_action = {key: item for key, item in vars(value).items() if not key.startswith("_")}
        return {"action": type(value).__name__, **plain(parts_of_action, numbers, inner)}
    return _text(value)


def _text(value: object) -> dict[str, str]:
    """Return Python's representation of a value that JSON cannot contain, without addresses, which differ from run to run."""
    try:
        shown = repr(value)
    except Exception:  # noqa: BLE001 - a broken `__repr__` of the user's must not lose the scene
        shown = f"<{type(value).__name__}>"
    return {"$text": _ADDRESS.sub("", shown)}
