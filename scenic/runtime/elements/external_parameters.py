"""External parameters: values that a search may choose, and ordinary draws where nothing searches.

Each owns one axis of the cube, as every primitive distribution does, and is registered with the program that makes it. So a scene of a
seed has the law that the program says; a sampler that chooses values gives the numbers of those axes
(`scenic.falsification`).
"""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from scenic.graph.construction import make_node
from scenic.graph.node import axis
from scenic.graph.operations import TABLE
from scenic.language.errors import InvalidScenarioError, ScenicTypeError, ScenicValueError
from scenic.runtime.ground.choosable import Choosable
from scenic.runtime.ground.context import current, here, next_address
from scenic.runtime.python.opaque import call_later
from scenic.runtime.values.distributions import (
    checked_weight,
    choose_among,
    cumulative,
    nothing_to_choose,
    primitive,
)
from scenic.runtime.values.values import Random, as_node, as_value, describe, is_number, is_random

__all__ = [
    "ExternalParameter",
    "SeriesValue",
    "TimeSeries",
    "VerifaiDiscreteRange",
    "VerifaiOptions",
    "VerifaiParameter",
    "VerifaiRange",
]

_BUCKETS: Final = 5
"""Default number of buckets that approximate a prior."""


def _make(operation: str, operands: Sequence[object], payload: object, choosable: Choosable) -> Any:
    """Return a value whose axis a search may choose; in a simulation it is drawn at once."""
    context = current.get()
    if context is None or not context.is_symbolic or context.evaluating:
        return primitive(operation, *operands, payload=payload)
    span, place = here(), next_address()
    uniform = axis(span, place)
    assert place is not None
    context.record.externals[place] = choosable
    constants = [as_node(item) for item in operands]
    node = make_node(TABLE[operation], [uniform, *constants], payload, span)
    return as_value(node, lambda: _make(operation, operands, payload, choosable))


class _Kind(type):
    """The class of a kind of external parameter: calling it gives a random value, which is an instance of it."""

    def __instancecheck__(cls, value: object) -> bool:
        found = choosable_of(value)
        return found is not None and (cls.__name__ in ("ExternalParameter", "VerifaiParameter", found.kind))


def choosable_of(value: object) -> Choosable | None:
    """Return the values that may be chosen, if a value is an external parameter itself."""
    context = current.get()
    if context is None or not isinstance(value, Random):
        return None
    node = value.node
    if node.operation.name in ("select", "look-up"):
        node = node.operands[0]
    first = node.operands[0] if node.operands else None
    if first is None or not first.is_axis or first.payload is None:
        return None
    return context.record.externals.get(int(first.payload))


class ExternalParameter(metaclass=_Kind):
    """A value that an external sampler gives. Programs make one of the kinds below."""

    def __new__(cls, *_arguments: Any, **_keywords: Any) -> Any:
        raise InvalidScenarioError(
            f"`{cls.__name__}` has no values of its own",
            span=here(),
            help="use `VerifaiRange`, `VerifaiDiscreteRange` or `VerifaiOptions`",
        )


class VerifaiParameter(ExternalParameter):
    """A value that a sampler of the package gives."""

    @staticmethod
    def withPrior(dist: object, buckets: int | None = None) -> Any:
        """Return an external parameter whose prior is a primitive distribution, in buckets (5 unless given).

        Samplers choose among the buckets and places in them; within a bucket the law is that of the prior. Buckets of a normal law
        are one deviation wide, the outer two endless; all others divide the values evenly.
        """
        return _with_prior(dist, _BUCKETS if buckets is None else buckets)


class VerifaiRange(VerifaiParameter):
    """A real number between two fixed ends, uniform, or with a weight for each of some buckets of equal width."""

    def __new__(
        cls, low: object, high: object, buckets: int | None = None, weights: Sequence[float] | None = None
    ) -> Any:
        return cls._over(low, high, buckets, weights)

    @classmethod
    def _over(
        cls,
        low: object,
        high: object,
        buckets: int | None,
        weights: Sequence[float] | None = None,
        *,
        is_stratified: bool = False,
    ) -> Any:
        first, last = _fixed(low, cls.__name__), _fixed(high, cls.__name__)
        if weights is None:
            count = None if buckets is None else _count(buckets)
            shares: tuple[float, ...] | None = None if count is None else (1 / count,) * count
        else:
            numbers = [checked_weight(weight) for weight in weights]
            if buckets is not None and buckets != len(numbers):
                raise ScenicValueError(
                    f"`VerifaiRange` has {buckets} buckets and {len(numbers)} weights",
                    span=here(),
                    help="give one weight for each bucket, or leave `buckets` out",
                )
            if not any(numbers):
                raise nothing_to_choose(cls.__name__)
            shares = tuple(weight / sum(numbers) for weight in numbers)
        if weights is None:
            choosable = Choosable("VerifaiRange", first, last, None, shares, is_stratified=is_stratified)
            return _make("range", (first, last), None, choosable)
        assert shares is not None
        edges = tuple(first + (last - first) * place / len(shares) for place in range(len(shares) + 1))
        choosable = _possible(
            Choosable("VerifaiRange", first, last, None, shares), tuple(itertools.pairwise(edges))
        )
        return _make("piecewise", (), ((0.0, *cumulative(shares)), edges), choosable)


class VerifaiDiscreteRange(VerifaiParameter):
    """An integer between two fixed ones, both included, uniform, or with a weight for each."""

    def __new__(cls, low: object, high: object, weights: Sequence[float] | None = None) -> Any:
        ends = [_fixed(end, cls.__name__) for end in (low, high)]
        if any(end != int(end) for end in ends) or ends[0] > ends[1]:
            raise ScenicValueError(
                f"`VerifaiDiscreteRange` takes two integers, the lower first, not {low!r} and {high!r}",
                span=here(),
            )
        first, last = int(ends[0]), int(ends[1])
        count = last - first + 1
        numbers = [1.0] * count if weights is None else [checked_weight(weight) for weight in weights]
        if len(numbers) != count:
            raise ScenicValueError(
                f"`VerifaiDiscreteRange` from {first} to {last} needs {count} weights, not {len(numbers)}",
                span=here(),
            )
        if not any(numbers):
            raise nothing_to_choose(cls.__name__)
        shares = tuple(weight / sum(numbers) for weight in numbers)
        values = tuple((float(value), float(value)) for value in range(first, last + 1))
        choosable = _possible(Choosable("VerifaiDiscreteRange", first, last, count, shares), values)
        return _make("weighted integer", (), (first, cumulative(numbers)), choosable)


class VerifaiOptions(VerifaiParameter):
    """One of some options, each equally likely, or with the weights of a dictionary."""

    def __new__(cls, options: Mapping[Any, float] | Iterable[Any]) -> Any:
        if not isinstance(options, list | tuple | Mapping) and (
            is_random(options) or not isinstance(options, Iterable)
        ):
            raise ScenicTypeError(
                f"`VerifaiOptions` takes a dictionary of weights or a fixed collection, not {describe(options)}",
                span=here(),
            )
        if isinstance(options, Mapping):
            pairs = [(option, checked_weight(weight)) for option, weight in options.items()]
        else:
            pairs = [(option, 1.0) for option in options]
        possible = [(option, weight) for option, weight in pairs if weight > 0]
        if not possible:
            raise nothing_to_choose(cls.__name__)
        weights = [weight for _, weight in possible]
        shares = tuple(weight / sum(weights) for weight in weights)
        choosable = Choosable("VerifaiOptions", 0, len(shares) - 1, len(shares), shares)
        index = _make("choice", (), cumulative(weights), choosable)
        return choose_among([option for option, _ in possible], weights, cls.__name__, index=index)


def _possible(chosen: Choosable, cells: tuple[tuple[float, float], ...]) -> Choosable:
    """Return a choice without its cells of weight zero."""
    assert chosen.shares is not None
    indices = [place for place, share in enumerate(chosen.shares) if share > 0]
    if len(indices) == len(cells):
        return chosen
    return replace(
        chosen,
        count=None if chosen.count is None else len(indices),
        shares=tuple(chosen.shares[place] for place in indices),
        cells=tuple(cells[place] for place in indices),
    )


def _fixed(value: object, name: str) -> float:
    if is_random(value) or not is_number(value) or not math.isfinite(value):
        raise ScenicTypeError(
            f"the ends of `{name}` are fixed, finite numbers, not {describe(value)}",
            span=here(),
            help="choose a number between 0 and 1, and compute the value from it",
        )
    return float(value)


def _count(buckets: object) -> int:
    if not isinstance(buckets, int) or buckets < 1:
        raise ScenicValueError(f"the number of buckets is an integer from 1 on, not {buckets!r}", span=here())
    return buckets


def _with_prior(dist: object, buckets: int) -> Any:
    if not isinstance(dist, Random) or not dist.isPrimitive:
        raise ScenicTypeError(
            f"the prior of an external parameter is a primitive distribution, not {describe(dist)}",
            span=here(),
            help="use `Range`, `Normal`, `TruncatedNormal`, `DiscreteRange`, `Uniform` or `Discrete`",
        )
    node = dist.node
    name = node.operation.name
    numbers: list[Any] = (
        [_constant(item) for item in node.operands[1:]] if name not in ("select", "look-up") else []
    )
    match name:
        case "range":
            low, high = numbers
            return VerifaiRange._over(low, high, _count(buckets), is_stratified=True)
        case "normal":
            inner = [place - _count(buckets) / 2 for place in range(1, buckets)]
            return _normal(name, numbers, None, (-math.inf, *inner, math.inf))
        case "truncated normal":
            mean, deviation = numbers
            low, high = ((end - mean) / deviation for end in node.payload)
            edges = (low + (high - low) * place / _count(buckets) for place in range(buckets + 1))
            return _normal(name, numbers, node.payload, tuple(edges))
        case "discrete range":
            low, high = numbers
            return VerifaiDiscreteRange(low, high)
        case "weighted integer":
            first, sums = node.payload
            return VerifaiDiscreteRange(first, first + len(sums) - 1, weights=_differences(sums))
        case "select" | "look-up" if node.operands[0].operation.name == "choice":
            return VerifaiOptions(
                dict(zip(_options(node), _differences(node.operands[0].payload), strict=True))
            )
        case _:
            raise InvalidScenarioError(
                f"a distribution of the kind `{name}` cannot be a prior",
                span=here(),
                help="give buckets and weights",
            )


def _constant(node: Any) -> float:
    if not node.is_constant:
        raise InvalidScenarioError("the parameters of a prior must be fixed", span=here())
    return float(node.payload.column[0])


def _options(node: Any) -> list[Any]:
    if node.operation.name == "look-up":
        return list(node.payload.column.tolist())
    return [
        as_value(option) if not option.is_constant else option.payload.value for option in node.operands[1:]
    ]


def _differences(sums: Sequence[float]) -> list[float]:
    return [last - first for first, last in zip((0.0, *sums), sums, strict=False)]


def _normal(operation: str, law: Sequence[float], window: Any, edges: Sequence[float]) -> Any:
    """Return a parameter with a normal prior; the edges of its buckets are deviations from the mean."""
    mean, deviation = law
    below = [0.5 * math.erfc(-edge / math.sqrt(2)) for edge in edges]
    whole = below[-1] - below[0]
    shares = tuple((last - first) / whole for first, last in itertools.pairwise(below))
    low, high = (-math.inf, math.inf) if window is None else window
    chosen = Choosable("VerifaiRange", low, high, None, shares, normal=(mean, deviation), is_stratified=True)
    return _make(operation, law, window, chosen)


class SeriesValue:
    """The value of a time series in a scene: one value for each step of a simulation."""

    def __init__(self, *values: Any) -> None:
        self._values = values
        self._taken: tuple[int, int] | None = None

    def __len__(self) -> int:
        return len(self._values)

    @property
    def values(self) -> tuple[Any, ...]:
        """The values of all steps."""
        return self._values

    def getSample(self) -> Any:
        """The value of the present step of the running simulation, once in a step."""
        context = current.get()
        run = getattr(context, "run", None)
        if run is None:
            raise InvalidScenarioError(
                "`getSample` is called outside of a simulation",
                help="call it in a behavior, monitor or record",
            )
        now = (id(run), int(run.simulation.currentTime))
        if now == self._taken:
            raise InvalidScenarioError(
                "`getSample` is called twice in one step", help="keep the step's value in a variable"
            )
        if now[1] >= len(self._values):
            raise InvalidScenarioError(
                f"the simulation has more steps than the {len(self._values)} of the parameter `timeBound`",
                help="set `param timeBound` to the number of steps",
            )
        self._taken = now
        return self._values[now[1]]


def TimeSeries(param: Any) -> Any:
    """Return an external parameter that has another value at each step of a simulation: `SeriesValue`.

    The parameter ``timeBound`` of the program is the number of steps.
    """
    context = current.get()
    if choosable_of(param) is None or context is None:
        raise ScenicTypeError(f"`TimeSeries` takes an external parameter, not {describe(param)}", span=here())
    steps = context.parameters.value("timeBound", 0)
    if not isinstance(steps, int) or steps < 1:
        raise InvalidScenarioError(
            "`TimeSeries` needs the parameter `timeBound`, the number of steps",
            span=here(),
            help="write `param timeBound = 100` before it",
        )
    return call_later(SeriesValue, param, *(param.resampled() for _ in range(steps - 1)))
