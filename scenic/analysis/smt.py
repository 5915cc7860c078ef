"""Requirements as formulas: which of them contradict each other, and which always hold.

Verdicts are about real numbers; rounding is left out. A requirement that only rounding could satisfy counts as
impossible, which is what its author wants to know. What the solver cannot express is left open, so that a contradiction
never rests on it.
"""

import math
from collections.abc import Sequence
from typing import Any

from scenic.analysis.facts import Fact
from scenic.analysis.solver_terms import Questions, SolverTerms, Term
from scenic.dataclass import dataclass
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph, Node
from scenic.graph.operations import TABLE


@dataclass(frozen=True, slots=True, eq=False)
class Support:
    """A fact about a primitive value that a contradiction may rest on: ``node`` with its ``phrase`` ("is at most 10")."""

    node: Node
    phrase: str


@dataclass(frozen=True, slots=True, eq=False)
class Contradiction:
    """Conditions and supports that cannot hold together, while each part of them can; in the order they were given."""

    conditions: tuple[Fact, ...]
    supports: tuple[Support, ...]


@dataclass(frozen=True, slots=True, eq=False)
class SolverVerdict:
    """The answer of the solver about a set of conditions."""

    contradictions: tuple[Contradiction, ...]
    tautologies: tuple[Fact, ...]
    encoding: "SolverEncoding"


def judge(conditions: Sequence[Fact]) -> SolverVerdict:
    """Find the contradictions among conditions, and those that hold in every scene.

    Conditions that are impossible by themselves are reported first and alone; then, as long as the rest cannot hold
    together, a minimal contradiction, whose last condition is left out of what follows.
    """
    encoding = SolverEncoding([condition.node for condition in conditions])
    formulas = [encoding.truth(condition.node) for condition in conditions]
    supports = encoding.supports
    count = len(conditions)
    questions = Questions(
        encoding.terms, encoding.terms.definitions, [*formulas, *(term for term, _ in supports)]
    )
    support_numbers = list(range(count, count + len(supports)))

    def contradiction(core: Sequence[int]) -> Contradiction:
        return Contradiction(
            tuple(conditions[member] for member in core if member < count),
            tuple(supports[member - count][1] for member in core if member >= count),
        )

    contradictions = []
    remaining = []
    for number in range(count):
        core = questions.contradiction([number, *support_numbers])
        if core is None:
            remaining.append(number)
        else:
            contradictions.append(contradiction(core))
    possible = tuple(remaining)
    while len(remaining) > 1:
        core = questions.contradiction([*remaining, *support_numbers])
        if core is None:
            break
        contradictions.append(contradiction(core))
        remaining.remove(max(member for member in core if member < count))
    tautologies = tuple(
        conditions[number] for number in possible if questions.refutes(~formulas[number], support_numbers)
    )
    return SolverVerdict(tuple(contradictions), tautologies, encoding)


class SolverEncoding:
    """The terms of nodes, with what is known of the primitive values among them."""

    def __init__(self, roots: Sequence[Node]) -> None:
        self.terms = SolverTerms()
        self.supports: list[tuple[Term, Support]] = []
        self.nodes = Graph(roots).nodes
        self._terms_of: dict[Node, Term] = {}
        self._table = frozenset(TABLE.values())
        terms_by_key: dict[Any, Term] = {}
        keys: dict[Node, Any] = {}
        for node in self.nodes:
            # The same formula written twice is one term, also where the solver knows nothing about it.
            key = self._key(node, keys)
            keys[node] = key
            if key not in terms_by_key:
                terms_by_key[key] = self._encode(node)
            self._terms_of[node] = terms_by_key[key]

    def _key(self, node: Node, keys: dict[Node, Any]) -> Any:
        if node.operation not in self._table:  # which are all pure
            return node
        try:
            hash(node.payload)
        except TypeError:
            return node
        return (node.operation.name, node.payload, *(id(keys[operand]) for operand in node.operands))

    def term(self, node: Node) -> Term:
        """Return the term of a node; ``None`` for Python objects of which nothing is known."""
        return self._terms_of[node]

    def truth(self, node: Node) -> Term:
        """Return the term of a condition; an unconstrained term if the condition is not a boolean node."""
        term = self._terms_of[node]
        return term if node.kind is Kind.BOOLEAN else self.terms.fresh(Kind.BOOLEAN)

    def _encode(self, node: Node) -> Term:
        terms = self.terms
        if node.is_constant:
            return self._constant(node)
        if node.is_axis:
            value = terms.fresh(Kind.SCALAR)
            terms.define((value > terms.real(0)) & (value < terms.real(1)))
            return value
        solver = node.operation.solver
        operands = [self._terms_of[operand] for operand in node.operands]
        if solver is None or (node.operation.strict and any(operand is None for operand in operands)):
            return terms.fresh(node.kind)
        first = len(terms.supports)
        term = solver(terms, node.payload, *operands)
        self.supports += [(fact, Support(node, phrase)) for fact, phrase in terms.supports[first:]]
        return terms.fresh(node.kind) if term is None else term

    def _constant(self, node: Node) -> Term:
        value, kind = node.value, node.kind
        if kind.is_boxed and not isinstance(value, bool | int | float):
            return None
        if isinstance(value, bool):
            return self.terms.truth(value)
        if kind.trailing:
            parts = node.payload.column[0].tolist()
            finite = all(math.isfinite(part) for part in parts)
            return tuple(self.terms.real(part) for part in parts) if finite else self.terms.fresh(kind)
        if kind is Kind.BOOLEAN:
            return self.terms.truth(bool(node.payload.column[0]))
        number = value if kind.is_boxed else node.payload.column[0].item()
        is_finite = isinstance(number, int) or math.isfinite(number)  # there are integers that no float is
        return self.terms.real(number) if is_finite else self.terms.fresh(Kind.SCALAR)
