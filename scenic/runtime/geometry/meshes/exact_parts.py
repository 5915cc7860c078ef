"""Exact division of a solid into convex parts, along the planes of its own faces.

An edge at which two faces meet at more than a straight angle, seen from inside, is *reflex*; a solid without one is convex, if it is in one piece.
Cuts along a face at a reflex edge take that edge away (B. Chazelle, "Convex partitions of polyhedra", 1984); the face whose plane has
most of them comes first. Furniture becomes its boards that way; a solid with curved hollows has too many reflex edges.
"""

from collections.abc import Iterator, Sequence
from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt

__all__ = ["exact_parts"]

Floats = npt.NDArray[np.float64]

Plane: TypeAlias = tuple[tuple[float, float, float], float]
"""Unit normal, and distance from the origin along it."""

_FLAT: Final = 1e-5
"""Distance from a plane, in units of the solid's box, that is none: files often have six digits."""
_DEEP: Final = 3e-5
"""By so much may a part fall short of its hull, in the same units."""
_DUST: Final = 1e-8
"""Parts of less volume are left out, and no cut makes them."""
_CRUMB: Final = 1e-5
"""Parts that no cut divides may be their hulls if these have hardly more volume."""
_CHOICE: Final = 8
"""Planes, at most, that are tried for a cut."""
_MOST_FACES: Final = 3000


def exact_parts(vertices: Floats, faces: npt.NDArray[Any], most: int) -> list[Floats] | None:
    """Return the corners ``(n, 3)`` of convex parts that make up a closed solid in its unit box.

    Args:
        vertices: of the solid ``(v, 3)``.
        faces: its triangles ``(f, 3)``, anticlockwise from outside.
        most: the number of parts, cuts counted too, beyond which there is no result.

    Returns:
        The parts; ``None`` for a solid with too many faces or parts.

    """
    import manifold3d  # slow to import

    if len(faces) > _MOST_FACES:
        return None
    whole = manifold3d.Manifold(manifold3d.Mesh64(np.array(vertices, np.float64), np.array(faces, np.uint64)))
    if whole.status() != manifold3d.Error.NoError:
        return None
    waiting, parts, cuts = list(whole.decompose()), [], 0
    while waiting:
        solid = waiting.pop()
        if solid.volume() < _DUST:
            continue
        corners, planes = _examined(solid)
        pieces = _cut(solid, planes)
        if pieces:
            cuts += 1
            waiting += pieces
        elif solid.hull().volume() - solid.volume() < _CRUMB:
            parts.append(corners)
        else:
            return None
        # With many planes, cuts would end in too many parts, much later.
        if max(cuts, len(parts), len(planes) / 2) > most:
            return None
    return parts


def _cut(solid: Any, planes: Sequence[Plane]) -> list[Any]:
    """Return the pieces of a solid on both sides of the first plane that really divides it; none if no plane does."""
    hull = solid.hull().volume() if planes else 0.0
    for plane in planes[:_CHOICE]:
        sides = [side for side in solid.split_by_plane(*plane) if side.volume() > _DUST]
        # A cut may also take off a sheet without thickness.
        if len(sides) == 2 or (sides and sides[0].hull().volume() < (1 - _DEEP) * hull):
            return [piece for side in sides for piece in side.decompose()]
    return []


def _examined(solid: Any) -> tuple[Floats, list[Plane]]:
    """Return the corners of a solid, and planes along which to cut it, the best first; none if it is convex."""
    mesh = solid.to_mesh64()
    corners = np.asarray(mesh.vert_properties, np.float64)[:, :3]
    triangles = corners[np.asarray(mesh.tri_verts, np.int64)]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    real = lengths > 1e-14
    normals = normals[real] / lengths[real, None]
    offsets = np.einsum("fx,fx->f", normals, triangles[real, 0])
    heights = normals @ corners.T - offsets[:, None]
    if not len(normals) or float(heights.max()) < _DEEP:
        return corners, []
    return corners, _planes(corners, np.asarray(mesh.tri_verts, np.int64)[real], normals, offsets)


def _planes(corners: Floats, faces: npt.NDArray[np.int64], normals: Floats, offsets: Floats) -> list[Plane]:
    """Return the planes of faces at reflex edges, those first on which the longest reflex edges lie, all together."""
    reflex = list(_reflex_edges(corners, faces, normals, offsets))
    ends = np.array([(one, other) for one, other, _, _ in reflex], dtype=np.intp).reshape(-1, 2)
    long = np.linalg.norm(corners[ends[:, 0]] - corners[ends[:, 1]], axis=1)
    # Where sheets without thickness hang on a solid, no edge may look reflex.
    candidates = np.unique([face for _, _, *both in reflex for face in both] or range(len(faces)))
    # One face of each plane, of those on both sides of which there is something.
    heights = normals[candidates] @ corners.T - offsets[candidates, None]
    candidates = candidates[(heights.min(axis=1) < -_FLAT) & (heights.max(axis=1) > _FLAT)]
    coefficients = np.round(np.column_stack([normals[candidates], offsets[candidates]]), 6)
    candidates = candidates[np.unique(coefficients, axis=0, return_index=True)[1]]
    away = np.abs(normals[candidates] @ corners[ends].transpose(0, 2, 1) - offsets[candidates, None])
    # Of shape (edges, candidates, 2 ends).
    score = long @ (away.max(axis=2) < _FLAT)
    best = candidates[np.argsort(-score, kind="stable")]
    return [
        ((x, y, z), offset)
        for (x, y, z), offset in zip(normals[best].tolist(), offsets[best].tolist(), strict=True)
    ]


def _reflex_edges(
    corners: Floats, faces: npt.NDArray[np.int64], normals: Floats, offsets: Floats
) -> Iterator[tuple[int, int, int, int]]:
    """Yield the edges at which the solid is not convex: their ends and their faces."""
    sides: dict[tuple[int, int], tuple[int, int]] = {}
    for number, (a, b, c) in enumerate(faces.tolist()):
        for one, other, opposite in ((a, b, c), (b, c, a), (c, a, b)):
            sides[one, other] = (number, opposite)
    for (one, other), (face, _) in sides.items():
        neighbour = sides.get((other, one))
        if neighbour is None or one > other:
            continue
        if float(normals[face] @ corners[neighbour[1]]) - offsets[face] > _FLAT:
            yield one, other, face, neighbour[0]
