"""Forward kinematics over lanes: where the links of a body with joints are, for many configurations at once.

A chain is what MuJoCo makes of a description: bodies in the frames of their parents, each moved by hinges and slides in order.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph import quaternions

__all__ = ["Joint", "Segment", "forward"]

Floats = NDArray[np.float64]


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


def forward(segments: Sequence[Segment], values: Sequence[Floats]) -> tuple[Floats, Floats]:
    """The frame of the last segment of a chain in the frame that the chain begins in.

    Args:
        segments: from the base outwards.
        values: of their joints in order, ``(n,)`` each, radians or metres.

    Returns:
        Positions ``(n, 3)`` and orientations ``(n, 4)``, ``(x, y, z, w)``; one row if the chain has no joints.

    """
    count = len(values[0]) if values else 1
    position, turn = np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
    upcoming = iter(values)
    for segment in segments:
        position = position + quaternions.rotate(turn, np.asarray(segment.position))
        turn = quaternions.multiply(turn, np.asarray(segment.quaternion))
        for joint in segment.joints:
            change = next(upcoming) - joint.home
            axis, anchor = np.asarray(joint.axis), np.asarray(joint.anchor)
            if joint.slides:
                position = position + quaternions.rotate(turn, axis) * change[:, None]
                continue
            fixed = position + quaternions.rotate(turn, anchor)
            sine = np.sin(change / 2)[:, None] * axis
            turn = quaternions.multiply(turn, np.concatenate([sine, np.cos(change / 2)[:, None]], axis=1))
            position = fixed - quaternions.rotate(turn, anchor)
    return position, turn
