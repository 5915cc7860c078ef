"""Recorded answers of functions over lanes: where decisions flip, and what numbers come out, as lines of text."""

from collections.abc import Callable
from typing import Any

import numpy as np
import shapely
import trimesh

from scenic.graph.bounds import Bounds
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.regions.base import Region
from tests.recorded import said, shown

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
