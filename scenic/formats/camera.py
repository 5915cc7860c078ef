"""The viewpoint of an image, and the ground below the objects."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from scenic.dataclass import dataclass
from scenic.formats.mesh_instances import Array, MeshInstance
from scenic.formats.regions import bounds as workspace_bounds
from scenic.formats.scene_protocols import Scene

FIELD_OF_VIEW = np.radians(38)
"""The vertical opening angle."""
MARGIN = 1.06

_UNIT_CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))


@dataclass(frozen=True, slots=True)
class Outlook:
    """The viewpoint of a picture of a scene.

    Attributes:
        azimuth: in which direction the camera stands, degrees, anticlockwise from due south seen from above: negative
            to the west of south as the camera looks north.
        elevation: how far above the horizon it stands, degrees; 90 is straight above.
        workspace: whether the whole workspace is in the picture, if it is bounded, and not just the objects; so
            pictures of one program all show the same part of the world.
        follow: the object with which the camera goes, by the name of its variable or its number; the azimuth then is that
            from behind it, and turns with it.
        reach: metres around that object that are in the picture; by default by its size.

    """

    azimuth: float = -35.0
    elevation: float = 33.0
    workspace: bool = True
    follow: str | int | None = None
    reach: float | None = None


STANDARD = Outlook()


@dataclass(frozen=True, slots=True)
class Camera:
    """A perspective camera.

    ``eye`` is its place; ``right``, ``up`` and ``ahead`` are unit vectors, each of shape ``(3,)``; ``tangents`` are
    the tangents of half the horizontal and vertical opening angles.
    """

    eye: Array
    right: Array
    up: Array
    ahead: Array
    tangents: tuple[float, float]

    def directions(self, x: Array, y: Array) -> Array:
        """Unit vectors, shape ``(n, 3)``, through points of the image plane with coordinates in ``[-1, 1]``."""
        rays = (
            self.ahead
            + (x * self.tangents[0])[:, None] * self.right
            + (y * self.tangents[1])[:, None] * self.up
        )
        rays /= np.sqrt(np.einsum("ij,ij->i", rays, rays))[:, None]
        return np.asarray(rays)


def corners(instances: Sequence[MeshInstance]) -> Array:
    """Return corners of the objects' boxes, shape ``(8 n, 3)``; of a unit box at the origin if there are none."""
    if not instances:
        return _UNIT_CORNERS
    return np.concatenate(
        [_UNIT_CORNERS @ (matrix := instance.matrix())[:3, :3].T + matrix[:3, 3] for instance in instances]
    )


def ground_height(points: Array) -> float:
    """The height of the ground below points: 0, unless they reach below it or are all far above it."""
    low, extent = points[:, 2].min(), np.ptp(points, axis=0).max()
    return float(low if low < 0 or low > 4 * extent else 0.0)


def framed(scene: Scene, instances: Sequence[MeshInstance], outlook: Outlook) -> Array:
    """The points that a picture of a scene has to show, ``(n, 3)``: corners of objects, and of the workspace."""
    points = corners(instances)
    if (least := getattr(scene.workspace, "minimumZoomSize", 0.0)) > 0:
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        points = np.concatenate([points, middle + _UNIT_CORNERS * [least, least, 0.0]])
    bounds = workspace_bounds(scene.workspace) if outlook.workspace else None
    if bounds is None:
        return points
    low, high = bounds
    low[2], high[2] = np.minimum(low[2], points[:, 2].min()), np.maximum(high[2], points[:, 2].max())
    around = _UNIT_CORNERS * (high - low) + (low + high) / 2
    return np.concatenate([points, around])


def framing(points: Array, aspect: float, outlook: Outlook = STANDARD) -> Camera:
    """Return the nearest camera of a direction that sees all points ``(n, 3)``.

    A point with coordinates (r, u, a) along right, up and ahead is in sight of an eye at (R, U, A) if
    ``|r - R| <= t (a - A)`` for the tangent t, and likewise for u: linear bounds on the eye, whose largest A is wanted.
    """
    azimuth, elevation = np.radians(outlook.azimuth), np.radians(outlook.elevation)
    ahead = np.array(
        [np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), -np.sin(elevation)]
    )
    right = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    up = np.cross(right, ahead)
    vertical = float(np.tan(FIELD_OF_VIEW / 2))
    tangents = (vertical * aspect, vertical)
    basis = np.stack([right, up, ahead])
    local = points @ basis.T
    lower, upper, nearest = [], [], []
    for axis, tangent in enumerate(tangents):
        tangent /= MARGIN
        low = np.max(local[:, axis] - tangent * local[:, 2])
        high = np.min(local[:, axis] + tangent * local[:, 2])
        lower.append((low, tangent))
        upper.append((high, tangent))
        nearest.append((high - low) / (2 * tangent))
    depth = min(nearest)
    sides = [
        (low + tangent * depth + high - tangent * depth) / 2
        for (low, tangent), (high, _) in zip(lower, upper, strict=True)
    ]
    eye = np.array([*sides, depth]) @ basis
    return Camera(eye, right, up, ahead, tangents)
