"""Random stable poses of shapes, as values of the graph."""

from typing import Any, Final

import numpy as np

from scenic.graph import quaternions
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import ScenicTypeError
from scenic.runtime.geometry.meshes.stable_poses import stable_poses
from scenic.runtime.ground.context import here
from scenic.runtime.shapes.shapes import Shape
from scenic.runtime.values.values import apply, per_option, to_scalar, to_vector, uniform

__all__ = ["resting_pose"]

_DIGITS: Final = 9
"""Digits of the ratios of extents by which poses are kept."""


def resting_pose(shape: object, width: object, length: object, height: object) -> Any:
    """A random stable pose of a shape at a size: the vector of pitch, roll (radians) and height of the middle (metres).

    Raises:
        ScenicTypeError: the shape is neither definite nor a choice among definite shapes.

    """
    draw = uniform()
    sizes = [to_scalar(extent) for extent in (width, length, height)]

    def of_option(option: object) -> Any:
        if not isinstance(option, Shape):
            raise ScenicTypeError(
                "`resting on` needs a shape that is known before the draw",
                span=here(),
                help="choose among shapes: `with shape Uniform(MeshShape(...), MeshShape(...))`",
            )
        return apply(_POSE, draw, *sizes, payload=option.mesh)

    return to_vector(per_option(shape, of_option))


def _pose(call: Call, draw: Column, width: Column, length: Column, height: Column) -> Column:
    draw, width, length, height = np.broadcast_arrays(draw, width, length, height)
    # As complex numbers, of which pairs of ratios are sorted fast.
    ratios = np.round((length / width).ravel(), _DIGITS) + 1j * np.round((height / width).ravel(), _DIGITS)
    result = np.empty((3, draw.size))
    alike = len(ratios) > 0 and bool((ratios == ratios[0]).all())
    kinds, members = (ratios[:1], None) if alike else np.unique(ratios, return_inverse=True)
    for number, ratio in enumerate(kinds.tolist()):
        along, upward = ratio.real, ratio.imag
        lanes = slice(None) if members is None else np.flatnonzero(members == number)
        if not (along > 0 and upward > 0):  # no size: refused elsewhere
            result[:, lanes] = 0.0
            continue
        poses = stable_poses(call.payload, along, upward)
        numbers = np.minimum(
            np.searchsorted(poses.shares, draw.ravel()[lanes], side="right"), len(poses.shares) - 1
        )
        result[:, lanes] = poses.pitches[numbers], poses.rolls[numbers], poses.lifts[numbers]
    result[2] *= width.ravel()
    return quaternions.components_last(result.reshape(3, *draw.shape))


_POSE: Final = Operation(
    "stable pose", always(Kind.VECTOR), _pose, "A stable pose of a mesh, drawn by its probability."
)
