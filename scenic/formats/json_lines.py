"""Scenes as JSON Lines: one line of JSON for each scene (``docs/scene-format.md`` describes every field)."""

import json
import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from scenic.formats.poses import euler_angles, quaternion_of
from scenic.formats.scenes import Scene, SceneObject

FORMAT = "scenic-scene"
VERSION = 1

TOLD_ELSEWHERE = frozenset({"position", "orientation", "heading", "width", "length", "height", "shape"})
"""Properties that have fields of their own or follow from them."""

DEPTH = 32
"""Deeper nesting of lists and mappings is written as text."""

_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def scene_line(scene: Scene) -> str:
    """The scene as one line of JSON, without the line's end; equal scenes give equal text."""
    return SceneLines().line(scene)


def scene_document(scene: Scene) -> dict[str, Any]:
    """The scene as plain data that JSON can hold."""
    document: dict[str, Any] = json.loads(scene_line(scene))
    return document


class SceneLines:
    """Lines of the scenes of one program. What is the same in all of them is put into words once.

    Args:
        program: the name of the program's file and the digest of its text and options; told in every line.
        changed: whether to tell only properties that the program gives, not those at the defaults of the language.

    """

    def __init__(self, program: tuple[str, str] | None = None, *, changed: bool = False) -> None:
        self._changed = changed
        self._head = {"format": FORMAT, "version": VERSION}
        if program is not None:
            self._head["program"], self._head["digest"] = program
        self._fixed: dict[tuple[int, str], tuple[object, str]] = {}

    def line(self, scene: Scene) -> str:
        """The scene as one line of JSON, without the line's end."""
        numbers = {id(thing): index for index, thing in enumerate(scene.objects)}
        names = scene.names
        head = self._head | {
            "seed": scene.seed,
            "k": scene.k,
            "attempts": scene.attempts,
            "params": {str(name): plain(value, numbers) for name, value in scene.params.items()},
            "ego": None if scene.egoObject is None else numbers[id(scene.egoObject)],
        }
        objects = ",".join(self._object(scene, thing, names.get(thing), numbers) for thing in scene.objects)
        return f'{_text_of(head)[:-1]},"objects":[{objects}]}}'

    def _object(self, scene: Scene, thing: SceneObject, name: str | None, numbers: Mapping[int, int]) -> str:
        quaternion = quaternion_of(thing)
        head = {
            "class": type(thing).__name__,
            "name": name,
            "position": [number(value) for value in thing.position],
            "quaternion": [number(value) for value in quaternion],
            "euler": [number(value) for value in euler_angles(quaternion)],
            "size": [number(value) for value in (thing.width, thing.length, thing.height)],
            "shape": plain(thing.shape.source.as_dict(), numbers),
        }
        origin = scene.origin(thing)
        properties = []
        for key in origin.given if self._changed else origin.names:
            if key in TOLD_ELSEWHERE:
                continue
            known = self._fixed.get((id(origin), key))
            if known is not None:
                properties.append(known[1])
                continue
            text = f"{_text_of(key)}:{_text_of(plain(origin.read(thing, key), numbers))}"
            properties.append(text)
            if key in origin.fixed:
                # The origin is kept, so that its identity stays its own.
                self._fixed[id(origin), key] = origin, text
        return f'{_text_of(head)[:-1]},"properties":{{{",".join(properties)}}}}}'


def _text_of(data: Any) -> str:
    return json.dumps(data, allow_nan=False, separators=(",", ":"))


def number(value: float) -> float | dict[str, str]:
    """A real number; JSON has no word for those that are not finite, so they are marked."""
    value = float(value) + 0.0  # no negative zero
    if math.isfinite(value):
        return value
    return {"$float": "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"}


def plain(value: object, numbers: Mapping[int, int], within: tuple[int, ...] = ()) -> Any:
    """A value as JSON holds it; ``numbers`` maps the ``id`` of each object of the scene to its index.

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
    return _text(value)


def _text(value: object) -> dict[str, str]:
    """What Python shows for a value JSON cannot hold, without addresses, which differ from run to run."""
    try:
        shown = repr(value)
    except Exception:  # noqa: BLE001 - a broken `__repr__` of the user's must not lose the scene
        shown = f"<{type(value).__name__}>"
    return {"$text": _ADDRESS.sub("", shown)}
