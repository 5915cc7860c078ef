"""Scenes made by hand, with only what the writers may rely on."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh


@dataclass(frozen=True)
class Mesh:
    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.int64]


def unit(mesh: trimesh.Trimesh) -> Mesh:
    """The mesh scaled to the unit box."""
    low, high = mesh.bounds
    return Mesh((mesh.vertices - (low + high) / 2) / (high - low), np.asarray(mesh.faces))


@dataclass(frozen=True)
class Source:
    content: dict[str, Any]

    def as_dict(self) -> dict[str, Any]:
        return self.content


@dataclass(frozen=True)
class Shape:
    mesh: Mesh
    source: Source


BOX = Shape(unit(trimesh.creation.box()), Source({"kind": "box"}))
BALL = Shape(unit(trimesh.creation.icosphere(3)), Source({"kind": "spheroid"}))
CYLINDER = Shape(
    unit(trimesh.creation.cylinder(1, 1, sections=24)), Source({"kind": "cylinder", "sections": 24})
)


@dataclass(frozen=True)
class Turn:
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 1.0

    @staticmethod
    def by(yaw: float, pitch: float = 0.0, roll: float = 0.0) -> "Turn":
        from scipy.spatial.transform import Rotation

        return Turn(*(float(value) for value in Rotation.from_euler("ZXY", [yaw, pitch, roll]).as_quat()))


@dataclass(eq=False)
class Object:
    position: tuple[float, float, float] = (0, 0, 0)
    orientation: Turn = Turn()
    width: float = 1.0
    length: float = 1.0
    height: float = 1.0
    shape: Shape = BOX
    color: tuple[float, ...] | None = None
    others: Mapping[str, object] = field(default_factory=dict)
    yaw: float = 0.0
    pitch: float = 0.0
    roll: float = 0.0

    @property
    def properties(self) -> Mapping[str, object]:
        return {
            "position": self.position,
            "orientation": self.orientation,
            "width": self.width,
            "length": self.length,
            "height": self.height,
            "shape": self.shape,
            "color": self.color,
            **self.others,
        }


class Chair(Object):
    pass


class Origin:
    """All properties of a stand-in, none of them known to be the same in other scenes."""

    fixed: frozenset[str] = frozenset()

    def __init__(self, thing: Object) -> None:
        self.names = self.given = tuple(sorted(thing.properties))

    def read(self, thing: Object, name: str) -> object:
        return thing.properties[name]


@dataclass(eq=False)
class Scene:
    objects: list[Object]
    seed: int = 7
    k: int = 0
    attempts: int = 1
    params: Mapping[str, object] = field(default_factory=dict)
    egoObject: Object | None = None
    names: Mapping[Object, str] = field(default_factory=dict)
    workspace: object = None

    def origin(self, thing: Object) -> Origin:
        return Origin(thing)
