"""Regions made of members, whatever joins these; `scenic.runtime.regions.combinations` has the kinds (section 9.4 of the specification).

These are the general forms, for members of any kind with parameters of any kind; what has a closed form is found by
`scenic.runtime.regions.algebra`. A point is drawn from a member until one lies in the region.
"""

from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from functools import reduce
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from scenic.graph.bounds import Bounds
from scenic.graph.draws import mix, open_unit
from scenic.graph.kinds import Column
from scenic.language.errors import UndefinedSamplingException
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.geometry.containment.body_containment import extreme_corners
from scenic.runtime.geometry.meshes import polytopes
from scenic.runtime.ground.context import here
from scenic.runtime.regions import generic
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.choice import RegionChoice
from scenic.runtime.regions.flat import Flat, load_library, rows_of, upright_boxes
from scenic.runtime.regions.one_lane import in_lane
from scenic.runtime.regions.planar import Footprint, PlanarRegion
from scenic.runtime.regions.spaces import Workspace

TRIES: Final = 2_000
"""Draws of one point before a region counts as empty in a lane."""

_TOGETHER: Final = 1 << 12
"""Draws that are looked at together, at most."""

PROBES: Final = 8
"""Vertices of a body that are looked at before the union of its lane is made."""

LEVEL: Final = 1e-6
"""Metres within which a point counts as being at the height of a region of the plane."""


_Part = TypeVar("_Part")


class Composite(Region):
    """A region made of members.

    Args:
        members: the regions.
        orientation: a vector field in the place of what the members prefer.
        name: for messages.

    """

    draws = 1
    may_find_none = True

    def __init__(self, *members: Region, orientation: object = None, name: str | None = None) -> None:
        super().__init__(*(value for member in members for value in member.parameters), name=name)
        self.members = members
        self.tolerance = max(member.tolerance for member in members)
        if self.is_random and is_flat(self):
            load_library()
        self._field = orientation
        self.has_orientation, self.orientation = orientation is not None, orientation

    @property
    def regions(self) -> tuple[Region, ...]:
        """The members."""
        return self.members

    def _parts(self, columns: Sequence[_Part]) -> Iterator[tuple[Region, Sequence[_Part]]]:
        first = 0
        for member in self.members:
            count = len(member.parameters)
            yield member, columns[first : first + count]
            first += count

    def sampled(self, sample: Any) -> Region:
        """The region of one sample, in closed form where it has one."""
        members = [member.sampled(sample) for member in self.members]
        field = sample.value(self._field)
        if field is self._field and all(new is old for new, old in zip(members, self.members, strict=True)):
            return self
        if field is not None:
            return type(self)(*members, orientation=field, name=self.name)
        return self.combined(members)

    def in_lane(self, lane: int, columns: Sequence[Column]) -> Region:
        """Return the region at the values of one lane, in closed form where it has one."""
        return in_lane(self, lane, columns)

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        """Return the distances to the nearest point of a member where that decides, elsewhere to what is left of the plane in each lane.

        Lanes with neither get the distance of their closed form. Raises `UnsupportedError` where there is none, as with points
        and lines.
        """
        lanes = max(len(points), *map(len, columns), 1)
        points = np.broadcast_to(points, (lanes, 3))
        result = self.decided(points, columns)
        left = np.flatnonzero(np.isnan(result))
        if not len(left):
            return result
        mine = rows_of(columns, left)
        flat = self.from_above(*mine)
        if flat is not None:
            result[left] = flat.distances(points[left])
            return result
        solid = self.solid_distances(points[left], mine)
        if solid is not None:
            result[left] = solid
            return result
        if not self.is_random:
            return super().distances(points, *columns)
        for lane in left.tolist():
            region = self.in_lane(lane, columns)
            place = points[lane : lane + 1]
            result[lane] = region.distances(place, *region.fixed_columns("the distance"))[0]
        return result

    def solid_distances(self, points: Points, columns: Sequence[Column]) -> NDArray[np.float64] | None:
        """The distances ``(n,)`` of points from what is left of convex solids with few faces; ``None`` for others."""
        return None

    def decided(self, points: Points, columns: Sequence[Column]) -> NDArray[np.float64]:
        """Return the distances ``(n,)`` that members decide; not a number where none does."""
        return np.full(len(points), np.nan)

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Return a mask of the lanes in which the body meets the region: by probes of the body, or by
        outlines for regions of the plane.
        """
        result = np.array(np.broadcast_to(self.may_meet(body, lanes, columns), lanes))
        left = np.flatnonzero(result)
        if not len(left):
            return result
        rest = left[~self._meets_surely(body, left, rows_of(columns, left))]
        if len(rest):
            mine = rows_of(columns, rest)
            flat = self.from_above(*mine)
            if flat is not None:
                result[rest] = flat.meets(body, rest)
            else:
                result[rest] = self._meets_solidly(body, rest, columns)
        return result

    @abstractmethod
    def may_meet(self, body: Body, lanes: int, columns: Sequence[Column]) -> Mask:
        """Return a mask of the lanes in which the members do not rule out that a body meets the region, ``(lanes | 1,)``."""

    def _meets_surely(self, body: Body, lanes: NDArray[np.intp], columns: Sequence[Column]) -> Mask:
        """Return the mask of those of some lanes, whose columns these are, in which a known point of the body lies in the region."""
        if not is_flat(self):
            is_inside: Mask = np.zeros(len(lanes), dtype=np.bool_)
            for points in _known_points(body, lanes):
                is_inside |= exactly_contains(self, points, columns)
            return is_inside
        level = next((m.heights(*c) for m, c in _leaves(self, columns) if isinstance(m, PlanarRegion)), None)
        height = None if level is None else np.broadcast_to(level, len(lanes))
        every = np.arange(len(lanes))
        boxes, rectangles = upright_boxes(body.take(lanes), every, height)
        places = np.concatenate([rectangles.centre[:, np.newaxis], rectangles.corners()], axis=1)
        is_inside = np.zeros(len(lanes), dtype=np.bool_)
        for number in range(places.shape[1]):
            points = np.zeros((len(lanes), 3))
            points[:, :2] = places[:, number]
            if height is not None:
                points[:, 2] = height
            is_inside |= exactly_contains(self, points, columns)
        return is_inside & boxes

    def _meets_solidly(self, body: Body, lanes: NDArray[np.intp], columns: Sequence[Column]) -> Mask:
        """Return the mask of those of some lanes in which what is left of solids meets the body.

        Bodies and members that are not convex, or have many faces, are combined exactly, one lane after the other.
        """
        part, mine = body.take(lanes), rows_of(columns, lanes)
        result = np.zeros(len(lanes), dtype=np.bool_)
        for mesh, lanes_of_mesh in part.by_mesh(len(lanes)):
            rows_of_mesh = rows_of(mine, lanes_of_mesh)
            poses = part.poses.take(lanes_of_mesh)
            planes = polytopes.half_spaces(mesh, poses)
            meeting = (
                None if planes is None else self.meets_polytopes(planes, len(lanes_of_mesh), rows_of_mesh)
            )
            if meeting is None:
                alone = Body((mesh,), None, poses)
                meeting = generic.meets_bodies(self, alone, len(lanes_of_mesh), rows_of_mesh)
            result[lanes_of_mesh] = meeting
        return result

    def meets_polytopes(self, planes: Column, lanes: int, columns: Sequence[Column]) -> Mask | None:
        """The mask of polytopes ``(n | 1, k, 4)`` that meet the region; ``None`` unless its members are convex and have few faces."""
        return None

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return self._box_of([member.extent(*mine) for member, mine in self._parts(parameters)])

    def container_extent(self, *parameters: Bounds | None) -> Bounds | None:
        """Combine the extents of the members as containers: a member in the plane contains the space above and below it."""
        return self._box_of([member.container_extent(*mine) for member, mine in self._parts(parameters)])

    @abstractmethod
    def _box_of(self, boxes: Sequence[Bounds | None]) -> Bounds | None:
        """Return the box of the region from those of its members."""

    @abstractmethod
    def combined(self, members: Sequence[Region]) -> Region:
        """Return the same combination of other members."""

    def members_that_hold(self, points: Points, columns: Sequence[Column]) -> list[Mask]:
        """Return for each member a mask of the points that lie in it; of regions of the plane also at its height."""
        return [exactly_contains(member, points, mine) for member, mine in self._parts(columns)]

    @abstractmethod
    def joined(self, inside: Sequence[Mask]) -> Mask:
        """The mask of points that lie in the region, from those of its members."""

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return self.joined([member.contains_points(points, *mine) for member, mine in self._parts(columns)])

    @abstractmethod
    def _accept(self, points: Points, inside: Sequence[Mask], chosen: NDArray[np.intp], dice: Column) -> Mask:
        """Return a mask of the draws to keep; draw i comes from member ``chosen[i]``."""

    @abstractmethod
    def _sources(self, columns: Sequence[Column]) -> tuple[list[int], NDArray[np.float64]]:
        """The members to draw from, with weights ``(members, n | 1)``."""

    def _boxes_of_draws(
        self, sources: Sequence[int], columns: Sequence[Column]
    ) -> tuple[Points, Points] | None:
        """Return boxes ``(n | 1, 3)`` outside of which no draw is accepted; ``None`` where nothing is known."""
        return None

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        lanes = uniforms.shape[1]
        sources, weights = self._sources(columns)
        sums = np.cumsum(np.broadcast_to(weights, (len(sources), lanes)), axis=0)
        points = np.zeros((lanes, 3))
        has_point = np.zeros(lanes, dtype=np.bool_)
        words = np.broadcast_to(np.asarray(keys, dtype=np.uint64), lanes)
        parts = list(self._parts(columns))
        boxes = self._boxes_of_draws(sources, columns)
        empty = np.zeros(lanes, dtype=np.bool_)
        first = 0
        while first < TRIES and len(missing := np.flatnonzero(~has_point & ~empty)):
            # The first attempt that is kept counts, so looking at several at once changes nothing. They become more as lanes
            # turn out to find it hard.
            count = min(max(first, 1), TRIES - first, max(_TOGETHER // len(missing), 1))
            lane = np.repeat(missing, count)
            attempts = np.tile(np.arange(first, first + count, dtype=np.uint64), len(missing))
            seeds = mix(words[lane] ^ (attempts + np.uint64(1)))
            choice = uniforms[0, missing] if first == 0 else open_unit(mix(seeds))
            total = sums[:, lane]
            source_numbers = (choice * total[-1] >= total).sum(axis=0).clip(0, len(sources) - 1)
            candidates = np.zeros((len(lane), 3))
            is_point = np.zeros(len(lane), dtype=np.bool_)
            for number, source in enumerate(sources):
                mine = np.flatnonzero(source_numbers == number)
                if not len(mine):
                    continue
                member, all_columns = parts[source]
                some = [column if len(column) == 1 else column[lane[mine]] for column in all_columns]
                fresh = (
                    np.stack(
                        [open_unit(mix(seeds[mine] + np.uint64(17 + axis))) for axis in range(member.draws)]
                    )
                    if member.draws
                    else np.empty((0, len(mine)))
                )
                words_of_mine = mix(seeds[mine] + np.uint64(3))
                if boxes is None:
                    candidates[mine], present = member.draw_points(fresh, words_of_mine, *some)
                else:
                    corners = [corner if len(corner) == 1 else corner[lane[mine]] for corner in boxes]
                    corners = [np.broadcast_to(corner, (len(mine), 3)) for corner in corners]
                    candidates[mine], present = member.draw_points_in(*corners, fresh, words_of_mine, *some)
                    if present is not None and len(sources) == 1:
                        empty[lane[mine[~present]]] = True
                is_point[mine] = True if present is None else present
            rows = [column if len(column) == 1 else column[lane] for column in columns]
            accepted_lanes = is_point & self._accept(
                candidates,
                self.members_that_hold(candidates, rows),
                source_numbers,
                open_unit(mix(seeds + np.uint64(5))),
            )
            kept_by_lane = accepted_lanes.reshape(len(missing), count)
            lucky = np.flatnonzero(kept_by_lane.any(axis=1))
            points[missing[lucky]] = candidates[lucky * count + kept_by_lane[lucky].argmax(axis=1)]
            has_point[missing[lucky]] = True
            first += count
        return points, has_point

    def uniform_placement(self) -> tuple[Any, Any]:
        if not any(np.isfinite(member.dimension) and member.dimension >= 0 for member in self.members):
            raise UndefinedSamplingException("no point can be drawn from an unbounded region", span=here())
        return super().uniform_placement()

    def orientation_at(self, point: object) -> Any:
        if self.orientation is not None:
            return self.orientation[point]
        for member in self.members:
            if member.has_orientation:
                return member.orientation_at(point) if self.has_orientation else None
        return None


def levelled(region: Composite, points: Points, columns: Sequence[Column]) -> Points:
    """Points at the height of the first member of the plane, where there is one."""
    for leaf, mine in _leaves(region, columns):
        if isinstance(leaf, PlanarRegion):
            points = np.array(points)
            points[:, 2] = leaf.heights_at(points, *mine)
            break
    return points


def join_flats(join: Callable[[Flat, Flat], Flat | None], parts: Sequence[Flat | None]) -> Flat | None:
    """Join geometries of members one after the other; ``None`` where one has none."""
    result = parts[0]
    for part in parts[1:]:
        if result is None or part is None:
            return None
        result = join(result, part)
    return result


# Masks and columns of members are combined two by two, as `reduce` does: some may have a single row, and others one for each lane.
def all_of(masks: Sequence[Mask]) -> Mask:
    return np.asarray(reduce(np.logical_and, masks), dtype=np.bool_)


def any_of(masks: Sequence[Mask]) -> Mask:
    return np.asarray(reduce(np.logical_or, masks), dtype=np.bool_)


def exactly_contains(region: Region, points: Points, columns: Sequence[Column]) -> Mask:
    """The mask of points that lie in a region, with their heights where it lies in a plane, or is made of such as do."""
    if isinstance(region, Workspace):
        return exactly_contains(region.region, points, columns)
    if isinstance(region, Composite):
        return np.broadcast_to(region.joined(region.members_that_hold(points, columns)), len(points))
    if isinstance(region, RegionChoice):
        is_inside = np.zeros(len(points), dtype=np.bool_)
        for option, lanes_of_option, mine in region.drawn(len(points), columns):
            is_inside[lanes_of_option] = exactly_contains(option, points[lanes_of_option], mine)
        return is_inside
    inside = region.contains_points(points, *columns)
    if isinstance(region, PlanarRegion):
        inside = inside & (np.abs(points[:, 2] - region.heights_at(points, *columns)) <= LEVEL)
    return np.broadcast_to(inside, len(points))


def _leaves(region: Region, columns: Sequence[_Part]) -> Iterator[tuple[Region, Sequence[_Part]]]:
    """Yield the members of members, with their columns."""
    if isinstance(region, Composite):
        for member, mine in region._parts(columns):
            yield from _leaves(member, mine)
    else:
        yield region, columns


def is_flat(region: Region) -> bool:
    """Return whether all leaves lie in planes or are columns."""
    return all(
        isinstance(leaf, PlanarRegion | Footprint) and leaf.has_closed_form
        for leaf, _ in _leaves(region, region.parameters)
    )


def _known_points(body: Body, lanes: NDArray[np.intp]) -> Iterator[Points]:
    """Points ``(n, 3)`` that bodies hold for certain, in some lanes: extreme corners, and middles of convex ones."""
    part, count = body.take(lanes), len(lanes)
    points_of_mesh = []
    for mesh in body.meshes:
        corners = extreme_corners(mesh)
        first = mesh.vertices.mean(axis=0) if mesh.is_convex else corners[0]
        points_of_mesh.append(np.concatenate([first[np.newaxis], corners]))
    for number in range(1 + min(PROBES, max(map(len, points_of_mesh)) - 1)):
        points = np.empty((count, 3))
        for mesh, lanes_of_mesh in part.by_mesh(count):
            mine = points_of_mesh[body.meshes.index(mesh)]
            place = mine[min(number, len(mine) - 1)]
            points[lanes_of_mesh] = part.poses.take(lanes_of_mesh).to_world(place[np.newaxis, np.newaxis])[
                :, 0
            ]
        yield points
