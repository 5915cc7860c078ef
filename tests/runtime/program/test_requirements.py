"""Requirements: what they mean however they are written, when names are bound, faults, soft ones; the built-in ones."""

import itertools
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

import scenic
from scenic.graph.batch import Batch
from scenic.language.errors import (
    InvalidScenarioError,
    RandomControlFlowError,
    RejectionException,
    ScenicTypeError,
)
from scenic.runtime.sampling.engine import _attempts
from scenic.runtime.sampling.pending import SceneTask
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.values.values import as_node
from tests.runtime.programs import FALSE_ALARM, draws, failure, fingerprint, place, scenario

SETTING = (
    "ego = new Object at (Range(-2, 2), Range(-2, 2)), facing Range(0, 3), with width Range(1, 2), with foo Range(0, 1),"
    " with allowCollisions True\n"
    "other = new Object at (Range(-2, 2), Range(-2, 2)), with tag Uniform('a', 'b'), with allowCollisions True\n"
    "disc = CircularRegion((0, 0), 1.5)\nx = Range(0, 1)\nn = DiscreteRange(0, 5)\nxs = Uniform([1, 2], [3, 4, 5])\n"
    "either = Uniform(ego, other)\nlimit = 0.6\nparam x = x, n = n, xs = xs\n"
    "def same(v): return v\n"
    "def nearest(v): return ego if v < limit else other\n"
    "class Judge(object):\n    def likes(self, v): return type(v) is float and v < 0.5\njudge = Judge()\n"
)
CONDITIONS = [
    "x < 0.5",
    "0.2 < x <= limit",
    "x < 0.3 or x > 0.7",
    "x < 0.7 and ego.position.x > 0",
    "not x < 0.5",
    "not (x < 0.5 and n > 2)",
    "(x < 0.5) == (n > 2)",
    "x * n + 1 > ego.width ** 2",
    "n % 2 == 0",
    "n // 2 == 1 and n in [2, 3, 4]",
    "abs(ego.x - other.x) > 0.5",
    "max(x, ego.foo, 0.4) < 0.8",
    "(distance from ego to other) < 2",
    "(distance to other) < 2 and (angle to other) > 0",
    "(relative heading of other) < -1",
    "(apparent heading of other) < 1",
    "(distance past other) > 0",
    "ego in disc",
    "ego.position in disc",
    "other.position not in disc",
    "ego intersects other",
    "not (ego intersects other)",
    "(front of ego).position.x > 0",
    "xs[0] > 2",
    "len(xs) == 2",
    "either.position.x > 0",
    "either is ego",
    "other.tag == 'a'",
    "other.tag in ('a', 'c')",
    "(x if n > 2 else 1 - x) < 0.5",
    "ego.position.distanceTo(other.position) < 2",
    "ego.distanceTo(other) < 2",
    "round(x * 4) == 2 and int(x * 10) != 5 and float(n) > 1",
    "x < 0.5 implies n > 2",
    "n - 1",
    "n and xs[0] > 2",
    "(n or 5) > 3",
    "(3 and n) == 2",
    "(x > 0.5 or n) == 1",
    "(x, n) > (0.5, 2)",
    "[i for i in xs if i > n]",
    "(lambda v: v < x)(0.5)",
    "any(i == n for i in xs)",
    "(y := x + 1) > 1.5 and y < 1.8",
    "f'{n}' == '3'",
    "{1: x, 2: n}[1] < 0.5",
    "ego.orientation.yaw > 1",
    "ego.yaw > 1 and ego.heading > 1",
    "(relative position of other)[0] > 0",
    "ego.corners[0].x > other.corners[1].x",
    "other.position == other.position and ego != either",
    "either == other",
    "ego == either or ego == other",
    "not (ego == other) and either != other",
    "(x if limit > 0.5 else 1 - x) < 0.5",
    "(x if limit < 0.5 else 1 - x) < 0.4",
    "(x < 0.5 if n > 2 else n)",
    "(x > 0.5 or n > 2) == (ego.foo > 0.5)",
    "(not (x > 0.5 or n > 3)) == (ego.foo > 0.5 and n < 3)",
    "(x > 0.5 and n) == 1",
    "[1, 2, 2].count(n) == 2",
    "'a-b'.find(other.tag) == 2",
    "{1: 2}.get(n, 0) == 2",
    "nearest(x) == ego",
    "ego == nearest(x)",
    "other != nearest(x) and nearest(x) in (3, ego)",
    "nearest(x) == nearest(ego.foo)",
    "nearest(x).position.x > 0",
    "judge.likes(x)",
    "not judge.likes(ego.foo)",
]


def unpruned(folder: Path, text: str) -> Any:
    """A scenario that is sampled from the whole cube, whatever analysis knows of its requirements."""
    program = folder / "program.scenic"
    program.write_text(text)
    return scenic.load(program, prune=False)


@pytest.mark.parametrize("condition", CONDITIONS)
def test_a_condition_means_the_same_however_it_is_written(condition: str, tmp_path: Path) -> None:
    ways = [f"require {condition}\n"]
    if "implies" not in condition:
        ways += [
            f"require same({condition})\n",
            f"def check():\n    return {condition}\nrequire check()\n",
            f"def make(other, x, n, xs, either):\n    return lambda: ({condition})\nf = make(other, x, n, xs, either)\nrequire f()\n",
        ]
    if ":=" in condition:
        ways = ways[:2]
    scenes = [unpruned(tmp_path, SETTING + way).sample(12, seed=6, lanes=32) for way in ways]
    prints = [[fingerprint(scene) for scene in items] for items in scenes]
    attempts = [scene.attempts for scene in scenes[0]]
    assert max(attempts) > 1, "the condition rejects nothing"
    for way, found in zip(ways, prints, strict=True):
        assert found == prints[0], way


@pytest.mark.parametrize(
    ("name", "body", "condition"),
    [
        ("abs", "-v", "abs(x) < -0.5"),
        ("max", "min(v, *w)", "max(x, 0.5) == 0.5"),
        ("round", "v", "round(x) > 0.5"),
        ("min", "max(v, *w)", "min(x, 0.5) > 0.5"),
        ("len", "x", "len('a') > 0.5"),
        ("sin", "v", "sin(x) > 0.5"),
    ],
)
def test_functions_of_the_programs_own_count_whatever_their_names_usually_mean(
    name: str, body: str, condition: str
) -> None:
    """Defined by the program, or bound within a function that makes the requirement."""
    head = "from math import sin\nx = Range(0, 1)\nparam x = x\n"
    for text in (
        f"{head}def {name}(v, *w): return {body}\nrequire {condition}\n",
        f"{head}{name} = lambda v, *w: {body}\nrequire {condition}\n",
        f"{head}def made({name}):\n    require {condition}\nmade(lambda v, *w: {body})\n",
    ):
        values = [scene.params["x"] for scene in scenario(text).sample(40, seed=0)]
        assert 0.5 < min(values) < 0.6
        assert max(values) > 0.9


def test_random_branches_are_fine_in_functions_of_conditions() -> None:
    text = "x = Range(0, 1)\ndef f(v):\n    if v < 0.5:\n        return v > 0.25\n    return v < 0.75\nrequire f(x)\nparam x = x"
    values = draws(text, n=1000)
    assert stats.kstest(values, stats.uniform(0.25, 0.5).cdf).pvalue > FALSE_ALARM


# Names are those of the moment at which the statement ran


@pytest.mark.parametrize("read", ["x", "same(x)", "f()", "g()", "(lambda: x)()"])
def test_names_are_bound_when_the_statement_runs(read: str) -> None:
    text = (
        "def same(v): return v\nx = Range(0, 1)\ndef f(): return x\ndef g(): return f()\n"
        f"require {read} < 0.5\nparam first = x\nx = Range(5, 6)\nrequire {read} > 5.5\nparam second = x\nx = None\n"
    )
    for scene in scenario(text).sample(20, seed=1):
        assert scene.params["first"] < 0.5
        assert scene.params["second"] > 5.5


def test_definite_names_too() -> None:
    text = "y = 3\ndef f(): return y\nrequire f() == 3 and y == 3\ny = 4\nrequire f() == 4 and y == 4\n"
    scenario(text).sample(1, seed=0)


def test_loops_and_closures() -> None:
    text = (
        "xs = [Range(0, 1) for i in range(3)]\nfor i, x in enumerate(xs):\n    require x > i / 4\n"
        "def low(v, limit):\n    require v < limit\nfor x in xs:\n    low(x, 0.9)\nparam x = tuple(xs)\n"
    )
    for first, second, third in draws(text, n=20):
        assert 0 < first < 0.9
        assert 0.25 < second < 0.9
        assert 0.5 < third < 0.9


@pytest.mark.parametrize("read", ["ego.x", "same(ego.x)", "of_ego()", "(distance to (0, 0))", "far()"])
def test_the_ego_is_that_of_the_moment(read: str) -> None:
    text = (
        "def same(v): return v\ndef of_ego(): return ego.x\ndef far(): return distance to (0, 0)\n"
        "ego = new Object at (Range(0, 10), 0)\nfirst = ego\n"
        f"require {read} < 2\nego = new Object at (Range(20, 30), 0)\nrequire {read} > 28\nego = first\n"
    )
    for scene in scenario(text).sample(10, seed=1):
        assert scene.egoObject.x < 2
        assert scene.objects[1].x > 28


@pytest.mark.parametrize(
    "read", ["workspace", "same(workspace)", "space()", "again()", "(lambda: workspace)()"]
)
def test_the_workspace_is_that_of_the_moment(read: str) -> None:
    text = (
        "def same(v): return v\ndef space(): return workspace\ndef again(): return space()\n"
        "workspace = Workspace(BoxRegion((20, 20, 20)))\nx = Range(0, 20)\n"
        f"require Vector(x, 0, 0) not in {read}\nworkspace = Workspace(BoxRegion((30, 30, 30)))\n"
        f"require Vector(x, 0, 0) in {read}\nworkspace = Workspace(everywhere)\nparam x = x\n"
    )
    values = [scene.params["x"] for scene in scenario(text).sample(50, seed=1, max_attempts=400)]
    assert min(values) > 10
    assert max(values) < 15


def test_functions_that_call_each_other() -> None:
    text = (
        "def even(n): return n < y or odd(n - 2)\ndef odd(n): return not (n < y) and even(n - 2)\n"
        "y = DiscreteRange(0, 5)\nparam x = y\n"
    )
    expected = set()
    for y in range(6):

        def even(n: int, y: int = y) -> bool:
            return n < y or odd(n - 2)

        def odd(n: int, y: int = y) -> bool:
            return n >= y and even(n - 2, y)

        try:
            if even(7):
                expected.add(y)
        except RecursionError:
            pass
    assert set(draws(text + "require y > 0\nrequire even(7)", n=100)) == expected - {0}


def test_methods_see_sampled_names() -> None:
    text = (
        "limit = Range(0, 1)\nclass Car:\n    speed2: Range(0, 1)\n    def slow(self): return self.speed2 < limit and self.known()\n"
        "    def known(self): return car is self\ncar = new Car\nrequire car.slow()\nparam x = (car.speed2, limit)\n"
    )
    assert all(speed < limit for speed, limit in draws(text, n=30))


@pytest.mark.parametrize(
    "body",
    [
        "    class Inner:\n        value = r\n    return Inner.value",
        "    class Inner:\n        value = [r, r][0]\n        class Deep:\n            value = r\n    return Inner.Deep.value",
        "    return (lambda: [r for _ in range(2)][0])()",
        "    def inner(): return r\n    return inner()",
        "    def inner(value=r): return value\n    return inner()",
        "    return next(r for _ in range(2))",
        "    try:\n        return r\n    finally:\n        pass",
    ],
)
def test_names_in_nested_code_of_functions_are_those_of_the_sample(body: str) -> None:
    text = f"r = Range(0, 1)\ndef f():\n{body}\nrequire f() < 0.3\nparam x = r\n"
    found = scenario(text).sample(10, seed=1)
    assert all(type(scene.params["x"]) is float and scene.params["x"] < 0.3 for scene in found)


@pytest.mark.parametrize(
    ("method", "use"),
    [
        ("distanceTo(self, other)", "ego.distanceTo(p) < 50"),
        ("distancePast(self, other)", "ego.distancePast(p) < 50"),
        ("relativePosition(self, other)", "ego.relativePosition(p) < 50"),
        ("containsPoint(self, other)", "ego.containsPoint(p) < 50"),
        ("intersects(self, other)", "ego.intersects(p) < 50"),
        ("canSee(self, other)", "ego.canSee(p) < 50"),
    ],
)
def test_methods_that_a_class_overrides_are_called_on_samples(method: str, use: str) -> None:
    text = (
        f"class Car:\n    def {method}: return 1 if type(other.position.x) is float else 100\n"
        f"ego = new Car at (Range(0, 5), 0)\np = new Object at (Range(10, 15), 30)\nrequire {use}\n"
    )
    assert len(scenario(text).sample(2, seed=1, max_attempts=20)) == 2


@pytest.mark.parametrize(
    "condition", ["car == 3", "3 == car", "not car != 3", "car > 2", "2 < car", "car >= 3 and 3 <= car"]
)
def test_what_a_class_says_of_comparisons_is_asked_of_samples(condition: str) -> None:
    text = (
        "class Car:\n    tag: DiscreteRange(1, 3)\n"
        "    def __eq__(self, other): return self.tag == other\n    def __hash__(self): return id(self)\n"
        "    def __gt__(self, other): return True if self.tag > other else False\n"
        "    def __ge__(self, other): return True if self.tag >= other else False\n"
        f"car = new Car\nego = car\nrequire {condition}\n"
    )
    assert {item.egoObject.tag for item in scenario(text).sample(8, seed=1)} == {3}


def test_points_may_be_made_in_conditions() -> None:
    text = (
        "ego = new Object at (Range(0, 1), 0)\ndef f():\n    p = new OrientedPoint at (3, 0)\n"
        "    return (distance from p to ego) < 2.5\nrequire f()\n"
    )
    program = scenario(text)
    before = len(program._program.instances)
    assert all(scene.egoObject.x > 0.5 for scene in program.sample(10, seed=0))
    assert len(program._program.instances) == before


# Soft requirements


def test_soft_requirements_hold_with_their_probability() -> None:
    values = draws("x = Range(0, 1)\nrequire[0.6] x < 0.5\nparam x = x", n=4000)
    # Active with probability 0.6; otherwise it holds by chance half of the time.
    low = sum(value < 0.5 for value in values)
    assert stats.binomtest(low, 4000, 0.6 + 0.4 / 2).pvalue > FALSE_ALARM


def test_soft_requirements_are_drawn_once_a_scene_and_apart() -> None:
    text = (
        "x, y = Range(0, 1), Range(0, 1)\nrequire[0.5] x < 0.05\nrequire[0.5] y < 0.05\nrequire[0] x > 2\n"
        "require[1] x < 0.9\nparam x = (x, y)\n"
    )
    values = np.array(draws(text, n=600))
    counts = [
        int(np.sum(((values < 0.05) == case).all(axis=1)))
        for case in itertools.product([True, False], repeat=2)
    ]
    active = 0.5
    x_by_chance, y_by_chance = 0.05 / 0.9, 0.05
    px, py = active + (1 - active) * x_by_chance, active + (1 - active) * y_by_chance
    expected = [600 * p for p in (px * py, px * (1 - py), (1 - px) * py, (1 - px) * (1 - py))]
    assert stats.chisquare(counts, expected).pvalue > FALSE_ALARM
    assert (values[:, 0] < 0.9).all()


# Faults


@pytest.mark.parametrize("lanes", [1, 7, 512])
@pytest.mark.parametrize("opaque", [False, True])
def test_a_fault_counts_only_if_no_requirement_rejects(lanes: int, opaque: bool) -> None:
    wrap = "same({})" if opaque else "{}"
    inverse = wrap.format("1 / (n - 2)") + " < 9"
    text = "n = DiscreteRange(0, 4)\ndef same(v): return v\nparam x = n\n"
    guard = wrap.format("n != 2")
    for order in ((guard, inverse), (inverse, guard)):
        guarded = scenario(text + "".join(f"require {condition}\n" for condition in order))
        assert {scene.params["x"] for scene in guarded.sample(60, seed=0, lanes=lanes)} == {0, 1, 3, 4}
    alone = scenario(text + f"require {inverse}\nrequire {wrap.format('n != 3')}\n")
    with pytest.raises(ZeroDivisionError) as caught:
        alone.sample(60, seed=0, lanes=lanes)
    assert caught.value.__notes__[0].startswith(
        "<string>:4:1: requirement on line 4 failed: ZeroDivisionError"
    )


def test_scenes_before_the_fault_come_out_whatever_the_batch() -> None:
    text = "n = DiscreteRange(0, 30)\nparam x = n\nrequire 1 / n > 0\n"
    found = set()
    for lanes in (1, 7, 512, 4096):
        seen = []
        with pytest.raises(ZeroDivisionError):
            seen.extend(fingerprint(scene) for scene in scenario(text).stream(10_000, seed=4, lanes=lanes))
        count = 0
        stream = scenario(text).stream(10_000, seed=4, lanes=lanes)
        try:
            for _ in stream:
                count += 1
        except ZeroDivisionError as error:
            found.add((count, *error.__notes__))
    assert len(found) == 1
    assert next(iter(found))[0] > 0


def test_a_soft_requirement_that_is_off_does_not_fail() -> None:
    assert len(draws("n = DiscreteRange(0, 0)\nrequire[0] 1 / n > 0\nparam x = n", n=20)) == 20


def test_rejection_in_a_function_of_a_condition() -> None:
    text = (
        "x = Range(0, 1)\ndef f(v):\n    if v < 0.5:\n        raise RejectionException('low')\n    return True\n"
        "require f(x)\nparam x = x"
    )
    assert min(draws(text, n=50)) >= 0.5


@pytest.mark.parametrize(
    ("statement", "error", "message"),
    [
        ("require (new Object)", InvalidScenarioError, "cannot create an object"),
        ("require Range(0, 1) < 1", InvalidScenarioError, "cannot create a distribution"),
        ("require Uniform(1, 2) < 1", InvalidScenarioError, "cannot create a distribution"),
        ("def f():\n    require True\nrequire f()", InvalidScenarioError, "cannot contain another"),
        ("def f():\n    param a = 1\nrequire f()", InvalidScenarioError, "cannot be set here"),
        ("require ego.x > 0", InvalidScenarioError, "ego object is used before it is set"),
        ("require nothing_here > 0", NameError, None),
        ("require x.nothing > 0", AttributeError, "nothing"),
        ("require x + 'a' > 0", TypeError, ""),
        ("require 1 / 0 > 0", ZeroDivisionError, "division by zero"),
        ("require x < 'a'", TypeError, ""),
        ("require (1, 2) in x", TypeError, ""),
        ("require distance from x to (1, 2)", ScenicTypeError, "expected a vector"),
        ("require front of x", ScenicTypeError, "expected an object"),
    ],
)
def test_mistakes_in_conditions(statement: str, error: type[Exception], message: str | None) -> None:
    found = failure(f"x = Range(0, 1)\n{statement}\n")
    if message is None:
        assert "nothing_here" in str(found)
    else:
        assert type(found) is error, found
        assert message in str(found)
    code, where, _ = place(found)
    assert code.startswith("SC")
    assert int(where.partition(":")[0]) >= 2


def test_conditions_that_cannot_hold() -> None:
    for text in (
        "require False",
        "x = Range(0, 1)\nrequire x > 2",
        "x = Range(0, 1)\nrequire x < 0 or x > 1",
    ):
        found = failure(text)
        assert isinstance(found, RejectionException)
        assert "requirement on line" in str(found)
    named = failure("x = Range(0, 1)\nrequire x > 2 as far")
    assert "far" in str(named)
    assert "requirement on line" not in str(named)


# Built-in requirements


def test_containment_and_the_workspace() -> None:
    text = "workspace = Workspace(RectangularRegion((0, 0), 0, 4, 4))\nnew Object at (Range(-5, 5), 0, 7), facing 45 deg\n"
    reach = 2 - np.sqrt(0.5)
    values = [scene.objects[0].x for scene in scenario(text).sample(500, seed=0)]
    assert stats.kstest(values, stats.uniform(-reach, 2 * reach).cdf).pvalue > FALSE_ALARM
    own = "new Object at (Range(-5, 5), 0), with regionContainedIn BoxRegion((2, 2, 2), (1, 0, 0))\n"
    assert all(0.5 <= scene.objects[1].x <= 1.5 for scene in scenario(text + own).sample(20, seed=0))
    free = "new Object at (Range(4, 5), 0), with regionContainedIn everywhere\n"
    assert all(scene.objects[1].x >= 4 for scene in scenario(text + free).sample(20, seed=0))


COMPOSITES = {
    "disc.difference(hole)": {2, 3},
    "disc.intersect(other)": {3},
    "hole.union(other)": {0, 1, 3, 4, 5},
    "Uniform(hole, other)": {0, 1, 3, 4, 5},
}


@pytest.mark.parametrize("container", COMPOSITES)
@pytest.mark.parametrize("three", ["3", "Range(2.9, 3)"])
def test_containers_of_the_plane_hold_what_is_above_them(container: str, three: str) -> None:
    """At any height; what is taken away from one is missing there too."""
    text = (
        f"disc, hole = CircularRegion((0, 0), {three} + 0.5), CircularRegion((0, 0), {three} - 1.8)\n"
        f"other = CircularRegion((4, 0), {three} - 1.5)\n"
        "place = DiscreteRange(0, 5)\n"
        "new Object at (place, 0, Uniform(-9, 0, 7)), with width 0.1, with length 0.1, with height 0.1, "
        f"with regionContainedIn {container}\nparam x = place\n"
    )
    assert {scene.params["x"] for scene in scenario(text).sample(30, seed=2)} == COMPOSITES[container]


def test_collisions() -> None:
    text = "a = new Object\nb = new Object at (Range(-3, 3), 0)\n"
    values = [abs(scene.objects[1].x) for scene in scenario(text).sample(500, seed=0)]
    assert stats.kstest(values, stats.uniform(1, 2).cdf).pvalue > FALSE_ALARM
    for free in ("a", "b"):
        loose = text.replace(f"{free} = new Object", f"{free} = new Object with allowCollisions True,")
        loose = re.sub(r",(\n| at)", lambda match: "\n" if match[1] == "\n" else ", at", loose)
        assert min(abs(scene.objects[1].x) for scene in scenario(loose).sample(50, seed=0)) < 1


def test_a_random_permission_to_collide() -> None:
    text = "a = new Object with allowCollisions Uniform(True, False)\nb = new Object at (0.5, 0)\n"
    program = scenario(text)
    scenes = program.sample(200, seed=0)
    assert all(scene.objects[0].allowCollisions for scene in scenes)


@pytest.mark.parametrize(
    ("text", "message", "where"),
    [
        ("new Object\nnew Object at (0.5, 0)", "always collides with the Object on line 1", "2:1-2:23"),
        ("class Car: pass\nego = new Car\nx = new Object in RectangularRegion((0, 0), 0, 0, 0)", None, None),
        ("workspace = Workspace(CircularRegion((0, 0), 2))\nx = new Object at (2, 0)", "not inside its container", "2:5-2:25"),
        ("workspace = Workspace(nowhere)\nnew Object", "cannot be inside its container, which is empty", "2:1-2:11"),
        ("new Object at (5, 5), with regionContainedIn CircularRegion((0, 0), 2)", "not inside", "1:1-1:71"),
    ],
)  # fmt: skip
def test_what_can_be_seen_to_be_wrong_before_sampling(
    text: str, message: str | None, where: str | None
) -> None:
    if message is None:
        assert isinstance(failure(text), InvalidScenarioError | RejectionException)
        return
    with pytest.raises(InvalidScenarioError, match=message) as caught:
        scenario(text)
    assert place(caught.value)[:2] == ("SC401", where)


def test_of_several_collisions_that_first_complete_one_is_told() -> None:
    """As one reads on, the first object that is in the way of an earlier one."""
    text = "new Object at (0, 0)\nnew Object at (5, 0)\nnew Object at (5.5, 0)\nnew Object at (0.5, 0)\n"
    with pytest.raises(InvalidScenarioError, match="always collides with the Object on line 2") as caught:
        scenario(text)
    assert place(caught.value)[1].startswith("3:")


@pytest.mark.parametrize("name", ["width", "length", "height"])
def test_random_sizes_are_positive(name: str) -> None:
    text = f"ego = new Object with {name} Range(-1, 1)\nparam x = ego.{name}"
    assert stats.kstest(draws(text, n=500), "uniform").pvalue > FALSE_ALARM


OVERFLOWING = [
    *(
        "at (big, 0, 0)",
        "at (0, -big, 0)",
        "at (0, 0, big)",
        "with yaw big",
        "with pitch -big",
        "with roll big",
    ),
    *("with width big", "with length big", "with height big"),
]


def attempts_of(program: Scenario) -> Batch:
    """A batch of the first attempts at a scene."""
    return program._sampler.engine.batch(
        program._sampler.engine._source(_attempts(SceneTask(1, 0), np.arange(40, dtype=np.int64)))
    )


def test_what_overflows_makes_no_object() -> None:
    """One coordinate, angle or size is enough; of each, exactly the candidates in which it is finite pass."""
    objects = "".join(f"new Object {text}\n" for text in OVERFLOWING)
    program = scenario(f"big = 1e308 * Range(0.1, 3)\nparam big = big\n{objects}")
    batch = attempts_of(program)
    finite = np.isfinite(batch.full(as_node(program.params["big"])))
    assert set(finite.tolist()) == {True, False}
    found = {}
    for check in program._sampler.engine.plan.checks:
        if check.label.startswith("finite"):
            found[check.span.line - 3] = check.test(batch).holds.tolist()
        elif check.label.startswith("positive"):
            assert check.test(batch).holds.all()
    assert found == dict.fromkeys(range(len(OVERFLOWING)), finite.tolist())


def test_sizes_that_may_be_nothing_are_looked_at() -> None:
    """Each passes where it is positive; of one that certainly is there is no check."""
    texts = [
        (name, size) for name in ("width", "length", "height") for size in ("x - 0.5", "x * -1", "x", "x + 1")
    ]
    program = scenario(
        "x = Range(0, 1)\n" + "".join(f"new Object with {name} {size}\n" for name, size in texts)
    )
    batch = attempts_of(program)
    x = batch.full(program._sampler.engine.plan.graph.nodes[0])
    found = {
        (check.label, check.span.line - 2): check.test(batch).holds.tolist()
        for check in program._sampler.engine.plan.checks
        if check.label.startswith("positive")
    }
    assert found == {
        (f"positive {name} of Object", line): (eval(size, {"x": x}) > 0).tolist()
        for line, (name, size) in enumerate(texts)
        if size != "x + 1"
    }
    assert len({tuple(held) for held in found.values()}) == 3


FINITE = [
    *(
        "at (x, 0)",
        "at (1 / (x + 1), 0)",
        "at (hypot(x, x), sin(x))",
        "at (Normal(0, 1), x ** 3)",
        "facing x",
    ),
    *("facing (x, x, x)", "facing toward (x, 2)", "with pitch Uniform(1, x)", "at (x, 0) offset by (1, x)"),
    *("in CircularRegion((x, 0), 3)", "with roll 3 * x"),
]
MAYBE_INFINITE = [
    *("at (1 / x, 0)", "at (f(x), 0)", "at (x - f(x), 0)", "facing (f(x), 0, 0)", "facing (0, f(x), 0)"),
    *(
        "facing (x, x, big)",
        "facing (x, big, 0)",
        "facing (big, x, 1)",
        "facing toward (big, 0)",
        "with yaw f(x)",
    ),
    *(
        "with roll Uniform(1, 1 / x)",
        "with pitch f(x)",
        "at Uniform((0, 0), (big, 0))",
        "at (x, 0) offset by (big, 0)",
    ),
    *("at (0, 0, 1 / x)", "in CircularRegion((big, 0), 3)"),
]


def test_what_may_be_infinite_is_looked_at_and_nothing_else() -> None:
    """By what is known of each operation: code may give anything, as may what is turned by what is infinite."""
    head = "x = Range(0, 1)\nbig = 1e308 * Range(0, 3)\n@distributionFunction\ndef f(v): return v\n"
    texts = [*FINITE, *MAYBE_INFINITE]
    program = scenario(head + "".join(f"new Object {text}\n" for text in texts))
    lines = {
        check.span.line for check in program._sampler.engine.plan.checks if check.label.startswith("finite")
    }
    first = head.count("\n") + 1
    assert [text for line, text in enumerate(texts, first) if line in lines] == MAYBE_INFINITE


def test_branches_outside_requirements_are_refused() -> None:
    assert isinstance(failure("x = Range(0, 1)\nif x > 0.5:\n    require True"), RandomControlFlowError)


def holds(formula: Any, trace: Sequence[Mapping[str, bool]], now: int) -> bool:
    """Whether a formula holds at a moment of a trace whose last state goes on for ever."""
    match formula:
        case str():
            return trace[now][formula]
        case "not", part:
            return not holds(part, trace, now)
        case "and", one, other:
            return holds(one, trace, now) and holds(other, trace, now)
        case "or", one, other:
            return holds(one, trace, now) or holds(other, trace, now)
        case "implies", one, other:
            return not holds(one, trace, now) or holds(other, trace, now)
        case "next", part:
            return holds(part, trace, min(now + 1, len(trace) - 1))
        case "always", part:
            return all(holds(part, trace, later) for later in range(now, len(trace)))
        case "eventually", part:
            return any(holds(part, trace, later) for later in range(now, len(trace)))
        case "until", one, other:
            return any(
                holds(other, trace, end) and all(holds(one, trace, before) for before in range(now, end))
                for end in range(now, len(trace))
            )
    raise AssertionError(formula)


def written(formula: Any) -> str:
    match formula:
        case str():
            return formula
        case word, part:
            return f"({word} {written(part)})"
    word, one, other = formula
    return f"({written(one)} {word} {written(other)})"


ONE = ("always", "eventually", "next", "not")
TWO = ("and", "or", "implies", "until")
FORMULAS = [
    *((two, "a", "b") for two in TWO),
    *((one, (other, "a")) for one in ONE for other in ONE),
    *((one, (two, "a", "b")) for one in ONE for two in TWO),
    *((two, (one, "a"), "b") for one in ONE for two in TWO),
    *((two, "a", (one, "b")) for one in ONE for two in TWO),
    *(("not", (two, (one, "a"), (other, "b"))) for one in ONE[:2] for other in ONE[:2] for two in TWO),
]
STATES = [{"a": a, "b": b} for a in (False, True) for b in (False, True)]


@pytest.mark.parametrize("formula", FORMULAS, ids=written)
def test_a_scene_may_begin_what_a_requirement_says_of_time(formula: Any) -> None:
    """A candidate is rejected where no course of a simulation that begins so can meet the requirement, and only there."""
    possible = [
        first
        for first in STATES
        if any(holds(formula, (first, *then), 0) for then in itertools.product(STATES, repeat=2))
    ]
    text = (
        f"a, b = Uniform(False, True), Uniform(False, True)\nparam a = a, b = b\nrequire {written(formula)}\n"
    )
    try:
        found = [scene.params for scene in scenario(text).sample(30, seed=1)]
    except InvalidScenarioError:
        found = []
    assert [state for state in STATES if state in found] == possible


@pytest.mark.parametrize(
    "made",
    [
        "new Point at (x, 0)",
        "new OrientedPoint at (x, 0), facing 0.5",
        "(new OrientedPoint ahead of ego by x)",
    ],
)
@pytest.mark.parametrize(
    "way",
    [
        "require abs(({made}).position.x) + abs(({made}).position.y) > 0.5",
        "def far():\n    point = {made}\n    return abs(point.position.x) + abs(point.position.y) > 0.5\nrequire far()",
    ],
)
def test_points_may_be_made_by_requirements(way: str, made: str) -> None:
    """They belong to it alone; objects may not."""
    text = f"x = Range(0, 1)\nego = new Object with width 1e-6, with length 1e-6\n{way.format(made=made)}\nparam x = x\n"
    found = scenario(text).sample(10, seed=1)
    assert min(item.params["x"] for item in found) > 0.49
    assert {len(item.objects) for item in found} == {1}
    error = failure(text.replace("new OrientedPoint", "new Object").replace("new Point", "new Object"))
    assert isinstance(error, InvalidScenarioError)
    assert "a requirement cannot create an object" in str(error)


@pytest.mark.parametrize("probability", ["1", "1.0", "0.5", "0"])
@pytest.mark.parametrize(
    "condition",
    ["always x < 0.5", "eventually x < 0.5", "x < 0.5 and next True", "x < 0.5 implies always True"],
)
def test_only_what_is_certain_may_speak_of_time(condition: str, probability: str) -> None:
    text = f"x = Range(0, 1)\nego = new Object\nrequire[{probability}] {condition}\nparam x = x\n"
    if float(probability) == 1:
        values = draws(text, n=10)
        assert (max(values) < 0.5) == (condition.startswith(("always", "x < 0.5 and")))
    else:
        error = failure(text)
        assert isinstance(error, InvalidScenarioError)
        assert "a temporal requirement cannot have a probability" in str(error)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("a", "told(a, x)"),
        ("told(a, x)", "a"),
        ("told(a, x)", "told(a, x)"),
        ("u", "told(a, x)"),
        ("told(u, x)", "a"),
        ("a", "told(u, x)"),
    ],
)
def test_instances_that_code_gives_back_are_compared_as_themselves(left: str, right: str) -> None:
    """With `u` one of both objects, they are the same where it is the first."""
    text = (
        "told = distributionFunction(lambda value, _: value)\nx = Range(0, 1)\na = new Object at (9, 9)\nego = new Object\n"
        f"u = Uniform(a, ego)\nparam u = u, x = x\nrequire {left} {{}} {right} or x > 0.5\n"
    )
    drawn = "u" in left + right
    for operator in ("==", "!="):
        low = [
            found.params["u"] is not found.egoObject
            for found in scenario(text.format(operator)).sample(40, seed=3)
            if found.params["x"] < 0.5
        ]
        if operator == "==":
            assert low
            assert all(low) == drawn
        else:
            assert bool(low) == drawn
            assert not any(low)


@pytest.mark.parametrize(
    ("condition", "left"),
    [
        ("(n or n > 5) == 2", {2}),
        ("(n > 1 or n) == 1", {1, 2}),
        ("(n and n > 1) == 0", {0, 1}),
        ("(n > 0 and n) == 2", {2}),
        ("[n and 'a'] == ['a']", {1, 2}),
        ("(n > 0 and n < 2) == True", {1}),
        ("(not n) == True", {0}),
        ("((n or 7) + 1) in (2, 8)", {0, 1}),
    ],
)
def test_and_and_or_within_expressions_give_their_operands(condition: str, left: set[int]) -> None:
    assert set(draws(f"n = DiscreteRange(0, 2)\nrequire {condition}\nparam x = n\n", n=20)) == left


@pytest.mark.parametrize("ego", ["", "ego = a\n", "ego = new Object at (50, 50)\n"])
def test_what_a_program_makes_later_stands_in_the_way_of_a_look(ego: str) -> None:
    """Whether there is an ego or not; and whether it is certain to stand there, or in half of the scenes."""
    text = (
        "x = Range(-1, 1)\na = new Object at (0, 0)\nb = new Object at (0, 10)\n{ego}require {condition}\nparam x = x\n"
        "wall = new Object at ({place}, 5), with width 30, with height 30, with length 0.1\n"
    )
    assert scenario(text.format(ego=ego, condition="not (a can see b)", place="0")).sample(2, seed=1)
    with pytest.raises(RejectionException):
        scenario(text.format(ego=ego, condition="a can see b", place="0")).sample(1, seed=1)
    places = draws(text.format(ego=ego, condition="a can see b", place="max(0, 500 * x)"), n=6)
    assert (np.array(places) > 0).all()


OF_LENGTH = "__len__(self): return 1 if self.size > 1.5 else 0"
OF_TRUTH = "__bool__(self): return self.size > 1.5"


@pytest.mark.parametrize(
    ("judge", "condition", "wanted"),
    [
        *((OF_TRUTH, name, True) for name in ("ego", "either", "held", "[held][0]")),
        *((OF_TRUTH, f"not {name}", False) for name in ("ego", "either", "held")),
        *((OF_LENGTH, name, True) for name in ("ego", "either", "held")),
        (OF_TRUTH, "ego and True", True),
        (OF_TRUTH, "False or held", True),
        (OF_TRUTH, "not not either", True),
        (OF_TRUTH, "(1 if ego else 0) == 1", True),
        (OF_TRUTH, "(not held) == True", False),
        (OF_TRUTH, "always either", True),
    ],
)
def test_the_truth_of_instances_is_that_of_sampled_ones(judge: str, condition: str, wanted: bool) -> None:
    """Where the program defines it: for instances of its classes, and of plain ones."""
    text = (
        f"size = Range(1, 2)\nclass Car:\n    size: size\n    def {judge}\n"
        f"class Held(object):\n    def __init__(self): self.size = size\n    def {judge}\n"
        f"held = Held()\nego = new Car\neither = Uniform(ego, new Car at (9, 9))\nrequire {condition}\n"
    )
    sizes = [item.egoObject.size for item in scenario(text).sample(3, seed=1)]
    assert [size > 1.5 for size in sizes] == [wanted] * 3


@pytest.mark.parametrize("name", ["eq", "ne", "lt", "le", "gt", "ge"])
def test_instances_are_compared_by_the_methods_of_sampled_ones(name: str) -> None:
    """Those that a choice draws, too, on either side, and plain ones; a number that is drawn may be the other side."""
    sign = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}[name]
    compare = f"def __{name}__(self, other): return self.size > 1.5\n    __hash__ = object.__hash__"
    for left, right in (("ego", "3"), ("either", "ego"), ("either", "size"), ("held", "ego"), ("drawn", "3")):
        text = (
            f"size = Range(1, 2)\nclass Car:\n    size: size\n    {compare}\nclass Held(object):\n"
            f"    def __init__(self): self.size = size\n    {compare}\nheld = Held()\ndrawn = Uniform(held, Held())\n"
            f"ego = new Car\neither = Uniform(ego, new Car at (9, 9))\nrequire {left} {sign} {right}\n"
        )
        sizes = [item.egoObject.size for item in scenario(text).sample(2, seed=1)]
        assert min(sizes) > 1.5


LOADED = """
class Car:
    load: Range(0, 4)
    def __add__(self, other): return self.load + other
    def __radd__(self, other): return other + self.load
    def __neg__(self): return -self.load
    def __abs__(self): return abs(self.load)
    def __len__(self): return int(self.load) + 1
    def __int__(self): return int(self.load)
    def __float__(self): return float(self.load)
    def __round__(self, n=0): return round(self.load, n)
    def __str__(self): return 'car' + str(int(self.load))
    def __getitem__(self, i): return self.load * i
    def __contains__(self, i): return i < self.load
    def __call__(self, i): return self.load - i
    def __iter__(self): return iter([self.load, 1])
a = new Car at (5, 5)
b = new Car at (9, 9)
ego = new Car
d = Uniform(a, b)
param d = d
"""
ASKED = ["d + 1", "1 + d", "-d", "abs(d)", "len(d)", "int(d)", "float(d)", "round(d, 1)", "str(d)", "d[2]", "d(1)", "max(d, default=0)"]  # fmt: skip


@pytest.mark.parametrize(
    "asked", [*ASKED, "1.5 in d", "sorted(d)", "list(d)", "sum(d)", "f'{d}'", "[x for x in d]"]
)
def test_python_asks_sampled_instances_by_the_methods_of_their_class(asked: str) -> None:
    """Those that choices draw, too: in requirements whatever it asks, elsewhere all that gives a value."""
    seen: list[tuple[Any, Any]] = []
    text = f"{LOADED}require Noted(d, {asked})\n" + (f"param x = {asked}\n" if asked in ASKED else "")

    def noted(thing: Any, answer: Any) -> bool:
        seen.append((eval(asked, {"d": thing}), answer))
        return True

    program = scenario(text.replace("Noted", "globalParameters.noted"), params={"noted": noted})
    scene = program.sample(6, seed=2)[5]
    assert len(seen) >= 6
    assert all(answer == expected for expected, answer in seen)
    if asked in ASKED:
        assert scene.params["x"] == eval(asked, {"d": scene.params["d"]})


@pytest.mark.parametrize(
    "condition",
    ["len(d) >= 3", "float(d) > 2", "int(d) >= 2", "str(d) == 'car2'", "abs(d) > 2", "-d < -2", "d + 1 > 3", "1 + d > 3",
     "round(d, 0) > 2", "d[2] > 4", "d(1) > 1", "max(d) > 2", "1.5 in d", "not (len(d) < 3)", "int(d) >= 2 and len(d) < 4"],
)  # fmt: skip
def test_conditions_on_what_python_asks_of_sampled_instances(condition: str) -> None:
    """They hold in all scenes, and others than these meet them, too."""
    plain = [scene.params["d"] for scene in scenario(LOADED).sample(40, seed=3)]
    met = [scene.params["d"] for scene in scenario(f"{LOADED}require {condition}\n").sample(20, seed=3)]
    assert {bool(eval(condition, {"d": thing})) for thing in plain} == {True, False}
    assert all(eval(condition, {"d": thing}) for thing in met)
