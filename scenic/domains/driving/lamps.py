"""Traffic lights and signs as pictures show them: a post where the signal stands, and lines where traffic halts for it."""

import math
from collections.abc import Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import Lane
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.signs import Signal
from scenic.runtime.geometry.patches import Lamp

__all__ = ["LampPosts", "halting_lanes"]

_AROUND: Final = 60.0
"""Metres around things within which lamps are drawn."""
_FAR: Final = 40.0
"""Metres beyond which a post is not where traffic halts for it, but at the side of the lane there."""
_LINE: Final = (0.5, 0.03)
"""Length along the lane and height of the line at which traffic halts, metres."""


class LampPosts:
    """Makes the posts and lines of all signals of a network, when first asked for.

    Args:
        network: the road network.

    """

    def __init__(self, network: RoadNetwork) -> None:
        self._network = network

    @cached_property
    def all(self) -> tuple[Lamp, ...]:
        """The posts and lines of all signals."""
        return tuple(lamp for signal in self._network.signals for lamp in self._lamps(signal))

    def around(self, places: NDArray[np.float64]) -> tuple[Lamp, ...]:
        """The lamps near places ``(n, 2 | 3)``."""
        if not self.all or not len(places):
            return ()
        from scipy.spatial import KDTree

        posts = np.array([lamp.position[:2] for lamp in self.all])
        distances = np.asarray(KDTree(places[:, :2]).query(posts)[0])
        return tuple(lamp for lamp, away in zip(self.all, distances, strict=True) if away < _AROUND)

    def _lamps(self, signal: Signal) -> Sequence[Lamp]:
        form = _form(signal)
        lanes = halting_lanes(signal) if form else []
        if form is None or not lanes:
            return ()
        lines = []
        for lane in lanes:
            x, y, heading, width = _halt(signal, lane)
            height = self._height(lane, x, y)
            lines.append(Lamp(signal.uid, "line", (x, y, height + 0.07), heading, (0.9 * width, *_LINE)))
        x, y, _ = signal.position
        base = lines[0]
        if math.hypot(x - base.position[0], y - base.position[1]) > _FAR:
            aside = 0.5 * base.size[0] / 0.9 + 0.8
            x = base.position[0] + aside * math.cos(base.yaw)
            y = base.position[1] + aside * math.sin(base.yaw)
        post = Lamp(signal.uid, form, (x, y, base.position[2] - 0.07), base.yaw, _SIZES[form])
        return [post, *(lines if form == "light" else ())]

    def _height(self, lane: Lane, x: float, y: float) -> float:
        if not self._network.is_elevated:
            return 0.0
        return float(lane.surface.heights(np.array([[x, y]]))[0])


_SIZES: Final = MappingProxyType(
    {"light": (0.45, 0.45, 3.6), "stop": (0.9, 0.14, 2.7), "yield": (0.9, 0.14, 2.7)}
)
"""Sizes of posts with what is on them, metres."""


def _form(signal: Signal) -> str | None:
    if signal.isTrafficLight:
        return "light"
    if signal.isStopSign:
        return "stop"
    return "yield" if signal.isYieldSign else None


def halting_lanes(signal: Signal) -> list[Lane]:
    """Return the lanes outside intersections on which traffic halts for a signal, each once."""
    lanes = {id(maneuver.startLane): maneuver.startLane for maneuver in signal.controlledManeuvers}
    return [lane for lane in lanes.values() if signal.stop_along(lane) is not None]


def _halt(signal: Signal, lane: Lane) -> tuple[float, float, float, float]:
    """Place, heading of traffic and width of the lane where it halts for a signal."""
    import shapely

    line = shapely.LineString(lane.line)
    along = min(signal.stop_along(lane) or 0.0, line.length)
    point = line.interpolate(along)
    before, after = line.interpolate(max(along - 1.0, 0.0)), line.interpolate(min(along + 1.0, line.length))
    heading = math.atan2(before.x - after.x, after.y - before.y)
    width = sum(float(shapely.distance(shapely.LineString(edge), point)) for edge in (lane.left, lane.right))
    return point.x, point.y, heading, width
