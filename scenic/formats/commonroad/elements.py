"""XML elements of CommonRoad's version 2020a for records of roads; objects are named by numbers."""

import math
from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Final
from xml.etree import ElementTree

import numpy as np

from scenic.formats.commonroad.records import (
    Floats,
    Junction,
    Lanelet,
    RoadRecords,
    StopLine,
    TrafficLight,
    TrafficSign,
)

__all__ = ["Numbers", "add", "add_exact", "add_location", "add_point", "add_roads", "decimal"]

Element = ElementTree.Element

_COLORS: Final = {"off": "inactive"}
"""Colours of lights that have another name in CommonRoad."""


class Numbers:
    """Numbers of named things in a file, given in the order in which names are first used."""

    def __init__(self) -> None:
        self._numbers: dict[str, int] = {}

    def reserve(self, key: str) -> None:
        """Give a name the next number, unless it has one."""
        self._numbers.setdefault(key, len(self._numbers) + 1)

    def __getitem__(self, key: str) -> str:
        return str(self._numbers.setdefault(key, len(self._numbers) + 1))


def decimal(value: float, digits: int = 9) -> str:
    """A number as text without an exponent, which the schema does not allow."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("", "-0") else text


def add(parent: Element, tag: str, text: str | None = None, **attributes: str) -> Element:
    """Append an element and return it."""
    element = ElementTree.SubElement(parent, tag, attributes)
    element.text = text
    return element


def add_exact(parent: Element, tag: str, value: float) -> None:
    """Append a quantity with an exact value."""
    add(add(parent, tag), "exact", decimal(value))


def add_point(parent: Element, place: Iterable[float], digits: int = 9) -> None:
    """Append a point of the plane."""
    point = add(parent, "point")
    for name, value in zip("xy", place, strict=False):
        add(point, name, decimal(value, digits))


def add_location(root: Element, records: RoadRecords) -> None:
    """Append the location; the world's coordinates are unknown but for the offset of the map."""
    location = add(root, "location")
    add(location, "geoNameId", "-999")
    add(location, "gpsLatitude", "999")
    add(location, "gpsLongitude", "999")
    if any(records.offset):
        shift = add(location, "geoTransformation")
        add(shift, "geoReference", "")
        transformation = add(shift, "additionalTransformation")
        names = ("xTranslation", "yTranslation", "zRotation")
        for name, value in zip(names, records.offset, strict=True):
            add(transformation, name, decimal(value))
        add(transformation, "scaling", "1")
    tags = add(root, "scenarioTags")
    for tag in records.tags:
        add(tags, tag)


def add_roads(root: Element, records: RoadRecords, numbers: Numbers, timestep: float) -> None:
    """Append lanelets, signs, lights and junctions."""
    before: dict[str, list[str]] = {}
    for lanelet in records.lanelets:
        for key in lanelet.successors:
            before.setdefault(key, []).append(lanelet.key)
    for lanelet in records.lanelets:
        _add_lanelet(root, lanelet, before.get(lanelet.key, ()), numbers)
    for sign in records.signs:
        _add_sign(root, sign, numbers)
    for light in records.lights:
        _add_light(root, light, numbers, timestep)
    for junction in records.junctions:
        _add_junction(root, junction, numbers)


def _add_lanelet(root: Element, lanelet: Lanelet, before: Sequence[str], numbers: Numbers) -> None:
    element = add(root, "lanelet", id=numbers[lanelet.key])
    for tag, line in zip(("leftBound", "rightBound"), _even(lanelet.left, lanelet.right), strict=True):
        bound = add(element, tag)
        for place in line.tolist():
            add_point(bound, place, 6)
    _refer(element, "predecessor", before, numbers)
    _refer(element, "successor", lanelet.successors, numbers)
    neighbours = ("adjacentLeft", lanelet.left_neighbour), ("adjacentRight", lanelet.right_neighbour)
    for tag, neighbour in neighbours:
        if neighbour is not None:
            way = "same" if neighbour[1] else "opposite"
            add(element, tag, ref=numbers[neighbour[0]], drivingDir=way)
    if lanelet.stop_line is not None:
        _add_stop_line(element, lanelet.stop_line, numbers)
    for tag, words in (
        ("laneletType", lanelet.types),
        ("userOneWay", lanelet.one_way),
        ("userBidirectional", lanelet.both_ways),
    ):
        for word in words:
            add(element, tag, word)
    _refer(element, "trafficSignRef", lanelet.signs, numbers)
    _refer(element, "trafficLightRef", lanelet.lights, numbers)


def _even(left: Floats, right: Floats) -> tuple[Floats, Floats]:
    """Both lines with equal numbers of vertices: those of one are added to the other at equal shares of the length."""
    if len(left) == len(right):
        return left, right
    shares = [_shares(line) for line in (left, right)]
    both = np.unique(np.concatenate(shares))
    first, second = (
        np.column_stack([np.interp(both, share, line[:, axis]) for axis in (0, 1)])
        for share, line in zip(shares, (left, right), strict=True)
    )
    return first, second


def _shares(line: Floats) -> Floats:
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    return np.asarray(along / along[-1]) if along[-1] > 0 else np.linspace(0.0, 1.0, len(line))


def _refer(parent: Element, tag: str, keys: Iterable[str], numbers: Numbers) -> None:
    for key in keys:
        add(parent, tag, ref=numbers[key])


def _add_stop_line(parent: Element, line: StopLine, numbers: Numbers) -> None:
    element = add(parent, "stopLine")
    add_point(element, line.start, 6)
    add_point(element, line.end, 6)
    add(element, "lineMarking", "solid")
    _refer(element, "trafficSignRef", line.signs, numbers)
    _refer(element, "trafficLightRef", line.lights, numbers)


def _add_sign(root: Element, sign: TrafficSign, numbers: Numbers) -> None:
    element = add(root, "trafficSign", id=numbers[sign.key])
    content = add(element, "trafficSignElement")
    add(content, "trafficSignID", sign.code)
    for value in sign.values:
        add(content, "additionalValue", value)
    add_point(add(element, "position"), sign.place, 6)


def _add_light(root: Element, light: TrafficLight, numbers: Numbers, timestep: float) -> None:
    element = add(root, "trafficLight", id=numbers[light.key])
    cycle = add(element, "cycle")
    # Rounded at the borders of phases, so that errors do not add up.
    end, steps = 0.0, 0
    for seconds, color in light.cycle:
        end += seconds
        duration = math.floor(end / timestep + 0.5) - steps
        if duration > 0:
            steps += duration
            phase = add(cycle, "cycleElement")
            add(phase, "duration", str(duration))
            add(phase, "color", _COLORS.get(color, color))
    add_point(add(element, "position"), light.place, 6)
    add(element, "direction", light.direction)
    add(element, "active", str(any(color != "off" for _, color in light.cycle)).lower())


def _add_junction(root: Element, junction: Junction, numbers: Numbers) -> None:
    element = add(root, "intersection", id=numbers[junction.key])
    for place, incoming in enumerate(junction.incomings):
        part = add(element, "incoming", id=numbers[f"{junction.key} incoming {place}"])
        _refer(part, "incomingLanelet", incoming.lanelets, numbers)
        turns = (
            ("successorsRight", incoming.right),
            ("successorsStraight", incoming.straight),
            ("successorsLeft", incoming.left),
        )
        for tag, keys in turns:
            _refer(part, tag, dict.fromkeys(chain(keys)), numbers)
    if junction.crossings:
        _refer(add(element, "crossing"), "crossingLanelet", junction.crossings, numbers)
