"""The map under the cars: areas and markings of a road network as patches, tile by tile."""

from collections.abc import Sequence
from functools import cached_property
from itertools import product
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.drawing import COLORS
from scenic.domains.driving.elements import NetworkElement
from scenic.domains.driving.network import RoadNetwork
from scenic.runtime.geometry.patches import Patch

__all__ = ["MapPatches"]

Floats = NDArray[np.float64]

_TILE: Final = 50.0
"""Metres along the side of a tile."""
_AROUND: Final = 60.0
"""Metres around things within which tiles are drawn."""
_SIMPLE: Final = 0.05
"""Metres by which drawn borders may deviate."""
_MARKING: Final = 0.15
"""Metres across the line between two lanes."""
_STRIPE: Final = 0.5
"""Metres across a stripe of a crossing, and between two."""
_STEP: Final = 4.0
"""Metres between the corners of areas that follow the height of a road."""
_LIFTS: Final = MappingProxyType(
    {"shoulder": 0.02, "sidewalk": 0.03, "road": 0.04, "intersection": 0.05, "crossing": 0.06, "lane": 0.06}
)
"""Metres above the ground: what is on top is drawn, where areas overlap."""


class MapPatches:
    """Makes the tiles of a network on demand, each once.

    Args:
        network: the road network.

    """

    def __init__(self, network: RoadNetwork) -> None:
        self._network = network
        self._tiles: dict[tuple[int, int], tuple[Patch, ...]] = {}

    def around(self, places: Floats) -> tuple[Patch, ...]:
        """The patches of the tiles near places ``(n, 2 | 3)``."""
        tiles: dict[tuple[int, int], None] = {}
        for low, high in np.unique(
            np.stack(
                [np.floor((places[:, :2] + reach) / _TILE).astype(int) for reach in (-_AROUND, _AROUND)],
                axis=1,
            ),
            axis=0,
        ):
            tiles.update(dict.fromkeys(product(range(low[0], high[0] + 1), range(low[1], high[1] + 1))))
        return tuple(patch for tile in tiles for patch in self._tile(tile))

    def _tile(self, tile: tuple[int, int]) -> tuple[Patch, ...]:
        known = self._tiles.get(tile)
        if known is None:
            known = self._tiles[tile] = tuple(self._made(tile))
        return known

    @cached_property
    def _areas(self) -> tuple[list[tuple[str, NetworkElement, Any]], Any]:
        """Every area with its kind and element, and an index of them."""
        import shapely

        network = self._network
        areas: list[tuple[str, NetworkElement, Any]] = []
        for kind, elements in (
            ("shoulder", network.shoulders),
            ("sidewalk", network.sidewalks),
            ("road", network.allRoads),
            ("intersection", network.intersections),
            ("crossing", network.crossings),
        ):
            shape_of = _stripes if kind == "crossing" else _whole
            areas += [(kind, element, shape_of(element.polygon)) for element in elements]
        for road in network.roads:
            edges = {id(edge): edge for lane in road.lanes for edge in (lane.left, lane.right)}
            lines = shapely.union_all([shapely.LineString(edge) for edge in edges.values()])
            strip = shapely.buffer(lines, _MARKING / 2, cap_style="flat")
            # Halves of a strip that two tiles share are too narrow to be simplified.
            areas.append(("lane", road, shapely.simplify(strip, _SIMPLE)))
        return areas, shapely.STRtree([polygon for _, _, polygon in areas])

    def _made(self, tile: tuple[int, int]) -> Sequence[Patch]:
        import shapely

        areas, tree = self._areas
        x, y = tile[0] * _TILE, tile[1] * _TILE
        square = shapely.box(x, y, x + _TILE, y + _TILE)
        parts: dict[str, list[tuple[NetworkElement, Any]]] = {}
        for index in sorted(tree.query(square, predicate="intersects").tolist()):
            kind, element, polygon = areas[index]
            cut = shapely.intersection(polygon, square)
            if kind not in ("lane", "crossing"):
                cut = shapely.simplify(cut, _SIMPLE)
            if shapely.area(cut) > 0:
                parts.setdefault(kind, []).append((element, cut))
        return [self._patch(kind, areas_of_kind) for kind, areas_of_kind in parts.items()]

    def _patch(self, kind: str, parts: Sequence[tuple[NetworkElement, Any]]) -> Patch:
        import shapely

        follows = self._network.is_elevated and not self._network.levels.elevation.is_level
        corners = []
        for element, polygon in parts:
            fine = shapely.segmentize(polygon, _STEP) if follows else polygon
            triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(fine))
            places = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3].reshape(-1, 2)
            points = np.column_stack([places, np.full(len(places), _LIFTS[kind])])
            if follows and len(points):
                points[:, 2] += element.surface.heights(points)
            corners.append(points)
        every = np.round(np.concatenate([*corners, np.zeros((0, 3))]), 3)
        vertices, faces = np.unique(every, axis=0, return_inverse=True)
        red, green, blue = (int(COLORS[kind][place : place + 2], 16) / 255 for place in (1, 3, 5))
        return Patch(
            (red, green, blue),
            vertices,
            faces.reshape(-1, 3).astype(np.int64),
            list(_LIFTS).index(kind),
            not self._network.is_elevated,
        )


def _whole(polygon: Any) -> Any:
    return polygon


def _stripes(polygon: Any) -> Any:
    """Return the stripes of a crossing, across the way of pedestrians."""
    import shapely

    box = shapely.get_coordinates(shapely.minimum_rotated_rectangle(polygon))
    if len(box) < 4:
        return polygon
    sides = np.diff(box[:3], axis=0)
    lengths = np.hypot(*sides.T)
    along, across = (sides / lengths[:, None])[np.argsort(lengths)[::-1]]
    length, width = np.sort(lengths)[::-1]
    middle = box[:4].mean(axis=0)
    starts = np.arange(-length / 2, length / 2, 2 * _STRIPE)
    half = across * width / 2
    stripes = [
        [
            middle + along * s - half,
            middle + along * e - half,
            middle + along * e + half,
            middle + along * s + half,
        ]
        for s, e in zip(starts, starts + _STRIPE, strict=True)
    ]
    return shapely.intersection(polygon, shapely.union_all(shapely.polygons(np.array(stripes))))
