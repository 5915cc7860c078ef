"""Polygons as solids: the prism between two heights, and the polygon where a solid is cut."""

from typing import Any

import numpy as np

from scenic.runtime.geometry.meshes.booleans import union
from scenic.runtime.geometry.meshes.mesh import Mesh


def prism(polygon: object, low: float, high: float) -> Mesh | None:
    """The points above a shapely polygon or multipolygon between two heights; ``None`` where it is empty."""
    parts = [
        part for part in getattr(polygon, "geoms", [polygon]) if part.geom_type == "Polygon" and part.area > 0
    ]
    solids = [_prism(part, low, high) for part in parts]
    if len(solids) < 2:
        return solids[0] if solids else None
    return union(solids)


def _prism(polygon: object, low: float, high: float) -> Mesh:
    import shapely

    outline = shapely.orient_polygons(shapely.force_2d(polygon))
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(outline))
    numbers: dict[tuple[float, float], int] = {}

    def number(point: Any) -> int:
        return numbers.setdefault((float(point[0]), float(point[1])), len(numbers))

    caps = []
    for triangle in triangles:
        a, b, c = (np.array(point) for point in triangle.exterior.coords[:3])
        turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        caps.append([number(point) for point in ((a, b, c) if turn > 0 else (a, c, b))])
    walls = []
    for ring in (outline.exterior, *outline.interiors):
        corners = [number(point) for point in ring.coords[:-1]]
        walls += list(zip(corners, [*corners[1:], corners[0]], strict=True))
    count = len(numbers)
    plane = np.array(list(numbers))
    bottom = np.column_stack([plane, np.full(count, low)])
    top = np.column_stack([plane, np.full(count, high)])
    faces = [[i, k, j] for i, j, k in caps]
    faces += [[i + count, j + count, k + count] for i, j, k in caps]
    for i, j in walls:
        faces += [[i, j, j + count], [i, j + count, i + count]]
    return Mesh(np.vstack([bottom, top]), np.array(faces))


def slice_at(solid: Mesh, height: float) -> Any:
    """Return the shapely polygon where a solid meets the plane at a height; empty where it does not."""
    import manifold3d
    import shapely

    vertices, faces = np.array(solid.vertices), np.array(solid.faces, dtype=np.uint64)
    body = manifold3d.Manifold(manifold3d.Mesh64(vertices, faces))
    lower, upper = solid.bounds[0][2], solid.bounds[1][2]
    if not lower <= height <= upper:
        return shapely.Polygon()
    # The plane of a face cuts nothing: it is moved by an invisible distance into the solid.
    inset = 1e-9 * max(1.0, upper - lower)
    loops = body.slice(float(np.clip(height, lower + inset, upper - inset))).to_polygons()
    result = shapely.Polygon()
    for loop in loops:
        result = result.symmetric_difference(shapely.Polygon(loop))
    return result


def shadow(solid: Mesh) -> Any:
    """Return the shapely polygon of a solid seen from above."""
    import shapely

    flat = solid.triangles[:, :, :2]
    (x, y), (u, v) = (flat[:, 1] - flat[:, 0]).T, (flat[:, 2] - flat[:, 0]).T
    return shapely.union_all(shapely.polygons(flat[x * v != y * u]))


__all__ = ["prism", "shadow", "slice_at"]
