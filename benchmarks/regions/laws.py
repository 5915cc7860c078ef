"""The laws of the programs of the table, beside plain rejection written in NumPy and shapely: ``python -m benchmarks.regions --laws``.

For each cell, the place of the other object as the ego sees it, and both headings, are compared with those of candidates that
rejection accepts (Kolmogorov and Smirnov's test for each coordinate and two mixtures). The last line pools all p-values: the least
of them times their number is below 0.001 that often under equal laws. Scenes are also the same at 1, 7, 512 and 4,096 lanes.
"""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy import stats

import scenic
from benchmarks.regions.oracles import ORACLES, Ego, Floats, Oracle, turned
from benchmarks.regions.programs import QUESTIONS, REGIONS, program

SCENES: Final = 300
LANES: Final = (1, 7, 512, 4096)
LIKELY: Final = 0.001
_TOGETHER: Final = 64
"""Points that are drawn together until one lies in a region."""


def _accepts(region: Oracle, question: str, place: Floats, heading: float) -> bool:
    match question:
        case "drawn":
            return True
        case "contained in" | "regionContainedIn":
            return region.holds(place, heading)
        case "not (a in r)":
            return not region.holds(place, heading)
        case "not (a intersects r)":
            return not region.meets(place, heading)
        case _:
            return region.distance(place) < 2


def _drawn(region: Oracle, ego: Ego, rng: np.random.Generator) -> Floats:
    """A uniform point of a region."""
    while True:
        points = np.array([*ego[:2], 0.0]) + rng.uniform(-16, 16, (_TOGETHER, 3)) * (1, 1, 5 / 16)
        inside = np.flatnonzero(region.covers(points))
        if len(inside):
            return np.asarray(points[inside[0]] * (1, 1, 0 if region.is_flat else 1))


def rejected(name: str, question: str, count: int, rng: np.random.Generator) -> Floats:
    """Rows of the values that `found` reads, from a number of accepted candidates."""
    is_drawn = question in ("drawn", "contained in")
    rows: list[Sequence[float]] = []
    while len(rows) < count:
        ego = (*rng.uniform(-5, 5, 2), rng.uniform(0, 2 * math.pi))
        heading = 0.0 if question == "drawn" else rng.uniform(0, 2 * math.pi)
        region = ORACLES[name](ego)
        # What is drawn from a region is drawn for this ego until it lies in it; only then the rest may reject both.
        place = _drawn(region, ego, rng) if is_drawn else rng.uniform(-1, 1, 3) * (9, 9, 0.5)
        if _accepts(region, question, place, heading):
            rows.append(_row(ego, place, heading))
    return np.array(rows)


def _row(ego: Ego, place: Sequence[float] | Floats, heading: float) -> Sequence[float]:
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
        offsets = np.array([turned(row[np.newaxis, 3:5] - row[:2], -row[2])[0] for row in rows])
        mixed = rows @ np.array([[1, 0.7, 0.5, -0.8, 0.6, 0.3, 0.4], [-0.4, 1, 0.2, 0.9, -0.7, 1, 0.1]]).T
        return np.column_stack([rows, offsets, mixed])

    a, b = seen(one), seen(two)
    varying = [column for column in range(a.shape[1]) if np.ptp(b[:, column]) > 1e-9]
    return [float(stats.ks_2samp(a[:, column], b[:, column]).pvalue) for column in varying]


def main(regions: Sequence[str] | None = None, questions: Sequence[str] | None = None) -> bool:
    """Print the least p-value of each cell and the pooled one; whether all is as it should be."""
    pooled: list[float] = []
    is_right = True
    for name in regions or REGIONS:
        for question in questions or QUESTIONS:
            text = program(name, question)
            first, *others = (found(text, 20, lanes) for lanes in LANES)
            same = all((other == first).all() for other in others)
            rng = np.random.default_rng(len(pooled))
            values = same_law(found(text, SCENES), rejected(name, question, SCENES, rng))
            pooled += values
            is_right &= same
            line = f"{'the same' if same else 'NOT the same'} at {', '.join(map(str, LANES))} lanes"
            print(f"{name:26} {question:20} {line}; least p of {len(values)}: {min(values):.4f}", flush=True)
    least = min(pooled) * len(pooled)
    print(f"{len(pooled)} tests; the least p-value times their number: {least:.3f}")
    return is_right and least > LIKELY


__all__ = ["found", "main", "rejected", "same_law"]
