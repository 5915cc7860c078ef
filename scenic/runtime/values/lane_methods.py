"""Methods that are evaluated in many lanes: with random arguments, or of an object that a random choice draws.

Such a method declares how arrays of its operands are evaluated for one object. So a call of it is one operation: each object of a
choice is called once, with the operands of all lanes that draw it.
"""

import functools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph import construction
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call, Operation, always
from scenic.runtime.ground.context import here
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.lazy import Lazy, defer
from scenic.runtime.values.nodes import as_node, as_value
from scenic.runtime.values.random_base import RandomBase, is_random

__all__ = ["MethodLanes", "are_open", "node_over_lanes", "over_lanes"]

_Method = TypeVar("_Method", bound=Callable[..., Any])

_SHAPES: Mapping[Kind, tuple[int, ...]] = {Kind.SCALAR: (), Kind.VECTOR: (3,), Kind.ORIENTATION: (4,)}


class MethodLanes:
    """The lanes in which a method of one object is evaluated.

    Attributes:
        failed: mask ``(n,)`` of the lanes that have no value because of ``error``.
        error: the first error.

    """

    __slots__ = ("error", "failed")

    def __init__(self, count: int) -> None:
        self.failed = np.zeros(count, dtype=np.bool_)
        self.error: Exception | None = None

    def __len__(self) -> int:
        return len(self.failed)

    def fault(self, lane: int, error: Exception) -> None:
        """Let a lane fail with an error, if its value is used."""
        self.failed[lane] = True
        self.error = self.error or error


Operands = Callable[..., tuple[Sequence[Any], Any] | None]
"""From the arguments of a method, its random operands of the declared types and a fixed setting; ``None`` if that is random."""

Evaluation = Callable[..., Column]
"""From `MethodLanes`, an object, the setting, and a column ``(n, ...)`` for each operand, the column of results."""


@dataclass(frozen=True, slots=True, eq=False)
class _Declared:
    """The declaration of a method.

    ``qualifies`` says for which objects the declaration holds; the method of any other is called on samples.
    """

    name: str
    kind: Kind
    operands: Operands
    evaluation: Evaluation
    qualifies: Callable[[Any], bool]
    operation: Operation


def over_lanes(
    kind: Kind,
    operands: Operands,
    evaluation: Evaluation,
    *,
    qualifies: Callable[[Any], bool] = lambda _owner: True,
    alone: bool = True,
    faults: bool = False,
) -> Callable[[_Method], _Method]:
    """Decorate a method of definite arguments so that random arguments make a value of the graph.

    Args:
        kind: the kind of the results: scalar, vector or orientation.
        operands: checks and converts the arguments, as the method does.
        evaluation: the same results as the method's, in every bit, for many lanes.
        qualifies: returns whether the declaration holds for an object; its method gets random arguments itself if not.
        alone: whether random arguments make a value also for a definite object; else its method gets them.
        faults: whether lanes may fail.

    """

    def decorate(method: _Method) -> _Method:
        declaration = _Declared(
            method.__name__,
            kind,
            operands,
            evaluation,
            qualifies,
            Operation(
                f"method {method.__name__}",
                always(kind),
                _evaluated,
                "A method of the object of an index; payload the declaration, the objects, and a setting of the call.",
                faults=faults,
            ),
        )

        if not alone:
            method.__dict__["over_lanes"] = declaration
            return method

        @functools.wraps(method)
        def call(owner: Any, *args: Any, **keywords: Any) -> Any:
            if not are_open(args, keywords) or not qualifies(owner):
                return method(owner, *args, **keywords)
            node = _node(declaration, as_node(0), [owner], args, keywords)
            if node is None:
                return call_later(method, owner, *args, **keywords)
            if isinstance(node, Lazy):
                return defer(functools.partial(call, owner), *args, **keywords)
            return as_value(node)

        call.__dict__["over_lanes"] = declaration
        return call  # type: ignore[return-value] # of the same parameters

    return decorate


def are_open(args: Iterable[object], keywords: Mapping[str, object]) -> bool:
    """Return whether some arguments are random or lazy, or instances with such a position."""
    return any(
        isinstance(value, Lazy | RandomBase)
        or is_random(value)
        or isinstance(getattr(value, "position", None), Lazy | RandomBase)
        for value in (*args, *keywords.values())
    )


def node_over_lanes(
    index: Node, functions: Sequence[Node], args: Sequence[object], keywords: Mapping[str, object]
) -> Node | None:
    """The call of a choice among bound methods with such a declaration, as one node; ``None`` for other functions.

    A node of ``functions`` that is not constant counts as absent: whoever chooses has to put it in its place.
    """
    owners: list[Any] = []
    common_declaration: _Declared | None = None
    for function in functions:
        if not function.is_constant:
            owners.append(None)
            continue
        declaration = getattr(getattr(function.value, "__func__", None), "over_lanes", None)
        if declaration is None or (common_declaration is not None and common_declaration is not declaration):
            return None
        owner = function.value.__self__
        if not declaration.qualifies(owner):
            return None
        common_declaration = declaration
        owners.append(owner)
    if common_declaration is None:
        return None
    try:
        node = _node(common_declaration, index, owners, args, keywords)
    except Exception:  # noqa: BLE001 - whatever the arguments are, each option reports it for itself
        return None
    return node if isinstance(node, Node) else None


def _node(
    declared: _Declared,
    index: Node,
    owners: Sequence[object],
    args: Sequence[object],
    keywords: Mapping[str, object],
) -> Node | Lazy | None:
    operands = declared.operands(*args, **keywords)
    if operands is None:
        return None
    values, setting = operands
    lazy = next((value for value in values if isinstance(value, Lazy)), None)
    if lazy is not None:
        return lazy
    nodes = [index, *map(as_node, values)]
    if any(node.kind.is_boxed for node in nodes):
        return None
    payload = (declared, tuple(owners), setting)
    return construction.make_node(declared.operation, nodes, payload, here())


def _evaluated(call: Call, index: Column, *columns: Column) -> Column:
    declaration, owners, setting = call.payload
    lanes = max(map(len, (index, *columns)))
    spread = [np.broadcast_to(column, (lanes, *column.shape[1:])) for column in columns]
    result = np.zeros((lanes, *_SHAPES[declaration.kind]))
    faulty_lanes, error = np.zeros(lanes, dtype=np.bool_), None
    for number, mine in _groups(np.broadcast_to(index, lanes)):
        if owners[number] is None:
            continue
        part = MethodLanes(len(mine))
        result[mine] = declaration.evaluation(
            part, owners[number], setting, *(np.ascontiguousarray(column[mine]) for column in spread)
        )
        if part.error is not None:
            faulty_lanes[mine] = part.failed
            error = error or part.error
    if error is not None:
        call.fault(faulty_lanes, error)
    return result


def _groups(index: NDArray[np.int64]) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """The numbers that occur, each with the lanes that have it."""
    order = np.argsort(index, kind="stable")
    numbers, starts = np.unique(index[order], return_index=True)
    yield from zip(numbers.tolist(), np.split(order, starts[1:]), strict=True)
