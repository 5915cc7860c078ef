"""Visibility of points (section 11.3)."""

from collections.abc import Sequence

import numpy as np

from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.views.observers import Views
from scenic.runtime.geometry.views.occluders import Obstacles, Occluder


def sees_points(views: Views, points: Floats, occluders: Sequence[Occluder], lanes: int) -> Booleans:
    """Return whether each observer sees its point, ``(lanes,)``.

    Args:
        views: the observers.
        points: in the world, metres, ``(lanes | 1, 3)``.
        occluders: what may hide the points; the observers themselves must not be among them.
        lanes: the number of lanes.

    """
    result = np.zeros(lanes, dtype=np.bool_)
    inside = np.broadcast_to(views.contain(points), (lanes,))
    lanes_inside = np.flatnonzero(inside)
    if len(lanes_inside):
        spread = np.broadcast_to(points, (lanes, 3))[lanes_inside]
        result[lanes_inside] = ~hidden_points(
            views.spread(lanes).take(lanes_inside), spread, occluders, lanes_inside
        )
    return result


def hidden_points(views: Views, points: Floats, occluders: Sequence[Occluder], lanes: Indices) -> Booleans:
    """Return whether an occluder's surface meets the way from the camera to a point, ``(n,)``; never for one at the camera.

    Args:
        views: with a row for each of the lanes.
        points: in the world, metres, ``(n, 3)``.
        occluders: over all lanes.
        lanes: which lanes the rows belong to, ``(n,)``.

    """
    obstacles = Obstacles(occluders, views, lanes, points, np.zeros(len(points)))
    way = views.to_view(points)
    away = np.flatnonzero((way != 0).any(axis=1))
    result = np.zeros(len(points), dtype=np.bool_)
    result[away] = obstacles.block(away, way[away], np.ones(len(away)), exact=True)
    return result
