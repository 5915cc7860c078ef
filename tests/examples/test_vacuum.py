"""The case study of the robot vacuum: its room, its controller, and the area that it covers."""

import importlib.util
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.runtime.geometry.meshes import convex_parts
from tests.amounts import LONG, amount

if importlib.util.find_spec("mujoco") is None:
    pytest.skip("needs the extra [mujoco]", allow_module_level=True)

PROGRAM = Path(__file__).parents[2] / "examples" / "vacuum" / "vacuum.scenic"


@pytest.mark.slow
def test_the_vacuum_drives_turns_and_covers_the_floor(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = amount(60, 120)
    if not LONG:  # Rougher parts of the furniture are found in half the time.
        monkeypatch.setattr(
            convex_parts, "_SEARCH", {**convex_parts._SEARCH, "mcts_iterations": 10, "resolution": 200}
        )
    scenario = scenic.load(PROGRAM, params={"numToys": 2, "duration": steps / 4})
    scene = scenario.sample(1, seed=1)[0]
    kinds = [type(thing).__name__ for thing in scene.objects]
    assert (kinds.count("Chair"), kinds.count("Block"), kinds.count("Toy")) == (4, 3, 2)
    for thing in scene.objects:
        if type(thing).__name__ in ("DiningTable", "Chair", "Couch"):
            flat = [(corner[0], corner[1]) for corner in thing.corners]
            assert min(math.dist(place, scene.egoObject.position[:2]) for place in flat) > 1 - 0.3
    (row,) = scenario.simulate(1, seed=1, max_steps=steps, keep_violations=True)
    assert row.about is not None
    assert row.about["steps"] == steps
    path = np.array([place for _, place in row.about["records"]["path"]])
    pace = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1) / 0.25
    assert pace[:2].max() < 0.01  # it starts after half a second
    assert np.median(pace[pace > 0.45]) == pytest.approx(16 * 0.031, rel=0.03)
    assert row.about["records"]["covered"] == pytest.approx(raster(path[:-1]) / 25, abs=0.001)
    (requirement,) = row.about["requirements"]
    assert requirement["robustness"] == pytest.approx(row.about["records"]["covered"] - 1 / 3, abs=0.03)


def raster(path: Any) -> float:
    """The area within 0.1675 m of a path, by points 2 cm apart, square metres."""
    axis = np.arange(-2.5, 2.5, 0.02) + 0.01
    x, y = np.meshgrid(axis, axis)
    covered = np.zeros(x.shape, dtype=bool)
    for start, end in pairwise(path):
        along = end[:2] - start[:2]
        length = float(along @ along) or 1.0
        share = np.clip(((x - start[0]) * along[0] + (y - start[1]) * along[1]) / length, 0, 1)
        covered |= np.hypot(x - start[0] - share * along[0], y - start[1] - share * along[1]) < 0.335 / 2
    return float(covered.sum()) * 0.02**2
