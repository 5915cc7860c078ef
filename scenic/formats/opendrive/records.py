"""OpenDRIVE maps as typed records, in the units of the file (metres, radians); lines are those of the XML elements."""

from dataclasses import field
from typing import Literal

from scenic.dataclass import dataclass

__all__ = [
    "Connection",
    "Crosswalk",
    "Cubic",
    "Geometry",
    "Junction",
    "Lane",
    "LaneLinks",
    "LaneSection",
    "Link",
    "MapProblem",
    "MapRecords",
    "Road",
    "Signal",
    "SignalReference",
]

Shape = Literal["line", "arc", "spiral", "poly3", "paramPoly3"]


@dataclass(frozen=True, slots=True)
class MapProblem:
    """Something that is wrong with a map, and what was done instead.

    Attributes:
        code: the diagnostic's code.
        message: what is wrong.
        line: the line of the XML element, from 1; 0 where no element is to blame.
        kind: a word for counting problems that are alike.

    """

    code: str
    message: str
    line: int
    kind: str


@dataclass(frozen=True, slots=True)
class Cubic:
    """The polynomial ``a + b ds + c ds^2 + d ds^3`` from ``start`` on, with ``ds`` counted from there."""

    start: float
    a: float
    b: float
    c: float
    d: float


@dataclass(frozen=True, slots=True)
class LateralShape:
    """The heights of a road's surface across it, over the plane that superelevation tilts.

    Attributes:
        s: where along the road.
        heights: cubics of the distance to the left of the reference line, in order.

    """

    s: float
    heights: tuple[Cubic, ...]


@dataclass(frozen=True, slots=True)
class Geometry:
    """A piece of a reference line.

    Attributes:
        s: where it begins along the road.
        x: east of its first point.
        y: north of its first point.
        heading: of its first point, anticlockwise from east.
        length: along the curve.
        shape: the kind of curve.
        numbers: curvature of an arc; first and last curvature of a spiral; ``a b c d`` of a ``poly3``; ``aU .. dU aV .. dV`` of a
            ``paramPoly3``.
        normalized: whether the parameter of a ``paramPoly3`` goes from 0 to 1, not to the length.
        line: of the XML element.

    """

    s: float
    x: float
    y: float
    heading: float
    length: float
    shape: Shape
    numbers: tuple[float, ...]
    normalized: bool
    line: int
    corrected: bool = False
    """True if the length is not that of the file, which contradicts where the next piece begins."""


@dataclass(frozen=True, slots=True)
class Speed:
    """A speed limit from a place on: ``start`` in metres from the beginning of the road, or of the lane section."""

    start: float
    limit: float | None
    """In m/s; ``None`` where there is none."""


@dataclass(frozen=True, slots=True)
class Lane:
    """A lane of a lane section; ``id`` is positive on the left of the reference line, negative on the right."""

    id: int
    type: str
    predecessor: int | None
    successor: int | None
    widths: tuple[Cubic, ...]
    borders: tuple[Cubic, ...]
    speeds: tuple[Speed, ...]
    """Speed limits of its own."""
    access: frozenset[str]
    """Kinds of road users that the file allows or denies, as ``allow bicycle``."""
    line: int
    lost: frozenset[str] = frozenset()
    """The ones of ``predecessor`` and ``successor`` that the file has, but not so that they can be used."""


@dataclass(frozen=True, slots=True)
class LaneSection:
    """A part of a road with constant lanes; ``lanes`` run from the leftmost to the rightmost, without the middle one."""

    s: float
    lanes: tuple[Lane, ...]
    line: int
    is_whole: bool = True
    """True if no lane of the file was omitted for a fault, which has been reported."""


@dataclass(frozen=True, slots=True)
class Link:
    """The road or junction at an end of a road."""

    element: Literal["road", "junction"]
    id: str
    contact: Literal["start", "end"] | None
    line: int


@dataclass(frozen=True, slots=True)
class Signal:
    """A traffic sign or light."""

    id: str
    country: str
    type: str
    subtype: str
    orientation: str
    s: float
    t: float
    height: float
    """Metres above the road."""
    value: float | None
    validity: tuple[tuple[int, int], ...]
    """First and last ids of the lanes for which it is valid; none for all lanes of its direction."""
    priorities: tuple[str, ...]
    """Types of priority, of its semantics."""
    references: tuple[str, ...]
    """Ids of signals and objects that belong to it."""
    dependencies: tuple[str, ...]
    """Ids of signals that it controls."""
    is_valid: bool
    """Valid for some lane of its own road, not only through references of others."""
    line: int


@dataclass(frozen=True, slots=True)
class SignalReference:
    """A signal of another road that is valid on this one."""

    id: str
    orientation: str
    s: float
    validity: tuple[tuple[int, int], ...]
    line: int


@dataclass(frozen=True, slots=True)
class Crosswalk:
    """A crosswalk: corners ``(s, t)`` where ``along_road``, else ``(u, v)`` about its place."""

    id: str
    s: float
    t: float
    heading: float
    corners: tuple[tuple[float, float], ...]
    along_road: bool
    line: int


@dataclass(frozen=True, slots=True)
class Road:
    """A road of the file."""

    id: str
    name: str
    length: float
    junction: str | None
    left_hand: bool
    type: str
    speeds: tuple[Speed, ...]
    predecessor: Link | None
    successor: Link | None
    geometry: tuple[Geometry, ...]
    elevation: tuple[Cubic, ...]
    superelevation: tuple[Cubic, ...]
    crossfall: tuple[tuple[Cubic, ...], tuple[Cubic, ...]]
    """Of the left and of the right side."""
    shapes: tuple[LateralShape, ...]
    lane_offset: tuple[Cubic, ...]
    sections: tuple[LaneSection, ...]
    signals: tuple[Signal | SignalReference, ...]
    crosswalks: tuple[Crosswalk, ...]
    line: int
    lost: frozenset[str] = frozenset()
    """As for lanes."""


@dataclass(frozen=True, slots=True)
class LaneLinks:
    """A connection's link from a lane of the incoming road to a lane of the connecting road."""

    source: int
    target: int
    line: int = field(default=0, compare=False)


@dataclass(frozen=True, slots=True)
class Connection:
    """A way through a junction."""

    id: str
    incoming: str
    connecting: str
    contact: Literal["start", "end"]
    links: tuple[LaneLinks, ...] | None
    """``None`` where the file has none: lanes of the same ids are linked."""
    line: int


@dataclass(frozen=True, slots=True)
class Junction:
    """A junction; ``type`` is ``default`` unless the file gives another type."""

    id: str
    name: str
    type: str
    connections: tuple[Connection, ...]
    line: int
    groups: frozenset[str] = frozenset()
    """Types of the groups of junctions to which it belongs, as ``roundabout``."""


@dataclass(frozen=True, slots=True)
class MapRecords:
    """A whole file."""

    filename: str
    version: str
    vendor: str
    georeference: str
    offset: tuple[float, float, float, float]
    """Metres by which the coordinates of the file lie beside those of ``georeference``, and radians by which they are turned."""
    roads: tuple[Road, ...]
    junctions: tuple[Junction, ...]
    problems: tuple[MapProblem, ...] = field(default=())
    left_out: frozenset[str] = frozenset()
    """Roads and junctions that are not here because something is wrong with them, as ``road 5``."""
