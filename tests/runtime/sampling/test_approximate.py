"""Approximate scenes: the law, against rejection; probabilities that are known; what is told of them."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from scenic.language.errors import RejectionException
from scenic.runtime.sampling.approximate import _correlation as measured
from scenic.runtime.sampling.rejection_report import Approximation
from tests.amounts import amount
from tests.cli.commands import run_here
from tests.runtime.programs import FALSE_ALARM, fingerprint, scenario

SAME = "def same(*v): return v[0]\n"

MUGS = (
    "table = RectangularRegion((0, 0), 0, 1.4, 1)\nfor i in range({}):\n    new Object in table, with width 0.1, with length 0.1, "
    "with height 0.1, with shape CylinderShape()\n"
)

PROGRAMS = {
    "mugs": MUGS.format(6),
    "soft": f"{SAME}x, y = Range(0, 1), Range(0, 1)\nrequire[0.6] same(x, y) > 0.7\nrequire same(y, x) + same(x) > 0.9\nparam v = (x, y)\n",
    "pavings": f"{SAME}a, b, c = Range(-1, 1), Range(-1, 1), Uniform(1, 2, 3)\nrequire a * a + b * b > 1.3\nrequire same(a, b) * c > 0.4\nparam v = (a, b, c)\n",
    "relative": "ego = new Object at (Range(-2, 2), Range(-2, 2)), facing Range(0, 6)\nfor i in range(3):\n    new Object at (Range(-3, 3), Range(-3, 3)) relative to ego\n"
    "require ego.x > -1\n",
    "retries": "room = PolygonalRegion([(0, 0), (9, 0), (4, 1), (0, 9)])\nworkspace = Workspace(room)\nfor i in range(3):\n    new Object in room, with width 0.9\n",
}  # fmt: skip


def observed(scenes):
    return np.array(
        [
            [*scene.params.get("v", ()), *(part for item in scene.objects for part in (item.position.x, item.position.y))]
            for scene in scenes
        ],
        dtype=float,
    )  # fmt: skip


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_the_law_is_nearly_that_of_rejection(name: str) -> None:
    program = scenario(PROGRAMS[name])
    count = amount(300, 600)
    scenes = program.sample(count, seed=1, approximate=count)
    expected = observed(program.sample(count, seed=2))
    found = observed(scenes)
    mix = np.arange(1, found.shape[1] + 1)[:, np.newaxis] % 7 - 2.6
    for ours, theirs in zip((*found.T, *(found @ mix).T), (*expected.T, *(expected @ mix).T), strict=True):
        assert stats.ks_2samp(ours, theirs).pvalue > FALSE_ALARM
    told = scenes[0].approximation
    assert told is not None
    assert count / 3 < told.effective <= count
    exact = sum(math.log(part.acceptance) for part in program.estimates(seed=3, candidates=4000))
    if "soft" not in name:
        assert told.log_probability == pytest.approx(exact, abs=0.4)


def test_scenes_depend_on_seed_number_and_lanes_alone(tmp_path: Path) -> None:
    program = scenario(MUGS.format(4))
    scenes = program.sample(70, seed=3, approximate=32)
    expected = [fingerprint(scene) for scene in scenes]
    assert len(set(expected)) == 70
    again = scenario(MUGS.format(4)).stream(5, seed=3, first=62, approximate=32)
    assert [fingerprint(scene) for scene in again] == expected[62:67]
    scenes[40].save(tmp_path / "scene.json")
    assert fingerprint(program.replay(tmp_path / "scene.json")) == expected[40]


def test_probabilities_that_are_known() -> None:
    for bound in (0.9, 0.999):
        program = scenario(
            f"{SAME}x, y = Range(0, 1), Range(0, 1)\nrequire same(x) > {bound}\nrequire same(y) > {bound}\n"
        )
        (scene, *_) = program.sample(1, seed=0, approximate=200)
        assert scene.approximation.log_probability == pytest.approx(2 * math.log(1 - bound), abs=0.5)
    # Two discs on a square: the middle of one keeps a disc of twice the radius from that of the other.
    text = "for i in range(2):\n    new Object at (Range(-10, 10), Range(-10, 10)), with width 4, with length 4, with shape CylinderShape()\n"
    (scene, *_) = scenario(text).sample(1, seed=0, approximate=2000)
    # The mean share of a disc of radius 4 about a point of a square of side 20 that lies in it.
    r = 4 / 20
    covered = math.pi * r**2 - 8 / 3 * r**3 + r**4 / 2
    assert math.exp(scene.approximation.log_probability) == pytest.approx(1 - covered, abs=0.03)


def test_what_rejection_does_not_find_and_what_nobody_does() -> None:
    scenes = scenario(MUGS.format(14)).sample(8, seed=0, approximate=32)
    told = scenes[0].approximation
    assert told.log_probability < -1
    assert len(told.survival) >= 14
    assert len({fingerprint(scene) for scene in scenes}) == 8
    never = scenario(f"{SAME}x = Range(0, 1)\nrequire same(x) > 2 as never\n")
    with pytest.raises(RejectionException, match="never rejected every candidate"):
        never.sample(2, seed=0, approximate=8, max_attempts=20)
    program = scenario(f"{SAME}x = Range(0, 1)\nrequire 1 / (same(x) < 0.9)\n")
    with pytest.raises(ZeroDivisionError):
        program.sample(100, seed=0, approximate=100)
    for wrong in ({"approximate": 1}, {"approximate": 8, "lanes": 3}, {"approximate": 8, "processes": 2}):
        with pytest.raises(ValueError, match="approximate scenes"):
            program.sample(2, seed=0, **wrong)


def test_the_method_is_told(tmp_path: Path) -> None:
    path = tmp_path / "mugs.scenic"
    path.write_text(MUGS.format(6))
    done = run_here(["sample", path, "-n", 3, "--seed", 1, "--approximate", 16])
    assert done.returncode == 0, done.stderr
    assert "approximate: 16 scenes made together, effective sample size" in done.stderr
    head, *rows = map(json.loads, done.stdout.splitlines())
    assert len(rows) + 1 >= 3
    assert head.get("points") == "approximate 16"
    folder = tmp_path / "set"
    done = run_here(
        ["sample", path, "-n", 20, "--seed", 1, "--approximate", 16, "-o", f"{folder}/", "--format", "jsonl"]
    )
    assert done.returncode == 0, done.stderr
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["points"] == "approximate 16"
    assert manifest["approximation"].startswith("approximate: 16 scenes made together")
    assert run_here(["dataset", "verify", folder]).returncode == 0
    assert run_here(["sample", path, "--approximate", 16, "-j", 2]).returncode == 2


def test_chance_is_not_taken_for_dependence_and_dependence_is_seen() -> None:
    random = np.random.default_rng(0)
    for lanes in (32, 128, 512):
        chance = random.normal(0, lanes**-0.5, 200)
        assert measured(chance.tolist(), lanes) < 0.1
        assert measured([*chance, 1.0], lanes) > 0.6, "one block stays"
        assert measured((chance + 0.3).tolist(), lanes) > 0.2, "all blocks move too little"
    assert measured([], 16) == 0
    good = Approximation(16, -3.0, 15.0, (1.0,), 4, 0.05)
    assert "warning" not in str(good)
    assert "still depend on how they were begun" in str(replace(good, correlation=0.4))
