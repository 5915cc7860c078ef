"""Prints what holds of the protocol: ``python -m benchmarks.protocol``."""

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, Final

from benchmarks.protocol.documents import bursts, edits, positions
from benchmarks.protocol.features import capabilities, depth, size
from benchmarks.protocol.lifecycle import base_protocol, life_cycle, parent
from benchmarks.protocol.peer import Failure
from benchmarks.protocol.runs import runs

__all__ = ["main", "outcome"]

_PARTS: Final[dict[str, Callable[[int], Iterator[Any]]]] = {
    "life": lambda _edits: life_cycle(),
    "base": lambda _edits: base_protocol(),
    "parent": lambda _edits: parent(),
    "positions": lambda _edits: positions(),
    "edits": edits,
    "bursts": lambda _edits: bursts(),
    "capabilities": lambda _edits: capabilities(),
    "runs": lambda _edits: runs(),
    "depth": lambda _edits: depth(),
    "size": lambda _edits: size(),
}


def outcome(done: Callable[[], Any], wanted: Any) -> tuple[bool, str]:
    """Return true if a promise holds, and what came instead or was measured; ``...`` is a measurement."""
    try:
        found = done()
    except (Failure, KeyError, IndexError, TypeError) as error:
        return False, f"{type(error).__name__}: {error}"
    if wanted is ...:
        return True, str(found)
    return found == wanted, "" if found == wanted else str(found)[:200]


def main() -> int:
    """Print a line for each promise that does not hold, measurements, and a table of all parts."""
    parser = argparse.ArgumentParser(description="an outside client of the language server")
    parser.add_argument(
        "--part", choices=list(_PARTS), action="append", help="only this part; may be repeated"
    )
    parser.add_argument("--edits", type=int, default=2000, help="random edits in all")
    parser.add_argument("--show", action="store_true", help="print all promises")
    arguments = parser.parse_args()
    table = []
    for part in arguments.part or _PARTS:
        held, count, began = 0, 0, time.monotonic()
        for title, done, wanted in _PARTS[part](arguments.edits):
            holds, detail = outcome(done, wanted)
            held, count = held + holds, count + 1
            if not holds or arguments.show or wanted is ...:
                print(f"{'      ' if holds else 'NOT   '}{title}{': ' if detail else ''}{detail}", flush=True)
        table.append((part, held, count, time.monotonic() - began))
    print(f"{'part':14}{'holds':>7}{'of':>6}{'seconds':>9}")
    for part, held, count, seconds in table:
        print(f"{part:14}{held:7}{count:6}{seconds:9.1f}")
    return int(any(held < count for _, held, count, _ in table))


if __name__ == "__main__":
    sys.exit(main())
