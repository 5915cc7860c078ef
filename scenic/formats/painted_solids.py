"""Meshes of simple solids whose faces may have colours of their own, of which what pictures show is put together."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.poses import Triple

__all__ = ["Appearance", "Modeller"]

_Array = npt.NDArray[np.float64]
_Point = Sequence[float]

_LIFT: Final = 0.008
"""Metres between a panel and the face under it."""


@dataclass(frozen=True, slots=True)
class Appearance:
    """The form that pictures show of an object in place of its shape: triangles in the unit box.

    Attributes:
        vertices: corners, ``(v, 3)``.
        faces: triangles as indices of corners, ``(f, 3)``, anticlockwise seen from outside.
        paints: colours of the triangles in sRGB, ``(f, 3)``; NaN for those that take the colour of the object.
        size: width, length and height in metres of what it was made after.

    """

    vertices: _Array
    faces: npt.NDArray[np.int64]
    paints: _Array
    size: Triple


class Modeller:
    """Puts a mesh together of solids, in metres: X to the right, Y ahead, Z up. A ``paint`` of ``None`` is the object's colour."""

    def __init__(self) -> None:
        self._vertices: list[_Array] = []
        self._faces: list[npt.NDArray[np.int64]] = []
        self._paints: list[_Array] = []
        self._count = 0

    def appearance(self) -> Appearance:
        """Return the whole, in the unit box."""
        vertices = np.concatenate(self._vertices)
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        width, length, height = (high - low).tolist()
        return Appearance(
            (vertices - (low + high) / 2) / (high - low),
            np.concatenate(self._faces),
            np.concatenate(self._paints),
            (width, length, height),
        )

    def _add(self, vertices: _Array, faces: Sequence[Sequence[int]], paint: Triple | None) -> None:
        """Add polygons whose corners are numbered in ``vertices``; each is convex and becomes a fan of triangles."""
        triangles = [(face[0], b, c) for face in faces for b, c in pairwise(face[1:])]
        self._vertices.append(vertices)
        self._faces.append(np.array(triangles, dtype=np.int64) + self._count)
        color = (math.nan,) * 3 if paint is None else paint
        self._paints.append(np.tile(np.array(color, dtype=np.float64), (len(triangles), 1)))
        self._count += len(vertices)

    def loft(self, rings: Sequence[Sequence[_Point]], paint: Triple | None = None) -> None:
        """The closed solid through rings of equally many corners, anticlockwise seen from beyond the last ring."""
        vertices = np.array(rings, dtype=np.float64)
        count, around = vertices.shape[:2]
        sides = [
            (k * around + i, k * around + j, (k + 1) * around + j, (k + 1) * around + i)
            for k in range(count - 1)
            for i in range(around)
            for j in [(i + 1) % around]
        ]
        ends = [tuple(reversed(range(around))), tuple(range((count - 1) * around, count * around))]
        self._add(vertices.reshape(-1, 3), [*sides, *ends], paint)

    def box(self, low: _Point, high: _Point, paint: Triple | None = None) -> None:
        """Add the box between two opposite corners."""
        (x, y, z), (x2, y2, z2) = low, high
        self.loft(
            [[(x, y, level), (x2, y, level), (x2, y2, level), (x, y2, level)] for level in (z, z2)], paint
        )

    def tube(
        self,
        start: _Point,
        end: _Point,
        radius: float,
        paint: Triple | None = None,
        *,
        end_radius: float | None = None,
        sides: int = 8,
    ) -> None:
        """The cylinder, or the blunt cone, from one point to another."""
        a, b = np.array(start, dtype=np.float64), np.array(end, dtype=np.float64)
        axis = (b - a) / np.linalg.norm(b - a)
        across = np.cross(axis, [0.0, 0.0, 1.0] if abs(axis[2]) < 0.9 else [1.0, 0.0, 0.0])
        across /= np.linalg.norm(across)
        angles = 2 * np.pi * np.arange(sides) / sides
        circle = np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * np.cross(axis, across)
        self.loft(
            [
                (a + radius * circle).tolist(),
                (b + (radius if end_radius is None else end_radius) * circle).tolist(),
            ],
            paint,
        )

    def ball(self, center: _Point, radii: _Point, paint: Triple | None = None, sides: int = 10) -> None:
        """The ellipsoid about a point, its radii along X, Y and Z."""
        levels = np.linspace(-0.5 * np.pi, 0.5 * np.pi, sides // 2 + 2)[1:-1]
        around = 2 * np.pi * np.arange(sides) / sides
        rings = [
            [
                (math.cos(level) * math.cos(turn), math.cos(level) * math.sin(turn), math.sin(level))
                for turn in around
            ]
            for level in levels
        ]
        self.loft((np.array(rings) * np.array(radii) + np.array(center)).tolist(), paint)

    def hoop(
        self, center: _Point, radius: float, thickness: float, paint: Triple | None = None, sides: int = 20
    ) -> None:
        """The ring about the X axis through a point, as of a tyre, with a square section."""
        angles = 2 * np.pi * np.arange(sides) / sides
        half = thickness / 2
        corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
        vertices = np.array(
            [
                (x, (radius + out) * math.cos(turn), (radius + out) * math.sin(turn))
                for turn in angles
                for x, out in corners
            ]
        )
        faces = [
            (4 * k + i, 4 * k + j, 4 * after + j, 4 * after + i)
            for k in range(sides)
            for after in [(k + 1) % sides]
            for i in range(4)
            for j in [(i + 1) % 4]
        ]
        self._add(vertices + np.array(center), faces, paint)

    def panel(self, corners: Sequence[_Point], paint: Triple | None, inset: float = 0.0) -> None:
        """Add a flat piece on a face with these corners, anticlockwise seen from outside; it is smaller than the face by ``inset`` of its size."""
        points = np.array(corners, dtype=np.float64)
        normal = np.cross(points[1] - points[0], points[-1] - points[0])
        middle = points.mean(axis=0)
        lifted = middle + (points - middle) * (1 - inset) + _LIFT * normal / np.linalg.norm(normal)
        self._add(lifted, [tuple(range(len(points)))], paint)
