"""From the text of an OpenDRIVE file to records (sections 3.1 and 3.7 of the driving specification).

Anything that is wrong with a part of the file costs at most that part, and is told as a `MapProblem` with its line.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise, zip_longest
from types import MappingProxyType
from typing import Final, Literal

from scenic.formats.opendrive.attributes import (
    ids,
    junction_groups,
    number_or,
    offset,
    priorities,
    speed,
    validity,
)
from scenic.formats.opendrive.parts import (
    NUMBERS_OF_SHAPES,
    UnusablePart,
    contact_of,
    crosswalk_of,
    cubics_of,
    geometry_of,
    integer_of,
    lane_of,
    lateral_shapes_of,
    number_of,
    profile_of,
    text_of,
)
from scenic.formats.opendrive.records import (
    Connection,
    Crosswalk,
    Cubic,
    Geometry,
    Junction,
    Lane,
    LaneLinks,
    LaneSection,
    Link,
    MapProblem,
    MapRecords,
    Road,
    Signal,
    SignalReference,
    Speed,
)
from scenic.formats.opendrive.schema import faults_of
from scenic.formats.opendrive.signal_references import unknown_references
from scenic.formats.opendrive.xml_tree import Element, MapError, read_tree
from scenic.language.spans import Span

__all__ = ["read_map"]

_SHORTEST: Final = 1e-6
"""Metres; shorter pieces of a reference line are skipped."""
_SHARPEST: Final = 50.0
"""Change of curvature in 1/m^2 from which on a spiral is an artefact."""
_AGREEMENT: Final = 1e-3
"""Metres by which the length of a piece may differ from the distance to the next one without a word."""
_BEHIND: Final = 0.1
"""Metres by which something may lie behind the end of its road without a word."""
_CODES: Final = MappingProxyType({"road": "SC621", "lane": "SC622", "link": "SC623", "junction": "SC624"})


class _NoLanes(Exception):
    """A road that has no lanes because of faults that are reported separately."""


def read_map(content: bytes, filename: str) -> MapRecords:
    """The records of an OpenDRIVE file.

    Raises `MapError` where the file is not XML, not OpenDRIVE, or has no road that can be used.
    """
    root, reference = read_tree(content, filename)
    if root.tag != "OpenDRIVE":
        raise MapError(
            f"the root of the file is <{root.tag}>, not <OpenDRIVE>",
            filename=filename,
            span=Span(root.line, 0, root.line, 1),
            help="scenic reads road maps in the format OpenDRIVE (.xodr)",
        )
    return _Reader(filename, root).map(root, reference)


class _Reader:
    """Reads one file, and reports each violation of the standard once, with its known consequences."""

    def __init__(self, filename: str, root: Element) -> None:
        self._filename = filename
        self._problems: list[MapProblem] = []
        self._faults = dict(faults_of(root))
        self._left_out: set[str] = set()
        self._lost: set[str] = set()
        """The links, of the road that is being read, that cannot be used."""

    def _tell(self, code: str, message: str, line: int, kind: str) -> None:
        self._problems.append(MapProblem(code, message, line, kind))

    def _tell_of(self, about: tuple[Element, str], code: str, message: str, kind: str) -> None:
        """Report what follows from a fault, instead of the fault itself."""
        self._faults.pop(about, None)
        self._tell(code, message, about[0].line, kind)

    def map(self, root: Element, reference: str) -> MapRecords:
        header = root.first("header") or Element("header", {}, root.line)
        version = f"{header.attributes.get('revMajor', '1')}.{header.attributes.get('revMinor', '?')}"
        roads, junctions = self._roads(root), self._junctions(root)
        if not roads:
            raise self._without_roads(root)
        return MapRecords(
            self._filename,
            version,
            header.attributes.get("vendor", ""),
            reference,
            offset(header),
            roads,
            junctions,
            (*self._told(), *unknown_references(root)),
            frozenset(self._left_out),
        )

    def _roads(self, root: Element) -> tuple[Road, ...]:
        """Return the roads that can be used, without those of a number that is taken."""
        roads: dict[str, Road] = {}
        for element in root.all("road"):
            try:
                road = self._road(element)
            except _NoLanes:
                self._left_out.add(f"road {element.attributes['id']}")
                continue
            except UnusablePart as wrong:
                name = element.attributes.get("id") or "?"
                self._left_out.add(f"road {name}")
                self._tell_of(wrong.about, "SC621", f"road {name} is left out: {wrong}", "road")
                continue
            if road.id in roads:
                self._forget(element)
                self._tell(
                    "SC621", f"road {road.id} is there twice: the second is left out", road.line, "twice"
                )
            else:
                roads[road.id] = road
        return tuple(roads.values())

    def _junctions(self, root: Element) -> tuple[Junction, ...]:
        """Return the junctions that can be used, without those of a number that is taken."""
        junctions: dict[str, Junction] = {}
        groups = junction_groups(root)
        for element in root.all("junction"):
            try:
                junction = self._junction(element)
            except UnusablePart as wrong:
                name = element.attributes.get("id") or "?"
                self._left_out.add(f"junction {name}")
                self._tell_of(wrong.about, "SC624", f"junction {name} is left out: {wrong}", "junction")
                continue
            if junction.id in junctions:
                self._forget(element)
                message = f"junction {junction.id} is there twice: the second is left out"
                self._tell("SC624", message, junction.line, "twice")
            else:
                junctions[junction.id] = replace(junction, groups=groups.get(junction.id, frozenset()))
        return tuple(junctions.values())

    def _without_roads(self, root: Element) -> MapError:
        # Whatever is wrong with the first road says more than that there is none.
        problems = [problem for problem in self._problems if problem.kind == "road"] or self._told()
        first = next(iter(problems), None)
        line = root.line if first is None else first.line
        return MapError(
            "the map has no road that can be used" + (f": {first.message}" if first else ""),
            filename=self._filename,
            span=Span(line, 0, line, 1),
            help="is the file complete?" if first is None else "mend the road, or save the map again",
        )

    def _told(self) -> list[MapProblem]:
        """Return all problems: what was left out or changed, then faults without further effect."""
        faults = [
            MapProblem(_CODES[fault.where], fault.message, fault.line, f"{element.tag} {part}")
            for (element, part), fault in self._faults.items()
        ]
        return [*self._problems, *faults]

    def _forget(self, element: Element) -> None:
        """Say nothing of ids that are there twice in an element that is itself there twice."""
        for inner in element.children:
            self._faults.pop((inner, "twice"), None)
            self._forget(inner)

    # Roads

    def _road(self, element: Element) -> Road:
        name = text_of(element, "id")
        self._lost.clear()
        plan = element.first("planView")
        if plan is None:
            self._faults.pop((element, "lanes"), None)
            raise UnusablePart("it has no planView", element, "planView")
        # Without a usable length only the reference line counts.
        length = math.nan if (element, "length") in self._faults else number_of(element, "length")
        geometry = self._plan(name, plan, length)
        ends = geometry[-1].s + geometry[-1].length
        lanes = element.first("lanes")
        if lanes is None:
            raise UnusablePart("it has no lanes", element, "lanes")
        self._within(name, element.all("type"), ends)
        type_ = element.first("type")
        speeds = tuple(
            Speed(number_of(item, "s", 0.0), speed(item.first("speed"))) for item in element.all("type")
        )
        junction = element.attributes.get("junction", "-1")
        return Road(
            name,
            element.attributes.get("name", ""),
            ends,
            None if junction in ("-1", "") else junction,
            element.attributes.get("rule", "RHT").upper() == "LHT",
            "" if type_ is None else type_.attributes.get("type", ""),
            tuple(sorted(speeds, key=lambda item: item.start)),
            self._link(element, "predecessor"),
            self._link(element, "successor"),
            geometry,
            profile_of(element.first("elevationProfile"), "elevation"),
            profile_of(element.first("lateralProfile"), "superelevation"),
            self._crossfall(element.first("lateralProfile")),
            lateral_shapes_of(element.first("lateralProfile")),
            tuple(cubics_of(lanes, "laneOffset", "s")),
            self._sections(name, lanes, ends),
            tuple(self._signals(name, element.first("signals"), ends)),
            tuple(self._crosswalks(element.first("objects"))),
            element.line,
            frozenset(self._lost),
        )

    def _crossfall(self, profile: Element | None) -> tuple[tuple[Cubic, ...], tuple[Cubic, ...]]:
        """Return the crossfall of the left and of the right side."""
        if profile is None:
            return (), ()
        left, right = (
            tuple(
                cubics_of(
                    Element(
                        "",
                        {},
                        0,
                        [
                            item
                            for item in profile.all("crossfall")
                            if item.attributes.get("side", "both") in (side, "both")
                        ],
                    ),
                    "crossfall",
                    "s",
                )
            )
            for side in ("left", "right")
        )
        return left, right

    def _within(self, road: str, elements: Iterable[Element], end: float) -> None:
        """Report elements that are placed behind the end of a road."""
        for element in elements:
            start = element.attributes.get("s", "")
            if (element, "s") not in self._faults and start and float(start) > end + _BEHIND:
                message = f"<{element.tag}> of road {road} is at s = {start}, behind the end at {end:.3f}"
                self._tell("SC621", message, element.line, "behind")

    def _link(self, road: Element, which: str) -> Link | None:
        link = road.first("link")
        if link is None:
            return None
        end = link.first(which)
        if end is None:
            return None
        name = road.attributes.get("id", "?")
        if not end.attributes.get("elementId", "").strip():
            message = f"the {which} of road {name} has no 'elementId': dropped"
            self._tell_of((end, "elementId"), "SC623", message, "link")
            self._lost.add(which)
            return None
        kind = end.attributes.get("elementType", "road")
        contact = end.attributes.get("contactPoint")
        if kind not in ("road", "junction"):
            message = f"a link to an element of the type {kind!r} is dropped"
            self._tell_of((end, "elementType"), "SC623", message, "link")
            self._lost.add(which)
            return None
        element: Literal["road", "junction"] = "junction" if kind == "junction" else "road"
        if element == "road" and contact not in ("start", "end"):
            message = f"the {which} of road {name} has no 'contactPoint': the links of the other road decide"
            self._tell_of((end, "contactPoint"), "SC623", message, "contact")
        return Link(element, end.attributes["elementId"], contact_of(contact), end.line)

    def _plan(self, road: str, plan: Element, declared: float) -> tuple[Geometry, ...]:
        pieces: list[Geometry] = []
        short: list[Geometry] = []
        elements = list(plan.all("geometry"))
        for element, following in zip_longest(elements, elements[1:]):
            piece = geometry_of(element)
            shapes = [part for part in element.children if part.tag in NUMBERS_OF_SHAPES]
            if len(shapes) > 1:
                message = f"a piece of road {road} has {len(shapes)} shapes: the first counts"
                self._tell("SC621", message, shapes[1].line, "repeated")
            is_sharp = (
                piece.shape == "spiral"
                and piece.length > 0
                and abs(piece.numbers[1] - piece.numbers[0]) / piece.length > _SHARPEST
            )
            if following is not None and number_of(following, "s") - piece.s > _AGREEMENT > piece.length:
                self._faults.pop((element, "length"), None)  # the next piece says how long it is
            elif piece.length < _SHORTEST or is_sharp:
                what = "bends too sharply" if is_sharp else "has no length"
                message = f"a piece of road {road} that {what} is skipped"
                self._tell_of((element, "length"), "SC621", message, "piece")
                short.append(piece)
                continue
            if pieces and piece.s <= pieces[-1].s:
                raise UnusablePart("the pieces of its reference line are out of order", element, "s")
            pieces.append(piece)
        if not pieces:
            if not short:
                raise UnusablePart("its planView has no geometry", plan, "geometry")
            longest = max(short, key=lambda piece: piece.length)
            if longest.length <= 0:
                raise UnusablePart("its reference line has no length", plan)
            pieces = [longest]
        self._measure(road, pieces)
        end = pieces[-1].s + pieces[-1].length
        if abs(declared - end) > max(_AGREEMENT, 1e-3 * end):
            message = f"road {road} is declared {declared:.3f} m long, its reference line is {end:.3f} m"
            self._tell("SC621", message, plan.line, "length")
        return tuple(pieces)

    def _measure(self, road: str, pieces: list[Geometry]) -> None:
        """Let each piece end where the next one begins, and the first one begin at 0."""
        for index, (piece, after) in enumerate(pairwise(list(pieces))):
            real = after.s - piece.s
            if abs(real - piece.length) > _AGREEMENT:
                message = (
                    f"a piece of road {road} is {piece.length:.4f} m long, "
                    f"but the next one begins {real:.4f} m on: that counts"
                )
                self._tell("SC621", message, piece.line, "length")
            pieces[index] = replace(piece, length=real, corrected=abs(real - piece.length) > _AGREEMENT)
        first = pieces[0].s
        if first:
            # Everything else counts from the start of the road.
            pieces[0] = replace(pieces[0], s=0.0)
            if abs(first) > _AGREEMENT:
                self._tell("SC621", f"road {road} begins at s = {first:g}, not 0", pieces[0].line, "start")
            for index in range(1, len(pieces)):
                pieces[index] = replace(pieces[index], s=pieces[index].s - first)

    # Lanes

    def _sections(self, road: str, lanes: Element, end: float) -> tuple[LaneSection, ...]:
        sections: list[LaneSection] = []
        for element in lanes.all("laneSection"):
            start = number_of(element, "s", 0.0)
            if not sections and abs(start) > _BEHIND:
                message = (
                    f"the first lane section of road {road} begins at s = {start:g}, not 0: it counts from 0"
                )
                self._tell_of((element, "s"), "SC622", message, "section")
            if sections and start <= sections[-1].s:
                message = f"a lane section of road {road} is out of order: left out"
                self._tell("SC622", message, element.line, "section")
                continue
            if start >= end - _SHORTEST and sections:
                message = f"a lane section of road {road} begins behind its end: left out"
                self._tell("SC622", message, element.line, "section")
                continue
            before = len(self._problems)
            is_empty = not element.children or any(
                (side, "lane") in self._faults for side in element.children
            )
            left = self._lanes(road, element.first("left"))
            right = self._lanes(road, element.first("right"))
            self._middle(road, element.first("center"))
            wrong = [lane for lane in left if lane.id < 0] + [lane for lane in right if lane.id > 0]
            for lane in wrong:
                message = f"lane {lane.id} of road {road} is on the wrong side: left out"
                self._tell("SC622", message, lane.line, "side")
            both = {lane.id: lane for lane in (*left, *right) if lane not in wrong}
            lanes_by_id = sorted(both.values(), key=lambda lane: -lane.id)
            if len(self._problems) == before:
                self._numbered(road, element, list(both))
            is_whole = len(self._problems) == before and not is_empty
            sections.append(
                LaneSection(0.0 if not sections else start, tuple(lanes_by_id), element.line, is_whole)
            )
        if sections and not any(section.lanes or section.is_whole for section in sections):
            raise _NoLanes
        if not sections or not any(section.lanes for section in sections):
            raise UnusablePart("it has no lanes", lanes, "laneSection")
        return tuple(sections)

    def _middle(self, road: str, center: Element | None) -> None:
        """Report a middle lane that has another number than 0."""
        lane = None if center is None else center.first("lane")
        if lane is None or (lane, "id") in self._faults or lane.attributes["id"].strip() in ("0", "-0", "+0"):
            return
        message = f"the middle lane of road {road} has the id {lane.attributes['id']}, not 0"
        self._tell("SC622", message, lane.line, "middle")

    def _numbered(self, road: str, section: Element, ids: Sequence[int]) -> None:
        """Report ids of lanes that leave numbers out."""
        for side in ([lane for lane in ids if lane > 0], [-lane for lane in ids if lane < 0]):
            if side and max(side) > len(side):
                message = f"the lanes of road {road} with the ids {', '.join(map(str, sorted(side)))} leave numbers out"
                self._tell("SC622", message, section.line, "numbers")

    def _lanes(self, road: str, side: Element | None) -> list[Lane]:
        lane_by_id: dict[int, Lane] = {}
        for element in () if side is None else side.all("lane"):
            try:
                lane = lane_of(element)
            except UnusablePart as wrong:
                self._tell_of(wrong.about, "SC622", f"a lane of road {road} is left out: {wrong}", "lane")
                continue
            if lane.id == 0:
                continue
            self._lane_faults(f"lane {lane.id} of road {road}", element, lane)
            if lane.id in lane_by_id:
                message = f"lane {lane.id} of road {road} is there twice: the second is left out"
                self._tell("SC622", message, lane.line, "twice")
                continue
            if not lane.widths and not lane.borders:
                message = f"lane {lane.id} of road {road} has no width: left out"
                self._tell("SC622", message, lane.line, "width")
                continue
            lane_by_id[lane.id] = lane
        return list(lane_by_id.values())

    def _lane_faults(self, name: str, element: Element, lane: Lane) -> None:
        """Report attributes that a lane lacks, and widths that do not begin with it."""
        if not element.attributes.get("type"):
            message = f"{name} has no type: it is for nobody"
            self._tell_of((element, "type"), "SC622", message, "no type")
        for which in lane.lost:
            end = next(end for link in element.all("link") for end in link.all(which))
            fault = self._faults.get((end, "id"))
            message = f"the {which} of {name} has no id" if fault is None else fault.message
            self._tell_of((end, "id"), "SC623", f"{message}: dropped", "lane link")
        widths = list(element.all("width"))
        if widths and lane.widths[0].start > _SHORTEST:
            start = widths[0].attributes["sOffset"]
            message = f"the widths of {name} begin at sOffset = {start}, not 0: the first counts before"
            self._tell("SC622", message, widths[0].line, "width late")
        for width in widths:
            missing = [letter for letter in "abcd" if (width, letter) in self._faults]
            if missing:
                message = f"a width of {name} has no {', '.join(missing)}: 0 counts"
                for letter in missing:
                    self._faults.pop((width, letter))
                self._tell("SC622", message, width.line, "coefficients")

    # Beside the road

    def _signals(self, road: str, signals: Element | None, end: float) -> Iterator[Signal | SignalReference]:
        self._within(road, () if signals is None else signals.all("signal"), end)
        for element in () if signals is None else signals.children:
            if element.tag not in ("signal", "signalReference") or "id" not in element.attributes:
                continue
            attributes = element.attributes
            lanes = validity(element)
            # Some exporters write lanes 0 to 0 where they mean none of the own road.
            is_valid = not lanes or any(pair != (0, 0) for pair in lanes)
            lanes = tuple(pair for pair in lanes if pair != (0, 0))
            if element.tag == "signalReference":
                if not is_valid:
                    continue
                yield SignalReference(
                    attributes["id"],
                    attributes.get("orientation", "none"),
                    number_or(element, "s", 0.0),
                    lanes,
                    element.line,
                )
                continue
            try:
                place = number_of(element, "s", 0.0), number_of(element, "t", 0.0)
            except UnusablePart as wrong:
                self._tell_of(wrong.about, "SC621", f"a signal of road {road} is left out: {wrong}", "signal")
                continue
            yield Signal(
                attributes["id"],
                attributes.get("country", ""),
                attributes.get("type", ""),
                attributes.get("subtype", ""),
                attributes.get("orientation", "none"),
                *place,
                number_or(element, "zOffset", 0.0),
                number_or(element, "value", None),
                lanes,
                priorities(element),
                tuple(ids(element, "reference", "elementId")),
                tuple(ids(element, "dependency", "id")),
                is_valid,
                element.line,
            )

    def _crosswalks(self, objects: Element | None) -> Iterator[Crosswalk]:
        for element in () if objects is None else objects.all("object"):
            if element.attributes.get("type") != "crosswalk":
                continue
            try:
                crosswalk = crosswalk_of(element)
            except UnusablePart as wrong:
                self._tell_of(
                    wrong.about,
                    "SC621",
                    f"crosswalk {element.attributes.get('id')} is left out: {wrong}",
                    "crosswalk",
                )
                continue
            yield crosswalk

    # Junctions

    def _junction(self, element: Element) -> Junction:
        name = text_of(element, "id")
        kind = element.attributes.get("type", "default")
        if kind not in ("default", "direct", "virtual", "common"):
            message = f"junction {name} is of the unknown type {kind!r}"
            self._tell_of((element, "type"), "SC624", message, "type")
        connections = []
        for item in element.all("connection"):
            attributes = item.attributes
            if "incomingRoad" not in attributes or not (
                "connectingRoad" in attributes or "linkedRoad" in attributes
            ):
                message = f"a connection of junction {name} without roads is left out"
                self._tell_of((item, "incomingRoad"), "SC624", message, "connection")
                self._left_out.add(f"connections of {name}")
                continue
            links: list[LaneLinks] = []
            for link in item.all("laneLink"):
                try:
                    link_pair = LaneLinks(integer_of(link, "from"), integer_of(link, "to"), link.line)
                except UnusablePart as wrong:
                    message = f"a lane link of junction {name} is left out: {wrong}"
                    self._tell_of(wrong.about, "SC624", message, "link")
                    continue
                if link_pair in links:
                    message = f"a connection of junction {name} has a lane link twice: once counts"
                    self._tell("SC624", message, link.line, "link twice")
                else:
                    links.append(link_pair)
            if attributes.get("contactPoint") not in ("start", "end"):
                message = f"a connection of junction {name} has no 'contactPoint': start counts"
                self._tell_of((item, "contactPoint"), "SC624", message, "contact of connection")
            connecting = attributes.get("connectingRoad", attributes.get("linkedRoad", ""))
            contact = contact_of(attributes.get("contactPoint")) or "start"
            connections.append(
                Connection(
                    attributes.get("id", ""),
                    attributes["incomingRoad"],
                    connecting,
                    contact,
                    tuple(links) if item.first("laneLink") else None,
                    item.line,
                )
            )
        return Junction(name, element.attributes.get("name", ""), kind, tuple(connections), element.line)
