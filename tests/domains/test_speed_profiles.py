"""Speeds along paths: never above limits, and braked before junctions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenic.domains.driving.speed_profiles import Comfort, _least_within, speeds_along

ALONG = np.arange(0.0, 300.0, 0.5)
COMFORT = Comfort()


def limits(lows: list[tuple[int, float]], width: int = 20) -> np.ndarray:
    """Limits of 20 m/s, lower over ten metres from points on."""
    values = np.full(len(ALONG), 20.0)
    for begin, low in lows:
        values[begin : begin + width] = np.minimum(values[begin : begin + width], low)
    return values


@settings(max_examples=40)
@given(
    st.lists(st.tuples(st.integers(200, 560), st.floats(3.0, 19.0)), min_size=1, max_size=4),
    st.integers(160, 400),
    st.integers(10, 100),
)
def test_nobody_brakes_in_a_junction_for_what_comes_after(
    lows: list[tuple[int, float]], begin: int, length: int
) -> None:
    allowed = limits(lows)
    end = min(begin + length, len(ALONG) - 60)
    # Within the junction the limit is even: only what comes after it could ask for less.
    allowed[begin : end + 1] = allowed[begin : end + 1].min()
    speeds, accelerations = speeds_along(ALONG, allowed, 10.0, COMFORT, junctions=[(begin, end)])
    assert accelerations[begin : end + 1].min() > -0.5
    assert (speeds <= allowed + 0.05).all()
    assert accelerations.min() > -1.05 * COMFORT.deceleration


def test_a_car_that_is_too_fast_for_that_brakes_in_the_junction() -> None:
    speeds, accelerations = speeds_along(ALONG, limits([(150, 5.0)]), 16.0, COMFORT, junctions=[(20, 120)])
    assert accelerations[20:120].min() == pytest.approx(-COMFORT.deceleration, abs=0.5)
    assert speeds[155] <= 5.05


def test_junctions_count_though_the_car_is_too_fast_for_a_bend_before_them() -> None:
    allowed = limits([(20, 3.0), (150, 4.0)])
    _, accelerations = speeds_along(ALONG, allowed, 8.0, COMFORT, junctions=[(20, 40), (100, 145)])
    assert accelerations[:20].min() < -1.2 * COMFORT.deceleration
    assert accelerations[100:145].min() > -0.5


@pytest.mark.parametrize("speed", [14.0, 16.0, 17.0, 17.6])
def test_who_plans_anew_brakes_no_harder(speed: float) -> None:
    allowed = limits([(120, 5.0)], width=300)
    speeds, accelerations = speeds_along(ALONG, allowed, speed, COMFORT)
    hardest = accelerations.min()
    for place in range(5, 110, 7):
        _, anew = speeds_along(
            ALONG[place:],
            allowed[place:],
            float(speeds[place]),
            COMFORT,
            acceleration=float(accelerations[place]),
        )
        assert anew.min() > 1.1 * hardest - 0.1


@settings(max_examples=60)
@given(st.lists(st.floats(0.0, 30.0), min_size=1, max_size=80), st.integers(0, 120), st.integers(0, 120))
def test_least_values_around_points(values: list[float], before: int, after: int) -> None:
    places = range(len(values))
    least = [min(values[max(0, place - before) : place + after + 1]) for place in places]
    assert _least_within(np.array(values), before, after).tolist() == least
