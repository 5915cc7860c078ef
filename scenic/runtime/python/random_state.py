"""The global generators of Python and NumPy, which programs may use: seeded for them, and put back afterwards.

Nothing of ours draws from them (`scenic.graph.draws`).
"""

import random
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np


@contextmanager
def preserved() -> Iterator[Any]:
    """Both generators are afterwards as they were before, in the states that this gives."""
    before = states()
    try:
        yield before
    finally:
        restore(before)


def states() -> Any:
    """The states of both generators, for `restore`."""
    return random.getstate(), np.random.get_state()  # noqa: NPY002 - what programs use


def is_as(before: Any) -> bool:
    """Return whether both generators are in the states of another moment: then nothing has been drawn since."""
    (python_before, numpy_before), (python_now, numpy_now) = before, states()
    return bool(
        python_before == python_now
        and numpy_before[2:] == numpy_now[2:]
        and np.array_equal(numpy_before[1], numpy_now[1])
    )


def restore(before: Any) -> None:
    """Put both generators into the states of another moment."""
    python_state, numpy_state = before
    random.setstate(python_state)
    np.random.set_state(numpy_state)  # noqa: NPY002 - what programs use


def seed_globals(seed: int) -> None:
    """Seed both generators with a number of at most 64 bits."""
    random.seed(seed)
    np.random.seed(seed & 0xFFFFFFFF)  # noqa: NPY002 - what programs use
