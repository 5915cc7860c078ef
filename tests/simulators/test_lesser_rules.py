"""Rules of simulations that show only in corners: who may create what, what is asked for, and what is told."""

import math
import signal
import sys
import threading
import time
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.batch.keeping import SimulationRecord
from scenic.language.errors import (
    DivergenceError,
    InvalidScenarioError,
    InvariantViolation,
    Located,
    RejectSimulationException,
    ScenicValueError,
    SerializationError,
    SimulationCreationError,
    annotation,
)
from scenic.runtime.dynamics.recorders import Recorder
from scenic.runtime.dynamics.requirements import RequirementOutcome
from scenic.runtime.temporal.monitors import Verdict
from scenic.runtime.values.values import Vector
from scenic.simulators.actions import Action
from scenic.simulators.dummy import DummySimulator
from scenic.simulators.kinematic import KinematicSimulator
from scenic.simulators.numbered_simulations import SimulatorChoiceError, choose_simulator, simulate_number
from scenic.simulators.replays import Replay, Tape
from scenic.simulators.results import Latest, NotKeptError
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator
from scenic.simulators.step_watchdog import Watch

from .test_interface import AGENTS, DRAWING, REJECTED, Plain, scene, simulator

MAIN = "scenario Main():\n    setup:\n        ego = new Object\n"
SUB = "scenario Sub():\n    setup:\n        new Object at (9, 9)\n    compose:\n        wait\n"


@pytest.mark.parametrize(
    "text",
    [
        "behavior B():\n    wait\n    new Object at (5, 5)\n    wait\nego = new Object with behavior B\n",
        "monitor M():\n    wait\n    new Object at (5, 5)\n    wait\nego = new Object\nrequire monitor M()\n",
        f"{MAIN}    compose:\n        wait\n        new Object at (5, 5)\n        wait\n",
        # Where another scenario has been set up before.
        f"{MAIN}    compose:\n        do Sub()\n        new Object at (5, 5)\n        wait\n{SUB}",
    ],
)
def test_objects_are_created_in_set_ups_alone(text: str) -> None:
    with pytest.raises(InvalidScenarioError, match="only in the setup of a scenario"):
        DummySimulator().simulate(scene(text), maxSteps=4)


def test_conditions_of_ends_draw_nothing() -> None:
    ends = "        terminate when simulation().currentTime > 1 and Range(0, 1) > 2\n"
    loaded = scene(f"{MAIN}{ends}    compose:\n        while True:\n            wait\n")
    with pytest.raises(InvalidScenarioError, match="cannot create a distribution"):
        DummySimulator().simulate(loaded, maxSteps=4)


@pytest.mark.parametrize(
    ("condition", "error"),
    [("late > 1", NameError), ("self.position.nothing > 1", AttributeError)],
)
def test_mistakes_in_conditions_of_interrupts_are_raised(condition: str, error: type[Exception]) -> None:
    text = (
        "behavior B():\n    try:\n        while True:\n            wait\n"
        f"    interrupt when {condition}:\n        wait\nego = new Object with behavior B\n"
        "if ego is None:\n    late = 1\n"
    )
    loaded = scene(text)
    with pytest.raises(error):
        DummySimulator().simulate(loaded, maxSteps=4)


def test_what_a_simulator_creates_is_mutated_already() -> None:
    text = (
        f"{MAIN}    compose:\n        do Sub()\n"
        "scenario Sub():\n    setup:\n        thing = new Object at (20, 0)\n        mutate thing\n    compose:\n        wait\n"
    )
    created = []

    class Seen(Plain):
        def createObjectInSimulator(self, obj: Any) -> None:
            created.append(tuple(obj.position))

    done = simulator(Seen).simulate(scene(text), maxSteps=3)
    assert done is not None
    assert len(created) == 2
    assert created[1] != (20, 0, 0)


def test_recorders_are_told_whether_what_they_kept_counts() -> None:
    told = []

    class Telling(Recorder):
        def beginRecording(self, *_arguments: Any) -> None:
            pass

        def recordValue(self, value: Any, step: int) -> None:
            pass

        def endRecording(self, canceled: bool) -> None:
            told.append(canceled)

    for more, canceled in (("", False), ("require eventually ego.position.x > 3\n", True)):
        told.clear()
        made = scenic.scenarioFromString(
            f"ego = new Object\nrecord ego.position.x to globalParameters.telling\n{more}",
            params={"telling": Telling()},
        )
        DummySimulator().simulate(made.sample(1, seed=0)[0], maxSteps=3)
        assert told == [canceled]


def test_arrays_that_a_simulation_changes_are_its_own() -> None:
    text = (
        "import numpy\ncounts = numpy.zeros(2)\nbehavior B():\n    while True:\n        counts[0] += 1\n        take counts[0]\n"
        "ego = new Object with behavior B\n"
    )
    one = scene(text)
    for _ in range(2):
        done = DummySimulator().simulate(one, maxSteps=3)
        assert done is not None
        assert [step[done.agents[0]][0] for step in done.result.actions] == [1, 2, 3]


def test_many_draws_of_a_row_are_different_numbers() -> None:
    (one,) = scenic.scenarioFromString(DRAWING).sample(1, seed=1, source=scenic.Sobol())
    done = DummySimulator().simulate(one, maxSteps=100, source=scenic.Sobol())
    assert done is not None
    drawn = [step[done.agents[0]][0] for step in done.result.actions]
    assert len(set(drawn)) == 100
    assert 0.3 < np.mean(drawn) < 0.7


def test_actions_from_outside_are_among_the_last_ones() -> None:
    class Open(Plain):
        def __init__(self, scene: Any, **options: Any) -> None:
            super().__init__(scene, maxSteps=3, name="1", timestep=1, deferred=True, **options)

    open_ = Open(scene(AGENTS))
    open_.begin()
    open_.advanceOnce()
    agent = open_.agents[0]
    open_.take(agent, [7])
    assert agent.lastActions == (1, 7)
    open_.take(agent, [8, 9])
    assert agent.lastActions == open_.actionSequence[-1][agent] == (1, 7, 8, 9)
    open_.cancel()


def test_a_simulation_cleans_up_once() -> None:
    ends = []

    class Counting(Plain):
        def __init__(self, scene: Any, **options: Any) -> None:
            super().__init__(scene, deferred=True, **options)

        def destroy(self) -> None:
            ends.append(self)

    made = Counting(scene(AGENTS), maxSteps=2, name="1", timestep=1)
    made.begin()
    made.cancel()
    made.cancel()
    assert ends == [made]


def test_all_actions_have_to_be_such_as_the_agent_can_take() -> None:
    text = (
        "from scenic.simulators.commands import SetVelocity, SetThrottle\n"
        "behavior B():\n    take {}\nego = new Object with behavior B\n"
    )
    for actions in ("SetVelocity((1, 0, 0)), SetThrottle(1)", "SetThrottle(1), SetVelocity((1, 0, 0))", "3"):
        with pytest.raises(InvalidScenarioError, match="cannot take these actions"):
            KinematicSimulator().simulate(scene(text.format(actions)), maxSteps=2)


def test_simulators_are_asked_for_what_they_decide_and_for_new_objects_at_once() -> None:
    text = (
        f"{MAIN}    compose:\n        do Sub()\n"
        "scenario Sub():\n    setup:\n        thing = new Object at (20, 0)\n        record thing.position.x as x\n"
        "    compose:\n        wait\n        wait\n"
    )
    asked: set[str] = set()

    class Asked(Plain):
        def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
            asked.update(properties)
            found = {name: getattr(obj, name) for name in properties}
            if obj.position.x >= 20:
                found["position"] = scenic_vector(obj.position.x + 1)
            return found

    done = simulator(Asked).simulate(scene(text), maxSteps=6)
    assert done is not None
    # Read back when it was created, and after each step.
    assert [x for _, x in done.result.records["x"]] == [21, 22]
    assert "heading" not in asked
    assert {"position", "yaw", "velocity"} <= asked


def scenic_vector(x: float) -> Any:
    from scenic.runtime.values.values import Vector

    return Vector(x, 0, 0)


@pytest.mark.parametrize("change", ["more", "less"])
def test_simulators_give_exactly_what_they_are_asked_for(change: str) -> None:
    class Wrong(Plain):
        def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
            found = {name: getattr(obj, name) for name in properties}
            if change == "more":
                return {**found, "mood": 1}
            del found["yaw"]
            return found

    with pytest.raises(RuntimeError, match="mood" if change == "more" else "yaw"):
        simulator(Wrong).simulate(scene(AGENTS), maxSteps=2)


@pytest.mark.parametrize(
    ("default", "given", "fine"),
    [
        ("True", False, True),
        ("True", 1, False),
        ("True", 0.5, False),
        ("0.5", True, False),
        ("0.5", 2, True),
        ("2", 2.5, True),
        ("'calm'", "glad", True),
        ("'calm'", ["glad"], False),
        ("['calm']", ["glad"], True),
        ("['calm']", "glad", False),
        ("'calm'", None, False),
        ("(1, 2, 3)", Vector(1, 2, 3), False),
        ("Vector(1, 2, 3)", Vector(4, 5, 6), True),
        ("Vector(1, 2, 3)", (4, 5, 6), False),
        ("Vector(1, 2, 3)", 4, False),
    ],
)
def test_properties_keep_the_type_of_their_default(default: str, given: Any, fine: bool) -> None:
    class Telling(Plain):
        def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
            found = dict(super().getProperties(obj, properties))
            return {**found, "mood": given} if self.currentTime else found

    one = scene(
        f"class Moody:\n    mood[dynamic]: {default}\nego = new Moody\nrecord final ego.mood as mood\n"
    )
    if fine:
        done = simulator(Telling).simulate(one, maxSteps=1)
        assert done is not None
        assert done.records["mood"] == given
    else:
        with pytest.raises(RuntimeError, match=r"gave property 'mood' of .* a value of type"):
            simulator(Telling).simulate(one, maxSteps=1)


def test_a_look_back_is_behind_whatever_came_of_it() -> None:
    """Raised while it was handled, or from it."""

    def failed(raising: Any) -> BaseException:
        try:
            raising()
        except Exception as error:  # noqa: BLE001 - what comes of it is looked at
            return error
        raise AssertionError

    def looking() -> None:
        Latest("state")[0]

    def handling() -> None:
        try:
            looking()
        except LookupError:
            raise ValueError("something else")  # noqa: B904 - as programs do

    def passing() -> None:
        try:
            looking()
        except LookupError as error:
            raise ValueError("something else") from error

    for raising in (looking, handling, passing):
        assert NotKeptError.behind(failed(raising))
    assert not NotKeptError.behind(failed(lambda: [][0]))
    assert not NotKeptError.behind(None)


def test_an_error_of_a_module_names_its_file(tmp_path: Path) -> None:
    """Where it was raised, not what led there."""
    (tmp_path / "lib.scenic").write_text(
        "def g(x):\n    y = x + 1\n    return 1 / (x - x)\nbehavior C(x):\n    wait\n    take g(x)\n"
    )
    for text, file, line in (
        ("from lib import g\nbehavior B():\n    take g(1)\n", "lib.scenic", 3),
        ("import lib\nbehavior B():\n    do lib.C(2)\n", "lib.scenic", 3),
        ("import lib\nbehavior B():\n    wait\n    do lib.C(2)\n    take (lib.count)\n", "lib.scenic", 3),
        ("import lib\nbehavior B():\n    take len(lib.count)\n", "main.scenic", 3),
    ):
        main = tmp_path / "main.scenic"
        main.write_text(f"{text}ego = new Object with behavior B\n")
        (one,) = scenic.scenarioFromFile(main).sample(1, seed=0)
        with pytest.raises((ZeroDivisionError, AttributeError)) as caught:
            DummySimulator().simulate(one, maxSteps=4)
        found = annotation(caught.value)
        assert found is not None
        assert found.span is not None
        assert (Path(str(found.filename)).name, found.span.line) == (file, line)


def test_what_enters_in_2d_mode_lies_in_the_plane() -> None:
    text = (
        "scenario Main():\n    setup:\n        ego = new Object at (1, 2)\n    compose:\n        do Sub()\n"
        "scenario Sub():\n    setup:\n        thing = new Object at (5, 5, 3), with heading 40 deg\n"
        "        record initial (thing.position, thing.heading) as thing\n    compose:\n        wait\n"
    )
    (one,) = scenic.scenarioFromString(text, mode2D=True).sample(1, seed=0)
    done = DummySimulator().simulate(one, maxSteps=2)
    assert done is not None
    place, heading = done.records["thing"]
    assert tuple(place) == (5, 5, 0)
    assert heading == pytest.approx(math.radians(40))


def test_replays_with_something_behind_them_are_damaged() -> None:
    data = Replay(b"key", [(1, 0.5)], [[1.0, 2.0], []]).encoded()
    assert Replay.decoded(data) == Replay(b"key", [(1, 0.5)], [[1.0, 2.0], []])
    for damaged in (data + b"\0", data[:-1], b"SCR2" + data[4:]):
        with pytest.raises(SerializationError):
            Replay.decoded(damaged)


def test_other_draws_diverge_only_where_that_is_looked_for() -> None:
    """Without the check, what was not drawn before is drawn anew."""
    first = DummySimulator().simulate(scene(DRAWING), maxSteps=3)
    assert first is not None
    other = scene(DRAWING.replace("take Range(0, 1)", "take 0 + Range(0, 1)"))
    again = DummySimulator().replay(other, first.getReplay(), maxSteps=3)
    assert again is not None
    assert again.replaying
    with pytest.raises(DivergenceError, match="did not draw"):
        DummySimulator().replay(other, first.getReplay(), maxSteps=3, enableDivergenceCheck=True)


def test_every_rejection_is_told() -> None:
    told: list[Exception] = []
    assert (
        DummySimulator().simulate(scene(REJECTED), maxSteps=1, maxIterations=3, onRejection=told.append)
        is None
    )
    assert len(told) == 3


def test_a_program_may_choose_its_simulator() -> None:
    text = (
        "from scenic.simulators.dummy import DummySimulator\nsimulator DummySimulator()\nego = new Object\n"
    )
    assert isinstance(choose_simulator(None, scenic.scenarioFromString(text)), DummySimulator)
    plain = scenic.scenarioFromString("ego = new Object\n")
    assert isinstance(choose_simulator(None, plain), KinematicSimulator)
    assert isinstance(choose_simulator("dummy", plain), Simulator)


# Kinematics


def course(properties: str, actions: str = "wait", steps: int = 10, timestep: float = 0.1) -> Any:
    text = (
        "from scenic.simulators.commands import *\n"
        f"behavior B():\n    {actions}\n    while True:\n        wait\nego = new Object with behavior B, {properties}\n"
        "record ego.position as place\nrecord ego.yaw as yaw\nrecord ego.pitch as pitch\nrecord ego.roll as roll\n"
    )
    done = KinematicSimulator(timestep=timestep).simulate(scene(text), maxSteps=steps)
    assert done is not None
    return done


def series(done: Any, name: str) -> Sequence[Any]:
    return [value for _, value in done.result.records[name]]


def test_a_quadrotor_that_gets_no_command_hovers() -> None:
    places = series(course("at (0, 0, 5), with dynamics 'quadrotor'"), "place")
    assert all(abs(place.z - 5) < 1e-9 for place in places)


def test_own_angles_of_objects_whose_frame_is_turned() -> None:
    """What moves straight on keeps the angles it had, whatever they are counted from."""
    done = course(
        "with parentOrientation Orientation.fromEuler(0.5, 0.4, 0.3), facing (0.2, -0.6, 0.1), with velocity (1, 2, 0)"
    )
    for name in ("yaw", "pitch", "roll"):
        values = series(done, name)
        first = getattr(done.scene.objects[0], name)
        assert values == pytest.approx([first] * len(values), abs=1e-9)


def test_a_bicycle_turns_by_its_mean_speed() -> None:
    """The way along the arc, over the base, times the tangent of the steering angle, is by how much it has turned."""
    done = course(
        "with dynamics 'bicycle', with length 5, with velocity (0, 2, 0)",
        "take SetThrottle(3), SetSteering(0.2)",
        steps=10,
    )
    turned = series(done, "yaw")[-1]
    way = 2 * 1.0 + 3 * 1.0**2 / 2
    assert turned == pytest.approx(way / (0.6 * 5) * math.tan(0.2), abs=1e-6)


@pytest.mark.parametrize("angle", [0.6, -0.6])
def test_wheels_are_steered_so_far_and_no_farther(angle: float) -> None:
    properties = "with dynamics 'bicycle', with velocity (0, 2, 0)"
    most, more = (
        series(course(properties, f"take SetSteering({value})", steps=4), "yaw")
        for value in (angle, 3 * angle)
    )
    assert most == more
    assert abs(most[-1]) > 0.3


def test_headings_stay_within_half_a_turn() -> None:
    """South itself is half a turn to the left."""
    done = course(
        "with dynamics 'differential', with width 1",
        f"take SetWheelSpeeds({-math.pi / 4}, {math.pi / 4})",
        steps=6,
        timestep=1.0,
    )
    assert series(done, "yaw") == pytest.approx(
        [0, math.pi / 2, math.pi, -math.pi / 2, 0, math.pi / 2, math.pi], abs=1e-9
    )


SUB = (
    "def noted(): log.append(len(log))\nlog = []\n"
    "behavior Calm():\n    while True:\n        wait\n"
    "behavior Busy():\n    noted()\n    while True:\n        wait\n"
    "scenario Main():\n    setup:\n        ego = new Object\n        record len(log) as starts\n"
    "    compose:\n        sub = Sub()\n        do sub\n"
    "scenario Sub():\n    setup:\n        thing = new Object at (4, 4), with behavior Calm\n"
    "        override thing with behavior {}\n    compose:\n        wait\n        wait\n"
)


@pytest.mark.parametrize(("behavior", "starts"), [("Busy", [0, 1, 1]), ("None", [0, 0, 0])])
def test_what_overrides_the_behavior_of_a_new_agent_starts_once(behavior: str, starts: list[int]) -> None:
    done = DummySimulator().simulate(scene(SUB.format(behavior)), maxSteps=3)
    assert done is not None
    assert [count for _, count in done.records["starts"]] == starts


def test_running_scenarios_show_what_they_hold() -> None:
    text = SUB.format("Calm").replace(
        "        do sub\n",
        "        do sub until seen(sub)\n",
    )
    text = (
        "found = []\ndef seen(sub):\n"
        "    found.append((sub.ego is ego, len(sub.objects), [tuple(item.position)[:2] for item in sub.agents]))\n"
        "    return False\n" + text.replace("len(log) as starts", "list(found) as found")
    )
    done = DummySimulator().simulate(scene(text), maxSteps=3)
    assert done is not None
    assert done.records["found"][-1][1][-1] == (True, 1, [(4, 4)])


@pytest.mark.parametrize(("name", "meant"), [("Kinematc", "kinematic"), ("MUJOCO", "mujoco"), ("zzz", None)])
def test_simulators_that_were_meant_are_named(name: str, meant: str | None) -> None:
    with pytest.raises(SimulatorChoiceError) as caught:
        choose_simulator(name, scenic.scenarioFromString("ego = new Object\n"))
    advice = str(caught.value.help)
    assert advice == f"did you mean `{meant}`?" if meant else "MODULE:CLASS" in advice


def test_what_became_of_a_requirement_is_told_in_words() -> None:
    assert repr(RequirementOutcome("near", 3, Verdict.PRESUMABLY_TRUE, 1.0)) == "<near: presumably true>"
    assert repr(RequirementOutcome("near", None, None, None)) == "<near: not evaluated>"


def test_a_property_without_a_value_takes_the_type_of_its_first_one() -> None:
    class Telling(Plain):
        def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
            found = dict(super().getProperties(obj, properties))
            found["mood"] = [None, 1.5, 2, self.odd][min(self.currentTime, 3)]
            return found

    text = "class Moody:\n    mood[dynamic]: None\nego = new Moody\nrecord ego.mood as mood\n"
    for odd, fine in ((2.5, True), ("glad", False), (scenic_vector(1), False)):
        Telling.odd = odd
        if fine:
            done = simulator(Telling).simulate(scene(text), maxSteps=4)
            assert done is not None
            assert [value for _, value in done.records["mood"]] == [None, 1.5, 2, 2.5, 2.5]
        else:
            with pytest.raises(RuntimeError, match="mood"):
                simulator(Telling).simulate(scene(text), maxSteps=4)


def test_each_property_without_a_value_takes_a_type_of_its_own() -> None:
    """Of each object."""

    class Telling(Plain):
        def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
            found = dict(super().getProperties(obj, properties))
            first = obj is self.objects[0]
            given = {"mood": True, "trust": 0.5} if first else {"mood": 1.5, "trust": Vector(1, 2, 3)}
            return {**found, **given} if self.currentTime else found

    done = simulator(Telling).simulate(
        scene(
            "class Moody:\n    mood[dynamic]: None\n    trust[dynamic]: None\nego = new Moody\nother = new Moody at (5, 5)\n"
            "record final [ego.mood, ego.trust, other.mood, other.trust] as moods\n"
        ),
        maxSteps=3,
    )
    assert done is not None
    assert done.records["moods"] == [True, 0.5, 1.5, Vector(1, 2, 3)]


def test_a_look_back_in_one_try_is_remembered_in_the_next() -> None:
    kept = SimulationRecord(None, "jsonl", shown=False)
    courses = [Latest("state"), Latest("state")]
    for course in courses:
        course.append(1)
        course.append(2)
    for course in courses:
        kept.begin()(SimpleNamespace(trajectory=course, actionSequence=[]), (), {})
        if course is courses[0]:
            assert not kept.looked_back()
            with pytest.raises(NotKeptError):
                course[0]
    assert kept.looked_back()


def test_a_recorder_that_cannot_begin_is_not_told_of_an_end() -> None:
    """Those that have begun are told that what they kept does not count."""
    told = []

    class Telling(Recorder):
        def __init__(self, name: str, *, begins: bool) -> None:
            self.name = name
            self.begins = begins

        def beginRecording(self, *_arguments: Any) -> None:
            if not self.begins:
                raise OSError("no such device")

        def recordValue(self, value: Any, step: int) -> None:
            told.append((self.name, step))

        def endRecording(self, canceled: bool) -> None:
            told.append((self.name, canceled))

    made = scenic.scenarioFromString(
        "ego = new Object\nrecord 1 to globalParameters.first\nrecord 2 to globalParameters.second\n",
        params={"first": Telling("first", begins=True), "second": Telling("second", begins=False)},
    )
    with pytest.raises(OSError, match="no such device"):
        DummySimulator().simulate(made.sample(1, seed=0)[0], maxSteps=3)
    assert told == [("first", True)]


def test_the_watch_over_a_step_ends_with_it_in_other_threads_too() -> None:
    """Nothing is said of code that has ended, or of what runs in the thread after it."""
    said: list[str] = []

    def work() -> None:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            for _ in range(3):
                with Watch(0.1, lambda frame: (None, "a line"), is_error=False):
                    pass
            time.sleep(0.2)
            said.extend(str(each.message) for each in caught)
            with Watch(0.02, lambda frame: (None, "a line"), is_error=False):
                time.sleep(0.2)
            assert "a line has run for 0.02 s" in str(caught[-1].message)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert said == []


def test_what_a_simulator_of_ones_own_raises_when_it_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Errors of the language stay what they are, with their code and help; others become one of the choice."""
    scenario = scenic.scenarioFromString("ego = new Object\n")
    for error, code, words in (
        (ScenicValueError("no such map", help="make one"), ScenicValueError.code, "no such map"),
        (LookupError("no such map"), SimulatorChoiceError.code, "cannot be made: no such map"),
        (LookupError(), SimulatorChoiceError.code, "cannot be made: LookupError"),
    ):

        def failing(error: Exception = error) -> None:
            raise error

        monkeypatch.setattr(sys.modules[__name__], "Failing", failing, raising=False)
        with pytest.raises(Located, match=words) as caught:
            choose_simulator(f"{__name__}:Failing", scenario)
        assert caught.value.diagnostic().code == code


@pytest.mark.parametrize(
    ("expected", "actual", "differ"),
    [
        (1.0, 1.05, False),
        (1.0, 1.15, True),
        (1.0, None, True),
        (None, 1.0, True),
        (None, None, False),
        ("a", "a", False),
        ("a", "b", True),
        (Vector(0, 0, 0), Vector(0, 0, 0.05), False),
        (Vector(0, 0, 0), Vector(0, 0, -0.15), True),
        (Vector(0, 0, 0), 0.0, True),
    ],
)
def test_values_differ_by_more_than_the_tolerance(expected: Any, actual: Any, differ: bool) -> None:
    """In any component, to either side; values of different kinds always do."""
    tape = Tape(None, key=b"", keep_draws=False, keep_states=False, tolerance=0.1, go_on=False)
    assert tape.differ(expected, actual) is differ


@pytest.mark.parametrize("rejected", [False, True])
def test_a_recorder_is_told_of_its_end_once(rejected: bool) -> None:
    """That of a scenario which is over is not told again when the simulation ends, well or not."""
    told = []

    class Telling(Recorder):
        def recordValue(self, value: Any, step: int) -> None:
            told.append(step)

        def endRecording(self, canceled: bool) -> None:
            told.append(canceled)

    text = (
        "scenario Main():\n    setup:\n        ego = new Object\n        {}\n"
        "    compose:\n        do Sub() for 2 steps\n        wait for 3 steps\n"
        "scenario Sub():\n    setup:\n        record 1 to globalParameters.telling\n"
    )
    more = "require eventually ego.position.x > 3" if rejected else "pass"
    made = scenic.scenarioFromString(text.format(more), params={"telling": Telling()})
    done = DummySimulator().simulate(made.sample(1, seed=0)[0], maxSteps=9)
    assert (done is None) is rejected
    assert told == [0, 1, False]


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no timer to watch with")
def test_the_watch_leaves_a_timer_that_runs_alone() -> None:
    """It is somebody else's: neither its time nor what it calls changes, nor does anything else interrupt the code."""
    called: list[int] = []
    before = signal.signal(signal.SIGALRM, lambda *_: called.append(1))
    mine = signal.getsignal(signal.SIGALRM)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        with Watch(0.01, lambda frame: (None, "a line"), is_error=True):
            assert signal.getsignal(signal.SIGALRM) is mine
            time.sleep(0.05)
        assert signal.getsignal(signal.SIGALRM) is mine
        assert called == []
        time.sleep(0.1)
        assert called == [1]
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


class Push(Action):
    """An action of a Python module, which holds what it is given."""

    __slots__ = ("much", "of")

    def __init__(self, of: Any, much: Any) -> None:
        self.of, self.much = of, much
        self.me, self.own = self, [self]

    def applyTo(self, agent: Any, simulation: Any) -> None:
        assert self.me is self.own[0] is self
        thing = self.of() if callable(self.of) else self.of
        thing.__dict__["position"] += self.much


def test_actions_made_before_the_simulation_hold_its_objects_and_values() -> None:
    """Whoever defined them; those in which nothing is random stay what they are."""
    text = """
from tests.simulators.test_lesser_rules import Push
from scenic.simulators.commands import SetVelocity
r, alone = Range(1, 2), Range(3, 4)
other = new Object at (Range(5, 6), 5)
def found(): return other
class Own(Push):
    def applyTo(self, agent, simulation):
        super().applyTo(agent, simulation)
        assert self.much == (0, 0, r)
        assert type(alone) is float
behavior B(*actions):
    while True:
        take actions
plain = SetVelocity((0, 0, 0))
ego = new Object with behavior B(Push(other, (r, 0, 0)), Push(found, (0, r, 0)), Own(other, (0, 0, r))), with plain plain
param r = r, plain = plain
"""

    class Acting(Plain):
        def executeActions(self, allActions: Mapping[Any, Sequence[Any]]) -> None:
            Simulation.executeActions(self, allActions)

    made = scenic.scenarioFromString(text)
    for one in made.sample(2, seed=0):
        assert one.egoObject.plain is one.params["plain"] is made.sample(1, seed=7)[0].params["plain"]
        begin, r = one.objects[1].position, one.params["r"]
        for _ in range(2):
            done = simulator(Acting).simulate(one, maxSteps=2)
            assert done is not None
            assert done.result is not None
            assert tuple(done.result.finalState[1]) == pytest.approx(
                (begin.x + 2 * r, begin.y + 2 * r, 2 * r)
            )
        assert one.objects[1].position == begin


def test_actions_that_are_random_in_part_are_sampled() -> None:
    """Whichever part of them it is, in a slot or not."""
    text = """
from scenic.simulators.actions import Action
class Mixed(Action):
    __slots__ = ("first",)
    def __init__(self, first, second, third): self.first, self.second, self.third = first, second, third
    def applyTo(self, agent, simulation): pass
    def held(self): return (self.first, self.second, self.third)
class Reading(Mixed):
    def held(self): return (*super().held(), r)
r = Range(0, 1)
ego = new Object
param r = r, made = [cls(*parts) for cls in (Mixed, Reading) for parts in ((r, 1, 'a'), (1, r, 'a'), (1, 'a', [r]), (1, 2, 3))]
"""
    for one in scenic.scenarioFromString(text).sample(2, seed=0):
        r = one.params["r"]
        found = [item.held() for item in one.params["made"]]
        parts = [(r, 1, "a"), (1, r, "a"), (1, "a", [r]), (1, 2, 3)]
        assert found == [*parts, *((*each, r) for each in parts)]


@pytest.mark.parametrize("model", ["point", "bicycle", "differential"])
def test_commands_with_random_numbers_may_be_arguments_of_behaviors(model: str) -> None:
    action = {
        "point": "SetVelocity((0, r, 0))",
        "bicycle": "SetThrottle(2 * r)",
        "differential": "SetWheelSpeeds(r, r)",
    }[model]
    text = (
        "from scenic.simulators.commands import *\nbehavior B(action):\n    take action\nr = Range(1, 2)\nparam r = r\n"
        f"ego = new Object with dynamics '{model}', with behavior B({action})\n"
    )
    for one in scenic.scenarioFromString(text).sample(2, seed=1):
        done = KinematicSimulator(timestep=1).simulate(one, maxSteps=1)
        assert done is not None
        assert done.result is not None
        assert done.result.finalState[0].y == pytest.approx(one.params["r"])


MOVED = "behavior B():\n    take 1\n    take 2\n    wait\nego = new Object with behavior B\nother = new Object at (5, 0)\n"


@pytest.mark.parametrize("keep_poses", [False, True])
def test_states_are_told_with_what_is_then_done(keep_poses: bool) -> None:
    """Nothing is done in the last one."""
    told: list[Any] = []

    def tell(simulation: Any, poses: Any, actions: Any) -> None:
        acting = {simulation.objects.index(agent): done for agent, done in actions.items()}
        told.append((simulation.currentTime, [place.y for place, _ in poses], acting))

    done = DummySimulator(drift=2).simulate(scene(MOVED), maxSteps=2, on_state=tell, keep_poses=keep_poses)
    assert told == [(0, [0, 0], {0: (1,)}), (1, [2, 2], {0: (2,)}), (2, [4, 4], {})]
    assert done is not None
    assert (done.poses is not None) is keep_poses


@pytest.mark.parametrize("begun", [False, True])
def test_a_simulation_that_is_given_up_cleans_up_though_it_never_began(begun: bool) -> None:
    ends = []

    class Counting(Plain):
        def destroy(self) -> None:
            ends.append(self)

    made = Counting(scene(AGENTS), maxSteps=2, name="1", timestep=1, deferred=True)
    if begun:
        made.begin()
    made.cancel()
    assert ends == [made]
    assert made.result is None


def test_what_fails_gives_the_objects_of_the_scene_back() -> None:
    one = scene(
        "behavior B():\n    take 1\n    raise RuntimeError('no more')\nego = new Object with behavior B\nnew Object at (5, 5)\n"
    )
    made = Plain(one, maxSteps=9, name="1", timestep=1, deferred=True)
    made.begin()
    assert made.objects[0] is not one.objects[0]
    assert made.advanceOnce()
    with pytest.raises(RuntimeError, match="no more"):
        made.advanceOnce()
    assert made.scene is one
    assert [item is own for item, own in zip(made.objects, one.objects, strict=True)] == [True, True]
    assert made.agents[0] is one.objects[0]
    assert list(made.actionSequence[0]) == [one.objects[0]]


@pytest.mark.parametrize("entering", [False, True])
def test_what_a_simulator_cannot_create_is_told_where_the_program_makes_it(entering: bool) -> None:
    class Small(Plain):
        def createObjectInSimulator(self, obj: Any) -> None:
            if obj.position.x > 3:
                raise SimulationCreationError("there is no room")

    more = "new Object at (9, 9)"
    text = (
        "scenario Main():\n    setup:\n        ego = new Object\n        {}\n    compose:\n        do Sub()\n"
        "scenario Sub():\n    setup:\n        {}\n    compose:\n        wait\n"
    ).format(*(("pass", more) if entering else (more, "pass")))
    with pytest.raises(SimulationCreationError, match="there is no room") as caught:
        simulator(Small).simulate(scene(text), maxSteps=2)
    assert caught.value.span is not None
    assert (caught.value.span.line, caught.value.span.column) == (9 if entering else 4, 8)
    assert caught.value.filename == "<string>"


def test_mistakes_of_what_enters_are_told_at_the_specifier() -> None:
    text = (
        "scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        do Sub()\n"
        "scenario Sub():\n    setup:\n        new Object at (9, 9), with width -1, with length 2\n    compose:\n        wait\n"
    )
    with pytest.raises(ScenicValueError, match="'width' must be greater than 0") as caught:
        DummySimulator().simulate(scene(text), maxSteps=2)
    span = caught.value.span
    assert span is not None
    assert (span.line, span.column, span.end_column) == (8, 30, 43)


def taken(done: Any) -> list[float]:
    assert done is not None
    return [step[done.objects[0]][0] for step in done.result.actions]


def test_replays_may_go_on_longer_than_what_they_replay() -> None:
    one = scene(DRAWING)
    options: dict[str, Any] = {"enableDivergenceCheck": True}
    first = DummySimulator(drift=1).simulate(one, maxSteps=3, **options)
    assert first is not None
    again = DummySimulator(drift=1).replay(one, first.getReplay(), maxSteps=7, **options)
    assert taken(again)[:3] == taken(first)
    assert len(set(taken(again))) == 7


def test_what_follows_a_divergence_is_drawn_from_another_key() -> None:
    one = scene(DRAWING)
    options: dict[str, Any] = {"enableDivergenceCheck": True, "continueAfterDivergence": True, "maxSteps": 5}
    first = DummySimulator(drift=1).simulate(one, **options)
    assert first is not None
    other = DummySimulator(drift=2).replay(one, first.getReplay(), **options)
    assert other is not None
    assert not other.replaying
    before, after = taken(first), taken(other)
    assert after[0] == before[0]
    assert not set(after[1:]) & set(before)


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_divergence_names_the_object(number: int) -> None:
    class Straying(Plain):
        straying = False

        def step(self) -> None:
            if self.straying:
                self.objects[number].__dict__["position"] = Vector(1, 2, 3 + number)

    one = scene(AGENTS)
    first = simulator(Straying).simulate(one, maxSteps=2, enableDivergenceCheck=True)
    assert first is not None
    Straying.straying = True
    with pytest.raises(DivergenceError, match=rf"step 1: position of object {number} is .*Vector\(1, 2"):
        simulator(Straying).replay(one, first.getReplay(), maxSteps=2, enableDivergenceCheck=True)


@pytest.mark.parametrize("length", [0, 1, 4, 5, 8, 12, 15, 20, 30])
def test_replays_that_are_cut_off_are_damaged(length: int) -> None:
    data = Replay(b"key", [(1, 0.5)], [[1.0, 2.0], []]).encoded()
    with pytest.raises(SerializationError):
        Replay.decoded(data[:length])


def test_of_a_latest_series_the_newest_member_has_two_places() -> None:
    series: Latest = Latest("states")
    for value in "abc":
        series.append(value)
        assert series[-1] == series[len(series) - 1] == value
    assert not series.missed
    for place in (0, 1, -2, 3, slice(None)):
        series.missed = False
        with pytest.raises(NotKeptError, match="of the states of this simulation"):
            series[place]
        assert series.missed


@pytest.mark.parametrize(("tries", "names"), [(1, ["run"]), (3, ["run.1", "run.2", "run.3"])])
def test_each_try_has_a_name(tries: int, names: list[str]) -> None:
    found = []

    class Named(Plain):
        def __init__(self, scene: Any, **options: Any) -> None:
            found.append(options["name"])
            super().__init__(scene, **options)

    simulator(Named).simulate(scene(REJECTED), 1, tries, name="run")
    assert found == names
    found.clear()
    simulator(Named).simulate(scene(REJECTED), 1, tries)
    assert found == [str(number + 1) for number in range(tries)]


def test_only_guards_are_raised_where_guards_are_to_be_raised() -> None:
    assert DummySimulator().simulate(scene(REJECTED), maxSteps=1, raiseGuardViolations=True) is None


@pytest.mark.parametrize(
    ("own", "asked", "seconds"), [(None, None, 1), (0.5, None, 0.5), (0.5, 0.25, 0.25), (None, 2, 2)]
)
def test_who_asks_decides_how_long_a_step_is(own: float | None, asked: float | None, seconds: float) -> None:
    done = DummySimulator(timestep=own).simulate(scene(AGENTS), maxSteps=2, timestep=asked)
    assert done is not None
    assert (done.timestep, done.currentRealTime) == (seconds, 2 * seconds)


def test_no_time_at_all_is_no_limit_for_a_step() -> None:
    """In this thread and in others."""

    def work() -> None:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            with Watch(0, lambda frame: (None, "a line"), is_error=True):
                time.sleep(0.02)
            said.extend(caught)

    said: list[Any] = []
    work()
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert said == []


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no timer to watch with")
def test_the_watch_puts_back_what_the_signal_called() -> None:
    def mine(*_: Any) -> None:
        pass

    before = signal.signal(signal.SIGALRM, mine)
    try:
        watch = Watch(30, lambda frame: (None, "a line"), is_error=True)
        for _ in range(2):
            with watch:
                assert signal.getsignal(signal.SIGALRM) is not mine
                assert 0 < signal.getitimer(signal.ITIMER_REAL)[0] <= 30
            assert signal.getsignal(signal.SIGALRM) is mine
            assert signal.getitimer(signal.ITIMER_REAL)[0] == 0
    finally:
        signal.signal(signal.SIGALRM, before)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no timer to watch with")
def test_a_watch_throughout_counts_the_time_of_each_step() -> None:
    """Short steps, and what goes on between them, take as long as they like; each long step is told of once."""
    watch = Watch(0.06, lambda frame: (None, "a line"), is_error=False, throughout=True)

    def spin(seconds: float) -> None:
        end = time.process_time() + seconds
        while time.process_time() < end:
            pass

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for inside, between in ((0.012, 0.0), (0.012, 0.0), (0.012, 0.08), *[(0.012, 0.0)] * 4):
            with watch:
                spin(inside)
            spin(between)
        assert caught == []
        for number in (1, 2):
            with watch:
                spin(0.15)
            assert len(caught) == number
        watch.release()
    assert signal.getitimer(signal.ITIMER_REAL)[0] == 0


@pytest.mark.parametrize("tries", [3, 5, 9])
def test_the_most_frequent_reason_of_rejections_is_the_first(tries: int) -> None:
    reasons = iter(["rare", "often", "often", "rare", "often"])

    class Rejecting(Plain):
        def step(self) -> None:
            for reason in reasons:
                raise RejectSimulationException(reason)

    made = scenic.scenarioFromString(AGENTS)
    found = simulate_number(made, simulator(Rejecting), seed=3, k=2, tries=tries, maxSteps=1)
    assert found.rejections == (("often", 2 if tries == 3 else 3), ("rare", 1 if tries == 3 else 2))
    assert found.tries == min(tries, 6)
    assert (found.k, found.seed, found.simulation is None) == (2, 3, tries < 6)


def test_simulations_in_which_nothing_is_random_are_tried_once() -> None:
    text = "import random\nego = new Object\nmonitor M():\n    x = {}\n    wait\nrequire monitor M()\nrequire eventually ego.x > 1\n"

    def tries(value: str) -> tuple[int, bool]:
        made = simulate_number(
            scenic.scenarioFromString(text.format(value)), DummySimulator(), seed=3, k=0, tries=4, maxSteps=1
        )
        return made.tries, made.is_random

    assert tries("1") == (1, False)
    assert tries("Range(0, 1)") == (4, True)
    assert tries("random.random()") == (4, True)


def test_scenes_of_a_number_are_tried_as_often_as_allowed() -> None:
    made = scenic.scenarioFromString(
        "ego = new Object at (Range(0, 1), 0)\nrequire (10000 * ego.x) % 10 < 0.3\n"
    )
    has = [
        simulate_number(made, DummySimulator(), seed=1, k=k, max_attempts=1, maxSteps=1).has_scene
        for k in range(8)
    ]
    assert has.count(False) > 4


def test_a_simulator_that_is_named_wins_over_that_of_the_program() -> None:
    made = scenic.scenarioFromString(
        "from scenic.simulators.dummy import DummySimulator\nsimulator DummySimulator(drift=3)\nego = new Object\n"
    )
    assert type(choose_simulator("kinematic", made)) is KinematicSimulator
    assert choose_simulator(None, made).drift == 3
    assert choose_simulator("dummy", made).drift == 0


def test_the_workspace_of_a_running_scenario_is_seen_from_outside() -> None:
    text = """
found = []
def seen(sub):
    found.append((sub.workspace.region.width, len(sub.agents)))
    return False
scenario Main():
    setup:
        ego = new Object
        record final list(found) as found
    compose:
        sub = Sub()
        do sub until seen(sub)
scenario Sub():
    setup:
        workspace = Workspace(RectangularRegion((0, 0), 0, 40, 30))
    compose:
        wait
        wait
"""
    done = DummySimulator().simulate(scene(text), maxSteps=4)
    assert done is not None
    assert done.records["found"][-1] == (40, 0)


@pytest.mark.parametrize("how", ["visible", "not visible"])
@pytest.mark.parametrize("of_its_own", [True, False])
def test_where_objects_enter_to_be_seen_or_not_is_in_the_workspace_of_their_scenario(
    how: str, of_its_own: bool
) -> None:
    """Which it sets itself, or has from the scenario that invokes it; that of the file is another."""
    rooms = [f"workspace = Workspace(RectangularRegion(({x}, 0), 0, 20, 20))" for x in (100, 200)]
    text = f"""
workspace = Workspace(RectangularRegion((0, 0), 0, 500, 500))
scenario Main():
    setup:
        ego = new Object
    compose:
        do Between()
scenario Between():
    setup:
        {rooms[0]}
    compose:
        do Sub()
scenario Sub():
    setup:
        {rooms[1] if of_its_own else "pass"}
        watcher = new Point at (150, 0), with visibleDistance {100 if how == "visible" else 1}
        x = new Object {how} from watcher, with width 0.1, with length 0.1
        record initial x.position.x as x
    compose:
        wait
"""
    low = 190 if of_its_own else 90
    for found in scenic.scenarioFromString(text).sample(3, seed=1):
        done = DummySimulator().simulate(found, maxSteps=1, maxIterations=50)
        assert done is not None
        assert low <= done.records["x"] <= low + 20


def test_an_ego_that_an_invoked_scenario_sets_is_that_of_running_ones_that_have_none() -> None:
    """So what these invoke later has it, too; those that have one keep it."""
    text = """
def where(): return ego.position.x
scenario Main():
    setup:
        record final where() as outermost
    compose:
        do Between(), Beside()
        do Later()
        do Other()
        do Later()
scenario Between():
    setup:
        record final where() as between
    compose:
        do Sets(10)
        wait
scenario Beside():
    compose:
        wait
        wait
        do Read()
scenario Sets(x):
    setup:
        ego = new Object at (x, 0)
    compose:
        wait
scenario Read():
    setup:
        record initial where() as beside
    compose:
        wait
scenario Later():
    setup:
        new Object at (ego offset by (0, 20 * (simulation().currentTime + 1)))
        record initial (distance to (10, 0)) as later
    compose:
        wait
scenario Other():
    setup:
        ego = new Object at (77, 0)
        record initial where() as other
    compose:
        wait
"""
    done = DummySimulator().simulate(scene(text), maxSteps=20)
    assert done is not None
    found = {name: done.records[name] for name in ("between", "beside", "outermost", "later", "other")}
    assert found == {"between": 10, "beside": 10, "outermost": 10, "later": 0, "other": 77}


def test_what_stands_in_between_in_a_simulation_hides() -> None:
    """Objects that have entered since the scene was made, where they are now."""
    text = """
scenario Main():
    setup:
        ego = new Object with requireVisible False
        other = new Object at (0, 20)
        record (ego can see other) as seen
    compose:
        wait
        do Sub() for 3 steps
scenario Sub():
    setup:
        new Object at (0, 9), with width 9, with height 9, with length 0.5
    compose:
        while True:
            wait
"""

    class Lifting(Plain):
        def getProperties(self, obj: Any, properties: Any) -> Any:
            values = super().getProperties(obj, properties)
            if obj.width == 9 and self.currentTime >= 2:
                values["position"] = Vector(0, 9, 99)
            return values

    done = simulator(Lifting).simulate(scene(text), maxSteps=4)
    assert done is not None
    assert [seen for _, seen in done.records["seen"]][:3] == [True, False, True]


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize(
    "ways",
    [
        "do b",
        "do b for 9 steps",
        "do choose b",
        "try:\n        do b\n    interrupt when False:\n        wait",
    ],
)
def test_behaviors_that_have_ended_may_be_done_again_by_anyone(order: tuple[int, int], ways: str) -> None:
    """By another agent: the one that did them first has nothing to do any more."""
    agents = ["new Object with behavior b", "new Object at (5, 5), with behavior Later"]
    names = ["first", "later"]
    text = (
        "behavior B():\n    take self.name, 1\n    take self.name, 2\n"
        f"behavior Later():\n    for i in range(3):\n        wait\n    {ways}\n    {ways}\n    take 9\n"
        "b = B()\n"
    )
    made = "".join(f"{names[i]} = {agents[i]}, with name '{names[i]}'\n" for i in order)
    done = DummySimulator().simulate(scene(f"{text}{made}ego = first\n"), maxSteps=9)
    assert done is not None
    told = {agent.name: [step[agent] for step in done.result.actions] for agent in done.result.actions[0]}
    assert told["first"] == [("first", 1), ("first", 2), *[()] * 7]
    assert told["later"] == [*[()] * 3, *[("later", 1), ("later", 2)] * 2, (9,), ()]


def test_scenarios_are_run_once_and_actions_refused_where_they_are_taken() -> None:
    again = f"{MAIN}    compose:\n        sub = Sub()\n        do sub\n        do sub\n{SUB_WAITS}"
    with pytest.raises(InvalidScenarioError, match=r"scenario Sub\(\) has been run already") as caught:
        DummySimulator().simulate(scene(again), maxSteps=4)
    assert caught.value.help == "create one for each use: `Sub(...)`"
    assert caught.value.span is not None
    assert caught.value.span.line == 7
    shared = "behavior B():\n    while True:\n        wait\nb = B()\nego = new Object with behavior b\nnew Object at (5, 5), with behavior b\n"
    with pytest.raises(InvalidScenarioError, match=r"behavior B\(\) is running already") as caught:
        DummySimulator().simulate(scene(shared), maxSteps=4)
    assert caught.value.span is not None
    assert caught.value.span.line == 6
    refused = (
        "behavior B():\n    wait\n    take 1\n    take (\n        3)\nego = new Object with behavior B\n"
    )

    class Picky(Plain):
        def actionsAreCompatible(self, agent: Any, actions: Any) -> bool:
            return tuple(actions) != (3,)

    with pytest.raises(InvalidScenarioError, match="cannot take these actions") as caught:
        simulator(Picky).simulate(scene(refused), maxSteps=4)
    assert caught.value.span is not None
    assert caught.value.span.line == 4
    assert caught.value.filename == "<string>"


SUB_WAITS = "scenario Sub():\n    setup:\n        pass\n    compose:\n        wait\n"


@pytest.mark.parametrize(
    ("condition", "told"),
    [
        ("always ego.y < 1.5", "is violated"),
        ("eventually ego.y > 9", "does not hold at the end; reached time limit (3 steps)"),
    ],
)
@pytest.mark.parametrize("depth", [0, 1, 2])
def test_a_requirement_is_told_to_be_violated_or_not_to_hold_whichever_scenario_asks_for_it(
    condition: str, told: str, depth: int
) -> None:
    """One that is violated within another scenario ends both while that is told."""
    inner = f"scenario Part{depth}():\n    setup:\n        require {condition}\n"
    outer = [f"scenario Part{n}():\n    compose:\n        do Part{n + 1}()\n" for n in range(depth)]
    main = "scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        do Part0()\n"
    text = "".join([inner, *outer, main])
    reasons: list[Exception] = []
    assert DummySimulator(drift=1).simulate(scene(text), maxSteps=3, onRejection=reasons.append) is None
    (reason,) = reasons
    assert str(reason) == f"requirement on line 3 {told}"


@pytest.mark.parametrize("order", [1, -1])
def test_agents_see_what_others_have_done_in_this_step_alone(order: int) -> None:
    """Those that decide earlier see nothing of the step before, and neither does anybody of one that has ended."""
    text = """
behavior Tell(name, steps):
    for i in range(steps):
        take name, tuple(other.lastActions[:1] for other in simulation().objects)
ego = new Object with behavior Tell("a", 3)
new Object at (5, 0), with behavior Tell("b", 3)
new Object at (9, 0), with behavior Tell("c", 1)
record tuple(other.lastActions[:1] for other in simulation().objects) as after
"""

    class Ordered(Plain):
        def scheduleForAgents(self) -> Sequence[Any]:
            return self.agents[::order]

    done = simulator(Ordered).simulate(scene(text), maxSteps=3)
    assert done is not None
    assert done.result is not None
    seen = [[actions[1] for actions in step.values() if actions] for step in done.result.actions]
    a, b, c, none = ("a",), ("b",), ("c",), ()
    if order == 1:
        assert seen == [
            [(none, none, none), (a, none, none), (a, b, none)],
            *[[(none, none, none), (a, none, none)]] * 2,
        ]
    else:
        assert seen == [
            [(none, b, c), (none, none, c), (none, none, none)],
            *[[(none, b, none), (none, none, none)]] * 2,
        ]
    after = [value for _, value in done.result.records["after"]]
    assert after == [(none, none, none), (a, b, c), (a, b, none), (a, b, none)]


CLEANED = """
behavior B(name):
    try:
        while True:
            wait
    finally:
        print(name)
behavior End():
    wait
    wait
    {end}
scenario Main():
    setup:
        ego = new Object with behavior B("ego")
        new Object at (3, 0), with behavior End
    compose:
        do Early() for 1 steps
        do Late()
scenario Early():
    setup:
        new Object at (6, 0), with behavior B("early")
scenario Late():
    setup:
        new Object at (9, 0), with behavior B("late")
        override ego with behavior B("override")
"""


@pytest.mark.parametrize(
    ("end", "fails"),
    [
        ("wait", None),
        ("terminate", None),
        ("terminate simulation", None),
        ("require False", RejectSimulationException),
        ("raise KeyError('end')", KeyError),
    ],
)
def test_all_behaviors_clean_up_once_whoever_made_their_agents(
    end: str, fails: type[Exception] | None, capsys: pytest.CaptureFixture[str]
) -> None:
    """That of an override first, with its scenario; the one that it suspended and those that outlived theirs as well."""
    rejections: list[Exception] = []
    made = scene(CLEANED.format(end=end))
    if fails is KeyError:
        with pytest.raises(KeyError):
            DummySimulator().simulate(made, maxSteps=4)
    else:
        done = DummySimulator().simulate(made, maxSteps=4, onRejection=rejections.append)
        assert (done is None) is bool(fails)
    assert list(map(type, rejections)) == [fails] * len(rejections)
    assert capsys.readouterr().out.split() == ["override", "ego", "early", "late"]


@pytest.mark.parametrize("invoked", [False, True])
@pytest.mark.parametrize("end", ["wait", "require False", "raise KeyError('end')"])
def test_a_recorder_of_a_scenario_that_still_runs_hears_how_the_simulation_ends(
    end: str, invoked: bool
) -> None:
    """Where it is given up, nothing is evaluated any more."""
    told: list[Any] = []

    class Telling(Recorder):
        def recordValue(self, value: Any, step: int) -> None:
            told.append(step)

        def endRecording(self, canceled: bool) -> None:
            told.append(canceled)

    body = "        record 1 to globalParameters.telling\n        record final globalParameters.count() as late\n"
    text = (
        f"behavior End():\n    wait\n    {end}\n    wait\n"
        "scenario Main():\n    setup:\n        ego = new Object with behavior End\n"
        + (f"    compose:\n        do Sub()\nscenario Sub():\n    setup:\n{body}" if invoked else body)
    )
    counted: list[int] = []
    params = {"telling": Telling(), "count": lambda: counted.append(1)}
    made = scenic.scenarioFromString(text, params=params).sample(1, seed=0)[0]
    if "KeyError" in end:
        with pytest.raises(KeyError):
            DummySimulator().simulate(made, maxSteps=2)
    else:
        DummySimulator().simulate(made, maxSteps=2)
    goes_well = end == "wait"
    assert told == ([0, 1, 2, False] if goes_well else [0, 1, True])
    assert counted == [1] * goes_well


BROKEN = """
scenario Main():
    setup:
        ego = new Object
    compose:
        {handled}
scenario Outer():
    compose:
        do Inner()
scenario Inner():
    invariant: {invariant}
    setup:
        require eventually ego.position.x > 3
    compose:
        wait
        {broken}
        wait
"""


@pytest.mark.parametrize("invoked", ["Inner()", "Outer()", "Other(), Outer()"])
@pytest.mark.parametrize(
    ("invariant", "broken", "error"),
    [
        ("True", "raise KeyError('broken')", KeyError),
        ("simulation().currentTime < 1", "pass", InvariantViolation),
        ("True", "require False", RejectSimulationException),
    ],
)
def test_what_goes_wrong_in_a_scenario_is_told_and_not_what_did_not_come_true_for_it(
    invariant: str, broken: str, error: type[Exception], invoked: str
) -> None:
    """As where no scenario invokes another. If the program catches it, the requirement rejects the simulation."""
    reasons: list[Exception] = []
    other = "scenario Other():\n    compose:\n        wait\n        wait\n"

    def run(handled: str) -> Simulation | None:
        text = other + BROKEN.format(handled=handled, invariant=invariant, broken=broken)
        done: Simulation | None = DummySimulator().simulate(
            scene(text), maxSteps=4, raiseGuardViolations=True, onRejection=reasons.append
        )
        return done

    if error is RejectSimulationException:
        assert run(f"do {invoked}") is None
        assert str(reasons.pop()).endswith("is violated")
    else:
        with pytest.raises(error):
            run(f"do {invoked}")
    assert not reasons
    handled = f"try:\n            do {invoked}\n        except {error.__name__}:\n            wait"
    if error is not RejectSimulationException:
        assert run(handled) is None
        assert str(reasons.pop()).endswith("does not hold at the end")


def test_after_a_divergence_nothing_is_compared_any_more() -> None:
    asked = []

    class Straying(Plain):
        def valuesHaveDiverged(self, obj: Any, prop: str, expected: Any, actual: Any) -> bool:
            asked.append((self.currentTime, prop))
            return prop == "velocity" and self.currentTime == 1

    made, runner = scene(AGENTS), simulator(Straying)
    first = runner.simulate(made, maxSteps=3, enableDivergenceCheck=True)
    assert first is not None
    assert asked == []
    again = runner.replay(
        made, first.getReplay(), maxSteps=3, enableDivergenceCheck=True, continueAfterDivergence=True
    )
    assert again is not None
    assert not again.replaying
    assert asked[-1] == (1, "velocity")
    assert asked.count(asked[-1]) == 1


@pytest.mark.parametrize("invoked", [False, True])
def test_a_scenario_that_ends_the_simulation_may_end_itself_in_the_same_step(invoked: bool) -> None:
    """Then it records nothing more in that step, unless it is the whole; the reason is the first one."""
    body = (
        "    setup:\n        record simulation().currentTime as found\n"
        "        terminate when simulation().currentTime >= 1\n"
        "    compose:\n        wait\n        terminate simulation\n"
    )
    if invoked:
        text = f"{MAIN}    compose:\n        do Part()\nscenario Part():\n{body}"
    else:
        text = "scenario Main():\n" + body.replace("setup:\n", "setup:\n        ego = new Object\n")
    done = DummySimulator().simulate(scene(text), maxSteps=4)
    assert done is not None
    assert done.result is not None
    assert done.result.terminationReason.startswith('"terminate simulation" executed')
    assert done.currentTime == 1
    assert done.records["found"] == [(0, 0), (1, 1)][: 1 if invoked else 2]
