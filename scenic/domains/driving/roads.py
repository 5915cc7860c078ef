"""Road networks and their elements: the names that programs import."""

from pathlib import Path
from typing import Any

from scenic.domains.driving.drawing import show, svg
from scenic.domains.driving.elements import (
    Intersection,
    Lane,
    LaneGroup,
    LaneSection,
    LinearElement,
    Maneuver,
    NetworkElement,
    PedestrianCrossing,
    Road,
    RoadSection,
    Shoulder,
    Sidewalk,
    Signal,
)
from scenic.domains.driving.kinds import ManeuverType, VehicleType
from scenic.domains.driving.loading import load_network
from scenic.domains.driving.network import RoadNetwork

__all__ = [
    "Intersection",
    "Lane",
    "LaneGroup",
    "LaneSection",
    "LinearElement",
    "Maneuver",
    "ManeuverType",
    "Network",
    "NetworkElement",
    "PedestrianCrossing",
    "Road",
    "RoadSection",
    "Shoulder",
    "Sidewalk",
    "Signal",
    "VehicleType",
]


class Network(RoadNetwork):
    """The road network of a map."""

    @classmethod
    def fromFile(cls, path: Any, useCache: bool = True, writeCache: bool = True, **options: Any) -> "Network":
        """The network of a map file; the same one for equal content and options.

        Args:
            path: an OpenDRIVE file; ``.xodr`` may be left out.
            useCache: whether a network that was kept may be used.
            writeCache: whether to keep the network.
            options: see `scenic.domains.driving.loading.MapOptions`.

        Raises:
            FileNotFoundError: if there is no such file.
            ValueError: if its name tells of another format.
            MapError: if it is not a map.

        """
        return load_network(path, {"useCache": useCache, "writeCache": writeCache, **options}, cls)

    @classmethod
    def fromOpenDrive(cls, path: Any, **options: Any) -> "Network":
        """The network of an OpenDRIVE file; see `fromFile`."""
        return cls.fromFile(path, **options)

    def svg(self, width: int = 1200) -> str:
        """A drawing of the network from above, as SVG, ``width`` pixels wide."""
        return svg(self, width)

    def show(self, labelIncomingLanes: bool = False, showCurbArrows: bool = False) -> Path:
        """Draw the network in a browser, and return the file; the arguments are accepted for compatibility."""
        return show(self)
