"""Poses in which a thrown solid comes to rest on a plane, with their probabilities.

A solid rests on a face of its convex hull above which its centre of mass is. The probability of a face is the share of orientations
from which the solid, let go without speed, ends on the face (K. Goldberg and others, "Part pose statistics", 1999), as trimesh
computes it.
"""

from functools import lru_cache
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats

__all__ = ["StablePoses", "stable_poses"]

_FIRM: Final = np.radians(3.0)
"""Poses that a smaller tilt would end are left out, if others are left."""

_MOST: Final = 256
"""Poses that are kept, the likeliest ones: a fine sphere has thousands."""


@dataclass(frozen=True, slots=True, eq=False)
class StablePoses:
    """The stable poses of a solid of one size.

    Attributes:
        shares: cumulative probabilities ``(p,)``; the last is 1.
        pitches: angles about X ``(p,)``, radians, before a rotation about the vertical.
        rolls: angles about Y ``(p,)``, radians, before the pitch.
        lifts: heights of the middle of the solid's box above the plane ``(p,)``, in units of its width.

    """

    shares: Floats
    pitches: Floats
    rolls: Floats
    lifts: Floats


@lru_cache(maxsize=512)
def stable_poses(mesh: Mesh, length: float, height: float) -> StablePoses:
    """The stable poses of a unit mesh at width 1 and the given length and height, of one density."""
    import trimesh  # slow to import

    solid: Any = trimesh.Trimesh(mesh.vertices * (1.0, length, height), np.asarray(mesh.faces), process=False)
    matrices, shares = trimesh.poses.compute_stable_poses(solid)
    points = solid.convex_hull.vertices
    middle = np.asarray(solid.center_mass)
    firm = np.array([_margin(matrix[:3, :3], points, middle) for matrix in matrices])
    kept = np.flatnonzero(firm >= min(_FIRM, firm.max()))
    kept = kept[np.argsort(-shares[kept], kind="stable")][:_MOST]
    turns = matrices[kept, :3, :3]
    pitches = np.arcsin(np.clip(turns[:, 2, 1], -1, 1))
    rolls = np.arctan2(-turns[:, 2, 0], turns[:, 2, 2])
    # The lowest row of the rotation by pitch and roll: heights of points above the middle of the box.
    rows = np.stack(
        [-np.cos(pitches) * np.sin(rolls), np.sin(pitches), np.cos(pitches) * np.cos(rolls)], axis=-1
    )
    lifts = -(rows @ points.T).min(axis=1)
    cumulative = np.cumsum(shares[kept])
    cumulative /= cumulative[-1]
    return StablePoses(cumulative, pitches, rolls, lifts)


def _margin(turn: Floats, points: Floats, middle: Floats) -> float:
    """The least tilt, in radians, after which a solid in a pose falls over."""
    from scipy.spatial import ConvexHull, QhullError  # slow to import

    places = points @ turn.T
    low = places[:, 2].min()
    feet = places[places[:, 2] < low + 1e-6 * np.ptp(places)][:, :2]
    centre = turn @ middle
    try:
        edges = ConvexHull(feet).equations
    except QhullError:  # it stands on an edge or a point
        return 0.0
    # Distances to the edges of the support, negative inside.
    inside = -float((edges[:, :2] @ centre[:2] + edges[:, 2]).max())
    return float(np.arctan2(inside, centre[2] - low))
