"""Rules of what runs: when arguments are evaluated, guards are checked, records are made, and who acts."""

from typing import Any

import pytest

import scenic
from scenic.language.errors import DivergenceError, ScenicSyntaxError, SpecifierError
from scenic.simulators.dummy import DummySimulator


def _run(text: str, steps: int = 5, **options: Any) -> Any:
    scene, _ = scenic.scenarioFromString(text).generate(seed=1)
    return DummySimulator().simulate(scene, maxSteps=steps, **options)


def _actions(text: str, steps: int = 5) -> list[tuple[Any, ...]]:
    return [tuple(step.values()) for step in _run(text, steps).result.actions]


COMPOSED = """
scenario First():
    setup:
        y = 5
        ego = new Object
    compose:
        wait
        wait
scenario Second(n):
    setup:
        new Object at (n, 5)
        record n as n
    compose:
        wait
scenario Main():
    compose:
        first = First()
        second = Second(first.y + 1)
        do first, second
"""


def test_arguments_that_read_a_scenario_are_evaluated_when_their_own_starts() -> None:
    simulation = _run(COMPOSED)
    assert simulation.result.records["n"][0] == (0, 6)
    assert simulation.objects[1].position.x == 6
    with pytest.raises(AttributeError, match="scenario 'First' has no variable 'z'"):
        _run(COMPOSED.replace("first.y", "first.z"))


PREEMPTED = """
behavior Careful():
    invariant: self.bar < 1
    try:
        while True:
            take 1
    interrupt when simulation().currentTime == 1:
        take 2
        ego.bar = {bar}
behavior B():
    try:
        do Careful()
    except InvariantViolation:
        take 4
        take 4
ego = new Object with behavior B, with bar 0
"""


@pytest.mark.parametrize(("bar", "taken"), [(1, [1, 2, 4, 4, ()]), (0, [1, 2, 1, 1, 1])])
def test_a_block_that_goes_on_after_its_handler_checks_invariants(bar: int, taken: list[Any]) -> None:
    assert _actions(PREEMPTED.format(bar=bar)) == [((item,) if item else (),) for item in taken]


def test_an_unset_variable_of_a_behavior_is_an_error_in_a_condition() -> None:
    text = "behavior B():\n    try:\n        take 1\n    interrupt when x > 3:\n        take 2\n    x = 5\n"
    with pytest.raises(NameError, match="'x' of behavior 'B' is not set yet"):
        _run(f"{text}ego = new Object with behavior B\n")


def test_initial_records_are_made_before_others() -> None:
    records = _run(
        "order = []\ndef f(x):\n    order.append(x)\n    return len(order)\n"
        "ego = new Object\nrecord f('a') as a\nrecord initial f('b') as b\n",
        2,
    ).result.records
    assert records == {"b": 1, "a": [(0, 2), (1, 3), (2, 4)]}


def test_the_initial_scenario_of_a_composition_is_the_first_that_sets_up() -> None:
    text = """
scenario Main():
    compose:
        do A(), B()
scenario A():
    setup:
        if initial scenario:
            ego = new Object with mark 1
    compose:
        wait
scenario B():
    setup:
        new Object at (5, 5), with mark initial scenario
    compose:
        wait
"""
    assert [item.mark for item in _run(text).objects] == [1, False]


def test_agents_whose_behavior_was_taken_back_take_no_actions() -> None:
    text = """
behavior B():
    while True:
        take 1
scenario Main():
    setup:
        ego = new Object
        other = new Object at (5, 5), with behavior Once
    compose:
        do Sub()
        wait
behavior Once():
    take 2
scenario Sub():
    setup:
        override ego with behavior B
    compose:
        wait
"""
    assert _actions(text) == [((2,), (1,)), ((),)]


def test_a_replay_of_states_is_compared_with_them() -> None:
    text = "behavior B():\n    while True:\n        wait\nego = new Object with behavior B, with velocity (0, 1, 0)\n"
    scene, _ = scenic.scenarioFromString(text).generate(seed=1)
    recorded = DummySimulator(drift=1).simulate(scene, maxSteps=3, enableDivergenceCheck=True).getReplay()
    assert DummySimulator(drift=1).simulate(scene, maxSteps=3, replay=recorded).currentTime == 3
    with pytest.raises(DivergenceError):
        DummySimulator(drift=2).simulate(scene, maxSteps=3, replay=recorded)
    unchecked = DummySimulator(drift=1).simulate(scene, maxSteps=3).getReplay()
    assert DummySimulator(drift=2).simulate(scene, maxSteps=3, replay=unchecked).currentTime == 3


def test_definitions_have_the_signatures_that_the_program_gives_them() -> None:
    text = (
        "import inspect\nbehavior B(a, b=2):\n    wait\nmonitor M(x):\n    wait\nscenario S(q=1):\n    setup:\n"
        "        ego = new Object\nparam signatures = [str(inspect.signature(item)) for item in (B, M, S)]\n"
    )
    scene, _ = scenic.scenarioFromString(text).generate(seed=1)
    assert scene.params["signatures"] == ["(a, b=2)", "(x)", "(q=1)"]


def test_the_program_runs_as_the_main_module() -> None:
    scene, _ = scenic.scenarioFromString("ego = new Object with mark __name__\n").generate(seed=1)
    assert scene.egoObject.mark == "__main__"


def test_the_first_set_up_overrides_properties_of_scenes() -> None:
    text = """
behavior B(x):
    while True:
        take x
class Box:
    foo: 1
    twice: self.foo * 2
scenario Main():
    setup:
        ego = new Box with behavior B(0)
        override ego with foo Range(2, 3), with behavior B(1)
        new Object at (5, 5), with foo ego.foo
        record ego.foo as foo
"""
    scenario = scenic.scenarioFromString(text)
    scene, _ = scenario.generate(seed=1)
    first, second = scene.objects
    assert 2 <= first.foo == second.foo <= 3
    assert first.twice == 2  # Other properties stay, as in later scenarios.
    simulation = DummySimulator().simulate(scene, maxSteps=2)
    assert [tuple(step.values()) for step in simulation.result.actions] == [((1,),)] * 2
    assert simulation.result.records["foo"] == [(step, first.foo) for step in range(3)]
    for wrong, message in (("missing 1", "no property 'missing'"), ("velocity (1, 1)", "is dynamic")):
        with pytest.raises(SpecifierError, match=message):
            scenic.scenarioFromString(text.replace("foo Range(2, 3)", wrong))


def test_a_monitor_that_is_required_like_a_condition_is_a_syntax_error() -> None:
    with pytest.raises(ScenicSyntaxError, match="`monitor` is missing"):
        scenic.scenarioFromString("monitor M():\n    wait\nego = new Object\nrequire M()\n")


def test_fields_in_behaviors_mean_the_present_place_of_the_agent_and_in_specifiers_that_of_what_they_specify() -> (
    None
):
    text = (
        "field = VectorField('field', lambda place: place.x / 10)\n"
        "behavior Report():\n"
        "    spot = new OrientedPoint at (5, 0), facing 1 relative to field\n"
        "    take (1 relative to field).yaw, spot.yaw\n"
        "    self.position = (3, 0, 0)\n"
        "    take turned()\n"
        "def turned():\n"
        "    return (1 relative to field).yaw\n"
        "ego = new Object at (1, 0), with behavior Report\n"
    )
    assert _actions(text, 2) == [((pytest.approx(1.1), pytest.approx(1.5)),), ((pytest.approx(1.3),),)]


def test_fields_in_monitors_and_compose_blocks_mean_the_present_place_of_the_ego() -> None:
    """In a set-up they mean the place of what is made there."""
    text = (
        "field = VectorField('field', lambda place: place.x / 10)\n"
        "behavior Tell(*turns):\n"
        "    take turns\n"
        "    self.position = (3, 0, 0)\n"
        "    wait\n"
        "monitor Watch():\n"
        "    while True:\n"
        "        if (1 relative to field).yaw > 1.2:\n"
        "            terminate\n"
        "        wait\n"
        "scenario Sub(turn):\n"
        "    setup:\n"
        "        own = 1 relative to field\n"
        "        other = new Object at (5, 9), facing own\n"
        "        other.behavior = Tell(turn, other.yaw)\n"
        "scenario Main():\n"
        "    setup:\n"
        "        ego = new Object at (1, 0), with behavior Tell()\n"
        "        require monitor Watch()\n"
        "    compose:\n"
        "        do Sub((1 relative to field).yaw)\n"
    )
    assert _actions(text, 9) == [((), (pytest.approx(1.1), pytest.approx(1.5))), ((), ())]
