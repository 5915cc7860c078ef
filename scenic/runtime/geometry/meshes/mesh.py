"""Triangle meshes as immutable values, with what is derived from them computed once."""

from collections.abc import Callable
from functools import cached_property
from typing import Any, Final, TypeVar, cast

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.language.errors import MeshError
from scenic.runtime.geometry.meshes import topology
from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import distinct, first_of_each
from scenic.runtime.geometry.store import Arrays, digest_of, kept
from scenic.runtime.geometry.vectors import dot

_MOST_HEIGHTS: Final = 1 << 21
"""Heights of vertices above faces that are looked at to see that a solid is convex without its hull."""

Derived = TypeVar("Derived")

_CONVEXITY_TOLERANCE: Final = 1e-10
"""Part of the volume of its convex hull that a convex solid may miss, for rounding."""


@dataclass(frozen=True, slots=True)
class Hull:
    """A convex hull.

    Attributes:
        vertices: ``(h, 3)``.
        planes: ``(p, 4)`` rows (a, b, c, d) with unit normal; inside means ``a x + b y + c z + d <= 0``.
        volume: of the hull.

    """

    vertices: Floats
    planes: Floats
    volume: float


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh; equal only to itself.

    Most functions of this package want a *unit mesh*: its bounding box is [-1/2, 1/2]³, or 0 on the axes
    in which it is flat. See ``normalized``.

    Attributes:
        vertices: ``(v, 3)`` float64, read-only.
        faces: ``(f, 3)`` vertex indices, anticlockwise seen from outside, read-only.

    Raises:
        MeshError: an index out of range, or a coordinate that is not finite.

    """

    vertices: Floats
    faces: Indices

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=np.float64, order="C")
        faces = np.array(self.faces, dtype=np.intp, order="C")
        if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
            raise MeshError(f"a mesh needs arrays (v, 3) and (f, 3), not {vertices.shape} and {faces.shape}")
        if not len(faces):
            raise MeshError("the mesh has no triangles")
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise MeshError(f"the mesh has a face with vertex indices outside 0 to {len(vertices) - 1}")
        if not np.isfinite(vertices).all():
            raise MeshError("the mesh has a coordinate that is not finite")
        vertices.flags.writeable = False
        faces.flags.writeable = False
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)

    def __reduce__(self) -> tuple[Any, ...]:
        # What is derived stays behind: it is computed again where it is needed, and some of it cannot be pickled.
        return Mesh, (self.vertices, self.faces)

    def __copy__(self) -> "Mesh":
        return self

    def __deepcopy__(self, _memo: object) -> "Mesh":
        return self

    def __repr__(self) -> str:
        return f"<Mesh of {len(self.vertices)} vertices, {len(self.faces)} faces>"

    def derived(self, build: Callable[["Mesh"], Derived]) -> Derived:
        """``build(self)``, computed at the first call with this function and kept with the mesh."""
        if build not in self._derived:
            self._derived[build] = build(self)
        return cast(Derived, self._derived[build])

    @cached_property
    def _derived(self) -> dict[Callable[..., Any], Any]:
        return {}

    @cached_property
    def digest(self) -> bytes:
        """The digest that stands for the mesh where something that follows from it is kept on disk."""
        return digest_of(self.vertices, self.faces)

    @cached_property
    def bounds(self) -> Floats:
        """Lower and upper corner, ``(2, 3)``."""
        return _read_only(np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)]))

    @property
    def extents(self) -> Floats:
        """Size of the bounding box, ``(3,)``."""
        return cast(Floats, self.bounds[1] - self.bounds[0])

    @cached_property
    def triangles(self) -> Floats:
        """Corners of the faces, ``(f, 3, 3)``."""
        return _read_only(self.vertices[self.faces])

    @cached_property
    def area_vectors(self) -> Floats:
        """Half the cross products of the edges, ``(f, 3)``: outward normals as long as the areas."""
        a, b, c = self.triangles[:, 0], self.triangles[:, 1], self.triangles[:, 2]
        return _read_only(0.5 * np.cross(b - a, c - a))

    @cached_property
    def areas(self) -> Floats:
        """Areas of the faces, ``(f,)``."""
        return _read_only(np.linalg.norm(self.area_vectors, axis=1))

    @cached_property
    def normals(self) -> Floats:
        """Unit normals of the faces, ``(f, 3)``; zero for faces without area."""
        areas = self.areas[:, None]
        return _read_only(
            np.divide(self.area_vectors, areas, out=np.zeros_like(self.area_vectors), where=areas > 0)
        )

    @cached_property
    def volume(self) -> float:
        """Enclosed volume; negative if the normals point inwards, meaningless if the mesh is not closed."""
        return topology.signed_volume(self.vertices, self.faces)

    @cached_property
    def census(self) -> topology.EdgeCensus:
        """Open and inconsistent edges."""
        return topology.edge_census(self.faces)

    @property
    def is_volume(self) -> bool:
        """Return whether the mesh bounds a solid: closed, consistently wound, normals outwards."""
        return self.census.is_closed and self.volume > 0

    @cached_property
    def hull(self) -> Hull:
        """The convex hull; fails for flat meshes."""
        if self._is_its_hull:
            planes = np.concatenate([self.normals, self._offsets[:, None]], axis=1)[self.areas > 0]
            planes = _different(planes)
            used = distinct(self.faces)
            return Hull(_read_only(self.vertices[used]), _read_only(planes), self.volume)
        found = kept("hull 1", self.digest, self._computed_hull)
        return Hull(_read_only(found["vertices"]), _read_only(found["planes"]), float(found["volume"]))

    @cached_property
    def outermost(self) -> Floats:
        """Vertices ``(h, 3)`` of which one is farthest in any direction: those of the hull, all of a flat mesh."""
        try:
            return self.hull.vertices
        except (
            RuntimeError
        ):  # scipy's `QhullError`, which takes long to import: it lies in a plane, perhaps in a tilted one
            return self.vertices[distinct(self.faces)]

    def _computed_hull(self) -> Arrays:
        from scipy.spatial import ConvexHull

        # Interior vertices of flat faces are no corners; qhull's default joins such faces, so that no sliver
        # gives a plane of its own.
        hull = ConvexHull(self.vertices)
        planes = _different(hull.equations)
        return {
            "vertices": self.vertices[np.sort(hull.vertices)],
            "planes": planes,
            "volume": np.array(hull.volume),
        }

    @cached_property
    def is_box(self) -> bool:
        """Return whether the solid is its own bounding box."""
        corner = (self.vertices == self.bounds[0]) | (self.vertices == self.bounds[1])
        used = np.zeros(len(self.vertices), dtype=np.bool_)
        used[self.faces] = True
        return bool(
            corner[used].all()
            and self.is_volume
            and np.isclose(self.volume, np.prod(self.extents), rtol=1e-12)
        )

    @cached_property
    def is_convex(self) -> bool:
        """Return whether the solid is convex."""
        if not self.is_volume:
            return False
        # Necessary and cheap: no vertex lies above the plane of a face next to it. It spares large meshes the hull.
        if self._has_concave_neighbours():
            return False
        return (
            self._is_its_hull
            or abs(self.hull.volume - self.volume) <= _CONVEXITY_TOLERANCE * self.hull.volume
        )

    @cached_property
    def _offsets(self) -> Floats:
        """The negative heights of the faces' planes above the origin, ``(f,)``."""
        return _read_only(-dot(self.normals, self.triangles[:, 0]))

    @cached_property
    def _is_its_hull(self) -> bool:
        """Return whether the solid is seen, without the hull, to be convex: no vertex lies above any face."""
        if len(self.vertices) * len(self.faces) > _MOST_HEIGHTS or not self.is_volume:
            return False
        slack = 1e-12 * float(self.extents.max())
        x, y, z = self.vertices[distinct(self.faces)].T
        return all(
            bool((a * x + b * y + c * z + d).max() <= slack)
            for (a, b, c), d in zip(self.normals.tolist(), self._offsets.tolist(), strict=True)
        )

    def _has_concave_neighbours(self) -> bool:
        count = len(self.vertices)
        start, end = self.faces, self.faces[:, [1, 2, 0]]
        apex = self.faces[:, [2, 0, 1]].ravel()
        order = np.argsort((start * count + end).ravel())
        opposite = np.argsort((end * count + start).ravel())
        # In a closed mesh the k-th smallest edge has its partner in the k-th smallest reversed edge.
        face, neighbour_apex = order // 3, apex[opposite]
        offset = self.vertices[neighbour_apex] - self.triangles[face, 0]
        normal = self.normals[face]
        height = dot(offset, normal)
        return bool((height > 1e-7 * float(self.extents.max())).any())

    @cached_property
    def component_vertices(self) -> Floats:
        """One vertex of each connected surface of the mesh, ``(c, 3)``."""
        components = topology.face_components(self.faces, len(self.vertices))
        return _read_only(self.vertices[self.faces[first_of_each(components), 0]])

    def moved(self, matrix: npt.ArrayLike) -> "Mesh":
        """Return the mesh with the vertices turned by a rotation matrix ``(3, 3)``."""
        m = np.asarray(matrix, dtype=np.float64)
        v = self.vertices
        return Mesh(v[:, :1] * m[:, 0] + v[:, 1:2] * m[:, 1] + v[:, 2:] * m[:, 2], self.faces)

    def normalized(self) -> tuple["Mesh", Floats, Floats]:
        """Return the unit mesh, and the centre ``(3,)`` and extents ``(3,)`` of this one's bounding box.

        An axis in which the mesh is flat gets the coordinate 0 and keeps the extent 0.
        """
        lower, upper = self.bounds
        if (lower == -0.5).all() and (upper == 0.5).all():
            return self, np.zeros(3), np.ones(3)
        centre, extents = (lower + upper) / 2, upper - lower
        vertices = np.divide(
            self.vertices - centre, extents, out=np.zeros_like(self.vertices), where=extents > 0
        )
        # Rounding must not leave the extreme vertices a little off the faces of the unit cube.
        vertices = np.where((self.vertices == upper) & (extents > 0), 0.5, np.clip(vertices, -0.5, 0.5))
        vertices = np.where((self.vertices == lower) & (extents > 0), -0.5, vertices)
        return Mesh(vertices, self.faces), centre, extents


def _different(planes: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Planes ``(f, 4)``, each once though some differ by rounding, in order."""
    # Asked for the index, too, NumPy does without its masked arrays, whose import takes a tenth of a start.
    return np.unique(np.round(planes, 12), axis=0, return_index=True)[0]


def _read_only(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    array = np.ascontiguousarray(array)
    array.flags.writeable = False
    return array
