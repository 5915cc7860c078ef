"""Operations on values: at once where all operands are definite, as new nodes of the graph otherwise."""

from collections.abc import Callable, Iterable, Sequence
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from scenic.graph import construction
from scenic.graph.batch import Batch
from scenic.graph.draws import Counter
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph, Node, axis, constant, key
from scenic.graph.operation import Call, Operation
from scenic.graph.operations import TABLE
from scenic.graph.schedule import Scheduler
from scenic.language.errors import InvalidScenarioError, RejectionException
from scenic.runtime.ground.context import current, here, next_address, uniform_draw
from scenic.runtime.values.choices import is_answered_by_code, over_options
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.lazy import Lazy, defer
from scenic.runtime.values.nodes import CODEC, as_node, as_value
from scenic.runtime.values.random_base import random_value
from scenic.runtime.values.rows import EXACT, of_row, row_class


def scalar_of(name: str) -> Callable[..., Any]:
    """An operation of the table on plain numbers."""
    scalar = TABLE[name].scalar
    assert scalar is not None, name
    return scalar


def operate(name: str, *operands: Any, payload: object = None) -> Any:
    """Apply an operation of the table to values."""
    return apply(TABLE[name], *operands, payload=payload)


def apply(operation: Operation, *operands: Any, payload: object = None) -> Any:
    """Apply any operation to values: at once when all are definite, as a new node otherwise; later where one is lazy."""
    if operation.scalar is not None:
        result = _at_once(operation.scalar, payload, operands)
        if result is not NotImplemented:
            return result
    if any(isinstance(operand, Lazy) for operand in operands):
        return defer(apply, operation, *operands, payload=payload)
    nodes = [as_node(operand) for operand in operands]
    if operation.pure and all(node.is_constant for node in nodes):
        return folded(operation, nodes, payload)
    if operation.pure and operation.is_python(nodes, Kind.OTHER):
        if any(node.kind.is_boxed for node in nodes) and _is_of_code(operation, operands):
            return call_later(operation.python, *operands)
        choice = over_options(nodes, lambda *options: operation.python(*options))  # type: ignore[misc] # it has one
        if choice is not None:
            return choice
    return as_value(construction.make_node(operation, nodes, payload, here()))


def _is_of_code(operation: Operation, operands: Sequence[object]) -> bool:
    """Return whether classes of the program define what Python's function gives for an operand: of samples it has to be asked."""
    # Python's operators and functions have the names of the methods that they call: `operator.add`, `len`.
    name = operation.python.__name__.strip("_")  # type: ignore[union-attr] # it has one
    methods = (f"__{name}__", f"__r{name}__", *_INSTEAD.get(name, ()))
    return any(is_answered_by_code(operand, methods) for operand in operands)


_INSTEAD: Final = MappingProxyType(
    {"int": ("__index__", "__trunc__"), "float": ("__index__",), "str": ("__repr__",)}
)
"""Methods that Python calls where a class has none of the function's own name."""


def _at_once(scalar: Callable[..., Any], payload: object, operands: Sequence[Any]) -> Any:
    """The value of an operation on plain numbers, vectors and orientations; ``NotImplemented`` where there are others."""
    rows = []
    for operand in operands:
        cls = type(operand)
        if cls is float or cls is int:
            rows.append(operand)
        elif cls in EXACT:
            rows.append(operand._row)
        else:
            return NotImplemented
    return of_row(scalar(payload, *rows))


def unary(name: str) -> Callable[[Any], Any]:
    """Return `operate` for one operation of one operand without data, which simulations apply all the time."""
    operation, scalar = TABLE[name], scalar_of(name)

    def applied(operand: Any) -> Any:
        cls = type(operand)
        if cls is float:
            result = scalar(None, operand)
        elif cls in EXACT:
            result = scalar(None, operand._row)
        else:
            return apply(operation, operand)
        if type(result) is float:
            return result
        return apply(operation, operand) if result is NotImplemented else of_row(result)

    return applied


def binary(name: str) -> Callable[[Any, Any], Any]:
    """Return `operate` for one operation of two operands without data, which simulations apply all the time."""
    operation, scalar, vectors = TABLE[name], scalar_of(name), row_class(3)

    def applied(left: Any, right: Any) -> Any:
        first, second = type(left), type(right)
        if second is vectors and first in EXACT:
            return of_row(scalar(None, left._row, right._row))
        if first is float and second is float:
            result = scalar(None, left, right)
            return apply(operation, left, right) if result is NotImplemented else result
        return apply(operation, left, right)

    return applied


def folded(operation: Operation, nodes: Sequence[Node], payload: object) -> Any:
    """Return the value of an operation on constants; raises what a sample of it would raise."""
    kind = operation.kind(nodes, payload)
    plain = all(node.kind.is_number for node in nodes) or kind.is_boxed
    if operation.python is not None and (plain or any(node.kind.is_boxed for node in nodes)):
        return operation.python(*(node.value for node in nodes))
    call = Call(
        (1,), payload, [None] * len(nodes), kinds=[node.kind for node in nodes], kind=kind, codec=CODEC
    )
    with np.errstate(all="ignore"):
        column = operation.batch(call, *(node.payload.column for node in nodes))
    if call.error is not None:
        raise call.error
    if call.status is not None:
        if _is_sampling():
            raise RejectionException(operation.missing)
        raise InvalidScenarioError(
            f"there is no {operation.missing}", span=here(), help="every sample would be rejected"
        )
    return CODEC.decode(kind, column[:1])[0]


def _is_sampling() -> bool:
    """Return whether a sample is computed, or a simulation runs, rather than the program that describes them."""
    context = current.get()
    return context is not None and (not context.is_symbolic or context.sample is not None)


def fixed_batch(nodes: Iterable[Node]) -> Batch:
    """Return a batch of one lane that holds fixed nodes."""
    return Batch(Scheduler(Graph(nodes)), Counter(np.zeros(1, dtype=np.uint64)), CODEC)


def uniform() -> Any:
    """Return one axis of the cube as a value: uniform on (0, 1)."""
    drawn = uniform_draw()
    return random_value(axis(here(), next_address())) if drawn is None else drawn


def random_key() -> Any:
    """Return a random word as a value, which keys the further draws of an operation that retries."""
    drawn = uniform_draw()
    if drawn is None:
        return random_value(key(here(), next_address()))
    # As a value it would be a number again, and no word.
    return random_value(constant(drawn, Kind.KEY, int(drawn * 2.0**52)))
