"""Noise on mutated objects (section 10.5 of the specification)."""

import math
from itertools import permutations

import numpy as np
import pytest
from scipy import stats

from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.runtime.instances.mutators import OrientationMutator, PositionMutator
from scenic.runtime.values.values import Vector
from scenic.simulators.dummy import DummySimulator
from tests.runtime.programs import (
    FALSE_ALARM,
    assert_same_rotation,
    draws,
    euler,
    failure,
    place,
    scenario,
    scene,
    thing,
)

N = 3000


def normal(values: object, deviation: float, mean: float = 0) -> bool:
    return bool(stats.kstest(values, stats.norm(mean, deviation).cdf).pvalue > FALSE_ALARM)


@pytest.mark.parametrize("how", ["\nmutate", "\nmutate ego", "\nmutate ego by 1", ", with mutationScale 1"])
def test_position_and_yaw_get_normal_noise(how: str) -> None:
    scenes = scenario(f"ego = new Object at (1, 2, 3), facing 0.5{how}\n").sample(N, seed=3)
    places = np.array([tuple(item.egoObject.position) for item in scenes])
    assert normal(places[:, 0], 1, 1)
    assert normal(places[:, 1], 1, 2)
    assert (places[:, 2] == 3).all()
    assert normal([item.egoObject.heading for item in scenes], math.radians(5), 0.5)


def test_the_scale_and_the_deviations_count() -> None:
    text = "ego = new Object with positionStdDev (0.1, 0, 0.2), with orientationStdDev (0.01, 0.02, 0.03)\nmutate ego by 3\n"
    scenes = scenario(text).sample(N, seed=4)
    egos = [item.egoObject for item in scenes]
    assert normal([ego.position.x for ego in egos], 0.3)
    assert {ego.position.y for ego in egos} == {0.0}
    assert normal([ego.position.z for ego in egos], 0.6)
    for name, deviation in (("yaw", 0.03), ("pitch", 0.06), ("roll", 0.09)):
        assert normal([getattr(ego, name) for ego in egos], deviation)


def test_a_scale_of_either_sign_makes_noise() -> None:
    scenes = scenario("ego = new Object\nmutate ego by -2\n").sample(N, seed=6)
    assert normal([item.egoObject.position.x for item in scenes], 2)


def test_final_properties_follow_and_others_stay() -> None:
    item = thing("ego = new Object at (1, 2), with tag 7, with speed 2\nmutate ego\n")
    assert item.position.x != 1
    assert item.heading == item.orientation.yaw == pytest.approx(item.yaw)
    assert item.tag == 7
    assert tuple(item.velocity) == pytest.approx((0, 2, 0))


@pytest.mark.parametrize("names", list(permutations("abc")))
def test_what_follows_from_others_does_so_in_turn(names: tuple[str, str, str]) -> None:
    """Whatever the names and the order of definitions: after mutation, and at each step of a simulation."""
    first, second, third = names
    lines = (
        f"    {third}[dynamic, final]: self.{second} + 1\n",
        f"    {second}[dynamic, final]: self.{first} * 2 + self.heading\n",
        f"    {first}[dynamic, final]: self.position.y\n",
    )
    for definitions in (lines, lines[::-1]):
        text = f"class A:\n{''.join(definitions)}ego = new A at (5, 0), facing 1\nmutate\nrecord ego.{third} as end\n"
        item = scene(text)
        ego = item.egoObject
        assert getattr(ego, third) == ego.position.y * 2 + ego.orientation.yaw + 1
        done = DummySimulator(drift=3).simulate(item, maxSteps=2)
        assert done is not None
        found = [value for _, value in done.records["end"]]
        assert found == [state[0].y * 2 + ego.orientation.yaw + 1 for state in done.trajectory]


def test_requirements_see_the_noise_wherever_they_stand_and_captured_values_do_not() -> None:
    text = (
        "ego = new Object at (0, 0)\nold = ego.position.x\nrequire ego.position.x > 0.5\n"
        "require all(distance from o to (0, 0) < 2 for o in [ego])\nrequire old == 0\nmutate ego\nparam x = old\n"
    )
    for item in scenario(text).sample(50, seed=2):
        assert item.egoObject.position.x > 0.5
        assert math.hypot(*tuple(item.egoObject.position)[:2]) < 2
        assert item.params["x"] == 0


def test_requirements_keep_the_values_and_the_ego_of_their_moment() -> None:
    text = (
        "a = new Object at (Range(0, 1), 0)\nb = new Object at (9, 9)\nego = a\nlimit = 0.5\n"
        "require (distance to (0, 0)) + 0 * a.position.y > limit if limit < 1 else False\n"
        "ego = b\nlimit = 100\nmutate b\n"
    )
    for item in scenario(text).sample(20, seed=2):
        assert item.objects[1].position.x > 0.5


def test_requirements_keep_the_global_names_of_their_moment() -> None:
    """Also those that functions read which are called on samples."""
    text = (
        "limit = 0\ndef low(value):\n    if value < limit:\n        return True\n    return False\n"
        "ego = new Object\nrequire low(ego.position.x)\nlimit = 100\nmutate ego\n"
    )
    assert max(item.egoObject.position.x for item in scenario(text).sample(50, seed=1)) < 0


def test_points_are_mutated_too() -> None:
    values = draws(
        "p = new OrientedPoint at (4, 5)\nmutate p\nparam x = (p.position.x, p.heading)\nparam p = p", n=3
    )
    assert values == [(4, 0)] * 3
    found = draws("p = new OrientedPoint at (4, 5)\nmutate p\nparam p = p", "p", n=N)
    assert normal([p.position.x for p in found], 1, 4)
    assert normal([p.heading for p in found], math.radians(5))


def test_a_random_scale() -> None:
    values = [
        item.egoObject
        for item in scenario("ego = new Object with mutationScale Uniform(0, 2)\n").sample(N, seed=5)
    ]
    still = [ego for ego in values if ego.mutationScale == 0]
    assert {ego.position.x for ego in still} == {0.0}
    assert normal([ego.position.x for ego in values if ego.mutationScale == 2], 2)


CUSTOM = """
import random
class Shift(Mutator):
    def __init__(self, length, go_on=True):
        self.length, self.go_on = length, go_on
    def appliedTo(self, thing):
        thing.position = thing.position + (self.length * thing.mutationScale, 0, 10)
        thing.tag = thing.tag + 1
        return thing, self.go_on
class C:
    tag: 0
    mutator[additive]: Shift(2{go_on})
class D(C):
    mutator[additive]: None
"""


@pytest.mark.parametrize("cls", ["C", "D"])
def test_mutators_of_the_program_come_first(cls: str) -> None:
    text = CUSTOM.format(go_on="") + f"ego = new {cls} at (Range(1, 2), 0), facing 0.5\nmutate ego by 3\n"
    egos = [item.egoObject for item in scenario(text).sample(300, seed=1)]
    assert {ego.tag for ego in egos} == {1}
    assert {ego.position.z for ego in egos} == {10.0}
    spread = np.array([ego.position.x for ego in egos]) - 6
    assert (
        stats.kstest(
            spread, lambda x: np.mean(stats.norm(np.linspace(1, 2, 200), 3).cdf(np.asarray(x)[..., None]), -1)
        ).pvalue
        > FALSE_ALARM
    )
    assert normal([ego.heading - 0.5 for ego in egos], 3 * math.radians(5))
    for ego in egos[:5]:
        assert_same_rotation(ego.orientation, euler(ego.yaw))


def test_beside_mutators_of_the_program_each_angle_has_its_own_noise() -> None:
    """The built-in mutators, too, are then called on each sample."""
    text = (
        CUSTOM.format(go_on="")
        + "ego = new C with orientationStdDev ({}), with positionStdDev (0, 0, 0)\nmutate ego\n"
    )
    for axis, name in enumerate(("yaw", "pitch", "roll")):
        deviations = ", ".join("0.2" if number == axis else "0" for number in range(3))
        egos = [item.egoObject for item in scenario(text.format(deviations)).sample(200, seed=1)]
        assert normal([getattr(ego, name) for ego in egos], 0.2)
        for other in {"yaw", "pitch", "roll"} - {name}:
            assert {getattr(ego, other) for ego in egos} == {0}


def test_a_mutator_may_stop_the_others() -> None:
    text = (
        CUSTOM.format(go_on=", False")
        + "ego = new C at (1, 0)\nmutate ego by 3\nrequire ego.position.x > 6.5\n"
    )
    assert {item.egoObject.position.x for item in scenario(text).sample(5, seed=1)} == {7.0}


def test_beside_mutators_of_the_program_deviations_may_be_random_and_scales_negative() -> None:
    text = CUSTOM.format(go_on="") + (
        "ego = new C with positionStdDev (Range(1, 3), 0, 0), with orientationStdDev (0, 0, 0)\nmutate ego by -3\n"
    )
    egos = [item.egoObject for item in scenario(text).sample(300, seed=1)]
    deviations = np.array([ego.positionStdDev.x for ego in egos])
    assert stats.kstest(deviations, stats.uniform(1, 2).cdf).pvalue > FALSE_ALARM
    noise = (np.array([ego.position.x for ego in egos]) + 2 * 3) / deviations
    assert normal(noise, 3)
    assert stats.spearmanr(np.abs(noise), deviations).pvalue > FALSE_ALARM
    assert {ego.tag for ego in egos} == {1}


def test_mutators_of_equal_deviations_are_equal() -> None:
    one, same, other = (
        PositionMutator((1, 2, 3)),
        PositionMutator(Vector(1, 2, 3)),
        PositionMutator((1, 2, 4)),
    )
    assert one == same
    assert hash(one) == hash(same)
    assert one != other
    assert one != OrientationMutator((1, 2, 3))


def test_a_mutator_may_give_a_copy_with_other_values() -> None:
    text = (
        "from scenic.simulators.utils.colors import Color, ColorMutator\n"
        "class Moved(Mutator):\n    def appliedTo(self, thing):\n"
        "        return thing._copyWith(position=thing.position + (1, 0, 0), width=2), False\n"
        "class Thing(Object):\n    mutator[additive]: Moved()\nego = new Thing at (Range(4, 5), 0)\nmutate ego\n"
        "class Painted(Object):\n    color: Color(0.5, 0.5, 0.5)\n    mutator[additive]: ColorMutator()\n"
        "painted = new Painted at (9, 9)\nmutate painted\n"
    )
    for found in scenario(text).sample(5, seed=1):
        ego, painted = found.objects
        assert 5 <= ego.position.x <= 6
        assert (ego.width, ego.occupiedSpace.dimensions.x) == (2, 2)
        assert tuple(painted.color) != (0.5, 0.5, 0.5)


@pytest.mark.parametrize("scale", ["0", "Uniform(0, 2)"])
def test_a_scale_that_is_drawn_as_zero_asks_no_mutator(scale: str) -> None:
    text = (
        "class Raised(Mutator):\n    def appliedTo(self, thing):\n        thing.width += 3\n        return thing, True\n"
        f"class Thing(Object):\n    mutator[additive]: Raised()\nego = new Thing with mutationScale {scale}\n"
    )
    found = {
        (item.egoObject.mutationScale, item.egoObject.width, item.egoObject.position.x == 0)
        for item in scenario(text).sample(30, seed=1)
    }
    assert found == {(0.0, 1.0, True), *([(2.0, 4.0, False)] if scale != "0" else [])}


def test_requirements_are_about_what_some_mutator_changed_whatever_stands_behind_it() -> None:
    text = (
        "ego = new Object at (0, 0)\nother = new Object at (9, 0), with mutator ()\nmutate ego, other by 2\n"
        "require ego.position.x > 1\n"
    )
    for item in scenario(text).sample(10, seed=1):
        assert item.egoObject.position.x > 1
        assert item.objects[1].position.x == 9


def test_mistakes_with_mutation() -> None:
    assert isinstance(failure("ego = new Object\nmutate ego by Range(1, 2)"), ScenicTypeError)
    assert isinstance(failure("ego = new Object\nx = 3\nmutate x"), ScenicTypeError)
    assert isinstance(
        failure("ego = new Object\ndef f():\n    mutate ego\nrequire f() is None"), InvalidScenarioError
    )


def test_calls_on_samples_see_what_comes_out() -> None:
    """Whether the call stands before `mutate` or after it; of a choice, of a list, of several calls in a row."""
    text = (
        "def f(o): return o.position.x\nclass A(Object):\n    def east(self): return self.position.x\n"
        "a = new A at (Range(0, 1), 0)\nb = new A at (100, 0)\nc = Uniform(a, b)\nl = Uniform([a, b], [b, a])\n"
        "i = DiscreteRange(0, 1)\ng = distributionFunction(f)\n"
        "param c = c, d = l[i], r = [g(c), g(c) + 1, c.east(), l[i].position.x, max(a, b, key=f).position.x], b = b\n"
        "{}require g(c) > 0.5\n"
    )
    for item in scenario(text.format("mutate a, b by 3\n")).sample(8, seed=1):
        x = item.params["c"].position.x
        assert item.params["r"] == [x, x + 1, x, item.params["d"].position.x, item.params["b"].position.x]
        assert x > 0.5
        assert item.params["b"].position.x != 100
    for item in scenario(text.format("")).sample(3, seed=1):
        assert item.params["b"].position.x == 100


def test_a_mutator_sees_the_instance_as_it_was() -> None:
    text = (
        "class M(Mutator):\n    def appliedTo(self, o):\n        o.position = (100 + o.position.x, 0, 0)\n"
        "        return o, False\na = new Object at (Range(0, 1), 0), with mutator M(), with mutationScale 1\n"
        "param x = a.position.x, a = a\n"
    )
    for item in scenario(text).sample(3, seed=1):
        assert item.params["a"].position.x == 100 + item.params["x"]


def test_whether_to_be_visible_may_be_drawn_without_an_ego() -> None:
    text = "seen = Uniform(True, False)\nnew Object with requireVisible seen\nparam seen = seen\n"
    assert [item.params["seen"] for item in scenario(text).sample(6, seed=1)] == [False] * 6


@pytest.mark.parametrize(
    ("text", "drawn"),
    [
        ("a.position", False),
        ("Uniform(a, a).position", True),
        ("Uniform(a, a).toVector()", True),
        ("Uniform([a], [a])[0].position", True),
        ("Uniform(a, a) offset by (0, 0, 0)", True),
        ("(relative position of Uniform(a, a) from (0, 0, 0))", True),
        ("(back of Uniform(a, a)) offset by (0, 0.5, 0)", True),
    ],
)
def test_a_choice_draws_instances_as_mutated(text: str, drawn: bool) -> None:
    program = scenario(
        f"a = new Object at (3, 4), with orientationStdDev (0, 0, 0)\nego = a\nx = {text}\nparam x = x\nmutate a"
    )
    for item in program.sample(5, seed=2):
        found = item.params["x"]
        place = tuple(getattr(found, "position", found))
        assert place == pytest.approx(tuple(item.egoObject.position) if drawn else (3, 4, 0))


@pytest.mark.parametrize("mutator", ["", "    mutator: M()\n"])
def test_a_choice_among_instances_made_of_the_same_values_draws_each_with_its_own_noise(mutator: str) -> None:
    """Of every kind: places, turns, numbers, texts."""
    text = (
        "class M(Mutator):\n    def appliedTo(self, item):\n        item.share += item.mark\n        item.word += str(item.mark)\n"
        "        item.turn = item.turn * Orientation.fromEuler(item.mark / 10, 0, 0)\n        item.position += Vector(item.mark, 0, 0)\n        return item, True\n"
        f"class A:\n    allowCollisions: True\n    mark: 0\n    share: s\n    word: w\n    turn: t\n{mutator}"
        "s, w, t, v = Range(0, 1), Uniform('a', 'b'), Orientation.fromEuler(Range(0, 1), Range(0, 1), 0), Vector(Range(0, 1), 5, 1)\n"
        "items = [new A at v, with mark number, facing t for number in (1, 2, 3)]\n"
        "c = Uniform(*items)\nmutate\n"
        "side, turned = Vector(1, 2, 3) offset along c.turn by (1, 0, 0), c.orientation * c.turn\n"
        "param x = (c.mark, c.position, c.orientation, c.share, c.word, c.turn, side, turned)\n"
    )
    seen = set()
    for item in scenario(text).sample(10, seed=3):
        mark, *found = item.params["x"]
        drawn = item.objects[mark - 1]
        *found, side, turned = found
        assert found == [drawn.position, drawn.orientation, drawn.share, drawn.word, drawn.turn]
        assert side == Vector(1, 2, 3) + Vector(1, 0, 0).rotatedBy(drawn.turn)
        assert turned == drawn.orientation * drawn.turn
        assert len({tuple(other.position) for other in item.objects}) == 3
        seen.add(mark)
    assert len(seen) > 1


@pytest.mark.parametrize("scale", [0, 1])
def test_a_choice_draws_what_mutators_of_the_program_make_of_any_property(scale: int) -> None:
    text = (
        "class M(Mutator):\n    def appliedTo(self, item):\n        item.count += 10\n        item.flag = not item.flag\n"
        "        item.share += 100\n        item.word = item.word * 2\n        return item, False\n"
        "class A:\n    count: 3\n    flag: True\n    share: Range(0, 1)\n    word: 'a'\n    mutator: M()\n"
        f"a = new A\nmutate a by {scale}\nc = Uniform(a, a)\n"
        "param x = (c.count, c.flag, c.share, c.word, c.count + c.share)\n"
    )
    drawn = scene(text)
    count, flag, share, word, total = drawn.params["x"]
    (item,) = drawn.objects
    assert (count, flag, word) == ((13, False, "aa") if scale else (3, True, "a"))
    assert type(count) is int
    assert share // 100 == scale
    assert total == count + share
    assert (count, flag, share, word) == (item.count, item.flag, item.share, item.word)


def test_what_is_specified_by_a_choice_follows_the_mutated_instance() -> None:
    text = "a = new Object at (3, 4)\nego = a\nb = new Object left of Uniform(a, a) by 1\nmutate a"
    for item in scenario(text).sample(5, seed=2):
        one, other = item.objects
        gap = tuple(p - q for p, q in zip(one.position, other.position, strict=True))
        assert sum(part * part for part in gap) == pytest.approx(4)


@pytest.mark.parametrize(
    ("property", "specifier", "statement"),
    [
        ("foo: 1", "with foo 1", "mutate a"),
        ("foo: 1", "with foo 1", "def f():\n    mutate a\nf()"),
        ("foo: 1", "with foo 1", "a.mutationScale = 1"),
        ("foo: 1", "with mutationScale 1", "pass"),
        ("mutationScale: 1", "with foo 1", "pass"),
    ],
)
def test_choices_follow_mutation_however_it_is_asked_for(
    property: str, specifier: str, statement: str
) -> None:
    text = (
        f"class A(Object):\n    {property}\na = new A at (3, 4), {specifier}\nego = a\n"
        f"param x = (a.position.x, Uniform(a, a).position.x, Uniform(a, a, a).position.x)\n{statement}\n"
    )
    for item in scenario(text).sample(5, seed=2):
        assert item.params["x"] == (3, item.egoObject.position.x, item.egoObject.position.x)
        assert item.egoObject.position.x != 3


def test_what_would_follow_its_own_noise_follows_the_value_without_it() -> None:
    text = (
        "a = new Object at (3, 4)\nb = new Object at (30, 4)\nego = a\n"
        "a.mutationScale = Uniform(a, b).position.x\nparam x = Uniform(a, a).position.x, b = b\nmutate b\n"
    )
    scenes = scenario(text).sample(8, seed=2)
    scales = [item.egoObject.mutationScale for item in scenes]
    assert all(scale in (3, item.params["b"].position.x) for scale, item in zip(scales, scenes, strict=True))
    assert 0 < scales.count(3) < 8
    assert 3 not in {item.egoObject.position.x for item in scenes}
    assert 30 not in {item.params["b"].position.x for item in scenes}


def test_a_mutator_of_the_program_may_change_what_is_final_but_not_what_follows_from_others() -> None:
    text = (
        "class M(Mutator):\n    def appliedTo(self, o):\n        o.fixed += 1\n        o.twice = 7\n        o.position = (5, 0, 0)\n"
        "        return o, True\n"
        "class A:\n    fixed[final]: 1\n    twice[dynamic, final]: 2 * self.position.x\n"
        "ego = new A with mutator M()\nmutate\n"
    )
    ego = scene(text).egoObject
    assert (ego.fixed, ego.position.x, ego.twice) == (2, 5, 10)


def test_a_mutator_that_gives_nothing_back_is_told_at_the_object() -> None:
    error = failure(
        "class M(Mutator):\n    def appliedTo(self, o):\n        o.position = (1, 2, 3)\n"
        "class A:\n    mutator: M()\nego = new Object\nx = new A at (5, 5)\nmutate x\n"
    )
    assert place(error)[:2] == ("SC404", "7:5-7:20")


def test_code_that_fails_while_an_object_is_mutated_is_told_where_it_is() -> None:
    """A final dynamic property follows what is noisy by then; the place is that of its line, not of the object."""
    error = failure(
        "class A:\n    side[dynamic, final]: 'left' if self.position.x > 2 else 'right'\n"
        "ego = new A at (3, 4)\nmutate\n"
    )
    assert place(error)[:2] == ("SC403", "2:37-2:56")


@pytest.mark.parametrize("form", ["{}", "[{}]", "({},)", "(None, {})", "[{}, None]"])
def test_one_mutator_or_several_may_be_given(form: str) -> None:
    mutators = form.format("PositionMutator((0, 0, 2))")
    text = f"from scenic.runtime.instances.mutators import PositionMutator\nego = new Object facing 0.5, with mutator {mutators}\nmutate\n"
    for item in scenario(text).sample(5, seed=1):
        x, y, z = item.egoObject.position
        assert (x, y, item.egoObject.heading) == (0, 0, pytest.approx(0.5))
        assert z != 0


def test_mutators_see_what_follows_from_the_noise_before_them() -> None:
    text = """
from scenic.runtime.instances.mutators import Mutator, OrientationMutator
class Telling(Mutator):
    def appliedTo(self, instance):
        instance.before = (instance.yaw, instance.heading, instance.orientation.yaw)
        return instance, True
ego = new Object with mutator (OrientationMutator((0.5, 0, 0)), Telling()), with before None
mutate
"""
    for item in scenario(text).sample(5, seed=1):
        yaw, heading, global_yaw = item.egoObject.before
        assert yaw != 0
        assert heading == global_yaw == pytest.approx(yaw)
        assert item.egoObject.heading == pytest.approx(yaw)


@pytest.mark.parametrize(
    ("kind", "scale", "mutator"),
    [
        *(("Object", scale, "") for scale in (-3, 0, 2)),
        *(("Object", scale, ", with mutator [None, PositionMutator((1, 0, 0))]") for scale in (-3, 0, 2)),
        ("OrientedPoint", 2, ""),
        ("Point", 3, ""),
    ],
)
def test_what_a_simulation_makes_is_mutated_by_its_scale(kind: str, scale: float, mutator: str) -> None:
    text = (
        "from scenic.runtime.instances.mutators import PositionMutator\n"
        "scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        do Sub()\n"
        f"scenario Sub():\n    setup:\n        thing = new {kind} at (50, 0){mutator}\n        mutate thing by {scale}\n"
        "        record initial thing.position as place\n    compose:\n        wait\n"
    )
    offsets, one = [], scene(text)
    for key in range(25):
        done = DummySimulator().simulate(one, maxSteps=1, key=bytes([key]))
        assert done is not None
        offsets.append(np.array(done.records["place"]) - (50, 0, 0))
    deviations = np.std(offsets, axis=0)
    wanted = np.array([1, 0 if mutator else 1, 0]) * abs(scale)
    assert (deviations[wanted == 0] == 0).all()
    assert (abs(deviations / np.where(wanted == 0, 1, wanted) - 1) < 0.5)[wanted > 0].all()


def test_points_that_a_behavior_makes_have_the_noise_that_they_ask_for() -> None:
    text = (
        "behavior B():\n    while True:\n        p = new OrientedPoint at (7, 0), with mutationScale 1\n        q = new Point at (7, 0)\n"
        "        take p.position.x, p.heading, q.position.x\nego = new Object with behavior B\n"
    )
    done = DummySimulator().simulate(scene(text), maxSteps=20)
    assert done is not None
    assert done.result is not None
    taken = [step[done.objects[0]] for step in done.result.actions]
    assert len({x for x, _, _ in taken}) == len({heading for _, heading, _ in taken}) == 20
    assert 0.4 < np.std([x for x, _, _ in taken]) < 2
    assert {x for _, _, x in taken} == {7}


@pytest.mark.parametrize(
    "body",
    [
        "thing.position = (5, 6, 1)",
        "thing.yaw, thing.roll = 0.5, 0.25",
        "thing.yaw = 7",
        "thing.position += (1, 0, 2)\n        thing.speed = 3",
        "thing.parentOrientation, thing.angularVelocity = (0.5, 0.25, 0.125), [1, 2, 3]",
        "thing.width, thing.tag = 7, thing.tag + 1",
        "thing.double = 9",
        "thing.shape = ConeShape()",
        "thing = copy.copy(thing)\n        thing.position, thing.yaw, thing.tag = (5, 6), 0.5, 4",
        "thing = copy.copy(thing)\n        thing.shape, thing.height = ConeShape(), 3",
    ],
)
def test_what_mutators_of_the_program_make_is_the_same_in_scenes_and_simulations(body: str) -> None:
    """Whether they change the instance that they are given or give another; values are normalised, and others follow."""
    classes = (
        f"import copy\nclass First(Mutator):\n    def appliedTo(self, thing):\n        {body}\n        return thing, True\n"
        "class Second(Mutator):\n    def appliedTo(self, thing):\n        thing.tag += 10 * thing.yaw + thing.width\n        return thing, False\n"
        "class A:\n    tag: 1\n    double[dynamic, final]: 2 * self.position.x\n"
        "    mutator: (None, First(), Second(), PositionMutator((1, 1, 1)))\n"
    )
    imported = "from scenic.runtime.instances.mutators import PositionMutator\n"
    made = "thing = new A at (1, 2), facing 0.1\nmutate thing\n"
    asked = [
        "position",
        "yaw",
        "pitch",
        "roll",
        "heading",
        "orientation",
        "parentOrientation",
        "angularVelocity",
        "double",
        "tag",
        "width",
        "height",
        "shape",
    ]
    drawn = thing(f"{imported}{classes}{made}")
    told = ", ".join(f"thing.{name}" for name in asked)
    one = scene(
        f"{imported}{classes}scenario Main():\n    setup:\n        ego = new Object at (50, 0)\n    compose:\n        do Sub()\n"
        f"scenario Sub():\n    setup:\n        {made.replace(chr(10), chr(10) + 8 * ' ')}record initial ({told}) as all\n"
        "    compose:\n        wait\n"
    )
    done = DummySimulator().simulate(one, maxSteps=1)
    assert done is not None
    for name, found in zip(asked, done.records["all"], strict=True):
        expected = getattr(drawn, name)
        assert type(found) is type(expected), name
        assert (repr(found) if name == "shape" else found) == (
            repr(expected) if name == "shape" else expected
        ), name


def test_mutators_may_change_what_a_specifier_has_made() -> None:
    text = """
from scenic.runtime.instances.mutators import Mutator
class Doubling(Mutator):
    def appliedTo(self, instance):
        instance.load, instance.worth = 2 * instance.load, instance.worth + 1
        return instance, True
class Car:
    worth: 1
ego = new Car with mutator Doubling(), with load Range(1, 2)
x = ego.load
mutate
require ego.load > 3
param x = x
"""
    for item in scenario(text).sample(5, seed=1):
        assert item.egoObject.load == 2 * item.params["x"] > 3
        assert item.egoObject.worth == 2


def test_what_decides_a_noise_does_not_wait_for_it() -> None:
    """The noise of an object that, by now, can be reached from one that a call has been given."""
    text = (
        "asked = distributionFunction(lambda thing, x: 1 + thing.position.x + x)\nx = Range(0, 1)\n"
        "ego = new Object at (Range(5, 6), 0)\nscale = asked(ego, x)\n"
        "other = new Object at (90, 90), with mutationScale scale\nego.friend = other\n"
        "mutate ego\nparam x = x, scale = scale\n"
    )
    for program, moved in ((text.replace("mutate ego\n", ""), False), (text, True)):
        for found in scenario(program).sample(3, seed=2):
            ego, other = found.objects
            assert ego.friend is other
            assert found.params["scale"] == other.mutationScale == 1 + ego.x + found.params["x"]
            assert other.x != 90
            assert (5 < ego.x < 6 and ego.y == 0) is not moved


def test_a_noise_that_would_decide_itself_is_told() -> None:
    text = (
        "asked = distributionFunction(lambda thing, x: thing.position.x + x)\n"
        "ego = new Object at (Range(5, 6), 0)\nego.mutationScale = asked(ego, Range(0, 1))\n"
    )
    error = failure(text)
    assert isinstance(error, InvalidScenarioError)
    assert "decides how an object is mutated" in str(error)
    assert place(error)[1].startswith("3:")
    scenario(text.replace("asked(ego", "asked(new Object at ego offset by (9, 9)")).sample(2)
