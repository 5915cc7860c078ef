"""By how much requirements hold: the signed distances of comparisons, regions and objects, against values by hand."""

import math

import pytest

import scenic
from scenic.simulators.dummy import DummySimulator

SCENE = """
zone = RectangularRegion((0, 2), 0, 10, 10)
shelf = RectangularRegion((0, 2, 0.4), 0, 10, 10)
room = BoxRegion(dimensions=(20, 20, 20), position=(0, 0, 0))
far = RectangularRegion((0, 20), 0, 10, 10)
row = PointSetRegion('row', [(0, 0, 0), (0, 1, 0), (0, 2, 0), (0, 3, 0)])
ego = new Object with name 'ego'
wall = new Object at (0, 6), with shape SpheroidShape()
"""


def robustness(condition: str, steps: int) -> float:
    """Of a requirement while everything moves North by a metre in each step."""
    scene = scenic.scenarioFromString(f"{SCENE}require {condition}\n").sample(1, seed=0)[0]
    done = DummySimulator(drift=1).simulate(scene, maxSteps=steps, robustness=True)
    assert done is not None
    assert done.result is not None
    (outcome,) = done.result.requirements
    assert outcome.robustness is not None
    return outcome.robustness


@pytest.mark.parametrize(
    ("condition", "margin"),
    [
        ("always ego.position.y < 10", 7),
        ("eventually 2 < ego.position.y <= 4", 1),
        ("eventually ego.position.y == 2", math.inf),
        ("always ego.position.x != 3", 3),
        ("not always ego.position.y == 0", 3),
        ("always ego.position != (4, 0, 0)", 4),
        ("always ego.position in zone", 3),
        ("always ego in zone", 2.5),
        ("always ego.position in shelf", 3),
        ("always ego in shelf", 2.5),
        ("eventually wall.position not in shelf", 2),
        ("always wall.position not in zone implies ego in zone", 2.5),
        ("eventually wall.position not in zone", 2),
        ("always ego.position in room", 7),
        ("always ego in room", 6.5),
        ("always ego.position in row", math.inf),
        ("always wall in room", math.inf),
        ("always ego not in far", 12.5),  # by its corner that is farthest from there
        ("always not (ego intersects wall)", 5),
        ("always ego.name == 'ego'", math.inf),
    ],
)
def test_margins(condition: str, margin: float) -> None:
    assert robustness(condition, steps=3) == pytest.approx(margin, abs=1e-3)


def test_the_margin_of_the_first_state_decides_outside_of_temporal_operators() -> None:
    assert robustness("ego.position in zone", steps=3) == pytest.approx(3)
