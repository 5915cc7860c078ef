"""Bodies in a running SUMO: put to places, or driven by SUMO along routes."""

import math
import random
from collections.abc import Mapping
from dataclasses import field
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.language.errors import SimulationCreationError, SimulationError

__all__ = ["Pose", "SumoBody", "SumoTraffic"]

_AHEAD: Final = 5
"""Edges that a route has before a vehicle at least: drivers brake for what they see of it."""
_FREELY: Final = 2
"""SUMO's mode of placing bodies anywhere, off the roads too."""
_ON_LANE: Final = 0
"""SUMO's mode of placing bodies on the nearest lane, with a route through it."""


@dataclass(frozen=True, slots=True)
class Pose:
    """The pose of a body in SUMO: its centre (metres), heading (radians, anticlockwise from north) and speed (m/s)."""

    x: float
    y: float
    z: float
    heading: float
    speed: float


@dataclass(slots=True)
class SumoBody:
    """A body by its name in SUMO; ``length`` is in metres.

    Attributes:
        entered: it has been put on a lane, where SUMO needs it first, so that it may go anywhere.
        edges: of its route, while SUMO drives it.
        speed_factor: of the speed limit, while SUMO drives it.
        own_speed: with which SUMO is to begin to drive it, in m/s, until it has been told.

    """

    name: str
    length: float
    entered: bool = False
    edges: int = 0
    speed_factor: float | None = None
    own_speed: float | None = None
    last: Mapping[int, Any] = field(default_factory=dict)


class SumoTraffic:
    """The bodies in a running SUMO.

    SUMO's position of a body is the middle of its front, and its angles are in degrees clockwise from north.

    Args:
        sumo: the module ``libsumo``, with a network loaded.

    """

    def __init__(self, sumo: Any) -> None:
        self._sumo = sumo
        names = sumo.constants
        self._position, self._angle = names.VAR_POSITION3D, names.VAR_ANGLE
        self._speed, self._route_index = names.VAR_SPEED, names.VAR_ROUTE_INDEX
        self._next: dict[str, tuple[str, ...]] = {}

    def add(self, name: str, size: tuple[float, float, float], max_speed: float) -> SumoBody:
        """Add a body that SUMO's drivers see.

        Args:
            name: a new one.
            size: width, length and height in metres.
            max_speed: in m/s.

        """
        sumo = self._sumo
        width, length, height = size
        kinds = sumo.vehicletype
        kinds.copy("DEFAULT_VEHTYPE", name)
        kinds.setWidth(name, width)
        kinds.setLength(name, length)
        kinds.setHeight(name, height)
        kinds.setMaxSpeed(name, max_speed)
        sumo.vehicle.add(name, "", typeID=name)
        sumo.vehicle.subscribe(name, [self._position, self._angle, self._speed, self._route_index])
        return SumoBody(name, length)

    def put(self, body: SumoBody, x: float, y: float, heading: float) -> None:
        """Put a body's centre to a place, with a heading in radians; it is there after the next step."""
        if not body.entered:
            # A body that has never been on a lane must not be put elsewhere: libsumo would crash.
            edge, along, lane = self._nearest(x, y)
            x, y = self._sumo.simulation.convert2D(edge, along, lane)
            body.entered = True
            self._move(body, x, y, 0.0, _FREELY)
        else:
            front = body.length / 2
            self._move(body, x - front * math.sin(heading), y + front * math.cos(heading), heading, _FREELY)
        body.edges, body.speed_factor = 0, None

    def release(
        self, body: SumoBody, x: float, y: float, heading: float, speed: float, speed_factor: float
    ) -> None:
        """Put a body onto the nearest lane in its direction, and let SUMO drive it from there on, at its present speed (m/s).

        Raises:
            SimulationError: there is no lane near.

        """
        if body.speed_factor is None:
            front = body.length / 2
            place = x - front * math.sin(heading), y + front * math.cos(heading)
            try:
                self._move(body, *place, heading, _ON_LANE)
            except self._sumo.TraCIException as error:
                raise SimulationError(
                    f"SUMO has no lane for a vehicle at ({x:.2f}, {y:.2f}) to drive on",
                    help="leave vehicles to SUMO where they are on a lane for cars",
                ) from error
            body.own_speed = max(0.0, speed)
        if body.speed_factor != speed_factor:
            self._sumo.vehicle.setSpeedFactor(body.name, speed_factor)
            body.speed_factor = speed_factor

    def step(self, bodies: list[SumoBody]) -> None:
        """Advance SUMO by a step, and make the routes of those that it drives long enough."""
        self._sumo.simulationStep()
        results = self._sumo.vehicle.getAllSubscriptionResults()
        for body in bodies:
            body.last = results.get(body.name, {})
            if body.own_speed is not None and body.last:
                # SUMO takes the speed of a body that was put somewhere for that of the move.
                self._sumo.vehicle.setPreviousSpeed(body.name, body.own_speed)
                body.last = {**body.last, self._speed: body.own_speed}
                body.own_speed = None
            if body.speed_factor is not None and body.last:
                self._go_on(body, body.last[self._route_index])

    def pose(self, body: SumoBody) -> Pose | None:
        """Return the pose of a body in SUMO; ``None`` for a body that has left the map at a dead end."""
        last = body.last
        if not last:
            return None
        x, y, z = last[self._position]
        heading = -math.radians(last[self._angle])
        back = body.length / 2
        heading = math.pi - (math.pi - heading) % (2 * math.pi)
        return Pose(x + back * math.sin(heading), y - back * math.cos(heading), z, heading, last[self._speed])

    def _move(self, body: SumoBody, x: float, y: float, heading: float, mode: int) -> None:
        angle = -math.degrees(heading) % 360
        self._sumo.vehicle.moveToXY(body.name, "", -1, x, y, angle, keepRoute=mode)

    def _nearest(self, x: float, y: float) -> tuple[str, float, int]:
        try:
            edge, along, lane = self._sumo.simulation.convertRoad(x, y, False, "passenger")
        except self._sumo.TraCIException as error:
            raise SimulationCreationError("SUMO finds no road for cars in this map") from error
        return edge, along, lane

    # Routes

    def _go_on(self, body: SumoBody, index: int) -> None:
        """Make the route longer when its last edge comes near."""
        if index < body.edges - _AHEAD:
            return
        vehicle = self._sumo.vehicle
        route = vehicle.getRoute(body.name)[max(index, 0) :]
        vehicle.setRoute(
            body.name, self._longer(route, vehicle.getRoadID(body.name), vehicle.getLaneIndex(body.name))
        )
        # SUMO keeps the edges before.
        body.edges = len(vehicle.getRoute(body.name))

    def _longer(self, route: tuple[str, ...], road: str, lane: int) -> tuple[str, ...]:
        """Return a route with random edges behind: those next to the road can be reached from the lane that is given."""
        edges = list(route)
        for _ in range(2 * _AHEAD):
            onward = self._successors(edges[-1])
            if edges[-1] == road:
                onward = self._from_lane(road, lane) or onward
            if not onward:
                break
            edges.append(random.choice(onward))
        return tuple(edges)

    def _successors(self, edge: str) -> tuple[str, ...]:
        known = self._next.get(edge)
        if known is None:
            lanes = range(self._sumo.edge.getLaneNumber(edge))
            known = tuple(sorted({onto for lane in lanes for onto in self._from_lane(edge, lane)}))
            self._next[edge] = known
        return known

    def _from_lane(self, edge: str, lane: int) -> tuple[str, ...]:
        of_lanes = self._sumo.lane
        onto = {link[0] for link in of_lanes.getLinks(f"{edge}_{lane}")}
        for_cars = [other for other in onto if "passenger" not in of_lanes.getDisallowed(other)]
        return tuple(sorted({of_lanes.getEdgeID(other) for other in for_cars}))
