"""Bases of simulators for the driving domain."""

import math
from collections.abc import Callable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any, ClassVar

from scenic.domains.driving.car_following import Traffic
from scenic.domains.driving.controllers import PIDLateralController, PIDLongitudinalController
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.right_of_way import RightOfWay
from scenic.domains.driving.signals import LightTimes, TrafficLights
from scenic.domains.driving.signs import Signal
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator

__all__ = ["DrivingSimulation", "DrivingSimulator"]

Controllers = tuple[PIDLongitudinalController, PIDLateralController]


class DrivingSimulation(Simulation):
    """A simulation of traffic.

    Behaviors plan paths and speeds, and turn them into steering and pedals by what the simulation says of its cars. A simulation
    that overrides one of the methods for controllers, such as `getLaneFollowingControllers`, drives its cars by these.

    Attributes:
        steering_lead: steps until steering that has been set begins to turn the way of a car.

    """

    steering_lead: float = 0.0
    _car_gains: ClassVar[dict[str, tuple[float, float, float]]] = {
        "keep": (0.2, 0.1, 0.0),
        "turn": (0.8, 0.2, 0.0),
        "change": (0.08, 0.3, 0.0),
    }

    @cached_property
    def traffic_lights(self) -> Any:
        """The traffic lights of the map, by the program's parameter ``traffic_lights``."""
        network = getattr(self.scene.workspace, "network", None)
        times = LightTimes.of(self.scene.params.get("traffic_lights") or {})
        lights = TrafficLights(RoadNetwork() if network is None else network, times)
        lights.time = self.currentTime * float(self.timestep)
        return lights

    @cached_property
    def right_of_way(self) -> RightOfWay:
        """The ways through intersections that cars have taken."""
        return RightOfWay()

    @property
    def traffic(self) -> Traffic:
        """The places of the objects at the present step."""
        known = self._present
        if known is None or known[0] != self.currentTime or len(known[1].items) != len(self.objects):
            known = self._present = self.currentTime, Traffic(tuple(self.objects))
        return known[1]

    _present: tuple[int, Traffic] | None = None

    @property
    def pedestrians(self) -> tuple[Any, ...]:
        """The objects that walk."""
        return self._of_kinds[1]

    @property
    def vehicles(self) -> tuple[Any, ...]:
        """The objects that drive."""
        return self._of_kinds[2]

    @property
    def _of_kinds(self) -> tuple[int, tuple[Any, ...], tuple[Any, ...]]:
        kinds = self._kinds
        if kinds is None or kinds[0] != len(self.objects):
            walking = tuple(item for item in self.objects if getattr(item, "isPedestrian", False))
            driving = tuple(item for item in self.objects if getattr(item, "isVehicle", False))
            kinds = self._kinds = len(self.objects), walking, driving
        return kinds

    _kinds: tuple[int, tuple[Any, ...], tuple[Any, ...]] | None = None

    @cached_property
    def drivers(self) -> dict[int, Any]:
        """The drivers that behaviors have made last, by the ``id`` of their cars."""
        return {}

    @cached_property
    def _law_abiding(self) -> set[int]:
        return set()

    def obeys_rules(self, agent: object) -> bool:
        """Return whether a car takes its way through intersections by `right_of_way`."""
        return id(agent) in self._law_abiding

    def note_rules(self, agent: object, obeys: bool) -> None:
        """Note whether a car takes its way through intersections by `right_of_way`."""
        if obeys:
            self._law_abiding.add(id(agent))
        else:
            self._law_abiding.discard(id(agent))

    def signalState(self, signal: Signal) -> str:
        """Return the colour of a traffic light now: ``red``, ``yellow``, ``green`` or ``off``."""
        lights = self.traffic_lights
        lights.time = self.currentTime * float(self.timestep)
        color: str = lights.get(signal)
        return color

    def recordCurrentState(self) -> None:
        """Append the state to the trajectory, and the colours of lights to `light_course`."""
        super().recordCurrentState()
        planned = self._planned_lights
        if planned is None:
            return
        lights, colors = planned
        lights.time = self.currentTime * float(self.timestep)
        moment = lights.moment
        if moment != self._light_moment:
            self._light_moment = moment
            self._light_colors = colors(self)
        self.light_course.append(self._light_colors)

    @cached_property
    def _planned_lights(self) -> tuple[TrafficLights, Callable[[object], Mapping[str, str]]] | None:
        """The lights that change by plan and what gives their colours; ``None`` if there are none, or those of another simulator."""
        colors = getattr(self.scene.workspace, "light_colors", None)
        if colors is None or not isinstance(self.trajectory, list):
            return None
        if not isinstance(self.traffic_lights, TrafficLights):
            return None
        is_overridden = type(self).signalState is not DrivingSimulation.signalState
        return None if is_overridden else (self.traffic_lights, colors)

    @cached_property
    def light_course(self) -> list[Mapping[str, str]]:
        """The colours of the map's lights in the states of the trajectory, by ``uid``, where the simulation has them by plan."""
        return []

    _light_moment: tuple[int, int, int] | None = None
    _light_colors: Mapping[str, str] = MappingProxyType({})

    def conclude(self) -> None:
        """Note why cars stand at the end."""
        for driver in self.drivers.values():
            driver.note_end()
        super().conclude()

    def _light_ahead(self, vehicle: Any, distance: float) -> Signal | None:
        """Return the first traffic light ahead of a vehicle within a distance in metres."""
        lane = vehicle._lane
        if lane is None:
            return None
        x, y, *_ = vehicle.position
        best: tuple[float, Signal] | None = None
        for signal in lane.halting_signals:
            point = signal.stoppingPointOn(lane)
            if not signal.isTrafficLight or point is None:
                continue
            a, b = point[0] - x, point[1] - y
            away = math.hypot(a, b)
            ahead = b * math.cos(vehicle.heading) - a * math.sin(vehicle.heading) > 0
            if ahead and away < distance and (best is None or away < best[0]):
                best = away, signal
        return None if best is None else best[1]

    def closest_traffic_light(self, vehicle: object, distance: float) -> str:
        """Return the colour of the traffic light ahead of a vehicle within a distance in metres; ``none`` if there is none."""
        signal = self._light_ahead(vehicle, distance)
        return "none" if signal is None else self.signalState(signal)

    def set_closest_traffic_light(self, vehicle: object, color: str, distance: float) -> None:
        """Set the traffic light ahead of a vehicle within a distance in metres, if there is one."""
        signal = self._light_ahead(vehicle, distance)
        if signal is not None:
            self.signalState(signal)
            self.traffic_lights.set(signal, color)

    def has_own_controllers(self, name: str) -> bool:
        """Return whether the simulation overrides a method for controllers."""
        return getattr(type(self), name) is not getattr(DrivingSimulation, name)

    def _controllers(self, agent: object, kind: str, others: tuple[float, float, float]) -> Controllers:
        is_car = bool(getattr(agent, "isCar", False))
        dt = float(self.timestep)
        along = (0.5, 0.1, 0.7) if is_car else (0.25, 0.025, 0.0)
        return (
            PIDLongitudinalController(*along, dt=dt),
            PIDLateralController(*(self._car_gains[kind] if is_car else others), dt=dt),
        )

    def steering_for(self, agent: Any, curvature: float) -> float:
        """Return the position of the steering wheel, -1 (left) to 1 (right), by which an agent drives a curve.

        A car turns about its rear axle by ``tan(angle of the front wheels) / wheelbase``.

        Args:
            agent: the agent.
            curvature: of its way, in 1/m, positive to the left.

        """
        angle: float = math.atan(curvature * agent.wheelbase) / agent.maxSteeringAngle
        return min(1.0, max(-1.0, -angle))

    def curvature_of(self, agent: Any, steering: float) -> float:
        """Return the curvature (1/m, positive to the left) that an agent drives by a position of the steering wheel."""
        return math.tan(-steering * float(agent.maxSteeringAngle)) / float(agent.wheelbase)

    def pivot_of(self, agent: Any) -> float:
        """Metres from the middle of an agent back to the point about which it turns: the rear axle."""
        return float(agent.wheelbase) / 2

    def pedal_for(self, agent: Any, acceleration: float) -> float:
        """The throttle (0 to 1), or the brake (-1 to 0), by which an agent reaches an acceleration in m/s^2."""
        most = agent.maxAcceleration if acceleration > 0 else agent.maxDeceleration
        return min(1.0, max(-1.0, acceleration / float(most)))

    def acceleration_of(self, agent: Any, pedal: float) -> float:
        """The acceleration (m/s^2) of an agent by a throttle (0 to 1) or brake (-1 to 0)."""
        return pedal * float(agent.maxAcceleration if pedal > 0 else agent.maxDeceleration)

    def getLaneFollowingControllers(self, agent: object) -> Controllers:
        """Return the controllers that keep an agent in its lane."""
        return self._controllers(agent, "keep", (0.2, 0.1, 0.0))

    def getTurningControllers(self, agent: object) -> Controllers:
        """Return the controllers that take an agent round a turn."""
        return self._controllers(agent, "turn", (0.4, 0.1, 0.0))

    def getLaneChangingControllers(self, agent: object) -> Controllers:
        """Return the controllers that take an agent to another lane."""
        return self._controllers(agent, "change", (0.1, 0.3, 0.0))


class DrivingSimulator(Simulator):
    """A simulator of traffic."""
