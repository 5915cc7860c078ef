"""Scenes by the established calls: batches, streams, seeds, and scenes in pickles."""

import itertools
import pickle
import random

import numpy as np
import pytest

import scenic
from scenic.language.errors import RejectionException

SCENARIO = scenic.scenarioFromString("ego = new Object at (Range(0, 1), 0)\nrequire ego.position.x > 0.3")


def places(scenes: object) -> list[float]:
    return [scene.egoObject.position.x for scene in scenes]  # type: ignore[attr-defined]


def test_a_stream_gives_the_scenes_of_its_seed_in_order() -> None:
    found = []
    for options in ({}, {"bufferSize": 3}, {"numWorkers": 2, "bufferSize": 4}):
        scenic.setSeed(5)
        found.append(places(itertools.islice(SCENARIO.generateStream(**options), 9)))  # type: ignore[arg-type]
    assert found[0] == found[1] == found[2]
    assert len(set(found[0])) == 9
    scenic.setSeed(5)
    pairs = list(SCENARIO.generateStream(9, serialized=True, iterationCount=True))
    assert places(SCENARIO.sceneFromBytes(data) for data, _ in pairs) == found[0]
    assert all(count >= 1 for _, count in pairs)


def test_a_batch_may_be_made_by_several_processes() -> None:
    found = []
    for workers in (0, 2):
        scenic.setSeed(5)
        scenes, tried = SCENARIO.generateBatch(5, numWorkers=workers)
        found.append((places(scenes), tried))
    assert found[0] == found[1]
    data, _ = SCENARIO.generateBatch(2, serialized=True)
    assert all(isinstance(item, bytes) for item in data)
    for call in (SCENARIO.generateBatch, SCENARIO.generateStream):
        with pytest.raises(ValueError, match="several processes"):
            call(3, maxIterations=5, numWorkers=2)
    with pytest.raises(RejectionException):
        list(
            scenic.scenarioFromString(
                "ego = new Object at (Range(0, 1), 0)\nrequire ego.x > 2"
            ).generateStream(1, maxIterations=3)
        )


def test_a_seed_decides_both_generators() -> None:
    drawn = []
    for _ in range(2):
        scenic.setSeed(3)
        drawn.append((random.random(), np.random.random(), SCENARIO.generate()[0].egoObject.position.x))  # noqa: NPY002
    assert drawn[0] == drawn[1]


def test_a_scene_is_pickled_with_its_scenario() -> None:
    scene, _ = SCENARIO.generate()
    assert scene.scenario is SCENARIO
    again = pickle.loads(pickle.dumps(scene))
    assert places([again]) == places([scene])
    assert (
        again.scenario.sceneFromBytes(SCENARIO.sceneToBytes(scene)).egoObject.position
        == scene.egoObject.position
    )
