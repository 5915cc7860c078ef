"""Bounds widened for rounding, beside NumPy's own neighbours of numbers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from scenic.graph.bounds import outward

EDGES = (0.0, -0.0, 5e-324, -5e-324, 2.2250738585072014e-308, 1.7976931348623157e308, -1.7976931348623157e308)
INFINITE = (float("inf"), float("-inf"), float("nan"))


@settings(max_examples=100, deadline=None)
@given(
    arrays.arrays(np.float64, st.integers(1, 300), elements=st.floats(width=64) | st.sampled_from(EDGES)),
    st.integers(1, 3),
)
def test_widened_bounds_are_neighbours_in_every_bit(values: np.ndarray, ulps: int) -> None:
    values = np.concatenate([np.tile(EDGES + INFINITE, 15), values])
    lower = upper = values
    with np.errstate(over="ignore"):
        for _ in range(ulps):
            lower, upper = np.nextafter(lower, -np.inf), np.nextafter(upper, np.inf)
        found = outward(values, values, ulps)
    assert found.lower.tobytes() == lower.tobytes()
    assert found.upper.tobytes() == upper.tobytes()


@pytest.mark.parametrize("shape", [(3, 4, 100), (1200,)])
def test_widened_bounds_keep_shape_and_order_in_memory(shape: tuple[int, ...]) -> None:
    values = np.random.default_rng(1).normal(size=shape).T
    assert (outward(values, values).upper == np.nextafter(values, np.inf)).all()
    assert (outward(values[::2], values[::2]).lower == np.nextafter(values[::2], -np.inf)).all()
    integers = np.arange(200)
    assert (outward(integers, integers).lower == np.nextafter(integers, -np.inf)).all()
