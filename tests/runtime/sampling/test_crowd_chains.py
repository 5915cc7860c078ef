"""Approximate scenes of crowds: the law, against rejection; independence of scenes; crowds that do not fit."""

import math
from pathlib import Path

import numpy as np
import pytest

from scenic.language.errors import RejectionException
from scenic.runtime.sampling import crowd_chains
from tests.amounts import amount
from tests.runtime.programs import fingerprint, scenario
from tests.runtime.sampling.test_apart import PROGRAMS, check_law, drawn_apart, observed

CROWD = "yard = RectangularRegion((0, 0), 0, {0}, {0})\nfor i in range({1}):\n    new Object in yard, facing Range(0, 360) deg\n"


@pytest.mark.parametrize("name", ["alike", "pairs", "beside a wall", "softly", "of several areas"])
def test_the_law_is_nearly_that_of_rejection(name: str) -> None:
    program = scenario(PROGRAMS[name])
    assert crowd_chains.is_loose(drawn_apart(program))
    count = amount(300, 3000)
    scenes = program.sample(count, seed=1, approximate=count)
    found = observed(scenes)
    program._sampler._finder = program._sampler.engine
    whole = observed(program.sample(count, seed=2))
    check_law(found, whole)
    report = scenes[0].approximation
    assert report is not None
    assert report.is_mixed
    assert report.effective == count
    if name != "softly":
        (whole_scene,) = program.estimates(seed=3, candidates=10_000)
        error = 0.1 + 4 / math.sqrt(whole_scene.accepted)
        assert report.log_probability == pytest.approx(math.log(whole_scene.acceptance), abs=error)


def test_scenes_depend_on_seed_and_number_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = scenario(CROWD.format(20, 70))
    scenes = program.sample(12, seed=5, approximate=12)
    expected = [fingerprint(scene) for scene in scenes]
    assert len(set(expected)) == 12
    assert [fingerprint(scene) for scene in program.sample(12, seed=5, approximate=5)] == expected
    (one,) = scenario(CROWD.format(20, 70)).stream(1, seed=5, first=7, approximate=2)
    assert fingerprint(one) == expected[7]
    monkeypatch.setattr(crowd_chains, "_MOST_KEPT", 200)
    assert [fingerprint(scene) for scene in program.sample(12, seed=5, approximate=12)] == expected
    attempts = np.array([scene.component_attempts for scene in scenes])
    assert [fingerprint(scene) for scene in program.found(5, np.arange(12), attempts)] == expected
    scenes[3].save(tmp_path / "scene.json")
    assert fingerprint(program.replay(tmp_path / "scene.json")) == expected[3]


def test_crowds_that_rejection_does_not_find() -> None:
    program = scenario(CROWD.format(40, 150))
    (scene, other) = program.sample(2, seed=1, approximate=2)
    assert scene.approximation is not None
    assert scene.approximation.log_probability < math.log(1e-9)
    assert fingerprint(scene) != fingerprint(other)
    batch = scene.found.batch
    (check,) = program._sampler.engine.plan.checks
    assert check.test(batch).holds.all()


def test_crowds_that_do_not_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    program = scenario(CROWD.format(14, 70))
    monkeypatch.setattr(crowd_chains, "_DENSEST", math.inf)
    monkeypatch.setattr(crowd_chains, "_ROUNDS", 2)
    with pytest.raises(RejectionException, match="no scene was found within"):
        program.sample(2, seed=1, approximate=2)
    monkeypatch.setattr(crowd_chains, "_ROUNDS", 400)
    with pytest.raises(RejectionException, match="within 3 candidates"):
        program.sample(2, seed=1, approximate=2, max_attempts=3)
