"""Pairs of boxes of the plane, among many, that meet."""

from typing import Any

import numpy as np

from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import expand

__all__ = ["near_boxes", "tree_of_boxes"]


def tree_of_boxes(lower: Floats, upper: Floats) -> Any:
    """Return an index of boxes by their corners ``(k, 2 or more)``; heights do not count."""
    import shapely

    return shapely.STRtree(shapely.box(lower[:, 0], lower[:, 1], upper[:, 0], upper[:, 1]))


def near_boxes(tree: Any, lower: Floats, upper: Floats) -> tuple[Indices, Indices]:
    """Pairs of other boxes, by their finite corners ``(n, 2 or more)``, and boxes of the index that they meet, in order.

    Equal boxes in a row, as of many tries in one lane, are looked up once.
    """
    import shapely

    corners = np.concatenate([lower[:, :2], upper[:, :2]], axis=1)
    is_first = np.ones(len(corners), dtype=np.bool_)
    is_first[1:] = (corners[1:] != corners[:-1]).any(axis=1)
    first = np.flatnonzero(is_first)
    queries, hits = tree.query(shapely.box(*corners[first].T))
    order = np.lexsort((hits, queries))
    queries, hits = queries[order], hits[order]
    if len(first) == len(corners):
        return queries, hits
    counts = np.bincount(queries, minlength=len(first))
    starts = np.cumsum(counts) - counts
    run = np.cumsum(is_first) - 1
    owner, offset = expand(counts[run])
    return owner, hits[starts[run[owner]] + offset]
