"""Cameras that follow an object of a simulation, from behind or from above."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from scenic.formats.camera import Camera, Outlook, framing
from scenic.formats.mesh_instances import Array, MeshInstance
from scenic.formats.poses import rotation_matrix
from scenic.language.errors import ScenicError
from scenic.language.spelling import nearest

__all__ = ["BEHIND", "CameraFollowError", "Track"]

BEHIND: Final = (0.0, 22.0)
"""Azimuth and elevation of a camera that follows, degrees, if nothing else is said."""
_STEADY: Final = 0.5
"""Seconds over which the direction of the camera is the mean of the object's, so that it does not shake."""
_SIZES: Final = 2.5
"""Lengths of the object around it that are in the picture."""
_AHEAD: Final = 0.8
"""So many times that far ahead of the object is the middle of what is shown from low behind; from above it is the object."""
_LEAST: Final = 5.0
"""Metres around the object that are in the picture at least."""


class CameraFollowError(ScenicError):
    """There is no object of the name that a camera is to follow."""

    code = "SC604"


class Track:
    """The way of an object through the states of a simulation.

    Args:
        states: the objects in each state.
        name: of the variable that holds the object, or the object's number among those that are drawn.
        timestep: seconds between states.

    Raises:
        CameraFollowError: there is no such object.

    """

    def __init__(self, states: Sequence[Sequence[MeshInstance]], name: str | int, timestep: float) -> None:
        self._size = max(_chosen(states, name).size)
        whole = [_in_state(state, name) for state in states]
        present = [number for number, item in enumerate(whole) if item is not None]
        numbers = range(len(states))
        # Before it is there, the camera waits where it will be.
        self._places = np.column_stack(
            [
                np.interp(numbers, present, [item.position[axis] for item in whole if item is not None])
                for axis in range(3)
            ]
        )
        ahead = np.array([rotation_matrix(item.quaternion)[:, 1] for item in whole if item is not None])
        headings = np.unwrap(np.arctan2(-ahead[:, 0], ahead[:, 1]))
        self._headings = _steadied(np.interp(numbers, present, headings), _STEADY / timestep)

    def camera(self, state: int, aspect: float, outlook: Outlook) -> Camera:
        """The camera in a state, for images so much wider than high."""
        reach = outlook.reach or max(_LEAST, _SIZES * self._size)
        heading = self._headings[state]
        azimuth = outlook.azimuth - math.degrees(heading)
        turns = heading + np.linspace(0, 2 * np.pi, 12, endpoint=False)
        circle = np.column_stack([np.cos(turns), np.sin(turns), np.zeros(12)]) * reach
        # Seen from behind, what lies before it is of more interest than what lies behind.
        forward = math.cos(math.radians(outlook.elevation)) * math.cos(math.radians(outlook.azimuth))
        ahead = _AHEAD * max(forward, 0.0) * reach
        middle = self._places[state] + ahead * np.array([-np.sin(heading), np.cos(heading), 0.0])
        return framing(middle + circle, aspect, replace(outlook, azimuth=azimuth))


def _in_state(state: Sequence[MeshInstance], name: str | int) -> MeshInstance | None:
    if isinstance(name, int):
        return state[name] if name < len(state) else None
    return next((item for item in state if item.name == name or (name == "ego" and item.is_ego)), None)


def _chosen(states: Sequence[Sequence[MeshInstance]], name: str | int) -> MeshInstance:
    for state in states:
        item = _in_state(state, name)
        if item is not None:
            return item
    names = list(dict.fromkeys(item.label for state in states for item in state if item.name or item.is_ego))
    count = max(map(len, states), default=0)
    near = nearest(name, names) if isinstance(name, str) else None
    raise CameraFollowError(
        f"there is no object {name!r} to follow",
        help=f"did you mean {near!r}?"
        if near
        else f"objects with names: {', '.join(names) or 'none'}; or give a number from 0 to {count - 1}",
    )


def _steadied(values: Array, width: float) -> Array:
    """The means of values over a window of a width."""
    half = round(width / 2)
    if half < 1 or len(values) < 2:
        return values
    padded = np.pad(values, half, mode="edge")
    return np.convolve(padded, np.full(2 * half + 1, 1 / (2 * half + 1)), mode="valid")
