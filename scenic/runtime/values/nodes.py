"""Values as nodes of the graph, and nodes as values; of which kind a value is, and how columns hold it."""

from collections.abc import Callable
from typing import Any, Final, TypeGuard

import numpy as np

from scenic.graph import construction
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node, constant
from scenic.graph.operation import Operation, always, by_lane
from scenic.language.errors import ScenicTypeError, UnsupportedError
from scenic.runtime.ground.context import here
from scenic.runtime.values.describing import describe
from scenic.runtime.values.generic import as_orientation, as_vector
from scenic.runtime.values.random_base import RandomBase, is_random, random_value
from scenic.runtime.values.rows import OrientationRow, VectorRow, row_class

LARGEST_INTEGER = 2**62
"""Integers beyond this are kept as Python objects."""


_NUMBERS = (int, float, np.integer, np.floating, np.bool_)  # made once: it is asked for all the time


ROWS = (tuple, list, np.ndarray)


def is_number(value: object) -> TypeGuard[float]:
    """Return whether a definite value is a real number."""
    return isinstance(value, _NUMBERS)


def is_vector(value: object) -> bool:
    """Return whether a value is a vector, or a pair or triple that stands for one."""
    if isinstance(value, RandomBase):
        return value.node.kind is Kind.VECTOR
    if isinstance(value, tuple | list):
        return len(value) in (2, 3)
    return isinstance(value, VectorRow) or (isinstance(value, np.ndarray) and value.shape in ((2,), (3,)))


def is_orientation(value: object) -> bool:
    """Return whether a value is an orientation."""
    if isinstance(value, RandomBase):
        return value.node.kind is Kind.ORIENTATION
    return isinstance(value, OrientationRow)


def kind_of(value: object) -> Kind:
    """Return the kind of a definite value."""
    if isinstance(value, bool | np.bool_):
        return Kind.BOOLEAN
    if isinstance(value, int | np.integer):
        return Kind.INTEGER if abs(int(value)) < LARGEST_INTEGER else Kind.OTHER
    if isinstance(value, float | np.floating):
        return Kind.SCALAR
    if isinstance(value, VectorRow):
        return Kind.VECTOR
    if isinstance(value, OrientationRow):
        return Kind.ORIENTATION
    kind: Kind = getattr(value, "scenic_kind", Kind.OTHER)
    return kind if isinstance(kind, Kind) else Kind.OTHER


class ValueCodec:
    """Columns as the values above; see `scenic.graph.kinds.Codec`."""

    def decode(self, kind: Kind, column: Column) -> list[Any]:
        """Return the values of a column, lane by lane."""
        if not kind.trailing:
            return column.tolist()  # type: ignore[no-any-return]
        cls = row_class(3 if kind is Kind.VECTOR else 4)
        values: list[Any] = [object.__new__(cls) for _ in column]
        for value, row in zip(values, zip(*column.T.tolist(), strict=True), strict=True):
            value._row = row
        return values

    def encode(self, kind: Kind, value: object) -> Any:
        """Return the row of a value; raises ``TypeError`` where it is of another kind."""
        if kind.is_boxed:
            return value
        if isinstance(value, RandomBase):
            raise UnsupportedError(
                "reaching a random value of an instance through a random container is not supported yet",
                help="choose among the instances themselves: `Uniform(a, b)`",
            )
        if kind is Kind.VECTOR:
            return value._row if isinstance(value, VectorRow) else tuple(as_vector(value))
        if kind is Kind.ORIENTATION:
            if isinstance(value, OrientationRow):
                return value._row
            orientation = as_orientation(value)
            return (orientation.x, orientation.y, orientation.z, orientation.w)
        if not is_number(value):
            raise ScenicTypeError(f"expected a number, not {describe(value)}")
        return value


CODEC = ValueCodec()


TUPLE = Operation(
    "tuple",
    always(Kind.OTHER),
    by_lane,
    "A tuple with random parts.",
    python=lambda *parts: parts,
    together=lambda *parts: list(zip(*parts, strict=True)),
)


LIST = Operation(
    "list",
    always(Kind.OTHER),
    by_lane,
    "A list with random parts.",
    python=lambda *parts: list(parts),
    together=lambda *parts: list(map(list, zip(*parts, strict=True))),
)


_SLICE = Operation("slice", always(Kind.OTHER), by_lane, "A slice with random ends.", python=slice)


def _paired(*parts: Any) -> dict[Any, Any]:
    count = len(parts) // 2
    return dict(zip(parts[:count], parts[count:], strict=True))


DICTIONARY = Operation(
    "dictionary",
    always(Kind.OTHER),
    by_lane,
    "A dictionary with random parts; operands its keys, then its values; payload which operand is of which key, "
    "or none where a key is random.",
    python=_paired,
)


_SET = Operation(
    "set", always(Kind.OTHER), by_lane, "A set with random elements.", python=lambda *parts: set(parts)
)


_FROZEN_SET = Operation(
    "frozen set",
    always(Kind.OTHER),
    by_lane,
    "A set with random elements that is not changed.",
    python=lambda *parts: frozenset(parts),
)

CONTAINERS_MADE: Final = frozenset({TUPLE, LIST, DICTIONARY, _SET, _FROZEN_SET})
"""Operations that put their operands into a container, as they are."""


def _container(value: object) -> Operation:
    """Return the operation that makes a container of the type of ``value`` from its parts."""
    if isinstance(value, list):
        return LIST
    if not hasattr(value, "_fields"):
        return TUPLE
    return Operation(
        "named tuple", always(Kind.OTHER), by_lane, "A named tuple with random parts.", python=type(value)
    )


def as_node(value: Any) -> Node:
    """Return the node of a value: its own if random, else a constant."""
    if isinstance(value, RandomBase):
        return value.node
    if isinstance(value, tuple | list) and is_random(value):
        return construction.make_node(_container(value), [as_node(item) for item in value], span=here())
    if isinstance(value, slice) and is_random(value):
        ends = [as_node(end) for end in (value.start, value.stop, value.step)]
        return construction.make_node(_SLICE, ends, span=here())
    if type(value) is dict and is_random(value):
        places = (
            None if is_random(tuple(value)) else {key: len(value) + place for place, key in enumerate(value)}
        )
        parts = [as_node(item) for item in (*value, *value.values())]
        return construction.make_node(DICTIONARY, parts, places, here())
    if type(value) in (set, frozenset) and is_random(value):
        operation = _SET if type(value) is set else _FROZEN_SET
        return construction.make_node(operation, [as_node(item) for item in value], span=here())
    kind = kind_of(value)
    return constant(value, kind, CODEC.encode(kind, value))


def as_value(node: Node, again: Callable[[], Any] | None = None) -> Any:
    """Return the value of a node: definite for a constant, else random."""
    if node.is_constant:
        return node.value
    return random_value(node, again)
