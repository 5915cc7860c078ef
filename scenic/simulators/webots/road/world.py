"""The world whose roads a program uses."""

import os

from scenic.formats.webots_reading import WORLD_PARAMETER
from scenic.runtime.program.veneer import param

__all__ = ["setLocalWorld"]


def setLocalWorld(module: str, relpath: str) -> None:
    """Choose the world of a program, before it imports `scenic.simulators.webots.road.model`.

    Args:
        module: the file of the program, ``__file__``.
        relpath: the path of the world file, relative to the folder of the program.

    """
    param({WORLD_PARAMETER: os.path.join(os.path.dirname(os.path.abspath(module)), relpath)})
