"""The values of a program in one simulation.

A simulation works on copies of its own: sampled values in place of random ones, objects whose properties change with time,
functions over global names that they may assign. So nothing that happens in it is seen by the scene
or by another simulation. Containers that hold nothing of that are shared with the program, and filled as at first for each simulation
(`scenic.runtime.python.shared_containers`).
"""

from collections.abc import Iterable
from types import FunctionType, ModuleType
from typing import Any, Final
from weakref import ref

import numpy as np

from scenic.runtime.python.samples import Globals, Sample, SampledLanes
from scenic.runtime.python.shared_containers import Originals
from scenic.runtime.values.instance_base import Instance
from scenic.runtime.values.ownership import (
    DECORATED,
    PRELUDE,
    SAMPLE,
    functions_of,
    is_own_function,
    leads_back,
)

__all__ = ["Copies"]

_DEEPEST: Final = 50
"""Instances within properties of instances that are copied at once; Python's stack would not hold a long chain."""


class Copies(Sample):
    """Makes the copies: one of each value, however often it is requested.

    Args:
        lanes: the values of nodes.
        lane: which of the lanes the scene is.
        originals: the program's containers that it may share.

    """

    __slots__ = ("_depth", "_filled", "_modules", "_originals", "_own", "_shares", "_waiting")

    def __init__(self, lanes: SampledLanes, lane: int, originals: Originals) -> None:
        names = Globals()
        names.contents, names.with_methods = originals.contents, originals.with_methods
        super().__init__(lanes, lane, names)
        self._originals = originals
        self._shares = originals.claim(self)
        self._filled: dict[int, set[str]] = {}
        self._own: dict[int, dict[str, Any]] = {}
        self._modules: dict[int, ModuleType] = {}
        self._depth = 0
        self._waiting: list[tuple[Instance, Any]] = []

    def release(self) -> None:
        """The simulation has ended: another one may use what it has shared with the program."""
        self._originals.release(self)

    def adopt(self, module: ModuleType) -> None:
        """A module is about to run that the simulation is the first to import, and that is its own therefore."""
        names = vars(module)
        names[SAMPLE] = ref(self)
        self._own[id(names)] = names
        self.remember(module, module)

    def remember(self, value: object, copy: object) -> None:
        """Say what the copy of a value is while it is being made; the copy is its own."""
        super().remember(value, copy)
        self._memo[id(copy)] = copy

    def _sampled(self, value: object) -> Any:
        if self._shares and value in self._originals:
            return value
        # An array may be changed in place.
        return (
            self._originals.contents(value).copy() if type(value) is np.ndarray else super()._sampled(value)
        )

    def _stays(self, item: object) -> bool:
        if isinstance(item, DECORATED):
            return all(map(self._stays, functions_of(item)))
        if not isinstance(item, FunctionType):
            return False
        # What the simulation itself defined is its own already.
        return id(item.__globals__) in self._own if is_own_function(item) else not leads_back(item)

    def _varies(self, cls: type) -> bool:
        return True

    def _instance(self, instance: Instance) -> Any:
        source = instance.__dict__.get("_source", instance)
        if source is not instance:
            return self.value(source)
        copy = object.__new__(type(instance))
        self.remember(instance, copy)
        self._waiting.append((instance, copy))
        if self._depth < _DEEPEST:
            self._depth += 1
            try:
                while self._waiting:
                    self._complete(*self._waiting.pop())
            finally:
                self._depth -= 1
        return copy

    def _complete(self, instance: Instance, copy: object) -> None:
        """Give a copy the values of its own."""
        for name, value in instance.__dict__.items():
            copy.__dict__[name] = self.value(value)
        copy.__dict__["_sample"] = self

    def _module(self, module: ModuleType) -> ModuleType:
        copy = self._space(vars(module))
        self.remember(module, copy)
        self._fill_in([name for name in vars(module) if not name.startswith("__")], vars(module))
        return copy

    def _scope(self, function: FunctionType) -> dict[str, Any]:
        return vars(self._space(function.__globals__))

    def _space(self, names: dict[str, Any]) -> ModuleType:
        """Return the module whose names functions over these names read and write, so that both ways to them lead to the same."""
        module = self._modules.get(id(names))
        if module is None:
            module = self._modules[id(names)] = ModuleType("")
            scope = vars(module)
            scope.update(names)
            scope[SAMPLE] = ref(self)
            self._own[id(scope)] = names  # Kept alive, so that identities stay unique.
            self._filled[id(names)] = {PRELUDE, "__builtins__"}
        return module

    def _fill(self, function: FunctionType, scope: dict[str, Any]) -> None:
        self._fill_in(self._names.in_code(function.__code__), function.__globals__)

    def _fill_in(self, wanted: Iterable[str], names: dict[str, Any]) -> None:
        """Give the simulation its values of some names."""
        filled, scope = self._filled[id(names)], vars(self._modules[id(names)])
        for name in wanted:
            if name not in filled:
                # Only once: the simulation may have assigned it since.
                filled.add(name)
                if name in names:
                    scope[name] = self.value(names[name])
