"""Pictures of scenes without a display: rays are cast at the meshes, for sight, shadow and ambient light.

Sight is dense: what each pixel sees is found with a ray of its own, or is that of the pixels around it where they agree.
Light is sparse: soft shadow and ambient light are estimated with several rays at every fourth pixel of every fourth
row, and spread from there over the surfaces; where the nodes around a pixel disagree, as in half shadow, it gets rays of
its own. Edges are smoothed by more rays for sight alone. Everything is deterministic.
"""

from dataclasses import dataclass
from typing import Final, TypeVar

import numpy as np
import numpy.typing as npt

from scenic.formats.buffers import Buffer, Lens, seen
from scenic.formats.camera import Camera, corners, framing
from scenic.formats.colors import encoded, linear
from scenic.formats.instances import Picture
from scenic.formats.stage import GROUND, SKY, Stage, ground_light, sequence
from scenic.runtime.geometry.embree import Singles

Pixels = npt.NDArray[np.intp]
Groups = npt.NDArray[np.int32]
_Scalar = TypeVar("_Scalar", bound=np.generic)

SIZE: Final = (960, 720)

_NODE: Final = 4
"""Light is estimated at every so many pixels."""
_SUN_RAYS: Final = 4
_OWN_SUN_RAYS: Final = 6
_SKY_RAYS: Final = 4
_OWN_SKY_RAYS: Final = 12
_EDGE_SAMPLES: Final = 4
_LAYERS: Final = 4
"""So many transparent surfaces are seen through."""

_GROUND_COLOR: Final = (0.80, 0.81, 0.83)
_LINE_COLOR: Final = (0.55, 0.57, 0.61)
_HORIZON: Final = (0.90, 0.92, 0.95)
_ZENITH: Final = (0.74, 0.82, 0.91)


def render(
    picture: Picture, number: int, size: tuple[int, int] = SIZE, *, camera: Camera | None = None
) -> npt.NDArray[np.uint8]:
    """An image of scene ``number`` of the picture; shape ``(height, width, 3)``, sRGB.

    Without a camera, the nearest one of the standard direction that sees every object whole.
    """
    width, height = size
    instances = picture.scenes[number]
    stage = Stage(picture.surfaces, instances)
    lens = Lens(camera or framing(corners(instances), width / height), stage.center, size)
    return paint(stage, lens, seen(lens, stage.rays, exact=False))


def paint(stage: Stage, lens: Lens, buffer: Buffer) -> npt.NDArray[np.uint8]:
    """The image of what the pixels see; shape ``(height, width, 3)``, sRGB."""
    drawing = _Drawing(stage, lens, buffer)
    drawing.shade()
    drawing.see_through()
    drawing.smooth_edges()
    return np.ascontiguousarray(encoded(drawing.image).T).reshape(lens.height, lens.width, 3)


@dataclass(frozen=True, slots=True)
class _Light:
    """Light at the nodes: parts of the sun and of the sky, each ``(rows, columns)``; and what the nodes show."""

    sun: Singles
    sky: Singles
    group: Groups


class _Drawing:
    """An image in the making; ``image`` holds linear light, ``(3, pixels)``."""

    def __init__(self, stage: Stage, lens: Lens, buffer: Buffer) -> None:
        self._stage = stage
        self._lens = lens
        self._triangle = buffer.triangle.reshape(-1)
        self._second, self._third = buffer.second.reshape(-1), buffer.third.reshape(-1)
        self._nearness = buffer.nearness.reshape(-1)
        self.image = np.empty((3, lens.width * lens.height), np.float32)
        self._group = self._groups(self._triangle)
        self._lay_ground()

    def _groups(self, triangle: Groups) -> Groups:
        """Numbers of surfaces: those of the stage, or sky."""
        if not len(self._stage.face_group):
            return np.full(triangle.shape, SKY, np.int32)
        return np.where(triangle >= 0, self._stage.face_group[triangle], np.int32(SKY))

    def _lay_ground(self) -> None:
        """Put ground where rays that meet no object go down."""
        lens, stage = self._lens, self._stage
        fall = stage.ground - float(lens.eye[2])
        open_pixels = np.flatnonzero(self._triangle < 0)
        if fall >= 0 or not len(open_pixels):
            return
        down = lens.through(open_pixels)[:, 2] < -1e-6
        below = open_pixels[down]
        self._group[below] = GROUND
        self._nearness[below] = lens.through(below)[:, 2] / np.float32(fall)

    # Light

    def shade(self) -> None:
        """Give every pixel its colour, as if nothing were transparent."""
        sun, sky = self._spread(self._node_light())
        stage = self._stage
        for channel, plane in enumerate(self.image):
            np.multiply(np.take(stage.flat[channel], self._triangle), sun, out=plane)
            plane += np.take(stage.flat[channel + 3], self._triangle) * sky
        if stage.smooth.any():
            curved = np.flatnonzero(np.take(stage.smooth, self._triangle) & (self._triangle >= 0))
            self.image[:, curved] = self._curved_color(
                self._triangle[curved], self._second[curved], self._third[curved], sun[curved], sky[curved]
            ).T
        rest = np.flatnonzero(self._triangle < 0)
        directions = self._lens.through(rest)
        backdrop = _sky_color(directions)
        ground = np.flatnonzero(self._group[rest] == GROUND)
        if len(ground):
            pixels = rest[ground]
            near = self._nearness[pixels]
            place = self._lens.eye + directions[ground] / near[:, None]
            albedo = _ground_color(stage, place, directions[ground], near, self._lens.pixel)
            color = ground_light(albedo, sun[pixels], sky[pixels])
            away = np.hypot(place[:, 0], place[:, 1]) / np.float32(1.2 * stage.reach)
            fade = np.clip(away - np.float32(0.5), 0, 1)[:, None] ** np.float32(0.8)
            backdrop[ground] = color + fade * (backdrop[ground] - color)
        self.image[:, rest] = backdrop.T

    def _thing_color(
        self, triangle: Groups, second: Singles, third: Singles, sun: Singles, sky: Singles
    ) -> Singles:
        """Colours ``(n, 3)`` of places on triangles, in parts of the sun and the sky."""
        stage = self._stage
        result = np.empty((len(triangle), 3), np.float32)
        for channel in range(3):
            sunny, shady = stage.flat[channel, triangle], stage.flat[channel + 3, triangle]
            result[:, channel] = sunny * sun + shady * sky
        curved = np.flatnonzero(stage.smooth[triangle])
        result[curved] = self._curved_color(
            triangle[curved], second[curved], third[curved], sun[curved], sky[curved]
        )
        return result

    def _curved_color(
        self, triangle: Groups, second: Singles, third: Singles, sun: Singles, sky: Singles
    ) -> Singles:
        """The same on triangles whose corners have different normals."""
        total = np.zeros((len(triangle), 3), np.float32)
        for corner, weight in enumerate((1 - second - third, second, third)):
            sunny, shady = self._stage.sunny[triangle, corner], self._stage.shady[triangle, corner]
            total += weight[:, None] * (sunny * sun[:, None] + shady * sky[:, None])
        return total

    def _node_light(self) -> _Light:
        width, height = self._lens.width, self._lens.height
        column = np.minimum(np.arange(-(-width // _NODE) + 1) * _NODE, width - 1)
        row = np.minimum(np.arange(-(-height // _NODE) + 1) * _NODE, height - 1)
        pixels = (row[:, None] * width + column).reshape(-1)
        group = self._group[pixels]
        sun, sky = np.zeros(len(pixels), np.float32), np.ones(len(pixels), np.float32)
        lit = np.flatnonzero(group > SKY)
        row_of, column_of = np.divmod(lit, len(column))
        sun[lit], sky[lit] = self._estimate(
            pixels[lit], (row_of % 4) * 4 + column_of % 4, _SUN_RAYS, _SKY_RAYS
        )
        shape = (len(row), len(column))
        return _Light(
            sun.reshape(shape), _averaged(sky.reshape(shape), group.reshape(shape)), group.reshape(shape)
        )

    def _estimate(
        self, pixels: Pixels, pattern: npt.NDArray[np.int64], sun_rays: int, sky_rays: int
    ) -> tuple[Singles, Singles]:
        """Parts of the sun and the sky that light what pixels see; no rays, no estimate (zeros)."""
        directions = self._lens.through(pixels)
        return self._estimate_at(
            directions, self._nearness[pixels], self._triangle[pixels], pattern, sun_rays, sky_rays
        )

    def _estimate_at(
        self,
        directions: Singles,
        nearness: Singles,
        triangle: Groups,
        pattern: npt.NDArray[np.int64],
        sun_rays: int,
        sky_rays: int,
    ) -> tuple[Singles, Singles]:
        stage = self._stage
        place = self._lens.eye + directions / nearness[:, None]
        normal = np.zeros_like(place)
        normal[:, 2] = 1
        on_thing = np.flatnonzero(triangle >= 0)
        facing = stage.normals[triangle[on_thing]].astype(np.float32)
        away = np.einsum("ij,ij->i", facing, directions[on_thing]) > 0
        facing[away] *= -1
        normal[on_thing] = facing
        nothing = np.zeros(len(place), np.float32)
        sun = stage.sunlit(place, normal, pattern, sun_rays) if sun_rays else nothing
        sky = stage.openness(place, normal, pattern, sky_rays) if sky_rays else nothing
        return sun, sky

    def _spread(self, light: _Light) -> tuple[Singles, Singles]:
        """Parts of the sun and the sky at every pixel, ``(n,)`` each."""
        width, height = self._lens.width, self._lens.height
        sun, sky = (_enlarged(values, width, height).reshape(-1) for values in (light.sun, light.sky))
        nodes = light.group
        whole = (nodes[:-1, :-1] == nodes[1:, :-1]) & (nodes[:-1, 1:] == nodes[1:, 1:])
        whole &= nodes[:-1, :-1] == nodes[:-1, 1:]
        cell = np.where(whole, nodes[:-1, :-1], np.int32(SKY - 1))
        same = _repeated(cell, width, height).reshape(-1) == self._group
        low, high = (_around(light.sun, choose) for choose in (np.minimum, np.maximum))
        steady = _repeated(low == high, width, height).reshape(-1)
        lit = self._group > SKY
        self._mend(np.flatnonzero(lit & ~same), light, sun, sky)
        shadowed = np.flatnonzero(lit & same & ~steady)
        sun[shadowed] = self._estimate(shadowed, self._pattern(shadowed), _OWN_SUN_RAYS, 0)[0]
        return sun, sky

    def _mend(self, pixels: Pixels, light: _Light, sun: Singles, sky: Singles) -> None:
        """The light of pixels that not all nodes around them share the surface of."""
        row, column = np.divmod(pixels, self._lens.width)
        i, j = row // _NODE, column // _NODE
        down, right = (row % _NODE) / np.float32(_NODE), (column % _NODE) / np.float32(_NODE)
        group = self._group[pixels]
        weight = np.zeros(len(pixels), np.float32)
        total = np.zeros(len(pixels), np.float32)
        low, high = np.full(len(pixels), 2, np.float32), np.full(len(pixels), -1, np.float32)
        for below, part in ((0, 1 - down), (1, down)):
            for beside, share in ((0, 1 - right), (1, right)):
                match = light.group[i + below, j + beside] == group
                heft = np.where(match, part * share + np.float32(1e-3), 0).astype(np.float32)
                weight += heft
                total += heft * light.sky[i + below, j + beside]
                value = light.sun[i + below, j + beside]
                low = np.where(match, np.minimum(low, value), low)
                high = np.where(match, np.maximum(high, value), high)
        known = weight > 0
        sky[pixels[known]] = total[known] / weight[known]
        sun[pixels[low == high]] = low[low == high]
        alone = pixels[~known]
        sun[alone], sky[alone] = self._estimate(alone, self._pattern(alone), _OWN_SUN_RAYS, _OWN_SKY_RAYS)
        halfway = pixels[known & (low != high)]
        sun[halfway] = self._estimate(halfway, self._pattern(halfway), _OWN_SUN_RAYS, 0)[0]

    def _pattern(self, pixels: Pixels) -> npt.NDArray[np.int64]:
        row, column = np.divmod(pixels, self._lens.width)
        return np.asarray((row % 4) * 4 + column % 4)

    # What is transparent

    def see_through(self) -> None:
        """Mix what is behind transparent objects into their pixels."""
        if not (self._stage.alphas < 1).any():
            return
        clear = np.flatnonzero(self._group > 0)
        clear = clear[self._stage.alphas[self._stage.owner[self._triangle[clear]]] < 1]
        if len(clear):
            front = self._triangle[clear]
            depth = np.float32(1) / self._nearness[clear]
            behind = self._behind(self._lens.through(clear), depth, self._pattern(clear), _LAYERS)
            alpha = self._stage.alphas[self._stage.owner[front]]
            self.image[:, clear] = alpha * self.image[:, clear] + (1 - alpha) * behind.T

    def _behind(
        self, directions: Singles, depth: Singles, pattern: npt.NDArray[np.int64], layers: int
    ) -> Singles:
        """Colours beyond a depth along rays from the eye."""
        stage, lens = self._stage, self._lens
        start = depth + np.float32(stage.reach * 1e-4)
        hits = stage.rays.first_hits(lens.eye + directions * start[:, None], directions)
        far = start + hits.distance
        triangle = hits.triangle
        fall = np.float32(stage.ground) - lens.eye[2]
        grounded = (triangle < 0) & (directions[:, 2] < -1e-6) & (fall < 0)
        far = np.where(grounded, fall / np.minimum(directions[:, 2], -1e-6), far)
        color = _sky_color(directions)
        lit = np.flatnonzero(grounded | (triangle >= 0))
        sun, sky = np.zeros(len(color), np.float32), np.ones(len(color), np.float32)
        sun[lit], sky[lit] = self._estimate_at(
            directions[lit],
            np.float32(1) / far[lit],
            triangle[lit],
            pattern[lit],
            _OWN_SUN_RAYS,
            _OWN_SKY_RAYS,
        )
        ground = np.flatnonzero(grounded)
        place = lens.eye + directions[ground] * far[ground, None]
        albedo = _ground_color(stage, place, directions[ground], np.float32(1) / far[ground], lens.pixel)
        color[ground] = ground_light(albedo, sun[ground], sky[ground])
        thing = np.flatnonzero(triangle >= 0)
        color[thing] = self._thing_color(
            triangle[thing], hits.second[thing], hits.third[thing], sun[thing], sky[thing]
        )
        through = thing[stage.alphas[stage.owner[triangle[thing]]] < 1]
        if len(through) and layers > 1:
            alpha = stage.alphas[stage.owner[triangle[through]], None]
            beyond = self._behind(directions[through], far[through], pattern[through], layers - 1)
            color[through] = alpha * color[through] + (1 - alpha) * beyond
        return color

    # Edges

    def smooth_edges(self) -> None:
        """Give pixels at edges the mean colour of what several rays through them see.

        A ray takes the colour of its pixel or of the neighbour on its side that shows the same surface.
        """
        width, height = self._lens.width, self._lens.height
        group = self._group.reshape(height, width)
        edge = np.zeros((height, width), np.bool_)
        across, along = group[:, 1:] != group[:, :-1], group[1:] != group[:-1]
        edge[:, 1:] |= across
        edge[:, :-1] |= across
        edge[1:] |= along
        edge[:-1] |= along
        edge |= self._jumps()
        pixels = np.flatnonzero(edge.reshape(-1))
        row, column = np.divmod(pixels, width)
        total = np.zeros((3, len(pixels)), np.float32)
        for dx, dy in sequence(_EDGE_SAMPLES).astype(np.float32):
            directions = self._lens.directions(column.astype(np.float32) + dx, row.astype(np.float32) + dy)
            found = self._groups(self._stage.rays.first_triangles(self._lens.eye, directions))
            if self._lens.eye[2] > self._stage.ground:
                found[(found == SKY) & (directions[:, 2] < -1e-6)] = GROUND
            beside = np.clip(column + (1 if dx > 0.5 else -1), 0, width - 1)
            below = np.clip(row + (1 if dy > 0.5 else -1), 0, height - 1)
            source = pixels.copy()
            open_rays = self._group[pixels] != found
            for other in (row * width + beside, below * width + column, below * width + beside):
                fits = open_rays & (self._group[other] == found)
                source[fits] = other[fits]
                open_rays &= ~fits
            total += self.image[:, source]
        self.image[:, pixels] = total / np.float32(_EDGE_SAMPLES)

    def _jumps(self) -> npt.NDArray[np.bool_]:
        """Pixels of objects whose depth is not on a line with that of their neighbours: nearness is linear on planes."""
        near = self._nearness.reshape(self._lens.height, self._lens.width)
        result = np.zeros(near.shape, np.bool_)
        middle = near[1:-1] * np.float32(2)
        result[1:-1] |= np.abs(near[:-2] + near[2:] - middle) > np.float32(0.01) * middle
        middle = near[:, 1:-1] * np.float32(2)
        result[:, 1:-1] |= np.abs(near[:, :-2] + near[:, 2:] - middle) > np.float32(0.01) * middle
        return result & (self._group.reshape(near.shape) > 0)


def _around(values: Singles, choose: np.ufunc) -> Singles:
    """The least or greatest of the four nodes around each cell."""
    result: Singles = choose(
        choose(values[:-1, :-1], values[1:, :-1]), choose(values[:-1, 1:], values[1:, 1:])
    )
    return result


def _averaged(values: Singles, group: Groups) -> Singles:
    """Means over the five by five nodes around each one that show the same surface, first down and then along."""
    for axis in (0, 1):
        total, weight = values.copy(), np.ones(values.shape, np.float32)
        for shift in (-2, -1, 1, 2):
            index = np.clip(np.arange(values.shape[axis]) + shift, 0, values.shape[axis] - 1)
            match = np.take(group, index, axis=axis) == group
            # Four nodes hold one of each pattern: the outer two of five count half.
            share = match * np.float32(0.5 if abs(shift) == 2 else 1)
            total += share * np.take(values, index, axis=axis)
            weight += share
        values = total / weight
    return values


def _repeated(values: npt.NDArray[_Scalar], width: int, height: int) -> npt.NDArray[_Scalar]:
    """Values of cells, for each of their pixels."""
    return np.repeat(np.repeat(values, _NODE, axis=1)[:, :width], _NODE, axis=0)[:height]


def _enlarged(values: Singles, width: int, height: int) -> Singles:
    """Values at nodes, linear in between, for each pixel."""
    for axis, length in ((0, height), (1, width)):
        place = np.arange(length)
        part = ((place % _NODE) / _NODE).astype(np.float32)
        part = part[:, None] if axis == 0 else part
        before, after = (np.take(values, place // _NODE + more, axis=axis) for more in (0, 1))
        values = before + part * (after - before)
    return values


def _sky_color(directions: Singles) -> Singles:
    """A pale gradient; below the horizon it is the horizon's colour."""
    length = np.sqrt(np.einsum("ij,ij->i", directions, directions))
    up = np.clip(directions[:, 2] / length * np.float32(2), 0, 1)[:, None]
    low, high = linear(_HORIZON), linear(_ZENITH)
    result: Singles = low + up * (high - low)
    return result


def _ground_color(
    stage: Stage, place: Singles, directions: Singles, nearness: Singles, pixel: float
) -> Singles:
    """The grid on the ground: lines a pixel or two wide at any distance, that fade where they crowd."""
    steepness = np.maximum(-directions[:, 2], np.float32(0.05))
    footprint = np.float32(pixel) / (nearness * steepness)
    cover = np.zeros(len(place), np.float32)
    spacing = _grid_spacing(stage.reach)
    for step, strength in ((spacing, 0.35), (spacing * 5, 0.7)):
        away = np.full(len(place), np.inf, np.float32)
        for axis in (0, 1):
            position = place[:, axis] * np.float32(1 / step) + np.float32(stage.center[axis] / step)
            position -= np.round(position)
            np.minimum(away, np.abs(position, out=position), out=away)
        line = np.clip(np.float32(1.2) - away * np.float32(step) / footprint, 0, 1)
        line *= np.float32(strength) * np.clip(np.float32(1.5) - footprint * np.float32(6 / step), 0, 1)
        # A line that crosses another covers what that leaves.
        cover += line * (1 - cover)
    ground, lines = linear(_GROUND_COLOR), linear(_LINE_COLOR)
    result: Singles = ground + cover[:, None] * (lines - ground)
    return result


def _grid_spacing(reach: float) -> float:
    """One, two or five times a power of ten metres, so that a scene has some twenty lines."""
    power = 10.0 ** np.floor(np.log10(reach / 12))
    return float(min((1, 2, 5, 10), key=lambda step: abs(np.log(step * power * 12 / reach))) * power)
