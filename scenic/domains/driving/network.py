"""Road networks: all elements of a map, and which of them are where (section 2.7 of the driving specification)."""

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import (
    Intersection,
    Lane,
    LaneGroup,
    LaneSection,
    Maneuver,
    NetworkElement,
    PedestrianCrossing,
    Road,
    RoadSection,
    Shoulder,
    Sidewalk,
)
from scenic.domains.driving.elevation import Elevation
from scenic.domains.driving.followed_lines import joined_ground
from scenic.domains.driving.joined_surfaces import JoinedSurface
from scenic.domains.driving.levels import Levels
from scenic.domains.driving.lookups import Finder, RoadDirection
from scenic.domains.driving.path_smoothing import TIGHTEST
from scenic.domains.driving.paths import PathPieces
from scenic.domains.driving.random_elements import NestedFinder, element_at
from scenic.domains.driving.signs import Signal
from scenic.domains.driving.surfaces import GroundedLine
from scenic.language.diagnostics import Diagnostic
from scenic.language.errors import RejectionException
from scenic.runtime.python.opaque import call_later
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.lines import PolylineRegion
from scenic.runtime.regions.planar import PolygonalRegion
from scenic.runtime.regions.spaces import nowhere
from scenic.runtime.values.frozen import Frozen
from scenic.runtime.values.lazy import Lazy, defer
from scenic.runtime.values.values import is_random, to_vector

__all__ = ["RoadNetwork"]

_LATEST: Final = 64
"""Tuples of elements that are known by identity."""


class RoadNetwork(Frozen):
    """A road network, which never changes.

    Attributes:
        elements: all elements by ``uid``.
        roads: ordinary roads, in the order of the file.
        connectingRoads: roads within intersections.
        intersections: the intersections.
        crossings: the pedestrian crossings.
        sidewalks: the sidewalks.
        shoulders: the shoulders.
        signals: the traffic lights and signs.
        driveOnLeft: whether traffic keeps left.
        offset: metres along x, y and z, and radians, by which the coordinates of the map are moved.
        tolerance: metres within which an element counts as being at a place that none holds.
        problems: what is wrong with the map, and what was done instead.
        is_elevated: whether its elements are surfaces in space, and not of the plane.

    """

    def __init__(self, *, tolerance: float = 0.05, driveOnLeft: bool = False) -> None:
        self.tolerance = tolerance
        self.driveOnLeft = driveOnLeft
        self.elements: dict[str, NetworkElement] = {}
        self.roads: tuple[Road, ...] = ()
        self.connectingRoads: tuple[Road, ...] = ()
        self.intersections: tuple[Intersection, ...] = ()
        self.crossings: tuple[PedestrianCrossing, ...] = ()
        self.sidewalks: tuple[Sidewalk, ...] = ()
        self.shoulders: tuple[Shoulder, ...] = ()
        self.signals: tuple[Signal, ...] = ()
        self.offset = (0.0, 0.0, 0.0, 0.0)
        self.problems: tuple[Diagnostic, ...] = ()
        self._fillings: tuple[Any, ...] = ()
        """Polygons that close gaps between the ends of linked lanes."""
        self._elevation = Elevation(())
        self.is_elevated = False
        self.origin: bytes | None = None
        """The digest of all that the network follows from, where that is known."""
        self._finders: dict[Any, Finder] = {}
        self._latest_finders: dict[int, tuple[tuple[NetworkElement, ...], Finder]] = {}
        """Some of them by the identity of the very tuple of elements, which is kept alive here."""
        self._nested_finders: dict[str, NestedFinder] = {}

    @property
    def content_digest(self) -> bytes | None:
        """The digest of the network for `scenic.analysis.identity`; ``None`` where it is not known."""
        return None if self.origin is None else self.origin + bytes([self.is_elevated])

    # What there is

    @cached_property
    def allRoads(self) -> tuple[Road, ...]:
        """Ordinary roads, then connecting ones."""
        return (*self.roads, *self.connectingRoads)

    @cached_property
    def laneGroups(self) -> tuple[LaneGroup, ...]:
        """The lane groups of all roads."""
        return tuple(group for road in self.allRoads for group in road.laneGroups)

    @cached_property
    def lanes(self) -> tuple[Lane, ...]:
        """The lanes of all roads."""
        return tuple(lane for road in self.allRoads for lane in road.lanes)

    @cached_property
    def roadSections(self) -> tuple[RoadSection, ...]:
        """The sections of ordinary roads."""
        return tuple(section for road in self.roads for section in road.sections)

    @cached_property
    def laneSections(self) -> tuple[LaneSection, ...]:
        """The sections of all lanes."""
        return tuple(section for lane in self.lanes for section in lane.sections)

    @cached_property
    def maneuvers(self) -> tuple[Maneuver, ...]:
        """The maneuvers through all intersections."""
        return tuple(maneuver for item in self.intersections for maneuver in item.maneuvers)

    def maneuvers_of(self, signal: Signal) -> tuple[Maneuver, ...]:
        """Return the maneuvers for which a signal holds."""
        return self._controlled.get(signal.uid, ())

    @cached_property
    def _controlled(self) -> dict[str, tuple[Maneuver, ...]]:
        found: dict[str, tuple[Maneuver, ...]] = {}
        for maneuver in self.maneuvers:
            for signal in maneuver.signals:
                found[signal.uid] = (*found.get(signal.uid, ()), maneuver)
        return found

    def speedLimitAt(self, point: object) -> float | None:
        """The speed limit in m/s at a point: that of the lane there; ``None`` where there is none."""
        lane = self.laneAt(point)
        if lane is None:
            return None
        place = self.vector(point)
        import shapely

        along = float(shapely.LineString(lane.line).project(shapely.Point(place.x, place.y)))
        limit: float | None = lane.speedLimitAt(along)
        return limit

    def crossings_along(self, lane: Lane) -> tuple[tuple[PedestrianCrossing, float, float], ...]:
        """Return the pedestrian crossings on a lane, with metres along its centerline to their near and their far edge."""
        crossings = self._crossings_along.get(lane.uid)
        if crossings is None:
            crossings = self._crossings_along[lane.uid] = tuple(self._crossed_by(lane))
        return crossings

    @cached_property
    def _crossings_along(self) -> dict[str, tuple[tuple[PedestrianCrossing, float, float], ...]]:
        return {}

    @cached_property
    def _crossing_tree(self) -> Any:
        import shapely

        return shapely.STRtree([crossing.polygon for crossing in self.crossings])

    def _crossed_by(self, lane: Lane) -> Iterable[tuple[PedestrianCrossing, float, float]]:
        import shapely

        line = shapely.LineString(lane.line)
        for number in sorted(self._crossing_tree.query(lane.polygon, predicate="intersects").tolist()):
            crossing = self.crossings[number]
            part = line.intersection(crossing.polygon)
            if not part.is_empty:
                places = [line.project(shapely.Point(place)) for place in shapely.get_coordinates(part)]
                yield crossing, min(places), max(places)

    # Regions

    @cached_property
    def drivableRegion(self) -> Region:
        """Roads and intersections, without shoulders."""
        return self.region_of((*self.intersections, *self.roads), self._fillings)

    @cached_property
    def roadRegion(self) -> Region:
        """Ordinary roads."""
        return self.region_of(self.roads)

    @cached_property
    def laneRegion(self) -> Region:
        """All lanes."""
        return self.region_of(self.lanes)

    @cached_property
    def intersectionRegion(self) -> Region:
        """All intersections."""
        return self.region_of(self.intersections)

    @cached_property
    def walkableRegion(self) -> Region:
        """Sidewalks and crossings."""
        return self.region_of((*self.sidewalks, *self.crossings))

    @cached_property
    def sidewalkRegion(self) -> Region:
        """All sidewalks."""
        return self.region_of(self.sidewalks)

    @cached_property
    def crossingRegion(self) -> Region:
        """All pedestrian crossings."""
        return self.region_of(self.crossings)

    @cached_property
    def shoulderRegion(self) -> Region:
        """All shoulders."""
        return self.region_of(self.shoulders)

    @cached_property
    def curbRegion(self) -> Region:
        """The curbs of ordinary roads, in the direction of the traffic beside them."""
        curbs = [group.curb for road in self.roads for group in road.laneGroups]
        if not curbs:
            return nowhere
        import shapely

        lines = shapely.MultiLineString([curb.lineString for curb in curbs])
        if not self.is_elevated:
            return PolylineRegion(polyline=lines)
        return GroundedLine(
            lines, joined_ground(self.levels, [curb for curb in curbs if isinstance(curb, GroundedLine)])
        )

    def region_of(self, elements: Sequence[NetworkElement], fillings: Sequence[object] = ()) -> Region:
        """Return the union of elements as a region with their directions; the empty region if there are none.

        Args:
            elements: the elements, in order of precedence.
            fillings: further polygons that belong to it.

        """
        import shapely

        if not elements:
            return nowhere
        if self.is_elevated:
            return JoinedSurface(self, elements, fillings)
        union = shapely.union_all([*(element.polygon for element in elements), *fillings])
        return PolygonalRegion(polygon=union, orientation=self.direction_of(elements))

    def direction_of(self, elements: Sequence[NetworkElement]) -> RoadDirection:
        """Return the field of the first of some elements that holds a point."""
        return RoadDirection("direction of elements", elements, self.tolerance, self._levels_in_space)

    @cached_property
    def roadDirection(self) -> RoadDirection:
        """The direction of traffic."""
        elements = (*self.intersections, *self.roads, *self.shoulders)
        return RoadDirection("roadDirection", elements, self.tolerance, self._levels_in_space)

    # Heights

    @cached_property
    def levels(self) -> Levels:
        """The areas of roads, sidewalks and shoulders with their heights."""
        areas = [
            (element.polygon, element._road_uid)
            for element in (*self.allRoads, *self.sidewalks, *self.shoulders)
        ]
        known = [(polygon, self.road_number(uid)) for polygon, uid in areas if uid in self._elevation.numbers]
        polygons, roads = map(list, zip(*known, strict=True)) if known else ([], [])
        return Levels(self._elevation, polygons, roads, self.content_digest)

    @property
    def _levels_in_space(self) -> Levels | None:
        return self.levels if self.is_elevated else None

    def is_level(self, element: NetworkElement, point: object) -> bool:
        """Return whether a thing over an element is at its height, and not on a bridge above it or on a road below it."""
        return not self.is_elevated or self.levels.is_on(element, point)

    def road_number(self, uid: str | None) -> int:
        """The number of a road in `levels`."""
        return self._elevation.numbers[uid or ""]

    # Paths

    def path_pieces(self, *, backward: bool = False, tightest: float = TIGHTEST) -> PathPieces:
        """Return the pieces of paths that cars share.

        Args:
            backward: those against the direction of lanes.
            tightest: curvature (1/m) that they may have.

        """
        key = backward, tightest
        if key not in self._path_pieces:
            self._path_pieces[key] = PathPieces(
                backward=backward, tightest=tightest, origin=self.origin, lanes=self.elements
            )
        return self._path_pieces[key]

    @cached_property
    def _path_pieces(self) -> dict[tuple[bool, float], PathPieces]:
        return {}

    # What is where

    def vector(self, point: object) -> Any:
        """A point as a vector; its height does not count."""
        return to_vector(point, "a point of the map")

    def findPointIn(self, point: object, elems: Sequence[NetworkElement], reject: object = False) -> Any:
        """Return the first of some elements that contains a point; if none does, the first within the tolerance.

        Args:
            point: anything with a position. Where it is random, so is the element.
            elems: the elements, in order of precedence.
            reject: what to do where there is none: true or a message rejects the sample, else the answer is ``None``.

        """
        place = self.vector(point)
        if isinstance(place, Lazy):
            return defer(self.findPointIn, place, elems, reject)
        if is_random(place):
            return element_at(self._finder(tuple(elems)), place, reject)
        element = self._finder(tuple(elems)).at(place.x, place.y, place.z)
        if element is None and reject:
            error = RejectionException(
                reject if isinstance(reject, str) else "there is no such element at the point"
            )
            error.subject = None if place is point else point
            raise error
        return element

    def _finder(self, elements: tuple[NetworkElement, ...]) -> Finder:
        elements_before, finder = self._latest_finders.get(id(elements), (None, None))
        if elements_before is elements and finder is not None:
            return finder
        key = tuple(map(id, elements))  # they live as long as the network does
        finder = self._finders.get(key)
        if finder is None:
            finder = self._finders[key] = Finder(elements, self.tolerance, self._levels_in_space)
        if len(self._latest_finders) >= _LATEST:
            self._latest_finders.clear()
        self._latest_finders[id(elements)] = elements, finder
        return finder

    def intersections_holding(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return for each place ``(n, 2)`` whether an intersection holds it."""
        return self._finder(self.intersections).holding(places) < len(self.intersections)

    def elementAt(self, point: object, reject: object = False) -> Any:
        """The intersection, road, shoulder or sidewalk at a point, the first of these."""
        return self.findPointIn(
            point, (*self.intersections, *self.roads, *self.shoulders, *self.sidewalks), reject
        )

    def roadAt(self, point: object, reject: object = False) -> Any:
        """The road at a point: an ordinary one first, then a connecting one."""
        return self.findPointIn(point, self.allRoads, reject)

    def laneAt(self, point: object, reject: object = False) -> Any:
        """The lane at a point."""
        return self.findPointIn(point, self.lanes, reject)

    def laneSectionAt(self, point: object, reject: object = False) -> Any:
        """The lane section at a point."""
        return self._through(point, reject, self.lanes, "sections")

    def laneGroupAt(self, point: object, reject: object = False) -> Any:
        """The lane group at a point."""
        return self._through(point, reject, self.allRoads, "laneGroups")

    def crossingAt(self, point: object, reject: object = False) -> Any:
        """The pedestrian crossing at a point."""
        return self.findPointIn(point, self.crossings, reject)

    def intersectionAt(self, point: object, reject: object = False) -> Any:
        """The intersection at a point."""
        return self.findPointIn(point, self.intersections, reject)

    def sidewalkAt(self, point: object, reject: object = False) -> Any:
        """The sidewalk at a point."""
        return self.findPointIn(point, self.sidewalks, reject)

    def shoulderAt(self, point: object, reject: object = False) -> Any:
        """The shoulder at a point."""
        return self.findPointIn(point, self.shoulders, reject)

    def _through(self, point: object, reject: object, elems: Sequence[NetworkElement], parts: str) -> Any:
        """A part of the element at a point."""
        place = self.vector(point)
        if isinstance(place, Lazy):
            return defer(self._through, place, reject, elems, parts)
        if is_random(place):
            return element_at(self._nested(parts, elems), place, reject)
        found = self.findPointIn(point, elems, reject)
        return None if found is None else self.findPointIn(point, getattr(found, parts), reject)

    def _nested(self, parts: str, elems: Sequence[NetworkElement]) -> NestedFinder:
        finder = self._nested_finders.get(parts)
        if finder is None:
            inner = [self._finder(tuple(getattr(element, parts))) for element in elems]
            finder = self._nested_finders[parts] = NestedFinder(self._finder(tuple(elems)), inner)
        return finder

    def nominalDirectionsAt(self, point: object, reject: object = False) -> Any:
        """Return the directions of traffic that are possible at a point: several in an intersection, none off the road."""
        place = self.vector(point)
        if isinstance(place, Lazy):
            return defer(self.nominalDirectionsAt, place, reject)
        if is_random(place):
            return call_later(self.nominalDirectionsAt, place, reject)
        found = self.findPointIn(place, (*self.intersections, *self.roads, *self.shoulders), reject)
        return () if found is None else found.nominalDirectionsAt(place)

    def elevationAt(self, point: object, element: NetworkElement | None = None) -> Any:
        """The height in metres of the road at a point, ``None`` off the road.

        Args:
            point: anything with a position. Where roads pass above each other, its z chooses the nearest one.
            element: the only element to look at, whatever passes above or below.

        """
        place = self.vector(point)
        if isinstance(place, Lazy):
            return defer(self.elevationAt, place, element)
        if is_random(place):
            return call_later(self.elevationAt, place, element)
        (height,) = self.elevations(np.array([[place.x, place.y, place.z]]), element)
        return None if np.isnan(height) else float(height)

    def elevations(
        self, points: NDArray[np.float64], element: NetworkElement | None = None
    ) -> NDArray[np.float64]:
        """Heights ``(n,)`` of the road in metres at points ``(n, 3)``, NaN off the road; see `elevationAt`."""
        if element is None:
            return self.levels.heights(points)
        heights = np.full(len(points), np.nan)
        inside = np.flatnonzero(element.outline.contains(points[:, 0], points[:, 1]))
        heights[inside] = element.surface.heights(points[inside])
        return heights

    def __repr__(self) -> str:
        return f"<Network of {len(self.roads)} roads, {len(self.intersections)} intersections>"

    def __deepcopy__(self, _memo: object) -> "RoadNetwork":
        return self

    def __copy__(self) -> "RoadNetwork":
        return self
