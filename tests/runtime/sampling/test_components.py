"""Scenes put together from independent components: the same law, the same invariants, and what falls apart."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

from scenic.graph.points import Sobol
from scenic.language.errors import RejectionException
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from tests.amounts import amount
from tests.runtime.programs import FALSE_ALARM, fingerprint, scenario

LOT = "for j in range(3):\n    new Object at ({} + Range(-3, 3), Range(-3, 3)), with width 2, with length 2, facing Range(0, 7)\n"

OPAQUE = "def same(*v): return v[0]\n"

PROGRAMS = {
    "lots": LOT.format(0) + LOT.format(100) + LOT.format(200),
    "values": OPAQUE + "x, y, z = Range(0, 1), Range(0, 1), Range(0, 1)\nrequire same(x, z) > z\nrequire same(y) > 0.8\n"
    "param v = (x, y, z)\n",
    "soft": OPAQUE + "x, y = Range(0, 1), Range(0, 1)\nrequire[0.7] same(x) > 0.8\nrequire[0.3] same(y) > 0.5\n"
    "require[0.5] same(y) > 0.2\nparam v = (x, y)\n",
    "pavings": OPAQUE + "a, b, c, d = Range(-1, 1), Range(-1, 1), Range(-1, 1), Range(-1, 1)\nrequire a * a + b * b > 1.3\n"
    "require c * c + d * d > 1.5\nrequire same(c) > 0\nparam v = (a, b, c, d)\n",
    "retries": "ego = new Object in PolygonalRegion([(0, 0), (9, 0), (4, 1), (0, 9)])\n"
    "new Object in PolygonalRegion([(90, 0), (99, 0), (94, 1), (90, 9)]), with regionContainedIn CircularRegion((90, 0), 3)\n"
    "require ego.x + ego.y < 5\n",
}  # fmt: skip


def components(program: Scenario) -> int:
    return len(program._sampler.engines)


def observed(scenes: Any) -> np.ndarray[Any, Any]:
    """The numbers that scenes show: parameters, and the places of objects."""
    rows = [
        [*scene.params.get("v", ()), *(part for item in scene.objects for part in (item.position.x, item.position.y))]
        for scene in scenes
    ]  # fmt: skip
    return np.array(rows)


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_the_law_is_that_of_whole_scenes(name: str) -> None:
    program = scenario(PROGRAMS[name])
    assert components(program) > 1
    found = observed(program.sample(400, seed=1))
    program._sampler._finder = Engine(program.outline.plan(program.domain))
    expected = observed(program.sample(400, seed=2))
    # A mixture of the columns tells whether their dependence is the same, too.
    mix = np.arange(1, found.shape[1] + 1)[:, np.newaxis] % 7 - 2.6
    for ours, theirs in zip((*found.T, *(found @ mix).T), (*expected.T, *(expected @ mix).T), strict=True):
        assert stats.ks_2samp(ours, theirs).pvalue > FALSE_ALARM


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_scenes_depend_on_seed_and_number_alone(name: str, tmp_path: Path) -> None:
    program = scenario(PROGRAMS[name])
    count = amount(20, 40)
    scenes = program.sample(count, seed=5)
    expected = [fingerprint(scene) for scene in scenes]
    for lanes in (1, 7, 512):
        assert [
            fingerprint(scene) for scene in scenario(PROGRAMS[name]).sample(count, seed=5, lanes=lanes)
        ] == expected
    assert [fingerprint(*program.stream(1, first=k, seed=5)) for k in range(12)] == expected[:12]
    # What is kept of them says all.
    numbers = np.arange(count)
    attempts = np.array([scene.component_attempts for scene in scenes])
    assert [scene.attempts for scene in scenes] == attempts.max(axis=1).tolist()
    for told in (attempts, attempts.max(axis=1)):
        assert [fingerprint(scene) for scene in program.found(5, numbers, told)] == expected
    scenes[3].save(tmp_path / "scene.json")
    assert fingerprint(program.replay(tmp_path / "scene.json")) == expected[3]
    rows = [fingerprint(scene) for scene in program.sample(6, seed=5, source=Sobol())]
    assert [fingerprint(scene) for scene in program.sample(6, seed=5, source=Sobol(), lanes=2)] == rows


def test_what_falls_apart() -> None:
    counts = {
        "x = Range(0, 1)\nrequire x > 0.5\n": 1,
        "x, y = Range(0, 1), Range(0, 1)\nrequire x > 0.5\nparam y = y\n": 1,
        f"{OPAQUE}x, y = Range(0, 1), Range(0, 1)\nrequire same(x) > 0.5\nrequire same(y) > 0.5\n": 2,
        f"{OPAQUE}x, y = Range(0, 1), Range(0, 1)\nrequire same(x) > 0.5\nrequire same(y) > 0.5\nrequire same(x, y)\n": 1,
        # A requirement that cannot fail joins nothing.
        f"{OPAQUE}x, y = Range(0, 1), Range(0, 1)\nrequire same(x) > 0.5\nrequire same(y) > 0.5\nrequire x + y < 3\n": 2,
        "for i in range(4):\n    new Object at (Range(0, 1) + 3 * i, 0), facing Range(0, 7)\n": 1,
        "for i in range(4):\n    new Object at (Range(0, 3) + (0, 2, 9, 11)[i], 0), facing Range(0, 7)\n": 2,
        # What does not move joins nothing, wherever it stands between.
        "for i in range(2):\n    new Object at (Range(0, 3) + 10 * i, 0)\nnew Object at (5, 0), with width 10\n": 2,
        "for i in range(2):\n    new Object at (Range(0, 3) + 10 * i, 0), with width Range(1, 12)\n": 1,
        "for i in range(2):\n    new Object at (Range(0, 3) + 10 * i, 0), with allowCollisions True\n": 1,
    }  # fmt: skip
    for text, count in counts.items():
        assert components(scenario(text)) == count, text


def test_a_product_of_components_costs_what_each_of_them_does() -> None:
    city = scenario("".join(LOT.format(100 * number) for number in range(20)))
    assert components(city) == 20
    scenes = city.sample(10, seed=1)
    assert max(scene.attempts for scene in scenes) < 100  # one lot is free in a quarter of all candidates
    for scene in scenes:
        assert not any(one.intersects(other) for one, other in pairwise(scene.objects))


def test_limits_are_those_of_each_component() -> None:
    text = (
        OPAQUE
        + "x, y = Range(0, 1), Range(0, 1)\nrequire same(x) > 0.9\nrequire same(y) > 2 as never\nparam v = (x, y)\n"
    )
    program = scenario(text)
    for most in (1, 100):
        (result,) = program.stream(1, seed=0, max_attempts=most)
        assert isinstance(result, Exhausted)
        assert result.attempts == most
        assert [row.label for row in result.report.culprits()][-1] == "never"
    with pytest.raises(RejectionException, match="never rejected every candidate"):
        program.sample(2, seed=0, max_attempts=50)


def test_a_failure_is_told_at_its_scene_and_attempt() -> None:
    text = (
        OPAQUE
        + "x, y = Range(0, 1), Range(0, 1)\ndef high(v): return 1 / (v >= 0.1)\nrequire same(x) > 0.8\nrequire high(y)\nparam v = (x, y)\n"
    )
    program = scenario(text)
    sound = scenario(text.replace("1 / (v >= 0.1)", "True")).sample(60, seed=4)
    first = next(scene for scene in sound if scene.params["v"][1] < 0.1)
    for lanes in (1, 4096):
        results = program.stream(60, seed=4, lanes=lanes)
        for k in range(first.k):
            assert next(results).k == k
        with pytest.raises(ZeroDivisionError) as caught:
            next(results)
        assert f"(attempt 0 at scene {first.k})" in caught.value.__notes__[0]
