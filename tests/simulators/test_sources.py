"""Scenes and simulations whose random numbers are chosen: Sobol's rows, an optimiser's, an earlier simulation's."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.stats import kstest, qmc

import scenic
from scenic.language.errors import ScenicWarning
from scenic.runtime.dynamics.time_draws import Draw
from scenic.simulators.dummy import DummySimulator
from scenic.simulators.numbered_simulations import simulate_number

FALSE_ALARM = 1e-6
SQUARE = "ego = new Object at (Range(0, 1), Range(0, 1))\n"
DRAWING = """
behavior B():
    while True:
        take Range(0, 1)
ego = new Object at (Range(0, 1), 0), with behavior B
other = new Object at (5, 0), with behavior B
"""


def places(scenes: list[scenic.Scene]) -> np.ndarray[Any, Any]:
    return np.array([[scene.egoObject.position.x, scene.egoObject.position.y] for scene in scenes])


def actions(simulation: Any) -> list[list[float]]:
    """What each agent did, step by step."""
    return [[step[agent][0] for step in simulation.result.actions] for agent in simulation.agents]


def first_action(simulation: Any) -> float:
    (action,) = simulation.result.actions[0][simulation.agents[0]]
    return float(action)


def test_scenes_by_sobol_are_spread_evenly() -> None:
    scenario = scenic.scenarioFromString(SQUARE)
    for seed in range(3):
        even = qmc.discrepancy(places(scenario.sample(256, seed=seed, source=scenic.Sobol())))
        assert even < 0.05 * qmc.discrepancy(places(scenario.sample(256, seed=seed)))


def test_parts_of_the_domain_are_chosen_one_by_one() -> None:
    """Two values that are each narrowed to two parts: all four pairs of parts are drawn alike."""
    program = scenic.scenarioFromString(
        "x = Range(-1, 1)\ny = Range(-1, 1)\nrequire abs(x) > 0.5\nrequire abs(y) > 0.5\nego = new Object at (x, y)\n"
    )
    scenes = program.sample(400, seed=6, source=scenic.Sobol())
    assert all(scene.attempts == 1 for scene in scenes)
    signs = (places(scenes) > 0) @ [1, 2]
    assert (np.bincount(signs, minlength=4) > 70).all()


def test_the_law_is_the_programs_also_where_candidates_are_rejected() -> None:
    scenario = scenic.scenarioFromString(
        "x = Range(0, 1)\ny = Range(0, 1)\nrequire x * x + y * y < 1\nego = new Object at (x, y)\n"
    )
    scenes = scenario.sample(4096, seed=2, source=scenic.Sobol())
    assert max(scene.attempts for scene in scenes) > 2
    found = places(scenes)
    assert (np.hypot(*found.T) < 1).all()
    # Uniform on a quarter of the disc: the square of the radius and the angle are.
    for column in (np.hypot(*found.T) ** 2, np.arctan2(found[:, 1], found[:, 0]) / (math.pi / 2)):
        assert kstest(column, "uniform").pvalue > FALSE_ALARM
    # And more even than random points are: half of them in half of the area, nearly.
    inner = (np.hypot(*found.T) ** 2 < 0.5).sum()
    assert abs(inner - 2048) < 32  # a standard deviation of random points


def test_scenes_by_sobol_are_functions_of_seed_and_number() -> None:
    scenario = scenic.scenarioFromString(SQUARE + "require ego.position.x + ego.position.y < 1.2\n")
    sobol = scenic.Sobol()
    whole = scenario.sample(40, seed=9, source=sobol)
    some = list(scenario.stream(5, seed=9, first=20, source=sobol, lanes=3))
    assert places(some).tolist() == places(whole[20:25]).tolist()  # type: ignore[arg-type] # scenes, all of them
    again = scenario.sceneFromBytes(scenario.sceneToBytes(whole[31]))
    assert places([again]).tolist() == places(whole[31:32]).tolist()
    assert places(scenario.sample(1, seed=9)).tolist() != places(whole[:1]).tolist()


def test_what_rows_do_not_give_is_a_function_of_seed_and_number_too() -> None:
    """The draws of the program's own functions, where candidates before are rejected in some scenes."""
    with pytest.warns(ScenicWarning, match="draws once"):
        program = scenic.scenarioFromString(
            "import random\ndef some(v): return hash(v) % 3 == 0\ndef noise(v): return v + random.random()\nx = Range(0, 1)\n"
            "require some(x)\ny = noise(x)\nrequire y > 0.5\nparam y = y\n"
        )
    for check in program._sampler.engine.plan.checks:
        check.separate = True  # each is made in those lanes alone that the ones before leave
    sobol = scenic.Sobol()
    together = [scene.params["y"] for scene in program.sample(20, seed=4, source=sobol)]
    for lanes in (1, 3):
        assert [
            scene.params["y"] for scene in program.sample(20, seed=4, source=sobol, lanes=lanes)
        ] == together


def test_an_optimiser_gives_points() -> None:
    loose = scenic.scenarioFromString(SQUARE)
    assert [axis.span.column for axis in loose.axes if axis.span] == [21, 34]
    points = scenic.GivenPoints([[0.25, 0.5], [0.9, 0.5], [0.1, 0.75]])
    assert places(loose.sample(3, seed=0, source=points)).tolist() == [[0.25, 0.5], [0.9, 0.5], [0.1, 0.75]]
    with pytest.raises(IndexError, match="no row for scene 3"):
        loose.sample(4, seed=0, source=points)


def test_points_that_meet_no_requirement_are_no_scenes() -> None:
    scenario = scenic.scenarioFromString(
        "x = Range(0, 1)\nego = new Object at (x, 0)\nrequire (lambda v: v < 0.5)(x)\n"
    )
    points = scenic.GivenPoints([[0.25], [0.75], [0.125]])
    found = list(scenario.stream(3, seed=0, source=points))
    assert [type(item).__name__ for item in found] == ["Scene", "Exhausted", "Scene"]
    assert [item.attempts for item in found] == [1, 1, 1]
    # There is no other point for them, however many candidates may be tried.
    again = list(scenario.stream(3, seed=0, source=points, max_attempts=9))
    assert [(type(item).__name__, item.attempts) for item in again] == [
        (type(item).__name__, 1) for item in found
    ]


def test_simulations_by_sobol_are_spread_evenly_in_time() -> None:
    scenario = scenic.scenarioFromString(DRAWING)
    simulator, sobol = DummySimulator(), scenic.Sobol()
    found, usual = [], []
    for scene in scenario.sample(128, seed=4, source=sobol):
        for source, into in ((sobol, found), (None, usual)):
            done = simulator.simulate(scene, maxSteps=2, source=source)
            into.append([scene.egoObject.position.x, *itertools.chain(*actions(done))])
    assert qmc.discrepancy(np.array(found)) < 0.4 * qmc.discrepancy(np.array(usual))
    for column in np.array(found).T:
        assert len(np.unique(np.floor(column * 128))) == 128


def test_simulations_tried_again_have_rows_of_their_own() -> None:
    scenario = scenic.scenarioFromString(
        "behavior B():\n    x = Range(0, 1)\n    take x\n    require x > 0.5\n    wait\nego = new Object with behavior B\n"
    )
    found, tries = [], []
    for k in range(64):
        made = simulate_number(scenario, DummySimulator(), seed=1, k=k, tries=40, sobol=True, maxSteps=2)
        assert made.simulation is not None
        found.append(first_action(made.simulation))
        tries.append(made.tries)
    assert max(tries) > 2
    assert min(found) > 0.5
    # 64 rows have 32 in each half, exactly: so many first tries succeed.
    assert tries.count(1) == 32
    (scene,) = scenario.stream(1, seed=1, first=tries.index(max(tries)), source=scenic.Sobol())
    again = DummySimulator().simulate(scene, maxSteps=2, maxIterations=40, source=scenic.Sobol())
    assert first_action(again) == found[tries.index(max(tries))]


def test_rows_go_on_into_simulations() -> None:
    scenario = scenic.scenarioFromString(DRAWING)
    points = scenic.GivenPoints([[0.5, 0.1, 0.2, 0.3]])
    (scene,) = scenario.sample(1, seed=0, source=points)
    done = DummySimulator().simulate(scene, maxSteps=3, source=points, key=b"k")
    assert done is not None
    assert actions(done)[0][:2] == pytest.approx([0.1, 0.3])
    assert actions(done)[1][0] == pytest.approx(0.2)
    hashed = DummySimulator().simulate(scene, maxSteps=3, key=b"k")
    # What the row does not tell is hashed, and by address: the same whatever was given.
    assert actions(done)[1][1:] == actions(hashed)[1][1:]
    replayed = DummySimulator().replay(scene, done.getReplay(), maxSteps=3)
    assert actions(replayed) == actions(done)


@pytest.mark.parametrize(
    ("options", "kept"),
    [
        ({"until": 2}, [[True, True, False, False]] * 2),
        ({"agents": [1]}, [[False] * 4, [True] * 4]),
        ({"agents": [0], "until": 3}, [[True, True, True, False], [False] * 4]),
        ({"keep": lambda draw: draw.occurrence == 1}, [[False, True, False, False]] * 2),
        ({"until": 0}, [[False] * 4] * 2),
        ({"agents": []}, [[False] * 4] * 2),
        ({"agents": [None]}, [[False] * 4] * 2),
        ({"agents": {0, 1}, "until": 1}, [[True, False, False, False]] * 2),
        ({"until": 2, "keep": lambda draw: draw.agent == 1}, [[False] * 4, [True, True, False, False]]),
        ({}, [[True] * 4] * 2),
    ],
)
def test_some_draws_of_an_earlier_simulation(options: dict[str, Any], kept: list[list[bool]]) -> None:
    (scene,) = scenic.scenarioFromString(DRAWING).sample(1, seed=0)
    simulator = DummySimulator()
    earlier = simulator.simulate(scene, maxSteps=4, key=b"earlier")
    assert earlier is not None
    source = scenic.Conditioned(earlier.getReplay(), **options)
    done = simulator.simulate(scene, maxSteps=4, key=b"later", source=source)
    anew = simulator.simulate(scene, maxSteps=4, key=b"later")
    for agent in (0, 1):
        for step in range(4):
            expected = earlier if kept[agent][step] else anew
            assert actions(done)[agent][step] == actions(expected)[agent][step]


def test_a_draw_says_where_it_is_made() -> None:
    (scene,) = scenic.scenarioFromString(DRAWING).sample(1, seed=0)
    simulator, seen = DummySimulator(), []
    earlier = simulator.simulate(scene, maxSteps=2)
    assert earlier is not None

    def keep(draw: Draw) -> bool:
        seen.append(draw)
        return True

    simulator.simulate(scene, maxSteps=2, source=scenic.Conditioned(earlier.getReplay(), keep=keep))
    assert seen == [
        Draw(1, agent, "take Range(0, 1)", 5, occurrence, occurrence)
        for occurrence in (0, 1)
        for agent in (0, 1)
    ]


def test_agents_that_enter_later_are_told_apart_by_their_places() -> None:
    text = """
behavior B():
    while True:
        take Range(0, 1)
scenario Main():
    setup:
        ego = new Object
        new Object at (3, 3), with behavior B
    compose:
        wait
        do Sub()
scenario Sub():
    setup:
        new Object at (5, 5)
        new Object at (7, 7), with behavior B
        new Object at (9, 9), with behavior B
    compose:
        while True:
            wait
"""
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=0)
    earlier = DummySimulator().simulate(scene, maxSteps=3, key=b"1")
    assert earlier is not None
    for kept in (1, 3, 4):
        done = DummySimulator().simulate(
            scene, maxSteps=3, key=b"2", source=scenic.Conditioned(earlier.getReplay(), agents=[kept])
        )
        assert done is not None
        for number in (1, 3, 4):
            pair = [
                [step[agent] for step in each.result.actions]
                for each in (done, earlier)
                for agent in [each.objects[number]]
            ]
            assert len(pair[0][-1]) == 1
            assert (pair[0] == pair[1]) is (number == kept)


def test_the_choice_of_a_box_is_a_draw_of_its_own() -> None:
    """Where analysis leaves several boxes of the cube, rows fill each of them evenly."""
    scenario = scenic.scenarioFromString("x = Range(0, 1)\nparam x = x\nrequire x < 0.2 or x > 0.8\n")
    assert scenario.domain.boxes > 1
    values = np.array([scene.params["x"] for scene in scenario.sample(256, seed=1, source=scenic.Sobol())])
    counts = np.histogram(values, [0, 0.1, 0.2, 0.8, 0.9, 1])[0]
    assert counts.tolist() == pytest.approx([64, 64, 0, 64, 64], abs=24)


def test_what_a_row_does_not_give_is_hashed() -> None:
    """As it is without rows: the numbers of other axes change nothing."""
    loose = scenic.scenarioFromString(SQUARE)
    hashed = places(loose.sample(3, seed=0))
    for rows, given in (([[0.25], [0.5], [0.75]], 1), (np.zeros((3, 0)), 0)):
        found = places(loose.sample(3, seed=0, source=scenic.GivenPoints(rows)))
        assert found[:, given:].tolist() == hashed[:, given:].tolist()
        assert found[:, :given].tolist() == [row[:given] for row in np.asarray(rows).tolist()]
    with pytest.warns(ScenicWarning, match="draws once"):
        wide = scenic.scenarioFromString(
            "import random\nego = new Object at (Range(0, 1), random.random() + Range(0, 1))\n"
        )
    assert np.isfinite(places(wide.sample(3, seed=0, source=scenic.GivenPoints([[0.5]] * 3)))).all()


def test_what_a_scenario_does_after_another_one_is_its_own() -> None:
    """Its draws have its number again; what it overrides ends with it."""
    text = """
scenario Main():
    setup:
        ego = new Object with foo 0
        record ego.foo as foo
    compose:
        first = Range(0, 1)
        do Sub() for 2 steps
        second = Range(0, 1)
        override ego with foo 1
        do Sub() for 2 steps
        third = Range(0, 1)
scenario Sub():
    compose:
        while True:
            within = Range(0, 1)
            wait
"""
    made: list[Draw] = []

    class Told:
        def __init__(self, rest: Any) -> None:
            self.rest, self.word = rest, rest.word

        def draw(self, place: int, what: Draw) -> float:
            made.append(what)
            return float(self.rest.draw(place, what))

    (scene,) = scenic.scenarioFromString(text).sample(1, seed=0)
    done = DummySimulator().simulate(scene, maxSteps=8, source=Told)
    assert done is not None
    assert [what.scenario for what in made if "within" not in what.line] == [1, 1, 1]
    inner = [what.scenario for what in made if "within" in what.line]
    assert len(set(inner)) == 2
    assert 1 not in inner
    assert [value for _, value in done.records["foo"]][:4] == [0, 0, 1, 1]
