"""From the text of an OpenDRIVE file to records (sections 3.1 and 3.7 of the driving specification).

Anything that is wrong with a part of the file costs at most that part, and is told as a `Problem` with its line.
"""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Final, Literal

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
    MapRecords,
    Problem,
    Road,
    Shape,
    Signal,
    SignalReference,
)
from scenic.formats.opendrive.xml_tree import Element, MapError, read_tree
from scenic.language.spans import Span

__all__ = ["read_map"]

_SPEEDS: Final = {"m/s": 1.0, "km/h": 1 / 3.6, "kmh": 1 / 3.6, "mph": 0.44704, "": 1.0}
_SHORTEST: Final = 1e-6
"""Metres; shorter pieces of a reference line are skipped."""
_SHARPEST: Final = 50.0
"""Change of curvature in 1/m^2 from which on a spiral is an artefact."""
_AGREEMENT: Final = 1e-3
"""Metres by which the length of a piece may differ from the distance to the next one without a word."""
_ALIKE: Final = 5
"""Problems of one kind that are told one by one."""


class _Wrong(Exception):
    """A part of the file that cannot be used, and why."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.line = line


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
    return _Reader(filename).map(root, reference)


class _Reader:
    def __init__(self, filename: str) -> None:
        self._filename = filename
        self._problems: list[Problem] = []

    def _tell(self, code: str, message: str, line: int, kind: str) -> None:
        self._problems.append(Problem(code, message, line, kind))

    def map(self, root: Element, reference: str) -> MapRecords:
        header = root.first("header") or Element("header", {}, root.line)
        version = f"{header.attributes.get('revMajor', '1')}.{header.attributes.get('revMinor', '?')}"
        roads: dict[str, Road] = {}
        for element in root.all("road"):
            try:
                road = self._road(element)
            except _Wrong as wrong:
                name = element.attributes.get("id", "?")
                self._tell("SC621", f"road {name} is left out: {wrong}", wrong.line, "road")
                continue
            if road.id in roads:
                self._tell(
                    "SC621", f"road {road.id} is there twice: the second is left out", road.line, "twice"
                )
            else:
                roads[road.id] = road
        junctions: dict[str, Junction] = {}
        for element in root.all("junction"):
            try:
                junction = self._junction(element)
            except _Wrong as wrong:
                name = element.attributes.get("id", "?")
                self._tell("SC624", f"junction {name} is left out: {wrong}", wrong.line, "junction")
                continue
            if junction.id in junctions:
                message = f"junction {junction.id} is there twice: the second is left out"
                self._tell("SC624", message, junction.line, "twice")
            else:
                junctions[junction.id] = junction
        if not roads:
            raise MapError(
                "the map has no road that can be used",
                filename=self._filename,
                span=Span(root.line, 0, root.line, 1),
                help="check the file with `scenic check`" if self._problems else "is the file complete?",
            )
        return MapRecords(
            self._filename,
            version,
            header.attributes.get("vendor", ""),
            reference,
            tuple(roads.values()),
            tuple(junctions.values()),
            tuple(self._problems),
        )

    # Roads

    def _road(self, element: Element) -> Road:
        name = _text(element, "id")
        plan = element.first("planView")
        if plan is None:
            raise _Wrong("it has no planView", element.line)
        length = _number(element, "length", math.nan)
        geometry = self._plan(name, plan, length)
        ends = geometry[-1].s + geometry[-1].length
        lanes = element.first("lanes")
        if lanes is None:
            raise _Wrong("it has no lanes", element.line)
        type_ = element.first("type")
        speed = None if type_ is None else _speed(type_.first("speed"))
        junction = element.attributes.get("junction", "-1")
        return Road(
            name,
            element.attributes.get("name", ""),
            ends,
            None if junction in ("-1", "") else junction,
            element.attributes.get("rule", "RHT").upper() == "LHT",
            "" if type_ is None else type_.attributes.get("type", ""),
            speed,
            self._link(element, "predecessor"),
            self._link(element, "successor"),
            geometry,
            _profile(element.first("elevationProfile"), "elevation"),
            _profile(element.first("lateralProfile"), "superelevation"),
            tuple(_cubics(lanes, "laneOffset", "s")),
            self._sections(name, lanes, ends),
            tuple(self._signals(element.first("signals"))),
            tuple(self._crosswalks(element.first("objects"))),
            element.line,
        )

    def _once(self, where: str, elements: Sequence[Element]) -> None:
        """Report elements of which there may be only one."""
        if len(elements) > 1:
            message = f"{where} has {len(elements)} elements <{elements[1].tag}>: the first counts"
            self._tell("SC621", message, elements[1].line, "repeated")

    def _link(self, road: Element, which: str) -> Link | None:
        link = road.first("link")
        if link is None:
            return None
        ends = list(link.all(which))
        name = road.attributes.get("id", "?")
        self._once(f"the link of road {name}", ends)
        end = ends[0] if ends else None
        if end is None:
            return None
        if "elementId" not in end.attributes:
            self._tell("SC623", f"the {which} of road {name} has no 'elementId': dropped", end.line, "link")
            return None
        kind = end.attributes.get("elementType", "road")
        contact = end.attributes.get("contactPoint")
        if kind not in ("road", "junction"):
            self._tell("SC623", f"a link to an element of the type {kind!r} is dropped", end.line, "link")
            return None
        element: Literal["road", "junction"] = "junction" if kind == "junction" else "road"
        if element == "road" and contact not in ("start", "end"):
            message = f"the {which} of road {name} has no 'contactPoint': the links of the other road decide"
            self._tell("SC623", message, end.line, "contact")
        return Link(element, end.attributes["elementId"], _contact(contact), end.line)

    def _plan(self, road: str, plan: Element, declared: float) -> tuple[Geometry, ...]:
        pieces: list[Geometry] = []
        short: list[Geometry] = []
        for element in plan.all("geometry"):
            piece = _geometry(element)
            self._once(f"a piece of road {road}", [part for part in element.children if part.tag in _NUMBERS])
            is_sharp = (
                piece.shape == "spiral"
                and piece.length > 0
                and abs(piece.numbers[1] - piece.numbers[0]) / piece.length > _SHARPEST
            )
            if piece.length < _SHORTEST or is_sharp:
                what = "bends too sharply" if is_sharp else "has no length"
                self._tell("SC621", f"a piece of road {road} that {what} is skipped", piece.line, "piece")
                short.append(piece)
                continue
            if pieces and piece.s <= pieces[-1].s:
                raise _Wrong("the pieces of its reference line are out of order", piece.line)
            pieces.append(piece)
        if not pieces:
            if not short:
                raise _Wrong("its planView has no geometry", plan.line)
            longest = max(short, key=lambda piece: piece.length)
            if longest.length <= 0:
                raise _Wrong("its reference line has no length", plan.line)
            pieces = [longest]
        for index, (piece, after) in enumerate(pairwise(list(pieces))):
            real = after.s - piece.s
            if abs(real - piece.length) > _AGREEMENT:
                message = (
                    f"a piece of road {road} is {piece.length:.4f} m long, "
                    f"but the next one begins {real:.4f} m on: that counts"
                )
                self._tell("SC621", message, piece.line, "length")
            pieces[index] = replace(piece, length=real)
        first = pieces[0].s
        if first:
            # Everything else counts from the start of the road.
            pieces[0] = replace(pieces[0], s=0.0)
            if abs(first) > _AGREEMENT:
                self._tell("SC621", f"road {road} begins at s = {first:g}, not 0", pieces[0].line, "start")
            for index in range(1, len(pieces)):
                pieces[index] = replace(pieces[index], s=pieces[index].s - first)
        end = pieces[-1].s + pieces[-1].length
        if abs(declared - end) > max(_AGREEMENT, 1e-3 * end):
            message = f"road {road} is declared {declared:.3f} m long, its reference line is {end:.3f} m"
            self._tell("SC621", message, plan.line, "length")
        return tuple(pieces)

    # Lanes

    def _sections(self, road: str, lanes: Element, end: float) -> tuple[LaneSection, ...]:
        sections: list[LaneSection] = []
        for element in lanes.all("laneSection"):
            start = _number(element, "s", 0.0)
            if sections and start <= sections[-1].s:
                self._tell(
                    "SC622",
                    f"a lane section of road {road} is out of order: left out",
                    element.line,
                    "section",
                )
                continue
            if start >= end - _SHORTEST and sections:
                message = f"a lane section of road {road} begins behind its end: left out"
                self._tell("SC622", message, element.line, "section")
                continue
            left = self._lanes(road, element.first("left"))
            right = self._lanes(road, element.first("right"))
            wrong = [lane for lane in left if lane.id < 0] + [lane for lane in right if lane.id > 0]
            for lane in wrong:
                message = f"lane {lane.id} of road {road} is on the wrong side: left out"
                self._tell("SC622", message, lane.line, "side")
            both = {lane.id: lane for lane in (*left, *right) if lane not in wrong}
            ordered = sorted(both.values(), key=lambda lane: -lane.id)
            sections.append(LaneSection(0.0 if not sections else start, tuple(ordered), element.line))
        if not sections or not any(section.lanes for section in sections):
            raise _Wrong("it has no lanes", lanes.line)
        return tuple(sections)

    def _lanes(self, road: str, side: Element | None) -> list[Lane]:
        found: dict[int, Lane] = {}
        for element in () if side is None else side.all("lane"):
            try:
                lane = _lane(element)
            except _Wrong as wrong:
                self._tell("SC622", f"a lane of road {road} is left out: {wrong}", wrong.line, "lane")
                continue
            if lane.id == 0:
                continue
            self._lane_faults(f"lane {lane.id} of road {road}", element, lane)
            if lane.id in found:
                message = f"lane {lane.id} of road {road} is there twice: the second is left out"
                self._tell("SC622", message, lane.line, "twice")
                continue
            if not lane.widths and not lane.borders:
                message = f"lane {lane.id} of road {road} has no width: left out"
                self._tell("SC622", message, lane.line, "width")
                continue
            found[lane.id] = lane
        return list(found.values())

    def _lane_faults(self, name: str, element: Element, lane: Lane) -> None:
        """Report attributes that a lane lacks, and what it has twice."""
        if not element.attributes.get("type"):
            self._tell("SC622", f"{name} has no type: it is for nobody", element.line, "no type")
        starts: set[str] = set()
        for child in element.children:
            if child.tag == "link":
                for which in ("predecessor", "successor"):
                    ends = list(child.all(which))
                    self._once(f"the link of {name}", ends)
                    if ends and "id" not in ends[0].attributes:
                        self._tell(
                            "SC623", f"the {which} of {name} has no id: dropped", ends[0].line, "lane link"
                        )
            elif child.tag == "width":
                start = child.attributes.get("sOffset", "0")
                if not starts and lane.widths[0].start > _SHORTEST:
                    message = (
                        f"the widths of {name} begin at sOffset = {start}, not 0: the first counts before"
                    )
                    self._tell("SC622", message, child.line, "width late")
                if start in starts:
                    message = f"{name} has two widths at sOffset = {start}: the last counts"
                    self._tell("SC622", message, child.line, "width twice")
                starts.add(start)
                missing = [letter for letter in "abcd" if letter not in child.attributes]
                if missing:
                    message = f"a width of {name} has no {', '.join(missing)}: 0 counts"
                    self._tell("SC622", message, child.line, "coefficients")

    # Beside the road

    def _signals(self, signals: Element | None) -> Iterator[Signal | SignalReference]:
        for element in () if signals is None else signals.children:
            if element.tag not in ("signal", "signalReference") or "id" not in element.attributes:
                continue
            given = element.attributes
            lanes = [
                (v.attributes.get("fromLane"), v.attributes.get("toLane")) for v in element.all("validity")
            ]
            is_valid = not lanes or any(pair != ("0", "0") for pair in lanes)
            if element.tag == "signalReference":
                if not is_valid:
                    continue
                yield SignalReference(given["id"], given.get("orientation", "none"), element.line)
                continue
            try:
                place = _number(element, "s", 0.0), _number(element, "t", 0.0)
            except _Wrong as wrong:
                self._tell("SC621", f"a signal is left out: {wrong}", wrong.line, "signal")
                continue
            yield Signal(
                given["id"],
                given.get("country", ""),
                given.get("type", ""),
                given.get("subtype", ""),
                given.get("orientation", "none"),
                *place,
                is_valid,
                element.line,
            )

    def _crosswalks(self, objects: Element | None) -> Iterator[Crosswalk]:
        for element in () if objects is None else objects.all("object"):
            if element.attributes.get("type") != "crosswalk":
                continue
            try:
                found = _crosswalk(element)
            except _Wrong as wrong:
                self._tell("SC621", f"a crosswalk is left out: {wrong}", wrong.line, "crosswalk")
                continue
            if found is not None:
                yield found

    # Junctions

    def _junction(self, element: Element) -> Junction:
        name = _text(element, "id")
        kind = element.attributes.get("type", "default")
        if kind not in ("default", "direct", "virtual", "common"):
            self._tell("SC624", f"junction {name} is of the unknown type {kind!r}", element.line, "type")
        connections = []
        for item in element.all("connection"):
            given = item.attributes
            if "incomingRoad" not in given or not ("connectingRoad" in given or "linkedRoad" in given):
                message = f"a connection of junction {name} without roads is left out"
                self._tell("SC624", message, item.line, "connection")
                continue
            links = []
            for link in item.all("laneLink"):
                try:
                    links.append(LaneLinks(_integer(link, "from"), _integer(link, "to")))
                except _Wrong as wrong:
                    self._tell(
                        "SC624", f"a lane link of junction {name} is left out: {wrong}", wrong.line, "link"
                    )
            if len(set(links)) < len(links):
                message = f"a connection of junction {name} has a lane link twice: once counts"
                self._tell("SC624", message, item.line, "link twice")
                links = list(dict.fromkeys(links))
            if given.get("contactPoint") not in ("start", "end"):
                message = f"a connection of junction {name} has no 'contactPoint': start counts"
                self._tell("SC624", message, item.line, "contact of connection")
            connecting = given.get("connectingRoad", given.get("linkedRoad", ""))
            contact = _contact(given.get("contactPoint")) or "start"
            connections.append(
                Connection(
                    given.get("id", ""), given["incomingRoad"], connecting, contact, tuple(links), item.line
                )
            )
        return Junction(name, element.attributes.get("name", ""), kind, tuple(connections), element.line)


def told(problems: tuple[Problem, ...]) -> tuple[Problem, ...]:
    """The problems with at most a few of a kind, and a count of the others of that kind."""
    seen: Counter[str] = Counter()
    shown = []
    for problem in problems:
        seen[problem.kind] += 1
        if seen[problem.kind] <= _ALIKE:
            shown.append(problem)
    for kind, count in seen.items():
        if count > _ALIKE:
            first = next(problem for problem in problems if problem.kind == kind)
            message = f"{count - _ALIKE} more like: {first.message}"
            shown.append(Problem(first.code, message, first.line, kind))
    return tuple(shown)


# Parts of elements


def _text(element: Element, name: str) -> str:
    value = element.attributes.get(name, "").strip()
    if not value:
        raise _Wrong(f"<{element.tag}> has no {name!r}", element.line)
    return value


def _number(element: Element, name: str, default: float | None = None) -> float:
    text = element.attributes.get(name)
    if text is None:
        if default is None:
            raise _Wrong(f"<{element.tag}> has no {name!r}", element.line)
        return default
    try:
        value = float(text)
    except ValueError:
        raise _Wrong(f"{name!r} of <{element.tag}> is {text!r}, not a number", element.line) from None
    if not math.isfinite(value) or abs(value) > 1e12:
        raise _Wrong(f"{name!r} of <{element.tag}> is {text}, not a finite number", element.line)
    return value


def _integer(element: Element, name: str) -> int:
    value = _number(element, name)
    if value != int(value):
        raise _Wrong(f"{name!r} of <{element.tag}> is not an integer", element.line)
    return int(value)


def _contact(text: str | None) -> Literal["start", "end"] | None:
    return "start" if text == "start" else "end" if text == "end" else None


def _speed(element: Element | None) -> float | None:
    if element is None:
        return None
    try:
        value = float(element.attributes.get("max", ""))
    except ValueError:  # "no limit", "undefined"
        return None
    factor = _SPEEDS.get(element.attributes.get("unit", ""), 1.0)
    return value * factor if math.isfinite(value) and value > 0 else None


def _cubics(element: Element, tag: str, start: str) -> Iterator[Cubic]:
    found = {}
    for item in element.all(tag):
        cubic = Cubic(_number(item, start, 0.0), *(_number(item, name, 0.0) for name in ("a", "b", "c", "d")))
        found[cubic.start] = cubic
    yield from (found[key] for key in sorted(found))


def _profile(element: Element | None, tag: str) -> tuple[Cubic, ...]:
    return () if element is None else tuple(_cubics(element, tag, "s"))


def _geometry(element: Element) -> Geometry:
    shapes = [child for child in element.children if child.tag in _NUMBERS]
    if not shapes:
        raise _Wrong("a piece of its reference line has no shape", element.line)
    shape = shapes[0]
    numbers = tuple(_number(shape, name) for name in _NUMBERS[shape.tag])
    normalized = shape.tag == "paramPoly3" and shape.attributes.get("pRange", "normalized") != "arcLength"
    kind: Shape = shape.tag  # type: ignore[assignment] # it is one of the keys of the table
    s, x, y, heading, length = (_number(element, name) for name in ("s", "x", "y", "hdg", "length"))
    return Geometry(s, x, y, heading, length, kind, numbers, normalized, element.line)


_NUMBERS: Final[dict[str, tuple[str, ...]]] = {
    "line": (),
    "arc": ("curvature",),
    "spiral": ("curvStart", "curvEnd"),
    "poly3": ("a", "b", "c", "d"),
    "paramPoly3": ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV"),
}


def _lane(element: Element) -> Lane:
    link = element.first("link")

    def neighbour(which: str) -> int | None:
        end = None if link is None else link.first(which)
        return None if end is None or "id" not in end.attributes else _integer(end, "id")

    access = frozenset(
        f"{item.attributes.get('rule', 'allow')} {item.attributes.get('restriction', '')}"
        for item in element.all("access")
    )
    speeds = [speed for item in element.all("speed") if (speed := _speed(item)) is not None]
    return Lane(
        _integer(element, "id"),
        element.attributes.get("type", "none"),
        neighbour("predecessor"),
        neighbour("successor"),
        tuple(_cubics(element, "width", "sOffset")),
        tuple(_cubics(element, "border", "sOffset")),
        speeds[0] if speeds else None,
        access,
        element.line,
    )


def _crosswalk(element: Element) -> Crosswalk | None:
    outlines = list(element.all("outline"))
    for several in element.all("outlines"):
        outlines += several.all("outline")
    for outline in outlines:
        along = [(_number(c, "s"), _number(c, "t")) for c in outline.all("cornerRoad")]
        local = [(_number(c, "u"), _number(c, "v")) for c in outline.all("cornerLocal")]
        corners = along or local
        if len(corners) >= 3:
            s, t, heading = (_number(element, name, 0.0) for name in ("s", "t", "hdg"))
            name = element.attributes.get("id", "")
            return Crosswalk(name, s, t, heading, tuple(corners), bool(along), element.line)
    return None
