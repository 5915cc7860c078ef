"""Pictures of scenes without a display: rays are cast at the meshes, for sight, shadow and ambient light.

Light that many rays estimate (soft shadow, ambient occlusion) is sampled sparsely, with another pattern in each of
4 by 4 neighbouring pixels, and smoothed over such blocks where they show one smooth surface. Pixels at edges are
sampled again several times. Everything is deterministic.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.formats.camera import Camera, corners, framing, ground_height
from scenic.formats.instances import Array, Instance, Picture
from scenic.formats.poses import rotation_matrix
from scenic.runtime.geometry.embree import RayScene
from scenic.runtime.geometry.embree import Singles as Floats

SIZE: Final = (960, 720)

_BLOCK: Final = 4
_AMBIENT_RAYS: Final = 6
_SUN_RAYS: Final = 2
_EDGE_SAMPLES: Final = 12
_CHUNK: Final = 1 << 18
_LAYERS: Final = 4
"""So many transparent surfaces are seen through."""

_SUN_COLOR: Final = np.array([1.0, 0.96, 0.9], np.float32) * 0.95
_SKY_COLOR: Final = np.array([0.86, 0.93, 1.0], np.float32) * 0.62
_BOUNCE_COLOR: Final = np.array([1.0, 0.95, 0.88], np.float32) * 0.34
_GROUND_COLOR: Final = np.array([0.80, 0.81, 0.83], np.float32)
_LINE_COLOR: Final = np.array([0.55, 0.57, 0.61], np.float32)
_HORIZON: Final = np.array([0.90, 0.92, 0.95], np.float32)
_ZENITH: Final = np.array([0.74, 0.82, 0.91], np.float32)

_GROUND: Final = -1
_SKY: Final = -2


@dataclass(frozen=True, slots=True)
class _Seen:
    """What rays see: object index (or ground, or sky), place, normal, colour and opacity, an entry per ray."""

    thing: npt.NDArray[np.int32]
    place: Floats
    normal: Floats
    color: Floats
    alpha: Floats
    distance: Floats


class _Stage:
    """One scene made ready for rays; coordinates are relative to the middle of the scene."""

    def __init__(self, picture: Picture, instances: Sequence[Instance]) -> None:
        points = corners(instances)
        self.center = (points.min(axis=0) + points.max(axis=0)) / 2
        self.reach = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
        self.ground = ground_height(points) - self.center[2]
        triangles, normals, owners = [np.zeros((0, 3, 3))], [np.zeros((0, 3, 3))], [np.zeros(0, np.int32)]
        for index, instance in enumerate(instances):
            surface = picture.surfaces[instance.surface]
            matrix = instance.matrix()
            world = surface.vertices @ matrix[:3, :3].T + (matrix[:3, 3] - self.center)
            turned = surface.normals / instance.size @ rotation_matrix(instance.quaternion).T
            turned /= np.linalg.norm(turned, axis=1, keepdims=True)
            triangles.append(world[surface.faces])
            normals.append(turned[surface.faces])
            owners.append(np.full(len(surface.faces), index, np.int32))
        self.triangles = np.concatenate(triangles).astype(np.float32)
        self.normals = np.concatenate(normals).astype(np.float32)
        self.owners = np.concatenate(owners)
        rgba = np.array([instance.color for instance in instances], np.float32).reshape(-1, 4)
        self.colors = _linear(rgba[:, :3])
        self.alphas = rgba[:, 3]
        self.rays = RayScene(self.triangles)
        self.spacing = _grid_spacing(self.reach)

    def see(self, origins: Floats, directions: Floats, pixel: float) -> _Seen:
        """What rays of unit directions see; ``pixel`` is the angle between neighbouring rays."""
        hits = self.rays.first_hits(origins, directions)
        with np.errstate(divide="ignore", invalid="ignore"):
            to_ground = np.where(
                directions[:, 2] < -1e-6, (self.ground - origins[:, 2]) / directions[:, 2], np.inf
            ).astype(np.float32)
        to_ground[to_ground <= 0] = np.inf
        distance = np.minimum(hits.distance, to_ground)
        hit = hits.triangle >= 0
        thing = np.where(
            hits.distance <= to_ground, self.owners[hits.triangle] if len(self.owners) else _SKY, _GROUND
        )
        thing = np.where(np.isfinite(distance), thing, _SKY).astype(np.int32)
        safe = np.where(np.isfinite(distance), distance, 0).astype(np.float32)
        place = origins + safe[:, None] * directions
        normal = np.zeros_like(place)
        normal[:, 2] = 1
        color = np.zeros_like(place)
        alpha = np.ones(len(place), np.float32)
        on_thing = hit & (thing >= 0)
        index = hits.triangle[on_thing]
        second, third = hits.second[on_thing, None], hits.third[on_thing, None]
        corner = self.normals[index]
        smooth = (1 - second - third) * corner[:, 0] + second * corner[:, 1] + third * corner[:, 2]
        smooth /= np.maximum(np.sqrt(np.einsum("ij,ij->i", smooth, smooth)), 1e-6)[:, None]
        away = np.einsum("ij,ij->i", smooth, directions[on_thing]) > 0
        smooth[away] *= -1
        normal[on_thing] = smooth
        color[on_thing] = self.colors[thing[on_thing]]
        alpha[on_thing] = self.alphas[thing[on_thing]]
        on_ground = thing == _GROUND
        if on_ground.any():
            color[on_ground] = self._ground_color(
                place[on_ground], directions[on_ground], safe[on_ground], pixel
            )
        return _Seen(thing, place, normal, color, alpha, safe)

    def _ground_color(self, place: Floats, directions: Floats, distance: Floats, pixel: float) -> Floats:
        """The grid on the ground: lines a pixel or two wide at any distance, that fade where they crowd."""
        color = np.broadcast_to(_linear(_GROUND_COLOR), place.shape).copy()
        footprint = distance * pixel / np.maximum(-directions[:, 2], 0.05)
        for spacing, strength in ((self.spacing, 0.35), (self.spacing * 5, 0.7)):
            cover = np.zeros(len(place), np.float32)
            for axis in (0, 1):
                position = (place[:, axis] + np.float32(self.center[axis])) / spacing
                away = np.abs(position - np.round(position)) * spacing
                cover = np.maximum(cover, np.clip(1.2 - away / footprint, 0, 1))
            cover *= strength * np.clip(1.5 - 6 * footprint / spacing, 0, 1)
            color += cover[:, None] * (_linear(_LINE_COLOR) - color)
        return color.astype(np.float32)

    def fade(self, seen: _Seen) -> Floats:
        """How much the ground at each place goes over into the sky's colour, from 0 to 1."""
        away = np.hypot(seen.place[:, 0], seen.place[:, 1]) / (1.2 * self.reach)
        return np.where(seen.thing == _GROUND, np.clip((away - 0.5) / 1.0, 0, 1) ** 0.8, 0).astype(np.float32)


def render(picture: Picture, number: int, size: tuple[int, int] = SIZE) -> npt.NDArray[np.uint8]:
    """An image of scene ``number`` of the picture; shape ``(height, width, 3)``, sRGB."""
    width, height = size
    instances = picture.scenes[number]
    camera = framing(instances, width / height)
    stage = _Stage(picture, instances)
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    image, edges = _first_pass(stage, camera, columns.reshape(-1), rows.reshape(-1), size)
    _refine(stage, camera, image, np.flatnonzero(edges), size)
    return _encode(image).reshape(height, width, 3)


def _rays(
    stage: _Stage, camera: Camera, x: Array, y: Array, size: tuple[int, int]
) -> tuple[Floats, Floats, float]:
    """Rays through image positions in pixels."""
    width, height = size
    directions = camera.directions(2 * x / width - 1, 1 - 2 * y / height).astype(np.float32)
    origins = np.broadcast_to((camera.eye - stage.center).astype(np.float32), directions.shape)
    return origins, directions, 2 * camera.tangents[1] / height


def _first_pass(
    stage: _Stage,
    camera: Camera,
    columns: npt.NDArray[np.int64],
    rows: npt.NDArray[np.int64],
    size: tuple[int, int],
) -> tuple[Floats, npt.NDArray[np.bool_]]:
    """One ray a pixel; returns colours, shape ``(n, 3)``, in linear light, and which pixels are at edges."""
    width, height = size
    origins, directions, pixel = _rays(stage, camera, np.add(columns, 0.5), np.add(rows, 0.5), size)
    seen = stage.see(origins, directions, pixel)
    pattern = (rows % _BLOCK) * _BLOCK + columns % _BLOCK
    sun, ambient = _light(stage, seen, pattern)
    edges = _edges(seen, directions, size)
    sun, ambient = _smoothed(np.stack([sun, ambient]), seen, size)
    image = _shade(stage, seen, directions, sun, ambient)
    see_through = seen.alpha < 1
    edges |= _grown(see_through.reshape(height, width)).reshape(-1) & see_through
    return image, edges


def _refine(
    stage: _Stage, camera: Camera, image: Floats, pixels: npt.NDArray[np.int64], size: tuple[int, int]
) -> None:
    """Sample pixels again at several places each; the image is changed in place."""
    step = max(1, _CHUNK // _EDGE_SAMPLES)
    offsets = _sequence(_EDGE_SAMPLES)
    for start in range(0, len(pixels), step):
        part = pixels[start : start + step]
        x = (part % size[0])[:, None] + offsets[:, 0]
        y = (part // size[0])[:, None] + offsets[:, 1]
        pattern = np.tile(np.arange(_EDGE_SAMPLES), len(part)) % _BLOCK**2
        origins, directions, pixel = _rays(stage, camera, x.reshape(-1), y.reshape(-1), size)
        colors = _color(stage, origins, directions, pixel, pattern, _LAYERS)
        image[part] = colors.reshape(len(part), _EDGE_SAMPLES, 3).mean(axis=1)


def _color(
    stage: _Stage,
    origins: Floats,
    directions: Floats,
    pixel: float,
    pattern: npt.NDArray[np.int64],
    layers: int,
) -> Floats:
    """Colours that rays see, through transparent surfaces too."""
    seen = stage.see(origins, directions, pixel)
    sun, ambient = _light(stage, seen, pattern)
    color = _shade(stage, seen, directions, sun, ambient)
    through = np.flatnonzero(seen.alpha < 1)
    if len(through) and layers:
        alpha = seen.alpha[through, None]
        beyond = seen.place[through] + directions[through] * np.float32(stage.reach * 1e-4)
        behind = _color(stage, beyond, directions[through], pixel, pattern[through], layers - 1)
        color[through] = alpha * color[through] + (1 - alpha) * behind
    return color


def _shade(stage: _Stage, seen: _Seen, directions: Floats, sun: Floats, ambient: Floats) -> Floats:
    upward = seen.normal[:, 2:3] * 0.5 + 0.5
    light = sun[:, None] * _SUN_COLOR
    light = light + ambient[:, None] * (upward * _SKY_COLOR + (1 - upward) * _BOUNCE_COLOR)
    sky = _sky(directions)
    color: Floats = np.where((seen.thing == _SKY)[:, None], sky, seen.color * light)
    return (color + stage.fade(seen)[:, None] * (sky - color)).astype(np.float32)


def _sky(directions: Floats) -> Floats:
    """A pale gradient; below the horizon it is the horizon's colour."""
    up = np.clip(directions[:, 2:3] * 2, 0, 1)
    return (_linear(_HORIZON) * (1 - up) + _linear(_ZENITH) * up).astype(np.float32)


def _light(stage: _Stage, seen: _Seen, pattern: npt.NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Estimates of sunlight received and of open sky, in [0, 1] each, for every place seen."""
    sun = np.zeros(len(seen.thing), np.float32)
    ambient = np.ones(len(seen.thing), np.float32)
    lit = np.flatnonzero(seen.thing != _SKY)
    for start in range(0, len(lit), _CHUNK):
        part = lit[start : start + _CHUNK]
        normal = seen.normal[part]
        place = seen.place[part] + normal * np.float32(stage.reach * 2e-4)
        sun[part] = _sunlight(stage, place, normal, pattern[part])
        ambient[part] = _openness(stage, place, normal, pattern[part])
    return sun, ambient


def _sunlight(stage: _Stage, place: Floats, normal: Floats, pattern: npt.NDArray[np.int64]) -> Floats:
    """Light of a sun that is a small disc, in the west-south-west."""
    middle = np.array([-0.55, -0.33, 0.77])
    middle /= np.linalg.norm(middle)
    side = np.cross(middle, [0, 0, 1])
    side /= np.linalg.norm(side)
    points = _sequence(_SUN_RAYS * _BLOCK**2)
    radius, angle = 0.035 * np.sqrt(points[:, 0]), 2 * np.pi * points[:, 1]
    disc = (
        middle
        + np.outer(radius * np.cos(angle), side)
        + np.outer(radius * np.sin(angle), np.cross(middle, side))
    )
    table = (disc / np.linalg.norm(disc, axis=1, keepdims=True)).astype(np.float32)
    facing = np.maximum(normal @ middle.astype(np.float32), 0)
    total = np.zeros(len(place), np.float32)
    lit = np.flatnonzero(facing > 0)
    for k in range(_SUN_RAYS):
        directions = table[(pattern[lit] * 7 + k * _BLOCK**2) % len(table)]
        total[lit] += ~stage.rays.blocked(place[lit], directions)
    return (facing * total / _SUN_RAYS).astype(np.float32)


def _openness(stage: _Stage, place: Floats, normal: Floats, pattern: npt.NDArray[np.int64]) -> Floats:
    """The part of the sky, weighed by the cosine, that nothing near hides; the ground hides the lower half."""
    points = _sequence(_AMBIENT_RAYS * _BLOCK**2)
    z = 2 * points[:, 0] - 1
    angle = 2 * np.pi * points[:, 1]
    ring = np.sqrt(1 - z * z)
    ball = np.column_stack([ring * np.cos(angle), ring * np.sin(angle), z]).astype(np.float32)
    total = np.zeros(len(place), np.float32)
    for k in range(_AMBIENT_RAYS):
        # A point on the unit sphere about the tip of the normal is distributed by the cosine.
        directions = normal * np.float32(1.001) + ball[(pattern * 5 + k * _BLOCK**2) % len(ball)]
        total += ~stage.rays.blocked(place, directions, stage.reach * 0.25)
    return (total / _AMBIENT_RAYS).astype(np.float32)


def _edges(seen: _Seen, directions: Floats, size: tuple[int, int]) -> npt.NDArray[np.bool_]:
    """Pixels whose neighbours show another object, a sharp edge or a jump in depth."""
    width, height = size
    thing = seen.thing.reshape(height, width)
    normal = seen.normal.reshape(height, width, 3)
    slope = np.einsum("ij,ij->i", seen.normal, directions).reshape(height, width)
    depth = seen.distance.reshape(height, width)
    edges = np.zeros((height, width), dtype=bool)
    for first, second in (
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
    ):
        bent = np.einsum("ijk,ijk->ij", normal[first], normal[second]) < 0.9
        steep = np.minimum(np.abs(slope[first]), np.abs(slope[second]))
        jump = np.abs(depth[first] - depth[second]) * steep > 0.01 * depth[first]
        change = (thing[first] != thing[second]) | ((bent | jump) & (thing[first] != _SKY))
        edges[first] |= change
        edges[second] |= change
    return edges.reshape(-1)


def _grown(mask: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    grown = mask.copy()
    grown[1:] |= mask[:-1]
    grown[:-1] |= mask[1:]
    return grown


def _smoothed(values: Floats, seen: _Seen, size: tuple[int, int]) -> tuple[Floats, Floats]:
    """Means over 4 by 4 pixels, first along rows and then along columns, within one smooth surface."""
    width, height = size
    layers = values.reshape(2, height, width)
    thing = seen.thing.reshape(height, width)
    normal = seen.normal.reshape(height, width, 3)
    for axis in (0, 1):
        total, weight = layers.copy(), np.ones((height, width), np.float32)
        for shift in (-2, -1, 1, 2):
            near = _shifted(thing, shift, axis) == thing
            near &= np.einsum("ijk,ijk->ij", _shifted(normal, shift, axis), normal) > 0.95
            # Five neighbours make four: the outer two count half.
            share = near * np.float32(0.5 if abs(shift) == 2 else 1)
            total += share * _shifted(layers, shift, axis + 1)
            weight += share
        layers = total / weight
    return layers[0].reshape(-1), layers[1].reshape(-1)


def _shifted(values: npt.NDArray[Any], shift: int, axis: int) -> npt.NDArray[Any]:
    index = np.clip(np.arange(values.shape[axis]) + shift, 0, values.shape[axis] - 1)
    return np.take(values, index, axis=axis)


def _sequence(count: int) -> Array:
    """Evenly spread points of the unit square, shape ``(count, 2)``: Roberts's R2 sequence."""
    root = 1.32471795724474602596  # the real root of x**3 = x + 1
    return np.asarray((0.5 + np.outer(np.arange(1, count + 1), [1 / root, 1 / root**2])) % 1)


def _grid_spacing(reach: float) -> float:
    """One, two or five times a power of ten metres, so that a scene has some twenty lines."""
    power = 10.0 ** np.floor(np.log10(reach / 12))
    return float(
        min((step for step in (1, 2, 5, 10)), key=lambda step: abs(np.log(step * power * 12 / reach))) * power
    )


def _linear(srgb: Floats) -> Floats:
    """Components in sRGB as linear light (IEC 61966-2-1)."""
    values = np.asarray(srgb, np.float32)
    return np.where(
        values <= 0.04045, values / 12.92, ((np.maximum(values, 0) + 0.055) / 1.055) ** 2.4
    ).astype(np.float32)


def _encode(light: Floats) -> npt.NDArray[np.uint8]:
    """Linear light as 8-bit sRGB."""
    values = np.clip(light, 0, 1)
    srgb = np.where(values <= 0.0031308, values * 12.92, 1.055 * values ** (1 / 2.4) - 0.055)
    return (srgb * 255 + 0.5).astype(np.uint8)
