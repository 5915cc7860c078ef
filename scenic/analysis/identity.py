"""Digests of what narrowing depends on, by which its results are kept for later runs.

Equal digests mean equal results on one version of the code. A digest is made of all that bounds read: numbers, arrays, objects of this
package with all that they hold (or their ``content_digest``, where they have one), and functions of this package with what they enclose. Where there is anything else, as
a function or an object of the program's own, there is no digest.
"""

import functools
import hashlib
import sys
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from types import BuiltinFunctionType, FunctionType, MappingProxyType, MethodType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.graph.node import Graph, Node
from scenic.graph.operation import Operation

__all__ = ["identity"]

_MOST: Final = 10_000
"""Values that are looked at; of more the digest could cost more than it saves."""

_PACKAGE: Final = "scenic."
"""Names of modules that begin so are ours: their functions are the same wherever the version of the code is."""

_PLAIN: Final = (type(None), bool, int, float, complex, str, bytes, range, slice)

_READINGS: Final = ("bounds", "inverse", "cuts", "looks_at")
"""The parts of an operation that narrowing calls."""


class _UnknownError(Exception):
    """Something of which nothing is known but what it does."""


def identity(
    graph: Graph, order: Sequence[Node], conditions: Sequence[Node], met: Mapping[Node, NDArray[np.bool_]]
) -> bytes | None:
    """A digest of some nodes, and of all else that narrowing reads; ``None`` where it cannot be known.

    Args:
        graph: what the nodes are in: the numbers of its axes and of its nodes matter.
        order: the nodes below the conditions that bounds are read of, operands first.
        conditions: what must hold, in order.
        met: which candidates met a condition, ``(n,)``, where that is known.

    """
    content = _Content(order)
    try:
        content.add((graph.dimension, len(graph.nodes), len(order)))
        for node in order:
            content.add_node(node, graph)
        for condition in conditions:
            content.add(condition)
            content.add(met.get(condition))
    except _UnknownError:
        return None
    return content.digest()


class _Content:
    """A digest that grows."""

    def __init__(self, order: Sequence[Node]) -> None:
        self._hash = hashlib.sha256()
        self._numbers = {node: number for number, node in enumerate(order)}
        self._seen: dict[int, tuple[int, object]] = {}
        """By identity: the number of an object that has been added, and the object, which so remains what it is."""

    def digest(self) -> bytes:
        """The digest so far."""
        return self._hash.digest()

    def add_node(self, node: Node, graph: Graph) -> None:
        """Add a node of the order."""
        self._word(f"node {node.kind.value} {node.limits}")
        if node.is_axis:
            self._word(f"axis {graph.axes[node]}")
            return
        if node.is_constant:
            self._constant(node)
            return
        self.add(node.operation)
        self.add(node.payload)
        for operand in node.operands:
            if operand in self._numbers:
                self.add(operand)
            else:
                # Its bounds are never read, but its kind and its operation's name may be.
                self._word(f"unread {operand.kind.value} {operand.operation.name}")

    def add(self, value: Any) -> None:
        """Add a value with all that it holds."""
        kind = type(value)
        if kind in _PLAIN:
            self._word(f"{kind.__name__} {value!r}")
        elif kind is Node:
            number = self._numbers.get(value)
            if number is None:
                raise _UnknownError
            self._word(f"node {number}")
        elif isinstance(value, np.generic):
            self._array(np.asarray(value))
        elif id(value) in self._seen:
            self._word(f"again {self._seen[id(value)][0]}")
        else:
            if len(self._seen) >= _MOST:
                raise _UnknownError
            self._seen[id(value)] = len(self._seen), value
            self._add_object(value, kind)

    def _add_object(self, value: Any, kind: type[Any]) -> None:
        if kind is np.ndarray:
            self._array(value)
        elif kind in (tuple, list):
            self._word(f"{kind.__name__} {len(value)}")
            for item in value:
                self.add(item)
        elif kind in (dict, MappingProxyType):
            self._word(f"mapping {len(value)}")
            for key, item in value.items():
                self.add(key)
                self.add(item)
        elif kind is frozenset and all(isinstance(item, str | int | Enum) for item in value):
            self._word(f"set {sorted(map(repr, value))}")
        elif isinstance(value, Enum):
            self._word(f"enum {kind.__module__}.{kind.__qualname__}.{value.name}")
        elif kind is Operation:
            self._word(f"operation {value.name} {value.strict} {value.partial}")
            for reading in _READINGS:
                self.add(getattr(value, reading))
        else:
            self._add_code(value, kind)

    def _add_code(self, value: Any, kind: type[Any]) -> None:
        """Add a function, a class or an instance of one of our classes."""
        if kind is functools.partial:
            self._word("partial")
            self.add((value.func, value.args, value.keywords))
        elif kind is MethodType:
            self._word("method")
            self.add((value.__func__, value.__self__))
        elif kind is FunctionType:
            self._function(value)
        elif isinstance(value, type) or kind is BuiltinFunctionType or kind is np.ufunc:
            self._named(value)
        elif kind.__module__.startswith(_PACKAGE):
            self._word(f"instance {kind.__module__}.{kind.__qualname__}")
            digest = getattr(value, "content_digest", None)
            if type(digest) is bytes:
                self._word(digest.hex())
                return
            for name, item in _state(value, kind):
                self._word(name)
                self.add(item)
        elif kind.__module__.startswith("shapely.geometry."):
            self._word(f"geometry {value.wkb_hex}")
        else:
            raise _UnknownError

    def _function(self, value: FunctionType) -> None:
        """Digest a function of this package: its code by its place, its defaults, and the values that it encloses."""
        if not value.__module__.startswith(_PACKAGE):
            raise _UnknownError
        code = value.__code__
        self._word(f"function {value.__module__}.{value.__qualname__} {code.co_firstlineno}")
        self._word(code.co_code.hex())
        try:
            cell_values = tuple(cell.cell_contents for cell in value.__closure__ or ())
        except ValueError:  # not there yet
            raise _UnknownError from None
        self.add((value.__defaults__, value.__kwdefaults__))
        for item in cell_values:
            self.add(item)

    def _named(self, value: Any) -> None:
        """Digest a value by its name in a module of this package, of Python or of NumPy."""
        module = getattr(value, "__module__", None) or "numpy"
        name = getattr(value, "__qualname__", value.__name__)
        member: Any = sys.modules.get(module)
        for part in name.split("."):
            member = getattr(member, part, None)
        top = module.partition(".")[0]
        if member is not value or not (top in ("scenic", "numpy") or top in sys.stdlib_module_names):
            raise _UnknownError
        self._word(f"named {module}.{name}")

    def _constant(self, node: Node) -> None:
        if node.kind.is_boxed:
            self.add(node.value)
        else:
            self._array(node.payload.column)

    def _array(self, array: NDArray[Any]) -> None:
        self._word(f"array {array.dtype.str} {array.shape}")
        if array.dtype.hasobject:
            for item in array.flat:
                self.add(item)
            return
        self._hash.update(np.ascontiguousarray(array).data)

    def _word(self, text: str) -> None:
        self._hash.update(f"{len(text)}:{text};".encode("utf-8", "surrogatepass"))


def _state(value: Any, kind: type[Any]) -> Iterator[tuple[str, Any]]:
    """The attributes of an instance, by name; without those that it computes from the others and caches."""
    for each in reversed(kind.__mro__):
        for name in vars(each).get("__slots__", ()):
            if name not in ("__weakref__", "__dict__") and hasattr(value, name):
                yield name, getattr(value, name)
    for name, item in getattr(value, "__dict__", {}).items():
        if not isinstance(getattr(kind, name, None), functools.cached_property):
            yield name, item
