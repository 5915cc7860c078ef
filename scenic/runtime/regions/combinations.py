"""Intersections, unions and differences of regions (section 9.4 of the specification)."""

from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column
from scenic.language.errors import ScenicTypeError, UndefinedSamplingException
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.geometry.meshes import polytopes
from scenic.runtime.ground.context import here
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.composite import (
    PROBES,
    Composite,
    all_of,
    any_of,
    exactly_contains,
    is_flat,
    join_flats,
    levelled,
)
from scenic.runtime.regions.flat import Flat, rows_of
from scenic.runtime.regions.nearness import hull_of
from scenic.runtime.regions.planar import Footprint, PlanarRegion


class IntersectionRegion(Composite):
    """The points that lie in all members."""

    def __init__(self, *members: Region, orientation: object = None, name: str | None = None) -> None:
        super().__init__(*members, orientation=orientation, name=name)
        self.dimension = min(member.dimension for member in members)
        oriented = next((member for member in members if member.has_orientation), None)
        if orientation is None and oriented is not None:
            self.has_orientation, self.orientation = True, oriented.orientation

    def uniform_placement(self) -> tuple[Any, Any]:
        if all(isinstance(member, Footprint) for member in self.members):
            raise UndefinedSamplingException(
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
        sources = [
            number
            for number, (member, mine) in enumerate(self._parts(columns))
            if member.dimension == self.dimension and np.isfinite(member.box(*mine)[0]).all()
        ]
        if not sources:
            sources = [
                number
                for number, (member, mine) in enumerate(self._parts(columns))
                if np.isfinite(member.box(*mine)[0]).all()
            ][:1]
        if not sources:
            raise ScenicTypeError("no point can be drawn from an intersection of unbounded regions")
        return sources[:1], np.ones((1, 1))

    def _boxes_of_draws(
        self, sources: Sequence[int], columns: Sequence[Column]
    ) -> tuple[Points, Points] | None:
        boxes = [
            member.tight_box(*mine)
            for number, (member, mine) in enumerate(self._parts(columns))
            if number not in sources
        ]
        finite = [
            box for box in boxes if np.isfinite(box[0][:, :2]).all() and np.isfinite(box[1][:, :2]).all()
        ]
        if not finite:
            return None
        lower, upper = zip(*finite, strict=True)
        return reduce(np.maximum, lower), reduce(np.minimum, upper)

    def _accept(self, points: Points, inside: Sequence[Mask], chosen: NDArray[np.intp], dice: Column) -> Mask:
        return all_of(inside)

    def joined(self, inside: Sequence[Mask]) -> Mask:
        return all_of(inside)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return all_of([member.contains_bodies(body, lanes, *mine) for member, mine in self._parts(columns)])

    def may_meet(self, body: Body, lanes: int, columns: Sequence[Column]) -> Mask:
        return all_of([member.meets_bodies(body, lanes, *mine) for member, mine in self._parts(columns)])

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
        return join_flats(
            Flat.intersection, [member.from_above(*mine) for member, mine in self._parts(columns)]
        )

    def decided(self, points: Points, columns: Sequence[Column]) -> NDArray[np.float64]:
        """Return the distance to a member whose nearest point lies in all others; infinite where flat members lie at different heights."""
        result = super().decided(points, columns)
        levels = [
            member.heights(*mine) for member, mine in self._parts(columns) if isinstance(member, PlanarRegion)
        ]
        for level in levels[1:]:
            result[np.broadcast_to(level != levels[0], len(points))] = np.inf
        for member, mine in self._parts(columns):
            nearest_points = member.nearest(points, *mine)
            if nearest_points is None:
                continue
            nearest_points = levelled(self, nearest_points, columns)
            memberships = [
                exactly_contains(other, nearest_points, theirs)
                for other, theirs in self._parts(columns)
                if other is not member
            ]
            if memberships:
                closest = np.isnan(result) & all_of(memberships)
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

    def __init__(self, *members: Region, orientation: object = None, name: str | None = None) -> None:
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
        numbers, weights = [], []
        for number, (member, mine) in enumerate(self._parts(columns)):
            if member.dimension == self.dimension:
                size = member.sizes(*mine)
                if not np.isfinite(size).all():
                    raise ScenicTypeError(
                        f"the size of {member!r} is not known: no point of a union with it can be drawn"
                    )
                numbers.append(number)
                weights.append(size)
        lanes = max(map(len, weights))
        return numbers, np.stack([np.broadcast_to(weight, lanes) for weight in weights])

    def _accept(self, points: Points, inside: Sequence[Mask], chosen: NDArray[np.intp], dice: Column) -> Mask:
        # A point in several members is drawn once for each of them.
        mine = [
            mask
            for mask, member in zip(inside, self.members, strict=True)
            if member.dimension == self.dimension
        ]
        return np.asarray(dice * np.sum(mine, axis=0) <= 1)

    def joined(self, inside: Sequence[Mask]) -> Mask:
        return any_of(inside)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Return a mask of the lanes in which the union contains the whole body: within one member, or within
        several whose union has a closed form in that lane.
        """
        one = any_of([member.contains_bodies(body, lanes, *mine) for member, mine in self._parts(columns)])
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
        """Return the mask of those of some lanes in which the first vertices of the body lie in members."""
        is_inside = np.ones(len(lanes), dtype=np.bool_)
        rows = [column if len(column) == 1 else column[lanes] for column in columns]
        part = body if len(body) == 1 else body.take(lanes)
        for mesh, lanes_of_mesh in part.by_mesh(len(lanes)):
            poses = part.poses.take(lanes_of_mesh) if len(part.poses) > 1 else part.poses
            mine = [row if len(row) == 1 else row[lanes_of_mesh] for row in rows]
            for vertex in mesh.vertices[:PROBES]:
                points = np.broadcast_to(
                    poses.to_world(vertex[np.newaxis, np.newaxis])[:, 0], (len(lanes_of_mesh), 3)
                )
                is_inside[lanes_of_mesh] &= self.contains_points(points, *mine)
        return is_inside

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return self.may_meet(body, lanes, columns)

    def may_meet(self, body: Body, lanes: int, columns: Sequence[Column]) -> Mask:
        return any_of([member.meets_bodies(body, lanes, *mine) for member, mine in self._parts(columns)])

    def from_above(self, *columns: Column) -> Flat | None:
        return join_flats(Flat.union, [member.from_above(*mine) for member, mine in self._parts(columns)])

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
        self, regionA: Region, regionB: Region, *, orientation: object = None, name: str | None = None
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
        """Return a mask of the lanes in which the first member contains the whole body and the second does not touch it."""
        (first, mine), (second, others) = self._parts(columns)
        inside = np.broadcast_to(first.contains_bodies(body, lanes, *mine), lanes).copy()
        held = np.flatnonzero(inside)
        if len(held):
            # A container of the plane holds what is above it: what is cut out of it is cut out at every height.
            hole = second.footprint if is_flat(self) else second
            inside[held] = ~hole.meets_bodies(body.take(held), len(held), *rows_of(others, held))
        return inside

    def may_meet(self, body: Body, lanes: int, columns: Sequence[Column]) -> Mask:
        (first, mine), _ = self._parts(columns)
        return first.meets_bodies(body, lanes, *mine)

    def meets_polytopes(self, planes: Column, lanes: int, columns: Sequence[Column]) -> Mask | None:
        """Return a mask of the lanes in which the polytope meets the difference: a vertex of its intersection
        with the first member lies outside the second, which must be convex.
        """
        (first, mine), (second, others) = self._parts(columns)
        faces = first.half_spaces(*mine)
        if faces is None or not second.is_surely_convex():
            return None
        segments = polytopes.edges(polytopes.joined(faces, planes))
        result = np.zeros(len(segments.valid), dtype=np.bool_)
        for ends in (segments.starts, segments.ends):
            lane, edge = np.nonzero(segments.valid)
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
        return join_flats(
            Flat.difference, [member.from_above(*mine) for member, mine in self._parts(columns)]
        )

    def decided(self, points: Points, columns: Sequence[Column]) -> NDArray[np.float64]:
        """Return the distance to the first member, where its nearest point is not in the second."""
        result = super().decided(points, columns)
        (first, mine), (second, others) = self._parts(columns)
        found = first.nearest(points, *mine)
        if found is not None:
            outside = ~exactly_contains(second, levelled(self, found, columns), others)
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
        return np.minimum(depths, second.gaps(points, *others)) if is_flat(self) else depths

    def box(self, *columns: Column) -> tuple[Points, Points]:
        (first, mine), _ = self._parts(columns)
        return first.box(*mine)

    def _box_of(self, boxes: Sequence[Bounds | None]) -> Bounds | None:
        return boxes[0]


__all__ = ["Composite", "DifferenceRegion", "IntersectionRegion", "UnionRegion", "exactly_contains"]
