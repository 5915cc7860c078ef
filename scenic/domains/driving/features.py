"""Counts and examples of the elements of a road map, as plain data: what a program can ask of it."""

from collections import Counter
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from scenic.domains.driving.roads import Network

__all__ = ["map_counts", "map_features"]

_EXAMPLES: Final = 3
"""Examples of each kind of element."""


def map_counts(network: "Network") -> dict[str, int]:
    """The numbers of elements of each kind."""
    return {
        "roads": len(network.roads),
        "lanes": len(network.lanes),
        "intersections": len(network.intersections),
        "sidewalks": len(network.sidewalks),
        "crossings": len(network.crossings),
        "shoulders": len(network.shoulders),
    }


def map_features(network: "Network") -> dict[str, Any]:
    """Counts, kinds of intersections and maneuvers, speed limits, and examples of lanes with neighbours."""
    junctions = network.intersections
    limits = (lane.speedLimit for lane in network.lanes)
    speeds = Counter(round(limit, 1) for limit in limits if limit is not None)
    maneuvers = Counter(
        maneuver.type.name for junction in junctions for maneuver in junction.maneuvers if maneuver.type
    )
    return {
        "counts": map_counts(network),
        "intersections": {
            "three_way": sum(each.is3Way for each in junctions),
            "four_way": sum(each.is4Way for each in junctions),
            "signalized": sum(each.isSignalized for each in junctions),
            "maneuvers": dict(sorted(maneuvers.items())),
            "examples": [each.uid for each in junctions[:_EXAMPLES]],
        },
        "speed_limits": [
            {"metres_per_second": speed, "lanes": count} for speed, count in sorted(speeds.items())
        ],
        "lanes": _lanes(network),
        "one_way_roads": sum(bool(road.is1Way) for road in network.roads),
        "drives_on_left": bool(network.driveOnLeft),
        "problems": len(network.problems),
    }


def _lanes(network: "Network") -> dict[str, Any]:
    """Numbers and examples of sections of lanes that have a neighbour, a faster lane, or traffic against them."""
    sections = [section for lane in network.lanes for section in lane.sections]
    kinds = {
        "with_left_neighbour": [each for each in sections if each._laneToLeft is not None],
        "with_right_neighbour": [each for each in sections if each._laneToRight is not None],
        "with_faster_lane": [each for each in sections if each._fasterLane is not None],
        "with_oncoming_traffic": [
            each
            for each in sections
            if each._laneToLeft is not None and each._laneToLeft.isForward != each.isForward
        ],
    }
    return {
        name: {
            "sections": len(sections_of_kind),
            "examples": [each.uid for each in sections_of_kind[:_EXAMPLES]],
        }
        for name, sections_of_kind in kinds.items()
    }
