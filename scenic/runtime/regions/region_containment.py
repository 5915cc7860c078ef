"""Containment of a fixed region in another: the cells of the kinds."""

from typing import Final

import numpy as np

from scenic.runtime.geometry.meshes import booleans
from scenic.runtime.geometry.meshes.prisms import shadow
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.body_regions import OccupiedSpace
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.composite import Composite
from scenic.runtime.regions.lines import LineRegion, PolylineRegion
from scenic.runtime.regions.pairs import Cell, PairTable
from scenic.runtime.regions.planar import Footprint, PlanarRegion
from scenic.runtime.regions.scattered import PointSetRegion
from scenic.runtime.regions.terms import flat_of, holds, length_inside, meshed
from scenic.runtime.regions.view_regions import ViewRegion
from scenic.runtime.regions.volumes import PlacedVolume

_SLACK: Final = 1e-9
"""Metres, or parts of a volume, by which something may stick out, for rounding."""


def _disc_holds_flat(disc: CircularRegion, other: Region, tolerance: float) -> bool | None:
    """Return whether a disc contains another region, exactly: a sector of the same circle sticks out of the disc's polygon."""
    import shapely

    flat = flat_of(other)
    if flat is None:
        return None
    if float(disc.height) != flat[1]:
        return False
    reach = shapely.hausdorff_distance(shapely.Point(disc.center.x, disc.center.y), flat[0])
    return bool(reach <= float(disc.radius) + tolerance + _SLACK)


def _flat_holds_flat(one: Region, two: Region, tolerance: float) -> bool | None:
    first, second = flat_of(one), flat_of(two)
    if first is None or second is None:
        return None
    if first[1] is not None and first[1] != second[1]:
        return False
    return bool(first[0].buffer(tolerance + _SLACK).covers(second[0]))


def _region_holds_column(one: Region, _column: Footprint, _tolerance: float) -> bool | None:
    return False if one.dimension == 3 and not isinstance(one, Footprint | Composite) else None


def _solid_holds_solid(one: Region, two: Region, _tolerance: float) -> bool | None:
    first, second = meshed(one), meshed(two)
    if first is None or second is None:
        return None
    rest = booleans.difference(second, [first])
    return rest is None or rest.volume <= _SLACK * second.volume


def _column_holds_solid(column: Footprint, other: Region, tolerance: float) -> bool | None:
    solid = meshed(other)
    if solid is None:
        return None
    return bool(column.polygons.buffer(tolerance + _SLACK).covers(shadow(solid)))


def _solid_holds_line(one: Region, line: LineRegion, tolerance: float) -> bool | None:
    solid = meshed(one)
    if solid is None:
        return None
    return length_inside(line, solid) >= line.length * (1 - _SLACK) - tolerance


_SOLIDS: Final[tuple[type, ...]] = (OccupiedSpace, PlacedVolume, ViewRegion)
_FLATS: Final[tuple[type, ...]] = (PlanarRegion, Footprint, PolylineRegion)

HOLDS: Final = PairTable(
    "whether {} holds {}",
    (
        Cell(
            Region,
            PointSetRegion,
            lambda one, two, _tolerance: all(holds(one, point) for point in np.asarray(two.points)),
        ),
        *(Cell(CircularRegion, two, _disc_holds_flat) for two in _FLATS),
        *(Cell(one, two, _flat_holds_flat) for one in _FLATS for two in _FLATS),
        Cell(Region, Footprint, _region_holds_column),
        *(Cell(one, two, _solid_holds_solid) for one in _SOLIDS for two in _SOLIDS),
        *(Cell(Footprint, two, _column_holds_solid) for two in _SOLIDS),
        Cell(Region, Region, lambda one, two, _tolerance: False if one.dimension < two.dimension else None),
        *(Cell(one, LineRegion, _solid_holds_line) for one in _SOLIDS),
        Cell(Region, Region, None),
    ),
    symmetric=False,
)
"""Rules by which a region of one kind holds one of another; rules that answer ``None`` leave it to those below."""

__all__ = ["HOLDS"]
