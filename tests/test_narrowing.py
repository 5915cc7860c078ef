"""Conditions narrow the cube to the boxes of the candidates that meet them, as NumPy evaluates them, and to little more."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

import scenic
from scenic.analysis.fact_diagnostics import prove
from scenic.narrowing import conditions

PROGRAM = """
x = Range(-2, 3)
y = Range(1, 4)
z = Range(-1, 1)
n = DiscreteRange(-3, 6)
g = Normal(1, 2)
v = Vector(x, y, z)
c = CircularRegion((x, 0), y)
b = BoxRegion(position=(x, 1, 2), dimensions=(y, 2, 3))
k = SpheroidRegion(position=(x, 1, 2), dimensions=(y, 2, 3))
q = RectangularRegion((x, 1, 0), 0.3, y, 4)
ego = new Object with places (x, y, z, n, g)
"""
AXES = 5
ROWS: NDArray[np.float64] = np.random.default_rng(0).random((20_000, AXES))
X, Y, Z = -2 + 5 * ROWS[:, 0], 1 + 3 * ROWS[:, 1], -1 + 2 * ROWS[:, 2]
VALUES = {
    "x": X,
    "y": Y,
    "z": Z,
    "n": -3 + np.floor(10 * ROWS[:, 3]),
    "g": stats.norm.ppf(ROWS[:, 4]) * 2 + 1,
    "abs": np.abs,
    "round": np.round,
    "np": np,
}
SAME = (
    """
x > 1; x < -1.5; x + y > 6; x - y > 1; x * y < -6; x / y > 2; y / x < -3; x * x > 5; x ** 2 < 0.5; x ** 3 > 10; 2 ** x > 6
y ** z > 3.5; x // 2 == 1; n // 2 == 1; x % 2 > 1.8; n % 3 == 2; -x > 1.5; abs(x) < 0.4; abs(x) > 2.7; round(x) == 3
n == 4; n != 4; n > 4.5; n * 2 < -4; g > 5; g < -4; abs(g) < 0.5; round(n / 2) == -2; round(n / 2) == 0
""".strip()
    .replace("\n", "; ")
    .split("; ")
)
"""Conditions whose text is the same in NumPy."""

SAID_OTHERWISE = {
    "min(x, y) > 2": "np.minimum(x, y) > 2",
    "max(x, y) < 1.5": "np.maximum(x, y) < 1.5",
    "max(x, y, z) > 3.9": "y > 3.9",
    "x > 1 and y < 2": "(x > 1) & (y < 2)",
    "x > 2.5 or x < -1.5": "(x > 2.5) | (x < -1.5)",
    "not x < 2": "x >= 2",
    "not (x > -1 and y > 2)": "(x <= -1) | (y <= 2)",
    "x > 2 if z > 0 else x < -1": "np.where(z > 0, x > 2, x < -1)",
    "0 < x < y < 2": "(0 < x) & (x < y) & (y < 2)",
    "n in [1, 2]": "(n == 1) | (n == 2)",
    "v.norm() > 4.8": "np.sqrt(x * x + y * y + z * z) > 4.8",
    "v[2] < -0.5": "z < -0.5",
    "v.cross((1, 0, 0)).y > 0.9": "z > 0.9",
    "v.distanceTo((1, 1, 0)) < 0.5": "np.sqrt((x - 1) ** 2 + (y - 1) ** 2 + z * z) < 0.5",
    "(distance from v to (3, 4, 1)) < 0.7": "np.sqrt((x - 3) ** 2 + (y - 4) ** 2 + (z - 1) ** 2) < 0.7",
}
LOOSE = {
    "v.dot((1, 2, 3)) > 11": "x + 2 * y + 3 * z > 11",
    "(2.9, 0.5) in c": "np.hypot(x - 2.9, 0.5) <= y",
    "(2.9, 1.5, 2) in b": "np.abs(x - 2.9) <= y / 2",
    "(2.9, 1, 2) in k": "np.abs(x - 2.9) <= y / 2",
    "(2.9, 1) in q": "np.abs(2.9 - x) * np.cos(0.3) <= y / 2",
}
"""Conditions whose boxes are looser, or of which few rows reach the corners."""


@pytest.mark.parametrize("condition", [*SAME, *SAID_OTHERWISE, *LOOSE])
def test_what_is_left_holds_what_meets_a_condition_and_little_more(condition: str) -> None:
    holds = eval({**SAID_OTHERWISE, **LOOSE}.get(condition, condition), VALUES)
    slack = 0.25 if condition in LOOSE else 0.05
    domain = scenic.scenarioFromString(f"{PROGRAM}require {condition}\n").domain
    ((lower,), (upper,)), rows = domain.hull, ROWS[holds]
    assert (lower <= rows.min(axis=0)).all()
    assert (rows.max(axis=0) <= upper).all()
    if condition != "n != 4":  # nearly all candidates meet it: it is not worth boxes
        assert (rows.min(axis=0) - lower).max() < slack
        assert (upper - rows.max(axis=0)).max() < slack
        assert domain.volume < 1.35 * holds.mean() + slack


@pytest.mark.parametrize(
    "condition", ["x > 3", "x + y > 7", "x > 2 and x < 1", "n == 7", "v.norm() > 6", "(9, 9) in c", "v.z > 1"]
)
def test_what_no_candidate_meets_is_proved_impossible(condition: str) -> None:
    outline = scenic.scenarioFromString(f"{PROGRAM}require {condition}\n").outline
    assert [diagnostic.code for diagnostic in prove(outline.graph, conditions(outline))] == ["SC700"]
