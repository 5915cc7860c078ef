"""Roads with heights under the objects of the built-in simulator."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from scenic.domains.driving.levels import Levels
    from scenic.simulators.newtonian.simulator import State

__all__ = ["Terrain"]


class Terrain:
    """Keeps objects that move in the plane on the roads beneath them.

    Args:
        levels: the heights of the roads.

    """

    def __init__(self, levels: "Levels") -> None:
        self._levels = levels

    @classmethod
    def under(cls, scene: Any) -> "Terrain | None":
        """Return the terrain of a scene; ``None`` if its map is flat."""
        network = getattr(scene.workspace, "network", None)
        if network is None or not network.is_elevated or network.levels.elevation.is_level:
            return None
        return cls(network.levels)

    def stand(self, states: Sequence["State"]) -> None:
        """Note how high above the road objects are; they keep that height."""
        places = np.array([state.position for state in states])
        above = places[:, 2] - self._levels.heights(places)
        for state, height in zip(states, np.where(np.isfinite(above), above, 0.0).tolist(), strict=True):
            state.above = height

    def settle(self, states: Sequence["State"]) -> None:
        """Put objects that have moved in the plane back on the road: at their height above it, and cars with its slope."""
        states = [state for state in states if (state.position, state.heading) != state.settled]
        if not states:
            return
        new = np.array([state.position for state in states])
        heights, frames = self._levels.settled(new, np.array([state.heading for state in states]))
        # Off the road, nobody knows a height: what leaves it goes on level.
        resting_heights = heights + np.array([state.above for state in states])
        new[:, 2] = np.where(np.isfinite(heights), resting_heights, new[:, 2])
        for state, place, frame in zip(states, new.tolist(), frames.tolist(), strict=True):
            state.position = (place[0], place[1], place[2])
            if state.is_car:
                state.frame = frame
            state.settled = state.position, state.heading
