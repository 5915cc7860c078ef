"""Nodes, graphs and kinds."""

from dataclasses import replace

import numpy as np
import pytest

from graph.programs import Triple, constant, make, one_of, uniform
from scenic.graph import bounding
from scenic.graph.construction import make_node
from scenic.graph.kinds import Kind, boxed, join
from scenic.graph.node import Graph, Node, axis
from scenic.graph.operations import TABLE


def test_operands_come_before_what_uses_them():
    x, y = uniform(0, 1), uniform(0, 1)
    root = make("add", make("multiply", x, y), x)
    network = Graph([root, y])
    assert network.nodes[-1] is root
    for node in network.nodes:
        assert all(network.index[operand] < network.index[node] for operand in node.operands)
    assert len(set(network.nodes)) == len(network.nodes)


def test_axes_are_numbered_by_the_order_of_roots_and_operands():
    first, second = axis(), axis()
    a = make("range", first, 0, 1)
    b = make("range", second, 0, 1)
    assert Graph([a, b]).axes == {first: 0, second: 1}
    assert Graph([b, a]).axes == {second: 0, first: 1}
    assert Graph([make("subtract", b, a)]).dimension == 2


def test_the_order_of_one_root_leaves_out_leaves():
    x = uniform(0, 1)
    root = make("add", x, 1)
    assert Graph([root]).order(root) == [x, root]


def test_constants_know_their_values():
    node = constant(2.5)
    assert node.is_constant
    assert node.value == 2.5
    assert constant(7).limits == (7, 7)
    with pytest.raises(ValueError, match="not a constant"):
        _ = uniform(0, 1).value


def test_join():
    assert join(Kind.SCALAR, Kind.SCALAR) is Kind.SCALAR
    assert join(Kind.INTEGER, Kind.SCALAR) is Kind.OTHER
    assert one_of(1, 2).kind is Kind.INTEGER
    assert one_of(1, 2.0).kind is Kind.OTHER


def test_boxed_columns_keep_sequences_whole():
    column = boxed([(1, 2), [3], np.array([4.0, 5.0])])
    assert column.shape == (3,)
    assert column[0] == (1, 2)


def test_bounds_of_the_whole_cube():
    x = uniform(0, 10)
    bounds = bounding.overall(make("divide", x, 4))
    assert bounds.lower[0] == pytest.approx(0)
    assert bounds.upper[0] == pytest.approx(2.5)
    assert bounding.overall(constant("word")) is None
    mixed = bounding.overall(make("add", one_of(1, 2.5), 1))
    assert (mixed.lower[0], mixed.upper[0]) == pytest.approx((2, 3.5))
    assert bounding.overall(one_of(1, "word")) is None
    assert bounding.overall(constant(Triple((1.0, 2.0, 3.0)))).lower.tolist() == [[1.0, 2.0, 3.0]]


@pytest.mark.parametrize("length", [10, 700])
def test_bounds_of_long_chains_are_looked_for_once(length):
    """Below so many nodes, what is known of the furthest is their kind alone."""
    x = uniform(0, 1)
    total, every = make("modulo", x, 3), make("greater", x, 2)
    for number in range(length):
        total = make("add", total, uniform(0, 1) if number % 2 else 0.5)
        every = make("and", make("greater", uniform(0, 1), 0.5), every)
    for node in (total, every):
        bounds = bounding.overall(node)
        assert bounding.overall(node) is bounds
    truth = bounding.overall(every)
    assert (truth.lower[0], truth.upper[0]) == ((0, 0) if length == 10 else (0, 1))


def test_bounds_of_a_node_that_is_completed_are_those_of_its_operands():
    """Also where somebody asked for them before."""
    node = Node(TABLE["negative"], (uniform(0, 1),), Kind.SCALAR)
    for low, high in ((0, 1), (5, 6)):
        node.complete((uniform(low, high),), None)
        bounds = bounding.overall(node)
        assert (bounds.lower[0], bounds.upper[0]) == pytest.approx((-high, -low))


def test_bounds_of_the_whole_cube_give_up_after_some_nodes():
    x = uniform(0, 1)
    for _ in range(1000):
        x = make("multiply", x, 1.5)
    bounds = bounding.overall(x)
    assert (bounds.lower[0], bounds.upper[0]) == (-np.inf, np.inf)


def test_equal_nodes_are_one_unless_what_they_carry_may_change():
    x = uniform(0, 1)
    operation = replace(TABLE["sin"], rewrite=None)
    assert make_node(operation, [x], payload="name") is make_node(operation, [x], payload="name")
    assert make_node(operation, [x], payload="name") is not make_node(operation, [x], payload="other")
    namesake = replace(operation, doc="Another one of this name.")
    assert make_node(operation, [x]) is make_node(operation, [x]) is not make_node(namesake, [x])
    changing = ["name"]
    assert make_node(operation, [x], payload=changing) is not make_node(operation, [x], payload=changing)


def test_nodes_of_the_same_operands_otherwise_are_different_nodes():
    """In another order, more often, fewer of them, or as constants: each is itself when it is made again, and no other."""
    x, y, whole = uniform(0, 1), uniform(0, 1), make("int", uniform(0, 5))
    made = [
        lambda: make("subtract", x, y),
        lambda: make("subtract", y, x),
        lambda: make("subtract", x, x),
        lambda: make("subtract", y, y),
        lambda: make("subtract", x, 2.0),
        lambda: make("subtract", 2.0, x),
        lambda: make("subtract", x, 2),
        lambda: make("subtract", 2, x),
        lambda: make("subtract", whole, x),
        lambda: make("subtract", x, whole),
        lambda: make("minimum", x, y),
        lambda: make("minimum", y, x),
        lambda: make("minimum", x, y, y),
        lambda: make("minimum", x, x, y),
        lambda: make("minimum", x, y, x),
        lambda: make("maximum", x, y),
    ]
    nodes = [build() for build in made]
    assert len(set(nodes)) == len(nodes)
    assert [build() for build in reversed(made)] == nodes[::-1]


def test_objects_that_are_printed_alike_are_different_constants():
    class Alike:
        def __repr__(self):
            return "alike"

    first, second = Alike(), Alike()
    choice = one_of(first, second)
    nodes = [make("equal", choice, constant(item)) for item in (first, second, first)]
    assert nodes[0] is nodes[2] is not nodes[1]


def test_numbers_of_the_same_bytes_are_different_constants():
    x = make_node(TABLE["int"], [uniform(1, 5)])
    assert x.kind is Kind.INTEGER
    kinds = [make("multiply", x, constant(zero)).kind for zero in (0, 0.0, 0, 0.0)]
    assert kinds == [Kind.INTEGER, Kind.SCALAR] * 2
    assert make("less", x, constant(0)) is not make("less", x, constant(0.0))
