"""Several elements of a road network as one surface in space."""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from scenic.domains.driving.elements import NetworkElement
from scenic.domains.driving.levels import Ground
from scenic.domains.driving.lookups import Finder, RoadDirection
from scenic.domains.driving.surfaces import Surface
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.flat.polygons import Polygons
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.regions.base import Mask, Points, Region

if TYPE_CHECKING:
    from scenic.domains.driving.network import RoadNetwork

__all__ = ["JoinedSurface"]


class JoinedSurface(Surface):
    """The union of elements of a network in space.

    Where elements overlap on one level, the first one counts. Where one passes above another, both do: points are drawn from
    *decks*, sets of elements of which none lies above another.

    Args:
        network: the network.
        elements: the elements, in order of precedence.
        fillings: further polygons that belong to it.

    """

    def __init__(
        self, network: "RoadNetwork", elements: Sequence[NetworkElement], fillings: Sequence[object] = ()
    ) -> None:
        import shapely

        self.network = network
        self.elements = tuple(elements)
        self.fillings = tuple(fillings)
        union = shapely.union_all([*(element.polygon for element in elements), *fillings])
        field = network.direction_of(self.elements)
        super().__init__(polygon=union, orientation=field)
        roads = sorted({road for element in elements for road in element.surface.roads})
        self.ground = Ground(network.levels, field.roads_at, roads)

    @cached_property
    def _rivals(self) -> list[set[int]]:
        """For each element, those that pass above or below it."""
        roads = [set(element.surface.roads) for element in self.elements]
        over = [{b for a, b in self.network.levels.pairs if a in mine} for mine in roads]
        return [
            {other for other, theirs in enumerate(roads) if mine & theirs} if mine else set() for mine in over
        ]

    @cached_property
    def _decks(self) -> list[tuple[Polygons, Ground]]:
        """Sets of elements that can be drawn from as areas of the plane."""
        import shapely

        decks: list[list[int]] = []
        for number, rivals in enumerate(self._rivals):
            deck = next((deck for deck in decks if rivals.isdisjoint(deck)), None)
            if deck is None:
                decks.append(deck := [])
            deck.append(number)
        pairs = []
        for index, deck in enumerate(decks):
            elements_of_deck = [self.elements[number] for number in deck]
            # What closes gaps lies on the ground.
            parts = [element.polygon for element in elements_of_deck] + list(
                self.fillings if index == 0 else ()
            )
            field = RoadDirection("deck", elements_of_deck, self.network.tolerance)
            pairs.append(
                (
                    Polygons(shapely.union_all(parts)),
                    Ground(self.network.levels, field.roads_at, self.ground.roads if self.ground else ()),
                )
            )
        return pairs

    def sizes(self, *columns: Column) -> Column:
        return np.full(1, sum(polygons.area for polygons, _ in self._decks))

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        areas = np.array([polygons.area for polygons, _ in self._decks])
        shares = np.concatenate([[0.0], np.cumsum(areas) / areas.sum()])
        deck_numbers = np.clip(np.searchsorted(shares, uniforms[0], side="right") - 1, 0, len(areas) - 1)
        points = np.zeros((uniforms.shape[1], 3))
        for number, (polygons, ground) in enumerate(self._decks):
            mine = np.flatnonzero(deck_numbers == number)
            if len(mine):
                choice = (uniforms[0, mine] - shares[number]) / (shares[number + 1] - shares[number])
                points[mine, :2] = polygons.sample(choice, uniforms[1, mine], uniforms[2, mine])
                points[mine, 2] = ground.heights(points[mine])
        return points, None

    def drawn_extent(self, numbers: Sequence[Bounds], *parameters: Bounds | None) -> Bounds | None:
        return (
            super().drawn_extent(numbers, *parameters) if len(self._decks) == 1 else self.extent(*parameters)
        )

    def draw_cuts(self) -> Column | None:  # type: ignore[override] # several decks have none
        return super().draw_cuts() if len(self._decks) == 1 else None

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        # One of the levels is the nearest, whichever it is.
        return self.outline.contains(points[:, 0], points[:, 1])

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Return the mask of bodies in the union of the elements; a body that passes above or below the element at its middle is not in it."""
        inside = containment.in_polygons(body, self.outline, lanes)
        if not any(self._rivals):
            return inside
        some = np.flatnonzero(inside)
        middles = np.broadcast_to(body.poses.position, (lanes, 3))[some]
        owners = self._finder.near(middles)
        for owner in np.unique(owners).tolist():
            if owner < len(self.elements) and self._rivals[owner]:
                mine = some[owners == owner]
                part = body if len(body) == 1 else body.take(mine)
                inside[mine] = containment.in_polygons(part, self._beside(owner), len(mine))
        return inside

    @cached_property
    def _finder(self) -> Finder:
        return Finder(self.elements, self.network.tolerance, self.network.levels)

    def _beside(self, owner: int) -> Polygons:
        """Return the union of the elements that do not pass above or below one of them."""
        import shapely

        unions = self.__dict__.setdefault("_beside_known", {})
        if owner not in unions:
            rivals = self._rivals[owner]
            parts = [element.polygon for number, element in enumerate(self.elements) if number not in rivals]
            unions[owner] = Polygons(shapely.union_all([*parts, *self.fillings]))
        union: Polygons = unions[owner]
        return union

    def union(self, other: object) -> Region:
        """The points that lie in either region; with another surface of the network, a surface again."""
        if isinstance(other, JoinedSurface) and other.network is self.network:
            elements = dict.fromkeys((*self.elements, *other.elements))
            return JoinedSurface(self.network, tuple(elements), (*self.fillings, *other.fillings))
        return super().union(other)
