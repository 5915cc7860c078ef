"""The global generators of Python and NumPy, which programs may use: seeded for them, and put back afterwards.

Nothing of ours draws from them (`scenic.graph.draws`).
"""

import random
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np


@contextmanager
def preserved() -> Iterator[None]:
    """Both generators are afterwards as they were before."""
    python_state, numpy_state = random.getstate(), np.random.get_state()  # noqa: NPY002 - what programs use
    try:
        yield
    finally:
        random.setstate(python_state)
        np.random.set_state(numpy_state)  # noqa: NPY002 - what programs use


def seed_globals(seed: int) -> None:
    """Seed both generators with a number of at most 64 bits."""
    random.seed(seed)
    np.random.seed(seed & 0xFFFFFFFF)  # noqa: NPY002 - what programs use
