"""What is evaluated together, and what is not: groups, runs of members, and what is there already."""

import tracemalloc

import numpy as np
import pytest

import scenic
from scenic.graph.node import Graph, axis
from scenic.graph.operation import FAULT, OK
from scenic.graph.schedule import (
    ChosenDraw,
    ColumnPlace,
    ColumnRun,
    DrawStep,
    Gathered,
    Scheduler,
    Step,
    _run,
)
from tests.graph.programs import batch_at, make


@pytest.mark.parametrize(
    ("members", "run"),
    [
        ([2], slice(2, 3)),
        ([0, 1, 2], slice(0, 3, 1)),
        ([1, 3, 5], slice(1, 6, 2)),
        ([4, 4, 4], slice(4, 5)),
        ([0, 1, 1, 3], None),  # its ends are as far apart as those of a run
        ([0, 2, 2, 6], None),
        ([3, 2, 1], None),
    ],
)
def test_runs_are_steps_of_one_length(members: list[int], run: slice | None) -> None:
    found = _run([ColumnPlace(7, member) for member in members])
    assert found == (None if run is None else ColumnRun(7, run))
    assert _run([*(ColumnPlace(7, member) for member in members), ColumnPlace(8, members[-1] + 1)]) is None


def test_members_in_any_order_keep_their_own_operands() -> None:
    """Alike operations over operands that lie together, apart, twice, and backwards."""
    x = [axis(None, number) for number in range(6)]
    sums = [make("add", number, 1.0) for number in x]
    pairs = [(0, 1), (1, 1), (5, 4), (2, 0), (3, 5), (4, 4), (2, 3)]
    differences = [make("subtract", sums[i], sums[j]) for i, j in pairs]
    graph = Graph(differences)
    points = np.random.default_rng(1).random((5, graph.dimension))
    of = {node: points[:, place] for node, place in graph.axes.items()}
    for grouped in (True, False):
        batch = batch_at(graph, points, grouped=grouped)
        for (i, j), node in zip(pairs, differences, strict=True):
            np.testing.assert_array_equal(batch.column(node), (of[x[i]] + 1) - (of[x[j]] + 1))


def test_one_member_that_may_fail_is_enough() -> None:
    """Alike divisions: by a number that is never 0, and by one that may be."""
    dividends = [make("add", axis(None, number), 1.0) for number in range(4)]
    divisor = axis(None, 9)
    safe = [make("divide", number, 2.0) for number in dividends]
    risky = make("divide", dividends[0], make("subtract", divisor, 0.25))
    graph = Graph([*safe, risky])
    points = np.full((2, graph.dimension), 0.75)
    points[0, graph.axes[divisor]] = 0.25
    batch = batch_at(graph, points)
    batch.need([*safe, risky])
    assert [batch.status(risky)[lane] for lane in (0, 1)] == [FAULT, OK]
    for node in safe:
        assert batch.column(node).tolist() == [0.875, 0.875]


def test_what_is_there_is_not_evaluated_again() -> None:
    x = axis(None, 1)
    first, second = make("add", x, 1.0), make("multiply", x, 3.0)
    scheduler = Scheduler(Graph([first, second]))
    before = scheduler.after(scheduler.start, (first,))
    assert before.steps
    assert scheduler.after(before, (first, x)).steps == ()
    (step,) = scheduler.after(before, (first, second)).steps
    assert step.nodes == (second,)
    both = scheduler.after(before, (second,))
    gathered = scheduler.gather(both, (first, second, first))
    assert gathered == Gathered((before.places[first], both.places[second], before.places[first]))


def test_alike_products_of_small_and_of_large_integers_are_kept_apart() -> None:
    """Those that fit into machine integers from those that need Python's."""
    text = (
        "a, b = DiscreteRange(0, 1), DiscreteRange(0, 1)\n"
        "c, d = DiscreteRange(2**51, 2**52), DiscreteRange(2**51, 2**52)\n"
        "param parts = [a, b, c, d], small = a * b, large = c * d\n"
    )
    for scene in scenic.scenarioFromString(text).sample(20, seed=1):
        a, b, c, d = scene.params["parts"]
        assert (scene.params["small"], scene.params["large"]) == (a * b, c * d)
        assert type(scene.params["large"]) is int


def test_alike_powers_of_either_kind_are_kept_apart() -> None:
    """The sign of an exponent decides between an integer and a float, where all operands are integers."""
    text = (
        "n, m, base = DiscreteRange(0, 3), DiscreteRange(-3, -1), DiscreteRange(2, 4)\n"
        "param parts = [base, n, m], whole = base ** n, broken = base ** m, other = 2 ** n, last = 2 ** m\n"
    )
    for order in (
        text,
        text.replace("whole = base ** n, broken = base ** m", "broken = base ** m, whole = base ** n"),
    ):
        for scene in scenic.scenarioFromString(order).sample(10, seed=1):
            base, n, m = scene.params["parts"]
            expected = {"whole": base**n, "broken": base**m, "other": 2**n, "last": 2**m}
            found = {name: scene.params[name] for name in expected}
            assert found == expected
            assert {name: type(value) for name, value in found.items()} == {
                name: type(value) for name, value in expected.items()
            }


def test_chains_change_no_value() -> None:
    """Stages in any order, with lanes dropped between them; and other nodes asked for in the middle, which ends a chain."""
    x = [axis(None, number) for number in range(5)]
    sums = [make("add", number, 1.0) for number in x]
    products = [make("multiply", sums[i], sums[j]) for i, j in ((0, 1), (1, 2), (2, 3), (3, 4), (0, 4))]
    chosen = make("select", make("int", make("multiply", x[0], 3)), *sums[1:4])
    nodes = [*sums, *products, chosen, make("divide", products[0], make("subtract", x[2], 0.5))]
    graph = Graph(nodes)
    random = np.random.default_rng(7)
    points = random.random((6, graph.dimension))
    points[0, graph.axes[x[2]]] = 0.5
    plain = batch_at(graph, points)
    expected = {node: plain.full(node) for node in nodes}
    for grouped in (True, False):
        for _ in range(40):
            order = [nodes[place] for place in random.permutation(len(nodes))]
            stages = [order[:3], order[3:5], order[5:5], order[5:9], order[9:]]
            batch = batch_at(graph, points, grouped=grouped)
            chain = batch._scheduler.chain(stages)
            aside = int(random.integers(8))
            for number, (stage, schedule) in enumerate(zip(stages, chain, strict=True)):
                batch.follow(schedule, stage)
                if number == aside:
                    other = nodes[int(random.integers(len(nodes)))]
                    assert batch.full(other).tolist() == expected[other][batch.rows].tolist()
                for node in stage:
                    assert batch.full(node).tolist() == expected[node][batch.rows].tolist()
                    whole = plain.status(node)
                    found = batch.status(node)
                    left = None if whole is None else whole[batch.rows]
                    assert (found is None) is (left is None or not left.any())
                batch.keep(random.random(len(batch)) < 0.9)
            for node in nodes:
                assert batch.full(node).tolist() == expected[node][batch.rows].tolist()


def test_columns_are_freed_after_their_last_use() -> None:
    """A chain of hundreds takes the memory of a few columns, where only its end is wanted."""
    lanes = 20_000
    start = axis(None, 1)
    node, middle = start, start
    for number in range(300):
        node = make("multiply", make("add", node, 1.0), 0.5 + number / 300)
        middle = node if number == 150 else middle
    graph = Graph([node])
    points = np.random.default_rng(1).random((lanes, 1))
    values = []
    for chained in (False, True):
        batch = batch_at(graph, points)
        tracemalloc.start()
        if chained:
            first, second = batch._scheduler.chain([[middle], [node]])
            batch.follow(first, [middle])
            batch.follow(second, [node])
        else:
            batch.need([middle])
            batch.need([node])
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        values.append(batch.column(node))
        columns = peak / (8 * lanes)
        assert columns < 40 if chained else columns > 500  # some are the schedule itself
    np.testing.assert_array_equal(*values)


def read_by(step: DrawStep | ChosenDraw | Step) -> set[int]:
    """The slots that a step reads: those of its operands, however they are gathered."""
    gathers = (
        () if isinstance(step, DrawStep) else (step.index,) if isinstance(step, ChosenDraw) else step.operands
    )
    slots = set()
    for gather in gathers:
        if isinstance(gather, ColumnRun):
            slots.add(gather.slot)
        elif isinstance(gather, Gathered):
            slots |= {part.slot for part in gather.parts if isinstance(part, ColumnPlace)}
    return slots


def test_a_chain_keeps_what_is_still_read_and_nothing_else() -> None:
    """After each stage exactly the columns are there that a later step reads, that this stage gives, or a later one as well."""
    x = [axis(None, number) for number in range(5)]
    sums = [make("add", number, 1.0) for number in x]
    products = [make("multiply", sums[i], sums[j]) for i, j in ((0, 1), (1, 2), (2, 3), (3, 4), (0, 4))]
    index = make("int", make("multiply", x[0], 3))
    chosen = make("select", index, *x[1:4])
    parts = [make("subtract", products[0], chosen), make("subtract", sums[4], 1.0)]
    nodes = [*sums, *products, index, chosen, *parts]
    random = np.random.default_rng(3)
    points = random.random((4, Graph(nodes).dimension))
    kinds = set()
    for grouped in (True, False):
        for _ in range(30):
            order = [nodes[place] for place in random.permutation(len(nodes))]
            stages = [order[:2], order[2:4], order[4:4], [*order[4:6], order[0]], order[6:9]]
            batch = batch_at(Graph(nodes), points, grouped=grouped)
            chain = batch._scheduler.chain(stages)
            for number, (stage, schedule) in enumerate(zip(stages, chain, strict=True)):
                batch.follow(schedule, stage)
                made = {step.slot for each in chain[: number + 1] for step in each.steps}
                later = {
                    slot for each in chain[number + 1 :] for step in each.steps for slot in read_by(step)
                }
                given = {schedule.places[node].slot for each in stages[number:] for node in each}
                assert batch._groups.keys() == made & (later | given)
                kinds |= {type(step) for step in schedule.steps}
    assert kinds == {DrawStep, ChosenDraw, Step}


def test_a_chain_that_is_left_begins_anew() -> None:
    """What it had not foreseen is evaluated from the start, and nothing of what had been freed is taken as there."""
    x, y = axis(None, 1), axis(None, 2)
    first, second = make("add", x, 1.0), make("multiply", make("add", x, 1.0), make("add", y, 3.0))
    aside = make("subtract", x, y)
    graph = Graph([first, second, aside])
    points = np.random.default_rng(2).random((3, 2))
    of = {node: points[:, place] for node, place in graph.axes.items()}
    for left in range(2):
        batch = batch_at(graph, points)
        chain = batch._scheduler.chain([[first], [second]])
        for schedule, node in list(zip(chain, (first, second), strict=True))[: left + 1]:
            batch.follow(schedule, [node])
        before = set(batch._groups)
        assert batch.column(first if left == 0 else second) is not None
        assert set(batch._groups) == before  # what is there is not evaluated again
        assert batch.column(aside).tolist() == (of[x] - of[y]).tolist()
        assert not before & batch._groups.keys()
        batch.follow(chain[1], [second])
        assert batch.column(second).tolist() == ((of[x] + 1) * (of[y] + 3)).tolist()
        assert batch.column(first).tolist() == (of[x] + 1).tolist()


def test_batches_of_one_scheduler_may_be_asked_in_any_order() -> None:
    """What is to be done for a node depends on what is there: each batch has its own."""
    x = [axis(None, number) for number in range(3)]
    sums = [make("add", number, 1.0) for number in x]
    nodes = [
        *sums,
        make("multiply", sums[0], sums[1]),
        make("subtract", sums[1], sums[2]),
        make("multiply", make("subtract", sums[2], sums[0]), 2.0),
    ]
    graph = Graph(nodes)
    points = np.random.default_rng(2).random((3, graph.dimension))
    expected = {node: batch_at(graph, points).column(node) for node in nodes}
    for grouped in (True, False):
        scheduler = Scheduler(graph, grouped=grouped)
        rng = np.random.default_rng(3)
        for _ in range(60):
            batch = batch_at(graph, points, scheduler=scheduler)
            for place in rng.permutation(len(nodes))[: rng.integers(1, len(nodes) + 1)].tolist():
                if rng.random() < 0.5:
                    batch.need([nodes[place], nodes[(place + 1) % len(nodes)]])
                np.testing.assert_array_equal(batch.column(nodes[place]), expected[nodes[place]])
