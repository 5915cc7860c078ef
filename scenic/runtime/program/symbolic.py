"""Methods that generated code calls to build the nodes of a condition."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from scenic.graph.construction import make_node
from scenic.graph.kinds import Kind
from scenic.graph.operations import TABLE
from scenic.runtime.description.conditions import Condition, NotSymbolicError, connect, truth
from scenic.runtime.elements.operands import is_kind, is_unknown
from scenic.runtime.ground.context import here
from scenic.runtime.instances.objects import Object, Point
from scenic.runtime.program import builtins as names
from scenic.runtime.program import unrolling
from scenic.runtime.program.constructing import constructed
from scenic.runtime.python.samples import may_return_instances
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import as_region
from scenic.runtime.values.frozen import Frozen
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.methods import OrientationMethods, VectorMethods
from scenic.runtime.values.values import (
    IDENTITY,
    Random,
    apply,
    as_node,
    as_value,
    is_answered_by_code,
    is_choice_of_frozen,
    is_random,
    operate,
)

_COMPARISONS: Mapping[str, str] = MappingProxyType(
    {
        "<": "less",
        "<=": "less or equal",
        ">": "greater",
        ">=": "greater or equal",
        "==": "equal",
        "!=": "not equal",
    }
)

_OF_ORDER = ("__eq__", "__ne__", "__lt__", "__le__", "__gt__", "__ge__")


class Symbolic:
    """The part of the prelude that the symbolic reading of a condition calls.

    What only a sample can tell raises `NotSymbolicError`: then Python evaluates the condition on each sample.
    """

    def provided(self, name: str, function: object) -> Any:
        """Return the function, if it is the one that every module finds in scope under this name."""
        if function is not names.provided(name):
            raise NotSymbolicError
        return function

    def read(self, value: object, name: str) -> Any:
        """An attribute, read when the condition is evaluated."""
        return getattr(value, name)

    def call(self, value: object, name: str, *args: Any) -> Any:
        """Return a method that takes random arguments; any other is called on samples."""
        if not isinstance(value, VectorMethods | OrientationMethods | Region | Random | Object | Frozen):
            raise NotSymbolicError
        if isinstance(value, Object) and getattr(type(value), name, None) is not getattr(Object, name, None):
            raise NotSymbolicError  # The program's own method: never traced.
        return getattr(value, name)(*args)

    def compare(self, operator: str, left: object, right: object) -> Any:
        """Evaluate ``left operator right`` to a truth value, which may be random."""
        if may_return_instances(left) or may_return_instances(right):
            return call_later(TABLE[_COMPARISONS[operator]].python, left, right)
        if any(is_answered_by_code(item, _OF_ORDER) for item in (left, right)):
            raise NotSymbolicError
        if is_random(left) or is_random(right):
            return operate(_COMPARISONS[operator], left, right)
        if isinstance(left, Point) or isinstance(right, Point):
            raise NotSymbolicError  # Whether two instances are equal is decided on their samples.
        return operate(_COMPARISONS[operator], left, right)

    def identical(self, left: object, right: object) -> Any:
        """Evaluate ``left is right`` for instances, for objects that never change, and for random choices among these."""
        if all(item is None or isinstance(item, Point) for item in (left, right)):
            return left is right  # so are their samples
        nodes = [as_node(left), as_node(right)]
        if not all(map(is_choice_of_frozen, nodes)):
            raise NotSymbolicError
        return apply(IDENTITY, left, right)

    def contains(self, item: object, container: object) -> Any:
        """Evaluate ``item in container`` for a region; other containers are left to Python."""
        region = as_region(container)
        # Of a value that is unknown until it is drawn, the draw has to tell whether all of it has to lie in the region.
        if region is None or is_unknown(item):
            raise NotSymbolicError
        return region.containsObject(item) if is_kind(item, Object) else region.containsPoint(item)

    def all_of(self, *values: Any) -> Any:
        """Evaluate ``and`` of truth values inside an expression."""
        return self._logic("and", values)

    def any_of(self, *values: Any) -> Any:
        """Evaluate ``or`` of truth values inside an expression."""
        return self._logic("or", values)

    def invert(self, value: object) -> Any:
        """Evaluate ``not`` of a truth value inside an expression."""
        if isinstance(value, bool):
            return not value
        return as_value(connect("not", [truth(value)]))

    def _logic(self, operation: str, values: Sequence[object]) -> Any:
        nodes = [as_node(value) for value in values]
        if not all(node.kind is Kind.BOOLEAN for node in nodes):
            raise NotSymbolicError  # Python's `and` and `or` give an operand, not a truth value.
        return as_value(connect(operation, nodes))

    def iterated(self, name: str, function: object, *sequences: Any) -> Any:
        """Return the sequence over which one of Python's own functions iterates, of fixed sequences."""
        return unrolling.iterated(self.provided(name, function), sequences)

    def each(self, sequence: object, function: Callable[..., list[Any]], spread: bool) -> list[Any]:
        """Return the values of a comprehension, by a function of an element, or of its parts."""
        return unrolling.each(sequence, function, spread=spread)

    def given(self, test: object, make: Callable[[], list[Any]]) -> list[Any]:
        """Return the values behind an ``if`` of a comprehension."""
        return unrolling.given(test, make)

    def perhaps(self, test: object, make: Callable[[], list[Any]]) -> list[Any]:
        """Return the values behind an ``if`` of a comprehension that `over` or `number_of` reads."""
        return unrolling.perhaps(test, make)

    def number_of(self, length: object, values: list[Any]) -> Any:
        """Evaluate ``len([...])`` of a comprehension; ``length`` is what the program has under the name ``len``."""
        self.provided("len", length)
        return unrolling.number_of(values)

    def occurrences(self, values: object, value: object) -> Any:
        """``values.count(value)`` of a list or tuple."""
        return unrolling.occurrences(values, value)

    def items_of(self, container: object, view: str) -> list[Any]:
        """Evaluate ``container.values()``, ``keys()`` or ``items()`` of a dictionary."""
        return unrolling.items_of(container, view)

    def ascending(self, function: object, values: object) -> Any:
        """Evaluate ``values == sorted(values)``; ``function`` is what the program has under the name ``sorted``."""
        self.provided("sorted", function)
        return unrolling.ascending(values)

    def over(self, name: str, function: object, values: object) -> Any:
        """Evaluate ``all``, ``any``, ``sum``, ``min`` or ``max`` of fixed sequences."""
        self.provided(name, function)
        return unrolling.over(name, values)

    def differ(self, length: object, made: object, values: object, count: object) -> Any:
        """Evaluate ``len(set(values)) == count``; ``length`` and ``made`` are what the program has under the names ``len`` and ``set``."""
        self.provided("len", length)
        self.provided("set", made)
        return unrolling.differ(values, count)

    def construct(self, name: str, function: object, *args: Any, **keywords: Any) -> Any:
        """Return a region or vector that a condition makes."""
        return constructed(self.provided(name, function), *args, **keywords)

    def choose(self, test: Condition, then: Callable[[], Any], otherwise: Callable[[], Any]) -> Any:
        """Evaluate ``then if test else otherwise``."""
        assert test.build is not None
        node = test.build()
        if node.is_constant:
            return then() if node.value else otherwise()
        return as_value(make_node(TABLE["if"], [node, as_node(then()), as_node(otherwise())], span=here()))


__all__ = ["Symbolic"]
