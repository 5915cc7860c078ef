"""The bodies that may stand between observers and what they look at."""

from collections.abc import Sequence
from dataclasses import field

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.vectors import dot, length
from scenic.runtime.geometry.views.hits import SeenBodies, place
from scenic.runtime.geometry.views.observers import DISTANCE_SLACK, Views


def _always() -> Booleans:
    return np.ones(1, dtype=np.bool_)


@dataclass(frozen=True)
class Occluder:
    """A body that hides what is behind it, and in which lanes it does, ``(n,)`` or ``(1,)``."""

    body: Body
    active: Booleans = field(default_factory=_always)


class Obstacles:
    """The occluders that may hide something of a target, for some lanes.

    Attributes:
        near: the occluders that may, in some lane.
        lanes: in which lanes each of them may, ``(n,)`` each.

    """

    def __init__(
        self,
        occluders: Sequence[Occluder],
        views: Views,
        lanes: Indices,
        middle: Floats,
        radius: Floats,
    ) -> None:
        """Find the occluders whose bounding spheres meet the hull of the camera and a ball.

        Args:
            occluders: those to choose from.
            views: with a row for each of the lanes.
            lanes: the lanes, ``(n,)``.
            middle: middle of a ball about the target, in the world, ``(n, 3)``.
            radius: its radius, metres, ``(n,)``.

        """
        self.near: list[Occluder] = []
        self.lanes: list[Booleans] = []
        self._views = views
        self._all = lanes
        self._placed: list[SeenBodies | None] = []
        way = middle - views.camera
        for occluder in occluders:
            active = occluder.active if len(occluder.active) == 1 else occluder.active[lanes]
            if not active.any():
                continue
            poses = occluder.body.poses.take(lanes)
            offset = poses.position - views.camera
            near = active & _meet_hull(offset, 0.5 * length(poses.size), way, radius)
            if near.any():
                self.near.append(occluder)
                self.lanes.append(near)
                self._placed.append(None)

    def placed(self, number: int) -> SeenBodies:
        """Return occluder ``number`` of ``near`` as the observers see it."""
        known = self._placed[number]
        if known is None:
            known = self._placed[number] = place(self.near[number].body, self._views, self._all)
        return known

    def block(self, lane: Indices, directions: Floats, limits: Floats, *, exact: bool = False) -> Booleans:
        """Return whether rays meet an occluder no farther than their limits, ``(r,)``.

        Args:
            lane: number of each ray's lane among those given at the start, ``(r,)``.
            directions: in the view's frame, ``(r, 3)``.
            limits: in lengths of the directions, ``(r,)``.
            exact: look at every face that a ray may meet in double precision.

        """
        result = np.zeros(len(lane), dtype=np.bool_)
        open_rays = np.arange(len(lane))
        for number, near in enumerate(self.lanes):
            ray_numbers = open_rays[near[lane[open_rays]]]
            if not len(ray_numbers):
                continue
            distance = self.placed(number).first(lane[ray_numbers], directions[ray_numbers], exact=exact)
            blocked_rays = ray_numbers[distance <= limits[ray_numbers] * (1 + DISTANCE_SLACK) + 1e-300]
            if len(blocked_rays):
                result[blocked_rays] = True
                open_rays = open_rays[~result[open_rays]]
        return result


def _meet_hull(offset: Floats, reach: Floats, way: Floats, radius: Floats) -> Booleans:
    """Return whether balls about ``offset`` meet the hull of the origin and a ball of a radius about ``way``; never wrongly no.

    The hull is the union of the balls of radius ``t radius`` about ``t way``, for t from 0 to 1. What the ball about
    ``offset`` lacks to meet one of them is convex in t, so its least value is where the derivative vanishes, or at
    an end.
    """
    distance = np.maximum(length(way), 1e-300)
    ahead = dot(offset, way) / distance
    beside = np.sqrt(np.maximum(length(offset) ** 2 - ahead * ahead, 0.0))
    slope = np.minimum(radius / distance, 1.0)
    rise = np.sqrt(np.maximum(1.0 - slope * slope, 1e-30))
    part = np.clip((ahead + beside * slope / rise) / distance, 0.0, 1.0)
    gap = np.hypot(beside, part * distance - ahead) - part * radius - reach
    result: Booleans = gap <= 1e-9 * (1.0 + length(offset) + distance)
    return result
