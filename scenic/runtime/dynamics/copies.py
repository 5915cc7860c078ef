"""The values of a program in one simulation.

A simulation works on copies of its own: sampled values in place of random ones, objects whose properties change with time,
functions over global names that they may assign. So nothing that happens in it is seen by the scene, by the program,
or by another simulation.
"""

from collections.abc import Callable
from types import CellType, CodeType, FunctionType, MethodType
from typing import Any

from scenic.graph.node import Node
from scenic.runtime.objects import Object, OrientedPoint, Point
from scenic.runtime.samples import PRELUDE
from scenic.runtime.values import Random

__all__ = ["Copies"]

_PLAIN = (int, float, str, bytes, bool, type, CodeType)
_BUILT_IN = frozenset({object, Point, OrientedPoint, Object})


class Copies:
    """Makes the copies, one of each value however often it is asked for.

    Args:
        lookup: the value of a node in the scene.

    """

    def __init__(self, lookup: Callable[[Node], Any]) -> None:
        self._lookup = lookup
        self._memo: dict[int, tuple[Any, Any]] = {}
        self._scopes: dict[int, tuple[dict[str, Any], dict[str, Any]]] = {}
        self._methods: dict[type, tuple[tuple[str, FunctionType], ...]] = {}
        self._filled: dict[int, set[str]] = {}
        self._own: set[int] = set()
        self._names: dict[CodeType, frozenset[str]] = {}

    def value(self, value: Any) -> Any:
        """The copy of a value; the value itself if it is one that nothing can change."""
        if value is None or isinstance(value, _PLAIN):
            return value
        kept = self._memo.get(id(value))
        if kept is None:
            copy = self._copy(value)
            # What was kept while copying leads back to itself.
            kept = self._memo.setdefault(id(value), (value, copy))
        return kept[1]

    def remember(self, value: Any, copy: Any) -> None:
        """Say what the copy of a value is while it is being made."""
        self._memo[id(value)] = (value, copy)
        self._memo[id(copy)] = (copy, copy)

    def _copy(self, value: Any) -> Any:
        if isinstance(value, Random):
            drawn = self._lookup(value.node)
            return self.value(drawn) if value.node.kind.is_boxed else drawn
        if isinstance(value, Point):
            return self._instance(value)
        if isinstance(value, tuple):
            items = [self.value(item) for item in value]
            if all(new is old for new, old in zip(items, value, strict=True)):
                return value
            return type(value)(*items) if hasattr(value, "_fields") else tuple(items)
        if type(value) is list:
            copy: list[Any] = []
            self.remember(value, copy)
            copy.extend(self.value(item) for item in value)
            return copy
        if type(value) is dict:
            table: dict[Any, Any] = {}
            self.remember(value, table)
            table.update((self.value(key), self.value(item)) for key, item in value.items())
            return table
        if type(value) is set:
            return {self.value(item) for item in value}
        if isinstance(value, slice):
            return slice(self.value(value.start), self.value(value.stop), self.value(value.step))
        if isinstance(value, FunctionType):
            names = value.__globals__
            # What the simulation itself defined is its own already.
            return self._function(value) if PRELUDE in names and id(names) not in self._own else value
        if isinstance(value, MethodType):
            return MethodType(self.value(value.__func__), self.value(value.__self__))
        if hasattr(value, "sampled") and hasattr(value, "random_parts"):
            return value.sampled(self)
        return value

    def _instance(self, instance: Point) -> Any:
        source = instance.__dict__.get("_source", instance)
        if source is not instance:
            return self.value(source)
        copy = object.__new__(type(instance))
        self.remember(instance, copy)
        for name, value in instance.__dict__.items():
            copy.__dict__[name] = self.value(value)
        for name, method in self.methods(type(instance)):
            copy.__dict__[name] = MethodType(self.value(method), copy)
        return copy

    def methods(self, cls: type) -> tuple[tuple[str, FunctionType], ...]:
        """The methods that a class has from the program."""
        found = self._methods.get(cls)
        if found is None:
            own: dict[str, FunctionType] = {}
            for base in cls.__mro__:
                if base not in _BUILT_IN:
                    for name, item in vars(base).items():
                        if isinstance(item, FunctionType) and PRELUDE in item.__globals__:
                            own.setdefault(name, item)
            found = self._methods[cls] = tuple(own.items())
        return found

    def _function(self, function: FunctionType) -> FunctionType:
        """The function over the simulation's own globals and closure."""
        names = function.__globals__
        known = self._scopes.get(id(names))
        if known is None:
            known = self._scopes[id(names)] = (names, dict(names))
            self._own.add(id(known[1]))
            self._filled[id(names)] = {PRELUDE, "__builtins__"}
        scope = known[1]
        cells = tuple(CellType() for _ in function.__closure__ or ())
        copy = FunctionType(function.__code__, scope, function.__name__, None, cells or None)
        copy.__doc__ = function.__doc__
        self.remember(function, copy)
        filled = self._filled[id(names)]
        for name in self._globals_of(function.__code__):
            if name not in filled:
                # Only once: the simulation may have assigned it since.
                filled.add(name)
                if name in names:
                    scope[name] = self.value(names[name])
        for new, old in zip(cells, function.__closure__ or (), strict=True):
            try:
                content = old.cell_contents
            except ValueError:  # not bound yet
                continue
            new.cell_contents = self.value(content)
        copy.__defaults__ = self.value(function.__defaults__)
        copy.__kwdefaults__ = self.value(function.__kwdefaults__)
        return copy

    def _globals_of(self, code: CodeType) -> frozenset[str]:
        """The names that code, or code nested in it, may read or write."""
        found = self._names.get(code)
        if found is None:
            nested = [self._globals_of(item) for item in code.co_consts if isinstance(item, CodeType)]
            found = self._names[code] = frozenset(code.co_names).union(*nested)
        return found
