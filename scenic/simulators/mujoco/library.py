"""The MuJoCo library, which is optional: imported when a simulation is made."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from scenic.language.extras import needing

__all__ = ["draw_without_window", "library", "quietly"]


def draw_without_window() -> None:
    """Let MuJoCo draw without a window where there is no display; it reads this when it is imported."""
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        os.environ.setdefault("MUJOCO_GL", "egl")


def library() -> Any:
    """Return the module ``mujoco``; raises `UnsupportedError` without it. It has no types, hence `Any`."""
    draw_without_window()
    words = "the MuJoCo simulator needs the package mujoco-core"
    with needing(words, "mujoco", instead="; or simulate with --simulator kinematic"):
        import mujoco  # optional, and slow to import
    return mujoco


@contextmanager
def quietly() -> Iterator[None]:
    """Within this the library's warnings are neither printed nor written to its log file in the working directory.

    What they warn of is counted in ``MjData.warning``, which is read after each step.
    """
    mujoco = library()
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(_ignore)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)


def _ignore(_message: str) -> None:
    pass
