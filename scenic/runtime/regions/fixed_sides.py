"""Sides of bodies that are the same in every scene: their faces are a table, which needs no geometry to draw from.

Most things stand on something that does not move. Analysis sees where they may be, and where all faces look the same way,
as on a box, the orientation on the side is fixed, too.
"""

from functools import cached_property, lru_cache
from itertools import accumulate
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph import quaternions
from scenic.graph.bounds import Bounds
from scenic.graph.intervals import EPSILON
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, always, stacking
from scenic.graph.operations.distributions import LOOKUP, LookupTable
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.surface import Side, face_orientations, side_contains
from scenic.runtime.geometry.poses import Floats, Poses
from scenic.runtime.values.distributions import primitive
from scenic.runtime.values.values import Orientation, apply, uniform

_MOST_FACES: Final = 4096
"""Larger meshes are left to the geometry: the table is made whenever a program places something there."""


class Triangles:
    """The payload of a point on triangles: their corners in the world, ``(f, 3 corners, 3)``."""

    __slots__ = ("_key", "parts")

    def __init__(self, corners: Floats) -> None:
        self.parts: Final = np.ascontiguousarray(corners.transpose(1, 2, 0))
        """By corner, component and triangle."""
        self._key = self.parts.tobytes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Triangles) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)


def _point(call: Call, face: Column, first: Column, second: Column) -> Column:
    a, b, c = call.payload.parts[:, :, face]
    # The square root makes a strip parallel to the edge opposite the first corner as likely as it is long.
    root = np.sqrt(first)
    return quaternions.components_last((1 - root) * a + root * (1 - second) * b + root * second * c)


def _point_bounds(payload: Triangles, face: Bounds, *_uniforms: Bounds) -> Bounds:
    """Return the box around all triangles; weights that sum to 1 but for rounding leave it by little."""
    slack = 8 * EPSILON * np.abs(payload.parts).max()
    count = len(face.lower)
    return Bounds(
        np.tile(payload.parts.min(axis=(0, 2)) - slack, (count, 1)),
        np.tile(payload.parts.max(axis=(0, 2)) + slack, (count, 1)),
    )


_POINT: Final = stacking(
    "point of triangles",
    always(Kind.VECTOR),
    _point,
    "A uniform point of the triangle of a table that an index draws.",
    bounds=_point_bounds,
)


@dataclass(frozen=True, eq=False)
class FixedSide:
    """The faces of a side of a fixed body.

    Attributes:
        areas: of the faces in the world, ``(f,)``, none of them 0.
        corners: of the faces in the world, ``(f, 3, 3)``.
        orientations: preferred on the faces, quaternions ``(f, 4)``.

    """

    areas: Floats
    corners: Floats
    orientations: Floats

    @staticmethod
    @lru_cache(maxsize=16)
    def of(mesh: Mesh, placement: tuple[Any, Any, Any], side: Side, threshold: float) -> "FixedSide | None":
        """Return the side of a body; ``None`` where it has no faces, or the mesh too many.

        Kept for a while: one thing after the other is placed on the same table.

        Args:
            mesh: its mesh.
            placement: its position, orientation and size.
            side: axis and sign.
            threshold: as of `side_contains`.

        """
        position, orientation, size = placement
        row = (orientation.x, orientation.y, orientation.z, orientation.w)
        body = Body((mesh,), None, Poses.fixed(tuple(position), row, tuple(size)))
        count = len(mesh.faces)
        if count > _MOST_FACES:
            return None
        corners = body.poses.to_world(mesh.triangles[np.newaxis])[0]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas = np.sqrt((normals * normals).sum(axis=1)) / 2
        members = side_contains(
            mesh, body.poses, side, threshold, np.zeros(count, dtype=np.intp), np.arange(count)
        )
        faces = np.flatnonzero(members & (areas > 0))
        if not len(faces):
            return None
        # Nought has no sign here, so that faces which look the same way compare equal.
        return FixedSide(areas[faces], corners[faces], face_orientations(body, faces) + 0.0)

    def placement(self) -> tuple[Any, Any]:
        """A uniform random point, and the preferred orientation there."""
        face = primitive("choice", payload=self._shares)
        point = apply(_POINT, face, uniform(), uniform(), payload=self._triangles)
        if self.orientation is not None:
            return point, self.orientation
        return point, apply(LOOKUP, face, payload=self._table)

    @cached_property
    def orientation(self) -> Any:
        """The preferred orientation on all faces; ``None`` where they differ."""
        first = self.orientations[0]
        return Orientation.of(first.tolist()) if (self.orientations == first).all() else None

    @cached_property
    def _shares(self) -> tuple[float, ...]:
        """Cumulative probabilities of the faces; the last is exactly 1."""
        shares = accumulate((self.areas / self.areas.sum()).tolist())
        return (*tuple(shares)[:-1], 1.0)

    @cached_property
    def _triangles(self) -> Triangles:
        return Triangles(self.corners)

    @cached_property
    def _table(self) -> LookupTable:
        return LookupTable(Kind.ORIENTATION, self.orientations)


__all__ = ["FixedSide"]
