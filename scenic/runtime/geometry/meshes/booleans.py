"""The facade over manifold3d: Boolean operations on solids, in double precision."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from scenic.runtime.geometry.meshes.mesh import Mesh


def union(solids: Sequence[Mesh]) -> Mesh | None:
    """Return the union of proper volumes; ``None`` if one of them is not a manifold or the result is empty."""
    return _combined(solids, "Add")


def intersection(solids: Sequence[Mesh]) -> Mesh | None:
    """Return the intersection of proper volumes; ``None`` if one of them is not a manifold or the result is empty."""
    return _combined(solids, "Intersect")


def difference(first: Mesh, others: Sequence[Mesh]) -> Mesh | None:
    """Return the rest of ``first``; ``None`` if one operand is not a manifold or the result is empty."""
    return _combined([first, *others], "Subtract")


def _combined(solids: Sequence[Mesh], operation: str) -> Mesh | None:
    import manifold3d

    operands = [_manifold(solid) for solid in solids]
    if any(operand is None for operand in operands):
        return None
    result = manifold3d.Manifold.batch_boolean(operands, getattr(manifold3d.OpType, operation))
    if result.status() != manifold3d.Error.NoError or result.is_empty():
        return None
    mesh64 = result.to_mesh64()
    return Mesh(mesh64.vert_properties[:, :3], mesh64.tri_verts)


def _manifold(solid: Mesh) -> Any:  # manifold3d has no types
    import manifold3d

    vertices = np.array(solid.vertices)  # copies, because manifold3d refuses read-only arrays
    faces = np.array(solid.faces, dtype=np.uint64)
    result = manifold3d.Manifold(manifold3d.Mesh64(vertices, faces))
    return result if result.status() == manifold3d.Error.NoError else None
