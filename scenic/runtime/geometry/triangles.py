"""Whether triangles of space share a point, for many pairs at once, in double precision.

By separating axes: two triangles are apart exactly if their projections are apart on a normal of one of them, on
the cross product of an edge of each, or, where they lie in one plane, on the normal of an edge in that plane.
"""

from collections.abc import Sequence
from typing import Final, TypeAlias

import numpy as np

from scenic.runtime.geometry.affine import Columns, taken
from scenic.runtime.geometry.poses import Booleans, Floats, Indices

Corners: TypeAlias = Sequence[Columns]
"""The three corners of triangles, each as columns ``(m,)`` of coordinates."""

_SLACK: Final = 1e-14
"""Gap, in parts of the triangles' extent, up to which they touch: the rounding of their coordinates."""

_PARALLEL: Final = 1e-9
"""Sine of the angle between two planes up to which the axes within the planes are tried too."""


def separated_by_edges(first: Corners, second: Corners) -> Booleans:
    """Which triangles ``(m,)`` are apart, given that each meets the plane of the other."""
    origin = first[0]
    # Near the origin, so that rounding is relative to the triangles' extent.
    a, b = ([_minus(corner, origin) for corner in corners] for corners in (first, second))
    edges_a, edges_b = _edges(a), _edges(b)
    scale = np.abs(b[0][0])
    for corner in (*a[1:], *b):
        for column in corner:
            scale = np.maximum(scale, np.abs(column))
    apart = np.zeros(len(origin[0]), dtype=np.bool_)
    left = np.arange(len(apart))
    for i in range(3):
        here = np.zeros(len(left), dtype=np.bool_)
        for j in range(3):
            here |= _separates(_cross(edges_a[i], edges_b[j]), a, b, scale)
        apart[left[here]] = True
        stay = np.flatnonzero(~here)
        left, scale = left[stay], scale[stay]
        a, b, edges_a, edges_b = (taken_corners(part, stay) for part in (a, b, edges_a, edges_b))
    normals = _cross(edges_a[0], edges_a[1]), _cross(edges_b[0], edges_b[1])
    squares = [_dot(normal, normal) for normal in normals]
    across = _cross(*normals)
    level = np.flatnonzero(_dot(across, across) <= _PARALLEL * _PARALLEL * squares[0] * squares[1])
    if len(level):
        larger = squares[0] >= squares[1]
        x, y, z = (np.where(larger, *pair)[level] for pair in zip(*normals, strict=True))
        a, b, scale = taken_corners(a, level), taken_corners(b, level), scale[level]
        here = np.zeros(len(level), dtype=np.bool_)
        for edge in (*taken_corners(edges_a, level), *taken_corners(edges_b, level)):
            here |= _separates(_cross((x, y, z), edge), a, b, scale)
        apart[left[level[here]]] = True
    return apart


def _separates(axis: Columns, a: Corners, b: Corners, scale: Floats) -> Booleans:
    """Whether the projections on the axis are apart by more than rounding."""
    low_a, high_a = _span(axis, a)
    low_b, high_b = _span(axis, b)
    slack = _SLACK * scale * (np.abs(axis[0]) + np.abs(axis[1]) + np.abs(axis[2]))
    result: Booleans = (low_a > high_b + slack) | (low_b > high_a + slack)
    return result


def _span(axis: Columns, corners: Corners) -> tuple[Floats, Floats]:
    first, second, third = (_dot(axis, corner) for corner in corners)
    return np.minimum(np.minimum(first, second), third), np.maximum(np.maximum(first, second), third)


def _edges(corners: Corners) -> list[Columns]:
    return [_minus(corners[(k + 1) % 3], corners[k]) for k in range(3)]


def taken_corners(corners: Corners, chosen: Indices) -> list[Columns]:
    """The corners of these triangles."""
    return [taken(corner, chosen) for corner in corners]


def _minus(a: Columns, b: Columns) -> Columns:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _dot(a: Columns, b: Columns) -> Floats:
    result: Floats = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return result


def _cross(a: Columns, b: Columns) -> Columns:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
