"""The facade over python-fcl: do the surfaces of two meshes touch.

FCL knows surfaces only, cannot scale what it has indexed, and crashes the process on bad indices; the meshes
that come here are checked by the constructor of `Mesh`.
"""

from collections import OrderedDict
from typing import Any, Final

import numpy as np

from scenic.runtime.geometry.mesh import Mesh
from scenic.runtime.geometry.poses import Floats, Indices

_KEPT_FACES: Final = 1 << 21
"""Faces of one mesh kept in indices at different sizes, in all."""


class Surface:
    """The indexed faces of a mesh, at one size."""

    def __init__(self, vertices: Floats, faces: Indices) -> None:
        import fcl

        model = fcl.BVHModel()
        model.beginModel(len(faces), len(vertices))
        model.addSubModel(vertices, faces)
        model.endModel()
        # Two handles on one index, so that a surface can be compared with another place of itself.
        self._still: Any = fcl.CollisionObject(model, fcl.Transform())
        self._moving: Any = fcl.CollisionObject(model, fcl.Transform())
        self._request: Any = fcl.CollisionRequest(num_max_contacts=1, enable_contact=False)

    @classmethod
    def of_faces(cls, vertices: Floats, faces: Indices) -> "Surface":
        """The surface of some faces, without the vertices of others: handing those over is what takes the time."""
        used, numbers = np.unique(faces, return_inverse=True)
        return cls(vertices[used], numbers.reshape(faces.shape))

    def touches(self, other: "Surface") -> bool:
        """Whether the surfaces share a point, the other one where it was placed last (if it was) in this frame."""
        import fcl

        return bool(fcl.collide(self._still, other._moving, self._request, fcl.CollisionResult()))

    def place(self, position: Floats, orientation: Floats) -> None:
        """Move the surface to ``position`` ``(3,)``, turned by the quaternion ``(x, y, z, w)``."""
        import fcl

        x, y, z, w = orientation.tolist()
        self._moving.setTransform(fcl.Transform(np.array([w, x, y, z]), position))


class SizedSurfaces:
    """The indices of one mesh at the sizes used last. Get it as ``mesh.derived(SizedSurfaces)``."""

    def __init__(self, mesh: Mesh) -> None:
        self._mesh = mesh
        self._kept: OrderedDict[tuple[float, ...], Surface] = OrderedDict()
        self._most = int(np.clip(_KEPT_FACES // len(mesh.faces), 2, 256))

    def at(self, size: Floats) -> Surface:
        """The surface of the unit mesh multiplied by ``size`` ``(3,)``."""
        key = tuple(size.tolist())
        if key in self._kept:
            self._kept.move_to_end(key)
        else:
            if len(self._kept) == self._most:
                self._kept.popitem(last=False)
            self._kept[key] = Surface(self._mesh.vertices * size, self._mesh.faces)
        return self._kept[key]
