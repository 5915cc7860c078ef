"""The content of a CommonRoad file as plain data, in metres, seconds, and radians from east."""

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass

__all__ = [
    "Incoming",
    "Junction",
    "Lanelet",
    "RoadRecords",
    "RoadSource",
    "StopLine",
    "TrafficLight",
    "TrafficSign",
]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class StopLine:
    """A line across a lanelet at which traffic halts.

    Attributes:
        start: its end on the left.
        end: its end on the right.
        signs: keys of traffic signs.
        lights: keys of traffic lights.

    """

    start: tuple[float, float]
    end: tuple[float, float]
    signs: tuple[str, ...]
    lights: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Lanelet:
    """A part of a lane between two lines; other lanelets, signs and lights are named by their keys.

    Attributes:
        key: a unique name.
        left: vertices of its left line, in the direction of traffic, ``(n, 2)``.
        right: those of its right line, as many.
        types: names of CommonRoad's types.
        one_way: road users who follow its direction.
        both_ways: road users who may follow both directions.
        successors: lanelets that follow.
        left_neighbour: the lanelet on the left, and whether its direction is equal.
        right_neighbour: the lanelet on the right, and whether its direction is equal.
        stop_line: where traffic halts.
        signs: traffic signs that hold.
        lights: traffic lights that hold.

    """

    key: str
    left: Floats
    right: Floats
    types: tuple[str, ...]
    one_way: tuple[str, ...]
    both_ways: tuple[str, ...] = ()
    successors: tuple[str, ...] = ()
    left_neighbour: tuple[str, bool] | None = None
    right_neighbour: tuple[str, bool] | None = None
    stop_line: StopLine | None = None
    signs: tuple[str, ...] = ()
    lights: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class TrafficSign:
    """A sign: its number in CommonRoad's catalogue, numbers on it, and its place."""

    key: str
    code: str
    values: tuple[str, ...]
    place: tuple[float, float]


@dataclass(frozen=True, slots=True)
class TrafficLight:
    """A traffic light.

    Attributes:
        key: a unique name.
        place: where it stands.
        direction: of the turns for which it holds, in CommonRoad's words.
        cycle: seconds and colours (``red``, ``yellow``, ``green`` or ``off``), repeated for ever.

    """

    key: str
    place: tuple[float, float]
    direction: str
    cycle: tuple[tuple[float, str], ...]


@dataclass(frozen=True, slots=True)
class Incoming:
    """The lanelets of a road that lead into a junction, and the lanelets that follow, by the turn."""

    lanelets: tuple[str, ...]
    right: tuple[str, ...]
    straight: tuple[str, ...]
    left: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Junction:
    """A junction: its incoming roads, and the lanelets of pedestrian crossings."""

    key: str
    incomings: tuple[Incoming, ...]
    crossings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class RoadRecords:
    """The road network of a file.

    Attributes:
        name: of the map.
        lanelets: all lanelets.
        signs: all traffic signs.
        lights: all traffic lights.
        junctions: all junctions.
        tags: CommonRoad's words for the kind of the network.
        offset: metres along x and y, and radians, by which coordinates are moved to those of the map's projection.

    """

    name: str
    lanelets: tuple[Lanelet, ...]
    signs: tuple[TrafficSign, ...]
    lights: tuple[TrafficLight, ...]
    junctions: tuple[Junction, ...]
    tags: tuple[str, ...]
    offset: tuple[float, float, float]


@runtime_checkable
class RoadSource(Protocol):
    """A workspace that knows its roads (`scenic.domains.driving.workspace.DrivingWorkspace`)."""

    def commonroad_records(self, params: Mapping[str, object]) -> RoadRecords:
        """Return the roads, with traffic lights by the parameters of a scene."""

    def lanelets_at(self, place: tuple[float, float]) -> tuple[str, ...]:
        """Return the keys of the lanelets for cars that contain a place."""

    def light_colors(self, simulation: object) -> Mapping[str, str]:
        """The colours of traffic lights at the present step of a simulation, by their keys."""
