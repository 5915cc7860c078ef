"""Traffic lights that change: phases in which no two ways cross, and their times (section 12 of the driving specification)."""

import math
from collections.abc import Mapping
from dataclasses import fields
from itertools import pairwise
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.domains.driving.elements import Intersection
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.signs import Signal
from scenic.language.errors import InvalidScenarioError
from scenic.language.spelling import nearest
from scenic.simulators.actions import Action

__all__ = [
    "COLORS",
    "FreezeTrafficLightsAction",
    "LightTimes",
    "SetTrafficLightAction",
    "TrafficLights",
    "fixed_colors",
    "phases_of",
]

COLORS: Final = ("red", "yellow", "green", "off")


@dataclass(frozen=True, slots=True)
class LightTimes:
    """Times of traffic lights (the parameter ``traffic_lights``).

    Attributes:
        green: seconds of green of a phase.
        yellow: seconds of yellow after it.
        all_red: seconds in which all lights are red before the next phase.
        offset: seconds by which the cycle has begun before the simulation.
        states: colours of lights that never change, by the ids of signals.

    """

    green: float = 10.0
    yellow: float = 3.0
    all_red: float = 1.5
    offset: float = 0.0
    states: Mapping[str, str] | None = None

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> "LightTimes":
        """Return the times of a mapping.

        Raises:
            InvalidScenarioError: an entry has an unknown name, or is not a time.

        """
        field_names = [field.name for field in fields(cls)]
        for name, value in given.items():
            if name not in field_names:
                near = nearest(name, field_names)
                raise InvalidScenarioError(
                    f"traffic_lights has no entry {name!r}",
                    help=f"did you mean {near!r}?" if near else f"the entries are {', '.join(field_names)}",
                )
            is_time = isinstance(value, int | float) and math.isfinite(value) and value >= 0
            if name != "states" and not is_time:
                raise InvalidScenarioError(f"traffic_lights: {name} must be seconds, not {value!r}")
        times = cls(**given)
        if times.green <= 0:
            raise InvalidScenarioError("traffic_lights: green must be more than 0 seconds")
        return times


def phases_of(intersection: Intersection) -> tuple[tuple[Signal, ...], ...]:
    """Return the lights of an intersection that are green together: no maneuver of one conflicts with a maneuver of another one."""
    phases: list[list[Signal]] = []
    for signal in intersection.signals:
        if not signal.isTrafficLight:
            continue
        for phase in phases:
            if not any(_conflict(signal, other) for other in phase):
                phase.append(signal)
                break
        else:
            phases.append([signal])
    return tuple(map(tuple, phases))


def _conflict(one: Signal, other: Signal) -> bool:
    others = {id(maneuver) for maneuver in other.controlledManeuvers}
    return any(
        id(crossing) in others
        for maneuver in one.controlledManeuvers
        for crossing in maneuver.conflictingManeuvers
    )


def fixed_colors(network: RoadNetwork, states: Mapping[str, str]) -> dict[str, str]:
    """Return the colours of lights that never change, by ``uid``, from colours by ids.

    Raises:
        InvalidScenarioError: a light is not there, or a colour is not one of `COLORS`.

    """
    colors = {}
    lights = {signal.openDriveID: signal for signal in network.signals if signal.isTrafficLight}
    for key, color in states.items():
        light = lights.get(str(key).removeprefix("signal"))
        if light is None:
            near = nearest(str(key), list(lights))
            raise InvalidScenarioError(
                f"traffic_lights names the light {key!r}, which the map does not have",
                help=f"did you mean {near!r}?"
                if near
                else f"lights of the map: {', '.join(sorted(lights)) or 'none'}",
            )
        colors[light.uid] = _color(color)
    return colors


class TrafficLights:
    """The traffic lights of a running simulation.

    Args:
        network: the road network.
        times: of the phases.

    Raises:
        InvalidScenarioError: ``times`` name a light that is not there, or a colour that is none.

    """

    def __init__(self, network: RoadNetwork, times: LightTimes) -> None:
        self._times = times
        self._length = times.green + times.yellow + times.all_red
        self._phase: dict[str, tuple[int, int]] = {}
        for intersection in network.intersections:
            phases = phases_of(intersection)
            for number, phase in enumerate(phases):
                for signal in phase:
                    self._phase.setdefault(signal.uid, (number, len(phases)))
        self._fixed = fixed_colors(network, times.states or {})
        self._set: dict[str, tuple[str, str]] = {}
        self._frozen: float | None = None
        self._lag = 0.0
        self._interventions = 0
        self.time = 0.0

    @property
    def _now(self) -> float:
        return (self.time if self._frozen is None else self._frozen) - self._lag + self._times.offset

    @property
    def moment(self) -> tuple[int, int, int]:
        """Numbers that are the same as long as no light changes."""
        times = self._times
        turn, into = divmod(self._now, self._length)
        return int(turn), (into >= times.green) + (into >= times.green + times.yellow), self._interventions

    def get(self, signal: Signal) -> str:
        """Return the colour of a light now: ``red``, ``yellow``, ``green`` or ``off``."""
        fixed_color = self._fixed.get(signal.uid)
        if fixed_color is not None:
            return fixed_color
        planned_color = self._planned(signal)
        if signal.uid in self._set:
            color, before = self._set[signal.uid]
            # A light that has been set stays so until it would change.
            if before == planned_color or self._frozen is not None:
                return color
            del self._set[signal.uid]
        return planned_color

    def _planned(self, signal: Signal) -> str:
        place = self._phase.get(signal.uid)
        if place is None:
            return "off"
        number, count = place
        times, length = self._times, self._length
        into = self._now % (length * count) - number * length
        if 0 <= into < times.green:
            return "green"
        return "yellow" if times.green <= into < times.green + times.yellow else "red"

    def cycle(self, signal: Signal) -> tuple[tuple[float, str], ...]:
        """Return the seconds and colours of a light from the beginning of the simulation on; they repeat unless a program sets the light."""
        fixed_color, place = self._fixed.get(signal.uid), self._phase.get(signal.uid)
        if fixed_color is not None or place is None:
            return ((1.0, fixed_color or "off"),)
        number, count = place
        times, length = self._times, self._length
        colors = ["red", "green", "yellow", "red"]
        ends = np.cumsum([number * length, times.green, times.yellow])
        borders = [0.0, *ends.tolist(), length * count]
        start_time = times.offset % borders[-1]
        parts = [(*border, color) for border, color in zip(pairwise(borders), colors, strict=True)]
        intervals = [(max(start, start_time), end, color) for start, end, color in parts if end > start_time]
        intervals += [
            (start, min(end, start_time), color) for start, end, color in parts if start < start_time
        ]
        return tuple((end - start, color) for start, end, color in intervals if end > start)

    @property
    def longest_cycle(self) -> float:
        """Seconds of the longest cycle of any intersection; 0 without lights."""
        length = self._times.green + self._times.yellow + self._times.all_red
        return length * max((count for _, count in self._phase.values()), default=0)

    def set(self, signal: Signal, color: str) -> None:
        """Set a light, until it would change."""
        self._interventions += 1
        self._set[signal.uid] = _color(color), self._planned(signal)

    def freeze(self, frozen: bool) -> None:
        """Let all lights stay as they are, or change again from there on."""
        self._interventions += 1
        if frozen and self._frozen is None:
            self._frozen = self.time
        elif not frozen and self._frozen is not None:
            self._lag += self.time - self._frozen
            self._frozen = None


def _color(color: object) -> str:
    name = str(color).lower()
    if name not in COLORS:
        raise InvalidScenarioError(
            f"{color!r} is not a colour of a traffic light", help=f"use one of {', '.join(COLORS)}"
        )
    return name


class SetTrafficLightAction(Action):
    """Set a traffic light, until it would change.

    Args:
        signal: the light.
        color: ``red``, ``yellow``, ``green`` or ``off``.

    """

    def __init__(self, signal: Signal, color: str) -> None:
        self.signal, self.color = signal, _color(color)

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Set it."""
        simulation.traffic_lights.set(self.signal, self.color)


class FreezeTrafficLightsAction(Action):
    """Let all traffic lights stay as they are, or change again."""

    def __init__(self, frozen: bool = True) -> None:
        self.frozen = frozen

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Do it."""
        simulation.traffic_lights.freeze(self.frozen)
