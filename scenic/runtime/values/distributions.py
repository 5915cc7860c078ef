"""The distributions that programs draw from (section 8.1 of the specification).

Names are the language's. Each gives a random value while a scenario is compiled, and a plain draw during a simulation.
"""

import functools
import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final

from scenic.graph.construction import make_node
from scenic.graph.kinds import Kind
from scenic.graph.node import axis, constant
from scenic.graph.operation import Operation
from scenic.graph.operations import TABLE
from scenic.language.errors import InvalidScenarioError, ScenicTypeError, ScenicValueError
from scenic.language.names import NAMES
from scenic.language.types import SCALAR
from scenic.runtime.ground.context import current, here, next_address, uniform_draw
from scenic.runtime.values.lazy import defer, is_lazy
from scenic.runtime.values.values import (
    Random,
    as_node,
    as_value,
    describe,
    folded,
    is_number,
    is_random,
    to_scalar,
)

_MOST_EXACT: Final = 2**61
"""Whole numbers of smaller size than this fit the integers of columns."""


class Law:
    """The function that draws from a law, which can also stand after ``isinstance``, as scripts expect of a class.

    The law is declared under the function's name in `scenic.language.names`: arguments whose type is declared are converted before the
    function gets them, and values of the law are those that the declared operations make.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        declared = NAMES[function.__name__]
        assert set(declared.types) <= {SCALAR}, "no law has taken anything else so far"
        self._function = function
        self._label = f"`{declared.name}`"
        self._operations = frozenset({declared.operation, *declared.operations})
        self._numbers = declared.parameters[: len(declared.types)]

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        count = len(self._numbers)
        numbers = [to_scalar(value, self._label) for value in args[:count]]
        for name in self._numbers:
            if name in keywords:
                keywords[name] = to_scalar(keywords[name], self._label)
        return self._function(*numbers, *args[count:], **keywords)

    def __instancecheck__(self, value: object) -> bool:
        return (
            isinstance(value, Random) and value.isPrimitive and value.node.operation.name in self._operations
        )

    def __repr__(self) -> str:
        return f"<law {self._function.__name__}>"


def primitive(operation: str | Operation, *operands: Any, payload: object = None) -> Any:
    """Return a primitive random value: the operation's first operand is an axis of its own.

    In a simulation it is drawn at once. Raises `InvalidScenarioError` inside a requirement.
    """
    context = current.get()
    if context is not None and context.evaluating:
        raise InvalidScenarioError(
            "a requirement cannot create a distribution",
            span=here(),
            help="draw the value before the `require` statement and use it there",
        )
    if is_lazy(operands):
        return defer(primitive, operation, *operands, payload=payload)
    nodes = [as_node(operand) for operand in operands]
    uniform = uniform_draw()
    entry = TABLE[operation] if isinstance(operation, str) else operation
    if uniform is not None:
        first = constant(uniform, Kind.SCALAR, uniform)
        return folded(entry, [first, *nodes], payload)
    span = here()
    node = make_node(entry, [axis(span, next_address()), *nodes], payload, span)
    return as_value(node, lambda: primitive(operation, *operands, payload=payload))


@Law
def Range(low: object, high: object) -> Any:
    """A real number, uniform between two ends (in either order; they may be random)."""
    return primitive("range", low, high)


@Law
def Normal(mean: object, stdDev: object) -> Any:
    """A real number, normally distributed."""
    return primitive("normal", mean, stdDev)


@Law
def TruncatedNormal(mean: object, stdDev: object, low: object, high: object) -> Any:
    """A real number, normally distributed on condition that it lies between two fixed ends."""
    if is_random(low) or is_random(high):
        raise ScenicValueError("the window of `TruncatedNormal` must be fixed", span=here())
    window = (to_scalar(low, "`TruncatedNormal`"), to_scalar(high, "`TruncatedNormal`"))
    if not window[0] < window[1]:
        raise ScenicValueError(
            f"the window of `TruncatedNormal` is empty: {low!r} is not below {high!r}",
            span=here(),
            help="give the lower end first",
        )
    return primitive("truncated normal", mean, stdDev, payload=window)


@Law
def DiscreteRange(low: object, high: object, weights: Sequence[float] | None = None) -> Any:
    """An integer between two ends (included), uniform, or with a weight for each."""
    if weights is None:
        return primitive("discrete range", _end(low), _end(high))
    ends = []
    for end in (low, high):
        if is_random(end) or not is_number(end) or int(end) != end:
            raise ScenicTypeError(
                f"with weights the ends of `DiscreteRange` are fixed integers, not {describe(end)}",
                span=here(),
            )
        ends.append(int(end))
    if ends[0] > ends[1]:
        raise ScenicValueError(
            f"`DiscreteRange` is empty: {low} is above {high}", span=here(), help="give the lower end first"
        )
    count = ends[1] - ends[0] + 1
    if len(weights) != count:
        raise ScenicValueError(
            f"`DiscreteRange` from {low} to {high} needs {count} weights, not {len(weights)}", span=here()
        )
    numbers = [checked_weight(weight) for weight in weights]
    if not any(numbers):
        raise nothing_to_choose("DiscreteRange")
    return primitive("weighted integer", payload=(ends[0], cumulative(numbers)))


def _end(value: object) -> Any:
    """An end of a range of integers. Integers stay integers: above 2**53 floats cannot represent all of them."""
    if isinstance(value, int) and abs(value) < _MOST_EXACT:
        return int(value)
    if isinstance(value, Random) and value.node.kind is Kind.INTEGER:
        return value
    return to_scalar(value, "`DiscreteRange`")


@Law
def Uniform(*options: Any) -> Any:
    """Return one of the options, each equally likely. ``Uniform(*xs)`` draws from the elements of a list."""
    return choose_among(options, [1.0] * len(options), "Uniform")


@Law
def Discrete(options: Mapping[Any, Any] | Iterable[Any]) -> Any:
    """Return one of the keys of a dictionary, with probability in proportion to its value."""
    if isinstance(options, Mapping):
        return choose_among(
            list(options), [checked_weight(weight) for weight in options.values()], "Discrete"
        )
    if (is_random(options) and not isinstance(options, tuple | list)) or not isinstance(options, Iterable):
        raise ScenicTypeError(
            f"`Discrete` takes a dictionary of weights or a fixed collection, not {describe(options)}",
            span=here(),
        )
    keys = list(options)
    return choose_among(keys, [1.0] * len(keys), "Options")


Options = Discrete


def choose_among(options: Sequence[object], weights: Sequence[float], name: str, index: Any = None) -> Any:
    if is_lazy(tuple(options)):
        return defer(choose_among, tuple(options), weights, name, index)
    possible = [(option, weight) for option, weight in zip(options, weights, strict=True) if weight > 0]
    if not possible:
        raise nothing_to_choose(name)
    if index is None:
        index = primitive("choice", payload=cumulative([weight for _, weight in possible]))
    candidates = [option for option, _ in possible]
    if not isinstance(index, Random):
        return candidates[index]
    node = make_node(TABLE["select"], [as_node(index), *map(as_node, candidates)], span=here())
    # Drawing again keeps the options and draws only which one.
    return as_value(node, lambda: choose_among(options, weights, name))


def nothing_to_choose(name: str) -> InvalidScenarioError:
    return InvalidScenarioError(
        f"`{name}` has nothing to choose from", span=here(), help="give at least one possible option"
    )


def checked_weight(weight: object) -> float:
    if is_random(weight) or not is_number(weight):
        raise ScenicTypeError(f"a weight is a fixed number, not {describe(weight)}", span=here())
    if not 0 <= weight < math.inf:
        raise ScenicValueError(
            f"a weight is a number from 0 on, not {weight}", span=here(), help="weights need not sum to 1"
        )
    return float(weight)


def cumulative(weights: Sequence[float]) -> tuple[float, ...]:
    """Return cumulative probabilities; the last is exactly 1."""
    total = sum(weights)
    if math.isinf(total):
        return cumulative([weight / max(weights) for weight in weights])
    sums = list(itertools.accumulate(weight / total for weight in weights))
    return (*sums[:-1], 1.0)


def resample(value: object) -> Any:
    """An independent draw of the same primitive distribution; a value that is not random stays as it is."""
    return value.resampled() if isinstance(value, Random) else value
