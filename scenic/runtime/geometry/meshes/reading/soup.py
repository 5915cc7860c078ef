"""Results of readers, and functions that they share."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import expand


class NotCoveredError(Exception):
    """The file is fine, but uses what the reader does not know."""


class Soup(NamedTuple):
    """Vertices ``(v, 3)`` and triangles ``(f, 3)`` as a file holds them."""

    vertices: Floats
    faces: Indices


def joined(parts: Iterable[Soup]) -> Soup:
    """Several of them as one."""
    parts = list(parts)
    if not parts:
        return Soup(np.empty((0, 3)), np.empty((0, 3), dtype=np.intp))
    counts = [len(part.vertices) for part in parts]
    starts = np.cumsum([0, *counts[:-1]])
    return Soup(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + start for part, start in zip(parts, starts, strict=True)]),
    )


def fans(corners: Indices, counts: Indices) -> Indices:
    """The triangles ``(f, 3)`` of polygons, each a fan about its first corner.

    Args:
        corners: the vertex numbers of all polygons, one after the other.
        counts: how many belong to each polygon; those with fewer than 3 have no triangles.

    """
    starts = np.cumsum(counts) - counts
    polygon, number = expand(np.maximum(counts - 2, 0))
    first = starts[polygon]
    return np.stack([corners[first], corners[first + number + 1], corners[first + number + 2]], axis=1)
