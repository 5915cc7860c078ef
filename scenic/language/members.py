"""The attributes and methods of values that are not instances: vectors, orientations, regions, shapes, vector fields."""

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.types import (
    BOOLEAN,
    FIELD,
    ORIENTATION,
    ORIENTED_POINT,
    POINTS,
    REGION,
    REGIONS,
    SCALAR,
    TEXT,
    VECTOR,
    Type,
)

__all__ = ["INSTANCE_METHODS", "MEMBERS", "Member", "members_of"]


@dataclass(frozen=True, slots=True)
class Member:
    """An attribute or a method of the values of a kind.

    ``result`` is the type of its value, or of what a call returns; ``None`` if that differs or is not declared. ``takes`` are the
    types of which each argument must have one, in order, as far as they are declared; those of which values are not examined
    are empty.
    """

    name: str
    is_method: bool = False
    result: Type | None = None
    takes: tuple[tuple[Type, ...], ...] = ()


_TYPES: Final[Mapping[str, tuple[Type, ...]]] = MappingProxyType(
    {
        "any": (),
        "boolean": (BOOLEAN,),
        "field": (FIELD,),
        "orientation": (ORIENTATION,),
        "oriented": (ORIENTED_POINT,),
        "place": (VECTOR,),
        "points": (POINTS,),
        "region": (REGION,),
        "regions": (REGIONS,),
        "scalar": (SCALAR,),
        "text": (TEXT,),
        "turn": (ORIENTATION,),
        "vector": (VECTOR,),
    }
)
"""The words of the tables below."""

_ALL: Final = {
    "vector": """
        altitudeTo(vector): scalar, angleTo(vector): scalar, angleWith(vector): scalar, applyRotation(any): vector,
        azimuthTo(vector): scalar, coordinates, count(any): scalar, cross(vector): vector, distanceTo(vector): scalar,
        dot(vector): scalar, index(any): scalar, norm(): scalar, normalized(): vector, offsetLocally(turn vector): vector,
        offsetRadially(scalar turn): vector, offsetRotated(turn vector): vector, rotatedBy(turn): vector,
        sphericalCoordinates(): vector, toVector(): vector, x: scalar, y: scalar, z: scalar
    """,
    "orientation": """
        approxEq(any any): boolean, eulerAngles, fromEuler(scalar scalar scalar): orientation, fromQuaternion(any): orientation,
        getRotation(), globalToLocalAngles(scalar scalar scalar), inverse: orientation, localAnglesFor(turn), pitch: scalar, q, r,
        roll: scalar, toHeading(): scalar, toOrientation(): orientation, w: scalar, x: scalar, y: scalar, yaw: scalar, z: scalar
    """,
    "region": """
        AABB, approxBoundFootprint(any any), area: scalar, boundFootprint(any any), boundary: region, boundingPolygon,
        buffer(scalar): region, center: vector, circumcircle, closestPointTo(any): vector, cumulativeLengths, defaultOrientation(any),
        dimensions, heading, hl, hw, inradius: scalar, kdTree, lineString, onDirection, rotation, tolerance,
        containsObject(any): boolean, containsPoint(place): boolean, containsRegion(region any): boolean, corners,
        difference(region): region, dimensionality: scalar, distanceTo(place): scalar, end: oriented,
        equallySpacedPoints(scalar): points, footprint: region, fromFile(text): region, getSurfaceRegion(): region,
        getVolumeRegion(): region, height: scalar, intersect(region): region, intersects(any): boolean, isConvex: boolean,
        length: scalar, mesh, name, nearestSegmentTo(place), orient(any), orientation, pointAlongBy(scalar any): vector, points,
        pointsSeparatedBy(scalar): points, polygons, position: vector, project(place any), projectVector(place any), radius: scalar,
        segments, signedDistanceTo(place): scalar, size, start: oriented, uniformPointIn(region any), uniformPointInner(),
        union(region): region, unionAll(regions any): region, voxelized(any), width: scalar, z: scalar
    """,
    "shape": """
        containsCenter: boolean, dimensions: vector, height: scalar, isConvex: boolean, length: scalar, mesh, width: scalar
    """,
    "vector field": """
        at(place): orientation, defaultStepSize: scalar, followFrom(place scalar any any): vector, forUnionOf(regions any), minSteps,
        name, value, valueType
    """,
}

_OF_INSTANCES: Final = """
    distanceTo(place): scalar, distancePast(place): scalar, relativize(place): oriented, relativePosition(place): vector,
    containsPoint(place): boolean, intersects(any): boolean, canSee(place any): boolean
"""


def _read(table: str) -> Mapping[str, Member]:
    members = {}
    for text in table.replace("\n", " ").split(","):
        match = re.fullmatch(r"(\w+)(?:\(([\w ]*)\))?(?:: (\w+))?", " ".join(text.split()))
        if match is None:
            raise ValueError(f"not a member: {text!r}")
        name, parameters, result = match.groups()
        types = _TYPES.get(result or "any", ())
        takes = tuple(_TYPES[each] for each in (parameters or "").split())
        members[name] = Member(name, parameters is not None, types[0] if types else None, takes)
    return MappingProxyType(members)


MEMBERS: Final[Mapping[str, Mapping[str, Member]]] = MappingProxyType(
    {kind: _read(table) for kind, table in _ALL.items()}
)
"""The public members by the word of the declared type. Those of regions and shapes are those of all their kinds together."""

INSTANCE_METHODS: Final[Mapping[str, Member]] = _read(_OF_INSTANCES)
"""The methods of points and objects that take arguments; `scenic.language.properties` declares all of their attributes."""


def members_of(kind: str) -> Mapping[str, Member]:
    """Return the members of the values of a kind; none if they are not declared."""
    return MEMBERS.get("region" if kind == "workspace" else kind, MappingProxyType({}))
