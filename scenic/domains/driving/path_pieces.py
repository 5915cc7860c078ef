"""Parts of paths: points of a smooth curve with its direction and curvature, along lanes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.domains.driving.path_smoothing import curvatures_of, headings_of

__all__ = ["PathPiece", "piece_along"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PathPiece:
    """A part of a path: points with the direction and curvature of the curve.

    Attributes:
        points: ``(n, 2)``, in metres.
        headings: ``(n,)``, radians, anticlockwise from north, without jumps.
        curvatures: ``(n,)``, in 1/m, positive to the left.
        lanes: the lanes of the piece, with the index of the first point of each.

    """

    points: Floats
    headings: Floats
    curvatures: Floats
    lanes: tuple[tuple[int, Any], ...]


def piece_along(
    points: Floats, lanes: Sequence[tuple[int, Any]] = (), *, cut: tuple[int, int] = (0, 0)
) -> PathPiece:
    """The piece along points of a smooth curve.

    Args:
        points: ``(n, 2)``, about half a metre apart.
        lanes: lanes, with the index of the first point of each.
        cut: numbers of points to leave out at both ends, after curvatures have been computed.

    """
    steps = headings_of(points)
    headings = np.concatenate([steps[:1], (steps[:-1] + steps[1:]) / 2, steps[-1:]])
    remaining = slice(cut[0], len(points) - cut[1])
    return PathPiece(
        points[remaining],
        headings[remaining],
        curvatures_of(points)[remaining],
        tuple((max(0, index - cut[0]), lane) for index, lane in lanes),
    )
