"""Values that are known only while an instance is being built, because they read its properties.

A vector field in an expression is one: ``field relative to 5 deg`` means the field's direction at the position of the
instance that is being specified. A lazy value says which properties it reads, so that it is evaluated after them;
everything computed from it is lazy too.
"""

import operator
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

from scenic.language.errors import InvalidScenarioError, RandomControlFlowError
from scenic.runtime.ground.context import here


class Lazy:
    """A value that is computed from the properties of one instance.

    Args:
        reads: the properties that it needs.
        compute: gives the value, from the instance as far as it is built.

    """

    __slots__ = ("_compute", "reads")
    __array_priority__ = 1000  # NumPy scalars on the left defer to the methods below.

    def __init__(self, reads: frozenset[str], compute: Callable[[Any], Any]) -> None:
        self.reads = reads
        self._compute = compute

    def value_for(self, instance: object) -> Any:
        """Return the value for one instance: the same on every call while the instance is built."""
        known = instance.__dict__.setdefault(MEMO, {})
        if id(self) not in known:
            known[id(self)] = (self, resolve(self._compute(instance), instance))
        return known[id(self)][1]

    def random_parts(self) -> list[Any]:
        """Return the parts of the value that may be random, for sampling."""
        return [self._compute]

    def sampled(self, sample: Any) -> "Lazy":
        """Return the same over sampled values."""
        return Lazy(self.reads, lambda instance: sample.value(self._compute(instance)))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") and name.endswith("__"):
            raise AttributeError(name)
        return defer(getattr, self, name)

    def __getitem__(self, index: object) -> Any:
        return defer(operator.getitem, self, index)

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        return defer(_called, self, *args, **keywords)

    def _definite(self, what: str) -> RandomControlFlowError:
        return RandomControlFlowError(
            f"{what} a value that depends on the object being specified is not possible here",
            span=here(),
            help="it is known only while the object is built: use it in a specifier or in the default of a property",
        )

    def __bool__(self) -> bool:
        raise self._definite("branching on the truth of")

    def __iter__(self) -> Iterator[Any]:
        raise self._definite("iterating over")

    def __len__(self) -> int:
        raise self._definite("taking Python's own `len` of")

    def __contains__(self, item: object) -> bool:
        raise self._definite("looking into")

    def __lt__(self, other: object) -> bool:
        raise self._definite("comparing")

    __le__ = __gt__ = __ge__ = __lt__

    def __eq__(self, other: object) -> bool:
        raise self._definite("comparing")

    def __ne__(self, other: object) -> bool:
        raise self._definite("comparing")

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"<value that depends on {', '.join(sorted(self.reads))}>"


MEMO = "_lazy"
"""The attribute in which an instance under construction caches the results of its lazy values."""


def _called(function: Any, *args: Any, **keywords: Any) -> Any:
    return function(*args, **keywords)


def _binary(function: Callable[[Any, Any], Any]) -> tuple[Callable[..., Any], Callable[..., Any]]:
    def straight(self: Lazy, other: object) -> Any:
        return defer(function, self, other)

    def reflected(self: Lazy, other: object) -> Any:
        return defer(function, other, self)

    return straight, reflected


def _unary(function: Callable[[Any], Any]) -> Callable[..., Any]:
    return lambda self: defer(function, self)


_BINARY: Mapping[str, Callable[[Any, Any], Any]] = MappingProxyType(
    {
        **{
            name: getattr(operator, name)
            for name in ("add", "sub", "mul", "truediv", "floordiv", "mod", "pow")
        },
        "divmod": divmod,
    }
)
for _name, _function in _BINARY.items():
    _straight, _reflected = _binary(_function)
    setattr(Lazy, f"__{_name}__", _straight)
    setattr(Lazy, f"__r{_name}__", _reflected)
for _name in ("neg", "pos", "abs"):
    setattr(Lazy, f"__{_name}__", _unary(getattr(operator, _name)))


_NOTHING: frozenset[str] = frozenset()
_NUMBERS = frozenset({int, float})
"""Types that most parts of containers have; looked at first."""


def reads_of(value: Any, within: tuple[int, ...] = ()) -> frozenset[str]:
    """Return the properties that a value, or something in it, reads; none where it is not lazy.

    ``within``: the identities of the containers that hold it, which may hold themselves.
    """
    if isinstance(value, Lazy):
        return value.reads
    kind = type(value)
    names = _NOTHING
    if (kind is tuple or kind is list or kind is dict) and id(value) not in within:
        inside = (*within, id(value))
        for item in value.values() if kind is dict else value:
            if type(item) not in _NUMBERS and (reads := reads_of(item, inside)):
                names |= reads
    elif kind is slice:
        names = reads_of((value.start, value.stop, value.step))
    return names


def is_lazy(value: object) -> bool:
    """Return whether a value is lazy, or a container or slice with lazy parts."""
    return isinstance(value, Lazy) or (type(value) in (tuple, list, dict, slice) and bool(reads_of(value)))


def resolve(value: Any, instance: object) -> Any:
    """Return a value for one instance: lazy values in it evaluated, everything else as it is."""
    if isinstance(value, Lazy):
        return value.value_for(instance)
    if is_lazy(value):
        if isinstance(value, dict):
            return {key: resolve(item, instance) for key, item in value.items()}
        if isinstance(value, slice):
            return slice(*(resolve(item, instance) for item in (value.start, value.stop, value.step)))
        return type(value)(resolve(item, instance) for item in value)
    return value


def defer(function: Callable[..., Any], *args: Any, **keywords: Any) -> Lazy:
    """The lazy value of a call, some arguments of which are lazy."""
    reads = reads_of(args) | reads_of(keywords)

    def compute(instance: object) -> Any:
        given: Mapping[str, Any] = resolve(keywords, instance)
        return function(*(resolve(arg, instance) for arg in args), **given)

    return Lazy(reads, compute)


def definite(value: object, what: str) -> Any:
    """Return ``value`` unless it is lazy.

    Raises `InvalidScenarioError` for a lazy value: ``what`` has no object to read.
    """
    if is_lazy(value):
        raise InvalidScenarioError(
            f"{what} depends on the object being specified, and is undefined outside of its definition",
            span=here(),
            help="evaluate a field at a point instead: `field at position`",
        )
    return value


__all__ = ["MEMO", "Lazy", "defer", "definite", "is_lazy", "reads_of", "resolve"]
