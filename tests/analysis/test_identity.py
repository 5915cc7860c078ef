"""Digests of what narrowing reads: equal for a program loaded twice, different where any of it differs."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from scenic import scenarioFromString
from scenic.analysis.contraction import nodes_below
from scenic.analysis.identity import identity
from scenic.graph.node import Node
from scenic.narrowing import conditions

PROGRAM = """
region = {region}
ego = new Object at (Range(-5, 5), Range(-5, {far!r}), 0)
other = new Object in region, facing {heading}
require {measure}(distance from ego to other) < {near!r}
require ego.x > 0
require other.heading < 0.5
"""

USUAL: Mapping[str, Any] = {
    "region": "RectangularRegion((0, 0, 0), 0, 6, 6)",
    "far": 5.0,
    "heading": "Range(0, 1)",
    "near": 3.0,
    "measure": "",
}

OTHERS: Mapping[str, Any] = {
    "region": "RectangularRegion((0, 0, 0), 0, 6, 6.5)",
    "far": math.nextafter(5.0, 6),
    "heading": "Range(0, 2)",
    "near": math.nextafter(3.0, 4),
    "measure": "2 * ",
}


def digest(program: Mapping[str, Any], met: Mapping[int, np.ndarray] | None = None) -> bytes | None:
    outline = scenarioFromString(PROGRAM.format(**{**USUAL, **program})).outline
    nodes: list[Node] = [fact.node for fact in conditions(outline)]
    masks = {nodes[number]: mask for number, mask in (met or {}).items()}
    return identity(outline.graph, nodes_below(nodes), nodes, masks)


def test_a_program_loaded_twice_has_one_digest() -> None:
    assert digest({}) == digest({}) is not None


def test_programs_that_differ_have_different_digests() -> None:
    digests = {digest({name: other}) for name, other in OTHERS.items()} | {digest({})}
    assert len(digests) == len(OTHERS) + 1
    assert None not in digests


def test_candidates_that_met_a_condition_are_part_of_it() -> None:
    half, other = np.arange(8) % 2 == 0, np.arange(8) % 2 == 1
    assert len({digest({}), digest({}, {0: half}), digest({}, {0: other}), digest({}, {1: half})}) == 4


@pytest.mark.parametrize(
    "call",
    ["measured", "scenic.bounded(lambda lower, upper: (lower, upper))(measured)"],
    ids=["opaque", "bounded"],
)
def test_functions_of_a_program_have_no_digest(call: str) -> None:
    """Their meaning may change while their names remain."""
    text = "import scenic\ndef measured(value): return value + 1\n"
    program = f"{text}ego = new Object at (Range(0, 1), 0, 0)\nrequire {call}(ego.x) > 1.5\n"
    outline = scenarioFromString(program).outline
    nodes = [fact.node for fact in conditions(outline)]
    assert identity(outline.graph, nodes_below(nodes), nodes, {}) is None
