"""Operations on regions that need to know kinds of regions which stand on each other.

Here they are declared, so that the methods of any region can call them. The modules that know the kinds register how they are
carried out, by the class of the first operand: `scenic.runtime.regions.algebra` for all regions.
"""

from collections.abc import Sequence
from functools import singledispatch
from typing import Any

from scenic.graph.kinds import Column
from scenic.language.errors import InternalError
from scenic.runtime.geometry.meshes.bodies import Body

__all__ = [
    "boundary",
    "contains_region",
    "difference",
    "intersection",
    "intersects",
    "joint_field",
    "meets_bodies",
    "meshed",
    "oriented_point",
    "outline_from_above",
    "own_field",
    "part_between",
    "surface_of",
    "union",
    "voxelized",
    "world_mesh",
]


def _missing(operation: str, region: object) -> InternalError:
    return InternalError(f"no module has registered {operation} of a {type(region).__name__}")


@singledispatch
def intersection(first: object, second: object) -> Any:  # noqa: ARG001
    """The region of the points that lie in both regions."""
    raise _missing("the intersection", first)


@singledispatch
def union(first: object, second: object) -> Any:  # noqa: ARG001
    """The region of the points that lie in either region."""
    raise _missing("the union", first)


@singledispatch
def difference(first: object, second: object) -> Any:  # noqa: ARG001
    """The region of the points of the first region that do not lie in the second."""
    raise _missing("the difference", first)


@singledispatch
def intersects(first: object, second: object) -> Any:  # noqa: ARG001
    """Return whether a region shares a point with another or with an object; random where one of them is."""
    raise _missing("the meeting", first)


@singledispatch
def contains_region(first: object, second: object, tolerance: float = 0) -> bool:  # noqa: ARG001
    """Return whether a fixed region contains another, up to a tolerance in metres; raises `UnknownPairError`."""
    raise _missing("the containment", first)


@singledispatch
def meets_bodies(region: object, body: Body, lanes: int, columns: Sequence[Column]) -> Any:  # noqa: ARG001
    """Return the lanes in which a region shares a point with a body, as a mask ``(lanes,)``."""
    raise _missing("the meeting with bodies", region)


@singledispatch
def boundary(region: object) -> Any:
    """Return the outline of a region of the plane, as a line."""
    raise _missing("the boundary", region)


@singledispatch
def oriented_point(position: object, orientation: object, *, by_angles: bool = False) -> Any:  # noqa: ARG001
    """The oriented point at a place, with an orientation (`scenic.runtime.instances.objects`)."""
    raise _missing("the oriented point", position)


@singledispatch
def outline_from_above(region: object) -> Any:
    """Return a volume or surface seen from above, as a polygon at height 0."""
    raise _missing("the outline from above", region)


@singledispatch
def meshed(region: object) -> Any:
    """A box, ellipsoid or view as the volume of a mesh, with the same parameters."""
    raise _missing("the mesh", region)


@singledispatch
def joint_field(first: object, members: Sequence[object]) -> Any:  # noqa: ARG001
    """Return the preferred orientation of the union of some members, of which ``first`` is one; ``None`` if none has any."""
    raise _missing("the field", first)


@singledispatch
def own_field(region: object) -> Any:
    """Return the orientations that the points of a region have by themselves, as a vector field."""
    raise _missing("the field", region)


@singledispatch
def part_between(region: object, low: float, high: float) -> Any:  # noqa: ARG001
    """Return the part of a footprint between two heights, in metres."""
    raise _missing("the part between two heights", region)


@singledispatch
def surface_of(region: object) -> Any:
    """Return the surface of a solid, with the same parameters."""
    raise _missing("the surface", region)


@singledispatch
def voxelized(region: object, pitch: float) -> Any:  # noqa: ARG001
    """Return the cells, of an edge length in metres, that a volume touches."""
    raise _missing("the cells", region)


@singledispatch
def world_mesh(region: object) -> Any:
    """Return the mesh of a region of a body in the world, as a ``trimesh.Trimesh``."""
    raise _missing("the mesh", region)
