"""Options of the whole test suite."""

import os

import pytest
from hypothesis import HealthCheck, settings

# A slow machine is no finding. (Where CI is set, Hypothesis takes its own profile, which says the same.)
settings.register_profile(
    "patient", settings.get_profile("default"), deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
if not os.environ.get("CI"):
    settings.load_profile("patient")

# Tests compute everything themselves, and leave nothing behind in the home of whoever runs them.
os.environ["SCENIC_CACHE"] = "off"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden",
        action="store_true",
        help="write what is found into the golden data files; read the difference before committing it",
    )
    parser.addoption(
        "--library",
        default="",
        help="which eighth of Python's modules is read: 0 to 7, or all; by the commit if not given",
    )
