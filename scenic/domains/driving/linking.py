"""Links between roads: successors, intersections, maneuvers (sections 2.5 and 2.6 of the driving specification)."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import Any, Final

import numpy as np

from scenic.domains.driving.building import (
    BuiltRoad,
    Tell,
    angle_about,
    area_of,
    number_or_text,
    union_of,
)
from scenic.domains.driving.elements import Intersection, Lane, LaneGroup, Maneuver, Road, Signal
from scenic.domains.driving.network import RoadNetwork
from scenic.formats.opendrive import records
from scenic.formats.opendrive.records import Link, MapRecords, Problem

__all__ = ["link_roads"]

_GAP: Final = 1.0
"""Metres between the ends of linked lanes up to which a gap is closed."""

_OPPOSITE: Final = {"start": "end", "end": "start"}


def link_roads(
    network: RoadNetwork,
    map: MapRecords,
    built: Mapping[str, BuiltRoad],
    tell: Tell,
    *,
    fill_gaps: bool,
    fill_intersections: bool,
) -> None:
    """Link the roads of a network, and make its intersections and maneuvers."""
    linker = _Linker(network, map, built, tell)
    linker.roads()
    for junction in map.junctions:
        linker.junction(junction, fill=fill_intersections)
    linker.road_ends()
    linker.maneuvers()
    linker.signals()
    fillings = tuple(linker.gaps())
    if fill_gaps:
        network._fillings = fillings


class _Linker:
    def __init__(
        self, network: RoadNetwork, map: MapRecords, built: Mapping[str, BuiltRoad], tell: Tell
    ) -> None:
        self._network = network
        self._map = map
        self._built = built
        self._tell = tell
        self._names = {road.id for road in map.roads}
        self._inside: dict[str | None, list[BuiltRoad]] = defaultdict(list)
        """The roads within each junction."""
        for road in built.values():
            self._inside[road.record.junction].append(road)
        self._intersections: dict[str, Intersection] = {}
        self._maneuvers: dict[int, list[Maneuver]] = defaultdict(list)
        self._joints: list[tuple[Lane, Lane]] = []
        """Pairs of lanes of which the second continues the first."""

    # Roads that follow each other

    def roads(self) -> None:
        """Link the lanes of roads that follow each other without a junction between them."""
        for road in self._built.values():
            for end, link in (("start", road.record.predecessor), ("end", road.record.successor)):
                if link is None or link.element == "junction":
                    continue
                other = self._built.get(link.id)
                if other is None:
                    if link.id not in self._names:
                        message = (
                            f"road {road.record.id} is linked to road {link.id}, which is not there: dropped"
                        )
                        self._tell(Problem("SC623", message, link.line, "link"))
                    continue
                contact = link.contact or self._contact(other, road.record.id)
                self._lanes(road, end, other, contact)

    def _contact(self, other: BuiltRoad, id: str) -> str:
        """The end of a road that is linked to another one."""
        successor = other.record.successor
        return "end" if successor is not None and successor.id == id else "start"

    def _lanes(self, road: BuiltRoad, end: str, other: BuiltRoad, contact: str) -> None:
        """Link lanes at an end of a road with those at the end of another one that touches it."""
        for key, lane in road.contact_lanes(end):
            section = road.record.sections[0 if end == "start" else -1]
            record = next(item for item in section.lanes if item.id == key)
            target = record.predecessor if end == "start" else record.successor
            if target is None:
                target = self._back_link(other, contact, key)
            if target is None:
                continue
            beyond = other.lane_at(contact, target)
            if beyond is None:
                if self._is_declared(other, contact, target):
                    continue
                message = f"lane {key} of road {road.record.id} is linked to lane {target} of road {other.record.id}, which is not there: dropped"
                self._tell(Problem("SC623", message, record.line, "lane link"))
                continue
            forward = road.lane_at(end, key).sections[0].isForward  # type: ignore[union-attr] # it is there
            leaves = forward == (end == "end")
            before, after = (lane, beyond) if leaves else (beyond, lane)
            self._join(before, after)

    def _back_link(self, other: BuiltRoad, contact: str, id: int) -> int | None:
        """The lane at an end of another road that says it leads to a lane of this one."""
        section = other.record.sections[0 if contact == "start" else -1]
        for item in section.lanes:
            if (item.predecessor if contact == "start" else item.successor) == id:
                return item.id
        return None

    def _is_declared(self, road: BuiltRoad, end: str, id: int) -> bool:
        return any(lane.id == id for lane in road.record.sections[0 if end == "start" else -1].lanes)

    def _join(self, before: Lane, after: Lane) -> None:
        before._successor, after._predecessor = after, before
        before.sections[-1]._successor, after.sections[0]._predecessor = (
            after.sections[0],
            before.sections[-1],
        )
        self._joints.append((before, after))

    # Junctions

    def junction(self, junction: records.Junction, *, fill: bool) -> None:
        """Make the intersection of a junction, and the ways through it."""
        import shapely

        inside = self._inside[junction.id]
        ways: list[tuple[BuiltRoad, str, BuiltRoad, records.Connection]] = []
        for connection in junction.connections:
            incoming, connecting = (
                self._built.get(connection.incoming),
                self._built.get(connection.connecting),
            )
            if incoming is None or connecting is None:
                missing = connection.incoming if incoming is None else connection.connecting
                if missing in self._names:
                    continue  # a road without lanes for traffic
                message = f"a connection of junction {junction.id} names road {missing}, which is not there: dropped"
                self._tell(Problem("SC624", message, connection.line, "connection"))
                continue
            ways.append(
                (
                    incoming,
                    self._touching(incoming, junction.id, connecting, connection),
                    connecting,
                    connection,
                )
            )
        if junction.type == "virtual":
            return
        through = {id(road): road for road in (*inside, *(way[2] for way in ways)) if road.road.lanes}
        polygon = union_of(lane.polygon for road in through.values() for lane in road.road.lanes)
        if polygon is None or not ways:
            message = f"junction {junction.id} has no connection that can be used: left out"
            self._tell(Problem("SC624", message, junction.line, "junction"))
            return
        if fill:
            parts = [shapely.Polygon(part.exterior) for part in getattr(polygon, "geoms", [polygon])]
            polygon = area_of(shapely.union_all(parts))
        intersection = Intersection(
            self._network,
            f"intersection{junction.id}",
            polygon,
            id=number_or_text(junction.id),
            name=junction.name,
        )
        self._network.elements[intersection.uid] = intersection
        self._intersections[junction.id] = intersection
        ends: dict[str, tuple[BuiltRoad, str]] = {}
        incoming_lanes: list[Lane] = []
        outgoing: list[Lane] = []
        maneuvers: list[Maneuver] = []
        for incoming, end, connecting, connection in ways:
            ends.setdefault(incoming.record.id, (incoming, end))
            links = connection.links or tuple(
                records.LaneLinks(key, key) for key, _ in incoming.contact_lanes(end)
            )
            for link in links:
                start = incoming.lane_at(end, link.source)
                lane = connecting.lane_at(connection.contact, link.target)
                if start is None or lane is None:
                    self._tell_of_missing(link.source, incoming, end, connection)
                    self._tell_of_missing(link.target, connecting, connection.contact, connection)
                    continue
                if (start.sections[0].isForward) != (end == "end"):
                    continue  # traffic comes out of the junction there
                beyond, where = self._beyond(connecting, _OPPOSITE[connection.contact], link.target)
                self._join(start, lane)
                if beyond is None or where is None:
                    message = f"lane {link.target} of connecting road {connecting.record.id} leads nowhere: no maneuver"
                    self._tell(Problem("SC624", message, connection.line, "leads nowhere"))
                    continue
                ends.setdefault(where[0].record.id, where)
                maneuver = Maneuver(start, beyond, lane, intersection)
                self._maneuvers[id(start)].append(maneuver)
                maneuvers.append(maneuver)
                incoming_lanes.append(start)
                outgoing.append(beyond)
        center = polygon.centroid
        middle = (center.x, center.y)

        def around(road: BuiltRoad, end: str) -> float:
            reference = road.shape.reference
            return angle_about(middle, reference[0 if end == "start" else -1])

        ordered = sorted(ends.values(), key=lambda item: around(*item))
        intersection.roads = tuple(road.road for road, _ in ordered)
        intersection.incomingLanes = _by_angle(incoming_lanes, middle, -1)
        intersection.outgoingLanes = _by_angle(outgoing, middle, 0)
        intersection.maneuvers = tuple(maneuvers)
        lanes = [maneuver.connectingLane for maneuver in maneuvers] + [
            lane for road in inside for lane in road.road.lanes
        ]
        intersection._connecting = tuple(dict.fromkeys(lane for lane in lanes if lane is not None))
        signals: dict[str, Signal] = {}
        for road in (*(item for item, _ in ordered), *inside):
            for signal in road.road.signals:
                signals.setdefault(signal.uid, signal)
        intersection.signals = tuple(signals.values())
        for road in inside:
            self._network.connectingRoads += (road.road,)

    def _tell_of_missing(self, id: int, road: BuiltRoad, end: str, connection: records.Connection) -> None:
        """Report a lane that a connection names and the file lacks; one that is not for traffic is no mistake."""
        section = road.record.sections[0 if end == "start" else -1]
        if all(lane.id != id for lane in section.lanes):
            message = (
                f"a connection names lane {id} of road {road.record.id}, which is not there: no maneuver"
            )
            self._tell(Problem("SC623", message, connection.line, "lane of connection"))

    def _touching(
        self, incoming: BuiltRoad, junction: str, connecting: BuiltRoad, connection: records.Connection
    ) -> str:
        """The end of an incoming road that touches a junction."""
        link = connecting.record.predecessor if connection.contact == "start" else connecting.record.successor
        if link is not None and link.element == "road" and link.id == incoming.record.id and link.contact:
            return link.contact
        for end, at in (("end", incoming.record.successor), ("start", incoming.record.predecessor)):
            if at is not None and at.element == "junction" and at.id == junction:
                return end
        message = f"road {incoming.record.id} leads into junction {junction}, but has no link to it"
        self._tell(
            Problem("SC623", f"{message}: its end counts", incoming.record.line, "link of incoming road")
        )
        return "end"

    def _beyond(
        self, connecting: BuiltRoad, end: str, id: int
    ) -> tuple[Lane | None, tuple[BuiltRoad, str] | None]:
        """The lane that a connecting lane leads into, and the road end where that begins."""
        link: Link | None = connecting.record.predecessor if end == "start" else connecting.record.successor
        if link is None or link.element != "road" or link.id not in self._built:
            return None, None
        other = self._built[link.id]
        contact = link.contact or self._contact(other, connecting.record.id)
        lane = connecting.lane_at(_OPPOSITE[end], id)
        found = None if lane is None else lane._successor
        return found, (other, contact)

    # Everything that needs the intersections

    def road_ends(self) -> None:
        """Give roads, sections and groups what they lead into, and the network its lists."""
        for built in self._built.values():
            road = built.road
            after = self._at_end(built.record.successor)
            before = self._at_end(built.record.predecessor)
            road._successor, road._predecessor = after, before
            if road.sections:
                road.sections[-1]._successor, road.sections[0]._predecessor = after, before
            for group in road.laneGroups:
                forward = group is road.forwardLanes
                ahead, behind = (built.record.successor, built.record.predecessor)
                if not forward:
                    ahead, behind = behind, ahead
                group._successor = self._group_at(group, ahead, -1)
                group._predecessor = self._group_at(group, behind, 0)
        inside = {id(road) for road in self._network.connectingRoads}
        self._network.roads = tuple(
            built.road for built in self._built.values() if id(built.road) not in inside and built.road.lanes
        )
        order = {junction.id: index for index, junction in enumerate(self._map.junctions)}
        self._network.intersections = tuple(
            self._intersections[name] for name in sorted(self._intersections, key=lambda name: order[name])
        )
        first = [road.id for road in self._map.roads]
        place = {name: index for index, name in enumerate(first)}
        self._network.connectingRoads = tuple(
            sorted(
                set(self._network.connectingRoads), key=lambda road: place[str(road.uid).removeprefix("road")]
            )
        )

    def _at_end(self, link: Link | None) -> Road | Intersection | None:
        if link is None:
            return None
        if link.element == "junction":
            if link.id not in self._intersections and not any(j.id == link.id for j in self._map.junctions):
                message = f"a road is linked to junction {link.id}, which is not there: dropped"
                self._tell(Problem("SC623", message, link.line, "link"))
            return self._intersections.get(link.id)
        other = self._built.get(link.id)
        return None if other is None else other.road

    def _group_at(self, group: LaneGroup, link: Link | None, which: int) -> Any:
        if link is None:
            return None
        if link.element == "junction":
            return self._intersections.get(link.id)
        for lane in group.lanes:
            beside = lane._successor if which == -1 else lane._predecessor
            if isinstance(beside, Lane) and hasattr(beside, "group"):
                return beside.group
        return None

    def maneuvers(self) -> None:
        """Give lanes their maneuvers: those of intersections, else straight on."""
        for road in self._network.allRoads:
            for lane in road.lanes:
                found = self._maneuvers.get(id(lane))
                if found:
                    lane.maneuvers = tuple(found)
                elif isinstance(lane._successor, Lane):
                    lane.maneuvers = (Maneuver(lane, lane._successor, None, None),)

    def signals(self) -> None:
        """Resolve references to signals of other roads."""
        known = {
            signal.id: signal
            for road in self._map.roads
            for signal in road.signals
            if isinstance(signal, records.Signal)
        }
        for built in self._built.values():
            added = []
            for item in built.record.signals:
                if not isinstance(item, records.SignalReference):
                    continue
                signal = known.get(item.id)
                if signal is None:
                    message = (
                        f"road {built.record.id} refers to signal {item.id}, which is not there: dropped"
                    )
                    self._tell(Problem("SC623", message, item.line, "signal"))
                    continue
                added.append(Signal(f"signal{signal.id}", signal.id, signal.country, signal.type))
            if added:
                built.road.signals += tuple(added)
        for name, intersection in self._intersections.items():
            signals = {signal.uid: signal for signal in intersection.signals}
            for road in (*(built.road for built in self._inside[name]), *intersection.roads):
                for sign in road.signals:
                    signals.setdefault(sign.uid, sign)
            intersection.signals = tuple(signals.values())

    def gaps(self) -> Iterable[Any]:
        """Polygons between the ends of lanes that are linked but do not touch; reports those far apart."""
        import shapely

        limit = _GAP + self._network.tolerance
        for before, after in self._joints:
            corners = np.stack([before.left[-1], before.right[-1], after.right[0], after.left[0]])
            gap = max(np.hypot(*(corners[0] - corners[3])), np.hypot(*(corners[1] - corners[2])))
            away = np.hypot(*(corners[0] + corners[1] - corners[2] - corners[3])) / 2
            if away > limit:
                message = (
                    f"{before.uid} ends {away:.1f} m from where {after.uid} begins, though it leads into it: "
                    "a link, a place or a width is wrong"
                )
                record = self._built_of(after).record
                self._tell(Problem("SC623", message, record.line, "apart"))
            elif gap > 1e-3:
                hull = area_of(shapely.MultiPoint(corners).convex_hull)
                if hull is not None:
                    yield hull

    def _built_of(self, lane: Lane) -> BuiltRoad:
        return self._built[lane.road.uid.removeprefix("road")]


def _by_angle(lanes: list[Lane], middle: tuple[float, float], place: int) -> tuple[Lane, ...]:
    """Lanes without repetitions, anticlockwise about a place by their first or last point."""
    distinct = dict.fromkeys(lanes)
    return tuple(sorted(distinct, key=lambda lane: angle_about(middle, lane.line[place])))
