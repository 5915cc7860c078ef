"""Choices among many alike options: merged they are what they are without, and evaluated once a lane."""

from typing import Any

import numpy as np
import pytest

import scenic
from scenic.graph.batch import Batch
from scenic.graph.domain import Domain
from scenic.graph.draws import Counter, Points, each_of_distinct
from scenic.graph.merging import Merger
from scenic.graph.node import Graph, Node, axis
from scenic.graph.operation import OK
from scenic.graph.schedule import ChosenDraw, DrawStep, Scheduler, Step
from tests.graph.programs import CODEC, make, one_of, uniform

LANES = 500


def term(number: int) -> Node:
    return make("add", make("multiply", uniform(0.0, 1.0 + number), 2.0), float(number))


def uneven(number: int) -> Node:
    """What is not like the others now and then: a constant, a bare axis, another operation."""
    if number % 7 == 3:
        return make("subtract", uniform(0.0, 2.0), 1.0)
    return [term(number), axis(), make("add", 1.0, 2.5)][0 if number > 2 else number]


def risky(number: int) -> Node:
    """Undefined in half of the lanes of every third option."""
    return make("divide", 1.0, make("maximum", 0.0, make("subtract", axis(), 0.5 * (number % 3 == 0))))


def vectors(number: int) -> Node:
    return make("add", make("vector", term(number), axis(), float(number)), make("vector", 1.0, 2.0, 3.0))


def nested(number: int) -> Node:
    return make("add", one_of(*(term(inner + number) for inner in range(9))), float(number))


SHARED = [axis() for _ in range(3)]


def sharing(number: int) -> Node:
    """Made of the same few nodes in turn, the first of which is in the last option too."""
    return make("add", make("multiply", SHARED[number % 3 if number % 13 else 0], 2.0), number + 1.5)


def few(number: int) -> Node:
    """Made of one, two and four different operands in turn, the same of which come again in a row and apart."""
    inner = make("multiply", SHARED[number // 3 % 2], [2.0, 3.0, 5.0, 7.0][number % 4])
    return make("subtract", make("add", inner, SHARED[2]), float(number % 2))


def batches(root: Node, **options: Any) -> tuple[Batch, Batch]:
    graph = Graph([root])
    source = Counter(np.arange(LANES, dtype=np.uint64))
    merged, plain = (
        Batch(Scheduler(graph, grouped=grouped), source, CODEC, **options) for grouped in (True, False)
    )
    return merged, plain


def assert_same(merged: Batch, plain: Batch, root: Node) -> None:
    statuses = [batch.status(root) for batch in (merged, plain)]
    fine = [np.full(len(plain), OK) if status is None else status for status in statuses]
    np.testing.assert_array_equal(*fine)
    np.testing.assert_array_equal(merged.full(root)[fine[0] == OK], plain.full(root)[fine[0] == OK])


@pytest.mark.parametrize("option", [term, uneven, risky, vectors, nested, sharing, few])
@pytest.mark.parametrize("count", [2, 8, 9, 10, 40])
def test_merged_choices_have_the_same_values(option: Any, count: int) -> None:
    options = [option(number) for number in range(count)]
    if option is uneven:  # numbers of the vector kinds cannot be among those
        options = [item for item in options if item.kind is options[0].kind]
    root = make("negative", one_of(*options)) if option is not vectors else one_of(*options)
    merged, plain = batches(root)
    assert_same(merged, plain, root)
    for batch in (merged, plain):
        batch.keep(np.arange(LANES) % 3 == 1)
    assert_same(merged, plain, root)


def test_drawn_options_alone_are_evaluated() -> None:
    root = one_of(*(term(number) for number in range(200)))
    scheduler = Scheduler(Graph([root]))
    steps = scheduler.after(scheduler.start, (root,)).steps
    assert sum(len(step.nodes) for step in steps if isinstance(step, Step)) < 20
    assert sum(len(step.addresses) for step in steps if isinstance(step, DrawStep)) < 4
    (chosen,) = (step for step in steps if isinstance(step, ChosenDraw))
    assert len(chosen.addresses) > 190


def test_options_are_there_when_they_are_asked_for() -> None:
    options = [term(number) for number in range(20)]
    root = one_of(*options)
    graph = Graph([root, options[4]])
    batch, plain = (
        Batch(Scheduler(graph, grouped=grouped), Counter(np.arange(LANES, dtype=np.uint64)), CODEC)
        for grouped in (True, False)
    )
    for node in (root, options[4], root.operands[0]):
        assert_same(batch, plain, node)
    taken = batch.full(root.operands[0]) == 4
    assert taken.any()
    np.testing.assert_array_equal(batch.full(root)[taken], batch.full(options[4])[taken])


def test_chosen_draws_lie_in_the_domain() -> None:
    """Two boxes that cut the options' axes differently."""
    root = one_of(*(axis() for _ in range(12)))
    graph = Graph([root])
    lower, upper = np.zeros((2, graph.dimension)), np.ones((2, graph.dimension))
    lower[0, 3:7], upper[1, 1:5] = 0.75, 0.25
    merged, plain = batches(root, domain=Domain(lower, upper))
    assert_same(merged, plain, root)
    share = (plain.full(root) > 0.75).mean()
    assert 0.25 < share < 0.42


def test_each_lane_has_its_own_address() -> None:
    hashed = Counter(np.arange(6, dtype=np.uint64))
    given = Points({5: np.linspace(0.1, 0.6, 6)}, hashed)
    addresses = np.array([5, 7, 5, 9, 7, 5], dtype=np.uint64)
    for source in (hashed, given):
        expected = [source.uniforms(addresses[lane : lane + 1])[0, lane] for lane in range(6)]
        assert source.uniform_each(addresses).tolist() == expected
        assert each_of_distinct(source, addresses).tolist() == expected


def test_chains_of_any_length_are_merged_or_left() -> None:
    def chain(number: int) -> Node:
        node = uniform(0.0, 1.0)
        for _ in range(600):
            node = make("add", make("multiply", node, 0.75), float(number + 1))
        return node

    root = one_of(*(chain(number) for number in range(10)))
    assert_same(*batches(root), root)
    merger = Merger()
    assert merger(root) is merger(root) is not root


def test_saved_scenes_and_points_of_sobol_come_back(tmp_path: Any) -> None:
    text = (
        "x = Uniform(*[new OrientedPoint at (Range(i, i + 1), Range(0, 1), 0), facing Range(0, 1) for i in range(30)])\n"
        "ego = new Object at x, with y x.heading, facing x.heading\nrequire ego.x > 1\n"
    )
    scenario = scenic.scenarioFromString(text)
    for source in (None, scenic.Sobol()):
        for scene in scenario.sample(6, seed=2, source=source):
            scene.save(tmp_path / "one.scene")
            again = scenario.replay(tmp_path / "one.scene")
            for before, after in zip(scene.objects, again.objects, strict=True):
                assert before.position == after.position
                assert before.orientation == after.orientation
                assert before.y == after.y
