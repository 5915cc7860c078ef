"""Cameras while a simulation runs: at each step they give what a scene would that begins as the objects are then."""

from typing import Any

import numpy as np
import pytest

import scenic
from scenic.formats.labels import observe
from scenic.formats.scene_cameras import sensor_viewpoint
from scenic.simulators.cameras import Cameras
from scenic.simulators.kinematic import KinematicSimulation, KinematicSimulator
from scenic.simulators.simulation import Simulation

HEAD = """
from scenic import DepthSensor, RGBSensor, SSSensor
from scenic.simulators.kinematic import *
class Chair:
    color: (0.2, 0.8, 0.3)
class Table:
    shape: ConeShape()
class Ball:
    shape: SpheroidShape()
front = {
    'rgb': RGBSensor(width=20, height=14),
    'parts': SSSensor(width=24, height=18, offset=(0.1, 0.6, 0.4), rotation=(10 deg, -5 deg, 20 deg)),
}
back = {'depth': DepthSensor(width=24, height=18, rotation=(180 deg, 0, 0)), 'parts': SSSensor(width=18, height=24, rotation=(170 deg, 0, 0))}
"""
COURSE = """
behavior Turning():
    take SetWheelSpeeds(1, 2)
    while True:
        wait
class Driven(Table):
    dynamics: 'differential'
    behavior: Turning
scenario Main():
    setup:
        ego = new Driven at (0, 0, 0), facing 20 deg, with sensors front
        other = new Driven at (0, 6, 0), facing (30 deg, 10 deg, 5 deg), with sensors back
        new Chair at (-2, 5, 0), with velocity (1, 0, 0.5)
        record {name: {key: it.observations[key] for key in it.sensors} for name, it in (('ego', ego), ('other', other))} as images
        record [(type(it).__name__, tuple(it.position), it.yaw, it.pitch, it.roll, it.width) for it in simulation().objects] as states
    compose:
        wait
        do Wider(other)
        wait
scenario Wider(thing):
    setup:
        override thing with width 3
        new Ball at (1, 3, 0.5)
    compose:
        wait
"""


def test_cameras_see_what_a_scene_would_show_that_begins_there() -> None:
    """Wherever their owners have moved and turned to, whatever has grown or entered since.

    Classes keep their numbers when one enters whose name comes before theirs.
    """
    (scene,) = scenic.scenarioFromString(HEAD + COURSE).sample(1, seed=0)
    done = KinematicSimulator().simulate(scene, maxSteps=9, timestep=0.5)
    assert done is not None
    steps = list(zip(done.records["images"], done.records["states"], strict=True))
    assert len(steps) == 4
    numbers: dict[str, int] = {}
    for (_, images), (_, states) in steps[:3]:
        text = HEAD
        sensors = ["front", "back", "{}", "{}"]
        for (kind, place, yaw, pitch, roll, width), carried in zip(states, sensors, strict=False):
            kind = "Table" if kind == "Driven" else kind
            text += f"new {kind} at {place}, facing ({yaw}, {pitch}, {roll}), with width {width}, with sensors {carried}, with allowCollisions True\n"
        (still,) = scenic.scenarioFromString(text).sample(1, seed=0)
        for name, owner in zip(("ego", "other"), still.objects, strict=False):
            for key, sensor in owner.sensors.items():
                seen = observe(still, sensor_viewpoint(key, owner, sensor), labelled=False)
                found: Any = images[name][key]
                if sensor.outputs == ("rgb",):
                    np.testing.assert_allclose(found, seen.rgb, atol=1)
                elif sensor.outputs == ("depth",):
                    np.testing.assert_allclose(found, seen.depth, rtol=1e-5)
                else:
                    np.testing.assert_array_equal(found["instance"], seen.objects + 1)
                    for number in np.unique(seen.objects):
                        (label,) = set(found["semantic"][seen.objects == number].tolist())
                        kind = "nothing" if number < 0 else states[number][0]
                        assert numbers.setdefault(kind, label) == label
    assert numbers["nothing"] == 0
    assert sorted(numbers.values()) == list(range(len(numbers)))
    assert set(numbers) == {"nothing", "Driven", "Chair", "Ball"}


def test_a_simulator_may_see_itself_for_some_cameras() -> None:
    """Those that it leaves out get nothing, also where others have the same output among several."""

    class Painting(KinematicSimulation):
        def sense(self) -> None:
            self._cameras.deliver(self, leave={("rgb",), ("semantic",)})
            Simulation.sense(self)

    class Painter(KinematicSimulator):
        def createSimulation(self, scene: Any, **options: Any) -> KinematicSimulation:
            return Painting(scene, **options)

    text = f"{HEAD}ego = new Chair with sensors {{**front, **back}}\nrecord {{**ego.observations}} as seen\n"
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=0)
    done = Painter().simulate(scene, maxSteps=0)
    assert done is not None
    ((_, seen),) = done.records["seen"]
    assert {name for name, image in seen.items() if image is not None} == {"depth", "parts"}


ONCE = """
monitor Once():
    wait
    assert ego.observations['rgb'] is not None
    while True:
        wait
"""


@pytest.mark.parametrize(
    ("lines", "images"),
    [
        ("", 1),
        ("record int(ego.observations['rgb'].sum()) as seen\n", 6),
        ("record final int(ego.observations['rgb'].sum()) as seen\n", 1),
        (f"{ONCE}require monitor Once()\n", 2),
        ("require always ego.sensors['rgb'].getObservation() is ego.sensors['rgb'].getObservation()\n", 6),
    ],
)
def test_cameras_see_what_is_read_and_the_end(
    lines: str, images: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[float] = []
    image = Cameras._image
    monkeypatch.setattr(
        Cameras, "_image", lambda self, *given: made.append(given[1].x) or image(self, *given)
    )
    text = f"{HEAD}ego = new Chair at (0, 0), with velocity (1, 0, 0), with sensors {{'rgb': RGBSensor(width=8, height=6)}}\n"
    (scene,) = scenic.scenarioFromString(text + lines).sample(1, seed=0)
    done = KinematicSimulator().simulate(scene, maxSteps=5, timestep=1.0)
    assert done is not None
    assert len(made) == images
    assert made == sorted(made)
    assert made[-1] == 5


def test_a_compose_block_reads_what_was_observed_in_the_last_step() -> None:
    text = f"""{HEAD}
scenario Main():
    setup:
        ego = new Chair at (0, 0), with velocity (1, 0, 0), with sensors {{'rgb': RGBSensor(width=8, height=6)}}
        new Ball at (3, 3, 0)
        record int(ego.observations['rgb'].sum()) as seen
        record last[0] as before
    compose:
        while True:
            last[0] = int(ego.observations['rgb'].sum()) if ego.observations else None
            wait
last = [None]
"""
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=0)
    done = KinematicSimulator().simulate(scene, maxSteps=3, timestep=1.0)
    assert done is not None
    seen, before = ([value for _, value in done.records[name]] for name in ("seen", "before"))
    assert before == [None, *seen[:-1]]
    assert len(set(seen)) == 4
