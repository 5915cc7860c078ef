"""What simulators and scripts written for the established API rely on."""

import contextlib
import io
import random
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from scenic.core.simulators import DummySimulator, Simulation, Simulator, TerminationType

import scenic
from scenic.language.errors import GuardViolation

AGENTS = """
behavior B(n):
    while True:
        take n
ego = new Object with behavior B(1)
other = new Object at (5, 0), with behavior B(2)
thing = new Object at (9, 0)
"""
DRAWING = "behavior B():\n    while True:\n        take Range(0, 1)\nego = new Object with behavior B\n"
REJECTED = "ego = new Object\nrequire eventually ego.position.x > 3\n"


def scene(text: str) -> Any:
    return scenic.scenarioFromString(text).sample(1, seed=0)[0]


def drawn(simulation: Any) -> list[float]:
    return [step[simulation.objects[0]][0] for step in simulation.result.actions]


class Plain(Simulation):
    """The least that a simulation needs."""

    def createObjectInSimulator(self, obj: Any) -> None:
        pass

    def step(self) -> None:
        pass

    def actionsAreCompatible(self, agent: Any, actions: Sequence[Any]) -> bool:
        return True

    def executeActions(self, allActions: Mapping[Any, Sequence[Any]]) -> None:
        pass

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        return {name: getattr(obj, name) for name in properties}


def simulator(cls: type[Simulation]) -> Simulator:
    class Own(Simulator):
        def createSimulation(self, scene: Any, **options: Any) -> Simulation:
            return cls(scene, **options)

    return Own()


def test_the_schedule_holds_all_agents() -> None:
    class Forgetful(Plain):
        def scheduleForAgents(self) -> Sequence[Any]:
            return self.agents[:1]

    class Reversed(Plain):
        def scheduleForAgents(self) -> Sequence[Any]:
            return self.agents[::-1]

    with pytest.raises(RuntimeError, match="schedule does not hold all agents"):
        simulator(Forgetful).simulate(scene(AGENTS), maxSteps=1)
    done = simulator(Reversed).simulate(scene(AGENTS), maxSteps=1)
    assert done is not None
    assert done.result is not None
    assert [done.result.actions[0][agent] for agent in done.agents] == [(1,), (2,)]


def test_what_has_no_behavior_takes_no_actions() -> None:
    done = DummySimulator().simulate(scene(AGENTS), maxSteps=1)
    assert done is not None
    assert done.result is not None
    (step,) = done.result.actions
    assert step[done.objects[2]] == ()
    assert step == {done.objects[0]: (1,), done.objects[1]: (2,)}


def test_scalars_from_simulators_are_floats() -> None:
    class Whole(Plain):
        def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
            return {**super().getProperties(obj, properties), "speed": 7}

    text = "behavior B():\n    while True:\n        take type(self.speed).__name__, self.speed\nego = new Object with behavior B\n"
    done = simulator(Whole).simulate(scene(text), maxSteps=1)
    assert done is not None
    assert done.result is not None
    assert done.result.actions[0][done.objects[0]] == ("float", 7.0)


def test_names_of_simulations() -> None:
    names: list[str] = []

    class Named(DummySimulator):
        def createSimulation(self, scene: Any, **options: Any) -> Any:
            names.append(options["name"])
            return super().createSimulation(scene, **options)

    for tries, name in ((1, "alone"), (2, "several"), (1, None)):
        Named().simulate(scene(REJECTED), maxSteps=1, maxIterations=tries, name=name)
    assert names == ["alone", "several.1", "several.2", "1"]


def test_replays_have_to_be_kept() -> None:
    done = DummySimulator().simulate(scene(DRAWING), maxSteps=2, enableReplay=False)
    assert done is not None
    with pytest.raises(RuntimeError, match="enableReplay=False"):
        done.getReplay()


def test_draws_are_new_after_a_divergence() -> None:
    start = scene(DRAWING)
    earlier = DummySimulator(drift=1).simulate(start, maxSteps=4, enableDivergenceCheck=True)
    assert earlier is not None
    options: dict[str, Any] = {"maxSteps": 4, "enableDivergenceCheck": True, "continueAfterDivergence": True}
    same = DummySimulator(drift=1).replay(start, earlier.getReplay(), **options)
    other = DummySimulator(drift=2).replay(start, earlier.getReplay(), **options)
    assert drawn(same) == drawn(earlier)
    assert drawn(other)[:1] == drawn(earlier)[:1]
    assert not set(drawn(other)[1:]) & set(drawn(earlier))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("behavior A(n):\n    precondition: n > 3\n    take 1\nego = new Object with behavior A(2)\n", "A"),
        ("scenario Main():\n    precondition: ego.x > 3\n    setup:\n        ego = new Object\n", "Main"),
    ],
)
def test_violated_guards_name_what_they_guard(text: str, name: str) -> None:
    with pytest.raises(GuardViolation, match=f"violated precondition of {name} on line 2") as caught:
        DummySimulator().simulate(scene(text), maxSteps=1, raiseGuardViolations=True)
    assert caught.value.behaviorName == name
    assert caught.value.lineno == 2


def test_what_simulations_tell() -> None:
    def told(text: str, verbosity: int) -> list[str]:
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            DummySimulator().simulate(scene(text), maxSteps=1, verbosity=verbosity)
        return output.getvalue().splitlines()

    assert told(AGENTS, 1) == []
    assert told(AGENTS, 2) == [
        "  Starting simulation 1...",
        "  Simulation 1 ended successfully at time step 1 because: reached time limit (1 steps)",
    ]
    assert told(REJECTED, 2)[1].startswith("  Rejected simulation 1 because: requirement on line 2")
    whole = told(AGENTS, 3)
    assert sum("Creating object" in line for line in whole) == 3
    assert "    Time step 0:" in whole
    assert any("Agent" in line and line.endswith("takes action(s) (2,)") for line in whole)


def test_kinds_of_ends() -> None:
    assert TerminationType.terminatedByUser.value == "manually terminated by user"


@pytest.mark.parametrize("course", [True, False])
@pytest.mark.parametrize("replay", [True, False])
def test_what_is_kept_of_the_course_and_of_the_draws_are_two_things(
    tmp_path: Path, course: bool, replay: bool
) -> None:
    text = (
        f"param recordFolder = {str(tmp_path)!r}\n{DRAWING}record simulation().currentTime to 'run.jsonl'\n"
    )
    start = scene(text)
    random.seed(8)
    done = DummySimulator().simulate(start, maxSteps=3, keep_course=course, enableReplay=replay)
    assert done is not None
    (recorded,) = done.records.values()
    assert (recorded == [(step, step) for step in range(4)]) is course
    if replay:
        random.seed(8)
        whole = DummySimulator().simulate(start, maxSteps=3)
        assert whole is not None
        assert done.getReplay() == whole.getReplay()
    else:
        with pytest.raises(RuntimeError, match="enableReplay=False"):
            done.getReplay()


def test_a_simulator_may_do_more_when_objects_are_read_back() -> None:
    """Once before the first step, and after each."""
    times = []

    class Reading(Plain):
        def updateObjects(self) -> None:
            super().updateObjects()
            times.append(self.currentTime)

    assert simulator(Reading).simulate(scene(AGENTS), maxSteps=2) is not None
    assert times == [0, 1, 2]
