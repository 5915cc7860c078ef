"""The workspace of driving scenarios."""

from typing import Any

from scenic.domains.driving.network import RoadNetwork
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

    def scenicToSchematicCoords(self, coords: Any) -> tuple[float, float]:
        """Coordinates of drawings: x and y."""
        x, y, *_ = coords
        return x, y
