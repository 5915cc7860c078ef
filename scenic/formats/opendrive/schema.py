"""The structure that the OpenDRIVE standard requires of a file, for the elements that are read, and the search for violations.

Attributes that only later versions of the standard require are optional here.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass
from scenic.formats.opendrive.xml_tree import Element

__all__ = ["Fault", "faults_of"]

LARGEST: Final = 1e12
"""Numbers beyond this are taken for mistakes."""


@dataclass(frozen=True, slots=True)
class Fault:
    """A violation of the standard.

    Attributes:
        message: what is wrong.
        line: the line of the element.
        where: the kind of element in which it is: ``road``, ``lane``, ``link`` or ``junction``.

    """

    message: str
    line: int
    where: str


def _number(text: str, least: float = -LARGEST) -> str | None:
    try:
        value = float(text)
    except ValueError:
        return "not a number"
    if not math.isfinite(value) or abs(value) > LARGEST:
        return "not a finite number"
    return None if value >= least else "negative"


def _place(text: str) -> str | None:
    return _number(text, 0.0)


def _length(text: str) -> str | None:
    found = _number(text, 0.0)
    return "not positive" if found is None and float(text) == 0 else found


def _integer(text: str) -> str | None:
    found = _number(text)
    return "not an integer" if found is None and float(text) != int(float(text)) else found


def _count(text: str) -> str | None:
    return None if text.strip().isdecimal() and int(text) < 65536 else "not a version number"


def _speed(text: str) -> str | None:
    return None if text in ("no limit", "undefined") else _number(text, 0.0)


def _country(text: str) -> str | None:
    is_code = len(text) in (2, 3) and text.isalpha() and text.isupper()
    return None if is_code or text in _COUNTRIES else "not the code of a country"


def _text(_text: str) -> None:
    return None


def _one_of(words: str) -> Callable[[str], str | None]:
    known = frozenset(words.split("|"))
    return lambda text: None if text in known else f"not one of those that the standard knows{_listed(known)}"


def _listed(words: frozenset[str]) -> str:
    return f" ({', '.join(sorted(words))})" if len(words) < 6 else ""


_COUNTRIES: Final = frozenset(
    {"OpenDRIVE", "Austria", "Brazil", "China", "France", "Germany", "Italy", "Switzerland", "USA"}
)
"""Names that earlier versions of the standard use."""

_LANE_TYPES: Final = (
    "shoulder|border|driving|stop|none|restricted|parking|median|biking|sidewalk|walking|curb|exit|entry|onRamp|offRamp|"
    "connectingRamp|slipLane|bidirectional|shared|special1|special2|special3|roadWorks|roadMarks|tram|rail|bus|taxi|HOV|"
    "mwyEntry|mwyExit"
)
_ROAD_TYPES: Final = (
    "unknown|rural|motorway|town|lowSpeed|pedestrian|bicycle|townExpressway|townCollector|townArterial|townPrivate|"
    "townLocal|townPlayStreet"
)

_TYPES: Final[Mapping[str, Callable[[str], str | None]]] = MappingProxyType(
    {
        "number": _number,
        "place": _place,
        "length": _length,
        "integer": _integer,
        "count": _count,
        "speed": _speed,
        "id": lambda text: None if text.strip() else "empty",
        "country": _country,
        "orientation": _one_of("+|-|none"),
        "yes no": _one_of("yes|no"),
        "text": _text,
        "contact": _one_of("start|end"),
        "linked": _one_of("road|junction"),
        "rule": _one_of("RHT|LHT"),
        "range": _one_of("arcLength|normalized"),
        "unit": _one_of("m/s|mph|km/h"),
        "level": _one_of("true|false|0|1"),
        "lane type": _one_of(_LANE_TYPES),
        "road type": _one_of(_ROAD_TYPES),
        "junction type": _one_of("default|direct|virtual|common|crossing"),
    }
)

_CUBIC: Final = "a:number b:number c:number d:number"

_SIGN: Final = (
    "dynamic:yes_no? zOffset:number? country:country? value:number? height:place? width:place? hOffset:number? "
    "pitch:number? roll:number?"
)

_DECLARED: Final = MappingProxyType(
    # Each element by its path from the nearest one that tells it from others of its name: its attributes, then what it holds.
    {
        "OpenDRIVE": ("", "header road+ junction*"),
        "header": (
            "revMajor:count revMinor:count north:number? south:number? east:number? west:number?",
            "offset?",
        ),
        "road": (
            "id:id length:place junction:id rule:rule?",
            "link? type* planView elevationProfile? lateralProfile? lanes objects? signals?",
        ),
        "road/link": ("", "predecessor? successor?"),
        "road/link/predecessor": ("elementId:id elementType:linked contactPoint:contact?", ""),
        "road/link/successor": ("elementId:id elementType:linked contactPoint:contact?", ""),
        "type": ("s:place type:road_type", "speed?"),
        "speed": ("max:speed unit:unit?", ""),
        "planView": ("", "geometry+"),
        "geometry": ("s:place x:number y:number hdg:number length:place", ""),
        "spiral": ("curvStart:number curvEnd:number", ""),
        "arc": ("curvature:number", ""),
        "poly3": (_CUBIC, ""),
        "paramPoly3": (
            "aU:number bU:number cU:number dU:number aV:number bV:number cV:number dV:number pRange:range?",
            "",
        ),
        "elevationProfile": ("", "elevation*"),
        "elevation": (f"s:place {_CUBIC}", ""),
        "lateralProfile": ("", "superelevation* crossfall* shape*"),
        "superelevation": (f"s:place {_CUBIC}", ""),
        "crossfall": (f"s:place {_CUBIC}", ""),
        "shape": (f"s:place t:number {_CUBIC}", ""),
        "lanes": ("", "laneOffset* laneSection+"),
        "laneOffset": (f"s:place {_CUBIC}", ""),
        "laneSection": ("s:place", "left? center right?"),
        "left": ("", "lane+"),
        "right": ("", "lane+"),
        "center": ("", "lane"),
        "lane": ("id:integer type:lane_type level:level?", "link? width* border* speed* access* height*"),
        "lane/link": ("", "predecessor? successor?"),
        "lane/link/predecessor": ("id:integer", ""),
        "lane/link/successor": ("id:integer", ""),
        "width": (f"sOffset:place {_CUBIC}", ""),
        "border": (f"sOffset:place {_CUBIC}", ""),
        "lane/speed": ("sOffset:place max:speed unit:unit?", ""),
        "signals": ("", "signal* signalReference*"),
        "signal": (
            f"id:id s:place t:number type:text orientation:orientation {_SIGN}",
            "validity*",
        ),
        "signalReference": ("id:id s:place t:number orientation:orientation?", "validity*"),
        "validity": ("fromLane:integer toLane:integer", ""),
        "objects": ("", "object*"),
        "object": ("id:id s:place t:number", "outline? outlines?"),
        "outlines": ("", "outline+"),
        "outline": ("", "cornerRoad* cornerLocal*"),
        "cornerRoad": ("s:place t:number", ""),
        "cornerLocal": ("u:number v:number", ""),
        "junction": ("id:id type:junction_type?", "connection*"),
        "connection": ("id:id incomingRoad:id contactPoint:contact", "laneLink*"),
        "laneLink": ("from:integer to:integer", ""),
    }
)

_ASCENDING: Final = MappingProxyType(
    {
        "type": "s",
        "elevation": "s",
        "superelevation": "s",
        "laneOffset": "s",
        "width": "sOffset",
        "border": "sOffset",
    }
)
"""Elements that follow each other along the road, and the attribute with their start."""


class _Rule:
    """The attributes and children of one kind of element."""

    __slots__ = ("children", "inner", "optional", "required")

    def __init__(self, attributes: str, children: str) -> None:
        self.required: dict[str, Callable[[str], str | None]] = {}
        self.optional: dict[str, Callable[[str], str | None]] = {}
        for item in attributes.split():
            name, _, kind = item.partition(":")
            known = self.optional if kind.endswith("?") else self.required
            known[name] = _TYPES[kind.rstrip("?").replace("_", " ")]
        words = children.split()
        self.children = {word.rstrip("?*+"): word[-1] if word[-1] in "?*+" else "" for word in words}
        self.inner: dict[str, _Rule] = {}


def _rules() -> _Rule:
    """Return the rule of the root, from which those of all others are reached."""
    rules = {path: _Rule(*declaration) for path, declaration in _DECLARED.items()}
    for path, rule in rules.items():
        for child in rule.children:
            inner_rule = rules.get(f"{path}/{child}", rules.get(child))
            if inner_rule is not None:
                rule.inner[child] = inner_rule
    for shape in ("spiral", "arc", "poly3", "paramPoly3"):
        rules["geometry"].inner[shape] = rules[shape]
    return rules["OpenDRIVE"]


_ROOT: Final = _rules()

_WHERE: Final = MappingProxyType(
    {"road": "road", "laneSection": "lane", "link": "link", "junction": "junction"}
)


def faults_of(root: Element) -> Iterator[tuple[tuple[Element, str], Fault]]:
    """The violations in a file, each under its element and the name of the attribute or child that is concerned."""
    yield from _faults(root, _ROOT, "the map", "road")
    yield from _repeated_ids(root)


def _faults_of_attributes(
    element: Element, rule: _Rule, name: str, where: str
) -> Iterator[tuple[tuple[Element, str], Fault]]:
    for attributes, must in ((rule.required, True), (rule.optional, False)):
        for attribute, check in attributes.items():
            text = element.attributes.get(attribute)
            if text is None:
                if must:
                    message = f"<{element.tag}> of {name} has no {attribute!r}"
                    yield (element, attribute), Fault(message, element.line, where)
                continue
            wrong = check(text)
            if wrong is not None:
                message = f"{attribute!r} of <{element.tag}> of {name} is {text!r}, {wrong}"
                yield (element, attribute), Fault(message, element.line, where)


def _name(child: Element, name: str) -> str:
    """The name of an element in messages: its own, or that of the one around it."""
    if child.tag in ("road", "junction"):
        return f"{child.tag} {child.attributes.get('id')}"
    return f"lane {child.attributes.get('id')} of {name}" if child.tag == "lane" else name


def _faults(
    element: Element, rule: _Rule, name: str, where: str
) -> Iterator[tuple[tuple[Element, str], Fault]]:
    """Yield the violations in an element and all that it holds."""
    yield from _faults_of_attributes(element, rule, name, where)
    if not rule.children and not rule.inner:
        return
    counts: dict[str, int] = {}
    starts: dict[str, float] = {}
    for child in element.children:
        tag = child.tag
        counts[tag] = counts.get(tag, 0) + 1
        inner = rule.inner.get(tag)
        if tag in rule.children and counts[tag] == 2 and rule.children[tag] in ("", "?"):
            message = f"{name} has more than one <{tag}>: the first counts"
            yield (child, "repeated"), Fault(message, child.line, _WHERE.get(tag, where))
        if inner is None:
            continue
        if (along := _ASCENDING.get(tag)) is not None and _place(
            begin := child.attributes.get(along, "")
        ) is None:
            start = float(begin)
            if start <= starts.get(tag, -1.0):
                message = f"<{tag}> of {name} at {along} = {begin} does not begin behind the one before it"
                yield (child, "order"), Fault(message, child.line, where)
            starts[tag] = start
        yield from _faults(child, inner, _name(child, name), _WHERE.get(tag, where))
    for tag, many in rule.children.items():
        if many in ("", "+") and tag not in counts:
            message = (
                f"<{element.tag}> of {name} has no <{tag}>"
                if element.tag != "OpenDRIVE"
                else f"the map has no <{tag}>"
            )
            yield (element, tag), Fault(message, element.line, _WHERE.get(tag, where))


def _repeated_ids(root: Element) -> Iterator[tuple[tuple[Element, str], Fault]]:
    """Yield the signals, objects and connections whose id another one of their kind has."""
    for paths in (("signals", "signal"), ("objects", "object")):
        outer, tag = paths
        identifiers: set[str] = set()
        for road in root.all("road"):
            group = road.first(outer)
            for item in () if group is None else group.all(tag):
                yield from _again(item, identifiers, f"road {road.attributes.get('id')}", "road")
    for junction in root.all("junction"):
        identifiers = set()
        for item in junction.all("connection"):
            yield from _again(item, identifiers, f"junction {junction.attributes.get('id')}", "junction")


def _again(
    item: Element, seen: set[str], name: str, where: str
) -> Iterator[tuple[tuple[Element, str], Fault]]:
    own = item.attributes.get("id")
    if own is None:
        return
    if own in seen:
        message = f"<{item.tag}> {own} of {name} has the id of another one"
        yield (item, "twice"), Fault(message, item.line, where)
    seen.add(own)
