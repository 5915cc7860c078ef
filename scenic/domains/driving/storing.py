"""Networks as arrays, in which the store keeps them from one run to the next (section 3.8).

Areas are one array of well-known binary, lines one array of vertices; everything else (who follows whom, which lanes a
road has) is text in JSON, in which elements are numbers. Nothing in it is ever executed.
"""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import (
    Intersection,
    Lane,
    LaneGroup,
    LaneSection,
    LinearElement,
    Maneuver,
    NetworkElement,
    PedestrianCrossing,
    Road,
    RoadSection,
    Shoulder,
    Sidewalk,
)
from scenic.domains.driving.elevation import Elevation, RoadHeight
from scenic.domains.driving.enumerations import ManeuverType, VehicleType
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.signs import Placement, Signal
from scenic.formats.opendrive.records import Cubic, LateralShape
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.spans import Span
from scenic.runtime.geometry.store import Arrays

__all__ = ["KIND", "restored", "stored"]

KIND: Final = "road network 6"
"""Name and version of the form of the arrays."""

_Network = TypeVar("_Network", bound=RoadNetwork)

_CLASSES: Final = (
    LaneSection, Lane, LaneGroup, RoadSection, Road, Sidewalk, Shoulder, PedestrianCrossing, Intersection,
)  # fmt: skip

_PLAIN: Final = MappingProxyType({LaneSection: ("openDriveID", "isForward")})
"""Attributes that are numbers or flags."""

_ONE: Final = MappingProxyType(
    {
        LaneSection: (
            "_successor", "_predecessor", "lane", "group", "road",
            "_laneToLeft", "_laneToRight", "_fasterLane", "_slowerLane",
        ),
        Lane: ("_successor", "_predecessor", "group", "road"),
        LaneGroup: ("_successor", "_predecessor", "road", "_sidewalk", "_bikeLane", "_shoulder", "_opposite"),
        RoadSection: ("_successor", "_predecessor", "road"),
        Road: ("_successor", "_predecessor", "forwardLanes", "backwardLanes"),
        Sidewalk: ("road",),
        Shoulder: ("road", "group"),
        PedestrianCrossing: ("parent", "startSidewalk", "endSidewalk"),
        Intersection: (),
    }
)  # fmt: skip
"""Attributes that are an element or ``None``."""

_MANY: Final = MappingProxyType(
    {
        LaneSection: ("adjacentLanes",),
        Lane: ("sections",),
        LaneGroup: ("lanes",),
        RoadSection: ("lanes", "forwardLanes", "backwardLanes"),
        Road: ("lanes", "laneGroups", "sections", "crossings", "sidewalks"),
        Sidewalk: ("crossings",),
        Shoulder: (),
        PedestrianCrossing: (),
        Intersection: ("roads", "incomingLanes", "outgoingLanes", "crossings", "_connecting"),
    }
)
"""Attributes that are tuples of elements."""

_LISTS: Final = ("roads", "connectingRoads", "intersections", "crossings", "sidewalks", "shoulders")
"""Attributes of a network that are tuples of elements."""


def stored(network: RoadNetwork) -> Arrays:
    """Return the arrays from which `restored` makes an equal network."""
    elements = list(network.elements.values())
    number: dict[int | None, int] = {id(element): index for index, element in enumerate(elements)}
    number[id(None)] = -1
    maneuvers = _distinct(
        maneuver
        for element in elements
        if isinstance(element, Lane | Intersection)
        for maneuver in element.maneuvers
    )
    signals = list(network.signals)
    way = {id(item): index for index, item in enumerate(maneuvers)}
    sign = {id(item): index for index, item in enumerate(signals)}
    rows = [_row(element, number, way, sign) for element in elements]
    text = {
        "driveOnLeft": network.driveOnLeft,
        "problems": [
            (item.code, item.message, item.span.line if item.span is not None else 0)
            for item in network.problems
        ],
        "elements": rows,
        "maneuvers": [_maneuver_row(item, number) for item in maneuvers],
        "signals": [_signal_row(item) for item in signals],
        "offset": network.offset,
        "lists": [[number[id(item)] for item in getattr(network, name)] for name in _LISTS],
        "heights": [_height_row(road) for road in network._elevation.roads],
    }
    samples = [road.samples for road in network._elevation.roads]
    lines = [line for element in elements for line in _lines(element)]
    return {
        "text": np.frombuffer(json.dumps(text, separators=(",", ":")).encode(), dtype=np.uint8),
        "vertices": np.concatenate([*lines, np.empty((0, 2))]),
        "vertex_counts": np.array([len(line) for line in lines], dtype=np.int64),
        "samples": np.concatenate([*samples, np.empty((0, 4))]),
        "sample_counts": np.array([len(rows) for rows in samples], dtype=np.int64),
        **_binary("areas", [element.polygon for element in elements]),
        **_binary("fillings", network._fillings),
    }


def _row(
    element: Any, number: Mapping[int | None, int], way: Mapping[int, int], sign: Mapping[int, int]
) -> list[object]:
    """An element, others by their numbers; `_element` and `_link` read it."""
    cls = type(element)
    row = [
        _CLASSES.index(cls),
        element.uid,
        element.id,
        element.name,
        element.speedLimit,
        sorted(kind.name for kind in element.vehicleTypes),
        sorted(element.tags),
        [getattr(element, name) for name in _PLAIN.get(cls, ())],
        [number[id(getattr(element, name, None))] for name in _ONE[cls]],
        [[number[id(item)] for item in getattr(element, name)] for name in _MANY[cls]],
        [way[id(item)] for item in getattr(element, "maneuvers", ())],
        [sign[id(item)] for item in getattr(element, "signals", ())],
        element.speedLimitRanges,
    ]
    if isinstance(element, RoadSection):
        row.append([number[id(item)] for item in element.lanesByOpenDriveID.values()])
    return row


def _maneuver_row(item: Maneuver, number: Mapping[int | None, int]) -> tuple[object, ...]:
    ends = (item.startLane, item.endLane, item.connectingLane, item.intersection)
    return (*(number[id(end)] for end in ends), item.type.name)


def _signal_row(item: Signal) -> tuple[object, ...]:
    places = [
        (at.road, at.s, at.orientation, at.validity, at.is_reference, at.holds) for at in item.placements
    ]
    return (
        *(item.uid, item.openDriveID, item.country, item.type, item.subtype, item.t, item.height),
        *(item.value, item.references, item.dependencies, item._priorities, item._place),
        places,
    )


def _height_row(road: RoadHeight) -> tuple[object, ...]:
    return (
        road.uid,
        *([_numbers(cubic) for cubic in cubics] for cubics in (road.profile, road.tilt, *road.falls)),
        [(shape.s, [_numbers(cubic) for cubic in shape.heights]) for shape in road.shapes],
    )


def restored(arrays: Arrays, filename: str, tolerance: float, cls: type[_Network]) -> _Network:
    """Return the network of arrays that `stored` made.

    Raises ``LookupError``, ``TypeError`` or ``ValueError`` where the arrays are not of this form.
    """
    text: Mapping[str, Any] = json.loads(arrays["text"].tobytes())
    network = cls(tolerance=tolerance, driveOnLeft=text["driveOnLeft"])
    rows, polygons = text["elements"], _polygons(arrays, "areas")
    vertices = arrays["vertices"]
    ends = np.cumsum(arrays["vertex_counts"]).tolist()
    bounds = iter(zip([0, *ends], ends, strict=False))

    def next_line() -> NDArray[np.float64]:
        start, stop = next(bounds)
        line: NDArray[np.float64] = vertices[start:stop]
        return line

    elements: list[Any] = [_element(network, row, area) for row, area in zip(rows, polygons, strict=True)]
    network.elements = {element.uid: element for element in elements}
    ways = [
        Maneuver(
            elements[start], elements[end], _at(elements, lane), _at(elements, inter), ManeuverType[kind]
        )
        for start, end, lane, inter, kind in text["maneuvers"]
    ]
    signs = [_signal(network, *fields) for fields in text["signals"]]
    network.signals = tuple(signs)
    network.offset = tuple(text["offset"])
    for element, row in zip(elements, rows, strict=True):
        _link(element, row, elements, ways, signs, next_line)
    for name, items in zip(_LISTS, text["lists"], strict=True):
        setattr(network, name, tuple(elements[item] for item in items))
    network.problems = tuple(
        Diagnostic(code, message, Span(line, 0, line, 1) if line > 0 else None, Severity.WARNING, filename)
        for code, message, line in text["problems"]
    )
    network._fillings = tuple(_polygons(arrays, "fillings"))
    network._elevation = _elevation(arrays, text["heights"])
    return network


def _elevation(arrays: Arrays, rows: Sequence[Any]) -> Elevation:
    starts = [0, *np.cumsum(arrays["sample_counts"]).tolist()]
    return Elevation(
        [
            RoadHeight(
                uid,
                arrays["samples"][start:stop],
                _cubics(profile),
                _cubics(tilt),
                (_cubics(left), _cubics(right)),
                tuple(LateralShape(s, _cubics(heights)) for s, heights in shapes),
            )
            for (uid, profile, tilt, left, right, shapes), start, stop in zip(
                rows, starts[:-1], starts[1:], strict=True
            )
        ]
    )


def _element(network: RoadNetwork, row: Sequence[Any], polygon: object) -> NetworkElement:
    kind, uid, key, name, speed, vehicles, tags = row[:7]
    return _CLASSES[kind](
        network,
        uid,
        polygon,
        id=key,
        name=name,
        speed=speed,
        vehicles=frozenset(VehicleType[item] for item in vehicles),
        tags=frozenset(tags),
    )


def _signal(network: RoadNetwork, *fields: Any) -> Signal:
    (
        uid,
        key,
        country,
        kind,
        subtype,
        t,
        height,
        value,
        references,
        dependencies,
        priorities,
        place,
        places,
    ) = fields
    signal = Signal(
        uid,
        key,
        country,
        kind,
        subtype=subtype,
        t=t,
        height=height,
        value=value,
        references=tuple(references),
        dependencies=tuple(dependencies),
        priorities=tuple(priorities),
        place=tuple(place),
        placements=tuple(
            Placement(road, s, orientation, tuple(map(tuple, validity)), is_reference, holds)
            for road, s, orientation, validity, is_reference, holds in places
        ),
    )
    signal.network = network
    return signal


def _link(
    element: Any,
    row: Sequence[Any],
    elements: Sequence[Any],
    maneuvers: Sequence[Maneuver],
    signals: Sequence[Signal],
    next_line: Callable[[], NDArray[np.float64]],
) -> None:
    """Give an element its attributes that name others, and its lines."""
    cls: Any = type(element)
    plain, one, many, ways, signs, ranges = row[7:13]
    element.speedLimitRanges = tuple(map(tuple, ranges))
    for name, value in zip(_PLAIN.get(cls, ()), plain, strict=True):
        setattr(element, name, value)
    for name, item in zip(_ONE[cls], one, strict=True):
        setattr(element, name, _at(elements, item))
    for name, items in zip(_MANY[cls], many, strict=True):
        setattr(element, name, tuple(elements[item] for item in items))
    if ways:
        element.maneuvers = tuple(maneuvers[item] for item in ways)
    if signs:
        element.signals = tuple(signals[item] for item in signs)
    if isinstance(element, LinearElement):
        element.place(next_line(), next_line(), next_line())
    if isinstance(element, LaneGroup):
        element._curb = next_line()
    if isinstance(element, RoadSection):
        element.lanesByOpenDriveID = {elements[item].openDriveID: elements[item] for item in row[13]}


def _lines(element: NetworkElement) -> Iterable[NDArray[np.float64]]:
    """The lines of an element, in the order in which `_link` takes them."""
    if isinstance(element, LinearElement):
        yield from (element.line, element.left, element.right)
    if isinstance(element, LaneGroup):
        yield element._curb


def _at(elements: Sequence[object], index: int) -> Any:
    return None if index < 0 else elements[index]


def _distinct(items: Iterable[object]) -> list[Any]:
    """Return the items, each but once, by identity."""
    return list({id(item): item for item in items}.values())


def _numbers(cubic: Cubic) -> tuple[float, ...]:
    return cubic.start, cubic.a, cubic.b, cubic.c, cubic.d


def _cubics(rows: Iterable[Sequence[float]]) -> tuple[Cubic, ...]:
    return tuple(Cubic(*row) for row in rows)


def _binary(name: str, geometries: Sequence[object]) -> Arrays:
    """Encode geometries as two arrays: their well-known binary end to end, and the lengths of the parts."""
    import shapely

    parts = [shapely.to_wkb(geometry) for geometry in geometries]
    return {
        name: np.frombuffer(b"".join(parts), dtype=np.uint8),
        f"{name}_sizes": np.array([len(part) for part in parts], dtype=np.int64),
    }


def _polygons(arrays: Arrays, name: str) -> list[Any]:
    import shapely

    content = arrays[name].tobytes()
    ends = np.cumsum(arrays[f"{name}_sizes"]).tolist()
    parts = [content[start:stop] for start, stop in zip([0, *ends], ends, strict=False)]
    try:
        return list(shapely.from_wkb(np.array(parts, dtype=object)))
    except shapely.errors.GEOSException as error:
        raise ValueError(str(error)) from None
