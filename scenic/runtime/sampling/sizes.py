"""Sizes of bodies: in words for reports, and whether a body fits into its container at all."""

import numpy as np

from scenic.graph.bounding import overall
from scenic.graph.bounds import Floats
from scenic.graph.node import Node
from scenic.runtime.regions.base import Region
from scenic.runtime.values.values import as_node

__all__ = ["extents", "outgrows", "size_in_words"]


def size_in_words(size: Node) -> str:
    """Write width, length and height as text, such as ``11.8 x 9.5 x 8.0 m`` or ``0.5-1.0 x 2.0 x 2.0 m``; empty without bounds.

    Args:
        size: the node of a body's width, length and height.

    """
    bounds = overall(size)
    if bounds is None or not (np.isfinite(bounds.lower).all() and np.isfinite(bounds.upper).all()):
        return ""
    sides = zip(bounds.lower[0].tolist(), bounds.upper[0].tolist(), strict=True)
    return " x ".join(_side(low, high) for low, high in sides) + " m"


def extents(container: Region) -> Floats | None:
    """Return the width, length and height ``(3,)`` of a region's bounding box, the largest where they are random; ``None`` if unknown."""
    extent = container.container_extent(*(overall(as_node(value)) for value in container.parameters))
    return None if extent is None else np.asarray((extent.upper - extent.lower).max(axis=0))


def outgrows(size: Node, extents: Floats | None) -> bool:
    """Return whether a body is larger than a region of these `extents`, however it is turned.

    Its longest side is compared with the diagonal of the region's bounding box. A body may stand upright in a region
    without bounds upwards, so that there its middle side counts.
    """
    bounds = overall(size)
    if bounds is None or extents is None:
        return False
    sides = np.sort(bounds.lower[0])
    if np.isfinite(extents).all():
        return bool(sides[2] > np.linalg.norm(extents))
    return bool(np.isfinite(extents[:2]).all() and sides[1] > np.linalg.norm(extents[:2]))


def _side(low: float, high: float) -> str:
    return _metres(low) if low == high else f"{_metres(low)}-{_metres(high)}"


def _metres(value: float) -> str:
    """Return a length to the decimetre; one below a metre to two digits."""
    return f"{value:.1f}" if value >= 1 else f"{value:.2g}"
