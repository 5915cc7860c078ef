"""The first hits of rays through the pixels of an image."""

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.camera import Camera
from scenic.formats.mesh_instances import Array
from scenic.formats.stage import GROUND, SKY, Stage
from scenic.runtime.geometry.meshes.embree import RayScene, Singles

Groups = npt.NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class Buffer:
    """An entry for each pixel, each array of shape ``(height, width)``.

    Attributes:
        triangle: the triangle seen, -1 where there is none.
        nearness: one over its distance along the camera's axis, per metre; 0 where there is none.
        second: weight of the triangle's second corner.
        third: weight of its third corner.

    """

    triangle: Groups
    nearness: Singles
    second: Singles
    third: Singles


@dataclass(frozen=True, slots=True)
class Seen:
    """The first hits of some rays: objects, ground or sky; an entry for each ray.

    Attributes:
        directions: of the rays, ``(n, 3)``.
        triangle: -1 where it is none of an object, ``(n,)``.
        nearness: one over the lengths of the direction to it; 0 for the sky.
        second: weight of the triangle's second corner.
        third: weight of its third corner.
        group: number of the surface (`Stage.face_group`), or `GROUND` or `SKY`.

    """

    directions: Singles
    triangle: Groups
    nearness: Singles
    second: Singles
    third: Singles
    group: Groups

    def take(self, index: npt.NDArray[np.intp]) -> "Seen":
        """Return some of the entries."""
        return Seen(
            self.directions[index],
            self.triangle[index],
            self.nearness[index],
            self.second[index],
            self.third[index],
            self.group[index],
        )

    def replace(self, index: npt.NDArray[np.intp], other: "Seen") -> None:
        """Put other hits in the place of some entries, for rays of the same directions."""
        for name in ("triangle", "nearness", "second", "third", "group"):
            getattr(self, name)[index] = getattr(other, name)


class Lens:
    """Rays through an image of a size.

    Attributes:
        width: columns of pixels.
        height: rows of pixels.
        eye: where the rays start, relative to the middle of the scene, ``(3,)``.
        ahead: unit vector along the camera's axis, ``(3,)``.
        pixel: angle between two pixels in the middle of the image, radians.

    """

    def __init__(self, camera: Camera, center: Array, size: tuple[int, int]) -> None:
        self.width, self.height = size
        self.eye = (camera.eye - center).astype(np.float32)
        self.pixel = 2 * camera.tangents[1] / self.height
        self._across = camera.right * camera.tangents[0]
        self._upward = camera.up * camera.tangents[1]
        self.ahead = camera.ahead.astype(np.float32)

    def directions(self, x: npt.NDArray[np.float32], y: npt.NDArray[np.float32]) -> Singles:
        """Return directions ``(..., 3)``, 1 long along the camera's axis, through places in pixels; x and y broadcast."""
        right = (2 * x / np.float32(self.width) - 1).astype(np.float32)
        up = (1 - 2 * y / np.float32(self.height)).astype(np.float32)
        result = np.empty((*np.broadcast_shapes(x.shape, y.shape), 3), np.float32)
        for axis in range(3):
            sideways = np.float32(self._across[axis]) * right + self.ahead[axis]
            np.add(sideways, np.float32(self._upward[axis]) * up, out=result[..., axis])
        return result

    def through(self, pixels: npt.NDArray[np.intp]) -> Singles:
        """Return directions ``(n, 3)`` through the middles of pixels, numbered row by row."""
        row, column = np.divmod(pixels, self.width)
        return self.directions(
            column.astype(np.float32) + np.float32(0.5), row.astype(np.float32) + np.float32(0.5)
        )

    def through_all(self, step: int) -> Singles:
        """Return directions ``(rows, columns, 3)`` through the middles of every ``step``-th pixel of every such row."""
        x = np.arange(0, self.width, step, dtype=np.float32) + np.float32(0.5)
        y = np.arange(0, self.height, step, dtype=np.float32) + np.float32(0.5)
        return self.directions(x, y[:, None])


def seen(lens: Lens, rays: RayScene) -> Buffer:
    """Return the hit of the ray through the middle of each pixel."""
    directions = lens.through_all(1)
    hits = rays.first_hits(_repeated(lens.eye, directions.size // 3), directions.reshape(-1, 3))
    parts = (hits.triangle, np.float32(1) / hits.distance, hits.second, hits.third)
    return Buffer(*(part.reshape(lens.height, lens.width) for part in parts))  # type: ignore[arg-type] # in that order


def look(stage: Stage, eye: Singles, directions: Singles) -> Seen:
    """Return the first hits of rays from an eye ``(3,)`` or eyes ``(n, 3)`` in directions ``(n, 3)``."""
    hits = stage.rays.first_hits(_repeated(eye, len(directions)), directions)
    return grounded(
        stage, eye, directions, hits.triangle, np.float32(1) / hits.distance, hits.second, hits.third
    )


def grounded(
    stage: Stage,
    eye: Singles,
    directions: Singles,
    triangle: Groups,
    nearness: Singles,
    second: Singles,
    third: Singles,
) -> Seen:
    """Return the same of what is known of objects: rays that meet none and fall end on the ground."""
    group = stage.group_of(triangle)
    fall = np.float32(stage.ground) - eye[..., 2]
    below = falls(stage, eye, directions) & (triangle < 0)
    group[below] = GROUND
    drop = fall if eye.ndim == 1 else fall[below]
    nearness[below] = directions[below, 2] / drop
    return Seen(directions, triangle, nearness, second, third, group)


def falls(stage: Stage, eye: Singles, directions: Singles) -> npt.NDArray[np.bool_]:
    """Return whether rays reach the ground if nothing else stops them, ``(n,)``."""
    return np.asarray((directions[:, 2] < -1e-6) & (eye[..., 2] > stage.ground))


def first_groups(stage: Stage, eye: Singles, directions: Singles) -> Groups:
    """Return the surfaces alone that rays from one eye meet first."""
    group = stage.group_of(stage.rays.first_triangles(eye, directions))
    group[(group == SKY) & falls(stage, eye, directions)] = GROUND
    return group


def _repeated(eye: Singles, count: int) -> Singles:
    return np.broadcast_to(eye, (count, 3))
