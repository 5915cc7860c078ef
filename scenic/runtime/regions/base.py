"""What every region can do.

A region is a fixed kind of shape with parameters (a centre, a radius), each definite or random. Its geometry is written
once, over columns of those parameters; from that come the answers to programs (`containsPoint` on values), the
requirement nodes that the sampler tests in batches, and the points that specifiers draw.
"""

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import InvalidScenarioError, ScenicTypeError, UnsupportedError
from scenic.runtime.context import here
from scenic.runtime.geometry.collision import Body, Poses
from scenic.runtime.values import apply, is_random, to_scalar, to_vector, vector

Points = NDArray[np.float64]
Mask = NDArray[np.bool_]


class Region(ABC):
    """A set of points in space.

    Subclasses set ``parameters`` (values, definite or random) and implement the geometry over their columns.
    """

    scenic_kind: ClassVar[Kind] = Kind.REGION
    dimension: float
    """0 for points to 3 for volumes; infinite for all of space."""
    has_orientation: bool = False
    """Whether every point has a preferred orientation."""

    def __init__(self, *parameters: Any, name: str | None = None) -> None:
        self.parameters: tuple[Any, ...] = parameters
        self.name = name

    # Geometry over columns; ``columns`` are those of ``parameters``.

    @abstractmethod
    def contains_points(self, points: Points, *columns: Column) -> Mask:
        """Which points ``(n, 3)`` lie in the region, shape ``(n,)``."""

    @abstractmethod
    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """In which lanes the whole body lies in the region, shape ``(lanes,)``."""

    # Values for programs and specifiers

    @abstractmethod
    def uniform_placement(self) -> tuple[Any, Any]:
        """A uniform random point, and its preferred orientation (``None`` if the region has none)."""

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        """The point of the region where ``point`` lands along ``direction``, and its preferred orientation.

        ``direction`` is ``None`` where the object does not say. Raises `ScenicTypeError` for regions on which
        nothing lands.
        """
        raise ScenicTypeError(
            f"nothing can be placed `on` a {type(self).__name__} by projection", span=here()
        )

    def distance_from(self, point: Any) -> Any:
        """Distance from a point to the nearest point of the region, in metres; 0 inside."""
        return apply(_DISTANCE, to_vector(point), *self.parameters, payload=self)

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        """Distances of points ``(n, 3)`` from the region, shape ``(n,)``."""
        raise unsupported(f"the distance to a {type(self).__name__}")

    @property
    def is_random(self) -> bool:
        """Whether some parameter is random."""
        return is_random(self.parameters)

    @property
    def footprint(self) -> "Region":
        """The region of all points above and below this one; the region itself where it is 3D."""
        return self

    def containsPoint(self, point: Any) -> Any:
        """Whether a point lies in the region: true or false, or a random truth value."""
        return apply(_CONTAINS_POINT, to_vector(point), *self.parameters, payload=self)

    def containsObject(self, thing: Any) -> Any:
        """Whether the region holds the whole of an object."""
        return apply(_CONTAINS_BODY, *body_operands(thing), *self.parameters, payload=self)

    def distanceTo(self, point: Any) -> Any:
        """Distance from a point to the nearest point of the region, in metres."""
        return self.distance_from(point)

    def intersects(self, other: Any) -> Any:
        """Whether the region shares a point with another or with an object: not built yet."""
        raise unsupported(f"`intersects` of a {type(self).__name__}")

    def containsRegion(self, other: Any, tolerance: float = 0) -> Any:
        """Whether the region holds another: not built yet."""
        raise unsupported("`containsRegion`")

    def intersect(self, other: Any) -> Any:
        """The points that lie in both regions: not built yet."""
        raise unsupported("the intersection of regions")

    def union(self, other: Any) -> Any:
        """The points that lie in either region: not built yet."""
        raise unsupported("the union of regions")

    def difference(self, other: Any) -> Any:
        """The points that do not lie in the other region: not built yet."""
        raise unsupported("the difference of regions")

    @property
    def AABB(self) -> Any:
        """The bounding box along the global axes: not built yet."""
        raise unsupported("`AABB`")

    def __contains__(self, item: Any) -> Any:
        return self.containsObject(item) if hasattr(item, "occupiedSpace") else self.containsPoint(item)

    def __repr__(self) -> str:
        return self.name or f"<{type(self).__name__}>"


def _contains_point(call: Call, points: Points, *columns: Column) -> Column:
    return np.asarray(call.payload.contains_points(points, *columns), dtype=np.bool_)


_CONTAINS_POINT = Operation(
    "region contains point", always(Kind.BOOLEAN), _contains_point, "Whether a region holds a point."
)


def _distances(call: Call, points: Points, *columns: Column) -> Column:
    distances: Column = call.payload.distances(points, *columns)
    return distances


_DISTANCE = Operation(
    "distance to region", always(Kind.SCALAR), _distances, "Distance from a point to a region."
)


def body_operands(thing: Any) -> tuple[Any, Any, Any, Any]:
    """Position, orientation, size and shape of an object: the operands of operations on its body."""
    size = vector(to_scalar(thing.width), to_scalar(thing.length), to_scalar(thing.height))
    return thing.position, thing.orientation, size, thing.shape


def body_of(position: Column, orientation: Column, size: Column, shape: Column) -> Body:
    """The body of an object over lanes, from the columns of `body_operands`."""
    poses = Poses(position, orientation, size)
    if len(shape) == 1:
        return Body((shape[0].mesh,), None, poses)
    meshes: dict[int, int] = {}
    kinds: list[Any] = []
    choice = np.empty(len(shape), dtype=np.intp)
    for lane, item in enumerate(shape):
        key = id(item)
        if key not in meshes:
            meshes[key] = len(kinds)
            kinds.append(item.mesh)
        choice[lane] = meshes[key]
    return Body(tuple(kinds), choice, poses)


def _contains_body(
    call: Call, position: Column, orientation: Column, size: Column, shape: Column, *columns: Column
) -> Column:
    lanes = max(len(column) for column in (position, orientation, size, shape, *columns))
    body = body_of(position, orientation, size, shape)
    return np.asarray(call.payload.contains_bodies(body, lanes, *columns), dtype=np.bool_)


_CONTAINS_BODY = Operation(
    "region contains object", always(Kind.BOOLEAN), _contains_body, "Whether a region holds a whole object."
)


class Everywhere(Region):
    """All of space."""

    dimension = np.inf

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return np.ones(len(points), dtype=np.bool_)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.ones(lanes, dtype=np.bool_)

    def uniform_placement(self) -> tuple[Any, Any]:
        raise InvalidScenarioError(
            "no point can be drawn uniformly from all of space",
            span=here(),
            help="draw from a bounded region, or set `workspace = Workspace(region)`",
        )

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return np.zeros(len(points))

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        return point, None


class Nowhere(Region):
    """The empty region."""

    dimension = 0

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return np.zeros(len(points), dtype=np.bool_)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.zeros(lanes, dtype=np.bool_)

    def uniform_placement(self) -> tuple[Any, Any]:
        raise InvalidScenarioError("no point can be drawn from the empty region", span=here())


everywhere = Everywhere(name="everywhere")
nowhere = Nowhere(name="nowhere")


class Workspace(Region):
    """The region in which everything takes place; delegates to the region it is made of."""

    dimension: float

    def __init__(self, region: Any = everywhere, *, name: str | None = None) -> None:
        if not isinstance(region, Region):
            raise ScenicTypeError(f"a workspace is made of a region, not of {region!r}", span=here())
        if region.is_random:
            raise InvalidScenarioError("the workspace's region must be fixed", span=here())
        super().__init__(*region.parameters, name=name)
        self.region = region
        self.has_orientation = region.has_orientation
        self.dimension = region.dimension

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return self.region.contains_points(points, *columns)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return self.region.contains_bodies(body, lanes, *columns)

    def uniform_placement(self) -> tuple[Any, Any]:
        return self.region.uniform_placement()

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        return self.region.project(point, direction)

    @property
    def footprint(self) -> Region:
        return self.region.footprint

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "region":
            raise AttributeError(name)
        return getattr(self.region, name)


def unsupported(what: str) -> UnsupportedError:
    """The refusal of a region or function that this version does not build."""
    return UnsupportedError(
        f"{what} is not supported yet", span=here(), help="see the list of what works in the README"
    )


__all__ = [
    "Everywhere",
    "Mask",
    "Nowhere",
    "Points",
    "Region",
    "Workspace",
    "body_of",
    "body_operands",
    "everywhere",
    "nowhere",
    "unsupported",
]
