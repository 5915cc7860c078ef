"""Recorded answers of functions over lanes: where decisions flip, and what numbers come out, as lines of text."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import shapely
import trimesh

from scenic.graph.bounds import Bounds
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.combinations import UnionRegion
from scenic.runtime.regions.planar import PlanarRegion
from scenic.runtime.regions.view_regions import ViewRegion
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from tests.recorded import said, shown
from tests.runtime.geometry.samples import table

Array = np.ndarray[Any, Any]
Decide = Callable[[Array], Array]
"""Which lanes hold, given how far each is on its way, ``(n,)`` in [0, 1]."""

_MANY = 40
"""Numbers from which on only their sums are shown."""


def numbers(values: Any) -> str:
    """Numbers or truth values of any shape; of very many a few sums, each with other weights."""
    array = np.asarray(values)
    shape = "x".join(map(str, array.shape))
    if array.dtype == np.bool_:
        if array.size > 3 * _MANY:
            return f"{shape}: {_sums(array.astype(float))}"
        return "".join("X" if value else "o" for value in array.ravel().tolist())
    array = array.astype(np.float64)
    if array.size > _MANY:
        return f"{shape}: {_sums(array)}"
    rows = array.reshape(-1, array.shape[-1]) if array.ndim > 1 else [array.reshape(-1)]
    return "; ".join(" ".join(_number(value) for value in np.asarray(row).tolist()) for row in rows)


def _number(value: float) -> str:
    return "0" if abs(value) < 1e-9 else f"{value:.8g}"


def _sums(array: Array) -> str:
    flat = array.ravel()
    finite = np.isfinite(flat)
    weights = np.random.default_rng(7).uniform(1, 2, (2, flat.size))
    totals = (np.where(finite, flat, 0.0) * weights).sum(axis=1)
    return f"{finite.sum()} sum to {_number(totals[0])} and {_number(totals[1])}"


def flips(decide: Decide, lanes: int, steps: int = 14) -> str:
    """Whether each lane holds at the beginning and at the end of its way; if these differ, where it changes."""
    low, high = np.zeros(lanes), np.ones(lanes)
    first, last = (np.broadcast_to(decide(end), lanes) for end in (low, high))
    for _ in range(steps if (first != last).any() else 0):
        middle = (low + high) / 2
        as_first = np.broadcast_to(decide(middle), lanes) == first
        low, high = np.where(as_first, middle, low), np.where(as_first, high, middle)
    return " ".join(
        ("X" if begin else "o") if begin == end else f"{'Xo' if begin else 'oX'} {place:.7f}"
        for begin, end, place in zip(first.tolist(), last.tolist(), high.tolist(), strict=True)
    )


def summary(value: Any) -> str:
    """What tells a value of geometry from others, with numbers that do not depend on the order of its parts."""
    if isinstance(value, trimesh.Trimesh):
        volume = f", volume {_number(value.volume)}" if value.is_volume else ""
        corners = numbers(np.sort(value.vertices.round(9).sum(axis=1))[[0, -1]])
        return f"mesh in {numbers(value.bounds)}, area {_number(value.area)}{volume}, sums {corners}"
    if isinstance(value, Mesh):
        return f"mesh of {len(value.vertices)} and {len(value.faces)}, in {numbers(value.bounds)}, volume {_number(value.volume)}"
    if isinstance(value, shapely.Geometry):
        middle = value.centroid
        place = "" if value.is_empty else f", middle {_number(middle.x)} {_number(middle.y)}"
        return f"{value.geom_type} of {_number(value.area)} and {_number(value.length)}{place}"
    if isinstance(value, Region):
        return region_summary(value)
    if isinstance(value, np.ndarray):
        return numbers(value)
    if isinstance(value, Bounds):
        return f"[{numbers(value.lower)}] to [{numbers(value.upper)}]"
    if isinstance(value, list | tuple):
        if len(value) > 8:
            return (
                f"{type(value).__name__} of {len(value)}: {summary(list(value[:2]))} ... {summary(value[-1])}"
            )
        return f"{type(value).__name__}({', '.join(map(summary, value))})"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {summary(part)}' for key, part in value.items())}}}"
    if hasattr(value, "__next__"):
        return summary(list(value))
    return shown(value)


def region_summary(region: Region) -> str:
    """Kind, dimension, size and box of a region, and which places of a lattice it holds."""
    parts = [type(region).__name__, f"of {shown(region.dimension)}"]
    if region.is_random:
        return " ".join([*parts, f"from {len(region.parameters)}"])
    parts.append(f"size {attempt(lambda: region.size)}")
    parts.append(f"box {attempt(lambda: np.array(region.AABB))}")
    columns = region.fixed_columns("a test")
    parts.append(f"holds {attempt(lambda: region.contains_points(LATTICE, *columns))}")
    if region.has_orientation:
        parts.append("oriented")
    return " ".join(parts)


LATTICE = np.array(
    [
        (x + 0.03 * z, y + 0.07 * x, z)
        for x in (-2.6, -0.9, 0.7, 1.9, 3.3)
        for y in (-3.1, -1.2, 0.4, 2.1)
        for z in (-0.6, 0.0, 1.7)
    ]
)


def attempt(ask: Callable[[], Any]) -> str:
    """The summary of an answer, or what is said of its error."""
    try:
        return summary(ask())
    except Exception as error:  # noqa: BLE001 - what is said of it is the answer
        return said(error).replace("\n", " /")


# Lanes

LANES = 7


def turns(rng: np.random.Generator, lanes: int = LANES) -> Array:
    """Random orientations as quaternions."""
    found = rng.normal(size=(lanes, 4))
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def bodies(position: Array, size: Array, orientation: Array, choice: Array | None = None) -> Body:
    """Bodies of three meshes: a box, a cone and a concave one."""
    lanes = len(position)
    numbers = np.arange(lanes) % 3 if choice is None else choice
    return Body((primitives.box(), primitives.cone(), table()), numbers, Poses(position, orientation, size))


def varied(columns: Sequence[Any], rng: np.random.Generator, lanes: int = LANES) -> list[Any]:
    """The columns of parameters, other numbers in each lane."""
    result: list[Any] = []
    for column in columns:
        values = np.asarray(column)
        if values.dtype.kind == "i":  # which option of a choice
            result.append(np.arange(lanes) % 3)
        elif values.dtype.kind != "f":
            result.append(values)
        elif values.shape[1:] == (4,):
            rows = values + rng.normal(0, 0.3, (lanes, 4))
            result.append(rows / np.linalg.norm(rows, axis=1, keepdims=True))
        elif (values > 0).all():
            result.append(values * rng.uniform(0.8, 1.2, (lanes, *values.shape[1:])))
        else:
            result.append(values + rng.normal(0, 0.2, (lanes, *values.shape[1:])))
    return result


def over_lanes(region: Region, columns: Sequence[Any], seed: int) -> Iterator[str]:
    """Everything that the engine asks of a region, with these columns of its parameters."""
    rng = np.random.default_rng(seed)

    def line(name: str, ask: Callable[[], Any]) -> str:
        return f"{name}: {attempt(ask)}"

    yield line("box", lambda: region.box(*columns))
    yield line("container", lambda: region.container_box(*columns))
    yield line("sizes", lambda: region.sizes(*columns))
    uniforms = rng.uniform(0.02, 0.98, (max(region.draws, 4), LANES))
    keys = rng.integers(0, 2**63, LANES).astype(np.uint64)
    lower, upper = (np.clip(np.broadcast_to(end, (LANES, 3)), -6, 6) for end in region.box(*columns))
    shares = rng.uniform(0, 1, (LANES, 3))
    inner = lower + shares * (upper - lower)
    try:
        drawn, known = region.draw_points(uniforms[: region.draws], keys, *columns)
        drawn = np.broadcast_to(drawn, (LANES, 3))
        yield f"draws: {numbers(drawn)}{'' if known is None else ' found ' + numbers(known)}"
        start = np.array(drawn)
    except Exception as error:  # noqa: BLE001 - what is said of it is the answer
        yield f"draws: {said(error)}".replace("\n", " /")
        start = inner
    way = rng.normal(size=(LANES, 3))
    way *= (1 + np.linalg.norm(upper - lower, axis=1, keepdims=True)) / np.linalg.norm(
        way, axis=1, keepdims=True
    )
    if region.dimension <= 1:  # only what is near is on it
        way *= 3 * max(region.tolerance, 1e-6) / np.linalg.norm(way, axis=1, keepdims=True)
    if region.dimension == 2:
        way[::2, 2] *= 1e-6
    middle = (lower + upper) / 2
    extent = np.maximum(upper - lower, 0.2)
    yield f"points: {_attempted(lambda t: region.contains_points(start + t[:, None] * way, *columns))}"
    yield line("distances", lambda: region.distances(middle + (shares - 0.5) * extent * 2.5, *columns))
    yield line("distances inside", lambda: region.distances(start, *columns))
    yield line("gaps", lambda: region.gaps(middle + (shares - 0.5) * extent * 3, *columns))
    if region.has_orientation:
        yield line("orientations", lambda: region.orientations(start + 0.01, *columns))
    size, turn = rng.uniform(0.5, 1, (LANES, 3)), turns(rng)
    place = start if region.dimension > 2 else inner

    def grown(t: Array) -> Body:
        return bodies(place, size * (1e-3 + 4 * t)[:, None], turn)

    def passing(t: Array) -> Body:
        return bodies(middle + (2 * t - 1)[:, None] * way * 1.1 + 0.01, size * 0.3, turn)

    # Kinds that decide by meshes take their time: fewer steps, and no search where lanes are looked at one by one.
    is_quick = isinstance(region, PlanarRegion | BoxRegion | SpheroidRegion)
    steps = 12 if is_quick else 2 if isinstance(region, ViewRegion) else 3
    yield f"holds growing: {_attempted(lambda t: region.contains_bodies(grown(t), LANES, *columns), steps)}"
    small = bodies(start, size * 0.05, turn)
    yield line("holds small", lambda: region.contains_bodies(small, LANES, *columns))
    alone = Body((table(),), None, Poses(start[:1], turn[:1], size[:1] * 0.1))
    yield line("holds one", lambda: region.contains_bodies(alone, LANES, *columns))
    if type(region).meets_bodies is not Region.meets_bodies and not isinstance(region, UnionRegion):
        yield f"meets growing: {_attempted(lambda t: region.meets_bodies(grown(t), LANES, *columns), 8 if is_quick else 2)}"
    yield line("meets", lambda: region.meets_bodies(passing(np.linspace(0.3, 0.6, LANES)), LANES, *columns))


def _attempted(decide: Decide, steps: int = 14) -> str:
    try:
        return flips(decide, LANES, steps)
    except Exception as error:  # noqa: BLE001 - what is said of it is the answer
        return said(error).replace("\n", " /")
