"""The workspace of driving scenarios."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.map_patches import MapPatches
from scenic.domains.driving.network import RoadNetwork
from scenic.runtime.geometry.patches import Patch
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

    def scenicToSchematicCoords(self, coords: Any) -> tuple[float, float]:
        """Coordinates of drawings: x and y."""
        x, y, *_ = coords
        return x, y
