"""MetaDrive's packages, which are optional: imported when a simulation is made. They have no types, hence `Any`."""

from importlib import import_module
from pathlib import Path
from typing import Any, Final, NamedTuple

from scenic.language.errors import UnsupportedError

__all__ = ["MetaDriveClasses", "environment", "library"]


class MetaDriveClasses(NamedTuple):
    """The classes of MetaDrive that are used."""

    BaseEnv: Any
    DummyObservation: Any
    SumoMapManager: Any
    DefaultVehicle: Any
    Pedestrian: Any
    TrafficBarrier: Any


_PLACES: Final = {
    "BaseEnv": "metadrive.envs.base_env",
    "DummyObservation": "metadrive.obs.observation_base",
    "SumoMapManager": "metadrive.manager.sumo_map_manager",
    "DefaultVehicle": "metadrive.component.vehicle.vehicle_type",
    "Pedestrian": "metadrive.component.traffic_participants.pedestrian",
    "TrafficBarrier": "metadrive.component.static_object.traffic_object",
}
"""The modules of MetaDrive's classes."""


def library() -> MetaDriveClasses:
    """Return MetaDrive's classes; raises `UnsupportedError` without them."""
    try:
        return MetaDriveClasses(
            **{name: getattr(import_module(module), name) for name, module in _PLACES.items()}
        )
    except ImportError as error:
        raise UnsupportedError(
            f"simulating with MetaDrive needs the packages metadrive-simulator and sumolib ({error})",
            help="pip install metadrive-simulator sumolib; sampling scenes needs neither",
        ) from error


def environment(parts: MetaDriveClasses, network: Path, **settings: Any) -> Any:
    """Return an environment of MetaDrive on a road network of SUMO, with one agent.

    Args:
        parts: MetaDrive's classes.
        network: the ``.net.xml`` file.
        settings: MetaDrive's configuration.

    """

    class Environment(parts.BaseEnv):  # type: ignore[name-defined,misc] # a class that is known when it runs
        """An environment without goals."""

        def reward_function(self, _agent: object) -> tuple[float, dict[str, Any]]:
            return 0.0, {}

        def cost_function(self, _agent: object) -> tuple[float, dict[str, Any]]:
            return 0.0, {}

        def done_function(self, _agent: object) -> tuple[bool, dict[str, Any]]:
            return False, {}

        def get_single_observation(self) -> Any:
            return parts.DummyObservation()

        def setup_engine(self) -> None:
            super().setup_engine()
            self.engine.register_manager("map_manager", parts.SumoMapManager(str(network)))

    return Environment(settings)
