"""Meeting of two fixed regions: the cells of the kinds that are not made of others."""

from collections.abc import Iterable
from typing import Final

import numpy as np

from scenic.runtime.geometry.contact.collision import collide
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.prisms import slice_at
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.body_regions import OccupiedSpace, SideSurface
from scenic.runtime.regions.lines import LineRegion, PathRegion, PolylineRegion
from scenic.runtime.regions.meshes import surface_in_world
from scenic.runtime.regions.pairs import Cell
from scenic.runtime.regions.planar import Footprint, PlanarRegion
from scenic.runtime.regions.terms import are_inside, crossings, flat_of, meshed, prism_about
from scenic.runtime.regions.view_regions import ViewRegion
from scenic.runtime.regions.volumes import PlacedVolume
from scenic.runtime.regions.voxels import VoxelRegion


def cells_near(voxels: VoxelRegion, other: Region) -> Iterable[Region]:
    """Return the cells of a region within the box of another."""
    return voxels.cells_within(*other.box(*other.fixed_columns("the box")))


def _flat_meets_flat(one: Region, two: Region) -> bool | None:
    first, second = flat_of(one), flat_of(two)
    if first is None or second is None:
        return None
    same = first[1] is None or second[1] is None or first[1] == second[1]
    return same and bool(first[0].intersects(second[0]))


def _solid_meets_solid(one: Region, two: Region) -> bool | None:
    first, second = meshed(one), meshed(two)
    return None if first is None or second is None else _solids_meet(first, second)


def _solid_meets_line(one: Region, line: LineRegion) -> bool | None:
    solid = meshed(one)
    if solid is None:
        return None
    if are_inside(solid, line.pieces.starts).any():
        return True
    ends = zip(line.pieces.starts, line.pieces.ends, strict=True)
    return any(crossings(start, end, solid) for start, end in ends)


def _solid_meets_flat(one: Region, two: Region) -> bool | None:
    solid, flat = meshed(one), flat_of(two)
    if solid is None or flat is None:
        return None
    polygon, height = flat
    if height is None:
        column = prism_about(solid, polygon)
        return column is not None and _solids_meet(solid, column)
    return bool(slice_at(solid, height).intersects(polygon))


def _path_meets_column(path: PathRegion, column: Footprint) -> bool:
    import shapely

    chains = ([point[:2] for point in chain] for chain in path.chains)
    return any(column.polygons.intersects(shapely.LineString(chain)) for chain in chains)


def _surface_meets_column(surface: SideSurface, column: Footprint) -> bool:
    shell = surface_in_world(surface)
    return shell is not None and _is_over(shell, column.polygons)


def _surface_meets_surface(one: SideSurface, two: SideSurface) -> bool:
    first, second = surface_in_world(one), surface_in_world(two)
    return first is not None and second is not None and _edges_cross(first, second)


def _surface_meets_solid(surface: SideSurface, other: Region) -> bool | None:
    shell, solid = surface_in_world(surface), meshed(other)
    if shell is None or solid is None:
        return False
    return bool(are_inside(solid, shell.vertices).any()) or _edges_cross(shell, solid)


def _crosses_plane(line: LineRegion, region: PlanarRegion) -> bool:
    """Return whether a line in space meets a region of the plane."""
    import shapely

    height, polygon = float(region.height), region.polygons
    for start, end in zip(line.pieces.starts, line.pieces.ends, strict=True):
        if start[2] == end[2]:
            if start[2] == height and polygon.intersects(shapely.LineString([start[:2], end[:2]])):
                return True
        elif min(start[2], end[2]) <= height <= max(start[2], end[2]):
            point = start + (height - start[2]) / (end[2] - start[2]) * (end - start)
            if polygon.intersects(shapely.Point(point[:2])):
                return True
    return False


def _is_over(shell: Mesh, polygons: object) -> bool:
    """Return whether a face of a surface, which may stand upright, has a point above or below polygons."""
    import shapely

    seen = shapely.convex_hull(shapely.multipoints(shell.triangles[:, :, :2]))
    return bool(shapely.intersects(polygons, seen).any())


def _edges_cross(one: Mesh, two: Mesh) -> bool:
    """Return whether an edge of one of two meshes meets a face of the other."""
    for edges_of, faces_of in ((one, two), (two, one)):
        pairs = np.sort(edges_of.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        for first, second in np.unique(pairs, axis=0).tolist():
            if crossings(edges_of.vertices[first], edges_of.vertices[second], faces_of):
                return True
    return False


def _solids_meet(one: Mesh, two: Mesh) -> bool:
    bodies = []
    for solid in (one, two):
        unit, centre, extents = solid.normalized()
        bodies.append(Body((unit,), None, Poses.fixed(centre, size=extents)))
    return not bool(collide(bodies, np.array([[0, 1]]), lanes=1).free[0])


_SOLIDS: Final[tuple[type, ...]] = (OccupiedSpace, PlacedVolume, ViewRegion)
_FLATS: Final[tuple[type, ...]] = (PlanarRegion, Footprint, PolylineRegion)

MEETING: Final = (
    *(Cell(one, two, _flat_meets_flat) for one in _FLATS for two in _FLATS),
    *(Cell(one, two, _solid_meets_solid) for one in _SOLIDS for two in _SOLIDS),
    *(Cell(one, LineRegion, _solid_meets_line) for one in _SOLIDS),
    *(Cell(one, two, _solid_meets_flat) for one in _SOLIDS for two in _FLATS),
    Cell(PathRegion, Footprint, _path_meets_column),
    Cell(PathRegion, PlanarRegion, lambda path, plane: _crosses_plane(path, plane)),
    Cell(SideSurface, Footprint, _surface_meets_column),
    Cell(SideSurface, SideSurface, _surface_meets_surface),
    *(Cell(SideSurface, solid, _surface_meets_solid) for solid in _SOLIDS),
    Cell(SideSurface, PlanarRegion, None),
    Cell(SideSurface, LineRegion, None),
    Cell(LineRegion, LineRegion, None),
)
"""Rules by which two kinds meet, the special cells first; ``None`` where it is not known."""

__all__ = ["MEETING", "cells_near"]
