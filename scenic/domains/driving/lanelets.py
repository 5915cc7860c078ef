"""A road network as CommonRoad's lanelets, signs, lights and junctions."""

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import (
    Intersection,
    Lane,
    LaneSection,
    LinearElement,
    Maneuver,
    PedestrianCrossing,
)
from scenic.domains.driving.enumerations import ManeuverType
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.signals import TrafficLights
from scenic.domains.driving.signs import Signal
from scenic.formats.commonroad.records import (
    Incoming,
    Junction,
    Lanelet,
    RoadRecords,
    StopLine,
    TrafficLight,
    TrafficSign,
)

__all__ = ["road_records"]

Floats = NDArray[np.float64]

_ROADS: Final = (
    ("motorway", "interstate"),
    ("rural", "country"),
    ("town", "urban"),
    ("lowSpeed", "urban"),
    ("bicycle", "bicycleLane"),
    ("pedestrian", "sidewalk"),
)
"""CommonRoad's types of lanelets by OpenDRIVE's types of roads."""

_LANES: Final = (
    ("exit", "exitRamp"),
    ("offRamp", "exitRamp"),
    ("entry", "accessRamp"),
    ("onRamp", "accessRamp"),
    ("bus", "busLane"),
    ("restricted", "restricted"),
)
"""CommonRoad's types of lanelets by OpenDRIVE's types of lanes."""

_SIGNS: Final = (
    *("101", "102", "205", "206", "208", "209", "215", "237", "239", "240", "245", "250", "251", "253"),
    *("254", "255", "259", "260", "261", "264", "265", "266", "267", "274.1", "274.2", "275", "276", "277"),
    *("278", "280", "281", "282", "301", "306", "308", "310", "311", "325.1", "325.2", "327", "350"),
)
"""Numbers of signs that have a place in CommonRoad's catalogue; limits of speed come from lanes."""

_PARALLEL: Final = 1e-3
"""Metres by which the lines of neighbours may deviate."""


def road_records(network: RoadNetwork, lights: TrafficLights, name: str) -> RoadRecords:
    """The records of a network.

    Args:
        network: the network.
        lights: its traffic lights, for their cycles.
        name: of the map.

    """
    records = _Records(network)
    x, y, _, turn = network.offset
    return RoadRecords(
        name,
        tuple(records.lanelets()),
        tuple(records.signs.values()),
        tuple(
            TrafficLight(signal.uid, _place(signal), _direction(signal), lights.cycle(signal))
            for signal in network.signals
            if signal.isTrafficLight
        ),
        tuple(_junction(item) for item in network.intersections if item.incomingLanes),
        _tags(network),
        (x, y, turn),
    )


class _Records:
    """The lanelets of a network; ``signs`` are the traffic signs on the way."""

    def __init__(self, network: RoadNetwork) -> None:
        self._network = network
        self.signs: dict[str, TrafficSign] = {}

    def lanelets(self) -> Iterable[Lanelet]:
        network = self._network
        for lane in network.lanes:
            for section in lane.sections:
                yield self._drivable(section)
        for group in network.laneGroups:
            if group._bikeLane is not None:
                yield _aside(group._bikeLane, "bicycleLane", one_way=("bicycle",))
        for shoulder in network.shoulders:
            yield _aside(shoulder, "shoulder")
        for sidewalk in network.sidewalks:
            yield _aside(sidewalk, "sidewalk", both_ways=("pedestrian",))
        for crossing in network.crossings:
            yield _aside(crossing, "crosswalk", both_ways=("pedestrian",))

    def _drivable(self, section: LaneSection) -> Lanelet:
        lane = section.lane
        signs, lights, stop = self._halts(section)
        limit = self._limit(section)
        users = ["vehicle"]
        users += [word.name.lower() for word in section.vehicleTypes if word.name != "CAR"]
        return Lanelet(
            section.uid,
            section.left,
            section.right,
            _types(section, lane),
            tuple(sorted(users)),
            successors=tuple(dict.fromkeys(item.uid for item in _after(section))),
            left_neighbour=_beside(section, section._laneToLeft),
            right_neighbour=_beside(section, section._laneToRight),
            stop_line=stop,
            signs=(*signs, *limit),
            lights=lights,
        )

    def _halts(self, section: LaneSection) -> tuple[tuple[str, ...], tuple[str, ...], StopLine | None]:
        """Return the signs and lights that apply to a section, and the line at which to stop for the first light or sign to stop."""
        lane = section.lane
        if lane.is_connecting:
            return (), (), None
        begin, end = _stretch(section)
        signs, lights, stops = [], [], []
        halting = [
            item for item in self._network.signals if item.affects(lane) or item in lane.halting_signals
        ]
        for signal in halting:
            along = signal.stop_along(lane)
            is_last = section is lane.sections[-1]
            if along is None or not (begin <= along < end or (is_last and along >= end)):
                continue
            if signal.isTrafficLight:
                lights.append(signal.uid)
            elif (key := self._sign(signal)) is not None:
                signs.append(key)
            if signal.isTrafficLight or signal.isStopSign:
                stops.append((min(1.0, (along - begin) / (end - begin)), signal))
        if not stops:
            return tuple(signs), tuple(lights), None
        share = min(share for share, _ in stops)
        here = [signal.uid for at, signal in stops if at == share]
        line = StopLine(
            _at_share(section.left, share),
            _at_share(section.right, share),
            tuple(uid for uid in here if uid in signs),
            tuple(uid for uid in here if uid in lights),
        )
        return tuple(signs), tuple(lights), line

    def _sign(self, signal: Signal) -> str | None:
        """The key of the record of a sign; ``None`` for signs that CommonRoad has no number for."""
        code = "206" if signal.isStopSign else "205" if signal.isYieldSign else signal.type
        full = f"{code}-{signal.subtype}" if signal.subtype not in ("", "-1", "none") else code
        number = next((item for item in (full, code) if item in _SIGNS), None)
        if number is None:
            return None
        self.signs[signal.uid] = TrafficSign(signal.uid, number, (), _place(signal))
        return signal.uid

    def _limit(self, section: LaneSection) -> tuple[str, ...]:
        """The key of the sign with the speed limit of a lane section, the lowest of its length."""
        if section.speedLimit is None:
            return ()
        key = f"{section.group.uid} limit {section.speedLimit:g}"
        if key not in self.signs:
            edge = section.left if self._network.driveOnLeft else section.right
            x, y = edge[0].tolist()
            self.signs[key] = TrafficSign(key, "274", (f"{section.speedLimit:g}",), (x, y))
        return (key,)


def _aside(
    element: LinearElement, kind: str, one_way: tuple[str, ...] = (), both_ways: tuple[str, ...] = ()
) -> Lanelet:
    """Return a lanelet beside the traffic, without successors."""
    return Lanelet(element.uid, element.left, element.right, (kind,), one_way, both_ways)


def _after(section: LaneSection) -> Iterable[LaneSection]:
    """Yield the sections that follow one."""
    lane = section.lane
    if isinstance(section._successor, LaneSection):
        yield section._successor
    if section is not lane.sections[-1]:
        return
    for maneuver in lane.maneuvers:
        onward = maneuver.connectingLane or maneuver.endLane
        if onward is not lane:
            yield onward.sections[0]


def _beside(section: LaneSection, other: LaneSection | None) -> tuple[str, bool] | None:
    """The key of a neighbour, and whether it has the same direction; ``None`` where no line is shared."""
    if other is None:
        return None
    same = other.isForward == section.isForward
    lines = (other.left, other.right) if same else (other.left[::-1], other.right[::-1])
    for mine in (section.left, section.right):
        if any(line.shape == mine.shape and np.abs(line - mine).max() < _PARALLEL for line in lines):
            return other.uid, same
    return None


def _types(section: LaneSection, lane: Lane) -> tuple[str, ...]:
    tags = section.tags | lane.tags | lane.road.tags
    found = [word for table in (_ROADS, _LANES) for tag, word in table if tag in tags]
    if lane.is_connecting:
        found.append("intersection")
    return tuple(dict.fromkeys(found)) or ("unknown",)


def _stretch(section: LaneSection) -> tuple[float, float]:
    """Return the metres along the lane at which a section begins and ends."""
    begin = 0.0
    for part in section.lane.sections:
        length = float(np.hypot(*np.diff(part.line, axis=0).T).sum())
        if part is section:
            return begin, begin + length
        begin += length
    raise LookupError(section.uid)


def _at_share(line: Floats, share: float) -> tuple[float, float]:
    import shapely

    point = shapely.LineString(line).interpolate(share, normalized=True)
    return point.x, point.y


def _place(signal: Signal) -> tuple[float, float]:
    x, y, *_ = signal.position
    return float(x), float(y)


def _direction(signal: Signal) -> str:
    """CommonRoad's word for the turns that a light controls."""
    turns = {maneuver.type for maneuver in signal.controlledManeuvers}
    words = {
        frozenset({ManeuverType.LEFT_TURN}): "left",
        frozenset({ManeuverType.RIGHT_TURN}): "right",
        frozenset({ManeuverType.STRAIGHT}): "straight",
        frozenset({ManeuverType.LEFT_TURN, ManeuverType.STRAIGHT}): "leftStraight",
        frozenset({ManeuverType.RIGHT_TURN, ManeuverType.STRAIGHT}): "straightRight",
        frozenset({ManeuverType.LEFT_TURN, ManeuverType.RIGHT_TURN}): "leftRight",
    }
    return words.get(frozenset(turns), "all")


def _junction(intersection: Intersection) -> Junction:
    incomings = []
    for road in dict.fromkeys(lane.road for lane in intersection.incomingLanes):
        lanes = [lane for lane in intersection.incomingLanes if lane.road is road]
        ways = [item for item in intersection.maneuvers if item.startLane in lanes]
        incomings.append(
            Incoming(
                tuple(lane.sections[-1].uid for lane in lanes),
                _onto(ways, (ManeuverType.RIGHT_TURN,)),
                _onto(ways, (ManeuverType.STRAIGHT,)),
                _onto(ways, (ManeuverType.LEFT_TURN, ManeuverType.U_TURN)),
            )
        )
    crossings: Sequence[PedestrianCrossing] = intersection.crossings
    return Junction(intersection.uid, tuple(incomings), tuple(item.uid for item in crossings))


def _onto(maneuvers: Sequence[Maneuver], types: Sequence[ManeuverType]) -> tuple[str, ...]:
    lanes = [item.connectingLane for item in maneuvers if item.type in types]
    return tuple(dict.fromkeys(lane.sections[0].uid for lane in lanes if lane is not None))


def _tags(network: RoadNetwork) -> tuple[str, ...]:
    roads = {tag for road in network.roads for tag in road.tags}
    facts = (
        ("interstate", "motorway" in roads),
        ("urban", bool({"town", "lowSpeed"} & roads)),
        ("intersection", bool(network.intersections)),
        ("multi_lane", any(section._fasterLane is not None for section in network.laneSections)),
        ("oncoming_traffic", any(not road.is1Way for road in network.roads)),
        ("rural", "rural" in roads),
        ("simulated", True),
        ("speed_limit", any(lane.speedLimit is not None for lane in network.lanes)),
    )
    return tuple(word for word, holds in facts if holds)
