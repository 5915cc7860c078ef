"""The example programs of the driving domain sample, and run in the built-in simulator."""

from pathlib import Path

import pytest

import scenic

FOLDER = Path(__file__).parents[2] / "examples" / "driving"
PROGRAMS = sorted(path.name for path in FOLDER.glob("*.scenic"))


@pytest.mark.parametrize("name", PROGRAMS)
def test_examples_sample_and_run(name: str) -> None:
    scenario = scenic.scenarioFromFile(FOLDER / name, mode2D=True)
    scene = scenario.sample(3, seed=1)[0]
    for index, thing in enumerate(scene.objects):
        for other in scene.objects[:index]:
            assert thing.position.distanceTo(other.position) > 1
    done = scenario.getSimulator().simulate(scene, maxSteps=20, maxIterations=5)
    assert done is not None
    assert done.currentTime > 0


def test_there_are_examples() -> None:
    assert len(PROGRAMS) >= 8
