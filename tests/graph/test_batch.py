"""Evaluation of graphs: order, lanes that are dropped, and the fate of lanes that fail or are rejected."""

import itertools

import numpy as np
import pytest

from graph.programs import (
    CODEC,
    Triple,
    batch_at,
    constant,
    evaluate,
    faulty,
    is_fine,
    make,
    one_of,
    random_points,
    sampled,
    source,
    uniform,
)
from scenic.graph import construction
from scenic.graph import node as graph
from scenic.graph.domain import Domain
from scenic.graph.draws import address
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph
from scenic.graph.operation import Call, Operation, always
from tests.each import each

OK, FAULT, REJECTED = 0, 1, 2


def lanes_of(name, *columns, **keywords):
    """Value and status of a boolean operation over operands given as strings: T, F, f (fault), r (rejected).

    A lane without a value holds anything: false here, true where ``e`` and ``q`` stand for ``f`` and ``r``.
    """
    operands = []
    for column in columns:
        values = [letter in "Teq" for letter in column]
        statuses = [
            {"f": FAULT, "e": FAULT, "r": REJECTED, "q": REJECTED}.get(letter, OK) for letter in column
        ]
        operands.append(faulty(Kind.BOOLEAN, values, statuses, ValueError(column)))
    node = make(name, *operands, **keywords)
    batch = evaluate(node, len(columns[0]))
    fine = is_fine(batch, node)
    status = batch.status(node)
    values = batch.full(node)
    return "".join(
        ("T" if values[lane] else "F") if fine[lane] else ("f" if status[lane] == FAULT else "r")
        for lane in range(len(fine))
    )


@pytest.mark.parametrize(("name", "decisive"), [("and", "F"), ("or", "T")])
@pytest.mark.parametrize("count", [2, 3])
def test_logic_reads_from_the_left_as_far_as_needed(name, decisive, count):
    rows = list(itertools.product("TFfreq", repeat=count))
    fates = [next((letter for letter in row if letter in decisive + "freq"), row[-1]) for row in rows]
    expected = "".join({"e": "f", "q": "r"}.get(letter, letter) for letter in fates)
    assert lanes_of(name, *("".join(column) for column in zip(*rows, strict=True))) == expected


def test_a_conditional_has_the_fate_of_its_test_or_of_the_branch_taken():
    rows = list(itertools.product("TFfr", repeat=3))
    test, then, otherwise = ("".join(column) for column in zip(*rows, strict=True))
    expected = "".join(t if t in "fr" else a if t == "T" else b for t, a, b in rows)
    assert lanes_of("if", test, then, otherwise) == expected


def test_three_operands():
    assert lanes_of("and", "TTTF", "TFTT", "ffTr") == "fFTF"
    assert lanes_of("or", "FFFT", "FTFF", "ffFr") == "fTFT"


def test_strict_operations_take_the_worse_fate():
    assert lanes_of("equal", "TTfr", "TfrF") == "Tfrr"
    assert lanes_of("not", "TFfr") == "FTfr"


def test_a_conditional_counts_only_the_part_it_takes():
    assert lanes_of("if", "TTFFfr", "TfTfTT", "fTfFTT") == "TffFfr"


def test_a_choice_counts_only_the_option_drawn():
    index = source(Kind.INTEGER, [0, 0, 1, 1, 2])
    options = [
        faulty(Kind.SCALAR, [1, 2, 3, 4, 5], [0, 1, 0, 0, 0], ZeroDivisionError()),
        faulty(Kind.SCALAR, [10, 20, 30, 40, 50], [1, 0, 0, 2, 1], ZeroDivisionError()),
        source(Kind.SCALAR, [100] * 5),
    ]
    node = make("select", index, *options)
    batch = evaluate(node, 5)
    assert batch.status(node).tolist() == [OK, FAULT, OK, REJECTED, OK]
    assert batch.column(node)[[0, 2, 4]].tolist() == [1.0, 30.0, 100.0]


def test_the_error_is_that_of_the_option_drawn():
    first, second = ValueError("first"), KeyError("second")
    index = source(Kind.INTEGER, [1])
    options = [faulty(Kind.SCALAR, [0], [FAULT], first), faulty(Kind.SCALAR, [0], [FAULT], second)]
    node = make("select", index, *options)
    batch = evaluate(node, 1)
    batch.column(node)
    assert batch.errors[node] is second


def test_the_error_of_a_strict_operation_is_its_first_operands():
    first, second = ValueError("first"), KeyError("second")
    quotient = make(
        "divide", faulty(Kind.SCALAR, [1], [FAULT], first), faulty(Kind.SCALAR, [0], [FAULT], second)
    )
    batch = evaluate(quotient, 1)
    batch.column(quotient)
    assert batch.errors[quotient] is first


@pytest.mark.parametrize(
    ("statuses", "expected"),
    [("fr", True), ("rf", True), ("ro", False), ("of", True), ("oo", False), ("rfr", True)],
)
def test_a_batch_remembers_that_some_value_failed(statuses, expected):
    marks = {"o": [OK, OK], "f": [FAULT, OK], "r": [OK, REJECTED]}
    nodes = [faulty(Kind.SCALAR, [1, 2], marks[letter], ValueError()) for letter in statuses]
    batch = batch_at(Graph(nodes), np.empty((2, 0)), CODEC)
    for node in nodes:
        batch.status(node)
    assert batch.has_faults is expected


def test_options_of_different_kinds_are_seen_as_what_they_are():
    vector = source(Kind.VECTOR, [[1.0, 2.0, 3.0]] * 5)
    words = np.array(["a", "b", "c", "d", "e"], dtype=object)
    index = source(Kind.INTEGER, [0, 1, 2, 3, 4])
    node = make("select", index, 7, 2.5, True, source(Kind.OTHER, words), vector)
    assert node.kind is Kind.OTHER
    batch = evaluate(node, 5)
    values = [batch.value(node, lane) for lane in range(5)]
    assert values == [7, 2.5, True, "d", Triple((1.0, 2.0, 3.0))]
    assert [type(value) for value in values] == [int, float, bool, str, Triple]


def test_a_fault_of_an_option_of_another_kind_is_not_decoded():
    index = source(Kind.INTEGER, [0, 1])
    node = make("select", index, 1, faulty(Kind.SCALAR, [0, 0], [FAULT, FAULT], ValueError()))
    batch = evaluate(node, 2)
    assert batch.status(node).tolist() == [OK, FAULT]
    assert batch.value(node, 0) == 1


def program():
    """A small graph with draws, a choice, a fault and Python objects."""
    x, y = uniform(0.0, 10.0), uniform(-1.0, 1.0)
    choice = one_of(1, 2.5, "text")
    product = make("multiply", choice, 2)
    quotient = make("divide", x, make("int", make("multiply", y, 3)))
    return [x, y, choice, product, quotient, make("greater", quotient, 1.0)]


def test_dropping_lanes_changes_no_value():
    """Values are the same whether lanes are dropped before or after a node is evaluated, in one step or several."""
    nodes = program()
    whole = sampled(nodes, 100, seed=4)
    columns = {node: whole.full(node) for node in nodes}
    statuses = {node: whole.status(node) for node in nodes}
    rng = np.random.default_rng(0)
    for _ in range(10):
        batch = sampled(nodes, 100, seed=4)
        for node in rng.permutation(len(nodes)):
            batch.column(nodes[node])
            batch.keep(rng.random(len(batch)) < 0.8)
            if len(batch) == 0:
                break
        for node in nodes:
            assert batch.full(node).tolist() == columns[node][batch.rows].tolist()
            expected = statuses[node]
            found = batch.status(node)
            if expected is None or not expected[batch.rows].any():
                assert found is None
            else:
                assert found.tolist() == expected[batch.rows].tolist()


def test_keeping_by_indices_and_by_mask():
    nodes = program()
    by_mask, by_index = sampled(nodes, 10), sampled(nodes, 10)
    mask = np.arange(10) % 3 == 0
    by_mask.keep(mask)
    by_index.keep(np.flatnonzero(mask))
    assert by_mask.rows.tolist() == by_index.rows.tolist() == [0, 3, 6, 9]
    assert by_mask.column(nodes[0]).tolist() == by_index.column(nodes[0]).tolist()


def test_no_lanes_at_all():
    nodes = program()
    batch = sampled(nodes, 5)
    batch.keep(np.zeros(5, dtype=bool))
    assert all(len(batch.full(node)) == 0 for node in nodes)


def test_python_functions_may_reject():
    class Rejected(Exception):
        pass

    def picky(value):
        if value < 1:
            raise Rejected
        if value < 2:
            raise KeyError("two")
        return value

    operation = Operation("picky", always(Kind.OTHER), lambda call, a: a, "A test.", python=picky)
    node = construction.make_node(operation, [source(Kind.SCALAR, [0.5, 1.5, 2.5])])
    batch = batch_at(Graph([node]), np.empty((3, 0)), CODEC, rejections=(Rejected,))
    assert batch.status(node).tolist() == [REJECTED, FAULT, OK]
    assert batch.value(node, 2) == 2.5


def test_a_value_of_the_wrong_kind_is_a_fault():
    operation = Operation("word", always(Kind.SCALAR), lambda call, a: a, "A test.", python=lambda a: a)
    node = construction.make_node(operation, [source(Kind.OTHER, np.array(["word", 1.5], dtype=object))])
    batch = evaluate(node, 2)
    assert batch.status(node).tolist() == [FAULT, OK]
    assert batch.value(node, 1) == 1.5


def test_keys_depend_on_the_lane_and_the_address_alone():
    first, second = graph.key(place=address("a")), graph.key(place=address("b"))
    x = uniform(0, 1)
    several, alone = Graph([first, x, second]), Graph([second])
    words = batch_at(several, np.full((5, 1), 0.5)).column(second)
    assert batch_at(alone, np.empty((5, 0))).column(second).tolist() == words.tolist()
    assert len({*words.tolist(), *batch_at(several, np.full((5, 1), 0.5)).column(first).tolist()}) == 10


def tangle(rng, size=60):
    """A graph of many alike nodes: of draws, constants, zeros of both signs, faults, rejections and Python objects."""
    lanes = 12
    statuses = [rng.choice([OK, OK, FAULT, REJECTED], lanes) for _ in range(2)]
    numbers = [graph.axis(place=address("axis", number)) for number in range(4)]
    numbers += [uniform(-1.0, 1.0), constant(0.0), constant(-0.0), constant(2.5), constant(-1.0)]
    numbers += [faulty(Kind.SCALAR, rng.random(lanes), status, KeyError("given")) for status in statuses]
    truths = [make("less", numbers[0], 0.5), constant(True)]
    vectors = [
        make("vector", *numbers[:3]),
        constant(Triple((1.0, -0.0, 2.5))),
        constant(Triple((0.0, 0.0, 0.0))),
    ]
    for _ in range(size):
        a, b, c = (numbers[place] for place in rng.integers(0, len(numbers), 3))
        p, q = (truths[place] for place in rng.integers(0, len(truths), 2))
        u, v = (vectors[place] for place in rng.integers(0, len(vectors), 2))
        match rng.integers(0, 14):
            case 0 | 1 | 2:
                numbers.append(make(str(rng.choice(["add", "multiply", "subtract"])), a, b))
            case 3:
                numbers.append(make("divide", a, b))
            case 4:
                numbers.append(make("if", p, a, b))
            case 5:
                numbers.append(one_of(a, b, c, 1.5))
            case 6:
                truths.append(make("less", a, b))
            case 7:
                truths.append(make(str(rng.choice(["and", "or"])), p, q))
            case 8 | 9:
                vectors.append(make(str(rng.choice(["add", "subtract", "cross"])), u, v))
            case 10:
                vectors.append(make("multiply", v, a))
            case 11:
                vectors.append(make("if", p, u, v))
            case 12:
                numbers.append(make("component", v, payload=int(rng.integers(3))))
            case _:
                numbers.append(make("maximum", a, b))
    return [node for node in (*numbers, *truths, *vectors) if not node.is_constant], lanes


PAVED = 3
"""Boxes of the domain below."""


@each(range(12))
def test_lanes_are_what_they_are_alone(seed):
    """Whatever is evaluated together, in whichever order, from which boxes, and whichever lanes are dropped meanwhile."""
    rng = np.random.default_rng(seed)
    nodes, lanes = tangle(rng)
    net = Graph(nodes)
    corners = np.sort(rng.random((PAVED, net.dimension, 2)), axis=2)
    corners[:, :, 1] += 1e-3
    domain = Domain(corners[:, :, 0], np.minimum(corners[:, :, 1], 1.0))
    points = random_points(net, lanes, seed)
    alone = {}
    whole = batch_at(net, points, grouped=False, domain=domain)
    for node in nodes:
        status = whole.status(node)
        alone[node] = whole.full(node), np.zeros(lanes, int) if status is None else status
    for _ in range(4):
        batch = batch_at(net, points, domain=domain)
        batch.need([node for node in net.nodes if node.operation.name == "faulty"])
        order = rng.permutation(len(nodes))
        for some in np.array_split(order, int(rng.integers(1, 8))):
            batch.need([nodes[place] for place in some])
            if rng.random() < 0.5:
                batch.read(0, nodes[some[0]])
                batch.tuples(tuple(nodes[place] for place in some[:2]))
            if len(batch) > 3:
                batch.keep(rng.random(len(batch)) < 0.8)
        kept_tuple = tuple(nodes[place] for place in order[:3])
        rows = batch.tuples(kept_tuple) if len(batch) else []
        for node in nodes:
            values, status = (column[batch.rows] for column in alone[node])
            found = batch.status(node)
            assert (np.zeros(len(batch), int) if found is None else found).tolist() == status.tolist()
            fine = status == OK
            # Zeros of both signs are told apart.
            assert batch.full(node)[fine].tobytes() == values[fine].tobytes()
            for lane in np.flatnonzero(fine):
                assert np.array_equal(batch.read(int(lane), node), values[lane])
                if node in kept_tuple:
                    row = rows[lane if len(rows) > 1 else 0]
                    assert np.array_equal(row[kept_tuple.index(node)], values[lane])


def test_one_row_of_values_and_a_fate_for_each_lane():
    """An operand may be the same in all lanes that have it."""
    operation = Operation("next", always(Kind.OTHER), lambda call, a: a, "A test.", python=lambda a: a + 1)
    node = construction.make_node(
        operation, [faulty(Kind.SCALAR, [5.0], np.array([FAULT, OK, REJECTED]), ValueError())]
    )
    batch = evaluate(node, 3)
    assert batch.status(node).tolist() == [FAULT, OK, REJECTED]
    assert batch.value(node, 1) == 6.0


def test_what_is_the_same_in_all_lanes_is_read_in_each():
    node = make("add", source(Kind.SCALAR, [2.0]), 1.0)
    batch = evaluate(node, 4)
    assert len(batch.column(node)) == 1
    assert [batch.read(lane, node) for lane in range(4)] == [3.0] * 4
    assert [batch.value(node, lane) for lane in range(4)] == [3.0] * 4


def test_an_index_without_a_value_draws_nothing():
    index = faulty(Kind.INTEGER, [0, 99, -99, 2], np.array([OK, FAULT, REJECTED, OK]), ValueError())
    axes = [graph.axis(place=address("option", number)) for number in range(12)]
    node = make("select", index, *axes)
    net = Graph([node, *axes])
    points = random_points(net, 4)
    batch = batch_at(net, points)
    assert batch.status(node).tolist() == [OK, FAULT, REJECTED, OK]
    assert batch.full(node)[[0, 3]].tolist() == [points[0, net.axes[axes[0]]], points[3, net.axes[axes[2]]]]


def test_zeros_of_either_sign_are_different_numbers():
    x = graph.axis()
    products = [make("multiply", x, zero) for zero in (0.0, -0.0, 0.0, -0.0)]
    batch = batch_at(Graph(products), [[0.5]])
    batch.need(products)
    assert [np.signbit(batch.column(node)[0]) for node in products] == [False, True, False, True]


def test_rows_are_those_of_the_lanes_that_are_kept():
    nodes = (source(Kind.SCALAR, [1.0, 2.0, 3.0]), source(Kind.SCALAR, [4.0, 5.0, 6.0]))
    batch = batch_at(Graph(nodes), np.empty((3, 0)), CODEC)
    assert batch.tuples(nodes) == [(1, 4), (2, 5), (3, 6)]
    assert batch.read(1, nodes[0]) == 2
    batch.keep(np.array([False, True, True]))
    assert batch.tuples(nodes) == [(2, 5), (3, 6)]
    assert batch.read(1, nodes[0]) == 3
    for _ in range(3):  # of tuples of nodes that are there no longer nothing is left
        assert [batch.tuples((node,)) for node in nodes] == [[(2,), (3,)], [(5,), (6,)]]


@each(list(itertools.permutations(("fault", "reject", "inherit"))))
def test_the_worst_fate_of_a_lane_is_told_whatever_comes_first(order):
    """Of the exceptions the first one is kept, also where a later one is of other lanes."""
    first, second = ValueError("first"), KeyError("second")
    call = Call((5,), None, [np.array([OK, FAULT, REJECTED, FAULT, REJECTED], dtype=np.int8), None])
    for step in order:
        if step == "fault":
            call.fault(np.array([True, False, True, False, False]), first)
            call.fault(np.array([False, True, False, False, False]), second)
        elif step == "reject":
            call.reject(np.array([True, False, False, True, False]))
        else:
            call.inherit(0, np.array([True, False, True, False, True]))
            call.inherit(1, np.ones(5, dtype=bool))
    assert call.status.tolist() == [REJECTED, FAULT, REJECTED, REJECTED, REJECTED]
    assert call.error is first
    assert call.culprit is None


def test_the_first_operand_that_failed_is_the_culprit():
    statuses = [np.array([status], dtype=np.int8) for status in (OK, REJECTED, FAULT, FAULT)]
    call = Call((1,), None, statuses)
    for position in range(4):
        call.inherit(position, np.ones(1, dtype=bool))
    assert call.culprit == 2
    untouched = Call((3,), None, [])
    untouched.reject(np.zeros(3, dtype=bool))
    untouched.fault(np.zeros(1, dtype=bool), ValueError())
    assert untouched.status is untouched.error is None


@pytest.mark.parametrize("count", [2, 3, 4])
def test_alike_nodes_have_the_fate_of_their_own_operands(count):
    """Also where the operands of one of them are a constant and a member of another group."""
    fates = [[OK] * 4, [OK, FAULT, OK, OK], [REJECTED, OK, OK, OK], [OK, OK, FAULT, REJECTED]]
    for order in itertools.permutations(fates, count):
        given = [faulty(Kind.SCALAR, [1.0] * 4, np.array(fate), ValueError()) for fate in order]
        members = [make("add", source(Kind.SCALAR, [2.0]), each) for each in given]
        other = make("multiply", source(Kind.SCALAR, [3.0]), source(Kind.SCALAR, [4.0]))
        nodes = [make("subtract", member, other) for member in members]
        nodes += [make("subtract", 5.0, member) for member in members]
        batch = batch_at(Graph(nodes), np.empty((4, 0)))
        batch.need(nodes)
        for node, fate in zip(nodes, order * 2, strict=True):
            assert is_fine(batch, node).tolist() == [each == OK for each in fate]
            status = batch.status(node)
            assert status is None if not any(fate) else status.tolist() == fate


@pytest.mark.parametrize("grouped", [True, False])
def test_the_error_is_that_of_the_operand_that_failed(grouped):
    """Not of one before it whose neighbour in a group, or whose other lanes, failed."""
    given = KeyError("given")
    divisors = [source(Kind.SCALAR, [value]) for value in (4.0, 0.0)]
    fine, failed = (make("divide", 1.0, divisor) for divisor in divisors)
    node = make("subtract", fine, faulty(Kind.SCALAR, [1.0], [FAULT], given))
    truth = make("and", make("less", fine, 1.0), faulty(Kind.BOOLEAN, [True], [FAULT], given))
    batch = batch_at(Graph([fine, failed, node, truth]), np.empty((1, 0)), grouped=grouped)
    batch.need([fine, failed])
    batch.need([node, truth])
    assert batch.errors[node] is batch.errors[truth] is given
    assert batch.status(fine) is None
    assert fine not in batch.errors
    if not grouped:
        assert isinstance(batch.errors[failed], ZeroDivisionError)


def test_a_settled_batch_may_lose_lanes():
    nodes = [node for node in program() if not node.kind.is_boxed]
    whole = sampled(nodes, 60, seed=5)
    batch = sampled(nodes, 60, seed=5)
    batch.need(nodes[:1])
    batch.keep(np.arange(60) % 5 != 2)
    batch.need(nodes)
    batch.keep(np.arange(len(batch)) % 3 != 0)
    batch.settle(nodes[::2])
    for size in (20, 7, 1):
        batch.keep(np.arange(len(batch))[-size:])
        for node in nodes[::2]:
            status, expected = batch.status(node), whole.status(node)
            fine = is_fine(batch, node)
            assert batch.full(node)[fine].tolist() == whole.full(node)[batch.rows][fine].tolist()
            assert (status is None) is (expected is None or not expected[batch.rows].any())
            if status is not None:
                assert status.tolist() == expected[batch.rows].tolist()


def test_functions_are_called_where_their_operands_have_values_alone():
    """And once, where those are the same in all lanes."""
    seen = []
    operation = Operation("seen", always(Kind.OTHER), lambda call, a: a, "A test.", python=seen.append)
    values = faulty(Kind.SCALAR, [1.0, 2.0, 3.0, 4.0], np.array([OK, FAULT, REJECTED, OK]), ValueError())
    node = construction.make_node(operation, [values])
    assert evaluate(node, 4).status(node).tolist() == [OK, FAULT, REJECTED, OK]
    assert seen == [1.0, 4.0]
    node = construction.make_node(operation, [source(Kind.SCALAR, [5.0])])
    evaluate(node, 4).column(node)
    assert seen == [1.0, 4.0, 5.0]


def test_an_index_that_failed_has_the_fate_of_no_option():
    """Whatever number stands in its place."""
    index = faulty(Kind.INTEGER, [0, 1, 0, 1], np.array([FAULT, FAULT, REJECTED, OK]), ValueError())
    rejected = faulty(Kind.SCALAR, [1.0] * 4, np.array([REJECTED] * 4), ValueError())
    node = make("select", index, rejected, source(Kind.SCALAR, [5.0, 6.0, 7.0, 8.0]))
    batch = evaluate(node, 4)
    assert batch.status(node).tolist() == [FAULT, FAULT, REJECTED, OK]
    assert batch.value(node, 3) == 8.0


@pytest.mark.parametrize("fate", ["fault", "reject"])
def test_an_operation_that_does_not_say_that_it_fails_is_found_out(fate):
    """Nobody would look at the fate of its lanes."""

    def batch(call, a):
        if fate == "fault":
            call.fault(np.ones(1, dtype=bool), ValueError("a test"))
        else:
            call.reject(np.ones(1, dtype=bool))
        return a

    told = Operation("honest", always(Kind.SCALAR), batch, "A test.", faults=True, rejects=True)
    hidden = Operation("liar", always(Kind.SCALAR), batch, "A test.")
    x = uniform(0, 1)
    node = construction.make_node(told, [x])
    assert sampled([node], 2).status(node).tolist() == [FAULT if fate == "fault" else REJECTED] * 2
    silent = construction.make_node(hidden, [x])
    with pytest.raises(AssertionError, match="liar failed or rejected a lane"):
        sampled([silent], 2).status(silent)


@pytest.mark.parametrize("chained", [False, True])
def test_a_settled_batch_may_be_asked_for_anything(chained):
    """What it was settled for is there; the columns that this was made of are not, and are made again."""
    nodes = program()
    whole = sampled(nodes, 30, seed=6)
    every = [node for node in Graph(nodes).nodes if not node.is_constant]
    for kept in (nodes[-1:], nodes[:2], nodes[::2]):
        for aside in every:
            batch = sampled(nodes, 30, seed=6)
            if chained:
                for schedule, stage in zip(
                    batch._scheduler.chain([nodes[3:4], kept]), (nodes[3:4], kept), strict=True
                ):
                    batch.follow(schedule, stage)
                    batch.keep(np.arange(len(batch)) % 4 != 1)
            batch.keep(np.arange(len(batch)) % 3 != 0)
            batch.settle(kept)
            for node in (aside, *kept, *every):
                fine = is_fine(batch, node)
                assert fine.tolist() == is_fine(whole, node)[batch.rows].tolist()
                assert batch.full(node)[fine].tolist() == whole.full(node)[batch.rows][fine].tolist()


@each(list(itertools.permutations(range(3))))
def test_a_settled_batch_gives_together_what_it_has_and_what_it_lost(order):
    x = uniform(0, 1)
    nodes = [make("multiply", x, 2.0), make("subtract", x, 3.0), make("add", make("sin", x), 1.0)]
    asked = [nodes[place] for place in order]
    expected = sampled(nodes, 5, seed=2).stack(asked)
    for kept in range(3):
        for ask in (lambda batch: batch.stack(asked), lambda batch: np.array(batch.lists(asked))):
            batch = sampled(nodes, 5, seed=2)
            batch.settle([nodes[kept]])
            assert ask(batch).tolist() == expected.tolist()
        batch = sampled(nodes, 5, seed=2)
        batch.settle([nodes[kept]])
        batch.need(asked)
        assert all(batch._is_there(node) for node in nodes)


@pytest.mark.parametrize(("shape", "lanes"), [((4,), 4), ((2, 3), 3), ((3, 2), 2), ((1, 5), 5)])
def test_members_that_are_stacked_are_no_lanes(shape, lanes):
    assert Call(shape, None, []).lanes == lanes
