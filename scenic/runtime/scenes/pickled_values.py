"""Values of a scene in its pickle, so that the process which unpickles it does not evaluate the program once more."""

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from math import prod
from typing import Any

import numpy as np

from scenic.graph.batch import Batch
from scenic.graph.kinds import Kind
from scenic.graph.node import Node
from scenic.graph.schedule import Scheduler
from scenic.runtime.values.nodes import CODEC

__all__ = ["RecalledBatch", "ValueLayout"]


class ValueLayout:
    """The order of the values in a pickled scene: all numbers, vectors and orientations of its objects and parameters, by kind.

    Args:
        outputs: nodes of the objects and parameters; values that are Python objects are left out.

    """

    def __init__(self, outputs: Iterable[Node]) -> None:
        self._nodes: dict[Kind, list[Node]] = {kind: [] for kind in Kind if not kind.is_boxed}
        for node in outputs:
            if not (node.kind.is_boxed or node.is_constant):
                self._nodes[node.kind].append(node)

    def pack(self, batch: Batch, lane: int) -> bytes:
        """Return the values in one lane."""
        columns = [batch.column(node) for nodes in self._nodes.values() for node in nodes]
        return b"".join([column[lane if len(column) > 1 else 0].tobytes() for column in columns])

    def unpack(self, data: bytes) -> dict[Node, Any]:
        """Return the Python values in the data by node; raises ``ValueError`` for data of another layout."""
        values: dict[Node, Any] = {}
        start = 0
        for kind, nodes in self._nodes.items():
            column = np.frombuffer(data, kind.dtype, len(nodes) * prod(kind.trailing), start)
            values.update(zip(nodes, CODEC.decode(kind, column.reshape(-1, *kind.trailing)), strict=True))
            start += column.nbytes
        if start != len(data):
            raise ValueError(f"{len(data)} bytes of values, not {start}")
        return values


class RecalledBatch(Batch):
    """One lane whose values at some nodes are known; others are evaluated when they are read.

    Args:
        scheduler: see `Batch`, as are the options.
        values: the known values.
        guard: gives a context in which the other nodes are evaluated.

    """

    def __init__(
        self,
        scheduler: Scheduler,
        *arguments: Any,
        values: Mapping[Node, Any],
        guard: Callable[[], AbstractContextManager[None]],
        **options: Any,
    ) -> None:
        super().__init__(scheduler, *arguments, **options)
        self._values.update((node, [value]) for node, value in values.items())
        self._guard = guard

    def settle(self, nodes: Iterable[Node]) -> None:
        """Leave all nodes to be evaluated when they are read."""

    def need(self, nodes: Iterable[Node]) -> None:
        """Evaluate nodes within the guard."""
        with self._guard():
            super().need(nodes)
