"""Evaluation of nodes over many lanes at a time.

A lane is one point of the cube. What nodes hold in a lane depends on that lane alone: not on the others, and not on which
nodes are evaluated together (`scenic.graph.schedule`).
"""

import time
from collections.abc import Callable, Iterable, Sequence
from itertools import repeat
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.graph.domain import Domain
from scenic.graph.draws import NumberSource
from scenic.graph.kinds import Codec, Column, boxed
from scenic.graph.node import Graph, Node
from scenic.graph.operation import FAULT, OK, Call, Status
from scenic.graph.schedule import (
    AnyStep,
    ChosenDraw,
    ColumnPlace,
    ColumnRun,
    DrawStep,
    Fixed,
    Gather,
    Gathered,
    Schedule,
    Scheduler,
    Slot,
    Step,
)


class _Group:
    """The columns of a group's members: ``column`` of shape (members, lanes or 1, ...), ``status`` of the same shape."""

    __slots__ = ("column", "generation", "status")

    def __init__(self, column: Column, status: Status | None, generation: int) -> None:
        self.column = column
        self.status = status
        self.generation = generation


class Batch:
    """The lanes of one run, and the columns computed for them so far.

    ``keep`` drops lanes; columns are narrowed only when they are used again, so that a test that leaves few lanes
    does not pay for every node. Values in lanes whose status is not `OK` are meaningless.

    Args:
        scheduler: the graph, and in which groups its nodes are evaluated.
        source: the random numbers of the lanes.
        codec: the Python side of values.
        domain: the part of the cube to draw from; the whole of it by default.
        rejections: exceptions by which the program's own functions reject a sample.
        meter: is told what each step took: the step, the number of lanes, seconds.

    """

    def __init__(
        self,
        scheduler: Scheduler,
        source: NumberSource,
        codec: Codec,
        *,
        domain: Domain | None = None,
        rejections: tuple[type[Exception], ...] = (),
        meter: Callable[[AnyStep, int, float], None] | None = None,
    ) -> None:
        self._scheduler = scheduler
        self._source = source
        self._codec = codec
        self._domain = None if domain is None or domain.is_whole else domain
        self._rejections = rejections
        self._meter = meter
        self.rows: NDArray[np.intp] = np.arange(len(source))
        """The numbers of the present lanes among the first ones, ascending."""
        self.errors: dict[Node, Exception] = {}
        """The error at a node; exact only in a batch of one lane whose nodes are evaluated singly."""
        self.has_faults = False
        """True if an operation has failed in some lane."""
        self._generation = 0
        self._kept: list[NDArray[np.intp]] = []
        self._schedule: Schedule = scheduler.start
        self._is_settled = False
        self._groups: dict[Slot, _Group] = {}
        self._boxes: NDArray[np.intp] | None = None
        self._values: dict[Node, list[Any]] = {}
        self._tuples: dict[int, tuple[tuple[Node, ...], list[tuple[Any, ...]]]] = {}

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def graph(self) -> Graph:
        """The graph that is evaluated."""
        return self._scheduler.graph

    @property
    def source(self) -> NumberSource:
        """The random numbers of its lanes."""
        return self._source

    # Lanes

    def keep(self, lanes: NDArray[Any]) -> None:
        """Go on with these lanes only: a mask ``(n,)`` or ascending indices."""
        indices = np.flatnonzero(lanes) if lanes.dtype == np.bool_ else lanes
        if len(indices) == len(self.rows):
            return
        self.rows = self.rows[indices]
        self._source = self._source.take(indices)
        if self._boxes is not None:
            self._boxes = self._boxes[:, indices]
        self._kept.append(indices)
        self._generation += 1
        self._values.clear()
        self._tuples.clear()

    def settle(self, nodes: Sequence[Node]) -> None:
        """Evaluate ``nodes`` and drop all other columns: the batch is finished but for being read."""
        self.need(nodes)
        wanted = {self._schedule.places[node].slot for node in nodes if not node.is_constant}
        self._groups = {slot: self._group(slot) for slot in sorted(wanted)}
        self._is_settled = True
        self._kept = []
        self._generation = 0
        for group in self._groups.values():
            group.generation = 0

    # Columns

    def need(self, nodes: Iterable[Node]) -> None:
        """Evaluate ``nodes`` together; what is there already is not evaluated again."""
        roots = tuple(nodes)
        if self._schedule.unused or self._is_settled:
            # Columns may be gone. What a chain does not foresee is evaluated from the start: nobody asks for it in every batch.
            if all(node.is_constant or self._is_there(node) for node in roots):
                return
            self._groups.clear()
            self._schedule = self._scheduler.start
            self._is_settled = False
        self._do(self._scheduler.after(self._schedule, roots))

    def follow(self, schedule: Schedule, nodes: Sequence[Node]) -> None:
        """Evaluate ``nodes`` by the next schedule of a chain (`Scheduler.chain`), which frees what nobody needs any more."""
        if self._schedule.places is schedule.places or not self._groups:
            self._do(schedule)
        else:
            self.need(nodes)

    def _do(self, schedule: Schedule) -> None:
        self._schedule = schedule
        groups = self._groups
        drops = iter(schedule.unused)
        for slot in next(drops, ()):
            del groups[slot]
        if schedule.steps:
            with np.errstate(all="ignore"):
                for step in schedule.steps:
                    start_time = 0.0 if self._meter is None else time.thread_time()
                    if isinstance(step, DrawStep):
                        group = self._draw(step)
                    elif isinstance(step, ChosenDraw):
                        group = self._draw_chosen(step)
                    else:
                        group = self._evaluate(step)
                    groups[step.slot] = group
                    if self._meter is not None:
                        self._meter(step, len(self.rows), time.thread_time() - start_time)
                    for slot in next(drops, ()):
                        del groups[slot]

    def _is_there(self, node: Node) -> bool:
        place = self._schedule.places.get(node)
        return place is not None and place.slot in self._groups

    def column(self, node: Node) -> Column:
        """Return the values of ``node``; the leading dimension is ``len(self)``, or 1 where all lanes have the same value."""
        if node.is_constant:
            column: Column = node.payload.column
            return column
        place = self._place(node)
        found: Column = self._group(place.slot).column[place.member]
        return found

    def status(self, node: Node) -> Status | None:
        """Return the status of each lane at ``node``, ``None`` when all are `OK`."""
        if node.is_constant:
            return None
        place = self._place(node)
        status = self._group(place.slot).status
        if status is None:
            return None
        mine = status[place.member]
        return mine if mine.any() else None

    def full(self, node: Node) -> Column:
        """Return the values of ``node`` as `column` does, but always with the leading dimension ``len(self)``."""
        column = self.column(node)
        if len(column) == len(self.rows):
            return column
        return np.broadcast_to(column, (len(self.rows), *column.shape[1:]))

    def stack(self, nodes: Sequence[Node]) -> Column:
        """Return the values of nodes of one kind, of shape (nodes or 1, lanes or 1, ...); a dimension is 1 where all values along it are the same."""
        self.need(nodes)
        gather = self._scheduler.gather(self._schedule, tuple(nodes))
        return self._operand(gather)[0]

    def value(self, node: Node, lane: int = 0) -> Any:
        """Return the Python value of ``node`` in one lane; the same object on every call."""
        return self.read(lane, node)

    def read(self, lane: int, node: Node) -> Any:
        """Return the value of ``node`` in one lane; the order of the arguments is that of samples."""
        values = self._values_of(node)
        return values[lane if len(values) > 1 else 0]

    def tuples(self, nodes: tuple[Node, ...]) -> list[tuple[Any, ...]]:
        """Return the values of several nodes lane by lane, the objects that `read` gives; one row where all lanes agree."""
        entry = self._tuples.get(id(nodes))
        if entry is None:
            columns = self.lists(nodes)
            count = max(map(len, columns))
            rows = list(
                zip(
                    *(column if len(column) == count else repeat(column[0], count) for column in columns),
                    strict=True,
                )
            )
            entry = self._tuples[id(nodes)] = (nodes, rows)
        return entry[1]

    def lists(self, nodes: Sequence[Node]) -> list[list[Any]]:
        """Return the values of several nodes, lane by lane, the objects that `read` gives; one where all lanes agree."""
        return [[node.value] if node.is_constant else self._values_of(node) for node in nodes]

    def _values_of(self, node: Node) -> list[Any]:
        values = self._values.get(node)
        if values is None:
            values = self._values[node] = self._codec.decode(node.kind, self.column(node))
        return values

    def _place(self, node: Node) -> ColumnPlace:
        if not self._is_there(node):
            self.need((node,))
        return self._schedule.places[node]

    def _group(self, slot: Slot) -> _Group:
        group = self._groups[slot]
        if group.generation == self._generation:
            return group
        lanes = self._since(group.generation)
        if group.column.shape[1] > 1:
            group.column = _lanes(group.column, lanes)
        if group.status is not None:
            group.status = group.status[:, lanes]
            if not group.status.any():
                group.status = None
        group.generation = self._generation
        return group

    def _since(self, generation: int) -> NDArray[np.intp]:
        """Return the numbers, in an older generation, of the lanes that are still in the batch."""
        lanes = self._kept[-1]
        for chosen in reversed(self._kept[generation:-1]):
            lanes = chosen[lanes]
        return lanes

    # Steps

    def _draw(self, step: DrawStep) -> _Group:
        if step.axes is None:
            return _Group(self._source.words(step.addresses), None, self._generation)
        numbers = self._source.uniforms(step.addresses)
        if self._domain is not None:
            numbers = self._domain.place(numbers, step.axes, self._boxes_of(self._domain))
        return _Group(numbers, None, self._generation)

    def _draw_chosen(self, step: ChosenDraw) -> _Group:
        columns, status = self._operand(step.index)
        index = np.broadcast_to(columns[0], (len(self.rows),))
        if status is not None:
            index = np.where(status[0] == OK, index, 0)
        numbers = self._source.uniform_each(step.addresses[index])
        if self._domain is not None:
            numbers = self._domain.place_each(numbers, step.axes[index], self._boxes_of(self._domain))
        return _Group(numbers[np.newaxis], status, self._generation)

    def _boxes_of(self, domain: Domain) -> NDArray[np.intp]:
        """The numbers of the boxes and cells that each lane is drawn from (`Domain.choose`)."""
        if self._boxes is None:
            self._boxes = domain.choose(self._source.uniforms(np.concatenate(domain.addresses())))
        return self._boxes

    def _evaluate(self, step: Step) -> _Group:
        columns: list[Column] = []
        statuses: list[Status | None] = []
        for gather in step.operands:
            column, status = self._operand(gather)
            columns.append(column)
            statuses.append(status)
        lanes = len(self.rows)
        if not step.stacked:
            columns = [column[0] for column in columns]
            statuses = [None if status is None else status[0] for status in statuses]
        shape = (len(step.nodes), lanes) if step.stacked else (lanes,)
        call = Call(shape, step.payload, statuses, kinds=step.kinds, kind=step.kind, codec=self._codec)
        if step.is_python:
            column = self._by_lane(step, columns, call)
        else:
            column = step.operation.batch(call, *columns)
        status = call.status
        if status is not None and not step.may_mark:
            raise AssertionError(
                f"{step.operation.name} failed or rejected a lane, which it does not declare"
            )
        if step.operation.strict:
            for operand_status in statuses:
                if operand_status is not None:
                    status = operand_status if status is None else np.maximum(status, operand_status)
        if not step.stacked:
            column = column[np.newaxis]
            status = None if status is None else status[np.newaxis]
        elif len(column) < len(step.nodes):
            column = np.broadcast_to(column, (len(step.nodes), *column.shape[1:]))
        if status is not None:
            if status.shape != (len(step.nodes), lanes):
                status = np.broadcast_to(status, (len(step.nodes), lanes))
            self.has_faults = self.has_faults or bool((status == FAULT).any())
            if lanes == 1 and len(step.nodes) == 1 and status[0, 0] == FAULT:
                error = self._error(step, call)
                if error is not None:
                    self.errors[step.nodes[0]] = error
        return _Group(column, status, self._generation)

    def _operand(self, gather: Gather) -> tuple[Column, Status | None]:
        """Return the columns of an operand over the members, and their statuses."""
        if isinstance(gather, Fixed):
            return gather.column, None
        if isinstance(gather, ColumnRun):
            group = self._group(gather.slot)
            status = group.status
            return group.column[gather.members], None if status is None else status[gather.members]
        return self._gathered(gather)

    def _gathered(self, gather: Gathered) -> tuple[Column, Status | None]:
        columns: list[Column] = []
        statuses: list[Status | None] = []
        for part in gather.parts:
            if isinstance(part, ColumnPlace):
                group = self._group(part.slot)
                columns.append(group.column[part.member])
                statuses.append(None if group.status is None else group.status[part.member])
            else:
                columns.append(part)
                statuses.append(None)
        lanes = max(len(column) for column in columns)
        first = columns[0]
        result = np.empty((*first.shape[1:], len(columns), lanes), dtype=first.dtype)
        if result.ndim == 3:
            result = result.transpose(1, 2, 0)
        for member, column in enumerate(columns):
            result[member] = column
        if all(status is None for status in statuses):
            return result, None
        status_rows = np.zeros((len(columns), len(self.rows)), dtype=np.int8)
        for member, status in enumerate(statuses):
            if status is not None:
                status_rows[member] = status
        return result, status_rows

    def _error(self, step: Step, call: Call) -> Exception | None:
        """Return the error of a step in a batch of one lane: the first faulty operand's, as Python evaluates from the left."""
        operands = step.nodes[0].operands
        if step.operation.strict:
            for operand, status in zip(operands, call.operands, strict=True):
                if status is not None and status.flat[0] == FAULT:
                    return self.errors.get(operand)
        elif call.culprit is not None:
            return self.errors.get(operands[call.culprit])
        return call.error

    def _by_lane(self, step: Step, columns: list[Column], call: Call) -> Column:
        """Python's own function, lane by lane, where values are Python objects."""
        function = step.operation.python
        assert function is not None
        bad = _combined(call.operands)
        lanes = 1 if bad is None and all(len(column) == 1 for column in columns) else call.lanes
        decode, encode = self._codec.decode, self._codec.encode
        rows: list[Any] = []
        faulty_lanes = np.zeros(lanes, dtype=np.bool_)
        rejections = np.zeros(lanes, dtype=np.bool_)
        error: Exception | None = None
        blank = None if step.kind.is_boxed else np.zeros(step.kind.trailing, dtype=step.kind.dtype)
        plain = [decode(kind, column) for kind, column in zip(call.kinds, columns, strict=True)]
        if bad is None and step.kind.is_boxed and step.operation.together is not None:
            spread = (items if len(items) == lanes else items * lanes for items in plain)
            outputs = step.operation.together(*spread)
            if outputs is not None:
                return boxed(outputs)
        for lane in range(lanes):
            if bad is not None and bad[lane] != OK:
                rows.append(blank)
                continue
            values = [items[lane if len(items) > 1 else 0] for items in plain]
            try:
                rows.append(encode(step.kind, function(*values)))
            except self._rejections:
                rows.append(blank)
                rejections[lane] = True
            except Exception as problem:  # noqa: BLE001 - whatever the program's own values raise is that lane's fault
                rows.append(blank)
                faulty_lanes[lane] = True
                error = problem if error is None else error
        if error is not None:
            call.fault(faulty_lanes, error)
        call.reject(rejections)
        if step.kind.is_boxed:
            return boxed(rows)
        return np.asarray(rows, dtype=step.kind.dtype).reshape(lanes, *step.kind.trailing)


def _lanes(column: Column, lanes: NDArray[np.intp]) -> Column:
    """Some lanes of a group's columns; vectors stay stored component by component."""
    if column.ndim == 2:
        return column.take(lanes, axis=1)
    return column.transpose(2, 0, 1).take(lanes, axis=2).transpose(1, 2, 0)


def _combined(statuses: Iterable[Status | None]) -> Status | None:
    result: Status | None = None
    for status in statuses:
        if status is not None:
            result = status if result is None else np.maximum(result, status)
    return result


__all__ = ["Batch"]
