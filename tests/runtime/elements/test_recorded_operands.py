"""The table of operands: every operator, specifier, method and function accepts or refuses each kind as recorded.

A case is a template; ``{a}`` stands for each kind of operand in turn, ``{b}`` and ``{n}`` for some. Accepted operands have a
line each with the value; refused ones stand together behind the code of their diagnostic, so that a change of a message
leaves the table as it is. (The words of messages are tested in `tests.compiler.test_messages` and beside each feature.)
"""

from collections import defaultdict
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import pytest
import scenic.syntax.translator

from scenic.failures import diagnose
from scenic.language.errors import InvalidScenarioError, RejectionException
from scenic.runtime.instances.objects import Point
from scenic.runtime.sampling.engine import CandidateError
from scenic.runtime.sampling.pending import SceneTask
from scenic.runtime.sampling.piecewise import PiecewiseEngine
from scenic.runtime.values.values import as_node
from tests.recorded import FOLDER, hold, shown, unusual

KINDS = {
    "integer": "3",
    "float": "-0.7",
    "bool": "True",
    "random": "Range(0.3, 0.9)",
    "whole": "DiscreteRange(2, 4)",
    "pair": "(4, 5)",
    "vector": "Vector(1.5, -2, 0.4)",
    "moving": "(Range(1, 2), -3, 0.25)",
    "place": "Uniform(Vector(1, 2, 3), Vector(-2, 1, 4))",
    "turn": "Orientation.fromEuler(0.3, 0.2, -0.1)",
    "turning": "Orientation.fromEuler(Range(0.1, 0.6), 0.2, -0.1)",
    "point": "point",
    "oriented": "oriented",
    "object": "thing",
    "one of": "Uniform(thing, ego)",
    "mixed": "Uniform(0.5, 2)",
    "region": "disc",
    "field": "flow",
    "string": "'word'",
    "list": "[1, 2.5, -3, 4]",
    "none": "None",
    "array": "np.array([4, 5])",
    "numpy": "np.float64(0.5)",
    "class": "Object",
    "infinite": "math.inf",
    "huge": "10**30",
    "unknown": "given(0.5, Range(0, 1))",
    "unknown object": "given(thing, Range(0, 1))",
}

SECOND = {
    "b": ("random", "moving", "one of", "list"),
    "n": ("random", "moving"),
}
"""Kinds of the second of two operands; fewer where most others would fail only on a sample, one by one."""

PREAMBLE = """
import math
import numpy as np
from scenic.core.distributions import distributionFunction
flow = VectorField("flow", lambda p: 0.1 * p.x - 0.2 * p.y)
disc = CircularRegion((2, -1, 0.5), 3)
workspace = Workspace(BoxRegion(position=(0, 0, 0), dimensions=(80, 90, 100)))
ego = new Object at (9, -7, 1), facing (0.4, 0.1, -0.2), with width 0.6, with length 1.7, with height 0.9
point = new Point at (6, 5, -4)
oriented = new OrientedPoint at (-5, 8, 2), facing (1.1, -0.3, 0.2)
thing = new Object at (-12, -9, 3), facing (-0.8, 0.35, 0.5), with width 2.2, with length 1.3, with height 0.7
def helper(value, other=2):
    return (value, other)
@distributionFunction
def given(value, other):
    return value
answers = {}
def attempt(key, function):
    try:
        answers[key] = function()
    except Exception as error:
        answers[key] = error
"""


SEED = 3


def expressions(template: str) -> Iterator[tuple[str, str]]:
    """Each choice of operands of a template, as its name and its text."""
    places = {
        place: KINDS if place == "a" else SECOND[place] for place in "abn" if f"{{{place}}}" in template
    }
    for names in product(*places.values()):
        operands = {place: f"({KINDS[name]})" for place, name in zip(places, names, strict=True)}
        yield ", ".join(names) or "alone", template.format(**operands)


def answers(source: str) -> str:
    asked = list(expressions(source.rstrip("\n")))
    found = some([text for _, text in asked])
    accepted, refused = [], defaultdict(list)
    for (name, _), answer in zip(asked, found, strict=True):
        if isinstance(answer, Refusal):
            refused[answer.code].append(name)
        else:
            accepted.append(f"{name} -> {answer}")
    return "\n".join([*accepted, *(f"{code}: {'; '.join(names)}" for code, names in sorted(refused.items()))])


class Refusal(NamedTuple):
    """The code of the diagnostic of a refused expression, or the type of an error without one."""

    code: str


def some(asked: list[str]) -> list[str | Refusal]:
    """The answers of many expressions, together in one program but for those in which a sample has a fault."""
    answers: dict[int, str | Refusal] = {}
    left = dict(enumerate(asked))
    while left:
        calls = "".join(f"attempt({number}, lambda: {text})\n" for number, text in left.items())
        scenario = None
        try:
            scenario = scenic.scenarioFromString(f"{PREAMBLE}{calls}param answers = answers\n")
            (scene,) = scenario.sample(1, seed=SEED, max_attempts=60)
        except Exception as error:  # noqa: BLE001 - what is said of it is the answer
            found = {} if scenario is None else faults(scenario)
            at_fault = [next(iter(left))] if len(left) == 1 else [*left][_line(error)]
            found |= dict.fromkeys(at_fault, told(error))
            if not found:
                middle = len(left) // 2
                halves = [[*left.values()][:middle], [*left.values()][middle:]]
                found = dict(zip(left, [answer for half in halves for answer in some(half)], strict=True))
            answers |= found
            left = {number: text for number, text in left.items() if number not in found}
        else:
            answers |= {number: told(value) for number, value in scene.params["answers"].items()}
            left = {}
    return [answers[number] for number in range(len(asked))]


def faults(scenario: scenic.Scenario) -> dict[int, str | Refusal]:
    """Diagnostics of the attempts that fail in the first candidate, each evaluated alone: a program reports the first alone."""
    engine = scenario._sampler.engine
    whole = engine._whole if isinstance(engine, PiecewiseEngine) else engine
    batch = whole._alone(SceneTask(SEED, 0), 0)
    check: Any = SimpleNamespace(label="parameters", span=None, filename=None)
    found: dict[int, str | Refusal] = {}
    for number, value in scenario.params["answers"].items():
        if isinstance(value, Point):
            continue  # checks look at those in an order of their own
        node = as_node(value)
        batch.need([node])
        if node in batch.errors:
            error = CandidateError(check, 0, 1)
            error.__cause__ = batch.errors[node]
            found[number] = told(scenario._sampling_error(error))
    return found


def _line(error: Exception) -> slice:
    """Which of the attempts of a program an error names by its line: one or none."""
    found = None if isinstance(error, InvalidScenarioError | RejectionException) else diagnose(error)
    line = found.span.line - PREAMBLE.count("\n") - 1 if found and found.span else -1
    return slice(line, line + 1) if line >= 0 else slice(0)


def told(value: object) -> str | Refusal:
    if isinstance(value, Point):
        left_out = {"allowCollisions", "tag"}
        return ", ".join(f"{name} {text}" for name, text in unusual(value).items() if name not in left_out)
    if isinstance(value, Exception):
        found = diagnose(value)
        return Refusal(type(value).__name__ if found is None else found.code)
    return shown(value)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("operands_*.txt")), ids=lambda path: path.stem)
def test_operands_of_every_kind(
    path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Narrowing would take half of the time, and is not asked about here.
    monkeypatch.setattr(scenic.syntax.translator, "usePruning", False, raising=False)
    hold(path, answers, request)
