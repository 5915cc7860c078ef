"""The kinds of values a node may have, and how a column of each looks."""

from enum import Enum, unique
from typing import Any, Protocol

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

    SCALAR = "scalar"  # float64, (n,)
    INTEGER = "integer"  # int64, (n,); only where bounds prove that it cannot overflow
    BOOLEAN = "boolean"  # bool, (n,)
    VECTOR = "vector"  # float64, (n, 3): x, y, z in metres
    ORIENTATION = "orientation"  # float64, (n, 4): unit quaternion x, y, z, w
    KEY = "key"  # uint64, (n,): a random word that keys further draws
    REGION = "region"
    SHAPE = "shape"
    OBJECT = "object"
    OTHER = "other"

    @property
    def is_number(self) -> bool:
        """Whether Python's arithmetic applies to the column as it is."""
        return self in _NUMBERS

    @property
    def is_boxed(self) -> bool:
        """Whether columns of this kind hold Python objects."""
        return self in _BOXED

    @property
    def trailing(self) -> tuple[int, ...]:
        """Shape of one lane's value."""
        return _TRAILING.get(self, ())

    @property
    def dtype(self) -> np.dtype[Any]:
        """Element type of the column."""
        return _DTYPES.get(self, _OBJECT)


_NUMBERS = frozenset({Kind.SCALAR, Kind.INTEGER, Kind.BOOLEAN})
_BOXED = frozenset({Kind.REGION, Kind.SHAPE, Kind.OBJECT, Kind.OTHER})
_TRAILING = {Kind.VECTOR: (3,), Kind.ORIENTATION: (4,)}
_OBJECT = np.dtype(object)
_DTYPES = {
    Kind.SCALAR: np.dtype(np.float64),
    Kind.INTEGER: np.dtype(np.int64),
    Kind.BOOLEAN: np.dtype(np.bool_),
    Kind.VECTOR: np.dtype(np.float64),
    Kind.ORIENTATION: np.dtype(np.float64),
    Kind.KEY: np.dtype(np.uint64),
}


def join(*kinds: Kind) -> Kind:
    """The kind of a value that may be of any of ``kinds``: the common one, or `Kind.OTHER`.

    An integer and a scalar join to `Kind.OTHER`, since Python keeps the difference (``1`` prints otherwise
    than ``1.0``, and ``//`` of large integers is exact).
    """
    distinct = set(kinds)
    return distinct.pop() if len(distinct) == 1 else Kind.OTHER


class Codec(Protocol):
    """Turns rows of columns into the Python values that a program sees, and back.

    The graph knows no vector class; the runtime passes its codec in.
    """

    def decode(self, kind: Kind, row: Any) -> Any:
        """The Python value of one lane."""

    def encode(self, kind: Kind, value: Any) -> Any:
        """The row for a Python value; raises ``TypeError`` when it does not fit the kind."""


def boxed(values: list[Any]) -> Column:
    """A column of Python objects, whatever they are (NumPy would look into sequences)."""
    column = np.empty(len(values), dtype=object)
    for lane, value in enumerate(values):
        column[lane] = value
    return column
