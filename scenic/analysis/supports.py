"""Values that random quantities can have: over the whole cube, and over the part of it that analysis leaves."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.variables import Variable, variables_of
from scenic.dataclass import dataclass
from scenic.graph.bounding import over
from scenic.graph.bounds import Bounds, Floats
from scenic.graph.domain import Domain
from scenic.graph.node import Graph, Node
from scenic.graph.operations import TABLE
from scenic.language.spans import Span

__all__ = [
    "DISCRETE",
    "NAMES",
    "DeadValues",
    "DrawnSupport",
    "dead_values",
    "options_of",
    "places_of",
    "supports",
]

NAMES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "range": "Range",
        "discrete range": "DiscreteRange",
        "weighted integer": "DiscreteRange",
        "normal": "Normal",
        "truncated normal": "TruncatedNormal",
        "choice": "choice",
    }
)
"""Names of primitive distributions for users, by operation; everything else that is drawn is a place in a region."""

DISCRETE: Final = ("choice", "discrete range", "weighted integer")
"""Operations that draw one of some integers, or of numbered options."""


@dataclass(frozen=True, slots=True)
class DrawnSupport:
    """The values that one primitive quantity can have.

    Attributes:
        kind: what is drawn: ``Range``, ``Normal``, ``choice``, ...; ``place`` for a point of a region.
        span: where in the program.
        before: the least and the greatest value; ``None`` of a place, or where nothing is known.
        after: the same in the part of the cube that is sampled.
        options: what a choice among fixed values picks from, as text; empty for others.
        left: options that are left, by number.
        removed: the share of the axes that is removed, 0 to 1.
        axes: the axes that decide it.

    """

    kind: str
    span: Span | None
    before: tuple[float, float] | None
    after: tuple[float, float] | None
    options: tuple[str, ...]
    left: tuple[int, ...]
    removed: float
    axes: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class DeadValues:
    """The values of one draw that no scene has.

    Attributes:
        draw: the choice or the integer that is drawn.
        axis: its axis.
        count: the number of its values.
        values: those that never occur, as text.
        left: the others, as text.

    """

    draw: Node
    axis: Node
    count: int
    values: tuple[str, ...]
    left: tuple[str, ...]


def dead_values(graph: Graph, domains: Sequence[Domain]) -> tuple[DeadValues, ...]:
    """The draws of a graph some values of which are not left in one of some domains, though they have a weight."""
    variables = variables_of(graph)
    rows = []
    for node in graph.nodes:
        axis = next((operand for operand in node.operands if operand in variables), None)
        if axis is None or node.operation.name not in DISCRETE:
            continue
        values = values_of_cells(node, graph, variables[axis])
        if not len(values):
            continue
        left = np.logical_and.reduce([cells_left(domain, variables[axis]) for domain in domains])
        alive = set(values[left].tolist())
        possible = sorted(set(values.tolist()))
        options = options_of(node, graph.nodes)
        if node.operation.name == "choice":
            texts = [options[value] if value < len(options) else f"number {value + 1}" for value in possible]
        else:
            texts = [str(value) for value in possible]
        dead = tuple(text for value, text in zip(possible, texts, strict=True) if value not in alive)
        left_texts = tuple(text for value, text in zip(possible, texts, strict=True) if value in alive)
        if dead:
            rows.append(DeadValues(node, axis, len(options) or len(possible), dead, left_texts))
    return tuple(rows)


def supports(graph: Graph, domain: Domain) -> tuple[DrawnSupport, ...]:
    """The supports of all primitive values of a graph, in the order of the graph."""
    axes_of_node: dict[Node, list[int]] = {}
    for node in graph.nodes:
        axes = [graph.axes[operand] for operand in node.operands if operand.is_axis]
        if axes:
            axes_of_node[node] = axes
    whole = Domain.whole(graph.dimension).hull
    before, after = over(axes_of_node, graph.axes, *whole), over(axes_of_node, graph.axes, *domain.hull)
    variables = variables_of(graph)
    rows: list[DrawnSupport] = []
    places: dict[Span | None, int] = {}
    for node, axes in axes_of_node.items():
        span = node.span if isinstance(node.span, Span) else None
        removed_share = 1 - float(np.prod([_left(domain, axis) for axis in axes]))
        own_axes = tuple(operand for operand in node.operands if operand.is_axis)
        kind = NAMES.get(node.operation.name, "place")
        if kind == "place":
            if span in places:  # several numbers of one place
                place = places[span]
                earlier = rows[place]
                rows[place] = DrawnSupport(
                    kind,
                    span,
                    None,
                    None,
                    (),
                    (),
                    1 - (1 - earlier.removed) * (1 - removed_share),
                    earlier.axes + own_axes,
                )
            else:
                places[span] = len(rows)
                rows.append(DrawnSupport(kind, span, None, None, (), (), removed_share, own_axes))
            continue
        options = options_of(node, graph.nodes)
        ends = _ends(after[node])
        left = _options_left(node, graph, domain, variables) if options else ()
        rows.append(
            DrawnSupport(kind, span, _ends(before[node]), ends, options, left, removed_share, own_axes)
        )
    return tuple(rows)


def places_of(position: Node, graph: Graph, domain: Domain) -> tuple[Floats, Floats]:
    """Return boxes in which a position may lie, as corners ``(m, 3)``, one for each box of a part of the domain."""
    axes_used = {axis for axis in graph.axes if axis in Graph([position]).index}
    numbers = np.array(sorted(graph.axes[axis] for axis in axes_used), dtype=np.intp)
    lower, upper = domain.hull
    for part, axes_of_part in zip(domain.parts, domain.joined_axes(), strict=False):
        if len(np.intersect1d(axes_of_part, numbers)) and len(lower) == 1:
            lower, upper = np.repeat(lower, part.boxes, axis=0), np.repeat(upper, part.boxes, axis=0)
            lower[:, axes_of_part], upper[:, axes_of_part] = (
                part.lower[:, axes_of_part],
                part.upper[:, axes_of_part],
            )
    bounds = over([position], graph.axes, lower, upper)[position]
    if bounds is None or bounds.lower.shape[1:] != (3,):
        return np.full((1, 3), -np.inf), np.full((1, 3), np.inf)
    count = len(lower)
    return np.broadcast_to(bounds.lower, (count, 3)), np.broadcast_to(bounds.upper, (count, 3))


def options_of(choice: Node, nodes: Sequence[Node]) -> tuple[str, ...]:
    """Return the fixed values that a choice picks from, as text; empty where it is none, or they are not fixed."""
    if choice.operation is not TABLE["choice"]:
        return ()
    for node in nodes:
        if node.operation is TABLE["look-up"] and node.operands[0] is choice:
            return tuple(_shown(value) for value in node.payload.column.tolist())
        if node.operation is TABLE["select"] and node.operands[0] is choice:
            return tuple(
                _shown(option.value) if option.is_constant else "a random value"
                for option in node.operands[1:]
            )
    return ()


def cells_left(domain: Domain, variable: Variable) -> NDArray[np.bool_]:
    """Return a mask ``(d,)`` of the cells that a domain leaves of an axis with discrete values."""
    axis, middles = variable.number, variable.middles[:, np.newaxis]
    mask = np.ones(variable.size, dtype=np.bool_)
    for part in domain.parts:
        # All points of a cell are alike, so that a cell of which a box lacks some has no solution in it.
        mask &= ((part.lower[:, axis] <= middles) & (middles <= part.upper[:, axis])).any(axis=1)
    for lower, _ in _cells_left(domain, axis):
        mask &= np.isin(variable.lower, lower)
    return mask


def values_of_cells(node: Node, graph: Graph, variable: Variable) -> NDArray[np.intp]:
    """Return the integer ``(d,)`` that a draw has on each cell of its axis; nothing where other draws decide it, too."""
    lower, upper = np.zeros((variable.size, graph.dimension)), np.ones((variable.size, graph.dimension))
    lower[:, variable.number] = upper[:, variable.number] = variable.middles
    bounds = over([node], graph.axes, lower, upper)[node]
    if bounds is None or bounds.lower.shape != (variable.size,) or (bounds.lower != bounds.upper).any():
        return np.empty(0, dtype=np.intp)
    return bounds.lower.astype(np.intp)


def _options_left(
    choice: Node, graph: Graph, domain: Domain, variables: Mapping[Node, Variable]
) -> tuple[int, ...]:
    """Return the numbers of the options that are left of a choice; all of them where there are too many to decide."""
    variable = variables.get(choice.operands[0])
    if variable is None:
        return tuple(range(len(options_of(choice, graph.nodes))))
    values = values_of_cells(choice, graph, variable)
    left = values[cells_left(domain, variable)] if len(values) else np.arange(variable.size)
    return tuple(sorted(set(left.tolist())))


def _cells_left(domain: Domain, axis: int) -> list[tuple[Floats, Floats]]:
    """The ends of the cells of an axis that a finite part of a domain leaves, if one chooses them."""
    return [
        (one.lower[place], one.upper[place])
        for one in domain.finite
        for place in np.flatnonzero(one.axes == axis).tolist()
    ]


def _shown(value: object) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else repr(value)
    return text if len(text) < 30 else f"{text[:26]}..."


def _ends(bounds: Bounds | None) -> tuple[float, float] | None:
    if bounds is None or bounds.lower.shape != (1,):
        return None
    return float(bounds.lower[0]), float(bounds.upper[0])


def _left(domain: Domain, axis: int) -> float:
    """Return the share of an axis that the boxes of a domain cover together."""
    share = 1.0
    for part in domain.parts:
        order = np.argsort(part.lower[:, axis])
        lower, upper = part.lower[order, axis], part.upper[order, axis]
        ends = np.maximum.accumulate(np.concatenate([[0.0], upper[:-1]]))
        covered_length = np.maximum(upper - np.maximum(lower, ends), 0).sum()
        share = min(share, float(covered_length))
    for lower, upper in _cells_left(domain, axis):
        share = min(share, float((upper - lower).sum()))
    return share
