"""Pictures of scenes without a display: rays are cast at the meshes, for sight, shadow and ambient light.

An image is first made *coarse*, of every other pixel of every other row, with a ray for each of them. The pixels between
two that show one surface in nearly one colour take the mean of both; the others, its *details*, get rays of their own.
What is thinner than two pixels may have gaps, unless the caller knows what every pixel shows. Edges are smoothed by more
rays for sight alone. Everything is deterministic.
"""

from collections.abc import Callable
from typing import Final, TypeVar

import numpy as np
import numpy.typing as npt

from scenic.formats.backdrop import ground_color, sky_color
from scenic.formats.buffers import Buffer, Groups, Lens, Seen, first_groups, grounded, look
from scenic.formats.camera import Camera, corners, framing
from scenic.formats.colors import decoded, encoded
from scenic.formats.lighting import Index, Light, coarse_light, fine_light, own_light
from scenic.formats.mesh_instances import Array, Picture
from scenic.formats.scenery import scenery_of
from scenic.formats.stage import GROUND, SKY, Stage
from scenic.runtime.geometry.meshes.embree import Singles

_Scalar = TypeVar("_Scalar", bound=np.generic)
Bytes = npt.NDArray[np.uint8]
Mask = npt.NDArray[np.bool_]

SIZE: Final = (960, 720)

_NEARLY: Final = 8
"""Colours that differ by so much of 255 at most are nearly one."""
_JUMP: Final = 0.03
"""So much, in parts, one over the depth departs from a line where a surface is torn."""
_LAYERS: Final = 4
"""So many transparent things are seen through."""
_INSIDE: Final = 16
"""Surfaces within a transparent thing, at most, that are not seen."""


def render(
    picture: Picture,
    number: int,
    size: tuple[int, int] = SIZE,
    *,
    camera: Camera | None = None,
    around: Array | None = None,
) -> Bytes:
    """Return an image of scene ``number`` of the picture; shape ``(height, width, 3)``, sRGB.

    Without a camera, the nearest one of the standard direction that sees every object whole. ``around`` are points ``(n, 3)`` that
    the ground surrounds, by default the corners of the objects.
    """
    width, height = size
    instances = picture.scenes[number]
    scenery = scenery_of(picture.params[number])
    lamps = picture.lamps[number] if picture.lamps else ()
    around = corners(instances) if around is None else around
    stage = Stage(picture.surfaces, instances + lamps, scenery, picture.grounds[number], around)
    return paint(stage, Lens(camera or framing(corners(instances), width / height), stage.center, size))


def paint(stage: Stage, lens: Lens, known: Buffer | None = None) -> Bytes:
    """Return the image that a lens makes; shape ``(height, width, 3)``, sRGB.

    Args:
        stage: the scene.
        lens: where it is seen from.
        known: what every pixel shows; without it, rays decide which pixels need rays.

    """
    return _Drawing(stage, lens, known).image


class _Drawing:
    """An image in the making: ``image`` is ``(height, width, 3)``, sRGB."""

    def __init__(self, stage: Stage, lens: Lens, known: Buffer | None) -> None:
        self._stage = stage
        self._lens = lens
        self._known = known
        self.image = np.empty((lens.height, lens.width, 3), np.uint8)
        self._group = np.empty((lens.height, lens.width), np.int32)
        torn = self._draw()
        self._smooth_edges(torn)

    def _draw(self) -> Mask:
        """Draw everything but smooth edges; where surfaces are torn, ``(height, width)``."""
        stage, lens = self._stage, self._lens
        directions = lens.through_all(2)
        shape = (directions.shape[0], directions.shape[1])
        directions = directions.reshape(-1, 3)
        if self._known is None:
            coarse = look(stage, lens.eye, directions)
        else:
            every = np.arange(lens.width * lens.height).reshape(lens.height, lens.width)[::2, ::2]
            coarse = self._recall(self._known, directions, every.reshape(-1))
        light = coarse_light(stage, lens.eye, coarse, shape)
        color = encoded(self._color(coarse, light)).reshape(3, *shape)
        group = coarse.group.reshape(shape)
        tears = _jumps(coarse.nearness.reshape(shape)) & (group > 0)
        beside = (group[:, 1:] != group[:, :-1]) | tears[:, 1:] | tears[:, :-1]
        below = (group[1:] != group[:-1]) | tears[1:] | tears[:-1]
        for plane in color:
            beside |= _apart(plane[:, 1:], plane[:, :-1])
            below |= _apart(plane[1:], plane[:-1])
        _fill(self._group, group, np.minimum)
        for channel, plane in enumerate(color):
            _fill(self.image[..., channel], plane, _mean)
        details = _between(beside, below, self._group.shape)
        if self._known is not None:
            # Ground and sky are told apart by their directions alone: where they meet is seen in the coarse image.
            remembered_groups = stage.group_of(self._known.triangle)
            details |= remembered_groups != np.where(self._group == GROUND, np.int32(SKY), self._group)
        self._detail(np.flatnonzero(details), (coarse.group, light, shape))
        return _twice(tears, self._group.shape)

    def _recall(self, known: Buffer, directions: Singles, pixels: Index) -> Seen:
        """Return the surface points that pixels show, from a buffer of known results."""
        return grounded(
            self._stage,
            self._lens.eye,
            directions,
            known.triangle.reshape(-1)[pixels],
            known.nearness.reshape(-1)[pixels],
            known.second.reshape(-1)[pixels],
            known.third.reshape(-1)[pixels],
        )

    def _detail(self, pixels: Index, coarse: tuple[Groups, Light, tuple[int, int]]) -> None:
        """Draw pixels of the fine image, numbered row by row."""
        stage, lens = self._stage, self._lens
        directions = lens.through(pixels)
        if self._known is None:
            hits = look(stage, lens.eye, directions)
        else:
            hits = self._recall(self._known, directions, pixels)
        light = fine_light(stage, lens.eye, hits, pixels, lens.width, coarse)
        self.image.reshape(-1, 3)[pixels] = encoded(self._color(hits, light)).T
        self._group.reshape(-1)[pixels] = hits.group

    # Colours

    def _color(self, seen: Seen, light: Light, eye: Singles | None = None, layers: int = _LAYERS) -> Singles:
        """Return the linear colours ``(3, n)`` that rays from the lens see; rays that see nothing get what is behind, seen from farther eyes."""
        stage = self._stage
        result = np.zeros((3, len(seen.group)), np.float32)
        thing = np.flatnonzero(seen.group > 0)
        triangle, sun, sky = seen.triangle[thing], light.sun[thing], light.sky[thing]
        is_smooth = stage.smooth[triangle]
        if not is_smooth.all():
            for channel in range(3):
                sunny = np.take(stage.flat[channel], triangle) * sun
                result[channel, thing] = sunny + np.take(stage.flat[channel + 3], triangle) * sky
        if is_smooth.any():
            some = np.flatnonzero(is_smooth)
            result[:, thing[some]] = self._curved_color(seen.take(thing[some]), Light(sun[some], sky[some])).T
        if stage.textures and len(thing):
            start = self._lens.eye if eye is None else eye[thing]
            places = start + seen.directions[thing] / seen.nearness[thing, None]
            width = np.asarray(self._lens.pixel / seen.nearness[thing], np.float32)
            weights = seen.second[thing], seen.third[thing]
            result[:, thing] *= stage.pattern(triangle, weights, places, width)
        if (stage.alphas < 1).any():
            alpha = stage.alphas[stage.owner[triangle]]
            clear = thing[alpha < 1]
            if len(clear) and layers:
                start = self._lens.eye if eye is None else eye[clear]
                behind = self._behind(seen.take(clear), start, layers)
                alpha = alpha[alpha < 1]
                result[:, clear] = alpha * result[:, clear] + (1 - alpha) * behind
        ground = np.flatnonzero(seen.group == GROUND)
        if len(ground):
            start, near = self._lens.eye, seen.nearness[ground]
            if eye is not None:
                farther = (eye[ground] - start) @ self._lens.ahead
                near = np.asarray(near / (1 + near * farther), np.float32)
            result[:, ground] = ground_color(
                stage,
                start,
                seen.directions[ground],
                near,
                (light.sun[ground], light.sky[ground]),
                self._lens.pixel,
            )
        sky_seen = np.flatnonzero(seen.group == SKY)
        result[:, sky_seen] = sky_color(seen.directions[sky_seen], stage.scenery)
        return result

    def _curved_color(self, seen: Seen, light: Light) -> Singles:
        """Return linear colours ``(n, 3)`` on triangles whose corners have different normals."""
        total = np.zeros((len(seen.triangle), 3), np.float32)
        for corner, weight in enumerate((1 - seen.second - seen.third, seen.second, seen.third)):
            sunny, shady = self._stage.sunny[seen.triangle, corner], self._stage.shady[seen.triangle, corner]
            total += (weight * light.sun)[:, None] * sunny + (weight * light.sky)[:, None] * shady
        return total

    def _behind(self, front: Seen, eye: Singles, layers: int) -> Singles:
        """Return colours ``(3, n)`` beyond transparent things, whose inside is not seen."""
        stage = self._stage
        margin = np.float32(stage.reach * 1e-4)
        start = eye + front.directions * (np.float32(1) / front.nearness + margin)[:, None]
        sight = look(stage, start, front.directions)
        thing = stage.owner[front.triangle]
        for _ in range(_INSIDE):
            within = np.flatnonzero((sight.group > 0) & (stage.owner[sight.triangle] == thing))
            if not len(within):
                break
            start[within] += sight.directions[within] * (1 / sight.nearness[within] + margin)[:, None]
            sight.replace(within, look(stage, start[within], sight.directions[within]))
        light = own_light(stage, start, sight, np.arange(len(start)) % 16)
        return self._color(sight, light, start, layers - 1)

    # Edges

    def _smooth_edges(self, torn: Mask) -> None:
        """Mix into pixels at edges what rays through their corners see, one for all pixels that share a corner.

        A pixel keeps half of its own colour, and takes an eighth of that at each corner around which surfaces differ, or are
        torn.
        """
        group = self._group
        height, width = group.shape
        across, along = group[:, 1:] != group[:, :-1], group[1:] != group[:-1]
        # If three sides of a square of pixels join the same surface, so does the fourth.
        has_edge = across[:-1] | across[1:] | along[:, 1:]
        for down in (0, 1):
            for right in (0, 1):
                has_edge |= torn[down : height - 1 + down, right : width - 1 + right]
        edge = np.zeros(group.shape, np.bool_)
        for down in (0, 1):
            for right in (0, 1):
                edge[down : height - 1 + down, right : width - 1 + right] |= has_edge
        row, column = np.divmod(np.flatnonzero(has_edge), width - 1)
        colors = self._corner_colors(row + 1, column + 1)
        number = np.full((height + 1, width + 1), -1, np.int32)
        number[row + 1, column + 1] = np.arange(len(row))
        pixels = np.flatnonzero(edge)
        image = self.image.reshape(-1, 3)
        own_colors = decoded(image[pixels])
        total = own_colors * np.float32(0.5)
        row, column = np.divmod(pixels, width)
        for down in (0, 1):
            for right in (0, 1):
                corner = number[row + down, column + right]
                there = np.flatnonzero(corner >= 0)
                part = own_colors * np.float32(0.125)
                part[there] = colors[corner[there]]
                total += part
        image[pixels] = encoded(total)

    def _corner_colors(self, row: Index, column: Index) -> Singles:
        """Return an eighth of the linear colours ``(n, 3)`` at corners between pixels: above and to the left of those given.

        It is the mean of the pixels around the corner that show the surface which a ray through it meets.
        """
        width = self._group.shape[1]
        directions = self._lens.directions(column.astype(np.float32), row.astype(np.float32))
        corner_groups = first_groups(self._stage, self._lens.eye, directions)
        group, image = self._group.reshape(-1), self.image.reshape(-1, 3)
        pixel = row * width + column
        around = [pixel - width - 1, pixel - width, pixel - 1, pixel]
        total, matching = np.zeros((len(row), 3), np.float32), np.zeros(len(row), np.float32)
        for pixel in around:
            match = np.flatnonzero(group[pixel] == corner_groups)
            matching[match] += 1
            total[match] += decoded(image[pixel[match]])
        # Something too thin for the middle of any pixel takes the colour around it.
        alone = np.flatnonzero(matching == 0)
        for pixel in around:
            total[alone] += decoded(image[pixel[alone]])
        matching[alone] = 4
        total *= (np.float32(0.125) / matching)[:, None]
        return total


def _apart(a: Bytes, b: Bytes) -> Mask:
    return np.asarray(np.maximum(a, b) - np.minimum(a, b) > _NEARLY)


def _mean(a: Bytes, b: Bytes) -> Bytes:
    return ((a.astype(np.uint16) + b + 1) >> 1).astype(np.uint8)


def _fill(
    fine: npt.NDArray[_Scalar],
    coarse: npt.NDArray[_Scalar],
    join: Callable[[npt.NDArray[_Scalar], npt.NDArray[_Scalar]], npt.NDArray[_Scalar]],
) -> None:
    """Put a coarse image into a fine one, and what joins neighbours between them."""
    height, width = ((length - 1) // 2 * 2 for length in fine.shape)
    fine[::2, ::2] = coarse
    fine[::2, 1:width:2] = join(coarse[:, :-1], coarse[:, 1:])
    fine[1:height:2] = join(fine[:height:2], fine[2 : height + 1 : 2])


def _between(beside: Mask, below: Mask, shape: tuple[int, int]) -> Mask:
    """Return the mask, of shape ``shape``, of the pixels between those of a coarse image that neighbours do not decide; also of those without neighbours."""
    height, width = shape
    rows, columns = below.shape[0] + 1, beside.shape[1] + 1
    across, along = np.ones((rows, columns), np.bool_), np.ones((rows, columns), np.bool_)
    across[:, :-1], along[:-1] = beside, below
    middle = across | along
    middle[:-1] |= across[1:]
    middle[:, :-1] |= along[:, 1:]
    result = np.zeros(shape, np.bool_)
    result[::2, 1::2] = across[:, : width // 2]
    result[1::2, ::2] = along[: height // 2]
    result[1::2, 1::2] = middle[: height // 2, : width // 2]
    return result


def _twice(values: Mask, shape: tuple[int, int]) -> Mask:
    """Return a coarse image at its size: two by two pixels for each."""
    result = np.zeros(shape, np.bool_)
    for down in (0, 1):
        for right in (0, 1):
            part = result[down::2, right::2]
            part[:] = values[: part.shape[0], : part.shape[1]]
    return result


def _jumps(near: Singles) -> Mask:
    """Return a mask of the pixels whose inverse depth is not collinear with the neighbours', as it is on planes."""
    result = np.zeros(near.shape, np.bool_)
    for axis in (0, 1):
        values, marks = (near, result) if axis == 0 else (near.T, result.T)
        middle = values[1:-1] * np.float32(2)
        away = values[:-2] + values[2:]
        away -= middle
        middle *= np.float32(_JUMP)
        marks[1:-1] |= np.abs(away, out=away) > middle
    return result
