"""The share of the sun and of the sky that reaches what an image shows.

Both are estimated by rays, sparsely: at every other row and column of the coarse image (`scenic.formats.render`), its
*nodes*. From there light is spread over the surfaces; where the nodes around a place disagree, as in half shadow, it
gets rays of its own.
"""

from typing import Final, TypeVar

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.buffers import Groups, Seen
from scenic.formats.stage import SKY, Stage
from scenic.runtime.geometry.meshes.embree import Singles

Index = npt.NDArray[np.intp]
_Scalar = TypeVar("_Scalar", bound=np.generic)

_NODE: Final = 2
_SUN_RAYS: Final = 2
_OWN_SUN_RAYS: Final = 6
_SKY_RAYS: Final = 3
_OWN_SKY_RAYS: Final = 12
_FEW: Final = 6.0
"""Nodes with so little weight of others of their surface around them get rays for the sky of their own."""
_CLOSE: Final = 0.5
"""Neighbours whose parts of the sun differ by so much at most give their mean."""


@dataclass(frozen=True, slots=True)
class Light:
    """Parts in [0, 1] of the sun and of the sky that reach places, ``(n,)`` each."""

    sun: Singles
    sky: Singles


def own_light(stage: Stage, eye: Singles, seen: Seen, pattern: Index) -> Light:
    """Return the light on the surfaces that rays from an eye hit, estimated for each ray separately; `pattern` as for `Stage.sunlit`."""
    sun, sky = np.zeros(len(pattern), np.float32), np.ones(len(pattern), np.float32)
    lit = np.flatnonzero(seen.group != SKY)
    places = seen.take(lit), pattern[lit]
    start = eye if eye.ndim == 1 else eye[lit]
    sun[lit] = _sun(stage, start, *places, _OWN_SUN_RAYS)
    sky[lit] = _sky(stage, start, *places, _OWN_SKY_RAYS)
    return Light(sun, sky)


def coarse_light(stage: Stage, eye: Singles, seen: Seen, shape: tuple[int, int]) -> Light:
    """The light on all of a coarse image with a number of rows and columns."""
    rows, columns = (np.minimum(np.arange(-(-length // _NODE) + 1) * _NODE, length - 1) for length in shape)
    index = (rows[:, None] * shape[1] + columns).reshape(-1)
    size = (len(rows), len(columns))
    nodes = seen.group[index]
    node_sun, node_sky = np.zeros(len(index), np.float32), np.ones(len(index), np.float32)
    lit = np.flatnonzero(nodes != SKY)
    row, column = np.divmod(lit, size[1])
    places = seen.take(index[lit]), (row % 4) * 4 + column % 4
    node_sun[lit] = _sun(stage, eye, *places, _SUN_RAYS)
    node_sky[lit] = _sky(stage, eye, *places, _SKY_RAYS)
    group = nodes.reshape(size)
    smooth_sky, weight = _averaged(node_sky.reshape(size), group)
    few = np.flatnonzero((weight.reshape(-1) < _FEW) & (nodes != SKY))
    smooth_sky.reshape(-1)[few] = _sky(stage, eye, seen.take(index[few]), few % 16, _OWN_SKY_RAYS)
    at_nodes = node_sun.reshape(size), smooth_sky

    sun, sky = (_enlarged(values, shape).reshape(-1) for values in at_nodes)
    whole = (group[:-1, :-1] == group[1:, :-1]) & (group[:-1, 1:] == group[1:, 1:])
    whole &= group[:-1, :-1] == group[:-1, 1:]
    cell = np.where(whole, group[:-1, :-1], np.int32(SKY - 1))
    same = _of_cells(cell, shape).reshape(-1) == seen.group
    low, high = (_around(at_nodes[0], choose) for choose in (np.minimum, np.maximum))
    steady = _of_cells(low == high, shape).reshape(-1)
    bright = seen.group != SKY
    halfway = np.flatnonzero(bright & same & ~steady)
    sun[halfway] = _sun(stage, eye, seen.take(halfway), _pattern(halfway, shape[1]), _OWN_SUN_RAYS)
    border_pixels = np.flatnonzero(bright & ~same)
    row, column = np.divmod(border_pixels, shape[1])
    corners = [
        (row // _NODE + below) * size[1] + column // _NODE + beside for below in (0, 1) for beside in (0, 1)
    ]
    light = _from_neighbours(
        stage,
        eye,
        seen.take(border_pixels),
        corners,
        nodes,
        Light(*(part.reshape(-1) for part in at_nodes)),
        _pattern(border_pixels, shape[1]),
    )
    sun[border_pixels], sky[border_pixels] = light.sun, light.sky
    return Light(sun, sky)


def fine_light(
    stage: Stage,
    eye: Singles,
    seen: Seen,
    pixels: Index,
    width: int,
    coarse: tuple[Groups, Light, tuple[int, int]],
) -> Light:
    """The light on pixels between those of a coarse image, given its groups, its light, and its rows and columns."""
    groups, light, shape = coarse
    row, column = np.divmod(pixels, width)
    up, left = row // 2, column // 2
    down, right = np.minimum((row + 1) // 2, shape[0] - 1), np.minimum((column + 1) // 2, shape[1] - 1)
    corners = [i * shape[1] + j for i, j in ((up, left), (up, right), (down, left), (down, right))]
    return _from_neighbours(stage, eye, seen, corners, groups, light, _pattern(pixels, width))


def _from_neighbours(
    stage: Stage,
    eye: Singles,
    seen: Seen,
    neighbours: list[Index],
    groups: Groups,
    light: Light,
    pattern: Index,
) -> Light:
    """Return the light of those neighbours that show the same surface; where they disagree or are none, rays of its own."""
    count = len(pattern)
    matches, sky, sun = np.zeros((3, count), np.float32)
    low, high = np.full(count, 2, np.float32), np.full(count, -1, np.float32)
    for corner in neighbours:
        match = groups[corner] == seen.group
        matches += match
        sky += match * light.sky[corner]
        value = light.sun[corner]
        sun += match * value
        np.minimum(low, value, out=low, where=match)
        np.maximum(high, value, out=high, where=match)
    share = 1 / np.maximum(matches, 1)
    sky *= share
    sun *= share
    bright = seen.group != SKY
    unsure = np.flatnonzero(bright & ((high - low > _CLOSE) | (matches == 0)))
    sun[unsure] = _sun(stage, eye, seen.take(unsure), pattern[unsure], _OWN_SUN_RAYS)
    alone = np.flatnonzero(bright & (matches == 0))
    sky[alone] = _sky(stage, eye, seen.take(alone), pattern[alone], _OWN_SKY_RAYS)
    return Light(sun, sky)


def _sun(stage: Stage, eye: Singles, seen: Seen, pattern: Index, rays: int) -> Singles:
    return stage.sunlit(*_places(stage, eye, seen), pattern, rays)


def _sky(stage: Stage, eye: Singles, seen: Seen, pattern: Index, rays: int) -> Singles:
    return stage.openness(*_places(stage, eye, seen), pattern, rays)


def _places(stage: Stage, eye: Singles, seen: Seen) -> tuple[Singles, Singles]:
    """Return the ends of rays, and the unit normals there, directed towards the eye."""
    normal = stage.normals[seen.triangle]
    away = np.einsum("ij,ij->i", normal, seen.directions) > 0
    normal[away] *= -1
    return eye + seen.directions / seen.nearness[:, None], normal


def _pattern(pixels: Index, width: int) -> Index:
    """A number in [0, 16) for each pixel, another one for each of four by four."""
    row, column = np.divmod(pixels, width)
    return np.asarray((row % 4) * 4 + column % 4)


def _around(values: Singles, choose: np.ufunc) -> Singles:
    """Return the least or greatest of the four nodes around each cell."""
    result: Singles = choose(
        choose(values[:-1, :-1], values[1:, :-1]), choose(values[:-1, 1:], values[1:, 1:])
    )
    return result


def _averaged(values: Singles, group: Groups) -> tuple[Singles, Singles]:
    """Means over the five by five nodes around each one that show the same surface, and how many those are."""
    count = np.ones(values.shape, np.float32)
    for axis in (0, 1):
        total, weight = values.copy(), np.ones(values.shape, np.float32)
        number = count.copy()
        for shift in (-2, -1, 1, 2):
            here, there = _shifted(axis, shift), _shifted(axis, -shift)
            # Four nodes hold one of each pattern: the outer two of five count half.
            share = (group[there] == group[here]) * np.float32(0.5 if abs(shift) == 2 else 1)
            total[here] += share * values[there]
            weight[here] += share
            number[here] += share * count[there]
        values, count = total / weight, number
    return values, count


def _shifted(axis: int, shift: int) -> tuple[slice, slice]:
    part = slice(None, -shift) if shift > 0 else slice(-shift, None)
    return (part, slice(None)) if axis == 0 else (slice(None), part)


def _of_cells(values: npt.NDArray[_Scalar], shape: tuple[int, int]) -> npt.NDArray[_Scalar]:
    """Values of the cells between nodes, for each place in them."""
    wide = np.repeat(values, _NODE, axis=1)[:, : shape[1]]
    return np.repeat(wide, _NODE, axis=0)[: shape[0]]


def _enlarged(values: Singles, shape: tuple[int, int]) -> Singles:
    """Values at nodes, linear in between, for each place."""
    for axis, length in enumerate(shape):
        place = np.arange(length)
        part = ((place % _NODE) / _NODE).astype(np.float32)
        part = part[:, None] if axis == 0 else part
        before, after = (np.take(values, place // _NODE + more, axis=axis) for more in (0, 1))
        values = before + part * (after - before)
    return values
