"""The data of the page that plays simulations."""

import base64
import json
import re
from typing import Any

import numpy as np

import scenic
from scenic.formats.course_page import PoseTape, course_data, course_page
from scenic.simulators.kinematic import KinematicSimulator

PROGRAM = """
from scenic.simulators.kinematic import *
workspace = Workspace(RectangularRegion((0, 0, 0), 0, 40, 40))
zone = RectangularRegion((5, 5, 0), 0, 4, 4)
behavior Go():
    take SetVelocity((1, 0, 0))
    while True:
        wait
scenario Main():
    setup:
        ego = new Object at (-5, 0, 1), with width 2, with length 2, with height 2, with behavior Go, with color (1, 0, 0)
        require always ego.position.x < 8 as inside
        require eventually ego.position.x > -4 as away
    compose:
        wait for 3 seconds
        do Later()
scenario Later():
    setup:
        new Object at (0, 8, 1), facing 30 deg, with color (0, 0, 1)
    compose:
        wait for 100 seconds
"""


def simulated(steps: int = 80, text: str = PROGRAM) -> Any:
    scene = scenic.scenarioFromString(text).sample(1, seed=1)[0]
    done = KinematicSimulator().simulate(scene, maxSteps=steps, keep_poses=True, robustness=True, key=b"1")
    assert done is not None
    return done


def data_of(simulation: Any) -> dict[str, Any]:
    tape = PoseTape()
    for state in simulation.poses:
        tape.add(state)
    return course_data(simulation, tape)


def test_every_pose_is_on_the_page() -> None:
    done = simulated()
    (scene,) = data_of(done)["scenes"]
    course = scene["course"]
    poses = np.frombuffer(base64.b64decode(course["poses"]), dtype="<f4").reshape(81, 2, 7)
    assert (course["steps"], course["timestep"]) == (80, 0.1)
    for state, row in zip(done.poses, poses, strict=True):
        for (position, turn), values in zip(state, row, strict=False):
            np.testing.assert_allclose(values, [*position, *turn.q], rtol=1e-6, atol=1e-6)
        assert np.isnan(row[len(state) :]).all()
    assert [len(state) for state in done.poses] == [1] * 30 + [2] * 51
    assert [item["verdict"] for item in course["requirements"]] == ["presumably true", "true"]
    assert [thing["class"] for thing in scene["objects"]] == ["Object", "Object"]


def test_a_tape_without_objects_or_states() -> None:
    assert PoseTape().poses().shape == (0, 0, 7)
    tape = PoseTape()
    tape.add(())
    assert tape.poses().shape == (1, 0, 7)


def test_what_is_the_same_is_on_the_page_once() -> None:
    one = data_of(simulated(15))
    text = course_page("a <page>", [one, one, one])
    held = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    assert held is not None
    data = json.loads(held[1])
    assert len(data["scenes"]) == 3
    assert (len(data["meshes"]), len(data["outlines"])) == (len(one["meshes"]), len(one["outlines"]))
    assert data["scenes"][2] == json.loads(json.dumps(one["scenes"][0]))
    assert "a &lt;page&gt;" in text


OTHER = """
from scenic.simulators.kinematic import *
first = CircularRegion((0, 0, 0), 3)
zone = RectangularRegion((5, 5, 0), 0, 4, 4)
last = CircularRegion((9, 9, 0), 2)
ground = new Object at (0, 0, -3), with render False
ego = new Object at (1, 2, 3), with shape SpheroidShape(), with occupied (first, zone, last)
new Object at (4, 5, 6), with width 2, with length 2, with height 2
"""


def test_scenes_of_other_programs_keep_their_own_meshes_and_regions() -> None:
    alone = [data_of(simulated(15)), data_of(simulated(1, OTHER))]
    text = course_page("both", alone)
    held = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    assert held is not None
    data = json.loads(held[1])
    kept = json.loads(json.dumps(alone))
    for own, scene in zip(kept, data["scenes"], strict=True):
        (before,) = own["scenes"]
        for old, new in zip(before["objects"], scene["objects"], strict=True):
            assert own["meshes"][old["mesh"]] == data["meshes"][new["mesh"]]
        assert before["regions"].keys() == scene["regions"].keys()
        for name, number in before["regions"].items():
            assert own["outlines"][number] == data["outlines"][scene["regions"][name]]
        if before["workspace"] is not None:
            assert own["outlines"][before["workspace"]] == data["outlines"][scene["workspace"]]
    assert [scene["workspace"] is None for scene in data["scenes"]] == [False, True]


def test_what_is_not_drawn_takes_no_pose() -> None:
    (scene,) = data_of(simulated(1, OTHER))["scenes"]
    poses = np.frombuffer(base64.b64decode(scene["course"]["poses"]), dtype="<f4").reshape(2, 2, 7)
    assert [thing["position"] for thing in scene["objects"]] == [(1, 2, 3), (4, 5, 6)]
    np.testing.assert_allclose(poses[0, :, :3], [(1, 2, 3), (4, 5, 6)], atol=1e-6)
