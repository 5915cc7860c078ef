"""Amounts that tests try: as much as finds most faults soon, or, where SCENIC_TEST_LONG is set, as much as finds rare ones."""

import os

LONG = bool(os.environ.get("SCENIC_TEST_LONG"))


def amount(usual: int, long: int) -> int:
    """The number of cases, samples or seeds of a test: ``long`` in long runs (``make test-long``)."""
    return long if LONG else usual
