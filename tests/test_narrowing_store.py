"""Narrowed domains that are kept: equal to those that are computed, and used only where the code that made them is the same."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from scenic import Scenario, narrowing_store, scenarioFromString
from scenic.analysis import contraction
from scenic.graph.domain import Domain
from scenic.runtime.geometry.store import find

CORRIDOR = """
ego = new Object at (0, 0, 0), facing Range(0, 360) deg
other = new Object at (Range(-9, 9), Range(-9, 9), 0), facing Range(0, 360) deg
third = new Object at (Range(-9, 9), Range(-9, 9), 0)
require abs(relative heading of other from ego) < 5 deg
require 2 < (distance from ego to other) < 3
require 2 < (distance from other to third) < 2.5
"""

IMPOSSIBLE = """
ego = new Object at (Range(0, 1), 0, 0)
require ego.x * ego.x > 2
"""


@pytest.fixture(autouse=True)
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A store of its own, in which everything is kept."""
    monkeypatch.setenv("SCENIC_CACHE", "")
    monkeypatch.setenv("SCENIC_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(narrowing_store, "_WORTH", 0.0)
    return tmp_path


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[object]]:
    """The calls of the analysis."""
    made: list[object] = []

    def counted(*arguments: object) -> contraction.Pruning:
        made.append(arguments)
        return contraction.contract(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(narrowing_store, "contract", counted)
    return iter([made])


def content(domain: Domain) -> list[bytes]:
    return [array.tobytes() for part in domain.parts for array in (part.lower, part.upper)]


def poses(scenario: Scenario) -> list[list[tuple[float, ...]]]:
    return [
        [(*item.position, item.yaw) for item in scene.objects]
        for scene in scenario.sample(20, seed=3, max_attempts=None)
    ]


def test_a_second_load_is_not_analysed_and_gives_the_same_scenes(
    calls: Iterator[list[object]], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = next(calls)
    first, second = scenarioFromString(CORRIDOR), scenarioFromString(CORRIDOR)
    assert len(made) == 1
    monkeypatch.setenv("SCENIC_CACHE", "off")
    without = scenarioFromString(CORRIDOR)
    assert len(made) == 2
    domains = [each._sampler.plan.domain for each in (first, second, without)]
    assert domains[0].volume < 0.5
    assert content(domains[0]) == content(domains[1]) == content(domains[2])
    assert poses(first) == poses(second) == poses(without)


def test_requirements_that_cannot_hold_are_kept(calls: Iterator[list[object]]) -> None:
    made = next(calls)
    first, second = scenarioFromString(IMPOSSIBLE), scenarioFromString(IMPOSSIBLE)
    assert len(made) == 1
    assert first._sampler.impossible == second._sampler.impossible != ()


@pytest.mark.parametrize("fault", ["code", "damage", "content"])
def test_what_other_code_made_is_not_used(
    store: Path, calls: Iterator[list[object]], monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    made = next(calls)
    first = scenarioFromString(CORRIDOR)
    (file,) = store.glob("*.arrays")
    if fault == "code":
        monkeypatch.setattr(narrowing_store, "library_version", lambda _library: "another")
    elif fault == "damage":
        file.write_bytes(file.read_bytes()[:-20])
    else:
        # Whole, and of the same code, but with boxes that are none.
        monkeypatch.setattr(
            narrowing_store, "find", lambda *key: {**(find(*key) or {}), "lower 0": np.ones((3, 1))}
        )
    second = scenarioFromString(CORRIDOR)
    assert len(made) == 2
    assert content(first._sampler.plan.domain) == content(second._sampler.plan.domain)
