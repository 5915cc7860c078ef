"""Work counted rather than timed, so that tests of linear time do not depend on the machine."""

import sys
from collections.abc import Callable
from typing import Any


def calls_while(function: Callable[..., Any], *arguments: Any) -> int:
    """How many Python functions are called, or gone on with, while ``function`` runs."""
    count = 0

    def profile(frame: object, event: str, argument: object) -> None:
        nonlocal count
        count += event == "call"

    sys.setprofile(profile)
    try:
        function(*arguments)
    finally:
        sys.setprofile(None)
    return count
