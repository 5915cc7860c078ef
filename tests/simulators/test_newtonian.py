"""Cars of the built-in traffic simulator."""

import math
import os
import random
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.simulators.newtonian import NewtonianSimulation, NewtonianSimulator
from tests.maps import RoadText, line, map_text, two_way

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


class Asking(NewtonianSimulation):
    """Gives its properties when asked for them, as any other simulator, where the built-in one writes them at once."""

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        return super().getProperties(obj, properties)


MOVING = """
model scenic.simulators.newtonian.driving_model
behavior Weave():
    while True:
        take SetThrottleAction(Range(0, 1)), SetSteerAction(Range(-1, 1)), SetReverseAction(Uniform(True, False))
        take SetBrakeAction(Range(0, 1)), SetHandBrakeAction(Uniform(True, False))
        if Range(0, 1) < 0.1:
            self.parentOrientation = Orientation.fromEuler(Range(-3, 3), 0, 0)
        if Range(0, 1) < 0.1:
            take SetPositionAction(self.position + Vector(1, 2, 0)), SetSpeedAction(3)
ego = new Car on road, with behavior Weave, with speed Range(0, 9)
new Car on road, facing Range(-180, 180) deg, with speed Range(0, 9), with regionContainedIn None, with requireVisible False
new Car at (3, 200), with parentOrientation (Range(-180, 180) deg, TILT, 0), with behavior Weave, with regionContainedIn None, with requireVisible False
new Pedestrian at (9, 200), with behavior WalkForwardBehavior, with regionContainedIn None, with requireVisible False
new Debris at (12, 200), with regionContainedIn None, with requireVisible False
record [(o.position, o.velocity, o.angularVelocity, o.orientation.q, o.heading, o.yaw, o.pitch, o.roll, o.speed, o.angularSpeed, getattr(o, 'elevation', 0)) for o in simulation().objects] as all
"""


CROSSING = (Path(__file__).parents[2] / "examples" / "driving" / "crossing.xodr").read_text()
PROFILES = (
    '<elevationProfile><elevation s="0" a="2" b="0.02" c="0.0004" d="0"/></elevationProfile>'
    '<lateralProfile><superelevation s="0" a="0.02" b="0.001" c="0" d="0"/></lateralProfile>'
)
HILL = map_text([RoadText("1", 400.0, line(0, 0, 0.7, 400.0), two_way(False, False), rest=PROFILES)])


@pytest.mark.parametrize(
    ("road_map", "tilt", "mode_2d"), [(CROSSING, 0, True), (CROSSING, 0.1, False), (HILL, 0.1, False)]
)
def test_properties_written_at_once_are_those_of_a_simulator_that_is_asked(
    tmp_path: Path, road_map: str, tilt: float, mode_2d: bool
) -> None:
    (tmp_path / "map.xodr").write_text(road_map)
    text = f"param map = {str(tmp_path / 'map.xodr')!r}{MOVING.replace('TILT', str(tilt))}"
    for scene in scenic.scenarioFromString(text, mode2D=mode_2d).sample(2, seed=2):
        courses = []
        for kind in (NewtonianSimulation, Asking):
            random.seed(5)
            done = kind(scene, maxSteps=60, name="weaving", timestep=0.1)
            assert done.result is not None
            courses.append(repr(done.result.records["all"]))
        assert courses[0] == courses[1]
