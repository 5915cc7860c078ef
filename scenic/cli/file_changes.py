"""Doing something again whenever files change."""

import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Final

from scenic.cli.discovery import discover
from scenic.configuration.project import Configurations

__all__ = ["watch"]

_INTERVAL: Final = 0.3
"""Seconds between two looks."""
_CLEAR: Final = "\x1b[2J\x1b[H"
_ENDINGS: Final = (".scenic", ".sc", ".py", "pyproject.toml", ".xodr")


def watch(paths: Sequence[str], run: Callable[[], object]) -> None:
    """Run at once, and again when a program among ``paths``, or what lies beside one, has changed. Until interrupted."""
    while True:
        before = dict(_stamps(paths))
        if sys.stdout.isatty():
            sys.stdout.write(_CLEAR)
        run()
        sys.stdout.flush()
        while dict(_stamps(paths)) == before:
            time.sleep(_INTERVAL)


def _stamps(paths: Sequence[str]) -> Iterator[tuple[str, tuple[int, int]]]:
    """When each file was last written, and its size. Modules that programs import lie beside them, as a rule."""
    files = discover(paths, Configurations()).files
    for folder in sorted({os.path.dirname(os.path.abspath(file)) for file in files} | {os.getcwd()}):
        try:
            entries = list(os.scandir(folder))
        except OSError:
            continue
        for entry in entries:
            if entry.name.endswith(_ENDINGS):
                try:
                    status = entry.stat()
                except OSError:
                    continue
                yield entry.path, (status.st_mtime_ns, status.st_size)
