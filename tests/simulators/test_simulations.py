"""Simulations as the Python API shows them: replays, soft requirements, records in files, faults, interleaving."""

import json
import pickle
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.language.errors import (
    DivergenceError,
    GuardViolation,
    InvalidScenarioError,
    PreconditionViolation,
    ScenicTypeError,
    ScenicValueError,
    SerializationError,
    SpecifierError,
    StuckBehaviorError,
    StuckBehaviorWarning,
    annotation,
)
from scenic.runtime.dynamics.recorders import File, Files, for_pattern
from scenic.runtime.ground.context import current
from scenic.runtime.ground.files import whole
from scenic.runtime.values.values import Vector
from scenic.simulators.actions import Action
from scenic.simulators.dummy import DummySimulation, DummySimulator
from scenic.simulators.results import TerminationType
from scenic.simulators.simulation import Simulation

DRAWING = """
behavior B():
    while True:
        take Range(0, 1), DiscreteRange(0, 1000)
ego = new Object with behavior B
other = new Object at (5, 0), with behavior B
"""


def scene_of(text: str, *, seed: int = 0) -> Any:
    return scenic.scenarioFromString(text).sample(1, seed=seed)[0]


def simulate(text: str, steps: int = 5, **options: Any) -> Simulation:
    done = DummySimulator(drift=options.pop("drift", 0)).simulate(scene_of(text), maxSteps=steps, **options)
    assert done is not None
    return done


def taken(simulation: Simulation, number: int = 0) -> list[Any]:
    assert simulation.result is not None
    return [step[simulation.objects[number]] for step in simulation.result.actions]


# Draws


def test_a_key_decides_all_draws() -> None:
    first, again, other = (simulate(DRAWING, key=key) for key in (b"1", b"1", b"2"))
    empty, too = (simulate(DRAWING, key=b"") for _ in range(2))
    assert taken(empty) == taken(too) != taken(first)
    assert taken(first) == taken(again) != taken(other)
    assert taken(first, 0) != taken(first, 1)


def test_pythons_seed_decides_simulations_without_a_key() -> None:
    random.seed(3)
    first, second = simulate(DRAWING), simulate(DRAWING)
    random.seed(3)
    assert taken(first) == taken(simulate(DRAWING)) != taken(second)


def test_an_agent_that_draws_more_changes_nothing_for_others() -> None:
    more = DRAWING.replace(
        "other = new Object", "extra = new Object at (9, 0), with behavior B\nother = new Object"
    )
    first, second = simulate(DRAWING, key=b"1"), simulate(more, key=b"1")
    assert taken(first, 0) == taken(second, 0)


def test_global_generators_are_the_simulations_own() -> None:
    text = "import random\nbehavior B():\n    while True:\n        take random.random()\nego = new Object with behavior B\n"
    random.seed(1)
    state = random.getstate()
    first = simulate(text, key=b"1")
    assert random.getstate() == state
    assert taken(first) == taken(simulate(text, key=b"1"))


@pytest.mark.parametrize("draw", ["random.random()", "float(numpy.random.rand())"])
def test_global_generators_go_on_from_step_to_step(draw: str) -> None:
    """Also where a simulation is advanced step by step, beside others that draw from them."""
    text = f"import random, numpy\nbehavior B():\n    while True:\n        take {draw}\nego = new Object with behavior B\n"
    scene = scene_of(text)
    whole = taken(simulate(text, 6, key=b"1"))
    assert len(set(whole)) == 6
    runs = [
        DummySimulation(scene, maxSteps=6, name="x", timestep=1, deferred=True, key=key)
        for key in (b"1", b"2")
    ]
    for run in runs:
        run.begin()
    going = list(runs)
    while going:
        going = [run for run in going if run.advanceOnce()]
        random.random()
    assert taken(runs[0]) == whole != taken(runs[1])


# Replays


def test_simulations_are_data() -> None:
    scenario = scenic.scenarioFromString(DRAWING)
    scene, _ = scenario.generate(seed=1)
    simulator = DummySimulator(drift=1)
    first = simulator.simulate(scene, maxSteps=4, enableDivergenceCheck=True)
    assert first is not None
    data = scenario.simulationToBytes(first)
    again = scenario.simulationFromBytes(data, simulator, maxSteps=6, enableDivergenceCheck=True)
    assert taken(again)[:4] == taken(first)
    other = scenic.scenarioFromString(DRAWING + "another = 3\n")
    with pytest.raises(SerializationError, match="another program"):
        other.simulationFromBytes(data, simulator, maxSteps=4)
    assert taken(other.simulationFromBytes(data, simulator, verify=False, maxSteps=4)) == taken(first)
    with pytest.raises(DivergenceError, match="step 1: position of object 0"):
        scenario.simulationFromBytes(data, DummySimulator(drift=2), maxSteps=4, enableDivergenceCheck=True)
    tolerant = {"enableDivergenceCheck": True, "divergenceTolerance": 100}
    scenario.simulationFromBytes(data, DummySimulator(drift=2), maxSteps=4, **tolerant)
    going_on = {"enableDivergenceCheck": True, "continueAfterDivergence": True}
    scenario.simulationFromBytes(data, DummySimulator(drift=2), maxSteps=4, **going_on)


ENTERING = """
behavior B():
    while True:
        take Range(0, 1)
scenario Main():
    setup:
        ego = new Object
    compose:
        wait
        do Sub() for 2 steps
        do Sub()
scenario Sub():
    setup:
        new Object at ({x}, 5), with behavior B
        new Object at (9 + simulation().currentTime, simulation().currentTime), with behavior B
    compose:
        while True:
            wait
"""


def test_objects_that_enter_later_are_compared_as_they_were_then() -> None:
    """With those that entered in the same step of the replay, although all have moved on since."""
    scene = scene_of(ENTERING.format(x="5 + 100 * simulation().currentTime"))
    first = DummySimulator(drift=1).simulate(scene, maxSteps=6, enableDivergenceCheck=True)
    assert first is not None
    again = DummySimulator(drift=1).replay(scene, first.getReplay(), maxSteps=9, enableDivergenceCheck=True)
    assert [taken(again, number)[:6] for number in range(5)] == [taken(first, number) for number in range(5)]
    other = scene_of(
        ENTERING.format(x="5 + 100 * simulation().currentTime + (simulation().currentTime == 3)")
    )
    with pytest.raises(
        DivergenceError, match=r"step 3: position of object 3 is Vector\(306, .* was Vector\(305, "
    ):
        DummySimulator(drift=1).replay(other, first.getReplay(), maxSteps=6, enableDivergenceCheck=True)


def test_global_generators_give_the_same_in_a_replay() -> None:
    text = (
        "import random, numpy\nbehavior B():\n    while True:\n        take random.random(), float(numpy.random.rand())\n"
        "ego = new Object with behavior B\n"
    )
    scene = scene_of(text)
    first = simulate(text, 3)
    again = DummySimulator().replay(scene, first.getReplay(), maxSteps=3)
    assert again is not None
    assert taken(again) == taken(first)


def test_a_simulator_may_say_itself_what_diverges() -> None:
    asked = []

    class Lenient(DummySimulation):
        def valuesHaveDiverged(self, obj: Any, prop: str, expected: Any, actual: Any) -> bool:
            asked.append((self.objects.index(obj), prop, expected, actual))
            return prop == "position" and bool(actual.y > expected.y + 2)

    scene = scene_of(DRAWING)
    first = DummySimulator(drift=1).simulate(scene, maxSteps=4, enableDivergenceCheck=True)
    assert first is not None
    options: dict[str, Any] = {"name": "x", "timestep": 1, "enableDivergenceCheck": True}
    Lenient(scene, drift=2, maxSteps=2, replay=first.getReplay(), **options)
    assert (1, "position", Vector(5, 1, 0), Vector(5, 2, 0)) in asked
    with pytest.raises(DivergenceError, match="diverged at step 3: position of object 0"):
        Lenient(scene, drift=2, maxSteps=4, replay=first.getReplay(), **options)


@pytest.mark.parametrize("cut", [0, 3, 10, -1, -9])
def test_damaged_data_is_refused(cut: int) -> None:
    scenario = scenic.scenarioFromString(DRAWING)
    scene, _ = scenario.generate(seed=1)
    simulator = DummySimulator()
    done = simulator.simulate(scene, maxSteps=2)
    data = scenario.simulationToBytes(done)
    with pytest.raises(SerializationError):
        scenario.simulationFromBytes(data[:cut], simulator, maxSteps=2)
    assert done is not None
    with pytest.raises(SerializationError):
        simulator.replay(scene, done.getReplay()[:cut], maxSteps=2)


# What a simulation may not touch


def test_a_scene_is_untouched() -> None:
    scene = scene_of(DRAWING)
    before = [tuple(item.position) for item in scene.objects]
    done = DummySimulator(drift=1).simulate(scene, maxSteps=3)
    assert done is not None
    assert [tuple(item.position) for item in scene.objects] == before
    assert done.objects[0] is scene.objects[0]
    assert done.scene is scene
    assert done.result is not None
    assert tuple(done.result.finalState[0]) == (0, 3, 0)
    assert list(done.result.actions[0]) == list(scene.objects)


def test_simulations_interleave() -> None:
    text = "count = 0\nbehavior B():\n    global count\n    while True:\n        count += 1\n        take count\nego = new Object with behavior B\n"
    scene = scene_of(text)
    runs = [
        DummySimulation(scene, maxSteps=3, name="x", timestep=1, deferred=True, key=b"1") for _ in range(2)
    ]
    for run in runs:
        run.begin()
    going = list(runs)
    while going:
        going = [run for run in going if run.advanceOnce()]
    assert [taken(run) for run in runs] == [[(1,), (2,), (3,)]] * 2


def test_each_of_several_simulations_writes_its_own_files(tmp_path: Path) -> None:
    """Although the program makes the recorders once for all of them."""
    text = (
        f"from scenic.runtime.dynamics.recorders import File, Files\nparam recordFolder = {str(tmp_path)!r}\nego = new Object\n"
        "record ego.position.y to File('{simulation}.jsonl')\nrecord ego.position.y to Files('{simulation}-{step}.json')\n"
    )
    scene = scene_of(text)
    runs = [
        DummySimulation(scene, drift=drift, maxSteps=steps, name=str(drift), timestep=1, deferred=True)
        for drift, steps in ((1, 3), (2, 1))
    ]
    for run in runs:
        run.begin()
    going = runs
    while going:
        going = [run for run in going if run.advanceOnce()]
    for drift, steps in ((1, 3), (2, 1)):
        rows = map(json.loads, (tmp_path / f"{drift}.jsonl").read_text().splitlines())
        assert [row["value"] for row in rows] == [drift * step for step in range(steps + 1)]
        for step in range(steps + 1):
            assert json.loads((tmp_path / f"{drift}-{step}.json").read_text()) == drift * step
    assert len(list(tmp_path.iterdir())) == 8


def test_nothing_survives_a_failure() -> None:
    text = "behavior B():\n    take 1\n    raise ValueError('oops')\nego = new Object with behavior B\n"
    with pytest.raises(ValueError, match="oops") as caught:
        simulate(text)
    found = annotation(caught.value)
    assert found is not None
    assert found.span is not None
    assert found.span.line == 3
    assert current.get() is None
    assert taken(simulate(DRAWING, 2)) != []
    scenic.scenarioFromString("ego = new Object\nnew Object at (5, 5)").sample(1)


def test_defaults_of_classes_read_the_values_of_the_scene() -> None:
    text = """
size = Range(3, 4)
class C:
    foo: size
    width: size + 1
behavior B():
    take self.foo, self.width, size
scenario Main():
    setup:
        ego = new Object
    compose:
        do Sub()
scenario Sub():
    setup:
        new C at (9, 0), with behavior B
    compose:
        wait
"""
    done = DummySimulator().simulate(scene_of(text), maxSteps=2)
    assert done is not None
    [(foo, width, size)] = taken(done, 1)
    assert 3 < foo == size
    assert width == size + 1


def test_what_code_returns_is_an_object_of_the_simulation() -> None:
    text = """
told = distributionFunction(lambda *values: values[0])
behavior B(thing, things):
    for _ in range(3):
        take thing is things[1] is o, (distance from thing to o), thing.position.y
    o.seen = 5
    take thing.seen, things[1].seen, o.seen
ego = new Object
class Car:
    seen: 1
o = new Car at (Range(3, 8), 5)
mutate o
x = told(o, Range(0, 1))
ego.behavior = B(x, told([1, x], Range(0, 1)))
record (x is o) as same
require always x is o
"""
    done = DummySimulator(drift=1).simulate(scene_of(text), maxSteps=4)
    assert done is not None
    assert done.result is not None
    moves = taken(done)
    assert [step[:2] for step in moves[:3]] == [(True, 0)] * 3
    assert moves[0][2] < moves[1][2] < moves[2][2]
    assert moves[3] == (5, 5, 5)
    assert [same for _, same in done.result.records["same"]] == [True] * 5


@pytest.mark.parametrize("word", ["visible", "not visible"])
def test_objects_that_enter_are_seen_as_their_specifiers_say(word: str) -> None:
    text = f"""
scenario Main():
    setup:
        ego = new Object
    compose:
        do Sub()
scenario Sub():
    setup:
        new Object at (9, PLACE), {word} from ego
    compose:
        wait
"""
    for place, seen in (("0", True), ("990", False)):
        done = DummySimulator().simulate(scene_of(text.replace("PLACE", place)), maxSteps=2)
        assert (done is not None) == (seen == (word == "visible")), (place, word)


@pytest.mark.parametrize("word", ["visible", "not visible"])
def test_objects_that_enter_in_2d_mode_are_seen_in_the_plane(word: str) -> None:
    """As those that are there from the beginning: the camera, far above, counts as if it were on the ground."""
    text = f"""
scenario Main():
    setup:
        ego = new Object with visibleDistance 30, with viewAngle 90 deg, with cameraOffset (0, 0, 40)
    compose:
        do Sub()
scenario Sub():
    setup:
        new Object at PLACE, {word}, with requireVisible False
    compose:
        wait
"""
    for place, seen in (("(0, 9)", True), ("(9.9, 9)", True), ("(0, -9)", False), ("(0, 31)", False)):
        (scene,) = scenic.scenarioFromString(text.replace("PLACE", place), mode2D=True).sample(1, seed=0)
        done = DummySimulator().simulate(scene, maxSteps=2)
        assert (done is not None) == (seen == (word == "visible")), (place, word)


def test_parameters_of_a_simulation_are_its_own() -> None:
    """Whether or not those of the scene were looked at before; afterwards these are as they were."""
    text = (
        "ego = new Object at (Range(0, 1), 0)\nparam leader = ego, log = [ego]\n"
        "monitor M():\n    while True:\n        globalParameters.log.append(3)\n        wait\n"
        "require monitor M()\n"
        "record (simulation().scene.params['leader'] is ego, simulation().scene.params['log'][0] is ego) as same\n"
        "record len(simulation().scene.params['log']) as count\n"
    )
    for look in (True, False):
        (scene,) = scenic.scenarioFromString(text).sample(1, seed=1)
        assert not look or scene.params["log"] == [scene.egoObject]
        for _ in range(2):
            done = DummySimulator(drift=1).simulate(scene, maxSteps=2)
            assert done is not None
            assert [value for _, value in done.records["same"]] == [(True, True)] * 3
            assert [value for _, value in done.records["count"]] == [1, 2, 3]
        assert scene.params["leader"] is scene.egoObject
        assert scene.params["log"] == [scene.egoObject]


# Requirements


def test_soft_requirements_count_only_where_they_were_active() -> None:
    text = "ego = new Object at (Range(0, 1), 0)\nrequire[0.5] ego.x > 0.5\n"
    scenario = scenic.scenarioFromString(text)
    scenes = scenario.sample(40, seed=3)
    low = [scene for scene in scenes if scene.egoObject.x <= 0.5]
    assert 3 < len(low) < 20
    requirement = scenario.requirements[0]
    for scene in scenes:
        assert DummySimulator().simulate(scene, maxSteps=1) is not None
        assert scene.egoObject.x > 0.5 or not scene.enforces(requirement)
    assert any(scene.enforces(requirement) for scene in scenes)


def test_soft_requirements_that_always_hold_take_no_turn_of_others() -> None:
    """However many of them stand before, between and behind those of which chance decides."""
    text = (
        "ego = new Object at (Range(0, 1), Range(0, 1))\nrequire[0.3] True\nrequire[0.5] ego.x > 0.5\n"
        "require[0.9] 1 < 2\nrequire ego.x < 5\nrequire[0.5] ego.y > 0.5\nrequire[0.2] True\n"
    )
    scenario = scenic.scenarioFromString(text)
    sure, x, sure_too, hard, y, last = scenario.requirements
    scenes = scenario.sample(40, seed=3)
    for scene in scenes:
        assert all(map(scene.enforces, (sure, sure_too, hard, last)))
        assert scene.egoObject.x > 0.5 or not scene.enforces(x)
        assert scene.egoObject.y > 0.5 or not scene.enforces(y)
    assert {(scene.enforces(x), scene.enforces(y)) for scene in scenes} == {
        (one, other) for one in (True, False) for other in (True, False)
    }


def test_requirements_have_verdicts_and_robustness() -> None:
    text = (
        "ego = new Object\nrequire always ego.position.y < 10\nrequire eventually ego.position.y > 2 as far\n"
    )
    done = simulate(text, 5, drift=1, robustness=True)
    assert done.result is not None
    first, second = done.result.requirements
    assert (first.line, first.verdict.name) == (2, "PRESUMABLY_TRUE")
    assert (second.label, second.verdict.name) == ("far", "TRUE")
    assert first.robustness > 0 < second.robustness


def test_violated_guards_reject_or_are_raised() -> None:
    text = "behavior B():\n    precondition: False\n    take 1\nego = new Object with behavior B\n"
    scene = scene_of(text)
    assert DummySimulator().simulate(scene, maxSteps=1) is None
    with pytest.raises(PreconditionViolation, match="line 2"):
        DummySimulator().simulate(scene, maxSteps=1, raiseGuardViolations=True)


# Steps


def test_a_simulator_may_have_a_timestep() -> None:
    scene = scene_of("ego = new Object\nterminate after 2 seconds\n")
    simulator = DummySimulator(timestep=0.5)
    for given, steps in ((None, 4), (1, 2)):
        done = simulator.simulate(scene, maxSteps=9, timestep=given)
        assert done is not None
        assert done.currentTime == steps


def test_long_simulations_need_not_keep_their_course() -> None:
    text = (
        "behavior B():\n    while True:\n        take Range(0, 1)\nego = new Object with behavior B\n"
        "record final simulation().currentTime as time\n"
    )
    whole = simulate(text, 20, key=b"1", drift=1)
    short = simulate(text, 20, key=b"1", drift=1, keep_course=False, enableReplay=False)
    assert whole.result is not None
    assert short.result is not None
    assert short.result.trajectory == whole.result.trajectory[-1:]
    assert [taken(short)[-1]] == taken(short) == taken(whole)[-1:]
    assert short.result.records == {"time": 20}


def test_no_steps_at_all() -> None:
    done = simulate("behavior B():\n    take 1\nego = new Object with behavior B\n", 0)
    assert done.result is not None
    assert done.result.actions == ()
    assert len(done.result.trajectory) == 1
    assert done.result.terminationType is TerminationType.timeLimit


SUB = """
scenario Main():
    setup:
        ego = new Object with foo 1, with bar 2
        record (ego.foo, ego.bar) as both
    compose:
        wait
        do Sub() for 2 steps
        wait
scenario Sub():
    setup:
{setup}
"""


def with_sub(setup: str, steps: int = 6, **options: Any) -> Simulation | None:
    text = SUB.format(setup="\n".join(f"        {line}" for line in setup.splitlines()))
    return DummySimulator(**options).simulate(scene_of(text), maxSteps=steps)


def test_all_overrides_are_reverted() -> None:
    done = with_sub("override ego with foo 5\noverride ego with bar 6\noverride ego with foo 7")
    assert done is not None
    assert [value for _, value in done.records["both"]] == [(1, 2), (7, 6), (7, 6), (1, 2), (1, 2)]


def test_what_was_nothing_before_an_override_is_nothing_again() -> None:
    text = SUB.replace("with foo 1", "with foo None").format(setup="        override ego with foo 5")
    done = DummySimulator().simulate(scene_of(text), maxSteps=6)
    assert done is not None
    assert [value for _, value in done.records["both"]] == [(None, 2), (5, 2), (5, 2), (None, 2), (None, 2)]


@pytest.mark.parametrize(
    ("setup", "match"),
    [("override ego with speed 3", "dynamic"), ("override ego with fooo 3", "no property 'fooo'")],
)
def test_what_cannot_be_overridden(setup: str, match: str) -> None:
    with pytest.raises(SpecifierError, match=match):
        with_sub(setup)


def test_ends_and_records_of_invoked_scenarios_are_theirs() -> None:
    done = with_sub("record simulation().currentTime as t\nterminate when simulation().currentTime == 2")
    assert done is not None
    assert done.records["t"] == [(1, 1)]
    assert done.result is not None
    assert done.result.terminationReason == "finished compose block"
    done = with_sub("terminate simulation when simulation().currentTime == 2 as two")
    assert done is not None
    assert done.result is not None
    assert done.result.terminationReason == "two"


def test_a_monitor_of_an_invoked_scenario_ends_that_scenario() -> None:
    text = (
        "monitor M():\n    wait\n    terminate\n" + SUB.format(setup="        require monitor M()").lstrip()
    )
    done = DummySimulator().simulate(scene_of(text), maxSteps=9)
    assert done is not None
    assert done.result is not None
    assert done.result.terminationType is TerminationType.scenarioComplete


def test_an_interrupted_scenario_goes_on() -> None:
    text = """
scenario Main():
    setup:
        ego = new Object
    compose:
        try:
            do Long()
        interrupt when simulation().currentTime == 1:
            do Short()
        wait
scenario Long():
    setup:
        record simulation().currentTime as long
    compose:
        wait
        wait
        wait
scenario Short():
    setup:
        record simulation().currentTime as short
    compose:
        wait
        wait
"""
    done = DummySimulator().simulate(scene_of(text), maxSteps=9)
    assert done is not None
    assert done.records["short"] == [(1, 1), (2, 2)]
    assert [step for step, _ in done.records["long"]] == [0, 1, 2, 3, 4]


# Records


def test_periods_and_delays_select_steps() -> None:
    done = simulate("ego = new Object\nrecord simulation().currentTime every 2 steps after 3 steps as t\n", 8)
    assert done.records["t"] == [(4, 4), (6, 6), (8, 8)]
    text = "ego = new Object\nrecord simulation().currentTime every 1 seconds after 0.5 seconds as t\n"
    assert simulate(text, 8, timestep=0.25).records["t"] == [(4, 4), (8, 8)]


def recording(folder: Path, target: str, value: str = "simulation().currentTime", end: str = "") -> str:
    return f"param recordFolder = {str(folder)!r}\nego = new Object\nrecord {value} to {target!r}\n{end}"


def test_series_are_written(tmp_path: Path) -> None:
    simulate(recording(tmp_path, "deep/{simulation}.jsonl"), 2, name="run", timestep=0.5)
    rows = [json.loads(line) for line in (tmp_path / "deep" / "run.jsonl").read_text().splitlines()]
    assert rows == [{"step": step, "time": step / 2, "value": step} for step in range(3)]
    simulate(recording(tmp_path, "{simulation}.npz", "ego.position"), 2)
    found = np.load(tmp_path / "1.npz")
    assert found["values"].shape == (3, 3)


def test_arrays_tell_the_steps_at_which_they_were_recorded(tmp_path: Path) -> None:
    text = f"param recordFolder = {str(tmp_path)!r}\nego = new Object\nrecord simulation().currentTime every 2 steps after 3 steps to 'run.npz'\n"
    simulate(text, 9, timestep=0.25)
    found = np.load(tmp_path / "run.npz")
    assert found["steps"].tolist() == found["values"].tolist() == [4, 6, 8]
    assert found["times"].tolist() == [1, 1.5, 2]


def test_pickled_series_tell_the_steps_at_which_they_were_recorded(tmp_path: Path) -> None:
    text = f"param recordFolder = {str(tmp_path)!r}\nego = new Object\nrecord simulation().currentTime every 2 steps after 3 steps to 'run.pickle'\n"
    simulate(text, 9)
    assert pickle.loads((tmp_path / "run.pickle").read_bytes()) == [(4, 4), (6, 6), (8, 8)]


def test_series_may_be_pickled(tmp_path: Path) -> None:
    """As pairs of step and value; nothing is there before the end, or after a rejection."""
    simulate(recording(tmp_path, "run.pickle", "(simulation().currentTime, 'x')"), 2)
    assert [path.name for path in tmp_path.iterdir()] == ["run.pickle"]
    found = pickle.loads((tmp_path / "run.pickle").read_bytes())
    assert [(step, tuple(value)) for step, value in found] == [(step, (step, "x")) for step in range(3)]
    (tmp_path / "run.pickle").unlink()
    end = "require eventually ego.position.y > 30\n"
    assert DummySimulator().simulate(scene_of(recording(tmp_path, "run.pickle", end=end)), maxSteps=2) is None
    assert list(tmp_path.iterdir()) == []


def test_values_are_written(tmp_path: Path) -> None:
    simulate(recording(tmp_path, "{step}.npy", "[1, 2]"), 2)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0.npy", "1.npy", "2.npy"]
    for pattern in ("{0}/{1}/{2}.npy", "{}/{}/{}.npy", "{simulation}/{step}/{time}.npy"):
        folder = tmp_path / pattern[1:2]
        simulate(recording(folder, pattern, "[1, 2]"), 1, name="run", timestep=0.5)
        found = sorted(str(path.relative_to(folder)) for path in folder.rglob("*.npy"))
        assert found == ["run/0/0.0.npy", "run/1/0.5.npy"]
    image = "[[0, 128, 255], [1, 2, 3]]"
    simulate(recording(tmp_path / "images", "{time}.png", image), 1)
    assert sorted(path.name for path in (tmp_path / "images").iterdir()) == ["0.png", "1.png"]


def test_arrays_and_images_are_written_as_they_are(tmp_path: Path) -> None:
    """Arrays keep the type of their numbers; intensities from 0 to 1 become bytes, beyond that they are cut off."""
    from PIL import Image

    image = "numpy.array([[0, 0.5, 1], [-1, 2, 0.1]], dtype=numpy.float32)"
    for kind in ("npy", "png"):
        simulate("import numpy\n" + recording(tmp_path, f"{{step}}.{kind}", image), 1)
    found = np.load(tmp_path / "0.npy")
    assert found.dtype == np.float32
    np.testing.assert_array_equal(found, np.array([[0, 0.5, 1], [-1, 2, 0.1]], dtype=np.float32))
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "0.png")), [[0, 128, 255], [0, 255, 26]])


@pytest.mark.parametrize(
    ("image", "expected"),
    [
        ("[[300, -1, 256, 255, 0]]", [[255, 0, 255, 255, 0]]),
        ("numpy.array([[65535, 254]], dtype=numpy.uint16)", [[255, 254]]),
        ("numpy.array([[-128, 127]], dtype=numpy.int8)", [[0, 127]]),
        ("[[1e300, -0.1, float('nan'), float('-inf'), 1]]", [[255, 0, 0, 0, 255]]),
        ("[[[300, 5, -7]]]", [[[255, 5, 0]]]),
    ],
)
def test_what_is_brighter_or_darker_than_images_can_be_is_cut_off(
    tmp_path: Path, image: str, expected: Any
) -> None:
    """Integers as floats are; what is not measured is black."""
    from PIL import Image

    simulate("import numpy\n" + recording(tmp_path, "{step}.png", image), 0)
    with Image.open(tmp_path / "0.png") as found:
        np.testing.assert_array_equal(np.asarray(found), expected)


@pytest.mark.parametrize(
    ("image", "mode"),
    [
        ("[[0, 9], [255, 3]]", "L"),
        ("[[[1, 2, 3]], [[4, 5, 255]]]", "RGB"),
        ("[[[1, 2, 3, 255], [5, 6, 7, 128]]]", "RGBA"),
    ],
)
def test_images_have_as_many_channels_as_they_are_given(tmp_path: Path, image: str, mode: str) -> None:
    from PIL import Image

    simulate("import numpy\n" + recording(tmp_path, "{step}.png", f"numpy.array({image})"), 0)
    with Image.open(tmp_path / "0.png") as found:
        assert found.mode == mode
        np.testing.assert_array_equal(np.asarray(found), eval(image))


@pytest.mark.parametrize("name", ["a.png", "b.PNG", "c.bmp", "d.tiff", "e.webp", "f.Jpg", "g.jpeg"])
def test_images_are_of_the_format_that_their_names_say(tmp_path: Path, name: str) -> None:
    from PIL import Image

    simulate(recording(tmp_path, f"{{step}}-{name}", "[[(9, 99, 200)] * 8] * 6"), 0)
    with Image.open(tmp_path / f"0-{name}") as found:
        assert found.format == name[2:].upper().replace("JPG", "JPEG")
        assert found.size == (8, 6)
        np.testing.assert_allclose(np.asarray(found), np.broadcast_to([9, 99, 200], (6, 8, 3)), atol=9)


@pytest.mark.parametrize(
    ("pattern", "several"),
    [
        ("run.npz", False), ("run", False), ("run.NPZ", False), ("{simulation}.jsonl", False), ("{0}.pkl", False), ("{}.pickle", False),
        ("{}.mp4", False), ("{0}.mov", False), ("{simulation}.MKV", False),
        ("{step}.npy", True), ("{1}.json", True), ("{2}.png", True), ("{time:.2f}.jpg", True), ("{0}-{1:04}.JPEG", True),
        ("{}{}.bmp", True), ("{}{}{}.tiff", True), ("{step:03d}.webp", True),
    ],
)  # fmt: skip
def test_a_pattern_stands_for_one_file_unless_it_depends_on_the_step(pattern: str, several: bool) -> None:
    recorder = for_pattern(pattern)
    assert isinstance(recorder, Files if several else File)
    recorder.beginRecording(None, "run", 0.25, {"recordFolder": "there"})
    paths = {str(recorder.path(step)) for step in (2, 3)}
    known = {"simulation": "run"}
    expected = {pattern.format("run", step, step / 4, step=step, time=step / 4, **known) for step in (2, 3)}
    assert paths == {f"there/{name}" for name in expected}
    assert len(paths) == 1 + several
    assert recorder.written.name == ("there/" + (pattern if several else expected.pop()))


@pytest.mark.parametrize(
    ("pattern", "field"),
    [("{3}.npy", "3"), ("{}{}{}{}.npy", "3"), ("{name}.png", "name"), ("{steps}.json", "steps")],
)
def test_fields_that_are_not_known_are_named(pattern: str, field: str) -> None:
    with pytest.raises(ScenicValueError, match=f"unknown field '{field}'"):
        for_pattern(pattern)


@pytest.mark.parametrize(
    ("pattern", "kinds"),
    [
        ("{step}.npz", ".bmp, .jpeg, .jpg, .json, .npy, .png, .tiff, .webp"),
        ("run.png", ".jsonl, .mkv, .mov, .mp4, .npz, .pickle, .pkl"),
    ],
)
def test_of_formats_those_are_named_that_the_pattern_may_have(pattern: str, kinds: str) -> None:
    with pytest.raises(ScenicValueError, match="nothing can be recorded to files of extension") as caught:
        for_pattern(pattern)
    assert caught.value.help == f"use one of {kinds}"


@pytest.mark.parametrize("shape", [(2, 3, 2), (2, 3, 5), (2,), (2, 3, 3, 3)])
def test_what_is_no_image_is_refused(tmp_path: Path, shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="an image is an array of shape"):
        simulate("import numpy\n" + recording(tmp_path, "{step}.png", f"numpy.zeros({shape})"), 0)


def test_options_are_for_what_writes_the_format(tmp_path: Path) -> None:
    """Images take Pillow's; what a format does not know is refused."""
    from PIL import Image

    text = (
        f"param recordFolder = {str(tmp_path)!r}\nego = new Object\n"
        "image = [[(7 * i * j) % 256 for i in range(40)] for j in range(40)]\n"
        "record image to Files('{kind}-{{step}}.{form}'{options})\n"
    )
    sizes = []
    for kind, form, options in (
        ("plain", "png", ", compress_level=0"),
        ("packed", "png", ", compress_level=9"),
        ("rough", "jpg", ", quality=1"),
        ("fine", "jpeg", ", quality=95"),
    ):
        simulate(text.format(kind=kind, form=form, options=options), 1)
        path = tmp_path / f"{kind}-0.{form}"
        sizes.append(path.stat().st_size)
        with Image.open(path) as image:
            assert image.size == (40, 40)
    assert sizes[0] > 1.2 * sizes[1]
    assert sizes[3] > 1.2 * sizes[2]
    with pytest.raises(TypeError, match="compress_level"):
        simulate(text.format(kind="none", form="npy", options=", compress_level=0"), 1)


@pytest.mark.parametrize("target", ["{step}.npy", "{simulation}.jsonl"])
@pytest.mark.parametrize(
    "end",
    ["require always simulation().currentTime < 3\n", "require eventually simulation().currentTime > 30\n"],
)
def test_nothing_is_left_of_a_rejected_simulation(tmp_path: Path, target: str, end: str) -> None:
    end = end.replace("simulation().currentTime", "ego.position.y")
    scene = scene_of(recording(tmp_path, target, end=end))
    assert DummySimulator(drift=1).simulate(scene, maxSteps=5) is None
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("target", ["sub.jsonl", "sub.npz", "sub.pickle", "sub-{step}.npy"])
def test_what_was_whole_before_a_rejection_goes_too(tmp_path: Path, target: str) -> None:
    """The file of a scenario that has ended, in a simulation that is rejected later."""
    text = f"param recordFolder = {str(tmp_path)!r}\n" + SUB.format(
        setup=f'        record simulation().currentTime to "{target}"'
    )
    done = DummySimulator().simulate(scene_of(text), maxSteps=5)
    assert done is not None
    assert len(list(tmp_path.iterdir())) == (2 if "step" in target else 1)
    for path in tmp_path.iterdir():
        path.unlink()
    rejected = text.replace(
        "        do Sub() for 2 steps\n        wait\n",
        "        do Sub() for 2 steps\n        wait\n        require False\n        wait\n",
    )
    assert rejected != text
    assert DummySimulator().simulate(scene_of(rejected), maxSteps=5) is None
    assert list(tmp_path.iterdir()) == []


def test_of_a_cancelled_series_nothing_remains_though_somebody_took_a_file_of_it(tmp_path: Path) -> None:
    recorder = for_pattern("{step}.json")
    recorder.beginRecording(None, "run", 1, {"recordFolder": str(tmp_path)})
    for step in range(4):
        recorder.recordValue(step, step)
    (tmp_path / "1.json").unlink()
    (tmp_path / "other").touch()
    recorder.endRecording(True)
    assert [path.name for path in tmp_path.iterdir()] == ["other"]


def test_of_two_records_of_one_name_in_one_step_the_last_counts() -> None:
    text = "ego = new Object\nrecord 1 as a\nrecord 2 every 2 steps as a\nrecord initial 3 as b\nrecord initial 4 as b\n"
    done = simulate(text, 3)
    assert done.records["a"] == [(0, 2), (1, 1), (2, 2), (3, 1)]
    assert done.records["b"] == 4


def test_objects_are_recorded_as_they_are_in_each_step() -> None:
    records = simulate("ego = new Object\nrecord [ego] as a\nrecord initial ego as b\n", 2, drift=1).records
    places = [things[0].position for _, things in records["a"]]
    assert len({tuple(place) for place in places}) == 3
    assert records["b"].position == places[0] == (0, 0, 0)


def test_what_cannot_be_recorded_is_shown_in_the_file_that_records_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "recording_module.scenic").write_text(
        "param a = 1\nego = new Object\nrecord None to 'run.npz'\n"
    )
    monkeypatch.chdir(tmp_path)
    (tmp_path / "main.scenic").write_text("x = 3\n\n\nfrom recording_module import *\n")
    scene = scenic.scenarioFromFile(str(tmp_path / "main.scenic")).sample(1, seed=0)[0]
    with pytest.raises(ScenicValueError, match="only numbers can be recorded") as caught:
        DummySimulator().simulate(scene, maxSteps=1)
    assert caught.value.span is not None
    assert (Path(str(caught.value.filename)).name, caught.value.span.line) == ("recording_module.scenic", 3)


@pytest.mark.parametrize("name", ["run.jsonl", "run.npz", "run.pickle", "run-{step}.json"])
def test_recorders_of_files_may_be_used_by_others(tmp_path: Path, name: str) -> None:
    """A recorder of the program may hand on what it is told: of a run that is cancelled nothing remains."""
    recorder = for_pattern(name)
    for number, canceled in enumerate((False, True, False)):
        folder = tmp_path / str(number)
        recorder.beginRecording({}, "run", 0.5, {"recordFolder": str(folder)})
        for step in (0, 2):
            recorder.recordValue(step + number, step)
        recorder.endRecording(canceled)
        found = sorted(contents(folder)) if folder.exists() else []
        expected = ["run-0.json", "run-2.json"] if "step" in name else [name]
        assert found == ([] if canceled else expected)
    if "step" in name:
        assert [json.loads((tmp_path / "2" / f"run-{step}.json").read_text()) for step in (0, 2)] == [2, 4]


def contents(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir()}


@pytest.mark.parametrize("ended", [KeyboardInterrupt, SystemExit, ValueError])
def test_files_that_are_not_whole_do_not_remain(tmp_path: Path, ended: type[BaseException]) -> None:
    """However it ends; and what had the name before is as it was."""
    path = tmp_path / "one.npy"

    def half() -> None:
        with whole(path) as stream:
            stream.write(b"half")
            stream.flush()
            assert (path.read_bytes() if path.exists() else b"") in (b"", b"before")
            raise ended

    for before in ({}, {"one.npy": b"before"}):
        for name, content in before.items():
            (tmp_path / name).write_bytes(content)
        with pytest.raises(ended):
            half()
        assert contents(tmp_path) == before
    with whole(path) as stream:
        stream.write(b"all")
    assert contents(tmp_path) == {"one.npy": b"all"}


def test_a_disk_that_is_full_leaves_no_half_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from scenic.runtime.ground import files

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        simulate(recording(tmp_path, "{step}.npy", "[1, 2]"), 2)
    assert list(tmp_path.iterdir()) == []


class FullStream:
    """A stream to which nothing can be written."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def write(self, _content: Any) -> int:
        raise OSError(28, "No space left on device")

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


@pytest.mark.parametrize("name", ["run.jsonl", "run.npz"])
def test_a_series_that_finds_the_disk_full_names_its_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """Although it waits in a file that has no name."""
    from scenic.runtime.dynamics import series

    real = series.unnamed
    monkeypatch.setattr(series, "unnamed", lambda path: FullStream(real(path)))
    with pytest.raises(OSError, match="No space left") as caught:
        simulate(recording(tmp_path, name), 2)
    assert caught.value.filename == str(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("target", ["3", "None or 3", "['a']", "ego"])
def test_records_go_to_names_and_recorders_alone(target: str) -> None:
    with pytest.raises(ScenicTypeError, match="expected a pattern of file names or a recorder") as caught:
        scene_of(f"ego = new Object\nrecord 1 to {target}\n")
    assert caught.value.span is not None
    assert caught.value.span.line == 2


# Simulators


class Move(Action):
    def __init__(self, dx: float) -> None:
        self.dx = dx

    def canBeTakenBy(self, agent: Any) -> bool:
        return bool(agent.movable)

    def applyTo(self, agent: Any, simulation: Any) -> None:
        simulation.places[agent] += self.dx


class Sliding(Simulation):
    """A simulation as others write them."""

    def __init__(self, scene: Any, *, broken: str = "", **options: Any) -> None:
        self.places: dict[Any, float] = {}
        self.broken = broken
        self.destroyed = 0
        super().__init__(scene, **options)

    def setup(self) -> None:
        super().setup()
        assert set(self.places) == set(self.objects)

    def createObjectInSimulator(self, obj: Any) -> None:
        self.places[obj] = obj.position.x

    def step(self) -> None:
        if self.broken == "dies" and self.currentTime == 2:
            raise ConnectionError("the simulator has died")

    def getProperties(self, obj: Any, properties: Any) -> dict[str, Any]:
        values = {name: getattr(obj, name) for name in properties}
        values["position"] = Vector(self.places[obj], 0, 0)
        if self.broken == "missing":
            del values["yaw"]
        if self.broken == "type":
            values["position"] = "here"
        return values

    def destroy(self) -> None:
        self.destroyed += 1


MOVING = """
from tests.simulators.test_simulations import Move
behavior B():
    while True:
        take Move(2)
ego = new Object with behavior B, with movable True
"""


def slide(**options: Any) -> Sliding:
    return Sliding(scene_of(MOVING), maxSteps=4, name="x", timestep=1, **options)


def test_actions_are_applied_and_read_back() -> None:
    done = slide()
    assert done.result is not None
    assert [state[0].x for state in done.result.trajectory] == [0, 2, 4, 6, 8]
    assert done.destroyed == 1


@pytest.mark.parametrize(("broken", "match"), [("missing", "other properties"), ("type", "type str")])
def test_wrong_properties_are_refused(broken: str, match: str) -> None:
    with pytest.raises(RuntimeError, match=match):
        slide(broken=broken)


def test_a_simulator_that_dies() -> None:
    with pytest.raises(ConnectionError):
        slide(broken="dies")
    assert slide().result is not None


def test_actions_that_cannot_be_taken() -> None:
    text = "behavior B():\n    take 3\nego = new Object with behavior B\n"
    with pytest.raises(InvalidScenarioError, match="cannot take these actions"):
        Sliding(scene_of(text), maxSteps=4, name="x", timestep=1)


def test_a_destroyed_simulator_is_of_no_use() -> None:
    simulator = DummySimulator()
    simulator.destroy()
    with pytest.raises(RuntimeError, match="destroyed"):
        simulator.simulate(scene_of("ego = new Object"), maxSteps=1)
    with pytest.raises(RuntimeError, match="destroyed already"):
        simulator.destroy()


def test_the_simulator_of_a_program() -> None:
    text = "from scenic.core.simulators import DummySimulator\nparam drift = 2\nsimulator DummySimulator(drift=globalParameters.drift)\nego = new Object\n"
    scenario = scenic.scenarioFromString(text)
    assert scenario.getSimulator().drift == 2
    with pytest.raises(RuntimeError, match="no `simulator` statement"):
        scenic.scenarioFromString("ego = new Object").getSimulator()


SPINNING = "behavior B():\n    take 1\n    i = 0\n    while i < 4_000_000:\n        i += 1\nego = new Object with behavior B\n"


def test_code_that_spins_is_named() -> None:
    with pytest.warns(StuckBehaviorWarning, match=r"behavior 'B' has run for 0.05 s .*, at line [45];"):
        simulate(SPINNING, 2, stuck_after=0.05)
    with pytest.raises(StuckBehaviorError, match=r"behavior 'B' has run .*, at line [45];"):
        simulate(SPINNING.replace("4_000_000", "10**12"), 2, stuck_after=0.05, stuck_is_error=True)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("monitor M():\n    slow()\n    wait\nego = new Object\nrequire monitor M()\n", "monitor 'M'"),
        (
            "scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        slow()\n        wait\n",
            "scenario 'Main'",
        ),
        (
            "behavior A():\n    slow()\n    wait\nbehavior B():\n    do A()\nego = new Object with behavior B\n",
            "behavior 'A'",
        ),
        ("ego = new Object\nrecord slow() as x\n", "line [34]"),
    ],
)
def test_the_code_that_spins_is_that_of_a_block(text: str, place: str) -> None:
    slow = "def slow():\n    i = 0\n    while i < 2_000_000:\n        i += 1\n    return i\n"
    with pytest.warns(StuckBehaviorWarning, match=f"^{place} has run for 0.02 s"):
        simulate(slow + text, 1, stuck_after=0.02)


def test_scripts_set_how_long_code_may_spin(monkeypatch: pytest.MonkeyPatch) -> None:
    import scenic.core.dynamics

    assert scenic.core.dynamics.stuckBehaviorWarningTimeout == 10
    monkeypatch.setattr(scenic.core.dynamics, "stuckBehaviorWarningTimeout", 0.05)
    with pytest.warns(StuckBehaviorWarning, match=r"has run for 0.05 s"):
        simulate(SPINNING, 2)


def test_code_that_spins_while_robustness_is_measured_is_no_margin() -> None:
    """A condition is computed once for its verdict, and again for its margin."""
    text = (
        "known = []\ndef late(y):\n    while y > 0 and y in known:\n        pass\n    known.append(y)\n    return y\n"
        "ego = new Object\nrequire always late(ego.y) < 9\n"
    )
    simulator = DummySimulator(drift=1, timestep=1)
    with pytest.raises(StuckBehaviorError, match=r"has run for 0\.05 s"):
        simulator.simulate(scene_of(text), maxSteps=4, robustness=True, stuck_after=0.05, stuck_is_error=True)


@pytest.mark.parametrize("kind", ["precondition", "invariant"])
def test_a_guard_that_rejects_does_not_hold(kind: str) -> None:
    text = (
        "def odd():\n    raise RejectionException('odd')\n"
        f"behavior B():\n    {kind}: odd()\n    while True:\n        take 1\nego = new Object with behavior B\n"
    )
    assert DummySimulator().simulate(scene_of(text), maxSteps=3) is None
    with pytest.raises(GuardViolation):
        DummySimulator().simulate(scene_of(text), maxSteps=3, raiseGuardViolations=True)


def test_files_of_no_known_kind_are_named() -> None:
    with pytest.raises(ValueError, match=r"extension '\.odd'"):
        scene_of("ego = new Object\nrecord 1 to 'run.odd'\n")


@pytest.mark.parametrize("kind", ["precondition", "invariant"])
@pytest.mark.parametrize("made", ["Other()", "bool(Sub())", "Watch() and True"])
def test_nothing_that_runs_is_created_in_a_guard(kind: str, made: str) -> None:
    text = (
        "behavior Other():\n    take 1\nmonitor Watch():\n    wait\nscenario Sub():\n    compose:\n        wait\n"
        f"behavior B():\n    {kind}: {made}\n    while True:\n        take 1\n"
        "scenario Main():\n    setup:\n        ego = new Object with behavior B\n"
    )
    with pytest.raises(InvalidScenarioError, match="cannot be created in a condition"):
        simulate(text, 2)


ENDING = """
behavior Last():
    while True:
        acted.append(("last", simulation().currentTime))
        take 1
behavior Ender():
    take 2
    take 3
    {end}
    take 4
acted = []
scenario Main():
    setup:
        ego = new Object
        record len(acted) as acted
        {main}
    compose:
        {compose}
scenario Sub():
    setup:
        new Object at (5, 5), with behavior Ender
        new Object at (9, 9), with behavior Last
"""


def test_a_behavior_that_ends_the_simulation_ends_it_at_once() -> None:
    """Whatever scenario its agent is of: nobody acts in that step, and the simulator does not advance."""
    agents = "new Object at (5, 5), with behavior Ender\n        new Object at (9, 9), with behavior Last"
    for main, compose in (("pass", "do Sub()"), (agents, "wait for 9 steps")):
        done = simulate(ENDING.format(end="terminate simulation", main=main, compose=compose), 9)
        assert done.currentTime == 2
        assert done.result is not None
        assert done.result.terminationType is TerminationType.terminatedByBehavior
        assert len(done.result.actions) == 2
        assert done.records["acted"] == [(0, 0), (1, 1), (2, 2)]


@pytest.mark.parametrize("value", ["3", "None", "'M'", "M", "B()", "Other()"])
@pytest.mark.parametrize("place", ["top", "setup", "compose"])
def test_only_monitors_can_be_required_as_such(value: str, place: str) -> None:
    """Wherever that is said; the error shows the line."""
    lines = {"top": "", "setup": "pass", "compose": "wait"} | {place: f"require monitor {value}"}
    text = (
        "monitor M():\n    wait\nbehavior B():\n    take 1\nscenario Other():\n    compose:\n        wait\n"
    )
    if place == "top":
        text += f"ego = new Object\n{lines['top']}\n"
    else:
        text += f"scenario Main():\n    setup:\n        ego = new Object\n        {lines['setup']}\n    compose:\n        {lines['compose']}\n        wait\n"
    with pytest.raises(ScenicTypeError, match="`require monitor`: expected a monitor") as caught:
        simulate(text, 2)
    assert caught.value.span is not None
    assert text.splitlines()[caught.value.span.line - 1].strip() == f"require monitor {value}"


def test_values_of_unknown_kinds_are_recorded_as_they_show_themselves(tmp_path: Path) -> None:
    value = "Path('a'), Colour.RED, {1}, (2.5, None), ego.position"
    text = "from pathlib import Path\nfrom enum import Enum\nclass Colour(Enum):\n    RED = 7\n"
    simulate(text + recording(tmp_path, "run.jsonl", f"({value})"), 0)
    (row,) = map(json.loads, (tmp_path / "run.jsonl").read_text().splitlines())
    assert row["value"] == [repr(Path("a")), "<Colour.RED: 7>", [1], [2.5, None], [0, 0, 0]]


def test_what_libraries_and_the_language_compute_is_recorded_as_plain_data(tmp_path: Path) -> None:
    expected = {
        "numpy.int64(2**53 + 1)": 2**53 + 1,
        "numpy.float32(0.5)": 0.5,
        "numpy.bool_(True)": True,
        "numpy.array([[1, 2], [3, 4]])": [[1, 2], [3, 4]],
        "[numpy.array(7), (numpy.uint8(9),)]": [7, [9]],
        "{3: (ego.position, numpy.int64(2)), None: {'a': {5}}, (1, 2): frozenset()}": {
            "3": [[0, 0, 0], 2],
            "None": {"a": [5]},
            "(1, 2)": [],
        },
        "ego.orientation": [0, 0, 0.5**0.5, 0.5**0.5],
        "new Point at (1, 2, 3)": [1, 2, 3],
        "1 + 2j": "(1+2j)",
    }
    text = f"import numpy\nparam recordFolder = {str(tmp_path)!r}\nego = new Object facing 90 deg\n"
    for number, value in enumerate(expected):
        text += f"record {value} to 'lines-{number}.jsonl'\nrecord {value} to 'one-{number}-{{step}}.json'\n"
    simulate(text, 0)
    for number, value in enumerate(expected.values()):
        alone = json.loads((tmp_path / f"one-{number}-0.json").read_text())
        assert json.loads((tmp_path / f"lines-{number}.jsonl").read_text())["value"] == alone
        assert alone == (pytest.approx(value) if number == 6 else value)


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ([1, 2, 3], "i"),
        ([1, 2.5, 3, 4.5], "f"),  # numbers stay those of the wider kind
        ([1, 2.5, "numpy.array(3j)", 4, 0.5], "c"),
        ([True, 2, False], "i"),
        ([2**53 + 1, True], "i"),
        (["'a'", "'abc'", "'b'"], "U"),
        (["numpy.float32(0.5)", 0.1], "f"),
        ([[1, 2], [0.5, 3], [4, 5]], "f"),
        ([[], []], "f"),
    ],
)
def test_arrays_are_of_the_widest_kind_of_all_values(tmp_path: Path, values: list[Any], kind: str) -> None:
    """Whichever of them it first comes with: those before and after it are as they were."""
    written = "[" + ", ".join(map(str, values)) + "]"
    text = f"import numpy\nvalues = {written}\n" + recording(
        tmp_path, "run.npz", "values[simulation().currentTime]"
    )
    simulate(text, len(values) - 1)
    found = np.load(tmp_path / "run.npz")["values"]
    expected = np.array(eval(written, {"numpy": np}))
    assert found.dtype.kind == kind
    assert found.shape == expected.shape
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("value", ["None", "[[1], [1, 2]]", "{1: 2}", "2**70", "[{}, 1]", "[None, 1.5]"])
def test_what_is_no_array_of_numbers_is_recorded_to_none(tmp_path: Path, value: str) -> None:
    for name in ("run.npz", "run-{step}.npy"):
        with pytest.raises(ScenicValueError, match="only numbers can be recorded as an array") as caught:
            simulate(recording(tmp_path, name, value), 1)
        assert caught.value.span is not None
    assert list(tmp_path.iterdir()) == []


def test_conditions_of_a_simulation_create_no_object() -> None:
    with pytest.raises(InvalidScenarioError, match="cannot create an object"):
        simulate("def made():\n    new Object at (9, 9)\nego = new Object\nterminate when made()")


def test_long_chains_of_objects_are_copied() -> None:
    """Each is a property of the next; they are more than Python's stack would hold."""
    text = (
        "class Car:\n    leader: None\nprevious = new Car at (0, -5), with foo Range(-1, 0)\nfor i in range(600):\n"
        "    previous = new Car at (2 * i, 0), with foo Range(i, i + 1), with leader previous\n"
        "ego = previous\ndef followed():\n    found = [ego]\n    while found[-1].leader is not None:\n"
        "        found.append(found[-1].leader)\n    return [item.foo for item in found]\n"
        "record followed() as values\n"
    )
    done = simulate(text, 1)
    assert done.result is not None
    expected = sorted((item.foo for item in done.scene.objects), reverse=True)
    assert len(expected) == 601
    assert done.result.records["values"] == [(0, expected), (1, expected)]


def test_a_condition_that_raises_is_over() -> None:
    """What a behavior does after it has caught the exception draws as before."""
    text = (
        "behavior B():\n    try:\n        require 1 / simulation().currentTime > 0\n    except ZeroDivisionError:\n"
        "        pass\n    take Range(1, 2)\nego = new Object with behavior B\n"
    )
    done = simulate(text, 1)
    assert done.result is not None
    ((action,),) = done.result.actions[0].values()
    assert 1 <= action <= 2


def test_an_ego_that_another_scenario_sets_later_is_none_before() -> None:
    parts = "".join(
        f"scenario {name}():\n    setup:\n        {statement}\n        terminate after 1 steps\n"
        for name, statement in (
            ("First", "ego = new Object at (5, 0)"),
            ("Second", "new Object at ego offset by (0, 3)"),
        )
    )
    text = f"scenario Main():\n    setup:\n        new Object\n    compose:\n        do Second()\n        do First()\n{parts}"
    with pytest.raises(InvalidScenarioError, match="ego object is used before it is set"):
        simulate(text)


@pytest.mark.parametrize("place", ["ego.position.x", "(distance to (0, 0))", "where()"])
def test_an_invoked_scenario_judges_its_ends_by_its_own_ego(place: str) -> None:
    """Whether the condition names the ego, means it, or calls what reads it."""
    text = (
        "def where(): return distance from (0, 0) to ego\n"
        "scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        do Sub()\n        wait\n"
        f"scenario Sub():\n    setup:\n        ego = new Object at (20, 0)\n        terminate when {place} > 10\n"
        "    compose:\n        while True:\n            wait\n"
    )
    done = DummySimulator().simulate(scene_of(text), maxSteps=9)
    assert done is not None
    assert done.result is not None
    assert (done.currentTime, done.result.terminationReason) == (1, "finished compose block")


@pytest.mark.parametrize("pattern", ["run.npz", "run.jsonl", "run.pickle", "{step}.json"])
def test_late_steps_are_recorded(tmp_path: Path, pattern: str) -> None:
    recorder, late = for_pattern(pattern), 3 * 2**31
    recorder.beginRecording(None, "run", 0.5, {"recordFolder": str(tmp_path)})
    recorder.recordValue(7, late)
    recorder.endRecording(False)
    (written,) = tmp_path.iterdir()
    if pattern == "{step}.json":
        assert written.name == f"{late}.json"
    elif pattern == "run.npz":
        found = np.load(written)
        assert (found["steps"].tolist(), found["times"].tolist()) == ([late], [late / 2])
    elif pattern == "run.jsonl":
        assert json.loads(written.read_text()) == {"step": late, "time": late / 2, "value": 7}
    else:
        assert pickle.loads(written.read_bytes()) == [(late, 7)]


def test_behaviors_whose_attributes_lead_back_to_them() -> None:
    text = (
        "behavior B(n):\n    take n\n"
        "b = B(Range(1, 2))\nb.itself = lambda: b\nb.n2 = Range(5, 6)\n"
        "ego = new Object with behavior b\n"
        "record (ego.behavior.itself() is ego.behavior, ego.behavior.itself().n2) as seen\n"
    )
    scene = scene_of(text)
    for _ in range(2):
        done = DummySimulator().simulate(scene, maxSteps=1)
        assert done is not None
        assert done.records["seen"][0][1][0] is True
        assert 5 <= done.records["seen"][0][1][1] <= 6


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ("self.position.x", 7),
        ("helper.x", 4),
        ("0 if True else x", 0),
        ("1 or x", 1),
        ("unused()", 6),
        ("[x for x in (1, 2)][1]", 2),
        ("(lambda x: x)(3)", 3),
    ],
)
def test_a_random_value_that_only_shares_its_name_with_what_code_reads_is_not_asked_for(
    code: str, found: float
) -> None:
    """As with an attribute, or in code that Python leaves out: no scene has a value of it."""
    text = (
        "x = Range(0, 1)\nclass Helper(object):\n    x = 4\nhelper = Helper()\n"
        "def unused():\n    if False:\n        return x\n    return 6\n"
        f"behavior B():\n    while True:\n        take {code}\nego = new Object at (7, 0), with behavior B\n"
    )
    assert taken(simulate(text, steps=1)) == [(found,)]


def test_recorders_that_a_program_makes_are_the_simulations_own_and_sampled() -> None:
    """What code reads is the one that records, and no other simulation of the scene finds anything in it."""
    text = """
from scenic.runtime.dynamics.recorders import Recorder
class Keeping(Recorder):
    def __init__(self, scale):
        self.scale, self.values = scale, []
    def recordValue(self, value, step):
        self.values.append(value * self.scale)
keeping = Keeping(Range(2, 3))
behavior Look():
    while True:
        take (keeping.scale, *keeping.values)
ego = new Object with behavior Look
record 1 to keeping
"""
    first, second = scenic.scenarioFromString(text).sample(2, seed=0)
    scales = []
    for scene in (first, second, first):
        done = DummySimulator().simulate(scene, maxSteps=3)
        assert done is not None
        scale = taken(done)[0][0]
        assert 2 < scale < 3
        assert taken(done) == [(scale,) * count for count in (2, 3, 4)]
        scales.append(scale)
    assert scales[0] == scales[2] != scales[1]
    alone = text.replace("(keeping.scale, *keeping.values)", "1").replace(
        "to keeping", "to Keeping(Range(2, 3))"
    )
    assert simulate(alone, 2).records == {"record13": [(0, 1), (1, 1), (2, 1)]}


def test_every_way_to_an_object_leads_to_that_of_the_simulation(tmp_path: Path) -> None:
    """A copy too many, or one that is missing, is an object that stays where it is."""
    (tmp_path / "keeping.scenic").write_text(
        "kept = []\ntable = {}\n"
        "def keep(thing):\n    kept.append(thing)\n    table['it'] = thing\n"
        "def it():\n    return table['it']\n"
    )
    text = """
import keeping
from keeping import keep, it, table as imported
from collections import OrderedDict, defaultdict, deque, namedtuple
from functools import lru_cache, partial
class Own(object):
    shared = None
    def __init__(self, thing):
        self.thing = thing
    def get(self):
        return self.thing
    @property
    def asked(self):
        return ego
    @staticmethod
    def of_none():
        return ego
    @classmethod
    def of_class(cls):
        return cls.shared
class Slotted(object):
    __slots__ = ("thing",)
    def __init__(self, thing):
        self.thing = thing
class Row(list):
    pass
class Car:
    friend: None
    def me(self):
        return self
    @property
    def itself(self):
        return self
behavior Look():
    while True:
        take [name for name, way in ways.items() if way() is not self]
ego = new Car with behavior Look
other = new Car at (5, 0), with friend ego
keep(ego)
Own.shared = ego
Pair = namedtuple("Pair", "thing number")
def given(thing=ego, *, named=ego):
    return thing if thing is named else None
def told():
    return ego
told.about = ego
def closed(thing):
    return lambda: thing
def yielding():
    yield ego
def same(thing):
    return thing
listed, held, cell, own = [ego], {"a": [({"b": ego},)]}, closed(ego), Own(ego)
asking, method, remembered = own.get, ego.me, lru_cache(None)(lambda: ego)
bound, keyed = partial(same, ego), partial(same, thing=ego)
default, ordered, queue = defaultdict(list, {1: [ego]}), OrderedDict(a=ego), deque([ego])
members, fixed, keys = {ego}, frozenset([ego]), {ego: 1}
pair, slotted, row, codes = Pair(ego, Range(0, 1)), Slotted(ego), Row([ego]), [lambda: ego]
ways = {
    "name": lambda: ego, "simulation": lambda: simulation().objects[0], "property": lambda: other.friend,
    "module": lambda: keeping.kept[0], "function of it": lambda: it(), "table": lambda: keeping.table["it"],
    "imported": lambda: imported["it"], "list": lambda: listed[0], "nested": lambda: held["a"][0][0]["b"],
    "default": lambda: given(), "attribute": lambda: told.about, "function": lambda: told(),
    "closure": lambda: cell(), "generator": lambda: next(yielding()), "code": lambda: codes[0](),
    "instance": lambda: own.thing, "bound": lambda: asking(), "asked": lambda: own.asked,
    "static": lambda: Own.of_none(), "class": lambda: Own.of_class(), "shared": lambda: Own.shared,
    "method": lambda: method(), "own method": lambda: ego.me(), "own property": lambda: other.friend.itself,
    "remembered": lambda: remembered(), "partial": lambda: bound(), "keyed": lambda: keyed(),
    "defaultdict": lambda: default[1][0], "ordered": lambda: ordered["a"], "deque": lambda: queue[0],
    "set": lambda: [*members][0], "frozenset": lambda: [*fixed][0], "keys": lambda: [*keys][0],
    "named tuple": lambda: pair.thing, "slot": lambda: slotted.thing, "derived list": lambda: row[0],
}
"""
    path = tmp_path / "main.scenic"
    path.write_text(text)
    scenario = scenic.scenarioFromFile(path)
    for scene in scenario.sample(2, seed=0):
        done = DummySimulator(drift=1).simulate(scene, maxSteps=2)
        assert done is not None
        assert taken(done) == [(), ()]


def test_what_a_behavior_was_given_before_the_simulation_is_sampled_and_its_own_then() -> None:
    text = """
behavior Count():
    take self.behavior.number, self.behavior.agent is self, self.behavior.other
    self.behavior.number += 1
    self.behavior.other.append(1)
    take self.behavior.number, self.behavior.agent is self, self.behavior.other
ego = new Object with behavior Count
ego.behavior.number = Range(1, 2)
ego.behavior.agent = ego
ego.behavior.other = []
"""
    scene = scene_of(text)
    numbers = set()
    for _ in range(2):
        done = DummySimulator().simulate(scene, maxSteps=2)
        assert done is not None
        (number, *first), (more, *second) = taken(done)
        assert more == number + 1
        assert first == second == [True, [1]]  # one list
        numbers.add(number)
    assert len(numbers) == 1


def test_a_global_name_that_only_a_simulation_sets_is_unknown_before_in_each() -> None:
    text = """
behavior Set(value):
    global late
    for _ in range(2):
        try:
            take late, told()
        except NameError:
            take "unknown"
        late = value
def told():
    return late
ego = new Object with behavior Set(5)
other = new Object at (5, 0), with behavior Set(6)
"""
    scene = scene_of(text)
    for _ in range(2):
        done = DummySimulator().simulate(scene, maxSteps=2)
        assert done is not None
        # In the second step the ego sets and reads, then the other one.
        assert taken(done) == [("unknown",), (5, 5)]
        assert taken(done, 1) == [("unknown",), (6, 6)]
