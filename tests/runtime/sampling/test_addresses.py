"""A scene is a function of seed and number: bitwise the same in any company, and whatever else the program draws."""

import json
import warnings
from pathlib import Path
from typing import Any

import pytest

from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.pending import SceneTask
from scenic.runtime.sampling.piecewise import PiecewiseEngine
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from tests.amounts import LONG
from tests.runtime.programs import scenario

TABLE = json.loads((Path(__file__).parents[2] / "data" / "reference" / "table.json").read_text())
RECORDED = [
    entry["program"].replace("{SETTING}", TABLE["setting"])
    for entry in TABLE["programs"].values()
    if entry.get("scenes", 1) > 1 and "error" not in entry and "differs" not in entry
]
OWN = [
    # A rare fault before a rare requirement, soft requirements, opaque calls that draw, retries, crowds.
    "x, y = DiscreteRange(0, 30), Range(0, 1)\nparam x = (x, y)\nrequire x != 0 and 1 / x < 2 or y < 0.9\nrequire x > 0",
    "x = Range(0, 1)\nrequire[0.5] x < 0.2\nrequire[0.3] x > 0.1\nparam x = x",
    "import random\ndef f(v): return v + random.random()\nx = Range(0, 1)\nrequire f(x) < 1\nparam x = x",
    "import random\ndef f(): return random.random()\nrequire f() < 0.3\nparam x = 1",
    (
        "r = Uniform(CircularRegion((0, 0), 2), BoxRegion((1, 2, 3)), RectangularRegion((5, 5), 1, 2, 3))\n"
        "p = new Point in r\nparam x = p.position"
    ),
    (
        "workspace = Workspace(RectangularRegion((0, 0, 0), 0, 9, 9))\nfor _ in range(6):\n"
        "    new Object in workspace, facing Range(0, 6), with width Range(1, 2)\nparam x = 1"
    ),
    (
        "a = new Object at (Range(-9, 9), 0)\nb = new Object left of a by Range(0, 1)\nc = Uniform(a, b)\n"
        "param x = (c.position, Uniform([1, 2], [3])[0], str(c.x))\nrequire c.x > 0"
    ),
    (
        "p = Uniform(*[new OrientedPoint at (Range(i, i + 1), Range(0, 2)), facing Range(0, 1) for i in range(12)])\n"
        "q = Discrete({Normal(i, 1 + i) * Range(0, 1) + Uniform(*[DiscreteRange(j, 9) for j in range(15)]): i + 1 for i in range(20)})\n"
        "ego = new Object at p, facing p.heading\nparam x = (p.x, q)\nrequire q > 2"
    ),
    (
        "x = Normal(0, 1)\ny = TruncatedNormal(x, 1, -1, 2)\nz = Discrete({x: 1, y: 2})\nparam x = (x, y, z, resample(x))\n"
        "require z > x or y > 0"
    ),
]
TAILS = [
    "\nq = DiscreteRange(0, 9)\nrequire[0.6] q > 3\nrequire q == 0 or 1 / q > 0.12\n",
    "\nimport random\ndef coin(v): return random.random() < v\nlevel = Range(0.4, 1)\nrequire coin(level)\n",
]
SOME = RECORDED if LONG else RECORDED[::2]
PROGRAMS = [*OWN, *SOME[::2], *(text + TAILS[number % 2] for number, text in enumerate(SOME))]
FEW = 4


def shown(program: Scenario, result: Any) -> Any:
    """Everything of a scene, bit for bit."""
    if isinstance(result, Exhausted):
        return result.attempts
    things = [(repr(item.position), repr(item.orientation), item.width) for item in result.objects]
    exact = [tuple(value.hex() for value in item.position) for item in result.objects]
    return result.attempts, repr(result.params), things, exact


def scenes(program: Scenario, lanes: int) -> list[Any]:
    results = program.stream(FEW, seed=3, lanes=lanes, max_attempts=300)
    return [shown(program, result) for result in results]


def test_there_are_many_programs() -> None:
    assert len(PROGRAMS) >= 60


@pytest.mark.parametrize("number", range(len(PROGRAMS)))
def test_company_changes_no_bit(number: int) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        program = scenario(PROGRAMS[number])
        first = scenes(program, 4096)
        for lanes in (1, 2, 7, 512) if LONG else (1, 7):
            assert scenes(program, lanes) == first, lanes
        # One at a time, from a program that is compiled anew, and with every node evaluated by itself.
        again = scenario(PROGRAMS[number])
        assert [
            shown(again, *again.stream(1, seed=3, first=k, max_attempts=300)) for k in range(FEW)
        ] == first
        plan = program.outline.plan(program.domain)
        single: Engine | PiecewiseEngine = Engine(plan, grouped=False)
        if isinstance(finder := program._sampler._finder, PiecewiseEngine):
            single = PiecewiseEngine(Engine(plan, grouped=False), finder._components)
        tasks = [SceneTask(3, k) for k in range(FEW)]
        attempts = [
            result.attempts if isinstance(result, Exhausted) else result[0].attempts[result[1]]
            for result in single.scenes(tasks, max_attempts=300, lanes=16)
        ]
        assert attempts == [item if isinstance(item, int) else item[0] for item in first]


@pytest.mark.parametrize("text", OWN[4:])
def test_what_is_added_changes_no_other_draw(text: str) -> None:
    plain = scenario(text)
    more = scenario(
        f"{text}\nunrelated = Range(0, 5)\nparam other = unrelated\nrequire unrelated >= 0\n"
        "extra = new Point at (Range(0, 1), Normal(0, 2))\n"
    )
    for one, other in zip(plain.sample(6, seed=9), more.sample(6, seed=9), strict=True):
        assert repr(one.params["x"]) == repr(other.params["x"])
        assert one.attempts == other.attempts
        assert [repr(item.position) for item in one.objects] == [
            repr(item.position) for item in other.objects
        ]


def test_remarks_change_neither_draws_nor_digest() -> None:
    plain = scenario("x = Range(0, 1)\ny = Uniform('#1', \"it's #2\") if True else 0\nparam x = x, y = y\n")
    told = scenario(
        "# first\nx = Range(0, 1)  # a number\ny = Uniform('#1', \"it's #2\") if True else 0 # 'one'\nparam x = x, y = y#\n"
    )
    (one,) = plain.sample(1, seed=5)
    assert told.sample(1, seed=5)[0].params == one.params
    assert told.digest == plain.digest
    assert told.sceneFromBytes(plain.sceneToBytes(one)).params == one.params
