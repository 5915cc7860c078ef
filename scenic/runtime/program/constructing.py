"""Regions and vectors that a requirement makes, as values of the graph.

A region made of random values is what the region of each sample would be, unless its constructor refuses some of the samples: where
that is not excluded, `NotSymbolicError` is raised, and Python makes the region of each sample.
"""

from collections.abc import Callable
from typing import Any, Final

from scenic.graph.bounding import overall
from scenic.runtime.description.conditions import NotSymbolicError
from scenic.runtime.values.values import as_node, is_random

_SIZES: Final = ("radius", "width", "length", "angle", "dimensions")
"""Attributes of regions that constructors want to be positive."""


def constructed(constructor: Callable[..., Any], *args: Any, **keywords: Any) -> Any:
    """The result of a constructor of the language for values that may be random."""
    made = constructor(*args, **keywords)
    for name in _SIZES:
        size = getattr(made, name, None)
        if is_random(size):
            bounds = overall(as_node(size))
            if bounds is None or not (bounds.lower > 0).all():
                raise NotSymbolicError
    return made


__all__ = ["constructed"]
