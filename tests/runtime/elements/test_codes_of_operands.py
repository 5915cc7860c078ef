"""An operator or specifier refuses an operand of a wrong type with one code, be the operand definite, drawn, a choice or open.

Each is asked twice, of a definite operand and of a random one of the same kind. Where both are refused, while
the program is loaded or in a sample, the codes must agree.
"""

import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.graph.batch import Batch
from scenic.graph.draws import Counter
from scenic.graph.node import Graph, Node
from scenic.graph.operation import FAULT
from scenic.graph.schedule import Scheduler
from scenic.language.errors import Located
from scenic.language.operators import OPERATORS, SIDES, Operator
from scenic.language.specifiers import SPECIFIERS, SpecifierDeclaration
from scenic.runtime.values.values import CODEC, Random

KINDS = {
    "number": ("0.5", "Range(0, 1)"),
    "boolean": ("True", "Uniform(True, False)"),
    "vector": ("Vector(1, 2, 3)", "Vector(Range(1, 2), 2, 3)"),
    "orientation": ("turn", "Orientation.fromEuler(Range(0, 1), 0, 0)"),
    "point": ("point", None),
    "oriented point": ("oriented", None),
    "object": ("thing", None),
    "region": ("disc", None),
    "field": ("flow", None),
    "shape": ("BoxShape()", None),
    "string": ("'word'", None),
    "list": ("[1, 2.5, -3, 4]", "[Range(0, 1), 2.5, -3, 4]"),
    "none": ("nothing", None),
    "class": ("cls", None),
}
"""The text of a definite operand of each kind, and of one that is drawn."""

SECOND = ("object", "field")
"""Kinds of the operand that stays definite."""

PREAMBLE = """
from scenic.core.distributions import distributionFunction
flow = VectorField("flow", lambda p: 0.1 * p.x - 0.2 * p.y)
disc = CircularRegion((2, -1, 0.5), 3)
turn = Orientation.fromEuler(0.3, 0.2, -0.1)
nothing, cls = None, Object
workspace = Workspace(BoxRegion(position=(0, 0, 0), dimensions=(80, 90, 100)))
ego = new Object at (9, -7, 1)
point = new Point at (6, 5, -4)
oriented = new OrientedPoint at (-5, 8, 2)
thing = new Object at (-12, -9, 3)
@distributionFunction
def given(value, other):
    return value
"""


def form_of(declared: Operator | SpecifierDeclaration) -> str:
    """How an element is written with all operands, each as a field to be filled in."""
    words = declared.forms[-1].split()
    for operand in declared.operands:  # Keywords of the same name stand before it.
        if operand.name in words:
            words[len(words) - 1 - words[::-1].index(operand.name)] = f"({{{operand.name}}})"
    return " ".join(words)


def random_texts(kind: str) -> Iterator[str]:
    """A random operand of a kind: a choice, one of which only the draw shows what it is, and one that is drawn."""
    definite, drawn = KINDS[kind]
    yield f"Uniform({definite}, {definite})"
    yield f"given({definite}, Range(0, 1))"
    if drawn:
        yield drawn


def operators() -> Iterator[str]:
    """Each operator, but one alone of the sides, which are one function."""
    for name, declared in OPERATORS.items():
        if name.removesuffix(" of") not in SIDES[1:]:
            yield form_of(declared)


def specifiers() -> Iterator[str]:
    """What each specifier gives a new object; one alone of those that differ by a direction."""
    for name, declared in SPECIFIERS.items():
        if name not in ("with", "right of", "ahead of", "behind", "above", "below"):
            given = "orientation" if declared.group == "orientation" else "position"
            yield f"(new Object {form_of(declared)}, with allowCollisions True).{given}"


def cases(forms: Iterator[str]) -> Iterator[tuple[str, list[str]]]:
    """An expression over a definite operand, and those over random ones in its place."""
    for form in forms:
        names = re.findall(r"\{(\w+)\}", form)
        for asked in names:
            for others in seconds(len(names) - 1):
                rest = dict(zip([each for each in names if each != asked], others, strict=True))
                filled = {each: KINDS[kind][0] for each, kind in rest.items()}
                for kind in KINDS:
                    yield (
                        form.format(**filled, **{asked: KINDS[kind][0]}),
                        [form.format(**filled, **{asked: text}) for text in random_texts(kind)],
                    )


def seconds(count: int) -> list[tuple[str, ...]]:
    if count == 0:
        return [()]
    if count == 1:
        return [(kind,) for kind in SECOND]
    return [("field", "vector"), ("vector", "number")]


def codes(expressions: list[str]) -> list[str | None]:
    """The code with which each expression is refused while the program is loaded or in a sample, if it is."""
    answers: list[Any] = []

    def attempt(function: Callable[[], Any]) -> None:
        try:
            answers.append(function())
        except Exception as error:  # noqa: BLE001 - its code is the answer
            answers.append(error.with_traceback(None))  # whose frames would keep all programs in memory

    asked = "".join(f"attempt(lambda: {text})\n" for text in expressions)
    program = f"{PREAMBLE}attempt = globalParameters.attempt\n{asked}"
    scenic.scenarioFromString(program, params={"attempt": attempt})
    nodes = [answer.node for answer in answers if isinstance(answer, Random)]
    batch = Batch(Scheduler(Graph(nodes), grouped=False), Counter(np.array([7], dtype=np.uint64)), CODEC)
    batch.need(nodes)
    found = [
        code_of(answer)
        if isinstance(answer, Exception)
        else code_in(batch, answer.node)
        if isinstance(answer, Random)
        else None
        for answer in answers
    ]
    answers.clear()  # which the program has a constant of, and would keep in memory
    return found


def code_of(error: BaseException) -> str:
    return error.code if isinstance(error, Located) else type(error).__name__


def code_in(batch: Batch, node: Node) -> str | None:
    status = batch.status(node)
    if status is None or status[0] != FAULT:
        return None
    failed = next(each for each in Graph([node]).nodes if each in batch.errors)
    return code_of(batch.errors[failed])


@pytest.mark.parametrize("forms", [operators, specifiers])
def test_definite_and_random_operands_are_refused_alike(forms: Callable[[], Iterator[str]]) -> None:
    asked = list(cases(forms()))
    expressions = list(dict.fromkeys(text for definite, random in asked for text in (definite, *random)))
    found = dict(zip(expressions, codes(expressions), strict=True))
    pairs = {(definite, other) for definite, random in asked for other in random}
    refused = [pair for pair in pairs if found[pair[0]] and found[pair[1]]]
    different = sorted(
        f"{definite}: {found[definite]}; {other}: {found[other]}"
        for definite, other in refused
        if found[definite] != found[other]
    )
    assert len(refused) > 700
    assert not different, f"{len(different)} of {len(refused)}\n" + "\n".join(different)
