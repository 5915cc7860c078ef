"""The field of a region: the orientations that its points have by themselves."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.graph import quaternions
from scenic.graph.kinds import Kind
from scenic.language.errors import ScenicValueError
from scenic.runtime.regions.base import Points, Region
from scenic.runtime.regions.fields import VectorField, steps_of
from scenic.runtime.values.lane_methods import MethodLanes, over_lanes
from scenic.runtime.values.lazy import Lazy, defer
from scenic.runtime.values.values import is_random, to_scalar, to_vector

__all__ = ["RegionField", "way_given"]


def _is_fixed(region: Region) -> bool:
    """Return whether a region's `orientations` are what `orientation_asked` gives, and depend on no parameter."""
    own = type(region)
    return (
        not region.parameters
        and own.orientation_asked is Region.orientation_asked
        and own.own_orientation is Region.own_orientation
    )


def way_given(
    position: object, distance: object, steps: Any, size: Any
) -> tuple[tuple[Any, Any], tuple[int | None, float | None]] | None:
    """Return the operands of a way along a field, for `over_lanes`."""
    if is_random((steps, size)):
        return None
    place, length = to_vector(position, "`follow ... from`"), to_scalar(distance, "`follow ... for`")
    return (place, length), (steps, size)


class RegionField(VectorField):
    """The orientations that the points of a region have by themselves: along a line, across a surface."""

    def __init__(self, region: Any) -> None:
        self.region = region
        super().__init__(f"orientation of {region!r}", region.own_orientation)

    def _asked(self) -> dict[str, Any]:
        return {}

    @over_lanes(
        Kind.ORIENTATION,
        lambda position: ((to_vector(position, "a place in a field"),), None),
        lambda _lanes, field, _setting, points: field.region.orientations(points),
        qualifies=lambda field: _is_fixed(field.region),
        alone=False,
    )
    def __getitem__(self, position: Any) -> Any:
        place = to_vector(position, f"field {self.name!r}")
        if isinstance(place, Lazy):
            return defer(self.__getitem__, place)
        return self.region.orientation_asked(place)

    @over_lanes(
        Kind.VECTOR,
        lambda position, distance, steps=None, stepSize=None: way_given(position, distance, steps, stepSize),
        lambda lanes, field, setting, points, distances: field.follow_together(
            lanes, setting, points, distances
        ),
        qualifies=lambda field: _is_fixed(field.region),
        faults=True,
    )
    def followFrom(
        self, position: object, distance: object, steps: int | None = None, stepSize: float | None = None
    ) -> Any:
        return super().followFrom(position, distance, steps, stepSize)

    def follow_together(
        self,
        lanes: MethodLanes,
        setting: tuple[int | None, float | None],
        points: Points,
        distances: NDArray[np.float64],
    ) -> Points:
        """The ends ``(n, 3)`` of ways from points ``(n, 3)`` for distances ``(n,)``; see `followFrom`."""
        steps, size = setting
        law = (steps, self.minSteps, self.defaultStepSize if size is None else size)
        counts = np.zeros(len(points), dtype=np.int64)
        for lane, distance in enumerate(distances.tolist()):
            try:
                counts[lane] = steps_of(distance, law)
            except ScenicValueError as endless:
                lanes.fault(lane, endless)
        place, stride = np.array(points), np.zeros((len(points), 3))
        stride[:, 1] = distances / np.maximum(counts, 1)
        for step in range(int(counts.max(initial=0))):
            moving = np.flatnonzero(step < counts)
            turns = self.region.orientations(place[moving])
            place[moving] += quaternions.rotate(turns, stride[moving])
        return place
