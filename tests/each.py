"""One test for many cases: a loop where a parametrised test would be thousands of cases of a millisecond each."""

from collections.abc import Callable, Iterable
from itertools import product
from typing import Any

import pytest


def each(*tables: Iterable[Any]) -> Callable[[Callable[..., None]], Callable[[], None]]:
    """A decorator: asks a test about every case, and reports all that fail, each with its case.

    A case has an entry of each table, which are the arguments of the test.

    Cases that the test skips are passed over; if it skips all, it is skipped.

    Raises:
        ExceptionGroup: by the test, with one exception for each case that fails.
        ValueError: if there is no case.
    """
    known = tuple(product(*tables))
    if not known:
        raise ValueError("no case")

    def decorate(test: Callable[..., None]) -> Callable[[], None]:
        def run() -> None:
            failures, skipped = [], 0
            for case in known:
                try:
                    test(*case)
                except pytest.skip.Exception:
                    skipped += 1
                except Exception as error:  # noqa: BLE001 - each failure is reported with its case
                    error.add_note(f"case: {', '.join(map(str, case))}")
                    failures.append(error)
            if failures:
                raise ExceptionGroup(f"{len(failures)} of {len(known)} cases fail", failures)
            if skipped == len(known):
                pytest.skip("every case is skipped")

        run.__name__, run.__doc__, run.__module__ = test.__name__, test.__doc__, test.__module__
        return run

    return decorate
