"""Containment narrows the distributions before sampling: few candidates, and the law of those that rejection accepts.

The other program draws from a range that just holds the workspace, in the whole cube: its scenes have the same law by rejection.
"""

from typing import Any

import numpy as np
import pytest
from scipy import stats

from tests.amounts import amount
from tests.runtime.programs import scenario, unpruned

LIKELY = 0.001
"""What a p-value must be at least; seeds are fixed."""

SMALL = "with width 0.5, with length 0.5, with height 0.5, with allowCollisions True"
WORKSPACES = {
    "box": ("BoxRegion((2, 2, 2))", 2),
    "square": ("RectangularRegion((0, 0, 0), 0, 2, 2)", 2),
    "turned": ("RectangularRegion((0, 0, 0), 0.4, 2, 1.4)", 4),
    "disc": ("CircularRegion((0, 0, 0), 1)", 4),
    "ball": ("SpheroidRegion(dimensions=(2, 2.5, 2))", 5),
    "corner": ("PolygonalRegion([(-1, -1), (1, -1), (1, 0), (0, 0), (0, 1), (-1, 1)])", 5),
}
"""Each with how many candidates a scene may take on average."""


def sampled(program: Any, seed: int, n: int = amount(250, 500)) -> tuple[np.ndarray[Any, Any], float]:
    scenes = program.sample(n, seed=seed)
    rows = [[*scene.objects[0].position, scene.objects[0].heading] for scene in scenes]
    return np.array(rows), float(np.mean([scene.attempts for scene in scenes]))


def same_law(found: np.ndarray[Any, Any], expected: np.ndarray[Any, Any]) -> None:
    mixed = np.array([1.0, 0.7, 0.3, -0.4])
    for column in range(found.shape[1]):
        assert stats.ks_2samp(found[:, column], expected[:, column]).pvalue > LIKELY
    assert stats.ks_2samp(found @ mixed, expected @ mixed).pvalue > LIKELY


@pytest.mark.parametrize("name", WORKSPACES)
def test_a_wide_range_in_a_small_workspace(name: str) -> None:
    region, most = WORKSPACES[name]
    text = (
        f"workspace = Workspace({region})\n"
        f"ego = new Object at (Range(-{{0}}, {{0}}), Range(-{{0}}, {{0}}), 0), facing Range(-1, 2), {SMALL}\n"
    )
    found, attempts = sampled(scenario(text.format(100)), 1)
    assert attempts <= most
    expected, rejected = sampled(unpruned(text.format(1.5)), 2)
    assert rejected > attempts
    same_law(found, expected)


@pytest.mark.parametrize("region", ["RectangularRegion((0, 0, 0), 0, 2, 2)", "BoxRegion((2, 2, 2))"])
def test_a_unit_cube_in_a_workspace_of_two_by_two(region: str) -> None:
    found, attempts = sampled(
        scenario(f"workspace = Workspace({region})\nego = new Object in workspace\n"), 1
    )
    assert attempts == 1
    for column in range(3 if "Box" in region else 2):
        assert stats.kstest(found[:, column], stats.uniform(-0.5, 1).cdf).pvalue > LIKELY
        assert np.abs(found[:, column]).max() <= 0.5 + 1e-9
    corner = found[:, 0] + found[:, 1]
    assert stats.kstest(corner, stats.triang(0.5, -1, 2).cdf).pvalue > LIKELY


def test_a_wide_range_twice_needs_two_candidates() -> None:
    """Each object once in a direction of its own; where both reach the middle they collide, in a quarter of the cases."""
    text = (
        "workspace = Workspace(BoxRegion((2, 2, 2)))\n"
        "ego = new Object at (Range(-100, 100), 0, 0), with width 0.5, with length 0.5, with height 0.5\n"
        "other = new Object at (0, Range(-100, 100), 0), with width 0.5, with length 0.5, with height 0.5\n"
    )
    scenes = scenario(text).sample(500, seed=1)
    assert np.mean([scene.attempts for scene in scenes]) <= 2
    x = np.array([[scene.objects[0].x, scene.objects[1].y] for scene in scenes])
    # Uniform in the square of the possible places, but for the smaller square in which they touch.
    assert (np.abs(x) <= 0.75 + 1e-9).all()
    assert (np.abs(x).max(axis=1) >= 0.5 - 1e-9).all()
    rng = np.random.default_rng(1)
    drawn = rng.uniform(-0.75, 0.75, (4000, 2))
    expected = drawn[np.abs(drawn).max(axis=1) > 0.5]
    for one, another in (
        (x[:, 0], expected[:, 0]),
        (x[:, 1], expected[:, 1]),
        (x.sum(axis=1), expected.sum(axis=1)),
        (np.abs(x).min(axis=1), np.abs(expected).min(axis=1)),
    ):
        assert stats.ks_2samp(one, another).pvalue > LIKELY
