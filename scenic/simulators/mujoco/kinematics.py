"""Forward kinematics over lanes: where the links of a body with joints are, for many configurations at once.

A chain is what MuJoCo makes of a description: bodies in the frames of their parents, each moved by hinges and slides in order.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph import quaternions

__all__ = ["Joint", "Segment", "forward"]

Floats = NDArray[np.float64]

_UNTURNED: Final = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint.

    Attributes:
        name: of the joint.
        slides: whether it is prismatic (metres), else it turns (radians).
        axis: unit vector in the frame of its body.
        anchor: a point of the axis in that frame, metres.
        low: least value; minus infinity without a limit.
        high: greatest value.
        home: value in the description's own configuration, in which the bodies stand as their frames say.

    """

    name: str
    slides: bool
    axis: tuple[float, float, float]
    anchor: tuple[float, float, float]
    low: float
    high: float
    home: float


@dataclass(frozen=True, slots=True)
class Segment:
    """A body between its parent and its joints: its frame in the parent's, orientation ``(x, y, z, w)``."""

    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]
    joints: tuple[Joint, ...]


def forward(
    segments: Sequence[Segment],
    values: Sequence[Floats],
    position: Floats | None = None,
    turn: Floats | None = None,
) -> tuple[Floats, Floats]:
    """The frame of the last segment of a chain.

    Args:
        segments: from the base outwards.
        values: of their joints in order, ``(n,)`` each, radians or metres.
        position: of the frame that the chain begins in, ``(n, 3)`` or ``(1, 3)``, metres; zero by default.
        turn: orientation of that frame, ``(n, 4)`` or ``(1, 4)``, ``(x, y, z, w)``; none by default.

    Returns:
        Positions ``(n, 3)`` and orientations ``(n, 4)``; one row if all operands have one.

    """
    position = np.zeros((1, 3)) if position is None else position
    turn = np.array([_UNTURNED]) if turn is None else turn
    upcoming = iter(values)
    for segment in segments:
        position = position + quaternions.rotate(turn, np.asarray(segment.position))
        if segment.quaternion != _UNTURNED:
            turn = quaternions.multiply(turn, np.asarray(segment.quaternion))
        for joint in segment.joints:
            change = next(upcoming) - joint.home
            axis, anchor = np.asarray(joint.axis), np.asarray(joint.anchor)
            if joint.slides:
                position = position + quaternions.rotate(turn, axis) * change[:, None]
                continue
            if not anchor.any():  # on the axis, whose points the joint leaves where they are
                turn = quaternions.multiply(turn, _hinged(axis, change))
                continue
            anchor_place = position + quaternions.rotate(turn, anchor)
            turn = quaternions.multiply(turn, _hinged(axis, change))
            position = anchor_place - quaternions.rotate(turn, anchor)
    return position, turn


def _hinged(axis: Floats, angle: Floats) -> Floats:
    """The orientations ``(n, 4)`` of turns about an axis ``(3,)`` by angles ``(n,)``, radians."""
    return np.concatenate([np.sin(angle / 2)[:, None] * axis, np.cos(angle / 2)[:, None]], axis=1)
