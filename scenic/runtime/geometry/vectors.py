"""Products of vectors ``(..., 3)``, with the sums written out, so that no row depends on its batch."""

import numpy as np

from scenic.runtime.geometry.poses import Floats


def dot(a: Floats, b: Floats) -> Floats:
    """Return the inner products ``(...)`` of vectors."""
    result: Floats = a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]
    return result


def length(a: Floats) -> Floats:
    """Return the lengths ``(...)`` of vectors."""
    return np.sqrt(dot(a, a))


def cross(a: Floats, b: Floats) -> Floats:
    """Cross products, ``(..., 3)``."""
    return np.stack(
        [
            a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1],
            a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
            a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0],
        ],
        axis=-1,
    )
