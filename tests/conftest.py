"""Options of the whole test suite."""

import pytest


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
