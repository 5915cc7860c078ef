"""Regions made of meshes: the inside of a closed one, and the surface of any (sections 9.2 and 9.3 of the specification)."""

from pathlib import Path
from typing import Any, Self

import numpy as np

from scenic.graph.kinds import Column
from scenic.language.errors import InvalidScenarioError, ScenicTypeError, ScenicValueError
from scenic.runtime.geometry.containment import body_points, distance
from scenic.runtime.geometry.meshes.loading import factor_of, load_mesh
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.solids import proper_volume
from scenic.runtime.geometry.meshes.surface import side_contains
from scenic.runtime.geometry.meshes.topology import without_unused
from scenic.runtime.ground.context import here
from scenic.runtime.ground.used_files import note_file
from scenic.runtime.regions import generic
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.body_regions import Facing, OccupiedSpace, SideSurface
from scenic.runtime.regions.region_field import RegionField
from scenic.runtime.regions.stacked import body_of
from scenic.runtime.shapes.shapes import Shape, ShapeSource
from scenic.runtime.values.values import Orientation, is_number, operate, to_orientation, to_vector, vector


class _Placement:
    """A mesh and its placement, converted to the operands of `body_of`."""

    def __init__(
        self,
        mesh: Mesh,
        dimensions: object,
        position: object,
        rotation: object,
        centered: bool,
        what: str,
        *,
        flat: bool,
    ) -> None:
        unit, centre, extents = mesh.normalized()
        if dimensions is None:
            self.dimensions = vector(*extents.tolist())
        else:
            self.dimensions = to_vector(dimensions, f"{what} dimensions")
        for size in self.dimensions:
            if is_number(size) and not (size >= 0 if flat else size > 0):
                raise ScenicValueError(f"{what} needs positive dimensions, not {dimensions!r}", span=here())
        self.position = vector(0, 0, 0) if position is None else to_vector(position, f"{what} position")
        self.rotation = Orientation() if rotation is None else to_orientation(rotation, f"{what} rotation")
        middle = self.position
        if not centered and (centre != 0).any():
            # Along an axis in which the mesh is flat nothing stretches it, nor its distance from the origin.
            offset = vector(
                *(
                    operate("multiply", part / extent, size) if extent > 0 else part
                    for part, extent, size in zip(
                        centre.tolist(), extents.tolist(), self.dimensions, strict=True
                    )
                )
            )
            middle = operate("add", middle, operate("rotate", self.rotation, offset))
        shape = Shape(unit, tuple(extents.tolist()), ShapeSource("mesh"))
        # A mesh has the coordinate 0 along an axis in which it is flat: there any size places it alike, but 0 cannot be undone.
        sizes = zip(self.dimensions, extents.tolist(), strict=True)
        spread = vector(*(size if extent > 0 else 1.0 for size, extent in sizes))
        self.operands = (middle, self.rotation, spread, shape)


def _mesh(mesh: Any, what: str) -> Mesh:
    if isinstance(mesh, Mesh):
        return mesh
    try:
        whole = Mesh(mesh.vertices, mesh.faces)
    except AttributeError:
        raise ScenicTypeError(
            f"{what} needs a mesh, not {mesh!r}",
            span=here(),
            help="pass a `trimesh.Trimesh`, or use `fromFile`",
        ) from None
    # What no face uses must not count for the extents.
    return Mesh(*without_unused(whole.vertices, whole.faces))


def _loaded(cls: type[Region], path: object, unit: str, scale: float, **how: bool) -> Mesh:
    """Return the mesh of a file, in metres."""
    what = f"{cls.__name__}.fromFile"
    if not isinstance(path, str | Path):
        raise ScenicTypeError(f"{what} needs a fixed path, not {path!r}", span=here())
    factor = factor_of(unit, scale, what)
    note_file(path)
    mesh = load_mesh(path, **how)
    return mesh if factor == 1 else Mesh(mesh.vertices * factor, mesh.faces)


class MeshRegion(Region):
    """A volume or surface, for programs that ask for either."""

    kindred = ("OccupiedSpace", "PlacedVolume", "SideSurface", "ViewRegion")


class MeshVolumeRegion(OccupiedSpace):
    """The inside of a closed mesh: centred, scaled to dimensions, turned and moved.

    Args:
        mesh: a `trimesh.Trimesh`, or anything with vertices and faces.
        dimensions: extents; those of the mesh by default.
        position, rotation: where it is.
        orientation: a vector field, or ``None``.
        tolerance: metres within which a point beside the volume counts as inside.
        centerMesh: whether the mesh is moved so that its bounding box is about the origin first.
        onDirection: the direction in which things land on it.

    Raises:
        ValueError: if the mesh bounds no volume, or a dimension is not positive.

    """

    kindred = ("OccupiedSpace", "PlacedVolume", "ViewRegion")
    draws = 3

    def __init__(
        self,
        mesh: object,
        dimensions: object = None,
        position: object = None,
        rotation: object = None,
        orientation: object = None,
        tolerance: float = 1e-6,
        centerMesh: bool = True,
        onDirection: object = None,
        name: str | None = None,
        **_established: Any,
    ) -> None:
        what = f"`{type(self).__name__}`"
        self.source = proper_volume(_mesh(mesh, what), unify=False)
        self._finish(self.source, dimensions, position, rotation, centerMesh, name)
        self.orientation = orientation
        self.has_orientation = orientation is not None
        self.tolerance = tolerance
        self.onDirection = onDirection

    def _finish(
        self,
        mesh: Mesh,
        dimensions: object,
        position: object,
        rotation: object,
        centered: bool,
        name: str | None,
    ) -> None:
        what = f"`{type(self).__name__}`"
        placement = _Placement(mesh, dimensions, position, rotation, centered, what, flat=False)
        Region.__init__(self, *placement.operands, name=name)
        self.dimensions, self.position, self.rotation = (
            placement.dimensions,
            placement.position,
            placement.rotation,
        )

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        """Return the solid and what is within the tolerance of it."""
        inside = super().contains_points(points, *columns)
        body = body_of(*columns)
        near = np.flatnonzero(~inside & (body_points.distances_from_box(body, points) <= self.tolerance))
        if len(near):
            inside = np.array(np.broadcast_to(inside, max(len(inside), len(points), len(body))))
            part = body if len(body) == 1 else body.take(near)
            place = points if len(points) == 1 else points[near]
            nearest = distance.to_surface(part, place, len(near), within=self.tolerance)
            inside[near] = nearest.distance <= self.tolerance
        return inside

    @classmethod
    def fromFile(
        cls, path: object, unify: bool = True, unit: str = "m", scale: float = 1, **options: Any
    ) -> Self:
        """Return the region of a mesh file in a unit of length, times ``scale``; further arguments are those of the class."""
        return cls(_loaded(cls, path, unit, scale, unify=unify), **options)

    def project(self, point: object, direction: object) -> tuple[Any, Any]:
        return super().project(point, self.onDirection if direction is None else direction)


class MeshSurfaceRegion(SideSurface):
    """The surface of a mesh: centred, scaled to dimensions, turned and moved.

    The arguments are those of `MeshVolumeRegion`; the mesh need not be closed. ``orientation=True`` gives points the orientation
    whose local Z is the normal of the face, and whose yaw is as near to North as possible.
    """

    kindred = ("SideSurface",)

    def __init__(
        self,
        mesh: object,
        dimensions: object = None,
        position: object = None,
        rotation: object = None,
        orientation: object = True,
        tolerance: float = 1e-6,
        centerMesh: bool = True,
        onDirection: Any = None,
        name: str | None = None,
        **_established: Any,
    ) -> None:
        what = f"`{type(self).__name__}`"
        placement = _Placement(_mesh(mesh, what), dimensions, position, rotation, centerMesh, what, flat=True)
        self._finish(placement.operands, orientation, name)
        self.dimensions, self.position, self.rotation = (
            placement.dimensions,
            placement.position,
            placement.rotation,
        )
        self.tolerance = tolerance
        self.onDirection = onDirection

    @classmethod
    def of_operands(cls, operands: tuple[Any, ...], orientation: object = True) -> Self:
        """Return the surface of a body given by the operands of `body_of`."""
        self = cls.__new__(cls)
        self._finish(operands, orientation, None)
        self.position, self.rotation, self.dimensions = operands[:3]
        self.tolerance, self.onDirection = 1e-6, None
        return self

    def _finish(self, operands: tuple[Any, ...], orientation: object, name: str | None) -> None:
        Region.__init__(self, *operands, name=name)
        self.facing = Facing()
        self.orientation = RegionField(self) if orientation is True else orientation
        self.has_orientation = self.orientation is not None

    @classmethod
    def fromFile(
        cls, path: object, unify: bool = True, unit: str = "m", scale: float = 1, **options: Any
    ) -> Self:
        """Return the region of a mesh file in a unit of length, times ``scale``; further arguments are those of the class."""
        return cls(_loaded(cls, path, unit, scale, unify=unify, volume=False), **options)

    def uniform_placement(self) -> tuple[Any, Any]:
        point, normal = super().uniform_placement()
        if self.orientation is None:
            return point, None
        return point, normal if isinstance(self.orientation, RegionField) else self.orientation[point]

    def project(self, point: object, direction: object) -> tuple[Any, Any]:
        landed, normal = super().project(point, self.onDirection if direction is None else direction)
        return landed, normal if isinstance(self.orientation, RegionField) else self.orientation_at(landed)

    def getVolumeRegion(self) -> MeshVolumeRegion:
        """Return the volume that the surface bounds; raises ``ValueError`` where it bounds none."""
        position, rotation, dimensions, shape = self.parameters
        return MeshVolumeRegion(shape.mesh, dimensions, position, rotation)


def solid_in_world(operands: list[Column]) -> Mesh:
    """Return the mesh of a body in its one placement, in the world."""
    body = body_of(*operands)
    unit = body.meshes[0 if body.choice is None else int(body.choice[0])]
    vertices = body.poses.to_world(unit.vertices[np.newaxis])[0]
    return Mesh(vertices, unit.faces)


def surface_in_world(region: SideSurface) -> Mesh | None:
    """Return the faces of a surface without random parameters, in the world, and their vertices alone; ``None`` without faces."""
    columns = region.fixed_columns("the surface")
    body, mesh = body_of(*columns), solid_in_world(columns)
    side, threshold = region.facing.side, region.facing.threshold
    if side is None:
        return mesh
    unit = body.meshes[0 if body.choice is None else int(body.choice[0])]
    faces = np.arange(len(unit.faces))
    mine = mesh.faces[side_contains(unit, body.poses, side, threshold, np.zeros_like(faces), faces)]
    if not len(mine):
        return None
    return Mesh(*without_unused(mesh.vertices, mine))


@generic.world_mesh.register(Region)
def world_mesh(region: Region) -> Any:
    """Return the mesh of a region of a body in the world, as a `trimesh.Trimesh`."""
    import trimesh

    if isinstance(region, SideSurface):
        mesh = surface_in_world(region)
        if mesh is None:
            raise InvalidScenarioError(
                f"{region!r} has no faces",
                span=here(),
                help="take another side, or give the object other `sideComponentThresholds`",
            )
    else:
        mesh = solid_in_world(region.fixed_columns("the mesh"))
    return trimesh.Trimesh(np.array(mesh.vertices), np.array(mesh.faces), process=False)


__all__ = [
    "MeshRegion",
    "MeshSurfaceRegion",
    "MeshVolumeRegion",
    "solid_in_world",
    "surface_in_world",
    "world_mesh",
]
