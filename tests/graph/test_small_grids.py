"""Bounds and inverses on every small box: ends that touch, coincide, are zero, or have either sign.

Random boxes hardly ever meet where a formula changes. Here all boxes whose ends are among a few numbers are tried, with all
values of a finer grid in them.
"""

import itertools
import math

import numpy as np

from graph.programs import B, I, S, U
from graph.readings import CASES, has, kind_of, values_of
from scenic.graph.bounds import Bounds
from scenic.graph.operations import TABLE
from tests.each import each

STEPS = {
    S: (-1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0),
    I: (-2, -1, 0, 1, 2, 3),
    B: (0, 1),
    U: (1 / 16, 1 / 4, 1 / 2, 3 / 4, 15 / 16),
}
"""Values of operands; boxes have their ends among them."""
MOST = 300
"""Boxes of an operation of three operands, at most."""
TURNS = {"sin", "cos", "tan", "normalize angle"}
"""Operations whose formulas change at multiples of a quarter turn."""


def steps(case, part):
    if isinstance(part, tuple):
        return tuple(range(part[1]))
    if case.name in TURNS and part is S:
        return tuple(step * math.pi for step in (-3, -2, -1.5, -1, -0.5, 0, 0.5, 1, 2, 2.5, 3))
    return STEPS["axis" if part == U else part]


def boxes(grid):
    """All pairs of places in a grid, the lower end first."""
    return [(low, high) for low in range(len(grid)) for high in range(low, len(grid))]


class Grid:
    """An operation at all values of its operands' grids, and all boxes of these."""

    def __init__(self, case):
        self.case = case
        self.axes = [steps(case, part) for part in case.operands]
        places = np.array(list(itertools.product(*(range(len(axis)) for axis in self.axes))))
        self.columns = [
            np.array(axis, dtype=kind_of(part).dtype)[column]
            for axis, part, column in zip(self.axes, case.operands, places.T, strict=True)
        ]
        with np.errstate(all="ignore"):
            self.values, fine = values_of(case, self.columns)
        fine &= np.isfinite(self.values)
        ends = np.array(list(itertools.product(*(boxes(axis) for axis in self.axes))))
        if len(self.axes) > 2 and len(ends) > MOST:
            ends = ends[np.random.default_rng(5).choice(len(ends), MOST, replace=False)]
        inside = np.ones((len(ends), len(places)), dtype=bool)
        for operand in range(places.shape[1]):
            low, high = ends[:, operand, :1], ends[:, operand, 1:]
            inside &= (places[:, operand] >= low) & (places[:, operand] <= high)
        self.inside = inside & fine
        self.bounds = [
            Bounds(*(np.array(axis, dtype=float)[ends[:, operand, side]] for side in (0, 1)))
            for operand, axis in enumerate(self.axes)
        ]

    def extremes(self, values, mask):
        """The least and the largest of values ``(n,)`` among those of a mask ``(m, n)``."""
        return np.where(mask, values, np.inf).min(axis=1), np.where(mask, values, -np.inf).max(axis=1)


KINDS = {S, I, B, U}
SMALL = [
    case
    for case in CASES
    if has(case, "bounds")
    and case.name not in {"vector", "from euler", "from yaw"}
    and (case.name != "look-up" or case.payload.column.ndim == 1)
    and 0 < len(case.operands) <= 3
    and all(isinstance(part, tuple) or part in KINDS for part in case.operands)
]
EXACT = {
    *("add", "subtract", "multiply", "negative", "positive", "absolute", "minimum", "maximum"),
    *("less", "less or equal", "greater", "greater or equal", "equal", "not equal"),
    *("and", "or", "not", "select", "look-up", "int", "float"),
}
"""Operations of which bounds say all: their extreme values are at ends."""
NARROWING = {
    *("add", "subtract", "negative", "positive", "minimum", "maximum", "float"),
    *("less", "less or equal", "greater", "greater or equal"),
    *("and", "or", "not", "select"),
}
"""Operations whose inverses leave hardly more than what the results need."""


@each(SMALL)
def test_bounds_of_small_boxes(case):
    grid = Grid(case)
    with np.errstate(all="ignore"):
        known = TABLE[case.name].bounds(case.payload, *grid.bounds)
    low, high = grid.extremes(grid.values, grid.inside)
    met = grid.inside.any(axis=1)
    assert (known.lower <= low)[met].all()
    assert (known.upper >= high)[met].all()
    if case.name in EXACT and ("equal" not in case.name or len(set(case.operands)) == 1):
        np.testing.assert_allclose(np.broadcast_to(known.lower, low.shape)[met], low[met], atol=1e-12)
        np.testing.assert_allclose(np.broadcast_to(known.upper, high.shape)[met], high[met], atol=1e-12)


@each([case for case in SMALL if has(case, "inverse")])
def test_inverses_of_small_boxes(case):
    """Nothing is lost of what gives a result, or one of several next to each other; and where it may be said, little else is kept."""
    grid = Grid(case)
    met = np.unique(grid.values[grid.inside.any(axis=0)])
    some = met[:: max(1, len(met) // 7)]
    for low, high in [*zip(some, some, strict=True), *itertools.pairwise(some)]:
        count = len(grid.inside)
        result = Bounds(np.full(count, low), np.full(count, high))
        consistent = grid.inside & (grid.values >= low) & (grid.values <= high)
        possible = consistent.any(axis=1)
        with np.errstate(all="ignore"):
            parts = TABLE[case.name].inverse(case.payload, result, *grid.bounds)
        for column, before, part, axis in zip(grid.columns, grid.bounds, parts, grid.axes, strict=True):
            left = before if part is None else before.meet(part)
            needed = grid.extremes(column.astype(float), consistent)
            assert (left.lower <= needed[0])[possible].all()
            assert (left.upper >= needed[1])[possible].all()
            if case.name in NARROWING:
                step = np.diff(axis).max() + 1e-9
                assert (left.lower >= needed[0] - step)[possible].all()
                assert (left.upper <= needed[1] + step)[possible].all()
