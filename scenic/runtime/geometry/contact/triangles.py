"""Contacts of triangles of space, for many pairs at once, in double precision.

By separating axes: two triangles are apart exactly if their projections are apart on a normal of one of them, on
the cross product of an edge of each, or, where they lie in one plane, on the normal of an edge in that plane.
Several axes are tried by each operation, since for few pairs operations cost more than numbers.
"""

from typing import Final, TypeAlias

import numpy as np

from scenic.runtime.geometry.affine import Columns
from scenic.runtime.geometry.poses import Booleans, Floats

Corners: TypeAlias = Floats
"""The three corners of triangles, ``(3, 3, m)`` indexed by corner, coordinate and triangle."""

_SLACK: Final = 1e-14
"""Gap, in parts of the triangles' extent, up to which they touch: the rounding of their coordinates."""

_PARALLEL: Final = 1e-9
"""Sine of the angle between two planes up to which the axes within the planes are tried too."""


def separated_by_edges(first: Corners, second: Corners) -> Booleans:
    """Return the mask of triangles ``(m,)`` that are apart, given that each meets the plane of the other."""
    # Near the origin, so that rounding is relative to the triangles' extent. From here on coordinates come first.
    a, b = ((corners - first[0]).swapaxes(0, 1) for corners in (first, second))
    edges_a, edges_b = _edges(a), _edges(b)
    scale = np.maximum(*(np.maximum.reduce(np.abs(corners), axis=(0, 1)) for corners in (a, b)))
    apart = np.zeros(len(scale), dtype=np.bool_)
    left = np.arange(len(apart))
    for i in range(3):
        here = _separated(_cross(edges_a[:, i : i + 1], edges_b), a, b, scale)
        apart[left[here]] = True
        stay = np.flatnonzero(~here)
        left, scale = left[stay], scale[stay]
        a, b, edges_a, edges_b = (part.take(stay, axis=2) for part in (a, b, edges_a, edges_b))
    normals = [np.stack([*_cross(edges[:, 0], edges[:, 1])]) for edges in (edges_a, edges_b)]
    squares = [_dot(normal, normal) for normal in normals]
    across = _cross(*normals)
    # Of a triangle that is hardly more than a segment the normal is rounding; it may lie in the other's plane, too.
    is_level = _dot(across, across) <= _PARALLEL * _PARALLEL * squares[0] * squares[1]
    is_level |= np.minimum(*squares) <= (_PARALLEL * scale * scale) ** 2
    level = np.flatnonzero(is_level)
    if len(level):
        normal = np.where(squares[0] >= squares[1], *normals)[:, np.newaxis, level]
        a, b, edges_a, edges_b = (part.take(level, axis=2) for part in (a, b, edges_a, edges_b))
        here = _separated(_cross(normal, np.concatenate([edges_a, edges_b], axis=1)), a, b, scale[level])
        apart[left[level[here]]] = True
    return apart


def _separated(axes: Columns, a: Floats, b: Floats, scale: Floats) -> Booleans:
    """Return a mask ``(m,)`` of the pairs whose projections on one of the axes ``(k, m)`` are apart by more than rounding."""
    low_a, high_a = _span(axes, a)
    low_b, high_b = _span(axes, b)
    slack = _SLACK * scale * (np.abs(axes[0]) + np.abs(axes[1]) + np.abs(axes[2]))
    result: Booleans = np.logical_or.reduce((low_a > high_b + slack) | (low_b > high_a + slack), axis=0)
    return result


def _span(axes: Columns, corners: Floats) -> tuple[Floats, Floats]:
    """Return the least and the greatest projections of the corners ``(3, 3, m)``, ``(k, m)`` each."""
    first, second, third = (_dot(axes, corners[:, number]) for number in range(3))
    return np.minimum(np.minimum(first, second), third), np.maximum(np.maximum(first, second), third)


def _edges(corners: Floats) -> Floats:
    return corners[:, (1, 2, 0)] - corners


def _dot(a: Columns, b: Columns) -> Floats:
    result: Floats = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return result


def _cross(a: Columns, b: Columns) -> Columns:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
