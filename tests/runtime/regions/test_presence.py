"""Objects that may take no part in a scene (`present`): the law, what is asked of them, and every way in which scenes are told."""

import io
import json
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.compiler.check import check_text
from scenic.formats.json_lines import SceneLines, scene_document
from scenic.language.errors import InvalidScenarioError, RandomControlFlowError
from scenic.runtime.scenes.columns import SceneColumns
from scenic.simulators.kinematic import KinematicSimulator
from tests.each import each

COUNTED = """
count = DiscreteRange(2, 4)
ego = new Object at (0, 0, 0), with name 'ego'
last = ego
for i in range(4):
    last = new Object at (3 * i + 3, Range(0, 1), 0), with present i < count, with name str(i), with before last
param count = count
"""


def compiled(text: str, **options: Any) -> scenic.Scenario:
    return scenic.scenarioFromString(text, **options)


@pytest.fixture(scope="module")
def counted() -> scenic.Scenario:
    return compiled(COUNTED)


def test_a_random_number_of_objects(counted: scenic.Scenario) -> None:
    scenes = counted.sample(300, seed=1)
    counts = Counter(scene.params["count"] for scene in scenes)
    assert min(counts[number] for number in (2, 3, 4)) > 70
    for scene in scenes:
        assert [thing.name for thing in scene.objects] == ["ego", *map(str, range(scene.params["count"]))]
        assert all(thing.present is True for thing in scene.objects)
        assert scene.egoObject is scene.objects[0]
        assert len(scene.cast) == len(counted.objects) == 5
        assert [thing.present for thing in scene.cast[1:]] == [i < scene.params["count"] for i in range(4)]


def test_scenes_as_lines_columns_programs_and_bytes_agree(counted: scenic.Scenario, tmp_path: Path) -> None:
    scenes = counted.sample(40, seed=2)
    lines = SceneLines(changed=True)
    for scene in scenes:
        document = json.loads(lines.line(scene))
        told = [thing["properties"]["name"] for thing in document["objects"]]
        assert told == [thing.name for thing in scene.objects]
        # References are numbers among those that are there.
        before = [thing["properties"].get("before") for thing in document["objects"]]
        assert before[1:] == [{"$object": number} for number in range(len(told) - 1)]
        assert all("present" not in thing["properties"] for thing in document["objects"])
        again = counted.sceneFromBytes(counted.sceneToBytes(scene))
        assert scene_document(again)["objects"] == scene_document(scene)["objects"]
        stream = io.StringIO()
        scene.dumpAsScenicCode(stream)
        (copy,) = compiled(stream.getvalue()).sample(1)
        assert [tuple(thing.position) for thing in copy.objects] == [
            tuple(thing.position) for thing in scene.objects
        ]
    pytest.importorskip("pyarrow")
    from scenic.formats.scene_tables import SceneTable

    rows = SceneTable(counted).batch(scenes).to_pylist()
    for row, scene in zip(rows, scenes, strict=True):
        assert [thing["properties"]["name"] for thing in row["objects"]] == [
            thing.name for thing in scene.objects
        ]
        positions = [thing["position"] for thing in row["objects"]]
        assert positions == [list(thing.position) for thing in scene.objects]
    (fourth,) = SceneColumns(counted).objects[4:]
    assert fourth.present.array(scenes).tolist() == [len(scene.objects) == 5 for scene in scenes]


def test_what_is_absent_meets_nothing_and_the_law_is_that_of_rejection() -> None:
    """A body that fits in a quarter of its places: where it is present these count, where it is absent all do."""
    text = """
workspace = Workspace(RectangularRegion((0, 0), 0, 10, 10))
ego = new Object at (0, 0, 0), with width 4, with length 4
other = new Object at (Range(-6, 6), 0, 0), with present Uniform(True, False)
"""
    for options in ({}, {"mode2D": True}):
        scenes = compiled(text, **options).sample(4000, seed=3)
        share = np.mean([len(scene.objects) == 2 for scene in scenes])
        # 4 of 12 metres are free and inside; 1/2 * 1/3 beside 1/2 * 1.
        assert share == pytest.approx(0.25, abs=0.03)
        places = [scene.cast[1].position.x for scene in scenes if len(scene.objects) == 1]
        assert min(places) < -5.9
        assert any(abs(place) < 0.1 for place in places)


ASKED = {
    "collisions": "new Object at (0.5, 0, 0), with present {}",
    "containment": "new Object at (50, 0, 0), with present {}",
    "requireVisible": "new Object at (9, 0, 0), with requireVisible True, with present {}",
    "visible": "new Object at (9, 0, 0), visible, with present {}",
    "not visible": "new Object at (2, 0, 0), not visible, with present {}",
    "a container of its own": "new Object at (3, 0, 0), with regionContainedIn CircularRegion((9, 0, 0), 1), with present {}",
    "size": "new Object at (3, 0, 0), with width Range(-1, 0), with present {}",
}


@each(ASKED)
def test_nothing_is_required_of_what_is_absent(what: str) -> None:
    text = f"""
workspace = Workspace(BoxRegion(dimensions=(20, 20, 20)))
ego = new Object with visibleDistance 5
{ASKED[what]}
"""
    scenario = compiled(text.format("Uniform(True, False)"))
    assert all(len(scene.objects) == 1 for scene in scenario.sample(10, seed=1))
    if what != "size":  # of one that never is there its size is refused as that of any other
        (scene,) = compiled(text.format("False")).sample(1)
        assert len(scene.objects) == 1


def test_what_is_absent_is_not_seen_and_hides_nothing() -> None:
    text = """
there = Uniform(True, False)
ego = new Object
wall = new Object at (0, 3, 0), with width 20, with length 0.1, with height 20, with present there
ball = new Object at (0, 6, 0)
require {}
"""
    for condition, present in (
        ("ego can see ball", False),
        ("not (ego can see ball)", True),
        ("ego can see wall", True),
        ("not (ego can see wall)", False),
        ("wall.present implies there", None),
    ):
        found = {len(scene.objects) == 3 for scene in compiled(text.format(condition)).sample(12, seed=4)}
        assert found == ({True, False} if present is None else {present}), condition


def test_conditions_may_say_who_is_present() -> None:
    text = """
x, word, n = Range(0, 1), Uniform('a', 'b'), DiscreteRange(0, 3)
class Maybe:
    limit: 0.5
    present: Range(0, 1) < self.limit
def make(i):
    return new Object at (2 * i, 0, 0), with present {}
ego = new Object at (0, 9, 0)
make(1)
new Maybe at (0, 4, 0), with limit 0.2
param x = x, word = word, n = n
"""
    expected = {
        "0.2 < x <= 0.7 and word == 'a'": lambda p: 0.2 < p["x"] <= 0.7 and p["word"] == "a",
        "not (n == 2 or x > 0.5)": lambda p: not (p["n"] == 2 or p["x"] > 0.5),
        "n": lambda p: bool(p["n"]),
        "(x * 2 if i == 1 else x) < 0.3": lambda p: p["x"] * 2 < 0.3,
        "i > 0": lambda p: True,
    }
    for condition, wanted in expected.items():
        scenes = compiled(text.format(condition)).sample(60, seed=5)
        for scene in scenes:
            assert scene.cast[1].present is wanted(scene.params), condition
        assert 0 < sum(scene.cast[2].present for scene in scenes) < 30


def test_simulations_have_only_who_is_present() -> None:
    text = """
behavior Go():
    while True:
        wait
behavior Wait():
    wait
    terminate
class Box:
    behavior: Go()
scenario Later():
    setup:
        new Box at (20, 0, 0), with present False
        new Box at (30, 0, 0), with present simulation().currentTime == 0
        new Box at (40, 0, 0), with present simulation().currentTime > 0
scenario Main():
    setup:
        there = Uniform(True, False)
        ego = new Box at (0, 0, 0)
        other = new Box at (5, 0, 0), with present there
        record other.present as there
        record (ego can see other) as seen
    compose:
        do Later() for 2 steps
"""
    scenario = compiled(text)
    counts = set()
    for scene in scenario.sample(8, seed=6):
        done = KinematicSimulator().simulate(scene, maxSteps=3)
        assert done is not None
        present = scene.cast[1].present
        assert [obj.position.x for obj in done.objects] == [0.0, *([5.0] if present else []), 30.0]
        assert len(done.agents) == 2 + present
        assert (
            {value for _, value in done.records["there"]}
            == {present}
            == {value for _, value in done.records["seen"]}
        )
        counts.add(present)
    assert counts == {True, False}


def test_the_ego_is_always_there() -> None:
    with pytest.raises(InvalidScenarioError, match="the ego takes part in every scene"):
        compiled("ego = new Object with present Uniform(True, False)")


def test_a_loop_over_a_random_number_names_the_property(tmp_path: Path) -> None:
    with pytest.raises(RandomControlFlowError) as caught:
        compiled("n = [DiscreteRange(2, 6)]\nfor i in range(n[0]):\n    new Object")
    assert "with present i < count" in str(caught.value.diagnostic().help)
    found = check_text("for i in range(DiscreteRange(2, 6)):\n    new Object\n", filename="f")
    (problem,) = [item for item in found if item.code == "SC403"]
    assert "with present i < count" in str(problem.help)
    fine = "count = DiscreteRange(2, 6)\nfor i in range(6):\n    new Object at i, with present not (i >= count and count > 3)\n"
    assert not [item for item in check_text(fine, filename="f") if item.code == "SC403"]
