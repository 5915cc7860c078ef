"""Conditions with sequences, regions and points of their own: what Python gives on samples, without calling it."""

import pytest

from scenic.graph.node import Graph
from scenic.runtime.scenes.scenario import Scenario
from tests.runtime.programs import fingerprint, scenario

OBJECTS = """
ego = new Object at (Range(-5, 5), Range(-5, 5)), with allowCollisions True
others = [new Object at (Range(-9, 9), Range(-9, 9)), with allowCollisions True for i in range(3)]
pair = (others[0], ego)
limits, either = (3, 4, 5), Uniform(others, pair)
x, n, m = Range(-3, 3), DiscreteRange(0, 4), DiscreteRange(2, 9)
colour, other = Uniform('red', 'blue'), Uniform('blue', 'red', 'black')
counts, numbers = {'a': n, 'b': m}, [n, m, 7]
def same(value):
    return value
class Spot(Point):
    note: same(3)
"""

UNROLLED = (
    "all((distance from o) < 9 for o in others)",
    "all([o.position.x < 5 for o in others])",
    "not any(o.position.x > 3 for o in others)",
    "any((o.position.x > 3) == (o.position.y > 3) for o in pair)",
    "sum(o.position.x for o in pair) > 1",
    "sum([o.position.x > 0 for o in others]) >= 2",
    "sum(n * i for i in range(5)) > 20",
    "max(o.position.x for o in others) > 4",
    "min(o.position.x for o in others) < min(o.position.y for o in others)",
    "max([x, ego.position.x]) < 2",
    "all((distance from a to b) > 3 for a in others for b in others if a is not b)",
    "all(o.position.x < limit for o, limit in zip(others, limits))",
    "all(o.position.x < i + 2 for i, o in enumerate(others))",
    "all(others[i].position.x < others[i + 1].position.x for i in range(2))",
    "all(o.position.x < 3 for o in reversed(others) if o is not None)",
    "all(all(abs(o.position.x - p.position.x) < 8 for p in pair) for o in others)",
    "any([x > 1, n > 2])",
    "all([])",
    "all(o.position.x < 5 for o in others if o.position.y > 1)",
    "any([o.position.x > 3 for o in others if o.position.y > 1 if o.position.x < 7])",
    "all(1 / (k - 1) < 1 for k in numbers if k != 1)",
    "sum(1 for o in others if o.position.x > 0) == 2",
    "sum(k for k in numbers if k % 2 if k > 2) > 6",
    "len([o for o in others if o.position.x > 0 if o.position.y > -5]) >= 1",
    "numbers.count(n) == 1",
    "[colour, other, 'red'].count('red') == 2",
    "numbers == sorted(numbers)",
    "sum(counts.values()) > 6",
    "len(set(counts.values())) == 2",
    "all(name == 'a' or value > 3 for name, value in counts.items())",
    "len(set([n, m, 7])) == 3",
    "colour is not other",
    "ego.position.x > 0 and any(o.position.x > i for i in range(3) for o in pair)",
    "ego.position in RectangularRegion((1, 2), 30 deg, 6, length=4)",
    "ego in CircularRegion(Vector(others[0].position.x, 1), radius=n + 1)",
    "not (ego intersects BoxRegion(dimensions=(3, 3, 3), position=others[0].position))",
    "all((distance from o to Vector(x, n, 0)) < 9 for o in others)",
    "(distance from ego to (new Point at (x, 2))) < 4",
    "abs(relative heading of (new OrientedPoint at (x, 2), facing x) from ego) < 1",
    "(distance from ego to (new OrientedPoint left of others[1] by 2)) < 9",
)
"""Conditions that become nodes."""

OPAQUE = (
    "all(same(o.position.x) < 5 for o in others)",
    "[o for o in others if o.position.y > 1] != []",
    "max(o.position.x for o in (ego, *others) if o.position.y > -9) > 0",
    "[(n, 1), (m, 2)].count((n, 1)) == 1",
    "[n, m] == sorted([n, m], reverse=True)",
    "all(i < 3 for i in range(n))",
    "any(o.position.x > 3 for o in either)",
    "sum(len(str(o.position.x)) for o in pair) > 10",
    "max((o.position.x for o in others), default=1) > 0",
    "[o.position.x for o in others][0] == max({o.position.x for o in others})",
    "ego.position in CircularRegion((0, 0), 9 * abs(x))",
    "(distance from ego to (new Spot at (x, 2))) < 9",
    "(distance from ego to (new Point at (x, 2), with note 3)) < 9",
    "ego.position in CircularRegion(*[(0, 0), 9])",
    "len(set([n, m, 7])) == 2",
    "len(set([ego, others[0]])) == 2",
    "len(set((colour, other, 'green'))) == 3",
)
"""Conditions that Python computes."""


def runs_python(program: Scenario) -> bool:
    nodes = [node for check in program.outline.checks for node in check.nodes]
    return any(node.runs_python for node in Graph(nodes).nodes)


def opaque(condition: str) -> str:
    """The same condition in a function of the program, which is called on samples."""
    return f"def holds():\n    return bool({condition})\nrequire holds()\n"


@pytest.mark.parametrize("condition", UNROLLED)
def test_fixed_sequences_become_nodes_of_the_same_value(condition: str) -> None:
    program = scenario(f"{OBJECTS}require {condition}\n")
    assert not runs_python(program)
    slow = scenario(f"{OBJECTS}{opaque(condition)}")
    assert runs_python(slow)
    unpruned = program.within(slow.domain)
    found = [(fingerprint(item), item.attempts) for item in unpruned.sample(6, seed=2)]
    assert found == [(fingerprint(item), item.attempts) for item in slow.sample(6, seed=2)]


@pytest.mark.parametrize("condition", OPAQUE)
def test_what_is_not_fixed_is_called_on_samples(condition: str) -> None:
    program = scenario(f"{OBJECTS}require {condition}\n")
    assert runs_python(program)
    program.sample(2, seed=1)


def test_names_of_the_program_come_before_those_of_python() -> None:
    for definition in ("def all(values):\n    return True\n", "from builtins import any as all\n"):
        program = scenario(f"{OBJECTS}{definition}require all([True, x > 2])\n")
        assert runs_python(program)
        program.sample(1, seed=1)


def test_elements_that_are_added_later_count() -> None:
    text = (
        "things = [new Object at (Range(0, 9), 0)]\n"
        "require all(o.position.x > 5 for o in things)\n"
        "things.append(new Object at (Range(0, 9), 5))\n"
    )
    for scene in scenario(text).sample(10, seed=0):
        assert all(item.position.x > 5 for item in scene.objects)


def test_mutated_objects_are_meant_as_they_come_out() -> None:
    text = (
        "things = [new Object at (i * 5, 0) for i in range(2)]\n"
        "mutate\n"
        "require all(o.position.y > 0.2 for o in things)\n"
    )
    program = scenario(text)
    assert not runs_python(program)
    for scene in program.sample(10, seed=0):
        assert all(item.position.y > 0.2 for item in scene.objects)


def test_many_elements_are_left_to_python() -> None:
    program = scenario("x = Range(0, 1)\nego = new Object\nrequire all(x < i for i in range(1, 5000))\n")
    assert runs_python(program)


def test_a_fault_behind_the_first_false_element_does_not_count() -> None:
    program = scenario("x = Range(-1, 1)\nego = new Object\nrequire any([x < 0, 1 / (x - abs(x)) < 0])\n")
    with pytest.raises(ZeroDivisionError):
        program.sample(20, seed=0)
    program = scenario("x = Range(-1, 1)\nego = new Object\nrequire any([x < 0, 1 / (x + abs(x)) > 0])\n")
    assert len(program.sample(20, seed=0)) == 20


ITEMS = (
    ("same(numbers[0]) < numbers[2]", 1),
    ("same(counts['b']) - counts['b'] == 0", 1),
    ("same(rows[0])[i - 1] > 1", 2),
    ("same(numbers[-1]) == 7", 0),
    ("same(numbers[i]) > 3 and same(numbers[i - 1]) > 1", 1),
    ("same(numbers[0]) < len(numbers)", 2),
    ("same([numbers[i] for i in range(2)])[0] > 1", 2),
    ("same(numbers[n % 2]) > 1", 2),
)
"""Conditions that call a function of the program, and on how many of two draws each call depends."""


@pytest.mark.parametrize(("condition", "draws"), ITEMS)
def test_code_depends_on_the_items_that_it_reads(condition: str, draws: int) -> None:
    text = f"{OBJECTS}rows, i = [[n, m], [7]], 1\n"
    program = scenario(f"{text}require {condition}\n")
    calls = [
        node for check in program.outline.checks for node in Graph(check.nodes).nodes if node.runs_python
    ]
    below = [{item for item in Graph([call]).nodes if item.is_axis} for call in calls]
    assert max(map(len, below)) == draws
    slow = scenario(f"{text}{opaque(condition)}")
    unpruned = program.within(slow.domain)
    found = [(fingerprint(item), item.attempts) for item in unpruned.sample(6, seed=2)]
    assert found == [(fingerprint(item), item.attempts) for item in slow.sample(6, seed=2)]


def test_items_that_are_replaced_later_count() -> None:
    text = (
        "def same(value):\n    return value\n"
        "things, names = [Range(0, 9), 1], {'a': Range(0, 9)}\n"
        "require same(things[0]) > 5\nrequire same(names['a']) > 5\n"
        "things[0], names['a'] = Range(0, 9), Range(0, 9)\nparam v = (things[0], names['a'])\n"
    )
    for scene in scenario(text).sample(10, seed=0):
        assert all(value > 5 for value in scene.params["v"])
