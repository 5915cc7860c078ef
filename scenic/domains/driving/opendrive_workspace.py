"""The established workspace of an OpenDRIVE map, by its regions alone."""

import warnings
from typing import Any

from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.roads import Network
from scenic.domains.driving.workspace import DrivingWorkspace
from scenic.formats.opendrive import OpenDriveWarning
from scenic.runtime.regions.base import Region

__all__ = ["OpenDriveWorkspace"]


class OpenDriveWorkspace(DrivingWorkspace):
    """All of space, with the regions of a map.

    Attributes:
        drivable_region: where cars may be.
        sidewalk_region: the sidewalks.
        intersection_region: the intersections.
        road_direction: the field of the direction of traffic.
        lane_sec_dict: for each road, by its id in the file, the regions of its lanes in each section, by their ids.

    Args:
        path: an OpenDRIVE file.
        n: samples of each piece of a reference line, at least.
        tolerance: metres within which an element counts as being at a place that none holds.

    Raises:
        FileNotFoundError: if there is no such file.
        MapError: if it is not a map.

    """

    def __init__(self, path: object, n: int = 20, tolerance: float | None = None) -> None:
        options: dict[str, Any] = {} if tolerance is None else {"tolerance": tolerance}
        network = Network.fromFile(path, ref_points=n, **options)
        for problem in network.problems:
            warnings.warn(problem.message, OpenDriveWarning, stacklevel=2)
        super().__init__(network)
        self.drivable_region: Region = network.drivableRegion
        self.sidewalk_region: Region = network.sidewalkRegion
        self.intersection_region: Region = network.intersectionRegion
        self.road_direction = network.roadDirection
        self.lane_sec_dict = _lanes_of_sections(network)


def _lanes_of_sections(network: RoadNetwork) -> dict[Any, list[dict[int, Region]]]:
    return {
        road.id: [dict(section.lanesByOpenDriveID) for section in road.sections] for road in network.allRoads
    }
