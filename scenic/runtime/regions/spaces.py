"""All of space, none of it, and the workspace."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.graph.kinds import Column
from scenic.language.errors import InvalidScenarioError, RejectionException, ScenicTypeError
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.geometry.patches import Patch
from scenic.runtime.ground.context import here
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.flat import Flat
from scenic.runtime.regions.scalar_regions import Single


class Everywhere(Region):
    """All of space."""

    dimension = np.inf

    def __init__(self, name: str | None = None) -> None:
        super().__init__(name=name)

    def __repr__(self) -> str:
        return self.name or "everywhere"

    __str__ = __repr__

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return np.ones(len(points), dtype=np.bool_)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.ones(lanes, dtype=np.bool_)

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.ones(lanes, dtype=np.bool_)

    def sizes(self, *columns: Column) -> NDArray[np.float64]:
        return np.full(1, np.inf)

    def uniform_placement(self) -> tuple[Any, Any]:
        raise InvalidScenarioError(
            "no point can be drawn uniformly from all of space",
            span=here(),
            help="draw from a bounded region, or set `workspace = Workspace(region)`",
        )

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return np.zeros(len(points))

    def project(self, point: object, direction: object) -> tuple[Any, Any]:
        return point, None


class Nowhere(Region):
    """The empty region."""

    dimension = 0
    may_find_none = True

    def __init__(self, name: str | None = None) -> None:
        super().__init__(name=name)

    def __repr__(self) -> str:
        return self.name or "nowhere"

    __str__ = __repr__

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return np.zeros(len(points), dtype=np.bool_)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.zeros(lanes, dtype=np.bool_)

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.zeros(lanes, dtype=np.bool_)

    def sizes(self, *columns: Column) -> NDArray[np.float64]:
        return np.zeros(1)

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return np.full(len(points), np.inf)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        lanes = uniforms.shape[1]
        return np.zeros((lanes, 3)), np.zeros(lanes, dtype=np.bool_)

    def uniformPointInner(self) -> Any:
        raise RejectionException("no point can be drawn from the empty region")

    def project(self, point: object, direction: object) -> tuple[Any, Any]:
        raise InvalidScenarioError("nothing lands on the empty region", span=here())

    def uniform_placement(self) -> tuple[Any, Any]:
        raise InvalidScenarioError("no point can be drawn from the empty region", span=here())


everywhere = Everywhere(name="everywhere")
nowhere = Nowhere(name="nowhere")


class Workspace(Region):
    """The region in which everything takes place; delegates to the region it is made of."""

    dimension: float

    def __init__(self, region: object = everywhere, *, name: str | None = None) -> None:
        if not isinstance(region, Region):
            raise ScenicTypeError(f"a workspace is made of a region, not of {region!r}", span=here())
        if region.is_random:
            raise InvalidScenarioError(
                "the workspace's region must be fixed",
                span=here(),
                help="for a random place use `with regionContainedIn`, or `in` the region",
            )
        super().__init__(*region.parameters, name=name)
        self.region = region
        self.has_orientation, self.orientation = region.has_orientation, region.orientation
        self.dimension = region.dimension
        self.draws, self.may_find_none, self.tolerance = region.draws, region.may_find_none, region.tolerance

    def patches(self, places: Points) -> tuple[Patch, ...]:
        """Return the areas that pictures show under objects at places ``(n, 3)``: here none."""
        return ()

    def single(self) -> Single | None:
        return self.region.at_once

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return self.region.contains_points(points, *columns)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return self.region.contains_bodies(body, lanes, *columns)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        return self.region.draw_points(uniforms, keys, *columns)

    def orientations(self, points: Points, *columns: Column) -> Column:
        return self.region.orientations(points, *columns)

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return self.region.meets_bodies(body, lanes, *columns)

    def from_above(self, *columns: Column) -> Flat | None:
        return self.region.from_above(*columns)

    def nearest(self, points: Points, *columns: Column) -> Points | None:
        return self.region.nearest(points, *columns)

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return self.region.distances(points, *columns)

    def gaps(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return self.region.gaps(points, *columns)

    def lie_farther(self, points: Points, limits: Column, *columns: Column) -> Mask:
        return self.region.lie_farther(points, limits, *columns)

    def depths(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return self.region.depths(points, *columns)

    def box(self, *columns: Column) -> tuple[Points, Points]:
        return self.region.box(*columns)

    def container_box(self, *columns: Column) -> tuple[Points, Points]:
        return self.region.container_box(*columns)

    def sizes(self, *columns: Column) -> NDArray[np.float64]:
        return self.region.sizes(*columns)

    def uniform_placement(self) -> tuple[Any, Any]:
        return self.region.uniform_placement()

    def project(self, point: object, direction: object) -> tuple[Any, Any]:
        return self.region.project(point, direction)

    @property
    def footprint(self) -> Region:
        return self.region.footprint

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "region":
            raise AttributeError(name)
        return getattr(self.region, name)


__all__ = ["Everywhere", "Nowhere", "Workspace", "everywhere", "nowhere"]
