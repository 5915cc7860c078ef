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
    return json.dumps(scene_document(scene), allow_nan=False, separators=(",", ":"))


def scene_document(scene: Scene) -> dict[str, Any]:
    """The scene as plain data that JSON can hold."""
    numbers = {id(thing): index for index, thing in enumerate(scene.objects)}
    names = scene.names
    return {
        "format": FORMAT,
        "version": VERSION,
        "seed": scene.seed,
        "k": scene.k,
        "attempts": scene.attempts,
        "params": {str(name): plain(value, numbers) for name, value in scene.params.items()},
        "ego": None if scene.egoObject is None else numbers[id(scene.egoObject)],
        "objects": [_object(thing, names.get(thing), numbers) for thing in scene.objects],
    }


def _object(thing: SceneObject, name: str | None, numbers: Mapping[int, int]) -> dict[str, Any]:
    quaternion = quaternion_of(thing)
    return {
        "class": type(thing).__name__,
        "name": name,
        "position": [number(value) for value in thing.position],
        "quaternion": [number(value) for value in quaternion],
        "euler": [number(value) for value in euler_angles(quaternion)],
        "size": [number(value) for value in (thing.width, thing.length, thing.height)],
        "shape": plain(thing.shape.source.as_dict(), numbers),
        "properties": {
            key: plain(value, numbers)
            for key, value in sorted(thing.properties.items())
            if key not in TOLD_ELSEWHERE
        },
    }


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
