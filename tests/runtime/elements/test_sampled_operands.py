"""What an expression over random operands is worth in a sample is what it is worth of the values that they have there.

The same function of a program is asked twice: while the program is loaded, of random operands, so that it makes nodes of the
graph; and on each sample, of their values, by Python. Operands differ in value and in type from lane to lane, so that lanes of
one batch take different ways, and some of them fail. Conditions of requirements are held against Python likewise.
"""

import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import product
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.graph.batch import Batch
from scenic.graph.draws import Counter
from scenic.graph.node import Graph, Node
from scenic.graph.operation import FAULT, OK
from scenic.graph.schedule import Scheduler
from scenic.language.errors import RejectionException
from scenic.runtime.instances.objects import Point
from scenic.runtime.values.lazy import Lazy
from scenic.runtime.values.values import CODEC, as_node
from tests.compiler.golden_cases import read_cases
from tests.recorded import FOLDER, shown

LANES = 10
KINDS = {
    "number": "Range(0.3, 0.9)",
    "whole": "DiscreteRange(-2, 2)",
    "mixed": "Uniform(0.5, 2, True)",
    "moving": "Vector(Range(1, 2), -3, Normal(0, 1))",
    "place": "Uniform(Vector(1, 2, 3), Vector(-2, 1, 4), (1, 5))",
    "turning": "Orientation.fromEuler(Range(0.1, 0.6), Range(-1, 1), -0.1)",
    "thing": "Uniform(thing, ego)",
    "which": "Uniform(thing, oriented, point)",
    "list": "Uniform([1, 2.5, -3, 4], [0.5], [])",
    "nested": "[Range(0, 1), Uniform(1, 2.5), 'x']",
    "text": "Uniform('word', 'other', '')",
    "perhaps": "Uniform(None, 3, Range(0, 1))",
    "any": "Uniform(3, (1, 2), thing, 'a', disc)",
    "where": "Uniform(disc, box)",
    "given": "given(Uniform(0.5, 2), 1)",
    "given thing": "given(Uniform(thing, oriented), 1)",
    "dictionary": "Uniform({'a': 1}, {'a': Range(0, 1), 'b': {2}})",
    "rejected": "Uniform(0.4, refused(Range(0, 1)))",
}
SECOND = {"b": ("number", "which"), "n": ("whole",)}

PREAMBLE = """
import math
import numpy as np
from scenic.core.distributions import distributionFunction, RejectionException
flow = VectorField("flow", lambda p: 0.1 * p.x - 0.2 * p.y)
disc = CircularRegion((2, -1, 0.5), 3)
box = BoxRegion(position=(1, 2, 0), dimensions=(4, 5, 6))
workspace = Workspace(BoxRegion(position=(0, 0, 0), dimensions=(80, 90, 100)))
ego = new Object at (9, -7, 1), facing (0.4, 0.1, -0.2), with width 0.6, with length 1.7, with height 0.9
point = new Point at (6, 5, -4)
oriented = new OrientedPoint at (-5, 8, 2), facing (1.1, -0.3, 0.2)
thing = new Object at (-12, -9, 3), facing (-0.8, 0.35, 0.5), with width 2.2, with length 1.3, with height 0.7
def helper(value, other=2):
    return (value, other)
def attempt(function):
    try:
        return function()
    except Exception as error:
        return error.with_traceback(None)  # whose frames would keep all programs in memory
@distributionFunction
def given(value, other):
    return value
@distributionFunction
def refused(value):
    if value < 0.7:
        raise RejectionException("too small")
    return value
answers = []
"""
OPERANDS = "".join(f"a{number} = {text}\nb{number} = {text}\n" for number, text in enumerate(KINDS.values()))

DRAWS = re.compile(
    r"verbosePrint|\b(Range|DiscreteRange|Normal|TruncatedNormal|Uniform|Discrete|Options|resample|visible)\b| is "
)
"""What draws numbers of its own would draw others when it is asked again; and identity is never a node."""


@dataclass(frozen=True)
class Asked:
    """A template with operands of some kinds."""

    template: str
    kinds: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.template}  of  {', '.join(self.kinds)}"

    @property
    def operands(self) -> str:
        """The names of the operands."""
        numbers = [list(KINDS).index(kind) for kind in self.kinds]
        return ", ".join(
            f"{'a' if place == 'a' else 'b'}{number}"
            for place, number in zip(places_of(self.template), numbers, strict=True)
        )

    @property
    def is_decided_by_types(self) -> bool:
        """Whether it means what the static types of its operands say: of a choice, what all of its options are."""
        return bool(re.search("relative to|offset by", self.template)) and not {"which", "thing"}.isdisjoint(
            self.kinds
        )


def places_of(template: str) -> list[str]:
    return [place for place in "abn" if f"{{{place}}}" in template]


def body_of(template: str) -> str:
    return template.format(**{place: f"({place})" for place in places_of(template)})


def every_kind(template: str) -> list[Asked]:
    kinds = [KINDS if place == "a" else SECOND[place] for place in places_of(template)]
    every = [Asked(template, chosen) for chosen in product(*kinds)]
    # The other branch of a conditional expression would be rejected as an argument of a function, too.
    return [asked for asked in every if " else " not in template or "rejected" not in asked.kinds]


def loops(templates: Sequence[str], body: str) -> str:
    """Does something for all operands of each template: ``{text}`` is the expression over those, ``{names}`` are their names."""
    lines = []
    for template in templates:
        names = ", ".join(places_of(template))
        rows = "".join(f"({asked.operands},), " for asked in every_kind(template))
        lines.append(f"for {names}, in [{rows}]:\n{body.format(names=names, text=body_of(template))}")
    return "".join(lines)


def loaded(text: str) -> scenic.Scenario:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return scenic.scenarioFromString(f"{PREAMBLE}{OPERANDS}{text}\nparam answers = answers\n")


def lanes_of(nodes: Sequence[Node]) -> Iterator[list[Any]]:
    """The values of nodes over the same lanes; in the place of a value, what becomes of a lane that has none."""
    batch = Batch(
        Scheduler(Graph(nodes)),
        Counter(np.arange(1, LANES + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)),
        CODEC,
        rejections=(RejectionException,),
    )
    batch.need(nodes)
    for node in nodes:
        status = batch.status(node)
        fates = [OK] * LANES if status is None else status.tolist()
        yield [
            batch.value(node, lane) if fate == OK else Fate.FAILS if fate == FAULT else Fate.REJECTS
            for lane, fate in enumerate(fates)
        ]


class Fate(Enum):
    FAILS = "fails"
    REJECTS = "rejects"


def told(value: Any) -> str:
    """A value as text; of an error, what becomes of a sample that has it."""
    if isinstance(value, Fate):
        return value.value
    if isinstance(value, RejectionException):
        return Fate.REJECTS.value
    # Of a negative number to a broken power Python makes a complex one, which no value of the graph is.
    if isinstance(value, Exception | complex):
        return Fate.FAILS.value
    return shown(parts(value) if isinstance(value, Point) else value)


def parts(value: Point) -> tuple[Any, ...]:
    """Class and properties of an instance."""
    return (type(value).__name__, *(value.properties[name] for name in sorted(value.properties)))


def differences(asked: Asked, found: Sequence[Any], expected: Sequence[Any]) -> list[str]:
    """The first lane in which two answers differ."""
    for lane, (one, other) in enumerate(zip(map(told, found), map(told, expected), strict=True)):
        if one != other:
            return [f"{asked}: {one}, not {other} in lane {lane}"]
    return []


@pytest.mark.parametrize("stem", ["functions", "members", "operators", "python"])
def test_values_are_those_of_the_sampled_operands(stem: str) -> None:
    _, cases = read_cases(FOLDER / f"operands_{stem}.txt")
    texts = [case.source.strip("\n") for case in cases]
    templates = [text for text in texts if "{a}" in text and not DRAWS.search(text)]
    body = "    answers.append((attempt(lambda: {text}), given_attempt(lambda {names}: {text}, {names})))\n"
    program = loaded(
        "@distributionFunction\ndef given_attempt(function, *values): return attempt(lambda: function(*values))\n"
        + loops(templates, body)
    )
    asked = [item for template in templates for item in every_kind(template)]
    answers = program.params["answers"]
    assert len(asked) == len(answers)
    compared = [
        (item, made, by_python)
        for item, (made, by_python) in zip(asked, answers, strict=True)
        if not isinstance(made, Exception | Lazy) and not item.is_decided_by_types
    ]
    nodes = [as_node(parts(made) if isinstance(made, Point) else made) for _, made, _ in compared]
    expected = lanes_of([as_node(by_python) for _, _, by_python in compared])
    wrong = []
    for (item, _, _), found, values in zip(compared, lanes_of(nodes), expected, strict=True):
        wrong += differences(item, found, values)
    assert len(compared) > 0.2 * len(asked)  # the others are refused while the program is loaded
    assert not wrong, "\n".join(wrong)


CONDITIONS = """
{a}
not {a}
{a} and {b}
{a} or {b}
{a} and not {b} or {n} > 0
{a} < {b}
{a} <= {n}
{n} > {a}
0 < {a} <= {n}
{a} == {b}
{a} != {n}
{n} == {a}
{a} == 'word'
{a} == (1, 2, 3)
{a} == None
{a} is None
{a} is not {b}
{a} is thing
{a} in {b}
{a} not in (0.5, 2, 'word', None)
{n} in {a}
{a} in disc
{a} in workspace
({a} if {n} > 0.5 else {b}) == {b}
(1 if {a} else 0) == 1
{a}.x > 0
{a}.width > 1 and {n} > 0
{a} + {n} > 1
-{a} < 0
{a} / {n} > 0.5
{a} % {n} == 0
{a}[0] == 1
{a}['a'] > 0.5
{a}[{n}] == 'o'
len({a}) > 1
str({a}) == '2'
int({a}) == 1
min({a}, {n}) > 0.4
max({a}) > 1
abs({a} - 1) < 0.7
round({a}) == {n}
any(v == 1 for v in {a})
[v for v in {a}] == []
sorted({a}) == {a}
isinstance({a}, Object)
isinstance({a}, (int, float))
hasattr({a}, 'position')
type({a}) is float
callable({a})
(lambda v: v == {n})({a})
helper({a})[0] == {b}
math.sqrt({a}) > 0.7
distance to {a} < 14
distance from {a} to {b} > 4
angle from {a} to {b} > 0
relative heading of {a} > 0
apparent heading of {a} from {b} > 0
distance past {a} > 0
(relative position of {a}).x > 0
{a} intersects {b}
(front of {a}).position.x > 0
({a} offset by {b}).x > 0
({a} relative to {b}) == {b}
flow at {a} == 0
({a} deg) > 0.01
{a}.distanceTo({b}) > 3
{a}.containsPoint({b})
{a}.intersects({b})
{a}.containsObject({b})
{a}.yaw > 0
{a}.norm() > 2
{a}.dot((1, 2, 3)) > 0
{a}.upper() == 'WORD'
{a}.get('a') == 1
{a} implies {b}
{a} if {n} else {b}
""".strip().split("\n")


def test_conditions_hold_where_they_hold_of_the_sampled_operands() -> None:
    """Whether a part of a condition becomes nodes or is asked on each sample changes nothing."""
    pythonic = [text.replace("{a} implies", "not {a} or") for text in CONDITIONS]
    body = "    answers.append(held(lambda {names}: {text}, {names}))\n"
    asking = "".join(loops([text], body) for text in pythonic)
    program = loaded(
        "@distributionFunction\ndef held(function, *values): return attempt(lambda: bool(function(*values)))\n"
        + asking
        + loops(CONDITIONS, "    require {text}\n")
    )
    asked = [item for template in CONDITIONS for item in every_kind(template)]
    conditions = [item.condition for item in program.requirements]
    answers = [as_node(answer) for answer in program.params["answers"]]
    assert len(conditions) == len(answers) == len(asked)
    wrong = []
    for item, found, values in zip(asked, lanes_of(conditions), lanes_of(answers), strict=True):
        if not item.is_decided_by_types:
            wrong += differences(item, found, values)
    assert not wrong, "\n".join(wrong)
