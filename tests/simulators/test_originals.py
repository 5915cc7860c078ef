"""Containers that simulations share with the program: aliases hold, and each simulation finds them as at first."""

from pathlib import Path

import pytest

import scenic
from scenic.simulators.dummy import DummySimulator

HELPER = """
log = []

def note(item):
    log.append(item)

class Holder:
    def __init__(self, items):
        self.items = items

    def add(self, item):
        self.items.append(item)
"""

PROGRAM = """
from collections import deque
from functools import partial
import numpy
from aliases_of_containers import Holder, log, note
own, drawn, pairs, queue = [], [Range(0, 1)], {}, deque(maxlen=2)
put, three, enter, push = own.append, partial(own.append, 3), pairs.setdefault, queue.append
held = []
holder = Holder(held)
grid = numpy.zeros((2, 2))
row = grid[0]
tagged = [log]
behavior B():
    while True:
        note("x")
        put(1)
        three()
        enter(len(pairs), "y")
        push(simulation().currentTime)
        holder.add(2)
        row[1] += 1
        drawn.append(1)
        self.mine.append(1)
        wait
ego = new Object with behavior B, with mine []
record len(log) as log
record len(tagged[0]) as tagged
record len(own) as own
record len(pairs) as pairs
record list(queue) as queue
record len(held) as held
record grid[0, 1] as grid
record len(drawn) as drawn
record len(ego.mine) as mine
record own as whole
require len(own) == 0
"""


@pytest.fixture
def scenario(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> scenic.Scenario:
    (tmp_path / "aliases_of_containers.py").write_text(HELPER)
    path = tmp_path / "main.scenic"
    path.write_text(PROGRAM)
    monkeypatch.syspath_prepend(tmp_path)
    return scenic.load(path)


def _course(records: dict[str, list[tuple[int, object]]]) -> dict[str, list[object]]:
    return {name: [value for _, value in series] for name, series in records.items()}


EXPECTED = {
    **{name: [0, 1, 2, 3] for name in ("log", "tagged", "pairs", "held", "mine")},
    "own": [0, 2, 4, 6],
    "queue": [[], [0], [0, 1], [1, 2]],
    "grid": [0, 1, 2, 3],
    "drawn": [1, 2, 3, 4],
    "whole": [[], [1, 3], [1, 3] * 2, [1, 3] * 3],
}


def test_aliases_hold_and_simulations_are_independent(scenario: scenic.Scenario) -> None:
    first, second = scenario.sample(2, seed=1)
    results = [
        DummySimulator().simulate(scene, maxSteps=3, maxIterations=1).result
        for scene in (first, second, first)
    ]
    for result in results:
        assert _course(result.records) == EXPECTED


def test_what_the_last_simulation_left_is_there_to_be_seen_but_not_by_scenes(
    scenario: scenic.Scenario,
) -> None:
    import aliases_of_containers

    (before,) = scenario.sample(1, seed=1)
    DummySimulator().simulate(before, maxSteps=3)
    assert aliases_of_containers.log == ["x"] * 3
    (after,) = scenario.sample(1, seed=1)
    assert before.objects[0].mine == after.objects[0].mine == []
    assert aliases_of_containers.log == ["x"] * 3


def test_interleaved_simulations_do_not_see_each_other(scenario: scenic.Scenario) -> None:
    scene, _ = scenario.generate(seed=1)
    simulator = DummySimulator()
    first, second = (
        simulator.createSimulation(scene, maxSteps=3, name=name, timestep=1, verbosity=0, deferred=True)
        for name in "ab"
    )
    for simulation in (first, second):
        simulation.begin()
    while first.advanceOnce() | second.advanceOnce():
        pass
    for simulation in (first, second):
        course = _course(simulation.result.records)
        for name in ("own", "pairs", "queue", "drawn", "mine", "whole"):  # what no Python module holds, too
            assert course[name] == EXPECTED[name]
    assert DummySimulator().simulate(scene, maxSteps=3).result.records["log"] == list(
        enumerate(EXPECTED["log"])
    )
