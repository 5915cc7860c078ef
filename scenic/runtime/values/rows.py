"""Definite vectors and orientations as rows of floats: what operations on values know of them.

The classes that programs see, with all their methods, stand on the operations (`scenic.runtime.values.definite`); each registers
itself here by the length of its rows, so that operations can make its instances.
"""

from collections.abc import Iterable, Iterator
from typing import Any, ClassVar, Final, Self

__all__ = ["EXACT", "OrientationRow", "Row", "VectorRow", "orientation_of", "vector_of"]


class Row:
    """Base of definite vectors and orientations.

    A subclass that gives ``length`` is registered as the one whose instances operations make. Its instances are nothing but
    their rows.
    """

    __slots__ = ("_row",)
    _row: tuple[float, ...]
    _registered: ClassVar[dict[int, type["Row"]]] = {}
    """The class of rows of each length."""
    _plain: ClassVar[set[type["Row"]]] = set()
    """The registered classes."""

    def __init_subclass__(cls, *, length: int | None = None, **options: Any) -> None:
        super().__init_subclass__(**options)
        if length is not None:
            Row._registered[length] = cls
            Row._plain.add(cls)

    @classmethod
    def of(cls, row: Iterable[float]) -> Self:
        """Return the instance of a row of floats."""
        self = object.__new__(cls)
        self._row = tuple(row)
        return self


class VectorRow(Row):
    """Base of definite vectors: three floats, in metres."""

    __slots__ = ()
    _row: tuple[float, float, float]

    @property
    def row(self) -> tuple[float, float, float]:
        """The three floats."""
        return self._row

    def __iter__(self) -> Iterator[float]:
        return iter(self._row)


class OrientationRow(Row):
    """Base of definite orientations: unit quaternions x, y, z, w."""

    __slots__ = ()
    _row: tuple[float, float, float, float]


_CLASSES: Final[dict[int, type[Row]]] = Row._registered
EXACT: Final = Row._plain
"""Classes whose instances are nothing but their rows."""


def row_class(length: int) -> type[Row]:
    """Return the class whose instances are made of rows of a length: 3 for vectors, 4 for orientations."""
    return _CLASSES[length]


def vector_of(row: tuple[float, float, float]) -> Any:
    """Return the vector of three floats."""
    value: Any = object.__new__(_CLASSES[3])
    value._row = row
    return value


def orientation_of(row: tuple[float, ...]) -> Any:
    """Return the orientation of a unit quaternion x, y, z, w."""
    value: Any = object.__new__(_CLASSES[4])
    value._row = row
    return value


def of_row(result: object) -> Any:
    """The result of an operation on plain numbers as a value: a row as a vector or an orientation."""
    if type(result) is not tuple:
        return result
    value: Any = object.__new__(_CLASSES[len(result)])
    value._row = result
    return value
