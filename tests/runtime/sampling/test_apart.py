"""Crowds whose groups are drawn apart, alike ones as lanes: the same law, the same invariants."""

from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from scenic import scenarioFromFile
from scenic.graph.points import Sobol
from scenic.runtime.geometry.contact.collision import collide
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.sampling import pairing
from scenic.runtime.sampling.apart import Apart, rehearsed, separated
from scenic.runtime.sampling.components import Components
from scenic.runtime.sampling.draw_blocks import Reads
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.group_collisions import Bodies
from scenic.runtime.sampling.piecewise import PiecewiseEngine
from scenic.runtime.scenes.scenario import Scenario
from tests.amounts import amount
from tests.runtime.programs import FALSE_ALARM, fingerprint, scenario

PROGRAMS = {
    "alike": "yard = CircularRegion((0, 0), 3)\n"
    "for i in range(6):\n    new Object in yard, with regionContainedIn yard, facing Range(0, 360) deg\n",
    "two kinds, in turn": "yard = RectangularRegion((0, 0), 0, 7, 7)\n"
    "for i in range(3):\n    new Object in yard, with regionContainedIn yard, with width Uniform(1, 2)\n"
    "    new Object in yard, with width Range(0.5, 1), with shape CylinderShape()\n",
    "pairs": "yard = RectangularRegion((0, 0), 0, 12, 12)\n"
    "for i in range(4):\n    one = new Object in yard, facing Range(0, 360) deg\n"
    "    new Object ahead of one by Range(0.1, 3), with regionContainedIn yard\n",
    "beside a wall": "yard = RectangularRegion((0, 0), 0, 8, 8)\nnew Object at (1, 0), with width 0.4, with length 5\n"
    "for i in range(5):\n    new Object in yard, facing Range(0, 360) deg, with length Discrete({1: 3, 2: 1})\n",
    "softly": "yard = RectangularRegion((0, 0), 0, 9, 5)\n"
    "for i in range(5):\n    thing = new Object in yard, with name f'thing {i}'\n    require[0.6] thing.x > 1\n",
    "with requirements between": "yard = RectangularRegion((0, 0), 0, 9, 9)\nthings = [new Object in yard for i in range(6)]\n"
    "require (distance from things[0] to things[5]) < 4\nrequire things[2].y > things[3].y\n",
    "of several areas": "west, east = CircularRegion((-5, 0), 2), PolygonalRegion([(2, -3), (8, -3), (8, 3), (5, 0)])\narea = west.union(east)\n"
    "for i in range(5):\n    new Object in area, with regionContainedIn area, "
    "with allowCollisions Discrete({True: 1, False: 4})\n",
}  # fmt: skip


def drawn_apart(program: Scenario) -> Apart:
    """Let the scenes of a program be drawn apart, however many candidates pass."""
    engine = program._sampler.engine
    found = separated(engine, engine.plan, Reads(engine.plan.graph, engine.plan.domain), 0)
    assert found is not None
    program._sampler._may_divide = False
    program._sampler._finder = PiecewiseEngine(engine, Components((engine.plan,), found.owners(), (found,)))
    return found


def observed(scenes: Any) -> np.ndarray[Any, Any]:
    """Places and sizes of objects, ``(scenes, objects, 4)``."""
    return np.array(
        [[(item.x, item.y, item.width, item.length) for item in scene.objects] for scene in scenes]
    )


def check_law(found: np.ndarray[Any, Any], whole: np.ndarray[Any, Any]) -> None:
    """Compare what is observed of each object, and the distance of each pair, in two samples of scenes."""
    for item in range(found.shape[1]):
        for axis in range(4):
            ours, theirs = found[:, item, axis], whole[:, item, axis]
            values = np.unique(np.concatenate([ours, theirs]))
            if 1 < len(values) < 5:
                counts = [[(each == value).sum() for value in values] for each in (ours, theirs)]
                assert stats.chi2_contingency(counts).pvalue > FALSE_ALARM
            elif len(values) > 1:
                assert stats.ks_2samp(ours, theirs).pvalue > FALSE_ALARM
    for one, other in combinations(range(found.shape[1]), 2):
        ours, theirs = (
            np.linalg.norm(each[:, one, :2] - each[:, other, :2], axis=1) for each in (found, whole)
        )
        assert stats.ks_2samp(ours, theirs).pvalue > FALSE_ALARM


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_the_law_is_that_of_whole_scenes(name: str) -> None:
    program = scenario(PROGRAMS[name])
    assert drawn_apart(program).leaves >= 4
    found = observed(program.sample(amount(300, 2000), seed=1))
    program._sampler._finder = program._sampler.engine
    whole = observed(program.sample(amount(300, 2000), seed=2))
    check_law(found, whole)


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_scenes_depend_on_seed_and_number_alone(
    name: str, tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = scenario(PROGRAMS[name])
    drawn_apart(program)
    scenes = program.sample(20, seed=5)
    expected = [fingerprint(scene) for scene in scenes]
    for lanes in (1, 7):
        assert [fingerprint(scene) for scene in program.sample(12, seed=5, lanes=lanes)] == expected[:12]
    assert [fingerprint(*program.stream(1, first=k, seed=5)) for k in range(8)] == expected[:8]
    monkeypatch.setattr(pairing, "_MOST_KEPT", 50)
    monkeypatch.setattr(pairing, "_SCENES", 40)
    assert [fingerprint(scene) for scene in program.sample(20, seed=5)] == expected
    attempts = np.array([scene.component_attempts for scene in scenes])
    assert [fingerprint(scene) for scene in program.found(5, np.arange(20), attempts)] == expected
    scenes[3].save(tmp_path / "scene.json")
    assert fingerprint(program.replay(tmp_path / "scene.json")) == expected[3]
    rows = [fingerprint(scene) for scene in program.sample(4, seed=5, source=Sobol())]
    assert rows == [fingerprint(scene) for scene in program.sample(4, seed=5, source=Sobol(), lanes=3)]
    engine = program._sampler.engine
    found = program._sampler._finder.scenes([(5, k) for k in range(20)], max_attempts=1000)
    batch = next(iter(found))[0].batch  # type: ignore[index]
    for check in engine.plan.checks:
        assert check.probability < 1 or check.test(batch).holds.all()


def test_limits_of_attempts_and_time() -> None:
    program = scenario(PROGRAMS["alike"])
    drawn_apart(program)
    assert max(result.attempts for result in program.stream(8, seed=1, max_attempts=1)) == 1
    late = list(program.stream(3, seed=1, time_limit=1e-9))
    assert [result.reason for result in late] == ["time"] * 3


def test_a_profile_counts_what_was_tried() -> None:
    program = scenario(PROGRAMS["alike"])
    drawn_apart(program)
    profile = program.profile(5, seed=1)
    assert profile.candidates >= 5
    assert profile.seconds > 0
    assert profile.rounds >= 1


def test_alike_things_are_one_kind() -> None:
    kinds = {name: len(drawn_apart(scenario(text)).kinds) for name, text in PROGRAMS.items()}
    assert kinds == {
        "alike": 1,
        "two kinds, in turn": 2,
        "pairs": 1,
        "beside a wall": 1,
        "softly": 1,
        "with requirements between": 3,
        "of several areas": 1,
    }


def test_crowds_are_rehearsed_as_whole_candidates_are() -> None:
    text = (
        "area = RectangularRegion((0, 0), 0, 90, 30)\nnew Object at (50, 0), with length 20\n"
        "for i in range(64):\n    new Object in area, facing Range(0, 360) deg, with width Uniform(1, 2), "
        "with regionContainedIn area\n"
    )
    program = scenario(text)
    finder = program._sampler._finder
    assert isinstance(finder, PiecewiseEngine)
    apart = finder._components.trees[0]
    assert isinstance(apart, Apart)
    whole = Engine(program._sampler.plan)
    whole.prepare()
    met, passed = rehearsed(program._sampler.engine, apart)
    assert passed == whole.rehearsed
    pending, count = whole.pending([(0, 0)]), whole.rehearsed_of
    batch = whole.attempts_at(pending, np.zeros(count, dtype=np.intp), np.arange(count))
    for number, mask in met.items():
        assert (mask == whole.plan.checks[number].test(batch).holds).all()
    assert len(met) == 64


def test_a_crowd_that_hardly_ever_fits_is_found() -> None:
    """Ninety things on 40 x 40 metres: about one candidate in 10^8 is a scene."""
    text = "yard = RectangularRegion((0, 0), 0, 40, 40)\nfor i in range(90):\n    new Object in yard, with regionContainedIn yard\n"
    program = scenario(text)
    (scene,) = program.sample(1, seed=1)
    places = np.array([(item.x, item.y) for item in scene.objects])
    gaps = np.abs(places[:, np.newaxis] - places).max(axis=2) + np.eye(90)
    assert (gaps >= 1).all()
    assert (np.abs(places) <= 19.5).all()


@st.composite
def crowds(draw: st.DrawFn) -> tuple[list[Body], np.ndarray[Any, Any], int]:
    count, lanes = draw(st.integers(2, 7)), draw(st.integers(1, 5))
    random = np.random.default_rng(draw(st.integers(0, 10**6)))
    meshes = (primitives.box(), primitives.cone())
    bodies = [
        Body(
            meshes,
            random.integers(0, 2, lanes),
            Poses(
                random.uniform(-2, 2, (lanes, 3)) * draw(st.sampled_from([1.0, 50.0])),
                random.standard_normal((lanes, 4)),
                random.uniform(0.3, 2, (lanes, 3)),
            ),
            random.random(lanes) < 0.1,
        )
        for _ in range(count)
    ]
    for body in bodies:
        body.poses.orientation[:] /= np.linalg.norm(body.poses.orientation, axis=1, keepdims=True)
    return bodies, random.integers(0, 3, count), lanes


def test_attempts_that_all_fail_are_followed_by_others() -> None:
    # Chairs that stand on nothing fail at the first check, so that others have no lane left.
    room = Path(__file__).parents[3] / "examples" / "indoor" / "furnished_room.scenic"
    assert len(scenarioFromFile(room).sample(2, seed=1)) == 2


@given(crowds())
def test_meeting_is_collision_between_parts(drawn: Any) -> None:
    bodies, part, lanes = drawn
    count = len(bodies)
    store = Bodies()
    first = store.add(bodies, np.tile(np.arange(count), (lanes, 1)))
    may_meet = part[:, np.newaxis] != part
    pairs = np.argwhere(np.triu(may_meet))
    expected = collide(bodies, pairs, lanes).free
    chosen = (first[:, np.newaxis] + np.arange(count)).ravel()
    lane = np.repeat(np.arange(lanes), count)
    everything = np.ones((count, count), dtype=np.bool_)
    assert (store.apart(lanes, chosen, lane, np.tile(part, lanes), everything) == expected).all()
    assert (store.apart(lanes, chosen, lane, np.tile(np.arange(count), lanes), may_meet) == expected).all()
