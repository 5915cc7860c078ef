"""The kinds of values a node may have, and how a column of each looks."""

from enum import Enum, unique
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

Column = NDArray[Any]
"""Values of one node over the lanes of a batch: shape ``(n,)``, ``(n, 3)`` or ``(n, 4)`` by kind.

A value that is the same in every lane may have a leading dimension of 1 instead of ``n``; operations are written
elementwise, so that broadcasting does the rest. An operation that *stacks* also takes the columns of several alike nodes at
once, with one more leading dimension for the nodes.
"""


@unique
class Kind(Enum):
    """Static type of a node. The last four differ in meaning only: their columns hold Python objects."""

    SCALAR = "scalar", np.float64
    INTEGER = "integer", np.int64  # only where bounds prove that it cannot overflow
    BOOLEAN = "boolean", np.bool_
    VECTOR = "vector", np.float64, (3,)  # x, y, z in metres
    ORIENTATION = "orientation", np.float64, (4,)  # unit quaternion x, y, z, w
    KEY = "key", np.uint64  # a random word that keys further draws
    REGION = "region", object
    SHAPE = "shape", object
    OBJECT = "object", object
    OTHER = "other", object

    dtype: np.dtype[Any]
    """Element type of the column."""
    trailing: tuple[int, ...]
    """Shape of one lane's value."""
    is_number: bool
    """True if Python's arithmetic applies to the column as it is."""
    is_boxed: bool
    """True if columns of this kind hold Python objects."""

    def __new__(cls, word: str, dtype: type[Any], trailing: tuple[int, ...] = ()) -> Self:
        kind = object.__new__(cls)
        kind._value_ = word
        kind.dtype = np.dtype(dtype)
        kind.trailing = trailing
        kind.is_number = dtype in (np.float64, np.int64, np.bool_) and not trailing
        kind.is_boxed = dtype is object
        return kind

    __hash__ = object.__hash__  # members are single; the enumeration's own hash runs in Python


def join(*kinds: Kind) -> Kind:
    """Return the kind of a value that may be of any of ``kinds``: the common one, or `Kind.OTHER`.

    An integer and a scalar join to `Kind.OTHER`, since Python keeps the difference (``1`` prints otherwise
    than ``1.0``, and ``//`` of large integers is exact).
    """
    distinct = set(kinds)
    return distinct.pop() if len(distinct) == 1 else Kind.OTHER


class Codec(Protocol):
    """Turns columns into the Python values that a program sees, and back.

    The graph knows no vector class; the runtime passes its codec in.
    """

    def decode(self, kind: Kind, column: Column) -> list[Any]:
        """Return the Python values of a column, lane by lane."""

    def encode(self, kind: Kind, value: object) -> Any:
        """Return the row for a Python value; raises ``TypeError`` when it does not fit the kind."""


def boxed(values: list[Any]) -> Column:
    """A column of Python objects, whatever they are (NumPy would look into sequences)."""
    return np.fromiter(values, dtype=object, count=len(values))
