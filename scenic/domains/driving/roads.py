"""Road networks and their elements: the names that programs import."""

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
from scenic.domains.driving.network import Network

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
