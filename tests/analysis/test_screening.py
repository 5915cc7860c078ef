"""The choice of the conditions that are narrowed for."""

import numpy as np
import pytest
from numpy.typing import NDArray

import scenic
from scenic.analysis.facts import Fact
from scenic.analysis.screening import FREQUENT, seldom_met
from scenic.graph.node import Node, axis

Mask = NDArray[np.bool_]


def fact(name: str) -> Fact:
    return Fact(axis(), name)


def met(share: float, count: int = 100) -> Mask:
    return np.arange(count) < share * count


def names(groups: list[list[Fact]]) -> list[str]:
    return ["".join(item.label for item in group) for group in groups]


def test_groups_are_left_out_as_long_as_most_candidates_meet_them_together() -> None:
    a, b, c, d = (fact(name) for name in "abcd")
    masks: dict[Node, Mask] = {
        a.node: ~met(0.1),
        b.node: met(0.95),
        c.node: met(0.92),
        d.node: met(1.0),
    }
    assert FREQUENT == 0.8
    # Of 100 candidates 92 meet b, c and d, and 82 also a.
    assert names(seldom_met([[a], [b], [c], [d]], masks)) == []
    e = fact("e")
    assert names(seldom_met([[a], [b], [e], [c]], masks | {e.node: np.arange(100) % 4 > 0})) == ["e"]


def test_a_group_remains_as_a_whole() -> None:
    a, b, c = (fact(name) for name in "abc")
    masks: dict[Node, Mask] = {a.node: met(1.0), b.node: met(0.5), c.node: met(0.9)}
    assert names(seldom_met([[a, b], [c]], masks)) == ["ab"]


def test_conditions_of_which_nothing_is_known_remain() -> None:
    a, b = fact("a"), fact("b")
    assert names(seldom_met([[a], [b]], {b.node: met(1.0)})) == ["a"]


def lower(text: str) -> list[float]:
    domain = scenic.scenarioFromString(text).domain
    return [
        float(min(part.lower[:, axis].min() for part in domain.parts)) for axis in range(domain.dimension)
    ]


def test_what_most_candidates_meet_is_not_narrowed() -> None:
    text = "x, y = Range(0, 1), Range(0, 1)\nrequire x > 0.02\n{}param p = [x, y]\n"
    assert lower(text.format("")) == [0, 0]
    assert lower(text.format("require y > 0.5\n")) == pytest.approx([0, 0.5])
    assert lower(text.format("require y + x > 1.5\n")) == pytest.approx([0.5, 0.5], abs=1e-6)


def test_a_contradiction_is_told_at_load() -> None:
    program = "x, y = Range(0, 1), Range(0, 1)\nrequire y > 0.02\nrequire x > 2\nparam p = [x, y]\n"
    assert scenic.scenarioFromString(program).impossible == ("requirement on line 3",)
