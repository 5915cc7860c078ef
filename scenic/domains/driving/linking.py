"""Links between roads: successors, intersections, maneuvers (sections 2.5 and 2.6 of the driving specification)."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np

from scenic.domains.driving.building import (
    BuiltRoad,
    Tell,
    angle_about,
    area_of,
    number_or_text,
    union_of,
)
from scenic.domains.driving.elements import Intersection, Lane, LaneGroup, Maneuver, Road
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.signs import Signal, placement_of, signal_of
from scenic.formats.opendrive import records
from scenic.formats.opendrive.records import Link, MapProblem, MapRecords

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
    linker.tell_of_links()
    if fill_gaps:
        network._fillings = fillings


class _Way(NamedTuple):
    """A connection of a junction: from an end of a road over a connecting road."""

    incoming: BuiltRoad
    end: str
    connecting: BuiltRoad
    connection: records.Connection


class _Crossing:
    """The traffic through one intersection, as its connections are read."""

    def __init__(self) -> None:
        self.ends: dict[str, tuple[BuiltRoad, str]] = {}
        """The roads that meet there, with their ends."""
        self.maneuvers: list[Maneuver] = []
        self.nowhere: dict[int, tuple[BuiltRoad, str, int]] = {}
        """Connecting roads that lead nowhere, each with an end and a lane there."""

    def complete(self, intersection: Intersection, inside: Sequence[BuiltRoad]) -> None:
        """Give an intersection its roads, lanes, maneuvers and signals."""
        center = intersection.polygon.centroid
        middle = (center.x, center.y)

        def around(meeting: tuple[BuiltRoad, str]) -> float:
            road, end = meeting
            return angle_about(middle, road.shape.reference[0 if end == "start" else -1])

        intersection.roads = tuple(road.road for road, _ in sorted(self.ends.values(), key=around))
        incoming = [maneuver.startLane for maneuver in self.maneuvers]
        intersection.incomingLanes = _by_angle(incoming, middle, -1)
        intersection.outgoingLanes = _by_angle([item.endLane for item in self.maneuvers], middle, 0)
        # Together by the lanes that they start from, lanes and maneuvers in the order of the file.
        order = {lane: number for number, lane in enumerate(dict.fromkeys(incoming))}
        self.maneuvers.sort(key=lambda maneuver: order[maneuver.startLane])
        intersection.maneuvers = tuple(self.maneuvers)
        lanes = [maneuver.connectingLane for maneuver in self.maneuvers]
        lanes += [lane for road in inside for lane in road.road.lanes]
        intersection._connecting = tuple(dict.fromkeys(lane for lane in lanes if lane is not None))
        signals: dict[str, Signal] = {}
        for road in (*intersection.roads, *(item.road for item in inside)):
            for signal in road.signals:
                signals.setdefault(signal.uid, signal)
        intersection.signals = tuple(signals.values())


class _Linker:
    def __init__(
        self, network: RoadNetwork, map: MapRecords, built: Mapping[str, BuiltRoad], tell: Tell
    ) -> None:
        self._network = network
        self._map = map
        self._built = built
        self._tell = tell
        self._names = {road.id for road in map.roads}
        self._junctions = {junction.id for junction in map.junctions}
        self._one_sided: set[str] = set()
        """Roads that lack links which others return."""
        self._missing: dict[str, list[int]] = defaultdict(list)
        """Roads, junctions and lanes that links name and the file lacks, and the lines of these links."""
        self._inside: dict[str | None, list[BuiltRoad]] = defaultdict(list)
        """The roads within each junction."""
        for road in built.values():
            self._inside[road.record.junction].append(road)
            if road.record.junction is not None:
                self._look_up_junction(road.record.junction, road.record.line)
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
                    self._look_up_road(link.id, link.line)
                    continue
                contact = link.contact or self._contact(other, road.record.id)
                self._mutual(road, other, contact, link)
                self._lanes(road, end, other, contact)

    def _mutual(self, road: BuiltRoad, other: BuiltRoad, contact: str, link: Link) -> None:
        """Report a road that another one follows, or is followed by, and that does not say so itself."""
        which = "predecessor" if contact == "start" else "successor"
        back = other.record.predecessor if contact == "start" else other.record.successor
        if which in other.record.lost:
            return
        if back is None and road.record.junction is None and other.record.junction is None:
            message = (
                f"road {other.record.id} has no {which}, but road {road.record.id} is linked to it: completed"
            )
            if other.record.id not in self._one_sided:
                self._tell(MapProblem("SC623", message, other.record.line, "one-sided"))
            self._one_sided.add(other.record.id)

    def _look_up_road(self, id: str, line: int) -> None:
        """Report a link to a missing road, unless the road was omitted for a reported fault."""
        if id not in self._names and not {f"road {id}", "road ?"} & self._map.left_out:
            self._missing[f"road {id}"].append(line)

    def _look_up_junction(self, id: str, line: int) -> None:
        """Note a link to a junction that is not there, as for roads."""
        if id not in self._junctions and not {f"junction {id}", "junction ?"} & self._map.left_out:
            self._missing[f"junction {id}"].append(line)

    def _look_up_lane(self, road: BuiltRoad, end: str, id: int, line: int) -> None:
        """Report a link to a missing lane; a lane that was omitted, or is not for traffic, is not a mistake."""
        section = road.record.sections[0 if end == "start" else -1]
        if section.is_whole and all(lane.id != id for lane in section.lanes):
            self._missing[f"lane {id} at the {end} of road {road.record.id}"].append(line)

    def tell_of_links(self) -> None:
        """Report what links name and the file lacks, once for each road that it concerns."""
        roads: dict[str, list[str]] = defaultdict(list)
        for what in self._missing:
            lane, _, road = what.partition(" of ")
            roads[road or lane].append(what)
        for missing_names in roads.values():
            lines = sorted(line for what in missing_names for line in self._missing[what])
            names = f"{len(lines)} links name" if len(lines) > 1 else "a link names"
            are = "are" if len(missing_names) > 1 else "is"
            message = f"{', '.join(missing_names)}, which {names}, {are} not there: dropped"
            self._tell(MapProblem("SC623", message, lines[0], "dangling"))

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
                self._look_up_lane(other, contact, target, record.line)
                continue
            forward = road.lane_at(end, key).sections[0].isForward  # type: ignore[union-attr] # it is there
            leaves = forward == (end == "end")
            before, after = (lane, beyond) if leaves else (beyond, lane)
            self._join(before, after)

    def _back_link(self, other: BuiltRoad, contact: str, id: int) -> int | None:
        """The lane at an end of another road whose link leads to a lane of this road."""
        section = other.record.sections[0 if contact == "start" else -1]
        for item in section.lanes:
            if (item.predecessor if contact == "start" else item.successor) == id:
                return item.id
        return None

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
        inside = self._inside[junction.id]
        ways = list(self._ways(junction))
        if junction.type == "virtual":
            return
        intersection = self._intersection(junction, inside, ways, fill=fill)
        if intersection is None:
            return
        crossing = _Crossing()
        for way in ways:
            self._cross(way, intersection, crossing)
        for connecting, contact, lane_id in crossing.nowhere.values():
            self._tell_of_end(connecting, _OPPOSITE[contact], lane_id)
        crossing.complete(intersection, inside)
        self._network.connectingRoads += tuple(road.road for road in inside)

    def _ways(self, junction: records.Junction) -> Iterator[_Way]:
        """Yield the connections of a junction between roads that are there."""
        for connection in junction.connections:
            incoming, connecting = (
                self._built.get(connection.incoming),
                self._built.get(connection.connecting),
            )
            if incoming is None or connecting is None:
                for name in (connection.incoming, connection.connecting):
                    self._look_up_road(name, connection.line)
                continue
            end = self._touching(incoming, junction.id, connecting, connection)
            yield _Way(incoming, end, connecting, connection)

    def _intersection(
        self, junction: records.Junction, inside: Sequence[BuiltRoad], ways: Sequence[_Way], *, fill: bool
    ) -> Intersection | None:
        """Return the intersection of a junction over the areas of its roads; ``None`` where nothing goes through it."""
        import shapely

        through = {id(road): road for road in (*inside, *(way.connecting for way in ways)) if road.road.lanes}
        polygon = union_of(lane.polygon for road in through.values() for lane in road.road.lanes)
        if polygon is None or not ways:
            message = f"junction {junction.id} has no connection that can be used: left out"
            self._tell(MapProblem("SC624", message, junction.line, "junction"))
            return None
        if fill:
            parts = [shapely.Polygon(part.exterior) for part in getattr(polygon, "geoms", [polygon])]
            polygon = area_of(shapely.union_all(parts))
        intersection = Intersection(
            self._network,
            f"intersection{junction.id}",
            polygon,
            id=number_or_text(junction.id),
            name=junction.name,
            tags=junction.groups | ({junction.type} - {"default"}),
        )
        self._network.elements[intersection.uid] = intersection
        self._intersections[junction.id] = intersection
        return intersection

    def _cross(self, way: _Way, intersection: Intersection, crossing: _Crossing) -> None:
        """Make the maneuvers of one connection."""
        incoming, end, connecting, connection = way
        crossing.ends.setdefault(incoming.record.id, (incoming, end))
        links = connection.links
        if links is None:
            links = tuple(records.LaneLinks(key, key) for key, _ in incoming.contact_lanes(end))
        for link in links:
            start = incoming.lane_at(end, link.source)
            lane = connecting.lane_at(connection.contact, link.target)
            if start is None or lane is None:
                if connection.links is not None:
                    self._look_up_lane(incoming, end, link.source, link.line)
                    self._look_up_lane(connecting, connection.contact, link.target, link.line)
                continue
            if (start.sections[0].isForward) != (end == "end"):
                continue  # traffic comes out of the junction there
            beyond, where = self._beyond(connecting, _OPPOSITE[connection.contact], link.target)
            self._join(start, lane)
            if beyond is None or where is None:
                crossing.nowhere.setdefault(id(connecting), (connecting, connection.contact, link.target))
                continue
            crossing.ends.setdefault(where[0].record.id, where)
            maneuver = Maneuver(start, beyond, lane, intersection)
            self._maneuvers[id(start)].append(maneuver)
            crossing.maneuvers.append(maneuver)

    def _tell_of_end(self, connecting: BuiltRoad, end: str, lane_id: int) -> None:
        """Report a connecting road with a lane that leads nowhere, unless the cause has been reported."""
        record = connecting.record
        link = record.predecessor if end == "start" else record.successor
        section = record.sections[0 if end == "start" else -1]
        lane = next((lane for lane in section.lanes if lane.id == lane_id), None)
        which = "predecessor" if end == "start" else "successor"
        if which in record.lost or (lane is not None and which in lane.lost):
            return
        if link is None or (
            lane is not None and (lane.predecessor if end == "start" else lane.successor) is None
        ):
            message = f"lane {lane_id} of connecting road {record.id} leads nowhere: no maneuver"
            line = record.line if link is None or lane is None else lane.line
            self._tell(MapProblem("SC624", message, line, "leads nowhere"))

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
            MapProblem("SC623", f"{message}: its end counts", incoming.record.line, "link of incoming road")
        )
        return "end"

    def _beyond(
        self, connecting: BuiltRoad, end: str, id: int
    ) -> tuple[Lane | None, tuple[BuiltRoad, str] | None]:
        """Return the lane that a connecting lane leads into, and the road end where that begins."""
        link: Link | None = connecting.record.predecessor if end == "start" else connecting.record.successor
        if link is None or link.element != "road" or link.id not in self._built:
            return None, None
        other = self._built[link.id]
        contact = link.contact or self._contact(other, connecting.record.id)
        lane = connecting.lane_at(_OPPOSITE[end], id)
        next_lane = None if lane is None else lane._successor
        return next_lane, (other, contact)

    # Everything that needs the intersections

    def road_ends(self) -> None:
        """Give roads, sections and groups what they lead into, and the network its lists."""
        for built_road in self._built.values():
            road = built_road.road
            after = self._at_end(built_road.record.successor)
            before = self._at_end(built_road.record.predecessor)
            road._successor, road._predecessor = after, before
            if road.sections:
                road.sections[-1]._successor, road.sections[0]._predecessor = after, before
            for group in road.laneGroups:
                forward = group is road.forwardLanes
                ahead, behind = (built_road.record.successor, built_road.record.predecessor)
                if not forward:
                    ahead, behind = behind, ahead
                group._successor = self._group_at(group, ahead, -1)
                group._predecessor = self._group_at(group, behind, 0)
        inside = {id(road) for road in self._network.connectingRoads}
        self._network.roads = tuple(
            built_road.road
            for built_road in self._built.values()
            if id(built_road.road) not in inside and built_road.road.lanes
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
            self._look_up_junction(link.id, link.line)
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
        without_lanes = [road for road in self._map.roads if road.id not in self._built]
        self._network.signals += tuple(
            signal_of(record, road)
            for road in without_lanes
            for record in road.signals
            if isinstance(record, records.Signal)
        )
        signals_by_id = {signal.openDriveID: signal for signal in self._network.signals}
        for signal in self._network.signals:
            signal.network = self._network
        for built_road in self._built.values():
            new_signals = []
            for item in built_road.record.signals:
                if not isinstance(item, records.SignalReference):
                    continue
                referenced_signal = signals_by_id.get(item.id)
                if referenced_signal is None:
                    message = (
                        f"road {built_road.record.id} refers to signal {item.id}, which is not there: dropped"
                    )
                    self._tell(MapProblem("SC623", message, item.line, "signal"))
                    continue
                referenced_signal.placements = (
                    *referenced_signal.placements,
                    placement_of(item, built_road.road.uid),
                )
                new_signals.append(referenced_signal)
            if new_signals:
                built_road.road.signals += tuple(dict.fromkeys(new_signals))
        invalid = {
            record.id
            for road in self._map.roads
            for record in road.signals
            if isinstance(record, records.Signal) and not record.is_valid
        }
        for signal in self._network.signals:
            if signal.openDriveID in invalid and len(signal.placements) > 1:
                signal.placements = (replace(signal.placements[0], holds=False), *signal.placements[1:])
        for name, intersection in self._intersections.items():
            signals = {signal.uid: signal for signal in intersection.signals}
            for road in (*(built_road.road for built_road in self._inside[name]), *intersection.roads):
                for sign in road.signals:
                    signals.setdefault(sign.uid, sign)
            intersection.signals = tuple(signals.values())

    def gaps(self) -> Iterable[Any]:
        """Polygons between the ends of lanes that are linked but do not touch; reports those far apart."""
        import shapely

        limit = _GAP + self._network.tolerance
        apart: list[tuple[Lane, Lane, float]] = []
        for before, after in dict.fromkeys(self._joints):
            corners = np.stack([before.left[-1], before.right[-1], after.right[0], after.left[0]])
            gap = max(np.hypot(*(corners[0] - corners[3])), np.hypot(*(corners[1] - corners[2])))
            away = np.hypot(*(corners[0] + corners[1] - corners[2] - corners[3])) / 2
            if away > limit:
                apart.append((before, after, away))
            elif gap > 1e-3:
                hull = area_of(shapely.MultiPoint(corners).convex_hull)
                if hull is not None:
                    yield hull
        self._tell_of_distances(apart)

    def _tell_of_distances(self, apart: Sequence[tuple[Lane, Lane, float]]) -> None:
        """Report linked lanes that lie apart, once for each road that is at the wrong place: those with most of such links."""
        left = list(apart)
        while left:
            roads = Counter(lane.road for before, after, _ in left for lane in {before, after})
            wrong = max(roads, key=lambda road: roads[road])
            mine = [joint for joint in left if wrong in (joint[0].road, joint[1].road)]
            left = [joint for joint in left if joint not in mine]
            before, after, away = mine[0]
            others = f" (and {len(mine) - 1} more links of {wrong.uid})" if len(mine) > 1 else ""
            message = (
                f"{before.uid} ends {away:.1f} m from where {after.uid} begins, though it leads into it{others}: "
                "a link, a place or a width is wrong"
            )
            record = self._built_of(before if before.road is wrong else after).record
            self._tell(MapProblem("SC623", message, record.line, "apart"))

    def _built_of(self, lane: Lane) -> BuiltRoad:
        return self._built[lane.road.uid.removeprefix("road")]


def _by_angle(lanes: list[Lane], middle: tuple[float, float], place: int) -> tuple[Lane, ...]:
    """Lanes without repetitions, anticlockwise about a place by their first or last point."""
    distinct = dict.fromkeys(lanes)
    return tuple(sorted(distinct, key=lambda lane: angle_about(middle, lane.line[place])))
