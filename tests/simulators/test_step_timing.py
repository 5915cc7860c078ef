"""When things happen in a simulation, where a step more or less, or a value kept too long, would be seen."""

import math
from collections import Counter
from typing import Any

import pytest

import scenic
from scenic.language.errors import ScenicTypeError, ScenicValueError
from scenic.runtime.dynamics.time_draws import Draw, Seeded
from scenic.simulators.dummy import DummySimulation, DummySimulator
from scenic.simulators.results import TerminationType
from tests.simulators.test_simulations import scene_of, simulate, taken


def recorded(done: Any, name: str) -> list[Any]:
    return [value for _, value in done.records[name]]


# Records


@pytest.mark.parametrize(
    ("selection", "steps"),
    [
        ("every 0.25 seconds", [0, 2, 4, 6, 8]),  # two whole steps of a tenth of a second
        ("every 0.3 seconds", [0, 3, 6]),
        ("every 0.05 seconds", [0, 1, 2, 3, 4, 5, 6, 7, 8]),  # a step at least
        ("after 0.55 seconds", [5, 6, 7, 8]),
        ("every 3 steps after 4 steps", [6]),  # the period counts from the beginning, not from the delay
    ],
)
def test_periods_and_delays_are_whole_steps(selection: str, steps: list[int]) -> None:
    done = simulate(f"ego = new Object\nrecord 1 {selection} as one\n", 8, timestep=0.1)
    assert [step for step, _ in done.records["one"]] == steps


# Draws among what may start

CHOICES = """
behavior Never():
    precondition: False
    take "never"
behavior Take(what):
    take what
behavior B():
    while True:
        do choose {{{weights}}}
ego = new Object with behavior B
"""


def test_weights_of_what_may_not_start_do_not_count() -> None:
    text = CHOICES.format(weights='Take("a"): 1, Never(): 30, Take("b"): 2, Take("c"): 0')
    counts = Counter(action for (action,) in taken(simulate(text, 300, key=b"1")))
    assert counts.keys() == {"a", "b"}
    assert 70 < counts["a"] < 130


def test_nothing_of_weight_zero_may_start() -> None:
    text = CHOICES.format(weights='Take("a"): 0, Take("b"): 0')
    assert DummySimulator().simulate(scene_of(text), maxSteps=2) is None


@pytest.mark.parametrize(
    ("weight", "error"),
    [
        ("-1", ScenicValueError),
        ("-1e-300", ScenicValueError),
        ("float('nan')", ScenicValueError),
        ("float('inf')", ScenicValueError),
        ("'much'", ScenicTypeError),
        ("None", ScenicTypeError),
        ("[1]", ScenicTypeError),
    ],
)
def test_weights_are_numbers_from_zero_on_in_statements_as_in_distributions(
    weight: str, error: type[Exception]
) -> None:
    """Wherever the wrong one is among the others; and whether or not it belongs to what may start."""
    for options in (
        f'Take("a"): {weight}, Take("b"): 1',
        f'Take("b"): 1, Take("a"): {weight}',
        f'Take("b"): 1, Never(): {weight}',
    ):
        for word in ("choose", "shuffle"):
            with pytest.raises(error, match=f"`do {word}`: a weight is a number"):
                simulate(CHOICES.replace("choose", word).format(weights=options), 1)
    with pytest.raises(error, match="a weight is a"):
        simulate(f"ego = new Object\nparam x = Discrete({{'b': 1, 'a': {weight}}})\n", 1)


def test_weights_may_be_true_and_tiny() -> None:
    for weights in ('Take("a"): True, Take("b"): False', 'Take("b"): 0, Take("a"): 5e-324'):
        assert taken(simulate(CHOICES.format(weights=weights), 2)) == [("a",), ("a",)]


class Drawing(Seeded):
    """Gives one number whatever is drawn."""

    def __init__(self, number: float) -> None:
        super().__init__(b"")
        self._number = number

    def draw(self, place: int, what: Draw) -> float:
        return self._number


@pytest.mark.parametrize(("number", "taken_first"), [(2.0**-53, "a"), (1 - 2.0**-53, "b")])
def test_the_least_and_the_greatest_number_choose_the_first_and_the_last_that_may_start(
    number: float, taken_first: str
) -> None:
    """Also where what is left of the greatest one after all weights is not below zero, for rounding."""
    text = CHOICES.format(weights='Take("x"): 0, Never(): 1, Take("a"): 0.3, Take("b"): 0.7, Take("y"): 0')
    assert (1 - 2.0**-53) * (0.3 + 0.7) - 0.3 - 0.7 == 0
    assert taken(simulate(text, 2, source=lambda _: Drawing(number))) == [(taken_first,)] * 2


# Durations


@pytest.mark.parametrize("duration", ["True", "'2'", "None", "(1, 2)"])
@pytest.mark.parametrize("unit", ["steps", "seconds"])
def test_durations_are_numbers(duration: str, unit: str) -> None:
    for statement in (f"do A() for {duration} {unit}", f"wait for {duration} {unit}"):
        text = f"behavior A():\n    take 1\nbehavior B():\n    {statement}\n    take 2\nego = new Object with behavior B\n"
        with pytest.raises(ScenicTypeError, match=f"`for`: expected a number of {unit}"):
            simulate(text, 1)
    with pytest.raises(ScenicTypeError, match=f"`terminate after`: expected a fixed number of {unit}"):
        simulate(f"ego = new Object\nterminate after {duration} {unit}\n", 1)


@pytest.mark.parametrize("word", ["every", "after"])
@pytest.mark.parametrize(
    ("duration", "error", "match"),
    [
        ("True steps", ScenicTypeError, "expected a whole number of steps, not True"),
        ("'2' steps", ScenicTypeError, "expected a whole number of steps, not '2'"),
        ("1.5 steps", ScenicTypeError, "expected a whole number of steps, not 1.5"),
        ("True seconds", ScenicTypeError, "expected a number of seconds, not True"),
        ("-1 steps", ScenicValueError, "must be .* not -1"),
        ("-0.5 seconds", ScenicValueError, "must be .* not -0.5"),
    ],
)
def test_periods_and_delays_are_numbers(word: str, duration: str, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=f"`record ... {word}`?:? {match}") as caught:
        scene_of(f"ego = new Object\nrecord 1 {word} {duration}\n")
    assert caught.value.span is not None  # type: ignore[attr-defined] # errors of the language have one
    assert caught.value.span.line == 2  # type: ignore[attr-defined]


def test_a_period_may_be_no_time_only_as_a_delay() -> None:
    for unit in ("steps", "seconds"):
        done = simulate(f"ego = new Object\nrecord 1 every 2.0 steps after 0 {unit} as one\n", 4)
        assert [step for step, _ in done.records["one"]] == [0, 2, 4]
        with pytest.raises(ScenicValueError, match="every` must be more than 0, not 0"):
            scene_of(f"ego = new Object\nrecord 1 every 0 {unit}\n")


# Scenarios in parallel


@pytest.mark.parametrize(
    ("parts", "after"),
    [
        ("A(2)", 2),
        ("A(2), A(2)", 2),
        ("A(1), A(2)", 2),
        ("A(2), A(1), A(3)", 3),
        ("A(0), A(0)", 0),
        ("A(0), A(1)", 1),
    ],
)
def test_what_follows_scenarios_in_parallel_starts_with_the_end_of_the_last(parts: str, after: int) -> None:
    text = f"""
scenario Main():
    setup:
        ego = new Object
    compose:
        do {parts}
        do Next()
scenario A(n):
    compose:
        for i in range(n):
            wait
        if False:
            wait
scenario Next():
    setup:
        record simulation().currentTime as begun
    compose:
        wait
"""
    assert simulate(text, 9).records["begun"] == [(after, after)]


# What a compose block asks for while it runs


@pytest.mark.parametrize(
    ("formula", "holds"),
    [
        ("always ego.position.y != 0", True),  # what was before does not count
        ("always ego.position.y != 1", False),  # the step in which it is asked for does
        ("always ego.position.y != 2", False),
        ("eventually ego.position.y == 1", True),
        ("eventually ego.position.y == 0", False),
        ("next ego.position.y == 2", True),
        ("next ego.position.y == 1", False),
    ],
)
def test_requirements_of_a_compose_block_begin_with_the_step_that_asks_for_them(
    formula: str, holds: bool
) -> None:
    text = f"""
scenario Main():
    setup:
        ego = new Object
    compose:
        wait
        require {formula}
        wait
        wait
"""
    done = DummySimulator(drift=1).simulate(scene_of(text), maxSteps=9)
    assert (done is not None) is holds


def test_monitors_of_a_compose_block_begin_with_the_step_that_asks_for_them() -> None:
    """Those that have ended before end nothing for the others."""
    text = """
times = []
monitor Over():
    if False:
        wait
monitor Short():
    wait
monitor M(name):
    while True:
        times.append((name, simulation().currentTime))
        wait
scenario Main():
    setup:
        ego = new Object
        require monitor Over()
        require monitor M("first")
        require monitor Short()
        require monitor M("second")
        record final list(times) as times
    compose:
        wait
        require monitor M("late")
        wait
        wait
"""
    found = simulate(text, 9).records["times"]
    expected = {(name, time) for name in ("first", "second") for time in range(3)} | {
        ("late", 1),
        ("late", 2),
    }
    assert len(found) == len(set(found)) == 8
    assert set(found) == expected


@pytest.mark.parametrize(
    ("statements", "reason"),
    [
        (("terminate simulation", "terminate simulation"), 1),
        (("terminate", "terminate"), 1),
        (("terminate simulation", "terminate"), 0),
        (("terminate", "terminate simulation"), 1),
    ],
)
def test_of_several_monitors_the_last_that_asks_for_the_most_gives_the_reason(
    statements: tuple[str, str], reason: int
) -> None:
    text = "".join(f"monitor M{number}():\n    {line}\n" for number, line in enumerate(statements))
    text += "ego = new Object\nrequire monitor M0()\nrequire monitor M1()\n"
    result = simulate(text, 3).result
    assert result is not None
    assert result.terminationType is TerminationType.terminatedByMonitor
    assert result.terminationReason == f'"{statements[reason]}" executed on line {2 + 2 * reason}'


def test_a_workspace_is_that_of_its_scenario_and_of_what_that_runs() -> None:
    text = """
workspace = Workspace(RectangularRegion((0, 0), 0, 90, 90))
scenario Main():
    setup:
        ego = new Object
        record workspace.region.width as main
    compose:
        wait
        do Sub() for 2 steps
        do Inner("after") for 1 steps
scenario Sub():
    setup:
        workspace = Workspace(RectangularRegion((0, 0), 0, 40, 40))
        record workspace.region.width as sub
    compose:
        do Inner("within")
scenario Inner(name):
    setup:
        record (name, workspace.region.width) as inner
    compose:
        while True:
            wait
"""
    scene = scene_of(text)
    for _ in range(2):  # of one simulation nothing is left for the next
        done = DummySimulator().simulate(scene, maxSteps=9)
        assert done is not None
        assert set(recorded(done, "main")) == {90}
        assert recorded(done, "sub") == [40, 40]
        assert recorded(done, "inner") == [("within", 40), ("within", 40), ("after", 90)]


# Overrides


def test_what_follows_from_an_overridden_property_follows_at_once_and_back() -> None:
    program = """
scenario Main():
    setup:
        ego = new Object
        record ego.heading as heading
    compose:
        do Sub()
        wait
scenario Sub():
    setup:
        override ego with parentOrientation 90 deg
    compose:
        require abs(ego.heading - 90 deg) < 1e-9
        wait
"""
    done = DummySimulator().simulate(scene_of(program), maxSteps=4)
    assert done is not None
    assert recorded(done, "heading") == pytest.approx([math.pi / 2, 0, 0])


def test_what_was_computed_of_an_object_is_computed_again_after_an_override() -> None:
    program = """
behavior B():
    take ego.corners[0].x, ego.occupiedSpace.containsPoint((0.9, 0, 0))
    take ego.corners[0].x, ego.occupiedSpace.containsPoint((0.9, 0, 0))
    take ego.corners[0].x, ego.occupiedSpace.containsPoint((0.9, 0, 0))
scenario Main():
    setup:
        ego = new Object with behavior B
    compose:
        wait
        do Sub() for 1 steps
        wait
scenario Sub():
    setup:
        override ego with width 4
    compose:
        while True:
            wait
"""
    done = DummySimulator().simulate(scene_of(program), maxSteps=3)
    assert done is not None
    assert taken(done) == [(0.5, False), (2.0, True), (0.5, False)]


def test_dynamic_properties_of_a_program_follow_what_is_overridden_and_what_moves() -> None:
    text = """
class Car:
    span[dynamic, final]: self.width + self.position.y
scenario Main():
    setup:
        ego = new Car
        record (ego.span, ego.width, ego.y) as found
    compose:
        wait
        do Sub() for 2 steps
        wait
scenario Sub():
    setup:
        override ego with width 4
    compose:
        require ego.span == 4 + ego.y
        while True:
            wait
"""
    done = DummySimulator(drift=1).simulate(scene_of(text), maxSteps=4)
    assert done is not None
    found = recorded(done, "found")
    assert [width for _, width, _ in found] == [1, 4, 4, 1, 1][: len(found)]
    assert len(found) > 3
    assert all(span == width + y for span, width, y in found)


@pytest.mark.parametrize("default", ["0.25 relative to field", "bend", "(0, 0.25 relative to field)"])
def test_dynamic_properties_of_a_program_that_depend_on_the_object_are_computed_for_it_in_each_step(
    default: str,
) -> None:
    """A value may be named before: what it came to in one step is not what it is in the next."""
    text = f"""
field = VectorField("field", lambda place: 0.125 * place.y)
bend = 0.25 relative to field
class Car:
    turned[dynamic, final]: {default}
ego = new Car at (0, 1)
record (ego.turned[1] if isinstance(ego.turned, tuple) else ego.turned).yaw as found
"""
    done = DummySimulator(drift=1).simulate(scene_of(text), maxSteps=3)
    assert recorded(done, "found") == pytest.approx([0.25 + 0.125 * y for y in (1, 2, 3, 4)])


def test_dynamic_properties_of_a_program_stay_of_their_kind() -> None:
    text = """
class Car:
    velocity[dynamic, final]: (self.width, self.position.y)
ego = new Car at (0, 1)
record ego.velocity + (1, 1, 1) as found
"""
    done = DummySimulator(drift=1).simulate(scene_of(text), maxSteps=2)
    assert recorded(done, "found") == [(2, 2, 1), (2, 3, 1), (2, 4, 1)]


def test_values_that_depend_on_the_object_may_be_named_and_used_in_overrides() -> None:
    """They are computed where the object is then, of what was drawn for the scene."""
    text = """
field = VectorField("field", lambda place: 0.125 * place.y)
drawn = Range(0.25, 0.5)
bend = drawn relative to field
behavior Turn():
    while True:
        take drawn, self.first.yaw, self.again
        override self with again bend
ego = new Object at (0, 1), with behavior Turn, with first bend, with again None
"""
    done = DummySimulator(drift=1).simulate(scene_of(text), maxSteps=4)
    assert done is not None
    (drawn, *_, unset), *later = taken(done)
    assert unset is None
    assert 0.25 < drawn < 0.5
    for y, (same, first, again) in enumerate(later, start=2):
        assert same == drawn
        assert first == pytest.approx(drawn + 0.125)
        assert again.yaw == pytest.approx(drawn + 0.125 * y)


def test_behaviors_of_two_scenarios_that_override_one_agent_take_one_turn_in_each_step() -> None:
    """Whether or not it had one before; the later one counts, and afterwards the earlier one again."""
    text = """
behavior B(what):
    while True:
        take what
scenario Main():
    setup:
        ego = new Object at (0, 0){before}
    compose:
        do First(), Second()
        wait
scenario First():
    setup:
        override ego with behavior B(1)
    compose:
        wait
        wait
        wait
scenario Second():
    setup:
        override ego with behavior B(2)
    compose:
        wait
        wait
"""
    for before, alone in (("", []), (", with behavior B(0)", [[0]])):
        done = DummySimulator().simulate(scene_of(text.format(before=before)), maxSteps=6)
        assert done is not None
        assert done.result is not None
        assert [list(map(list, step.values())) for step in done.result.actions] == [
            [[2]],
            [[2]],
            [[1]],
            alone,
        ]
        assert list(done.agents) == [done.objects[0]]


def test_properties_go_back_to_what_the_override_found() -> None:
    """Also if the earlier of two scenarios that run side by side stops first, as it was established."""
    text = """
class Box:
    content: 1
scenario Over(value, steps):
    setup:
        override ego with content value
        override ego with content value + 0.5
    compose:
        wait for steps steps
scenario Main():
    setup:
        ego = new Box
        record ego.content as found
    compose:
        do {parts}
        wait
"""
    for parts, found in (
        ("Over(5, 2), Over(6, 3)", [6.5, 6.5, 1, 5.5, 5.5]),
        ("Over(5, 3), Over(6, 2)", [6.5, 6.5, 5.5, 1, 1]),
    ):
        assert recorded(simulate(text.format(parts=parts), 4), "found") == found


def test_a_behavior_of_an_override_acts_for_the_scenario_that_asked_for_it() -> None:
    text = """
behavior Stop():
    wait
    terminate
scenario Main():
    setup:
        ego = new Object
    compose:
        do Sub()
        wait
        wait
scenario Sub():
    setup:
        override ego with behavior Stop
    compose:
        while True:
            wait
"""
    done = DummySimulator().simulate(scene_of(text), maxSteps=9)
    assert done is not None
    assert done.result is not None
    assert (done.currentTime, done.result.terminationReason) == (4, "finished compose block")


def test_overrides_are_computed_where_the_object_is() -> None:
    """What depends on a place, also within lists and dictionaries, is that of the object as it is then."""
    text = """
field = VectorField("field", lambda place: place.y)
scenario Main():
    setup:
        ego = new Object with foo 0, with bar 0
        record ego.foo as foo
        record ego.bar as bar
    compose:
        wait
        do Sub()
scenario Sub():
    setup:
        override ego with foo (0.25 relative to field)
        override ego with bar [{"a": (0.25 relative to field)}, ego.width]
    compose:
        wait
"""
    done = DummySimulator(drift=1).simulate(scene_of(text), maxSteps=1)
    assert done is not None
    _, turn = recorded(done, "foo")
    _, (held, width) = recorded(done, "bar")
    assert (turn.yaw, held["a"].yaw) == pytest.approx((1.25, 1.25))
    assert width == 1


def test_overrides_in_2d_mode_are_read_as_in_that_mode() -> None:
    """There a heading may be specified, which gives angles that a simulator decides."""
    text = """
scenario Main():
    setup:
        ego = new Object
    compose:
        do Sub()
scenario Sub():
    setup:
        override ego with heading 90 deg
    compose:
        wait
"""
    for flat, match in (
        (True, "is dynamic and cannot be overridden"),
        (False, "cannot be directly specified"),
    ):
        made = scenic.scenarioFromString(text, mode2D=flat).sample(1, seed=0)[0]
        with pytest.raises(scenic.SpecifierError, match=match):
            DummySimulator().simulate(made, maxSteps=3)


def test_a_final_property_that_is_not_dynamic_stays() -> None:
    text = """
class Car:
    token[final]: Range(0, 1)
scenario Main():
    setup:
        ego = new Car with foo 1
        record ego.token as token
    compose:
        wait
        do Sub() for 1 steps
        wait
scenario Sub():
    setup:
        override ego with foo 2
    compose:
        wait
        wait
"""
    done = DummySimulator(drift=1).simulate(scene_of(text), maxSteps=4)
    assert done is not None
    assert len(set(recorded(done, "token"))) == 1


REUSED = """
log = []
behavior First():
    while True:
        take 1
behavior Other(what):
    try:
        while True:
            take what
    finally:
        log.append(what)
second, third = Other(2), Other(3)
scenario Main():
    setup:
        ego = new Object with behavior First
        record final tuple(log) as ended
    compose:
        do Sub() for 2 steps
        wait
        do Sub() for 2 steps
        wait
scenario Sub():
    setup:
        override ego with behavior second
        {again}
    compose:
        while True:
            wait
"""


@pytest.mark.parametrize(
    ("again", "actions", "ended"),
    [
        ("pass", [2, 2, 1, 2, 2, 1], (2, 2)),
        ("override ego with behavior third", [3, 3, 1, 3, 3, 1], (3, 3)),
    ],
)
def test_behaviors_of_overrides_end_with_them_and_may_run_again(
    again: str, actions: list[int], ended: tuple[int, ...]
) -> None:
    done = DummySimulator().simulate(scene_of(REUSED.format(again=again)), maxSteps=6)
    assert done is not None
    assert [action for (action,) in taken(done)] == actions
    assert done.records["ended"] == ended


def test_a_monitor_ends_with_its_scenario_and_may_run_again() -> None:
    text = """
monitor M():
    while True:
        wait
m = M()
scenario Main():
    setup:
        ego = new Object
    compose:
        do Sub()
        do Sub()
scenario Sub():
    setup:
        require monitor m
    compose:
        wait
"""
    done = DummySimulator().simulate(scene_of(text), maxSteps=5)
    assert done is not None
    assert done.currentTime == 2


# Objects that come later

LATER = """
class Up(Mutator):
    def appliedTo(self, thing):
        thing.position = thing.position + (0, 0, 5)
        return thing, False
class Post:
    mutator[additive]: Up()
scenario Main():
    setup:
        ego = new Object
        record final simulation().objects[1].position as place
    compose:
        do Sub()
scenario Sub():
    setup:
        post = new {cls} at (9, 0, 0)
        mutate post by {scale}
    compose:
        wait
"""


@pytest.mark.parametrize("scale", [0.5, 1])
def test_objects_of_invoked_scenarios_are_mutated_too(scale: float) -> None:
    done = DummySimulator().simulate(scene_of(LATER.format(cls="Object", scale=scale)), maxSteps=2)
    assert done is not None
    x, y, z = done.records["place"]
    assert x != 9
    assert y != 0
    assert z == 0
    assert abs(x - 9) < 6 * scale


def test_a_mutator_of_the_program_may_stop_the_others_there_too() -> None:
    done = DummySimulator().simulate(scene_of(LATER.format(cls="Post", scale=1)), maxSteps=2)
    assert done is not None
    assert tuple(done.records["place"]) == (9, 0, 5)


# The order within a step


def test_an_end_that_a_monitor_brings_about_comes_in_the_next_step() -> None:
    text = """
flag = [False]
monitor M():
    wait
    flag[0] = True
    wait
ego = new Object
require monitor M()
terminate when flag[0] as raised
"""
    done = simulate(text, 9)
    assert done.result is not None
    assert (done.currentTime, done.result.terminationReason) == (2, "raised")
    assert done.result.terminationType is TerminationType.scenarioComplete


def test_actions_are_done_in_the_order_of_agents_whatever_the_schedule() -> None:
    class Backwards(DummySimulation):
        def scheduleForAgents(self) -> Any:
            return reversed(self.agents)

    text = "log = []\nbehavior B(n):\n    while True:\n        log.append(n)\n        take n, tuple(log)\n"
    text += "ego = new Object with behavior B(0)\nnew Object at (5, 0), with behavior B(1)\n"
    scene = scenic.scenarioFromString(text).sample(1, seed=0)[0]
    done = Backwards(scene, maxSteps=1, name="x", timestep=1)
    assert done.result is not None
    assert list(done.result.actions[0].values()) == [(0, (1, 0)), (1, (1,))]


def test_agents_outlive_their_scenario_and_draw_on() -> None:
    """The numbers of what they draw go on, too: none comes twice."""
    text = """
behavior B():
    while True:
        take Range(0, 1)
scenario Main():
    setup:
        ego = new Object
    compose:
        do Sub() for 3 steps
        while True:
            wait
scenario Sub():
    setup:
        new Object at (5, 0), with behavior B
"""
    (drawn,) = zip(*taken(simulate(text, 12), 1), strict=True)
    assert len(set(drawn)) == len(drawn) == 12


def test_at_the_end_scenarios_stop_from_the_newest_to_the_oldest(capsys: pytest.CaptureFixture[str]) -> None:
    text = """
scenario Main():
    setup:
        ego = new Object
    compose:
        try:
            do Sub("first"), Sub("second")
        finally:
            print("main")
scenario Sub(name):
    compose:
        try:
            while True:
                wait
        finally:
            print(name)
"""
    simulate(text, 3)
    assert capsys.readouterr().out.split() == ["second", "first", "main"]


# Limits and guards, step by step


@pytest.mark.parametrize(
    ("limit", "count"),
    [
        ("0 steps", 0),
        ("1 steps", 1),
        ("2 steps", 2),
        ("2.4 steps", 3),
        ("2.5 steps", 3),
        ("2.6 steps", 3),
        ("1 seconds", 2),
        ("1.1 seconds", 3),
        ("1.4 seconds", 3),
    ],
)
@pytest.mark.parametrize("statement", ["do Forever()", "wait"])
def test_what_lasts_a_while_ends_at_the_first_step_that_is_late_enough(
    statement: str, limit: str, count: int
) -> None:
    """Limits are not rounded: after two steps of half a second 1.1 seconds are not over."""
    text = (
        'behavior Forever():\n    while True:\n        take "in"\nbehavior B():\n    take "before"\n'
        f'    {statement} for {limit}\n    take "after"\nego = new Object with behavior B\n'
    )
    inside: tuple[str, ...] = () if statement == "wait" else ("in",)
    done = taken(simulate(text, 8, timestep=0.5))
    assert done[: 2 + count] == [("before",), *[inside] * count, ("after",)]
    assert len(done) == 8


@pytest.mark.parametrize("limit", [1, 2, 3])
@pytest.mark.parametrize("inner", ["wait", "do Idle()", "do Idle() for 100 steps"])
def test_a_scenario_is_over_after_its_steps_whatever_it_runs(limit: int, inner: str) -> None:
    text = (
        "scenario Idle():\n    compose:\n        while True:\n            wait\n"
        f"scenario Timed():\n    setup:\n        terminate after {limit} steps\n    compose:\n"
        f"        while True:\n            {inner}\n"
        "scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        wait\n        do Timed()\n"
    )
    done = simulate(text, 20)
    assert done.result is not None
    assert done.currentTime == 1 + limit


def test_initial_values_are_those_of_the_step_in_which_a_scenario_starts() -> None:
    text = (
        "scenario Late():\n    setup:\n        record initial simulation().currentTime as begun\n"
        "        record final simulation().currentTime as ended\n"
        "        record simulation().currentTime as all\n"
        "    compose:\n        wait\n        wait\n"
        "scenario Main():\n    setup:\n        ego = new Object\n"
        "    compose:\n        wait\n        wait\n        do Late()\n        wait\n"
    )
    done = simulate(text, 20)
    assert done.records["begun"] == 2
    assert done.records["ended"] == 4
    assert done.records["all"] == [(2, 2), (3, 3)]


NOTED = """
def note(what):
    print(what, simulation().currentTime)
    return True
behavior Inner():
    precondition: note("inner precondition")
    invariant: note("inner")
    take "inner"
    take "inner"
behavior B():
    precondition: note("precondition")
    invariant: note("invariant")
    take "own"
    take "own"
    do Inner()
    take "own"
ego = new Object with behavior B
"""


def test_guards_of_behaviors_are_asked_when_they_start_and_go_on(capsys: pytest.CaptureFixture[str]) -> None:
    """Invariants not at the first resumption, which the start has just asked, nor while something else is being done."""
    simulate(NOTED, 6)
    assert capsys.readouterr().out.splitlines() == [
        "precondition 0",
        "invariant 0",
        "invariant 1",
        "invariant 2",
        "inner precondition 2",
        "inner 2",
        "inner 3",
        "inner 4",
        "invariant 4",  # what was done is over
        "invariant 5",
    ]


@pytest.mark.parametrize("limit", ["for 1 steps", "until simulation().currentTime >= 3"])
def test_guards_are_asked_when_what_was_done_has_run_out(
    limit: str, capsys: pytest.CaptureFixture[str]
) -> None:
    simulate(NOTED.replace("do Inner()", f"do Inner() {limit}"), 5)
    assert capsys.readouterr().out.splitlines()[3:] == [
        "invariant 2",
        "inner precondition 2",
        "inner 2",
        "invariant 3",
        "invariant 4",
    ]


NOTED_SCENARIOS = """
def note(what):
    print(what, simulation().currentTime)
    return True
scenario Inner():
    precondition: note("inner precondition")
    invariant: note("inner")
    setup:
        x = 1
        terminate after 2 steps
scenario Main():
    invariant: note("invariant")
    setup:
        ego = new Object
    compose:
        wait
        wait
        do Inner()
        wait
"""


def test_guards_of_scenarios_are_asked_when_they_start_and_go_on(capsys: pytest.CaptureFixture[str]) -> None:
    """Those of one that composes nothing in each of its steps."""
    simulate(NOTED_SCENARIOS, 10)
    told = [line for line in capsys.readouterr().out.splitlines() if not line.startswith("nothing")]
    assert [line for line in told if line.startswith("inner")] == [
        "inner precondition 2",
        "inner 2",
        "inner 2",
        "inner 3",
    ]
    steps = [int(line.split()[1]) for line in told if line.startswith("invariant")]
    assert steps == [0, 1, 2, 4, 5]


@pytest.mark.parametrize("limit", ["for 2 steps", "until simulation().currentTime >= 2"])
def test_invariants_are_asked_after_a_wait_and_not_within(
    limit: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (
        "def note():\n    print(simulation().currentTime)\n    return True\n"
        f'behavior B():\n    invariant: note()\n    wait {limit}\n    take "own"\n    take "own"\n'
        "ego = new Object with behavior B\n"
    )
    simulate(text, 4)
    # Once at the start, once where the wait is over, then with each resumption.
    assert capsys.readouterr().out.split() == ["0", "2", "3"]


PLACES = """
class Box:
    content: 1
    reach[dynamic, final]: self.content + self.position.y
behavior Tell(name):
    while True:
        take name, self.content, self.reach, self.width
scenario Main():
    setup:
        ego = new Box with behavior Tell("before")
    compose:
        wait
        do Over() for 3 steps
        wait
"""
OVERRIDE = 'override ego with content 5, with width 3, with behavior Tell("over")'


@pytest.mark.parametrize(
    ("place", "late"),
    [
        ("{}", 0),
        ("require True\n    compose:\n        {}\n        while True:\n            wait", 0),
        ("require monitor Do()\nmonitor Do():\n    {}\n    while True:\n        wait", 0),
        # An agent decides after the ego, whose turn in this step was an earlier one.
        ("new Object at (9, 0), with behavior Do\nbehavior Do():\n    {}\n    while True:\n        wait", 1),
    ],
)
def test_overrides_are_the_same_from_wherever_the_scenario_asks_for_them(place: str, late: int) -> None:
    text = f"{PLACES}scenario Over():\n    setup:\n        {place.format(OVERRIDE)}\n"
    done = DummySimulator(drift=1).simulate(scene_of(text), maxSteps=7)
    assert done is not None
    assert taken(done) == [
        ("over", 5, 5 + y, 3) if 1 + late <= y < 4 else ("before", 1, 1 + y, 1) for y in range(5)
    ]


@pytest.mark.parametrize(
    "invocation",
    [
        "do Three()",
        "do Three() for 9 steps",
        "do Three() until simulation().currentTime == 9",
        "do choose Three()",
        "do shuffle Three()",
        "do Within()",
        "try:\n            do Three()\n        interrupt when simulation().currentTime == 9:\n            wait",
        "try:\n            while True:\n                wait\n        interrupt when True:\n            do Three()\n            abort",
    ],
)
@pytest.mark.parametrize("violated", [1, 2, 3])
def test_invariants_are_asked_in_each_step_however_a_behavior_is_invoked(
    invocation: str, violated: int
) -> None:
    """When it starts, and whenever it goes on, its end included."""
    text = f"""
behavior Three():
    invariant: simulation().currentTime != {violated}
    take 1
    take 1
    take 1
behavior Within():
    do Three()
behavior B():
    try:
        {invocation}
    except InvariantViolation:
        take "violated"
    take "after"
ego = new Object with behavior B
"""
    assert taken(simulate(text, 5)) == [
        *[(1,)] * violated,
        ("violated",),
        ("after",),
        *[()] * (3 - violated),
    ]


# Side by side, and limits


SIDE_BY_SIDE = """
behavior Two():
    take "a", "b"
    take "c"
behavior Three():
    for number in range(3): take number
behavior Stop():
    wait
    terminate
behavior Both():
    do {statement}
    take "end"
ego = new Object with behavior Both
"""


@pytest.mark.parametrize(
    ("statement", "actions"),
    [
        ("Two(), Three()", [("a", "b", 0), ("c", 1), (2,), ("end",)]),
        ("Three(), Two() for 1 steps", [(0, "a", "b"), ("end",), (), ()]),
        ("Three(), Two() until simulation().currentTime == 2", [(0, "a", "b"), (1, "c"), ("end",), ()]),
        ("Two(), Stop(), Three()", [("a", "b", 0)]),
    ],
)
def test_behaviors_run_side_by_side(statement: str, actions: list[tuple[Any, ...]]) -> None:
    assert taken(simulate(SIDE_BY_SIDE.format(statement=statement), 4)) == actions


def test_the_earliest_of_several_limits_ends_by_time() -> None:
    done = simulate(
        "ego = new Object\nterminate after 3 steps\nterminate after 1 seconds\nterminate after 5 steps\n",
        9,
        timestep=0.5,
    )
    assert len(done.result.actions) == 2
    assert done.result.terminationType is TerminationType.timeLimit


def test_records_cover_the_steps_in_which_their_scenario_runs() -> None:
    text = """
scenario Main():
    setup:
        ego = new Object
    compose:
        wait
        do Part() for 2 steps
        wait
scenario Part():
    setup:
        record simulation().currentTime as each
        record final simulation().currentTime as last
"""
    done = simulate(text, 9)
    assert done.records["each"] == [(1, 1), (2, 2)]
    assert done.records["last"] == 3


def test_a_limit_of_the_top_level_scenario_completes_it() -> None:
    done = simulate(
        "scenario Main():\n    setup:\n        ego = new Object\n        terminate after 2 steps\n", 9
    )
    assert len(done.result.trajectory) == 3
    assert done.result.terminationType is TerminationType.scenarioComplete
