"""Choices, option by option: a function of a choice is the choice among its results."""

import operator
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from scenic.graph import construction
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call, Operation, always
from scenic.graph.operations import TABLE
from scenic.language.errors import RejectionException
from scenic.runtime.ground.context import current, here
from scenic.runtime.values.frozen import is_frozen
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.nodes import CONTAINERS_MADE, as_node, as_value, kind_of
from scenic.runtime.values.ownership import is_own_function
from scenic.runtime.values.random_base import RandomBase
from scenic.runtime.values.rows import EXACT

MOST_OPTIONS = 4096
"""Options of a choice for each of which a call is made at once, at most."""


def over_options(operands: Sequence[Node], function: Callable[..., Any]) -> Any:
    """The result of a function that depends on nothing but its operands, where these are constants and choices by one draw.

    It is the choice among the results, so that no sample needs a call: what the options give is computed here. An option for
    which the function fails does so only in samples that draw it. ``None`` for other operands, and for choices among instances.
    """
    choices = [node for node in operands if not node.is_constant]
    if not choices or not all(_is_choice_of_data(node) for node in choices):
        return None
    index, count = choices[0].operands[0], len(choices[0].operands) - 1
    if count > MOST_OPTIONS or any(node.operands[0] is not index for node in choices):
        return None
    results: list[Node] = []
    for place in range(1, count + 1):
        values = [(node if node.is_constant else node.operands[place]).value for node in operands]
        try:
            results.append(as_node(function(*values)))
        except RejectionException as error:
            results.append(rejection(error))
        except Exception as error:  # noqa: BLE001 - whatever it raises is an error where this option is drawn
            results.append(construction.make_node(MISSING, (), error, here()))
    return select(index, results)


def _is_choice_of_data(node: Node) -> bool:
    """Return whether a node is a choice among constants that are data of Python, in which nothing is random."""
    if node.operation is not TABLE["select"]:
        return False
    return all(option.is_constant and _is_data(option.value) for option in node.operands[1:])


def is_choice_of_frozen(node: Node) -> bool:
    """Return whether a node is an object that never changes, a text or ``None``, or a choice among such constants."""
    options = node.operands[1:] if node.operation is TABLE["select"] else (node,)
    return all(
        each.is_constant and (each.value is None or type(each.value) is str or is_frozen(each.value))
        for each in options
    )


def _identical(_call: Call, left: Any, right: Any) -> Any:
    return np.frompyfunc(operator.is_, 2, 1)(left, right).astype(np.bool_)


def _by_number(operands: Sequence[Node], _payload: object) -> Node | None:
    """Between choices among constants it is a comparison of numbers, of which bounds are known."""
    options = [node.operands[1:] if node.operation is TABLE["select"] else (node,) for node in operands]
    if not all(option.is_constant and option.kind.is_boxed for each in options for option in each):
        return None
    number_of: dict[int, int] = {}
    for each in options:
        for option in each:
            number_of.setdefault(id(option.value), len(number_of))
    numbers = []
    for node, each in zip(operands, options, strict=True):
        numbers_of_options = [number_of[id(option.value)] for option in each]
        if node.is_constant:
            numbers.append(as_node(numbers_of_options[0]))
        elif numbers_of_options == list(range(len(numbers_of_options))):
            numbers.append(node.operands[0])
        else:
            number_nodes = [as_node(number) for number in numbers_of_options]
            numbers.append(construction.make_node(TABLE["select"], [node.operands[0], *number_nodes]))
    return construction.make_node(TABLE["equal"], numbers)


IDENTITY = Operation(
    "is",
    always(Kind.BOOLEAN),
    _identical,
    "Whether two Python objects are one and the same.",
    rewrite=_by_number,
)


def _is_data(value: Any) -> bool:
    cls = type(value)
    if cls in (list, tuple, set, frozenset):
        return all(map(_is_data, value))
    if cls is dict:
        return all(_is_data(key) and _is_data(item) for key, item in value.items())
    if value is None or cls in (int, float, bool, str, bytes, slice) or cls in EXACT:
        return True
    return is_frozen(value)


def is_answered_by_code(value: Any, methods: Sequence[str]) -> bool:
    """Return whether methods of the program's classes answer for a value: they have to be asked of the sampled one."""
    if not isinstance(value, RandomBase):
        return _has_own(value, methods)
    stack, nodes = [value.node], {value.node}
    while stack:
        node = stack.pop()
        if node.is_constant:
            if node.kind.is_boxed and _has_own(node.value, methods):
                return True
        elif node.kind.is_boxed and (not node.operation.strict or node.operation in CONTAINERS_MADE):
            # What these hand on; anything else is computed, and where instances answer for it, of sampled ones.
            new = [operand for operand in node.operands if operand not in nodes]
            nodes.update(new)
            stack.extend(new)
    return False


def _has_own(value: Any, methods: Sequence[str]) -> bool:
    return any(is_own_function(getattr(type(value), name, None)) for name in methods)


def select(index: Node, options: Sequence[Node]) -> Any:
    """Return the choice among options by an index; of those that reject samples only constants are left."""
    rejecting = [option.operation is REJECTED for option in options]
    if (
        any(rejecting)
        and not all(rejecting)
        and all(node.is_constant or node.operation is REJECTED for node in options)
    ):
        index = construction.make_node(_ADMITTED, [index], tuple(rejecting), here())
        other = options[rejecting.index(False)]
        options = [other if rejects else node for node, rejects in zip(options, rejecting, strict=True)]
    return as_value(construction.make_node(TABLE["select"], [index, *options], span=here()))


def _missing(call: Call) -> Any:
    call.fault(np.ones(1, dtype=np.bool_), call.payload)
    return np.empty(1, dtype=object)


MISSING = Operation(
    "missing attribute",
    always(Kind.OTHER),
    _missing,
    "An attribute that an option of a choice does not have; an error only where that option is drawn.",
    pure=False,
    faults=True,
)


def rejection(error: RejectionException) -> Node:
    """Return a value that rejects the samples which draw it, for an option."""
    return construction.make_node(REJECTED, (), str(error), here())


def reject_all(call: Call) -> Any:
    """Reject the lanes of a call; returns a column without a value."""
    call.reject(np.ones(1, dtype=np.bool_))
    return np.empty(1, dtype=object)


REJECTED = Operation(
    "rejected option",
    always(Kind.OTHER),
    reject_all,
    "What an option of a choice refuses to give; a sample that draws it is rejected. The payload says why.",
    pure=False,
    rejects=True,
)


def _admitted(call: Call, index: Any) -> Any:
    rejects = np.array(call.payload)[index]
    if rejects.any():
        call.reject(rejects)
    return index


def _admitted_bounds(rejects: tuple[bool, ...], index: Bounds) -> Bounds:
    """From the first admitted option to the last one; nothing where none of them is admitted."""
    last = len(rejects) - 1
    admitted = np.flatnonzero(~np.array(rejects))
    first = np.searchsorted(admitted, np.clip(np.ceil(index.lower), 0, last))
    final = np.searchsorted(admitted, np.clip(np.floor(index.upper), 0, last), side="right") - 1
    some = first <= final
    lower = admitted[np.minimum(first, len(admitted) - 1)]
    return Bounds(np.where(some, lower, np.inf), np.where(some, admitted[np.maximum(final, 0)], -np.inf))


_ADMITTED = Operation(
    "admitted option",
    always(Kind.INTEGER),
    _admitted,
    "An index that rejects samples in which it draws an option which refuses what is asked of it; payload which ones do.",
    bounds=_admitted_bounds,
    inverse=lambda _payload, result, _index: [result],
    rejects=True,
)


def drawn_option(option: Node) -> Any:
    """Return the value of an option of a choice, as the choice draws it: an instance after mutation."""
    value = as_value(option)
    context = current.get()
    return value if context is None or kind_of(value) is not Kind.OBJECT else context.stand_ins.make(value)


def options_of(value: Any) -> tuple[Any, ...]:
    """Return the options of a random choice; none of any other value."""
    if isinstance(value, RandomBase) and value.node.operation is TABLE["select"]:
        return tuple(as_value(option) for option in value.node.operands[1:])
    return ()


def is_open(value: Any) -> bool:
    """Return whether a random value, or some option of it, can be of any type until it is drawn (section 4.3)."""
    if not isinstance(value, RandomBase) or not value.node.kind.is_boxed:
        return False
    options = options_of(value)
    return not options or any(map(is_open, options))


def per_option(value: Any, function: Callable[[Any], Any]) -> Any:
    """Apply ``function`` to a value.

    A random choice becomes the choice among the results for its options. Options that are choices themselves are treated in the
    same way.
    """
    if isinstance(value, RandomBase) and value.node.operation is TABLE["select"]:
        index, *options = value.node.operands
        return select(index, [as_node(per_option(drawn_option(option), function)) for option in options])
    return function(value)


def as_drawn(function: Callable[[Any, Any], Any], first: Any, second: Any) -> Any:
    """Return ``function(first, second)`` where the second value decides what is done, and may be random.

    The function is called with each option of a choice. Where only the draw shows what the second value is, it is called with the
    drawn value.
    """
    if not isinstance(second, RandomBase) or not second.node.kind.is_boxed:
        return function(first, second)
    if is_open(second):
        return call_later(function, first, second)
    return per_option(second, partial(function, first))
