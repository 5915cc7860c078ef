"""Python code that is called on samples: never traced, lane by lane.

What such code does cannot be known before it runs. So it gets concrete values, and finds the names of the program at
concrete values too; analysis sees nothing of it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import BuiltinFunctionType, FunctionType, MappingProxyType
from typing import Any

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph.bounding import of_constant
from scenic.graph.bounds import Bounds
from scenic.graph.construction import make_node
from scenic.graph.kinds import Column, Kind, boxed
from scenic.graph.node import Graph, Node, key
from scenic.graph.operation import OK, Call, Operation, always
from scenic.language.errors import InvalidScenarioError, RejectionException
from scenic.runtime.ground.context import Context, current, here, next_address
from scenic.runtime.python.bounded import bounds_of_call
from scenic.runtime.python.random_state import is_as, preserved, seed_globals
from scenic.runtime.python.samples import Globals, Reach, Sample, dependencies, mention, nodes_of, reachable
from scenic.runtime.values import generic
from scenic.runtime.values.instance_base import Instance
from scenic.runtime.values.values import CODEC, Random, as_value


class _Habit:
    """A record of whether some code has drawn from the global generators so far.

    It changes speed, never a result.
    """

    __slots__ = ("draws",)

    def __init__(self) -> None:
        self.draws = False


@dataclass(frozen=True, slots=True)
class OpaqueCode(Reach):
    """A function with its arguments, the nodes behind both, and where it runs.

    ``names`` are the global names that functions in reach read, as they were when this was made. ``looks`` says that they may
    ask what is seen, which depends on all objects.
    """

    function: Callable[..., Any]
    args: tuple[Any, ...]
    keywords: Mapping[str, Any]
    operands: tuple[Node, ...]
    names: Globals
    context: Context | None
    looks: bool
    habit: _Habit


def later(
    operation: Operation,
    function: Callable[..., Any],
    args: Sequence[object],
    keywords: Mapping[str, object] = MappingProxyType({}),
    *,
    names: Globals | None = None,
) -> Node:
    """The node of a call that is made on each sample; ``operation`` is one made with `evaluated`.

    ``names`` are global names as functions in reach shall see them; as they are now by default.
    """
    global_names = Globals() if names is None else names
    key_of_call = key(here(), next_address())
    context = current.get()
    reads: list[Any] = [function, *args, *keywords.values()]
    reachable_values = list(reachable(reads, global_names))
    looks = context is not None and mention(reachable_values, *_OBJECT_READERS)
    if context is not None and looks:
        context.record.looks = True
        reachable_values = list(reachable([*reads, *context.objects], global_names))
    operands = (key_of_call, *nodes_of(reachable_values))
    habit = _Habit()
    habit.draws = mention(reachable_values, *_STATE_READERS)
    instances = tuple(value for value in reachable_values if isinstance(value, Instance))
    code = OpaqueCode(
        instances, function, tuple(args), keywords, operands, global_names, context, looks, habit
    )
    node = make_node(operation, operands, code, here())
    if instances and context is not None and context.is_symbolic:
        context.record.calls.append((node, instances))
    return node


def see_mutated(context: Context) -> None:
    """Let calls that were made before see instances as they come out in the end, mutated.

    What a call sees of an instance is looked up when it is made on a sample; so the nodes of what has been
    mutated since have to be among its operands; but not what the call itself decides.
    """
    for node, instances in context.record.calls:
        new = [item for item in dependencies(instances) if item not in node.operands]
        if new and node in Graph(new).index:
            new = [item for item in new if node not in Graph([item]).index]
        if new:
            operands = (*node.operands, *new)
            node.complete(operands, replace(node.payload, operands=operands))


def call_later(function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Any:
    """The random value of a call that is made on each sample."""
    return as_value(later(CALL, function, args, keywords))


Rows = Sequence[tuple[Any, ...]]
"""Arguments by lane."""

_OBJECT_READERS = ("can see", "present_objects")
"""Names of what looks at all objects of a scene."""

_STATE_READERS = ("getstate", "get_state")
"""Names of the functions that read the state of a generator without drawing."""

generic.call_later.register(object, call_later)


def is_later(*values: Any) -> bool:
    """Return whether a call with these values has to wait for samples: something random is in their reach."""
    context = current.get()
    if context is not None and (context.sample is not None or not context.is_symbolic):
        return False
    return any(isinstance(value, Random) for value in reachable(values, Globals()))


def evaluated(call: Call, columns: Sequence[Column], absent: Any = None) -> list[Any]:
    """The results of the calls, ``absent`` in lanes where there is none.

    A call that raises `RejectionException` rejects its lane, any other exception is that lane's fault. Python's and
    NumPy's global generators are seeded for each call by its key, the first column, and are afterwards as they were before.
    """
    results: list[Any] = Calls(call, columns).made(lambda calls: calls.results(absent))
    return results


def together(
    call: Call, columns: Sequence[Column], compute: Callable[["Calls", Rows], Column]
) -> Column | None:
    """The result of ``compute`` from the arguments of the code by lane; it may make calls of its own, in many lanes at once.

    ``None`` where the code draws random numbers, or is not the same in every lane: then only one lane after the other will do.
    """
    calls = Calls(call, columns)
    plain = calls.plain()
    if plain is None or calls.code.habit.draws:
        return None
    column: Column | None = calls.made(lambda calls: compute(calls, plain[1]), again=False)
    return column


class Calls:
    """The calls of one evaluation.

    Attributes:
        present: the lanes in which all operands are fine.
        failed, rejected: masks ``(n,)`` of the lanes in which a call has raised an exception.

    """

    def __init__(self, call: Call, columns: Sequence[Column]) -> None:
        self.code: OpaqueCode = call.payload
        self.call = call
        self.lanes = _Lanes(
            {
                node: CODEC.decode(node.kind, column)
                for node, column in zip(self.code.operands, columns, strict=True)
            }
        )
        self.failed, self.rejected, absent = (np.zeros(call.lanes, dtype=np.bool_) for _ in range(3))
        for status in call.operands:
            if status is not None:
                absent |= status != OK
        self.present: list[int] = np.flatnonzero(~absent).tolist()
        self.error: Exception | None = None
        self.seeding = False

    def made(self, compute: Callable[["Calls"], Any], *, again: bool = True) -> Any:
        """The result of ``compute``, where code of the program may run.

        Setting the generators takes longer than most calls, and most draw nothing: then their states are afterwards as they
        were. Otherwise all calls are made ``again``, each with its own seed, now and later.
        """
        code, context = self.code, self.code.context
        sample_before = None if context is None else context.sample
        was_evaluating = context is not None and context.evaluating
        token = current.set(context)
        try:
            if context is not None:
                context.evaluating = True
            with preserved() as before:
                self.seeding = code.habit.draws
                result = compute(self)
                if not self.seeding and not is_as(before):
                    code.habit.draws = self.seeding = True
                    self.failed[:] = self.rejected[:] = False
                    self.error = None
                    if not again:
                        return None
                    result = compute(self)
        finally:
            if context is not None:
                context.evaluating = was_evaluating
                context.sample = sample_before
            current.reset(token)
        if self.error is not None:
            self.call.fault(self.failed, self.error)
        self.call.reject(self.rejected)
        return result

    def results(self, absent: Any = None) -> list[Any]:
        """The result of each call, ``absent`` in lanes where there is none."""
        results: list[Any] = [absent] * self.call.lanes
        code, context = self.code, self.code.context
        plain = None if self.seeding else self.plain()
        if plain is not None:
            function, rows = plain
            self.each(function, self.present, [rows[lane] for lane in self.present], results)
            return results
        seeds = self.lanes.values[code.operands[0]]
        same = [self._is_same(item) for item in code.args]
        always_function = self._is_same(code.function)
        for lane in self.present:
            sample = Sample(self.lanes, lane, code.names, of_call=True)
            if context is not None:
                context.sample = sample
            if self.seeding:
                seed_globals(seeds[lane])
            try:
                args = [
                    item if is_same else sample.value(item)
                    for item, is_same in zip(code.args, same, strict=True)
                ]
                keywords = {name: sample.value(item) for name, item in code.keywords.items()}
                function = code.function if always_function else sample.value(code.function)
                results[lane] = function(*args, **keywords)
            except (Exception, SystemExit) as problem:  # noqa: BLE001 - whatever the program raises is that lane's fault
                self.mark(lane, problem)
        return results

    def plain(self) -> tuple[Callable[..., Any], Rows] | None:
        """Return the function, and its arguments by lane, where these are columns and what is the same in every sample."""
        code = self.code
        if code.keywords or code.looks or not self._is_same(code.function):
            return None
        columns = []
        for item in code.args:
            if isinstance(item, Random) and not item.node.kind.is_boxed:
                values = [item.node.value] if item.node.is_constant else self.lanes.values[item.node]
                columns.append(values * self.call.lanes if len(values) == 1 else values)
            elif self._is_same(item):
                columns.append([item] * self.call.lanes)
            else:
                return None
        if code.context is not None:
            code.context.sample = Sample(self.lanes, 0, code.names)  # says that samples are being made
        return code.function, list(zip(*columns, strict=True)) if columns else [()] * self.call.lanes

    def _is_same(self, item: Any) -> bool:
        """Return whether something is the same object in every sample."""
        if item is None or isinstance(item, int | float | str):
            return True
        if isinstance(item, tuple):
            return all(map(self._is_same, item))
        return isinstance(item, BuiltinFunctionType) or (
            isinstance(item, FunctionType) and self.code.names.is_fixed(item)
        )

    def each(
        self, function: Callable[..., Any], lanes: Sequence[int], rows: Rows, results: list[Any]
    ) -> None:
        """Call a function in some lanes, with a row of arguments for each."""
        for lane, row in zip(lanes, rows, strict=True):
            try:
                results[lane] = function(*row)
            except (Exception, SystemExit) as problem:  # noqa: BLE001 - whatever the program raises is that lane's fault
                self.mark(lane, problem)

    def mark(self, lane: int, problem: BaseException) -> None:
        """Note what went wrong in a lane."""
        if isinstance(problem, RejectionException):
            self.rejected[lane] = True
            return
        self.failed[lane] = True
        if self.error is None:
            self.error = _ended(problem) if isinstance(problem, SystemExit) else problem  # type: ignore[assignment]


def _ended(end: SystemExit) -> InvalidScenarioError:
    return InvalidScenarioError(
        f"the program ended itself (`sys.exit`, with {end.code!r}) while a candidate was evaluated",
        help="raise `RejectionException` to reject a candidate, or an exception that says what is wrong",
    )


class _Lanes:
    """The values of the operands, by node."""

    __slots__ = ("values",)

    def __init__(self, values: Mapping[Node, list[Any]]) -> None:
        self.values = values

    def read(self, lane: int, node: Node) -> Any:
        """Return the value of a node in one lane."""
        found = self.values.get(node)
        if found is None:
            raise InvalidScenarioError(
                "a call that decides how an object is mutated reads what comes out of that",
                help="give the call the values that it needs, instead of the object",
            )
        return found[lane if len(found) > 1 else 0]

    def tuples(self, nodes: tuple[Node, ...]) -> list[tuple[Any, ...]]:
        """Return the values of several nodes lane by lane."""
        count = max(len(self.values[node]) for node in nodes)
        return [tuple(self.read(lane, node) for node in nodes) for lane in range(count)]


def _told_bounds(code: OpaqueCode, *operands: Bounds | None) -> Bounds | None:
    """Return the bounds that the program declares for the results of some code (`scenic.bounded`), or ``None``."""
    if code.keywords:
        return None
    bounds_by_node = dict(zip(code.operands, operands, strict=False))

    def bounds_of(item: Any) -> Bounds | None:
        if isinstance(item, Random):
            return of_constant(item.node) if item.node.is_constant else bounds_by_node.get(item.node)
        return Bounds.exactly(float(item)) if isinstance(item, int | float) else None

    return bounds_of_call(code.function, code.args, bounds_of)


CALL = Operation(
    "opaque call",
    always(Kind.OTHER),
    lambda call, *columns: boxed(evaluated(call, columns)),
    "A call of Python code with sampled arguments; the first operand is its key.",
    bounds=_told_bounds,
    partial=True,
    pure=False,
    calls_code=True,
    faults=True,
    rejects=True,
)
