"""Scenes as one HTML page that shows them in three dimensions; it needs no network and no other file.

The page holds every mesh once and, for each scene, where it stands. The viewer itself is the plain JavaScript beside
this module.
"""

import base64
import html as markup
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.formats.colors import linear
from scenic.formats.json_lines import plain
from scenic.formats.lamps import COLORS, color_numbers, first_colors
from scenic.formats.mesh_instances import (
    Array,
    Gallery,
    GroundPiece,
    MeshInstance,
    MeshSurface,
    places_of,
    resting,
)
from scenic.formats.poses import euler_angles, rotation_matrix
from scenic.formats.regions import outlines, view_outline
from scenic.formats.scene_protocols import Scene
from scenic.language.properties import properties_of

_MOST_POINTS: Final = 1000
"""So many points the lines of a region may have where a map is drawn, which shows whole road networks better."""


class Page:
    """A page in the making: scenes are added one by one, and are not kept."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._gallery = Gallery()
        self._scenes: list[dict[str, Any]] = []
        # Most regions are the same in all scenes: their lines are on the page once.
        self._outlines: dict[str, int] = {}
        self._pieces: dict[int, tuple[int, GroundPiece]] = {}

    def __len__(self) -> int:
        return len(self._scenes)

    def add(
        self,
        scene: Scene,
        places: Array | None = None,
        colors: Sequence[Mapping[str, str]] | None = None,
    ) -> tuple[MeshInstance, ...]:
        """Put a scene on the page, after the others; gives what is drawn of it.

        Args:
            scene: the scene.
            places: where objects are or will be, ``(n, 3)``, if not only where the scene has them: the ground is drawn there.
            colors: of lights in each state of a simulation, by their keys.

        """
        instances = self._gallery.add(scene)
        if places is None:
            places = places_of(instances)
        pieces = self._gallery.ground(scene.workspace, places)
        if pieces:
            instances = resting(instances)
        self._scenes.append(
            {
                "seed": str(scene.seed),  # may be larger than JavaScript's numbers
                "k": scene.k,
                "attempts": scene.attempts,
                "params": {str(name): _brief(value) for name, value in scene.params.items()},
                "objects": [_object(instance) for instance in instances],
                "workspace": self._outline(scene.workspace),
                "regions": self._regions(scene, _MOST_POINTS if pieces else math.inf),
                **self._ground(scene, pieces),
                **self._lamps(scene, places, colors),
            }
        )
        return instances

    def _lamps(
        self, scene: Scene, places: Array, colors: Sequence[Mapping[str, str]] | None
    ) -> dict[str, Any]:
        """Return the page's data of lights and signs, empty if the workspace shows none."""
        lamps = self._gallery.lamps(scene.workspace, places)
        if not lamps:
            return {}
        if colors is None:
            colors = [first_colors(scene.workspace, scene.params)]
        return {
            "lamps": [
                {
                    "mesh": item.surface,
                    "position": item.position,
                    "quaternion": item.quaternion,
                    "size": item.size,
                }
                for _, item in lamps
            ],
            "lampColors": packed(color_numbers([key for key, _ in lamps], colors)),
        }

    def _ground(self, scene: Scene, pieces: Sequence[GroundPiece]) -> dict[str, Any]:
        """Return the page's data of the ground, empty if the workspace shows no ground."""
        if not pieces:
            return {}
        numbers = [self._pieces.setdefault(piece.surface, (len(self._pieces), piece))[0] for piece in pieces]
        return {"ground": numbers, "least": getattr(scene.workspace, "minimumZoomSize", 0.0)}

    def _regions(self, scene: Scene, most: float) -> dict[str, int]:
        """Numbers of the lines of named regions; those without lines, with too many, and the workspace, are left out."""
        workspace = getattr(scene.workspace, "region", scene.workspace)
        # Scenes that were read from a file have no regions.
        named = getattr(scene, "regions", {}).items()
        numbers = {name: self._outline(region, most) for name, region in named if region is not workspace}
        return {name: number for name, number in numbers.items() if number is not None}

    def _outline(self, region: object, most: float = math.inf) -> int | None:
        """The number of a region's lines on the page; ``None`` if it has none, or more points than ``most``."""
        lines = [_points(line) for line in outlines(region)]
        if not lines or sum(map(len, lines)) > most:
            return None
        text = json.dumps(lines, allow_nan=False, separators=(",", ":"))
        return self._outlines.setdefault(text, len(self._outlines))

    def data(self) -> dict[str, Any]:
        """Return the contents of the page, as plain data."""
        return {
            "meshes": [_mesh(surface) for surface in self._gallery.surfaces],
            "scenes": self._scenes,
            "outlines": [json.loads(text) for text in self._outlines],
            "lights": list(COLORS.values()),
            **self._grounds(),
        }

    def _grounds(self) -> dict[str, Any]:
        if not self._pieces:
            return {}
        return {
            "grounds": [
                {"mesh": piece.surface, "color": piece.color, "layer": piece.layer, "flat": piece.is_flat}
                for _, piece in self._pieces.values()
            ]
        }

    def text(self) -> str:
        """Return the text of the page, which needs at least one scene."""
        return page_text(self._title, self.data())


def page_text(title: str, data: Mapping[str, object]) -> str:
    """Return the text of a page that holds this data, as `Page.data` gives it."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    parts = {
        "title": markup.escape(title),
        "style": _asset("page.css"),
        "script": _asset("viewer.js"),
        # No text of the scenes may end the element that holds it.
        "data": text.replace("<", "\\u003c"),
    }
    return _filled(_asset("page.html"), parts)


def page(scenes: Iterable[Scene], title: str) -> str:
    """Return the text of a page of these scenes, at least one."""
    made = Page(title)
    for scene in scenes:
        made.add(scene)
    return made.text()


def _mesh(surface: MeshSurface) -> dict[str, str]:
    """Encode corners as 32-bit floats, normals as four 16-bit integers (the last for alignment), and 32-bit indices.

    Colours of corners, where some have their own, are four bytes of linear light, the last 0 for those that have none.
    """
    normals = np.zeros((len(surface.normals), 4), "<i2")
    normals[:, :3] = np.round(surface.normals * 32767)
    mesh = {
        "points": packed(surface.vertices.astype("<f4")),
        "normals": packed(normals),
        "indices": packed(surface.faces.astype("<u4")),
    }
    if surface.paints is not None:
        paints = np.zeros((len(surface.paints), 4), np.uint8)
        has_paint = ~np.isnan(surface.paints[:, 0])
        paints[has_paint, :3], paints[has_paint, 3] = np.round(linear(surface.paints[has_paint]) * 255), 255
        mesh["paints"] = packed(paints)
    return mesh


def packed(values: npt.NDArray[Any]) -> str:
    """Return an array as text: its bytes in base 64."""
    return base64.b64encode(values.tobytes()).decode("ascii")


def _object(instance: MeshInstance) -> dict[str, Any]:
    """Return the page's data of an object: its place, and the properties that its class adds to the built-in ones."""
    builtin = properties_of("Object")
    return {
        "mesh": instance.surface,
        "class": instance.class_name,
        "label": instance.label,
        "position": instance.position,
        "quaternion": instance.quaternion,
        "euler": euler_angles(instance.quaternion),
        "size": instance.size,
        "color": instance.color,
        "ego": instance.is_ego,
        "view": _view(instance),
        "more": {
            name: _brief(value)
            for name, value in instance.thing.properties.items()
            if name not in builtin and not name.startswith("_")
        },
    }


def _points(line: Array) -> list[list[float]]:
    """Return a line as lists of numbers, to a tenth of a millimetre."""
    return [[round(value, 4) for value in point] for point in line.tolist()]


def _view(instance: MeshInstance) -> list[list[list[float]]] | None:
    """Return lines that show the view of an object: of the ego, and of objects with ``showVisibleRegion``."""
    thing = instance.thing
    if not (instance.is_ego or thing.properties.get("showVisibleRegion", False)):
        return None
    angles, distance = thing.properties.get("viewAngles"), thing.properties.get("visibleDistance")
    if not isinstance(angles, tuple | list) or not isinstance(distance, int | float):
        return None
    offset = thing.properties.get("cameraOffset", (0.0, 0.0, 0.0))
    turn = rotation_matrix(instance.quaternion)
    camera = np.array(instance.position) + turn @ np.array([float(value) for value in offset])  # type: ignore[attr-defined] # three numbers
    horizontal, vertical = min(float(angles[0]), 2 * np.pi), min(float(angles[1]), np.pi)
    lines = view_outline(horizontal, vertical, float(distance))
    return [_points(camera + line @ turn.T) for line in lines]


def _brief(value: object) -> str:
    """Return a value in a few words."""
    match plain(value, {}):
        case str() as text:
            words = text
        case float() as real:
            words = f"{real:.6g}"
        case {"$text": str() as text}:
            words = text
        case other:
            words = json.dumps(other)
    return words if len(words) <= 80 else words[:79] + "…"


def _filled(template: str, parts: Mapping[str, str]) -> str:
    """Return the template with ``{{name}}`` replaced; what is put in is not searched again."""
    pieces = template.split("{{")
    result = [pieces[0]]
    for piece in pieces[1:]:
        name, _, rest = piece.partition("}}")
        result += [parts[name], rest]
    return "".join(result)


def _asset(name: str) -> str:
    return (resources.files("scenic.formats") / "viewer" / name).read_text(encoding="utf-8")
