"""Objects of our own classes, and of those that derive from them, whose attributes may hold values of a program."""

import copy as shallow
from typing import Any

from scenic.runtime.values.ownership import slots

__all__ = ["Carrier"]


class Carrier:
    """A holder that a program may make of random values or instances, or of functions that read some."""

    def random_parts(self) -> list[Any]:
        """Return the values in the holder that may be random, for sampling."""
        return [type(self), *_held(self).values()]

    def sampled(self, sample: Any) -> Any:
        """Return the same of sampled values; itself where they are those that it has."""
        twin = shallow.copy(self)
        sample.remember(self, twin)  # Its parts may lead back to it.
        cls = sample.value(type(self))
        attributes = _held(self)
        values = {name: sample.value(item) for name, item in attributes.items()}
        if cls is type(self) and all(values[name] is item for name, item in attributes.items()):
            sample.remember(self, self)
            return self
        object.__setattr__(twin, "__class__", cls)
        for name, item in values.items():
            object.__setattr__(twin, name, item)
        return twin


def _held(carrier: Carrier) -> dict[str, Any]:
    """Return the attributes that it holds itself, by name."""
    kept = {name: getattr(carrier, name) for name in slots(type(carrier)) if hasattr(carrier, name)}
    return {**kept, **getattr(carrier, "__dict__", {})}
