"""Meanings of Scenic 2 that the conversion keeps: scenes and simulations agree with values derived by hand."""

import math

import pytest

from scenic.migration.converting import Converter
from scenic.pipeline import scenarioFromString
from scenic.runtime.scenes.scenario import Scenario
from scenic.simulators.kinematic import KinematicSimulator


def converted(text: str) -> Scenario:
    result = Converter().convert(text, "program.scenic")
    assert result.problem is None
    return scenarioFromString(result.text)


def test_headings_are_those_of_the_world() -> None:
    scenario = converted(
        "class Box:\n    heading: 90 deg\n    requireVisible: False\n"
        "ego = Object at 0 @ 0, with heading 30 deg\n"
        "Box at 5 @ 0\n"
        "Box at 0 @ 5, with heading 10 deg\n"
    )
    ego, plain, turned = scenario.generate()[0].objects
    assert [each.heading for each in (ego, plain, turned)] == pytest.approx(
        [math.radians(angle) for angle in (30, 90, 10)]
    )


@pytest.mark.parametrize("specifier", ["offset by 0 @ 5", "offset along 90 deg by 0 @ 5"])
def test_offset_by_is_a_place_in_the_frame_of_the_ego_alone(specifier: str) -> None:
    """The ego looks along -x: 5 m ahead of (1, 2) is (-4, 2). The new object looks north, as no specifier turns it."""
    scenario = converted(f"ego = Object at 1 @ 2, with heading 90 deg\nObject {specifier}\n")
    other = scenario.generate()[0].objects[1]
    assert tuple(other.position) == pytest.approx((-4, 2, 0))
    assert other.heading == pytest.approx(0)


def test_objects_on_regions_lie_in_them() -> None:
    """The centre is on the region and not, as with `on` of Scenic 3, half a metre above it."""
    scenario = converted("ego = Object on CircularRegion(3 @ 3, 1)\n")
    assert [scenario.generate()[0].egoObject.position.z for _ in range(3)] == [0, 0, 0]


def test_classes_stay_visible_from_the_ego() -> None:
    """Of two places the one behind the ego, which sees a quarter to the north, is never taken."""
    scenario = converted(
        "class Box:\n    width: 1\n"
        "ego = Object at 0 @ 0, with viewAngle 90 deg\n"
        "Box at Uniform(0 @ 5, 0 @ -5)\n"
    )
    places = {scenario.generate(maxIterations=50)[0].objects[1].position.y for _ in range(8)}
    assert places == {5}


def test_deviations_are_horizontal() -> None:
    scenario = converted("ego = Object at 1 @ 2, with positionStdDev 0.5\nmutate ego\n")
    places = [scenario.generate()[0].egoObject.position for _ in range(3)]
    assert all(place.z == 0 and place.x != 1 and place.y != 2 for place in places)


def test_monitors_are_in_force_where_they_are_defined() -> None:
    """The monitor waits twice, then ends the simulation: three states."""
    scenario = converted("ego = Object\nmonitor M:\n    wait\n    wait\n    terminate\n")
    simulation = KinematicSimulator().simulate(scenario.generate()[0], maxSteps=9)
    assert simulation is not None
    assert simulation.result is not None
    assert len(simulation.result.trajectory) == 3


def test_terminate_of_a_behavior_ends_the_simulation() -> None:
    """Otherwise the inner scenario alone would end after one step, and the outer one would go on."""
    scenario = converted(
        "behavior Stop():\n    wait\n    terminate\n"
        "scenario Inner():\n    setup:\n        Object at 5 @ 5, with behavior Stop, with requireVisible False\n"
        "    compose:\n        while True:\n            wait\n"
        "scenario Main():\n    setup:\n        ego = Object\n    compose:\n        do Inner()\n        while True:\n"
        "            wait\n"
    )
    simulation = KinematicSimulator().simulate(scenario.generate()[0], maxSteps=9)
    assert simulation is not None
    assert simulation.result is not None
    assert len(simulation.result.trajectory) == 2


def test_parameters_keep_their_values() -> None:
    scenario = converted("param time_step = 0.25\nego = Object\n")
    assert scenario.generate()[0].params["timestep"] == 0.25
