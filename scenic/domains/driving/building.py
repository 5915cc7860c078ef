"""From the records of a map to its network (sections 2.2 to 2.6, 3.4 and 3.5 of the driving specification)."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import field
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.domains.driving.elements import (
    Lane,
    LaneGroup,
    LaneSection,
    NetworkElement,
    Road,
    RoadSection,
    Shoulder,
    Sidewalk,
)
from scenic.domains.driving.enumerations import VehicleType
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.signs import signal_of
from scenic.domains.driving.speed_limits import lowest, ranges_of, road_speeds, section_speeds
from scenic.formats.opendrive import records
from scenic.formats.opendrive.records import MapProblem, MapRecords
from scenic.formats.opendrive.sampled_lanes import RoadShape, SectionShape, joined, road_shape

__all__ = ["BuiltRoad", "LaneTypes", "build_roads"]

Floats = NDArray[np.float64]

_SLIVER: Final = 0.002
"""Square metres below which a polygon is dropped."""


@dataclass(frozen=True, slots=True)
class LaneTypes:
    """The types of lanes in the file, by their use."""

    drivable: frozenset[str] = frozenset(
        ["driving", "entry", "exit", "offRamp", "onRamp", "connectingRamp", "slipLane", "bidirectional"]
    )
    sidewalk: frozenset[str] = frozenset({"sidewalk", "walking"})
    shoulder: frozenset[str] = frozenset({"shoulder", "parking", "stop", "border"})
    bicycle: frozenset[str] = frozenset({"biking"})


@dataclass(eq=False)
class _Strip:
    """A lane in one section of its road, before it is an element."""

    shape: SectionShape
    index: int
    lane: records.Lane
    polygon: Any = None

    @property
    def id(self) -> int:
        return self.lane.id

    def lines(self, forward: bool) -> tuple[Floats, Floats, Floats]:
        """Return the centerline, left and right edge in the direction of traffic."""
        left, right = self.shape.boundaries[self.index], self.shape.boundaries[self.index + 1]
        middle = (left + right) / 2
        if forward:
            return middle, left, right
        return middle[::-1], right[::-1], left[::-1]


@dataclass(eq=False)
class BuiltRoad:
    """A road of the network, with what is needed to link it to others."""

    record: records.Road
    shape: RoadShape
    road: Road
    lanes_by_section: list[dict[int, Lane]] = field(default_factory=list)
    """For each section the lanes by their id in it."""

    def lane_at(self, end: str, id: int) -> Lane | None:
        """The lane of an id at an end of the road, ``start`` or ``end``."""
        return self.lanes_by_section[0 if end == "start" else -1].get(id)

    def contact_lanes(self, end: str) -> Iterable[tuple[int, Lane]]:
        """The lanes at an end of the road, with their ids."""
        return self.lanes_by_section[0 if end == "start" else -1].items()


Tell = Callable[[MapProblem], None]


def build_roads(
    network: RoadNetwork,
    map: MapRecords,
    tell: Tell,
    *,
    types: LaneTypes,
    max_error: float,
    min_points: int,
) -> dict[str, BuiltRoad]:
    """The roads of a map by their ids, each with its lanes, groups, sections, sidewalks and shoulders.

    A road without drivable lanes is no road. One that fails costs itself alone.
    """
    shapes: list[RoadShape] = []
    for record in map.roads:
        try:
            shapes.append(road_shape(record, tell, max_error=max_error, min_points=min_points))
        except (ValueError, ArithmeticError, IndexError, MemoryError) as error:
            message = f"road {record.id} is left out: its geometry cannot be computed ({error})"
            tell(MapProblem("SC621", message, record.line, "road"))
    strips = {id(shape): _strips_of(shape, types) for shape in shapes}
    _fill_polygons([strip for rows in strips.values() for row in rows for strip in row])
    roads: dict[str, BuiltRoad] = {}
    for shape in shapes:
        road = _RoadBuilder(network, shape, strips[id(shape)], types, tell).build()
        if road is not None:
            roads[shape.record.id] = road
    return roads


def _strips_of(shape: RoadShape, types: LaneTypes) -> list[list[_Strip]]:
    wanted = types.drivable | types.sidewalk | types.shoulder | types.bicycle
    return [
        [
            _Strip(section, index, lane)
            for index, lane in enumerate(section.record.lanes)
            if lane.type in wanted
        ]
        for section in shape.sections
    ]


def _fill_polygons(strips: Sequence[_Strip]) -> None:
    """Give strips their polygons, all in one go; those without area keep none."""
    import shapely

    rings = [
        np.concatenate([strip.shape.boundaries[strip.index], strip.shape.boundaries[strip.index + 1][::-1]])
        for strip in strips
    ]
    if not rings:
        return
    owner = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings])
    points = np.concatenate(rings)
    finite = np.isfinite(points).all(axis=1)
    points[~finite] = 0
    polygons = shapely.polygons(shapely.linearrings(points, indices=owner))
    valid = shapely.is_valid(polygons)
    areas = shapely.area(polygons)
    is_broken = np.bincount(owner[~finite], minlength=len(rings)) > 0
    for index, strip in enumerate(strips):
        polygon = polygons[index]
        if is_broken[index]:
            continue
        if not valid[index]:
            polygon = _folded(strip)
        elif areas[index] < _SLIVER:
            polygon = None
        strip.polygon = polygon


def _folded(strip: _Strip) -> Any:
    """Return the polygon of a strip that crosses itself: the union of its quadrilaterals."""
    import shapely

    left, right = strip.shape.boundaries[strip.index], strip.shape.boundaries[strip.index + 1]
    quads = np.stack([left[:-1], left[1:], right[1:], right[:-1]], axis=1)
    parts = shapely.polygons(quads)
    wrong = ~shapely.is_valid(parts)
    parts[wrong] = shapely.make_valid(parts[wrong])
    return area_of(shapely.union_all(parts))


def area_of(geometry: object) -> Any:
    """Return the polygons of a geometry without slivers; ``None`` if there are none."""
    import shapely

    parts = [
        part
        for part in shapely.get_parts(shapely.make_valid(geometry))
        if part.geom_type == "Polygon" and part.area >= _SLIVER
    ]
    if not parts:
        return None
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


def union_of(polygons: Iterable[object]) -> Any:
    """Return the union of polygons; ``None`` if there are none."""
    import shapely

    listed = [polygon for polygon in polygons if polygon is not None]
    if len(listed) <= 1:
        return listed[0] if listed else None
    merged = shapely.union_all(listed)
    return merged if merged.geom_type in ("Polygon", "MultiPolygon") else area_of(merged)


class _RoadBuilder:
    def __init__(
        self, network: RoadNetwork, shape: RoadShape, rows: list[list[_Strip]], types: LaneTypes, tell: Tell
    ) -> None:
        self._network = network
        self._shape = shape
        self._record = shape.record
        self._types = types
        self._tell = tell
        self._drivable = [[s for s in row if s.lane.type in types.drivable] for row in rows]
        self._walks = [[s for s in row if s.lane.type in types.sidewalk] for row in rows]
        self._shoulders = [[s for s in row if s.lane.type in types.shoulder] for row in rows]
        self._bicycle = [[s for s in row if s.lane.type in types.bicycle] for row in rows]
        self._uid = f"road{self._record.id}"
        self._forward_side = 1 if self._record.left_hand else -1
        for row in self._drivable:
            for strip in [strip for strip in row if strip.polygon is None]:
                row.remove(strip)
                message = (
                    f"lane {strip.id} of road {self._record.id}, "
                    f"section {self._shape.sections.index(strip.shape)} has no area: dropped"
                )
                tell(MapProblem("SC622", message, strip.lane.line, "area"))

    def _is_forward(self, id: int) -> bool:
        return (id > 0) == (self._forward_side > 0)

    def build(self) -> BuiltRoad | None:
        if not any(self._drivable):
            return None
        record = self._record
        tags = frozenset({record.type}) if record.type else frozenset()
        polygon = union_of(self._outlines())
        road = self._register(
            Road,
            self._uid,
            polygon,
            id=number_or_text(record.id),
            name=record.name,
            speed=lowest(road_speeds(record)),
            tags=tags,
        )
        road.speedLimitRanges = road_speeds(record)
        result = BuiltRoad(record, self._shape, road)
        sections = self._lane_sections(road, tags)
        self._lanes(result, road, sections)
        self._groups(road)
        self._sections(road, sections)
        self._neighbours(sections)
        self._sides(road)
        reference = self._shape.reference
        forward, backward = road.forwardLanes, road.backwardLanes
        left = backward.right if backward is not None else forward.left if forward is not None else reference
        right = forward.right if forward is not None else backward.left if backward is not None else reference
        road.place(reference, left, right)
        signs = [signal_of(signal, record) for signal in record.signals if isinstance(signal, records.Signal)]
        self._network.signals += tuple(signs)
        road.signals = tuple(
            sign
            for sign, signal in zip(
                signs, (item for item in record.signals if isinstance(item, records.Signal)), strict=True
            )
            if signal.is_valid
        )
        return result

    def _register(self, cls: type[Any], uid: str, polygon: object, **named: Any) -> Any:
        element: NetworkElement = cls(self._network, uid, polygon, **named)
        self._network.elements[uid] = element
        return element

    def _outlines(self) -> Iterable[Any]:
        """The polygons of runs of drivable lanes that lie side by side, section by section."""
        import shapely

        for row in self._drivable:
            runs: list[list[_Strip]] = []
            for strip in row:
                if runs and strip.index == runs[-1][-1].index + 1:
                    runs[-1].append(strip)
                else:
                    runs.append([strip])
            for run in runs:
                if len(run) == 1:
                    yield run[0].polygon
                    continue
                bounds = run[0].shape.boundaries
                ring = np.concatenate([bounds[run[0].index], bounds[run[-1].index + 1][::-1]])
                outline = shapely.Polygon(ring)
                yield outline if outline.is_valid else union_of(strip.polygon for strip in run)

    # Lanes

    def _lane_sections(self, road: Road, tags: frozenset[str]) -> list[dict[int, LaneSection]]:
        rows = []
        for number, row in enumerate(self._drivable):
            sections_by_id: dict[int, LaneSection] = {}
            for strip in row:
                forward = self._is_forward(strip.id)
                element: LaneSection = self._register(
                    LaneSection,
                    f"{self._uid}_sec{number}_lane{strip.id}",
                    strip.polygon,
                    speed=lowest(
                        ranges := section_speeds(self._record, strip.shape.record, strip.lane, forward)
                    ),
                    vehicles=_vehicles(strip.lane),
                    tags=tags | {strip.lane.type},
                )
                element.road = road
                element.speedLimitRanges = ranges
                element.openDriveID = strip.id
                element.isForward = forward
                element.place(*strip.lines(forward))
                sections_by_id[strip.id] = element
            rows.append(sections_by_id)
        return rows

    def _lanes(
        self,
        built: BuiltRoad,
        road: Road,
        sections: list[dict[int, LaneSection]],
    ) -> None:
        """Join lane sections to lanes by their links, and give each its successor within the road."""
        chains, merging = self._chains(sections)
        # Of the lanes that begin in one section the rightmost, as seen along the road, comes first, whatever their order in the file.
        lanes = [
            self._lane(road, number, chain)
            for number, (*_, chain) in enumerate(sorted(chains, key=lambda each: each[:2]))
        ]
        for section, after in merging:
            # In the direction of the road the lane ends there; against it, traffic begins there.
            if section.isForward:
                section._successor = after
                section.lane._successor = after.lane
            else:
                section._predecessor = after
                section.lane._predecessor = after.lane
        road.lanes = tuple(lanes)
        built.lanes_by_section = [{key: part.lane for key, part in row.items()} for row in sections]

    def _chains(
        self, sections: list[dict[int, LaneSection]]
    ) -> tuple[list[tuple[int, int, list[LaneSection]]], list[tuple[LaneSection, LaneSection]]]:
        """Return the sections of each lane, with where it begins; and pairs of which the first leads into a lane that has begun."""
        lane_of: dict[int, list[LaneSection]] = {}
        chains: list[tuple[int, int, list[LaneSection]]] = []
        sections_taken: set[int] = set()
        merging: list[tuple[LaneSection, LaneSection]] = []
        following = [self._following(number, sections) for number in range(len(sections) - 1)]
        for number, row in enumerate(sections):
            for key, section in row.items():
                if id_of(section) not in lane_of:
                    chain = [section]
                    chains.append((number, key, chain))
                    lane_of[id_of(section)] = chain
                chain = lane_of[id_of(section)]
                if number == len(following) or key not in following[number]:
                    continue
                after = sections[number + 1].get(following[number][key])
                if after is None:
                    continue
                if id_of(after) in sections_taken:
                    merging.append((section, after))
                    continue
                sections_taken.add(id_of(after))
                chain.append(after)
                lane_of[id_of(after)] = chain
        return chains, merging

    def _lane(self, road: Road, number: int, chain: list[LaneSection]) -> Lane:
        """Make the lane of some sections, which stand in the order of the road."""
        parts = chain if chain[0].isForward else chain[::-1]
        lane: Lane = self._register(
            Lane,
            f"{self._uid}_lane{number}",
            union_of(part.polygon for part in chain),
            speed=lowest(ranges := ranges_of(parts)),
            vehicles=frozenset().union(*(part.vehicleTypes for part in chain)),
            tags=frozenset().union(*(part.tags for part in chain)),
        )
        lane.road = road
        lane.speedLimitRanges = ranges
        lane.sections = tuple(parts)
        lane.place(
            joined([part.line for part in parts]),
            joined([part.left for part in parts]),
            joined([part.right for part in parts]),
        )
        for part in parts:
            part.lane = lane
        for before, after in pairwise(parts):
            before._successor, after._predecessor = after, before
        return lane

    def _following(self, number: int, sections: list[dict[int, LaneSection]]) -> dict[int, int]:
        """Return by id, for lanes of a section, the lane of the next section that they lead into along the reference line."""
        here = {strip.id: strip.lane for strip in self._drivable[number]}
        there = {strip.id: strip.lane for strip in self._drivable[number + 1]}
        next_lanes = {}
        for key, lane in here.items():
            if lane.successor is not None and lane.successor in there:
                next_lanes[key] = lane.successor
        for key, lane in there.items():
            if (
                lane.predecessor is not None
                and lane.predecessor in here
                and lane.predecessor not in next_lanes
            ):
                next_lanes[lane.predecessor] = key  # the link is given on one side only
        has_links = any(lane.successor is not None for lane in here.values()) or any(
            lane.predecessor is not None for lane in there.values()
        )
        if not has_links:
            next_lanes = {key: key for key in here if key in there}
        return {
            key: other
            for key, other in next_lanes.items()
            if sections[number][key].isForward == self._is_forward(other)
        }

    def _groups(self, road: Road) -> None:
        for forward, word in ((True, "forward"), (False, "backward")):
            lanes = [lane for lane in road.lanes if lane.sections[0].isForward == forward]
            if not lanes:
                continue
            # From the curb inward: the outermost ids first.
            lanes.sort(key=lambda lane: -abs(lane.sections[0].openDriveID))
            group: LaneGroup = self._register(
                LaneGroup,
                f"{self._uid}_{word}",
                union_of(lane.polygon for lane in lanes),
                speed=road.speedLimit,
                tags=road.tags,
            )
            group.road = road
            group.lanes = tuple(lanes)
            left, right, middle = self._group_edges(forward)
            group.place(middle, left, right)
            group._curb = left if self._record.left_hand else right
            for lane in lanes:
                lane.group = group
                for section in lane.sections:
                    section.group = group
            if forward:
                road.forwardLanes = group
            else:
                road.backwardLanes = group
        road.laneGroups = tuple(
            group for group in (road.forwardLanes, road.backwardLanes) if group is not None
        )
        if road.forwardLanes is not None and road.backwardLanes is not None:
            road.forwardLanes._opposite = road.backwardLanes
            road.backwardLanes._opposite = road.forwardLanes

    def _group_edges(self, forward: bool) -> tuple[Floats, Floats, Floats]:
        """Return the left edge, right edge and middle of the lanes of one direction, in that direction."""
        left, right, middle = [], [], []
        for row in self._drivable:
            mine = [strip for strip in row if self._is_forward(strip.id) == forward]
            if not mine:
                continue
            bounds = mine[0].shape.boundaries
            first, last = bounds[mine[0].index], bounds[mine[-1].index + 1]
            left.append(first)
            right.append(last)
            middle.append((first + last) / 2)
        lines = joined(left), joined(right), joined(middle)
        if forward:
            return lines
        return lines[1][::-1], lines[0][::-1], lines[2][::-1]

    def _sections(self, road: Road, rows: list[dict[int, LaneSection]]) -> None:
        sections = []
        for number, (row, drivable) in enumerate(zip(rows, self._drivable, strict=True)):
            if not row:
                continue
            shape = self._shape.sections[number]
            section: RoadSection = self._register(
                RoadSection,
                f"{self._uid}_sec{number}",
                union_of(strip.polygon for strip in drivable),
                speed=road.speedLimit,
                tags=road.tags,
            )
            section.road = road
            section.lanes = tuple(row[key] for key in sorted(row))  # from right to left along the road
            section.forwardLanes = tuple(lane for lane in section.lanes if lane.isForward)
            section.backwardLanes = tuple(lane for lane in section.lanes if not lane.isForward)
            section.lanesByOpenDriveID = dict(row)
            bounds = shape.boundaries
            section.place(shape.reference, bounds[drivable[0].index], bounds[drivable[-1].index + 1])
            sections.append(section)
        for before, after in pairwise(sections):
            before._successor, after._predecessor = after, before
        road.sections = tuple(sections)

    def _neighbours(self, rows: list[dict[int, LaneSection]]) -> None:
        for row in rows:
            for key, section in row.items():
                inner = key + 1 if key < 0 else key - 1
                inner = inner or (1 if key < 0 else -1)
                outer = key - 1 if key < 0 else key + 1
                middle, edge = row.get(inner), row.get(outer)
                left, right = (edge, middle) if self._record.left_hand else (middle, edge)
                section._laneToLeft, section._laneToRight = left, right
                same = [
                    lane if lane is not None and lane.isForward == section.isForward else None
                    for lane in (left, right)
                ]
                faster, slower = same[::-1] if self._record.left_hand else same
                section._fasterLane, section._slowerLane = faster, slower
                section.adjacentLanes = tuple(lane for lane in (left, right) if lane is not None)

    # Beside the traffic

    def _sides(self, road: Road) -> None:
        sidewalks, shoulders = [], []
        for forward, word in ((True, "Forward"), (False, "Backward")):
            group = road.forwardLanes if forward else road.backwardLanes
            walk = self._side(road, Sidewalk, self._walks, forward, f"{self._uid}_sidewalk{word}")
            if walk is not None:
                walk.vehicleTypes = frozenset({VehicleType.PEDESTRIAN})
                sidewalks.append(walk)
                if group is not None:
                    group._sidewalk = walk
            shoulder = self._side(road, Shoulder, self._shoulders, forward, f"{self._uid}_shoulder{word}")
            if shoulder is not None:
                shoulder.group = group
                shoulders.append(shoulder)
                if group is not None:
                    group._shoulder = shoulder
                    group._curb = shoulder.left if self._record.left_hand else shoulder.right
            if group is not None:
                group._bikeLane = self._bicycle_lane(road, group, forward)
        road.sidewalks = tuple(sidewalks)
        self._network.sidewalks += tuple(sidewalks)
        self._network.shoulders += tuple(shoulders)

    def _side(self, road: Road, cls: type[Any], rows: list[list[_Strip]], forward: bool, uid: str) -> Any:
        """Return all strips of one kind on one side as an element: the outermost run of each section."""
        left, right, polygons = [], [], []
        for row in rows:
            mine = [s for s in row if self._is_forward(s.id) == forward and s.polygon is not None]
            if not mine:
                continue
            outermost = mine[-1] if mine[0].id < 0 else mine[0]
            run = [outermost]
            order = mine[::-1] if mine[0].id < 0 else mine
            for strip in order[1:]:
                if abs(strip.index - run[-1].index) != 1:
                    message = f"{cls.__name__.lower()} lane {strip.id} of road {self._record.id} lies apart from the outer ones: left out"
                    self._tell(MapProblem("SC622", message, strip.lane.line, "apart"))
                    break
                run.append(strip)
            indices = [strip.index for strip in run]
            bounds = run[0].shape.boundaries
            left.append(bounds[min(indices)])
            right.append(bounds[max(indices) + 1])
            polygons += [strip.polygon for strip in run]
        if not polygons:
            return None
        element = self._register(cls, uid, union_of(polygons), speed=road.speedLimit, tags=road.tags)
        element.road = road
        lines = joined([(a + b) / 2 for a, b in zip(left, right, strict=True)]), joined(left), joined(right)
        element.place(*(lines if forward else (lines[0][::-1], lines[2][::-1], lines[1][::-1])))
        return element

    def _bicycle_lane(self, road: Road, group: LaneGroup, forward: bool) -> Lane | None:
        strips = [
            max(mine, key=lambda strip: abs(strip.id))
            for row in self._bicycle
            if (mine := [s for s in row if self._is_forward(s.id) == forward and s.polygon is not None])
        ]
        if not strips:
            return None
        lane: Lane = self._register(
            Lane,
            f"{group.uid}_bikeLane",
            union_of(strip.polygon for strip in strips),
            speed=road.speedLimit,
            vehicles=frozenset({VehicleType.BICYCLE}),
            tags=road.tags,
        )
        lane.road, lane.group = road, group
        strips_in_order = strips if forward else strips[::-1]
        lines = [strip.lines(forward) for strip in strips_in_order]
        lane.place(*(joined(list(parts)) for parts in zip(*lines, strict=True)))
        return lane


def id_of(thing: object) -> int:
    """Return the identity of an object."""
    return id(thing)


def _vehicles(lane: records.Lane) -> frozenset[VehicleType]:
    kinds = {VehicleType.CAR}
    if "allow bicycle" in lane.access:
        kinds.add(VehicleType.BICYCLE)
    if "allow pedestrian" in lane.access:
        kinds.add(VehicleType.PEDESTRIAN)
    return frozenset(kinds)


def number_or_text(text: str) -> Any:
    try:
        return int(text)
    except ValueError:
        return text


def angle_about(center: tuple[float, float], point: Floats) -> float:
    """The heading from a centre to a point: 0 to the north, anticlockwise, from -pi to pi, so that an order starts in the south."""
    return math.atan2(center[0] - float(point[0]), float(point[1]) - center[1])
