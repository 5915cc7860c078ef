"""Distributions written in Python, and functions and methods that take random arguments (section 8.1 and 8.3)."""

import functools
from collections.abc import Callable
from typing import Any, Self, cast

import numpy as np

from scenic.graph.kinds import Column, Kind, boxed
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.language.types import SCALAR
from scenic.runtime.ground.context import current, here, uniform_draw
from scenic.runtime.python.bounded import bounds_of_support
from scenic.runtime.python.opaque import call_later, evaluated, later
from scenic.runtime.python.random_state import preserved, seed_globals
from scenic.runtime.python.single_samples import support_of
from scenic.runtime.values.lazy import is_lazy
from scenic.runtime.values.values import Random, is_random, wrong_type


class _AnyLaw(type):
    """The metaclass of custom distributions: an instance made in a simulation is replaced by the value that it draws.

    Every random value counts as a `Distribution` where a program asks with ``isinstance``.
    """

    def __call__(cls, *args: Any, **keywords: Any) -> Any:
        law = super().__call__(*args, **keywords)
        context = current.get()
        return law if context is None or context.is_symbolic else context.settled(_drawn_now(law))

    def __instancecheck__(cls, value: object) -> bool:
        return isinstance(value, Random) if cls.__base__ is Random else super().__instancecheck__(value)


class Distribution(Random, metaclass=_AnyLaw):
    """Base of distributions written in Python.

    A subclass passes the values that it depends on to the base's initialiser, and implements `sampleGiven`. It may draw from
    Python's ``random`` and from ``numpy.random``: both are seeded for each sample. In a simulation, creating
    an instance returns the drawn value.

    Args:
        dependencies: values, random or not, that the draw depends on.
        valueType: the type of the drawn values, if it is always the same; with ``float`` the value is known to be a number.

    """

    def __init__(self, *dependencies: Any, valueType: type | None = None) -> None:
        context = current.get()
        if context is not None and context.evaluating:
            raise InvalidScenarioError("a requirement cannot create a distribution", span=here())
        if is_lazy(dependencies):
            raise ScenicTypeError(
                f"{type(self).__name__} cannot depend on the object being specified", span=here()
            )
        self._dependencies = dependencies
        self._valueType = valueType
        node = later(_SCALAR if valueType is float else _LAW, _drawn, (_Holder(self), dependencies))
        super().__init__(node, self.clone)

    def sampleGiven(self, value: object) -> Any:
        """One draw; ``value[d]`` is the sampled value of the dependency ``d``."""
        raise NotImplementedError(f"{type(self).__name__} does not say how it is drawn (`sampleGiven`)")

    def clone(self) -> Self:
        """An independent draw of the same law, for ``resample``."""
        copy = object.__new__(type(self))
        copy.__dict__.update(self.__dict__)
        Distribution.__init__(copy, *self._dependencies, valueType=self._valueType)
        return copy

    def bucket(self, buckets: object = None) -> Any:
        """Return an approximation by buckets; not every distribution has one."""
        raise NotImplementedError(f"{type(self).__name__} cannot be divided into buckets")

    def supportInterval(self) -> tuple[float | None, float | None]:
        """Return the least and the greatest value, if known: analysis relies on them if ``valueType`` is ``float``."""
        return (None, None)


class _Holder:
    """Carries a distribution into the call that draws it, where it must not be replaced by its own sample."""

    def __init__(self, distribution: Distribution) -> None:
        self.distribution = distribution


class DependencyValues:
    """The sampled values of dependencies, by the dependencies themselves."""

    def __init__(self, before: tuple[Any, ...], after: tuple[Any, ...]) -> None:
        self._values = {id(old): new for old, new in zip(before, after, strict=True)}

    def __getitem__(self, dependency: object) -> Any:
        return self._values.get(id(dependency), dependency)


def _drawn(holder: _Holder, sampled: tuple[Any, ...]) -> Any:
    law = holder.distribution
    return law.sampleGiven(DependencyValues(law._dependencies, sampled))


def _drawn_now(law: Distribution) -> Any:
    """Return a value drawn from a distribution, with Python's and NumPy's generators seeded by a draw of the simulation."""
    with preserved():
        seed_globals(int((uniform_draw() or 0) * 2.0**52))
        value = _drawn(_Holder(law), law._dependencies)
    if law._valueType is not float:
        return value
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise wrong_type(SCALAR, value, "`sampleGiven`") from None


def _numbers(call: Call, *columns: Column) -> Column:
    numbers = np.full(call.lanes, np.nan)
    faulty_lanes = np.zeros(call.lanes, dtype=np.bool_)
    first: Exception | None = None
    for lane, value in enumerate(evaluated(call, columns, np.nan)):
        try:
            numbers[lane] = float(value)
        except (TypeError, ValueError, OverflowError):
            faulty_lanes[lane] = True
            first = wrong_type(SCALAR, value, "`sampleGiven`") if first is None else first
    if first is not None:
        call.fault(faulty_lanes, first)
    return numbers


_LAW = Operation(
    "drawn by Python",
    always(Kind.OTHER),
    lambda call, *columns: boxed(evaluated(call, columns)),
    "A draw of a distribution of the program's own.",
    pure=False,
    calls_code=True,
    faults=True,
    rejects=True,
)
_SCALAR = Operation(
    "number drawn by Python",
    always(Kind.SCALAR),
    _numbers,
    "A draw of a distribution of numbers of the program's own.",
    bounds=lambda code, *_operands: bounds_of_support(code.args[0].distribution.supportInterval),
    partial=True,
    pure=False,
    calls_code=True,
    faults=True,
    rejects=True,
)


def distributionMethod(method: Callable[..., Any]) -> Callable[..., Any]:
    """Make a method take random arguments: it is then called with their sampled values."""

    @functools.wraps(method)
    def lifted(self: object, *args: Any, **keywords: Any) -> Any:
        if is_random(args) or is_random(keywords):
            return call_later(method, self, *args, **keywords)
        return method(self, *args, **keywords)

    return lifted


def supportInterval(value: Any) -> tuple[float | None, float | None]:
    """Return the least and the greatest value that a number, random or not, can have; ``None`` where that is not known."""
    if Distribution in type(value).__mro__:
        return cast("tuple[float | None, float | None]", value.supportInterval())
    return support_of(value)


__all__ = ["Distribution", "distributionMethod", "supportInterval"]
