"""Speed limits along roads and lanes, from the records of a map."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.formats.opendrive import records

__all__ = ["Ranges", "limits_along", "lowest", "merged", "ranges_of", "road_speeds", "section_speeds"]

Ranges = tuple[tuple[float, float, float | None], ...]
"""Stretches of an element in its direction: from and to, in metres along it, and the limit in m/s; ``None`` for no limit."""


def lowest(ranges: Ranges) -> float | None:
    """The lowest limit of some stretches in m/s; ``None`` if none has one."""
    return min((limit for _, _, limit in ranges if limit is not None), default=None)


def road_speeds(road: records.Road) -> Ranges:
    """The limits along a road's reference line."""
    return _ranges(road.speeds, 0.0, road.length, ((0.0, road.length, None),))


def section_speeds(
    road: records.Road, section: records.LaneSection, lane: records.Lane, is_forward: bool
) -> Ranges:
    """The limits along a lane in a section of its road, in the direction of traffic: those of the lane before those of the road."""
    begin = section.s
    end = next((other.s for other in road.sections if other.s > begin), road.length)
    base = tuple(
        (max(start, begin) - begin, min(stop, end) - begin, limit)
        for start, stop, limit in road_speeds(road)
        if start < end and stop > begin
    )
    ranges = _ranges(lane.speeds, 0.0, end - begin, base)
    if is_forward:
        return ranges
    return tuple((end - begin - stop, end - begin - start, limit) for start, stop, limit in ranges[::-1])


def _ranges(speeds: Sequence[records.Speed], begin: float, end: float, base: Ranges) -> Ranges:
    """The limits of records, and before the first record those of ``base``."""
    places = [speed for speed in speeds if speed.start < end]
    first = max(begin, places[0].start) if places else end
    ranges = [(start, min(stop, first), limit) for start, stop, limit in base if start < first]
    stops = [*(speed.start for speed in places[1:]), *([end] if places else [])]
    ranges += [
        (max(begin, speed.start), stop, speed.limit)
        for speed, stop in zip(places, stops, strict=True)
        if stop > speed.start
    ]
    return merged(ranges)


def ranges_of(parts: Iterable[Any]) -> Ranges:
    """The limits of elements, one after the other."""
    found = []
    along = 0.0
    for part in parts:
        for start, stop, limit in part.speedLimitRanges:
            found.append((along + start, along + stop, limit))
        along = found[-1][1] if found else along
    return merged(found)


def merged(ranges: Iterable[tuple[float, float, float | None]]) -> Ranges:
    """Stretches, with neighbours of one limit joined."""
    found: list[tuple[float, float, float | None]] = []
    for start, stop, limit in ranges:
        if found and found[-1][2] == limit:
            found[-1] = (found[-1][0], stop, limit)
        elif stop > start:
            found.append((start, stop, limit))
    return tuple(found)


def limits_along(ranges: Ranges, along: NDArray[np.float64]) -> NDArray[np.float64]:
    """The limits ``(n,)`` in m/s at places ``(n,)`` metres along an element; infinite where there is none."""
    result = np.full(len(along), np.inf)
    for start, stop, limit in ranges:
        if limit is not None:
            result[(along >= start) & (along <= stop)] = limit
    return result
