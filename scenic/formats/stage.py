"""One scene made ready for rays: its triangles with what they look like in sunlight and under the open sky.

Light is the sum of two parts, each a colour for every corner of a triangle times a share in [0, 1] that rays
estimate: what the sun gives where nothing stands before it, and what the sky and the ground give where nothing is near.
Coordinates are relative to the middle of the scene, which keeps single precision fine.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.camera import corners, ground_height
from scenic.formats.colors import linear
from scenic.formats.mesh_instances import Array, GroundPiece, MeshInstance, MeshSurface
from scenic.formats.poses import rotation_matrix
from scenic.formats.scenery import USUAL, Scenery
from scenic.formats.textures import ImageTexture, Texture, TextureError, texture_of
from scenic.runtime.geometry.meshes.embree import RayScene, Singles

GROUND: Final = -1
SKY: Final = -2

_SUN_COLOR: Final = np.array([1.0, 0.96, 0.9]) * 0.95
_SKY_COLOR: Final = np.array([0.86, 0.93, 1.0]) * 0.62
_BOUNCE_COLOR: Final = np.array([1.0, 0.95, 0.88]) * 0.34
_SUN_RADIUS: Final = 0.035

SUN_SAMPLES: Final = 64
SKY_SAMPLES: Final = 256


class Stage:
    """The triangles of a scene, and the light on them.

    Args:
        surfaces: the meshes.
        instances: the objects.
        scenery: where light comes from.
        pieces: parts of the ground with colours of their own.
        around: points ``(n, 3)`` that decide the middle and the size of the scene in place of the objects' corners.

    Attributes:
        scenery: the same.
        textures: of each instance, by its number; only of those that have one.
        center: middle of the scene in the world, ``(3,)``, the origin of all places here.
        reach: the scene's diagonal, metres.
        ground: height of the ground, relative to the center.
        owner: index of the instance of each triangle, ``(t,)``.
        normals: unit normals of the triangles, ``(t + 1, 3)``; the last is that of the ground.
        smooth: whether the normals at the corners of a triangle differ, ``(t + 1,)``.
        sunny: linear colour that the sun gives each corner, ``(t, 3, 3)``: triangle, corner, colour.
        shady: linear colour that the open sky gives each corner, likewise.
        flat: the three components of both at the first corner, ``(6, t + 1)``; 0 in the entry for no triangle.
        alphas: opacity of each instance, ``(n,)``.
        rays: the triangles, to cast rays at.

    """

    def __init__(
        self,
        surfaces: Sequence[MeshSurface],
        instances: Sequence[MeshInstance],
        scenery: Scenery = USUAL,
        pieces: Sequence[GroundPiece] = (),
        around: Array | None = None,
    ) -> None:
        self.scenery = scenery
        self._instances = instances
        self.textures = _textures(instances)
        points = corners(instances) if around is None else around
        self.center = (points.min(axis=0) + points.max(axis=0)) / 2
        self.reach = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
        low = [surfaces[piece.surface].vertices[:, 2].min() for piece in pieces if not piece.is_flat]
        # The ground lies below roads that have heights.
        lowest = min([ground_height(points), *(height - 0.1 for height in low)])
        self.ground = float(lowest) - self.center[2]
        triangles, normals, owners = [], [], []
        self._coordinates: dict[int, _Coordinates] = {}
        for index, instance in enumerate(instances):
            surface = surfaces[instance.surface]
            matrix = instance.matrix()
            world = surface.vertices @ matrix[:3, :3].T + (matrix[:3, 3] - self.center)
            world_normals = surface.normals / instance.size @ rotation_matrix(instance.quaternion).T
            world_normals /= np.sqrt(np.einsum("ij,ij->i", world_normals, world_normals))[:, None]
            triangles.append(world.astype(np.float32)[surface.faces])
            normals.append(world_normals.astype(np.float32)[surface.faces])
            owners.append(np.full(len(surface.faces), index, np.int32))
            texture = self.textures.get(index)
            if isinstance(texture, ImageTexture) and texture.projection == "mesh":
                file_coordinates = surface.coordinates(instance.thing.shape.source.as_dict())
                if file_coordinates is not None:
                    first = sum(map(len, owners[:-1]))
                    self._coordinates[index] = _Coordinates(
                        first, file_coordinates, _density(file_coordinates, triangles[-1])
                    )
        for index, piece in enumerate(pieces, len(instances)):
            surface = surfaces[piece.surface]
            world = surface.vertices - self.center
            if piece.is_flat:
                world[:, 2] = surface.vertices[:, 2] + self.ground
            triangles.append(world.astype(np.float32)[surface.faces])
            normals.append(surface.normals.astype(np.float32)[surface.faces])
            owners.append(np.full(len(surface.faces), index, np.int32))
        self.owner = np.concatenate([*owners, np.zeros(0, np.int32)])
        corner_normals = np.concatenate([*normals, np.zeros((0, 3, 3), np.float32)])
        colors = [instance.color for instance in instances] + [piece.color for piece in pieces]
        rgba = np.array(colors).reshape(-1, 4)
        self.alphas = rgba[:, 3].astype(np.float32)
        mean = corner_normals[:, 0] + corner_normals[:, 1] + corner_normals[:, 2]
        mean /= np.maximum(np.sqrt(np.einsum("ij,ij->i", mean, mean)), np.float32(1e-9))[:, None]
        self.normals = np.concatenate([mean, np.array([[0, 0, 1]], np.float32)])
        away = np.abs(corner_normals - mean[:, None]) > np.float32(1e-3)
        self.smooth = np.append(away.reshape(-1, 9).any(axis=1), False)
        # Images bring their own colours.
        rgba[[k for k, item in self.textures.items() if isinstance(item, ImageTexture)], :3] = 1
        albedo = linear(rgba[:, :3])[self.owner]
        paint_numbers = _paint([surfaces[instance.surface] for instance in instances], albedo)
        self.sunny, self.shady = _light_on(scenery, corner_normals, albedo)
        # Flat triangles are most of the pixels; entries of one array after the other are quick to take.
        flat = np.concatenate([self.sunny[:, 0], self.shady[:, 0]], axis=1).T
        self.flat = np.concatenate([flat, np.zeros((6, 1), np.float32)], axis=1)
        rough = np.rint(mean * np.float32(2)).astype(np.int32) + 2
        code = (rough[:, 0] * 5 + rough[:, 1]) * 5 + rough[:, 2]
        # Surfaces of two colours are two surfaces.
        kind = self.owner * (paint_numbers.max(initial=0) + 1) + paint_numbers
        self._groups = np.append(kind * 125 + code + 1, np.int32(SKY))
        self.rays = RayScene(np.concatenate([*triangles, np.zeros((0, 3, 3), np.float32)]))

    def group_of(self, triangle: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
        """A number for the object and the rough direction of triangles, at least 1; `SKY` for -1."""
        return np.take(self._groups, triangle)

    def pattern(
        self,
        triangle: npt.NDArray[np.int32],
        corners: tuple[Singles, Singles],
        places: Singles,
        pixel: Singles,
    ) -> Singles:
        """Return by how much textures change colours at places on instances; components ``(3, n)``.

        Args:
            triangle: the triangles, ``(n,)``.
            corners: the weights of their second and third corners, ``(n,)`` each.
            places: places on them, ``(n, 3)``.
            pixel: widths of the image's pixels there, metres, ``(n,)``.

        """
        owner = self.owner[triangle]
        factor = np.ones((3, len(owner)), np.float32)
        for number, texture in self.textures.items():
            mine = np.flatnonzero(owner == number)
            if not len(mine):
                continue
            item = self._instances[number]
            turn = rotation_matrix(item.quaternion).astype(np.float32)
            offset = (places[mine] - (np.array(item.position) - self.center).astype(np.float32)) @ turn
            own_color = linear(item.color[:3])
            if isinstance(texture, Texture):
                change = linear(texture.color) / np.maximum(own_color, np.float32(1e-3)) - np.float32(1)
                factor[:, mine] += change[:, None] * texture.share(offset)
                continue
            triangles = triangle[mine]
            coordinates, density = texture.projected(offset, self.normals[triangles] @ turn, item.size)
            blur = pixel[mine] * np.float32(density)
            if number in self._coordinates:
                second, third = (weight[mine] for weight in corners)
                file_coordinates = self._coordinates[number]
                file_values = file_coordinates.at(triangles - file_coordinates.first, second, third)
                has = ~np.isnan(file_values[:, 0])
                coordinates[has] = file_values[has]
                blur[has] = (
                    pixel[mine][has] * file_coordinates.density[triangles[has] - file_coordinates.first]
                )
            factor[:, mine] = texture.colors(own_color, coordinates, blur)
        return factor

    def sunlit(self, places: Singles, normals: Singles, pattern: npt.NDArray[np.int64], rays: int) -> Singles:
        """The share of the sun seen from places ``(n, 3)``, by a number of rays each; 0 if it is behind the surface.

        Places of another ``pattern``, ``(n,)``, use other rays; those of one are neighbours in the sequence of samples,
        and so are spread evenly by themselves.
        """
        table = _sun_directions(self.scenery.sun)
        total = np.zeros(len(places), np.float32)
        facing = np.flatnonzero(normals @ self.scenery.sun.astype(np.float32) > 0)
        start = places[facing] + normals[facing] * np.float32(self.reach * 2e-4)
        for k in range(rays):
            directions = table[(pattern[facing] * rays + k) % SUN_SAMPLES]
            total[facing] += ~self.rays.blocked(start, directions)
        result: Singles = total / np.float32(rays)
        return result

    def openness(
        self, places: Singles, normals: Singles, pattern: npt.NDArray[np.int64], rays: int
    ) -> Singles:
        """Return the part of the sky, weighed by the cosine, that nothing near hides."""
        ball = _ball()
        total = np.zeros(len(places), np.float32)
        start = places + normals * np.float32(self.reach * 2e-4)
        for k in range(rays):
            # A point on the unit sphere about the tip of the normal is distributed by the cosine.
            directions = normals * np.float32(1.001) + ball[(pattern * rays + k) % SKY_SAMPLES]
            total += ~self.rays.blocked(start, directions, self.reach * 0.25)
        result: Singles = total / np.float32(rays)
        return result


@dataclass(frozen=True, slots=True)
class _Coordinates:
    """Texture coordinates of an instance's triangles, whose first has the number ``first``.

    ``values`` has shape ``(t, 3, 2)``; ``density``, ``(t,)``, is how many of them a metre is.
    """

    first: int
    values: Singles
    density: Singles

    def at(self, triangle: npt.NDArray[np.int32], second: Singles, third: Singles) -> Singles:
        """Interpolate coordinates ``(n, 2)`` in triangles by weights of their corners; not a number where a triangle has none."""
        a, b, c = (self.values[triangle, corner] for corner in range(3))
        return np.asarray(a + second[:, None] * (b - a) + third[:, None] * (c - a), np.float32)


def _density(values: Singles, triangles: Singles) -> Singles:
    """Return texture coordinates for each metre on triangles ``(t, 3, 3)`` with coordinates ``(t, 3, 2)``; ``(t,)``."""
    u, v = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    area = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    share = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / np.maximum(area, np.float32(1e-12))
    return np.asarray(np.sqrt(share), np.float32)


def _paint(surfaces: Sequence[MeshSurface], albedo: npt.NDArray[np.float32]) -> npt.NDArray[np.int32]:
    """Give triangles of surfaces, one after the other, the linear colours of their own, in ``albedo``.

    Returns a number for each triangle ``(t,)``, 0 for those without a colour of their own, that differs between colours of a surface.
    """
    paint_numbers = np.zeros(len(albedo), np.int32)
    first = 0
    for surface in surfaces:
        paints = surface.face_paints()
        if paints is not None:
            painted_triangles = np.flatnonzero(~np.isnan(paints[:, 0]))
            albedo[first + painted_triangles] = linear(paints[painted_triangles])
            paint_numbers[first + painted_triangles] = 1 + np.unique(
                paints[painted_triangles], axis=0, return_inverse=True
            )[1].reshape(-1)
        first += len(surface.faces)
    return paint_numbers


def _textures(instances: Sequence[MeshInstance]) -> dict[int, Texture | ImageTexture]:
    """Return the textures of instances that have one, by their numbers; their files can be read."""
    texture_of_instance = {}
    for number, item in enumerate(instances):
        try:
            texture = texture_of(item.thing.properties.get("texture"), item.color, item.folder)
            if isinstance(texture, ImageTexture):
                texture.image()
        except TextureError as error:
            error.thing = item.thing
            raise
        if texture is not None:
            texture_of_instance[number] = texture
    return texture_of_instance


def ground_light(albedo: Singles, sun: Singles, sky: Singles, scenery: Scenery = USUAL) -> Singles:
    """Return linear colours ``(3, n)`` of ground of a colour, in so much of the sun's light and of the sky's, ``(n,)``."""
    sun_color, sky_color, _ = _colors(scenery)
    sunny, shady = (sun_color * scenery.sun[2]).astype(np.float32), sky_color.astype(np.float32)
    result: Singles = albedo * (sunny[:, None] * sun + shady[:, None] * sky)
    return result


def _colors(scenery: Scenery) -> tuple[Array, Array, Array]:
    """Return the linear colours of the light of the sun, of the sky and of the ground."""
    sun, sky = scenery.exposure * scenery.sunlight, scenery.exposure * scenery.skylight
    return _SUN_COLOR * sun, _SKY_COLOR * sky, _BOUNCE_COLOR * sky


def _light_on(scenery: Scenery, normals: Singles, albedo: Singles) -> tuple[Singles, Singles]:
    """Return the colours that sun and sky give the corners of triangles ``(t, 3, 3)`` of colours ``(t, 3)``."""
    facing = np.maximum(normals @ scenery.sun.astype(np.float32), 0)
    upward = normals[..., 2] * np.float32(0.5) + np.float32(0.5)
    sun, sky, bounce = (color.astype(np.float32) for color in _colors(scenery))
    sunny = (albedo * sun)[:, None] * facing[..., None]
    shady = albedo[:, None] * (bounce + upward[..., None] * (sky - bounce))
    return sunny, shady


def _sun_directions(sun: Array) -> Singles:
    """Directions to evenly spread points of the sun's disc, ``(SUN_SAMPLES, 3)``."""
    # A sun straight above has no side of its own.
    side = np.cross(sun, [0, 0, 1] if sun[2] < 1 - 1e-9 else [0, 1, 0])
    side /= np.linalg.norm(side)
    points = sequence(SUN_SAMPLES)
    radius, angle = _SUN_RADIUS * np.sqrt(points[:, 0]), 2 * np.pi * points[:, 1]
    disc = (
        sun + np.outer(radius * np.cos(angle), side) + np.outer(radius * np.sin(angle), np.cross(sun, side))
    )
    result: Singles = (disc / np.linalg.norm(disc, axis=1, keepdims=True)).astype(np.float32)
    return result


def _ball() -> Singles:
    """Evenly spread points of the unit sphere, ``(SKY_SAMPLES, 3)``."""
    points = sequence(SKY_SAMPLES)
    z = 2 * points[:, 0] - 1
    angle = 2 * np.pi * points[:, 1]
    ring = np.sqrt(1 - z * z)
    return np.column_stack([ring * np.cos(angle), ring * np.sin(angle), z]).astype(np.float32)


def sequence(count: int) -> Array:
    """Evenly spread points of the unit square, shape ``(count, 2)``: Roberts's R2 sequence."""
    root = 1.32471795724474602596  # the real root of x**3 = x + 1
    return np.asarray((0.5 + np.outer(np.arange(1, count + 1), [1 / root, 1 / root**2])) % 1)
