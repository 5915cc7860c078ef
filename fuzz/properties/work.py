"""Work counted, not timed: linear time must not depend on the machine."""

import sys
from collections.abc import Callable
from typing import Any

__all__ = ["work"]


def work(function: Callable[..., Any], *arguments: Any) -> int:
    """Return the number of calls and resumptions of Python functions while ``function`` runs."""
    count = 0

    def profile(_frame: object, event: str, _argument: object) -> None:
        nonlocal count
        count += event == "call"

    before = sys.getprofile()
    sys.setprofile(profile)
    try:
        function(*arguments)
    finally:
        sys.setprofile(before)
    return count
