"""Objects of scenes are made together with those of neighbouring scenes; nothing of it shows."""

import gc
import weakref
from copy import deepcopy
from typing import Any

import pytest

import scenic
from scenic.language.garbage import import_lasting, no_garbage_collection

ALONE = """\
ego = new Object at (Range(0, 1), 0, 0), with name "first"
new Object at (Range(3, 4), 0, 0), with width Range(1, 2)
"""
LINKED = ALONE + "new Object at (6, 0, 0), with friend ego\n"
IN_PARAMETER = ALONE + "param friend = ego\n"
BY_METHOD = """\
class Counting:
    def where(self):
        return ego.position.x
    def whose(self):
        return ego
ego = new Object at (Range(0, 1), 0, 0)
new Counting at (3, 0, 0)
"""
EMPTY = "param x = Range(0, 1)\n"
PROGRAMS = [EMPTY, ALONE, LINKED, IN_PARAMETER]


def told(scene: Any) -> list[Any]:
    return [(tuple(item.position), item.yaw, item.width, item.length) for item in scene.objects]


@pytest.mark.parametrize("text", PROGRAMS)
def test_every_order_of_reading_shows_the_same_objects(text: str) -> None:
    scenario = scenic.scenarioFromString(text)
    forward = [told(scene) for scene in scenario.sample(600, seed=3)]
    scenes = scenario.sample(600, seed=3)
    assert [told(scene) for scene in reversed(scenes)][::-1] == forward
    assert [told(scene) for scene in scenario.sample(600, seed=3, lanes=7)] == forward
    assert told(scenes[0]) == forward[0], "and again"


@pytest.mark.parametrize("text", PROGRAMS)
def test_streams_in_turns_do_not_disturb_each_other(text: str) -> None:
    scenario = scenic.scenarioFromString(text)
    pairs = zip(scenario.stream(40, seed=1), scenario.stream(40, seed=2), strict=True)
    told_in_turns = [(told(one), told(other)) for one, other in pairs]
    assert [one for one, _ in told_in_turns] == [told(scene) for scene in scenario.sample(40, seed=1)]
    assert [other for _, other in told_in_turns] == [told(scene) for scene in scenario.sample(40, seed=2)]


@pytest.mark.parametrize("text", PROGRAMS)
def test_an_object_is_one_however_it_is_reached(text: str) -> None:
    for scene in scenic.scenarioFromString(text).sample(3, seed=1):
        assert scene.egoObject is (scene.objects[0] if scene.objects else None)
        friends = [item.friend for item in scene.objects if "friend" in item.properties]
        friends += [scene.params["friend"]] if "friend" in scene.params else []
        assert all(friend is scene.objects[0] for friend in friends)
        assert len(friends) == (text in (LINKED, IN_PARAMETER))


def test_a_method_finds_the_objects_of_its_own_scene() -> None:
    for scene in scenic.scenarioFromString(BY_METHOD).sample(5, seed=1):
        assert scene.objects[1].where() == scene.objects[0].position.x
        assert scene.objects[1].whose() is scene.objects[0]


def test_what_a_script_sets_stays_in_one_scene() -> None:
    first, second, *_ = scenic.scenarioFromString(ALONE).sample(5, seed=1)
    first.objects[0].mark = 1
    assert first.egoObject.mark == 1
    assert not hasattr(second.objects[0], "mark")
    again = deepcopy(first)
    assert not hasattr(again.objects[0], "mark")
    assert told(again) == told(first)


@pytest.mark.parametrize("given", ["with foo x", "with width f(x)", "at (f(x), 0, 0)"])
def test_an_object_is_that_of_its_own_scene(given: str) -> None:
    """Also where only a property differs, and where a function that is called on samples gives the place or size."""
    text = (
        "@distributionFunction\ndef f(v):\n    return v + 1\n"
        f"x = Range(0, 1)\nego = new Object {given}\nparam x = x\n"
    )
    scenes = scenic.scenarioFromString(text).sample(60, seed=1)
    values = {
        "with foo x": lambda item: item.foo,
        "with width f(x)": lambda item: item.width - 1,
        "at (f(x), 0, 0)": lambda item: item.position.x - 1,
    }
    found = [values[given](scene.egoObject) for scene in scenes]
    assert found == pytest.approx([scene.params["x"] for scene in scenes])
    assert len({round(value, 9) for value in found}) == 60


def test_copies_of_scenes_made_together_have_objects_of_their_own() -> None:
    for scene in scenic.scenarioFromString(ALONE).sample(5, seed=1):
        scene.objects[0].mark = 1
        again = deepcopy(scene)
        assert not {*map(id, scene.objects)} & {*map(id, again.objects)}
        assert not hasattr(again.objects[0], "mark")
        assert told(again) == told(scene)


def test_scenes_of_all_parts_of_a_batch_have_their_own_objects() -> None:
    """Of many objects those of few scenes are made at a time: of 600 scenes here in four parts."""
    text = (
        "x = Range(0, 1)\nparam x = x\nego = new Object at (x, 0, 0), with width x + 1\n"
        "for i in range(20):\n    new Object at (3 * i + 3, x, 0), with allowCollisions True\n"
        "new Object at (99, 0, 0), with tag x\n"
    )
    program = scenic.scenarioFromString(text)
    scenes = program.sample(600, seed=3)
    for scene in [*scenes[300:], *scenes[:300][::-1], *map(deepcopy, scenes[::50])]:
        x = scene.params["x"]
        assert (scene.egoObject.position.x, scene.egoObject.width, scene.objects[21].tag) == (x, x + 1, x)
        assert [item.position.y for item in scene.objects[1:21]] == [x] * 20
    assert len({id(item) for scene in scenes for item in scene.objects}) == 600 * 22


def test_scenes_are_freed_as_soon_as_nobody_holds_them() -> None:
    scenario = scenic.scenarioFromString(ALONE)
    with no_garbage_collection():
        scenes = scenario.sample(3, seed=1)
        items = [weakref.ref(item) for scene in scenes for item in scene.objects]
        kept = scenes[0].objects[1]
        del scenes
        assert [item() for item in items] == [None, kept, None, None, None, None]
        assert kept.shape.width == 1, "values are still to be had"


@pytest.mark.parametrize("enabled", [True, False])
def test_an_import_leaves_the_collector_as_it_was(enabled: bool) -> None:
    before = gc.isenabled()
    try:
        (gc.enable if enabled else gc.disable)()
        assert import_lasting("json").__name__ == "json"
        assert gc.isenabled() is enabled
    finally:
        (gc.enable if before else gc.disable)()


def test_what_is_imported_already_needs_no_count_of_all_objects(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gc, "get_freeze_count", lambda: pytest.fail("it takes 0.1 s in a large process"))
    assert import_lasting("json").__name__ == "json"


def test_objects_are_made_without_dictionaries() -> None:
    (scene,) = scenic.scenarioFromString(
        "class Box:\n    mine: 1\n" + "new Box at (Range(0, 1), 0, 0)"
    ).sample(1, seed=1)
    (thing,) = scene.objects
    assert not any(type(held) is dict for held in gc.get_referents(thing))
    assert thing.mine == 1


def test_a_class_that_hides_a_property_is_refused() -> None:
    text = "class Box:\n    @property\n    def heading(self):\n        return 3\nego = new Box\n"
    with pytest.raises(scenic.SpecifierError, match="heading"):
        scenic.scenarioFromString(text)


def test_an_object_whose_size_may_be_no_number_is_that_of_its_scene() -> None:
    """An option of another type, though it is never drawn, keeps sizes from being columns of numbers."""
    program = scenic.scenarioFromString(
        "t = Range(0, 1)\nego = new Object with width Discrete({1: 1, 'a': 1e-12, 2.5: 1}), with tag t\n"
        "new Object at (9, 9), with tag (t, ego.width)\nparam t = t, w = ego.width\n"
    )
    scenes = program.sample(20, seed=1)
    assert len({scene.params["t"] for scene in scenes}) == 20
    for scene in scenes:
        assert scene.objects[0].tag == scene.params["t"]
        assert scene.objects[0].width == scene.params["w"]
        assert scene.objects[1].tag == (scene.params["t"], scene.params["w"])


def test_a_copy_of_a_scene_has_parameters_of_its_own() -> None:
    """Also where those of the scene were looked at before; they lead to the objects of the copy."""
    text = "ego = new Object at (Range(0, 1), 0)\nparam leader = ego, marks = [Range(0, 1)]\n"
    for look in (True, False):
        (scene,) = scenic.scenarioFromString(text).sample(1, seed=1)
        assert not look or scene.params["marks"]
        again = deepcopy(scene)
        assert again.params["leader"] is again.egoObject is not scene.egoObject
        assert again.params["marks"] == scene.params["marks"]
        assert again.params["marks"] is not scene.params["marks"]


def test_a_scene_without_an_ego_has_none() -> None:
    (scene,) = scenic.scenarioFromString("new Object at (Range(0, 1), 0)\nnew Object at (9, 9)\n").sample(
        1, seed=1
    )
    assert scene.egoObject is None
    assert len(scene.objects) == 2


def test_what_an_object_is_in_all_scenes_is_told() -> None:
    """Which properties it has, which of them the program gives, and which are the same in every scene."""
    text = (
        "class Car:\n    load: 3\nego = new Car at (Range(0, 1), 0), with width 2, with extra 'x'\n"
        "new Car at (9, 9), facing 30 deg\nmoved = new Car at (20, 0)\nmutate moved by 3\n"
    )
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=1)
    ego, fixed, mutated = map(scene.origin, scene.objects)
    assert {"extra", "load", "width", "position"} <= {*ego.names}
    assert [*ego.names] == sorted(ego.names)
    assert "extra" not in fixed.names
    assert {"position", "width", "extra"} <= {*ego.given}
    assert "length" not in ego.given
    assert not {"width", "extra"} & {*fixed.given}
    assert {"width", "length", "load", "extra"} <= ego.fixed
    assert "position" not in ego.fixed
    assert {*fixed.names} == fixed.fixed
    assert mutated.fixed == frozenset()
    assert scene.origin(scene.objects[0]) is ego
    assert ego.read(scene.objects[0], "load") == 3
