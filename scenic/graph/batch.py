"""Evaluation of a graph over many points of the cube at a time."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.graph.kinds import Codec, Column, Kind, boxed
from scenic.graph.node import Graph, Node
from scenic.graph.operation import FAULT, OK, Call, Status


class Batch:
    """The lanes of one run: points of the cube, and the columns computed for them so far.

    ``keep`` drops lanes; columns are narrowed only when they are used again, so that a test that leaves few lanes
    does not pay for every node. Values in lanes whose status is not `OK` are meaningless.

    Args:
        graph: the graph that numbers the axes.
        cube: shape ``(n, graph.dimension)``, points of the open unit cube.
        codec: the Python side of values.
        rejections: exceptions by which the program's own functions reject a sample.

    """

    def __init__(
        self,
        graph: Graph,
        cube: NDArray[np.float64],
        codec: Codec,
        *,
        rejections: tuple[type[Exception], ...] = (),
    ) -> None:
        if cube.ndim != 2 or cube.shape[1] != graph.dimension:
            raise ValueError(f"cube has shape {cube.shape}, the graph {graph.dimension} axes")
        self._graph = graph
        self._codec = codec
        self._rejections = rejections
        self.cube = cube
        self.rows: NDArray[np.intp] = np.arange(len(cube))
        """Which of the first lanes each present lane is, ascending."""
        self.errors: dict[Node, Exception] = {}
        """What went wrong at a node; exact only in a batch of one lane."""
        self._generation = 0
        self._kept: list[NDArray[np.intp]] = []
        self._columns: dict[Node, tuple[int, Column, Status | None]] = {}

    def __len__(self) -> int:
        return len(self.rows)

    def keep(self, lanes: NDArray[Any]) -> None:
        """Go on with these lanes only: a mask ``(n,)`` or ascending indices."""
        chosen = np.flatnonzero(lanes) if lanes.dtype == np.bool_ else lanes
        if len(chosen) == len(self.rows):
            return
        self.rows = self.rows[chosen]
        self._kept.append(chosen)
        self._generation += 1

    def column(self, node: Node) -> Column:
        """Values of ``node``, leading dimension ``len(self)`` or 1."""
        return self._get(node)[0]

    def status(self, node: Node) -> Status | None:
        """Status of each lane at ``node``; ``None`` when all are `OK`."""
        return self._get(node)[1]

    def full(self, node: Node) -> Column:
        """As `column`, always of leading dimension ``len(self)``."""
        column = self._get(node)[0]
        if len(column) == len(self.rows):
            return column
        return np.broadcast_to(column, (len(self.rows), *column.shape[1:]))

    def value(self, node: Node, lane: int = 0) -> Any:
        """The Python value of ``node`` in one lane."""
        column = self.column(node)
        return self._codec.decode(node.kind, column[lane if len(column) > 1 else 0])

    def _get(self, node: Node) -> tuple[Column, Status | None]:
        if node.is_constant:
            return node.payload.column, None
        if node not in self._columns:
            self._evaluate(node)
        generation, column, status = self._columns[node]
        if generation == self._generation:
            return column, status
        lanes = self._since(generation)
        if len(column) > 1:
            column = column[lanes]
        if status is not None:
            status = status[lanes]
            if not status.any():
                status = None
        self._columns[node] = self._generation, column, status
        return column, status

    def _since(self, generation: int) -> NDArray[np.intp]:
        """Lanes of an older generation that are still here."""
        lanes = self._kept[-1]
        for chosen in reversed(self._kept[generation:-1]):
            lanes = chosen[lanes]
        return lanes

    def _evaluate(self, root: Node) -> None:
        stack = [root]
        while stack:
            node = stack[-1]
            if node in self._columns:
                stack.pop()
                continue
            if node.is_axis:
                values = np.ascontiguousarray(self.cube[self.rows, self._graph.axes[node]])
                self._columns[node] = self._generation, values, None
                stack.pop()
                continue
            missing = [
                operand
                for operand in node.operands
                if not operand.is_constant and operand not in self._columns
            ]
            if missing:
                stack.extend(reversed(missing))
                continue
            self._apply(node)
            stack.pop()

    def _apply(self, node: Node) -> None:
        operation = node.operation
        parts = [self._get(operand) for operand in node.operands]
        columns = [part[0] for part in parts]
        statuses = [part[1] for part in parts]
        call = Call(
            len(self.rows),
            node.payload,
            statuses,
            lambda: self._seeds(node),
            kinds=[operand.kind for operand in node.operands],
            kind=node.kind,
            codec=self._codec,
        )
        by_lane = (
            operation.python is not None
            and operation.strict
            and (node.kind.is_boxed or any(operand.kind.is_boxed for operand in node.operands))
        )
        with np.errstate(all="ignore"):
            if by_lane:
                column = self._by_lane(node, columns, call)
            else:
                column = operation.batch(call, *columns)
        status = call.status
        if operation.strict:
            for operand_status in statuses:
                if operand_status is not None:
                    status = operand_status if status is None else np.maximum(status, operand_status)
        if status is not None and len(self.rows) == 1 and status[0] == FAULT:
            error = self._error(node, call)
            if error is not None:
                self.errors[node] = error
        self._columns[node] = self._generation, column, status

    def _error(self, node: Node, call: Call) -> Exception | None:
        """What went wrong in a batch of one lane: the first operand's fault, as Python evaluates from the left."""
        if node.operation.strict:
            for operand, status in zip(node.operands, call.operands, strict=True):
                if status is not None and status[0] == FAULT:
                    return self.errors.get(operand)
        elif call.culprit is not None:
            return self.errors.get(node.operands[call.culprit])
        return call.error

    def _by_lane(self, node: Node, columns: list[Column], call: Call) -> Column:
        """Python's own function, lane by lane, where values are Python objects."""
        function = node.operation.python
        assert function is not None
        bad = _combined(call.operands)
        lanes = 1 if bad is None and all(len(column) == 1 for column in columns) else call.lanes
        decode, encode = self._codec.decode, self._codec.encode
        rows: list[Any] = []
        failed = np.zeros(lanes, dtype=np.bool_)
        rejected = np.zeros(lanes, dtype=np.bool_)
        error: Exception | None = None
        blank = _blank(node.kind)
        for lane in range(lanes):
            if bad is not None and bad[lane] != OK:
                rows.append(blank)
                continue
            values = [
                decode(kind, column[lane if len(column) > 1 else 0])
                for kind, column in zip(call.kinds, columns, strict=True)
            ]
            try:
                rows.append(encode(node.kind, function(*values)))
            except self._rejections:
                rows.append(blank)
                rejected[lane] = True
            except Exception as problem:  # noqa: BLE001 - whatever the program's own values raise is that lane's fault
                rows.append(blank)
                failed[lane] = True
                error = problem if error is None else error
        if error is not None:
            call.fault(failed, error)
        call.reject(rejected)
        if node.kind.is_boxed:
            return boxed(rows)
        return np.asarray(rows, dtype=node.kind.dtype).reshape(lanes, *node.kind.trailing)

    def _seeds(self, node: Node) -> NDArray[np.uint64]:
        """A seed for each lane that depends on its point of the cube and on the node, nothing else."""
        state = np.full(len(self.rows), self._graph.index[node], dtype=np.uint64)
        for name in range(self.cube.shape[1]):
            state = mix(state ^ np.ascontiguousarray(self.cube[self.rows, name]).view(np.uint64))
        return mix(state)


def mix(words: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Scramble 64-bit words (the finaliser of SplitMix64: Steele, Lea and Flood, OOPSLA 2014)."""
    with np.errstate(over="ignore"):
        words = words + np.uint64(0x9E3779B97F4A7C15)
        words = (words ^ (words >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        words = (words ^ (words >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return words ^ (words >> np.uint64(31))


def _combined(statuses: Any) -> Status | None:
    result: Status | None = None
    for status in statuses:
        if status is not None:
            result = status if result is None else np.maximum(result, status)
    return result


def _blank(kind: Kind) -> Any:
    return None if kind.is_boxed else np.zeros(kind.trailing, dtype=kind.dtype)


__all__ = ["Batch", "mix"]
