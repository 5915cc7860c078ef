"""Calls with starred arguments, which may be random: such a call is put off until the scene is sampled."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from scenic.language.errors import RejectionException
from scenic.runtime.distributions import Uniform
from scenic.runtime.opaque import call_later
from scenic.runtime.values import Random, uniform

Parts = Sequence[tuple[bool, Any]]
"""Positional arguments, each with whether it is starred."""


def spread(function: Callable[..., Any], parts: Parts, keywords: Mapping[str, Any]) -> Any:
    """``function(a, *b, k=c)``.

    ``Uniform(*xs)`` of a random list draws one of its elements, each equally likely; a sample in which it has none is
    rejected. Any other function is called with the sampled arguments.
    """
    if not any(is_starred and isinstance(value, Random) for is_starred, value in parts):
        return function(*_arguments(parts), **keywords)
    if function is Uniform:
        return call_later(_element, uniform(), parts)
    return call_later(_call, function, parts, **keywords)


def _arguments(parts: Parts) -> Iterator[Any]:
    for is_starred, value in parts:
        if is_starred:
            yield from value
        else:
            yield value


def _call(function: Callable[..., Any], parts: Parts, **keywords: Any) -> Any:
    return function(*_arguments(parts), **keywords)


def _element(draw: float, parts: Parts) -> Any:
    elements = list(_arguments(parts))
    if not elements:
        raise RejectionException("there is nothing to choose from")
    return elements[min(int(draw * len(elements)), len(elements) - 1)]
