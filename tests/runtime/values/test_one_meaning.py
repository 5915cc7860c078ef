"""What instances, vectors and orientations offer is the same wherever it is asked.

In the program, of random values; of the objects of its scenes, and of copies of these; in code that is called on samples; and in a
simulation. The ways to an answer have little in common.
"""

import copy
import math
import pickle
from collections.abc import Callable
from typing import Any

import pytest

from scenic.runtime.instances.objects import SIDES, OrientedPoint, Point
from scenic.runtime.values.values import Orientation, Vector, is_number
from scenic.simulators.dummy import DummySimulator
from tests.runtime.programs import scene

PROGRAM = """
r = Range(0.3, 0.6)
disc, room = CircularRegion((3, 4, 0.2), 5), BoxRegion(dimensions=(3, 4, 5), position=(1, r, 0))
class Car:
    weight: 7 * self.width
    allowCollisions: True
    def twice(self, number=1): return 2 * self.width + number
    @property
    def mass(self): return self.weight + self.tag[0]
    @staticmethod
    def best(): return r
    @classmethod
    def named(cls): return (cls.__name__, r)
thing = new Car at (r, 2 * r, 0.1), facing r, with width 1 + r, with length 2, with height 3 * r, with name "mine", with tag [r, "a"]
other = new Car at (2, 2, 0), facing 0.5, with width 2 * r, with viewAngle 90 deg, with visibleDistance 4, with tag (r, thing)
p = new OrientedPoint at (r, -3), facing 0.3 + r, with viewAngles (r, 1)
q = new Point at (r, -4)
ego = thing
"""

OF_OBJECTS = (
    "{o}.hw, {o}.hl, {o}.hh, {o}.radius, {o}.inradius, {o}.planarInradius",
    "{o}.corners",
    "{o}.boundingBox.position, {o}.boundingBox.dimensions",
    "{o}.distanceTo((3, 1, 2)), {o}.occupiedSpace.distanceTo((3, 1))",
    "{o}.containsPoint((0.5, 0.9, 0.1)), {o}.containsPoint((2, 2.2))",
    "{o}.intersects(thing), {o}.intersects(other), {o}.intersects(disc), {o}.intersects(room)",
    "{o}.weight, {o}.twice(), {o}.twice(number=3), {o}.mass, {o}.best(), {o}.named()",
    "{o}.velocity, {o}.speed, {o}.shape, {o}.allowCollisions, {o}.color, {o}.baseOffset, {o}.visionSensorOffset",
    *(
        f"{{o}}.{side}urface.distanceTo((1, 2, 9))"
        for side in ("topS", "bottomS", "leftS", "rightS", "frontS", "backS", "s", "onS")
    ),
    *("{o}." + side for side in SIDES),
)
OF_ORIENTED = (
    "{o}.heading, {o}.yaw, {o}.pitch, {o}.roll, {o}.orientation, {o}.parentOrientation",
    "{o}.toHeading(), {o}.toOrientation(), {o}.viewAngle, {o}.viewAngles",
    "{o}.relativePosition((1, 2, 3)), {o}.relativize((1, 2)), {o}.distancePast((1, 2, 0))",
)
OF_POINTS = (
    "{o}.position, {o}.toVector(), {o}.width, {o}.visibleDistance",
    "{o}.x, {o}.y, {o}.z, {o}.norm(), {o}.dot((1, 2, 3)), {o}.angleTo((5, 6)), {o}.offsetRadially(2, 0.5)",
    "{o}.coordinates, {o}.position.distanceTo(other), {o}.position.altitudeTo((1, 2, 3)), {o}.position.angleWith((-1, 2))",
    "{o}.position + (1, 2), (1, 2, 3) - {o}.position, {o}.position * 2, {o}.position / 3, -{o}.position, {o}.position[1:], {o}.position[-1]",
    "{o}.visibleRegion.containsPoint((1, 2)), {o}.canSee((1, 2, 0)), {o}.canSee(other), {o}.canSee(thing, [other])",
    "{o}.position.rotatedBy(r), {o}.position.offsetRotated(thing.orientation, (1, 2, 3)), {o}.position.sphericalCoordinates()",
)
OF_OTHERS = (
    "thing.orientation * other.orientation, thing.orientation * (1, 2, 3), 0.5 + p.orientation, p.orientation + (0.1, 0.2, 0.3)",
    "p.orientation.inverse, p.orientation.q, p.orientation.eulerAngles, thing.orientation.localAnglesFor(p.orientation)",
    "disc.containsPoint(thing.position), room.containsPoint(q), room.distanceTo(other.position)",
    "other.tag[0], thing.name, thing.tag",
)
QUESTIONS = [
    *(
        text.replace("{o}", name)
        for name in ("thing", "other")
        for text in (*OF_OBJECTS, *OF_ORIENTED, *OF_POINTS)
    ),
    *(text.replace("{o}", "p") for text in (*OF_ORIENTED, *OF_POINTS)),
    *(text.replace("{o}", "q") for text in OF_POINTS),
    *OF_OTHERS,
]
OF_CHOICES: dict[str, Callable[[dict[str, Any]], Any]] = {
    "front of thing": lambda held: held["thing"].front,
    "distance from thing to other": lambda held: (held["thing"].position - held["other"].position).norm(),
    "distance from room to p": lambda held: held["room"].distanceTo(held["p"].position),
    "thing intersects other": lambda held: held["thing"].intersects(held["other"]),
    "relative heading of p from thing": lambda held: angle(held["p"].heading - held["thing"].heading),
    "(1, 2, 3) relative to p": lambda held: held["p"].relativize((1, 2, 3)),
    "thing offset by (1, 2, 3)": lambda held: held["thing"].relativize((1, 2, 3)),
    "q.position offset along thing by (1, 2)": lambda held: (
        held["q"].position + Vector(1, 2).rotatedBy(held["thing"].orientation)
    ),
    "distance past q of thing": lambda held: held["thing"].distancePast(held["q"].position),
}
"""What operators of the language say of choices, by what methods say of instances."""

NAMES = "thing, other, p, q, disc, room, r"


def angle(value: float) -> float:
    return math.remainder(value, math.tau)


def assert_same(one: Any, other: Any, question: str) -> None:
    if isinstance(one, Vector | tuple | list):
        assert type(one) is type(other), question
        for first, second in zip(one, other, strict=True):
            assert_same(first, second, question)
    elif isinstance(one, Orientation):
        assert one.approxEq(other), question
    elif isinstance(one, Point):
        assert type(one).__name__ == type(other).__name__, question
        assert_same(one.position, other.position, question)
        if isinstance(one, OrientedPoint):
            assert_same(one.orientation, other.orientation, question)
    elif is_number(one):
        assert type(one) is type(other), question
        assert math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-9), (question, one, other)
    else:
        assert repr(one) == repr(other), question


def again(objects: dict[str, Any], how: Callable[[Any], Any]) -> dict[str, Any]:
    """Copies of all of them together, so that those which know each other still do."""
    return {**objects, **how({name: objects[name] for name in ("thing", "other", "p", "q")})}


@pytest.mark.parametrize("mode_2d", [False, True])
def test_everything_that_is_asked_of_values_has_one_answer(mode_2d: bool) -> None:
    program = (
        PROGRAM
        if mode_2d
        else PROGRAM.replace("facing r,", "facing (r, 0.2, -r),").replace(
            "facing 0.5,", "facing (0.5, -0.3, 0.2),"
        )
    )
    asked = ", ".join(f"({question})" for question in QUESTIONS)
    one = scene(
        f"{program}def ask({NAMES}): return [{asked}]\n"
        f"param now = [{asked}], given = ({NAMES}), called = distributionFunction(ask)({NAMES})\n"
        f"record initial ask({NAMES}) as found\n",
        seed=3,
        mode2D=mode_2d,
    )
    objects = dict(zip(NAMES.split(", "), one.params["given"], strict=True))
    done = DummySimulator().simulate(one, maxSteps=1)
    assert done is not None
    holders = {
        "sampled": objects,
        "copied": again(objects, lambda held: {name: copy.copy(item) for name, item in held.items()}),
        "deep": again(objects, copy.deepcopy),
        "pickled": again(objects, lambda held: pickle.loads(pickle.dumps(held))),
    }
    for number, (question, expected) in enumerate(zip(QUESTIONS, one.params["now"], strict=True)):
        answers = {"called": one.params["called"][number], "simulated": done.records["found"][number]}
        for way, held in holders.items():
            if way != "pickled" or "twice" not in question:  # their class is left behind
                answers[way] = eval(question, held)
        for way, answer in answers.items():
            assert_same(expected, answer, f"{way}: {question}")


@pytest.mark.parametrize("mode_2d", [False, True])
def test_a_choice_answers_as_the_mutated_instance_that_it_draws(mode_2d: bool) -> None:
    """Whatever it is asked for, before the noise is known."""
    chosen = "thing, other, p, q = (Uniform(each, each) for each in (thing, other, p, q))"
    questions = [*QUESTIONS, *OF_CHOICES]
    one = scene(
        f"{PROGRAM}items = thing, other, p, q\n{chosen}\nparam now = [{', '.join(f'({question})' for question in questions)}]\n"
        f"param given = ({NAMES})\nmutate\n",
        seed=5,
        mode2D=mode_2d,
    )
    objects = dict(zip(NAMES.split(", "), one.params["given"], strict=True))
    assert objects["thing"] is one.objects[0]
    assert one.objects[0].position.x > one.params["given"][-1] + 0.01
    for question, found in zip(questions, one.params["now"], strict=True):
        if question not in OF_CHOICES:
            assert_same(eval(question, objects), found, question)
    for question, answer in zip(OF_CHOICES, one.params["now"][len(QUESTIONS) :], strict=True):
        assert_same(OF_CHOICES[question](objects), answer, question)
