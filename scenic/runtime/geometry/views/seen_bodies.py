"""Visibility of bodies (section 11.3): the answer of casting every ray, found with as few as possible.

What is cheap decides first: a camera inside, the middle of the body, its range and directions, occluders that
hide its whole box. Then rays are cast: a few spread over the body, more, all. A ray that seems to get through is
checked in double precision against every face it may meet, so that no body is seen through a gap of rounding.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes import inside
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.ragged import first_of_each
from scenic.runtime.geometry.vectors import length
from scenic.runtime.geometry.views.grid import RayRows, rows_towards
from scenic.runtime.geometry.views.hits import SeenBodies, place
from scenic.runtime.geometry.views.observers import (
    DISTANCE_SLACK,
    Extents,
    Views,
    box_corners,
    extents,
)
from scenic.runtime.geometry.views.occluders import Obstacles, Occluder
from scenic.runtime.geometry.views.occlusion_proofs import boxes_hidden
from scenic.runtime.geometry.views.seen_points import hidden_points

_LANES: Final = 1024
"""Lanes looked at together."""

_RAYS: Final = 1 << 17
"""Rays cast together."""

_STAGES: Final = (8, 40)
"""Rows and columns of the rays cast before all of them are."""


def sees_bodies(views: Views, target: Body, occluders: Sequence[Occluder], lanes: int) -> Booleans:
    """Return whether each observer sees the target, ``(lanes,)``.

    Args:
        views: the observers.
        target: what they look at.
        occluders: what may hide it; neither the observers themselves nor the target may be among them.
        lanes: the number of lanes.

    """
    result = np.zeros(lanes, dtype=np.bool_)
    spread = views.spread(lanes)
    for start in range(0, lanes, _LANES):
        part = np.arange(start, min(start + _LANES, lanes))
        result[part] = _sees(spread.take(part), target, occluders, part)
    return result


def _sees(views: Views, target: Body, occluders: Sequence[Occluder], lanes: Indices) -> Booleans:
    """Return the same for some lanes; the views have a row for each of them."""
    bounds = bounded(views, target, occluders, lanes)
    seen = bounds.seen
    if len(bounds.left):
        seen[bounds.left] = RaySearch(views, target, occluders, lanes, bounds).found()
    return seen


@dataclass(frozen=True)
class SightBounds:
    """Facts that are known before rays are cast.

    Attributes:
        seen: the lanes whose observer is in the target or sees its middle, ``(n,)``.
        left: numbers of the lanes that are open: not seen yet, but within range and angles, ``(m,)``.
        directions: those of the targets' boxes in the open lanes.

    """

    seen: Booleans
    left: Indices
    directions: Extents

    def surroundings(
        self, views: Views, target: Body, occluders: Sequence[Occluder], lanes: Indices
    ) -> tuple[SeenBodies, Obstacles, Floats]:
        """For the open lanes, whose views are given: the target, what may hide it, and its box's corners."""
        chosen = lanes[self.left]
        poses = target.poses.take(chosen)
        position, size = (np.broadcast_to(part, (len(chosen), 3)) for part in (poses.position, poses.size))
        radius = 0.5 * np.sqrt(size[:, 0] ** 2 + size[:, 1] ** 2 + size[:, 2] ** 2)
        obstacles = Obstacles(occluders, views, chosen, position, radius)
        return place(target, views, chosen), obstacles, box_corners(views, poses)


def bounded(views: Views, target: Body, occluders: Sequence[Occluder], lanes: Indices) -> SightBounds:
    """Return the decisions by bounds and the middle of the target; the views have a row for each of the lanes."""
    poses = target.poses.take(lanes)
    position = np.broadcast_to(poses.position, (len(lanes), 3))
    placement = place(target, views, lanes)
    is_seen = inside_body(placement)
    central = np.flatnonzero(~is_seen & views.contain(position) & _holds_centre(placement))
    if len(central):
        is_hidden = hidden_points(views.take(central), position[central], occluders, lanes[central])
        is_seen[central] = ~is_hidden
    apart = box_distance(placement.origin, poses.size)
    left = np.flatnonzero(~is_seen & (apart <= views.distance * (1 + DISTANCE_SLACK)))
    directions = extents(box_corners(views.take(left), poses.take(left)))
    meets = np.flatnonzero(directions.meet(views.window[left]))
    directions = Extents(directions.azimuth[meets], directions.around[meets], directions.altitude[meets])
    return SightBounds(is_seen, left[meets], directions)


def inside_body(placed: SeenBodies) -> Booleans:
    """Return whether the camera is inside the body, ``(n,)``."""
    result = np.zeros(len(placed.mesh), dtype=np.bool_)
    near = (np.abs(placed.origin) <= 0.5).all(axis=1)
    for number, mesh in enumerate(placed.meshes):
        chosen = np.flatnonzero(near & (placed.mesh == number))
        if len(chosen):
            result[chosen] = mesh.is_box or inside.contains_points(mesh, placed.origin[chosen])
    return result


def box_distance(origin: Floats, size: Floats) -> Floats:
    """Distances of points ``(n, 3)`` in the unit frame from the box of a size, in metres, ``(n,)``."""
    return length((origin - np.clip(origin, -0.5, 0.5)) * size)


def _holds_centre(placed: SeenBodies) -> Booleans:
    known = np.array([mesh.derived(contains_own_centre) for mesh in placed.meshes], dtype=np.bool_)
    return known[placed.mesh]


def contains_own_centre(mesh: Mesh) -> bool:
    """Return whether the solid of a mesh holds the middle of its box."""
    return mesh.is_box or bool(inside.contains_points(mesh, np.zeros((1, 3)))[0])


class RaySearch:
    """The search for a ray that meets the target and nothing before it, in some lanes."""

    def __init__(
        self, views: Views, target: Body, occluders: Sequence[Occluder], lanes: Indices, bounds: SightBounds
    ) -> None:
        self._views = views.take(bounds.left)
        self._count = len(bounds.left)
        self._placed, self._obstacles, self._corners = bounds.surroundings(
            self._views, target, occluders, lanes
        )
        position = np.broadcast_to(target.poses.take(lanes[bounds.left]).position, (self._count, 3))
        way = position - self._views.camera
        distance = np.sqrt(way[:, 0] ** 2 + way[:, 1] ** 2 + way[:, 2] ** 2)
        self._rows = rows_towards(self._views, bounds.directions, distance)

    def found(self) -> Booleans:
        """Return whether there is such a ray among those of the view's grid, ``(n,)``."""
        is_seen = np.zeros(self._count, dtype=np.bool_)
        left = ~boxes_hidden(self._corners, self._obstacles)
        for across in _STAGES:
            totals = self._rows.totals(self._count)
            few = left & (totals <= 4 * across * across)
            self._cast(self._rows, few, is_seen)
            left &= ~few
            self._cast(self._rows.thinned(across, self._count), left, is_seen)
            left &= ~is_seen
            if not left.any():
                return is_seen
        self._cast(self._rows, left, is_seen)
        return is_seen

    def _cast(self, rows: RayRows, wanted: Booleans, seen: Booleans) -> None:
        """Cast the rays of the wanted lanes and mark those where one gets through."""
        rows = rows.where(np.flatnonzero(wanted[rows.lane]))
        for lane, directions in rows.rays(_RAYS):
            useful = np.flatnonzero(~seen[lane])
            lane, directions = lane[useful], directions[useful]
            through = self._through(lane, directions)
            # One ray for each lane is enough; only where it fails the exact test, the next is looked at.
            while len(through):
                first = through[first_of_each(lane[through])]
                passes = self._through(lane[first], directions[first], exact=True)
                seen[lane[first[passes]]] = True
                through = through[~seen[lane[through]] & ~np.isin(through, first)]

    def _through(self, lane: Indices, directions: Floats, *, exact: bool = False) -> Indices:
        """The numbers of the rays that meet the target within range and no occluder before it."""
        distance = self._placed.first(lane, directions, exact=exact)
        meets = np.flatnonzero(distance <= self._views.distance[lane] * (1 + DISTANCE_SLACK))
        if not len(meets):
            return meets
        blocked = self._obstacles.block(lane[meets], directions[meets], distance[meets], exact=exact)
        return meets[~blocked]
