"""Tables of checks: which combinations of the discrete values that a check reads pass it.

A table is made by the engine itself, which evaluates the check on a point of each combination. So it is right whatever the
check calls. Checks that differ only in the axes that they read have one table.
"""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from contextlib import suppress
from types import BuiltinFunctionType, FunctionType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.variables import Variable
from scenic.dataclass import dataclass
from scenic.graph.batch import Batch
from scenic.graph.draws import Counter, NumberSource, Points
from scenic.graph.node import Graph, Node
from scenic.language.errors import ScenicError
from scenic.runtime.python.opaque import OpaqueCode
from scenic.runtime.python.purity import global_names, is_pure
from scenic.runtime.python.samples import mention, reachable
from scenic.runtime.sampling.checks import CheckVerdict

__all__ = ["LARGEST", "Likeness", "Mask", "Table", "Tabulator", "seeds_of_calls"]

LARGEST: Final = 1 << 16
"""Combinations of a table that the engine evaluates, at most."""

LARGEST_OF_CODE: Final = 1 << 13
"""The same where evaluation calls Python code of the program that depends on its arguments alone."""

LARGEST_OF_OTHER_CODE: Final = 1 << 10
"""The same for code of the program of which that is not known."""

_SEEN: Final = ("print", "input", "open", "display")
"""Functions whose calls users see: code that names one is called for scenes only."""

BUDGET: Final = 1 << 21
"""Combinations times nodes that all tables of a program together may take, at most, in units of `_UNIT` nodes."""

_UNIT: Final = 4
_CHUNK: Final = 4096

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """The combinations of some variables that are allowed.

    Attributes:
        scope: the numbers of the variables.
        allowed: a mask with one dimension for each of them.

    """

    scope: tuple[int, ...]
    allowed: Mask


class Tabulator:
    """Makes tables of checks.

    Args:
        variables: the finite axes.
        batch: makes a batch of the engine from a source.

    """

    def __init__(self, variables: Mapping[Node, Variable], batch: Callable[[NumberSource], Batch]) -> None:
        self._variables = variables
        self._batch = batch
        self._known: dict[Hashable, Mask | None] = {}
        self._likeness = Likeness(variables)
        self._left = BUDGET
        self.reason = ""
        """The reason why the last table that was wanted is none."""

    def below(self, nodes: Iterable[Node]) -> tuple[list[Variable], list[Node], tuple[Node, ...]]:
        """The finite axes below some nodes, the other draws, and all nodes below."""
        every = Graph(nodes).nodes
        drawn = [node for node in every if node.is_drawn]
        finite = [self._variables[node] for node in drawn if node in self._variables]
        return finite, [node for node in drawn if node not in self._variables], every

    def table(
        self,
        scope: Sequence[Variable],
        nodes: Sequence[Node],
        every: Sequence[Node],
        test: Callable[[Batch], CheckVerdict],
        kind: str,
    ) -> Mask | None:
        """Return a mask ``(sizes of the scope)`` of the combinations that pass a check.

        It is ``None`` where there are too many combinations, or where one cannot be decided (`reason`).

        Args:
            scope: the finite axes that the check reads.
            nodes: the nodes that it needs.
            every: all nodes below these.
            test: the check.
            kind: its kind: checks of one kind and of alike nodes have one table.

        """
        sizes = [variable.size for variable in scope]
        count = float(np.prod(sizes, dtype=np.float64))
        calls = [node.payload for node in every if isinstance(node.payload, OpaqueCode)]
        limit = min(map(_most_calls, calls), default=LARGEST)
        if count > limit:
            self.reason = _too_many(count, limit, len(scope), bool(calls))
            return None
        key = (kind, self._likeness(nodes, every))
        if key not in self._known:
            price = int(count) * len(every) // _UNIT
            self._left -= price
            combinations = None if self._left < 0 else self._made(scope, test)
            # Code that draws random numbers by itself does not follow from the axes.
            self._known[key] = None if any(call.habit.draws for call in calls) else combinations
        if self._known[key] is None:
            self.reason = (
                "the tables of other requirements take all the work that is allowed"
                if self._left < 0
                else "it draws random numbers by itself, or fails for some combination"
            )
        return self._known[key]

    def _made(self, scope: Sequence[Variable], test: Callable[[Batch], CheckVerdict]) -> Mask | None:
        sizes = tuple(variable.size for variable in scope)
        count = int(np.prod(sizes, dtype=np.int64))
        result = np.empty(count, dtype=np.bool_)
        for start in range(0, count, _CHUNK):
            places = np.arange(start, min(start + _CHUNK, count))
            cells = np.unravel_index(places, sizes)
            numbers = {
                variable.address: variable.middles[cell] for variable, cell in zip(scope, cells, strict=True)
            }
            rest = Counter(np.zeros(len(places), dtype=np.uint64))
            try:
                with np.errstate(all="ignore"):
                    result[places] = test(self._batch(Points(numbers, rest))).passes
            except ScenicError:
                return None
        return result.reshape(sizes)


class Likeness:
    """Tells which nodes are made alike of axes that have the same cells.

    Args:
        variables: the finite axes.

    """

    def __init__(self, variables: Mapping[Node, Variable]) -> None:
        self._variables = variables
        self._identities: dict[Hashable, int] = {}

    def __call__(self, nodes: Sequence[Node], every: Sequence[Node]) -> Hashable:
        """Return a key that is equal for alike nodes; ``every`` contains all nodes below them."""
        places = {node: place for place, node in enumerate(every)}
        parts: list[Hashable] = []
        for node in every:
            if node in self._variables:
                part: Hashable = self._variables[node].lower.tobytes()
            elif node.is_drawn:
                part = node.kind
            elif node.is_constant:
                part = node.payload.key
            else:
                part = (id(node.operation), _payload_key(node.payload), node.kind)
            operands = tuple(places[operand] for operand in node.operands)
            # Long keys take long to compare: each is replaced by a number.
            parts.append(self._identities.setdefault((part, operands), len(self._identities)))
        return tuple(parts), tuple(places[node] for node in nodes)


def seeds_of_calls(graph: Graph) -> frozenset[Node]:
    """Return the keys that only seed the random generators for calls of Python code, which mostly do not use them."""
    readers: dict[Node, bool] = {}
    for node in graph.nodes:
        for operand in node.operands:
            if operand.is_drawn and not operand.is_axis:
                readers[operand] = readers.get(operand, True) and isinstance(node.payload, OpaqueCode)
    return frozenset(key for key, only in readers.items() if only)


def _most_calls(call: OpaqueCode) -> int:
    """The number of combinations, at most, for which code may be called."""
    if not isinstance(call.function, FunctionType | BuiltinFunctionType | type):
        return 0
    reads = [call.function, *call.args, *call.keywords.values()]
    values = list(reachable(reads, call.names))
    if mention(values, *_SEEN):
        return 0
    functions = [value for value in values if isinstance(value, FunctionType)]
    is_known = all(is_pure(function, global_names(function)) for function in functions)
    return LARGEST_OF_CODE if is_known else LARGEST_OF_OTHER_CODE


def _too_many(count: float, limit: int, values: int, calls: bool) -> str:
    """Say why a check has no table."""
    if limit == 0:
        return "it calls code that prints, asks or draws"
    code = " where code of the program is called" if calls else ""
    return f"its {values} values have {count:,.0f} combinations, of which at most {limit:,} are tried{code}"


def _payload_key(payload: object) -> Hashable:
    with suppress(TypeError):
        hash(payload)
        return payload
    return id(payload)
