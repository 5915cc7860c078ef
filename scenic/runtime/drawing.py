"""One sample of a random value by itself, drawn now: for scripts that look at a law without a scenario."""

import random
from typing import Any

import numpy as np

from scenic.graph.batch import Batch
from scenic.graph.bounding import overall
from scenic.graph.draws import Counter
from scenic.graph.node import Graph
from scenic.graph.operation import FAULT
from scenic.graph.schedule import Scheduler
from scenic.language.errors import RejectionException
from scenic.runtime.samples import Sample, dependencies
from scenic.runtime.values import CODEC, Random, as_node, is_number


def sample_of(value: Any) -> Any:
    """A sample of a value and of all that is random in it, from Python's generator.

    Raises:
        RejectionException: if there is none, as for a number between ends that leave nothing.
        Exception: what the program's own functions raise on this sample.

    """
    nodes = dependencies([value])
    keys = np.array([random.getrandbits(64)], dtype=np.uint64)
    batch = Batch(Scheduler(Graph(nodes)), Counter(keys), CODEC, rejections=(RejectionException,))
    batch.need(nodes)
    for node in nodes:
        status = batch.status(node)
        if status is not None:
            if status[0] == FAULT and batch.errors:
                raise next(iter(batch.errors.values()))
            raise RejectionException(f"this sample of {value!r} is rejected")
    return Sample(batch, 0).value(value)


def support_of(value: Any) -> tuple[float | None, float | None]:
    """The least and the greatest value that a number, random or not, can have; ``None`` where that is not known."""
    if is_number(value):
        return (value, value)
    if not isinstance(value, Random) or not as_node(value).kind.is_number:
        return (None, None)
    bounds = overall(value.node)
    if bounds is None:
        return (None, None)
    low, high = float(bounds.lower[0]), float(bounds.upper[0])
    return (None if np.isinf(low) else low, None if np.isinf(high) else high)


Random.drawn = staticmethod(sample_of)
Random.supported = staticmethod(support_of)

__all__ = ["sample_of", "support_of"]
