"""Values, objects, scenes and scenarios can be pickled, copied and sent to other processes."""

import copy
import multiprocessing
import pickle
from collections.abc import Iterator
from typing import Any

import pytest

from runtime.programs import scenario
from scenic.runtime.values.values import Orientation, Random, Vector
from scenic.simulators.dummy import DummySimulator

PROGRAM = (
    "class Car:\n    width: 2\n    speedy: Range(0, 1)\n"
    "ego = new Car at (Range(0, 1), 2, 3), facing Range(0, 1)\n"
    "other = new Object at (9, 9), with shape CylinderShape()\n"
    "r = CircularRegion((1, 2, 3), Range(1, 2))\nparam r = r, x = [Range(0, 1), {'a': ego.position}], spot = front of ego\n"
)


def whole() -> Any:
    return scenario(PROGRAM).sample(1, seed=4)[0]


COPIES = [lambda value: pickle.loads(pickle.dumps(value)), copy.copy, copy.deepcopy]


@pytest.mark.parametrize("again", COPIES)
def test_values_are_equal_again(again: Any) -> None:
    scene = whole()
    car, other = scene.objects
    assert again(car.position) == car.position
    assert again(car.orientation) == car.orientation
    assert again(scene.params["r"]).center == (1, 2, 3)
    assert again(scene.params["r"]).radius == scene.params["r"].radius
    assert (again(other.shape).mesh.vertices == other.shape.mesh.vertices).all()
    spot = scene.params["spot"]
    assert (again(spot).position, again(spot).orientation) == (car.front.position, car.orientation)
    assert again(spot).properties.keys() == spot.properties.keys()
    assert (again(spot).yaw, again(spot).viewAngles) == (spot.yaw, spot.viewAngles)
    assert again(other.shape).source.as_dict() == {"kind": "cylinder", "sections": 24}


@pytest.mark.parametrize("again", COPIES)
def test_shapes_that_were_looked_at_can_be_copied(again: Any) -> None:
    scene = scenario(
        "ego = new Object\nwall = new Object at (0, 2), with shape ConeShape()\n"
        "target = new Object at (0, 4), with height 3\nrequire ego can see target\n"
    ).sample(1, seed=0)[0]
    same = again(scene.objects[1].shape)
    assert (same.mesh.vertices == scene.objects[1].shape.mesh.vertices).all()
    assert not same.mesh.vertices.flags.writeable


@pytest.mark.parametrize("again", COPIES)
def test_objects_keep_their_properties(again: Any) -> None:
    car, other = whole().objects
    same = again(car)
    assert type(same).__name__ == "Car"
    assert type(again(other)) is type(other)
    for name in ("position", "yaw", "width", "speedy", "velocity", "visibleDistance"):
        assert getattr(same, name) == getattr(car, name), name
    assert same.corners == car.corners


@pytest.mark.parametrize("again", COPIES)
def test_copies_of_copies_have_all_properties(again: Any) -> None:
    """Those that a specifier made, too; and what is flat stays so, and sees what is above its disc."""
    text = "class Car:\n    speedy: Range(0, 1)\nego = new Car with size Range(5, 6)\n"
    for flat in (False, True):
        ego = scenario(text, mode2D=flat).sample(1, seed=1)[0].egoObject
        same = again(again(ego))
        assert same.properties.keys() == ego.properties.keys()
        assert (same.size, same.speedy) == (ego.size, ego.speedy)
        assert same.canSee((0, 45, 45)) is ego.canSee((0, 45, 45)) is flat


@pytest.mark.parametrize("again", COPIES)
def test_scenes_are_the_same_scenes(again: Any) -> None:
    scene = whole()
    same = again(scene)
    assert (same.seed, same.k, same.attempts) == (scene.seed, scene.k, scene.attempts)
    assert [item.position for item in same.objects] == [item.position for item in scene.objects]
    assert same.params["x"] == scene.params["x"]


def test_a_deep_copy_has_objects_of_its_own() -> None:
    scene = whole()
    same = copy.deepcopy(scene)
    assert same.egoObject is not scene.egoObject


@pytest.mark.parametrize("again", COPIES)
def test_copies_of_objects_that_know_each_other_do_so_too(again: Any) -> None:
    text = (
        "class Friendly:\n    friend: None\n    itself: None\n"
        "ego = new Friendly at (Range(0, 1), 0)\nother = new Friendly at (3, 0), with friend ego\n"
        "ego.friend = other\nego.itself = ego\n"
    )
    scene = scenario(text).sample(1, seed=1)[0]
    first = scene.egoObject
    assert first.friend.friend is first
    assert first.itself is first
    same = again(first)
    assert same is not first
    assert same.position == first.position
    owner = first if again is copy.copy else same  # which copies the object alone
    assert (same.friend is first.friend) is (again is copy.copy)
    assert same.friend.friend is owner
    assert same.itself is owner
    ego, other = again(scene).objects
    assert (ego.friend, other.friend, ego.itself) == (other, ego, ego)


COUNTED = """
calls = []
def seen(x):
    calls.append(x)
    return [x, len(calls)]
behavior Call():
    calls.extend([1, 2, 3])
    wait
ego = new Object at (Range(0, 1), Normal(0, 1)), facing Range(0, 1), with behavior Call, with foo DiscreteRange(0, 9)
other = new Object at (0, 9), with shape Uniform(BoxShape(), ConeShape())
param p = seen(ego.x), b = Uniform(True, False)
"""


def test_values_come_out_of_the_pickle() -> None:
    """Numbers, vectors and orientations are not evaluated again; Python objects are, when they are read, as if nothing had happened since."""
    scenes = scenario(COUNTED).sample(3, seed=1)
    copies = [pickle.loads(pickle.dumps(scene)) for scene in scenes]
    calls = copies[0].scenario.program.module["calls"]
    calls.clear()
    for scene, same in zip(scenes, copies, strict=True):
        for thing, copied in zip(scene.objects, same.objects, strict=True):
            assert (copied.position, copied.orientation) == (thing.position, thing.orientation)
        assert same.egoObject.foo == scene.egoObject.foo
    assert calls == []
    DummySimulator().simulate(copies[0], maxSteps=2)
    for scene, same in zip(scenes, copies, strict=True):
        assert same.params["p"][0] == scene.egoObject.x
        assert (same.params["b"], type(same.objects[1].shape)) == (
            scene.params["b"],
            type(scene.objects[1].shape),
        )


def test_a_scenario_is_compiled_anew() -> None:
    program = scenario(PROGRAM)
    again = pickle.loads(pickle.dumps(program))
    one, other = (item.sample(3, seed=2) for item in (program, again))
    assert [item.egoObject.position for item in one] == [item.egoObject.position for item in other]


def first_position(number: int) -> Any:
    return scenario(PROGRAM).sample(1, seed=number)[0].egoObject.position


@pytest.mark.slow
def test_a_pool_returns_positions() -> None:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map_async(first_position, [4]).get(timeout=60) == [whole().egoObject.position]


def test_vectors_are_equal_to_pairs_and_triples_alone() -> None:
    assert Vector(1, 2, 0) == (1, 2) == Vector(1, 2, 0)
    assert Vector(1, 2, 3) == [1, 2, 3]
    for other in ((1,), (1, 0, 0, 0), (), (1, 0, 1), [1], "100"):
        assert Vector(1, 0, 0) != other


def test_a_rotation_is_that_of_the_opposite_quaternion_too() -> None:
    turn = Orientation.fromEuler(0.3, 0.2, 0.1)
    opposite = Orientation.of(-part for part in (turn.x, turn.y, turn.z, turn.w))
    assert turn == opposite
    assert hash(turn) == hash(opposite)
    assert turn.approxEq(opposite)
    assert opposite.approxEq(Orientation.fromEuler(0.3 + 1e-7, 0.2, 0.1))
    assert not opposite.approxEq(Orientation.fromEuler(0.31, 0.2, 0.1))
    half = Orientation.of((1.0, 0.0, 0.0, 0.0))
    assert half == Orientation.of((-1.0, 0.0, 0.0, 0.0))
    assert hash(half) == hash(Orientation.of((-1.0, 0.0, 0.0, 0.0)))


DRAWN = """
behavior B(x):
    take x
class A:
    foo: Range(0, 1)
    bar: [Range(0, 1), {'a': (Range(2, 3), 'x')}]
    positionStdDev: (Range(0.1, 0.2), 0, 0)
    orientationStdDev: (0, Range(0.1, 0.2), 0)
    regionContainedIn: CircularRegion((0, 0), Range(90, 100))
    shape: Uniform(BoxShape(), ConeShape())
ego = new A with behavior B([Range(0, 1)]), with width Range(1, 2)
new A at (9, Range(0, 1)), with behavior Uniform(B(1), B(Range(2, 3))), with color Uniform((1, 0, 0), (0, 1, 0))
mutate
param p = Range(0, 1), q = [ego.foo, {'z': Range(0, 1)}], r = CircularRegion((Range(0, 1), 0), 3)
"""


def random_parts(value: Any, path: str, seen: dict[int, Any]) -> Iterator[str]:
    """Where in a value something is still random."""
    if id(value) in seen:
        return
    seen[id(value)] = value
    if isinstance(value, Random):
        yield path
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from random_parts(item, f"{path}[{key!r}]", seen)
    elif isinstance(value, list | tuple | set):
        for index, item in enumerate(value):
            yield from random_parts(item, f"{path}[{index}]", seen)
    elif type(value).__module__.startswith("scenic.runtime"):
        yield from random_parts(getattr(value, "__dict__", None), path, seen)
        arguments = getattr(value, "_arguments", None)
        yield from random_parts(getattr(arguments, "arguments", None), f"{path}()", seen)


def test_nothing_in_a_scene_is_random() -> None:
    """However deep: deviations of mutators, arguments of behaviors, regions, parts of containers."""
    for scene in scenario(DRAWN).sample(3, seed=2):
        values: dict[str, Any] = {"params": scene.params}
        for number, thing in enumerate(scene.objects):
            values |= {f"{number}.{name}": value for name, value in thing.properties.items()}
        for name, value in values.items():
            assert list(random_parts(value, name, {})) == []
        assert all(
            0.1 < mutator.stddevs[place] < 0.2
            for thing in scene.objects
            for place, mutator in ((1, thing.mutator[0]), (0, thing.mutator[1]))
        )


def test_pickled_objects_leave_the_program_behind() -> None:
    """Behaviors, mutators and sensors are the program's; all else is kept."""
    for thing in scenario(DRAWN).sample(1, seed=2)[0].objects:
        same = pickle.loads(pickle.dumps(thing))
        gone = {"behavior", "mutator", "sensors", "observations", "lastActions"}
        assert {name for name, value in same.properties.items() if value is None} >= gone
        for name in ("foo", "bar", "position", "width", "yaw", "color", "positionStdDev"):
            assert getattr(same, name) == getattr(thing, name)
