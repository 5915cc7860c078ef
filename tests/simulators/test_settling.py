"""Scenes in which things stay where they are put."""

from pathlib import Path

import pytest

import scenic
from scenic.batch.engines import Processes
from scenic.batch.scenes import Job, in_processes
from scenic.language.errors import ScenicValueError

pytest.importorskip("mujoco")

from scenic.simulators.mujoco.settling import Settling

PROGRAM = """
model scenic.simulators.mujoco.model
table = new Fixture at (0, 0, 0.35), with width 1, with length 1, with height 0.7
tips = Uniform(0, 90) deg
cone = new Body on table, with shape ConeShape((0.1, 0.1, 0.15)), facing (0, tips, 0)
ego = new Body at (0, 0, Uniform(0.755, 2)), with width 0.1, with length 0.1, with height 0.1
"""


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "stays.scenic"
    path.write_text(PROGRAM)
    return path


def test_scenes_in_which_something_moves_are_rejected(program: Path) -> None:
    scenario = scenic.load(program, settle=0.5)
    for scene in scenario.sample(6, seed=1):
        cone = next(thing for thing in scene.objects if thing is not scene.egoObject and thing.width == 0.1)
        assert abs(cone.pitch) < 1
        assert scene.egoObject.position.z == 0.755
    tally = scenario.program.settling.tally
    assert tally.stable >= 6
    assert tally.scenes - tally.stable > 3
    assert tally.objects == 2 * tally.scenes
    assert tally.fell
    assert tally.tipped
    assert tally.fell + tally.tipped + tally.slid >= tally.scenes - tally.stable


def test_candidates_that_other_requirements_reject_are_not_simulated(program: Path) -> None:
    program.write_text(f"{PROGRAM}require tips == 0\nrequire ego.z < 1\n")
    scenario = scenic.load(program, settle=0.1)
    assert len(scenario.sample(4, seed=2)) == 4
    tally = scenario.program.settling.tally
    assert tally.scenes == tally.stable >= 4


def test_scenes_do_not_depend_on_processes(program: Path) -> None:
    scenario = scenic.load(program, settle=0.2)
    alone = [scene.egoObject.position for scene in scenario.sample(4, seed=3)]
    beside = [scene.egoObject.position for scene in scenario.sample(4, seed=3, processes=2)]
    assert alone == beside


def test_settled_poses_are_kept(program: Path) -> None:
    scenario = scenic.load(program, settle=1, settle_keep=True)
    scenes = scenario.sample(5, seed=1)
    again = Settling(1.0)
    for scene in scenes:
        assert again.stays(scene.objects)
        assert scene.egoObject.position.z == pytest.approx(0.75, abs=2e-3)
        corners = scene.egoObject.corners  # derived values follow
        assert min(corner.z for corner in corners) == pytest.approx(0.7, abs=2e-3)
    saved = scenario.sceneToBytes(scenes[0])
    assert scenario.sceneFromBytes(saved).egoObject.position == scenes[0].egoObject.position
    assert scenario.program.settling.tally.fell >= 1


def test_processes_count_together(program: Path) -> None:
    scenario = scenic.load(program, settle=0.2)
    tally = scenario.program.settling.tally
    list(in_processes(scenario, lambda _, scenes: b"", Job(3, 0, 8, None, None), Processes(2)))
    assert tally.stable >= 8
    assert tally.objects == 2 * tally.scenes


def test_absent_objects_are_not_simulated() -> None:
    program = """
model scenic.simulators.mujoco.model
new Body at (0, 0, 5), with present False
ego = new Fixture at (0, 0, 0.5)
"""
    assert scenic.scenarioFromString(program).sample(1, seed=1, settle=0.5)


def test_times_and_distances_are_positive() -> None:
    with pytest.raises(ScenicValueError, match="seconds of settling must be a positive number, not 0"):
        Settling(0)
