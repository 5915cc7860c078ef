"""Options of the whole test suite."""

import gc
import os
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

from tests.amounts import amount

# A slow machine is no finding. Each run draws other examples, so that many short runs see as much as a long one.
settings.register_profile(
    "patient",
    settings.get_profile("default"),
    max_examples=amount(40, 200),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
if not os.environ.get("CI"):
    settings.load_profile("patient")

# Several processes test at once: threads of BLAS would only wait for each other, which costs processor time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Tests compute everything themselves, and leave nothing behind in the home of whoever runs them.
os.environ["SCENIC_CACHE"] = "off"


@pytest.hookimpl(wrapper=True)
def pytest_collection(session: pytest.Session) -> Iterator[None]:
    """Collects tests without Python's garbage collector, which would go through all of them again and again."""
    gc.disable()
    try:
        return (yield)
    finally:
        # What collection leaves is kept, garbage included: looking for that among all tests would cost each worker a second.
        gc.freeze()
        gc.set_threshold(50_000)  # as the commands do; Python's own costs some three hundredths of all time
        gc.enable()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden",
        action="store_true",
        help="write what is found into the golden data files; read the difference before committing it",
    )
    parser.addoption(
        "--library",
        default="",
        help="which fortieth of Python's modules is read: 0 to 39, or all; by the commit if not given",
    )
