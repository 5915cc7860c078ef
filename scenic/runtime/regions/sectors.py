"""Sectors of discs, as regions of the plane (section 9.2 of the specification)."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.flat.outlines import Geometries
from scenic.runtime.geometry.flat.polygons import Polygons
from scenic.runtime.geometry.flat.rectangles import Rectangles
from scenic.runtime.regions.base import Mask, Points
from scenic.runtime.regions.circular import disc_extent
from scenic.runtime.regions.flat import Flat, ragged_polygons, rows_of
from scenic.runtime.regions.planar import PlanarRegion, positive, rounded_outward
from scenic.runtime.values.values import to_heading, to_vector


def sector_box(center: Column, radius: Column, heading: Column, angle: Column) -> tuple[Points, Points]:
    """Return boxes ``(n, 3)`` around sectors, from columns of their centres, radii, headings of their middles, and widths."""
    # The centre, both ends of the arc, and where the arc crosses a direction of the axes.
    half = np.minimum(angle / 2, math.pi)
    ways = [heading - half, heading + half]
    for quarter in range(4):
        way = np.full_like(heading, quarter * math.pi / 2)
        off = np.remainder(way - heading + math.pi, 2 * math.pi) - math.pi
        ways.append(np.where(np.abs(off) <= half, way, heading + half))
    lanes = max(map(len, (center, radius, heading, angle)))
    points = np.zeros((lanes, 7, 3))
    for number, way in enumerate(ways):
        points[:, number, 0], points[:, number, 1] = -radius * np.sin(way), radius * np.cos(way)
    return rounded_outward(center + points.min(axis=1), center + points.max(axis=1))


class SectorRegion(PlanarRegion):
    """A sector of a disc.

    Args:
        center: of the disc; points are drawn at its z.
        radius: metres.
        heading: of the middle of the sector, radians.
        angle: how wide it is, radians.
        resolution: vertices per quadrant of the polygon that must hold the outline of an object.

    """

    parameter_names = ("center", "radius", "heading", "angle")
    draws = 2

    def __init__(
        self,
        center: object,
        radius: object,
        heading: object,
        angle: object,
        resolution: int = 32,
        *,
        name: str | None = None,
    ) -> None:
        self.center = to_vector(center, "`SectorRegion` center")
        self.radius = positive(radius, "`SectorRegion` radius")
        self.heading = to_heading(heading, "`SectorRegion` heading")
        self.angle = positive(angle, "`SectorRegion` angle")
        self.resolution = resolution
        super().__init__(self.center, self.radius, self.heading, self.angle, name=name)

    @property
    def height(self) -> Any:
        return self.center.z

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        center, radius, heading, angle = columns
        reach = radius * np.sqrt(uniforms[0])
        way = heading + (uniforms[1] - 0.5) * np.minimum(angle, 2 * math.pi)
        offset = np.stack([-reach * np.sin(way), reach * np.cos(way), np.zeros_like(reach)], axis=-1)
        return center + offset, None

    def heights(self, *columns: Column) -> Column:
        return columns[0][:, 2]

    def box(self, *columns: Column) -> tuple[Points, Points]:
        return sector_box(*columns)

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return super().extent(*parameters) or disc_extent(*parameters[:2])

    def sizes(self, *columns: Column) -> Column:
        return np.asarray(np.minimum(columns[3], 2 * math.pi) / 2 * columns[1] ** 2)

    def _polar(self, points: Points, center: Column, heading: Column) -> tuple[Column, Column]:
        """Return the distance from the centre, and the angle from the middle of the sector, at most pi."""
        dx, dy = points[:, 0] - center[:, 0], points[:, 1] - center[:, 1]
        turned = np.arctan2(-dx, dy) - heading
        return np.hypot(dx, dy), np.abs(np.remainder(turned + math.pi, 2 * math.pi) - math.pi)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        center, radius, heading, angle = columns
        reach, turned = self._polar(points, center, heading)
        return np.asarray((reach <= radius) & ((turned <= angle / 2) | (reach == 0)))

    def beside(self, points: Points, *columns: Column) -> Column:
        center, radius, heading, angle = columns
        reach, turned = self._polar(points, center, heading)
        # Beside the sector the nearest point lies on one of its two straight edges.
        away = np.maximum(turned - angle / 2, 0)
        along = np.clip(reach * np.cos(away), 0, radius)
        edge = np.hypot(reach * np.cos(away) - along, reach * np.sin(away))
        return np.asarray(np.where(away > 0, edge, np.maximum(reach - radius, 0)))

    def polygons_now(self) -> Any:
        return self._polygon(tuple(self.center), self.radius, self.heading, self.angle)

    def _polygon(self, center: Sequence[float], radius: float, heading: float, angle: float) -> Any:
        import shapely

        if angle >= 2 * math.pi:
            return shapely.Point(center[0], center[1]).buffer(radius, quad_segs=self.resolution)
        count = max(2, math.ceil(angle / (math.pi / 2) * self.resolution) + 1)
        ways = heading + np.linspace(-angle / 2, angle / 2, count)
        arc = np.column_stack([center[0] - radius * np.sin(ways), center[1] + radius * np.cos(ways)])
        return shapely.Polygon([(center[0], center[1]), *arc.tolist()])

    def geometries(self, *columns: Column) -> Geometries:
        import shapely

        corners, counts = self._arcs(*columns)
        center, radius, _, angle = columns
        polygons = ragged_polygons(corners, counts + 1)
        full = np.flatnonzero(np.broadcast_to(angle >= 2 * math.pi, len(polygons)))
        if len(full):
            centres, radii = rows_of((center, radius), full)
            discs = shapely.buffer(shapely.points(centres[:, :2]), radii, quad_segs=self.resolution)
            polygons[full] = discs
        return polygons

    def _arcs(self, *columns: Column) -> tuple[Column, NDArray[np.intp]]:
        """Return the centre and the vertices of the arc ``(n, k + 1, 2)``, and how many of the arc are different, ``(n,)``."""
        lanes = max(map(len, columns))
        center, radius, heading, angle = (np.broadcast_to(c, (lanes, *c.shape[1:])) for c in columns)
        width = np.minimum(angle, 2 * math.pi)
        counts = np.maximum(2, np.ceil(width / (math.pi / 2) * self.resolution).astype(np.intp) + 1)
        numbers = np.minimum(np.arange(int(counts.max())), counts[:, np.newaxis] - 1)
        # As `numpy.linspace` does: the last is the end itself.
        steps = (width / (counts - 1))[:, np.newaxis]
        ends = numbers == counts[:, np.newaxis] - 1
        offsets = np.where(ends, width[:, np.newaxis] / 2, numbers * steps - width[:, np.newaxis] / 2)
        ways = heading[:, np.newaxis] + offsets
        corners = np.empty((lanes, numbers.shape[1] + 1, 2))
        corners[:, 0] = center[:, :2]
        corners[:, 1:, 0] = center[:, :1] - radius[:, np.newaxis] * np.sin(ways)
        corners[:, 1:, 1] = center[:, 1:2] + radius[:, np.newaxis] * np.cos(ways)
        return corners, counts

    def nearest(self, points: Points, *columns: Column) -> Points:
        center, radius, heading, angle = columns
        reach, bearing = self._polar(points, center, heading)
        half = np.minimum(angle / 2, math.pi)
        offset = points[:, :2] - center[:, :2]
        side = np.sin(np.arctan2(-offset[:, 0], offset[:, 1]) - heading)
        edge = heading + np.where(side >= 0, half, -half)
        along = np.clip(reach * np.cos(np.maximum(bearing - half, 0)), 0, radius)
        share = np.minimum(1.0, radius / np.where(reach > 0, reach, 1.0))
        beside = bearing > half
        places = np.array(points)
        places[:, 0] = center[:, 0] + np.where(beside, -along * np.sin(edge), share * offset[:, 0])
        places[:, 1] = center[:, 1] + np.where(beside, along * np.cos(edge), share * offset[:, 1])
        return places

    def meets_rectangles(self, rectangles: Rectangles, *columns: Column) -> tuple[Mask, Mask]:
        """A rectangle beside the disc does not; one with the centre of the disc, or whose middle is inside, does."""
        center, radius = columns[0][:, :2], columns[1]
        away = rectangles.distances(center)
        inside = self.contains_points(rectangles.centre, *columns)
        return np.asarray((radius >= 0) & ((away == 0) | inside)), np.asarray(away <= radius)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Test bodies against the polygon of the sector: by its edges where it is convex, elsewhere by shapely."""
        center, radius, heading, angle = columns
        if all(len(column) == 1 for column in columns):
            polygon = self._polygon(center[0].tolist(), float(radius[0]), float(heading[0]), float(angle[0]))
            if not polygon.area > 0:
                return np.zeros(lanes, np.bool_)
            return containment.in_polygons(body, Polygons(polygon), lanes)
        result = np.zeros(lanes, dtype=np.bool_)
        convex = np.broadcast_to(angle <= math.pi, lanes)
        for mine in (np.flatnonzero(convex), np.flatnonzero(~convex)):
            if len(mine):
                corners, _ = self._arcs(*rows_of(columns, mine))
                # Beyond half a disc, the hull of the arc alone holds the centre.
                outline = corners if convex[mine[0]] else corners[:, 1:]
                result[mine] = containment.in_convex_polygon(body.take(mine), outline, len(mine))
        left = np.flatnonzero(result & ~convex)
        if len(left):
            result[left] = Flat(self.geometries(*rows_of(columns, left)), None).holds(body, left)
        return result
