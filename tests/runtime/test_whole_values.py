"""Values, objects, scenes and scenarios can be pickled, copied and sent to other processes."""

import copy
import multiprocessing
import pickle
from typing import Any

import pytest

from runtime.programs import scenario
from scenic.runtime.values import Orientation, Vector

PROGRAM = (
    "class Car:\n    width: 2\n    speedy: Range(0, 1)\n"
    "ego = new Car at (Range(0, 1), 2, 3), facing Range(0, 1)\n"
    "other = new Object at (9, 9), with shape CylinderShape()\n"
    "r = CircularRegion((1, 2, 3), Range(1, 2))\nparam r = r, x = [Range(0, 1), {'a': ego.position}]\n"
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
    car = whole().egoObject
    same = again(car)
    assert type(same).__name__ == "Car"
    for name in ("position", "yaw", "width", "speedy", "velocity", "visibleDistance"):
        assert getattr(same, name) == getattr(car, name), name
    assert same.corners == car.corners


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
