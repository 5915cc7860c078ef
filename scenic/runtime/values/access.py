"""Parts of random values: elements, attributes, and what calls of them give."""

import functools
import operator
from collections.abc import Mapping, Sequence
from types import BuiltinFunctionType, MappingProxyType
from typing import Any, Final

import numpy as np

from scenic.graph import construction
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call, Operation, always, by_lane, stacking
from scenic.graph.operations import TABLE
from scenic.language.errors import RejectionException
from scenic.runtime.ground.context import here
from scenic.runtime.values.applying import apply, operate
from scenic.runtime.values.choices import (
    MISSING,
    MOST_OPTIONS,
    REJECTED,
    drawn_option,
    reject_all,
    rejection,
    select,
)
from scenic.runtime.values.class_members import member
from scenic.runtime.values.frozen import is_frozen
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.lane_methods import are_open, node_over_lanes
from scenic.runtime.values.lazy import defer, is_lazy
from scenic.runtime.values.nodes import DICTIONARY, LIST, TUPLE, as_node, as_value, kind_of
from scenic.runtime.values.random_base import RandomBase, is_random, random_value

NOTHING = "there is nothing to choose from"

_ROUNDING: Final = 4e-16
"""Relative error of a product."""

_MOST_CUT: Final = 64
"""Lists, and places between their elements, between which analysis cuts, at most."""


def element_of(index: Node, lists: Sequence[Sequence[Node]], draw: RandomBase) -> Any:
    """The element at the share ``draw`` of the length of one of several lists, which ``index`` draws.

    Samples in which the list is empty are rejected.
    """
    everything = [element for elements in lists for element in elements]
    if everything and all(element.is_constant and is_frozen(element.value) for element in everything):
        # One list after the other, and the place in all of them.
        place = apply(_PLACE_IN_ALL, as_value(index), draw, payload=tuple(map(len, lists)))
        return select(as_node(place), everything)
    results = []
    for elements in lists:
        if elements:
            place = apply(_PLACE, draw, payload=len(elements))
            results.append(as_node(select(as_node(place), elements)))
        else:
            results.append(construction.make_node(_NOTHING, (), span=here()))
    return select(index, results)


def elements_of(node: Node) -> Sequence[Node] | None:
    """The elements of a list or tuple of fixed length, as nodes; ``None`` for anything else."""
    if node.operation in (LIST, TUPLE):
        return node.operands
    if node.is_constant and type(node.value) in (list, tuple):
        return [as_node(item) for item in node.value]
    return None


def element_at(node: Node, index: object) -> Any:
    """Return an element of a choice among containers: the choice among their elements. ``None`` for other operands."""
    if node.operation is not TABLE["select"] or type(index) not in (int, str):
        return None
    draw, *options = node.operands
    if len(options) > MOST_OPTIONS:
        return None
    results = []
    for option in options:
        try:
            if option.operation in (LIST, TUPLE) and type(index) is int:
                results.append(option.operands[index])
            elif option.operation is DICTIONARY and option.payload is not None:
                results.append(option.operands[option.payload[index]])
            elif option.is_constant and type(option.value) in (list, tuple, dict):
                results.append(as_node(option.value[index]))
            else:
                return None
        except LookupError as error:
            results.append(construction.make_node(MISSING, (), error, here()))
    return select(draw, results)


def element(value: RandomBase, index: object) -> Any:
    """Return the element of a random container, or of a choice among containers, at an index."""
    if is_lazy(index):
        return defer(element, value, index)
    if holds_instances(value.node):
        # Instances as they are in the sample; that they are instances is not known before (section 8.1).
        return call_later(operator.getitem, value, index)
    item = element_at(value.node, index)
    if item is None and value.node.operation is TABLE["select"] and is_random(index):
        item = _element_over_lanes(value.node, index)
    return operate("getitem", value, index) if item is None else item


def _element_over_lanes(node: Node, index: object) -> Any:
    """The element of a choice among fields at a random place; ``None`` for other options."""
    draw, *options = node.operands
    if not all(option.is_constant and hasattr(type(option.value), "__getitem__") for option in options):
        return None
    found = node_over_lanes(draw, [as_node(option.value.__getitem__) for option in options], (index,), {})
    return None if found is None else as_value(found)


def sliceable(container: object) -> Any:
    """A container to take a slice of; one that takes random and lazy bounds, if it is a sequence of Python's own."""
    return _Sliceable(container) if isinstance(container, list | tuple | str) else container


class _Sliceable:
    """A sequence of Python's own whose slices may have random or lazy bounds."""

    __slots__ = ("_container",)

    def __init__(self, container: Any) -> None:
        self._container = container

    def __getitem__(self, bounds: slice) -> Any:
        parts = bounds.start, bounds.stop, bounds.step
        if is_random(parts) or is_lazy(bounds):
            return element(random_value(as_node(self._container)), bounds)
        return self._container[bounds]


_PARAMETERS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "range": ("low", "high"),
        "discrete range": ("low", "high"),
        "normal": ("mean", "stdDev"),
        "truncated normal": ("mean", "stdDev"),
    }
)
"""Parameters of primitive distributions that scripts read, in the order of their operands."""


def attribute(value: RandomBase, name: str) -> Any:
    """Return an attribute of a random value. A choice gives the choice among the options' attributes."""
    node = value.node
    names = _PARAMETERS.get(node.operation.name, ())
    if name in names:
        return as_value(node.operands[1 + names.index(name)])
    if node.operation is TABLE["select"]:
        index, *options = node.operands
        rejects = any(option.is_constant and is_frozen(option.value) for option in options)
        return select(index, [_attribute_of_option(option, name, rejects) for option in options])
    if node.kind.is_number and hasattr(0.0 if node.kind is Kind.SCALAR else 0, name):
        return apply(_GETATTR, value, name)
    if node.kind.is_number or node.kind in (Kind.VECTOR, Kind.ORIENTATION):
        raise AttributeError(
            f"a random {node.kind.value} has no attribute {name!r}", name=name, obj=type(value)
        )
    return call_later(getattr, value, name) if holds_instances(node) else apply(_GETATTR, value, name)


def called(value: RandomBase, args: Sequence[object], kwargs: dict[str, Any]) -> Any:
    """The result of calling a random value. A choice among functions calls each with the arguments."""
    node = value.node
    if node.operation is TABLE["select"]:
        index, *options = node.operands
        common_result = _shared(index, options, args, kwargs)
        if common_result is None and _is_called_once(options, args, kwargs):
            return call_later(value, *args, **kwargs)
        results = []
        for option in options:
            if option.operation in (MISSING, REJECTED):
                results.append(option)
            elif common_result is not None:
                results.append(common_result)
            elif option.is_constant and _is_of_runtime(option.value) and not _draws(option.value):
                results.append(_traced(option.value, args, kwargs))
            elif option.is_constant and isinstance(option.value, BuiltinFunctionType):
                results.append(_call_in_lanes(option, args, kwargs))
            else:
                results.append(as_node(call_later(as_value(option), *args, **kwargs)))
        return select(index, results)
    return call_later(value, *args, **kwargs)


def _shared(
    index: Node, options: Sequence[Node], args: Sequence[object], kwargs: dict[str, Any]
) -> Node | None:
    """The call of all options at once where their method can be evaluated in many lanes; ``None`` for other options.

    What depends on the option alone is a table of results instead, unless that would take long to make.
    """
    if any(not option.is_constant and option.operation not in (MISSING, REJECTED) for option in options):
        return None
    if not are_open(args, kwargs) and all(
        not option.is_constant or _is_of_runtime(option.value) for option in options
    ):
        return None
    return node_over_lanes(index, options, args, kwargs)


def _is_called_once(options: Sequence[Node], args: Sequence[object], kwargs: dict[str, Any]) -> bool:
    """Return whether a sample calls the option that it draws alone: a method of objects that never change, of no random argument.

    Other functions have a call for each option, with a source of randomness of its own.
    """
    if not all(
        option.is_constant and is_frozen(getattr(option.value, "__self__", None)) for option in options
    ):
        return False
    first = options[0].value
    if _draws(first):
        return False
    if not _is_of_runtime(first):
        return True
    try:
        first(*args, **kwargs)
    except Exception:  # noqa: BLE001 - whatever the call raises: it needs definite arguments
        return True
    return False


_DRAWING: Final = frozenset({"sample", "uniformPointInner"})
"""Methods of the runtime that draw whenever they are called: of a choice they are called in each sample."""


def _draws(function: object) -> bool:
    return getattr(function, "__name__", None) in _DRAWING


def _is_of_runtime(function: object) -> bool:
    """Return whether a callable is one of the runtime's own, which take random arguments; what programs define does not."""
    defined = getattr(function, "__func__", function)
    module = getattr(defined, "__module__", None) or ""
    return module.startswith("scenic.runtime.")


def _traced(function: Any, args: Sequence[object], kwargs: dict[str, Any]) -> Node:
    """The result of a call; an error of it counts only where this option is drawn, and with the arguments of that sample."""
    try:
        return as_node(function(*args, **kwargs))
    except Exception as error:  # noqa: BLE001 - whatever the call raises
        if are_open(args, kwargs):
            return as_node(call_later(function, *args, **kwargs))
        return construction.make_node(MISSING, (), error, here())


def _call_in_lanes(function: Node, args: Sequence[object], kwargs: dict[str, Any]) -> Node:
    operands = [function, *(as_node(item) for item in (*args, *kwargs.values()))]
    names, positional = tuple(kwargs), len(args)

    def invoke(target: Any, *values: Any) -> Any:
        return target(*values[:positional], **dict(zip(names, values[positional:], strict=True)))

    operation = Operation("call", always(Kind.OTHER), by_lane, "A call of Python's own.", python=invoke)
    return construction.make_node(operation, operands, span=here())


def _attribute_of_option(option: Node, name: str, rejects: bool = False) -> Node:
    """Return an attribute of an option; where that is ``None``, its samples are rejected or at fault."""
    if option.operation in (MISSING, REJECTED):
        return option
    value = drawn_option(option)
    if value is None and rejects:
        return rejection(RejectionException(f"there is nothing here that could have an attribute {name!r}"))
    if kind_of(value) is Kind.OBJECT and _is_computed(type(value), name):  # type: ignore[arg-type] # classes are hashable
        return as_node(call_later(getattr, value, name))
    try:
        return as_node(getattr(value, name))
    except RejectionException as error:
        return rejection(error)
    except AttributeError as error:
        return construction.make_node(MISSING, (), error, here())


@functools.lru_cache(maxsize=1024)
def _is_computed(cls: type, name: str) -> bool:
    """Return whether an attribute is computed by code of the program, which has to see sampled values."""
    found = member(cls, name)
    code = found.fget if isinstance(found, property) else getattr(found, "func", None)
    return isinstance(found, property | functools.cached_property) and not _is_of_runtime(code)


def holds_instances(node: Node) -> bool:
    """Return whether instances of the program are among the constants that a node is made of, or in containers there."""
    stack, nodes = [node], {node}
    while stack:
        below = stack.pop()
        if below.is_constant:
            if below.kind is Kind.OBJECT or (below.kind.is_boxed and _with_instances(below.value)):
                return True
        elif not below.is_drawn and below.operation.pure:  # calls on samples give sampled instances
            new = [operand for operand in below.operands if operand not in nodes]
            nodes.update(new)
            stack.extend(new)
    return False


def _with_instances(value: object) -> bool:
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, tuple | list | set | frozenset):
        return any(_with_instances(item) for item in value)
    return holds_instances(value.node) if isinstance(value, RandomBase) else kind_of(value) is Kind.OBJECT


_NOTHING = Operation(
    "nothing",
    always(Kind.OTHER),
    reject_all,
    "An element of an empty list; a sample that draws it is rejected.",
    pure=False,
    rejects=True,
)


_PLACE = stacking(
    "place in a list",
    always(Kind.INTEGER),
    lambda call, draw: np.minimum((draw * call.payload).astype(np.int64), call.payload - 1),
    "The place of an element that is drawn by a number of the unit interval; payload the length.",
    bounds=lambda count, draw: Bounds(
        np.clip(np.floor(draw.lower * count) - 1, 0, count - 1),
        np.clip(np.floor(draw.upper * count) + 1, 0, count - 1),
    ),
)


def _place_in_all(call: Call, index: Any, draw: object) -> Any:
    counts = np.array(call.payload)
    starts, mine = np.cumsum(counts) - counts, counts[index]
    if (mine == 0).any():
        call.reject(mine == 0)
    # A place that there is, also where the sample is rejected.
    place = starts[index] + np.clip((draw * mine).astype(np.int64), 0, np.maximum(mine - 1, 0))
    return np.minimum(place, counts.sum() - 1)


def _lists_drawn(lengths: tuple[int, ...], index: Bounds) -> tuple[Any, Any, Any, Any, Any]:
    """Lengths and starts of lists, the first and last ones that an index may mean, ``(m,)``, and whether that is one, not empty."""
    counts = np.array(lengths)
    last = len(lengths) - 1
    first = np.clip(index.lower, 0, last).astype(np.int64)
    final = np.clip(index.upper, 0, last).astype(np.int64)
    return counts, np.cumsum(counts) - counts, first, final, (first == final) & (counts[first] > 0)


def _bounds_in_all(lengths: tuple[int, ...], index: Bounds, draw: Bounds) -> Bounds:
    counts, starts, first, final, one = _lists_drawn(lengths, index)
    most = counts.sum() - 1
    lower = np.minimum(starts[first], most)
    upper = np.maximum(lower, starts[final] + counts[final] - 1)
    # Boxes that end at a break between places hold the place before it, up to rounding.
    low = np.floor(draw.lower * counts[first] * (1 + _ROUNDING))
    high = np.ceil(draw.upper * counts[first] * (1 - _ROUNDING)) - 1
    low = np.clip(low, 0, np.maximum(counts[first] - 1, 0))
    # Where all lists that may be drawn are empty, every sample is rejected: there is no place.
    none = starts[final] + counts[final] == starts[first]
    return Bounds(
        np.where(none, np.inf, np.where(one, starts[first] + low, lower)),
        np.where(none, -np.inf, np.where(one, starts[first] + np.clip(high, low, counts[first] - 1), upper)),
    )


def _inverse_in_all(lengths: tuple[int, ...], result: Bounds, index: Bounds, _draw: Bounds) -> list[Bounds]:
    """The lists that hold such places; where there is one, the numbers that draw them."""
    counts, starts, first, _, one = _lists_drawn(lengths, index)
    ends = np.cumsum(counts)
    least = np.searchsorted(ends, np.ceil(result.lower), side="right")
    most = np.searchsorted(starts, np.floor(result.upper), side="right") - 1
    low = np.where(one, (result.lower - starts[first]) / np.maximum(counts[first], 1), -np.inf)
    high = np.where(one, (result.upper + 1 - starts[first]) / np.maximum(counts[first], 1), np.inf)
    slack = 1e-12
    return [Bounds(least.astype(np.float64), most.astype(np.float64)), Bounds(low - slack, high + slack)]


def _cuts_in_all(lengths: tuple[int, ...], operands: Sequence[Any]) -> Any:
    if not operands[1].is_axis or len(lengths) > _MOST_CUT:
        return None
    places = {part / count for count in set(lengths) for part in range(1, count)}
    return np.array(sorted(places)) if len(places) <= _MOST_CUT else None


_PLACE_IN_ALL = Operation(
    "place in lists",
    always(Kind.INTEGER),
    _place_in_all,
    "The place, among the elements of several lists one after the other, of that which a number of the unit interval draws from "
    "the list of an index. Payload the lengths; an empty list rejects the sample.",
    bounds=_bounds_in_all,
    inverse=_inverse_in_all,
    cuts=_cuts_in_all,
    rejects=lambda _operands, lengths: 0 in lengths,
)


_GETATTR = Operation(
    "attribute", always(Kind.OTHER), by_lane, "An attribute of a random value.", python=getattr
)
