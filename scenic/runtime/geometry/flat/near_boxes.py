"""Pairs of boxes of the plane, among many, that meet."""

from typing import Any

import numpy as np

from scenic.runtime.geometry.poses import Floats, Indices

__all__ = ["near_boxes", "tree_of_boxes"]


def tree_of_boxes(lower: Floats, upper: Floats) -> Any:
    """An index of boxes by their corners ``(k, 2 or more)``; heights do not count."""
    import shapely

    return shapely.STRtree(shapely.box(lower[:, 0], lower[:, 1], upper[:, 0], upper[:, 1]))


def near_boxes(tree: Any, lower: Floats, upper: Floats) -> tuple[Indices, Indices]:
    """Pairs of other boxes, by their finite corners ``(n, 2 or more)``, and boxes of the index that they meet, in order."""
    import shapely

    asked, found = tree.query(shapely.box(lower[:, 0], lower[:, 1], upper[:, 0], upper[:, 1]))
    order = np.lexsort((found, asked))
    return asked[order], found[order]
