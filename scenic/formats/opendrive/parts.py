"""From elements of OpenDRIVE files to the parts of records: numbers, polynomials, pieces of lines, lanes, outlines."""

import math
from collections.abc import Iterator
from typing import Final, Literal

from scenic.formats.opendrive.attributes import speed
from scenic.formats.opendrive.records import Crosswalk, Cubic, Geometry, Lane, LateralShape, Shape, Speed
from scenic.formats.opendrive.schema import LARGEST
from scenic.formats.opendrive.xml_tree import Element

__all__ = [
    "NUMBERS_OF_SHAPES",
    "UnusablePart",
    "contact_of",
    "crosswalk_of",
    "cubics_of",
    "geometry_of",
    "integer_of",
    "lane_of",
    "lateral_shapes_of",
    "number_of",
    "profile_of",
    "text_of",
]


class UnusablePart(Exception):
    """A part of the file that cannot be used, and why.

    Args:
        message: what is wrong.
        element: the element in which it is.
        part: the attribute or child that is concerned.

    """

    def __init__(self, message: str, element: Element, part: str = "") -> None:
        super().__init__(message)
        self.line = element.line
        self.about = (element, part)


def text_of(element: Element, name: str) -> str:
    value = element.attributes.get(name, "").strip()
    if not value:
        raise UnusablePart(f"<{element.tag}> has no {name!r}", element, name)
    return value


def number_of(element: Element, name: str, default: float | None = None) -> float:
    text = element.attributes.get(name)
    if text is None:
        if default is None:
            raise UnusablePart(f"<{element.tag}> has no {name!r}", element, name)
        return default
    try:
        value = float(text)
    except ValueError:
        raise UnusablePart(f"{name!r} of <{element.tag}> is {text!r}, not a number", element, name) from None
    if not math.isfinite(value) or abs(value) > LARGEST:
        raise UnusablePart(f"{name!r} of <{element.tag}> is {text}, not a finite number", element, name)
    return value


def integer_of(element: Element, name: str) -> int:
    value = number_of(element, name)
    if value != int(value):
        raise UnusablePart(f"{name!r} of <{element.tag}> is not an integer", element, name)
    return int(value)


def contact_of(text: str | None) -> Literal["start", "end"] | None:
    return "start" if text == "start" else "end" if text == "end" else None


def cubics_of(element: Element, tag: str, start: str) -> Iterator[Cubic]:
    found = {}
    for item in element.all(tag):
        cubic = Cubic(
            number_of(item, start, 0.0), *(number_of(item, name, 0.0) for name in ("a", "b", "c", "d"))
        )
        found[cubic.start] = cubic
    yield from (found[key] for key in sorted(found))


def profile_of(element: Element | None, tag: str) -> tuple[Cubic, ...]:
    return () if element is None else tuple(cubics_of(element, tag, "s"))


def lateral_shapes_of(profile: Element | None) -> tuple[LateralShape, ...]:
    if profile is None:
        return ()
    places: dict[float, list[Element]] = {}
    for item in profile.all("shape"):
        places.setdefault(number_of(item, "s", 0.0), []).append(item)
    return tuple(
        LateralShape(s, tuple(cubics_of(Element("", {}, 0, places[s]), "shape", "t"))) for s in sorted(places)
    )


def geometry_of(element: Element) -> Geometry:
    shapes = [child for child in element.children if child.tag in NUMBERS_OF_SHAPES]
    if not shapes:
        raise UnusablePart("a piece of its reference line has no shape", element)
    shape = shapes[0]
    numbers = tuple(number_of(shape, name) for name in NUMBERS_OF_SHAPES[shape.tag])
    normalized = shape.tag == "paramPoly3" and shape.attributes.get("pRange", "normalized") != "arcLength"
    kind: Shape = shape.tag  # type: ignore[assignment] # it is one of the keys of the table
    s, x, y, heading, length = (number_of(element, name) for name in ("s", "x", "y", "hdg", "length"))
    return Geometry(s, x, y, heading, length, kind, numbers, normalized, element.line)


NUMBERS_OF_SHAPES: Final[dict[str, tuple[str, ...]]] = {
    "line": (),
    "arc": ("curvature",),
    "spiral": ("curvStart", "curvEnd"),
    "poly3": ("a", "b", "c", "d"),
    "paramPoly3": ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV"),
}


def lane_of(element: Element) -> Lane:
    link = element.first("link")
    dropped_links = set()

    def neighbour(which: str) -> int | None:
        end = None if link is None else link.first(which)
        if end is None:
            return None
        try:
            return integer_of(end, "id")
        except UnusablePart:
            dropped_links.add(which)
            return None

    access = frozenset(
        f"{item.attributes.get('rule', 'allow')} {item.attributes.get('restriction', '')}"
        for item in element.all("access")
    )
    speeds = tuple(Speed(number_of(item, "sOffset", 0.0), speed(item)) for item in element.all("speed"))
    return Lane(
        integer_of(element, "id"),
        element.attributes.get("type", "none"),
        neighbour("predecessor"),
        neighbour("successor"),
        tuple(cubics_of(element, "width", "sOffset")),
        tuple(cubics_of(element, "border", "sOffset")),
        tuple(sorted(speeds, key=lambda item: item.start)),
        access,
        element.line,
        frozenset(dropped_links),
    )


def crosswalk_of(element: Element) -> Crosswalk:
    outlines = list(element.all("outline"))
    for several in element.all("outlines"):
        outlines += several.all("outline")
    for outline in outlines:
        along = [(number_of(c, "s"), number_of(c, "t")) for c in outline.all("cornerRoad")]
        local = [(number_of(c, "u"), number_of(c, "v")) for c in outline.all("cornerLocal")]
        corners = along or local
        if len(corners) >= 3:
            s, t, heading = (number_of(element, name, 0.0) for name in ("s", "t", "hdg"))
            name = element.attributes.get("id", "")
            return Crosswalk(name, s, t, heading, tuple(corners), bool(along), element.line)
    raise UnusablePart("it has no outline with three corners", element)
