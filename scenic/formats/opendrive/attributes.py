"""Attributes of elements of OpenDRIVE files that have a meaning of their own: speeds, validity, offsets."""

import math
from collections.abc import Iterator
from typing import Any, Final

from scenic.formats.opendrive.xml_tree import Element

__all__ = ["ids", "junction_groups", "number_or", "offset", "priorities", "speed", "validity"]

_SPEEDS: Final = {"m/s": 1.0, "km/h": 1 / 3.6, "kmh": 1 / 3.6, "mph": 0.44704, "": 1.0}


def offset(header: Element) -> tuple[float, float, float, float]:
    """Return metres along x, y and z, and radians, by which the coordinates of the file are moved."""
    found = header.first("offset")
    if found is None:
        return 0.0, 0.0, 0.0, 0.0
    x, y, z, heading = (number_or(found, name, 0.0) for name in ("x", "y", "z", "hdg"))
    return x, y, z, heading


def junction_groups(root: Element) -> dict[str, frozenset[str]]:
    """The types of groups, such as ``roundabout``, to which each junction belongs, by the junction's id."""
    found: dict[str, frozenset[str]] = {}
    for group in root.all("junctionGroup"):
        for junction in ids(group, "junctionReference", "junction"):
            found[junction] = found.get(junction, frozenset()) | {group.attributes.get("type", "unknown")}
    return found


def validity(element: Element) -> tuple[tuple[int, int], ...]:
    """First and last ids of lanes for which something is valid."""
    found = []
    for item in element.all("validity"):
        try:
            found.append((int(item.attributes.get("fromLane", "")), int(item.attributes.get("toLane", ""))))
        except ValueError:  # a finding of the schema
            continue
    return tuple((min(pair), max(pair)) for pair in found)


def priorities(element: Element) -> tuple[str, ...]:
    semantics = element.first("semantics")
    if semantics is None:
        return ()
    return tuple(item.attributes.get("type", "") for item in semantics.all("priority"))


def ids(element: Element, tag: str, attribute: str) -> Iterator[str]:
    for item in element.all(tag):
        if attribute in item.attributes:
            yield item.attributes[attribute]


def number_or(element: Element, name: str, default: object) -> Any:
    """A number of an element; the default where it is none."""
    try:
        value = float(element.attributes[name])
    except (KeyError, ValueError):
        return default
    return value if math.isfinite(value) else default


def speed(element: Element | None) -> float | None:
    if element is None:
        return None
    try:
        value = float(element.attributes.get("max", ""))
    except ValueError:  # "no limit", "undefined"
        return None
    factor = _SPEEDS.get(element.attributes.get("unit", ""), 1.0)
    return value * factor if math.isfinite(value) and value > 0 else None
