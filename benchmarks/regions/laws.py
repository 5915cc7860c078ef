"""The laws of the programs of the table, beside plain rejection written in NumPy and shapely: ``python -m benchmarks.regions --laws``.

For each cell, the place of the other object as the ego sees it, and both headings, are compared with those of candidates that
rejection accepts (Kolmogorov and Smirnov's test for each coordinate and two mixtures). The last line pools all p-values:
under the same laws they are uniform. Scenes are also the same at 1, 7 and 512 lanes. Meshes, intersections of bodies with solids,
and what an object sees are left to the tests of geometry and visibility.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import stats

import scenic
from benchmarks.regions.programs import QUESTIONS, REGIONS, program

SCENES: Final = 300
LIKELY: Final = 0.001
_SIDES: Final = 128
_CORNERS: Final = np.array([(x, y) for x, y in ((0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5))])
_SOLID_CORNERS: Final = np.array([(*corner, z) for corner in _CORNERS for z in (-0.5, 0.5)])
_ROOM: Final = shapely.Polygon([(-9, -9), (9, -9), (9, 0), (0, 2), (0, 9), (-9, 9)])

Floats = NDArray[np.float64]
Ego = tuple[float, float, float]
"""Position and heading."""


def _disc(x: float, y: float, radius: float) -> Any:
    ways = np.arange(_SIDES) * (2 * math.pi / _SIDES)
    return shapely.Polygon(np.column_stack([x + radius * np.cos(ways), y + radius * np.sin(ways)]))


def _rectangle(x: float, y: float, heading: float, width: float, length: float) -> Any:
    return shapely.Polygon(_turned(_CORNERS * (width, length), heading) + np.array([x, y]))


def _sector(ego: Ego, radius: float) -> Any:
    x, y, heading = ego
    ways = heading + np.radians(np.linspace(-50, 50, 100))
    arc = np.column_stack([x - radius * np.sin(ways), y + radius * np.cos(ways)])
    return shapely.Polygon([(x, y), *arc])


def _turned(points: Floats, heading: float) -> Floats:
    cos, sin = math.cos(heading), math.sin(heading)
    return np.column_stack([points[:, 0] * cos - points[:, 1] * sin, points[:, 0] * sin + points[:, 1] * cos])


FLAT: Final[dict[str, Callable[[Ego], Any]]] = {
    "disc": lambda ego: _disc(*ego[:2], 5),
    "rectangle": lambda ego: _rectangle(*ego, 8, 6),
    "sector": lambda ego: _sector(ego, 6),
    "disc minus disc": lambda ego: _disc(*ego[:2], 6).difference(_disc(ego[0] + 1, ego[1], 2)),
    "rectangle minus rectangle": lambda ego: _rectangle(*ego, 10, 8).difference(
        _rectangle(ego[0] + 1, ego[1], 0, 2, 3)
    ),
    "polygon minus sector": lambda ego: _ROOM.difference(_sector(ego, 4)),
    "polygon and disc": lambda ego: _ROOM.intersection(_disc(*ego[:2], 6)),
}
"""Regions of the plane at an ego, as polygons."""


def _solid(name: str, ego: Ego, points: Floats) -> Floats:
    """Distances of points from a solid; 0 inside."""
    local = points - np.array([*ego[:2], 0.0])
    if name == "ball":
        return np.asarray(np.maximum(np.linalg.norm(local, axis=1) - 4.5, 0))
    local[:, :2] = _turned(local[:, :2], -ego[2])
    return np.asarray(np.linalg.norm(np.maximum(np.abs(local) - np.array([4, 3, 2.5]), 0), axis=1))


SOLID: Final = ("box", "ball")


def _accepts_flat(region: Any, question: str, place: Floats, heading: float) -> bool:
    outline = shapely.Polygon(_turned(_CORNERS, heading) + place[:2])
    match question:
        case "drawn":
            return bool(region.covers(shapely.Point(place[:2])))
        case "contained in":
            return bool(region.covers(shapely.Point(place[:2])) and region.covers(outline))
        case "regionContainedIn":
            return bool(region.covers(outline))
        case "not (a in r)":
            return not region.covers(outline)
        case "not (a intersects r)":
            return not region.intersects(outline)
        case _:
            return math.hypot(region.distance(shapely.Point(place[:2])), place[2]) < 2


def _accepts_solid(name: str, ego: Ego, question: str, place: Floats, heading: float) -> bool:
    corners = np.column_stack([_turned(_SOLID_CORNERS[:, :2], heading), _SOLID_CORNERS[:, 2]]) + place
    holds = bool((_solid(name, ego, corners) == 0).all())
    at = float(_solid(name, ego, place[np.newaxis])[0])
    match question:
        case "drawn":
            return at == 0
        case "contained in":
            return at == 0 and holds
        case "regionContainedIn":
            return holds
        case "not (a in r)":
            return not holds
        case _:
            return at < 2


def rejected(name: str, question: str, count: int, rng: np.random.Generator) -> Floats:
    """Rows of what `found` reads, of so many candidates that are accepted."""
    is_drawn = question in ("drawn", "contained in")
    rows = []
    while len(rows) < count:
        ego = (*rng.uniform(-5, 5, 2), rng.uniform(0, 2 * math.pi))
        heading = 0.0 if question == "drawn" else rng.uniform(0, 2 * math.pi)
        region = FLAT[name](ego) if name in FLAT else None
        # What is drawn from a region is drawn for this ego until it lies in it; only then the rest may reject both.
        while True:
            place = (
                rng.uniform(-9, 9, 3) if not is_drawn else np.array([*ego[:2], 0.0]) + rng.uniform(-16, 16, 3)
            )
            if region is not None:
                place[2] = 0.0 if is_drawn else rng.uniform(-0.5, 0.5)
            elif is_drawn:
                place[2] = rng.uniform(-5, 5)
            else:
                place[2] = rng.uniform(-0.5, 0.5)
            if not is_drawn or _accepts(name, region, ego, "drawn", place, 0.0):
                break
        if _accepts(name, region, ego, question, place, heading):
            rows.append(_row(ego, place, heading))
    return np.array(rows)


def _accepts(name: str, region: Any, ego: Ego, question: str, place: Floats, heading: float) -> bool:
    if region is None:
        return _accepts_solid(name, ego, question, place, heading)
    return _accepts_flat(region, question, place, heading)


def _row(ego: Ego, place: Sequence[float], heading: float) -> Sequence[float]:
    return (*ego, *place, heading % (2 * math.pi))


def found(text: str, count: int, lanes: int | None = None) -> Floats:
    """Rows ``(count, 7)``: position and heading of the ego, those of the other object."""
    rows = []
    for scene in scenic.scenarioFromString(text).sample(count, seed=1, lanes=lanes):
        ego, other = scene.objects
        start = (ego.position.x, ego.position.y, ego.heading % (2 * math.pi))
        rows.append(_row(start, tuple(other.position), other.heading))
    return np.array(rows)


def same_law(one: Floats, two: Floats) -> list[float]:
    """P-values of coordinates, of places as the ego sees them, and of two mixtures."""

    def seen(rows: Floats) -> Floats:
        offsets = np.array([_turned(row[np.newaxis, 3:5] - row[:2], -row[2])[0] for row in rows])
        mixed = rows @ np.array([[1, 0.7, 0.5, -0.8, 0.6, 0.3, 0.4], [-0.4, 1, 0.2, 0.9, -0.7, 1, 0.1]]).T
        return np.column_stack([rows, offsets, mixed])

    a, b = seen(one), seen(two)
    varying = [column for column in range(a.shape[1]) if np.ptp(b[:, column]) > 1e-9]
    return [float(stats.ks_2samp(a[:, column], b[:, column]).pvalue) for column in varying]


def main() -> bool:
    """Print the least p-value of each cell and the pooled one; whether all is as it should be."""
    pooled: list[float] = []
    is_right = True
    for name in REGIONS:
        for question in QUESTIONS:
            known = name in FLAT or (name in SOLID and question != "not (a intersects r)")
            text = program(name, question)
            alike = [found(text, 20, lanes) for lanes in (1, 7, 512)]
            same = all((other == alike[0]).all() for other in alike[1:])
            line = "the same at 1, 7 and 512 lanes" if same else "NOT the same at 1, 7 and 512 lanes"
            if known:
                rng = np.random.default_rng(len(pooled))
                values = same_law(found(text, SCENES), rejected(name, question, SCENES, rng))
                pooled += values
                line += f"; least p of {len(values)}: {min(values):.4f}"
            is_right &= same
            print(f"{name:26} {question:20} {line}", flush=True)
    least = min(pooled) * len(pooled)
    print(f"{len(pooled)} tests; the least p-value times their number: {least:.3f}")
    return is_right and least > LIKELY


__all__ = ["found", "main", "rejected", "same_law"]
