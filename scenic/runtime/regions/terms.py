"""Fixed regions in terms of meshes and shapely geometries."""

import itertools
import math
from typing import Any

import numpy as np

from scenic.runtime.geometry.containment.body_containment import contains_points
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.prisms import prism
from scenic.runtime.geometry.poses import Booleans, Floats, Poses
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.body_regions import OccupiedSpace
from scenic.runtime.regions.composite import exactly_contains
from scenic.runtime.regions.lines import LineRegion, PolylineRegion
from scenic.runtime.regions.meshes import solid_in_world
from scenic.runtime.regions.planar import Footprint, PlanarRegion
from scenic.runtime.regions.view_regions import ViewRegion
from scenic.runtime.regions.volumes import PlacedVolume


def solid_of(region: Region) -> Mesh | None:
    """Return a fixed volume as a mesh of the world; ``None`` for other regions."""
    if isinstance(region, OccupiedSpace):
        return solid_in_world(region.fixed_columns("the solid"))
    if isinstance(region, PlacedVolume):
        dimensions, position, rotation = region.fixed_columns("the solid")
        unit = region.unit_mesh()
        return Mesh(Poses(position, rotation, dimensions).to_world(unit.vertices[np.newaxis])[0], unit.faces)
    return None


def meshed(region: Region) -> Mesh | None:
    """Return a fixed volume as a mesh of the world, views included, whose meshes are somewhat smaller than they are."""
    return region.solid() if isinstance(region, ViewRegion) else solid_of(region)


def flat_of(region: Region) -> tuple[Any, float | None] | None:
    """Return a fixed region of the plane as a shapely geometry with its height; no height means all heights.

    A surface that is not level has no height either: questions about it are those about what is above and below it.
    """
    if isinstance(region, PlanarRegion):
        return region.polygons, float(region.height) if region.has_closed_form else None
    if isinstance(region, Footprint):
        return region.polygons, None
    if isinstance(region, PolylineRegion):
        return region.lineString, 0.0 if region.has_closed_form else None
    return None


def prism_about(solid: Mesh, polygon: object) -> Mesh | None:
    """Return the part of a footprint that can meet a solid, as a prism somewhat higher than it."""
    low, high = float(solid.bounds[0][2]), float(solid.bounds[1][2])
    return prism(polygon, low - 1, high + 1)


def crossings(start: Any, end: Any, solid: Mesh) -> list[float]:
    """Return the places where a segment meets the faces of a solid, as shares of its length (Moeller and Trumbore, 1997)."""
    along = end - start
    a, b, c = (solid.triangles[:, corner] for corner in range(3))
    ab, ac = b - a, c - a
    across = np.cross(along, ac)
    determinant = (ab * across).sum(axis=1)
    crosses = np.abs(determinant) > 1e-14
    inverse = 1 / np.where(crosses, determinant, 1.0)
    offset = start - a
    u = (offset * across).sum(axis=1) * inverse
    cross_products = np.cross(offset, ab)
    v = (cross_products @ along) * inverse
    part = (ac * cross_products).sum(axis=1) * inverse
    hit = crosses & (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (part >= 0) & (part <= 1)
    return [float(value) for value in part[hit]]


def are_inside(solid: Mesh, points: Floats) -> Booleans:
    """Return whether a solid of the world holds points ``(n, 3)``, one by one, ``(n,)``."""
    unit, centre, extents = solid.normalized()
    body = Body((unit,), None, Poses.fixed(centre, size=extents))
    return contains_points(body, points)


def holds(region: Region, point: object) -> bool:
    """Return whether a fixed region holds a point; one of the plane only what is at its height."""
    place = np.asarray(point, dtype=np.float64).reshape(1, 3)
    return bool(exactly_contains(region, place, region.fixed_columns("containment"))[0])


def pieces_inside(line: LineRegion, solid: Mesh) -> list[list[list[float]]]:
    """The ends of the pieces of a line inside a solid: it is cut wherever it meets the surface."""
    pieces = []
    for start, end in zip(line.pieces.starts, line.pieces.ends, strict=True):
        cuts = [0.0, *sorted(crossings(start, end, solid)), 1.0]
        pieces += [
            [start + part * (end - start) for part in (low, high)]
            for low, high in itertools.pairwise(cuts)
            if high - low > 1e-12
        ]
    if not pieces:
        return []
    inside = are_inside(solid, np.array(pieces).mean(axis=1))
    return [[end.tolist() for end in piece] for piece, is_in in zip(pieces, inside, strict=True) if is_in]


def length_inside(line: LineRegion, solid: Mesh) -> float:
    """Return the length of a line inside a solid, in metres."""
    return sum(math.dist(start, end) for start, end in pieces_inside(line, solid))


__all__ = [
    "are_inside",
    "crossings",
    "flat_of",
    "holds",
    "length_inside",
    "meshed",
    "pieces_inside",
    "prism_about",
    "solid_of",
]
