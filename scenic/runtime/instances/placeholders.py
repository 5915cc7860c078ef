"""Stand-ins for instances where a choice draws them.

Mutation is part of drawing an instance, so that ``Uniform(a, b).position`` is a place after it, while ``a.position`` is the
value that was there when it was read (sections 8.3 and 10.5 of the specification). The noise is known only when the program has
ended: until then a stand-in has nodes to be completed in the place of what may change. Programs that mutate nothing have none.
"""

from types import CodeType
from typing import Any, Final

from scenic.graph.construction import make_node
from scenic.graph.kinds import Column, Kind, boxed
from scenic.graph.node import Graph
from scenic.graph.operation import Call, Operation, always, stacking
from scenic.runtime.ground.context import Context, current, here
from scenic.runtime.instances.mutators import KEPT, active, is_built_in
from scenic.runtime.instances.objects import Point
from scenic.runtime.instances.properties import NORMAL
from scenic.runtime.values.values import CODEC, Random, as_node, as_value

_OF_KNOWN_KINDS: Final = NORMAL.keys() | KEPT
"""Properties that are of the same kind whatever a mutator gives."""

__all__ = ["complete", "may_mutate", "stand_in"]


def may_mutate(code: CodeType) -> bool:
    """Return whether the code of a module contains ``mutate``, or sets a scale of mutation."""
    if "mutate" in code.co_names or "mutationScale" in code.co_names or "mutationScale" in code.co_consts:
        return True
    return any(may_mutate(item) for item in code.co_consts if isinstance(item, CodeType))


def stand_in(instance: object) -> Any:
    """Return an instance with the values of another after mutation; the instance itself where nothing is mutated."""
    context = current.get()
    if context is None or not context.is_symbolic or context.sample is not None:
        return instance
    if not isinstance(instance, Point) or "_source" in instance.__dict__:
        return instance
    pair = context.stand_ins.made.get(id(instance))
    if pair is None:
        pair = context.stand_ins.made[id(instance)] = (instance, _made(instance))
    return pair[1]


def _made(instance: Point) -> Point:
    stored = instance.__dict__
    by_python = not is_built_in(active(instance))
    values = {
        name: _of_any_kind(value) if by_python and name not in _OF_KNOWN_KINDS else _late(value)
        for name, value in stored.items()
        if name in instance.scenic_properties
    }
    return type(instance)._make({**stored, **values})


def _late(value: object) -> Any:
    """Return a value of which only the kind is known so far; the value itself if it is not a number, vector or orientation."""
    if isinstance(value, bool) or value is None or isinstance(value, str | tuple | list | dict):
        return value
    node = as_node(value)
    if node.kind.is_boxed or node.kind is Kind.BOOLEAN:
        return value
    return as_value(make_node(_LATE, [node], node.kind, here()))


def _of_any_kind(value: object) -> Any:
    """Return a value of which nothing is known: a mutator of the program's own may give anything, but leaves places what they are."""
    kind = as_node(value).kind
    if kind not in (Kind.VECTOR, Kind.ORIENTATION):
        kind = Kind.OTHER
    return as_value(make_node(_LATE, [as_node(value)], kind, here()))


def complete(context: Context) -> None:
    """Give all stand-ins the values that instances have now that mutation is over."""
    for instance, copy in context.stand_ins.made.values():
        for name, value in copy.__dict__.items():
            if isinstance(value, Random) and value.node.operation is _LATE:
                new = as_node(instance.__dict__[name])
                if value.node.kind is Kind.OTHER and not new.kind.is_boxed:
                    new = make_node(_BOXED, [new], new.kind, here())
                if new.kind is value.node.kind and value.node not in Graph([new]).index:
                    value.node.complete((new,), value.node.payload)


def _same(_call: Call, column: Column) -> Column:
    return column


_LATE = stacking(
    "drawn instance",
    lambda _operands, payload: payload,
    _same,
    "A property of an instance as a choice draws it, mutated; payload its kind.",
    pure=False,
)

_BOXED = Operation(
    "boxed",
    always(Kind.OTHER),
    lambda call, column: boxed(CODEC.decode(call.payload, column)),
    "A value of a known kind as a Python object; payload its kind.",
)
