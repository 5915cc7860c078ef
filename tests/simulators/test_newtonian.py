"""Cars of the built-in traffic simulator."""

import math
import os
from pathlib import Path

import pytest

import scenic
from scenic.simulators.newtonian import NewtonianSimulator

MAPS = Path(os.environ.get("SCENIC_TEST_MAPS", "maps"))
PROGRAM = """
param map = localPath({map!r})
model scenic.simulators.newtonian.driving_model
behavior Drive():
    take SetThrottleAction(0.25), SetSteerAction(-0.5), SetReverseAction(True)
    take SetThrottleAction(0), SetBrakeAction(0.75), SetHandBrakeAction(True)
ego = new Car with behavior Drive
record (ego.throttle, ego.steer, ego.brake, ego.hand_brake, ego.reverse) as controls
"""


@pytest.mark.skipif(not (MAPS / "Town01.xodr").exists(), reason="needs the road maps")
def test_cars_tell_their_present_controls() -> None:
    text = PROGRAM.format(map=str(MAPS / "Town01.xodr"))
    (scene,) = scenic.scenarioFromString(text, mode2D=True).sample(1, seed=1)
    assert scene.egoObject.throttle == 0
    done = NewtonianSimulator().simulate(scene, maxSteps=2)
    assert done is not None
    assert done.result is not None
    assert [controls for _, controls in done.result.records["controls"]] == [
        (0.0, 0.0, 0.0, False, False),
        (0.25, -0.5, 0.0, False, True),
        (0.0, -0.5, 0.75, True, True),
    ]


@pytest.mark.skipif(not (MAPS / "Town01.xodr").exists(), reason="needs the road maps")
def test_the_driving_model_brings_names_of_python() -> None:
    text = (
        f"param map = localPath({str(MAPS / 'Town01.xodr')!r})\nmodel scenic.domains.driving.model\n"
        "ego = new Car\nparam half = math.pi / 2, kinds = (issubclass(SetBrakeAction, Action), Sensor, Optional[int])\n"
    )
    (scene,) = scenic.scenarioFromString(text, mode2D=True).sample(1, seed=1)
    assert scene.params["half"] == math.pi / 2
    assert scene.params["kinds"][0]
