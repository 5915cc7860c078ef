"""Axes of the cube below discrete values, as variables with finitely many values."""

from typing import Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph.bounds import Floats
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph, Node

__all__ = ["Variable", "variables_of"]

MOST_VALUES: Final = 4096
"""Values of a variable, at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Variable:
    """An axis that falls into cells, on each of which all that reads it is the same.

    Attributes:
        axis: the axis.
        number: its number in the graph.
        address: its address.
        lower: the lower ends of the cells, ``(d,)``.
        upper: the upper ends, ``(d,)``, just below the next lower end.

    """

    axis: Node
    number: int
    address: int
    lower: Floats
    upper: Floats

    @property
    def size(self) -> int:
        """The number of values."""
        return len(self.lower)

    @property
    def weights(self) -> Floats:
        """The probabilities of the cells."""
        return np.diff(np.append(self.lower, 1.0))

    @property
    def middles(self) -> Floats:
        """A point in each cell."""
        return (self.lower + self.upper) / 2


def variables_of(graph: Graph) -> dict[Node, Variable]:
    """Return the axes of a graph all of whose readers are discrete distributions, with at least two values."""
    cuts: dict[Node, list[Floats] | None] = {}
    for node in graph.nodes:
        for operand in node.operands:
            if not operand.is_axis:
                continue
            reading = node.operation.cuts if node.kind is Kind.INTEGER else None
            values_read = None if reading is None else reading(node.payload, node.operands)
            earlier_cuts = cuts.get(operand, [])
            cuts[operand] = (
                None if values_read is None or earlier_cuts is None else [*earlier_cuts, values_read]
            )
    variables: dict[Node, Variable] = {}
    for axis, places in cuts.items():
        if places is None:
            continue
        lower = np.array(sorted({0.0}.union(*(each.tolist() for each in places))))
        if 1 < len(lower) <= MOST_VALUES:
            upper = np.append(np.nextafter(lower[1:], 0.0), 1.0)
            variables[axis] = Variable(axis, graph.axes[axis], graph.address(axis), lower, upper)
    return variables
