"""Pedestrian crossings, from the crosswalks of a map."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.building import BuiltRoad, Tell, area_of
from scenic.domains.driving.elements import Intersection, PedestrianCrossing, Road, Sidewalk
from scenic.domains.driving.enumerations import VehicleType
from scenic.domains.driving.network import RoadNetwork
from scenic.formats.opendrive.curves import Curve, cubic_values
from scenic.formats.opendrive.records import Crosswalk, MapProblem

__all__ = ["add_crossings"]

Floats = NDArray[np.float64]


def add_crossings(network: RoadNetwork, built: Mapping[str, BuiltRoad], tell: Tell) -> None:
    """Give a network its crossings."""
    import shapely

    crossings = []
    junction_of = {
        id(lane): intersection for intersection in network.intersections for lane in intersection._connecting
    }
    inside = {
        id(road): junction_of[id(lane)]
        for road in network.connectingRoads
        for lane in road.lanes
        if id(lane) in junction_of
    }
    for road in built.values():
        for number, crosswalk in enumerate(road.record.crosswalks):
            corners = _corners(road, crosswalk)
            polygon = area_of(shapely.MultiPoint(corners).convex_hull) if np.isfinite(corners).all() else None
            if polygon is None:
                message = f"crosswalk {crosswalk.id} of road {road.record.id} has no area: left out"
                tell(MapProblem("SC621", message, crosswalk.line, "crosswalk"))
                continue
            crossing = PedestrianCrossing(
                network,
                f"road{road.record.id}_crossing{number}",
                polygon,
                id=crosswalk.id,
                vehicles=frozenset({VehicleType.PEDESTRIAN}),
            )
            network.elements[crossing.uid] = crossing
            parent: Road | Intersection = inside.get(id(road.road), road.road)
            crossing.parent = parent
            left, right = _long_sides(polygon)
            crossing.place((left + right) / 2, left, right)
            parent.crossings += (crossing,)
            crossings.append(crossing)
    network.crossings = tuple(crossings)
    for crossing in crossings:
        ends = [_sidewalk_at(network, crossing.line[0]), _sidewalk_at(network, crossing.line[-1])]
        crossing.startSidewalk, crossing.endSidewalk = ends
        for sidewalk in dict.fromkeys(end for end in ends if end is not None):
            sidewalk.crossings += (crossing,)


def _corners(road: BuiltRoad, crosswalk: Crosswalk) -> Floats:
    """Return the corners of a crosswalk, ``(n, 2)``."""
    curve = Curve(road.record.geometry)

    def place(s: float, t: float) -> tuple[Floats, float]:
        at = np.array([min(max(s, 0.0), curve.length)])
        points, headings = curve.at(at)
        heading = float(headings[0])
        offset = t + float(cubic_values(road.record.lane_offset, at)[0])
        return points[0] + offset * np.array([-np.sin(heading), np.cos(heading)]), heading

    if crosswalk.along_road:
        return np.array([place(s, t)[0] for s, t in crosswalk.corners])
    origin, heading = place(crosswalk.s, crosswalk.t)
    heading += crosswalk.heading
    cos, sin = np.cos(heading), np.sin(heading)
    local = np.array(crosswalk.corners)
    return np.asarray(origin + local @ np.array([[cos, sin], [-sin, cos]]))


def _long_sides(polygon: object) -> tuple[Floats, Floats]:
    """The two long sides of the smallest rectangle round a polygon, in one direction, ``(2, 2)`` each."""
    import shapely

    box = shapely.get_coordinates(shapely.minimum_rotated_rectangle(polygon))[:4]
    if np.hypot(*(box[1] - box[0])) < np.hypot(*(box[2] - box[1])):
        box = np.roll(box, -1, axis=0)
    return box[[3, 2]], box[[0, 1]]


def _sidewalk_at(network: RoadNetwork, place: Floats) -> Sidewalk | None:
    """The sidewalk nearest to the end of a crossing, within a lane's width."""
    import shapely

    point = shapely.Point(place)
    near = [(sidewalk.polygon.distance(point), index) for index, sidewalk in enumerate(network.sidewalks)]
    best = min(near, default=None)
    return network.sidewalks[best[1]] if best is not None and best[0] <= 3.5 else None
