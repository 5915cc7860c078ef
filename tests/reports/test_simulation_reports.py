"""Reports about simulations: actions, invariants, names, requirements over time."""

import gc
import json
import tracemalloc

import pytest
from scenic.core.dynamics import InvariantViolation

import scenic
from scenic.simulators.kinematic import KinematicSimulator
from tests.reports.programs import Programs, programs, values  # noqa: F401 - a fixture


def test_taking_none_does_nothing(programs: Programs) -> None:  # noqa: F811
    result = programs.simulated(
        "behavior B():\n    take None\n    take ()\nego = new Object with behavior B()\n", 2
    )
    assert [tuple(step.values()) for step in result.actions] == [((None,),), ((),)]


def test_invariants_hold_after_actions(programs: Programs) -> None:  # noqa: F811
    """They are checked when the behavior goes on, and find what its own action has done."""
    text = (
        "from scenic.simulators.actions import Action\n"
        "class Count(Action):\n    def applyTo(self, agent, simulation):\n        agent.count += 1\n"
        "class Counter:\n    count[dynamic, final]: 0\n"
        "behavior B():\n    invariant: self.count < 3\n    while True:\n        take Count()\n"
        "ego = new Counter with behavior B()\n"
    ).replace("count[dynamic, final]", "count")
    with pytest.raises(InvariantViolation):
        programs.simulated(text, 9, raiseGuardViolations=True)
    assert len(programs.simulated(text, 2, raiseGuardViolations=True).trajectory) == 3


def test_objects_are_equal_to_self(programs: Programs) -> None:  # noqa: F811
    result = programs.simulated(
        "behavior B():\n    self.same = [o == self for o in simulation().objects]\n    wait\n    wait\n"
        "class Agent:\n    same: ()\n"
        "ego = new Agent with behavior B()\nother = new Object at (5, 5)\nrecord final ego.same as same\n",
        2,
    )
    assert result.records["same"] == [True, False]


def test_names_of_the_language_that_programs_use(programs: Programs) -> None:  # noqa: F811
    result = programs.simulated(
        "simulator = 3\nbehavior Follow():\n    take ()\n    self.done = simulator\n    wait\n"
        "class Agent:\n    done: 0\n"
        "ego = new Agent with behavior Follow(), with width simulator\nrecord final ego.done as done\n",
        3,
    )
    assert result.records["done"] == 3


def test_requirements_over_time_of_all_of_some(programs: Programs) -> None:  # noqa: F811
    text = "ego = new Object\nboxes = [new Object at (5, 5 * i) for i in range(1, 3)]\nrequire {}\n"
    result = programs.simulated(text.format("always all(not (box intersects ego) for box in boxes)"), 3)
    assert len(result.trajectory) == 4
    with pytest.raises(scenic.ScenicSyntaxError) as caught:
        programs.compiled(text.format("all((always box.position.x > 1) for box in boxes)"))
    assert caught.value.lineno == 3
    assert "`always` cannot be part of an ordinary expression" in str(caught.value)


def test_memory_of_many_simulations(programs: Programs) -> None:  # noqa: F811
    """Simulations that are over leave nothing behind, their images included."""
    scene = programs.compiled(
        "from scenic import RGBSensor\n"
        "ego = new Object with sensors {'front': RGBSensor(width=32, height=24)}\nnew Object at (0, 5)\n"
    ).sample(1, seed=1)[0]
    simulator = KinematicSimulator()

    def run(count: int) -> int:
        for _ in range(count):
            assert simulator.simulate(scene, maxSteps=1) is not None
        gc.collect()
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        run(5)
        before = run(5)
        assert run(20) - before < 200_000
    finally:
        tracemalloc.stop()


def test_records_go_to_paths_beside_the_program(programs: Programs) -> None:  # noqa: F811
    programs.simulated(
        "ego = new Object at (1, 2)\n"
        "record ego.position to localPath('places.jsonl')\nrecord ego.x to Files(localPath('x_{step}.json'))\n",
        2,
    )
    assert len((programs.folder / "places.jsonl").read_text().splitlines()) == 3
    assert json.loads((programs.folder / "x_1.json").read_text()) == 1
