"""Traffic signs and lights: what they are, and for which lanes they hold (section 12 of the driving specification)."""

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.formats.opendrive import records
from scenic.formats.opendrive.curves import Curve
from scenic.runtime.values.frozen import Frozen
from scenic.runtime.values.values import Vector

if TYPE_CHECKING:
    from scenic.domains.driving.elements import Lane, Maneuver

__all__ = ["Placement", "Signal", "halt_point_ahead", "placement_of", "signal_of"]

_LIGHTS: Final = ("1000001", "1000011")
_STOP: Final = ("206",)
_YIELD: Final = ("205",)
_STOP_LINES: Final = ("294", "295")
_SPEEDS: Final = ("274",)
_CODES: Final = (
    (_LIGHTS, "trafficLight"),
    (_STOP, "stop"),
    (_YIELD, "yield"),
)
"""Types of signals of the German catalogue, which other countries' exporters write too, and their priorities."""


@dataclass(frozen=True, slots=True)
class Placement:
    """A place at which a signal holds: that of the signal, or of a reference to it.

    Attributes:
        road: the ``uid`` of the road.
        s: metres along the road.
        orientation: ``+`` for traffic along the road, ``-`` against it, ``none`` for both.
        validity: first and last ids of lanes; none for all lanes of the direction.
        is_reference: it is that of a reference.
        holds: it holds for lanes there; a signal that is valid for no lane of its own road holds where references name it.

    """

    road: str
    s: float
    orientation: str
    validity: tuple[tuple[int, int], ...]
    is_reference: bool = False
    holds: bool = True


def placement_of(reference: records.SignalReference, road: str) -> Placement:
    """Return the placement of a reference on a road."""
    return Placement(road, reference.s, reference.orientation, reference.validity, is_reference=True)


def signal_of(record: records.Signal, road: records.Road) -> "Signal":
    """The signal of a record on a road."""
    curve = Curve(road.geometry)
    points, headings = curve.at(np.array([min(max(record.s, 0.0), curve.length)]))
    (x, y), heading = points[0].tolist(), float(headings[0])
    return Signal(
        f"signal{record.id}",
        record.id,
        record.country,
        record.type,
        subtype=record.subtype,
        t=record.t,
        height=record.height,
        value=record.value,
        references=record.references,
        dependencies=record.dependencies,
        priorities=record.priorities,
        place=(x - record.t * math.sin(heading), y + record.t * math.cos(heading)),
        placements=(Placement(f"road{road.id}", record.s, record.orientation, record.validity),),
    )


class Signal(Frozen):
    """A traffic sign or light.

    Attributes:
        uid: unique text in its network.
        openDriveID: the id in the file.
        country: as in the file.
        type: the code in the file.
        subtype: the code in the file.
        t: metres from the reference line of its road, positive to the left.
        height: metres above the road.
        value: the number on it, if any.
        references: ids of signals and objects that belong to it.
        dependencies: ids of signals that it controls.
        placements: where it holds: first its own place, then those of references.

    """

    def __init__(
        self,
        uid: str,
        openDriveID: str,
        country: str,
        type: str,
        *,
        subtype: str = "",
        t: float = 0.0,
        height: float = 0.0,
        value: float | None = None,
        references: tuple[str, ...] = (),
        dependencies: tuple[str, ...] = (),
        priorities: tuple[str, ...] = (),
        place: tuple[float, float] = (0.0, 0.0),
        placements: tuple[Placement, ...] = (),
    ) -> None:
        self.uid = uid
        self.openDriveID = openDriveID
        self.country = country
        self.type = type
        self.subtype = subtype
        self.t = t
        self.height = height
        self.value = value
        self.references = references
        self.dependencies = dependencies
        self._priorities = priorities
        self._place = place
        self.placements = placements
        self.network: Any = None

    @property
    def s(self) -> float:
        """Metres along its road."""
        return self.placements[0].s if self.placements else 0.0

    @cached_property
    def position(self) -> Vector:
        """The place at which it stands: its middle, above the ground by its height."""
        x, y = self._place
        place: Vector = Vector(x, y, float(self.height))
        return place

    @property
    def orientation(self) -> str:
        """The direction of traffic for which it holds: ``+`` along its road, ``-`` against it, ``none`` for both."""
        return self.placements[0].orientation if self.placements else "none"

    @property
    def validity(self) -> tuple[tuple[int, int], ...]:
        """First and last ids of the lanes for which it holds; none for all lanes of its direction."""
        return self.placements[0].validity if self.placements else ()

    @property
    def priorities(self) -> tuple[str, ...]:
        """The types of its priority in the file's semantics; else the one of its known code."""
        if self._priorities:
            return self._priorities
        return tuple(name for codes, name in _CODES if self.type in codes)

    @property
    def isTrafficLight(self) -> bool:
        """Return whether it is a traffic light."""
        return self.type in _LIGHTS or "trafficLight" in self._priorities

    @property
    def isStopSign(self) -> bool:
        """Return whether it is a stop sign."""
        return "stop" in self.priorities

    @property
    def isYieldSign(self) -> bool:
        """Return whether it is a sign to give way."""
        return "yield" in self.priorities

    @property
    def isStopLine(self) -> bool:
        """Return whether it is a line at which to stop."""
        return self.type in _STOP_LINES or "stopLine" in self._priorities

    @property
    def isSpeedLimit(self) -> bool:
        """Return whether it is a sign with a speed limit."""
        return self.type in _SPEEDS

    def affects(self, lane: "Lane") -> bool:
        """Return whether it holds for traffic on a lane: on its own road, or on one from which a reference names it."""
        return self._placement_on(lane) is not None

    def _placement_on(self, lane: "Lane") -> Placement | None:
        for place in self.placements:
            if place.road != lane.road.uid or not place.holds:
                continue
            section = lane.sections[0] if lane.sections else None
            if section is None:
                continue
            # Lanes that are named count; exporters disagree about the orientation beside them.
            has_direction = place.orientation in ("+", "-") and not place.validity
            if has_direction and (place.orientation == "+") != section.isForward:
                continue
            ids = {part.openDriveID for part in lane.sections}
            if place.validity and not any(low <= key <= high for low, high in place.validity for key in ids):
                continue
            return place
        return None

    def stoppingPointOn(self, lane: "Lane") -> Any:
        """The point of a lane's centerline beside the signal, as a vector; ``None`` if it does not hold for the lane.

        For a lane that leads into an intersection whose connecting lane the signal holds for, that is the end of the lane.
        """
        along = self.stop_along(lane)
        if along is None:
            return None
        return lane.centerline.pointAlongBy(min(along, float(lane.centerline.length)))

    def stop_along(self, lane: "Lane") -> float | None:
        """Return the metres along a lane at which to stop for the signal; ``None`` if the signal does not apply to the lane."""
        place = self._placement_on(lane)
        if place is None:
            if any(self in maneuver.signals for maneuver in lane.maneuvers):
                return _length(lane.line)
            return None
        import shapely

        road = lane.road
        point = shapely.LineString(road.line).interpolate(place.s)
        along = float(shapely.LineString(lane.line).project(point))
        # In an intersection, one stops before it.
        return 0.0 if lane.is_connecting else along

    @property
    def controlledManeuvers(self) -> tuple["Maneuver", ...]:
        """The maneuvers for which it holds."""
        found: tuple[Maneuver, ...] = self.network.maneuvers_of(self)
        return found

    def __repr__(self) -> str:
        return f"<Signal {self.uid} type={self.type}>"


def _length(line: Any) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def halt_point_ahead(lane: "Lane", position: Any, lookahead: float) -> tuple["Signal", float] | None:
    """Return the first signal ahead on a lane at which traffic may have to halt, and metres along the lane to its stopping point."""
    import shapely

    x, y, *_ = position
    here = float(shapely.LineString(lane.line).project(shapely.Point(x, y)))
    best: tuple[Signal, float] | None = None
    for signal in lane.halting_signals:
        along = signal.stop_along(lane)
        if along is None or not here <= along <= here + lookahead:
            continue
        if best is None or along < best[1]:
            best = signal, along
    return best
