"""Draws on which nothing depends."""

import pytest

import scenic
from scenic.falsification.space import space_of

COLORED = "ego = new Object with color (Range(0, 1), 0, 0)"
MEASURED = (
    "from scenic.domains.driving.measures import time_headway\n"
    "other = new Object at (5, 0)\nrequire time_headway(ego, other) > 0"
)
BEHAVIOR = "behavior Go():\n    x = self.{name}\n    wait\n"


def idle(text: str) -> set[str]:
    scenario = scenic.scenarioFromString(text)
    names = {axis.address: axis.name.text for axis in scenario.axes}
    searched = {item.address for item in space_of(scenario).coordinates}
    assert searched == names.keys() - scenario.idle_draws
    assert len(space_of(scenario, "scene")) == len(names)
    return {names[address] for address in scenario.idle_draws}


@pytest.mark.parametrize(
    "text",
    [
        COLORED,
        f"{COLORED}, with speed Range(1, 2)\nrequire ego.speed > 1.5",
        f"{BEHAVIOR.format(name='speed')}{COLORED}, with behavior Go",
        f"{COLORED}\nother = new Object at (5, 0)\nrequire (distance to other) > 2\nrecord ego.position",
        f"{COLORED}, with width Range(1, 2)\n{MEASURED}",
    ],
)
def test_colors_that_nobody_looks_at_are_idle(text: str) -> None:
    assert idle(text) == {"ego.color[0]"}


@pytest.mark.parametrize(
    "text",
    [
        f"{COLORED}\nrequire ego.color[0] > 0.5",
        f"{COLORED}\nrecord ego.color",
        f"{COLORED}\nrequire getattr(ego, 'color')[0] > 0.5",
        f"{BEHAVIOR.format(name='color')}{COLORED}, with behavior Go",
        "x = Range(0, 1)\nego = new Object with color (x, 0, 0)",
        "def make(x):\n    return new Object with color (x, 0, 0), with width 1 + x\nego = make(Range(0, 1))",
        "from scenic.core.sensors import *\n" + COLORED + ", with sensors {'front': 3}",
    ],
)
def test_colors_that_something_depends_on_are_not(text: str) -> None:
    assert idle(text) == set()


def test_defaults_of_behaviors_that_are_not_run_are_idle() -> None:
    behavior = "behavior Go(speed=Range(1, 2)):\n    wait\n"
    assert idle(behavior + "ego = new Object") == {"Go.speed"}
    assert idle(behavior + "behavior Run():\n    do Go()\nego = new Object with behavior Run") == set()
    assert idle(behavior + "ego = new Object with behavior Go") == set()
