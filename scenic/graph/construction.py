"""Making nodes: the one place where a node of an operation comes into being.

A node is simplified first where its operation knows how (`Operation.rewrite`), and a value that is computed already is
not computed again: of equal nodes there is one. Both happen before anything reads the graph, so that analysis, solver and
sampler see the same nodes.
"""

from collections.abc import Hashable, Sequence

from scenic.graph.bounding import limits_of, overall, read
from scenic.graph.kinds import Kind
from scenic.graph.node import Consumers, Node
from scenic.graph.operation import Operation


def make_node(
    operation: Operation, operands: Sequence[Node], payload: object = None, span: Hashable | None = None
) -> Node:
    """Return the node of ``operation`` over ``operands``, of the kind that the operation's rule gives."""
    if operation.rewrite is not None:
        simpler = operation.rewrite(operands, payload)
        if simpler is not None:
            return simpler  # type: ignore[no-any-return] # rules cannot name the type of nodes
    kind = operation.kind(operands, payload)
    equal_nodes, key = _equal_nodes(operation, operands, payload, kind)
    if equal_nodes is not None:
        node = equal_nodes.get(key)
        if node is not None:
            return node
    limits = None
    if kind is Kind.INTEGER:
        limits = limits_of(read(operation, kind, payload, [overall(operand) for operand in operands]))
    node = Node(operation, tuple(operands), kind, payload, span, limits)
    if equal_nodes is not None:
        equal_nodes[key] = node
    return node


def _equal_nodes(
    operation: Operation, operands: Sequence[Node], payload: object, kind: Kind
) -> tuple[Consumers | None, Hashable]:
    """Return the table and the key under which a node equal to this one would be stored; ``None`` if equal
    nodes are not merged.

    Python objects are not shared: two lists of equal items are two lists.
    """
    if not operation.pure or kind.is_boxed:
        return None, None
    anchor = next((operand for operand in operands if not operand.is_constant), None)
    if anchor is None:
        return None, None
    parts = tuple(operand.payload.key if operand.is_constant else id(operand) for operand in operands)
    key = (id(operation), payload, parts)
    try:
        hash(key)
    except TypeError:  # the payload is a container that may change
        return None, None
    return anchor.consumers, key
