"""The workspace of driving scenarios."""

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.lamps import LampPosts
from scenic.domains.driving.lanelets import road_records
from scenic.domains.driving.map_patches import MapPatches
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.signals import LightTimes, TrafficLights
from scenic.domains.driving.signs import Signal
from scenic.formats.commonroad.records import RoadRecords
from scenic.runtime.geometry.patches import Lamp, Patch
from scenic.runtime.regions.spaces import Workspace, everywhere

__all__ = ["DrivingWorkspace"]


class DrivingWorkspace(Workspace):
    """All of space, with the road network in the background.

    Args:
        network: the road network.

    """

    def __init__(self, network: RoadNetwork) -> None:
        self.network = network
        super().__init__(everywhere)

    @property
    def minimumZoomSize(self) -> float:
        """Metres that a drawing shows at least."""
        return 20.0

    @cached_property
    def _patches(self) -> MapPatches:
        return MapPatches(self.network)

    def patches(self, places: NDArray[np.float64]) -> tuple[Patch, ...]:
        """The map around places ``(n, 3)``, for pictures."""
        return self._patches.around(places)

    @cached_property
    def _posts(self) -> LampPosts:
        return LampPosts(self.network)

    def lamps(self, places: NDArray[np.float64]) -> tuple[Lamp, ...]:
        """The traffic lights and signs around places ``(n, 3)``, for pictures."""
        return self._posts.around(places)

    def first_colors(self, params: Mapping[str, object]) -> Mapping[str, str]:
        """Return the colours of traffic lights at the beginning, by ``uid``, by the parameters of a scene."""
        lights = self._lights(params)
        return {signal.uid: lights.get(signal) for signal in self._signals}

    def _lights(self, params: Mapping[str, object]) -> TrafficLights:
        times = params.get("traffic_lights")
        return TrafficLights(self.network, LightTimes.of(times if isinstance(times, Mapping) else {}))

    @cached_property
    def _signals(self) -> tuple[Signal, ...]:
        return tuple(signal for signal in self.network.signals if signal.isTrafficLight)

    def commonroad_records(self, params: Mapping[str, object]) -> RoadRecords:
        """Return the road network as a CommonRoad file has it, with traffic lights by the parameters of a scene."""
        return road_records(self.network, self._lights(params), Path(str(params.get("map", "Map"))).stem)

    def lanelets_at(self, place: tuple[float, float]) -> tuple[str, ...]:
        """Return the keys of the CommonRoad lanelets for cars that contain a place."""
        section = self.network.laneSectionAt(place)
        return () if section is None else (section.uid,)

    def light_colors(self, simulation: Any) -> Mapping[str, str]:
        """The colours of traffic lights at the present step of a simulation, by ``uid``."""
        return {signal.uid: simulation.signalState(signal) for signal in self._signals}

    def scenicToSchematicCoords(self, coords: Any) -> tuple[float, float]:
        """Return the coordinates of drawings: x and y."""
        x, y, *_ = coords
        return x, y
