"""Noticing that the process that started the server has gone."""

import os
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

__all__ = ["is_alive", "watch"]

INTERVAL: Final = 1.0
"""Seconds between two looks."""


def watch(process: int, gone: Callable[[], None]) -> None:
    """Call ``gone`` once, in a thread of its own, when no process has this number any more."""

    def look() -> None:
        while is_alive(process):
            time.sleep(INTERVAL)
        gone()

    threading.Thread(target=look, name="parent", daemon=True).start()


def is_alive(process: int) -> bool:
    """Return whether a process of this number runs. A process that has ended, but whose exit code nobody has read, does not run."""
    if sys.platform == "win32":
        return _is_alive_on_windows(process)
    if process <= 0:
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True  # It belongs to someone else.
    try:
        state = Path(f"/proc/{process}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return True  # There is no such file here.
    return state.rpartition(")")[2].split()[:1] != ["Z"]


def _is_alive_on_windows(process: int) -> bool:
    # Asking for a process by `os.kill` would end it there.
    import ctypes

    kernel = getattr(ctypes, "windll").kernel32  # noqa: B009 - only there on Windows
    synchronize, timeout = 0x0010_0000, 0x102
    handle = kernel.OpenProcess(synchronize, False, process)
    if not handle:
        return False
    try:
        return bool(kernel.WaitForSingleObject(handle, 0) == timeout)
    finally:
        kernel.CloseHandle(handle)
