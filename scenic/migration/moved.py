"""Names that Scenic 3 has in another place, or calls otherwise."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

__all__ = [
    "LIBRARY_NAMES",
    "LOST_CLASSES",
    "MAP_LOADERS",
    "MAP_LOADING",
    "MOVED_MODULES",
    "PARAMETERS",
    "PYTHON_API",
]

MOVED_MODULES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "scenic.simulators.webots.mars.model": "scenic.simulators.webots.model",
        "scenic.simulators.webots.mars.mars_model": "scenic.simulators.webots.model",
        "scenic.simulators.webots.common.model": "scenic.simulators.webots.model",
        "scenic.simulators.carla.road_model": "scenic.simulators.carla.model",
        "scenic.simulators.carla.prop_model": "scenic.simulators.carla.model",
        "scenic.simulators.carla.carla_model": "scenic.simulators.carla.model",
        "scenic.simulators.gta.gta_model": "scenic.simulators.gta.model",
        "scenic.simulators.lgsvl.lgsvl_model": "scenic.simulators.lgsvl.model",
        "scenic.simulators.domains.driving.model": "scenic.domains.driving.model",
        "scenic.simulators.domains.driving.network": "scenic.domains.driving.network",
        "scenic.simulators.domains.driving.roads": "scenic.domains.driving.roads",
        "scenic.simulators.formats.opendrive.model": "scenic.domains.driving.model",
    }
)
"""World models and libraries: the module of Scenic 2, and the module of today."""

MAP_LOADERS: Final[Mapping[str, str]] = MappingProxyType(
    {"loadNetwork": "param map = ", "loadLocalNetwork": "param map = localPath("}
)
"""Functions of the first driving library that read a map, and what stands there today before its path."""

MAP_LOADING: Final = frozenset(
    {"scenic.simulators.domains.driving.network", "scenic.domains.driving.network"}
)
"""Their modules."""

LOST_CLASSES: Final = frozenset(
    {"scenic.simulators.webots.mars.model", "scenic.simulators.webots.mars.mars_model"}
)
"""Moved modules some of whose classes exist nowhere today."""

PARAMETERS: Final[Mapping[str, str]] = MappingProxyType({"time_step": "timestep"})
"""Parameters of programs."""

LIBRARY_NAMES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "distanceToAnyCars": "withinDistanceToAnyCars",
        "distanceToAnyObjs": "withinDistanceToAnyObjs",
        "distanceToAnyPedestrians": "withinDistanceToAnyPedestrians",
        "distanceToObjsInLane": "withinDistanceToObjsInLane",
    }
)
"""Names of the driving library."""

PYTHON_API: Final[Mapping[str, str]] = MappingProxyType(
    {
        "maxIterations": "simulate(scene, maxSteps=..., maxIterations=...)",
        "verbosity": "createSimulation(scene, *, timestep, maxSteps, name, **kwargs)",
        "TokenParseError": "scenic.core.errors.ScenicSyntaxError",
        "zoom": "scene.show() or scene.show2D(zoom=...)",
    }
)
"""Names of the Python API that are reported: each with what to write today."""
