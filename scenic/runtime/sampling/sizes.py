"""Sizes of bodies: in words for reports, and whether a body fits into its container at all."""

from typing import Any

import numpy as np

from scenic.graph.bounding import overall
from scenic.graph.node import Node
from scenic.runtime.regions.base import Region
from scenic.runtime.values.values import as_node

__all__ = ["outgrows", "size_in_words"]


def size_in_words(size: Node) -> str:
    """Width, length and height as text, such as ``11.8 x 9.5 x 8.0 m`` or ``0.5-1.0 x 2.0 x 2.0 m``; empty without bounds.

    Args:
        size: the node of a body's width, length and height.

    """
    bounds = overall(size)
    if bounds is None or not (np.isfinite(bounds.lower).all() and np.isfinite(bounds.upper).all()):
        return ""
    sides = zip(bounds.lower[0].tolist(), bounds.upper[0].tolist(), strict=True)
    return " x ".join(_side(low, high) for low, high in sides) + " m"


def outgrows(size: Node, container: Region) -> bool:
    """Return whether a body is larger than a region, however it is turned.

    Its longest side is compared with the diagonal of the region's bounding box. A body may stand upright in a region
    without bounds upwards, so that there its middle side counts.
    """
    bounds = overall(size)
    parameters: list[Any] = [overall(as_node(value)) for value in container.parameters]
    extent = container.container_extent(*parameters)
    if bounds is None or extent is None:
        return False
    sides = np.sort(bounds.lower[0])
    across = (extent.upper - extent.lower).max(axis=0)
    if np.isfinite(across).all():
        return bool(sides[2] > np.linalg.norm(across))
    return bool(np.isfinite(across[:2]).all() and sides[1] > np.linalg.norm(across[:2]))


def _side(low: float, high: float) -> str:
    return _metres(low) if low == high else f"{_metres(low)}-{_metres(high)}"


def _metres(value: float) -> str:
    """A length to the decimetre; one below a metre to two digits."""
    return f"{value:.1f}" if value >= 1 else f"{value:.2g}"
