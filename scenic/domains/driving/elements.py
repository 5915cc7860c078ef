"""The elements of a road network: polygonal regions with a direction (section 2 of the driving specification)."""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.enumerations import ManeuverType, VehicleType
from scenic.domains.driving.levels import Ground
from scenic.domains.driving.line_directions import Segments, share_along
from scenic.domains.driving.signs import Signal, halt_point_ahead
from scenic.domains.driving.speed_limits import Ranges, limits_along
from scenic.domains.driving.surfaces import GroundedLine, Surface, frames_of
from scenic.graph.kinds import Column, Kind
from scenic.language.errors import RejectionException
from scenic.runtime.geometry.flat.polygons import Polygons
from scenic.runtime.regions.base import Points, Region
from scenic.runtime.regions.lines import PolylineRegion
from scenic.runtime.regions.region_field import RegionField, way_given
from scenic.runtime.values.frozen import Frozen
from scenic.runtime.values.lane_methods import over_lanes
from scenic.runtime.values.values import Orientation

if TYPE_CHECKING:
    from scenic.domains.driving.network import RoadNetwork

__all__ = [
    "Intersection",
    "Lane",
    "LaneGroup",
    "LaneSection",
    "LinearElement",
    "Maneuver",
    "NetworkElement",
    "PedestrianCrossing",
    "Road",
    "RoadSection",
    "Shoulder",
    "Sidewalk",
    "Signal",
]

Floats = NDArray[np.float64]

CARS = frozenset({VehicleType.CAR})


def _required(value: object, what: str) -> Any:
    """Return a value that is there; rejects the sample otherwise."""
    if value is None:
        raise RejectionException(what)
    return value


class NetworkElement(Frozen, Surface):
    """A part of a road network.

    Attributes:
        uid: unique text in its network.
        id: the id in the file of roads, intersections and crossings; the ``uid`` of others.
        name: its name in the file, else empty.
        network: the network.
        polygon: its area, shapely's.
        vehicleTypes: the road users that may be there.
        speedLimit: in m/s, the lowest of its length, if the file says.
        speedLimitRanges: stretches along it (from, to, in metres) with their limits (m/s, or ``None``).
        tags: further words of the file.

    """

    def __init__(
        self,
        network: "RoadNetwork",
        uid: str,
        polygon: Any,
        *,
        id: Any = None,
        name: str = "",
        speed: float | None = None,
        vehicles: frozenset[VehicleType] = CARS,
        tags: frozenset[str] = frozenset(),
    ) -> None:
        Region.__init__(self, name=name)
        self.network = network
        self.uid = uid
        self.id = uid if id is None else id
        self.name = name
        self.polygon = polygon
        self.speedLimit = speed
        self.speedLimitRanges: Ranges = ()
        self.vehicleTypes = vehicles
        self.tags = tags
        self._z = 0.0
        self.has_orientation = True

    @property
    def content_digest(self) -> bytes | None:
        """The digest of the element for `scenic.analysis.identity`; ``None`` where that of its network is not known."""
        network = self.network.content_digest
        return None if network is None else network + self.uid.encode()

    @cached_property
    def orientation(self) -> RegionField:  # made when somebody needs it
        """The direction of traffic within the element."""
        return RegionField(self)

    @property
    def ground(self) -> Ground | None:  # type: ignore[override] # follows from the network
        """Its surface; ``None`` where the network is one of the plane."""
        return self.surface if self.network.is_elevated else None

    @cached_property
    def surface(self) -> Ground:
        """Its surface in space, also where the network is one of the plane."""
        number = self.network.road_number(self._road_uid)
        return Ground(self.network.levels, lambda points: np.full(len(points), number), [number])

    @cached_property
    def outline(self) -> Polygons:  # type: ignore[override] # made when somebody needs it
        """The polygons, for computations."""
        return Polygons(self.polygon)

    def speedLimitAt(self, s: float) -> float | None:
        """The speed limit in m/s at metres along the element; ``None`` where there is none."""
        if not self.speedLimitRanges:
            return self.speedLimit
        limit = float(limits_along(self.speedLimitRanges, np.array([float(s)]))[0])
        return limit if np.isfinite(limit) else None

    @property
    def elementType(self) -> str:
        """The name of the class."""
        return type(self).__name__

    def random_parts(self) -> list[Any]:
        return []

    def sampled(self, sample: object) -> Region:
        return self

    def _guides(self) -> Sequence["LinearElement"]:
        """Return the elements whose directions hold where they are, in their order; the nearest one elsewhere."""
        raise NotImplementedError

    def orientations(self, points: Points, *columns: Column) -> Column:
        """Directions ``(n, 4)`` at points: of the first guide that holds a point, else of the nearest one."""
        headings = self.headings_at(points[:, :2])
        return frames_of(headings) if self.ground is None else self.ground.frames(points, headings)

    def headings_at(self, places: Floats) -> Floats:
        """Headings ``(n,)``, anticlockwise from north, at places ``(n, 2)``."""
        guides = self._guides()
        if len(guides) == 1:
            return guides[0].along(places)
        chosen = self._guide_at(places)
        headings = np.empty(len(places))
        for number in np.unique(chosen):
            mine = chosen == number
            headings[mine] = guides[number].along(places[mine])
        return headings

    def _guide_at(self, places: Floats) -> NDArray[np.intp]:
        """Return the guide ``(n,)`` that holds each place ``(n, 2)``, the first one if several do; else the nearest."""
        guides = self._guides()
        guide_numbers = np.full(len(places), 0 if len(guides) == 1 else -1, dtype=np.intp)
        for number, guide in enumerate(guides):
            free = guide_numbers < 0
            if not free.any():
                break
            guide_numbers[free] = np.where(guide.outline.contains(*places[free].T), number, -1)
        is_outside = guide_numbers < 0
        if is_outside.any():
            distances = np.stack([guide.outline.distances(*places[is_outside].T) for guide in guides])
            guide_numbers[is_outside] = distances.argmin(axis=0)
        return guide_numbers

    def nominalDirectionsAt(self, point: object) -> tuple[Orientation, ...]:
        """Return the directions of traffic that are possible at a point; here one."""
        return (self.orientation[point],)

    def elevationAt(self, point: object) -> Any:
        """The height in metres of this element's own road at a point, whatever passes above or below; ``None`` off the road."""
        return self.network.elevationAt(point, self)

    @property
    def _road_uid(self) -> str | None:
        """The ``uid`` of the road to which the element belongs; ``None`` for parts of intersections."""
        road = getattr(self, "road", None)
        return None if road is None else road.uid

    def line_of(self, vertices: Floats) -> PolylineRegion:
        """Return a line along the element, from its vertices ``(n, 2)``."""
        if self.ground is None:
            return ElementLine([(float(x), float(y), 0.0) for x, y in vertices])
        import shapely

        return GroundedLine(shapely.LineString(vertices), self.ground)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name or ''!r} id={self.id} uid={self.uid!r}>"

    def __reduce__(self) -> Any:
        return _element_of, (self.network, self.uid)


def _element_of(network: "RoadNetwork", uid: str) -> NetworkElement:
    return network.elements[uid]


class LinearElement(NetworkElement):
    """An element with a direction.

    Attributes:
        line: the vertices of its centerline, in its direction, ``(n, 2)``.
        left: those of its left edge.
        right: those of its right edge.

    """

    line: Floats
    left: Floats
    right: Floats
    _successor: Any = None
    _predecessor: Any = None

    def place(self, line: Floats, left: Floats, right: Floats) -> None:
        """Give the element its lines, ``(n, 2)`` each."""
        self.line, self.left, self.right = line, left, right

    @cached_property
    def centerline(self) -> PolylineRegion:
        """The middle of the element, in its direction."""
        return self.line_of(self.line)

    @cached_property
    def leftEdge(self) -> PolylineRegion:
        """The left edge, in the direction of the element."""
        return self.line_of(self.left)

    @cached_property
    def rightEdge(self) -> PolylineRegion:
        """The right edge, in the direction of the element."""
        return self.line_of(self.right)

    @property
    def successor(self) -> Any:
        """The element that follows; rejects the sample if there is none."""
        return _required(self._successor, f"{self.uid} has no successor")

    @property
    def predecessor(self) -> Any:
        """The element before this one; rejects the sample if there is none."""
        return _required(self._predecessor, f"{self.uid} has no predecessor")

    def _guides(self) -> Sequence["LinearElement"]:
        return (self,)

    def along(self, places: Floats) -> Floats:
        """Headings ``(n,)``, anticlockwise from north, of the segments of the centerline nearest to places ``(n, 2)``."""
        return self._segments.headings(places)

    @cached_property
    def _segments(self) -> "Segments":
        return Segments(self.line)

    @over_lanes(
        Kind.VECTOR,
        lambda point, distance, steps=None, stepSize=5: way_given(point, distance, steps, stepSize),
        lambda lanes, element, setting, *columns: element.orientation.follow_together(
            lanes, setting, *columns
        ),
        faults=True,
    )
    def flowFrom(self, point: object, distance: object, steps: int | None = None, stepSize: float = 5) -> Any:
        """The point reached by following the element's direction from a point for a distance in metres."""
        return self.orientation.followFrom(point, distance, steps=steps, stepSize=stepSize)


class ElementLine(Frozen, PolylineRegion):
    """A line of an element, which never changes."""


class LaneSection(LinearElement):
    """The part of a lane in one section of its road."""

    lane: "Lane"
    group: "LaneGroup"
    road: "Road"
    openDriveID: int
    isForward: bool
    adjacentLanes: tuple["LaneSection", ...] = ()
    _laneToLeft: "LaneSection | None" = None
    _laneToRight: "LaneSection | None" = None
    _fasterLane: "LaneSection | None" = None
    _slowerLane: "LaneSection | None" = None

    @property
    def laneToLeft(self) -> "LaneSection":
        """The lane to the left, perhaps of oncoming traffic; rejects the sample if there is none."""
        found: LaneSection = _required(self._laneToLeft, f"{self.uid} has no lane to its left")
        return found

    @property
    def laneToRight(self) -> "LaneSection":
        """The lane to the right; rejects the sample if there is none."""
        found: LaneSection = _required(self._laneToRight, f"{self.uid} has no lane to its right")
        return found

    @property
    def fasterLane(self) -> "LaneSection":
        """The faster lane of the same direction; rejects the sample if there is none."""
        found: LaneSection = _required(self._fasterLane, f"{self.uid} has no faster lane")
        return found

    @property
    def slowerLane(self) -> "LaneSection":
        """The slower lane of the same direction; rejects the sample if there is none."""
        found: LaneSection = _required(self._slowerLane, f"{self.uid} has no slower lane")
        return found

    def shiftedBy(self, offset: int) -> "LaneSection":
        """Return the lane section ``offset`` lanes to the left (to the right if negative); rejects the sample if there is none."""
        current = self
        for _ in range(abs(offset)):
            current = current.laneToLeft if offset > 0 else current.laneToRight
        return current


class Lane(LinearElement):
    """A lane along a whole road."""

    group: "LaneGroup"
    road: "Road"
    sections: tuple[LaneSection, ...] = ()
    maneuvers: tuple["Maneuver", ...] = ()

    @cached_property
    def adjacentLanes(self) -> tuple["Lane", ...]:
        """The lanes beside any of its sections."""
        found = [beside.lane for section in self.sections for beside in section.adjacentLanes]
        return tuple(dict.fromkeys(lane for lane in found if lane is not self))

    @cached_property
    def is_connecting(self) -> bool:
        """Return whether it leads through an intersection."""
        return any(self.road is road for road in self.network.connectingRoads)

    @cached_property
    def halting_signals(self) -> tuple[Signal, ...]:
        """Lights and signs that hold for it, or for maneuvers at its end."""
        own = [signal for signal in self.network.signals if signal.affects(self)]
        ahead = [signal for maneuver in self.maneuvers for signal in maneuver.signals]
        return tuple(
            signal
            for signal in dict.fromkeys((*own, *ahead))
            if signal.isTrafficLight or signal.isStopSign or signal.isYieldSign or signal.isStopLine
        )

    def haltPointAhead(self, position: object, lookahead: float = 80) -> Any:
        """The point at which traffic may have to halt for the first signal ahead of a position; ``None`` if there is none.

        Args:
            position: on the lane.
            lookahead: metres.

        """
        found = halt_point_ahead(self, getattr(position, "position", position), lookahead)
        return None if found is None else self.centerline.pointAlongBy(found[1])

    def sectionAt(self, point: object, reject: object = False) -> LaneSection | None:
        """The section at a point; ``None`` (or a rejection if ``reject``) elsewhere."""
        found: LaneSection | None = self.network.findPointIn(point, self.sections, reject)
        return found


class LaneGroup(LinearElement):
    """All lanes of one direction of a road, the lane nearest the curb first."""

    road: "Road"
    lanes: tuple[Lane, ...] = ()
    _curb: Floats
    _sidewalk: "Sidewalk | None" = None
    _bikeLane: Lane | None = None
    _shoulder: "Shoulder | None" = None
    _opposite: "LaneGroup | None" = None

    @cached_property
    def curb(self) -> PolylineRegion:
        """The border of the road on this side, in the direction of traffic."""
        return self.line_of(self._curb)

    def _guides(self) -> Sequence[LinearElement]:
        return self.lanes

    @property
    def sidewalk(self) -> "Sidewalk":
        """The sidewalk on this side; rejects the sample if there is none."""
        found: Sidewalk = _required(self._sidewalk, f"{self.uid} has no sidewalk")
        return found

    @property
    def bikeLane(self) -> Lane:
        """The bicycle lane on this side; rejects the sample if there is none."""
        found: Lane = _required(self._bikeLane, f"{self.uid} has no bicycle lane")
        return found

    @property
    def shoulder(self) -> "Shoulder":
        """The shoulder on this side; rejects the sample if there is none."""
        found: Shoulder = _required(self._shoulder, f"{self.uid} has no shoulder")
        return found

    @property
    def opposite(self) -> "LaneGroup":
        """The lanes of the other direction; rejects the sample on a one-way road."""
        found: LaneGroup = _required(self._opposite, f"{self.uid} has no opposite group")
        return found

    def laneAt(self, point: object, reject: object = False) -> Lane | None:
        """The lane at a point; ``None`` (or a rejection if ``reject``) elsewhere."""
        found: Lane | None = self.network.findPointIn(point, self.lanes, reject)
        return found


class RoadSection(LinearElement):
    """A part of a road with constant lanes."""

    road: "Road"
    lanes: tuple[LaneSection, ...] = ()
    forwardLanes: tuple[LaneSection, ...] = ()
    backwardLanes: tuple[LaneSection, ...] = ()
    lanesByOpenDriveID: dict[int, LaneSection]

    def _guides(self) -> Sequence[LinearElement]:
        return self.lanes or (self,)

    def laneAt(self, point: object, reject: object = False) -> LaneSection | None:
        """The lane section at a point; ``None`` (or a rejection if ``reject``) elsewhere."""
        found: LaneSection | None = self.network.findPointIn(point, self.lanes, reject)
        return found


class Road(LinearElement):
    """A road of the map; it runs along its reference line."""

    lanes: tuple[Lane, ...] = ()
    forwardLanes: LaneGroup | None = None
    backwardLanes: LaneGroup | None = None
    laneGroups: tuple[LaneGroup, ...] = ()
    sections: tuple[RoadSection, ...] = ()
    signals: tuple["Signal", ...] = ()
    crossings: tuple["PedestrianCrossing", ...] = ()
    sidewalks: tuple["Sidewalk", ...] = ()

    def _guides(self) -> Sequence[LinearElement]:
        return self.lanes or (self,)

    @property
    def _road_uid(self) -> str:  # its own
        return self.uid

    @property
    def is1Way(self) -> bool:
        """Return whether all lanes have one direction."""
        return len(self.laneGroups) < 2

    @cached_property
    def sidewalkRegion(self) -> Region:
        """All of its sidewalks."""
        return self.network.region_of(self.sidewalks)

    def sectionAt(self, point: object, reject: object = False) -> RoadSection | None:
        """The road section at a point; ``None`` (or a rejection if ``reject``) elsewhere."""
        found: RoadSection | None = self.network.findPointIn(point, self.sections, reject)
        return found

    def laneSectionAt(self, point: object, reject: object = False) -> LaneSection | None:
        """The lane section at a point; ``None`` (or a rejection if ``reject``) elsewhere."""
        lane = self.laneAt(point, reject)
        return None if lane is None else lane.sectionAt(point, reject)

    def laneAt(self, point: object, reject: object = False) -> Lane | None:
        """The lane at a point; ``None`` (or a rejection if ``reject``) elsewhere."""
        found: Lane | None = self.network.findPointIn(point, self.lanes, reject)
        return found

    def laneGroupAt(self, point: object, reject: object = False) -> LaneGroup | None:
        """The lane group at a point; ``None`` (or a rejection if ``reject``) elsewhere."""
        found: LaneGroup | None = self.network.findPointIn(point, self.laneGroups, reject)
        return found

    def crossingAt(self, point: object, reject: object = False) -> "PedestrianCrossing | None":
        """The crossing at a point; ``None`` (or a rejection if ``reject``) elsewhere."""
        found: PedestrianCrossing | None = self.network.findPointIn(point, self.crossings, reject)
        return found

    def shiftLanes(self, point: object, offset: int) -> Any:
        """The point at the same share of its lane section, ``offset`` lanes to the left; ``None`` if no such lane exists."""
        section = self.laneSectionAt(point)
        if section is None:
            return None
        current: LaneSection | None = section
        for _ in range(abs(offset)):
            if current is not None:
                current = current._laneToLeft if offset > 0 else current._laneToRight
        if current is None:
            return None
        share = share_along(section.line, point)
        if current.isForward != section.isForward:
            share = 1 - share
        return current.centerline.pointAlongBy(share, normalized=True)


class Sidewalk(LinearElement):
    """A sidewalk along one side of a road."""

    road: Road
    crossings: tuple["PedestrianCrossing", ...] = ()


class Shoulder(LinearElement):
    """The shoulder, parking, stop and border lanes along one side of a road."""

    road: Road
    group: LaneGroup | None = None


class PedestrianCrossing(LinearElement):
    """A crosswalk."""

    parent: "Road | Intersection"
    startSidewalk: Sidewalk | None = None
    endSidewalk: Sidewalk | None = None

    @cached_property
    def conflictingManeuvers(self) -> tuple["Maneuver", ...]:
        """The maneuvers that lead over it: of its intersection, or with a lane of its road."""
        import shapely

        maneuvers = []
        for maneuver in self.network.maneuvers:
            lanes = [maneuver.startLane, maneuver.connectingLane, maneuver.endLane]
            if isinstance(self.parent, Road):
                lanes = [lane for lane in lanes if lane is not None and lane.road is self.parent]
            elif maneuver.intersection is not self.parent:
                continue
            lines = [shapely.LineString(lane.line) for lane in lanes if lane is not None]
            if any(self.polygon.intersects(line) for line in lines):
                maneuvers.append(maneuver)
        return tuple(maneuvers)

    @cached_property
    def _road_uid(self) -> str:
        """The road that it crosses; in an intersection, the connecting road at its middle."""
        if isinstance(self.parent, Road):
            return self.parent.uid
        middle = self.polygon.centroid
        (number,) = self.parent.surface.roads_at(np.array([[middle.x, middle.y, 0.0]]))
        uid: str = self.network.levels.elevation.roads[number].uid
        return uid


class Intersection(NetworkElement):
    """A junction of the map."""

    roads: tuple[Road, ...] = ()
    incomingLanes: tuple[Lane, ...] = ()
    outgoingLanes: tuple[Lane, ...] = ()
    maneuvers: tuple["Maneuver", ...] = ()
    signals: tuple["Signal", ...] = ()
    crossings: tuple[PedestrianCrossing, ...] = ()
    _connecting: tuple[Lane, ...] = ()

    def _guides(self) -> Sequence[LinearElement]:
        return self._connecting

    @cached_property
    def surface(self) -> Ground:
        """The ground below a point: of the first connecting lane that contains the point, or of the nearest connecting lane."""
        numbers = np.array([self.network.road_number(lane.road.uid) for lane in self._connecting])
        return Ground(
            self.network.levels, lambda points: numbers[self._guide_at(points[:, :2])], numbers.tolist()
        )

    @property
    def is3Way(self) -> bool:
        """Return whether three roads meet."""
        return len(self.roads) == 3

    @property
    def is4Way(self) -> bool:
        """Return whether four roads meet."""
        return len(self.roads) == 4

    @property
    def isSignalized(self) -> bool:
        """Return whether there is any signal, stop signs included."""
        return bool(self.signals)

    @property
    def hasTrafficLights(self) -> bool:
        """Return whether there is a traffic light."""
        return any(signal.isTrafficLight for signal in self.signals)

    def maneuversAt(self, point: object) -> list["Maneuver"]:
        """Return the maneuvers whose connecting lane holds a point."""
        found = []
        for maneuver in self.maneuvers:
            lane = maneuver.connectingLane
            if lane is not None and lane.containsPoint(self.network.vector(point)):
                found.append(maneuver)
        return found

    def nominalDirectionsAt(self, point: object) -> tuple[Orientation, ...]:
        """Return the directions of the maneuvers that are possible at a point; that of the nearest one where none is."""
        lanes = [maneuver.connectingLane for maneuver in self.maneuversAt(point)]
        if not lanes:
            return (self.orientation[point],)
        return tuple(lane.orientation[point] for lane in lanes if lane is not None)


class Maneuver(Frozen):
    """A way through an intersection, or on along a road.

    Attributes:
        type: the kind of turn.
        startLane: the lane in which it begins.
        endLane: the lane in which it ends.
        connectingLane: the lane through the intersection; ``None`` where there is none.
        intersection: the intersection; ``None`` outside of any.

    """

    def __init__(
        self,
        startLane: Lane,
        endLane: Lane,
        connectingLane: Lane | None,
        intersection: Intersection | None,
        type: ManeuverType | None = None,
    ) -> None:
        self.startLane = startLane
        self.endLane = endLane
        self.connectingLane = connectingLane
        self.intersection = intersection
        self.type = type or ManeuverType.guessTypeFromLanes(startLane, endLane, connectingLane)

    @cached_property
    def conflictingManeuvers(self) -> tuple["Maneuver", ...]:
        """Maneuvers of the intersection from other lanes whose ways cross this one."""
        import shapely

        if self.intersection is None or self.connectingLane is None:
            return ()
        mine = shapely.linestrings(self.connectingLane.line)
        return tuple(
            other
            for other in self.intersection.maneuvers
            if other.startLane is not self.startLane
            and other.connectingLane is not None
            # Ways into one lane end at one point, but for rounding.
            and (
                other.endLane is self.endLane
                or mine.intersects(shapely.linestrings(other.connectingLane.line))
            )
        )

    @cached_property
    def signals(self) -> tuple[Signal, ...]:
        """The lights and signs that hold for it: of the connecting lane if it has some, else of the lane before."""
        if self.connectingLane is None:
            return ()
        network = self.startLane.network
        on_way = tuple(signal for signal in network.signals if signal.affects(self.connectingLane))
        if on_way:
            return on_way
        return tuple(signal for signal in network.signals if signal.affects(self.startLane))

    @property
    def signal(self) -> Signal | None:
        """The light that holds for it, else the first sign that halts or slows traffic; ``None`` if there is none."""
        order = ("isTrafficLight", "isStopSign", "isYieldSign")
        return next((item for name in order for item in self.signals if getattr(item, name)), None)

    @cached_property
    def reverseManeuvers(self) -> tuple["Maneuver", ...]:
        """Maneuvers of the intersection from the road where this one ends to the road where it begins."""
        if self.intersection is None:
            return ()
        return tuple(
            other
            for other in self.intersection.maneuvers
            if other.startLane.road is self.endLane.road and other.endLane.road is self.startLane.road
        )

    def __repr__(self) -> str:
        return f"<Maneuver {self.type.name} {self.startLane.uid} -> {self.endLane.uid}>"
