"""The attributes and methods of values that are not instances: vectors, orientations, regions, shapes, vector fields."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

__all__ = ["MEMBERS"]

_ALL: Final = {
    "vector": """
        altitudeTo angleTo angleWith applyRotation azimuthTo coordinates count cross distanceTo dot index
        norm normalized offsetLocally offsetRadially offsetRotated rotatedBy sphericalCoordinates toVector x
        y z
    """,
    "orientation": """
        approxEq eulerAngles fromEuler fromQuaternion getRotation globalToLocalAngles inverse localAnglesFor
        pitch q r roll toHeading toOrientation w x y yaw z
    """,
    "region": """
        AABB area boundary boundingPolygon buffer circumcircle containsObject containsPoint containsRegion
        corners difference dimensionality distanceTo end equallySpacedPoints footprint fromFile
        getSurfaceRegion getVolumeRegion height intersect intersects isConvex length mesh name
        nearestSegmentTo orient orientation pointAlongBy points pointsSeparatedBy polygons position project
        projectVector radius segments signedDistanceTo size start uniformPointIn uniformPointInner union
        unionAll voxelized width z
    """,
    "shape": """
        containsCenter dimensions height isConvex length mesh width
    """,
    "vector field": """
        at defaultStepSize followFrom forUnionOf minSteps name value valueType
    """,
}

MEMBERS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {kind: tuple(names.split()) for kind, names in _ALL.items()}
)
"""The public names by the word of the declared type. Those of regions and shapes are the names of all their kinds together."""
