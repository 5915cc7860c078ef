"""U-turns in the free width of a road: as one arc, or forward and backward where there is less room."""

import math
from typing import Any, Final

import numpy as np

from scenic.domains.driving.actions import RegulatedControlAction, SetReverseAction
from scenic.domains.driving.elements import Lane
from scenic.domains.driving.following import stopping_acceleration
from scenic.domains.driving.lane_driving import lane_under
from scenic.domains.driving.running_traffic import running_traffic
from scenic.language.errors import InvalidScenarioError, SimulationError

__all__ = ["FASTEST", "UTurner"]

_SPEED: Final = 2.5
"""Speed (m/s) of the turn."""
FASTEST: Final = 3.0
"""Speed (m/s) from which on a car slows down along its lane before it turns."""
_TURNING: Final = 0.5
"""Change of curvature (1/m in a second) by steering while the car moves."""
_BRAKING: Final = 1.5
"""Deceleration (m/s^2) by which the car begins to brake before the edge of the road."""
_SPEEDING_UP: Final = 1.5
"""Acceleration (m/s^2)."""
_SETTLING: Final = 0.4
"""Seconds in which it comes to the speed of the turn, about."""
_JERK: Final = 5.0
"""Change of the acceleration (m/s^3)."""
_LOOK: Final = 8.0
"""Metres ahead that are looked at for the edge of the road."""
_GRAIN: Final = 0.04
_CLOSE: Final = 0.06
"""Metres before the edge at which the car stops."""
_STEERING: Final = 0.95
"""Share of the lock of the steering wheel that is used."""
_HANDED_OVER: Final = math.radians(35)
"""Angle from the direction of the other lanes at which a car goes on along them."""
_MOST: Final = 12
"""Changes of direction after which a turn is given up."""


class UTurner:
    """Turns a car round, step by step.

    Args:
        agent: the car.

    Raises:
        InvalidScenarioError: the road has no lanes of the other direction beside it.

    """

    def __init__(self, agent: Any) -> None:
        import shapely

        self._agent = agent
        self._simulation = running_traffic()
        network = agent.roadNetwork
        lane = lane_under(agent)
        opposite = lane.group._opposite
        if opposite is None:
            raise InvalidScenarioError(
                f"{lane.uid} has no lanes of the other direction beside it to turn into",
                help="turn round on a road with lanes of both directions",
            )
        self._lanes: tuple[Lane, ...] = opposite.lanes
        self._room = shapely.buffer(shapely.union_all([network.drivableRegion.polygons]), 0.02)
        shapely.prepare(self._room)
        along = float(lane.along(np.array([agent.position[:2]]))[0])
        self._goal = along + math.pi
        self._side = -1.0 if network.driveOnLeft else 1.0
        self._gear = 1.0
        self._curvature: float | None = None
        self._changes = 0
        self._acceleration = 0.0
        self._stop: float | None = None
        """Metres to the place at which the car is to stop, if it is."""

    def lane(self) -> Lane:
        """Return the lane of the other direction that is nearest to the car."""
        import shapely

        spot = shapely.Point(self._agent.position[0], self._agent.position[1])
        nearest: Lane = min(self._lanes, key=lambda lane: shapely.LineString(lane.line).distance(spot))
        return nearest

    @property
    def _left(self) -> float:
        """The angle by which the car has still to turn, positive anticlockwise, -pi to pi."""
        return float((self._goal - self._agent.heading + math.pi) % (2 * math.pi) - math.pi)

    def is_done(self) -> bool:
        """Return whether the car faces along the other lanes, and drives forward."""
        return self._gear > 0 and abs(self._left) < _HANDED_OVER

    def actions(self) -> tuple[RegulatedControlAction, SetReverseAction]:
        """The actions of one step.

        Raises:
            SimulationError: there is not enough room to turn.

        """
        agent, simulation = self._agent, self._simulation
        speed = float(agent.speed)
        if self._stop is not None and speed < 0.02:
            self._gear = -self._gear
            self._stop, self._acceleration = None, 0.0
            self._changes += 1
            if self._changes > _MOST:
                raise SimulationError(
                    f"there is no room for a U-turn at ({agent.position[0]:.1f}, {agent.position[1]:.1f})",
                    help="turn round where the road is wider",
                )
        if abs(self._left) < math.pi / 2:
            self._side = math.copysign(1.0, self._left)
        lock = abs(simulation.curvature_of(agent, 1.0)) * _STEERING
        curvature = self._steered(self._side * self._gear * lock, speed)
        acceleration = self._sped(speed, self._free_distance(lock) - _CLOSE)
        pedal = simulation.pedal_for(agent, acceleration)
        steering = simulation.steering_for(agent, curvature)
        return (
            RegulatedControlAction(pedal, steering, steering, 1.0, 1.0, 1.0),
            SetReverseAction(self._gear < 0),
        )

    def _sped(self, speed: float, free: float) -> float:
        """The acceleration (m/s^2) of this step, with metres of room ahead: evenly up to the speed of the turn, and evenly to a stop."""
        timestep = self._simulation.timestep
        # What is decided now acts for a step, and braking begins evenly.
        free -= speed * timestep
        rising = max(0.0, self._acceleration + _BRAKING) / _JERK
        way = rising * (speed + rising * (self._acceleration / 2 - _JERK * rising / 6))
        after = max(0.0, speed + rising * (self._acceleration - _JERK * rising / 2))
        braking_way = way + 2 * after * after / (3 * _BRAKING)
        if self._stop is not None:
            self._stop = min(self._stop - speed * timestep, free)
        elif free <= braking_way:
            self._stop = free
        elif self._gear < 0 and abs(self._left) < 0.9 * _HANDED_OVER:
            # Where going forward ends the turn, the car reverses no farther.
            self._stop = braking_way
        if self._stop is not None:
            acceleration = stopping_acceleration(speed, self._stop, timestep)
        else:
            acceleration = min((_SPEED - speed) / _SETTLING, _SPEEDING_UP)
        change = _JERK * timestep
        self._acceleration = min(max(acceleration, self._acceleration - change), self._acceleration + change)
        return self._acceleration

    def _steered(self, wanted: float, speed: float) -> float:
        """The curvature (1/m) of this step, towards one that is wanted; a car that stands may turn its wheels at will."""
        before = 0.0 if self._curvature is None else self._curvature
        change = math.inf if speed < 0.1 else _TURNING * self._simulation.timestep
        self._curvature = min(max(wanted, before - change), before + change)
        return self._curvature

    def _free_distance(self, lock: float) -> float:
        """Return the metres that the car can drive with its wheels at the lock before a corner leaves the road; at most `_LOOK`."""
        x, y, *_ = self._agent.position
        heading = self._agent.heading
        back = self._simulation.pivot_of(self._agent)
        x, y = x + back * math.sin(heading), y - back * math.cos(heading)
        reach = np.arange(0.0, _LOOK, _GRAIN)
        turn_angles = self._side * lock * reach
        chord = self._gear * reach * np.sinc(turn_angles / (2 * np.pi))
        middle, after = heading + turn_angles / 2, heading + turn_angles
        xs = x - chord * np.sin(middle) - back * np.sin(after)
        ys = y + chord * np.cos(middle) + back * np.cos(after)
        outside = self._outside(xs, ys, after)
        # A car that begins across the edge may go on where that does not make it worse.
        collisions = np.flatnonzero((outside & ~outside[0]).any(axis=1))
        return float(reach[collisions[0]]) if len(collisions) else _LOOK

    def _outside(self, x: Any, y: Any, heading: Any) -> Any:
        """Return for each corner of the car if it is off the road, ``(n, 4)``, at poses ``(n,)``."""
        import shapely

        sine, cosine = np.sin(heading), np.cos(heading)
        a, b = self._agent.width / 2, self._agent.length / 2
        corners = [(u, v) for u in (-a, a) for v in (-b, b)]
        xs = np.stack([x + u * cosine - v * sine for u, v in corners], axis=1)
        ys = np.stack([y + u * sine + v * cosine for u, v in corners], axis=1)
        return ~shapely.contains_xy(self._room, xs, ys)
