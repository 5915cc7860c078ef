"""Random stable poses of shapes, as values of the graph."""

from typing import Any, Final

import numpy as np

from scenic.graph import quaternions
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import ScenicTypeError
from scenic.runtime.geometry.meshes.stable_poses import (
    centre_of_mass,
    ellipsoid_footing,
    hull_footing,
    resting_poses,
)
from scenic.runtime.ground.context import here
from scenic.runtime.shapes.shapes import Shape
from scenic.runtime.values.values import apply, operate, per_option, to_scalar, to_vector, uniform, vector

__all__ = ["middle_of_mass", "resting_pose"]

_DIGITS: Final = 9
"""Digits of the ratios of extents by which poses are kept, and of the place of a centre of mass in a unit box."""


def resting_pose(shape: object, width: object, length: object, height: object) -> Any:
    """Return a random stable pose of a shape at a size: the vector of pitch, roll (radians) and height of the middle (metres).

    Raises:
        ScenicTypeError: the shape is neither definite nor a choice among definite shapes.

    """
    draw = uniform()
    sizes = [to_scalar(extent) for extent in (width, length, height)]

    def of_option(option: object) -> Any:
        definite = _definite(option)
        is_ellipsoid = definite.source.kind == "spheroid" and definite.source.initial_rotation is None
        return apply(_POSE, draw, *sizes, payload=(definite.mesh, is_ellipsoid))

    return to_vector(per_option(shape, of_option))


def middle_of_mass(shape: object, width: object, length: object, height: object) -> Any:
    """Return the centre of mass of a solid of one density, from the middle of its box along its own axes (metres).

    Raises:
        ScenicTypeError: the shape is neither definite nor a choice among definite shapes.

    """

    def of_option(option: object) -> Any:
        place = _definite(option).mesh.derived(centre_of_mass).round(_DIGITS).tolist()
        return vector(
            *(operate("multiply", *pair) for pair in zip(place, (width, length, height), strict=True))
        )

    return to_vector(per_option(shape, of_option))


def _definite(shape: object) -> Shape:
    if not isinstance(shape, Shape):
        raise ScenicTypeError(
            "`resting on` needs a shape that is known before the draw",
            span=here(),
            help="choose among shapes: `with shape Uniform(MeshShape(...), MeshShape(...))`",
        )
    return shape


def _pose(call: Call, draw: Column, width: Column, length: Column, height: Column) -> Column:
    draw, width, length, height = np.broadcast_arrays(draw, width, length, height)
    ratios = np.stack([np.ones(width.shape), length / width, height / width], axis=-1).reshape(-1, 3)
    proper = np.all((ratios > 0) & np.isfinite(ratios), axis=1, keepdims=True)  # others are refused elsewhere
    sizes = np.where(proper, ratios.astype(np.float64), 1.0).round(_DIGITS)
    mesh, is_ellipsoid = call.payload
    footing = mesh.derived(ellipsoid_footing if is_ellipsoid else hull_footing)
    result = resting_poses(footing, sizes, draw.ravel())
    result[2] *= width.ravel()
    result *= proper.T
    return quaternions.components_last(result.reshape(3, *draw.shape))


_POSE: Final = Operation(
    "stable pose", always(Kind.VECTOR), _pose, "A stable pose of a mesh, drawn by its probability."
)
