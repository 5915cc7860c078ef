"""Regions made of others: what lies in all of them, in any, or in one and not in another (section 9.4 of the specification).

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
from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.runtime.geometry import polytopes
from scenic.runtime.geometry.collision import Body
from scenic.runtime.geometry.containment import extreme_corners
from scenic.runtime.program.context import here
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.choice import RegionChoice
from scenic.runtime.regions.flat import Flat, load_library, rows_of, upright_boxes
from scenic.runtime.regions.nearness import hull_of
from scenic.runtime.regions.planar import Footprint, PlanarRegion
from scenic.runtime.regions.spaces import Workspace

TRIES: Final = 2_000
"""Draws of one point before a region counts as empty in a lane."""

_TOGETHER: Final = 1 << 12
"""Draws that are looked at together, at most."""

_PROBES: Final = 8
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

    def __init__(self, *members: Region, orientation: Any = None, name: str | None = None) -> None:
        super().__init__(*(value for member in members for value in member.parameters), name=name)
        self.members = members
        self.tolerance = max(member.tolerance for member in members)
        if self.is_random and _is_flat(self):
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
        """The region at the values of one lane, in closed form where it has one."""
        region: Region = self.algebra.in_lane(self, lane, columns)
        return region

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        """By members where the nearest point of one decides, elsewhere by what is left of the plane in each lane.

        What has neither has the distance of the closed form of the lane; `UnsupportedError` where there is none, as with
        points and lines.
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
        """The distances ``(n,)`` that members decide; not a number where none does."""
        return np.full(len(points), np.nan)

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Where probes of the body lie in the region, or what is left of the plane in a lane meets its outline."""
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
        """In which lanes the members do not rule out that a body meets the region, ``(lanes | 1,)``."""

    def _meets_surely(self, body: Body, lanes: NDArray[np.intp], columns: Sequence[Column]) -> Mask:
        """In which of some lanes, whose columns these are, a known point of the body lies in the region."""
        if not _is_flat(self):
            held: Mask = np.zeros(len(lanes), dtype=np.bool_)
            for points in _known_points(body, lanes):
                held |= exactly_contains(self, points, columns)
            return held
        level = next((m.heights(*c) for m, c in _leaves(self, columns) if isinstance(m, PlanarRegion)), None)
        height = None if level is None else np.broadcast_to(level, len(lanes))
        every = np.arange(len(lanes))
        boxes, rectangles = upright_boxes(body.take(lanes), every, height)
        places = np.concatenate([rectangles.centre[:, np.newaxis], rectangles.corners()], axis=1)
        held = np.zeros(len(lanes), dtype=np.bool_)
        for number in range(places.shape[1]):
            points = np.zeros((len(lanes), 3))
            points[:, :2] = places[:, number]
            if height is not None:
                points[:, 2] = height
            held |= exactly_contains(self, points, columns)
        return held & boxes

    def _meets_solidly(self, body: Body, lanes: NDArray[np.intp], columns: Sequence[Column]) -> Mask:
        """In which of some lanes what is left of solids meets the body.

        Bodies and members that are not convex, or have many faces, are combined exactly, one lane after the other.
        """
        part, mine = body.take(lanes), rows_of(columns, lanes)
        result = np.zeros(len(lanes), dtype=np.bool_)
        for mesh, chosen in part.by_mesh(len(lanes)):
            own = rows_of(mine, chosen)
            poses = part.poses.take(chosen)
            planes = polytopes.half_spaces(mesh, poses)
            met = None if planes is None else self.meets_polytopes(planes, len(chosen), own)
            if met is None:
                alone = Body((mesh,), None, poses)
                met = self.algebra.meets_bodies(self, alone, len(chosen), own)
            result[chosen] = met
        return result

    def meets_polytopes(self, planes: Column, lanes: int, columns: Sequence[Column]) -> Mask | None:
        """Which polytopes ``(n | 1, k, 4)`` meet the region; ``None`` unless its members are convex and have few faces."""
        return None

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return self._box_of([member.extent(*mine) for member, mine in self._parts(parameters)])

    def container_extent(self, *parameters: Bounds | None) -> Bounds | None:
        """Of the members as containers: one in the plane holds what is above and below it, others do not."""
        return self._box_of([member.container_extent(*mine) for member, mine in self._parts(parameters)])

    @abstractmethod
    def _box_of(self, boxes: Sequence[Bounds | None]) -> Bounds | None:
        """The box of the region from those of its members."""

    @abstractmethod
    def combined(self, members: Sequence[Region]) -> Region:
        """The same combination of other members."""

    def members_that_hold(self, points: Points, columns: Sequence[Column]) -> list[Mask]:
        """For each member, which points lie in it; of regions of the plane also at its height."""
        return [exactly_contains(member, points, mine) for member, mine in self._parts(columns)]

    @abstractmethod
    def joined(self, inside: Sequence[Mask]) -> Mask:
        """Which points lie in the region, from which lie in its members."""

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return self.joined([member.contains_points(points, *mine) for member, mine in self._parts(columns)])

    @abstractmethod
    def _accept(self, points: Points, inside: Sequence[Mask], chosen: NDArray[np.intp], dice: Column) -> Mask:
        """Which draws from members ``chosen`` are kept."""

    @abstractmethod
    def _sources(self, columns: Sequence[Column]) -> tuple[list[int], NDArray[np.float64]]:
        """The members to draw from, with weights ``(members, n | 1)``."""

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        lanes = uniforms.shape[1]
        sources, weights = self._sources(columns)
        sums = np.cumsum(np.broadcast_to(weights, (len(sources), lanes)), axis=0)
        points = np.zeros((lanes, 3))
        found = np.zeros(lanes, dtype=np.bool_)
        words = np.broadcast_to(np.asarray(keys, dtype=np.uint64), lanes)
        parts = list(self._parts(columns))
        first = 0
        while first < TRIES and len(missing := np.flatnonzero(~found)):
            # The first attempt that is kept counts, so looking at several at once changes nothing. They become more as lanes
            # turn out to find it hard.
            count = min(max(first, 1), TRIES - first, max(_TOGETHER // len(missing), 1))
            lane = np.repeat(missing, count)
            attempts = np.tile(np.arange(first, first + count, dtype=np.uint64), len(missing))
            own = mix(words[lane] ^ (attempts + np.uint64(1)))
            choice = uniforms[0, missing] if first == 0 else open_unit(mix(own))
            total = sums[:, lane]
            chosen = (choice * total[-1] >= total).sum(axis=0).clip(0, len(sources) - 1)
            drawn = np.zeros((len(lane), 3))
            known = np.zeros(len(lane), dtype=np.bool_)
            for number, source in enumerate(sources):
                mine = np.flatnonzero(chosen == number)
                if not len(mine):
                    continue
                member, all_columns = parts[source]
                some = [column if len(column) == 1 else column[lane[mine]] for column in all_columns]
                fresh = (
                    np.stack(
                        [open_unit(mix(own[mine] + np.uint64(17 + axis))) for axis in range(member.draws)]
                    )
                    if member.draws
                    else np.empty((0, len(mine)))
                )
                drawn[mine], present = member.draw_points(fresh, mix(own[mine] + np.uint64(3)), *some)
                known[mine] = True if present is None else present
            rows = [column if len(column) == 1 else column[lane] for column in columns]
            kept = known & self._accept(
                drawn, self.members_that_hold(drawn, rows), chosen, open_unit(mix(own + np.uint64(5)))
            )
            kept_by_lane = kept.reshape(len(missing), count)
            lucky = np.flatnonzero(kept_by_lane.any(axis=1))
            points[missing[lucky]] = drawn[lucky * count + kept_by_lane[lucky].argmax(axis=1)]
            found[missing[lucky]] = True
            first += count
        return points, found

    def uniform_placement(self) -> tuple[Any, Any]:
        if not any(np.isfinite(member.dimension) and member.dimension >= 0 for member in self.members):
            raise InvalidScenarioError("no point can be drawn from an unbounded region", span=here())
        return super().uniform_placement()

    def orientation_at(self, point: Any) -> Any:
        if self.orientation is not None:
            return self.orientation[point]
        for member in self.members:
            if member.has_orientation:
                return member.orientation_at(point) if self.has_orientation else None
        return None


def _levelled(region: Composite, points: Points, columns: Sequence[Column]) -> Points:
    """Points at the height of the first member of the plane, where there is one."""
    for leaf, mine in _leaves(region, columns):
        if isinstance(leaf, PlanarRegion):
            points = np.array(points)
            points[:, 2] = leaf.heights(*mine)
            break
    return points


def _joined(join: Callable[[Flat, Flat], Flat | None], parts: Sequence[Flat | None]) -> Flat | None:
    """Geometries of members, joined one after the other; ``None`` where one has none."""
    result = parts[0]
    for part in parts[1:]:
        if result is None or part is None:
            return None
        result = join(result, part)
    return result


# Masks and columns of members are combined two by two, as `reduce` does: some may have a single row, and others one for each lane.
def _all(masks: Sequence[Mask]) -> Mask:
    return np.asarray(reduce(np.logical_and, masks), dtype=np.bool_)


def _any(masks: Sequence[Mask]) -> Mask:
    return np.asarray(reduce(np.logical_or, masks), dtype=np.bool_)


def exactly_contains(region: Region, points: Points, columns: Sequence[Column]) -> Mask:
    """Which points lie in a region, with their heights where it lies in a plane, or is made of such as do."""
    if isinstance(region, Workspace):
        return exactly_contains(region.region, points, columns)
    if isinstance(region, Composite):
        return np.broadcast_to(region.joined(region.members_that_hold(points, columns)), len(points))
    if isinstance(region, RegionChoice):
        held = np.zeros(len(points), dtype=np.bool_)
        for option, chosen, mine in region.drawn(len(points), columns):
            held[chosen] = exactly_contains(option, points[chosen], mine)
        return held
    inside = region.contains_points(points, *columns)
    if isinstance(region, PlanarRegion):
        inside = inside & (np.abs(points[:, 2] - region.heights(*columns)) <= LEVEL)
    return np.broadcast_to(inside, len(points))


def _leaves(region: Region, columns: Sequence[_Part]) -> Iterator[tuple[Region, Sequence[_Part]]]:
    """The members of members, with their columns."""
    if isinstance(region, Composite):
        for member, mine in region._parts(columns):
            yield from _leaves(member, mine)
    else:
        yield region, columns


def _is_flat(region: Region) -> bool:
    """Whether all leaves lie in planes or are columns."""
    return all(isinstance(leaf, PlanarRegion | Footprint) for leaf, _ in _leaves(region, region.parameters))


def _known_points(body: Body, lanes: NDArray[np.intp]) -> Iterator[Points]:
    """Points ``(n, 3)`` that bodies hold for certain, in some lanes: extreme corners, and middles of convex ones."""
    part, count = body.take(lanes), len(lanes)
    known = []
    for mesh in body.meshes:
        corners = extreme_corners(mesh)
        first = mesh.vertices.mean(axis=0) if mesh.is_convex else corners[0]
        known.append(np.concatenate([first[np.newaxis], corners]))
    for number in range(1 + min(_PROBES, max(map(len, known)) - 1)):
        points = np.empty((count, 3))
        for mesh, chosen in part.by_mesh(count):
            mine = known[body.meshes.index(mesh)]
            place = mine[min(number, len(mine) - 1)]
            points[chosen] = part.poses.take(chosen).to_world(place[np.newaxis, np.newaxis])[:, 0]
        yield points


class IntersectionRegion(Composite):
    """The points that lie in all members."""

    def __init__(self, *members: Region, orientation: Any = None, name: str | None = None) -> None:
        super().__init__(*members, orientation=orientation, name=name)
        self.dimension = min(member.dimension for member in members)
        oriented = next((member for member in members if member.has_orientation), None)
        if orientation is None and oriented is not None:
            self.has_orientation, self.orientation = True, oriented.orientation

    def uniform_placement(self) -> tuple[Any, Any]:
        if all(isinstance(member, Footprint) for member in self.members):
            raise InvalidScenarioError(
                "no point can be drawn from an intersection of unbounded regions",
                span=here(),
                help="intersect them with a bounded region, too",
            )
        return super().uniform_placement()

    def combined(self, members: Sequence[Region]) -> Region:
        result = members[0]
        for member in members[1:]:
            result = result.intersect(member)
        return result

    def _sources(self, columns: Sequence[Column]) -> tuple[list[int], NDArray[np.float64]]:
        bounded = [
            number
            for number, (member, mine) in enumerate(self._parts(columns))
            if member.dimension == self.dimension and np.isfinite(member.box(*mine)[0]).all()
        ]
        if not bounded:
            bounded = [
                number
                for number, (member, mine) in enumerate(self._parts(columns))
                if np.isfinite(member.box(*mine)[0]).all()
            ][:1]
        if not bounded:
            raise ScenicTypeError("no point can be drawn from an intersection of unbounded regions")
        return bounded[:1], np.ones((1, 1))

    def _accept(self, points: Points, inside: Sequence[Mask], chosen: NDArray[np.intp], dice: Column) -> Mask:
        return _all(inside)

    def joined(self, inside: Sequence[Mask]) -> Mask:
        return _all(inside)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return _all([member.contains_bodies(body, lanes, *mine) for member, mine in self._parts(columns)])

    def may_meet(self, body: Body, lanes: int, columns: Sequence[Column]) -> Mask:
        return _all([member.meets_bodies(body, lanes, *mine) for member, mine in self._parts(columns)])

    def half_spaces(self, *columns: Column) -> NDArray[np.float64] | None:
        parts = [member.half_spaces(*mine) for member, mine in self._parts(columns)]
        known = [part for part in parts if part is not None]
        return polytopes.joined(*known) if len(known) == len(parts) else None

    def meets_polytopes(self, planes: Column, lanes: int, columns: Sequence[Column]) -> Mask | None:
        own = self.half_spaces(*columns)
        if own is None:
            return None
        every = polytopes.joined(own, planes)
        return np.broadcast_to(polytopes.edges(every).valid.any(axis=1), lanes)

    def solid_distances(self, points: Points, columns: Sequence[Column]) -> NDArray[np.float64] | None:
        planes = self.half_spaces(*columns)
        if planes is None:
            return None
        return polytopes.distances(np.broadcast_to(planes, (len(points), *planes.shape[1:])), points)

    def from_above(self, *columns: Column) -> Flat | None:
        return _joined(Flat.intersection, [member.from_above(*mine) for member, mine in self._parts(columns)])

    def decided(self, points: Points, columns: Sequence[Column]) -> NDArray[np.float64]:
        """The distance to a member whose nearest point lies in all others; infinite where flat members lie at different heights."""
        result = super().decided(points, columns)
        levels = [
            member.heights(*mine) for member, mine in self._parts(columns) if isinstance(member, PlanarRegion)
        ]
        for level in levels[1:]:
            result[np.broadcast_to(level != levels[0], len(points))] = np.inf
        for member, mine in self._parts(columns):
            found = member.nearest(points, *mine)
            if found is None:
                continue
            found = _levelled(self, found, columns)
            held = [
                exactly_contains(other, found, theirs)
                for other, theirs in self._parts(columns)
                if other is not member
            ]
            if held:
                closest = np.isnan(result) & _all(held)
                result[closest] = np.broadcast_to(member.distances(points, *mine), len(points))[closest]
        return result

    @property
    def footprint(self) -> Region:
        return IntersectionRegion(*(member.footprint for member in self.members))

    def gaps(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return np.asarray(
            reduce(np.maximum, [member.gaps(points, *mine) for member, mine in self._parts(columns)])
        )

    def depths(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return np.asarray(
            reduce(np.minimum, [member.depths(points, *mine) for member, mine in self._parts(columns)])
        )

    def box(self, *columns: Column) -> tuple[Points, Points]:
        boxes = [member.box(*mine) for member, mine in self._parts(columns)]
        lower = reduce(np.maximum, [low for low, _ in boxes])
        upper = reduce(np.minimum, [high for _, high in boxes])
        return np.minimum(lower, upper), upper

    def _box_of(self, boxes: Sequence[Bounds | None]) -> Bounds | None:
        known = [box for box in boxes if box is not None]
        if not known:
            return None
        met = reduce(Bounds.meet, known)
        return Bounds(np.minimum(met.lower, met.upper), met.upper)


class UnionRegion(Composite):
    """The points that lie in any member."""

    def __init__(self, *members: Region, orientation: Any = None, name: str | None = None) -> None:
        super().__init__(*members, orientation=orientation, name=name)
        self.dimension = max(member.dimension for member in members)

    def uniform_placement(self) -> tuple[Any, Any]:
        for member in self.members:
            if member.dimension == self.dimension and type(member).sizes is Region.sizes:
                raise ScenicTypeError(
                    f"the size of {member!r} is not known: no point of a union with it can be drawn",
                    span=here(),
                    help="choose among the regions, as by `Uniform(a, b)`, or use such whose parameters are fixed",
                )
        return super().uniform_placement()

    def combined(self, members: Sequence[Region]) -> Region:
        result = members[0]
        for member in members[1:]:
            result = result.union(member)
        return result

    def _sources(self, columns: Sequence[Column]) -> tuple[list[int], NDArray[np.float64]]:
        chosen, weights = [], []
        for number, (member, mine) in enumerate(self._parts(columns)):
            if member.dimension == self.dimension:
                size = member.sizes(*mine)
                if not np.isfinite(size).all():
                    raise ScenicTypeError(
                        f"the size of {member!r} is not known: no point of a union with it can be drawn"
                    )
                chosen.append(number)
                weights.append(size)
        lanes = max(map(len, weights))
        return chosen, np.stack([np.broadcast_to(weight, lanes) for weight in weights])

    def _accept(self, points: Points, inside: Sequence[Mask], chosen: NDArray[np.intp], dice: Column) -> Mask:
        # A point in several members is drawn once for each of them.
        mine = [
            mask
            for mask, member in zip(inside, self.members, strict=True)
            if member.dimension == self.dimension
        ]
        return np.asarray(dice * np.sum(mine, axis=0) <= 1)

    def joined(self, inside: Sequence[Mask]) -> Mask:
        return _any(inside)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Where one member holds the whole body, or several together do whose union has a closed form in that lane."""
        one = _any([member.contains_bodies(body, lanes, *mine) for member, mine in self._parts(columns)])
        inside = np.array(np.broadcast_to(one, lanes))
        left = np.flatnonzero(~inside)
        if not len(left):
            return inside
        left = left[self._hold_vertices(body, left, columns)]
        flat = self.from_above(*rows_of(columns, left)) if len(left) else None
        if flat is not None:
            inside[left] = flat.holds(body, left)
            return inside
        if not self.is_random:
            return inside
        for lane in left.tolist():
            region = self.in_lane(lane, columns)
            if not isinstance(region, UnionRegion):
                part = body if len(body) == 1 else body.take(np.array([lane]))
                inside[lane] = region.contains_bodies(part, 1, *region.fixed_columns("the union"))[0]
        return inside

    def _hold_vertices(self, body: Body, lanes: NDArray[np.intp], columns: Sequence[Column]) -> Mask:
        """In which of some lanes the first vertices of the body lie in members."""
        held = np.ones(len(lanes), dtype=np.bool_)
        rows = [column if len(column) == 1 else column[lanes] for column in columns]
        part = body if len(body) == 1 else body.take(lanes)
        for mesh, chosen in part.by_mesh(len(lanes)):
            poses = part.poses.take(chosen) if len(part.poses) > 1 else part.poses
            mine = [row if len(row) == 1 else row[chosen] for row in rows]
            for vertex in mesh.vertices[:_PROBES]:
                points = np.broadcast_to(
                    poses.to_world(vertex[np.newaxis, np.newaxis])[:, 0], (len(chosen), 3)
                )
                held[chosen] &= self.contains_points(points, *mine)
        return held

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return self.may_meet(body, lanes, columns)

    def may_meet(self, body: Body, lanes: int, columns: Sequence[Column]) -> Mask:
        return _any([member.meets_bodies(body, lanes, *mine) for member, mine in self._parts(columns)])

    def from_above(self, *columns: Column) -> Flat | None:
        return _joined(Flat.union, [member.from_above(*mine) for member, mine in self._parts(columns)])

    def gaps(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return np.asarray(
            reduce(np.minimum, [member.gaps(points, *mine) for member, mine in self._parts(columns)])
        )

    @property
    def footprint(self) -> Region:
        return UnionRegion(*(member.footprint for member in self.members))

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        return np.asarray(
            reduce(np.minimum, [member.distances(points, *mine) for member, mine in self._parts(columns)])
        )

    def box(self, *columns: Column) -> tuple[Points, Points]:
        boxes = [member.box(*mine) for member, mine in self._parts(columns)]
        return reduce(np.minimum, [low for low, _ in boxes]), reduce(np.maximum, [high for _, high in boxes])

    def _box_of(self, boxes: Sequence[Bounds | None]) -> Bounds | None:
        return hull_of(boxes)


class DifferenceRegion(Composite):
    """The points of the first member that do not lie in the second."""

    def __init__(
        self, regionA: Region, regionB: Region, *, orientation: Any = None, name: str | None = None
    ) -> None:
        super().__init__(regionA, regionB, orientation=orientation, name=name)
        self.regionA, self.regionB = regionA, regionB
        self.dimension = regionA.dimension
        if orientation is None:
            self.has_orientation, self.orientation = regionA.has_orientation, regionA.orientation

    def combined(self, members: Sequence[Region]) -> Region:
        return members[0].difference(members[1])

    def _sources(self, columns: Sequence[Column]) -> tuple[list[int], NDArray[np.float64]]:
        return [0], np.ones((1, 1))

    def _accept(self, points: Points, inside: Sequence[Mask], chosen: NDArray[np.intp], dice: Column) -> Mask:
        return np.asarray(~inside[1])

    def joined(self, inside: Sequence[Mask]) -> Mask:
        first, second = inside
        return np.asarray(first & ~second)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Where the first member holds the whole body, and the second touches it nowhere."""
        (first, mine), (second, others) = self._parts(columns)
        inside = np.broadcast_to(first.contains_bodies(body, lanes, *mine), lanes).copy()
        held = np.flatnonzero(inside)
        if len(held):
            # A container of the plane holds what is above it: what is cut out of it is cut out at every height.
            hole = second.footprint if _is_flat(self) else second
            inside[held] = ~hole.meets_bodies(body.take(held), len(held), *rows_of(others, held))
        return inside

    def may_meet(self, body: Body, lanes: int, columns: Sequence[Column]) -> Mask:
        (first, mine), _ = self._parts(columns)
        return first.meets_bodies(body, lanes, *mine)

    def meets_polytopes(self, planes: Column, lanes: int, columns: Sequence[Column]) -> Mask | None:
        """Where a vertex of what the polytope shares with the first member lies outside the second, which is convex."""
        (first, mine), (second, others) = self._parts(columns)
        own = first.half_spaces(*mine)
        if own is None or not second.is_surely_convex():
            return None
        found = polytopes.edges(polytopes.joined(own, planes))
        result = np.zeros(len(found.valid), dtype=np.bool_)
        for ends in (found.starts, found.ends):
            lane, edge = np.nonzero(found.valid)
            outside = ~second.contains_points(ends[lane, edge], *rows_of(others, lane))
            np.logical_or.at(result, lane, outside)
        return np.broadcast_to(result, lanes)

    def solid_distances(self, points: Points, columns: Sequence[Column]) -> NDArray[np.float64] | None:
        (first, mine), (second, others) = self._parts(columns)
        planes = first.half_spaces(*mine)
        if planes is None:
            return None
        planes = np.broadcast_to(planes, (len(points), *planes.shape[1:]))
        holes = second.half_spaces(*others)
        if holes is not None:
            # Outside a polytope is beyond one of its planes.
            beyond = [
                polytopes.distances(polytopes.joined(planes, -holes[:, [number]]), points)
                for number in range(holes.shape[1])
            ]
            return np.asarray(reduce(np.minimum, beyond))
        ball = second.ball(*others)
        if ball is None:
            return None
        centre, radius = (np.broadcast_to(part, (len(points), *part.shape[1:])) for part in ball)
        return polytopes.distances_without_ball(planes, centre, radius, points)

    def from_above(self, *columns: Column) -> Flat | None:
        return _joined(Flat.difference, [member.from_above(*mine) for member, mine in self._parts(columns)])

    def decided(self, points: Points, columns: Sequence[Column]) -> NDArray[np.float64]:
        """The distance to the first member, where its nearest point is not in the second."""
        result = super().decided(points, columns)
        (first, mine), (second, others) = self._parts(columns)
        found = first.nearest(points, *mine)
        if found is not None:
            outside = ~exactly_contains(second, _levelled(self, found, columns), others)
            result[outside] = np.broadcast_to(first.distances(points, *mine), len(points))[outside]
        return result

    @property
    def footprint(self) -> Region:
        first, second = (member.footprint for member in self.members)
        return DifferenceRegion(first, second)

    def gaps(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        (first, mine), _ = self._parts(columns)
        return first.gaps(points, *mine)

    def depths(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        (first, mine), (second, others) = self._parts(columns)
        depths = first.depths(points, *mine)
        # What is cut out of a container of the plane is cut out at every height.
        return np.minimum(depths, second.gaps(points, *others)) if _is_flat(self) else depths

    def box(self, *columns: Column) -> tuple[Points, Points]:
        (first, mine), _ = self._parts(columns)
        return first.box(*mine)

    def _box_of(self, boxes: Sequence[Bounds | None]) -> Bounds | None:
        return boxes[0]


__all__ = ["Composite", "DifferenceRegion", "IntersectionRegion", "UnionRegion", "exactly_contains"]
