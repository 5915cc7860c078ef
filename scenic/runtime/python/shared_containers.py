"""Containers that simulations share with the program, and what they held when it had run.

Code that a program imports may hold the program's lists, dictionaries, sets and arrays, too: as a global of its own, in a bound
method, in an attribute. A copy would be another one than it knows. So a simulation uses those that hold nothing random as they
are, and their contents are put back in place when the next one begins. Only where a simulation of the program is still under
way has another one copies.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from types import FunctionType, ModuleType
from typing import Any
from weakref import ref

import numpy as np

from scenic.runtime.python.samples import Globals, contents_of, kind_of_container, parts, reachable
from scenic.runtime.values.instance_base import Instance
from scenic.runtime.values.ownership import PRELUDE, is_own_function
from scenic.runtime.values.values import Random

__all__ = ["Originals"]

_Contents = tuple[Any, dict[str, Any]]
"""The items of a container, as a list or an array, and its attributes."""


class Originals:
    """The containers within reach of a program's names.

    Args:
        roots: the values of these names.

    """

    def __init__(self, roots: Iterable[object]) -> None:
        self._user: ref[Any] | None = None
        self.with_methods: dict[type, bool] = {}
        """Classes, and whether methods of theirs are a program's, as simulations have found (`scenic.runtime.values.ownership.is_own`)."""
        self._kept: dict[int, tuple[Any, _Contents]] = {
            id(item): (item, _contents(item)) for item in _shareable(list(roots))
        }

    def __contains__(self, item: object) -> bool:
        return id(item) in self._kept

    def contents(self, container: object) -> Any:
        """Return the contents of a container when the program had run; the present ones if it is none of these."""
        kept = self._kept.get(id(container))
        return _contents(container)[0] if kept is None else kept[1][0]

    def claim(self, user: object) -> bool:
        """Let a simulation use the containers, filled as at first; false if another one is using them."""
        if self._user is not None and self._user() is not None:
            return False
        self._user = ref(user)
        for container, contents in self._kept.values():
            _fill(container, contents)
        return True

    def release(self, user: object) -> None:
        """A simulation has ended; what the containers hold stays there to be looked at."""
        if self._user is not None and self._user() is user:
            self._user = None

    @contextmanager
    def put_back(self) -> Iterator[None]:
        """Within this the containers hold what they held at first, whatever simulations have done."""
        now = [(container, _contents(container)) for container, _ in self._kept.values()]
        for container, contents in self._kept.values():
            _fill(container, contents)
        try:
            yield
        finally:
            for container, contents in now:
                _fill(container, contents)


def _shareable(roots: list[Any]) -> Iterator[Any]:
    """The containers in reach that are the same in every sample, and so is all that they hold."""
    names = Globals()
    values = list(reachable(roots, names))
    moving = {id(item) for item in values if _moves(item, names)}
    inside = {id(item): list(parts(item, names)) for item in values if id(item) not in moving}
    # What is found is found after something that holds it, so that few passes suffice.
    before = -1
    while before != len(moving):
        before = len(moving)
        for item in reversed(values):
            if id(item) not in moving and any(id(part) in moving for part in inside[id(item)]):
                moving.add(id(item))
    for item in values:
        if id(item) not in moving and (type(item) is np.ndarray or kind_of_container(type(item)) is not None):
            yield item


def _moves(item: object, names: Globals) -> bool:
    """Return whether each sample or simulation has its own of a value, whatever that holds."""
    if isinstance(item, Random | Instance):
        return True
    if isinstance(item, FunctionType):
        return is_own_function(item)
    if isinstance(item, ModuleType):
        return PRELUDE in vars(item)
    return names.owns(item) if isinstance(item, type) else names.copies(type(item))


def _contents(container: object) -> _Contents:
    if type(container) is np.ndarray:
        return container.copy(), {}
    return contents_of(container), dict(getattr(container, "__dict__", {}))


def _fill(container: object, contents: _Contents) -> None:
    """Put contents back in place."""
    content, attributes = contents
    if type(container) is np.ndarray:
        if container.flags.writeable and container.shape == content.shape:
            container[...] = content
        return
    kind = kind_of_container(type(container))
    kind.clear(container)
    (kind.extend if kind in (list, deque) else kind.update)(container, content)
    if hasattr(container, "__dict__"):
        vars(container).clear()
        vars(container).update(attributes)
