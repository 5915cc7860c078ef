"""What long simulations keep in memory: nothing that grows with their steps."""

import gc
import stat
import sys
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.formats.trajectories import LinesFile, step_document
from scenic.language.errors import ScenicValueError
from scenic.simulators.dummy import DummySimulation, DummySimulator
from tests.cli.commands import run_here

AGENTS = """
behavior Once():
    take Range(0, 1)
behavior B():
    while True:
        do Once()
        try:
            take 1
            wait
        interrupt when simulation().currentTime % 5 == 0:
            take 2
"""
REQUIREMENTS = """
require always ego.position.y < 1e9
require always (ego.position.x > 3 implies eventually ego.position.x < 3)
require eventually ego.position.y > 2
record ego.position to "place.npz"
record ego.position.y to "y.jsonl"
"""
LONG = AGENTS + "ego = new Object with behavior B\nnew Object at (5, 0), with behavior B\n" + REQUIREMENTS
SCENARIOS = (
    AGENTS
    + """
scenario Main():
    setup:
        ego = new Object with behavior B
    compose:
        while True:
            do Short()
scenario Short():
    setup:
        width = Range(1, 2)
        require always ego.position.y < 1e9
        record ego.position.y as y
    compose:
        wait
        override ego with width width
        wait
"""
)


WARM = 800
"""Steps until Python's own reserves are filled."""
STRETCH = 50
"""Steps between two counts."""


def grown(text: str, folder: Path) -> float:
    """Blocks of memory that are taken in each step of a simulation that is kept in a file.

    What is kept of the steps grows in each stretch of them; what the process does besides, now and then, in one.
    """
    gc.freeze()  # What other tests have left is not searched for garbage.
    scenario = scenic.scenarioFromString(text, params={"recordFolder": str(folder)})
    (scene,) = scenario.sample(1, seed=1)
    with closing(LinesFile(folder / "run.jsonl")) as file:
        simulation = DummySimulation(
            scene,
            drift=0.01,
            maxSteps=5000,
            name="long",
            timestep=None,
            keep_course=False,
            enableReplay=False,
            robustness=True,
            on_state=lambda *state: file.add(step_document(*state)),
            deferred=True,
        )
        simulation.begin()
        counts = []
        for step in range(WARM + 3 * STRETCH + 1):
            assert simulation.advanceOnce()
            if step >= WARM and step % STRETCH == 0:
                gc.collect()
                counts.append(sys.getallocatedblocks())
        simulation.cancel()
    return min(after - before for before, after in pairwise(counts)) / STRETCH


def test_memory_does_not_grow_with_steps(tmp_path: Path) -> None:
    assert grown(LONG, tmp_path) < 0.5
    assert list(tmp_path.iterdir()) == []


def test_of_scenarios_that_have_run_little_is_kept(tmp_path: Path) -> None:
    assert grown(SCENARIOS.replace("        record ego.position.y as y\n", ""), tmp_path) < 4


def test_only_the_newest_state_is_kept() -> None:
    text = "behavior B():\n    while True:\n        take simulation().currentTime\nego = new Object with behavior B"
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=1)
    done = DummySimulator(drift=1).simulate(scene, maxSteps=3, keep_course=False)
    assert done is not None
    assert done.result is not None
    assert [tuple(place) for place in done.result.finalState] == [(0, 3, 0)]
    assert done.result.actions == ({scene.egoObject: (2,)},)
    assert len(done.trajectory) == 4
    assert done.trajectory[3] == done.trajectory[-1] == done.result.finalState
    for wrong in (lambda: done.trajectory[0], lambda: list(done.trajectory)):
        with pytest.raises(LookupError, match="only the newest is kept"):
            wrong()


def test_the_command_keeps_what_a_program_looks_back_at(tmp_path: Path) -> None:
    (tmp_path / "course.py").write_text(
        "def states(simulation):\n    return len(list(simulation.trajectory))\n"
    )
    (tmp_path / "back.scenic").write_text(
        "from course import states\nego = new Object\nrecord states(simulation()) as states\n"
        "record ego.position.x to 'x-{simulation}.npz'\nrecord ego.position.x to 'x-{simulation}-{step}.json'\n"
    )
    options = ["--seed", "1", "--simulator", "dummy", "--time", "3", "-o", "out"]
    done = run_here(["simulate", "back.scenic", *options], folder=tmp_path)
    assert done.returncode == 0, done.stderr
    (path,) = (tmp_path / "out").glob("*.jsonl")
    records = scenic.read_trajectory(path).about["records"]
    assert [value for _, value in records["states"]] == [0, 1, 2, 3]
    # The numbers are there where the program itself looks back.
    assert records["record4"] == [[step, 0.0] for step in range(4)]
    text = (tmp_path / "back.scenic").read_text().replace("states(simulation())", "1")
    (tmp_path / "back.scenic").write_text(text)
    done = run_here(["simulate", "back.scenic", *options[:-1], "other"], folder=tmp_path)
    assert done.returncode == 0, done.stderr
    (path,) = (tmp_path / "other").glob("*.jsonl")
    read = scenic.read_trajectory(path)
    assert read.about["records"]["record4"] == {"$file": "x-0.npz"}
    assert read.about["records"]["record5"] == {"$file": "x-{simulation}-{step}.json"}
    assert sorted(item.name for item in tmp_path.glob("x*")) == [
        "x-0-0.json",
        "x-0-1.json",
        "x-0-2.json",
        "x-0-3.json",
        "x-0.npz",
    ]
    # They have the permissions of other new files.
    assert {stat.S_IMODE(item.stat().st_mode) for item in tmp_path.glob("x*")} == {
        stat.S_IMODE(path.stat().st_mode)
    }


def test_a_program_whose_text_looks_back_is_run_once(tmp_path: Path) -> None:
    (tmp_path / "note.py").write_text(
        "from pathlib import Path\n"
        "def note():\n"
        "    with Path('runs').open('a') as file:\n"
        "        file.write('x')\n"
    )
    options = ["--seed", "1", "--simulator", "dummy", "--time", "3"]
    runs = 0
    for look, more in (("simulation().trajectory", 1), ("getattr(simulation(), 'tra' + 'jectory')", 2)):
        (tmp_path / "back.scenic").write_text(
            "from note import note\nego = new Object\nrecord initial note()\n"
            f"record final len(list({look})) as states\n"
        )
        output = f"out{more}"  # another program needs another folder
        done = run_here(["simulate", "back.scenic", *options, "-o", output], folder=tmp_path)
        assert done.returncode == 0, done.stderr
        (path,) = (tmp_path / output).glob("*.jsonl")
        assert scenic.read_trajectory(path).about["records"]["states"] == 4
        runs += more
        assert (tmp_path / "runs").read_text() == "x" * runs


# Series of arrays


def archive(tmp_path: Path, expression: str, *, steps: int = 3) -> Any:
    text = f"ego = new Object\ntime = lambda: simulation().currentTime\nrecord {expression} to 'series.npz'\n"
    scenario = scenic.scenarioFromString(text, params={"recordFolder": str(tmp_path)})
    (scene,) = scenario.sample(1, seed=1)
    assert DummySimulator().simulate(scene, maxSteps=steps, timestep=0.5) is not None
    return np.load(tmp_path / "series.npz")


@pytest.mark.parametrize(
    ("expression", "wanted"),
    [
        ("time()", np.arange(4)),
        ("time() < 2", np.array([True, True, False, False])),
        ("(True, 2, 2.5, 3)[time()]", np.array([True, 2, 2.5, 3])),
        ("[[1, time()], [2.5, 0]]", np.array([[[1, step], [2.5, 0]] for step in range(4)])),
        ("('a', 'bcd', 'e', 'fg')[time()]", np.array(["a", "bcd", "e", "fg"])),
        ("[]", np.empty((4, 0))),
    ],
)
def test_arrays_of_any_numbers(tmp_path: Path, expression: str, wanted: np.ndarray) -> None:
    found = archive(tmp_path, expression)
    np.testing.assert_array_equal(found["values"], wanted)
    assert found["values"].dtype == wanted.dtype
    np.testing.assert_array_equal(found["steps"], range(4))
    np.testing.assert_array_equal(found["times"], [0, 0.5, 1, 1.5])


def test_values_of_several_shapes_are_no_array(tmp_path: Path) -> None:
    with pytest.raises(ScenicValueError, match=r"not one of \(1,\) after \(0,\)"):
        archive(tmp_path, "[0] * time()")
    assert list(tmp_path.iterdir()) == []
