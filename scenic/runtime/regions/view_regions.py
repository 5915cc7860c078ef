"""Views of observers as regions: `visibleRegion`, and the parts of other regions that are in view or are not.

Occlusion is ignored here (section 11.2 of the specification).
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final, Self

import numpy as np

from scenic.graph.bounds import Bounds
from scenic.graph.draws import mix, open_unit, words_of
from scenic.graph.kinds import Column
from scenic.language.errors import ScenicValueError
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.containment import distance
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Indices, Poses
from scenic.runtime.geometry.views.observers import CORNERS, Views
from scenic.runtime.geometry.views.subdivision import Proof, prove
from scenic.runtime.geometry.views.view_volumes import (
    draw_near,
    draw_places,
    near_volume,
    region_angles,
    view_mesh,
    view_volume,
)
from scenic.runtime.ground.context import here
from scenic.runtime.regions import generic
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.combinations import DifferenceRegion, IntersectionRegion
from scenic.runtime.regions.nearness import grown
from scenic.runtime.regions.planar import PlanarRegion
from scenic.runtime.regions.planar_visibility import FULL_ANGLE
from scenic.runtime.regions.sectors import SectorRegion, sector_box
from scenic.runtime.regions.spaces import Everywhere, Workspace
from scenic.runtime.regions.visibility_nodes import view_operands
from scenic.runtime.values.values import (
    Orientation,
    is_number,
    operate,
    per_option,
    to_orientation,
    to_scalar,
    to_vector,
    vector,
)

VIEW_PARAMETERS: Final = 5
"""Number of an observer's first operands, which describe its view; the other operands are about rays."""

_SLACK: Final = 1e-6
"""Share, or radians, by which boxes of views are larger: more than the slack of being in view."""

_TRIES: Final = 1000
"""So often a point is drawn again until it lies in the right place; then the region counts as empty."""

_ROWS: Final = 1024
"""So many draws are made at once, where there are fewer lanes: most of the time of one is that of calling NumPy."""


class ViewRegion(Region):
    """The places in view of an observer: a part of a ball."""

    dimension: float = 3

    def __init__(
        self,
        visibleDistance: object,
        viewAngles: Any,
        name: str | None = None,
        position: object = (0, 0, 0),
        rotation: object = None,
    ) -> None:
        """The view of an observer that is none of the program's.

        Args:
            visibleDistance: how far it sees, metres.
            viewAngles: horizontal and vertical, radians.
            name: for messages.
            position: where it is.
            rotation: of its frame, as an orientation.

        """
        horizontal, vertical = (to_scalar(angle, "`ViewRegion` angle") for angle in viewAngles)
        if any(is_number(angle) and not angle > 0 for angle in (horizontal, vertical)):
            raise ScenicValueError(f"view angles are greater than 0, not {tuple(viewAngles)!r}", span=here())
        super().__init__(
            to_vector(position, "`ViewRegion` position"),
            Orientation() if rotation is None else to_orientation(rotation, "`ViewRegion` rotation"),
            horizontal,
            vertical,
            to_scalar(visibleDistance, "`ViewRegion` distance"),
            name=name,
        )

    @classmethod
    def of(cls, observer: object) -> Self:
        """The view of an observer."""
        region = object.__new__(cls)
        Region.__init__(region, *view_operands(observer)[:VIEW_PARAMETERS])
        return region

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        return draw_places(views_over(columns).spread(uniforms.shape[1]), uniforms.T), None

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return views_over(columns).contain(points)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        result = np.zeros(lanes, dtype=np.bool_)
        for chosen, solid in _solids(views_over(columns).spread(lanes)):
            part = body if len(body) == 1 else body.take(chosen)
            result[chosen] = containment.in_body(part, solid, len(chosen))
        return result

    def distances(self, points: Points, *columns: Column) -> Column:
        """To the mesh of the view, which is inside it by a thousandth of its reach at most; 0 for points in view."""
        lanes = max(len(points), *map(len, columns))
        points = np.broadcast_to(points, (lanes, 3))
        result = np.zeros(lanes)
        for chosen, solid in _solids(views_over(columns).spread(lanes)):
            result[chosen] = distance.to_solid(solid, points[chosen], len(chosen))
        return np.where(self.contains_points(points, *columns), 0.0, result)

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """A body reaches into the view if it could be seen were nothing in the way."""
        return np.asarray(prove(views_over(columns), body, (), lanes) != Proof.HIDDEN)

    def solid(self) -> Mesh:
        """The mesh of a view without random parameters, in the world; see `distances`."""
        ((_, body),) = _solids(views_over(self.fixed_columns("the view")))
        (unit,) = body.meshes
        return Mesh(body.poses.to_world(unit.vertices[np.newaxis])[0], unit.faces)

    def getVolumeRegion(self) -> Region:
        """Return the volume of its mesh, without random parameters."""
        region: Region = generic.meshed(self)
        return region

    def getSurfaceRegion(self) -> Region:
        """Return the surface of its mesh, without random parameters."""
        region: Region = generic.meshed(self).getSurfaceRegion()
        return region

    @property
    def mesh(self) -> Any:
        """A mesh of it in the world, trimesh's, without random parameters; see `distances`."""
        return generic.meshed(self).mesh

    @property
    def boundingPolygon(self) -> Any:
        """Its mesh seen from above."""
        return generic.meshed(self).boundingPolygon

    @property
    def position(self) -> Any:
        """The position of the observer."""
        return self.parameters[0]

    @property
    def rotation(self) -> Any:
        """The frame of the observer."""
        return self.parameters[1]

    @property
    def isConvex(self) -> bool:
        """Return whether its mesh is convex."""
        return bool(generic.meshed(self).isConvex)

    @property
    def inradius(self) -> float:
        """As of its mesh."""
        return float(generic.meshed(self).inradius)

    @property
    def circumcircle(self) -> tuple[Any, float]:
        """As of its mesh."""
        circle: tuple[Any, float] = generic.meshed(self).circumcircle
        return circle

    def voxelized(self, pitch: float) -> Region:
        """Return the cells of this edge length, in metres, that its mesh touches."""
        region: Region = generic.meshed(self).voxelized(pitch)
        return region

    def project(self, point: object, direction: object) -> tuple[Any, Any]:
        """Project a point onto the mesh of the region."""
        landing: tuple[Any, Any] = generic.meshed(self).project(point, direction)
        return landing

    def box(self, *columns: Column) -> tuple[Points, Points]:
        camera, reach = columns[0], columns[4][:, None]
        return camera - reach, camera + reach

    def tight_box(self, *columns: Column) -> tuple[Points, Points]:
        camera, orientation, horizontal, _, distance = columns
        lower, upper = self.box(*columns)
        # Upright views are sectors, seen from above.
        upright = (orientation[:, :2] == 0).all(axis=1)
        if upright.any():
            heading = 2 * np.arctan2(orientation[:, 2], orientation[:, 3])
            sector = sector_box(camera, distance * (1 + _SLACK), heading, horizontal + _SLACK)
            flat = upright[:, np.newaxis] & np.array([True, True, False])
            lower = np.where(flat, np.maximum(sector[0], lower), lower)
            upper = np.where(flat, np.minimum(sector[1], upper), upper)
        return lower, upper

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        camera, reach = parameters[0], parameters[4]
        return None if camera is None or reach is None else grown(camera, reach.upper)

    def sizes(self, *columns: Column) -> Column:
        return view_volume(views_over(columns))


def _solids(views: Views) -> Iterator[tuple[Indices, Body]]:
    """The meshes of views, of each pair of angles with the lanes that have it."""
    for angles in np.unique(views.angles, axis=0):
        chosen = np.flatnonzero((views.angles == angles).all(axis=1))
        unit, centre, extents = view_mesh(*angles.tolist()).normalized()
        view, reach = views.take(chosen), views.distance[chosen, None]
        x, y, z = (reach * centre).T
        turn = view.matrix
        offset = np.stack([turn[:, i, 0] * x + turn[:, i, 1] * y + turn[:, i, 2] * z for i in range(3)], -1)
        yield chosen, Body((unit,), None, Poses(view.camera + offset, view.orientation, reach * extents))


def views_over(columns: Sequence[Column]) -> Views:
    """Return the views whose first operands have these columns, with the angles that their regions have."""
    camera, orientation, horizontal, vertical, distance = columns
    angles = np.stack(np.broadcast_arrays(horizontal, vertical), axis=-1).astype(np.float64)
    one, none = np.ones(1), np.zeros((1, 2))
    angles = region_angles(angles)
    return Views(camera, orientation, angles, distance, one, none, np.zeros(1, dtype=np.bool_))


class NearView(Region):
    """The places in a container where an observer may see something of a size, as far as range and angles say.

    Uniform points of it, conditioned on the thing being seen there, are distributed as uniform points of the container
    are: what is left out are places from which nothing can be seen. A container in the plane is a column, and
    one without bounds none at all.
    """

    dimension: float = 3
    draws = 4
    may_find_none = True

    def __init__(self, container: Region, observer: object, thing: Any) -> None:
        size = vector(to_scalar(thing.width), to_scalar(thing.length), to_scalar(thing.height))
        radius = operate("multiply", 0.5, operate("norm", size))
        self.container = container.footprint
        super().__init__(*self.container.parameters, *view_operands(observer)[:VIEW_PARAMETERS], radius)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        inside = self.container.contains_points(points, *columns[: -VIEW_PARAMETERS - 1])
        return np.asarray(inside & self._reached(points, columns))

    @staticmethod
    def _reached(points: Points, columns: Sequence[Column]) -> Mask:
        camera, reach = columns[-VIEW_PARAMETERS - 1], columns[-2] + columns[-1]
        x, y, z = (points - camera.reshape(-1, *(1,) * (points.ndim - 2), 3)).transpose(
            -1, *range(points.ndim - 1)
        )
        return np.asarray(np.sqrt(x * x + y * y + z * z) <= reach.reshape(-1, *(1,) * (points.ndim - 2)))

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        inside = self.container.contains_bodies(body, lanes, *columns[: -VIEW_PARAMETERS - 1])
        return np.asarray(inside & self._reached(body.poses.to_world(CORNERS[None]), columns).all(axis=1))

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        count = uniforms.shape[1]
        views = views_over(columns[-VIEW_PARAMETERS - 1 : -1]).spread(count)
        radius = np.broadcast_to(columns[-1], (count,))
        container = columns[: -VIEW_PARAMETERS - 1]
        volume = np.broadcast_to(self.container.sizes(*container), (count,))
        # A small container is drawn from itself.
        direct = (volume < near_volume(views, radius)) & (self.container.dimension == 3)

        def draw(numbers: Column, words: Column, lanes: Column) -> tuple[Points, Mask]:
            container_rows = _rows(container, lanes)
            points = draw_near(views.take(lanes), radius[lanes], numbers.T)
            fits = self.container.contains_points(points, *container_rows)
            mine = np.flatnonzero(direct[lanes])
            if len(mine):
                parts = _rows(container, lanes[mine])
                points_of_container, there = self.container.draw_points(
                    numbers[: self.container.draws, mine], words[mine], *parts
                )
                points[mine] = points_of_container
                fits[mine] = True if there is None else there
            return points, fits

        return _drawn_until_fit(uniforms, keys, draw)


_Draw = Callable[[Column, Column, Column], tuple[Points, Mask]]


def _drawn_until_fit(uniforms: Column, keys: Column, draw: _Draw) -> tuple[Points, Mask]:
    """Points that fit, and where one was found: each lane draws again by numbers that follow from its key."""
    count = uniforms.shape[1]
    points, has_point = np.zeros((count, 3)), np.zeros(count, dtype=np.bool_)
    lanes = np.arange(count)
    words = np.broadcast_to(keys, (count,))
    addresses = np.arange(len(uniforms), dtype=np.uint64)
    first_attempt, together = 0, 1
    while len(lanes) and first_attempt < _TRIES:
        attempts = np.arange(first_attempt, min(first_attempt + together, _TRIES), dtype=np.uint64)
        mine = mix(words[lanes] ^ mix(attempts)[:, None]).reshape(-1)
        numbers = uniforms[:, lanes] if first_attempt == 0 else open_unit(words_of(mine, addresses))
        candidates, fits = draw(numbers, mine, np.tile(lanes, len(attempts)))
        # The first attempt that fits counts, as if one were made after the other.
        fits = fits.reshape(len(attempts), -1)
        fitting = fits.any(axis=0)
        first = np.where(fitting, fits.argmax(axis=0), len(attempts) - 1)
        points[lanes] = candidates.reshape(len(attempts), -1, 3)[first, np.arange(len(lanes))]
        has_point[lanes] = fitting
        lanes = lanes[~fitting]
        first_attempt += len(attempts)
        together = max(1, min(2 * together, _ROWS // max(len(lanes), 1)))
    return points, has_point


def _rows(columns: Sequence[Column], lanes: Column) -> list[Column]:
    return [column if len(column) == 1 else column[lanes] for column in columns]


def place_near(observer: object, container: Region, thing: object) -> Any:
    """A uniform point of a container, as far as an observer may see a thing there."""
    if container.dimension < 2:
        return container.uniform_placement()[0]
    return NearView(container, observer, thing).uniform_placement()[0]


def place_in_plane(observer: object, container: Region, *, seen: bool) -> Any:
    """A uniform point of a container that an observer has in view, or has not, in 2D mode (section 5.5)."""

    def place(viewer: object) -> Any:
        view = view_in_plane(viewer)
        if not seen:
            return container.difference(view).uniform_placement()[0]
        region = view if isinstance(container, Everywhere) else container.intersect(view)
        return region.uniform_placement()[0]

    return per_option(observer, place)


def view_in_plane(observer: Any) -> PlanarRegion:
    """Return the disc or sector that an observer has in view in 2D mode."""
    camera, _, angle, _, distance = view_operands(observer)[:VIEW_PARAMETERS]
    center = vector(camera.x, camera.y, 0)
    if not hasattr(type(observer), "toHeading") or (is_number(angle) and angle >= FULL_ANGLE):
        return CircularRegion(center, distance)
    return SectorRegion(center, distance, observer.heading, angle)


def part_of(region: Region, observer: object, *, seen: bool) -> Region:
    """Return the part of a region that an observer has in view, or has not."""
    view = ViewRegion.of(observer)
    while isinstance(region, Workspace):
        region = region.region
    if not seen:
        return DifferenceRegion(region, view)
    return view if isinstance(region, Everywhere) else IntersectionRegion(region, view)
