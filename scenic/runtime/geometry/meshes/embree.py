"""Ray casting: the one place that knows Embree, which works in single precision."""

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass

Singles: TypeAlias = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Hits:
    """The first hits of rays, an entry for each ray: the triangle (-1 for none), the distance along the ray in lengths of
    its direction, and the weights of the triangle's second and third corners.
    """

    triangle: npt.NDArray[np.int32]
    distance: Singles
    second: Singles
    third: Singles


class RayScene:
    """Triangles that rays can be cast at; ``triangles`` has shape ``(n, 3, 3)``."""

    def __init__(self, triangles: npt.NDArray[Any]) -> None:
        from embreex import rtcore_scene
        from embreex.mesh_construction import TriangleMesh

        self._empty = len(triangles) == 0
        self._scene: Any = rtcore_scene.EmbreeScene()
        if not self._empty:
            self._mesh: Any = TriangleMesh(self._scene, np.ascontiguousarray(triangles, dtype=np.float32))

    def first_hits(self, origins: Singles, directions: Singles) -> Hits:
        """Return the first hit of each ray."""
        count = len(origins)
        if self._empty or not count:
            return Hits(
                np.full(count, -1, np.int32),
                np.full(count, np.inf, np.float32),
                *np.zeros((2, count), np.float32),
            )
        hits: dict[str, Any] = self._scene.run(
            np.ascontiguousarray(origins), np.ascontiguousarray(directions), output=True
        )
        triangle = hits["primID"]
        distance = np.where(triangle >= 0, hits["tfar"], np.float32(np.inf))
        return Hits(triangle, distance, hits["u"], hits["v"])

    def first_triangles(self, origin: Singles, directions: Singles) -> npt.NDArray[np.int32]:
        """Return the triangle that each ray from one place meets first, -1 for none."""
        count = len(directions)
        if self._empty or not count:
            return np.full(count, -1, np.int32)
        origins = np.empty((count, 3), np.float32)
        origins[:] = origin
        triangles: npt.NDArray[np.int32] = self._scene.run(
            origins, np.ascontiguousarray(directions), query="INTERSECT"
        )
        return triangles

    def blocked(self, origins: Singles, directions: Singles, reach: float = 1e30) -> npt.NDArray[np.bool_]:
        """Return whether each ray meets anything within ``reach`` lengths of its direction."""
        count = len(origins)
        if self._empty or not count:
            return np.zeros(count, dtype=bool)
        triangles: npt.NDArray[np.int32] = self._scene.run(
            np.ascontiguousarray(origins),
            np.ascontiguousarray(directions),
            dists=np.full(count, reach, np.float32),
            query="OCCLUDED",
        )
        return triangles >= 0
