"""Inputs placed where an answer changes, and solids of another library that know the answer.

A program asks about an arrangement that depends on one number ``d``. Bisection with the oracle finds where its answer
changes; the program draws ``d`` from both sides of that, and every scene is compared with the oracle.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
import numpy.typing as npt
import shapely
import trimesh
from scipy.spatial.transform import Rotation

from tests.runtime.geometry.samples import SHAPES
from tests.runtime.programs import euler, rotation

Floats = npt.NDArray[np.float64]

ROUNDING = 1e-7
"""Metres: arrangements as close to the change as this may be answered either way."""

HAIR = 1e-9
CENTIMETRE = 1e-2


def flip(answer: Callable[[float], bool], low: float, high: float, width: float = 1e-11) -> float:
    """Where an answer changes between two numbers for which it differs."""
    first = answer(low)
    assert answer(high) != first
    while abs(high - low) > width:
        middle = (low + high) / 2
        if answer(middle) == first:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def flips(answer: Callable[[float], bool], places: Sequence[float]) -> list[float]:
    """All changes of an answer between neighbours of a sequence of numbers."""
    answers = [answer(place) for place in places]
    return [
        flip(answer, places[index], places[index + 1])
        for index in range(len(places) - 1)
        if answers[index] != answers[index + 1]
    ]


def compare(
    answer: Callable[[float], bool | None],
    truth: Callable[[float], bool],
    change: float,
    *,
    certain: bool,
) -> None:
    """An answer where the truth changes, beside that, and far enough away to be certain."""
    for off in (0.0, HAIR, -HAIR):
        assert answer(change + off) is None
    for off in (1e-4, -1e-4, CENTIMETRE, -CENTIMETRE):
        found = answer(change + off)
        assert found in (None, truth(change + off))
        if certain and abs(off) == CENTIMETRE:
            assert found is not None


# Solids


@cache
def unit_mesh(name: str) -> tuple[Floats, npt.NDArray[np.int64]]:
    mesh = SHAPES[name]()
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


@dataclass(frozen=True)
class Thing:
    """An object by name of its shape, size, place and Euler angles."""

    shape: str
    size: tuple[float, float, float] = (1, 1, 1)
    position: tuple[float, float, float] = (0, 0, 0)
    angles: tuple[float, float, float] = (0, 0, 0)
    turn: Rotation | None = field(default=None, compare=False)

    @classmethod
    def of(cls, shape: str, found: Any) -> "Thing":
        """An object of a scene."""
        size = (found.width, found.length, found.height)
        return cls(shape, size, tuple(found.position), turn=rotation(found.orientation))

    def vertices(self) -> Floats:
        """Its vertices in the world, by SciPy's rotations."""
        turn = euler(*self.angles) if self.turn is None else self.turn
        corners: Floats = turn.apply(unit_mesh(self.shape)[0] * self.size) + self.position
        return corners

    def solid(self) -> manifold3d.Manifold:
        corners = np.ascontiguousarray(self.vertices())
        faces = np.array(unit_mesh(self.shape)[1], dtype=np.uint64)
        return manifold3d.Manifold(manifold3d.Mesh64(corners, faces))

    def text(self, files: Path, *, position: str = "", width: str = "", angles: str = "") -> str:
        """The object in a program, tolerant of collisions; some parts may be expressions instead."""
        return (
            f"new Object at {position or self.position}, with shape {shape_text(self.shape, files)}, "
            f"with width {width or self.size[0]}, with length {self.size[1]}, with height {self.size[2]}, "
            f"facing {angles or self.angles}, with allowCollisions True"
        )


OWN = {
    "box": "BoxShape()",
    "cylinder": "CylinderShape()",
    "cone": "ConeShape()",
    "spheroid": "SpheroidShape()",
}


def shape_text(name: str, files: Path) -> str:
    """The text of a shape; those that the language does not name are written to a file."""
    if name in OWN:
        return OWN[name]
    path = files / f"{name}.ply"
    if not path.exists():
        vertices, faces = unit_mesh(name)
        trimesh.Trimesh(vertices, faces, process=False).export(path)
    return f"MeshShape.fromFile({str(path)!r})"


def together(one: Thing, other: Thing) -> bool:
    """Whether two solids share a volume."""
    common = one.solid() ^ other.solid()
    return bool(common.volume() > 0)


def apart(one: Thing, other: Thing) -> float:
    """The distance between two solids, up to 1."""
    return float(one.solid().min_gap(other.solid(), 1.0))


def holds(outer: Thing, inner: Thing) -> bool:
    """Whether one solid lies in another."""
    return bool((inner.solid() - outer.solid()).volume() <= 1e-15)


def covers(polygon: shapely.Geometry, thing: Thing) -> bool:
    """Whether the projection of a solid, triangle by triangle, lies in a polygon."""
    corners = thing.vertices()[:, :2]
    triangles = shapely.polygons(corners[unit_mesh(thing.shape)[1]])
    proper = triangles[shapely.area(triangles) > 1e-14]
    points = shapely.MultiPoint(corners)
    return bool(polygon.covers(points) and shapely.covers(polygon, proper).all())
