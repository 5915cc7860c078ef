"""A single sample of a random value, drawn now: for scripts that use a distribution without a scenario."""

import random
from collections.abc import Sequence
from typing import Any

import numpy as np

from scenic.graph.batch import Batch
from scenic.graph.bounding import overall
from scenic.graph.draws import Counter, Words
from scenic.graph.node import Graph, Node
from scenic.graph.operation import FAULT
from scenic.graph.schedule import Scheduler
from scenic.language.errors import RejectionException
from scenic.runtime.python.samples import Sample, dependencies
from scenic.runtime.values import generic
from scenic.runtime.values.values import CODEC, Random, as_node, is_number


def sample_of(value: object) -> Any:
    """A sample of a value and of all that is random in it, from Python's generator.

    Raises:
        RejectionException: if there is none, as for a number between ends that leave nothing.
        Exception: what the program's own functions raise on this sample.

    """
    nodes = dependencies([value])
    keys = np.array([random.getrandbits(64)], dtype=np.uint64)
    batch = _drawn(nodes, keys)
    statuses = [batch.status(node) for node in nodes]
    if any(status is not None for status in statuses):
        # Once more, singly: that tells what failed.
        batch = _drawn(nodes, keys, grouped=False)
        for node in nodes:
            status = batch.status(node)
            if status is not None:
                if status[0] == FAULT and node in batch.errors:
                    raise batch.errors[node]
                raise RejectionException(f"this sample of {value!r} is rejected")
    return Sample(batch, 0).value(value)


def _drawn(nodes: Sequence[Node], keys: Words, *, grouped: bool = True) -> Batch:
    scheduler = Scheduler(Graph(nodes), grouped=grouped)
    batch = Batch(scheduler, Counter(keys), CODEC, rejections=(RejectionException,))
    batch.need(nodes)
    return batch


def support_of(value: object) -> tuple[float | None, float | None]:
    """Return the least and the greatest value that a number, random or not, can have; ``None`` where that is not known."""
    if is_number(value):
        return (value, value)
    if not isinstance(value, Random) or not as_node(value).kind.is_number:
        return (None, None)
    bounds = overall(value.node)
    if bounds is None:
        return (None, None)
    low, high = float(bounds.lower[0]), float(bounds.upper[0])
    return (None if np.isinf(low) else low, None if np.isinf(high) else high)


generic.sample_of.register(object, sample_of)
generic.support_of.register(object, support_of)

__all__ = ["sample_of", "support_of"]
