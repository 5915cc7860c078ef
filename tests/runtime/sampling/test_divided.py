"""Scenes put together from halves of their components: the same law, the same invariants, and where that pays."""

from typing import Any

import numpy as np
import pytest
from scipy import stats

from scenic.graph.points import Sobol
from scenic.runtime.sampling.components import components_of, divided
from scenic.runtime.sampling.piecewise import PiecewiseEngine
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from tests.amounts import amount
from tests.runtime.programs import FALSE_ALARM, fingerprint, scenario

CHAIN = (
    "places = [new Point in CircularRegion((i, 0), 1.2) for i in range({})]\n"
    "things = [new Object at place, with width 0.2, with length 0.2 for place in places]\n"
    "for one, other in zip(things, things[1:]):\n    require 0.3 < (distance from one to other) < 1.5\n"
)

PROGRAMS = {
    "chain": CHAIN.format(5),
    "discs": "table = RectangularRegion((0, 0), 0, 1, 1.4)\nfor i in range(6):\n    new Object in table, with width 0.2, "
    "with length 0.2, with shape CylinderShape()\n",
    "soft": "a, b, c = Range(0, 1), Range(0, 1), Range(0, 1)\nrequire[0.7] a < b\nrequire[0.4] b < c\nrequire a + c < 1\n"
    "require[0.5] b > 0.3\nparam v = (a, b, c)\n",
    "parts": "for lot in range(2):\n    for i in range(3):\n        new Object at (50 * lot + Range(-2, 2), Range(-2, 2)), facing Range(0, 7)\n",
    "shared": "ego = new Object at (Range(0, 5), Range(0, 5))\none = new Object at ego offset by (Range(1, 4), Range(-3, 3))\n"
    "two = new Object at one offset by (Range(-4, 4), Range(-3, 3))\nrequire two.x > ego.x\nrequire one.y + two.y > ego.y\n",
    "boxes and words": "yard = PolygonalRegion([(0, 0), (9, 0), (4, 1), (0, 9)])\none = new Object in yard\n"
    "two = new Object in yard, with regionContainedIn yard\na, b = Range(-1, 1), Range(-1, 1)\nrequire a * a + b * b > 1.3\n"
    "require one.x + a > two.x\nparam v = (a, b)\n",
}  # fmt: skip


def halved(program: Scenario) -> int:
    """Divide all that can be divided in a program, and tell into how many leaves."""
    sampler = program._sampler
    components = divided(sampler.engine, components_of(sampler.engine.plan), always=True)
    assert components is not None
    sampler._finder = PiecewiseEngine(sampler.engine, components)
    return components.leaves


def observed(scenes: Any) -> np.ndarray[Any, Any]:
    return np.array(
        [
            [*scene.params.get("v", ()), *(part for item in scene.objects for part in (item.position.x, item.position.y))]
            for scene in scenes
        ]
    )  # fmt: skip


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_the_law_is_that_of_whole_scenes(name: str) -> None:
    program = scenario(PROGRAMS[name])
    assert halved(program) >= 2
    found = observed(program.sample(amount(250, 400), seed=1))
    program._sampler._finder = program._sampler.engine
    expected = observed(program.sample(amount(250, 400), seed=2))
    mix = np.arange(1, found.shape[1] + 1)[:, np.newaxis] % 7 - 2.6
    for ours, theirs in zip((*found.T, *(found @ mix).T), (*expected.T, *(expected @ mix).T), strict=True):
        assert stats.ks_2samp(ours, theirs).pvalue > FALSE_ALARM


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_scenes_depend_on_seed_and_number_alone(name: str, tmp_path: Any) -> None:
    program = scenario(PROGRAMS[name])
    halved(program)
    scenes = program.sample(20, seed=5)
    expected = [fingerprint(scene) for scene in scenes]
    for lanes, count in ((1, amount(6, 20)), (7, 20), (512, 20)):
        assert [fingerprint(scene) for scene in program.sample(count, seed=5, lanes=lanes)] == expected[
            :count
        ]
    assert [fingerprint(*program.stream(1, first=k, seed=5)) for k in range(8)] == expected[:8]
    # What is kept of them says all.
    attempts = np.array([scene.component_attempts for scene in scenes])
    assert [fingerprint(scene) for scene in program.found(5, np.arange(20), attempts)] == expected
    scenes[3].save(tmp_path / "scene.json")
    assert fingerprint(program.replay(tmp_path / "scene.json")) == expected[3]
    rows = [fingerprint(scene) for scene in program.sample(4, seed=5, source=Sobol())]
    assert rows == [fingerprint(scene) for scene in program.sample(4, seed=5, source=Sobol(), lanes=3)]


def test_what_a_limit_ends() -> None:
    program = scenario(PROGRAMS["discs"])
    halved(program)
    assert {result.attempts for result in program.stream(3, seed=1, max_attempts=1)} == {1}
    late = list(program.stream(3, seed=1, time_limit=1e-9))
    assert [result.reason for result in late] == ["time"] * 3


def is_divided(text: str) -> bool:
    program = scenario(text)
    program.sample(1, seed=1)
    return isinstance(program._sampler._finder, PiecewiseEngine)


CROWD = (
    "yard = CircularRegion((0, 0), 5)\n"
    "for i in range(9):\n    new Object in yard, with regionContainedIn yard, facing Range(0, 360) deg\n"
)


def test_crowds_are_drawn_apart_by_the_same_law(tmp_path: Any) -> None:
    program = scenario(CROWD)
    scenes = program.sample(amount(250, 1000), seed=1)
    assert isinstance(program._sampler._finder, PiecewiseEngine)
    assert program._sampler._finder._components.leaves > 1
    expected = [fingerprint(scene) for scene in scenes[:8]]
    assert [fingerprint(*program.stream(1, first=k, seed=1)) for k in range(8)] == expected
    assert [fingerprint(scene) for scene in program.sample(8, seed=1, lanes=3)] == expected
    scenes[3].save(tmp_path / "scene.json")
    assert fingerprint(program.replay(tmp_path / "scene.json")) == expected[3]
    found = observed(scenes)
    program._sampler._finder = program._sampler.engine
    whole = observed(program.sample(amount(250, 1000), seed=2))
    for ours, theirs in zip(found.T, whole.T, strict=True):
        assert stats.ks_2samp(ours, theirs).pvalue > FALSE_ALARM
    near, near_whole = (np.linalg.norm(rows[:, 0:2] - rows[:, 2:4], axis=1) for rows in (found, whole))
    assert stats.ks_2samp(near, near_whole).pvalue > FALSE_ALARM


def test_rare_chains_are_divided_and_common_ones_are_not() -> None:
    rare = scenario(CHAIN.format(16))
    scenes = rare.sample(3, seed=1)
    assert isinstance(rare._sampler._finder, PiecewiseEngine)
    assert fingerprint(scenes[0]) == fingerprint(scenario(CHAIN.format(16)).sample(1, seed=1)[0])
    for scene in scenes:
        places = np.array([thing.position for thing in scene.objects])
        gaps = np.linalg.norm(np.diff(places, axis=0), axis=1)
        assert (gaps > 0.3).all()
        assert (gaps < 1.5).all()
    assert not is_divided(CHAIN.format(4))


def test_values_that_may_fail_are_judged_with_the_whole_scene() -> None:
    text = CHAIN.format(16) + "require 1 / (things[0].x - things[1].x) < 9\n"
    (result,) = scenario(text).stream(1, seed=1, max_attempts=100)
    assert isinstance(result, Exhausted)
