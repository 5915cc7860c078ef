"""The finite part of a plan: which checks couple discrete values, and how these are drawn so that the checks hold."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field
from itertools import islice
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.constraint_network import Constraint, FiniteProblem
from scenic.analysis.finite.decomposing import Decomposer
from scenic.analysis.finite.mixed import Possible
from scenic.analysis.finite.solving import Component, Drawn, solve
from scenic.analysis.finite.tables import Table, Tabulator, seeds_of_calls
from scenic.analysis.finite.variables import Variable, variables_of
from scenic.analysis.screening import FREQUENT
from scenic.dataclass import dataclass
from scenic.graph.batch import Batch
from scenic.graph.draws import NumberSource, address
from scenic.graph.finite import Finite
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph, Node
from scenic.runtime.sampling.checks import Check, CollisionCheck, DrawingCheck, NodeCheck
from scenic.runtime.sampling.engine import Plan

__all__ = ["Decision", "decide"]

Mask = NDArray[np.bool_]

_MIXED: Final = "it depends on values that are not discrete, too"
_NO_WAY: Final = "no exact way to draw takes it together with the others"

MOST_PIECES: Final = 20_000
"""Conditions and pairs of objects, at most, of which tables are made."""


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """The finite part of a plan, decided.

    Attributes:
        variables: the finite axes of the plan, in the order of their numbers as variables.
        components: the components of the problem.
        parts: how the draws of components are made, for the domain.
        settled: the numbers of the checks that always hold then.
        left: the numbers of the checks that read discrete values and are left to chance.
        impossible: the numbers of checks that cannot hold together; then there is no scene.
        problem: the problem of the components.
        reasons: why the checks in ``left`` are left to chance, by number.

    """

    variables: tuple[Variable, ...] = ()
    components: tuple[Component, ...] = ()
    parts: tuple[Finite, ...] = ()
    settled: frozenset[int] = frozenset()
    left: tuple[int, ...] = ()
    impossible: tuple[int, ...] = ()
    problem: FiniteProblem | None = None
    reasons: Mapping[int, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """A part of a check that has a table of its own: a condition, or the collision of a pair."""

    check: Check
    number: int
    kind: str


def decide(
    plan: Plan, batch: Callable[[NumberSource], Batch], met: Mapping[int, Mask], *, always: bool = False
) -> Decision:
    """Decide the finite part of a plan.

    Args:
        plan: on the whole cube.
        batch: makes a batch of its engine from a source.
        met: which of some candidates met a check, by its number, where that is known.
        always: make tables and components whether or not candidates are rejected.

    """
    variables = variables_of(plan.graph)
    if not variables:
        return Decision()
    finite = _Finiteness(plan.graph, variables)
    pieces = list(islice(_pieces(plan.checks, finite), MOST_PIECES + 1))
    numbers = list(dict.fromkeys(piece.number for piece in pieces))
    if not pieces or len(pieces) > MOST_PIECES or not (always or _rejects(numbers, met)):
        return Decision()
    builder = _Builder(plan.graph, variables, batch)
    for piece in pieces:
        if finite.is_finite(piece.check.nodes):
            builder.add(piece)
        elif always or _rejects([piece.number], met):
            builder.add_possible(piece)
    problem = FiniteProblem(
        tuple(variable.weights for variable in builder.order)
        + tuple(np.ones(size) for size in builder.sizes[len(builder.order) :]),
        len(builder.order),
        tuple(builder.constraints),
    )
    components = tuple(solve(problem))
    order = tuple(builder.order)
    impossible = next((one for one in components if one.share == 0), None)
    if impossible is not None:
        return Decision(order, components, impossible=_core(problem, impossible), problem=problem)
    parts = tuple(_part(draw, order) for one in components for draw in one.drawn)
    met_always = {id(constraint) for one in components for constraint in one.met}
    reasons = {
        constraint.check: _NO_WAY for constraint in builder.constraints if id(constraint) not in met_always
    }
    reasons |= builder.undecided
    decided_numbers = frozenset(numbers) - reasons.keys()
    return Decision(
        order, components, parts, decided_numbers, tuple(sorted(reasons)), problem=problem, reasons=reasons
    )


def _rejects(numbers: Sequence[int], met: Mapping[int, Mask]) -> bool:
    """Return whether checks may reject more than a few candidates."""
    masks = [met[number] for number in numbers if number in met]
    if len(masks) < len(numbers):
        return True
    return float(np.logical_and.reduce(masks).mean()) < FREQUENT


class _Finiteness:
    """The nodes that depend on finite axes, and on no other draws.

    Args:
        graph: the graph.
        variables: its finite axes.

    """

    def __init__(self, graph: Graph, variables: Mapping[Node, Variable]) -> None:
        self._draws: dict[Node, int] = {}
        """By node, as bits: 1 for those below which are finite axes, 2 for others."""
        seeds = seeds_of_calls(graph)
        for node in graph.nodes:
            if node.is_drawn:
                self._draws[node] = 1 if node in variables else 0 if node in seeds else 2
            else:
                draws = 0
                for operand in node.operands:
                    draws |= self._draws[operand]
                self._draws[node] = draws

    def __call__(self, nodes: Sequence[Node]) -> int:
        """Return the union of the bits of some nodes."""
        found = 0
        for node in nodes:
            found |= self._draws[node]
        return found

    def is_finite(self, nodes: Sequence[Node]) -> bool:
        """Return whether nodes depend on nothing but finite axes."""
        return not self(nodes) & 2


def _pieces(checks: Sequence[Check], finite: _Finiteness) -> Iterator[_Piece]:
    """The parts of checks that read finite axes."""
    for number, check in enumerate(checks):
        if check.probability < 1:
            continue
        if isinstance(check, CollisionCheck):
            below = np.array([finite(item.all) for item in check.objects])
            one, other = below[check.pairs].T
            # Bounds show collisions only of things whose places are known but for a little.
            is_coupled = ((one | other) == 1) | ((one & other) == 1) | ((one & other) == 3)
            for place in np.flatnonzero(is_coupled).tolist():
                yield _Piece(check.of_pairs(check.pairs[place : place + 1]), number, "collision")
        elif isinstance(check, DrawingCheck):
            if finite(check.nodes) == 1:
                yield _Piece(check, number, "drawing")
        elif isinstance(check, NodeCheck) and finite(check.nodes) & 1:
            for node in _conjuncts(check.node):
                if finite([node]) & 1:
                    one_check = (
                        check
                        if node is check.node
                        else NodeCheck(node, check.label, check.span, check.position)
                    )
                    yield _Piece(one_check, number, "condition")


def _conjuncts(node: Node) -> list[Node]:
    """Return the conditions that hold together where a condition holds."""
    if node.operation.name != "and":
        return [node]
    return [inner for operand in node.operands for inner in _conjuncts(operand)]


class _Builder:
    """Makes constraints of pieces."""

    def __init__(
        self, graph: Graph, variables: Mapping[Node, Variable], batch: Callable[[NumberSource], Batch]
    ) -> None:
        self.order = list(variables.values())
        self.sizes = [variable.size for variable in self.order]
        self.constraints: list[Constraint] = []
        self.undecided: dict[int, str] = {}
        """Reasons why checks have no table that tells all of them, by their numbers."""
        self._number = {variable.axis: place for place, variable in enumerate(self.order)}
        self._tabulator = Tabulator(variables, batch)
        self._decomposer = Decomposer(variables, self._number, self.sizes)
        self._possible = Possible(graph, variables)

    def add(self, piece: _Piece) -> None:
        """Add the constraint of a piece, if it can be made."""
        check = piece.check
        scope, _, every = self._tabulator.below(check.nodes)
        combinations = self._tabulator.table(scope, check.nodes, every, check.test, piece.kind)
        if combinations is None:
            tables = None
            if isinstance(check, NodeCheck) and check.node.kind is Kind.BOOLEAN:
                tables = self._decomposer.tables(check.node)
            if tables is None:
                self.undecided[piece.number] = self._tabulator.reason
                return
        else:
            tables = [_simplified([self._number[variable.axis] for variable in scope], combinations)]
        if all(table.allowed.all() for table in tables):
            return
        self.constraints.append(Constraint(tuple(tables), piece.number))

    def add_possible(self, piece: _Piece) -> None:
        """Add what is possible of a piece that reads other draws, too."""
        self.undecided.setdefault(piece.number, _MIXED)
        found = self._possible.table(piece.check)
        if found is None:
            return
        scope, allowed = found
        if not allowed.all():
            table = _simplified([self._number[variable.axis] for variable in scope], allowed)
            self.constraints.append(Constraint((table,), piece.number, exact=False))


def _simplified(scope: Sequence[int], allowed: Mask) -> Table:
    """Return a table without the variables that it does not depend on."""
    left = list(scope)
    for variable in scope:
        place = left.index(variable)
        first = allowed.take([0], axis=place)
        if (allowed == first).all():
            allowed = first.squeeze(axis=place)
            left.remove(variable)
    return Table(tuple(left), allowed)


def _part(drawn: Drawn, order: Sequence[Variable]) -> Finite:
    """Draws of a component as a part of a domain."""
    mine = [order[variable] for variable in drawn.variables]
    first = min(variable.address for variable in mine)
    addresses = [
        order[variable].address
        if variable is not None and variable < len(order)
        else address("inner value", first, place)
        for place, variable in enumerate(drawn.numbers)
    ]
    return Finite(
        np.array([variable.number for variable in mine], dtype=np.intp),
        tuple(variable.lower[values] for variable, values in zip(mine, drawn.values, strict=True)),
        tuple(variable.upper[values] for variable, values in zip(mine, drawn.values, strict=True)),
        np.array(addresses, dtype=np.uint64),
        drawn.law,
        drawn.share,
    )


def _core(problem: FiniteProblem, component: Component) -> tuple[int, ...]:
    """A minimal set of checks that cannot hold together, of a component without solutions."""
    left = list(dict.fromkeys(constraint.check for constraint in component.constraints))
    if len(left) > _MOST_EXPLAINED:
        return tuple(left)
    for check in list(left):
        rest = [other for other in left if other != check]
        constraints = tuple(one for one in component.constraints if one.check in rest)
        if any(one.share == 0 for one in solve(FiniteProblem(problem.weights, problem.draws, constraints))):
            left = rest
    return tuple(left)


_MOST_EXPLAINED: Final = 64
"""Checks, at most, of which a minimal set is looked for."""
